//! One requirement: samples of a design in a field, or in a region of several, a value a sample or one for all, with its derivatives.
//!
//! Notation: p a sample in its frame, z = M p + m in the field's, s the field's scale; J = s F(phi(z_1), phi(z_2), ...), F the aggregate, or
//! each phi by itself; phi that of the region, if it is of several fields.

use super::aggregation::{Aggregate, Aggregation, Kind, SampleWeight, SoftMin};
use super::body::{Body, with_one};
use super::layout::{BlockOf, Span};
use super::moments::{BLOCK, Exponentials, Moments, Place};
use super::region::Region;
use super::relative::Relative;
use crate::Result;
use crate::field::Outputs;
use crate::geometry::matrix::{Affine, applied_transposed};
use crate::geometry::vec::{add, scale};
use crate::isa::dispatch;
use std::ops::Range;
use std::sync::Arc;

/// What is sampled.
#[derive(Debug, Clone)]
pub enum Samples<const D: usize> {
    /// The points of a body, in its frame.
    Body(Arc<Body<D>>),
    /// Points that are variables, in the world, the first coordinate of the first being variable `first_variable`.
    Points { first_variable: usize, n: usize },
}

/// Where a term's entries of the Hessian stand.
#[derive(Debug, Clone, Copy, Default)]
pub struct HessianBlocks {
    /// The frame of the samples against itself; against the field's; the field's against itself.
    pub frames: [Option<BlockOf>; 3],
    /// Points against points, and against the field's frame.
    pub points: [Option<BlockOf>; 2],
}

/// Samples that shall lie where phi of a region is positive.
#[derive(Debug, Clone)]
pub struct Term<const D: usize> {
    pub samples: Samples<D>,
    /// Index of the frame that the samples are in.
    pub samples_frame: usize,
    pub region: Region<D>,
    pub field_frame: usize,
    pub aggregation: Aggregation,
    pub first_row: usize,
    /// Of its entries of the Jacobian.
    pub first_entry: usize,
    pub blocks: HessianBlocks,
}

/// A block of samples: their numbers, places and phi.
pub struct Block<const D: usize> {
    pub points: [[f64; 4]; BLOCK],
    pub z: [[f64; D]; BLOCK],
    pub phi: [f64; BLOCK],
    pub gradients: [[f64; D]; BLOCK],
}

impl<const D: usize> Block<D> {
    pub fn new() -> Self {
        Block { points: [[0.0; 4]; BLOCK], z: [[0.0; D]; BLOCK], phi: [0.0; BLOCK], gradients: [[0.0; D]; BLOCK] }
    }
}

/// An entry of a Jacobian: its row, its place among the term's entries, its variable and its value.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    pub row: usize,
    pub index: usize,
    pub variable: usize,
    pub value: f64,
}

/// Takes what a term gives, row by row.
pub trait Output {
    /// A value; where it is not wanted it comes all the same.
    fn value(&mut self, row: usize, value: f64);

    /// An entry of the Jacobian.
    fn entry(&mut self, entry: Entry);
}

/// Entries alone.
impl<F: FnMut(Entry)> Output for F {
    fn value(&mut self, _row: usize, _value: f64) {}

    fn entry(&mut self, entry: Entry) {
        self(entry);
    }
}

/// The numbers of the samples, block by block.
pub fn blocks(samples: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let end = samples.end;
    samples.step_by(BLOCK).map(move |first| first..(first + BLOCK).min(end))
}

impl<const D: usize> Term<D> {
    /// How many samples.
    pub fn n_samples(&self) -> usize {
        match &self.samples {
            Samples::Body(body) => body.len(),
            Samples::Points { n, .. } => *n,
        }
    }

    /// The variables of points, where these are what is sampled.
    pub fn points(&self) -> Option<Span> {
        match self.samples {
            Samples::Body(_) => None,
            Samples::Points { first_variable, n } => Some(Span { first: first_variable, n: D * n }),
        }
    }

    /// How many values.
    pub fn n_rows(&self) -> usize {
        if self.aggregation.is_one() { 1 } else { self.n_samples() }
    }

    /// An entry, by its row and its place in the whole set.
    pub fn of_set(&self, entry: Entry) -> Entry {
        Entry { row: self.first_row + entry.row, index: self.first_entry + entry.index, ..entry }
    }

    /// Variables that a row has as points.
    pub fn n_point_variables(&self) -> usize {
        match (&self.samples, self.aggregation.is_one()) {
            (Samples::Body(_), _) => 0,
            (Samples::Points { n, .. }, true) => D * n,
            (Samples::Points { .. }, false) => D,
        }
    }

    /// D, in the field's frame; the largest of several fields.
    pub fn unit(&self) -> f64 {
        self.region.unit()
    }

