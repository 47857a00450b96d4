//! What a mesh is worth: whether it bounds a solid, and what stands in the way.

use std::fmt;

use super::edges::{Edges, Sets, Side, repeats_vertex};
use super::vec::{Vec3, cross, dot, norm, scale, sub};
use super::{Bounds, Mesh};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// What the memory is for, should it run out.
const WORK: &str = "the report of the mesh";

/// A triangle is degenerate when its height over its longest side is at most this fraction of that side: far above the
/// rounding of the product that gives its normal, far below any sliver that single precision can tell from a line.
const FLAT: f64 = 1e-10;

/// Findings about a mesh. Edges and what follows from them leave out triangles that repeat a vertex.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MeshReport {
    /// Number of vertices V.
    pub n_vertices: usize,
    /// Number of triangles T.
    pub n_triangles: usize,
    /// Whether there is no boundary edge.
    pub closed: bool,
    /// Whether the two triangles of every edge that has two run through it in opposite directions.
    pub oriented: bool,
    /// Whether every edge has at most two triangles, and every vertex's triangles form one fan.
    pub manifold: bool,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Vertices whose triangles form no single fan: they fall into several, or meet at a non-manifold edge.
    pub non_manifold_vertices: usize,
    /// Parts connected through shared edges, non-manifold ones among them; touching at a vertex does not connect.
    pub components: usize,
    /// Triangles that repeat a vertex, or whose height is at most 1e-10 of their longest side.
    pub degenerate_triangles: usize,
    /// Triangles whose three vertices an earlier triangle has already, in any order.
    pub duplicate_triangles: usize,
    /// Vertices that no triangle uses.
    pub unreferenced_vertices: usize,
    /// The box around the vertices that triangles use.
    pub bounds: Bounds,
    /// Area.
    pub area: f64,
    /// Volume enclosed, negative when inside out; of meaning only when closed and oriented.
    pub volume: f64,
    /// Whether the mesh is closed and oriented and its volume negative: its normals point into the solid.
    pub inside_out: bool,
}

impl Mesh {
    /// Findings about this mesh, in O(T log T).
    pub fn report(&self) -> Result<MeshReport> {
        let topology = Topology::of(self)?;
        let size = Size::of(self);
        let closed = topology.boundary_edges == 0 && topology.components > 0;
        Ok(MeshReport {
            n_vertices: self.vertices().len(),
            n_triangles: self.triangles().len(),
            closed,
            oriented: topology.oriented,
            manifold: topology.non_manifold_edges == 0 && topology.non_manifold_vertices == 0,
            boundary_edges: topology.boundary_edges,
            non_manifold_edges: topology.non_manifold_edges,
            non_manifold_vertices: topology.non_manifold_vertices,
            components: topology.components,
            degenerate_triangles: size.degenerate,
            duplicate_triangles: count_duplicates(self.triangles())?,
            unreferenced_vertices: count_unreferenced(self)?,
            bounds: self.bounds(),
            area: size.area,
            volume: size.volume,
            inside_out: closed && topology.oriented && size.negative,
        })
    }
}

/// How the triangles hang together.
struct Topology {
    boundary_edges: usize,
    non_manifold_edges: usize,
    non_manifold_vertices: usize,
    components: usize,
    oriented: bool,
}

