//! Invalid input returns an `Error` that names it, and no uncaptured error reaches the application's handler.

use hsad::{
    Error,
    config::Preset,
    dense::{Destination, Matcher},
    disparity::DisparityRange,
    features::{Detector, FeatureConfig},
    gpu::{REQUIRED_LIMITS, block_on},
    image::Size,
    luma::{Input, Source},
    wgpu::{
        Buffer, BufferUsages, Features, Instance, InstanceDescriptor, Limits, TextureFormat, TextureUsages,
        TextureViewDescriptor, TextureViewDimension,
    },
};

use crate::application::{Application, config, pair};

const SIZE: Size = Size::new(40, 30);
const BYTES: u64 = 4 * 40 * 30;

#[test]
fn resources_that_will_not_do() {
    let application = Application::new();
    let matcher = Matcher::new(&application.gpu, SIZE, &config()).unwrap();
    let elsewhere = Application::new();

    let readable = TextureUsages::TEXTURE_BINDING;
    let rgba = TextureFormat::Rgba8Unorm;
    let good = application.texture(rgba, SIZE, readable, &[]);
    let input = |source: Source<'_>, expected: &[&str]| {
        // Right and wrong, either way round.
        for (left, right, name) in
            [(source, Source::Texture(&good), "the left view"), (Source::Texture(&good), source, "the right view")]
        {
            let error = matcher.inputs(left, right).err();
            let error = error.unwrap_or_else(|| panic!("{source:?} is accepted")).to_string();
            for part in [&[name], expected].concat() {
                assert!(error.contains(part), "{part}: {error}");
            }
        }
    };
    let texture = |format, size: Size, usage| application.texture(format, size, usage, &[]);
    let small = application.buffer(BYTES / 4 - 4, BufferUsages::COPY_SRC);
    input(Source::Luma(&small), &["buffer of 1196 bytes", "1200 bytes are needed"]);
    input(
        Source::Luma(&application.buffer(BYTES, BufferUsages::STORAGE)),
        &["STORAGE", "needs BufferUsages(COPY_SRC)"],
    );
    input(Source::Luma(&elsewhere.buffer(BYTES, BufferUsages::COPY_SRC)), &["device"]);
    input(Source::Texture(&texture(TextureFormat::Rg8Unorm, SIZE, readable)), &["format Rg8Unorm", "R16Float"]);
    input(Source::Texture(&texture(TextureFormat::R32Uint, SIZE, readable)), &["format R32Uint", "Bgra8UnormSrgb"]);
    input(Source::TextureAs(&good, TextureFormat::R16Float), &["format R16Float", "the texture has Rgba8Unorm"]);
    input(Source::Texture(&texture(rgba, Size::new(30, 40), readable)), &["30x40 pixels", "the pair has 40x30"]);
    let written = TextureUsages::STORAGE_BINDING;
    input(Source::Texture(&texture(rgba, SIZE, written)), &["STORAGE_BINDING", "needs TextureUsages(TEXTURE_BINDING)"]);
    input(Source::Texture(&elsewhere.texture(rgba, SIZE, readable, &[])), &["device"]);

    let output = |destination: Destination<'_>, confidences: Option<&Buffer>, expected: &[&str]| {
        let error = matcher.outputs(destination, confidences).err();
        let error = error.unwrap_or_else(|| panic!("{destination:?} is accepted")).to_string();
        assert!(expected.iter().all(|part| error.contains(part)), "{expected:?}: {error}");
    };
    let copied = BufferUsages::COPY_DST;
    let good = application.buffer(BYTES, copied);
    let small = application.buffer(BYTES - 4, copied);
    output(Destination::Buffer(&small), None, &["the disparity map", "4796 bytes", "4800 bytes are needed"]);
    let usage = application.buffer(BYTES, BufferUsages::STORAGE);
    output(Destination::Buffer(&usage), None, &["the disparity map", "needs BufferUsages(COPY_DST)"]);
    output(Destination::Buffer(&elsewhere.buffer(BYTES, copied)), None, &["device"]);
    let small = application.buffer(BYTES / 4 - 4, copied);
    output(Destination::Buffer(&good), Some(&small), &["the confidence map", "1200 bytes are needed"]);
    output(Destination::Buffer(&good), Some(&usage), &["the confidence map", "needs BufferUsages(COPY_DST)"]);
    output(Destination::Buffer(&good), Some(&elsewhere.buffer(BYTES, copied)), &["device"]);
    output(Destination::Buffer(&good), Some(&good), &["the confidence map", "a buffer of its own"]);
    output(Destination::Buffer(&good), Some(matcher.luma()[1]), &["the confidence map", "a buffer of its own"]);
    let map = TextureFormat::R32Float;
    let unsigned = texture(TextureFormat::R32Uint, SIZE, written);
    output(Destination::Texture(&unsigned), None, &["format R32Uint", "R32Sint", "R32Float"]);
    let size = texture(map, Size::new(40, 31), written);
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
    let gpu = &application.gpu;
    let detector = block_on(Detector::new(gpu, SIZE, &FeatureConfig::default())).unwrap();
    let view = application.texture(TextureFormat::R8Unorm, SIZE, TextureUsages::TEXTURE_BINDING, &[]);
    let unusable = application.buffer(BYTES, BufferUsages::COPY_DST);
    let small = application.buffer(1196, BufferUsages::STORAGE);
    let elsewhere = Application::new();
    let foreign = elsewhere.buffer(BYTES, BufferUsages::STORAGE);
    for (luma, expected) in
        [(&unusable, "needs BufferUsages(STORAGE)"), (&small, "1200 bytes are needed"), (&foreign, "device")]
    {
        let input = block_on(Input::new(gpu, SIZE, Source::Texture(&view), luma)).expect_err("an error");
        let detector = block_on(detector.input(luma)).expect_err("an error");
        for error in [input, detector] {
            assert!(error.to_string().contains(expected), "{expected}: {error}");
        }
    }
    application.assert_quiet();
    elsewhere.assert_quiet();
}

