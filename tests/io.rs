//! File formats: round trips, and decoders fed with arbitrary bytes.

#![cfg(feature = "cli")]

mod allocation;
mod pictures;

use std::{io::Cursor, path::Path};

use allocation::largest_allocation;
use hsad::{
    Error,
    dense::Dense,
    disparity::{DisparityMap, NONE},
    image::{Plane, Size},
    io::{Calibration, MAX_PIXELS, csv, disparity_png, homography, load, pfm, ply, png},
};
use image::{DynamicImage, ImageFormat};
use pictures::cmyk_tiff;
use proptest::prelude::*;

const FORMATS: [ImageFormat; 6] =
    [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Pnm, ImageFormat::Bmp, ImageFormat::Tiff, ImageFormat::WebP];

/// Number of cases per property: `PROPTEST_CASES=100000 cargo test --test io` runs a long search, with a name behind
/// it, as in `--test io homography`, over the properties with that name.
fn cases_or(usual: u32) -> u32 {
    std::env::var("PROPTEST_CASES").map_or(usual, |cases| cases.parse().expect("a number of cases"))
}

fn path() -> &'static Path {
    Path::new("given.bytes")
}

fn reason<T: std::fmt::Debug>(result: Result<T, Error>) -> String {
    match result {
        Err(Error::Format { path, reason }) if path == self::path() => reason,
        other => panic!("{other:?}"),
    }
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

/// An RGB picture of 24x16 pixels, smooth enough to survive JPEG.
fn photograph() -> DynamicImage {
    let pixel = |x: u32, y: u32| image::Rgb([(x * 10) as u8, (y * 15) as u8, (200 - 3 * x - 5 * y) as u8]);
    DynamicImage::ImageRgb8(image::RgbImage::from_fn(24, 16, pixel))
}

/// A 16-bit PNG of 24x16 disparities from `least` on, in pixels, some of them missing.
fn disparities(least: i32) -> Vec<u8> {
    let disparity = |x: u32, y: u32| 256 * least + (x * 700 + y * 11 + 1) as i32;
    let map = DisparityMap::from_fn((24, 16), |x, y| if x == y { NONE } else { disparity(x, y) });
    let mut bytes = Vec::new();
    disparity_png::write(&mut bytes, &map).unwrap();
    bytes
}

fn plane<T: std::fmt::Debug + Clone>(value: impl Strategy<Value = T>) -> impl Strategy<Value = Plane<T>> {
    let value = proptest::collection::vec(value, 1..200);
    (value, 1..20_u32).prop_map(|(mut data, width)| {
        let width = width.min(data.len() as u32);
        let height = data.len() as u32 / width;
        data.truncate((width * height) as usize);
        Plane::new((width, height), data).unwrap()
    })
}

fn number_or_infinity() -> impl Strategy<Value = f32> {
    prop_oneof![4 => proptest::num::f32::NORMAL | proptest::num::f32::ZERO, 1 => Just(f32::INFINITY)]
}

/// A big-endian PFM, written from the format's description, independently of the library's writer.
fn big_endian_pfm(plane: &Plane<f32>) -> Vec<u8> {
    let mut bytes = format!("Pf\n{} {}\n1.0\n", plane.width(), plane.height()).into_bytes();
    for y in (0..plane.height()).rev() {
        bytes.extend((0..plane.width()).flat_map(|x| plane.get(x, y).to_be_bytes()));
    }
    bytes
}

/// Mutates `bytes`: changes some of them, and may cut off the end.
fn mutated(bytes: Vec<u8>) -> impl Strategy<Value = Vec<u8>> {
    let length = bytes.len();
    let changes = proptest::collection::vec((0..length, any::<u8>()), 0..6);
    // The bytes that control a decoder are mostly at the front.
    let header_changes = proptest::collection::vec((0..length.min(64), any::<u8>()), 0..3);
    (changes, header_changes, prop_oneof![Just(length), 0..length]).prop_map(move |(changes, header_changes, end)| {
        let mut bytes = bytes.clone();
        for (index, value) in changes.into_iter().chain(header_changes) {
            bytes[index] = value;
        }
        bytes.truncate(end);
        bytes
    })
}

/// A table with the columns of [`POINTS`] in some order, others between them, and blank lines; and its rows.
fn table() -> impl Strategy<Value = (String, Vec<Vec<f64>>)> {
    let number = proptest::num::f64::NORMAL | proptest::num::f64::ZERO | proptest::num::f64::SUBNORMAL;
    let rows = proptest::collection::vec(proptest::collection::vec(number, 3), 0..20);
    let columns = Just(["x", "y", "scale", "note", "x2"]).prop_shuffle();
    let end = proptest::sample::select(vec!["\n", "\r\n", "\n\n", "\n  \n"]);
    (rows, columns, end, any::<bool>()).prop_map(|(rows, columns, end, marked)| {
        let line = |cell: &dyn Fn(&str) -> String| columns.map(cell).join(", ") + end;
        let mut text = if marked { "\u{feff}" } else { "" }.to_owned() + &line(&|column| column.into());
        for row in &rows {
            text += &line(&|column| {
                let place = POINTS.iter().position(|&wanted| wanted == column);
                place.map_or("no number".into(), |place| row[place].to_string())
            });
        }
        (text, rows)
    })
}

/// The columns of points, and those of matches.
const POINTS: [&str; 3] = ["x", "y", "scale"];
const MATCHES: [&str; 4] = ["x1", "y1", "x2", "y2"];

/// Pattern of random texts for tables and homographies.
const WORDS: &str = "(x1?|y2|scale|confidence|nan|-inf|1e999|[-+.0-9eE]{1,30}|,|,|\n|\n|\r| |\\PC){0,80}";

proptest! {
    // Each case takes microseconds.
    #![proptest_config(ProptestConfig::with_cases(cases_or(2000)))]

    #[test]
    fn pfm_comes_back(plane in plane(number_or_infinity())) {
        let mut little = Vec::new();
        pfm::write(&mut little, &plane).unwrap();
        prop_assert_eq!(&pfm::decode(&little, path()).unwrap(), &plane);
        prop_assert_eq!(&pfm::decode(&big_endian_pfm(&plane), path()).unwrap(), &plane);
    }

    #[test]
    fn ply_has_a_record_for_each_point(disparity in plane(prop_oneof![-999..99_999_i32, Just(NONE)])) {
        let Size { width, height } = disparity.size();
        let picture = Plane::from_fn((width, height), |x, y| [x as u8, y as u8, 1, 255]);
        let calibration = Calibration::centred(50.0, 0.1, 0.0, (width, height)).unwrap();
        let filter = ply::PointFilter::new(&calibration);
        let near = disparity.data().iter().filter(|&&d| d >= 5 * 256).count();
        let known = disparity.data().iter().filter(|&&d| d != NONE).count();
        let dense = Dense { confidence: Plane::filled((width, height), 16), disparity };
        let (points, left_out) = ply::points(&dense, &picture, &calibration, &filter).unwrap();
        prop_assert_eq!((points.len(), left_out), (near, ply::LeftOut { unsure: 0, beyond: known - near }));
        let mut bytes = Vec::new();
        ply::write(&mut bytes, &points).unwrap();
        let end = b"end_header\n";
        let header = bytes.windows(end.len()).position(|window| window == end).unwrap() + end.len();
        prop_assert_eq!(bytes.len(), header + 15 * points.len());
        let count = format!("element vertex {}\n", points.len());
        prop_assert!(String::from_utf8_lossy(&bytes[..header]).contains(&count));
    }

    #[test]
    fn pfm_of_random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        check_pfm(&bytes)?;
        check_pfm(&[b"Pf\n", &bytes[..]].concat())?;
    }

    #[test]
    fn pfm_of_mutated_bytes(bytes in mutated(big_endian_pfm(&Plane::from_fn((5, 4), |x, y| (x + y) as f32)))) {
        check_pfm(&bytes)?;
    }

    #[test]
    fn pfm_of_claimed_sizes(width in any::<u32>(), height in any::<u32>(), rest in any::<[u8; 16]>()) {
        let header = format!("Pf {width} {height} -1\n").into_bytes();
        check_pfm(&[header, rest.to_vec()].concat())?;
    }

    #[test]
    fn calibration_of_random_text(text in "\\PC{0,200}", lines in "((cam[01]|doffs|baseline|width)=?[-0-9.eENainf;\\[\\] ]{0,40}\n){0,8}") {
        check_calibration(&text)?;
        check_calibration(&lines)?;
    }

    #[test]
    fn calibration_of_mutated_bytes(bytes in mutated(CALIBRATION.into())) {
        check_calibration(&String::from_utf8_lossy(&bytes))?;
    }

    #[test]
    fn csv_comes_back((text, rows) in table()) {
        let table = csv::decode(text.as_bytes(), path(), &POINTS, &["missing"]).unwrap();
        prop_assert_eq!(table.has, [false]);
        prop_assert_eq!(table.rows.into_iter().map(|(_, row)| row).collect::<Vec<_>>(), rows);
    }

    #[test]
    fn csv_of_random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        check_csv(&bytes)?;
        check_csv(&[b"x,y,scale\n", &bytes[..]].concat())?;
    }

    #[test]
    fn csv_of_words(text in WORDS, others in WORDS) {
        check_csv(text.as_bytes())?;
        check_csv(format!("x,scale,y,\n{text}").as_bytes())?;
        check_csv(format!("x1,y2,x2,y1,confidence{others}\n{text}").as_bytes())?;
    }

    #[test]
    fn csv_of_mutated_bytes(bytes in table().prop_flat_map(|(text, _)| mutated(text.into()))) {
        check_csv(&bytes)?;
    }

    #[test]
    fn homography_comes_back(
        rows in proptest::array::uniform9(proptest::num::f64::NORMAL | proptest::num::f64::ZERO),
        between in proptest::sample::select(vec![" ", "\n", "\t\r\n "]),
    ) {
        let text = rows.map(|number| number.to_string()).join(between);
        let matrix = homography::decode(text.as_bytes(), path()).unwrap();
        prop_assert_eq!(matrix.transpose().to_cols_array(), rows);
    }

    #[test]
    fn homography_of_random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200), text in WORDS) {
        check_homography(&bytes)?;
        check_homography(text.as_bytes())?;
    }

    #[test]
    fn homography_of_mutated_bytes(bytes in mutated(HOMOGRAPHY.into())) {
        check_homography(&bytes)?;
    }
}

