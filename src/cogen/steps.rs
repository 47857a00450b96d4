//! The relative motion of two parts, cut into steps: paper 002, (8) and (9).
//!
//! With tau = tau_1^-1 tau_2, what part 2 does is seen from part 1: p(t) = tau(t) q. From the velocities v_1, v_2 in the world, at P = tau_1 p,
//!
//!   p'  = R_1^T (v_2(P) - v_1(P))
//!   p'' = R_1^T (-W_1 (v_2 - v_1) + dv_2/dt - dv_1/dt), d/dt along part 2's point,
//!
//! so |p''| <= turn_1 |v_2 - v_1| + a_2 + (drift_rate_1 + turn_rate_1 r_1 + turn_1 speed_2), a_2 = drift_rate_2 + turn_rate_2 r_2 + turn_2 speed_2,
//! speed_i = drift_i + turn_i r_i, r_i = |P - o_i|. A step knows pose and velocities in its middle, and bounds p'' over its length: where p
//! is at any time within follows to second order.

use super::grid::Grid;
use super::motion::{Motion, RateBound, gcd};
use crate::error::{try_reserve, try_with_capacity};
use crate::geometry::matrix::applied_transposed;
use crate::geometry::rigid::{Rigid, Twist};
use crate::geometry::vec::{norm, number, scale, sub};
use crate::{Error, Result};
use std::cmp::Ordering;

/// How finely time is cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// That many even steps: the paper's K.
    Steps(usize),
    /// So many that cells are kept apart by at most about this much of the smaller cell's edge more than they must.
    Slack(f64),
}

/// Steps, at most.
pub const MOST_STEPS: usize = 10_000_000;

/// A while of the relative motion.
#[derive(Debug, Clone, Copy)]
pub struct Step<const D: usize> {
    /// Its middle.
    pub time: f64,
    /// Half its length.
    pub half: f64,
    /// tau in its middle: from the moving part's frame to the other's.
    pub pose: Rigid<D>,
    /// Velocities in its middle, in the other part's frame.
    pub twist: Twist<D>,
    /// Bound of |p''| / 2 half^2: how far p may be from where its velocity in the middle would take it.
    pub bend: f64,
}

/// Two motions, of which one is seen from the other.
#[derive(Debug, Clone)]
pub struct Relative<const D: usize> {
    /// tau_1, of the part that one looks from.
    pub from: Motion<D>,
    /// tau_2, of the part that one sees move.
    pub of: Motion<D>,
}

/// Times that tell motions apart.
const TIMES: [f64; 4] = [0.0, 0.312_5, 0.718_75, 1.0];

impl<const D: usize> Relative<D> {
    /// tau(t)
    pub fn at(&self, t: f64) -> Rigid<D> {
        self.from.at(t).inverse().after(&self.of.at(t))
    }

    /// Velocities of the moving part in the other's frame, by place there.
    pub fn twist(&self, t: f64) -> Twist<D> {
        let world = self.of.twist(t).plus(&self.from.twist(t).scaled(-1.0));
        world.seen_from(&self.from.at(t).inverse())
    }

    /// The same looked at from the other part.
    pub fn reversed(&self) -> Self {
        Relative { from: self.of.clone(), of: self.from.clone() }
    }

    /// An order of the two motions, by where `of` is and where `from` is at some times: of parts that are alike it tells one from the other,
    /// whichever comes first. Equal where they do not move against each other, as far as these times tell.
    pub(super) fn order(&self) -> Ordering {
        let numbers = |motion: &Motion<D>, t: f64| {
            let pose = motion.at(t);
            pose.shift.into_iter().chain(pose.turn.into_iter().flatten()).collect::<Vec<_>>()
        };
        let pairs = TIMES.iter().flat_map(|&t| numbers(&self.of, t).into_iter().zip(numbers(&self.from, t)));
        pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    }

    /// How often both motions repeat themselves together as t goes from 0 to 1: one period of them shows all that happens.
    pub fn n_periods(&self) -> usize {
        gcd(self.from.n_periods(), self.of.n_periods()).clamp(1, 1 << 30) as usize
    }

