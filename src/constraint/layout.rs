//! Where the entries of a Hessian stand: blocks of variables against variables, each pair of variables once, in its lower triangle.

use crate::error::{try_reserve, try_reserve_entry};
use crate::{Error, Result};
use std::collections::HashMap;

/// Neighbouring variables: those of a frame, or the coordinates of a set of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    pub first: usize,
    pub n: usize,
}

/// Which entries a block has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shape {
    /// Those of a span against another, row by row.
    Full,
    /// Those on and below the diagonal of a span against itself, row by row.
    Lower,
    /// Those of each point of a span against itself, `dim` coordinates a point.
    Points { dim: usize },
}

#[derive(Debug, Clone, Copy)]
struct Block {
    rows: Span,
    columns: Span,
    shape: Shape,
    /// Of its first entry.
    offset: usize,
}

impl Block {
    fn n_entries(&self) -> u128 {
        let (rows, columns) = (self.rows.n as u128, self.columns.n as u128);
        match self.shape {
            Shape::Full => rows * columns,
            Shape::Lower => rows * (rows + 1) / 2,
            Shape::Points { dim } => rows / dim as u128 * (dim * (dim + 1) / 2) as u128,
        }
    }
}

/// Which of a pattern's blocks holds the entries of one span against another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockOf {
    index: usize,
    /// Whether the first of the two spans has its columns.
    swapped: bool,
}

/// The entries of a Hessian's lower triangle.
#[derive(Debug, Clone, Default)]
pub struct Layout {
    blocks: Vec<Block>,
    /// Number of the block of two spans, by their first variables, rows first: spans that begin together are the same.
    numbers: HashMap<[usize; 2], usize>,
    n_entries: usize,
}

/// A layout as it was.
pub struct Mark {
    n_blocks: usize,
    n_entries: usize,
    /// A block that may be widened.
    block: Option<(usize, Block)>,
}

/// What the memory is for, should it run out.
const WHAT: &str = "the pattern of the Hessian";

/// Entries of a pattern, at most: numbers of them fit all integers that optimisers take.
const MOST_ENTRIES: u128 = i32::MAX as u128;

impl Layout {
    /// The block of `one` against `other`, made where there is none.
    pub fn between(&mut self, one: Span, other: Span) -> Result<BlockOf> {
        let swapped = one.first < other.first;
        let (rows, columns) = if swapped { (other, one) } else { (one, other) };
        let shape = if rows == columns { Shape::Lower } else { Shape::Full };
        Ok(BlockOf { index: self.find_or_add(rows, columns, shape)?, swapped })
    }

    /// The block of each point of `span` against itself; part of that of all points against all, where there is one.
    pub fn of_points(&mut self, span: Span, dim: usize) -> Result<BlockOf> {
        Ok(BlockOf { index: self.find_or_add(span, span, Shape::Points { dim })?, swapped: false })
    }

    fn find_or_add(&mut self, rows: Span, columns: Span, shape: Shape) -> Result<usize> {
        let (spans, block) = ([rows.first, columns.first], Block { rows, columns, shape, offset: self.n_entries });
        let found = self.numbers.get(&spans).copied();
        // Each point against itself is part of all against all.
        if let Some(index) = found.filter(|i| [shape, Shape::Lower].contains(&self.blocks[*i].shape)) {
            return Ok(index);
        }
        let fewer = found.map_or(0, |index| self.blocks[index].n_entries());
        let total = self.n_entries as u128 + block.n_entries() - fewer;
        if total > MOST_ENTRIES {
            return Err(Error::InvalidArgument(format!(
                "the Hessian would have {total} entries; at most {MOST_ENTRIES} are served: an aggregate of points that are variables \
                 couples all of them"
            )));
        }
        if let Some(index) = found {
            self.blocks[index] = block;
            self.renew_offsets();
            return Ok(index);
        }
        try_reserve(&mut self.blocks, 1, WHAT)?;
        try_reserve_entry(&mut self.numbers, WHAT)?;
        self.numbers.insert(spans, self.blocks.len());
        self.blocks.push(block);
        self.n_entries = total as usize;
        Ok(self.blocks.len() - 1)
    }

    fn renew_offsets(&mut self) {
        let mut offset = 0;
        for block in &mut self.blocks {
            block.offset = offset;
            offset += block.n_entries() as usize;
        }
        self.n_entries = offset;
    }

    /// The layout as it is, to go back to; of the blocks only that of `span` against itself may be widened until then.
    pub fn mark(&self, span: Option<Span>) -> Mark {
        let index = span.and_then(|s| self.numbers.get(&[s.first, s.first]).copied());
        Mark { n_blocks: self.blocks.len(), n_entries: self.n_entries, block: index.map(|i| (i, self.blocks[i])) }
    }

