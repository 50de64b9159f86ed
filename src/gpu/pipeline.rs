//! The compute pipeline of a stage on one device: its layout at once, compiled when it is asked for.

use std::sync::OnceLock;

use super::{
    Gpu,
    stage::{Binding, Stage},
};

/// The compute pipeline of a stage, and the layout of its bind group.
///
/// Bind groups need the layout alone, so that a plan is made before anything is compiled; then [`super::guarded`]
/// compiles what the plan needs, side by side.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(super) stage: Stage,
    pub(super) layout: wgpu::BindGroupLayout,
    compiled: OnceLock<wgpu::ComputePipeline>,
}

impl Pipeline {
    /// Creates the layout for `stage`.
    pub(super) fn new(gpu: &Gpu, stage: Stage) -> Self {
        let entries: Vec<_> = (0..).zip(stage.bindings).map(|(binding, kind)| layout_entry(binding, *kind)).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(stage.name), entries: &entries };
        Self { layout: gpu.device.create_bind_group_layout(&descriptor), stage, compiled: OnceLock::new() }
    }

    /// The pipeline, compiled by the first call, for the entry point `main`.
    pub(super) fn compiled(&self, gpu: &Gpu) -> &wgpu::ComputePipeline {
        self.compiled.get_or_init(|| self.compile(gpu))
    }

    fn compile(&self, gpu: &Gpu) -> wgpu::ComputePipeline {
        let (device, label) = (&gpu.device, Some(self.stage.name));
        let text = if gpu.is_lavapipe() { self.stage.wgsl_for_lavapipe() } else { self.stage.wgsl() };
        #[cfg(not(target_arch = "wasm32"))]
        super::dump::dump(self.stage.name, &text);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&self.layout)],
            immediate_size: 0,
        });
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: gpu.cache.as_ref(),
        })
    }
}

fn layout_entry(binding: u32, kind: Binding) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let view_dimension = wgpu::TextureViewDimension::D2;
    let texture = |sample_type| wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
    let ty = match kind {
        Binding::Uniform(_) => buffer(wgpu::BufferBindingType::Uniform),
        Binding::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
        Binding::Write => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
        Binding::Words => wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::ReadOnly,
            format: wgpu::TextureFormat::R32Uint,
            view_dimension,
        },
        Binding::Picture => texture(wgpu::TextureSampleType::Float { filterable: false }),
        Binding::Map(format) => {
            wgpu::BindingType::StorageTexture { access: wgpu::StorageTextureAccess::WriteOnly, format, view_dimension }
        }
    };
    wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None }
}
