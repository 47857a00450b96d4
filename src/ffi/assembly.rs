//! `ko_assembly`: any number of parts, none of which collides with another.

use super::cells::{bits_of, check_set, put};
use super::guard::{guard, guard_free, guard_with_remark};
use super::mesh::check_count;
use super::motion::{at, in_plane, in_space, ko_motion};
use super::pair_options::{Wanted, ko_pair_options};
use super::part::ko_part;
use super::pointer::{
    Sized_, array, array_mut, array_or_none, check_wanted_place, create, free, object, object_or_none, read_sized_or,
    tell, write_sized,
};
use super::progress::{ko_progress, listener};
use super::status::{KO_NEVER_MEET, KO_OK};
use crate::cogen::weights::MOST_OF_CUT;
use crate::cogen::{ArrangeOptions, Assembly, Bits, CellWeights, Motion, OverlapOptions, Part, Weights};
use crate::dimension::{OfDimension, differ};
use crate::error::try_with_capacity;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_void;

/// Parts and their motions, any number of them: which of their cells conflict. Freed by `ko_assembly_free`.
///
/// What takes a set of cells takes n_cells bytes, those of all parts, part after part in the order in which they were given; weights likewise.
#[allow(non_camel_case_types)]
pub struct ko_assembly {
    assembly: Assembly,
    /// Cells that each part may have beside the frozen ones of others.
    room: Vec<Bits>,
    /// Areas or volumes of each part's cells.
    measures: Vec<f64>,
    dim: u32,
}

/// What an assembly is. Filled by `ko_assembly_get_report`.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_assembly_report {
    /// sizeof(ko_assembly_report) as the caller knows it.
    pub struct_size: usize,
    /// Cells of all parts' grids.
    pub n_cells: u64,
    /// Pairs of parts of which some cells conflict.
    pub n_meetings: u64,
    /// Pairs of cells that conflict.
    pub n_edges: u64,
    /// Bytes that the conflict graph takes.
    pub graph_bytes: u64,
    /// Parts.
    pub n_parts: u32,
    /// 2 or 3.
    pub dim: u32,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_assembly_report {
    const FIRST_SIZE: usize = size_of::<usize>() + 4 * 8 + 8;
}

const _: () = assert!(size_of::<ko_assembly_report>() == <ko_assembly_report as Sized_>::FIRST_SIZE);

/// Options of `ko_assembly_arrange`. Initialise by `ko_arrange_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_arrange_options {
    /// sizeof(ko_arrange_options), set by ko_arrange_options_init.
    pub struct_size: usize,
    /// How often each team of parts is given a cut, at most. Default 20.
    pub max_rounds: u32,
    /// Teams that may be the first, each of which leads to a result of its own; at most. Default 4.
    pub max_starts: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: repr(C), starts with a usize, and no padding, by the order of its fields (checked below). Every pattern of bits is a value:
// `progress` may be any address, as in C, and is only ever called as the caller promised.
unsafe impl Sized_ for ko_arrange_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 8 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_arrange_options>() == <ko_arrange_options as Sized_>::FIRST_SIZE);

impl ko_arrange_options {
    fn defaults() -> Self {
        let d = ArrangeOptions::default();
        ko_arrange_options {
            struct_size: size_of::<ko_arrange_options>(),
            max_rounds: d.max_rounds as u32,
            max_starts: d.max_starts as u32,
            progress: None,
            progress_data: std::ptr::null_mut(),
        }
    }
}

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_arrange_options_init(options: *mut ko_arrange_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_arrange_options::defaults(), "options") }
    })
}

