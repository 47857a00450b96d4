//! Sums over the 4 x 4 x 4 control points of one cell, 4 x 4 in the plane: paper 000 (5) with derivatives, and its transpose.
//!
//! Sums run over rows of four contiguous control points, so that each inner loop is one vector of four: per point of space 44 of them
//! for value and gradient, 72 with the Hessian. The plane is space with one layer along x, on which nothing depends. Derivatives are with
//! respect to coordinates in cells.

// Index loops of fixed length are what the compiler unrolls into vectors, and read like the sums.
#![allow(clippy::needless_range_loop)]

use super::basis::Weights;
use super::rows::Rows;
use crate::isa::{Isa, prefetch};

/// Where the 4^D control points of a cell lie in the tensor.
#[derive(Debug, Clone, Copy)]
pub struct Stencil<const D: usize> {
    /// Index of the first.
    pub first: usize,
    /// Distance between neighbours along each axis; 1 along the last.
    pub strides: [usize; D],
}

type Row = [f64; 4];

/// y += s x
#[inline(always)]
fn axpy<I: Isa>(s: f64, x: I::Four, y: &mut I::Four) {
    *y = I::mul_add_4(I::splat(s), x, *y);
}

#[inline(always)]
fn dot<I: Isa>(x: I::Four, y: I::Four) -> f64 {
    I::sum(I::mul_4(x, y))
}

/// Four of [`dot`].
#[inline(always)]
fn dots<I: Isa>(pairs: [(I::Four, I::Four); 4]) -> [f64; 4] {
    let [a, b, c, d] = pairs;
    let mut row = [0.0; 4];
    I::store(I::sum_4([I::mul_4(a.0, a.1), I::mul_4(b.0, b.1), I::mul_4(c.0, c.1), I::mul_4(d.0, d.1)]), &mut row);
    row
}

/// Symmetric matrix of second derivatives.
pub type Hessian<const D: usize> = [[f64; D]; D];

/// The weights of x, y and z as the sums take them: in the plane x has one layer of weight 1.
struct Layers {
    /// Layers along x.
    n: usize,
    x: Weights,
    y: Weights,
    z: Weights,
}

impl Layers {
    #[inline(always)]
    fn of<const D: usize>(b: &[Weights; D]) -> Self {
        let one = Weights { w: [1.0, 0.0, 0.0, 0.0], dw: [0.0; 4] };
        let (n, x) = if D == 3 { (4, b[0]) } else { (1, one) };
        Layers { n, x, y: b[D - 2], z: b[D - 1] }
    }
}

/// The last D of x, y, z.
#[inline(always)]
fn last<const D: usize>(v: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|a| v[a + 3 - D])
}

impl<const D: usize> Stencil<D> {
    /// Index of the row of layer `i` along x and `j` along y.
    #[inline(always)]
    fn start(&self, i: usize, j: usize) -> usize {
        let plane = if D == 3 { self.strides[0] } else { 0 };
        self.first + i * plane + j * self.strides[D - 2]
    }

    /// The same control points, in a tensor whose layers along the first axis begin at `first_layer`.
    #[inline(always)]
    pub fn shifted(&self, first_layer: usize) -> Self {
        Stencil { first: self.first - first_layer * self.strides[0], ..*self }
    }

    /// Asks for the control points, which are to be read soon.
    #[inline(always)]
    pub fn prefetch(&self, coefficients: &[f64]) {
        let rows = Rows::of(self, coefficients);
        for i in 0..if D == 3 { 4 } else { 1 } {
            for j in 0..4 {
                // Both ends: a row may lie in two lines of the cache.
                let row = rows.get(i, j);
                prefetch(&row[0]);
                prefetch(&row[3]);
            }
        }
    }

    /// Value at local coordinates `u`.
    #[inline(always)]
    pub fn value<I: Isa>(&self, coefficients: &[f64], u: [f64; D]) -> f64 {
        let Layers { n, x, y, z } = Layers::of(&Weights::along::<I, D>(&u));
        let (rows, zero) = (Rows::of(self, coefficients), I::splat(0.0));
        let mut v = zero;
        for i in 0..n {
            let mut r = zero;
            for j in 0..4 {
                axpy::<I>(y.w[j], I::load(rows.get(i, j)), &mut r);
            }
            axpy::<I>(x.w[i], r, &mut v);
        }
        dot::<I>(v, I::load(&z.w))
    }

