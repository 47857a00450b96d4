//! The regularisation energy, paper 000 (7), integrated exactly: (1/|V|) int ||hess phi||_F^2 dV.
//!
//! With A_k, B_k, C_k the Gram matrices of the k-th derivatives along x, y, z, its matrix is
//!
//! ```text
//! A2 (x) (B0 C0) + A1 (x) 2 (B1 C0 + B0 C1) + A0 (x) (B2 C0 + 2 B1 C1 + B0 C2)
//! ```
//!
//! applied plane by plane along z, then y, then x (in the plane A0 = 1, A1 = A2 = 0): 84 multiplications a control point, where the
//! assembled matrix has 343 entries a row.

use crate::Result;
use crate::error::try_vec;
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use crate::spline::Grid;
use crate::spline::gram::{Band, Gram, HALF_BAND, columns};
use crate::spline::two_scale::coarser_gram;

/// The operator (weight / |V|) int hess . hess on one grid.
pub struct Smoothness {
    /// Control points along x, y, z; the plane has one layer along x.
    shape: [usize; 3],
    gram: [Gram; 3],
    factor: f64,
    /// The matrices along z by distances, lines as long as those of the tensors below: entry (k, k + d - 3) of order o at `[o][d][k]`.
    along_z: [[Vec<f64>; 2 * HALF_BAND + 1]; 3],
    /// Six tensors: the factors along z, and the sums along y and z that go with A2, A1, A0. Their lines end at a multiple of four.
    scratch: [Vec<f64>; 6],
}

impl Smoothness {
    /// The operator on `grid`, in units of D.
    pub fn new<const D: usize>(grid: &Grid<D>, weight: f64) -> Result<Self> {
        let mut gram = std::array::from_fn(|_| Gram::of_no_axis());
        for (a, axis) in grid.axes.iter().enumerate() {
            gram[a + 3 - D] = Gram::new(axis.n_cells, axis.cell)?;
        }
        let volume: f64 = grid.axes.iter().map(|a| a.n_cells as f64 * a.cell).product();
        Smoothness::of(gram, weight / volume)
    }

    fn of(gram: [Gram; 3], factor: f64) -> Result<Self> {
        let shape: [usize; 3] = std::array::from_fn(|a| gram[a].order[0].len());
        let mut along_z: [[Vec<f64>; 2 * HALF_BAND + 1]; 3] = Default::default();
        for (line, (o, d)) in along_z.iter_mut().flatten().zip((0..3).flat_map(|o| (0..7).map(move |d| (o, d)))) {
            *line = try_vec(shape[2].next_multiple_of(4), 0.0, "the Gram matrices")?;
            line.iter_mut().zip(&gram[2].order[o]).for_each(|(to, row)| *to = row[d]);
        }
        Ok(Smoothness { shape, gram, factor, along_z, scratch: Default::default() })
    }

    /// Bytes on a tensor of `shape`, with what [`Smoothness::reserve`] takes.
    pub fn bytes(shape: [u128; 3]) -> u128 {
        let [nx, ny, nz] = shape;
        let line = nz.next_multiple_of(4);
        // Along an axis three bands of 7 numbers a control point; those along z once more.
        8 * (6 * nx * ny * line + 21 * (nx + ny + nz + line))
    }

    /// The operator on the grid with the axes coarsened for which `halved` is true: integrated over the same box.
    pub fn coarser(&self, halved: [bool; 3]) -> Result<Self> {
        let mut gram = self.gram.clone();
        for a in (0..3).filter(|a| halved[*a]) {
            gram[a] = coarser_gram(&self.gram[a])?;
        }
        Smoothness::of(gram, self.factor)
    }

    /// Control points along x, y, z.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// The operator as a sum of tensor products of bands along x, y, z.
    pub fn products(&self) -> Vec<(f64, [&Band; 3])> {
        let [a, b, c] = [0, 1, 2].map(|axis| &self.gram[axis].order);
        let pure = [[&a[2], &b[0], &c[0]], [&a[0], &b[2], &c[0]], [&a[0], &b[0], &c[2]]];
        let mixed = [[&a[1], &b[1], &c[0]], [&a[1], &b[0], &c[1]], [&a[0], &b[1], &c[1]]];
        pure.into_iter().map(|p| (self.factor, p)).chain(mixed.into_iter().map(|p| (2.0 * self.factor, p))).collect()
    }

    /// Multiplies the weight by `factor`.
    pub fn scale(&mut self, factor: f64) {
        self.factor *= factor;
    }

    /// Takes the memory that [`Smoothness::apply`] works in.
    pub fn reserve(&mut self) -> Result<()> {
        let [nx, ny, nz] = self.shape;
        let n = nx * ny * nz.next_multiple_of(4);
        for tensor in self.scratch.iter_mut().filter(|tensor| tensor.len() != n) {
            *tensor = try_vec(n, 0.0, "the work space of the regularisation")?;
        }
        Ok(())
    }

