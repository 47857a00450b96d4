//! The energy's matrix on one grid, and on ever coarser ones for the multigrid: cells twice as long where they are short beside the others,
//! the same points and the same box.
//!
//! Splines of a coarse grid are splines of the fine one, so the same energy on the coarse grid is the Galerkin product, exactly but for the
//! distances, of which a coarse grid takes the masses of the finer ones in the middles of cells half as long.
//!
//! A grid needs no matrix until there are so many points a control point that entries are cheaper than they.

use super::data::{DataTerm, View};
use super::distance::DistanceTerm;
use super::smoothness::Smoothness;
use crate::Result;
use crate::error::try_vec;
use crate::linalg::dense::Cholesky;
use crate::linalg::multigrid::{self, Multigrid, Smoother};
use crate::par::Workers;
use crate::spline::assembled::Assembled;
use crate::spline::blocks::{Blocks, Kinds};
use crate::spline::gram::Gram;
use crate::spline::two_scale::{TwoScale, coarser};
use crate::spline::{Axis, Grid};
use std::ops::{Deref, DerefMut, Range};

/// Unknowns of the coarsest grid, which is solved, at most, where its axes can be coarsened so far.
const COARSEST: usize = 400;

/// Control points, in halves, a point below which a grid has entries: reading those of so many costs as much as the sums of a point.
const ENTRIES_BELOW: u128 = 3;

/// An axis is coarsened where its cells are at most this many times as long as the shortest.
const LONG: f64 = 1.5;

/// A control point is stiff where data hold it this many times as much as smoothness.
const STIFF: f64 = 0.5;

/// Pivots that fall below this part of the diagonal are rounding.
const LEAST_PIVOT: f64 = 1e-13;

/// The terms of the energy on one grid.
pub(super) struct Terms<const D: usize> {
    pub view: View<D>,
    pub smoothness: Smoothness,
    /// `None` where the energy is the paper's.
    pub distance: Option<DistanceTerm<D>>,
    /// How many times as long as the finest the cells are.
    times: [usize; D],
}

impl<const D: usize> Terms<D> {
    /// On the finest grid.
    pub fn new(view: View<D>, smooth_weight: f64) -> Result<Self> {
        let smoothness = Smoothness::new(view.grid(), smooth_weight)?;
        Ok(Terms { view, smoothness, distance: None, times: [1; D] })
    }

    /// y = A x
    pub fn apply(&mut self, data: &DataTerm<D>, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.smoothness.apply(workers, x, y);
        data.apply(&self.view, workers, x, y);
        if let Some(distance) = &mut self.distance {
            distance.apply(workers, x, y);
        }
    }

    /// The diagonal of A.
    pub fn diagonal(&mut self, data: &DataTerm<D>, workers: &Workers) -> Result<Vec<f64>> {
        let mut d = try_vec(self.view.grid().n_control(), 0.0, "the diagonal")?;
        self.smoothness.add_diagonal(&mut d);
        data.add_diagonal(&self.view, workers, &mut d);
        if let Some(distance) = &mut self.distance {
            distance.add_diagonal(workers, &mut d);
        }
        Ok(d)
    }

    /// What makes the matrix once more.
    pub fn copy(&self, data: &DataTerm<D>) -> Result<Self> {
        self.coarser(data, [false; D])
    }

    /// The terms on the grid with the axes coarsened for which `halved` is true, as far as they make its matrix.
    fn coarser(&self, data: &DataTerm<D>, halved: [bool; D]) -> Result<Self> {
        let grid = coarser_grid(self.view.grid(), halved);
        let times = std::array::from_fn(|a| if halved[a] { 2 * self.times[a] } else { self.times[a] });
        let distance = self.distance.as_ref().map(|d| d.coarser(&grid)).transpose()?;
        let mut smoothness = self.smoothness.coarser(in_space(halved))?;
        smoothness.reserve()?;
        Ok(Terms { smoothness, distance, view: data.view(grid, times)?, times })
    }

    /// A's entries in some planes of control points along x.
    fn assemble(&self, data: &DataTerm<D>, planes: Range<usize>, workers: &Workers) -> Result<Assembled> {
        let mut matrix = Assembled::new(self.smoothness.shape(), planes)?;
        matrix.add_bands(workers, &self.smoothness.products());
        data.add_to(&self.view, workers, &mut matrix);
        if let Some(distance) = &self.distance {
            distance.add_to(workers, &mut matrix);
        }
        Ok(matrix)
    }

