//! Surfels: a cloud as a mesh of small facets, one a point, which tells sides away from the surface by its winding number.
//!
//! Each facet, an equilateral triangle or a segment, lies in the plane of its point's normal and has the area that the point stands for.
//! The winding number of a cloud is that of its surfels (Barill et al. 2018).
//!
//! The area comes from the covariance C of the nearest points that face the same way, seen in the plane, divided among them. In space it
//! is that of an ellipse: 4 pi sqrt(det C) / k. Unlike pi r^2 / k with r the distance to the k-th, it is right for strips one point wide
//! too: the edges of thin plates. In the plane it is the spacing of even points: sqrt(12 C / (k^2 - 1)).

use super::neighbours::{Neighbour, Neighbours};
use super::vec::{Vec3, add, cross, dot, normalized, scale, sub};
use super::{Cloud, Mesh};
use crate::Result;
use crate::error::try_with_capacity;
use std::f64::consts::PI;

/// k: points that a point's area is taken from, itself among them.
const fn points<const D: usize>() -> usize {
    if D == 2 { 5 } else { MOST_POINTS }
}
const MOST_POINTS: usize = 9;

impl<const D: usize> Cloud<D> {
    /// The cloud's surfels; `tree` holds its points. Coordinates must be of a size whose squares are finite and not 0: of about 1, say.
    pub fn surfels(&self, tree: &Neighbours<D>) -> Result<Mesh<D>> {
        let n = self.len();
        let mut vertices = try_with_capacity(D * n, "the surfels")?;
        let mut facets = try_with_capacity(n, "the surfels")?;
        for (i, (p, normal)) in self.points().iter().zip(self.normals()).enumerate() {
            let tangents = tangents(*normal);
            let radius = radius_of::<D>(self.area_of(i, &tangents, tree));
            vertices.extend(corners::<D>().map(|c| {
                // The last coordinate lies along the normal: 0.
                let along = |p, k: usize| add(p, scale(radius * c[k], tangents[k]));
                (0..D - 1).fold(*p, along)
            }));
            let first = (D * i) as u32;
            facets.push(std::array::from_fn(|k| first + k as u32));
        }
        Mesh::new(vertices, facets)
    }

    /// The area that point `i` stands for, with the unit vectors that span its plane first in `tangents`; 0 when all that face its way lie
    /// on a line.
    fn area_of(&self, i: usize, tangents: &[[f64; D]; D], tree: &Neighbours<D>) -> f64 {
        let faces_along = |j: usize| dot(self.normals()[i], self.normals()[j]) > 0.0;
        let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; MOST_POINTS];
        let k = tree.nearest(self.points()[i], faces_along, &mut nearest[..points::<D>()]);
        let in_plane = nearest[..k].iter().map(|n| {
            let r = sub(self.points()[n.index as usize], self.points()[i]);
            [0, 1].map(|a| if a < D - 1 { dot(r, tangents[a]) } else { 0.0 })
        });
        let n = k as f64;
        let mean = |f: &dyn Fn([f64; 2]) -> f64| in_plane.clone().map(f).sum::<f64>() / n;
        let [a, b] = [mean(&|[a, _]| a), mean(&|[_, b]| b)];
        let aa = mean(&|[x, _]| (x - a) * (x - a));
        if D == 2 {
            return (12.0 * aa / (n * n - 1.0).max(1.0)).sqrt();
        }
        let (bb, ab) = (mean(&|[_, y]| (y - b) * (y - b)), mean(&|[x, y]| (x - a) * (y - b)));
        4.0 * PI * (aa * bb - ab * ab).max(0.0).sqrt() / n
    }
}

/// Circumradius of the facet of this area: half a segment; an equilateral triangle of circumradius r has the area 3 sqrt(3) / 4 r^2.
fn radius_of<const D: usize>(area: f64) -> f64 {
    if D == 2 { 0.5 * area } else { (area / (0.75 * 3f64.sqrt())).sqrt() }
}

