//! The fit: solve, look, cut, until the surface misses no point by more than it may.

use super::super::data::{Data, Misfit};
use super::super::{FitOptions, FitReport, Reweighting, reweight};
use super::cuts::{cut, marks};
use super::energy::{Holding, RefinedEnergy};
use crate::Result;
use crate::error::{Error, try_vec, try_with_capacity};
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

/// Distance from the surface, in cells of its own leaves, from which on distances are held. Closer than on a grid, which has fewer points a
/// cell: of 19 closed shapes fewer then have wrong signs beside sharp edges, and what distances bend is refined.
const NEAREST: f64 = 0.5;

/// What points that are missed by just more than they may be are weighted with.
const MISSED: f64 = 2.0;

/// Rounds of cuts: each goes a level deeper, or wider.
const MOST_ROUNDS: u32 = 40;

/// What a fit works with.
struct Fitting<'a, 'b, const D: usize> {
    options: &'a FitOptions,
    workers: &'a Workers,
    clock: Instant,
    energy: RefinedEnergy<D>,
    misfits: Vec<Misfit>,
    report: &'a mut FitReport,
    progress: &'a mut Progress<'b>,
    /// The fraction of the work that is done.
    done: f64,
    /// Whether no more is to be cut: a limit left no room for all that was to be.
    full: bool,
}

/// Fits `data`, which is in the cells of the tree's grid, from `start` on: a tree with its grid in units of D, and control points of its
/// active functions. Refines it until the largest error is at most that of the options, or its control points or bytes reach their limit:
/// the tree then, its functions and the control points of the active ones, in units of D. `report` gets what the fit did, but for the
/// errors at the points. Without `max_error` nothing is refined.
pub fn fit<const D: usize>(
    start: (Tree<D>, Vec<f64>),
    data: Data<D>,
    options: &FitOptions,
    workers: &Workers,
    report: &mut FitReport,
    progress: &mut Progress,
) -> Result<(Tree<D>, Space<D>, Vec<f64>)> {
    if options.reweighting == Reweighting::Robust {
        let text = "a robust fit leaves points out that refinement cannot tell from errors; take KO_REWEIGHT_LARGEST, or one grid \
                    (max_error 0)";
        return Err(Error::Unsupported(text.into()));
    }
    let (clock, n_points) = (Instant::now(), data.xi.len());
    progress.tell(0.0, "assembly")?;
    let (tree, active) = start;
    let space = Space::new(&tree)?;
    let mut x = space.with_active(active.into_iter())?;
    let holding = Holding { weight: options.distance_weight, nearest: NEAREST, spacings: 1.0 };
    let energy = RefinedEnergy::new((tree, space), data, options.weights(), holding, workers)?;
    let misfits = try_vec(n_points, Misfit::default(), "the misfits of the points")?;
    let mut fitting = Fitting { options, workers, clock, energy, misfits, report, progress, done: 0.05, full: false };
    fitting.energy.check_normals(workers)?;
    fitting.report.seconds_assembly += fitting.lap();

    for round in 1..=MOST_ROUNDS {
        // What comes out must be solved to the end.
        fitting.full |= round == MOST_ROUNDS;
        x = fitting.solve(x, true, 0.3)?;
        let mut further = fitting.refine(&x, true)?;
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
        x = fitting.energy.refine(tree, space, &x, workers)?;
        fitting.energy.reset_weights();
        fitting.report.seconds_assembly += fitting.lap();
    }
    let Fitting { energy, report, .. } = fitting;
    report.n_levels = energy.tree().n_levels();
    report.n_unknowns = energy.space().n_active() as u64;
    report.clear_sides = energy.clear();
    let (tree, space) = energy.into_tree();
    let mut active = try_with_capacity(space.n_active(), "the control points")?;
    active.extend(space.active(&x));
    Ok((tree, space, active))
}

impl<const D: usize> Fitting<'_, '_, D> {
    /// Measures the misfits of `x`, and gives the tree to go on with where some are too large, within the limits; looks for thin parts and
    /// wrong sides too, where that is wanted.
    fn refine(&mut self, x: &[f64], looks_everywhere: bool) -> Result<Option<(Tree<D>, Space<D>)>> {
        let sign = self.options.feasible.sign();
        self.energy.misfits(self.workers, x, sign, reweight::FLATTEST, &mut self.misfits)?;
        if self.options.max_error == 0.0 || self.full {
            return Ok(None);
        }
        let strays = if looks_everywhere { self.energy.strays(self.workers, x, sign, STRAY)? } else { Vec::new() };
        let marks = marks(&self.energy, &self.misfits, &strays, self.options.max_error)?;
        // As many of them, the worst first, as the limits leave room for.
        let mut n = marks.len();
        while n > 0 {
            let mut tree = self.energy.tree().try_clone()?;
            cut(&mut tree, &marks[..n])?;
            if tree.tiles().len() == self.energy.tree().tiles().len() {
                return Ok(None);
            }
            let space = Space::new(&tree)?;
            let bytes = memory(self.misfits.len(), &tree, &space);
            if space.n_active() as u64 <= self.options.max_unknowns && bytes <= self.options.memory_limit {
                return Ok(Some((tree, space)));
            }
            (n, self.full) = (n / 2, true);
        }
        Ok(None)
    }

    /// Makes points count for more that the surface misses though no cells can be cut there; whether there are any. Where a limit is in the
    /// way of cuts there would be many, and phi would oscillate between them.
    fn weigh_the_missed(&mut self) -> bool {
        let max_error = self.options.max_error;
        let missed = |m: &Misfit| m.value > max_error;
        if max_error == 0.0 || self.full || !self.misfits.iter().any(missed) {
            return false;
        }
        self.energy.reweight(self.misfits.iter().map(|m| if missed(m) { MISSED * m.value / max_error } else { 1.0 }));
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
        self.energy.renew_diagonal(self.workers);
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
            .map_err(|error| error.counting_earlier_iterations(earlier))?;
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

/// Bytes that a fit of `n_points` points on `tree` takes, cloud and result included.
fn memory<const D: usize>(n_points: usize, tree: &Tree<D>, space: &Space<D>) -> u64 {
    // Of points as for a grid. Of a tile the table, those of the field, distances with their masses; of functions ten vectors. The
    // functions of the tree before are there until those of the next are.
    let points = super::super::fit::memory::<D>(n_points as u128, [0; D]) as u64;
    points
        + RefinedEnergy::<D>::bytes_of_tile() * tree.tiles().len() as u64
        + 2 * space.bytes()
        + 12 * 8 * space.n_numbers() as u64
}

/// Control points of the grid that is refined, where none are asked for: few, so that little is kept far from the surface.
pub fn coarsest<const D: usize>() -> usize {
    if D == 2 { 32 * 32 } else { 8192 }
}
