//! Conversion of texels to RGBA8, from the definition.

use super::{
    luma_texture::{Texels, level},
    rgba,
};
use crate::image::Plane;

/// The colours of texels, with an alpha of 255.
pub fn rgba_texture(texels: &Texels) -> Plane<[u8; 4]> {
    match texels {
        Texels::Rgba(picture) => picture.map(|&[r, g, b, _]| [r, g, b, 255]),
        Texels::Grey(picture) => rgba(picture),
        Texels::RgbaHalf(picture) => picture.map(|&[r, g, b, _]| [level(r), level(g), level(b), 255]),
        Texels::GreyHalf(picture) => rgba(&picture.map(|&grey| level(grey))),
    }
}
