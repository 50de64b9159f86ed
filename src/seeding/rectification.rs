//! Diagnosis of rectification: whether corresponding points lie in the same row, and if not, by how much the views are
//! shifted, rotated and scaled.

use std::fmt;

use glam::{DMat3, DVec3};

use super::brightness::median;
use crate::{image::Size, matching::Seed};

/// Number of seeds on which candidate fits are tested, the most confident ones.
const TRIED: usize = 1000;
/// Number of candidate fits.
const FITS: usize = 1000;
/// Largest row error of an inlier, in pixels: features are located to about half a pixel.
const AGREEMENT: f64 = 1.5;
/// Smallest number of inliers, and their smallest share of all seeds. By chance about one seed in a hundred is an
/// inlier.
const NEEDED: (usize, f64) = (15, 0.2);
/// Number of steps of the robust fit; the last ones no longer change it.
const STEPS: usize = 10;
/// Largest row difference anywhere in the picture that counts as rectified, in pixels.
const TOLERANCE: f64 = 1.5;

/// Whether a pair is rectified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Corresponding points lie in the same row.
    Rectified,
    /// Corresponding points lie in different rows: a search along rows would find nothing but noise.
    NotRectified,
    /// Too few seeds agree with each other.
    Unknown,
}

/// The similarity between the rows of the two views.
///
/// The figures describe the map from the left view's rows to the right view's, seen from midway between the two:
/// exchanging the views negates offset and rotation and inverts the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectification {
    /// The verdict from the figures below.
    pub verdict: Verdict,
    /// Right row minus left row at the centre of the picture, in pixels.
    pub offset: f32,
    /// Rotation of the right view against the left, in degrees, clockwise on the screen.
    pub rotation: f32,
    /// Vertical size of an object in the right view divided by that in the left view.
    pub scale: f32,
    /// Robust standard deviation of the inliers' rows from the fit, in pixels.
    pub residual: f32,
    /// Largest row difference of the fit anywhere in the picture, in pixels.
    pub largest: f32,
    /// Number of inliers, seeds that agree with the fit.
    pub agreeing: usize,
    /// Number of all seeds.
    pub seeds: usize,
}

impl Rectification {
    /// Fits the similarity to seeds matched in any row, the most confident first; `size` is width and height of the
    /// views, in pixels.
    ///
    /// Random sample consensus (Fischler and Bolles 1981) with a fixed random sequence, then reweighted least squares
    /// (Tukey's biweight); the same seeds give the same figures.
    pub fn new(seeds: &[Seed], size: impl Into<Size>) -> Self {
        let size = size.into();
        let points: Vec<Point> = seeds.iter().map(|seed| Point::new(seed, size)).collect();
        let fit = consensus(&points[..points.len().min(TRIED)]).and_then(|fit| refined(fit, &points));
        let agreeing = fit.map_or(0, |fit| fit.agreeing(&points).count());
        let enough = agreeing >= NEEDED.0 && agreeing as f64 >= NEEDED.1 * seeds.len() as f64;
        let Some(fit) = fit.filter(|_| enough) else {
            return Self { agreeing, ..Self::unknown(seeds.len()) };
        };
        let largest = fit.largest(size);
        let (rotation, scale) = fit.similarity();
        let errors = fit.agreeing(&points).map(|point| fit.error(point).abs() as f32).collect();
        Self {
            verdict: if largest <= TOLERANCE { Verdict::Rectified } else { Verdict::NotRectified },
            offset: fit.0.x as f32,
            rotation: rotation as f32,
            scale: scale as f32,
            residual: median(errors).map_or(0.0, |spread| super::DEVIATIONS * spread),
            largest: largest as f32,
            agreeing,
            seeds: seeds.len(),
        }
    }

    fn unknown(seeds: usize) -> Self {
        Self {
            verdict: Verdict::Unknown,
            offset: 0.0,
            rotation: 0.0,
            scale: 1.0,
            residual: 0.0,
            largest: 0.0,
            agreeing: 0,
            seeds,
        }
    }

    /// Whether corresponding points are known to lie in the same row.
    pub fn is_rectified(&self) -> bool {
        self.verdict == Verdict::Rectified
    }
}

