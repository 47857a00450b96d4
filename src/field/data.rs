//! The data terms of the energy, paper 000 (6): values and gradients at the points of the cloud.
//!
//! Neither matrix nor stencil is stored: a point keeps its coordinates in cells, and its 4^D weights are made again where they are needed.

use crate::Result;
use crate::error::try_vec;
use crate::geometry::Cloud;
use crate::geometry::vec::norm;
use crate::par::Workers;
use crate::spline::Grid;
use crate::spline::basis::Weights;
use std::ops::Range;

/// Cells along x of a slab. The points of a slab touch its planes of control points and the three behind, so slabs of at least three
/// cells, every other one at a time, write to different planes and need no lock.
const SLAB: usize = 4;

/// Points in cells of a grid, sorted by cell.
pub struct Data<const D: usize = 3> {
    /// [N x D], in cells.
    xi: Vec<[f64; D]>,
    mass: Vec<Mass>,
}

/// What a point counts for: 1 / N unless reweighted.
#[derive(Debug, Clone, Copy)]
struct Mass {
    /// In the sum of values.
    value: f64,
    /// In the sum of gradients.
    gradient: f64,
}

impl<const D: usize> Data<D> {
    /// The points of `cloud` in the cells of `grid`, all of one mass, and the cloud's indices in the order that they now have.
    pub fn new(cloud: &Cloud<D>, grid: &Grid<D>) -> Result<(Self, Vec<u32>)> {
        let n = cloud.len();
        let to_cells = |p: &[f64; D]| std::array::from_fn(|a| (p[a] - grid.axes[a].lower) / grid.axes[a].cell);
        let mut keys = try_vec(n, (0usize, 0u32), "the order of the points")?;
        for (i, (key, p)) in keys.iter_mut().zip(cloud.points()).enumerate() {
            *key = (grid.stencil(to_cells(p)).0.first, i as u32);
        }
        keys.sort_unstable();
        let mut order = try_vec(n, 0, "the order of the points")?;
        let mut xi = try_vec(n, [0.0; D], "the points")?;
        for ((key, slot), place) in keys.iter().zip(&mut xi).zip(&mut order) {
            *slot = to_cells(&cloud.points()[key.1 as usize]);
            *place = key.1;
        }
        Ok((
            Data {
                xi,
                mass: try_vec(n, Mass { value: 1.0 / n as f64, gradient: 1.0 / n as f64 }, "the masses of the points")?,
            },
            order,
        ))
    }
}

/// Energy of the values and gradients at the points: sum of m_v phi^2 + lambda_n m_g |grad phi|^2.
pub struct DataTerm<const D: usize = 3> {
    data: Data<D>,
    /// In units of D.
    grid: Grid<D>,
    normal_weight: f64,
    /// 1 / h_a: what turns a derivative along a cell into one along x.
    per_cell: [f64; D],
    slabs: Vec<Range<usize>>,
}

impl<const D: usize> DataTerm<D> {
    /// The term for `data` in the cells of `grid`, which is in units of D.
    pub fn new(data: Data<D>, grid: Grid<D>, normal_weight: f64) -> Self {
        let per_cell = grid.axes.map(|a| 1.0 / a.cell);
        let below = |cell: usize| data.xi.partition_point(|xi| grid.axes[0].locate(xi[0]).0 < cell);
        let n_slabs = grid.axes[0].n_cells.div_ceil(SLAB);
        let slabs = (0..n_slabs).map(|s| below(s * SLAB)..below((s + 1) * SLAB)).collect();
        DataTerm { data, grid, normal_weight, per_cell, slabs }
    }

    /// y += (the term's matrix) x
    pub fn apply(&self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.by_slab(workers, y, |p, y, first_layer| {
            let (stencil, u) = self.grid.stencil(self.data.xi[p]);
            let b = u.map(Weights::at);
            let (value, gradient) = stencil.value_gradient(x, &b);
            let (mass, pull) = (self.data.mass[p].value, self.pull(p));
            let gradient = std::array::from_fn(|a| pull[a] * self.per_cell[a] * gradient[a]);
            stencil.shifted(first_layer).scatter(y, &b, mass * value, gradient);
        });
    }

