//! Kamencay's method as a whole, compared with the twins.

use hsad::{
    Error,
    dense::{Brightness, View},
    disparity::{DisparityRange, SCALE},
    gpu::Gpu,
    image::Size,
    internals::{
        self,
        cpu::kamencay::{compute, compute_within},
    },
    io::Picture,
    kamencay::{self, KamencayConfig},
    wgpu,
};

use crate::common::*;

/// A picture of smooth noise in colour.
pub fn colours((width, height): (u32, u32), seed: u32) -> Picture {
    let channels = [0, 1, 2].map(|channel| picture((width, height), 3 * seed + channel));
    Picture::from_fn((width, height), |x, y| {
        let [red, green, blue] = [0, 1, 2].map(|channel: usize| channels[channel].get(x, y));
        [red, green, blue, 0]
    })
}

/// A right view, and a left view shifted by 5 px, plus 1 px per 16 rows.
fn pair(width: u32, height: u32) -> (Picture, Picture) {
    let right = colours((width, height), 1);
    let left =
        Picture::from_fn((width, height), |x, y| right.get_clamped(i64::from(x) - 5 - i64::from(y / 16), i64::from(y)));
    (left, right)
}

fn config(min: i32, count: u32) -> KamencayConfig {
    KamencayConfig::new(DisparityRange::new(min, count).unwrap())
}

fn compare(what: &str, (left, right): &(Picture, Picture), config: &KamencayConfig) {
    let actual = block_on(kamencay::compute(gpu(), left, right, config)).unwrap_or_else(|e| panic!("{what}: {e}"));
    let expected = compute(left, right, config).unwrap();
    assert_same(what, actual.disparity.data(), expected.disparity.data());
    assert_same(what, actual.confidence.data(), expected.confidence.data());
}

#[test]
fn the_twins_end_with_the_same_bytes() {
    for Size { width, height } in SIZES {
        for (min, count) in [(0, 13), (-2, 32)] {
            // At some of these sizes only disparity 0 gives a pixel a partner.
            compare(&format!("{width}x{height}"), &pair(width, height), &config(min, count));
        }
    }
    let brightness = Brightness { gain: 280, offset: -700 };
    compare("right view", &pair(97, 33), &KamencayConfig { reference: View::Right, brightness, ..config(0, 9) });
}

/// Views without texture, a single disparity, partners in a few columns only.
#[test]
fn what_shows_nothing_gives_a_map_and_no_panic() {
    let flat = |level: u8| Picture::filled((41, 30), [level; 4]);
    for (left, right) in [(flat(0), flat(0)), (flat(90), flat(255)), (colours((41, 30), 5), colours((41, 30), 77))] {
        for (min, count) in [(3, 1), (-9, 17), (0, 500), (-40, 3)] {
            compare(&format!("{count} from {min}"), &(left.clone(), right.clone()), &config(min, count));
        }
    }
}

#[test]
fn a_shifted_picture_is_found_in_either_view() {
    let right = colours((120, 60), 1);
    let left = Picture::from_fn((120, 60), |x, y| right.get_clamped(i64::from(x) - 7, y.into()));
    for reference in [View::Left, View::Right] {
        let config = KamencayConfig { reference, ..config(-3, 20) };
        let dense = block_on(kamencay::compute(gpu(), &left, &right, &config)).unwrap();
        let found = dense.disparity.data().iter().filter(|&&disparity| disparity == 7 * SCALE).count();
        assert!(found > 7000, "{reference:?}: {found} of 7200");
        assert!(dense.measured() > 0.85, "{}", dense.measured());
    }
}

#[test]
fn strips_are_those_of_the_twins_and_hardly_show() {
    let (left, right) = pair(130, 131);
    let config = config(0, 20);
    let whole = compute(&left, &right, &config).unwrap();
    for rows in [48, 60, 130] {
        let bytes = 16 * 130 * 5 * rows;
        let actual = block_on(internals::kamencay::compute_within(gpu(), &left, &right, &config, bytes)).unwrap();
        let expected = compute_within(&left, &right, &config, bytes).unwrap();
        assert_same("strips", actual.disparity.data(), expected.disparity.data());
        assert_same("strips", actual.confidence.data(), expected.confidence.data());
        let pixels = actual.disparity.data().iter().zip(whole.disparity.data());
        let others = pixels.filter(|(strip, whole)| strip != whole).count();
        assert!(others * 100 < whole.disparity.data().len(), "{rows} rows: {others} pixels differ");
    }
    let error = block_on(internals::kamencay::compute_within(gpu(), &left, &right, &config, 1000)).unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
}

#[test]
fn the_smallest_limits_are_enough() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).unwrap();
    let descriptor =
        wgpu::DeviceDescriptor { required_limits: wgpu::Limits::downlevel_defaults(), ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    let strict = Gpu::new(device, queue);
    let (left, right) = pair(97, 33);
    let actual = block_on(kamencay::compute(&strict, &left, &right, &config(0, 20))).unwrap();
    assert_same(
        "disparities",
        actual.disparity.data(),
        compute(&left, &right, &config(0, 20)).unwrap().disparity.data(),
    );
}

#[test]
fn what_cannot_be_is_refused_by_both_alike() {
    let (left, right) = pair(40, 30);
    let mut unknown = config(0, 9);
    unknown.parameters.levels = 7;
    for config in [config(40, 8), unknown] {
        let device = block_on(kamencay::compute(gpu(), &left, &right, &config)).unwrap_err();
        let twin = compute(&left, &right, &config).unwrap_err();
        assert!(matches!(device, Error::Parameter { .. }), "{device}");
        assert_eq!(device.to_string(), twin.to_string());
    }
    let other = colours((39, 30), 1);
    assert!(matches!(block_on(kamencay::compute(gpu(), &left, &other, &config(0, 9))), Err(Error::SizesDiffer { .. })));
    assert!(matches!(compute(&left, &other, &config(0, 9)), Err(Error::SizesDiffer { .. })));
}
