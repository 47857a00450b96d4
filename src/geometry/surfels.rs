//! Surfels: a cloud as a mesh of small facets, one a point, which tells sides away from the surface by its winding number.
//!
//! Each facet, an equilateral triangle or a segment, lies in the plane of its point's normal and has the area that the point stands for.
//! The winding number of a cloud is that of its surfels (Barill et al. 2018).
//!
//! The area is that of the point's Voronoi cell among the nearest points that face the same way, seen in the plane: cells fill a surface
//! without gaps however its points lie, evenly, in rows or at random. What a fixed number of points spread over does not: of random ones it
//! tells two thirds. Cells end at the box that has the points' moments, along their principal axes, so they are right at the rims of faces
//! too, and in strips one point wide, the edges of thin plates.

use super::neighbours::{Neighbour, Neighbours};
use super::vec::{Vec3, add, cross, dot, normalized, scale, sub};
use super::{Cloud, Mesh};
use crate::Result;
use crate::error::try_with_capacity;

/// Points that a point's area is taken from, itself among them: with fewer some random points have no neighbour on one side, and their cell
/// ends at the box.
const fn points<const D: usize>() -> usize {
    if D == 2 { 9 } else { MOST_POINTS }
}
const MOST_POINTS: usize = 16;

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

    /// The nearest points that face the way of point `i`, itself among them, into `nearest`; gives how many there are.
    pub(super) fn facing_along<'a>(
        &self,
        i: usize,
        tree: &Neighbours<D>,
        nearest: &'a mut Facing,
    ) -> impl ExactSizeIterator<Item = usize> + Clone + use<'a, D> {
        let faces_along = |j: usize| dot(self.normals()[i], self.normals()[j]) > 0.0;
        let k = tree.nearest(self.points()[i], faces_along, &mut nearest[..points::<D>()]);
        nearest[..k].iter().map(|n| n.index as usize)
    }

    /// The area that point `i` stands for, with the unit vectors that span its plane first in `tangents`; 0 when all that face its way lie
    /// on a line.
    fn area_of(&self, i: usize, tangents: &[[f64; D]; D], tree: &Neighbours<D>) -> f64 {
        let mut nearest = NONE_FACING;
        let mut in_plane = [[0.0; 2]; MOST_POINTS];
        let mut k = 0;
        for j in self.facing_along(i, tree, &mut nearest) {
            let r = sub(self.points()[j], self.points()[i]);
            in_plane[k] = [0, 1].map(|a| if a < D - 1 { dot(r, tangents[a]) } else { 0.0 });
            k += 1;
        }
        if D == 2 { cell_length(&in_plane[..k]) } else { cell_area(&in_plane[..k]) }
    }
}

/// Room for the nearest points that face one way.
pub(super) type Facing = [Neighbour; MOST_POINTS];
pub(super) const NONE_FACING: Facing = [Neighbour { index: 0, distance_squared: 0.0 }; MOST_POINTS];

/// The length of the cell around 0 among `points`, 0 among them, of which the first coordinate counts.
fn cell_length(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = points.iter().map(|p| p[0]).sum::<f64>() / n;
    let half = (3.0 * points.iter().map(|p| (p[0] - mean).powi(2)).sum::<f64>() / n).sqrt();
    let (mut low, mut high, mut copies) = (mean - half, mean + half, 0.0);
    for [x, _] in points {
        match *x {
            x if x > 0.0 => high = high.min(0.5 * x),
            x if x < 0.0 => low = low.max(0.5 * x),
            _ => copies += 1.0,
        }
    }
    (high - low).max(0.0) / f64::max(copies, 1.0)
}

/// The area of the cell around 0 among `points`, 0 among them.
fn cell_area(points: &[[f64; 2]]) -> f64 {
    let mut cell = Polygon::with_moments_of(points);
    let mut copies = 0.0;
    for r in points {
        if *r == [0.0; 2] {
            copies += 1.0;
        } else {
            cell.keep_nearer_to_0_than_to(*r);
        }
    }
    cell.area() / f64::max(copies, 1.0)
}

/// A convex polygon; each cut adds a corner at most.
struct Polygon {
    corners: [[f64; 2]; 4 + MOST_POINTS],
    len: usize,
}

