//! Surfels: a cloud as a mesh of small triangles, one a point, which tells sides away from the surface by its winding number.
//!
//! Each triangle is equilateral, lies in the plane of its point's normal and has the area that the point stands for. The winding number
//! of a cloud is that of its surfels (Barill et al. 2018).
//!
//! The area is that of an ellipse with the covariance C of the nearest points that face the same way, seen in the plane, divided among
//! them: 4 pi sqrt(det C) / k. Unlike pi r^2 / k with r the distance to the k-th, it is right for strips one point wide too: the edges of
//! thin plates.

use super::neighbours::{Neighbour, Neighbours};
use super::vec3::{Vec3, add, cross, dot, normalized, scale, sub};
use super::{Cloud, Mesh};
use crate::Result;
use crate::error::try_with_capacity;

/// k: points that a point's area is taken from, itself among them.
const POINTS: usize = 9;

impl Cloud {
    /// The cloud's surfels; `tree` holds its points. Coordinates must be of a size whose squares are finite and not 0: of about 1, say.
    pub fn surfels(&self, tree: &Neighbours) -> Result<Mesh> {
        let n = self.len();
        let mut vertices = try_with_capacity(3 * n, "the surfels")?;
        let mut triangles = try_with_capacity(n, "the surfels")?;
        for (i, (p, normal)) in self.points().iter().zip(self.normals()).enumerate() {
            let [u, v] = tangents(*normal);
            // An equilateral triangle of circumradius r has the area 3 sqrt(3) / 4 r^2.
            let radius = (self.area_of(i, [u, v], tree) / (0.75 * 3f64.sqrt())).sqrt();
            vertices.extend(CORNERS.map(|[a, b]| add(*p, add(scale(radius * a, u), scale(radius * b, v)))));
            let first = 3 * i as u32;
            triangles.push([first, first + 1, first + 2]);
        }
        Mesh::new(vertices, triangles)
    }

    /// The area that point `i` stands for, with unit vectors that span its plane; 0 when all that face its way lie on a line.
    fn area_of(&self, i: usize, tangents: [Vec3; 2], tree: &Neighbours) -> f64 {
        let faces_along = |j: usize| dot(self.normals()[i], self.normals()[j]) > 0.0;
        let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; POINTS];
        let k = tree.nearest(self.points()[i], faces_along, &mut nearest);
        let in_plane = nearest[..k].iter().map(|n| {
            let r = sub(self.points()[n.index as usize], self.points()[i]);
            tangents.map(|t| dot(r, t))
        });
        let n = k as f64;
        let mean = |f: &dyn Fn([f64; 2]) -> f64| in_plane.clone().map(f).sum::<f64>() / n;
        let [a, b] = [mean(&|[a, _]| a), mean(&|[_, b]| b)];
        let [aa, bb] = [mean(&|[x, _]| (x - a) * (x - a)), mean(&|[_, y]| (y - b) * (y - b))];
        let ab = mean(&|[x, y]| (x - a) * (y - b));
        4.0 * std::f64::consts::PI * (aa * bb - ab * ab).max(0.0).sqrt() / n
    }
}

/// Corners of an equilateral triangle of circumradius 1, counter-clockwise.
const CORNERS: [[f64; 2]; 3] = [[1.0, 0.0], [-0.5, HALF_ROOT_3], [-0.5, -HALF_ROOT_3]];
const HALF_ROOT_3: f64 = 0.866_025_403_784_438_6;

/// Two unit vectors u, v with u x v = n.
fn tangents(n: Vec3) -> [Vec3; 2] {
    // The axis least along n is far from parallel to it.
    let least = (0..3).fold(0, |least, a| if n[a].abs() < n[least].abs() { a } else { least });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = normalized(cross(n, axis)).unwrap_or(axis);
    [u, cross(n, u)]
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{box_mesh, sphere, torus};
    use super::super::vec3::norm;
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
                assert!((w - expected).abs() < 0.2, "{p:?}: {w} at distance {d}");
            }
        }
    }
}
