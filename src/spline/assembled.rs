//! A symmetric operator on a tensor of control points, entry by entry, for energies that are sums of tensor products.
//!
//! In such an energy an entry of functions (i, j, k) and (i', j', k') stays the same when i and i' alone change places, and so along each
//! axis. Entries are kept for i <= i', j <= j', k <= k' only: 4^D a control point, where a row of the matrix has 7^D.
//!
//! Taken where points are many beside control points, and for some planes at a time to cut blocks out of.

use super::gram::{Band, HALF_BAND};
use crate::Result;
use crate::error::try_vec;
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use std::ops::Range;

/// Functions of a cell along an axis, and so the distances between two of them.
const WIDTH: usize = HALF_BAND + 1;

/// Products of the four functions of a cell along an axis: those of a and a + d at `[d][a]`, 0 where there is no a + d.
pub type Products = [[f64; 4]; 4];

/// The products of the numbers `f` of four functions.
#[inline(always)]
pub fn products(f: &[f64; 4]) -> Products {
    let mut products = [[0.0; 4]; 4];
    for d in 0..4 {
        for a in 0..4 - d {
            products[d][a] = f[a] * f[a + d];
        }
    }
    products
}

/// Products of values and of derivatives along one axis.
#[derive(Debug, Clone, Copy)]
pub struct AxisProducts {
    /// Of values.
    pub value: Products,
    /// Of derivatives.
    pub slope: Products,
}

impl AxisProducts {
    /// Of an axis that the plane lacks: one function, 1.
    pub fn of_no_axis() -> Self {
        AxisProducts { value: products(&[1.0, 0.0, 0.0, 0.0]), slope: [[0.0; 4]; 4] }
    }
}

/// The operator, or some planes of it.
pub struct Assembled {
    /// Control points along x, y, z; the plane has one along x.
    shape: [usize; 3],
    /// Planes along x, each with the entries towards those behind.
    planes: Range<usize>,
    /// [plane][y][distance along x][along y][along z][z, with a rim]; in the plane without that along x.
    entries: Vec<f64>,
    /// The vector to be multiplied and the product, their lines with rims.
    padded: [Vec<f64>; 2],
}

/// Numbers of a line of `n` with its rim: zeros, as many as two functions are apart, so that products need not look where a line ends.
fn with_rim(n: usize) -> usize {
    (n + HALF_BAND).next_multiple_of(4)
}

impl Assembled {
    /// Bytes of `n_planes` planes on a tensor of `shape`.
    pub fn bytes(shape: [u128; 3], n_planes: u128) -> u128 {
        let along_x = if shape[0] == 1 { 1 } else { WIDTH as u128 };
        // With the vector to be multiplied and the product.
        n_planes * shape[1] * (shape[2] + 6) * (along_x * (WIDTH * WIDTH) as u128 + 2) * size_of::<f64>() as u128
    }

    /// 0, on the `planes` of a tensor of `shape`.
    pub fn new(shape: [usize; 3], planes: Range<usize>) -> Result<Self> {
        let mut a = Assembled { shape, planes, entries: Vec::new(), padded: [Vec::new(), Vec::new()] };
        a.entries = try_vec(a.planes.len() * a.plane(), 0.0, "the operator of a coarse grid")?;
        if a.planes == (0..shape[0]) {
            // A rim before the first line, too.
            let n = shape[0] * shape[1] * with_rim(shape[2]);
            a.padded = [
                try_vec(n + 8, 0.0, "the operator of a coarse grid")?,
                try_vec(n, 0.0, "the operator of a coarse grid")?,
            ];
        }
        Ok(a)
    }

    /// The planes that are kept.
    pub fn planes(&self) -> Range<usize> {
        self.planes.clone()
    }

    /// Distances along x that have entries.
    fn along_x(&self) -> usize {
        if self.shape[0] == 1 { 1 } else { WIDTH }
    }

    /// Entries of a line along z, for all distances.
    fn line(&self) -> usize {
        self.along_x() * WIDTH * WIDTH * with_rim(self.shape[2])
    }

