//! An approximate inverse of a symmetric operator: the sum of the exact inverses on small overlapping blocks of control points (additive
//! Schwarz; Smith, Bjorstad and Gropp 1996, chapter 1).
//!
//! Where data are stiff beside smoothness, combinations of neighbours that the data hardly see have far less energy than any one control
//! point. The diagonal takes them for stiff, and no coarse grid can express them; a block of 4^D control points, every second one along
//! each axis, has them whole.
//!
//! Blocks with stiff control points have factors of their own, and are factored and solved eight side by side, one a lane, so that every
//! instruction serves all. The others hold what is the same everywhere, and share a factor with all blocks that lie likewise towards the
//! ends of the axes. Factors are kept in single precision: rounding leaves them positive, and their square is near the operator's wherever
//! its condition is below 1e12.

use super::assembled::Assembled;
use super::gram::{Band, HALF_BAND};
use super::place_of;
use crate::Result;
use crate::error::{try_reserve_exact, try_vec, try_with_capacity};
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
    shared: Vec<SharedFactor>,
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
    factor: BatchFactor,
}

impl Batch {
    /// The place of one that is to be made.
    fn none() -> Self {
        Batch { firsts: Vec::new(), factor: BatchFactor::Own(Vec::new()) }
    }
}

/// L of the blocks with a diagonal of 1: rows of the lower triangle, with the reciprocals of its diagonal.
enum BatchFactor {
    Own(Vec<[f32; LANES]>),
    /// Index of the one that they share.
    Shared(usize),
}

/// The factor of blocks that lie alike.
struct SharedFactor {
    class: Class,
    rows: Vec<f32>,
    /// 1 / sqrt(diagonal) of the block.
    scale: Vec<f64>,
}

/// How a block lies: control points from its first to either end of each axis, as far as ends are felt, and which of the operators it has.
type Class = ([[usize; 2]; 3], usize);

/// Where blocks begin along an axis of `n` control points.
fn starts(n: usize) -> Vec<usize> {
    match n {
        1 => vec![0],
        _ => (0..n - EDGE).step_by(STEP).chain([n - EDGE]).collect(),
    }
}

/// A sum of tensor products of bands along x, y, z: what an operator is away from stiff control points.
pub type Products<'a> = Vec<(f64, [&'a Band; 3])>;

/// Which blocks have factors of their own, and what the others are.
pub struct Kinds<'a> {
    /// Control points of which the blocks have factors of their own `[n]`.
    pub own: &'a [bool],
    /// Control points of which the other blocks have the second of the operators `[n]`.
    pub second: &'a [bool],
    /// The operators of the other blocks.
    pub operators: [Products<'a>; 2],
}

impl Blocks {
    /// Planes that are assembled at a time, where not all are, at most.
    pub const WINDOW: u128 = (SLABS * STEP + EDGE) as u128;

    /// Bytes of the blocks on a tensor of `shape`, with the factors of their own that `n_points` points can ask for.
    pub fn bytes(shape: [u128; 3], n_points: u128) -> u128 {
        let [edge, step, lanes] = [EDGE, STEP, LANES].map(|n| n as u128);
        let n_starts = |n: u128| if n == 1 { 1 } else { (n - edge).div_ceil(step) + 1 };
        let blocks = shape.iter().map(|n| n_starts(*n)).product::<u128>();
        let n = if shape[0] == 1 { edge.pow(2) } else { edge.pow(3) };
        // A point's cell has functions of as many blocks as a block has control points. Lanes stay empty at the end of a slab.
        let own = blocks.min(n * n_points) + n_starts(shape[0]) * lanes;
        // Along an axis a block lies in one of five ways, and it has one of two operators.
        let shared = blocks.min(2 * 5u128.pow(3));
        let triangle = n * (n + 1) / 2 * size_of::<f32>() as u128;
        own * triangle + shared * (triangle + 16 * n) + blocks * 32 + shape.iter().product::<u128>() * 8
    }

    /// No block, on a tensor of `shape`, of an operator with the `diagonal`.
    pub fn new(shape: [usize; 3], diagonal: &[f64]) -> Result<Self> {
        let mut scale = try_vec(diagonal.len(), 0.0, "the smoother")?;
        scale.iter_mut().zip(diagonal).for_each(|(s, d)| *s = 1.0 / d.sqrt());
        Ok(Blocks { shape, slabs: Vec::new(), scale, shared: Vec::new() })
    }