    /// Puts the samples `range`, each with a 1 behind it, into `block`, and places them.
    pub fn place(&self, x: &[f64], map: &Affine<D>, range: Range<usize>, block: &mut Block<D>) {
        let n = range.len();
        let points = &mut block.points[..n];
        match &self.samples {
            Samples::Body(body) => points.copy_from_slice(&body.with_ones()[range]),
            Samples::Points { first_variable, .. } => {
                let x = x[first_variable + D * range.start..].as_chunks::<D>().0;
                points.iter_mut().zip(x).for_each(|(p, x)| *p = with_one(x));
            }
        }
        dispatch(Place { map, points, z: &mut block.z[..n] });
    }

    fn look_up(&self, x: &[f64], map: &Affine<D>, range: Range<usize>, block: &mut Block<D>) -> Result<()> {
        let (first, n) = (range.start, range.len());
        self.place(x, map, range, block);
        let outputs =
            Outputs { values: Some(&mut block.phi[..n]), gradients: Some(&mut block.gradients[..n]), hessians: None };
        self.region.eval_from(first, &block.z[..n], outputs)
    }

    /// The values, one a row.
    pub fn values(&self, x: &[f64], relative: &Relative<D>, values: &mut [f64]) -> Result<()> {
        if self.aggregation.is_one() {
            values[0] = relative.scale * self.aggregate(x, relative)?.0.value();
            return Ok(());
        }
        let mut block = Block::new();
        for range in blocks(0..self.n_samples()) {
            self.place(x, &relative.map, range.clone(), &mut block);
            let values = &mut values[range.clone()];
            let outputs = Outputs { values: Some(&mut *values), ..Outputs::default() };
            self.region.eval_from(range.start, &block.z[..range.len()], outputs)?;
            values.iter_mut().for_each(|v| *v *= relative.scale);
        }
        Ok(())
    }

    /// The aggregate of phi, and the number of the first sample where it is least.
    pub fn aggregate(&self, x: &[f64], relative: &Relative<D>) -> Result<(Aggregate, usize)> {
        let (mut sums, mut least, mut block) = (SoftMin::EMPTY, (f64::INFINITY, 0), Block::new());
        for range in blocks(0..self.n_samples()) {
            let n = range.len();
            self.place(x, &relative.map, range.clone(), &mut block);
            let phi = &mut block.phi[..n];
            let outputs = Outputs { values: Some(&mut *phi), ..Outputs::default() };
            self.region.eval_from(range.start, &block.z[..n], outputs)?;
            if self.aggregation.kind == Kind::Minimum {
                least = (range.start..).zip(phi.iter()).fold(least, |m, (i, v)| if *v < m.0 { (*v, i) } else { m });
            } else {
                sums.merge(self.exponentials::<false>(&block, n).0, self.aggregation.sharpness);
            }
        }
        if self.aggregation.kind == Kind::Minimum {
            sums = SoftMin { least: least.0 / self.unit(), sum: 1.0, first: 0.0 };
        }
        Ok((Aggregate::new(self.aggregation, self.unit(), sums, self.n_samples()), least.1))
    }

    fn exponentials<const MOMENTS: bool>(&self, block: &Block<D>, n: usize) -> (SoftMin, Moments<D>) {
        dispatch(Exponentials {
            of: self.aggregation,
            per_unit: 1.0 / self.unit(),
            phi: &block.phi[..n],
            gradients: MOMENTS.then_some(&block.gradients[..n]),
            points: &block.points[..n],
        })
    }

    /// The Jacobian's entries, and the values.
    pub fn jacobian(&self, x: &[f64], relative: &Relative<D>, to: &mut impl Output) -> Result<()> {
        match (self.aggregation.kind, &self.samples) {
            (Kind::None, _) => self.jacobian_of_each(x, relative, to),
            (Kind::Minimum, _) | (_, Samples::Points { .. }) => self.jacobian_by_weights(x, relative, to),
            (_, Samples::Body(_)) => self.jacobian_of_body(x, relative, to),
        }
    }

    /// The value of a row and its entries by the frames, of F = `value` and its derivative by (M, m).
    fn by_frames(&self, row: usize, relative: &Relative<D>, value: f64, by_map: &Affine<D>, to: &mut impl Output) {
        to.value(row, relative.scale * value);
        let n_points = self.n_point_variables();
        let first = row * (n_points + relative.n()) + n_points;
        for (k, variable) in relative.variables().iter().enumerate() {
            let of_map = relative.scale * by_map.inner(&relative.first()[k]);
            let value = of_map + relative.d_scale()[k] * value;
            to.entry(Entry { row, index: first + k, variable: *variable, value });
        }
    }

