//! Masks: which pixels of a view show the scene.
//!
//! Nothing is seen where the alpha of a [`Picture`] is 0, and in constant borders, which rectified pictures and endoscopes
//! have. Such pixels bear no interest points, correspond to nothing and get no disparity.

mod borders;
mod unseen;

pub(crate) use borders::without_borders;
pub(crate) use unseen::{drowned, extended};

use crate::{
    features::Feature,
    image::{Luma, Plane, Size},
    io::Picture,
};

/// One value per pixel of a view: [`SEEN`], or 0 for a pixel that does not show the scene.
pub type Mask = Plane<u8>;

/// The value of a pixel that shows the scene.
pub const SEEN: u8 = 255;

/// The mask of a view from its alpha and its constant borders; `None` if every pixel shows the scene.
pub(crate) fn mask_of(picture: &Picture, luma: &Luma) -> Option<Mask> {
    let alpha = picture.map(|&[.., alpha]| if alpha == 0 { 0 } else { SEEN });
    let mask = without_borders(luma, alpha);
    mask.data().contains(&0).then_some(mask)
}

/// Whether an interest point and its surroundings, twice its scale around it, are seen.
pub(crate) fn is_seen(mask: &Mask, point: &Feature) -> bool {
    let reach = 2.0 * point.scale;
    let seen = |x: f32, y: f32| mask.get_clamped(x.round() as i64, y.round() as i64) != 0;
    let Feature { x, y, .. } = *point;
    [(0.0, 0.0), (reach, 0.0), (-reach, 0.0), (0.0, reach), (0.0, -reach)].into_iter().all(|(i, j)| seen(x + i, y + j))
}

/// Downscales a mask by an integer `factor`: a pixel is seen if its whole block is.
pub(crate) fn reduced(mask: &Mask, factor: u32) -> Mask {
    let Size { width, height } = mask.size();
    let mut small = Mask::filled((width.div_ceil(factor), height.div_ceil(factor)), SEEN);
    for y in 0..height {
        for (x, _) in (0..width).zip(mask.row(y)).filter(|&(_, &value)| value == 0) {
            small.set(x / factor, y / factor, 0);
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_is_a_mask() {
        let texture = |x: u32, y: u32| (17 * x + 31 * y) as u8;
        let opaque = Picture::from_fn((9, 7), |x, y| [texture(x, y), 0, 0, 1]);
        assert_eq!(mask_of(&opaque, &opaque.luma()), None);
        let cut = Picture::from_fn((9, 7), |x, y| [texture(x, y), 0, 0, if x == 4 { 0 } else { 255 }]);
        let mask = mask_of(&cut, &cut.luma()).unwrap();
        assert_eq!(mask, Plane::from_fn((9, 7), |x, _| if x == 4 { 0 } else { SEEN }));
        // One unseen pixel makes a block of 2x2 unseen.
        assert_eq!(reduced(&mask, 2), Plane::from_fn((5, 4), |x, _| if x == 2 { 0 } else { SEEN }));
    }
}
