//! The other formulations of non-interference that paper 000 compares with, as functions to be called beside a field.
//!
//! Notation: x a point, (p_i, n_i) the points of an oriented cloud, Delta_i = |x - p_i|, d_i the signed distance of x to the plane at p_i,
//! w_i weights, rho the smoothing, k how many nearest points count, D the diagonal of the cloud's box. Values are in the caller's unit of
//! length, positive on the feasible side, outside by default.
//!
//! | paper 000 | here | differentiable | cost |
//! |---|---|---|---|
//! | Hicken and Kaur 2022, (1), linear and quadratic (2.2.3) | [`hicken_kaur`], `curvature`, `terms` | but at the p_i | O(N) |
//! | the same over the k nearest (2.2.3) | `terms` | value and gradient jump where the set changes | O(k log N) |
//! | Lin et al. 2022 (2.1) | `lin`, `terms` | everywhere | O(N) |
//! | Criado Risco et al. 2023 (2.2.3), Bergeles et al. 2015 (1) | `nearest` | value and gradient jump where the nearest change | O(k log N) |
//! | Brelje et al. 2020 (2.1) | [`brelje`] | see there | O(N) at worst |
//!
//! Where we depart: the papers but for (1) are known to us by what paper 000 tells of them, so that all but (1) are reconstructions. None has
//! Hessians here. Evaluation allocates nothing and locks nothing, and gives the same bits whatever the batch.

pub mod brelje;
mod curvature;
pub mod hicken_kaur;
mod lin;
mod nearest;
mod options;
mod terms;

pub use options::{ExplicitOptions, Formulation};

use crate::geometry::Cloud;
use crate::geometry::bounds::DIAGONALS;
use crate::geometry::neighbours::{Neighbour, Neighbours};
use crate::geometry::vec::{scale, text};
use crate::isa::dispatch;
use crate::{Error, Result};
use hicken_kaur::Exponential;
use lin::Power;
use terms::{Mean, Picked, Terms, Wants, Weigh};

/// The most nearest points that are served: they are kept on the stack.
pub const MOST_NEAREST: usize = 64;

/// Queries are taken up to so many D from the middle of the cloud.
const FARTHEST: f64 = 1e12;

/// An explicit formulation on a cloud.
#[derive(Debug)]
pub struct Explicit<const D: usize = 3> {
    options: ExplicitOptions,
    center: [f64; D],
    /// D
    diagonal: f64,
    /// In 1 / D.
    smoothing: f64,
    cloud: Cloud<D>,
    terms: Terms<D>,
    /// Where nearest points are asked for.
    tree: Option<Neighbours<D>>,
}

impl<const D: usize> Explicit<D> {
    /// The formulation of the points of `cloud` that count; their weights say no more than whether they do.
    pub fn new(cloud: &Cloud<D>, options: &ExplicitOptions) -> Result<Self> {
        options.validate()?;
        let cloud = cloud.copy_of_counted()?;
        let (center, diagonal) = (cloud.bounds().center(), cloud.bounds().diagonal());
        if !DIAGONALS.contains(&diagonal) {
            let text = format!("the diagonal of the cloud's box is {diagonal}; it must lie in [1e-90, 1e90]");
            return Err(if diagonal == 0.0 { Error::Degenerate(text) } else { Error::InvalidArgument(text) });
        }
        let is_quadratic = options.formulation == Formulation::HickenKaurQuadratic;
        let asks_spacing = options.formulation.has_smoothing() && options.smoothing == 0.0;
        let tree = match options.n_nearest().is_some() || is_quadratic || asks_spacing {
            true => Some(Neighbours::new(cloud.points())?),
            false => None,
        };
        let mut smoothing = options.smoothing;
        if let Some(tree) = tree.as_ref().filter(|_| asks_spacing) {
            let spacing = hicken_kaur::spacing(&cloud, tree)?;
            smoothing = (hicken_kaur::SMOOTHING_OF_SPACING * diagonal / spacing).clamp(1.0, 1e9);
        }
        let tensors =
            tree.as_ref().filter(|_| is_quadratic).map(|tree| curvature::tensors(&cloud, tree)).transpose()?;
        let terms = Terms::new(&cloud, tensors.as_deref())?;
        let tree = tree.filter(|_| options.n_nearest().is_some());
        Ok(Explicit { options: *options, center, diagonal, smoothing, cloud, terms, tree })
    }

