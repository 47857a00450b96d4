//! Co-generation by the paper: (37) to (43), Algorithm 1.
//!
//! Among the cells that collide as both parts may have them, (33) and (34), densities are sought that
//!
//!   maximise V_1 + V_2  with  g_21 = 0, g_12 = 0, gamma V_1 - (1 - gamma) V_2 = 0.
//!
//! Where we depart: (38) and (43) leave the multipliers to the reader, and those of a maximisation would have to be negative; here the method of
//! moving asymptotes finds them, for the constraints as inequalities within a tolerance. The paper stops at densities, and what it shows are
//! those above 1/2, which still collide: here these go through closure, which takes out what collides and fills up what is free.

use super::bits::Bits;
use super::closure::{Pair, close, larger};
use super::conflict::{Conflicts, Side};
use super::correlation::{Correlation, Measures};
use super::mma::{Mma, Problem};
use crate::error::{try_vec, try_with_capacity};
use crate::geometry::vec::number;
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OptimiseOptions {
    /// gamma of (37d), in [0, 1]: V_2 / (V_1 + V_2) of what is left of the colliding cells.
    pub gamma: f64,
    /// Iterations, at most.
    pub max_iterations: usize,
    /// It ends when an iteration changes less than this fraction of the colliding cells' volume.
    pub tolerance: f64,
    /// What the measures may be at the end, as fractions of what they begin with, and the two sides of (37d), as one of the volume.
    pub feasibility: f64,
    /// The part from which closure begins; by default that with the larger volume.
    pub from: Option<Side>,
}

/// What is shaped.
#[derive(Debug, Clone, Copy)]
pub struct Design<'a, const D: usize> {
    /// The paper's measure, by which densities are found.
    pub correlation: &'a Correlation<D>,
    /// The graph in which they are closed: the measure's own, or that of overlaps.
    pub conflicts: &'a Conflicts,
    /// The cells that each part may have beside the frozen ones of the other: see [`room`](super::room).
    pub room: &'a [Bits; 2],
    /// The frozen cells.
    pub frozen: [&'a Bits; 2],
}

impl Default for OptimiseOptions {
    fn default() -> Self {
        OptimiseOptions { gamma: 0.5, max_iterations: 200, tolerance: 1e-4, feasibility: 1e-3, from: None }
    }
}

/// An iterate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// Volumes of what is left of both parts' colliding cells.
    pub volumes: [f64; 2],
    /// The measures.
    pub measures: Measures,
    /// The part of the colliding volume that changed on the way here.
    pub change: f64,
}

/// Densities, and the pair that they lead to.
#[derive(Debug)]
pub struct Optimised {
    /// Of all cells, `[n_1]` and `[n_2]`.
    pub densities: [Vec<f64>; 2],
    /// What is above 1/2, closed.
    pub pair: Pair,
    /// gamma of that pair: V_2 / (V_1 + V_2) of what is left of the colliding cells; NaN where nothing is.
    pub gamma: f64,
    /// One for each iteration, the first for the beginning.
    pub history: Vec<Iteration>,
    /// Whether the last change is below the tolerance, and no constraint is exceeded by more than it may be off.
    pub converged: bool,
}

/// Cells that are variables, of one part.
struct Variables {
    cells: Vec<u32>,
    /// eps^D
    measure: f64,
    /// Area or volume of the colliding cells that are kept whatever happens.
    frozen: f64,
}

/// Runs Algorithm 1, and closes what it gives.
pub fn optimise<const D: usize>(
    design: &Design<'_, D>,
    options: &OptimiseOptions,
    workers: &Workers,
    progress: &mut Progress<'_>,
) -> Result<Optimised> {
    let Design { correlation, conflicts, room, frozen } = *design;
    options.check()?;
    let colliding = correlation.colliding(workers)?;
    let variables = [Side::First, Side::Second].map(|side| -> Result<Variables> {
        let k = side.index();
        let mut cells = try_with_capacity(colliding[k].count(), "densities")?;
        cells.extend(colliding[k].iter().filter(|&i| room[k].has(i) && !frozen[k].has(i)).map(|i| i as u32));
        let measure = correlation.measure(side);
        let n_frozen = colliding[k].iter().filter(|&i| room[k].has(i) && frozen[k].has(i)).count();
        Ok(Variables { cells, measure, frozen: n_frozen as f64 * measure })
    });
    let [one, two] = variables;
    let variables = [one?, two?];
    let mut densities = [const { Vec::new() }; 2];
    for (rho, set) in densities.iter_mut().zip(room) {
        *rho = try_vec(set.len(), 0.0, "densities")?;
        set.iter().for_each(|i| rho[i] = 1.0);
    }
    let mut state = State::new(correlation, &variables, options, workers)?;
    let mut history: Vec<Iteration> = Vec::new();
    let mut converged = false;
    for k in 0..=options.max_iterations {
        progress.tell(k as f64 / (options.max_iterations + 1) as f64, "moving asymptotes")?;
        let (iteration, values) = state.evaluate(&densities)?;
        history.push(iteration);
        // Little change where constraints do not hold is no end.
        let holds = values.iter().all(|value| *value <= options.feasibility);
        // Where nothing collides there is nothing to do.
        converged = state.x.is_empty() || k > 0 && holds && state.change < options.tolerance;
        if converged || k == options.max_iterations {
            break;
        }
        state.step(values, &mut densities);
    }
    let kept = |k: usize| Bits::of(room[k].len(), |i| densities[k][i] > 0.5);
    let thresholded = [kept(0)?, kept(1)?];
    let measures = [Side::First, Side::Second].map(|side| correlation.measure(side));
    let from = options.from.unwrap_or_else(|| larger(measures, thresholded.each_ref()));
    let pair = close(conflicts, room, from, &thresholded[from.index()])?;
    let counts = pair.count_some(&colliding);
    let left = [0, 1].map(|k| counts[k] as f64 * measures[k]);
    Ok(Optimised { densities, pair, gamma: left[1] / (left[0] + left[1]), history, converged })
}

