//! Sharing of a device between threads, and of a pipeline cache.

use std::thread;

use hsad::{
    config::Preset,
    dense::{self, Destination, Inputs, MapReadback, Matcher, Outputs},
    disparity::DisparityRange,
    features::{Detector, DetectorInput, FeatureConfig, FeatureReadback},
    gpu::{Gpu, block_on},
    image::{Luma, Size},
    internals::cpu::dense::compute,
    luma::{Input, Source},
    wgpu::{Features, Limits, PipelineCacheDescriptor, TextureFormat, TextureUsages},
};

use crate::application::{Application, config, pair};

const SIZE: Size = Size::new(131, 67);

#[test]
fn everything_goes_to_other_threads() {
    fn assert_shared<T: Send + Sync>() {}
    assert_shared::<Matcher>();
    assert_shared::<Inputs>();
    assert_shared::<Outputs>();
    assert_shared::<Input>();
    assert_shared::<Detector>();
    assert_shared::<DetectorInput>();
    assert_shared::<MapReadback>();
    assert_shared::<FeatureReadback>();
    assert_shared::<Gpu>();
}

/// Two threads build, run and drop matchers at the same time on one device.
#[test]
fn threads_share_a_device() {
    let application = Application::new();
    let range = DisparityRange::new(0, 24).unwrap();
    let configs = [config(), Preset::Balanced.dense_config(range)];
    let pairs = [pair(SIZE, 9), pair(SIZE, 10)];
    thread::scope(|scope| {
        for (config, views) in configs.iter().zip(&pairs) {
            let application = &application;
            scope.spawn(move || {
                let [left, right] = views;
                let expected = compute(left, right, config).unwrap();
                for _ in 0..5 {
                    assert_eq!(block_on(dense::compute(&application.gpu, left, right, config)).unwrap(), expected);
                }
            });
        }
    });
    application.assert_quiet();
}

/// An error of one thread is reported to that thread only.
#[test]
fn errors_stay_with_their_thread() {
    let application = Application::new();
    thread::scope(|scope| {
        let gpu = &application.gpu;
        scope.spawn(move || {
            for _ in 0..20 {
                assert!(Matcher::new(gpu, (1 << 19, 1 << 19), &config()).is_err());
            }
        });
        for _ in 0..3 {
            Matcher::new(gpu, SIZE, &config()).unwrap();
        }
    });
    application.assert_quiet();
}

/// Not every driver fills a pipeline cache visibly, but a cache of another device is refused by every kernel compiled
/// with it.
#[test]
fn the_pipeline_cache_of_the_application_is_used() {
    let applications = [0; 2].map(|_| Application::with(Features::PIPELINE_CACHE, Limits::downlevel_defaults()));
    let caches = applications.each_ref().map(|application| {
        let descriptor = PipelineCacheDescriptor { label: None, data: None, fallback: false };
        // SAFETY: no initial data is passed that would have to come from such a cache.
        unsafe { application.device().create_pipeline_cache(&descriptor) }
    });
    let [own, foreign] = caches.map(|cache| applications[0].gpu.clone().with_cache(cache));
    let matcher = Matcher::new(&own, SIZE, &config()).unwrap();
    let black = Luma::filled(SIZE, 0);
    assert_eq!(matcher.run().unwrap(), compute(&black, &black, &config()).unwrap());

    let picture = applications[0].texture(TextureFormat::R8Unorm, SIZE, TextureUsages::TEXTURE_BINDING, &[]);
    let map = applications[0].texture(TextureFormat::R32Float, SIZE, TextureUsages::STORAGE_BINDING, &[]);
    let picture = Source::Texture(&picture);
    let refused = [
        Matcher::new(&foreign, SIZE, &config()).err(),
        block_on(Detector::new(&foreign, SIZE, &FeatureConfig::default())).err(),
        block_on(Input::new(&foreign, SIZE, picture, matcher.luma()[0])).err(),
    ];
    for error in refused {
        let error = error.expect("an error").to_string();
        assert!(error.contains("PipelineCache") && error.contains("device"), "{error}");
    }
    // The failure leaves no state behind.
    matcher.inputs(picture, picture).unwrap();
    matcher.outputs(Destination::Texture(&map), None).unwrap();
    applications.iter().for_each(Application::assert_quiet);
}
