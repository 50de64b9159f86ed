//! Results from textures and buffers, in textures and buffers, equal those of the CPU twins to the byte.

use std::{
    pin::pin,
    task::{Context, Waker},
};

use hsad::{
    config::Preset,
    dense::{Brightness, Dense, DenseConfig, Destination, Matcher, View},
    disparity::DisparityRange,
    features::{Detector, FeatureConfig},
    gpu::block_on,
    image::{Luma, Size},
    internals::{
        cpu::dense::{compute, compute_in_colour, map_texture},
        dense::MapTexel,
    },
    io::Picture,
    luma::{Source, pack},
    wgpu::{self, BufferUsages, TextureFormat, TextureUsages},
};

use crate::application::{Application, config, pair};

const SIZE: Size = Size::new(131, 67);

/// The texels of a grey picture.
fn texels(luma: &Luma, format: TextureFormat) -> Vec<u8> {
    let count = format.components() as usize;
    luma.data().iter().flat_map(|&grey| std::iter::repeat_n(grey, count)).collect()
}

/// Configurations that run different kernels: block matching with and without refinement, and paths.
fn configs() -> Vec<DenseConfig> {
    let range = DisparityRange::new(0, 24).unwrap();
    let preset = |preset: Preset| preset.dense_config(range);
    vec![config(), preset(Preset::Fast), preset(Preset::Balanced)]
}

fn assert_answers(what: &str, disparities: &[i32], confidences: &[u32], expected: &Dense) {
    assert_eq!(disparities, expected.disparity.data(), "{what}");
    assert_eq!(confidences, pack(&expected.confidence), "{what}");
}

#[test]
fn textures_in_and_out_in_bands_and_not() {
    let application = Application::new();
    let (gpu, bench) = (&application.gpu, application.bench());
    let views = pair(SIZE, 1);
    for config in configs() {
        let expected = compute(&views[0], &views[1], &config).unwrap();
        for band_rows in [u32::MAX, 20] {
            let matcher = block_on(Matcher::with_band_rows(gpu, SIZE, &config, band_rows)).unwrap();
            // Two formats that are read differently.
            let [left, right] = [TextureFormat::Bgra8UnormSrgb, TextureFormat::R8Unorm];
            let textures = [(&views[0], left), (&views[1], right)]
                .map(|(view, format)| bench.texture(format, SIZE, &texels(view, format)));
            let [left, right] = textures.each_ref().map(Source::Texture);
            let inputs = matcher.inputs(left, right).unwrap();
            for texel in MapTexel::ALL {
                let map = bench.output_texture(texel.format(), SIZE);
                let view = map.create_view(&wgpu::TextureViewDescriptor::default());
                let confidences = bench.output(SIZE.width.div_ceil(4) * SIZE.height).unwrap();
                let outputs = matcher.outputs(Destination::Texture(&view), Some(&confidences)).unwrap();
                bench.run(|encoder| matcher.record(encoder, &inputs, &outputs));
                let what = format!("{texel:?} in bands of {band_rows}, {:?}", config.parameters.aggregation);
                match texel {
                    MapTexel::FixedPoint => {
                        let confidences = bench.download::<u32>(&confidences).unwrap();
                        assert_answers(&what, &bench.download_texture(&map).unwrap(), &confidences, &expected);
                    }
                    MapTexel::Pixels => {
                        let pixels = bench.download_texture::<f32>(&map).unwrap();
                        assert_eq!(pixels, map_texture(&expected.disparity), "{what}");
                    }
                }
            }
        }
    }
    application.assert_quiet();
}