/// Corners of a facet of circumradius 1 along its tangents, in the order that makes its normal the point's.
fn corners<const D: usize>() -> [[f64; D]; D] {
    const HALF_ROOT_3: f64 = 0.866_025_403_784_438_6;
    const TRIANGLE: [[f64; 2]; 3] = [[1.0, 0.0], [-0.5, HALF_ROOT_3], [-0.5, -HALF_ROOT_3]];
    std::array::from_fn(|corner| {
        std::array::from_fn(|k| match (D, k) {
            (2, 0) => [-1.0, 1.0][corner],
            (3, 0 | 1) => TRIANGLE[corner][k],
            _ => 0.0,
        })
    })
}

/// Unit vectors that span the plane of `n`, and `n` last: in space u x v = n, in the plane n lies to the right of u.
pub(crate) fn tangents<const D: usize>(n: [f64; D]) -> [[f64; D]; D] {
    if D == 2 {
        return std::array::from_fn(|row| if row == 0 { std::array::from_fn(|k| [-n[1], n[0]][k]) } else { n });
    }
    let m: Vec3 = std::array::from_fn(|k| n[k]);
    // The axis least along n is far from parallel to it.
    let least = (0..3).fold(0, |least, a| if m[a].abs() < m[least].abs() { a } else { least });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = normalized(cross(m, axis)).unwrap_or(axis);
    let v = cross(m, u);
    std::array::from_fn(|row| std::array::from_fn(|k| [u, v, m][row][k]))
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{box_mesh, circle, rectangle, sphere, torus};
    use super::super::vec::norm;
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

    /// An ellipse of half axes 1 and `b`, with `n` segments.
    fn ellipse(b: f64, n: usize) -> Mesh<2> {
        let ring = circle([0.0; 2], 1.0, n).unwrap();
        Mesh::new(ring.vertices().iter().map(|&[x, y]| [x, b * y]).collect(), ring.segments().to_vec()).unwrap()
    }

    #[test]
    fn surfels_of_the_plane_have_their_points_normals_and_together_the_length() {
        let curve = ellipse(0.5, 500);
        let cloud = curve.sample(300, 1).unwrap();
        let surfels = cloud.surfels(&Neighbours::new(cloud.points()).unwrap()).unwrap();
        for (s, (p, n)) in cloud.points().iter().zip(cloud.normals()).enumerate() {
            let [a, b] = surfels.corners(s);
            assert!(norm(sub(scale(0.5, add(a, b)), *p)) < 1e-15);
            assert!(norm(sub(normalized(surfels.area_normal(s)).unwrap(), *n)) < 1e-12);
        }
        let ratio = surfels.report().unwrap().area / curve.report().unwrap().area;
        assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    }

    #[test]
    fn sides_away_from_a_curve_are_those_of_the_shape() {
        for curve in [ellipse(0.01, 2000), ellipse(0.5, 200), rectangle([-1.0, -0.02], [1.0, 0.02]).unwrap()] {
            for n in [100, 1000] {
                let cloud = curve.sample(n, 1).unwrap();
                let surfels = cloud.surfels(&Neighbours::new(cloud.points()).unwrap()).unwrap();
                let tree = surfels.distance_tree().unwrap();
                let mut random = super::super::random::SplitMix64::new(2);
                let points: Vec<[f64; 2]> =
                    (0..2000).map(|_| std::array::from_fn(|_| random.between(-1.3, 1.3))).collect();
                let mut exact = vec![0.0; 2000];
                curve.distance_tree().unwrap().signed_distances(&points, &mut exact).unwrap();
                for (p, d) in points.iter().zip(&exact).filter(|(_, d)| d.abs() > 0.05) {
                    let (w, expected) = (tree.winding_number(*p), if *d < 0.0 { 1.0 } else { 0.0 });
                    assert!((w - expected).abs() < 0.2, "{n} {p:?}: {w} at distance {d}");
                }
            }
        }
    }
}
