//! An approximate inverse of a symmetric operator: the sum of the exact inverses on small overlapping blocks of control points (additive
//! Schwarz; Smith, Bjorstad and Gropp 1996, chapter 1).
//!
//! Where data are stiff beside smoothness, combinations of neighbours that the data hardly see have far less energy than any one control
//! point. The diagonal takes them for stiff, and no coarse grid can express them; a block of 4^D control points, every second one along each
//! axis, has them whole. Control points in no block have the diagonal.
//!
//! Blocks are factored and solved eight side by side, one a lane, so that every instruction serves all. Factors are kept in single precision:
//! rounding leaves them positive, and their square is near the operator's wherever its condition is below 1e12.

use super::assembled::Assembled;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use std::ops::Range;

/// Control points of a block along an axis: as many as share a cell, and as an axis has at least.
const EDGE: usize = 4;

/// From one block to the next.
const STEP: usize = 2;

/// Blocks side by side.
const LANES: usize = 8;

/// Pivots that fall below this part of the diagonal are rounding.
const LEAST_PIVOT: f64 = 1e-12;

/// Slabs of which the operator is assembled at a time.
const SLABS: usize = 8;

/// The inverse.
pub struct Blocks {
    shape: [usize; 3],
    slabs: Vec<Slab>,
    /// 1 / sqrt(diagonal) [n]
    scale: Vec<f64>,
    /// Whether each control point is in no block [n]
    alone: Vec<bool>,
}

/// The blocks that begin at one plane.
struct Slab {
    plane: usize,
    batches: Vec<Batch>,
}

/// Eight blocks.
struct Batch {
    /// First control point of each; as many as there are.
    firsts: Vec<usize>,
    /// L of the blocks with a diagonal of 1, rows of the lower triangle, with the reciprocals of its diagonal.
    factor: Vec<[f32; LANES]>,
}

/// Where blocks begin along an axis of `n` control points.
fn starts(n: usize) -> Vec<usize> {
    match n {
        1 => vec![0],
        _ => (0..n - EDGE).step_by(STEP).chain([n - EDGE]).collect(),
    }
}

impl Blocks {
    /// Bytes of the blocks, where all are taken, on a tensor of `shape`.
    pub fn bytes(shape: [u128; 3]) -> u128 {
        let n = if shape[0] == 1 { 16 } else { 64 };
        shape.iter().map(|n| n.div_ceil(2)).product::<u128>() * (n * (n + 1) / 2 * 4)
    }

    /// No block, on a tensor of `shape`, of an operator with the `diagonal`.
    pub fn new(shape: [usize; 3], diagonal: &[f64]) -> Result<Self> {
        let mut scale = try_vec(diagonal.len(), 0.0, "the smoother")?;
        scale.iter_mut().zip(diagonal).for_each(|(s, d)| *s = 1.0 / d.sqrt());
        Ok(Blocks { shape, slabs: Vec::new(), scale, alone: try_vec(diagonal.len(), true, "the smoother")? })
    }

    /// Planes of the operator to hand to [`Blocks::add`], one range after the other, where not all are at hand.
    pub fn windows(shape: [usize; 3]) -> Vec<Range<usize>> {
        let starts = starts(shape[0]);
        starts.chunks(SLABS).map(|chunk| chunk[0]..chunk[chunk.len() - 1] + shape[0].min(EDGE)).collect()
    }

    /// Adds the blocks within the planes of `matrix` that hold a `stiff` control point.
    pub fn add(&mut self, matrix: &Assembled, stiff: &[bool], workers: &Workers) -> Result<()> {
        let planes = matrix.planes();
        for plane in starts(self.shape[0]) {
            if plane < planes.start || plane + self.layers() > planes.end {
                continue;
            }
            let firsts = self.chosen(plane, stiff);
            let factor = |b: usize| self.factor(matrix, &firsts[b * LANES..(b * LANES + LANES).min(firsts.len())]);
            let batches = workers.map(firsts.len().div_ceil(LANES), factor).into_iter().collect::<Result<_>>()?;
            self.slabs.push(Slab { plane, batches });
            self.cover(&firsts);
        }
        if std::env::var("TELL").is_ok() { eprintln!("blocks {} of {}", self.slabs.iter().map(|s| s.batches.iter().map(|b| b.firsts.len()).sum::<usize>()).sum::<usize>(), self.shape.iter().map(|n| n / 2).product::<usize>()); }
        Ok(())
    }

