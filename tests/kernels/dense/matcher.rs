//! The dense half as a whole, in step with the twins.

use std::{collections::BTreeSet, sync::mpsc::channel, thread, time::Duration};

use hsad::{
    Error,
    config::Preset,
    dense::{
        self, Aggregation, Brightness, Compared, Cost, CostAggregation, CrossCheck, DenseConfig, DenseParameters,
        Destination, Difference, Matcher, Paths, Penalties, Refinement, Search, SemiGlobal, View,
    },
    disparity::{DisparityRange, coverage},
    gpu::{Gpu, SgmPlan},
    image::{Luma, Size},
    internals::{cpu::dense::compute, dense::CELL},
    luma::pack,
    verify::{Bench, compare, trials::DenseTrial},
    wgpu,
};

use crate::common::*;

fn pair(width: u32, height: u32) -> (Luma, Luma) {
    let right = picture((width, height), 1);
    let left =
        Luma::from_fn((width, height), |x, y| right.get_clamped(i64::from(x) - 5 - i64::from(y / 16), i64::from(y)));
    (left, right)
}

fn config(reference: View) -> DenseConfig {
    let range = DisparityRange::new(-2, 30).unwrap();
    let brightness = Brightness { gain: 280, offset: -700 };
    let checked = DenseParameters { uniqueness: 10, consistency: Some(256), ..DenseParameters::default() };
    DenseConfig { reference, brightness, range, parameters: checked }
}

/// A refinement with every step.
const FILLED: Option<Refinement> =
    Some(Refinement { support: 9, majority: true, medians_before: 1, fill: true, medians_after: 1 });

fn costs(reference: View, window: u32, paths: Option<Paths>, cross_check: CrossCheck) -> DenseConfig {
    let part = |weight, limit| Difference { weight, limit };
    // With the right view as the reference, all texture costs the same.
    let weak_spread = (reference == View::Left).then_some(700);
    let cost = Cost { census: 40, difference: part(16, 24), gradient: part(8, 32), weak_spread };
    let penalties = Penalties { p1: 16, p2: 120, least_p2: 24, p2_scale: 8 };
    let semi_global = paths.map(|paths| SemiGlobal { penalties, paths });
    config(reference).with(|parameters| {
        parameters.aggregation =
            Aggregation::Costs(CostAggregation { cost, window, semi_global, cross_check, search: Search::Whole });
        parameters.refinement = FILLED;
    })
}

fn coarse_to_fine(reference: View) -> DenseConfig {
    let aggregation = Aggregation::Sad { side: 5, search: Search::CoarseToFine, compared: Compared::Luma };
    config(reference).with(|parameters| parameters.aggregation = aggregation)
}

/// Soft ranks, checked for agreement of neighbours, with or without a refinement after it.
fn agreeing(reference: View, search: Search, refinement: Option<Refinement>) -> DenseConfig {
    config(reference).with(|parameters| {
        parameters.aggregation = Aggregation::Sad { side: 5, search, compared: Compared::SoftRank };
        parameters.agreement = 4;
        parameters.refinement = refinement;
    })
}

#[test]
fn the_twins_end_with_the_same_bytes() {
    for Size { width, height } in SIZES {
        let (left, right) = pair(width, height);
        for (reference, config) in [
            (View::Left, config(View::Left)),
            (View::Right, config(View::Right)),
            (View::Left, coarse_to_fine(View::Left)),
            (View::Right, coarse_to_fine(View::Right)),
            (View::Left, agreeing(View::Left, Search::Whole, None)),
            (View::Right, agreeing(View::Right, Search::CoarseToFine, FILLED)),
            (View::Left, costs(View::Left, 1, Some(Paths::Three), CrossCheck::Claimed)),
            (View::Right, costs(View::Right, 1, Some(Paths::Four), CrossCheck::Searched)),
            (View::Left, costs(View::Left, 5, None, CrossCheck::Searched)),
            (View::Right, costs(View::Right, 3, Some(Paths::Three), CrossCheck::Claimed)),
        ] {
            let (left, right) = (left.clone(), right.clone());
            let what = format!("{width}x{height} {reference:?}");
            assert_twin(&what, &DenseTrial { left, right, config, band_rows: u32::MAX });
        }
    }
}

