//! Loading of pairs: deep samples, unseen pixels, orientations.

#[path = "../exif/mod.rs"]
mod exif;

use std::{
    fs,
    io::Cursor,
    path::{Path, PathBuf},
};

use exif::turned_jpeg;
use hsad::{
    Error,
    image::Plane,
    io::{
        load::{self, LoadedPair, Stretch, Unseen, load_pair},
        pfm,
    },
};
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, LumaA, Rgb, Rgb32FImage, Rgba, Rgba32FImage};
use tempfile::TempDir;

/// A folder with the files of one test.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.into().write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

/// A 16-bit grey PNG of one row.
fn grey16(samples: &[u16]) -> Vec<u8> {
    let image = ImageBuffer::from_raw(samples.len() as u32, 1, samples.to_vec()).unwrap();
    encoded(DynamicImage::ImageLuma16(image), ImageFormat::Png)
}

/// An 8-bit grey PNG of one row.
fn grey8(samples: &[u8]) -> Vec<u8> {
    encoded(GrayImage::from_raw(samples.len() as u32, 1, samples.to_vec()).unwrap(), ImageFormat::Png)
}

/// A PFM of one row.
fn floats(samples: &[f32]) -> Vec<u8> {
    let mut bytes = Vec::new();
    pfm::write(&mut bytes, &Plane::new((samples.len() as u32, 1), samples.to_vec()).unwrap()).unwrap();
    bytes
}

/// A little-endian BigTIFF of one row of 16-bit grey, written from its specification (AWare Systems, 'The BigTIFF File
/// Format').
fn big_tiff(samples: &[u16]) -> Vec<u8> {
    let (short, length) = (3_u16, samples.len() as u64);
    // Header of 16 bytes, number of entries, 10 entries of 20 bytes, offset of the next directory.
    let start = 16 + 8 + 10 * 20 + 8;
    let entries: [(u16, u64); 10] = [
        (256, length),
        (257, 1),
        (258, 16),
        (259, 1),
        (262, 1),
        (273, start),
        (277, 1),
        (278, 1),
        (279, 2 * length),
        (339, 1),
    ];
    let mut bytes = [&b"II+\0\x08\0\0\0"[..], &16_u64.to_le_bytes(), &10_u64.to_le_bytes()].concat();
    for (tag, value) in entries {
        bytes.extend([tag.to_le_bytes(), short.to_le_bytes()].concat());
        bytes.extend([1_u64.to_le_bytes(), value.to_le_bytes()].concat());
    }
    bytes.extend(0_u64.to_le_bytes());
    bytes.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    bytes
}

/// The grey values of a file that is loaded alone; all its pixels must be seen.
fn alone(bytes: &[u8]) -> Vec<u8> {
    let picture = load::decode(bytes, Path::new("picture")).unwrap();
    let grey = |&[red, green, blue, alpha]: &[u8; 4]| {
        assert_eq!([green, blue, alpha], [red, red, 255]);
        red
    };
    picture.data().iter().map(grey).collect()
}

fn reason<T: std::fmt::Debug>(result: Result<T, Error>, at: &Path) -> String {
    match result {
        Err(Error::Format { path, reason }) if path == at => reason,
        other => panic!("{other:?}"),
    }
}

fn upper_bits(samples: &[u16]) -> Vec<u8> {
    samples.iter().map(|&sample| (sample >> 8) as u8).collect()
}

#[test]
fn eight_bits_in_sixteen_and_wide_spans_keep_their_upper_bits() {
    let values: Vec<u16> = (90..150).collect();
    let by_257: Vec<u16> = values.iter().map(|value| 257 * value).collect();
    let by_256: Vec<u16> = values.iter().map(|value| 256 * value).collect();
    let wide: Vec<u16> = vec![1000, 5001, 20_003, 33_768];
    for samples in [by_257, by_256, wide] {
        assert_eq!(alone(&grey16(&samples)), upper_bits(&samples));
    }
    // 32,767 is less than half of the 16 bits: 1000 becomes 0, and 33,767 is 255.
    assert_eq!(alone(&grey16(&[1000, 33_767])), [0, 255]);
    // One sample that is no 8-bit value.
    assert_eq!(alone(&grey16(&[257 * 100, 257 * 100 + 1, 257 * 100 + 2])), [0, 128, 255]);
    // No span at all.
    assert_eq!(alone(&grey16(&[25_801; 3])), [100; 3]);
}

