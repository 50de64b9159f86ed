//! What follows when all bands are matched: the plan from a map with holes and speckles to a complete one.
//!
//! agreement of neighbours -> residuals and support -> weighted medians of the supported disparities -> filling ->
//! weighted medians of all pixels -> a plain median.

use std::ops::Range;

use super::{BandLimits, Kept, Plan, WholeMap, filling::Filling};
use crate::{
    dense::{
        config::{DenseParameters, Filters, Median, View},
        kernels::{
            AGREEMENT_REACH, Agreement, ComparedViews, Loss, MapBuffer, MapLayout, Residual, SUPPORT_RADIUS, Support,
            Tangents, Unseen, WeightedMedian,
        },
        uploaded::UploadedPair,
        word_copy::{CopyTarget, WordCopy},
    },
    disparity::DisparityRange,
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu, most_words},
    image::Size,
    luma::Colours,
};

/// What is done to a map of all bands.
#[derive(Clone, Debug)]
pub(crate) struct After {
    /// Least number of agreeing pixels, if that is checked.
    pub(crate) agreement: Option<u32>,
    /// Filters of the refinement, if there is one.
    pub(crate) filters: Option<Filters>,
}

impl After {
    /// What `parameters` ask for.
    pub(crate) fn of(parameters: &DenseParameters) -> Self {
        Self {
            agreement: parameters.checks_agreement().then_some(parameters.agreement),
            filters: parameters.refinement.as_ref().map(Into::into),
        }
    }

    /// Whether holes are filled.
    pub(crate) fn fills(&self) -> bool {
        self.filters.as_ref().is_some_and(|filters| filters.fill)
    }

    /// Rows above and below a pixel that its checks and filters read.
    pub(crate) fn halo(&self) -> u32 {
        let agreement = if self.agreement.is_some() { AGREEMENT_REACH } else { 0 };
        let radii =
            |filters: &Filters| filters.before.iter().chain(&filters.after).map(|median| median.radius).sum::<u32>();
        let filling = if self.fills() { Filling::HALO } else { 0 };
        agreement + filling + self.filters.as_ref().map_or(0, |filters| SUPPORT_RADIUS + radii(filters))
    }
}

/// A map to be refined.
pub(super) struct Unrefined<'a> {
    /// Where the map lies.
    pub(super) map: StoredMap,
    /// Width and height of the map.
    pub(super) size: Size,
    /// The searched disparities; filled pixels stay within them.
    pub(super) range: DisparityRange,
    /// The pair, with the colours of the reference view if holes are filled.
    pub(super) pair: &'a UploadedPair,
    /// The reference view, to which the map belongs.
    pub(super) reference: View,
}

/// A window of rows of a map.
struct Window {
    /// Row of the map where the window begins.
    top: u32,
    /// The rows of the window that are handed out.
    result: Range<u32>,
}

/// The weighted-median kernels of a refinement. Most filters share their parameters, and each kernel is compiled once.
struct Medians(Vec<(Median, WeightedMedian)>);

impl Medians {
    fn new(gpu: &Gpu, filters: &Filters) -> Self {
        let mut kernels: Vec<(Median, WeightedMedian)> = Vec::new();
        for &median in filters.before.iter().chain(&filters.after) {
            if kernels.iter().all(|(known, _)| *known != median) {
                kernels.push((median, WeightedMedian::new(gpu, median, gpu.shapes().weighted_median)));
            }
        }
        Self(kernels)
    }

    fn get(&self, median: Median) -> &WeightedMedian {
        let kernel = self.0.iter().find(|(known, _)| *known == median);
        &kernel.expect("a kernel for each filter of the refinement").1
    }
}

/// The kernels of a refinement, and its memory besides the maps.
struct Refining<'a> {
    filters: Filters,
    residual: Residual,
    support: Support,
    filling: Option<Filling<'a>>,
    medians: Medians,
    residuals: wgpu::Buffer,
    supported: wgpu::Buffer,
}

impl<'a> Refining<'a> {
    /// Compiles and allocates for maps of up to `largest`.
    fn new(
        gpu: &Gpu,
        plan: &mut Plan,
        filters: &Filters,
        colours: Option<&'a Colours>,
        largest: MapLayout,
    ) -> Result<Self> {
        Ok(Self {
            residual: Residual::new(gpu),
            support: Support::new(gpu, filters.support, filters.majority, gpu.shapes().support),
            filling: colours.map(|colours| Filling::new(gpu, plan, colours, largest)).transpose()?,
            medians: Medians::new(gpu, filters),
            residuals: plan.buffer("residuals", u64::from(largest.width.div_ceil(4)) * u64::from(largest.rows))?,
            supported: plan.buffer("supported disparities", largest.words())?,
            filters: filters.clone(),
        })
    }

