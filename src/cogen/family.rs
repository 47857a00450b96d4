//! The family of pairs: (25) and (26), over the whole range of gamma.
//!
//! With V_i what is left of part i's colliding cells, gamma = V_2 / (V_1 + V_2) as in (37d). For weights w > 0 of the two parts a minimum cut
//! gives a pair of greatest w_1 V_1 + w_2 V_2, a corner of the convex hull of all (V_1, V_2); and the cut's value bounds every pair there is:
//! V_1 + V_2 <= W / (w_1 (1 - gamma) + w_2 gamma). Beginning with the two unsweeps, gamma = 0 and 1, weights are taken across the line between two
//! known corners: either there is a corner beyond it, or the line is an edge of the hull. Pairs of one weight lie on such an edge, and a chain of
//! them is walked from one end to the other (`ties`): where it passes a gamma that is asked for, that pair is as good as any can be.
//! Where the chain, or what is known so far, leaps over it, some of the leap's cells are taken, those that conflict with each other first, and the
//! pair is closed: maximal still, and taken if it is near enough to the bound. If there is no corner left between, and it is not near enough,
//! proximal cuts choose the cells (`proximal`), and the better pair is taken.
//!
//! Small weights make flows of few units, which are found much faster: where pairs need not come up to the bound, weights are rounded.

use super::bits::Bits;
use super::closure::{Pair, check_room, close};
use super::conflict::{Conflicts, Side};
use super::cut::weight_of_all;
use super::flow::Flow;
use super::proximal::{PULLS, Proximal};
use super::ties::Ties;
use crate::error::try_with_capacity;
use crate::geometry::vec::number;
use crate::progress::Progress;
use crate::{Error, Result};

/// A pair of the family.
#[derive(Debug, Clone)]
pub struct Member {
    /// The gamma that was asked for.
    pub wanted: f64,
    /// That of the pair; NaN where nothing is left of the colliding cells that weighs anything.
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

/// What lies between two pairs of a family.
struct Row {
    /// Near cells that one has more, and far ones that it has less.
    gained: Bits,
    lost: Bits,
    /// The near ones, those that conflict near each other.
    order: Vec<u32>,
}

/// How near to the bound pairs shall come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FamilyOptions {
    /// Pairs are good enough at this fraction below the bound; with 0 corners are looked for until the hull is known at each gamma.
    pub gap: f64,
}

impl Default for FamilyOptions {
    fn default() -> Self {
        FamilyOptions { gap: 0.005 }
    }
}

/// What all searches share.
struct Search<'a> {
    options: FamilyOptions,
    conflicts: &'a Conflicts,
    room: &'a [Bits; 2],
    weights: [&'a [u64]; 2],
    /// Cells that collide with any of the other part.
    colliding: [Bits; 2],
    /// (w_1, w_2, W) of all cuts, by which pairs are bounded.
    cuts: Vec<[f64; 3]>,
    found: Vec<Member>,
    /// Pairs that are asked for.
    n_wanted: usize,
}

fn weigh(w: [u64; 2], corner: &Corner) -> u128 {
    (0..2).map(|k| u128::from(w[k]) * u128::from(corner.volumes[k])).sum()
}

/// What part 2 gains, and what part 1 loses, from one corner to another.
fn slope(low: &Corner, high: &Corner) -> [u64; 2] {
    let change = |more: u64, less: u64| more.saturating_sub(less).max(1);
    [change(high.volumes[1], low.volumes[1]), change(low.volumes[0], high.volumes[0])]
}

/// The nearest fraction with numbers up to ROUND.
fn rounded(w: [u64; 2]) -> [u64; 2] {
    if w[0].max(w[1]) <= ROUND {
        return w;
    }
    let ratio = w[0] as f64 / w[1] as f64;
    let of = |b: u64| ((ratio * b as f64).round().clamp(1.0, ROUND as f64) as u64, b);
    let off = |(a, b): (u64, u64)| (a as f64 / b as f64 / ratio).ln().abs();
    let (a, b) = (1..=ROUND).map(of).min_by(|x, y| off(*x).total_cmp(&off(*y))).expect("there are some");
    [a, b]
}

/// In the middle where nothing is left that weighs anything.
fn gamma_of(volumes: [u64; 2]) -> f64 {
    if volumes == [0, 0] { 0.5 } else { volumes[1] as f64 / (volumes[0] as f64 + volumes[1] as f64) }
}

