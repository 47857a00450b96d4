//! Exact one-dimensional Gram matrices: the factors of the regularisation integral, paper 000 (7).
//!
//! The paper samples that integral at control points, (8). On uniform cubics this loses definiteness: the tensor k (x) k (x) k with
//! k_i = (sqrt(3) - 2)^i has a Hessian that vanishes at every knot, so it has no sampled energy. The integral itself costs no more, since
//! it is a sum of Kronecker products of the banded matrices made here.

use super::basis::{Weights, second};
use crate::Result;
use crate::error::try_vec;

/// Off-diagonals on each side of the diagonal.
pub const HALF_BAND: usize = 3;

/// A symmetric banded matrix by rows: entry (i, i + d - 3) at `rows[i][d]`, 0 where the column does not exist.
pub type Band = Vec<[f64; 2 * HALF_BAND + 1]>;

/// The Gram matrices of the values, first and second derivatives of the basis along one axis.
#[derive(Debug, Clone)]
pub struct Gram {
    /// `order[k]`: integrals of B_i^(k) B_j^(k), derivatives and integral with respect to x.
    pub order: [Band; 3],
}

impl Gram {
    /// Integrals over `n_cells` cells of edge `cell` of the n_cells + 3 functions of the cells.
    pub fn new(n_cells: usize, cell: f64) -> Result<Self> {
        let band = || try_vec(n_cells + 3, [0.0; 2 * HALF_BAND + 1], "the Gram matrices");
        let mut order: [Band; 3] = [band()?, band()?, band()?];
        for i in 0..n_cells {
            for (u, weight) in GAUSS {
                let Weights { w, dw } = Weights::at(u);
                for (k, b) in [w, dw, second(u)].iter().enumerate() {
                    // d/dx = (1 / h) d/dxi, dx = h dxi
                    let scale = weight * cell.powi(1 - 2 * k as i32);
                    for p in 0..4 {
                        for q in 0..4 {
                            order[k][i + p][q + HALF_BAND - p] += scale * b[p] * b[q];
                        }
                    }
                }
            }
        }
        Ok(Gram { order })
    }

    /// The matrices of the axis that the plane lacks: one function, 1, and an integral of 1.
    pub fn of_no_axis() -> Self {
        let mut one = [0.0; 2 * HALF_BAND + 1];
        let zero = vec![one];
        one[HALF_BAND] = 1.0;
        Gram { order: [vec![one], zero.clone(), zero] }
    }
}

/// The matrix of sums over some places along an axis of `n_control` control points: sum of w w^T, w the weights of the four functions from
/// `cell` on.
pub fn band_of_places(n_control: usize, places: impl Iterator<Item = (usize, [f64; 4])>) -> Result<Band> {
    let mut band = try_vec(n_control, [0.0; 2 * HALF_BAND + 1], "the Gram matrices")?;
    for (cell, w) in places {
        for p in 0..4 {
            (0..4).for_each(|q| band[cell + p][q + HALF_BAND - p] += w[p] * w[q]);
        }
    }
    Ok(band)
}

/// Gauss-Legendre points and weights on [0, 1]: exact to degree 7, one more than products of cubics have.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Columns of row `i` of an n x n band.
pub fn columns(i: usize, n: usize) -> std::ops::Range<usize> {
    i.saturating_sub(HALF_BAND)..(i + HALF_BAND + 1).min(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sum_j a_ij x_j for row `i`.
    fn row_dot(band: &Band, i: usize, x: &[f64]) -> f64 {
        columns(i, x.len()).map(|j| band[i][j + HALF_BAND - i] * x[j]).sum()
    }

    fn quadratic_form(band: &Band, x: &[f64]) -> f64 {
        (0..x.len()).map(|i| x[i] * row_dot(band, i, x)).sum()
    }

    #[test]
    fn interior_rows_are_the_known_integrals() {
        let gram = Gram::new(9, 1.0).unwrap();
        let known = [[1.0, 120.0, 1191.0, 2416.0].map(|x| x / 5040.0), [-1.0, -24.0, -15.0, 80.0].map(|x| x / 120.0)];
        for (band, row) in gram.order.iter().zip(known) {
            for d in 0..=3 {
                assert!((band[5][d] - row[d]).abs() < 1e-15);
                assert!((band[5][6 - d] - row[d]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn integrates_polynomials_exactly() {
        // Control points (i - 1) reproduce f(xi) = xi on n cells; so int f^2 = n^3 / 3, int f'^2 = n, int f''^2 = 0.
        for (n, cell) in [(1, 1.0), (2, 0.5), (5, 2.0), (7, 0.1)] {
            let gram = Gram::new(n, cell).unwrap();
            let extent = n as f64;
            let x: Vec<f64> = (0..n + 3).map(|i| i as f64 - 1.0).collect();
            let expected = [extent.powi(3) / 3.0 * cell, extent / cell, 0.0];
            for (k, e) in expected.into_iter().enumerate() {
                let got = quadratic_form(&gram.order[k], &x);
                assert!((got - e).abs() < 1e-12 * (1.0 + e) * cell.powi(-4).max(1.0), "order {k}: {got} for {e}");
            }
        }
    }

    #[test]
    fn the_mode_without_sampled_energy_has_energy_here() {
        let n = 12;
        let gram = Gram::new(n, 1.0).unwrap();
        let k: Vec<f64> = (0..n as i32 + 3).map(|i| (3f64.sqrt() - 2.0).powi(i)).collect();
        for i in 0..n {
            let knot_value: f64 = (0..4).map(|a| Weights::at(0.0).w[a] * k[i + a]).sum();
            assert!(knot_value.abs() < 1e-14, "the mode vanishes at knot {i}");
        }
        assert!(quadratic_form(&gram.order[0], &k) > 1e-3);
        assert!(quadratic_form(&gram.order[2], &k) > 1e-3);
    }
}
