//! The data terms of the energy, paper 000 (6): values and gradients at the points of the cloud.
//!
//! Neither matrix nor stencil is stored: a point keeps its coordinates in cells, and its 4^D weights are made again where they are needed.

use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::geometry::Cloud;
use crate::geometry::vec::{norm, scale, sub};
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use crate::spline::Grid;
use crate::spline::assembled::{Assembled, AxisProducts, LayerSums, products};
use crate::spline::basis::Weights;
use crate::spline::kernel::Stencil;
use std::ops::Range;

/// Cells along x of a slab. The points of a slab touch its planes of control points and the three behind, so slabs of at least three
/// cells, every other one at a time, write to different planes and need no lock.
const SLAB: usize = 4;

/// How far a point is from what the data ask for.
#[derive(Debug, Clone, Copy, Default)]
pub struct Misfit {
    /// |phi|, in units of D.
    pub value: f64,
    /// First-order distance |phi| / |grad phi| to the surface phi = 0, in units of D.
    pub distance: f64,
    /// |grad phi - s n|
    pub normal: f64,
}

/// Points in cells of a grid, sorted by cell.
pub struct Data<const D: usize = 3> {
    /// [N x D], in cells.
    pub(super) xi: Vec<[f64; D]>,
    /// Unit normals [N x D].
    pub(super) normals: Vec<[f64; D]>,
    /// The caller's weights, of sum 1 [N].
    pub(super) share: Vec<f64>,
    pub(super) mass: Vec<Mass>,
    /// Their numbers in the cloud [N].
    pub(super) number: Vec<u32>,
}

/// What a point counts for: its share unless reweighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    /// In the sum of values.
    pub value: f64,
    /// In the sum of gradients.
    pub gradient: f64,
}

impl<const D: usize> Data<D> {
    /// The points of `cloud` in the cells of `grid`, each with its share.
    pub fn new(cloud: &Cloud<D>, grid: &Grid<D>) -> Result<Self> {
        let n = cloud.len();
        let to_cells = |p: &[f64; D]| std::array::from_fn(|a| (p[a] - grid.axes[a].lower) / grid.axes[a].cell);
        let mut keys = try_vec(n, (0usize, 0u32), "the order of the points")?;
        for (i, (key, p)) in keys.iter_mut().zip(cloud.points()).enumerate() {
            *key = (grid.stencil(to_cells(p)).0.first, i as u32);
        }
        keys.sort_unstable();
        let mut data = Data {
            xi: try_vec(n, [0.0; D], "the points")?,
            normals: try_vec(n, [0.0; D], "the normals")?,
            share: try_vec(n, 1.0 / n as f64, "the shares of the points")?,
            mass: try_vec(n, Mass { value: 0.0, gradient: 0.0 }, "the masses of the points")?,
            number: try_vec(n, 0, "the numbers of the points")?,
        };
        let largest = cloud.weights().map(|weights| weights.iter().fold(0.0, |m: f64, w| m.max(*w)));
        for (place, (_, i)) in keys.iter().enumerate() {
            data.number[place] = *i;
            data.xi[place] = to_cells(&cloud.points()[*i as usize]);
            data.normals[place] = cloud.normals()[*i as usize];
            if let (Some(weights), Some(largest)) = (cloud.weights(), largest) {
                data.share[place] = weights[*i as usize] / largest;
            }
        }
        if largest.is_some() {
            let total: f64 = data.share.iter().sum();
            data.share.iter_mut().for_each(|s| *s /= total);
        }
        data.reset_weights();
        Ok(data)
    }

    /// Makes each point count for its share.
    pub(super) fn reset_weights(&mut self) {
        self.mass.iter_mut().zip(&self.share).for_each(|(m, s)| *m = Mass { value: *s, gradient: *s });
    }

    /// Whether the normal of point `place` counts for more than half. Sides are told by normals alone, so one that is in doubt is none.
    pub(super) fn counts(&self, place: usize) -> bool {
        self.mass[place].gradient > 0.5 * self.share[place]
    }

    /// What point `place` counts for without having been reweighted.
    pub(super) fn own_mass(&self, place: usize) -> Mass {
        Mass { value: self.share[place], gradient: self.share[place] }
    }

    /// The place of each number in this order.
    pub(super) fn places(&self) -> Result<Vec<u32>> {
        let mut places = try_vec(self.number.len(), 0, "the places of the points")?;
        (0..).zip(&self.number).for_each(|(place, number)| places[*number as usize] = place);
        Ok(places)
    }

    /// Multiplies what the value of each point counts for by a factor of its own.
    pub(super) fn reweight(&mut self, factors: impl Iterator<Item = f64>) {
        self.mass.iter_mut().zip(factors).for_each(|(mass, factor)| mass.value *= factor);
    }
}

