//! Linear algebra in double precision: null spaces, eigenvalues and singular values of 3x3 matrices.

use glam::{DMat3, DQuat, DVec3};

/// A basis of the null space of `R` equations with `C` unknowns, `K = C - R` vectors, by elimination with full pivoting;
/// `None` if the equations depend on each other.
pub(super) fn null_space<const R: usize, const C: usize, const K: usize>(
    mut rows: [[f64; C]; R],
) -> Option<[[f64; C]; K]> {
    /// Smallest pivot, as a share of the first one.
    const LEAST: f64 = 1e-10;
    let mut order: [usize; C] = std::array::from_fn(|column| column);
    let mut first = 0.0;
    for done in 0..R {
        let places = (done..R).flat_map(|row| (done..C).map(move |column| (row, column)));
        let size = |&(row, column): &(usize, usize)| rows[row][order[column]].abs();
        let (row, column) = places.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        rows.swap(done, row);
        order.swap(done, column);
        let pivot = rows[done][order[done]];
        if done == 0 {
            first = pivot.abs();
        }
        if pivot.abs() <= LEAST * first || pivot.is_nan() {
            return None;
        }
        rows[done].iter_mut().for_each(|value| *value /= pivot);
        let own = rows[done];
        for (_, other) in rows.iter_mut().enumerate().filter(|(row, _)| *row != done) {
            let factor = other[order[done]];
            other.iter_mut().zip(own).for_each(|(value, own)| *value -= factor * own);
        }
    }
    Some(std::array::from_fn(|vector| {
        let free = order[R + vector];
        let mut basis = [0.0; C];
        basis[free] = 1.0;
        (0..R).for_each(|row| basis[order[row]] = -rows[row][free]);
        basis
    }))
}

/// Eigenvalues of a symmetric matrix, the largest first, and its eigenvectors as columns, a rotation (Jacobi's method).
pub(super) fn eigen(symmetric: DMat3) -> ([f64; 3], DMat3) {
    const SWEEPS: usize = 12;
    let (mut diagonal, mut vectors) = (symmetric, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = diagonal.col(q)[p];
            if off == 0.0 {
                continue;
            }
            let theta = (diagonal.col(q)[q] - diagonal.col(p)[p]) / (2.0 * off);
            let sign = if theta < 0.0 { -1.0 } else { 1.0 };
            let tangent = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sin = tangent * cos;
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = cos;
            turn.col_mut(q)[q] = cos;
            turn.col_mut(q)[p] = sin;
            turn.col_mut(p)[q] = -sin;
            diagonal = turn.transpose() * diagonal * turn;
            vectors *= turn;
        }
    }
    let values = [0, 1, 2].map(|i| diagonal.col(i)[i]);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let mut sorted = DMat3::from_cols(vectors.col(order[0]), vectors.col(order[1]), vectors.col(order[2]));
    if sorted.determinant() < 0.0 {
        sorted.z_axis = -sorted.z_axis;
    }
    (order.map(|i| values[i]), sorted)
}

/// Singular values of a matrix, `matrix = U diag(values) V'`, the largest first, with rotations `U` and `V`: the smallest
/// value is negative if the determinant is.
pub(super) fn singular(matrix: DMat3) -> (DMat3, [f64; 3], DMat3) {
    let (_, v) = eigen(matrix.transpose() * matrix);
    let images = [0, 1, 2].map(|i| matrix * v.col(i));
    let first = images[0].try_normalize().unwrap_or(DVec3::X);
    let second = (images[1] - first * first.dot(images[1])).try_normalize();
    let second = second.unwrap_or_else(|| first.any_orthonormal_vector());
    let u = DMat3::from_cols(first, second, first.cross(second));
    (u, [images[0].dot(u.x_axis), images[1].dot(u.y_axis), images[2].dot(u.z_axis)], v)
}

/// The rotation about the direction of `turn` by its length in radians.
pub(super) fn rotation(turn: DVec3) -> DMat3 {
    DMat3::from_quat(DQuat::from_scaled_axis(turn))
}

/// The matrix of the cross product with `vector`.
pub(super) fn cross(vector: DVec3) -> DMat3 {
    let DVec3 { x, y, z } = vector;
    DMat3::from_cols(DVec3::new(0.0, z, -y), DVec3::new(-z, 0.0, x), DVec3::new(y, -x, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATRIX: DMat3 = DMat3::from_cols_array(&[2.0, -1.0, 0.5, 0.3, 1.7, 4.0, -2.2, 0.1, 0.9]);

    #[test]
    fn a_null_space_solves_its_equations() {
        let rows = [[1.0, 2.0, 3.0, 4.0], [2.0, 4.0, -1.0, 0.5]];
        let basis: [[f64; 4]; 2] = null_space(rows).unwrap();
        for vector in basis {
            for row in rows {
                assert!(row.iter().zip(vector).map(|(a, b)| a * b).sum::<f64>().abs() < 1e-12);
            }
        }
        assert!(basis[0] != basis[1]);
        assert_eq!(null_space::<2, 3, 1>([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]]), None);
    }

    #[test]
    fn eigenvectors_and_singular_vectors_rebuild_their_matrix() {
        let symmetric = MATRIX + MATRIX.transpose();
        let (values, vectors) = eigen(symmetric);
        let rebuilt = vectors * DMat3::from_diagonal(values.into()) * vectors.transpose();
        assert!(rebuilt.abs_diff_eq(symmetric, 1e-10) && values.is_sorted_by(|a, b| a >= b));
        for matrix in [MATRIX, -MATRIX, DMat3::from_diagonal(DVec3::new(0.0, 3.0, -1.0))] {
            let (u, values, v) = singular(matrix);
            assert!((u * DMat3::from_diagonal(values.into()) * v.transpose()).abs_diff_eq(matrix, 1e-7), "{values:?}");
            assert!((u.determinant() - 1.0).abs() < 1e-9 && (v.determinant() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_cross_product_is_a_matrix() {
        let (a, b) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 2.0));
        assert_eq!(cross(a) * b, a.cross(b));
    }
}
