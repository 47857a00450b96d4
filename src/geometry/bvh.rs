//! A tree of bounding boxes over things that have one, triangles or points, in one flat array.
//!
//! Built top down: a node is split where the surface area heuristic, evaluated at [`N_BINS`] bins along the axis on which the
//! centroids spread widest, finds the cheapest cut (Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007).

use super::Bounds;
use super::vec::dot;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use std::ops::Range;

/// Things in a leaf at most.
pub(super) const LEAF_SIZE: usize = 4;

/// Bins of the surface area heuristic.
const N_BINS: usize = 16;

/// Below this depth nodes are halved by number, which ends the tree within 32 levels more whatever the boxes.
const MAX_HEURISTIC_DEPTH: u32 = 60;

/// Nodes that a traversal may have to remember: one a level.
pub(super) const STACK_SIZE: usize = 96;

/// A node: its box, and either two children or some things.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node<const D: usize> {
    pub bounds: Bounds<D>,
    /// A leaf's first thing, or the first child; the second follows it.
    first: u32,
    /// Things of a leaf; 0 for an inner node.
    count: u32,
}

impl<const D: usize> Node<D> {
    /// The things of a leaf, `None` for an inner node.
    #[inline]
    pub fn leaf(&self) -> Option<Range<usize>> {
        (self.count > 0).then(|| self.first as usize..(self.first + self.count) as usize)
    }

    /// The children of an inner node.
    #[inline]
    pub fn children(&self) -> [usize; 2] {
        [self.first as usize, self.first as usize + 1]
    }

    /// Squared distance from `p` to the box, 0 inside.
    #[inline]
    pub fn distance_squared(&self, p: [f64; D]) -> f64 {
        let Bounds { min, max } = &self.bounds;
        let outside = |a: usize| (min[a] - p[a]).max(p[a] - max[a]).max(0.0);
        let d: [f64; D] = std::array::from_fn(outside);
        dot(d, d)
    }
}

/// The tree. Its leaves hold successive things of an order of its own.
#[derive(Debug)]
pub(super) struct Bvh<const D: usize> {
    /// The root first, children after their parents.
    pub nodes: Vec<Node<D>>,
    /// The thing at each place of the tree's order.
    pub order: Vec<u32>,
}

/// What the build moves about: a thing with its box.
#[derive(Clone, Copy)]
struct Item<const D: usize> {
    bounds: Bounds<D>,
    thing: u32,
}

/// A node still to be split.
struct Task {
    node: usize,
    items: Range<usize>,
    depth: u32,
}

impl<const D: usize> Bvh<D> {
    /// The tree of `n` > 0 things, at most 2^31 - 1, of which `bounds` tells the boxes.
    pub fn new(n: usize, bounds: impl Fn(usize) -> Bounds<D>) -> Result<Self> {
        let mut items = try_with_capacity(n, "the boxes of a tree")?;
        items.extend((0..n).map(|i| Item { bounds: bounds(i), thing: i as u32 }));

        // A leaf has at least one thing, so there are at most n leaves and n - 1 inner nodes.
        let mut nodes = try_with_capacity(2 * n, "the tree of boxes")?;
        nodes.push(leaf(&items, 0..n));
        let mut tasks = vec![Task { node: 0, items: 0..n, depth: 0 }];
        while let Some(Task { node, items: range, depth }) = tasks.pop() {
            if range.len() <= LEAF_SIZE {
                continue;
            }
            let middle = range.start + split(&mut items[range.clone()], depth);
            let first = nodes.len();
            nodes[node].first = first as u32;
            nodes[node].count = 0;
            for (child, items_of_child) in [range.start..middle, middle..range.end].into_iter().enumerate() {
                nodes.push(leaf(&items, items_of_child.clone()));
                tasks.push(Task { node: first + child, items: items_of_child, depth: depth + 1 });
            }
        }
        nodes.shrink_to_fit();
        let mut order = try_vec(n, 0, "the order of a tree")?;
        order.iter_mut().zip(&items).for_each(|(i, item)| *i = item.thing);
        Ok(Bvh { nodes, order })
    }
}

fn leaf<const D: usize>(items: &[Item<D>], range: Range<usize>) -> Node<D> {
    let (first, count) = (range.start as u32, range.len() as u32);
    Node { bounds: items[range].iter().fold(Bounds::EMPTY, |b, i| b.union(i.bounds)), first, count }
}

