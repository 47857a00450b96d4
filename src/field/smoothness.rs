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
    /// Six tensors: the factors along z, and the sums along y and z that go with A2, A1, A0.
    scratch: [Vec<f64>; 6],
}

impl Smoothness {
    /// The operator on `grid`, in units of D.
    pub fn new<const D: usize>(grid: &Grid<D>, weight: f64) -> Result<Self> {
        let (mut shape, mut gram) = ([1; 3], std::array::from_fn(|_| Gram::of_no_axis()));
        for (a, axis) in grid.axes.iter().enumerate() {
            shape[a + 3 - D] = axis.n_control();
            gram[a + 3 - D] = Gram::new(axis.n_cells, axis.cell)?;
        }
        let volume: f64 = grid.axes.iter().map(|a| a.n_cells as f64 * a.cell).product();
        Ok(Smoothness { shape, gram, factor: weight / volume, scratch: Default::default() })
    }

    /// The operator on the grid with the axes coarsened for which `halved` is true: integrated over the same box.
    pub fn coarser(&self, halved: [bool; 3]) -> Result<Self> {
        let mut coarse =
            Smoothness { shape: self.shape, gram: self.gram.clone(), factor: self.factor, scratch: Default::default() };
        for a in (0..3).filter(|a| halved[*a]) {
            coarse.gram[a] = coarser_gram(&self.gram[a])?;
            coarse.shape[a] = coarse.gram[a].order[0].len();
        }
        Ok(coarse)
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
        let n: usize = self.shape.iter().product();
        for tensor in self.scratch.iter_mut().filter(|tensor| tensor.len() != n) {
            *tensor = try_vec(n, 0.0, "the work space of the regularisation")?;
        }
        Ok(())
    }

    /// y = (the operator's matrix) x
    pub fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        let [_, ny, nz] = self.shape;
        let plane = ny * nz;
        let [gx, gy, gz] = &self.gram;
        let [c0, c1, c2, s2, s1, s0] = &mut self.scratch;
        let along_z = c0.chunks_mut(plane).zip(c1.chunks_mut(plane)).zip(c2.chunks_mut(plane));
        let along_y = s2.chunks_mut(plane).zip(s1.chunks_mut(plane)).zip(s0.chunks_mut(plane));
        workers.for_each(x.chunks(plane).zip(along_z).zip(along_y), |((x, ((c0, c1), c2)), ((s2, s1), s0))| {
            for (x, ((c0, c1), c2)) in x.chunks(nz).zip(c0.chunks_mut(nz).zip(c1.chunks_mut(nz)).zip(c2.chunks_mut(nz)))
            {
                band_line(&gz.order, x, [c0, c1, c2]);
            }
            [&mut *s2, &mut *s1, &mut *s0].into_iter().for_each(|s| s.fill(0.0));
            for j in 0..ny {
                let row = j * nz..(j + 1) * nz;
                band_rows(&gy.order[0], j, 1.0, c0, &mut s2[row.clone()]);
                band_rows(&gy.order[1], j, 2.0, c0, &mut s1[row.clone()]);
                band_rows(&gy.order[0], j, 2.0, c1, &mut s1[row.clone()]);
                band_rows(&gy.order[2], j, 1.0, c0, &mut s0[row.clone()]);
                band_rows(&gy.order[1], j, 2.0, c1, &mut s0[row.clone()]);
                band_rows(&gy.order[0], j, 1.0, c2, &mut s0[row]);
            }
        });
        workers.for_each(y.chunks_mut(plane).enumerate(), |(i, y)| {
            y.fill(0.0);
            band_rows(&gx.order[2], i, self.factor, s2, y);
            band_rows(&gx.order[1], i, self.factor, s1, y);
            band_rows(&gx.order[0], i, self.factor, s0, y);
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

/// to_k = band_k from for the three orders k, along contiguous numbers.
fn band_line(bands: &[Band; 3], from: &[f64], to: [&mut [f64]; 3]) {
    let n = from.len();
    for (band, to) in bands.iter().zip(to) {
        for (i, to) in to.iter_mut().enumerate() {
            let columns = columns(i, n);
            let entries = &band[i][columns.start + HALF_BAND - i..];
            *to = from[columns].iter().zip(entries).map(|(x, a)| a * x).sum();
        }
    }
}

/// to += factor * (row `i` of the band) from, with rows of `from` as long as `to`.
fn band_rows(band: &Band, i: usize, factor: f64, from: &[f64], to: &mut [f64]) {
    let m = to.len();
    for j in columns(i, band.len()) {
        let a = factor * band[i][j + HALF_BAND - i];
        to.iter_mut().zip(&from[j * m..][..m]).for_each(|(t, f)| *t += a * f);
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