    /// Planes of the operator to hand to [`Blocks::add`], one range after the other, where not all are at hand.
    pub fn windows(shape: [usize; 3]) -> Vec<Range<usize>> {
        let starts = starts(shape[0]);
        starts.chunks(SLABS).map(|chunk| chunk[0]..chunk[chunk.len() - 1] + shape[0].min(EDGE)).collect()
    }

    /// Adds the blocks within the planes of `matrix` that are not there yet.
    pub fn add(&mut self, matrix: &Assembled, kinds: &Kinds, workers: &Workers) -> Result<()> {
        let planes = matrix.planes();
        let done = self.slabs.last().map_or(0, |slab| slab.plane + 1);
        for plane in starts(self.shape[0]) {
            if plane < done.max(planes.start) || plane + self.layers() > planes.end {
                continue;
            }
            let is_own = |f: &usize| self.members(*f).any(|p| kinds.own[p]);
            let n_own = self.firsts(plane).filter(is_own).count();
            let mut own = try_with_capacity(n_own, "the blocks of the smoother")?;
            own.extend(self.firsts(plane).filter(is_own));
            let mut others = try_with_capacity(self.firsts(plane).count() - n_own, "the blocks of the smoother")?;
            others.extend(self.firsts(plane).filter(|f| !is_own(f)));

            let mut batches = try_with_capacity(n_own.div_ceil(LANES), "the smoother")?;
            batches.resize_with(n_own.div_ceil(LANES), Batch::none);
            workers.try_for_each(batches.iter_mut().zip(own.chunks(LANES)), |(batch, firsts)| {
                *batch = self.factor(matrix, firsts)?;
                Ok(())
            })?;
            self.share(&others, kinds, &mut batches)?;
            self.slabs.push(Slab { plane, batches });
        }
        Ok(())
    }

    /// Adds the batches of the blocks that begin at `firsts` and share factors.
    fn share(&mut self, firsts: &[usize], kinds: &Kinds, batches: &mut Vec<Batch>) -> Result<()> {
        // Factors in the order in which they are met: there are few.
        let mut met: Vec<usize> = Vec::new();
        let mut sorted = try_with_capacity(firsts.len(), "the blocks of the smoother")?;
        for first in firsts {
            let index = self.shared_by(*first, kinds)?;
            let rank = met.iter().position(|i| *i == index).unwrap_or_else(|| {
                met.push(index);
                met.len() - 1
            });
            sorted.push((rank, *first));
        }
        sorted.sort_unstable();
        try_reserve_exact(batches, firsts.len() / LANES + met.len(), "the smoother")?;
        for alike in sorted.chunk_by(|a, b| a.0 == b.0) {
            for eight in alike.chunks(LANES) {
                let firsts = eight.iter().map(|(_, first)| *first).collect();
                batches.push(Batch { firsts, factor: BatchFactor::Shared(met[eight[0].0]) });
            }
        }
        Ok(())
    }

    /// The index of the factor that the block that begins at `first` shares, made where it is the first.
    fn shared_by(&mut self, first: usize, kinds: &Kinds) -> Result<usize> {
        // A function feels an end that its support reaches.
        const FELT: usize = 3;
        let start = self.place(first);
        let which = usize::from(self.members(first).any(|p| kinds.second[p]));
        let ends = |a: usize| match self.shape[a] {
            1 => [0, 0],
            n => [start[a].min(FELT), (n - EDGE - start[a]).min(FELT)],
        };
        let class = ([ends(0), ends(1), ends(2)], which);
        if let Some(index) = self.shared.iter().position(|s| s.class == class) {
            return Ok(index);
        }
        let n = self.layers() * EDGE * EDGE;
        let mut rows = try_vec(n * (n + 1) / 2, [0.0; LANES], "the smoother")?;
        let local = |m: usize| place_of(m, [EDGE; 3]);
        let entry = |p: usize, q: usize| {
            let (p, q) = (local(p), local(q));
            let at = |band: &Band, a: usize| band[start[a] + p[a]][HALF_BAND + q[a] - p[a]];
            kinds.operators[which].iter().map(|(f, [x, y, z])| f * at(x, 0) * at(y, 1) * at(z, 2)).sum::<f64>()
        };
        let scale: Vec<f64> = (0..n).map(|p| 1.0 / entry(p, p).sqrt()).collect();
        for p in 0..n {
            (0..=p).for_each(|q| rows[p * (p + 1) / 2 + q][0] = scale[p] * scale[q] * entry(p, q));
            (1..LANES).for_each(|lane| rows[p * (p + 1) / 2 + p][lane] = 1.0);
        }
        dispatch(Factor { rows: &mut rows, n });
        self.shared.push(SharedFactor { class, rows: rows.iter().map(|row| row[0] as f32).collect(), scale });
        Ok(self.shared.len() - 1)
    }

