//! The dense half of one pair size: all kernels, all memory, and the order of things.

use super::{
    block_match::{BlockMatch, Layout, Tile, Wanted},
    config::{DenseConfig, View},
    consistency::Consistency,
    pad::Pad,
};
use crate::{
    disparity::DisparityMap,
    error::{Error, Result},
    gpu::{Dispatch, Gpu, Readback, guarded, storage_buffer},
    image::{Luma, Plane},
    luma::{check_packed, upload},
};

/// More rows than this are never matched at once, to stay below 65,535 workgroups.
const MAX_BAND_ROWS: u32 = 8192;

/// Nor are more pixel-disparities: a device that also draws the desktop is taken away from a dispatch
/// that takes seconds, and slow ones do 10^9 of them in about one.
const MAX_BAND_WORK: u64 = 1 << 30;

/// A disparity for each pixel of the reference view, and how far it can be trusted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dense {
    /// Fixed-point disparities; see [`crate::disparity`].
    pub disparity: DisparityMap,
    /// 0 where there is no disparity, otherwise 1 to 255: the margin by which the winner's cost is
    /// below its best rival's, as a share of the rival's.
    pub confidence: Plane<u8>,
}

/// Dense matching of pairs of one size on a borrowed device.
///
/// Pictures whose planes do not fit in one buffer are matched in bands of rows; no result depends
/// on where they are cut.
pub struct Matcher {
    size: (u32, u32),
    bands: Vec<Band>,
    /// The disparities of a band, then its confidences.
    matches: wgpu::Buffer,
    confidence_offset: u32,
    bytes: u64,
}

struct Band {
    first_row: u32,
    rows: u32,
    dispatches: Vec<Dispatch>,
}

impl Matcher {
    /// Compiles the kernels and allocates all memory for packed `left` and `right` of `size`
    /// (rows of `width.div_ceil(4)` words, four pixels a word).
    ///
    /// # Errors
    /// [`Error::Parameter`] for a configuration that cannot be, [`Error::TooLarge`] for a row that
    /// the device cannot bind, and what the device says.
    pub fn new(
        device: &wgpu::Device,
        size: (u32, u32),
        config: &DenseConfig,
        left: &wgpu::Buffer,
        right: &wgpu::Buffer,
    ) -> Result<Self> {
        Self::with_band_rows(device, size, config, left, right, MAX_BAND_ROWS)
    }

    /// As [`Self::new`], with at most `band_rows` rows at once: less memory for a little more work.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_band_rows(
        device: &wgpu::Device,
        size: (u32, u32),
        config: &DenseConfig,
        left: &wgpu::Buffer,
        right: &wgpu::Buffer,
        band_rows: u32,
    ) -> Result<Self> {
        config.validate()?;
        for luma in [left, right] {
            check_packed(luma, size.0, size.1)?;
        }
        // The kernels count words and pixels in 32 bits.
        let limit = device.limits().max_storage_buffer_binding_size.min(device.limits().max_buffer_size).min(1 << 32);
        let band_rows = band_rows_within(limit, size, config, tiles(device), band_rows)?;
        guarded(device, "dense matching", || Self::build(device, size, config, [left, right], band_rows))
    }

    fn build(
        device: &wgpu::Device,
        size: (u32, u32),
        config: &DenseConfig,
        [left, right]: [&wgpu::Buffer; 2],
        band_rows: u32,
    ) -> Result<Self> {
        let (width, height) = size;
        let [tile, winners_tile] = tiles(device);
        let pad = Pad::new(device);
        let block_match = BlockMatch::new(device, config, Wanted::Matches, tile);
        let check = config.consistency.map(|max_difference| {
            (BlockMatch::new(device, config, Wanted::Winners, winners_tile), Consistency::new(device), max_difference)
        });

        let mut bytes = 0;
        let mut buffer = |label, words: u64| {
            bytes += 4 * words;
            storage_buffer(device, label, 4 * words)
        };
        let confidence_offset = width * band_rows;
        let pixels = u64::from(confidence_offset);
        let planes = buffer("padded planes", plane_words(size, band_rows, config, tiles(device))?)?;
        let matches = buffer("matches", 2 * pixels)?;
        let winners = if check.is_some() { Some(buffer("winners of the other view", pixels)?) } else { None };

        let padding = |layout: &Layout, view: View| {
            let [reference, searched] = match view {
                View::Left => [left, right],
                View::Right => [right, left],
            };
            let [of_reference, of_searched] = layout.padding(view);
            [pad.prepare(device, of_reference, reference, &planes), pad.prepare(device, of_searched, searched, &planes)]
        };
        let mut bands = Vec::new();
        for first_row in (0..height).step_by(band_rows as usize) {
            let rows = band_rows.min(height - first_row);
            let layout = Layout::new(size, first_row, rows, config, tile)?;
            let view = config.reference;
            let mut dispatches = Vec::from(padding(&layout, view));
            dispatches.push(block_match.prepare(device, &layout, view, &planes, &matches, confidence_offset));
            if let (Some((find_winners, consistency, max_difference)), Some(winners)) = (&check, &winners) {
                let layout = Layout::new(size, first_row, rows, config, winners_tile)?;
                dispatches.extend(padding(&layout, view.other()));
                dispatches.push(find_winners.prepare(device, &layout, view.other(), &planes, winners, 0));
                let size = (width, rows);
                let limit = *max_difference;
                dispatches.push(consistency.prepare(device, size, confidence_offset, view, limit, winners, &matches));
            }
            bands.push(Band { first_row, rows, dispatches });
        }
        Ok(Self { size, bands, matches, confidence_offset, bytes })
    }

    /// Bytes of device memory that this matcher holds.
    pub fn memory(&self) -> u64 {
        self.bytes
    }

    /// In how many bands of rows the pair is matched.
    pub fn bands(&self) -> usize {
        self.bands.len()
    }

    /// Records the whole matching, which ends with `disparities` (`i32`) and `confidences` (`u32`,
    /// 0 to 255) of every pixel of the reference view in the caller's buffers, row by row. Both
    /// need `COPY_DST`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, disparities: &wgpu::Buffer, confidences: &wgpu::Buffer) {
        for band in &self.bands {
            for dispatch in &band.dispatches {
                dispatch.record(encoder);
            }
            let row_bytes = 4 * u64::from(self.size.0);
            let (offset, length) = (row_bytes * u64::from(band.first_row), row_bytes * u64::from(band.rows));
            let confidence_bytes = 4 * u64::from(self.confidence_offset);
            encoder.copy_buffer_to_buffer(&self.matches, 0, disparities, offset, Some(length));
            encoder.copy_buffer_to_buffer(&self.matches, confidence_bytes, confidences, offset, Some(length));
        }
    }
}

