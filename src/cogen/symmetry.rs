//! Symmetric pairs on demand: for maps that carry both grids onto themselves, and conflicts onto conflicts.
//!
//! Such maps make groups of cells, orbits, and a set that they carry onto itself is a set of whole orbits. So with orbits for cells, each with
//! the weight of all that are in it, and an edge between two where any of their cells conflict, closure, cuts and families are what they are
//! without symmetry, and give the symmetric pairs; the graph is smaller by about as much as there are maps. Where weights are symmetric too, a best
//! symmetric pair is a best pair: of all minimum cuts the smallest is one alone, so every such map carries it onto itself. And what cannot grow
//! by an orbit cannot grow by a cell, since with one cell of an orbit there is room for all.
//!
//! A map takes each part's cells to that part's own. One that changes the parts for each other would not do: two cells that it changes, and that
//! conflict, have no symmetric pair but none.

use super::bits::Bits;
use super::closure::Pair;
use super::conflict::{Conflicts, Side};
use super::cut::{Cut, cut};
use super::family::{FamilyOptions, Member, family};
use super::foresight::Limit;
use super::grid::Grid;
use super::parcels::{cells, n_blocks};
use crate::error::{try_vec, try_with_capacity};
use crate::geometry::vec::{number, text};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// How far from a cell's centre, in cells, the image of one may be.
const OFF_CENTER: f64 = 1e-6;

const SIDES: [Side; 2] = [Side::First, Side::Second];

/// A map of each part's cells onto themselves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symmetry {
    /// Where each part's cells go.
    to: [Vec<u32>; 2],
}

/// A map of points.
pub type PointMap<'a, const D: usize> = &'a dyn Fn([f64; D]) -> [f64; D];

impl Symmetry {
    /// Cell i of part k goes to `to[k][i]`: `[n_1]` and `[n_2]`, each cell once.
    pub fn of_cells(to: [Vec<u32>; 2]) -> Result<Self> {
        for (k, to) in to.iter().enumerate() {
            let mut from: Vec<u32> = try_vec(to.len(), NONE, "a symmetry")?;
            for (i, &j) in to.iter().enumerate() {
                let Some(from) = from.get_mut(j as usize) else {
                    return Err(Error::InvalidArgument(format!(
                        "the map takes cell {i} of part {} to {j}; it has {} cells",
                        k + 1,
                        to.len()
                    )));
                };
                if *from != NONE {
                    return Err(Error::InvalidArgument(format!(
                        "the map takes cells {from} and {i} of part {} to one, {j}",
                        k + 1
                    )));
                }
                *from = i as u32;
            }
        }
        Ok(Symmetry { to })
    }