/// A pair for each of `gammas`, in their order: among the pairs of greatest weight where one comes near to it, else near to those. `weights`
/// are the cells', `[n_1]` and `[n_2]`: all 1 for the same volume each.
pub fn family(
    conflicts: &Conflicts,
    room: &[Bits; 2],
    weights: [&[u64]; 2],
    gammas: &[f64],
    options: &FamilyOptions,
    progress: &mut Progress<'_>,
) -> Result<Vec<Member>> {
    if !(0.0..1.0).contains(&options.gap) {
        return Err(Error::InvalidArgument(format!("the gap is {}; it must be in [0, 1)", number(options.gap))));
    }
    if let Some((i, g)) = gammas.iter().enumerate().find(|(_, g)| !(0.0..=1.0).contains(*g)) {
        return Err(Error::InvalidArgument(format!("gamma {i} is {}; it must be in [0, 1]", number(*g))));
    }
    check_room(conflicts, room)?;
    let all = weight_of_all(room, weights)?;
    let colliding = conflicts.colliding(room)?;
    let mut search = Search {
        options: *options,
        conflicts,
        room,
        weights,
        colliding,
        cuts: Vec::new(),
        found: Vec::new(),
        n_wanted: gammas.len(),
    };
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
    // Where the cells of a part that collide weigh nothing, there is one gamma.
    if let Some(end) =
        [(0, 1), (1, 0)].into_iter().find(|(part, _)| ends[*part].volumes[*part] == 0).map(|(_, end)| end)
    {
        wanted.iter().for_each(|g| search.put(*g, &ends[end]));
        wanted.clear();
    }
    let from = wanted.partition_point(|g| *g <= gamma_of(ends[0].volumes));
    let to = wanted.partition_point(|g| *g < gamma_of(ends[1].volumes)).max(from);
    wanted[..from].iter().for_each(|g| search.put(*g, &ends[0]));
    wanted[to..].iter().for_each(|g| search.put(*g, &ends[1]));
    search.between(&ends[0], &ends[1], &wanted[from..to], progress)?;
    let mut members = Vec::with_capacity(gammas.len());
    let has_idle = (0..2).any(|k| room[k].iter().any(|i| weights[k][i] == 0));
    for gamma in gammas {
        let mut member = search.found.iter().find(|m| m.wanted == *gamma).expect("each has been put").clone();
        member.bound = search.bound(*gamma);
        if has_idle {
            // Cells of weight 0 are on either side of a cut.
            member.pair = close(conflicts, room, Side::First, &member.pair.cells[0])?;
        }
        members.push(member);
    }
    Ok(members)
}

