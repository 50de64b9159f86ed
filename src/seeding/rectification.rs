//! Diagnosis of rectification: how the rows of the two views correspond.

use glam::DVec2;

use super::{
    Verdict,
    brightness::median,
    evidence::{TURN, is_enough, is_majority, is_of_one_scale, is_small},
    vertical::vertical,
};
use crate::{
    image::Size,
    matching::Seed,
    rectify::{AGREEMENT, Climb, Correspondence, RowKind, RowModel, Slant, fit::RowFit},
};

/// Smallest share of the inliers of a fit that agree with the rows as they are, for these to be preferred where most seeds
/// contradict the fit.
const AS_MANY: f64 = 0.9;

/// How the rows of the two views correspond.
///
/// Figures of a fit are given wherever at least 15 seeds and a fifth of them agree with it; they deserve trust where most
/// seeds agree, see [`Self::most_agree`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectification {
    /// The verdict from the figures below.
    pub verdict: Verdict,
    /// Left rows of the pixels of the right view. Rows as they are, unless the verdict is [`Verdict::Alignable`].
    pub rows: RowModel,
    /// Right row minus left row at the centre of the right view, in pixels.
    pub offset: f32,
    /// Rotation of the right view against the left, in degrees, clockwise on the screen.
    pub rotation: f32,
    /// Vertical size of an object in the right view divided by that in the left view.
    pub scale: f32,
    /// Robust standard deviation of the inliers' rows from the fit, in pixels.
    pub residual: f32,
    /// 95 % of the inliers' row errors are at most this, in pixels, once the fit is taken into account.
    pub remaining: f32,
    /// Largest row error anywhere in the picture that a distortion of the lens leaves after the fit, in pixels; 0 if the
    /// seeds show no distortion.
    pub unexplained: f32,
    /// Largest row difference of the fit anywhere in the picture, in pixels.
    pub largest: f32,
    /// Change of the disparity per row that most surfaces share, where rows correspond: as where the columns of the right view lean. 0 unless
    /// it is clear.
    pub lean: f32,
    /// Row difference per pixel of disparity, where the baseline of the cameras slants in the pictures: no warp of the rows brings these
    /// together, and [`Self::verdict`] is [`Verdict::NotRectified`]. 0 unless it is clear.
    pub climb: f32,
    /// Number of inliers, seeds that agree with the fit; for [`Verdict::Vertical`], with a fit of columns.
    pub agreeing: usize,
    /// Number of all seeds.
    pub seeds: usize,
}

impl Rectification {
    /// Fits row models to seeds matched in any row, the most confident first; `size` is width and height of the views, in
    /// pixels. The same seeds give the same figures.
    pub fn new(seeds: &[Seed], size: impl Into<Size>) -> Self {
        let size = size.into();
        let points: Vec<Correspondence> = seeds.iter().map(correspondence).collect();
        let fit = RowFit::new(&points, size);
        let agreeing = fit.as_ref().map_or(0, RowFit::agreeing);
        let nothing = Self { agreeing, seeds: seeds.len(), ..Self::UNKNOWN };
        if let Some(columns) = vertical(&points, size, agreeing) {
            return Self { verdict: Verdict::Vertical, agreeing: columns, ..nothing };
        }
        match fit {
            Some(fit) if is_enough(agreeing, points.len()) => Self::of(preferred(fit, &points), &points, size),
            _ => nothing,
        }
    }

    const UNKNOWN: Self = Self {
        verdict: Verdict::Unknown,
        rows: RowModel::AS_IS,
        offset: 0.0,
        rotation: 0.0,
        scale: 1.0,
        residual: 0.0,
        remaining: 0.0,
        unexplained: 0.0,
        largest: 0.0,
        lean: 0.0,
        climb: 0.0,
        agreeing: 0,
        seeds: 0,
    };

    /// Figures and verdict of a fit that enough seeds agree with.
    fn of(fit: RowFit, points: &[Correspondence], size: Size) -> Self {
        let mut errors: Vec<f32> = fit.inliers().map(|error| error as f32).collect();
        errors.sort_by(f32::total_cmp);
        let agreeing = errors.len();
        let seeds = fit.errors.len();
        let rotation = fit.model.rotation() as f32;
        let climb = Climb::of(points, &fit.errors).filter(Climb::is_clear);
        let climb = climb.map_or(0.0, |climb| climb.rows as f32);
        let verdict = if climb != 0.0 {
            Verdict::NotRectified
        } else if fit.model.kind() == RowKind::AsIs {
            Verdict::Rectified
        } else if !is_majority(agreeing, seeds) {
            Verdict::NotRectified
        } else if is_small(&fit.model, size) {
            Verdict::Alignable
        } else if 180.0 - rotation.abs() <= TURN && is_of_one_scale(&fit.model) {
            Verdict::UpsideDown
        } else {
            Verdict::NotRectified
        };
        let aligned = matches!(verdict, Verdict::Rectified | Verdict::Alignable);
        Self {
            verdict,
            rows: if aligned { fit.model } else { RowModel::AS_IS },
            remaining: errors.get(agreeing * 95 / 100).copied().unwrap_or(0.0),
            unexplained: if aligned { fit.unexplained as f32 } else { 0.0 },
            lean: if aligned { lean(&fit, points) } else { 0.0 },
            climb,
            residual: median(errors).map_or(0.0, |spread| super::DEVIATIONS * spread),
            agreeing,
            seeds,
            ..Self::UNKNOWN.along(fit.model, size)
        }
    }