    /// The map of cells that maps of points make, one for each grid in its own coordinates: turns and mirrors, say.
    pub fn of_points<const D: usize>(grids: [&Grid<D>; 2], maps: [PointMap<'_, D>; 2]) -> Result<Self> {
        let of = |k: usize| -> Result<Vec<u32>> {
            let (grid, map) = (grids[k], maps[k]);
            let (corner, cell, counts) = (grid.corner(), grid.cell(), grid.counts());
            let mut to = try_with_capacity(grid.n_cells(), "a symmetry")?;
            for i in 0..grid.n_cells() {
                let p = map(grid.center(i));
                let at: [f64; D] = std::array::from_fn(|a| (p[a] - corner[a]) / cell - 0.5);
                let hit = (0..D).all(|a| {
                    (at[a] - at[a].round()).abs() <= OFF_CENTER && (0.0..counts[a] as f64).contains(&at[a].round())
                });
                if !hit {
                    return Err(Error::InvalidArgument(format!(
                        "the map takes cell {i} of part {}, with its centre at {}, to {}, where no cell of its grid has its centre",
                        k + 1,
                        text(&grid.center(i)),
                        text(&p)
                    )));
                }
                to.push(grid.number(at.map(|x| x.round() as usize)) as u32);
            }
            Ok(to)
        };
        Symmetry::of_cells([of(0)?, of(1)?])
    }
}

/// No cell, no orbit.
const NONE: u32 = u32::MAX;

/// A part's orbits.
#[derive(Debug)]
struct Orbits {
    /// The orbit of each cell; orbits are numbered as their first cells are.
    of: Vec<u32>,
    /// Cells, orbit by orbit, and where each orbit ends.
    cells: Vec<u32>,
    ends: Vec<u32>,
}

impl Orbits {
    fn new(n: usize, maps: &[&[u32]]) -> Result<Self> {
        let mut orbits = Orbits {
            of: try_vec(n, NONE, "orbits")?,
            cells: try_with_capacity(n, "orbits")?,
            ends: try_with_capacity(n, "orbits")?,
        };
        for first in 0..n {
            if orbits.of[first] != NONE {
                continue;
            }
            let (orbit, mut at) = (orbits.ends.len() as u32, orbits.cells.len());
            orbits.of[first] = orbit;
            orbits.cells.push(first as u32);
            // Maps are of finite order: what comes back to a cell is what goes on from it.
            while let Some(&i) = orbits.cells.get(at) {
                at += 1;
                for j in maps.iter().map(|map| map[i as usize]) {
                    if orbits.of[j as usize] == NONE {
                        orbits.of[j as usize] = orbit;
                        orbits.cells.push(j);
                    }
                }
            }
            orbits.ends.push(at as u32);
        }
        Ok(orbits)
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn cells(&self, orbit: usize) -> &[u32] {
        let from = if orbit == 0 { 0 } else { self.ends[orbit - 1] };
        &self.cells[from as usize..self.ends[orbit] as usize]
    }
}

/// The conflict graph of orbits.
#[derive(Debug)]
pub struct Folded {
    orbits: [Orbits; 2],
    conflicts: Conflicts,
}

impl Folded {
    /// Of `conflicts`, by all `maps` and what they make together. It takes a pass over all edges for each map, and one more. Each must carry edges onto edges: of those of the graph at most the fraction
    /// `excess` may miss their images. With 0 it must do so exactly; a little more leaves room for what rounding makes of cells that just touch,
    /// and of steps of time that the map does not carry onto steps. Images that are missed count as conflicts: what is given back is free of
    /// conflicts all the same.
    pub fn new(
        conflicts: &Conflicts,
        maps: &[Symmetry],
        excess: f64,
        workers: &Workers,
        progress: &mut Progress<'_>,
    ) -> Result<Self> {
        if !(0.0..1.0).contains(&excess) {
            let text = format!("the excess of edges is {}; it must be in [0, 1)", number(excess));
            return Err(Error::InvalidArgument(text));
        }
        for (m, map) in maps.iter().enumerate() {
            for side in SIDES {
                let (n, wanted) = (map.to[side.index()].len(), conflicts.n_cells(side));
                if n != wanted {
                    return Err(Error::InvalidArgument(format!(
                        "map {m} is of {n} cells for part {}'s {wanted}",
                        side.index() + 1
                    )));
                }
            }
            progress.tell(0.0, "symmetries")?;
            check(conflicts, m, map, excess, workers)?;
        }
        let orbits = |side: Side| {
            let maps: Vec<&[u32]> = maps.iter().map(|map| &map.to[side.index()][..]).collect();
            Orbits::new(conflicts.n_cells(side), &maps)
        };
        let orbits = [orbits(Side::First)?, orbits(Side::Second)?];
        let (near, sizes) = (conflicts.rows_of(), orbits.each_ref().map(Orbits::len));
        let (own, other) = (&orbits[near.index()], &orbits[near.other().index()]);
        let row = |orbit: usize, mark: &mut dyn FnMut(usize)| {
            let runs = own.cells(orbit).iter().flat_map(|&i| conflicts.rows().iter(i as usize));
            runs.for_each(|run| other.of[run].iter().for_each(|&j| mark(j as usize)));
        };
        let conflicts = Conflicts::of_rows(sizes, near, row, Limit::none(), workers, progress)?;
        Ok(Folded { orbits, conflicts })
    }

