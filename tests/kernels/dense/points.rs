use hsad::{
    dense::Dense,
    disparity::{NONE, SCALE},
    image::{Plane, Size},
    internals::dense::{PointLayout, PointRule},
    verify::{Values, trials::PointsTrial},
};

use super::depth_texture::{map, table};
use crate::common::{SIZES, assert_twin, leaves, picture};

#[test]
fn by_hand() {
    let disparity = Plane::new((3, 2), vec![8 * SCALE, NONE, 13 * SCALE, SCALE, 28 * SCALE, 10 * SCALE]).unwrap();
    let dense = Dense { confidence: Plane::new((3, 2), vec![16, 255, 20, 255, 255, 9]).unwrap(), disparity };
    let trial = |capacity, instanced| PointsTrial {
        dense: dense.clone(),
        picture: Plane::from_fn((3, 2), |x, y| [x as u8, y as u8, 200, 77]),
        table: table(2.0).0,
        rule: PointRule { least: 3 * SCALE, min_confidence: 16 },
        layout: PointLayout { centre: [0.5, 1.0], capacity, instanced },
    };
    // 30 m px over 10, 15 and 30 px are 3, 2 and 1 m, of which a pixel shows 0.01 m, 2 / 300 m and 1 / 300 m.
    let by_pixel = [0.01, (2.0_f64 / 300.0) as f32, (1.0_f64 / 300.0) as f32];
    let positions = [
        [-0.5 * by_pixel[0], -by_pixel[0], 3.0],
        [1.5 * by_pixel[1], -by_pixel[1], 2.0],
        [0.5 * by_pixel[2], 0.0, 1.0],
    ];
    let attributes: Vec<u32> = vec![0x10c8_0000, 0x14c8_0002, 0xffc8_0101];
    let expected = |arguments: [u32; 4], count: usize| -> Vec<Values> {
        let positions = positions[..count].as_flattened().to_vec();
        vec![arguments.to_vec().into(), positions.into(), attributes[..count].to_vec().into()]
    };
    assert_eq!(leaves(&trial(6, 0)), expected([3, 1, 0, 0], 3));
    assert_eq!(leaves(&trial(3, 4)), expected([4, 3, 0, 0], 3));
    // Points beyond the capacity are left out.
    assert_eq!(leaves(&trial(2, 0)), expected([2, 1, 0, 0], 2));
}

#[test]
fn equals_the_twin_at_every_size() {
    // Rows longer than a workgroup, and more rows than its threads.
    for size in SIZES.into_iter().chain([Size::new(700, 3), Size::new(3, 700)]) {
        let channels = [5, 6, 7, 8].map(|seed| picture(size, seed));
        let trial = PointsTrial {
            dense: map(size),
            picture: Plane::from_fn(size, |x, y| channels.each_ref().map(|channel| channel.get(x, y))),
            table: table(-1.5).0,
            rule: PointRule { least: -3 * SCALE, min_confidence: 90 },
            layout: PointLayout { centre: [3.5, 2.25], capacity: size.pixels() as u32, instanced: 0 },
        };
        assert_twin(&size.to_string(), &trial);
    }
}
