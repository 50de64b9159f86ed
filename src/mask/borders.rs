//! Constant borders: what a rectification left empty, letterboxes, and the round masks of endoscopes.

use super::{Mask, SEEN};
use crate::image::{Luma, Size};

/// Largest difference of a border's pixels from its grey value: JPEG rings at the edge of a border.
const TOLERANCE: u8 = 8;
/// Smallest share of neighbours in a border that are equal, in per cent. Borders stored as JPEG have 53 to 96; the noise of a
/// sensor leaves 30 or less.
const EQUAL: usize = 50;
/// Largest grey value that is black, and smallest share of a black border's pixels that are, in per cent.
const BLACK: (u8, usize) = (4, 80);
/// Smallest share of the pixels of a dark surround that are at most [`TOLERANCE`], in per cent.
const DARK: usize = 90;
/// Smallest area of a border, in pixels, and the share of the picture's pixels that it is at least, as a divisor.
const AREA: (usize, usize) = (64, 500);
/// Smallest share of a side of the picture along which a border without a corner lies, as a divisor: a black object in
/// the picture rarely touches as much.
const CONTACT: u32 = 3;
/// Width of the seam between border and scene that interpolation mixes of both, in pixels.
const SEAM: i64 = 2;

/// Removes the constant borders of a view, and the seam beside them, from its `mask`.
///
/// A border is a connected black area that lies along a third of a side of the picture, or holds a corner where another
/// corner is held as well, as by the round mask of an endoscope: one black corner is an object. An area of another grey
/// value must fill rows or columns or have straight edges, since an overexposed sky is white in any shape. A mask that
/// would leave nothing is returned as it was. Dark areas with the noise of a sensor are a border where all four corners lie in
/// such areas or in borders, as around the round picture of an endoscope.
pub(crate) fn without_borders(luma: &Luma, mask: Mask) -> Mask {
    let size = luma.size();
    let mut reached = luma.map(|_| false);
    let (mut constant, mut dark) = (Vec::new(), Vec::new());
    for (x, y) in edge(size) {
        if !reached.get(x, y) {
            let area = constant_area(luma, (x, y), &mut reached);
            if looks_like_a_border(luma, &area) {
                constant.push(area);
            } else if is_dark(luma, &area) {
                dark.push(area);
            }
        }
    }
    let held_by = |areas: &[Vec<(u32, u32)>]| areas.iter().map(|area| corners(area, size)).sum::<usize>();
    let held = held_by(&constant);
    if held + held_by(&dark) < 4 {
        dark.clear();
    }
    let mut bordered = mask.clone();
    dark.retain(|area| corners(area, size) > 0);
    dark.into_iter().flatten().for_each(|place| remove(&mut bordered, place));
    for area in constant {
        if lies_along_a_side(&area, size) || held >= 2 && corners(&area, size) > 0 {
            area.into_iter().for_each(|place| remove(&mut bordered, place));
        }
    }
    if bordered.data().contains(&SEEN) { bordered } else { mask }
}

/// The pixels of the picture's edge.
fn edge(Size { width, height }: Size) -> impl Iterator<Item = (u32, u32)> {
    let rows = (0..width).flat_map(move |x| [(x, 0), (x, height - 1)]);
    rows.chain((0..height).flat_map(move |y| [(0, y), (width - 1, y)]))
}

/// The connected pixels around `start` that differ from it by at most [`TOLERANCE`].
fn constant_area(luma: &Luma, start: (u32, u32), reached: &mut crate::image::Plane<bool>) -> Vec<(u32, u32)> {
    let Size { width, height } = luma.size();
    let grey = luma.get(start.0, start.1);
    reached.set(start.0, start.1, true);
    let mut area = vec![start];
    let mut next = 0;
    while let Some(&(x, y)) = area.get(next) {
        next += 1;
        for (x, y) in [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)] {
            if x < width && y < height && !reached.get(x, y) && luma.get(x, y).abs_diff(grey) <= TOLERANCE {
                reached.set(x, y, true);
                area.push((x, y));
            }
        }
    }
    area
}

/// Whether an area is large.
fn is_large(luma: &Luma, area: &[(u32, u32)]) -> bool {
    area.len() >= AREA.0.max(luma.data().len() / AREA.1)
}

/// Whether an area is large and as dark as no light leaves it.
fn is_dark(luma: &Luma, area: &[(u32, u32)]) -> bool {
    let dark = area.iter().filter(|&&(x, y)| luma.get(x, y) <= TOLERANCE).count();
    is_large(luma, area) && 100 * dark >= DARK * area.len()
}

