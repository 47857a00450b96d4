//! A set of requirements over one vector of variables: frames and points that move, samples of them in fields.

use super::aggregation::Aggregation;
use super::body::Body;
use super::layout::{Layout, Span};
use super::pose::{Order, Pose, PoseKind};
use super::region::Region;
use super::relative::{Placed, Relative};
use super::term::{Entry, HessianBlocks, Output, Samples, Term};
use crate::error::try_reserve;
use crate::{Error, Result};
use std::sync::Arc;

/// A frame of a set, by its number; 0 is the world, which does not move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameId(pub usize);

/// The world.
pub const WORLD: FrameId = FrameId(0);

/// A set of points that are variables, by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointsId(pub usize);

#[derive(Debug, Clone)]
enum Frame {
    /// It moves by the variables from this one on.
    Moving { kind: PoseKind, first_variable: usize },
    /// It stands still.
    Fixed { kind: PoseKind, parameters: Vec<f64> },
}

/// How many of each there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Size {
    /// Variables.
    pub n_variables: usize,
    /// Values, each to be kept at or above 0.
    pub n_rows: usize,
    /// Entries of the Jacobian that may differ from 0.
    pub n_jacobian: usize,
    /// Entries of the lower triangle of the Hessian that may differ from 0.
    pub n_hessian: usize,
}

/// Requirements, each of samples in a field, over one vector of variables.
#[derive(Debug, Clone)]
pub struct Constraints<const D: usize> {
    frames: Vec<Frame>,
    points: Vec<Span>,
    terms: Vec<Term<D>>,
    layout: Layout,
    n_variables: usize,
    n_rows: usize,
    n_jacobian: usize,
}

const WHAT: &str = "the constraints";

/// Variables, values and entries: numbers of them fit all integers that optimisers take.
const MOST: usize = i32::MAX as usize;

impl<const D: usize> Default for Constraints<D> {
    fn default() -> Self {
        let kind = PoseKind { rotation: super::pose::Rotation::None, scale: super::pose::Scale::One };
        Constraints {
            frames: vec![Frame::Fixed { kind, parameters: vec![0.0; D] }],
            points: Vec::new(),
            terms: Vec::new(),
            layout: Layout::default(),
            n_variables: 0,
            n_rows: 0,
            n_jacobian: 0,
        }
    }
}

impl<const D: usize> Constraints<D> {
    /// Without variables and requirements.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a frame whose pose has parameters of `kind`, all of them variables, behind those that there are.
    pub fn add_frame(&mut self, kind: PoseKind) -> Result<FrameId> {
        kind.check::<D>()?;
        let n = self.more_variables(kind.n_parameters::<D>())?;
        try_reserve(&mut self.frames, 1, WHAT)?;
        self.frames.push(Frame::Moving { kind, first_variable: self.n_variables });
        self.n_variables = n;
        Ok(FrameId(self.frames.len() - 1))
    }

    /// Adds a frame that stands still at the pose of `kind` with `parameters`.
    pub fn add_fixed_frame(&mut self, kind: PoseKind, parameters: &[f64]) -> Result<FrameId> {
        kind.check::<D>()?;
        let n = kind.n_parameters::<D>();
        if parameters.len() != n {
            let text = format!("the pose has {} parameters; such a frame has {n}", parameters.len());
            return Err(Error::InvalidArgument(text));
        }
        check_variables(parameters, "parameter")?;
        Pose::<D>::at(kind, parameters, Order::Value)?;
        try_reserve(&mut self.frames, 1, WHAT)?;
        self.frames.push(Frame::Fixed { kind, parameters: parameters.to_vec() });
        Ok(FrameId(self.frames.len() - 1))
    }

    /// Adds `n` points of the world whose coordinates are variables, point by point, behind those that there are.
    pub fn add_points(&mut self, n: usize) -> Result<PointsId> {
        if n == 0 || n > MOST / D {
            return Err(Error::InvalidArgument(format!(
                "{n} points are asked for; from 1 to {} can be served",
                MOST / D
            )));
        }
        let n_variables = self.more_variables(D * n)?;
        try_reserve(&mut self.points, 1, WHAT)?;
        self.points.push(Span { first: self.n_variables, n: D * n });
        self.n_variables = n_variables;
        Ok(PointsId(self.points.len() - 1))
    }

    fn more_variables(&self, more: usize) -> Result<usize> {
        fits(self.n_variables as u128 + more as u128, "variables")
    }