    fn plane(&self) -> usize {
        self.shape[1] * self.line()
    }

    /// Layers of cells that the planes have entries of.
    fn layers(&self) -> Range<usize> {
        if self.shape[0] == 1 {
            0..1
        } else {
            self.planes.start.saturating_sub(3)..self.planes.end.min(self.shape[0] - 3)
        }
    }

    /// Calls `add(layer, sums)` for each layer of cells along x.
    pub fn add_layers(&mut self, workers: &Workers, add: impl Fn(usize, &mut LayerSums) + Send + Sync) {
        // Layers four apart do not meet; those before the planes begin with fewer of them.
        let (plane, layers, first) = (self.plane(), self.layers(), self.planes.start);
        let (shape, line, along_x) = (self.shape, self.line(), self.along_x());
        for colour in 0..layers.len().min(4) {
            let mut rest = &mut self.entries[..];
            let mut at = first;
            let mut items = Vec::new();
            for layer in layers.clone().skip(colour).step_by(4) {
                let begin = layer.max(first);
                let end = (layer + along_x).min(self.planes.end);
                let (_, behind) = rest.split_at_mut((begin - at) * plane);
                let (rows, behind) = behind.split_at_mut((end - begin) * plane);
                (rest, at) = (behind, end);
                items.push((layer, LayerSums { rows, skipped: begin - layer, along_x, line, nz: with_rim(shape[2]) }));
            }
            workers.for_each(items, |(layer, mut sums)| add(layer, &mut sums));
        }
    }

    /// Adds a sum of tensor products of bands along x, y, z, each with its factor.
    pub fn add_bands(&mut self, workers: &Workers, terms: &[(f64, [&Band; 3])]) {
        let (nz, along_x, first) = (with_rim(self.shape[2]), self.along_x(), self.planes.start);
        let (line, plane) = (self.line(), self.plane());
        workers.for_each(self.entries.chunks_mut(plane).enumerate(), |(i, rows)| {
            for (j, row) in rows.chunks_mut(line).enumerate() {
                for (star, sums) in row.chunks_mut(WIDTH * nz).enumerate() {
                    let (dx, dy) = if along_x == 1 { (0, star) } else { (star / WIDTH, star % WIDTH) };
                    for (factor, [a, b, c]) in terms {
                        let ab = factor * a[first + i][HALF_BAND + dx] * b[j][HALF_BAND + dy];
                        for (d, sums) in sums.chunks_mut(nz).enumerate() {
                            sums.iter_mut().zip(c.iter()).for_each(|(s, c)| *s += ab * c[HALF_BAND + d]);
                        }
                    }
                }
            }
        });
    }

    /// The entry of `p` and `q`, of which the planes are among those kept.
    #[inline]
    pub fn entry(&self, p: [usize; 3], q: [usize; 3]) -> f64 {
        let [x, y, z] = std::array::from_fn(|a| (p[a].min(q[a]), p[a].abs_diff(q[a])));
        if x.1.max(y.1).max(z.1) > HALF_BAND {
            return 0.0;
        }
        let line = ((x.0 - self.planes.start) * self.shape[1] + y.0) * self.line();
        self.entries[line + ((x.1 * WIDTH + y.1) * WIDTH + z.1) * with_rim(self.shape[2]) + z.0]
    }

    /// The entries of line (i, j) along z and that `dx` and `dy` behind it, those of z and z + d at `[d][z]`.
    #[inline(always)]
    pub fn bands(&self, [i, j]: [usize; 2], dx: usize, dy: usize) -> [&[f64]; WIDTH] {
        let rimmed = with_rim(self.shape[2]);
        let line = ((i - self.planes.start) * self.shape[1] + j) * self.line() + (dx * WIDTH + dy) * WIDTH * rimmed;
        std::array::from_fn(|d| &self.entries[line + d * rimmed..][..rimmed])
    }

