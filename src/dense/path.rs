//! A path of semi-global matching. `shaders/path.wgsl`.

use super::{band::VolumeBand, cost::MAX_COST};
use crate::{
    error::{Error, Result},
    gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, uniform_buffer},
};

const WORKGROUP: u32 = 16;

/// What changes of the disparity along a path cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Penalties {
    /// A change by one.
    pub p1: u32,
    /// A larger one where the luma stays the same, at most 128.
    pub p2: u32,
    /// A larger one where the luma changes, at least: `p1` to `p2`.
    pub least_p2: u32,
    /// The change of luma that halves `p2`, 1 to 255.
    pub p2_scale: u32,
}

impl Penalties {
    /// With these a path leaves all costs as they are: changes cost nothing, so that the best way to a pixel takes away what
    /// it adds.
    pub const NONE: Self = Self { p1: 0, p2: 0, least_p2: 0, p2_scale: 1 };

    /// The penalty for a jump where the luma changes by `change`: `p2 scale / (scale + change)`, rounded
    /// down, or the least.
    pub fn p2_at(&self, change: u32) -> u32 {
        (self.p2 * self.p2_scale / (self.p2_scale + change)).max(self.least_p2)
    }

    /// Refuses what would not fit in the volumes' eight bits.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the rule.
    pub fn validate(&self) -> Result<()> {
        let check = |name, value: u32, range: std::ops::RangeInclusive<u32>| {
            if range.contains(&value) {
                return Ok(());
            }
            let expected = format!("it must be {} to {}", range.start(), range.end());
            Err(Error::Parameter { name, value: value.to_string(), expected })
        };
        check("P2", self.p2, 1..=255 - MAX_COST)?;
        check("the least P2", self.least_p2, 1..=self.p2)?;
        check("P1", self.p1, 0..=self.least_p2)?;
        check("the scale of P2", self.p2_scale, 1..=255)
    }
}

/// From where to where a path goes: to the next column and row, each -1, 0 or 1, not both 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction {
    /// Columns a pixel.
    pub dx: i32,
    /// Rows a pixel.
    pub dy: i32,
}

impl Direction {
    /// Along the rows and the columns first, then aslant: those of the first three, the first four or of all eight are used.
    pub const ALL: [Self; 8] = {
        const fn d(dx: i32, dy: i32) -> Direction {
            Direction { dx, dy }
        }
        [d(-1, 0), d(1, 0), d(0, 1), d(0, -1), d(1, 1), d(-1, -1), d(1, -1), d(-1, 1)]
    };
}

shader_struct! {
    /// The uniforms of all kernels that follow lines: `shaders/shared/line.wgsl`.
    pub(super) struct Params {
        pub(super) width: u32,
        pub(super) rows: u32,
        pub(super) first_row: u32,
        pub(super) path_start: u32,
        pub(super) goes_on: u32,
        pub(super) dx: i32,
        pub(super) dy: i32,
        pub(super) volumes_start: u32,
        pub(super) volume_words: u32,
        pub(super) min_disparity: i32,
        pub(super) disparities: u32,
        pub(super) uniqueness: u32,
        pub(super) confidence_offset: u32,
        pub(super) key_offset: u32,
    }
}

impl Params {
    /// For a path through `band`, whose costs stand from word `start` of the paths on; with `goes_on` the row
    /// before the band in the path's direction holds where lines come from. What concerns a selection is 0.
    pub(super) fn new(band: &VolumeBand, direction: Direction, start: u32, goes_on: bool) -> Self {
        Self {
            width: band.width,
            rows: band.rows,
            first_row: band.first_row,
            path_start: start,
            goes_on: goes_on.into(),
            dx: direction.dx,
            dy: direction.dy,
            min_disparity: band.range.min,
            disparities: band.range.count,
            ..bytemuck::Zeroable::zeroed()
        }
    }

    /// Workgroups of a kernel with a line a thread.
    pub(super) fn groups(&self) -> [u32; 3] {
        let lines = if self.dy == 0 { self.rows } else { self.width };
        [lines.div_ceil(WORKGROUP), 1, 1]
    }
}

/// The constants of all kernels that follow lines.
pub(super) fn line_constants(penalties: &Penalties, words: u32) -> Vec<(&'static str, i64)> {
    vec![
        ("WORKGROUP", WORKGROUP.into()),
        ("WORDS", words.into()),
        ("P1", penalties.p1.into()),
        ("P2", penalties.p2.into()),
        ("LEAST_P2", penalties.least_p2.into()),
        ("P2_SCALE", penalties.p2_scale.into()),
    ]
}

/// The kernel of a path, for one number of disparities.
pub struct Path(Kernel);

impl Path {
    /// What the kernel is made of, for `words` words a pixel.
    pub fn stage(penalties: &Penalties, words: u32) -> Stage {
        Stage {
            name: "path",
            source: concat!(
                include_str!("../../shaders/shared/quotient.wgsl"),
                include_str!("../../shaders/shared/line.wgsl"),
                include_str!("../../shaders/path.wgsl")
            ),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: line_constants(penalties, words),
        }
    }

    /// Compiles it.
    pub fn new(device: &Context<'_>, penalties: &Penalties, words: u32) -> Self {
        Self(Kernel::new(device, &Self::stage(penalties, words)))
    }

    /// Follows all lines of a direction through a band of `costs`. The path's costs stand from word `start` of `paths` on;
    /// with `goes_on` the row before it in the path's direction holds where lines come from.
    #[expect(clippy::too_many_arguments, reason = "three buffers, each of one kind, and places in them")]
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        band: &VolumeBand,
        direction: Direction,
        reference: &wgpu::Buffer,
        costs: &wgpu::Buffer,
        paths: &wgpu::Buffer,
        start: u32,
        goes_on: bool,
    ) -> Dispatch {
        let params = Params::new(band, direction, start, goes_on);
        let uniforms = uniform_buffer(device, "path", &params);
        self.0.dispatch(device, &[&uniforms, reference, costs, paths], params.groups())
    }
}
