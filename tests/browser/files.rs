//! Picture files that browsers and the library decode to different bytes by default.

use std::io::Cursor;

use hsad::{image::Size, io::Picture};
use image::{
    DynamicImage, GrayAlphaImage, ImageBuffer, ImageFormat, LumaA, Rgb, RgbImage, Rgba, RgbaImage,
    codecs::jpeg::JpegEncoder,
};

const SIZE: Size = Size::new(24, 16);

/// All files, with their names.
pub fn all() -> Vec<(&'static str, Vec<u8>)> {
    let Size { width, height } = SIZE;
    let picture = Picture::from_fn((width, height), |x, y| [(x * 10) as u8, (y * 15) as u8, (200 - 3 * x) as u8, 255]);
    let grey = GrayAlphaImage::from_fn(width, height, |x, y| LumaA([(7 * x + 3 * y) as u8, (9 * x) as u8]));
    // Values whose upper bytes rounding to 8 bits would change.
    let deep = ImageBuffer::from_fn(width, height, |x, y| Rgb([x, y, x + y].map(|v| (v * 1500 + 255) as u16)));
    vec![
        ("transparent.png", transparent_png(&picture)),
        ("grey.png", encoded(&grey.into(), ImageFormat::Png)),
        ("deep.png", encoded(&DynamicImage::ImageRgb16(deep), ImageFormat::Png)),
        ("palette.png", palette_png()),
        ("photograph.jpg", jpeg(&picture)),
        ("photograph.tiff", encoded(&rgb(&picture).into(), ImageFormat::Tiff)),
    ]
}

/// The picture with pixels of every opacity.
pub fn transparent_png(picture: &Picture) -> Vec<u8> {
    let pixel = |x, y| {
        let [red, green, blue] = picture.rgb(x, y);
        Rgba([red, green, blue, (x * 37 + y * 11) as u8])
    };
    encoded(&RgbaImage::from_fn(picture.width(), picture.height(), pixel).into(), ImageFormat::Png)
}

pub fn jpeg(picture: &Picture) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 95).encode_image(&rgb(picture)).unwrap();
    bytes
}

/// A palette with transparency, and a gamma that is not a screen's.
fn palette_png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIZE.width, SIZE.height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette((0..=255).flat_map(|index: u8| [index, 255 - index, index / 2]).collect::<Vec<_>>());
    encoder.set_trns((0..=255).rev().collect::<Vec<u8>>());
    encoder.set_source_gamma(png::ScaledFloat::new(1.0));
    let indices: Vec<u8> = (0..SIZE.width * SIZE.height).map(|index| (index * 5) as u8).collect();
    encoder.write_header().unwrap().write_image_data(&indices).unwrap();
    bytes
}

fn rgb(picture: &Picture) -> RgbImage {
    RgbImage::from_fn(picture.width(), picture.height(), |x, y| Rgb(picture.rgb(x, y)))
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}
