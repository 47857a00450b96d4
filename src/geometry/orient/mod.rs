//! Normals of points that come without: a plane through each point's neighbours, and signs that agree.
//!
//! Takes points; gives a [`Cloud`] and a [`NormalReport`]. One code for the plane and for space.
//!
//! | source | here |
//! |---|---|
//! | Hoppe et al. 1992, section 3.2, tangent planes | `planes` |
//! | its section 3.3, the Riemannian graph | `graph` |
//! | Koenig and Gumhold 2009, the flip criterion | `agreement` |
//! | Keuper et al. 2015, greedy additive edge contraction | `merge` |
//! | divergence theorem; Barill et al. 2018, for nested parts | `outward` |
//! | Golub and Van Loan 2013, algorithm 8.5.2 | `eigen` |
//!
//! Notation: p point, n unit normal, k neighbours, a_ij agreement, A the area that a point stands for.
//!
//! Where we depart from Hoppe et al.:
//! - The agreement of two normals looks at where their points lie, so that the two sides of an edge are related, and those of a sheet.
//! - Signs come from merging clusters of points, the most sure first, the agreements between two clusters summed. A spanning tree stakes
//!   all behind an edge on that one edge.
//! - The planes are fitted once more to the neighbours that then face the same way, and the signs found again: not across a thin sheet.
//! - Components face outward by the volume they enclose, not by their topmost point, whose normal may be the worst.
//!
//! What was tried, in wrong normals of 25,000 samples, without noise and with a deviation of 0.001 D. `tree` is the maximum spanning tree,
//! `merge` what stands here, c the factor of `agreement`, `refit` the second fit. `cargo test --test data_normals` has today's figures.
//!
//! | | fandisk | knot | armadillo | heart | rotor | blended wing | box 0.01 thick |
//! |---|--:|--:|--:|--:|--:|--:|--:|
//! | tree, c = 0 (Hoppe et al.) | 0, 1 | 0, 0 | 10, 23 | 1996, 1965 | 9818, 9914 | 1037, 1161 | 12524, 12499 |
//! | tree, c = 2 | 0, 5 | 0, 0 | 8, 34 | 135, 158 | 66, 644 | 1047, 1028 | 443, 9044 |
//! | merge, c = 2 | 0, 2 | 0, 0 | 8, 19 | 239, 678 | 337, 432 | 961, 1183 | 226, 2147 |
//! | merge, c = 3 | 1, 34 | 0, 2 | 7, 99 | 153, 162 | 65, 191 | 552, 1580 | 145, 533 |
//! | merge, c = 4 | 2, 100 | 0, 18 | 9, 280 | 117, 153 | 45, 199 | 523, 2214 | 174, 2169 |
//! | merge, c = 2.5, refit | 0, 13 | 0, 0 | 6, 35 | 151, 174 | 112, 120 | 575, 1175 | 63, 263 |
//! | merge, c = 3, refit | 1, 26 | 0, 2 | 5, 79 | 133, 133 | 69, 151 | 506, 1465 | 56, 265 |
//! | merge, c = 4, refit | 1, 77 | 0, 13 | 10, 220 | 109, 116 | 23, 134 | 484, 2069 | 75, 737 |
//!
//! With c = 3 and the refit, k = 8 has 240 and 877 wrong on the thin box, k = 12 33 and 111; elsewhere 8, 10 and 12 differ little, either
//! way, and normals beside edges are the better the smaller k is. Turning single points by the winding number of the surfels a little
//! before and behind them (after Barill et al. 2018) was tried too: it mends some thin parts and, where points are noisy, turns whole
//! neighbourhoods, 1610 points of a sphere with c = 4.

mod agreement;
mod eigen;
mod graph;
mod merge;
mod options;
mod outliers;
mod outward;
mod places;
mod planes;
#[cfg(test)]
mod tests;

pub use options::{NormalOptions, NormalReport};

use super::unit::Unit;
use super::vec::{is_finite, scale, text};
use super::{Bounds, Cloud};
use crate::error::try_with_capacity;
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
use graph::Graph;
use places::Places;
use std::time::Instant;

/// Fits of the planes after the first, each to the neighbours that face alike after the one before.
const REFITS: usize = 1;

