//! Level sets of `ko_field`, and their options.

use super::field::ko_field;
use super::guard::{guard, guard_with_remark};
use super::mesh::ko_mesh;
use super::pointer::{Sized_, create, object, read_sized_or, write_sized};
use super::progress::{ko_progress, listener};
use super::status::{KO_OK, KO_OPEN_AT_BOX};
use crate::dimension::OfDimension;
use crate::field::{LevelSet, LevelSetOptions};
use crate::geometry::Mesh;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_void;

/// Options of `ko_field_level_set`. Initialise by `ko_level_set_options_init`, then set what shall differ.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_level_set_options {
    /// sizeof(ko_level_set_options), set by ko_level_set_options_init.
    pub struct_size: usize,
    /// Lattice edges per cell of the field, along each axis, in [1, 1024]. What is thinner than a lattice edge may be missed, or joined:
    /// this decides the topology, and most of the cost. Default 4.
    pub subdivisions: u32,
    /// Threads, at most 1024: 0 (default) for all cores, 1 for none but the caller's. The result does not depend on it.
    pub n_threads: u32,
    /// Edges of the result shorter than this fraction of the field's shortest cell edge are collapsed, where that changes neither topology
    /// nor side and bends nothing far from the level set; in [0, 1], 0 keeps them all. It decides the size of the result. Default 0.3.
    pub shortest_edge: f64,
    /// Rounds in which vertices move along the level set towards the middle of their neighbours; at most 1000. Default 6.
    pub relaxations: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Bytes that the call may take; more is refused before it is taken. Default 8 GiB.
    pub memory_limit: u64,
    /// Told of progress, or NULL (default).
    pub progress: ko_progress,
    /// Handed to `progress`.
    pub progress_data: *mut c_void,
}

// SAFETY: repr(C), starts with a usize, and no padding, by the order of its fields (checked below). Every pattern of bits is a value:
// `progress` may be any address, as in C, and is only ever called as the caller promised.
unsafe impl Sized_ for ko_level_set_options {
    const FIRST_SIZE: usize = 2 * size_of::<usize>() + 32 + size_of::<ko_progress>();
}

const _: () = assert!(size_of::<ko_level_set_options>() == <ko_level_set_options as Sized_>::FIRST_SIZE);

/// Fills `options` with the defaults. `struct_size` is sizeof *options.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for NULL or a size that is none. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_level_set_options_init(options: *mut ko_level_set_options, struct_size: usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a struct of this size.
        unsafe { write_sized(options, struct_size, ko_level_set_options::defaults(), "options") }
    })
}

impl ko_level_set_options {
    fn defaults() -> Self {
        let d = LevelSetOptions::default();
        ko_level_set_options {
            struct_size: size_of::<ko_level_set_options>(),
            subdivisions: d.subdivisions,
            n_threads: d.n_threads,
            shortest_edge: d.shortest_edge,
            relaxations: d.relaxations,
            reserved: 0,
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

    /// The same for the level set.
    fn to_level_set_options(self) -> Result<LevelSetOptions> {
        if self.reserved != 0 {
            return Err(Error::InvalidArgument(format!("reserved is {}; it must be 0", self.reserved)));
        }
        Ok(LevelSetOptions {
            subdivisions: self.subdivisions,
            shortest_edge: self.shortest_edge,
            relaxations: self.relaxations,
            n_threads: self.n_threads,
            memory_limit: self.memory_limit,
        })
    }
}

/// Makes a mesh of the level set phi = `level` within the field's box: triangles in space, curves in the plane.
///
/// `level` is in the cloud's unit of length: 0 gives the fitted shape, others a shape about that far from it, on the feasible side where
/// they are above 0. `options` NULL: the defaults.
/// Normals point out of the solid, and a solid lies on the left of curves, wherever the feasible side is. Vertices lie on the level set
/// but for rounding; between them it is missed by about an eighth of the square of an edge times its curvature, and what is smaller than an
/// edge may be missed or joined. The mesh is watertight wherever the level set stays within the box: marching simplices (Allgower and
/// Gnutzmann 1987) on the cells cut into `subdivisions`, vertices by Newton's method, then short edges collapsed (Dey et al. 1999).
/// Of a refined field these are the cells of the deepest level with which the lattice has no more than 2^26 vertices.
/// `*mesh` is the caller's to free. The same field and options give the same bits.
/// Returns KO_OPEN_AT_BOX, a success, where the level set meets the box and the mesh is open there: a larger `margin` of the fit may
/// close it. Errors: KO_ERR_INVALID_ARGUMENT for a level that is not finite and for an option out of its range; KO_ERR_DEGENERATE for a
/// level that phi does not take, with the range that it takes at the corners of cells; KO_ERR_UNSUPPORTED for an option that this library
/// does not know; KO_ERR_OUT_OF_MEMORY with the bytes that it would take; KO_ERR_CANCELLED.
/// Threads: any number at once; `progress` is called on the caller's. Cost: an evaluation a lattice vertex, about 5 with gradient a vertex
/// of the surface before the collapse, and the collapse. Memory: 13 bytes a lattice vertex and 320 a vertex of that surface. Of the lattice
/// only vertices near the level set count: blocks of it that the field's control points keep from the level are left out.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_field_level_set(
    field: *const ko_field,
    level: f64,
    options: *const ko_level_set_options,
    mesh: *mut *mut ko_mesh,
) -> i32 {
    guard_with_remark(|| {
        let mut remark = KO_OK;
        let make = || {
            // SAFETY: the header asks for a field.
            let ko_field(field) = unsafe { object(field, "field") }?;
            // SAFETY: the header asks for NULL or initialised options.
            let options = unsafe { ko_level_set_options::read(options) }?;
            // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
            let mut tell = unsafe { listener(options.progress, options.progress_data) };
            let (options, mut progress) = (options.to_level_set_options()?, Progress::new(&mut tell));
            let (mesh, end) = match field {
                OfDimension::Plane(field) => {
                    let (mesh, end) = finished(field.level_set(level, &options, &mut progress)?)?;
                    (OfDimension::Plane(mesh), end)
                }
                OfDimension::Space(field) => {
                    let (mesh, end) = finished(field.level_set(level, &options, &mut progress)?)?;
                    (OfDimension::Space(mesh), end)
                }
            };
            remark = end;
            Ok(ko_mesh(mesh))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(mesh, "mesh", make) }?;
        Ok(remark)
    })
}

/// The level set as a mesh, and whether the box cut it open.
fn finished<const D: usize>(set: LevelSet<D>) -> Result<(Mesh<D>, i32)> {
    let remark = if set.boundary() > 0 { KO_OPEN_AT_BOX } else { KO_OK };
    Ok((set.into_mesh()?, remark))
}