    /// Value and gradient under the weights `b` of the axes.
    #[inline(always)]
    pub fn value_gradient<I: Isa>(&self, coefficients: &[f64], b: &[Weights; D]) -> (f64, [f64; D]) {
        let Layers { n, x, y, z } = Layers::of(b);
        let (rows, zero) = (Rows::of(self, coefficients), I::splat(0.0));
        let [mut v, mut vx, mut vy] = [zero; 3];
        for i in 0..n {
            let [mut r, mut ry] = [zero; 2];
            for j in 0..4 {
                let row = I::load(rows.get(i, j));
                axpy::<I>(y.w[j], row, &mut r);
                axpy::<I>(y.dw[j], row, &mut ry);
            }
            axpy::<I>(x.w[i], r, &mut v);
            axpy::<I>(x.dw[i], r, &mut vx);
            axpy::<I>(x.w[i], ry, &mut vy);
        }
        let (w, dw) = (I::load(&z.w), I::load(&z.dw));
        let [x, y, z, value] = dots::<I>([(vx, w), (vy, w), (v, dw), (v, w)]);
        (value, last([x, y, z]))
    }

    /// Value, gradient and Hessian under the weights `b` of the axes and those of second derivatives.
    #[inline(always)]
    pub fn value_gradient_hessian<I: Isa>(
        &self,
        coefficients: &[f64],
        b: &[Weights; D],
        second: &[[f64; 4]; D],
    ) -> (f64, [f64; D], Hessian<D>) {
        let Layers { n, x, y, z } = Layers::of(b);
        let ddx = if D == 3 { second[0] } else { [0.0; 4] };
        let (ddy, ddz) = (second[D - 2], second[D - 1]);
        let (rows, zero) = (Rows::of(self, coefficients), I::splat(0.0));
        let [mut v, mut vx, mut vy, mut vxx, mut vxy, mut vyy] = [zero; 6];
        for i in 0..n {
            let [mut r, mut ry, mut ryy] = [zero; 3];
            for j in 0..4 {
                let row = I::load(rows.get(i, j));
                axpy::<I>(y.w[j], row, &mut r);
                axpy::<I>(y.dw[j], row, &mut ry);
                axpy::<I>(ddy[j], row, &mut ryy);
            }
            axpy::<I>(x.w[i], r, &mut v);
            axpy::<I>(x.dw[i], r, &mut vx);
            axpy::<I>(ddx[i], r, &mut vxx);
            axpy::<I>(x.w[i], ry, &mut vy);
            axpy::<I>(x.dw[i], ry, &mut vxy);
            axpy::<I>(x.w[i], ryy, &mut vyy);
        }
        let (w, dw, ddw) = (I::load(&z.w), I::load(&z.dw), I::load(&ddz));
        let [gx, gy, gz, value] = dots::<I>([(vx, w), (vy, w), (v, dw), (v, w)]);
        let [xx, xy, xz, yy] = dots::<I>([(vxx, w), (vxy, w), (vx, dw), (vyy, w)]);
        let (yz, zz) = (dot::<I>(vy, dw), dot::<I>(v, ddw));
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(last);
        (value, last([gx, gy, gz]), std::array::from_fn(|a| rows[a + 3 - D]))
    }