/// Holes are filled by the colours of the reference view where it has some; the caller's luma has none.
#[test]
fn textures_bring_their_colours() {
    let application = Application::new();
    let (gpu, bench) = (&application.gpu, application.bench());
    let [left, right] = pair(SIZE, 7);
    // Red and blue differ where green does not.
    let hue = |x: u32, y: u32| if (x / 9 + y / 7).is_multiple_of(2) { [200, 20] } else { [10, 250] };
    let coloured = |view: &Luma| {
        let colour = |x, y| [hue(x, y)[0], view.get(x, y), hue(x, y)[1], 255];
        Picture::from_fn(SIZE, colour)
    };
    let pictures = [coloured(&left), coloured(&right)];
    let lumas = pictures.each_ref().map(Picture::luma);
    for (index, reference) in View::ALL.into_iter().enumerate() {
        let config = DenseConfig { reference, ..Preset::Quality.dense_config(DisparityRange::new(0, 24).unwrap()) };
        let grey = compute(&lumas[0], &lumas[1], &config).unwrap();
        let expected = compute_in_colour([&lumas[0], &lumas[1]], &pictures[index], &config).unwrap();
        assert_ne!(grey, expected);
        let matcher = block_on(Matcher::with_band_rows(gpu, SIZE, &config, 30)).unwrap();
        let textures =
            pictures.each_ref().map(|picture| bench.texture(TextureFormat::Rgba8Unorm, SIZE, picture.rgba()));
        let [left, right] = textures.each_ref().map(Source::Texture);
        let inputs = matcher.inputs(left, right).unwrap();
        let mut readback = block_on(matcher.readback()).unwrap();
        bench.run(|encoder| matcher.record(encoder, &inputs, readback.outputs()));
        assert_eq!(block_on(readback.read()).unwrap(), expected, "{reference}");
        // The same luma without colours: what the matcher still holds.
        assert_eq!(matcher.run().unwrap(), grey, "{reference}");
    }
    application.assert_quiet();
}

/// Two frames in flight share one matcher and one encoder, with their own views and maps.
#[test]
fn frames_take_turns_in_one_encoder() {
    let application = Application::new();
    let (gpu, bench) = (&application.gpu, application.bench());
    let frames = [pair(SIZE, 2), pair(SIZE, 3)];
    let matcher = Matcher::new(gpu, SIZE, &config()).unwrap();
    let prepared = frames.each_ref().map(|[left, right]| {
        let left = bench.upload_luma(left).unwrap();
        let right = bench.texture(TextureFormat::Rgba8Unorm, SIZE, &texels(right, TextureFormat::Rgba8Unorm));
        let inputs = matcher.inputs(Source::Luma(&left), Source::Texture(&right)).unwrap();
        // The buffer has one word more than needed, which must not change.
        let map = bench.output(SIZE.width * SIZE.height + 1).unwrap();
        let confidences = bench.output(SIZE.width.div_ceil(4) * SIZE.height).unwrap();
        let outputs = matcher.outputs(Destination::Buffer(&map), Some(&confidences)).unwrap();
        (inputs, outputs, map, confidences)
    });
    bench.run(|encoder| {
        for (inputs, outputs, ..) in &prepared {
            matcher.record(encoder, inputs, outputs);
        }
    });
    for ([left, right], (.., map, confidences)) in frames.iter().zip(&prepared) {
        let expected = compute(left, right, &config()).unwrap();
        let disparities = bench.download::<i32>(map).unwrap();
        let (disparities, rest) = disparities.split_at((SIZE.width * SIZE.height) as usize);
        assert_answers("a frame", disparities, &bench.download::<u32>(confidences).unwrap(), &expected);
        assert_eq!(rest, [-1]);
    }
    application.assert_quiet();
}

/// A read that is dropped while its mapping is pending leaves the readback as it was.
#[test]
fn a_cancelled_read_can_be_repeated() {
    let application = Application::new();
    let matcher = Matcher::new(&application.gpu, SIZE, &config()).unwrap();
    let views = pair(SIZE, 5);
    for (view, luma) in views.iter().zip(matcher.luma()) {
        application.bench().write(luma, &pack(view));
    }
    let expected = compute(&views[0], &views[1], &config()).unwrap();
    let mut readback = block_on(matcher.readback()).unwrap();
    for _ in 0..3 {
        let mut encoder = application.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        // Enough work for the mapping to be pending at the first poll.
        (0..20).for_each(|_| matcher.record_luma(&mut encoder, readback.outputs()));
        application.gpu.queue.submit([encoder.finish()]);
        let cancelled = pin!(readback.read()).poll(&mut Context::from_waker(Waker::noop()));
        drop(cancelled);
        let map = block_on(readback.read()).unwrap();
        assert_eq!((map.disparity, map.confidence), (expected.disparity.clone(), expected.confidence.clone()));
    }
    application.assert_quiet();
}