    /// The graph, for closure, cuts and families of orbits.
    pub fn conflicts(&self) -> &Conflicts {
        &self.conflicts
    }

    /// The orbits of part `side` all of whose cells are in `set`.
    pub fn fold(&self, side: Side, set: &Bits) -> Result<Bits> {
        let orbits = &self.orbits[side.index()];
        if set.len() != orbits.of.len() {
            let (n, part) = (orbits.of.len(), side.index() + 1);
            let text = format!("a set of {} cells for part {part}'s {n}", set.len());
            return Err(Error::InvalidArgument(text));
        }
        Bits::of(orbits.len(), |k| orbits.cells(k).iter().all(|&i| set.has(i as usize)))
    }

    /// The orbits that each part may have beside those that the other must; `frozen` are the cells that it must. The error tells of a frozen cell
    /// whose orbit does not fit into the `room`, and of orbits of frozen cells that conflict: by images that an excess lets be missed.
    pub fn room(&self, room: &[Bits; 2], frozen: [&Bits; 2]) -> Result<[Bits; 2]> {
        let mut folded = [self.fold(Side::First, &room[0])?, self.fold(Side::Second, &room[1])?];
        for k in 0..2 {
            let lost = |&i: &usize| self.orbits[k].of.get(i).is_none_or(|&orbit| !folded[k].has(orbit as usize));
            if let Some(i) = frozen[k].iter().find(lost) {
                return Err(Error::InvalidArgument(format!(
                    "frozen cell {i} of part {} has an image that the part may not have",
                    k + 1
                )));
            }
        }
        let of = |side: Side| -> Result<Bits> {
            let (orbits, frozen) = (&self.orbits[side.index()], frozen[side.index()]);
            Bits::of(orbits.len(), |k| orbits.cells(k).iter().any(|&i| frozen.has(i as usize)))
        };
        let kept = [of(Side::First)?, of(Side::Second)?];
        for side in SIDES {
            let (k, other) = (side.index(), side.other().index());
            let taken = self.conflicts.neighbours(side, &kept[k])?;
            let mut both = taken.clone();
            both.intersect(&kept[other]);
            if let Some(orbit) = both.iter().next() {
                return Err(Error::InvalidArgument(format!(
                    "frozen cell {} of part {} has an image that conflicts with one of a frozen cell of part {}",
                    self.orbits[other].cells(orbit)[0],
                    other + 1,
                    k + 1
                )));
            }
            folded[other].subtract(&taken);
        }
        Ok(folded)
    }

    /// The weights of orbits, sums of their cells'.
    pub fn weights(&self, weights: [&[u64]; 2]) -> Result<[Vec<u64>; 2]> {
        let of = |k: usize| -> Result<Vec<u64>> {
            let orbits = &self.orbits[k];
            if weights[k].len() != orbits.of.len() {
                let (n, given) = (orbits.of.len(), weights[k].len());
                return Err(Error::InvalidArgument(format!("{given} weights for part {}'s {n} cells", k + 1)));
            }
            let mut sums = try_with_capacity(orbits.len(), "weights of orbits")?;
            // Cuts refuse what is as large as this.
            let sum =
                |orbit| orbits.cells(orbit).iter().fold(0_u64, |sum, &i| sum.saturating_add(weights[k][i as usize]));
            sums.extend((0..orbits.len()).map(sum));
            Ok(sums)
        };
        Ok([of(0)?, of(1)?])
    }

