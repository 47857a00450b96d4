//! Motions of one parameter t in [0, 1]: paper 002, (3) and (4).
//!
//! What is built in is a screw run by a law, exp(f(t) xi): turning about an axis, sliding, a screw, a cam's stroke; or samples, which mean the
//! screws between them and nothing else; or products and inverses of these. A pose need not be the identity at t = 0.
//!
//! Each motion gives velocities, and bounds from which it follows how far points go between two times: with o a fixed point of the world, a
//! point P has the velocity u(t) + W(t) (P - o), |W| <= turn, |W'| <= turn_rate, |u| <= drift, |u'| <= drift_rate.

use crate::error::try_with_capacity;
use crate::geometry::matrix::applied;
use crate::geometry::rigid::{Rigid, Twist};
use crate::geometry::vec::{add, is_finite, norm, number, scale, sub};
use crate::{Error, Result};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A motion. Copies share what it is made of.
#[derive(Debug, Clone)]
pub struct Motion<const D: usize> {
    kind: Arc<Kind<D>>,
    /// Motions that it is a product of.
    n_factors: usize,
}

/// Motions that one may be a product of: each costs time, and stack, wherever the product is asked for.
const MOST_FACTORS: usize = 1000;

#[derive(Debug)]
enum Kind<const D: usize> {
    Fixed(Rigid<D>),
    /// exp(f(t) xi)
    Along(Twist<D>, Law),
    /// Poses at even times, and the twists of the screws from one to the next, per unit of t.
    Sampled(Vec<Rigid<D>>, Vec<Twist<D>>),
    /// tau_a(t) tau_b(t)
    Product(Motion<D>, Motion<D>),
    Inverse(Motion<D>),
}

/// How far along its screw a motion is: f(t) = offset + slope t + sum of amplitude cos(2 pi cycles t + phase).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Law {
    /// f without the rest.
    pub offset: f64,
    /// Rate of the even part.
    pub slope: f64,
    /// The waves.
    pub waves: Vec<Wave>,
}

/// amplitude cos(2 pi cycles t + phase)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Half of what it goes to and fro.
    pub amplitude: f64,
    /// Waves while t goes from 0 to 1.
    pub cycles: f64,
    /// Radians at t = 0.
    pub phase: f64,
}

/// Bounds of a motion's velocities over a while; see the page's head.
#[derive(Debug, Clone, Copy)]
pub struct RateBound<const D: usize> {
    /// o
    pub about: [f64; D],
    /// Bound of |W|.
    pub turn: f64,
    /// Bound of |W'|.
    pub turn_rate: f64,
    /// Bound of |u|.
    pub drift: f64,
    /// Bound of |u'|.
    pub drift_rate: f64,
}

impl Law {
    /// f(t) = slope t
    pub fn even(slope: f64) -> Self {
        Law { slope, ..Law::default() }
    }

    fn at(&self, t: f64) -> f64 {
        let wave = |w: &Wave| w.amplitude * (TAU * w.cycles * t + w.phase).cos();
        self.offset + self.slope * t + self.waves.iter().map(wave).sum::<f64>()
    }

    fn rate(&self, t: f64) -> f64 {
        let wave = |w: &Wave| -w.amplitude * TAU * w.cycles * (TAU * w.cycles * t + w.phase).sin();
        self.slope + self.waves.iter().map(wave).sum::<f64>()
    }

    /// Bounds of |f'| and |f''|.
    fn bounds(&self) -> (f64, f64) {
        self.waves.iter().fold((self.slope.abs(), 0.0), |(first, second), w| {
            let rate = (TAU * w.cycles).abs();
            (first + w.amplitude.abs() * rate, second + w.amplitude.abs() * rate * rate)
        })
    }

