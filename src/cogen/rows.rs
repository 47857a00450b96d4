//! The edges of a bipartite graph, by rows: to each cell of one part the cells of the other, as runs of numbers that follow each other.
//!
//! A run is a word of 32 bits: 24 tell how many numbers lie between the run before and this one, 8 how many it has. What does not fit takes
//! several words, of which those before the last may have no number. Rows stand in blocks, so that they can be made on several threads and
//! never move.

use super::parcels::BLOCK;
use crate::Result;
use crate::error::{try_reserve, try_vec, try_with_capacity};
use crate::par::Workers;
use std::ops::Range;
use std::sync::Arc;

const GAP: usize = (1 << 24) - 1;
const LENGTH: usize = 255;

/// Edges that are put in order at a time: 256 MB.
const SLAB: usize = 1 << 26;

/// Some rows.
#[derive(Debug, Default)]
pub struct Block {
    /// Where each row ends in `runs`.
    ends: Vec<u32>,
    runs: Vec<u32>,
    n_edges: usize,
}

impl Block {
    /// No rows, with room for [`BLOCK`].
    pub fn new() -> Result<Self> {
        Ok(Block { ends: try_with_capacity(BLOCK, "rows of the conflict graph")?, runs: Vec::new(), n_edges: 0 })
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        4 * (self.runs.capacity() + self.ends.capacity())
    }

    /// Bytes of the runs alone.
    pub fn bytes_of_runs(&self) -> usize {
        4 * self.runs.len()
    }

    /// The same rows, without room for more.
    pub fn settled(mut self) -> Self {
        self.runs.shrink_to_fit();
        self
    }

    /// Puts a row behind the others: `each` calls what it is given for each run, in order.
    pub fn push_row(
        &mut self,
        each: impl FnOnce(&mut dyn FnMut(Range<usize>) -> Result<()>) -> Result<()>,
    ) -> Result<()> {
        let mut at = 0;
        let Block { ends, runs, n_edges } = self;
        each(&mut |run: Range<usize>| {
            let (mut gap, mut n) = (run.start - at, run.len());
            at = run.end;
            *n_edges += n;
            try_reserve(runs, gap / GAP + n / LENGTH + 2, "the conflict graph")?;
            while gap > GAP {
                runs.push((GAP as u32) << 8);
                gap -= GAP;
            }
            while n > LENGTH {
                runs.push((gap as u32) << 8 | LENGTH as u32);
                (gap, n) = (0, n - LENGTH);
            }
            runs.push((gap as u32) << 8 | n as u32);
            Ok(())
        })?;
        // A block of as many runs would take 17 GB.
        ends.push(u32::try_from(runs.len()).expect("a block's runs"));
        Ok(())
    }
}

/// All rows. Copies share them.
#[derive(Debug, Clone)]
pub struct Rows {
    blocks: Arc<Vec<Block>>,
    n_rows: usize,
}

/// Some columns, each with the rows that it is in, in order.
struct Gathered {
    first: usize,
    /// Where each begins in `cells`.
    begins: Vec<usize>,
    cells: Vec<u32>,
}

impl Gathered {
    /// Puts column `j` behind the rows of `block`.
    fn put(&self, j: usize, block: &mut Block) -> Result<()> {
        let k = j - self.first;
        let cells = &self.cells[self.begins[k]..self.begins[k + 1]];
        block.push_row(|run| {
            cells.chunk_by(|a, b| a + 1 == *b).try_for_each(|c| run(c[0] as usize..c[0] as usize + c.len()))
        })
    }
}

/// A place in a row: how many of its runs have been taken, and where the last of them ends.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cursor {
    taken: u32,
    end: u32,
}

impl Rows {
    /// Rows of `blocks`, each of [`BLOCK`] but the last.
    pub fn new(blocks: Vec<Block>) -> Self {
        let n_rows = blocks.iter().map(|b| b.ends.len()).sum();
        debug_assert!(blocks.iter().rev().skip(1).all(|b| b.ends.len() == BLOCK));
        Rows { blocks: Arc::new(blocks), n_rows }
    }

    /// The same edges by the numbers in the rows, which are below `n`.
    pub fn transposed(&self, n: usize, workers: &Workers) -> Result<Self> {
        self.transposed_by(SLAB, n, workers)
    }

    /// The same with as many edges at a time, or one column.
    fn transposed_by(&self, slab: usize, n: usize, workers: &Workers) -> Result<Self> {
        let counts = self.counts(n)?;
        let edges = |columns: Range<usize>| counts[columns].iter().map(|&c| c as usize).sum::<usize>();
        let mut blocks: Vec<Block> = try_with_capacity(n.div_ceil(BLOCK), "the conflict graph")?;
        let mut from = 0;
        while from < n {
            // As many blocks of columns as have `slab` edges, but one at least.
            let mut to = (from + BLOCK).min(n);
            let mut sum = edges(from..to);
            while to < n && sum + edges(to..(to + BLOCK).min(n)) <= slab {
                let next = (to + BLOCK).min(n);
                sum += edges(to..next);
                to = next;
            }
            if sum > slab {
                blocks.push(self.dense(from..to, slab, &counts)?);
            } else {
                let gathered = self.gathered(from..to, &counts)?;
                let made = workers.map((to - from).div_ceil(BLOCK), |k| -> Result<Block> {
                    let mut block = Block::new()?;
                    let first = from + k * BLOCK;
                    (first..(first + BLOCK).min(to)).try_for_each(|j| gathered.put(j, &mut block))?;
                    Ok(block.settled())
                });
                for block in made {
                    blocks.push(block?);
                }
            }
            from = to;
        }
        Ok(Rows::new(blocks))
    }