    /// y += the right-hand side that asks for the gradient `sign` n at each point; the points are those of `normals` [N x D] in `order`.
    pub fn add_right_hand_side(
        &self,
        workers: &Workers,
        normals: &[[f64; D]],
        order: &[u32],
        sign: f64,
        y: &mut [f64],
    ) {
        self.by_slab(workers, y, |p, y, first_layer| {
            let (stencil, u) = self.grid.stencil(self.data.xi[p]);
            let pull = self.pull(p);
            let gradient = std::array::from_fn(|a| pull[a] * sign * normals[order[p] as usize][a]);
            stencil.shifted(first_layer).scatter(y, &u.map(Weights::at), 0.0, gradient);
        });
    }

    /// y += the diagonal of the term's matrix.
    pub fn add_diagonal(&self, workers: &Workers, y: &mut [f64]) {
        self.by_slab(workers, y, |p, y, first_layer| {
            let (stencil, u) = self.grid.stencil(self.data.xi[p]);
            // The squares of the weights of a tensor product are the tensor product of the squares.
            let squares = u.map(|u| {
                let Weights { w, dw } = Weights::at(u);
                Weights { w: w.map(|w| w * w), dw: dw.map(|d| d * d) }
            });
            let pull = self.pull(p);
            let gradient = std::array::from_fn(|a| pull[a] * self.per_cell[a]);
            stencil.shifted(first_layer).scatter(y, &squares, self.data.mass[p].value, gradient);
        });
    }

    /// Points.
    pub fn n_points(&self) -> usize {
        self.data.xi.len()
    }

    /// First-order distance |phi| / |grad phi| of each point to the surface phi = 0, in units of D; `x` are control points.
    ///
    /// Where phi is nearly flat the quotient means nothing: `flattest` bounds |grad phi| from below.
    pub fn distances(&self, workers: &Workers, x: &[f64], flattest: f64, distances: &mut [f64]) {
        const CHUNK: usize = 1024;
        workers.for_each(self.data.xi.chunks(CHUNK).zip(distances.chunks_mut(CHUNK)), |(xi, distances)| {
            for (xi, distance) in xi.iter().zip(distances) {
                let (stencil, u) = self.grid.stencil(*xi);
                let (value, g) = stencil.value_gradient(x, &u.map(Weights::at));
                let slope = norm::<D>(std::array::from_fn(|a| self.per_cell[a] * g[a]));
                *distance = value.abs() / slope.max(flattest);
            }
        });
    }

    /// Multiplies what the value of each point counts for by a factor of its own.
    pub fn reweight(&mut self, factors: &[f64]) {
        self.data.mass.iter_mut().zip(factors).for_each(|(mass, factor)| mass.value *= factor);
    }

    /// mass lambda_n / h_a of point `p`.
    fn pull(&self, p: usize) -> [f64; D] {
        self.per_cell.map(|c| self.normal_weight * self.data.mass[p].gradient * c)
    }

    /// Calls `work(point, layers of y along x, index of the first of these)` for each point; the order of the sums into an entry of y
    /// does not depend on the threads.
    fn by_slab(&self, workers: &Workers, y: &mut [f64], work: impl Fn(usize, &mut [f64], usize) + Send + Sync) {
        let plane = self.grid.n_control() / self.grid.shape()[0];
        for parity in 0..2 {
            let Some(planes) = y.get_mut(parity * SLAB * plane..) else { break };
            let slabs = self.slabs.iter().enumerate().skip(parity).step_by(2);
            workers.for_each(slabs.zip(planes.chunks_mut(2 * SLAB * plane)), |((s, points), y)| {
                for p in points.clone() {
                    work(p, y, s * SLAB);
                }
            });
        }
    }
}
