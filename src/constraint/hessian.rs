//! Second derivatives of terms.
//!
//! With w, beta, a and the couplings of [`aggregation`](super::aggregation), J = s F has, by parameters k and l of the frames,
//!
//! ```text
//! J_kl = s (sum_i w_i (dz_ik hess phi dz_il) + beta_i (g_i dz_ik) (g_i dz_il) + sum_i w_i g_i d2z_ikl + c (F_k, F_l)) + s_k F_l + s_l F_k
//! ```
//!
//! the sums over samples taken by (M, m) first. By points that are variables dz is M, and the coupling is of every point with every other.

use super::aggregation::{Aggregate, SampleWeight};
use super::layout::{BlockOf, Layout};
use super::moments::{AddSecondMoments, BLOCK, SecondMoments};
use super::relative::{MOST, Relative};
use super::term::{Block, Samples, Term, blocks, pulled_back};
use crate::field::Outputs;
use crate::geometry::matrix::{Affine, applied, applied_transposed, matrix, product, transposed};
use crate::geometry::vec::{add, dot, scale};
use crate::isa::dispatch;
use crate::spline::kernel::Hessian;
use crate::{Error, Result};
use std::ops::Range;

/// Numbers of a packed Hessian in space.
const PACKED: usize = 6;

/// A block of samples with second derivatives.
struct SecondBlock<const D: usize> {
    block: Block<D>,
    hessians: [f64; PACKED * BLOCK],
    weights: [SampleWeight; BLOCK],
}

impl<const D: usize> SecondBlock<D> {
    fn new() -> Self {
        let none = SampleWeight { share: 0.0, first: 0.0, second: 0.0 };
        SecondBlock { block: Block::new(), hessians: [0.0; PACKED * BLOCK], weights: [none; BLOCK] }
    }

    /// The Hessian of phi at the `i`th sample.
    fn hessian(&self, i: usize) -> Hessian<D> {
        let n = D * (D + 1) / 2;
        let packed = &self.hessians[n * i..n * (i + 1)];
        // The row of a begins behind those before it, which are D, D - 1, ... long.
        matrix(|a, b| packed[a.min(b) * (2 * D - 1 - a.min(b)) / 2 + a.max(b)])
    }
}

/// Where entries are added.
struct Entries<'a> {
    layout: &'a Layout,
    values: &'a mut [f64],
}

impl Entries<'_> {
    fn add(&mut self, of: Option<BlockOf>, i: usize, j: usize, value: f64) {
        let of = of.expect("the blocks of a term were made with it");
        self.values[self.layout.index(of, i, j)] += value;
    }
}

/// A term whose sums over samples are known.
struct Second<'a, const D: usize> {
    term: &'a Term<D>,
    x: &'a [f64],
    relative: &'a Relative<'a, D>,
    /// The multipliers of the rows.
    lambda: &'a [f64],
    aggregate: Option<Aggregate>,
    /// The derivative of F by (M, m), F_k and the same of the shares.
    by_map: Affine<D>,
    by_frames: [f64; MOST],
    shares_by_frames: [f64; MOST],
}

impl<const D: usize> Term<D> {
    /// Adds the Hessian of the sum of the rows times `lambda` [n_rows] to `values`.
    pub fn add_hessian(
        &self,
        x: &[f64],
        relative: &Relative<D>,
        lambda: &[f64],
        layout: &Layout,
        values: &mut [f64],
    ) -> Result<()> {
        if lambda.iter().all(|l| *l == 0.0) {
            return Ok(());
        }
        if !self.aggregation.is_smooth() {
            let text =
                format!("value {} is a minimum, which is not smooth and has no Hessian; take KS", self.first_row);
            return Err(Error::Unsupported(text));
        }
        if !self.region.is_smooth() {
            let text = format!(
                "the fields of value {} are combined by a minimum, which is not smooth and has no Hessian; take KS",
                self.first_row
            );
            return Err(Error::Unsupported(text));
        }
        let aggregate = if self.aggregation.is_one() { Some(self.aggregate(x, relative)?.0) } else { None };
        let mut second = Second {
            term: self,
            x,
            relative,
            lambda,
            aggregate,
            by_map: Affine::ZERO,
            by_frames: [0.0; MOST],
            shares_by_frames: [0.0; MOST],
        };
        let mut entries = Entries { layout, values };
        let mut block = SecondBlock::new();
        second.by_frames(&mut block, &mut entries)?;
        if let Samples::Points { .. } = self.samples {
            second.by_points(&mut block, &mut entries)?;
            if second.aggregate.is_some() {
                second.couple_points(&mut block, &mut entries)?;
            }
        }
        Ok(())
    }
}

