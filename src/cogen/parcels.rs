//! Work on blocks of cells, a few at a time: so that progress is told, and what grows too large is noticed early.

use super::foresight::Limit;
use crate::Result;
use crate::par::Workers;
use crate::progress::Progress;
use std::ops::Range;

/// Cells of a block.
pub const BLOCK: usize = 256;

/// The blocks of some cells.
pub fn n_blocks(n_cells: usize) -> usize {
    n_cells.div_ceil(BLOCK)
}

/// The cells of a block.
pub fn cells(block: usize, n_cells: usize) -> Range<usize> {
    block * BLOCK..((block + 1) * BLOCK).min(n_cells)
}

/// Calls `make` with the cells of each block, on all threads, and `take` with what it gives, in order.
pub fn each_block<T: Send>(
    n_cells: usize,
    workers: &Workers,
    progress: &mut Progress<'_>,
    stage: &str,
    make: impl Fn(Range<usize>) -> Result<T> + Sync + Send,
    mut take: impl FnMut(T) -> Result<()>,
) -> Result<()> {
    let (n, many) = (n_blocks(n_cells), 4 * workers.n_threads().max(8));
    for from in (0..n).step_by(many) {
        progress.tell(from as f64 / n as f64, stage)?;
        for made in workers.map(many.min(n - from), |k| make(cells(from + k, n_cells))) {
            take(made?)?;
        }
    }
    Ok(())
}

/// What has been made so far takes up, and what all of it may.
pub struct Room {
    limit: Limit,
    n_blocks: usize,
    made: usize,
    bytes: usize,
}

impl Room {
    /// For what `limit` is of, of as many cells.
    pub fn new(limit: Limit, n_cells: usize) -> Self {
        Room { limit, n_blocks: n_blocks(n_cells), made: 0, bytes: 0 }
    }

    /// Counts a block more; the error tells what all would take if the others are like those so far.
    pub fn take(&mut self, bytes: usize) -> Result<()> {
        self.made += 1;
        self.bytes += bytes;
        if self.bytes as u64 <= self.limit.most() {
            return Ok(());
        }
        Err(self.limit.refusal(self.bytes as f64 * self.n_blocks as f64 / self.made as f64, None))
    }
}
