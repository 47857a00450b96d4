//! Rigid motions: poses, the screws between them, and velocities.
//!
//! A pose is p -> R p + t. A twist is a field of velocities W p + u with W skew; its screw of length s is the pose exp(s (W, u)). With
//! w = |W|, the rate of turning, by Rodrigues in both dimensions:
//!
//!   exp(W) = I + sin(w) / w W + (1 - cos w) / w^2 W^2,   t = (I + (1 - cos w) / w^2 W + (w - sin w) / w^3 W^2) u

use super::matrix::{Matrix, applied, applied_transposed, diagonal, matrix, product, transposed};
use super::vec::{add, is_finite, norm, scale, sub};
use crate::{Error, Result};

/// Entries of R^T R may be off those of the identity by this much in poses that callers give.
const OFF_RIGID: f64 = 1e-6;

/// A pose: p -> turn p + shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid<const D: usize> {
    /// R, a rotation.
    pub turn: Matrix<D>,
    /// t
    pub shift: [f64; D],
}

/// A field of velocities: turn p + drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist<const D: usize> {
    /// W, skew.
    pub turn: Matrix<D>,
    /// u, the velocity at the origin.
    pub drift: [f64; D],
}

impl<const D: usize> Rigid<D> {
    /// The pose that moves nothing.
    pub const IDENTITY: Self = {
        let (mut turn, mut a) = ([[0.0; D]; D], 0);
        while a < D {
            turn[a][a] = 1.0;
            a += 1;
        }
        Rigid { turn, shift: [0.0; D] }
    };

    /// A pose of the caller's, made rigid to rounding; the error tells what is not rigid about it.
    pub fn new(turn: Matrix<D>, shift: [f64; D]) -> Result<Self> {
        if !(is_finite(turn.as_flattened()) && is_finite(&shift)) {
            return Err(Error::InvalidArgument("an entry of the pose is not finite".into()));
        }
        let gram = product(&transposed(&turn), &turn);
        let off = matrix::<D>(|a, b| (gram[a][b] - f64::from(u8::from(a == b))).abs());
        let off = off.as_flattened().iter().fold(0.0, |m: f64, x| m.max(*x));
        if off > OFF_RIGID {
            let text =
                format!("the pose is not rigid: R^T R is off the identity by {off:.3e}, more than {OFF_RIGID:e}");
            return Err(Error::InvalidArgument(text));
        }
        if determinant(&turn) < 0.0 {
            return Err(Error::InvalidArgument("the pose mirrors: the determinant of R is -1; it must be 1".into()));
        }
        Ok(Rigid { turn: orthogonal(turn), shift })
    }

    /// The pose's image of `p`.
    #[inline]
    pub fn apply(&self, p: [f64; D]) -> [f64; D] {
        add(applied(&self.turn, p), self.shift)
    }

    /// What the pose moves to `p`.
    #[inline]
    pub fn apply_inverse(&self, p: [f64; D]) -> [f64; D] {
        applied_transposed(&self.turn, sub(p, self.shift))
    }

    /// This pose after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Rigid { turn: product(&self.turn, &first.turn), shift: self.apply(first.shift) }
    }

    /// The pose that undoes this one.
    pub fn inverse(&self) -> Self {
        Rigid { turn: transposed(&self.turn), shift: scale(-1.0, applied_transposed(&self.turn, self.shift)) }
    }

    /// The twist of which this is the screw of length 1: that of the smallest turn.
    pub fn log(&self) -> Twist<D> {
        let turn = log_turn(&self.turn);
        let w = rate(&turn);
        // V^-1 = I - W / 2 + (1 / w^2 - cot(w / 2) / (2 w)) W^2; the factor tends to 1/12.
        let factor = if w < 1e-2 {
            1.0 / 12.0 + w * w / 720.0 + w.powi(4) / 30240.0
        } else {
            1.0 / (w * w) - 0.5 / (w * (0.5 * w).tan())
        };
        let square = product(&turn, &turn);
        let inverse = matrix(|a, b| f64::from(u8::from(a == b)) - 0.5 * turn[a][b] + factor * square[a][b]);
        Twist { turn, drift: applied(&inverse, self.shift) }
    }
}

impl<const D: usize> Twist<D> {
    /// The twist of what does not move.
    pub const ZERO: Self = Twist { turn: [[0.0; D]; D], drift: [0.0; D] };

    /// Velocity at `p`.
    #[inline]
    pub fn at(&self, p: [f64; D]) -> [f64; D] {
        add(applied(&self.turn, p), self.drift)
    }

    /// |W|, radians per unit of time.
    pub fn rate(&self) -> f64 {
        rate(&self.turn)
    }

