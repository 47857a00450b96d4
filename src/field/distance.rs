//! The distance energy away from the surface, paper 000 (9): what keeps the sign right where no data is near.
//!
//! The Hessian energy alone goes on linearly from the data. Beyond a sharp edge of a thin part, where the true distance has a kink, it
//! may so pass through zero again. The paper leaves (9) out because it found phi to overfit and oscillate with it. Near the surface
//! distances taken from a cloud disagree with the data terms, so the term is kept to cells farther than an edge from the surface, and its
//! weight is tied to that of the smoothness:
//!
//! ```text
//! lambda_d = w lambda_r / h^4,   E_d = (1 / number of cells) sum over far cells of s (phi(x) - d(x))^2
//! ```
//!
//! x a cell's centre, h the longest cell edge. phi then follows d over lengths above h / w^(1/4) and rounds its kinks below. d is the
//! distance to the nearest point of the cloud, with the sign of t - 2 W, W the winding number of its surfels, and s = (t - 2 W)^2, at
//! most 1, fades the term out where an open shape has no clear side. t is 2 W_s, W_s the mean of W on both sides of the surface nearby:
//! see [`sides`](crate::geometry::sides). It is 1 where the normals point out of a solid: W is 1 inside and 0 outside; -1 around a cavity,
//! where they point inwards and W is -1 inside and 0 outside; 0 beside a flat sheet, where W is 1/2 behind and -1/2 before it. So d is
//! positive where the normals point to.

use super::distance_sampler::{DistanceSampler, Hint};
use super::held::{Held, HeldCell, Hold};
use crate::Result;
use crate::error::try_vec;
use crate::geometry::Cloud;
use crate::geometry::vec::{norm, sub};
use crate::isa::{Isa, Kernel, dispatch};
use crate::par::Workers;
use crate::spline::Grid;
use crate::spline::assembled::{Assembled, AxisProducts, LayerSums, products};
use crate::spline::basis::Weights;
use crate::spline::centers::{Centers, Taps};
use crate::spline::gram::{Band, band_of_places};

/// Distance from the surface, in cells, from which on the term counts.
const NEAREST: f64 = 1.0;

/// s from which on a cell's side counts as clear: |t - 2 W| is a half.
pub(super) const CLEAR: f64 = 0.25;

/// Distances to hold far from the surface, a cell each.
pub struct FarDistances {
    /// s / number of cells, 0 for near cells [cells]
    share: Vec<f64>,
    /// d, in units of D [cells]
    distance: Vec<f64>,
    /// The number of the nearest point [cells]
    nearest: Vec<u32>,
    /// The part of the far cells whose side is clear; 1 where there is none.
    clear: f64,
}

impl FarDistances {
    /// The part of the far cells on whose side of the cloud there is little doubt: 1 for closed shapes.
    pub fn clear(&self) -> f64 {
        self.clear
    }

    /// The distances to `cloud`, positive where its normals point to, at the centres of the cells of `grid`; both in units of D.
    /// `tell` is told the fraction done, and may stop.
    pub fn new<const D: usize>(
        cloud: Cloud<D>,
        grid: &Grid<D>,
        workers: &Workers,
        mut tell: impl FnMut(f64) -> Result<()>,
    ) -> Result<Self> {
        const CHUNK: usize = 1024;
        const ROUND: usize = 32;
        tell(0.0)?;
        let n = grid.n_cells().iter().product();
        let sampler = DistanceSampler::new(cloud, workers)?;
        let near = NEAREST * grid.longest_cell();
        let (mut distance, mut share) = (try_vec(n, 0.0, "far distances")?, try_vec(n, 0.0, "far distances")?);
        let mut nearest = try_vec(n, 0, "far distances")?;
        let of_cells = distance.chunks_mut(CHUNK).zip(share.chunks_mut(CHUNK)).zip(nearest.chunks_mut(CHUNK));
        let mut chunks = of_cells.enumerate();
        // Some chunks at a time, so that the caller hears of them.
        for done in (0..n).step_by(ROUND * CHUNK) {
            tell(done as f64 / n as f64)?;
            workers.for_each(chunks.by_ref().take(ROUND), |(chunk, ((distance, share), nearest))| {
                let mut hint = Hint::default();
                for (i, ((d, s), nearest)) in (chunk * CHUNK..).zip(distance.iter_mut().zip(share).zip(nearest)) {
                    let (x, place);
                    x = center(grid, i);
                    (*d, place) = sampler.nearest(x, &mut hint);
                    if *d > near {
                        *nearest = sampler.number(place);
                        (*d, *s) = sampler.side(x, *d, &mut hint);
                        *s /= n as f64;
                    }
                }
            });
        }
        let (mut n_far, mut n_clear) = (0u64, 0u64);
        for (_, s) in distance.iter().zip(&share).filter(|(d, _)| d.abs() > near) {
            n_far += 1;
            n_clear += u64::from(s * n as f64 >= CLEAR);
        }
        let clear = if n_far == 0 { 1.0 } else { n_clear as f64 / n_far as f64 };
        Ok(FarDistances { share, distance, nearest, clear })
    }