/// A view's format may differ from its texture's, as in renderers that use sRGB views only for display.
#[test]
fn a_view_may_have_another_format_than_its_texture() {
    let application = Application::new();
    let (gpu, bench) = (&application.gpu, application.bench());
    let views = pair(SIZE, 4);
    let matcher = Matcher::new(gpu, SIZE, &config()).unwrap();
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    let srgb = TextureFormat::Rgba8UnormSrgb;
    let textures = views.each_ref().map(|view| {
        let plain = application.texture(TextureFormat::Rgba8Unorm, SIZE, usage, &[srgb]);
        let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * SIZE.width), ..Default::default() };
        let texture = plain.texture();
        application.gpu.queue.write_texture(texture.as_image_copy(), &texels(view, srgb), layout, texture.size());
        texture.create_view(&wgpu::TextureViewDescriptor { format: Some(srgb), ..Default::default() })
    });
    let [left, right] = textures.each_ref().map(|view| Source::TextureAs(view, srgb));
    let inputs = matcher.inputs(left, right).unwrap();
    let readback = block_on(matcher.readback()).unwrap();
    bench.run(|encoder| matcher.record(encoder, &inputs, readback.outputs()));
    for (luma, view) in matcher.luma().into_iter().zip(&views) {
        assert_eq!(bench.download::<u32>(luma).unwrap(), pack(view));
    }
    application.assert_quiet();
}

#[test]
fn recording_creates_nothing_and_submits_nothing() {
    let application = Application::new();
    let (gpu, bench) = (&application.gpu, application.bench());
    let views = pair(SIZE, 5);
    let format = TextureFormat::Rgba8UnormSrgb;
    let textures = views.each_ref().map(|view| bench.texture(format, SIZE, &texels(view, format)));
    let [left, right] = textures.each_ref().map(Source::Texture);
    for config in configs() {
        let matcher = Matcher::new(gpu, SIZE, &config).unwrap();
        let inputs = matcher.inputs(left, right).unwrap();
        let before = existing(&gpu.device);
        let map = bench.output_texture(TextureFormat::R32Float, SIZE);
        let view = map.create_view(&wgpu::TextureViewDescriptor::default());
        let outputs = matcher.outputs(Destination::Texture(&view), None).unwrap();
        // The counters see the created objects.
        assert_ne!(existing(&gpu.device), before);

        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let before = existing(&gpu.device);
        for _ in 0..2 {
            matcher.record(&mut encoder, &inputs, &outputs);
        }
        let commands = encoder.finish();
        assert_eq!(existing(&gpu.device), before);
        // Nothing was written: every texel keeps its value.
        assert!(bench.download_texture::<u32>(&map).unwrap().iter().all(|&texel| texel == u32::MAX));
        application.gpu.queue.submit([commands]);
        let expected = compute(&views[0], &views[1], &config).unwrap();
        assert_eq!(bench.download_texture::<f32>(&map).unwrap(), map_texture(&expected.disparity));
    }
    application.assert_quiet();
}

/// Numbers of all kinds of objects on a device, and the memory they take, in bytes.
pub fn existing(device: &wgpu::Device) -> [isize; 12] {
    let counters = device.get_internal_counters().hal;
    [
        &counters.buffers,
        &counters.textures,
        &counters.texture_views,
        &counters.bind_groups,
        &counters.bind_group_layouts,
        &counters.compute_pipelines,
        &counters.pipeline_layouts,
        &counters.samplers,
        &counters.shader_modules,
        &counters.query_sets,
        &counters.buffer_memory,
        &counters.texture_memory,
    ]
    .map(|counter| counter.read())
}

