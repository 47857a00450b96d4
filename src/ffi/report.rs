//! Reports: plain structs that the library fills.

use super::fit_options::{KO_FEASIBLE_INSIDE, KO_FEASIBLE_OUTSIDE};
use super::pointer::{Sized_, write_sized};
use crate::Result;
use crate::field::{Feasible, Field};
use crate::geometry::MeshReport;
use crate::spline::Axis;

/// What can be said of a mesh. Filled by `ko_mesh_get_report`. In the plane read segment for triangle, end of a segment for edge, length
/// for area, area for volume; entries along z are 0.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_mesh_report {
    /// sizeof(ko_mesh_report) as the caller knows it.
    pub struct_size: usize,
    /// Vertices, used by a triangle or not.
    pub n_vertices: u64,
    /// Triangles.
    pub n_triangles: u64,
    /// Parts that are connected through shared edges.
    pub n_components: u64,
    /// Edges with one triangle.
    pub n_boundary_edges: u64,
    /// Edges with more than two triangles.
    pub n_non_manifold_edges: u64,
    /// Vertices whose triangles form more than one fan.
    pub n_non_manifold_vertices: u64,
    /// Triangles without area: a vertex twice, or a height of at most 1e-10 of the longest side.
    pub n_degenerate: u64,
    /// Triangles whose three vertices another triangle before them has too.
    pub n_duplicate: u64,
    /// Vertices that no triangle uses.
    pub n_unreferenced: u64,
    /// 1: no boundary edge.
    pub closed: i32,
    /// 1: neighbours run through their shared edge in opposite directions.
    pub oriented: i32,
    /// 1: at most two triangles at an edge, one fan at a vertex.
    pub manifold: i32,
    /// 1: closed and oriented with normals that point into the solid (volume < 0): `ko_mesh_flip` turns it.
    pub inside_out: i32,
    /// Lower corner of the bounding box.
    pub bounds_min: [f64; 3],
    /// Upper corner of the bounding box.
    pub bounds_max: [f64; 3],
    /// Area, in the square of the mesh's unit.
    pub area: f64,
    /// Signed volume, in the cube of the mesh's unit; it means something for a closed, oriented mesh.
    pub volume: f64,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_mesh_report {
    const FIRST_SIZE: usize = size_of::<usize>() + 9 * 8 + 4 * 4 + 8 * 8;
}

const _: () = assert!(size_of::<ko_mesh_report>() == <ko_mesh_report as Sized_>::FIRST_SIZE);

impl ko_mesh_report {
    /// # Safety
    /// `to` is NULL or points to `size` writable bytes.
    pub(super) unsafe fn write<const D: usize>(to: *mut Self, size: usize, r: &MeshReport<D>) -> Result<()> {
        // In the plane what belongs to z is 0.
        let in_space = |p: [f64; D]| [0, 1, 2].map(|a| p.get(a).copied().unwrap_or(0.0));
        let report = ko_mesh_report {
            struct_size: size,
            n_vertices: r.n_vertices as u64,
            n_triangles: r.n_facets as u64,
            n_components: r.components as u64,
            n_boundary_edges: r.boundary_edges as u64,
            n_non_manifold_edges: r.non_manifold_edges as u64,
            n_non_manifold_vertices: r.non_manifold_vertices as u64,
            n_degenerate: r.degenerate_facets as u64,
            n_duplicate: r.duplicate_facets as u64,
            n_unreferenced: r.unreferenced_vertices as u64,
            closed: i32::from(r.closed),
            oriented: i32::from(r.oriented),
            manifold: i32::from(r.manifold),
            inside_out: i32::from(r.inside_out),
            bounds_min: in_space(r.bounds.min),
            bounds_max: in_space(r.bounds.max),
            area: r.area,
            volume: r.volume,
        };
        // SAFETY: the caller's promise.
        unsafe { write_sized(to, size, report, "report") }
    }
}

