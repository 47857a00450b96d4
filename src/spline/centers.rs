//! Values of a spline at the centres of all cells, axis by axis: 12 multiplications a cell, where a point anywhere takes 84. On a coarse
//! grid, the centres of the cells of the one that is finer.

use super::Grid;
use super::basis::Weights;
use crate::Result;
use crate::error::try_vec;
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;

/// Weights of the four functions of a cell, the same along each axis.
#[derive(Debug, Clone, Copy)]
pub struct Taps {
    /// At the centre of a cell.
    whole: [f64; 4],
    /// At the centres of its halves.
    halves: [[f64; 4]; 2],
}

impl Taps {
    /// B_i
    pub fn values() -> Self {
        Taps { whole: Weights::at(0.5).w, halves: [0.25, 0.75].map(|u| Weights::at(u).w) }
    }

    /// B_i^2
    pub fn squares() -> Self {
        let Taps { whole, halves } = Taps::values();
        let squares = |w: [f64; 4]| w.map(|w| w * w);
        Taps { whole: squares(whole), halves: halves.map(squares) }
    }
}

/// Places along one axis.
#[derive(Debug, Clone, Copy)]
struct Places {
    /// How many.
    n: usize,
    n_control: usize,
    /// Two a cell, but for the last where their number is odd.
    halved: bool,
}

impl Places {
    /// The cell of place `i` and the weights of its functions there.
    #[inline(always)]
    fn at<'t>(&self, taps: &'t Taps, i: usize) -> (usize, &'t [f64; 4]) {
        if self.halved { (i / 2, &taps.halves[i % 2]) } else { (i, &taps.whole) }
    }

    /// The places in a cell, none in one that is not there.
    fn of_cell(&self, cell: usize) -> std::ops::Range<usize> {
        let per_cell = if self.halved { 2 } else { 1 };
        (cell * per_cell).min(self.n)..(cell * per_cell + per_cell).min(self.n)
    }
}

/// Sums over the control points of each cell, with the memory that they take.
#[derive(Debug)]
pub struct Centers<const D: usize = 3> {
    places: [Places; D],
    /// After each axis but the last.
    scratch: Vec<Vec<f64>>,
}

impl<const D: usize> Centers<D> {
    /// For the cells of `grid`.
    pub fn new(grid: &Grid<D>) -> Result<Self> {
        Centers::of_finer(grid, grid.n_cells())
    }

    /// For `n` cells along each axis, those of `grid` or halves of them.
    pub fn of_finer(grid: &Grid<D>, n: [usize; D]) -> Result<Self> {
        let (shape, n_cells) = (grid.shape(), grid.n_cells());
        let places = std::array::from_fn(|a| Places { n: n[a], n_control: shape[a], halved: n[a] > n_cells[a] });
        let len = |a: usize| n[..=a].iter().product::<usize>() * shape[a + 1..].iter().product::<usize>();
        let scratch = (0..D - 1).map(|a| try_vec(len(a), 0.0, "the values at cells"));
        Ok(Centers { places, scratch: scratch.collect::<Result<_>>()? })
    }

    /// Cell and local coordinate of place `i` along `axis`.
    pub fn place(&self, axis: usize, i: usize) -> (usize, f64) {
        if self.places[axis].halved { (i / 2, 0.25 + 0.5 * (i % 2) as f64) } else { (i, 0.5) }
    }

    /// Cells along each axis.
    pub fn cells(&self) -> [usize; D] {
        self.places.map(|p| p.n_control - 3)
    }

    /// Places along each axis.
    pub fn shape(&self) -> [usize; D] {
        self.places.map(|p| p.n)
    }

    /// values = sum over a cell's control points of w_i w_j w_k c_ijk, one a place
    pub fn gather(&mut self, workers: &Workers, taps: &Taps, coefficients: &[f64], values: &mut [f64]) {
        for (a, places) in self.places.into_iter().enumerate() {
            let inner = self.inner(a);
            let (done, rest) = self.scratch.split_at_mut(a);
            let from = done.last().map_or(coefficients, |v| &v[..]);
            let to = rest.first_mut().map_or(&mut *values, |v| &mut v[..]);
            gather_axis(workers, taps, places, from, to, inner);
        }
    }

    /// coefficients += the transpose of [`Centers::gather`] applied to `values`.
    pub fn scatter(&mut self, workers: &Workers, taps: &Taps, values: &[f64], coefficients: &mut [f64]) {
        self.scratch.iter_mut().for_each(|v| v.fill(0.0));
        for (a, places) in self.places.into_iter().enumerate().rev() {
            let inner = self.inner(a);
            let (before, behind) = self.scratch.split_at_mut(a);
            let from = behind.first().map_or(values, |v| &v[..]);
            let to = before.last_mut().map_or(&mut *coefficients, |v| &mut v[..]);
            scatter_axis(workers, taps, places, from, to, inner);
        }
    }

