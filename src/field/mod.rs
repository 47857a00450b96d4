//! Level-set fields: a smooth function phi, close to the signed distance to a shape, fitted once and evaluated often. Paper 000.
//!
//! Takes a cloud with normals; gives phi, grad phi and hess phi at points. phi > 0 where the design may be.
//!
//! Notation: D the diagonal of the cloud's bounding box; p, n a point of the cloud and its unit normal; c control points; lambda_n,
//! lambda_r the dimensionless weights of (10): with phi = D phi', the paper's dimensional ones are D^2 and D^4 times these.
//!
//! | paper 000 | here |
//! |---|---|
//! | the box and its cells, Algorithm 1, steps 2 and 3 | [`domain`] |
//! | (6), data terms | [`data`] |
//! | (7), regularisation | [`smoothness`] |
//! | (9), distances, in cells away from the surface | [`distance`] |
//! | (10), the energy | [`energy`] |
//! | (11), its minimum, Algorithm 1, step 4 | [`fit`]; its solution: `system`, on ever coarser grids: `levels` |
//! | its section 3.5, derivatives for a boundary that varies | [`sensitivity`] |
//! | its section 5, refinement where needed | `refined` |
//! | (5), evaluation, Algorithm 1, step 5 | [`eval`], [`crate::spline::kernel`] |
//! | nothing: what phi at the samples of a body proves | [`certify`] |
//! | the zero contour of its figures, and any other | [`level_set`]; values on slices and boxes: [`lattice`] |
//!
//! Where we depart:
//! - The regularisation is integrated exactly; sampled at control points, (8), the matrix is singular: see [`crate::spline::gram`].
//! - Weights are dimensionless, so that units do not change the field. The paper's values taken as dimensionless give errors a hundred
//!   times as large as ours: docs/weights.md.
//! - Normals point to the feasible side or away from it as [`Feasible`] says; the paper's (6) takes them into the infeasible side.
//! - Away from the surface phi is held to the distance to the cloud, (9), which the paper states and leaves out, so that its sign is
//!   right there: [`distance`].
//! - Points that the surface misses are weighted more in a few rounds, against the largest error: [`reweight`]; or, where the caller
//!   does not trust the cloud, less: [`robust`].
//! - The minimum is found from zero: the problem is linear, so the paper's start from (1) changes nothing but the count of iterations, and
//!   that from 98 to 94, to 1e-8 by multigrid not at all (`benches/run field guess`). A shape that moves a little is another matter:
//!   [`Field::refit`].
//! - Degree 3 only. The paper studied others and found nothing above 3. Degree 2 has a Hessian that jumps, which no Newton method forgives;
//!   4 and 5 read 125 and 216 control points a point where 3 reads 64, two to three and a half times as many, in rows that
//!   no longer are one vector of four numbers; and every kernel of a fit would need a form for each. What limits the error beside an edge
//!   is the size of a cell: phi is smooth there and the distance is not, whatever the degree.
//! - An axis of the box thinner than 0.05 D is widened to that first, so that a flat cloud has a box: [`domain`].
//! - Outside the box, where the paper's field ends, it is continued: [`beyond`].

#![forbid(unsafe_code)]

pub mod beyond;
pub mod certify;
pub mod data;
pub mod distance;
mod distance_sampler;
pub mod domain;
pub mod energy;
pub mod eval;
pub mod file;
pub mod fit;
pub mod function;
mod functional;
mod groups;
mod held;
pub mod lattice;
pub mod level_set;
mod levels;
mod options;
mod order;
mod refined;
mod report;
pub mod reweight;
pub mod robust;
pub mod sensitivity;
pub mod smoothness;
mod system;
mod weighed;

use crate::error::try_vec;
use crate::spline::Grid;
use crate::spline::axis::Cells;
use crate::{Error, Result};
pub use beyond::Beyond;
pub use certify::{Certificate, CertifyOptions};
pub use eval::Outputs;
pub use file::load;
pub use function::Function;
pub use lattice::Lattice;
pub use level_set::{LevelSet, LevelSetOptions};
pub use options::{Feasible, FitOptions, Reweighting};
use refined::Refined;
pub use report::FitReport;
use weighed::Weighed;

/// A fitted level-set function.
#[derive(Debug, Clone)]
pub struct Field<const D: usize = 3> {
    /// In the caller's units.
    grid: Grid<D>,
    /// The same, as evaluations take it.
    cells: Cells<D>,
    /// Row-major, the last axis contiguous, in the caller's unit of length; none where the field is refined.
    coefficients: Vec<f64>,
    refined: Option<Box<Refined<D>>>,
    feasible: Feasible,
    beyond: Beyond,
    /// D of the cloud.
    diagonal: f64,
    report: FitReport,
    /// What the points counted for in the fit; a file does not keep it.
    weighed: Weighed,
}