    /// Requires that `body`, which moves with `frame`, lies where phi of `region`, a field or several, which moves with `field_frame`, is
    /// positive. Gives the number of its first value.
    pub fn keep_body(
        &mut self,
        (body, frame): (Arc<Body<D>>, FrameId),
        (region, field_frame): (impl Into<Region<D>>, FrameId),
        aggregation: Aggregation,
    ) -> Result<usize> {
        self.check_frame(frame)?;
        self.keep(Samples::Body(body), frame, (region.into(), field_frame), aggregation)
    }

    /// The same of points that are variables.
    pub fn keep_points(
        &mut self,
        PointsId(points): PointsId,
        (region, field_frame): (impl Into<Region<D>>, FrameId),
        aggregation: Aggregation,
    ) -> Result<usize> {
        let Some(span) = self.points.get(points) else {
            let n = self.points.len();
            return Err(Error::InvalidArgument(format!(
                "there is no set of points {points}; {n} were added, counted from 0"
            )));
        };
        let samples = Samples::Points { first_variable: span.first, n: span.n / D };
        self.keep(samples, WORLD, (region.into(), field_frame), aggregation)
    }

    fn keep(
        &mut self,
        samples: Samples<D>,
        frame: FrameId,
        (region, field_frame): (Region<D>, FrameId),
        aggregation: Aggregation,
    ) -> Result<usize> {
        self.check_frame(field_frame)?;
        aggregation.validate()?;
        if frame == field_frame && self.span(frame.0).is_some() {
            let text = format!(
                "samples and field both move with frame {}, so that nothing changes: another frame is needed",
                frame.0
            );
            return Err(Error::InvalidArgument(text));
        }
        let mut term = Term {
            samples,
            samples_frame: frame.0,
            region,
            field_frame: field_frame.0,
            aggregation,
            first_row: self.n_rows,
            first_entry: self.n_jacobian,
            blocks: HessianBlocks::default(),
        };
        let spans = [frame, field_frame].map(|FrameId(f)| self.span(f));
        let a_row = term.n_point_variables() + spans.iter().flatten().map(|s| s.n).sum::<usize>();
        let n_rows = fits(self.n_rows as u128 + term.n_rows() as u128, "values")?;
        let n_jacobian =
            fits(self.n_jacobian as u128 + term.n_rows() as u128 * a_row as u128, "entries of the Jacobian")?;
        try_reserve(&mut self.terms, 1, WHAT)?;
        let mark = self.layout.mark(term.points());
        match blocks_of(&term, spans, &mut self.layout) {
            Ok(blocks) => term.blocks = blocks,
            Err(error) => {
                self.layout.go_back(mark);
                return Err(error);
            }
        }
        let first_row = term.first_row;
        self.terms.push(term);
        (self.n_rows, self.n_jacobian) = (n_rows, n_jacobian);
        Ok(first_row)
    }

    fn check_frame(&self, FrameId(frame): FrameId) -> Result<()> {
        let n = self.frames.len();
        if frame < n {
            return Ok(());
        }
        Err(Error::InvalidArgument(format!("there is no frame {frame}; {n} are there, the world counted, from 0")))
    }

    /// The variables of a frame; none where it stands still.
    fn span(&self, frame: usize) -> Option<Span> {
        match &self.frames[frame] {
            Frame::Moving { kind, first_variable } => {
                Some(Span { first: *first_variable, n: kind.n_parameters::<D>() })
            }
            Frame::Fixed { .. } => None,
        }
    }

    /// First variable of a frame, and how many it has; 0 where it stands still.
    pub fn frame_variables(&self, frame: FrameId) -> Result<(usize, usize)> {
        self.check_frame(frame)?;
        Ok(self.span(frame.0).map_or((0, 0), |s| (s.first, s.n)))
    }

    /// First variable of a set of points, and how many it has.
    pub fn points_variables(&self, PointsId(points): PointsId) -> Result<(usize, usize)> {
        let n = self.points.len();
        match self.points.get(points) {
            Some(span) => Ok((span.first, span.n)),
            None => Err(Error::InvalidArgument(format!(
                "there is no set of points {points}; {n} were added, counted from 0"
            ))),
        }
    }

    /// How many variables, values and entries there are.
    pub fn size(&self) -> Size {
        Size {
            n_variables: self.n_variables,
            n_rows: self.n_rows,
            n_jacobian: self.n_jacobian,
            n_hessian: self.layout.n_entries(),
        }
    }

