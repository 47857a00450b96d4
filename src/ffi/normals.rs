//! Clouds of points that come without normals, with what was found on the way.

use super::cloud::ko_cloud;
use super::guard::guard;
use super::mesh::copied;
use super::pointer::{Sized_, array, check_wanted_sized, create, read_sized_or, wanted, write_sized};
use super::progress::{ko_progress, listener};
use crate::dimension::OfDimension;
use crate::geometry::Cloud;
use crate::geometry::orient::{NormalOptions, NormalReport, check_memory};
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_void;

/// Bit of a point's flags: it lies at the very place of an earlier point, whose normal it shares.
pub const KO_POINT_COPY: u8 = 1;
/// Bit of a point's flags: it is far from its neighbours, for how near those are to theirs.
pub const KO_POINT_OUTLIER: u8 = 2;
/// Bit of a point's flags: it lies on a line with its neighbours; no plane could be told, and its normal is one of many.
pub const KO_POINT_DEGENERATE: u8 = 4;
/// Bit of a point's flags: its neighbours ask, in sum, for the other sign of its normal.
pub const KO_POINT_DOUBTFUL: u8 = 8;

/// Options of `ko_cloud_estimate_normals`. Initialise by `ko_normal_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_normal_options {
    /// sizeof(ko_normal_options), set by ko_normal_options_init.
    pub struct_size: usize,
    /// Nearest neighbours that a normal is taken from, in [3, 64]; 0 (the default) for 10 in space and 4 in the plane. More smooth noise,
    /// and edges with it.
    pub neighbours: u32,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// A point whose mean distance to its neighbours is this many times the median of theirs is an outlier; above 1. Default 2.5.
    pub outlier_factor: f64,
    /// Bytes that the call may take; more is refused before any is taken. Default 8 GiB.
    pub memory_limit: u64,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: repr(C), starts with a usize, and no padding, by the order of its fields (checked below). Every pattern of bits is a value:
// `progress` may be any address, as in C, and is only ever called as the caller promised.
unsafe impl Sized_ for ko_normal_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 24 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_normal_options>() == <ko_normal_options as Sized_>::FIRST_SIZE);

/// What an estimate of normals found. Filled by `ko_cloud_estimate_normals`, the `flags` of which tell which points are counted here.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_normal_report {
    /// sizeof(ko_normal_report) as the caller knows it.
    pub struct_size: usize,
    /// Parts that neighbours connect; each has a sign of its own.
    pub n_components: u64,
    /// Points at the place of an earlier one: KO_POINT_COPY.
    pub n_copies: u64,
    /// Points far from their neighbours: KO_POINT_OUTLIER.
    pub n_outliers: u64,
    /// Points on a line with their neighbours: KO_POINT_DEGENERATE.
    pub n_degenerate: u64,
    /// Points whose neighbours ask for the other sign: KO_POINT_DOUBTFUL.
    pub n_doubtful: u64,
    /// Of what all pairs of neighbours ask for, by weight, the fraction that the signs meet: 1 is all. Below 0.9, look at the result.
    pub agreement: f64,
    /// Seconds of the call.
    pub seconds: f64,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_normal_report {
    const FIRST_SIZE: usize = size_of::<usize>() + 7 * 8;
}

const _: () = assert!(size_of::<ko_normal_report>() == <ko_normal_report as Sized_>::FIRST_SIZE);

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_normal_options_init(options: *mut ko_normal_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_normal_options::defaults(), "options") }
    })
}

