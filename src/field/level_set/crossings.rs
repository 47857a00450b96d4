//! Which edges of the lattice the level set crosses, and their numbers: in the order of the lattice vertex at which they begin, then of
//! the axes along which they run.

use super::CubeEdge;
use super::cubes::Cubes;
use super::near::Near;
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

/// The crossed edges of a lattice, by the places of the vertices that are kept of it.
pub(super) struct Crossings {
    /// Per vertex: bit e - 1 is set where the edge along the axes e is crossed. D <= 3 leaves at most 7 edges.
    crossed: Vec<u8>,
    /// Per vertex: the number of the first edge that is crossed there or later.
    first: Vec<u32>,
    /// Crossed edges in all.
    pub len: usize,
}

impl Crossings {
    /// Bytes per vertex.
    pub const BYTES: u128 = 5;

    /// The edges that are crossed under the values `f` at the vertices of `near`.
    pub fn find<const D: usize>(near: &Near<D>, f: &[f64], workers: &Workers) -> Result<Self> {
        let mut crossed = try_vec(f.len(), 0_u8, WORK)?;
        let mut rest = &mut crossed[..];
        let mut layers = try_with_capacity(near.n_layers(), WORK)?;
        for layer in 0..near.n_layers() {
            let (mine, behind) = rest.split_at_mut(near.layer(layer).len());
            layers.push((layer, mine));
            rest = behind;
        }
        workers.for_each(layers, |(layer, crossed)| mark(near, f, layer, crossed));
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

    /// The number of an edge that is crossed, which begins at the vertex at `place` and runs along `axes`.
    pub fn number(&self, place: usize, axes: usize) -> u32 {
        debug_assert!(self.crossed[place] >> (axes - 1) & 1 == 1);
        let before = self.crossed[place] & ((1 << (axes - 1)) - 1);
        self.first[place] + before.count_ones()
    }

    /// The crossed edges in the order of their numbers.
    pub fn list<const D: usize>(&self, cubes: &Cubes<D>, near: &Near<D>) -> Result<Vec<Crossing>> {
        let mut list = try_with_capacity(self.len, WORK)?;
        let vertices = near.vertices(0..self.crossed.len());
        for (vertex, &crossed) in vertices.zip(&self.crossed).filter(|(_, crossed)| **crossed != 0) {
            let at = cubes.coordinates(vertex);
            for axes in (1..1 << D).filter(|axes| crossed >> (axes - 1) & 1 == 1) {
                list.push(Crossing { vertex, axes, faces: cubes.faces(at, CubeEdge { from: 0, axes }) });
            }
        }
        Ok(list)
    }
}

/// Marks the crossed edges that begin in a layer of vertices across the first axis, as `crossed` has them.
fn mark<const D: usize>(near: &Near<D>, f: &[f64], layer: usize, crossed: &mut [u8]) {
    let (cubes, first) = (near.counts(), near.layer(layer).start);
    // An edge is one of the cube that begins where it begins; where none does, on the upper faces, of the last before.
    let beyond = usize::from(layer == cubes[0]);
    near.each_mixed_cube(f, layer - beyond, |cube| {
        let last = (1..D).fold(beyond, |bits, a| bits | usize::from(cube.at[a] == cubes[a] - 1) << a);
        for from in (0..1_usize << D).filter(|from| from & !last == 0 && from & 1 == beyond) {
            let place = cube.place(from) - first;
            for axes in (1..1 << D).filter(|axes| axes & from == 0) {
                let differ = cube.negative >> from & 1 != cube.negative >> (from | axes) & 1;
                crossed[place] |= u8::from(differ) << (axes - 1);
            }
        }
    });
}
