//! The first place where curves meet that should not: a crossing, a touch, or a piece run along twice.
//!
//! Whether two segments meet is decided exactly ([`super::predicate`]); which to ask, by the tree of their boxes.

use std::cmp::Ordering;

use super::bvh::{Bvh, STACK_SIZE};
use super::predicate::orientation;
use super::vec::{add, scale, sub};
use super::{Bounds, Mesh};
use crate::Result;

/// How two segments meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meeting {
    /// Each passes from one side of the other to the other side.
    Cross,
    /// An end of one lies on the other.
    Touch,
    /// They share a piece.
    Overlap,
}

/// Two segments that meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// The segments, lower index first.
    pub segments: [u32; 2],
    pub meeting: Meeting,
    /// A point that both hold; to within rounding where they cross.
    pub place: [f64; 2],
}

/// The meeting of the lowest segment that meets another, with the lowest that it meets; segments that share a vertex may meet there.
/// `mesh` is of size 1. In O(S log S) where few boxes overlap.
pub(super) fn first_crossing(mesh: &Mesh<2>) -> Result<Option<Crossing>> {
    let n = mesh.segments().len();
    let bounds = |s: usize| Bounds::of(&mesh.corners(s));
    let tree = Bvh::new(n, bounds)?;
    Ok((0..n).find_map(|s| {
        let mut first: Option<Crossing> = None;
        for_each_overlap(&tree, bounds(s), |t| {
            let is_lowest = first.is_none_or(|c| t < c.segments[1]);
            if t as usize > s
                && is_lowest
                && let Some((meeting, place)) = meeting_in(mesh, s, t as usize)
            {
                first = Some(Crossing { segments: [s as u32, t], meeting, place });
            }
        });
        first
    }))
}

/// Calls `visit` with the things in the leaves whose boxes meet `bounds`.
fn for_each_overlap(tree: &Bvh<2>, bounds: Bounds<2>, mut visit: impl FnMut(u32)) {
    let mut stack = [0; STACK_SIZE];
    let mut depth = 1;
    while depth > 0 {
        depth -= 1;
        let node = &tree.nodes[stack[depth]];
        if !overlap(&node.bounds, &bounds) {
            continue;
        }
        if let Some(places) = node.leaf() {
            tree.order[places].iter().for_each(|&thing| visit(thing));
        } else {
            stack[depth..depth + 2].copy_from_slice(&node.children());
            depth += 2;
        }
    }
}

/// Whether two boxes share a point.
fn overlap(a: &Bounds<2>, b: &Bounds<2>) -> bool {
    (0..2).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// How segments `s` and `t` of a mesh meet, and where; a vertex that they share does not count.
fn meeting_in(mesh: &Mesh<2>, s: usize, t: usize) -> Option<(Meeting, [f64; 2])> {
    let (of_s, of_t) = (mesh.segments()[s], mesh.segments()[t]);
    let (a, b) = (mesh.corners(s), mesh.corners(t));
    let Some(shared) = (0..2).find(|&i| of_t.contains(&of_s[i])) else {
        return meeting(a, b);
    };
    let in_t = usize::from(of_t[1] == of_s[shared]);
    let (pivot, p, q) = (a[shared], a[1 - shared], b[1 - in_t]);
    // Segments with a common end meet elsewhere only when they fold back.
    let folds = orientation(pivot, p, q).is_eq() && (0..2).all(|k| side(p[k], pivot[k]) == side(q[k], pivot[k]));
    let nearer = if holds([pivot, p], q) { q } else { p };
    folds.then_some((Meeting::Overlap, nearer))
}

fn side(x: f64, y: f64) -> Option<Ordering> {
    x.partial_cmp(&y)
}

/// How two segments meet, and where.
fn meeting([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Option<(Meeting, [f64; 2])> {
    let of_cd = [orientation(a, b, c), orientation(a, b, d)];
    let of_ab = [orientation(c, d, a), orientation(c, d, b)];
    // Ends that lie on the other segment.
    let ends = [(of_cd[0], [a, b], c), (of_cd[1], [a, b], d), (of_ab[0], [c, d], a), (of_ab[1], [c, d], b)];
    let mut touching = ends.iter().filter(|(o, on, p)| o.is_eq() && holds(*on, *p)).map(|(_, _, p)| *p);
    if let Some(first) = touching.next() {
        let is_piece = touching.any(|p| p != first);
        return Some((if is_piece { Meeting::Overlap } else { Meeting::Touch }, first));
    }
    let crosses = [of_cd, of_ab].iter().all(|o| o[0].is_ne() && o[0] == o[1].reverse());
    crosses.then(|| (Meeting::Cross, crossing_point([a, b], [c, d])))
}

/// Whether the box of a segment holds `p`; on the segment's line, the segment does.
fn holds(segment: [[f64; 2]; 2], p: [f64; 2]) -> bool {
    overlap(&Bounds::of(&segment), &Bounds { min: p, max: p })
}

/// Where two segments that cross do so, to within rounding.
fn crossing_point([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> [f64; 2] {
    let beside = |p: [f64; 2]| {
        let (u, v) = (sub(d, c), sub(p, c));
        u[0] * v[1] - u[1] * v[0]
    };
    let (of_a, of_b) = (beside(a), beside(b));
    let t = of_a / (of_a - of_b);
    if t.is_finite() { add(a, scale(t.clamp(0.0, 1.0), sub(b, a))) } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meetings_are_told_apart() {
        let base = [[0.0, 0.0], [2.0, 0.0]];
        for (other, expected) in [
            ([[1.0, -1.0], [1.0, 3.0]], Some((Meeting::Cross, [1.0, 0.0]))),
            ([[1.0, 0.0], [1.0, 3.0]], Some((Meeting::Touch, [1.0, 0.0]))),
            ([[2.0, 0.0], [3.0, 0.0]], Some((Meeting::Touch, [2.0, 0.0]))),
            ([[3.0, 0.0], [1.0, 0.0]], Some((Meeting::Overlap, [1.0, 0.0]))),
            ([[-1.0, 0.0], [3.0, 0.0]], Some((Meeting::Overlap, [0.0, 0.0]))),
            ([[0.0, 0.0], [2.0, 0.0]], Some((Meeting::Overlap, [0.0, 0.0]))),
            ([[2.5, 0.0], [3.0, 0.0]], None),
            ([[1.0, 1e-300], [1.0, 3.0]], None),
            ([[3.0, -1.0], [1.0, 3.0]], None),
        ] {
            for other in [other, [other[1], other[0]]] {
                assert_eq!(meeting(base, other).map(|m| m.0), expected.map(|m| m.0), "{other:?}");
                assert_eq!(meeting(other, base).map(|m| m.0), expected.map(|m| m.0), "{other:?}");
            }
            assert_eq!(meeting(base, other), expected);
        }
    }

    #[test]
    fn neighbours_meet_only_where_they_fold_back() {
        let fold = |p| {
            let mesh = Mesh::new(vec![[0.0, 0.0], [0.3, 0.1], p], vec![[0, 1], [1, 2]]).unwrap();
            first_crossing(&mesh).unwrap().map(|c| (c.segments, c.meeting, c.place))
        };
        assert_eq!(fold([0.6, 0.2]), None);
        assert_eq!(fold([-0.3, -0.1]), Some(([0, 1], Meeting::Overlap, [0.0, 0.0])));
        assert_eq!(fold([-0.3, -0.1_f64.next_up()]), None);
        assert_eq!(fold([0.0, 0.0]), Some(([0, 1], Meeting::Overlap, [0.0, 0.0])));
    }
}
