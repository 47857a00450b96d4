//! What slices and level sets ask of a function: values and gradients at many points at once.

use super::level_set::LatticeBlocks;
use super::{Field, Outputs};
use crate::Result;
use crate::par::Workers;

/// A continuously differentiable function of D coordinates that may be asked from several threads at once.
pub trait Function<const D: usize>: Sync {
    /// Values `[n]` at `points` [n x D], on the caller's thread.
    fn values(&self, points: &[[f64; D]], values: &mut [f64]) -> Result<()>;

    /// Values `[n]` and gradients [n x D] at `points` [n x D], on the caller's thread.
    fn gradients(&self, points: &[[f64; D]], values: &mut [f64], gradients: &mut [[f64; D]]) -> Result<()>;

    /// Marks the blocks of a lattice on the function's box in which it may be `level`; all where nothing is known. `tell` is told the
    /// fraction done, and may stop.
    fn mark_blocks(
        &self,
        _level: f64,
        blocks: &LatticeBlocks<D>,
        _workers: &Workers,
        _tell: &mut dyn FnMut(f64) -> Result<()>,
    ) -> Result<()> {
        blocks.mark_all();
        Ok(())
    }
}

impl<const D: usize> Function<D> for Field<D> {
    fn values(&self, points: &[[f64; D]], values: &mut [f64]) -> Result<()> {
        self.eval(points, Outputs { values: Some(values), ..Outputs::default() })
    }

    fn gradients(&self, points: &[[f64; D]], values: &mut [f64], gradients: &mut [[f64; D]]) -> Result<()> {
        self.eval(points, Outputs { values: Some(values), gradients: Some(gradients), hessians: None })
    }

    fn mark_blocks(
        &self,
        level: f64,
        blocks: &LatticeBlocks<D>,
        workers: &Workers,
        tell: &mut dyn FnMut(f64) -> Result<()>,
    ) -> Result<()> {
        self.mark_level(level, blocks, workers, tell)
    }
}
