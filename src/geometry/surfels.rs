//! Surfels: a cloud as a mesh of small triangles, one a point, which tells sides away from the surface by its winding number.
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

/// A surfel's circumradius at most, in distances to the second of the nearest: on a strip one point wide the k-th is far along the strip.
const WIDEST: f64 = 1.5;

impl Cloud {
    /// The cloud's surfels; `tree` holds its points. Coordinates must be of a size whose squares are finite and not 0: of about 1, say.
    pub fn surfels(&self, tree: &Neighbours) -> Result<Mesh> {
        let n = self.len();
        let mut vertices = try_with_capacity(3 * n, "the surfels")?;
        let mut triangles = try_with_capacity(n, "the surfels")?;
        for (i, (p, normal)) in self.points().iter().zip(self.normals()).enumerate() {
            let radius = self.radius_of(i, tree);
            vertices.extend(corners(*normal).map(|c| add(*p, scale(radius, c))));
            let first = 3 * i as u32;
            triangles.push([first, first + 1, first + 2]);
        }
        Mesh::new(vertices, triangles)
    }

    /// Circumradius of the surfel of point `i`; 0 when no other point faces the same way.
    fn radius_of(&self, i: usize, tree: &Neighbours) -> f64 {
        let faces_along = |j: usize| j != i && dot(self.normals()[i], self.normals()[j]) > 0.0;
        let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; NEIGHBOURS];
        let k = tree.nearest(self.points()[i], faces_along, &mut nearest);
        if k == 0 {
            return 0.0;
        }
        let area = std::f64::consts::PI * nearest[k - 1].distance_squared / k as f64;
        // An equilateral triangle of circumradius r has the area 3 sqrt(3) / 4 r^2.
        let radius = (area / (0.75 * 3f64.sqrt())).sqrt();
        radius.min(WIDEST * nearest[1.min(k - 1)].distance_squared.sqrt())
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
        let surfels = cloud.surfels(&Neighbours::new(cloud.points()).unwrap()).unwrap();
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
    fn sides_away_from_the_surface_are_those_of_the_shape() {
        let thin = box_mesh([-1.0, -1.0, -0.01], [1.0, 1.0, 0.01]).unwrap();
        for mesh in [thin, torus(0.7, 0.25, 60, 30).unwrap(), sphere([0.1; 3], 0.8, 4).unwrap()] {
            let cloud = mesh.sample(5000, 1).unwrap();
            let surfels = cloud.surfels(&Neighbours::new(cloud.points()).unwrap()).unwrap();
            let tree = surfels.distance_tree().unwrap();
            let mut random = super::super::random::SplitMix64::new(2);
            let points: Vec<Vec3> = (0..2000).map(|_| std::array::from_fn(|_| random.between(-1.3, 1.3))).collect();
            let mut exact = vec![0.0; 2000];
            mesh.distance_tree().unwrap().signed_distances(&points, &mut exact).unwrap();
            for (p, d) in points.iter().zip(&exact).filter(|(_, d)| d.abs() > 0.1) {
                let (w, expected) = (tree.winding_number(*p), if *d < 0.0 { 1.0 } else { 0.0 });
                assert!((w - expected).abs() < 0.4, "{p:?}: {w} at distance {d}");
            }
        }
    }
}
