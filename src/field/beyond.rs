//! The field outside its box: a C2 continuation that grows like a distance.
//!
//! Along an axis, let t be the signed distance beyond a face (0 inside), s(t) = h tanh(t / h) and e = t - s(t). With P the boundary cell's
//! polynomial, continued by at most one cell h, and e the vector of e over the axes,
//!
//! ```text
//! phi(x) = P(x_face + s) + sigma |e|
//! ```
//!
//! e starts as t^3 / (3 h^2), so phi is C2 across the faces; far away s stands still, and the gradient tends to sigma e / |e|, of
//! length 1. sigma is the sign that phi has on all faces: for a closed shape +1 where the design may be outside, -1 where inside, so
//! that |phi| does not fall on the way out. Where phi has both signs on the faces (an open shape that reaches the box) sigma =
//! tanh(P / h), the sign of the clamped point made smooth: a sign itself would jump where P crosses 0.

use super::Field;
use crate::spline::kernel::Stencil;

/// The sign with which |phi| grows outside the box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FarSign {
    /// phi has this sign on all faces of the box.
    Fixed(f64),
    /// phi has both signs there.
    OfClampedPoint,
}

/// Value, gradient and Hessian (xx xy xz yy yz zz).
pub type Jet = (f64, [f64; 3], [f64; 6]);

/// Row and column of each entry of a packed Hessian.
const PACKED: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// How one coordinate is bent: derivatives of s and e with respect to t, e itself.
#[derive(Clone, Copy, Default)]
struct Bend {
    ds: f64,
    dds: f64,
    e: f64,
    de: f64,
    dde: f64,
}

impl Field {
    /// The continuation at a point given in cells, outside the box along one axis at least.
    #[cold]
    pub(super) fn beyond(&self, xi: [f64; 3]) -> Jet {
        let mut bends = [Bend { ds: 1.0, ..Bend::default() }; 3];
        let mut bent = xi;
        for (a, axis) in self.grid.axes.iter().enumerate() {
            let face = xi[a].clamp(0.0, axis.n_cells as f64);
            if face != xi[a] {
                let tau = xi[a] - face;
                bends[a] = bend(tau, axis.cell);
                bent[a] = face + tau.tanh();
            }
        }
        let polynomial = self.bent_polynomial(bent, &bends);
        let escape = length(&bends);
        match self.far_sign {
            FarSign::Fixed(sign) => sum(polynomial, escape, sign),
            FarSign::OfClampedPoint => {
                let sign = tanh_jet(polynomial, self.grid.longest_cell());
                sum(polynomial, product(escape, sign), 1.0)
            }
        }
    }

    /// Jet of P(x_face + s(t)).
    fn bent_polynomial(&self, bent: [f64; 3], bends: &[Bend; 3]) -> Jet {
        let (stencil, u): (Stencil, _) = self.grid.stencil(bent);
        let (value, g, h) = stencil.value_gradient_hessian(&self.coefficients, u);
        let per_cell = self.grid.axes.map(|a| 1.0 / a.cell);
        let slope = |a: usize| per_cell[a] * bends[a].ds;
        let gradient = std::array::from_fn(|a| g[a] * slope(a));
        let hessian = std::array::from_fn(|p| {
            let (a, b) = PACKED[p];
            let own = if a == b { g[a] * per_cell[a] * bends[a].dds } else { 0.0 };
            h[p] * slope(a) * slope(b) + own
        });
        (value, gradient, hessian)
    }
}

/// s(t) and e(t) = t - s(t) at t = `tau` h.
fn bend(tau: f64, h: f64) -> Bend {
    let tanh = tau.tanh();
    let t2 = tanh * tanh;
    // tau - tanh(tau) cancels for small tau; there its series is exact to rounding.
    let e = if tau.abs() < 0.05 {
        let q = tau * tau;
        tau * q * (1.0 / 3.0 - q * (2.0 / 15.0 - q * (17.0 / 315.0 - q * (62.0 / 2835.0 - q * 1382.0 / 155_925.0))))
    } else {
        tau - tanh
    };
    // s' = sech^2, s'' = -2 tanh sech^2 / h; e' = 1 - s', e'' = -s''.
    let dds = -2.0 * tanh * (1.0 - t2) / h;
    Bend { ds: 1.0 - t2, dds, e: h * e, de: t2, dde: -dds }
}

/// Jet of |e|; zero, as its limit, where e is.
fn length(bends: &[Bend; 3]) -> Jet {
    let largest = bends.iter().fold(0.0, |m: f64, b| m.max(b.e.abs()));
    if largest == 0.0 {
        return (0.0, [0.0; 3], [0.0; 6]);
    }
    // Divided by the largest first: the square of a far coordinate overflows.
    let length = largest * bends.iter().map(|b| (b.e / largest).powi(2)).sum::<f64>().sqrt();
    let unit: [f64; 3] = std::array::from_fn(|a| bends[a].e / length);
    let gradient: [f64; 3] = std::array::from_fn(|a| unit[a] * bends[a].de);
    let hessian = std::array::from_fn(|p| {
        let (a, b) = PACKED[p];
        let own = if a == b { bends[a].de * bends[a].de / length + unit[a] * bends[a].dde } else { 0.0 };
        own - gradient[a] * gradient[b] / length
    });
    (length, gradient, hessian)
}

/// Jet of tanh(p / h).
fn tanh_jet((value, g, h): Jet, scale: f64) -> Jet {
    let tanh = (value / scale).tanh();
    let first = (1.0 - tanh * tanh) / scale;
    let second = -2.0 * tanh * first / scale;
    let hessian = std::array::from_fn(|p| first * h[p] + second * g[PACKED[p].0] * g[PACKED[p].1]);
    (tanh, g.map(|g| first * g), hessian)
}

/// Jet of a product.
fn product((v, g, h): Jet, (w, k, m): Jet) -> Jet {
    let hessian = std::array::from_fn(|p| {
        let (a, b) = PACKED[p];
        h[p] * w + g[a] * k[b] + g[b] * k[a] + v * m[p]
    });
    (v * w, std::array::from_fn(|a| g[a] * w + v * k[a]), hessian)
}

/// Jet of first + factor second.
fn sum((v, g, h): Jet, (w, k, m): Jet, factor: f64) -> Jet {
    (v + factor * w, std::array::from_fn(|a| g[a] + factor * k[a]), std::array::from_fn(|p| h[p] + factor * m[p]))
}