    /// The cells of a pair of orbits.
    pub fn unfold(&self, pair: &Pair) -> Result<Pair> {
        let of = |k: usize| -> Result<Bits> {
            let (orbits, set) = (&self.orbits[k], &pair.cells[k]);
            if set.len() != orbits.len() {
                let (n, part) = (orbits.len(), k + 1);
                return Err(Error::InvalidArgument(format!("a set of {} for part {part}'s {n} orbits", set.len())));
            }
            Bits::of(orbits.of.len(), |i| set.has(orbits.of[i] as usize))
        };
        Ok(Pair { cells: [of(0)?, of(1)?] })
    }

    /// The symmetric pair of greatest weight: [`cut`](fn@super::cut) of orbits. `room`, `frozen` and `weights` are of cells.
    pub fn cut(
        &self,
        room: &[Bits; 2],
        frozen: [&Bits; 2],
        weights: [&[u64]; 2],
        progress: &mut Progress<'_>,
    ) -> Result<Cut> {
        let (room, [one, two]) = (self.room(room, frozen)?, self.weights(weights)?);
        let found = cut(&self.conflicts, &room, [&one, &two], progress)?;
        Ok(Cut { pair: self.unfold(&found.pair)?, ..found })
    }

    /// A family of symmetric pairs: [`family`](fn@super::family) of orbits. The same are of cells.
    pub fn family(
        &self,
        room: &[Bits; 2],
        frozen: [&Bits; 2],
        weights: [&[u64]; 2],
        gammas: &[f64],
        options: &FamilyOptions,
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Member>> {
        let (room, [one, two]) = (self.room(room, frozen)?, self.weights(weights)?);
        let mut found = family(&self.conflicts, &room, [&one, &two], gammas, options, progress)?;
        for member in &mut found {
            member.pair = self.unfold(&member.pair)?;
        }
        Ok(found)
    }
}

/// Whether the images of all edges, but for a fraction `excess` of them, are edges: since no two have the same image, the images are all edges then.
fn check(conflicts: &Conflicts, m: usize, map: &Symmetry, excess: f64, workers: &Workers) -> Result<()> {
    let near = conflicts.rows_of();
    let (own, other) = (&map.to[near.index()], &map.to[near.other().index()]);
    let (rows, n) = (conflicts.rows(), other.len());
    let missed = workers.map(n_blocks(own.len()), |block| -> Result<(usize, Option<[usize; 2]>)> {
        let (mut image, mut n_missed, mut first) = (Bits::none(n)?, 0, None);
        for i in cells(block, own.len()) {
            rows.iter(own[i] as usize).for_each(|run| image.insert_range(run));
            for j in rows.iter(i).flatten().filter(|&j| !image.has(other[j] as usize)) {
                n_missed += 1;
                first = first.or(Some([i, j]));
            }
            rows.iter(own[i] as usize).for_each(|run| image.remove_range(run));
        }
        Ok((n_missed, first))
    });
    let (mut n_missed, mut first) = (0, None);
    for part in missed {
        let (n, edge) = part?;
        n_missed += n;
        first = first.or(edge);
    }
    let Some([i, j]) = first.filter(|_| n_missed as f64 > excess * conflicts.n_edges() as f64) else { return Ok(()) };
    let by_part = |i: usize, j: usize| if near == Side::First { [i, j] } else { [j, i] };
    let ([a, b], [c, d]) = (by_part(i, j), by_part(own[i] as usize, other[j] as usize));
    Err(Error::InvalidArgument(format!(
        "map {m} does not carry conflicts onto conflicts: cells {a} and {b} of parts 1 and 2 conflict, their images {c} and {d} do not; so it is with \
         {n_missed} of {} conflicts, and may be with the fraction {}",
        conflicts.n_edges(),
        number(excess)
    )))
}

#[cfg(test)]
mod tests {
    use super::super::closure::close;
    use super::super::conflict::OverlapOptions;
    use super::super::correlation::Correlation;
    use super::super::motion::{Law, Motion};
    use super::super::part::Part;
    use super::super::steps::{Relative, Sampling};
    use super::super::tests::table;
    use super::*;
    use crate::geometry::matrix::{Matrix, applied};
    use crate::geometry::random::SplitMix64;
    use crate::geometry::vec::{add, sub};
    use std::f64::consts::TAU;

