//! Arithmetic of small square matrices, and affine maps.

use super::vec::{add, dot};

/// Rows of a square matrix.
pub type Matrix<const D: usize> = [[f64; D]; D];

/// The matrix of `entry`(row, column).
pub fn matrix<const D: usize>(entry: impl Fn(usize, usize) -> f64) -> Matrix<D> {
    std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b)))
}

/// s I
pub fn diagonal<const D: usize>(s: f64) -> Matrix<D> {
    matrix(|a, b| if a == b { s } else { 0.0 })
}

/// A B
pub fn product<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> Matrix<D> {
    matrix(|i, j| (0..D).map(|k| a[i][k] * b[k][j]).sum())
}

/// A v
pub fn applied<const D: usize>(a: &Matrix<D>, v: [f64; D]) -> [f64; D] {
    a.map(|row| dot(row, v))
}

/// A^T v
pub fn applied_transposed<const D: usize>(a: &Matrix<D>, v: [f64; D]) -> [f64; D] {
    std::array::from_fn(|j| (0..D).map(|i| a[i][j] * v[i]).sum())
}

/// A^T
pub fn transposed<const D: usize>(a: &Matrix<D>) -> Matrix<D> {
    matrix(|i, j| a[j][i])
}

/// s A
pub fn scaled<const D: usize>(s: f64, a: &Matrix<D>) -> Matrix<D> {
    matrix(|i, j| s * a[i][j])
}

/// z = linear p + shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<const D: usize> {
    pub linear: Matrix<D>,
    pub shift: [f64; D],
}

impl<const D: usize> Affine<D> {
    /// The map to 0, and the sum of nothing.
    pub const ZERO: Self = Affine { linear: [[0.0; D]; D], shift: [0.0; D] };

    /// What it makes of `p`.
    pub fn apply(&self, p: [f64; D]) -> [f64; D] {
        add(applied(&self.linear, p), self.shift)
    }

    /// Sum of products entry by entry.
    pub fn inner(&self, other: &Self) -> f64 {
        let linear: f64 = (0..D).map(|a| dot(self.linear[a], other.linear[a])).sum();
        linear + dot(self.shift, other.shift)
    }

    /// Row `a` with its shift behind it.
    pub fn row(&self, a: usize) -> [f64; 4] {
        let mut row = [0.0; 4];
        row[..D].copy_from_slice(&self.linear[a]);
        row[D] = self.shift[a];
        row
    }

    /// Of such rows.
    pub fn of_rows(rows: &[[f64; 4]; D]) -> Self {
        Affine { linear: matrix(|a, b| rows[a][b]), shift: std::array::from_fn(|a| rows[a][D]) }
    }
}