impl<const D: usize> Field<D> {
    fn new(grid: Grid<D>, coefficients: Vec<f64>, feasible: Feasible, diagonal: f64, report: FitReport) -> Self {
        Field::with(grid, coefficients, None, feasible, diagonal, report)
    }

    fn of_refined(refined: Refined<D>, feasible: Feasible, diagonal: f64, report: FitReport) -> Self {
        Field::with(*refined.tree().grid(), Vec::new(), Some(Box::new(refined)), feasible, diagonal, report)
    }

    fn with(
        grid: Grid<D>,
        coefficients: Vec<f64>,
        refined: Option<Box<Refined<D>>>,
        feasible: Feasible,
        diagonal: f64,
        report: FitReport,
    ) -> Self {
        let cells = Cells::of(&grid);
        let beyond = Beyond::default();
        let weighed = Weighed::default();
        let mut field = Field { grid, cells, coefficients, refined, feasible, beyond, diagonal, report, weighed };
        field.beyond = field.look_at_faces();
        field
    }

    /// A field of given `control_points`, row-major, the last axis contiguous, in the caller's unit of length, on `grid`. `diagonal` is the
    /// D that its dimensionless figures shall have. The report is empty but for the counts.
    pub fn from_control_points(
        grid: Grid<D>,
        control_points: Vec<f64>,
        feasible: Feasible,
        diagonal: f64,
    ) -> Result<Self> {
        domain::check(&grid, diagonal)?;
        // The product may be larger than a usize.
        let (n, given) = (grid.shape().iter().map(|&n| n as u128).product::<u128>(), control_points.len());
        if n != given as u128 {
            let text = format!("the grid has {n} control points, but {given} are given; as many are needed");
            return Err(Error::InvalidArgument(text));
        }
        if let Some((_, text)) = unusable(&control_points) {
            return Err(Error::InvalidArgument(text));
        }
        let report = FitReport {
            control_points: std::array::from_fn(|a| grid.shape().get(a).map_or(0, |&n| n as u32)),
            n_unknowns: given as u64,
            n_levels: 1,
            clear_sides: f64::NAN,
            convergence_rate: f64::NAN,
            ..FitReport::default()
        };
        Ok(Field::new(grid, control_points, feasible, diagonal, report))
    }

    /// A copy, where there is room for one, but for what the fit's points counted for.
    fn try_clone(&self) -> Result<Self> {
        let mut coefficients = try_vec(self.coefficients.len(), 0.0, "the control points")?;
        coefficients.copy_from_slice(&self.coefficients);
        let refined = self.refined.as_ref().map(|r| r.try_clone().map(Box::new)).transpose()?;
        Ok(Field { coefficients, refined, weighed: Weighed::default(), ..*self })
    }

    /// The box, its cells and control points; of a refined field the longest cells.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// Control points, row-major, the last axis contiguous; none where the field is refined.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Whether cells were refined, so that there is no one tensor of control points.
    pub fn is_refined(&self) -> bool {
        self.refined.is_some()
    }

    /// Side where phi > 0.
    pub fn feasible(&self) -> Feasible {
        self.feasible
    }

    /// How the field goes on outside its box.
    pub fn beyond(&self) -> &Beyond {
        &self.beyond
    }

    /// D: the unit of dimensionless figures.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// What the fit did.
    pub fn report(&self) -> &FitReport {
        &self.report
    }

    /// Bytes that the field holds for evaluation: what it remembers of its fit does not count, and does not outlive a file.
    pub fn bytes(&self) -> usize {
        let refined = self.refined.as_ref().map_or(0, |r| r.bytes());
        size_of::<Self>() + self.coefficients.capacity() * size_of::<f64>() + refined
    }
}

/// Control points up to this size keep evaluations in the box in the range of doubles: Hessians divide by a cell twice, of 1e-90 and more.
const LARGEST_CONTROL_POINT: f64 = 1e100;

/// The first control point that no field can have, and why.
fn unusable(control_points: &[f64]) -> Option<(usize, String)> {
    // A NaN is in no range.
    let usable = -LARGEST_CONTROL_POINT..=LARGEST_CONTROL_POINT;
    let i = control_points.iter().position(|c| !usable.contains(c))?;
    let c = control_points[i];
    Some((i, format!("control point {i} is {c:?}; it must be finite, and at most {LARGEST_CONTROL_POINT:e} in size")))
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_multigrid;
#[cfg(test)]
mod tests_plane;
#[cfg(test)]
mod tests_refined;
