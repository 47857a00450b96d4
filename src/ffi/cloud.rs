//! `ko_cloud`.

use super::guard::{guard, guard_free};
use super::mesh::{check_count, copied, ko_mesh};
use super::pointer::{array, array_mut, array_or_none, create, free, object, place, wanted};
use crate::dimension::{OfDimension, differ, in_its_dimension, no_dim};
use crate::geometry::orient::NormalOptions;
use crate::geometry::{Cloud, Mesh};
use crate::progress::Progress;
use crate::{Error, Result};

/// Points of a surface in space (dim 3) or of a curve in the plane (dim 2) with unit normals. Freed by `ko_cloud_free`.
#[allow(non_camel_case_types)]
pub struct ko_cloud(pub(super) OfDimension<Cloud<2>, Cloud<3>>);

/// Makes a cloud from `points` [dim * n_points] with `normals` [dim * n_points] out of the solid, of any length but 0.
///
/// `dim` is 2 or 3. NULL normals are estimated, on all cores, by `ko_cloud_estimate_normals` with its default options, where the errors and
/// the cost of that are told. The arrays are copied. `*cloud` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for no points or more than 2^30, for a point or normal that is not finite and for a normal of length 0,
/// naming the first; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: O(n_points).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_from_points(
    dim: u32,
    points: *const f64,
    normals: *const f64,
    n_points: usize,
    cloud: *mut *mut ko_cloud,
) -> i32 {
    guard(|| {
        let make = || {
            Ok(ko_cloud(match dim {
                // SAFETY: the header asks for arrays of these lengths.
                2 => OfDimension::Plane(unsafe { from_points(points, normals, n_points) }?),
                // SAFETY: as above.
                3 => OfDimension::Space(unsafe { from_points(points, normals, n_points) }?),
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(cloud, "cloud", make) }
    })
}

/// # Safety
/// `points` and `normals` are NULL or arrays of D times `n`.
unsafe fn from_points<const D: usize>(points: *const f64, normals: *const f64, n: usize) -> Result<Cloud<D>> {
    // SAFETY: the caller's promise.
    let points = unsafe { array(points.cast::<[f64; D]>(), n, "points") }?;
    Cloud::<D>::check_count(n)?;
    if normals.is_null() {
        let points = copied(points, "the points")?;
        let (cloud, _) = Cloud::with_estimated_normals(points, &NormalOptions::default(), &mut Progress::silent())?;
        return Ok(cloud);
    }
    // SAFETY: as above.
    let normals = unsafe { array(normals.cast::<[f64; D]>(), n, "normals") }?;
    Cloud::new(copied(points, "the points")?, copied(normals, "the normals")?)
}

/// Frees a cloud. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_free(cloud: *mut ko_cloud) {
    // SAFETY: the header asks for NULL or a cloud that was not freed.
    guard_free(|| unsafe { free(cloud) });
}

/// Tells the dimension of the cloud, 2 or 3. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_get_dim(cloud: *const ko_cloud, dim: *mut u32) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a cloud and a place to write.
        let (ko_cloud(cloud), dim) = unsafe { (object(cloud, "cloud")?, place(dim, "dim")?) };
        *dim = cloud.dim();
        Ok(())
    })
}

/// Tells how many points the cloud has. Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_get_size(cloud: *const ko_cloud, n_points: *mut usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a cloud and a place to write.
        let (ko_cloud(cloud), n_points) = unsafe { (object(cloud, "cloud")?, place(n_points, "n_points")?) };
        *n_points = in_its_dimension!(cloud, cloud => cloud.len());
        Ok(())
    })
}

/// Copies the cloud to `points` [dim * n_points] and `normals` [dim * n_points], of length 1; either may be NULL.
///
/// `n_points` must be that of `ko_cloud_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_copy(
    cloud: *const ko_cloud,
    n_points: usize,
    points: *mut f64,
    normals: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a cloud.
        let ko_cloud(cloud) = unsafe { object(cloud, "cloud") }?;
        // SAFETY: the header asks for NULL or arrays of this length.
        in_its_dimension!(cloud, cloud => unsafe { copy(cloud, n_points, points, normals) })
    })
}

/// # Safety
/// `points` and `normals` are NULL or arrays of D times `n`, used by no one else.
unsafe fn copy<const D: usize>(cloud: &Cloud<D>, n: usize, points: *mut f64, normals: *mut f64) -> Result<()> {
    check_count("n_points", n, cloud.len())?;
    // SAFETY: the caller's promise.
    let (points, normals) =
        unsafe { (wanted(points.cast::<[f64; D]>(), n, "points")?, wanted(normals.cast::<[f64; D]>(), n, "normals")?) };
    if let Some(to) = points {
        to.copy_from_slice(cloud.points());
    }
    if let Some(to) = normals {
        to.copy_from_slice(cloud.normals());
    }
    Ok(())
}

