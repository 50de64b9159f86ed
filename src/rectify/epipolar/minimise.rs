//! Robust least squares with a few parameters.

use crate::rectify::cholesky::solved;

/// Smallest share of a diagonal element of normal equations that has to remain.
pub(super) const SINGULAR: f64 = 1e-13;
/// Largest number of steps.
const STEPS: usize = 60;
/// Steps end when the cost falls by a smaller share.
const SETTLED: f64 = 1e-9;
/// Number of factors per logarithm: for errors up to 1e19.
const FACTORS: usize = 8;
/// Step of numeric derivatives, in units of the parameters, which are of the order of 1.
const DELTA: f64 = 1e-6;

/// Parameters, and their cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Minimum<const N: usize> {
    pub parameters: [f64; N],
    pub cost: f64,
}

/// The errors of a model: the cost is the sum of `ln(1 + e^2)` over the robust ones and of `e^2` over the others.
#[derive(Default)]
pub(super) struct Errors {
    pub robust: Vec<f64>,
    pub plain: Vec<f64>,
}

impl Errors {
    fn cost(&self) -> f64 {
        sum_of_logarithms(self.robust.iter().copied()) + self.plain.iter().map(|error| error * error).sum::<f64>()
    }

    /// All errors, the robust ones first.
    fn all(&self) -> impl Iterator<Item = f64> {
        self.robust.iter().chain(&self.plain).copied()
    }
}

/// The sum of `ln(1 + e^2)` over all `errors`: a logarithm per [`FACTORS`] of them, whose product stays below 1e308.
pub(super) fn sum_of_logarithms(errors: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut product, mut count) = (0.0, 1.0, 0);
    for error in errors {
        product *= 1.0 + error * error;
        count += 1;
        if count == FACTORS {
            sum += libm::log(product);
            (product, count) = (1.0, 0);
        }
    }
    sum + libm::log(product)
}

/// The parameters of least cost around `start`: Levenberg-Marquardt steps with Cauchy weights for the robust errors (Huber,
/// Robust Statistics, 1981) and numeric derivatives. `errors` puts as many errors into the lists for all parameters.
pub(super) fn minimise<const N: usize>(start: [f64; N], errors: impl Fn(&[f64; N], &mut Errors)) -> Minimum<N> {
    let (mut here, mut there) = (Errors::default(), Errors::default());
    let evaluated = |parameters: &[f64; N], list: &mut Errors| {
        list.robust.clear();
        list.plain.clear();
        errors(parameters, list);
        list.cost()
    };
    let mut best = Minimum { parameters: start, cost: evaluated(&start, &mut here) };
    let mut damping = 1e-3;
    let mut slopes: Vec<[f64; N]> = Vec::new();
    for _ in 0..STEPS {
        slopes.clear();
        slopes.resize(here.robust.len() + here.plain.len(), [0.0; N]);
        for i in 0..N {
            let mut moved = best.parameters;
            moved[i] += DELTA;
            evaluated(&moved, &mut there);
            for (slope, (from, to)) in slopes.iter_mut().zip(here.all().zip(there.all())) {
                slope[i] = (to - from) / DELTA;
            }
        }
        let (mut normal, mut moment) = ([[0.0; N]; N], [0.0; N]);
        for (index, (error, slope)) in here.all().zip(&slopes).enumerate() {
            let weight = if index < here.robust.len() { 1.0 / (1.0 + error * error) } else { 1.0 };
            for i in 0..N {
                moment[i] -= weight * slope[i] * error;
                for j in 0..=i {
                    normal[i][j] += weight * slope[i] * slope[j];
                }
            }
        }
        let before = best.cost;
        while damping < 1e9 {
            let mut damped = normal;
            (0..N).for_each(|i| damped[i][i] += damping * (normal[i][i] + 1e-12));
            let Some(step) = solved(damped, moment, N, SINGULAR) else {
                damping *= 10.0;
                continue;
            };
            let moved = std::array::from_fn(|i| best.parameters[i] + step[i]);
            let cost = evaluated(&moved, &mut there);
            if cost < best.cost {
                best = Minimum { parameters: moved, cost };
                std::mem::swap(&mut here, &mut there);
                damping = (0.2 * damping).max(1e-12);
                break;
            }
            damping *= 5.0;
        }
        if best.cost >= before * (1.0 - SETTLED) || best.cost.is_nan() {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_found_despite_outliers() {
        // y = 2 exp(-0.7 x) at 40 places, every fifth one wrong.
        let points: Vec<(f64, f64)> = (0..40)
            .map(|i| {
                let x = f64::from(i) / 10.0;
                (x, 2.0 * (-0.7 * x).exp() + if i % 5 == 0 { 3.0 } else { 0.0 })
            })
            .collect();
        let found = minimise([1.0, 0.0], |&[a, b], errors| {
            errors.robust.extend(points.iter().map(|(x, y)| (a * (b * x).exp() - y) / 0.01));
        });
        let [a, b] = found.parameters;
        assert!((a - 2.0).abs() < 1e-3 && (b + 0.7).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn plain_errors_pull_in_proportion() {
        // The least of (a - 1)^2 + (2 (a - 4))^2 is at (1 + 16) / 5.
        let found = minimise([0.0], |&[a], errors| errors.plain.extend([a - 1.0, 2.0 * (a - 4.0)]));
        assert!((found.parameters[0] - 3.4).abs() < 1e-6 && (found.cost - 7.2).abs() < 1e-6, "{found:?}");
    }
}
