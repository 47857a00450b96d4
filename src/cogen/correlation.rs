//! Collision measures of two parts' densities: paper 002, (12) to (15), (27) to (32), with the weights of (A.14) to (A.17).
//!
//! With n_21(i_1, i_2) the steps of K at which the centre of part 1's cell i_1 is in part 2's cell i_2, and n_12(i_1, i_2) those at which the
//! centre of i_2 is in i_1, densities being fractions of a cell,
//!
//!   w^12[i_1, i_2] = eps_2^D n_12 / K,   w^21[i_2, i_1] = eps_1^D n_21 / K:
//!
//! a moving centre carries its cell's measure, so that g is an area or volume times a fraction of the motion. Where we depart from the paper:
//! (A.16) runs k over 0..K - 1, as the t_k below it do, not 1..K; sums over trajectories take O((n_1 + n_2) K), not O(n_1 n_2 K); and the
//! right-hand sides of (32) are the wrong way round: dg_12/drho_1 = (w^21)^T rho_2, dg_12/drho_2 = w^21 rho_1.

use super::bits::Bits;
use super::conflict::{Conflicts, Side};
use super::foresight::{Estimate, Limit};
use super::grid::Grid;
use super::motion::gcd;
use super::parcels::BLOCK;
use super::part::Part;
use super::pitch::{Turns, Wide};
use super::steps::{Relative, Step};
use super::trajectory::Trajectories;
use crate::error::try_vec;
use crate::geometry::vec::{number, scale};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// Where the centres of part 1 are looked for, and those of part 2, and in how many turns that are alike.
fn wide<const D: usize>(
    parts: [&Part<D>; 2],
    [there, back]: [&Relative<D>; 2],
    n_steps: usize,
) -> Result<([Wide<D>; 2], usize)> {
    let turns = |seen: &Relative<D>, still: &Part<D>| {
        let (n, slide) = seen.turns()?;
        // With as many steps each.
        let same = gcd(n_steps as u64, n);
        (same > 1).then_some(())?;
        Turns::of(same as usize, scale((n / same) as f64, slide), still.grid())
    };
    let alike = turns(there, parts[1]).zip(turns(back, parts[0])).filter(|(one, two)| one.n == two.n);
    if let Some((one, two)) = alike
        && let (Some(first), Some(second)) = (Wide::new(parts[1], one)?, Wide::new(parts[0], two)?)
    {
        return Ok(([first, second], one.n));
    }
    let whole = |part| Wide::new(part, Turns::ONE).map(|wide| wide.expect("one turn takes no table"));
    Ok(([whole(parts[1])?, whole(parts[0])?], 1))
}

/// Rows are added to partial sums by as many parts of them, whatever the number of threads.
const PARTS: usize = 8;

/// What correlates the cells of two parts in relative motion: it depends on the motion and the grids alone.
#[derive(Debug)]
pub struct Correlation<const D: usize> {
    /// Of part 1's centres in part 2's cells, n_21 by rows; of part 2's in part 1's, n_12 by columns.
    of: [Trajectories<D>; 2],
    allowed: [Bits; 2],
    grids: [Grid<D>; 2],
    n_steps: usize,
    /// Steps that visits are counted over: those of a period, or all.
    n_looked_at: usize,
}

/// How both parts collide as a whole: (29) and (30).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// g_{2,1}: area or volume of part 2 that is in part 1, times the fraction of the motion that it is.
    pub g21: f64,
    /// g_{1,2}
    pub g12: f64,
}

impl<const D: usize> Correlation<D> {
    /// For parts in relative motion, tau_12 being `relative`; `n_steps` is the paper's K. Of motions that repeat themselves, with as many steps
    /// each time, one period is looked at. The error tells of what would take more than `max_bytes`, and what would fit: before it is made,
    /// from a sample of the trajectories.
    pub fn new(
        parts: [&Part<D>; 2],
        relative: &Relative<D>,
        n_steps: usize,
        max_bytes: u64,
        workers: &Workers,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        let [there, back] = [relative.reversed(), relative.clone()];
        let (wide, n_turns) = wide(parts, [&there, &back], n_steps)?;
        let steps = |seen: &Relative<D>| match n_turns {
            1 => seen.even_steps_of_period(n_steps),
            n => seen.first_even_steps(n_steps, n_steps / n),
        };
        let (there, back) = (steps(&there)?, steps(&back)?);
        // Half as large cells are 2^D as many, of which each visits twice as many if steps are not too few for that.
        let limit = Limit::new("the trajectories", max_bytes, parts.map(Part::grid), D);
        let estimate = |there: &[Step<D>], back: &[Step<D>]| -> Result<Estimate> {
            let first = Trajectories::estimate(there, &wide[0], parts[0], workers)?;
            Ok(first.plus(&Trajectories::estimate(back, &wide[1], parts[1], workers)?))
        };
        let foreseen = estimate(&there, &back)?;
        if limit.is_passed_by(&foreseen) {
            // Fewer and fewer of the steps, until they fit.
            let mut n = there.len() * 4 / 5;
            let some = |steps: &[Step<D>], n: usize| (0..n).map(|k| steps[k * steps.len() / n]).collect::<Vec<_>>();
            while n > 1 && estimate(&some(&there, n), &some(&back, n))?.bytes() > max_bytes as f64 {
                n = n * 4 / 5;
            }
            let fitting = if n > 1 { Some(n * n_steps / there.len()) } else { None };
            return Err(limit.refusal(foreseen.bytes(), fitting));
        }
        let [of_second, of_first] = wide;
        let first =
            progress.part(0.0, 0.5, |part| Trajectories::new(&there, of_second, parts[0], limit, workers, part))?;
        let left = max_bytes.saturating_sub(first.bytes() as u64);
        let limit = Limit::new("the trajectories", left, parts.map(Part::grid), D);
        let second =
            progress.part(0.5, 1.0, |part| Trajectories::new(&back, of_first, parts[1], limit, workers, part))?;
        let allowed = parts.map(|p| p.allowed().clone());
        let grids = parts.map(|p| *p.grid());
        Ok(Correlation { of: [first, second], allowed, grids, n_steps, n_looked_at: n_turns * there.len() })
    }