impl Search<'_> {
    fn corner(&self, pair: Pair) -> Corner {
        let volumes = pair.weigh_some(&self.colliding, self.weights);
        Corner { pair, volumes }
    }

    fn put(&mut self, wanted: f64, corner: &Corner) {
        let Corner { pair, volumes } = corner.clone();
        let gamma = if volumes == [0, 0] { f64::NAN } else { gamma_of(volumes) };
        self.found.push(Member { wanted, gamma, volumes, bound: f64::INFINITY, pair });
    }

    /// Finds pairs for the gammas `wanted`, in order, which lie between those of two corners.
    fn between(&mut self, low: &Corner, high: &Corner, wanted: &[f64], progress: &mut Progress<'_>) -> Result<()> {
        if wanted.is_empty() {
            return Ok(());
        }
        let w = self.across(low, high);
        if self.cuts.iter().any(|[w1, w2, _]| (*w1, *w2) == (w[0] as f64, w[1] as f64)) {
            // Rounded, they have been tried.
            return self.leap(low, high, wanted, None, progress).map(|_| ());
        }
        let weights = self.scaled(w)?;
        let near = self.conflicts.rows_of();
        let (near_k, far_k) = (near.index(), near.other().index());
        let (near_cells, far_cells) = (&self.colliding[near_k], &self.colliding[far_k]);
        let flow = Flow::new(self.conflicts, near_cells, &weights[near_k], far_cells, &weights[far_k])?;
        let (from, to) = self.share();
        let mut ties = progress.part(from, to, |part| Ties::new(flow, near_cells, far_cells, part))?;
        let all: u64 = (0..2).map(|k| self.colliding[k].iter().map(|i| weights[k][i]).sum::<u64>()).sum();
        self.cuts.push([w[0] as f64, w[1] as f64, (all - ties.flow()) as f64]);
        // The chain goes towards small gamma where part 1 grows.
        let first = self.of_ties(&ties);
        let (last, rest) = self.walk(&mut ties, near, &first, wanted, progress)?;
        let (least, most) = if near == Side::First { (&last, &first) } else { (&first, &last) };
        let from = rest.partition_point(|g| *g < gamma_of(least.volumes));
        for (low, high, wanted) in [(low, least, &rest[..from]), (most, high, &rest[from..])] {
            // What comes near enough to the bound as it is known now.
            let is_edge = weigh(w, low) == weigh(w, high);
            let left = if is_edge || low.volumes[0] <= high.volumes[0] || low.volumes[1] >= high.volumes[1] {
                self.leap(low, high, wanted, None, progress)?
            } else if self.options.gap == 0.0 {
                wanted.to_vec()
            } else {
                self.leap(low, high, wanted, Some(self.options.gap), progress)?
            };
            self.between(low, high, &left, progress)?;
        }
        Ok(())
    }

    /// The weights times `w`.
    fn scaled(&self, w: [u64; 2]) -> Result<[Vec<u64>; 2]> {
        let of = |k: usize| -> Result<Vec<u64>> {
            let mut all = try_with_capacity(self.weights[k].len(), "weights")?;
            all.extend(self.weights[k].iter().map(|x| x * w[k]));
            Ok(all)
        };
        Ok([of(0)?, of(1)?])
    }

    /// The fractions of the work between which a cut is told: by how many pairs have been found.
    fn share(&self) -> (f64, f64) {
        let of = |n: usize| 0.2 + 0.8 * n.min(self.n_wanted) as f64 / self.n_wanted as f64;
        (of(self.found.len()), of(self.found.len() + 1))
    }

    /// Weights across the line between two corners: what part 1 loses from one to the other weighs what part 2 gains.
    fn across(&self, low: &Corner, high: &Corner) -> [u64; 2] {
        let w = slope(low, high);
        if self.options.gap == 0.0 { w } else { rounded(w) }
    }

    /// What no pair of `gamma` weighs more than.
    fn bound(&self, gamma: f64) -> f64 {
        let bounds = self.cuts.iter().map(|[w1, w2, most]| most / (w1 * (1.0 - gamma) + w2 * gamma));
        bounds.filter(|b| b.is_finite()).fold(f64::INFINITY, f64::min)
    }

    /// Puts pairs between two corners where they are within `gap` of the bound, or all if that is not given; the gammas that are left.
    fn leap(
        &mut self,
        low: &Corner,
        high: &Corner,
        wanted: &[f64],
        gap: Option<f64>,
        progress: &mut Progress<'_>,
    ) -> Result<Vec<f64>> {
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        let near = self.conflicts.rows_of();
        let (few, many) = if near == Side::First { (high, low) } else { (low, high) };
        let Row { gained, lost, order } = self.row(few, many, near)?;
        let mut left = Vec::new();
        let mut proximal = None;
        for &g in wanted {
            let mut corner = self.within_leap(few, many, near, &order, g)?;
            let near_enough = |corner: &Corner, gap: f64| {
                let total = (corner.volumes[0] + corner.volumes[1]) as f64;
                total >= (1.0 - gap) * self.bound(gamma_of(corner.volumes))
            };
            if gap.is_some_and(|gap| !near_enough(&corner, gap)) {
                left.push(g);
                continue;
            }
            if gap.is_none() && !near_enough(&corner, self.options.gap) {
                let first = match &proximal {
                    Some(first) => first,
                    None => proximal.insert(Proximal::new(self.conflicts, gained.clone(), lost.clone(), &order)?),
                };
                let other = self.proximal(few, many, near, first, g, progress)?;
                let off = |c: &Corner| (gamma_of(c.volumes) - g).abs();
                if off(&other) <= LOOSE.max(off(&corner))
                    && other.volumes.iter().sum::<u64>() > corner.volumes.iter().sum()
                {
                    corner = other;
                }
            }
            self.put(g, &corner);
        }
        Ok(left)
    }

    /// What lies between two pairs.
    fn row(&self, few: &Corner, many: &Corner, near: Side) -> Result<Row> {
        let mut gained = many.pair.cells[near.index()].clone();
        gained.subtract(&few.pair.cells[near.index()]);
        let mut lost = few.pair.cells[near.other().index()].clone();
        lost.subtract(&many.pair.cells[near.other().index()]);
        let order = self.conflicts.by_distance(&gained, &lost)?;
        Ok(Row { gained, lost, order })
    }

    /// The pair nearest to `gamma` that proximal cuts find between two, of which `few` has fewer near cells; `first` is what lies between them. Where
    /// a weak pull leaps over it a stronger one goes on between the pairs beside it.
    fn proximal(
        &self,
        few: &Corner,
        many: &Corner,
        near: Side,
        first: &Proximal<'_>,
        gamma: f64,
        progress: &mut Progress<'_>,
    ) -> Result<Corner> {
        let off = |c: &Corner| (gamma_of(c.volumes) - gamma).abs();
        let w = rounded(if near == Side::First { slope(many, few) } else { slope(few, many) });
        let weights = self.scaled(w)?;
        let weights = [&weights[near.index()][..], &weights[near.other().index()]];
        let (mut few, mut many) = (few.clone(), many.clone());
        let mut best = if off(&few) <= off(&many) { few.clone() } else { many.clone() };
        let mut own;
        let mut between = first;
        for pull in PULLS {
            // Places are told apart to a hundredth of the row.
            let (mut from, mut to, apart) = (0, between.n_places(), between.n_places().div_ceil(100));
            let base = few.pair.cells[near.index()].clone();
            while off(&best) > LOOSE && to - from > apart {
                let place = (from + to) / 2;
                let mut set = base.clone();
                let (done, next) = self.share();
                set.unite(&progress.part(done, next, |part| between.cut(place, pull, weights, part))?);
                let corner = self.corner(close(self.conflicts, self.room, near, &set)?);
                if off(&corner) < off(&best) {
                    best = corner.clone();
                }
                if (gamma_of(corner.volumes) < gamma) == (near == Side::First) {
                    (to, many) = (place, corner);
                } else {
                    (from, few) = (place, corner);
                }
            }
            let Row { gained, lost, order } = self.row(&few, &many, near)?;
            if off(&best) <= LOOSE || order.len() < 2 {
                return Ok(best);
            }
            own = Proximal::new(self.conflicts, gained, lost, &order)?;
            between = &own;
        }
        let Row { order, .. } = self.row(&few, &many, near)?;
        self.within_leap(&few, &many, near, &order, gamma)
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
    fn walk(
        &mut self,
        ties: &mut Ties<'_>,
        near: Side,
        first: &Corner,
        wanted: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<(Corner, Vec<f64>)> {
        let (near_k, far_k) = (near.index(), near.other().index());
        let sign = if near == Side::First { -1.0 } else { 1.0 };
        // Gammas in the order in which the chain comes to them.
        let ahead = |g: f64, volumes: [u64; 2]| sign * (g - gamma_of(volumes));
        let mut rest: Vec<f64> = wanted.iter().copied().filter(|g| ahead(*g, first.volumes) < 0.0).collect();
        let mut coming: Vec<f64> = wanted.iter().copied().filter(|g| ahead(*g, first.volumes) >= 0.0).collect();
        if sign < 0.0 {
            coming.reverse();
        }
        let (mut next, mut volumes) = (0, first.volumes);
        let (mut gained, mut lost) = (Vec::new(), Vec::new());
        while ties.step(&mut gained, &mut lost)? {
            volumes[near_k] += gained.iter().map(|&i| self.weights[near_k][i]).sum::<u64>();
            volumes[far_k] -= lost.iter().map(|&j| self.weights[far_k][j]).sum::<u64>();
            let passed = coming[next..].iter().take_while(|g| ahead(**g, volumes) < 0.0).count();
            if passed == 0 {
                continue;
            }
            let after = self.of_ties(ties);
            let before = self.before(&after, near, &gained, &lost);
            let (low, high) = if near == Side::First { (&after, &before) } else { (&before, &after) };
            self.leap(low, high, &coming[next..next + passed], None, progress)?;
            next += passed;
        }
        let last = self.of_ties(ties);
        rest.extend(&coming[next..]);
        rest.sort_by(f64::total_cmp);
        Ok((last, rest))
    }

    /// The chain's pair before its last step.
    fn before(&self, after: &Corner, near: Side, gained: &[usize], lost: &[usize]) -> Corner {
        let mut pair = after.pair.clone();
        gained.iter().for_each(|&i| pair.cells[near.index()].remove(i));
        lost.iter().for_each(|&j| pair.cells[near.other().index()].insert(j));
        self.corner(pair)
    }

    /// The pair nearest to `gamma` among those that have some of the leap's cells, closed: by bisection.
    fn within_leap(&self, before: &Corner, after: &Corner, near: Side, gained: &[u32], gamma: f64) -> Result<Corner> {
        let off = |c: &Corner| (gamma_of(c.volumes) - gamma).abs();
        let mut best = if off(before) <= off(after) { before.clone() } else { after.clone() };
        let (mut few, mut many) = (0, gained.len());
        while many - few > 1 && off(&best) > NEAR {
            let middle = (few + many) / 2;
            let mut set = before.pair.cells[near.index()].clone();
            gained[..middle].iter().for_each(|&i| set.insert(i as usize));
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

/// Weights are rounded to fractions of numbers up to this.
const ROUND: u64 = 12;

/// Gammas nearer than this are as good as equal.
const NEAR: f64 = 1e-3;

/// And for proximal cuts, whose pairs weigh more.
const LOOSE: f64 = 2e-3;