    /// As [`Motion::n_periods`]: the even part has to come to whole turns, of a screw without a slide, and waves to whole ones.
    fn n_periods<const D: usize>(&self, twist: &Twist<D>) -> u64 {
        let turns = self.slope.abs() * twist.rate() / TAU;
        let slides = twist.slide() > 8.0 * f64::EPSILON * norm(twist.drift);
        let even = if self.slope == 0.0 {
            0
        } else if slides {
            1
        } else {
            whole(turns).unwrap_or(1)
        };
        let waves = self.waves.iter().filter(|w| w.amplitude != 0.0).map(|w| whole(w.cycles.abs()).unwrap_or(1));
        waves.fold(even, gcd)
    }

    fn check(&self) -> Result<()> {
        let (_, second) = self.bounds();
        let phases: f64 = self.waves.iter().map(|w| w.phase.abs()).sum();
        if (self.offset + self.slope.abs() + second + phases).is_finite() {
            return Ok(());
        }
        Err(Error::InvalidArgument("a number of the motion's law is not finite, or too large".into()))
    }
}

impl<const D: usize> Motion<D> {
    /// A part that stays where it is.
    pub fn fixed() -> Self {
        Motion::at_pose(Rigid::IDENTITY)
    }

    /// A part that stays at `pose`.
    pub fn at_pose(pose: Rigid<D>) -> Self {
        Motion::of(Kind::Fixed(pose))
    }

    /// A slide by `law` times `along`.
    pub fn slide(along: [f64; D], law: Law) -> Result<Self> {
        Motion::along(Twist { turn: [[0.0; D]; D], drift: along }, law)
    }

    /// exp(law(t) `twist`).
    pub fn along(twist: Twist<D>, law: Law) -> Result<Self> {
        if !(is_finite(&twist.drift) && is_finite(twist.turn.as_flattened())) {
            return Err(Error::InvalidArgument("a number of the motion's screw is not finite".into()));
        }
        if (0..D).any(|a| (0..=a).any(|b| twist.turn[a][b] != -twist.turn[b][a])) {
            return Err(Error::InvalidArgument("the matrix of the motion's screw is not skew: W^T must be -W".into()));
        }
        law.check()?;
        Ok(Motion::of(Kind::Along(twist, law)))
    }

    /// The screw interpolation of `poses` at even times from 0 to 1: from each to the next by the screw of the smallest turn. Samples have
    /// to be so dense that no turn comes near pi. The error tells which pose is not finite or not rigid. A leap from one place to another is a
    /// fast move, which nothing gets through: [`Motion::of_function`] refuses one beyond a speed.
    pub fn sampled(poses: Vec<Rigid<D>>) -> Result<Self> {
        if poses.len() < 2 {
            return Err(Error::InvalidArgument(format!("a motion of {} poses; it takes 2 at least", poses.len())));
        }
        let mut checked = try_with_capacity(poses.len(), "a motion's poses")?;
        for (k, pose) in poses.into_iter().enumerate() {
            checked
                .push(Rigid::new(pose.turn, pose.shift).map_err(|e| Error::InvalidArgument(format!("pose {k}: {e}")))?);
        }
        let poses: Vec<Rigid<D>> = checked;
        let n = (poses.len() - 1) as f64;
        let mut twists = try_with_capacity(poses.len() - 1, "the motion's screws")?;
        for (k, pair) in poses.windows(2).enumerate() {
            let twist = pair[1].after(&pair[0].inverse()).log();
            if !(is_finite(&twist.drift) && is_finite(twist.turn.as_flattened())) {
                return Err(Error::InvalidArgument(format!("from pose {k} to pose {} the part goes too far", k + 1)));
            }
            if twist.rate() > MOST_TURN {
                return Err(Error::InvalidArgument(format!(
                    "from pose {k} to pose {} the part turns by {} rad, which could be either way round; at most {MOST_TURN} rad, by more \
                     poses",
                    k + 1,
                    number(twist.rate())
                )));
            }
            twists.push(twist.scaled(n));
        }
        Ok(Motion::of(Kind::Sampled(poses, twists)))
    }