/// Whether one thread follows a line or threads share the disparities, in one band and in several.
#[test]
fn both_plans_end_with_the_same_bytes() {
    let (left, right) = pair(130, 67);
    let device = gpu().clone().with_sgm_plan(SgmPlan::Lanes);
    let kernels = |gpu: &Gpu, config: &DenseConfig| {
        let matcher = block_on(Matcher::new_async(gpu, (130, 67), config)).unwrap();
        block_on(matcher.profile()).unwrap().1.into_iter().map(|(kernel, _)| kernel).collect::<BTreeSet<_>>()
    };
    for config in [
        costs(View::Left, 1, Some(Paths::Three), CrossCheck::Claimed),
        costs(View::Right, 1, Some(Paths::Eight), CrossCheck::Searched),
        costs(View::Left, 5, None, CrossCheck::Searched),
        costs(View::Right, 3, Some(Paths::Four), CrossCheck::Claimed),
    ] {
        let (here, there) = (kernels(gpu(), &config), kernels(&device, &config));
        let follows =
            matches!(&config.parameters.aggregation, Aggregation::Costs(costs) if costs.semi_global.is_some());
        assert!(here.contains("select") && !here.contains("lane_path"), "{here:?}");
        assert_eq!(there.contains("lane_path") && there.contains("lane_select"), follows, "{there:?}");
        for band_rows in [u32::MAX, 19] {
            let (left, right) = (left.clone(), right.clone());
            let trial = DenseTrial { left, right, config: config.clone(), band_rows };
            for comparison in compare(&trial, &Bench::new(&device)).expect("a device that works") {
                assert_eq!(comparison.fault, None, "bands of {band_rows}");
            }
        }
    }
}

/// The pair where the matcher reads it.
fn write(matcher: &Matcher, left: &Luma, right: &Luma) {
    for (view, luma) in [left, right].into_iter().zip(matcher.luma()) {
        bench().write(luma, &pack(view));
    }
}

#[test]
fn bands_leave_no_trace() {
    let (left, right) = pair(130, 131);
    for config in [
        config(View::Left),
        coarse_to_fine(View::Left),
        agreeing(View::Left, Search::CoarseToFine, None),
        agreeing(View::Right, Search::Whole, FILLED),
        costs(View::Right, 1, Some(Paths::Three), CrossCheck::Claimed),
        costs(View::Left, 1, Some(Paths::Eight), CrossCheck::Searched),
        costs(View::Left, 5, None, CrossCheck::Claimed),
        costs(View::Left, 3, Some(Paths::Four), CrossCheck::Claimed),
    ] {
        in_bands(&left, &right, &config);
    }
}

fn in_bands(left: &Luma, right: &Luma, config: &DenseConfig) {
    let whole = block_on(dense::compute(gpu(), left, right, config)).unwrap();
    assert!(coverage(&whole.disparity) > 0.3);
    for rows in [1, 7, 64, 130] {
        let banded = block_on(Matcher::with_band_rows(gpu(), (130, 131), config, rows)).unwrap();
        write(&banded, left, right);
        // Whole cells, where each has a range of its own.
        let in_cells = matches!(config.parameters.aggregation, Aggregation::Sad { search: Search::CoarseToFine, .. });
        let rows_of_band = if in_cells { (rows / CELL * CELL).max(CELL) } else { rows };
        assert_eq!(banded.bands(), 131_usize.div_ceil(rows_of_band as usize));
        let banded = banded.run().unwrap();
        assert_same(&format!("bands of {rows}"), banded.disparity.data(), whole.disparity.data());
        assert_same(&format!("bands of {rows}"), banded.confidence.data(), whole.confidence.data());
    }
}

#[test]
fn twice_in_one_encoder_and_after_garbage() {
    let (left, right) = pair(97, 33);
    let expected = block_on(dense::compute(gpu(), &left, &right, &config(View::Left))).unwrap();
    let matcher = Matcher::new(gpu(), (97, 33), &config(View::Left)).unwrap();
    write(&matcher, &left, &right);
    let maps = [0; 2].map(|_| [0; 2].map(|_| upload(&vec![7_u32; 97 * 33])));
    let outputs = maps.each_ref().map(|[disparities, confidences]| {
        matcher.outputs(Destination::Buffer(disparities), Some(confidences)).unwrap()
    });
    bench().run(|encoder| {
        matcher.record_luma(encoder, &outputs[0]);
        matcher.record_luma(encoder, &outputs[1]);
    });
    for [disparities, confidences] in &maps {
        assert_same("disparities", &download::<i32>(disparities), expected.disparity.data());
        let (packed, rest) = (pack(&expected.confidence), vec![7; 97 * 33 - 25 * 33]);
        assert_same("confidences", &download::<u32>(confidences), &[packed, rest].concat());
    }
}