    /// The distances of the cells `held` from the points that were nearest, `place` of their numbers; all in units of D.
    pub(super) fn kept<const D: usize>(held: &Held, grid: &Grid<D>, place: impl Fn(u32) -> [f64; D]) -> Result<Self> {
        let n = grid.n_cells().iter().product();
        let room = || try_vec(n, 0.0, "far distances");
        let mut far = FarDistances { share: room()?, distance: room()?, nearest: Vec::new(), clear: held.clear() };
        for HeldCell { cell, point, side } in held.cells() {
            let c = *cell as usize;
            far.share[c] = side.abs() / n as f64;
            far.distance[c] = norm(sub(place(*point), center(grid, c))).copysign(*side);
        }
        Ok(far)
    }

    /// The cells in which they are held, of points that have these `numbers` in the cloud.
    pub(super) fn held(&self, numbers: &[u32]) -> Result<Option<Held>> {
        let n = self.share.len() as f64;
        let cells = self.share.iter().zip(&self.distance).zip(&self.nearest).enumerate();
        let far = cells.filter(|(_, ((share, _), _))| **share > 0.0);
        let held = far.map(|(c, ((share, d), i))| (c, numbers[*i as usize], (share * n).copysign(*d)));
        Held::new(held, self.clear)
    }
}

/// The centre of cell `c`.
fn center<const D: usize>(grid: &Grid<D>, mut c: usize) -> [f64; D] {
    let mut x = [0.0; D];
    for (x, axis) in x.iter_mut().zip(&grid.axes).rev() {
        *x = axis.lower + ((c % axis.n_cells) as f64 + 0.5) * axis.cell;
        c /= axis.n_cells;
    }
    x
}

/// The term on one grid: sum of mass (phi - d)^2 over the centres of cells.
pub struct DistanceTerm<const D: usize = 3> {
    centers: Centers<D>,
    /// lambda_d share [cells]
    mass: Vec<f64>,
    /// d, in units of D [cells]
    distance: Vec<f64>,
    values: Vec<f64>,
}

impl<const D: usize> DistanceTerm<D> {
    /// The term with weight `lambda_d` on `grid`.
    pub fn new(far: FarDistances, grid: &Grid<D>, lambda_d: f64) -> Result<Self> {
        let FarDistances { share: mut mass, distance, .. } = far;
        mass.iter_mut().for_each(|m| *m *= lambda_d);
        let values = try_vec(mass.len(), 0.0, "the far values")?;
        Ok(DistanceTerm { centers: Centers::new(grid)?, mass, distance, values })
    }

    /// The cells `held`, as the term has them; `grid` is the finest.
    pub(super) fn holds(&self, held: &Held, grid: &Grid<D>) -> impl Iterator<Item = Hold<D>> + Clone {
        held.cells().iter().map(|HeldCell { cell, point, side }| {
            let c = *cell as usize;
            Hold { middle: center(grid, c), mass: self.mass[c].copysign(*side), point: *point }
        })
    }

