//! Bounds beyond the faces of the box, where phi is continued.
//!
//! With the names of [`beyond`](super::super::beyond), s, e, r and their derivatives are monotone in t, and the fading q = L^2 / (L^2 + r^2)
//! falls with r. So intervals of
//!
//! ```text
//! phi        = m + (P - m) q + sigma r
//! dphi/dx_a  = q dP/dx_a s'_a + ((P - m) dq/dr + sigma) (e_a / r) e'_a + dsigma/dP dP/dx_a s'_a r
//! ```
//!
//! come from the ends of a part and from bounds of P and its derivatives. They hold for a part without end, too.

use super::super::beyond::{Beyond, bend};
use super::ROUNDING;
use super::bounds::{Range, steps};
use super::parts::{Cells, Part, Stand};
use crate::spline::hull;

/// Width, in cells, that a part is taken to have at least where a derivative of P beyond a face is asked for.
const NARROWEST: f64 = 1.0 / 16.0;

/// The least and the largest.
type Interval = [f64; 2];

/// The products of two intervals; 0 for nothing times what has no end.
fn times(x: Interval, y: Interval) -> Interval {
    let product = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
    let all = [product(x[0], y[0]), product(x[0], y[1]), product(x[1], y[0]), product(x[1], y[1])];
    [all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

fn plus(x: Interval, y: Interval) -> Interval {
    [x[0] + y[0], x[1] + y[1]]
}

/// The largest size in an interval.
fn size([low, high]: Interval) -> f64 {
    high.max(-low)
}

/// What the gradient on a part beyond a face is made of.
struct Terms<const D: usize> {
    /// q dP/dx_a s'_a + dsigma/dP dP/dx_a s'_a r
    of_polynomial: [Interval; D],
    /// (P - m) dq/dr + sigma
    factor: Interval,
    /// (e_a / r) e'_a, of the sign of the way out.
    away: [Interval; D],
    /// The largest e'.
    bending: f64,
}

impl<const D: usize> Cells<'_, D> {
    /// Where phi lies on a part on which P is in this interval.
    pub fn range_beyond(&self, part: &Part<D>, [low, high]: Interval) -> Range {
        let Beyond { sign, level, length, .. } = self.field.beyond;
        let r = self.escapes(part);
        let q = r.map(|r| fading(r, length));
        // The product with q is largest where q is if it is positive, where q is least if it is not.
        let faded_high = |p: f64| if p > 0.0 { p * q[0] } else { p * q[1] };
        let faded_low = |p: f64| if p < 0.0 { p * q[0] } else { p * q[1] };
        match sign {
            Some(sign) => {
                let away = if sign > 0.0 { r } else { [-r[1], -r[0]] };
                let [low, high] = [faded_low(low - level), faded_high(high - level)];
                Range { low: level + low + away[0], high: level + high + away[1] }
            }
            None => {
                // m = 0, sigma of the sign of P and growing with it.
                let h = self.field.grid.longest_cell();
                let away = |p: f64, far: bool| (p / h).tanh() * if far { r[1] } else { r[0] };
                // r makes much of what P is rounded by.
                let off = f64::EPSILON * ROUNDING * self.size;
                let (l, u) = (low - off, high + off);
                Range { low: faded_low(low) + away(l, l < 0.0), high: faded_high(high) + away(u, u > 0.0) }
            }
        }
    }

    /// r at the near end of a part and at its far end.
    fn escapes(&self, part: &Part<D>) -> Interval {
        let [near, far] = [0, 1].map(|end| {
            let e = |a: usize| if part.stand[a] == Stand::Inside { 0.0 } else { self.bends(part, a)[end].1 };
            (0..D).map(e).fold(0.0, f64::hypot)
        });
        // In the order that rounding may not leave them.
        [near, far.max(near)]
    }

    /// A bound of |grad phi| on a part beyond a face; without end where sides change there.
    pub fn slope_beyond(&self, part: &Part<D>, rounding: f64) -> f64 {
        if self.field.beyond.sign.is_none() {
            return f64::INFINITY;
        }
        let Terms { of_polynomial, factor, away, bending } = self.terms(part, rounding);
        // The vector (e_a / r) e'_a is no longer than the largest e', which its parts, each by itself, do not tell.
        let (mut inside, mut bent, mut by_axis) = (0.0_f64, 0.0_f64, 0.0_f64);
        for a in 0..D {
            if part.stand[a] == Stand::Inside {
                inside = inside.hypot(size(of_polynomial[a]));
            } else {
                bent = bent.hypot(size(of_polynomial[a]));
                by_axis = by_axis.hypot(size(plus(of_polynomial[a], times(factor, away[a]))));
            }
        }
        inside.hypot(by_axis.min(bent + size(factor) * bending))
    }

    /// Where the derivatives of phi lie on a part beyond a face.
    pub fn gradient_beyond(&self, part: &Part<D>) -> [Interval; D] {
        let Terms { of_polynomial, factor, away, .. } = self.terms(part, 0.0);
        std::array::from_fn(|a| plus(of_polynomial[a], times(factor, away[a])))
    }

    fn terms(&self, part: &Part<D>, rounding: f64) -> Terms<D> {
        let mut local = self.local(part);
        for (a, local) in local.iter_mut().enumerate() {
            match part.stand[a] {
                Stand::Inside => {}
                Stand::Below => local[1] = local[1].max(local[0] + NARROWEST),
                Stand::Above => local[0] = local[0].min(local[1] - NARROWEST),
            }
        }
        let points = self.bezier_on(part, &local);
        let (low, high) = hull::range::<D>(&points);
        let Beyond { sign, level, length, .. } = self.field.beyond;
        let r = self.escapes(part);
        let h = self.field.grid.longest_cell();
        let p = [low - rounding, high + rounding];
        let sigma = sign.map_or_else(|| p.map(|p| (p / h).tanh()), |sign| [sign; 2]);
        let falling = [-steepest_fading(r, length), 0.0];
        let factor = plus(sigma, times([p[0] - level, p[1] - level], falling));
        let mut share = [fading(r[1], length), fading(r[0], length)];
        if sign.is_none() {
            // dsigma/dP = (1 - sigma^2) / h; it is positive, and at most 1 / h.
            let flat = 1.0 - size(sigma) * size(sigma);
            let crosses = sigma[0] <= 0.0 && sigma[1] >= 0.0;
            let steep = if crosses { 1.0 } else { 1.0 - sigma[0].abs().min(sigma[1].abs()).powi(2) };
            share = plus(share, times([flat / h, steep / h], r));
        }
        let mut terms = Terms { of_polynomial: [[0.0; 2]; D], factor, away: [[0.0; 2]; D], bending: 0.0 };
        for (a, local) in local.iter().enumerate() {
            let width = self.edge(&part.cell, a) * (local[1] - local[0]);
            let [low, high] = steps::<D>(&points, a).map(|step| 3.0 * step / width);
            let off = 3.0 * rounding / width;
            terms.of_polynomial[a] = times([low - off, high + off], share);
            if part.stand[a] != Stand::Inside {
                let [near, far] = self.bends(part, a);
                terms.of_polynomial[a] = times(terms.of_polynomial[a], [far.0, near.0]);
                let most = if r[0] > 0.0 { (far.1 / r[0]).min(1.0) } else { 1.0 };
                let least = if r[1] > 0.0 && r[1].is_finite() { near.1 / r[1] } else { 0.0 };
                let away = times([least, most], [near.2, far.2]);
                terms.away[a] = if part.stand[a] == Stand::Above { away } else { [-away[1], -away[0]] };
                terms.bending = terms.bending.max(far.2);
            }
        }
        terms
    }

    /// s', e and e' at the near and at the far end of a part along axis `a`, beyond a face of which it is.
    fn bends(&self, part: &Part<D>, a: usize) -> [(f64, f64, f64); 2] {
        let l = self.field.beyond.reach * self.field.grid.axes[a].cell;
        part.span[a].map(|t| {
            let end = bend(t / l, l);
            if t.is_finite() { (end.ds, end.e, end.de) } else { (0.0, f64::INFINITY, 1.0) }
        })
    }
}

/// L^2 / (L^2 + r^2); 0 for ever away.
fn fading(r: f64, length: f64) -> f64 {
    1.0 / (1.0 + (r / length) * (r / length))
}

/// The largest |dq / dr| = 2 r q^2 / L^2 between these r: it grows up to r = L / sqrt(3), and falls from there.
fn steepest_fading([near, far]: Interval, length: f64) -> f64 {
    let r = (length / 3.0_f64.sqrt()).clamp(near, far);
    // A little more, for what the peak is rounded by.
    (1.0 + 1e-12) * 2.0 * r / length * fading(r, length).powi(2) / length
}

/// The largest of phi on the points x of a part with normal . (x - the part's middle) <= offset, as
/// [`highest_below`](super::bounds::highest_below) has it for polynomials, by phi at the middle and the bounds of its derivatives.
pub(super) fn highest_below<const D: usize>(
    middle: (f64, [f64; D]),
    gradient: &[Interval; D],
    extents: &[f64; D],
    normal: &[f64; D],
    offset: f64,
) -> f64 {
    let (phi, slopes) = middle;
    let slope = (0..D).map(|a| slopes[a] * normal[a]).sum::<f64>().max(0.0);
    let rise = |a: usize| 0.5 * extents[a] * size(plus(gradient[a], [-slope * normal[a]; 2]));
    phi + (0..D).map(rise).sum::<f64>() + slope * offset
}
