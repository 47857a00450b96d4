//! The family of pairs: (25) and (26), over the whole range of gamma.
//!
//! With V_i what is left of part i's colliding cells, gamma = V_2 / (V_1 + V_2) as in (37d). For weights w > 0 of the two parts a minimum cut
//! gives a pair of greatest w_1 V_1 + w_2 V_2, a corner of the convex hull of all (V_1, V_2); and the cut's value bounds every pair there is:
//! V_1 + V_2 <= W / (w_1 (1 - gamma) + w_2 gamma). Beginning with the two unsweeps, gamma = 0 and 1, weights are taken across the line between two
//! known corners: either there is a corner beyond it, or the line is an edge of the hull. Pairs of one weight lie on such an edge, and a chain of
//! them is walked from one end to the other ([`ties`](super::ties)): wherever it passes a gamma that is asked for, that pair is as good as any can
//! be. Where the chain leaps over it, some of the leap's cells are taken, and the pair is closed: still maximal, and how far it is below the bound
//! is told.

use super::bits::Bits;
use super::closure::{Pair, close};
use super::conflict::{Conflicts, Side};
use super::cut::weight_of_all;
use super::flow::Flow;
use super::ties::Ties;
use crate::geometry::vec::number;
use crate::progress::Progress;
use crate::{Error, Result};

/// A pair of the family.
#[derive(Debug, Clone)]
pub struct Member {
    /// The gamma that was asked for.
    pub wanted: f64,
    /// That of the pair.
    pub gamma: f64,
    /// Weights of what is left of both parts' colliding cells.
    pub volumes: [u64; 2],
    /// No pair of the gamma that was asked for weighs more.
    pub bound: f64,
    /// The pair.
    pub pair: Pair,
}

/// A pair and what it weighs.
#[derive(Clone)]
struct Corner {
    pair: Pair,
    volumes: [u64; 2],
}

/// What all searches share.
struct Search<'a> {
    conflicts: &'a Conflicts,
    room: &'a [Bits; 2],
    weights: [&'a [u64]; 2],
    /// Cells that collide with any of the other part.
    colliding: [Bits; 2],
    /// (w_1, w_2, W) of all cuts, by which pairs are bounded.
    cuts: Vec<[f64; 3]>,
    found: Vec<Member>,
}

fn gamma_of(volumes: [u64; 2]) -> f64 {
    volumes[1] as f64 / (volumes[0] as f64 + volumes[1] as f64)
}

/// A pair for each of `gammas`, in their order: among the pairs of greatest weight where one comes near to it, else near to those. `weights`
/// are the cells', [n_1] and [n_2]: all 1 for the same volume each.
pub fn family(
    conflicts: &Conflicts,
    room: &[Bits; 2],
    weights: [&[u64]; 2],
    gammas: &[f64],
    progress: &mut Progress<'_>,
) -> Result<Vec<Member>> {
    if let Some((i, g)) = gammas.iter().enumerate().find(|(_, g)| !(0.0..=1.0).contains(*g)) {
        return Err(Error::InvalidArgument(format!("gamma {i} is {}; it must be in [0, 1]", number(*g))));
    }
    let all = weight_of_all(room, weights)?;
    let colliding = |side: Side| -> Result<Bits> {
        let mut cells = conflicts.neighbours(side.other(), &room[side.other().index()])?;
        cells.intersect(&room[side.index()]);
        Ok(cells)
    };
    let colliding = [colliding(Side::First)?, colliding(Side::Second)?];
    let mut search = Search { conflicts, room, weights, colliding, cuts: Vec::new(), found: Vec::new() };
    let ends = [
        search.corner(close(conflicts, room, Side::First, &room[0])?),
        search.corner(close(conflicts, room, Side::Second, &room[1])?),
    ];
    // The weights of a cut are differences of volumes, each below `all`.
    if u128::from(all) * u128::from(all) > u128::from(u64::MAX) {
        return Err(Error::InvalidArgument(format!("the weights' sum is {all}; for a family it must be below 2^32")));
    }
    let mut wanted: Vec<f64> = gammas.to_vec();
    wanted.sort_by(f64::total_cmp);
    wanted.dedup();
    search.cuts.push([1.0, 0.0, ends[0].volumes[0] as f64]);
    search.cuts.push([0.0, 1.0, ends[1].volumes[1] as f64]);
    let from = wanted.partition_point(|g| *g <= gamma_of(ends[0].volumes));
    let to = wanted.partition_point(|g| *g < gamma_of(ends[1].volumes)).max(from);
    wanted[..from].iter().for_each(|g| search.put(*g, &ends[0]));
    wanted[to..].iter().for_each(|g| search.put(*g, &ends[1]));
    search.between(&ends[0], &ends[1], &wanted[from..to], progress)?;
    let mut members = Vec::with_capacity(gammas.len());
    for gamma in gammas {
        let mut member = search.found.iter().find(|m| m.wanted == *gamma).expect("each has been put").clone();
        let bound = search.cuts.iter().map(|[w1, w2, most]| most / (w1 * (1.0 - gamma) + w2 * gamma));
        member.bound = bound.filter(|b| b.is_finite()).fold(f64::INFINITY, f64::min);
        members.push(member);
    }
    Ok(members)
}