    /// y = (the operator's matrix) x
    pub fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        let [_, ny, nz] = self.shape;
        let plane = ny * nz.next_multiple_of(4);
        let [gx, gy, _] = &self.gram;
        let (along_z, factor) = (&self.along_z, self.factor);
        let [c0, c1, c2, s2, s1, s0] = &mut self.scratch;
        let along_y = s2.chunks_mut(plane).zip(s1.chunks_mut(plane)).zip(s0.chunks_mut(plane));
        let factors = c0.chunks_mut(plane).zip(c1.chunks_mut(plane)).zip(c2.chunks_mut(plane));
        workers.for_each(x.chunks(ny * nz).zip(factors).zip(along_y), |((x, ((c0, c1), c2)), ((s2, s1), s0))| {
            dispatch(AlongZ { bands: along_z, x, nz, to: [c0, c1, c2] });
            dispatch(AlongY { bands: &gy.order, from: [c0, c1, c2], ny, to: [s2, s1, s0] });
        });
        let sums = [&**s2, &**s1, &**s0];
        workers.for_each(y.chunks_mut(ny * nz).enumerate(), |(i, y)| {
            dispatch(AlongX { bands: &gx.order, i, from: sums, plane, factor, nz, y });
        });
    }

    /// y += the diagonal of the operator's matrix.
    pub fn add_diagonal(&self, y: &mut [f64]) {
        let [nx, ny, nz] = self.shape;
        let [a, b, c] = [0, 1, 2].map(|axis| move |k: usize, i: usize| self.gram[axis].order[k][i][HALF_BAND]);
        let mut entries = y.iter_mut();
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    let sum = a(2, i) * b(0, j) * c(0, k)
                        + 2.0 * a(1, i) * (b(1, j) * c(0, k) + b(0, j) * c(1, k))
                        + a(0, i) * (b(2, j) * c(0, k) + 2.0 * b(1, j) * c(1, k) + b(0, j) * c(2, k));
                    *entries.next().expect("one entry a control point") += self.factor * sum;
                }
            }
        }
    }
}

/// Numbers of a Band's row.
const WIDTH: usize = 2 * HALF_BAND + 1;

/// Numbers that four rows of a Band reach.
const REACH: usize = 2 * HALF_BAND + 4;

#[inline(always)]
fn four(x: &[f64], k: usize) -> &[f64; 4] {
    x[k..k + 4].try_into().expect("a slice of four")
}

#[inline(always)]
fn four_mut(x: &mut [f64], k: usize) -> &mut [f64; 4] {
    (&mut x[k..k + 4]).try_into().expect("a slice of four")
}

/// The lines of one plane times the matrices along z, of the three orders.
struct AlongZ<'a> {
    bands: &'a [[Vec<f64>; WIDTH]; 3],
    /// Lines of `nz`.
    x: &'a [f64],
    nz: usize,
    /// Lines that end at a multiple of four.
    to: [&'a mut [f64]; 3],
}

impl Kernel for AlongZ<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AlongZ { bands, x, nz, to } = self;
        let rounded = nz.next_multiple_of(4);
        for (j, x) in x.chunks_exact(nz).enumerate() {
            for k in (0..rounded).step_by(4) {
                // What four products reach, with zeros beyond the ends of the line.
                let mut padded = [0.0; REACH];
                let reached = x.get(k.wrapping_sub(HALF_BAND)..).and_then(|x| x.get(..REACH)).unwrap_or_else(|| {
                    let (first, end) = (HALF_BAND.saturating_sub(k), (nz + HALF_BAND - k).min(REACH));
                    padded[first..end].copy_from_slice(&x[k + first - HALF_BAND..k + end - HALF_BAND]);
                    &padded
                });
                let x: [I::Four; WIDTH] = std::array::from_fn(|d| I::load(four(reached, d)));
                for o in 0..3 {
                    let mut sum = I::splat(0.0);
                    for d in 0..WIDTH {
                        sum = I::mul_add_4(I::load(four(&bands[o][d], k)), x[d], sum);
                    }
                    I::store(sum, four_mut(to[o], j * rounded + k));
                }
            }
        }
    }
}

/// The sums along y that go with A2, A1 and A0, of one plane.
struct AlongY<'a> {
    bands: &'a [Band; 3],
    from: [&'a [f64]; 3],
    ny: usize,
    to: [&'a mut [f64]; 3],
}

impl Kernel for AlongY<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AlongY { bands: [b0, b1, b2], from: [c0, c1, c2], ny, to: [s2, s1, s0] } = self;
        let n = c0.len() / ny;
        for j in 0..ny {
            for k in (0..n).step_by(4) {
                let [mut t2, mut t1, mut t0] = [I::splat(0.0); 3];
                for from in columns(j, ny) {
                    let d = from + HALF_BAND - j;
                    let [v0, v1, v2] = [c0, c1, c2].map(|c| I::load(four(c, from * n + k)));
                    let (w0, w1, w2) = (I::splat(b0[j][d]), I::splat(2.0 * b1[j][d]), I::splat(b2[j][d]));
                    let twice = I::add_4(w0, w0);
                    t2 = I::mul_add_4(w0, v0, t2);
                    t1 = I::mul_add_4(w1, v0, I::mul_add_4(twice, v1, t1));
                    t0 = I::mul_add_4(w2, v0, I::mul_add_4(w1, v1, I::mul_add_4(w0, v2, t0)));
                }
                I::store(t2, four_mut(s2, j * n + k));
                I::store(t1, four_mut(s1, j * n + k));
                I::store(t0, four_mut(s0, j * n + k));
            }
        }
    }
}

