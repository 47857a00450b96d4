//! `ko_fit_options`.

use super::guard::guard;
use super::pointer::{Sized_, read_sized_or, write_sized};
use super::progress::ko_progress;
use crate::field::{Feasible, FitOptions, Reweighting};
use crate::{Error, Result};
use std::ffi::c_void;

/// phi > 0 on the side that the normals point to: outside a solid. grad phi = +n on the surface.
pub const KO_FEASIBLE_OUTSIDE: i32 = 0;
/// phi > 0 on the other side: inside a solid. grad phi = -n on the surface.
pub const KO_FEASIBLE_INSIDE: i32 = 1;

/// Points that the surface misses count for more: against the largest error, for clouds to be trusted.
pub const KO_REWEIGHT_LARGEST: i32 = 0;
/// Points that disagree with the others count for less, at last for nothing: against noise, outliers and wrong normals. Two solves more,
/// the first of them much smoother.
pub const KO_REWEIGHT_ROBUST: i32 = 1;
/// For `ko_field_refit` alone, of the same points, moved: each counts for what it counted for at last in the fit of `start`, D stays, and
/// distances are held in the same cells, as much, to the points that were nearest then. One solve and nothing to measure: the fastest refit,
/// and that of which `ko_sensitivity_solve` gives the derivatives. After moves of cells' lengths refit by the default.
pub const KO_REWEIGHT_KEEP: i32 = 2;

/// Options of `ko_field_fit` and `ko_field_refit`. Initialise by `ko_fit_options_init`, then set what shall differ. Weights have no unit:
/// lengths are taken in units of D, the diagonal of the cloud's bounding box.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_fit_options {
    /// sizeof(ko_fit_options), set by ko_fit_options_init.
    pub struct_size: usize,
    /// Control points along x, y, z: at least 4 each, honoured exactly; 0 (the default) lets the fit choose: near-cubic cells, about
    /// twice as many control points as points, between 4096 and 262144. In the plane z is ignored, and N points get N^2 / 100, between
    /// 1024 and 65536.
    pub control_points: [u32; 3],
    /// Rounds in which points are weighted anew, as `reweighting` says; at most 100. 0: none, the paper's fit; a robust fit weighs them
    /// once all the same. With `max_error` cells are cut instead, and only points reweighted that are missed where no more can be cut.
    /// Default 3.
    pub reweightings: u32,
    /// How much longer than the cloud the box is along each axis, in [0, 100]. Default 0.15: 1.15 times the extents.
    pub margin: f64,
    /// lambda_n of (10): weight of the normals, in [1e-12, 1e12]. Default 1e-4.
    pub lambda_normal: f64,
    /// lambda_r of (10): weight of the smoothness, in [1e-20, 1e12]. Default 3e-10.
    pub lambda_smooth: f64,
    /// Weight of the distance energy (9), kept to cells away from the surface, in units of lambda_smooth / h^4, h the longest cell edge in
    /// units of D. It keeps the sign right far from the data. In [0, 1e6]; 0: none, the paper's fit. Default 150.
    pub distance_weight: f64,
    /// Relative residual of the solve to reach, in [1e-15, 0.5]. Default 1e-4.
    pub tolerance: f64,
    /// KO_FEASIBLE_OUTSIDE (default) or KO_FEASIBLE_INSIDE: where phi > 0.
    pub feasible: i32,
    /// Iterations in all after which not having reached the tolerance is KO_ERR_NOT_CONVERGED; at least 1. Default 20000.
    pub max_iterations: u32,
    /// Bytes that the fit may take; a larger one is refused before any is taken. Default 8 GiB.
    pub memory_limit: u64,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
    /// What the rounds of reweighting are for: KO_REWEIGHT_LARGEST (default) or KO_REWEIGHT_ROBUST; or KO_REWEIGHT_KEEP, for none.
    pub reweighting: i32,
    /// Must be 0.
    pub reserved_2: u32,
    /// Largest error on the surface that is wanted, as a fraction of D, in [1e-9, 1]: cells are halved, again and again, where |phi| at the
    /// cloud's points is larger, and where parts are thin. The grid is then coarse where no `control_points` are asked for, lambda_normal
    /// and lambda_smooth are those of its cells, and fall by 4 and 5 with each halving. Not with KO_REWEIGHT_ROBUST or KO_REWEIGHT_KEEP. 0
    /// (default): one grid.
    pub max_error: f64,
    /// Control points that refinement may take, at least 1; a fit that needs more, or more than `memory_limit`, ends with
    /// KO_BUDGET_REACHED. The grid that it begins with has no more either, but four along each axis, or the `control_points` asked for.
    /// Default 2000000. Without `max_error` it means nothing.
    pub max_unknowns: u64,
}

