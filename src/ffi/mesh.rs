//! `ko_mesh`.

use super::cloud::ko_cloud;
use super::guard::{guard, guard_free};
use super::pointer::{array, array_mut, create, free, object, path, place, wanted};
use super::report::ko_mesh_report;
use crate::dimension::{OfDimension, in_its_dimension};
use crate::error::try_with_capacity;
use crate::geometry::Mesh;
use crate::{Error, Result};
use std::ffi::c_char;

/// A triangulated surface in space (dim 3), or polylines in the plane (dim 2). Freed by `ko_mesh_free`.
#[allow(non_camel_case_types)]
pub struct ko_mesh(pub(super) OfDimension<Mesh<2>, Mesh<3>>);

/// Reads a mesh from `path`: OBJ, STL (binary, ASCII), PLY (binary, ASCII) or OFF, each also compressed by gzip.
///
/// The format is told by the content where it has a mark, else by the name's ending. Polygons are cut into fans of triangles; the equal
/// vertices of an STL are merged. `path` is UTF-8 on Windows, bytes elsewhere. `*mesh` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or an empty path, KO_ERR_IO, KO_ERR_FORMAT with line or byte, KO_ERR_UNSUPPORTED for other
/// formats, KO_ERR_OUT_OF_MEMORY, also for more than 4 GiB after unpacking. Threads: any. Cost: one pass over the file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_read(path: *const c_char, mesh: *mut *mut ko_mesh) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a NUL-terminated path and a handle to write.
        unsafe { create(mesh, "mesh", || Ok(ko_mesh(OfDimension::Space(Mesh::read(self::path(path, "path")?)?)))) }
    })
}

/// Makes a mesh from `vertices` [3 * n_vertices] and `triangles` [3 * n_triangles], indices from 0, counter-clockwise seen from outside.
///
/// The arrays are copied. `*mesh` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for no triangle, a coordinate that is not finite, an index out of range; KO_ERR_OUT_OF_MEMORY.
/// Threads: any. Cost: O(n_vertices + n_triangles).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_from_triangles(
    vertices: *const f64,
    n_vertices: usize,
    triangles: *const u32,
    n_triangles: usize,
    mesh: *mut *mut ko_mesh,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for arrays of these lengths.
            let vertices = unsafe { array(vertices.cast::<[f64; 3]>(), n_vertices, "vertices") }?;
            // SAFETY: as above.
            let triangles = unsafe { array(triangles.cast::<[u32; 3]>(), n_triangles, "triangles") }?;
            let mesh = Mesh::new(copied(vertices, "the vertices")?, copied(triangles, "the triangles")?)?;
            Ok(ko_mesh(OfDimension::Space(mesh)))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(mesh, "mesh", make) }
    })
}

/// Frees a mesh. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_free(mesh: *mut ko_mesh) {
    // SAFETY: the header asks for NULL or a mesh that was not freed.
    guard_free(|| unsafe { free(mesh) });
}

/// Tells the dimension of the mesh: 3 for triangles in space, 2 for segments in the plane.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_get_dim(mesh: *const ko_mesh, dim: *mut u32) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh and a place to write.
        let (ko_mesh(mesh), dim) = unsafe { (object(mesh, "mesh")?, place(dim, "dim")?) };
        *dim = mesh.dim();
        Ok(())
    })
}

/// Tells how many vertices and triangles, in the plane segments, the mesh has. Either output may be NULL.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for no mesh. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_get_size(
    mesh: *const ko_mesh,
    n_vertices: *mut usize,
    n_triangles: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh.
        let ko_mesh(mesh) = unsafe { object(mesh, "mesh") }?;
        // SAFETY: the header asks for NULL or a place to write.
        if let Some(n) = unsafe { wanted(n_vertices, 1, "n_vertices") }? {
            n[0] = in_its_dimension!(mesh, mesh => mesh.vertices().len());
        }
        // SAFETY: as above.
        if let Some(n) = unsafe { wanted(n_triangles, 1, "n_triangles") }? {
            n[0] = in_its_dimension!(mesh, mesh => mesh.facets().len());
        }
        Ok(())
    })
}

/// Copies the mesh to `vertices` [dim * n_vertices] and `triangles` [dim * n_triangles], in the plane the segments; either may be NULL.
///
/// The counts must be those of `ko_mesh_get_size`. Errors: KO_ERR_INVALID_ARGUMENT, also for other counts. Threads: any. Cost: a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_copy(
    mesh: *const ko_mesh,
    n_vertices: usize,
    n_triangles: usize,
    vertices: *mut f64,
    triangles: *mut u32,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh.
        let ko_mesh(mesh) = unsafe { object(mesh, "mesh") }?;
        // SAFETY: the header asks for NULL or arrays of these lengths.
        in_its_dimension!(mesh, mesh => unsafe { copy(mesh, [n_vertices, n_triangles], vertices, triangles) })
    })
}

