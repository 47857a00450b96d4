//! The energy that a field minimises, paper 000 (10), as a quadratic form on the control points of one grid.
//!
//! ```text
//! f(c) = sum m phi(p)^2 + lambda_n sum m |grad phi(p) - s n|^2 + (lambda_r/|V|) int ||hess phi||_F^2 dV + lambda_d E_d
//! ```
//!
//! all in units of D; m is 1/N, or the share of a point that counts for more or less than others; s is 1 where the design may be outside
//! and -1 where it may be inside, E_d is (9) kept away from the surface: see [`distance`](super::distance). Half its gradient is A c - b.

use super::data::{Data, DataTerm, Misfit};
use super::distance::{DistanceTerm, FarDistances};
use super::held::Held;
use super::levels::{Level, Terms, multigrid};
use crate::error::try_vec;
use crate::geometry::Cloud;
use crate::linalg::multigrid::Multigrid;
use crate::par::Workers;
use crate::spline::Grid;
use crate::{Error, Result};

/// Weights of the terms, dimensionless.
#[derive(Debug, Clone, Copy)]
pub struct EnergyWeights {
    /// lambda_n
    pub normal: f64,
    /// lambda_r
    pub smooth: f64,
}

/// The multigrid of an energy.
type BorrowingMultigrid<'a, const D: usize> = Multigrid<Level<&'a DataTerm<D>, &'a mut Terms<D>, D>>;

/// The form on one grid.
pub struct Energy<const D: usize = 3> {
    /// In units of D.
    grid: Grid<D>,
    weights: EnergyWeights,
    data: DataTerm<D>,
    terms: Terms<D>,
}

impl<const D: usize> Energy<D> {
    /// The form on `grid`, in units of D, for `data` in its cells.
    pub fn new(data: Data<D>, grid: Grid<D>, weights: EnergyWeights) -> Result<Self> {
        let data = DataTerm::new(data, weights.normal);
        let terms = Terms::new(data.view(grid, [1; D])?, weights.smooth)?;
        Ok(Energy { grid, weights, data, terms })
    }

    /// Distances to the points that count, and where they are held. `tell` is told the fraction done, and may stop.
    pub(super) fn measure(
        &self,
        workers: &Workers,
        tell: impl FnMut(f64) -> Result<()>,
    ) -> Result<(FarDistances, Option<Held>)> {
        let far = FarDistances::new(self.counted()?, &self.grid, workers, tell)?;
        let held = far.held(&self.data.counted_numbers()?)?;
        Ok((far, held))
    }

    /// Distances where they were `held`, to the points as they are now.
    pub(super) fn keep(&self, held: &Held) -> Result<FarDistances> {
        let (data, places) = (self.data.points(), self.data.points().places()?);
        FarDistances::kept(held, &self.grid, |number| {
            let xi = data.xi[places[number as usize] as usize];
            std::array::from_fn(|a| xi[a] * self.grid.axes[a].cell)
        })
    }

    /// Adds the distance term for `far`, with weight `relative` lambda_r / h^4.
    pub fn hold(&mut self, far: FarDistances, relative: f64) -> Result<()> {
        let lambda_d = relative * self.weights.smooth / self.grid.longest_cell().powi(4);
        self.terms.distance = Some(DistanceTerm::new(far, &self.grid, lambda_d)?);
        Ok(())
    }

    /// The grid, in units of D.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// Takes the memory that applying the form works in.
    pub fn reserve(&mut self) -> Result<()> {
        self.terms.smoothness.reserve()
    }

    /// The data terms.
    pub fn data(&self) -> &DataTerm<D> {
        &self.data
    }

    /// The data terms, to be weighed anew.
    pub fn data_mut(&mut self) -> &mut DataTerm<D> {
        &mut self.data
    }

    /// The points whose normals count, as [`DataTerm::counted`] gives them.
    pub fn counted(&self) -> Result<Cloud<D>> {
        self.data.counted(&self.grid)
    }

    /// How far each point is from what the data ask for at control points `x`, as [`DataTerm::misfits`] gives it.
    pub fn misfits(&self, workers: &Workers, x: &[f64], sign: f64, flattest: f64) -> Result<Vec<Misfit>> {
        self.data.misfits(&self.terms.view, workers, x, sign, flattest)
    }

    /// Multiplies lambda_r by `factor`, in the smoothness alone.
    pub fn smoothen(&mut self, factor: f64) {
        self.terms.smoothness.scale(factor);
    }

    /// b, for gradients `sign` n at the points and distances `sign` d away from them.
    pub fn right_hand_side(&mut self, workers: &Workers, sign: f64) -> Result<Vec<f64>> {
        let mut b = try_vec(self.grid.n_control(), 0.0, "the right-hand side")?;
        self.data.add_right_hand_side(&self.terms.view, workers, sign, &mut b);
        check_normals(&b, self.weights.normal, &self.grid, self.data.n_points())?;
        if let Some(distance) = &mut self.terms.distance {
            distance.add_right_hand_side(workers, sign, &mut b);
        }
        Ok(b)
    }

    /// The diagonal of A.
    pub fn diagonal(&mut self, workers: &Workers) -> Result<Vec<f64>> {
        self.terms.diagonal(&self.data, workers)
    }

    /// y = A x
    pub fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.terms.apply(&self.data, workers, x, y);
    }

    /// The multigrid of A.
    pub(super) fn multigrid(&mut self, workers: &Workers) -> Result<BorrowingMultigrid<'_, D>> {
        multigrid(&self.data, &mut self.terms, workers)
    }

    /// The points and the terms, to be borrowed apart.
    pub(super) fn parts_mut(&mut self) -> (&DataTerm<D>, &mut Terms<D>) {
        (&self.data, &mut self.terms)
    }

    /// The points and the terms.
    pub(super) fn into_parts(self) -> (DataTerm<D>, Terms<D>) {
        (self.data, self.terms)
    }
}

/// [`Error::Degenerate`] where `b`, what the normals of `n_points` points ask for on `grid`, is nothing.
pub(super) fn check_normals<const D: usize>(
    b: &[f64],
    normal_weight: f64,
    grid: &Grid<D>,
    n_points: usize,
) -> Result<()> {
    // What one point adds where no other is near; normals that cancel out leave rounding of it.
    let shortest = grid.axes.iter().fold(f64::INFINITY, |m, a| m.min(a.cell));
    let one = normal_weight / (n_points as f64 * shortest);
    if b.iter().all(|b| b.abs() <= 1e-12 * one) {
        let text = "the normals cancel out, so that the surface has no outer side; normals out of the solid are needed";
        return Err(Error::Degenerate(text.into()));
    }
    Ok(())
}
