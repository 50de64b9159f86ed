//! What the other view sees, told from one view's winners.

use hsad::{
    dense::{Claim, View, VolumeBand},
    disparity::{DisparityRange, NONE, SCALE},
    image::Plane,
    reference::claimed,
};

use crate::common::*;

/// The disparities of the claims that hold, after as many words of something else in front of the keys.
fn on_device(winners: &Plane<Option<(u32, i32)>>, view: View, range: DisparityRange) -> Vec<i32> {
    let device = &gpu().device;
    let (width, rows) = winners.size();
    let key = |&(cost, disparity): &(u32, i32)| cost << 16 | (disparity - range.min) as u32;
    let keys = winners.data().iter().map(|winner| winner.as_ref().map_or(u32::MAX, key));
    let matches = upload(&[7, 8].into_iter().chain(keys).collect::<Vec<u32>>());
    let claims = upload(&vec![0_u32; (width * rows) as usize]);
    let band = VolumeBand { width, first_row: 0, rows, range };
    let dispatch = Claim::new(device).prepare(device, &band, view, 2, &matches, &claims);
    run(|encoder| dispatch.record(encoder));
    let disparity = |&claim: &u32| match claim {
        0 => NONE,
        claim => (range.min + (!claim & 0xffff) as i32) * SCALE,
    };
    download::<u32>(&claims).iter().map(disparity).collect()
}

#[test]
fn the_twin_lets_the_same_claims_hold() {
    let range = DisparityRange::new(-5, 30).unwrap();
    for (width, height) in SIZES {
        for view in [View::Left, View::Right] {
            let (costs, disparities) = (picture(width, height, 111), picture(width, height, 112));
            let winners = Plane::from_fn(width, height, |x, y| {
                let cost = u32::from(costs.get(x, y) / 16);
                (cost > 2).then(|| (cost, range.min + i32::from(disparities.get(x, y)) % 30))
            });
            let expected = claimed(&winners, view);
            assert_same(&format!("{width}x{height} {view:?}"), &on_device(&winners, view, range), expected.data());
        }
    }
}

#[test]
fn by_hand() {
    // Pixels 2 and 3 both claim pixel 1 of the right view, of which the second is cheaper; 0 leads outside.
    let winners = Plane::new(4, 1, vec![Some((1, 1)), None, Some((9, 1)), Some((4, 2))]).unwrap();
    let range = DisparityRange::new(0, 3).unwrap();
    assert_eq!(on_device(&winners, View::Left, range), [NONE, 2 * SCALE, NONE, NONE]);
}
