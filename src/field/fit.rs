//! The fit: paper 000's Algorithm 1, steps 2 to 4.

use super::data::{Data, Misfit};
use super::energy::Energy;
use super::held::Held;
use super::levels;
use super::refined::fit::Spline;
use super::refined::{self, Refined};
use super::smoothness::Smoothness;
use super::system::{Diagonal, FEW, PATIENCE};
use super::weighed::Weighed;
use super::{Field, FitOptions, FitReport, Reweighting, domain, reweight, robust};
use crate::Result;
use crate::error::{Error, try_vec, try_with_capacity};
use crate::geometry::vec::text;
use crate::geometry::{Bounds, Cloud};
use crate::linalg::cg::{self, Stop};
use crate::par::Workers;
use crate::progress::Progress;
use crate::spline::tree::Tree;
use crate::spline::{Axis, Grid};
use std::time::Instant;

/// Control points chosen for `n_points` points when none are asked for: with twice as many, parts about as thin as a cell keep their
/// sides on all shapes of docs/weights.md. In the plane, where a curve of N points crosses a number of cells in proportion to N, a cell
/// for about three points' spacing likewise.
fn chosen_control_points<const D: usize>(n_points: usize) -> usize {
    match D {
        2 => (n_points.saturating_mul(n_points) / 100).clamp(32 * 32, 256 * 256),
        _ => (2 * n_points).clamp(4096, 262_144),
    }
}

/// Control points of the grid that is refined, where none are asked for, of at most `most`: but an axis has four.
fn coarsest<const D: usize>(most: u64) -> usize {
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    refined::fit::coarsest::<D>().min(most).max(4usize.pow(D as u32))
}

/// Cells of a refit, in D: where they are much longer the system is singular to rounding, and no solve converges.
const LARGEST_CELL: f64 = 100.0;

/// Bytes that the fit of `n_points` points with a tensor of `shape` control points takes at most, cloud and result included, but for some
/// kilobytes a thread.
pub fn memory<const D: usize>(n_points: u128, shape: [u128; D]) -> u128 {
    // A point: its coordinates, normal, origin and weight; the same in the order of cells, its share, masses, number, misfit and place; what
    // the field remembers of it; its copy in units of D; its surfel with the trees that measure distances to it.
    let point = (24 + 24 + 32 + 8) + (24 + 24 + 8 + 16 + 4 + 32 + 16) + (24 + 4) + 48 + 450;
    // An unknown: the solution and the right-hand side, four vectors of the solve, one of the preconditioner, eight of the distances, where
    // they are held and from which point.
    let unknown = 8 * (2 + 4 + 1 + 8) + 16 + 4;
    let in_space = std::array::from_fn(|a| if a + D >= 3 { shape[a + D - 3] } else { 1 });
    n_points * point + shape.iter().product::<u128>() * unknown + Smoothness::bytes(in_space)
}

impl<const D: usize> Field<D> {
    /// Fits a field to `cloud`: minimises the energy (10), with the departures of this room, over the control points.
    pub fn fit(cloud: &Cloud<D>, options: &FitOptions, progress: &mut Progress) -> Result<Self> {
        options.validate::<D>()?;
        check_reweighting(options, false)?;
        if options.reweighting == Reweighting::Kept {
            let text = "KO_REWEIGHT_KEEP keeps what points counted for in the field that a refit starts from; a first fit has none: take \
                        KO_REWEIGHT_LARGEST or KO_REWEIGHT_ROBUST";
            return Err(Error::InvalidArgument(text.into()));
        }
        let n_points = cloud.counted_points().count();
        let refines = options.max_error > 0.0;
        let target = if refines { coarsest::<D>(options.max_unknowns) } else { chosen_control_points::<D>(n_points) };
        let asked_for = std::array::from_fn(|a| options.control_points[a]);
        let grid = domain::grid(&Bounds::of(cloud.counted_points()), options.margin, asked_for, target)?;
        check_size(n_points, &grid, options.memory_limit)?;
        let counted = cloud.counted()?;
        let cloud = counted.as_ref().unwrap_or(cloud);
        let d = domain::diagonal(&cloud.bounds())?;
        if refines {
            let tree = Tree::new(grid)?;
            let space = refined::fit::functions(&tree, n_points, options.memory_limit)?;
            let x = try_vec(space.n_numbers(), 0.0, "the control points")?;
            fit_tree(Start { at: Spline { tree, space, x }, d, kept: None }, cloud, options, progress)
        } else {
            let at = try_vec(grid.n_control(), 0.0, "the control points")?;
            fit_on(grid, Start { at, d, kept: None }, cloud, options, progress)
        }
    }

