//! Which blocks of the lattice a level set may go through.

use super::super::Field;
use crate::Result;
use crate::error::try_with_capacity;
use crate::par::Workers;
use crate::spline::hierarchical::{per_table, strides};
use crate::spline::hull::{self, Window};
use crate::spline::kernel::Stencil;
use crate::spline::tree::{SIDE, Tile, Tree};
use crate::spline::{Grid, place_of};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Cubes of a block along each axis. With fewer, to look at a block costs more than to evaluate in it.
pub const BLOCK: usize = 4;

/// Blocks of 4^D cubes, each marked or not. The last along an axis may have fewer cubes.
pub struct LatticeBlocks<const D: usize> {
    /// Cubes along each axis.
    cubes: [usize; D],
    /// Words of a row of blocks along the last axis, a bit a block.
    words: usize,
    bits: Vec<AtomicU64>,
}

impl<const D: usize> LatticeBlocks<D> {
    /// The blocks of a lattice with these `cubes`, none of them marked.
    pub fn new(cubes: [usize; D]) -> Result<Self> {
        let (words, rows) = size(cubes);
        let mut bits = try_with_capacity(words * rows, "the blocks of the lattice")?;
        bits.resize_with(words * rows, AtomicU64::default);
        Ok(LatticeBlocks { cubes, words, bits })
    }

    /// Bytes that they take.
    pub fn bytes(cubes: [usize; D]) -> u128 {
        let (words, rows) = size(cubes);
        8 * words as u128 * rows as u128
    }

    /// Cubes along each axis.
    pub fn cubes(&self) -> [usize; D] {
        self.cubes
    }

    /// Marks the blocks that hold cubes from `from` to before `to`; from any number of threads.
    pub fn mark(&self, from: [usize; D], to: [usize; D]) {
        let (first, end) = (from.map(|x| x / BLOCK), to.map(|x| x.div_ceil(BLOCK)));
        let mut at = first;
        while at[0] < end[0] {
            let row = self.row(&at) * self.words;
            (first[D - 1]..end[D - 1]).for_each(|k| {
                self.bits[row + k / 64].fetch_or(1 << (k % 64), Ordering::Relaxed);
            });
            // The next row: no carry but into the first axis, which ends.
            for a in (0..D - 1).rev() {
                at[a] += 1;
                if at[a] < end[a] || a == 0 {
                    break;
                }
                at[a] = first[a];
            }
        }
    }

    /// Marks all.
    pub fn mark_all(&self) {
        self.mark([0; D], self.cubes);
    }

    /// Runs of blocks along the last axis of which one at least is marked in a row of `rows`, places along the axes before the last;
    /// `scratch` is overwritten.
    pub fn runs<'a>(
        &self,
        rows: [Range<usize>; 2],
        scratch: &'a mut Vec<u64>,
    ) -> impl Iterator<Item = Range<usize>> + use<'a, D> {
        scratch.clear();
        scratch.resize(self.words, 0);
        for i in rows[0].clone() {
            for j in if D == 3 { rows[1].clone() } else { 0..1 } {
                let mut at = [0; D];
                (at[0], at[D - 2]) = if D == 3 { (i, j) } else { (i, i) };
                let row = &self.bits[self.row(&at) * self.words..][..self.words];
                scratch.iter_mut().zip(row).for_each(|(all, one)| *all |= one.load(Ordering::Relaxed));
            }
        }
        let mut from = 0;
        std::iter::from_fn(move || {
            let first = next(scratch, from, true)?;
            from = next(scratch, first, false).unwrap_or(64 * scratch.len());
            Some(first..from)
        })
    }

    /// The row that holds the block at `at`.
    fn row(&self, at: &[usize; D]) -> usize {
        (0..D - 1).fold(0, |row, a| row * self.cubes[a].div_ceil(BLOCK) + at[a])
    }
}

/// Words of a row of blocks, and rows.
fn size<const D: usize>(cubes: [usize; D]) -> (usize, usize) {
    let n = cubes.map(|n| n.div_ceil(BLOCK));
    (n[D - 1].div_ceil(64), n[..D - 1].iter().product())
}

/// The first bit from `from` on that is `set`.
fn next(words: &[u64], from: usize, set: bool) -> Option<usize> {
    let (mut w, mut mask) = (from / 64, u64::MAX << (from % 64));
    while w < words.len() {
        let bits = if set { words[w] } else { !words[w] } & mask;
        if bits != 0 {
            return Some(64 * w + bits.trailing_zeros() as usize);
        }
        (w, mask) = (w + 1, u64::MAX);
    }
    None
}

