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

/// Edges that are put in order at a time.
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
        // As many columns at a time as have about SLAB edges.
        let mut count: Vec<u32> = try_vec(n + 1, 0, "the conflict graph")?;
        for i in 0..self.n_rows {
            for run in self.iter(i) {
                count[run.start] = count[run.start].wrapping_add(1);
                count[run.end] = count[run.end].wrapping_sub(1);
            }
        }
        (0..n).for_each(|j| count[j + 1] = count[j + 1].wrapping_add(count[j]));
        let mut slabs = vec![0];
        let mut sum = 0;
        for block in 0..n.div_ceil(BLOCK) {
            let end = ((block + 1) * BLOCK).min(n);
            sum += count[block * BLOCK..end].iter().map(|&c| c as usize).sum::<usize>();
            if sum >= SLAB || end == n {
                slabs.push(end);
                sum = 0;
            }
        }
        let mut blocks = Vec::new();
        for slab in slabs.windows(2) {
            let columns = slab[0]..slab[1];
            let mut begins: Vec<u32> = try_vec(columns.len() + 1, 0, "the conflict graph")?;
            (0..columns.len()).for_each(|j| begins[j + 1] = begins[j] + count[slab[0] + j]);
            let mut cells: Vec<u32> = try_vec(begins[columns.len()] as usize, 0, "the conflict graph")?;
            let mut at = begins.clone();
            for i in 0..self.n_rows {
                for run in self.iter(i).skip_while(|run| run.end <= slab[0]).take_while(|run| run.start < slab[1]) {
                    for j in run.start.max(slab[0])..run.end.min(slab[1]) {
                        cells[at[j - slab[0]] as usize] = i as u32;
                        at[j - slab[0]] += 1;
                    }
                }
            }
            let made = workers.map(columns.len().div_ceil(BLOCK), |k| -> Result<Block> {
                let mut block = Block::new()?;
                for j in k * BLOCK..((k + 1) * BLOCK).min(columns.len()) {
                    let cells = &cells[begins[j] as usize..begins[j + 1] as usize];
                    block.push_row(|run| {
                        cells.chunk_by(|a, b| a + 1 == *b).try_for_each(|c| run(c[0] as usize..c[0] as usize + c.len()))
                    })?;
                }
                Ok(block.settled())
            });
            for block in made {
                blocks.push(block?);
            }
        }
        Ok(Rows::new(blocks))
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
