//! A kernel: WGSL text with its constants written in front, its bindings and its pipeline.

use super::{context::Context, imports::imported, limits::BUFFER_LIMITS, shader_struct::Shape, unroll::unrolled};
use crate::error::{Error, Result};

/// One binding of a kernel's only bind group, in the order of `@binding`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A uniform buffer that holds this.
    Uniform(Shape),
    /// A storage buffer that is only read.
    Read,
    /// A storage buffer that is written.
    Write,
    /// A storage texture of one `u32` a texel that is only read.
    Words,
    /// A texture of floats that is only read, and not sampled.
    Picture,
    /// A texture of this format that is only written.
    Map(wgpu::TextureFormat),
}

/// What is bound: a whole buffer, or a texture.
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

/// What a stage's kernel is made of; enough to build it, and to check it without any GPU.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The stage's name: that of its shader, its Rust file, its CPU twin and its test.
    pub name: &'static str,
    /// The shader's text, without its constants and its imports.
    pub source: &'static str,
    /// The buffers of bind group 0, in order.
    pub bindings: &'static [Binding],
    /// Constants that host and shader share; written in front of the text.
    pub constants: Vec<(&'static str, i64)>,
}

impl Stage {
    /// The whole module: the constants, the imported parts, the shader's text, with marked loops unrolled.
    pub fn wgsl(&self) -> String {
        let mut text = String::new();
        for (name, value) in &self.constants {
            text += &format!("const {name} = {value};\n");
        }
        text + &unrolled(&imported(self.source), &self.constants)
    }
}

/// A stage's compute pipeline on one device.
#[derive(Clone)]
pub(crate) struct Kernel {
    name: &'static str,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    /// Compiles `stage`, whose entry point is `main`.
    pub(crate) fn new(device: &Context<'_>, stage: &Stage) -> Self {
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
        let text = stage.wgsl();
        #[cfg(not(target_arch = "wasm32"))]
        super::dump::dump(stage.name, &text);
        let source = wgpu::ShaderSource::Wgsl(text.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
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
            cache: device.cache,
        });
        Self { name: stage.name, layout, pipeline }
    }

    /// Binds `bound`, in the order of the stage's bindings, for `groups` workgroups along x, y and z.
    pub(crate) fn dispatch<B: Bindable + ?Sized>(
        &self,
        device: &wgpu::Device,
        bound: &[&B],
        groups: [u32; 3],
    ) -> Dispatch {
        self.bind(device, bound, Groups::Known(groups))
    }

    /// As [`Self::dispatch`], for as many workgroups as the first three words of `groups` will say when the device
    /// gets there.
    pub(crate) fn dispatch_indirect<B: Bindable + ?Sized>(
        &self,
        device: &wgpu::Device,
        bound: &[&B],
        groups: &wgpu::Buffer,
    ) -> Dispatch {
        self.bind(device, bound, Groups::Indirect(groups.clone()))
    }

    fn bind<B: Bindable + ?Sized>(&self, device: &wgpu::Device, bound: &[&B], groups: Groups) -> Dispatch {
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, bound)| wgpu::BindGroupEntry { binding, resource: bound.resource() })
            .collect();
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.layout,
            entries: &entries,
        });
        Dispatch { kernel: self.clone(), bind_group, groups }
    }
}

/// A kernel with its buffers and its size: all that is left to do is to record it.
pub struct Dispatch {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    groups: Groups,
}

/// How many workgroups there are.
enum Groups {
    Known([u32; 3]),
    /// As three words of a buffer say.
    Indirect(wgpu::Buffer),
}

impl Dispatch {
    /// The kernel's name.
    pub(crate) fn name(&self) -> &'static str {
        self.kernel.name
    }

    /// Records it, in a pass of its own.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.record_timed(encoder, None);
    }

    /// The same, with the device's clock at the pass's beginning and end written where `timestamp_writes` says.
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

/// A storage buffer that a kernel fills or reads, and that can be copied from and to.
///
/// # Errors
/// [`Error::TooLarge`] where the device could not bind it.
pub(crate) fn storage_buffer(device: &wgpu::Device, label: &'static str, bytes: u64) -> Result<wgpu::Buffer> {
    let limits = device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    buffer_within(device, label, bytes, (limit, BUFFER_LIMITS), wgpu::BufferUsages::STORAGE)
}

