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

    /// Smooths x with the residual r = b - A x at hand, which stays at hand only where it is kept.
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
        let bottom = try_vec(coarsest.n_unknowns(), 0.0, "the coarsest level")?;
        Ok(Multigrid { levels, coarsest, bottom })
    }

    /// The finest level.
    pub fn finest(&mut self) -> &mut L {
        &mut self.levels[0].0
    }

    /// z = M r, M the V-cycle from zero.
    pub fn cycle(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        self.levels[0].1.r.copy_from_slice(r);
        cycle(&mut self.levels, &self.coarsest, &mut self.bottom, workers);
        z.copy_from_slice(&self.levels[0].1.x);
    }
}

/// The x of the first of `levels` from its r.
fn cycle<L: Level>(levels: &mut [(L, Smoother)], coarsest: &Cholesky, bottom: &mut [f64], workers: &Workers) {
    let Some(((level, smoother), below)) = levels.split_first_mut() else { return };
    smoother.x.fill(0.0);
    smoother.smooth(level, workers, Residual::Kept);
    smoother.z.fill(0.0);
    if below.is_empty() {
        level.restrict(workers, &smoother.r, bottom);
        coarsest.solve(bottom);
        level.prolong_add(workers, bottom, &mut smoother.z);
    } else {
        level.restrict(workers, &smoother.r, &mut below[0].1.r);
        cycle(below, coarsest, bottom, workers);
        level.prolong_add(workers, &below[0].1.x, &mut smoother.z);
    }
    update(workers, &mut smoother.x, &smoother.z, |z, x| x + z);
    level.apply(workers, &smoother.z, &mut smoother.az);
    update(workers, &mut smoother.r, &smoother.az, |az, r| r - az);
    smoother.smooth(level, workers, Residual::Spent);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::cg;

    /// Second differences on 2^k - 1 points, halved; B is the inverse of the diagonal.
    struct Line(usize);

    impl Level for Line {
        fn n_unknowns(&self) -> usize {
            self.0
        }

        fn apply(&mut self, _: &Workers, x: &[f64], y: &mut [f64]) {
            // 1 / h, so that linear interpolation makes each level's matrix from the one above.
            let h = 1.0 / (self.0 + 1) as f64;
            let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
            y.iter_mut().enumerate().for_each(|(i, y)| *y = (2.0 * x[i] - at(i.wrapping_sub(1)) - at(i + 1)) / h);
        }

        fn invert_locally(&mut self, _: &Workers, r: &[f64], z: &mut [f64]) {
            let h = 1.0 / (self.0 + 1) as f64;
            z.iter_mut().zip(r).for_each(|(z, r)| *z = 0.5 * h * r);
        }

        fn restrict(&mut self, _: &Workers, fine: &[f64], coarse: &mut [f64]) {
            for (j, c) in coarse.iter_mut().enumerate() {
                *c = 0.5 * fine[2 * j] + fine[2 * j + 1] + 0.5 * fine[2 * j + 2];
            }
        }

        fn prolong_add(&mut self, _: &Workers, coarse: &[f64], fine: &mut [f64]) {
            for (j, c) in coarse.iter().enumerate() {
                (0..3).for_each(|k| fine[2 * j + k] += [0.5, 1.0, 0.5][k] * c);
            }
        }
    }

    fn hierarchy(n: usize) -> Multigrid<Line> {
        let workers = Workers::caller_only();
        let sizes = std::iter::successors(Some(n), |n| Some(n / 2)).take_while(|n| *n > 3);
        let levels: Vec<_> = sizes
            .map(|n| {
                let mut level = Line(n);
                let smoother = Smoother::new(&mut level, &workers).unwrap();
                (level, smoother)
            })
            .collect();
        // Second differences on three points.
        Multigrid::new(levels, Cholesky::new(3, vec![8.0, -4.0, 8.0, 0.0, -4.0, 8.0], 0.0)).unwrap()
    }

    impl cg::System for Multigrid<Line> {
        fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
            self.finest().apply(workers, x, y);
        }

        fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
            self.cycle(workers, r, z);
        }
    }

    #[test]
    fn iterations_do_not_grow_with_the_grid() {
        for n in [7, 63, 1023, 16_383] {
            let b: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
            let stop = cg::Stop { tolerance: 1e-10, max_iterations: 100, patience: None };
            let workers = Workers::caller_only();
            let (_, done) = cg::solve(&mut hierarchy(n), &b, vec![0.0; n], stop, &workers, |_, _| Ok(())).unwrap();
            assert!(done.iterations <= 12, "{n}: {}", done.iterations);
        }
    }

    #[test]
    fn a_cycle_is_symmetric_and_positive() {
        let (mut multigrid, workers) = (hierarchy(63), Workers::caller_only());
        let vector = |f: f64| -> Vec<f64> { (0..63).map(|i| (i as f64 * f).sin()).collect() };
        let (x, y) = (vector(0.9), vector(2.3));
        let (mut mx, mut my) = (vec![0.0; 63], vec![0.0; 63]);
        multigrid.cycle(&workers, &x, &mut mx);
        multigrid.cycle(&workers, &y, &mut my);
        assert!((dot(&workers, &x, &my) - dot(&workers, &y, &mx)).abs() < 1e-14);
        assert!(dot(&workers, &x, &mx) > 0.0 && dot(&workers, &y, &my) > 0.0);
    }
}
