//! `ko_mesh`.

use super::cloud::ko_cloud;
use super::guard::{guard, guard_free};
use super::pointer::{array, array_mut, create, free, object, path, place, wanted};
use super::report::ko_mesh_report;
use crate::dimension::{OfDimension, in_its_dimension};
use crate::error::try_with_capacity;
use crate::geometry::{Ends, Mesh, Polylines};
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

/// Writes the mesh to the file `path`, in the format that its ending names: .obj, .off, .ply or .stl, in small letters or capitals.
///
/// OBJ, OFF and PLY (binary) hold every bit of the coordinates; STL (binary) rounds them to `float`, and vertices that become one are one
/// when it is read. A mesh of the plane is written as OBJ: lines, z = 0. A file that stood there is replaced whole or, after an error, left
/// as it was. `path` is UTF-8 on Windows, bytes elsewhere.
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL, an empty path, or a coordinate that an STL cannot hold; KO_ERR_UNSUPPORTED for other endings;
/// KO_ERR_IO. Threads: any. Cost: one pass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_write(mesh: *const ko_mesh, path: *const c_char) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh and a NUL-terminated path.
        let (ko_mesh(mesh), path) = unsafe { (object(mesh, "mesh")?, self::path(path, "path")?) };
        in_its_dimension!(mesh, mesh => mesh.write(path))
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
            Mesh::<3>::check_count(n_triangles)?;
            let mesh = Mesh::new(copied(vertices, "the vertices")?, copied(triangles, "the triangles")?)?;
            Ok(ko_mesh(OfDimension::Space(mesh)))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(mesh, "mesh", make) }
    })
}

/// Makes a mesh of the plane from polylines: `points` [2 * n_points], of which polyline i begins at `loop_starts`[i] [n_loops].
///
/// `loop_starts` begins with 0 and ascends. `closed` 1: each polyline goes back to its first point, which may be given again as its last;
/// 0: none does. A solid lies on the left of closed polylines: counter-clockwise around it, clockwise around a hole in it. A point that
/// repeats the one before it is dropped. The arrays are copied. `*mesh` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for a point that is not finite, starts that do not ascend, fewer than 2 points, closed 3; for polylines
/// that cross, touch or overlap themselves or each other, with the segments and the place; for loops right inside one another that run the
/// same way, naming the one to turn around; KO_ERR_OUT_OF_MEMORY. Threads: any.
/// Cost: O(n_points log n_points) where segments are short.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_from_polylines(
    points: *const f64,
    n_points: usize,
    loop_starts: *const usize,
    n_loops: usize,
    closed: i32,
    mesh: *mut *mut ko_mesh,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for arrays of these lengths.
            let points = unsafe { array(points.cast::<[f64; 2]>(), n_points, "points") }?;
            // SAFETY: as above.
            let loop_starts = unsafe { array(loop_starts, n_loops, "loop_starts") }?;
            let ends = match closed {
                0 => Ends::Open,
                1 => Ends::Closed,
                _ => return Err(Error::InvalidArgument(format!("closed is {closed}; it must be 0 or 1"))),
            };
            Ok(ko_mesh(OfDimension::Plane(Mesh::from_polylines(copied(points, "the points")?, loop_starts, ends)?)))
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
        // SAFETY: the header asks for NULL or places to write.
        let (n_vertices, n_triangles) =
            unsafe { (wanted(n_vertices, 1, "n_vertices")?, wanted(n_triangles, 1, "n_triangles")?) };
        if let Some(n) = n_vertices {
            n[0] = in_its_dimension!(mesh, mesh => mesh.vertices().len());
        }
        if let Some(n) = n_triangles {
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
    let (vertices, facets) = unsafe {
        let vertices = wanted(vertices.cast::<[f64; D]>(), n_vertices, "vertices")?;
        (vertices, wanted(facets.cast::<[u32; D]>(), n_facets, "triangles")?)
    };
    if let Some(to) = vertices {
        to.copy_from_slice(mesh.vertices());
    }
    if let Some(to) = facets {
        to.copy_from_slice(mesh.facets());
    }
    Ok(())
}

/// Tells how many points and polylines `ko_mesh_copy_polylines` gives of a mesh of the plane. Either output may be NULL.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for no mesh and for one of space; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: O(n_vertices), with some 30
/// bytes a vertex taken meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_get_polylines_size(
    mesh: *const ko_mesh,
    n_points: *mut usize,
    n_loops: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh.
        let lines = polylines(unsafe { object(mesh, "mesh") }?)?;
        // SAFETY: the header asks for NULL or places to write.
        let (n_points, n_loops) = unsafe { (wanted(n_points, 1, "n_points")?, wanted(n_loops, 1, "n_loops")?) };
        if let Some(n) = n_points {
            n[0] = lines.points.len();
        }
        if let Some(n) = n_loops {
            n[0] = lines.starts.len();
        }
        Ok(())
    })
}

