//! What a block of samples adds to an aggregate and to its derivatives by the map that places the samples.
//!
//! With z = M p + m the derivative of phi by row a of (M, m) is g_a (p, 1): derivatives by all twelve numbers are sums over the samples of
//! products of the gradient with (p, 1), four numbers at a time; second ones, of S = second g g^T + first hess phi, with (p, 1) (p, 1)^T.

// Index loops of fixed length are what the compiler unrolls into vectors, and read like the sums.
#![allow(clippy::needless_range_loop)]

use super::aggregation::{Aggregation, Kind, SampleWeight, SoftMin, slope, y_of};
use super::exponential::exp_of_negative;
use crate::geometry::matrix::Affine;
use crate::isa::{Isa, Kernel};

/// Samples that are looked at at once.
pub const BLOCK: usize = 256;

/// Places samples: z = M p + m.
pub struct Place<'a, const D: usize> {
    pub map: &'a Affine<D>,
    /// Each with a 1 behind it.
    pub points: &'a [[f64; 4]],
    pub z: &'a mut [[f64; D]],
}

impl<const D: usize> Kernel for Place<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let rows: [[f64; 4]; D] = std::array::from_fn(|a| self.map.row(a));
        let columns: [[f64; 4]; 4] =
            std::array::from_fn(|b| std::array::from_fn(|a| rows.get(a).map_or(0.0, |row| row[b])));
        let columns = columns.map(|c| I::load(&c));
        for (p, z) in self.points.iter().zip(self.z) {
            let mut sum = columns[D];
            for b in 0..D {
                sum = I::mul_add_4(I::splat(p[b]), columns[b], sum);
            }
            let mut four = [0.0; 4];
            I::store(sum, &mut four);
            z.copy_from_slice(&four[..D]);
        }
    }
}

/// Sums over samples of e y' g (p, 1), and of e (y - m) g (p, 1).
#[derive(Debug, Clone, Copy)]
pub struct Moments<const D: usize> {
    pub zeroth: [[f64; 4]; D],
    pub first: [[f64; 4]; D],
}

impl<const D: usize> Moments<D> {
    pub const EMPTY: Self = Moments { zeroth: [[0.0; 4]; D], first: [[0.0; 4]; D] };

    /// Takes in others, where the least y of both falls, of these and of the others, by `by`.
    pub fn take_in(&mut self, other: &Self, by: [f64; 2], rho: f64) {
        let [own, others] = by.map(|by| (-rho * by).exp());
        // The least of none is infinite, and what it falls by.
        let shift = by.map(|by| if by.is_finite() { by } else { 0.0 });
        for a in 0..D {
            for b in 0..4 {
                let (zeroth, first) = (self.zeroth[a][b], self.first[a][b]);
                let (z, f) = (other.zeroth[a][b], other.first[a][b]);
                self.zeroth[a][b] = own * zeroth + others * z;
                self.first[a][b] = own * (first + shift[0] * zeroth) + others * (f + shift[1] * z);
            }
        }
    }
}

/// Exponentials of a block, and, where gradients are given, moments.
pub(super) struct Exponentials<'a, const D: usize> {
    pub of: Aggregation,
    /// 1 / D
    pub per_unit: f64,
    pub phi: &'a [f64],
    /// Of phi; none where no moments are wanted.
    pub gradients: Option<&'a [[f64; D]]>,
    /// The samples, each with a 1 behind it.
    pub points: &'a [[f64; 4]],
}

