//! `ko_field`.

use super::cloud::ko_cloud;
use super::fit_options::{feasible as side, ko_fit_options};
use super::guard::{guard, guard_free, guard_with_remark};
use super::mesh::{check_count, copied};
use super::pointer::{array, array_mut, create, free, object, path, wanted};
use super::progress::listener;
use super::report::ko_fit_report;
use super::status::{KO_BUDGET_REACHED, KO_OK};
use crate::dimension::{OfDimension, differ, in_its_dimension, no_dim};
use crate::field::eval::packed;
use crate::field::{self, Feasible, Field, FitOptions, Lattice, Outputs, domain};
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_char;
use std::sync::Arc;

/// A level-set function phi, close to the signed distance to a shape. Freed by `ko_field_free`.
#[allow(non_camel_case_types)]
pub struct ko_field(pub(super) OfDimension<Arc<Field<2>>, Arc<Field<3>>>);

/// Shared, so that constraints may hold it.
fn shared(field: OfDimension<Field<2>, Field<3>>) -> ko_field {
    ko_field(match field {
        OfDimension::Plane(field) => OfDimension::Plane(Arc::new(field)),
        OfDimension::Space(field) => OfDimension::Space(Arc::new(field)),
    })
}

/// Fits a field to `cloud`: the minimum of the energy (10) of Dunn et al. 2023 over cubic B-splines on a box around the cloud, with the
/// smoothness integrated exactly, distances held away from the surface, and points that the surface misses weighted more.
///
/// `options` NULL: the defaults. phi > 0 on the feasible side; |phi| is close to the distance near the surface and smooth everywhere.
/// `*field` is the caller's to free; it does not refer to the cloud. With `max_error` its cells are refined where the error is larger: by
/// hierarchical B-splines, C2 as well (Kraft 1997).
/// Returns KO_BUDGET_REACHED, a success, where `max_error` was not reached within `max_unknowns` and `memory_limit`, or by cells as fine as
/// the points tell. Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range or D outside [1e-90, 1e90], KO_ERR_DEGENERATE for points
/// that are all equal and for normals that cancel out, KO_ERR_UNSUPPORTED for an option that this library does not know and for
/// KO_REWEIGHT_ROBUST with `max_error`, KO_ERR_OUT_OF_MEMORY with the bytes that it would take, KO_ERR_NOT_CONVERGED, KO_ERR_CANCELLED.
/// Threads: any; `progress` is called on the caller's. Cost: an iteration takes some 30 ns a point and 25 ns a control point on one
/// thread; a hundred or two are usual. Where many more seem to be left the solve goes on by multigrid, in some ten iterations however many
/// control points there are, each at fifteen times the cost. Memory: about 600 bytes a point and 200 a control point; a multigrid takes up
/// to 4000 a control point more, for a million of them 700 to 1700, and is left out where `memory_limit` has no room for it. With
/// `max_error` there is no multigrid: a control point takes some 350 bytes, and the solves some hundreds of iterations in all with
/// default options, but thousands with a margin of several times the shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_fit(
    cloud: *const ko_cloud,
    options: *const ko_fit_options,
    field: *mut *mut ko_field,
) -> i32 {
    guard_with_remark(|| {
        let mut remark = KO_OK;
        let make = || {
            // SAFETY: the header asks for a cloud.
            let ko_cloud(cloud) = unsafe { object(cloud, "cloud") }?;
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_fit_options::read(options) }?;
            // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
            let mut tell = unsafe { listener(options.progress, options.progress_data) };
            let (options, mut progress) = (options.to_fit_options()?, Progress::new(&mut tell));
            let field = match cloud {
                OfDimension::Plane(cloud) => OfDimension::Plane(Field::fit(cloud, &options, &mut progress)?),
                OfDimension::Space(cloud) => OfDimension::Space(Field::fit(cloud, &options, &mut progress)?),
            };
            remark = remark_on(&field, &options);
            Ok(shared(field))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(field, "field", make) }?;
        Ok(remark)
    })
}

