//! Cells twice as long: the splines of a coarse grid are splines of the fine one, control points and all.
//!
//! ```text
//! B_J(x / 2) = 1/8 B_{2J-3} + 4/8 B_{2J-2} + 6/8 B_{2J-1} + 4/8 B_{2J} + 1/8 B_{2J+1}
//! ```
//!
//! J and the others count control points, so those of coarse cell I are I .. I + 3. An odd number of fine cells leaves the last coarse cell
//! half beyond the box, and its last fine function with no support inside, where it is left out: splines agree on the box, not beyond.
//! Axes are coarsened each for itself; the plane is space with one control point along x.

use super::gram::{Band, Gram, HALF_BAND};
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;

/// Weights of the fine functions 2J - 3 .. 2J + 1 in a coarse one.
const WEIGHTS: [f64; 5] = [0.125, 0.5, 0.75, 0.5, 0.125];

/// Cells of twice the length that cover `n_cells`.
pub fn coarser(n_cells: usize) -> usize {
    n_cells.div_ceil(2)
}

/// Fine control points among `n_fine` that take part in coarse one `j`, with the first one's place among the weights.
fn children(j: usize, n_fine: usize) -> (std::ops::Range<usize>, usize) {
    let first = (2 * j).saturating_sub(3);
    (first..(2 * j + 2).min(n_fine), first + 3 - 2 * j)
}

/// Coarse control points that fine one `i` takes part in, and the place of its weight in the first; in the next it is 2 less.
fn parents(i: usize) -> (std::ops::RangeInclusive<usize>, usize) {
    let last = (i + 3) / 2;
    let first = i.saturating_sub(1).div_ceil(2);
    (first..=last, i + 3 - 2 * first)
}

/// Transfers between the control points of a grid and those of a coarser one.
pub struct TwoScale {
    fine: [usize; 3],
    coarse: [usize; 3],
    /// After axis x, and after x and y.
    scratch: [Vec<f64>; 2],
}

impl TwoScale {
    /// Between tensors of `fine` control points and those with the axes coarsened for which `halved` is true.
    pub fn new(fine: [usize; 3], halved: [bool; 3]) -> Result<Self> {
        let n = |a: usize| if halved[a] { coarser(fine[a] - 3) + 3 } else { fine[a] };
        let coarse = [n(0), n(1), n(2)];
        let scratch = [
            try_vec(coarse[0] * fine[1] * fine[2], 0.0, "the work space of the multigrid")?,
            try_vec(coarse[0] * coarse[1] * fine[2], 0.0, "the work space of the multigrid")?,
        ];
        Ok(TwoScale { fine, coarse, scratch })
    }

    /// Control points of the coarse grid.
    pub fn coarse(&self) -> [usize; 3] {
        self.coarse
    }

    /// coarse = P^T fine
    pub fn restrict(&mut self, workers: &Workers, fine: &[f64], coarse: &mut [f64]) {
        let ([fx, fy, fz], [cx, cy, cz]) = (self.fine, self.coarse);
        let [along_x, along_y] = &mut self.scratch;
        let plane = fy * fz;
        workers.for_each(along_x.chunks_mut(plane).enumerate(), |(j, to)| restrict_row(fine, [fx, cx], j, to));
        let planes = along_y.chunks_mut(cy * fz).zip(coarse.chunks_mut(cy * cz));
        workers.for_each(along_x.chunks(plane).zip(planes), |(from, (along_y, to))| {
            for (j, row) in along_y.chunks_mut(fz).enumerate() {
                restrict_row(from, [fy, cy], j, row);
            }
            for (from, to) in along_y.chunks(fz).zip(to.chunks_mut(cz)) {
                to.iter_mut().enumerate().for_each(|(j, t)| restrict_row(from, [fz, cz], j, std::slice::from_mut(t)));
            }
        });
    }

    /// fine += P coarse
    pub fn prolong_add(&mut self, workers: &Workers, coarse: &[f64], fine: &mut [f64]) {
        let ([fx, fy, fz], [cx, cy, cz]) = (self.fine, self.coarse);
        let [along_x, along_y] = &mut self.scratch;
        let planes = along_y.chunks_mut(cy * fz).zip(along_x.chunks_mut(fy * fz));
        workers.for_each(coarse.chunks(cy * cz).zip(planes), |(from, (along_y, to))| {
            along_y.fill(0.0);
            for (from, to) in from.chunks(cz).zip(along_y.chunks_mut(fz)) {
                to.iter_mut().enumerate().for_each(|(i, t)| prolong_row(from, [fz, cz], i, std::slice::from_mut(t)));
            }
            to.fill(0.0);
            for (i, row) in to.chunks_mut(fz).enumerate() {
                prolong_row(along_y, [fy, cy], i, row);
            }
        });
        let along_x = &*along_x;
        workers.for_each(fine.chunks_mut(fy * fz).enumerate(), |(i, to)| prolong_row(along_x, [fx, cx], i, to));
    }
}

/// to = row `j` of P^T along an axis of `[fine, coarse]` control points, with rows as long as `to`.
fn restrict_row(from: &[f64], [fine, coarse]: [usize; 2], j: usize, to: &mut [f64]) {
    let m = to.len();
    if fine == coarse {
        to.copy_from_slice(&from[j * m..][..m]);
        return;
    }
    to.fill(0.0);
    let (children, first) = children(j, fine);
    for (i, w) in children.zip(&WEIGHTS[first..]) {
        to.iter_mut().zip(&from[i * m..][..m]).for_each(|(t, f)| *t += w * f);
    }
}