    /// The diagonal of the planes.
    pub fn diagonal(&self) -> Result<Vec<f64>> {
        let nz = self.shape[2];
        let mut d = try_vec(self.planes.len() * self.shape[1] * nz, 0.0, "the diagonal")?;
        d.chunks_mut(nz).zip(self.entries.chunks(self.line())).for_each(|(d, line)| d.copy_from_slice(&line[..nz]));
        Ok(d)
    }

    /// The lower triangle as a dense matrix, row after row.
    pub fn lower_triangle(&self) -> Result<Vec<f64>> {
        let [nx, ny, nz] = self.shape;
        let n = nx * ny * nz;
        let mut rows = try_vec(n * (n + 1) / 2, 0.0, "the coarsest grid")?;
        let place = |p: usize| [p / (ny * nz), p / nz % ny, p % nz];
        for p in 0..n {
            let row = &mut rows[p * (p + 1) / 2..][..p + 1];
            row.iter_mut().enumerate().for_each(|(q, a)| *a = self.entry(place(p), place(q)));
        }
        Ok(rows)
    }

    /// y = A x, for an operator of which all planes are kept.
    pub fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        debug_assert_eq!(self.planes, 0..self.shape[0]);
        let [nx, ny, nz] = self.shape;
        let rimmed = with_rim(nz);
        let (line, plane) = (self.line(), ny * rimmed);
        let [padded, sums] = &mut self.padded;
        padded[4..].chunks_exact_mut(rimmed).zip(x.chunks_exact(nz)).for_each(|(to, x)| to[..nz].copy_from_slice(x));
        sums.fill(0.0);
        // Entries are read once, and serve all that they couple: a slab's planes and the three behind. Every other slab at a time.
        for parity in 0..2 {
            let Some(rest) = sums.get_mut(parity * SLAB * plane..) else { break };
            let slabs = (parity * SLAB..nx).step_by(2 * SLAB).zip(rest.chunks_mut(2 * SLAB * plane));
            workers.for_each(slabs, |(i, y)| {
                let entries = &self.entries[i * ny * line..((i + SLAB).min(nx)) * ny * line];
                dispatch(SlabProduct { entries, shape: self.shape, x: &padded[i * plane..], y });
            });
        }
        y.chunks_exact_mut(nz).zip(sums.chunks_exact(rimmed)).for_each(|(y, sums)| y.copy_from_slice(&sums[..nz]));
    }
}

/// Planes whose products one thread takes on: at least three.
const SLAB: usize = 4;

/// The entries that the cells of one layer add to.
pub struct LayerSums<'a> {
    /// Planes of the layer's functions, from the first that is kept on.
    rows: &'a mut [f64],
    /// Planes before that.
    skipped: usize,
    along_x: usize,
    line: usize,
    nz: usize,
}

impl LayerSums<'_> {
    /// Adds value v_x v_y v_z + pull (s_x v_y v_z + v_x s_y v_z + v_x v_y s_z), v the products of values and s those of slopes, at the cell
    /// (j, k) of the layer; `ny` control points lie along y.
    #[inline(always)]
    pub fn add<I: Isa>(&mut self, ny: usize, [j, k]: [usize; 2], products: &[AxisProducts; 3], value: f64, pull: f64) {
        let [x, y, z] = products;
        let n_rows = self.rows.len() / (ny * self.line);
        for row in 0..n_rows {
            let a = row + self.skipped;
            for dx in 0..self.along_x - if self.along_x == 1 { 0 } else { a } {
                let (vx, sx) = (x.value[dx][a], x.slope[dx][a]);
                let (plain, with_slope) = (I::mul_add(pull, sx, value * vx), pull * vx);
                for b in 0..4 {
                    let line = &mut self.rows[(row * ny + j + b) * self.line..][..self.line];
                    for dy in 0..4 - b {
                        let (vy, sy) = (y.value[dy][b], y.slope[dy][b]);
                        let (vz, sz) = (I::mul_add(plain, vy, with_slope * sy), with_slope * vy);
                        let star = &mut line[(dx * WIDTH + dy) * WIDTH * self.nz..][..WIDTH * self.nz];
                        for (d, sums) in star.chunks_exact_mut(self.nz).enumerate() {
                            let sums: &mut [f64; 4] = (&mut sums[k..k + 4]).try_into().expect("a slice of four");
                            let with_slope = I::mul_add_4(I::splat(sz), I::load(&z.slope[d]), I::load(sums));
                            I::store(I::mul_add_4(I::splat(vz), I::load(&z.value[d]), with_slope), sums);
                        }
                    }
                }
            }
        }
    }
}

