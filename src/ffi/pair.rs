//! `ko_pair`: two parts in relative motion, and how they collide.

use super::cells::put;
use super::guard::{guard, guard_free, guard_with_remark};
use super::mesh::check_count;
use super::motion::{in_plane, in_space, ko_motion};
use super::pair_options::{Wanted, ko_pair_options};
use super::part::ko_part;
use super::pointer::{
    Sized_, array, array_mut, check_wanted_place, create, free, object, object_or_none, tell, wanted, write_sized,
};
use super::progress::listener;
use super::status::{KO_NEVER_MEET, KO_OK};
use crate::cogen::{Bits, Change, Conflicts, Correlation, Grid, OverlapOptions, Part, Relative, Side, room};
use crate::dimension::{OfDimension, differ, in_its_dimension};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
use std::sync::Arc;

/// Two parts and their motions: collision measures, which depend on motions and grids alone, and the conflict graph, of which pairs that never
/// collide are the independent sets. Morris and Behandish 2022. Freed by `ko_pair_free`.
///
/// What takes a set for each part takes n_1 and n_2 bytes, numbers of cells of part 1 and of part 2; densities likewise.
#[allow(non_camel_case_types)]
pub struct ko_pair(pub(super) OfDimension<Coupled<2>, Coupled<3>>);

/// What a pair holds.
pub(super) struct Coupled<const D: usize> {
    pub parts: [Arc<Part<D>>; 2],
    pub relative: Relative<D>,
    pub correlation: Option<Correlation<D>>,
    pub graph: Option<Graph>,
}

/// The conflict graph, and what follows from it.
pub(super) struct Graph {
    pub conflicts: Conflicts,
    /// Cells that each part may have beside the frozen ones of the other.
    pub room: [Bits; 2],
    /// Those of them that conflict with others.
    pub colliding: [Bits; 2],
}

/// What a pair is. Filled by `ko_pair_get_report`.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_pair_report {
    /// sizeof(ko_pair_report) as the caller knows it.
    pub struct_size: usize,
    /// n_1 and n_2, cells of both grids.
    pub n_cells: [u64; 2],
    /// Cells that each part may have beside those that the other keeps, and that conflict with cells of the other.
    pub n_colliding: [u64; 2],
    /// Edges of the conflict graph.
    pub n_edges: u64,
    /// Bytes that it takes.
    pub graph_bytes: u64,
    /// K, 0 for a pair without measures.
    pub measure_steps: u64,
    /// Visits of centres in cells that the measures are of.
    pub n_visits: u64,
    /// Bytes that they take.
    pub measure_bytes: u64,
    /// 2 or 3.
    pub dim: u32,
    /// 1: there is a conflict graph.
    pub has_graph: i32,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_pair_report {
    const FIRST_SIZE: usize = size_of::<usize>() + 9 * 8 + 8;
}

const _: () = assert!(size_of::<ko_pair_report>() == <ko_pair_report as Sized_>::FIRST_SIZE);

