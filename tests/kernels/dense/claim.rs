//! The other view's disparities, claimed by the winners of one view.

use hsad::{
    dense::View,
    disparity::{DisparityRange, NONE, SCALE},
    image::{Plane, Size},
    verify::trials::ClaimTrial,
};

use crate::common::*;

#[test]
fn the_twin_lets_the_same_claims_hold() {
    let range = DisparityRange::new(-5, 30).unwrap();
    for Size { width, height } in SIZES {
        for view in [View::Left, View::Right] {
            let (costs, disparities) = (picture((width, height), 111), picture((width, height), 112));
            let winners = Plane::from_fn((width, height), |x, y| {
                let cost = u32::from(costs.get(x, y) / 16);
                (cost > 2).then(|| (cost, range.min + i32::from(disparities.get(x, y)) % 30))
            });
            assert_twin(&format!("{width}x{height} {view:?}"), &ClaimTrial { winners, view, range, spare_rows: 1 });
        }
    }
}

#[test]
fn by_hand() {
    // Pixels 2 and 3 both claim pixel 1 of the right view, pixel 3 at a lower cost; the partner of pixel 0 lies
    // outside.
    let winners = Plane::new((4, 1), vec![Some((1, 1)), None, Some((9, 1)), Some((4, 2))]).unwrap();
    let range = DisparityRange::new(0, 3).unwrap();
    let trial = ClaimTrial { winners, view: View::Left, range, spare_rows: 1 };
    assert_eq!(leaves(&trial), [vec![NONE, 2 * SCALE, NONE, NONE].into()]);
}
