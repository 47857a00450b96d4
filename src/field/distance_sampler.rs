//! Signed distances to a cloud, as the distance energy asks for them: see [`distance`](super::distance).

use crate::Result;
use crate::error::try_vec;
use crate::geometry::Cloud;
use crate::geometry::sides::{Beside, NearSides};
use crate::par::Workers;

/// Signed distances to a cloud, in its own unit.
pub struct DistanceSampler<const D: usize> {
    sides: NearSides<D>,
    /// t of each probe.
    turns: Vec<f64>,
    /// Whether all are the same, as those of closed shapes are: then none need be looked for.
    same: bool,
}

/// What was nearest last: of places close to each other it is often the same.
#[derive(Default)]
pub struct Hint {
    point: usize,
    probe: usize,
}

impl<const D: usize> DistanceSampler<D> {
    /// Of `cloud`, the coordinates of which are of a size of about 1.
    pub fn new(cloud: Cloud<D>, workers: &Workers) -> Result<Self> {
        let sides = NearSides::new(cloud, workers)?;
        let whole = sides.everywhere();
        let mut turns = try_vec(sides.at_probes().len(), 0.0, "far distances")?;
        turns.iter_mut().zip(sides.at_probes()).for_each(|(t, beside)| *t = turn(*beside, whole));
        let same = turns.iter().all(|t| *t == turns[0]);
        Ok(DistanceSampler { sides, turns, same })
    }

    /// |d| at `x`, and the place of the nearest point.
    pub fn nearest(&self, x: [f64; D], hint: &mut Hint) -> (f64, u32) {
        let d = self.sides.nearest(x, &mut hint.point);
        (d, hint.point as u32)
    }

    /// The point at a place.
    pub fn point(&self, place: u32) -> [f64; D] {
        self.sides.point(place as usize)
    }

    /// The number in the cloud of the point at a place; of copies, that of the first.
    pub fn number(&self, place: u32) -> u32 {
        self.sides.number(place as usize)
    }

    /// d and s at `x`, of which |d| is `distance`.
    pub fn side(&self, x: [f64; D], distance: f64, hint: &mut Hint) -> (f64, f64) {
        let t = self.turns[if self.same { 0 } else { self.sides.probe(x, &mut hint.probe) }];
        let side = t - 2.0 * self.sides.winding_number(x);
        (distance.copysign(side), (side * side).min(1.0))
    }
}

/// t, of W `beside` the surface, and W_s of the `whole` surface on average. W_s of a closed shape is 1/2, of a cavity -1/2; of a cloud that
/// stands for one it comes out from 0.3 to 0.55, and 1 or -1 is wanted. Above 1/2 it is where one part lies in another, and each part's
/// inside shall stay infeasible.
///
/// Wrong normals shall do no more harm than they must. Where W hardly jumps, they contradict each other, or a part of a closed shape is
/// thin: then t is that of the whole. And what turns the other way in a whole that is closed is taken for a patch of wrong normals.
fn turn(beside: Beside, whole: Beside) -> f64 {
    let closed = whole.mean.abs() > 0.25;
    let of_whole = if closed { whole.mean.signum() } else { 1.0 };
    let own = (4.0 * beside.mean).clamp(-1.0, 1.0);
    let own = if closed { own.abs() * of_whole } else { own };
    let trust = (4.0 * beside.jump - 1.0).clamp(0.0, 1.0);
    of_whole + trust * (own - of_whole)
}
