//! Axis-aligned boxes.

use super::vec3::{Vec3, norm, sub};

/// The smallest axis-aligned box around some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box around no point: grows from here by [`Bounds::include`].
    pub const EMPTY: Bounds = Bounds { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// The box around `points`.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Vec3>) -> Self {
        points.into_iter().fold(Bounds::EMPTY, |b, p| b.include(*p))
    }

    /// This box grown to hold `p`.
    pub fn include(self, p: Vec3) -> Self {
        Bounds {
            min: std::array::from_fn(|a| self.min[a].min(p[a])),
            max: std::array::from_fn(|a| self.max[a].max(p[a])),
        }
    }

    /// This box grown to hold `other`.
    pub fn union(self, other: Bounds) -> Self {
        self.include(other.min).include(other.max)
    }

    /// Edge lengths.
    pub fn extents(&self) -> Vec3 {
        sub(self.max, self.min)
    }

    /// Centre.
    pub fn center(&self) -> Vec3 {
        std::array::from_fn(|a| 0.5 * (self.min[a] + self.max[a]))
    }

    /// Length D of the diagonal: the unit of every dimensionless figure.
    pub fn diagonal(&self) -> f64 {
        norm(self.extents())
    }
}