/// What the entries of some planes add to y = A x.
struct SlabProduct<'a> {
    entries: &'a [f64],
    shape: [usize; 3],
    /// Lines with rims, after one rim, from the first of the planes on.
    x: &'a [f64],
    y: &'a mut [f64],
}

impl Kernel for SlabProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let SlabProduct { entries, shape: [nx, ny, nz], x, y } = self;
        let n = with_rim(nz);
        let along_x = if nx == 1 { 1 } else { WIDTH };
        let planes = y.len() / (ny * n);
        for (at, line) in entries.chunks_exact(along_x * WIDTH * WIDTH * n).enumerate() {
            let (i, j) = (at / ny, at % ny);
            for (star, bands) in line.chunks_exact(WIDTH * n).enumerate() {
                let (dx, dy) = (star / WIDTH, star % WIDTH);
                if i + dx >= planes || j + dy >= ny {
                    continue;
                }
                // The lines that the entries couple, two by two.
                let (own, far) = ((i * ny + j) * n, ((i + dx) * ny + j + dy) * n);
                let (side_x, side_y) = ((i * ny + j + dy) * n, ((i + dx) * ny + j) * n);
                if star == 0 {
                    add_band_product::<I, 1>(bands, x, y, [own], [own], n);
                } else if dx == 0 || dy == 0 {
                    add_band_product::<I, 2>(bands, x, y, [own, far], [far, own], n);
                } else {
                    add_band_product::<I, 4>(bands, x, y, [own, far, side_x, side_y], [far, own, side_y, side_x], n);
                }
            }
        }
    }
}

