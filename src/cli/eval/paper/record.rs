//! Matches of one method under one condition, judged against the ground truth.

use glam::DVec2;
use hsad::{
    Result,
    eval::{Judged, PointMatch, Truth},
    image::Plane,
};
use serde_json::{Value, json};

use super::method::{Method, MethodMatches};
use crate::cli::eval::saved_results;

/// A method's matches under a condition, judged against the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub condition: String,
    pub method: Method,
    /// All interest points, in pixels of the first view; empty for a dense method, which finds none itself.
    pub points: Vec<DVec2>,
    /// Number of points with known ground truth.
    pub known: usize,
    /// Number of these points that the second view shows, which are all that can be found.
    pub shown: usize,
    /// For each match of a point with known ground truth, the most confident first: whether it is right.
    pub right: Vec<bool>,
    /// Number of pixels of the first view with known ground truth.
    pub pixels: usize,
    /// For the matches of all positions, the most confident first: `(k, right matches among the first k)` at [`steps`].
    pub everywhere: Vec<(usize, usize)>,
    /// Wall-clock time from the pictures to the matches in seconds, including building the kernels.
    pub seconds: f64,
}

impl Record {
    /// Judges matches of the first view of a scene; the true `disparities` are not finite where unknown.
    ///
    /// # Errors
    /// [`hsad::Error::Parameter`] for a tolerance that is negative or NaN.
    pub fn new(
        (condition, method): (&str, Method),
        answers: MethodMatches,
        (truth, disparities): (&Truth, &Plane<f32>),
        tolerance: f64,
        seconds: f64,
    ) -> Result<Self> {
        let judged = |found: &[PointMatch]| -> Result<Vec<bool>> {
            Ok(Judged::new(found, truth, tolerance)?.with_even_ties(found).right)
        };
        Ok(Self {
            condition: condition.into(),
            method,
            known: answers.points.iter().filter(|&&at| truth.locate(at).is_some()).count(),
            shown: answers.points.iter().filter(|&&at| truth.shows(at)).count(),
            right: judged(&answers.at_points)?,
            pixels: disparities.data().iter().filter(|disparity| disparity.is_finite()).count(),
            everywhere: counted(&judged(&answers.everywhere)?),
            points: if method.is_dense() { Vec::new() } else { answers.points },
            seconds,
        })
    }
}

impl saved_results::Saveable for Record {
    fn to_json(&self) -> Value {
        let Self { condition, method, points, known, shown, right, pixels, everywhere, seconds } = self;
        json!({
            "condition": condition,
            "method": method.name(),
            "known": known,
            "shown": shown,
            "right": right.iter().map(|&right| if right { '1' } else { '0' }).collect::<String>(),
            "pixels": pixels,
            "everywhere": everywhere,
            "seconds": seconds,
            "points": points.iter().map(|at| [at.x, at.y]).collect::<Vec<_>>(),
        })
    }

    fn from_json(value: &Value) -> Option<Self> {
        let count = |value: &Value| usize::try_from(value.as_u64()?).ok();
        let judged = |digit| match digit {
            '0' => Some(false),
            '1' => Some(true),
            _ => None,
        };
        let point = |pair: &Value| Some(DVec2::new(pair.get(0)?.as_f64()?, pair.get(1)?.as_f64()?));
        let counts = |pair: &Value| Some((count(pair.get(0)?)?, count(pair.get(1)?)?));
        Some(Self {
            condition: value["condition"].as_str()?.into(),
            method: Method::named(value["method"].as_str()?)?,
            known: count(&value["known"])?,
            shown: count(&value["shown"])?,
            right: value["right"].as_str()?.chars().map(judged).collect::<Option<_>>()?,
            pixels: count(&value["pixels"])?,
            everywhere: value["everywhere"].as_array()?.iter().map(counts).collect::<Option<_>>()?,
            seconds: value["seconds"].as_f64()?,
            points: value["points"].as_array()?.iter().map(point).collect::<Option<_>>()?,
        })
    }
}