impl<const D: usize> Kernel for Exponentials<'_, D> {
    type Output = (SoftMin, Moments<D>);

    #[inline(always)]
    fn run<I: Isa>(self) -> (SoftMin, Moments<D>) {
        let Exponentials { of: Aggregation { kind, sharpness, .. }, per_unit, phi, gradients, points } = self;
        let n = phi.len();
        let (mut y, mut e) = ([0.0; BLOCK], [0.0; BLOCK]);
        let mut least = f64::INFINITY;
        for i in 0..n {
            y[i] = y_of(kind, phi[i] * per_unit);
            least = if y[i] < least { y[i] } else { least };
        }
        for i in 0..n {
            e[i] = exp_of_negative::<I>(-sharpness * (y[i] - least));
        }
        let (mut sum, mut first) = (0.0, 0.0);
        for i in 0..n {
            sum += e[i];
            first += e[i] * (y[i] - least);
        }
        let mut moments = Moments::EMPTY;
        if let Some(gradients) = gradients {
            if kind == Kind::PNorm {
                (0..n).for_each(|i| e[i] *= slope(phi[i] * per_unit));
            }
            moments.zeroth = weighted::<I, D>(&e[..n], gradients, points);
            if kind == Kind::InducedExponential {
                (0..n).for_each(|i| e[i] *= y[i] - least);
                moments.first = weighted::<I, D>(&e[..n], gradients, points);
            }
        }
        (SoftMin { least, sum, first }, moments)
    }
}

/// Sum of weight g (p, 1).
#[inline(always)]
fn weighted<I: Isa, const D: usize>(weights: &[f64], gradients: &[[f64; D]], points: &[[f64; 4]]) -> [[f64; 4]; D] {
    let mut sums = [I::splat(0.0); D];
    for ((w, g), p) in weights.iter().zip(gradients).zip(points) {
        let p = I::load(p);
        for a in 0..D {
            sums[a] = I::mul_add_4(I::splat(w * g[a]), p, sums[a]);
        }
    }
    let mut rows = [[0.0; 4]; D];
    (0..D).for_each(|a| I::store(sums[a], &mut rows[a]));
    rows
}

/// Pairs a <= c of coordinates, at most.
const PAIRS: usize = 6;

/// First and second derivatives by (M, m), of samples that count for given weights.
#[derive(Debug, Clone, Copy)]
pub struct SecondMoments<const D: usize> {
    /// Sum of first g (p, 1).
    pub first: [[f64; 4]; D],
    /// Sum of share g (p, 1).
    pub share: [[f64; 4]; D],
    /// For pairs of rows of (M, m), in the order of a packed Hessian: sum of S_ac (p, 1) (p, 1)^T.
    pub second: [[[f64; 4]; 4]; PAIRS],
}

impl<const D: usize> SecondMoments<D> {
    pub const EMPTY: Self =
        SecondMoments { first: [[0.0; 4]; D], share: [[0.0; 4]; D], second: [[[0.0; 4]; 4]; PAIRS] };
}

/// Adds a block to second moments.
pub(super) struct AddSecondMoments<'a, const D: usize> {
    pub weights: &'a [SampleWeight],
    pub gradients: &'a [[f64; D]],
    /// Packed.
    pub hessians: &'a [f64],
    /// Each with a 1 behind it.
    pub points: &'a [[f64; 4]],
    pub to: &'a mut SecondMoments<D>,
}

impl<const D: usize> Kernel for AddSecondMoments<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AddSecondMoments { weights, gradients, hessians, points, to } = self;
        let n_pairs = D * (D + 1) / 2;
        for (((w, g), h), p) in weights.iter().zip(gradients).zip(hessians.chunks_exact(n_pairs)).zip(points) {
            let four = I::load(p);
            let mut pair = 0;
            for a in 0..D {
                add::<I>(w.first * g[a], four, &mut to.first[a]);
                add::<I>(w.share * g[a], four, &mut to.share[a]);
                for c in a..D {
                    let s = w.second * g[a] * g[c] + w.first * h[pair];
                    for b in 0..=D {
                        add::<I>(s * p[b], four, &mut to.second[pair][b]);
                    }
                    pair += 1;
                }
            }
        }
    }
}

#[inline(always)]
fn add<I: Isa>(s: f64, x: I::Four, to: &mut [f64; 4]) {
    I::store(I::mul_add_4(I::splat(s), x, I::load(to)), to);
}
