//! The two views as they are matched: what does not show the scene is masked, and rows are aligned.

use std::borrow::Cow;

use super::rectified::RectifiedPair;
use crate::{
    backend::Backend,
    config::{Config, Method},
    cpu::{self, dense::unseen},
    dense::{Dense, DenseConfig, Seen, View, kernels::Loss},
    disparity::DisparityMap,
    error::Result,
    features::{Detected, FeatureConfig},
    image::{self, Luma, Size},
    io::Picture,
    mask::{self, Mask},
    mosaic::demosaicked,
    pair::Pair,
    rectify::{RowModel, WarpMap},
    tiles::Whole,
};

/// A pair, with what was found about its left and its right view.
pub(super) struct Views<'b> {
    pub pair: Pair<'b>,
    pub masks: [Option<Mask>; 2],
    /// Pixels of the resampled right view that lie in the right view as given, if any do not.
    within: Option<Mask>,
    /// Whether the view was a raw mosaic, which the luma of its colours replaced.
    pub mosaics: [bool; 2],
    /// The rectified pair whose pictures the views are, if they are.
    rectified: Option<&'b RectifiedPair>,
    /// The map that resampled the right view, from the picture as given or, of a rectified pair, as it was taken.
    map: Option<WarpMap>,
}

/// Of which views `config` needs the colours, to fill holes by.
fn coloured(config: &Config) -> [bool; 2] {
    let fills = matches!(&config.method, Method::Hsad(parameters) if parameters.fills());
    View::ALL.map(|view| fills && view == config.reference)
}

impl<'b> Views<'b> {
    /// The views of a rectified pair, of which only alpha tells what is seen: the scene goes on up to there, and its luma beyond.
    pub async fn of_rectified(backend: &'b Backend, rectified: &'b RectifiedPair, config: &Config) -> Result<Self> {
        let [left, right] = coloured(config);
        let pictures = [(&rectified.pictures[0], left), (&rectified.pictures[1], right)];
        let pictures = pictures.map(|(picture, is_coloured)| is_coloured.then_some(picture));
        let pair = Pair::with_known_luma(backend, rectified.luma.clone(), pictures).await?;
        let masks = rectified.masks().map(|mask| Some(mask).filter(|mask| mask.data().contains(&0)));
        Ok(Self { pair, masks, within: None, mosaics: [false; 2], rectified: Some(rectified), map: None })
    }

