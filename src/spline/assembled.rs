//! A symmetric operator on a tensor of control points, entry by entry: 7^D a row, those of functions that share a cell.
//!
//! For grids so coarse that many points lie in a cell; on a fine one the entries would be most of the memory. Rows are stored four at a
//! time along the last axis, so that a product runs over one stream of vectors.

use super::gram::{Band, HALF_BAND};
use crate::Result;
use crate::error::try_vec;
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;

/// Functions that one shares a cell with along an axis, itself included.
const WIDTH: usize = 2 * HALF_BAND + 1;

/// Pairs of functions of a cell along one axis, in any order.
const PAIRS: usize = 10;

/// Place of the pair of functions p and q of a cell.
const PAIR: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 4, 5, 6], [2, 5, 7, 8], [3, 6, 8, 9]];

/// Products of the functions of a cell, pair by pair, padded to whole vectors.
pub type PairVector = [f64; 12];

/// The sums of a cell's form: entry (p, q) of functions p = (p_x, p_y, p_z) and q at the pairs of each axis [10 x 10 x 12]; in the plane
/// the first axis has one pair.
pub type CellForm = Vec<f64>;

/// Products f_p g_p... of four functions' numbers with themselves, pair by pair.
#[inline(always)]
pub fn pairs(f: &[f64; 4]) -> PairVector {
    let mut v = [0.0; 12];
    let mut at = 0;
    for p in 0..4 {
        for q in p..4 {
            v[at] = f[p] * f[q];
            at += 1;
        }
    }
    v
}

type Four = [f64; 4];

/// The operator.
pub struct Assembled {
    /// Control points along x, y, z; the plane has one along x.
    shape: [usize; 3],
    /// [lines along z][blocks of four][entries along x and y][entries along z]
    entries: Vec<Four>,
    /// The vector with a rim of zeros.
    padded: Vec<f64>,
}

impl Assembled {
    /// Bytes of an operator on a tensor of `shape`.
    pub fn bytes(shape: [u128; 3]) -> u128 {
        let along_x = if shape[0] == 1 { 1 } else { WIDTH as u128 };
        shape[0] * shape[1] * shape[2].div_ceil(4) * along_x * (WIDTH * WIDTH * size_of::<Four>()) as u128
    }

    /// 0 on a tensor of `shape`.
    pub fn new(shape: [usize; 3]) -> Result<Self> {
        let mut a = Assembled { shape, entries: Vec::new(), padded: Vec::new() };
        let n = shape[0] * shape[1] * a.blocks() * a.stars() * WIDTH;
        a.entries = try_vec(n, [0.0; 4], "the operator of a coarse grid")?;
        let [px, py, pz] = a.padded_shape();
        a.padded = try_vec(px * py * pz, 0.0, "the operator of a coarse grid")?;
        Ok(a)
    }

    /// Entries along x and y.
    fn stars(&self) -> usize {
        if self.shape[0] == 1 { WIDTH } else { WIDTH * WIDTH }
    }

    /// Blocks of four along z.
    fn blocks(&self) -> usize {
        self.shape[2].div_ceil(4)
    }

    fn padded_shape(&self) -> [usize; 3] {
        let along_x = if self.shape[0] == 1 { 1 } else { self.shape[0] + 2 * HALF_BAND };
        [along_x, self.shape[1] + 2 * HALF_BAND, 4 * self.blocks() + 2 * HALF_BAND]
    }

    /// Entries of a plane of rows.
    fn plane(&self) -> usize {
        self.shape[1] * self.blocks() * self.stars() * WIDTH
    }

    /// Adds the form of the cell of which the first control point is `first`; `planes` are its rows, from the plane `from` on.
    fn add_cell(&self, planes: &mut [Four], from: usize, first: [usize; 3], form: &[f64]) {
        let (blocks, stars) = (self.blocks(), self.stars());
        let layers = if self.shape[0] == 1 { 1 } else { 4 };
        for px in 0..layers {
            for py in 0..4 {
                let line = ((first[0] + px - from) * self.shape[1] + first[1] + py) * blocks;
                for qx in 0..layers {
                    for qy in 0..4 {
                        let star = if layers == 1 { 0 } else { (qx + HALF_BAND - px) * WIDTH } + qy + HALF_BAND - py;
                        let along_z = &form[(PAIR[px][qx] * PAIRS + PAIR[py][qy]) * 12..][..12];
                        for pz in 0..4 {
                            let k = first[2] + pz;
                            let row = ((line + k / 4) * stars + star) * WIDTH + HALF_BAND - pz;
                            for qz in 0..4 {
                                planes[row + qz][k % 4] += along_z[PAIR[pz][qz]];
                            }
                        }
                    }
                }
            }
        }
    }

