//! The lattice near the level set: the vertices of the cubes of marked blocks, row by row.
//!
//! Cubes whose corners are of both signs lie in marked blocks, and with them all cubes that hold a crossed edge: what is left out is of
//! one sign. Vertices are kept in the order of the lattice, so that what is numbered by them is numbered as on the whole lattice.

use super::blocks::{BLOCK, LatticeBlocks};
use super::cubes::Cubes;
use crate::Result;
use crate::error::try_with_capacity;
use std::ops::Range;

/// What the memory is for, should it run out.
const WORK: &str = "the lattice near the level set";

/// Kept vertices in a row, as many as up to the place of the next run.
#[derive(Clone, Copy)]
struct Run {
    /// Lattice vertex.
    first: usize,
    /// Its place among those kept.
    place: usize,
}

/// The vertices kept of a lattice.
pub(super) struct Near<const D: usize> {
    blocks: LatticeBlocks<D>,
    /// Distance in memory of lattice vertices along each axis.
    strides: [usize; D],
    /// Per row of lattice vertices along the last axis, the first of its runs; and their number.
    of_row: Vec<usize>,
    /// One more stands at the end.
    runs: Vec<Run>,
}

/// A cube with corners of both signs.
pub(super) struct Mixed<'a, const D: usize> {
    pub at: [usize; D],
    /// Bit c is set where corner c is negative; bit a of c where that is the upper one along axis a.
    pub negative: usize,
    /// Places of the corners that are lower along the last axis.
    lower: &'a [usize],
    along: usize,
}

impl<const D: usize> Mixed<'_, D> {
    /// The place of a corner among the vertices kept.
    pub fn place(&self, corner: usize) -> usize {
        let last = 1 << (D - 1);
        self.lower[corner & (last - 1)] + self.along + usize::from(corner & last != 0)
    }
}

impl<const D: usize> Near<D> {
    /// Bytes that it takes at least, blocks included.
    pub fn least_bytes(cubes: &Cubes<D>) -> u128 {
        LatticeBlocks::bytes(cubes.counts()) + (cubes.len() / cubes.shape[D - 1]) as u128 * size_of::<usize>() as u128
    }

    /// The vertices of the cubes of marked `blocks`. Before it takes memory it asks `afford(bytes, vertices)`.
    pub fn new(
        cubes: &Cubes<D>,
        blocks: LatticeBlocks<D>,
        afford: impl FnOnce(u128, usize) -> Result<()>,
    ) -> Result<Self> {
        let rows = cubes.len() / cubes.shape[D - 1];
        let (mut n_runs, mut n) = (0, 0);
        each_run(cubes, &blocks, |_, run| (n_runs, n) = (n_runs + 1, n + run.len()));
        afford(Self::least_bytes(cubes) + n_runs as u128 * size_of::<Run>() as u128, n)?;
        let (mut of_row, mut runs) = (try_with_capacity(rows + 1, WORK)?, try_with_capacity(n_runs + 1, WORK)?);
        let mut place = 0;
        each_run(cubes, &blocks, |row, run| {
            while of_row.len() <= row {
                of_row.push(runs.len());
            }
            runs.push(Run { first: run.start, place });
            place += run.len();
        });
        of_row.resize(rows + 1, runs.len());
        runs.push(Run { first: cubes.len(), place });
        Ok(Near { blocks, strides: cubes.strides, of_row, runs })
    }

    /// Vertices kept.
    pub fn len(&self) -> usize {
        self.runs[self.runs.len() - 1].place
    }

    /// Cubes of the lattice along each axis.
    pub fn counts(&self) -> [usize; D] {
        self.blocks.cubes()
    }

    /// Layers of vertices across the first axis.
    pub fn n_layers(&self) -> usize {
        self.blocks.cubes()[0] + 1
    }

    /// The places of the vertices of a layer.
    pub fn layer(&self, layer: usize) -> Range<usize> {
        let rows = (self.of_row.len() - 1) / self.n_layers();
        let place = |layer: usize| self.runs[self.of_row[layer * rows]].place;
        place(layer)..place(layer + 1)
    }

    /// The place of a vertex that is kept.
    pub fn place(&self, vertex: usize) -> usize {
        let row = vertex / self.strides[D - 2];
        let runs = &self.runs[self.of_row[row]..self.of_row[row + 1]];
        let Run { first, place } = runs[runs.partition_point(|run| run.first <= vertex) - 1];
        place + vertex - first
    }

    /// The vertices at `places`.
    pub fn vertices(&self, places: Range<usize>) -> impl Iterator<Item = usize> {
        let mut run = self.runs.partition_point(|run| run.place <= places.start) - 1;
        places.map(move |place| {
            while self.runs[run + 1].place <= place {
                run += 1;
            }
            self.runs[run].first + place - self.runs[run].place
        })
    }

    /// Calls `visit` for each cube of a layer across the first axis whose corners, of values `f` at their places, are of both signs.
    pub fn each_mixed_cube(&self, f: &[f64], layer: usize, mut visit: impl FnMut(Mixed<D>)) {
        let cubes = self.blocks.cubes();
        let (half, all) = (1_usize << (D - 1), (1_usize << (1 << D)) - 1);
        let (mut scratch, mut lower) = (Vec::new(), [0; 4]);
        let mut at = [0; D];
        at[0] = layer;
        for row in 0..if D == 3 { cubes[1] } else { 1 } {
            if D == 3 {
                at[1] = row;
            }
            let block = |x: usize| x / BLOCK..x / BLOCK + 1;
            for run in self.blocks.runs([block(layer), block(row)], &mut scratch) {
                let (first, end) = (run.start * BLOCK, (run.end * BLOCK).min(cubes[D - 1]));
                for (bits, lower) in lower[..half].iter_mut().enumerate() {
                    let beside = (0..D - 1).map(|a| (at[a] + (bits >> a & 1)) * self.strides[a]).sum::<usize>();
                    *lower = self.place(beside + first);
                }
                let lower = &lower[..half];
                let side = |k: usize| (0..half).fold(0, |bits, c| bits | usize::from(f[lower[c] + k] < 0.0) << c);
                let mut below = side(0);
                for along in 0..end - first {
                    let above = side(along + 1);
                    let negative = below | above << half;
                    below = above;
                    if negative != 0 && negative != all {
                        at[D - 1] = first + along;
                        visit(Mixed { at, negative, lower, along });
                    }
                }
            }
        }
    }
}

/// Calls `visit(row, vertices)` for each run of vertices that marked blocks keep, in the order of the lattice.
fn each_run<const D: usize>(cubes: &Cubes<D>, blocks: &LatticeBlocks<D>, mut visit: impl FnMut(usize, Range<usize>)) {
    let n = cubes.counts();
    let along = cubes.shape[D - 1];
    let mut scratch = Vec::new();
    // The blocks of the cubes on either side of a vertex.
    let beside = |x: usize, n: usize| (x.max(1) - 1) / BLOCK..x.min(n - 1) / BLOCK + 1;
    for row in 0..cubes.len() / along {
        let (i, j) = if D == 3 { (row / cubes.shape[1], row % cubes.shape[1]) } else { (row, 0) };
        for run in blocks.runs([beside(i, n[0]), beside(j, n[D - 2])], &mut scratch) {
            let end = (run.end * BLOCK).min(n[D - 1]) + 1;
            visit(row, row * along + run.start * BLOCK..row * along + end);
        }
    }
}