    /// Where one part stays and the other is screwed by whole turns, n of them: how many, and by how much the moving part is farther after each, in
    /// the frame that one looks from.
    pub(super) fn turns(&self) -> Option<(u64, [f64; D])> {
        let looked_from = self.from.at(0.0).turn;
        match (self.from.n_periods(), self.of.n_periods()) {
            (0, _) => self.of.turns().map(|(n, slide)| (n, applied_transposed(&looked_from, slide))),
            // The axis stays where it is in the part's own frame.
            (_, 0) => self.from.turns().map(|(n, slide)| (n, scale(-1.0, applied_transposed(&looked_from, slide)))),
            _ => None,
        }
    }

    /// Those of `n` even steps that lie in the first of as many equal pieces of the motion as all have the same steps.
    pub fn even_steps_of_period(&self, n: usize) -> Result<Vec<Step<D>>> {
        self.first_even_steps(n, n / gcd(n as u64, self.n_periods() as u64).max(1) as usize)
    }

    /// The first `some` of `n` even steps, the paper's t_k = (k + 1/2) / K, without bounds.
    pub(super) fn first_even_steps(&self, n: usize, some: usize) -> Result<Vec<Step<D>>> {
        if n == 0 || n > MOST_STEPS {
            return Err(Error::InvalidArgument(format!("{n} steps of time; it must be 1 to {MOST_STEPS}")));
        }
        let half = 0.5 / n as f64;
        let mut steps = try_with_capacity(some, "steps of time")?;
        for k in 0..some {
            steps.push(self.step((2 * k + 1) as f64 * half, half, f64::INFINITY)?);
        }
        Ok(steps)
    }

    /// Steps that no jump of velocities lies in, with bounds for points of the grid `moving` in that of `still` or within `clearance` of it: of
    /// one period.
    pub fn bounded_steps(
        &self,
        sampling: Sampling,
        still: &Grid<D>,
        moving: &Grid<D>,
        clearance: f64,
    ) -> Result<Vec<Step<D>>> {
        self.bounded_steps_of(self.n_periods(), sampling, [still, moving], clearance)
    }

    /// The same for the first of `n` equal pieces of the motion, which are alike and have no jumps if there are several.
    fn bounded_steps_of(
        &self,
        n: usize,
        sampling: Sampling,
        grids: [&Grid<D>; 2],
        clearance: f64,
    ) -> Result<Vec<Step<D>>> {
        let sampling = match sampling {
            // As many in each piece.
            Sampling::Steps(k) => Sampling::Steps(k.div_ceil(n).saturating_mul(n)),
            slack => slack,
        };
        let mut knots = vec![0.0, 1.0 / n as f64];
        self.from.knots(&mut knots);
        self.of.knots(&mut knots);
        knots.sort_by(f64::total_cmp);
        // Knots that differ by rounding are one.
        knots.dedup_by(|b, a| *b - *a < 1e-12);
        let mut steps = Vec::new();
        for pair in knots.windows(2) {
            let (from, length) = (pair[0], pair[1] - pair[0]);
            let n = self.steps_between([from, length], sampling, grids, clearance)?;
            if steps.len() + n > MOST_STEPS {
                return Err(Error::InvalidArgument(format!(
                    "the motion takes more than {MOST_STEPS} steps at {sampling:?}; is it as fast as it should be?"
                )));
            }
            let half = 0.5 * length / n as f64;
            try_reserve(&mut steps, n, "steps of time")?;
            for k in 0..n {
                let time = from + (2 * k + 1) as f64 * half;
                let acceleration = self.acceleration(time, half, grids, clearance);
                steps.push(self.step(time, half, 0.5 * acceleration * half * half)?);
            }
        }
        Ok(steps)
    }

    fn step(&self, time: f64, half: f64, bend: f64) -> Result<Step<D>> {
        let (pose, twist) = (self.at(time), self.twist(time));
        let numbers =
            pose.shift.iter().chain(pose.turn.as_flattened()).chain(&twist.drift).chain(twist.turn.as_flattened());
        if let Some(x) = numbers.copied().find(|x| !x.is_finite()) {
            return Err(Error::InvalidArgument(format!(
                "at time {} the motion has the number {}",
                number(time),
                number(x)
            )));
        }
        Ok(Step { time, half, pose, twist, bend })
    }

