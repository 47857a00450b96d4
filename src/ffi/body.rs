//! `ko_body`.

use super::guard::{guard, guard_free};
use super::mesh::{check_count, ko_mesh};
use super::pointer::{array, array_mut, create, free, object, place};
use crate::constraint::Body;
use crate::dimension::{OfDimension, in_its_dimension};
use crate::{Error, Result};
use std::sync::Arc;

/// Points of a design that move with it, and how densely they cover its surface. Freed by `ko_body_free`; constraints that were made of it
/// go on.
#[allow(non_camel_case_types)]
pub struct ko_body(pub(super) OfDimension<Arc<Body<2>>, Arc<Body<3>>>);

/// Makes a body of `points` [dim * n_points] in a frame of its own.
///
/// `dim` is 2 or 3. No point of the body's surface must be farther than `covering_radius` from one of its points, in their unit of length;
/// 0 where that is not known, or the points are all there is. The points are copied. `*body` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for no points or more than 2^30, for one that is not finite or beyond 1e90, naming the first, for a
/// radius below 0; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_body_from_points(
    dim: u32,
    points: *const f64,
    n_points: usize,
    covering_radius: f64,
    body: *mut *mut ko_body,
) -> i32 {
    guard(|| {
        let make = || {
            Ok(ko_body(match dim {
                // SAFETY: the header asks for an array of this length.
                2 => OfDimension::Plane(unsafe { from_points(points, n_points, covering_radius) }?),
                // SAFETY: as above.
                3 => OfDimension::Space(unsafe { from_points(points, n_points, covering_radius) }?),
                _ => return Err(Error::InvalidArgument(format!("dim is {dim}; it must be 2 or 3"))),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(body, "body", make) }
    })
}

/// # Safety
/// `points` is NULL or an array of D times `n`.
unsafe fn from_points<const D: usize>(points: *const f64, n: usize, covering_radius: f64) -> Result<Arc<Body<D>>> {
    // SAFETY: the caller's promise.
    let points = unsafe { array(points.cast::<[f64; D]>(), n, "points") }?;
    Ok(Arc::new(Body::new(points, covering_radius)?))
}

/// Makes a body of points on `mesh`, so many that no point of its triangles, in the plane of its segments, is farther than
/// `covering_radius` from one of them, in the mesh's unit of length.
///
/// They are the vertices of its facets, halved along their longest edges until these are at most sqrt(3) radii long, in the plane 2: a
/// surface of area S gets some 0.7 to 1.3 S / radius^2 beside the mesh's own. `*body` is the caller's to free; it does not refer to the mesh.
/// Errors: KO_ERR_INVALID_ARGUMENT for a radius outside [1e-90, 1e90], or so small that it asks for more than 2^30 points or for points
/// that doubles do not tell apart: at once where area or length alone tell so, with the smallest radius that they let through;
/// KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: less than a microsecond, and some 100 bytes, a point.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_body_from_mesh(mesh: *const ko_mesh, covering_radius: f64, body: *mut *mut ko_body) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a mesh.
            let ko_mesh(mesh) = unsafe { object(mesh, "mesh") }?;
            Ok(ko_body(match mesh {
                OfDimension::Plane(mesh) => OfDimension::Plane(Arc::new(Body::on_mesh(mesh, covering_radius)?)),
                OfDimension::Space(mesh) => OfDimension::Space(Arc::new(Body::on_mesh(mesh, covering_radius)?)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(body, "body", make) }
    })
}

/// Frees a body. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_body_free(body: *mut ko_body) {
    // SAFETY: the header asks for NULL or a body that was not freed.
    guard_free(|| unsafe { free(body) });
}

/// Tells the dimension of the body, 2 or 3. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_body_get_dim(body: *const ko_body, dim: *mut u32) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a body and a place to write.
        let (ko_body(body), dim) = unsafe { (object(body, "body")?, place(dim, "dim")?) };
        *dim = body.dim();
        Ok(())
    })
}

/// Tells how many points the body has. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_body_get_size(body: *const ko_body, n_points: *mut usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a body and a place to write.
        let (ko_body(body), n_points) = unsafe { (object(body, "body")?, place(n_points, "n_points")?) };
        *n_points = in_its_dimension!(body, body => body.len());
        Ok(())
    })
}

/// Tells the body's covering radius in its own unit of length: in a frame of scale s it is s times that. 0 where it is not known. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_body_get_covering_radius(body: *const ko_body, covering_radius: *mut f64) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a body and a place to write.
        let (ko_body(body), radius) = unsafe { (object(body, "body")?, place(covering_radius, "covering_radius")?) };
        *radius = in_its_dimension!(body, body => body.covering_radius());
        Ok(())
    })
}

/// Copies the body's points to `points` [dim * n_points].
///
/// `n_points` must be that of `ko_body_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_body_copy_points(body: *const ko_body, n_points: usize, points: *mut f64) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a body.
        let ko_body(body) = unsafe { object(body, "body") }?;
        // SAFETY: the header asks for an array of this length.
        in_its_dimension!(body, body => unsafe { copy(body, n_points, points) })
    })
}

/// # Safety
/// `points` is NULL or an array of D times `n`, used by no one else.
unsafe fn copy<const D: usize>(body: &Body<D>, n: usize, points: *mut f64) -> Result<()> {
    check_count("n_points", n, body.len())?;
    // SAFETY: the caller's promise.
    let to = unsafe { array_mut(points.cast::<[f64; D]>(), n, "points") }?;
    to.iter_mut().zip(body.points()).for_each(|(to, p)| *to = p);
    Ok(())
}
