//! Value, gradient and Hessian together in fewer operations: the fast twin of [`Stencil::value_gradient_hessian`], which it agrees with to
//! rounding.
//!
//! Along an axis, of control points c_0 to c_3 with d = c_2 - c_1, e_0 = c_0 - 2 c_1 + c_2 and e_1 = c_1 - 2 c_2 + c_3, since splines
//! reproduce constants and lines, at u with v = 1 - u
//!
//! ```text
//! value  = c_1 + u d + v^3/6 e_0 + u^3/6 e_1
//! first  =         d - v^2/2 e_0 + u^2/2 e_1
//! second =             v     e_0 + u     e_1
//! ```
//!
//! That is half as many factors as the sums over four control points have, so that more of them stay in registers, and additions for
//! multiplications, which machines do side by side. Along y and z it pays; along x sums as they come do, and for less than a Hessian
//! the sums of [`super::kernel`].

use super::axis::Cells;
use super::basis::{Weights, second_with};
use super::kernel::Stencil;
use super::rows::Rows;
use crate::isa::Isa;

/// What the differences of an axis are multiplied by.
#[derive(Clone, Copy)]
struct Factors<I: Isa> {
    u: I::Four,
    v: I::Four,
    /// v^3/6, u^3/6
    value: [I::Four; 2],
    /// -v^2/2, u^2/2
    first: [I::Four; 2],
}

impl<I: Isa> Factors<I> {
    /// Those of y and z, worked out side by side.
    #[inline(always)]
    fn of_y_and_z<const D: usize>(u: &[f64; D]) -> [Self; 2] {
        let u = I::load(&[u[D - 2], u[D - 1], 0.0, 0.0]);
        let v = I::sub_4(I::splat(1.0), u);
        let uu = I::mul_4(I::mul_4(I::splat(0.5), u), u);
        let vv = I::mul_4(I::mul_4(I::splat(-0.5), v), v);
        let uuu = I::mul_4(I::mul_4(I::splat(1.0 / 3.0), u), uu);
        let vvv = I::mul_4(I::mul_4(I::splat(-1.0 / 3.0), v), vv);
        let [u, v, uu, vv, uuu, vvv] =
            [stored::<I>(u), stored::<I>(v), stored::<I>(uu), stored::<I>(vv), stored::<I>(uuu), stored::<I>(vvv)];
        let of = |a: usize| (u[a], v[a], [vvv[a], uuu[a]], [vv[a], uu[a]]);
        [Self::splat(of(0)), Self::splat(of(1))]
    }

    #[inline(always)]
    fn splat((u, v, value, first): (f64, f64, [f64; 2], [f64; 2])) -> Self {
        Factors {
            u: I::splat(u),
            v: I::splat(v),
            value: [I::splat(value[0]), I::splat(value[1])],
            first: [I::splat(first[0]), I::splat(first[1])],
        }
    }
}

/// c_1, d, e_0 and e_1 of four vectors of control points.
#[derive(Clone, Copy)]
struct Differences<I: Isa> {
    c: I::Four,
    d: I::Four,
    e: [I::Four; 2],
}

impl<I: Isa> Differences<I> {
    #[inline(always)]
    fn of(c: [I::Four; 4]) -> Self {
        let d = I::sub_4(c[2], c[1]);
        let e = [I::add_4(I::sub_4(c[0], c[1]), d), I::sub_4(I::sub_4(c[3], c[2]), d)];
        Differences { c: c[1], d, e }
    }

    #[inline(always)]
    fn value(&self, by: &Factors<I>) -> I::Four {
        I::mul_add_4(by.value[1], self.e[1], I::mul_add_4(by.value[0], self.e[0], I::mul_add_4(by.u, self.d, self.c)))
    }

    #[inline(always)]
    fn first(&self, by: &Factors<I>) -> I::Four {
        I::mul_add_4(by.first[1], self.e[1], I::mul_add_4(by.first[0], self.e[0], self.d))
    }

    #[inline(always)]
    fn second(&self, by: &Factors<I>) -> I::Four {
        I::mul_add_4(by.u, self.e[1], I::mul_4(by.v, self.e[0]))
    }
}

/// Derivatives, none to two, along x and y of the spline's four sums along z.
struct AlongZ<I: Isa> {
    v: I::Four,
    vx: I::Four,
    vy: I::Four,
    vxx: I::Four,
    vxy: I::Four,
    vyy: I::Four,
}

impl<I: Isa> AlongZ<I> {
    #[inline(always)]
    fn of<const D: usize>(rows: &Rows, u: &[f64; D], y: &Factors<I>) -> Self {
        let zero = I::splat(0.0);
        let mut sums = AlongZ { v: zero, vx: zero, vy: zero, vxx: zero, vxy: zero, vyy: zero };
        if D == 2 {
            let layer = Self::layer(rows, 0);
            return AlongZ { v: layer.value(y), vy: layer.first(y), vyy: layer.second(y), ..sums };
        }
        let ([Weights { w, dw }], ddw) = (Weights::along::<I, 1>(&[u[0]]), second_with::<I>(u[0]));
        for i in 0..4 {
            let layer = Self::layer(rows, i);
            let (r, ry, ryy) = (layer.value(y), layer.first(y), layer.second(y));
            let (w, dw, ddw) = (I::splat(w[i]), I::splat(dw[i]), I::splat(ddw[i]));
            sums.v = I::mul_add_4(w, r, sums.v);
            sums.vx = I::mul_add_4(dw, r, sums.vx);
            sums.vxx = I::mul_add_4(ddw, r, sums.vxx);
            sums.vy = I::mul_add_4(w, ry, sums.vy);
            sums.vxy = I::mul_add_4(dw, ry, sums.vxy);
            sums.vyy = I::mul_add_4(w, ryy, sums.vyy);
        }
        sums
    }

