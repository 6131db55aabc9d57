//! Eigenvalues and eigenvectors of a symmetric matrix.

use glam::{DMat3, DVec3};

/// Eigenvalues of a symmetric matrix from the smallest to the largest, and unit eigenvectors in that order, by Jacobi's
/// rotations.
pub(super) fn symmetric_eigen(matrix: &DMat3) -> ([f64; 3], [DVec3; 3]) {
    let mut m = *matrix;
    let mut axes = DMat3::IDENTITY;
    // Each sweep squares what is left beside the diagonal: six are more than f64 holds.
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let beside = m.col(q)[p];
            if beside == 0.0 {
                continue;
            }
            let theta = 0.5 * (m.col(q)[q] - m.col(p)[p]) / beside;
            let tangent = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            let mut rotation = DMat3::IDENTITY;
            rotation.col_mut(p)[p] = cosine;
            rotation.col_mut(q)[q] = cosine;
            rotation.col_mut(q)[p] = tangent * cosine;
            rotation.col_mut(p)[q] = -tangent * cosine;
            m = rotation.transpose() * m * rotation;
            axes *= rotation;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| m.col(*a)[*a].total_cmp(&m.col(*b)[*b]));
    (order.map(|i| m.col(i)[i]), order.map(|i| axes.col(i)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_and_values_make_up_the_matrix() {
        for (a, b, c) in [(1.0, 2.0, 3.0), (1e-9, 1.0, 1e3), (2.0, 2.0, 2.0), (0.0, 0.0, 1.0)] {
            let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
            let matrix = turn * DMat3::from_diagonal(DVec3::new(b, a, c)) * turn.transpose();
            let (values, axes) = symmetric_eigen(&matrix);
            assert!(values.is_sorted());
            for (value, axis) in values.into_iter().zip(axes) {
                assert!((matrix * axis - value * axis).length() < 1e-12 * c.max(1.0), "{value} {axis}");
                assert!((axis.length() - 1.0).abs() < 1e-12);
            }
        }
    }
}
