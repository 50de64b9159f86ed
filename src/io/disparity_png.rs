//! Disparities as 16-bit grey PNG, the format of the KITTI benchmarks.
//!
//! A value is 256 times the disparity in pixels, and 0 stands for no disparity (Menze and Geiger, 'Object Scene Flow
//! for Autonomous Vehicles', CVPR 2015, development kit). The scale is this crate's fixed point, so nothing is rounded,
//! but the format is limited to 1/256 to 65535/256 px: a disparity of exactly 0 becomes 1/256 px.
//!
//! A map with disparities below 0 or from 256 px on is written with an offset, and in steps of more than 1/256 px if it spans
//! more than 254 px. Both stand in a text chunk of the PNG, which [`decode`] follows: `tEXt` with the keyword `hsad-disparity` and
//! the text `offset_px=-6 px_per_value=0.00390625`. A PFM ([`super::pfm`]) holds all disparities as they are.

use std::{
    io::{self, Write},
    path::Path,
};

use ::image::DynamicImage;

use super::{codec, malformed, png, png_text};
use crate::{
    disparity::{DisparityMap, NONE, SCALE},
    error::Result,
    image::Plane,
};

pub(super) use super::png_chunks::SIGNATURE;

/// Keyword of the text chunk that holds an [`Encoding`].
const KEYWORD: &str = "hsad-disparity";

/// What the values of a PNG stand for: `value * step` in 1/256 px, plus `offset` in pixels; 0 for no disparity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoding {
    /// What is added to every disparity, in whole pixels.
    pub offset: i32,
    /// Difference of two values that follow each other, in 1/256 px: a power of two.
    pub step: u32,
}

impl Encoding {
    /// The encoding of the KITTI benchmarks.
    pub const KITTI: Self = Self { offset: 0, step: 1 };
    /// Largest step, which the largest span of a map needs.
    const MOST: u32 = 1 << 17;

    /// The encoding that holds every disparity of `map`: KITTI's if that does, otherwise the one of the smallest step.
    pub fn of(map: &DisparityMap) -> Self {
        let known = || map.data().iter().copied().filter(|&d| d != NONE);
        let Some((least, most)) = known().min().zip(known().max()) else { return Self::KITTI };
        if least >= 0 && most <= u16::MAX.into() {
            return Self::KITTI;
        }
        let mut step = 1;
        loop {
            // One more pixel or step, so that no value is rounded to 0.
            let below = i64::from(least) - i64::from(step.max(SCALE as u32));
            let encoding = Self { offset: below.div_euclid(SCALE.into()) as i32, step };
            if encoding.value(most) <= u16::MAX.into() {
                return encoding;
            }
            step *= 2;
        }
    }

    /// Pixels per value.
    pub fn px_per_value(&self) -> f64 {
        f64::from(self.step) / f64::from(SCALE)
    }

    /// The value of a disparity in 1/256 px, rounded, at least 1.
    fn value(&self, disparity: i32) -> i64 {
        let from_offset = i64::from(disparity) - i64::from(self.offset) * i64::from(SCALE);
        ((from_offset + i64::from(self.step / 2)) / i64::from(self.step)).max(1)
    }

    /// The disparity of a value, in 1/256 px.
    fn disparity(&self, value: u16) -> i32 {
        if value == 0 {
            return NONE;
        }
        let disparity = i64::from(value) * i64::from(self.step) + i64::from(self.offset) * i64::from(SCALE);
        disparity.clamp((NONE + 1).into(), i32::MAX.into()) as i32
    }

    fn values(&self, map: &DisparityMap) -> Plane<u16> {
        map.map(|&d| if d == NONE { 0 } else { self.value(d).min(u16::MAX.into()) as u16 })
    }

    fn text(&self) -> String {
        format!("offset_px={} px_per_value={}", self.offset, self.px_per_value())
    }

    /// Parses [`Self::text`].
    fn parse(text: &str) -> Option<Self> {
        let (offset, step) = text.strip_prefix("offset_px=")?.split_once(" px_per_value=")?;
        let step = step.parse::<f64>().ok()? * f64::from(SCALE);
        let is_usable = step.fract() == 0.0 && (1.0..=Self::MOST.into()).contains(&step);
        Some(Self { offset: offset.parse().ok()?, step: is_usable.then_some(step as u32)? })
    }
}

/// Writes `map`, in 1/256 px, in the encoding that [`Encoding::of`] gives it.
///
/// # Errors
/// The errors of `out`.
pub fn write(out: &mut impl Write, map: &DisparityMap) -> io::Result<()> {
    let encoding = Encoding::of(map);
    let values = encoding.values(map);
    if encoding == Encoding::KITTI {
        return png::write_grey16(out, &values);
    }
    let mut bytes = Vec::new();
    png::write_grey16(&mut bytes, &values)?;
    out.write_all(&png_text::with_text(&bytes, KEYWORD, &encoding.text()))
}

