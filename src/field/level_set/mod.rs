//! Level sets {phi = level} as meshes: triangles in space, segments in the plane, by one code path.
//!
//! Takes a function on a box of cells; gives vertices on the level set and facets oriented as the boundary of the solid: out of the side
//! where the design may not be. Watertight by construction wherever the level set stays within the box: every ridge (an edge in space, a
//! vertex in the plane) between two facets, every vertex in one fan. Where it meets the box it is left open, and the ridges there are
//! counted.
//!
//! Notation: f = phi - level; lattice, the cells cut into `subdivisions` along each axis; crossing, an edge of the lattice between values
//! of different sign; h the length of the result's edges: that of a lattice edge, or what edges are collapsed to.
//!
//! | step | source | here |
//! |---|---|---|
//! | blocks of the lattice where f may be 0 | Bezier points bound a spline: Ramshaw 1989 | `blocks.rs`, [`crate::spline::hull`] |
//! | f at their vertices, no others | | `cubes.rs`, `near.rs`, [`super::lattice`] |
//! | crossed edges, numbered | | `crossings.rs` |
//! | vertices: roots on crossed edges | safeguarded Newton | `roots.rs` |
//! | cases of a cube | Kuhn 1960, Freudenthal 1942 | `kuhn.rs` |
//! | facets | Allgower and Gnutzmann 1987, marching simplices | `assemble.rs` |
//! | short edges collapsed | Dey et al. 1999, link condition; Hoppe 1996 | `collapse.rs`, `rings.rs`, `quality.rs` |
//! | vertices moved along the level set | Freitag 1997, smart smoothing | `relax.rs` |
//! | segments joined to curves | | [`Mesh::polylines`] |
//!
//! Where we depart: vertices are roots of the function itself, not of its linear interpolant, so they lie on the level set to rounding,
//! but for those within 1e-9 of a lattice vertex, which keep that distance from it (in edges).
//!
//! The facets are a piecewise linear stand-in: between its vertices the level set is missed by about h^2 times an eighth of its curvature,
//! and what is smaller than h may be missed or joined. Self-intersections are not looked for; marching simplices make none before edges
//! are collapsed.

mod assemble;
mod blocks;
mod collapse;
mod crossings;
mod cubes;
mod kuhn;
mod near;
mod options;
mod quality;
mod queue;
mod relax;
mod rings;
mod roots;
#[cfg(test)]
mod tests;

use super::{Field, Function};
use crate::Result;
use crate::error::{Error, try_vec, try_with_capacity};
use crate::geometry::Mesh;
use crate::geometry::vec::number;
use crate::par::Workers;
use crate::progress::Progress;
use crate::spline::Axis;
pub use blocks::LatticeBlocks;
use crossings::Crossings;
use cubes::Cubes;
use kuhn::CubeEdge;
use near::Near;
pub use options::LevelSetOptions;
use relax::Relaxation;
use std::ops::Range;

/// A level set in a box of D dimensions, as a simplicial mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelSet<const D: usize> {
    vertices: Vec<[f64; D]>,
    facets: Vec<[u32; D]>,
    boundary: usize,
}

impl<const D: usize> LevelSet<D> {
    /// Vertices [V x D], in the caller's units. Each is used, no two are equal.
    pub fn vertices(&self) -> &[[f64; D]] {
        &self.vertices
    }

    /// Vertex indices of the facets [F x D]: triangles counter-clockwise seen from outside the solid, segments with the solid on their
    /// left.
    pub fn facets(&self) -> &[[u32; D]] {
        &self.facets
    }

    /// Edges in space, vertices in the plane, at which the surface is open because it meets the box; 0 when it is closed.
    pub fn boundary(&self) -> usize {
        self.boundary
    }

    /// The level set as a mesh.
    pub fn into_mesh(self) -> Result<Mesh<D>> {
        Mesh::new(self.vertices, self.facets)
    }
}

/// The function whose level set is asked for, and the box in which.
#[derive(Debug, Clone, Copy)]
pub struct Question<'a, F, const D: usize> {
    /// The function.
    pub phi: &'a F,
    /// The box and its cells.
    pub axes: [Axis; D],
    /// The level.
    pub level: f64,
    /// 1 when phi grows out of the solid, -1 when it grows into it: normals run along this times grad phi.
    pub outward: f64,
}

