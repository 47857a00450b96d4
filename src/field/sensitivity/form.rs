//! The form whose minimum a field is, made again from its cloud, and solves with its matrix.

use super::Effort;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::field::data::{Data, DataTerm, Mass};
use crate::field::energy::Energy;
use crate::field::fit::{self, in_units_of};
use crate::field::held::{Held, Hold};
use crate::field::levels::{Level, Terms, multigrid};
use crate::field::refined::energy::RefinedEnergy;
use crate::field::refined::{self, Refined};
use crate::field::system::{Diagonal, PATIENCE};
use crate::field::{Field, FitOptions};
use crate::geometry::Cloud;
use crate::linalg::cg::{self, Stop};
use crate::linalg::multigrid::Multigrid;
use crate::linalg::vector::{norm, update};
use crate::par::Workers;
use crate::progress::Progress;
use std::sync::Arc;

/// The form, in units of D.
pub(super) enum Form<const D: usize> {
    OneGrid(Box<OneGrid<D>>),
    Leaves(Box<RefinedEnergy<D>>),
}

/// The form on one grid.
pub(super) struct OneGrid<const D: usize> {
    data: Arc<DataTerm<D>>,
    terms: Terms<D>,
    held: Option<Held>,
    /// Made by the first solve that takes long without.
    multigrid: Option<OwnMultigrid<D>>,
    /// Whether it may be made.
    may_have_multigrid: bool,
}

/// A multigrid that lives with the form.
type OwnMultigrid<const D: usize> = Multigrid<Level<Arc<DataTerm<D>>, Box<Terms<D>>, D>>;

impl<const D: usize> Form<D> {
    /// The form of `field` and `cloud`, all of whose points count and lie in the box, and |b - A c| / |b| that the field leaves.
    pub fn new(
        field: &Field<D>,
        cloud: &Cloud<D>,
        options: &FitOptions,
        workers: &Workers,
        progress: &mut Progress,
    ) -> Result<(Self, f64)> {
        let data = Data::new(cloud, &field.grid)?;
        match &field.refined {
            None => OneGrid::form(field, data, options, workers, progress),
            Some(refined) => leaves(field, refined, data, options, workers, progress),
        }
    }

    /// What each point counts for in the sum of values, and, times lambda_n, in that of gradients; by number.
    pub fn forces(&self) -> Result<Vec<Mass>> {
        let n = match self {
            Form::OneGrid(form) => form.data.n_points(),
            Form::Leaves(energy) => energy.data().xi.len(),
        };
        let mut forces = try_vec(n, Mass { value: 0.0, gradient: 0.0 }, "what the points count for")?;
        match self {
            Form::OneGrid(form) => form.data.forces().for_each(|(i, force)| forces[i as usize] = force),
            Form::Leaves(energy) => energy.forces().for_each(|(i, force)| forces[i as usize] = force),
        }
        Ok(forces)
    }

    /// The cells in which distances are held.
    pub fn holds(&self) -> Result<Vec<Hold<D>>> {
        match self {
            Form::OneGrid(form) => match (&form.terms.distance, &form.held) {
                (Some(distance), Some(held)) => listed(distance.holds(held, form.terms.view.grid())),
                _ => Ok(Vec::new()),
            },
            Form::Leaves(energy) => listed(energy.holds()),
        }
    }

    /// lambda of A lambda = g, g the functional that is `sums`.
    pub fn solve(
        &mut self,
        sums: Vec<f64>,
        effort: Effort,
        workers: &Workers,
        progress: &mut Progress,
    ) -> Result<Vec<f64>> {
        let observe = |_, residual: f64| {
            let solved = (residual.ln() / effort.tolerance.ln()).clamp(0.0, 1.0);
            progress.tell(0.95 * if solved.is_nan() { 1.0 } else { solved }, "solve")
        };
        match self {
            Form::OneGrid(form) => form.solve(&sums, effort, workers, observe),
            Form::Leaves(energy) => {
                let g = energy.functional(workers, &sums)?;
                drop(sums);
                let x = try_vec(g.len(), 0.0, "the solution")?;
                let max_iterations = effort.max_iterations as usize;
                let stop = Stop { tolerance: effort.tolerance, max_iterations, patience: None };
                Ok(cg::solve(&mut **energy, &g, x, stop, workers, observe)?.0)
            }
        }
    }

    /// psi as a field on the cells of `field`.
    pub fn spline(&self, field: &Field<D>, lambda: Vec<f64>) -> Result<Field<D>> {
        let (feasible, d, report) = (field.feasible, field.diagonal, field.report);
        match self {
            Form::OneGrid(_) => Ok(Field::new(field.grid, lambda, feasible, d, report)),
            Form::Leaves(energy) => {
                let space = energy.space();
                let mut active = try_with_capacity(space.n_active(), "the control points")?;
                active.extend(space.active(&lambda));
                let tree = energy.tree().try_clone()?.on(field.grid);
                Ok(Field::of_refined(Refined::new(tree, space, active)?, feasible, d, report))
            }
        }
    }
}

