//! Uniform cubic B-splines on a box: bases, exact Gram matrices and the evaluation kernel.
//!
//! Takes a box and a resolution; gives weights, banded matrices and sums over the stencil of a point. Paper 000, section 3.2.
//!
//! Words: a *knot* is a point where polynomial pieces meet; here knots are uniform and simple. A *cell* is the interval between two
//! neighbouring knots inside the box. *Degree* is always meant, never order: cubic is degree 3. *Control points* are the coefficients;
//! an axis of c cells has n = c + 3 of them, and those of cell i are i, i + 1, i + 2, i + 3, so the outermost lie beyond the box.
//!
//! Notation: h cell edge; xi = (x - lower) / h the coordinate in cells; i = floor(xi) the cell; u = xi - i in [0, 1]; B_i the basis
//! function of control point i; w, dw, ddw its values and derivatives with respect to xi on one cell.
//!
//! | paper 000 | here |
//! |---|---|
//! | (4), de Boor's recursion, on uniform knots | [`basis::Weights`], its closed form |
//! | (5), the sum over control points | [`kernel`] |
//! | the integrals of (7) along one axis | [`gram::Gram`] |
//!
//! Of what the paper has not: [`two_scale`], splines of a coarse grid on a fine one; [`assembled`], operators by their entries; [`blocks`],
//! their local inverses; [`centers`], sums at the middles of all cells; [`tree`], cells refined where needed, [`hierarchical`], the splines
//! on them, and [`tile_gram`], their smoothness; [`hull`], bounds on parts of a cell.
//!
//! Tensors of control points are row-major, the last axis contiguous.

#![deny(unsafe_code)]

pub mod assembled;
pub mod axis;
pub mod basis;
pub mod blocks;
pub mod centers;
pub mod gram;
pub mod hierarchical;
pub mod hull;
pub mod kernel;
pub mod rows;
pub mod tile_gram;
pub mod tree;
pub mod two_scale;

pub use axis::{Axis, Grid};

/// Where number `i` of a tensor of `shape` stands, row-major.
#[inline(always)]
pub fn place_of<const D: usize>(mut i: usize, shape: [usize; D]) -> [usize; D] {
    let mut place = [0; D];
    for (x, n) in place.iter_mut().zip(shape).rev() {
        (*x, i) = (i % n, i / n);
    }
    place
}