    /// Transpose of [`Stencil::value_gradient`]: coefficients += value' * B + gradient' . grad B.
    #[inline(always)]
    pub fn scatter<I: Isa>(&self, coefficients: &mut [f64], b: &[Weights; D], value: f64, gradient: [f64; D]) {
        let Layers { n, x, y, z } = Layers::of(b);
        let (w, dw) = (I::load(&z.w), I::load(&z.dw));
        let (gx, gy, gz) = (if D == 3 { gradient[0] } else { 0.0 }, gradient[D - 2], gradient[D - 1]);
        for i in 0..n {
            let along_w = x.w[i] * value + x.dw[i] * gx;
            let (along_dy, along_dz) = (x.w[i] * gy, x.w[i] * gz);
            for j in 0..4 {
                let start = self.start(i, j);
                let row: &mut Row = (&mut coefficients[start..start + 4]).try_into().expect("a slice of four");
                let mut sum = I::load(row);
                axpy::<I>(y.w[j] * along_w + y.dw[j] * along_dy, w, &mut sum);
                axpy::<I>(y.w[j] * along_dz, dw, &mut sum);
                I::store(sum, row);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::isa::Portable;
    use crate::spline::basis::second;

    #[test]
    fn scatter_is_the_transpose_of_value_and_gradient() {
        let stencil = Stencil { first: 3, strides: [40, 6, 1] };
        let mut random = SplitMix64::new(1);
        for _ in 0..20 {
            let c: Vec<f64> = (0..200).map(|_| random.between(-1.0, 1.0)).collect();
            let b: [Weights; 3] = std::array::from_fn(|_| Weights::at(random.unit()));
            let (value, gradient) = stencil.value_gradient::<Portable>(&c, &b);
            let (v, g): (f64, [f64; 3]) = (random.unit(), std::array::from_fn(|_| random.unit()));
            let mut back = vec![0.0; c.len()];
            stencil.scatter::<Portable>(&mut back, &b, v, g);
            let there = v * value + (0..3).map(|a| g[a] * gradient[a]).sum::<f64>();
            let back: f64 = back.iter().zip(&c).map(|(x, y)| x * y).sum();
            assert!((there - back).abs() < 1e-13, "{there} {back}");
        }
    }

    #[test]
    fn the_three_kernels_agree() {
        let stencil = Stencil { first: 0, strides: [16, 4, 1] };
        let mut random = SplitMix64::new(2);
        for _ in 0..20 {
            let c: Vec<f64> = (0..64).map(|_| random.between(-1.0, 1.0)).collect();
            let u: [f64; 3] = std::array::from_fn(|_| random.unit());
            let (value, gradient) = stencil.value_gradient::<Portable>(&c, &u.map(Weights::at));
            let (b, second) = (u.map(Weights::at), u.map(second));
            let (value_h, gradient_h, _) = stencil.value_gradient_hessian::<Portable>(&c, &b, &second);
            assert_eq!((value, gradient), (value_h, gradient_h));
            assert!((stencil.value::<Portable>(&c, u) - value).abs() < 1e-15);
        }
    }

    #[test]
    fn the_plane_is_space_without_the_first_axis() {
        let mut random = SplitMix64::new(3);
        let c: Vec<f64> = (0..16).map(|_| random.between(-1.0, 1.0)).collect();
        let plane = Stencil { first: 0, strides: [4, 1] };
        let space = Stencil { first: 0, strides: [16, 4, 1] };
        let layers = c.repeat(4);
        for _ in 0..20 {
            let u: [f64; 2] = std::array::from_fn(|_| random.unit());
            let in_space = [random.unit(), u[0], u[1]];
            let (value, g, h) = plane.value_gradient_hessian::<Portable>(&c, &u.map(Weights::at), &u.map(second));
            let (value_3, g_3, h_3) =
                space.value_gradient_hessian::<Portable>(&layers, &in_space.map(Weights::at), &in_space.map(second));
            assert!((value - value_3).abs() < 1e-14 && (plane.value::<Portable>(&c, u) - value).abs() < 1e-15);
            for a in 0..2 {
                assert!((g[a] - g_3[a + 1]).abs() < 1e-14);
                (0..2).for_each(|b| assert!((h[a][b] - h_3[a + 1][b + 1]).abs() < 1e-13));
            }
            let b = u.map(Weights::at);
            assert_eq!(plane.value_gradient::<Portable>(&c, &b), (value, g));
            let (mut back, gradient) = (vec![0.0; 16], [0.3, -0.7]);
            plane.scatter::<Portable>(&mut back, &b, 0.4, gradient);
            let there = 0.4 * value + gradient[0] * g[0] + gradient[1] * g[1];
            assert!((there - back.iter().zip(&c).map(|(x, y)| x * y).sum::<f64>()).abs() < 1e-14);
        }
    }
}