    /// Goes back to what was marked.
    pub fn go_back(&mut self, mark: Mark) {
        for block in self.blocks.drain(mark.n_blocks..) {
            self.numbers.remove(&[block.rows.first, block.columns.first]);
        }
        if let Some((index, block)) = mark.block {
            self.blocks[index] = block;
        }
        self.renew_offsets();
        debug_assert_eq!(self.n_entries, mark.n_entries);
    }

    /// Entries in all.
    pub fn n_entries(&self) -> usize {
        self.n_entries
    }

    /// Calls `entry` with the row and the column of each entry, in order; rows are no smaller than columns.
    pub fn for_each(&self, mut entry: impl FnMut(usize, usize)) {
        for block in &self.blocks {
            for i in 0..block.rows.n {
                let columns = match block.shape {
                    Shape::Full => 0..block.columns.n,
                    Shape::Lower => 0..i + 1,
                    Shape::Points { dim } => i / dim * dim..i + 1,
                };
                columns.for_each(|j| entry(block.rows.first + i, block.columns.first + j));
            }
        }
    }

    /// Index of the entry of the `i`th variable of the first span of `of` and the `j`th of the second.
    #[inline]
    pub fn index(&self, of: BlockOf, i: usize, j: usize) -> usize {
        let block = &self.blocks[of.index];
        let (row, column) = if of.swapped { (j, i) } else { (i, j) };
        block.offset
            + match block.shape {
                Shape::Full => row * block.columns.n + column,
                Shape::Lower => row.max(column) * (row.max(column) + 1) / 2 + row.min(column),
                Shape::Points { dim } => {
                    debug_assert_eq!(row / dim, column / dim);
                    let (point, row, column) = (row / dim, row % dim, column % dim);
                    let (high, low) = (row.max(column), row.min(column));
                    point * (dim * (dim + 1) / 2) + high * (high + 1) / 2 + low
                }
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(layout: &Layout) -> Vec<(usize, usize)> {
        let mut entries = Vec::new();
        layout.for_each(|row, column| entries.push((row, column)));
        assert_eq!(entries.len(), layout.n_entries());
        entries
    }

    #[test]
    fn indices_are_those_of_the_pattern() {
        let (frame, points) = (Span { first: 9, n: 4 }, Span { first: 3, n: 6 });
        let mut layout = Layout::default();
        let own = layout.between(frame, frame).unwrap();
        let cross = layout.between(points, frame).unwrap();
        let each = layout.of_points(points, 3).unwrap();
        assert_eq!(layout.between(frame, points).unwrap(), BlockOf { swapped: false, ..cross });
        let all = entries(&layout);
        assert_eq!(all.len(), 10 + 24 + 12);
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            assert_eq!(all[layout.index(own, i, j)], (9 + i.max(j), 9 + i.min(j)));
        }
        for (i, j) in (0..6).flat_map(|i| (0..4).map(move |j| (i, j))) {
            assert_eq!(all[layout.index(cross, i, j)], (9 + j, 3 + i));
        }
        for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))).filter(|(i, j)| i / 3 == j / 3) {
            assert_eq!(all[layout.index(each, i, j)], (3 + i.max(j), 3 + i.min(j)));
        }
    }

    #[test]
    fn points_against_themselves_become_part_of_all_against_all() {
        let (points, other) = (Span { first: 0, n: 6 }, Span { first: 6, n: 2 });
        let mut layout = Layout::default();
        let each = layout.of_points(points, 2).unwrap();
        layout.between(other, other).unwrap();
        assert_eq!(layout.n_entries(), 9 + 3);
        let whole = layout.between(points, points).unwrap();
        assert_eq!((layout.n_entries(), whole.index), (21 + 3, each.index));
        assert_eq!(layout.of_points(points, 2).unwrap(), each);
        assert_eq!(entries(&layout)[layout.index(each, 5, 4)], (5, 4));
    }

    #[test]
    fn what_is_marked_comes_back() {
        let (points, other) = (Span { first: 0, n: 6 }, Span { first: 6, n: 2 });
        let mut layout = Layout::default();
        layout.of_points(points, 2).unwrap();
        layout.between(other, other).unwrap();
        let before = entries(&layout);
        let mark = layout.mark(Some(points));
        layout.between(points, points).unwrap();
        layout.between(points, other).unwrap();
        assert_eq!(layout.n_entries(), 21 + 3 + 12);
        layout.go_back(mark);
        assert_eq!(entries(&layout), before);
        layout.between(points, other).unwrap();
        assert_eq!(layout.n_entries(), before.len() + 12);
    }

    #[test]
    fn patterns_beyond_all_integers_are_refused() {
        let points = Span { first: 0, n: 300_000 };
        assert!(Layout::default().between(points, points).unwrap_err().to_string().contains("45000150000 entries"));
    }
}
