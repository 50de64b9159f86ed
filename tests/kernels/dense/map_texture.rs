use hsad::{
    disparity::{DisparityMap, NONE, NONE_IN_PIXELS, SCALE},
    image::{Plane, Size},
    internals::dense::MapTexel,
    verify::trials::MapTextureTrial,
};

use crate::common::{SIZES, assert_twin, leaves, picture};

#[test]
fn by_hand() {
    let disparities = DisparityMap::new((3, 2), vec![0, 256, -128, NONE, 1, 16_000 * 256 + 3]).unwrap();
    for parts in [1, 2] {
        let trial = |texel| MapTextureTrial { disparities: disparities.clone(), texel, parts };
        assert_eq!(leaves(&trial(MapTexel::FixedPoint)), [disparities.data().to_vec().into()]);
        let pixels = vec![0.0_f32, 1.0, -0.5, NONE_IN_PIXELS, 1.0 / 256.0, 16_000.0 + 3.0 / 256.0];
        assert_eq!(leaves(&trial(MapTexel::Pixels)), [pixels.into()]);
    }
    assert_eq!(NONE_IN_PIXELS, -8_388_608.0);
}

#[test]
fn equals_the_twin_at_every_size() {
    for Size { width, height } in SIZES {
        let noise = picture((width, height), 3);
        let disparities = Plane::from_fn((width, height), |x, y| match noise.get(x, y) {
            grey if grey % 7 == 0 => NONE,
            grey => (i32::from(grey) - 100) * SCALE + (x * y) as i32 % SCALE,
        });
        for texel in MapTexel::ALL {
            let trial = MapTextureTrial { disparities: disparities.clone(), texel, parts: 3 };
            assert_twin(&format!("{width}x{height} {texel:?}"), &trial);
        }
    }
}