    /// Plans the refinement of a window of rows, in `unrefined`, whose view has the mask `own`. Returns the buffers of the result: of its disparities, and
    /// of the confidences, which lie behind a map.
    fn plan<'b>(
        &'b self,
        plan: &mut Plan,
        unrefined: MapBuffer<'b>,
        Window { top, result }: Window,
        (views, range): (ComparedViews<'_>, DisparityRange),
        own: Option<&wgpu::Buffer>,
    ) -> [&'b wgpu::Buffer; 2] {
        let layout = unrefined.layout;
        let size = Size::new(layout.width, layout.rows);
        let [left, right] = views.luma;
        let luma = if views.reference == View::Left { left } else { right };
        plan.run(self.residual.prepare(size, top, views, unrefined.buffer, &self.residuals));
        plan.run(self.support.prepare(unrefined, &self.residuals, &self.supported));

        // The map that the next filter reads, and the one that it writes. Medians leave confidences where they are.
        let mut maps = [&self.supported, unrefined.buffer];
        let mut confidences = &self.supported;
        let filter = |median: Median, [from, to]: [&wgpu::Buffer; 2]| {
            self.medians.get(median).prepare(size, (luma, top), from, to)
        };
        for &median in &self.filters.before {
            plan.run(filter(median, maps));
            maps.swap(0, 1);
        }
        if let Some(filling) = &self.filling {
            join(plan, maps[0], confidences, layout);
            confidences = maps[0];
            let reach: u32 = self.filters.after.iter().map(|median| median.radius).sum();
            let filled = result.start.saturating_sub(reach)..(result.end + reach).min(layout.rows);
            let map = MapBuffer { buffer: maps[0], layout };
            filling.plan(plan, (range, views.reference), own, top, map, filled);
        }
        for &median in &self.filters.after {
            plan.run(filter(median, maps));
            maps.swap(0, 1);
        }
        [maps[0], confidences]
    }
}

/// Plans the agreement check and the refinement of a map of all bands, and its copies to the caller's outputs.
///
/// A map that exceeds `limits` is worked on in windows of rows, with a halo of as many rows as the filters reach; the
/// result does not depend on where windows are cut.
pub(super) fn plan_after_bands(
    gpu: &Gpu,
    plan: &mut Plan,
    after: &After,
    Unrefined { map, size, range, pair, reference }: Unrefined<'_>,
    limits: BandLimits,
) -> Result<()> {
    let Size { width, height } = size;
    let halo = after.halo();
    let colours = after.fills().then(|| pair.colours.as_ref().expect("the colours of the reference view"));
    let brightness = &plan.brightness(View::Right);
    let views = ComparedViews { luma: pair.luma.each_ref(), brightness, reference };
    let rows = window_rows(gpu, size, halo, after.fills(), limits)?;
    let largest = MapLayout { width, rows: (rows + 2 * halo).min(height) };
    // A map that lies whole in one buffer stays there.
    let in_place = if let (true, StoredMap::Matches(matches)) = (rows == height, &map) { Some(matches) } else { None };
    let window = match in_place {
        Some(matches) => matches.clone(),
        None => plan.buffer("map of a window", largest.words())?,
    };
    let agreement = match after.agreement {
        Some(least) => Some((Agreement::new(gpu), least, plan.word_texture("map before the check", largest.words())?)),
        None => None,
    };
    let own = pair.masks.as_ref().map(|masks| &masks.own);
    let unseen = pair.masks.as_ref().map(|masks| (Unseen::new(gpu), masks));
    let refining = match &after.filters {
        Some(filters) => Some(Refining::new(gpu, plan, filters, colours, largest)?),
        None => None,
    };

    for first_row in (0..height).step_by(rows as usize) {
        let result_rows = rows.min(height - first_row);
        let top = first_row.saturating_sub(halo);
        let layout = MapLayout { width, rows: (first_row + result_rows + halo).min(height) - top };
        if in_place.is_none() {
            map.copy_rows(plan, size, top, MapBuffer { buffer: &window, layout });
        }
        let matches = MapBuffer { buffer: &window, layout };
        let skipped = first_row - top;
        if let Some((agreement, least, before)) = &agreement {
            plan.fill_texture(&window, before);
            plan.run(agreement.prepare(before, *least, matches));
        }
        if let Some((unseen, masks)) = &unseen {
            plan.run(unseen.prepare(matches, top, reference, [&masks.own, &masks.other], masks.loss));
        }
        let [disparities, mut confidences] = match &refining {
            None => [&window, &window],
            Some(refining) => {
                let result = skipped..skipped + result_rows;
                refining.plan(plan, matches, Window { top, result }, (views, range), own)
            }
        };
        if let Some((unseen, masks)) = &unseen {
            join(plan, disparities, confidences, layout);
            confidences = disparities;
            let refined = MapBuffer { buffer: disparities, layout };
            plan.run(unseen.prepare(refined, top, reference, [&masks.own, &masks.other], Loss::Confidence));
        }
        for (from, start, row_words, to) in [
            (disparities, 0, width, CopyTarget::Disparities),
            (confidences, u64::from(layout.confidence_offset()), width.div_ceil(4), CopyTarget::Confidences),
        ] {
            let row_words = u64::from(row_words);
            let from_word = start + row_words * u64::from(skipped);
            let (to_word, words) = (row_words * u64::from(first_row), row_words * u64::from(result_rows));
            plan.copy(WordCopy { from: from.clone(), from_word, to, to_word, words });
        }
        plan.checkpoint();
    }
    Ok(())
}