/// A view with layers, and resources of another instance, which wgpu answers by a panic.
#[test]
fn views_and_instances_that_will_not_do() {
    let application = Application::new();
    let matcher = Matcher::new(&application.gpu, SIZE, &config()).unwrap();
    let rgba = TextureFormat::Rgba8Unorm;
    let plain = application.texture(rgba, SIZE, TextureUsages::TEXTURE_BINDING, &[]);
    let layers = TextureViewDescriptor { dimension: Some(TextureViewDimension::D2Array), ..Default::default() };
    let layers = plain.texture().create_view(&layers);
    let error = matcher.inputs(Source::Texture(&layers), Source::Texture(&plain)).unwrap_err().to_string();
    assert_eq!(
        error,
        "the left view is refused by the device (Texture binding 1 expects dimension = D2, but given a view with \
         dimension = D2Array), but it must belong to this device and not be destroyed, and a view must have two dimensions"
    );

    let foreign = Application::of_instance(&Instance::new(InstanceDescriptor::new_without_display_handle()));
    // Instances number their resources alike; only a number that the other instance does not know is recognised.
    let foreign: Vec<_> = (0..1000).map(|_| foreign.texture(rgba, SIZE, TextureUsages::TEXTURE_BINDING, &[])).collect();
    let last = Source::Texture(&foreign[foreign.len() - 1]);
    let error = matcher.inputs(Source::Texture(&plain), last).unwrap_err().to_string();
    assert!(error.starts_with("the right view") && error.contains("another wgpu::Instance"), "{error}");
    // The matcher is as it was.
    matcher.inputs(Source::Texture(&plain), Source::Texture(&plain)).unwrap();
    application.assert_quiet();
}

#[test]
#[should_panic(expected = "inputs of another matcher")]
fn inputs_of_another_matcher() {
    let application = Application::new();
    let [one, other] = [(); 2].map(|()| Matcher::new(&application.gpu, SIZE, &config()).unwrap());
    let view = application.texture(TextureFormat::R8Unorm, SIZE, TextureUsages::TEXTURE_BINDING, &[]);
    let inputs = other.inputs(Source::Texture(&view), Source::Texture(&view)).unwrap();
    let readback = block_on(one.readback()).unwrap();
    application.bench().run(|encoder| one.record(encoder, &inputs, readback.outputs()));
}

