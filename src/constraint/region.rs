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
//! So F is a function as phi is, and all that is done with samples in a field is done in a region. With x of phi_f, or of -phi_f for a union,
//! y, m and S are as there.

use super::aggregation::{Aggregate, Aggregation, Extreme, Kind, SoftMin, first_least, y_of};
use super::exponential::exp_of_negative;
use super::moments::BLOCK;
use crate::field::{Field, Outputs};
use crate::geometry::vec::{add, scale};
use crate::isa::{Isa, Kernel, dispatch};
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

/// What the fields count for at some samples.
struct Sums {
    /// y - m, field by field.
    t: [f64; BLOCK],
    /// exp(-rho (y - m)), field by field; of a minimum 1 for the first field that has it, 0 for others.
    e: [f64; BLOCK],
    /// m, a sample; of a minimum in the unit of phi.
    least: [f64; BLOCK],
    /// S, a sample.
    sum: [f64; BLOCK],
    /// sum e (y - m), a sample.
    first: [f64; BLOCK],
}

/// Fills [`Sums`] for an aggregate that is smooth. Sample beside sample the compiler makes vectors of it.
struct AddUp<'a> {
    of: Aggregation,
    /// What phi is multiplied with to be x.
    per_unit: f64,
    /// Samples.
    n: usize,
    /// `n` of each field.
    phi: &'a [f64],
    to: &'a mut Sums,
}

impl Kernel for AddUp<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AddUp { of: Aggregation { kind, sharpness, .. }, per_unit, n, phi, to } = self;
        let (t, e) = (&mut to.t[..phi.len()], &mut to.e[..phi.len()]);
        let (least, sum, first) = (&mut to.least[..n], &mut to.sum[..n], &mut to.first[..n]);
        t.iter_mut().zip(phi).for_each(|(t, phi)| *t = y_of(kind, phi * per_unit));
        least.copy_from_slice(&t[..n]);
        for y in t.chunks_exact(n) {
            least.iter_mut().zip(y).for_each(|(least, y)| *least = if y < least { *y } else { *least });
        }
        for t in t.chunks_exact_mut(n) {
            t.iter_mut().zip(&*least).for_each(|(t, least)| *t -= least);
        }
        e.iter_mut().zip(&*t).for_each(|(e, t)| *e = exp_of_negative::<I>(-sharpness * t));
        sum.fill(0.0);
        first.fill(0.0);
        for (e, t) in e.chunks_exact(n).zip(t.chunks_exact(n)) {
            sum.iter_mut().zip(e).for_each(|(sum, e)| *sum += e);
            first.iter_mut().zip(e.iter().zip(t)).for_each(|(first, (e, t))| *first += e * t);
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
        let none = [0.0; BLOCK];
        let mut sums = Sums { t: none, e: none, least: none, sum: none, first: none };
        let (mut first, mut rest) = (first, outputs);
        for points in points.chunks(BLOCK / self.fields.len()) {
            let (outputs, behind) = rest.split(points.len());
            self.look_up(first, points, &outputs, &mut looked)?;
            self.add_up(points.len(), &looked, &mut sums);
            self.combine(points.len(), &looked, &sums, outputs);
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

    /// What phi is multiplied with to be x of the aggregate of the least.
    fn per_unit(&self) -> f64 {
        self.sign * (1.0 / self.unit)
    }

    /// What the fields count for at `n` samples.
    fn add_up(&self, n: usize, looked: &Looked<D>, to: &mut Sums) {
        let n_fields = self.fields.len();
        let phi = &looked.phi[..n_fields * n];
        if self.of.kind != Kind::Minimum {
            return dispatch(AddUp { of: self.of, per_unit: self.per_unit(), n, phi, to });
        }
        to.e[..n_fields * n].fill(0.0);
        to.sum[..n].fill(1.0);
        for i in 0..n {
            let f = first_least((0..n_fields).map(|f| self.sign * phi[f * n + i]));
            to.e[f * n + i] = 1.0;
            to.least[i] = self.sign * phi[f * n + i];
        }
    }

    /// F of `n` samples.
    fn combine(&self, n: usize, looked: &Looked<D>, sums: &Sums, mut outputs: Outputs<D>) {
        let n_pairs = D * (D + 1) / 2;
        for i in 0..n {
            let of_sample = SoftMin { least: sums.least[i], sum: sums.sum[i], first: sums.first[i] };
            let one = Aggregate::moved_by(self.of, self.unit, of_sample, self.moved);
            if let Some(values) = &mut outputs.values {
                let value = if self.of.kind == Kind::Minimum { sums.least[i] } else { one.value() };
                values[i] = self.sign * value;
            }
            let hessian = outputs.hessians.as_mut().map(|h| &mut h[n_pairs * i..n_pairs * (i + 1)]);
            if outputs.gradients.is_some() || hessian.is_some() {
                let gradient = self.differentiate((n, i), looked, (sums, &one), hessian);
                outputs.gradients.iter_mut().for_each(|gradients| gradients[i] = gradient);
            }
        }
    }

    /// The gradient of F at sample `i` of `n`, and its packed `hessian` where one is wanted; `one` is the aggregate there.
    fn differentiate(
        &self,
        (n, i): (usize, usize),
        looked: &Looked<D>,
        (sums, one): (&Sums, &Aggregate),
        mut hessian: Option<&mut [f64]>,
    ) -> [f64; D] {
        let n_pairs = D * (D + 1) / 2;
        let (mut w, mut a) = ([0.0; D], [0.0; D]);
        hessian.iter_mut().for_each(|to| to.fill(0.0));
        for at in (0..self.fields.len()).map(|f| f * n + i) {
            let weight = one.weight_of(looked.phi[at] * self.per_unit(), sums.t[at], sums.e[at]);
            let g = looked.gradients[at];
            w = add(w, scale(weight.first, g));
            if let Some(to) = &mut hessian {
                a = add(a, scale(weight.share, g));
                let (second, h) = (self.sign * weight.second, &looked.hessians[n_pairs * at..]);
                for_each_pair::<D>(|pair, j, k| to[pair] += second * g[j] * g[k] + weight.first * h[pair]);
            }
        }
        if let Some(to) = hessian {
            let [ww, aw] = one.coupling().map(|c| self.sign * c);
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
