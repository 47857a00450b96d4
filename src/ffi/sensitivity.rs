//! `ko_sensitivity`.

use super::cloud::ko_cloud;
use super::field::ko_field;
use super::fit_options::ko_fit_options;
use super::guard::{guard, guard_free};
use super::mesh::check_count;
use super::pointer::{array, array_or_none, create, free, object, place, wanted};
use super::progress::listener;
use crate::Result;
use crate::dimension::{OfDimension, differ, in_its_dimension};
use crate::field::sensitivity::{Derivatives, Effort, Functional, Sensitivity};
use crate::progress::Progress;

/// How values of a field change as its cloud does: a field and its cloud, ready for any number of `ko_sensitivity_solve`. Freed by
/// `ko_sensitivity_free`.
#[allow(non_camel_case_types)]
pub struct ko_sensitivity(OfDimension<Sensitivity<2>, Sensitivity<3>>);

/// Makes ready for the derivatives of values of `field` with respect to the points and normals of `cloud`, to which it was fitted (by
/// `ko_field_fit` or `ko_field_refit`) with `options`; NULL: the defaults.
///
/// Of the options lambda_normal, lambda_smooth and distance_weight tell the energy, and `tolerance` what the field is held to: it must be
/// the minimum to twice that. What reweighting, robust or not, made of the points the field remembers, and where distances are held, but not
/// in a file: a field that was loaded serves where it was fitted with `reweightings` 0. `*sensitivity` is the caller's to free; it refers to neither field nor cloud.
/// Errors: KO_ERR_INVALID_ARGUMENT for a cloud of another dimension or of another number of points, for a point outside the box, naming the
/// first, and for a field that is not the minimum for the cloud and the options, with the residual; KO_ERR_UNSUPPORTED for an option that
/// this library does not know, KO_ERR_OUT_OF_MEMORY with the bytes that it would take, KO_ERR_CANCELLED.
/// Threads: any; `progress` is called on the caller's, and no more after the call. Cost: some passes over points and cells, and nothing is
/// solved; for a field that was loaded the distances are measured again. Memory: that of the fit, and some 250 bytes a point and 100 a control point.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_sensitivity_create(
    field: *const ko_field,
    cloud: *const ko_cloud,
    options: *const ko_fit_options,
    sensitivity: *mut *mut ko_sensitivity,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a field and a cloud.
            let (ko_field(field), ko_cloud(cloud)) = unsafe { (object(field, "field")?, object(cloud, "cloud")?) };
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_fit_options::read(options) }?;
            // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
            let mut tell = unsafe { listener(options.progress, options.progress_data) };
            let (options, mut progress) = (options.to_fit_options()?, Progress::new(&mut tell));
            Ok(ko_sensitivity(match (field, cloud) {
                (OfDimension::Plane(field), OfDimension::Plane(cloud)) => {
                    OfDimension::Plane(Sensitivity::new(field, cloud, &options, &mut progress)?)
                }
                (OfDimension::Space(field), OfDimension::Space(cloud)) => {
                    OfDimension::Space(Sensitivity::new(field, cloud, &options, &mut progress)?)
                }
                _ => return Err(differ(&[("the field", field.dim()), ("the cloud", cloud.dim())])),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(sensitivity, "sensitivity", make) }
    })
}

