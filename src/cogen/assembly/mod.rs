//! Assemblies: any number of parts, each with its motion, none of which collides with another.
//!
//! Parts that come near each other have conflicts, found pair by pair; the sets of cells that can be together are the independent sets of all
//! these edges. Where parts can be given two colours so that those that meet differ, as in a train of gears, the graph is bipartite and one
//! minimum cut gives the best; three parts that meet each other make it another one, for which the best is hard to find. Then:
//!
//! - **Bound.** Of all x_u in [0, 1] with x_u + x_v <= 1 for cells in conflict those of greatest weight bound all sets from above. They are half of
//!   what a minimum cut leaves of the double cover, which has every cell on both sides and each edge both ways (Nemhauser and Trotter 1975).
//!   However weights are split among pairs of parts, the sum of the pairs' cuts is no smaller: a pair's graph is bipartite, so its cut is the
//!   greatest over those x, with its share of the weights, and one x serves all pairs.
//! - **Certain cells.** Where that x is 1 cells are in a set of greatest weight, and their neighbours are not: only cells at 1/2 are looked at.
//! - **Alternating cuts.** A team of parts that takes two colours gets the best that the others leave room for, by a cut, then the next team;
//!   what they have now is among what they could have, so no cut loses weight, and it ends when none gains.
//! - **Closure.** Each part in turn takes all that the others leave: none collides, none can grow.

use super::bits::Bits;
use super::conflict::{Conflicts, OverlapOptions, Side};
use super::cut::{cut, weight_of_all};
use super::foresight::Limit;
use super::frozen;
use super::grid::MOST_CELLS;
use super::motion::Motion;
use super::parcels::{Room, each_block, n_blocks};
use super::part::Part;
use super::rows::{Block, Rows};
use super::steps::Relative;
use super::swept_box::swept_boxes;
use crate::error::try_with_capacity;
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
use std::ops::Range;

/// Parts, and which of their cells conflict.
#[derive(Debug)]
pub struct Assembly {
    /// Numbers of each part's cells among all.
    cells: Vec<Range<usize>>,
    /// Pairs of parts that meet, each with the smaller number first.
    meetings: Vec<[usize; 2]>,
    graph: Conflicts,
}

/// How long cuts alternate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArrangeOptions {
    /// How often every team is given a cut, at most.
    pub max_rounds: usize,
    /// Teams that may be the first, each of which leads to a result of its own; at most.
    pub max_starts: usize,
}

impl Default for ArrangeOptions {
    fn default() -> Self {
        ArrangeOptions { max_rounds: 20, max_starts: 4 }
    }
}

/// Parts that never collide and of which none can grow.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Arrangement {
    /// The cells of each part.
    pub cells: Vec<Bits>,
    /// What they weigh.
    pub weight: u64,
    /// No parts that never collide weigh more: at most `bound - weight` is lost.
    pub bound: u64,
    /// Cuts that it took.
    pub n_cuts: usize,
}