/// Makes a pair of two parts and their motions in the world: `motion_1` takes part 1's frame to the world, `motion_2` part 2's; NULL: the part
/// stays. `options` NULL: the defaults, which make a conflict graph and no measures.
///
/// Conflicts of overlap are between cells that overlap at any time, or come nearer than the clearance: none is missed, by separating axes at steps of
/// time between which displacements are bounded; touching is no overlap. `*pair` is the caller's to free; it refers to neither parts nor motions.
/// Returns KO_NEVER_MEET, a success, where no cell of a part meets one of the other, which mostly is a mistake in frames or motions.
/// Errors: KO_ERR_INVALID_ARGUMENT for different dimensions, an option out of its range, a motion with a number that is not finite or so fast that
/// it takes more than 10 million steps, and for frozen cells of both parts that collide, naming two of them, and when and where they do;
/// KO_ERR_OUT_OF_MEMORY with the bytes that it would take; KO_ERR_UNSUPPORTED for an option that this library does not know; KO_ERR_CANCELLED.
/// Threads: any; `progress` is called on the caller's. Cost: of the graph for each cell of the part with fewer of them and each step, and for each
/// cell that it passes over then, some nanoseconds; of measures some nanoseconds for each cell and each of K steps, and two bytes a visit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_create(
    part_1: *const ko_part,
    motion_1: *const ko_motion,
    part_2: *const ko_part,
    motion_2: *const ko_motion,
    options: *const ko_pair_options,
    pair: *mut *mut ko_pair,
) -> i32 {
    guard_with_remark(|| {
        let mut remark = KO_OK;
        let make = || {
            // SAFETY: the header asks for parts, NULL or motions, and NULL or initialised options.
            let (ko_part(one), ko_part(two), motions, options) = unsafe {
                (
                    object(part_1, "part_1")?,
                    object(part_2, "part_2")?,
                    [object_or_none(motion_1, "motion_1")?, object_or_none(motion_2, "motion_2")?],
                    ko_pair_options::read(options)?,
                )
            };
            let made = match (one, two) {
                (OfDimension::Plane(one), OfDimension::Plane(two)) => {
                    let [from, of] = motions.map(in_plane);
                    // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
                    OfDimension::Plane(unsafe { coupled([one, two], Relative { from: from?, of: of? }, &options) }?)
                }
                (OfDimension::Space(one), OfDimension::Space(two)) => {
                    let [from, of] = motions.map(in_space);
                    // SAFETY: as above.
                    OfDimension::Space(unsafe { coupled([one, two], Relative { from: from?, of: of? }, &options) }?)
                }
                _ => return Err(differ(&[("part_1", one.dim()), ("part_2", two.dim())])),
            };
            if in_its_dimension!(&made, made => made.never_meet()) {
                remark = KO_NEVER_MEET;
            }
            Ok(ko_pair(made))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(pair, "pair", make) }?;
        Ok(remark)
    })
}

/// # Safety
/// The options' function may be called with their data.
unsafe fn coupled<const D: usize>(
    parts: [&Arc<Part<D>>; 2],
    relative: Relative<D>,
    options: &ko_pair_options,
) -> Result<Coupled<D>> {
    let wanted = options.wanted()?;
    let (overlap, n_steps, workers) = (options.overlap()?, options.measure_steps()?, Workers::new(options.n_threads)?);
    let both = parts.map(|part| &**part);
    // SAFETY: the caller's promise.
    let mut told = unsafe { listener(options.progress, options.progress_data) };
    let mut progress = Progress::new(&mut told);
    // Measures take the first half of what is told where there are both.
    let share = match (n_steps, wanted) {
        (0, _) => 0.0,
        (_, Wanted::None) => 1.0,
        _ => 0.5,
    };
    let correlation = if n_steps > 0 {
        let measure =
            |part: &mut Progress<'_>| Correlation::new(both, &relative, n_steps, options.max_bytes, &workers, part);
        Some(progress.part(0.0, share, measure)?)
    } else {
        None
    };
    let taken = correlation.as_ref().map_or(0, Correlation::bytes) as u64;
    let conflicts = match (wanted, &correlation) {
        (Wanted::Overlap, _) => {
            let overlap = OverlapOptions { max_bytes: options.max_bytes.saturating_sub(taken), ..overlap };
            let look = |part: &mut Progress<'_>| Conflicts::of_overlap(both, &relative, &overlap, part);
            Some(progress.part(share, 1.0, look)?)
        }
        (Wanted::Measure, Some(correlation)) => {
            let max_bytes = options.max_bytes.saturating_sub(taken);
            let look = |part: &mut Progress<'_>| correlation.conflicts(max_bytes, &workers, part);
            Some(progress.part(share, 1.0, look)?)
        }
        _ => None,
    };
    let graph = match conflicts {
        Some(conflicts) => {
            let room = room(&conflicts, both, &relative)?;
            let colliding = conflicts.colliding(&room)?;
            Some(Graph { conflicts, room, colliding })
        }
        None => None,
    };
    Ok(Coupled { parts: parts.map(Arc::clone), relative, correlation, graph })
}

impl<const D: usize> Coupled<D> {
    /// Numbers of both parts' cells.
    pub fn n_cells(&self) -> [usize; 2] {
        self.parts.each_ref().map(|part| part.grid().n_cells())
    }

