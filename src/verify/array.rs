//! Inputs and outputs of kernels, and tolerances of their comparison.

use std::{f32::consts::TAU, ops::Range};

/// A sequence of values of one type.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Bytes.
    U8(Vec<u8>),
    /// `u32`s.
    U32(Vec<u32>),
    /// `i32`s.
    I32(Vec<i32>),
    /// `f32`s.
    F32(Vec<f32>),
}

impl Values {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Name of the type of the values.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::U8(_) => "u8",
            Self::U32(_) => "u32",
            Self::I32(_) => "i32",
            Self::F32(_) => "f32",
        }
    }

    /// The bytes of all values, little-endian.
    pub fn to_le_bytes(&self) -> Vec<u8> {
        match self {
            Self::U8(values) => values.clone(),
            Self::U32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::I32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::F32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        }
    }

    /// A value as text.
    fn text(&self, index: usize) -> String {
        match self {
            Self::U8(values) => values[index].to_string(),
            Self::U32(values) => values[index].to_string(),
            Self::I32(values) => values[index].to_string(),
            Self::F32(values) => values[index].to_string(),
        }
    }

    /// A value as `f64`, exact for all types.
    fn number(&self, index: usize) -> f64 {
        match self {
            Self::U8(values) => values[index].into(),
            Self::U32(values) => values[index].into(),
            Self::I32(values) => values[index].into(),
            Self::F32(values) => values[index].into(),
        }
    }
}

impl From<Vec<u8>> for Values {
    fn from(values: Vec<u8>) -> Self {
        Self::U8(values)
    }
}

impl From<Vec<u32>> for Values {
    fn from(values: Vec<u32>) -> Self {
        Self::U32(values)
    }
}

impl From<Vec<i32>> for Values {
    fn from(values: Vec<i32>) -> Self {
        Self::I32(values)
    }
}

impl From<Vec<f32>> for Values {
    fn from(values: Vec<f32>) -> Self {
        Self::F32(values)
    }
}

/// The accepted difference of a device's values from the twin's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// No difference: bit for bit the same.
    Exact,
    /// `f32`s.
    Within {
        /// The largest difference of two values.
        difference: f32,
        /// Whether the values are angles, 0 to below 2 pi, whose differences wrap around.
        angles: bool,
        /// Values per group; a group is off if any of its values is.
        group: usize,
        /// For groups that are vectors: the largest difference of their length from the twin's, also for outliers.
        length: Option<f32>,
        /// Groups that may be off nevertheless.
        outliers: Option<Outliers>,
    },
}

/// A few groups that may be further off, where a last digit decides between two valid results. They excuse no invalid
/// result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outliers {
    /// Accepted outliers per thousand groups, rounded down: with 5, none is accepted among fewer than 200 groups.
    pub of_thousand: usize,
    /// The largest difference of a value in an outlier.
    pub difference: f32,
}

impl Tolerance {
    /// The tolerance as text.
    pub fn text(&self) -> String {
        match *self {
            Self::Exact => "exact".into(),
            Self::Within { difference, outliers: None, .. } => format!("{difference}"),
            Self::Within { difference, outliers: Some(Outliers { of_thousand, difference: most, .. }), .. } => {
                format!("{difference}, {of_thousand} of 1000 to {most:.2}")
            }
        }
    }

    fn group(&self) -> usize {
        match *self {
            Self::Exact => 1,
            Self::Within { group, .. } => group,
        }
    }

    /// Number of groups of `count` that may be off.
    fn allowed(&self, count: usize) -> usize {
        match *self {
            Self::Exact | Self::Within { outliers: None, .. } => 0,
            Self::Within { outliers: Some(outliers), .. } => outliers.of_thousand * count / 1000,
        }
    }
}

/// Named values with a tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Name of the values.
    pub name: &'static str,
    /// The values.
    pub values: Values,
    /// Tolerance of a device's values.
    pub tolerance: Tolerance,
}

impl Array {
    /// Values that must be bit for bit the same.
    pub fn exact(name: &'static str, values: impl Into<Values>) -> Self {
        Self { name, values: values.into(), tolerance: Tolerance::Exact }
    }
}

/// The result of a comparison of a device's values with the twin's.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Name of the values.
    pub name: &'static str,
    /// Tolerance of the comparison.
    pub tolerance: Tolerance,
    /// Number of groups compared.
    pub count: usize,
    /// Number of groups beyond the tolerance.
    pub off: usize,
    /// The largest difference of two values.
    pub largest: f64,
    /// Description of the fault; `None` if no more groups are off than accepted.
    pub fault: Option<String>,
}