/// Plans the copy of a map's confidences to the buffer of its disparities, if they lie in another one.
fn join(plan: &mut Plan, disparities: &wgpu::Buffer, confidences: &wgpu::Buffer, layout: MapLayout) {
    if disparities != confidences {
        let words = u64::from(layout.width.div_ceil(4)) * u64::from(layout.rows);
        let (from, to) = (confidences.clone(), CopyTarget::Buffer(disparities.clone()));
        let word = layout.confidence_offset().into();
        plan.copy(WordCopy { from, from_word: word, to, to_word: word, words });
    }
}

/// The map of all bands.
pub(super) enum StoredMap {
    /// In the buffer of the matches of the only band.
    Matches(wgpu::Buffer),
    /// Collected.
    Whole(WholeMap),
}

impl StoredMap {
    /// The map that `plan` keeps; `matches` is the buffer of the matches of a band.
    pub(super) fn of(plan: &Plan, matches: &wgpu::Buffer) -> Self {
        match &plan.kept {
            Kept::Whole(map) => Self::Whole(map.clone()),
            Kept::InPlace | Kept::Nowhere => Self::Matches(matches.clone()),
        }
    }

    /// Buffer and first word of the disparities and of the confidences of a map of `size`.
    fn parts(&self, Size { width, height }: Size) -> [(&wgpu::Buffer, u64); 2] {
        match self {
            Self::Matches(buffer) => {
                let offset = MapLayout { width, rows: height }.confidence_offset();
                [(buffer, 0), (buffer, offset.into())]
            }
            Self::Whole(WholeMap { disparities, confidences }) => [(disparities, 0), (confidences, 0)],
        }
    }

    /// Plans a copy of as many rows as `window` has, from row `top` on, of a map of `size`.
    fn copy_rows(&self, plan: &mut Plan, size: Size, top: u32, MapBuffer { buffer, layout }: MapBuffer<'_>) {
        let MapLayout { width, rows } = layout;
        let places = [(width, 0), (width.div_ceil(4), u64::from(layout.confidence_offset()))];
        for ((from, start), (row_words, to_word)) in self.parts(size).into_iter().zip(places) {
            let from_word = start + u64::from(row_words) * u64::from(top);
            let words = u64::from(row_words) * u64::from(rows);
            let to = CopyTarget::Buffer(buffer.clone());
            plan.copy(WordCopy { from: from.clone(), from_word, to, to_word, words });
        }
    }
}

/// The most rows of the result per window, with `halo` rows on either side.
fn window_rows(gpu: &Gpu, Size { width, height }: Size, halo: u32, fills: bool, limits: BandLimits) -> Result<u32> {
    let tangents = |rows: u32| if fills { Tangents::words(Size::new(width, rows)) } else { 0 };
    let row_bytes = |rows: u32| 4 * MapLayout { width, rows }.words().max(tangents(rows));
    // The map is also copied to a texture.
    let fitting = (limits.bytes / row_bytes(1)).min(most_words(gpu) / MapLayout { width, rows: 1 }.words());
    let fitting = u32::try_from(fitting).unwrap_or(u32::MAX);
    let rows = if fitting >= height { height } else { fitting.saturating_sub(2 * halo) }.min(limits.rows);
    if rows > 0 {
        return Ok(rows);
    }
    Err(Error::TooLarge {
        what: format!("the refinement of rows {width} px wide"),
        needed: row_bytes(2 * halo + 1),
        limit: limits.bytes,
        way_out: format!("refine less, scale the pictures down, or use a device with more of {BUFFER_LIMITS}"),
    })
}