/// Gives each point a weight, `weights` [n_points]: how much a fit trusts it, compared with the others. All count alike without.
///
/// A point of weight 0 takes no part in a fit, as if it were not there. `n_points` must be that of `ko_cloud_get_size`. The array is
/// copied.
/// Errors: KO_ERR_INVALID_ARGUMENT for a weight that is negative, not a number or above 1e100, naming the first, and where all are 0;
/// KO_ERR_OUT_OF_MEMORY. After an error the weights are as they were. No other thread may be using the cloud. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_set_weights(cloud: *mut ko_cloud, weights: *const f64, n_points: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a cloud that no one else uses.
        let ko_cloud(cloud) = unsafe { place(cloud, "cloud") }?;
        // SAFETY: the header asks for an array of this length.
        let weights = unsafe { array(weights, n_points, "weights") }?;
        in_its_dimension!(cloud, cloud => {
            cloud.check_weight_count(n_points)?;
            cloud.set_weights(copied(weights, "the weights")?)
        })
    })
}

/// Tells on which side of the cloud each of `points` [dim * n_points] lies, into `sides` [n_points]: 1 where the normals clearly point to,
/// -1 clearly behind them, between where an open shape has no clear side: around its rim and far from it.
///
/// 2 (W_s - W), with W the generalised winding number of the cloud (Barill et al. 2018), to about 0.1, and W_s its mean of both sides of
/// the surface nearby. Where it is small, so is the meaning of a field's sign.
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite; KO_ERR_OUT_OF_MEMORY. Threads: any number at once.
/// Cost: O(N log N) with about 500 bytes for each of the cloud's N points, and then some 10 microseconds a point: ask for many at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_sides(
    cloud: *const ko_cloud,
    points: *const f64,
    n_points: usize,
    sides: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a cloud.
        let ko_cloud(cloud) = unsafe { object(cloud, "cloud") }?;
        // SAFETY: the header asks for arrays of these lengths.
        let sides = unsafe { array_mut(sides, n_points, "sides") }?;
        in_its_dimension!(cloud, cloud => {
            // SAFETY: as above.
            let points = unsafe { array(points.cast(), n_points, "points") }?;
            if points.is_empty() {
                return Ok(());
            }
            cloud.sides()?.at(points, sides)
        })
    })
}

/// Copies where on its mesh each point was taken: index of the triangle, in the plane the segment, into
/// `triangles` [n_points], coordinates into `barycentric` [dim * n_points].
///
/// Either may be NULL. `n_points` must be that of `ko_cloud_get_size`. Errors: KO_ERR_INVALID_ARGUMENT, also for a cloud that was not
/// sampled from a mesh. Threads: any. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_copy_origins(
    cloud: *const ko_cloud,
    n_points: usize,
    triangles: *mut u32,
    barycentric: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a cloud.
        let ko_cloud(cloud) = unsafe { object(cloud, "cloud") }?;
        // SAFETY: the header asks for NULL or arrays of this length.
        in_its_dimension!(cloud, cloud => unsafe { copy_origins(cloud, n_points, triangles, barycentric) })
    })
}

/// # Safety
/// `facets` and `barycentric` are NULL or arrays of `n` and D times `n`, used by no one else.
unsafe fn copy_origins<const D: usize>(
    cloud: &Cloud<D>,
    n: usize,
    facets: *mut u32,
    barycentric: *mut f64,
) -> Result<()> {
    let Some(origins) = cloud.origins() else {
        let text = "the cloud was made from points; only one that was sampled from a mesh has origins";
        return Err(Error::InvalidArgument(text.into()));
    };
    check_count("n_points", n, cloud.len())?;
    // SAFETY: the caller's promise.
    let (facets, barycentric) =
        unsafe { (wanted(facets, n, "triangles")?, wanted(barycentric.cast::<[f64; D]>(), n, "barycentric")?) };
    if let Some(to) = facets {
        to.iter_mut().zip(origins).for_each(|(to, origin)| *to = origin.facet);
    }
    if let Some(to) = barycentric {
        to.iter_mut().zip(origins).for_each(|(to, origin)| *to = origin.barycentric);
    }
    Ok(())
}