    fn place(&self, p: usize) -> [usize; 3] {
        place_of(p, self.shape)
    }

    /// Control points of a block along x.
    fn layers(&self) -> usize {
        self.shape[0].min(EDGE)
    }

    /// First control points of the blocks that begin at plane `i`.
    fn firsts(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        let [_, ny, nz] = self.shape;
        let all = starts(ny).into_iter().flat_map(move |j| starts(nz).into_iter().map(move |k| [j, k]));
        all.map(move |[j, k]| (i * ny + j) * nz + k)
    }

    /// Control points of the block that begins at `first`, in the order of its rows.
    #[inline(always)]
    fn members(&self, first: usize) -> impl Iterator<Item = usize> + use<> {
        let [_, ny, nz] = self.shape;
        let lines = (0..self.layers()).flat_map(move |i| (0..EDGE).map(move |j| first + (i * ny + j) * nz));
        lines.flat_map(|line| line..line + EDGE)
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
        Ok(Batch { firsts: firsts.to_vec(), factor: BatchFactor::Own(factor) })
    }

    /// Fills one lane with the lower triangle of a block, scaled to a diagonal of 1.
    fn fill(&self, matrix: &Assembled, first: usize, rows: &mut [[f64; LANES]], lane: usize) {
        let [i0, j0, k0] = self.place(first);
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
        z.fill(0.0);
        // Slabs two apart do not meet, but for the last, which may begin anywhere.
        let plane = self.shape[1] * self.shape[2];
        let last = self.shape[0].saturating_sub(EDGE);
        let regular = |slab: &&Slab| slab.plane.is_multiple_of(STEP);
        for colour in 0..EDGE / STEP {
            let slabs: Vec<&Slab> =
                self.slabs.iter().filter(regular).filter(|s| s.plane / STEP % (EDGE / STEP) == colour).collect();
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
            let shared = match &batch.factor {
                BatchFactor::Own(_) => None,
                BatchFactor::Shared(index) => Some(&self.shared[*index]),
            };
            // Lines of four members: where each begins, and its scale.
            let line = |first: usize, l: usize| {
                let p = first + (l / EDGE * ny + l % EDGE) * nz;
                (p, shared.map_or(&self.scale[p..p + EDGE], |s| &s.scale[l * EDGE..][..EDGE]))
            };
            for (lane, first) in batch.firsts.iter().enumerate() {
                for (l, x) in x.chunks_exact_mut(EDGE).enumerate() {
                    let (p, scale) = line(*first, l);
                    let r = &r[p..p + EDGE];
                    (0..EDGE).for_each(|c| x[c][lane] = (scale[c] * r[c]) as f32);
                }
            }
            match (&batch.factor, shared) {
                (BatchFactor::Own(factor), _) => dispatch(Solve { factor: &factor[..], x }),
                (_, Some(shared)) => dispatch(Solve { factor: &shared.rows[..], x }),
                (BatchFactor::Shared(_), None) => unreachable!("a shared factor was looked up"),
            }
            for (lane, first) in batch.firsts.iter().enumerate() {
                for (l, x) in x.chunks_exact(EDGE).enumerate() {
                    let (p, scale) = line(*first, l);
                    let z = &mut z[p - origin..][..EDGE];
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
                let sum = less_products::<I>(&row[j], &row[..j], other);
                (0..LANES).for_each(|l| row[j][l] = sum[l] * other[j][l]);
            }
            let pivot = less_products::<I>(&row[i], &row[..i], &row[..i]);
            row[i] = pivot.map(|p| 1.0 / p.max(LEAST_PIVOT).sqrt());
        }
    }
}

/// c - the sum of products of a and b, lane by lane.
#[inline(always)]
fn less_products<I: Isa>(c: &[f64; LANES], a: &[[f64; LANES]], b: &[[f64; LANES]]) -> [f64; LANES] {
    let halves = |x: &[f64; LANES]| [0, 4].map(|h| I::load(x[h..h + 4].try_into().expect("half of the lanes")));
    // Sums of even and of odd ones, so that no product waits for the one before.
    let mut sums = [[I::splat(0.0); 2]; 2];
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        let ([a0, a1], [b0, b1]) = (halves(a), halves(b));
        let [s0, s1] = sums[k % 2];
        sums[k % 2] = [I::mul_add_4(a0, b0, s0), I::mul_add_4(a1, b1, s1)];
    }
    let mut less = [0.0; LANES];
    for (h, c) in halves(c).into_iter().enumerate() {
        let rest = I::sub_4(c, I::add_4(sums[0][h], sums[1][h]));
        I::store(rest, (&mut less[4 * h..4 * h + 4]).try_into().expect("half of the lanes"));
    }
    less
}