    /// Steps that a time is cut into, by where it begins and how long it is.
    fn steps_between(
        &self,
        [from, length]: [f64; 2],
        sampling: Sampling,
        [still, moving]: [&Grid<D>; 2],
        clearance: f64,
    ) -> Result<usize> {
        match sampling {
            Sampling::Steps(0) => Err(Error::InvalidArgument(format!("0 steps of time; it must be 1 to {MOST_STEPS}"))),
            Sampling::Steps(n) => Ok(((n as f64 * length).round() as usize).max(1)),
            Sampling::Slack(part) => {
                if !(part > 0.0 && part.is_finite()) {
                    let text = format!("a slack of {} cells; it must be above 0 and finite", number(part));
                    return Err(Error::InvalidArgument(text));
                }
                // Rates are looked at here and there: how fine steps are is a matter of taste, bounds are not.
                let looks = (0..LOOKS).map(|k| {
                    let t = from + length * (k as f64 + 0.5) / LOOKS as f64;
                    (self.twist(t).rate(), self.acceleration(t, 0.0, [still, moving], clearance))
                });
                let (turn, bend) = looks.fold((0.0_f64, 0.0_f64), |(w, a), (rate, bend)| (w.max(rate), a.max(bend)));
                // rho turn h + bend h^2 / 2 = slack
                let (w, slack) = (turn * moving.cell(), part * still.cell().min(moving.cell()));
                let half = 2.0 * slack / (w + (w * w + 2.0 * bend * slack).sqrt());
                let n = (0.5 * length / half).ceil();
                if n <= MOST_STEPS as f64 { Ok((n as usize).max(1)) } else { Ok(MOST_STEPS + 1) }
            }
        }
    }

    /// Bound of |p''| for points of `moving` within `half` of `t`, on their way to or from where they are within `clearance` of the grid `still`.
    fn acceleration(&self, t: f64, half: f64, [still, moving]: [&Grid<D>; 2], clearance: f64) -> f64 {
        let (one, two) = (self.from.bound(t, half), self.of.bound(t, half));
        let r2 = reach(&self.of.at(t), &two, moving, half);
        let speed2 = two.drift + two.turn * r2;
        // P is a point of part 2. When it comes near a cell of part 1 it is within the clearance of that part's grid; until then it is farther
        // from there by what it goes in half a step, m = half (speed_1 + speed_2), with speed_1 at r_1 + m.
        let in_grid = reach(&self.from.at(t), &one, still, half) + clearance;
        let way = half * (one.drift + one.turn * in_grid + speed2);
        let by_grid = if half * one.turn < 1.0 { in_grid + way / (1.0 - half * one.turn) } else { f64::INFINITY };
        let r1 = by_grid.min(r2 + norm(sub(one.about, two.about)));
        let speed1 = one.drift + one.turn * r1;
        one.turn * (speed1 + speed2)
            + (two.drift_rate + two.turn_rate * r2 + two.turn * speed2)
            + (one.drift_rate + one.turn_rate * r1 + one.turn * speed2)
    }
}

/// Times at which rates are looked at.
const LOOKS: usize = 64;

/// How far from o a part's points can be within `half` of the time of `pose`.
fn reach<const D: usize>(pose: &Rigid<D>, bound: &RateBound<D>, grid: &Grid<D>, half: f64) -> f64 {
    grid.corners().map(|p| norm(sub(pose.apply(p), bound.about))).fold(0.0, f64::max) + half * bound.drift
}

#[cfg(test)]
mod tests {
    use super::super::motion::{Law, Wave};
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::geometry::vec::{add, scale};

    fn relative() -> Relative<3> {
        let law = |slope| Law { offset: 0.1, slope, waves: vec![Wave { amplitude: 0.2, cycles: 1.0, phase: 0.4 }] };
        let screw = Motion::screw([1.0, 0.0, 0.5], [0.2, 1.0, -0.4], 0.3, law(3.0)).unwrap();
        let slide = Motion::slide([0.1, -0.4, 0.9], law(0.3)).unwrap();
        let sampled =
            Motion::sampled((0..5).map(|k| slide.times(&screw).unwrap().at(f64::from(k) / 4.0)).collect()).unwrap();
        Relative { from: screw, of: sampled.inverse() }
    }

    #[test]
    fn points_stay_where_steps_say() {
        // Steps of parts of a cell, and of many cells, at whose middle points are far from the grid that they come to.
        stay_where_steps_say(0.05, 60);
        stay_where_steps_say(4.0, 8);
    }