impl Assembly {
    /// Conflicts of all pairs of `parts`, which move by `motions`: see [`Conflicts::of_overlap`]. Pairs whose swept boxes never meet have none.
    ///
    /// `max_bytes` holds for the graphs of pairs and for that of all beside them. The error tells of frozen cells that collide, and when and where.
    pub fn of_overlap<const D: usize>(
        parts: &[&Part<D>],
        motions: &[Motion<D>],
        options: &OverlapOptions,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        if parts.len() != motions.len() {
            let text = format!("{} motions for {} parts; it must be one for each", motions.len(), parts.len());
            return Err(Error::InvalidArgument(text));
        }
        let n_cells: Vec<usize> = parts.iter().map(|p| p.grid().n_cells()).collect();
        // What is put together takes as much as the pairs' graphs.
        let mut left = options.max_bytes / 2;
        let mut graphs = Vec::new();
        let boxes = swept_boxes(parts, motions, options.clearance)?;
        let meetings: Vec<[usize; 2]> = boxes.meetings().collect();
        // The last tenth of what is told is the putting together.
        let share = |k: usize| 0.9 * k as f64 / meetings.len() as f64;
        for (k, &[i, j]) in meetings.iter().enumerate() {
            let relative = Relative { from: motions[i].clone(), of: motions[j].clone() };
            let of_pair = OverlapOptions { max_bytes: left, ..*options };
            let look = |part: &mut Progress<'_>| Conflicts::of_overlap([parts[i], parts[j]], &relative, &of_pair, part);
            let graph = progress.part(share(k), share(k + 1), look)?;
            frozen::check(&graph, [parts[i], parts[j]], &relative, [i, j])?;
            left = left.saturating_sub(graph.bytes() as u64);
            graphs.push(([i, j], graph));
        }
        let workers = Workers::new(options.n_threads)?;
        // Beside the graphs of pairs, until it is made.
        let taken: u64 = graphs.iter().map(|(_, graph)| graph.bytes() as u64).sum();
        let most = options.max_bytes.saturating_sub(taken);
        progress.part(0.9, 1.0, |part| Assembly::of_graphs(&n_cells, &graphs, most, &workers, part))
    }

    /// The assembly of parts of as many cells, with the graphs of pairs i < j of them, part i being the graph's first; without one, parts never
    /// collide.
    pub fn of_graphs(
        n_cells: &[usize],
        graphs: &[([usize; 2], Conflicts)],
        max_bytes: u64,
        workers: &Workers,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        let mut cells: Vec<Range<usize>> = Vec::with_capacity(n_cells.len());
        let mut n_all = 0;
        for &n in n_cells {
            cells.push(n_all..n_all + n);
            n_all += n;
        }
        if n_all > MOST_CELLS {
            return Err(Error::InvalidArgument(format!("the parts have {n_all} cells; they may have {MOST_CELLS}")));
        }
        // To each part its graphs, by the other part.
        let mut of_part: Vec<Vec<(usize, &Rows)>> = vec![Vec::new(); n_cells.len()];
        for ([i, j], graph) in graphs {
            let fits = i < j && *j < n_cells.len() && [*i, *j].map(|k| n_cells[k]) == SIDES.map(|s| graph.n_cells(s));
            if !fits {
                return Err(Error::InvalidArgument(format!(
                    "a graph of {} and {} cells is no graph of parts {i} and {j} of the {}",
                    graph.n_cells(Side::First),
                    graph.n_cells(Side::Second),
                    n_cells.len()
                )));
            }
            if of_part[*i].iter().any(|(other, _)| other == j) {
                return Err(Error::InvalidArgument(format!("parts {i} and {j} have two graphs; they may have one")));
            }
            let (first, second) = graph.by_side();
            of_part[*i].push((*j, first));
            of_part[*j].push((*i, second));
        }
        of_part.iter_mut().for_each(|of| of.sort_by_key(|(other, _)| *other));
        let mut blocks: Vec<Block> = try_with_capacity(n_blocks(n_all), "the assembly's graph")?;
        let mut room = Room::new(Limit::of("the assembly's graph", max_bytes), n_all);
        let make = |rows: Range<usize>| -> Result<Block> {
            let mut block = Block::new()?;
            for u in rows {
                let part = part_of(&cells, u);
                block.push_row(|run| {
                    of_part[part].iter().try_for_each(|(other, rows)| {
                        let from = cells[*other].start;
                        rows.iter(u - cells[part].start)
                            .filter(|r| !r.is_empty())
                            .try_for_each(|r| run(from + r.start..from + r.end))
                    })
                })?;
            }
            Ok(block.settled())
        };
        each_block(n_all, workers, progress, "the assembly's graph", make, |block| {
            room.take(block.bytes())?;
            blocks.push(block);
            Ok(())
        })?;
        let mut meetings: Vec<[usize; 2]> =
            graphs.iter().filter(|(_, g)| g.n_edges() > 0).map(|(pair, _)| *pair).collect();
        meetings.sort_unstable();
        Ok(Assembly { cells, meetings, graph: Conflicts::of_all(Rows::new(blocks), n_all) })
    }

