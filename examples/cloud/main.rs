//! A turning cloud inside a frame of an application's renderer: a pair in textures is matched, its points go to a vertex buffer, and an
//! indirect draw shows them from several sides, all in one encoder and one submission. Nothing is copied to the host.
//!
//!     cargo run --example cloud -- frame.png [LEFT RIGHT FOCAL BASELINE]
//!
//! writes the views side by side; the focal length is in px, the baseline in metres. With a window, there would be one per frame.
#![expect(clippy::print_stderr, reason = "it prints errors")]

#[path = "../embed/renderer.rs"]
mod renderer;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use hsad::{
    config::Preset,
    dense::{Destination, MapSources, Matcher, PointCloud, PointDraw, Reprojection},
    disparity::DisparityRange,
    gpu::{Gpu, block_on},
    image::Size,
    io::{Calibration, atomic, load, ply::PointFilter, png},
    luma::Source,
    wgpu::{self, TextureFormat, TextureUsages, util::DeviceExt},
};
use renderer::{AnyError, Renderer};

/// Turns of the views, in degrees.
const TURNS: [f32; 3] = [0.0, 12.0, -12.0];

/// The uniforms of `draw.wgsl`: nine floats and what rounds their size up.
type View = [f32; 12];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The frame's file, the pair and its geometry, by the arguments.
fn arguments() -> Result<(PathBuf, [PathBuf; 2], [f64; 3]), AnyError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved");
    match &arguments[..] {
        // The geometry of the scene: `data/curved/meta.json`.
        [out] => Ok((out.into(), ["left.png", "right.png"].map(|name| scene.join(name)), [388.0, 0.095, 11.0])),
        [out, left, right, focal, baseline] => {
            Ok((out.into(), [left.into(), right.into()], [focal.parse()?, baseline.parse()?, 0.0]))
        }
        _ => Err("usage: cloud FRAME.png [LEFT RIGHT FOCAL BASELINE]".into()),
    }
}

/// What draws the cloud: a pipeline whose vertex buffer steps per point.
fn pipeline(device: &wgpu::Device, format: TextureFormat) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("draw.wgsl"));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("points"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: PointCloud::STRIDE,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &PointCloud::ATTRIBUTES,
            })],
        },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("colour"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.into())],
        }),
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        multiview_mask: None,
        cache: None,
    })
}

/// The uniforms of a camera that is turned by `degrees` around the point `pivot` metres in front of the first one.
fn view(degrees: f32, pivot: f32, calibration: &Calibration, size: Size) -> View {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let half = [size.width, size.height].map(|side| side as f32 / 2.0);
    let focal = calibration.focal as f32;
    let [cx, cy] = [calibration.cx, calibration.cy].map(|centre| centre as f32 + 0.5);
    [
        cosine,
        sine,
        pivot,
        focal / half[0],
        focal / half[1],
        cx / half[0] - 1.0,
        cy / half[1] - 1.0,
        1.0 / half[0],
        1.0 / half[1],
        0.0,
        0.0,
        0.0,
    ]
}

fn run() -> Result<(), AnyError> {
    let (out, paths, [focal, baseline, doffs]) = arguments()?;
    let renderer = block_on(Renderer::new())?;
    let device = &renderer.device;
    let view_of = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());

    // The renderer's own resources: two pictures in textures, a target with a depth buffer, buffers of the map.
    let pictures = [load::load(&paths[0])?, load::load(&paths[1])?];
    let size = pictures[0].size();
    let calibration = Calibration::centred(focal, baseline, doffs, size)?;
    let [left, right] = pictures.each_ref().map(|picture| view_of(&renderer.upload(picture)));
    let target = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
    let frame_size = Size::new(TURNS.len() as u32 * size.width, size.height);
    let frame = renderer.texture(frame_size, TextureFormat::Rgba8UnormSrgb, target);
    let depths = renderer.texture(frame_size, TextureFormat::Depth32Float, TextureUsages::RENDER_ATTACHMENT);
    let map_buffer = |label, words: u64| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: 4 * words,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let disparities = map_buffer("disparities", size.pixels());
    let confidences = map_buffer("confidences", u64::from(size.width.div_ceil(4)) * u64::from(size.height));

    // Once per size: kernels, memory, inputs and outputs.
    let range = DisparityRange::new(0, 64)?;
    let gpu = Gpu::new(renderer.device.clone(), renderer.queue.clone());
    let matcher = Matcher::new(&gpu, size, &Preset::Balanced.dense_config(range))?;
    let inputs = matcher.inputs(Source::Texture(&left), Source::Texture(&right))?;
    let outputs = matcher.outputs(Destination::Buffer(&disparities), Some(&confidences))?;
    let reprojection = block_on(Reprojection::new(&gpu, size, range, &calibration))?;
    let sources = MapSources { disparities: &disparities, confidences: &confidences, picture: &left };
    let filter = PointFilter::new(&calibration);
    let capacity = size.pixels() as u32;
    let cloud = block_on(reprojection.points(sources, &filter, PointDraw::Instances(4), capacity))?;
    let pipeline = pipeline(device, frame.format());
    // The middle of the depths that the range has.
    let pivot = (focal * baseline / (doffs + 32.0)) as f32;
    let cameras = TURNS.map(|turn| {
        let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("camera"),
            contents: bytemuck::cast_slice(&view(turn, pivot, &calibration, size)),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        })
    });

    // Once per frame.
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
    matcher.record(&mut encoder, &inputs, &outputs);
    cloud.record(&mut encoder);
    let (target, depths) = (view_of(&frame), view_of(&depths));
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("points"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depths,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_vertex_buffer(0, cloud.vertices().slice(..));
    for (number, camera) in cameras.iter().enumerate() {
        let (x, [width, height]) = (number as u32 * size.width, [size.width, size.height].map(|side| side as f32));
        pass.set_viewport(x as f32, 0.0, width, height, 0.0, 1.0);
        pass.set_scissor_rect(x, 0, size.width, size.height);
        pass.set_bind_group(0, camera, &[]);
        pass.draw_indirect(cloud.arguments(), 0);
    }
    drop(pass);
    renderer.queue.submit([encoder.finish()]);

    let colours = renderer.read_back(&frame)?;
    atomic::write_whole(&out, |file| png::write_rgb8(file, &colours))?;
    Ok(())
}