const HOMOGRAPHY: &str = "8.7976964e-01 3.1245438e-01 -3.9430589e+01
-1.8389418e-01 9.3847198e-01 1.5315784e+02
1.9641425e-04 -1.6015275e-05 1.0000000e+00
";

/// Checks that decoding yields nine finite numbers or an error, and allocates no more than an error's text needs.
fn check_homography(bytes: &[u8]) -> Result<(), TestCaseError> {
    let (result, allocated) = largest_allocation(|| homography::decode(bytes, path()));
    prop_assert!(allocated <= 2 * bytes.len() + 256, "{} bytes reserved for {}", allocated, bytes.len());
    if let Ok(matrix) = result {
        prop_assert!(matrix.is_finite());
        let words = String::from_utf8_lossy(bytes).split_whitespace().count();
        prop_assert_eq!(words, 9);
    }
    Ok(())
}

/// Checks that every row has one finite number per column, and a line number of its own.
fn check_csv(bytes: &[u8]) -> Result<(), TestCaseError> {
    for (needed, optional) in [(&POINTS[..], &[][..]), (&MATCHES, &["confidence"])] {
        let (result, allocated) = largest_allocation(|| csv::decode(bytes, path(), needed, optional));
        // A cell of one byte takes 16 bytes in a list of cells, and twice that while the list grows.
        prop_assert!(allocated <= 32 * bytes.len() + 256, "{} bytes reserved for {}", allocated, bytes.len());
        let Ok(table) = result else { continue };
        prop_assert_eq!(table.has.len(), optional.len());
        let columns = needed.len() + table.has.iter().filter(|&&has| has).count();
        let lines = String::from_utf8_lossy(bytes).lines().count();
        // The first line is the header.
        let mut last = 1;
        for (line, row) in table.rows {
            prop_assert!(line > last && line <= lines, "line {} after {} of {}", line, last, lines);
            prop_assert!(row.len() == columns && row.iter().all(|number| number.is_finite()), "{:?}", row);
            last = line;
        }
    }
    Ok(())
}

