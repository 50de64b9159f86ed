//! An application with its own device, whose error handler takes every uncaptured error for a failure.

use std::sync::{Arc, Mutex, OnceLock};

use hsad::{
    dense::DenseConfig,
    disparity::DisparityRange,
    gpu::Gpu,
    image::{Luma, Size},
    verify::{Bench, smooth_noise},
    wgpu::{self, Features, Limits, TextureFormat, TextureUsages},
};

pub struct Application {
    pub gpu: Gpu,
    unhandled: Arc<Mutex<Vec<String>>>,
}

impl Application {
    pub fn new() -> Self {
        Self::with(Features::empty(), Limits::downlevel_defaults())
    }

    pub fn with(required_features: Features, required_limits: Limits) -> Self {
        // One instance for all tests: resources of another instance cannot be told from one's own.
        static INSTANCE: OnceLock<wgpu::Instance> = OnceLock::new();
        let instance =
            INSTANCE.get_or_init(|| wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle()));
        Self::on(instance, required_features, required_limits)
    }

    pub fn of_instance(instance: &wgpu::Instance) -> Self {
        Self::on(instance, Features::empty(), Limits::downlevel_defaults())
    }

    fn on(instance: &wgpu::Instance, required_features: Features, required_limits: Limits) -> Self {
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        let adapter = adapter.expect("these tests need a device; lavapipe is one");
        let descriptor = wgpu::DeviceDescriptor { required_features, required_limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        let unhandled = Arc::new(Mutex::new(Vec::new()));
        let list = unhandled.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| list.lock().unwrap().push(error.to_string())));
        Self { gpu: Gpu::new(device, queue), unhandled }
    }

    pub fn device(&self) -> &wgpu::Device {
        &self.gpu.device
    }

    pub fn bench(&self) -> Bench<'_> {
        Bench::new(&self.gpu)
    }

    pub fn buffer(&self, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device().create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    }

    /// A view of an empty texture that allows `view_formats`.
    pub fn texture(
        &self,
        format: TextureFormat,
        Size { width, height }: Size,
        usage: TextureUsages,
        view_formats: &[TextureFormat],
    ) -> wgpu::TextureView {
        let texture = self.device().create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats,
        });
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Asserts that no uncaptured error reached the application.
    #[track_caller]
    pub fn assert_quiet(&self) {
        assert_eq!(*self.unhandled.lock().unwrap(), [""; 0]);
    }
}

/// A left and a right view, shifted by 5 px at the top and by more further down.
pub fn pair(Size { width, height }: Size, seed: u32) -> [Luma; 2] {
    let right = smooth_noise((width, height), seed);
    let left =
        Luma::from_fn((width, height), |x, y| right.get_clamped(i64::from(x) - 5 - i64::from(y / 16), i64::from(y)));
    [left, right]
}

pub fn config() -> DenseConfig {
    DenseConfig::new(DisparityRange::new(0, 24).unwrap()).with(|parameters| parameters.consistency = Some(256))
}

/// The handler must see an error that is provoked.
#[test]
#[should_panic(expected = "Buffer size")]
fn an_error_that_nobody_handles_is_seen() {
    let application = Application::new();
    application.buffer(u64::MAX / 2, wgpu::BufferUsages::STORAGE);
    application.assert_quiet();
}
