//! What is chosen of an explicit formulation.

use super::MOST_NEAREST;
use crate::field::Feasible;
use crate::{Error, Result};

/// The formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formulation {
    /// Hicken and Kaur (1) with distances to planes.
    HickenKaurLinear,
    /// Hicken and Kaur (1) with distances to paraboloids of the principal curvatures.
    HickenKaurQuadratic,
    /// Lin et al. 2022, reconstructed: distances to planes under weights that fall by a power of the distance.
    Lin,
    /// The distance to the plane at the nearest point, after Criado Risco et al. 2023.
    NearestPlane,
    /// The distance to the nearest points, after Bergeles et al. 2015.
    NearestPoint,
}

impl Formulation {
    /// Whether the value is of some nearest points in any case.
    pub(super) fn is_of_nearest(self) -> bool {
        matches!(self, Formulation::NearestPlane | Formulation::NearestPoint)
    }

    /// Whether rho counts.
    pub(super) fn has_smoothing(self) -> bool {
        matches!(self, Formulation::HickenKaurLinear | Formulation::HickenKaurQuadratic)
    }
}

/// What an [`Explicit`](super::Explicit) is made with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExplicitOptions {
    /// The formula.
    pub formulation: Formulation,
    /// k, at most 64: only the k nearest points count; 0: all, and 1 where the formula is of nearest points.
    pub nearest: usize,
    /// rho of (1), in 1 / D, in [1, 1e9]; 0: [`SMOOTHING_OF_SPACING`](super::hicken_kaur::SMOOTHING_OF_SPACING) by the spacing of the points.
    pub smoothing: f64,
    /// q of Lin's weights, in [1, 32].
    pub exponent: u32,
    /// e of Lin's weights, in units of D, in [1e-6, 1].
    pub softening: f64,
    /// Where the value is positive.
    pub feasible: Feasible,
}

impl Default for ExplicitOptions {
    /// Formula (1) as printed: linear, over all points.
    fn default() -> Self {
        ExplicitOptions {
            formulation: Formulation::HickenKaurLinear,
            nearest: 0,
            smoothing: 0.0,
            exponent: 4,
            softening: 0.01,
            feasible: Feasible::Outside,
        }
    }
}

impl ExplicitOptions {
    /// Checks the ranges.
    pub fn validate(&self) -> Result<()> {
        let wrong = |text: String| Err(Error::InvalidArgument(text));
        if self.nearest > MOST_NEAREST {
            return wrong(format!("n_nearest is {}; it must be at most {MOST_NEAREST}, and 0 means all", self.nearest));
        }
        if self.formulation == Formulation::NearestPlane && self.nearest > 1 {
            return wrong(format!("n_nearest is {}; the plane at the nearest point takes 0 or 1", self.nearest));
        }
        if self.smoothing != 0.0 && !(1.0..=1e9).contains(&self.smoothing) {
            let text =
                format!("smoothing is {}; it must lie in [1, 1e9], or be 0 for the points' spacing", self.smoothing);
            return wrong(text);
        }
        if !(1..=32).contains(&self.exponent) {
            return wrong(format!("exponent is {}; it must lie in [1, 32]", self.exponent));
        }
        if !(1e-6..=1.0).contains(&self.softening) {
            return wrong(format!("softening is {}; it must lie in [1e-6, 1]", self.softening));
        }
        Ok(())
    }

    /// How many nearest points count; `None`: all.
    pub(super) fn n_nearest(&self) -> Option<usize> {
        match self.nearest {
            0 => self.formulation.is_of_nearest().then_some(1),
            k => Some(k),
        }
    }
}