    /// What it was made with.
    pub fn options(&self) -> &ExplicitOptions {
        &self.options
    }

    /// How many points count: N.
    pub fn n_points(&self) -> usize {
        self.cloud.len()
    }

    /// D, in the caller's unit of length.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// rho, in 1 / D; 0 where the formula has none.
    pub fn smoothing(&self) -> f64 {
        if self.options.formulation.has_smoothing() { self.smoothing } else { 0.0 }
    }

    /// Bytes that points, normals and curvatures take, for evaluation alone.
    pub fn bytes(&self) -> usize {
        self.terms.bytes()
    }

    /// Values `[n]`, in the caller's unit, and gradients [n x D] at `points` [n x D], each where wanted. After an error they are unspecified.
    pub fn eval(
        &self,
        points: &[[f64; D]],
        values: Option<&mut [f64]>,
        gradients: Option<&mut [[f64; D]]>,
    ) -> Result<()> {
        let lengths =
            [("values", values.as_ref().map(|v| v.len())), ("gradients", gradients.as_ref().map(|g| g.len()))];
        for (name, len) in lengths {
            if let Some(len) = len.filter(|len| *len != points.len()) {
                let n = points.len();
                return Err(Error::InvalidArgument(format!("{name} has room for {len} points; the batch has {n}")));
            }
        }
        let wants = if gradients.is_some() { Wants::ValueAndGradient } else { Wants::Value };
        let (mut values, mut gradients) = (values, gradients);
        let (mut picked, side) = (Picked::new(), self.options.feasible.sign());
        for (i, x) in points.iter().enumerate() {
            self.check(i, x)?;
            let (value, gradient) = self.at(*x, wants, &mut picked);
            if let Some(values) = &mut values {
                values[i] = side * value;
            }
            if let Some(gradients) = &mut gradients {
                gradients[i] = scale(side, gradient);
            }
        }
        Ok(())
    }

    /// Refuses point `i` where it is not finite, or too far.
    fn check(&self, i: usize, x: &[f64; D]) -> Result<()> {
        let most = FARTHEST * self.diagonal;
        // A NaN compares as false.
        if (0..D).all(|a| (x[a] - self.center[a]).abs() <= most) {
            return Ok(());
        }
        let (x, center) = (text(x), text(&self.center));
        Err(Error::InvalidArgument(format!(
            "point {i} is {x}; coordinates must be finite, and within {most:e} of the cloud's middle {center}"
        )))
    }

    fn at(&self, x: [f64; D], wants: Wants, picked: &mut Picked<D>) -> (f64, [f64; D]) {
        let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; MOST_NEAREST];
        let nearest = match (&self.tree, self.options.n_nearest()) {
            (Some(tree), Some(k)) => {
                let found = tree.nearest(x, |_| true, &mut nearest[..k]);
                &nearest[..found]
            }
            _ => &[],
        };
        match self.options.formulation {
            Formulation::NearestPlane => nearest::plane(&self.cloud, x, &nearest[0]),
            Formulation::NearestPoint => nearest::points(&self.cloud, x, nearest),
            Formulation::HickenKaurLinear | Formulation::HickenKaurQuadratic => {
                self.mean(x, nearest, Exponential { rho: self.smoothing / self.diagonal }, wants, picked)
            }
            Formulation::Lin => {
                let e = self.options.softening * self.diagonal;
                let weights = Power { exponent: self.options.exponent, softening_squared: e * e };
                self.mean(x, nearest, weights, wants, picked)
            }
        }
    }

    /// The mean over the `nearest` points, or all where there are none.
    fn mean(
        &self,
        x: [f64; D],
        nearest: &[Neighbour],
        weights: impl Weigh,
        wants: Wants,
        picked: &mut Picked<D>,
    ) -> (f64, [f64; D]) {
        let terms = match nearest {
            [] => self.terms.all(),
            nearest => self.terms.some(nearest.iter().map(|n| n.index as usize), picked),
        };
        dispatch(Mean { x, terms, weights, wants })
    }
}

#[cfg(test)]
mod tests;