/// Plane `i` of the product.
struct AlongX<'a> {
    bands: &'a [Band; 3],
    i: usize,
    /// The sums that go with A2, A1, A0.
    from: [&'a [f64]; 3],
    plane: usize,
    factor: f64,
    nz: usize,
    y: &'a mut [f64],
}

impl Kernel for AlongX<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AlongX { bands: [a0, a1, a2], i, from: [s2, s1, s0], plane, factor, nz, y } = self;
        let rounded = nz.next_multiple_of(4);
        for (j, y) in y.chunks_exact_mut(nz).enumerate() {
            for k in (0..rounded).step_by(4) {
                let mut sum = I::splat(0.0);
                for from in columns(i, a0.len()) {
                    let (d, at) = (from + HALF_BAND - i, from * plane + j * rounded + k);
                    for (s, a) in [(s2, a2), (s1, a1), (s0, a0)] {
                        sum = I::mul_add_4(I::splat(factor * a[i][d]), I::load(four(s, at)), sum);
                    }
                }
                if k + 4 <= nz {
                    I::store(sum, four_mut(y, k));
                } else {
                    let mut last = [0.0; 4];
                    I::store(sum, &mut last);
                    y[k..].copy_from_slice(&last[..nz - k]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::Axis;

    fn grid(cells: [usize; 3], edge: [f64; 3]) -> Grid {
        Grid { axes: [0, 1, 2].map(|a| Axis { lower: 0.0, cell: edge[a], n_cells: cells[a] }) }
    }

    fn energy(grid: &Grid, c: &[f64]) -> f64 {
        let mut operator = Smoothness::new(grid, 1.0).unwrap();
        operator.reserve().unwrap();
        let mut y = vec![0.0; c.len()];
        operator.apply(&Workers::caller_only(), c, &mut y);
        y.iter().zip(c).map(|(y, c)| y * c).sum()
    }

    /// Control points of f(x) = sum_k over axes, from those of x and x^2 along one axis: xi is reproduced by i - 1, xi^2 by (i - 1)^2 -
    /// 1/3.
    fn tensor(grid: &Grid, f: impl Fn([[f64; 2]; 3]) -> f64) -> Vec<f64> {
        let [nx, ny, nz] = grid.shape();
        let along = |a: usize, i: usize| {
            let (t, h) = (i as f64 - 1.0, grid.axes[a].cell);
            [t * h, (t * t - 1.0 / 3.0) * h * h]
        };
        let mut c = Vec::new();
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    c.push(f([along(0, i), along(1, j), along(2, k)]));
                }
            }
        }
        c
    }

    #[test]
    fn quadratics_have_their_known_energy_and_planes_none() {
        for cells in [[1, 1, 1], [2, 3, 1], [5, 4, 7]] {
            let grid = grid(cells, [0.5, 0.25, 0.125]);
            // ||hess||_F^2 is constant: 4 + 4 + 4 for the squares, 2 for each mixed product.
            let quadratic = tensor(&grid, |[x, y, z]| x[1] + y[1] + z[1]);
            let mixed = tensor(&grid, |[x, y, z]| 3.0 * x[0] * y[0] + x[0] * z[0] + y[0] * z[0]);
            let plane = tensor(&grid, |[x, y, z]| 1.0 + x[0] - 2.0 * y[0] + 3.0 * z[0]);
            assert!((energy(&grid, &quadratic) - 12.0).abs() < 1e-9);
            assert!((energy(&grid, &mixed) - 2.0 * (9.0 + 1.0 + 1.0)).abs() < 1e-9);
            assert!(energy(&grid, &plane).abs() < 1e-9);
        }
    }

    #[test]
    fn the_diagonal_is_the_matrix_at_unit_vectors() {
        let grid = grid([2, 1, 3], [0.3, 0.5, 0.2]);
        let n = grid.n_control();
        let mut operator = Smoothness::new(&grid, 0.7).unwrap();
        operator.reserve().unwrap();
        let mut diagonal = vec![0.0; n];
        operator.add_diagonal(&mut diagonal);
        for i in 0..n {
            let (mut e, mut y) = (vec![0.0; n], vec![0.0; n]);
            e[i] = 1.0;
            operator.apply(&Workers::caller_only(), &e, &mut y);
            assert!((y[i] - diagonal[i]).abs() <= 1e-12 * diagonal[i]);
        }
    }
}
