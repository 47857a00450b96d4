//! What slices and level sets ask of a function: values and gradients at many points at once.

use super::level_set::Blocks;
use super::{Field, Outputs};
use crate::Result;
use crate::par::Workers;

/// A continuously differentiable function of D coordinates that may be asked from several threads at once.
pub trait Function<const D: usize>: Sync {
    /// Values `[n]` at `points` [n x D], on the caller's thread.
    fn values(&self, points: &[[f64; D]], values: &mut [f64]) -> Result<()>;

    /// Values `[n]` and gradients [n x D] at `points` [n x D], on the caller's thread.
    fn gradients(&self, points: &[[f64; D]], values: &mut [f64], gradients: &mut [[f64; D]]) -> Result<()>;

    /// Marks the blocks of a lattice on the function's box in which it may be `level`; all where nothing is known.
    fn mark_blocks(&self, _level: f64, blocks: &Blocks<D>, _workers: &Workers) {
        blocks.mark_all();
    }
}

impl<const D: usize> Function<D> for Field<D> {
    fn values(&self, points: &[[f64; D]], values: &mut [f64]) -> Result<()> {
        self.eval(points, Outputs { values: Some(values), ..Outputs::default() })
    }

    fn gradients(&self, points: &[[f64; D]], values: &mut [f64], gradients: &mut [[f64; D]]) -> Result<()> {
        self.eval(points, Outputs { values: Some(values), gradients: Some(gradients), hessians: None })
    }

    fn mark_blocks(&self, level: f64, blocks: &Blocks<D>, workers: &Workers) {
        self.mark_level(level, blocks, workers);
    }
}