    pub fn grids(&self) -> [&Grid<D>; 2] {
        self.parts.each_ref().map(|part| part.grid())
    }

    /// The cells that each part keeps.
    pub fn frozen(&self) -> [&Bits; 2] {
        self.parts.each_ref().map(|part| part.frozen())
    }

    /// Refuses other numbers of cells.
    pub fn check(&self, n_1: usize, n_2: usize) -> Result<()> {
        let right = self.n_cells();
        check_count("n_1", n_1, right[0])?;
        check_count("n_2", n_2, right[1])
    }

    /// The graph, or why there is none.
    pub fn graph(&self) -> Result<&Graph> {
        let text = "the pair has no conflict graph; create it with conflicts KO_CONFLICTS_OF_OVERLAP or KO_CONFLICTS_OF_MEASURE";
        self.graph.as_ref().ok_or_else(|| Error::InvalidArgument(text.into()))
    }

    /// The measures, or why there are none.
    pub fn correlation(&self) -> Result<&Correlation<D>> {
        let text = "the pair has no measures; create it with measure_steps of 1 or more";
        self.correlation.as_ref().ok_or_else(|| Error::InvalidArgument(text.into()))
    }

    fn never_meet(&self) -> bool {
        let without = self.graph.as_ref().is_none_or(|graph| graph.conflicts.n_edges() == 0);
        without && self.correlation.as_ref().is_none_or(|correlation| correlation.n_visits() == 0)
    }

    fn report(&self) -> ko_pair_report {
        let (graph, measures) = (self.graph.as_ref(), self.correlation.as_ref());
        let n = |n: usize| n as u64;
        ko_pair_report {
            struct_size: size_of::<ko_pair_report>(),
            n_cells: self.n_cells().map(n),
            n_colliding: graph.map_or([0; 2], |g| g.colliding.each_ref().map(|set| n(set.count()))),
            n_edges: graph.map_or(0, |g| n(g.conflicts.n_edges())),
            graph_bytes: graph.map_or(0, |g| n(g.conflicts.bytes())),
            measure_steps: measures.map_or(0, |m| n(m.n_steps())),
            n_visits: measures.map_or(0, |m| n(m.n_visits())),
            measure_bytes: measures.map_or(0, |m| n(m.bytes())),
            dim: D as u32,
            has_graph: i32::from(graph.is_some()),
        }
    }
}

/// Frees a pair. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_free(pair: *mut ko_pair) {
    // SAFETY: the header asks for NULL or a pair that was not freed.
    guard_free(|| unsafe { free(pair) });
}

/// Tells what a pair is; `report_size` is sizeof *report.
///
/// Errors: KO_ERR_INVALID_ARGUMENT. Threads: any number at once. Cost: a pass over the sets of cells.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_get_report(
    pair: *const ko_pair,
    report_size: usize,
    report: *mut ko_pair_report,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair.
        let ko_pair(pair) = unsafe { object(pair, "pair") }?;
        let found = in_its_dimension!(pair, pair => pair.report());
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(report, report_size, found, "report") }
    })
}

/// Densities as C hands them over.
///
/// # Safety
/// Both are NULL or arrays of these lengths that live during `'a`.
unsafe fn densities<'a>(one: *const f64, n_1: usize, two: *const f64, n_2: usize) -> Result<[&'a [f64]; 2]> {
    // SAFETY: the caller's promise.
    unsafe { Ok([array(one, n_1, "densities_1")?, array(two, n_2, "densities_2")?]) }
}