    fn shuffled(random: &mut SplitMix64, n: usize) -> Vec<u32> {
        let mut to: Vec<u32> = (0..n as u32).collect();
        (1..n).for_each(|i| to.swap(i, random.bits() as usize % (i + 1)));
        to
    }

    /// A map under which about as many cells stay as go round in orbits of `order`.
    fn random_map(random: &mut SplitMix64, n: usize, order: usize) -> Vec<u32> {
        let cells = shuffled(random, n);
        let mut to: Vec<u32> = (0..n as u32).collect();
        for round in cells.chunks_exact(order).filter(|_| random.unit() < 0.7) {
            (0..order).for_each(|k| to[round[k] as usize] = round[(k + 1) % order]);
        }
        to
    }

    struct Case {
        maps: Vec<Symmetry>,
        edges: Vec<Vec<bool>>,
        conflicts: Conflicts,
    }

    /// A graph that one or two maps carry onto itself.
    fn symmetric_case(random: &mut SplitMix64) -> Case {
        let n = [0; 2].map(|_| 1 + random.bits() as usize % 9);
        let orders = [2, 3, 4];
        let maps: Vec<Symmetry> = (0..1 + random.bits() as usize % 2)
            .map(|_| {
                let order = orders[random.bits() as usize % 3];
                Symmetry::of_cells(n.map(|n| random_map(random, n, order))).unwrap()
            })
            .collect();
        let density = 0.5 * random.unit();
        let mut edges: Vec<Vec<bool>> =
            (0..n[0]).map(|_| (0..n[1]).map(|_| random.unit() < density).collect()).collect();
        // Images of edges, and images of these.
        let mut grown = true;
        while grown {
            grown = false;
            for map in &maps {
                for (i, j) in (0..n[0]).flat_map(|i| (0..n[1]).map(move |j| (i, j))) {
                    let (a, b) = (map.to[0][i] as usize, map.to[1][j] as usize);
                    if edges[i][j] && !edges[a][b] {
                        edges[a][b] = true;
                        grown = true;
                    }
                }
            }
        }
        let rows_of = SIDES[random.bits() as usize % 2];
        let conflicts = Conflicts::of_edges(n, rows_of, |i, j| edges[i][j]).unwrap();
        Case { maps, edges, conflicts }
    }

    fn is_symmetric(maps: &[Symmetry], pair: &Pair) -> bool {
        let carried = |map: &Symmetry, k: usize| pair.cells[k].iter().all(|i| pair.cells[k].has(map.to[k][i] as usize));
        maps.iter().all(|map| carried(map, 0) && carried(map, 1))
    }

    fn assert_free_and_maximal(edges: &[Vec<bool>], room: &[Bits; 2], pair: &Pair) {
        let meets =
            |k: usize, i: usize| pair.cells[1 - k].iter().any(|j| if k == 0 { edges[i][j] } else { edges[j][i] });
        for (k, room) in room.iter().enumerate() {
            for i in 0..room.len() {
                assert!(!pair.cells[k].has(i) || room.has(i) && !meets(k, i));
                assert!(pair.cells[k].has(i) || !room.has(i) || meets(k, i), "it could grow");
            }
        }
    }

