//! Axis-aligned boxes.

use super::vec::{norm, sub};

/// Diagonals that leave room for squares, cubes and quotients of lengths in a double.
pub(crate) const DIAGONALS: std::ops::RangeInclusive<f64> = 1e-90..=1e90;

/// The smallest axis-aligned box around some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds<const D: usize = 3> {
    /// Lower corner.
    pub min: [f64; D],
    /// Upper corner.
    pub max: [f64; D],
}

impl<const D: usize> Bounds<D> {
    /// The box around no point: grows from here by [`Bounds::include`].
    pub const EMPTY: Self = Bounds { min: [f64::INFINITY; D], max: [f64::NEG_INFINITY; D] };

    /// The box around `points`.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a [f64; D]>) -> Self {
        points.into_iter().fold(Bounds::EMPTY, |b, p| b.include(*p))
    }

    /// This box grown to hold `p`.
    pub fn include(self, p: [f64; D]) -> Self {
        Bounds {
            min: std::array::from_fn(|a| self.min[a].min(p[a])),
            max: std::array::from_fn(|a| self.max[a].max(p[a])),
        }
    }

    /// This box grown to hold `other`.
    pub fn union(self, other: Self) -> Self {
        self.include(other.min).include(other.max)
    }

    /// Edge lengths.
    pub fn extents(&self) -> [f64; D] {
        sub(self.max, self.min)
    }

    /// Centre.
    pub fn center(&self) -> [f64; D] {
        std::array::from_fn(|a| 0.5 * (self.min[a] + self.max[a]))
    }

    /// Length D of the diagonal: the unit of every dimensionless figure.
    pub fn diagonal(&self) -> f64 {
        norm(self.extents())
    }
}