/// The derivatives of J = sum of w_j phi(x_j), over `points` x [dim * n_points] with `weights` w [n_points], with respect to all points and
/// normals of the cloud: `d_points` [dim * n_cloud_points] and `d_normals` [dim * n_cloud_points].
///
/// By one linear solve, however many points there are: the adjoint of the minimum (11), which Dunn et al. 2023, section 3.5, leave open. m
/// constraints that are to be differentiated apart, such as phi(x_1), ..., phi(x_m), take m calls. `weights` NULL: each is 1. Points may lie
/// outside the box. `n_cloud_points` must be that of `ko_cloud_get_size`; either output may be NULL, and is 0 for points of weight 0.
/// Outputs are in the caller's units: with w without unit `d_points` has none, and `d_normals` is a length. They are derivatives of the
/// field that a refit with KO_REWEIGHT_KEEP gives, with these held: the box, D, the weights, the cells and their levels, what each point
/// counts for after reweighting, and in which cells distances are held, how much, with which sign and to which point. The distances
/// themselves follow the points. Of such refits, solved to 1e-12, differences agree to 1e-6 of |dJ|; phi bends within 1e-4 D where every point
/// moves its own way, so differences want smaller steps, or extrapolation. Normals of a cloud have length 1: `d_normals` is at right angles to
/// them, and the derivative with respect to a normal given with length l is `d_normals` / l. `ko_cloud_pull_back` goes on to the vertices of
/// a mesh.
/// `options` NULL: tolerance, max_iterations and n_threads of `ko_sensitivity_create`, no progress; else those, and `progress`, are taken
/// from them, and nothing else counts. The tolerance is that of |g - A lambda| / |g|, g the derivatives of J by the control points, and with
/// it the relative error of the outputs goes down.
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point or weight that is not finite, and for another n_cloud_points;
/// KO_ERR_NOT_CONVERGED, KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. After an error outputs are unspecified, and the handle serves on.
/// Threads: no other thread may be using the handle. The result depends neither on `n_threads` nor on earlier calls. Cost: that of one
/// solve of a fit, a value at each of `points`, and Hessians of two fields at each point of the cloud; where many iterations seem to be left,
/// the first such call makes a multigrid, which the later ones use.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_sensitivity_solve(
    sensitivity: *mut ko_sensitivity,
    points: *const f64,
    weights: *const f64,
    n_points: usize,
    options: *const ko_fit_options,
    n_cloud_points: usize,
    d_points: *mut f64,
    d_normals: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a handle that no one else uses.
        let ko_sensitivity(sensitivity) = unsafe { place(sensitivity, "sensitivity") }?;
        // SAFETY: the header asks for arrays of these lengths.
        let weights = unsafe { array_or_none(weights, n_points, "weights") }?;
        in_its_dimension!(sensitivity, sensitivity => {
            check_count("n_cloud_points", n_cloud_points, sensitivity.n_points())?;
            // SAFETY: as above, and NULL or arrays to write.
            let (points, to) = unsafe {
                let points = array(points.cast(), n_points, "points")?;
                let by_points = wanted(d_points.cast(), n_cloud_points, "d_points")?;
                (points, Derivatives { points: by_points, normals: wanted(d_normals.cast(), n_cloud_points, "d_normals")? })
            };
            // SAFETY: the header asks for NULL or initialised options.
            unsafe { solve(sensitivity, Functional { points, weights }, options, to) }
        })
    })
}

/// # Safety
/// `options` is NULL or points to as many bytes as its `struct_size` says, with a function that may be called with its `progress_data`.
unsafe fn solve<const D: usize>(
    sensitivity: &mut Sensitivity<D>,
    j: Functional<D>,
    options: *const ko_fit_options,
    to: Derivatives<D>,
) -> Result<()> {
    if options.is_null() {
        return sensitivity.solve(j, None, to, &mut Progress::silent());
    }
    // SAFETY: the caller's promise.
    let options = unsafe { ko_fit_options::read(options) }?;
    // SAFETY: the caller's promise.
    let mut tell = unsafe { listener(options.progress, options.progress_data) };
    let options = options.to_fit_options()?;
    options.validate::<D>()?;
    sensitivity.solve(j, Some(Effort::from(&options)), to, &mut Progress::new(&mut tell))
}

/// Frees a sensitivity. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_sensitivity_free(sensitivity: *mut ko_sensitivity) {
    // SAFETY: the header asks for NULL or a sensitivity that was not freed.
    guard_free(|| unsafe { free(sensitivity) });
}