    fn placed(&self, frame: usize, x: &[f64], order: Order) -> Result<Placed<D>> {
        match &self.frames[frame] {
            Frame::Fixed { kind, parameters } => {
                Ok(Placed { pose: Pose::at(*kind, parameters, Order::Value)?, first_variable: None })
            }
            Frame::Moving { kind, first_variable } => {
                let parameters = &x[*first_variable..first_variable + kind.n_parameters::<D>()];
                let pose = Pose::at(*kind, parameters, order).map_err(|error| match error {
                    Error::InvalidArgument(text) => Error::InvalidArgument(format!(
                        "frame {frame}, with variables from {first_variable} on: {text}"
                    )),
                    other => other,
                })?;
                Ok(Placed { pose, first_variable: Some(*first_variable) })
            }
        }
    }

    /// Calls `work` with each term and how its samples lie to its field at `x`.
    fn for_each(
        &self,
        x: &[f64],
        order: Order,
        mut work: impl FnMut(&Term<D>, &Relative<D>) -> Result<()>,
    ) -> Result<()> {
        self.check_x(x)?;
        for term in &self.terms {
            let samples = self.placed(term.samples_frame, x, order)?;
            let field = self.placed(term.field_frame, x, order)?;
            let mut work = |relative: &Relative<D>| work(term, relative);
            work(&Relative::new(&samples, &field)).map_err(|error| match error {
                Error::InvalidArgument(text) => {
                    Error::InvalidArgument(format!("samples of value {}, in the field's frame: {text}", term.first_row))
                }
                other => other,
            })?;
        }
        Ok(())
    }

    fn check_x(&self, x: &[f64]) -> Result<()> {
        check_length("x", x.len(), self.n_variables, "variables")?;
        check_variables(x, "variable")
    }

    /// The values at `x` `[n_variables]`, `values` `[n_rows]`, in the fields' unit of length times the scale of their frames.
    pub fn values(&self, x: &[f64], values: &mut [f64]) -> Result<()> {
        check_length("values", values.len(), self.n_rows, "values")?;
        self.for_each(x, Order::Value, |term, relative| {
            term.values(x, relative, &mut values[term.first_row..term.first_row + term.n_rows()])
        })
    }

    /// Row and variable of the Jacobian's entries `[n_jacobian]`, row by row; within a row those of points come first, then those of the
    /// samples' frame, then those of the field's.
    pub fn jacobian_pattern(&self, mut entry: impl FnMut(usize, usize)) {
        for term in &self.terms {
            // Which variables there are does not depend on where they are.
            let still = |frame: usize| {
                let mut pose = Pose::<D>::identity();
                pose.n_linear = match &self.frames[frame] {
                    Frame::Moving { kind, .. } => kind.n_linear(),
                    Frame::Fixed { .. } => 0,
                };
                Placed { pose, first_variable: self.span(frame).map(|s| s.first) }
            };
            let (samples, field) = (still(term.samples_frame), still(term.field_frame));
            term.pattern(&Relative::new(&samples, &field), |row, variable| entry(term.first_row + row, variable));
        }
    }

    fn entries(&self, x: &[f64], mut entry: impl FnMut(Entry)) -> Result<()> {
        self.for_each(x, Order::First, |term, relative| {
            term.jacobian(x, relative, &mut |e: Entry| entry(term.of_set(e)))
        })
    }

    /// Values and Jacobian at `x` `[n_variables]` at once: `values` `[n_rows]`, `entries` `[n_jacobian]` in the order of the pattern.
    pub fn values_and_jacobian(&self, x: &[f64], values: &mut [f64], entries: &mut [f64]) -> Result<()> {
        check_length("values", values.len(), self.n_rows, "values")?;
        check_length("entries", entries.len(), self.n_jacobian, "entries")?;
        self.for_each(x, Order::First, |term, relative| {
            term.jacobian(x, relative, &mut Both { values: &mut *values, entries: &mut *entries, term })
        })
    }

    /// The Jacobian's entries at `x` `[n_variables]`, `entries` `[n_jacobian]` in the order of the pattern.
    pub fn jacobian(&self, x: &[f64], entries: &mut [f64]) -> Result<()> {
        check_length("entries", entries.len(), self.n_jacobian, "entries")?;
        self.entries(x, |entry| entries[entry.index] = entry.value)
    }