/// The memory that a matcher or a detector reports equals the memory taken from the device.
#[test]
fn memory_is_what_the_device_gives() {
    let application = Application::new();
    let (gpu, device) = (&application.gpu, application.device());
    let taken = || {
        let counters = device.get_internal_counters().hal;
        (counters.buffer_memory.read() + counters.texture_memory.read()) as f64
    };
    let check = |what: &str, before: f64, told: u64| {
        let (taken, told) = (taken() - before, told as f64);
        // The device rounds allocations up.
        assert!(told <= taken && taken < 1.02 * told, "{told} bytes told, {taken} taken: {what}");
    };
    let size = (640, 480);
    for config in configs() {
        let before = taken();
        let matcher = Matcher::new(gpu, size, &config).unwrap();
        check(&format!("{:?}", config.parameters.aggregation), before, matcher.memory());
    }
    for max_features in [500, 65_536] {
        let before = taken();
        let config = FeatureConfig { max_features, ..FeatureConfig::default() };
        let detector = block_on(Detector::new(gpu, size, &config)).unwrap();
        check(&format!("{max_features} features"), before, detector.memory());
    }
}

/// The table of docs/benchmarks.md, on a device with the limits that it names.
#[test]
fn matchers_take_the_memory_that_is_told() {
    let benchmarks = include_str!("../../docs/benchmarks.md");
    let gpu = &Application::new().gpu;
    let [mut told, mut measured] = [vec![], vec![]];
    for (size, count) in [((640, 480), 128), ((768, 512), 64), ((1920, 1080), 256)] {
        let start = format!("| {}x{}, {count} | ", size.0, size.1);
        let row = benchmarks.lines().find_map(|line| line.strip_prefix(&start)).expect("the row of the size");
        told.extend(row.split('|').filter_map(|cell| cell.trim().parse::<f64>().ok()));
        let range = DisparityRange::new(0, count).unwrap();
        measured.extend([Preset::Fast, Preset::Balanced, Preset::Quality].map(|preset| {
            let matcher = Matcher::new(gpu, size, &preset.dense_config(range)).unwrap();
            (matcher.memory() as f64 / 1e6).round()
        }));
    }
    assert_eq!(told, measured);
}

#[test]
fn brightness_changes_without_another_matcher() {
    let application = Application::new();
    let bench = application.bench();
    let [left, right] = pair(SIZE, 6);
    for config in configs() {
        let matcher = block_on(Matcher::with_band_rows(&application.gpu, SIZE, &config, 40)).unwrap();
        for (view, luma) in [&left, &right].into_iter().zip(matcher.luma()) {
            bench.write(luma, &pack(view));
        }
        for brightness in [Brightness { gain: 300, offset: -4000 }, Brightness { gain: 100, offset: 9 }] {
            matcher.set_brightness(brightness).unwrap();
            let expected = compute(&left, &right, &DenseConfig { brightness, ..config.clone() }).unwrap();
            assert_eq!(matcher.run().unwrap(), expected);
        }
        let refused = matcher.set_brightness(Brightness { gain: 1 << 21, offset: 0 });
        assert!(refused.unwrap_err().to_string().starts_with("the gain is 2097152"));
    }
    application.assert_quiet();
}

/// Results can be written directly to a buffer that the host maps.
#[test]
fn a_map_goes_to_a_buffer_that_can_be_mapped() {
    let application = Application::new();
    let device = application.device();
    let [left, right] = pair(SIZE, 7);
    let matcher = Matcher::new(&application.gpu, SIZE, &config()).unwrap();
    for (view, luma) in [&left, &right].into_iter().zip(matcher.luma()) {
        application.bench().write(luma, &pack(view));
    }
    let bytes = 4 * u64::from(SIZE.width) * u64::from(SIZE.height);
    let map = application.buffer(bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
    let outputs = matcher.outputs(Destination::Buffer(&map), None).unwrap();
    application.bench().run(|encoder| matcher.record_luma(encoder, &outputs));
    map.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let expected = compute(&left, &right, &config()).unwrap();
    let read = map.get_mapped_range(..).unwrap();
    assert_eq!(bytemuck::pod_collect_to_vec::<u8, i32>(&read), expected.disparity.data());
    application.assert_quiet();
}