/// Whether an area is large, constant, and black or of straight edges.
fn looks_like_a_border(luma: &Luma, area: &[(u32, u32)]) -> bool {
    if !is_large(luma, area) {
        return false;
    }
    let black = area.iter().filter(|&&(x, y)| luma.get(x, y) <= BLACK.0).count();
    let is_black = 100 * black >= BLACK.1 * area.len();
    is_constant(luma, area) && (is_black || is_bar(area, luma.size()) || is_straight(area, luma.size()))
}

/// Number of the picture's corners in an area.
fn corners(area: &[(u32, u32)], Size { width, height }: Size) -> usize {
    area.iter().filter(|&&(x, y)| (x == 0 || x == width - 1) && (y == 0 || y == height - 1)).count()
}

/// Whether an area touches a side of the picture along a third.
fn lies_along_a_side(area: &[(u32, u32)], Size { width, height }: Size) -> bool {
    let along = |side: u32, on: &dyn Fn(u32, u32) -> bool| {
        area.iter().filter(|&&(x, y)| on(x, y)).count() >= (side / CONTACT) as usize
    };
    along(width, &|_, y| y == 0)
        || along(width, &|_, y| y == height - 1)
        || along(height, &|x, _| x == 0)
        || along(height, &|x, _| x == width - 1)
}

/// Whether most neighbours in an area are equal. Neighbours within the tolerance of the area's first pixel are in the area.
fn is_constant(luma: &Luma, area: &[(u32, u32)]) -> bool {
    let Size { width, height } = luma.size();
    let grey = luma.get(area[0].0, area[0].1);
    let (mut pairs, mut equal) = (0, 0);
    for &(x, y) in area {
        for (i, j) in [(x + 1, y), (x, y + 1)] {
            if i < width && j < height && luma.get(i, j).abs_diff(grey) <= TOLERANCE {
                pairs += 1;
                equal += usize::from(luma.get(i, j) == luma.get(x, y));
            }
        }
    }
    100 * equal >= EQUAL * pairs
}

/// Whether nearly all pixels of an area lie in rows or columns that the area fills.
fn is_bar(area: &[(u32, u32)], Size { width, height }: Size) -> bool {
    let (mut rows, mut columns) = (vec![0; height as usize], vec![0; width as usize]);
    for &(x, y) in area {
        rows[y as usize] += 1;
        columns[x as usize] += 1;
    }
    let filled = |&&(x, y): &&(u32, u32)| rows[y as usize] == width || columns[x as usize] == height;
    100 * area.iter().filter(filled).count() >= 95 * area.len()
}

/// Whether the edge between an area and the rest of the picture is a straight line along each side of the picture, within about
/// a pixel.
fn is_straight(area: &[(u32, u32)], size: Size) -> bool {
    let Size { width, height } = size;
    let mut inside = Mask::filled(size, 0);
    area.iter().for_each(|&(x, y)| inside.set(x, y, SEEN));
    let is_edge = |&&(x, y): &&(u32, u32)| {
        let around = [(-1, 0), (1, 0), (0, -1), (0, 1)];
        around.into_iter().any(|(i, j)| inside.get_clamped(i64::from(x) + i, i64::from(y) + j) == 0)
    };
    let mut sides: [Vec<[f64; 2]>; 4] = Default::default();
    for &(x, y) in area.iter().filter(is_edge) {
        let distances = [x, y, width - 1 - x, height - 1 - y];
        let nearest = (0..4).min_by_key(|&side| distances[side]).unwrap_or(0);
        sides[nearest].push([x.into(), y.into()]);
    }
    sides.iter().all(|places| variance_across(places) <= 1.0)
}

/// Variance of places across the straight line that fits them best, in square pixels; 0 for no places.
fn variance_across(places: &[[f64; 2]]) -> f64 {
    let count = (places.len() as f64).max(1.0);
    let mean = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>() / count;
    let middle = [mean(0), mean(1)];
    let moment =
        |a: usize, b: usize| places.iter().map(|p| (p[a] - middle[a]) * (p[b] - middle[b])).sum::<f64>() / count;
    let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
    // The smaller eigenvalue of the covariance.
    (xx + yy - ((xx - yy) * (xx - yy) + 4.0 * xy * xy).sqrt()) / 2.0
}

