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
//! | (10), the energy | [`energy`] |
//! | (11), its minimum, Algorithm 1, step 4 | [`fit`] |
//! | (5), evaluation, Algorithm 1, step 5 | [`eval`], [`crate::spline::kernel`] |
//!
//! Where we depart:
//! - The regularisation is integrated exactly; sampled at control points, (8), the matrix is singular: see [`crate::spline::gram`].
//! - Weights are dimensionless, so that units do not change the field. The paper's values taken as dimensionless give errors ten times as
//!   large as ours: docs/weights.md.
//! - Normals point to the feasible side or away from it as [`Feasible`] says; the paper's (6) takes them into the infeasible side.
//! - Points that the surface misses are weighted more in a few rounds, against the largest error: [`reweight`].
//! - The minimum is found from zero: the problem is linear, so the paper's start from (1) changes nothing but the count of iterations.
//! - Outside the box, where the paper's field ends, it is continued: [`beyond`].

#![forbid(unsafe_code)]

pub mod beyond;
pub mod data;
pub mod distance;
pub mod domain;
pub mod energy;
pub mod eval;
pub mod file;
pub mod fit;
mod multilevel;
mod options;
mod report;
pub mod reweight;
pub mod smoothness;

use crate::Result;
use crate::spline::Grid;
pub use beyond::FarSign;
pub use eval::Outputs;
pub use options::{Feasible, FitOptions};
pub use report::FitReport;

/// A fitted level-set function.
#[derive(Debug, Clone)]
pub struct Field {
    /// In the caller's units.
    grid: Grid,
    /// 1 / cell edge of each axis.
    per_cell: [f64; 3],
    /// Row-major, z contiguous, in the caller's unit of length.
    coefficients: Vec<f64>,
    feasible: Feasible,
    far_sign: FarSign,
    /// D of the cloud.
    diagonal: f64,
    report: FitReport,
}

impl Field {
    fn new(grid: Grid, coefficients: Vec<f64>, feasible: Feasible, diagonal: f64, report: FitReport) -> Result<Self> {
        let per_cell = grid.axes.map(|a| 1.0 / a.cell);
        let far_sign = FarSign::Fixed(feasible.sign());
        let mut field = Field { grid, per_cell, coefficients, feasible, far_sign, diagonal, report };
        field.far_sign = field.sign_on_faces();
        Ok(field)
    }

    /// The box, its cells and control points.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Control points, row-major, z contiguous.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Side where phi > 0.
    pub fn feasible(&self) -> Feasible {
        self.feasible
    }

    /// The sign with which |phi| grows outside the box.
    pub fn far_sign(&self) -> FarSign {
        self.far_sign
    }

    /// D: the unit of dimensionless figures.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// What the fit did.
    pub fn report(&self) -> &FitReport {
        &self.report
    }

    /// Bytes that the field holds.
    pub fn bytes(&self) -> usize {
        size_of::<Field>() + self.coefficients.capacity() * size_of::<f64>()
    }

    /// The sign that phi has on the faces of the box, looked for at the corners of all cells there.
    fn sign_on_faces(&self) -> FarSign {
        let n = self.grid.axes.map(|a| a.n_cells);
        let (mut positive, mut negative) = (false, false);
        for i in 0..=n[0] {
            for j in 0..=n[1] {
                let inner = i > 0 && i < n[0] && j > 0 && j < n[1];
                for k in (0..=n[2]).step_by(if inner { n[2] } else { 1 }) {
                    let (stencil, u) = self.grid.stencil([i, j, k].map(|x| x as f64));
                    let value = stencil.value(&self.coefficients, u);
                    positive |= value > 0.0;
                    negative |= value < 0.0;
                }
            }
        }
        match (positive, negative) {
            (true, true) => FarSign::OfClampedPoint,
            (false, true) => FarSign::Fixed(-1.0),
            (true, false) => FarSign::Fixed(1.0),
            (false, false) => FarSign::Fixed(self.feasible.sign()),
        }
    }
}