impl Polygon {
    /// The box whose mean and covariance are those of `points`.
    fn with_moments_of(points: &[[f64; 2]]) -> Self {
        let n = points.len() as f64;
        let mean = |f: &dyn Fn([f64; 2]) -> f64| points.iter().map(|p| f(*p)).sum::<f64>() / n;
        let [x, y] = [mean(&|[x, _]| x), mean(&|[_, y]| y)];
        let [xx, yy] = [mean(&|p| (p[0] - x) * (p[0] - x)), mean(&|p| (p[1] - y) * (p[1] - y))];
        let xy = mean(&|p| (p[0] - x) * (p[1] - y));
        let (middle, off) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
        // A box of half edge h has the variance h^2 / 3.
        let [long, short] = [middle + off, middle - off].map(|variance| (3.0 * variance.max(0.0)).sqrt());
        let mut corners = [[0.0; 2]; 4 + MOST_POINTS];
        for (corner, [s, t]) in corners.iter_mut().zip([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) {
            let (a, b) = (s * long, t * short);
            *corner = [x + a * cos - b * sin, y + a * sin + b * cos];
        }
        Polygon { corners, len: 4 }
    }

    /// Cuts off what is nearer to `r` than to 0.
    fn keep_nearer_to_0_than_to(&mut self, r: [f64; 2]) {
        let beyond = |p: [f64; 2]| dot(p, r) - 0.5 * dot(r, r);
        let (old, n) = (self.corners, self.len);
        self.len = 0;
        for (k, &p) in old[..n].iter().enumerate() {
            let q = old[(k + 1) % n];
            let (at_p, at_q) = (beyond(p), beyond(q));
            if at_p <= 0.0 {
                self.push(p);
            }
            if (at_p <= 0.0) != (at_q <= 0.0) {
                let t = at_p / (at_p - at_q);
                self.push(add(p, scale(t, sub(q, p))));
            }
        }
    }

    fn push(&mut self, p: [f64; 2]) {
        // More corners than a convex polygon can have are those of one that is a line but for rounding.
        if let Some(corner) = self.corners.get_mut(self.len) {
            *corner = p;
            self.len += 1;
        }
    }

    fn area(&self) -> f64 {
        let corners = &self.corners[..self.len];
        let next = corners.iter().cycle().skip(1);
        0.5 * corners.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>().abs()
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

    #[test]
    fn cells_have_their_area_between_even_neighbours_and_share_it_with_copies() {
        let grid: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i % 3 - 1), 2.0 * f64::from(i / 3 - 1)]).collect();
        assert!((cell_area(&grid) - 2.0).abs() < 1e-14);
        let mut twice = grid.clone();
        twice.push([0.0; 2]);
        assert!((cell_area(&twice) - 1.0).abs() < 1e-14);
        assert!((cell_length(&grid) - 1.0 / 3.0).abs() < 1e-14, "three of each along the line");
        // A strip about 0.17 wide, that of the box with its points' moments.
        let strip: Vec<[f64; 2]> = (-4..=4).map(|i| [f64::from(i), if i % 2 == 0 { 0.0 } else { 0.1 }]).collect();
        let area = cell_area(&strip);
        assert!((0.1..0.2).contains(&area), "{area}");
        for few in [&[[0.0; 2]][..], &[[0.0; 2], [1.0, 0.0]]] {
            assert_eq!(cell_area(few), 0.0);
        }
        assert_eq!(cell_length(&[[0.0; 2]]), 0.0);
    }

    #[test]
    fn areas_of_random_points_add_up_too() {
        let ball = super::super::shapes::scattered::sphere(3000, 1);
        let surfels = ball.surfels(&Neighbours::new(ball.points()).unwrap()).unwrap();
        let ratio = surfels.report().unwrap().area / (4.0 * std::f64::consts::PI);
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        let ring = super::super::shapes::scattered::circle(300, 1);
        let surfels = ring.surfels(&Neighbours::new(ring.points()).unwrap()).unwrap();
        let ratio = surfels.report().unwrap().area / std::f64::consts::TAU;
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
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