    #[test]
    fn symmetric_pairs_are_the_best_of_all_symmetric_pairs() {
        let mut random = SplitMix64::new(51);
        let mut n_turned = 0;
        for round in 0..1500 {
            let Case { maps, edges, conflicts } = symmetric_case(&mut random);
            let n = SIDES.map(|s| conflicts.n_cells(s));
            let folded = Folded::new(&conflicts, &maps, 0.0, &Workers::caller_only(), &mut Progress::silent()).unwrap();
            // Weights of orbits alike in two of three rounds, and room for whole orbits.
            let most = [1, 3, 1000][round % 3];
            let alike = !round.is_multiple_of(3);
            let weights: [Vec<u64>; 2] = [0, 1].map(|k| {
                let of: Vec<u64> = (0..n[k]).map(|_| 1 + random.bits() % most).collect();
                (0..n[k])
                    .map(|i| {
                        of[if alike { folded.orbits[k].cells(folded.orbits[k].of[i] as usize)[0] as usize } else { i }]
                    })
                    .collect()
            });
            let room = [0, 1].map(|k| Bits::of(n[k], |i| folded.orbits[k].of[i] % 4 != 3).unwrap());
            let of = [&weights[0][..], &weights[1]];
            let none = n.map(|n| Bits::none(n).unwrap());
            let orbit_room = folded.room(&room, none.each_ref()).unwrap();
            let silent = &mut Progress::silent();
            let found = folded.cut(&room, none.each_ref(), of, silent).unwrap();
            let pair = &found.pair;
            assert!(is_symmetric(&maps, pair));
            assert_eq!((pair.weigh(of).iter().sum::<u64>(), found.bound), (found.weight, found.weight));

            // All sets of part 1 that all maps carry onto themselves, each with the orbits that it leaves of part 2.
            let whole = |k: usize, set: u32| {
                maps.iter().all(|map| (0..n[k]).all(|i| set >> i & 1 == 0 || set >> map.to[k][i] & 1 == 1))
            };
            let weigh = |set: u32| -> u64 {
                let has = |i: usize| set >> i & 1 == 1;
                let left = (0..n[1]).filter(|&j| room[1].has(j) && (0..n[0]).all(|i| !has(i) || !edges[i][j]));
                let left = left.fold(0_u32, |set, j| set | 1 << j);
                assert!(!whole(0, set) || whole(1, left));
                (0..n[0]).filter(|&i| has(i)).map(|i| weights[0][i]).sum::<u64>()
                    + (0..n[1]).filter(|j| left >> j & 1 == 1).map(|j| weights[1][j]).sum::<u64>()
            };
            let in_room = |set: &u32| (0..n[0]).all(|i| set >> i & 1 == 0 || room[0].has(i));
            let all = || (0..1_u32 << n[0]).filter(in_room);
            assert_eq!(found.weight, all().filter(|&set| whole(0, set)).map(weigh).max().unwrap());
            if alike {
                // The cut without symmetry is as heavy, and symmetric by itself.
                let plain = cut(&conflicts, &room, of, silent).unwrap();
                assert_eq!(plain.weight, found.weight);
                assert_eq!(plain.pair, *pair);
            }

            let wanted = Bits::of(n[0], |i| !(i + round).is_multiple_of(3)).unwrap();
            let set = folded.fold(Side::First, &wanted).unwrap();
            let closed = folded.unfold(&close(folded.conflicts(), &orbit_room, Side::First, &set).unwrap()).unwrap();
            assert!(is_symmetric(&maps, &closed));
            assert_free_and_maximal(&edges, &room, &closed);
            // Without symmetry closure of the same set would not be.
            n_turned += usize::from(!is_symmetric(&maps, &close(&conflicts, &room, Side::First, &wanted).unwrap()));

            let options = FamilyOptions { gap: 0.0 };
            let gammas = [0.0, 0.3, 0.5, 0.8, 1.0];
            for member in folded.family(&room, none.each_ref(), of, &gammas, &options, silent).unwrap() {
                assert!(is_symmetric(&maps, &member.pair));
                assert_free_and_maximal(&edges, &room, &member.pair);
            }
        }
        assert!(n_turned > 40, "{n_turned}");
    }