/// Makes an assembly of `parts` [n_parts] and `motions` [n_parts]: `motions[k]` takes part k's frame to the world; NULL: the part stays.
///
/// Conflicts are those of overlap, as `ko_pair_create` makes them, of all pairs of parts whose swept boxes meet. Of `options` `slack`, `n_steps`,
/// `clearance`, `max_bytes`, `n_threads` and `progress` are taken; NULL: the defaults. `max_bytes` holds for the graphs of pairs and of all
/// together. `*assembly` is the caller's to free; it refers to neither parts nor motions.
/// Returns KO_NEVER_MEET, a success, where no cell meets one of another part. Errors: KO_ERR_INVALID_ARGUMENT for no parts, different dimensions,
/// more than 2^32 - 2 cells in all, other conflicts or measures asked for, and for frozen cells of two parts that collide, naming two of them, and
/// when and where they do; the others of `ko_pair_create`. Threads: any; `progress` is called on the caller's. Cost: that of `ko_pair_create` for
/// each pair that may meet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_assembly_create(
    parts: *const *const ko_part,
    motions: *const *const ko_motion,
    n_parts: usize,
    options: *const ko_pair_options,
    assembly: *mut *mut ko_assembly,
) -> i32 {
    guard_with_remark(|| {
        let mut remark = KO_OK;
        let make = || {
            // SAFETY: the header asks for arrays of these lengths and NULL or initialised options.
            let (parts, motions, options) = unsafe {
                (array(parts, n_parts, "parts")?, array(motions, n_parts, "motions")?, ko_pair_options::read(options)?)
            };
            if options.wanted()? != Wanted::Overlap || options.measure_steps()? != 0 {
                let text =
                    "an assembly has conflicts of overlap and no measures: conflicts and measure_steps must be 0";
                return Err(Error::InvalidArgument(text.into()));
            }
            let mut both = try_with_capacity(n_parts, "an assembly")?;
            for (k, (&part, &motion)) in parts.iter().zip(motions).enumerate() {
                // SAFETY: the header asks for parts, and NULL or motions.
                both.push(unsafe {
                    (object(part, &format!("parts[{k}]"))?, object_or_none(motion, &format!("motions[{k}]"))?)
                });
            }
            // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
            let mut told = unsafe { listener(options.progress, options.progress_data) };
            let progress = &mut Progress::new(&mut told);
            let made = match both.first() {
                None => return Err(Error::InvalidArgument("n_parts is 0; an assembly has 1 part at least".into())),
                Some((ko_part(OfDimension::Plane(_)), _)) => {
                    let each = |part: &ko_part| part.0.plane().cloned();
                    assembled(&both, each, in_plane, &options.overlap()?, progress)?
                }
                Some((ko_part(OfDimension::Space(_)), _)) => {
                    let each = |part: &ko_part| part.0.space().cloned();
                    assembled(&both, each, in_space, &options.overlap()?, progress)?
                }
            };
            if made.assembly.meetings().is_empty() {
                remark = KO_NEVER_MEET;
            }
            Ok(made)
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(assembly, "assembly", make) }?;
        Ok(remark)
    })
}

fn assembled<const D: usize>(
    both: &[(&ko_part, Option<&ko_motion>)],
    in_dimension: impl Fn(&ko_part) -> Option<std::sync::Arc<Part<D>>>,
    motion_of: impl Fn(Option<&ko_motion>) -> Result<Motion<D>>,
    options: &OverlapOptions,
    progress: &mut Progress<'_>,
) -> Result<ko_assembly> {
    let (mut parts, mut motions) = (try_with_capacity(both.len(), "parts")?, try_with_capacity(both.len(), "motions")?);
    for (k, (part, motion)) in both.iter().enumerate() {
        let of_first = || differ(&[("parts[0]", D as u32), (&format!("parts[{k}]"), part.0.dim())]);
        parts.push(in_dimension(part).ok_or_else(of_first)?);
        motions.push(motion_of(*motion).map_err(|error| at(&format!("part {k}"), error))?);
    }
    let parts: Vec<&Part<D>> = parts.iter().map(|part| &**part).collect();
    let assembly = Assembly::of_overlap(&parts, &motions, options, progress)?;
    let room = assembly.room(&parts)?;
    Ok(ko_assembly { assembly, room, measures: parts.iter().map(|p| p.grid().measure()).collect(), dim: D as u32 })
}

impl ko_assembly {
    fn n_cells(&self) -> usize {
        self.room.iter().map(Bits::len).sum()
    }

    fn room(&self) -> Vec<&Bits> {
        self.room.iter().collect()
    }

    /// What is given for all cells, part by part.
    fn parted<'a, T>(&self, mut all: &'a [T]) -> Vec<&'a [T]> {
        let mut next = |room: &Bits| {
            let (own, rest) = all.split_at(room.len());
            all = rest;
            own
        };
        self.room.iter().map(&mut next).collect()
    }

    /// Writes the sets of all parts.
    fn put(&self, sets: &[Bits], mut to: &mut [u8]) {
        for set in sets {
            let (own, rest) = to.split_at_mut(set.len());
            put(set, own);
            to = rest;
        }
    }
}

/// Frees an assembly. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_assembly_free(assembly: *mut ko_assembly) {
    // SAFETY: the header asks for NULL or an assembly that was not freed.
    guard_free(|| unsafe { free(assembly) });
}

/// Tells what an assembly is; `report_size` is sizeof *report.
///
/// Errors: KO_ERR_INVALID_ARGUMENT. Threads: any number at once. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_assembly_get_report(
    assembly: *const ko_assembly,
    report_size: usize,
    report: *mut ko_assembly_report,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for an assembly.
        let own = unsafe { object(assembly, "assembly") }?;
        let found = ko_assembly_report {
            struct_size: size_of::<ko_assembly_report>(),
            n_cells: own.n_cells() as u64,
            n_meetings: own.assembly.meetings().len() as u64,
            n_edges: own.assembly.n_edges() as u64,
            graph_bytes: own.assembly.bytes() as u64,
            n_parts: own.room.len() as u32,
            dim: own.dim,
        };
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(report, report_size, found, "report") }
    })
}

