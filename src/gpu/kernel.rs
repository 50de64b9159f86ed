//! A compute pipeline per stage, and its dispatches.

use super::{
    Gpu,
    buffers::uniform_buffer,
    stage::{Binding, Stage},
};

/// A resource that can be bound: a whole buffer, or a texture view.
pub(crate) trait Bindable {
    fn resource(&self) -> wgpu::BindingResource<'_>;
}

impl Bindable for wgpu::Buffer {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        self.as_entire_binding()
    }
}

impl Bindable for wgpu::TextureView {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(self)
    }
}

/// The compute pipeline of a stage, on one device.
#[derive(Clone, Debug)]
pub(crate) struct Kernel {
    gpu: Gpu,
    name: &'static str,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    /// Compiles `stage`, whose entry point is `main`.
    pub(crate) fn new(gpu: &Gpu, stage: &Stage) -> Self {
        let device = &gpu.device;
        let label = Some(stage.name);
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let view_dimension = wgpu::TextureViewDimension::D2;
        let texture = |sample_type| wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false };
        let entries: Vec<_> = (0..)
            .zip(stage.bindings)
            .map(|(binding, kind)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: match kind {
                    Binding::Uniform(_) => buffer(wgpu::BufferBindingType::Uniform),
                    Binding::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
                    Binding::Write => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
                    Binding::Words => wgpu::BindingType::StorageTexture {
                        access: wgpu::StorageTextureAccess::ReadOnly,
                        format: wgpu::TextureFormat::R32Uint,
                        view_dimension,
                    },
                    Binding::Picture => texture(wgpu::TextureSampleType::Float { filterable: false }),
                    Binding::Map(format) => wgpu::BindingType::StorageTexture {
                        access: wgpu::StorageTextureAccess::WriteOnly,
                        format: *format,
                        view_dimension,
                    },
                },
                count: None,
            })
            .collect();
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let text = if gpu.is_lavapipe() { stage.wgsl_without_inlinable_uniforms() } else { stage.wgsl() };
        #[cfg(not(target_arch = "wasm32"))]
        super::dump::dump(stage.name, &text);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: gpu.cache.as_ref(),
        });
        Self { gpu: gpu.clone(), name: stage.name, layout, pipeline }
    }

    /// Prepares a dispatch of `groups` workgroups along x, y and z. Binds a uniform buffer of `params`, unless that is
    /// `()`, then `bound`, in the order of the stage's bindings.
    pub(crate) fn dispatch<P: bytemuck::NoUninit>(
        &self,
        params: &P,
        bound: &[&dyn Bindable],
        groups: [u32; 3],
    ) -> Dispatch {
        self.bind(params, bound, Groups::Known(groups))
    }

    /// Prepares an indirect dispatch: as [`Self::dispatch`], with the number of workgroups read from the first three
    /// `u32`s of `groups` when the device runs it.
    pub(crate) fn dispatch_indirect<P: bytemuck::NoUninit>(
        &self,
        params: &P,
        bound: &[&dyn Bindable],
        groups: &wgpu::Buffer,
    ) -> Dispatch {
        self.bind(params, bound, Groups::Indirect(groups.clone()))
    }

    fn bind<P: bytemuck::NoUninit>(&self, params: &P, bound: &[&dyn Bindable], groups: Groups) -> Dispatch {
        let uniform = (size_of::<P>() > 0).then(|| uniform_buffer(&self.gpu, self.name, params));
        let resources = uniform.iter().map(Bindable::resource).chain(bound.iter().map(|bound| bound.resource()));
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let bind_group = self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.layout,
            entries: &entries,
        });
        Dispatch { kernel: self.clone(), bind_group, groups }
    }
}

/// A kernel with its bind group and number of workgroups, ready to be recorded.
#[derive(Debug)]
pub struct Dispatch {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    groups: Groups,
}

/// The number of workgroups of a dispatch, along x, y and z.
#[derive(Debug)]
enum Groups {
    Known([u32; 3]),
    /// The first three `u32`s of a buffer.
    Indirect(wgpu::Buffer),
}

impl Dispatch {
    /// The kernel's name.
    pub(crate) fn name(&self) -> &'static str {
        self.kernel.name
    }

    /// Records the dispatch, in a compute pass of its own.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.record_timed(encoder, None);
    }

    /// Records the dispatch, with timestamps at the beginning and the end of its pass.
    pub(crate) fn record_timed(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let label = Some(self.kernel.name);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label, timestamp_writes });
        pass.set_pipeline(&self.kernel.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        match &self.groups {
            Groups::Known([x, y, z]) => pass.dispatch_workgroups(*x, *y, *z),
            Groups::Indirect(groups) => pass.dispatch_workgroups_indirect(groups, 0),
        }
    }
}
