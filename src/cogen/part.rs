//! Parts: which cells of a grid a part may have, and which it must.

use super::bits::Bits;
use super::grid::Grid;
use crate::{Error, Result};

/// What a part may do with a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Cell {
    /// It never has it.
    Forbidden = 0,
    /// It may have it: those of the initial design, by default.
    Free = 1,
    /// It keeps it whatever happens.
    Frozen = 2,
}

/// A grid, and what a part may do with its cells.
#[derive(Debug, Clone)]
pub struct Part<const D: usize> {
    grid: Grid<D>,
    /// Free or frozen.
    allowed: Bits,
    frozen: Bits,
}

impl<const D: usize> Part<D> {
    /// A part that may have every cell.
    pub fn whole(grid: Grid<D>) -> Result<Self> {
        Ok(Part { grid, allowed: Bits::all(grid.n_cells())?, frozen: Bits::none(grid.n_cells())? })
    }

    /// A part by its cells `[n]`.
    pub fn of_cells(grid: Grid<D>, cells: &[Cell]) -> Result<Self> {
        if cells.len() != grid.n_cells() {
            return Err(Error::InvalidArgument(format!(
                "{} cells for a grid of {}; it must be one for each",
                cells.len(),
                grid.n_cells()
            )));
        }
        let of = |is: fn(Cell) -> bool| Bits::of(cells.len(), |i| is(cells[i]));
        Ok(Part { grid, allowed: of(|c| c != Cell::Forbidden)?, frozen: of(|c| c == Cell::Frozen)? })
    }

    /// A part that may have the cells of which `is_in` says so at their centres.
    pub fn of_centers(grid: Grid<D>, is_in: impl Fn([f64; D]) -> bool) -> Result<Self> {
        let allowed = Bits::of(grid.n_cells(), |i| is_in(grid.center(i)))?;
        Ok(Part { grid, allowed, frozen: Bits::none(grid.n_cells())? })
    }

    /// The same part with no more than `cells`.
    pub fn within(&self, cells: &Bits) -> Self {
        let mut part = self.clone();
        part.allowed.intersect(cells);
        part.frozen.intersect(cells);
        part
    }

    /// Its grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// A_i, the cells that it may have.
    pub fn allowed(&self) -> &Bits {
        &self.allowed
    }

    /// The cells that it must have.
    pub fn frozen(&self) -> &Bits {
        &self.frozen
    }
}
