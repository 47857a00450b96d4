//! Hierarchical B-splines on the cells of a [`Tree`]: splines of short cells where the tree is cut, of long ones elsewhere, C2 throughout.
//!
//! W_l, the domain of level l, is what its tiles cover. A function of level l is *active*, and has a control point, where its support, as
//! far as it lies in the box, is in W_l but not all of it in W_{l+1}: the basis of Kraft 1997. A spline of the space is the sum over all
//! levels.
//!
//! In a tile of level l the spline is one of that level: its control points there are those of level l - 1, on the finer knots, and the
//! level's own: [`Space::accumulate`].
//!
//! Functions are kept in *packs* of 4^D: those whose last cell lies in the same tile. So those of a tile's cells are parts of 2^D packs. A
//! function is numbered in its level as control points of a grid are: those of cell i are i .. i + 3.

use super::tree::{SIDE, Tree, in_tile};
use crate::Result;
use crate::error::{try_reserve, try_reserve_entry, try_vec, try_with_capacity};
use crate::par::Workers;
use std::collections::HashMap;
use std::ops::Range;

/// Functions of a tile along an axis.
pub const SPAN: usize = SIDE + 3;

/// Numbers of a row of functions of a tile: one more, which is 0, so that rows are vectors.
pub const ROW: usize = 8;

/// No pack, or no tile.
const NONE: u32 = u32::MAX;

/// What the memory is for, should it run out.
const WHAT: &str = "the functions of a hierarchy";

/// Packs that an item of work has.
const CHUNK: usize = 64;

/// Functions of a pack.
pub const fn per_pack<const D: usize>() -> usize {
    SIDE.pow(D as u32)
}

/// Numbers of a tile's functions with the surplus of rows: SPAN^(D-1) rows.
pub const fn per_table<const D: usize>() -> usize {
    SPAN.pow(D as u32 - 1) * ROW
}

/// Strides of such a table.
pub fn strides<const D: usize>() -> [usize; D] {
    let mut strides = [1; D];
    for a in (0..D - 1).rev() {
        strides[a] = if a + 2 == D { ROW } else { SPAN * strides[a + 1] };
    }
    strides
}

/// The largest table.
pub const LARGEST_TABLE: usize = per_table::<3>();

/// What belongs to a pack.
#[derive(Debug, Clone, Copy)]
struct Pack {
    /// Tiles that it has functions of, by bits of the place beside it: 1 for the tile before along an axis.
    tiles: [u32; 8],
    /// Packs of the coarser level with the functions that its own are parts of, by bits: 1 for the next along an axis.
    coarse: [u32; 8],
    /// Packs of the finer level with parts of its functions: those at twice its place and beside, -1 .. 1 along an axis.
    fine: [u32; 27],
    /// Bits of 2s and 1s along each axis: whether it stands at an odd place.
    odd: u8,
    /// Functions that are active.
    active: u64,
}

/// The functions of a tree.
pub struct Space<const D: usize> {
    /// Packs of each level.
    levels: Vec<Range<usize>>,
    packs: Vec<Pack>,
    /// Packs of each tile, by bits: 1 for the next along an axis.
    of_tile: Vec<[u32; 8]>,
    numbers: HashMap<(u32, [u32; D]), u32>,
}

/// Bit of axis `a` in `bits`.
fn bit<const D: usize>(bits: usize, a: usize) -> usize {
    bits >> (D - 1 - a) & 1
}

impl<const D: usize> Space<D> {
    /// The functions of `tree`.
    pub fn new(tree: &Tree<D>) -> Result<Self> {
        let n = tree.tiles().len();
        let mut space = Space {
            levels: Vec::new(),
            packs: try_with_capacity(2 * n, WHAT)?,
            of_tile: try_vec(n, [NONE; 8], WHAT)?,
            numbers: HashMap::new(),
        };
        for level in 0..tree.n_levels() {
            let first = space.packs.len();
            for (i, tile) in tree.tiles().iter().enumerate().filter(|(_, t)| t.level == level && tree.holds(t)) {
                for bits in 0..1 << D {
                    let pack =
                        space.number(level, std::array::from_fn(|a| tile.place[a] + bit::<D>(bits, a) as u32))?;
                    space.of_tile[i][bits] = pack;
                    space.packs[pack as usize].tiles[bits] = i as u32;
                }
            }
            space.levels.push(first..space.packs.len());
        }
        space.connect();
        space.activate(tree);
        Ok(space)
    }

