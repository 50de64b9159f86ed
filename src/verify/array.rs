//! What kernels are given and what they leave, and how far the results of two may be apart.

use std::f32::consts::TAU;

/// Values in a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Bytes.
    U8(Vec<u8>),
    /// Words.
    U32(Vec<u32>),
    /// Signed words.
    I32(Vec<i32>),
    /// Floats.
    F32(Vec<f32>),
}

impl Values {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The name of their type.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::U8(_) => "u8",
            Self::U32(_) => "u32",
            Self::I32(_) => "i32",
            Self::F32(_) => "f32",
        }
    }

    /// Their bytes, the lowest of each value first.
    pub fn to_le_bytes(&self) -> Vec<u8> {
        match self {
            Self::U8(values) => values.clone(),
            Self::U32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::I32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::F32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        }
    }

    /// A value, for people.
    fn text(&self, index: usize) -> String {
        match self {
            Self::U8(values) => values[index].to_string(),
            Self::U32(values) => values[index].to_string(),
            Self::I32(values) => values[index].to_string(),
            Self::F32(values) => values[index].to_string(),
        }
    }

    /// A value as a number that all of them fit in.
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

/// How far a device's values may be from the twin's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// Not at all: bit for bit the same.
    Exact,
    /// Floats.
    Within {
        /// The largest difference of two values.
        difference: f32,
        /// Whether they are angles: 0 to below 2 pi, where 0 is as near to the end as to the beginning.
        angles: bool,
        /// So many values in a row are one thing, which is off where any of them is.
        group: usize,
        /// Of a thousand things so many may be off, rounded up to whole ones.
        outliers: usize,
    },
}

impl Tolerance {
    /// The tolerance, for people.
    pub fn text(&self) -> String {
        match *self {
            Self::Exact => "exact".into(),
            Self::Within { difference, outliers: 0, .. } => format!("{difference}"),
            Self::Within { difference, outliers, .. } => format!("{difference}, but {outliers} of 1000"),
        }
    }

    fn group(&self) -> usize {
        match *self {
            Self::Exact => 1,
            Self::Within { group, .. } => group,
        }
    }

    /// How many things of `count` may be off.
    fn allowed(&self, count: usize) -> usize {
        match *self {
            Self::Exact => 0,
            Self::Within { outliers, .. } => (outliers * count).div_ceil(1000),
        }
    }
}

/// Named values.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// What they are.
    pub name: &'static str,
    /// The values.
    pub values: Values,
    /// How far a device's may be from the twin's.
    pub tolerance: Tolerance,
}

impl Array {
    /// Values of which every bit counts.
    pub fn exact(name: &'static str, values: impl Into<Values>) -> Self {
        Self { name, values: values.into(), tolerance: Tolerance::Exact }
    }
}

/// What came of a comparison of a device's values with the twin's.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What the values are.
    pub name: &'static str,
    /// How far they may be apart.
    pub tolerance: Tolerance,
    /// How many things were compared.
    pub count: usize,
    /// How many of them are further apart than that.
    pub off: usize,
    /// The largest difference of two values.
    pub largest: f64,
    /// What is wrong, for people; nothing where no more are off than may be.
    pub fault: Option<String>,
}

impl Comparison {
    /// Compares value by value.
    pub fn new(actual: &Array, expected: &Array) -> Self {
        let Array { name, tolerance, .. } = *expected;
        let mut comparison = Self { name, tolerance, count: 0, off: 0, largest: 0.0, fault: None };
        let (values, wanted) = (&actual.values, &expected.values);
        if (actual.name, values.kind(), values.len()) != (name, wanted.kind(), wanted.len()) {
            let of = |array: &Array| format!("{} {} {}", array.values.len(), array.name, array.values.kind());
            comparison.fault = Some(format!("there are {}, not {}", of(actual), of(expected)));
            return comparison;
        }
        let group = tolerance.group();
        let mut first = None;
        for start in (0..wanted.len()).step_by(group) {
            let mut off = None;
            for index in start..(start + group).min(wanted.len()) {
                let (difference, near) = compare(values, wanted, index, tolerance);
                // NaN is further away than any number, and stays.
                if difference.is_nan() || difference > comparison.largest {
                    comparison.largest = difference;
                }
                if !near {
                    off = off.or(Some(index));
                }
            }
            comparison.count += 1;
            comparison.off += usize::from(off.is_some());
            first = first.or(off);
        }
        if let (Some(index), true) = (first, comparison.off > tolerance.allowed(comparison.count)) {
            let (is, should, off) = (values.text(index), wanted.text(index), comparison.off);
            comparison.fault = Some(format!("{name}: value {index} is {is}, not {should}; {off} are off"));
        }
        comparison
    }
}

/// The difference of two values, and whether it is within `tolerance`.
fn compare(actual: &Values, expected: &Values, index: usize, tolerance: Tolerance) -> (f64, bool) {
    let (a, e) = (actual.number(index), expected.number(index));
    let difference = (a - e).abs();
    match tolerance {
        Tolerance::Exact => {
            let same = match (actual, expected) {
                (Values::F32(actual), Values::F32(expected)) => actual[index].to_bits() == expected[index].to_bits(),
                _ => a == e,
            };
            (difference, same)
        }
        Tolerance::Within { difference: limit, angles: false, .. } => (difference, difference <= limit.into()),
        Tolerance::Within { difference: limit, .. } => {
            let around = difference.min(f64::from(TAU) - difference);
            (around, (0.0..TAU.into()).contains(&a) && around <= limit.into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(actual: Array, expected: Array) -> Option<String> {
        Comparison::new(&actual, &expected).fault
    }

    fn floats(values: impl Into<Vec<f32>>, angles: bool, group: usize, outliers: usize) -> Array {
        let tolerance = Tolerance::Within { difference: 0.001, angles, group, outliers };
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
        let good = || floats([1.0, 2.0], false, 1, 0);
        assert_eq!(fault(floats([1.0009, 2.0], false, 1, 0), good()), None);
        for value in [1.002, -1.0, f32::NAN, f32::INFINITY] {
            let changed = Comparison::new(&floats([value, 2.0], false, 1, 0), &good());
            assert!(changed.fault.is_some() && (changed.largest > 0.001 || changed.largest.is_nan()), "{changed:?}");
        }
    }

    #[test]
    fn a_changed_angle_is_seen() {
        let angles = |values: [f32; 2]| floats(values, true, 1, 0);
        assert_eq!(fault(angles([1.0, 0.0]), angles([1.0, TAU - 1e-4])), None);
        for value in [1.002, TAU + 1.0, f32::NAN] {
            assert!(fault(angles([value, 0.0]), angles([1.0, 0.0])).is_some(), "{value}");
        }
    }

    #[test]
    fn more_than_may_be_off_are_seen() {
        let mut values = vec![1.0; 400];
        values[14] = 9.0;
        values[15] = 9.0;
        // Two values of one pair: one of 200 is allowed.
        assert_eq!(fault(floats(values.clone(), false, 2, 5), floats(vec![1.0; 400], false, 2, 5)), None);
        values[16] = 9.0;
        let expected = Some("floats: value 14 is 9, not 1; 2 are off");
        assert_eq!(fault(floats(values, false, 2, 5), floats(vec![1.0; 400], false, 2, 5)).as_deref(), expected);
    }
}