impl Search<'_> {
    fn corner(&self, pair: Pair) -> Corner {
        let weigh = |k: usize| {
            let mut cells = pair.cells[k].clone();
            cells.intersect(&self.colliding[k]);
            cells.iter().map(|i| self.weights[k][i]).sum()
        };
        let volumes = [weigh(0), weigh(1)];
        Corner { pair, volumes }
    }

    fn put(&mut self, wanted: f64, corner: &Corner) {
        let Corner { pair, volumes } = corner.clone();
        self.found.push(Member { wanted, gamma: gamma_of(volumes), volumes, bound: f64::INFINITY, pair });
    }

    /// Finds pairs for the gammas `wanted`, in order, which lie between those of two corners.
    fn between(&mut self, low: &Corner, high: &Corner, wanted: &[f64], progress: &mut Progress<'_>) -> Result<()> {
        if wanted.is_empty() {
            return Ok(());
        }
        // Across the line between both: what part 1 loses from one to the other weighs what part 2 gains.
        let w = [high.volumes[1] - low.volumes[1], low.volumes[0] - high.volumes[0]];
        let weights = [0, 1].map(|k| self.weights[k].iter().map(|x| x * w[k]).collect::<Vec<u64>>());
        let near = self.conflicts.rows_of();
        let (near_k, far_k) = (near.index(), near.other().index());
        let flow = Flow::new(
            self.conflicts,
            &self.colliding[near_k],
            &weights[near_k],
            &self.colliding[far_k],
            &weights[far_k],
        )?;
        let mut ties = Ties::new(flow, &self.colliding[near_k], &self.colliding[far_k], progress)?;
        let all: u64 = (0..2).map(|k| self.colliding[k].iter().map(|i| weights[k][i]).sum::<u64>()).sum();
        self.cuts.push([w[0] as f64, w[1] as f64, (all - ties.flow()) as f64]);
        // The chain goes towards small gamma where part 1 grows.
        let first = self.of_ties(&ties);
        let (last, rest) = self.walk(&mut ties, near, &first, wanted)?;
        let (least, most) = if near == Side::First { (&last, &first) } else { (&first, &last) };
        let from = rest.partition_point(|g| *g < gamma_of(least.volumes));
        self.between_ends(low, least, &rest[..from], w, progress)?;
        self.between_ends(most, high, &rest[from..], w, progress)
    }

    /// Goes on, unless nothing is left between both corners.
    fn between_ends(
        &mut self,
        low: &Corner,
        high: &Corner,
        wanted: &[f64],
        w: [u64; 2],
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        let weigh =
            |c: &Corner| u128::from(w[0]) * u128::from(c.volumes[0]) + u128::from(w[1]) * u128::from(c.volumes[1]);
        // No corner beyond the line: only rounding of gammas could ask for more.
        if weigh(low) == weigh(high) || low.volumes[0] <= high.volumes[0] || low.volumes[1] >= high.volumes[1] {
            for g in wanted {
                let nearer =
                    if (gamma_of(low.volumes) - g).abs() <= (gamma_of(high.volumes) - g).abs() { low } else { high };
                self.put(*g, nearer);
            }
            return Ok(());
        }
        self.between(low, high, wanted, progress)
    }

    /// The pair where the chain is, with the cells that do not collide.
    fn of_ties(&self, ties: &Ties<'_>) -> Corner {
        let mut pair = ties.pair();
        for k in 0..2 {
            let mut free = self.room[k].clone();
            free.subtract(&self.colliding[k]);
            pair.cells[k].unite(&free);
        }
        self.corner(pair)
    }

    /// Walks along the chain and puts pairs where it passes gammas that are wanted; its last pair, and the gammas that it does not pass.
    fn walk(&mut self, ties: &mut Ties<'_>, near: Side, first: &Corner, wanted: &[f64]) -> Result<(Corner, Vec<f64>)> {
        let (near_k, far_k) = (near.index(), near.other().index());
        let sign = if near == Side::First { -1.0 } else { 1.0 };
        // Gammas in the order in which the chain comes to them.
        let ahead = |g: f64, volumes: [u64; 2]| sign * (g - gamma_of(volumes));
        let mut rest: Vec<f64> = wanted.iter().copied().filter(|g| ahead(*g, first.volumes) < 0.0).collect();
        let mut coming: Vec<f64> = wanted.iter().copied().filter(|g| ahead(*g, first.volumes) >= 0.0).collect();
        if sign < 0.0 {
            coming.reverse();
        }
        let (mut at, mut next) = (0, 0);
        let mut volumes = first.volumes;
        let mut gained = Vec::new();
        while let Some(i) = ties.free().first_in(at..ties.free().len()) {
            at = i + 1;
            let (old, far_weights, near_weights) = (volumes, self.weights[far_k], self.weights[near_k]);
            let (mut more, mut less) = (0, 0);
            gained.clear();
            ties.add(
                i,
                |i| {
                    more += near_weights[i];
                    gained.push(i);
                },
                |j| less += far_weights[j],
            )?;
            volumes[near_k] += more;
            volumes[far_k] -= less;
            let passed = coming[next..].iter().take_while(|g| ahead(**g, volumes) < 0.0).count();
            if passed == 0 {
                continue;
            }
            let after = self.of_ties(ties);
            let before = self.before(&after, near, &gained, old)?;
            for g in coming[next..next + passed].to_vec() {
                let corner = self.within_leap(&before, &after, near, &gained, g)?;
                self.put(g, &corner);
            }
            next += passed;
        }
        let last = self.of_ties(ties);
        rest.extend(&coming[next..]);
        rest.sort_by(f64::total_cmp);
        Ok((last, rest))
    }

    /// The chain's pair before it gained some near cells.
    fn before(&self, after: &Corner, near: Side, gained: &[usize], volumes: [u64; 2]) -> Result<Corner> {
        let mut set = after.pair.cells[near.index()].clone();
        gained.iter().for_each(|&i| set.remove(i));
        let corner = self.corner(close(self.conflicts, self.room, near, &set)?);
        debug_assert!(corner.volumes[near.index()] >= volumes[near.index()]);
        Ok(corner)
    }

    /// The pair nearest to `gamma` among those that have some of the leap's cells, closed: by bisection.
    fn within_leap(&self, before: &Corner, after: &Corner, near: Side, gained: &[usize], gamma: f64) -> Result<Corner> {
        let off = |c: &Corner| (gamma_of(c.volumes) - gamma).abs();
        let mut best = if off(before) <= off(after) { before.clone() } else { after.clone() };
        let (mut few, mut many) = (0, gained.len());
        while many - few > 1 && off(&best) > NEAR {
            let middle = (few + many) / 2;
            let mut set = before.pair.cells[near.index()].clone();
            gained[..middle].iter().for_each(|&i| set.insert(i));
            let corner = self.corner(close(self.conflicts, self.room, near, &set)?);
            let beyond = (gamma_of(corner.volumes) < gamma) == (near == Side::First);
            if off(&corner) < off(&best) {
                best = corner;
            }
            if beyond { many = middle } else { few = middle }
        }
        Ok(best)
    }
}

/// Gammas nearer than this are as good as equal.
const NEAR: f64 = 1e-3;
