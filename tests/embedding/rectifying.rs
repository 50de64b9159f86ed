//! Views as they were taken: resampled, matched, and the map taken back, in one recording.

use std::path::Path;

use hsad::{
    Backend, Config,
    calibration::{CameraModel, Lens, RadialTangential, StereoCalibration},
    config::Preset,
    dense::{Dense, DenseConfig, Destination, Matcher, View},
    disparity::DisparityRange,
    glam::{DMat3, DVec2, DVec3},
    gpu::block_on,
    image::Size,
    internals::{
        cpu::{
            dense::{compute_in_colour, compute_seen, map_back},
            rectify::{warp, warp_colours},
        },
        dense::{Loss, MapTexel, Seen},
    },
    io::{Picture, load},
    luma::{Source, pack},
    pipeline::{self, RectifiedPair},
    rectify::{CalibratedRectification, StereoRectification, WarpMap},
    wgpu::{CommandEncoderDescriptor, TextureFormat, TextureViewDescriptor},
};

use crate::{
    application::{Application, config},
    results::existing,
};

/// Two pictures of different sizes, and the cameras that are said to have taken them.
fn taken() -> ([Picture; 2], StereoCalibration) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/planes");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let Size { width, height } = right.size();
    let right = Picture::from_fn((width + 5, height - 3), |x, y| right.get(x.min(width - 1), y));
    let sizes = [left.size(), right.size()];
    let camera = |k1: f64| {
        let lens = Lens::Pinhole(RadialTangential::new(&[k1, 0.02]).unwrap());
        let middle = DVec2::new(width.into(), height.into()) / 2.0;
        CameraModel::new(DVec2::new(300.0, 301.0), middle, lens).unwrap()
    };
    let turned = DMat3::from_rotation_y(0.02) * DMat3::from_rotation_z(0.05);
    let apart = DVec3::new(-0.1, 0.002, 0.001);
    let stereo = StereoCalibration::new([camera(-0.1), camera(-0.15)], sizes.map(Some), turned, apart).unwrap();
    ([left, right], stereo)
}

/// The map that the twins make of `pictures`, resampled by `maps`.
fn expected(pictures: &[Picture; 2], maps: &[WarpMap; 2], config: &DenseConfig) -> Dense {
    let [left, right] = [0, 1].map(|view: usize| warp(&pictures[view].luma(), &maps[view]));
    let (own, other) = if config.reference == View::Left { (0, 1) } else { (1, 0) };
    let masks = [own, other].map(|view: usize| maps[view].visible());
    let picture = warp_colours(&pictures[own], &maps[own]);
    let seen = Seen { masks: [Some(&masks[0]), Some(&masks[1])], loss: Loss::Nothing };
    let shown = seen.near_partners(config.reference, config.range).unwrap();
    let seen = Seen { masks: [Some(&shown), seen.masks[1]], ..seen };
    let dense = compute_seen([&left, &right], Some(&picture), Some(seen), config).unwrap();
    // What the masks keep out makes a difference.
    assert_ne!(dense, compute_in_colour([&left, &right], &picture, config).unwrap());
    dense
}

#[test]
fn raw_textures_in_and_maps_of_both_pictures_out() {
    let application = Application::new();
    let (gpu, bench) = (&application.gpu, application.bench());
    let (pictures, stereo) = taken();
    let rectification = CalibratedRectification::new(&stereo, pictures.each_ref().map(Picture::size)).unwrap();
    let rectification = StereoRectification::Calibrated(rectification.into());
    let range = DisparityRange::new(0, 32).unwrap();
    let maps = [0, 1].map(|view| rectification.map(view).unwrap());
    let textures =
        pictures.each_ref().map(|picture| bench.texture(TextureFormat::Rgba8UnormSrgb, picture.size(), picture.rgba()));
    let [left, right] = textures.each_ref().map(Source::Texture);
    for (preset, view) in [(Preset::Balanced, 0), (Preset::Balanced, 1), (Preset::Fast, 0)] {
        let config = DenseConfig { reference: View::ALL[view], ..preset.dense_config(range) };
        let dense = expected(&pictures, &maps, &config);
        let matcher = Matcher::rectifying(gpu, maps.each_ref(), &config).unwrap();
        let inputs = matcher.inputs(left, right).unwrap();
        let mut readback = block_on(matcher.readback()).unwrap();

        let way_back = rectification.map_back(view).unwrap();
        let size = way_back.size();
        let map = bench.output_texture(MapTexel::FixedPoint.format(), size);
        let texture = map.create_view(&TextureViewDescriptor::default());
        let buffer = bench.output((size.width * size.height) + 1).unwrap();
        let confidences = bench.output(size.width.div_ceil(4) * size.height).unwrap();
        let to_texture = matcher.outputs_back(&way_back, Destination::Texture(&texture), None).unwrap();
        let to_buffer = matcher.outputs_back(&way_back, Destination::Buffer(&buffer), Some(&confidences)).unwrap();
        block_on(matcher.warm_up(Some(&inputs), &to_texture)).unwrap();

        let mut encoder = gpu.device.create_command_encoder(&CommandEncoderDescriptor::default());
        let before = existing(&gpu.device);
        for outputs in [readback.outputs(), &to_texture, &to_buffer] {
            matcher.record(&mut encoder, &inputs, outputs);
        }
        let commands = encoder.finish();
        assert_eq!(existing(&gpu.device), before, "recording creates nothing");
        gpu.queue.submit([commands]);

        assert_eq!(block_on(readback.read()).unwrap(), dense, "{preset}, view {view}");
        let back = map_back(&dense, &way_back);
        assert_eq!(bench.download_texture::<i32>(&map).unwrap(), back.disparity.data(), "{preset}, view {view}");
        let disparities = bench.download::<i32>(&buffer).unwrap();
        let (disparities, rest) = disparities.split_at((size.width * size.height) as usize);
        assert_eq!((disparities, rest), (back.disparity.data(), &[-1][..]), "{preset}, view {view}");
        assert_eq!(bench.download::<u32>(&confidences).unwrap(), pack(&back.confidence), "{preset}, view {view}");
    }
    application.assert_quiet();
}