    /// tau(t) = this(t) `inner`(t): what `inner` does is seen from what this moves. The error tells of too many motions in a product.
    pub fn times(&self, inner: &Self) -> Result<Self> {
        let n_factors = self.n_factors.saturating_add(inner.n_factors);
        if n_factors > MOST_FACTORS {
            let text = format!("a product of {n_factors} motions; at most {MOST_FACTORS}: sample it instead");
            return Err(Error::InvalidArgument(text));
        }
        Ok(Motion { kind: Arc::new(Kind::Product(self.clone(), inner.clone())), n_factors })
    }

    /// The motion that undoes this one at each time.
    pub fn inverse(&self) -> Self {
        match &*self.kind {
            Kind::Inverse(motion) => motion.clone(),
            _ => Motion { kind: Arc::new(Kind::Inverse(self.clone())), n_factors: self.n_factors },
        }
    }

    fn of(kind: Kind<D>) -> Self {
        Motion { kind: Arc::new(kind), n_factors: 1 }
    }

    /// tau(t)
    pub fn at(&self, t: f64) -> Rigid<D> {
        match &*self.kind {
            Kind::Fixed(pose) => *pose,
            Kind::Along(twist, law) => twist.scaled(law.at(t)).exp(),
            Kind::Sampled(poses, twists) => {
                let (k, since) = segment(t, twists.len());
                twists[k].scaled(since).exp().after(&poses[k])
            }
            Kind::Product(a, b) => a.at(t).after(&b.at(t)),
            Kind::Inverse(a) => a.at(t).inverse(),
        }
    }

    /// Velocities at t, by place in the world; between samples' screws that of the later one.
    pub fn twist(&self, t: f64) -> Twist<D> {
        match &*self.kind {
            Kind::Fixed(_) => Twist::ZERO,
            Kind::Along(twist, law) => twist.scaled(law.rate(t)),
            Kind::Sampled(_, twists) => twists[segment(t, twists.len()).0],
            Kind::Product(a, b) => a.twist(t).plus(&b.twist(t).seen_from(&a.at(t))),
            Kind::Inverse(a) => a.twist(t).seen_from(&a.at(t).inverse()).scaled(-1.0),
        }
    }

    /// Puts the times between 0 and 1 at which velocities may jump behind those of `times`.
    pub fn knots(&self, times: &mut Vec<f64>) {
        match &*self.kind {
            Kind::Fixed(_) | Kind::Along(..) => {}
            Kind::Sampled(_, twists) => times.extend((1..twists.len()).map(|k| k as f64 / twists.len() as f64)),
            Kind::Product(a, b) => {
                a.knots(times);
                b.knots(times);
            }
            Kind::Inverse(a) => a.knots(times),
        }
    }

    /// How often the motion repeats itself as t goes from 0 to 1: tau(t + 1 / n) = tau(t) for this n and its divisors; 0 where nothing moves,
    /// which any n holds for. Samples are not looked at: they count as 1.
    pub fn n_periods(&self) -> u64 {
        match &*self.kind {
            Kind::Fixed(_) => 0,
            Kind::Along(twist, law) => law.n_periods(twist),
            Kind::Sampled(..) => 1,
            Kind::Product(a, b) => gcd(a.n_periods(), b.n_periods()),
            Kind::Inverse(a) => a.n_periods(),
        }
    }

    /// Where the motion is a screw that slides while it turns evenly, whole turns n times: tau(t + 1 / n) is tau(t) moved on by a vector of the world.
    pub(super) fn turns(&self) -> Option<(u64, [f64; D])> {
        match &*self.kind {
            Kind::Along(twist, law) if law.waves.iter().all(|w| w.amplitude == 0.0) => {
                let n = whole(law.slope.abs() * twist.rate() / TAU).filter(|n| *n > 1)?;
                Some((n, twist.scaled(law.slope / n as f64).exp().shift))
            }
            Kind::Product(a, b) => match (&*a.kind, &*b.kind) {
                (Kind::Fixed(pose), _) => b.turns().map(|(n, slide)| (n, applied(&pose.turn, slide))),
                (_, Kind::Fixed(_)) => a.turns(),
                _ => None,
            },
            _ => None,
        }
    }

