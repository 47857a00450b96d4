//! Motions of mechanisms with one degree of freedom.

use super::motion::{Law, Motion};
use crate::error::try_with_capacity;
use crate::geometry::rigid::Rigid;
use crate::geometry::vec::{norm, number, sub};
use crate::{Error, Result};
use std::f64::consts::TAU;

/// Two wheels that turn against each other about `centers`, as gears do: the first by `turns`, counter-clockwise, the second by `ratio` times
/// that, clockwise. Cut from what they leave of each other, teeth have the pitch radii r_1 = ratio r_2.
pub fn gears(centers: [[f64; 2]; 2], turns: f64, ratio: f64) -> Result<[Motion<2>; 2]> {
    if !(ratio > 0.0 && ratio.is_finite()) {
        return Err(Error::InvalidArgument(format!("a ratio of {}; it must be above 0 and finite", number(ratio))));
    }
    let turn = |center, turns: f64| Motion::turn(center, Law::even(TAU * turns));
    Ok([turn(centers[0], turns)?, turn(centers[1], -turns * ratio)?])
}

/// A planar four-bar linkage. Crank and rocker turn about two fixed pivots, the coupler joins their ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FourBar {
    /// Where crank and rocker turn.
    pub pivots: [[f64; 2]; 2],
    /// From the first pivot to the joint of crank and coupler.
    pub crank: f64,
    /// From joint to joint.
    pub coupler: f64,
    /// From the second pivot to the joint of rocker and coupler.
    pub rocker: f64,
    /// The crank's angle at t = 0, counter-clockwise from the direction of the x axis.
    pub from: f64,
    /// By how much it turns until t = 1.
    pub by: f64,
    /// On which side of the line from the crank's joint to the second pivot the rocker's joint lies.
    pub side: Bend,
}

/// One of the two ways in which a four-bar linkage can be put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bend {
    /// The rocker's joint lies to the left.
    Left,
    /// To the right.
    Right,
}

impl FourBar {
    /// The motions of crank, coupler and rocker. Each part is given in a frame of its own: the crank's and the rocker's have their origins in
    /// their pivots and their x axes towards their joints, the coupler's its origin in the crank's joint and its x axis towards the rocker's.
    /// They are sampled at `n` + 1 even times, and move by screws from each to the next: of coupler and rocker these come the nearer to the
    /// linkage the larger `n` is, as 1 / n^2. The error tells at which angle of the crank the linkage does not close.
    pub fn motions(&self, n: usize) -> Result<[Motion<2>; 3]> {
        let FourBar { pivots, crank, coupler, rocker, from, by, .. } = *self;
        for (name, x) in [("crank", crank), ("coupler", coupler), ("rocker", rocker)] {
            if !(x > 0.0 && x.is_finite()) {
                return Err(Error::InvalidArgument(format!("the {name} is {} long; it must be above 0", number(x))));
            }
        }
        if n == 0 {
            return Err(Error::InvalidArgument("0 steps for a linkage; it takes 1 at least".into()));
        }
        // Between samples a bar goes the shorter way round.
        if !((by / n as f64).abs() <= 3.0 && from.is_finite()) {
            return Err(Error::InvalidArgument(format!(
                "the crank turns from {} by {} rad in {n} steps; it must be finite, and at most 3 rad a step",
                number(from),
                number(by)
            )));
        }
        let bars = || try_with_capacity(n.saturating_add(1), "the linkage's poses");
        let (mut cranks, mut couplers, mut rockers) = (bars()?, bars()?, bars()?);
        for k in 0..=n {
            let angle = from + by * k as f64 / n as f64;
            let joint = [pivots[0][0] + crank * angle.cos(), pivots[0][1] + crank * angle.sin()];
            let other = self.rocker_joint(joint).ok_or_else(|| {
                Error::InvalidArgument(format!(
                    "at the crank's angle {} rad the linkage does not close: its joint is {} from the second pivot, coupler and rocker \
                     reach from {} to {}",
                    number(angle),
                    number(norm(sub(pivots[1], joint))),
                    number((coupler - rocker).abs()),
                    number(coupler + rocker)
                ))
            })?;
            cranks.push(frame(pivots[0], joint)?);
            couplers.push(frame(joint, other)?);
            rockers.push(frame(pivots[1], other)?);
        }
        Ok([Motion::sampled(cranks)?, Motion::sampled(couplers)?, Motion::sampled(rockers)?])
    }

