//! Meshes of parts: what a set of cells, or densities, bound.

use super::cells::read_set;
use super::guard::guard;
use super::mesh::ko_mesh;
use super::part::ko_part;
use super::pointer::{array, create, object};
use super::progress::{ko_progress, listener};
use crate::cogen::{BoundaryOptions, Within, mesh_of_cells, mesh_of_densities};
use crate::dimension::OfDimension;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ffi::c_void;

/// The mesh lies in the cells: meshes of parts that do not collide do not.
pub const KO_WITHIN_CELLS: i32 = 0;
/// About as much of the mesh lies outside of the cells as inside, which keeps their volume: meshes of parts that do not collide may.
pub const KO_WITHIN_ANYWHERE: i32 = 1;

/// Makes the mesh that bounds `cells` [n_cells], a set of the part's cells, in the part's frame: closed, in the plane curves with the cells on
/// their left, in space triangles whose normals point outwards.
///
/// `within` is a KO_WITHIN_ constant. Each vertex is moved `rounds` times, 20 do; with 0 the mesh is the cells' faces. It lies within a cell of
/// these, and is moved into a part by a quarter of its thickness there at most. Every edge has two triangles, every vertex one fan of them; where
/// cells touch by an edge or a corner the mesh may touch itself. It is not proven that moved triangles do not pass through each other. `*mesh` is
/// the caller's to free; a field is fitted to what `ko_mesh_sample` draws from it. `progress` is told of progress with `progress_data`, or NULL.
/// Errors: KO_ERR_INVALID_ARGUMENT for another number of cells, an entry that is not 0 or 1, another `within`; KO_ERR_DEGENERATE for no cells;
/// KO_ERR_OUT_OF_MEMORY, KO_ERR_CANCELLED. Threads: any number at once; `progress` is called on the caller's. Cost: some microseconds a face of a
/// cell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_mesh_of_cells(
    part: *const ko_part,
    cells: *const u8,
    n_cells: usize,
    within: i32,
    rounds: u32,
    progress: ko_progress,
    progress_data: *mut c_void,
    mesh: *mut *mut ko_mesh,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a part and a set of this length.
            let (ko_part(part), cells) = unsafe { (object(part, "part")?, read_set(cells, n_cells, "cells")?) };
            let options = boundary(within, rounds)?;
            // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
            let mut told = unsafe { listener(progress, progress_data) };
            let mut progress = Progress::new(&mut told);
            Ok(ko_mesh(match part {
                OfDimension::Plane(part) => {
                    OfDimension::Plane(mesh_of_cells(part.grid(), &cells, &options, &mut progress)?)
                }
                OfDimension::Space(part) => {
                    OfDimension::Space(mesh_of_cells(part.grid(), &cells, &options, &mut progress)?)
                }
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(mesh, "mesh", make) }
    })
}

/// The same of the cells whose density is above `level`, with `densities` [n_cells] in [0, 1]; the mesh is drawn to where the density passes it.
///
/// `level` is in [0, 1), mostly 1/2. With KO_WITHIN_CELLS the mesh lies in those cells. Errors, threads, cost: those of `ko_part_mesh_of_cells`;
/// KO_ERR_INVALID_ARGUMENT for a density outside [0, 1], naming the first, and another level.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_mesh_of_densities(
    part: *const ko_part,
    densities: *const f64,
    n_cells: usize,
    level: f64,
    within: i32,
    rounds: u32,
    progress: ko_progress,
    progress_data: *mut c_void,
    mesh: *mut *mut ko_mesh,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for a part and an array of this length.
            let (ko_part(part), rho) = unsafe { (object(part, "part")?, array(densities, n_cells, "densities")?) };
            let options = boundary(within, rounds)?;
            // SAFETY: the header asks for a function of this type that may be called with `progress_data`.
            let mut told = unsafe { listener(progress, progress_data) };
            let mut progress = Progress::new(&mut told);
            Ok(ko_mesh(match part {
                OfDimension::Plane(part) => {
                    OfDimension::Plane(mesh_of_densities(part.grid(), rho, level, &options, &mut progress)?)
                }
                OfDimension::Space(part) => {
                    OfDimension::Space(mesh_of_densities(part.grid(), rho, level, &options, &mut progress)?)
                }
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(mesh, "mesh", make) }
    })
}

fn boundary(within: i32, rounds: u32) -> Result<BoundaryOptions> {
    let within = match within {
        KO_WITHIN_CELLS => Within::Cells,
        KO_WITHIN_ANYWHERE => Within::Anywhere,
        _ => {
            return Err(Error::InvalidArgument(format!(
                "within is {within}; it must be KO_WITHIN_CELLS (0) or KO_WITHIN_ANYWHERE (1)"
            )));
        }
    };
    Ok(BoundaryOptions { within, rounds: rounds as usize })
}