/// Entries of factors, one for all lanes or one a lane.
trait Entry: Copy {
    fn lanes<I: Isa>(&self) -> I::Eight;
}

impl Entry for f32 {
    #[inline(always)]
    fn lanes<I: Isa>(&self) -> I::Eight {
        I::splat_8(*self)
    }
}

impl Entry for [f32; LANES] {
    #[inline(always)]
    fn lanes<I: Isa>(&self) -> I::Eight {
        I::load_8(self)
    }
}

/// x becomes the solution of L L^T x = x, lane by lane.
struct Solve<'a, E> {
    factor: &'a [E],
    x: &'a mut [[f32; LANES]],
}

impl<E: Entry> Kernel for Solve<'_, E> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let Solve { factor, x } = self;
        let n = x.len();
        for i in 0..n {
            let row = &factor[i * (i + 1) / 2..][..i + 1];
            // Four sums, so that no product waits for the one before.
            let zero = I::splat_8(0.0);
            let mut sums = [I::load_8(&x[i]), zero, zero, zero];
            let (rows, others) = (row[..i].chunks_exact(4), x[..i].chunks_exact(4));
            for (a, x) in rows.remainder().iter().zip(others.remainder()) {
                sums[0] = I::mul_sub_8(a.lanes::<I>(), I::load_8(x), sums[0]);
            }
            for (a, x) in rows.zip(others) {
                for k in 0..4 {
                    sums[k] = I::mul_sub_8(a[k].lanes::<I>(), I::load_8(&x[k]), sums[k]);
                }
            }
            let sum = I::add_8(I::add_8(sums[0], sums[1]), I::add_8(sums[2], sums[3]));
            I::store_8(I::mul_8(sum, row[i].lanes::<I>()), &mut x[i]);
        }
        for i in (0..n).rev() {
            let row = &factor[i * (i + 1) / 2..][..i + 1];
            let own = I::mul_8(I::load_8(&x[i]), row[i].lanes::<I>());
            I::store_8(own, &mut x[i]);
            for (a, x) in row[..i].iter().zip(&mut *x) {
                I::store_8(I::mul_sub_8(a.lanes::<I>(), own, I::load_8(x)), x);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::linalg::dense::Cholesky;
    use crate::spline::gram::Gram;

    /// The squares of values and first derivatives, on cells of edge 1; the plane where there are no cells along x.
    struct Squares([Gram; 3]);

    impl Squares {
        fn new(cells: [usize; 3]) -> Self {
            Squares(cells.map(|n| if n == 0 { Gram::of_no_axis() } else { Gram::new(n, 1.0).unwrap() }))
        }

        fn shape(&self) -> [usize; 3] {
            std::array::from_fn(|a| self.0[a].order[0].len())
        }

        fn products(&self) -> Products<'_> {
            let [x, y, z] = [0, 1, 2].map(|a| &self.0[a].order);
            vec![(1.0, [&x[0], &y[0], &z[0]]), (0.5, [&x[0], &y[1], &z[0]]), (0.25, [&x[0], &y[0], &z[1]])]
        }

        fn assembled(&self, planes: Range<usize>) -> Assembled {
            let mut a = Assembled::new(self.shape(), planes).unwrap();
            a.add_bands(&Workers::caller_only(), &self.products());
            a
        }

        /// Blocks that are the assembled operator's where they have factors of their own or hold a control point that is `second`, and
        /// twice that elsewhere.
        fn blocks(&self, own: bool, second: &[bool], workers: &Workers) -> Blocks {
            let (shape, n) = (self.shape(), second.len());
            let mut blocks = Blocks::new(shape, &self.assembled(0..shape[0]).diagonal().unwrap()).unwrap();
            let twice = self.products().into_iter().map(|(factor, bands)| (2.0 * factor, bands)).collect();
            let kinds = Kinds { own: &vec![own; n], second, operators: [twice, self.products()] };
            for planes in Blocks::windows(shape) {
                blocks.add(&self.assembled(planes), &kinds, workers).unwrap();
            }
            blocks
        }
    }

    fn numbers(n: usize, seed: u64) -> Vec<f64> {
        let mut random = SplitMix64::new(seed);
        (0..n).map(|_| random.between(-1.0, 1.0)).collect()
    }

    #[test]
    fn the_inverse_is_the_sum_of_those_of_the_blocks_with_factors_of_their_own_or_shared() {
        for cells in [[0, 1, 1], [0, 5, 8], [1, 1, 1], [2, 3, 4], [22, 1, 2]] {
            let squares = Squares::new(cells);
            let shape = squares.shape();
            let a = squares.assembled(0..shape[0]);
            let r = numbers(shape.iter().product(), 1);
            // Of all tensors but the smallest some blocks hold such points, and some do not.
            let second: Vec<bool> = (0..r.len()).map(|p| p % 97 == 7).collect();
            // With factors of their own, or shared.
            let mut expected = [vec![0.0; r.len()], vec![0.0; r.len()]];
            let edge = shape.map(|n| n.min(EDGE));
            for (i, j, k) in starts(shape[0])
                .into_iter()
                .flat_map(|i| starts(shape[1]).into_iter().map(move |j| (i, j)))
                .flat_map(|(i, j)| starts(shape[2]).into_iter().map(move |k| (i, j, k)))
            {
                let n = edge.iter().product();
                let member = |m: usize| [i + m / (edge[1] * edge[2]), j + m / edge[2] % edge[1], k + m % edge[2]];
                let index = |p: [usize; 3]| (p[0] * shape[1] + p[1]) * shape[2] + p[2];
                let lower = (0..n).flat_map(|p| (0..=p).map(move |q| (p, q)));
                let rows = lower.map(|(p, q)| a.entry(member(p), member(q))).collect();
                let mut b: Vec<f64> = (0..n).map(|m| r[index(member(m))]).collect();
                Cholesky::new(n, rows, 0.0).solve(&mut b);
                let shared = if (0..n).any(|m| second[index(member(m))]) { 1.0 } else { 0.5 };
                for m in 0..n {
                    expected[0][index(member(m))] += b[m];
                    expected[1][index(member(m))] += shared * b[m];
                }
            }
            for (own, n_threads) in [(true, 1), (true, 2), (false, 1), (false, 2)] {
                let expected = &expected[usize::from(!own)];
                let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                let workers = Workers::new(n_threads).unwrap();
                let mut z = vec![f64::NAN; r.len()];
                squares.blocks(own, &second, &workers).apply(&workers, &r, &mut z);
                // The condition of a block of such squares is some 1e4, its factor's the root of that.
                let worst = z.iter().zip(expected).fold(0.0, |m: f64, (z, e)| m.max((z - e).abs()));
                assert!(worst < 1e-3 * size, "{cells:?} own {own}: {worst:e} of {size:e}");
            }
        }
    }

    #[test]
    fn instruction_sets_agree_to_rounding() {
        let n = 64;
        let mut random = SplitMix64::new(3);
        let mut rows: Vec<[f64; LANES]> =
            (0..n * (n + 1) / 2).map(|_| std::array::from_fn(|_| 0.01 * random.unit())).collect();
        (0..n).for_each(|p| rows[p * (p + 1) / 2 + p] = [1.0; LANES]);
        let mut portable = rows.clone();
        dispatch(Factor { rows: &mut rows, n });
        Factor { rows: &mut portable, n }.run::<crate::isa::Portable>();
        let close = |a: &f64, b: &f64| (a - b).abs() < 1e-13;
        assert!(rows.iter().flatten().zip(portable.iter().flatten()).all(|(a, b)| close(a, b)));
        let factor: Vec<[f32; LANES]> = rows.iter().map(|row| row.map(|x| x as f32)).collect();
        let mut x: Vec<[f32; LANES]> = (0..n).map(|_| std::array::from_fn(|_| random.unit() as f32)).collect();
        let mut y = x.clone();
        dispatch(Solve { factor: &factor, x: &mut x });
        Solve { factor: &factor, x: &mut y }.run::<crate::isa::Portable>();
        assert!(x.iter().flatten().zip(y.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-5));
    }
}
