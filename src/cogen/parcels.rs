//! Work on blocks of cells, a few at a time: so that progress is told, and what grows too large is noticed early.

use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
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
    what: &'static str,
    n_blocks: usize,
    made: usize,
    bytes: usize,
    most: u64,
}

impl Room {
    /// For `what` of as many cells, which may take `most` bytes.
    pub fn new(what: &'static str, n_cells: usize, most: u64) -> Self {
        Room { what, n_blocks: n_blocks(n_cells), made: 0, bytes: 0, most }
    }

    /// Counts a block more; the error tells what all would take if the others are like those so far.
    pub fn take(&mut self, bytes: usize) -> Result<()> {
        self.made += 1;
        self.bytes += bytes;
        if self.bytes as u64 <= self.most {
            return Ok(());
        }
        let bytes = self.bytes as u128 * self.n_blocks as u128 / self.made as u128;
        Err(Error::OutOfMemory { what: self.what.into(), bytes, limit: Some(self.most.into()) })
    }
}