const CALIBRATION: &str = "cam0=[999.421 0 294.182; 0 999.421 252.932; 0 0 1]
cam1=[999.421 0 326.96; 0 999.421 252.932; 0 0 1]
doffs=32.778
baseline=193.001
width=741
height=497
ndisp=64
";

fn check_calibration(text: &str) -> Result<(), TestCaseError> {
    let (result, allocated) = largest_allocation(|| Calibration::parse(text, path()));
    // Each line is at most one entry of a table.
    prop_assert!(allocated <= 64 * text.len() + 4096, "{} bytes reserved for {}", allocated, text.len());
    if let Ok(calibration) = result {
        prop_assert!(calibration.validate().is_ok(), "{:?}", calibration);
    }
    Ok(())
}

fn check_pfm(bytes: &[u8]) -> Result<(), TestCaseError> {
    let (result, allocated) = largest_allocation(|| pfm::decode(bytes, path()));
    prop_assert!(allocated <= 2 * bytes.len() + 1024, "{} bytes reserved for {}", allocated, bytes.len());
    if let Ok(plane) = result {
        prop_assert!(plane.data().iter().all(|&value| value.is_finite() || value == f32::INFINITY));
    }
    Ok(())
}

proptest! {
    // Each case encodes a picture, or decodes one in six formats.
    #![proptest_config(ProptestConfig::with_cases(cases_or(1000)))]

    #[test]
    fn disparity_png_comes_back(map in plane(prop_oneof![-32_000..33_000_i32, Just(NONE)])) {
        let map = map.map(|&d| if d == 0 { 1 } else { d });
        let mut bytes = Vec::new();
        disparity_png::write(&mut bytes, &map).unwrap();
        prop_assert_eq!(disparity_png::decode(&bytes, path()).unwrap(), map);
    }

    #[test]
    fn png_comes_back(picture in plane(any::<[u8; 3]>())) {
        let (mut color_bytes, mut grey_bytes) = (Vec::new(), Vec::new());
        png::write_rgb8(&mut color_bytes, &picture).unwrap();
        prop_assert_eq!(load::decode(&color_bytes, path()).unwrap(), picture.map(|&[r, g, b]| [r, g, b, 255]));
        let grey = picture.map(|&[r, _, _]| r);
        png::write_grey8(&mut grey_bytes, &grey).unwrap();
        prop_assert_eq!(load::decode(&grey_bytes, path()).unwrap().luma(), grey);
    }

    #[test]
    fn pictures_of_random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        for format in FORMATS {
            let magic = &encoded(&photograph(), format)[..12];
            check_picture(&[magic, &bytes].concat())?;
        }
        check_picture(&bytes)?;
    }

    #[test]
    fn disparity_png_of_mutated_bytes(bytes in mutated(disparities(0)), with_text in mutated(disparities(-90))) {
        check_picture(&bytes)?;
        let _ = disparity_png::decode(&with_text, path());
    }

    #[test]
    fn floats_of_mutated_bytes(bytes in mutated(encoded(&photograph().to_rgb32f().into(), ImageFormat::Tiff))) {
        check_picture(&bytes)?;
    }

    #[test]
    fn pictures_of_mutated_bytes(files in FORMATS.map(|format| mutated(encoded(&photograph(), format)))) {
        for bytes in files {
            check_picture(&bytes)?;
        }
    }
}

