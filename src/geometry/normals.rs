//! Normals at the corners of triangles, smooth over a smooth surface and broken along sharp edges.
//!
//! The triangles around a vertex fall into groups: two belong together when they share an edge that is used by exactly these
//! two, once in each direction, and their normals differ by at most [`SHARP_EDGE_DEGREES`]. A corner's normal is the mean of
//! its group's unit normals, weighted by the angles at the vertex (Thuermer and Wuethrich, "Computing vertex normals from
//! polygonal facets", 1998). A fan of a cone can add up to more than that angle: only neighbours are compared.

use super::Mesh;
use super::vec3::{Vec3, add, cross, dot, norm, normalized, scale, sub};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// An edge is sharp where its two triangles' normals differ by more than this.
pub const SHARP_EDGE_DEGREES: f64 = 40.0;

/// One corner of one triangle.
#[derive(Debug, Clone, Copy)]
struct Corner {
    triangle: u32,
    corner: u32,
}

/// A triangle's edge at the vertex at hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spoke {
    /// The edge's other end.
    end: u32,
    /// Whether the triangle runs along the edge away from the vertex.
    outgoing: bool,
    /// Index of the triangle's corner in the fan.
    member: u32,
}

/// Unit normals of the three corners of every triangle [T x 3 x 3]. A triangle without area has zeros, and takes no part.
pub fn corner_normals(mesh: &Mesh) -> Result<Vec<[Vec3; 3]>> {
    let n_triangles = mesh.triangles().len();
    let mut face_normals = try_with_capacity(n_triangles, "the face normals")?;
    face_normals.extend((0..n_triangles).map(|t| normalized(mesh.area_normal(t)).unwrap_or_default()));

    let (starts, corners) = corners_by_vertex(mesh, &face_normals)?;
    let mut normals = try_vec(n_triangles, [[0.0; 3]; 3], "the corner normals")?;
    let mut fan = Fan::default();
    for window in starts.windows(2) {
        let members = &corners[window[0]..window[1]];
        fan.group(mesh, &face_normals, members);
        fan.accumulate(mesh, &face_normals, members);
        for (i, m) in members.iter().enumerate() {
            let mean = fan.sums[fan.root(i as u32) as usize];
            normals[m.triangle as usize][m.corner as usize] =
                normalized(mean).unwrap_or(face_normals[m.triangle as usize]);
        }
    }
    Ok(normals)
}

/// The corners at each vertex, of triangles with area: vertex v has `corners[starts[v]..starts[v + 1]]`.
fn corners_by_vertex(mesh: &Mesh, face_normals: &[Vec3]) -> Result<(Vec<usize>, Vec<Corner>)> {
    let with_area = || mesh.triangles().iter().enumerate().filter(|(t, _)| face_normals[*t] != [0.0; 3]);
    let mut starts = try_vec(mesh.vertices().len() + 1, 0_usize, "the corners by vertex")?;
    for &v in with_area().flat_map(|(_, vertices)| vertices) {
        starts[v as usize + 1] += 1;
    }
    for v in 0..mesh.vertices().len() {
        starts[v + 1] += starts[v];
    }
    let n_corners = starts[mesh.vertices().len()];
    let mut next = try_with_capacity(starts.len(), "the corners by vertex")?;
    next.extend_from_slice(&starts);
    let mut corners = try_vec(n_corners, Corner { triangle: 0, corner: 0 }, "the corners by vertex")?;
    for (t, vertices) in with_area() {
        for (corner, &v) in vertices.iter().enumerate() {
            corners[next[v as usize]] = Corner { triangle: t as u32, corner: corner as u32 };
            next[v as usize] += 1;
        }
    }
    Ok((starts, corners))
}

/// Scratch for the triangles around one vertex.
#[derive(Default)]
struct Fan {
    spokes: Vec<Spoke>,
    /// Union-find: a member's parent, itself at a group's root.
    parents: Vec<u32>,
    /// Sum of angle times unit normal, at a group's root.
    sums: Vec<Vec3>,
}

