//! The field outside its box: a C2 continuation that grows like a distance.
//!
//! Along an axis, let t be the signed distance beyond a face (0 inside), l a quarter of the edge of the shortest cells on faces, s(t) =
//! l tanh(t / l) and e = t - s(t). With P the boundary cell's polynomial, continued by at most l, and r = |e| over the axes,
//!
//! ```text
//! phi(x) = m + (P(x_face + s) - m) L^2 / (L^2 + r^2) + sigma r
//! ```
//!
//! e starts as t^3 / (3 l^2), so phi is C2 across the faces. Far away s stands still and P gives way to m, its mean over the faces, on
//! the scale of L, the box's diagonal; so the gradient tends to sigma e / r, of length 1. sigma is the sign of the mean of phi over the
//! faces: for a closed shape +1 where the design may be outside, -1 where inside, so that |phi| grows on the way out, but for errors of
//! the fit near a face. Where |m| is at most half the mean of |phi| on the faces (a sheet that reaches the box) m = 0 and sigma = tanh(P
//! / h), h the longest cell edge: the sign of the clamped point made smooth, since a sign itself would jump where P crosses 0; beside the
//! prolongation of that crossing the slope grows with r / h.

use super::Field;
use super::eval::Place;
use crate::geometry::matrix::matrix;
use crate::geometry::vec::norm;
use crate::isa::Portable;
use crate::spline::basis::{Weights, second};
use crate::spline::kernel::Hessian;
use crate::spline::place_of;

/// Reach of the boundary cell's polynomial beyond a face, in cells. A cubic runs off over a whole cell where the surface is near the face.
const REACH: f64 = 0.25;

/// |mean of phi| over mean of |phi| on the faces above which they count as of one side: about 0 for a sheet through the box, near 1 for
/// closed shapes. A few values of the wrong sign, where the surface comes near a face, do not make a shape open.
const ONE_SIDED: f64 = 0.5;

/// How the field goes on outside its box.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beyond {
    /// sigma where the faces are of one side, `None` where they are of both.
    pub sign: Option<f64>,
    /// m
    pub(super) level: f64,
    /// L
    pub(super) length: f64,
    /// l, in cells of the grid.
    pub(super) reach: f64,
}

/// Value, gradient and Hessian.
pub type Jet<const D: usize> = (f64, [f64; D], Hessian<D>);

/// How phi at a point outside the box depends on control points.
pub(super) struct Dependence<'a, const D: usize> {
    /// Where P is evaluated.
    pub place: Place<'a, D>,
    /// d phi / d P
    pub on_polynomial: f64,
    /// d phi / d m
    pub on_level: f64,
}

/// How one coordinate is bent: derivatives of s and e with respect to t, e itself.
#[derive(Clone, Copy, Default)]
pub(super) struct Bend {
    pub ds: f64,
    dds: f64,
    pub e: f64,
    pub de: f64,
    dde: f64,
}

impl<const D: usize> Field<D> {
    /// The continuation at a point given in cells, outside the box along one axis at least.
    #[cold]
    pub(super) fn continued(&self, xi: [f64; D]) -> Jet<D> {
        let (bent, bends) = self.bent(xi);
        let Beyond { sign, level, length, .. } = self.beyond;
        let polynomial = self.bent_polynomial(bent, &bends);
        let r = escape(&bends);
        let sigma = match sign {
            Some(sign) => constant(sign),
            None => tanh(polynomial, self.grid.longest_cell()),
        };
        let faded = product(sum(polynomial, constant(-level)), fading(r, length));
        sum(constant(level), sum(faded, product(sigma, r)))
    }