/// The cells of one grid as the points see them: those of the finest, or of one that is coarser by powers of two.
pub struct View<const D: usize = 3> {
    /// In units of D.
    grid: Grid<D>,
    /// What turns coordinates in the finest cells into those of this grid's.
    to_cells: [f64; D],
    /// 1 / h_a: what turns a derivative along a cell into one along x.
    per_cell: [f64; D],
    slabs: Vec<Range<usize>>,
}

impl<const D: usize> View<D> {
    /// The points of `data` in `grid`, in units of D, of which the cells are `times` as long as the finest.
    pub fn new(data: &Data<D>, grid: Grid<D>, times: [usize; D]) -> Result<Self> {
        let to_cells = times.map(|t| 1.0 / t as f64);
        let below = |cell: usize| data.xi.partition_point(|xi| grid.axes[0].locate(xi[0] * to_cells[0]).0 < cell);
        let n_slabs = grid.axes[0].n_cells.div_ceil(SLAB);
        let mut slabs = try_with_capacity(n_slabs, "the slabs of the points")?;
        slabs.extend((0..n_slabs).map(|s| below(s * SLAB)..below((s + 1) * SLAB)));
        Ok(View { grid, to_cells, per_cell: grid.axes.map(|a| 1.0 / a.cell), slabs })
    }

    /// The grid, in units of D.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    #[inline(always)]
    fn stencil(&self, xi: &[f64; D]) -> (Stencil<D>, [f64; D]) {
        self.grid.stencil(std::array::from_fn(|a| xi[a] * self.to_cells[a]))
    }

    /// Has each point add to y; the order of the sums into an entry of y does not depend on the threads.
    fn by_slab(&self, workers: &Workers, y: &mut [f64], point: impl Point) {
        let plane = self.grid.n_control() / self.grid.shape()[0];
        for parity in 0..2 {
            let Some(planes) = y.get_mut(parity * SLAB * plane..) else { break };
            let slabs = self.slabs.iter().enumerate().skip(parity).step_by(2);
            workers.for_each(slabs.zip(planes.chunks_mut(2 * SLAB * plane)), |((s, points), y)| {
                dispatch(Slab { points: points.clone(), first_layer: s * SLAB, y, point });
            });
        }
    }
}

/// What a point adds.
trait Point: Copy + Send + Sync {
    /// Adds what point `p` does to the layers `y` along x, of which `first_layer` is the first.
    fn add<I: Isa>(self, p: usize, y: &mut [f64], first_layer: usize);
}

/// The points of one slab.
struct Slab<'a, P: Point> {
    points: Range<usize>,
    first_layer: usize,
    y: &'a mut [f64],
    point: P,
}

impl<P: Point> Kernel for Slab<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        for p in self.points {
            self.point.add::<I>(p, self.y, self.first_layer);
        }
    }
}

/// Energy of the values and gradients at the points: sum of m_v phi^2 + lambda_n m_g |grad phi|^2.
pub struct DataTerm<const D: usize = 3> {
    data: Data<D>,
    normal_weight: f64,
}

impl<const D: usize> DataTerm<D> {
    /// The term for `data`.
    pub fn new(data: Data<D>, normal_weight: f64) -> Self {
        DataTerm { data, normal_weight }
    }

    /// The points in a grid of which the cells are `times` as long as the finest.
    pub fn view(&self, grid: Grid<D>, times: [usize; D]) -> Result<View<D>> {
        View::new(&self.data, grid, times)
    }

    /// y += (the term's matrix on the grid of `view`) x
    pub fn apply(&self, view: &View<D>, workers: &Workers, x: &[f64], y: &mut [f64]) {
        view.by_slab(workers, y, Product { term: self, view, x });
    }

    /// Adds the term's matrix on the grid of `view`.
    pub fn add_to(&self, view: &View<D>, workers: &Workers, matrix: &mut Assembled) {
        matrix.add_layers(workers, |layer, sums| dispatch(AddLayer { term: self, view, layer, sums }));
    }

    /// The points in a layer of cells along x; in the plane, all.
    fn of_layer(&self, view: &View<D>, layer: usize) -> Range<usize> {
        if D == 2 {
            return 0..self.n_points();
        }
        let layer_of = |p: usize| view.grid.axes[0].locate(self.data.xi[p][0] * view.to_cells[0]).0;
        self.below(layer_of, layer)..self.below(layer_of, layer + 1)
    }