impl Fan {
    fn root(&self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            member = self.parents[member as usize];
        }
        member
    }

    /// Joins the members that share an edge which is not sharp.
    fn group(&mut self, mesh: &Mesh, face_normals: &[Vec3], members: &[Corner]) {
        self.spokes.clear();
        for (i, m) in members.iter().enumerate() {
            let t = mesh.triangles()[m.triangle as usize];
            let (next, previous) = (t[(m.corner as usize + 1) % 3], t[(m.corner as usize + 2) % 3]);
            self.spokes.push(Spoke { end: next, outgoing: true, member: i as u32 });
            self.spokes.push(Spoke { end: previous, outgoing: false, member: i as u32 });
        }
        self.spokes.sort_unstable();
        self.parents.clear();
        self.parents.extend(0..members.len() as u32);

        let cos_sharp = SHARP_EDGE_DEGREES.to_radians().cos();
        let normal = |s: Spoke| face_normals[members[s.member as usize].triangle as usize];
        let spokes = std::mem::take(&mut self.spokes);
        for edge in spokes.chunk_by(|a, b| a.end == b.end) {
            if let &[a, b] = edge
                && a.outgoing != b.outgoing
                && dot(normal(a), normal(b)) >= cos_sharp
            {
                let (root_a, root_b) = (self.root(a.member), self.root(b.member));
                self.parents[root_a.max(root_b) as usize] = root_a.min(root_b);
            }
        }
        self.spokes = spokes;
    }

    fn accumulate(&mut self, mesh: &Mesh, face_normals: &[Vec3], members: &[Corner]) {
        self.sums.clear();
        self.sums.resize(members.len(), [0.0; 3]);
        for (i, m) in members.iter().enumerate() {
            let corners = mesh.corners(m.triangle as usize);
            let [a, b, c] = std::array::from_fn(|k| corners[(m.corner as usize + k) % 3]);
            let root = self.root(i as u32) as usize;
            let weighted = scale(angle(sub(b, a), sub(c, a)), face_normals[m.triangle as usize]);
            self.sums[root] = add(self.sums[root], weighted);
        }
    }
}

/// The angle between two vectors, from tan: right for small angles too.
fn angle(a: Vec3, b: Vec3) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{box_mesh, sphere, torus};
    use super::*;

    #[test]
    fn cube_has_the_normals_of_its_faces_to_the_bit() {
        let cube = box_mesh([-1.0, 0.0, 2.0], [1.0, 0.3, 2.7]).unwrap();
        for (t, normals) in corner_normals(&cube).unwrap().iter().enumerate() {
            let face = normalized(cube.area_normal(t)).unwrap();
            assert_eq!(face.iter().map(|x| x.abs()).sum::<f64>(), 1.0);
            assert_eq!(*normals, [face; 3]);
        }
    }

    #[test]
    fn sphere_has_radial_normals_far_closer_than_its_faces() {
        let ball = sphere([0.0; 3], 1.0, 3).unwrap();
        let (mut worst_corner, mut worst_face) = (0.0_f64, 0.0_f64);
        for (t, normals) in corner_normals(&ball).unwrap().iter().enumerate() {
            let face = normalized(ball.area_normal(t)).unwrap();
            for (p, n) in ball.corners(t).iter().zip(normals) {
                worst_corner = worst_corner.max(angle(*p, *n));
                worst_face = worst_face.max(angle(*p, face));
            }
        }
        assert!(worst_corner < 0.1 * worst_face, "{worst_corner} {worst_face}");
    }

    #[test]
    fn boundaries_repeats_and_degenerate_triangles_are_served() {
        // A square, a third triangle on its diagonal, one of repeated vertices, one on a line, one turned over.
        let vertices =
            vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0], [2.0, 2.0, 0.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 2, 4], [1, 1, 2], [0, 2, 5], [1, 5, 2], [1, 5, 2]];
        let mesh = Mesh::new(vertices, triangles).unwrap();
        let normals = corner_normals(&mesh).unwrap();
        assert_eq!(normals[0], [[0.0, 0.0, 1.0]; 3]);
        assert_eq!(normals[3], [[0.0; 3]; 3]);
        assert_eq!(normals[4], [[0.0; 3]; 3]);
    }

    #[test]
    fn a_doubled_torus_keeps_its_sides_apart() {
        let ring = torus(3.0, 1.0, 24, 12).unwrap();
        let mut triangles = ring.triangles().to_vec();
        triangles.extend(ring.triangles().iter().map(|&[a, b, c]| [a, c, b]));
        let doubled = Mesh::new(ring.vertices().to_vec(), triangles).unwrap();
        for (t, normals) in corner_normals(&doubled).unwrap().iter().enumerate() {
            // Each edge has four triangles, so every corner keeps its face's normal.
            let face = normalized(doubled.area_normal(t)).unwrap();
            assert!(normals.iter().all(|n| dot(*n, face) > 1.0 - 1e-15));
        }
    }
}
