//! Preconditioned conjugate gradients (Hestenes and Stiefel 1952; Saad 2003, algorithm 9.1).
//!
//! Notation: A the operator, M the preconditioner, r = b - A x, z = M r, p the direction, rho = r . z.

use super::vector::{dot, norm, update};
use crate::error::{try_reserve, try_vec};
use crate::par::Workers;
use crate::{Error, Result};

/// A symmetric positive definite system with its preconditioner.
pub trait System {
    /// y = A x, both `[n]`.
    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]);

    /// z = M r, both `[n]`: M symmetric positive definite, close to the inverse of A.
    fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]);
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// Relative residual |b - A x| / |b| to reach.
    pub tolerance: f64,
    /// Iterations after which not having reached it is an error.
    pub max_iterations: usize,
    /// Iterations that are worth waiting for: where more seem to be left the solve ends with what it has. `None` waits for all.
    pub patience: Option<usize>,
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Iterations done.
    pub iterations: usize,
    /// Relative residual |b - A x| / |b|, computed from x; above the tolerance where patience ended.
    pub residual: f64,
    /// Mean factor by which an iteration lowered it.
    pub rate: f64,
}

/// How fast residuals fall, by those of the last half of the iterations.
struct Pace {
    residuals: Vec<f64>,
}

impl Pace {
    /// Iterations between looks.
    const LOOK: usize = 16;

    /// Whether more iterations than `patience` seem to be left to `tolerance` after one that reached `residual`.
    fn is_slow(&mut self, residual: f64, tolerance: f64, patience: Option<usize>) -> Result<bool> {
        let Some(patience) = patience else { return Ok(false) };
        try_reserve(&mut self.residuals, 1, "the residuals of the solve")?;
        self.residuals.push(residual);
        let n = self.residuals.len();
        if !n.is_multiple_of(Pace::LOOK) {
            return Ok(false);
        }
        let fall = (self.residuals[n / 2] / residual).ln() / (n - 1 - n / 2) as f64;
        // A NaN, where residuals do not fall at all, is no number of iterations to wait for either.
        let waits = (residual / tolerance).ln() <= fall * patience as f64;
        Ok(!waits)
    }
}