/// Largest single allocation allowed for a file, in bytes: for the pixels that its header claims, unless they exceed
/// the limit, in the largest layout, plus what a codec keeps of the file and besides it.
fn most_bytes(bytes: &[u8]) -> usize {
    let reader = image::ImageReader::new(Cursor::new(bytes)).with_guessed_format().expect("bytes can be read");
    let codec = if reader.format() == Some(ImageFormat::Tiff) { TIFF_BYTES } else { CODEC_BYTES };
    let (width, height) = reader.into_dimensions().unwrap_or_default();
    let pixels = u64::from(width) * u64::from(height);
    let pixels = if pixels <= MAX_PIXELS { pixels as usize } else { 0 };
    16 * pixels + 4 * bytes.len() + codec
}

/// Buffers and tables of a codec, independent of the picture's size, in bytes: WebP needs 2 MiB.
const CODEC_BYTES: usize = 1 << 22;

/// Most memory that the TIFF codec reserves for a list in its header before reading it, in bytes, at 32 bytes per
/// value.
const TIFF_BYTES: usize = 1 << 28;

fn check_picture(bytes: &[u8]) -> Result<(), TestCaseError> {
    let (most, format) = (most_bytes(bytes), image::guess_format(bytes).ok());
    let (result, allocated) = largest_allocation(|| load::decode(bytes, path()));
    prop_assert!(allocated <= most, "{:?}: {} bytes reserved, not {} at most", format, allocated, most);
    if let Ok(picture) = result {
        prop_assert!(picture.data().iter().all(|pixel| [0, 255].contains(&pixel[3])));
        prop_assert!(picture.data().iter().any(|pixel| pixel[3] == 255));
    }
    // Both decoders read PNG, but only 16-bit grey is a disparity map.
    let (map, allocated) = largest_allocation(|| disparity_png::decode(bytes, path()));
    prop_assert!(allocated <= most, "{:?}: {} bytes reserved, not {} at most", format, allocated, most);
    if let Ok(map) = map {
        prop_assert!(map.data().iter().all(|&disparity| disparity == NONE || (1..=65535).contains(&disparity)));
    }
    Ok(())
}

