//! Poses: x_w = s R x_b + t, with first and second derivatives by their parameters.
//!
//! Parameters stand in the order t, D of them, those of R, s. R of a quaternion q = (w, x, y, z) is Q(q) / |q|^2, Q its homogeneous
//! quadratic matrix, so that q need not have length 1 and derivatives are those by its raw entries; that of a rotation vector v is
//! I + A(s) V + B(s) V^2 with V the matrix of the cross product with v, s = v . v, A = sin(theta) / theta, B = (1 - cos(theta)) / theta^2,
//! theta = |v| (Rodrigues), by series where s is small; that of an angle in the plane is counter-clockwise.

use crate::geometry::matrix::{Matrix, diagonal, matrix, scaled, transposed};
use crate::{Error, Result};

/// How a frame is turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rotation {
    /// Not at all: no parameter.
    None,
    /// By a quaternion w, x, y, z of any length but 0; in space.
    Quaternion,
    /// By a rotation vector: along the axis, as long as the angle in radians; in space.
    Vector,
    /// By an angle in radians, counter-clockwise; in the plane.
    Angle,
}

/// Whether a frame is scaled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// s is 1.
    One,
    /// s, above 0, is a parameter.
    Free,
}

/// Which parameters a pose has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PoseKind {
    /// How the frame is turned.
    pub rotation: Rotation,
    /// Whether it is scaled.
    pub scale: Scale,
}

/// Parameters of rotation and scale together, at most.
pub const MOST_LINEAR: usize = 5;

/// Parameters of a pose, at most.
pub const MOST_PARAMETERS: usize = 3 + MOST_LINEAR;

impl PoseKind {
    /// Refuses what is of the other dimension.
    pub fn check<const D: usize>(self) -> Result<()> {
        let wrong = match (D, self.rotation) {
            (2, Rotation::Quaternion) => "a quaternion",
            (2, Rotation::Vector) => "a rotation vector",
            (3, Rotation::Angle) => "an angle",
            _ => return Ok(()),
        };
        let right = if D == 2 { "an angle" } else { "a quaternion or a rotation vector" };
        Err(Error::InvalidArgument(format!("a frame of dimension {D} is turned by {right}, not by {wrong}")))
    }

    fn n_rotation(self) -> usize {
        match self.rotation {
            Rotation::None => 0,
            Rotation::Quaternion => 4,
            Rotation::Vector => 3,
            Rotation::Angle => 1,
        }
    }

    /// Parameters of rotation and scale.
    pub fn n_linear(self) -> usize {
        self.n_rotation() + usize::from(self.scale == Scale::Free)
    }

    /// All parameters.
    pub fn n_parameters<const D: usize>(self) -> usize {
        D + self.n_linear()
    }
}

/// Derivatives that are wanted, up to this one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// None.
    Value,
    /// First ones.
    First,
    /// First and second ones.
    Second,
}

/// A pose at its parameters: L = s R, its inverse K = R^T / s, and their derivatives by the parameters of rotation and scale.
#[derive(Debug, Clone)]
pub(super) struct Pose<const D: usize> {
    /// t
    pub shift: [f64; D],
    /// s, and its derivatives.
    pub scale: f64,
    pub d_scale: [f64; MOST_LINEAR],
    /// L
    pub linear: Matrix<D>,
    /// K
    pub inverse: Matrix<D>,
    pub n_linear: usize,
    pub d_linear: [Matrix<D>; MOST_LINEAR],
    pub d_inverse: [Matrix<D>; MOST_LINEAR],
    pub dd_linear: [[Matrix<D>; MOST_LINEAR]; MOST_LINEAR],
    pub dd_inverse: [[Matrix<D>; MOST_LINEAR]; MOST_LINEAR],
}

/// R and its derivatives.
struct Turn<const D: usize> {
    r: Matrix<D>,
    d: [Matrix<D>; 4],
    dd: [[Matrix<D>; 4]; 4],
}

impl<const D: usize> Turn<D> {
    fn none() -> Self {
        Turn { r: diagonal(1.0), d: [diagonal(0.0); 4], dd: [[diagonal(0.0); 4]; 4] }
    }
}