impl<const D: usize> Field<D> {
    /// The level set {phi = `level`}, `level` in the caller's unit of length, within the field's box: for level 0 the fitted shape, for
    /// others a shape about that far from it. Normals point out of the solid, to where phi grows when the feasible side is outside, to
    /// where it falls when inside.
    ///
    /// Of a refined field the cells that `options` cuts are those of its deepest level with which the lattice has no more than 2^26
    /// vertices.
    ///
    /// The same bits on any number of threads. Cost: an evaluation at each lattice vertex in blocks that phi's control points do not keep
    /// from the level, about 5 with gradient at each crossing. [`Error::Degenerate`] where phi does not take the level on the lattice,
    /// naming the range that it takes at the corners of cells; [`Error::OutOfMemory`] beforehand, where that part of the lattice or the
    /// surface would take more than the limit.
    pub fn level_set(&self, level: f64, options: &LevelSetOptions, progress: &mut Progress) -> Result<LevelSet<D>> {
        let outward = self.feasible.sign();
        extract(
            &Question { phi: self, axes: self.surface_axes(options.subdivisions), level, outward },
            options,
            progress,
        )
    }

    /// The cells on which a surface is looked for: of a refined field those of the deepest level with which the lattice is not too large.
    pub(in crate::field) fn surface_axes(&self, subdivisions: u32) -> [Axis; D] {
        let Some(refined) = &self.refined else { return self.grid.axes };
        let vertices =
            |axes: &[Axis; D]| axes.iter().map(|a| a.n_cells as u128 * u128::from(subdivisions) + 1).product::<u128>();
        let tree = refined.tree();
        let of_levels = (1..tree.n_levels()).rev().map(|level| tree.grid_of(level).axes);
        of_levels.into_iter().find(|axes| vertices(axes) <= LARGEST_LATTICE).unwrap_or(self.grid.axes)
    }
}

/// Vertices of the lattice on which the surface of a refined field is looked for, at most, where its longest cells allow that.
const LARGEST_LATTICE: u128 = 1 << 26;

/// A surface in the making.
#[derive(Debug, Clone)]
struct Surface<const D: usize> {
    vertices: Vec<[f64; D]>,
    /// Unit normals of the level set at the vertices.
    normals: Vec<[f64; D]>,
    /// Faces of the box that hold each vertex, as bits; 0 inside.
    faces: Vec<u8>,
    facets: Vec<[u32; D]>,
}

/// Bytes per vertex of the raw surface: place, normal, faces, crossing, with facets (two a vertex), rings, the list of short edges and the
/// moves.
const VERTEX_BYTES: u128 = 320;

/// A function whose values differ by no more than this fraction of the level is constant but for rounding: sums of 64 terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The level set that `question` asks for: see [`Field::level_set`].
pub fn extract<F: Function<D>, const D: usize>(
    question: &Question<F, D>,
    options: &LevelSetOptions,
    progress: &mut Progress,
) -> Result<LevelSet<D>> {
    options.validate()?;
    let &Question { phi, axes, level, outward } = question;
    if !level.is_finite() {
        return Err(Error::InvalidArgument(format!("the level is {level}; it must be finite")));
    }
    let cubes = Cubes::new(axes, options.subdivisions)?;
    check_memory(Near::least_bytes(&cubes), &cubes, options.memory_limit)?;
    let workers = Workers::new(options.n_threads)?;
    let blocks = LatticeBlocks::new(cubes.counts())?;
    phi.mark_blocks(level, &blocks, &workers, &mut |done| progress.tell(0.1 * done, "lattice"))?;
    let mut lattice_bytes = 0;
    let near = Near::new(&cubes, blocks, |bytes, vertices| {
        lattice_bytes = bytes + vertices as u128 * (size_of::<f64>() as u128 + Crossings::BYTES);
        check_memory(lattice_bytes, &cubes, options.memory_limit)
    })?;

    let mut f = try_vec(near.len(), 0.0, "the values on the lattice")?;
    let which = (near.len(), |places| near.vertices(places));
    let tell = |done| progress.tell(0.1 + 0.3 * done, "lattice");
    cubes.lattice()?.eval_some(phi, which, Some(&mut f), None, &workers, tell)?;
    let range = range_of(&f);
    f.iter_mut().for_each(|f| *f -= level);
    let crossings = Crossings::find(&near, &f, &workers)?;
    // Blocks are left out only far from the level, so that beside them values are no constant.
    if crossings.len == 0 || range.1 - range.0 <= ROUNDING * level.abs() {
        return Err(out_of_reach(corner_range(question, &workers, progress)?, level));
    }
    check_memory(lattice_bytes + crossings.len as u128 * VERTEX_BYTES, &cubes, options.memory_limit)?;

    let edges = crossings.list(&cubes, &near)?;
    let tell = |done| progress.tell(0.4 + 0.2 * done, "vertices");
    let mut surface = roots::find(question, (&cubes, &near, &f), &edges, &workers, tell)?;
    drop(edges);
    surface.facets = assemble::facets(&near, &f, &crossings, outward, &workers)?;
    drop((f, crossings, near));
    let shortest = options.shortest_edge * axes.iter().fold(f64::INFINITY, |m, a| m.min(a.cell));
    // The size of the result's facets.
    let h = cubes.shortest_edge().max(shortest);
    if shortest > 0.0 {
        collapse::collapse(&mut surface, shortest, h, |done| progress.tell(0.6 + 0.2 * done, "collapse"))?;
    }
    let relaxation = Relaxation { phi, level, sign: outward, h, lower: cubes.lower, upper: cubes.upper };
    let tell = |done| progress.tell(0.8 + 0.2 * done, "relaxation");
    relaxation.run(&mut surface, options.relaxations, &workers, tell)?;
    progress.tell(1.0, "done")?;
    let boundary = count_boundary(&surface)?;
    Ok(LevelSet { vertices: surface.vertices, facets: surface.facets, boundary })
}