#[test]
#[should_panic(expected = "readback of another detector")]
fn a_readback_of_another_detector() {
    let application = Application::new();
    let [one, other] = [16, 99].map(|max_features| {
        let config = FeatureConfig { max_features, ..FeatureConfig::default() };
        block_on(Detector::new(&application.gpu, SIZE, &config)).unwrap()
    });
    let readback = block_on(other.readback()).unwrap();
    application.bench().run(|encoder| one.record_readback(encoder, &readback));
}

#[test]
fn luma_of_the_matcher_is_no_input_and_no_rows_are_no_band() {
    let application = Application::new();
    let matcher = Matcher::new(&application.gpu, SIZE, &config()).unwrap();
    let [left, right] = matcher.luma().map(Source::Luma);
    let error = matcher.inputs(right, left).unwrap_err().to_string();
    assert!(error.starts_with("the left view is the matcher's own luma") && error.contains("record_luma"), "{error}");
    let error = block_on(Matcher::with_band_rows(&application.gpu, SIZE, &config(), 0)).unwrap_err().to_string();
    assert!(error.starts_with("band_rows is 0, but it must be 1 to"), "{error}");
    application.assert_quiet();
}

/// An error about the size of a picture names the limit that it exceeds.
#[test]
fn a_buffer_that_is_too_large_names_its_limits() {
    let mut limits = Limits::downlevel_defaults();
    limits.max_storage_buffer_binding_size = 16 << 10;
    let application = Application::with(Features::empty(), limits);
    let gpu = &application.gpu;
    for (size, preset) in [((400, 30), Preset::Fast), ((400, 30), Preset::Balanced), ((200, 200), Preset::Balanced)] {
        let config = preset.dense_config(DisparityRange::new(0, 128).unwrap());
        let error = Matcher::new(gpu, size, &config).expect_err("an error").to_string();
        assert!(error.contains("at most 16384: ") && error.contains("max_storage_buffer_binding_size"), "{error}");
    }
    let detector = block_on(Detector::new(gpu, (200, 200), &FeatureConfig::default()));
    let error = detector.expect_err("an error").to_string();
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
        let existing = || application.device().get_internal_counters().hal.buffers.read();
        let before = existing();
        let matcher = Matcher::new(&application.gpu, SIZE, &config()).expect_err("an error");
        let detector = block_on(Detector::new(&application.gpu, SIZE, &FeatureConfig::default()));
        for error in [matcher, detector.expect_err("an error")] {
            assert!(matches!(error, Error::Unsupported(_)));
            let text = error.to_string();
            assert!(text.contains(&format!("limit {name} is {has}, but at least {} is needed", limit.least)), "{text}");
        }
        assert_eq!(existing(), before);
        application.assert_quiet();
    }
}

#[test]
fn a_lost_device_is_an_error_and_another_one_goes_on() {
    let application = Application::new();
    let [left, right] = pair(SIZE, 8);
    let gpu = &application.gpu;
    let matcher = Matcher::new(gpu, SIZE, &config()).unwrap();
    let before = matcher.run().unwrap();
    let map = application.buffer(BYTES, BufferUsages::COPY_DST);
    let view = application.texture(TextureFormat::R8Unorm, SIZE, TextureUsages::TEXTURE_BINDING, &[]);
    let features = FeatureConfig::default();
    let detector = block_on(Detector::new(gpu, SIZE, &features)).unwrap();
    application.device().destroy();

    let view = Source::Texture(&view);
    let errors = [
        Matcher::new(gpu, SIZE, &config()).err(),
        matcher.run().err(),
        matcher.inputs(view, view).err(),
        matcher.outputs(Destination::Buffer(&map), None).err(),
        block_on(matcher.readback()).err(),
        block_on(Detector::new(gpu, SIZE, &features)).err(),
        block_on(detector.input(matcher.luma()[0])).err(),
        block_on(detector.read()).err(),
        block_on(detector.readback()).err(),
        block_on(hsad::dense::compute(gpu, &left, &right, &config())).err(),
        block_on(hsad::features::detect(gpu, &left, &features)).err(),
    ];
    for (index, error) in errors.into_iter().enumerate() {
        assert!(matches!(error, Some(Error::DeviceLost(_))), "{index}: {error:?}");
    }
    application.assert_quiet();

    let another = Matcher::new(&Application::new().gpu, SIZE, &config()).unwrap();
    assert_eq!(another.memory(), matcher.memory());
    assert_eq!(another.run().unwrap(), before);
}
