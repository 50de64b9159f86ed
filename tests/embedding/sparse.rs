//! Feature detection without waiting: features in buffers that the application reads.

use hsad::{
    dense::Matcher,
    features::{DESCRIPTOR_LENGTH, Detector, FeatureConfig, Keypoint, collect, detect},
    gpu::block_on,
    luma::Source,
    verify::smooth_noise,
    wgpu::TextureFormat,
};

use crate::application::{Application, config};

/// One conversion to luma serves dense matching and features; the buffers hold the same features as the library's
/// read-back.
#[test]
fn features_of_a_texture_are_read_from_their_buffers() {
    let application = Application::new();
    let (gpu, bench) = (&application.gpu, application.bench());
    let size = (311, 239);
    let luma = smooth_noise(size, 7);
    let view = bench.texture(TextureFormat::R8Unorm, size, luma.data());
    let matcher = Matcher::new(gpu, size, &config()).unwrap();
    let inputs = matcher.inputs(Source::Texture(&view), Source::Texture(&view)).unwrap();
    let features = FeatureConfig { upright: false, max_features: 5000, ..FeatureConfig::default() };
    let detector = block_on(Detector::new(gpu, size, &features)).unwrap();
    let input = block_on(detector.input(matcher.luma()[0])).unwrap();
    let map = block_on(matcher.readback()).unwrap();
    let mut readback = block_on(detector.readback()).unwrap();
    bench.run(|encoder| {
        matcher.record(encoder, &inputs, map.outputs());
        detector.record(encoder, &input);
        detector.record_readback(encoder, &readback);
    });
    let expected = block_on(detect(gpu, &luma, &features)).unwrap().features;

    let list = detector.keypoints();
    let found = bench.download::<u32>(list.count()).unwrap()[0] as usize;
    assert!(found > 100 && list.capacity() == 5000, "{found}");
    let keypoints = bench.download::<Keypoint>(list.keypoints()).unwrap();
    let descriptors = bench.download::<[f32; DESCRIPTOR_LENGTH]>(detector.descriptors()).unwrap();
    assert_eq!(collect(&keypoints[..found], &descriptors[..found]), expected);
    assert_eq!(block_on(detector.read()).unwrap(), expected);
    assert_eq!(block_on(readback.read()).unwrap(), expected);
    application.assert_quiet();
}