    #[inline(always)]
    fn layer(rows: &Rows, i: usize) -> Differences<I> {
        Differences::of([
            I::load(rows.get(i, 0)),
            I::load(rows.get(i, 1)),
            I::load(rows.get(i, 2)),
            I::load(rows.get(i, 3)),
        ])
    }
}

/// What turns derivatives along cells into those along x, y and z: once a batch.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Of 1, d/dx, d/dy, and of these once more along z.
    values: [f64; 4],
    first: [f64; 4],
    /// Of d2/dz2.
    second: f64,
    /// Of d2/dx2, d2/dx dy, nothing, d2/dy2.
    rest: [f64; 4],
}

impl Scale {
    /// Of the derivatives on `cells`.
    #[inline(always)]
    pub fn of<const D: usize>(cells: &Cells<D>) -> Self {
        let per_cell = cells.per_cell();
        let (x, y, z) = (if D == 3 { per_cell[0] } else { 0.0 }, per_cell[D - 2], per_cell[D - 1]);
        Scale {
            values: [1.0, x, y, 0.0],
            first: [z, x * z, y * z, 0.0],
            second: z * z,
            rest: [x * x, x * y, 0.0, y * y],
        }
    }
}

#[inline(always)]
fn stored<I: Isa>(x: I::Four) -> [f64; 4] {
    let mut row = [0.0; 4];
    I::store(x, &mut row);
    row
}

/// Value, gradient and the rows of the Hessian's upper triangle, [xx, xy, xz, yy, yz, zz] or in the plane [xx, xy, yy, ..], at local
/// coordinates `u`.
#[inline(always)]
pub fn jet<I: Isa, const D: usize>(
    stencil: &Stencil<D>,
    coefficients: &[f64],
    u: &[f64; D],
    scale: &Scale,
) -> (f64, [f64; D], [f64; 6]) {
    let rows = Rows::of(stencil, coefficients);
    let [y, z] = Factors::<I>::of_y_and_z(u);
    let AlongZ { v, vx, vy, vxx, vxy, vyy } = AlongZ::of(&rows, u, &y);
    let zero = I::splat(0.0);
    let along_z = Differences::<I>::of(I::transposed([v, vx, vy, zero]));
    let rest = Differences::<I>::of(I::transposed([vxx, vxy, zero, vyy])).value(&z);
    let [value, gx, gy, _] = stored::<I>(I::mul_4(along_z.value(&z), I::load(&scale.values)));
    let [gz, xz, yz, _] = stored::<I>(I::mul_4(along_z.first(&z), I::load(&scale.first)));
    let [zz, ..] = stored::<I>(I::mul_4(along_z.second(&z), I::splat(scale.second)));
    let [xx, xy, _, yy] = stored::<I>(I::mul_4(rest, I::load(&scale.rest)));
    // By entries: a matrix on its way through memory, written and read in other pieces, makes the next instructions wait.
    let upper = if D == 3 { [xx, xy, xz, yy, yz, zz] } else { [yy, yz, zz, 0.0, 0.0, 0.0] };
    let mut gradient = [gz; D];
    if D == 3 {
        gradient[0] = gx;
    }
    gradient[D - 2] = gy;
    (value, gradient, upper)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::isa::Portable;
    use crate::spline::{Axis, Grid};

    /// Against the sums, at corners of cells and inside.
    fn agrees_with_the_sums<const D: usize>(cells: [f64; D]) {
        let grid = Grid { axes: cells.map(|cell| Axis { lower: 0.0, cell, n_cells: 2 }) };
        let scale = Scale::of(&Cells::of(&grid));
        let mut random = SplitMix64::new(5);
        let c: Vec<f64> = (0..grid.n_control()).map(|_| random.between(-1.0, 1.0)).collect();
        for i in 0..60 {
            let xi = std::array::from_fn(|a| [2.0 * random.unit(), 1.0, 2.0][(i / 3_usize.pow(a as u32)) % 3]);
            let (stencil, u) = grid.stencil(xi);
            let (value, gradient, upper) = jet::<Portable, D>(&stencil, &c, &u, &scale);
            let (v, g, h) = stencil.value_gradient_hessian::<Portable>(&c, u);
            assert!((value - v).abs() < 1e-14);
            let mut entries = upper.iter();
            for a in 0..D {
                assert!((gradient[a] * cells[a] - g[a]).abs() < 1e-14);
                for b in a..D {
                    assert!((entries.next().unwrap() * (cells[a] * cells[b]) - h[a][b]).abs() < 1e-13, "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn agrees_with_the_sums_in_space_and_in_the_plane() {
        agrees_with_the_sums([0.3, 1.7, 0.9]);
        agrees_with_the_sums([2.0, 0.4]);
    }
}
