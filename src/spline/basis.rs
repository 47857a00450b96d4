//! The four cubic B-splines that live on a cell.

use crate::isa::Isa;

/// Values and derivatives, with respect to the coordinate in cells, of the four basis functions of a cell at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// B_i(u)
    pub w: [f64; 4],
    /// B_i'(u)
    pub dw: [f64; 4],
}

impl Weights {
    /// Weights at `u` in the cell; outside [0, 1] they continue the cell's polynomial.
    #[inline(always)]
    pub fn at(u: f64) -> Self {
        const SIXTH: f64 = 1.0 / 6.0;
        let v = 1.0 - u;
        let (uu, vv) = (u * u, v * v);
        Weights {
            w: [
                SIXTH * vv * v,
                SIXTH * (4.0 - 3.0 * uu * (2.0 - u)),
                SIXTH * (4.0 - 3.0 * vv * (2.0 - v)),
                SIXTH * uu * u,
            ],
            dw: [-0.5 * vv, u * (1.5 * u - 2.0), v * (2.0 - 1.5 * v), 0.5 * uu],
        }
    }
}

impl Weights {
    /// [`Weights::at`] along each axis, as it is cheapest with the instructions of `I`.
    #[inline(always)]
    pub fn along<I: Isa, const D: usize>(u: &[f64; D]) -> [Self; D] {
        // A loop: what a closure of the standard library calls may be compiled without the instructions of `I`.
        let mut b = [Weights { w: [0.0; 4], dw: [0.0; 4] }; D];
        for a in 0..D {
            b[a] = if I::FUSED {
                Weights { w: polynomial::<I, 4>(&VALUES, u[a]), dw: polynomial::<I, 3>(&FIRST, u[a]) }
            } else {
                Weights::at(u[a])
            };
        }
        b
    }
}

/// [`second`] along each axis, as it is cheapest with the instructions of `I`.
#[inline(always)]
pub fn second_along<I: Isa, const D: usize>(u: &[f64; D]) -> [[f64; 4]; D] {
    let mut b = [[0.0; 4]; D];
    for a in 0..D {
        b[a] = if I::FUSED { polynomial::<I, 2>(&SECOND, u[a]) } else { second(u[a]) };
    }
    b
}

/// Coefficients of 1, u, u^2 and u^3 of the four basis functions.
const VALUES: [[f64; 4]; 4] = [
    [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    [-0.5, 0.0, 0.5, 0.0],
    [0.5, -1.0, 0.5, 0.0],
    [-1.0 / 6.0, 0.5, -0.5, 1.0 / 6.0],
];

/// Those of their derivatives.
const FIRST: [[f64; 4]; 3] = [[-0.5, 0.0, 0.5, 0.0], [1.0, -2.0, 1.0, 0.0], [-0.5, 1.5, -1.5, 0.5]];

/// Those of their second derivatives.
const SECOND: [[f64; 4]; 2] = [[1.0, -2.0, 1.0, 0.0], [-1.0, 3.0, -3.0, 1.0]];

/// Four polynomials of N coefficients each, by Horner's rule.
#[inline(always)]
fn polynomial<I: Isa, const N: usize>(coefficients: &[[f64; 4]; N], u: f64) -> [f64; 4] {
    let u = I::splat(u);
    let mut sum = I::load(&coefficients[N - 1]);
    for k in (0..N - 1).rev() {
        sum = I::mul_add_4(sum, u, I::load(&coefficients[k]));
    }
    let mut row = [0.0; 4];
    I::store(sum, &mut row);
    row
}

/// Second derivatives of the four basis functions at `u`.
#[inline(always)]
pub fn second(u: f64) -> [f64; 4] {
    let v = 1.0 - u;
    [v, 3.0 * u - 2.0, 3.0 * v - 2.0, u]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isa::Portable;

    /// De Boor's recursion, paper 000 (4), on the integer knots: B_{i,k}(x), support [i, i + k + 1].
    fn de_boor(i: i32, k: i32, x: f64) -> f64 {
        if k == 0 {
            return f64::from(f64::from(i) <= x && x < f64::from(i + 1));
        }
        let (left, right) = ((x - f64::from(i)) / f64::from(k), (f64::from(i + k + 1) - x) / f64::from(k));
        left * de_boor(i, k - 1, x) + right * de_boor(i + 1, k - 1, x)
    }

    #[test]
    fn agrees_with_de_boors_recursion() {
        for step in 0..100 {
            let u = f64::from(step) / 100.0;
            let weights = Weights::at(u);
            for a in 0..4 {
                // Cell [0, 1] sees the functions that start at -3, -2, -1, 0.
                assert!((weights.w[a] - de_boor(a as i32 - 3, 3, u)).abs() < 1e-15, "function {a} at u = {u}");
            }
        }
    }

    #[test]
    fn horners_rule_agrees_with_the_closed_form() {
        for step in -50..=150 {
            let u = f64::from(step) / 100.0;
            let Weights { w, dw } = Weights::at(u);
            let close = |x: [f64; 4], y: [f64; 4]| (0..4).all(|k| (x[k] - y[k]).abs() < 2e-15);
            assert!(close(polynomial::<Portable, 4>(&VALUES, u), w), "u = {u}");
            assert!(close(polynomial::<Portable, 3>(&FIRST, u), dw), "u = {u}");
            assert!(close(polynomial::<Portable, 2>(&SECOND, u), second(u)), "u = {u}");
        }
    }

    #[test]
    fn sums_to_one_with_derivatives_that_sum_to_zero() {
        for step in -50..=150 {
            let u = f64::from(step) / 100.0;
            let Weights { w, dw } = Weights::at(u);
            assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(dw.iter().sum::<f64>().abs() < 1e-14);
            assert!(second(u).iter().sum::<f64>().abs() < 1e-14);
        }
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        let e = 1e-5;
        for step in 0..=20 {
            let u = f64::from(step) / 20.0;
            let (lo, hi) = (Weights::at(u - e), Weights::at(u + e));
            for a in 0..4 {
                assert!((Weights::at(u).dw[a] - (hi.w[a] - lo.w[a]) / (2.0 * e)).abs() < 1e-9);
                assert!((second(u)[a] - (hi.dw[a] - lo.dw[a]) / (2.0 * e)).abs() < 1e-9);
            }
        }
    }
}
