//! How good a facet is: its shape, and how far it leans from the level set.

use super::Surface;
use crate::geometry::facet;
use crate::geometry::vec::{dot, norm, sub};

/// Shape and lean of a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quality {
    /// Of a triangle 1 when equilateral, 0 when flat; of a segment its length in units of h, at most 1.
    pub shape: f64,
    /// Cosine of the angle between the facet's normal and the level set's at its corners.
    pub cosine: f64,
}

impl Quality {
    /// Better than any facet: where a minimum starts.
    pub const BEST: Quality = Quality { shape: 1.0, cosine: 1.0 };

    /// The worse of both in either respect.
    pub fn worse(self, other: Quality) -> Quality {
        Quality { shape: self.shape.min(other.shape), cosine: self.cosine.min(other.cosine) }
    }
}

impl<const D: usize> Surface<D> {
    /// The quality of a facet with these corners, where edges are to have length `h`; `at(v)` gives place and normal of vertex v.
    pub fn quality(facet: [u32; D], h: f64, at: impl Fn(u32) -> ([f64; D], [f64; D])) -> Quality {
        let ends = facet.map(&at);
        let corners = ends.map(|(p, _)| p);
        let n = facet::normal(&corners);
        let size = norm(n);
        let toward: [f64; D] = std::array::from_fn(|a| ends.iter().map(|(_, m)| m[a]).sum());
        let lean = dot(n, toward) / (size * norm(toward));
        let squares: f64 = (0..D).map(|k| sub(corners[(k + 1) % D], corners[k])).map(|e| dot(e, e)).sum();
        let shape = match D {
            2 => (size / h).min(1.0),
            // 4 sqrt(3) area / sum of squared sides.
            _ => 2.0 * 3.0_f64.sqrt() * size / squares,
        };
        // A facet of no size has neither shape nor side.
        Quality { shape: if shape.is_nan() { 0.0 } else { shape }, cosine: if lean.is_nan() { -1.0 } else { lean } }
    }
}