impl<const D: usize> Cloud<D> {
    /// The cloud of `points` [n x D], in any unit, with estimated normals that point out of the solid, and what was found on the way.
    ///
    /// All points stay, in their order: outliers and copies are named in the report, not dropped. Closed parts face outward; a part inside
    /// an odd number of others is the boundary of a cavity and faces into it; open parts face the side they bulge to, flat ones that of
    /// their largest coordinate. The same points give the same bits on any number of threads, and scaled by a power of two the same
    /// normals.
    ///
    /// Sides of a sheet nearer to each other than the points of one side are not told apart: on closed shapes nearly all wrong normals
    /// are there. Time grows as n log n: half a second for 25,000 points of space and 3.5 s for 250,000, on one thread of a small machine.
    ///
    /// Errors: fewer than D + 1 points, more than 2^30 / D, a coordinate that is not finite, options out of range
    /// ([`Error::InvalidArgument`]); fewer than D + 1 different places, or all points on a line of space ([`Error::Degenerate`]);
    /// [`Error::OutOfMemory`]; [`Error::Cancelled`].
    pub fn with_estimated_normals(
        points: Vec<[f64; D]>,
        options: &NormalOptions,
        progress: &mut Progress,
    ) -> Result<(Self, NormalReport)> {
        let start = Instant::now();
        options.validate()?;
        check(&points)?;
        check_memory::<D>(points.len(), options)?;
        progress.tell(0.0, "neighbours")?;
        let workers = Workers::new(options.n_threads)?;
        let mut places = Places::of(&points, Unit::of_bounds(&Bounds::of(&points)))?;
        if places.points.len() <= D {
            let (n, m) = (points.len(), places.points.len());
            return Err(Error::Degenerate(format!(
                "the {n} points lie at {m} different places; normals need at least {}",
                D + 1
            )));
        }
        let k = options.k::<D>(places.points.len());
        let graph = Graph::new(std::mem::take(&mut places.points), k, &workers, progress, 0.4)?;
        let found = estimate(&graph, options, &workers, progress)?;
        let (cloud, mut report) = found.at_points(points, places)?;
        progress.tell(1.0, "done")?;
        report.seconds = start.elapsed().as_secs_f64();
        Ok((cloud, report))
    }

    /// The cloud less the points at `indices`, in any order: the outliers of a [`NormalReport`], say. Those that stay keep weights and
    /// origins.
    pub fn without(&self, indices: &[u32]) -> Result<Self> {
        let n = self.len();
        let mut kept = crate::error::try_vec(n, true, "the points that stay")?;
        for (place, &i) in indices.iter().enumerate() {
            let Some(kept) = kept.get_mut(i as usize) else {
                return Err(Error::InvalidArgument(format!(
                    "index {place} is {i}, but the cloud has {n} points, counted from 0"
                )));
            };
            *kept = false;
        }
        let left = kept.iter().filter(|kept| **kept).count();
        let (points, normals) = (of_kept(self.points(), &kept, left)?, of_kept(self.normals(), &kept, left)?);
        let mut cloud = Cloud::new(points, normals)?;
        if let Some(weights) = self.weights() {
            cloud.set_weights(of_kept(weights, &kept, left)?)?;
        }
        match self.origins() {
            Some(origins) => Ok(cloud.with_origins(of_kept(origins, &kept, left)?)),
            None => Ok(cloud),
        }
    }
}

/// The `left` ones of `all` that are `kept`.
fn of_kept<T: Copy>(all: &[T], kept: &[bool], left: usize) -> Result<Vec<T>> {
    let mut some = try_with_capacity(left, "what belongs to the points that stay")?;
    some.extend(all.iter().zip(kept).filter(|(_, kept)| **kept).map(|(x, _)| *x));
    Ok(some)
}

/// What was found at the places.
struct Found<const D: usize> {
    normals: Vec<[f64; D]>,
    n_components: usize,
    outliers: Vec<bool>,
    degenerate: Vec<bool>,
    consent: agreement::Consent,
}

