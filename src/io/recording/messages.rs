//! The messages of ROS that have pictures and calibrations.

use std::borrow::Cow;

use super::{
    Told,
    fields::{Encoding, Fields},
};
use crate::{image::Size, io::MAX_PIXELS};

/// Most coefficients of a distortion.
const MOST_COEFFICIENTS: u32 = 32;
const NANOSECONDS: u64 = 1_000_000_000;

/// What the messages of a topic are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Image,
    CompressedImage,
    CameraInfo,
}

impl Kind {
    /// The kind of the messages of a type.
    pub fn of(message_type: &str) -> Option<Self> {
        match message_type.strip_prefix("sensor_msgs/")? {
            "msg/Image" | "Image" => Some(Self::Image),
            "msg/CompressedImage" | "CompressedImage" => Some(Self::CompressedImage),
            "msg/CameraInfo" | "CameraInfo" => Some(Self::CameraInfo),
            _ => None,
        }
    }
}

/// Reads the header, whose time it returns in nanoseconds.
fn stamp(fields: &mut Fields<'_>) -> Told<u64> {
    if fields.encoding() == Encoding::Ros1 {
        let _sequence = fields.u32()?;
    }
    let (seconds, nanoseconds) = (fields.u32()?, fields.u32()?);
    let _frame = fields.text()?;
    Ok(u64::from(seconds) * NANOSECONDS + u64::from(nanoseconds))
}

/// The time of a message, in nanoseconds.
pub(super) fn stamp_of(message: &[u8], encoding: Encoding) -> Told<u64> {
    stamp(&mut Fields::of(message, encoding)?)
}

/// The picture of `sensor_msgs/CompressedImage`, as the file that it is.
pub(super) fn compressed_picture(message: &[u8], encoding: Encoding) -> Told<Cow<'_, [u8]>> {
    let mut fields = Fields::of(message, encoding)?;
    stamp(&mut fields)?;
    let format = fields.text()?;
    if format.contains("compressedDepth") {
        return Err("the topic has depths, and no pictures".into());
    }
    fields.bytes().map(Cow::Borrowed)
}

/// How the samples of a picture are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Layout {
    /// Samples per pixel.
    channels: usize,
    /// Bytes per sample.
    bytes: usize,
    /// Places of red, green and blue; `None`: grey.
    colours: Option<[usize; 3]>,
}

impl Layout {
    /// The layout of an encoding (`sensor_msgs/image_encodings.hpp`). A Bayer mosaic is grey, and is recognised as one later.
    fn of(encoding: &str) -> Option<Self> {
        const RGB: Option<[usize; 3]> = Some([0, 1, 2]);
        const BGR: Option<[usize; 3]> = Some([2, 1, 0]);
        let (channels, bytes, colours) = match encoding {
            "mono8" | "8UC1" | "bayer_rggb8" | "bayer_bggr8" | "bayer_gbrg8" | "bayer_grbg8" => (1, 1, None),
            "mono16" | "16UC1" | "bayer_rggb16" | "bayer_bggr16" | "bayer_gbrg16" | "bayer_grbg16" => (1, 2, None),
            "rgb8" => (3, 1, RGB),
            "bgr8" | "8UC3" => (3, 1, BGR),
            "rgba8" => (4, 1, RGB),
            "bgra8" | "8UC4" => (4, 1, BGR),
            "rgb16" => (3, 2, RGB),
            "bgr16" | "16UC3" => (3, 2, BGR),
            "rgba16" => (4, 2, RGB),
            "bgra16" | "16UC4" => (4, 2, BGR),
            _ => return None,
        };
        Some(Self { channels, bytes, colours })
    }
}

