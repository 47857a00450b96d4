//! Pairs of sets of cells that never collide: what `ko_pair` makes.

use super::cells::{put, read_set};
use super::guard::guard;
use super::pair::{Coupled, Graph, ko_pair};
use super::pair_options::{ko_family_options, side};
use super::pointer::{array, array_mut, array_or_none, check_wanted_place, object, tell, wanted};
use super::progress::listener;
use crate::Result;
use crate::cogen::weights::{MOST_OF_CUT, MOST_OF_FAMILY};
use crate::cogen::{Bits, CellWeights, Pair, Side, Weights, close, cut, family, larger};
use crate::dimension::in_its_dimension;
use crate::progress::Progress;

impl<const D: usize> Coupled<D> {
    /// The pair that one gets by keeping one of `sets`.
    fn closed(&self, sets: [&Bits; 2], from: Option<Side>) -> Result<Pair> {
        let Graph { conflicts, room, .. } = self.graph()?;
        let from = from.unwrap_or_else(|| larger(self.parts.each_ref().map(|part| part.grid().measure()), sets));
        close(conflicts, room, from, sets[from.index()])
    }

    /// Areas or volumes of what is left of both parts' colliding cells, and gamma.
    pub(super) fn volumes(&self, pair: &Pair) -> Result<([f64; 2], f64)> {
        let counts = pair.count_some(&self.graph()?.colliding);
        let volumes = [0, 1].map(|k| counts[k] as f64 * self.parts[k].grid().measure());
        Ok((volumes, volumes[1] / (volumes[0] + volumes[1])))
    }

    /// Weights of all cells: those given, or areas and volumes.
    pub(super) fn weights(&self, given: [Option<&[f64]>; 2], most: u64) -> Result<CellWeights<2>> {
        let of = |k: usize| {
            let grid = self.parts[k].grid();
            given[k].map_or(Weights::Even { weight: grid.measure(), n_cells: grid.n_cells() }, Weights::Each)
        };
        CellWeights::new([of(0), of(1)], most)
    }
}

/// Writes both sets.
pub(super) fn put_pair(pair: &Pair, outs: [&mut [u8]; 2]) {
    pair.cells.iter().zip(outs).for_each(|(set, to)| put(set, to));
}

/// The arrays that a pair goes to.
///
/// # Safety
/// Both are NULL or arrays of these lengths that no one else uses during `'a`.
pub(super) unsafe fn outputs<'a>(one: *mut u8, n_1: usize, two: *mut u8, n_2: usize) -> Result<[&'a mut [u8]; 2]> {
    // SAFETY: the caller's promise.
    unsafe { Ok([array_mut(one, n_1, "cells_1")?, array_mut(two, n_2, "cells_2")?]) }
}

/// Tells of the sets `set_1` [n_1] and `set_2` [n_2], whatever they are, the areas or volumes `volumes` [2] of what is left of the colliding
/// cells, `*gamma` = V_2 / (V_1 + V_2) as in (37d) of Morris and Behandish 2022, NaN where nothing is left, and `*n_lost`, the cells of part 2
/// in its set that conflict with cells of part 1 in its: 0 of a pair that never collides. Each output may be NULL.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, an entry that is not 0 or 1. Threads: any number
/// at once. Cost: a pass over the edges of part 1's set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_volumes(
    pair: *const ko_pair,
    set_1: *const u8,
    n_1: usize,
    set_2: *const u8,
    n_2: usize,
    volumes: *mut f64,
    gamma: *mut f64,
    n_lost: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair, sets and NULL or arrays of these lengths.
        let (ko_pair(pair), one, two, to) = unsafe {
            (
                object(pair, "pair")?,
                read_set(set_1, n_1, "set_1")?,
                read_set(set_2, n_2, "set_2")?,
                wanted(volumes, 2, "volumes")?,
            )
        };
        check_wanted_place(gamma, "gamma")?;
        check_wanted_place(n_lost, "n_lost")?;
        in_its_dimension!(pair, pair => {
            pair.check(n_1, n_2)?;
            let sets = Pair { cells: [one, two] };
            let (found, reached) = pair.volumes(&sets)?;
            let mut lost = pair.graph()?.conflicts.neighbours(Side::First, &sets.cells[0])?;
            lost.intersect(&sets.cells[1]);
            if let Some(to) = to {
                to.copy_from_slice(&found);
            }
            // SAFETY: the header asks for NULL or places to write.
            unsafe {
                tell(gamma, reached)?;
                tell(n_lost, lost.count())
            }
        })
    })
}

