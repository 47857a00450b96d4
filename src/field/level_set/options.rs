//! What a level set can be asked for.

use crate::par::Workers;
use crate::{Error, Result};

/// Options of [`Field::level_set`](super::super::Field::level_set).
#[derive(Debug, Clone, PartialEq)]
pub struct LevelSetOptions {
    /// Lattice edges per cell of the field, along each axis. What is thinner than a lattice edge may be missed, or joined: this decides the
    /// topology, and most of the cost.
    pub subdivisions: u32,
    /// Edges of the result shorter than this fraction of the shortest cell edge are collapsed, where that changes neither topology nor
    /// side and bends no facet far from the level set; 0 keeps them all. This decides the size of the result.
    pub shortest_edge: f64,
    /// Rounds in which vertices move along the level set towards the middle of their neighbours.
    pub relaxations: u32,
    /// Threads: 0 for all cores, 1 for none but the caller's. They do not change the result.
    pub n_threads: u32,
    /// Bytes that the extraction may take; more is refused beforehand.
    pub memory_limit: u64,
}

impl Default for LevelSetOptions {
    /// Four lattice edges per cell: with two, fields of the bunny, the rotor and the spool lose or gain handles where a part is thinner
    /// than half a cell; with four they have those of the shape (tests/level_sets.rs).
    fn default() -> Self {
        LevelSetOptions { subdivisions: 4, shortest_edge: 0.3, relaxations: 6, n_threads: 0, memory_limit: 8 << 30 }
    }
}

impl LevelSetOptions {
    /// Lattice edges per cell at most.
    const MOST_SUBDIVISIONS: u32 = 1024;
    /// Rounds of relaxation at most; a few are all that help.
    const MOST_RELAXATIONS: u32 = 1000;

    /// Checks every range.
    pub fn validate(&self) -> Result<()> {
        let wrong = |text: String| Err(Error::InvalidArgument(text));
        if !(1..=Self::MOST_SUBDIVISIONS).contains(&self.subdivisions) {
            let (n, most) = (self.subdivisions, Self::MOST_SUBDIVISIONS);
            return wrong(format!("subdivisions is {n}; it must lie in [1, {most}]"));
        }
        // A NaN is in no range.
        if !(0.0..=1.0).contains(&self.shortest_edge) {
            return wrong(format!("shortest_edge is {}; it must lie in [0, 1]", self.shortest_edge));
        }
        if self.relaxations > Self::MOST_RELAXATIONS {
            let (n, most) = (self.relaxations, Self::MOST_RELAXATIONS);
            return wrong(format!("relaxations is {n}; it must be at most {most}"));
        }
        Workers::check(self.n_threads)
    }
}