    /// Control points of a block along x.
    fn layers(&self) -> usize {
        self.shape[0].min(EDGE)
    }

    /// First control points of the blocks of the slab that begins at plane `i` that hold a stiff one.
    fn chosen(&self, i: usize, stiff: &[bool]) -> Vec<usize> {
        let [_, ny, nz] = self.shape;
        let begin = |[j, k]: [usize; 2]| (i * ny + j) * nz + k;
        let all = starts(ny).into_iter().flat_map(|j| starts(nz).into_iter().map(move |k| [j, k]));
        all.map(begin).filter(|first| self.members(*first).any(|p| stiff[p])).collect()
    }

    /// Control points of the block that begins at `first`, in the order of its rows.
    #[inline(always)]
    fn members(&self, first: usize) -> impl Iterator<Item = usize> + use<> {
        let [_, ny, nz] = self.shape;
        let lines = (0..self.layers()).flat_map(move |i| (0..EDGE).map(move |j| first + (i * ny + j) * nz));
        lines.flat_map(|line| line..line + EDGE)
    }

    fn cover(&mut self, firsts: &[usize]) {
        for first in firsts {
            for p in self.members(*first) {
                self.alone[p] = false;
            }
        }
    }

    /// Factors the blocks that begin at `firsts`, at most as many as there are lanes.
    fn factor(&self, matrix: &Assembled, firsts: &[usize]) -> Result<Batch> {
        let n = self.layers() * EDGE * EDGE;
        let mut rows = try_vec(n * (n + 1) / 2, [0.0; LANES], "the smoother")?;
        for lane in 0..LANES {
            match firsts.get(lane) {
                Some(first) => self.fill(matrix, *first, &mut rows, lane),
                // The unit matrix.
                None => (0..n).for_each(|p| rows[p * (p + 1) / 2 + p][lane] = 1.0),
            }
        }
        dispatch(Factor { rows: &mut rows, n });
        let mut factor = try_with_capacity(rows.len(), "the smoother")?;
        factor.extend(rows.iter().map(|row| row.map(|x| x as f32)));
        Ok(Batch { firsts: firsts.to_vec(), factor })
    }

    /// Fills one lane with the lower triangle of a block, scaled to a diagonal of 1.
    fn fill(&self, matrix: &Assembled, first: usize, rows: &mut [[f64; LANES]], lane: usize) {
        let [_, ny, nz] = self.shape;
        let (i0, j0, k0) = (first / (ny * nz), first / nz % ny, first % nz);
        let mut scale = [0.0; EDGE * EDGE * EDGE];
        scale.iter_mut().zip(self.members(first)).for_each(|(s, p)| *s = self.scale[p]);
        let lines = self.layers() * EDGE;
        for p in 0..lines {
            for q in 0..=p {
                let [(pi, pj), (qi, qj)] = [p, q].map(|l| (l / EDGE, l % EDGE));
                // Lines in order: along x never backwards, along y perhaps.
                let bands = matrix.bands([i0 + qi, j0 + pj.min(qj)], pi - qi, pj.abs_diff(qj));
                for c in 0..EDGE {
                    let row = p * EDGE + c;
                    let columns = if p == q { c + 1 } else { EDGE };
                    for d in 0..columns {
                        let entry = bands[c.abs_diff(d)][k0 + c.min(d)];
                        rows[row * (row + 1) / 2 + q * EDGE + d][lane] = scale[row] * scale[q * EDGE + d] * entry;
                    }
                }
            }
        }
    }

    /// z = (the inverse) r
    pub fn apply(&self, workers: &Workers, r: &[f64], z: &mut [f64]) {
        let boost: f64 = std::env::var("ALONE").map_or(1.0, |s| s.parse().unwrap());
        let entries = z.iter_mut().zip(r).zip(self.scale.iter().zip(&self.alone));
        entries.for_each(|((z, r), (s, alone))| *z = if *alone { boost * s * s * r } else { 0.0 });
        // Slabs two apart do not meet, but for the last, which may begin anywhere.
        let plane = self.shape[1] * self.shape[2];
        let last = self.shape[0].saturating_sub(EDGE);
        let regular = |slab: &&Slab| slab.plane % STEP == 0;
        for colour in 0..EDGE / STEP {
            let slabs: Vec<&Slab> = self.slabs.iter().filter(regular).filter(|s| s.plane / STEP % (EDGE / STEP) == colour).collect();
            let (mut rest, mut at) = (&mut *z, 0);
            let mut items = Vec::with_capacity(slabs.len());
            for slab in slabs {
                let (_, behind) = rest.split_at_mut((slab.plane - at) * plane);
                let (own, behind) = behind.split_at_mut(self.layers() * plane);
                (rest, at) = (behind, slab.plane + self.layers());
                items.push((slab, own));
            }
            workers.for_each(items, |(slab, z)| self.apply_slab(slab, r, z));
        }
        for slab in self.slabs.iter().filter(|slab| !regular(slab)) {
            self.apply_slab(slab, r, &mut z[last * plane..]);
        }
    }

