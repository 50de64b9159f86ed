//! The paper's figures: interest points in a picture, and matches between two.

use super::Picture;
use crate::{features::Feature, image::Plane};

/// A match to draw: column and row in the left view, then in the right view, in pixels.
pub type PointPair = ([f32; 2], [f32; 2]);

/// Radius of a feature's circle, in units of its scale: the blob's edge and a little around it.
const RADIUS_PER_SCALE: f32 = 2.5;

/// Radius of the circle around a matched point, in pixels.
const MATCH_RADIUS: f32 = 3.0;

/// Gap between two pictures side by side, in pixels.
const GAP: u32 = 8;

/// Width of lines, in pixels.
const LINE_WIDTH: f32 = 1.25;

/// Colour of a dark blob on light ground.
const DARK_BLOB: [u8; 3] = [255, 72, 48];

/// Colour of a light blob on dark ground.
const LIGHT_BLOB: [u8; 3] = [48, 176, 255];

/// Draws `picture` in grey with a circle around each feature, of a radius of 2.5 scales: red for dark blobs, blue for
/// light ones. A line from the centre shows the orientation, unless it is exactly 0, as in upright mode.
pub fn keypoints(picture: &Picture, features: &[Feature]) -> Plane<[u8; 3]> {
    let mut canvas = Canvas(grey(picture));
    for feature in features {
        let color = if feature.dark { DARK_BLOB } else { LIGHT_BLOB };
        let (centre, radius) = ([feature.x, feature.y], RADIUS_PER_SCALE * feature.scale);
        canvas.circle(centre, radius, color);
        if feature.orientation != 0.0 {
            let (sin, cos) = feature.orientation.sin_cos();
            canvas.line(centre, [feature.x + radius * cos, feature.y + radius * sin], color);
        }
    }
    canvas.0
}

/// Draws both pictures in grey, side by side, with a line between the points of each pair and a circle around each
/// point. Neighbours in the list have distinct colours.
pub fn matches(left: &Picture, right: &Picture, pairs: &[PointPair]) -> Plane<[u8; 3]> {
    let start = left.width() + GAP;
    let mut canvas = Canvas(side_by_side(&[&grey(left), &grey(right)]));
    for (index, &(from, to)) in (0..).zip(pairs) {
        let to = [to[0] + start as f32, to[1]];
        let color = distinct(index);
        canvas.line(from, to, color);
        canvas.circle(from, MATCH_RADIUS, color);
        canvas.circle(to, MATCH_RADIUS, color);
    }
    canvas.0
}

/// Draws both pictures of a rectified pair in grey, side by side, with the epipolar line of each pair of points: the row of the
/// left point, through both pictures, and a circle around each point.
pub fn epipolar_lines(left: &Picture, right: &Picture, pairs: &[PointPair]) -> Plane<[u8; 3]> {
    let start = left.width() + GAP;
    let mut canvas = Canvas(side_by_side(&[&grey(left), &grey(right)]));
    let end = canvas.0.width() as f32 - 1.0;
    for (index, &(from, to)) in (0..).zip(pairs) {
        let color = distinct(index);
        canvas.line([0.0, from[1]], [end, from[1]], color);
        canvas.circle(from, MATCH_RADIUS, color);
        canvas.circle([to[0] + start as f32, to[1]], MATCH_RADIUS, color);
    }
    canvas.0
}

fn grey(picture: &Picture) -> Plane<[u8; 3]> {
    picture.luma().map(|&grey| [grey; 3])
}

/// Places pictures in a row, aligned at the top, on black.
///
/// # Panics
/// If `pictures` is empty.
pub fn side_by_side(pictures: &[&Plane<[u8; 3]>]) -> Plane<[u8; 3]> {
    let width = pictures.iter().map(|picture| picture.width() + GAP).sum::<u32>() - GAP;
    let height = pictures.iter().map(|picture| picture.height()).max().unwrap_or(0);
    let mut canvas = Canvas(Plane::filled((width, height), [0; 3]));
    let mut start = 0;
    for picture in pictures {
        canvas.paste(picture, start);
        start += picture.width() + GAP;
    }
    canvas.0
}

/// The `index`-th of a list of saturated colours: steps of the golden angle around the hue circle keep neighbours
/// apart, however long the list.
fn distinct(index: u32) -> [u8; 3] {
    let hue = (f64::from(index) * 0.618_033_988_749_895).fract() * 6.0;
    // Red, green and blue are ramps around their own hue, at 0, 2 and 4 of 6.
    [0.0, 2.0, 4.0].map(|primary: f64| {
        let apart = (hue - primary).abs();
        let distance = apart.min(6.0 - apart);
        (255.0 * (2.0 - distance).clamp(0.15, 1.0)).round() as u8
    })
}

/// A picture to draw on; strokes are clipped to it.
struct Canvas(Plane<[u8; 3]>);

