//! Where a curve stops to rise, and its inverse up to there.

/// Halvings of a bracket by [`root_between`]: a double has no more digits.
const BISECTIONS: u32 = 120;
/// Halvings by [`inverse`] before Newton's method takes over.
const COARSE_BISECTIONS: u32 = 12;
const NEWTON_STEPS: u32 = 20;

/// The least root of the polynomial `c[0] + c[1] x + c[2] x^2 + ...` in `0 < x < end`, for `c[0] > 0`; `end` if there is none.
///
/// Between neighbouring roots of its derivative a polynomial is monotone and has at most one root.
pub(super) fn first_root(coefficients: &[f64], end: f64) -> f64 {
    roots(coefficients, end).first().copied().unwrap_or(end)
}

/// All roots in `0 < x < end` where the sign changes, in ascending order.
fn roots(coefficients: &[f64], end: f64) -> Vec<f64> {
    let Some((_, rest)) = coefficients.split_first().filter(|(_, rest)| !rest.is_empty()) else { return Vec::new() };
    let derivative: Vec<f64> = (1..).zip(rest).map(|(power, c)| f64::from(power) * c).collect();
    let mut bounds = roots(&derivative, end);
    bounds.insert(0, 0.0);
    bounds.push(end);
    let value = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    bounds.windows(2).filter_map(|ends| root_between(value, ends[0], ends[1])).collect()
}

/// The root of `f`, monotone between `low` and `high`, if the sign changes there.
fn root_between(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> Option<f64> {
    let rises = f(low) <= 0.0;
    if rises == (f(high) <= 0.0) {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if (f(middle) <= 0.0) == rises {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}

/// The `x` in `0 <= x <= end` with `f(x) = target`, for `f` that rises from `f(0) = 0`; `f` returns value and slope. `None`
/// if `target` is above `f(end)`.
pub(super) fn inverse(f: impl Fn(f64) -> (f64, f64), target: f64, end: f64) -> Option<f64> {
    // Most curves stay near the identity, where a bracket of twice the target is tight; `end` can be far away.
    let mut high = (2.0 * target).min(end);
    let mut low = 0.0;
    while f(high).0 < target {
        if high >= end {
            return None;
        }
        low = high;
        high = (2.0 * high).min(end);
    }
    for _ in 0..COARSE_BISECTIONS {
        let middle = 0.5 * (low + high);
        if f(middle).0 < target { low = middle } else { high = middle }
    }
    let mut x = 0.5 * (low + high);
    for _ in 0..NEWTON_STEPS {
        let (value, slope) = f(x);
        if value < target {
            low = x
        } else {
            high = x
        }
        let next = x - (value - target) / slope;
        // A step out of the bracket, or one that is not a number, halves the bracket instead.
        let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
        if (next - x).abs() <= 4.0 * f64::EPSILON * x {
            return Some(next);
        }
        x = next;
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_positive_root_by_hand() {
        // (1 - x)(2 - x)(3 - x)
        assert!((first_root(&[6.0, -11.0, 6.0, -1.0], 10.0) - 1.0).abs() < 1e-12);
        assert_eq!(first_root(&[6.0, -11.0, 6.0, -1.0], 0.5), 0.5);
        // No real root.
        assert_eq!(first_root(&[1.0, 0.0, 1.0], 1e6), 1e6);
        // A root beyond a dip that does not reach 0: (x^2 - 2x + 1.01)(1 - x/5)
        assert!((first_root(&[1.01, -2.202, 1.4, -0.2], 1e6) - 5.0).abs() < 1e-9);
        assert_eq!(first_root(&[1.0], 7.0), 7.0);
    }

    #[test]
    fn an_inverse_is_found_up_to_the_end_and_not_beyond() {
        let cubic = |x: f64| (x - 0.1 * x * x * x, 1.0 - 0.3 * x * x);
        let end = (1.0_f64 / 0.3).sqrt();
        for x in [0.0, 1e-9, 0.3, 1.0, 1.8, end] {
            let found = inverse(cubic, cubic(x).0, end).unwrap();
            // The slope is 0 at the end: half of the digits are lost there.
            assert!((found - x).abs() <= if x < end { 1e-14 } else { 1e-7 }, "{x}: {found}");
        }
        assert_eq!(inverse(cubic, 1.01 * cubic(end).0, end), None);
    }
}