    /// Adds forms of cells, layer by layer along x. `layer(i, forms)` fills the forms of the cells of layer i, `[y * z]`, and marks
    /// those that it touched.
    pub fn add_cells(
        &mut self,
        workers: &Workers,
        layer: impl Fn(usize, &mut LayerForms) + Send + Sync,
    ) -> Result<()> {
        // Rows of four layers apart do not meet.
        const COLOURS: usize = 4;
        let plane = self.plane();
        let flat = self.shape[0] == 1;
        let n_layers = if flat { 1 } else { self.shape[0] - 3 };
        let [ny, nz] = [self.shape[1] - 3, self.shape[2] - 3];
        let mut entries = std::mem::take(&mut self.entries);
        for colour in 0..COLOURS.min(n_layers) {
            let rows = entries[colour * plane..].chunks_mut(COLOURS * plane);
            workers.for_each((colour..n_layers).step_by(COLOURS).zip(rows), |(i, rows)| {
                let mut forms = LayerForms { index: vec![usize::MAX; ny * nz], forms: Vec::new(), pairs_x: if flat { 1 } else { PAIRS } };
                layer(i, &mut forms);
                for (cell, &form) in forms.index.iter().enumerate().filter(|(_, form)| **form != usize::MAX) {
                    let size = forms.size();
                    self.add_cell(rows, i, [i, cell / nz, cell % nz], &forms.forms[form * size..][..size]);
                }
            });
        }
        self.entries = entries;
        Ok(())
    }

    /// Adds factor * sum of the tensor products of bands along x, y, z.
    pub fn add_products(&mut self, workers: &Workers, factor: f64, terms: &[[&Band; 3]]) {
        let ([nx, ny, nz], blocks, stars) = (self.shape, self.blocks(), self.stars());
        let plane = self.plane();
        workers.for_each(self.entries.chunks_mut(plane).enumerate(), |(i, rows)| {
            for (j, line) in rows.chunks_mut(blocks * stars * WIDTH).enumerate().take(ny) {
                for star in 0..stars {
                    let (dx, dy) = if nx == 1 { (HALF_BAND, star) } else { (star / WIDTH, star % WIDTH) };
                    for [a, b, c] in terms {
                        let ab = factor * a[i][dx] * b[j][dy];
                        for k in 0..nz {
                            let row = &mut line[(k / 4 * stars + star) * WIDTH..][..WIDTH];
                            (0..WIDTH).for_each(|d| row[d][k % 4] += ab * c[k][d]);
                        }
                    }
                }
            }
        });
    }

    /// The diagonal.
    pub fn diagonal(&self) -> Result<Vec<f64>> {
        let mut d = try_vec(self.shape.iter().product(), 0.0, "the diagonal")?;
        let (blocks, stars) = (self.blocks(), self.stars());
        let nz = self.shape[2];
        for (line, d) in d.chunks_mut(nz).enumerate() {
            for (k, d) in d.iter_mut().enumerate() {
                *d = self.entries[((line * blocks + k / 4) * stars + stars / 2) * WIDTH + HALF_BAND][k % 4];
            }
        }
        Ok(d)
    }

    /// The lower triangle as a dense matrix, row after row.
    pub fn lower_triangle(&self) -> Result<Vec<f64>> {
        let ([nx, ny, nz], blocks, stars) = (self.shape, self.blocks(), self.stars());
        let n = nx * ny * nz;
        let mut rows = try_vec(n * (n + 1) / 2, 0.0, "the coarsest grid")?;
        let at = |i: usize, d: usize, n: usize| (i + d).checked_sub(HALF_BAND).filter(|x| *x < n);
        for p in 0..n {
            let (line, k) = (p / nz, p % nz);
            for star in 0..stars {
                let (dx, dy) = if nx == 1 { (HALF_BAND, star) } else { (star / WIDTH, star % WIDTH) };
                let (Some(i), Some(j)) = (at(line / ny, dx, nx), at(line % ny, dy, ny)) else { continue };
                for d in 0..WIDTH {
                    let Some(q) = at(k, d, nz).map(|k| (i * ny + j) * nz + k).filter(|q| *q <= p) else { continue };
                    rows[p * (p + 1) / 2 + q] = self.entries[((line * blocks + k / 4) * stars + star) * WIDTH + d][k % 4];
                }
            }
        }
        Ok(rows)
    }

