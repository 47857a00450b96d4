//! Evaluation in batches: value, gradient and Hessian, each where wanted. Nothing here allocates or locks, but for
//! [`Field::eval_parallel`], which does so once a call, and large batches of large fields, which are put in order.

use super::Field;
use super::groups::by_groups;
use super::order::{self, Order};
use super::refined::Refined;
use crate::error::try_with_capacity;
use crate::geometry::vec::text;
use crate::isa::{self, Isa, Kernel};
use crate::par::{self, Workers, try_share};
use crate::spline::basis::{Weights, second_along};
use crate::spline::kernel::{Hessian, Stencil};
use crate::{Error, Result};

/// Points checked, then evaluated, at a time.
const BLOCK: usize = 256;

/// Points that a thread takes at a time.
const ITEM: usize = 16 * BLOCK;

/// Points of which the places and weights are found before the first of their sums: what leads to a sum takes as long as the sum, and a
/// processor looks ahead no farther than a point or two: 21.6 ns a point with gradients where one by one took 26.4, 33.2 with Hessians where
/// it took 44.3. Values alone gain nothing by it.
const AHEAD: usize = 8;

/// Bytes of control points from which on most of them are not in a cache of the core's own: there asking for them ahead pays.
const LARGE: usize = 8 << 20;

/// Where the results of a batch go; `None` where one is not wanted.
#[derive(Default)]
pub struct Outputs<'a, const D: usize = 3> {
    /// phi `[n]`, in the caller's unit of length.
    pub values: Option<&'a mut [f64]>,
    /// grad phi [n x D], without unit.
    pub gradients: Option<&'a mut [[f64; D]]>,
    /// Hessian [n x 6], rows of the upper triangle xx xy xz yy yz zz; in the plane [n x 3], xx xy yy; in 1 / the caller's unit of length.
    pub hessians: Option<&'a mut [f64]>,
}

/// Numbers of a packed Hessian.
pub const fn packed<const D: usize>() -> usize {
    D * (D + 1) / 2
}

impl<'a, const D: usize> Outputs<'a, D> {
    /// The first `n` places, and the rest.
    pub(crate) fn split(self, n: usize) -> (Self, Self) {
        let (v, v_rest) = self.values.map(|s| s.split_at_mut(n)).unzip();
        let (g, g_rest) = self.gradients.map(|s| s.split_at_mut(n)).unzip();
        let (h, h_rest) = self.hessians.map(|s| s.split_at_mut(n * packed::<D>())).unzip();
        (
            Outputs { values: v, gradients: g, hessians: h },
            Outputs { values: v_rest, gradients: g_rest, hessians: h_rest },
        )
    }

    fn check(&self, n: usize) -> Result<()> {
        // Numbers of Hessians that make no whole one are room for none.
        let whole = |len: usize| if len.is_multiple_of(packed::<D>()) { len / packed::<D>() } else { usize::MAX };
        let lengths = [
            ("values", self.values.as_ref().map(|v| v.len())),
            ("gradients", self.gradients.as_ref().map(|g| g.len())),
            ("hessians", self.hessians.as_ref().map(|h| whole(h.len()))),
        ];
        match lengths.iter().find(|(_, len)| len.is_some_and(|len| len != n)) {
            None => Ok(()),
            Some((name, Some(usize::MAX))) => Err(Error::InvalidArgument(format!(
                "{name} has a length that is no multiple of {}; {} a point are needed",
                packed::<D>(),
                packed::<D>()
            ))),
            Some((name, len)) => Err(Error::InvalidArgument(format!(
                "{name} has room for {} points; the batch has {n}",
                len.unwrap_or(0)
            ))),
        }
    }
}

impl<const D: usize> Field<D> {
    /// Evaluates at `points` [n x D], on the caller's thread. After an error the outputs are unspecified.
    pub fn eval(&self, points: &[[f64; D]], outputs: Outputs<D>) -> Result<()> {
        outputs.check(points.len())?;
        self.eval_from(0, points, outputs)
    }

    /// [`Field::eval`] with the batch spread over `n_threads` threads, as [`Workers::new`] takes them; the same bits.
    pub fn eval_parallel(&self, points: &[[f64; D]], outputs: Outputs<D>, n_threads: u32) -> Result<()> {
        outputs.check(points.len())?;
        Workers::check(n_threads)?;
        let mut rest = outputs;
        // What is put in order is best put so in large parts, four a thread so that none waits long for another: no point depends on others,
        // so parts may depend on the number of threads.
        let large = if self.is_large() { points.len().div_ceil(4 * par::count(n_threads)).min(order::MOST) } else { 0 };
        let part = ITEM.max(large);
        let mut items = try_with_capacity(points.len().div_ceil(part), "the parts of a batch")?;
        for (i, points) in points.chunks(part).enumerate() {
            let (outputs, behind) = rest.split(points.len());
            rest = behind;
            items.push((i * part, points, outputs));
        }
        try_share(n_threads, items, |(first, points, outputs)| self.eval_from(first, points, outputs))
    }

