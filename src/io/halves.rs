//! Both views in one picture.

use super::decoded::Decoded;

/// Where the views lie in a picture that has both; each has half of its width or height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halves {
    /// The left view on the left, as for parallel viewing.
    LeftRight,
    /// The left view on the right, as for crossed eyes and in most JPS files.
    RightLeft,
    /// The left view on top.
    LeftOnTop,
    /// The right view on top.
    RightOnTop,
}

impl Halves {
    /// The place of the left view, in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::LeftRight => "on the left",
            Self::RightLeft => "on the right",
            Self::LeftOnTop => "on top",
            Self::RightOnTop => "below",
        }
    }

    /// The left and the right view; of an odd number of columns or rows the middle one is in neither. `None` if there is but one.
    pub(super) fn split(self, Decoded { image, orientation, doubt }: &Decoded) -> Option<[Decoded; 2]> {
        let is_beside = matches!(self, Self::LeftRight | Self::RightLeft);
        let (width, height) = (image.width(), image.height());
        let [half_width, half_height] = if is_beside { [width / 2, height] } else { [width, height / 2] };
        if half_width == 0 || half_height == 0 {
            return None;
        }
        let part = |x, y| Decoded {
            image: image.crop_imm(x, y, half_width, half_height),
            orientation: *orientation,
            doubt: doubt.clone(),
        };
        let (first, second) = (part(0, 0), part(width - half_width, height - half_height));
        Some(if matches!(self, Self::LeftRight | Self::LeftOnTop) { [first, second] } else { [second, first] })
    }
}

#[cfg(test)]
mod tests {
    use ::image::{DynamicImage, GrayImage, Luma};

    use super::*;

    #[test]
    fn halves_by_hand() {
        let grey = |x: u32, y: u32| Luma([(10 * y + x) as u8]);
        let picture =
            |width, height| Decoded::upright(DynamicImage::ImageLuma8(GrayImage::from_fn(width, height, grey)));
        let halves = |halves: Halves, width, height| {
            halves.split(&picture(width, height)).map(|views| views.map(|view| view.image.into_luma8().into_raw()))
        };
        let [left, right] = [vec![0, 1, 10, 11], vec![3, 4, 13, 14]];
        assert_eq!(halves(Halves::LeftRight, 5, 2), Some([left.clone(), right.clone()]));
        assert_eq!(halves(Halves::RightLeft, 5, 2), Some([right, left]));
        let [top, bottom] = [vec![0, 1], vec![20, 21]];
        assert_eq!(halves(Halves::LeftOnTop, 2, 3), Some([top.clone(), bottom.clone()]));
        assert_eq!(halves(Halves::RightOnTop, 2, 3), Some([bottom, top]));
        assert_eq!((halves(Halves::LeftRight, 1, 2), halves(Halves::RightOnTop, 2, 1)), (None, None));
    }
}