    /// The number of the pack at `place` of `level`, which is made where there is none.
    fn number(&mut self, level: u32, place: [u32; D]) -> Result<u32> {
        try_reserve_entry(&mut self.numbers, WHAT)?;
        try_reserve(&mut self.packs, 1, WHAT)?;
        Ok(*self.numbers.entry((level, place)).or_insert_with(|| {
            let none = Pack { tiles: [NONE; 8], coarse: [NONE; 8], fine: [NONE; 27], odd: 0, active: 0 };
            self.packs.push(none);
            self.packs.len() as u32 - 1
        }))
    }

    /// Tells packs of those of the levels beside.
    fn connect(&mut self) {
        for (&(level, place), &number) in &self.numbers {
            if level == 0 {
                continue;
            }
            let pack = number as usize;
            for bits in 0..1_usize << D {
                // Functions 2 t .. 2 t + 3 of the coarser level: for an even place t one pack, for an odd one two.
                if (0..D).any(|a| bit::<D>(bits, a) == 1 && place[a] % 2 == 0) {
                    continue;
                }
                let at = std::array::from_fn(|a| place[a] / 2 + bit::<D>(bits, a) as u32);
                let Some(&coarse) = self.numbers.get(&(level - 1, at)) else { continue };
                let beside = (0..D).fold(0, |b, a| 3 * b + (1 + place[a] as usize - 2 * at[a] as usize));
                self.packs[coarse as usize].fine[beside] = number;
                self.packs[pack].coarse[bits] = coarse;
            }
            self.packs[pack].odd = (0..D).fold(0, |odd, a| 2 * odd + (place[a] % 2) as u8);
        }
    }

    /// Tells which functions are active.
    fn activate(&mut self, tree: &Tree<D>) {
        for (&(level, place), &number) in &self.numbers {
            let pack = &mut self.packs[number as usize];
            // Whether a function's support is in the tile before, and in its own: by its place in the pack.
            let needs: [[Option<[bool; 2]>; SIDE]; D] = std::array::from_fn(|a| {
                let n = tree.n_cells(level, a);
                std::array::from_fn(|o| {
                    let (t, f) = (place[a] as usize, SIDE * place[a] as usize + o);
                    let (first, last) = (f.saturating_sub(3) / SIDE, f.min(n - 1) / SIDE);
                    (f < n + 3).then_some([last >= t && first <= t, first < t])
                })
            });
            for f in 0..per_pack::<D>() {
                let offset = in_tile::<D>(f);
                let (mut served, mut replaced) = (true, true);
                for bits in 0..1_usize << D {
                    let needed = (0..D).try_fold(true, |all, a| Some(all && needs[a][offset[a]]?[bit::<D>(bits, a)]));
                    match (needed, pack.tiles[bits]) {
                        (Some(false), _) => {}
                        (None, _) | (_, NONE) => served = false,
                        (_, tile) => replaced &= !tree.tiles()[tile as usize].is_leaf(),
                    }
                }
                pack.active |= u64::from(served && !replaced) << f;
            }
        }
    }

    /// Numbers of a vector of control points: 4^D a pack, those that are not active included.
    pub fn n_numbers(&self) -> usize {
        self.packs.len() * per_pack::<D>()
    }

    /// Bytes that the numbers of packs take.
    pub fn bytes(&self) -> u64 {
        let number = size_of::<((u32, [u32; D]), u32)>() + 1;
        // A map keeps up to twice the room that it needs.
        (self.packs.len() * (size_of::<Pack>() + 2 * number) + self.of_tile.len() * size_of::<[u32; 8]>()) as u64
    }

    /// Active functions: the dimension of the space.
    pub fn n_active(&self) -> usize {
        self.packs.iter().map(|p| p.active.count_ones() as usize).sum()
    }