/// What a field is and what its fit did. Filled by `ko_field_get_report`. Errors are fractions of D.
#[allow(non_camel_case_types)]
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ko_fit_report {
    /// sizeof(ko_fit_report) as the caller knows it.
    pub struct_size: usize,
    /// 2 in the plane, where entries along z are 0; 3 in space.
    pub dim: u32,
    /// KO_FEASIBLE_OUTSIDE or KO_FEASIBLE_INSIDE.
    pub feasible: i32,
    /// Control points along x, y, z; an axis of n has n - 3 cells. Of a refined field those of the longest cells.
    pub control_points: [u32; 3],
    /// Iterations of the solve, all rounds together.
    pub iterations: u32,
    /// Unknowns of the solve: control points in all.
    pub n_unknowns: u64,
    /// Points of the cloud.
    pub n_points: u64,
    /// Bytes that the field holds for evaluation. A field that was fitted, not loaded, remembers besides up to 24 bytes a point and 16 a cell.
    pub bytes: u64,
    /// Lower corner of the box.
    pub box_min: [f64; 3],
    /// Upper corner of the box.
    pub box_max: [f64; 3],
    /// D: diagonal of the cloud's bounding box.
    pub diagonal: f64,
    /// Relative residual reached.
    pub residual: f64,
    /// Seconds to bring the points in order and to measure the far distances; of refined fits, those to bring functions in order too, and
    /// all of it on the cells of each round.
    pub seconds_assembly: f64,
    /// Seconds of the solves, with right-hand sides, preconditioners, and what looks at their outcome between them.
    pub seconds_solve: f64,
    /// Seconds to measure the errors.
    pub seconds_check: f64,
    /// Root mean square of phi at the points of the cloud.
    pub rms: f64,
    /// Largest |phi| at the points of the cloud.
    pub max: f64,
    /// Mean of |grad phi| at the points of the cloud: 1 for a distance.
    pub mean_gradient: f64,
    /// Points that a robust fit (KO_REWEIGHT_ROBUST) left out at last.
    pub n_outliers: u64,
    /// Of the cells farther than one from the points (refined: than half of one of theirs, and than their spacing), the part on whose
    /// side there is little doubt: 1 for closed shapes. Less for open ones: beyond their rim and far from them the sign of phi is one of
    /// many; `ko_cloud_sides` tells where. Not a number where distance_weight was 0, and for a field that was loaded or made.
    pub clear_sides: f64,
    /// Mean factor by which an iteration of the last round lowered the residual: 0.1 gains a digit each. Not a number for a field that
    /// was loaded or made.
    pub convergence_rate: f64,
    /// Levels of cells, those of each half as long as those of the one before: 1 where nothing was refined.
    pub n_levels: u64,
}

// SAFETY: repr(C), starts with a usize, plain numbers without padding (checked below).
unsafe impl Sized_ for ko_fit_report {
    const FIRST_SIZE: usize = size_of::<usize>() + 6 * 4 + 3 * 8 + 14 * 8;
}

const _: () = assert!(std::mem::offset_of!(ko_fit_report, n_outliers) == <ko_fit_report as Sized_>::FIRST_SIZE);

impl ko_fit_report {
    /// # Safety
    /// `to` is NULL or points to `size` writable bytes.
    pub(super) unsafe fn write<const D: usize>(to: *mut Self, size: usize, field: &Field<D>) -> Result<()> {
        let r = field.report();
        // In the plane what belongs to z is 0.
        let along = |f: fn(&Axis) -> f64| [0, 1, 2].map(|a| field.grid().axes.get(a).map_or(0.0, f));
        let report = ko_fit_report {
            struct_size: size,
            dim: D as u32,
            feasible: match field.feasible() {
                Feasible::Outside => KO_FEASIBLE_OUTSIDE,
                Feasible::Inside => KO_FEASIBLE_INSIDE,
            },
            control_points: r.control_points,
            iterations: r.iterations,
            n_unknowns: r.n_unknowns,
            n_points: r.n_points,
            bytes: field.bytes() as u64,
            box_min: along(|a| a.lower),
            box_max: along(Axis::upper),
            diagonal: field.diagonal(),
            residual: r.residual,
            seconds_assembly: r.seconds_assembly,
            seconds_solve: r.seconds_solve,
            seconds_check: r.seconds_check,
            rms: r.rms,
            max: r.max,
            mean_gradient: r.mean_gradient,
            n_outliers: r.n_outliers,
            clear_sides: r.clear_sides,
            convergence_rate: r.convergence_rate,
            n_levels: r.n_levels.into(),
        };
        // SAFETY: the caller's promise.
        unsafe { write_sized(to, size, report, "report") }
    }
}
