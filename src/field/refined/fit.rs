//! The fit: solve, look, cut, until the surface misses no point by more than it may.

use super::super::data::Data;
use super::super::held::Held;
use super::super::weighed::Weighed;
use super::super::{FitOptions, FitReport, reweight};
use super::cuts::{cut, marks};
use super::energy::{Holding, RefinedEnergy};
use crate::Result;
use crate::error::{Error, try_vec};
use crate::linalg::cg::{self, Stop};
use crate::linalg::vector::{norm, update};
use crate::par::Workers;
use crate::progress::Progress;
use crate::spline::hierarchical::Space;
use crate::spline::tree::Tree;
use std::time::Instant;

/// What a solve before the last lowers the residual by: what is to be seen of the errors then shows.
const ROUGH: f64 = 0.1;

/// How far phi may be from a distance that is held, in that distance: less than where its sign is wrong.
const STRAY: f64 = 0.5;

/// Distance from the surface, in cells of its own leaves, from which on distances are held. Closer than on a grid: signs are right sooner
/// beside sharp edges, and what distances bend there is refined.
const NEAREST: f64 = 0.5;

/// What points that are missed by just more than they may be are weighted with.
const MISSED: f64 = 2.0;

/// Rounds of cuts: each goes a level deeper, or wider.
const MOST_ROUNDS: u32 = 40;

/// A spline on a tree.
pub struct Spline<const D: usize> {
    /// The cells.
    pub tree: Tree<D>,
    /// Its functions.
    pub space: Space<D>,
    /// The control points, as vectors of the space have them.
    pub x: Vec<f64>,
}

/// What a fit works with.
struct Fitting<'a, 'b, const D: usize> {
    options: &'a FitOptions,
    workers: &'a Workers,
    clock: Instant,
    energy: RefinedEnergy<D>,
    /// |phi| at the points, in units of D.
    errors: Vec<f64>,
    report: &'a mut FitReport,
    progress: &'a mut Progress<'b>,
    /// The fraction of the work that is done.
    done: f64,
    /// Whether no more is to be cut: a limit left no room for all that was to be.
    full: bool,
}

/// Fits `data`, which is in the cells of the tree's grid, from `start` on: with the grid of its tree, and the spline, in units of D. Refines
/// it until the largest error is at most that of the options, or its control points or bytes reach their limit: the spline then, and what the
/// points counted for. Distances are `held` where they were, if so, and else measured. `report` gets what the fit did, but for the errors at the points. Without `max_error` nothing is refined.
pub fn fit<const D: usize>(
    start: Spline<D>,
    (data, held): (Data<D>, Option<&Held>),
    options: &FitOptions,
    workers: &Workers,
    report: &mut FitReport,
    progress: &mut Progress,
) -> Result<(Spline<D>, Weighed)> {
    let (clock, n_points) = (Instant::now(), data.xi.len());
    let mut tell = || progress.tell(0.0, "assembly");
    tell()?;
    let Spline { tree, space, mut x } = start;
    let (parts, weights, holding) = ((tree, space), options.weights(), holding(options));
    let energy = match held {
        Some(held) => RefinedEnergy::keeping(parts, data, weights, (holding, held), workers, tell)?,
        None => RefinedEnergy::new(parts, data, weights, holding, workers, tell)?,
    };
    let errors = try_vec(n_points, 0.0, "the errors at the points")?;
    let mut fitting = Fitting { options, workers, clock, energy, errors, report, progress, done: 0.05, full: false };
    fitting.energy.check_normals(workers)?;
    fitting.report.seconds_assembly += fitting.lap();

    for round in 1..=MOST_ROUNDS {
        // What comes out must be solved to the end.
        fitting.full |= round == MOST_ROUNDS;
        let mut further = None;
        if fitting.may_cut() {
            // From the start on to the end: what a solve leaves undone would be taken for errors of the cells, and cut.
            x = fitting.solve(x, round > 1, 0.3)?;
            further = fitting.refine(&x, true)?;
        }
        if further.is_none() {
            x = fitting.solve(x, false, 0.6)?;
            further = fitting.refine(&x, false)?;
        }
        for _ in 0..options.reweightings {
            if further.is_some() || !fitting.weigh_the_missed() {
                break;
            }
            x = fitting.solve(x, false, 0.6)?;
            further = fitting.refine(&x, false)?;
        }
        let Some((tree, space)) = further else { break };
        let done = fitting.done;
        let tell = || fitting.progress.tell(done, "assembly");
        x = fitting.energy.refine(tree, space, &x, workers, tell)?;
        fitting.energy.reset_weights();
        fitting.report.seconds_assembly += fitting.lap();
    }
    let Fitting { energy, report, .. } = fitting;
    report.n_levels = energy.tree().n_levels();
    report.n_unknowns = energy.space().n_active() as u64;
    report.clear_sides = energy.clear();
    let weighed = Weighed::of(energy.data(), energy.held()?)?;
    let (tree, space) = energy.into_tree();
    Ok((Spline { tree, space, x }, weighed))
}

/// How distances are held in refined fits.
pub fn holding(options: &FitOptions) -> Holding {
    Holding { weight: options.distance_weight, nearest: NEAREST, spacings: 1.0 }
}

impl<const D: usize> Fitting<'_, '_, D> {
    /// Whether cells may be cut.
    fn may_cut(&self) -> bool {
        self.options.max_error > 0.0 && !self.full
    }

    /// Tells what is done, between one piece of work and the next.
    fn tell(&mut self, stage: &str) -> Result<()> {
        self.progress.tell(self.done, stage)
    }

