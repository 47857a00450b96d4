//! Among pairs of one weight, those that keep in touch.
//!
//! The cut leaves many pairs of the greatest weight: its ties (`ties`), components that are each added or not, if what they need is added with
//! them. Weight does not tell these pairs apart; how well they touch over the motion does. Of a gap g at each of the times, persistence is the mean
//! of 1 / (1 + g / h): 1 where the parts never part, 1/2 where they are always h from each other. It is looked for where the gap is largest: ties
//! around that place are added or taken away, a few or many at a time, and what raises persistence stays.

use super::bits::Bits;
use super::closure::{Pair, close};
use super::conflict::{Conflicts, Side};
use super::contact::{Contact, contact};
use super::cut::weight_of_all;
use super::flow::Flow;
use super::grid::Grid;
use super::steps::Relative;
use super::ties::Ties;
use crate::error::{try_reserve, try_vec, try_with_capacity};
use crate::geometry::vec::{norm, number, sub};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// How persistence is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersistenceOptions {
    /// Times at which gaps are measured.
    pub n_times: usize,
    /// h, in the caller's units; 0 for the edge of the larger of both parts' cells.
    pub scale: f64,
    /// Pairs that are tried, at most.
    pub max_tries: usize,
    /// gamma of the pairs, from and to: V_2 / (V_1 + V_2) of what is left of the colliding cells, as in (37d).
    pub gammas: [f64; 2],
}

impl Default for PersistenceOptions {
    fn default() -> Self {
        PersistenceOptions { n_times: 200, scale: 0.0, max_tries: 100, gammas: [0.0, 1.0] }
    }
}

/// What was found.
#[derive(Debug, Clone)]
pub struct Persistent<const D: usize> {
    /// The pair.
    pub pair: Pair,
    /// Persistence of the pair that the search began with.
    pub before: f64,
    /// That of the pair.
    pub after: f64,
    /// Its gaps.
    pub contact: Contact<D>,
    /// Pairs that were tried.
    pub n_tries: usize,
}

/// Persistence of gaps, for h = `scale`.
pub fn persistence<const D: usize>(contact: &Contact<D>, scale: f64) -> f64 {
    contact.gaps.iter().map(|g| 1.0 / (1.0 + g.distance / scale)).sum::<f64>() / contact.gaps.len() as f64
}

impl PersistenceOptions {
    fn checked_scale<const D: usize>(&self, grids: [&Grid<D>; 2]) -> Result<f64> {
        let [from, to] = self.gammas;
        if !(0.0 <= from && from <= to && to <= 1.0) {
            let [from, to] = self.gammas.map(number);
            return Err(Error::InvalidArgument(format!(
                "gammas from {from} to {to}; they must be in [0, 1], in order"
            )));
        }
        if !(self.scale >= 0.0 && self.scale.is_finite()) {
            let text = format!("a scale of {}; it must be above 0, or 0 for a cell's edge", number(self.scale));
            return Err(Error::InvalidArgument(text));
        }
        Ok(if self.scale > 0.0 { self.scale } else { grids[0].cell().max(grids[1].cell()) })
    }
}