/// The tiles for matches and for winners.
fn tiles(device: &wgpu::Device) -> [Tile; 2] {
    [Wanted::Matches, Wanted::Winners].map(|wanted| Tile::of(device, wanted))
}

/// Words of the padded planes of a band, whichever tile pads them.
fn plane_words(size: (u32, u32), rows: u32, config: &DenseConfig, tiles: [Tile; 2]) -> Result<u64> {
    let [matches, winners] = tiles.map(|tile| Layout::new(size, 0, rows, config, tile));
    Ok(matches?.words().max(winners?.words()))
}

/// The most rows, up to `wanted`, for which every buffer of a band stays within `limit` bytes and its
/// work within a second or so.
fn band_rows_within(limit: u64, size: (u32, u32), config: &DenseConfig, tiles: [Tile; 2], wanted: u32) -> Result<u32> {
    let (width, height) = size;
    let work = u64::from(width) * u64::from(config.searched(width)?.count);
    let quick = u32::try_from(MAX_BAND_WORK / work).unwrap_or(u32::MAX);
    let mut rows = wanted.min(quick).clamp(1, height.min(MAX_BAND_ROWS));
    loop {
        let planes = 4 * plane_words(size, rows, config, tiles)?;
        let needed = planes.max(8 * u64::from(width) * u64::from(rows));
        if needed <= limit {
            return Ok(rows);
        }
        if rows == 1 {
            return Err(Error::TooLarge {
                what: format!("one row of a picture {width} px wide with {} disparities", config.range.count),
                needed,
                limit,
                way_out: "search fewer disparities or scale the pictures down".into(),
            });
        }
        rows = rows.div_ceil(2);
    }
}

/// Matches one pair on `gpu` and waits for the result.
///
/// # Errors
/// [`Error::SizesDiffer`], and as [`Matcher::new`]; [`Error::DeviceLost`].
pub fn compute(gpu: &Gpu, left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    if left.size() != right.size() {
        return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
    }
    let (left_luma, right_luma) = (upload(gpu, left)?, upload(gpu, right)?);
    let matcher = Matcher::new(&gpu.device, left.size(), config, &left_luma, &right_luma)?;
    matcher.run(gpu)
}

impl Matcher {
    /// Submits the whole matching on `gpu` and waits for the result.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    pub fn run(&self, gpu: &Gpu) -> Result<Dense> {
        let (width, height) = self.size;
        let pixels = width as usize * height as usize;
        let device = &gpu.device;
        let [disparities, confidences] = guarded(device, "the disparity map", || {
            Ok(["disparities", "confidences"].map(|label| Readback::new(device, label, 4 * pixels as u64)))
        })?;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("dense") });
        self.record(&mut encoder, disparities.buffer(), confidences.buffer());
        gpu.queue.submit([encoder.finish()]);
        let disparity = Plane::new(width, height, disparities.read(device, pixels)?)?;
        let confidence = Plane::new(width, height, confidences.read::<u32>(device, pixels)?)?.map(|&c| c as u8);
        Ok(Dense { disparity, confidence })
    }
}
