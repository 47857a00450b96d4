//! Values of a spline at the centres of all cells, axis by axis: 12 multiplications a cell, where a point anywhere takes 84.

use super::Grid;
use super::basis::Weights;
use crate::Result;
use crate::error::try_vec;

/// Weights of the four functions of a cell, the same along each axis.
pub type Taps = [f64; 4];

/// B_i at the centre of a cell.
pub fn taps() -> Taps {
    Weights::at(0.5).w
}

/// Sums over the control points of each cell, with the memory that they take.
#[derive(Debug)]
pub struct Centers<const D: usize = 3> {
    /// Cells along the axes before each.
    outer: [usize; D],
    n_cells: [usize; D],
    /// Control points along the axes behind each.
    inner: [usize; D],
    /// After each axis but the last.
    scratch: Vec<Vec<f64>>,
}

impl<const D: usize> Centers<D> {
    /// For the cells of `grid`.
    pub fn new(grid: &Grid<D>) -> Result<Self> {
        let (shape, n_cells) = (grid.shape(), grid.n_cells());
        let outer = std::array::from_fn(|a| n_cells[..a].iter().product());
        let inner = std::array::from_fn(|a| shape[a + 1..].iter().product());
        let scratch = (0..D - 1).map(|a| try_vec(outer[a] * n_cells[a] * inner[a], 0.0, "the values at cells"));
        Ok(Centers { outer, n_cells, inner, scratch: scratch.collect::<Result<_>>()? })
    }

    /// values = sum over a cell's control points of w_i w_j w_k c_ijk, one a cell
    pub fn gather(&mut self, w: &Taps, coefficients: &[f64], values: &mut [f64]) {
        for a in 0..D {
            let sizes = self.sizes(a);
            let (done, rest) = self.scratch.split_at_mut(a);
            let from = done.last().map_or(coefficients, |v| &v[..]);
            gather_axis(w, from, rest.first_mut().map_or(&mut *values, |v| &mut v[..]), sizes);
        }
    }

    /// coefficients += the transpose of [`Centers::gather`] applied to `values`.
    pub fn scatter(&mut self, w: &Taps, values: &[f64], coefficients: &mut [f64]) {
        self.scratch.iter_mut().for_each(|v| v.fill(0.0));
        for a in (0..D).rev() {
            let sizes = self.sizes(a);
            let (before, behind) = self.scratch.split_at_mut(a);
            let from = behind.first().map_or(values, |v| &v[..]);
            scatter_axis(w, from, before.last_mut().map_or(&mut *coefficients, |v| &mut v[..]), sizes);
        }
    }

    /// Lines along axis `a`: how many blocks of them, their cells, and how many lie side by side.
    fn sizes(&self, a: usize) -> [usize; 3] {
        [self.outer[a], self.n_cells[a], self.inner[a]]
    }
}

/// to[o, i, :] = sum_a w_a from[o, i + a, :], for `outer` o, `n` cells i and rows of `inner`.
fn gather_axis(w: &Taps, from: &[f64], to: &mut [f64], [outer, n, inner]: [usize; 3]) {
    for o in 0..outer {
        let from = &from[o * (n + 3) * inner..][..(n + 3) * inner];
        for (i, to) in to[o * n * inner..][..n * inner].chunks_mut(inner).enumerate() {
            to.fill(0.0);
            for (a, w) in w.iter().enumerate() {
                let row = &from[(i + a) * inner..][..inner];
                to.iter_mut().zip(row).for_each(|(t, f)| *t += w * f);
            }
        }
    }
}

/// The transpose: to[o, i + a, :] += w_a from[o, i, :].
fn scatter_axis(w: &Taps, from: &[f64], to: &mut [f64], [outer, n, inner]: [usize; 3]) {
    for o in 0..outer {
        let to = &mut to[o * (n + 3) * inner..][..(n + 3) * inner];
        for (i, from) in from[o * n * inner..][..n * inner].chunks(inner).enumerate() {
            for (a, w) in w.iter().enumerate() {
                let row = &mut to[(i + a) * inner..][..inner];
                row.iter_mut().zip(from).for_each(|(t, f)| *t += w * f);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isa::Portable;
    use crate::spline::Axis;

    #[test]
    fn gathers_what_the_kernel_gives_and_scatters_its_transpose() {
        for n_cells in [[1, 1, 1], [2, 3, 1], [4, 3, 5]] {
            let grid = Grid { axes: n_cells.map(|n| Axis { lower: 0.0, cell: 1.0, n_cells: n }) };
            let c: Vec<f64> = (0..grid.n_control()).map(|i| (i as f64 * 0.37).sin()).collect();
            let mut centers = Centers::new(&grid).unwrap();
            let mut values = vec![0.0; n_cells.iter().product()];
            centers.gather(&taps(), &c, &mut values);
            let mut at = values.iter();
            for i in 0..n_cells[0] {
                for j in 0..n_cells[1] {
                    for k in 0..n_cells[2] {
                        let (stencil, u) = grid.stencil([i, j, k].map(|x| x as f64 + 0.5));
                        assert!((stencil.value::<Portable>(&c, u) - at.next().unwrap()).abs() < 1e-14);
                    }
                }
            }
            let weights: Vec<f64> = (0..values.len()).map(|i| (i as f64 * 0.9).cos()).collect();
            let mut back = vec![0.0; c.len()];
            centers.scatter(&taps(), &weights, &mut back);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            assert!((dot(&values, &weights) - dot(&c, &back)).abs() < 1e-12);
        }
    }
}
