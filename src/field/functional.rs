//! Sums of values of a field, as vectors on its control points: g of J = sum of w_j phi(x_j), with J = g . c as far as phi is linear in c,
//! and dJ = g . dc.

use super::Field;
use super::eval::{Place, check_points};
use crate::error::try_vec;
use crate::isa::Portable;
use crate::spline::basis::Weights;
use crate::{Error, Result};

impl<const D: usize> Field<D> {
    /// dJ / dc of J = sum of w_j phi(x_j) over `points`, as many as `weights`, each 1 where there are none: for the row-major control
    /// points, of a refined field for those of all tables. Points outside the box count as they are [continued](super::beyond).
    pub(super) fn functional(&self, points: &[[f64; D]], weights: Option<&[f64]>) -> Result<Vec<f64>> {
        if let Some(weights) = weights.filter(|w| w.len() != points.len()) {
            let (n, given) = (points.len(), weights.len());
            return Err(Error::InvalidArgument(format!("{n} points come with {given} weights; as many are needed")));
        }
        check_points(0, points)?;
        let n = self.refined.as_ref().map_or(self.coefficients.len(), |r| r.tables().len());
        let mut sums = try_vec(n, 0.0, "the functional")?;
        let mut of_level = 0.0;
        for (j, p) in points.iter().enumerate() {
            let w = weights.map_or(1.0, |w| w[j]);
            if !w.is_finite() {
                return Err(Error::InvalidArgument(format!("weight {j} is {w}; it must be finite")));
            }
            let xi = self.cells.coordinates(p);
            if self.cells.contain(&xi) {
                add(&mut sums, &self.place_near(xi), w);
            } else {
                let depends = self.dependence(xi);
                add(&mut sums, &depends.place, w * depends.on_polynomial);
                of_level += w * depends.on_level;
            }
        }
        if of_level != 0.0 {
            let mut n_corners = 0.0;
            self.for_face_corners(|_| n_corners += 1.0);
            self.for_face_corners(|place| add(&mut sums, &place, of_level / n_corners));
        }
        Ok(sums)
    }
}

/// Adds `w` times the value at `place`.
fn add<const D: usize>(sums: &mut [f64], place: &Place<D>, w: f64) {
    let weights = place.u.map(Weights::at);
    place.stencil.scatter::<Portable>(&mut sums[place.table..], &weights, w, [0.0; D]);
}