    /// `s` times the twist.
    pub fn scaled(&self, s: f64) -> Self {
        Twist { turn: matrix(|a, b| s * self.turn[a][b]), drift: scale(s, self.drift) }
    }

    /// Sum of both.
    pub fn plus(&self, other: &Self) -> Self {
        Twist { turn: matrix(|a, b| self.turn[a][b] + other.turn[a][b]), drift: add(self.drift, other.drift) }
    }

    /// The same field of velocities in the frame that `pose` moves to where it is seen now: Ad(pose).
    pub fn seen_from(&self, pose: &Rigid<D>) -> Self {
        let turn = product(&product(&pose.turn, &self.turn), &transposed(&pose.turn));
        Twist { drift: sub(applied(&pose.turn, self.drift), applied(&turn, pose.shift)), turn }
    }

    /// The screw of length 1.
    pub fn exp(&self) -> Rigid<D> {
        let w = self.rate();
        let square = product(&self.turn, &self.turn);
        let (a, b, c) = coefficients(w);
        let of = |first: f64, second: f64| {
            matrix(|i, j| f64::from(u8::from(i == j)) + first * self.turn[i][j] + second * square[i][j])
        };
        Rigid { turn: orthogonal(of(a, b)), shift: applied(&of(b, c), self.drift) }
    }

    /// The point nearest to the origin at which the velocity is along the axis, or 0 where nothing turns: the centre of rotation in the
    /// plane, a point of the axis in space.
    pub fn center(&self) -> [f64; D] {
        let w = self.rate();
        // W^2 projects onto what is across the axis, times -w^2: c = W u / w^2 solves W c + u across = 0.
        if w == 0.0 { [0.0; D] } else { scale(1.0 / (w * w), applied(&self.turn, self.drift)) }
    }

    /// Speed along the axis, or of everything where nothing turns.
    pub fn slide(&self) -> f64 {
        norm(self.at(self.center()))
    }
}

/// sin(w) / w, (1 - cos w) / w^2, (w - sin w) / w^3
fn coefficients(w: f64) -> (f64, f64, f64) {
    if w < 1e-2 {
        let s = w * w;
        return (
            1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0)),
            0.5 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0))),
            1.0 / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0))),
        );
    }
    let half = (0.5 * w).sin();
    (w.sin() / w, 2.0 * half * half / (w * w), (w - w.sin()) / (w * w * w))
}

/// |W|: of a skew matrix, the length of its vector.
fn rate<const D: usize>(turn: &Matrix<D>) -> f64 {
    norm3([turn[1][0], if D > 2 { turn[2][0] } else { 0.0 }, if D > 2 { turn[2][1] } else { 0.0 }])
}

fn norm3(v: [f64; 3]) -> f64 {
    norm(v)
}

fn determinant<const D: usize>(m: &Matrix<D>) -> f64 {
    if D == 2 {
        return m[0][0] * m[1][1] - m[0][1] * m[1][0];
    }
    let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
    m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
}

/// The rotation nearest to a matrix that is one but for a little: Newton's steps to the polar factor, R (3 I - R^T R) / 2.
fn orthogonal<const D: usize>(mut turn: Matrix<D>) -> Matrix<D> {
    for _ in 0..2 {
        let gram = product(&transposed(&turn), &turn);
        turn = product(&turn, &matrix(|a, b| f64::from(u8::from(a == b)) * 1.5 - 0.5 * gram[a][b]));
    }
    turn
}

/// W of the smallest turn with exp(W) = R.
fn log_turn<const D: usize>(r: &Matrix<D>) -> Matrix<D> {
    if D == 2 {
        let w = r[1][0].atan2(r[0][0]);
        return matrix(|a, b| {
            if a == b {
                0.0
            } else if a > b {
                w
            } else {
                -w
            }
        });
    }
    let q = quaternion(r);
    let sine = norm([q[1], q[2], q[3]]);
    let half = sine.atan2(q[0]);
    // The angle over the sine of its half; the limit is 2.
    let factor = if sine < 1e-9 { 2.0 } else { 2.0 * half / sine };
    let v = [q[1], q[2], q[3]].map(|x| factor * x);
    let mut turn = diagonal(0.0);
    for (a, b, k, sign) in [(0, 1, 2, -1.0), (0, 2, 1, 1.0), (1, 2, 0, -1.0)] {
        turn[a][b] = sign * v[k];
        turn[b][a] = -sign * v[k];
    }
    turn
}

