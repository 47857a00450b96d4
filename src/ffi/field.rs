//! `ko_field`.

use super::cloud::ko_cloud;
use super::fit_options::ko_fit_options;
use super::guard::{guard, guard_free};
use super::pointer::{array, array_mut, create, free, object, path, wanted};
use super::report::ko_fit_report;
use crate::Result;
use crate::dimension::{OfDimension, in_its_dimension};
use crate::field::eval::packed;
use crate::field::{self, Field, Outputs};
use crate::progress::Progress;
use std::ffi::{CString, c_char};
use std::ops::ControlFlow;

/// A level-set function phi, close to the signed distance to a shape. Freed by `ko_field_free`.
#[allow(non_camel_case_types)]
pub struct ko_field(pub(super) OfDimension<Field<2>, Field<3>>);

/// Fits a field to `cloud`: the minimum of the energy (10) of Dunn et al. 2023 over cubic B-splines on a box around the cloud, with the
/// smoothness integrated exactly, distances held away from the surface, and points that the surface misses weighted more.
///
/// `options` NULL: the defaults. phi > 0 on the feasible side; |phi| is close to the distance near the surface and smooth everywhere.
/// `*field` is the caller's to free; it does not refer to the cloud.
/// Errors: KO_ERR_INVALID_ARGUMENT for an option out of its range or D outside [1e-90, 1e90], KO_ERR_DEGENERATE for points that are all
/// equal and for normals that cancel out, KO_ERR_UNSUPPORTED for an option that this library does not know, KO_ERR_OUT_OF_MEMORY with the
/// bytes that it would take, KO_ERR_NOT_CONVERGED, KO_ERR_CANCELLED.
/// Threads: any; `progress` is called on the caller's. Cost: an iteration takes some 70 ns a point and 40 ns a control point on one
/// thread; a few hundred are usual. Memory: about 600 bytes a point and 200 a control point.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_fit(
    cloud: *const ko_cloud,
    options: *const ko_fit_options,
    field: *mut *mut ko_field,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a cloud.
            let ko_cloud(cloud) = unsafe { object(cloud, "cloud") }?;
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_fit_options::read(options) }?;
            let mut tell = |fraction: f64, stage: &str| match options.progress {
                None => ControlFlow::Continue(()),
                Some(progress) => {
                    let stage = CString::new(stage).unwrap_or_default();
                    // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
                    match unsafe { progress(fraction, stage.as_ptr(), options.progress_data) } {
                        0 => ControlFlow::Continue(()),
                        _ => ControlFlow::Break(()),
                    }
                }
            };
            let (options, mut progress) = (options.to_fit_options()?, Progress::new(&mut tell));
            Ok(ko_field(match cloud {
                OfDimension::Plane(cloud) => OfDimension::Plane(Field::fit(cloud, &options, &mut progress)?),
                OfDimension::Space(cloud) => OfDimension::Space(Field::fit(cloud, &options, &mut progress)?),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(field, "field", make) }
    })
}

/// Evaluates the field at `points` [dim * n_points]: `values` [n_points] in the cloud's unit of length, `gradients` [dim * n_points],
/// `hessians` by rows of the upper triangle, in space [6 * n_points], xx xy xz yy yz zz, in the plane [3 * n_points], xx xy yy.
///
/// Each output may be NULL. Analytic derivatives of (5). Outside the box, where (5) ends, the field goes on, C2 and growing like a distance:
/// with t the distance beyond a face along an axis, l a quarter of the cell's edge there, s = l tanh(t / l), P the boundary cell's
/// polynomial, r the length of the vector of t - s over the axes, L the box's diagonal and m the mean of phi over the faces,
///     phi = m + (P(face + s) - m) L^2 / (L^2 + r^2) + sigma r.
/// sigma is the sign of m: for a closed shape +1 when feasible is outside, -1 when it is inside, so |phi| grows on the way out, and the
/// gradient tends to length 1. Where |m| is at most half the mean of |phi| on the faces (a sheet that reaches the box), m = 0 and
/// sigma = tanh(P / longest cell edge), steep where P crosses 0. `ko_field_outside_box` tells which points are outside.
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150; outputs are
/// unspecified then.
/// Threads: any number at once. Cost: about 50 ns a point with gradient on one thread in cache; no allocation, no lock.
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
/// Threads: any number at once. Cost: starts the threads and joins them, which takes some 100 microseconds and memory: for batches of many
/// thousand points.
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

/// Writes to `outside` [n_points] 1 for each of `points` [dim * n_points] outside the field's box, 0 for each inside or on a face.
///
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite or has a coordinate beyond 1e150. Threads: any number at once.
/// No allocation, no lock.
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
        unsafe { create(field, "field", || Ok(ko_field(field::load(self::path(path, "path")?)?))) }
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
