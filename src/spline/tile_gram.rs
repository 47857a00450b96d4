//! The Hessian energy of one tile, paper 000 (7), and values at the middles of its cells, on the tile's own functions.
//!
//! The energy is a sum of tensor products of three banded matrices an axis, as [`gram`](super::gram) makes them. A table of a tile is small
//! enough for the first cache, so it is run through axis by axis with no thought of memory.

use super::gram::{Gram, HALF_BAND};
use super::hierarchical::{LARGEST_TABLE, ROW, SPAN, per_table};
use super::tree::SIDE;
use crate::Result;
use crate::isa::Isa;
use std::f64::consts::SQRT_2;

/// A symmetric matrix on the functions along an axis, rows with a surplus of zeros.
type Matrix = [[f64; ROW]; SPAN];

/// Those of values, first and second derivatives along an axis.
type Orders = [Matrix; 3];

/// A table on the stack.
pub type Table = [f64; LARGEST_TABLE];

/// The energy of the tiles of one level: weight times int ||hess phi||_F^2 dV.
pub struct TileGram<const D: usize> {
    /// Along each axis, by the cells that a tile has there less one.
    axes: [[Orders; SIDE]; D],
}

impl<const D: usize> TileGram<D> {
    /// For cells of the edges `cell`.
    pub fn new(cell: [f64; D], weight: f64) -> Result<Self> {
        let mut axes = [[[[[0.0; ROW]; SPAN]; 3]; SIDE]; D];
        for a in 0..D {
            for (n, orders) in axes[a].iter_mut().enumerate() {
                let gram = Gram::new(n + 1, cell[a])?;
                for (order, (to, band)) in orders.iter_mut().zip(&gram.order).enumerate() {
                    // Mixed derivatives count twice: each of their two factors by the root. The weight goes with one axis.
                    let factor = if order == 1 { SQRT_2 } else { 1.0 } * if a == 0 { weight } else { 1.0 };
                    for (i, row) in band.iter().enumerate() {
                        for j in i.saturating_sub(HALF_BAND)..(i + HALF_BAND + 1).min(band.len()) {
                            to[i][j] = factor * row[j + HALF_BAND - i];
                        }
                    }
                }
            }
        }
        Ok(TileGram { axes })
    }

    /// y += A x for a tile of `cells`.
    #[inline(always)]
    pub fn add_product<I: Isa>(&self, cells: [usize; D], x: &[f64], y: &mut [f64]) {
        let n = per_table::<D>();
        let of = |a: usize| &self.axes[a][cells[a] - 1];
        let (along_y, along_z) = (of(D - 2), of(D - 1));
        let mut t: [Table; 3] = [[0.0; LARGEST_TABLE]; 3];
        for (matrix, t) in along_z.iter().zip(&mut t) {
            rows_times::<I>(matrix, x, &mut t[..n]);
        }
        if D == 2 {
            for (order, t) in [(2, &t[0]), (0, &t[2]), (1, &t[1])] {
                add_combined::<I>(&along_y[order], &t[..n], y);
            }
            return;
        }
        let along_x = of(0);
        let mut s: [Table; 3] = [[0.0; LARGEST_TABLE]; 3];
        let slab = SPAN * ROW;
        for i in 0..SPAN {
            let at = i * slab..(i + 1) * slab;
            // What derivatives along x of order 2 - k are taken of.
            for (k, order, from) in [(0, 0, 0), (1, 1, 0), (1, 0, 1), (2, 2, 0), (2, 0, 2), (2, 1, 1)] {
                add_combined::<I>(&along_y[order], &t[from][at.clone()], &mut s[k][at.clone()]);
            }
        }
        for (k, s) in s.iter().enumerate() {
            add_combined::<I>(&along_x[2 - k], s, y);
        }
    }

    /// y += the diagonal for a tile of `cells`.
    pub fn add_diagonal(&self, cells: [usize; D], y: &mut [f64]) {
        let of = |a: usize, order: usize, i: usize| self.axes[a][cells[a] - 1][order][i][i];
        for (row, y) in y.chunks_exact_mut(ROW).enumerate() {
            let (i, j) = (row / SPAN, row % SPAN);
            for (k, y) in y.iter_mut().enumerate().take(SPAN) {
                // Of the axes that there are, the last ones.
                let at: [usize; D] = std::array::from_fn(|a| [i, j, k][a + 3 - D]);
                for a in 0..D {
                    for b in a..D {
                        let order = |c: usize| usize::from(c == a) + usize::from(c == b);
                        *y += (0..D).map(|c| of(c, order(c), at[c])).product::<f64>();
                    }
                }
            }
        }
    }
}

/// Weights of the middle of a cell.
const MIDDLE: [f64; 4] = [1.0 / 48.0, 23.0 / 48.0, 23.0 / 48.0, 1.0 / 48.0];

/// Values in the middles of a tile's cells [4^D].
#[inline(always)]
pub fn at_middles<I: Isa, const D: usize>(x: &[f64], values: &mut [f64]) {
    let rows = per_table::<D>() / ROW;
    let mut lines = [0.0; LARGEST_TABLE / 2];
    for (row, line) in x.chunks_exact(ROW).zip(lines.chunks_exact_mut(SIDE)) {
        let mut sum = I::splat(0.0);
        for (w, k) in MIDDLE.iter().zip(0..) {
            sum = I::mul_add_4(I::splat(*w), four::<I>(&row[k..]), sum);
        }
        I::store(sum, line.try_into().expect("a slice of four"));
    }
    let mut planes = [0.0; SPAN * SIDE * SIDE];
    // Lines of what is before an axis become sums over it; along the last two axes first.
    let plane = SIDE * SIDE;
    for (lines, plane) in lines[..rows * SIDE].chunks_exact(SPAN * SIDE).zip(planes.chunks_exact_mut(plane)) {
        middles_along::<I>(lines, plane);
    }
    if D == 2 {
        values.copy_from_slice(&planes[..plane]);
    } else {
        middles_along::<I>(&planes, values);
    }
}

