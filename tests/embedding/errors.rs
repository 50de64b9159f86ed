//! Invalid input returns an `Error` that names it, and no uncaptured error reaches the application's handler.

use hsad::{
    Error,
    config::Preset,
    dense::{Brightness, Destination, Matcher},
    disparity::DisparityRange,
    features::{Detector, FeatureConfig},
    gpu::{Gpu, REQUIRED_LIMITS},
    luma::{Input, Source},
    wgpu::{Buffer, BufferUsages, Features, Limits, TextureFormat, TextureUsages},
};

use crate::application::{Application, config, pair};

const SIZE: (u32, u32) = (40, 30);
const BYTES: u64 = 4 * 40 * 30;

#[test]
fn resources_that_will_not_do() {
    let application = Application::new();
    let device = application.device();
    let matcher = Matcher::new(device, SIZE, &config()).unwrap();
    let elsewhere = Application::new();

    let readable = TextureUsages::TEXTURE_BINDING;
    let rgba = TextureFormat::Rgba8Unorm;
    let good = application.texture(rgba, SIZE, readable, &[]);
    let input = |source: Source<'_>, expected: &[&str]| {
        // Right and wrong, either way round.
        for (left, right, name) in
            [(source, Source::Texture(&good), "the left view"), (Source::Texture(&good), source, "the right view")]
        {
            let error = matcher.inputs(device, left, right).err();
            let error = error.unwrap_or_else(|| panic!("{source:?} is accepted")).to_string();
            for part in [&[name], expected].concat() {
                assert!(error.contains(part), "{part}: {error}");
            }
        }
    };
    let texture = |format, size, usage| application.texture(format, size, usage, &[]);
    let small = application.buffer(BYTES / 4 - 4, BufferUsages::COPY_SRC);
    input(Source::Luma(&small), &["buffer of 1196 bytes", "1200 bytes are needed"]);
    input(
        Source::Luma(&application.buffer(BYTES, BufferUsages::STORAGE)),
        &["STORAGE", "needs BufferUsages(COPY_SRC)"],
    );
    input(Source::Luma(&elsewhere.buffer(BYTES, BufferUsages::COPY_SRC)), &["device"]);
    input(Source::Texture(&texture(TextureFormat::Rg8Unorm, SIZE, readable)), &["format Rg8Unorm", "R16Float"]);
    input(Source::Texture(&texture(TextureFormat::R32Float, SIZE, readable)), &["format R32Float", "Bgra8UnormSrgb"]);
    input(Source::TextureAs(&good, TextureFormat::R16Float), &["format R16Float", "the texture has Rgba8Unorm"]);
    input(Source::Texture(&texture(rgba, (30, 40), readable)), &["30x40 pixels", "the pair has 40x30"]);
    let written = TextureUsages::STORAGE_BINDING;
    input(Source::Texture(&texture(rgba, SIZE, written)), &["STORAGE_BINDING", "needs TextureUsages(TEXTURE_BINDING)"]);
    input(Source::Texture(&elsewhere.texture(rgba, SIZE, readable, &[])), &["device"]);

    let output = |destination: Destination<'_>, confidences: Option<&Buffer>, expected: &[&str]| {
        let error = matcher.outputs(device, destination, confidences).err();
        let error = error.unwrap_or_else(|| panic!("{destination:?} is accepted")).to_string();
        assert!(expected.iter().all(|part| error.contains(part)), "{expected:?}: {error}");
    };
    let copied = BufferUsages::COPY_DST;
    let good = application.buffer(BYTES, copied);
    let small = application.buffer(BYTES - 4, copied);
    output(Destination::Buffer(&small), None, &["the disparities", "4796 bytes", "4800 bytes are needed"]);
    let usage = application.buffer(BYTES, BufferUsages::STORAGE);
    output(Destination::Buffer(&usage), None, &["the disparities", "needs BufferUsages(COPY_DST)"]);
    output(Destination::Buffer(&elsewhere.buffer(BYTES, copied)), None, &["device"]);
    let small = application.buffer(BYTES / 4 - 4, copied);
    output(Destination::Buffer(&good), Some(&small), &["the confidences", "1200 bytes are needed"]);
    output(Destination::Buffer(&good), Some(&usage), &["the confidences", "needs BufferUsages(COPY_DST)"]);
    output(Destination::Buffer(&good), Some(&elsewhere.buffer(BYTES, copied)), &["device"]);
    output(Destination::Buffer(&good), Some(&good), &["the confidences", "another use here"]);
    output(Destination::Buffer(&good), Some(matcher.luma()[1]), &["the confidences", "another use here"]);
    let map = TextureFormat::R32Float;
    let unsigned = texture(TextureFormat::R32Uint, SIZE, written);
    output(Destination::Texture(&unsigned), None, &["format R32Uint", "R32Sint", "R32Float"]);
    let size = texture(map, (40, 31), written);
    output(Destination::Texture(&size), None, &["40x31 pixels", "the pair has 40x30"]);
    let usage = texture(map, SIZE, TextureUsages::COPY_DST);
    output(Destination::Texture(&usage), None, &["needs TextureUsages(STORAGE_BINDING)"]);
    output(Destination::Texture(&elsewhere.texture(map, SIZE, written, &[])), None, &["device"]);

    application.assert_quiet();
    elsewhere.assert_quiet();
}