    fn stay_where_steps_say(slack: f64, least: usize) {
        let relative = relative();
        let still = Grid::new([-1.0, -1.5, -0.5], 0.1, [20, 30, 10]).unwrap();
        let moving = Grid::new([-0.5; 3], 0.05, [20; 3]).unwrap();
        let steps = relative.bounded_steps(Sampling::Slack(slack), &still, &moving, 0.0).unwrap();
        assert!(steps.len() >= least, "{}", steps.len());
        let end = steps.iter().fold(0.0, |end, s: &Step<3>| {
            assert!((s.time - s.half - end).abs() < 1e-12);
            s.time + s.half
        });
        assert!((end - 1.0_f64).abs() < 1e-12);
        let (mut random, mut used, mut n) = (SplitMix64::new(3), 0.0_f64, 0);
        for step in &steps {
            for _ in 0..50 * (200 / steps.len()).max(1) {
                let q = std::array::from_fn(|_| random.between(-0.5, 0.5));
                let (p, t) = (step.pose.apply(q), step.time + step.half * random.between(-1.0, 1.0));
                // Only where it is in the other grid then, wherever it is in the middle of the step.
                let then = relative.at(t).apply(q);
                if (0..3).any(|a| then[a] < still.bounds().min[a] || then[a] > still.bounds().max[a]) {
                    continue;
                }
                let straight = add(p, scale(t - step.time, step.twist.at(p)));
                let off = norm(sub(then, straight));
                assert!(off <= step.bend * (1.0 + 1e-9) + 1e-14, "{off} {}", step.bend);
                used = used.max(off / step.bend);
                n += 1;
            }
        }
        assert!(n > 300 && used > 0.02, "{slack}: {n} {used}");
    }

    /// The largest deviation from the straight way of the moving grid's corners, of those that are in the other grid, over the step's bend.
    fn bend_that_is_used(relative: &Relative<2>, still: &Grid<2>, moving: &Grid<2>) -> f64 {
        let steps = relative.bounded_steps(Sampling::Steps(200), still, moving, 0.0).unwrap();
        let mut used = 0.0_f64;
        for step in &steps {
            for q in moving.corners() {
                let p = step.pose.apply(q);
                for side in [-1.0, 1.0] {
                    let then = relative.at(step.time + side * step.half).apply(q);
                    let bounds = still.bounds();
                    if (0..2).all(|a| (bounds.min[a]..=bounds.max[a]).contains(&then[a])) {
                        let straight = add(p, scale(side * step.half, step.twist.at(p)));
                        used = used.max(norm(sub(then, straight)) / step.bend);
                    }
                }
            }
        }
        used
    }

    #[test]
    fn bounds_are_reached_where_one_motion_has_all_of_it() {
        let wide = Grid::new([-1.0; 2], 0.1, [20; 2]).unwrap();
        let small = Grid::new([0.9, -0.1], 0.1, [1, 2]).unwrap();
        let turn = Motion::turn([0.0; 2], Law::even(2.0)).unwrap();
        let wave = Law { waves: vec![Wave { amplitude: 0.04, cycles: 1.0, phase: 0.0 }], ..Law::default() };
        let sway = Motion::turn([0.0; 2], wave.clone()).unwrap();
        let slide = Motion::slide([1.0, 0.0], wave).unwrap();
        let still = Motion::fixed;
        for (i, (from, of)) in [
            (still(), turn.clone()),
            (turn, still()),
            (still(), sway.clone()),
            (sway, still()),
            (still(), slide.clone()),
            (slide, still()),
        ]
        .into_iter()
        .enumerate()
        {
            let used = bend_that_is_used(&Relative { from, of }, &wide, &small);
            assert!(used > 0.8 && used < 1.0 + 1e-6, "{i}: {used}");
        }
    }

    #[test]
    fn even_steps_are_the_papers() {
        let steps = relative().first_even_steps(4, 4).unwrap();
        assert_eq!(steps.iter().map(|s| s.time).collect::<Vec<_>>(), [0.125, 0.375, 0.625, 0.875]);
        let back = relative().reversed().first_even_steps(4, 4).unwrap();
        let there = back[1].pose.apply(steps[1].pose.apply([0.2, 0.3, -0.1]));
        assert!(norm(sub(there, [0.2, 0.3, -0.1])) < 1e-14);
        assert!(relative().first_even_steps(0, 0).unwrap_err().to_string().contains("0 steps"));
    }
}