#[test]
fn every_format_is_read() {
    let expected = photograph().to_rgba8().into_raw();
    for format in FORMATS {
        let picture = load::decode(&encoded(&photograph(), format), path()).unwrap();
        assert_eq!(picture.size(), (24, 16), "{format:?}");
        let worst = picture.rgba().iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(if format == ImageFormat::Jpeg { worst < 12 } else { worst == 0 }, "{format:?} is off by {worst}");
    }
}

#[test]
fn every_layout_is_read() {
    // 257 * v is the 8-bit value v stored as 16 bits; 0x12ff shows that the lower byte is dropped.
    let sixteen = [257 * 200, 0x12ff, 257 * 7, 1];
    let rgba = image::Rgba(sixteen);
    let pixel = [200, 0x12, 7, 255];
    let grey = [200, 200, 200, 255];
    for (image, expected) in [
        (DynamicImage::ImageLuma8(image::GrayImage::from_pixel(2, 1, image::Luma([200]))), grey),
        (DynamicImage::ImageLumaA8(image::GrayAlphaImage::from_pixel(2, 1, image::LumaA([200, 1]))), grey),
        (DynamicImage::ImageRgb8(image::RgbImage::from_pixel(2, 1, image::Rgb([200, 0x12, 7]))), pixel),
        (DynamicImage::ImageRgba8(image::RgbaImage::from_pixel(2, 1, image::Rgba([200, 0x12, 7, 1]))), pixel),
        (DynamicImage::ImageLuma16(image::ImageBuffer::from_pixel(2, 1, image::Luma([0xc8ff]))), grey),
        (DynamicImage::ImageLumaA16(image::ImageBuffer::from_pixel(2, 1, image::LumaA([0xc8ff, 9]))), grey),
        (
            DynamicImage::ImageRgb16(image::ImageBuffer::from_pixel(
                2,
                1,
                image::Rgb([sixteen[0], sixteen[1], sixteen[2]]),
            )),
            pixel,
        ),
        (DynamicImage::ImageRgba16(image::ImageBuffer::from_pixel(2, 1, rgba)), pixel),
    ] {
        let picture = load::decode(&encoded(&image, ImageFormat::Png), path()).unwrap();
        assert_eq!(picture.data(), [expected; 2], "{:?}", image.color());
    }
}

#[test]
fn tiny_pnm_by_hand() {
    let picture = load::decode(b"P6\n2 1\n255\n\x01\x02\x03\xff\xfe\xfd", path()).unwrap();
    assert_eq!(picture.data(), [[1, 2, 3, 255], [255, 254, 253, 255]]);
    let bits = load::decode(b"P1\n2 1\n1 0\n", path()).unwrap();
    assert_eq!(bits.luma().data(), [0, 255]);
}