#[test]
fn luma_that_no_kernel_can_read() {
    let application = Application::new();
    let device = application.device();
    let view = application.texture(TextureFormat::R8Unorm, SIZE, TextureUsages::TEXTURE_BINDING, &[]);
    let unusable = application.buffer(BYTES, BufferUsages::COPY_DST);
    let small = application.buffer(1196, BufferUsages::STORAGE);
    let elsewhere = Application::new();
    let foreign = elsewhere.buffer(BYTES, BufferUsages::STORAGE);
    for (luma, expected) in [(&unusable, "needs STORAGE"), (&small, "than the 1196 given"), (&foreign, "device")] {
        let input = Input::new(device, SIZE, Source::Texture(&view), luma).err().expect("an error");
        let detector = Detector::new(device, luma, SIZE.0, SIZE.1, &FeatureConfig::default()).err().expect("an error");
        for error in [input, detector] {
            assert!(error.to_string().contains(expected), "{expected}: {error}");
        }
    }
    application.assert_quiet();
    elsewhere.assert_quiet();
}

/// An error about the size of a picture names the limit that it exceeds.
#[test]
fn a_buffer_that_is_too_large_names_its_limits() {
    let mut limits = Limits::downlevel_defaults();
    limits.max_storage_buffer_binding_size = 16 << 10;
    let application = Application::with(Features::empty(), limits);
    let device = application.device();
    for (size, preset) in [((400, 30), Preset::Fast), ((400, 30), Preset::Balanced), ((200, 200), Preset::Balanced)] {
        let config = preset.config().dense(DisparityRange::new(0, 128).unwrap(), Brightness::SAME);
        let error = Matcher::new(device, size, &config).err().expect("an error").to_string();
        assert!(error.contains("at most 16384: ") && error.contains("max_storage_buffer_binding_size"), "{error}");
    }
    let luma = application.buffer(200 * 200, BufferUsages::STORAGE);
    let error = Detector::new(device, &luma, 200, 200, &FeatureConfig::default()).err().expect("an error").to_string();
    assert!(error.contains("max_storage_buffer_binding_size"), "{error}");
    application.assert_quiet();
}

/// An error about a limit of the device names the limit, before any resource is created.
#[test]
fn a_limit_that_is_too_low_is_named() {
    type Lower = fn(&mut Limits);
    let lower: [(&str, Lower); 6] = [
        ("max_storage_buffers_per_shader_stage", |limits| limits.max_storage_buffers_per_shader_stage = 3),
        ("max_compute_invocations_per_workgroup", |limits| limits.max_compute_invocations_per_workgroup = 128),
        ("max_compute_workgroup_storage_size", |limits| limits.max_compute_workgroup_storage_size = 1024),
        ("max_compute_workgroups_per_dimension", |limits| limits.max_compute_workgroups_per_dimension = 1000),
        ("max_texture_dimension_2d", |limits| limits.max_texture_dimension_2d = 1024),
        ("max_storage_textures_per_shader_stage", |limits| limits.max_storage_textures_per_shader_stage = 1),
    ];
    for (name, change) in lower {
        let limit = REQUIRED_LIMITS.iter().find(|limit| limit.name == name).expect("a limit that is needed");
        let mut limits = Limits::downlevel_defaults();
        change(&mut limits);
        let has = (limit.of)(&limits);
        let application = Application::with(Features::empty(), limits);
        let luma = application.buffer(BYTES, BufferUsages::STORAGE);
        let existing = || application.device().get_internal_counters().hal.buffers.read();
        let before = existing();
        let matcher = Matcher::new(application.device(), SIZE, &config()).err().expect("an error");
        let detector = Detector::new(application.device(), &luma, SIZE.0, SIZE.1, &FeatureConfig::default());
        for error in [matcher, detector.err().expect("an error")] {
            assert!(matches!(error, Error::Unsupported(_)));
            let text = error.to_string();
            assert!(text.contains(&format!("limit {name} is {has}, and {} are needed", limit.least)), "{text}");
        }
        assert_eq!(existing(), before);
        application.assert_quiet();
    }
}

#[test]
fn a_lost_device_is_an_error_and_another_one_goes_on() {
    let application = Application::new();
    let [left, right] = pair(SIZE, 8);
    let matcher = Matcher::new(application.device(), SIZE, &config()).unwrap();
    let before = matcher.run(&application.gpu).unwrap();
    let map = application.buffer(BYTES, BufferUsages::COPY_DST);
    let luma = application.buffer(BYTES, BufferUsages::STORAGE);
    let view = application.texture(TextureFormat::R8Unorm, SIZE, TextureUsages::TEXTURE_BINDING, &[]);
    let features = FeatureConfig::default();
    let detector = Detector::new(application.device(), matcher.luma()[0], SIZE.0, SIZE.1, &features).unwrap();
    application.device().destroy();

    let device = application.device();
    let view = Source::Texture(&view);
    let errors = [
        Matcher::new(device, SIZE, &config()).err(),
        matcher.run(&application.gpu).err(),
        matcher.inputs(device, view, view).err(),
        matcher.outputs(device, Destination::Buffer(&map), None).err(),
        Detector::new(device, &luma, SIZE.0, SIZE.1, &features).err(),
        detector.read(device, &application.gpu.queue).err(),
        hsad::dense::compute(&application.gpu, &left, &right, &config()).err(),
        hsad::features::detect(&application.gpu, &left, &features).err(),
    ];
    for (index, error) in errors.into_iter().enumerate() {
        assert!(matches!(error, Some(Error::DeviceLost(_))), "{index}: {error:?}");
    }
    application.assert_quiet();

    let Gpu { device, .. } = &Application::new().gpu;
    let another = Matcher::new(device, SIZE, &config()).unwrap();
    assert_eq!(another.memory(), matcher.memory());
    let application = Application::new();
    let matcher = Matcher::new(application.device(), SIZE, &config()).unwrap();
    assert_eq!(matcher.run(&application.gpu).unwrap(), before);
}
