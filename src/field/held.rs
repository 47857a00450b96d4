//! The distances that a fit held away from the surface, as the field remembers them: see [`distance`](super::distance). A refit that keeps
//! them measures none, and the derivatives by the cloud are of what it holds.

use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// A cell in which a distance is held.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct HeldCell {
    /// Of one grid row-major, of a tree the place among the cells of all tiles.
    pub cell: u32,
    /// The nearest point, by its number in the cloud.
    pub point: u32,
    /// s, with the sign of d.
    pub side: f64,
}

/// A cell as the form has it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hold<const D: usize> {
    /// x, from the lower corner of the box on, in units of D.
    pub middle: [f64; D],
    /// M, with the sign of d.
    pub mass: f64,
    /// The number of q.
    pub point: u32,
}

/// All cells in which distances are held.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Held {
    cells: Vec<HeldCell>,
    /// The part of the far cells whose side is clear.
    clear: f64,
}

/// What the memory is for, should it run out.
const WHAT: &str = "the cells in which distances are held";

impl Held {
    /// Of `cells`; `None` where one has a number that is too large to be kept.
    pub fn new(cells: impl Iterator<Item = (usize, u32, f64)> + Clone, clear: f64) -> Result<Option<Self>> {
        let mut list = try_with_capacity(cells.clone().count(), WHAT)?;
        for (cell, point, side) in cells {
            let Ok(cell) = u32::try_from(cell) else { return Ok(None) };
            list.push(HeldCell { cell, point, side });
        }
        Ok(Some(Held { cells: list, clear }))
    }

    /// The cells.
    pub fn cells(&self) -> &[HeldCell] {
        &self.cells
    }

    /// The part of the far cells whose side is clear.
    pub fn clear(&self) -> f64 {
        self.clear
    }

    /// A copy, where there is room for one.
    pub fn try_clone(&self) -> Result<Self> {
        let mut cells = try_vec(self.cells.len(), HeldCell::default(), WHAT)?;
        cells.copy_from_slice(&self.cells);
        Ok(Held { cells, clear: self.clear })
    }
}