    /// The part of the term that makes its matrix, on `grid`, coarser than this one's by twice along the axes for which `halved` is true:
    /// the masses of cells, in the middle of those of the level between.
    pub fn coarser(&self, grid: &Grid<D>) -> Result<Self> {
        // Places of a coarse grid are the cells of the finer one: masses are first gathered in these.
        let (from, to) = (self.centers.shape(), self.centers.cells());
        let mut mass = try_vec(to.iter().product(), 0.0, "the far masses")?;
        for (mut i, m) in self.mass.iter().enumerate() {
            let (mut at, mut stride) = (0, 1);
            for a in (0..D).rev() {
                at += self.centers.place(a, i % from[a]).0 * stride;
                (i, stride) = (i / from[a], stride * to[a]);
            }
            mass[at] += m;
        }
        let centers = Centers::of_finer(grid, to)?;
        let values = try_vec(mass.len(), 0.0, "the far values")?;
        Ok(DistanceTerm { centers, mass, distance: Vec::new(), values })
    }

    /// The largest mass, and the matrices along each axis of which the tensor product times it would be the term's, had all places that
    /// mass.
    pub fn uniform(&self) -> Result<(f64, [Band; D])> {
        let n = self.centers.shape();
        let band = |a: usize| {
            let place = |i: usize| self.centers.place(a, i);
            band_of_places(self.centers.cells()[a] + 3, (0..n[a]).map(place).map(|(cell, u)| (cell, Weights::at(u).w)))
        };
        let mut bands: [Band; D] = std::array::from_fn(|_| Vec::new());
        for (a, to) in bands.iter_mut().enumerate() {
            *to = band(a)?;
        }
        Ok((self.mass.iter().fold(0.0, |m: f64, x| m.max(*x)), bands))
    }

    /// Adds the term's matrix.
    pub fn add_to(&self, workers: &Workers, matrix: &mut Assembled) {
        matrix.add_layers(workers, |layer, sums| dispatch(AddLayer { term: self, layer, sums }));
    }

    /// y += (the term's matrix) x
    pub fn apply(&mut self, workers: &Workers, x: &[f64], y: &mut [f64]) {
        self.centers.gather(workers, &Taps::values(), x, &mut self.values);
        self.values.iter_mut().zip(&self.mass).for_each(|(v, m)| *v *= m);
        self.centers.scatter(workers, &Taps::values(), &self.values, y);
    }

    /// y += the right-hand side that asks for `sign` d.
    pub fn add_right_hand_side(&mut self, workers: &Workers, sign: f64, y: &mut [f64]) {
        for ((v, m), d) in self.values.iter_mut().zip(&self.mass).zip(&self.distance) {
            *v = m * sign * d;
        }
        self.centers.scatter(workers, &Taps::values(), &self.values, y);
    }

    /// y += the diagonal of the term's matrix.
    pub fn add_diagonal(&mut self, workers: &Workers, y: &mut [f64]) {
        self.centers.scatter(workers, &Taps::squares(), &self.mass, y);
    }
}

/// The matrix of the places in one layer of cells.
struct AddLayer<'a, 'b, const D: usize> {
    term: &'a DistanceTerm<D>,
    layer: usize,
    sums: &'a mut LayerSums<'b>,
}

impl<const D: usize> Kernel for AddLayer<'_, '_, D> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        let AddLayer { term: DistanceTerm { centers, mass, .. }, layer, sums } = self;
        let (n, ny) = (centers.shape(), centers.cells()[D - 2] + 3);
        let plane = n[D - 2] * n[D - 1];
        let mut axes = [AxisProducts::of_no_axis(); 3];
        let at = |a: usize, i: usize| {
            let (cell, u) = centers.place(a, i);
            (cell, products(&Weights::at(u).w))
        };
        for (i, mass) in mass.chunks(plane).enumerate() {
            if D == 3 {
                let (cell, value) = at(0, i);
                if cell != layer {
                    continue;
                }
                axes[0].value = value;
            }
            for (j, mass) in mass.chunks(n[D - 1]).enumerate() {
                let (cell_y, value) = at(D - 2, j);
                axes[1] = AxisProducts { value, slope: [[0.0; 4]; 4] };
                for (k, m) in mass.iter().enumerate().filter(|(_, m)| **m > 0.0) {
                    let (cell_z, value) = at(D - 1, k);
                    axes[2] = AxisProducts { value, slope: [[0.0; 4]; 4] };
                    sums.add::<I>(ny, [cell_y, cell_z], &axes, *m, 0.0);
                }
            }
        }
    }
}
