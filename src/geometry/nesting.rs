//! Whether closed curves that do not meet bound a solid between them, by how they lie in each other.
//!
//! A loop inside an even number of others is an outer boundary, inside an odd number a hole. Outer boundaries all run one way around, holes
//! the other: counter-clockwise and clockwise around a solid, the reverse around a cavity of unbounded material.

use std::cmp::Ordering;

use super::Mesh;
use super::bvh::{Bvh, STACK_SIZE};
use super::predicate::orientation;
use super::{Bounds, vec};
use crate::Result;
use crate::error::try_with_capacity;

/// A loop that runs the wrong way around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Misfit {
    /// The loop to reverse.
    pub reverse: usize,
    /// The loop that it does not go with.
    pub other: usize,
    /// How the two lie.
    pub lie: Lie,
}

/// How two loops lie to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lie {
    /// One right inside the other, both the same way around.
    Nested,
    /// Neither inside any loop, and not the same way around.
    Apart,
}

/// The first pair of loops that bound no solid together. `mesh` is of size 1, and its segments are those of the loops, one loop after the
/// other, `first_segments` [L + 1] of each and their number; no two may meet. In O(S log S + L (log S + segments below a point)).
pub(super) fn first_misfit(mesh: &Mesh<2>, first_segments: &[usize]) -> Result<Option<Misfit>> {
    let n = first_segments.len() - 1;
    if n < 2 {
        return Ok(None);
    }
    let tree = Bvh::new(mesh.segments().len(), |s| Bounds::of(&mesh.corners(s)))?;
    let mut loops: Vec<Loop> = try_with_capacity(n, "the loops")?;
    loops.extend(first_segments.windows(2).map(|w| Loop::of(mesh, w[0]..w[1])));
    let mut below = try_with_capacity(mesh.segments().len(), "the segments below a loop")?;
    let mut outermost = None;
    for k in 0..n {
        segments_below(mesh, &tree, loops[k].lowest, &mut below);
        below.iter_mut().for_each(|s| *s = first_segments.partition_point(|first| first <= s) - 1);
        below.sort_unstable();
        // A loop around k has an odd number of segments below it.
        let around = || below.chunk_by(|a, b| a == b).filter(|c| c.len() % 2 == 1 && c[0] != k).map(|c| c[0]);
        // Of loops in each other, the inner starts further right.
        let parent = around().max_by(|&a, &b| lexicographic(loops[a].lowest, loops[b].lowest));
        let is_hole = around().count() % 2 == 1;
        let fits = loops[k].turns_left != is_hole;
        let misfit = |other, lie| {
            let reverse = if fits { other } else { k };
            Some(Misfit { reverse, other: if fits { k } else { other }, lie })
        };
        match parent {
            Some(parent) if loops[parent].turns_left == loops[k].turns_left => return Ok(misfit(parent, Lie::Nested)),
            Some(_) => {}
            None => {
                let first = *outermost.get_or_insert(k);
                if loops[first].turns_left != loops[k].turns_left {
                    return Ok(misfit(first, Lie::Apart));
                }
            }
        }
    }
    Ok(None)
}

/// A loop's first vertex from the left, from below where there are more, and which way the loop turns there: it turns so as a whole.
struct Loop {
    lowest: [f64; 2],
    turns_left: bool,
}

impl Loop {
    fn of(mesh: &Mesh<2>, segments: std::ops::Range<usize>) -> Self {
        let start = |s: usize| mesh.corners(s)[0];
        let first = segments.start;
        let lowest = segments.clone().reduce(|a, b| if lexicographic(start(b), start(a)).is_lt() { b } else { a });
        let lowest = lowest.unwrap_or(first);
        let before = if lowest == first { segments.end - 1 } else { lowest - 1 };
        let [at, after] = mesh.corners(lowest);
        Loop { lowest: at, turns_left: orientation(start(before), at, after).is_gt() }
    }
}

fn lexicographic(a: [f64; 2], b: [f64; 2]) -> Ordering {
    // No zero counts as below the other.
    let [a, b] = [a, b].map(|p| vec::add(p, [0.0, 0.0]));
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

/// Fills `below` with the segments that lie below `p`.
fn segments_below(mesh: &Mesh<2>, tree: &Bvh<2>, p: [f64; 2], below: &mut Vec<usize>) {
    below.clear();
    let mut stack = [0; STACK_SIZE];
    let mut depth = 1;
    while depth > 0 {
        depth -= 1;
        let node = &tree.nodes[stack[depth]];
        let Bounds { min, max } = node.bounds;
        if min[0] > p[0] || max[0] < p[0] || min[1] > p[1] {
            continue;
        }
        if let Some(places) = node.leaf() {
            let segments = tree.order[places].iter().map(|&s| s as usize);
            below.extend(segments.filter(|&s| is_below(mesh.corners(s), p)));
        } else {
            stack[depth..depth + 2].copy_from_slice(&node.children());
            depth += 2;
        }
    }
}

/// Whether segment (a, b) lies below `p`. It holds its left end and not its right, so that a vertex is met once.
fn is_below([a, b]: [[f64; 2]; 2], p: [f64; 2]) -> bool {
    let [left, right] = if a[0] <= b[0] { [a, b] } else { [b, a] };
    left[0] <= p[0] && p[0] < right[0] && orientation(left, right, p).is_gt()
}