    /// The Jacobian at `x` `[n_variables]` as a whole, `jacobian` `[n_rows x n_variables]`, row-major.
    pub fn dense_jacobian(&self, x: &[f64], jacobian: &mut [f64]) -> Result<()> {
        let n = self.n_variables;
        check_length("jacobian", jacobian.len(), self.n_rows.saturating_mul(n), "entries")?;
        jacobian.fill(0.0);
        self.entries(x, |entry| jacobian[entry.row * n + entry.variable] = entry.value)
    }

    /// J v, `product` `[n_rows]`, for `v` `[n_variables]`.
    pub fn jacobian_times(&self, x: &[f64], v: &[f64], product: &mut [f64]) -> Result<()> {
        check_length("v", v.len(), self.n_variables, "variables")?;
        check_length("product", product.len(), self.n_rows, "values")?;
        check_variables(v, "entry of v")?;
        product.fill(0.0);
        self.entries(x, |entry| product[entry.row] += entry.value * v[entry.variable])
    }

    /// J^T w, `product` `[n_variables]`, for `w` `[n_rows]`.
    pub fn transposed_jacobian_times(&self, x: &[f64], w: &[f64], product: &mut [f64]) -> Result<()> {
        check_length("w", w.len(), self.n_rows, "values")?;
        check_length("product", product.len(), self.n_variables, "variables")?;
        check_variables(w, "entry of w")?;
        product.fill(0.0);
        self.entries(x, |entry| product[entry.variable] += entry.value * w[entry.row])
    }

    /// Row and column of the entries of the Hessian's lower triangle `[n_hessian]`, each once.
    pub fn hessian_pattern(&self, entry: impl FnMut(usize, usize)) {
        self.layout.for_each(entry);
    }

    /// The Hessian of the sum of the values times `lambda` `[n_rows]` at `x` `[n_variables]`: `entries` `[n_hessian]` in the order of the
    /// pattern.
    pub fn hessian(&self, x: &[f64], lambda: &[f64], entries: &mut [f64]) -> Result<()> {
        check_length("lambda", lambda.len(), self.n_rows, "values")?;
        check_length("entries", entries.len(), self.layout.n_entries(), "entries")?;
        check_variables(lambda, "multiplier")?;
        entries.fill(0.0);
        self.for_each(x, Order::Second, |term, relative| {
            let lambda = &lambda[term.first_row..term.first_row + term.n_rows()];
            term.add_hessian(x, relative, lambda, &self.layout, entries)
        })
    }
}

/// Values and entries of a term in those of its set.
struct Both<'a, const D: usize> {
    values: &'a mut [f64],
    entries: &'a mut [f64],
    term: &'a Term<D>,
}

impl<const D: usize> Output for Both<'_, D> {
    fn value(&mut self, row: usize, value: f64) {
        self.values[self.term.first_row + row] = value;
    }

    fn entry(&mut self, entry: Entry) {
        self.entries[self.term.of_set(entry).index] = entry.value;
    }
}

/// The blocks of the Hessian that a term adds to.
fn blocks_of<const D: usize>(term: &Term<D>, spans: [Option<Span>; 2], layout: &mut Layout) -> Result<HessianBlocks> {
    let mut blocks = HessianBlocks::default();
    let [samples, field] = spans;
    let pairs = [(samples, samples), (samples, field), (field, field)];
    for (block, pair) in blocks.frames.iter_mut().zip(pairs) {
        if let (Some(one), Some(other)) = pair {
            *block = Some(layout.between(one, other)?);
        }
    }
    if let Some(points) = term.points() {
        let own =
            if term.aggregation.is_one() { layout.between(points, points)? } else { layout.of_points(points, D)? };
        blocks.points[0] = Some(own);
        if let Some(field) = field {
            blocks.points[1] = Some(layout.between(points, field)?);
        }
    }
    Ok(blocks)
}

fn fits(n: u128, what: &str) -> Result<usize> {
    if n <= MOST as u128 {
        return Ok(n as usize);
    }
    Err(Error::InvalidArgument(format!("there would be {n} {what}; at most {MOST} are served")))
}

fn check_length(name: &str, given: usize, right: usize, what: &str) -> Result<()> {
    if given == right {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!("{name} has {given} entries; there are {right} {what}")))
}

fn check_variables(x: &[f64], name: &str) -> Result<()> {
    match x.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => Err(Error::InvalidArgument(format!("{name} {i} is {}; it must be finite", x[i]))),
    }
}