impl<const D: usize> Pose<D> {
    /// The pose that moves nothing.
    pub fn identity() -> Self {
        let kind = PoseKind { rotation: Rotation::None, scale: Scale::One };
        Pose::of(kind, [0.0; D], &Turn::none(), 1.0, Order::Value)
    }

    /// The pose of `kind` at `parameters`; the error tells the first that is out of its range, by its number among them.
    pub fn at(kind: PoseKind, parameters: &[f64], order: Order) -> Result<Self> {
        debug_assert_eq!(parameters.len(), kind.n_parameters::<D>());
        let (shift, rest) = parameters.split_at(D);
        let (rotation, scale) = rest.split_at(kind.n_rotation());
        let turn = turn(kind.rotation, rotation, order)?;
        let scale = scale.first().copied().unwrap_or(1.0);
        // A NaN is not above 0.
        if !(SMALLEST_SCALE..=1.0 / SMALLEST_SCALE).contains(&scale) {
            let text = format!("parameter {} is the scale {scale}; it must lie in [1e-30, 1e30]", parameters.len() - 1);
            return Err(Error::InvalidArgument(text));
        }
        Ok(Pose::of(kind, std::array::from_fn(|a| shift[a]), &turn, scale, order))
    }

    fn of(kind: PoseKind, shift: [f64; D], turn: &Turn<D>, s: f64, order: Order) -> Self {
        let zero = diagonal(0.0);
        let n = kind.n_rotation();
        let mut pose = Pose {
            shift,
            scale: s,
            linear: scaled(s, &turn.r),
            inverse: scaled(1.0 / s, &transposed(&turn.r)),
            n_linear: kind.n_linear(),
            d_linear: [zero; MOST_LINEAR],
            d_inverse: [zero; MOST_LINEAR],
            dd_linear: [[zero; MOST_LINEAR]; MOST_LINEAR],
            dd_inverse: [[zero; MOST_LINEAR]; MOST_LINEAR],
            d_scale: [0.0; MOST_LINEAR],
        };
        if order >= Order::First {
            for k in 0..n {
                pose.d_linear[k] = scaled(s, &turn.d[k]);
                pose.d_inverse[k] = scaled(1.0 / s, &transposed(&turn.d[k]));
            }
            if kind.scale == Scale::Free {
                pose.d_scale[n] = 1.0;
                pose.d_linear[n] = turn.r;
                pose.d_inverse[n] = scaled(-1.0 / (s * s), &transposed(&turn.r));
            }
        }
        if order == Order::Second {
            pose.differentiate_twice(kind, turn, s);
        }
        pose
    }

    fn differentiate_twice(&mut self, kind: PoseKind, turn: &Turn<D>, s: f64) {
        let (pose, n) = (self, kind.n_rotation());
        for (k, l) in (0..n).flat_map(|k| (0..n).map(move |l| (k, l))) {
            pose.dd_linear[k][l] = scaled(s, &turn.dd[k][l]);
            pose.dd_inverse[k][l] = scaled(1.0 / s, &transposed(&turn.dd[k][l]));
        }
        if kind.scale == Scale::Free {
            pose.dd_inverse[n][n] = scaled(2.0 / (s * s * s), &transposed(&turn.r));
            for k in 0..n {
                pose.dd_linear[n][k] = turn.d[k];
                pose.dd_inverse[n][k] = scaled(-1.0 / (s * s), &transposed(&turn.d[k]));
                (pose.dd_linear[k][n], pose.dd_inverse[k][n]) = (pose.dd_linear[n][k], pose.dd_inverse[n][k]);
            }
        }
    }
}

/// Scales beyond it, and beyond its inverse, would leave the range of doubles.
const SMALLEST_SCALE: f64 = 1e-30;

fn turn<const D: usize>(rotation: Rotation, parameters: &[f64], order: Order) -> Result<Turn<D>> {
    match (rotation, parameters) {
        (Rotation::Quaternion, &[w, x, y, z]) => of_quaternion([w, x, y, z], order),
        (Rotation::Vector, &[x, y, z]) => of_vector([x, y, z], order),
        (Rotation::Angle, &[angle]) => of_angle(angle),
        _ => Ok(Turn::none()),
    }
}

