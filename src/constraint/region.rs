//! Where samples may be: where phi of a field is positive, or what set operations make of several fields in one frame.
//!
//! The intersection of the sets where phi_f > 0 is where the least phi_f is positive, their union where the largest is. With F the
//! [aggregate](super::aggregation) of the phi_f at a sample, in units of the largest D among the fields, and its w, beta, a and couplings:
//!
//! ```text
//! grad F = sum_f w_f g_f
//! hess F = sum_f w_f hess phi_f + beta_f g_f g_f^T + c (grad F, grad F), of the coupling (a, w) with sum_f a_f g_f
//! ```
//!
//! So F is a function as phi is, and all that is done with samples in a field is done in a region.

use super::aggregation::{Aggregate, Aggregation, Extreme, Kind, SampleWeight, first_least, sums};
use super::moments::BLOCK;
use crate::field::{Field, Outputs};
use crate::geometry::vec::{add, scale};
use crate::{Error, Result};
use std::sync::Arc;

/// Fields of a region, at most: as many as there is room for to look at one sample at once.
const MOST: usize = BLOCK;

/// Numbers of a packed Hessian in space.
const PACKED: usize = 6;

/// A field, or several of one frame and one unit of length as one.
#[derive(Debug, Clone)]
pub struct Region<const D: usize> {
    /// At least one.
    fields: Vec<Arc<Field<D>>>,
    /// Of the least of what `sign` makes of the phi_f.
    of: Aggregation,
    /// 1, or -1 for the largest.
    sign: f64,
    /// The largest D.
    unit: f64,
    /// What the aggregate of that many values is moved by.
    moved: f64,
}

impl<const D: usize> From<Arc<Field<D>>> for Region<D> {
    fn from(field: Arc<Field<D>>) -> Self {
        let unit = field.diagonal();
        Region { fields: vec![field], of: Aggregation::default(), sign: 1.0, unit, moved: 0.0 }
    }
}

/// phi_f, its gradients and its packed Hessians at some samples, field by field.
struct Looked<const D: usize> {
    phi: [f64; BLOCK],
    gradients: [[f64; D]; BLOCK],
    hessians: [f64; PACKED * BLOCK],
}

/// What a field counts for at a sample.
enum Weights {
    By(Aggregate),
    /// Of the field with this number alone: the least is not smooth.
    Of(usize),
}

impl Weights {
    fn of(&self, f: usize, phi: f64) -> SampleWeight {
        match self {
            Weights::By(aggregate) => aggregate.weight(phi),
            Weights::Of(one) => {
                let first = if f == *one { 1.0 } else { 0.0 };
                SampleWeight { share: first, first, second: 0.0 }
            }
        }
    }

    fn coupling(&self) -> [f64; 2] {
        match self {
            Weights::By(aggregate) => aggregate.coupling(),
            Weights::Of(_) => [0.0; 2],
        }
    }
}

impl<const D: usize> Region<D> {
    /// The intersection of the feasible sets of `fields`, [`Extreme::Least`], or their union, [`Extreme::Largest`], by `combination`, which
    /// lies below or above the least or the largest phi. The fields are in one frame and one unit of length. One alone is itself.
    pub fn new(fields: Vec<Arc<Field<D>>>, extreme: Extreme, combination: Aggregation) -> Result<Self> {
        Self::check_count(fields.len())?;
        combination.validate()?;
        if !combination.is_one() {
            let text = "no combination is asked for; KS, induced exponential, p-norm or minimum is needed";
            return Err(Error::InvalidArgument(text.into()));
        }
        let (sign, of) = extreme.by_the_least(combination);
        let unit = fields.iter().fold(0.0, |most: f64, field| most.max(field.diagonal()));
        let moved = of.moved(fields.len());
        Ok(Region { fields, of, sign, unit, moved })
    }

    /// Refuses none, and more fields than a region may have.
    pub fn check_count(n_fields: usize) -> Result<()> {
        if (1..=MOST).contains(&n_fields) {
            return Ok(());
        }
        Err(Error::InvalidArgument(format!("{n_fields} fields are given; from 1 to {MOST} can be combined")))
    }

    /// D: that of the field, or the largest.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Whether F has a Hessian.
    pub fn is_smooth(&self) -> bool {
        self.fields.len() == 1 || self.of.is_smooth()
    }

