//! `ko_part`, and what part of its cells solids fill.

use super::cells::put;
use super::field::ko_field;
use super::guard::{guard, guard_free};
use super::mesh::{check_count, ko_mesh};
use super::pointer::{array, array_mut, check_wanted_place, create, free, object, tell, wanted};
use crate::cogen::fraction::{FractionOptions, Solid, fractions as fill, fractions_of_mesh, fractions_of_solid};
use crate::cogen::{Cell, Grid, Part};
use crate::dimension::{OfDimension, differ, in_its_dimension, no_dim};
use crate::error::try_with_capacity;
use crate::field::{Feasible, Field, Outputs};
use crate::geometry::Bounds;
use crate::par::Workers;
use crate::{Error, Result};
use std::sync::Arc;

/// The part never has the cell.
pub const KO_CELL_FORBIDDEN: u8 = 0;
/// The part may have the cell: of its initial design, say.
pub const KO_CELL_FREE: u8 = 1;
/// The part keeps the cell whatever happens.
pub const KO_CELL_FROZEN: u8 = 2;

/// A grid of square or cubic cells in a part's own frame, (A.2) of Morris and Behandish 2022, and what the part may do with each. Freed by
/// `ko_part_free`; what was made of it goes on.
///
/// Cells are numbered row-major: the last axis runs fastest. Sets of a part's cells are arrays of a byte a cell, 1 where it is in the set, 0
/// where not; densities are arrays of a number in [0, 1] a cell.
#[allow(non_camel_case_types)]
pub struct ko_part(pub(super) OfDimension<Arc<Part<2>>, Arc<Part<3>>>);

/// Makes a part of `counts` [dim] cells of edge `cell_edge` along each axis, from `corner` [dim] on, its smallest coordinates.
///
/// `dim` is 2 or 3. `cells` [n_cells], as many as the product of the counts, are KO_CELL_ constants; NULL with n_cells 0: all are free. The arrays
/// are copied. `*part` is the caller's to free.
/// Errors: KO_ERR_INVALID_ARGUMENT for a count of 0, more than 2^32 - 2 cells, an edge that is not above 0, a number that is not finite, another
/// number of cells, or what is no KO_CELL_ constant, naming the first; KO_ERR_OUT_OF_MEMORY. Threads: any. Cost: a pass; two bits a cell.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_create(
    dim: u32,
    corner: *const f64,
    cell_edge: f64,
    counts: *const usize,
    cells: *const u8,
    n_cells: usize,
    part: *mut *mut ko_part,
) -> i32 {
    guard(|| {
        let make = || {
            // SAFETY: the header asks for an array of this length.
            let cells = unsafe { array(cells, n_cells, "cells") }?;
            Ok(ko_part(match dim {
                // SAFETY: the header asks for arrays of these lengths.
                2 => OfDimension::Plane(unsafe { part_of(corner, cell_edge, counts, cells) }?),
                // SAFETY: as above.
                3 => OfDimension::Space(unsafe { part_of(corner, cell_edge, counts, cells) }?),
                _ => return Err(no_dim(dim)),
            }))
        };
        // SAFETY: the header asks for a handle to write.
        unsafe { create(part, "part", make) }
    })
}

/// # Safety
/// `corner` and `counts` are NULL or arrays of D.
unsafe fn part_of<const D: usize>(
    corner: *const f64,
    edge: f64,
    counts: *const usize,
    cells: &[u8],
) -> Result<Arc<Part<D>>> {
    // SAFETY: the caller's promise.
    let (corner, counts) = unsafe { (object(corner.cast(), "corner")?, object(counts.cast(), "counts")?) };
    let grid = Grid::new(*corner, edge, *counts)?;
    if cells.is_empty() {
        return Ok(Arc::new(Part::whole(grid)?));
    }
    let mut own = try_with_capacity(cells.len(), "the part's cells")?;
    for (i, &cell) in cells.iter().enumerate() {
        own.push(match cell {
            KO_CELL_FORBIDDEN => Cell::Forbidden,
            KO_CELL_FREE => Cell::Free,
            KO_CELL_FROZEN => Cell::Frozen,
            _ => {
                return Err(Error::InvalidArgument(format!(
                    "cell {i} is {cell}; it must be a KO_CELL_ constant, 0 to 2"
                )));
            }
        });
    }
    Ok(Arc::new(Part::of_cells(grid, &own)?))
}

/// Frees a part. NULL is taken. No other thread may be using it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_free(part: *mut ko_part) {
    // SAFETY: the header asks for NULL or a part that was not freed.
    guard_free(|| unsafe { free(part) });
}

