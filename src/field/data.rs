//! The data terms of the energy, paper 000 (6): values and gradients at the points of the cloud.
//!
//! Neither matrix nor stencil is stored: a point keeps its coordinates in cells, and its 4^D weights are made again where they are needed.

use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::geometry::Cloud;
use crate::geometry::vec::{norm, scale, sub};
use crate::isa::Portable;
use crate::par::Workers;
use crate::spline::Grid;
use crate::spline::basis::Weights;
use std::ops::Range;

/// Cells along x of a slab. The points of a slab touch its planes of control points and the three behind, so slabs of at least three
/// cells, every other one at a time, write to different planes and need no lock.
const SLAB: usize = 4;

/// How far a point is from what the data ask for.
#[derive(Debug, Clone, Copy, Default)]
pub struct Misfit {
    /// First-order distance |phi| / |grad phi| to the surface phi = 0, in units of D.
    pub distance: f64,
    /// |grad phi - s n|
    pub normal: f64,
}

/// Points in cells of a grid, sorted by cell.
pub struct Data<const D: usize = 3> {
    /// [N x D], in cells.
    xi: Vec<[f64; D]>,
    /// Unit normals [N x D].
    normals: Vec<[f64; D]>,
    /// The caller's weights, of sum 1 [N].
    share: Vec<f64>,
    mass: Vec<Mass>,
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
        };
        let largest = cloud.weights().map(|weights| weights.iter().fold(0.0, |m: f64, w| m.max(*w)));
        for (place, (_, i)) in keys.iter().enumerate() {
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
        data.mass.iter_mut().zip(&data.share).for_each(|(m, s)| *m = Mass { value: *s, gradient: *s });
        Ok(data)
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
            let (value, gradient) = stencil.value_gradient::<Portable>(x, &b);
            let (mass, pull) = (self.data.mass[p].value, self.pull(p));
            let gradient = std::array::from_fn(|a| pull[a] * self.per_cell[a] * gradient[a]);
            stencil.shifted(first_layer).scatter::<Portable>(y, &b, mass * value, gradient);
        });
    }

    /// y += the right-hand side that asks for the gradient `sign` n at each point.
    pub fn add_right_hand_side(&self, workers: &Workers, sign: f64, y: &mut [f64]) {
        self.by_slab(workers, y, |p, y, first_layer| {
            let (stencil, u) = self.grid.stencil(self.data.xi[p]);
            let pull = self.pull(p);
            let gradient = std::array::from_fn(|a| pull[a] * sign * self.data.normals[p][a]);
            stencil.shifted(first_layer).scatter::<Portable>(y, &u.map(Weights::at), 0.0, gradient);
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
            stencil.shifted(first_layer).scatter::<Portable>(y, &squares, self.data.mass[p].value, gradient);
        });
    }

    /// Points.
    pub fn n_points(&self) -> usize {
        self.data.xi.len()
    }

    /// How far each point is from what the data ask for; `x` are control points.
    ///
    /// Where phi is nearly flat |phi| / |grad phi| means nothing: `flattest` bounds |grad phi| from below.
    pub fn misfits(&self, workers: &Workers, x: &[f64], sign: f64, flattest: f64, misfits: &mut [Misfit]) {
        const CHUNK: usize = 1024;
        workers.for_each(misfits.chunks_mut(CHUNK).enumerate(), |(chunk, misfits)| {
            for (i, misfit) in misfits.iter_mut().enumerate() {
                let p = chunk * CHUNK + i;
                let (stencil, u) = self.grid.stencil(self.data.xi[p]);
                let (value, g) = stencil.value_gradient::<Portable>(x, &u.map(Weights::at));
                let gradient: [f64; D] = std::array::from_fn(|a| self.per_cell[a] * g[a]);
                misfit.distance = value.abs() / norm(gradient).max(flattest);
                misfit.normal = norm(sub(gradient, scale(sign, self.data.normals[p])));
            }
        });
    }

    /// Multiplies what the value of each point counts for by a factor of its own.
    pub fn reweight(&mut self, factors: impl Iterator<Item = f64>) {
        self.data.mass.iter_mut().zip(factors).for_each(|(mass, factor)| mass.value *= factor);
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

    /// The points whose normals count for more than half, in units of D from the lower corner of the box, with their normals.
    pub fn counted(&self) -> Result<Cloud<D>> {
        // Sides are told by normals alone, so one that is in doubt is none.
        let counts = |p: &usize| self.data.mass[*p].gradient > 0.5 * self.data.share[*p];
        let n = (0..self.n_points()).filter(counts).count();
        let mut points = try_with_capacity(n, "the points in units of D")?;
        let mut normals = try_with_capacity(n, "the normals")?;
        for p in (0..self.n_points()).filter(counts) {
            points.push(std::array::from_fn(|a| self.data.xi[p][a] * self.grid.axes[a].cell));
            normals.push(self.data.normals[p]);
        }
        Cloud::new(points, normals)
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