/// A pair of the same weight as `start` that is more persistent, as far as it is found. `start` is one of the greatest weight within `room`: a
/// cut's, or one of a family whose weights were these. Each try measures the gaps once.
#[expect(clippy::too_many_arguments, reason = "a search over a motion, among pairs of a graph")]
pub fn more_persistent<const D: usize>(
    grids: [&Grid<D>; 2],
    conflicts: &Conflicts,
    room: &[Bits; 2],
    weights: [&[u64]; 2],
    relative: &Relative<D>,
    start: &Pair,
    options: &PersistenceOptions,
    workers: &Workers,
    progress: &mut Progress<'_>,
) -> Result<Persistent<D>> {
    let scale = options.checked_scale(grids)?;
    let ties = progress.part(0.0, 0.3, |part| Lattice::new(conflicts, room, weights, start, part))?;
    let mut state = State { pair: start.clone(), taken: ties.taken(start)? };
    let gaps = |pair: &Pair| contact(grids, pair, relative, options.n_times, workers, &mut Progress::silent());
    let mut now = gaps(&state.pair)?;
    let mut score = persistence(&now, scale);
    let (before, mut n_tries) = (score, 0);
    'search: loop {
        // The largest gaps first.
        let mut times: Vec<usize> = (0..now.gaps.len()).collect();
        times.sort_by(|&a, &b| now.gaps[b].distance.total_cmp(&now.gaps[a].distance).then(a.cmp(&b)));
        for &k in times.iter().step_by((times.len() / PLACES).max(1)).take(PLACES) {
            let gap = now.gaps[k];
            let ways = ties.ways(grids, gap.place, relative.at(gap.time).apply_inverse(gap.place))?;
            let least = ways.iter().copied().fold(f64::INFINITY, f64::min);
            for cells in RADII {
                let near: Vec<usize> = (0..ways.len()).filter(|&c| ways[c] <= least + cells * scale).collect();
                for change in [true, false] {
                    let Some(next) = ties.changed(&state, &near, change)? else { continue };
                    if !ties.is_within(&next.pair, options.gammas) || next.pair.cells.iter().any(|c| c.count() == 0) {
                        continue;
                    }
                    if n_tries == options.max_tries {
                        break 'search;
                    }
                    n_tries += 1;
                    progress.tell(0.3 + 0.7 * n_tries as f64 / options.max_tries as f64, "persistent contact")?;
                    let tried = gaps(&next.pair)?;
                    let better = persistence(&tried, scale);
                    if better > score {
                        (state, now, score) = (next, tried, better);
                        continue 'search;
                    }
                }
            }
        }
        break;
    }
    Ok(Persistent { pair: state.pair, before, after: score, contact: now, n_tries })
}

/// Places at which changes are tried, from that of the largest gap on.
const PLACES: usize = 8;

/// Ties are changed within this many times h around a place, beyond the nearest: the nearest alone as well.
const RADII: [f64; 4] = [0.0, 3.0, 10.0, 30.0];

/// No tie.
const NONE: u32 = u32::MAX;

/// A pair, and which ties it has taken.
struct State {
    pair: Pair,
    taken: Vec<bool>,
}

/// All pairs of the greatest weight.
struct Lattice<'a> {
    conflicts: &'a Conflicts,
    room: &'a [Bits; 2],
    near: Side,
    /// Near cells that each tie gains, far ones that it loses.
    ties: Vec<[Vec<u32>; 2]>,
    /// The tie of each near cell, and of each far one.
    tie_of: [Vec<u32>; 2],
    weights: [&'a [u64]; 2],
    /// Cells that collide with any of the other part.
    colliding: [Bits; 2],
    /// Whether there are cells of weight 0, which are in no tie.
    has_idle: bool,
}

