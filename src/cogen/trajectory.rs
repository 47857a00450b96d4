//! Trajectories of cells' centres through the other part's grid, in a few bytes a visit.
//!
//! A visit is a cell and how many steps the centre stays in it. Two bytes tell it: to which of the 3^D cells around the last one it goes, and
//! how long it stays; a visit that comes from elsewhere takes four bytes more for the cell's number. A stay longer than 255 steps takes
//! several visits.

use super::bits::Bits;
use super::foresight::{Estimate, Limit};
use super::grid::Grid;
use super::parcels::{BLOCK, Room, each_block, n_blocks};
use super::part::Part;
use super::pitch::{NONE, Wide};
use super::steps::Step;
use crate::error::{try_reserve, try_with_capacity};
use crate::geometry::matrix::{Matrix, applied, scaled};
use crate::geometry::vec::{add, scale, sub};
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// The code of a visit that comes from elsewhere: its cell's number follows.
const JUMP: u8 = 255;

/// Visits of the centres of one part's cells in the cells of the other.
#[derive(Debug)]
pub struct Trajectories<const D: usize> {
    /// Of the first turn, where there are several.
    blocks: Vec<Block>,
    wide: Wide<D>,
    n_rows: usize,
    n_visits: usize,
    /// What is added to a cell's number by each code.
    moves: [u32; 27],
}

#[derive(Debug)]
struct Block {
    ends: Vec<u32>,
    codes: Vec<u8>,
    n_visits: usize,
}

/// A step made ready: numbers of cells along each axis are the whole parts of what it makes of a centre.
struct Placing<const D: usize> {
    linear: Matrix<D>,
    shift: [f64; D],
}

impl<const D: usize> Trajectories<D> {
    /// Of the centres of the cells that `moving` may have in the cells of `wide`, at the middle of each of `steps`; the error tells when that takes
    /// more than the limit.
    pub fn new(
        steps: &[Step<D>],
        wide: Wide<D>,
        moving: &Part<D>,
        limit: Limit,
        workers: &Workers,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        let places = places(steps, &wide.grid)?;
        let n_rows = moving.grid().n_cells();
        let mut blocks: Vec<Block> = try_with_capacity(n_blocks(n_rows), "trajectories")?;
        let mut room = Room::new(limit, n_rows);
        let make = |rows| dispatch(Trace { places: &places, wide: &wide, moving, rows });
        each_block(n_rows, workers, progress, "trajectories", make, |block| {
            room.take(block.bytes())?;
            blocks.push(block);
            Ok(())
        })?;
        let n_visits = blocks.iter().map(|b| b.n_visits).sum();
        let moves = moves(&wide.grid);
        Ok(Trajectories { blocks, wide, n_rows, n_visits, moves })
    }

    /// What they will take.
    pub fn estimate(steps: &[Step<D>], wide: &Wide<D>, moving: &Part<D>, workers: &Workers) -> Result<Estimate> {
        let places = places(steps, &wide.grid)?;
        let make = |rows| dispatch(Trace { places: &places, wide, moving, rows });
        let codes = Estimate::of(moving.allowed(), workers, |i| Ok(make(i..i + 1)?.codes.len()))?;
        Ok(codes.unwrap_or_default().and(4.0 * moving.grid().n_cells() as f64 + wide.bytes() as f64))
    }

    /// Centres.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Visits of all that are stored.
    pub fn n_visits(&self) -> usize {
        self.n_visits
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.wide.bytes() + self.blocks.iter().map(Block::bytes).sum::<usize>()
    }

    /// Calls `visit` with cell and number of steps for each visit of centre `row`, in the order of time.
    #[inline]
    pub fn each(&self, row: usize, mut visit: impl FnMut(usize, u32)) {
        if self.wide.numbers.is_empty() {
            return self.each_stored(row, visit);
        }
        for own in self.wide.numbers.chunks_exact(self.wide.grid.n_cells()) {
            self.each_stored(row, |cell, stay| {
                if own[cell] != NONE {
                    visit(own[cell] as usize, stay);
                }
            });
        }
    }

    /// The same of what is stored.
    #[inline]
    fn each_stored(&self, row: usize, mut visit: impl FnMut(usize, u32)) {
        let (block, k) = (&self.blocks[row / BLOCK], row % BLOCK);
        let from = if k == 0 { 0 } else { block.ends[k - 1] };
        let mut codes = block.codes[from as usize..block.ends[k] as usize].iter();
        let mut cell = 0_u32;
        while let Some(&code) = codes.next() {
            if code == JUMP {
                let mut bytes = [0; 4];
                bytes.iter_mut().zip(&mut codes).for_each(|(to, from)| *to = *from);
                cell = u32::from_le_bytes(bytes);
            } else {
                cell = cell.wrapping_add(self.moves[code as usize]);
            }
            let stay = codes.next().map_or(0, |&n| n.into());
            visit(cell as usize, stay);
        }
    }
}

