//! Removal of what does not show the scene, from the definition.

use crate::{
    dense::{Dense, View, kernels::Loss},
    disparity::{NONE, SCALE},
    image::{Luma, Size},
};

/// Removes from the map of a view what does not show the scene, in a mask of the view and one of the other view, which are 0 for a
/// hidden pixel: the disparities of hidden pixels, and what pixels lose whose partner, at the nearest whole disparity, is hidden.
/// Beyond the edges of the other view its mask goes on. `None`: the whole view shows the scene.
pub fn unseen(dense: &mut Dense, view: View, own: Option<&Luma>, other: Option<&Luma>, loss: Loss) {
    let Size { width, height } = dense.disparity.size();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let disparity = dense.disparity.get(x, y);
        let is_hidden = own.is_some_and(|mask| mask.get(x, y) == 0);
        let has_hidden_partner = |mask: &Luma| {
            let whole = (i64::from(disparity) + i64::from(SCALE) / 2).div_euclid(SCALE.into());
            let partner = i64::from(x) + i64::from(view.direction()) * whole;
            disparity != NONE && mask.get_clamped(partner, y.into()) == 0
        };
        let is_alone = loss != Loss::Nothing && other.is_some_and(has_hidden_partner);
        if is_hidden || is_alone && loss == Loss::Disparity {
            dense.disparity.set(x, y, NONE);
        }
        if is_hidden || is_alone {
            dense.confidence.set(x, y, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Plane;

    #[test]
    fn hidden_pixels_and_hidden_partners_are_not_seen() {
        let dense = Dense {
            disparity: Plane::new((4, 1), vec![2 * SCALE, NONE, SCALE, SCALE + 127]).unwrap(),
            confidence: Plane::new((4, 1), vec![9, 0, 8, 7]).unwrap(),
        };
        let hides = |place: u32| Luma::from_fn((4, 1), |x, _| if x == place { 0 } else { 255 });
        let without = |view, own: Option<&Luma>, other: Option<&Luma>, loss| {
            let mut dense = dense.clone();
            unseen(&mut dense, view, own, other, loss);
            (dense.disparity.into_data(), dense.confidence.into_data())
        };
        // Partners: beyond the left edge, none, 1 and 2.
        let left = without(View::Left, Some(&hides(0)), Some(&hides(2)), Loss::Disparity);
        assert_eq!(left, (vec![NONE, NONE, SCALE, NONE], vec![0, 0, 8, 0]));
        let left = without(View::Left, None, Some(&hides(0)), Loss::Confidence);
        assert_eq!(left, (dense.disparity.data().to_vec(), vec![0, 0, 8, 7]));
        // Partners: 2, none, 3, and beyond the right edge.
        let right = without(View::Right, None, Some(&hides(2)), Loss::Confidence);
        assert_eq!(right, (dense.disparity.data().to_vec(), vec![0, 0, 8, 7]));
        let right = without(View::Right, Some(&hides(1)), Some(&hides(3)), Loss::Nothing);
        assert_eq!(right, (dense.disparity.data().to_vec(), dense.confidence.data().to_vec()));
    }
}
