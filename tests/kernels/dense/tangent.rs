//! Tangent planes of the surfaces beside holes.

use hsad::{
    disparity::{DisparityMap, DisparityRange, NONE},
    image::{Plane, Size},
    verify::{Values, trials::TangentTrial},
};

use crate::common::*;

/// A range with ends far from the disparities.
const WIDE: DisparityRange = DisparityRange { min: -99, count: 999 };

/// Slanted surfaces with noise and holes.
fn surfaces(width: u32, height: u32, [across, down]: [i32; 2]) -> DisparityMap {
    let (coarse, fine) = (picture((width.div_ceil(30), height), 141), picture((width, height), 142));
    Plane::from_fn((width, height), |x, y| match fine.get(x, y) {
        0..12 => NONE,
        value if x % 17 > 2 => {
            i32::from(coarse.get(x / 30, y)) * 4 + across * x as i32 + down * y as i32 + i32::from(value)
        }
        _ => NONE,
    })
}

#[test]
fn the_twin_fits_the_same() {
    for Size { width, height } in SIZES {
        for (slopes, range) in [([0, 0], WIDE), ([30, -60], WIDE), ([-90, 170], DisparityRange { min: 1, count: 4 })] {
            let channels = [1, 2, 3, 4].map(|seed| picture((width, height), seed));
            let picture = Plane::from_fn((width, height), |x, y| channels.each_ref().map(|channel| channel.get(x, y)));
            let disparities = surfaces(width, height, slopes);
            assert_twin(&format!("{width}x{height} {slopes:?}"), &TangentTrial { disparities, picture, range });
        }
    }
}

/// Height, slopes and colour at a pixel.
fn at(trial: &TangentTrial, x: u32, y: u32) -> (i32, [i32; 2], [u8; 3]) {
    let found = leaves(trial);
    let [Values::I32(heights), Values::U32(slopes), Values::U32(colours)] = &found[..] else { panic!("three parts") };
    let pixel = (y * trial.disparities.width() + x) as usize;
    let slope = |half: u32| i32::from(half as u16 as i16);
    let [red, green, blue, _] = colours[pixel].to_le_bytes();
    (heights[pixel], [slope(slopes[pixel]), slope(slopes[pixel] >> 16)], [red, green, blue])
}

/// A plane with slopes of 10/256 px per pixel along the row and -7/256 along the column, and a hole.
fn slanted(is_hole: fn(u32, u32) -> bool) -> TangentTrial {
    let height = |x: u32, y: u32| 4000 + 10 * x as i32 - 7 * y as i32;
    let disparities = Plane::from_fn((60, 60), |x, y| if is_hole(x, y) { NONE } else { height(x, y) });
    TangentTrial { disparities, picture: Plane::from_fn((60, 60), |x, _| [x as u8, 3, 200, 9]), range: WIDE }
}

#[test]
fn a_plane_is_found_beside_a_hole_only() {
    // Slopes in units of a 64th of 1/256 px per pixel. The colours of columns 28 and 29, rounded.
    let right = slanted(|x, _| x >= 30);
    assert_eq!(at(&right, 29, 40), (4000 + 290 - 280, [640, -448], [29, 3, 200]));
    // Pixels beside no hole, and holes, are not written.
    assert_eq!(at(&right, 28, 40), (0, [0, 0], [0; 3]));
    assert_eq!(at(&right, 31, 31), (0, [0, 0], [0; 3]));
    let below = slanted(|_, y| y >= 30);
    assert_eq!(at(&below, 50, 29), (4000 + 500 - 203, [640, -448], [50, 3, 200]));
    // The corner of a hole is level, at its own disparity.
    let corner = slanted(|x, y| x >= 30 && y >= 30);
    assert_eq!(at(&corner, 29, 29), (4000 + 290 - 203, [0, 0], [29, 3, 200]));
}