    /// Adds the inverses of a slab's blocks; `z` begins at its first plane.
    fn apply_slab(&self, slab: &Slab, r: &[f64], z: &mut [f64]) {
        let [_, ny, nz] = self.shape;
        let origin = slab.plane * ny * nz;
        for batch in &slab.batches {
            let mut x = [[0.0f32; LANES]; EDGE * EDGE * EDGE];
            let x = &mut x[..self.layers() * EDGE * EDGE];
            // Lines of four members, with where each begins.
            let line = |first: usize, l: usize| first + (l / EDGE * ny + l % EDGE) * nz;
            for (lane, first) in batch.firsts.iter().enumerate() {
                for (l, x) in x.chunks_exact_mut(EDGE).enumerate() {
                    let p = line(*first, l);
                    let (r, scale) = (&r[p..p + EDGE], &self.scale[p..p + EDGE]);
                    (0..EDGE).for_each(|c| x[c][lane] = (scale[c] * r[c]) as f32);
                }
            }
            dispatch(Solve { factor: &batch.factor, x });
            for (lane, first) in batch.firsts.iter().enumerate() {
                for (l, x) in x.chunks_exact(EDGE).enumerate() {
                    let p = line(*first, l);
                    let (z, scale) = (&mut z[p - origin..][..EDGE], &self.scale[p..p + EDGE]);
                    (0..EDGE).for_each(|c| z[c] += scale[c] * f64::from(x[c][lane]));
                }
            }
        }
    }
}

/// A = L L^T, lane by lane, with the diagonal of L replaced by its reciprocals.
struct Factor<'a> {
    rows: &'a mut [[f64; LANES]],
    n: usize,
}

impl Kernel for Factor<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Factor { rows, n } = self;
        for i in 0..n {
            let (above, row) = rows.split_at_mut(i * (i + 1) / 2);
            for j in 0..i {
                let other = &above[j * (j + 1) / 2..][..j + 1];
                let mut sum = row[j];
                for (a, b) in row[..j].iter().zip(other) {
                    (0..LANES).for_each(|l| sum[l] = I::mul_add(-a[l], b[l], sum[l]));
                }
                (0..LANES).for_each(|l| row[j][l] = sum[l] * other[j][l]);
            }
            let mut pivot = row[i];
            for a in &row[..i] {
                (0..LANES).for_each(|l| pivot[l] = I::mul_add(-a[l], a[l], pivot[l]));
            }
            row[i] = pivot.map(|p| 1.0 / p.max(LEAST_PIVOT).sqrt());
        }
    }
}

/// x becomes the solution of L L^T x = x, lane by lane.
struct Solve<'a> {
    factor: &'a [[f32; LANES]],
    x: &'a mut [[f32; LANES]],
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Solve { factor, x } = self;
        let n = x.len();
        for i in 0..n {
            let row = &factor[i * (i + 1) / 2..][..i + 1];
            let mut sums = [x[i], [0.0; LANES], [0.0; LANES], [0.0; LANES]];
            for (k, (a, x)) in row[..i].iter().zip(&*x).enumerate() {
                (0..LANES).for_each(|l| sums[k % 4][l] = I::mul_add_f32(-a[l], x[l], sums[k % 4][l]));
            }
            (0..LANES).for_each(|l| x[i][l] = ((sums[0][l] + sums[1][l]) + (sums[2][l] + sums[3][l])) * row[i][l]);
        }
        for i in (0..n).rev() {
            let row = &factor[i * (i + 1) / 2..][..i + 1];
            (0..LANES).for_each(|l| x[i][l] *= row[i][l]);
            let own = x[i];
            for (a, x) in row[..i].iter().zip(&mut *x) {
                (0..LANES).for_each(|l| x[l] = I::mul_add_f32(-a[l], own[l], x[l]));
            }
        }
    }
}