impl Comparison {
    /// Compares value by value.
    pub fn new(actual: &Array, expected: &Array) -> Self {
        let Array { name, tolerance, .. } = *expected;
        let mut comparison = Self { name, tolerance, count: 0, off: 0, largest: 0.0, fault: None };
        let (actual_values, expected_values) = (&actual.values, &expected.values);
        if (actual.name, actual_values.kind(), actual_values.len())
            != (name, expected_values.kind(), expected_values.len())
        {
            let of = |array: &Array| format!("{} {} {}", array.values.len(), array.name, array.values.kind());
            comparison.fault = Some(format!("there are {}, not {}", of(actual), of(expected)));
            return comparison;
        }
        let group = tolerance.group();
        let (mut first, mut first_beyond) = (None, None);
        for start in (0..expected_values.len()).step_by(group) {
            let indices = start..(start + group).min(expected_values.len());
            let mut off = None;
            // The value that is off by more than an outlier may be.
            let mut beyond = None;
            for index in indices.clone() {
                let (difference, near) = compare(actual_values, expected_values, index, tolerance);
                // NaN exceeds any number, and no later value replaces it.
                if difference.is_nan() || difference > comparison.largest {
                    comparison.largest = difference;
                }
                if near != Near::Enough {
                    off = off.or(Some(index));
                }
                if near == Near::No {
                    beyond = beyond.or(Some(index));
                }
            }
            if !length_kept(actual_values, expected_values, indices, tolerance) {
                off = off.or(Some(start));
                beyond = beyond.or(off);
            }
            comparison.count += 1;
            comparison.off += usize::from(off.is_some());
            first = first.or(off);
            first_beyond = first_beyond.or(beyond);
        }
        let too_many = first.filter(|_| comparison.off > tolerance.allowed(comparison.count));
        if let Some(index) = first_beyond.or(too_many) {
            let (is, should, off) = (actual_values.text(index), expected_values.text(index), comparison.off);
            comparison.fault = Some(format!("{name}: value {index} is {is}, not {should}; {off} are off"));
        }
        comparison
    }
}

/// The judgement of a value.
#[derive(Clone, Copy, PartialEq)]
enum Near {
    /// Equal, or within the tolerance.
    Enough,
    /// Off by no more than an outlier may be.
    AnOutlier,
    /// Beyond both.
    No,
}

/// The difference of two values, and its judgement by `tolerance`.
fn compare(actual: &Values, expected: &Values, index: usize, tolerance: Tolerance) -> (f64, Near) {
    let (a, e) = (actual.number(index), expected.number(index));
    let difference = (a - e).abs();
    let Tolerance::Within { difference: limit, angles, outliers, .. } = tolerance else {
        let same = match (actual, expected) {
            (Values::F32(actual), Values::F32(expected)) => actual[index].to_bits() == expected[index].to_bits(),
            _ => a == e,
        };
        return (difference, if same { Near::Enough } else { Near::No });
    };
    let difference = if angles { difference.min(f64::from(TAU) - difference) } else { difference };
    let in_range = !angles || (0.0..TAU.into()).contains(&a);
    // Every comparison with NaN is false, and infinity is within no limit.
    let within = |limit: f32| in_range && difference <= limit.into();
    let near = match outliers {
        _ if within(limit) => Near::Enough,
        Some(outliers) if within(outliers.difference) => Near::AnOutlier,
        _ => Near::No,
    };
    (difference, near)
}

