//! Vertices that share every bit made one: STL repeats a vertex in each of its triangles.

use std::collections::HashMap;

use super::builder::{check_vertex_count, push};
use super::fault::Read;
use crate::error::try_reserve_entry;
use crate::geometry::vec::Vec3;

/// Numbers points in the order in which they first come; equal points get one number.
#[derive(Default)]
pub(super) struct Welder {
    vertices: Vec<Vec3>,
    numbers: HashMap<[u64; 3], u32>,
}

impl Welder {
    /// The number of `p`, which must be finite.
    pub fn number(&mut self, p: Vec3) -> Read<u32> {
        // -0.0 + 0.0 is 0.0: the two zeros are one place.
        let p = p.map(|x| x + 0.0);
        let key = p.map(f64::to_bits);
        if let Some(&number) = self.numbers.get(&key) {
            return Ok(number);
        }
        let number = self.vertices.len();
        check_vertex_count(number + 1)?;
        try_reserve_entry(&mut self.numbers, "merging equal vertices")?;
        push(&mut self.vertices, p, "the vertices")?;
        self.numbers.insert(key, number as u32);
        Ok(number as u32)
    }

    /// Points so far, by number.
    pub fn into_vertices(self) -> Vec<Vec3> {
        self.vertices
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_points_share_a_number() {
        let mut welder = Welder::default();
        let points = [[0.0, 1.0, 2.0], [-0.0, 1.0, 2.0], [0.0, 1.0, 2.0000000000000004], [0.0, 1.0, 2.0]];
        assert_eq!(points.map(|p| welder.number(p).unwrap()), [0, 0, 1, 0]);
        assert_eq!(welder.into_vertices().len(), 2);
    }
}
