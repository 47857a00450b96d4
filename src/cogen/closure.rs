//! Closure: from any pair of parts to one that never collides and cannot grow.
//!
//! With A_i the cells that part i may have, and N(.) their neighbours in the conflict graph, two passes do it, S_2 := A_2 \ N(S_1), then
//! S_1 := A_1 \ N(S_2): the second gives back to part 1 all that part 2 leaves room for, so S_1 never shrinks, and then neither part can
//! grow, since whatever is not in S_2 is a neighbour of the S_1 that one began with, which S_1 still holds.

use super::bits::Bits;
use super::conflict::{Conflicts, Side};
use super::frozen;
use super::part::Part;
use super::steps::Relative;
use crate::{Error, Result};

/// A pair of parts, by their cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pair {
    /// The cells of part 1 and of part 2.
    pub cells: [Bits; 2],
}

impl Pair {
    /// What the cells of each part weigh.
    pub fn weigh(&self, weights: [&[u64]; 2]) -> [u64; 2] {
        [0, 1].map(|k| self.cells[k].iter().map(|i| weights[k][i]).sum())
    }

    /// What those of the cells that are among `some` weigh.
    pub fn weigh_some(&self, some: &[Bits; 2], weights: [&[u64]; 2]) -> [u64; 2] {
        [0, 1].map(|k| self.cells[k].iter().filter(|&i| some[k].has(i)).map(|i| weights[k][i]).sum())
    }

    /// How many of each part's cells are among `some`.
    pub fn count_some(&self, some: &[Bits; 2]) -> [usize; 2] {
        [0, 1].map(|k| self.cells[k].iter().filter(|&i| some[k].has(i)).count())
    }

    /// How many cells part `side` has.
    pub fn count(&self, side: Side) -> usize {
        self.cells[side.index()].count()
    }
}

/// Of two sets of cells, whose areas or volumes are `measures`, that with the larger one, part 1's where they are equal.
pub fn larger(measures: [f64; 2], sets: [&Bits; 2]) -> Side {
    let volume = |k: usize| sets[k].count() as f64 * measures[k];
    if volume(0) >= volume(1) { Side::First } else { Side::Second }
}

/// The cells that each part may have beside those that the other must: A_1 \ N(frozen_2), A_2 \ N(frozen_1). The error tells of frozen cells
/// that collide with each other, and from `relative`, the motion that the graph is of, when and where.
pub fn room<const D: usize>(conflicts: &Conflicts, parts: [&Part<D>; 2], relative: &Relative<D>) -> Result<[Bits; 2]> {
    frozen::check(conflicts, parts, relative, [1, 2])?;
    let mut room = parts.map(|p| p.allowed().clone());
    for side in [Side::First, Side::Second] {
        let frozen = parts[side.index()].frozen();
        if frozen.count() > 0 {
            room[side.other().index()].subtract(&conflicts.neighbours(side, frozen)?);
        }
    }
    Ok(room)
}

/// Refuses sets of other grids' cells.
pub(super) fn check_room(conflicts: &Conflicts, room: &[Bits; 2]) -> Result<()> {
    check_set(conflicts, Side::First, &room[0])?;
    check_set(conflicts, Side::Second, &room[1])
}

/// The same of one.
pub(super) fn check_set(conflicts: &Conflicts, side: Side, set: &Bits) -> Result<()> {
    if set.len() == conflicts.n_cells(side) {
        return Ok(());
    }
    Err(Error::InvalidArgument(format!(
        "a set among {} cells for part {}; its grid has {}",
        set.len(),
        side.index() + 1,
        conflicts.n_cells(side)
    )))
}

/// The pair that one gets by keeping `set`, the cells of part `side`, as far as there is `room` for them. The error tells of sets of other grids'
/// cells.
pub fn close(conflicts: &Conflicts, room: &[Bits; 2], side: Side, set: &Bits) -> Result<Pair> {
    check_room(conflicts, room)?;
    check_set(conflicts, side, set)?;
    let (one, two) = (side.index(), side.other().index());
    let mut kept = set.clone();
    kept.intersect(&room[one]);
    let mut other = room[two].clone();
    other.subtract(&conflicts.neighbours(side, &kept)?);
    let mut own = room[one].clone();
    own.subtract(&conflicts.neighbours(side.other(), &other)?);
    Ok(Pair {
        cells: match side {
            Side::First => [own, other],
            Side::Second => [other, own],
        },
    })
}