/// Closes a pair: from any sets to one that never collides and cannot grow, `cells_1` [n_1] and `cells_2` [n_2]; `*gamma`, which may be NULL, is
/// what it reached, as `ko_pair_volumes` tells.
///
/// `from` is the part whose set is kept as far as the other's frozen cells let it, 1 or 2; 0: that with the larger area or volume. With A_i the
/// cells that part i may have beside the frozen ones of the other, and N(.) the cells in conflict: from part 1, S_2 = A_2 \ N(S_1), then S_1 =
/// A_1 \ N(S_2); maximal pairs of Definition 2 of Morris and Behandish 2022. With all of part 1 and from 1 it is the unsweep, gamma = 0; all of
/// part 2 and from 2 give gamma = 1. `set_1` [n_1] and `set_2` [n_2] are sets; that of the part that one does not begin with may be NULL, unless
/// `from` is 0. Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, an entry that is not 0 or 1, another
/// `from`; KO_ERR_OUT_OF_MEMORY. Threads: any number at once. Cost: two passes over the edges.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_close(
    pair: *const ko_pair,
    set_1: *const u8,
    set_2: *const u8,
    from: u32,
    n_1: usize,
    n_2: usize,
    cells_1: *mut u8,
    cells_2: *mut u8,
    gamma: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair and arrays of these lengths.
        let (ko_pair(pair), outs) = unsafe { (object(pair, "pair")?, outputs(cells_1, n_1, cells_2, n_2)?) };
        check_wanted_place(gamma, "gamma")?;
        let from = side("from", from)?;
        // What is not begun with does not count.
        let read = |set: *const u8, n: usize, name: &str, own: Side| {
            if from.is_some_and(|from| from != own) {
                return Bits::none(n);
            }
            // SAFETY: the header asks for a set of this length.
            unsafe { read_set(set, n, name) }
        };
        in_its_dimension!(pair, pair => {
            pair.check(n_1, n_2)?;
            let sets = [read(set_1, n_1, "set_1", Side::First)?, read(set_2, n_2, "set_2", Side::Second)?];
            let closed = pair.closed(sets.each_ref(), from)?;
            let (_, reached) = pair.volumes(&closed)?;
            put_pair(&closed, outs);
            // SAFETY: the header asks for NULL or a place to write.
            unsafe { tell(gamma, reached) }
        })
    })
}

/// Finds the pair of the greatest weight among all that never collide, `cells_1` [n_1] and `cells_2` [n_2]: a minimum cut of the conflict graph,
/// which is globally optimal. It is maximal too.
///
/// `weights_1` [n_1] and `weights_2` [n_2], at least 0, are what cells count for, such as an outside objective's sensitivities; NULL: the cell's
/// area or volume. `*weight` is the pair's, and `*bound`, all cells' less the flow that meets the cut, what no pair weighs more than: the same,
/// which is the proof. Either may be NULL. Weights that are multiples of a common unit, down to 1/64 of the smallest, are taken as they are;
/// others are rounded up to multiples of 2^-40 of their sum. `*gamma`, which may be NULL, is what the pair reached, by volume, as
/// `ko_pair_volumes` tells. Of several best pairs it is always the same.
/// `options` NULL: the defaults; `gap` does not count. With symmetries it is the best of the pairs that all maps carry onto themselves; the graph is
/// folded by them anew in each call, by a pass over its edges for each map, and in the memory of a graph of orbits.
/// Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, a weight that is below 0 or not finite, naming
/// the first, a map that carries a cell onto none or a conflict onto none, naming them, and a frozen cell onto one that its part may not have; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; the call takes one; `progress` is called on it. Cost: some
/// seconds for 160,000 cells a part and 2 10^7 edges, two gears; a few numbers a cell and a flow between two.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_cut(
    pair: *const ko_pair,
    weights_1: *const f64,
    weights_2: *const f64,
    options: *const ko_family_options,
    n_1: usize,
    n_2: usize,
    cells_1: *mut u8,
    cells_2: *mut u8,
    weight: *mut f64,
    bound: *mut f64,
    gamma: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair, NULL or initialised options, and arrays of these lengths.
        let (ko_pair(pair), options, given, outs) = unsafe {
            (
                object(pair, "pair")?,
                ko_family_options::read(options)?,
                [array_or_none(weights_1, n_1, "weights_1")?, array_or_none(weights_2, n_2, "weights_2")?],
                outputs(cells_1, n_1, cells_2, n_2)?,
            )
        };
        check_wanted_place(weight, "weight")?;
        check_wanted_place(bound, "bound")?;
        check_wanted_place(gamma, "gamma")?;
        // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
        let mut told = unsafe { listener(options.progress, options.progress_data) };
        in_its_dimension!(pair, pair => {
            pair.check(n_1, n_2)?;
            let Graph { conflicts, room, .. } = pair.graph()?;
            let weights = pair.weights(given, MOST_OF_CUT)?;
            let progress = &mut Progress::new(&mut told);
            // SAFETY: the header asks for initialised options, with as many symmetries as they say.
            let found = match unsafe { options.folded(pair.grids(), conflicts, progress) }? {
                Some(folded) => folded.cut(room, pair.frozen(), weights.units(), progress)?,
                None => cut(conflicts, room, weights.units(), progress)?,
            };
            let reached = pair.volumes(&found.pair)?.1;
            let [own, most] = [found.weight, found.bound].map(|w| w as f64 * weights.unit());
            put_pair(&found.pair, outs);
            // SAFETY: the header asks for NULL or places to write.
            unsafe {
                tell(weight, own)?;
                tell(bound, most)?;
                tell(gamma, reached)
            }
        })
    })
}