    /// Parts.
    pub fn n_parts(&self) -> usize {
        self.cells.len()
    }

    /// Cells of a part's grid.
    pub fn n_cells(&self, part: usize) -> usize {
        self.cells[part].len()
    }

    /// Pairs of parts of which some cells conflict, each with the smaller number first.
    pub fn meetings(&self) -> &[[usize; 2]] {
        &self.meetings
    }

    /// Pairs of cells that conflict.
    pub fn n_edges(&self) -> usize {
        self.graph.n_edges() / 2
    }

    /// Bytes that the graph takes.
    pub fn bytes(&self) -> usize {
        self.graph.rows().bytes()
    }

    /// The cells that each part may have beside those that the others must: see [`room`](super::room).
    pub fn room<const D: usize>(&self, parts: &[&Part<D>]) -> Result<Vec<Bits>> {
        let frozen = self.joined(&parts.iter().map(|p| p.frozen()).collect::<Vec<_>>(), "frozen cells")?;
        let taken = self.graph.neighbours(Side::First, &frozen)?;
        let mut both = taken.clone();
        both.intersect(&frozen);
        if let Some(u) = both.iter().next() {
            let one = Bits::of(taken.len(), |v| v == u)?;
            let mut other = self.graph.neighbours(Side::First, &one)?;
            other.intersect(&frozen);
            let (v, name) = (other.iter().next().unwrap_or(u), |u: usize| {
                let part = part_of(&self.cells, u);
                format!("frozen cell {} of part {part}", u - self.cells[part].start)
            });
            return Err(Error::InvalidArgument(format!("{} collides with {}", name(u), name(v))));
        }
        let mut room = self.joined(&parts.iter().map(|p| p.allowed()).collect::<Vec<_>>(), "allowed cells")?;
        room.subtract(&taken);
        self.parted(&room)
    }

    /// From parts that may collide to parts that do not, and of which none can grow: part by part in the order `order`, each keeps of what
    /// it has in `sets` what those before it leave; then all take up what is left.
    pub fn close(&self, room: &[&Bits], sets: &[&Bits], order: &[usize]) -> Result<Vec<Bits>> {
        let mut sorted = order.to_vec();
        sorted.sort_unstable();
        if sorted != (0..self.n_parts()).collect::<Vec<_>>() {
            let text = format!("the order {order:?} does not name each of {} parts once", self.n_parts());
            return Err(Error::InvalidArgument(text));
        }
        let (room, sets) = (self.joined(room, "room")?, self.joined(sets, "cells")?);
        let (mut kept, mut taken) = (Bits::none(room.len())?, Bits::none(room.len())?);
        for &part in order {
            let mut own = self.only(&sets, part)?;
            own.intersect(&room);
            own.subtract(&taken);
            taken.unite(&self.graph.neighbours(Side::First, &own)?);
            kept.unite(&own);
        }
        self.fill(&room, &mut kept, order)?;
        self.parted(&kept)
    }