    /// The views of two pictures, mosaics demosaicked and unseen pixels replaced by their neighbours, for matching by `config`.
    pub async fn new(backend: &'b Backend, [left, right]: [&'b Picture; 2], config: &Config) -> Result<Self> {
        let pair = Pair::with_colours(backend, [left, right], coloured(config)).await?;
        let views = pair.views();
        // Before demosaicking, which mixes the edge of a border with the scene.
        let masks = [mask::mask_of(left, views.0), mask::mask_of(right, views.1)];
        let lumas = [demosaicked(left, views.0), demosaicked(right, views.1)];
        let mosaics = lumas.each_ref().map(Option::is_some);
        let pair = pair.with_views(lumas).await?;
        let views = pair.views();
        let shown = [(views.0, &masks[0]), (views.1, &masks[1])];
        let extended = shown.map(|(view, mask)| mask.as_ref().map(|mask| mask::extended(view, mask)));
        let pair = pair.with_luma(extended).await?;
        Ok(Self { pair, masks, within: None, mosaics, rectified: None, map: None })
    }

    /// The interest points of both views downscaled by `factor`, in pixels of the downscaled views.
    pub async fn features(&self, factor: u32, config: &FeatureConfig) -> Result<[Detected; 2]> {
        let mut detected = match factor {
            1 => self.pair.features(config).await?,
            _ => self.pair.reduced(factor).await?.features(config).await?,
        };
        for (Detected { features, found }, mask) in detected.iter_mut().zip(self.masks(factor)) {
            let weaker = *found - features.len();
            features.retain(|point| mask.as_ref().is_none_or(|mask| mask::is_seen(mask, point)));
            *found = features.len() + weaker;
        }
        Ok(detected)
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

    /// The views with the rows of the right one brought to the left ones, which `rows` says. The right view of a rectified pair is
    /// resampled once, from the view as it was taken.
    pub async fn aligned(self, rows: &RowModel) -> Result<Self> {
        let Some(map) = rows.warp(self.pair.size())? else { return Ok(self) };
        let [left, right] = self.masks;
        if let Some(RectifiedPair { rectification, right: taken, .. }) = self.rectified {
            let map = rectification.right_map_along(rows)?;
            let visible = taken.visible(&map)?;
            let right = Some(visible).filter(|mask| mask.data().contains(&0));
            let pair = self.pair.with_right_from(&taken.seen.luma, &map).await?;
            return Ok(Self { pair, masks: [left, right], map: Some(map), ..self });
        }
        let pair = self.pair.with_right_warped(&map).await?;
        let right = right.map(|mask| map.visible_through(&mask)).transpose()?;
        let within = Some(map.visible()).filter(|mask| mask.data().contains(&0));
        Ok(Self { pair, masks: [left, right], within, map: Some(map), ..self })
    }

    /// The views ready for dense matching: unseen pixels correspond to nothing. Those of a rectified pair lie beyond its edges, where
    /// the views go on as any view does beyond its edge; noise there would cost the pixels beside it their disparities.
    pub async fn drowned(self) -> Result<Self> {
        if self.rectified.is_some() {
            return Ok(self);
        }
        let (left, right) = self.pair.views();
        let shown = [(left, &self.masks[0], 0), (right, &self.masks[1], 1)];
        let drowned = shown.map(|(view, mask, seed)| mask.as_ref().map(|mask| mask::drowned(view, mask, seed)));
        Ok(Self { pair: self.pair.with_luma(drowned).await?, ..self })
    }

    /// The pictures of the views in colour, the right one with its rows aligned; grey for mosaics. `left` and `right` are the pictures
    /// as given.
    pub fn pictures<'p>(&self, [left, right]: [&'p Picture; 2]) -> [Cow<'p, Picture>; 2] {
        let grey = |luma: &Luma| Cow::Owned(cpu::luma::rgba(luma));
        let views = self.pair.views();
        [
            if self.mosaics[0] { grey(views.0) } else { Cow::Borrowed(left) },
            match (&self.map, self.rectified) {
                _ if self.mosaics[1] => grey(views.1),
                (Some(map), Some(pair)) => Cow::Owned(cpu::rectify::warp_colours(&pair.right.picture, map)),
                (Some(map), None) => Cow::Owned(cpu::rectify::warp_colours(right, map)),
                (None, _) => Cow::Borrowed(right),
            },
        ]
    }

    /// Matches the pair: a disparity and a confidence for each pixel of the reference view. Calls `progress` with the share of the
    /// work that a device has done, 0 to 1.
    ///
    /// Unseen pixels, and those whose partner is unseen, must not take part in the refinement, which fills holes from their
    /// neighbours. Beyond the edges of a rectified picture its view goes on, and partners may lie there.
    pub async fn dense(&self, config: &DenseConfig, progress: impl FnMut(f32)) -> Result<Dense> {
        let masks = self.own_and_other(config.reference);
        let is_masked = masks.iter().any(Option::is_some) && config.parameters.refinement.is_some();
        self.pair.dense_seen(config, is_masked.then_some(Seen { masks, loss: self.loss() }), progress).await
    }

    /// The views to cut tiles from; `pictures` are those that were given.
    pub fn whole<'a>(&'a self, pictures: [&'a Picture; 2], config: &'a DenseConfig) -> Whole<'a> {
        let (left, right) = self.pair.views();
        // A view that was demosaicked or resampled has no colours.
        let is_as_given = match config.reference {
            View::Left => !self.mosaics[0],
            View::Right => !self.mosaics[1] && self.map.is_none(),
        };
        let colours = pictures[usize::from(config.reference == View::Right)];
        Whole {
            luma: [left, right],
            colours: Some(colours).filter(|_| is_as_given && config.parameters.fills()),
            masks: self.own_and_other(config.reference),
            loss: self.loss(),
            config,
        }
    }

    /// What a pixel loses before the refinement whose partner is hidden.
    fn loss(&self) -> Loss {
        if self.rectified.is_some() { Loss::Nothing } else { Loss::Disparity }
    }

    /// A map of the `reference` view without what it does not show, and without confidence where the other view does not
    /// show the partner.
    pub fn confirmed(&self, mut dense: Dense, reference: View) -> Dense {
        let [own, other] = self.own_and_other(reference);
        unseen(&mut dense, reference, own, other, Loss::Confidence);
        let beyond = self.within.as_ref().filter(|_| reference == View::Left);
        unseen(&mut dense, reference, None, beyond, Loss::Confidence);
        dense
    }

    /// The disparities of a map of the `reference` view whose partners the other view shows.
    pub fn with_partners<'a>(&self, dense: &'a Dense, reference: View) -> Cow<'a, DisparityMap> {
        let [_, Some(other)] = self.own_and_other(reference) else { return Cow::Borrowed(&dense.disparity) };
        let mut shown = dense.clone();
        unseen(&mut shown, reference, None, Some(other), Loss::Disparity);
        Cow::Owned(shown.disparity)
    }

    /// The masks of the `reference` view and of the other one.
    fn own_and_other(&self, reference: View) -> [Option<&Mask>; 2] {
        let [left, right] = self.masks.each_ref().map(Option::as_ref);
        if reference == View::Left { [left, right] } else { [right, left] }
    }

    /// Width and height of both views, in pixels.
    pub fn size(&self) -> Size {
        self.pair.size()
    }
}
