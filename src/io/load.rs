//! Loading of photographs from PNG, JPEG, PNM, PFM, BMP, TIFF and WebP files.
//!
//! Grey and RGB, with or without alpha, become RGBA of 8 bits:
//! - 8-bit samples stay as they are;
//! - 16-bit samples keep their upper 8 bits (`>> 8`) if they hold 8-bit values (`257 v`, `256 v`) or use half of the
//!   16 bits or more; otherwise what is in use is stretched over 8 bits ([`Stretch`]);
//! - floats, and integers that are signed or have more than 16 bits (TIFF), are always stretched;
//! - alpha becomes 255 where a pixel was seen and 0 where not: alpha 0 in the file, a sample that is NaN or infinite,
//!   or what [`Unseen`] says. Other alpha is dropped, not composited: the camera's picture is matched, and a background
//!   would add edges of its own;
//! - pictures are rotated by their EXIF orientation, as in viewers;
//! - colour profiles and gamma are ignored: both views have the same.
//!
//! Both views of a pair have one stretch ([`load_pair`]). A pair of 8 and 16 bits is accepted, and only the latter view
//! stretched; floats and integers of up to 16 bits do not go together, since nothing tells how their units compare.
//!
//! A file may have both views ([`load_both`]): an MPO of a 3D camera, a JPS, or one picture with a view in each half.
//!
//! CMYK is refused, since its conversion to 8 bits would be a guess, and so are PFM of three channels. Only the first
//! frame or page of a file is read.

use std::path::Path;

use ::image::metadata::Orientation;

use super::{
    Picture, claims, codec,
    decoded::Decoded,
    jps, malformed, mpo,
    samples::{Kind, Samples},
};
use crate::error::{Result, shown};

pub use super::{
    halves::Halves,
    raw::{RawPicture, RawSamples},
    stretch::Stretch,
    unseen::Unseen,
};

/// The views of a pair as 8-bit pictures, and what became of them on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedPair {
    /// The left view.
    pub left: Picture,
    /// The right view.
    pub right: Picture,
    /// The stretch of the views that have more than 8 bits; `None`: the upper 8 bits were taken.
    pub stretch: Option<Stretch>,
    /// Doubts about the files, one line each: a missing end, bytes that belong to nothing, different EXIF orientations.
    pub warnings: Vec<String>,
}

/// Reads the bytes of a picture file, for those functions here that decode them. Of a file that begins as no picture does, such as a device
/// without an end, the first few bytes are read.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read; [`crate::Error::Format`] for an empty file and one longer than any picture.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    codec::read_bytes(path)
}

/// Loads a picture file as RGBA of 8 bits.
///
/// # Errors
/// [`crate::Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn load(path: &Path) -> Result<Picture> {
    decode(&codec::read_bytes(path)?, path)
}

/// Loads a picture file as [`load`], and tells what is odd about the file, though all of its picture is there: a missing end, or bytes that
/// belong to nothing.
///
/// # Errors
/// As [`load`].
pub fn load_with_doubt(path: &Path) -> Result<(Picture, Option<String>)> {
    decode_with_doubt(&codec::read_bytes(path)?, path)
}

/// Decodes the picture in a file's bytes to RGBA of 8 bits; `path` is named in errors.
///
/// # Errors
/// [`crate::Error::Format`] if the bytes are no picture of a supported format, are damaged or cut off, hold more than
/// [`super::MAX_PIXELS`], or no pixel that was seen.
pub fn decode(bytes: &[u8], path: &Path) -> Result<Picture> {
    Ok(decode_with_doubt(bytes, path)?.0)
}

/// Decodes the picture in a file's bytes as [`decode`], and tells what is odd about them as [`load_with_doubt`].
///
/// # Errors
/// As [`decode`].
pub fn decode_with_doubt(bytes: &[u8], path: &Path) -> Result<(Picture, Option<String>)> {
    let samples = seen(codec::decode(bytes, path)?, path)?;
    let doubt = samples.doubt.as_ref().map(|doubt| format!("{}: {doubt}", shown(path)));
    Ok((picture(&samples, Stretch::of(&[&samples])), doubt))
}

/// Loads the views of one pair, both with the same stretch, and without the pixels that `unseen` names.
///
/// The sizes of the views may differ if their EXIF orientations do not.
///
/// # Errors
/// As [`load`]; also [`crate::Error::Format`] for a mask of another size than its view, a mask or a value for missing
/// data that leaves no pixel, one view of floats and one of integers, and views of different sizes and
/// EXIF orientations.
pub fn load_pair(left: &Path, right: &Path, unseen: &Unseen) -> Result<LoadedPair> {
    let decode = |path: &Path| codec::decode(&codec::read_bytes(path)?, path);
    pair([decode(left)?, decode(right)?], [left, right], unseen)
}