    /// Edges of each column.
    fn counts(&self, n: usize) -> Result<Vec<u32>> {
        let mut counts: Vec<u32> = try_vec(n + 1, 0, "the conflict graph")?;
        for i in 0..self.n_rows {
            for run in self.iter(i) {
                counts[run.start] = counts[run.start].wrapping_add(1);
                counts[run.end] = counts[run.end].wrapping_sub(1);
            }
        }
        (0..n).for_each(|j| counts[j + 1] = counts[j + 1].wrapping_add(counts[j]));
        Ok(counts)
    }

    /// A block of columns with more than `slab` edges, some of them at a time.
    fn dense(&self, columns: Range<usize>, slab: usize, counts: &[u32]) -> Result<Block> {
        let mut block = Block::new()?;
        let mut from = columns.start;
        while from < columns.end {
            let (mut to, mut sum) = (from + 1, counts[from] as usize);
            while to < columns.end && sum + counts[to] as usize <= slab {
                sum += counts[to] as usize;
                to += 1;
            }
            let gathered = self.gathered(from..to, counts)?;
            (from..to).try_for_each(|j| gathered.put(j, &mut block))?;
            from = to;
        }
        Ok(block.settled())
    }

    /// The rows that some columns are in.
    fn gathered(&self, columns: Range<usize>, counts: &[u32]) -> Result<Gathered> {
        let n = columns.len();
        let mut begins: Vec<usize> = try_vec(n + 1, 0, "the conflict graph")?;
        (0..n).for_each(|j| begins[j + 1] = begins[j] + counts[columns.start + j] as usize);
        let mut cells: Vec<u32> = try_vec(begins[n], 0, "the conflict graph")?;
        let mut at: Vec<usize> = try_with_capacity(n, "the conflict graph")?;
        at.extend_from_slice(&begins[..n]);
        for i in 0..self.n_rows {
            let runs = self.iter(i).skip_while(|run| run.end <= columns.start);
            for run in runs.take_while(|run| run.start < columns.end) {
                for j in run.start.max(columns.start)..run.end.min(columns.end) {
                    let at = &mut at[j - columns.start];
                    cells[*at] = i as u32;
                    *at += 1;
                }
            }
        }
        Ok(Gathered { first: columns.start, begins, cells })
    }

    /// How many edges there are.
    pub fn n_edges(&self) -> usize {
        self.blocks.iter().map(|b| b.n_edges).sum()
    }

    /// Bytes that the runs take.
    pub fn bytes(&self) -> usize {
        self.blocks.iter().map(Block::bytes).sum()
    }

    #[inline]
    fn runs(&self, row: usize) -> &[u32] {
        let (block, k) = (&self.blocks[row / BLOCK], row % BLOCK);
        let from = if k == 0 { 0 } else { block.ends[k - 1] };
        &block.runs[from as usize..block.ends[k] as usize]
    }

    /// Whether the row has no edge.
    pub fn is_empty(&self, row: usize) -> bool {
        self.runs(row).is_empty()
    }

    /// The run behind `cursor`, which goes behind that.
    #[inline]
    pub fn next_run(&self, row: usize, cursor: &mut Cursor) -> Option<Range<usize>> {
        let run = *self.runs(row).get(cursor.taken as usize)?;
        let from = cursor.end + (run >> 8);
        *cursor = Cursor { taken: cursor.taken + 1, end: from + (run & 255) };
        Some(from as usize..cursor.end as usize)
    }

    /// The runs of a row, in order; one of more than 255 numbers comes in several.
    #[inline]
    pub fn iter(&self, row: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        let mut at = 0;
        self.runs(row).iter().map(move |&run| {
            let from = at + (run >> 8) as usize;
            at = from + (run & 255) as usize;
            from..at
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_the_rows_turned_whatever_comes_at_a_time() {
        let (n_rows, n) = (700, 900);
        let has = |i: usize, j: usize| (i * i + 3 * j) % 7 < 2 || (300..420).contains(&j);
        let blocks = (0..n_rows).step_by(BLOCK).map(|from| {
            let mut block = Block::new().unwrap();
            for i in from..(from + BLOCK).min(n_rows) {
                block.push_row(|run| (0..n).filter(|&j| has(i, j)).try_for_each(|j| run(j..j + 1))).unwrap();
            }
            block
        });
        let rows = Rows::new(blocks.collect());
        for slab in [1, 5_000, 100_000, SLAB] {
            let columns = rows.transposed_by(slab, n, &Workers::new(2).unwrap()).unwrap();
            assert_eq!((columns.n_rows, columns.n_edges()), (n, rows.n_edges()));
            for j in 0..n {
                assert!(columns.iter(j).flatten().eq((0..n_rows).filter(|&i| has(i, j))), "{slab} {j}");
            }
        }
    }

    #[test]
    fn rows_come_back_as_they_went_in() {
        let row = [3..4, 10..300, 301..811, 20_000_000..20_000_001, 60_000_000..60_000_255];
        let mut block = Block::new().unwrap();
        block.push_row(|_| Ok(())).unwrap();
        block.push_row(|run| row.iter().cloned().try_for_each(run)).unwrap();
        block.push_row(|run| run(0..1)).unwrap();
        let rows = Rows::new(vec![block]);
        assert_eq!(
            (rows.n_rows, rows.is_empty(0), rows.n_edges()),
            (3, true, row.iter().map(Range::len).sum::<usize>() + 1)
        );
        let numbers = |r| rows.iter(r).flatten().collect::<Vec<_>>();
        assert_eq!(numbers(1), row.iter().cloned().flatten().collect::<Vec<_>>());
        assert_eq!(numbers(2), [0]);
        let mut cursor = Cursor::default();
        let taken: Vec<usize> = std::iter::from_fn(|| rows.next_run(1, &mut cursor)).flatten().collect();
        assert_eq!(taken, numbers(1));
    }
}
