//! Hicken and Kaur 2022, paper 000 (1): distances to the planes of a cloud under weights that fall exponentially with the distance to its
//! points, w_i = exp(-rho (Delta_i - Delta_min) / D).
//!
//! Delta_min keeps the exponents at or below 0 and cancels out, of derivatives too. The paper calls (1) differentiable; it is, but at the
//! points of the cloud: Delta_i has a kink there, and the gradient jumps by up to 2 rho a_i |phi| / D with a_i = w_i / sum w_j, the gradient
//! given being the mean of opposite sides'.

use super::terms::{LANES, Lanes, Weigh};
use crate::Result;
use crate::constraint::exponential::exp_of_negative;
use crate::error::try_with_capacity;
use crate::geometry::Cloud;
use crate::geometry::neighbours::{Neighbour, Neighbours};
use crate::isa::Isa;

/// rho h / D, h the spacing of the points, where rho is not given. On spheres and tori the linear form's RMS error is then 1.2 to 1.35 times
/// that of the nearest plane, and falls with h alike; with 4 it is 2.5 times as large, and with 20, 1.03 times, of ever sharper bends.
pub const SMOOTHING_OF_SPACING: f64 = 8.0;

/// Weights of (1).
#[derive(Debug, Clone, Copy)]
pub(super) struct Exponential {
    /// rho / D, in 1 / the caller's unit of length.
    pub rho: f64,
}

impl Weigh for Exponential {
    #[inline(always)]
    fn weigh<I: Isa>(self, squared: &Lanes, least: f64) -> [Lanes; 2] {
        let (mut w, mut c) = ([0.0; LANES], [0.0; LANES]);
        let nearest = least.sqrt();
        for lane in 0..LANES {
            let delta = squared[lane].sqrt();
            w[lane] = exp_of_negative::<I>(-self.rho * (delta - nearest));
            // At the point itself r is 0, whatever c.
            c[lane] = if delta > 0.0 { -self.rho / delta } else { 0.0 };
        }
        [w, c]
    }
}

/// The spacing h of the cloud's points: the mean distance to the fourth nearest other point, in the plane to the second.
pub(super) fn spacing<const D: usize>(cloud: &Cloud<D>, tree: &Neighbours<D>) -> Result<f64> {
    let mut distances = try_with_capacity(cloud.len(), "the spacing of the points")?;
    for p in cloud.points() {
        let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; 5];
        // Itself among them.
        let found = tree.nearest(*p, |_| true, &mut nearest[..2 * D - 1]);
        distances.push(nearest[found - 1].distance_squared.sqrt());
    }
    Ok(distances.iter().sum::<f64>() / cloud.len() as f64)
}
