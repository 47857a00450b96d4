//! Scaling to the size 1 by a power of two, which rounds nothing.
//!
//! Areas and squared distances of a scaled shape neither overflow nor vanish, whatever the caller's units; and results do not
//! depend, to the bit, on a power of two in them.

use super::vec::scale;
use super::{Bounds, Mesh};
use crate::Result;
use crate::error::try_with_capacity;

/// Exponents that leave the factor and its inverse normal numbers.
const MAX_EXPONENT: i32 = 1022;

/// The power of two that brings coordinates to size 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    /// Multiplies the caller's coordinates.
    pub shrink: f64,
    /// Multiplies results: 1 / shrink.
    pub grow: f64,
}

impl Unit {
    /// The unit in which the largest coordinate of `mesh` lies in [1, 2), where such a unit exists.
    pub fn of<const D: usize>(mesh: &Mesh<D>) -> Self {
        Unit::of_bounds(&mesh.bounds())
    }

    /// The unit in which the largest coordinate of the corners of `bounds` lies in [1, 2), where such a unit exists.
    pub fn of_bounds<const D: usize>(bounds: &Bounds<D>) -> Self {
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |m: f64, x| m.max(x.abs()));
        let exponent = (((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023).clamp(-MAX_EXPONENT, MAX_EXPONENT);
        let power = |e: i32| f64::from_bits(((1023 + e) as u64) << 52);
        Unit { shrink: power(-exponent), grow: power(exponent) }
    }

    /// A copy of `mesh` of size 1.
    pub fn shrunk<const D: usize>(&self, mesh: &Mesh<D>) -> Result<Mesh<D>> {
        let mut vertices: Vec<[f64; D]> = try_with_capacity(mesh.vertices().len(), "the scaled vertices")?;
        // A vertex that no facet uses may overflow, and must not be refused for it.
        vertices.extend(mesh.vertices().iter().map(|&v| scale(self.shrink, v).map(|x| x.clamp(f64::MIN, f64::MAX))));
        let mut facets = try_with_capacity(mesh.facets().len(), "the scaled facets")?;
        facets.extend_from_slice(mesh.facets());
        Mesh::new(vertices, facets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brings_every_size_to_one() {
        for size in [5e-324, 1e-300, 1e-9, 0.75, 1.0, 1.5, 1e9, f64::MAX] {
            let mesh = Mesh::new(vec![[0.0; 3], [size, 0.0, 0.0], [0.0, -size, 0.0]], vec![[0, 1, 2]]).unwrap();
            let unit = Unit::of(&mesh);
            assert_eq!(unit.shrink * unit.grow, 1.0);
            if size > 1e-308 && size < f64::MAX {
                assert!((1.0..2.0).contains(&(size * unit.shrink)), "{size}");
            }
        }
    }
}