    /// Parts within `room` that never collide, of great weight; `weights` are those of each part's cells. The heaviest there are where parts that
    /// meet take two colours; else `bound` tells what may be missing.
    pub fn arrange(
        &self,
        room: &[&Bits],
        weights: &[&[u64]],
        options: &ArrangeOptions,
        progress: &mut Progress<'_>,
    ) -> Result<Arrangement> {
        for (name, n) in [("rounds", options.max_rounds), ("starts", options.max_starts)] {
            if n == 0 {
                return Err(Error::InvalidArgument(format!("0 {name}; it must be 1 at least")));
            }
        }
        let weights = self.joined_weights(weights)?;
        let room = self.joined(room, "room")?;
        // The double cover: what it weighs is below 2^64.
        let both = [room.clone(), room];
        weight_of_all(&both, [&weights, &weights])?;
        let whole = progress.part(0.0, 0.5, |part| cut(&self.graph, &both, [&weights, &weights], part))?;
        let [room, _] = both;
        let bound = whole.weight / 2;
        let [certain, mut open] = whole.pair.cells;
        // Certain are the cells that are on both sides; 1/2 those that are on one. The cut with the fewest on the first side has none there alone.
        debug_assert!(certain.iter().all(|u| open.has(u)));
        open.subtract(&certain);
        let search = Search { assembly: self, room, certain, open, weights, teams: self.teams()? };
        let mut best: Option<(Bits, u64)> = None;
        let mut n_cuts = 1;
        let n_starts = search.teams.len().clamp(1, options.max_starts);
        let share = |start: usize| 0.5 + 0.5 * start as f64 / n_starts as f64;
        for start in 0..n_starts {
            let alternate = |part: &mut Progress<'_>| search.alternate(start, options.max_rounds, &mut n_cuts, part);
            let kept = progress.part(share(start), share(start + 1), alternate)?;
            let weight = kept.iter().map(|u| search.weights[u]).sum();
            if best.as_ref().is_none_or(|(_, most)| weight > *most) {
                best = Some((kept, weight));
            }
            if weight == bound {
                break;
            }
        }
        let (kept, weight) = best.expect("there is a start");
        Ok(Arrangement { cells: self.parted(&kept)?, weight, bound, n_cuts })
    }

    /// Parts in two colours, so that none meets another of its colour: for each part the most that are found from it on. Each once.
    fn teams(&self) -> Result<Vec<[Bits; 2]>> {
        let n = self.n_parts();
        let meets = |i: usize, j: usize| self.meetings.binary_search(&[i.min(j), i.max(j)]).is_ok();
        let mut teams: Vec<Vec<Option<usize>>> = Vec::new();
        for first in 0..n {
            let mut colours: Vec<Option<usize>> = vec![None; n];
            // Those that meet the team so far, as they are found, then what meets nothing of it.
            let (mut waits, mut seen) = (vec![first], vec![false; n]);
            waits.extend((0..n).filter(|&k| k != first));
            seen[first] = true;
            while !waits.is_empty() {
                let at = waits.iter().position(|&k| seen[k]).unwrap_or(0);
                let k = waits.remove(at);
                let met: Vec<usize> = (0..n).filter(|&j| meets(k, j)).collect();
                let against = |c: usize| met.iter().any(|&j| colours[j] == Some(c));
                colours[k] = (0..2).find(|&c| !against(c));
                if colours[k].is_some() {
                    met.iter().for_each(|&j| seen[j] = true);
                }
            }
            // The same team with colours changed is the same.
            let flipped: Vec<_> = colours.iter().map(|c| c.map(|c| 1 - c)).collect();
            if !teams.contains(&colours) && !teams.contains(&flipped) {
                teams.push(colours);
            }
        }
        let of = |team: &Vec<Option<usize>>, c: usize| -> Result<Bits> {
            let mut cells = Bits::none(self.graph.n_cells(Side::First))?;
            (0..n).filter(|&k| team[k] == Some(c)).for_each(|k| cells.insert_range(self.cells[k].clone()));
            Ok(cells)
        };
        teams.iter().map(|team| Ok([of(team, 0)?, of(team, 1)?])).collect()
    }

    /// Each part in turn takes all that the others leave it.
    fn fill(&self, room: &Bits, kept: &mut Bits, order: &[usize]) -> Result<()> {
        for &part in order {
            let mut own = self.only(room, part)?;
            own.subtract(&self.graph.neighbours(Side::First, kept)?);
            kept.unite(&own);
        }
        Ok(())
    }

    /// Those of `set` that are of one part.
    fn only(&self, set: &Bits, part: usize) -> Result<Bits> {
        let mut own = Bits::none(set.len())?;
        own.insert_range(self.cells[part].clone());
        own.intersect(set);
        Ok(own)
    }