    /// The local inverse of A, and its entries where they are cheaper than points.
    fn prepare(&mut self, data: &DataTerm<D>, workers: &Workers) -> Result<(Blocks, Option<Assembled>)> {
        let n = self.view.grid().n_control();
        let entries = has_entries(n as u128, data.n_points() as u128);
        let matrix = entries.then(|| self.assemble_all(data, workers)).transpose()?;
        let zeros = || try_vec(n, 0.0, "the smoother");
        let (mut by_data, mut by_smoothness, mut by_distance) = (zeros()?, zeros()?, zeros()?);
        data.add_diagonal(&self.view, workers, &mut by_data);
        self.smoothness.add_diagonal(&mut by_smoothness);
        let mut uniform = None;
        if let Some(distance) = &mut self.distance {
            distance.add_diagonal(workers, &mut by_distance);
            uniform = Some(distance.uniform()?);
        }
        let (mut diagonal, flags) = (zeros()?, || try_vec(n, false, "the smoother"));
        let (mut own, mut second) = (flags()?, flags()?);
        for p in 0..n {
            own[p] = by_data[p] > STIFF * by_smoothness[p];
            second[p] = by_distance[p] > 0.0;
            diagonal[p] = by_data[p] + by_smoothness[p] + by_distance[p];
        }
        let smooth = self.smoothness.products();
        let mut held = smooth.clone();
        let no_axis = Gram::of_no_axis();
        if let Some((mass, bands)) = &uniform {
            let band = |a: usize| if a + D >= 3 { &bands[a + D - 3] } else { &no_axis.order[0] };
            held.push((*mass, std::array::from_fn(band)));
        }
        let kinds = Kinds { own: &own, second: &second, operators: [smooth, held] };
        let mut blocks = Blocks::new(self.smoothness.shape(), &diagonal)?;
        if let Some(matrix) = &matrix {
            blocks.add(matrix, &kinds, workers)?;
        } else {
            for planes in Blocks::windows(self.smoothness.shape()) {
                blocks.add(&self.assemble(data, planes, workers)?, &kinds, workers)?;
            }
        }
        Ok((blocks, matrix))
    }

    fn assemble_all(&self, data: &DataTerm<D>, workers: &Workers) -> Result<Assembled> {
        self.assemble(data, 0..self.smoothness.shape()[0], workers)
    }
}

/// The axes of `grid` to coarsen next; none where it is the coarsest.
fn halved<const D: usize>(grid: &Grid<D>) -> [bool; D] {
    let can = |a: usize| grid.axes[a].n_cells > 1;
    let shortest = (0..D).filter(|a| can(*a)).fold(f64::INFINITY, |m, a| m.min(grid.axes[a].cell));
    let coarsest = grid.n_control() <= COARSEST;
    std::array::from_fn(|a| !coarsest && can(a) && grid.axes[a].cell <= LONG * shortest)
}

/// `grid` with the axes coarsened for which `halved` is true.
fn coarser_grid<const D: usize>(grid: &Grid<D>, halved: [bool; D]) -> Grid<D> {
    let axis = |a: usize| match (grid.axes[a], halved[a]) {
        (axis, false) => axis,
        (axis, true) => Axis { cell: 2.0 * axis.cell, n_cells: coarser(axis.n_cells), ..axis },
    };
    Grid { axes: std::array::from_fn(axis) }
}

/// Whether a multigrid has more than one grid.
pub(super) fn serve<const D: usize>(grid: &Grid<D>) -> bool {
    halved(grid).contains(&true)
}

/// Whether entries are cheaper than points.
fn has_entries(n_control: u128, n_points: u128) -> bool {
    2 * n_control < ENTRIES_BELOW * n_points
}

