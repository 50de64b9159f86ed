//! The steps of a matcher, in order, and their memory.

pub(super) mod blocks;
mod coarse_to_fine;
mod compared;
pub(super) mod costs;
mod filling;
mod followers;
mod level;
mod other_winners;
mod refine;
mod transform;

pub(super) use level::{LevelKernels, LevelTask};
pub(crate) use refine::After;

use super::{
    config::{Brightness, DenseConfig, View},
    kernels::MapBuffer,
    outputs::Outputs,
    word_copy::{CopyTarget, WordCopy},
};
use crate::{
    error::Result,
    gpu::{
        Dispatch, Gpu, Readback, Stopwatch, WordTexture, guarded, in_rows, record_run, storage_buffer, store,
        uniform_buffer,
    },
    image::Size,
};

/// The largest band.
#[derive(Clone, Copy, Debug)]
pub(super) struct BandLimits {
    /// Most bytes of a buffer.
    pub(super) bytes: u64,
    /// Most rows.
    pub(super) rows: u32,
}

/// One step of a plan.
#[derive(Debug)]
pub(super) enum Step {
    /// Runs a kernel.
    Run(Dispatch),
    /// Copies `u32`s.
    Copy(WordCopy),
    /// Copies the first words of a buffer to a texture.
    ToTexture(wgpu::Buffer, WordTexture),
    /// Clears a whole buffer to 0.
    Clear(wgpu::Buffer),
    /// The end of a part that can be submitted by itself.
    Checkpoint,
}

impl Step {
    fn dispatch(&self) -> Option<&Dispatch> {
        if let Self::Run(dispatch) = self { Some(dispatch) } else { None }
    }
}

/// The disparities and confidences of a whole view, laid out as the caller gets them. The buffers are only copied,
/// never bound, since they may exceed the binding size of kernels.
#[derive(Clone, Debug)]
pub(super) struct WholeMap {
    pub(super) disparities: wgpu::Buffer,
    pub(super) confidences: wgpu::Buffer,
}

/// What becomes of the maps of bands.
#[derive(Debug)]
pub(super) enum Kept {
    /// They go to the caller's outputs.
    Nowhere,
    /// The only one stays in the buffer of the matches, for later steps.
    InPlace,
    /// They are collected, for later steps.
    Whole(WholeMap),
}

/// The steps, and the memory that they share.
#[derive(Debug)]
pub(super) struct Plan {
    gpu: Gpu,
    steps: Vec<Step>,
    kept: Kept,
    /// Changes of brightness of the left and of the right view, as uniforms.
    brightness: [wgpu::Buffer; 2],
    pub(super) bytes: u64,
    /// Number of bands of rows.
    pub(super) bands: usize,
}

impl Plan {
    /// A plan without steps, for `bands` bands.
    pub(super) fn new(gpu: &Gpu, config: &DenseConfig, bands: usize) -> Self {
        let brightness = [Brightness::SAME, config.brightness].map(|change| uniform_buffer(gpu, "brightness", &change));
        Self { gpu: gpu.clone(), steps: Vec::new(), kept: Kept::Nowhere, brightness, bytes: 0, bands }
    }

    /// The change of a view's brightness: a [`Brightness`] in a uniform buffer, shared by all bands.
    pub(super) fn brightness(&self, view: View) -> wgpu::Buffer {
        let [left, right] = &self.brightness;
        if view == View::Left { left.clone() } else { right.clone() }
    }

    /// Allocates a storage buffer of `words` `u32`s, for the plan's lifetime.
    pub(super) fn buffer(&mut self, label: &'static str, words: u64) -> Result<wgpu::Buffer> {
        self.bytes += 4 * words;
        storage_buffer(&self.gpu, label, 4 * words)
    }

    pub(super) fn run(&mut self, dispatch: Dispatch) {
        self.steps.push(Step::Run(dispatch));
    }

    /// Allocates a texture of `words` `u32`s, for the plan's lifetime.
    pub(super) fn word_texture(&mut self, label: &'static str, words: u64) -> Result<WordTexture> {
        self.bytes += 4 * in_rows(words);
        WordTexture::new(&self.gpu, label, words)
    }

    /// Allocates a buffer and a texture of `words` `u32`s.
    pub(super) fn words(&mut self, label: &'static str, words: u64) -> Result<(wgpu::Buffer, WordTexture)> {
        Ok((self.buffer(label, words)?, self.word_texture(label, words)?))
    }

    /// Copies the first words of a buffer, which holds as many as the texture, to the texture.
    pub(super) fn fill_texture(&mut self, buffer: &wgpu::Buffer, texture: &WordTexture) {
        self.steps.push(Step::ToTexture(buffer.clone(), texture.clone()));
    }

    pub(super) fn clear(&mut self, buffer: &wgpu::Buffer) {
        self.steps.push(Step::Clear(buffer.clone()));
    }

    /// Ends a part of the plan, between which progress is seen.
    pub(super) fn checkpoint(&mut self) {
        self.steps.push(Step::Checkpoint);
    }

    pub(super) fn copy(&mut self, copy: WordCopy) {
        self.steps.push(Step::Copy(copy));
    }

