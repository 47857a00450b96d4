//! Branch and bound: the largest of a function, best first.
//!
//! What is left of the search stands in a heap by its upper bounds; the largest are split, bounded and put back, until the largest bound is
//! hardly above a value that was found. A round takes so many boxes as a constant says, and what it finds is merged in their order: the
//! outcome does not depend on the number of threads.

use crate::Result;
use crate::error::{no_room, try_with_capacity};
use crate::par::Workers;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Boxes that a round splits, and boxes of an item of work.
const ROUND: usize = 256;
const ITEM: usize = 8;

/// Bounds that a box of a round or of the first look takes on average, at most; where boxes take more there are fewer of them, so that
/// the time between two reports of progress has its bound.
const USUAL_BOUNDS: u64 = 16;

/// Items of the first look, and groups of boxes of one.
const FIRST_ITEMS: usize = 64;
const GROUPS: usize = 4;

/// What is seen of a box.
pub(super) struct Look<N, const D: usize> {
    pub node: N,
    /// The function is nowhere larger in the box, as far as that counts; minus infinity where nothing of it does.
    pub upper: f64,
    /// A value that it takes, in the box or elsewhere, and where.
    pub found: f64,
    pub place: [f64; D],
    /// Bounds that the look took, 1 at least: what it cost.
    pub n_bounds: u64,
}

/// A function of which the largest value is looked for, on boxes of its own kind.
pub(super) trait Problem<const D: usize>: Sync {
    type Node: Copy + Send + Sync;

    /// Groups of boxes to begin with.
    fn n_groups(&self) -> usize;

    /// The boxes of a group.
    fn group(&self, group: usize, visit: &mut dyn FnMut(Self::Node));

    /// Boxes that together hold all of `node` that counts.
    fn split(&self, node: &Self::Node, visit: &mut dyn FnMut(Self::Node));

    /// Looks at a box; a bound that is at most `floor` need not be better.
    fn look(&self, node: Self::Node, floor: f64) -> Look<Self::Node, D>;
}

/// When a search ends.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// How far the bound may be above what was found, as a fraction of that.
    pub tolerance: f64,
    /// A size below which it is a fraction of this.
    pub least: f64,
    /// Bounds to take, one a box or more; those of the first look are not counted.
    pub max_bounds: u64,
}

impl Limits {
    /// The bound at which `found` is good enough.
    fn floor(&self, found: f64) -> f64 {
        found + self.tolerance * found.max(self.least)
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outcome<const D: usize> {
    /// The function is nowhere larger, but for rounding.
    pub upper: f64,
    /// The largest value found, and where.
    pub found: f64,
    pub place: [f64; D],
    /// Boxes looked at.
    pub n_boxes: u64,
    /// Whether the tolerance was not reached within the boxes allowed.
    pub is_cut_short: bool,
}

/// A box in the heap: ties come out as they came in.
struct Entry<N> {
    upper: f64,
    serial: u64,
    node: N,
}

impl<N> PartialEq for Entry<N> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<N> Eq for Entry<N> {}

impl<N> PartialOrd for Entry<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<N> Ord for Entry<N> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper).then(other.serial.cmp(&self.serial))
    }
}

/// A search on its way.
struct Search<N, const D: usize> {
    heap: BinaryHeap<Entry<N>>,
    /// The largest bound of what was left alone.
    dropped: f64,
    found: f64,
    place: [f64; D],
    n_boxes: u64,
    n_bounds: u64,
}

impl<N: Copy, const D: usize> Search<N, D> {
    fn take(&mut self, looks: Vec<Look<N, D>>, floor: f64) -> Result<()> {
        for look in looks {
            self.n_boxes += 1;
            self.n_bounds += look.n_bounds;
            if look.found > self.found {
                (self.found, self.place) = (look.found, look.place);
            }
            // A NaN is no bound.
            let upper = if look.upper.is_nan() { f64::INFINITY } else { look.upper };
            if upper <= floor {
                self.dropped = self.dropped.max(upper);
                continue;
            }
            let len = self.heap.len() as u128 + 1;
            self.heap.try_reserve(1).map_err(|_| no_room::<Entry<N>>(len, "the boxes of a certificate"))?;
            self.heap.push(Entry { upper, serial: self.n_boxes, node: look.node });
        }
        Ok(())
    }

    /// `usual` of what boxes are looked at in one go, or fewer where their bounds are many.
    fn at_once(&self, usual: usize) -> usize {
        let by_box = (self.n_bounds / self.n_boxes.max(1)).div_ceil(USUAL_BOUNDS).max(1);
        (usual as u64 / by_box).max(1) as usize
    }
}

/// The largest value of `problem`, of which `start` is one, with its place. `tell` is told the fraction done.
pub(super) fn search<P: Problem<D>, const D: usize>(
    problem: &P,
    (found, place): (f64, [f64; D]),
    limits: Limits,
    workers: &Workers,
    mut tell: impl FnMut(f64) -> Result<()>,
) -> Result<Outcome<D>> {
    let heap = BinaryHeap::new();
    let mut search = Search { heap, dropped: f64::NEG_INFINITY, found, place, n_boxes: 0, n_bounds: 0 };
    let n_groups = problem.n_groups();
    let mut first = 0;
    while first < n_groups {
        tell(0.5 * first as f64 / n_groups as f64)?;
        let n_items = (n_groups - first).div_ceil(GROUPS).min(search.at_once(FIRST_ITEMS));
        let floor = limits.floor(search.found);
        for looks in workers.map(n_items, |item| {
            let mut looks = Vec::new();
            let from = first + item * GROUPS;
            for group in from..(from + GROUPS).min(n_groups) {
                problem.group(group, &mut |node| looks.push(problem.look(node, floor)));
            }
            looks
        }) {
            search.take(looks, floor)?;
        }
        first += n_items * GROUPS;
    }
    let first_bounds = search.n_bounds;
    let mut nodes = try_with_capacity(ROUND, "the boxes of a round")?;
    let mut is_cut_short = false;
    // How far the largest bound was off at first: the logarithm of what is left of it falls about evenly.
    let mut widest = f64::NAN;
    while let Some(top) = search.heap.peek() {
        let floor = limits.floor(search.found);
        if top.upper <= floor {
            break;
        }
        is_cut_short = search.n_bounds - first_bounds >= limits.max_bounds;
        if is_cut_short {
            break;
        }
        let (off, wanted) = (top.upper - search.found, floor - search.found);
        widest = if widest.is_finite() { widest.max(off) } else { off };
        let done = (widest / off).ln() / (widest / wanted).ln();
        tell(0.5 + 0.5 * if done.is_finite() { done.clamp(0.0, 1.0) } else { 0.0 })?;
        nodes.clear();
        let round = search.at_once(ROUND);
        while let Some(top) = search.heap.peek()
            && nodes.len() < round
            && top.upper > floor
        {
            nodes.extend(search.heap.pop().map(|entry| entry.node));
        }
        let items: &[P::Node] = &nodes;
        for looks in workers.map(items.len().div_ceil(ITEM), |item| {
            let mut looks = Vec::new();
            for node in &items[item * ITEM..items.len().min((item + 1) * ITEM)] {
                problem.split(node, &mut |child| looks.push(problem.look(child, floor)));
            }
            looks
        }) {
            search.take(looks, floor)?;
        }
    }
    let upper = search.heap.peek().map_or(search.dropped, |top| search.dropped.max(top.upper)).max(search.found);
    let Search { found, place, n_boxes, .. } = search;
    Ok(Outcome { upper, found, place, n_boxes, is_cut_short })
}