#[test]
fn both_views_have_one_stretch() {
    let folder = Folder::new();
    let left = folder.file("left.png", grey16(&[1000, 1255, 1101]));
    let right = folder.file("right.pgm", [&b"P5\n3 1\n65535\n"[..], &[4, 226, 5, 228, 4, 77]].concat());
    let pair = load_pair(&left, &right, &Unseen::default()).unwrap();
    // The right samples are 1250, 1508 and 1101; 508 samples for 255 grey values.
    assert_eq!(pair.stretch, Some(Stretch { low: 1000.0, high: 1508.0 }));
    assert_eq!(pair.left.luma().data(), [0, 128, 51]);
    assert_eq!(pair.right.luma().data(), [125, 255, 51]);
    assert_eq!(pair.warnings, [""; 0]);
}

#[test]
fn big_tiff_is_read() {
    assert_eq!(alone(&big_tiff(&[30_000, 30_100, 30_255])), [0, 100, 255]);
    assert_eq!(alone(&big_tiff(&[257 * 3, 257 * 200])), [3, 200]);
    assert!(load::decode(&big_tiff(&[1, 2, 3])[..220], Path::new("a")).is_err());
}

#[test]
fn floats_are_always_stretched() {
    assert_eq!(alone(&floats(&[0.0, 0.5, 1.0])), [0, 128, 255]);
    assert_eq!(alone(&floats(&[-40_000.0, 60_000.0, 0.0])), [0, 255, 102]);
    let rgb = Rgb32FImage::from_raw(2, 1, vec![0.0, 10.0, 20.0, 51.0, 25.5, 5.0]).unwrap();
    let picture = load::decode(&encoded(rgb, ImageFormat::Tiff), Path::new("a.tif")).unwrap();
    assert_eq!(picture.data(), [[0, 50, 100, 255], [255, 128, 25, 255]]);
}

#[test]
fn alpha_0_and_values_that_are_not_finite_are_unseen() {
    let decode = |bytes: &[u8]| load::decode(bytes, Path::new("a")).unwrap().into_data();
    let rgba = ImageBuffer::from_raw(3, 1, vec![1, 2, 3, 0, 4, 5, 6, 1, 7, 8, 9, 255_u8]).unwrap();
    assert_eq!(
        decode(&encoded(DynamicImage::ImageRgba8(rgba), ImageFormat::Png)),
        [[1, 2, 3, 0], [4, 5, 6, 255], [7, 8, 9, 255]]
    );
    // The unseen 65,535 does not count for the stretch.
    let deep: ImageBuffer<LumaA<u16>, _> =
        ImageBuffer::from_raw(3, 1, vec![1000, 9, 65_535, 0, 1255, 65_535_u16]).unwrap();
    let bytes = encoded(DynamicImage::ImageLumaA16(deep), ImageFormat::Png);
    assert_eq!(decode(&bytes), [[0, 0, 0, 255], [255, 255, 255, 0], [255, 255, 255, 255]]);

    let alphas = |bytes: &[u8]| decode(bytes).into_iter().map(|[.., alpha]| alpha).collect::<Vec<_>>();
    assert_eq!(alphas(&floats(&[1.0, f32::INFINITY, 2.0, f32::NAN, f32::NEG_INFINITY])), [255, 0, 255, 0, 0]);
    let partly = Rgb32FImage::from_fn(2, 1, |x, _| Rgb([0.5, if x == 0 { f32::NAN } else { 0.25 }, 0.5]));
    assert_eq!(alphas(&encoded(partly, ImageFormat::Tiff)), [0, 255]);
    let transparent = Rgba32FImage::from_fn(2, 1, |x, _| Rgba([0.5, 1.0, 1.5, x as f32]));
    assert_eq!(alphas(&encoded(transparent, ImageFormat::Tiff)), [0, 255]);
}

#[test]
fn a_picture_of_which_nothing_was_seen_is_refused() {
    let path = Path::new("a");
    let clear = encoded(DynamicImage::ImageRgba8(ImageBuffer::new(2, 1)), ImageFormat::Png);
    assert!(reason(load::decode(&clear, path), path).contains("alpha is 0 everywhere"));
    assert!(reason(load::decode(&floats(&[f32::NAN; 2]), path), path).contains("no pixel is a finite number"));
}

