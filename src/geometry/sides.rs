//! The sides of a cloud, and how far they mean something: for shapes that may be open.
//!
//! The generalised winding number W of the cloud's surfels (see [`surfels`](super::surfels)) falls by 1 where one goes through the surface
//! along a normal. So with W_s its mean of both sides at the points of the cloud nearest to x,
//!
//! ```text
//! side(x) = 2 (W_s - W(x))
//! ```
//!
//! is 1 just before the surface and -1 just behind it, open or closed. Of a closed shape it stays so everywhere. Beside an open one it goes
//! from 1 to -1 on the way around the rim, and far away to 2 W_s: 0 where the shape is flat, more where it bulges. Where it is well between
//! -1 and 1 the sign of a field is one of many.

use super::neighbours::{Neighbour, Neighbours};
use super::unit::Unit;
use super::vec::{add, is_finite, norm, scale, sub, text};
use super::{Cloud, Mesh};
use crate::error::try_with_capacity;
use crate::{Error, Result};

/// Points that W_s is the mean of: one beside a sharp edge, where surfels leave gaps, would tell too little.
const POINTS: usize = 16;

/// Distance from a surfel, in its size, at which both sides are asked for W.
const BESIDE: f64 = 1e-3;

/// A cloud prepared to tell its sides.
#[derive(Debug)]
pub struct Sides<const D: usize = 3> {
    unit: Unit,
    /// Of size 1, without copies.
    points: Neighbours<D>,
    surfels: Mesh<D>,
    /// Mean of W on both sides of each point.
    both_sides: Vec<f64>,
}

impl<const D: usize> Cloud<D> {
    /// The cloud's sides: about 500 bytes a point, O(N log N).
    pub fn sides(&self) -> Result<Sides<D>> {
        let unit = Unit::of_bounds(&self.bounds());
        let mut points = try_with_capacity(self.len(), "the scaled points")?;
        points.extend(self.points().iter().map(|p| scale(unit.shrink, *p)));
        let mut normals = try_with_capacity(self.len(), "the normals")?;
        normals.extend_from_slice(self.normals());
        let cloud = Cloud::new(points, normals)?.without_copies()?;
        let points = Neighbours::new(cloud.points())?;
        let surfels = cloud.surfels(&points)?;
        let tree = surfels.distance_tree()?;
        let mut both_sides = try_with_capacity(cloud.len(), "the winding numbers of the points")?;
        both_sides.extend((0..cloud.len()).map(|i| {
            let [a, b] = [0, 1].map(|k| surfels.corners(i)[k]);
            let beside = scale(BESIDE * norm(sub(a, b)), cloud.normals()[i]);
            let p = cloud.points()[i];
            0.5 * (tree.winding_number(add(p, beside)) + tree.winding_number(sub(p, beside)))
        }));
        Ok(Sides { unit, points, surfels, both_sides })
    }
}

impl<const D: usize> Sides<D> {
    /// side(x) at `points` [n x D] into `sides`, as many, cut to [-1, 1]: 1 where the normals clearly point to, -1 clearly behind, between
    /// them where an open shape has no clear side. To about 0.1.
    pub fn at(&self, points: &[[f64; D]], sides: &mut [f64]) -> Result<()> {
        if points.len() != sides.len() {
            let (n, room) = (points.len(), sides.len());
            return Err(Error::InvalidArgument(format!(
                "{n} points come with room for {room} sides; as many are needed"
            )));
        }
        if let Some(i) = points.iter().position(|p| !is_finite(p)) {
            let p = text(&points[i]);
            return Err(Error::InvalidArgument(format!("point {i} is {p}; coordinates must be finite")));
        }
        let tree = self.surfels.distance_tree()?;
        for (p, side) in points.iter().zip(sides) {
            // Farther than this the cloud is a point, and has no sides but a closed shape's outside.
            let x = p.map(|x| (self.unit.shrink * x).clamp(-1e100, 1e100));
            let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; POINTS];
            let found = self.points.nearest(x, |_| true, &mut nearest);
            let sum: f64 = nearest[..found].iter().map(|n| self.both_sides[n.index as usize]).sum();
            *side = (2.0 * (sum / found as f64 - tree.winding_number(x))).clamp(-1.0, 1.0);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::super::shapes::{box_mesh, circle, sphere};
    use super::*;

    fn at<const D: usize>(cloud: &Cloud<D>, points: &[[f64; D]]) -> Vec<f64> {
        let mut sides = vec![0.0; points.len()];
        cloud.sides().unwrap().at(points, &mut sides).unwrap();
        sides
    }

    #[test]
    fn closed_shapes_have_clear_sides_everywhere() {
        for mesh in [sphere([0.0; 3], 1.0, 4).unwrap(), box_mesh([-1.0; 3], [1.0, 1.0, -0.5]).unwrap()] {
            let cloud = mesh.sample(4000, 1).unwrap();
            let mut random = SplitMix64::new(2);
            let points: Vec<[f64; 3]> = (0..500).map(|_| std::array::from_fn(|_| random.between(-2.0, 2.0))).collect();
            let mut d = vec![0.0; 500];
            mesh.distance_tree().unwrap().signed_distances(&points, &mut d).unwrap();
            for (side, d) in at(&cloud, &points).iter().zip(&d).filter(|(_, d)| d.abs() > 0.05) {
                assert!(side * d.signum() > 0.75, "{side} at distance {d}");
            }
        }
        let ring = circle([0.0; 2], 1.0, 500).unwrap().sample(500, 1).unwrap();
        let sides = at(&ring, &[[0.0, 0.0], [0.9, 0.0], [1.1, 0.0], [50.0, 3.0]]);
        for (side, right) in sides.iter().zip([-1.0, -1.0, 1.0, 1.0]) {
            assert!((side - right).abs() < 0.1, "{sides:?}");
        }
    }

    #[test]
    fn open_shapes_have_sides_near_their_surface_and_none_far_away_or_beyond_the_rim() {
        // A segment from (-1, 0) to (1, 0), normals up.
        let points: Vec<[f64; 2]> = (0..200).map(|i| [(f64::from(i) - 99.5) / 100.0, 0.0]).collect();
        let open = Cloud::new(points, vec![[0.0, 1.0]; 200]).unwrap();
        let sides = at(&open, &[[0.0, 0.05], [0.0, -0.05], [0.5, 0.1], [0.0, 20.0], [2.0, 0.05], [2.0, -0.05]]);
        assert!(sides[0] > 0.9 && sides[1] < -0.9 && sides[2] > 0.85, "{sides:?}");
        assert!(sides[3..].iter().all(|s| s.abs() < 0.1), "{sides:?}");
    }

    #[test]
    fn wrong_points_are_named() {
        let ball = sphere([0.0; 3], 1.0, 2).unwrap().sample(100, 1).unwrap().sides().unwrap();
        let end = ball.at(&[[0.0; 3], [f64::NAN, 0.0, 0.0]], &mut [0.0; 2]);
        assert!(end.unwrap_err().to_string().contains("point 1 is"));
        assert!(ball.at(&[[0.0; 3]], &mut []).is_err());
    }
}
