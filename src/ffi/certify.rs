//! Certificates of `ko_field`.

use super::field::ko_field;
use super::guard::{guard, guard_with_remark};
use super::mesh::ko_mesh;
use super::pointer::{Sized_, check_sized, object, read_sized_or, write_sized};
use super::progress::{ko_progress, listener};
use super::status::{KO_BUDGET_REACHED, KO_OK, KO_SIDE_NOT_CERTIFIED};
use crate::dimension::{OfDimension, differ};
use crate::field::{Certificate, CertifyOptions};
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_void;

/// Options of `ko_field_certify`. Initialise by `ko_certify_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_certify_options {
    /// sizeof(ko_certify_options), set by ko_certify_options_init.
    pub struct_size: usize,
    /// How far bounds may be above the largest value that is found, as a fraction of it, or of 1e-3 D where it is less; in [1e-4, 1e4].
    /// Default 0.05.
    pub tolerance: f64,
    /// Bounds that each of four searches may take of boxes that it splits off, at least 1: one a box, and one for each cell that a piece of
    /// the shape meets. Where more are needed the search's result is sound but looser, and the call ends with KO_BUDGET_REACHED. Beside the
    /// first look at every cell and triangle it bounds time, a few microseconds a bound, and memory, some 150 bytes a bound. Default 4000000.
    pub max_boxes: u64,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: repr(C), starts with a usize, and no padding, by the order of its fields (checked below). Every pattern of bits is a value:
// `progress` may be any address, as in C, and is only ever called as the caller promised.
unsafe impl Sized_ for ko_certify_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 24 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_certify_options>() == <ko_certify_options as Sized_>::FIRST_SIZE);

/// What was certified of a field. Filled by `ko_field_certify`. Lengths are in the mesh's unit.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_certificate {
    /// sizeof(ko_certificate) as the caller knows it.
    pub struct_size: usize,
    /// t: larger than phi, as `ko_field_eval` gives it, at every point that is on the infeasible side or within the clearance and the
    /// covering radius together of the shape; in the box and beyond it.
    pub threshold: f64,
    /// The largest phi that was found at such points: `threshold` over it tells how tight the threshold is at least.
    pub largest_found: f64,
    /// Where that was; z is 0 in the plane. A finer field there, or a field that fits better, lowers the threshold.
    pub place: [f64; 3],
    /// eps: at least |phi| at every point of the shape. Infinite where a budget ended before triangles longer than two cells were cut up.
    pub surface_error: f64,
    /// G: at least the length of grad phi at every point of the box.
    pub steepest: f64,
    /// At least the length of grad phi at every point beyond the box, often by a fifth too large or more; infinite where the box's faces are
    /// of both sides.
    pub steepest_beyond: f64,
    /// Boxes that were looked at.
    pub n_boxes: u64,
    /// Components of the shape, as `ko_mesh_get_component_count` tells.
    pub n_components: u64,
    /// 1: the mesh bounds a solid, so that the infeasible side has its part in `threshold`. 0: KO_SIDE_NOT_CERTIFIED.
    pub side_certified: i32,
    /// 1: a search ended before its tolerance was reached; that for `steepest_beyond` does not count.
    pub budget_reached: i32,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_certificate {
    const FIRST_SIZE: usize = size_of::<usize>() + 11 * 8;
}

const _: () = assert!(size_of::<ko_certificate>() == <ko_certificate as Sized_>::FIRST_SIZE);

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_certify_options_init(options: *mut ko_certify_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_certify_options::defaults(), "options") }
    })
}

