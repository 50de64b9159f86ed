//! A case: a preset at a size, over a number of disparities.

use std::time::{Duration, Instant};

use hsad::{
    Preset, Size,
    dense::Matcher,
    disparity::DisparityRange,
    gpu::{Gpu, block_on},
    image::Luma,
    luma::pack,
    verify::MAX_SIDE,
};

use super::figures::Figures;

/// The views of a scene, and its largest disparity.
pub type Scene = ([Luma; 2], f32);

/// What is measured.
#[derive(Clone, Copy)]
pub struct Case {
    pub preset: Preset,
    pub size: Size,
    pub range: DisparityRange,
}

impl Case {
    /// Checks the case before anything is measured.
    pub fn new(preset: Preset, size: Size, disparities: u32) -> hsad::Result<Self> {
        if !(1..=MAX_SIDE).contains(&size.width) || !(1..=MAX_SIDE).contains(&size.height) {
            return Err(hsad::Error::Parameter {
                name: "--size",
                value: size.to_string(),
                expected: format!("each side must be 1 to {MAX_SIDE} px"),
            });
        }
        let range = DisparityRange::new(0, disparities)?;
        preset.dense_config(range).validate()?;
        Ok(Self { preset, size, range })
    }

    /// The name of the case in tables.
    pub fn name(&self) -> String {
        format!("{} {} {}", self.preset, self.size, self.range.count)
    }

    /// A matcher with the views of `scene`, enlarged or repeated to the size.
    pub fn matcher(&self, gpu: &Gpu, (views, largest): &Scene) -> hsad::Result<Matcher> {
        let matcher = Matcher::new(gpu, self.size, &self.preset.dense_config(self.range))?;
        let width = views[0].width();
        let scale = f64::from(self.size.width) / f64::from(width);
        let scale = scale.min(f64::from(self.range.last()) / f64::from(*largest)).max(0.1);
        for (view, luma) in views.iter().zip(matcher.luma()) {
            gpu.queue.write_buffer(luma, 0, bytemuck::cast_slice(&pack(&repeated(view, scale, self.size))));
        }
        Ok(matcher)
    }

    /// Measures a first run and `runs` others.
    pub fn measure(self, gpu: &Gpu, scene: &Scene, runs: u32) -> hsad::Result<Figures> {
        let start = Instant::now();
        let matcher = self.matcher(gpu, scene)?;
        let run = || {
            let start = Instant::now();
            matcher.run().map(|_| start.elapsed())
        };
        run()?;
        let cold = start.elapsed();
        let mut warm = (0..runs).map(|_| run()).collect::<hsad::Result<Vec<_>>>()?;
        warm.sort();
        let kernels = least_times(&matcher, runs)?;
        Ok(Figures { memory: matcher.memory(), dispatches: matcher.dispatches(), case: self, cold, warm, kernels })
    }
}

/// The least time of each kernel over `runs` runs, in the order of execution; `None` without timestamps, by which the device tells
/// times of kernels.
fn least_times(matcher: &Matcher, runs: u32) -> hsad::Result<Option<Vec<(&'static str, Duration)>>> {
    let mut least = match block_on(matcher.profile()) {
        Ok((_, times)) => times,
        Err(hsad::Error::Unsupported(_)) => return Ok(None),
        Err(error) => return Err(error),
    };
    for _ in 1..runs {
        let (_, times) = block_on(matcher.profile())?;
        least.iter_mut().zip(times).for_each(|(least, time)| least.1 = least.1.min(time.1));
    }
    Ok(Some(least))
}

/// A view enlarged by `scale` and repeated to a picture of `size`: of each pixel the nearest one.
fn repeated(view: &Luma, scale: f64, size: Size) -> Luma {
    let at = |place: u32, length: u32| (f64::from(place) / scale) as u32 % length;
    Luma::from_fn(size, |x, y| view.get(at(x, view.width()), at(y, view.height())))
}