/// Decodes the views of one pair from two files' bytes, as [`load_pair`] does from files; the paths are named in errors.
///
/// # Errors
/// As [`load_pair`].
pub fn decode_pair(left: (&[u8], &Path), right: (&[u8], &Path), unseen: &Unseen) -> Result<LoadedPair> {
    let decode = |(bytes, path): (&[u8], &Path)| codec::decode(bytes, path);
    pair([decode(left)?, decode(right)?], [left.1, right.1], unseen)
}

/// Loads both views from one file, as [`load_pair`] does from two: from the halves of its picture, or, without `halves`, from a
/// multi-picture file (MPO), as cameras with two lenses write, or a stereo JPEG (JPS) whose APP3 segment tells where its views lie.
///
/// # Errors
/// As [`load_pair`]; also [`crate::Error::Format`] for a picture that is no multi-picture file, and one too small to hold two views.
pub fn load_both(path: &Path, halves: Option<Halves>, unseen: &Unseen) -> Result<LoadedPair> {
    decode_views(&codec::read_bytes(path)?, path, halves, unseen)
}

/// Decodes both views from the bytes of one file, as [`load_both`] does from the file; `path` is named in errors.
///
/// # Errors
/// As [`load_both`].
pub fn decode_views(bytes: &[u8], path: &Path, halves: Option<Halves>, unseen: &Unseen) -> Result<LoadedPair> {
    let loaded = match halves {
        Some(halves) => Some(decode_halves(bytes, path, halves, unseen)?),
        None => decode_both(bytes, path, unseen)?,
    };
    loaded.ok_or_else(|| {
        let reason = "it holds one picture, no list of several as an MPO has, and no word on where its views lie as a JPS may have: \
                      name the right view, too, or tell where both views lie in it (--side-by-side, --top-bottom)";
        malformed(path, reason)
    })
}

/// Decodes both views from the halves of the picture in a file's bytes; `path` is named in errors. A JPS that says otherwise of its views is
/// among the warnings.
///
/// # Errors
/// As [`load_both`], and for a multi-picture file, whose views are no halves of a picture.
pub fn decode_halves(bytes: &[u8], path: &Path, halves: Halves, unseen: &Unseen) -> Result<LoadedPair> {
    // The second picture of other files with an index is smaller, such as a gain map.
    if let Ok(Some([left, right])) = mpo::views(bytes)
        && claims::size(left) == claims::size(right)
    {
        let reason = "it is an MPO with a picture per view, not one with both: leave the order of the views out (--side-by-side, --top-bottom)";
        return Err(malformed(path, reason));
    }
    let both = codec::decode(bytes, path)?;
    let views = halves.split(&both).ok_or_else(|| malformed(path, "the picture is too small to hold two views"))?;
    let mut loaded = pair(views, [path; 2], unseen)?;
    let told = jps::descriptor(bytes);
    let otherwise = match told {
        Ok(Some(told)) if told.halves != halves => {
            Some(format!("it is a JPS whose left view lies {}", told.halves.words()))
        }
        Ok(_) => None,
        Err(reason) => Some(reason.into()),
    };
    loaded.warnings.extend(otherwise.map(|otherwise| {
        format!(
            "{}: the left view was taken to lie {} (--side-by-side, --top-bottom), but by its descriptor {otherwise}",
            shown(path),
            halves.words()
        )
    }));
    loaded.warnings.extend(told.ok().flatten().and_then(|told| told.squeezed).map(|side| {
        format!("the views were squeezed to half their {side}: disparities are those of the squeezed pictures, and so must a calibration be")
    }));
    Ok(loaded)
}

/// Decodes both views from the bytes of a file that tells where they lie: an MPO, or a JPS with a descriptor. `None` for any other file.
/// `path` is named in errors.
///
/// # Errors
/// As [`load_both`].
pub fn decode_both(bytes: &[u8], path: &Path, unseen: &Unseen) -> Result<Option<LoadedPair>> {
    if let Some(told) = jps::descriptor(bytes).map_err(|reason| malformed(path, reason))? {
        return decode_halves(bytes, path, told.halves, unseen).map(Some);
    }
    let Some([left, right]) = mpo::views(bytes).map_err(|reason| malformed(path, reason))? else { return Ok(None) };
    let views = [codec::decode(left, path)?, codec::decode(right, path)?];
    let [left, right] = views.each_ref().map(|view| (view.image.width(), view.image.height()));
    if left != right {
        let reason = format!(
            "its pictures are {}x{} and {}x{}: they are no views of one pair",
            left.0, left.1, right.0, right.1
        );
        return Err(malformed(path, reason));
    }
    pair(views, [path; 2], unseen).map(Some)
}

