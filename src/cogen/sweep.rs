//! Sweep and unsweep of cells: paper 002, section 2, (1) and (2).
//!
//! sweep(M, S) is what S passes over as it moves, unsweep(M, S) what stays within S. Here both are of cells, and on the safe side, by
//! `separation`: a sweep holds every cell of the other grid that is overlapped at any time, an unsweep only cells that overlap
//! nothing they must avoid, and leave nothing they must stay in, at any time. Several bodies, each with its own motion, are met at once: the
//! latch of figure 2 stays in its enclosure and keeps off its pin. (2) writes the pin's unsweep with S_P where its complement is meant, as in (1).

use super::bits::{Bits, Marks};
use super::conflict::moves;
use super::grid::Grid;
use super::parcels::each_block;
use super::part::Part;
use super::separation::Swathes;
use super::steps::{Relative, Sampling};
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ops::Range;

/// What a part has to do with a body's cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// It must overlap none of them.
    Avoid,
    /// It must lie within them.
    StayIn,
}

/// A body that a part moves about, or in.
#[derive(Debug, Clone)]
pub struct Body<'a, const D: usize> {
    /// The grid of its cells.
    pub grid: Grid<D>,
    /// Which of them it has.
    pub cells: &'a Bits,
    /// The part's motion as seen from the body: `from` is the body's, `of` the part's.
    pub relative: Relative<D>,
    /// What the part has to do with it.
    pub rule: Rule,
    /// Distance that the part keeps from what it must not overlap.
    pub clearance: f64,
}

/// The cells of `still` that those of `cells`, of the grid `moving`, overlap at any time of the motion, `of` being theirs.
pub fn sweep<const D: usize>(
    moving: &Grid<D>,
    cells: &Bits,
    relative: &Relative<D>,
    still: &Grid<D>,
    sampling: Sampling,
    workers: &Workers,
    progress: &mut Progress<'_>,
) -> Result<Bits> {
    check_cells(moving, cells)?;
    swept_by(&Swathes::new(relative, sampling, still, moving, 0.0)?, moving, cells, still, workers, progress)
}

fn swept_by<const D: usize>(
    swathes: &Swathes<D>,
    moving: &Grid<D>,
    cells: &Bits,
    still: &Grid<D>,
    workers: &Workers,
    progress: &mut Progress<'_>,
) -> Result<Bits> {
    let all = Bits::all(still.n_cells())?;
    let mut swept = Bits::none(still.n_cells())?;
    let make = |block| dispatch(Swept { swathes, moving, cells, all: &all, block });
    each_block(moving.n_cells(), workers, progress, "sweep", make, |found| {
        swept.unite(&found);
        Ok(())
    })?;
    Ok(swept)
}

/// The cells that a part may have so that it keeps to the rules of all `bodies` throughout the motion; whether it must have any does not count.
pub fn unsweep<const D: usize>(
    part: &Part<D>,
    bodies: &[Body<'_, D>],
    sampling: Sampling,
    workers: &Workers,
    progress: &mut Progress<'_>,
) -> Result<Bits> {
    let mut kept = part.allowed().clone();
    for body in bodies {
        check_cells(&body.grid, body.cells)?;
        // What must not be overlapped; around an enclosure a layer of cells more, which nothing gets out without passing.
        let (grid, forbidden) = match body.rule {
            Rule::Avoid => (body.grid, body.cells.clone()),
            Rule::StayIn => outside(&body.grid, body.cells)?,
        };
        let moving = part.grid();
        if body.rule == Rule::StayIn {
            // The layer is passed by what gets out, not by what never was in.
            let pose = body.relative.at(0.0);
            let bounds = body.grid.bounds();
            let is_out = |i: usize| {
                let p = pose.apply(moving.center(i));
                (0..D).any(|a| !(bounds.min[a]..=bounds.max[a]).contains(&p[a]))
            };
            let out: Vec<usize> = kept.iter().filter(|&i| is_out(i)).collect();
            out.into_iter().for_each(|i| kept.remove(i));
        }
        if body.rule == Rule::Avoid
            && moves((&grid, forbidden.count()), (moving, part.allowed().count()), &body.relative.reversed())
        {
            // Seen from the part, as a graph would have it.
            let swathes = Swathes::new(&body.relative.reversed(), sampling, moving, &grid, body.clearance)?;
            kept.subtract(&swept_by(&swathes, &grid, &forbidden, moving, workers, progress)?);
            continue;
        }
        let swathes = Swathes::new(&body.relative, sampling, &grid, moving, body.clearance)?;
        let tested = kept.clone();
        let make =
            |block| dispatch(Unswept { swathes: &swathes, moving, forbidden: &forbidden, tested: &tested, block });
        each_block(moving.n_cells(), workers, progress, "unsweep", make, |lost: Vec<usize>| {
            lost.into_iter().for_each(|i| kept.remove(i));
            Ok(())
        })?;
    }
    Ok(kept)
}

fn check_cells<const D: usize>(grid: &Grid<D>, cells: &Bits) -> Result<()> {
    if cells.len() == grid.n_cells() {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!("a set among {} cells; the grid has {}", cells.len(), grid.n_cells())))
}

/// The complement of `cells` in their grid, with a layer of cells more on each side.
fn outside<const D: usize>(grid: &Grid<D>, cells: &Bits) -> Result<(Grid<D>, Bits)> {
    let corner = grid.corner().map(|x| x - grid.cell());
    let wide = Grid::new(corner, grid.cell(), grid.counts().map(|n| n + 2))?;
    let is_outside = |i: usize| {
        let place = wide.place(i);
        let inside = (0..D).all(|a| (1..=grid.counts()[a]).contains(&place[a]));
        !inside || !cells.has(grid.number(place.map(|p| p - 1)))
    };
    Ok((wide, Bits::of(wide.n_cells(), is_outside)?))
}

/// The cells that a block of moving cells passes over.
struct Swept<'a, const D: usize> {
    swathes: &'a Swathes<D>,
    moving: &'a Grid<D>,
    cells: &'a Bits,
    all: &'a Bits,
    block: Range<usize>,
}

impl<const D: usize> Kernel for Swept<'_, D> {
    type Output = Result<Bits>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Result<Bits> {
        let (mut marks, mut found) = (Marks::new(self.all.len())?, Bits::none(self.all.len())?);
        for i in self.block.filter(|&i| self.cells.has(i)) {
            self.swathes.mark(self.moving.center(i), &mut marks);
        }
        marks.take_runs(self.all, &mut |run| {
            found.insert_range(run);
            Ok(())
        })?;
        Ok(found)
    }
}

/// The cells of a block, among those that are tested, that overlap what they must not.
struct Unswept<'a, const D: usize> {
    swathes: &'a Swathes<D>,
    moving: &'a Grid<D>,
    forbidden: &'a Bits,
    tested: &'a Bits,
    block: Range<usize>,
}

impl<const D: usize> Kernel for Unswept<'_, D> {
    type Output = Result<Vec<usize>>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Result<Vec<usize>> {
        let (mut marks, mut lost) = (Marks::new(self.forbidden.len())?, Vec::new());
        for i in self.block.filter(|&i| self.tested.has(i)) {
            self.swathes.mark(self.moving.center(i), &mut marks);
            let mut met = false;
            marks.take_runs(self.forbidden, &mut |_| {
                met = true;
                Ok(())
            })?;
            if met {
                lost.push(i);
            }
        }
        Ok(lost)
    }
}