/// Lengths of quaternions and rotation vectors, and angles: beyond it nothing is left of the direction, or squares overflow.
const LARGEST: f64 = 1e6;

fn of_angle<const D: usize>(angle: f64) -> Result<Turn<D>> {
    if !(-LARGEST..=LARGEST).contains(&angle) {
        let text = format!("parameter {D} is the angle {angle}; it must lie in [-1e6, 1e6]");
        return Err(Error::InvalidArgument(text));
    }
    let (sin, cos) = angle.sin_cos();
    let by = |c: f64, s: f64| matrix(|a, b| [[c, -s], [s, c]][a.min(1)][b.min(1)]);
    let mut turn = Turn { r: by(cos, sin), ..Turn::none() };
    (turn.d[0], turn.dd[0][0]) = (by(-sin, cos), by(-cos, -sin));
    Ok(turn)
}

fn of_quaternion<const D: usize>(q: [f64; 4], order: Order) -> Result<Turn<D>> {
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(1.0 / LARGEST..=LARGEST).contains(&length) {
        let text = format!(
            "parameters {D} to {} are a quaternion of length {length}; it must lie in [1e-6, 1e6], best near 1",
            D + 3
        );
        return Err(Error::InvalidArgument(text));
    }
    // Divided by its length here, and derivatives once and twice: what is left is a quotient of numbers near 1.
    let u = q.map(|x| x / length);
    let form = |a: [f64; 4], b: [f64; 4]| -> Matrix<D> {
        let p = |i: usize, j: usize| 0.5 * (a[i] * b[j] + a[j] * b[i]);
        let (ww, xx, yy, zz) = (p(0, 0), p(1, 1), p(2, 2), p(3, 3));
        let rows = [
            [ww + xx - yy - zz, 2.0 * (p(1, 2) - p(0, 3)), 2.0 * (p(1, 3) + p(0, 2))],
            [2.0 * (p(1, 2) + p(0, 3)), ww - xx + yy - zz, 2.0 * (p(2, 3) - p(0, 1))],
            [2.0 * (p(1, 3) - p(0, 2)), 2.0 * (p(2, 3) + p(0, 1)), ww - xx - yy + zz],
        ];
        matrix(|i, j| rows[i][j])
    };
    let unit = |k: usize| -> [f64; 4] { std::array::from_fn(|i| f64::from(i == k)) };
    let n = u.iter().map(|x| x * x).sum::<f64>();
    let mut turn = Turn { r: scaled(1.0 / n, &form(u, u)), ..Turn::none() };
    // With N = |u|^2 and R = Q / N: dR = (dQ - R dN) / N, ddR = (ddQ - dR dN - dR dN - R ddN) / N.
    for k in 0..4 {
        let dq = form(unit(k), u);
        turn.d[k] = matrix(|i, j| 2.0 * (dq[i][j] - turn.r[i][j] * u[k]) / n);
    }
    let twice = if order == Order::Second { 4 } else { 0 };
    for (k, l) in (0..twice).flat_map(|k| (0..4).map(move |l| (k, l))) {
        let ddq = form(unit(k), unit(l));
        let ddn = f64::from(k == l);
        turn.dd[k][l] = matrix(|i, j| {
            2.0 * (ddq[i][j] - turn.d[k][i][j] * u[l] - turn.d[l][i][j] * u[k] - turn.r[i][j] * ddn)
                / (n * length * length)
        });
    }
    turn.d = turn.d.map(|d| scaled(1.0 / length, &d));
    Ok(turn)
}

