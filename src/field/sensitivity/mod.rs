//! How values of a fitted field change as the boundary does: what paper 000, section 3.5, leaves open for a boundary that varies.
//!
//! Takes a field with the cloud it was fitted to, and then, for each J = sum of w_j phi(x_j), gives dJ/dp and dJ/dn of all points p and
//! normals n of the cloud. One solve for each J, however many points there are: the paper counts one for each point, or for each value.
//!
//! Notation, in units of D: A c = b the system of the minimum (11); g = dJ/dc; A lambda = g; psi the spline of the control points lambda;
//! m_v, m_n what a point counts for in the sums of values and of gradients; M, x, d a cell in which a distance is held: its mass, middle
//! and distance, with sign; q the point of the cloud nearest to x.
//!
//! ```text
//! dJ = g . dc = lambda . (db - dA c)
//!    = -d sum of m_v psi(p) phi(p) + lambda_n m_n grad psi(p) . (grad phi(p) - s n) + M psi(x) (phi(x) - s d),   c and lambda standing still
//!
//! dJ/dp = -m_v (phi grad psi + psi grad phi) - lambda_n m_n (hess phi grad psi + hess psi (grad phi - s n))
//!         + sum of s M psi(x) sign(d) (p - x) / |p - x| over the x of which q is p
//! dJ/dn = lambda_n m_n s grad psi, less its part along n, since the cloud makes normals unit vectors
//! ```
//!
//! | here | does |
//! |---|---|
//! | `form` | the form whose minimum the field is, made again; A lambda = g |
//! | `chain` | from phi and psi to dJ/dp and dJ/dn |
//!
//! What stands still: the box, D, the weights, the cells and their levels, what each point counts for after the rounds of reweighting (the
//! field remembers, `weighed`), and of the distances held in which cells they are, how much they count there, their sign and q. The
//! distances themselves follow the points: far from the surface it is they that phi follows. So this is the derivative of the field
//! that [`Field::refit`] gives with [`Reweighting::Kept`](super::Reweighting::Kept). It is smooth in the points but where one crosses to a
//! cell of another level.

mod chain;
mod form;

use super::{Field, FitOptions, fit};
use crate::error::{Error, try_vec, try_with_capacity};
use crate::geometry::Cloud;
use crate::geometry::vec::text;
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Result, spline::Grid};
use chain::Chain;
use form::Form;

/// Residuals of a field that is the minimum, in the tolerance of its fit: a little more than 1, for another order of sums.
const RESIDUAL: f64 = 2.0;

/// The same, beside which rounding of the control points is nothing.
const ROUNDING: f64 = 1e-9;

/// A field and its cloud, ready for any number of solves.
pub struct Sensitivity<const D: usize = 3> {
    field: Field<D>,
    form: Form<D>,
    chain: Chain<D>,
    /// Numbers in the caller's cloud of the points that count; `None` where all do.
    counted: Option<Vec<u32>>,
    /// Points of the caller's cloud.
    n_points: usize,
    effort: Effort,
}

/// How far a solve goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Relative residual |g - A lambda| / |g| to reach.
    pub tolerance: f64,
    /// Iterations after which not having reached it is an error.
    pub max_iterations: u32,
    /// Threads: 0 for all cores, 1 for none but the caller's.
    pub n_threads: u32,
}

impl From<&FitOptions> for Effort {
    fn from(options: &FitOptions) -> Self {
        let FitOptions { tolerance, max_iterations, n_threads, .. } = *options;
        Effort { tolerance, max_iterations, n_threads }
    }
}

/// J = sum of w_j phi(x_j).
#[derive(Debug, Clone, Copy)]
pub struct Functional<'a, const D: usize = 3> {
    /// x [n x D], in the caller's unit of length; in the box or outside it.
    pub points: &'a [[f64; D]],
    /// w `[n]`; `None`: each is 1.
    pub weights: Option<&'a [f64]>,
}

/// Where the derivatives of J go; `None` where one is not wanted. Of points that do not count they are 0.
#[derive(Default)]
pub struct Derivatives<'a, const D: usize = 3> {
    /// dJ/dp [N x D], without unit for w without unit.
    pub points: Option<&'a mut [[f64; D]]>,
    /// dJ/dn [N x D], in the caller's unit of length, at right angles to the normals.
    pub normals: Option<&'a mut [[f64; D]]>,
}

impl<const D: usize> Sensitivity<D> {
    /// Makes ready for the derivatives of `field` with respect to `cloud`, to which it was fitted with `options`: their weights are those of
    /// the energy, their tolerance is what the field is held to. [`Error::InvalidArgument`] where the field is not the minimum for them.
    pub fn new(field: &Field<D>, cloud: &Cloud<D>, options: &FitOptions, progress: &mut Progress) -> Result<Self> {
        options.validate::<D>()?;
        let n_counted = cloud.counted_points().count();
        check_size(field, n_counted, options.memory_limit)?;
        check_count(field, n_counted)?;
        progress.tell(0.0, "assembly")?;
        let n_points = cloud.len();
        let numbers = numbers_of_counted(cloud, n_counted)?;
        let counted = cloud.counted()?;
        let cloud = counted.as_ref().unwrap_or(cloud);
        check_places(field, cloud)?;
        let workers = Workers::new(options.n_threads)?;
        let (form, residual) = Form::new(field, cloud, options, &workers, progress)?;
        check_minimum(residual, options)?;
        let chain = Chain::new(field, cloud, &form)?;
        progress.tell(1.0, "done")?;
        Ok(Sensitivity { field: field.try_clone()?, form, chain, counted: numbers, n_points, effort: options.into() })
    }