impl ko_normal_options {
    fn defaults() -> Self {
        let d = NormalOptions::default();
        ko_normal_options {
            struct_size: size_of::<ko_normal_options>(),
            neighbours: d.neighbours,
            n_threads: d.n_threads,
            outlier_factor: d.outlier_factor,
            memory_limit: d.memory_limit,
            progress: None,
            progress_data: std::ptr::null_mut(),
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    unsafe fn read(pointer: *const Self) -> Result<Self> {
        // SAFETY: the caller's promise.
        unsafe { read_sized_or(pointer, Self::defaults(), "options") }
    }

    /// The same for the estimate.
    fn to_normal_options(self) -> NormalOptions {
        NormalOptions {
            neighbours: self.neighbours,
            outlier_factor: self.outlier_factor,
            n_threads: self.n_threads,
            memory_limit: self.memory_limit,
        }
    }
}

/// Makes a cloud from `points` [dim * n_points] that come without normals: a plane through each point's neighbours (Hoppe et al. 1992), and
/// signs that agree, the most sure ones first.
///
/// `dim` is 2 or 3. `options` NULL: the defaults. All points stay, in their order. Closed parts face outward; a part inside an odd number
/// of others is the boundary of a cavity and faces into it; open parts face the side they bulge to, flat ones that of their largest
/// coordinate. Sides of a sheet nearer to each other than the points of one side are not told apart.
/// `*cloud` is the caller's to free. `flags` [n_points] gets an or of KO_POINT_ bits for each point, 0 for most, and `report`, of
/// `report_size` bytes (sizeof *report), what was found; either may be NULL. To leave points out of fits, give them weight 0 by
/// `ko_cloud_set_weights`. The array is copied. The same points give the same bits.
/// Errors: KO_ERR_INVALID_ARGUMENT for fewer than dim + 1 points or more than 2^30 / dim, for one that is not finite, naming the first, and
/// for an option out of its range; KO_ERR_DEGENERATE for points at fewer than dim + 1 places and for points of space all on a line;
/// KO_ERR_UNSUPPORTED for an option that this library does not know; KO_ERR_OUT_OF_MEMORY with the bytes that it would take;
/// KO_ERR_CANCELLED.
/// Threads: any; `progress` is called on the caller's. Cost: O(n_points log n_points), some 20 microseconds a point of space on one
/// thread. Memory: at most 1000 bytes a point and 32 a neighbour.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_estimate_normals(
    dim: u32,
    points: *const f64,
    n_points: usize,
    options: *const ko_normal_options,
    cloud: *mut *mut ko_cloud,
    flags: *mut u8,
    report_size: usize,
    report: *mut ko_normal_report,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_normal_options::read(options) }?;
            // SAFETY: the header asks for NULL or an array of this length.
            let flags = unsafe { wanted(flags, n_points, "flags") }?;
            // Before the work, not after it.
            check_wanted_sized(report, report_size, "report")?;
            let (cloud, found) = match dim {
                2 => {
                    // SAFETY: the header asks for an array of this length.
                    let (cloud, found) = unsafe { estimate(points, n_points, options) }?;
                    (OfDimension::Plane(cloud), found)
                }
                3 => {
                    // SAFETY: as above.
                    let (cloud, found) = unsafe { estimate(points, n_points, options) }?;
                    (OfDimension::Space(cloud), found)
                }
                _ => return Err(Error::InvalidArgument(format!("dim is {dim}; it must be 2 or 3"))),
            };
            if !report.is_null() {
                // SAFETY: the header asks for NULL or a struct of this size.
                unsafe { ko_normal_report::write(report, report_size, &found) }?;
            }
            if let Some(flags) = flags {
                mark(flags, &found);
            }
            Ok(ko_cloud(cloud))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(cloud, "cloud", make) }
    })
}

/// # Safety
/// `points` is NULL or an array of D times `n`; the options' function may be called with their data.
unsafe fn estimate<const D: usize>(
    points: *const f64,
    n: usize,
    options: ko_normal_options,
) -> Result<(Cloud<D>, NormalReport)> {
    // SAFETY: the caller's promise.
    let points = unsafe { array(points.cast::<[f64; D]>(), n, "points") }?;
    // SAFETY: the caller's promise.
    let mut tell = unsafe { listener(options.progress, options.progress_data) };
    let options = options.to_normal_options();
    // Before any memory is taken, the copy's too.
    check_memory::<D>(n, &options)?;
    Cloud::with_estimated_normals(copied(points, "the points")?, &options, &mut Progress::new(&mut tell))
}

/// Writes the bits of each point.
fn mark(flags: &mut [u8], found: &NormalReport) {
    flags.fill(0);
    let kinds = [
        (KO_POINT_COPY, &found.copies),
        (KO_POINT_OUTLIER, &found.outliers),
        (KO_POINT_DEGENERATE, &found.degenerate),
        (KO_POINT_DOUBTFUL, &found.doubtful),
    ];
    for (bit, indices) in kinds {
        indices.iter().for_each(|&i| flags[i as usize] |= bit);
    }
}

impl ko_normal_report {
    /// # Safety
    /// `to` is NULL or points to `size` writable bytes.
    unsafe fn write(to: *mut Self, size: usize, r: &NormalReport) -> Result<()> {
        let report = ko_normal_report {
            struct_size: size,
            n_components: r.n_components as u64,
            n_copies: r.copies.len() as u64,
            n_outliers: r.outliers.len() as u64,
            n_degenerate: r.degenerate.len() as u64,
            n_doubtful: r.doubtful.len() as u64,
            agreement: r.agreement,
            seconds: r.seconds,
        };
        // SAFETY: the caller's promise.
        unsafe { write_sized(to, size, report, "report") }
    }
}