fn of_vector<const D: usize>(v: [f64; 3], order: Order) -> Result<Turn<D>> {
    let s = v.iter().map(|x| x * x).sum::<f64>();
    if !(0.0..=LARGEST * LARGEST).contains(&s) {
        let length = s.sqrt();
        let text =
            format!("parameters {D} to {} are a rotation vector of length {length}; at most 1e6 is taken", D + 2);
        return Err(Error::InvalidArgument(text));
    }
    let [[a, da, dda], [b, db, ddb]] = rodrigues(s);
    let skew = |v: [f64; 3]| [[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]];
    let unit = |k: usize| -> [f64; 3] { std::array::from_fn(|i| f64::from(i == k)) };
    // [v]^2 = v v^T - s I, and its derivatives.
    let square = |i: usize, j: usize| v[i] * v[j] - if i == j { s } else { 0.0 };
    let d_square = |k: usize, i: usize, j: usize| {
        f64::from(i == k) * v[j] + v[i] * f64::from(j == k) - if i == j { 2.0 * v[k] } else { 0.0 }
    };
    let dd_square = |k: usize, l: usize, i: usize, j: usize| {
        f64::from(i == k && j == l) + f64::from(i == l && j == k) - if i == j && k == l { 2.0 } else { 0.0 }
    };
    let cross = skew(v);
    let mut turn = Turn::none();
    turn.r = matrix(|i, j| f64::from(i == j) + a * cross[i][j] + b * square(i, j));
    for k in 0..3 {
        let d_cross = skew(unit(k));
        turn.d[k] = matrix(|i, j| {
            2.0 * v[k] * (da * cross[i][j] + db * square(i, j)) + a * d_cross[i][j] + b * d_square(k, i, j)
        });
        for l in 0..if order == Order::Second { 3 } else { 0 } {
            let other = skew(unit(l));
            let (same, both) = (2.0 * f64::from(k == l), 4.0 * v[k] * v[l]);
            turn.dd[k][l] = matrix(|i, j| {
                (same * da + both * dda) * cross[i][j]
                    + (same * db + both * ddb) * square(i, j)
                    + 2.0 * da * (v[k] * other[i][j] + v[l] * d_cross[i][j])
                    + 2.0 * db * (v[k] * d_square(l, i, j) + v[l] * d_square(k, i, j))
                    + b * dd_square(k, l, i, j)
            });
        }
    }
    Ok(turn)
}

