//! One axis of a box cut into cells, and the product of two or three.

use super::kernel::Stencil;
use crate::isa::Isa;

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
    #[inline(always)]
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
    #[inline(always)]
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

/// A grid as evaluations take it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cells<const D: usize> {
    lower: [f64; D],
    per_cell: [f64; D],
    /// Cells along each axis, and the index of the last.
    n: [f64; D],
    last: [f64; D],
    strides: [usize; D],
}

impl<const D: usize> Cells<D> {
    /// Those of `grid`.
    pub fn of(grid: &Grid<D>) -> Self {
        let mut strides = [1; D];
        for a in (1..D).rev() {
            strides[a - 1] = strides[a] * grid.axes[a].n_control();
        }
        Cells {
            lower: grid.axes.map(|a| a.lower),
            per_cell: grid.axes.map(|a| 1.0 / a.cell),
            n: grid.axes.map(|a| a.n_cells as f64),
            last: grid.axes.map(|a| (a.n_cells - 1) as f64),
            strides,
        }
    }

    /// 1 / h_a: what turns a derivative along a cell into one along x.
    #[inline(always)]
    pub fn per_cell(&self) -> [f64; D] {
        self.per_cell
    }

    /// Cells along each axis.
    pub fn n_cells(&self) -> [usize; D] {
        self.n.map(|n| n as usize)
    }

    /// A point in cells.
    #[inline(always)]
    pub fn coordinates(&self, p: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|a| (p[a] - self.lower[a]) * self.per_cell[a])
    }

    /// Whether a point given in cells lies in the box.
    #[inline(always)]
    pub fn contain(&self, xi: &[f64; D]) -> bool {
        // Without a branch for each face.
        (0..D).fold(true, |inside, a| inside & (xi[a] >= 0.0) & (xi[a] <= self.n[a]))
    }

    /// The 4^D control points and the local coordinates of a point of the box given in cells.
    #[inline(always)]
    pub fn stencil<I: Isa>(&self, xi: &[f64; D]) -> (Stencil<D>, [f64; D]) {
        let (mut first, mut u) = (0, [0.0; D]);
        for a in 0..D {
            // On the upper face it is the last cell's; without `min`, which asks for NaNs.
            let (index, cell) = I::whole(if xi[a] < self.last[a] { xi[a] } else { self.last[a] });
            first += index * self.strides[a];
            u[a] = xi[a] - cell;
        }
        (Stencil { first, strides: self.strides }, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::isa::Portable;

    #[test]
    fn cells_are_those_of_the_grid() {
        let axis = |lower, n_cells| Axis { lower, cell: 0.3, n_cells };
        let grid = Grid { axes: [axis(-1.0, 1), axis(0.2, 5), axis(3.0, 4)] };
        let cells = Cells::of(&grid);
        let mut random = SplitMix64::new(1);
        for i in 0..200 {
            // Faces, edges and corners among them.
            let xi: [f64; 3] = std::array::from_fn(|a| {
                let n = grid.axes[a].n_cells as f64;
                [0.0, n, n * random.unit()][(i / 3_usize.pow(a as u32)) % 3]
            });
            let ((mine, u), (theirs, v)) = (cells.stencil::<Portable>(&xi), grid.stencil(xi));
            assert!(cells.contain(&xi));
            assert_eq!((mine.first, mine.strides, u), (theirs.first, theirs.strides, v));
        }
        for a in 0..3 {
            for outside in [-1e-300, grid.axes[a].n_cells as f64 * (1.0 + f64::EPSILON), f64::NAN] {
                let mut xi = [0.5; 3];
                xi[a] = outside;
                assert!(!cells.contain(&xi));
            }
        }
    }
}
