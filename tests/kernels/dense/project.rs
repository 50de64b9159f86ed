//! Projection of a map to the other view.

use hsad::{
    dense::View,
    disparity::NONE,
    image::{Plane, Size},
    verify::trials::ProjectTrial,
};

use crate::common::*;

#[test]
fn the_twin_projects_the_same() {
    for Size { width, height } in SIZES {
        for view in [View::Left, View::Right] {
            let disparities = picture((width, height), 131).map(|&value| match value {
                0..60 => NONE,
                value => (i32::from(value) - 90) * 61,
            });
            assert_twin(&format!("{width}x{height} {view:?}"), &ProjectTrial { disparities, view });
        }
    }
}

#[test]
fn the_nearest_surface_hides_the_others() {
    // Pixels 1 and 3 point at pixel 0 or 1 of the right view, at the nearest whole disparity, pixel 4 at pixel 1, too, with the
    // larger disparity; pixel 0 at a pixel outside, pixel 5 at pixel 6 with a negative disparity, which is one.
    let disparities = Plane::new((7, 1), vec![300, 383, NONE, 384, 768, -256, NONE]).unwrap();
    let word = |disparity: i32| disparity.cast_unsigned() ^ 1 << 31;
    let expected = vec![word(383), word(768), 0, 0, 0, 0, word(-256)];
    assert_eq!(leaves(&ProjectTrial { disparities, view: View::Left }), [expected.into()]);
}
