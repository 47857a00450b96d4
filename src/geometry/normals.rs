//! Normals at the corners of facets, smooth over a smooth shape and broken along sharp edges, at sharp vertices in the plane.
//!
//! The facets around a vertex fall into groups: two belong together when they share an edge that is used by exactly these
//! two, once in each direction, and their normals differ by at most [`SHARP_EDGE_DEGREES`]. A corner's normal is the mean of
//! its group's unit normals. In space each weighs its angle at the vertex (Thuermer and Wuethrich, "Computing vertex normals from
//! polygonal facets", 1998). A fan of a cone can add up to more than that angle: only neighbours are compared. In the plane each weighs
//! its inverse length: a chord has the normal of its arc's middle, to the second order, and between two middles this interpolates to the
//! vertex, so uneven segments keep the second order.

use super::edges::{Edges, Sets};
use super::vec::{Vec3, add, cross, dot, norm, normalized, scale, sub};
use super::{Mesh, facet};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// An edge is sharp where its two facets' normals differ by more than this.
pub const SHARP_EDGE_DEGREES: f64 = 40.0;

/// Unit normals of the corners of every facet [F x D x D]. A facet without area has zeros, and takes no part.
pub fn corner_normals<const D: usize>(mesh: &Mesh<D>) -> Result<Vec<[[f64; D]; D]>> {
    Ok(CornerNormals::of(mesh)?.normals)
}

/// The corners' normals, with what they were made of.
pub(super) struct CornerNormals<const D: usize> {
    /// Unit normals of the facets [F x D], zeros where one has no area.
    pub faces: Vec<[f64; D]>,
    /// Groups of corners.
    pub groups: Sets,
    /// What [`corner_normals`] gives.
    pub normals: Vec<[[f64; D]; D]>,
    /// Of each group, at its first corner, the sum of its facets' normals, each times what it weighs [F x D x D].
    pub sums: Vec<[[f64; D]; D]>,
}

impl<const D: usize> CornerNormals<D> {
    /// Those of `mesh`.
    pub fn of(mesh: &Mesh<D>) -> Result<Self> {
        let n_facets = mesh.facets().len();
        let mut faces = try_with_capacity(n_facets, "the face normals")?;
        faces.extend((0..n_facets).map(|f| normalized(mesh.area_normal(f)).unwrap_or([0.0; D])));

        let mut groups = smooth_groups(mesh, &faces)?;
        let mut sums = try_vec(n_facets, [[0.0; D]; D], "the corner normals")?;
        for (f, normal) in faces.iter().enumerate() {
            let corners = mesh.corners(f);
            for k in 0..D {
                let group = groups.find(D * f + k);
                let sum = &mut sums.as_flattened_mut()[group];
                *sum = add(*sum, scale(weight(&corners, k), *normal));
            }
        }
        let mut normals = try_vec(n_facets, [[0.0; D]; D], "the corner normals")?;
        for (corner, normal) in normals.as_flattened_mut().iter_mut().enumerate() {
            let mean = sums.as_flattened()[groups.find(corner)];
            *normal = normalized(mean).unwrap_or(faces[corner / D]);
        }
        Ok(CornerNormals { faces, groups, normals, sums })
    }
}

/// The corners, numbered D f + k, joined around each vertex across edges that are not sharp.
fn smooth_groups<const D: usize>(mesh: &Mesh<D>, face_normals: &[[f64; D]]) -> Result<Sets> {
    let cos_sharp = SHARP_EDGE_DEGREES.to_radians().cos();
    let mut groups = Sets::new(D * face_normals.len())?;
    for sides in Edges::of(mesh.facets(), mesh.vertices().len())?.iter() {
        let mut with_area = sides.iter().filter(|side| face_normals[side.facet()] != [0.0; D]);
        if let (Some(a), Some(b), None) = (with_area.next(), with_area.next(), with_area.next())
            && a.forward != b.forward
            && dot(face_normals[a.facet()], face_normals[b.facet()]) >= cos_sharp
        {
            let (a, b) = (a.corners(), b.corners());
            groups.join(a[0], b[0]);
            groups.join(a[1], b[1]);
        }
    }
    Ok(groups)
}

/// What a facet's normal weighs at its corner k: the angle there, the inverse length of a segment. A segment whose length vanishes weighs
/// infinitely; no mean comes of that, and its neighbours keep their own normals.
pub(super) fn weight<const D: usize>(corners: &[[f64; D]; D], k: usize) -> f64 {
    match D {
        2 => 1.0 / facet::area(corners),
        _ => {
            let [a, b, c] = [0, 1, 2].map(|i| facet::cut(corners[(k + i) % D]));
            angle(sub(b, a), sub(c, a))
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

    /// Largest angle between the corner normals and `exact`, of a closed curve through `vertices`.
    fn worst_angle(vertices: Vec<[f64; 2]>, exact: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
        let n = vertices.len() as u32;
        let curve = Mesh::new(vertices, (0..n).map(|i| [i, (i + 1) % n]).collect()).unwrap();
        let mut worst = 0.0_f64;
        for (f, normals) in corner_normals(&curve).unwrap().iter().enumerate() {
            for (p, n) in curve.corners(f).iter().zip(normals) {
                worst = worst.max(norm(sub(normalized(exact(*p)).unwrap(), *n)));
            }
        }
        worst
    }

    #[test]
    fn normals_of_uneven_curves_are_of_the_second_order() {
        // Segments of length one and three in turn, on a circle and on an ellipse of axes 2 and 1.
        let at = |n: u32, i: u32| (f64::from(i / 2 * 4 + i % 2) * std::f64::consts::TAU / f64::from(2 * n)).sin_cos();
        let circle = |n: u32| worst_angle((0..n).map(|i| [at(n, i).1, at(n, i).0]).collect(), |p| p);
        let ellipse =
            |n: u32| worst_angle((0..n).map(|i| [2.0 * at(n, i).1, at(n, i).0]).collect(), |[x, y]| [0.25 * x, y]);
        // On a circle the interpolation is exact; equal weights err by 0.016 with 100 segments, lengths by 0.031.
        assert!(circle(100) < 1e-13, "{}", circle(100));
        let (coarse, fine) = (ellipse(100), ellipse(200));
        assert!(coarse < 1.6e-3 && coarse / fine > 3.8, "{coarse} {fine}");
    }

    #[test]
    fn corners_of_a_rectangle_keep_both_normals() {
        let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let curve = Mesh::new(corners, vec![[0, 1], [1, 2], [2, 3], [3, 0], [1, 1]]).unwrap();
        let normals = corner_normals(&curve).unwrap();
        let expected = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];
        assert_eq!(normals, expected.map(|n| [n; 2]));
    }

    #[test]
    fn a_segment_too_short_to_weigh_leaves_its_neighbours_their_normals() {
        let curve =
            Mesh::new(vec![[-1.0, 0.0], [0.0, 0.0], [1e-170, 1e-172], [1.0, 0.1]], vec![[0, 1], [1, 2], [2, 3]])
                .unwrap();
        let normals = corner_normals(&curve).unwrap();
        assert_eq!(normals[0], [[0.0, -1.0]; 2]);
        assert!(normals.as_flattened().iter().all(|n| (norm(*n) - 1.0).abs() < 1e-15));
    }
}