/// Values this close to the level, as a fraction of the largest control point and of the level, may be on its other side by rounding: far
/// more than what evaluations err by.
const SLACK: f64 = 1e-11;

/// Coordinates of lattice vertices are rounded: they may be this far in another cell, in units of rounding of the box's own coordinates.
const ASIDE: f64 = 64.0 * f64::EPSILON;

/// Where coordinates are off by more cells than this, nothing can be said of a cell. Less changes values by its cube, since splines are C2.
const MOST_ASIDE: f64 = 1e-4;

impl<const D: usize> Field<D> {
    /// Marks the blocks of a lattice on this field's box, of a whole number of cubes a cell of its grid, in which phi may be `level`. In a
    /// cell phi lies between its control points, in a part of it between its Bezier points there: what is left out is far from the level.
    /// Where evaluations err, they do so by less than what is taken off for that.
    ///
    /// `tell` is told the fraction of cells that were looked at, and may stop.
    pub(in crate::field) fn mark_level(
        &self,
        level: f64,
        blocks: &LatticeBlocks<D>,
        workers: &Workers,
        tell: &mut dyn FnMut(f64) -> Result<()>,
    ) -> Result<()> {
        let all = self.refined.as_ref().map_or(&self.coefficients[..], |r| r.tables());
        let size = all.iter().fold(level.abs(), |m, c| if c.abs() > m { c.abs() } else { m });
        let (grid, cubes) = (&self.grid, blocks.cubes());
        let depth = self.refined.as_ref().map_or(1, |r| r.tree().n_levels()) - 1;
        let aside = std::array::from_fn(|a| {
            let axis = grid.axes[a];
            ASIDE * axis.lower.abs().max(axis.upper().abs()) / axis.cell * (1u64 << depth) as f64
        });
        if aside.iter().any(|x: &f64| x.is_nan() || *x > MOST_ASIDE) {
            blocks.mark_all();
            return Ok(());
        }
        let per_cell = std::array::from_fn(|a| cubes[a] / grid.axes[a].n_cells);
        let search = Search { level, slack: SLACK * size, aside, per_cell, blocks };
        match &self.refined {
            None => {
                let n = grid.n_cells();
                let n_lines = n[..D - 1].iter().product();
                by_rounds(n_lines, ROUND.div_ceil(n[D - 1]), tell, |lines| {
                    workers.for_each(lines, |line| search.line(grid, line, &self.coefficients));
                })
            }
            Some(refined) => {
                let (tree, tables) = (refined.tree(), refined.tables());
                by_rounds(tree.tiles().len(), ROUND / SIDE.pow(D as u32), tell, |tiles| {
                    workers.for_each(tiles, |t| {
                        let n = per_table::<D>();
                        search.tile(tree, &tree.tiles()[t], &tables[t * n..(t + 1) * n]);
                    });
                })
            }
        }
    }
}

/// Cells that are looked at between two words of progress, about.
const ROUND: usize = 1 << 17;

/// Works on `n` items, some at a time, and tells how many are done.
fn by_rounds(
    n: usize,
    round: usize,
    tell: &mut dyn FnMut(f64) -> Result<()>,
    work: impl Fn(Range<usize>),
) -> Result<()> {
    for first in (0..n).step_by(round) {
        tell(first as f64 / n as f64)?;
        work(first..n.min(first + round));
    }
    Ok(())
}

/// The search for blocks that the level set may go through.
struct Search<'a, const D: usize> {
    level: f64,
    slack: f64,
    /// In the shortest cells.
    aside: [f64; D],
    /// Cubes of a cell of the grid along each axis.
    per_cell: [usize; D],
    blocks: &'a LatticeBlocks<D>,
}