    /// Points of which the layer along x lies below `layer`: these come first.
    fn below(&self, layer_of: impl Fn(usize) -> usize, layer: usize) -> usize {
        let (mut low, mut high) = (0, self.n_points());
        while low < high {
            let middle = low.midpoint(high);
            if layer_of(middle) < layer { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// y += the right-hand side on the grid of `view` that asks for the gradient `sign` n at each point.
    pub fn add_right_hand_side(&self, view: &View<D>, workers: &Workers, sign: f64, y: &mut [f64]) {
        view.by_slab(workers, y, RightHandSide { term: self, view, sign });
    }

    /// y += the diagonal of the term's matrix on the grid of `view`.
    pub fn add_diagonal(&self, view: &View<D>, workers: &Workers, y: &mut [f64]) {
        view.by_slab(workers, y, Diagonal { term: self, view });
    }

    /// The points.
    pub(super) fn points(&self) -> &Data<D> {
        &self.data
    }

    /// The points, to be weighed anew.
    pub(super) fn points_mut(&mut self) -> &mut Data<D> {
        &mut self.data
    }

    /// What each point counts for: its number, and its masses, of which that of the gradient is times lambda_n.
    pub(super) fn forces(&self) -> impl Iterator<Item = (u32, Mass)> {
        let forces = self.data.number.iter().zip(&self.data.mass);
        forces.map(|(i, m)| (*i, Mass { value: m.value, gradient: self.normal_weight * m.gradient }))
    }

    /// Points.
    pub fn n_points(&self) -> usize {
        self.data.xi.len()
    }

    /// How far each point is from what the data ask for, the gradient `sign` n; `x` are control points of the grid of `view`.
    ///
    /// Where phi is nearly flat |phi| / |grad phi| means nothing: `flattest` bounds |grad phi| from below.
    pub fn misfits(
        &self,
        view: &View<D>,
        workers: &Workers,
        x: &[f64],
        sign: f64,
        flattest: f64,
    ) -> Result<Vec<Misfit>> {
        const CHUNK: usize = 1024;
        let mut misfits = try_vec(self.n_points(), Misfit::default(), "the misfits of the points")?;
        workers.for_each(misfits.chunks_mut(CHUNK).enumerate(), |(chunk, misfits)| {
            dispatch(Misfits { term: self, view, x, sign, flattest, first: chunk * CHUNK, misfits });
        });
        Ok(misfits)
    }

    /// Multiplies what the value of each point counts for by a factor of its own.
    pub fn reweight(&mut self, factors: impl Iterator<Item = f64>) {
        self.data.reweight(factors);
    }

    /// Makes each point count for its share times a factor of its own.
    pub fn weigh(&mut self, factors: impl Iterator<Item = Mass>) {
        for ((mass, share), factor) in self.data.mass.iter_mut().zip(&self.data.share).zip(factors) {
            *mass = Mass { value: share * factor.value, gradient: share * factor.gradient };
        }
    }

    /// Points whose values count for nothing, but for those that never counted: weights that vanish beside the largest.
    pub fn n_left_out(&self) -> usize {
        self.data.mass.iter().zip(&self.data.share).filter(|(m, share)| m.value == 0.0 && **share > 0.0).count()
    }

    /// The points whose normals count for more than half, in units of D from the lower corner of the box, with their normals; `finest` is
    /// the grid in whose cells they are.
    pub fn counted(&self, finest: &Grid<D>) -> Result<Cloud<D>> {
        let counts = |p: &usize| self.data.counts(*p);
        let n = (0..self.n_points()).filter(counts).count();
        let mut points = try_with_capacity(n, "the points in units of D")?;
        let mut normals = try_with_capacity(n, "the normals")?;
        for p in (0..self.n_points()).filter(counts) {
            points.push(std::array::from_fn(|a| self.data.xi[p][a] * finest.axes[a].cell));
            normals.push(self.data.normals[p]);
        }
        Cloud::new(points, normals)
    }

    /// The numbers of the points that [`counted`](Self::counted) gives.
    pub fn counted_numbers(&self) -> Result<Vec<u32>> {
        let counts = |p: &usize| self.data.counts(*p);
        let mut numbers = try_with_capacity(self.n_points(), "the numbers of the points that count")?;
        numbers.extend((0..self.n_points()).filter(counts).map(|p| self.data.number[p]));
        Ok(numbers)
    }

    /// mass lambda_n / h_a of point `p`.
    #[inline(always)]
    fn pull(&self, view: &View<D>, p: usize) -> [f64; D] {
        view.per_cell.map(|c| self.normal_weight * self.data.mass[p].gradient * c)
    }
}

/// A point's part of the product with x.
#[derive(Clone, Copy)]
struct Product<'a, const D: usize> {
    term: &'a DataTerm<D>,
    view: &'a View<D>,
    x: &'a [f64],
}

impl<const D: usize> Point for Product<'_, D> {
    #[inline(always)]
    fn add<I: Isa>(self, p: usize, y: &mut [f64], first_layer: usize) {
        let Product { term, view, x } = self;
        let (stencil, u) = view.stencil(&term.data.xi[p]);
        let b = Weights::along::<I, D>(&u);
        let (value, gradient) = stencil.value_gradient::<I>(x, &b);
        let (mass, pull) = (term.data.mass[p].value, term.pull(view, p));
        let gradient = std::array::from_fn(|a| pull[a] * view.per_cell[a] * gradient[a]);
        stencil.shifted(first_layer).scatter::<I>(y, &b, mass * value, gradient);
    }
}

/// A point's part of the right-hand side.
#[derive(Clone, Copy)]
struct RightHandSide<'a, const D: usize> {
    term: &'a DataTerm<D>,
    view: &'a View<D>,
    sign: f64,
}