impl Canvas {
    fn paste(&mut self, picture: &Plane<[u8; 3]>, start: u32) {
        for y in 0..picture.height() {
            for (x, &color) in (start..).zip(picture.row(y)) {
                self.0.set(x, y, color);
            }
        }
    }

    /// Blends `color` over a pixel whose centre is `distance` pixels from the middle of a line: fully inside the line,
    /// not at all outside, and in proportion where the edge crosses the pixel.
    fn stroke(&mut self, x: u32, y: u32, distance: f32, color: [u8; 3]) {
        let cover = (LINE_WIDTH / 2.0 + 0.5 - distance).clamp(0.0, 1.0);
        let under = self.0.get(x, y);
        let mix = |channel: usize| {
            let (under, over) = (f32::from(under[channel]), f32::from(color[channel]));
            (under + cover * (over - under)).round() as u8
        };
        self.0.set(x, y, [mix(0), mix(1), mix(2)]);
    }

    fn circle(&mut self, [cx, cy]: [f32; 2], radius: f32, color: [u8; 3]) {
        let reach = radius + LINE_WIDTH;
        for y in pixels(cy - reach, cy + reach, self.0.height()) {
            let dy = y as f32 - cy;
            // Only the two arcs that this row crosses are visited, not the pixels between them.
            let outer = (reach * reach - dy * dy).max(0.0).sqrt();
            let inner_radius = (radius - LINE_WIDTH).max(0.0);
            let inner = (inner_radius * inner_radius - dy * dy).max(0.0).sqrt();
            let left = pixels(cx - outer, cx - inner, self.0.width());
            let right = pixels(((cx - inner).floor() + 1.0).max(cx + inner), cx + outer, self.0.width());
            for x in left.chain(right) {
                let distance = (x as f32 - cx).hypot(dy);
                self.stroke(x, y, (distance - radius).abs(), color);
            }
        }
    }

    fn line(&mut self, from: [f32; 2], to: [f32; 2], color: [u8; 3]) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy);
        if !length.is_finite() || length == 0.0 {
            return;
        }
        // Along its major axis, the line extends at most this far across.
        let reach = LINE_WIDTH * std::f32::consts::SQRT_2;
        let steep = dy.abs() > dx.abs();
        let (major, minor) = if steep { (1, 0) } else { (0, 1) };
        let (sides, slope) = ([self.0.width(), self.0.height()], [dx, dy][minor] / [dx, dy][major]);
        for along in pixels(from[major].min(to[major]), from[major].max(to[major]), sides[major]) {
            let middle = from[minor] + (along as f32 - from[major]) * slope;
            for across in pixels(middle - reach, middle + reach, sides[minor]) {
                let (x, y) = if steep { (across, along) } else { (along, across) };
                // The cross product with the direction gives the distance from the infinite line.
                let distance = ((x as f32 - from[0]) * dy - (y as f32 - from[1]) * dx).abs() / length;
                self.stroke(x, y, distance, color);
            }
        }
    }
}