/// The form on the cells of `refined`, those of `field`.
fn leaves<const D: usize>(
    field: &Field<D>,
    refined: &Refined<D>,
    mut data: Data<D>,
    options: &FitOptions,
    workers: &Workers,
    progress: &mut Progress,
) -> Result<(Form<D>, f64)> {
    field.weighed.weigh(&mut data);
    let tree = refined.tree().try_clone()?;
    let space = refined::fit::functions(&tree, data.xi.len(), options.memory_limit)?;
    let mut x = space.with_active(refined.active().iter().copied())?;
    x.iter_mut().for_each(|x| *x /= field.diagonal);
    let tell = || progress.tell(0.1, "distances");
    let spline = (tree.on(in_units_of(&field.grid, field.diagonal)), space);
    let holding = refined::fit::holding(options);
    let mut energy = match field.weighed.held() {
        Some(held) => RefinedEnergy::keeping(spline, data, options.weights(), (holding, held), workers, tell)?,
        None => RefinedEnergy::new(spline, data, options.weights(), holding, workers, tell)?,
    };
    energy.check_normals(workers)?;
    let b = energy.right_hand_side(workers, field.feasible.sign())?;
    let residual = residual(&mut energy, &x, &b, workers)?;
    energy.renew_preconditioner(workers);
    Ok((Form::Leaves(Box::new(energy)), residual))
}

impl<const D: usize> OneGrid<D> {
    fn form(
        field: &Field<D>,
        mut data: Data<D>,
        options: &FitOptions,
        workers: &Workers,
        progress: &mut Progress,
    ) -> Result<(Form<D>, f64)> {
        let grid = in_units_of(&field.grid, field.diagonal);
        let n_points = data.xi.len() as u128;
        field.weighed.weigh(&mut data);
        let mut energy = Energy::new(data, grid, options.weights())?;
        let mut held = None;
        if options.distance_weight > 0.0 {
            let tell = |fraction| progress.tell(0.1 + 0.8 * fraction, "distances");
            let far;
            (far, held) = match field.weighed.held() {
                Some(held) => (energy.keep(held)?, Some(held.try_clone()?)),
                None => energy.measure(workers, tell)?,
            };
            energy.hold(far, options.distance_weight)?;
        }
        let b = energy.right_hand_side(workers, field.feasible.sign())?;
        let mut x = try_vec(b.len(), 0.0, "the control points")?;
        x.iter_mut().zip(&field.coefficients).for_each(|(x, c)| *x = c / field.diagonal);
        let residual = residual(&mut Diagonal::new(&mut energy, workers)?, &x, &b, workers)?;
        let may_have_multigrid = fit::multigrid_fits(n_points, &grid, options.memory_limit);
        let (data, terms) = energy.into_parts();
        let form = OneGrid { data: Arc::new(data), terms, held, multigrid: None, may_have_multigrid };
        Ok((Form::OneGrid(Box::new(form)), residual))
    }

    /// Whether a solve took so long that a multigrid was made.
    #[cfg(test)]
    pub fn has_multigrid(&self) -> bool {
        self.multigrid.is_some()
    }

    /// As the fit solves: by the diagonal, and where that seems to take long, on by multigrid. The latter stays; but a solve begins without
    /// it even then, for its bits not to depend on those before.
    fn solve(
        &mut self,
        g: &[f64],
        effort: Effort,
        workers: &Workers,
        mut observe: impl FnMut(usize, f64) -> Result<()>,
    ) -> Result<Vec<f64>> {
        let tolerance = effort.tolerance;
        let patience = self.may_have_multigrid.then_some(PATIENCE);
        let mut stop = Stop { tolerance, max_iterations: effort.max_iterations as usize, patience };
        let x = try_vec(g.len(), 0.0, "the solution")?;
        let mut diagonal = Diagonal::of(&self.data, &mut self.terms, workers)?;
        let (x, done) = cg::solve(&mut diagonal, g, x, stop, workers, &mut observe)?;
        if done.residual <= tolerance {
            return Ok(x);
        }
        (stop.max_iterations, stop.patience) = (stop.max_iterations - done.iterations, None);
        let multigrid = match &mut self.multigrid {
            Some(multigrid) => multigrid,
            none => {
                let terms = Box::new(self.terms.copy(&self.data)?);
                none.insert(multigrid(Arc::clone(&self.data), terms, workers)?)
            }
        };
        let (x, _) = cg::solve(multigrid, g, x, stop, workers, &mut observe)
            .map_err(|error| error.of_a_round(done.iterations as u32, tolerance))?;
        Ok(x)
    }
}

/// |b - A x| / |b|
fn residual(system: &mut impl cg::System, x: &[f64], b: &[f64], workers: &Workers) -> Result<f64> {
    let mut r = try_vec(b.len(), 0.0, "the residual")?;
    system.apply(workers, x, &mut r);
    update(workers, &mut r, b, |b, r| b - r);
    Ok(norm(workers, &r) / norm(workers, b))
}

/// The items in a list.
fn listed<T>(items: impl Iterator<Item = T> + Clone) -> Result<Vec<T>> {
    let mut list = try_with_capacity(items.clone().count(), "the distances that are held")?;
    list.extend(items);
    Ok(list)
}