    /// Place in a vector of function `f` of `level`, where a tile has it.
    #[cfg(test)]
    pub fn index(&self, level: u32, f: [usize; D]) -> Option<usize> {
        let number = self.numbers.get(&(level, f.map(|f| (f / SIDE) as u32)))?;
        Some(f.iter().fold(*number as usize, |at, f| SIDE * at + f % SIDE))
    }

    /// Sets to 0 what is not active.
    pub fn keep_active(&self, x: &mut [f64]) {
        for (x, pack) in x.chunks_exact_mut(per_pack::<D>()).zip(&self.packs) {
            if pack.active.count_ones() as usize != x.len() {
                x.iter_mut().enumerate().filter(|(f, _)| pack.active >> f & 1 == 0).for_each(|(_, x)| *x = 0.0);
            }
        }
    }

    /// The entries of active functions, in order.
    pub fn active<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let packs = x.chunks_exact(per_pack::<D>()).zip(&self.packs);
        packs.flat_map(|(x, pack)| x.iter().enumerate().filter(|(f, _)| pack.active >> f & 1 == 1).map(|(_, x)| *x))
    }

    /// The vector of which those are `entries`, as many as functions are active.
    pub fn with_active(&self, mut entries: impl Iterator<Item = f64>) -> Result<Vec<f64>> {
        let mut x = try_vec(self.n_numbers(), 0.0, "the control points")?;
        for (x, pack) in x.chunks_exact_mut(per_pack::<D>()).zip(&self.packs) {
            let active = x.iter_mut().enumerate().filter(|(f, _)| pack.active >> f & 1 == 1);
            active.zip(&mut entries).for_each(|((_, x), entry)| *x = entry);
        }
        Ok(x)
    }

    /// The vector of the row-major `control_points` on a grid of `shape`, of which none of the cells is cut.
    pub fn of_grid(&self, shape: [usize; D], control_points: &[f64]) -> Result<Vec<f64>> {
        let mut x = try_vec(self.n_numbers(), 0.0, "the control points")?;
        self.for_grid(shape, |number, at| x[number] = control_points[at]);
        Ok(x)
    }

    /// The control points of level 0 in `x`, row-major on the grid of `shape`.
    pub fn on_grid(&self, shape: [usize; D], x: &[f64]) -> Result<Vec<f64>> {
        let mut control_points = try_vec(shape.iter().product(), 0.0, "the control points")?;
        self.for_grid(shape, |number, at| control_points[at] = x[number]);
        Ok(control_points)
    }

    /// Calls `pair(place in a vector, row-major place)` for the functions of level 0 on a grid of `shape` control points.
    fn for_grid(&self, shape: [usize; D], mut pair: impl FnMut(usize, usize)) {
        let n = per_pack::<D>();
        for (&(_, place), &number) in self.numbers.iter().filter(|((level, _), _)| *level == 0) {
            for f in 0..n {
                let offset = in_tile::<D>(f);
                let at: [usize; D] = std::array::from_fn(|a| SIDE * place[a] as usize + offset[a]);
                if (0..D).all(|a| at[a] < shape[a]) {
                    pair(number as usize * n + f, (0..D).fold(0, |i, a| i * shape[a] + at[a]));
                }
            }
        }
    }

    /// Control points of this space for the spline that `x` is in `other`, of the same tree when less of it was cut.
    pub fn take_over(&self, other: &Self, x: &[f64], workers: &Workers) -> Result<Vec<f64>> {
        let mut mine = try_vec(self.n_numbers(), 0.0, "the control points")?;
        let n = per_pack::<D>();
        for (place, &theirs) in &other.numbers {
            if let Some(&number) = self.numbers.get(place) {
                mine[number as usize * n..][..n].copy_from_slice(&x[theirs as usize * n..][..n]);
            }
        }
        // What is active no longer is a sum of functions of the next level.
        for level in 1..self.levels.len() {
            self.prolong(workers, level, &mut mine, |active| !active);
        }
        self.keep_active(&mut mine);
        Ok(mine)
    }

    /// The functions of tile `tile` into a table.
    #[inline(always)]
    pub fn gather(&self, tile: usize, x: &[f64], table: &mut [f64]) {
        for (bits, pack) in self.of_tile[tile].iter().enumerate().take(1 << D) {
            let x = &x[*pack as usize * per_pack::<D>()..][..per_pack::<D>()];
            for_rows::<D>(bits, |in_pack, in_table, n| {
                table[in_table..in_table + n].copy_from_slice(&x[in_pack..in_pack + n]);
            });
        }
    }

    /// x of what is not yet summed: for each pack the sums over the tables `[tiles][table]` of the tiles for which `counts` is true.
    pub fn sum_tables(&self, workers: &Workers, tables: &[f64], counts: impl Fn(usize) -> bool + Sync, x: &mut [f64]) {
        let n = per_pack::<D>();
        workers.for_each(x.chunks_mut(CHUNK * n).zip(self.packs.chunks(CHUNK)), |(x, packs)| {
            for (x, pack) in x.chunks_exact_mut(n).zip(packs) {
                x.fill(0.0);
                for (bits, &tile) in pack.tiles.iter().enumerate() {
                    if tile == NONE || !counts(tile as usize) {
                        continue;
                    }
                    let table = &tables[tile as usize * per_table::<D>()..][..per_table::<D>()];
                    for_rows::<D>(bits, |in_pack, in_table, n| {
                        let from = &table[in_table..in_table + n];
                        x[in_pack..in_pack + n].iter_mut().zip(from).for_each(|(x, t)| *x += t);
                    });
                }
            }
        });
    }

    /// Adds to the control points of each level those that make the coarser levels' spline on its knots. Where functions of no tile stand,
    /// numbers without meaning come out.
    pub fn accumulate(&self, workers: &Workers, x: &mut [f64]) {
        for level in 1..self.levels.len() {
            self.prolong(workers, level, x, |_| u64::MAX);
        }
    }

    /// Adds to `level` what the functions of the coarser level are on its knots, those that `taken` lets through of the active ones.
    fn prolong(&self, workers: &Workers, level: usize, x: &mut [f64], taken: impl Fn(u64) -> u64 + Sync) {
        let (n, level) = (per_pack::<D>(), self.levels[level].clone());
        let (coarser, x) = x.split_at_mut(level.start * n);
        let x = &mut x[..level.len() * n];
        workers.for_each(x.chunks_mut(CHUNK * n).zip(self.packs[level].chunks(CHUNK)), |(x, packs)| {
            for (x, pack) in x.chunks_exact_mut(n).zip(packs) {
                let mut window = [0.0; 64];
                for (bits, &coarse) in pack.coarse.iter().enumerate().filter(|(_, p)| **p != NONE) {
                    let from = &coarser[coarse as usize * n..][..n];
                    match taken(self.packs[coarse as usize].active) {
                        u64::MAX => for_window::<D>(pack.odd, bits, |own, other| window[own] = from[other]),
                        some => for_window::<D>(pack.odd, bits, |own, other| {
                            window[own] = if some >> other & 1 == 1 { from[other] } else { 0.0 };
                        }),
                    }
                }
                let window = &mut window[..n];
                for a in 0..D {
                    along::<D>(a, window, |[c0, c1, c2, c3]| {
                        [0.5 * (c0 + c1), 0.125 * (c0 + c2) + 0.75 * c1, 0.5 * (c1 + c2), 0.125 * (c1 + c3) + 0.75 * c2]
                    });
                }
                x.iter_mut().zip(&*window).for_each(|(x, w)| *x += w);
            }
        });
    }

    /// The transpose of [`Space::accumulate`], then 0 for what is not active. `scratch` is as long as `x`.
    pub fn restrict(&self, workers: &Workers, x: &mut [f64], scratch: &mut [f64]) {
        let n = per_pack::<D>();
        for l in (1..self.levels.len()).rev() {
            let (fine, coarse) = (self.levels[l].clone(), self.levels[l - 1].clone());
            let (x, finer) = x.split_at_mut(fine.start * n);
            let parts = &mut scratch[fine.start * n..fine.end * n];
            let finer = &finer[..fine.len() * n];
            workers.for_each(parts.chunks_mut(CHUNK * n).zip(finer.chunks(CHUNK * n)), |(parts, finer)| {
                parts.copy_from_slice(finer);
                for part in parts.chunks_exact_mut(n) {
                    for a in 0..D {
                        along::<D>(a, part, |[f0, f1, f2, f3]| {
                            [
                                0.5 * f0 + 0.125 * f1,
                                0.5 * (f0 + f2) + 0.75 * f1 + 0.125 * f3,
                                0.125 * f1 + 0.5 * f2 + 0.75 * f3,
                                0.125 * f3,
                            ]
                        });
                    }
                }
            });
            let x = &mut x[coarse.start * n..];
            let parts = &scratch[fine.start * n..fine.end * n];
            workers.for_each(x.chunks_mut(CHUNK * n).zip(self.packs[coarse].chunks(CHUNK)), |(x, packs)| {
                for (x, pack) in x.chunks_exact_mut(n).zip(packs) {
                    for (beside, &number) in pack.fine.iter().enumerate().filter(|(_, p)| **p != NONE) {
                        let part = &parts[(number as usize - fine.start) * n..][..n];
                        // At an odd place its coarse functions begin in the middle of a pack: of this one, or of the one before.
                        let place = |a: usize| beside / 3_usize.pow((D - 1 - a) as u32) % 3;
                        let odd = (0..D).fold(0, |odd, a| 2 * odd + u8::from(place(a) != 1));
                        let bits = (0..D).fold(0, |bits, a| 2 * bits + usize::from(place(a) == 0));
                        for_window::<D>(odd, bits, |own, other| x[other] += part[own]);
                    }
                }
            });
        }
        self.keep_active(x);
    }
}