    /// Fits a field to another `cloud` on this field's box, from its control points on: for a shape that moves a little from fit to fit,
    /// which then takes few iterations. Control points and margin of the options do not count. Cells that are refined stay so, and with a
    /// `max_error` more of them are. [`Error::InvalidArgument`] for a point outside the box.
    pub fn refit(&self, cloud: &Cloud<D>, options: &FitOptions, progress: &mut Progress) -> Result<Self> {
        options.validate::<D>()?;
        check_reweighting(options, self.is_refined())?;
        let n_points = cloud.counted_points().count();
        check_size(n_points, &self.grid, options.memory_limit)?;
        let counted = cloud.counted()?;
        let cloud = counted.as_ref().unwrap_or(cloud);
        if let Some(i) = cloud.points().iter().position(|p| !self.grid.holds(p)) {
            let p = text(&cloud.points()[i]);
            return Err(Error::InvalidArgument(format!(
                "point {i} is {p}, outside the field's box; fit anew, or with a larger margin before"
            )));
        }
        let d = domain::diagonal(&cloud.bounds())?;
        let cell = self.grid.longest_cell();
        if cell > LARGEST_CELL * d {
            return Err(Error::InvalidArgument(format!(
                "the cloud has a diagonal of {d:e}, which the field's cells of {cell:e} cannot resolve; at most {LARGEST_CELL} times the \
                 diagonal is served: fit anew"
            )));
        }
        let kept = self.kept(n_points, options)?;
        // What is kept was weighed in this unit.
        let d = if kept.is_some() { self.diagonal } else { d };
        if self.refined.is_none() && options.max_error == 0.0 {
            let mut at = try_vec(self.coefficients.len(), 0.0, "the control points")?;
            at.iter_mut().zip(&self.coefficients).for_each(|(x, c)| *x = c / d);
            return fit_on(self.grid, Start { at, d, kept }, cloud, options, progress);
        }
        let tree = self.refined.as_ref().map_or_else(|| Tree::new(self.grid), |r| r.tree().try_clone())?;
        let space = refined::fit::functions(&tree, n_points, options.memory_limit)?;
        let mut x = match &self.refined {
            Some(refined) => space.with_active(refined.active().iter().copied())?,
            None => space.of_grid(self.grid.shape(), &self.coefficients)?,
        };
        x.iter_mut().for_each(|x| *x /= d);
        fit_tree(Start { at: Spline { tree, space, x }, d, kept }, cloud, options, progress)
    }

    /// What the points counted for in this field's fit, where `options` ask to keep it for `n_points` points.
    fn kept(&self, n_points: usize, options: &FitOptions) -> Result<Option<&Weighed>> {
        if options.reweighting != Reweighting::Kept {
            return Ok(None);
        }
        match self.weighed.n_points() {
            n if n == n_points => Ok(Some(&self.weighed)),
            0 => Err(Error::InvalidArgument(
                "start was loaded or made, and does not know what points counted for; KO_REWEIGHT_KEEP is for refits of fields that were fitted"
                    .into(),
            )),
            n => Err(Error::InvalidArgument(format!(
                "start was fitted to {n} points, but {n_points} points of the cloud count; KO_REWEIGHT_KEEP is for the same points, moved"
            ))),
        }
    }

    /// The field with the errors at the points of `cloud` in its report.
    fn checked(mut self, cloud: &Cloud<D>, progress: &mut Progress) -> Result<Self> {
        let clock = Instant::now();
        progress.tell(0.98, "check")?;
        self.measure(cloud)?;
        self.report.seconds_check = clock.elapsed().as_secs_f64();
        progress.tell(1.0, "done")?;
        Ok(self)
    }

