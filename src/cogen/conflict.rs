//! The conflict graph: which cells of one part a part cannot have together with which of the other.
//!
//! An edge joins cells that overlap at some time. Pairs of parts that never collide are the independent sets of this bipartite graph.

use super::bits::{Bits, Marks};
use super::closure::check_set;
use super::foresight::{Estimate, Limit};
use super::grid::Grid;
use super::parcels::{Room, each_block, n_blocks};
use super::part::Part;
use super::rows::{Block, Rows};
use super::separation::Swathes;
use super::steps::{Relative, Sampling};
use crate::Result;
use crate::error::try_with_capacity;
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use crate::progress::Progress;
use std::ops::Range;

/// One of the two parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Part 1.
    First,
    /// Part 2.
    Second,
}

impl Side {
    /// The other part.
    pub fn other(self) -> Self {
        match self {
            Side::First => Side::Second,
            Side::Second => Side::First,
        }
    }

    /// 0 or 1.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// How conflicts are found: see [`Conflicts::of_overlap`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverlapOptions {
    /// How finely time is cut: no result depends on it but by what cells are kept apart too much.
    pub sampling: Sampling,
    /// Distance that parts keep from each other at all times, in the caller's units.
    pub clearance: f64,
    /// Bytes that the graph may take, rows and columns.
    pub max_bytes: u64,
    /// Threads; 0 takes all cores.
    pub n_threads: u32,
}

impl Default for OverlapOptions {
    fn default() -> Self {
        OverlapOptions { sampling: Sampling::Slack(0.05), clearance: 0.0, max_bytes: 8 << 30, n_threads: 0 }
    }
}

/// Whether of two parts the one with `grid` is seen to move, by how many of their cells count, by their cells, and by their motions, that of the
/// other first: the one with fewer. Graphs and unsweeps ask the same, so that they keep the same cells.
pub(super) fn moves<const D: usize>(
    (grid, n): (&Grid<D>, usize),
    (other, n_other): (&Grid<D>, usize),
    relative: &Relative<D>,
) -> bool {
    n.cmp(&n_other).then_with(|| grid.order(other)).then_with(|| relative.order()).is_lt()
}

/// The graph.
#[derive(Debug)]
pub struct Conflicts {
    /// To each cell of the part `rows_of` those of the other.
    rows: Rows,
    /// The same, to each cell of the other part.
    columns: Rows,
    rows_of: Side,
    /// Cells of each part's grid.
    n_cells: [usize; 2],
}

impl Conflicts {
    /// Cells that overlap at any time, or come nearer to each other than the clearance: no such pair is missed. Pairs that only nearly do
    /// may count as well: see `separation`. Cells that a part may not have are left out. `relative` is the motion of part 2 as seen from part 1.
    ///
    /// The error tells of a clearance below 0, of a motion with a number that is not finite, and of a graph that would take more than
    /// `max_bytes`, and what cells would fit: before it is made, from a sample of its rows. Time: for each cell of the part with fewer of them
    /// and each step, and for each cell that it passes over then; as many bits on one thread as on several.
    pub fn of_overlap<const D: usize>(
        parts: [&Part<D>; 2],
        relative: &Relative<D>,
        options: &OverlapOptions,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        let n_cells = parts.map(|p| p.grid().n_cells());
        // Rows for the part with fewer cells: they are what the time goes into.
        let n_allowed = parts.map(|p| p.allowed().count());
        let rows_of = if moves((parts[1].grid(), n_allowed[1]), (parts[0].grid(), n_allowed[0]), relative) {
            Side::Second
        } else {
            Side::First
        };
        let (moving, still) = (parts[rows_of.index()], parts[rows_of.other().index()]);
        let seen = if rows_of == Side::First { relative.reversed() } else { relative.clone() };
        let workers = Workers::new(options.n_threads)?;
        // Half as large cells are 2^D as many, each with twice as many runs.
        let limit = Limit::new("the conflict graph", options.max_bytes, [moving.grid(), still.grid()], D + 1);
        let rows = Making { moving, still, seen, options, limit, workers: &workers }.rows(progress)?;
        let made = Conflicts::of_made(n_cells, rows_of, rows, &workers)?;
        if made.bytes() as u64 > options.max_bytes {
            return Err(limit.refusal(made.bytes() as f64, None));
        }
        Ok(made)
    }

