use hsad::{
    dense::Dense,
    disparity::{NONE, SCALE},
    image::Plane,
    internals::dense::PointRule,
    verify::trials::PointCountsTrial,
};

use super::depth_texture::map;
use crate::common::{SIZES, assert_twin, leaves};

#[test]
fn by_hand() {
    let disparity = Plane::new((3, 2), vec![SCALE, SCALE - 1, NONE, 9 * SCALE, 8 * SCALE, 7 * SCALE]).unwrap();
    let dense = Dense { confidence: Plane::new((3, 2), vec![16, 255, 255, 15, 16, 17]).unwrap(), disparity };
    let counts = |least, min_confidence| {
        leaves(&PointCountsTrial { dense: dense.clone(), rule: PointRule { least, min_confidence } })
    };
    assert_eq!(counts(SCALE, 16), [vec![1_u32, 2].into()]);
    assert_eq!(counts(NONE + 1, 0), [vec![2_u32, 3].into()]);
    assert_eq!(counts(i32::MAX, 0), [vec![0_u32, 0].into()]);
}

#[test]
fn equals_the_twin_at_every_size() {
    for size in SIZES {
        let trial = PointCountsTrial { dense: map(size), rule: PointRule { least: -3 * SCALE, min_confidence: 90 } };
        assert_twin(&size.to_string(), &trial);
    }
}
