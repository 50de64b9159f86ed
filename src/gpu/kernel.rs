//! The kernel of a stage, and its dispatches.

use std::sync::Arc;

use super::{Gpu, buffers::uniform_buffer, pipeline::Pipeline, pipelines::pipeline_of, stage::Stage};

/// A resource that can be bound: a whole buffer, or a texture view.
pub(crate) trait Bindable {
    fn resource(&self) -> wgpu::BindingResource<'_>;

    /// Size of the resource in bytes; of a texture, without other mip levels.
    fn bytes(&self) -> u64;
}

impl Bindable for wgpu::Buffer {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        self.as_entire_binding()
    }

    fn bytes(&self) -> u64 {
        self.size()
    }
}

impl Bindable for wgpu::TextureView {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(self)
    }

    fn bytes(&self) -> u64 {
        let texture = self.texture();
        let texel = texture.format().block_copy_size(None).unwrap_or(0);
        u64::from(texture.width()) * u64::from(texture.height()) * u64::from(texel)
    }
}

/// A stage on one device.
#[derive(Clone, Debug)]
pub(crate) struct Kernel {
    gpu: Gpu,
    pipeline: Arc<Pipeline>,
}

impl Kernel {
    /// The kernel of `stage`, whose entry point is `main`. The compiled one, if the device has it; else a new one, which
    /// [`super::guarded`] compiles.
    pub(crate) fn new(gpu: &Gpu, stage: &Stage) -> Self {
        Self { gpu: gpu.clone(), pipeline: pipeline_of(gpu, stage) }
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
        let uniform = (size_of::<P>() > 0).then(|| uniform_buffer(&self.gpu, self.name(), params));
        let resources = uniform.iter().map(Bindable::resource).chain(bound.iter().map(|bound| bound.resource()));
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let bind_group = self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name()),
            layout: &self.pipeline.layout,
            entries: &entries,
        });
        let bytes = bound.iter().map(|bound| bound.bytes()).sum();
        Dispatch { kernel: self.clone(), bind_group, groups, bytes, operations: None }
    }

    fn name(&self) -> &'static str {
        self.pipeline.stage.name
    }
}

/// A kernel with its bind group and number of workgroups, ready to be recorded.
#[derive(Debug)]
pub struct Dispatch {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    groups: Groups,
    bytes: u64,
    operations: Option<u64>,
}

/// A dispatch in figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DispatchSize {
    /// The kernel's name.
    pub kernel: &'static str,
    /// Threads; `None` where the device alone knows the number of workgroups.
    pub threads: Option<u64>,
    /// Bytes that are read and written at least, if nothing stays in caches: each bound resource once, but of a volume of path costs
    /// what the dispatch follows, and matching costs once per path.
    pub bytes: u64,
    /// Additions, minima, comparisons and bit operations of 32 bits that the equations ask for, at least, where there are some per pixel
    /// and disparity; counted in the equations, not in the code that a compiler makes.
    pub operations: Option<u64>,
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
        self.kernel.name()
    }

    /// States the bytes that are read and written, where that is not each bound resource once.
    pub(crate) fn moving(self, bytes: u64) -> Self {
        Self { bytes, ..self }
    }

    /// States the operations that the equations ask for.
    pub(crate) fn counting(self, operations: u64) -> Self {
        Self { operations: Some(operations), ..self }
    }

    /// The dispatch in figures.
    pub(crate) fn size(&self) -> DispatchSize {
        let workgroup = u64::from(self.kernel.pipeline.stage.workgroup());
        let threads = match &self.groups {
            Groups::Known(groups) => Some(groups.iter().map(|&side| u64::from(side)).product::<u64>() * workgroup),
            Groups::Indirect(_) => None,
        };
        DispatchSize { kernel: self.name(), threads, bytes: self.bytes, operations: self.operations }
    }

    /// Records the dispatch, in a compute pass of its own.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        record_run(encoder, [self], None);
    }

    /// Records the dispatch without any workgroup: drivers compile the kernel, and nothing runs.
    pub(super) fn record_empty(&self, encoder: &mut wgpu::CommandEncoder) {
        let descriptor = wgpu::ComputePassDescriptor { label: Some(self.name()), timestamp_writes: None };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        self.bind_to(&mut pass);
        pass.dispatch_workgroups(0, 0, 0);
    }

    fn bind_to(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(self.kernel.pipeline.compiled(&self.kernel.gpu));
        pass.set_bind_group(0, &self.bind_group, &[]);
    }
}

/// Records `dispatches` one after the other in one compute pass, with timestamps at its beginning and its end. Each sees what
/// those before it have written.
pub(crate) fn record_run<'d>(
    encoder: &mut wgpu::CommandEncoder,
    dispatches: impl IntoIterator<Item = &'d Dispatch>,
    timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("hsad"), timestamp_writes });
    for dispatch in dispatches {
        dispatch.bind_to(&mut pass);
        match &dispatch.groups {
            Groups::Known([x, y, z]) => pass.dispatch_workgroups(*x, *y, *z),
            Groups::Indirect(groups) => pass.dispatch_workgroups_indirect(groups, 0),
        }
    }
}