    /// Fills the report with the errors at the points of `cloud`.
    fn measure(&mut self, cloud: &Cloud<D>) -> Result<()> {
        const BLOCK: usize = 256;
        let (mut values, mut gradients) = ([0.0; BLOCK], [[0.0; D]; BLOCK]);
        let (mut squares, mut max, mut lengths) = (0.0, 0.0f64, 0.0);
        for points in cloud.points().chunks(BLOCK) {
            let n = points.len();
            let outputs =
                super::Outputs { values: Some(&mut values[..n]), gradients: Some(&mut gradients[..n]), hessians: None };
            self.eval(points, outputs)?;
            for (v, g) in values.iter().zip(&gradients).take(n) {
                let v = v / self.diagonal;
                squares += v * v;
                max = max.max(v.abs());
                lengths += crate::geometry::vec::norm(*g);
            }
        }
        let n = cloud.len() as f64;
        (self.report.rms, self.report.max, self.report.mean_gradient) = ((squares / n).sqrt(), max, lengths / n);
        Ok(())
    }
}

/// Where a fit begins.
struct Start<'a, T> {
    /// Control points, in units of D.
    at: T,
    /// D
    d: f64,
    /// What the points are to count for, where they are not to be reweighted.
    kept: Option<&'a Weighed>,
}

/// The fit on `grid` from `start` on.
fn fit_on<const D: usize>(
    grid: Grid<D>,
    Start { at: start, d, kept }: Start<Vec<f64>>,
    cloud: &Cloud<D>,
    options: &FitOptions,
    progress: &mut Progress,
) -> Result<Field<D>> {
    let workers = Workers::new(options.n_threads)?;
    let report = FitReport { n_unknowns: grid.n_control() as u64, n_levels: 1, ..begun(&grid, cloud) };
    progress.tell(0.0, "assembly")?;
    let clock = Instant::now();
    let data = Data::new(cloud, &grid)?;
    let energy = Energy::new(data, in_units_of(&grid, d), options.weights())?;
    let mut fitting = Fitting { options, workers: &workers, clock, energy, held: None, report };
    let mut coefficients = match (kept, options.reweighting) {
        (Some(kept), _) => fitting.as_before(start, kept, progress)?,
        (None, Reweighting::Robust) => fitting.robustly(start, progress)?,
        (None, _) => fitting.against_the_largest_error(start, progress)?,
    };
    coefficients.iter_mut().for_each(|c| *c *= d);
    let weighed = Weighed::of(fitting.energy.data().points(), fitting.held)?;
    let field = Field::new(grid, coefficients, options.feasible, d, fitting.report);
    Field { weighed, ..field }.checked(cloud, progress)
}

/// The fit from `start` on, with its tree's grid in the caller's units and control points in units of D; refined where it must be. Where
/// nothing is, the field has one grid.
fn fit_tree<const D: usize>(
    Start { at: start, d, kept }: Start<Spline<D>>,
    cloud: &Cloud<D>,
    options: &FitOptions,
    progress: &mut Progress,
) -> Result<Field<D>> {
    let grid = *start.tree.grid();
    let workers = Workers::new(options.n_threads)?;
    let mut report = begun(&grid, cloud);
    let clock = Instant::now();
    let mut data = Data::new(cloud, &grid)?;
    report.seconds_assembly = clock.elapsed().as_secs_f64();
    if let Some(kept) = kept {
        kept.weigh(&mut data);
    }
    let held = kept.and_then(Weighed::held);
    let start = Spline { tree: start.tree.on(in_units_of(&grid, d)), ..start };
    let (spline, weighed) = refined::fit::fit(start, (data, held), options, &workers, &mut report, progress)?;
    let Spline { tree, space, mut x } = spline;
    x.iter_mut().for_each(|x| *x *= d);
    let field = if tree.n_levels() == 1 {
        Field::new(grid, space.on_grid(grid.shape(), &x)?, options.feasible, d, report)
    } else {
        let mut active = try_with_capacity(space.n_active(), "the control points")?;
        active.extend(space.active(&x));
        Field::of_refined(Refined::new(tree.on(grid), &space, active)?, options.feasible, d, report)
    };
    Field { weighed, ..field }.checked(cloud, progress)
}

/// The report of a fit that begins.
fn begun<const D: usize>(grid: &Grid<D>, cloud: &Cloud<D>) -> FitReport {
    FitReport {
        control_points: std::array::from_fn(|a| grid.shape().get(a).map_or(0, |&n| n as u32)),
        n_points: cloud.len() as u64,
        clear_sides: f64::NAN,
        ..FitReport::default()
    }
}