    /// Where both circles meet, on the side that is asked for.
    fn rocker_joint(&self, joint: [f64; 2]) -> Option<[f64; 2]> {
        let to_pivot = sub(self.pivots[1], joint);
        let d = norm(to_pivot);
        // Along the line of centres, and across it.
        let along = 0.5 * (d + (self.coupler * self.coupler - self.rocker * self.rocker) / d);
        let square = self.coupler * self.coupler - along * along;
        if !(square >= 0.0 && d > 0.0) {
            return None;
        }
        let across = square.sqrt() * if self.side == Bend::Left { 1.0 } else { -1.0 };
        let [x, y] = to_pivot.map(|c| c / d);
        Some([joint[0] + along * x - across * y, joint[1] + along * y + across * x])
    }
}

/// The pose with its origin at `origin` and its x axis towards `towards`.
fn frame(origin: [f64; 2], towards: [f64; 2]) -> Result<Rigid<2>> {
    let along = sub(towards, origin);
    let [c, s] = along.map(|x| x / norm(along));
    Rigid::new([[c, -s], [s, c]], origin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_four_bar_linkage_stays_together() {
        let linkage = FourBar {
            pivots: [[0.0, 0.0], [2.0, 0.3]],
            crank: 0.6,
            coupler: 1.9,
            rocker: 1.4,
            from: 0.3,
            by: TAU,
            side: Bend::Left,
        };
        let off = |n: usize| {
            let [crank, coupler, rocker] = linkage.motions(n).unwrap();
            (0..=1000).map(f64::from).fold(0.0_f64, |worst, k| {
                let t = k / 1000.0;
                let (crank, coupler, rocker) = (crank.at(t), coupler.at(t), rocker.at(t));
                assert!(norm(sub(rocker.apply([0.0; 2]), linkage.pivots[1])) < 1e-12);
                let first = norm(sub(crank.apply([0.6, 0.0]), coupler.apply([0.0; 2])));
                worst.max(first).max(norm(sub(coupler.apply([1.9, 0.0]), rocker.apply([1.4, 0.0]))))
            })
        };
        assert!(off(1000) < 1e-9, "at the samples it is exact: {}", off(1000));
        let (coarse, fine) = (off(50), off(100));
        assert!(coarse < 2e-3 && fine < coarse / 3.5, "{coarse} {fine}");
    }

    #[test]
    fn linkages_that_do_not_close_are_refused() {
        let linkage = FourBar {
            pivots: [[0.0, 0.0], [2.0, 0.0]],
            crank: 1.0,
            coupler: 1.5,
            rocker: 1.0,
            from: 0.0,
            by: TAU,
            side: Bend::Right,
        };
        let told = linkage.motions(100).unwrap_err().to_string();
        assert!(told.contains("does not close") && told.contains("reach from 0.5 to 2.5"), "{told}");
        assert!(FourBar { crank: 0.0, ..linkage }.motions(10).unwrap_err().to_string().contains("the crank is 0 long"));
        assert!(linkage.motions(0).is_err());
    }

    #[test]
    fn gears_roll_on_their_pitch_circles() {
        let [one, two] = gears([[0.0; 2], [3.0, 0.0]], 1.0, 2.0).unwrap();
        // Where the pitch circles, of 2 and 1, touch, both move alike.
        let p = [2.0, 0.0];
        for t in [0.0, 0.37] {
            assert!(norm(sub(one.twist(t).at(p), two.twist(t).at(p))) < 1e-12);
        }
        assert!(gears([[0.0; 2], [3.0, 0.0]], 1.0, 0.0).unwrap_err().to_string().contains("ratio"));
    }
}