#[test]
fn a_picture_that_is_cut_off_is_refused() {
    for format in FORMATS {
        let bytes = encoded(&photograph(), format);
        for length in (1..=bytes.len() * 3 / 4).step_by(7) {
            let reason = reason(load::decode(&bytes[..length], path()));
            assert!(!reason.is_empty(), "{format:?} of {length} bytes");
        }
        let half = reason(load::decode(&bytes[..bytes.len() / 2], path()));
        assert!(half.contains("again"), "{format:?}: {half}");
    }
}

#[test]
fn what_is_no_picture_is_told() {
    assert!(reason(load::decode(b"Dear reader,", path())).contains("PNG, JPEG, PNM, BMP, TIFF and WebP"));
    assert!(reason(load::decode(b"GIF89a\x01\0\x01\0\0\0\0;", path())).contains("convert the picture to PNG"));
    let empty = reason(load::decode(b"P5\n0 7\n255\n", path()));
    assert!(empty.contains("0x7") || empty.contains("damaged"), "{empty}");
}

#[test]
fn cmyk_and_pfm_of_three_channels_are_refused() {
    let reason_cmyk = reason(load::decode(&cmyk_tiff(), path()));
    assert!(reason_cmyk.contains("CMYK: convert it"), "{reason_cmyk}");
    assert!(reason(load::decode(b"PF\n1 1\n-1\n", path())).contains("three channels"));
}

#[test]
fn a_decompression_bomb_is_refused_by_its_header() {
    let mut bytes = encoded(&photograph(), ImageFormat::Bmp);
    // Width and height of a BMP.
    bytes[18..22].copy_from_slice(&60_000_u32.to_le_bytes());
    bytes[22..26].copy_from_slice(&60_000_u32.to_le_bytes());
    let (result, allocated) = largest_allocation(|| load::decode(&bytes, path()));
    assert!(reason(result).contains("60000x60000 pixels are more than"));
    assert!(allocated < 1 << 20, "{allocated} bytes reserved");
    assert!(reason(load::decode(b"P5\n100000 100000\n255\n1", path())).contains("scale it down"));
}

#[test]
fn exif_orientation_is_applied() {
    // A TIFF directory with one entry: orientation (0x112), a short, 6: rotate clockwise.
    let exif = b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
    let mut bytes = encoded(&photograph(), ImageFormat::Jpeg);
    let segment = [&[0xff, 0xe1], &(exif.len() as u16 + 2).to_be_bytes()[..], exif].concat();
    let upright = load::decode(&bytes, path()).unwrap();
    bytes.splice(2..2, segment);
    let turned = load::decode(&bytes, path()).unwrap();
    assert_eq!(turned, Plane::from_fn((16, 24), |x, y| upright.get(y, 15 - x)));
}

#[test]
fn the_file_is_named_in_errors() {
    let folder = tempfile::tempdir().unwrap();
    for file in [folder.path().join("missing.png"), folder.path().into()] {
        let error = load::load(&file).unwrap_err();
        assert!(matches!(&error, Error::Io { path, .. } if *path == file), "{error}");
        assert!(error.to_string().starts_with(&file.display().to_string()));
        assert!(matches!(pfm::read(&file), Err(Error::Io { path, .. }) if path == file));
        assert!(matches!(Calibration::read(&file), Err(Error::Io { path, .. }) if path == file));
    }
    let empty = folder.path().join("empty.png");
    std::fs::write(&empty, "").unwrap();
    assert!(load::load(&empty).unwrap_err().to_string().contains("the file is empty"));
}

#[test]
fn a_shipped_map_is_read() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/data/curved"));
    let map = pfm::read_disparities(&folder.join("disp_left.pfm")).unwrap();
    assert_eq!(map.size(), load::load(&folder.join("left.png")).unwrap().size());
    // The scene's meta.json: all pixels known, 15.107 to 59.376 px.
    assert_eq!(hsad::disparity::coverage(&map), 1.0);
    let pixels = || map.data().iter().map(|&d| f64::from(d) / 256.0);
    let (smallest, largest) = (pixels().fold(f64::MAX, f64::min), pixels().fold(f64::MIN, f64::max));
    assert!((smallest - 15.107).abs() < 0.003 && (largest - 59.376).abs() < 0.003, "{smallest} {largest}");
}