/// Fits a field to `cloud` on the box of `start`, from its control points on: for a shape that moves a little from fit to fit, which then
/// takes few iterations.
///
/// As `ko_field_fit`, but that the options' control points and margin do not count. `*field` is the caller's to free; it refers to neither
/// `start` nor the cloud, and `start` stays as it is.
/// With `max_error` the cells of `start` are refined further where they must be; those that it has stay. With KO_REWEIGHT_KEEP the points of
/// the cloud are those of the fit of `start`, as many in the same order, moved: each counts for what it counted for there, D is the one of
/// `start`, distances are held where they were, and one solve does, where the default measures and reweights as a fit does. A field that was
/// loaded or made does not know what points counted for.
/// Returns KO_BUDGET_REACHED as `ko_field_fit` does. Errors: those of `ko_field_fit`; KO_ERR_INVALID_ARGUMENT for a cloud of another
/// dimension or, with KO_REWEIGHT_KEEP, of another number of points, for a point outside the box, naming the first, and for a cloud of a
/// diagonal of less than a hundredth of the longest cell; KO_ERR_UNSUPPORTED for KO_REWEIGHT_ROBUST where `start` has refined cells. Threads,
/// cost, memory: those of `ko_field_fit`, in fewer iterations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_refit(
    start: *const ko_field,
    cloud: *const ko_cloud,
    options: *const ko_fit_options,
    field: *mut *mut ko_field,
) -> i32 {
    guard_with_remark(|| {
        let mut remark = KO_OK;
        let make = || {
            // SAFETY: the header asks for a field and a cloud.
            let (ko_field(start), ko_cloud(cloud)) = unsafe { (object(start, "start")?, object(cloud, "cloud")?) };
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_fit_options::read(options) }?;
            // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
            let mut tell = unsafe { listener(options.progress, options.progress_data) };
            let (options, mut progress) = (options.to_fit_options()?, Progress::new(&mut tell));
            let field = match (start, cloud) {
                (OfDimension::Plane(start), OfDimension::Plane(cloud)) => {
                    OfDimension::Plane(start.refit(cloud, &options, &mut progress)?)
                }
                (OfDimension::Space(start), OfDimension::Space(cloud)) => {
                    OfDimension::Space(start.refit(cloud, &options, &mut progress)?)
                }
                _ => return Err(differ(&[("start", start.dim()), ("the cloud", cloud.dim())])),
            };
            remark = remark_on(&field, &options);
            Ok(shared(field))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(field, "field", make) }?;
        Ok(remark)
    })
}

/// `KO_BUDGET_REACHED` where refinement left a larger error than was asked for.
fn remark_on(field: &OfDimension<Field<2>, Field<3>>, options: &FitOptions) -> i32 {
    let max = in_its_dimension!(field, field => field.report().max);
    if options.max_error > 0.0 && max > options.max_error { KO_BUDGET_REACHED } else { KO_OK }
}

/// Makes a field (5) of given control points: one that another library fitted, say, or an optimiser moved.
///
/// `dim` is 2 or 3. `counts` [dim], at least 4 each, are the control points along each axis of the box from `box_min` [dim] to `box_max`
/// [dim], an axis of n having n - 3 cells; `control_points` [n_control_points], as many as the product of the counts, row-major, the last
/// axis contiguous, are in the caller's unit of length, like the box and `diagonal`, the D that the field's report shall have. `feasible`
/// is KO_FEASIBLE_OUTSIDE or KO_FEASIBLE_INSIDE. The arrays are copied. `*field` is the caller's to free; what its report says of a fit is
/// 0.
/// Errors: KO_ERR_INVALID_ARGUMENT for fewer control points along an axis, for another number of them in all, for one that is not finite or
/// beyond 1e100, naming the first, for a box that is none, for cells or a diagonal outside [1e-90, 1e90]; KO_ERR_OUT_OF_MEMORY. Threads:
/// any. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_from_control_points(
    dim: u32,
    counts: *const u32,
    box_min: *const f64,
    box_max: *const f64,
    feasible: i32,
    diagonal: f64,
    control_points: *const f64,
    n_control_points: usize,
    field: *mut *mut ko_field,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for an array of this length.
            let numbers = unsafe { array(control_points, n_control_points, "control_points") }?;
            let given = Given { numbers, feasible: side(feasible)?, diagonal };
            Ok(shared(match dim {
                // SAFETY: the header asks for arrays of `dim` entries.
                2 => OfDimension::Plane(unsafe { from_control_points(counts, [box_min, box_max], given) }?),
                // SAFETY: as above.
                3 => OfDimension::Space(unsafe { from_control_points(counts, [box_min, box_max], given) }?),
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(field, "field", make) }
    })
}