    /// K
    pub fn n_steps(&self) -> usize {
        self.n_steps
    }

    /// Visits of both parts' centres that are stored, of one period or turn.
    pub fn n_visits(&self) -> usize {
        self.of.iter().map(Trajectories::n_visits).sum()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.of.iter().map(Trajectories::bytes).sum()
    }

    /// Cells of a part's grid.
    pub fn n_cells(&self, side: Side) -> usize {
        self.allowed[side.index()].len()
    }

    /// eps^D of a part.
    pub fn measure(&self, side: Side) -> f64 {
        self.grids[side.index()].measure()
    }

    /// Refuses densities `[n_1]`, `[n_2]` that are none: outside [0, 1], or not 0 where a part may not be.
    pub fn check(&self, densities: [&[f64]; 2]) -> Result<()> {
        for (k, (rho, allowed)) in densities.iter().zip(&self.allowed).enumerate() {
            if rho.len() != allowed.len() {
                return Err(Error::InvalidArgument(format!(
                    "{} densities for part {}'s {} cells",
                    rho.len(),
                    k + 1,
                    allowed.len()
                )));
            }
            let bad = |(i, &x): (usize, &f64)| !(0.0..=1.0).contains(&x) || x > 0.0 && !allowed.has(i);
            if let Some((i, &x)) = rho.iter().enumerate().find(|&(i, x)| bad((i, x))) {
                let why =
                    if (0.0..=1.0).contains(&x) { "0, since the part may not have that cell" } else { "in [0, 1]" };
                return Err(Error::InvalidArgument(format!(
                    "density {i} of part {} is {}; it must be {why}",
                    k + 1,
                    number(x)
                )));
            }
        }
        Ok(())
    }

    /// l_{2,1} of (12) for `Side::First`, l_{1,2} of (13) for the other: for the centre of each cell of part `side`, the fraction of the
    /// motion that it is in the other part, of `density`. Into `out`.
    ///
    /// Panics where `density` is not as long as the other part's cells are many, or `out` as those of this.
    pub fn local(&self, side: Side, density: &[f64], out: &mut [f64], workers: &Workers) {
        assert_eq!((density.len(), out.len()), (self.n_cells(side.other()), self.n_cells(side)), "a number a cell");
        let (of, share) = (&self.of[side.index()], 1.0 / self.n_looked_at as f64);
        workers.for_each(out.chunks_mut(BLOCK).enumerate(), |(block, out)| {
            for (k, sum) in out.iter_mut().enumerate() {
                let mut total = 0.0;
                of.each(block * BLOCK + k, |cell, stay| total += f64::from(stay) * density[cell]);
                *sum = share * total;
            }
        });
    }

    /// For each cell of the other part, how much of part `side`, of `density`, passes through it: the sum of densities, times the fraction
    /// of the motion that their centres are in it. Into `out`.
    fn spread(&self, side: Side, density: &[f64], out: &mut [f64], workers: &Workers) -> Result<()> {
        let (of, share) = (&self.of[side.index()], 1.0 / self.n_looked_at as f64);
        let rows = of.n_rows().div_ceil(PARTS).max(1);
        let sums = workers.map(PARTS, |part| -> Result<Vec<f64>> {
            let mut sum = try_vec(out.len(), 0.0, "partial sums of a collision measure")?;
            for i in (part * rows..((part + 1) * rows).min(of.n_rows())).filter(|&i| density[i] != 0.0) {
                of.each(i, |cell, stay| sum[cell] += f64::from(stay) * density[i]);
            }
            Ok(sum)
        });
        out.fill(0.0);
        for sum in sums {
            out.iter_mut().zip(sum?).for_each(|(total, x)| *total += share * x);
        }
        Ok(())
    }