impl<'a> Lattice<'a> {
    fn new(
        conflicts: &'a Conflicts,
        room: &'a [Bits; 2],
        weights: [&'a [u64]; 2],
        start: &Pair,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        let all = weight_of_all(room, weights)?;
        if close(conflicts, room, Side::First, &start.cells[0])? != *start {
            let text = "the pair collides, could grow, or has cells that a part may not have; it must be one of a cut or of a closure";
            return Err(Error::InvalidArgument(text.into()));
        }
        let near = conflicts.rows_of();
        let (n, f) = (near.index(), near.other().index());
        let flow = Flow::new(conflicts, &room[n], weights[n], &room[f], weights[f])?;
        let mut chain = Ties::new(flow, &room[n], &room[f], progress)?;
        let (weight, most) = (start.weigh(weights).iter().sum::<u64>(), all - chain.flow());
        if weight != most {
            return Err(Error::InvalidArgument(format!(
                "the pair weighs {weight}, and the greatest weight is {most}: contact tells pairs of that weight apart"
            )));
        }
        let mut ties = Vec::new();
        let mut tie_of = [try_vec(room[n].len(), NONE, "ties")?, try_vec(room[f].len(), NONE, "ties")?];
        let (mut gained, mut lost) = (Vec::new(), Vec::new());
        while chain.step(&mut gained, &mut lost)? {
            try_reserve(&mut ties, 1, "ties")?;
            for (of, cells) in tie_of.iter_mut().zip([&gained, &lost]) {
                cells.iter().for_each(|&i| of[i] = ties.len() as u32);
            }
            let of = |cells: &[usize]| -> Result<Vec<u32>> {
                let mut numbers = try_with_capacity(cells.len(), "ties")?;
                numbers.extend(cells.iter().map(|&i| i as u32));
                Ok(numbers)
            };
            ties.push([of(&gained)?, of(&lost)?]);
        }
        let colliding = conflicts.colliding(room)?;
        let has_idle = (0..2).any(|k| room[k].iter().any(|i| weights[k][i] == 0));
        Ok(Lattice { conflicts, room, near, ties, tie_of, weights, colliding, has_idle })
    }

    /// Which ties a pair has taken: those whose near cells it has.
    fn taken(&self, pair: &Pair) -> Result<Vec<bool>> {
        let near = &pair.cells[self.near.index()];
        let mut taken = try_vec(self.ties.len(), false, "ties")?;
        for (taken, [gained, _]) in taken.iter_mut().zip(&self.ties) {
            *taken = gained.iter().any(|&i| near.has(i as usize));
        }
        Ok(taken)
    }

    /// Distances from a place, given in both parts' frames, to the nearest cell of each tie.
    fn ways<const D: usize>(&self, grids: [&Grid<D>; 2], first: [f64; D], second: [f64; D]) -> Result<Vec<f64>> {
        let sides = [self.near, self.near.other()];
        let mut ways = try_vec(self.ties.len(), f64::INFINITY, "ties")?;
        for (way, tie) in ways.iter_mut().zip(&self.ties) {
            for (cells, side) in tie.iter().zip(sides) {
                let (grid, place) = (grids[side.index()], if side == Side::First { first } else { second });
                let each = cells.iter().map(|&i| norm(sub(grid.center(i as usize), place)));
                *way = each.fold(*way, f64::min);
            }
        }
        Ok(ways)
    }

    /// The pair that has taken `ties` as well, with all that they need, or has none of them, nor what needs them; none if it is no other.
    fn changed(&self, state: &State, ties: &[usize], take: bool) -> Result<Option<State>> {
        let mut next = State { pair: state.pair.clone(), taken: state.taken.clone() };
        let [near, far] = [self.near, self.near.other()].map(Side::index);
        let mut stack: Vec<usize> = ties.iter().copied().filter(|&c| next.taken[c] != take).collect();
        if stack.is_empty() {
            return Ok(None);
        }
        stack.iter().for_each(|&c| next.taken[c] = take);
        while let Some(c) = stack.pop() {
            let [gained, lost] = &self.ties[c];
            // What comes in, and the ties of what cannot be there with it.
            let (coming, lists, of) = if take {
                (gained, self.conflicts.rows(), &self.tie_of[1])
            } else {
                (lost, self.conflicts.columns(), &self.tie_of[0])
            };
            for &i in coming {
                for j in lists.iter(i as usize).flatten() {
                    let tie = of[j] as usize;
                    if of[j] != NONE && next.taken[tie] != take {
                        try_reserve(&mut stack, 1, "ties")?;
                        next.taken[tie] = take;
                        stack.push(tie);
                    }
                }
            }
            for &i in gained {
                let cells = &mut next.pair.cells[near];
                if take { cells.insert(i as usize) } else { cells.remove(i as usize) }
            }
            for &j in lost {
                let cells = &mut next.pair.cells[far];
                if take { cells.remove(j as usize) } else { cells.insert(j as usize) }
            }
        }
        if self.has_idle {
            next.pair = close(self.conflicts, self.room, Side::First, &next.pair.cells[0])?;
        }
        Ok(Some(next))
    }

    /// Whether gamma of a pair is in a range.
    fn is_within(&self, pair: &Pair, gammas: [f64; 2]) -> bool {
        let volumes = pair.weigh_some(&self.colliding, self.weights).map(|v| v as f64);
        (gammas[0]..=gammas[1]).contains(&(volumes[1] / (volumes[0] + volumes[1])))
    }
}

#[cfg(test)]
mod tests {
    use super::super::conflict::OverlapOptions;
    use super::super::cut::cut;
    use super::super::motion::{Law, Motion};
    use super::super::part::Part;
    use super::*;
    use std::f64::consts::TAU;