impl fmt::Display for Rectification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { offset, rotation, scale, largest, agreeing, seeds, .. } = *self;
        let either = |positive, one, other| if positive { one } else { other };
        match self.verdict {
            Verdict::Rectified => {
                write!(f, "rows correspond to within {largest:.1} px ({agreeing} of {seeds} points agree)")
            }
            Verdict::NotRectified => write!(
                f,
                "the right view lies {:.1} px {}, is turned {:.2} degrees {} and {:.1} % {}, so that rows differ by up \
                 to {largest:.1} px ({agreeing} of {seeds} points agree)",
                offset.abs(),
                either(offset >= 0.0, "lower", "higher"),
                rotation.abs(),
                either(rotation >= 0.0, "clockwise", "anticlockwise"),
                100.0 * (scale - 1.0).abs(),
                either(scale >= 1.0, "larger", "smaller"),
            ),
            Verdict::Unknown => {
                write!(f, "unknown: {agreeing} of {seeds} points agree on how rows correspond, too few to tell")
            }
        }
    }
}

/// A seed as a sample of the fit.
#[derive(Clone, Copy)]
struct Point {
    /// `(1, x, y)`, with the midpoint of the two views' positions relative to the picture centre, in pixels.
    at: DVec3,
    /// Row difference, in pixels.
    dy: f64,
}

impl Point {
    fn new(seed: &Seed, Size { width, height }: Size) -> Self {
        let x = f64::from(seed.x - seed.disparity / 2.0) - f64::from(width - 1) / 2.0;
        let y = f64::from(seed.y + seed.dy / 2.0) - f64::from(height - 1) / 2.0;
        Self { at: DVec3::new(1.0, x, y), dy: f64::from(seed.dy) }
    }
}

/// Coefficients `(offset, a, b)` of dy = offset + a x + b y.
#[derive(Clone, Copy, Debug)]
struct Fit(DVec3);

impl Fit {
    /// Weighted least-squares fit; `None` if the points lie on a line.
    fn least_squares(points: impl Iterator<Item = (Point, f64)>) -> Option<Self> {
        let (mut normal, mut moment) = (DMat3::ZERO, DVec3::ZERO);
        for (point, weight) in points {
            let weighted = point.at * weight;
            normal += DMat3::from_cols(weighted * point.at.x, weighted * point.at.y, weighted * point.at.z);
            moment += weighted * point.dy;
        }
        let spans = normal.determinant() > 1e-6 * normal.x_axis.x * normal.y_axis.y * normal.z_axis.z;
        spans.then(|| Self(normal.inverse() * moment))
    }

    fn error(&self, point: &Point) -> f64 {
        point.dy - self.0.dot(point.at)
    }

    fn agreeing<'a>(&'a self, points: &'a [Point]) -> impl Iterator<Item = &'a Point> {
        points.iter().filter(|point| self.error(point).abs() <= AGREEMENT)
    }

    fn largest(&self, Size { width, height }: Size) -> f64 {
        let (x, y) = (f64::from(width - 1) / 2.0, f64::from(height - 1) / 2.0);
        self.0.x.abs() + self.0.y.abs() * x + self.0.z.abs() * y
    }

    /// Rotation in degrees, and scale. With points as complex numbers and right = w left, the difference of the two is
    /// z = 2 (w - 1) / (w + 1) times their midpoint; the real part of z is b and its imaginary part is a.
    fn similarity(&self) -> (f64, f64) {
        let (a, b) = (self.0.y, self.0.z);
        let rotation = a.atan2(2.0 + b) - (-a).atan2(2.0 - b);
        (rotation.to_degrees(), (2.0 + b).hypot(a) / (2.0 - b).hypot(a))
    }
}

/// The fit through three points that has the most inliers.
fn consensus(points: &[Point]) -> Option<Fit> {
    if points.len() < 3 {
        return None;
    }
    let mut state = 1u64;
    let mut pick = || {
        // Knuth's MMIX generator; only its upper bits are random enough.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        points[(state >> 33) as usize % points.len()]
    };
    let mut best: Option<(usize, Fit)> = None;
    for _ in 0..FITS {
        let three = [pick(), pick(), pick()];
        let Some(fit) = Fit::least_squares(three.into_iter().map(|point| (point, 1.0))) else { continue };
        let agreeing = fit.agreeing(points).count();
        if best.is_none_or(|(most, _)| agreeing > most) {
            best = Some((agreeing, fit));
        }
    }
    best.map(|(_, fit)| fit)
}