    /// The graph of which `edge`(cell of part 1, cell of part 2) tells the edges: for few cells, it asks for each pair.
    pub fn of_edges(n_cells: [usize; 2], rows_of: Side, edge: impl Fn(usize, usize) -> bool + Sync) -> Result<Self> {
        let n = n_cells[rows_of.other().index()];
        let joined = |i: usize, j: usize| if rows_of == Side::First { edge(i, j) } else { edge(j, i) };
        let row = |i: usize, mark: &mut dyn FnMut(usize)| (0..n).filter(|&j| joined(i, j)).for_each(mark);
        let (workers, silent) = (Workers::caller_only(), &mut Progress::silent());
        Conflicts::of_rows(n_cells, rows_of, row, Limit::none(), &workers, silent)
    }

    /// The graph whose rows `row`(i, mark) marks, cell by cell, in any order and more than once. `row` is gone before the columns are made. What
    /// would pass the limit is refused before it is made, from a sample of the rows.
    pub(super) fn of_rows(
        n_cells: [usize; 2],
        rows_of: Side,
        row: impl Fn(usize, &mut dyn FnMut(usize)) + Sync + Send,
        limit: Limit,
        workers: &Workers,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        let (n_rows, n) = (n_cells[rows_of.index()], n_cells[rows_of.other().index()]);
        let all = Bits::all(n)?;
        let make = move |rows: Range<usize>| -> Result<Block> {
            let (mut block, mut marks) = (Block::new()?, Marks::new(n)?);
            for i in rows {
                row(i, &mut |j| marks.insert_range(j..j + 1));
                block.push_row(|run| marks.take_runs(&all, run))?;
            }
            Ok(block.settled())
        };
        let sample = Estimate::of(&Bits::all(n_rows)?, workers, |i| Ok(make(i..i + 1)?.bytes_of_runs()))?;
        // Columns take about what rows do.
        if let Some(both) = sample.map(|rows| rows.plus(&rows).and(4.0 * (n_rows + n) as f64))
            && limit.is_passed_by(&both)
        {
            return Err(limit.refusal(both.bytes(), None));
        }
        let mut blocks: Vec<Block> = try_with_capacity(n_blocks(n_rows), "the conflict graph")?;
        let mut room = Room::new(limit, n_rows);
        each_block(n_rows, workers, progress, "conflicts", make, |block| {
            room.take(2 * block.bytes())?;
            blocks.push(block);
            Ok(())
        })?;
        Conflicts::of_made(n_cells, rows_of, Rows::new(blocks), workers)
    }

    fn of_made(n_cells: [usize; 2], rows_of: Side, rows: Rows, workers: &Workers) -> Result<Self> {
        let columns = rows.transposed(n_cells[rows_of.other().index()], workers)?;
        Ok(Conflicts { rows, columns, rows_of, n_cells })
    }

    /// The graph of cells of several parts, by numbers through all of them, each row with all that its cell conflicts with: read as the double
    /// cover, which has every cell on both sides.
    pub(super) fn of_all(rows: Rows, n_cells: usize) -> Self {
        Conflicts { columns: rows.clone(), rows, rows_of: Side::First, n_cells: [n_cells; 2] }
    }

    /// Whether nothing collides: grids that never meet, or a motion that keeps them apart. Then both parts keep every cell, there is no gamma, and
    /// all that is asked of the graph has that answer.
    pub fn is_empty(&self) -> bool {
        self.n_edges() == 0
    }

    /// Edges.
    pub fn n_edges(&self) -> usize {
        self.rows.n_edges()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.rows.bytes() + self.columns.bytes()
    }

    /// Whose cells the rows are of.
    pub(super) fn rows_of(&self) -> Side {
        self.rows_of
    }

    /// The rows.
    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The columns.
    pub(super) fn columns(&self) -> &Rows {
        &self.columns
    }

    /// What the cells of part 1 conflict with, and what those of part 2 do.
    pub(super) fn by_side(&self) -> (&Rows, &Rows) {
        if self.rows_of == Side::First { (&self.rows, &self.columns) } else { (&self.columns, &self.rows) }
    }

    /// Cells of a part's grid.
    pub fn n_cells(&self, side: Side) -> usize {
        self.n_cells[side.index()]
    }

    /// The cells `gained` of the part that has the rows, by how many conflicts it takes to come to them from one at an end, over cells `lost` of
    /// the other part: of sets of the first of them few neighbours are beyond.
    pub(super) fn by_distance(&self, gained: &Bits, lost: &Bits) -> Result<Vec<u32>> {
        let mut order: Vec<u32> = try_with_capacity(gained.count(), "the order of a leap")?;
        // From any cell to one as far from it as there is, and from there; what is not joined to it follows.
        let mut seed = gained.iter().next();
        for _ in 0..2 {
            order.clear();
            let (mut new, mut unseen, mut head) = (gained.clone(), lost.clone(), 0);
            while let Some(i) = seed.take().filter(|&i| new.has(i)).or_else(|| new.first_in(0..new.len())) {
                new.remove(i);
                order.push(i as u32);
                while let Some(&i) = order.get(head) {
                    head += 1;
                    for run in self.rows.iter(i as usize) {
                        while let Some(j) = unseen.first_in(run.clone()) {
                            unseen.remove(j);
                            for run in self.columns.iter(j) {
                                new.each_in(run.clone(), |i| order.push(i as u32));
                                new.remove_range(run);
                            }
                        }
                    }
                }
            }
            seed = order.last().map(|&i| i as usize);
        }
        Ok(order)
    }

