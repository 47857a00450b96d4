//! The edges of a mesh, each with the facet sides along it; and sets of things that such edges join.
//!
//! What joins facets is an edge: a line between triangles, a vertex between segments, here an edge from the vertex to itself. A segment
//! has two sides: at the first it starts, forward; at the second it ends.

use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// A side of a facet: the edge it lies on and the way it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side<const D: usize> {
    /// The edge's vertices, lower number first; in the plane the same twice.
    pub edge: [u32; 2],
    /// D f + k for the side of facet f that goes from corner k to [`end_of`] k.
    id: usize,
    /// Whether the side runs from the lower vertex to the higher; in the plane, whether the segment starts there.
    pub forward: bool,
}

impl<const D: usize> Side<D> {
    /// Its facet.
    pub fn facet(&self) -> usize {
        self.id / D
    }

    /// Where it touches the edge's lower and higher vertex: D f + corner each.
    pub fn corners(&self) -> [usize; 2] {
        let (from, to) = (self.id, self.id - self.id % D + end_of::<D>(self.id % D));
        if self.forward { [from, to] } else { [to, from] }
    }
}

/// All sides, sorted by edge. Facets that repeat a vertex have no part in it: they are folded onto an edge.
#[derive(Debug)]
pub(crate) struct Edges<const D: usize> {
    sides: Vec<Side<D>>,
}

impl<const D: usize> Edges<D> {
    /// The edges of `facets` over `n_vertices`.
    pub fn of(facets: &[[u32; D]], n_vertices: usize) -> Result<Self> {
        let sides = || facets.iter().enumerate().filter(|(_, f)| !repeats_vertex(f)).flat_map(sides_of);
        // Counting sort by lower vertex, then each vertex's few sides by comparison.
        let mut ends = try_vec(n_vertices + 1, 0, "the edges of the mesh")?;
        for side in sides() {
            ends[side.edge[0] as usize + 1] += 1;
        }
        for v in 0..n_vertices {
            ends[v + 1] += ends[v];
        }
        let nowhere = Side { edge: [0; 2], id: 0, forward: true };
        let mut sorted = try_vec(ends[n_vertices], nowhere, "the edges of the mesh")?;
        for side in sides() {
            let next = &mut ends[side.edge[0] as usize];
            sorted[*next] = side;
            *next += 1;
        }
        for around in sorted.chunk_by_mut(|a, b| a.edge[0] == b.edge[0]) {
            around.sort_unstable();
        }
        Ok(Edges { sides: sorted })
    }

    /// Each edge as the sides along it, in order of vertices and facets.
    pub fn iter(&self) -> impl Iterator<Item = &[Side<D>]> {
        self.sides.chunk_by(|a, b| a.edge == b.edge)
    }
}

/// Whether a facet names a vertex more than once.
pub(crate) fn repeats_vertex<const D: usize>(f: &[u32; D]) -> bool {
    (1..D).any(|k| f[..k].contains(&f[k]))
}

/// The corner at which the side from corner k ends: the next of a triangle, k itself of a segment.
const fn end_of<const D: usize>(k: usize) -> usize {
    (k + D - 2) % D
}

fn sides_of<const D: usize>((i, f): (usize, &[u32; D])) -> [Side<D>; D] {
    std::array::from_fn(|k| {
        let (from, to) = (f[k], f[end_of::<D>(k)]);
        let forward = if D == 2 { k == 0 } else { from < to };
        Side { edge: [from.min(to), from.max(to)], id: D * i + k, forward }
    })
}

/// Disjoint sets over 0..n, each known by its smallest member.
#[derive(Debug)]
pub(crate) struct Sets {
    parent: Vec<usize>,
}

impl Sets {
    /// n sets of one.
    pub fn new(n: usize) -> Result<Self> {
        let mut parent = try_with_capacity(n, "the parts of the mesh")?;
        parent.extend(0..n);
        Ok(Sets { parent })
    }

    /// The smallest member of the set of `i`.
    pub fn find(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            // Path halving keeps the trees flat.
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Makes one set of those of `i` and `j`.
    pub fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.find(i), self.find(j));
        self.parent[i.max(j)] = i.min(j);
    }

    /// Whether `i` is the smallest member of its set.
    pub fn is_first(&self, i: usize) -> bool {
        self.parent[i] == i
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_share_one_edge() {
        let edges = Edges::of(&[[0, 1, 2], [2, 1, 3], [3, 3, 1]], 4).unwrap();
        let shared: Vec<_> = edges.iter().filter(|sides| sides.len() == 2).collect();
        assert_eq!((edges.iter().count(), shared.len()), (5, 1));
        let [a, b] = shared[0] else { panic!("two sides") };
        assert_eq!((a.edge, a.facet(), b.facet()), ([1, 2], 0, 1));
        assert_eq!((a.corners(), b.corners()), ([1, 2], [4, 3]));
        assert!(a.forward && !b.forward);
        assert_eq!(Edges::<3>::of(&[], 0).unwrap().iter().count(), 0);
    }

    #[test]
    fn two_segments_share_one_vertex() {
        let edges = Edges::of(&[[4, 1], [1, 2], [3, 3]], 5).unwrap();
        let shared: Vec<_> = edges.iter().filter(|sides| sides.len() == 2).collect();
        assert_eq!((edges.iter().count(), shared.len()), (3, 1));
        let [a, b] = shared[0] else { panic!("two sides") };
        assert_eq!((a.edge, a.facet(), b.facet()), ([1, 1], 0, 1));
        assert_eq!((a.corners(), b.corners()), ([1, 1], [2, 2]));
        assert!(!a.forward && b.forward);
    }

    #[test]
    fn sets_are_known_by_their_smallest_member() {
        let mut sets = Sets::new(5).unwrap();
        sets.join(4, 2);
        sets.join(2, 1);
        sets.join(1, 4);
        assert_eq!((0..5).map(|i| sets.find(i)).collect::<Vec<_>>(), [0, 1, 1, 3, 1]);
        assert_eq!((0..5).filter(|&i| sets.is_first(i)).count(), 3);
    }
}