impl Topology {
    fn of(mesh: &Mesh) -> Result<Self> {
        let (n_vertices, triangles) = (mesh.vertices().len(), mesh.triangles());
        let mut found = Topology {
            boundary_edges: 0,
            non_manifold_edges: 0,
            non_manifold_vertices: 0,
            components: 0,
            oriented: true,
        };
        let mut parts = Sets::new(triangles.len())?;
        // Corners of one vertex that shared edges join: a fan. Its corners are numbered 3 t + k.
        let mut fans = Sets::new(3 * triangles.len())?;
        let mut bad = try_vec(n_vertices, false, WORK)?;
        for sides in Edges::of(triangles, n_vertices)?.iter() {
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
        for (t, triangle) in triangles.iter().enumerate().filter(|(_, t)| !repeats_vertex(t)) {
            found.components += usize::from(parts.is_first(t));
            for (_, &v) in triangle.iter().enumerate().filter(|(k, _)| fans.is_first(3 * t + k)) {
                bad[v as usize] |= has_fan[v as usize];
                has_fan[v as usize] = true;
            }
        }
        found.non_manifold_vertices = bad.iter().filter(|b| **b).count();
        Ok(found)
    }
}

fn join(a: &Side, b: &Side, parts: &mut Sets, fans: &mut Sets) {
    parts.join(a.triangle(), b.triangle());
    let (a, b) = (a.corners(), b.corners());
    fans.join(a[0], b[0]);
    fans.join(a[1], b[1]);
}

/// Area, volume, and how many triangles have none of either.
struct Size {
    area: f64,
    volume: f64,
    /// Whether the volume is negative, where `volume` itself may have left the range of `f64`.
    negative: bool,
    degenerate: usize,
}

impl Size {
    fn of(mesh: &Mesh) -> Self {
        let bounds = mesh.bounds();
        // A power of two brings the box to about 1 without rounding, so that products neither overflow nor vanish; the
        // centre of the box as origin keeps the volume's terms as small as its sum.
        let s = unit_scale(bounds);
        let center = std::array::from_fn(|a| 0.5 * (s * bounds.min[a]) + 0.5 * (s * bounds.max[a]));
        let (mut area, mut volume, mut degenerate) = (0.0, 0.0, 0);
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = mesh.corners(t).map(|p| scale(s, p));
            let normal = cross(sub(b, a), sub(c, a));
            let double_area = norm(normal);
            area += 0.5 * double_area;
            volume += dot(sub(a, center), normal) / 6.0;
            if repeats_vertex(triangle) || is_flat(double_area, [a, b, c]) {
                degenerate += 1;
            }
        }
        Size { area: area / s / s, volume: volume / s / s / s, negative: volume < 0.0, degenerate }
    }
}

/// Whether the height over the longest side is at most [`FLAT`] of that side.
fn is_flat(double_area: f64, [a, b, c]: [Vec3; 3]) -> bool {
    let longest = norm(sub(b, a)).max(norm(sub(c, b))).max(norm(sub(a, c)));
    double_area <= FLAT * longest * longest
}

/// A power of two that takes the longest edge of `bounds` to between 1 and 4, as far as `f64` has one.
fn unit_scale(bounds: Bounds) -> f64 {
    // Halves, since the difference of finite numbers can overflow.
    let half = (0..3).map(|a| 0.5 * bounds.max[a] - 0.5 * bounds.min[a]).fold(0.0, f64::max);
    if half == 0.0 {
        return 1.0;
    }
    let biased_exponent = (half.to_bits() >> 52).min(2045);
    f64::from_bits((2046 - biased_exponent) << 52)
}

fn count_duplicates(triangles: &[[u32; 3]]) -> Result<usize> {
    let mut sets = try_with_capacity(triangles.len(), WORK)?;
    sets.extend_from_slice(triangles);
    sets.iter_mut().for_each(|t: &mut [u32; 3]| t.sort_unstable());
    sets.sort_unstable();
    Ok(sets.windows(2).filter(|pair| pair[0] == pair[1]).count())
}

fn count_unreferenced(mesh: &Mesh) -> Result<usize> {
    let mut used = try_vec(mesh.vertices().len(), false, WORK)?;
    mesh.triangles().iter().flatten().for_each(|&v| used[v as usize] = true);
    Ok(used.iter().filter(|u| !**u).count())
}

impl MeshReport {
    /// Whether the mesh bounds a solid with its normals out of it. Self-intersections are not looked for.
    pub fn is_solid(&self) -> bool {
        self.closed && self.oriented && self.manifold && !self.inside_out
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.bounds.extents();
        writeln!(
            f,
            "{} vertices, {} triangles, {} components; box {x:.4e} x {y:.4e} x {z:.4e}; area {:.6e}, volume {:.6e}",
            self.n_vertices, self.n_triangles, self.components, self.area, self.volume
        )?;
        let flags = [
            (self.is_solid(), "closed, oriented, manifold: a solid"),
            (self.inside_out, "inside out: flip it"),
            (!self.oriented, "winding: neighbouring triangles disagree; orient them alike"),
        ];
        for (_, remark) in flags.iter().filter(|(holds, _)| *holds) {
            writeln!(f, "{remark}")?;
        }
        let counts = [
            (self.boundary_edges, "boundary edges: open; close the holes if a solid is meant"),
            (self.non_manifold_edges, "edges with more than two triangles: split the parts that meet there"),
            (self.non_manifold_vertices, "vertices that join several fans: give each fan a vertex of its own"),
            (self.degenerate_triangles, "triangles without area: harmless for sampling, better removed"),
            (self.duplicate_triangles, "triangles given more than once: remove the copies"),
            (self.unreferenced_vertices, "vertices that no triangle uses: harmless"),
        ];
        for (count, remark) in counts.iter().filter(|(count, _)| *count > 0) {
            writeln!(f, "{count} {remark}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