    /// How phi depends on control points at a point given in cells, outside the box along one axis at least.
    pub(super) fn dependence(&self, xi: [f64; D]) -> Dependence<'_, D> {
        let (bent, bends) = self.bent(xi);
        let Beyond { sign, length, .. } = self.beyond;
        let place = self.place_near(bent);
        let r = escape(&bends);
        let faded = fading(r, length).0;
        let on_sigma = match sign {
            Some(_) => 0.0,
            None => {
                let h = self.grid.longest_cell();
                let sigma = (place.stencil.value::<Portable>(place.control_points, place.u) / h).tanh();
                r.0 * (1.0 - sigma * sigma) / h
            }
        };
        Dependence { place, on_polynomial: faded + on_sigma, on_level: if sign.is_some() { 1.0 - faded } else { 0.0 } }
    }

    /// x_face + s(t) in cells, and how each coordinate was bent.
    fn bent(&self, xi: [f64; D]) -> ([f64; D], [Bend; D]) {
        let mut bends = [Bend { ds: 1.0, ..Bend::default() }; D];
        let (mut bent, reach) = (xi, self.beyond.reach);
        for (a, axis) in self.grid.axes.iter().enumerate() {
            let face = xi[a].clamp(0.0, axis.n_cells as f64);
            if face != xi[a] {
                let tau = xi[a] - face;
                bends[a] = bend(tau / reach, reach * axis.cell);
                bent[a] = face + reach * (tau / reach).tanh();
            }
        }
        (bent, bends)
    }

    /// How a field of these control points goes on, from its values at the corners of all cells on the faces.
    pub(super) fn look_at_faces(&self) -> Beyond {
        let (mut total, mut size, mut count) = (0.0f64, 0.0, 0.0);
        self.for_face_corners(|Place { stencil, u, control_points, .. }| {
            let value = stencil.value::<Portable>(control_points, u);
            total += value;
            size += value.abs();
            count += 1.0;
        });
        let extents = self.grid.axes.map(|a| a.upper() - a.lower);
        let length = norm(extents);
        let reach = REACH / self.refined.as_ref().map_or(1.0, |r| r.finest_on_faces());
        if size == 0.0 {
            Beyond { sign: Some(self.feasible.sign()), level: 0.0, length, reach }
        } else if total.abs() > ONE_SIDED * size {
            Beyond { sign: Some(total.signum()), level: total / count, length, reach }
        } else {
            Beyond { sign: None, level: 0.0, length, reach }
        }
    }

    /// Visits the corners of all cells on the faces: those of which phi's mean is m.
    pub(super) fn for_face_corners<'a>(&'a self, mut visit: impl FnMut(Place<'a, D>)) {
        let n = self.grid.n_cells();
        // Lines along the last axis: of those inside, only the ends.
        let n_lines = n[..D - 1].iter().map(|n| n + 1).product::<usize>();
        for line in 0..n_lines {
            let across = std::array::from_fn(|a| if a == D - 1 { 1 } else { n[a] + 1 });
            let mut corner: [usize; D] = place_of(line, across);
            let inner = (0..D - 1).all(|a| corner[a] > 0 && corner[a] < n[a]);
            for k in (0..=n[D - 1]).step_by(if inner { n[D - 1] } else { 1 }) {
                corner[D - 1] = k;
                visit(self.place_near(corner.map(|x| x as f64)));
            }
        }
    }

    /// The place of a point given in cells of the grid, in the box or a little beyond it: then in the nearest cell, which it is not in.
    pub(super) fn place_near(&self, xi: [f64; D]) -> Place<'_, D> {
        let per_cell = self.grid.axes.map(|a| 1.0 / a.cell);
        let Some(refined) = &self.refined else {
            let (stencil, u) = self.grid.stencil(xi);
            return Place { stencil, u, control_points: &self.coefficients, table: 0, per_cell };
        };
        let face: [f64; D] = std::array::from_fn(|a| xi[a].clamp(0.0, self.grid.axes[a].n_cells as f64));
        let mut place = refined.place(&face, per_cell);
        for a in 0..D {
            place.u[a] += (xi[a] - face[a]) * (place.per_cell[a] / per_cell[a]);
        }
        place
    }

    /// Jet of P(x_face + s(t)).
    fn bent_polynomial(&self, bent: [f64; D], bends: &[Bend; D]) -> Jet<D> {
        let Place { stencil, u, control_points, per_cell, .. } = self.place_near(bent);
        let (value, g, h) =
            stencil.value_gradient_hessian::<Portable>(control_points, &u.map(Weights::at), &u.map(second));
        let slope = |a: usize| per_cell[a] * bends[a].ds;
        let gradient = std::array::from_fn(|a| g[a] * slope(a));
        let hessian = matrix(|a, b| {
            let own = if a == b { g[a] * per_cell[a] * bends[a].dds } else { 0.0 };
            h[a][b] * slope(a) * slope(b) + own
        });
        (value, gradient, hessian)
    }
}

