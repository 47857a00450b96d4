//! Fields on cells that are refined where the shape needs it: hierarchical B-splines, C2 across levels, after Kraft 1997.
//!
//! Takes a cloud in the cells of a coarse grid and the error that is wanted; gives a tree of cells and its control points. Paper 000 has
//! one grid, and names what that costs in its section 5: time that grows with uniform refinement, and small features lost.
//!
//! From the grid on the fit solves, looks where the surface misses its points by more than `max_error` or faces itself in a few cells, cuts
//! the cells there, and solves on: [`fit`]. What is found on coarse cells is where finer ones begin, so a level takes a few iterations.
//!
//! The energy (10) is the same sum over points and integral over the box, in each leaf on the splines of its own level: [`energy`]. Its
//! weights follow the cells: from level to level lambda_n falls by 4 and lambda_r by 5, which about keeps the three terms in the proportion
//! that they have on the grid, where a uniform grid asks the caller to know.
//!
//! Points are not reweighted as on one grid, but for those that are still missed when their cells hold too few points to be cut. Where the
//! surface misses points cells are cut, which brings the largest error down as well; and what points beside an edge gain from weight, phi
//! pays for next to them: it oscillates through 0 where there are none.
//!
//! Conjugate gradients have the diagonal for a preconditioner. With all functions whose support is in W_l in place of the active ones, which
//! makes of it the preconditioner of Bramble, Pasciak and Xu 1990 (Griebel 1994), they took two to five times as many iterations: data are
//! stiff, and every level more on them makes them stiffer. The multigrid of one grid is not carried over to trees.

mod adjoint;
mod cuts;
pub(super) mod energy;
pub(super) mod fit;
mod leaf_terms;

use super::eval::Place;
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;
use crate::spline::hierarchical::{Space, per_table, strides};
use crate::spline::kernel::Stencil;
use crate::spline::tree::{SIDE, Tile, Tree};

/// The cells and control points of a refined field.
#[derive(Debug, Clone)]
pub struct Refined<const D: usize> {
    /// Its grid in the caller's units.
    tree: Tree<D>,
    /// Control points of active functions, in the order of their packs.
    active: Vec<f64>,
    /// For each tile the control points of its own level with which phi is a spline in its cells; of tiles that are cut, too.
    tables: Vec<f64>,
}

impl<const D: usize> Refined<D> {
    /// The field of the `active` control points on `tree`, of which `space` are the functions.
    pub fn new(tree: Tree<D>, space: &Space<D>, active: Vec<f64>) -> Result<Self> {
        let workers = Workers::caller_only();
        let mut c = space.with_active(active.iter().copied())?;
        space.accumulate(&workers, &mut c);
        let mut tables = try_vec(tree.tiles().len() * per_table::<D>(), 0.0, "the control points of the tiles")?;
        for (i, table) in tables.chunks_exact_mut(per_table::<D>()).enumerate() {
            if tree.holds(&tree.tiles()[i]) {
                space.gather(i, &c, table);
            }
        }
        Ok(Refined { tree, active, tables })
    }

    /// A copy, where there is room for one.
    pub fn try_clone(&self) -> Result<Self> {
        let copy = |from: &[f64]| {
            let mut to = try_vec(from.len(), 0.0, "the control points")?;
            to.copy_from_slice(from);
            Ok(to)
        };
        Ok(Refined { tree: self.tree.try_clone()?, active: copy(&self.active)?, tables: copy(&self.tables)? })
    }

    /// The cells.
    pub fn tree(&self) -> &Tree<D> {
        &self.tree
    }

    /// Control points of active functions.
    pub fn active(&self) -> &[f64] {
        &self.active
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + 8 * (self.active.capacity() + self.tables.capacity()) + size_of_val(self.tree.tiles())
    }

    /// The control points of the tiles.
    pub fn tables(&self) -> &[f64] {
        &self.tables
    }

    /// The place of a point of the box given in cells of the grid, of which `per_cell` are in a unit of length.
    #[inline(always)]
    pub(in crate::field) fn place(&self, xi: &[f64; D], per_cell: [f64; D]) -> Place<'_, D> {
        let (leaf, y) = self.tree.locate(xi);
        let times = self.tree.times_as_short(leaf);
        let (strides, mut first, mut u) = (strides::<D>(), 0, [0.0; D]);
        for a in 0..D {
            // Below 0 it is 0.
            let cell = y[a] as usize;
            first += cell * strides[a];
            u[a] = y[a] - cell as f64;
        }
        let table = leaf * per_table::<D>();
        let control_points = &self.tables[table..][..per_table::<D>()];
        Place { stencil: Stencil { first, strides }, u, control_points, table, per_cell: per_cell.map(|c| c * times) }
    }

    /// How many times as short as the grid's the shortest cells on the faces of the box are.
    pub fn finest_on_faces(&self) -> f64 {
        let on_face = |t: &Tile<D>| {
            (0..D).any(|a| {
                let (first, n) = (SIDE * t.place[a] as usize, self.tree.n_cells(t.level, a));
                first == 0 || first + SIDE >= n
            })
        };
        let leaves = self.tree.tiles().iter().filter(|t| t.is_leaf() && self.tree.holds(t) && on_face(t));
        f64::from(1u32 << leaves.map(|t| t.level).max().unwrap_or(0))
    }
}
