//! Where two parts touch, and pairs that keep in touch.

use super::cells::read_set;
use super::guard::guard;
use super::pair::{Graph, ko_pair};
use super::pair_options::ko_persistence_options;
use super::pair_shapes::{outputs, put_pair};
use super::pointer::{array_or_none, check_wanted_place, object, tell, wanted};
use super::progress::{ko_progress, listener};
use crate::cogen::weights::MOST_OF_CUT;
use crate::cogen::{Pair, contact, more_persistent};
use crate::dimension::in_its_dimension;
use crate::par::Workers;
use crate::progress::Progress;
use std::ffi::c_void;

/// Tells the gaps between the sets `set_1` [n_1] and `set_2` [n_2] of a pair that does not collide, at `n_times` even times (k + 1/2) / n_times:
/// figure 11 of Morris and Behandish 2022.
///
/// `gaps` [n_times] are the distances between the nearest cells, 0 where they touch, `cells` [2 * n_times] these cells of part 1 and of part 2,
/// and `places` [dim * n_times] points between them, in part 1's frame. `*largest` and `*mean` are those of the gaps. Each output may be NULL.
/// `progress` is told of progress with `progress_data`, or NULL.
/// Errors: KO_ERR_INVALID_ARGUMENT for another number of cells, an entry that is not 0 or 1, for no times or more than 10 million;
/// KO_ERR_DEGENERATE where a part has no cells; KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the
/// caller's; `n_threads` is as elsewhere. Cost: a look at each boundary cell of part 2 a time, and a closer one at few of them; a number a cell
/// of part 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_contact(
    pair: *const ko_pair,
    set_1: *const u8,
    n_1: usize,
    set_2: *const u8,
    n_2: usize,
    n_times: usize,
    n_threads: u32,
    progress: ko_progress,
    progress_data: *mut c_void,
    gaps: *mut f64,
    cells: *mut usize,
    places: *mut f64,
    largest: *mut f64,
    mean: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair, sets and NULL or arrays of these lengths.
        let (ko_pair(pair), one, two, gaps, cells) = unsafe {
            (
                object(pair, "pair")?,
                read_set(set_1, n_1, "set_1")?,
                read_set(set_2, n_2, "set_2")?,
                wanted(gaps, n_times, "gaps")?,
                wanted(cells.cast::<[usize; 2]>(), n_times, "cells")?,
            )
        };
        check_wanted_place(largest, "largest")?;
        check_wanted_place(mean, "mean")?;
        // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
        let mut told = unsafe { listener(progress, progress_data) };
        in_its_dimension!(pair, pair => {
            // SAFETY: the header asks for NULL or an array of this length.
            let places = unsafe { wanted(places.cast(), n_times, "places") }?;
            pair.check(n_1, n_2)?;
            let grids = pair.grids();
            let (sets, workers) = (Pair { cells: [one, two] }, Workers::new(n_threads)?);
            let found = contact(grids, &sets, &pair.relative, n_times, &workers, &mut Progress::new(&mut told))?;
            for (to, gap) in gaps.into_iter().flatten().zip(&found.gaps) {
                *to = gap.distance;
            }
            for (to, gap) in cells.into_iter().flatten().zip(&found.gaps) {
                *to = gap.cells;
            }
            for (to, gap) in places.into_iter().flatten().zip(&found.gaps) {
                *to = gap.place;
            }
            // SAFETY: the header asks for NULL or places to write.
            unsafe {
                tell(largest, found.largest)?;
                tell(mean, found.mean)
            }
        })
    })
}

/// Finds among the pairs of the greatest weight one that keeps better in touch than `set_1` [n_1] and `set_2` [n_2], which is one of them, such
/// as `ko_pair_cut` gives: `cells_1` [n_1] and `cells_2` [n_2], as heavy, free of collisions and maximal.
///
/// Of gaps g at even times, as `ko_pair_contact` tells them, persistence is the mean of 1 / (1 + g / h), with h the options' scale: 1 where the
/// parts never part, 1/2 where they always are h from each other. `*before` is that of the sets, `*after` that of the cells, at least the same,
/// and `*n_tries` counts the pairs that were tried; each may be NULL. It is a local search, around the largest gaps. `weights_1` and
/// `weights_2` are those that the sets are of the greatest weight by, as of `ko_pair_cut`; `options` NULL: the defaults.
/// Errors: KO_ERR_INVALID_ARGUMENT for a pair without conflict graph, another number of cells, an entry that is not 0 or 1, sets that are not of
/// the greatest weight, telling both weights in the cut's units, an option out of its range; KO_ERR_DEGENERATE where a part has no cells;
/// KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: a cut, and
/// `ko_pair_contact` a try.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_more_persistent(
    pair: *const ko_pair,
    set_1: *const u8,
    set_2: *const u8,
    weights_1: *const f64,
    weights_2: *const f64,
    options: *const ko_persistence_options,
    n_1: usize,
    n_2: usize,
    cells_1: *mut u8,
    cells_2: *mut u8,
    before: *mut f64,
    after: *mut f64,
    n_tries: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair, NULL or initialised options, and sets and arrays of these lengths.
        let (ko_pair(pair), options, one, two, given, outs) = unsafe {
            (
                object(pair, "pair")?,
                ko_persistence_options::read(options)?,
                read_set(set_1, n_1, "set_1")?,
                read_set(set_2, n_2, "set_2")?,
                [array_or_none(weights_1, n_1, "weights_1")?, array_or_none(weights_2, n_2, "weights_2")?],
                outputs(cells_1, n_1, cells_2, n_2)?,
            )
        };
        check_wanted_place(before, "before")?;
        check_wanted_place(after, "after")?;
        check_wanted_place(n_tries, "n_tries")?;
        // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
        let mut told = unsafe { listener(options.progress, options.progress_data) };
        let (own, workers) = (options.to_persistence_options()?, Workers::new(options.n_threads)?);
        in_its_dimension!(pair, pair => {
            pair.check(n_1, n_2)?;
            let Graph { conflicts, room, .. } = pair.graph()?;
            let weights = pair.weights(given, MOST_OF_CUT)?;
            let (grids, start) = (pair.grids(), Pair { cells: [one, two] });
            let progress = &mut Progress::new(&mut told);
            let found = more_persistent(
                grids, conflicts, room, weights.units(), &pair.relative, &start, &own, &workers, progress,
            )?;
            put_pair(&found.pair, outs);
            // SAFETY: the header asks for NULL or places to write.
            unsafe {
                tell(before, found.before)?;
                tell(after, found.after)?;
                tell(n_tries, found.n_tries)
            }
        })
    })
}