    /// Points of the cloud.
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    /// The derivatives of `j`: one solve. `effort` `None`: that of the options. After an error the outputs are unspecified. The result does
    /// not depend on earlier solves, nor on the number of threads.
    pub fn solve(
        &mut self,
        j: Functional<D>,
        effort: Option<Effort>,
        mut derivatives: Derivatives<D>,
        progress: &mut Progress,
    ) -> Result<()> {
        for (name, room) in [("points", &derivatives.points), ("normals", &derivatives.normals)] {
            if let Some(room) = room.as_ref().map(|r| r.len()).filter(|n| *n != self.n_points) {
                let n = self.n_points;
                return Err(Error::InvalidArgument(format!(
                    "the derivatives by {name} have room for {room} points; the cloud has {n}"
                )));
            }
        }
        let effort = effort.unwrap_or(self.effort);
        let workers = Workers::new(effort.n_threads)?;
        progress.tell(0.0, "solve")?;
        let sums = self.field.functional(j.points, j.weights)?;
        let lambda = self.form.solve(sums, effort, &workers, progress)?;
        let psi = self.form.spline(&self.field, lambda)?;
        let Some(counted) = &self.counted else {
            self.chain.pull(&self.field, &psi, &workers, &mut derivatives)?;
            return progress.tell(1.0, "done");
        };
        let room = || try_vec(counted.len(), [0.0; D], "the derivatives");
        let (mut points, mut normals) = (room()?, room()?);
        let of_counted = &mut Derivatives { points: Some(&mut points), normals: Some(&mut normals) };
        self.chain.pull(&self.field, &psi, &workers, of_counted)?;
        for (all, of_counted) in [(derivatives.points, points), (derivatives.normals, normals)] {
            let Some(all) = all else { continue };
            all.fill([0.0; D]);
            counted.iter().zip(of_counted).for_each(|(i, derivative)| all[*i as usize] = derivative);
        }
        progress.tell(1.0, "done")
    }
}

/// Numbers of the points of `cloud` that count, `n` of them; `None` where all do.
fn numbers_of_counted<const D: usize>(cloud: &Cloud<D>, n: usize) -> Result<Option<Vec<u32>>> {
    let Some(weights) = cloud.weights().filter(|_| n < cloud.len()) else { return Ok(None) };
    let mut numbers = try_with_capacity(n, "the numbers of the points that count")?;
    numbers.extend((0..).zip(weights).filter(|(_, w)| **w > 0.0).map(|(i, _): (u32, _)| i));
    Ok(Some(numbers))
}

/// Refuses a cloud of another number of points than the field was fitted to, as far as the field knows.
fn check_count<const D: usize>(field: &Field<D>, n: usize) -> Result<()> {
    let fitted = field.report().n_points;
    if fitted == 0 || fitted == n as u64 {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!(
        "the field was fitted to {fitted} points, but {n} points of the cloud count; the cloud of its fit is needed"
    )))
}

/// Refuses points outside the box.
fn check_places<const D: usize>(field: &Field<D>, cloud: &Cloud<D>) -> Result<()> {
    let Some(i) = cloud.points().iter().position(|p| !field.grid().holds(p)) else { return Ok(()) };
    let p = text(&cloud.points()[i]);
    Err(Error::InvalidArgument(format!(
        "point {i} is {p}, outside the field's box; the cloud that the field was fitted to is needed"
    )))
}

/// Refuses a field that is not the minimum.
fn check_minimum(residual: f64, options: &FitOptions) -> Result<()> {
    let most = RESIDUAL * options.tolerance + ROUNDING;
    // A NaN is refused too.
    if residual <= most {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!(
        "the field leaves a relative residual of {residual:.3e} for this cloud and these options, more than {most:.3e}: it is not their \
         fit; the cloud, lambda_normal, lambda_smooth, distance_weight and tolerance of the fit are needed, and a field that was loaded no \
         more knows what reweighting made of the points: refit it, or fit with reweightings 0"
    )))
}

/// Bytes of a point: its places and normals in the chain, its forces, the trees to find the nearest; of a held cell: its middle, the force
/// and the point; of an unknown: g, lambda, psi, the field, a table of sums.
fn memory<const D: usize>(n_points: usize, n_unknowns: usize) -> u128 {
    let (n_points, n_unknowns) = (n_points as u128, n_unknowns as u128);
    n_points * (48 + 24 + 160) + n_unknowns * (24 + 24 + 8 + 8 * 6)
}

/// Refuses what would take more than `limit` bytes.
fn check_size<const D: usize>(field: &Field<D>, n_points: usize, limit: u64) -> Result<()> {
    let grid: &Grid<D> = field.grid();
    let n_unknowns = field.refined.as_ref().map_or(grid.n_control(), |r| r.tables().len());
    let of_fit = fit::memory(n_points as u128, grid.shape().map(|n| n as u128));
    let bytes = of_fit + memory::<D>(n_points, n_unknowns);
    if bytes <= u128::from(limit) {
        return Ok(());
    }
    let what = format!("the sensitivity of {n_unknowns} control points to {n_points} points");
    Err(Error::OutOfMemory { what, bytes, limit: Some(u128::from(limit)) })
}

#[cfg(test)]
mod tests;
