//! Pairs of triangles of two meshes that are near each other: both trees of boxes descended together.

use super::bvh::STACK_SIZE;
use super::vec::{Vec3, add, dot, scale};
use super::{Bounds, DistanceTree};

/// A triangle of each mesh.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    /// Index in the first mesh, and in the second.
    pub facets: [u32; 2],
    /// In [`Pairs`]' unit.
    pub corners: [[Vec3; 3]; 2],
    /// Squared distance of their boxes.
    pub apart_squared: f64,
}

/// Two meshes, the second moved, in the unit of the first one's tree.
pub(crate) struct Pairs<'a> {
    a: &'a DistanceTree,
    b: &'a DistanceTree,
    /// Brings the second tree's coordinates to the unit.
    scale: f64,
    shift: Vec3,
}

impl<'a> Pairs<'a> {
    /// Of `a`, and `b` moved by `translation`, all of a size whose squares are finite in the unit of `a`.
    pub fn new(a: &'a DistanceTree, b: &'a DistanceTree, translation: Vec3) -> Self {
        Pairs { a, b, scale: b.unit.grow * a.unit.shrink, shift: scale(a.unit.shrink, translation) }
    }

    /// Multiplies lengths in the unit to be in the caller's.
    pub fn grow(&self) -> f64 {
        self.a.unit.grow
    }

    /// Multiplies lengths in the caller's unit.
    pub fn shrink(&self) -> f64 {
        self.a.unit.shrink
    }

    /// Calls `visit` with the pairs whose boxes are no farther apart than `reach`, squared; it gives the squared reach for the rest, no
    /// larger, below 0 to end.
    pub fn visit(&self, mut reach_squared: f64, mut visit: impl FnMut(&Pair) -> f64) {
        let mut stack = [([0usize; 2], 0.0); 2 * STACK_SIZE];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let ([a, b], apart_squared) = stack[depth];
            if apart_squared > reach_squared {
                continue;
            }
            let (node_a, node_b) = (&self.a.tree.nodes[a], &self.b.tree.nodes[b]);
            let children = match (node_a.leaf(), node_b.leaf()) {
                (Some(places_a), Some(places_b)) => {
                    for i in places_a {
                        for j in places_b.clone() {
                            let pair = self.pair(i, j);
                            if pair.apart_squared <= reach_squared {
                                reach_squared = visit(&pair);
                            }
                        }
                    }
                    continue;
                }
                (Some(_), None) => node_b.children().map(|b| [a, b]),
                (None, Some(_)) => node_a.children().map(|a| [a, b]),
                // The larger box is halved, so that both shrink alike.
                (None, None) if self.moved(node_b.bounds).diagonal() > node_a.bounds.diagonal() => {
                    node_b.children().map(|b| [a, b])
                }
                (None, None) => node_a.children().map(|a| [a, b]),
            };
            let [first, second] = children.map(|[a, b]| {
                ([a, b], apart_squared_of(&self.a.tree.nodes[a].bounds, &self.moved(self.b.tree.nodes[b].bounds)))
            });
            let (near, far) = if second.1 < first.1 { (second, first) } else { (first, second) };
            stack[depth] = far;
            stack[depth + 1] = near;
            depth += 2;
        }
    }

    /// The triangles at these places of the trees.
    fn pair(&self, i: usize, j: usize) -> Pair {
        let corners = [self.a.corners[i], self.b.corners[j].map(|p| add(scale(self.scale, p), self.shift))];
        let apart_squared = apart_squared_of(&Bounds::of(&corners[0]), &Bounds::of(&corners[1]));
        Pair { facets: [self.a.tree.order[i], self.b.tree.order[j]], corners, apart_squared }
    }

    fn moved(&self, bounds: Bounds) -> Bounds {
        let moved = |p: Vec3| add(scale(self.scale, p), self.shift);
        Bounds { min: moved(bounds.min), max: moved(bounds.max) }
    }
}

/// Squared distance of two boxes, 0 where they meet.
fn apart_squared_of(a: &Bounds, b: &Bounds) -> f64 {
    let gap = |k: usize| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]).max(0.0);
    let gaps: Vec3 = std::array::from_fn(gap);
    dot(gaps, gaps)
}
