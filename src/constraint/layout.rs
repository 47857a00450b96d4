//! Where the entries of a Hessian stand: blocks of variables against variables, each pair of variables once, in its lower triangle.

use crate::error::try_reserve;
use crate::{Error, Result};

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
    n_entries: usize,
}

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
        let same = |b: &Block| (b.rows, b.columns) == (rows, columns);
        // Each point against itself is part of all against all.
        let serves = |b: &Block| same(b) && (b.shape == shape || b.shape == Shape::Lower);
        if let Some(index) = self.blocks.iter().position(serves) {
            return Ok(index);
        }
        let widened = self.blocks.iter().position(same);
        let block = Block { rows, columns, shape, offset: 0 };
        let fewer = widened.map_or(0, |index| self.blocks[index].n_entries());
        let total = self.n_entries as u128 + block.n_entries() - fewer;
        if total > MOST_ENTRIES {
            return Err(Error::InvalidArgument(format!(
                "the Hessian would have {total} entries; at most {MOST_ENTRIES} are served: an aggregate of points that are variables \
                 couples all of them"
            )));
        }
        let index = widened.unwrap_or(self.blocks.len());
        if widened.is_some() {
            self.blocks[index] = block;
        } else {
            try_reserve(&mut self.blocks, 1, "the pattern of the Hessian")?;
            self.blocks.push(block);
        }
        let mut offset = 0;
        for block in &mut self.blocks {
            block.offset = offset;
            offset += block.n_entries() as usize;
        }
        self.n_entries = offset;
        Ok(index)
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
    fn patterns_beyond_all_integers_are_refused() {
        let points = Span { first: 0, n: 300_000 };
        assert!(Layout::default().between(points, points).unwrap_err().to_string().contains("45000150000 entries"));
    }
}