#[test]
fn missing_data_is_unseen_in_the_unit_of_the_file() {
    let folder = Folder::new();
    let pair = |left: &[u8], right: &[u8], nodata| {
        let [left, right] = [("left", left), ("right", right)].map(|(name, bytes)| folder.file(name, bytes));
        load_pair(&left, &right, &Unseen { nodata: Some(nodata), ..Unseen::default() })
    };
    let alphas = |pair: LoadedPair| {
        [pair.left, pair.right].map(|view| view.data().iter().map(|&[.., alpha]| alpha).collect::<Vec<_>>())
    };
    let deep = pair(&grey16(&[40_000, 1000, 1255]), &grey16(&[1000, 40_000, 1100]), 40_000.0).unwrap();
    assert_eq!(deep.stretch, Some(Stretch { low: 1000.0, high: 1255.0 }));
    assert_eq!(alphas(deep), [vec![0, 255, 255], vec![255, 0, 255]]);
    let float = pair(&floats(&[-9999.0, 0.1, 0.2]), &floats(&[0.1, f32::NAN, 9999.0]), -9999.0).unwrap();
    assert_eq!(alphas(float), [vec![0, 255, 255], vec![255, 0, 255]]);
    let shallow = pair(&grey8(&[0, 1]), &grey8(&[1, 0]), 0.0).unwrap();
    assert_eq!((shallow.stretch, alphas(shallow)), (None, [vec![0, 255], vec![255, 0]]));
    let nan = pair(&floats(&[f32::NAN, 0.1]), &floats(&[0.1, 0.2]), f32::NAN).unwrap();
    assert_eq!(alphas(nan), [vec![0, 255], vec![255, 255]]);
    // A colour needs all three.
    let colors = ImageBuffer::from_raw(2, 1, vec![7, 7, 7, 7, 7, 8]).unwrap();
    let colors = encoded(DynamicImage::ImageRgb8(colors), ImageFormat::Png);
    assert_eq!(alphas(pair(&colors, &grey8(&[1, 2]), 7.0).unwrap()), [vec![0, 255], vec![255, 255]]);

    let nothing = reason(pair(&grey8(&[1, 0]), &grey8(&[7, 7]), 7.0), &folder.0.path().join("right"));
    assert!(nothing.contains("value for missing data, 7"), "{nothing}");
}

#[test]
fn masks_are_unseen_where_they_are_0() {
    let folder = Folder::new();
    let view = folder.file("view.png", grey8(&[10, 20, 30]));
    // 1 of 65,535 is not 0, although its upper 8 bits are.
    let mask = folder.file("mask.png", grey16(&[0, 1, 65_535]));
    let pair = |masks: [Option<&PathBuf>; 2]| {
        load_pair(&view, &view, &Unseen { masks: masks.map(|mask| mask.cloned()), nodata: None })
    };
    let seen = [[10, 10, 10, 255], [20, 20, 20, 255], [30, 30, 30, 255]];
    let masked = [[10, 10, 10, 0], [20, 20, 20, 255], [30, 30, 30, 255]];
    let of = |pair: LoadedPair| [pair.left.into_data(), pair.right.into_data()];
    assert_eq!(of(pair([Some(&mask), None]).unwrap()), [masked, seen]);
    assert_eq!(of(pair([None, Some(&mask)]).unwrap()), [seen, masked]);
    assert_eq!(of(pair([Some(&mask), Some(&mask)]).unwrap()), [masked, masked]);

    let small = folder.file("small.png", grey8(&[255; 2]));
    let misfit = reason(pair([None, Some(&small)]), &small);
    assert!(misfit.contains("2x1") && misfit.contains("3x1") && misfit.contains("view.png"), "{misfit}");
    let black = folder.file("black.png", grey8(&[0; 3]));
    assert!(reason(pair([Some(&black), None]), &black).contains("leaves no pixel of"));
}

#[test]
fn views_of_different_depth() {
    let folder = Folder::new();
    let shallow = folder.file("shallow.png", grey8(&[10, 20]));
    let deep = folder.file("deep.png", grey16(&[1000, 1255]));
    let float = folder.file("float.pfm", floats(&[0.0, 1.0]));
    let pair = load_pair(&shallow, &deep, &Unseen::default()).unwrap();
    assert_eq!(pair.left.luma().data(), [10, 20]);
    assert_eq!(pair.right.luma().data(), [0, 255]);
    assert_eq!(pair.stretch, Some(Stretch { low: 1000.0, high: 1255.0 }));
    for (left, right) in [(&float, &deep), (&shallow, &float)] {
        let refused = reason(load_pair(left, right, &Unseen::default()), &float);
        assert!(refused.contains("floating-point samples") && refused.contains("same scale"), "{refused}");
    }
}

#[test]
fn different_exif_orientations_are_told() {
    let folder = Folder::new();
    let [upright, reversed, sideways] =
        [1, 3, 6].map(|orientation| folder.file(&orientation.to_string(), turned_jpeg(24, 16, orientation)));
    let warnings = |left: &Path, right: &Path| load_pair(left, right, &Unseen::default()).unwrap().warnings;
    assert_eq!(warnings(&reversed, &reversed), [""; 0]);
    let told = warnings(&upright, &reversed);
    assert_eq!(told.len(), 1);
    assert!(told[0].contains("left view is not turned and the right view turned by 180 degrees"), "{}", told[0]);
    let refused = reason(load_pair(&sideways, &upright, &Unseen::default()), &upright);
    assert!(refused.contains("turned by 90 degrees") && refused.contains("16x24 and 24x16"), "{refused}");
}
