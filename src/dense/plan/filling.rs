//! Filling of holes: the plan.
//!
//! projection to the other view, bitmaps of the holes -> tangent planes beside holes -> filling along rays.

use std::ops::Range;

use super::Plan;
use crate::{
    dense::{
        config::View,
        kernels::{Bitmaps, Fill, MapBuffer, MapLayout, Project, Shown, Surroundings, Tangents, rays},
        word_copy::{CopyTarget, WordCopy},
    },
    disparity::DisparityRange,
    error::Result,
    gpu::{Gpu, WordTexture},
    image::Size,
    luma::Colours,
};

/// The filling of holes: its kernels and their memory, for the largest window.
pub(super) struct Filling<'a> {
    kernels: (Project, Bitmaps, Tangents, Fill),
    /// The colours of the reference view.
    colours: &'a Colours,
    with_holes: WordTexture,
    projected: wgpu::Buffer,
    bitmaps: wgpu::Buffer,
    tangents: wgpu::Buffer,
}

impl<'a> Filling<'a> {
    /// Rows around a pixel that decide how it is filled.
    pub(super) const HALO: u32 = rays::LONGEST + Tangents::RADIUS;

    pub(super) fn new(gpu: &Gpu, plan: &mut Plan, colours: &'a Colours, largest: MapLayout) -> Result<Self> {
        let size = Size::new(largest.width, largest.rows);
        Ok(Self {
            kernels: (Project::new(gpu), Bitmaps::new(gpu), Tangents::new(gpu), Fill::new(gpu)),
            colours,
            with_holes: plan.word_texture("disparities with holes", size.pixels())?,
            projected: plan.buffer("projected disparities", size.pixels())?,
            bitmaps: plan.buffer("bitmaps", Bitmaps::words(size))?,
            tangents: plan.buffer("tangents", Tangents::words(size))?,
        })
    }

    /// Fills, between checkpoints, the holes in `rows` of `map` that the mask `own` of the view shows, if there is one. The map has the rows of
    /// the view from row `top` on.
    pub(super) fn plan(
        &self,
        plan: &mut Plan,
        (range, view): (DisparityRange, View),
        own: Option<&wgpu::Buffer>,
        top: u32,
        map: MapBuffer<'_>,
        rows: Range<u32>,
    ) {
        let Self { kernels, colours, with_holes, projected, bitmaps, tangents } = self;
        let (project, bitmap, tangent, fill) = kernels;
        let MapBuffer { buffer: disparities, layout } = map;
        let size = Size::new(layout.width, layout.rows);
        let word = |row: u32| u64::from(layout.width) * u64::from(row);
        for (first_row, band, pixels) in colours.bands() {
            // The rows that the band and the window share.
            let (first, end) = (first_row.max(top), (first_row + band.height).min(top + layout.rows));
            if first < end {
                let (from, to) = (pixels.clone(), CopyTarget::Buffer(tangents.clone()));
                let from_word = word(first - first_row);
                let to_word = Tangents::picture_offset(size) + word(first - top);
                plan.copy(WordCopy { from, from_word, to, to_word, words: word(end - first) });
            }
        }
        plan.clear(projected);
        plan.run(project.prepare(size, view, disparities, projected));
        plan.fill_texture(disparities, with_holes);
        // A binding has a buffer, also where nothing reads it.
        let shown = Shown { mask: own.unwrap_or(projected), first_row: top, is_masked: own.is_some() };
        plan.run(bitmap.prepare(size, with_holes, shown, bitmaps));
        plan.run(tangent.prepare(size, range, with_holes, bitmaps, tangents));
        plan.checkpoint();
        plan.run(fill.prepare(range, view, Surroundings { tangents, projected, bitmaps }, map, rows));
        plan.checkpoint();
    }
}