/// Removes a pixel and the seam around it from a mask.
fn remove(mask: &mut Mask, (x, y): (u32, u32)) {
    let Size { width, height } = mask.size();
    let around = |at: u32, side: u32| {
        (i64::from(at) - SEAM).max(0) as u32..=(i64::from(at) + SEAM).min(i64::from(side) - 1) as u32
    };
    for y in around(y, height) {
        around(x, width).for_each(|x| mask.set(x, y, 0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A textured picture of 120x90 pixels, with `grey` where `inside` says so.
    fn picture(grey: u8, inside: impl Fn(i64, i64) -> bool) -> Luma {
        Luma::from_fn((120, 90), |x, y| {
            let texture = 60 + ((x * 7919 + y * 104_729) % 41) as u8;
            if inside(x.into(), y.into()) { grey } else { texture }
        })
    }

    fn unseen(view: &Luma) -> usize {
        let mask = without_borders(view, view.map(|_| SEEN));
        mask.data().iter().filter(|&&value| value == 0).count()
    }

    #[test]
    fn a_bar_is_removed_with_its_seam() {
        for grey in [0, 128, 255] {
            let view = picture(grey, |x, _| x < 10);
            let mask = without_borders(&view, view.map(|_| SEEN));
            let expected = Mask::from_fn((120, 90), |x, _| if x < 12 { 0 } else { SEEN });
            assert!(mask == expected, "{grey}");
        }
    }

    #[test]
    fn round_masks_and_triangles_are_removed() {
        let outside = |x: i64, y: i64| (x - 60).pow(2) + (y - 45).pow(2) > 40 * 40;
        let ring = unseen(&picture(0, outside)) as f64;
        let area = 120.0 * 90.0 - std::f64::consts::PI * 38.0 * 38.0;
        assert!((ring / area - 1.0).abs() < 0.03, "{ring} of {area}");
        assert!(unseen(&picture(0, |x, y| x + 2 * y < 60)) > 900);
    }

    #[test]
    fn what_the_picture_shows_is_kept() {
        assert_eq!(unseen(&picture(0, |_, _| false)), 0, "a texture");
        assert_eq!(unseen(&picture(0, |x, y| (30..80).contains(&x) && (20..70).contains(&y))), 0, "a black object");
        assert_eq!(unseen(&picture(0, |x, y| (30..60).contains(&x) && y > 60)), 0, "a black object at the edge");
        assert_eq!(unseen(&picture(0, |x, y| x < 5 && y < 5)), 0, "a dark corner");
        assert_eq!(unseen(&picture(0, |x, y| x < 25 && y < 25)), 0, "a black object in a corner");
        assert!(unseen(&picture(0, |x, y| x + y < 25 || x + y > 183)) > 600, "two corners");
        assert_eq!(unseen(&picture(7, |x, y| x * x + y * y < 1600)), 0, "a dark object");
        assert!(unseen(&picture(255, |x, y| x + 2 * y < 60)) > 900, "a white corner");
        assert_eq!(unseen(&picture(255, |x, y| y < 20 + 12 * (x / 15 % 2))), 0, "an overexposed sky above roofs");
        assert_eq!(unseen(&Luma::filled((120, 90), 0)), 0, "a lens cap");
        // Blocks of a JPEG whose grey values differ, with ringing in one of four pixels.
        let blocks = picture(0, |x, _| x < 20);
        let jpeg = Luma::from_fn((120, 90), |x, y| {
            if x < 20 { ((x / 8 + y / 8) % 3 + u32::from((x + 3 * y) % 8 == 0)) as u8 } else { blocks.get(x, y) }
        });
        assert_eq!(unseen(&jpeg), 22 * 90, "a bar stored as JPEG");
        let noisy = picture(0, |x, _| x < 20).map(|&grey| if grey == 0 { 0 } else { grey });
        let noise = Luma::from_fn((120, 90), |x, y| noisy.get(x, y).saturating_add(((x * 31 + y * 17) % 4) as u8));
        assert_eq!(unseen(&noise), 0, "a dark wall with the noise of a sensor");
    }

    #[test]
    fn a_dark_surround_with_noise_is_removed() {
        let noise = |x: u32, y: u32| (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).rotate_left(9) >> 24;
        let noisy = |is_dark: fn(i64, i64) -> bool| {
            let bright = picture(0, is_dark);
            Luma::from_fn((120, 90), |x, y| bright.get(x, y).max((noise(x, y) % 7) as u8))
        };
        let ring = noisy(|x, y| (x - 60).pow(2) + (y - 45).pow(2) > 40 * 40);
        assert_eq!(unseen(&ring), unseen(&picture(0, |x, y| (x - 60).pow(2) + (y - 45).pow(2) > 40 * 40)));
        // A night sky holds two corners.
        assert_eq!(unseen(&noisy(|x, y| y < 30 + x % 9)), 0);
    }
}