/// Whether a group has the right length as a vector, where the tolerance limits that.
fn length_kept(actual: &Values, expected: &Values, group: Range<usize>, tolerance: Tolerance) -> bool {
    let Tolerance::Within { length: Some(limit), .. } = tolerance else {
        return true;
    };
    let length = |values: &Values| group.clone().map(|index| values.number(index).powi(2)).sum::<f64>().sqrt();
    (length(actual) - length(expected)).abs() <= limit.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(actual: Array, expected: Array) -> Option<String> {
        Comparison::new(&actual, &expected).fault
    }

    fn floats(values: impl Into<Vec<f32>>, angles: bool) -> Array {
        let tolerance = Tolerance::Within { difference: 0.001, angles, group: 1, length: None, outliers: None };
        Array { name: "floats", values: values.into().into(), tolerance }
    }

    #[test]
    fn a_changed_element_is_seen() {
        let words = |values: &[u32]| Array::exact("words", values.to_vec());
        assert_eq!(fault(words(&[1, 2, 3]), words(&[1, 2, 3])), None);
        assert_eq!(
            fault(words(&[1, 2, 4]), words(&[1, 2, 3])).as_deref(),
            Some("words: value 2 is 4, not 3; 1 are off")
        );
        let comparison = Comparison::new(&words(&[9, 2, u32::MAX]), &words(&[1, 2, 3]));
        assert_eq!((comparison.off, comparison.count, comparison.largest), (2, 3, f64::from(u32::MAX - 3)));
    }

    #[test]
    fn a_missing_element_and_another_type_are_seen() {
        let two = Array::exact("words", vec![1_u32, 2]);
        assert!(fault(two.clone(), Array::exact("words", vec![1_u32, 2, 3])).is_some());
        assert!(fault(two.clone(), Array::exact("words", vec![1_i32, 2])).is_some());
        assert!(fault(two, Array::exact("bytes", vec![1_u32, 2])).is_some());
    }

    #[test]
    fn a_float_with_another_bit_is_not_exact() {
        let zeros = [0.0_f32, -0.0].map(|zero| Array::exact("zero", vec![zero]));
        assert!(fault(zeros[0].clone(), zeros[1].clone()).is_some());
    }

    #[test]
    fn a_changed_float_is_seen() {
        let good = || floats([1.0, 2.0], false);
        assert_eq!(fault(floats([1.0009, 2.0], false), good()), None);
        for value in [1.002, -1.0, f32::NAN, f32::INFINITY] {
            let changed = Comparison::new(&floats([value, 2.0], false), &good());
            assert!(changed.fault.is_some() && (changed.largest > 0.001 || changed.largest.is_nan()), "{changed:?}");
        }
    }

    #[test]
    fn a_changed_angle_is_seen() {
        let angles = |values: [f32; 2]| floats(values, true);
        assert_eq!(fault(angles([1.0, 0.0]), angles([1.0, TAU - 1e-4])), None);
        for value in [1.002, TAU + 1.0, f32::NAN] {
            assert!(fault(angles([value, 0.0]), angles([1.0, 0.0])).is_some(), "{value}");
        }
    }

    /// Vectors of length 1 along the first of their two axes, the first vectors turned; one of 200 may be off.
    fn vectors(count: usize, turned: &[f32]) -> Array {
        let outliers = Some(Outliers { of_thousand: 5, difference: 0.5 });
        let tolerance = Tolerance::Within { difference: 0.001, angles: false, group: 2, length: Some(1e-4), outliers };
        let angle = |index| turned.get(index).copied().unwrap_or(0.0);
        let values: Vec<f32> = (0..count).flat_map(|index| [angle(index).cos(), angle(index).sin()]).collect();
        Array { name: "vectors", values: values.into(), tolerance }
    }

    #[test]
    fn more_than_may_be_off_are_seen() {
        assert_eq!(fault(vectors(200, &[0.3]), vectors(200, &[])), None);
        let expected = "vectors: value 0 is 0.9553365, not 1; 2 are off";
        assert_eq!(fault(vectors(200, &[0.3, 0.3]), vectors(200, &[])).as_deref(), Some(expected));
        assert_eq!(fault(vectors(400, &[0.3, 0.3]), vectors(400, &[])), None);
        // The number of accepted outliers is rounded down.
        assert!(fault(vectors(199, &[0.3]), vectors(199, &[])).is_some());
        assert!(fault(vectors(1, &[0.3]), vectors(1, &[])).is_some());
    }

    #[test]
    fn what_is_no_outlier_but_garbage_is_seen() {
        let good = vectors(1000, &[]);
        for garbage in [[f32::NAN, 0.0], [f32::INFINITY, 0.0], [1.0, f32::NAN], [0.4, 0.917], [0.9, 0.0], [0.9995, 0.0]]
        {
            let mut changed = good.clone();
            let Values::F32(values) = &mut changed.values else { unreachable!("they are floats") };
            values[40..42].copy_from_slice(&garbage);
            let comparison = Comparison::new(&changed, &good);
            let value = if garbage[0] == 1.0 { "value 41 is NaN, not 0" } else { "value 40 is" };
            assert!(comparison.fault.is_some_and(|fault| fault.contains(value)), "{garbage:?}");
            assert_eq!(comparison.off, 1);
        }
    }
}