/// The quaternion w, x, y, z of a rotation in space, w >= 0, by Shepperd's choice of the largest.
fn quaternion<const D: usize>(r: &Matrix<D>) -> [f64; 4] {
    let squares = [
        1.0 + r[0][0] + r[1][1] + r[2][2],
        1.0 + r[0][0] - r[1][1] - r[2][2],
        1.0 - r[0][0] + r[1][1] - r[2][2],
        1.0 - r[0][0] - r[1][1] + r[2][2],
    ];
    let largest = (0..4).fold(0, |m, k| if squares[k] > squares[m] { k } else { m });
    let (x, y, z) = (r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]);
    let (xy, xz, yz) = (r[0][1] + r[1][0], r[0][2] + r[2][0], r[1][2] + r[2][1]);
    let s = squares[largest];
    let q = match largest {
        0 => [s, x, y, z],
        1 => [x, s, xy, xz],
        2 => [y, xy, s, yz],
        _ => [z, xz, yz, s],
    };
    let length = norm(q) * if q[0] < 0.0 { -1.0 } else { 1.0 };
    q.map(|v| v / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn twist3(v: [f64; 6]) -> Twist<3> {
        let [a, b, c, x, y, z] = v;
        Twist { turn: [[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]], drift: [x, y, z] }
    }

    fn near<const D: usize>(a: &Rigid<D>, b: &Rigid<D>, tolerance: f64) -> bool {
        let off =
            sub(a.shift, b.shift).into_iter().chain((0..D * D).map(|k| a.turn[k / D][k % D] - b.turn[k / D][k % D]));
        off.fold(0.0, |m: f64, x| m.max(x.abs())) <= tolerance
    }

    proptest! {
        #[test]
        fn screws_are_told_from_their_ends(v in prop::array::uniform6(-1.7..1.7_f64), small in prop::bool::ANY) {
            let twist = twist3(v).scaled(if small { 1e-6 } else { 1.0 });
            let pose = twist.exp();
            prop_assert!(near(&pose, &pose.log().exp(), 1e-14));
            if twist.rate() < 3.0 {
                prop_assert!(near(&twist.exp(), &twist.scaled(0.5).exp().after(&twist.scaled(0.5).exp()), 1e-14));
                let back = pose.log().plus(&twist.scaled(-1.0));
                prop_assert!(norm(back.drift) + back.rate() < 1e-12, "{back:?}");
            }
            prop_assert!(near(&Rigid::IDENTITY, &pose.after(&pose.inverse()), 1e-14));
        }

        #[test]
        fn half_turns_are_logged(v in prop::array::uniform3(-1.0..1.0_f64)) {
            let n = norm(v).max(1e-3);
            let pi = std::f64::consts::PI;
            let pose = twist3([v[0] / n * pi, v[1] / n * pi, v[2] / n * pi, 0.3, -0.2, 0.5]).exp();
            prop_assert!(near(&pose, &pose.log().exp(), 1e-12));
        }

        #[test]
        fn velocities_are_derivatives_of_screws(v in prop::array::uniform6(-2.0..2.0_f64), p in prop::array::uniform3(-2.0..2.0_f64)) {
            let (twist, h) = (twist3(v), 1e-5);
            let difference = scale(0.5 / h, sub(twist.scaled(h).exp().apply(p), twist.scaled(-h).exp().apply(p)));
            prop_assert!(norm(sub(difference, twist.at(p))) < 1e-8);
            // Ad: moving p by the screw seen from a pose is moving it there and back.
            let pose = twist3([0.3, v[4], -0.7, v[0], 0.1, v[2]]).exp();
            let seen = twist.seen_from(&pose).exp();
            prop_assert!(near(&seen, &pose.after(&twist.exp()).after(&pose.inverse()), 1e-12));
        }

        #[test]
        fn the_plane_turns_about_its_center(w in 0.1..3.0_f64, x in -2.0..2.0_f64, y in -2.0..2.0_f64) {
            let twist = Twist { turn: [[0.0, -w], [w, 0.0]], drift: [x, y] };
            let c = twist.center();
            prop_assert!(norm(sub(twist.exp().apply(c), c)) < 1e-13 * (1.0 + norm(c)));
            prop_assert!(twist.slide() < 1e-13 && near(&twist.exp(), &twist.exp().log().exp(), 1e-13));
        }
    }

    #[test]
    fn what_is_not_rigid_is_refused() {
        let bad = |turn| Rigid::<2>::new(turn, [0.0; 2]).unwrap_err().to_string();
        assert!(bad([[1.1, 0.0], [0.0, 1.0]]).contains("not rigid"));
        assert!(bad([[1.0, 0.0], [0.0, -1.0]]).contains("mirrors"));
        assert!(bad([[f64::NAN, 0.0], [0.0, 1.0]]).contains("finite"));
        let mended = Rigid::<2>::new([[1.0 + 1e-8, 0.0], [0.0, 1.0]], [0.0; 2]).unwrap();
        assert!((mended.turn[0][0] - 1.0).abs() < 1e-15);
    }
}