fn pair(views: [Decoded; 2], [left, right]: [&Path; 2], unseen: &Unseen) -> Result<LoadedPair> {
    unseen.check(views.each_ref().map(Kind::of))?;
    let [left_mask, right_mask] = unseen.masks.each_ref().map(Option::as_deref);
    let shown = |view, path: &Path, mask| -> Result<Samples> {
        let mut view = seen(view, path)?;
        unseen.hide(&mut view, mask, path)?;
        Ok(view)
    };
    let [left_view, right_view] = views;
    LoadedPair::of([&shown(left_view, left, left_mask)?, &shown(right_view, right, right_mask)?], [left, right])
}

/// A picture in memory as RGBA of 8 bits.
///
/// # Errors
/// [`crate::Error::Format`] if no pixel was seen.
pub fn picture_of(raw: RawPicture) -> Result<Picture> {
    let samples = seen(raw.into_decoded(), Path::new("the picture"))?;
    Ok(picture(&samples, Stretch::of(&[&samples])))
}

impl LoadedPair {
    /// The views of one pair in memory, both with the same stretch.
    ///
    /// # Errors
    /// [`crate::Error::Format`] for a view without a seen pixel, and for one view of floats and one of integers.
    pub fn from_raw(left: RawPicture, right: RawPicture) -> Result<Self> {
        let names = [Path::new("the left view"), Path::new("the right view")];
        Self::of([&seen(left.into_decoded(), names[0])?, &seen(right.into_decoded(), names[1])?], names)
    }

    fn of(views: [&Samples; 2], paths: [&Path; 2]) -> Result<Self> {
        check_kinds(views, paths)?;
        let told = |(view, path): (&Samples, &Path)| Some(format!("{}: {}", shown(path), view.doubt.as_ref()?));
        let mut warnings: Vec<String> = views.into_iter().zip(paths).filter_map(told).collect();
        // Halves of one picture share its doubt.
        warnings.dedup();
        warnings.extend(turns(views, paths[1])?);
        let stretch = Stretch::of(&views);
        let [left, right] = views.map(|view| picture(view, stretch));
        Ok(Self { left, right, stretch, warnings })
    }
}

/// The samples of a picture, of which something must have been seen.
fn seen(decoded: Decoded, path: &Path) -> Result<Samples> {
    let samples = Samples::new(decoded);
    if samples.is_seen() {
        return Ok(samples);
    }
    let reason = match samples.kind() {
        Kind::Float => "no pixel is a finite number with an alpha above 0: there is nothing to see",
        _ => "its alpha is 0 everywhere, which stands for 'not seen': remove the alpha channel",
    };
    Err(malformed(path, reason))
}

fn picture(samples: &Samples, stretch: Option<Stretch>) -> Picture {
    match (samples.kind(), stretch) {
        (Kind::Eight, _) => samples.picture(|sample| sample as u8),
        (_, Some(stretch)) => samples.picture(|sample| stretch.grey(sample)),
        (_, None) => samples.picture(|sample| (sample as u16 >> 8) as u8),
    }
}

fn check_kinds(views: [&Samples; 2], paths: [&Path; 2]) -> Result<()> {
    let kinds = views.map(|view| view.kind() == Kind::Float);
    if kinds[0] == kinds[1] {
        return Ok(());
    }
    let (float, integer) = if kinds[0] { (paths[0], paths[1]) } else { (paths[1], paths[0]) };
    let reason = "has floating-point samples (or integers beyond 16 bits)";
    let way_out = "nothing tells how the two compare, convert both views with the same scale";
    Err(malformed(float, format!("the picture {reason} and the other view, {}, has not: {way_out}", shown(integer))))
}

/// A warning if the files turn the views differently.
fn turns(views: [&Samples; 2], right: &Path) -> Result<Option<String>> {
    let [left_turn, right_turn] = views.map(|view| view.orientation);
    if left_turn == right_turn {
        return Ok(None);
    }
    let found = format!(
        "by their EXIF orientations the left view is {} and the right view {}",
        describe(left_turn),
        describe(right_turn)
    );
    let way_out = "the cameras of a pair are held alike, remove the orientation from both files";
    if views[0].size() != views[1].size() {
        let [left, other] = views.map(Samples::size);
        return Err(malformed(right, format!("{found}, so that they are {left} and {other} pixels: {way_out}")));
    }
    Ok(Some(format!("{found}: {way_out} unless the pair was rectified as it is shown")))
}

fn describe(orientation: Orientation) -> &'static str {
    match orientation {
        Orientation::NoTransforms => "not turned",
        Orientation::Rotate90 => "turned by 90 degrees",
        Orientation::Rotate180 => "turned by 180 degrees",
        Orientation::Rotate270 => "turned by 270 degrees",
        Orientation::FlipHorizontal => "mirrored",
        Orientation::FlipVertical => "mirrored upside down",
        Orientation::Rotate90FlipH | Orientation::Rotate270FlipH => "mirrored and turned by 90 degrees",
    }
}
