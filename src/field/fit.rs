//! The fit: paper 000's Algorithm 1, steps 2 to 4.

use super::data::Data;
use super::distance::FarDistances;
use super::energy::Energy;
use super::system::System;
use super::{Field, FitOptions, FitReport, domain, reweight};
use crate::Result;
use crate::error::{Error, try_vec, try_with_capacity};
use crate::geometry::Cloud;
use crate::linalg::cg::{self, Stop};
use crate::par::Workers;
use crate::progress::Progress;
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

/// Bytes that the fit of `n_points` points with a tensor of `shape` control points takes at most, cloud and result included.
pub fn memory<const D: usize>(n_points: u128, shape: [u128; D]) -> u128 {
    // A point: its coordinates, normal, origin, place and masses; its copy in units of D; its surfel with the trees that measure
    // distances to it.
    let point = 24 + 24 + 32 + 16 + 16 + 48 + 450;
    // An unknown: the solution and the right-hand side, four vectors of the solve, six of the regularisation, one of the
    // preconditioner, eight of the distances. An axis: three bands of 7 numbers a control point.
    let unknown = 8 * (2 + 4 + 6 + 1 + 8);
    let band = 3 * 56;
    n_points * point + shape.iter().product::<u128>() * unknown + shape.iter().sum::<u128>() * band
}

impl<const D: usize> Field<D> {
    /// Fits a field to `cloud`: minimises the energy (10), with the departures of this room, over the control points.
    pub fn fit(cloud: &Cloud<D>, options: &FitOptions, progress: &mut Progress) -> Result<Self> {
        options.validate::<D>()?;
        let bounds = cloud.bounds();
        let target = chosen_control_points::<D>(cloud.len());
        let asked_for = std::array::from_fn(|a| options.control_points[a]);
        let grid = domain::grid(&bounds, options.margin, asked_for, target)?;
        check_size(cloud.len(), &grid, options.memory_limit)?;
        let d = bounds.diagonal();
        let workers = Workers::new(options.n_threads)?;
        let mut report = FitReport {
            control_points: std::array::from_fn(|a| grid.shape().get(a).map_or(0, |&n| n as u32)),
            n_points: cloud.len() as u64,
            n_unknowns: grid.n_control() as u64,
            ..FitReport::default()
        };
        let mut clock = Instant::now();
        let mut lap = || std::mem::replace(&mut clock, Instant::now()).elapsed().as_secs_f64();

        progress.tell(0.0, "assembly")?;
        let (system, b) = assemble(cloud, &grid, d, options, &workers, progress)?;
        report.seconds_assembly = lap();
        let mut coefficients = solve(system, &b, options, &workers, progress, &mut report)?;
        coefficients.iter_mut().for_each(|c| *c *= d);
        report.seconds_solve = lap();

        progress.tell(0.98, "check")?;
        let mut field = Field::new(grid, coefficients, options.feasible, d, report);
        field.measure(cloud)?;
        field.report.seconds_check = lap();
        progress.tell(1.0, "done")?;
        Ok(field)
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

/// A and b of the minimum (11), in units of `d`.
fn assemble<const D: usize>(
    cloud: &Cloud<D>,
    grid: &Grid<D>,
    d: f64,
    options: &FitOptions,
    workers: &Workers,
    progress: &mut Progress,
) -> Result<(System<D>, Vec<f64>)> {
    let (data, order) = Data::new(cloud, grid)?;
    let mut energy = Energy::new(data, in_units_of(grid, d), options.weights())?;
    let sign = options.feasible.sign();
    let mut b = energy.right_hand_side(workers, cloud.normals(), &order, sign)?;
    if options.distance_weight > 0.0 {
        let tell = |fraction| progress.tell(0.01 + 0.09 * fraction, "distances");
        let far = FarDistances::new(in_units_of_the_box(cloud, grid, d)?, energy.grid(), workers, tell)?;
        energy = energy.with_distances(&far, options.distance_weight)?;
        energy.add_distances(&far, sign, &mut b);
    }
    Ok((System::new(energy, workers)?, b))
}

/// Solves A x = b, and again with the points that the surface misses weighted more, each time from where the last solve ended.
fn solve<const D: usize>(
    mut system: System<D>,
    b: &[f64],
    options: &FitOptions,
    workers: &Workers,
    progress: &mut Progress,
    report: &mut FitReport,
) -> Result<Vec<f64>> {
    let mut x = try_vec(b.len(), 0.0, "the control points")?;
    for round in 0..=options.reweightings {
        let last = round == options.reweightings;
        if round > 0 {
            system = reweighted(system, &x, workers)?;
        }
        let tolerance = if last { options.tolerance } else { reweight::rough_tolerance(options.tolerance) };
        let max_iterations = options.max_iterations - report.iterations;
        let stop = Stop { tolerance, max_iterations: max_iterations as usize };
        let (solution, done) = cg::solve(&mut system, b, x, stop, workers, |_, residual| {
            // The residual falls by about a factor an iteration, so its logarithm tells how far a solve is.
            let solved = (residual.ln() / tolerance.ln()).clamp(0.0, 1.0);
            let fraction = (f64::from(round) + solved) / f64::from(options.reweightings + 1);
            progress.tell(0.1 + 0.88 * fraction, "solve")
        })
        .map_err(|error| counting_earlier_rounds(error, report.iterations))?;
        x = solution;
        report.iterations += done.iterations as u32;
        report.residual = done.residual;
    }
    Ok(x)
}

/// `error` of a round's solve with the `earlier` rounds' iterations counted, as the limit counts them.
fn counting_earlier_rounds(error: Error, earlier: u32) -> Error {
    match error {
        Error::NotConverged { iterations, residual, tolerance } => {
            Error::NotConverged { iterations: iterations + earlier as usize, residual, tolerance }
        }
        other => other,
    }
}

/// The system with the points that the surface of `x` misses weighted more.
fn reweighted<const D: usize>(system: System<D>, x: &[f64], workers: &Workers) -> Result<System<D>> {
    let mut energy = system.into_energy();
    let mut factors = try_vec(energy.n_points(), 0.0, "the weights of the points")?;
    energy.distances(workers, x, reweight::FLATTEST, &mut factors);
    reweight::factors(&mut factors);
    energy.reweight(&factors);
    System::new(energy, workers)
}

/// The cloud in units of D, with the lower corner of the box as origin.
fn in_units_of_the_box<const D: usize>(cloud: &Cloud<D>, grid: &Grid<D>, d: f64) -> Result<Cloud<D>> {
    let mut points = try_with_capacity(cloud.len(), "the points in units of D")?;
    points.extend(cloud.points().iter().map(|p| std::array::from_fn(|a| (p[a] - grid.axes[a].lower) / d)));
    let mut normals = try_with_capacity(cloud.len(), "the normals")?;
    normals.extend_from_slice(cloud.normals());
    Cloud::new(points, normals)
}

/// The grid with its cells in units of D: what the energy sees.
fn in_units_of<const D: usize>(grid: &Grid<D>, d: f64) -> Grid<D> {
    Grid { axes: grid.axes.map(|a| Axis { lower: 0.0, cell: a.cell / d, n_cells: a.n_cells }) }
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
