//! Boxes around parts as they move, by which pairs are found that never come near each other.
//!
//! Time is cut into intervals in which no velocity jumps. A part's box of an interval is that of its grid in the middle, grown by how far its
//! points can go from there in half the interval: h (drift + turn r), r their greatest distance from the point that the bound is about.

use super::motion::Motion;
use super::part::Part;
use crate::geometry::Bounds;
use crate::geometry::vec::{is_finite, norm, number, sub};
use crate::{Error, Result};

/// Intervals at least.
const INTERVALS: f64 = 256.0;

/// The boxes of all parts.
pub struct SweptBoxes<const D: usize> {
    /// `[interval][part]`
    boxes: Vec<Vec<Bounds<D>>>,
    n_parts: usize,
}

/// Boxes of `parts` that move by `motions`, each grown by half the `clearance`.
pub fn swept_boxes<const D: usize>(parts: &[&Part<D>], motions: &[Motion<D>], clearance: f64) -> Result<SweptBoxes<D>> {
    let mut knots = vec![0.0, 1.0];
    motions.iter().for_each(|m| m.knots(&mut knots));
    knots.sort_by(f64::total_cmp);
    knots.dedup_by(|b, a| *b - *a < 1e-12);
    let mut boxes = Vec::new();
    for pair in knots.windows(2) {
        let n = ((pair[1] - pair[0]) * INTERVALS).ceil().max(1.0);
        let half = 0.5 * (pair[1] - pair[0]) / n;
        for k in 0..n as usize {
            let time = pair[0] + (2 * k + 1) as f64 * half;
            let of = |(k, (part, motion)): (usize, (&&Part<D>, &Motion<D>))| {
                let (pose, bound) = (motion.at(time), motion.bound(time, half));
                let corners: Vec<[f64; D]> = part.grid().corners().map(|p| pose.apply(p)).collect();
                // Those that are within r of o in the middle are within r + h drift of it throughout.
                let r = corners.iter().map(|p| norm(sub(*p, bound.about))).fold(0.0, f64::max) + half * bound.drift;
                let grow = half * (bound.drift + bound.turn * r) + 0.5 * clearance;
                let inner = Bounds::of(&corners);
                let outer = Bounds { min: inner.min.map(|x| x - grow), max: inner.max.map(|x| x + grow) };
                if is_finite(&outer.min) && is_finite(&outer.max) {
                    return Ok(outer);
                }
                let text = format!("at time {} part {k} is at no place that is finite", number(time));
                Err(Error::InvalidArgument(text))
            };
            boxes.push(parts.iter().zip(motions).enumerate().map(of).collect::<Result<Vec<_>>>()?);
        }
    }
    Ok(SweptBoxes { boxes, n_parts: parts.len() })
}

impl<const D: usize> SweptBoxes<D> {
    /// Pairs of parts whose boxes meet at some time, each with the smaller number first.
    pub fn meetings(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let pairs = (0..self.n_parts).flat_map(|i| (i + 1..self.n_parts).map(move |j| [i, j]));
        pairs.filter(|&[i, j]| self.boxes.iter().any(|of| meet(&of[i], &of[j])))
    }
}

fn meet<const D: usize>(one: &Bounds<D>, two: &Bounds<D>) -> bool {
    (0..D).all(|a| one.min[a] <= two.max[a] && two.min[a] <= one.max[a])
}

#[cfg(test)]
mod tests {
    use super::super::grid::Grid;
    use super::super::tests::motion;
    use super::*;
    use crate::geometry::random::SplitMix64;

    #[test]
    fn boxes_hold_parts_at_all_times_and_no_meeting_is_missed() {
        let mut random = SplitMix64::new(41);
        let (mut n_apart, mut fill) = (0, 0.0_f64);
        for _ in 0..60 {
            let part = |_| {
                let corner = std::array::from_fn(|_| random.between(-1.5, 1.5));
                Part::whole(Grid::<3>::new(corner, 0.1, [2, 3, 1]).unwrap()).unwrap()
            };
            let parts: Vec<_> = (0..3).map(part).collect();
            let motions: Vec<_> = (0..3).map(|_| motion::<3>(&mut random)).collect();
            let parts: Vec<&Part<3>> = parts.iter().collect();
            let found = swept_boxes(&parts, &motions, 0.02).unwrap();
            let pairs: Vec<_> = found.meetings().collect();
            let n = found.boxes.len();
            for _ in 0..200 {
                let t = random.unit();
                let at: Vec<Bounds<3>> = (0..3)
                    .map(|k| {
                        let corners: Vec<_> = parts[k].grid().corners().map(|p| motions[k].at(t).apply(p)).collect();
                        Bounds::of(&corners)
                    })
                    .collect();
                // Some box of all holds each part, grown by the clearance; intervals are of one length but for rounding where knots are even.
                for (k, now) in at.iter().enumerate() {
                    let held = |of: &Vec<Bounds<3>>| {
                        (0..3).all(|a| {
                            of[k].min[a] + 0.01 <= now.min[a] + 1e-12 && now.max[a] <= of[k].max[a] - 0.01 + 1e-12
                        })
                    };
                    let guess = (t * n as f64) as usize;
                    assert!((guess.saturating_sub(3)..(guess + 4).min(n)).any(|m| held(&found.boxes[m])), "{t} {k}");
                    let of = &found.boxes[guess.min(n - 1)][k];
                    fill =
                        fill.max((0..3).map(|a| of.max[a] - of.min[a] - (now.max[a] - now.min[a])).fold(0.0, f64::max));
                }
                for [i, j] in [[0, 1], [0, 2], [1, 2]] {
                    assert!(pairs.contains(&[i, j]) || !meet(&at[i], &at[j]));
                }
            }
            n_apart += 3 - pairs.len();
        }
        // They are not simply large.
        assert!(n_apart > 20 && fill < 0.2, "{n_apart} {fill}");
    }
}
