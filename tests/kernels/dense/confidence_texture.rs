use hsad::{
    image::{Plane, Size},
    verify::trials::ConfidenceTextureTrial,
};

use crate::common::{SIZES, assert_twin, leaves, picture};

#[test]
fn by_hand() {
    // The rows of bytes end with whole words.
    let confidences = Plane::new((5, 2), vec![0, 1, 2, 254, 255, 9, 8, 7, 6, 5]).unwrap();
    assert_eq!(leaves(&ConfidenceTextureTrial(confidences)), [vec![0_u32, 1, 2, 254, 255, 9, 8, 7, 6, 5].into()]);
}

#[test]
fn equals_the_twin_at_every_size() {
    for Size { width, height } in SIZES {
        assert_twin(&format!("{width}x{height}"), &ConfidenceTextureTrial(picture((width, height), 3)));
    }
}