/// to += row `i` of P along an axis of `[fine, coarse]` control points, with rows as long as `to`.
fn prolong_row(from: &[f64], [fine, coarse]: [usize; 2], i: usize, to: &mut [f64]) {
    let m = to.len();
    if fine == coarse {
        to.iter_mut().zip(&from[i * m..][..m]).for_each(|(t, f)| *t += f);
        return;
    }
    let (parents, first) = parents(i);
    for (j, w) in parents.zip((0..=first).rev().step_by(2).map(|k| WEIGHTS[k])) {
        to.iter_mut().zip(&from[j * m..][..m]).for_each(|(t, f)| *t += w * f);
    }
}

/// The matrices of the coarse functions, integrated over the box: P^T G P.
pub fn coarser_gram(gram: &Gram) -> Result<Gram> {
    let [zeroth, first, second] = &gram.order;
    Ok(Gram { order: [coarser_band(zeroth)?, coarser_band(first)?, coarser_band(second)?] })
}

fn coarser_band(band: &Band) -> Result<Band> {
    let n_fine = band.len();
    let n = coarser(n_fine - 3) + 3;
    let mut coarse: Band = try_vec(n, [0.0; 2 * HALF_BAND + 1], "the Gram matrices")?;
    for (p, row) in coarse.iter_mut().enumerate() {
        for q in p.saturating_sub(HALF_BAND)..(p + HALF_BAND + 1).min(n) {
            let ((rows, i0), (columns, j0)) = (children(p, n_fine), children(q, n_fine));
            let mut sum = 0.0;
            for (i, wi) in rows.zip(&WEIGHTS[i0..]) {
                for (j, wj) in columns.clone().zip(&WEIGHTS[j0..]) {
                    if i.abs_diff(j) <= HALF_BAND {
                        sum += wi * wj * band[i][j + HALF_BAND - i];
                    }
                }
            }
            row[q + HALF_BAND - p] = sum;
        }
    }
    Ok(coarse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::spline::{Axis, Grid};

    fn grid(n_cells: [usize; 3], cell: f64) -> Grid {
        Grid { axes: n_cells.map(|n| Axis { lower: 0.0, cell, n_cells: n }) }
    }

    fn numbers(n: usize, seed: u64) -> Vec<f64> {
        let mut random = SplitMix64::new(seed);
        (0..n).map(|_| random.between(-1.0, 1.0)).collect()
    }

    #[test]
    fn coarse_splines_are_fine_ones_on_the_box() {
        for n_cells in [[1, 1, 1], [2, 3, 1], [5, 4, 7], [9, 8, 6]] {
            let fine = grid(n_cells, 1.0);
            let halved = n_cells.map(|n| n > 1);
            let coarse_cells = std::array::from_fn(|a| if halved[a] { coarser(n_cells[a]) } else { n_cells[a] });
            let coarse = grid(coarse_cells, 1.0);
            let mut two = TwoScale::new(fine.shape(), halved).unwrap();
            assert_eq!(two.coarse(), coarse.shape());
            let c = numbers(coarse.n_control(), 1);
            let mut f = vec![0.0; fine.n_control()];
            two.prolong_add(&Workers::caller_only(), &c, &mut f);
            let mut random = SplitMix64::new(2);
            for _ in 0..50 {
                let x: [f64; 3] = std::array::from_fn(|a| random.between(0.0, n_cells[a] as f64));
                let half = std::array::from_fn(|a| if halved[a] { 0.5 * x[a] } else { x[a] });
                let ((sf, uf), (sc, uc)) = (fine.stencil(x), coarse.stencil(half));
                assert!(
                    (sf.value::<crate::isa::Portable>(&f, uf) - sc.value::<crate::isa::Portable>(&c, uc)).abs() < 1e-14,
                    "{n_cells:?} at {x:?}"
                );
            }
        }
    }

    #[test]
    fn restriction_is_the_transpose_of_prolongation() {
        for (fine, halved) in
            [([4, 5, 6], [false, true, true]), ([1, 8, 13], [false, true, true]), ([10, 4, 9], [true; 3])]
        {
            let workers = Workers::new(2).unwrap();
            let mut two = TwoScale::new(fine, halved).unwrap();
            let (f, c) = (numbers(fine.iter().product(), 3), numbers(two.coarse().iter().product(), 4));
            let (mut pc, mut rf) = (vec![0.0; f.len()], vec![0.0; c.len()]);
            two.prolong_add(&workers, &c, &mut pc);
            two.restrict(&workers, &f, &mut rf);
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            assert!((dot(&f, &pc) - dot(&rf, &c)).abs() < 1e-13);
        }
    }

    #[test]
    fn where_cells_align_the_coarse_matrices_are_those_of_the_coarse_grid() {
        for n in [2, 4, 10] {
            let (fine, coarse) = (Gram::new(n, 0.5).unwrap(), Gram::new(n / 2, 1.0).unwrap());
            let galerkin = coarser_gram(&fine).unwrap();
            for k in 0..3 {
                for (a, b) in galerkin.order[k].iter().flatten().zip(coarse.order[k].iter().flatten()) {
                    assert!((a - b).abs() < 1e-15 * 100.0);
                }
            }
        }
    }
}