/// A fit on its way.
struct Fitting<'a, const D: usize> {
    options: &'a FitOptions,
    workers: &'a Workers,
    /// Runs since the last time that it was read.
    clock: Instant,
    energy: Energy<D>,
    /// Where distances are held.
    held: Option<Held>,
    report: FitReport,
}

/// A solve among `of`, counted from 0.
#[derive(Clone, Copy)]
struct Round {
    index: u32,
    of: u32,
    tolerance: f64,
}

impl<const D: usize> Fitting<'_, D> {
    /// The minimum from `x` on, with points that the surface misses weighted more in later rounds.
    fn against_the_largest_error(&mut self, mut x: Vec<f64>, progress: &mut Progress) -> Result<Vec<f64>> {
        self.hold_distances(progress)?;
        let rounds = self.options.reweightings;
        for index in 0..=rounds {
            if index > 0 {
                let misfits = self.misfits(&x)?;
                self.energy.data_mut().reweight(reweight::factors(&misfits));
            }
            let wanted = self.options.tolerance;
            let tolerance = if index == rounds { wanted } else { reweight::rough_tolerance(wanted) };
            x = self.solve(x, Round { index, of: rounds + 1, tolerance }, progress)?;
        }
        Ok(x)
    }

    /// The minimum from `x` on, with points that disagree with the others left out: from a much smoother field on, which they cannot bend,
    /// to the one asked for. Distances are then measured to the points that are left.
    fn robustly(&mut self, mut x: Vec<f64>, progress: &mut Progress) -> Result<Vec<f64>> {
        let rounds = self.options.reweightings;
        let step = robust::START.powf(1.0 / f64::from(rounds.max(1)));
        // Without rounds there is none to take the smoothness back in.
        if rounds > 0 {
            self.energy.smoothen(robust::START);
        }
        for index in 0..rounds {
            let tolerance = reweight::rough_tolerance(self.options.tolerance);
            x = self.solve(x, Round { index, of: rounds + 2, tolerance }, progress)?;
            self.weigh(&x)?;
            self.energy.smoothen(1.0 / step);
        }
        self.hold_distances(progress)?;
        for index in rounds..rounds + 2 {
            x = self.solve(x, Round { index, of: rounds + 2, tolerance: self.options.tolerance }, progress)?;
            if index == rounds {
                self.weigh(&x)?;
            }
        }
        self.report.n_outliers = self.energy.data().n_left_out() as u64;
        Ok(x)
    }

    /// The minimum from `x` on, with points that count for what they are `kept` to count for.
    fn as_before(&mut self, x: Vec<f64>, kept: &Weighed, progress: &mut Progress) -> Result<Vec<f64>> {
        kept.weigh(self.energy.data_mut().points_mut());
        match kept.held().filter(|_| self.options.distance_weight > 0.0) {
            Some(held) => {
                self.report.clear_sides = held.clear();
                self.energy.hold(self.energy.keep(held)?, self.options.distance_weight)?;
                self.held = Some(held.try_clone()?);
                self.report.seconds_assembly += self.lap();
            }
            None => self.hold_distances(progress)?,
        }
        self.report.n_outliers = self.energy.data().n_left_out() as u64;
        self.solve(x, Round { index: 0, of: 1, tolerance: self.options.tolerance }, progress)
    }

    /// Weighs the points by how well `x` agrees with them.
    fn weigh(&mut self, x: &[f64]) -> Result<()> {
        let misfits = self.misfits(x)?;
        let masses = robust::masses(&misfits, self.energy.grid().longest_cell())?;
        self.energy.data_mut().weigh(masses);
        Ok(())
    }

    fn misfits(&self, x: &[f64]) -> Result<Vec<Misfit>> {
        self.energy.misfits(self.workers, x, self.options.feasible.sign(), reweight::FLATTEST)
    }

    /// Adds the distance term for the points that count.
    fn hold_distances(&mut self, progress: &mut Progress) -> Result<()> {
        if self.options.distance_weight > 0.0 {
            let tell = |fraction| progress.tell(0.01 + 0.09 * fraction, "distances");
            let far;
            (far, self.held) = self.energy.measure(self.workers, tell)?;
            self.report.clear_sides = far.clear();
            self.energy.hold(far, self.options.distance_weight)?;
        }
        self.report.seconds_assembly += self.lap();
        Ok(())
    }

    /// Solves A x = b (11) from `x` on, and counts the iterations.
    fn solve(&mut self, x: Vec<f64>, round: Round, progress: &mut Progress) -> Result<Vec<f64>> {
        let b = self.energy.right_hand_side(self.workers, self.options.feasible.sign())?;
        let Round { index, of, tolerance } = round;
        let mut observe = |_, residual: f64| {
            // The residual falls by about a factor an iteration, so its logarithm tells how far a solve is.
            let solved = (residual.ln() / tolerance.ln()).clamp(0.0, 1.0);
            progress.tell(0.1 + 0.88 * (f64::from(index) + solved) / f64::from(of), "solve")
        };
        let patience = self.multigrid_fits().then_some(PATIENCE);
        let mut stop = Stop { tolerance, max_iterations: self.iterations_left(), patience };
        let mut diagonal = Diagonal::new(&mut self.energy, self.workers)?;
        let (mut x, mut done) = cg::solve(&mut diagonal, &b, x, stop, self.workers, &mut observe)
            .map_err(|error| error.of_a_round(self.report.iterations, self.options.tolerance))?;
        self.report.iterations += done.iterations as u32;
        if done.residual > tolerance {
            (stop.max_iterations, stop.patience) = (self.iterations_left(), None);
            let mut multigrid = self.energy.multigrid(self.workers)?;
            (x, done) = cg::solve(&mut multigrid, &b, x, stop, self.workers, &mut observe)
                .map_err(|error| error.of_a_round(self.report.iterations, self.options.tolerance))?;
            self.report.iterations += done.iterations as u32;
        }
        (self.report.residual, self.report.convergence_rate) = (done.residual, done.rate);
        self.report.seconds_solve += self.lap();
        Ok(x)
    }

    /// Whether there may be a multigrid.
    fn multigrid_fits(&self) -> bool {
        multigrid_fits(self.energy.data().n_points() as u128, self.energy.grid(), self.options.memory_limit)
    }

    fn iterations_left(&self) -> usize {
        (self.options.max_iterations - self.report.iterations) as usize
    }

    fn lap(&mut self) -> f64 {
        std::mem::replace(&mut self.clock, Instant::now()).elapsed().as_secs_f64()
    }
}