/// The pixel indices from `first` to `last`, clipped to a side of `side` pixels; empty for NaN.
fn pixels(first: f32, last: f32, side: u32) -> std::ops::Range<u32> {
    if first.is_nan() || last.is_nan() || last < first.max(0.0) {
        return 0..0;
    }
    // A cast saturates.
    first.ceil() as u32..(last.floor() as u32).saturating_add(1).min(side)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [u8; 3] = [255; 3];

    fn canvas(width: u32, height: u32) -> Canvas {
        Canvas(Plane::filled((width, height), [0; 3]))
    }

    fn feature(x: f32, y: f32, scale: f32, orientation: f32) -> Feature {
        Feature { x, y, scale, response: 1.0, dark: true, orientation, descriptor: [0.0; 64] }
    }

    #[test]
    fn a_level_line_by_hand() {
        let mut canvas = canvas(7, 5);
        canvas.line([1.0, 2.0], [4.0, 2.0], WHITE);
        // A line of 1.25 px covers a pixel at its middle fully, and a pixel 1 px away by an eighth.
        let rows: Vec<Vec<u8>> = (0..5).map(|y| canvas.0.row(y).iter().map(|rgb| rgb[0]).collect()).collect();
        assert_eq!(rows[0], [0; 7]);
        assert_eq!(rows[1], [0, 32, 32, 32, 32, 0, 0]);
        assert_eq!(rows[2], [0, 255, 255, 255, 255, 0, 0]);
        assert_eq!(rows[3], rows[1]);
        assert_eq!(rows[4], [0; 7]);
    }

    #[test]
    fn lines_are_the_same_in_both_directions_and_axes() {
        let draw = |from: [f32; 2], to: [f32; 2]| {
            let mut canvas = canvas(20, 20);
            canvas.line(from, to, WHITE);
            canvas.0
        };
        let line = draw([3.0, 2.0], [15.0, 7.0]);
        assert_eq!(line, draw([15.0, 7.0], [3.0, 2.0]));
        let turned = draw([2.0, 3.0], [7.0, 15.0]);
        assert_eq!(line, Plane::from_fn((20, 20), |x, y| turned.get(y, x)));
    }

    #[test]
    fn a_circle_lies_on_its_radius() {
        let mut canvas = canvas(41, 41);
        canvas.circle([20.0, 20.0], 12.0, WHITE);
        for y in 0..41 {
            for x in 0..41 {
                let off = ((x as f32 - 20.0).hypot(y as f32 - 20.0) - 12.0).abs();
                let value = canvas.0.get(x, y)[0];
                assert_eq!(value, (255.0 * (1.125 - off).clamp(0.0, 1.0)).round() as u8, "({x}, {y})");
            }
        }
    }

    #[test]
    fn nothing_is_drawn_outside_and_nothing_panics() {
        let strange = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e9, 1e9, -3.5, 2.5];
        let picture = Picture::filled((5, 4), [10, 10, 10, 255]);
        for a in strange {
            for b in strange {
                keypoints(&picture, &[feature(a, b, a, b), feature(1.0, 1.0, a, b), feature(a, b, 2.0, 1.0)]);
                matches(&picture, &picture, &[([a, b], [b, a]), ([a, 1.0], [2.0, b])]);
            }
        }
        let far = keypoints(&picture, &[feature(100.0, 1.0, 2.0, 1.0), feature(-50.0, -50.0, 2.0, 1.0)]);
        assert!(far.data().iter().all(|&rgb| rgb == [10; 3]));
    }

    #[test]
    fn keypoints_show_scale_and_orientation() {
        let picture = Picture::filled((41, 41), [0, 0, 0, 255]);
        let down = keypoints(&picture, &[feature(20.0, 20.0, 4.0, std::f32::consts::FRAC_PI_2)]);
        assert_eq!(down.get(30, 20), DARK_BLOB, "on the circle of 2.5 * 4 px");
        assert_eq!(down.get(20, 25), DARK_BLOB, "on the line");
        assert_eq!(down.get(25, 20), [0; 3]);
        let upright = keypoints(&picture, &[feature(20.0, 20.0, 4.0, 0.0)]);
        assert_eq!(upright.get(25, 20), [0; 3]);
    }

    #[test]
    fn matches_join_the_two_pictures() {
        let (left, right) =
            (Picture::filled((20, 10), [50, 50, 50, 255]), Picture::filled((12, 14), [90, 90, 90, 255]));
        let figure = matches(&left, &right, &[([5.0, 5.0], [6.0, 5.0])]);
        assert_eq!(figure.size(), (20 + GAP + 12, 14));
        assert_eq!((figure.get(0, 0), figure.get(0, 13), figure.get(39, 13)), ([50; 3], [0; 3], [90; 3]));
        assert!((5..=34).all(|x| figure.get(x, 5) == distinct(0)));
        assert_ne!(figure.get(37, 5), [90; 3], "on the circle around the right point");
    }

    #[test]
    fn an_epipolar_line_runs_through_both_pictures() {
        let picture = Picture::filled((20, 30), [50, 50, 50, 255]);
        let figure = epipolar_lines(&picture, &picture, &[([15.0, 8.0], [3.0, 20.0])]);
        assert_eq!(figure.size(), (20 + GAP + 20, 30));
        assert!((0..48).all(|x| figure.get(x, 8) == distinct(0)));
        let right = 20 + GAP + 3;
        assert_eq!(figure.get(right + 3, 20), distinct(0), "on the circle around the right point");
        assert_eq!(figure.get(right, 20), [50; 3]);
    }

    #[test]
    fn pictures_stand_side_by_side() {
        let (a, b) = (Plane::filled((2, 1), [1; 3]), Plane::filled((1, 2), [2; 3]));
        let row = side_by_side(&[&a, &b, &a]);
        assert_eq!(row.size(), (2 + GAP + 1 + GAP + 2, 2));
        let level = |y: u32| [0, 1, 2, 2 + GAP, 2 + GAP + 1, 2 + GAP + 1 + GAP].map(|x| row.get(x, y)[0]);
        assert_eq!((level(0), level(1)), ([1, 1, 0, 2, 0, 1], [0, 0, 0, 2, 0, 0]));
        assert_eq!(side_by_side(&[&b]), b);
    }

    #[test]
    fn colours_of_neighbours_differ() {
        assert_eq!(distinct(0), [255, 38, 38]);
        let apart = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).map(|(&a, b)| u32::from(a.abs_diff(b))).sum::<u32>();
        for index in 0..1000 {
            assert!(apart(distinct(index), distinct(index + 1)) > 200, "{index}");
            assert!(apart(distinct(index), distinct(index + 2)) > 100, "{index}");
        }
    }
}