/// A and B, each with its first and second derivative by s = theta^2.
fn rodrigues(s: f64) -> [[f64; 3]; 2] {
    if s < 1.0 {
        // A = sum (-s)^n / (2n + 1)!, B = sum (-s)^n / (2n + 2)!; the quotients below cancel here.
        return [1.0, 2.0].map(|first| {
            let (mut value, mut d, mut dd) = (0.0, 0.0, 0.0);
            // By Horner's rule from the smallest term on: c_n = c_{n-1} times -1 / ((2n + first - 1) (2n + first)).
            let mut c = [0.0; 12];
            c[0] = if first == 1.0 { 1.0 } else { 0.5 };
            for n in 1..12 {
                let m = 2.0 * n as f64 + first;
                c[n] = -c[n - 1] / (m * (m - 1.0));
            }
            for c in c.iter().rev() {
                dd = dd * s + 2.0 * d;
                d = d * s + value;
                value = value * s + c;
            }
            [value, d, dd]
        });
    }
    let theta = s.sqrt();
    let (a, b) = (theta.sin() / theta, (1.0 - theta.cos()) / s);
    let da = (theta.cos() - a) / (2.0 * s);
    let dda = (-0.5 * a - 3.0 * da) / (2.0 * s);
    let db = (0.5 * a - b) / s;
    [[a, da, dda], [b, db, (0.5 * da - 2.0 * db) / s]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::matrix::product;
    use crate::geometry::random::SplitMix64;

    fn kinds<const D: usize>() -> Vec<PoseKind> {
        let rotations: &[Rotation] = if D == 2 {
            &[Rotation::None, Rotation::Angle]
        } else {
            &[Rotation::None, Rotation::Quaternion, Rotation::Vector]
        };
        let both = [Scale::One, Scale::Free];
        rotations.iter().flat_map(|&rotation| both.map(|scale| PoseKind { rotation, scale })).collect()
    }

    fn parameters<const D: usize>(kind: PoseKind, random: &mut SplitMix64, size: f64) -> Vec<f64> {
        let mut q: Vec<f64> = (0..kind.n_parameters::<D>()).map(|_| size * random.between(-1.0, 1.0)).collect();
        if kind.rotation == Rotation::Quaternion {
            q[3] += 0.8;
        }
        if kind.scale == Scale::Free {
            *q.last_mut().unwrap() = random.between(0.5, 2.0);
        }
        q
    }

    fn apart<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> f64 {
        a.as_flattened().iter().zip(b.as_flattened()).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()))
    }

    fn poses_are_rotations_with_their_derivatives<const D: usize>() {
        let mut random = SplitMix64::new(3);
        let h = 1e-5;
        for kind in kinds::<D>() {
            // Near no rotation at all too, where closed forms cancel, and on both sides of where the series ends.
            for size in [0.0, 1e-9, 1e-3, 0.5, 0.58, 0.6, 1.0, 3.0] {
                let q = parameters::<D>(kind, &mut random, size);
                let pose = Pose::<D>::at(kind, &q, Order::Second).unwrap();
                let one = product(&pose.linear, &pose.inverse);
                assert!(apart(&one, &diagonal(1.0)) < 1e-14, "{kind:?} {q:?}");
                let square = product(&transposed(&pose.linear), &pose.linear);
                assert!(apart(&square, &diagonal(pose.scale * pose.scale)) < 1e-13);
                let central = |k: usize, of: &dyn Fn(&Pose<D>) -> Matrix<D>| {
                    let [plus, minus] = [h, -h].map(|h| {
                        let mut q = q.clone();
                        q[D + k] += h;
                        of(&Pose::at(kind, &q, Order::Second).unwrap())
                    });
                    matrix(|a, b| (plus[a][b] - minus[a][b]) / (2.0 * h))
                };
                for k in 0..kind.n_linear() {
                    assert!(apart(&central(k, &|p| p.linear), &pose.d_linear[k]) < 1e-7, "{kind:?} {q:?} {k}");
                    assert!(apart(&central(k, &|p| p.inverse), &pose.d_inverse[k]) < 1e-7);
                    for l in 0..kind.n_linear() {
                        assert!(apart(&central(k, &|p| p.d_linear[l]), &pose.dd_linear[k][l]) < 1e-7, "{kind:?} {q:?}");
                        assert!(apart(&central(k, &|p| p.d_inverse[l]), &pose.dd_inverse[k][l]) < 1e-7);
                    }
                }
            }
        }
    }

    #[test]
    fn poses_are_rotations_with_their_derivatives_in_both_dimensions() {
        poses_are_rotations_with_their_derivatives::<2>();
        poses_are_rotations_with_their_derivatives::<3>();
    }

    #[test]
    fn a_quarter_turn_is_one_by_every_parametrisation() {
        let half = std::f64::consts::FRAC_PI_4;
        let quaternion = PoseKind { rotation: Rotation::Quaternion, scale: Scale::One };
        let vector = PoseKind { rotation: Rotation::Vector, scale: Scale::One };
        // About z, by a quaternion of length 3.
        let q = [0.0, 0.0, 0.0, 3.0 * half.cos(), 0.0, 0.0, 3.0 * half.sin()];
        let turned = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(apart(&Pose::<3>::at(quaternion, &q, Order::Value).unwrap().linear, &turned) < 1e-15);
        let v = [0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * half];
        assert!(apart(&Pose::<3>::at(vector, &v, Order::Value).unwrap().linear, &turned) < 1e-15);
        let angle = PoseKind { rotation: Rotation::Angle, scale: Scale::One };
        assert!(
            apart(
                &Pose::<2>::at(angle, &[0.0, 0.0, 2.0 * half], Order::Value).unwrap().linear,
                &[[0.0, -1.0], [1.0, 0.0]]
            ) < 1e-15
        );
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let quaternion = PoseKind { rotation: Rotation::Quaternion, scale: Scale::Free };
        let text = |q: &[f64]| Pose::<3>::at(quaternion, q, Order::Value).unwrap_err().to_string();
        assert!(text(&[0.0; 8]).contains("quaternion of length 0"));
        assert!(text(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -2.0]).contains("parameter 7 is the scale -2"));
        assert!(PoseKind { rotation: Rotation::Angle, scale: Scale::One }.check::<3>().is_err());
        assert!(quaternion.check::<2>().is_err() && quaternion.check::<3>().is_ok());
    }
}