    /// Evaluates F as a field evaluates phi, the first point having index `first` in its batch. Allocates nothing that fields do not.
    pub(super) fn eval_from(&self, first: usize, points: &[[f64; D]], outputs: Outputs<D>) -> Result<()> {
        if let [field] = &self.fields[..] {
            return field.eval_from(first, points, outputs);
        }
        let mut looked = Looked { phi: [0.0; BLOCK], gradients: [[0.0; D]; BLOCK], hessians: [0.0; PACKED * BLOCK] };
        let (mut first, mut rest) = (first, outputs);
        for points in points.chunks(BLOCK / self.fields.len()) {
            let (outputs, behind) = rest.split(points.len());
            self.look_up(first, points, &outputs, &mut looked)?;
            self.combine(points.len(), &looked, outputs);
            (first, rest) = (first + points.len(), behind);
        }
        Ok(())
    }

    /// Looks up in each field what the `outputs` of its combination need.
    fn look_up(&self, first: usize, points: &[[f64; D]], outputs: &Outputs<D>, to: &mut Looked<D>) -> Result<()> {
        let (n, n_pairs) = (points.len(), D * (D + 1) / 2);
        let second = outputs.hessians.is_some();
        for (f, field) in self.fields.iter().enumerate() {
            let (start, end) = (f * n, (f + 1) * n);
            let outputs = Outputs {
                values: Some(&mut to.phi[start..end]),
                gradients: (second || outputs.gradients.is_some()).then_some(&mut to.gradients[start..end]),
                hessians: second.then_some(&mut to.hessians[n_pairs * start..n_pairs * end]),
            };
            field.eval_from(first, points, outputs)?;
        }
        Ok(())
    }

    /// F of `n` samples.
    fn combine(&self, n: usize, looked: &Looked<D>, mut outputs: Outputs<D>) {
        let n_pairs = D * (D + 1) / 2;
        for i in 0..n {
            let (value, weights) = self.aggregate(n, i, looked);
            if let Some(values) = &mut outputs.values {
                values[i] = value;
            }
            let hessian = outputs.hessians.as_mut().map(|h| &mut h[n_pairs * i..n_pairs * (i + 1)]);
            if outputs.gradients.is_some() || hessian.is_some() {
                let gradient = self.differentiate((n, i), looked, &weights, hessian);
                outputs.gradients.iter_mut().for_each(|gradients| gradients[i] = gradient);
            }
        }
    }

    /// phi_f of sample `i` of `n`, as it comes to the aggregate of the least.
    fn phi(&self, (n, i): (usize, usize), f: usize, looked: &Looked<D>) -> f64 {
        self.sign * looked.phi[f * n + i]
    }

    fn aggregate(&self, n: usize, i: usize, looked: &Looked<D>) -> (f64, Weights) {
        let phi = (0..self.fields.len()).map(|f| self.phi((n, i), f, looked));
        if self.of.kind == Kind::Minimum {
            let f = first_least(phi);
            return (looked.phi[f * n + i], Weights::Of(f));
        }
        let one = Aggregate::moved_by(self.of, self.unit, sums(self.of, self.unit, phi), self.moved);
        (self.sign * one.value(), Weights::By(one))
    }

    /// The gradient of F at sample `i` of `n`, and its packed `hessian` where one is wanted.
    fn differentiate(
        &self,
        (n, i): (usize, usize),
        looked: &Looked<D>,
        weights: &Weights,
        mut hessian: Option<&mut [f64]>,
    ) -> [f64; D] {
        let n_pairs = D * (D + 1) / 2;
        let (mut w, mut a) = ([0.0; D], [0.0; D]);
        hessian.iter_mut().for_each(|to| to.fill(0.0));
        for f in 0..self.fields.len() {
            let (weight, g) = (weights.of(f, self.phi((n, i), f, looked)), looked.gradients[f * n + i]);
            w = add(w, scale(weight.first, g));
            if let Some(to) = &mut hessian {
                a = add(a, scale(weight.share, g));
                let (second, h) = (self.sign * weight.second, &looked.hessians[n_pairs * (f * n + i)..]);
                for_each_pair::<D>(|pair, j, k| to[pair] += second * g[j] * g[k] + weight.first * h[pair]);
            }
        }
        if let Some(to) = hessian {
            let [ww, aw] = weights.coupling().map(|c| self.sign * c);
            for_each_pair::<D>(|pair, j, k| to[pair] += ww * w[j] * w[k] + aw * (a[j] * w[k] + w[j] * a[k]));
        }
        w
    }
}

/// The pairs of coordinates in the order of a packed Hessian, with their numbers.
#[inline(always)]
fn for_each_pair<const D: usize>(mut work: impl FnMut(usize, usize, usize)) {
    let mut pair = 0;
    for j in 0..D {
        for k in j..D {
            work(pair, j, k);
            pair += 1;
        }
    }
}
