//! The edges of a triangle mesh, each with the triangle sides along it; and sets of things that such edges join.

use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// A side of a triangle: the edge it lies on and the way it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    /// The edge's vertices, lower number first.
    pub edge: [u32; 2],
    /// 3 t + k for the side from corner k to corner k + 1 of triangle t.
    id: usize,
    /// Whether the side runs from the lower vertex to the higher.
    pub forward: bool,
}

impl Side {
    /// Its triangle.
    pub fn triangle(&self) -> usize {
        self.id / 3
    }

    /// Where it touches the edge's lower and higher vertex: 3 t + corner each.
    pub fn corners(&self) -> [usize; 2] {
        let (from, to) = (self.id, self.id - self.id % 3 + (self.id + 1) % 3);
        if self.forward { [from, to] } else { [to, from] }
    }
}

/// All sides, sorted by edge. Triangles that repeat a vertex have no part in it: they are folded onto an edge.
#[derive(Debug)]
pub(crate) struct Edges {
    sides: Vec<Side>,
}

impl Edges {
    /// The edges of `triangles` over `n_vertices`.
    pub fn of(triangles: &[[u32; 3]], n_vertices: usize) -> Result<Self> {
        let sides = || triangles.iter().enumerate().filter(|(_, t)| !repeats_vertex(t)).flat_map(sides_of);
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

    /// Each edge as the sides along it, in order of vertices and triangles.
    pub fn iter(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.edge == b.edge)
    }
}

/// Whether a triangle names a vertex more than once.
pub(crate) fn repeats_vertex(t: &[u32; 3]) -> bool {
    t[0] == t[1] || t[1] == t[2] || t[2] == t[0]
}

fn sides_of((i, t): (usize, &[u32; 3])) -> [Side; 3] {
    std::array::from_fn(|k| {
        let (from, to) = (t[k], t[(k + 1) % 3]);
        Side { edge: [from.min(to), from.max(to)], id: 3 * i + k, forward: from < to }
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
        assert_eq!((a.edge, a.triangle(), b.triangle()), ([1, 2], 0, 1));
        assert_eq!((a.corners(), b.corners()), ([1, 2], [4, 3]));
        assert!(a.forward && !b.forward);
        assert_eq!(Edges::of(&[], 0).unwrap().iter().count(), 0);
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
