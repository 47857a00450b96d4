//! Normals at the corners of triangles, smooth over a smooth surface and broken along sharp edges.
//!
//! The triangles around a vertex fall into groups: two belong together when they share an edge that is used by exactly these
//! two, once in each direction, and their normals differ by at most [`SHARP_EDGE_DEGREES`]. A corner's normal is the mean of
//! its group's unit normals, weighted by the angles at the vertex (Thuermer and Wuethrich, "Computing vertex normals from
//! polygonal facets", 1998). A fan of a cone can add up to more than that angle: only neighbours are compared.

use super::Mesh;
use super::edges::{Edges, Sets};
use super::vec::{Vec3, add, cross, dot, norm, normalized, scale, sub};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// An edge is sharp where its two triangles' normals differ by more than this.
pub const SHARP_EDGE_DEGREES: f64 = 40.0;

/// Unit normals of the three corners of every triangle [T x 3 x 3]. A triangle without area has zeros, and takes no part.
pub fn corner_normals(mesh: &Mesh) -> Result<Vec<[Vec3; 3]>> {
    let n_triangles = mesh.triangles().len();
    let mut face_normals = try_with_capacity(n_triangles, "the face normals")?;
    face_normals.extend((0..n_triangles).map(|t| normalized(mesh.area_normal(t)).unwrap_or_default()));

    let mut groups = smooth_groups(mesh, &face_normals)?;
    let mut sums = try_vec(n_triangles, [[0.0; 3]; 3], "the corner normals")?;
    for (t, normal) in face_normals.iter().enumerate() {
        let corners = mesh.corners(t);
        for k in 0..3 {
            let [a, b, c] = std::array::from_fn(|i| corners[(k + i) % 3]);
            let group = groups.find(3 * t + k);
            let sum = &mut sums.as_flattened_mut()[group];
            *sum = add(*sum, scale(angle(sub(b, a), sub(c, a)), *normal));
        }
    }
    let mut normals = try_vec(n_triangles, [[0.0; 3]; 3], "the corner normals")?;
    for (corner, normal) in normals.as_flattened_mut().iter_mut().enumerate() {
        let mean = sums.as_flattened()[groups.find(corner)];
        *normal = normalized(mean).unwrap_or(face_normals[corner / 3]);
    }
    Ok(normals)
}

/// The corners, numbered 3 t + k, joined around each vertex across edges that are not sharp.
fn smooth_groups(mesh: &Mesh, face_normals: &[Vec3]) -> Result<Sets> {
    let cos_sharp = SHARP_EDGE_DEGREES.to_radians().cos();
    let mut groups = Sets::new(3 * face_normals.len())?;
    for sides in Edges::of(mesh.triangles(), mesh.vertices().len())?.iter() {
        let mut with_area = sides.iter().filter(|side| face_normals[side.triangle()] != [0.0; 3]);
        if let (Some(a), Some(b), None) = (with_area.next(), with_area.next(), with_area.next())
            && a.forward != b.forward
            && dot(face_normals[a.triangle()], face_normals[b.triangle()]) >= cos_sharp
        {
            let (a, b) = (a.corners(), b.corners());
            groups.join(a[0], b[0]);
            groups.join(a[1], b[1]);
        }
    }
    Ok(groups)
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
