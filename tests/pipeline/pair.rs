//! A pair of views on a device and on the CPU.

use std::path::Path;

use hsad::{
    Backend, Pair,
    config::Preset,
    disparity::DisparityRange,
    glam::DVec2,
    gpu::{DeviceChoice, block_on},
    io::load,
    rectify::WarpMap,
};

#[test]
fn a_warped_right_view_is_the_same_on_device_and_cpu() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/curved");
    let [left, right] = ["left.png", "right.png"].map(|name| load::load(&folder.join(name)).unwrap());
    let map = WarpMap::new(right.size(), right.size(), |p| p + DVec2::new(0.01 * p.y, 1.3 - 0.004 * p.x)).unwrap();
    let config = Preset::Fast.dense_config(DisparityRange::new(0, 32).unwrap());
    let [device, cpu] = [DeviceChoice::Best, DeviceChoice::Cpu].map(|choice| {
        let backend = Backend::open(&choice).expect("this test needs a device; lavapipe is one");
        let pair = block_on(Pair::new(&backend, &left, &right)).unwrap();
        let warped = block_on(pair.with_right_warped(&map)).unwrap();
        assert_eq!((warped.views().0, warped.size()), (pair.views().0, pair.size()));
        assert_ne!(warped.views().1, pair.views().1);
        // Dense matching reads the views on the device.
        let dense = block_on(warped.dense(&config)).unwrap();
        assert_ne!(dense, block_on(pair.dense(&config)).unwrap());
        (warped.views().1.clone(), dense)
    });
    assert!(device.0 == cpu.0, "luma of the right view");
    assert!(device.1 == cpu.1, "disparities and confidences");
}

#[test]
fn a_map_of_another_size_is_refused() {
    let picture = hsad::Picture::filled((9, 5), [7; 4]);
    let pair = block_on(Pair::new(&Backend::Cpu, &picture, &picture)).unwrap();
    for (size, source_size) in [((9, 4), (9, 5)), ((9, 5), (8, 5))] {
        let map = WarpMap::new(size, source_size, |p| p).unwrap();
        let error = block_on(pair.with_right_warped(&map)).unwrap_err().to_string();
        assert!(error.ends_with("but the views have 9x5: both sizes of the map must be 9x5"), "{error}");
    }
}