/// The lines of y at `to` += the symmetric band of which entry (k, k + d) is at `bands[d * n + k]`, times the lines of x at `from`.
#[inline(always)]
fn add_band_product<I: Isa, const N: usize>(
    bands: &[f64],
    x: &[f64],
    y: &mut [f64],
    to: [usize; N],
    from: [usize; N],
    n: usize,
) {
    // Entries towards functions before start within the rim of the distance before. All slices are as long as a line.
    let [a0, a1, a2, a3] = std::array::from_fn(|d| &bands[d * n..][..n]);
    let [b1, b2, b3] = std::array::from_fn(|d| &bands[(d + 1) * n - (d + 1)..][..n]);
    let x: [[&[f64]; 7]; N] = from.map(|from| std::array::from_fn(|d| &x[from + 4 + d - HALF_BAND..][..n]));
    // Four at a time: n is a multiple.
    let four = |x: &[f64], k: usize| I::load(x[k..k + 4].try_into().expect("a slice of four"));
    for k in (0..n).step_by(4) {
        let (a0, a1, a2, a3) = (four(a0, k), four(a1, k), four(a2, k), four(a3, k));
        let (b1, b2, b3) = (four(b1, k), four(b2, k), four(b3, k));
        for (x, to) in x.iter().zip(to) {
            let y: &mut [f64; 4] = (&mut y[to + k..to + k + 4]).try_into().expect("a slice of four");
            let mut up = I::mul_4(a3, four(x[6], k));
            let mut down = I::mul_add_4(b3, four(x[0], k), I::load(y));
            for (a, d) in [(a2, 5), (a1, 4), (a0, 3)] {
                up = I::mul_add_4(a, four(x[d], k), up);
            }
            for (b, d) in [(b2, 1), (b1, 2)] {
                down = I::mul_add_4(b, four(x[d], k), down);
            }
            I::store(I::add_4(up, down), y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::spline::gram::Gram;

    /// A cell, and values and slopes of its functions along each axis.
    type Place = ([usize; 3], [[[f64; 4]; 2]; 3]);

    /// The full matrix by its definition: bands, and points with their products.
    #[test]
    fn entries_and_products_are_those_of_the_sums_that_were_added() {
        let mut random = SplitMix64::new(5);
        for (cells, workers) in [([0, 1, 2], 1), ([0, 5, 4], 2), ([1, 1, 1], 1), ([5, 3, 2], 2), ([9, 2, 6], 2)] {
            let workers = Workers::new(workers).unwrap();
            let gram = cells.map(|n| if n == 0 { Gram::of_no_axis() } else { Gram::new(n, 0.7).unwrap() });
            let shape: [usize; 3] = std::array::from_fn(|a| gram[a].order[0].len());
            let points: Vec<Place> = (0..40)
                .map(|_| {
                    let cell = cells.map(|n| if n < 2 { 0 } else { (random.unit() * n as f64) as usize });
                    let axis = |a: usize, random: &mut SplitMix64| match cells[a] {
                        0 => [[1.0, 0.0, 0.0, 0.0], [0.0; 4]],
                        _ => [0, 1].map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))),
                    };
                    (cell, std::array::from_fn(|a| axis(a, &mut random)))
                })
                .collect();
            let term = [&gram[0].order[0], &gram[1].order[1], &gram[2].order[2]];
            let term = if cells[0] == 0 { term } else { [&gram[0].order[2], term[1], term[2]] };
            let assemble = |planes: Range<usize>| {
                let mut a = Assembled::new(shape, planes).unwrap();
                a.add_bands(&workers, &[(0.3, term)]);
                a.add_layers(&workers, |layer, sums| {
                    for (cell, f) in points.iter().filter(|(cell, _)| cell[0] == layer) {
                        let axes = f.map(|[v, s]| AxisProducts { value: products(&v), slope: products(&s) });
                        sums.add::<crate::isa::Portable>(shape[1], [cell[1], cell[2]], &axes, 0.5, 0.25);
                    }
                });
                a
            };
            let mut all = assemble(0..shape[0]);
            let n: usize = shape.iter().product();
            let place = |p: usize| [p / (shape[1] * shape[2]), p / shape[2] % shape[1], p % shape[2]];
            let expected = |p: [usize; 3], q: [usize; 3]| {
                let band = |a: usize| if p[a].abs_diff(q[a]) > 3 { 0.0 } else { term[a][p[a]][q[a] + 3 - p[a]] };
                let mut sum = 0.3 * band(0) * band(1) * band(2);
                for (cell, f) in &points {
                    let of = |a: usize, order: usize| {
                        let at =
                            |p: usize| p.checked_sub(cell[a]).and_then(|p| f[a][order].get(p)).copied().unwrap_or(0.0);
                        at(p[a]) * at(q[a])
                    };
                    sum += 0.5 * of(0, 0) * of(1, 0) * of(2, 0);
                    sum += 0.25
                        * (of(0, 1) * of(1, 0) * of(2, 0)
                            + of(0, 0) * of(1, 1) * of(2, 0)
                            + of(0, 0) * of(1, 0) * of(2, 1));
                }
                sum
            };
            let x: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
            let (mut y, diagonal, lower) = (vec![0.0; n], all.diagonal().unwrap(), all.lower_triangle().unwrap());
            all.apply(&workers, &x, &mut y);
            let some = assemble(shape[0] / 2..shape[0]);
            for p in 0..n {
                let row: Vec<f64> = (0..n).map(|q| expected(place(p), place(q))).collect();
                let size = row.iter().map(|a| a.abs()).sum::<f64>();
                assert!(
                    (y[p] - row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>()).abs() < 1e-13 * size,
                    "row {p} of {shape:?}"
                );
                assert!((diagonal[p] - row[p]).abs() < 1e-13 * size);
                for q in 0..=p {
                    assert!((lower[p * (p + 1) / 2 + q] - row[q]).abs() < 1e-13 * size);
                    if place(q)[0] >= shape[0] / 2 {
                        assert!((some.entry(place(p), place(q)) - row[q]).abs() < 1e-13 * size);
                    }
                }
            }
        }
    }
}