/// The picture of `sensor_msgs/Image`, as a PGM or PPM. Alpha, which cameras do not see, is left out.
pub(super) fn raw_picture(message: &[u8], encoding: Encoding) -> Told<Cow<'_, [u8]>> {
    let mut fields = Fields::of(message, encoding)?;
    stamp(&mut fields)?;
    let (height, width) = (fields.u32()?, fields.u32()?);
    let size = Size::new(width, height);
    let name = fields.text()?;
    let is_big_endian = fields.u8()? != 0;
    let step = fields.u32()? as usize;
    let samples = fields.bytes()?;
    let Layout { channels, bytes, colours } = Layout::of(&name).ok_or_else(|| {
        let name: String = name.chars().take(40).collect();
        format!(
            "pictures of the encoding {name:?} are not read: mono, rgb, bgr, rgba, bgra and bayer of 8 or 16 bits are"
        )
    })?;
    if width == 0 || height == 0 || size.pixels() > MAX_PIXELS {
        return Err(format!("the picture has {size} pixels: 1 to {MAX_PIXELS} are read"));
    }
    let row = width as usize * channels * bytes;
    let needed = step as u64 * u64::from(height - 1) + row as u64;
    if step < row || needed > samples.len() as u64 {
        return Err(format!(
            "{size} pixels of {name} with {step} bytes per row need {row} bytes per row and {needed} in all, and there are {}",
            samples.len()
        ));
    }
    let stored = colours.map_or(1, |colours| colours.len());
    let (letter, white) = (if stored == 1 { 5 } else { 6 }, if bytes == 1 { 255 } else { 65535 });
    let mut pnm = format!("P{letter} {width} {height} {white}\n").into_bytes();
    pnm.reserve(size.pixels() as usize * stored * bytes);
    for row in samples.chunks(step).take(height as usize).map(|line| &line[..row]) {
        let from = pnm.len();
        match colours {
            None => pnm.extend_from_slice(row),
            Some(places) => {
                for pixel in row.chunks_exact(channels * bytes) {
                    places.iter().for_each(|place| pnm.extend_from_slice(&pixel[place * bytes..(place + 1) * bytes]));
                }
            }
        }
        // Samples of a PNM are big endian.
        if bytes == 2 && !is_big_endian {
            pnm[from..].as_chunks_mut().0.iter_mut().for_each(|sample: &mut [u8; 2]| sample.reverse());
        }
    }
    Ok(pnm.into())
}

/// `sensor_msgs/CameraInfo`: the calibration of a camera, for the pictures that it sends. The message has that of all of the sensor's pixels; the
/// pictures are a part of these (`roi`), of which several make one (`binning`).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CameraInfo {
    pub size: Size,
    pub distortion_model: String,
    pub distortion: Vec<f64>,
    pub camera: [f64; 9],
    pub rectification: [f64; 9],
    pub projection: [f64; 12],
}

impl CameraInfo {
    pub(super) fn of(message: &[u8], encoding: Encoding) -> Told<Self> {
        let mut fields = Fields::of(message, encoding)?;
        stamp(&mut fields)?;
        let (height, width) = (fields.u32()?, fields.u32()?);
        let whole = Self {
            size: Size::new(width, height),
            distortion_model: fields.text()?,
            distortion: fields.list_of_floats(MOST_COEFFICIENTS)?,
            camera: fields.floats()?,
            rectification: fields.floats()?,
            projection: fields.floats()?,
        };
        let binning = [fields.u32()?, fields.u32()?];
        let (x, y, height, width) = (fields.u32()?, fields.u32()?, fields.u32()?, fields.u32()?);
        Ok(whole.of_part([x, y], Size::new(width, height)).binned(binning.map(|count| count.max(1))))
    }

    /// The calibration of a part of the picture, in pixels; a part of no size goes to the picture's end.
    fn of_part(mut self, from: [u32; 2], part: Size) -> Self {
        let side = |side: u32, whole: u32, from: u32| if side == 0 { whole.saturating_sub(from) } else { side };
        let size = Size::new(side(part.width, self.size.width, from[0]), side(part.height, self.size.height, from[1]));
        self.map_pixels([1.0; 2], from.map(|from| -f64::from(from)));
        Self { size, ..self }
    }

