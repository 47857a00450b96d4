//! Where the samples of one frame are in another's, and how that changes with the poses of both.
//!
//! With y = L_A p + t_A and z = K_B (y - t_B): z = M p + m, M = K_B L_A, m = K_B (t_A - t_B). All that poses do to a constraint goes
//! through these numbers, so a constraint is differentiated by them, sample by sample, and by the parameters once.

use super::pose::{MOST_PARAMETERS, Pose};
use crate::geometry::matrix::{Affine, applied, product};
use crate::geometry::vec::sub;

/// Parameters of both frames, at most.
pub const MOST: usize = 2 * MOST_PARAMETERS;

/// A frame at its parameters.
#[derive(Debug, Clone)]
pub struct Placed<const D: usize> {
    pub pose: Pose<D>,
    /// Index of its first variable; `None` where it is fixed.
    pub first_variable: Option<usize>,
}

/// What a parameter is to the map.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Role {
    ShiftOfSamples(usize),
    LinearOfSamples(usize),
    ShiftOfField(usize),
    LinearOfField(usize),
}

/// The map of samples into the field's frame.
pub struct Relative<'a, const D: usize> {
    samples: &'a Pose<D>,
    field: &'a Pose<D>,
    pub map: Affine<D>,
    /// s_B: what a length in the field's frame is multiplied with.
    pub scale: f64,
    n: usize,
    /// Of the samples' frame; those of the field's come behind them.
    n_of_samples: usize,
    variables: [usize; MOST],
    roles: [Role; MOST],
    /// d (M, m) by each parameter.
    first: [Affine<D>; MOST],
    d_scale: [f64; MOST],
}

impl<'a, const D: usize> Relative<'a, D> {
    /// Of samples in the frame `samples` to a field in the frame `field`. Both may be one and the same frame: nothing moves then.
    pub fn new(samples: &'a Placed<D>, field: &'a Placed<D>) -> Self {
        let (a, b) = (&samples.pose, &field.pose);
        let map = Affine { linear: product(&b.inverse, &a.linear), shift: applied(&b.inverse, sub(a.shift, b.shift)) };
        let mut relative = Relative {
            samples: a,
            field: b,
            map,
            scale: b.scale,
            n: 0,
            n_of_samples: 0,
            variables: [0; MOST],
            roles: [Role::ShiftOfSamples(0); MOST],
            first: [Affine::ZERO; MOST],
            d_scale: [0.0; MOST],
        };
        relative.add(samples, Role::ShiftOfSamples, Role::LinearOfSamples);
        relative.n_of_samples = relative.n;
        relative.add(field, Role::ShiftOfField, Role::LinearOfField);
        relative
    }

    fn add(&mut self, frame: &Placed<D>, shift: impl Fn(usize) -> Role, linear: impl Fn(usize) -> Role) {
        let Some(first) = frame.first_variable else { return };
        let roles = (0..D).map(shift).chain((0..frame.pose.n_linear).map(linear));
        for (i, role) in roles.enumerate() {
            (self.variables[self.n], self.roles[self.n]) = (first + i, role);
            self.first[self.n] = self.derivative(role);
            if let Role::LinearOfField(k) = role {
                self.d_scale[self.n] = self.field.d_scale[k];
            }
            self.n += 1;
        }
    }

    fn derivative(&self, role: Role) -> Affine<D> {
        let (a, b) = (self.samples, self.field);
        let column = |k: usize| b.inverse.map(|row| row[k]);
        match role {
            Role::ShiftOfSamples(k) => Affine { shift: column(k), ..Affine::ZERO },
            Role::LinearOfSamples(k) => Affine { linear: product(&b.inverse, &a.d_linear[k]), ..Affine::ZERO },
            Role::ShiftOfField(k) => Affine { shift: column(k).map(|x| -x), ..Affine::ZERO },
            Role::LinearOfField(k) => Affine {
                linear: product(&b.d_inverse[k], &a.linear),
                shift: applied(&b.d_inverse[k], sub(a.shift, b.shift)),
            },
        }
    }

    /// Parameters.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Of them, those of the samples' frame.
    pub fn n_of_samples(&self) -> usize {
        self.n_of_samples
    }

    /// Index of each parameter among the variables.
    pub fn variables(&self) -> &[usize] {
        &self.variables[..self.n]
    }

    /// d (M, m) by each parameter.
    pub fn first(&self) -> &[Affine<D>] {
        &self.first[..self.n]
    }

    /// d s_B by each parameter.
    pub fn d_scale(&self) -> &[f64] {
        &self.d_scale[..self.n]
    }

    /// The second derivative of (M, m) by the parameters `k` and `l`.
    pub fn second(&self, k: usize, l: usize) -> Affine<D> {
        let (a, b) = (self.samples, self.field);
        let shift =
            |k: usize, i: usize, sign: f64| Affine { shift: b.d_inverse[k].map(|row| sign * row[i]), ..Affine::ZERO };
        match (self.roles[k], self.roles[l]) {
            (Role::LinearOfSamples(k), Role::LinearOfSamples(l)) => {
                Affine { linear: product(&b.inverse, &a.dd_linear[k][l]), ..Affine::ZERO }
            }
            (Role::LinearOfField(k), Role::LinearOfField(l)) => Affine {
                linear: product(&b.dd_inverse[k][l], &a.linear),
                shift: applied(&b.dd_inverse[k][l], sub(a.shift, b.shift)),
            },
            (Role::LinearOfSamples(k), Role::LinearOfField(l)) | (Role::LinearOfField(l), Role::LinearOfSamples(k)) => {
                Affine { linear: product(&b.d_inverse[l], &a.d_linear[k]), ..Affine::ZERO }
            }
            (Role::ShiftOfSamples(i), Role::LinearOfField(l)) | (Role::LinearOfField(l), Role::ShiftOfSamples(i)) => {
                shift(l, i, 1.0)
            }
            (Role::ShiftOfField(i), Role::LinearOfField(l)) | (Role::LinearOfField(l), Role::ShiftOfField(i)) => {
                shift(l, i, -1.0)
            }
            _ => Affine::ZERO,
        }
    }
}