    struct Gears {
        grids: [Grid<2>; 2],
        conflicts: Conflicts,
        room: [Bits; 2],
        relative: Relative<2>,
        weights: [Vec<u64>; 2],
    }

    /// Squares of n^2 cells that turn against each other.
    fn gears(n: usize, turns: f64) -> Gears {
        let square = |x: f64| Part::whole(Grid::new([x - 0.5, -0.5], 1.0 / n as f64, [n, n]).unwrap()).unwrap();
        let turn = |x: f64, turns: f64| Motion::turn([x, 0.0], Law::even(turns * TAU)).unwrap();
        let parts = [square(0.0), square(1.0)];
        let relative = Relative { from: turn(0.0, turns), of: turn(1.0, -turns) };
        let options = OverlapOptions::default();
        let conflicts =
            Conflicts::of_overlap([&parts[0], &parts[1]], &relative, &options, &mut Progress::silent()).unwrap();
        let room = parts.each_ref().map(|p| p.allowed().clone());
        Gears { grids: parts.map(|p| *p.grid()), conflicts, room, relative, weights: [vec![1; n * n], vec![1; n * n]] }
    }

    impl Gears {
        fn weights(&self) -> [&[u64]; 2] {
            [&self.weights[0], &self.weights[1]]
        }

        fn best(&self) -> Pair {
            cut(&self.conflicts, &self.room, self.weights(), &mut Progress::silent()).unwrap().pair
        }

        fn search(&self, start: &Pair, options: &PersistenceOptions) -> Result<Persistent<2>> {
            let (workers, silent) = (Workers::caller_only(), &mut Progress::silent());
            let Gears { grids: [one, two], conflicts, room, relative, .. } = self;
            more_persistent([one, two], conflicts, room, self.weights(), relative, start, options, &workers, silent)
        }

        fn gamma(&self, pair: &Pair) -> f64 {
            let v = [Side::First, Side::Second].map(|s| {
                let mut cells = self.conflicts.neighbours(s.other(), &self.room[s.other().index()]).unwrap();
                cells.intersect(&pair.cells[s.index()]);
                cells.count() as f64
            });
            v[1] / (v[0] + v[1])
        }
    }

    #[test]
    fn pairs_of_the_same_weight_come_to_touch_better() {
        let gears = gears(40, 1.0);
        let start = gears.best();
        let options = PersistenceOptions { n_times: 60, ..PersistenceOptions::default() };
        let found = gears.search(&start, &options).unwrap();
        assert!(
            found.after > found.before + 0.02 && found.n_tries > 0,
            "{} {} {}",
            found.before,
            found.after,
            found.n_tries
        );
        assert_eq!(persistence(&found.contact, 1.0 / 40.0), found.after);
        let again = contact(
            gears.grids.each_ref(),
            &found.pair,
            &gears.relative,
            60,
            &Workers::caller_only(),
            &mut Progress::silent(),
        );
        assert_eq!(persistence(&again.unwrap(), 1.0 / 40.0), found.after);
        // As heavy, free of collisions, and maximal.
        assert_eq!(found.pair.weigh(gears.weights()).iter().sum::<u64>(), start.weigh(gears.weights()).iter().sum());
        let closed = close(&gears.conflicts, &gears.room, Side::First, &found.pair.cells[0]).unwrap();
        assert_eq!(closed, found.pair);
        let mut met = gears.conflicts.neighbours(Side::First, &found.pair.cells[0]).unwrap();
        met.intersect(&found.pair.cells[1]);
        assert_eq!(met.count(), 0);

        let options = PersistenceOptions { gammas: [0.3, 0.7], ..options };
        let middle = gears.search(&found.pair, &options).unwrap();
        assert!(middle.before == found.after && middle.after >= middle.before);
        let gamma = gears.gamma(&middle.pair);
        assert!(middle.pair == found.pair || (0.3..=0.7).contains(&gamma), "{gamma}");
    }