    /// In one pass: sums of exponentials and moments are brought to the least value as it is found.
    fn jacobian_of_body(&self, x: &[f64], relative: &Relative<D>, to: &mut impl Output) -> Result<()> {
        let rho = self.aggregation.sharpness;
        let (mut sums, mut moments, mut block) = (SoftMin::EMPTY, Moments::EMPTY, Block::new());
        for range in blocks(0..self.n_samples()) {
            let n = range.len();
            self.look_up(x, &relative.map, range, &mut block)?;
            let (of_block, moments_of_block) = self.exponentials::<true>(&block, n);
            let least = sums.least.min(of_block.least);
            moments.take_in(&moments_of_block, [sums.least - least, of_block.least - least], rho);
            sums.merge(of_block, rho);
        }
        let aggregate = Aggregate::new(self.aggregation, self.unit(), sums, self.n_samples());
        let [zeroth, first] = aggregate.of_moments();
        let rows = std::array::from_fn(|a| {
            std::array::from_fn(|b| zeroth * moments.zeroth[a][b] + first * moments.first[a][b])
        });
        self.by_frames(0, relative, aggregate.value(), &Affine::of_rows(&rows), to);
        Ok(())
    }

    /// In two passes: what each sample counts for is known in the second.
    fn jacobian_by_weights(&self, x: &[f64], relative: &Relative<D>, to: &mut impl Output) -> Result<()> {
        let (aggregate, least) = self.aggregate(x, relative)?;
        let (mut block, mut by_map) = (Block::new(), Affine::ZERO);
        for range in blocks(0..self.n_samples()) {
            self.look_up(x, &relative.map, range.clone(), &mut block)?;
            for (i, sample) in range.enumerate() {
                let weight = self.weight(&aggregate, least, sample, block.phi[i]).first;
                let g = scale(weight, block.gradients[i]);
                add_outer(&mut by_map, g, &block.points[i]);
                self.by_point(0, sample, relative, g, to);
            }
        }
        self.by_frames(0, relative, aggregate.value(), &by_map, to);
        Ok(())
    }

    fn jacobian_of_each(&self, x: &[f64], relative: &Relative<D>, to: &mut impl Output) -> Result<()> {
        let mut block = Block::new();
        for range in blocks(0..self.n_samples()) {
            self.look_up(x, &relative.map, range.clone(), &mut block)?;
            for (i, sample) in range.enumerate() {
                let mut by_map = Affine::ZERO;
                add_outer(&mut by_map, block.gradients[i], &block.points[i]);
                self.by_point(sample, sample, relative, block.gradients[i], to);
                self.by_frames(sample, relative, block.phi[i], &by_map, to);
            }
        }
        Ok(())
    }

    /// The entries of a row by the coordinates of `sample`, of the derivative `g` of F by z.
    fn by_point(&self, row: usize, sample: usize, relative: &Relative<D>, g: [f64; D], to: &mut impl Output) {
        let Samples::Points { first_variable, .. } = self.samples else { return };
        let by_y = pulled_back(relative, g);
        let before =
            row * (self.n_point_variables() + relative.n()) + if self.aggregation.is_one() { D * sample } else { 0 };
        for (a, value) in by_y.into_iter().enumerate() {
            to.entry(Entry { row, index: before + a, variable: first_variable + D * sample + a, value });
        }
    }

    /// What `sample` counts for in an aggregate.
    pub fn weight(&self, aggregate: &Aggregate, least: usize, sample: usize, phi: f64) -> SampleWeight {
        if self.aggregation.kind == Kind::Minimum {
            let first = if sample == least { 1.0 } else { 0.0 };
            return SampleWeight { share: first, first, second: 0.0 };
        }
        aggregate.weight(phi)
    }

    /// Row and variable of each of the Jacobian's entries, in order; `relative` is that of any values of the variables.
    pub fn pattern(&self, relative: &Relative<D>, mut entry: impl FnMut(usize, usize)) {
        for row in 0..self.n_rows() {
            if let Samples::Points { first_variable, .. } = self.samples {
                let first = first_variable + if self.aggregation.is_one() { 0 } else { D * row };
                (first..first + self.n_point_variables()).for_each(|variable| entry(row, variable));
            }
            relative.variables().iter().for_each(|variable| entry(row, *variable));
        }
    }
}

/// to += g (p, 1)
fn add_outer<const D: usize>(to: &mut Affine<D>, g: [f64; D], p: &[f64; 4]) {
    for (row, g) in to.linear.iter_mut().zip(g) {
        row.iter_mut().zip(p).for_each(|(to, p)| *to += g * p);
    }
    to.shift = add(to.shift, g);
}

/// s M^T g: what a derivative by z is by the point.
pub fn pulled_back<const D: usize>(relative: &Relative<D>, g: [f64; D]) -> [f64; D] {
    scale(relative.scale, applied_transposed(&relative.map.linear, g))
}