    /// N(S): cells of the other part that cannot be together with those of `set`, of the part `side`.
    pub fn neighbours(&self, side: Side, set: &Bits) -> Result<Bits> {
        check_set(self, side, set)?;
        let mut found = Bits::none(self.n_cells(side.other()))?;
        let lists = if side == self.rows_of { &self.rows } else { &self.columns };
        set.iter().for_each(|i| lists.iter(i).for_each(|run| found.insert_range(run)));
        Ok(found)
    }

    /// The cells of each part that conflict with others, if parts have the cells in `room`.
    pub fn colliding(&self, room: &[Bits; 2]) -> Result<[Bits; 2]> {
        let of = |side: Side| -> Result<Bits> {
            let mut cells = self.neighbours(side.other(), &room[side.other().index()])?;
            cells.intersect(&room[side.index()]);
            Ok(cells)
        };
        Ok([of(Side::First)?, of(Side::Second)?])
    }
}

/// What the making of rows needs.
struct Making<'a, const D: usize> {
    moving: &'a Part<D>,
    still: &'a Part<D>,
    /// The motion as seen from the part that stays.
    seen: Relative<D>,
    options: &'a OverlapOptions,
    limit: Limit,
    workers: &'a Workers,
}

impl<const D: usize> Making<'_, D> {
    fn rows(&self, progress: &mut Progress<'_>) -> Result<Rows> {
        let Making { moving, still, ref seen, options, limit, workers } = *self;
        let n_rows = moving.grid().n_cells();
        let mut blocks: Vec<Block> = try_with_capacity(n_blocks(n_rows), "the conflict graph")?;
        let of = |seen: &Relative<D>, moving: &Part<D>, still: &Part<D>| {
            Swathes::new(seen, options.sampling, still.grid(), moving.grid(), options.clearance)
        };
        let (there, back) = (of(seen, moving, still)?, of(&seen.reversed(), still, moving)?);
        let make = |rows| dispatch(Overlaps { swathes: &there, moving, still, rows });
        let turned = |rows| dispatch(Overlaps { swathes: &back, moving: still, still: moving, rows });
        // What rows and columns take together, as a part of what rows take.
        let mut share = 2.0;
        if let (Some(rows), Some(columns)) = (estimate(make, moving, workers)?, estimate(turned, still, workers)?) {
            let both = rows.plus(&columns);
            if limit.is_passed_by(&both) {
                return Err(limit.refusal(both.bytes(), None));
            }
            share = both.bytes() / rows.bytes();
        }
        let mut room = Room::new(limit, n_rows);
        each_block(n_rows, workers, progress, "conflicts", make, |block| {
            room.take((share * block.bytes() as f64) as usize)?;
            blocks.push(block);
            Ok(())
        })?;
        Ok(Rows::new(blocks))
    }
}

/// Bytes that the rows of a part will take; none where these are few.
fn estimate<const D: usize>(
    make: impl Fn(Range<usize>) -> Result<Block> + Sync + Send,
    part: &Part<D>,
    workers: &Workers,
) -> Result<Option<Estimate>> {
    let runs = Estimate::of(part.allowed(), workers, |i| Ok(make(i..i + 1)?.bytes_of_runs()))?;
    Ok(runs.map(|runs| runs.and(4.0 * part.grid().n_cells() as f64)))
}

/// The rows of some cells.
struct Overlaps<'a, const D: usize> {
    swathes: &'a Swathes<D>,
    moving: &'a Part<D>,
    still: &'a Part<D>,
    rows: Range<usize>,
}

impl<const D: usize> Kernel for Overlaps<'_, D> {
    type Output = Result<Block>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Result<Block> {
        let allowed = self.still.allowed();
        let (mut block, mut marks) = (Block::new()?, Marks::new(allowed.len())?);
        for i in self.rows {
            if self.moving.allowed().has(i) {
                self.swathes.mark(self.moving.grid().center(i), &mut marks);
            }
            block.push_row(|run| marks.take_runs(allowed, run))?;
        }
        Ok(block.settled())
    }
}