/// Tells the dimension of a part, 2 or 3, and the number of its cells. Either output may be NULL.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for no part. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_get_size(part: *const ko_part, dim: *mut u32, n_cells: *mut usize) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part.
        let ko_part(part) = unsafe { object(part, "part") }?;
        check_wanted_place(dim, "dim")?;
        check_wanted_place(n_cells, "n_cells")?;
        // SAFETY: the header asks for NULL or places to write.
        unsafe {
            tell(dim, part.dim())?;
            tell(n_cells, in_its_dimension!(part, part => part.grid().n_cells()))
        }
    })
}

/// Tells the grid of a part as it was given: `corner` [dim], `*cell_edge`, `counts` [dim]. Each output may be NULL.
///
/// Errors: KO_ERR_INVALID_ARGUMENT for no part. Threads: any. Cost: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_get_grid(
    part: *const ko_part,
    corner: *mut f64,
    cell_edge: *mut f64,
    counts: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part.
        let ko_part(part) = unsafe { object(part, "part") }?;
        check_wanted_place(cell_edge, "cell_edge")?;
        in_its_dimension!(part, part => {
            let grid = part.grid();
            // SAFETY: the header asks for NULL or arrays of these lengths.
            let (corners, sizes) = unsafe { (wanted(corner.cast(), 1, "corner")?, wanted(counts.cast(), 1, "counts")?) };
            if let Some(to) = corners {
                to[0] = grid.corner();
            }
            if let Some(to) = sizes {
                to[0] = grid.counts();
            }
            // SAFETY: the header asks for NULL or a place to write.
            unsafe { tell(cell_edge, grid.cell()) }
        })
    })
}

/// Copies what the part may do with its cells to `cells` [n_cells], KO_CELL_ constants.
///
/// `n_cells` must be that of `ko_part_get_size`. Errors: KO_ERR_INVALID_ARGUMENT. Threads: any. Cost: a pass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_copy_cells(part: *const ko_part, n_cells: usize, cells: *mut u8) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part and an array of this length.
        let (ko_part(part), cells) = unsafe { (object(part, "part")?, array_mut(cells, n_cells, "cells")?) };
        in_its_dimension!(part, part => {
            check_count("n_cells", n_cells, part.grid().n_cells())?;
            put(part.allowed(), cells);
            part.frozen().iter().for_each(|i| cells[i] = KO_CELL_FROZEN);
            Ok(())
        })
    })
}

/// Tells which part of each cell a solid fills, `fractions` [n_cells] in [0, 1]: densities, (A.3) of Morris and Behandish 2022. Here the solid is
/// what `mesh` bounds, in the part's frame.
///
/// A cell that the surface may pass through is sampled at `samples` points along each of its edges, 1 to 64: fractions are off by about
/// 1 / samples^dim to 1 / samples. What is inside is told by the generalised winding number, for open meshes too, roughly there.
/// `n_cells` must be that of `ko_part_get_size`; whether the part may have a cell does not count. `n_threads` is as elsewhere, and the bits do not
/// depend on it.
/// Errors: KO_ERR_INVALID_ARGUMENT for a mesh of another dimension, samples out of their range, another n_cells; KO_ERR_OUT_OF_MEMORY. Threads: any
/// number at once. Cost: a distance a cell, and samples^dim of them for each that the surface may pass through; the mesh keeps the tree of its
/// distances, about 200 bytes a triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_fractions_of_mesh(
    part: *const ko_part,
    mesh: *const ko_mesh,
    samples: u32,
    n_threads: u32,
    n_cells: usize,
    fractions: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part, a mesh and an array of this length.
        let (ko_part(part), ko_mesh(mesh), out) =
            unsafe { (object(part, "part")?, object(mesh, "mesh")?, array_mut(fractions, n_cells, "fractions")?) };
        let workers = Workers::new(n_threads)?;
        match (part, mesh) {
            (OfDimension::Plane(part), OfDimension::Plane(mesh)) => {
                fractions_of_mesh(part.grid(), mesh.distance_tree()?, samples as usize, out, &workers)
            }
            (OfDimension::Space(part), OfDimension::Space(mesh)) => {
                fractions_of_mesh(part.grid(), mesh.distance_tree()?, samples as usize, out, &workers)
            }
            _ => Err(differ(&[("the part", part.dim()), ("the mesh", mesh.dim())])),
        }
    })
}

