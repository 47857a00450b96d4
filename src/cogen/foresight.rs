//! What something will take, before it is made, from a sample of its rows; and where that is too much, what would fit.

use super::bits::Bits;
use super::grid::Grid;
use crate::error::try_with_capacity;
use crate::geometry::vec::number;
use crate::par::Workers;
use crate::{Error, Result};

/// Rows of a sample, at most.
const SAMPLE: usize = 512;

/// Of so many rows one is looked at, at most: the rest of the work is what the sample is to save.
const ONE_OF: usize = 16;

/// What may be taken.
#[derive(Debug, Clone, Copy)]
pub struct Limit {
    /// For what.
    what: &'static str,
    /// Bytes.
    most: u64,
    /// Edges of both grids' cells, and the power of 1 / eps that bytes grow as, at least; where what would fit can be told by these.
    cells: Option<([f64; 2], i32)>,
}

/// Bytes that all rows will take.
#[derive(Debug, Clone, Copy, Default)]
pub struct Estimate {
    bytes: f64,
    /// Variance of that.
    variance: f64,
}

impl Limit {
    /// `most` bytes for `what`, which grows as eps^-`power` with the cells of both grids, at least.
    pub fn new<const D: usize>(what: &'static str, most: u64, grids: [&Grid<D>; 2], power: usize) -> Self {
        Limit { what, most, cells: Some((grids.map(Grid::cell), power as i32)) }
    }

    /// `most` bytes for `what`, whatever it grows with.
    pub fn of(what: &'static str, most: u64) -> Self {
        Limit { what, most, cells: None }
    }

    /// No limit.
    pub fn none() -> Self {
        Limit::of("", u64::MAX)
    }

    /// Bytes.
    pub fn most(&self) -> u64 {
        self.most
    }

    /// Whether an estimate is beyond it for sure, or nearly so.
    pub fn is_passed_by(&self, estimate: &Estimate) -> bool {
        estimate.bytes - 2.0 * estimate.variance.sqrt() > self.most as f64
    }

    /// The error of what would take `bytes`; `n_steps` of time would fit too.
    pub fn refusal(&self, bytes: f64, n_steps: Option<usize>) -> Error {
        let fit = self.cells.map(|(cells, power)| {
            let part = bytes / self.most.max(1) as f64;
            let larger = (102.0 * part.powf(1.0 / f64::from(power))).ceil() / 100.0;
            let [one, two] = cells.map(|eps| {
                let eps = eps * larger;
                number(format!("{eps:.3e}").parse().unwrap_or(eps))
            });
            let steps = n_steps.map(|n| format!(", or with {n} steps of time")).unwrap_or_default();
            format!(", which would fit with cells about {larger} times as large ({one} and {two}){steps},")
        });
        Error::OutOfMemory {
            what: format!("{}{}", self.what, fit.unwrap_or_default()),
            bytes: bytes as u128,
            limit: Some(self.most.into()),
        }
    }
}

impl Estimate {
    /// From what `bytes_of` tells of some of `rows`; none where these are few.
    pub fn of(
        rows: &Bits,
        workers: &Workers,
        bytes_of: impl Fn(usize) -> Result<usize> + Sync + Send,
    ) -> Result<Option<Self>> {
        let n_rows = rows.count();
        let n = SAMPLE.min(n_rows / ONE_OF);
        if n < 2 {
            return Ok(None);
        }
        // Multiples of the golden ratio lie evenly, and in no step with the grid's rows.
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let mut ranks: Vec<usize> = try_with_capacity(n, "a sample of rows")?;
        ranks.extend((0..n).map(|k| (((k as f64 + 0.5) * GOLDEN).fract() * n_rows as f64) as usize));
        ranks.sort_unstable();
        let mut sample: Vec<usize> = try_with_capacity(n, "a sample of rows")?;
        for (rank, row) in rows.iter().enumerate() {
            while ranks.get(sample.len()) == Some(&rank) {
                sample.push(row);
            }
        }
        let (mut sum, mut squares) = (0.0, 0.0);
        for bytes in workers.map(n, |k| bytes_of(sample[k])) {
            let bytes = bytes? as f64;
            sum += bytes;
            squares += bytes * bytes;
        }
        let (n, n_rows) = (n as f64, n_rows as f64);
        let variance = ((squares - sum * sum / n) / (n - 1.0)).max(0.0);
        Ok(Some(Estimate { bytes: sum / n * n_rows, variance: variance / n * n_rows * n_rows }))
    }

    /// Bytes.
    pub fn bytes(&self) -> f64 {
        self.bytes
    }

    /// This and another.
    pub fn plus(&self, other: &Self) -> Self {
        Estimate { bytes: self.bytes + other.bytes, variance: self.variance + other.variance }
    }

    /// This and `bytes` more.
    pub fn and(&self, bytes: f64) -> Self {
        Estimate { bytes: self.bytes + bytes, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_tell_the_whole() {
        let rows = Bits::of(100_000, |i| i % 3 != 0).unwrap();
        let workers = Workers::new(2).unwrap();
        let bytes = |i: usize| 10 + i / 500 + i % 100;
        let whole: usize = rows.iter().map(bytes).sum();
        let estimate = Estimate::of(&rows, &workers, |i| Ok(bytes(i))).unwrap().unwrap();
        assert!((estimate.bytes / whole as f64 - 1.0).abs() < 0.02, "{} {whole}", estimate.bytes);
        let grid = Grid::new([0.0; 2], 0.1, [10, 10]).unwrap();
        let limit = |share: f64| Limit::new("it", (share * whole as f64) as u64, [&grid, &grid], 3);
        assert!(limit(0.85).is_passed_by(&estimate) && !limit(1.0).is_passed_by(&estimate));
        let told = limit(1.0).refusal(8.0 * whole as f64, Some(30)).to_string();
        let head = "it, which would fit with cells about 2.04 times as large (0.204 and 0.204), or with 30 steps of time, would take";
        assert!(told.starts_with(head), "{told}");
        // Few rows are not worth a sample.
        let few = Estimate::of(&Bits::all(20).unwrap(), &workers, |_| Ok(1 << 40)).unwrap();
        assert!(few.is_none());
    }
}
