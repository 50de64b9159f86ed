use hsad::{
    DisparityRange,
    dense::Dense,
    disparity::{NONE, SCALE},
    image::{Plane, Size},
    internals::dense::DepthTable,
    io::Calibration,
    verify::trials::DepthTextureTrial,
};

use crate::common::{SIZES, assert_twin, leaves, picture};

/// Disparities of both signs, none, and beyond any table; any confidences.
pub fn map(size: Size) -> Dense {
    let noise = [picture(size, 3), picture(size, 4)];
    let disparity = Plane::from_fn(size, |x, y| match noise[0].get(x, y) {
        grey if grey % 7 == 0 => NONE,
        grey => (i32::from(grey) - 100) * SCALE / 3 + (x * y) as i32 % SCALE,
    });
    Dense { disparity, confidence: noise[1].clone() }
}

/// Depths of 300 px focal length, 0.1 m baseline and disparities from -4 to 60 px.
pub fn table(doffs: f64) -> (DepthTable, Calibration) {
    let calibration = Calibration { focal: 300.0, baseline: 0.1, doffs, cx: 3.5, cy: 2.25, size: None };
    (DepthTable::new(DisparityRange::inclusive(-4, 60).unwrap(), &calibration), calibration)
}

#[test]
fn by_hand() {
    let disparities = [5 * SCALE, 2 * SCALE, -2 * SCALE, NONE, 60 * SCALE, 90 * SCALE];
    let disparity = Plane::new((3, 2), disparities.to_vec()).unwrap();
    let dense = Dense { confidence: Plane::filled((3, 2), 0), disparity };
    let trial = DepthTextureTrial { dense, table: table(2.0).0 };
    // 30 m px over 7, 4, 0 and 62 px; the last disparity lies beyond the table, whose end is 61 px.
    let expected = [30.0 / 7.0, 7.5, 0.0, 0.0, 30.0 / 62.0, 30.0 / 63.0].map(|depth: f64| depth as f32);
    assert_eq!(leaves(&trial), [expected.to_vec().into()]);
}

#[test]
fn equals_the_twin_at_every_size() {
    for size in SIZES {
        let trial = DepthTextureTrial { dense: map(size), table: table(-1.5).0 };
        assert_twin(&size.to_string(), &trial);
    }
}
