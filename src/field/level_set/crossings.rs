//! Which edges of the lattice the level set crosses, and their numbers: in the order of the lattice vertex at which they begin, then of
//! the axes along which they run.

use super::CubeEdge;
use super::cubes::Cubes;
use crate::error::{try_vec, try_with_capacity};
use crate::par::Workers;
use crate::{Error, Result};

/// What the memory is for, should it run out.
const WORK: &str = "the crossings of the level set";

/// An edge of the lattice whose ends have values of different sign. A value of 0 counts as positive.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// The lattice vertex at which it begins.
    pub vertex: usize,
    /// The axes along which it runs, as bits.
    pub axes: usize,
    /// Faces of the box that hold it.
    pub faces: u8,
}

/// The crossed edges of a lattice.
pub(super) struct Crossings {
    /// Per lattice vertex: bit e - 1 is set where the edge along the axes e is crossed. D <= 3 leaves at most 7 edges.
    crossed: Vec<u8>,
    /// Per lattice vertex: the number of the first edge that is crossed there or later.
    first: Vec<u32>,
    /// Crossed edges in all.
    pub len: usize,
}

impl Crossings {
    /// Bytes per lattice vertex.
    pub const BYTES: u128 = 5;

    /// The crossed edges of `cubes` under the values `f` at their vertices.
    pub fn find<const D: usize>(cubes: &Cubes<D>, f: &[f64], workers: &Workers) -> Result<Self> {
        let mut crossed = try_vec(f.len(), 0_u8, WORK)?;
        let offsets: Vec<usize> = (0..1 << D).map(|axes| cubes.offset(axes)).collect();
        let plane = cubes.strides[0];
        workers.for_each(crossed.chunks_mut(plane).enumerate(), |(i, crossed)| {
            for (j, crossed) in crossed.iter_mut().enumerate() {
                let vertex = i * plane + j;
                let at = cubes.coordinates(vertex);
                let last = (0..D).fold(0, |bits, a| bits | usize::from(at[a] == cubes.shape[a] - 1) << a);
                for axes in (1..1 << D).filter(|axes| axes & last == 0) {
                    *crossed |= u8::from((f[vertex] < 0.0) != (f[vertex + offsets[axes]] < 0.0)) << (axes - 1);
                }
            }
        });
        let mut first = try_with_capacity(f.len(), WORK)?;
        let mut len = 0_usize;
        for crossed in &crossed {
            // Checked below, before any number is used.
            first.push(len as u32);
            len += crossed.count_ones() as usize;
        }
        if len > u32::MAX as usize {
            let most = u32::MAX;
            let text =
                format!("the level set has {len} vertices; at most {most} are served: fewer subdivisions are needed");
            return Err(Error::Unsupported(text));
        }
        Ok(Crossings { crossed, first, len })
    }

    /// The number of an edge that is crossed, which begins at `vertex` and runs along `axes`.
    pub fn number(&self, vertex: usize, axes: usize) -> u32 {
        debug_assert!(self.crossed[vertex] >> (axes - 1) & 1 == 1);
        let before = self.crossed[vertex] & ((1 << (axes - 1)) - 1);
        self.first[vertex] + before.count_ones()
    }

    /// The crossed edges in the order of their numbers.
    pub fn list<const D: usize>(&self, cubes: &Cubes<D>) -> Result<Vec<Crossing>> {
        let mut list = try_with_capacity(self.len, WORK)?;
        for (vertex, &crossed) in self.crossed.iter().enumerate().filter(|(_, crossed)| **crossed != 0) {
            let at = cubes.coordinates(vertex);
            for axes in (1..1 << D).filter(|axes| crossed >> (axes - 1) & 1 == 1) {
                list.push(Crossing { vertex, axes, faces: cubes.faces(at, CubeEdge { from: 0, axes }) });
            }
        }
        Ok(list)
    }
}
