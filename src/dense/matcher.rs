//! The dense half of one pair size: all kernels, all memory, and the order of things.

use super::{
    block_match::{BlockMatch, Layout, Tile, Wanted},
    config::DenseConfig,
    consistency::Consistency,
    pad::Pad,
};
use crate::{
    disparity::DisparityMap,
    error::{Error, Result},
    gpu::{Dispatch, Gpu, Readback, guarded, storage_buffer},
    image::{Luma, Plane},
    luma::{check_packed, unpack, upload},
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
        let band_rows = band_rows_within(limit, size, config, &tiles(device, config), band_rows)?;
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
        let tiles = tiles(device, config);
        let view = config.reference;
        let pad = Pad::new(device);
        let block_match = BlockMatch::new(device, config, view, Wanted::Matches, tiles[0]);
        let check = config.consistency.map(|max_difference| {
            let winners = BlockMatch::new(device, config, view.other(), Wanted::Winners, tiles[1]);
            (winners, Consistency::new(device), max_difference)
        });

        let mut bytes = 0;
        let mut buffer = |label, words: u64| {
            bytes += 4 * words;
            storage_buffer(device, label, 4 * words)
        };
        let confidence_offset = width * band_rows;
        let planes = buffer("padded planes", Layout::new(size, 0, band_rows, config, &tiles)?.words())?;
        let matches = buffer("matches", match_words(width, band_rows))?;
        let winners = match check {
            Some(_) => Some(buffer("winners of the other view", confidence_offset.into())?),
            None => None,
        };

        let mut bands = Vec::new();
        for first_row in (0..height).step_by(band_rows as usize) {
            let rows = band_rows.min(height - first_row);
            let layout = Layout::new(size, first_row, rows, config, &tiles)?;
            let [pad_left, pad_right] = layout.padding();
            let mut dispatches = vec![
                pad.prepare(device, pad_left, left, &planes),
                pad.prepare(device, pad_right, right, &planes),
                block_match.prepare(device, &layout, &planes, &matches, confidence_offset),
            ];
            if let (Some((find_winners, consistency, max_difference)), Some(winners)) = (&check, &winners) {
                dispatches.push(find_winners.prepare(device, &layout, &planes, winners, 0));
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

    /// Records the whole matching, which ends with `disparities` (`i32`) and `confidences` (0 to 255,
    /// four a word, in rows of `width.div_ceil(4)` words) of every pixel of the reference view in
    /// the caller's buffers, row by row. Both need `COPY_DST`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, disparities: &wgpu::Buffer, confidences: &wgpu::Buffer) {
        for band in &self.bands {
            for dispatch in &band.dispatches {
                dispatch.record(encoder);
            }
            let mut copy = |from: u64, to: &wgpu::Buffer, row_words: u32| {
                let row_bytes = 4 * u64::from(row_words);
                let (offset, length) = (row_bytes * u64::from(band.first_row), row_bytes * u64::from(band.rows));
                encoder.copy_buffer_to_buffer(&self.matches, from, to, offset, Some(length));
            };
            copy(0, disparities, self.size.0);
            copy(4 * u64::from(self.confidence_offset), confidences, self.size.0.div_ceil(4));
        }
    }
}

/// The tiles for matches, and for the other view's winners if they are wanted.
fn tiles(device: &wgpu::Device, config: &DenseConfig) -> Vec<Tile> {
    let winners = config.consistency.map(|_| Wanted::Winners);
    [Some(Wanted::Matches), winners].into_iter().flatten().map(|wanted| Tile::of(device, wanted)).collect()
}

/// Words of a band's disparities and confidences.
fn match_words(width: u32, rows: u32) -> u64 {
    u64::from(rows) * (u64::from(width) + u64::from(width.div_ceil(4)))
}

/// The most rows, up to `wanted`, for which every buffer of a band stays within `limit` bytes and its
/// work within a second or so.
fn band_rows_within(limit: u64, size: (u32, u32), config: &DenseConfig, tiles: &[Tile], wanted: u32) -> Result<u32> {
    let (width, height) = size;
    let work = u64::from(width) * u64::from(config.searched(width)?.count);
    let quick = u32::try_from(MAX_BAND_WORK / work).unwrap_or(u32::MAX);
    let mut rows = wanted.min(quick).clamp(1, height.min(MAX_BAND_ROWS));
    loop {
        let planes = Layout::new(size, 0, rows, config, tiles)?.words();
        let needed = 4 * planes.max(match_words(width, rows));
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
        let row_words = width.div_ceil(4) as usize;
        let [disparities, confidences] = guarded(device, "the disparity map", || {
            let lengths = [("disparities", pixels), ("confidences", row_words * height as usize)];
            Ok(lengths.map(|(label, words)| Readback::new(device, label, 4 * words as u64)))
        })?;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("dense") });
        self.record(&mut encoder, disparities.buffer(), confidences.buffer());
        gpu.queue.submit([encoder.finish()]);
        let disparity = Plane::new(width, height, disparities.read(device, pixels)?)?;
        let words: Vec<u32> = confidences.read(device, row_words * height as usize)?;
        let confidence = unpack(width, height, &words);
        Ok(Dense { disparity, confidence })
    }
}