    /// Keeps the maps of all bands, of a picture of this size, for later steps to read.
    pub(super) fn keep(&mut self, size: Size) -> Result<()> {
        if self.bands > 1 {
            return self.keep_whole(size);
        }
        self.kept = Kept::InPlace;
        Ok(())
    }

    /// [`Self::keep`] in buffers of their own.
    pub(super) fn keep_whole(&mut self, Size { width, height }: Size) -> Result<()> {
        let mut whole = |label, row: u32| {
            let bytes = 4 * u64::from(row) * u64::from(height);
            self.bytes += bytes;
            store(&self.gpu, label, bytes)
        };
        let disparities = whole("all disparities", width)?;
        let confidences = whole("all confidences", width.div_ceil(4))?;
        self.kept = Kept::Whole(WholeMap { disparities, confidences });
        Ok(())
    }

    /// The collected maps, for another plan; the memory of this one becomes free.
    pub(super) fn into_map(self) -> Option<WholeMap> {
        if let Kept::Whole(map) = self.kept { Some(map) } else { None }
    }

    /// Copies the map of a band of `rows` rows from `first_row` to where it is kept, or to the caller's outputs.
    pub(super) fn hand_out(&mut self, matches: MapBuffer<'_>, first_row: u32, rows: u32) {
        let (width, buffer) = (matches.layout.width, matches.buffer);
        let [disparities, confidences] = match &self.kept {
            Kept::InPlace => return,
            Kept::Nowhere => [CopyTarget::Disparities, CopyTarget::Confidences],
            Kept::Whole(WholeMap { disparities, confidences }) => {
                [disparities, confidences].map(|b| CopyTarget::Buffer(b.clone()))
            }
        };
        let confidence_offset = u64::from(matches.layout.confidence_offset());
        for (to, from_word, row_words) in
            [(disparities, 0, u64::from(width)), (confidences, confidence_offset, u64::from(width.div_ceil(4)))]
        {
            let (to_word, words) = (row_words * u64::from(first_row), row_words * u64::from(rows));
            self.copy(WordCopy { from: buffer.clone(), from_word, to, to_word, words });
        }
    }

    /// The copies to the caller's disparities, in order; together they cover every pixel once.
    pub(super) fn copies_of_disparities(&self) -> impl Iterator<Item = &WordCopy> {
        self.steps.iter().filter_map(|step| match step {
            Step::Copy(copy) if matches!(copy.to, CopyTarget::Disparities) => Some(copy),
            _ => None,
        })
    }

    /// The dispatches, in order.
    pub(super) fn dispatches(&self) -> impl Iterator<Item = &Dispatch> {
        self.steps.iter().filter_map(Step::dispatch)
    }

    /// Records all steps, and the timestamps of the kernels if there is a `stopwatch`.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, outputs: &Outputs, stopwatch: Option<&Stopwatch>) {
        Self::record_steps(&self.steps, encoder, outputs, stopwatch);
        outputs.record_back(encoder);
    }

    /// Submits the plan part by part, each when the one before is done, and calls `progress` with the share of the parts
    /// that are done, 0 to 1. Disparities go to a buffer.
    pub(super) async fn run_by_parts(&self, outputs: &Outputs, mut progress: impl FnMut(f32)) -> Result<()> {
        let is_checkpoint = |step: &Step| matches!(step, Step::Checkpoint);
        let done = Readback::new(&self.gpu, "a part is done", 4);
        let parts: Vec<_> = self.steps.split(is_checkpoint).filter(|steps| !steps.is_empty()).collect();
        for (number, steps) in (1..).zip(&parts) {
            guarded(&self.gpu, "dense matching", || {
                let mut encoder = self.gpu.encoder("dense");
                Self::record_steps(steps, &mut encoder, outputs, None);
                done.record(&mut encoder, &outputs.matcher);
                self.gpu.queue.submit([encoder.finish()]);
                Ok(())
            })
            .await?;
            done.read::<u32>(1).await?;
            progress(number as f32 / parts.len() as f32);
        }
        Ok(())
    }

    fn record_steps(
        steps: &[Step],
        encoder: &mut wgpu::CommandEncoder,
        outputs: &Outputs,
        stopwatch: Option<&Stopwatch>,
    ) {
        let (mut kernel, mut output) = (0, 0);
        // A run of dispatches is one pass, unless each is timed.
        let is_run =
            |one: &Step, next: &Step| matches!((one, next), (Step::Run(_), Step::Run(_))) && stopwatch.is_none();
        for run in steps.chunk_by(is_run) {
            match &run[0] {
                Step::Run(_) => {
                    let dispatches = run.iter().filter_map(Step::dispatch);
                    record_run(encoder, dispatches, stopwatch.and_then(|stopwatch| stopwatch.writes(kernel)));
                    kernel += 1;
                }
                Step::ToTexture(buffer, texture) => texture.record(encoder, buffer),
                Step::Clear(buffer) => encoder.clear_buffer(buffer, 0, None),
                Step::Checkpoint => {}
                Step::Copy(copy) => match &copy.to {
                    CopyTarget::Buffer(buffer) => copy.record(encoder, buffer),
                    CopyTarget::Disparities => {
                        outputs.record_disparities(encoder, copy, output);
                        output += 1;
                    }
                    CopyTarget::Confidences => outputs.record_confidences(encoder, copy),
                },
            }
        }
    }
}
