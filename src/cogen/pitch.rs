//! Screws that slide: what happens in one turn happens in each, by whole cells farther along the axis.
//!
//! Where a turn slides by a whole number of cells, a centre's way in the k-th turn is that in the first, moved by k times as many cells. So the
//! first turn is stored, in a grid that reaches as far as what comes into the grid later, and for each turn a table of what its cells are then.

use super::bits::Bits;
use super::grid::{Grid, MOST_CELLS};
use super::part::Part;
use crate::Result;
use crate::error::try_vec;
use crate::geometry::vec::scale;

/// Turns that are alike, `n` of them, and by how many cells each is farther than the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Turns<const D: usize> {
    pub n: usize,
    pub by: [i64; D],
}

/// How far off a whole number of cells, in cells, a turn's slide may be.
const OFF: f64 = 1e-9;

/// The tables of all turns have as many entries at most: 256 MB.
const MOST_ENTRIES: usize = 1 << 26;

impl<const D: usize> Turns<D> {
    /// One: nothing repeats itself.
    pub const ONE: Self = Turns { n: 1, by: [0; D] };

    /// `n` turns that slide by `slide` each, if that is whole cells of the grid.
    pub fn of(n: usize, slide: [f64; D], grid: &Grid<D>) -> Option<Self> {
        let cells = scale(1.0 / grid.cell(), slide);
        let whole = cells.iter().all(|x| (x - x.round()).abs() <= OFF && x.abs() < 1e9);
        whole.then(|| Turns { n, by: cells.map(|x| x.round() as i64) })
    }
}

/// Where centres are looked for in the first turn, and what cells are in each.
#[derive(Debug)]
pub struct Wide<const D: usize> {
    pub grid: Grid<D>,
    /// Cells that are one that the part may have, in any turn.
    pub seen: Bits,
    /// For each turn, for each cell: the number of that cell in the part's grid, or [`NONE`]. Empty where there is one turn.
    pub numbers: Vec<u32>,
}

/// No cell.
pub const NONE: u32 = u32::MAX;

impl<const D: usize> Wide<D> {
    /// For the cells that `still` may have; none where that takes too much.
    pub fn new(still: &Part<D>, turns: Turns<D>) -> Result<Option<Self>> {
        let (grid, allowed) = (still.grid(), still.allowed());
        if turns.n == 1 {
            return Ok(Some(Wide { grid: *grid, seen: allowed.clone(), numbers: Vec::new() }));
        }
        // In turn k the cell p is p + k by: it lies k by before the grid at most.
        let last = turns.n as i64 - 1;
        let below = turns.by.map(|by| (last * by).max(0) as usize);
        let counts: [usize; D] =
            std::array::from_fn(|a| grid.counts()[a] + (last * turns.by[a]).unsigned_abs() as usize);
        let n = counts.iter().map(|&n| n as u128).product::<u128>();
        if n > MOST_CELLS as u128 || n * turns.n as u128 > MOST_ENTRIES as u128 {
            return Ok(None);
        }
        let corner = std::array::from_fn(|a| grid.corner()[a] - grid.cell() * below[a] as f64);
        let wide = Grid::new(corner, grid.cell(), counts)?;
        let n = wide.n_cells();
        let (mut seen, mut numbers) = (Bits::none(n)?, try_vec(turns.n * n, NONE, "turns of a screw")?);
        for (k, own) in numbers.chunks_exact_mut(n).enumerate() {
            for (i, to) in own.iter_mut().enumerate() {
                let place = wide.place(i);
                let moved: [i64; D] =
                    std::array::from_fn(|a| place[a] as i64 - below[a] as i64 + k as i64 * turns.by[a]);
                if (0..D).all(|a| (0..grid.counts()[a] as i64).contains(&moved[a])) {
                    let cell = grid.number(moved.map(|x| x as usize));
                    if allowed.has(cell) {
                        *to = cell as u32;
                        seen.insert(i);
                    }
                }
            }
        }
        Ok(Some(Wide { grid: wide, seen, numbers }))
    }

    /// Bytes that the tables take.
    pub fn bytes(&self) -> usize {
        4 * self.numbers.len()
    }
}
