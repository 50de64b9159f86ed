//! A view as it was taken, ready to be resampled.

use glam::DVec2;

use crate::{
    backend::Backend,
    cpu,
    error::Result,
    filter::in_parallel,
    image::{Luma, reduced},
    io::Picture,
    luma::{check_size, upload},
    mask::{self, Mask},
    mosaic::demosaicked,
    rectify::{WarpMap, warp, warp_colours},
};

/// A view, continued where it does not show the scene.
#[derive(Clone, Debug)]
pub(super) struct TakenView {
    /// Colours, grey for a raw mosaic; alpha is 0 where the view does not show the scene, and else 255.
    pub picture: Picture,
    pub seen: Seen,
    /// Whether the view is a raw mosaic.
    pub is_mosaic: bool,
}

/// The luma of a view, continued where it does not show the scene.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub luma: Luma,
    pub mask: Option<Mask>,
}

impl TakenView {
    /// The view of a picture, a mosaic demosaicked and unseen pixels replaced by their neighbours.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for sides beyond [`crate::luma::MAX_SIDE`].
    fn new(picture: &Picture) -> Result<Self> {
        check_size(picture.size())?;
        let luma = picture.luma();
        // Before demosaicking, which mixes the edge of a border with the scene.
        let mask = mask::mask_of(picture, &luma);
        let demosaicked = demosaicked(picture, &luma);
        let is_mosaic = demosaicked.is_some();
        let (colors, luma) = match demosaicked {
            Some(luma) => ([luma.clone(), luma.clone(), luma.clone()], luma),
            None => ([0, 1, 2].map(|channel| picture.map(|pixel| pixel[channel])), luma),
        };
        let continued = |plane: Luma| mask.as_ref().map(|mask| mask::extended(&plane, mask)).unwrap_or(plane);
        let [red, green, blue] = colors.map(continued);
        let picture = in_parallel(picture.size(), |x, y| {
            let alpha = mask.as_ref().map_or(mask::SEEN, |mask| mask.get(x, y));
            [red.get(x, y), green.get(x, y), blue.get(x, y), alpha]
        });
        Ok(Self { picture, seen: Seen { luma: continued(luma), mask }, is_mosaic })
    }

    /// Both views, as [`Self::new`] makes each.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub fn both(left: &Picture, right: &Picture) -> Result<[Self; 2]> {
        let (left, right) = rayon::join(|| Self::new(left), || Self::new(right));
        Ok([left?, right?])
    }

    /// The view resampled by `map`, the same bytes on every backend: in colour, alpha 0 where it shows nothing of the scene, and its
    /// luma, which goes on there.
    pub async fn warped(&self, backend: &Backend, map: &WarpMap) -> Result<(Picture, Luma)> {
        let is_grey = self.picture.data().iter().all(|[red, green, blue, _]| red == green && green == blue);
        let (luma, colours) = match backend {
            Backend::Cpu => (
                cpu::rectify::warp(&self.seen.luma, map),
                (!is_grey).then(|| cpu::rectify::warp_colours(&self.picture, map)),
            ),
            Backend::Gpu(gpu) => (
                warp(gpu, &upload(gpu, &self.seen.luma).await?, map).await?.1,
                if is_grey { None } else { Some(warp_colours(gpu, &self.picture, map).await?) },
            ),
        };
        let picture = match (colours, &self.seen.mask) {
            // Alpha 0 where a pixel lies beyond the view.
            (Some(picture), None) => picture,
            (colours, _) => {
                let visible = self.visible(map)?;
                in_parallel(map.size(), |x, y| match (visible.get(x, y), &colours) {
                    (0, _) => [0; 4],
                    (_, Some(picture)) => picture.get(x, y),
                    (_, None) => [luma.get(x, y), luma.get(x, y), luma.get(x, y), mask::SEEN],
                })
            }
        };
        Ok((picture, luma))
    }

    /// Which pixels of the view resampled by `map` show the scene.
    pub fn visible(&self, map: &WarpMap) -> Result<Mask> {
        match &self.seen.mask {
            Some(mask) => map.visible_nearest(mask),
            None => Ok(map.visible()),
        }
    }
}

impl Seen {
    /// The view downscaled by `factor`.
    pub fn reduced(&self, factor: u32) -> Self {
        let mask = self.mask.as_ref().map(|mask| mask::reduced(mask, factor));
        Self { luma: reduced(&self.luma, factor), mask }
    }

    /// Whether a place lies in the view and shows the scene.
    pub fn shows(&self, place: DVec2) -> bool {
        let pixel = place.round();
        let side = DVec2::new(self.luma.width().into(), self.luma.height().into());
        let is_inside = pixel.cmpge(DVec2::ZERO).all() && pixel.cmplt(side).all();
        is_inside && self.mask.as_ref().is_none_or(|mask| mask.get(pixel.x as u32, pixel.y as u32) != 0)
    }
}
