//! Options of `ko_pair` and of its calls.

use super::guard::guard;
use super::motion::at;
use super::pointer::{Sized_, array, read_sized_or, write_sized};
use super::progress::ko_progress;
use crate::cogen::{
    Conflicts, FamilyOptions, Folded, Grid, OptimiseOptions, OverlapOptions, PersistenceOptions, Sampling, Side,
    Symmetry,
};
use crate::error::try_with_capacity;
use crate::geometry::matrix::{Affine, matrix};
use crate::geometry::vec::number;
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_void;

/// Conflicts are those of whole cells at all times, none missed: parts without them never overlap.
pub const KO_CONFLICTS_OF_OVERLAP: i32 = 0;
/// Conflicts are those of the paper's measure, the nonzeros of w^12 and w^21: of cells' centres at `measure_steps` times. Parts without them may
/// still overlap in between.
pub const KO_CONFLICTS_OF_MEASURE: i32 = 1;
/// No conflict graph: the pair serves measures and sensitivities alone.
pub const KO_CONFLICTS_NONE: i32 = 2;

/// Options of `ko_pair_create`, `ko_part_sweep` and `ko_part_unsweep`. Initialise by `ko_pair_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_pair_options {
    /// sizeof(ko_pair_options), set by ko_pair_options_init.
    pub struct_size: usize,
    /// How finely time is cut for overlaps, which are never missed: so that cells are kept apart by about this much of the smaller cell's edge
    /// more than they must, at most. Above 0. Default 0.05.
    pub slack: f64,
    /// Even steps of time for overlaps instead; 0 (default): as many as `slack` asks for.
    pub n_steps: u64,
    /// K, the times (k + 1/2) / K at which centres of cells are looked at for the measures (A.14) to (A.17); 0 (default): no measures.
    pub measure_steps: u64,
    /// Distance that parts keep from each other at all times, in the unit of length, at least 0; with KO_CONFLICTS_OF_OVERLAP. Default 0.
    pub clearance: f64,
    /// Bytes that measures and conflict graph may take together; more is refused as soon as it is seen, with what it would take. Default 8 GiB.
    pub max_bytes: u64,
    /// A KO_CONFLICTS_ constant. Default KO_CONFLICTS_OF_OVERLAP.
    pub conflicts: i32,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: repr(C), starts with a usize, and no padding, by the order of its fields (checked below). Every pattern of bits is a value:
// `progress` may be any address, as in C, and is only ever called as the caller promised.
unsafe impl Sized_ for ko_pair_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 48 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_pair_options>() == <ko_pair_options as Sized_>::FIRST_SIZE);

/// Options of `ko_pair_cut` and `ko_pair_family`. Initialise by `ko_family_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_family_options {
    /// sizeof(ko_family_options), set by ko_family_options_init.
    pub struct_size: usize,
    /// Pairs of a family are good enough at this fraction below the bound, in [0, 1); with 0 the convex hull of all pairs' volumes is looked for at
    /// each gamma. A cut is exact whatever it is. Default 0.005.
    pub gap: f64,
    /// Maps by which pairs shall be symmetric, [2 * dim * (dim + 1) * n_symmetries]; NULL (default) for none. Of each map a matrix A [dim * dim],
    /// row-major, and a vector b [dim] for part 1, then A and b for part 2: x goes to A x + b in the part's own frame, a turn or a mirror. They must
    /// carry the grids onto themselves, and conflicts onto conflicts; only whole orbits of cells are in a pair then.
    pub symmetries: *const f64,
    /// Maps.
    pub n_symmetries: usize,
    /// The fraction of the conflicts that may miss their images, in [0, 1), such as where steps of time are not carried onto steps; images that are
    /// missed count as conflicts. Default 0.
    pub symmetry_excess: f64,
    /// Threads for symmetries, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: as above.
unsafe impl Sized_ for ko_family_options {
    const FIRST_SIZE: usize = 4 * size_of::<usize>() + 24 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_family_options>() == <ko_family_options as Sized_>::FIRST_SIZE);

/// Options of `ko_pair_optimise`. Initialise by `ko_optimise_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_optimise_options {
    /// sizeof(ko_optimise_options), set by ko_optimise_options_init.
    pub struct_size: usize,
    /// gamma of (37d), in [0, 1]: V_2 / (V_1 + V_2) of what is left of the colliding cells. Default 0.5.
    pub gamma: f64,
    /// It ends when an iteration changes less than this fraction of the colliding cells' volume; in (0, 1). Default 1e-4.
    pub tolerance: f64,
    /// What the measures may be at the end, as fractions of what they begin with, and the two sides of (37d), as one of the volume; in (0, 1).
    /// Default 1e-3.
    pub feasibility: f64,
    /// Iterations, at most. Default 200.
    pub max_iterations: u32,
    /// The part from which closure begins, 1 or 2; 0 (default): that with the larger volume.
    pub close_from: u32,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: as above.