    /// y = A x
    pub fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        let [nx, ny, nz] = self.shape;
        let [_, py, pz] = self.padded_shape();
        let rim = if nx == 1 { 0 } else { HALF_BAND };
        for (line, x) in x.chunks(nz).enumerate() {
            let (i, j) = (line / ny + rim, line % ny + HALF_BAND);
            self.padded[(i * py + j) * pz + HALF_BAND..][..nz].copy_from_slice(x);
        }
        let (plane, blocks, stars) = (self.plane(), self.blocks(), self.stars());
        let padded = &self.padded;
        workers.for_each(y.chunks_mut(ny * nz).zip(self.entries.chunks(plane)).enumerate(), |(i, (y, rows))| {
            dispatch(PlaneProduct { padded: &padded[i * py * pz..], rows, y, py, pz, nz, blocks, stars });
        });
    }
}

/// The forms of the cells of one layer.
pub struct LayerForms {
    /// Place of a cell's form, or none.
    index: Vec<usize>,
    forms: Vec<f64>,
    pairs_x: usize,
}

impl LayerForms {
    fn size(&self) -> usize {
        self.pairs_x * PAIRS * 12
    }

    /// The form of cell `c`.
    #[inline]
    pub fn of(&mut self, c: usize) -> &mut [f64] {
        let size = self.size();
        if self.index[c] == usize::MAX {
            self.index[c] = self.forms.len() / size;
            self.forms.resize(self.forms.len() + size, 0.0);
        }
        &mut self.forms[self.index[c] * size..][..size]
    }
}

/// form += sum over pairs of `x` y z, with y and z weighted once plainly and once by gradient: see the data terms.
#[inline(always)]
pub fn add_products_of_pairs<I: Isa>(form: &mut [f64], x: &[[f64; 2]], y: &[PairVector; 2], z: &[PairVector; 2], m: [f64; 4]) {
    // sum = (m0 x0 + m1 x1) y0 z0 + m2 x0 y1 z0 + m3 x0 y0 z1
    for (x, plane) in x.iter().zip(form.chunks_exact_mut(PAIRS * 12)) {
        let first = I::mul_add(m[0], x[0], m[1] * x[1]);
        let (second, third) = (m[2] * x[0], m[3] * x[0]);
        for (p, row) in plane.chunks_exact_mut(12).enumerate() {
            let with_z0 = I::mul_add(first, y[0][p], second * y[1][p]);
            let with_z1 = third * y[0][p];
            for (k, r) in row.iter_mut().enumerate() {
                *r = I::mul_add(with_z0, z[0][k], I::mul_add(with_z1, z[1][k], *r));
            }
        }
    }
}

/// One plane of y = A x.
struct PlaneProduct<'a> {
    /// From the first plane that the rows reach on.
    padded: &'a [f64],
    rows: &'a [Four],
    y: &'a mut [f64],
    py: usize,
    pz: usize,
    nz: usize,
    blocks: usize,
    stars: usize,
}

impl Kernel for PlaneProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let PlaneProduct { padded, rows, y, py, pz, nz, blocks, stars } = self;
        let mut rows = rows.chunks_exact(WIDTH);
        for (j, y) in y.chunks_mut(nz).enumerate() {
            for (b, y) in y.chunks_mut(4).enumerate().take(blocks) {
                let mut sums = [[0.0; 4]; 2];
                for star in 0..stars {
                    let (dx, dy) = (star / WIDTH, star % WIDTH);
                    let x = &padded[(dx * py + j + dy) * pz + 4 * b..][..4 + WIDTH - 1];
                    let row = rows.next().expect("a row of entries for each star");
                    for d in 0..WIDTH {
                        let sum = &mut sums[d % 2];
                        for k in 0..4 {
                            sum[k] = I::mul_add(row[d][k], x[d + k], sum[k]);
                        }
                    }
                }
                for (k, y) in y.iter_mut().enumerate() {
                    *y = sums[0][k] + sums[1][k];
                }
            }
        }
    }
}
