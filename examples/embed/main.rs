//! Disparities inside a frame of an application's renderer: two pictures in textures, their disparities in a texture,
//! drawn, all in one encoder and one submission, on the application's own device.
//!
//!     cargo run --example embed -- frame.png [LEFT RIGHT]
//!
//! writes the left picture and its disparities side by side. With a window, the frame would be presented instead of
//! read back.
#![expect(clippy::print_stderr, reason = "it prints errors")]

mod renderer;

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
    io::{atomic, load, png},
    luma::Source,
    wgpu::{self, TextureFormat, TextureUsages},
};
use renderer::{AnyError, Renderer};

/// Pipeline and bind group that draw two textures side by side.
fn drawing(
    device: &wgpu::Device,
    textures: [&wgpu::TextureView; 2],
    format: TextureFormat,
) -> (wgpu::RenderPipeline, wgpu::BindGroup) {
    let module = device.create_shader_module(wgpu::include_wgsl!("draw.wgsl"));
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
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
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
    (pipeline, device.create_bind_group(&descriptor))
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
    let (pipeline, textures) = drawing(device, [&left, &disparities], frame.format());

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