impl<const D: usize> Second<'_, D> {
    /// What entries are multiplied with: of values of samples it is in their weights.
    fn factor(&self) -> f64 {
        if self.aggregate.is_some() { self.lambda[0] } else { 1.0 }
    }

    /// Couplings (w, w) and (a, w).
    fn coupling(&self) -> [f64; 2] {
        self.aggregate.map_or([0.0; 2], |a| a.coupling())
    }

    fn look_up(&self, range: Range<usize>, block: &mut SecondBlock<D>) -> Result<()> {
        let n = range.len();
        self.term.place(self.x, &self.relative.map, range.clone(), &mut block.block);
        let outputs = Outputs {
            values: Some(&mut block.block.phi[..n]),
            gradients: Some(&mut block.block.gradients[..n]),
            hessians: Some(&mut block.hessians[..n * (D * (D + 1) / 2)]),
        };
        self.term.region.eval_from(range.start, &block.block.z[..n], outputs)?;
        for (i, sample) in range.enumerate() {
            block.weights[i] = match &self.aggregate {
                Some(aggregate) => aggregate.weight(block.block.phi[i]),
                None => SampleWeight { share: 0.0, first: self.lambda[sample], second: 0.0 },
            };
        }
        Ok(())
    }

    /// Frames against frames.
    fn by_frames(&mut self, block: &mut SecondBlock<D>, entries: &mut Entries) -> Result<()> {
        let relative = self.relative;
        // Points in a field that stands still.
        if relative.n() == 0 {
            return Ok(());
        }
        let mut moments = SecondMoments::<D>::EMPTY;
        for range in blocks(0..self.term.n_samples()) {
            let n = range.len();
            self.look_up(range, block)?;
            dispatch(AddSecondMoments {
                weights: &block.weights[..n],
                gradients: &block.block.gradients[..n],
                hessians: &block.hessians[..n * (D * (D + 1) / 2)],
                points: &block.block.points[..n],
                to: &mut moments,
            });
        }
        self.by_map = Affine::of_rows(&moments.first);
        let shares = Affine::of_rows(&moments.share);
        for (k, first) in relative.first().iter().enumerate() {
            (self.by_frames[k], self.shares_by_frames[k]) = (self.by_map.inner(first), shares.inner(first));
        }
        let [ww, aw] = self.coupling();
        let (f, a, ds) = (&self.by_frames, &self.shares_by_frames, relative.d_scale());
        for l in 0..relative.n() {
            let column = applied_to(&moments, &relative.first()[l]);
            for k in l..relative.n() {
                let bent = column.inner(&relative.first()[k]) + self.by_map.inner(&relative.second(k, l));
                let coupled = ww * f[k] * f[l] + aw * (a[k] * f[l] + f[k] * a[l]);
                let scaled = relative.scale * (bent + coupled) + ds[k] * f[l] + ds[l] * f[k];
                self.add_pair(entries, k, l, self.factor() * scaled);
            }
        }
        Ok(())
    }

    /// Adds to the entry of the parameters `k` and `l`.
    fn add_pair(&self, entries: &mut Entries, k: usize, l: usize, value: f64) {
        let n = self.relative.n_of_samples();
        let blocks = &self.term.blocks.frames;
        match (k < n, l < n) {
            (true, true) => entries.add(blocks[0], k, l, value),
            (true, false) => entries.add(blocks[1], k, l - n, value),
            (false, true) => entries.add(blocks[1], l, k - n, value),
            (false, false) => entries.add(blocks[2], k - n, l - n, value),
        }
    }

    /// Each point against itself, without the coupling, and against the field's frame.
    fn by_points(&self, block: &mut SecondBlock<D>, entries: &mut Entries) -> Result<()> {
        let relative = self.relative;
        let [with_itself, with_frame] = self.term.blocks.points;
        let m = &relative.map.linear;
        for range in blocks(0..self.term.n_samples()) {
            self.look_up(range.clone(), block)?;
            for (i, sample) in range.enumerate() {
                let (w, g, h) = (block.weights[i], block.block.gradients[i], block.hessian(i));
                let s: Hessian<D> = matrix(|a, b| w.second * g[a] * g[b] + w.first * h[a][b]);
                let own = product(&transposed(m), &product(&s, m));
                for (a, b) in (0..D).flat_map(|a| (0..=a).map(move |b| (a, b))) {
                    let value = self.factor() * relative.scale * own[a][b];
                    entries.add(with_itself, D * sample + a, D * sample + b, value);
                }
                let y = std::array::from_fn(|a| block.block.points[i][a]);
                for k in 0..relative.n() {
                    let by = self.point_by_frame(k, y, &w, g, &s);
                    (0..D).for_each(|a| entries.add(with_frame, D * sample + a, k, self.factor() * by[a]));
                }
            }
        }
        Ok(())
    }

    /// The derivative of s w M^T g, J's by the point `y`, by the parameter `k` of the field's frame.
    fn point_by_frame(&self, k: usize, y: [f64; D], w: &SampleWeight, g: [f64; D], s: &Hessian<D>) -> [f64; D] {
        let (relative, [ww, aw]) = (self.relative, self.coupling());
        let first = &relative.first()[k];
        let turned = scale(relative.scale * w.first, applied_transposed(&first.linear, g));
        let scaled = scale(relative.d_scale()[k] * w.first, applied_transposed(&relative.map.linear, g));
        let (f, a) = (self.by_frames[k], self.shares_by_frames[k]);
        let coupled = ww * w.first * f + aw * (w.share * f + w.first * a);
        let moved = add(applied(s, first.apply(y)), scale(coupled, g));
        add(add(turned, scaled), pulled_back(relative, moved))
    }

    /// Every point against every other, and itself, as the aggregate couples them.
    fn couple_points(&self, block: &mut SecondBlock<D>, entries: &mut Entries) -> Result<()> {
        let [ww, aw] = self.coupling();
        let (of, mut other) = (self.term.blocks.points[0], SecondBlock::new());
        for rows in blocks(0..self.term.n_samples()) {
            self.look_up(rows.clone(), block)?;
            for columns in blocks(0..rows.end) {
                self.look_up(columns.clone(), &mut other)?;
                for (i, row) in rows.clone().enumerate() {
                    let (w, g) = (block.weights[i], pulled_back(self.relative, block.block.gradients[i]));
                    for (j, column) in columns.clone().enumerate().take_while(|(_, column)| *column <= row) {
                        let (v, h) = (other.weights[j], pulled_back(self.relative, other.block.gradients[j]));
                        let coupled = ww * w.first * v.first + aw * (w.share * v.first + w.first * v.share);
                        // Both gradients have s, J one.
                        let c = self.factor() * coupled / self.relative.scale;
                        for (a, g) in g.iter().enumerate() {
                            // Of a point against itself the lower triangle.
                            for (b, h) in h.iter().enumerate().take(if row == column { a + 1 } else { D }) {
                                entries.add(of, D * row + a, D * column + b, c * g * h);
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// The second derivatives by (M, m) times a change of it.
fn applied_to<const D: usize>(moments: &SecondMoments<D>, change: &Affine<D>) -> Affine<D> {
    let rows = std::array::from_fn(|a| {
        let mut sum = [0.0; 4];
        for c in 0..D {
            let pair = a.min(c) * (2 * D - 1 - a.min(c)) / 2 + a.max(c);
            let row = change.row(c);
            (0..4).for_each(|b| sum[b] += dot(moments.second[pair][b], row));
        }
        sum
    });
    Affine::of_rows(&rows)
}
