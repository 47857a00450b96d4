//! Grids of square or cubic cells.

use crate::geometry::Bounds;
use crate::geometry::vec::{number, text};
use crate::{Error, Result};
use std::cmp::Ordering;

/// Cells of a grid, at most: their numbers are 32 bits wide, and one is kept for none.
pub const MOST_CELLS: usize = u32::MAX as usize - 1;

/// Coordinates and edges are at most this: products of three of them are numbers still.
const FAR: f64 = 1e100;

fn within(p: &[f64]) -> bool {
    p.iter().all(|x| x.abs() <= FAR)
}

/// Cells of edge eps from a corner on, row-major: the last axis runs fastest. Cell i is the closed cube C_i of (A.2) around its centre x_i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid<const D: usize> {
    corner: [f64; D],
    cell: f64,
    counts: [usize; D],
}

impl<const D: usize> Grid<D> {
    /// `counts` cells of edge `cell` along each axis, from `corner` on.
    pub fn new(corner: [f64; D], cell: f64, counts: [usize; D]) -> Result<Self> {
        if !within(&corner) {
            return Err(Error::InvalidArgument(format!(
                "the grid's corner is {}; its coordinates must be finite, and 1e100 at most in size",
                text(&corner)
            )));
        }
        if !(1.0 / FAR..=FAR).contains(&cell) {
            return Err(Error::InvalidArgument(format!(
                "the grid's cells have the edge {}; it must lie in [1e-100, 1e100]",
                number(cell)
            )));
        }
        if let Some(a) = counts.iter().position(|&n| n == 0) {
            return Err(Error::InvalidArgument(format!(
                "the grid has 0 cells along axis {a}; it must have 1 at least"
            )));
        }
        let n = counts.iter().map(|&n| n as u128).product::<u128>();
        if n > MOST_CELLS as u128 {
            return Err(Error::InvalidArgument(format!("the grid has {n} cells; it may have {MOST_CELLS}")));
        }
        let far = std::array::from_fn::<f64, D, _>(|a| corner[a] + cell * counts[a] as f64);
        if !within(&far) {
            let text = format!("the grid reaches to {}; 1e100 is the farthest", text(&far));
            return Err(Error::InvalidArgument(text));
        }
        Ok(Grid { corner, cell, counts })
    }

    /// An order of grids, by their numbers: of two alike parts it tells one from the other, whichever comes first.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let numbers = |g: &Self| std::iter::once(g.cell).chain(g.corner).collect::<Vec<_>>();
        let by_numbers = numbers(self).iter().zip(numbers(other)).map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne());
        by_numbers.unwrap_or(self.counts.cmp(&other.counts))
    }

    /// The corner with the smallest coordinates.
    pub fn corner(&self) -> [f64; D] {
        self.corner
    }

    /// eps, the edge of a cell.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// eps^D, the area or volume of a cell.
    pub fn measure(&self) -> f64 {
        self.cell.powi(D as i32)
    }

    /// Cells along each axis.
    pub fn counts(&self) -> [usize; D] {
        self.counts
    }

    /// n, the number of cells.
    pub fn n_cells(&self) -> usize {
        self.counts.iter().product()
    }

    /// The number of the cell at `place`.
    pub fn number(&self, place: [usize; D]) -> usize {
        (0..D).fold(0, |i, a| i * self.counts[a] + place[a])
    }

    /// Where cell `i` stands.
    pub fn place(&self, mut i: usize) -> [usize; D] {
        let mut place = [0; D];
        for a in (0..D).rev() {
            place[a] = i % self.counts[a];
            i /= self.counts[a];
        }
        place
    }

    /// x_i, the centre of cell `i`.
    pub fn center(&self, i: usize) -> [f64; D] {
        let place = self.place(i);
        std::array::from_fn(|a| self.corner[a] + self.cell * (place[a] as f64 + 0.5))
    }

    /// The box that the cells fill.
    pub fn bounds(&self) -> Bounds<D> {
        let max = std::array::from_fn(|a| self.corner[a] + self.cell * self.counts[a] as f64);
        Bounds { min: self.corner, max }
    }

    /// Corners of that box, 2^D of them.
    pub fn corners(&self) -> impl Iterator<Item = [f64; D]> + use<D> {
        let bounds = self.bounds();
        (0..1 << D).map(move |k| std::array::from_fn(|a| if k >> a & 1 == 0 { bounds.min[a] } else { bounds.max[a] }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_numbered_with_the_last_axis_fastest() {
        let grid = Grid::new([1.0, -1.0, 0.0], 0.5, [2, 3, 4]).unwrap();
        assert_eq!((grid.n_cells(), grid.number([0, 0, 1]), grid.number([1, 2, 3])), (24, 1, 23));
        for i in 0..24 {
            assert_eq!(grid.number(grid.place(i)), i);
        }
        assert_eq!(grid.center(23), [1.75, 0.25, 1.75]);
        assert_eq!(grid.bounds().max, [2.0, 0.5, 2.0]);
        assert_eq!(grid.corners().last(), Some([2.0, 0.5, 2.0]));
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        let told = |corner, cell, counts| Grid::<2>::new(corner, cell, counts).unwrap_err().to_string();
        assert!(told([f64::NAN, 0.0], 1.0, [1, 1]).contains("corner"));
        assert!(told([0.0; 2], 0.0, [1, 1]).contains("edge 0"));
        assert!(told([0.0; 2], 1.0, [1, 0]).contains("axis 1"));
        assert!(told([0.0; 2], 1.0, [usize::MAX, 2]).contains("may have"));
        assert!(told([0.0; 2], 1e99, [9, 99]).contains("the grid reaches to (9e99, 9.9e100)"));
        assert!(told([1e101, 0.0], 1.0, [1, 1]).contains("corner"));
        assert!(
            told([0.0; 2], 1e-101, [1, 1]).contains("edge")
                && told([0.0; 2], f64::INFINITY, [1, 1]).contains("edge inf")
        );
    }
}
