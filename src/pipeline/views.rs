//! The two views as they are matched: what does not show the scene is masked, and rows are aligned.

use std::borrow::Cow;

use crate::{
    backend::Backend,
    dense::{Dense, View},
    error::Result,
    features::{Feature, FeatureConfig},
    image::{self, Luma, Size},
    io::Picture,
    mask::{self, Mask},
    pair::Pair,
    rectify::WarpMap,
};

/// A pair with the masks of its left and of its right view.
pub(super) struct Views<'b> {
    pub pair: Pair<'b>,
    pub masks: [Option<Mask>; 2],
}

impl<'b> Views<'b> {
    /// The views of two pictures, with unseen pixels replaced by their neighbours.
    pub async fn new(backend: &'b Backend, left: &Picture, right: &Picture) -> Result<Self> {
        let pair = Pair::new(backend, left, right).await?;
        let views = pair.views();
        let masks = [mask::mask_of(left, views.0), mask::mask_of(right, views.1)];
        let shown = [(views.0, &masks[0]), (views.1, &masks[1])];
        let extended = shown.map(|(view, mask)| mask.as_ref().map(|mask| mask::extended(view, mask)));
        Ok(Self { pair: pair.with_views(extended).await?, masks })
    }

    /// The interest points of both views downscaled by `factor`, in pixels of the downscaled views.
    pub async fn features(&self, factor: u32, config: &FeatureConfig) -> Result<[Vec<Feature>; 2]> {
        let mut features = match factor {
            1 => self.pair.features(config).await?,
            _ => self.pair.reduced(factor).await?.features(config).await?,
        };
        for (points, mask) in features.iter_mut().zip(self.masks(factor)) {
            points.retain(|point| mask.as_ref().is_none_or(|mask| mask::is_seen(mask, point)));
        }
        Ok(features)
    }

    /// The masks of both views downscaled by `factor`.
    pub fn masks(&self, factor: u32) -> [Option<Mask>; 2] {
        self.masks.each_ref().map(|mask| mask.as_ref().map(|mask| mask::reduced(mask, factor)))
    }

    /// Both views downscaled by `factor`.
    pub fn reduced(&self, factor: u32) -> [Cow<'_, Luma>; 2] {
        let (left, right) = self.pair.views();
        [left, right].map(|view| match factor {
            1 => Cow::Borrowed(view),
            _ => Cow::Owned(image::reduced(view, factor)),
        })
    }

    /// The views with the right one resampled by `map`.
    pub async fn aligned(self, map: &WarpMap) -> Result<Self> {
        let pair = self.pair.with_right_warped(map).await?;
        let [left, right] = self.masks;
        let right = right.map(|mask| map.visible_through(&mask)).transpose()?.unwrap_or_else(|| map.visible());
        Ok(Self { pair, masks: [left, right.data().contains(&0).then_some(right)] })
    }

    /// The views ready for dense matching: unseen pixels correspond to nothing.
    pub async fn drowned(self) -> Result<Self> {
        let (left, right) = self.pair.views();
        let shown = [(left, &self.masks[0], 0), (right, &self.masks[1], 1)];
        let drowned = shown.map(|(view, mask, seed)| mask.as_ref().map(|mask| mask::drowned(view, mask, seed)));
        Ok(Self { pair: self.pair.with_views(drowned).await?, masks: self.masks })
    }

    /// A map of the `reference` view without what the views do not show.
    pub fn masked(&self, dense: Dense, reference: View) -> Dense {
        let [left, right] = self.masks.each_ref().map(Option::as_ref);
        match reference {
            View::Left => mask::masked(dense, reference, left, right),
            View::Right => mask::masked(dense, reference, right, left),
        }
    }

    /// Width and height of both views, in pixels.
    pub fn size(&self) -> Size {
        self.pair.size()
    }
}