    /// Measures the errors of `x`, and gives the tree to go on with where some are too large, within the limits; looks for thin parts and
    /// wrong sides too, where that is wanted.
    fn refine(&mut self, x: &[f64], looks_everywhere: bool) -> Result<Option<(Tree<D>, Space<D>)>> {
        if !self.may_cut() {
            return Ok(None);
        }
        self.tell("refinement")?;
        self.energy.errors(self.workers, x, &mut self.errors)?;
        let strays = if looks_everywhere {
            self.tell("refinement")?;
            self.energy.strays(self.workers, x, self.options.feasible.sign(), STRAY)?
        } else {
            Vec::new()
        };
        let marks = marks(&self.energy, &self.errors, &strays, self.options.max_error)?;
        // As many of them, the worst first, as the limits leave room for.
        let mut n = marks.len();
        while n > 0 {
            self.tell("refinement")?;
            let mut tree = self.energy.tree().try_clone()?;
            cut(&mut tree, &marks[..n])?;
            if tree.tiles().len() == self.energy.tree().tiles().len() {
                return Ok(None);
            }
            match functions(&tree, self.errors.len(), self.options.memory_limit) {
                Ok(space) if space.n_active() as u64 <= self.options.max_unknowns => return Ok(Some((tree, space))),
                Ok(_) | Err(Error::OutOfMemory { limit: Some(_), .. }) => (n, self.full) = (n / 2, true),
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// Makes points count for more that the surface misses though no cells can be cut there; whether there are any. Where a limit is in the
    /// way of cuts there would be many, and phi would oscillate between them.
    fn weigh_the_missed(&mut self) -> bool {
        let max_error = self.options.max_error;
        if !self.may_cut() || self.errors.iter().all(|e| *e <= max_error) {
            return false;
        }
        let factor = |e: &f64| if *e > max_error { MISSED * e / max_error } else { 1.0 };
        self.energy.reweight(self.errors.iter().map(factor));
        true
    }

    /// Solves A x = b from `x` on, to the tolerance, or `roughly`: until the residual is lower by [`ROUGH`], where the caller does not ask
    /// for so many digits that all are needed. This is `part` of the work that is left.
    fn solve(&mut self, x: Vec<f64>, roughly: bool, part: f64) -> Result<Vec<f64>> {
        let b = self.energy.right_hand_side(self.workers, self.options.feasible.sign())?;
        let mut tolerance = self.options.tolerance;
        if roughly && reweight::rough_tolerance(tolerance) != tolerance {
            let mut r = try_vec(b.len(), 0.0, "the residual")?;
            cg::System::apply(&mut self.energy, self.workers, &x, &mut r);
            update(self.workers, &mut r, &b, |b, r| b - r);
            tolerance = tolerance.max(ROUGH * norm(self.workers, &r) / norm(self.workers, &b));
        }
        self.energy.renew_preconditioner(self.workers);
        let max_iterations = (self.options.max_iterations - self.report.iterations) as usize;
        let stop = Stop { tolerance, max_iterations, patience: None };
        let (begin, share) = (self.done, part * (0.98 - self.done));
        let mut first = None;
        let progress = &mut *self.progress;
        let observe = |_, residual: f64| {
            let first = *first.get_or_insert(residual.max(tolerance));
            let solved = ((residual / first).ln() / (tolerance / first).ln()).clamp(0.0, 1.0);
            progress.tell(begin + share * if solved.is_nan() { 1.0 } else { solved }, "solve")
        };
        let earlier = self.report.iterations;
        let (x, done) = cg::solve(&mut self.energy, &b, x, stop, self.workers, observe)
            .map_err(|error| error.of_a_round(earlier, self.options.tolerance))?;
        self.done += share;
        self.report.iterations += done.iterations as u32;
        (self.report.residual, self.report.convergence_rate) = (done.residual, done.rate);
        self.report.seconds_solve += self.lap();
        Ok(x)
    }

    fn lap(&mut self) -> f64 {
        std::mem::replace(&mut self.clock, Instant::now()).elapsed().as_secs_f64()
    }
}

/// The functions of `tree`; [`Error::OutOfMemory`] where a fit of `n_points` points on it would take more than `limit` bytes, cloud and result
/// included.
pub fn functions<const D: usize>(tree: &Tree<D>, n_points: usize, limit: u64) -> Result<Space<D>> {
    let allowed = |bytes: u64| {
        let what = || format!("a fit of {n_points} points on {} blocks of cells", tree.tiles().len());
        let (bytes, limit) = (bytes.into(), limit.into());
        if bytes <= limit { Ok(()) } else { Err(Error::OutOfMemory { what: what(), bytes, limit: Some(limit) }) }
    };
    // Of points as for a grid. Of a tile the table, those of the field, distances with their masses; of functions ten vectors. The
    // functions of the tree before are there until those of the next are.
    let points = super::super::fit::memory::<D>(n_points as u128, [0; D]) as u64;
    let tiles = points.saturating_add(RefinedEnergy::<D>::bytes_of_tile().saturating_mul(tree.tiles().len() as u64));
    // Tiles that take too much have functions that do, too.
    allowed(tiles)?;
    let space = Space::new(tree)?;
    allowed(tiles + 2 * space.bytes() + 12 * 8 * space.n_numbers() as u64)?;
    Ok(space)
}

/// Control points of the grid that is refined, where none are asked for: few, so that little is kept far from the surface.
pub fn coarsest<const D: usize>() -> usize {
    if D == 2 { 32 * 32 } else { 8192 }
}