fn estimate<const D: usize>(
    graph: &Graph<D>,
    options: &NormalOptions,
    workers: &Workers,
    progress: &mut Progress,
) -> Result<Found<D>> {
    let outliers = outliers::outliers(graph, options.outlier_factor)?;
    let mut normals: Option<Vec<[f64; D]>> = None;
    let mut round = 0;
    loop {
        let [from, until] = [round, round + 1].map(|r| 0.4 + 0.5 * r as f64 / (REFITS + 1) as f64);
        progress.tell(from, "planes")?;
        let planes = planes::planes(graph, normals.as_deref(), workers)?;
        if planes.iter().all(|plane| plane.degenerate) {
            return Err(Error::Degenerate(format!(
                "each of the {} different points lies on a line with its neighbours; a normal needs neighbours off the line",
                graph.len()
            )));
        }
        let mut unsigned = try_with_capacity(graph.len(), "the normals")?;
        unsigned.extend(planes.iter().map(|plane| plane.normal));
        let signs = merge::merge(graph.len(), agreement::links(graph, &unsigned)?, progress, [from, until])?;
        if round == REFITS {
            progress.tell(until, "sides")?;
            let normals = outward::outward(graph, &planes, &outliers, &signs)?;
            let consent = agreement::consent(graph, &normals)?;
            let degenerate = planes.iter().map(|plane| plane.degenerate).collect();
            return Ok(Found { normals, n_components: signs.n_components, outliers, degenerate, consent });
        }
        unsigned.iter_mut().zip(&signs.sign).for_each(|(normal, sign)| *normal = scale(*sign, *normal));
        normals = Some(unsigned);
        round += 1;
    }
}

impl<const D: usize> Found<D> {
    /// The cloud of the caller's `points`, with all that is told in their indices.
    fn at_points(self, points: Vec<[f64; D]>, places: Places<D>) -> Result<(Cloud<D>, NormalReport)> {
        let of_point = &places.of_point;
        let named = |which: &dyn Fn(usize) -> bool| -> Result<Vec<u32>> {
            let all = || (0..points.len()).filter(|&i| which(of_point[i] as usize));
            let mut indices = try_with_capacity(all().count(), "the indices of the report")?;
            indices.extend(all().map(|i| i as u32));
            Ok(indices)
        };
        let report = NormalReport {
            n_components: self.n_components,
            outliers: named(&|place| self.outliers[place])?,
            degenerate: named(&|place| self.degenerate[place])?,
            doubtful: named(&|place| self.consent.of_point[place] < 0.0)?,
            agreement: self.consent.overall,
            copies: places.copies,
            seconds: 0.0,
        };
        let mut normals = try_with_capacity(points.len(), "the normals")?;
        normals.extend(of_point.iter().map(|&place| self.normals[place as usize]));
        Ok((Cloud::new(points, normals)?, report))
    }
}

fn check<const D: usize>(points: &[[f64; D]]) -> Result<()> {
    if points.len() <= D {
        let n = points.len();
        return Err(Error::InvalidArgument(format!("{n} points are given; normals need at least {}", D + 1)));
    }
    match points.iter().enumerate().find(|(_, p)| !is_finite(&p[..])) {
        Some((i, p)) => Err(Error::InvalidArgument(format!("point {i} is {}; coordinates must be finite", text(p)))),
        None => Ok(()),
    }
}

/// Refuses an estimate that would take more than the limit, or more points than the trees of the surfels count.
pub(crate) fn check_memory<const D: usize>(n: usize, options: &NormalOptions) -> Result<()> {
    let most = (1 << 30) / D;
    if n > most {
        return Err(Error::InvalidArgument(format!("{n} points are given; at most {most} are taken")));
    }
    let (bytes, limit) = (memory(n, options.k::<D>(n)), u128::from(options.memory_limit));
    if bytes <= limit {
        return Ok(());
    }
    Err(Error::OutOfMemory { what: format!("estimating the normals of {n} points"), bytes, limit: Some(limit) })
}

/// Bytes at most: a neighbour is 16 bytes, of which a point has k; so is a link, of which it has at most as many. The rest is the tree, the
/// points, their planes and, of several components, their surfels.
fn memory(n: usize, k: usize) -> u128 {
    n as u128 * (1000 + 32 * k as u128)
}