    /// The calibration of a picture whose pixels are as many of this one's: the centre of a pixel is that of those that it is made of.
    fn binned(mut self, [columns, rows]: [u32; 2]) -> Self {
        let scale = [columns, rows].map(|count| 1.0 / f64::from(count));
        self.map_pixels(scale, scale.map(|scale| (scale - 1.0) / 2.0));
        Self { size: Size::new(self.size.width / columns, self.size.height / rows), ..self }
    }

    /// Multiplies coordinates of pixels by `scale`, and adds `shift`, for columns and rows.
    fn map_pixels(&mut self, scale: [f64; 2], shift: [f64; 2]) {
        for (matrix, columns) in [(&mut self.camera[..], 3), (&mut self.projection[..], 4)] {
            let (pixels, last) = matrix.split_at_mut(2 * columns);
            for ((row, scale), shift) in pixels.chunks_mut(columns).zip(scale).zip(shift) {
                row.iter_mut().zip(&*last).for_each(|(value, last)| *value = *value * scale + shift * last);
            }
        }
    }

    /// Whether the camera was calibrated: drivers send zeros if not.
    pub(super) fn is_calibrated(&self) -> bool {
        self.camera[0] != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::{super::tests::image, *};

    #[test]
    fn pictures_of_every_encoding_by_hand() {
        for encoding in [Encoding::Cdr, Encoding::Ros1] {
            let pnm = |name, step, is_big_endian, samples: &[u8]| {
                let message = image(encoding, 5, (2, 2), name, is_big_endian, step, samples);
                raw_picture(&message, encoding).map(Cow::into_owned)
            };
            assert_eq!(pnm("mono8", 3, 0, &[1, 2, 0, 3, 4]).unwrap(), b"P5 2 2 255\n\x01\x02\x03\x04");
            assert_eq!(
                pnm("bgr8", 6, 0, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]).unwrap(),
                b"P6 2 2 255\n\x03\x02\x01\x06\x05\x04\x09\x08\x07\x0c\x0b\x0a"
            );
            let rgba: Vec<u8> = (1..=16).collect();
            assert_eq!(
                pnm("rgba8", 8, 0, &rgba).unwrap(),
                b"P6 2 2 255\n\x01\x02\x03\x05\x06\x07\x09\x0a\x0b\x0d\x0e\x0f"
            );
            let little = pnm("mono16", 4, 0, &[1, 0, 2, 0, 3, 0, 4, 9]).unwrap();
            assert_eq!(little, b"P5 2 2 65535\n\x00\x01\x00\x02\x00\x03\x09\x04");
            assert_eq!(pnm("16UC1", 4, 1, &[0, 1, 0, 2, 0, 3, 9, 4]).unwrap(), little);
            for (name, step, samples, told) in [
                ("mono8", 2, &[1, 2, 3][..], "need 2 bytes per row and 4 in all, and there are 3"),
                ("mono8", 1, &[1, 2, 3, 4], "with 1 bytes per row"),
                ("mono8", u32::MAX, &[1, 2, 3, 4], "in all"),
                ("yuv422_yuy2", 4, &[0; 8], "\"yuv422_yuy2\" are not read: mono, rgb"),
                ("32FC1", 8, &[0; 16], "not read"),
            ] {
                let error = pnm(name, step, 0, samples).unwrap_err();
                assert!(error.contains(told), "{error}");
            }
            for size in [(0, 2), (u32::MAX, u32::MAX), (1 << 20, 1 << 20)] {
                let error = raw_picture(&image(encoding, 5, size, "mono8", 0, size.0, &[1]), encoding).unwrap_err();
                assert!(error.contains("pixels: 1 to 134217728 are read"), "{error}");
            }
            let whole = image(encoding, 5, (2, 2), "mono8", 0, 2, &[1, 2, 3, 4]);
            assert_eq!(stamp_of(&whole, encoding), Ok(5));
            for length in 0..whole.len() {
                assert!(raw_picture(&whole[..length], encoding).is_err(), "{length}");
            }
        }
    }
}