#[test]
fn disparities_equal_those_of_the_pipeline() {
    let application = Application::new();
    let (pictures, stereo) = taken();
    let range = DisparityRange::new(0, 32).unwrap();
    let backend = Backend::Gpu(application.gpu.clone());
    let pair: RectifiedPair = pipeline::rectify_by(&backend, (&pictures[0], &pictures[1]), &stereo).unwrap();
    let config = Config { range: Some(range), align: false, equalise: false, force: true, ..Preset::Balanced.config() };
    let outcome = block_on(pipeline::run_rectified(&backend, &pair, &config, |_| (), |_| ())).unwrap();

    let maps = [0, 1].map(|view| pair.rectification.map(view).unwrap());
    let matcher =
        Matcher::rectifying(&application.gpu, maps.each_ref(), &Preset::Balanced.dense_config(range)).unwrap();
    let bench = application.bench();
    let textures =
        pictures.each_ref().map(|picture| bench.texture(TextureFormat::Rgba8Unorm, picture.size(), picture.rgba()));
    let [left, right] = textures.each_ref().map(Source::Texture);
    let inputs = matcher.inputs(left, right).unwrap();
    let mut readback = block_on(matcher.readback()).unwrap();
    bench.run(|encoder| matcher.record(encoder, &inputs, readback.outputs()));
    let disparities = block_on(readback.read()).unwrap().disparity;
    let differing = disparities.data().iter().zip(outcome.dense.disparity.data()).filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0);
}

#[test]
fn maps_of_other_sizes_are_refused() {
    let application = Application::new();
    let map = |size: (u32, u32)| WarpMap::new(size, (64, 48), |p| p).unwrap();
    let gpu = &application.gpu;
    let error = Matcher::rectifying(gpu, [&map((64, 48)), &map((64, 47))], &config()).unwrap_err().to_string();
    assert_eq!(error, "the maps is for 64x48 and 64x47 pixels, but both must be for one size");
    let matcher = Matcher::rectifying(gpu, [&map((70, 50)), &map((70, 50))], &config()).unwrap();
    let buffer = application.bench().output(70 * 50).unwrap();
    let error = matcher.outputs_back(&map((70, 50)), Destination::Buffer(&buffer), None).unwrap_err().to_string();
    assert_eq!(error, "the map back is into a picture of 64x48 pixels, but the matcher has 70x50");
    // Inputs have the size of the views.
    let luma = application.bench().output(70 * 50 / 4).unwrap();
    assert!(matcher.inputs(Source::Luma(&luma), Source::Luma(&luma)).is_ok());
    let texture = application.bench().texture(TextureFormat::R8Unorm, (70, 50), &[0; 70 * 50]);
    let error = matcher.inputs(Source::Texture(&texture), Source::Luma(&luma)).unwrap_err().to_string();
    assert!(error.contains("64x48"), "{error}");
    application.assert_quiet();
}

#[test]
fn memory_is_what_the_device_gives() {
    let application = Application::new();
    let taken = || {
        let counters = application.device().get_internal_counters().hal;
        (counters.buffer_memory.read() + counters.texture_memory.read()) as f64
    };
    let map = WarpMap::new((640, 480), (800, 600), |p| 1.3 * p - 9.0).unwrap();
    let config = Preset::Balanced.dense_config(DisparityRange::new(0, 24).unwrap());
    let before = taken();
    let matcher = Matcher::rectifying(&application.gpu, [&map; 2], &config).unwrap();
    let (taken, told) = (taken() - before, matcher.memory() as f64);
    assert!(told <= taken && taken < 1.02 * told, "{told} bytes told, {taken} taken");
}