#[test]
fn bounds() {
    // Steeper than 48/256 px per pixel along the row: held there. Along the column 128/256 are the most, as samples differ by at
    // most 2 px.
    let steep = |across: i32, down: i32| {
        let disparities = Plane::from_fn((90, 90), |x, y| match x {
            45.. => NONE,
            x => across * x as i32 + down * y as i32,
        });
        at(&TangentTrial { disparities, picture: Plane::filled((90, 90), [0; 4]), range: WIDE }, 44, 45).1
    };
    assert_eq!(steep(60, 0)[0], 48 * 64);
    assert_eq!(steep(0, -128)[1], -128 * 64);
    // Too few samples: level, at the pixel's own disparity.
    let few = Plane::from_fn((4, 12), |x, y| if x == 3 { NONE } else { 9 * y as i32 });
    assert_eq!(
        at(&TangentTrial { disparities: few, picture: Plane::filled((4, 12), [7; 4]), range: WIDE }, 2, 3),
        (27, [0, 0], [7; 3])
    );
    // The mean colour is that of the surface: neighbours of other disparities do not count.
    let step = Plane::from_fn((3, 1), |x, _| [0, 4000, NONE][x as usize]);
    let picture = Plane::from_fn((3, 1), |x, _| [[1, 1, 1, 1], [50, 60, 70, 1], [9; 4]][x as usize]);
    assert_eq!(at(&TangentTrial { disparities: step, picture, range: WIDE }, 1, 0), (4000, [0, 0], [50, 60, 70]));
}

/// The marks of a pixel: 1 if its surface is small, plus 2 if it is doubtful.
fn marks(disparities: DisparityMap, range: DisparityRange, [x, y]: [u32; 2]) -> u32 {
    let size = disparities.size();
    let found = leaves(&TangentTrial { disparities, picture: Plane::filled(size, [255; 4]), range });
    let Values::U32(colours) = &found[2] else { panic!("colours") };
    colours[(y * size.width + x) as usize] >> 24
}

#[test]
fn specks_and_wires_are_small() {
    // Of the 81 samples around its pixels a surface has at least 7, or it is small; beside the picture's edge fewer do.
    let mark = |width: u32, rows: std::ops::Range<u32>, at: [u32; 2]| {
        let surface = |x: u32, y: u32| (20..20 + width).contains(&x) && rows.contains(&y);
        marks(Plane::from_fn((60, 60), |x, y| if surface(x, y) { 700 } else { NONE }), WIDE, at) & 1
    };
    assert_eq!((mark(8, 20..28, [20, 20]), mark(8, 20..32, [20, 20])), (1, 1));
    assert_eq!(mark(12, 20..32, [20, 20]), 0);
    assert_eq!((mark(1, 10..31, [20, 30]), mark(1, 0..60, [20, 30])), (1, 0));
    assert_eq!(mark(40, 56..60, [59, 59]), 0);
    // A corner, too.
    assert_eq!(mark(2, 20..22, [21, 21]), 1);
}

#[test]
fn specks_amid_holes_are_doubtful() {
    // A surface of 12x12 px, 9 of 81 samples, and of 12x16 px, 12 of them, at (20, 20); another surface from column `beside` on: of
    // the samples, from column 4 to column 36, one column in nine from 36 on, two from 32, three from 28.
    let doubtful = |rows: u32, beside: u32| {
        let disparities = Plane::from_fn((60, 60), |x, y| match x {
            20..32 if (20..20 + rows).contains(&y) => 700,
            x if x >= beside => 9000,
            _ => NONE,
        });
        marks(disparities, WIDE, [20, 20]) >> 1
    };
    assert_eq!((doubtful(12, 60), doubtful(16, 60)), (1, 0));
    // 9 and 9 samples have a disparity, 9 and 18 are a quarter and more.
    assert_eq!((doubtful(12, 36), doubtful(12, 32)), (1, 0));
}

#[test]
fn patches_at_ends_of_the_range_are_doubtful() {
    // 16 and 20 rows of five columns of samples: 20 and 25 of 81 belong to the surface.
    let at = |disparity: i32, min: i32, last: i32, rows: u32| {
        let range = DisparityRange::inclusive(min, last).unwrap();
        let surface = |x: u32, y: u32| (20..40).contains(&x) && (20..20 + rows).contains(&y);
        marks(Plane::from_fn((60, 60), |x, y| if surface(x, y) { disparity } else { NONE }), range, [20, 20])
    };
    assert_eq!((at(2 * 256 + 384, 2, 20, 16), at(2 * 256 + 385, 2, 20, 16)), (2, 0));
    assert_eq!((at(20 * 256 - 384, 2, 20, 16), at(20 * 256 - 385, 2, 20, 16)), (2, 0));
    assert_eq!(at(20 * 256, 2, 20, 20), 0);
    // At infinity nothing goes on.
    assert_eq!((at(0, 0, 20, 16), at(0, -1, 20, 16)), (0, 2));
}