    /// All pairs of the greatest weight, by taking away and adding single ties from any on.
    #[test]
    fn the_search_stays_among_the_pairs_of_the_greatest_weight() {
        let gears = gears(8, 0.25);
        let start = gears.best();
        let silent = &mut Progress::silent();
        let lattice = Lattice::new(&gears.conflicts, &gears.room, gears.weights(), &start, silent).unwrap();
        assert!(lattice.ties.len() > 2, "{}", lattice.ties.len());
        let mut all = vec![State { taken: lattice.taken(&start).unwrap(), pair: start.clone() }];
        let mut k = 0;
        while k < all.len() && all.len() < 3000 {
            for c in 0..lattice.ties.len() {
                for take in [true, false] {
                    if let Some(next) = lattice.changed(&all[k], &[c], take).unwrap()
                        && all.iter().all(|s| s.pair != next.pair)
                    {
                        let mut met = gears.conflicts.neighbours(Side::First, &next.pair.cells[0]).unwrap();
                        met.intersect(&next.pair.cells[1]);
                        assert_eq!(met.count(), 0);
                        let weight = |p: &Pair| p.weigh(gears.weights()).iter().sum::<u64>();
                        assert_eq!(weight(&next.pair), weight(&start));
                        assert_eq!(lattice.taken(&next.pair).unwrap(), next.taken);
                        all.push(next);
                    }
                }
            }
            k += 1;
        }
        let options = PersistenceOptions { n_times: 20, max_tries: 1000, ..PersistenceOptions::default() };
        let found = gears.search(&start, &options).unwrap();
        let scores: Vec<f64> = all
            .iter()
            .filter(|s| s.pair.cells.iter().all(|c| c.count() > 0))
            .map(|s| {
                let workers = Workers::caller_only();
                let gaps =
                    contact(gears.grids.each_ref(), &s.pair, &gears.relative, 20, &workers, &mut Progress::silent());
                persistence(&gaps.unwrap(), 1.0 / 8.0)
            })
            .collect();
        let best = scores.iter().copied().fold(0.0, f64::max);
        assert!(scores.contains(&found.after) && found.after >= found.before);
        // It is a local search: it comes near to the best of them.
        assert!(found.after > best - 0.05, "{} {} {best} of {}", found.before, found.after, scores.len());
    }

    #[test]
    fn pairs_that_are_not_of_the_greatest_weight_are_refused() {
        let gears = gears(12, 1.0);
        let options = PersistenceOptions::default();
        let most: u64 = gears.best().weigh(gears.weights()).iter().sum();
        let some = |k: usize| {
            let set = Bits::of(144, |i| i % k == 0).unwrap();
            close(&gears.conflicts, &gears.room, Side::First, &set).unwrap()
        };
        let less = (2..9).map(some).find(|pair| pair.weigh(gears.weights()).iter().sum::<u64>() < most).unwrap();
        let told = gears.search(&less, &options).map(|found| found.after).unwrap_err().to_string();
        assert!(told.contains("the greatest weight is"), "{told}");
        // Some that overlap weigh as much.
        let mut other = gears.best();
        let lost = (0..144).find(|&i| !other.cells[0].has(i)).unwrap();
        let had = other.cells[0].iter().next().unwrap();
        other.cells[0].insert(lost);
        other.cells[0].remove(had);
        let told = gears.search(&other, &options).map(|found| found.after).unwrap_err().to_string();
        assert!(told.contains("the pair collides"), "{told}");
        let wrong = |options| gears.search(&gears.best(), &options).map(|found| found.after).unwrap_err().to_string();
        assert!(wrong(PersistenceOptions { gammas: [0.7, 0.3], ..options }).contains("from 0.7 to 0.3"));
        assert!(wrong(PersistenceOptions { scale: f64::NAN, ..options }).contains("a scale of NaN"));
        assert!(wrong(PersistenceOptions { n_times: 0, ..options }).contains("0 steps"));
    }
}
