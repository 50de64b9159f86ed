//! Homographies in another form than that of a truth, by comparison with matches.

use glam::DMat3;

use super::{
    matches::{Judged, PointMatch},
    truth::Truth,
};

/// Least number of matches to judge by.
const LEAST: usize = 20;
/// Largest share of matches that agree with a homography as it is, and least share that agrees with it in another form, where forms differ.
const SHARES: [f64; 2] = [0.25, 0.5];

/// A form of a homography other than from the first view to the second, by rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// From the second view to the first.
    Inverse,
    /// By columns.
    Transposed,
    /// From the second view to the first, by columns.
    InverseTransposed,
}

impl Form {
    const ALL: [Self; 3] = [Self::Inverse, Self::Transposed, Self::InverseTransposed];

    /// What mends the form, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Inverse => "inverted",
            Self::Transposed => "transposed",
            Self::InverseTransposed => "inverted and transposed",
        }
    }

    fn of(self, matrix: DMat3) -> DMat3 {
        match self {
            Self::Inverse => matrix.inverse(),
            Self::Transposed => matrix.transpose(),
            Self::InverseTransposed => matrix.inverse().transpose(),
        }
    }
}

/// The form that a homography seems to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherForm {
    /// What has to be done to the homography.
    pub form: Form,
    /// Share of matches that agree with the homography as it is, and in the other form, 0 to 1.
    pub agree: [f64; 2],
}

impl OtherForm {
    /// The other form of a homography, if few of `matches` agree with it and most do with its inverse, its transpose or both; `None` for the
    /// truth of a stereo pair, too. `tolerance` in pixels of the second view, as in [`Judged::new`].
    ///
    /// # Errors
    /// As [`Judged::new`].
    pub fn of(matches: &[PointMatch], truth: &Truth, tolerance: f64) -> crate::error::Result<Option<Self>> {
        if matches.len() < LEAST {
            return Ok(None);
        }
        let share = |truth: &Truth| {
            let right = Judged::new(matches, truth, tolerance)?.count_right();
            Ok::<_, crate::error::Error>(right as f64 / matches.len() as f64)
        };
        let as_it_is = share(truth)?;
        if as_it_is > SHARES[0] {
            return Ok(None);
        }
        for form in Form::ALL {
            // A form that is no homography is no other form.
            let Some(other) = truth.with_homography(|matrix| form.of(matrix)) else { continue };
            let agree = [as_it_is, share(&other)?];
            if agree[1] >= SHARES[1] {
                return Ok(Some(Self { form, agree }));
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::{
        eval::conditions::{Changed, Condition},
        io::Picture,
    };

    /// A shift, a scale and a little of perspective.
    const MATRIX: DMat3 = DMat3::from_cols_array(&[1.1, 0.05, 2e-4, -0.1, 0.95, 1e-4, 12.0, -7.0, 1.0]);

    fn truth(matrix: DMat3) -> Truth {
        Truth::homography(matrix, (160, 120), (160, 120)).unwrap()
    }

    /// Matches that agree with `truth`, a grid of the first view.
    fn matches(truth: &Truth) -> Vec<PointMatch> {
        let grid = (0..120).map(|i| DVec2::new(f64::from(20 + 10 * (i % 12)), f64::from(20 + 8 * (i / 12))));
        let found = |first| Some(PointMatch { first, second: truth.locate(first)?, confidence: 1.0, points: None });
        grid.filter(|&first| truth.shows(first)).filter_map(found).collect()
    }

    fn found(matches: &[PointMatch], matrix: DMat3) -> Option<Form> {
        OtherForm::of(matches, &truth(matrix), 1.5).unwrap().map(|other| other.form)
    }

    #[test]
    fn other_forms_are_found() {
        let matches = matches(&truth(MATRIX));
        assert!(matches.len() > 80);
        assert_eq!(found(&matches, MATRIX), None);
        assert_eq!(found(&matches, MATRIX.inverse()), Some(Form::Inverse));
        assert_eq!(found(&matches, MATRIX.transpose()), Some(Form::Transposed));
        assert_eq!(found(&matches, MATRIX.inverse().transpose()), Some(Form::InverseTransposed));
        assert_eq!(found(&matches[..19], MATRIX.inverse()), None, "too few");
    }

    #[test]
    fn what_agrees_with_no_form_is_no_other_form() {
        let elsewhere = DMat3::from_cols_array(&[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 130.0, 3.0, 1.0]);
        assert_eq!(found(&matches(&truth(MATRIX)), elsewhere), None);
    }

    #[test]
    fn a_changed_view_is_that_of_the_homography() {
        let turned =
            Changed::by(&["rotation=90".parse::<Condition>().unwrap()], &Picture::filled((160, 120), [9; 4]), 1);
        let changed = |matrix| truth(matrix).changed(&turned);
        let other = OtherForm::of(&matches(&changed(MATRIX)), &changed(MATRIX.inverse()), 1.5).unwrap().unwrap();
        assert_eq!((other.form, other.agree[1]), (Form::Inverse, 1.0));
    }
}
