//! What a mesh is worth: whether it bounds a solid, and what stands in the way.
//!
//! In the plane the edges of the segments are their vertices: an edge with one facet is an end point. Areas are lengths there, volumes
//! areas.

use std::fmt;

use super::edges::{Edges, Sets, Side, repeats_vertex};
use super::vec::{dot, norm, scale, sub};
use super::{Bounds, Mesh, facet};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// What the memory is for, should it run out.
const WORK: &str = "the report of the mesh";

/// A triangle is degenerate when its height over its longest side is at most this fraction of that side: far above the
/// rounding of the product that gives its normal, far below any sliver that single precision can tell from a line. A segment is degenerate
/// when it has no length.
const FLAT: f64 = 1e-10;

/// Findings about a mesh. Edges and what follows from them leave out facets that repeat a vertex.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MeshReport<const D: usize = 3> {
    /// Number of vertices V.
    pub n_vertices: usize,
    /// Number of facets F: triangles, or segments.
    pub n_facets: usize,
    /// Whether there is no boundary edge.
    pub closed: bool,
    /// Whether the two facets of every edge that has two run through it in opposite directions; in the plane, through it and on.
    pub oriented: bool,
    /// Whether every edge has at most two facets, and every vertex's facets form one fan.
    pub manifold: bool,
    /// Edges with one facet; in the plane, end points.
    pub boundary_edges: usize,
    /// Edges with more than two facets.
    pub non_manifold_edges: usize,
    /// Vertices whose facets form no single fan: they fall into several, or meet at a non-manifold edge. In the plane, non-manifold edges.
    pub non_manifold_vertices: usize,
    /// Parts connected through shared edges, non-manifold ones among them; touching at a vertex does not connect triangles.
    pub components: usize,
    /// Triangles that repeat a vertex, or whose height is at most 1e-10 of their longest side; segments without length.
    pub degenerate_facets: usize,
    /// Facets whose vertices an earlier one has already, in any order.
    pub duplicate_facets: usize,
    /// Vertices that no facet uses.
    pub unreferenced_vertices: usize,
    /// The box around the vertices that facets use.
    pub bounds: Bounds<D>,
    /// Area; in the plane, length.
    pub area: f64,
    /// Volume enclosed, in the plane area; negative when inside out, and of meaning only when closed and oriented.
    pub volume: f64,
    /// Whether the mesh is closed and oriented and its volume negative: its normals point into the solid.
    pub inside_out: bool,
}

impl<const D: usize> Mesh<D> {
    /// Findings about this mesh, in O(F log F).
    pub fn report(&self) -> Result<MeshReport<D>> {
        let topology = Topology::of(self)?;
        let size = Size::of(self);
        let closed = topology.boundary_edges == 0 && topology.components > 0;
        Ok(MeshReport {
            n_vertices: self.vertices().len(),
            n_facets: self.facets().len(),
            closed,
            oriented: topology.oriented,
            manifold: topology.non_manifold_edges == 0 && topology.non_manifold_vertices == 0,
            boundary_edges: topology.boundary_edges,
            non_manifold_edges: topology.non_manifold_edges,
            non_manifold_vertices: topology.non_manifold_vertices,
            components: topology.components,
            degenerate_facets: size.degenerate,
            duplicate_facets: count_duplicates(self.facets())?,
            unreferenced_vertices: count_unreferenced(self)?,
            bounds: self.bounds(),
            area: size.area,
            volume: size.volume,
            inside_out: closed && topology.oriented && size.negative,
        })
    }
}

/// How the facets hang together.
struct Topology {
    boundary_edges: usize,
    non_manifold_edges: usize,
    non_manifold_vertices: usize,
    components: usize,
    oriented: bool,
}

impl Topology {
    fn of<const D: usize>(mesh: &Mesh<D>) -> Result<Self> {
        let (n_vertices, facets) = (mesh.vertices().len(), mesh.facets());
        let mut found = Topology {
            boundary_edges: 0,
            non_manifold_edges: 0,
            non_manifold_vertices: 0,
            components: 0,
            oriented: true,
        };
        let mut parts = Sets::new(facets.len())?;
        // Corners of one vertex that shared edges join: a fan. Its corners are numbered D f + k.
        let mut fans = Sets::new(D * facets.len())?;
        let mut bad = try_vec(n_vertices, false, WORK)?;
        for sides in Edges::of(facets, n_vertices)?.iter() {
            match sides {
                [_] => found.boundary_edges += 1,
                [a, b] => found.oriented &= a.forward != b.forward,
                [a, ..] => {
                    found.non_manifold_edges += 1;
                    a.edge.iter().for_each(|&v| bad[v as usize] = true);
                }
                [] => {}
            }
            for pair in sides.windows(2) {
                join(&pair[0], &pair[1], &mut parts, &mut fans);
            }
        }
        let mut has_fan = try_vec(n_vertices, false, WORK)?;
        for (f, facet) in facets.iter().enumerate().filter(|(_, f)| !repeats_vertex(f)) {
            found.components += usize::from(parts.is_first(f));
            for (_, &v) in facet.iter().enumerate().filter(|(k, _)| fans.is_first(D * f + k)) {
                bad[v as usize] |= has_fan[v as usize];
                has_fan[v as usize] = true;
            }
        }
        found.non_manifold_vertices = bad.iter().filter(|b| **b).count();
        Ok(found)
    }
}

fn join<const D: usize>(a: &Side<D>, b: &Side<D>, parts: &mut Sets, fans: &mut Sets) {
    parts.join(a.facet(), b.facet());
    let (a, b) = (a.corners(), b.corners());
    fans.join(a[0], b[0]);
    fans.join(a[1], b[1]);
}

