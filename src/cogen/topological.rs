//! Topological sensitivities of the collision measures: paper 002, appendix B.
//!
//! How a measure changes as a small piece is put to a part at x, (B.1), or taken from it, (B.2), by the piece's area or volume. With pieces of
//! a cell's size around cells' centres, and densities as fractions of a cell, these are the changes themselves, g being linear in each density:
//!
//!   D^+ g_i = (1 - rho_i) dg/drho_i / eps^D,   D^- g_i = rho_i dg/drho_i / eps^D.
//!
//! Where a part fills a cell there is nothing to put, where it is not there is nothing to take: D^+ is 0 inside, D^- outside, as below (B.2). The
//! other of both is what (B.5), (B.6) and (B.12) tend to: the fraction of the motion that x is in the other part. In cells that the surface
//! cuts the paper leaves the limit open; here they have their shares.

use super::conflict::Side;
use super::correlation::Correlation;
use crate::Result;
use crate::par::Workers;

/// What is done to a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// A piece is put to it: D^+.
    Put,
    /// A piece is taken from it: D^-.
    Take,
}

impl<const D: usize> Correlation<D> {
    /// Topological sensitivities of g_{2,1} and of g_{1,2}, each by both parts; into `out`, `[measure][part][cell]`, as (31) and (32) are by
    /// [`Correlation::sensitivities`]. Without a unit; 0 at cells that a part may not have.
    pub fn topological_sensitivities(
        &self,
        densities: [&[f64]; 2],
        change: Change,
        out: [[&mut [f64]; 2]; 2],
        workers: &Workers,
    ) -> Result<()> {
        let [[a, b], [c, d]] = out;
        self.sensitivities(densities, [[&mut *a, &mut *b], [&mut *c, &mut *d]], workers)?;
        for (out, side) in [(a, Side::First), (b, Side::Second), (c, Side::First), (d, Side::Second)] {
            let inverse = 1.0 / self.measure(side);
            for (x, rho) in out.iter_mut().zip(densities[side.index()]) {
                *x *= inverse * if change == Change::Put { 1.0 - rho } else { *rho };
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::Grid;
    use super::super::motion::{Law, Motion};
    use super::super::part::Part;
    use super::super::steps::Relative;
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::progress::Progress;

    /// `[measure][part]`, both changes.
    fn all<const D: usize>(c: &Correlation<D>, rho: &[Vec<f64>; 2], workers: &Workers) -> [[[Vec<f64>; 2]; 2]; 2] {
        [Change::Put, Change::Take].map(|change| {
            let of = |k: usize| vec![f64::NAN; rho[k].len()];
            let mut out = [[of(0), of(1)], [of(0), of(1)]];
            let [[a, b], [e, d]] = &mut out;
            c.topological_sensitivities([&rho[0], &rho[1]], change, [[a, b], [e, d]], workers).unwrap();
            out
        })
    }

    fn they_are_what_cells_change<const D: usize>(
        corners: [[f64; D]; 2],
        counts: [[usize; D]; 2],
        motion: [Motion<D>; 2],
    ) {
        let workers = Workers::caller_only();
        let part = |k: usize, eps: f64| {
            let grid = Grid::new(corners[k], eps, counts[k]).unwrap();
            Part::of_centers(grid, |x| x[0] + x[1] > corners[k][0] + corners[k][1] + 0.3).unwrap()
        };
        // Cells of two sizes.
        let parts = [part(0, 0.13), part(1, 0.17)];
        let pair = [&parts[0], &parts[1]];
        let [from, of] = motion;
        let relative = Relative { from, of };
        let correlation = Correlation::new(pair, &relative, 50, 1 << 30, &workers, &mut Progress::silent()).unwrap();
        let mut random = SplitMix64::new(17);
        // Empty, full, and cut cells.
        let rho = parts.each_ref().map(|p| -> Vec<f64> {
            let of = |i: usize, x: f64| {
                if !p.allowed().has(i) || x < 0.4 {
                    0.0
                } else if x < 0.8 {
                    1.0
                } else {
                    5.0 * x - 4.0
                }
            };
            (0..p.grid().n_cells()).map(|i| of(i, random.unit())).collect()
        });
        let measures = |rho: &[Vec<f64>; 2]| {
            let m = correlation.measures([&rho[0], &rho[1]], &workers).unwrap();
            [m.g21, m.g12]
        };
        let (found, now) = (all(&correlation, &rho, &workers), measures(&rho));
        let mut n = 0;
        for side in 0..2 {
            for i in parts[side].allowed().iter() {
                for (change, to) in [(0, 1.0), (1, 0.0)] {
                    let mut changed = rho.clone();
                    changed[side][i] = to;
                    let then = measures(&changed);
                    for k in 0..2 {
                        let by = if change == 0 { then[k] - now[k] } else { now[k] - then[k] }
                            / parts[side].grid().measure();
                        let x = found[change][k][side][i];
                        assert!(
                            (x - by).abs() < 1e-10 && (rho[side][i] != 1.0 - f64::from(change as u8) || x == 0.0),
                            "{x} {by}"
                        );
                        n += usize::from(x > 0.0);
                    }
                }
            }
        }
        assert!(n > 100, "{n}");
    }

    #[test]
    fn they_are_what_cells_change_in_the_plane() {
        let turn = Motion::turn([0.1, 0.2], Law::even(2.0)).unwrap();
        let slide = Motion::slide([0.5, -0.3], Law::even(1.0)).unwrap();
        they_are_what_cells_change([[-0.7, -0.6], [-0.4, -0.9]], [[11, 10], [8, 9]], [turn, slide]);
    }

    #[test]
    fn they_are_what_cells_change_in_space() {
        let screw = Motion::screw([0.1, 0.2, 0.0], [0.3, 0.4, 1.0], 0.1, Law::even(2.0)).unwrap();
        they_are_what_cells_change([[-0.5; 3], [-0.4; 3]], [[7, 6, 5], [5, 5, 5]], [Motion::fixed(), screw]);
    }

    /// (B.6): a square slides over points, which it covers for a time that is known; the error goes with the cells.
    #[test]
    fn they_tend_to_times_of_cover() {
        let workers = Workers::caller_only();
        let off = |n: usize| {
            let eps = 1.0 / n as f64;
            let part = |x: f64, y: f64, w: usize, h: usize| {
                Part::whole(Grid::new([x, y], eps, [w * n, h * n]).unwrap()).unwrap()
            };
            // Part 2, a unit square, goes by 2 to the right, over part 1's grid of 3 x 1, of which the right third is filled.
            let parts = [part(0.0, 0.013, 3, 1), part(0.007, 0.0, 1, 1)];
            let of = Motion::slide([2.0, 0.0], Law::even(1.0)).unwrap();
            let relative = Relative { from: Motion::fixed(), of };
            let pair = [&parts[0], &parts[1]];
            let c = Correlation::new(pair, &relative, 7 * n + 3, 1 << 30, &workers, &mut Progress::silent()).unwrap();
            let grid = parts[0].grid();
            let one = (0..grid.n_cells()).map(|i| f64::from(u8::from(grid.center(i)[0] > 2.0))).collect();
            let [put, take] = all(&c, &[one, vec![1.0; n * n]], &workers);
            let (mut worst, mut outside) = (0.0_f64, 0.0_f64);
            for i in 0..grid.n_cells() {
                let [x, y] = grid.center(i);
                // It is over x from x - 1 to x, in halves of the time.
                let cover = if y < 1.0 { 0.5 * (1.0_f64.min(x).min(3.0 - x)) } else { 0.0 };
                let (is, other) = if x > 2.0 { (&take, &put) } else { (&put, &take) };
                // Rows at the rim of the square have few cells that do not tend.
                if y < 1.0 - eps {
                    worst = worst.max((is[0][0][i] - cover).abs()).max((is[1][0][i] - cover).abs());
                }
                outside = outside.max(other[0][0][i].abs());
            }
            assert_eq!(outside, 0.0);
            worst
        };
        let (coarse, fine) = (off(10), off(40));
        assert!(coarse < 0.02 && fine < 0.6 * coarse, "{coarse} {fine}");
    }
}