    /// These figures for rows by `rows`, in pictures of `size`, that a warp brings together.
    pub(crate) fn along(self, rows: RowModel, size: Size) -> Self {
        Self {
            verdict: if rows.kind() == RowKind::AsIs { Verdict::Rectified } else { Verdict::Alignable },
            rows,
            // The left row of the centre, in pixels below the centre, negated; 0 and not -0 for rows as they are.
            offset: 0.0 - rows.parameters()[2] as f32,
            rotation: rows.rotation() as f32,
            scale: rows.scale() as f32,
            largest: rows.largest(size) as f32,
            ..self
        }
    }

    /// Whether corresponding points are known to lie in the same row, without any warp.
    pub fn is_rectified(&self) -> bool {
        self.verdict == Verdict::Rectified
    }

    /// Whether a search along rows finds corresponding points: as the views are, or after a warp of the right view by
    /// [`Self::rows`].
    pub fn is_alignable(&self) -> bool {
        matches!(self.verdict, Verdict::Rectified | Verdict::Alignable)
    }

    /// Whether the views as they are have corresponding points in rows that no small warp mends: the verdicts
    /// [`Verdict::NotRectified`], [`Verdict::UpsideDown`] and [`Verdict::Vertical`].
    pub fn rows_differ(&self) -> bool {
        matches!(self.verdict, Verdict::NotRectified | Verdict::UpsideDown | Verdict::Vertical)
    }

    /// Whether the verdict stands on a fit: it is not unknown, and most seeds agree where rows differ.
    pub fn is_certain(&self) -> bool {
        self.is_alignable() || self.rows_differ() && self.most_agree()
    }

    /// Whether most seeds agree with the fit that the figures describe.
    pub fn most_agree(&self) -> bool {
        is_majority(self.agreeing, self.seeds)
    }
}

/// [`Rectification::lean`] of the points that agree with a fit.
fn lean(fit: &RowFit, points: &[Correspondence]) -> f32 {
    let inliers: Vec<Correspondence> = points
        .iter()
        .filter(|Correspondence { left, right }| (fit.model.left_row(right.x, right.y) - left.y).abs() <= AGREEMENT)
        .copied()
        .collect();
    Slant::of(&inliers, 1.0).filter(Slant::is_clear).map_or(0.0, |slant| slant.along[1] as f32)
}

fn correspondence(seed: &Seed) -> Correspondence {
    let place = |x: f32, y: f32| DVec2::new(x.into(), y.into());
    Correspondence { left: place(seed.x, seed.y), right: place(seed.right_x(), seed.right_y()) }
}

