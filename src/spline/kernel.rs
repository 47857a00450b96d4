//! Sums over the 4 x 4 x 4 control points of one cell: paper 000 (5) with derivatives, and its transpose.
//!
//! Sums run over rows of four contiguous control points, so that each inner loop is one vector of four: per point 44 of them
//! for value and gradient, 72 with the Hessian. Derivatives are with respect to coordinates in cells.

// Index loops of fixed length are what the compiler unrolls into vectors, and read like the sums.
#![allow(clippy::needless_range_loop)]

use super::basis::{Weights, second};

/// Where the 64 control points of a cell lie in the tensor.
#[derive(Debug, Clone, Copy)]
pub struct Stencil {
    /// Index of the first.
    pub first: usize,
    /// Distance between neighbours along x.
    pub plane: usize,
    /// Distance between neighbours along y.
    pub row: usize,
}

type Row = [f64; 4];

#[inline]
fn axpy(s: f64, x: &Row, y: &mut Row) {
    for k in 0..4 {
        y[k] += s * x[k];
    }
}

#[inline]
fn dot(x: &Row, y: &Row) -> f64 {
    (x[0] * y[0] + x[1] * y[1]) + (x[2] * y[2] + x[3] * y[3])
}

impl Stencil {
    #[inline]
    fn row<'c>(&self, coefficients: &'c [f64], i: usize, j: usize) -> &'c Row {
        let start = self.first + i * self.plane + j * self.row;
        coefficients[start..start + 4].try_into().expect("a slice of four")
    }

    /// The same control points, in a tensor whose planes begin at `first_plane`.
    #[inline]
    pub fn shifted(&self, first_plane: usize) -> Self {
        Stencil { first: self.first - first_plane * self.plane, ..*self }
    }

    /// Value at local coordinates `u`.
    #[inline]
    pub fn value(&self, coefficients: &[f64], u: [f64; 3]) -> f64 {
        let [x, y, z] = u.map(|u| Weights::at(u).w);
        let mut sum = [0.0; 4];
        for i in 0..4 {
            let mut along_y = [0.0; 4];
            for j in 0..4 {
                axpy(y[j], self.row(coefficients, i, j), &mut along_y);
            }
            axpy(x[i], &along_y, &mut sum);
        }
        dot(&sum, &z)
    }

    /// Value and gradient under the weights `b` of the three axes.
    #[inline]
    pub fn value_gradient(&self, coefficients: &[f64], b: &[Weights; 3]) -> (f64, [f64; 3]) {
        let [x, y, z] = b;
        let (mut v, mut vx, mut vy) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for i in 0..4 {
            let (mut r, mut ry) = ([0.0; 4], [0.0; 4]);
            for j in 0..4 {
                let row = self.row(coefficients, i, j);
                axpy(y.w[j], row, &mut r);
                axpy(y.dw[j], row, &mut ry);
            }
            axpy(x.w[i], &r, &mut v);
            axpy(x.dw[i], &r, &mut vx);
            axpy(x.w[i], &ry, &mut vy);
        }
        (dot(&v, &z.w), [dot(&vx, &z.w), dot(&vy, &z.w), dot(&v, &z.dw)])
    }

    /// Value, gradient and Hessian (xx xy xz yy yz zz) at local coordinates `u`.
    #[inline]
    pub fn value_gradient_hessian(&self, coefficients: &[f64], u: [f64; 3]) -> (f64, [f64; 3], [f64; 6]) {
        let [x, y, z] = u.map(Weights::at);
        let [ddx, ddy, ddz] = u.map(second);
        let (mut v, mut vx, mut vy) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        let (mut vxx, mut vxy, mut vyy) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for i in 0..4 {
            let (mut r, mut ry, mut ryy) = ([0.0; 4], [0.0; 4], [0.0; 4]);
            for j in 0..4 {
                let row = self.row(coefficients, i, j);
                axpy(y.w[j], row, &mut r);
                axpy(y.dw[j], row, &mut ry);
                axpy(ddy[j], row, &mut ryy);
            }
            axpy(x.w[i], &r, &mut v);
            axpy(x.dw[i], &r, &mut vx);
            axpy(ddx[i], &r, &mut vxx);
            axpy(x.w[i], &ry, &mut vy);
            axpy(x.dw[i], &ry, &mut vxy);
            axpy(x.w[i], &ryy, &mut vyy);
        }
        (
            dot(&v, &z.w),
            [dot(&vx, &z.w), dot(&vy, &z.w), dot(&v, &z.dw)],
            [dot(&vxx, &z.w), dot(&vxy, &z.w), dot(&vx, &z.dw), dot(&vyy, &z.w), dot(&vy, &z.dw), dot(&v, &ddz)],
        )
    }

    /// Transpose of [`Stencil::value_gradient`]: coefficients += value' * B + gradient' . grad B.
    #[inline]
    pub fn scatter(&self, coefficients: &mut [f64], b: &[Weights; 3], value: f64, gradient: [f64; 3]) {
        let [x, y, z] = b;
        for i in 0..4 {
            let along_w = x.w[i] * value + x.dw[i] * gradient[0];
            let (along_dy, along_dz) = (x.w[i] * gradient[1], x.w[i] * gradient[2]);
            for j in 0..4 {
                let start = self.first + i * self.plane + j * self.row;
                let row: &mut Row = (&mut coefficients[start..start + 4]).try_into().expect("a slice of four");
                axpy(y.w[j] * along_w + y.dw[j] * along_dy, &z.w, row);
                axpy(y.w[j] * along_dz, &z.dw, row);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;

    #[test]
    fn scatter_is_the_transpose_of_value_and_gradient() {
        let stencil = Stencil { first: 3, plane: 40, row: 6 };
        let mut random = SplitMix64::new(1);
        for _ in 0..20 {
            let c: Vec<f64> = (0..200).map(|_| random.between(-1.0, 1.0)).collect();
            let b: [Weights; 3] = std::array::from_fn(|_| Weights::at(random.unit()));
            let (value, gradient) = stencil.value_gradient(&c, &b);
            let (v, g): (f64, [f64; 3]) = (random.unit(), std::array::from_fn(|_| random.unit()));
            let mut back = vec![0.0; c.len()];
            stencil.scatter(&mut back, &b, v, g);
            let there = v * value + (0..3).map(|a| g[a] * gradient[a]).sum::<f64>();
            let back: f64 = back.iter().zip(&c).map(|(x, y)| x * y).sum();
            assert!((there - back).abs() < 1e-13, "{there} {back}");
        }
    }

    #[test]
    fn the_three_kernels_agree() {
        let stencil = Stencil { first: 0, plane: 16, row: 4 };
        let mut random = SplitMix64::new(2);
        for _ in 0..20 {
            let c: Vec<f64> = (0..64).map(|_| random.between(-1.0, 1.0)).collect();
            let u: [f64; 3] = std::array::from_fn(|_| random.unit());
            let (value, gradient) = stencil.value_gradient(&c, &u.map(Weights::at));
            let (value_h, gradient_h, _) = stencil.value_gradient_hessian(&c, u);
            assert_eq!((value, gradient), (value_h, gradient_h));
            assert!((stencil.value(&c, u) - value).abs() < 1e-15);
        }
    }
}