impl<const D: usize> Search<'_, D> {
    /// Marks blocks of the cells of a grid along the last axis, on line `line` of those.
    fn line(&self, grid: &Grid<D>, line: usize, coefficients: &[f64]) {
        let n = grid.n_cells();
        let strides: [usize; D] = std::array::from_fn(|a| grid.shape()[a + 1..].iter().product());
        let mut place = place_of(line, std::array::from_fn(|a| if a == D - 1 { 1 } else { n[a] }));
        let first = (0..D).map(|a| place[a] * strides[a]).sum::<usize>();
        for k in 0..n[D - 1] {
            place[D - 1] = k;
            self.cell(0, place, &Stencil { first: first + k, strides }, coefficients);
        }
    }

    /// Marks blocks of the cells of a tile, if it is a leaf with some.
    fn tile(&self, tree: &Tree<D>, tile: &Tile<D>, table: &[f64]) {
        if !tile.is_leaf() || !tree.holds(tile) {
            return;
        }
        let (n, strides) = (tree.cells(tile), strides::<D>());
        for i in 0..n.iter().product() {
            let within = place_of(i, n);
            let first = (0..D).map(|a| within[a] * strides[a]).sum();
            let place = std::array::from_fn(|a| SIDE * tile.place[a] as usize + within[a]);
            self.cell(tile.level, place, &Stencil { first, strides }, table);
        }
    }

    /// Marks blocks of the cell at `place` of the cells 2^`depth` times as short as the grid's.
    fn cell(&self, depth: u32, place: [usize; D], stencil: &Stencil<D>, coefficients: &[f64]) {
        let window = hull::window(stencil, coefficients);
        if self.reaches(&window) {
            let from: [usize; D] = std::array::from_fn(|a| ((place[a] * self.per_cell[a]) >> depth) / BLOCK);
            let to = std::array::from_fn(|a| {
                ((place[a] + 1) * self.per_cell[a]).div_ceil(BLOCK << depth).min(self.blocks.cubes[a].div_ceil(BLOCK))
            });
            self.part(&window, depth, place, from, to);
        }
    }

    /// Marks those of the blocks from `from` to before `to`, as far as they are in the cell.
    fn part(&self, window: &Window, depth: u32, place: [usize; D], from: [usize; D], to: [usize; D]) {
        let part: [_; D] = std::array::from_fn(|a| {
            // In cells from the cell's lower face on.
            let at = |block: usize| {
                (((BLOCK * block) << depth) as i64 - (place[a] * self.per_cell[a]) as i64) as f64
                    / self.per_cell[a] as f64
            };
            [at(from[a]).max(0.0) - self.aside[a], at(to[a]).min(1.0) + self.aside[a]]
        });
        if !self.reaches(&hull::bezier(window, &part)) {
            return;
        }
        if (0..D).all(|a| to[a] - from[a] == 1) {
            return self.blocks.mark(from.map(|x| x * BLOCK), to.map(|x| x * BLOCK));
        }
        for half in 0..1_usize << D {
            let middle = |a: usize| from[a] + (to[a] - from[a]).div_ceil(2);
            let lower = |a: usize| half >> a & 1 == 0;
            let first: [usize; D] = std::array::from_fn(|a| if lower(a) { from[a] } else { middle(a) });
            let end: [usize; D] = std::array::from_fn(|a| if lower(a) { middle(a) } else { to[a] });
            if (0..D).all(|a| first[a] < end[a]) {
                self.part(window, depth, place, first, end);
            }
        }
    }

    /// Whether what lies between the numbers of a window may take the level.
    fn reaches(&self, window: &Window) -> bool {
        let (low, high) = hull::range::<D>(window);
        low - self.slack <= self.level && self.level <= high + self.slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends<const D: usize>(blocks: &LatticeBlocks<D>, rows: [Range<usize>; 2]) -> Vec<(usize, usize)> {
        blocks.runs(rows, &mut Vec::new()).map(|run| (run.start, run.end)).collect()
    }

    #[test]
    fn runs_are_what_is_marked() {
        let blocks = LatticeBlocks::new([9, 5, 4 * 130]).unwrap();
        let runs = |rows| ends(&blocks, rows);
        assert!(runs([0..3, 0..2]).is_empty());
        blocks.mark([8, 0, 0], [9, 1, 5]);
        blocks.mark([0, 4, 4 * 62], [8, 5, 4 * 65]);
        assert_eq!(runs([2..3, 0..1]), [(0, 2)]);
        assert_eq!(runs([1..2, 1..2]), [(62, 65)]);
        assert_eq!(runs([1..3, 0..2]), [(0, 2), (62, 65)]);
        blocks.mark([0, 0, 4 * 129 + 1], [1, 1, 4 * 130]);
        assert_eq!(runs([0..1, 0..1]), [(129, 130)]);
        blocks.mark_all();
        assert_eq!(runs([0..1, 0..1]), [(0, 130)]);
        let plane = LatticeBlocks::new([2, 300]).unwrap();
        plane.mark([1, 280], [2, 281]);
        assert_eq!(ends(&plane, [0..1, 0..1]), [(70, 71)]);
    }
}
