//! What an estimate of normals can be asked for, and what it tells.

use crate::par::Workers;
use crate::{Error, Result};

/// Neighbours that an estimate takes at most: more smooth every edge away.
const MOST_NEIGHBOURS: u32 = 64;

/// Options of [`Cloud::with_estimated_normals`](crate::geometry::Cloud::with_estimated_normals).
#[derive(Debug, Clone, PartialEq)]
pub struct NormalOptions {
    /// k: nearest neighbours that a normal is taken from; 0 for 10 in space and 4 in the plane. More smooth noise, and edges with it.
    pub neighbours: u32,
    /// A point whose mean distance to its neighbours is this many times the median of theirs is named an outlier.
    pub outlier_factor: f64,
    /// Threads: 0 for all cores, 1 for none but the caller's.
    pub n_threads: u32,
    /// Bytes that the estimate may take; more is refused beforehand.
    pub memory_limit: u64,
}

impl Default for NormalOptions {
    /// k from the measurement in [`super`]; the outlier factor names no sample of the test data's meshes, noise of 0.001 D included.
    fn default() -> Self {
        NormalOptions { neighbours: 0, outlier_factor: 2.5, n_threads: 0, memory_limit: 8 << 30 }
    }
}

impl NormalOptions {
    /// Checks every range.
    pub fn validate(&self) -> Result<()> {
        let wrong = |text: String| Err(Error::InvalidArgument(text));
        // D neighbours and the point make D + 1 points: fewer fit every plane.
        if self.neighbours != 0 && !(3..=MOST_NEIGHBOURS).contains(&self.neighbours) {
            return wrong(format!(
                "neighbours is {}; it must lie in [3, {MOST_NEIGHBOURS}], and 0 lets the estimate choose",
                self.neighbours
            ));
        }
        if self.outlier_factor.is_nan() || self.outlier_factor <= 1.0 {
            return wrong(format!("outlier_factor is {}; it must be above 1", self.outlier_factor));
        }
        Workers::check(self.n_threads)
    }

    /// k for `n` places in D dimensions: from a measurement, see [`super`].
    pub(super) fn k<const D: usize>(&self, n: usize) -> usize {
        let k = match (self.neighbours, D) {
            (0, 2) => 4,
            (0, _) => 10,
            (k, _) => k as usize,
        };
        k.min(n.saturating_sub(1))
    }
}

/// What an estimate of normals found. Indices are the caller's, ascending.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalReport {
    /// Parts that neighbours connect; each has a sign of its own.
    pub n_components: usize,
    /// Points at the very place of an earlier one, whose normal they share.
    pub copies: Vec<u32>,
    /// Points far from their neighbours, for how near those are to theirs: see [`NormalOptions::outlier_factor`].
    pub outliers: Vec<u32>,
    /// Points of a line: no plane could be told, and the normal is one of many.
    pub degenerate: Vec<u32>,
    /// Points whose neighbours ask, in sum, for the other sign.
    pub doubtful: Vec<u32>,
    /// Of what all pairs of neighbours ask for, by weight, the fraction that the signs meet: 1 is all. Below 0.9, look at the result.
    pub agreement: f64,
    /// Wall time.
    pub seconds: f64,
}