    /// Bounds over the times within `half` of `t`, between which no knot lies.
    pub fn bound(&self, t: f64, half: f64) -> RateBound<D> {
        match &*self.kind {
            Kind::Fixed(_) => RateBound { about: [0.0; D], turn: 0.0, turn_rate: 0.0, drift: 0.0, drift_rate: 0.0 },
            Kind::Along(twist, law) => {
                let (first, second) = law.bounds();
                let (rate, slide) = (twist.rate(), twist.slide());
                RateBound {
                    about: twist.center(),
                    turn: first * rate,
                    turn_rate: second * rate,
                    drift: first * slide,
                    drift_rate: second * slide,
                }
            }
            Kind::Sampled(..) => {
                let twist = self.twist(t);
                RateBound {
                    about: twist.center(),
                    turn: twist.rate(),
                    turn_rate: 0.0,
                    drift: twist.slide(),
                    drift_rate: 0.0,
                }
            }
            Kind::Product(a, b) => {
                let (fixed, before) = (matches!(&*a.kind, Kind::Fixed(_)), a.at(t));
                let (a, b) = (a.bound(t, half), b.bound(t, half));
                if fixed {
                    // The same about where it puts b's o: about its own the whole would be farther off.
                    return RateBound { about: before.apply(b.about), ..b };
                }
                // How far from b's o the point is that a's o is in b's world: it moves as fast as a drifts.
                let r = norm(sub(before.apply_inverse(a.about), b.about)) + half * a.drift;
                RateBound {
                    about: a.about,
                    turn: a.turn + b.turn,
                    turn_rate: a.turn_rate + b.turn_rate + a.turn * b.turn,
                    drift: a.drift + b.drift + b.turn * r,
                    drift_rate: a.drift_rate
                        + a.turn * (b.drift + b.turn * r)
                        + (b.drift_rate + b.turn_rate * r + b.turn * a.drift),
                }
            }
            Kind::Inverse(a) => {
                let (pose, a) = (a.at(t), a.bound(t, half));
                // The part's point that is at o at t goes away from there no faster than o's neighbourhood drifts.
                let r = half * a.drift;
                let speed = a.drift + a.turn * r;
                RateBound {
                    about: pose.apply_inverse(a.about),
                    turn: a.turn,
                    turn_rate: a.turn_rate,
                    drift: speed,
                    drift_rate: 2.0 * a.turn * speed + a.drift_rate + a.turn_rate * r,
                }
            }
        }
    }
}

impl Motion<2> {
    /// A turn about `center` by `law` in radians, counter-clockwise.
    pub fn turn(center: [f64; 2], law: Law) -> Result<Self> {
        let turn = [[0.0, -1.0], [1.0, 0.0]];
        Motion::along(Twist { turn, drift: [center[1], -center[0]] }, law)
    }
}

impl Motion<3> {
    /// A screw about the line through `point` along `axis`, of any length but 0, by `law` in radians, which slides by `lead` a radian.
    pub fn screw(point: [f64; 3], axis: [f64; 3], lead: f64, law: Law) -> Result<Self> {
        let Some([x, y, z]) = crate::geometry::vec::normalized(axis) else {
            return Err(Error::InvalidArgument(
                "the axis of the motion has no direction; it must be finite and not 0".into(),
            ));
        };
        let turn = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        let still = Twist { turn, drift: [0.0; 3] };
        let drift = add(scale(-1.0, still.at(point)), scale(lead, [x, y, z]));
        Motion::along(Twist { turn, drift }, law)
    }
}

/// The whole number that `x` is to rounding, if it is one.
fn whole(x: f64) -> Option<u64> {
    let n = x.round();
    ((x - n).abs() <= 4.0 * f64::EPSILON * x && n <= 1e9).then_some(n as u64)
}