/// Reads a disparity map, in 1/256 px.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn read(path: &Path) -> Result<DisparityMap> {
    decode(&codec::read_bytes(path)?, path)
}

/// Decodes the disparity map in a PNG's bytes, in 1/256 px; `path` is named in errors.
///
/// # Errors
/// [`crate::Error::Format`] if the bytes are no valid PNG of 16-bit grey, or its text of the offset is damaged.
pub fn decode(bytes: &[u8], path: &Path) -> Result<DisparityMap> {
    if !bytes.starts_with(SIGNATURE) {
        return Err(malformed(path, "not a PNG: disparities are read from 16-bit grey PNG and from PFM"));
    }
    match codec::decode(bytes, path)?.image {
        DynamicImage::ImageLuma16(image) => {
            let (width, height) = image.dimensions();
            let encoding = encoding(bytes).map_err(|reason| malformed(path, reason))?;
            Ok(Plane::new((width, height), image.into_raw())?.map(|&value| encoding.disparity(value)))
        }
        other => {
            let found = codec::describe(other.color());
            let reason = format!("a PNG of {found}: disparities are 16-bit grey, 256 times the pixels, 0 for none");
            Err(malformed(path, reason))
        }
    }
}

/// The encoding of a PNG: that of its text, or KITTI's.
fn encoding(bytes: &[u8]) -> std::result::Result<Encoding, String> {
    let Some(text) = png_text::find(bytes, KEYWORD)? else { return Ok(Encoding::KITTI) };
    Encoding::parse(text)
        .ok_or_else(|| format!("the text '{KEYWORD}' is not 'offset_px=-6 px_per_value=0.00390625' or the like"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(disparities: &[i32]) -> DisparityMap {
        DisparityMap::new((disparities.len() as u32, 1), disparities.to_vec()).unwrap()
    }

    #[test]
    fn values_by_hand() {
        let of = |disparities: &[i32]| {
            let map = map(disparities);
            let encoding = Encoding::of(&map);
            (encoding, encoding.values(&map).into_data())
        };
        assert_eq!(of(&[NONE, 0, 1, 256, 65535]), (Encoding::KITTI, vec![0, 1, 1, 256, 65535]));
        assert_eq!(of(&[NONE, NONE]), (Encoding::KITTI, vec![0, 0]));
        assert_eq!(of(&[-1, NONE, 300]), (Encoding { offset: -2, step: 1 }, vec![511, 0, 812]));
        // 300 px and a half more.
        let wide = of(&[0, 300 * 256 + 128]);
        assert_eq!(wide, (Encoding { offset: -1, step: 2 }, vec![128, 38_592]));
        assert_eq!(of(&[70_000, 70_001]), (Encoding { offset: 272, step: 1 }, vec![368, 369]));
    }

    #[test]
    fn no_disparity_is_lost() {
        for disparities in [
            vec![-60_000, NONE, -1, 0, 1],
            vec![-70_000, NONE, -300, 0, 99_999],
            vec![NONE + 1, NONE, 0, i32::MAX],
            vec![0, 1 << 28],
            vec![NONE],
        ] {
            let (map, mut bytes) = (map(&disparities), Vec::new());
            write(&mut bytes, &map).unwrap();
            let Encoding { step, .. } = Encoding::of(&map);
            let read = decode(&bytes, Path::new("m.png")).unwrap();
            for (&given, &read) in map.data().iter().zip(read.data()) {
                assert_eq!(given == NONE, read == NONE);
                assert!(given.abs_diff(read) <= step / 2, "{given} {read}");
            }
        }
    }

    #[test]
    fn texts_come_back_or_are_refused() {
        for encoding in [Encoding::KITTI, Encoding { offset: -300, step: 8 }, Encoding { offset: 9, step: 1 << 17 }] {
            assert_eq!(Encoding::parse(&encoding.text()), Some(encoding), "{}", encoding.text());
        }
        assert_eq!(Encoding { offset: -6, step: 1 }.text(), "offset_px=-6 px_per_value=0.00390625");
        let mut bytes = Vec::new();
        png::write_grey16(&mut bytes, &Plane::filled((3, 2), 9)).unwrap();
        for text in [
            "",
            "offset_px=-6",
            "offset_px=x px_per_value=1",
            "offset_px=1 px_per_value=0",
            "offset_px=1 px_per_value=inf",
        ] {
            let bytes = png_text::with_text(&bytes, KEYWORD, text);
            let error = decode(&bytes, Path::new("m.png")).unwrap_err().to_string();
            assert!(error.contains("the text 'hsad-disparity' is not"), "{error}");
        }
    }

    #[test]
    fn other_pictures_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("grey.png");
        let mut grey = Vec::new();
        png::write_grey8(&mut grey, &Plane::filled((3, 2), 9)).unwrap();
        std::fs::write(&path, grey).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("a PNG of 8-bit grey: disparities are 16-bit grey"), "{error}");
        std::fs::write(&path, "Pf\n1 1\n-1\n0000").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("not a PNG"));
    }
}
