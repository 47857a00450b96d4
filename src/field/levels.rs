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
use crate::linalg::vector::update;
use crate::spline::assembled::Assembled;
use crate::spline::blocks::Blocks;
use crate::spline::two_scale::{TwoScale, coarser};
use crate::spline::{Axis, Grid};
use std::ops::Range;

/// Unknowns of the coarsest grid, which is solved, at most, where its axes can be coarsened so far.
const COARSEST: usize = 400;

/// Control points a point below which a grid has entries: a row of them costs as much as so many points.
const ENTRIES_BELOW: f64 = 1.5;

/// An axis is coarsened where its cells are at most this many times as long as the shortest.
const LONG: f64 = 1.5;

/// A control point is stiff where data hold it this many times as much as smoothness.
const STIFF: f64 = 4.0;

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
            distance.apply(x, y);
        }
    }

    /// The diagonal of A.
    pub fn diagonal(&mut self, data: &DataTerm<D>, workers: &Workers) -> Result<Vec<f64>> {
        let mut d = try_vec(self.view.grid().n_control(), 0.0, "the diagonal")?;
        self.smoothness.add_diagonal(&mut d);
        data.add_diagonal(&self.view, workers, &mut d);
        if let Some(distance) = &mut self.distance {
            distance.add_diagonal(&mut d);
        }
        Ok(d)
    }

    /// The axes to coarsen next; none where the grid is the coarsest.
    fn halved(&self) -> [bool; D] {
        let grid = self.view.grid();
        let can = |a: usize| grid.axes[a].n_cells > 1;
        let shortest = (0..D).filter(|a| can(*a)).fold(f64::INFINITY, |m, a| m.min(grid.axes[a].cell));
        if grid.n_control() <= COARSEST { [false; D] } else { std::array::from_fn(|a| can(a) && grid.axes[a].cell <= LONG * shortest) }
    }

    /// The terms on the grid with the axes coarsened for which `halved` is true.
    fn coarser(&self, data: &DataTerm<D>, halved: [bool; D]) -> Result<Self> {
        let axis = |a: usize| match (self.view.grid().axes[a], halved[a]) {
            (axis, false) => axis,
            (axis, true) => Axis { cell: 2.0 * axis.cell, n_cells: coarser(axis.n_cells), ..axis },
        };
        let grid = Grid { axes: std::array::from_fn(axis) };
        let times = std::array::from_fn(|a| if halved[a] { 2 * self.times[a] } else { self.times[a] });
        let distance = self.distance.as_ref().map(|d| d.coarser(&grid)).transpose()?;
        let mut smoothness = self.smoothness.coarser(in_space(halved))?;
        smoothness.reserve()?;
        Ok(Terms { smoothness, distance, view: data.view(grid, times), times })
    }

    /// A's entries in some planes of control points along x.
    fn assemble(&self, data: &DataTerm<D>, planes: Range<usize>, workers: &Workers) -> Result<Assembled> {
        let mut matrix = Assembled::new(self.smoothness.shape(), planes)?;
        self.smoothness.add_to(workers, &mut matrix);
        data.add_to(&self.view, workers, &mut matrix);
        if let Some(distance) = &self.distance {
            distance.add_to(workers, &mut matrix);
        }
        Ok(matrix)
    }

    /// The local inverse; `matrix` is A where all of it is assembled.
    fn local(&mut self, data: &DataTerm<D>, matrix: Option<&Assembled>, workers: &Workers) -> Result<Local> {
        let n = self.view.grid().n_control();
        let (mut by_data, mut by_smoothness) = (try_vec(n, 0.0, "the smoother")?, try_vec(n, 0.0, "the smoother")?);
        data.add_diagonal(&self.view, workers, &mut by_data);
        self.smoothness.add_diagonal(&mut by_smoothness);
        let stiffness: f64 = std::env::var("STIFF").map_or(4.0, |s| s.parse().unwrap());
        let stiff: Vec<bool> = by_data.iter().zip(&by_smoothness).map(|(d, s)| *d > stiffness * s).collect();
        let mut diagonal = self.diagonal(data, workers)?;
        if !stiff.contains(&true) {
            diagonal.iter_mut().for_each(|d| *d = 1.0 / *d);
            return Ok(Local::Diagonal(diagonal));
        }
        let mut blocks = Blocks::new(self.smoothness.shape(), &diagonal)?;
        match matrix {
            Some(matrix) => blocks.add(matrix, &stiff, workers)?,
            None => {
                for planes in Blocks::windows(self.smoothness.shape()) {
                    blocks.add(&self.assemble(data, planes, workers)?, &stiff, workers)?;
                }
            }
        }
        Ok(Local::Blocks(blocks))
    }

    fn assemble_all(&self, data: &DataTerm<D>, workers: &Workers) -> Result<Assembled> {
        self.assemble(data, 0..self.smoothness.shape()[0], workers)
    }
}

