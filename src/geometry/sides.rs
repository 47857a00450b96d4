//! The sides of a cloud, and how far they mean something: for shapes that may be open.
//!
//! The generalised winding number W of the cloud's surfels (see [`surfels`](super::surfels)) falls by 1 where one goes through the surface
//! along a normal. So with W_s its mean of both sides of the surface near x,
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
use super::{Cloud, DistanceTree};
use crate::error::{try_vec, try_with_capacity};
use crate::par::Workers;
use crate::{Error, Result};

/// Probes that W_s is the mean of: one beside a sharp edge, where surfels leave gaps, would tell too little.
const PROBES: usize = 16;

/// One point in so many is a probe, where the cloud has enough for that: W_s is much the same all over a part, and the mean over a wider
/// part is the steadier one. Of closed shapes, with sharp edges or thin, from 100 to 25,000 points, 2 W_s so comes out from 0.6 to 1.1, in
/// the plane, where surfels fit together, from 0.89 to 1.02.
const fn points_a_probe<const D: usize>() -> usize {
    if D == 2 { 1 } else { 16 }
}

/// Distance from a surfel, in its size, at which both sides are asked for W.
const BESIDE: f64 = 1e-3;

/// The same for a jump that contradicting normals do not have: their surfels are larger, and cover each other.
const AWAY: f64 = 1.0;

/// A cloud prepared to tell its sides.
#[derive(Debug)]
pub struct Sides<const D: usize = 3> {
    unit: Unit,
    near: NearSides<D>,
}

impl<const D: usize> Cloud<D> {
    /// The cloud's sides: about 500 bytes a point, O(N log N).
    pub fn sides(&self) -> Result<Sides<D>> {
        let unit = Unit::of_bounds(&self.bounds());
        let mut points = try_with_capacity(self.len(), "the scaled points")?;
        points.extend(self.points().iter().map(|p| scale(unit.shrink, *p)));
        let mut normals = try_with_capacity(self.len(), "the normals")?;
        normals.extend_from_slice(self.normals());
        let near = NearSides::new(Cloud::new(points, normals)?, &Workers::caller_only())?;
        Ok(Sides { unit, near })
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
        for (p, side) in points.iter().zip(sides) {
            // Farther than this the cloud is a point, and has no sides but a closed shape's outside.
            let x = p.map(|x| (self.unit.shrink * x).clamp(-1e100, 1e100));
            *side = (2.0 * (self.near.beside(x).mean - self.near.winding_number(x))).clamp(-1.0, 1.0);
        }
        Ok(())
    }
}

/// The sides of a cloud whose coordinates are of a size of about 1.
#[derive(Debug)]
pub(crate) struct NearSides<const D: usize> {
    /// Without copies.
    points: Neighbours<D>,
    surfels: DistanceTree<D>,
    /// Points at which W beside the surface is known.
    probes: Neighbours<D>,
    /// [probes]
    beside: Vec<Beside>,
}

/// W on both sides of the surface at a place, each the mean over some points there.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Beside {
    /// W_s.
    pub mean: f64,
    /// How much W falls through the surface from the points' spacing behind it to as much before it: 1, but less where the surface has
    /// another so near behind it, and about 0 where normals contradict each other.
    pub jump: f64,
}

impl<const D: usize> NearSides<D> {
    /// The sides of `cloud`.
    pub fn new(cloud: Cloud<D>, workers: &Workers) -> Result<Self> {
        const CHUNK: usize = 256;
        // Copies of a point have no room between them, and their surfels no area.
        let cloud = cloud.without_copies()?;
        let points = Neighbours::new(cloud.points())?;
        let surfels = cloud.surfels(&points)?;
        let tree = DistanceTree::of_surfels(&surfels)?;

        let step = (cloud.len() / (8 * PROBES)).clamp(1, points_a_probe::<D>());
        let mut chosen = try_with_capacity(cloud.len().div_ceil(step), "the probes")?;
        chosen.extend(points.order().iter().step_by(step).map(|i| *i as usize));
        let mut of_one = try_vec(chosen.len(), Beside::default(), "the winding numbers of the probes")?;
        workers.for_each(of_one.chunks_mut(CHUNK).zip(chosen.chunks(CHUNK)), |(of_one, chosen)| {
            for (w, &i) in of_one.iter_mut().zip(chosen) {
                let (p, size) = (cloud.points()[i], norm(sub(surfels.corners(i)[0], surfels.corners(i)[1])));
                let [[before, behind], [far_before, far_behind]] = [BESIDE, AWAY].map(|off| {
                    let off = scale(off * size, cloud.normals()[i]);
                    [add(p, off), sub(p, off)].map(|x| tree.winding_number(x))
                });
                *w = Beside { mean: 0.5 * (before + behind), jump: far_behind - far_before };
            }
        });

        let mut places = try_with_capacity(chosen.len(), "the probes")?;
        places.extend(chosen.iter().map(|&i| cloud.points()[i]));
        let probes = Neighbours::new(&places)?;
        let mut beside = try_vec(chosen.len(), Beside::default(), "the winding numbers of the probes")?;
        workers.for_each(beside.chunks_mut(CHUNK).zip(places.chunks(CHUNK)), |(beside, places)| {
            for (w, p) in beside.iter_mut().zip(places) {
                let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; PROBES];
                let found = probes.nearest(*p, |_| true, &mut nearest);
                *w = mean(nearest[..found].iter().map(|n| of_one[n.index as usize]));
            }
        });
        Ok(NearSides { points, surfels: tree, probes, beside })
    }

    /// The distance of the point nearest to `x`, whose place in order goes into `hint`, as [`Neighbours::nearest_from`] takes it.
    pub fn nearest(&self, x: [f64; D], hint: &mut usize) -> f64 {
        self.points.nearest_from(x, hint).distance_squared.sqrt()
    }

    /// The point at `place` in order.
    pub fn point(&self, place: usize) -> [f64; D] {
        self.points.at(place)
    }

    /// W, to about 0.1.
    pub fn winding_number(&self, x: [f64; D]) -> f64 {
        self.surfels.winding_number(x)
    }

    /// W on both sides of the surface near `x`.
    pub fn beside(&self, x: [f64; D]) -> Beside {
        self.beside[self.probe(x, &mut 0)]
    }

    /// Index of the probe nearest to `x`; `hint` as [`Neighbours::nearest_from`] takes it.
    pub fn probe(&self, x: [f64; D], hint: &mut usize) -> usize {
        self.probes.nearest_from(x, hint).index as usize
    }

    /// W on both sides of the surface at the probes.
    pub fn at_probes(&self) -> &[Beside] {
        &self.beside
    }

    /// The mean over the whole surface.
    pub fn everywhere(&self) -> Beside {
        mean(self.beside.iter().copied())
    }
}

/// The mean of each figure.
fn mean(all: impl ExactSizeIterator<Item = Beside>) -> Beside {
    let n = all.len() as f64;
    let sum = all.fold(Beside::default(), |a, b| Beside { mean: a.mean + b.mean, jump: a.jump + b.jump });
    Beside { mean: sum.mean / n, jump: sum.jump / n }
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