/// What a field of control points has beside its grid.
struct Given<'a> {
    numbers: &'a [f64],
    feasible: Feasible,
    diagonal: f64,
}

/// # Safety
/// `counts` and the corners of the box are NULL or arrays of D.
unsafe fn from_control_points<const D: usize>(
    counts: *const u32,
    [box_min, box_max]: [*const f64; 2],
    given: Given,
) -> Result<Field<D>> {
    // SAFETY: the caller's promise, for each of these.
    let (counts, lower, upper) = unsafe {
        let counts = object(counts.cast::<[u32; D]>(), "counts")?;
        (counts, object(box_min.cast(), "box_min")?, object(box_max.cast(), "box_max")?)
    };
    let grid = domain::grid_of_box(lower, upper, counts)?;
    Field::from_control_points(grid, copied(given.numbers, "the control points")?, given.feasible, given.diagonal)
}

/// Copies the control points of (5) to `control_points` [n_control_points], row-major, the last axis contiguous, in the cloud's unit of
/// length.
///
/// `n_control_points` must be `n_unknowns` of `ko_field_get_report`, which tells the counts and the box too. Errors:
/// KO_ERR_INVALID_ARGUMENT; KO_ERR_UNSUPPORTED for a field with `n_levels` above 1, whose control points are no tensor. Threads: any. Cost:
/// a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_copy_control_points(
    field: *const ko_field,
    n_control_points: usize,
    control_points: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a field.
        let ko_field(field) = unsafe { object(field, "field") }?;
        if in_its_dimension!(field, field => field.is_refined()) {
            let text = "the field is refined, so that its control points are no tensor; fit with max_error 0 for one";
            return Err(Error::Unsupported(text.into()));
        }
        let from = in_its_dimension!(field, field => field.coefficients());
        check_count("n_control_points", n_control_points, from.len())?;
        // SAFETY: the header asks for an array of this length.
        unsafe { array_mut(control_points, n_control_points, "control_points") }?.copy_from_slice(from);
        Ok(())
    })
}

/// Evaluates the field at `points` [dim * n_points]: `values` [n_points] in the cloud's unit of length, `gradients` [dim * n_points],
/// `hessians` by rows of the upper triangle, in space [6 * n_points], xx xy xz yy yz zz, in the plane [3 * n_points], xx xy yy.
///
/// Each output may be NULL. Analytic derivatives of (5). Outside the box, where (5) ends, the field goes on, C2 and growing like a
/// distance: with t the distance beyond a face along an axis, l a quarter of the edge of the shortest cells on faces, s = l tanh(t / l), P
/// the boundary cell's polynomial, r the length of the vector of t - s over the axes, L the box's diagonal and m the mean of phi over the
/// faces,
///     phi = m + (P(face + s) - m) L^2 / (L^2 + r^2) + sigma r.
/// sigma is the sign of m: for a closed shape +1 when feasible is outside, -1 when it is inside, so |phi| grows on the way out, and the
/// gradient tends to length 1. Where |m| is at most half the mean of |phi| on the faces (a sheet that reaches the box), m = 0 and
/// sigma = tanh(P / longest cell edge), steep where P crosses 0. `ko_field_outside_box` tells which points are outside.
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150; outputs are
/// unspecified then.
/// Threads: any number at once. Cost: 10 to 20 ns a point with gradient on one thread where the field fits into a cache, twice that without
/// AVX2, some two to three times where it is refined, and some 150 ns outside the box; no allocation, no lock. A field of more than some 8
/// MB waits for memory, up to 160 ns a point: there batches of a point and more for 256 control points, and of 8192 at least, are taken in
/// an order that keeps to the same control points, for which some 7 bytes a point are allocated, 4 MB at most, and up to half the time is saved;
/// where they cannot be had, points are taken as they come.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_eval(
    field: *const ko_field,
    points: *const f64,
    n_points: usize,
    values: *mut f64,
    gradients: *mut f64,
    hessians: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a field.
        let ko_field(field) = unsafe { object(field, "field") }?;
        in_its_dimension!(field, field => {
            // SAFETY: the header asks for arrays of these lengths.
            let (points, outputs) = unsafe { batch(points, n_points, values, gradients, hessians) }?;
            field.eval(points, outputs)
        })
    })
}

