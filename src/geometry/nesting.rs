//! Whether closed curves that do not meet bound a solid between them, by how they lie in each other.
//!
//! A loop inside an even number of others is an outer boundary, inside an odd number a hole. Outer boundaries all run one way around, holes
//! the other: counter-clockwise and clockwise around a solid, the reverse around a cavity of unbounded material.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::predicate::orientation;
use super::{Mesh, vec};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

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
/// other, `first_segments` [L + 1] of each and their number; no two may meet. In O(S log S).
pub(super) fn first_misfit(mesh: &Mesh<2>, first_segments: &[usize]) -> Result<Option<Misfit>> {
    let n = first_segments.len() - 1;
    if n < 2 {
        return Ok(None);
    }
    let mut loops: Vec<Loop> = try_with_capacity(n, "the loops")?;
    loops.extend(first_segments.windows(2).map(|w| Loop::of(mesh, w[0]..w[1])));
    let lies = nest(mesh, first_segments, &loops)?;
    let mut outermost = None;
    for k in 0..n {
        let fits = loops[k].turns_left != lies[k].is_hole;
        let misfit = |other, lie| {
            let reverse = if fits { other } else { k };
            Some(Misfit { reverse, other: if fits { k } else { other }, lie })
        };
        match lies[k].parent {
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

/// Where a loop lies.
#[derive(Clone, Copy)]
struct Place {
    /// The loop right around it.
    parent: Option<usize>,
    /// Whether an odd number of loops is around it.
    is_hole: bool,
}

/// What a line that sweeps the plane from left to right meets at one x, in this order: a segment holds its left end and not its right.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    End,
    Start,
    Lowest,
}

/// The place of each loop, by a sweep: the segment next below a loop's lowest point belongs to a loop around it, or to one beside it that
/// lies in the same one. The set of segments under the line is a tree of small nodes, taken as the line meets them.
fn nest(mesh: &Mesh<2>, first_segments: &[usize], loops: &[Loop]) -> Result<Vec<Place>> {
    const WORK: &str = "the nesting of the loops";
    let n_segments = mesh.segments().len();
    let mut events: Vec<([f64; 2], Event, usize)> = try_with_capacity(2 * n_segments + loops.len(), WORK)?;
    for s in (0..n_segments).filter(|&s| !Under::of(mesh, s).is_upright()) {
        let Under { left, right, .. } = Under::of(mesh, s);
        events.push((left, Event::Start, s));
        events.push((right, Event::End, s));
    }
    events.extend(loops.iter().enumerate().map(|(k, l)| (l.lowest, Event::Lowest, k)));
    events.sort_unstable_by(|(p, e, i), (q, f, j)| {
        let same_x = (p[0] + 0.0).total_cmp(&(q[0] + 0.0));
        same_x.then(e.cmp(f)).then(lexicographic(*p, *q)).then(i.cmp(j))
    });
    let mut under = BTreeSet::new();
    let mut places = try_vec(loops.len(), Place { parent: None, is_hole: false }, WORK)?;
    for (point, event, i) in events {
        match event {
            Event::End => _ = under.remove(&Under::of(mesh, i)),
            Event::Start => _ = under.insert(Under::of(mesh, i)),
            Event::Lowest => {
                let next = under.range(..Under { left: point, right: point, number: 0, runs_right: true }).next_back();
                if let Some(below) = next {
                    // Loops that reach farther left have their places already.
                    let other = first_segments.partition_point(|&first| first < below.number) - 1;
                    let is_inside = below.runs_right == loops[other].turns_left;
                    let parent = if is_inside { Some(other) } else { places[other].parent };
                    places[i] = Place { parent, is_hole: parent.is_some_and(|p| !places[p].is_hole) };
                }
            }
        }
    }
    Ok(places)
}

/// A segment under the line that sweeps, or a point on the line, whose ends are the same. In the order of height on the line.
#[derive(Clone, Copy)]
struct Under {
    left: [f64; 2],
    right: [f64; 2],
    /// The segment's index and 1; 0 for a point, which so comes before segments that begin at it.
    number: usize,
    /// Whether the segment runs from its left end to its right.
    runs_right: bool,
}

impl Under {
    fn of(mesh: &Mesh<2>, s: usize) -> Self {
        let [a, b] = mesh.corners(s);
        let runs_right = a[0] <= b[0];
        let [left, right] = if runs_right { [a, b] } else { [b, a] };
        Under { left, right, number: s + 1, runs_right }
    }

    fn is_upright(&self) -> bool {
        self.left[0] == self.right[0]
    }

    /// How high `later`, which begins under or over this segment, lies beside it.
    fn height_of(&self, later: &Self) -> Ordering {
        let side = |p| orientation(self.left, self.right, p);
        side(later.left).then_with(|| side(later.right)).then(later.number.cmp(&self.number))
    }
}

impl Ord for Under {
    fn cmp(&self, other: &Self) -> Ordering {
        if self.number == other.number {
            return Ordering::Equal;
        }
        let is_later = self.number == 0 || (other.number != 0 && self.left[0] > other.left[0]);
        if is_later { other.height_of(self) } else { self.height_of(other).reverse() }
    }
}

impl PartialOrd for Under {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Under {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Under {}

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
