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

use super::facet::all_directions;
use super::neighbours::{Neighbour, Neighbours};
use super::surfels::NONE_FACING;
use super::unit::Unit;
use super::vec::{add, dot, is_finite, norm, scale, sub, text};
use super::winding::Winding;
use super::{Cloud, DistanceTree, Mesh};
use crate::error::{try_vec, try_with_capacity};
use crate::par::Workers;
use crate::{Error, Result};
use std::f64::consts::PI;

/// Probes that W_s is the mean of: one beside a sharp edge, where surfels leave gaps, would tell too little.
const PROBES: usize = 16;

/// One point in so many is a probe, where the cloud has enough for that: W_s is much the same all over a part, and the mean over a wider
/// part is the steadier one. Of closed shapes, with sharp edges or thin, their points even or at random, 2 W_s so comes out from 0.86 to
/// 1.05 from 1000 to 25,000 points, of 100 from 0.53 to 1.17.
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
    /// Their numbers in the cloud; `None` where there were no copies.
    numbers: Option<Vec<u32>>,
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
        let (cloud, numbers) = cloud.without_copies()?;
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
                let both = |off: f64| {
                    let off = scale(off * size, cloud.normals()[i]);
                    [add(p, off), sub(p, off)]
                };
                let [far_before, far_behind] = both(AWAY).map(|x| tree.winding_number(x));
                let near = both(BESIDE);
                let [before, behind] = near.map(|x| tree.winding_number(x));
                let covered = covered(i, near, &cloud, &points, &surfels);
                *w = Beside { mean: 0.5 * (before + behind) - covered, jump: far_behind - far_before };
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
        Ok(NearSides { points, numbers, surfels: tree, probes, beside })
    }

    /// The distance of the point nearest to `x`, whose place in order goes into `hint`, as [`Neighbours::nearest_from`] takes it.
    pub fn nearest(&self, x: [f64; D], hint: &mut usize) -> f64 {
        self.points.nearest_from(x, hint).distance_squared.sqrt()
    }

    /// The point at `place` in order.
    pub fn point(&self, place: usize) -> [f64; D] {
        self.points.at(place)
    }

    /// The number in the cloud of the point at `place` in order; of copies, that of the first.
    pub fn number(&self, place: usize) -> u32 {
        let number = self.points.order()[place];
        self.numbers.as_ref().map_or(number, |numbers| numbers[number as usize])
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

/// By how much the surfels around that of point `i` falsify W between the two places `near` it: those of random points cover each other,
/// and on a bulge all that cover a point lie on one side of it. What they would add if they were spread is that of a dipole, smooth over a
/// surfel's size.
fn covered<const D: usize>(
    i: usize,
    near: [[f64; D]; 2],
    cloud: &Cloud<D>,
    points: &Neighbours<D>,
    surfels: &Mesh<D>,
) -> f64 {
    let mut nearest = NONE_FACING;
    let others = cloud.facing_along(i, points, &mut nearest).filter(|j| *j != i);
    others
        .map(|j| {
            let [before, behind] = near.map(|x| Winding::exact(&[surfels.corners(j)], x));
            let r = sub(cloud.points()[j], cloud.points()[i]);
            0.5 * (before + behind) - spread(surfels.area_normal(j), r)
        })
        .sum()
}

/// W at 0 of a facet at `r`, spread about as wide as it is: its dipole with the distance to a point its radius beside it.
fn spread<const D: usize>(area_normal: [f64; D], r: [f64; D]) -> f64 {
    let size = norm(area_normal);
    let (area, radius_squared) = if D == 2 { (1.0, 0.25 * size * size) } else { (0.5, 0.5 * size / PI) };
    let distance = (dot(r, r) + radius_squared).sqrt();
    if size == 0.0 { 0.0 } else { area * dot(area_normal, r) / (all_directions::<D>() * distance.powi(D as i32)) }
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
    use super::super::shapes::{box_mesh, circle, rectangle, scattered, sphere, torus};
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

    /// Sides of a closed shape are clear and right where it is `far`: 1 outside and -1 inside, by the sign of the exact distance.
    fn check_random<const D: usize>(cloud: &Cloud<D>, far: f64, distance: impl Fn(&[f64; D]) -> f64) {
        let mut random = SplitMix64::new(2);
        let points: Vec<[f64; D]> = (0..4000).map(|_| std::array::from_fn(|_| random.between(-1.2, 1.2))).collect();
        let mut inside = (0, 0.0);
        for (side, p) in at(cloud, &points).iter().zip(&points).filter(|(_, p)| distance(p).abs() > far) {
            let d = distance(p);
            assert!(side * d.signum() > 0.7, "{side} at distance {d} of {} points", cloud.len());
            if d < 0.0 {
                inside = (inside.0 + 1, inside.1 + side);
            }
        }
        let mean = inside.1 / f64::from(inside.0);
        assert!(inside.0 > 20 && mean < -0.9, "{mean} inside, of {} points", cloud.len());
    }

    #[test]
    fn random_points_tell_sides_as_even_ones_do() {
        for n in [500, 5000, 50_000] {
            // What random points leave open is some times their spacing.
            let far = 4.0 * (12.6 / n as f64).sqrt();
            check_random(&scattered::sphere(n, 1), far.min(0.5), |p| norm(*p) - 1.0);
        }
        for n in [3000, 30_000] {
            let far = (4.0 * (6.9 / n as f64).sqrt()).min(0.15);
            check_random(&scattered::torus(0.7, 0.25, n, 1), far, |[x, y, z]| (x.hypot(*y) - 0.7).hypot(*z) - 0.25);
        }
        for n in [100, 1000] {
            check_random(&scattered::circle(n, 1), 30.0 / n as f64, |p| norm(*p) - 1.0);
        }
    }

    /// The least and the largest 2 W_s at the probes of a cloud.
    fn range_of<const D: usize>(cloud: Cloud<D>) -> [f64; 2] {
        let sides = NearSides::new(cloud, &Workers::caller_only()).unwrap();
        let all = sides.at_probes().iter().map(|w| 2.0 * w.mean);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], w| [low.min(w), high.max(w)])
    }

    #[test]
    fn w_s_is_near_a_half_on_closed_shapes() {
        let mut ranges = Vec::new();
        for n in [100, 1000, 25_000] {
            let thin = box_mesh([-0.5, -0.5, -0.005], [0.5, 0.5, 0.005]).unwrap();
            let cube = box_mesh([-0.5; 3], [0.5; 3]).unwrap();
            for mesh in [thin, cube, sphere([0.0; 3], 0.5, 4).unwrap(), torus(0.35, 0.12, 60, 30).unwrap()] {
                ranges.push(("even", n, range_of(mesh.sample(n, 1).unwrap())));
            }
            ranges.push(("random", n, range_of(scattered::sphere(n, 1))));
            ranges.push(("random", n, range_of(scattered::torus(0.7, 0.25, n, 1))));
        }
        for n in [100, 1000] {
            for mesh in [circle([0.0; 2], 0.5, 500).unwrap(), rectangle([-0.5, -0.01], [0.5, 0.01]).unwrap()] {
                ranges.push(("even", n, range_of(mesh.sample(n, 1).unwrap())));
            }
            ranges.push(("random", n, range_of(scattered::circle(n, 1))));
        }
        let near = |n: usize| if n < 1000 { 0.5..1.2 } else { 0.85..1.1 };
        assert!(ranges.iter().all(|(_, n, range)| range.iter().all(|w| near(*n).contains(w))), "{ranges:?}");
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
