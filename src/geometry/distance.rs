//! Exact distance from points to a mesh, and the side they lie on.
//!
//! The closest point comes from a depth-first search of the tree of boxes, the nearer child first, boxes farther than the best
//! point skipped. The side comes from the generalised winding number (`winding.rs`), so open meshes have sides too,
//! inside where the mesh takes up half of what one sees or more: a flat sheet has no inside.

use super::bvh::{Bvh, STACK_SIZE};
use super::facet::{self, Closest, closest};
use super::morton::along_z_curve;
use super::unit::Unit;
use super::vec::{is_finite, scale, text};
use super::winding::{Side, Winding};
use super::{Bounds, Mesh};
use crate::error::try_with_capacity;
use crate::{Error, Result};

mod half_space;
mod solid;

pub(crate) use half_space::HalfSpace;

/// From this many sizes on, a mesh is a point to within rounding, and queries are pulled in lest their squares overflow: 2^300.
const FAR: f64 = f64::from_bits((1023 + 300) << 52);

/// The point of a mesh closest to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint<const D: usize = 3> {
    /// Distance to the query, not negative.
    pub distance: f64,
    /// The point.
    pub point: [f64; D],
    /// A facet that holds it.
    pub facet: u32,
}

/// A mesh prepared for distances. Each query's answer depends on the mesh and that query alone.
#[derive(Debug)]
pub struct DistanceTree<const D: usize = 3> {
    /// Of the mesh, in the caller's unit.
    bounds: Bounds<D>,
    /// Everything below is in this unit.
    pub(super) unit: Unit,
    pub(super) tree: Bvh<D>,
    /// Corners of the facets in the tree's order.
    pub(super) corners: Vec<[[f64; D]; D]>,
    winding: Winding<D>,
}

/// A query in the tree's unit.
struct Query<const D: usize> {
    point: [f64; D],
    /// Brings distances back to the caller's unit.
    stretch: f64,
}

impl<const D: usize> DistanceTree<D> {
    /// The tree of `mesh`: about 200 bytes a facet. [`Mesh::distance_tree`] keeps one.
    pub fn new(mesh: &Mesh<D>) -> Result<Self> {
        DistanceTree::with(mesh, Winding::new)
    }

    /// The tree of surfels, which are asked for winding numbers alone: what tells sides close behind an open mesh is left out.
    pub(super) fn of_surfels(mesh: &Mesh<D>) -> Result<Self> {
        DistanceTree::with(mesh, |_, tree, corners| Winding::without_sides(tree, corners))
    }

    fn with(
        mesh: &Mesh<D>,
        winding: impl Fn(&Mesh<D>, &Bvh<D>, &[[[f64; D]; D]]) -> Result<Winding<D>>,
    ) -> Result<Self> {
        let unit = Unit::of(mesh);
        let shrunk = unit.shrunk(mesh)?;
        let tree = Bvh::new(shrunk.facets().len(), |f| Bounds::of(&shrunk.corners(f)))?;
        let mut corners = try_with_capacity(tree.order.len(), "the facets of the distance tree")?;
        corners.extend(tree.order.iter().map(|&t| shrunk.corners(t as usize)));
        let winding = winding(&shrunk, &tree, &corners)?;
        Ok(DistanceTree { bounds: mesh.bounds(), unit, tree, corners, winding })
    }

    /// The point of the mesh closest to `point`.
    pub fn closest_point(&self, point: [f64; D]) -> Result<ClosestPoint<D>> {
        check_finite(0, point)?;
        let query = self.query(point);
        let (place, closest) = self.search(query.point);
        Ok(ClosestPoint {
            distance: closest.distance_squared.sqrt() * query.stretch,
            point: scale(self.unit.grow, facet::point(&self.corners[place], closest.barycentric)),
            facet: self.tree.order[place],
        })
    }

