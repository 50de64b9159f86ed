//! Why a pair cannot be rectified.

use std::fmt;

use super::{
    evidence::{Evidence, RELATED},
    relation::Relation,
};

/// Why a pair cannot be rectified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The cameras do not stand as a pair needs: [`Evidence::relation`] is not [`Relation::Parallax`].
    Relation(Evidence),
    /// Every homography that brings rows to correspond stretches or cuts the pictures beyond use.
    Distorted {
        /// Largest ratio of two areas around the matches that were one; infinite for a horizon between the matches.
        area: f64,
    },
    /// Rows do not correspond after the rectification: those of the points that agree with the geometry differ by so many pixels in
    /// the mean.
    Rows(f64),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let found = match self {
            Self::Relation(found) => found,
            Self::Distorted { area } => {
                let how = match area.is_finite() {
                    true => format!("one part of a picture is enlarged {area:.0} times as much as another"),
                    false => "a picture is torn apart at a horizon".into(),
                };
                return write!(f, "rows correspond only if {how}: take the pictures side by side");
            }
            Self::Rows(off) => {
                let out = "calibrate the cameras and rectify the pair by the calibration";
                return write!(f, "rows of matched points still differ by {off:.1} px in the mean: {out}");
            }
        };
        let Evidence { inliers, points, off_plane, epipoles, .. } = *found;
        match found.relation {
            Relation::Unrelated if points < RELATED.0 => write!(
                f,
                "the views are unrelated, or show too little in common, {points} matched points do not tell how the cameras stand: \
                 name two pictures of one scene"
            ),
            Relation::Unrelated => write!(
                f,
                "the views are unrelated, {inliers} of {points} matched points agree on how the cameras stand: name two pictures \
                 of one scene"
            ),
            Relation::Still => write!(
                f,
                "the views show no parallax, most of {inliers} points stay where they are, as in one picture or two from one place: \
                 take the second picture from another place"
            ),
            Relation::Flat | Relation::Plane | Relation::Turned => {
                let (what, way_out) = match found.relation {
                    Relation::Plane => ("the views show a plane", "take a scene with depth"),
                    Relation::Turned => ("the camera turned on the spot", "take the second picture from another place"),
                    _ => {
                        let way_out = "take both pictures of a scene with depth, from two places";
                        ("the views show a plane, or the camera turned on the spot", way_out)
                    }
                };
                write!(f, "{what}, {:.0} % of {inliers} points show depth: {way_out}", 100.0 * off_plane)
            }
            Relation::Forward => {
                let view = if epipoles[0] <= epipoles[1] { "left" } else { "right" };
                write!(
                    f,
                    "the camera moved forwards or backwards, the epipole lies inside the {view} picture: take the pictures side \
                     by side"
                )
            }
            Relation::Parallax => f.write_str("the views can be rectified"),
        }
    }
}