/// Where gradients of both measures by both parts' densities go.
///
/// # Safety
/// Each is NULL or an array of n_1 or n_2 numbers that no one else uses during `'a`.
unsafe fn gradients<'a>(
    [[d21_d1, d21_d2], [d12_d1, d12_d2]]: [[*mut f64; 2]; 2],
    n_1: usize,
    n_2: usize,
) -> Result<[[&'a mut [f64]; 2]; 2]> {
    // SAFETY: the caller's promise.
    unsafe {
        Ok([
            [array_mut(d21_d1, n_1, "d21_d1")?, array_mut(d21_d2, n_2, "d21_d2")?],
            [array_mut(d12_d1, n_1, "d12_d1")?, array_mut(d12_d2, n_2, "d12_d2")?],
        ])
    }
}

/// Evaluates the collision measures (29) and (30) of Morris and Behandish 2022 for `densities_1` [n_1] and `densities_2` [n_2]: `*g21`, the area or
/// volume of part 2 that is in part 1, times the fraction of the motion that it is; `*g12`, that of part 1 in part 2. Either may be NULL.
///
/// The weights are (A.14) to (A.17) with densities as fractions of cells, w^12 = eps_2^dim n_12 / K: unit of length to the power dim. Both are 0 for
/// densities of pairs without KO_CONFLICTS_OF_MEASURE. A density must be 0 where the part may not have the cell.
/// Errors: KO_ERR_INVALID_ARGUMENT for a pair without measures, another number of cells, or a density outside [0, 1], naming the first;
/// KO_ERR_OUT_OF_MEMORY. Threads: any number at once; `n_threads` is as elsewhere, and the bits do not depend on it. Cost: some nanoseconds a
/// visit of `ko_pair_get_report`; a number a cell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_measures(
    pair: *const ko_pair,
    densities_1: *const f64,
    n_1: usize,
    densities_2: *const f64,
    n_2: usize,
    n_threads: u32,
    g21: *mut f64,
    g12: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair and arrays of these lengths.
        let (ko_pair(pair), rho) = unsafe { (object(pair, "pair")?, densities(densities_1, n_1, densities_2, n_2)?) };
        check_wanted_place(g21, "g21")?;
        check_wanted_place(g12, "g12")?;
        let found = in_its_dimension!(pair, pair => {
            pair.correlation()?.measures(rho, &Workers::new(n_threads)?)?
        });
        // SAFETY: the header asks for NULL or places to write.
        unsafe {
            tell(g21, found.g21)?;
            tell(g12, found.g12)
        }
    })
}

/// Evaluates the local measures (12) and (13) of Morris and Behandish 2022: `l21` [n_1], for each cell of part 1 the fraction of the motion that its
/// centre is in part 2, with part 2's densities; `l12` [n_2], for those of part 2 in part 1. Either may be NULL.
///
/// A cell that its part may not have gets 0. Errors, threads, cost: those of `ko_pair_measures`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_local_measures(
    pair: *const ko_pair,
    densities_1: *const f64,
    n_1: usize,
    densities_2: *const f64,
    n_2: usize,
    n_threads: u32,
    l21: *mut f64,
    l12: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair and arrays of these lengths.
        let (ko_pair(pair), rho, l21, l12) = unsafe {
            (
                object(pair, "pair")?,
                densities(densities_1, n_1, densities_2, n_2)?,
                wanted(l21, n_1, "l21")?,
                wanted(l12, n_2, "l12")?,
            )
        };
        in_its_dimension!(pair, pair => {
            let correlation = pair.correlation()?;
            correlation.check(rho)?;
            let workers = Workers::new(n_threads)?;
            if let Some(out) = l21 {
                correlation.local(Side::First, rho[1], out, &workers);
            }
            if let Some(out) = l12 {
                correlation.local(Side::Second, rho[0], out, &workers);
            }
            Ok(())
        })
    })
}

/// Evaluates the sensitivities (31) and (32) of Morris and Behandish 2022: derivatives of g_21 by both parts' densities, `d21_d1` [n_1] and `d21_d2`
/// [n_2], and of g_12, `d12_d1` [n_1] and `d12_d2` [n_2].
///
/// The measures are bilinear: g_21 is the sum of d21_d2 times densities_2, g_12 that of d12_d1 times densities_1. The right-hand sides of the paper's
/// (32) are the wrong way round; here dg_12/drho_1 = (w^21)^T rho_2, dg_12/drho_2 = w^21 rho_1.
/// Errors, threads: those of `ko_pair_measures`. Cost: twice that.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_sensitivities(
    pair: *const ko_pair,
    densities_1: *const f64,
    n_1: usize,
    densities_2: *const f64,
    n_2: usize,
    n_threads: u32,
    d21_d1: *mut f64,
    d21_d2: *mut f64,
    d12_d1: *mut f64,
    d12_d2: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair and arrays of these lengths.
        let (ko_pair(pair), rho, out) = unsafe {
            (
                object(pair, "pair")?,
                densities(densities_1, n_1, densities_2, n_2)?,
                gradients([[d21_d1, d21_d2], [d12_d1, d12_d2]], n_1, n_2)?,
            )
        };
        in_its_dimension!(pair, pair => {
            pair.correlation()?.sensitivities(rho, out, &Workers::new(n_threads)?)
        })
    })
}