unsafe impl Sized_ for ko_optimise_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 40 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_optimise_options>() == <ko_optimise_options as Sized_>::FIRST_SIZE);

/// Options of `ko_pair_more_persistent`. Initialise by `ko_persistence_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_persistence_options {
    /// sizeof(ko_persistence_options), set by ko_persistence_options_init.
    pub struct_size: usize,
    /// h, the gap at which persistence is 1/2, in the unit of length; 0 (default): the edge of the larger of both parts' cells.
    pub scale: f64,
    /// gamma of the pairs that are looked at, from and to, in [0, 1]. Default 0 and 1.
    pub gammas: [f64; 2],
    /// Even times at which gaps are measured. Default 200.
    pub n_times: u64,
    /// Pairs that are tried, at most. Default 100.
    pub max_tries: u64,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: as above.
unsafe impl Sized_ for ko_persistence_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 48 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_persistence_options>() == <ko_persistence_options as Sized_>::FIRST_SIZE);

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_pair_options_init(options: *mut ko_pair_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_pair_options::defaults(), "options") }
    })
}

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_family_options_init(options: *mut ko_family_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_family_options::defaults(), "options") }
    })
}

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_optimise_options_init(options: *mut ko_optimise_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_optimise_options::defaults(), "options") }
    })
}

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_persistence_options_init(options: *mut ko_persistence_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_persistence_options::defaults(), "options") }
    })
}

/// What the graph is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    Overlap,
    Measure,
    None,
}

