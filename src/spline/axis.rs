//! One axis of a box cut into cells, and the product of two or three.

use super::kernel::Stencil;

/// Cells of edge `cell` from `lower` upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Lower end of the box.
    pub lower: f64,
    /// Edge of a cell.
    pub cell: f64,
    /// Number of cells, at least 1.
    pub n_cells: usize,
}

impl Axis {
    /// Control points along the axis: three more than cells.
    pub fn n_control(&self) -> usize {
        self.n_cells + 3
    }

    /// Upper end of the box.
    pub fn upper(&self) -> f64 {
        self.lower + self.cell * self.n_cells as f64
    }

    /// Cell that holds `xi` (a coordinate in cells) and the rest in it; the end cells hold what lies beyond them.
    #[inline]
    pub fn locate(&self, xi: f64) -> (usize, f64) {
        let i = xi.max(0.0).min((self.n_cells - 1) as f64) as usize;
        (i, xi - i as f64)
    }
}

/// A box of cells with its tensor of control points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid<const D: usize = 3> {
    /// Axes x, y and, in space, z.
    pub axes: [Axis; D],
}

impl<const D: usize> Grid<D> {
    /// Control points along each axis.
    pub fn shape(&self) -> [usize; D] {
        self.axes.map(|a| a.n_control())
    }

    /// Control points in all.
    pub fn n_control(&self) -> usize {
        self.shape().iter().product()
    }

    /// Edge of the longest cell: *a cell* in every statement about accuracy.
    pub fn longest_cell(&self) -> f64 {
        self.axes.iter().fold(0.0, |m, a| m.max(a.cell))
    }

    /// Cells along each axis.
    pub fn n_cells(&self) -> [usize; D] {
        self.axes.map(|a| a.n_cells)
    }

    /// Whether a point lies in the box or on one of its faces, by its own coordinates: those in cells are rounded.
    pub fn holds(&self, p: &[f64; D]) -> bool {
        p.iter().zip(&self.axes).all(|(x, axis)| (axis.lower..=axis.upper()).contains(x))
    }

    /// The 4^D control points and the local coordinates of a point given in cells.
    #[inline]
    pub fn stencil(&self, xi: [f64; D]) -> (Stencil<D>, [f64; D]) {
        let (mut first, mut u) = (0, [0.0; D]);
        let mut strides = [1; D];
        for a in (0..D).rev() {
            let cell;
            (cell, u[a]) = self.axes[a].locate(xi[a]);
            first += cell * strides[a];
            if a > 0 {
                strides[a - 1] = strides[a] * self.axes[a].n_control();
            }
        }
        (Stencil { first, strides }, u)
    }
}
