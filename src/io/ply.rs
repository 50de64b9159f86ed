//! Coloured point clouds as PLY, the Stanford polygon format.
//!
//! Points are in camera coordinates of the depth map's view, in metres: x right, y down, z forward. Viewers that take y
//! as up show them upside down; rotate the points by 180 degrees around x.

use std::io::{self, Write};

pub use super::ply_reader::{decode, read};
use super::{Calibration, Picture};
use crate::{
    calibration::depth_map,
    dense::Dense,
    error::{Result, check},
    image::{Plane, Size},
};

pub use super::point_filter::{LeftOut, PointFilter};

/// A coloured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// x (right), y (down) and z (forward), in metres.
    pub position: [f32; 3],
    /// Red, green and blue, 8 bits each.
    pub color: [u8; 3],
}

/// The points of a map that `filter` keeps, in metres, coloured by the map's picture, in raster order; and how many it leaves out.
///
/// # Errors
/// [`crate::Error::Parameter`] if map and picture differ in size, or as [`PointFilter::validate`].
pub fn points(
    dense: &Dense,
    picture: &Picture,
    calibration: &Calibration,
    filter: &PointFilter,
) -> Result<(Vec<Point>, LeftOut)> {
    check_size("the map", dense.disparity.size(), picture)?;
    filter.validate()?;
    let (kept, left_out) = filter.apply(dense, calibration);
    Ok((of_depth(&depth_map(&kept, calibration), picture, calibration)?, left_out))
}

/// The points of a depth map in metres, coloured by its picture, in raster order. Pixels without a finite depth have no point.
///
/// # Errors
/// [`crate::Error::Parameter`] if depth map and picture differ in size.
pub fn of_depth(depth: &Plane<f32>, picture: &Picture, calibration: &Calibration) -> Result<Vec<Point>> {
    check_size("the depth map", depth.size(), picture)?;
    colored(&positions(depth, calibration), picture)
}

/// The position of each pixel of a depth map in metres, not finite where the depth is not.
pub fn positions(depth: &Plane<f32>, calibration: &Calibration) -> Plane<[f32; 3]> {
    let Calibration { focal, cx, cy, .. } = *calibration;
    Plane::from_fn(depth.size(), |x, y| {
        let z = depth.get(x, y);
        let across = |pixel: u32, centre: f64| ((f64::from(pixel) - centre) * f64::from(z) / focal) as f32;
        [across(x, cx), across(y, cy), z]
    })
}

/// The points of a picture's pixels, in metres, in raster order. Points that are not finite are left out.
///
/// # Errors
/// [`crate::Error::Parameter`] if points and picture differ in size.
pub fn colored(positions: &Plane<[f32; 3]>, picture: &Picture) -> Result<Vec<Point>> {
    check_size("the points", positions.size(), picture)?;
    let pixels = positions.data().iter().zip(picture.data());
    let finite = pixels.filter(|(position, _)| position.iter().all(|coordinate| coordinate.is_finite()));
    Ok(finite.map(|(&position, &[red, green, blue, _])| Point { position, color: [red, green, blue] }).collect())
}

fn check_size(name: &'static str, size: Size, picture: &Picture) -> Result<()> {
    check(size == picture.size(), name, size, format!("its picture is {}: both need one size", picture.size()))
}

/// Writes `points` as a binary little-endian PLY.
///
/// # Errors
/// The errors of `out`.
pub fn write(out: &mut impl Write, points: &[Point]) -> io::Result<()> {
    write_head(out, &[("vertex", points.len(), &[("float", "x y z"), ("uchar", "red green blue")])])?;
    for Point { position, color } in points {
        for coordinate in position {
            out.write_all(&coordinate.to_le_bytes())?;
        }
        out.write_all(color)?;
    }
    Ok(())
}

/// The properties of an element: types, and the names of each type.
type Properties<'a> = &'a [(&'a str, &'a str)];

/// Writes the head of a binary little-endian PLY: name, number and properties of each element.
///
/// # Errors
/// The errors of `out`.
pub(super) fn write_head(out: &mut impl Write, elements: &[(&str, usize, Properties)]) -> io::Result<()> {
    let comment = "camera coordinates in metres: x right, y down, z forward";
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment {comment}\n")?;
    for (element, count, properties) in elements {
        writeln!(out, "element {element} {count}")?;
        for (kind, names) in *properties {
            names.split(' ').try_for_each(|name| writeln!(out, "property {kind} {name}"))?;
        }
    }
    writeln!(out, "end_header")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::NONE;

    #[test]
    fn points_by_hand() {
        let disparity = Plane::new((2, 2), vec![NONE, 2 * 256, 4 * 256, 256]).unwrap();
        let dense = Dense { disparity, confidence: Plane::filled((2, 2), 99) };
        let picture = Picture::from_fn((2, 2), |x, y| [x as u8, y as u8, 7, 255]);
        let calibration = Calibration { focal: 8.0, baseline: 1.0, doffs: 0.0, cx: 0.0, cy: 0.5, size: None };
        let filter = PointFilter { max_depth: 4.0, min_confidence: 99 };
        let expected = vec![
            // (1 - 0) * 4 / 8, (0 - 0.5) * 4 / 8
            Point { position: [0.5, -0.25, 4.0], color: [1, 0, 7] },
            Point { position: [0.0, 0.125, 2.0], color: [0, 1, 7] },
        ];
        let left_out = LeftOut { unsure: 0, beyond: 1 };
        assert_eq!(points(&dense, &picture, &calibration, &filter).unwrap(), (expected, left_out));
    }

    #[test]
    fn points_that_are_none_are_left_out() {
        let positions = Plane::new((2, 1), vec![[f32::NAN; 3], [1.0, 2.0, 3.0]]).unwrap();
        let picture = Picture::from_fn((2, 1), |x, _| [x as u8, 5, 6, 0]);
        let expected = [Point { position: [1.0, 2.0, 3.0], color: [1, 5, 6] }];
        assert_eq!(colored(&positions, &picture).unwrap(), expected);
    }

    #[test]
    fn sizes_must_agree() {
        let calibration = Calibration::centred(1.0, 1.0, 0.0, (2, 1)).unwrap();
        let dense = Dense { disparity: Plane::filled((2, 1), 256), confidence: Plane::filled((2, 1), 99) };
        let filter = PointFilter::new(&calibration);
        let error = points(&dense, &Picture::filled((1, 2), [0; 4]), &calibration, &filter).unwrap_err();
        assert_eq!(error.to_string(), "the map is 2x1, but its picture is 1x2: both need one size");
    }

    #[test]
    fn writes_exactly_these_bytes() {
        let mut out = Vec::new();
        write(&mut out, &[Point { position: [1.0, -2.0, 0.5], color: [1, 2, 3] }]).unwrap();
        let (header, body) = out.split_at(out.len() - 15);
        assert!(header.starts_with(b"ply\nformat binary_little_endian 1.0\n"));
        assert!(header.ends_with(b"property uchar blue\nend_header\n"));
        assert!(String::from_utf8_lossy(header).contains("\nelement vertex 1\n"));
        assert_eq!(body, b"\0\0\x80\x3f\0\0\0\xc0\0\0\0\x3f\x01\x02\x03");
    }
}