/// Cells are put to a part.
pub const KO_CHANGE_PUT: i32 = 0;
/// Cells are taken from a part.
pub const KO_CHANGE_TAKE: i32 = 1;

/// Evaluates the topological sensitivities (B.1) and (B.2) of Morris and Behandish 2022: how g_21 changes, by the area or volume, as a cell is put
/// to a part or taken from it, `d21_d1` [n_1] and `d21_d2` [n_2], and g_12, `d12_d1` [n_1] and `d12_d2` [n_2].
///
/// `change` is a KO_CHANGE_ constant. They have no unit: what (B.5), (B.6) and (B.12) tend to, the fraction of the motion that the place is in the
/// other part. Of a cell that the part fills there is nothing to put, of one that it has not there is nothing to take: 0. In cells that the
/// surface cuts the paper leaves the limit open; here they have their shares, 1 - density and density.
/// Errors, threads, cost: those of `ko_pair_sensitivities`; KO_ERR_INVALID_ARGUMENT for another change.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_topological_sensitivities(
    pair: *const ko_pair,
    densities_1: *const f64,
    n_1: usize,
    densities_2: *const f64,
    n_2: usize,
    change: i32,
    n_threads: u32,
    d21_d1: *mut f64,
    d21_d2: *mut f64,
    d12_d1: *mut f64,
    d12_d2: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair and arrays of these lengths.
        let (ko_pair(pair), rho, out) = unsafe {
            (
                object(pair, "pair")?,
                densities(densities_1, n_1, densities_2, n_2)?,
                gradients([[d21_d1, d21_d2], [d12_d1, d12_d2]], n_1, n_2)?,
            )
        };
        let change = match change {
            KO_CHANGE_PUT => Change::Put,
            KO_CHANGE_TAKE => Change::Take,
            _ => {
                return Err(Error::InvalidArgument(format!(
                    "change is {change}; it must be KO_CHANGE_PUT (0) or KO_CHANGE_TAKE (1)"
                )));
            }
        };
        in_its_dimension!(pair, pair => {
            pair.correlation()?.topological_sensitivities(rho, change, out, &Workers::new(n_threads)?)
        })
    })
}

/// Tells the initially colliding subdomains, (33) to (36) of Morris and Behandish 2022: the cells of each part that conflict with cells that the
/// other may have, sets `cells_1` [n_1] and `cells_2` [n_2]. Either may be NULL.
///
/// Only they can have to go. Cells that may not be beside frozen ones of the other part are left out. (33) and (34) with one direction miss cells
/// whose centres the other's cells meet while theirs meet none; here it is the union of both. Errors: KO_ERR_INVALID_ARGUMENT for a pair without
/// conflict graph, and another number of cells. Threads: any number at once. Cost: a pass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_colliding(
    pair: *const ko_pair,
    n_1: usize,
    n_2: usize,
    cells_1: *mut u8,
    cells_2: *mut u8,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a pair, NULL or arrays of these lengths.
        let (ko_pair(pair), outs) =
            unsafe { (object(pair, "pair")?, [wanted(cells_1, n_1, "cells_1")?, wanted(cells_2, n_2, "cells_2")?]) };
        in_its_dimension!(pair, pair => {
            pair.check(n_1, n_2)?;
            for (out, set) in outs.into_iter().zip(&pair.graph()?.colliding) {
                if let Some(out) = out {
                    put(set, out);
                }
            }
            Ok(())
        })
    })
}
