//! A V-cycle with Chebyshev smoothing, as a preconditioner (Briggs, Henson and McCormick 2000; Lottes 2022 for the polynomial).
//!
//! Notation: A the operator of a level, B its local inverse, cheap and close to that of A on what no coarser level can express, lambda the
//! largest eigenvalue of B A, P the prolongation from the next coarser level, on which the operator is P^T A P or close to it.
//!
//! Chebyshev polynomials of the fourth kind need no lower end of the spectrum to smooth: theirs is the best bound for a V-cycle of all
//! polynomials of their degree without it.

use super::dense::Cholesky;
use super::vector::{dot, update};
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;

/// One level of a hierarchy, from the finest on.
pub trait Level {
    /// Unknowns.
    fn n_unknowns(&self) -> usize;

    /// y = A x, both `[n]`.
    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]);

    /// z = B r, both `[n]`: B symmetric positive definite.
    fn invert_locally(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]);

    /// coarse = P^T fine
    fn restrict(&mut self, workers: &Workers, fine: &[f64], coarse: &mut [f64]);

    /// fine += P coarse
    fn prolong_add(&mut self, workers: &Workers, coarse: &[f64], fine: &mut [f64]);
}

/// What the smoothing of a level needs.
pub struct Smoother {
    /// lambda, or a little more
    largest: f64,
    /// The iterate, the residual, the step and its image, each [n].
    x: Vec<f64>,
    r: Vec<f64>,
    z: Vec<f64>,
    az: Vec<f64>,
}

/// What an estimate of lambda from below is multiplied with.
const SAFETY: f64 = 1.1;

/// Steps of that estimate.
const POWER_STEPS: usize = 6;

/// Degree of the polynomial.
const DEGREE: usize = 2;

impl Smoother {
    /// For `level`.
    pub fn new(level: &mut impl Level, workers: &Workers) -> Result<Self> {
        let vector = || try_vec(level.n_unknowns(), 0.0, "the vectors of the multigrid");
        let mut smoother = Smoother { largest: 0.0, x: vector()?, r: vector()?, z: vector()?, az: vector()? };
        smoother.largest = SAFETY * smoother.estimate_largest(level, workers);
        Ok(smoother)
    }

    /// The power method on B A.
    fn estimate_largest(&mut self, level: &mut impl Level, workers: &Workers) -> f64 {
        // Signs that alternate in no pattern of the grid's.
        for (i, z) in self.z.iter_mut().enumerate() {
            let hash = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33;
            *z = if hash & 1 == 0 { 1.0 } else { -1.0 };
        }
        let mut largest = 0.0;
        for _ in 0..POWER_STEPS {
            level.apply(workers, &self.z, &mut self.az);
            level.invert_locally(workers, &self.az, &mut self.x);
            // The Rayleigh quotient in the inner product of A.
            largest = dot(workers, &self.az, &self.x) / dot(workers, &self.z, &self.az);
            self.z.copy_from_slice(&self.x);
        }
        largest
    }

    /// Smooths x with the residual r = b - A x at hand, which is that of the new x only where it is `kept`.
    fn smooth(&mut self, level: &mut impl Level, workers: &Workers, residual: Residual) {
        for k in 1..=DEGREE {
            let k_real = k as f64;
            let old = (2.0 * k_real - 3.0) / (2.0 * k_real + 1.0);
            let new = (8.0 * k_real - 4.0) / (2.0 * k_real + 1.0) / self.largest;
            level.invert_locally(workers, &self.r, &mut self.az);
            update(workers, &mut self.z, &self.az, |b, z| if k == 1 { new * b } else { old * z + new * b });
            update(workers, &mut self.x, &self.z, |z, x| x + z);
            if k < DEGREE || residual == Residual::Kept {
                level.apply(workers, &self.z, &mut self.az);
                update(workers, &mut self.r, &self.az, |az, r| r - az);
            }
        }
    }
}

/// Whether a residual is wanted after smoothing.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Residual {
    Kept,
    Spent,
}

/// A hierarchy with its smoothers; the coarsest level is solved.
pub struct Multigrid<L> {
    /// From the finest on.
    levels: Vec<(L, Smoother)>,
    coarsest: Cholesky,
    /// Right-hand side and solution of the coarsest level.
    bottom: Vec<f64>,
}

impl<L: Level> Multigrid<L> {
    /// Of the `levels` from the finest on, above one of which the Cholesky factor is `coarsest`.
    pub fn new(levels: Vec<(L, Smoother)>, coarsest: Cholesky) -> Result<Self> {
        let bottom = try_vec(coarsest.len(), 0.0, "the coarsest level")?;
        Ok(Multigrid { levels, coarsest, bottom })
    }

    /// The finest level.
    pub fn finest(&mut self) -> &mut L {
        &mut self.levels[0].0
    }

    /// z = M r, M the V-cycle from zero.
    pub fn cycle(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        self.levels[0].1.r.copy_from_slice(r);
        self.cycle_from(0, workers);
        z.copy_from_slice(&self.levels[0].1.x);
    }

    /// Level `l`'s x from its r.
    fn cycle_from(&mut self, l: usize, workers: &Workers) {
        let (level, smoother) = &mut self.levels[l];
        smoother.x.fill(0.0);
        smoother.smooth(level, workers, Residual::Kept);
        match self.levels.get_mut(l..l + 2) {
            Some([(level, smoother), (_, below)]) => {
                level.restrict(workers, &smoother.r, &mut below.r);
                self.cycle_from(l + 1, workers);
                let [(level, smoother), (_, below)] = &mut self.levels[l..l + 2] else { unreachable!() };
                smoother.z.fill(0.0);
                level.prolong_add(workers, &below.x, &mut smoother.z);
            }
            _ => {
                let (level, smoother) = &mut self.levels[l];
                level.restrict(workers, &smoother.r, &mut self.bottom);
                self.coarsest.solve(&mut self.bottom);
                smoother.z.fill(0.0);
                level.prolong_add(workers, &self.bottom, &mut smoother.z);
            }
        }
        let (level, smoother) = &mut self.levels[l];
        update(workers, &mut smoother.x, &smoother.z, |z, x| x + z);
        level.apply(workers, &smoother.z, &mut smoother.az);
        update(workers, &mut smoother.r, &smoother.az, |az, r| r - az);
        smoother.smooth(level, workers, Residual::Spent);
    }
}