    /// Signed distances of `points` into `out`, as many: positive outside, where the winding number is below 1/2, negative
    /// inside, 0 on the mesh.
    pub fn signed_distances(&self, points: &[[f64; D]], out: &mut [f64]) -> Result<()> {
        if points.len() != out.len() {
            return Err(Error::InvalidArgument(format!(
                "{} points come with room for {} distances; as many are needed",
                points.len(),
                out.len()
            )));
        }
        for (i, &p) in points.iter().enumerate() {
            check_finite(i, p)?;
        }
        // In this order successive queries meet the same boxes, which nearly halves the time.
        for i in along_z_curve(points, &self.bounds)? {
            out[i] = self.signed_distance(&self.query(points[i]));
        }
        Ok(())
    }

    /// Winding number of the mesh around `point`, to about 0.1: the far fields of distant facets stand for them.
    pub fn winding_number(&self, point: [f64; D]) -> f64 {
        self.winding.rough(&self.tree, &self.corners, self.query(point).point)
    }

    fn signed_distance(&self, query: &Query<D>) -> f64 {
        let (_, closest) = self.search(query.point);
        if closest.distance_squared == 0.0 {
            return 0.0;
        }
        let distance = closest.distance_squared.sqrt() * query.stretch;
        match self.winding.side(&self.tree, &self.corners, query.point) {
            Side::Outside => distance,
            Side::Inside => -distance,
        }
    }

    /// A finite point in the tree's unit.
    fn query(&self, point: [f64; D]) -> Query<D> {
        let largest = point.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if largest * self.unit.shrink <= FAR {
            return Query { point: scale(self.unit.shrink, point), stretch: self.unit.grow };
        }
        Query { point: point.map(|x| x / largest * FAR), stretch: largest / FAR }
    }

    /// The place, in the tree's order, of a facet closest to `p`, and its closest point.
    fn search(&self, p: [f64; D]) -> (usize, Closest<D>) {
        let mut best = (0, closest(p, &self.corners[0]));
        let mut stack = [(0, 0.0); STACK_SIZE];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (node, box_distance) = stack[depth];
            if box_distance >= best.1.distance_squared {
                continue;
            }
            if let Some(range) = self.tree.nodes[node].leaf() {
                for place in range {
                    let candidate = closest(p, &self.corners[place]);
                    if candidate.distance_squared < best.1.distance_squared {
                        best = (place, candidate);
                    }
                }
                continue;
            }
            let [left, right] = self.tree.nodes[node].children();
            let left = (left, self.tree.nodes[left].distance_squared(p));
            let right = (right, self.tree.nodes[right].distance_squared(p));
            let (near, far) = if right.1 < left.1 { (right, left) } else { (left, right) };
            stack[depth] = far;
            stack[depth + 1] = near;
            depth += 2;
        }
        best
    }
}

/// Refuses point `i` when a coordinate is not finite.
fn check_finite<const D: usize>(i: usize, p: [f64; D]) -> Result<()> {
    if is_finite(&p) {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!("point {i} is {}; coordinates must be finite", text(&p))))
}