/// An executor may move the future to another thread, and need not know that there is a device to be polled.
#[test]
fn awaited_where_nobody_polls_the_device() {
    fn sent<F: Future + Send>(future: F) -> F {
        future
    }
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let (left, right) = pair(97, 33);
        let own = strict();
        let config = config(View::Left);
        let compute = sent(dense::compute(&own, &left, &right, &config));
        sender.send(pollster::block_on(compute)).unwrap();
    });
    let awaited = receiver.recv_timeout(Duration::from_secs(120)).expect("a future that ends").unwrap();
    let (left, right) = pair(97, 33);
    let expected = compute(&left, &right, &config(View::Left)).unwrap();
    assert_same("disparities", awaited.disparity.data(), expected.disparity.data());
}

#[test]
fn several_threads_wait_for_one_device() {
    let (left, right) = pair(97, 33);
    let expected = compute(&left, &right, &config(View::Left)).unwrap();
    let matcher = Matcher::new(gpu(), (97, 33), &config(View::Left)).unwrap();
    write(&matcher, &left, &right);
    thread::scope(|scope| {
        let threads = [0; 4].map(|_| scope.spawn(|| [0; 5].map(|_| matcher.run().unwrap())));
        for maps in threads.map(|thread| thread.join().unwrap()) {
            maps.iter().for_each(|map| assert_same("disparities", map.disparity.data(), expected.disparity.data()));
        }
    });
}

#[test]
fn what_cannot_be_is_refused_by_both_alike() {
    let (left, right) = pair(40, 30);
    let far = DenseConfig::new(DisparityRange::new(40, 8).unwrap());
    let even = config(View::Left).with_window(8);
    let unsure = config(View::Left).with(|parameters| parameters.uniqueness = 101);
    let even_costs = costs(View::Left, 4, None, CrossCheck::Claimed);
    let wide_costs = costs(View::Left, 33, Some(Paths::Three), CrossCheck::Claimed);
    for config in [far, even, unsure, even_costs, wide_costs] {
        let device = block_on(dense::compute(gpu(), &left, &right, &config)).unwrap_err();
        let twin = compute(&left, &right, &config).unwrap_err();
        assert!(matches!(device, Error::Parameter { .. }), "{device}");
        assert_eq!(device.to_string(), twin.to_string());
    }
    let small = Luma::filled((39, 30), 0);
    assert!(matches!(
        block_on(dense::compute(gpu(), &left, &small, &config(View::Left))),
        Err(Error::SizesDiffer { .. })
    ));
}

/// A device of the same adapter with the smallest limits of WebGPU.
fn strict() -> Gpu {
    with_limits(wgpu::Limits::downlevel_defaults())
}

fn with_limits(required_limits: wgpu::Limits) -> Gpu {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).unwrap();
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    Gpu::new(device, queue)
}

/// A device that binds less than a pair's maps and transforms need: the result is the same.
#[test]
fn no_buffer_needs_to_hold_a_whole_view() {
    let (left, right) = pair(400, 300);
    let small = wgpu::Limits { max_storage_buffer_binding_size: 300_000, ..wgpu::Limits::downlevel_defaults() };
    let small = with_limits(small);
    for config in [
        costs(View::Left, 1, Some(Paths::Three), CrossCheck::Claimed),
        costs(View::Right, 1, Some(Paths::Four), CrossCheck::Searched),
        costs(View::Left, 5, None, CrossCheck::Claimed),
        costs(View::Right, 3, Some(Paths::Three), CrossCheck::Claimed),
        coarse_to_fine(View::Right),
        agreeing(View::Left, Search::CoarseToFine, None),
        config(View::Left).with(|parameters| {
            parameters.refinement = costs(View::Left, 1, None, CrossCheck::Claimed).parameters.refinement;
        }),
    ] {
        // Rays from a hole reach farther than this view is high: see the next test.
        let config = config.with(|parameters| {
            parameters.refinement.iter_mut().for_each(|refinement| refinement.fill = false);
        });
        assert_same_on(&small, [&left, &right], &config);
    }
}

/// The same for the filling, in a view that is higher than rays are long.
#[test]
fn no_buffer_of_the_filling_needs_to_hold_a_whole_view() {
    let (left, right) = pair(50, 1400);
    let small = wgpu::Limits { max_storage_buffer_binding_size: 250_000, ..wgpu::Limits::downlevel_defaults() };
    let small = with_limits(small);
    for view in View::ALL {
        assert_same_on(&small, [&left, &right], &costs(view, 1, Some(Paths::Three), CrossCheck::Claimed));
    }
}

