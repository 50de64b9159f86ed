//! Disparities inside a frame of an application's renderer: two pictures in textures, their disparities in a texture,
//! drawn, all in one encoder and one submission, on the application's own device.
//!
//!     cargo run --example embed -- frame.png [LEFT RIGHT]
//!
//! writes the left picture and its disparities side by side. With a window, the frame would be presented instead of
//! read back.
#![expect(clippy::print_stderr, reason = "it prints errors")]

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use hsad::{
    config::Preset,
    dense::{Destination, Matcher},
    disparity::DisparityRange,
    gpu::Gpu,
    image::Size,
    io::{Picture, atomic, load, png},
    luma::Source,
    wgpu::{self, TextureFormat, TextureUsages},
};

type AnyError = Box<dyn std::error::Error>;

/// The application's device.
struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

impl Renderer {
    async fn new() -> Result<Self, AnyError> {
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

    fn texture(&self, Size { width, height }: Size, format: TextureFormat, usage: TextureUsages) -> wgpu::Texture {
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
    fn upload(&self, picture: &Picture) -> wgpu::Texture {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let texture = self.texture(picture.size(), TextureFormat::Rgba8UnormSrgb, usage);
        let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * picture.width()), ..Default::default() };
        self.queue.write_texture(texture.as_image_copy(), picture.rgba(), layout, texture.size());
        texture
    }

    /// Pipeline and bind group that draw two textures side by side.
    fn drawing(
        &self,
        textures: [&wgpu::TextureView; 2],
        format: TextureFormat,
    ) -> (wgpu::RenderPipeline, wgpu::BindGroup) {
        let module = self.device.create_shader_module(wgpu::include_wgsl!("draw.wgsl"));
        let entry = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                // Not every device can filter 32-bit floats.
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let entries = [entry(0), entry(1)];
        let layout =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("draw"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("color"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(format.into())],
            }),
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            multiview_mask: None,
            cache: None,
        });
        let resource = wgpu::BindingResource::TextureView;
        let entries = [0, 1].map(|i| wgpu::BindGroupEntry { binding: i, resource: resource(textures[i as usize]) });
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries };
        (pipeline, self.device.create_bind_group(&descriptor))
    }

    /// Reads the colours of a frame, after all submitted work is done.
    fn read_back(&self, frame: &wgpu::Texture) -> Result<hsad::image::Plane<[u8; 3]>, AnyError> {
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
        Ok(hsad::image::Plane::from_fn((width, height), |x, y| {
            let at = (y * row + 4 * x) as usize;
            [bytes[at], bytes[at + 1], bytes[at + 2]]
        }))
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), AnyError> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved");
    let (out, paths) = match &arguments[..] {
        [out] => (out, [scene.join("left.png"), scene.join("right.png")]),
        [out, left, right] => (out, [left.clone(), right.clone()]),
        _ => return Err("usage: embed FRAME.png [LEFT RIGHT]".into()),
    };
    let renderer = pollster::block_on(Renderer::new())?;
    let device = &renderer.device;
    let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());

    // The renderer's own resources: two pictures in textures, and a target.
    let pictures = [load::load(&paths[0])?, load::load(&paths[1])?];
    let size = pictures[0].size();
    let widest = device.limits().max_texture_dimension_2d / 2;
    if size.width.max(size.height) > widest {
        return Err(
            format!("the pictures have {}x{} pixels, and a side can have {widest}", size.width, size.height).into()
        );
    }
    let [left, right] = pictures.each_ref().map(|picture| view(&renderer.upload(picture)));
    let target = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
    let frame = renderer.texture(Size::new(2 * size.width, size.height), TextureFormat::Rgba8UnormSrgb, target);
    let map = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
    let disparities = view(&renderer.texture(size, TextureFormat::R32Float, map));

    // Once per size: kernels, memory, inputs and outputs.
    let config = Preset::Balanced.dense_config(DisparityRange::new(0, 64)?);
    let gpu = Gpu::new(renderer.device.clone(), renderer.queue.clone());
    let matcher = Matcher::new(&gpu, size, &config)?;
    let inputs = matcher.inputs(Source::Texture(&left), Source::Texture(&right))?;
    let outputs = matcher.outputs(Destination::Texture(&disparities), None)?;
    let (pipeline, textures) = renderer.drawing([&left, &disparities], frame.format());

    // Once per frame.
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
    matcher.record(&mut encoder, &inputs, &outputs);
    let target = view(&frame);
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("draw"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        })],
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &textures, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    renderer.queue.submit([encoder.finish()]);

    let colors = renderer.read_back(&frame)?;
    atomic::write_whole(out, |file| png::write_rgb8(file, &colors))?;
    Ok(())
}
