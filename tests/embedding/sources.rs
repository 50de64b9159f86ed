//! What an application has its pictures in: parts of textures, deep levels, floats.

use hsad::{
    config::Preset,
    dense::{Destination, Matcher},
    disparity::DisparityRange,
    image::{Plane, Size},
    luma::{Source, pack},
    wgpu::{
        BufferUsages, Extent3d, Features, Limits, TexelCopyBufferLayout, TexelCopyTextureInfo, TextureAspect,
        TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView, TextureViewDescriptor,
    },
};

use crate::application::{Application, pair};

const SIZE: Size = Size::new(131, 67);

/// Disparities and confidences of a pair, with holes filled by colours.
fn matched(application: &Application, sources: [Source<'_>; 2]) -> (Vec<i32>, Vec<u32>) {
    let config = Preset::Balanced.dense_config(DisparityRange::new(0, 24).unwrap());
    let matcher = Matcher::new(&application.gpu, SIZE, &config).unwrap();
    let inputs = matcher.inputs(sources[0], sources[1]).unwrap();
    let bench = application.bench();
    let disparities = bench.output(SIZE.pixels() as u32).unwrap();
    let confidences = bench.output(SIZE.width.div_ceil(4) * SIZE.height).unwrap();
    let outputs = matcher.outputs(Destination::Buffer(&disparities), Some(&confidences)).unwrap();
    bench.run(|encoder| matcher.record(encoder, &inputs, &outputs));
    (bench.download(&disparities).unwrap(), bench.download(&confidences).unwrap())
}

#[test]
fn both_views_may_lie_in_one_texture() {
    let application = Application::new();
    let bench = application.bench();
    let views = pair(SIZE, 1).map(|view| view.map(|&grey| [grey, grey / 2, 255 - grey, 9]));
    // The left view begins in row 1, the right one in column 134 and row 2; noise is around them.
    let firsts = [[0, 1], [SIZE.width + 3, 2]];
    let both = Plane::from_fn((2 * SIZE.width + 5, SIZE.height + 2), |x, y| {
        let inside = firsts.iter().zip(&views).find_map(|([column, row], view)| {
            let (x, y) = (x.checked_sub(*column)?, y.checked_sub(*row)?);
            (x < SIZE.width && y < SIZE.height).then(|| view.get(x, y))
        });
        inside.unwrap_or([(x * 7) as u8, (y * 13) as u8, 200, 255])
    });
    let texture = |pixels: &Plane<[u8; 4]>| -> TextureView {
        bench.texture(TextureFormat::Rgba8UnormSrgb, pixels.size(), pixels.data().as_flattened())
    };
    let (separate, both) = (views.each_ref().map(texture), texture(&both));
    let expected = matched(&application, separate.each_ref().map(Source::Texture));
    assert!(matched(&application, firsts.map(|first| Source::Part(&both, first))) == expected);

    let matcher =
        Matcher::new(&application.gpu, SIZE, &Preset::Fast.dense_config(DisparityRange::new(0, 24).unwrap())).unwrap();
    for first in [[SIZE.width + 6, 0], [0, 3], [u32::MAX, 0], [0, u32::MAX]] {
        let error = matcher.inputs(Source::Part(&both, [0, 0]), Source::Part(&both, first)).unwrap_err().to_string();
        assert!(error.contains("the right view is 131x67 pixels from column"), "{error}");
        assert!(error.contains("the texture has 267x69 pixels"), "{error}");
    }
    application.assert_quiet();
}

#[test]
fn deep_levels_and_floats_become_the_nearest_byte() {
    let application = Application::with(Features::TEXTURE_FORMAT_16BIT_NORM, Limits::downlevel_defaults());
    let bench = application.bench();
    let grey = pair(SIZE, 3)[0].clone();
    let levels = grey.data();
    let nearly = |grey: u8| (f32::from(grey) + 0.3) / 255.0;
    let texels: [(TextureFormat, Vec<u8>); 3] = [
        (
            TextureFormat::R16Unorm,
            levels.iter().flat_map(|&g| (u16::from(g) * 257).saturating_add(100).to_ne_bytes()).collect(),
        ),
        (TextureFormat::R32Float, levels.iter().flat_map(|&g| nearly(g).to_ne_bytes()).collect()),
        (
            TextureFormat::Rgba32Float,
            levels
                .iter()
                .flat_map(|&g| [nearly(g), nearly(g), nearly(g), 7.0].map(f32::to_ne_bytes).concat())
                .collect(),
        ),
    ];
    let config = Preset::Fast.dense_config(DisparityRange::new(0, 24).unwrap());
    let matcher = Matcher::new(&application.gpu, SIZE, &config).unwrap();
    let map = application.buffer(4 * SIZE.pixels(), BufferUsages::COPY_DST);
    let outputs = matcher.outputs(Destination::Buffer(&map), None).unwrap();
    for (format, texels) in texels {
        let view = bench.texture(format, SIZE, &texels);
        let inputs = matcher.inputs(Source::Texture(&view), Source::Texture(&view)).unwrap();
        bench.run(|encoder| matcher.record(encoder, &inputs, &outputs));
        let luma: Vec<u32> = bench.download(matcher.luma()[0]).unwrap();
        assert!(luma == pack(&grey), "{format:?}");
    }
    application.assert_quiet();
}

/// Mesa's lavapipe has no such textures; SwiftShader does.
#[test]
#[ignore = "needs a device with TEXTURE_FORMAT_NV12"]
fn the_luma_of_a_video_frame_is_taken_as_it_is() {
    let features = Features::TEXTURE_FORMAT_NV12 | Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
    let application = Application::with(features, Limits::downlevel_defaults());
    let bench = application.bench();
    // Planes of colours have half the columns and rows.
    let size = Size::new(132, 68);
    let views = pair(size, 5);
    let frames = views.each_ref().map(|view| {
        let texture = application.device().create_texture(&TextureDescriptor {
            label: None,
            size: Extent3d { width: size.width, height: size.height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: TextureFormat::NV12,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let plane = TexelCopyTextureInfo { aspect: TextureAspect::Plane0, ..texture.as_image_copy() };
        let layout = TexelCopyBufferLayout { bytes_per_row: Some(size.width), ..Default::default() };
        application.gpu.queue.write_texture(plane, view.data(), layout, texture.size());
        let plane = TextureViewDescriptor {
            format: Some(TextureFormat::R8Unorm),
            aspect: TextureAspect::Plane0,
            ..Default::default()
        };
        texture.create_view(&plane)
    });
    let config = Preset::Balanced.dense_config(DisparityRange::new(0, 24).unwrap());
    let matcher = Matcher::new(&application.gpu, size, &config).unwrap();
    let inputs = matcher.inputs(Source::Texture(&frames[0]), Source::Texture(&frames[1])).unwrap();
    let map = application.buffer(4 * size.pixels(), BufferUsages::COPY_DST);
    let outputs = matcher.outputs(Destination::Buffer(&map), None).unwrap();
    bench.run(|encoder| matcher.record(encoder, &inputs, &outputs));
    for (view, luma) in views.iter().zip(matcher.luma()) {
        assert!(bench.download::<u32>(luma).unwrap() == pack(view));
    }
    application.assert_quiet();
}