/// The greatest common divisor; 0 and n have n.
pub(super) fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A sampled motion turns by at most this from one pose to the next, in radians.
const MOST_TURN: f64 = 3.0;

/// The segment of n that t is in, and how long since it began.
fn segment(t: f64, n: usize) -> (usize, f64) {
    let k = ((t * n as f64) as usize).min(n - 1);
    (k, t - k as f64 / n as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Motions of all kinds.
    fn all() -> Vec<Motion<3>> {
        let law = || Law { offset: 0.1, slope: 1.5, waves: vec![Wave { amplitude: 0.3, cycles: 2.0, phase: 0.4 }] };
        let screw = Motion::screw([1.0, 0.0, 0.5], [0.2, 1.0, -0.4], 0.3, law()).unwrap();
        let slide = Motion::slide([0.1, -0.4, 0.9], law()).unwrap();
        let sampled =
            Motion::sampled((0..5).map(|k| screw.times(&slide).unwrap().at(f64::from(k) / 4.0)).collect()).unwrap();
        let product = screw.times(&sampled).unwrap();
        let still = Motion::at_pose(screw.at(0.3)).times(&product).unwrap();
        let (back, across) = (screw.inverse().times(&slide).unwrap(), slide.inverse().times(&product).unwrap());
        vec![Motion::fixed(), screw, slide, sampled, product.clone(), product.inverse(), back, across, still]
    }

    proptest! {
        #[test]
        fn velocities_and_their_bounds_hold(
            k in 0..4_u32, x in 0.0..1.0_f64, p in prop::array::uniform3(-2.0..2.0_f64), half in 1e-4..0.02_f64
        ) {
            // Away from the samples' times.
            let away = half + 2e-5;
            let t = 0.25 * f64::from(k) + away + x * (0.25 - 2.0 * away);
            for (i, motion) in all().into_iter().enumerate() {
                let (h, twist, pose) = (1e-5, motion.twist(t), motion.at(t));
                let q = pose.apply_inverse(p);
                let difference = scale(0.5 / h, sub(motion.at(t + h).apply(q), motion.at(t - h).apply(q)));
                prop_assert!(norm(sub(difference, twist.at(p))) < 1e-6, "{i}");

                let bound = motion.bound(t, half);
                for s in [-1.0, -0.3, 0.2, 1.0] {
                    let at = t + s * half;
                    let (now, soon) = (motion.twist(at), motion.twist(at + h));
                    prop_assert!(now.rate() <= bound.turn * (1.0 + 1e-12) + 1e-12, "{i}");
                    prop_assert!(norm(now.at(bound.about)) <= bound.drift * (1.0 + 1e-9) + 1e-9, "{i}");
                    let change = soon.plus(&now.scaled(-1.0)).scaled(1.0 / h);
                    prop_assert!(change.rate() <= bound.turn_rate * 1.001 + 1e-6, "{i} {} {}", change.rate(), bound.turn_rate);
                    prop_assert!(norm(change.at(bound.about)) <= bound.drift_rate * 1.001 + 1e-6, "{i}");
                }
            }
        }
    }

    #[test]
    fn samples_of_a_screw_are_that_screw() {
        let screw = Motion::screw([1.0, 0.0, 0.5], [0.2, 1.0, -0.4], 0.3, Law::even(3.0)).unwrap();
        let sampled = Motion::sampled((0..4).map(|k| screw.at(f64::from(k) / 3.0)).collect()).unwrap();
        for t in [0.0, 0.2, 1.0 / 3.0, 0.7, 1.0] {
            let p = [0.3, -0.8, 0.1];
            assert!(norm(sub(screw.at(t).apply(p), sampled.at(t).apply(p))) < 1e-14);
        }
    }

    #[test]
    fn products_are_of_a_thousand_motions_at_most() {
        let step = Motion::<2>::slide([1e-3, 0.0], Law::even(1.0)).unwrap();
        let mut whole = step.clone();
        for _ in 1..MOST_FACTORS {
            // Inverses of inverses are no deeper.
            whole = whole.inverse().inverse().times(&step).unwrap();
        }
        assert!((whole.at(1.0).shift[0] - 1.0).abs() < 1e-12);
        let told = whole.times(&step).unwrap_err().to_string();
        assert!(told.contains("a product of 1001 motions; at most 1000"), "{told}");
    }

    #[test]
    fn motions_know_how_often_they_repeat_themselves() {
        let wave = |cycles| Wave { amplitude: 0.3, cycles, phase: 0.4 };
        let law = |turns: f64, waves: &[f64]| Law {
            offset: 0.1,
            slope: turns * TAU,
            waves: waves.iter().map(|&c| wave(c)).collect(),
        };
        let turn = |law| Motion::<3>::screw([1.0, 0.3, 0.5], [0.2, 1.0, -0.4], 0.0, law).unwrap();
        let screw = Motion::<3>::screw([1.0, 0.3, 0.5], [0.2, 1.0, -0.4], 0.1, law(6.0, &[])).unwrap();
        let slide = |law| Motion::slide([0.1, 0.2, 0.3], law).unwrap();
        let samples = Motion::sampled(vec![Rigid::IDENTITY; 3]).unwrap();
        for (motion, n) in [
            (Motion::fixed(), 0),
            (turn(law(6.0, &[])), 6),
            (turn(law(-6.0, &[4.0])), 2),
            (turn(law(6.5, &[])), 1),
            (turn(law(0.0, &[9.0, 6.0])), 3),
            (turn(law(0.0, &[0.5])), 1),
            (screw, 1),
            (slide(law(0.0, &[8.0])), 8),
            (slide(law(1.0, &[])), 1),
            (slide(law(0.0, &[8.0])).times(&turn(law(12.0, &[]))).unwrap(), 4),
            (slide(law(0.0, &[8.0])).times(&samples).unwrap(), 1),
            (turn(law(6.0, &[])).inverse(), 6),
        ] {
            assert_eq!(motion.n_periods(), n, "{motion:?}");
            let n = n.max(1) as f64;
            for t in [0.0, 0.03, 0.2] {
                for k in 0..n as usize {
                    let (p, late) = ([0.3, -0.8, 0.1], t / n + k as f64 / n);
                    assert!(norm(sub(motion.at(t / n).apply(p), motion.at(late).apply(p))) < 1e-13, "{motion:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_motion_is_refused() {
        let pose = |w: f64| Twist { turn: [[0.0, -w], [w, 0.0]], drift: [0.0; 2] }.exp();
        let told = |poses| Motion::<2>::sampled(poses).unwrap_err().to_string();
        let bent = Rigid { turn: [[1.0, 0.2], [0.0, 1.0]], shift: [0.0; 2] };
        assert!(told(vec![pose(0.0), pose(0.1), bent]).contains("pose 2: the pose is not rigid"));
        let nowhere = Rigid { shift: [0.0, f64::NAN], ..pose(0.0) };
        assert!(told(vec![nowhere, pose(0.1)]).contains("pose 0: an entry of the pose is not finite"));
        assert!(told(vec![pose(0.0)]).contains("2 at least"));
        assert!(told(vec![pose(0.0), pose(1.0), pose(4.1)]).contains("from pose 1 to pose 2"));
        let nan = Law { slope: f64::NAN, ..Law::default() };
        assert!(Motion::<2>::turn([0.0; 2], nan).unwrap_err().to_string().contains("law"));
        assert!(Motion::<2>::turn([0.0, f64::INFINITY], Law::even(1.0)).is_err());
        let bent = Twist { turn: [[0.1, -1.0], [1.0, 0.0]], drift: [0.0; 2] };
        assert!(Motion::along(bent, Law::even(1.0)).unwrap_err().to_string().contains("skew"));
        assert!(Motion::<3>::screw([0.0; 3], [0.0; 3], 0.0, Law::even(1.0)).unwrap_err().to_string().contains("axis"));
    }
}