/// A buffer that no kernel sees, for what may be more than one can bind.
///
/// # Errors
/// [`Error::TooLarge`].
pub(crate) fn store(device: &wgpu::Device, label: &'static str, bytes: u64) -> Result<wgpu::Buffer> {
    let limit = (device.limits().max_buffer_size, "max_buffer_size");
    buffer_within(device, label, bytes, limit, wgpu::BufferUsages::empty())
}

fn buffer_within(
    device: &wgpu::Device,
    label: &'static str,
    bytes: u64,
    (limit, of): (u64, &str),
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer> {
    if bytes > limit {
        return Err(Error::TooLarge {
            what: label.into(),
            needed: bytes,
            limit,
            way_out: format!("use a smaller picture, or a device with more of {of}"),
        });
    }
    Ok(device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        // An empty binding is refused by wgpu; a copy needs whole words.
        size: bytes.next_multiple_of(4).max(4),
        usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}

/// A uniform buffer that holds `params` from the start, so that recording writes nothing.
pub(crate) fn uniform_buffer<P: bytemuck::NoUninit>(
    device: &wgpu::Device,
    label: &'static str,
    params: &P,
) -> wgpu::Buffer {
    buffer_of(device, label, bytemuck::bytes_of(params), wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST)
}

/// A buffer that holds `contents`, whole words, from the start.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn buffer_of(
    device: &wgpu::Device,
    label: &'static str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let size = contents.len() as u64;
    let buffer =
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: true });
    // Where there is nothing to be written to, the device has said why: see `guarded`.
    if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
        view.copy_from_slice(contents);
    }
    buffer.unmap();
    buffer
}

/// The same. What is mapped from the start cannot be had on a lost device: `createBuffer` throws then, and wgpu panics.
/// What the queue writes comes before all that is submitted later.
#[cfg(target_arch = "wasm32")]
pub(crate) fn buffer_of(
    device: &wgpu::Device,
    label: &'static str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    let size = contents.len() as u64;
    let buffer =
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false });
    if let (Some(device), Some(to)) = (device.as_webgpu(), buffer.as_webgpu()) {
        // It throws only where the buffer is too small; everything else is told as `guarded` expects it.
        let _ = device.queue().write_buffer_with_u32_and_u8_slice(to, 0, contents);
    }
    buffer
}

/// Whether the device creates nothing any more, which it does not say by itself.
#[cfg(not(target_arch = "wasm32"))]
fn is_lost(device: &wgpu::Device) -> bool {
    let usage = wgpu::BufferUsages::COPY_SRC;
    let probe = wgpu::BufferDescriptor { label: Some("probe"), size: 4, usage, mapped_at_creation: true };
    device.create_buffer(&probe).get_mapped_range_mut(..).is_err()
}

/// The same. A browser creates as if nothing had happened, and says it only where results are to be read.
#[cfg(target_arch = "wasm32")]
fn is_lost(_: &wgpu::Device) -> bool {
    false
}

/// Runs `build`, which creates things on `device`, and turns what the device has to say about it
/// into an [`Error`] instead of a call of the application's error handler.
pub(crate) async fn guarded<T>(device: &wgpu::Device, what: &str, build: impl FnOnce() -> Result<T>) -> Result<T> {
    let ((built, lost), said) = scoped(device, || (build(), is_lost(device)));
    let mut errors = Vec::new();
    for error in said {
        errors.extend(error.await);
    }
    if errors.iter().any(|error| matches!(error, wgpu::Error::OutOfMemory { .. })) {
        return Err(Error::OutOfMemory(what.into()));
    }
    // Before what else is said then: it is about what was not created.
    if lost {
        return Err(Error::DeviceLost(format!("{what}: nothing can be created on it any more")));
    }
    match errors.into_iter().next() {
        Some(error) => Err(Error::Unsupported(format!("{what}: {error}"))),
        None => built,
    }
}

/// What `build` returns, and what the device will have to say. Whatever else happens before that is known lies outside
/// the scopes: they have ended.
fn scoped<T>(device: &wgpu::Device, build: impl FnOnce() -> T) -> (T, [impl Future<Output = Option<wgpu::Error>>; 3]) {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let built = build();
    (built, [internal.pop(), memory.pop(), validation.pop()])
}
