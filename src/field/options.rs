//! What a fit can be asked for.

use super::energy::EnergyWeights;
use crate::{Error, Result};

/// The side of the surface on which the design may be, where phi > 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feasible {
    /// The side that the normals point to: grad phi = +n on the surface.
    Outside,
    /// The other side: grad phi = -n on the surface, the sign of paper 000 (6).
    Inside,
}

impl Feasible {
    /// Sign of grad phi . n on the surface.
    pub fn sign(self) -> f64 {
        match self {
            Feasible::Outside => 1.0,
            Feasible::Inside => -1.0,
        }
    }
}

/// What rounds of reweighting are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reweighting {
    /// Points that the surface misses count for more: against the largest error, for clouds to be trusted. See
    /// [`reweight`](super::reweight).
    Largest,
    /// Points that disagree with the others count for less, at last for nothing: against noise, outliers and wrong normals. See
    /// [`robust`](super::robust).
    Robust,
    /// None: each point counts as it did in the field that a refit starts from, which was fitted to as many, in the same order; distances
    /// are held where they were, to the points that were nearest, and D stays. One solve, and the field that [`sensitivity`](super::sensitivity) has the derivatives of.
    Kept,
}

/// Rounds of reweighting that a fit may be asked for; a few are all that help.
const MOST_REWEIGHTINGS: u32 = 100;

/// Options of [`Field::fit`](super::Field::fit). All weights are dimensionless, with lengths in units of the cloud's diagonal D.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// Control points along x, y, z, the last ignored in the plane, at least 4 each; 0 lets the fit choose: see [`domain`](super::domain).
    pub control_points: [u32; 3],
    /// How much longer than the cloud the box is along each axis: 0.15 makes it 1.15 times the extents, as in paper 000, section 3.5.
    pub margin: f64,
    /// lambda_n of (10).
    pub normal_weight: f64,
    /// lambda_r of (10).
    pub smooth_weight: f64,
    /// Weight of the distance energy (9) away from the surface, in units of lambda_r / h^4, h the longest cell edge: see
    /// [`distance`](super::distance). 0 is the paper's fit.
    pub distance_weight: f64,
    /// What the rounds of reweighting are for.
    pub reweighting: Reweighting,
    /// Rounds in which points are weighted anew. 0 is the paper's fit; a robust one weighs them once all the same. Refinement cuts cells
    /// instead, and reweights only points that are missed where it can cut no more.
    pub reweightings: u32,
    /// Largest error on the surface, in D, until which cells are refined where it is larger: see `field::refined`. 0: one grid.
    pub max_error: f64,
    /// Control points that refinement may take.
    pub max_unknowns: u64,
    /// Side where phi > 0.
    pub feasible: Feasible,
    /// Relative residual of the solve to reach.
    pub tolerance: f64,
    /// Iterations after which not having reached it is an error.
    pub max_iterations: u32,
    /// Threads: 0 for all cores, 1 for none but the caller's.
    pub n_threads: u32,
    /// Bytes that the fit may take; more is refused beforehand.
    pub memory_limit: u64,
}

impl Default for FitOptions {
    /// The weights come from a sweep over several shapes: docs/weights.md.
    fn default() -> Self {
        FitOptions {
            control_points: [0; 3],
            margin: 0.15,
            normal_weight: 1e-4,
            smooth_weight: 3e-10,
            distance_weight: 150.0,
            reweighting: Reweighting::Largest,
            reweightings: 3,
            max_error: 0.0,
            max_unknowns: 2_000_000,
            feasible: Feasible::Outside,
            tolerance: 1e-4,
            max_iterations: 20_000,
            n_threads: 0,
            memory_limit: 8 << 30,
        }
    }
}

impl FitOptions {
    /// The weights of the energy's terms.
    pub(super) fn weights(&self) -> EnergyWeights {
        EnergyWeights { normal: self.normal_weight, smooth: self.smooth_weight }
    }

    /// Checks every range.
    pub fn validate<const D: usize>(&self) -> Result<()> {
        let wrong = |text: String| Err(Error::InvalidArgument(text));
        for (axis, &n) in ["x", "y", "z"].iter().zip(&self.control_points).take(D) {
            if n != 0 && n < 4 {
                return wrong(format!(
                    "control_points along {axis} is {n}; a cubic needs at least 4, and 0 lets the fit choose"
                ));
            }
        }
        let ranges = [
            ("margin", self.margin, 0.0, 100.0),
            ("lambda_normal", self.normal_weight, 1e-12, 1e12),
            ("lambda_smooth", self.smooth_weight, 1e-20, 1e12),
            ("distance_weight", self.distance_weight, 0.0, 1e6),
            ("tolerance", self.tolerance, 1e-15, 0.5),
        ];
        for (name, value, low, high) in ranges {
            // A NaN is in no range.
            if !(low..=high).contains(&value) {
                return wrong(format!("{name} is {value}; it must lie in [{low:e}, {high:e}]"));
            }
        }
        if self.reweightings > MOST_REWEIGHTINGS {
            return wrong(format!("reweightings is {}; it must be at most {MOST_REWEIGHTINGS}", self.reweightings));
        }
        if self.max_error != 0.0 && !(1e-9..=1.0).contains(&self.max_error) {
            let e = self.max_error;
            return wrong(format!("max_error is {e}; it must be 0, for one grid, or lie in [1e-9, 1], in units of D"));
        }
        if self.max_unknowns == 0 {
            return wrong("max_unknowns is 0; at least 1 is needed".into());
        }
        if self.max_iterations == 0 {
            return wrong("max_iterations is 0; at least 1 is needed".into());
        }
        Ok(())
    }
}