/// Area, volume, and how many facets have none of either.
struct Size {
    area: f64,
    volume: f64,
    /// Whether the volume is negative, where `volume` itself may have left the range of `f64`.
    negative: bool,
    degenerate: usize,
}

impl Size {
    fn of<const D: usize>(mesh: &Mesh<D>) -> Self {
        let bounds = mesh.bounds();
        // A power of two brings the box to about 1 without rounding, so that products neither overflow nor vanish; the
        // centre of the box as origin keeps the volume's terms as small as its sum.
        let s = unit_scale(bounds);
        let center: [f64; D] = std::array::from_fn(|a| 0.5 * (s * bounds.min[a]) + 0.5 * (s * bounds.max[a]));
        let (mut area, mut volume, mut degenerate) = (0.0, 0.0, 0);
        for (f, facet) in mesh.facets().iter().enumerate() {
            let corners = mesh.corners(f).map(|p| scale(s, p));
            area += facet::area(&corners);
            // The pyramid over the facet, by the divergence theorem.
            volume += dot(sub(corners[0], center), facet::normal(&corners)) / (D * (D - 1)) as f64;
            if repeats_vertex(facet) || is_flat(&corners) {
                degenerate += 1;
            }
        }
        let grown = |x: f64, power: usize| (0..power).fold(x, |x, _| x / s);
        Size { area: grown(area, D - 1), volume: grown(volume, D), negative: volume < 0.0, degenerate }
    }
}

/// Whether a triangle's height over its longest side is at most [`FLAT`] of that side, or a segment has no length.
fn is_flat<const D: usize>(corners: &[[f64; D]; D]) -> bool {
    let sides = (0..D).map(|k| norm(sub(corners[(k + 1) % D], corners[k])));
    let longest = sides.fold(0.0, f64::max);
    (D - 1) as f64 * facet::area(corners) <= (1..D).fold(FLAT, |limit, _| limit * longest)
}

/// A power of two that takes the longest edge of `bounds` to between 1 and 4, as far as `f64` has one.
fn unit_scale<const D: usize>(bounds: Bounds<D>) -> f64 {
    // Halves, since the difference of finite numbers can overflow.
    let half = (0..D).map(|a| 0.5 * bounds.max[a] - 0.5 * bounds.min[a]).fold(0.0, f64::max);
    if half == 0.0 {
        return 1.0;
    }
    let biased_exponent = (half.to_bits() >> 52).min(2045);
    f64::from_bits((2046 - biased_exponent) << 52)
}

fn count_duplicates<const D: usize>(facets: &[[u32; D]]) -> Result<usize> {
    let mut sets = try_with_capacity(facets.len(), WORK)?;
    sets.extend_from_slice(facets);
    sets.iter_mut().for_each(|f: &mut [u32; D]| f.sort_unstable());
    sets.sort_unstable();
    Ok(sets.windows(2).filter(|pair| pair[0] == pair[1]).count())
}

fn count_unreferenced<const D: usize>(mesh: &Mesh<D>) -> Result<usize> {
    let mut used = try_vec(mesh.vertices().len(), false, WORK)?;
    mesh.facets().iter().flatten().for_each(|&v| used[v as usize] = true);
    Ok(used.iter().filter(|u| !**u).count())
}

impl<const D: usize> MeshReport<D> {
    /// Whether the mesh bounds a solid with its normals out of it. Self-intersections are not looked for.
    pub fn is_solid(&self) -> bool {
        self.closed && self.oriented && self.manifold && !self.inside_out
    }
}

/// What a report says in its dimension's words.
struct Words {
    area: &'static str,
    volume: &'static str,
    boundary_edges: &'static str,
    non_manifold_edges: &'static str,
}

const IN_SPACE: Words = Words {
    area: "area",
    volume: "volume",
    boundary_edges: "boundary edges: open; close the holes if a solid is meant",
    non_manifold_edges: "edges with more than two triangles: split the parts that meet there",
};

const IN_THE_PLANE: Words = Words {
    area: "length",
    volume: "area",
    boundary_edges: "end points: open; join them if a solid is meant",
    non_manifold_edges: "vertices with more than two segments: give each curve a vertex of its own",
};

impl<const D: usize> fmt::Display for MeshReport<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, words) = (Mesh::<D>::FACET, if D == 2 { IN_THE_PLANE } else { IN_SPACE });
        let extents = self.bounds.extents().map(|x| format!("{x:.4e}")).join(" x ");
        writeln!(
            f,
            "{} vertices, {} {name}s, {} components; box {extents}; {} {:.6e}, {} {:.6e}",
            self.n_vertices, self.n_facets, self.components, words.area, self.area, words.volume, self.volume
        )?;
        if self.is_solid() {
            writeln!(f, "closed, oriented, manifold: a solid")?;
        }
        if self.inside_out {
            writeln!(f, "inside out: flip it")?;
        }
        if !self.oriented {
            writeln!(f, "winding: neighbouring {name}s disagree; orient them alike")?;
        }
        // In the plane these are the vertices of the line before.
        let fans = if D == 2 { 0 } else { self.non_manifold_vertices };
        let counts = [
            (self.boundary_edges, words.boundary_edges.to_owned()),
            (self.non_manifold_edges, words.non_manifold_edges.to_owned()),
            (fans, "vertices that join several fans: give each fan a vertex of its own".to_owned()),
            (self.degenerate_facets, format!("{name}s without {}: harmless for sampling, better removed", words.area)),
            (self.duplicate_facets, format!("{name}s given more than once: remove the copies")),
            (self.unreferenced_vertices, format!("vertices that no {name} uses: harmless")),
        ];
        for (count, remark) in counts.iter().filter(|(count, _)| *count > 0) {
            writeln!(f, "{count} {remark}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
