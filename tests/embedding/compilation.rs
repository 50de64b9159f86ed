//! What is compiled, and what is kept of it.

use std::thread;

use hsad::{
    Detector, DisparityRange, FeatureConfig, Matcher, Preset, block_on,
    dense::{Aggregation, DenseConfig, Destination},
    luma::Source,
    wgpu::{TextureFormat, TextureUsages},
};

use crate::application::{Application, config};

/// Counts the compiled pipelines on the device, without those that wgpu itself has made so far.
fn counter(application: &Application) -> impl Fn() -> isize {
    let count = || application.device().get_internal_counters().hal.compute_pipelines.read();
    let own = count();
    move || count() - own
}

fn range(count: u32) -> DisparityRange {
    DisparityRange::new(0, count).expect("a range")
}

/// Kernels do not depend on the size of pictures, nor on the exact range.
#[test]
fn another_size_compiles_nothing() {
    let application = Application::new();
    let compiled = counter(&application);
    let gpu = &application.gpu;
    let build = |size: (u32, u32), count| {
        for preset in [Preset::Balanced, Preset::Quality, Preset::Paper] {
            let matcher = Matcher::new(gpu, size, &preset.dense_config(range(count))).expect("a matcher");
            let picture = application.texture(TextureFormat::R8Unorm, size.into(), TextureUsages::TEXTURE_BINDING, &[]);
            let map = application.texture(TextureFormat::R32Sint, size.into(), TextureUsages::STORAGE_BINDING, &[]);
            matcher.inputs(Source::Texture(&picture), Source::Texture(&picture)).expect("inputs");
            matcher.outputs(Destination::Texture(&map), None).expect("outputs");
        }
        block_on(Detector::new(gpu, size, &FeatureConfig::default())).expect("a detector");
    };
    build((131, 67), 24);
    let before = compiled();
    assert!(before > 20, "{before}");
    build((64, 200), 24);
    build((131, 67), 22);
    assert_eq!(compiled(), before);
    build((131, 67), 64);
    assert!(compiled() > before, "semi-global matching is compiled for its number of disparities");
    application.assert_quiet();
}

/// Parameters that change for ever leave no more than 64 kernels behind, and those of live matchers.
#[test]
fn a_bounded_number_of_kernels_is_kept() {
    let application = Application::new();
    let compiled = counter(&application);
    let with_p2 = |p2| {
        Preset::Balanced.dense_config(range(8)).with(|parameters| {
            let Aggregation::Costs(costs) = &mut parameters.aggregation else { panic!("{parameters:?}") };
            costs.semi_global.as_mut().expect("semi-global matching").penalties.p2 = p2;
            parameters.refinement = None;
        })
    };
    let build = |config: &DenseConfig| Matcher::new(&application.gpu, (40, 30), config).expect("a matcher");
    let live = build(&with_p2(40));
    let own = compiled();
    for p2 in 41..80 {
        build(&with_p2(p2));
        assert!(compiled() <= 64 + own, "{p2}");
    }
    assert!(compiled() >= 64, "{}", compiled());
    live.run().expect("a map");
    application.assert_quiet();
}

/// Clones share what any of them has compiled, also on other threads; another handle of the same device does not.
#[test]
fn clones_share_kernels() {
    let application = Application::new();
    let compiled = counter(&application);
    let build = |gpu: &hsad::Gpu| drop(Matcher::new(gpu, (40, 30), &config()).expect("a matcher"));
    thread::scope(|scope| {
        for _ in 0..4 {
            let gpu = application.gpu.clone();
            scope.spawn(move || build(&gpu));
        }
    });
    let before = compiled();
    build(&application.gpu);
    assert_eq!(compiled(), before);
    let other = hsad::Gpu::new(application.gpu.device.clone(), application.gpu.queue.clone());
    build(&other);
    assert_eq!(compiled(), 2 * before);
    drop(other);
    assert_eq!(compiled(), before);
    application.assert_quiet();
}

/// What a failed build has asked for is not kept.
#[test]
fn a_failed_build_keeps_nothing() {
    let application = Application::new();
    let compiled = counter(&application);
    Matcher::new(&application.gpu, (1 << 19, 1 << 19), &config()).expect_err("too large");
    Matcher::new(&application.gpu, (40, 30), &config()).expect("a matcher");
    assert!(compiled() > 0);
    application.assert_quiet();
}