    /// Whether evaluations wait for memory.
    pub(super) fn is_large(&self) -> bool {
        size_of::<f64>() * self.n_held() >= LARGE
    }

    /// Numbers that evaluations read: control points, those of a tree's leaves as often as they are held.
    pub(super) fn n_held(&self) -> usize {
        self.refined.as_ref().map_or(&self.coefficients[..], |r| r.tables()).len()
    }

    /// Whether each of `points` lies outside the box, where the field is continued: see [`beyond`](super::beyond).
    pub fn outside_box(&self, points: &[[f64; D]], outside: &mut [u8]) -> Result<()> {
        if outside.len() != points.len() {
            let (room, n) = (outside.len(), points.len());
            return Err(Error::InvalidArgument(format!("outside has room for {room} points; the batch has {n}")));
        }
        check_points(0, points)?;
        for (p, outside) in points.iter().zip(outside) {
            *outside = u8::from(!self.grid.holds(p));
        }
        Ok(())
    }

    /// Evaluates one part of a batch, the first point of which has index `first` in it.
    pub(crate) fn eval_from(&self, first: usize, points: &[[f64; D]], outputs: Outputs<D>) -> Result<()> {
        let order = if self.is_large() { Order::with_room(points.len(), self.n_held()) } else { None };
        isa::dispatch(Batch { field: self, first, points, order, outputs })
    }
}

/// One part of a batch, the first point of which has index `first` in it.
struct Batch<'a, const D: usize> {
    field: &'a Field<D>,
    first: usize,
    points: &'a [[f64; D]],
    /// Room for an order to take the points in, where they are not taken as they come.
    order: Option<Order>,
    outputs: Outputs<'a, D>,
}

impl<const D: usize> Kernel for Batch<'_, D> {
    type Output = Result<()>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Result<()> {
        match &self.field.refined {
            None => {
                let source = OneGrid(self.field);
                self.run_on::<I, _>(source)
            }
            Some(refined) => {
                let source = Leaves { refined, per_cell: self.field.cells.per_cell() };
                self.run_on::<I, _>(source)
            }
        }
    }
}

impl<'a, const D: usize> Batch<'a, D> {
    #[inline(always)]
    fn run_on<I: Isa, C: ControlPoints<'a, D>>(self, control_points: C) -> Result<()> {
        let Batch { field, first, points, order, outputs } = self;
        if field.is_large() {
            return by_groups::<I, C, D>(field, control_points, (first, points), order, outputs);
        }
        let mut rest = outputs;
        for (b, points) in points.chunks(BLOCK).enumerate() {
            check_points(first + b * BLOCK, points)?;
            let (outputs, behind) = rest.split(points.len());
            rest = behind;
            evaluate::<I, C, D>(field, control_points, points, outputs);
        }
        Ok(())
    }
}

/// Where a point lies among control points.
#[derive(Clone, Copy)]
pub(super) struct Place<'a, const D: usize> {
    pub stencil: Stencil<D>,
    /// In the cell.
    pub u: [f64; D],
    pub control_points: &'a [f64],
    /// Place of the first of these among the control points of all tables; 0 on a grid.
    pub table: usize,
    /// 1 / h_a: what turns a derivative along a cell into one along x.
    pub per_cell: [f64; D],
}

/// The control points of a field, and how they are found.
pub(super) trait ControlPoints<'a, const D: usize>: Copy {
    /// The place of a point of the box given in cells of the grid.
    fn place<I: Isa>(self, xi: &[f64; D]) -> Place<'a, D>;
}

/// Those of a grid.
#[derive(Clone, Copy)]
struct OneGrid<'a, const D: usize>(&'a Field<D>);

impl<'a, const D: usize> ControlPoints<'a, D> for OneGrid<'a, D> {
    #[inline(always)]
    fn place<I: Isa>(self, xi: &[f64; D]) -> Place<'a, D> {
        let (stencil, u) = self.0.cells.stencil::<I>(xi);
        Place { stencil, u, control_points: &self.0.coefficients, table: 0, per_cell: self.0.cells.per_cell() }
    }
}

/// Those of the leaves of a tree.
#[derive(Clone, Copy)]
struct Leaves<'a, const D: usize> {
    refined: &'a Refined<D>,
    per_cell: [f64; D],
}

