//! Left-right consistency. `shaders/dense/consistency.wgsl`.

use crate::{
    dense::config::{SUM_INDEX_BITS, View},
    disparity::{NONE, SCALE},
    gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, uniform_buffer},
};

const WORKGROUP: [u32; 2] = [32, 8];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        direction: i32,
        max_difference: u32,
        confidence_offset: u32,
        min_disparity: i32,
    }
}

/// What is known of the other view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Others {
    /// A fixed-point disparity a pixel.
    Disparities,
    /// The claims of [`super::Claim`], where index 0 is this disparity.
    Claims(i32),
}

/// The left-right consistency kernel.
pub struct Consistency {
    kernel: Kernel,
    others: Others,
}

impl Consistency {
    /// What the kernel is made of.
    pub fn stage(others: Others) -> Stage {
        Stage {
            name: "consistency",
            source: include_str!("../../../shaders/dense/consistency.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("SCALE", SCALE.into()),
                ("SCALE_BITS", SCALE.ilog2().into()),
                ("NONE", NONE.into()),
                ("CLAIMS", (others != Others::Disparities).into()),
                ("INDEX_BITS", SUM_INDEX_BITS.into()),
            ],
        }
    }

    /// Compiles it.
    pub fn new(device: &Context<'_>, others: Others) -> Self {
        Self { kernel: Kernel::new(device, &Self::stage(others)), others }
    }

    /// Takes away from `matches` of `view` (`width` x `rows` disparities, and from word
    /// `confidence_offset` on as many confidences, four a word and each row in words of its own) what the other view's disparities contradict by
    /// more than `max_difference` / 256 px.
    #[expect(clippy::too_many_arguments, reason = "four sizes and two buffers, each of one kind")]
    pub fn prepare(
        &self,
        device: &wgpu::Device,
        (width, rows): (u32, u32),
        confidence_offset: u32,
        view: View,
        max_difference: u32,
        others: &wgpu::Buffer,
        matches: &wgpu::Buffer,
    ) -> Dispatch {
        let min_disparity = match self.others {
            Others::Disparities => 0,
            Others::Claims(min_disparity) => min_disparity,
        };
        let direction = view.direction();
        let params = Params { width, rows, direction, max_difference, confidence_offset, min_disparity };
        let params = uniform_buffer(device, "consistency", &params);
        let groups = [width.div_ceil(4 * WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.kernel.dispatch(device, &[&params, others, matches], groups)
    }
}
