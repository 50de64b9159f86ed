//! Normal equations, solved by Cholesky decomposition.

/// Solution of the first `free` of symmetric positive definite equations, given by their lower triangle; zeros for the other
/// unknowns. `None` if the equations are singular: if `least` or less of a diagonal element remains, as a share.
pub(crate) fn solved<const N: usize>(
    mut normal: [[f64; N]; N],
    mut right: [f64; N],
    free: usize,
    least: f64,
) -> Option<[f64; N]> {
    for i in 0..free {
        let whole = normal[i][i];
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| normal[i][k] * normal[j][k]).sum();
            let rest = normal[i][j] - known;
            if i != j {
                normal[i][j] = rest / normal[j][j];
            } else if rest > least * whole {
                normal[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    for i in 0..free {
        let known: f64 = (0..i).map(|k| normal[i][k] * right[k]).sum();
        right[i] = (right[i] - known) / normal[i][i];
    }
    for i in (0..free).rev() {
        let known: f64 = (i + 1..free).map(|k| normal[k][i] * right[k]).sum();
        right[i] = (right[i] - known) / normal[i][i];
    }
    right[free..].fill(0.0);
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved_by_hand() {
        // 4 a + 2 b = 2 and 2 a + 5 b = -3: a = 1, b = -1; a third unknown is not free.
        let mut normal = [[4.0, 0.0, 0.0], [2.0, 5.0, 0.0], [7.0, 7.0, 7.0]];
        let [a, b, rest] = solved(normal, [2.0, -3.0, 9.0], 2, 1e-10).unwrap();
        assert!((a - 1.0).abs() < 1e-12 && (b + 1.0).abs() < 1e-12, "{a} {b}");
        assert_eq!(rest, 0.0);
        normal[1][1] = 1.0;
        assert_eq!(solved(normal, [0.0; 3], 2, 1e-10), None, "2 a + b = 0 twice");
    }
}