/// The transpose of [`at_middles`], added to `y`.
#[inline(always)]
pub fn add_from_middles<I: Isa, const D: usize>(values: &[f64], y: &mut [f64], weights: &[f64; 4]) {
    let mut planes = [0.0; SPAN * SIDE * SIDE];
    let plane = SIDE * SIDE;
    if D == 2 {
        planes[..plane].copy_from_slice(values);
    } else {
        add_middles_along::<I>(values, &mut planes, weights);
    }
    let mut lines = [0.0; LARGEST_TABLE / 2];
    let rows = per_table::<D>() / ROW;
    for (lines, plane) in lines[..rows * SIDE].chunks_exact_mut(SPAN * SIDE).zip(planes.chunks_exact(plane)) {
        add_middles_along::<I>(plane, lines, weights);
    }
    // The weights of a cell among those of a row: sums of whole rows, since stores at every number would wait for each other.
    let mut rows = [[0.0; ROW]; SIDE];
    for (k, row) in rows.iter_mut().enumerate() {
        row[k..k + 4].copy_from_slice(weights);
    }
    for (y, line) in y.chunks_exact_mut(ROW).zip(lines.chunks_exact(SIDE)) {
        let (mut low, mut high) = (four::<I>(y), four::<I>(&y[4..]));
        for (row, x) in rows.iter().zip(line) {
            let x = I::splat(*x);
            low = I::mul_add_4(x, four::<I>(row), low);
            high = I::mul_add_4(x, four::<I>(&row[4..]), high);
        }
        I::store(low, (&mut y[..4]).try_into().expect("a slice of four"));
        I::store(high, (&mut y[4..8]).try_into().expect("a slice of four"));
    }
}

/// [`add_from_middles`] for the diagonal of its product with [`at_middles`].
pub const SQUARES: [f64; 4] =
    [MIDDLE[0] * MIDDLE[0], MIDDLE[1] * MIDDLE[1], MIDDLE[2] * MIDDLE[2], MIDDLE[3] * MIDDLE[3]];

/// [`add_from_middles`] for the transpose.
pub const VALUES: [f64; 4] = MIDDLE;

/// Of 7 lines the sums of four, each of the 4.
#[inline(always)]
fn middles_along<I: Isa>(from: &[f64], to: &mut [f64]) {
    let n = from.len() / SPAN;
    for i in 0..SIDE {
        for at in (0..n).step_by(4) {
            let mut sum = I::splat(0.0);
            for (w, k) in MIDDLE.iter().zip(i..) {
                sum = I::mul_add_4(I::splat(*w), four::<I>(&from[k * n + at..]), sum);
            }
            I::store(sum, (&mut to[i * n + at..i * n + at + 4]).try_into().expect("a slice of four"));
        }
    }
}

/// Its transpose.
#[inline(always)]
fn add_middles_along<I: Isa>(from: &[f64], to: &mut [f64], weights: &[f64; 4]) {
    let n = from.len() / SIDE;
    for i in 0..SIDE {
        for at in (0..n).step_by(4) {
            let value = four::<I>(&from[i * n + at..]);
            for (w, k) in weights.iter().zip(i..) {
                let to = &mut to[k * n + at..k * n + at + 4];
                let sum = I::mul_add_4(I::splat(*w), value, four::<I>(to));
                I::store(sum, to.try_into().expect("a slice of four"));
            }
        }
    }
}

#[inline(always)]
fn four<I: Isa>(x: &[f64]) -> I::Four {
    I::load(x[..4].try_into().expect("a slice of four"))
}

/// Each row of `x` times the matrix.
#[inline(always)]
fn rows_times<I: Isa>(matrix: &Matrix, x: &[f64], y: &mut [f64]) {
    for (x, y) in x.chunks_exact(ROW).zip(y.chunks_exact_mut(ROW)) {
        let [mut low, mut high] = [I::splat(0.0); 2];
        for (m, x) in matrix.iter().zip(x) {
            let x = I::splat(*x);
            low = I::mul_add_4(x, four::<I>(m), low);
            high = I::mul_add_4(x, four::<I>(&m[4..]), high);
        }
        I::store(low, (&mut y[..4]).try_into().expect("a slice of four"));
        I::store(high, (&mut y[4..8]).try_into().expect("a slice of four"));
    }
}

/// y += the matrix times x, of 7 parts each.
#[inline(always)]
fn add_combined<I: Isa>(matrix: &Matrix, x: &[f64], y: &mut [f64]) {
    let n = x.len() / SPAN;
    for at in (0..n).step_by(4) {
        // A loop: what a closure of the standard library calls may be compiled without the instructions of `I`.
        let mut lines = [I::splat(0.0); SPAN];
        for (k, line) in lines.iter_mut().enumerate() {
            *line = four::<I>(&x[k * n + at..]);
        }
        for i in 0..SPAN {
            let y: &mut [f64; 4] = (&mut y[i * n + at..i * n + at + 4]).try_into().expect("a slice of four");
            let mut sum = I::load(y);
            for k in i.saturating_sub(HALF_BAND)..(i + HALF_BAND + 1).min(SPAN) {
                sum = I::mul_add_4(I::splat(matrix[i][k]), lines[k], sum);
            }
            I::store(sum, y);
        }
    }
}