/// The same of the solid that `field` was fitted to: where phi < 0, or phi > 0 with KO_FEASIBLE_INSIDE.
///
/// `steepness` is at least the length of grad phi on the grid, such as `steepest` and `steepest_beyond` of `ko_field_certify`; of most fields 2 is
/// more than that near the shape. Where it is less, cells that the surface passes through may be taken for full or empty. Errors: those of
/// `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a steepness that is not above 0. Threads: any number at once. Cost: a value a cell and a
/// sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_fractions_of_field(
    part: *const ko_part,
    field: *const ko_field,
    steepness: f64,
    samples: u32,
    n_threads: u32,
    n_cells: usize,
    fractions: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part, a field and an array of this length.
        let (ko_part(part), ko_field(field), out) =
            unsafe { (object(part, "part")?, object(field, "field")?, array_mut(fractions, n_cells, "fractions")?) };
        let workers = Workers::new(n_threads)?;
        let options = FractionOptions { samples: samples as usize, steepness };
        match (part, field) {
            (OfDimension::Plane(part), OfDimension::Plane(field)) => {
                of_field(part.grid(), field, &options, out, &workers)
            }
            (OfDimension::Space(part), OfDimension::Space(field)) => {
                of_field(part.grid(), field, &options, out, &workers)
            }
            _ => Err(differ(&[("the part", part.dim()), ("the field", field.dim())])),
        }
    })
}

fn of_field<const D: usize>(
    grid: &Grid<D>,
    field: &Field<D>,
    options: &FractionOptions,
    out: &mut [f64],
    workers: &Workers,
) -> Result<()> {
    let sign = if field.feasible() == Feasible::Outside { 1.0 } else { -1.0 };
    let values = |points: &[[f64; D]], values: &mut [f64]| {
        field.eval(points, Outputs { values: Some(values), ..Outputs::default() })?;
        values.iter_mut().for_each(|v| *v *= sign);
        Ok(())
    };
    fill(grid, values, options, out, workers)
}

/// The same of a box along the part's axes, from `box_min` [dim] to `box_max` [dim].
///
/// Errors: those of `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a box that is none. Threads: any number at once. Cost: nanoseconds a
/// cell and a sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_fractions_of_box(
    part: *const ko_part,
    box_min: *const f64,
    box_max: *const f64,
    samples: u32,
    n_threads: u32,
    n_cells: usize,
    fractions: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part.
        let ko_part(part) = unsafe { object(part, "part") }?;
        in_its_dimension!(part, part => {
            // SAFETY: the header asks for arrays of these lengths.
            let (min, max, out) = unsafe {
                (
                    *object(box_min.cast(), "box_min")?,
                    *object(box_max.cast(), "box_max")?,
                    array_mut(fractions, n_cells, "fractions")?,
                )
            };
            let solid = Solid::Box(Bounds { min, max });
            fractions_of_solid(part.grid(), &solid, samples as usize, out, &Workers::new(n_threads)?)
        })
    })
}

/// The same of a ball, in the plane a disc, around `center` [dim].
///
/// Errors: those of `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a radius that is not above 0. Threads: any number at once. Cost:
/// nanoseconds a cell and a sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_fractions_of_ball(
    part: *const ko_part,
    center: *const f64,
    radius: f64,
    samples: u32,
    n_threads: u32,
    n_cells: usize,
    fractions: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part.
        let ko_part(part) = unsafe { object(part, "part") }?;
        in_its_dimension!(part, part => {
            // SAFETY: the header asks for arrays of these lengths.
            let (center, out) = unsafe {
                (*object(center.cast(), "center")?, array_mut(fractions, n_cells, "fractions")?)
            };
            let solid = Solid::Ball { center, radius };
            fractions_of_solid(part.grid(), &solid, samples as usize, out, &Workers::new(n_threads)?)
        })
    })
}

/// The same of a cylinder with flat ends, in the plane a strip, whose ends have their middles at `ends` [2 * dim]; `radius` is half the strip's
/// width.
///
/// Errors: those of `ko_part_fractions_of_mesh`; KO_ERR_INVALID_ARGUMENT for a radius that is not above 0, and ends that are one point. Threads: any
/// number at once. Cost: nanoseconds a cell and a sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ko_part_fractions_of_cylinder(
    part: *const ko_part,
    ends: *const f64,
    radius: f64,
    samples: u32,
    n_threads: u32,
    n_cells: usize,
    fractions: *mut f64,
) -> i32 {
    guard(|| {
        // SAFETY: the header asks for a part.
        let ko_part(part) = unsafe { object(part, "part") }?;
        in_its_dimension!(part, part => {
            // SAFETY: the header asks for arrays of these lengths.
            let (ends, out) = unsafe {
                (*object(ends.cast(), "ends")?, array_mut(fractions, n_cells, "fractions")?)
            };
            let solid = Solid::Cylinder { ends, radius };
            fractions_of_solid(part.grid(), &solid, samples as usize, out, &Workers::new(n_threads)?)
        })
    })
}