impl<'a, const D: usize> ControlPoints<'a, D> for Leaves<'a, D> {
    #[inline(always)]
    fn place<I: Isa>(self, xi: &[f64; D]) -> Place<'a, D> {
        self.refined.place(xi, self.per_cell)
    }
}

/// Evaluates a few points.
#[inline(always)]
pub(super) fn evaluate<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    points: &[[f64; D]],
    outputs: Outputs<D>,
) {
    match outputs {
        Outputs { values, gradients, hessians: Some(hessians) } => {
            block_with_hessian::<I, C, D>(field, control_points, points, values, gradients, hessians);
        }
        Outputs { values, gradients: Some(gradients), hessians: None } => {
            block_with_gradient::<I, C, D>(field, control_points, points, values, gradients);
        }
        Outputs { values: Some(values), .. } => block_of_values::<I, C, D>(field, control_points, points, values),
        Outputs { values: None, .. } => {}
    }
}

#[inline(always)]
fn block_of_values<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    points: &[[f64; D]],
    values: &mut [f64],
) {
    for (p, value) in points.iter().zip(values) {
        let xi = field.cells.coordinates(p);
        *value = if field.cells.contain(&xi) {
            let Place { stencil, u, control_points, .. } = control_points.place::<I>(&xi);
            stencil.value::<I>(control_points, u)
        } else {
            field.continued(xi).0
        };
    }
}

/// A point whose place and weights are known, so that its sums need not wait for them.
#[derive(Clone, Copy)]
struct Ready<'a, const D: usize> {
    /// `None` outside the box.
    place: Option<Place<'a, D>>,
    weights: [Weights; D],
    /// Those of second derivatives, where they are wanted.
    second: [[f64; 4]; D],
}

impl<'a, const D: usize> Ready<'a, D> {
    const NONE: Self =
        Ready { place: None, weights: [Weights { w: [0.0; 4], dw: [0.0; 4] }; D], second: [[0.0; 4]; D] };

    #[inline(always)]
    fn set<I: Isa, C: ControlPoints<'a, D>, const ORDER: usize>(
        &mut self,
        field: &Field<D>,
        control_points: C,
        p: &[f64; D],
    ) {
        let xi = field.cells.coordinates(p);
        self.place = None;
        if field.cells.contain(&xi) {
            let place = control_points.place::<I>(&xi);
            self.weights = Weights::along::<I, D>(&place.u);
            if ORDER == 2 {
                self.second = second_along::<I, D>(&place.u);
            }
            self.place = Some(place);
        }
    }
}

#[inline(always)]
fn block_with_gradient<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    points: &[[f64; D]],
    mut values: Option<&mut [f64]>,
    gradients: &mut [[f64; D]],
) {
    let mut ready = [Ready::NONE; AHEAD];
    for (g, (points, gradients)) in points.chunks(AHEAD).zip(gradients.chunks_mut(AHEAD)).enumerate() {
        for (p, ready) in points.iter().zip(&mut ready) {
            ready.set::<I, C, 1>(field, control_points, p);
        }
        for (i, ((p, ready), gradient)) in points.iter().zip(&ready).zip(gradients).enumerate() {
            let value;
            (value, *gradient) = if let Some(Place { stencil, control_points, per_cell, .. }) = &ready.place {
                let (value, g) = stencil.value_gradient::<I>(control_points, &ready.weights);
                (value, std::array::from_fn(|a| g[a] * per_cell[a]))
            } else {
                let (value, gradient, _) = field.continued(field.cells.coordinates(p));
                (value, gradient)
            };
            if let Some(values) = &mut values {
                values[g * AHEAD + i] = value;
            }
        }
    }
}

#[inline(always)]
fn block_with_hessian<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    points: &[[f64; D]],
    mut values: Option<&mut [f64]>,
    mut gradients: Option<&mut [[f64; D]]>,
    hessians: &mut [f64],
) {
    let mut ready = [Ready::NONE; AHEAD];
    let groups = points.chunks(AHEAD).zip(hessians.chunks_mut(AHEAD * packed::<D>()));
    for (g, (points, hessians)) in groups.enumerate() {
        for (p, ready) in points.iter().zip(&mut ready) {
            ready.set::<I, C, 2>(field, control_points, p);
        }
        let outputs = hessians.chunks_exact_mut(packed::<D>());
        for (i, ((p, ready), packed)) in points.iter().zip(&ready).zip(outputs).enumerate() {
            let (value, gradient);
            if let Some(Place { stencil, control_points, per_cell, .. }) = &ready.place {
                let (v, g, h) = stencil.value_gradient_hessian::<I>(control_points, &ready.weights, &ready.second);
                (value, gradient) = (v, std::array::from_fn(|a| g[a] * per_cell[a]));
                let scaled = std::array::from_fn(|a| std::array::from_fn(|b| h[a][b] * (per_cell[a] * per_cell[b])));
                pack::<D>(&scaled, packed);
            } else {
                let hessian;
                (value, gradient, hessian) = field.continued(field.cells.coordinates(p));
                pack(&hessian, packed);
            }
            if let Some(values) = &mut values {
                values[g * AHEAD + i] = value;
            }
            if let Some(gradients) = &mut gradients {
                gradients[g * AHEAD + i] = gradient;
            }
        }
    }
}