    #[test]
    fn maps_that_miss_an_edge_are_refused() {
        let mut random = SplitMix64::new(52);
        let mut n_refused = 0;
        for _ in 0..500 {
            let Case { maps, edges, conflicts } = symmetric_case(&mut random);
            let each = (0..edges.len()).flat_map(|i| (0..edges[0].len()).map(move |j| (i, j)));
            let moves = |&(i, j): &(usize, usize)| {
                edges[i][j] && maps.iter().any(|map| (map.to[0][i], map.to[1][j]) != (i as u32, j as u32))
            };
            let Some(lost) = each.clone().find(moves) else { continue };
            let n = SIDES.map(|s| conflicts.n_cells(s));
            let less = Conflicts::of_edges(n, conflicts.rows_of(), |i, j| edges[i][j] && (i, j) != lost).unwrap();
            let told = Folded::new(&less, &maps, 0.0, &Workers::caller_only(), &mut Progress::silent())
                .unwrap_err()
                .to_string();
            assert!(told.contains(&format!("images {} and {} do not", lost.0, lost.1)), "{told}");
            n_refused += 1;
            // With room for it, it counts as a conflict.
            if let Ok(folded) = Folded::new(&less, &maps, 0.99, &Workers::caller_only(), &mut Progress::silent()) {
                let whole =
                    Folded::new(&conflicts, &maps, 0.0, &Workers::caller_only(), &mut Progress::silent()).unwrap();
                assert_eq!(table(folded.conflicts()), table(whole.conflicts()));
            }
        }
        assert!(n_refused > 100, "{n_refused}");
    }

    fn about(center: [f64; 2], linear: Matrix<2>) -> impl Fn([f64; 2]) -> [f64; 2] {
        move |p| add(center, applied(&linear, sub(p, center)))
    }

    const QUARTER: Matrix<2> = [[0.0, -1.0], [1.0, 0.0]];
    const BACK: Matrix<2> = [[0.0, 1.0], [-1.0, 0.0]];
    const MIRROR: Matrix<2> = [[1.0, 0.0], [0.0, -1.0]];

    /// Two gears of `n` cells a side: quarter turns against each other are quarters of the motion, and a mirror lets it run backwards.
    #[test]
    fn gears_are_symmetric_by_quarters() {
        let n = 24;
        let square = |x: f64| Part::whole(Grid::new([x - 0.5, -0.5], 1.0 / n as f64, [n, n]).unwrap()).unwrap();
        let parts = [square(0.0), square(1.0)];
        let pair = [&parts[0], &parts[1]];
        let turn = |x: f64, turns: f64| Motion::turn([x, 0.0], Law::even(turns * TAU)).unwrap();
        let relative = Relative { from: turn(0.0, 1.0), of: turn(1.0, -1.0) };
        let grids = pair.map(Part::grid);
        let of = |one, two| Symmetry::of_points(grids, [&about([0.0, 0.0], one), &about([1.0, 0.0], two)]).unwrap();
        let (quarter, mirror) = (of(QUARTER, BACK), of(MIRROR, MIRROR));
        let (workers, silent) = (Workers::caller_only(), &mut Progress::silent());
        let options = OverlapOptions { sampling: Sampling::Steps(400), ..OverlapOptions::default() };
        let overlaps = Conflicts::of_overlap(pair, &relative, &options, silent).unwrap();
        let correlation = Correlation::new(pair, &relative, 400, 1 << 30, &workers, silent).unwrap();
        let centers = correlation.conflicts(1 << 30, &workers, silent).unwrap();
        let room = parts.each_ref().map(|p| p.allowed().clone());
        let weights = [vec![1; n * n], vec![1; n * n]];
        for conflicts in [overlaps, centers] {
            let maps = [quarter.clone(), mirror.clone()];
            let folded = Folded::new(&conflicts, &maps, 0.0, &workers, silent).unwrap();
            let sizes = SIDES.map(|s| folded.conflicts().n_cells(s));
            // Eight cells an orbit, but for those on mirrors.
            assert_eq!(sizes, [n / 2 * (n / 2 + 1) / 2; 2]);
            let best = folded.cut(&room, pair.map(Part::frozen), [&weights[0], &weights[1]], silent).unwrap();
            let plain = cut(&conflicts, &room, [&weights[0], &weights[1]], silent).unwrap();
            assert_eq!((best.weight, best.pair), (plain.weight, plain.pair));
            let told = Folded::new(&conflicts, &[of(QUARTER, QUARTER)], 0.0, &workers, silent).unwrap_err().to_string();
            assert!(told.contains("map 0 does not carry"), "{told}");
        }
    }