/// `halved` with the axes that the plane lacks, which are not.
fn in_space<const D: usize>(halved: [bool; D]) -> [bool; 3] {
    std::array::from_fn(|a| a + D >= 3 && halved[a + D - 3])
}

/// A on one grid.
enum Form<'a, const D: usize> {
    Finest(&'a mut Terms<D>),
    Terms(Terms<D>),
    Entries(Assembled),
}

/// One grid of the multigrid.
pub(super) struct Level<'a, const D: usize> {
    data: &'a DataTerm<D>,
    form: Form<'a, D>,
    local: Local,
    to_coarser: TwoScale,
    len: usize,
}

/// Its local inverse.
enum Local {
    /// 1 / diagonal [n]
    Diagonal(Vec<f64>),
    Blocks(Blocks),
}

impl<const D: usize> multigrid::Level for Level<'_, D> {
    fn len(&self) -> usize {
        self.len
    }

    fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        match &mut self.form {
            Form::Finest(terms) => terms.apply(self.data, workers, x, y),
            Form::Terms(terms) => terms.apply(self.data, workers, x, y),
            Form::Entries(matrix) => matrix.apply(workers, x, y),
        }
    }

    fn invert_locally(&mut self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        match &self.local {
            Local::Diagonal(inverse) => {
                z.copy_from_slice(r);
                update(workers, z, inverse, |d, r| d * r);
            }
            Local::Blocks(blocks) => blocks.apply(workers, r, z),
        }
    }

    fn restrict(&mut self, workers: &Workers, fine: &[f64], coarse: &mut [f64]) {
        self.to_coarser.restrict(workers, fine, coarse);
    }

    fn prolong_add(&mut self, workers: &Workers, coarse: &[f64], fine: &mut [f64]) {
        self.to_coarser.prolong_add(workers, coarse, fine);
    }
}

/// The multigrid of `finest`; `None` where the grid is too small for one.
pub(super) fn multigrid<'a, const D: usize>(
    data: &'a DataTerm<D>,
    finest: &'a mut Terms<D>,
    workers: &Workers,
) -> Result<Option<Multigrid<Level<'a, D>>>> {
    let mut halved = finest.halved();
    if halved == [false; D] {
        return Ok(None);
    }
    let mut levels = Vec::new();
    let mut next = finest.coarser(data, halved)?;
    let n = finest.view.grid().n_control();
    let mut shape = finest.smoothness.shape();
    let (mut local, mut form) = if (n as f64) < ENTRIES_BELOW * data.n_points() as f64 {
        let t=std::time::Instant::now();
        let matrix = finest.assemble_all(data, workers)?;
        {eprintln!("assembled {:?}", t.elapsed());let l=finest.local(data, Some(&matrix), workers)?;eprintln!("blocks {:?}", t.elapsed()); (l, Form::Entries(matrix))}
    } else {
        (finest.local(data, None, workers)?, Form::Finest(finest))
    };
    loop {
        let to_coarser = TwoScale::new(shape, in_space(halved))?;
        let mut level = Level { data, form, local, to_coarser, len: shape.iter().product() };
        let smoother = Smoother::new(&mut level, workers)?;
        levels.push((level, smoother));
        halved = next.halved();
        if halved == [false; D] {
            let matrix = next.assemble_all(data, workers)?;
            let n = next.view.grid().n_control();
            return Ok(Some(Multigrid::new(levels, Cholesky::new(n, matrix.lower_triangle()?, LEAST_PIVOT))?));
        }
        let coarser = next.coarser(data, halved)?;
        shape = next.smoothness.shape();
        let n = next.view.grid().n_control();
        (local, form) = if (n as f64) < ENTRIES_BELOW * data.n_points() as f64 {
            let matrix = next.assemble_all(data, workers)?;
            (next.local(data, Some(&matrix), workers)?, Form::Entries(matrix))
        } else {
            (next.local(data, None, workers)?, Form::Terms(next))
        };
        next = coarser;
    }
}
