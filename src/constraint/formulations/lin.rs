//! Lin et al. 2022, reconstructed from what paper 000 tells of it (section 2.1): distances to the planes of a cloud under weights that fall
//! by a power of the distance to its points, w_i = (Delta_i^2 + e^2)^(-q / 2), smooth everywhere.
//!
//! Paper 000 prints no formula, and we have not seen theirs: comparisons are to be read as trends. In space weights of q <= 2 do not fall
//! faster than a surface grows: far points count as much as near ones.

use super::terms::{LANES, Lanes, Weigh};
use crate::isa::Isa;

/// Weights of Lin's formula.
#[derive(Debug, Clone, Copy)]
pub(super) struct Power {
    /// q
    pub exponent: u32,
    /// e^2, in the caller's unit of length squared.
    pub softening_squared: f64,
}

impl Weigh for Power {
    #[inline(always)]
    fn weigh<I: Isa>(self, squared: &Lanes, least: f64) -> [Lanes; 2] {
        let (mut w, mut c) = ([1.0; LANES], [0.0; LANES]);
        // Relative to the nearest point's, so that no weight overflows and their sum is at least 1.
        let mut power = [0.0; LANES];
        for lane in 0..LANES {
            let soft = squared[lane] + self.softening_squared;
            power[lane] = (least + self.softening_squared) / soft;
            c[lane] = -f64::from(self.exponent) / soft;
        }
        let mut bits = self.exponent / 2;
        if !self.exponent.is_multiple_of(2) {
            power = power.map(f64::sqrt);
            bits = self.exponent;
        }
        while bits > 0 {
            for lane in 0..LANES {
                w[lane] *= if bits & 1 == 1 { power[lane] } else { 1.0 };
                power[lane] *= power[lane];
            }
            bits >>= 1;
        }
        [w, c]
    }
}