/// Steps made ready for a grid.
fn places<const D: usize>(steps: &[Step<D>], still: &Grid<D>) -> Result<Vec<Placing<D>>> {
    let cell = 1.0 / still.cell();
    let mut places = try_with_capacity(steps.len(), "steps of time")?;
    places.extend(steps.iter().map(|step| Placing {
        linear: scaled(cell, &step.pose.turn),
        shift: scale(cell, sub(step.pose.shift, still.corner())),
    }));
    Ok(places)
}

impl Block {
    fn bytes(&self) -> usize {
        self.codes.capacity() + 4 * self.ends.capacity()
    }
}

/// Cells around one, by code: each axis has a digit of base 3, the first axis the highest.
fn moves<const D: usize>(grid: &Grid<D>) -> [u32; 27] {
    std::array::from_fn(|code| {
        let (mut rest, mut step, mut sum) = (code, 1_i64, 0_i64);
        for a in (0..D).rev() {
            sum += (rest % 3) as i64 * step - step;
            step *= grid.counts()[a] as i64;
            rest /= 3;
        }
        // Numbers below zero wrap, and so does the sum.
        sum as u32
    })
}

/// The visits of some rows.
struct Trace<'a, const D: usize> {
    places: &'a [Placing<D>],
    wide: &'a Wide<D>,
    moving: &'a Part<D>,
    rows: std::ops::Range<usize>,
}

impl<const D: usize> Kernel for Trace<'_, D> {
    type Output = Result<Block>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Result<Block> {
        let mut block = Block { ends: try_with_capacity(BLOCK, "trajectories")?, codes: Vec::new(), n_visits: 0 };
        for i in self.rows.clone() {
            if self.moving.allowed().has(i) {
                self.trace(self.moving.grid().center(i), &mut block)?;
            }
            block.ends.push(u32::try_from(block.codes.len()).map_err(|_| too_long())?);
        }
        block.codes.shrink_to_fit();
        Ok(block)
    }
}

fn too_long() -> Error {
    Error::OutOfMemory { what: "a block of trajectories".into(), bytes: 1 << 32, limit: Some(u32::MAX.into()) }
}

impl<const D: usize> Trace<'_, D> {
    #[inline(always)]
    fn trace(&self, x: [f64; D], block: &mut Block) -> Result<()> {
        let counts = self.wide.grid.counts();
        let limits = counts.map(|n| n as f64);
        let allowed: &Bits = &self.wide.seen;
        // Where it is, NOWHERE outside; since how many steps; the cell that is coded last and its place.
        const NOWHERE: usize = usize::MAX;
        let (mut at, mut stay) = (NOWHERE, 0_usize);
        let (mut place, mut coded, mut coded_place) = ([0; D], NOWHERE, [0; D]);
        for step in self.places {
            let q = add(applied(&step.linear, x), step.shift);
            let inside = (0..D).all(|a| q[a] >= 0.0 && q[a] < limits[a]);
            let (next, next_place) = if inside {
                let p: [usize; D] = std::array::from_fn(|a| q[a] as usize);
                let i = (0..D).fold(0, |i, a| i * counts[a] + p[a]);
                if allowed.has(i) { (i, p) } else { (NOWHERE, p) }
            } else {
                (NOWHERE, place)
            };
            if next == at {
                stay += 1;
                continue;
            }
            if at != NOWHERE {
                push(block, (coded, coded_place), (at, place), stay)?;
                (coded, coded_place) = (at, place);
            }
            (at, place, stay) = (next, next_place, 1);
        }
        if at != NOWHERE {
            push(block, (coded, coded_place), (at, place), stay)?;
        }
        Ok(())
    }
}

/// Puts the visit of `cell` behind that of `last`.
fn push<const D: usize>(
    block: &mut Block,
    last: (usize, [usize; D]),
    cell: (usize, [usize; D]),
    mut stay: usize,
) -> Result<()> {
    try_reserve(&mut block.codes, 6 + 2 * (stay / 255), "trajectories")?;
    // The first of a row comes from nowhere.
    let near = last.0 != usize::MAX && (0..D).all(|a| cell.1[a].abs_diff(last.1[a]) <= 1);
    if near {
        block.codes.push((0..D).fold(0, |code, a| 3 * code + (cell.1[a] + 1 - last.1[a]) as u8));
    } else {
        block.codes.push(JUMP);
        block.codes.extend((cell.0 as u32).to_le_bytes());
    }
    let same = (0..D).fold(0, |code, _| 3 * code + 1);
    while stay > 255 {
        block.codes.extend([255, same]);
        stay -= 255;
        block.n_visits += 1;
    }
    block.codes.push(stay as u8);
    block.n_visits += 1;
    Ok(())
}