impl ko_pair_options {
    fn defaults() -> Self {
        let d = OverlapOptions::default();
        let slack = match d.sampling {
            Sampling::Slack(slack) => slack,
            Sampling::Steps(_) => unreachable!("the default is by slack"),
        };
        ko_pair_options {
            struct_size: size_of::<ko_pair_options>(),
            slack,
            n_steps: 0,
            measure_steps: 0,
            clearance: d.clearance,
            max_bytes: d.max_bytes,
            conflicts: KO_CONFLICTS_OF_OVERLAP,
            n_threads: d.n_threads,
            progress: None,
            progress_data: std::ptr::null_mut(),
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    pub(super) unsafe fn read(pointer: *const Self) -> Result<Self> {
        // SAFETY: the caller's promise.
        unsafe { read_sized_or(pointer, Self::defaults(), "options") }
    }

    pub(super) fn sampling(&self) -> Result<Sampling> {
        Ok(match self.n_steps {
            0 => Sampling::Slack(self.slack),
            n => Sampling::Steps(count("n_steps", n)?),
        })
    }

    pub(super) fn overlap(&self) -> Result<OverlapOptions> {
        Ok(OverlapOptions {
            sampling: self.sampling()?,
            clearance: self.clearance,
            max_bytes: self.max_bytes,
            n_threads: self.n_threads,
        })
    }

    /// K, 0 for no measures.
    pub(super) fn measure_steps(&self) -> Result<usize> {
        count("measure_steps", self.measure_steps)
    }

    pub(super) fn wanted(&self) -> Result<Wanted> {
        let wanted = match self.conflicts {
            KO_CONFLICTS_OF_OVERLAP => Wanted::Overlap,
            KO_CONFLICTS_OF_MEASURE => Wanted::Measure,
            KO_CONFLICTS_NONE => Wanted::None,
            other => {
                return Err(Error::InvalidArgument(format!(
                    "conflicts is {other}; it must be a KO_CONFLICTS_ constant, 0 to 2"
                )));
            }
        };
        if wanted != Wanted::Overlap && self.measure_steps == 0 {
            let text = "measure_steps is 0, which leaves nothing to make; it must be 1 at least, or conflicts those of overlap";
            return Err(Error::InvalidArgument(text.into()));
        }
        if wanted != Wanted::Overlap && self.clearance != 0.0 {
            let text =
                format!("the clearance is {}; it must be 0 but with KO_CONFLICTS_OF_OVERLAP", number(self.clearance));
            return Err(Error::InvalidArgument(text));
        }
        Ok(wanted)
    }
}

impl ko_family_options {
    fn defaults() -> Self {
        ko_family_options {
            struct_size: size_of::<ko_family_options>(),
            gap: FamilyOptions::default().gap,
            symmetries: std::ptr::null(),
            n_symmetries: 0,
            symmetry_excess: 0.0,
            n_threads: 0,
            reserved: 0,
            progress: None,
            progress_data: std::ptr::null_mut(),
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    pub(super) unsafe fn read(pointer: *const Self) -> Result<Self> {
        // SAFETY: the caller's promise.
        unsafe { read_sized_or(pointer, Self::defaults(), "options") }
    }

    pub(super) fn to_family_options(self) -> FamilyOptions {
        FamilyOptions { gap: self.gap }
    }

    /// The graph of orbits, if pairs shall be symmetric.
    ///
    /// # Safety
    /// `symmetries` is NULL or an array of as many numbers as its docs say.
    pub(super) unsafe fn folded<const D: usize>(
        &self,
        grids: [&Grid<D>; 2],
        conflicts: &Conflicts,
        progress: &mut Progress<'_>,
    ) -> Result<Option<Folded>> {
        check_reserved(self.reserved)?;
        if self.n_symmetries == 0 {
            return Ok(None);
        }
        // SAFETY: the caller's promise.
        let maps = unsafe { array(self.symmetries, self.n_symmetries.saturating_mul(2 * D * (D + 1)), "symmetries") }?;
        let affine = |m: usize| {
            let (linear, shift) = maps[m * D * (D + 1)..].split_at(D * D);
            Affine { linear: matrix(|a, b| linear[D * a + b]), shift: std::array::from_fn(|a| shift[a]) }
        };
        let mut all = try_with_capacity(self.n_symmetries, "symmetries")?;
        for m in 0..self.n_symmetries {
            let (one, two): (Affine<D>, Affine<D>) = (affine(2 * m), affine(2 * m + 1));
            let made = Symmetry::of_points(grids, [&|p| one.apply(p), &|p| two.apply(p)]);
            all.push(made.map_err(|error| at(&format!("symmetry {m}"), error))?);
        }
        let workers = Workers::new(self.n_threads)?;
        progress.part(0.0, 0.2, |part| Folded::new(conflicts, &all, self.symmetry_excess, &workers, part)).map(Some)
    }
}

impl ko_optimise_options {
    fn defaults() -> Self {
        let d = OptimiseOptions::default();
        ko_optimise_options {
            struct_size: size_of::<ko_optimise_options>(),
            gamma: d.gamma,
            tolerance: d.tolerance,
            feasibility: d.feasibility,
            max_iterations: d.max_iterations as u32,
            close_from: 0,
            n_threads: 0,
            reserved: 0,
            progress: None,
            progress_data: std::ptr::null_mut(),
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    pub(super) unsafe fn read(pointer: *const Self) -> Result<Self> {
        // SAFETY: the caller's promise.
        unsafe { read_sized_or(pointer, Self::defaults(), "options") }
    }

    pub(super) fn to_optimise_options(self) -> Result<OptimiseOptions> {
        check_reserved(self.reserved)?;
        Ok(OptimiseOptions {
            gamma: self.gamma,
            max_iterations: self.max_iterations as usize,
            tolerance: self.tolerance,
            feasibility: self.feasibility,
            from: side("close_from", self.close_from)?,
        })
    }
}

impl ko_persistence_options {
    fn defaults() -> Self {
        let d = PersistenceOptions::default();
        ko_persistence_options {
            struct_size: size_of::<ko_persistence_options>(),
            scale: d.scale,
            gammas: d.gammas,
            n_times: d.n_times as u64,
            max_tries: d.max_tries as u64,
            n_threads: 0,
            reserved: 0,
            progress: None,
            progress_data: std::ptr::null_mut(),
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    pub(super) unsafe fn read(pointer: *const Self) -> Result<Self> {
        // SAFETY: the caller's promise.
        unsafe { read_sized_or(pointer, Self::defaults(), "options") }
    }

    pub(super) fn to_persistence_options(self) -> Result<PersistenceOptions> {
        check_reserved(self.reserved)?;
        Ok(PersistenceOptions {
            n_times: count("n_times", self.n_times)?,
            scale: self.scale,
            max_tries: count("max_tries", self.max_tries)?,
            gammas: self.gammas,
        })
    }
}

pub(super) fn check_reserved(reserved: u32) -> Result<()> {
    if reserved == 0 {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!("reserved is {reserved}; it must be 0")))
}

/// Part 1 or 2, none for 0.
pub(super) fn side(name: &str, number: u32) -> Result<Option<Side>> {
    match number {
        0 => Ok(None),
        1 => Ok(Some(Side::First)),
        2 => Ok(Some(Side::Second)),
        _ => Err(Error::InvalidArgument(format!(
            "{name} is {number}; it must be 1 or 2, or 0 for the part with the larger volume"
        ))),
    }
}

fn count(name: &str, n: u64) -> Result<usize> {
    usize::try_from(n).map_err(|_| Error::InvalidArgument(format!("{name} is {n}, more than there can be")))
}