impl OptimiseOptions {
    fn check(&self) -> Result<()> {
        if !(0.0..=1.0).contains(&self.gamma) {
            return Err(Error::InvalidArgument(format!("gamma is {}; it must be in [0, 1]", number(self.gamma))));
        }
        for (name, x) in [("tolerance", self.tolerance), ("feasibility", self.feasibility)] {
            if !(x > 0.0 && x < 1.0) {
                return Err(Error::InvalidArgument(format!("the {name} is {}; it must be in (0, 1)", number(x))));
            }
        }
        Ok(())
    }
}

/// What goes from one iteration to the next.
struct State<'a, const D: usize> {
    correlation: &'a Correlation<D>,
    variables: &'a [Variables; 2],
    options: &'a OptimiseOptions,
    workers: &'a Workers,
    mma: Mma<4>,
    /// Densities of the variables, part 1's first.
    x: Vec<f64>,
    /// Derivatives of -f, of g_21 and g_12, of (37d) and of minus that, `[n]` each.
    objective: Vec<f64>,
    gradients: [Vec<f64>; 4],
    /// Derivatives of both measures by all densities.
    all: [[Vec<f64>; 2]; 2],
    /// What the measures, and the volume, are at the beginning.
    first: Option<Measures>,
    volume: f64,
    change: f64,
}

impl<'a, const D: usize> State<'a, D> {
    fn new(
        correlation: &'a Correlation<D>,
        variables: &'a [Variables; 2],
        options: &'a OptimiseOptions,
        workers: &'a Workers,
    ) -> Result<Self> {
        let n = variables[0].cells.len() + variables[1].cells.len();
        let zeros = |n: usize| try_vec(n, 0.0, "the optimisation's derivatives");
        let volume = variables.iter().map(|v| v.cells.len() as f64 * v.measure).sum::<f64>();
        let gradients = [zeros(n)?, zeros(n)?, zeros(n)?, zeros(n)?];
        let sizes = [Side::First, Side::Second].map(|s| correlation.n_cells(s));
        let all = [[zeros(sizes[0])?, zeros(sizes[1])?], [zeros(sizes[0])?, zeros(sizes[1])?]];
        let x = try_vec(n, 1.0, "densities")?;
        let mut state = State {
            correlation,
            variables,
            options,
            workers,
            mma: Mma::new(n)?,
            x,
            objective: zeros(n)?,
            gradients,
            all,
            first: None,
            volume,
            change: 0.0,
        };
        let n_first = variables[0].cells.len();
        for j in 0..n {
            let (measure, share) = if j < n_first {
                (variables[0].measure, options.gamma)
            } else {
                (variables[1].measure, options.gamma - 1.0)
            };
            state.objective[j] = -measure / volume;
            state.gradients[2][j] = share * measure / volume;
            state.gradients[3][j] = -state.gradients[2][j];
        }
        Ok(state)
    }