/// Reweighted least squares, starting from a first fit.
fn refined(mut fit: Fit, points: &[Point]) -> Option<Fit> {
    for _ in 0..STEPS {
        fit = Fit::least_squares(points.iter().map(|&point| {
            let share = fit.error(&point) / (2.0 * AGREEMENT);
            (point, (1.0 - share * share).max(0.0).powi(2))
        }))?;
    }
    Some(fit)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size::new(641, 481);

    /// Seeds of a scene of many depths whose right view is rotated, scaled and shifted about the picture's centre;
    /// every third seed is wrong.
    fn seeds(degrees: f32, scale: f32, offset: f32) -> Vec<Seed> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        (0..120)
            .map(|i| {
                let (x, y) = ((i * 197 % 600) as f32 + 20.0, (i * 331 % 440) as f32 + 20.0);
                let (u, v) = (x - (i * 7 % 13) as f32 - 320.0, y - 240.0);
                let (right_x, right_y) = (320.0 + scale * (cos * u - sin * v), 240.0 + scale * (sin * u + cos * v));
                let wrong = if i % 3 == 0 { (i * 53 % 400) as f32 - 200.0 } else { 0.0 };
                Seed { x, y, disparity: x - right_x, dy: right_y + offset + wrong - y, confidence: 0.5 }
            })
            .collect()
    }

    #[test]
    fn rows_that_correspond_are_rectified() {
        let found = Rectification::new(&seeds(0.0, 1.0, 0.0), SIZE);
        assert!(found.is_rectified() && found.largest < 0.1, "{found:?}");
        assert!(found.agreeing >= 80 && found.seeds == 120);
    }

    #[test]
    fn offset_rotation_and_scale_are_told_with_their_figures() {
        for (degrees, scale, offset) in
            [(0.0, 1.0, 2.0), (0.0, 1.0, -25.0), (1.0, 1.0, 0.0), (0.0, 1.02, 0.0), (-2.5, 0.97, 4.0), (30.0, 1.5, 0.0)]
        {
            let found = Rectification::new(&seeds(degrees, scale, offset), SIZE);
            assert_eq!(found.verdict, Verdict::NotRectified);
            assert!((found.rotation - degrees).abs() < 0.1 + 0.02 * degrees.abs(), "{degrees} degrees: {found:?}");
            assert!((found.scale / scale - 1.0).abs() < 0.003, "x {scale}: {found:?}");
            if degrees == 0.0 {
                assert!((found.offset - offset).abs() < 0.1, "{offset} px: {found:?}");
            }
        }
    }

    #[test]
    fn exchanging_the_views_inverts_the_figures() {
        let forward = seeds(3.0, 1.1, 5.0);
        let exchanged = |s: &Seed| Seed { x: s.right_x(), y: s.right_y(), disparity: -s.disparity, dy: -s.dy, ..*s };
        let backward: Vec<Seed> = forward.iter().map(exchanged).collect();
        let (there, back) = (Rectification::new(&forward, SIZE), Rectification::new(&backward, SIZE));
        assert!((there.offset + back.offset).abs() < 1e-3, "{there:?} {back:?}");
        assert!((there.rotation + back.rotation).abs() < 1e-3, "{there:?} {back:?}");
        assert!((there.scale * back.scale - 1.0).abs() < 1e-4, "{there:?} {back:?}");
    }

    #[test]
    fn too_few_or_unrelated_seeds_are_unknown_not_unrectified() {
        let few = seeds(1.0, 1.0, 0.0);
        for seeds in [&few[..0], &few[..2], &few[..15]] {
            assert_eq!(Rectification::new(seeds, SIZE).verdict, Verdict::Unknown);
        }
        let mut noise = few;
        for (i, seed) in (0..).zip(&mut noise) {
            seed.dy = (i * i * 7919 % 4801) as f32 / 10.0 - 240.0;
        }
        assert_eq!(Rectification::new(&noise, SIZE).verdict, Verdict::Unknown);
        let column: Vec<Seed> =
            (0..60).map(|i| Seed { x: 9.0, y: i as f32, disparity: 0.0, dy: 0.0, confidence: 1.0 }).collect();
        assert_eq!(Rectification::new(&column, SIZE).verdict, Verdict::Unknown, "one column tells nothing of the rest");
    }

    #[test]
    fn diagnosis_is_one_line_with_figures() {
        let text = Rectification::new(&seeds(-1.0, 0.98, 3.0), SIZE).to_string();
        for part in ["px lower", "1.0", "anticlockwise", "2.0 % smaller", "points agree"] {
            assert!(text.contains(part), "'{part}' in: {text}");
        }
        assert!(!text.contains('\n'));
    }
}