/// Copies the pairs of parts of which some cells conflict to `meetings` [2 * n_meetings]: numbers of parts, from 0 on, the smaller one first.
///
/// `n_meetings` must be that of `ko_assembly_get_report`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any number at once. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_assembly_copy_meetings(
    assembly: *const ko_assembly,
    n_meetings: usize,
    meetings: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for an assembly and an array of this length.
        let (own, to) = unsafe {
            (object(assembly, "assembly")?, array_mut(meetings.cast::<[usize; 2]>(), n_meetings, "meetings")?)
        };
        let found = own.assembly.meetings();
        check_count("n_meetings", n_meetings, found.len())?;
        to.copy_from_slice(found);
        Ok(())
    })
}

/// Closes an assembly: from any `sets` [n_cells] to `cells` [n_cells], parts that never collide and of which none can grow.
///
/// Part by part in the `order` [n_parts], numbers from 0 on, each keeps of its set what those before it leave; then all take up what is left.
/// NULL: in the order in which they were given. `n_cells` must be that of `ko_assembly_get_report`. Errors: KO_ERR_INVALID_ARGUMENT for another
/// number of cells, an entry that is not 0 or 1, an order that does not name each part once; KO_ERR_OUT_OF_MEMORY. Threads: any number at once.
/// Cost: two passes over the edges.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_assembly_close(
    assembly: *const ko_assembly,
    sets: *const u8,
    order: *const usize,
    n_cells: usize,
    cells: *mut u8,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for an assembly and arrays of this length.
        let (own, out) = unsafe { (object(assembly, "assembly")?, array_mut(cells, n_cells, "cells")?) };
        check_count("n_cells", n_cells, own.n_cells())?;
        // SAFETY: the header asks for a set of this length, and NULL or an order of all parts.
        let (sets, order) = unsafe { (array(sets, n_cells, "sets")?, array_or_none(order, own.room.len(), "order")?) };
        let given: Vec<usize> = order.map_or_else(|| (0..own.room.len()).collect(), <[usize]>::to_vec);
        check_set(sets, "sets")?;
        let sets = own.parted(sets).into_iter().map(|set| bits_of(set, "sets")).collect::<Result<Vec<Bits>>>()?;
        let found = own.assembly.close(&own.room(), &sets.iter().collect::<Vec<_>>(), &given)?;
        own.put(&found, out);
        Ok(())
    })
}

/// Finds parts of great weight among all that never collide, `cells` [n_cells], of which none can grow; the heaviest where parts can be given two
/// colours so that those that meet differ, as in a train of gears.
///
/// `weights` [n_cells], at least 0, are what cells count for; NULL: the cell's area or volume. They are rounded as by `ko_pair_cut`. `*weight` is
/// that of all cells, and `*bound` what no parts weigh more than, by the double cover of the conflict graph (Nemhauser and Trotter 1975): at most
/// bound - weight is lost. `*n_cuts` counts the cuts that it took. Each of the three may be NULL. `options` NULL: the defaults. Where three parts
/// meet each other, teams of two colours get a cut in turn until none gains.
/// Errors: KO_ERR_INVALID_ARGUMENT for another number of cells, a weight that is below 0 or not finite, naming the first, 0 rounds or starts;
/// KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; the call takes one; `progress` is called on it. Cost: cuts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_assembly_arrange(
    assembly: *const ko_assembly,
    weights: *const f64,
    options: *const ko_arrange_options,
    n_cells: usize,
    cells: *mut u8,
    weight: *mut f64,
    bound: *mut f64,
    n_cuts: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for an assembly, NULL or initialised options, and NULL or arrays of this length.
        let (own, options, given, out) = unsafe {
            (
                object(assembly, "assembly")?,
                read_sized_or(options, ko_arrange_options::defaults(), "options")?,
                array_or_none(weights, n_cells, "weights")?,
                array_mut(cells, n_cells, "cells")?,
            )
        };
        check_wanted_place(weight, "weight")?;
        check_wanted_place(bound, "bound")?;
        check_wanted_place(n_cuts, "n_cuts")?;
        check_count("n_cells", n_cells, own.n_cells())?;
        let mut even = Vec::new();
        if given.is_none() {
            even = try_with_capacity(n_cells, "weights")?;
            own.room.iter().zip(&own.measures).for_each(|(room, m)| even.extend(std::iter::repeat_n(*m, room.len())));
        }
        let weights = CellWeights::new([Weights::Each(given.unwrap_or(&even))], MOST_OF_CUT)?;
        let [units] = weights.units();
        // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
        let mut told = unsafe { listener(options.progress, options.progress_data) };
        let arrange =
            ArrangeOptions { max_rounds: options.max_rounds as usize, max_starts: options.max_starts as usize };
        let found = own.assembly.arrange(&own.room(), &own.parted(units), &arrange, &mut Progress::new(&mut told))?;
        own.put(&found.cells, out);
        // SAFETY: the header asks for NULL or places to write.
        unsafe {
            tell(weight, found.weight as f64 * weights.unit())?;
            tell(bound, found.bound as f64 * weights.unit())?;
            tell(n_cuts, found.n_cuts)
        }
    })
}