/// Finds a family of pairs that never collide, one for each of `gammas` [n_gammas] in [0, 1], (25) and (26) of Morris and Behandish 2022: sets
/// `cells_1` [n_gammas * n_1] and `cells_2` [n_gammas * n_2], a row each for every gamma.
///
/// `reached` [n_gammas] are the gammas of the pairs, V_2 / (V_1 + V_2) as in (37d), `volumes` [2 * n_gammas] V_1 and V_2, what is left of the
/// colliding cells, and `bounds` [n_gammas] what no pair of the gamma that was asked for has for V_1 + V_2. Each of these may be NULL. Volumes
/// are by `weights_1` [n_1] and `weights_2` [n_2], at least 0; NULL: the cell's area or volume. Weights that are no multiples of a common unit,
/// see `ko_pair_cut`, are rounded up to multiples of 2^-32 of their sum. gamma 0 and 1 are the unsweeps. A gamma that no pair reaches gets one
/// near to it. `options` NULL: the defaults.
/// Errors: those of `ko_pair_cut`; KO_ERR_INVALID_ARGUMENT for a gamma outside [0, 1], naming the first, and a gap outside [0, 1). Threads: as
/// `ko_pair_cut`. Cost: some cuts, not one for each gamma; n_1 + n_2 bytes a gamma and more inside.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_family(
    pair: *const ko_pair,
    weights_1: *const f64,
    weights_2: *const f64,
    gammas: *const f64,
    n_gammas: usize,
    options: *const ko_family_options,
    n_1: usize,
    n_2: usize,
    cells_1: *mut u8,
    cells_2: *mut u8,
    reached: *mut f64,
    volumes: *mut f64,
    bounds: *mut f64,
) -> i32 {
    guard(|| {
        let (all_1, all_2) = (n_1.saturating_mul(n_gammas), n_2.saturating_mul(n_gammas));
        // SAFETY: the header asks for a pair, NULL or initialised options, and arrays of these lengths.
        let (ko_pair(pair), options, given, gammas, [out_1, out_2]) = unsafe {
            (
                object(pair, "pair")?,
                ko_family_options::read(options)?,
                [array_or_none(weights_1, n_1, "weights_1")?, array_or_none(weights_2, n_2, "weights_2")?],
                array(gammas, n_gammas, "gammas")?,
                outputs(cells_1, all_1, cells_2, all_2)?,
            )
        };
        // SAFETY: the header asks for NULL or arrays of these lengths.
        let (mut reached, mut volumes, mut bounds) = unsafe {
            (
                wanted(reached, n_gammas, "reached")?,
                wanted(volumes.cast::<[f64; 2]>(), n_gammas, "volumes")?,
                wanted(bounds, n_gammas, "bounds")?,
            )
        };
        // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
        let mut told = unsafe { listener(options.progress, options.progress_data) };
        in_its_dimension!(pair, pair => {
            pair.check(n_1, n_2)?;
            let Graph { conflicts, room, .. } = pair.graph()?;
            let (weights, own) = (pair.weights(given, MOST_OF_FAMILY)?, options.to_family_options());
            let progress = &mut Progress::new(&mut told);
            // SAFETY: the header asks for initialised options, with as many symmetries as they say.
            let found = match unsafe { options.folded(pair.grids(), conflicts, progress) }? {
                Some(folded) => folded.family(room, pair.frozen(), weights.units(), gammas, &own, progress)?,
                None => family(conflicts, room, weights.units(), gammas, &own, progress)?,
            };
            for (k, member) in found.into_iter().enumerate() {
                put_pair(&member.pair, [&mut out_1[k * n_1..(k + 1) * n_1], &mut out_2[k * n_2..(k + 1) * n_2]]);
                if let Some(to) = &mut reached {
                    to[k] = member.gamma;
                }
                if let Some(to) = &mut volumes {
                    to[k] = member.volumes.map(|v| v as f64 * weights.unit());
                }
                if let Some(to) = &mut bounds {
                    to[k] = member.bound * weights.unit();
                }
            }
            Ok(())
        })
    })
}
