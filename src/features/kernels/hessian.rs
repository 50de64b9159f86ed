//! The determinant of the Hessian, by box filters of growing size over the integral image (Bay et
//! al. 2008, section 3.2). `shaders/features/hessian.wgsl`.

use crate::{
    features::FeatureConfig,
    gpu::{Bindable, Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

/// Layers per octave.
pub const LAYERS: u32 = 4;

/// Filter sides in pixels: four layers in each of five octaves (Bay et al. 2008, figure 8).
pub const FILTER_SIZES: [[u32; LAYERS as usize]; 5] =
    [[9, 15, 21, 27], [15, 27, 39, 51], [27, 51, 75, 99], [51, 99, 147, 195], [99, 195, 291, 387]];

/// The kernels' value of OpenSURF's determinant 1: OpenSURF works on grey values 0 to 1, the kernels on 1/256 grey
/// level, and a determinant is a product of two such values.
pub const DETERMINANT_SCALE: f64 = (256.0 * 255.0) * (256.0 * 255.0);

/// The weight 0.9 of Dxy by Bay et al., which balances box filters as Gaussians are.
const XY_WEIGHT: f64 = 0.9;

const WORKGROUP: [u32; 2] = [8, 8];

/// Points per thread, along a row and along a column, in a dense grid.
const WALK: [u32; 2] = [8, 4];

/// Layers whose filters the next finer octave has too.
const SHARED_LAYERS: u32 = 2;

/// The points at which an octave's filters are centred: every `step` pixels from pixel 0 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Distance of neighbouring points in pixels.
    pub step: u32,
    /// Columns of points.
    pub width: u32,
    /// Rows of points.
    pub height: u32,
}

impl Grid {
    /// The grid of `octave` in a picture of `size`, where octave 0 has this `step`.
    pub fn new(size: impl Into<Size>, step: u32, octave: u32) -> Self {
        let Size { width, height } = size.into();
        let step = step << octave;
        Self { step, width: width.div_ceil(step), height: height.div_ceil(step) }
    }
}

shader_struct! {
    struct Layer {
        lobe: u32,
        scale_xx: f32,
        scale_xy: f32,
        padding: u32,
    }
}

impl Layer {
    fn new(size: u32) -> Self {
        let scale = 256.0 / f64::from(size * size);
        Self { lobe: size / 3, scale_xx: scale as f32, scale_xy: (XY_WEIGHT * scale) as f32, padding: 0 }
    }
}

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        step: u32,
        grid_width: u32,
        grid_height: u32,
        finer_width: u32,
        finer_height: u32,
        shared_layers: u32,
        layers: [Layer; LAYERS as usize],
    }
}

/// The stage, for a grid with one point per pixel (`dense`) or for any other grid.
pub fn stage(dense: bool) -> Stage {
    Stage {
        name: "hessian",
        source: include_str!("../../../shaders/features/hessian.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
        constants: vec![
            ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
            ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
            ("DENSE", dense.into()),
            ("WALK", WALK[0].into()),
        ],
    }
}

/// The response kernels: one for dense grids, with one point per pixel, and one for all others.
#[derive(Debug)]
pub struct Hessian {
    dense: Option<Kernel>,
    coarse: Option<Kernel>,
    step: u32,
}

impl Hessian {
    /// Compiles the kernels that the octaves of `config` need.
    pub fn new(gpu: &Gpu, config: &FeatureConfig) -> Self {
        let kernel = |dense| Kernel::new(gpu, &stage(dense));
        Self {
            dense: (config.step == 1).then(|| kernel(true)),
            coarse: (config.step > 1 || config.octaves > 1).then(|| kernel(false)),
            step: config.step,
        }
    }

    /// Bytes of an octave's responses: [`LAYERS`] planes of the octave's [`Grid`].
    pub fn bytes(&self, Size { width, height }: Size, octave: u32) -> u64 {
        let grid = Grid::new((width, height), self.step, octave);
        4 * u64::from(LAYERS) * u64::from(grid.width) * u64::from(grid.height)
    }

    /// Filters the `integral` image of a picture. A response is `determinant << 1 | (trace > 0)`, or 0 where the filter
    /// does not fit in the picture. Layers shared with the next `finer` octave are copied from it.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        octave: u32,
        integral: &wgpu::Buffer,
        finer: Option<&wgpu::Buffer>,
        responses: &wgpu::Buffer,
    ) -> Dispatch {
        let sizes = FILTER_SIZES[octave as usize];
        let grid = Grid::new((width, height), self.step, octave);
        let finer_grid = finer.map(|_| Grid::new((width, height), self.step, octave - 1));
        let params = Params {
            width,
            height,
            step: grid.step,
            grid_width: grid.width,
            grid_height: grid.height,
            finer_width: finer_grid.map_or(0, |grid| grid.width),
            finer_height: finer_grid.map_or(0, |grid| grid.height),
            shared_layers: finer_grid.map_or(0, |_| SHARED_LAYERS),
            layers: sizes.map(Layer::new),
        };
        let (kernel, threads) = if grid.step == 1 {
            (&self.dense, [walkers(grid.width, WALK[0], sizes), walkers(grid.height, WALK[1], sizes)])
        } else {
            (&self.coarse, [grid.width, grid.height])
        };
        let groups = [threads[0].div_ceil(WORKGROUP[0]), threads[1].div_ceil(WORKGROUP[1]), LAYERS];
        // The first octave shares no layer; any buffer serves as its finer one.
        let bound: [&dyn Bindable; 3] = [integral, finer.unwrap_or(integral), responses];
        let kernel = kernel.as_ref().expect("a kernel for each octave of the configuration");
        kernel.dispatch(&params, &bound, groups)
    }
}

/// Threads along one side of a dense grid. A thread takes `each` points, one lobe apart, and starts in the first lobe
/// of a block of `each` lobes.
fn walkers(points: u32, each: u32, sizes: [u32; LAYERS as usize]) -> u32 {
    let threads = |size: u32| {
        let lobe = size / 3;
        points / (each * lobe) * lobe + (points % (each * lobe)).min(lobe)
    };
    sizes.into_iter().map(threads).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_covers_the_picture_from_pixel_0() {
        assert_eq!(Grid::new((741, 497), 1, 0), Grid { step: 1, width: 741, height: 497 });
        assert_eq!(Grid::new((741, 497), 2, 3), Grid { step: 16, width: 47, height: 32 });
        assert_eq!(Grid::new((1, 1), 2, 4), Grid { step: 32, width: 1, height: 1 });
    }

    #[test]
    fn walkers_reach_every_point() {
        for (points, each) in (1..300).flat_map(|points| WALK.map(|each| (points, each))) {
            let threads = walkers(points, each, FILTER_SIZES[0]);
            for lobe in FILTER_SIZES[0].map(|size| size / 3) {
                let first = |thread| thread / lobe * each * lobe + thread % lobe;
                let mut reached: Vec<_> =
                    (0..threads).flat_map(|thread| (0..each).map(move |n| first(thread) + n * lobe)).collect();
                reached.sort_unstable();
                reached.dedup();
                assert!((0..points).all(|p| reached.binary_search(&p).is_ok()), "{points} points, lobe {lobe}");
            }
        }
    }

    #[test]
    fn neighbouring_octaves_share_two_filters() {
        for pair in FILTER_SIZES.windows(2) {
            assert_eq!(pair[1][..SHARED_LAYERS as usize], [pair[0][1], pair[0][3]]);
        }
    }
}