/// Copies the curves that the segments of a mesh of the plane make, as `ko_mesh_from_polylines` takes them: `points` [2 * n_points], of
/// which polyline i begins at `loop_starts`[i] [n_loops] and is closed where `closed`[i] [n_loops] is 1, else 0. Each may be NULL.
///
/// Open polylines come first, then closed ones, which do not repeat their first point; each kind in the order of the mesh's vertices. A
/// solid lies on the left. The counts must be those of `ko_mesh_get_polylines_size`.
/// Errors: KO_ERR_INVALID_ARGUMENT, also for a mesh of space and for other counts; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: that of
/// `ko_mesh_get_polylines_size`, and a copy.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_copy_polylines(
    mesh: *const ko_mesh,
    n_points: usize,
    n_loops: usize,
    points: *mut f64,
    loop_starts: *mut usize,
    closed: *mut u8,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh.
        let lines = polylines(unsafe { object(mesh, "mesh") }?)?;
        check_count("n_points", n_points, lines.points.len())?;
        check_count("n_loops", n_loops, lines.starts.len())?;
        // SAFETY: the header asks for NULL or arrays of these lengths.
        let (points, starts, closed) = unsafe {
            let points = wanted(points.cast::<[f64; 2]>(), n_points, "points")?;
            (points, wanted(loop_starts, n_loops, "loop_starts")?, wanted(closed, n_loops, "closed")?)
        };
        if let Some(to) = points {
            to.copy_from_slice(&lines.points);
        }
        if let Some(to) = starts {
            to.copy_from_slice(&lines.starts);
        }
        if let Some(to) = closed {
            to.iter_mut().zip(&lines.closed).for_each(|(to, closed)| *to = u8::from(*closed));
        }
        Ok(())
    })
}

fn polylines(ko_mesh(mesh): &ko_mesh) -> Result<Polylines> {
    match mesh {
        OfDimension::Plane(mesh) => mesh.polylines(),
        OfDimension::Space(_) => Err(Error::InvalidArgument(
            "the mesh is of space, dim 3; only one of the plane is made of polylines".into(),
        )),
    }
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
        // SAFETY: the header asks for a struct of this size.
        in_its_dimension!(mesh, mesh => unsafe { ko_mesh_report::write(report, struct_size, &mesh.report()?) })
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

/// Samples `n_points` points of the surface with normals, spread evenly by area (blue noise: Yuksel 2015), into a cloud; of curves in the
/// plane evenly by length.
///
/// Normals are smooth across edges, in the plane corners, of less than 40 degrees and sharp across others. The cloud remembers triangle and
/// barycentric coordinates of each point: `ko_cloud_copy_origins`. The same mesh, count and seed give the same bits. `*cloud` is the
/// caller's to free.
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
                OfDimension::Plane(mesh) => OfDimension::Plane(mesh.sample(n_points, seed)?),
                OfDimension::Space(mesh) => OfDimension::Space(mesh.sample(n_points, seed)?),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(cloud, "cloud", make) }
    })
}

/// Exact signed distances of `points` [dim * n_points] to the mesh, into `distances` [n_points]: positive outside, in the mesh's unit.
///
/// The side is that of the generalised winding number W (Jacobson et al. 2013), inside from 1/2 on. By this rule an open mesh has an inside
/// only where it takes up half of what is seen from there: a bowl has one, a flat sheet has none, and its distances are positive behind it
/// too. The two sides of a sheet are told by `ko_cloud_sides`, of a sample of the mesh, and by the sign of a field fitted to one.
/// Errors: KO_ERR_INVALID_ARGUMENT, naming the first point that is not finite; KO_ERR_OUT_OF_MEMORY for the tree.
/// Threads: any number at once. Cost: O(log n_triangles) a point, and where W is so near to 1/2 that sums over far triangles do not tell the
/// side, as close behind a flat sheet, some tens of nanoseconds more for each edge of the mesh's rim, or for each triangle among hundreds of
/// nested shells; the first call on a mesh builds its tree, O(n_triangles log n_triangles).
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

/// Tells how many components the mesh has: parts that hang together by vertices that triangles share, in the plane segments.
///
/// There may be fewer than `n_components` of `ko_mesh_get_report`, which a vertex alone does not connect. Errors: KO_ERR_INVALID_ARGUMENT
/// for NULL, KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a pass over the triangles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_get_component_count(mesh: *const ko_mesh, n_components: *mut usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh and a place to write.
        let (ko_mesh(mesh), n) = unsafe { (object(mesh, "mesh")?, place(n_components, "n_components")?) };
        *n = in_its_dimension!(mesh, mesh => mesh.component_points()?.len());
        Ok(())
    })
}

/// Copies a vertex of each component of the mesh to `points` [dim * n_components]: what a body that swallows the component holds.
///
/// `n_components` must be that of `ko_mesh_get_component_count`, or of a certificate. Errors: KO_ERR_INVALID_ARGUMENT, also for another
/// count; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a pass over the triangles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_mesh_copy_component_points(
    mesh: *const ko_mesh,
    n_components: usize,
    points: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a mesh.
        let ko_mesh(mesh) = unsafe { object(mesh, "mesh") }?;
        let found = in_its_dimension!(mesh, mesh => copied(mesh.component_points()?.as_flattened(), "the points")?);
        check_count("n_components", n_components, found.len() / mesh.dim() as usize)?;
        // SAFETY: the header asks for an array of this length.
        unsafe { array_mut(points, found.len(), "points") }?.copy_from_slice(&found);
        Ok(())
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