/// Reorders `items` so that the first part goes left and the rest right; gives the first part's length, neither part empty.
fn split<const D: usize>(items: &mut [Item<D>], depth: u32) -> usize {
    let centroids = items.iter().fold(Bounds::EMPTY, |b, i| b.include(i.bounds.center()));
    let extents = centroids.extents();
    let axis = (0..D).fold(0, |widest, a| if extents[a] > extents[widest] { a } else { widest });
    let halves = items.len() / 2;
    if depth >= MAX_HEURISTIC_DEPTH {
        let by_centroid = |i: &Item<D>| i.bounds.center()[axis];
        items.select_nth_unstable_by(halves, |a, b| {
            by_centroid(a).total_cmp(&by_centroid(b)).then(a.thing.cmp(&b.thing))
        });
        return halves;
    }
    let per_length = N_BINS as f64 / extents[axis];
    let bin_of =
        |i: &Item<D>| (((i.bounds.center()[axis] - centroids.min[axis]) * per_length) as usize).min(N_BINS - 1);
    let cut = cheapest_cut(items, bin_of);
    let middle = partition(items, |i| bin_of(i) < cut);
    // All centroids equal: any halves do.
    if middle == 0 || middle == items.len() { halves } else { middle }
}

/// The bin before which to cut, so that area times number, summed over both sides, is least.
fn cheapest_cut<const D: usize>(items: &[Item<D>], bin_of: impl Fn(&Item<D>) -> usize) -> usize {
    let mut bins = [(Bounds::EMPTY, 0_usize); N_BINS];
    for item in items {
        let (bounds, count) = &mut bins[bin_of(item)];
        *bounds = bounds.union(item.bounds);
        *count += 1;
    }
    let mut right_costs = [0.0; N_BINS];
    let mut right = (Bounds::EMPTY, 0);
    for k in (1..N_BINS).rev() {
        right = (right.0.union(bins[k].0), right.1 + bins[k].1);
        right_costs[k] = cost(right);
    }
    let mut left = (Bounds::EMPTY, 0);
    let mut best = (f64::INFINITY, N_BINS / 2);
    for k in 1..N_BINS {
        left = (left.0.union(bins[k - 1].0), left.1 + bins[k - 1].1);
        let both = cost(left) + right_costs[k];
        if both < best.0 && left.1 > 0 && left.1 < items.len() {
            best = (both, k);
        }
    }
    best.1
}

/// Half the box's surface, or rim in the plane, times the number in it.
fn cost<const D: usize>((bounds, count): (Bounds<D>, usize)) -> f64 {
    if count == 0 {
        return 0.0;
    }
    let extents = bounds.extents();
    let half = match D {
        2 => extents[0] + extents[1],
        _ => (0..D).map(|a| extents[a] * extents[(a + 1) % D]).sum(),
    };
    half * count as f64
}

/// Moves the items that go left to the front; gives their number.
fn partition<const D: usize>(items: &mut [Item<D>], goes_left: impl Fn(&Item<D>) -> bool) -> usize {
    let mut n_left = 0;
    for i in 0..items.len() {
        if goes_left(&items[i]) {
            items.swap(i, n_left);
            n_left += 1;
        }
    }
    n_left
}

#[cfg(test)]
mod tests {
    use super::super::Mesh;
    use super::super::shapes::torus;
    use super::super::vec::Vec3;
    use super::*;

    /// Every triangle is in one leaf, inside the boxes above it, and no path is longer than a traversal can remember.
    fn validate(mesh: &Mesh) {
        let tree = Bvh::new(mesh.triangles().len(), |t| Bounds::of(&mesh.corners(t))).unwrap();
        let mut seen = vec![0; mesh.triangles().len()];
        let mut stack = vec![(0, 1)];
        while let Some((node, depth)) = stack.pop() {
            assert!(depth < STACK_SIZE);
            let bounds = tree.nodes[node].bounds;
            if let Some(range) = tree.nodes[node].leaf() {
                assert!((1..=LEAF_SIZE).contains(&range.len()));
                for &t in &tree.order[range] {
                    seen[t as usize] += 1;
                    assert_eq!(bounds.union(Bounds::of(&mesh.corners(t as usize))), bounds);
                }
            } else {
                for child in tree.nodes[node].children() {
                    assert_eq!(bounds.union(tree.nodes[child].bounds), bounds);
                    stack.push((child, depth + 1));
                }
            }
        }
        assert!(seen.iter().all(|&n| n == 1));
    }

    #[test]
    fn trees_are_well_formed() {
        let ring = torus(3.0, 1.0, 40, 17).unwrap();
        validate(&ring);
        for n in 1..20 {
            validate(&Mesh::new(ring.vertices().to_vec(), ring.triangles()[..n].to_vec()).unwrap());
        }
    }

    #[test]
    fn equal_and_ever_smaller_triangles_do_not_deepen_the_tree() {
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        validate(&Mesh::new(corners, vec![[0, 1, 2]; 1000]).unwrap());
        let vertices: Vec<Vec3> = (0..1000).map(|i| [2.0_f64.powi(-i), 0.0, 0.0]).collect();
        let triangles = (0..998).map(|i| [i, i + 1, i + 2]).collect();
        validate(&Mesh::new(vertices, triangles).unwrap());
    }
}