/// Makes the cloud of the same places, triangles and barycentric coordinates, on `mesh`: the one that `cloud` was sampled from, with its
/// vertices moved.
///
/// Points and normals are made as `ko_mesh_sample` makes them; weights stay. On a mesh whose vertices did not move `*moved` is `cloud`. It is
/// the caller's to free. With `ko_field_refit` it makes the field follow a shape of parameters, with `ko_cloud_pull_back` derivatives by
/// them.
/// Errors: KO_ERR_INVALID_ARGUMENT for a cloud that was not sampled from a mesh, for a mesh of another dimension and for one that lacks a
/// triangle of the cloud's; KO_ERR_DEGENERATE for a triangle with a point that has lost its area; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost:
/// O(n_points + n_triangles).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_follow(
    cloud: *const ko_cloud,
    mesh: *const ko_mesh,
    moved: *mut *mut ko_cloud,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a cloud and a mesh.
            let (ko_cloud(cloud), ko_mesh(mesh)) = unsafe { (object(cloud, "cloud")?, object(mesh, "mesh")?) };
            Ok(ko_cloud(match (cloud, mesh) {
                (OfDimension::Plane(cloud), OfDimension::Plane(mesh)) => OfDimension::Plane(cloud.follow(mesh)?),
                (OfDimension::Space(cloud), OfDimension::Space(mesh)) => OfDimension::Space(cloud.follow(mesh)?),
                _ => return Err(differ(&[("the cloud", cloud.dim()), ("the mesh", mesh.dim())])),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(moved, "moved", make) }
    })
}

/// Takes derivatives of some J by the points and normals of `cloud`, `d_points` [dim * n_points] and `d_normals` [dim * n_points], those of
/// `ko_sensitivity_solve` say, back to derivatives by the vertices of `mesh`: `d_vertices` [dim * n_vertices].
///
/// The transpose of the derivative of `ko_cloud_follow`: of points as sums of corners with barycentric coordinates, of normals through the
/// corners' normals, the angles, in the plane the inverse lengths, that triangles weigh in these, and the triangles' own normals. Triangles,
/// barycentric coordinates and which edges are sharp are held. `cloud` is the one that was sampled from `mesh`, or that followed it. NULL
/// for `d_points` or `d_normals` stands for zeros. What `d_vertices` held before is lost; vertices without a triangle get 0.
/// Errors: KO_ERR_INVALID_ARGUMENT for a cloud that was not sampled from a mesh, a mesh of another dimension, one that lacks a triangle of
/// the cloud's, and for other counts than those of `ko_cloud_get_size` and `ko_mesh_get_size`; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost:
/// O(n_points + n_triangles); with `d_normals` some 300 bytes a triangle meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_cloud_pull_back(
    cloud: *const ko_cloud,
    mesh: *const ko_mesh,
    d_points: *const f64,
    d_normals: *const f64,
    n_points: usize,
    n_vertices: usize,
    d_vertices: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a cloud and a mesh.
        let (ko_cloud(cloud), ko_mesh(mesh)) = unsafe { (object(cloud, "cloud")?, object(mesh, "mesh")?) };
        let given = [d_points, d_normals];
        match (cloud, mesh) {
            // SAFETY: the header asks for arrays of these lengths.
            (OfDimension::Plane(cloud), OfDimension::Plane(mesh)) => unsafe {
                pull_back(cloud, mesh, given, [n_points, n_vertices], d_vertices)
            },
            // SAFETY: as above.
            (OfDimension::Space(cloud), OfDimension::Space(mesh)) => unsafe {
                pull_back(cloud, mesh, given, [n_points, n_vertices], d_vertices)
            },
            _ => Err(differ(&[("the cloud", cloud.dim()), ("the mesh", mesh.dim())])),
        }
    })
}

/// # Safety
/// The derivatives are NULL or arrays of D times `n_points`; `vertices` is NULL or an array of D times `n_vertices`, used by no one else.
unsafe fn pull_back<const D: usize>(
    cloud: &Cloud<D>,
    mesh: &Mesh<D>,
    given: [*const f64; 2],
    [n_points, n_vertices]: [usize; 2],
    vertices: *mut f64,
) -> Result<()> {
    check_count("n_points", n_points, cloud.len())?;
    check_count("n_vertices", n_vertices, mesh.vertices().len())?;
    // SAFETY: the caller's promise.
    let (points, normals, vertices) = unsafe {
        (
            array_or_none(given[0].cast(), n_points, "d_points")?,
            array_or_none(given[1].cast(), n_points, "d_normals")?,
            array_mut(vertices.cast(), n_vertices, "d_vertices")?,
        )
    };
    cloud.pull_back(mesh, points, normals, vertices)
}