impl ko_certify_options {
    fn defaults() -> Self {
        let d = CertifyOptions::default();
        ko_certify_options {
            struct_size: size_of::<ko_certify_options>(),
            tolerance: d.tolerance,
            max_boxes: d.max_boxes,
            n_threads: d.n_threads,
            reserved: 0,
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

    /// The same for the certificate.
    fn to_certify_options(self) -> Result<CertifyOptions> {
        if self.reserved != 0 {
            return Err(Error::InvalidArgument(format!("reserved is {}; it must be 0", self.reserved)));
        }
        Ok(CertifyOptions { tolerance: self.tolerance, n_threads: self.n_threads, max_boxes: self.max_boxes })
    }
}

impl ko_certificate {
    fn of<const D: usize>(c: &Certificate<D>) -> Self {
        ko_certificate {
            struct_size: size_of::<ko_certificate>(),
            threshold: c.threshold,
            largest_found: c.largest_found,
            // In the plane what belongs to z is 0.
            place: [0, 1, 2].map(|a| c.place.get(a).copied().unwrap_or(0.0)),
            surface_error: c.surface_error,
            steepest: c.steepest,
            steepest_beyond: c.steepest_beyond,
            n_boxes: c.n_boxes,
            n_components: c.n_components as u64,
            side_certified: i32::from(c.is_side_certified),
            budget_reached: i32::from(c.is_budget_reached),
        }
    }

    fn status(&self) -> i32 {
        match (self.side_certified, self.budget_reached) {
            (0, _) => KO_SIDE_NOT_CERTIFIED,
            (_, 0) => KO_OK,
            _ => KO_BUDGET_REACHED,
        }
    }
}

/// Certifies `field` against `mesh`, the shape that it was fitted to: gives a threshold t such that phi >= t at the samples of a body proves
/// that the whole body is on the feasible side and farther than `clearance` from the shape.
///
/// `clearance` d and `covering_radius` r, at least 0 and in the mesh's unit, are the distance that is wanted and the covering radius of the
/// body's samples: every point of its surface is within r of one. t is larger than phi at every point that is on the infeasible side or
/// within d + r of the shape, where the field is continued beyond its box too. `options` NULL: the defaults. `certificate_size` is sizeof
/// *certificate.
///
/// The proof: a sample with phi >= t is on the feasible side and farther than d + r from the shape. So every point of the body's surface is
/// on the feasible side, since the side changes only on the shape, and farther than d. Each component of the shape is then in the body or
/// off it as a whole. To exclude that the body swallowed one, test the points of `ko_mesh_copy_component_points` against the body: once
/// each of them is outside it, all of the body is on the feasible side and farther than d from the shape. An aggregate that is at most
/// the least phi, KS(min) say, serves for phi at the samples. Values of `ko_constraints` are s phi, s the scale of the field's frame: the
/// test is value >= s t then; and d and r count in the field's frame, where lengths of the world are 1 / s times as long. A body in a frame of
/// scale b has its samples b times as far apart, so r is b / s times its covering radius, with the largest b and the least s that there may
/// be where scales are free. What a pose rounds is the caller's to add to r: some 1e-15 of the coordinates.
///
/// t comes from a search by boxes, split where phi is large, with phi between its Bezier points on each and exact distances to the mesh;
/// what rounding can do is added. The mesh bounds a solid where every edge is run through as often one way as the other and the volume is
/// positive. Elsewhere sides are not certified: t covers what is within d + r of the shape, on both sides.
/// Returns KO_SIDE_NOT_CERTIFIED, a success, for a mesh that bounds no solid; KO_BUDGET_REACHED, a success, where `max_boxes` made a bound
/// looser than `tolerance`. The certificate tells of both. The same input gives the same bits.
/// Errors: KO_ERR_INVALID_ARGUMENT for a length or an option out of its range, for a mesh of another dimension, and where the coordinates and
/// d + r together are above 1e11 times the shortest cell, so that rounding would lose the cells; KO_ERR_DEGENERATE where
/// phi grows without end on the infeasible side, as of a field that does not have this mesh inside its box, or with the other side
/// feasible; KO_ERR_UNSUPPORTED for an option that this library does not know; KO_ERR_OUT_OF_MEMORY; KO_ERR_CANCELLED.
/// Threads: any number at once; `progress` is called on the caller's. Cost: every cell is bounded, a microsecond or two, and every triangle;
/// then boxes are split near the largest phi, the fewer the more it stands out. The mesh keeps the tree of its distances, about 200 bytes
/// a triangle, as after `ko_mesh_signed_distance`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_certify(
    field: *const ko_field,
    mesh: *const ko_mesh,
    clearance: f64,
    covering_radius: f64,
    options: *const ko_certify_options,
    certificate_size: usize,
    certificate: *mut ko_certificate,
) -> i32 {
    guard_with_remark(|| {
        // SAFETY: the header asks for a field and a mesh.
        let (ko_field(field), ko_mesh(mesh)) = unsafe { (object(field, "field")?, object(mesh, "mesh")?) };
        // SAFETY: the header asks for NULL or initialised options.
        let options = unsafe { ko_certify_options::read(options) }?;
        // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
        let mut tell = unsafe { listener(options.progress, options.progress_data) };
        let (options, mut progress) = (options.to_certify_options()?, Progress::new(&mut tell));
        // Before the work, not after it.
        check_sized(certificate, certificate_size, "certificate")?;
        let found = match (field, mesh) {
            (OfDimension::Plane(field), OfDimension::Plane(mesh)) => {
                ko_certificate::of(&field.certify(mesh, clearance, covering_radius, &options, &mut progress)?)
            }
            (OfDimension::Space(field), OfDimension::Space(mesh)) => {
                ko_certificate::of(&field.certify(mesh, clearance, covering_radius, &options, &mut progress)?)
            }
            _ => return Err(differ(&[("the field", field.dim()), ("the mesh", mesh.dim())])),
        };
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(certificate, certificate_size, found, "certificate") }?;
        Ok(found.status())
    })
}