/// Solves A x = b from the `x` given; `observe(iterations, residual)` is called once an iteration and may stop the solve with its error.
///
/// The residual that the recurrence carries drifts from b - A x by rounding. It decides when to look; the true one decides whether the
/// solve is done, and restarts the recurrence where it is not.
pub fn solve(
    system: &mut impl System,
    b: &[f64],
    mut x: Vec<f64>,
    stop: Stop,
    workers: &Workers,
    mut observe: impl FnMut(usize, f64) -> Result<()>,
) -> Result<(Vec<f64>, Convergence)> {
    let n = b.len();
    let vector = || try_vec(n, 0.0, "a vector of the solve");
    let (mut r, mut z, mut p, mut ap) = (vector()?, vector()?, vector()?, vector()?);
    let b_norm = norm(workers, b);
    let mut done = Convergence { iterations: 0, residual: 0.0, rate: 0.0 };
    if b_norm == 0.0 {
        x.fill(0.0);
        return Ok((x, done));
    }
    let (mut first, mut pace) = (None, Pace { residuals: Vec::new() });
    let mut impatient = false;
    loop {
        system.apply(workers, &x, &mut ap);
        r.copy_from_slice(b);
        update(workers, &mut r, &ap, |ap, r| r - ap);
        done.residual = norm(workers, &r) / b_norm;
        let first = *first.get_or_insert(done.residual);
        if done.iterations > 0 {
            done.rate = (done.residual / first).powf(1.0 / done.iterations as f64);
        }
        if done.residual <= stop.tolerance || impatient && done.residual.is_finite() {
            return Ok((x, done));
        }
        if done.iterations >= stop.max_iterations || !done.residual.is_finite() {
            let Convergence { iterations, residual, .. } = done;
            return Err(Error::NotConverged { iterations, residual, tolerance: stop.tolerance });
        }
        let mut rho = f64::INFINITY;
        // Written so that a NaN ends the loop too.
        while done.residual > stop.tolerance && done.iterations < stop.max_iterations && !impatient {
            system.precondition(workers, &r, &mut z);
            let rho_next = dot(workers, &r, &z);
            let beta = rho_next / rho;
            rho = rho_next;
            update(workers, &mut p, &z, |z, p| z + beta * p);
            system.apply(workers, &p, &mut ap);
            let alpha = rho / dot(workers, &p, &ap);
            update(workers, &mut x, &p, |p, x| x + alpha * p);
            update(workers, &mut r, &ap, |ap, r| r - alpha * ap);
            done.iterations += 1;
            done.residual = norm(workers, &r) / b_norm;
            observe(done.iterations, done.residual)?;
            impatient = pace.is_slow(done.residual, stop.tolerance, stop.patience)?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second-difference matrix plus a diagonal, preconditioned by its diagonal.
    struct Laplacian;

    impl System for Laplacian {
        fn apply(&mut self, _: &Workers, x: &[f64], y: &mut [f64]) {
            for i in 0..x.len() {
                let left = if i > 0 { x[i - 1] } else { 0.0 };
                let right = x.get(i + 1).copied().unwrap_or(0.0);
                y[i] = (2.0 + i as f64) * x[i] - left - right;
            }
        }

        fn precondition(&mut self, _: &Workers, r: &[f64], z: &mut [f64]) {
            z.iter_mut().enumerate().for_each(|(i, z)| *z = r[i] / (2.0 + i as f64));
        }
    }

    fn run(b: &[f64], tolerance: f64, max_iterations: usize, n_threads: u32) -> Result<(Vec<f64>, Convergence)> {
        let workers = Workers::new(n_threads).unwrap();
        solve(
            &mut Laplacian,
            b,
            vec![0.0; b.len()],
            Stop { tolerance, max_iterations, patience: None },
            &workers,
            |_, _| Ok(()),
        )
    }

    #[test]
    fn reaches_the_residual_that_it_reports_at_every_small_size() {
        for n in [0, 1, 2, 3, 17, 100] {
            let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let (x, done) = run(&b, 1e-12, 1000, 1).unwrap();
            let mut ax = vec![0.0; n];
            Laplacian.apply(&Workers::caller_only(), &x, &mut ax);
            let residual = b.iter().zip(&ax).map(|(b, a)| (b - a).powi(2)).sum::<f64>().sqrt();
            assert!(residual <= 1e-12 * b.iter().map(|b| b * b).sum::<f64>().sqrt());
            assert!(done.residual <= 1e-12);
        }
    }

    #[test]
    fn stopping_short_is_an_error_with_the_residual_reached() {
        let error = run(&[1.0; 100], 1e-12, 3, 1).unwrap_err();
        assert!(matches!(error, Error::NotConverged { iterations: 3, residual, .. } if residual > 1e-12));
    }

    #[test]
    fn an_unreachable_tolerance_ends_in_an_error() {
        assert!(matches!(run(&[1.0; 100], 1e-30, 500, 1), Err(Error::NotConverged { .. })));
    }

    #[test]
    fn the_number_of_threads_does_not_change_a_bit() {
        let b: Vec<f64> = (0..30_000).map(|i| (i as f64 * 0.1).sin()).collect();
        let one = run(&b, 1e-10, 1000, 1).unwrap();
        assert_eq!(one, run(&b, 1e-10, 1000, 2).unwrap());
        assert_eq!(one, run(&b, 1e-10, 1000, 3).unwrap());
    }

    #[test]
    fn impatience_ends_a_slow_solve_with_what_it_has_and_leaves_a_fast_one_alone() {
        /// The second-difference matrix: as many iterations as unknowns.
        struct Slow;

        impl System for Slow {
            fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
                Laplacian.apply(workers, x, y);
                y.iter_mut().zip(x).enumerate().for_each(|(i, (y, x))| *y -= i as f64 * x);
            }

            fn precondition(&mut self, _: &Workers, r: &[f64], z: &mut [f64]) {
                z.copy_from_slice(r);
            }
        }

        let b: Vec<f64> = (0..100).map(|i| (i as f64).sin()).collect();
        let with = |patience| {
            let stop = Stop { tolerance: 1e-10, max_iterations: 10_000, patience };
            solve(&mut Slow, &b, vec![0.0; b.len()], stop, &Workers::caller_only(), |_, _| Ok(())).unwrap().1
        };
        let patient = with(None);
        assert!(patient.residual <= 1e-10 && patient.iterations > 2 * Pace::LOOK);
        assert!(patient.rate > 0.0 && patient.rate < 1.0);
        let impatient = with(Some(1));
        assert!(impatient.iterations == Pace::LOOK && impatient.residual > 1e-10, "{impatient:?}");
    }

    #[test]
    fn a_residual_that_is_no_number_is_an_error_whoever_is_impatient() {
        /// A preconditioner that breaks down when patience is asked for the first time.
        struct Breaking(usize);

        impl System for Breaking {
            fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
                Laplacian.apply(workers, x, y);
            }

            fn precondition(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
                self.0 += 1;
                Laplacian.precondition(workers, r, z);
                z[0] *= if self.0 == Pace::LOOK { f64::NAN } else { 1.0 };
            }
        }

        for patience in [None, Some(1000)] {
            let stop = Stop { tolerance: 1e-30, max_iterations: 100, patience };
            let end = solve(&mut Breaking(0), &[1.0; 50], vec![0.0; 50], stop, &Workers::caller_only(), |_, _| Ok(()));
            assert!(matches!(end, Err(Error::NotConverged { iterations: Pace::LOOK, .. })), "{end:?}");
        }
    }

    #[test]
    fn an_observer_stops_the_solve() {
        let workers = Workers::caller_only();
        let stop = Stop { tolerance: 1e-12, max_iterations: 1000, patience: None };
        let stopped = solve(&mut Laplacian, &[1.0; 50], vec![0.0; 50], stop, &workers, |i, _| {
            if i == 2 { Err(Error::Cancelled) } else { Ok(()) }
        });
        assert_eq!(stopped.unwrap_err(), Error::Cancelled);
    }
}