    /// (29) and (30) for densities `[n_1]`, `[n_2]`.
    pub fn measures(&self, densities: [&[f64]; 2], workers: &Workers) -> Result<Measures> {
        self.check(densities)?;
        let of = |side: Side| -> Result<f64> {
            let k = side.index();
            let mut local = try_vec(densities[k].len(), 0.0, "local collision measures")?;
            self.local(side, densities[1 - k], &mut local, workers);
            Ok(self.grids[k].measure() * local.iter().zip(densities[k]).map(|(l, rho)| l * rho).sum::<f64>())
        };
        Ok(Measures { g21: of(Side::Second)?, g12: of(Side::First)? })
    }

    /// (31) and (32): derivatives of g_{2,1} and of g_{1,2}, each by both parts' densities; into `out`, `[measure][part][cell]`.
    pub fn sensitivities(&self, densities: [&[f64]; 2], out: [[&mut [f64]; 2]; 2], workers: &Workers) -> Result<()> {
        self.check(densities)?;
        for (k, out) in out.iter().flatten().enumerate() {
            let n = self.allowed[k % 2].len();
            if out.len() != n {
                return Err(Error::InvalidArgument(format!(
                    "room for {} derivatives by part {}'s {n} cells",
                    out.len(),
                    k % 2 + 1
                )));
            }
        }
        let [[d21_d1, d21_d2], [d12_d1, d12_d2]] = out;
        self.spread(Side::Second, densities[1], d21_d1, workers)?;
        self.local(Side::Second, densities[0], d21_d2, workers);
        self.local(Side::First, densities[1], d12_d1, workers);
        self.spread(Side::First, densities[0], d12_d2, workers)?;
        for (out, measure) in [(d21_d1, 1), (d21_d2, 1), (d12_d1, 0), (d12_d2, 0)] {
            out.iter_mut().for_each(|x| *x *= self.grids[measure].measure());
        }
        Ok(())
    }

    /// The conflict graph of the paper's measure: an edge wherever w^12 or w^21 is not 0. Cells whose centres do not meet at the sampled times
    /// may still overlap: see [`Conflicts::of_overlap`]. The error tells of a graph that would take more than `max_bytes`, and
    /// what cells would fit: before it is made, from a sample of its rows.
    pub fn conflicts(&self, max_bytes: u64, workers: &Workers, progress: &mut Progress<'_>) -> Result<Conflicts> {
        let n = self.allowed.each_ref().map(Bits::len);
        let rows_of = if self.allowed[1].count() < self.allowed[0].count() { Side::Second } else { Side::First };
        let (own, other) = (&self.of[rows_of.index()], &self.of[rows_of.other().index()]);
        // The other's visits, by the cells that are visited.
        let n_rows = n[rows_of.index()];
        let mut ends: Vec<u64> = try_vec(n_rows + 1, 0, "the conflict graph")?;
        (0..other.n_rows()).for_each(|j| other.each(j, |cell, _| ends[cell + 1] += 1));
        (0..n_rows).for_each(|i| ends[i + 1] += ends[i]);
        // Half as large cells are 2^D as many, each with twice as many runs.
        let limit = |most| Limit::new("the conflict graph", most, self.grids.each_ref(), D + 1);
        let by_visits = 16 * n_rows as u64 + 4 * ends[n_rows];
        let left = max_bytes.checked_sub(by_visits).ok_or_else(|| limit(max_bytes).refusal(by_visits as f64, None))?;
        let mut visitors: Vec<u32> = try_vec(ends[n_rows] as usize, 0, "the conflict graph")?;
        let mut at = ends.clone();
        for j in 0..other.n_rows() {
            other.each(j, |cell, _| {
                visitors[at[cell] as usize] = j as u32;
                at[cell] += 1;
            });
        }
        let row = move |i: usize, mark: &mut dyn FnMut(usize)| {
            own.each(i, |cell, _| mark(cell));
            visitors[ends[i] as usize..ends[i + 1] as usize].iter().for_each(|&j| mark(j as usize));
        };
        drop(at);
        Conflicts::of_rows(n, rows_of, row, limit(left), workers, progress)
    }

    /// (33) and (34): the cells of each part that collide with the other's cells as both may have them. One direction misses cells; this is
    /// the union of both.
    pub fn colliding(&self, workers: &Workers) -> Result<[Bits; 2]> {
        let ones = |side: Side| -> Result<Vec<f64>> {
            let allowed = &self.allowed[side.index()];
            let mut rho = try_vec(allowed.len(), 0.0, "colliding cells")?;
            allowed.iter().for_each(|i| rho[i] = 1.0);
            Ok(rho)
        };
        let rho = [ones(Side::First)?, ones(Side::Second)?];
        let meeting = |side: Side| -> Result<Bits> {
            let n = self.n_cells(side);
            let (mut own, mut others) = (try_vec(n, 0.0, "colliding cells")?, try_vec(n, 0.0, "colliding cells")?);
            let other = &rho[side.other().index()];
            self.local(side, other, &mut own, workers);
            self.spread(side.other(), other, &mut others, workers)?;
            Bits::of(n, |i| own[i] + others[i] > 0.0)
        };
        Ok([meeting(Side::First)?, meeting(Side::Second)?])
    }
}