/// # Safety
/// `vertices` and `facets` are NULL or arrays of D times these counts, used by no one else.
unsafe fn copy<const D: usize>(
    mesh: &Mesh<D>,
    [n_vertices, n_facets]: [usize; 2],
    vertices: *mut f64,
    facets: *mut u32,
) -> Result<()> {
    check_count("n_vertices", n_vertices, mesh.vertices().len())?;
    check_count("n_triangles", n_facets, mesh.facets().len())?;
    // SAFETY: the caller's promise.
    if let Some(to) = unsafe { wanted(vertices.cast::<[f64; D]>(), n_vertices, "vertices") }? {
        to.copy_from_slice(mesh.vertices());
    }
    // SAFETY: as above.
    if let Some(to) = unsafe { wanted(facets.cast::<[u32; D]>(), n_facets, "triangles") }? {
        to.copy_from_slice(mesh.facets());
    }
    Ok(())
}

/// Fills `report` with what can be said of the mesh: closed, oriented, manifold, components, flaws, extents. See `ko_mesh_report`.
///
/// `struct_size` is sizeof *report. Errors: KO_ERR_INVALID_ARGUMENT, KO_ERR_OUT_OF_MEMORY. Threads: any.
/// Cost: O(n_triangles log n_triangles), with some 100 bytes a triangle taken meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_get_report(
    mesh: *const ko_mesh,
    struct_size: usize,
    report: *mut ko_mesh_report,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh.
        let ko_mesh(mesh) = unsafe { object(mesh, "mesh") }?;
        match mesh {
            OfDimension::Plane(_) => Err(Error::Unsupported("reports are of meshes in space so far".into())),
            // SAFETY: the header asks for a struct of this size.
            OfDimension::Space(mesh) => unsafe { ko_mesh_report::write(report, struct_size, &mesh.report()?) },
        }
    })
}

/// Turns every triangle, in the plane every segment, over, so that an inside-out solid becomes a solid.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL. No other thread may be using the mesh. Cost: O(n_triangles).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_flip(mesh: *mut ko_mesh) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh that no one else uses.
        let ko_mesh(mesh) = unsafe { place(mesh, "mesh") }?;
        in_its_dimension!(mesh, mesh => mesh.flip());
        Ok(())
    })
}

/// Samples `n_points` points of the surface with normals, spread evenly by area (blue noise: Yuksel 2015), into a cloud.
///
/// Normals are smooth across edges of less than 40 degrees and sharp across others. The cloud remembers triangle and barycentric
/// coordinates of each point: `ko_cloud_copy_origins`. The same mesh, count and seed give the same bits. `*cloud` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for no points or more than 2^30 - 1, KO_ERR_DEGENERATE for a mesh without area, KO_ERR_OUT_OF_MEMORY.
/// Threads: any. Cost: O(n_points log n_points + n_triangles).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_sample(
    mesh: *const ko_mesh,
    n_points: usize,
    seed: u64,
    cloud: *mut *mut ko_cloud,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a mesh.
            let ko_mesh(mesh) = unsafe { object(mesh, "mesh") }?;
            Ok(ko_cloud(match mesh {
                OfDimension::Plane(_) => {
                    return Err(Error::Unsupported("only meshes in space are sampled so far".into()));
                }
                OfDimension::Space(mesh) => OfDimension::Space(mesh.sample(n_points, seed)?),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(cloud, "cloud", make) }
    })
}

/// Exact signed distances of `points` [dim * n_points] to the mesh, into `distances` [n_points]: positive outside, in the mesh's unit.
///
/// The side is that of the generalised winding number (Jacobson et al. 2013), inside from 1/2 on, so that open meshes have sides too.
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite; KO_ERR_OUT_OF_MEMORY for the tree.
/// Threads: any number at once. Cost: O(log n_triangles) a point; the first call on a mesh builds its tree, O(n_triangles log n_triangles).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_signed_distance(
    mesh: *const ko_mesh,
    points: *const f64,
    n_points: usize,
    distances: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh.
        let ko_mesh(mesh) = unsafe { object(mesh, "mesh") }?;
        // SAFETY: the header asks for arrays of these lengths.
        let distances = unsafe { array_mut(distances, n_points, "distances") }?;
        in_its_dimension!(mesh, mesh => {
            // SAFETY: as above.
            let points = unsafe { array(points.cast(), n_points, "points") }?;
            mesh.distance_tree()?.signed_distances(points, distances)
        })
    })
}

/// A copy of an array that may be too large for memory.
pub(super) fn copied<T: Copy>(from: &[T], what: &str) -> Result<Vec<T>> {
    let mut to = try_with_capacity(from.len(), what)?;
    to.extend_from_slice(from);
    Ok(to)
}

/// Refuses a length that is not the object's.
pub(super) fn check_count(name: &str, given: usize, right: usize) -> Result<()> {
    if given == right {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!("{name} is {given}; the object has {right}")))
}