/// The rows of the upper triangle.
#[inline(always)]
fn pack<const D: usize>(hessian: &Hessian<D>, packed: &mut [f64]) {
    let upper = (0..D).flat_map(|a| (a..D).map(move |b| (a, b)));
    packed.iter_mut().zip(upper).for_each(|(p, (a, b))| *p = hessian[a][b]);
}

/// Coordinates up to this size keep every step of an evaluation in the range of doubles.
const LARGEST: f64 = 1e150;

/// Refuses points that are not finite, or too far, naming the first by its index in the batch.
#[inline(always)]
pub(super) fn check_points<const D: usize>(first: usize, points: &[[f64; D]]) -> Result<()> {
    // A NaN compares as false. All are looked at: a loop without a way out is one of vectors.
    let served = points.as_flattened().iter().fold(true, |served, x| served & (x.abs() <= LARGEST));
    if served { Ok(()) } else { Err(unserved(first, points)) }
}

/// The error that names the first point that is not served.
#[cold]
fn unserved<const D: usize>(first: usize, points: &[[f64; D]]) -> Error {
    let i = points.iter().position(|p| !p.iter().all(|x| x.abs() <= LARGEST)).unwrap_or_default();
    let (p, i) = (text(&points[i]), first + i);
    Error::InvalidArgument(format!("point {i} is {p}; coordinates must be finite, and at most {LARGEST:e} in size"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Feasible, Field};
    use crate::geometry::random::SplitMix64;
    use crate::isa::Portable;
    use crate::spline::{Axis, Grid};

    /// All outputs of a batch as one kernel gives them: values, gradients, Hessians, each asked for alone and together.
    fn outputs<const D: usize>(points: &[[f64; D]], eval: impl Fn(Outputs<D>) -> Result<()>) -> Vec<f64> {
        let n = points.len();
        let (mut v, mut g, mut h) = (vec![0.0; n], vec![[0.0; D]; n], vec![0.0; n * packed::<D>()]);
        let mut all = Vec::new();
        eval(Outputs { values: Some(&mut v), ..Outputs::default() }).unwrap();
        all.extend(&v);
        eval(Outputs { values: Some(&mut v), gradients: Some(&mut g), hessians: None }).unwrap();
        all.extend(v.iter().chain(g.as_flattened()));
        eval(Outputs { values: Some(&mut v), gradients: Some(&mut g), hessians: Some(&mut h) }).unwrap();
        all.extend(v.iter().chain(g.as_flattened()).chain(&h));
        all
    }

    fn instruction_sets_agree<const D: usize>(n_cells: [usize; D]) {
        let mut random = SplitMix64::new(9);
        let grid = Grid { axes: n_cells.map(|n| Axis { lower: random.between(-2.0, 2.0), cell: 1.0, n_cells: n }) };
        let c: Vec<f64> = (0..grid.n_control()).map(|_| random.between(-1.0, 1.0)).collect();
        let field = Field::from_control_points(grid, c, Feasible::Outside, 1.0).unwrap();
        // In the box and around it, every third coordinate on a knot or a face.
        let points: Vec<[f64; D]> = (0..700)
            .map(|i| {
                std::array::from_fn(|a| {
                    let xi = random.between(-1.0, n_cells[a] as f64 + 1.0);
                    grid.axes[a].lower + if (i + a) % 3 == 0 { xi.round() } else { xi }
                })
            })
            .collect();
        let best = outputs(&points, |outputs| field.eval(&points, outputs));
        let portable = outputs(&points, |outputs| {
            Batch { field: &field, first: 0, points: &points, order: None, outputs }.run::<Portable>()
        });
        for (i, (x, y)) in best.iter().zip(&portable).enumerate() {
            assert!((x - y).abs() < 1e-13, "number {i}: {x} {y}");
        }
    }

    #[test]
    fn instruction_sets_agree_in_space_and_in_the_plane() {
        for n_cells in [[1, 1, 1], [2, 7, 1], [5, 4, 9]] {
            instruction_sets_agree(n_cells);
        }
        for n_cells in [[1, 1], [3, 2], [8, 11]] {
            instruction_sets_agree(n_cells);
        }
    }
}