#[cfg(test)]
mod plane_tests;

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::super::shapes::{box_mesh, sphere, torus};
    use super::super::vec::{Vec3, add, norm, sub};
    use super::*;

    fn random_point(random: &mut SplitMix64, size: f64) -> Vec3 {
        std::array::from_fn(|_| random.between(-size, size))
    }

    /// Triangles of all sizes, some degenerate, anyhow in a box of half width 1.
    fn soup(n: usize, seed: u64) -> Mesh {
        let mut random = SplitMix64::new(seed);
        let mut vertices = Vec::new();
        for i in 0..n {
            let center = random_point(&mut random, 1.0);
            let size = 0.5_f64.powi((i % 8) as i32);
            let [a, b, c] = std::array::from_fn(|_| add(center, random_point(&mut random, size)));
            vertices.extend(if i % 10 == 0 { [a, b, b] } else { [a, b, c] });
        }
        Mesh::new(vertices, (0..n as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap()
    }

    /// Half a sphere: the cap of positive x, open.
    fn hemisphere() -> Mesh {
        let ball = sphere([0.0; 3], 1.0, 4).unwrap();
        let upper = |t: &[u32; 3]| t.iter().all(|&v| ball.vertices()[v as usize][0] > -1e-9);
        Mesh::new(ball.vertices().to_vec(), ball.triangles().iter().copied().filter(upper).collect()).unwrap()
    }

    fn signed(mesh: &Mesh, points: &[Vec3]) -> Vec<f64> {
        let mut out = vec![f64::NAN; points.len()];
        mesh.distance_tree().unwrap().signed_distances(points, &mut out).unwrap();
        out
    }

    /// Every triangle is asked, in the order of the mesh.
    fn brute_force(mesh: &Mesh, p: Vec3) -> f64 {
        let corners: Vec<_> = (0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect();
        let squared = corners.iter().fold(f64::INFINITY, |d, t| d.min(closest(p, t).distance_squared));
        if Winding::exact(&corners, p) < 0.5 { squared.sqrt() } else { -squared.sqrt() }
    }

    #[test]
    fn agrees_with_brute_force() {
        let shapes = [
            soup(1, 1),
            soup(5, 2),
            soup(700, 3),
            soup(4000, 4),
            torus(0.7, 0.2, 50, 20).unwrap(),
            hemisphere(),
            box_mesh([-0.5; 3], [0.5, 0.6, 0.7]).unwrap(),
        ];
        let mut random = SplitMix64::new(5);
        for (k, mesh) in shapes.iter().enumerate() {
            let points: Vec<Vec3> =
                (0..400).map(|i| random_point(&mut random, if i % 4 == 0 { 10.0 } else { 1.2 })).collect();
            for (p, d) in points.iter().zip(signed(mesh, &points)) {
                let expected = brute_force(mesh, *p);
                assert!((d - expected).abs() <= 1e-14 * (1.0 + d.abs()), "shape {k}, {p:?}: {d} for {expected}");
                let closest = mesh.distance_tree().unwrap().closest_point(*p).unwrap();
                assert!((norm(sub(closest.point, *p)) - closest.distance).abs() <= 1e-14 * (1.0 + d.abs()));
                assert_eq!(closest.distance, d.abs());
            }
        }
    }

    #[test]
    fn cube_has_its_distances_to_the_bit() {
        let cube = box_mesh([-1.0; 3], [1.0; 3]).unwrap();
        let points = [[0.0; 3], [0.5, 0.25, 0.0], [3.0, 0.0, 0.0], [4.0, 5.0, 1.0], [2.0, 3.0, 3.0], [1.0, -1.0, 1.0]];
        assert_eq!(signed(&cube, &points), [-1.0, -0.5, 2.0, 5.0, 3.0, 0.0]);
        let found = cube.distance_tree().unwrap().closest_point([2.0, 0.5, 0.25]).unwrap();
        assert_eq!((found.distance, found.point), (1.0, [1.0, 0.5, 0.25]));
        assert!(cube.corners(found.facet as usize).iter().all(|c| c[0] == 1.0));
    }

    #[test]
    fn sphere_and_torus_follow_their_closed_forms() {
        let mut random = SplitMix64::new(6);
        let points: Vec<Vec3> = (0..2000).map(|_| random_point(&mut random, 2.0)).collect();
        // The meshes are inscribed: their sagittas are edge^2 / 8 radius, over both directions.
        let ball = sphere([0.0; 3], 1.0, 5).unwrap();
        for (p, d) in points.iter().zip(signed(&ball, &points)) {
            assert!((d - (norm(*p) - 1.0)).abs() < 1e-3);
        }
        let ring = torus(1.2, 0.5, 200, 100).unwrap();
        for (p, d) in points.iter().zip(signed(&ring, &points)) {
            let exact = (p[0].hypot(p[1]) - 1.2).hypot(p[2]) - 0.5;
            assert!((d - exact).abs() < 2e-3, "{p:?}: {d} {exact}");
        }
    }

    #[test]
    fn open_hemisphere_has_an_inside_under_its_cap() {
        // On the axis the open cap fills the solid angle 2 pi (1 - cos): w = 1/2 at the plane of the rim.
        let points = [[0.5, 0.0, 0.0], [0.1, 0.3, 0.0], [-0.3, 0.0, 0.0], [1.5, 0.0, 0.0], [-5.0, 1.0, 0.0]];
        let signs: Vec<f64> = signed(&hemisphere(), &points).iter().map(|d| d.signum()).collect();
        assert_eq!(signs, [-1.0, -1.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn points_on_vertices_and_edges_are_at_zero() {
        let ring = torus(3.0, 1.0, 20, 10).unwrap();
        assert!(signed(&ring, ring.vertices()).iter().all(|d| *d == 0.0));
        let middles: Vec<Vec3> = ring
            .triangles()
            .iter()
            .map(|t| scale(0.5, add(ring.vertices()[t[0] as usize], ring.vertices()[t[1] as usize])))
            .collect();
        assert!(signed(&ring, &middles).iter().all(|d| d.abs() < 4.0 * 4.0 * f64::EPSILON));
    }

    #[test]
    fn far_points_have_their_distance_and_side() {
        let ball = sphere([0.0; 3], 1.0, 3).unwrap();
        for exponent in [3, 6, 12, 100, 150, 300] {
            let r = 10.0_f64.powi(exponent);
            let p = scale(r, [0.48, -0.6, 0.64]);
            let [d] = signed(&ball, &[p])[..] else { unreachable!("one point") };
            assert!((d / r - 1.0).abs() < 2.0 / r + 1e-15, "{exponent}: {d}");
            assert!(ball.distance_tree().unwrap().closest_point(p).unwrap().point[0].is_finite());
        }
        let largest = signed(&ball, &[[1e308, 0.0, -1e308]])[0];
        assert!((largest / 2.0_f64.sqrt() / 1e308 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_power_of_two_only_scales() {
        let ring = torus(3.0, 1.0, 20, 10).unwrap();
        let mut random = SplitMix64::new(8);
        let points: Vec<Vec3> = (0..200).map(|_| random_point(&mut random, 5.0)).collect();
        let distances = signed(&ring, &points);
        for exponent in [-900, -30, 30, 900] {
            let factor = 2.0_f64.powi(exponent);
            let vertices = ring.vertices().iter().map(|&v| scale(factor, v)).collect();
            let scaled = Mesh::new(vertices, ring.triangles().to_vec()).unwrap();
            let scaled_points: Vec<Vec3> = points.iter().map(|&p| scale(factor, p)).collect();
            let expected: Vec<f64> = distances.iter().map(|d| factor * d).collect();
            assert_eq!(signed(&scaled, &scaled_points), expected);
        }
    }

    #[test]
    fn batches_do_not_matter_and_flipping_changes_sides() {
        let mut ring = torus(0.7, 0.2, 50, 20).unwrap();
        let mut random = SplitMix64::new(9);
        let points: Vec<Vec3> = (0..100).map(|_| random_point(&mut random, 1.0)).collect();
        let together = signed(&ring, &points);
        let apart: Vec<f64> = points.chunks(7).flat_map(|chunk| signed(&ring, chunk)).collect();
        assert_eq!(together, apart);
        let kept = ring.clone();
        ring.flip();
        // Turned over, w is -1 inside and 0 outside: everything is outside.
        assert!(signed(&ring, &points).iter().zip(&together).all(|(f, d)| *f == d.abs()));
        assert_eq!(signed(&kept, &points), together);
    }

    #[test]
    fn refuses_what_is_not_finite_or_does_not_fit() {
        let cube = box_mesh([-1.0; 3], [1.0; 3]).unwrap();
        let tree = cube.distance_tree().unwrap();
        assert!(tree.signed_distances(&[[0.0; 3]], &mut []).is_err());
        assert!(tree.signed_distances(&[[0.0, f64::NAN, 0.0]], &mut [0.0]).is_err());
        assert!(tree.closest_point([f64::INFINITY, 0.0, 0.0]).is_err());
    }

    #[test]
    fn a_mesh_of_one_point_is_served() {
        let speck = Mesh::new(vec![[1.0, 2.0, 2.0]], vec![[0, 0, 0]; 9]).unwrap();
        assert_eq!(signed(&speck, &[[0.0; 3], [1.0, 2.0, 2.0]]), [3.0, 0.0]);
        let origin = Mesh::new(vec![[0.0; 3]], vec![[0, 0, 0]]).unwrap();
        assert_eq!(signed(&origin, &[[3.0, 0.0, 4.0]]), [5.0]);
    }
}