    fn joined(&self, sets: &[&Bits], what: &str) -> Result<Bits> {
        self.check(sets.iter().map(|s| s.len()), what)?;
        let mut all = Bits::none(self.graph.n_cells(Side::First))?;
        for (set, cells) in sets.iter().zip(&self.cells) {
            set.iter().for_each(|i| all.insert(cells.start + i));
        }
        Ok(all)
    }

    fn joined_weights(&self, weights: &[&[u64]]) -> Result<Vec<u64>> {
        self.check(weights.iter().map(|w| w.len()), "weights")?;
        let mut all = try_with_capacity(self.graph.n_cells(Side::First), "weights")?;
        weights.iter().for_each(|w| all.extend_from_slice(w));
        Ok(all)
    }

    fn parted(&self, all: &Bits) -> Result<Vec<Bits>> {
        self.cells.iter().map(|cells| Bits::of(cells.len(), |i| all.has(cells.start + i))).collect()
    }

    fn check(&self, lengths: impl ExactSizeIterator<Item = usize>, what: &str) -> Result<()> {
        if lengths.len() != self.n_parts() {
            let text = format!("{what} of {} parts; the assembly has {}", lengths.len(), self.n_parts());
            return Err(Error::InvalidArgument(text));
        }
        for (k, (n, cells)) in lengths.zip(&self.cells).enumerate() {
            if n != cells.len() {
                return Err(Error::InvalidArgument(format!("{what}: {n} for part {k}'s {} cells", cells.len())));
            }
        }
        Ok(())
    }
}

const SIDES: [Side; 2] = [Side::First, Side::Second];

/// The part that a cell, by its number among all, is of.
fn part_of(cells: &[Range<usize>], u: usize) -> usize {
    cells.partition_point(|c| c.end <= u)
}

/// What all starts share.
struct Search<'a> {
    assembly: &'a Assembly,
    room: Bits,
    /// Cells of a set of greatest weight.
    certain: Bits,
    /// Cells of which nothing is known, and none of which conflicts with a certain one.
    open: Bits,
    weights: Vec<u64>,
    teams: Vec<[Bits; 2]>,
}

impl Search<'_> {
    /// Cuts for each team in turn from `start` on, until none gains, then closure.
    fn alternate(
        &self,
        start: usize,
        max_rounds: usize,
        n_cuts: &mut usize,
        progress: &mut Progress<'_>,
    ) -> Result<Bits> {
        let graph = &self.assembly.graph;
        let weigh = |set: &Bits| set.iter().map(|u| self.weights[u]).sum::<u64>();
        let mut kept = Bits::none(self.open.len())?;
        let (mut since_gain, n_teams) = (0, self.teams.len());
        for k in 0..max_rounds.saturating_mul(n_teams) {
            if since_gain == n_teams || self.open.count() == 0 {
                break;
            }
            let team = &self.teams[(start + k) % n_teams];
            let mut others = kept.clone();
            team.iter().for_each(|colour| others.subtract(colour));
            let taken = graph.neighbours(Side::First, &others)?;
            let of = |colour: &Bits| {
                let mut room = self.open.clone();
                room.intersect(colour);
                room.subtract(&taken);
                room
            };
            let found = cut(graph, &[of(&team[0]), of(&team[1])], [&self.weights, &self.weights], progress)?;
            *n_cuts += 1;
            let [mut next, other] = found.pair.cells;
            next.unite(&other);
            next.unite(&others);
            since_gain += 1;
            // Without a gain what there is stays: cuts of one weight could follow each other forever.
            if weigh(&next) > weigh(&kept) {
                kept = next;
                // This team has nothing to gain until another does.
                since_gain = 1;
            }
        }
        kept.unite(&self.certain);
        let order: Vec<usize> = (0..self.assembly.n_parts()).collect();
        self.assembly.fill(&self.room, &mut kept, &order)?;
        Ok(kept)
    }
}

#[cfg(test)]
mod tests;
