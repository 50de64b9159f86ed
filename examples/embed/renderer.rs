//! The renderer of the examples: a device of its own, textures, and frames read back.

use hsad::{
    image::{Plane, Size},
    io::Picture,
    wgpu::{self, TextureFormat, TextureUsages},
};

pub type AnyError = Box<dyn std::error::Error>;

/// The application's device.
pub struct Renderer {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

impl Renderer {
    pub async fn new() -> Result<Self, AnyError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default()).await?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("renderer"),
            // hsad needs these limits and no features. Larger pictures need larger limits, here for the frame's width.
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d,
                ..wgpu::Limits::downlevel_defaults()
            },
            ..Default::default()
        };
        let (device, queue) = adapter.request_device(&descriptor).await?;
        Ok(Self { device, queue })
    }

    pub fn texture(&self, Size { width, height }: Size, format: TextureFormat, usage: TextureUsages) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// Uploads a picture to an sRGB texture, as renderers do.
    pub fn upload(&self, picture: &Picture) -> wgpu::Texture {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let texture = self.texture(picture.size(), TextureFormat::Rgba8UnormSrgb, usage);
        let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * picture.width()), ..Default::default() };
        self.queue.write_texture(texture.as_image_copy(), picture.rgba(), layout, texture.size());
        texture
    }

    /// Reads the colours of a frame, after all submitted work is done.
    pub fn read_back(&self, frame: &wgpu::Texture) -> Result<Plane<[u8; 3]>, AnyError> {
        let (width, height) = (frame.width(), frame.height());
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(row), ..Default::default() };
        let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(frame.as_image_copy(), to, frame.size());
        self.queue.submit([encoder.finish()]);
        // An error of the mapping is reported by `get_mapped_range` below.
        buffer.map_async(wgpu::MapMode::Read, .., |_| ());
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        let bytes = buffer.get_mapped_range(..)?;
        Ok(Plane::from_fn((width, height), |x, y| {
            let at = (y * row + 4 * x) as usize;
            [bytes[at], bytes[at + 1], bytes[at + 2]]
        }))
    }
}
