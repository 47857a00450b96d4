//! Edges in the order of their length: a sorted list of those there are at first, a heap of those that come up on the way.

use crate::Result;
use crate::error::{no_room, try_reserve, try_with_capacity};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// An edge: its squared length as ordered bits, then its vertices, so that ties have one outcome.
pub(super) type Entry = (u64, u32, u32);

/// The shortest edge comes out first.
pub(super) struct Queue {
    /// Longest first: taken from the end.
    sorted: Vec<Entry>,
    /// A heap of all would be out of cache: most of what is offered later is short, and soon out again.
    later: BinaryHeap<Reverse<Entry>>,
}

impl Queue {
    /// An empty queue with room for `capacity` edges; `what` it is for, should memory run out.
    pub fn new(capacity: usize, what: &str) -> Result<Self> {
        Ok(Queue { sorted: try_with_capacity(capacity, what)?, later: BinaryHeap::new() })
    }

    /// Fills an empty queue.
    pub fn fill(&mut self, edges: impl Iterator<Item = Entry>, what: &str) -> Result<()> {
        debug_assert!(self.sorted.is_empty() && self.later.is_empty());
        for edge in edges {
            try_reserve(&mut self.sorted, 1, what)?;
            self.sorted.push(edge);
        }
        self.sorted.sort_unstable_by(|x, y| y.cmp(x));
        Ok(())
    }

    /// Puts in one edge more.
    pub fn push(&mut self, edge: Entry, what: &str) -> Result<()> {
        self.later.try_reserve(1).map_err(|_| no_room::<Entry>(self.later.len() as u128 + 1, what))?;
        self.later.push(Reverse(edge));
        Ok(())
    }

    /// Edges in it.
    pub fn len(&self) -> usize {
        self.sorted.len() + self.later.len()
    }

    /// Takes the first edge out.
    pub fn pop(&mut self) -> Option<Entry> {
        match (self.sorted.last(), self.later.peek()) {
            (Some(sorted), Some(Reverse(later))) if sorted <= later => self.sorted.pop(),
            (_, Some(_)) => self.later.pop().map(|Reverse(edge)| edge),
            (_, None) => self.sorted.pop(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;

    #[test]
    fn edges_come_out_in_order_whenever_they_came_in() {
        let mut random = SplitMix64::new(1);
        let mut edge = || ((20.0 * random.unit()) as u64, (3.0 * random.unit()) as u32, 7);
        let mut queue = Queue::new(0, "a test").unwrap();
        for _ in 0..2 {
            let mut all: Vec<Entry> = (0..50).map(|_| edge()).collect();
            queue.fill(all.iter().copied(), "a test").unwrap();
            let mut n = 0;
            while let Some(first) = queue.pop() {
                let least = (0..all.len()).min_by_key(|i| all[*i]).unwrap();
                assert_eq!(first, all.swap_remove(least));
                if n < 40 {
                    n += 1;
                    all.push(edge());
                    queue.push(all[all.len() - 1], "a test").unwrap();
                }
            }
            assert!(all.is_empty());
        }
    }
}