    /// Control points side by side behind axis `a`.
    fn inner(&self, a: usize) -> usize {
        self.places[a + 1..].iter().map(|p| p.n_control).product()
    }
}

/// Rows of an axis that one thread takes on at a time.
const ROWS: usize = 64;

/// to[o, i, :] = sum_a w_a from[o, cell(i) + a, :], for places i and rows of `inner`, block o by block.
fn gather_axis(workers: &Workers, taps: &Taps, places: Places, from: &[f64], to: &mut [f64], inner: usize) {
    if inner == 1 {
        let (lines, to) = (from.chunks(ROWS * places.n_control), to.chunks_mut(ROWS * places.n));
        return workers.for_each(lines.zip(to), |(from, to)| dispatch(GatherLines { taps, places, from, to }));
    }
    let rows = to.chunks_mut(inner).enumerate();
    workers.for_each(rows, |(row, to)| {
        let (o, i) = (row / places.n, row % places.n);
        let (cell, w) = places.at(taps, i);
        let from = &from[(o * places.n_control + cell) * inner..][..4 * inner];
        to.fill(0.0);
        dispatch(AddRows { w, from, to });
    });
}

/// The transpose: to[o, cell(i) + a, :] += w_a from[o, i, :].
fn scatter_axis(workers: &Workers, taps: &Taps, places: Places, from: &[f64], to: &mut [f64], inner: usize) {
    if inner == 1 {
        let (lines, to) = (from.chunks(ROWS * places.n), to.chunks_mut(ROWS * places.n_control));
        return workers.for_each(lines.zip(to), |(from, to)| dispatch(ScatterLines { taps, places, from, to }));
    }
    let rows = to.chunks_mut(inner).enumerate();
    workers.for_each(rows, |(row, to)| {
        let (o, p) = (row / places.n_control, row % places.n_control);
        let from = &from[o * places.n * inner..][..places.n * inner];
        // Control point p is function a of cell p - a.
        for a in 0..=p.min(3) {
            for i in places.of_cell(p - a) {
                let (_, w) = places.at(taps, i);
                dispatch(AddRows { w: &w[a..a + 1], from: &from[i * inner..][..inner], to });
            }
        }
    });
}

/// to += sum of w_a times row a of `from`.
struct AddRows<'a> {
    w: &'a [f64],
    from: &'a [f64],
    to: &'a mut [f64],
}

impl Kernel for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AddRows { w, from, to } = self;
        for (w, from) in w.iter().zip(from.chunks_exact(to.len())) {
            to.iter_mut().zip(from).for_each(|(t, f)| *t = I::mul_add(*w, *f, *t));
        }
    }
}

/// Values at the places of lines.
struct GatherLines<'a> {
    taps: &'a Taps,
    places: Places,
    from: &'a [f64],
    to: &'a mut [f64],
}

impl Kernel for GatherLines<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let GatherLines { taps, places, from, to } = self;
        for (from, to) in from.chunks_exact(places.n_control).zip(to.chunks_exact_mut(places.n)) {
            if places.halved {
                for (i, t) in to.iter_mut().enumerate() {
                    let (cell, w) = places.at(taps, i);
                    *t = (0..4).fold(0.0, |sum, a| I::mul_add(w[a], from[cell + a], sum));
                }
            } else {
                let [f0, f1, f2, f3] = std::array::from_fn(|a| &from[a..a + places.n]);
                let w = &taps.whole;
                for (i, t) in to.iter_mut().enumerate() {
                    let first = I::mul_add(w[0], f0[i], w[1] * f1[i]);
                    *t = I::mul_add(w[3], f3[i], I::mul_add(w[2], f2[i], first));
                }
            }
        }
    }
}

/// The transpose of [`GatherLines`], added.
struct ScatterLines<'a> {
    taps: &'a Taps,
    places: Places,
    from: &'a [f64],
    to: &'a mut [f64],
}

impl Kernel for ScatterLines<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let ScatterLines { taps, places, from, to } = self;
        for (from, to) in from.chunks_exact(places.n).zip(to.chunks_exact_mut(places.n_control)) {
            if places.halved {
                for (i, f) in from.iter().enumerate() {
                    let (cell, w) = places.at(taps, i);
                    (0..4).for_each(|a| to[cell + a] = I::mul_add(w[a], *f, to[cell + a]));
                }
            } else {
                for (a, w) in taps.whole.iter().enumerate() {
                    to[a..].iter_mut().zip(from).for_each(|(t, f)| *t = I::mul_add(*w, *f, *t));
                }
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
            centers.gather(&Workers::caller_only(), &Taps::values(), &c, &mut values);
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
            centers.scatter(&Workers::caller_only(), &Taps::values(), &weights, &mut back);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            assert!((dot(&values, &weights) - dot(&c, &back)).abs() < 1e-12);
        }
    }
}