/// Calls `row(place in the pack, place in the table, numbers)` for the rows of a tile's functions that are in the pack beside it at `bits`.
#[inline(always)]
fn for_rows<const D: usize>(bits: usize, mut row: impl FnMut(usize, usize, usize)) {
    let count = |a: usize| if bit::<D>(bits, a) == 1 { SPAN - SIDE } else { SIDE };
    let first = |a: usize| SIDE * bit::<D>(bits, a);
    let nx = if D == 3 { count(0) } else { 1 };
    for i in 0..nx {
        for j in 0..count(D - 2) {
            let before = if D == 3 { SPAN * (first(0) + i) } else { 0 };
            row((SIDE * i + j) * SIDE, (before + first(D - 2) + j) * ROW + first(D - 1), count(D - 1));
        }
    }
}

/// Calls `pair(place in the window, place in the pack)` for the part of a window of 4^D coarse functions that is in the pack at `bits`: a
/// window begins with a pack, or along the axes of which the bit is set in `odd`, in the middle of one.
#[inline(always)]
fn for_window<const D: usize>(odd: u8, bits: usize, mut pair: impl FnMut(usize, usize)) {
    // Along an axis: the first in the window, the first in the pack, how many.
    let range: [[usize; 3]; D] = std::array::from_fn(|a| match (bit::<D>(odd as usize, a), bit::<D>(bits, a)) {
        (0, _) => [0, 0, SIDE],
        (_, 0) => [0, 2, 2],
        _ => [2, 0, 2],
    });
    let [y, z] = [range[D - 2], range[D - 1]];
    let x = if D == 3 { range[0] } else { [0, 0, 1] };
    for i in 0..x[2] {
        for j in 0..y[2] {
            for k in 0..z[2] {
                let at = |of: usize| ((x[of] + i) * SIDE + y[of] + j) * SIDE + z[of] + k;
                pair(at(0), at(1));
            }
        }
    }
}

/// Replaces the lines of four along axis `a` of a cube of 4^D numbers.
#[inline(always)]
fn along<const D: usize>(a: usize, x: &mut [f64], line: impl Fn([f64; 4]) -> [f64; 4]) {
    let stride = SIDE.pow((D - 1 - a) as u32);
    for block in x.chunks_exact_mut(SIDE * stride) {
        for s in 0..stride {
            let out = line(std::array::from_fn(|k| block[s + k * stride]));
            out.iter().enumerate().for_each(|(k, o)| block[s + k * stride] = *o);
        }
    }
}