/// The fit, or the rows as they are if most points contradict the fit and nearly as many agree with the rows as they are:
/// few points do not justify a warp.
fn preferred(fit: RowFit, points: &[Correspondence]) -> RowFit {
    if is_majority(fit.agreeing(), points.len()) {
        return fit;
    }
    let as_is = RowFit::of(RowModel::AS_IS, points);
    if as_is.agreeing() as f64 >= AS_MANY * fit.agreeing() as f64 { as_is } else { fit }
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
        assert!(found.is_rectified() && found.largest == 0.0, "{found:?}");
        assert!(found.agreeing >= 80 && found.seeds == 120);
    }

    #[test]
    fn small_errors_are_alignable_with_their_figures() {
        for (degrees, scale, offset) in
            [(0.0, 1.0, 0.5), (0.0, 1.0, 2.0), (0.0, 1.0, -25.0), (1.0, 1.0, 0.0), (0.0, 1.02, 0.0), (-2.5, 0.97, 4.0)]
        {
            let found = Rectification::new(&seeds(degrees, scale, offset), SIZE);
            assert_eq!(found.verdict, Verdict::Alignable, "{found:?}");
            assert!((found.rotation - degrees).abs() < 0.01, "{degrees} degrees: {found:?}");
            assert!((found.scale / scale - 1.0).abs() < 0.001, "x {scale}: {found:?}");
            assert!((found.offset - offset).abs() < 0.05 + 0.04 * offset.abs(), "{offset} px: {found:?}");
            assert!(found.remaining < 0.05 && found.unexplained == 0.0, "{found:?}");
            // The right place of the left pixel (100, 50) at disparity 0.
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let (u, v, scale) = (-220.0, -190.0, f64::from(scale));
            let right = (320.0 + scale * (cos * u - sin * v), 240.0 + scale * (sin * u + cos * v) + f64::from(offset));
            assert!((found.rows.left_row(right.0, right.1) - 50.0).abs() < 0.05, "{found:?}");
        }
    }

    #[test]
    fn large_errors_are_not_rectified_and_nothing_is_warped() {
        for (degrees, scale, offset) in [(6.0, 1.0, 0.0), (0.0, 1.15, 0.0), (0.0, 1.0, 60.0), (30.0, 1.5, 0.0)] {
            let found = Rectification::new(&seeds(degrees, scale, offset), SIZE);
            assert_eq!(found.verdict, Verdict::NotRectified, "{found:?}");
            assert!((found.rotation - degrees).abs() < 0.1 && (found.scale / scale - 1.0).abs() < 0.003, "{found:?}");
            assert_eq!(found.rows, RowModel::AS_IS);
        }
    }

    #[test]
    fn a_right_view_upside_down_is_recognised() {
        for (degrees, offset) in [(180.0, 0.0), (178.0, 5.0), (-177.0, -9.0)] {
            let found = Rectification::new(&seeds(degrees, 1.0, offset), SIZE);
            assert_eq!(found.verdict, Verdict::UpsideDown, "{found:?}");
            assert!(found.to_string().contains("turn the right view by 180 degrees"), "{found}");
        }
        assert_eq!(Rectification::new(&seeds(170.0, 1.0, 0.0), SIZE).verdict, Verdict::NotRectified);
    }

    #[test]
    fn cameras_above_each_other_are_recognised() {
        let transposed = |seed: &Seed| {
            let (disparity, dy) = (-seed.dy, -4.0 * seed.disparity);
            Seed { x: seed.y, y: seed.x, disparity, dy, ..*seed }
        };
        let above: Vec<Seed> = seeds(0.0, 1.0, 2.0).iter().map(transposed).collect();
        let found = Rectification::new(&above, (SIZE.height, SIZE.width));
        assert_eq!(found.verdict, Verdict::Vertical, "{found:?}");
        assert!(found.agreeing >= 80, "{found:?}");
        let text = found.to_string();
        assert!(text.contains("turn both views by 90 degrees") && !text.contains("px"), "{text}");
    }

    #[test]
    fn exchanging_the_views_inverts_the_figures() {
        let forward = seeds(3.0, 1.05, 5.0);
        let exchanged = |s: &Seed| Seed { x: s.right_x(), y: s.right_y(), disparity: -s.disparity, dy: -s.dy, ..*s };
        let backward: Vec<Seed> = forward.iter().map(exchanged).collect();
        let (there, back) = (Rectification::new(&forward, SIZE), Rectification::new(&backward, SIZE));
        assert!((there.offset + back.offset).abs() < 0.7, "{there:?} {back:?}");
        assert!((there.rotation + back.rotation).abs() < 0.1, "{there:?} {back:?}");
        assert!((there.scale * back.scale - 1.0).abs() < 2e-3, "{there:?} {back:?}");
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
    fn figures_are_told_only_where_most_seeds_agree() {
        let text = Rectification::new(&seeds(-1.0, 0.98, 3.0), SIZE).to_string();
        for part in ["px lower", "1.0", "anticlockwise", "2.0 % smaller", "points agree"] {
            assert!(text.contains(part), "'{part}' in: {text}");
        }
        assert!(!text.contains('\n'));

        let mut mixed = seeds(6.0, 1.0, 3.0);
        for (i, seed) in (0..).zip(&mut mixed) {
            if i % 3 == 1 {
                seed.dy = (i * i * 7919 % 4801) as f32 / 10.0 - 240.0;
            }
        }
        let found = Rectification::new(&mixed, SIZE);
        assert_eq!(found.verdict, Verdict::NotRectified, "{found:?}");
        assert!(!found.most_agree() && !found.is_certain(), "{found:?}");
        let text = found.to_string();
        assert!(!text.contains("px") && !text.contains("degrees"), "{text}");
    }

    #[test]
    fn rows_as_they_are_win_where_few_seeds_agree_on_anything() {
        let mut few = seeds(0.0, 1.0, 0.1);
        for (i, seed) in (0..).zip(&mut few) {
            if i % 3 == 1 {
                seed.dy = (i * i * 7919 % 4801) as f32 / 10.0 - 240.0;
            }
        }
        let found = Rectification::new(&few, SIZE);
        assert!(found.is_rectified() && !found.most_agree(), "{found:?}");
    }
}