/// s(t) and e(t) = t - s(t) at t = `tau` l.
pub(super) fn bend(tau: f64, l: f64) -> Bend {
    let tanh = tau.tanh();
    let t2 = tanh * tanh;
    // tau - tanh(tau) cancels for small tau; there its series is exact to rounding.
    let e = if tau.abs() < 0.05 {
        let q = tau * tau;
        tau * q * (1.0 / 3.0 - q * (2.0 / 15.0 - q * (17.0 / 315.0 - q * (62.0 / 2835.0 - q * 1382.0 / 155_925.0))))
    } else {
        tau - tanh
    };
    // s' = sech^2, s'' = -2 tanh sech^2 / l; e' = 1 - s', e'' = -s''.
    let dds = -2.0 * tanh * (1.0 - t2) / l;
    Bend { ds: 1.0 - t2, dds, e: l * e, de: t2, dde: -dds }
}

/// Jet of r = |e|; zero, as its limit, where e is.
fn escape<const D: usize>(bends: &[Bend; D]) -> Jet<D> {
    let largest = bends.iter().fold(0.0, |m: f64, b| m.max(b.e.abs()));
    if largest == 0.0 {
        return constant(0.0);
    }
    // Divided by the largest first: the square of a far coordinate overflows.
    let length = largest * bends.iter().map(|b| (b.e / largest).powi(2)).sum::<f64>().sqrt();
    let unit: [f64; D] = std::array::from_fn(|a| bends[a].e / length);
    let gradient: [f64; D] = std::array::from_fn(|a| unit[a] * bends[a].de);
    let hessian = matrix(|a, b| {
        let own = if a == b { bends[a].de * bends[a].de / length + unit[a] * bends[a].dde } else { 0.0 };
        own - gradient[a] * gradient[b] / length
    });
    (length, gradient, hessian)
}

/// Jet of a constant.
fn constant<const D: usize>(value: f64) -> Jet<D> {
    (value, [0.0; D], [[0.0; D]; D])
}

/// Jet of f(p) from the jet of p and f, f', f'' there.
fn compose<const D: usize>((_, g, h): Jet<D>, [value, first, second]: [f64; 3]) -> Jet<D> {
    let hessian = matrix(|a, b| first * h[a][b] + second * g[a] * g[b]);
    (value, g.map(|g| first * g), hessian)
}

/// Jet of tanh(p / h).
fn tanh<const D: usize>(p: Jet<D>, h: f64) -> Jet<D> {
    let value = (p.0 / h).tanh();
    let first = (1.0 - value * value) / h;
    compose(p, [value, first, -2.0 * value * first / h])
}

/// Jet of L^2 / (L^2 + r^2).
fn fading<const D: usize>(r: Jet<D>, length: f64) -> Jet<D> {
    let x = r.0 / length;
    let q = 1.0 / (1.0 + x * x);
    // By q x, which stays small where x^2 overflows and q is 0.
    let qx = if x < 1.0 { q * x } else { 1.0 / (x + 1.0 / x) };
    compose(r, [q, -2.0 * q * qx / length, q * (8.0 * qx * qx - 2.0 * q) / (length * length)])
}

/// Jet of a product.
fn product<const D: usize>((v, g, h): Jet<D>, (w, k, m): Jet<D>) -> Jet<D> {
    let hessian = matrix(|a, b| h[a][b] * w + g[a] * k[b] + g[b] * k[a] + v * m[a][b]);
    (v * w, std::array::from_fn(|a| g[a] * w + v * k[a]), hessian)
}

/// Jet of a sum.
fn sum<const D: usize>((v, g, h): Jet<D>, (w, k, m): Jet<D>) -> Jet<D> {
    (v + w, std::array::from_fn(|a| g[a] + k[a]), matrix(|a, b| h[a][b] + m[a][b]))
}