/// Asserts that a device gives the result of the shared one.
fn assert_same_on(device: &Gpu, [left, right]: [&Luma; 2], config: &DenseConfig) {
    let expected = block_on(dense::compute(gpu(), left, right, config)).unwrap();
    let actual = block_on(dense::compute(device, left, right, config)).unwrap();
    assert_same("disparities", actual.disparity.data(), expected.disparity.data());
    assert_same("confidences", actual.confidence.data(), expected.confidence.data());
}

/// 36 megapixels: their disparities are more than one binding of 128 MiB holds.
#[test]
fn a_pair_too_large_for_one_buffer() {
    let (width, height) = (6000, 6000);
    let tile = picture((300, 200), 17);
    let right = Luma::from_fn((width, height), |x, y| tile.get((x + y / 200 * 7) % 300, y % 200));
    let left = Luma::from_fn((width, height), |x, y| right.get_clamped(i64::from(x) - 3, i64::from(y)));
    let config = DenseConfig::new(DisparityRange::new(0, 5).unwrap()).with_window(3);
    let dense = block_on(dense::compute(&strict(), &left, &right, &config)).unwrap();
    // The twin on cuts of it, without the rows whose windows see the cut; the second has the border
    // between two bands in its middle.
    let rows = 20;
    for first in [0, height / 2 - rows / 2, height - rows] {
        let cut = |view: &Luma| Luma::from_fn((width, rows), |x, y| view.get(x, first + y));
        let twin = compute(&cut(&left), &cut(&right), &config).unwrap();
        for y in 1..rows - 1 {
            let (actual, expected) = (dense.disparity.row(first + y), twin.disparity.row(y));
            assert_same(&format!("row {}", first + y), actual, expected);
        }
    }
}

#[test]
fn lines_that_lavapipe_would_not_follow_to_their_end_are_refused() {
    let is_lavapipe = gpu().info().driver == "llvmpipe";
    let config = Preset::Balanced.dense_config(DisparityRange::new(0, 16).unwrap());
    for size in [Size::new(65_001, 5), Size::new(5, 65_001)] {
        let view = Luma::filled(size, 90);
        let error = block_on(dense::compute(gpu(), &view, &view, &config)).err().map(|error| error.to_string());
        assert_eq!(error.is_some(), is_lavapipe, "{error:?}");
        assert!(error.is_none_or(|error| error.contains("65001") && error.contains("in tiles, or on another device")));
    }
}

#[test]
fn no_preset_trusts_pairs_that_show_nothing() {
    let noise = |seed| Luma::from_fn((41, 30), |x, y| picture((1, 1), seed + 41 * y + x).get(0, 0));
    let pairs = [
        ("black", Luma::filled((41, 30), 0), Luma::filled((41, 30), 0)),
        ("grey and white", Luma::filled((41, 30), 90), Luma::filled((41, 30), 255)),
        ("noise", noise(1), noise(5000)),
    ];
    for preset in [Preset::Fast, Preset::Balanced, Preset::Quality] {
        // One disparity, some of them negative, more than the picture has columns.
        for (min, count) in [(3, 1), (-9, 17), (0, 500)] {
            let config = preset.dense_config(DisparityRange::new(min, count).unwrap());
            for (name, left, right) in &pairs {
                let what = format!("{preset:?}, {name}, {count} from {min}");
                let actual = block_on(dense::compute(gpu(), left, right, &config)).unwrap();
                let expected = compute(left, right, &config).unwrap();
                assert_same(&what, actual.disparity.data(), expected.disparity.data());
                assert_same(&what, actual.confidence.data(), expected.confidence.data());
                // With one disparity there is nothing to choose; and some columns of blocks have one only.
                assert!(count == 1 || actual.measured() < 0.2, "{what}: {}", actual.measured());
            }
        }
    }
}

#[test]
fn a_profile_has_a_time_for_each_kernel_and_the_same_map() {
    let (left, right) = (picture((60, 50), 31), picture((60, 50), 32));
    let config = coarse_to_fine(View::Left);
    let matcher = Matcher::new(gpu(), (60, 50), &config).unwrap();
    write(&matcher, &left, &right);
    if !gpu().device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        assert!(matches!(block_on(matcher.profile()), Err(Error::Unsupported(_))));
        return;
    }
    let (dense, times) = block_on(matcher.profile()).unwrap();
    assert_eq!(dense, matcher.run().unwrap());
    let names: Vec<_> = times.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, matcher.dispatches().iter().map(|dispatch| dispatch.kernel).collect::<Vec<_>>());
    let first = ["halve", "halve", "pad", "pad", "block_match", "block_match", "cell_ranges"];
    assert_eq!((&names[..7], names.last()), (&first[..], Some(&"block_match")));
    assert!(times.iter().all(|(_, time)| !time.is_zero()), "{times:?}");
}
