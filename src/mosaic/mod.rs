//! Raw mosaics of Bayer colour filter arrays that were given as grey pictures.
//!
//! A mosaic has one colour per pixel: green where `x + y` has one parity, red and blue in alternate rows elsewhere (Bayer
//! 1976, US patent 3,971,065). As a grey picture it is the scene's luma plus carriers of the scene's colours (Alleysson,
//! Süsstrunk and Hérault 2005, Linear demosaicing inspired by the human visual system, IEEE Transactions on Image
//! Processing 14(4)):
//!
//! ```text
//! (R + 2 G + B) / 4  +  (R - B) / 4 ((-1)^x ± (-1)^y)  ±  (R - 2 G + B) / 4 (-1)^(x + y)
//! ```
//!
//! The carriers correspond to nothing: a disparity that is odd exchanges their signs. [`recognition`] sees them,
//! [`demosaic`] removes them.

mod carriers;
mod demosaic;
mod recognition;

use crate::{image::Luma, io::Picture};

/// The luma of the scene, if a picture is a mosaic; `luma` is that of the picture.
pub(crate) fn demosaicked(picture: &Picture, luma: &Luma) -> Option<Luma> {
    let green = recognition::green_parity(luma)?;
    let grey = picture.data().iter().all(|&[red, green, blue, _]| red == green && green == blue);
    grey.then(|| demosaic::luma_of_mosaic(luma, green))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene of two colours in patches of 40 px, brighter by 1 every 8 rows, as a mosaic: red at the even columns and rows.
    fn mosaic() -> Luma {
        let color = |x: u32, y: u32| if (x / 40 + y / 40).is_multiple_of(2) { [180, 120, 60] } else { [40, 90, 130] };
        Luma::from_fn((160, 120), |x, y| color(x, y)[(x % 2 + y % 2) as usize] + (y / 8) as u8)
    }

    #[test]
    fn a_grey_mosaic_is_demosaicked_and_a_colour_picture_is_not() {
        let mosaic = mosaic();
        let grey = mosaic.map(|&grey| [grey, grey, grey, 255]);
        let luma = demosaicked(&grey, &mosaic).unwrap();
        // (180 + 2 * 120 + 60) / 4 and (40 + 2 * 90 + 130) / 4 = 87.5, up; 2 brighter.
        assert_eq!([luma.get(20, 19), luma.get(21, 19), luma.get(21, 20)], [122; 3]);
        assert_eq!([luma.get(60, 19), luma.get(61, 19), luma.get(61, 20)], [90; 3]);
        let mut colored = grey;
        colored.set(159, 119, [1, 2, 3, 255]);
        assert_eq!(demosaicked(&colored, &mosaic), None);
    }
}