    /// Images that are missed count as conflicts: beside frozen cells too.
    #[test]
    fn frozen_cells_stay_where_images_are_missed() {
        let edges = [(1, 0), (2, 2), (3, 3)];
        let conflicts = Conflicts::of_edges([4, 4], Side::First, |i, j| edges.contains(&(i, j))).unwrap();
        let map = Symmetry::of_cells([vec![1, 0, 3, 2], vec![1, 0, 3, 2]]).unwrap();
        let silent = &mut Progress::silent();
        let folded = Folded::new(&conflicts, &[map], 0.5, &Workers::caller_only(), silent).unwrap();
        let all = [Bits::all(4).unwrap(), Bits::all(4).unwrap()];
        let (one, none) = (Bits::of(4, |i| i == 0).unwrap(), Bits::none(4).unwrap());
        let found = folded.cut(&all, [&one, &none], [&[1; 4], &[10; 4]], silent).unwrap();
        let cells = found.pair.cells.map(|set| set.iter().collect::<Vec<_>>());
        assert_eq!(cells, [vec![0, 1], vec![2, 3]]);
        let told = folded.cut(&all, [&one, &one], [&[1; 4], &[10; 4]], silent).unwrap_err().to_string();
        assert!(told.contains("has an image that conflicts"), "{told}");
    }

    #[test]
    fn what_is_no_symmetry_is_refused() {
        let told = |to| Symmetry::of_cells(to).unwrap_err().to_string();
        assert!(told([vec![0, 2], vec![0]]).contains("cell 1 of part 1 to 2; it has 2"));
        assert!(told([vec![0, 1], vec![1, 1]]).contains("cells 0 and 1 of part 2 to one, 1"));
        let grid = Grid::new([0.0, 0.0], 0.5, [2, 4]).unwrap();
        let of = |center| Symmetry::of_points([&grid, &grid], [&about([0.5, 1.0], MIRROR), &about(center, QUARTER)]);
        assert!(of([0.5, 1.0]).unwrap_err().to_string().contains("of part 2"));
        assert!(of([f64::NAN, 1.0]).is_err());
        let conflicts = Conflicts::of_edges([2, 1], Side::First, |_, _| true).unwrap();
        let new = |to, excess| {
            Folded::new(
                &conflicts,
                &[Symmetry::of_cells(to).unwrap()],
                excess,
                &Workers::caller_only(),
                &mut Progress::silent(),
            )
        };
        assert!(new([vec![0], vec![0]], 0.0).unwrap_err().to_string().contains("1 cells for part 1's 2"));
        assert!(new([vec![1, 0], vec![0]], 1.0).unwrap_err().to_string().contains("excess of edges is 1"));
        let folded = new([vec![1, 0], vec![0]], 0.0).unwrap();
        assert_eq!(SIDES.map(|s| folded.conflicts().n_cells(s)), [1, 1]);
        let (one, all) = (Bits::of(2, |i| i == 1).unwrap(), Bits::all(1).unwrap());
        let told = folded.room(&[one.clone(), all.clone()], [&one, &all]).unwrap_err().to_string();
        assert!(told.contains("frozen cell 1 of part 1 has an image"), "{told}");
        assert!(folded.fold(Side::First, &all).unwrap_err().to_string().contains("a set of 1 cells for part 1's 2"));
        assert!(folded.weights([&[1], &[1]]).unwrap_err().to_string().contains("1 weights for part 1's 2"));
        let pair = Pair { cells: [one, all] };
        assert!(folded.unfold(&pair).unwrap_err().to_string().contains("a set of 2 for part 1's 1 orbits"));
    }
}
