//! Surfels: a cloud as a mesh of small triangles, one a point, which answers distances and sides away from the surface.
//!
//! Each triangle is equilateral, lies in the plane of its point's normal and has the area that the point stands for: pi r^2 / k, r the distance
//! to the k-th of the nearest points that face the same way. A cloud's winding number is that of its surfels (Barill et al. 2018).

use super::neighbours::{Neighbour, Neighbours};
use super::vec3::{Vec3, add, cross, dot, norm, normalized, scale};
use super::{Cloud, Mesh};
use crate::Result;
use crate::error::try_with_capacity;

/// k: neighbours that a point's area is taken from.
const NEIGHBOURS: usize = 8;

impl Cloud {
    /// The cloud's surfels. Coordinates must be of a size whose squares are finite and not 0: of about 1, say.
    pub fn surfels(&self) -> Result<Mesh> {
        let n = self.len();
        let tree = Neighbours::new(self.points())?;
        let mut vertices = try_with_capacity(3 * n, "the surfels")?;
        let mut triangles = try_with_capacity(n, "the surfels")?;
        for (i, (p, normal)) in self.points().iter().zip(self.normals()).enumerate() {
            let area = self.area_of(i, &tree);
            // An equilateral triangle of circumradius r has the area 3 sqrt(3) / 4 r^2.
            let radius = (area / (0.75 * 3f64.sqrt())).sqrt();
            vertices.extend(corners(*normal).map(|c| add(*p, scale(radius, c))));
            let first = 3 * i as u32;
            triangles.push([first, first + 1, first + 2]);
        }
        Mesh::new(vertices, triangles)
    }

    /// The area that point `i` stands for; 0 when no other faces the same way.
    fn area_of(&self, i: usize, tree: &Neighbours) -> f64 {
        let faces_along = |j: usize| j != i && dot(self.normals()[i], self.normals()[j]) > 0.0;
        let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; NEIGHBOURS];
        match tree.nearest(self.points()[i], faces_along, &mut nearest) {
            0 => 0.0,
            k => std::f64::consts::PI * nearest[k - 1].distance_squared / k as f64,
        }
    }
}

/// Corners of an equilateral triangle of circumradius 1 around 0, counter-clockwise about `n`.
fn corners(n: Vec3) -> [Vec3; 3] {
    // The axis least along n is far from parallel to it.
    let least = (0..3).fold(0, |least, a| if n[a].abs() < n[least].abs() { a } else { least });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = normalized(cross(n, axis)).unwrap_or(axis);
    let v = cross(n, u);
    debug_assert!((norm(v) - 1.0).abs() < 1e-12);
    let half = 3f64.sqrt() / 2.0;
    [u, add(scale(-0.5, u), scale(half, v)), add(scale(-0.5, u), scale(-half, v))]
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{box_mesh, sphere, torus};
    use super::super::vec3::sub;
    use super::*;

    #[test]
    fn surfels_have_their_points_normals_and_together_about_the_area() {
        let ball = sphere([0.0; 3], 1.0, 4).unwrap();
        let cloud = ball.sample(2000, 1).unwrap();
        let surfels = cloud.surfels().unwrap();
        let mut area = 0.0;
        for (t, (p, n)) in cloud.points().iter().zip(cloud.normals()).enumerate() {
            let [a, b, c] = surfels.corners(t);
            assert!(norm(sub(scale(1.0 / 3.0, add(add(a, b), c)), *p)) < 1e-15);
            assert!(norm(sub(normalized(surfels.area_normal(t)).unwrap(), *n)) < 1e-12);
            area += 0.5 * norm(surfels.area_normal(t));
        }
        assert!((area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.1, "{area}");
    }

    #[test]
    fn sides_and_distances_away_from_the_surface_are_those_of_the_shape() {
        let thin = box_mesh([-1.0, -1.0, -0.01], [1.0, 1.0, 0.01]).unwrap();
        for mesh in [thin, torus(0.7, 0.25, 60, 30).unwrap(), sphere([0.1; 3], 0.8, 4).unwrap()] {
            let surfels = mesh.sample(5000, 1).unwrap().surfels().unwrap();
            let mut random = super::super::random::SplitMix64::new(2);
            let points: Vec<Vec3> = (0..2000).map(|_| std::array::from_fn(|_| random.between(-1.3, 1.3))).collect();
            let (mut exact, mut ours) = (vec![0.0; 2000], vec![0.0; 2000]);
            mesh.distance_tree().unwrap().signed_distances(&points, &mut exact).unwrap();
            surfels.distance_tree().unwrap().signed_distances(&points, &mut ours).unwrap();
            for ((p, e), o) in points.iter().zip(&exact).zip(&ours).filter(|((_, e), _)| e.abs() > 0.1) {
                assert!((e - o).abs() < 0.01, "{p:?}: {o} for {e}");
            }
        }
    }
}