// SAFETY: repr(C), starts with a usize, and no padding, by the order of its fields (checked below). Every pattern of bits is a value:
// `progress` may be any address, as in C, and is only ever called as the caller promised.
unsafe impl Sized_ for ko_fit_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 80 + size_of::<ko_progress>();
}

const _: () = assert!(std::mem::offset_of!(ko_fit_options, reweighting) == <ko_fit_options as Sized_>::FIRST_SIZE);

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_fit_options_init(options: *mut ko_fit_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_fit_options::defaults(), "options") }
    })
}

impl ko_fit_options {
    fn defaults() -> Self {
        let d = FitOptions::default();
        ko_fit_options {
            struct_size: size_of::<ko_fit_options>(),
            control_points: d.control_points,
            reweightings: d.reweightings,
            margin: d.margin,
            lambda_normal: d.normal_weight,
            lambda_smooth: d.smooth_weight,
            distance_weight: d.distance_weight,
            tolerance: d.tolerance,
            feasible: KO_FEASIBLE_OUTSIDE,
            max_iterations: d.max_iterations,
            memory_limit: d.memory_limit,
            n_threads: d.n_threads,
            reserved: 0,
            progress: None,
            progress_data: std::ptr::null_mut(),
            reweighting: KO_REWEIGHT_LARGEST,
            reserved_2: 0,
            max_error: d.max_error,
            max_unknowns: d.max_unknowns,
        }
    }

    /// The options at `pointer`, or the defaults for NULL.
    ///
    /// # Safety
    /// `pointer` is NULL or points to as many bytes as its `struct_size` says.
    pub(super) unsafe fn read(pointer: *const ko_fit_options) -> Result<Self> {
        // SAFETY: the caller's promise.
        unsafe { read_sized_or(pointer, Self::defaults(), "options") }
    }

    /// The same for the fit.
    pub(super) fn to_fit_options(self) -> Result<FitOptions> {
        let reweighting = match self.reweighting {
            KO_REWEIGHT_LARGEST => Reweighting::Largest,
            KO_REWEIGHT_ROBUST => Reweighting::Robust,
            KO_REWEIGHT_KEEP => Reweighting::Kept,
            other => {
                return Err(Error::InvalidArgument(format!(
                    "reweighting is {other}; it must be KO_REWEIGHT_LARGEST (0), KO_REWEIGHT_ROBUST (1) or KO_REWEIGHT_KEEP (2)"
                )));
            }
        };
        let reserved = [("reserved", self.reserved), ("reserved_2", self.reserved_2)];
        if let Some((name, value)) = reserved.iter().find(|(_, value)| *value != 0) {
            return Err(Error::InvalidArgument(format!("{name} is {value}; it must be 0")));
        }
        Ok(FitOptions {
            control_points: self.control_points,
            margin: self.margin,
            normal_weight: self.lambda_normal,
            smooth_weight: self.lambda_smooth,
            distance_weight: self.distance_weight,
            reweighting,
            reweightings: self.reweightings,
            max_error: self.max_error,
            max_unknowns: self.max_unknowns,
            feasible: feasible(self.feasible)?,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            n_threads: self.n_threads,
            memory_limit: self.memory_limit,
        })
    }
}

/// The side of a `KO_FEASIBLE_` constant.
pub(super) fn feasible(side: i32) -> Result<Feasible> {
    match side {
        KO_FEASIBLE_OUTSIDE => Ok(Feasible::Outside),
        KO_FEASIBLE_INSIDE => Ok(Feasible::Inside),
        other => Err(Error::InvalidArgument(format!(
            "feasible is {other}; it must be KO_FEASIBLE_OUTSIDE (0) or KO_FEASIBLE_INSIDE (1)"
        ))),
    }
}