/// The numbers of matches at which long curves are sampled: all up to 32, then in steps of a sixteenth of the number,
/// and the `last`.
pub fn steps(last: usize) -> Vec<usize> {
    let next = |&k: &usize| Some(k + (k / 16).max(1));
    let mut steps: Vec<usize> = std::iter::successors(Some(1), next).take_while(|&k| k < last).collect();
    steps.extend((last > 0).then_some(last));
    steps
}

/// Pairs of `k` and the number of right matches among the first `k`, at [`steps`].
fn counted(right: &[bool]) -> Vec<(usize, usize)> {
    let (mut done, mut count) = (0, 0);
    steps(right.len())
        .into_iter()
        .map(|k| {
            count += right[done..k].iter().filter(|&&right| right).count();
            done = k;
            (k, count)
        })
        .collect()
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::cli::eval::saved_results::Saveable as _;

    /// A record whose matches are right where `right` has a 1, with the same matches over the picture.
    pub fn record(condition: &str, method: Method, shown: usize, right: &str) -> Record {
        let right: Vec<bool> = right.chars().map(|digit| digit == '1').collect();
        Record {
            condition: condition.into(),
            method,
            points: vec![DVec2::new(1.5, 2.25)],
            known: 2 * shown,
            shown,
            pixels: 1000,
            everywhere: counted(&right),
            right,
            seconds: 0.5,
        }
    }

    #[test]
    fn answers_are_held_against_the_truth() {
        // Columns 0 and 1 leave the picture, and column 7 has no ground truth.
        let disparities = Plane::from_fn((8, 2), |x, _| if x == 7 { f32::INFINITY } else { 2.0 });
        let truth = Truth::stereo(disparities.clone(), None).unwrap();
        let points: Vec<_> = [1.0, 3.0, 4.0, 6.0, 7.0].map(|x| DVec2::new(x, 1.0)).into();
        let answer = |i: usize, off: f64, confidence| PointMatch {
            first: points[i],
            second: points[i] - DVec2::new(2.0 + off, 0.0),
            confidence,
            points: None,
        };
        let at_points = vec![answer(0, 0.0, 3.0), answer(1, 1.0, 1.0), answer(2, 1.5, 2.0), answer(4, 0.0, 9.0)];
        let answers = MethodMatches { points: points.clone(), everywhere: at_points[1..2].to_vec(), at_points };
        let record = Record::new(("none", Method::Balanced), answers, (&truth, &disparities), 1.0, 2.0).unwrap();
        // The match of the occluded point is the most confident one, and wrong.
        assert_eq!((record.known, record.shown, record.right), (4, 3, vec![false, false, true]));
        assert_eq!((record.pixels, record.everywhere, record.points), (14, vec![(1, 1)], vec![]));
    }

    #[test]
    fn json_and_back() {
        let record = record("blur=2", Method::Kamencay, 9, "1011");
        let json = record.to_json();
        assert_eq!(Record::from_json(&json), Some(record));
        for name in ["condition", "method", "known", "shown", "right", "pixels", "everywhere", "seconds", "points"] {
            let mut broken = json.clone();
            broken[name] = json!({});
            assert_eq!(Record::from_json(&broken), None, "{name}");
        }
    }

    #[test]
    fn steps_grow() {
        assert_eq!((steps(0), steps(1), steps(3)), (vec![], vec![1], vec![1, 2, 3]));
        let steps = steps(170_000);
        assert!(steps.len() < 200 && steps[..32].iter().copied().eq(1..=32) && steps[steps.len() - 1] == 170_000);
        assert_eq!(counted(&[true; 40]).last(), Some(&(40, 40)));
        let alternating: Vec<bool> = (0..100).map(|k| k % 2 == 0).collect();
        assert!(counted(&alternating).iter().all(|&(k, right)| right == k.div_ceil(2)));
    }
}