/// Ridges on the faces of the box: what is open.
fn count_boundary<const D: usize>(surface: &Surface<D>) -> Result<usize> {
    if D == 2 {
        return Ok(surface.faces.iter().filter(|faces| **faces != 0).count());
    }
    // Each edge on a face of the box is in one triangle, and an edge between two vertices of one face that is not on the boundary is in
    // two; so it is counted by its sides.
    let on_box = |v: u32| surface.faces[v as usize] != 0;
    let all = || {
        let sides = surface.facets.iter().flat_map(|f| (0..D).map(|k| [f[k], f[(k + 1) % D]]));
        sides.filter(|[a, b]| on_box(*a) && on_box(*b))
    };
    let mut sides = try_with_capacity(all().count(), "the boundary of the level set")?;
    sides.extend(all().map(|[a, b]| [a.min(b), a.max(b)]));
    sides.sort_unstable();
    Ok(sides.chunk_by(|a, b| a == b).filter(|sides| sides.len() == 1).count())
}

/// Refuses what would take more than `limit` bytes.
fn check_memory<const D: usize>(bytes: u128, cubes: &Cubes<D>, limit: u64) -> Result<()> {
    if bytes <= u128::from(limit) {
        return Ok(());
    }
    let shape = cubes.shape.map(|n| n.to_string()).join(" x ");
    Err(Error::OutOfMemory {
        what: format!("a level set on a lattice of {shape} points"),
        bytes,
        limit: Some(u128::from(limit)),
    })
}

/// The least and the largest of `phi`.
fn range_of(phi: &[f64]) -> (f64, f64) {
    phi.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)))
}

/// The least and the largest value of phi at the corners of cells.
fn corner_range<F: Function<D>, const D: usize>(
    &Question { phi, axes, .. }: &Question<F, D>,
    workers: &Workers,
    progress: &mut Progress,
) -> Result<(f64, f64)> {
    const BLOCK: usize = 1 << 14;
    let corners = Cubes::new(axes, 1)?.lattice()?;
    let mut values = try_vec(corners.len().min(BLOCK), 0.0, "the values at the corners of cells")?;
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for first in (0..corners.len()).step_by(BLOCK) {
        let values = &mut values[..BLOCK.min(corners.len() - first)];
        let which = (values.len(), |places: Range<usize>| first + places.start..first + places.end);
        corners.eval_some(phi, which, Some(&mut *values), None, workers, |_| progress.tell(0.0, "lattice"))?;
        let (low, high) = range_of(values);
        range = (low.min(range.0), high.max(range.1));
    }
    Ok(range)
}

/// Why there is no level set where f has one sign, or phi, from `low` to `high`, is constant but for rounding.
fn out_of_reach((low, high): (f64, f64), level: f64) -> Error {
    let [level, low, high] = [level, low, high].map(number);
    Error::Degenerate(format!(
        "the level {level} is not reached: at the corners of cells phi runs from {low} to {high}; choose a level between, where phi is not constant"
    ))
}