/// Bytes that a multigrid for `n_points` points on `grid` takes at most beside the terms there, but for a fifth of a megabyte a thread.
///
/// Grid by grid: where cells are longer along some axes than along others, a coarser grid has half of the control points, not an eighth.
pub(super) fn memory<const D: usize>(n_points: u128, grid: &Grid<D>) -> u128 {
    let (mut grid, mut bytes) = (*grid, 0);
    loop {
        let shape = shape_in_space(&grid);
        let n: u128 = shape.iter().product();
        let axes = halved(&grid);
        if axes == [false; D] {
            // The triangle of the matrix.
            return bytes + Assembled::bytes(shape, shape[0]) + n * (n + 1) / 2 * 8;
        }
        let planes = if has_entries(n, n_points) { shape[0] } else { shape[0].min(Blocks::WINDOW) };
        // Four vectors of the smoother, the transfer's one, and what tells blocks apart: six.
        bytes += Assembled::bytes(shape, planes) + Blocks::bytes(shape, n_points) + n * 8 * (4 + 1 + 6);
        grid = coarser_grid(&grid, axes);
        // The coarser grid's terms: smoothness, and far masses in these cells with three tensors of sums and values at most as large.
        bytes += Smoothness::bytes(shape_in_space(&grid)) + n * 8 * 4;
    }
}

/// Control points along x, y, z, of which the plane has one along x.
fn shape_in_space<const D: usize>(grid: &Grid<D>) -> [u128; 3] {
    std::array::from_fn(|a| if a + D >= 3 { grid.axes[a + D - 3].n_control() as u128 } else { 1 })
}

/// `halved` with the axes that the plane lacks, which are not.
fn in_space<const D: usize>(halved: [bool; D]) -> [bool; 3] {
    std::array::from_fn(|a| a + D >= 3 && halved[a + D - 3])
}

/// A on one grid.
enum Form<T, const D: usize> {
    Finest(T),
    Terms(Box<Terms<D>>),
    Entries(Assembled),
}

/// One grid of the multigrid, which borrows or shares the points, `P`, and borrows or owns the terms of the finest grid, `T`.
pub(super) struct Level<P, T, const D: usize> {
    data: P,
    form: Form<T, D>,
    blocks: Blocks,
    to_coarser: TwoScale,
    len: usize,
}

impl<P, T, const D: usize> multigrid::Level for Level<P, T, D>
where
    P: Deref<Target = DataTerm<D>>,
    T: DerefMut<Target = Terms<D>>,
{
    fn n_unknowns(&self) -> usize {
        self.len
    }

    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        match &mut self.form {
            Form::Finest(terms) => terms.apply(&self.data, workers, x, y),
            Form::Terms(terms) => terms.apply(&self.data, workers, x, y),
            Form::Entries(matrix) => matrix.apply(workers, x, y),
        }
    }

    fn invert_locally(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        self.blocks.apply(workers, r, z);
    }

    fn restrict(&mut self, workers: &Workers, fine: &[f64], coarse: &mut [f64]) {
        self.to_coarser.restrict(workers, fine, coarse);
    }

    fn prolong_add(&mut self, workers: &Workers, coarse: &[f64], fine: &mut [f64]) {
        self.to_coarser.prolong_add(workers, coarse, fine);
    }
}

/// The multigrid of `finest`, of which the grid must be one that it [serves](serve).
pub(super) fn multigrid<P, T, const D: usize>(
    data: P,
    mut finest: T,
    workers: &Workers,
) -> Result<Multigrid<Level<P, T, D>>>
where
    P: Deref<Target = DataTerm<D>> + Clone,
    T: DerefMut<Target = Terms<D>>,
{
    let mut levels = Vec::new();
    let mut axes = halved(finest.view.grid());
    let mut next = finest.coarser(&data, axes)?;
    let mut shape = finest.smoothness.shape();
    let (mut blocks, entries) = finest.prepare(&data, workers)?;
    let mut form = entries.map_or(Form::Finest(finest), Form::Entries);
    loop {
        let to_coarser = TwoScale::new(shape, in_space(axes))?;
        let mut level = Level { data: data.clone(), form, blocks, to_coarser, len: shape.iter().product() };
        let smoother = Smoother::new(&mut level, workers)?;
        levels.push((level, smoother));
        axes = halved(next.view.grid());
        if axes == [false; D] {
            let matrix = next.assemble_all(&data, workers)?;
            let n = next.view.grid().n_control();
            return Multigrid::new(levels, Cholesky::new(n, matrix.lower_triangle()?, LEAST_PIVOT));
        }
        let coarser = next.coarser(&data, axes)?;
        shape = next.smoothness.shape();
        let entries;
        (blocks, entries) = next.prepare(&data, workers)?;
        form = entries.map_or_else(|| Form::Terms(Box::new(next)), Form::Entries);
        next = coarser;
    }
}