/// Whether the grid is large enough for a multigrid to pay, and the limit of memory for what it takes more.
pub(super) fn multigrid_fits<const D: usize>(n_points: u128, grid: &Grid<D>, limit: u64) -> bool {
    let bytes = memory(n_points, grid.shape().map(|n| n as u128)) + levels::memory(n_points, grid);
    grid.n_control() >= FEW && levels::serve(grid) && bytes <= u128::from(limit)
}

/// The grid with its cells in units of D: what the energy sees.
pub(super) fn in_units_of<const D: usize>(grid: &Grid<D>, d: f64) -> Grid<D> {
    Grid { axes: grid.axes.map(|a| Axis { lower: 0.0, cell: a.cell / d, n_cells: a.n_cells }) }
}

/// Refuses what does not go with cells that are refined, or may be.
fn check_reweighting(options: &FitOptions, refined: bool) -> Result<()> {
    let may_be = options.max_error > 0.0;
    let text = match (options.reweighting, refined, may_be) {
        (Reweighting::Robust, true, _) => {
            "a robust fit leaves points out that refinement cannot tell from errors; the field has refined cells: fit anew on one grid \
             (max_error 0)"
        }
        (Reweighting::Robust, false, true) => {
            "a robust fit leaves points out that refinement cannot tell from errors; take KO_REWEIGHT_LARGEST, or one grid (max_error 0)"
        }
        (Reweighting::Kept, _, true) => {
            "KO_REWEIGHT_KEEP is for cells that stay as they are; take KO_REWEIGHT_LARGEST, or cut no cells (max_error 0)"
        }
        _ => return Ok(()),
    };
    Err(Error::Unsupported(text.into()))
}

/// Refuses a fit that would take more than `limit` bytes.
fn check_size<const D: usize>(n_points: usize, grid: &Grid<D>, limit: u64) -> Result<()> {
    let shape = grid.axes.map(|a| a.n_control() as u128);
    let bytes = memory(n_points as u128, shape);
    if bytes <= u128::from(limit) {
        return Ok(());
    }
    let counts = shape.map(|n| n.to_string()).join(" x ");
    Err(Error::OutOfMemory {
        what: format!("a fit of {counts} control points to {n_points} points"),
        bytes,
        limit: Some(u128::from(limit)),
    })
}
