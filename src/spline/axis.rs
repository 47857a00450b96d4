//! One axis of a box cut into cells, and the product of three.

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
pub struct Grid {
    /// Axes x, y, z.
    pub axes: [Axis; 3],
}

impl Grid {
    /// Control points along each axis.
    pub fn shape(&self) -> [usize; 3] {
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

    /// The 64 control points and the local coordinates of a point given in cells.
    #[inline]
    pub fn stencil(&self, xi: [f64; 3]) -> (Stencil, [f64; 3]) {
        let [_, ny, nz] = self.shape();
        let (i, u) = self.axes[0].locate(xi[0]);
        let (j, v) = self.axes[1].locate(xi[1]);
        let (k, w) = self.axes[2].locate(xi[2]);
        (Stencil { first: (i * ny + j) * nz + k, plane: ny * nz, row: nz }, [u, v, w])
    }
}
