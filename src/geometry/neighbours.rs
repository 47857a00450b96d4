//! The nearest of many points.

use super::Bounds;
use super::bvh::{Bvh, STACK_SIZE};
use super::vec::{dot, sub};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// A neighbour and the square of its distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Index of the point.
    pub index: u32,
    /// Squared distance to the query.
    pub distance_squared: f64,
}

impl Neighbour {
    /// Whether no point from `distance_squared` and `index` on comes before this one.
    fn is_before(&self, distance_squared: f64, index: u32) -> bool {
        (self.distance_squared, self.index) < (distance_squared, index)
    }
}

/// A tree over points, for nearest neighbours.
#[derive(Debug)]
pub struct Neighbours<const D: usize = 3> {
    tree: Bvh<D>,
    /// In the tree's order.
    points: Vec<[f64; D]>,
    /// The lowest index below each node: of many points at one distance, thousands at one place, say, only a few can be among the first.
    lowest: Vec<u32>,
}

impl<const D: usize> Neighbours<D> {
    /// The tree of `points` [n x D], n > 0, all of a size whose squares are finite.
    pub fn new(points: &[[f64; D]]) -> Result<Self> {
        let tree = Bvh::new(points.len(), |i| Bounds { min: points[i], max: points[i] })?;
        let mut in_order = try_with_capacity(points.len(), "the tree of points")?;
        in_order.extend(tree.order.iter().map(|&i| points[i as usize]));
        let mut lowest = try_vec(tree.nodes.len(), 0, "the tree of points")?;
        // Children come after their parents.
        for (i, node) in tree.nodes.iter().enumerate().rev() {
            lowest[i] = match node.leaf() {
                Some(places) => tree.order[places].iter().fold(u32::MAX, |low, &i| low.min(i)),
                None => node.children().map(|c| lowest[c]).into_iter().fold(u32::MAX, u32::min),
            };
        }
        Ok(Neighbours { tree, points: in_order, lowest })
    }

    /// The points by index, those near each other mostly in succession.
    pub fn order(&self) -> &[u32] {
        &self.tree.order
    }

    /// Fills `nearest` with the neighbours of `p` among the points that `accept` takes, nearest first, ties by index; gives how many there
    /// are, fewer than asked for where no more are accepted.
    pub fn nearest(&self, p: [f64; D], accept: impl Fn(usize) -> bool, nearest: &mut [Neighbour]) -> usize {
        let mut found = 0;
        let mut stack = [(0, 0.0); STACK_SIZE];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (node, box_distance) = stack[depth];
            if found == nearest.len() && nearest.last().is_some_and(|n| n.is_before(box_distance, self.lowest[node])) {
                continue;
            }
            let Some(places) = self.tree.nodes[node].leaf() else {
                let [a, b] = self.tree.nodes[node].children();
                let (to_a, to_b) = (self.tree.nodes[a].distance_squared(p), self.tree.nodes[b].distance_squared(p));
                let (near, far) = if to_b < to_a { ((b, to_b), (a, to_a)) } else { ((a, to_a), (b, to_b)) };
                stack[depth] = far;
                stack[depth + 1] = near;
                depth += 2;
                continue;
            };
            for place in places {
                let r = sub(self.points[place], p);
                let candidate = Neighbour { index: self.tree.order[place], distance_squared: dot(r, r) };
                if accept(candidate.index as usize) {
                    found = insert(candidate, nearest, found);
                }
            }
        }
        found
    }
}

impl<const D: usize> Neighbours<D> {
    /// The point at `place` in the order.
    pub fn at(&self, place: usize) -> [f64; D] {
        self.points[place]
    }

    /// The point nearest to `p`, the first of those as near; `hint` is its place in the order, or that of any point: one that is near makes
    /// the search short. Becomes the place that was found.
    pub fn nearest_from(&self, p: [f64; D], hint: &mut usize) -> Neighbour {
        let at = |place: usize| {
            let r = sub(self.points[place], p);
            Neighbour { index: self.tree.order[place], distance_squared: dot(r, r) }
        };
        let mut best = at(*hint);
        let mut stack = [(0, 0.0); STACK_SIZE];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (node, box_distance) = stack[depth];
            if best.is_before(box_distance, self.lowest[node]) {
                continue;
            }
            let Some(places) = self.tree.nodes[node].leaf() else {
                // One by one: the map of an array is a call that is not inlined.
                let [a, b] = self.tree.nodes[node].children();
                let (to_a, to_b) = (self.tree.nodes[a].distance_squared(p), self.tree.nodes[b].distance_squared(p));
                let (near, far) = if to_b < to_a { ((b, to_b), (a, to_a)) } else { ((a, to_a), (b, to_b)) };
                for child in [far, near] {
                    stack[depth] = child;
                    // Not kept where it can hold no nearer one: overwritten by the next.
                    depth += usize::from(child.1 <= best.distance_squared);
                }
                continue;
            };
            for place in places {
                let candidate = at(place);
                if !best.is_before(candidate.distance_squared, candidate.index) {
                    (best, *hint) = (candidate, place);
                }
            }
        }
        best
    }
}

/// Puts `candidate` in its place among the first `found` of `nearest`, if it has one; gives how many there are then.
fn insert(candidate: Neighbour, nearest: &mut [Neighbour], found: usize) -> usize {
    let before = |n: &Neighbour| (n.distance_squared, n.index) < (candidate.distance_squared, candidate.index);
    let place = nearest[..found].partition_point(before);
    if place == nearest.len() {
        return found;
    }
    let found = (found + 1).min(nearest.len());
    nearest[place..found].rotate_right(1);
    nearest[place] = candidate;
    found
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::super::vec::Vec3;
    use super::*;

    #[test]
    fn agrees_with_sorting_all_points() {
        let mut random = SplitMix64::new(1);
        for n in [1, 2, 5, 300] {
            // Few values a coordinate, so that there are ties and equal points.
            let points: Vec<Vec3> = (0..n).map(|_| std::array::from_fn(|_| (random.unit() * 8.0).floor())).collect();
            let tree = Neighbours::new(&points).unwrap();
            for query in &points {
                let even = |i: usize| i.is_multiple_of(2);
                let mut expected: Vec<(f64, u32)> = (0..n)
                    .filter(|&i| even(i))
                    .map(|i| (dot(sub(points[i], *query), sub(points[i], *query)), i as u32))
                    .collect();
                expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
                let mut nearest = [Neighbour { index: 0, distance_squared: 0.0 }; 7];
                let found = tree.nearest(*query, even, &mut nearest);
                assert_eq!(found, expected.len().min(7));
                for hint in [0, n / 2, n - 1] {
                    let mut place = hint;
                    let mut one = [Neighbour { index: 0, distance_squared: 0.0 }];
                    tree.nearest(*query, |_| true, &mut one);
                    assert_eq!(tree.nearest_from(*query, &mut place), one[0]);
                    assert_eq!(tree.order()[place], one[0].index);
                }
                let got: Vec<(f64, u32)> = nearest[..found].iter().map(|n| (n.distance_squared, n.index)).collect();
                assert_eq!(got, expected[..found]);
            }
        }
    }
}