/// `ko_field_eval` with the batch spread over `n_threads` threads (0: all cores, 1: none but the caller's); the same bits.
///
/// Errors: those of `ko_field_eval`; KO_ERR_INVALID_ARGUMENT for more than 1024 threads; KO_ERR_OUT_OF_MEMORY for threads
/// that do not start. A batch of at most 4096 points stays on the caller's thread.
/// Threads: any number at once. Cost: the caller's thread takes part; the others are started and joined, some 50 microseconds: for batches
/// of many thousand points. A caller that has a thread for each core already takes `n_threads` 1, or `ko_field_eval`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_eval_parallel(
    field: *const ko_field,
    points: *const f64,
    n_points: usize,
    values: *mut f64,
    gradients: *mut f64,
    hessians: *mut f64,
    n_threads: u32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a field.
        let ko_field(field) = unsafe { object(field, "field") }?;
        in_its_dimension!(field, field => {
            // SAFETY: the header asks for arrays of these lengths.
            let (points, outputs) = unsafe { batch(points, n_points, values, gradients, hessians) }?;
            field.eval_parallel(points, outputs, n_threads)
        })
    })
}

/// Evaluates the field at the points of an affine lattice, a line, a slice or, in space, a box, in any directions: those at `origin` [dim]
/// plus i_1 steps_1 + ... + i_k steps_k, 0 <= i_j < counts_j, for k = `n_steps` rows of `steps` [dim * n_steps] and `counts` [n_steps].
///
/// `n_steps` is at least 1 and at most dim. `values` [n] and `gradients` [dim * n], n the product of the counts, are row-major, the last
/// index fastest; either may be NULL. They are those of `ko_field_eval` at these points, inside the box and outside it, on `n_threads`
/// threads (0: all cores, 1: none but the caller's), with the same bits on any number.
/// Errors: KO_ERR_INVALID_ARGUMENT for a number of steps out of range, a count of 0, more points than memory can count, an origin or step
/// that is not finite, a corner of the lattice beyond 1e150, more than 1024 threads; KO_ERR_OUT_OF_MEMORY for threads that do not start.
/// Nothing is written then.
/// Threads: any number at once. Cost: that of `ko_field_eval`; takes some kilobytes, and starts and joins threads for more than 4096
/// points.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_eval_lattice(
    field: *const ko_field,
    origin: *const f64,
    steps: *const f64,
    counts: *const usize,
    n_steps: u32,
    values: *mut f64,
    gradients: *mut f64,
    n_threads: u32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a field.
        let ko_field(field) = unsafe { object(field, "field") }?;
        in_its_dimension!(field, field => {
            // SAFETY: the header asks for arrays of these lengths.
            let lattice = unsafe { lattice(origin, steps, counts, n_steps) }?;
            // SAFETY: the header asks for NULL or arrays of these lengths.
            let (values, gradients) = unsafe {
                let values = wanted(values, lattice.len(), "values")?;
                (values, wanted(gradients.cast(), lattice.len(), "gradients")?)
            };
            field.eval_lattice(&lattice, values, gradients, n_threads, &mut Progress::silent())
        })
    })
}