impl<const D: usize> Point for RightHandSide<'_, D> {
    #[inline(always)]
    fn add<I: Isa>(self, p: usize, y: &mut [f64], first_layer: usize) {
        let RightHandSide { term, view, sign } = self;
        let (stencil, u) = view.stencil(&term.data.xi[p]);
        let pull = term.pull(view, p);
        let gradient = std::array::from_fn(|a| pull[a] * sign * term.data.normals[p][a]);
        stencil.shifted(first_layer).scatter::<I>(y, &Weights::along::<I, D>(&u), 0.0, gradient);
    }
}

/// A point's part of the diagonal.
#[derive(Clone, Copy)]
struct Diagonal<'a, const D: usize> {
    term: &'a DataTerm<D>,
    view: &'a View<D>,
}

impl<const D: usize> Point for Diagonal<'_, D> {
    #[inline(always)]
    fn add<I: Isa>(self, p: usize, y: &mut [f64], first_layer: usize) {
        let Diagonal { term, view } = self;
        let (stencil, u) = view.stencil(&term.data.xi[p]);
        // The squares of the weights of a tensor product are the tensor product of the squares.
        let squares =
            Weights::along::<I, D>(&u).map(|Weights { w, dw }| Weights { w: w.map(|w| w * w), dw: dw.map(|d| d * d) });
        let pull = term.pull(view, p);
        let gradient = std::array::from_fn(|a| pull[a] * view.per_cell[a]);
        stencil.shifted(first_layer).scatter::<I>(y, &squares, term.data.mass[p].value, gradient);
    }
}

/// The misfits of some points in order.
struct Misfits<'a, const D: usize> {
    term: &'a DataTerm<D>,
    view: &'a View<D>,
    x: &'a [f64],
    sign: f64,
    flattest: f64,
    first: usize,
    misfits: &'a mut [Misfit],
}

impl<const D: usize> Kernel for Misfits<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Misfits { term: DataTerm { data, .. }, view, x, sign, flattest, first, misfits } = self;
        for (p, misfit) in (first..).zip(misfits) {
            let (stencil, u) = view.stencil(&data.xi[p]);
            let (value, g) = stencil.value_gradient::<I>(x, &Weights::along::<I, D>(&u));
            let gradient: [f64; D] = std::array::from_fn(|a| view.per_cell[a] * g[a]);
            misfit.value = value.abs();
            misfit.distance = misfit.value / norm(gradient).max(flattest);
            misfit.normal = norm(sub(gradient, scale(sign, data.normals[p])));
        }
    }
}

/// The matrix of the points in one layer of cells.
struct AddLayer<'a, 'b, const D: usize> {
    term: &'a DataTerm<D>,
    view: &'a View<D>,
    layer: usize,
    sums: &'a mut LayerSums<'b>,
}

impl<const D: usize> Kernel for AddLayer<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AddLayer { term: DataTerm { data, normal_weight, .. }, view, layer, sums } = self;
        let ny = view.grid.axes[D - 2].n_control();
        for p in self.term.of_layer(view, layer) {
            let mut axes = [AxisProducts::of_no_axis(); 3];
            let mut cell = [0; 3];
            for a in 0..D {
                let (c, u) = view.grid.axes[a].locate(data.xi[p][a] * view.to_cells[a]);
                let Weights { w, dw } = Weights::at(u);
                let slope = products(&dw.map(|d| d * view.per_cell[a]));
                (cell[a + 3 - D], axes[a + 3 - D]) = (c, AxisProducts { value: products(&w), slope });
            }
            let Mass { value, gradient } = data.mass[p];
            sums.add::<I>(ny, [cell[1], cell[2]], &axes, value, normal_weight * gradient);
        }
    }
}