    /// The iterate's figures, and the constraints' values.
    fn evaluate(&mut self, densities: &[Vec<f64>; 2]) -> Result<(Iteration, [f64; 4])> {
        let [[a, b], [c, d]] = &mut self.all;
        self.correlation.sensitivities([&densities[0], &densities[1]], [[a, b], [c, d]], self.workers)?;
        // g = sum of rho_2 dg_21/drho_2, since it is linear in each density.
        let product = |d: &[f64], rho: &[f64]| d.iter().zip(rho).map(|(d, rho)| d * rho).sum::<f64>();
        let measures = Measures { g21: product(b, &densities[1]), g12: product(c, &densities[0]) };
        let first = *self.first.get_or_insert(measures);
        let n_first = self.variables[0].cells.len();
        let (x1, x2) = self.x.split_at(n_first);
        let volume = |x: &[f64], v: &Variables| x.iter().sum::<f64>() * v.measure + v.frozen;
        let volumes = [volume(x1, &self.variables[0]), volume(x2, &self.variables[1])];
        let of = |g: f64, g0: f64| if g0 > 0.0 { g / g0 } else { 0.0 };
        let ratio = (self.options.gamma * volumes[0] - (1.0 - self.options.gamma) * volumes[1])
            / self.volume.max(f64::MIN_POSITIVE);
        let within = self.options.feasibility;
        let values = [
            of(measures.g21, first.g21) - within,
            of(measures.g12, first.g12) - within,
            ratio - within,
            -ratio - within,
        ];
        for (gradient, all, g0) in [(0, 0, first.g21), (1, 1, first.g12)] {
            let scale = if g0 > 0.0 { 1.0 / g0 } else { 0.0 };
            let cells = (0..2).flat_map(|k| self.variables[k].cells.iter().map(move |&i| (k, i as usize)));
            for (to, (k, i)) in self.gradients[gradient].iter_mut().zip(cells) {
                *to = scale * self.all[all][k][i];
            }
        }
        Ok((Iteration { volumes, measures, change: self.change }, values))
    }

    /// Goes on to the next iterate.
    fn step(&mut self, values: [f64; 4], densities: &mut [Vec<f64>; 2]) {
        let before = self.x.clone();
        let gradients = self.gradients.each_ref().map(Vec::as_slice);
        self.mma.step(&mut self.x, &Problem { objective: &self.objective, values, gradients }, self.workers);
        let n_first = self.variables[0].cells.len();
        let mut changed = 0.0;
        for (j, (x, old)) in self.x.iter().zip(&before).enumerate() {
            let (k, at) = if j < n_first { (0, j) } else { (1, j - n_first) };
            densities[k][self.variables[k].cells[at] as usize] = *x;
            changed += (x - old).abs() * self.variables[k].measure;
        }
        self.change = changed / self.volume;
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::Grid;
    use super::super::motion::{Law, Motion, Wave};
    use super::super::part::Part;
    use super::super::steps::Relative;
    use super::*;
    use std::f64::consts::TAU;

    /// A cam and its follower: at some gammas a part is at times all but gone, from where it has to come back.
    #[test]
    fn a_cam_and_its_follower_end_where_constraints_hold() {
        let n = 60;
        let grid = |y: f64, rows: usize| Grid::new([-0.5, y], 1.0 / n as f64, [n, rows]).unwrap();
        let parts = [Part::whole(grid(-0.5, n)).unwrap(), Part::whole(grid(-0.25, n / 2)).unwrap()];
        let pair = [&parts[0], &parts[1]];
        let wave = Wave { amplitude: 0.125, cycles: 2.0, phase: 0.0 };
        let slide = Motion::slide([0.0, 1.0], Law { offset: 0.75, slope: 0.0, waves: vec![wave] }).unwrap();
        let relative = Relative { from: Motion::turn([0.0; 2], Law::even(TAU)).unwrap(), of: slide };
        let (workers, silent) = (Workers::new(2).unwrap(), &mut Progress::silent());
        let correlation = Correlation::new(pair, &relative, 200, 1 << 30, &workers, silent).unwrap();
        let conflicts = correlation.conflicts(1 << 30, &workers, &mut Progress::silent()).unwrap();
        let (room, frozen) = (pair.map(|p| p.allowed().clone()), pair.map(Part::frozen));
        let design = Design { correlation: &correlation, conflicts: &conflicts, room: &room, frozen };
        for gamma in [0.0, 0.2, 0.6, 0.7, 0.8, 1.0] {
            let options = OptimiseOptions { gamma, ..OptimiseOptions::default() };
            let found = optimise(&design, &options, &workers, silent).unwrap();
            assert!(found.converged && found.history.len() < 100, "{gamma}: {}", found.history.len());
            let (first, last) = (found.history[0], found.history[found.history.len() - 1]);
            let within = 2.0 * options.feasibility * (1.0 + 1e-12);
            assert!(
                last.measures.g21 <= within * first.measures.g21 && last.measures.g12 <= within * first.measures.g12
            );
            let [v1, v2] = last.volumes;
            let all = first.volumes[0] + first.volumes[1];
            assert!((gamma * v1 - (1.0 - gamma) * v2).abs() <= within * all, "{gamma}: {v1} {v2}");
            assert!((found.gamma - gamma).abs() < 0.03, "{gamma}: {}", found.gamma);
        }
    }
}