/// # Safety
/// Each pointer is NULL or points to an array of the length that `ko_field_eval_lattice` documents.
unsafe fn lattice<const D: usize>(
    origin: *const f64,
    steps: *const f64,
    counts: *const usize,
    n_steps: u32,
) -> Result<Lattice<D>> {
    let k = n_steps as usize;
    if !(1..=D).contains(&k) {
        return Err(Error::InvalidArgument(format!("n_steps is {k}; it must lie in [1, {D}] for a field of dim {D}")));
    }
    // SAFETY: the caller's promise, for each of these.
    let (origin, steps, counts) = unsafe {
        let origin = object(origin.cast::<[f64; D]>(), "origin")?;
        (origin, array(steps.cast::<[f64; D]>(), k, "steps")?, array(counts, k, "counts")?)
    };
    Lattice::new(*origin, steps, counts)
}

/// Writes to `outside` [n_points] 1 for each of `points` [dim * n_points] outside the field's box, 0 for each inside or on a face.
///
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150. Threads: any number at
/// once. No allocation, no lock.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_outside_box(
    field: *const ko_field,
    points: *const f64,
    n_points: usize,
    outside: *mut u8,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a field.
        let ko_field(field) = unsafe { object(field, "field") }?;
        // SAFETY: the header asks for arrays of these lengths.
        let outside = unsafe { array_mut(outside, n_points, "outside") }?;
        in_its_dimension!(field, field => {
            // SAFETY: as above.
            field.outside_box(unsafe { array(points.cast(), n_points, "points") }?, outside)
        })
    })
}

/// Fills `report` with what the field is and what its fit did. `struct_size` is sizeof *report.
///
/// Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_get_report(
    field: *const ko_field,
    struct_size: usize,
    report: *mut ko_fit_report,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a field.
        let ko_field(field) = unsafe { object(field, "field") }?;
        // SAFETY: the header asks for a struct of this size.
        in_its_dimension!(field, field => unsafe { ko_fit_report::write(report, struct_size, field) })
    })
}

/// Writes the field to the file `path`: little-endian, with version and checksum, the same on every machine.
///
/// A file that stood there is replaced whole or, after an error, left as it was.
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or an empty path, KO_ERR_IO. Threads: any. Cost: one pass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_save(field: *const ko_field, path: *const c_char) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a field and a NUL-terminated path.
        let (ko_field(field), path) = unsafe { (object(field, "field")?, self::path(path, "path")?) };
        in_its_dimension!(field, field => field.save(path))
    })
}

/// Reads a field that `ko_field_save` wrote; it evaluates to the same bits. `*field` is the caller's to free.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or an empty path; KO_ERR_IO; KO_ERR_FORMAT for a file that is no field, of another version, cut
/// short or altered; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: one pass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_load(path: *const c_char, field: *mut *mut ko_field) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a NUL-terminated path and a handle to write.
        unsafe { create(field, "field", || Ok(shared(field::load(self::path(path, "path")?)?))) }
    })
}

/// Frees a field. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_free(field: *mut ko_field) {
    // SAFETY: the header asks for NULL or a field that was not freed.
    guard_free(|| unsafe { free(field) });
}

/// The arguments of an evaluation.
///
/// # Safety
/// Each pointer is NULL or points to an array of the length that `ko_field_eval` documents, outputs used by no one else.
unsafe fn batch<'a, const D: usize>(
    points: *const f64,
    n: usize,
    values: *mut f64,
    gradients: *mut f64,
    hessians: *mut f64,
) -> Result<(&'a [[f64; D]], Outputs<'a, D>)> {
    // SAFETY: the caller's promise, for each of these.
    unsafe {
        let points = array(points.cast(), n, "points")?;
        let outputs = Outputs {
            values: wanted(values, n, "values")?,
            gradients: wanted(gradients.cast(), n, "gradients")?,
            hessians: wanted(hessians, n.saturating_mul(packed::<D>()), "hessians")?,
        };
        Ok((points, outputs))
    }
}
