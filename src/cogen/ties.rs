//! The pairs of one weight: minimum cuts are the sets that are closed in the residual graph (Picard and Queyranne 1980).
//!
//! The smallest holds what supply reaches, the largest all from which demand is not reached; what is between falls into strongly connected
//! components, and Tarjan's algorithm (1972) finds these in an order in which each reaches none but those before it. So each is added alone,
//! and the chain of pairs goes in the smallest steps there are.

use super::bits::Bits;
use super::closure::Pair;
use super::conflict::Side;
use super::flow::Flow;
use super::rows::Cursor;
use crate::Result;
use crate::error::{try_reserve, try_vec};
use crate::progress::Progress;
use std::ops::Range;

/// A chain of pairs of one weight, on the way: the part that has the rows grows, the other shrinks.
pub(super) struct Ties<'a> {
    flow: Flow<'a>,
    /// Near cells kept, and far ones.
    near: Bits,
    far: Bits,
    /// Near cells from which demand is not reached, and that are in no component yet.
    free: Bits,
    /// When nodes were found, near cells first; 0 for those that have not been.
    found: Vec<u32>,
    /// The earliest node on the stack that a node is known to reach.
    low: Vec<u32>,
    n_found: u32,
    /// Nodes that are in no component yet, as they were found.
    stack: Vec<u32>,
    /// The path to the node that is looked at.
    path: Vec<Frame>,
}

/// A node on the path, and which of its edges have been followed.
#[derive(Debug, Clone)]
enum Frame {
    Near { cell: u32, cursor: Cursor, run: Range<usize> },
    Far { cell: u32, inflow: Option<u32> },
}

impl<'a> Ties<'a> {
    /// The chain's first pair, for the weights that `flow` is of; `near` and `far` are what it could be among.
    pub fn new(mut flow: Flow<'a>, near: &Bits, far: &Bits, progress: &mut Progress<'_>) -> Result<Self> {
        let (reached, left, _) = flow.solve(near, far, progress)?;
        let rows = flow.conflicts().rows();
        // What comes to demand: each round goes once over the near cells that have not been found to.
        let mut free = near.clone();
        free.subtract(&reached);
        let mut lost = Bits::of(left.len(), |j| left.has(j) && flow.has_demand(j))?;
        loop {
            let mut found = Vec::new();
            for i in free.iter() {
                if rows.iter(i).any(|run| lost.has_some(run)) {
                    try_reserve(&mut found, 1, "ties of the cut")?;
                    found.push(i);
                    flow.each_outflow(i, |j| lost.insert(j));
                }
            }
            if found.is_empty() {
                break;
            }
            found.into_iter().for_each(|i| free.remove(i));
        }
        let n = reached.len() + left.len();
        let zeros = || try_vec(n, 0, "ties of the cut");
        let (found, low) = (zeros()?, zeros()?);
        Ok(Ties { flow, near: reached, far: left, free, found, low, n_found: 0, stack: Vec::new(), path: Vec::new() })
    }

    /// The flow that proves it.
    pub fn flow(&self) -> u64 {
        self.flow.amount()
    }

    /// The pair as it is.
    pub fn pair(&self) -> Pair {
        let (near, far) = (self.near.clone(), self.far.clone());
        Pair { cells: if self.flow.conflicts().rows_of() == Side::First { [near, far] } else { [far, near] } }
    }

    /// Goes on to the next pair: `gained` are the near cells that it has more, `lost` the far ones that it has less. Whether there is one.
    pub fn step(&mut self, gained: &mut Vec<usize>, lost: &mut Vec<usize>) -> Result<bool> {
        gained.clear();
        lost.clear();
        loop {
            if self.path.is_empty() {
                let Some(seed) = self.free.first_in(0..self.free.len()) else { return Ok(false) };
                self.enter_near(seed)?;
            }
            if let Some(node) = self.look_ahead()? {
                self.take_component(node, gained, lost);
                // A component of far cells alone, which weigh nothing, waits for what it is lost to.
                if !gained.is_empty() {
                    return Ok(true);
                }
            }
        }
    }

    /// Follows one edge, or leaves a node; the node, if it is the first found of a component.
    fn look_ahead(&mut self) -> Result<Option<usize>> {
        let n_near = self.near.len();
        let frame = self.path.last_mut().expect("there is a path");
        match frame {
            Frame::Near { cell, cursor, run } => {
                let i = *cell as usize;
                if let Some(j) = self.far.first_in(run.clone()) {
                    run.start = j + 1;
                    let (node, at) = (n_near + j, self.found[n_near + j]);
                    if at == 0 {
                        self.enter(node, Frame::Far { cell: j as u32, inflow: None })?;
                    } else {
                        self.low[i] = self.low[i].min(at);
                    }
                    return Ok(None);
                }
                if let Some(next) = self.flow.conflicts().rows().next_run(i, cursor) {
                    *run = next;
                    return Ok(None);
                }
                Ok(self.leave(i))
            }
            Frame::Far { cell, inflow } => {
                let j = *cell as usize;
                if let Some((k, from)) = self.flow.next_inflow(j, *inflow) {
                    *inflow = Some(k);
                    if self.free.has(from) {
                        self.enter_near(from)?;
                    } else if self.found[from] > 0 && !self.near.has(from) {
                        self.low[n_near + j] = self.low[n_near + j].min(self.found[from]);
                    }
                    return Ok(None);
                }
                Ok(self.leave(n_near + j))
            }
        }
    }

    fn enter_near(&mut self, i: usize) -> Result<()> {
        self.free.remove(i);
        self.enter(i, Frame::Near { cell: i as u32, cursor: Cursor::default(), run: 0..0 })
    }

    fn enter(&mut self, node: usize, frame: Frame) -> Result<()> {
        self.n_found += 1;
        self.found[node] = self.n_found;
        self.low[node] = self.n_found;
        try_reserve(&mut self.stack, 1, "ties of the cut")?;
        try_reserve(&mut self.path, 1, "ties of the cut")?;
        self.stack.push(node as u32);
        self.path.push(frame);
        Ok(())
    }

    /// Goes back from a node; the node, if none that was found before it is reached.
    fn leave(&mut self, node: usize) -> Option<usize> {
        self.path.pop();
        let low = self.low[node];
        if let Some(frame) = self.path.last() {
            let parent = match frame {
                Frame::Near { cell, .. } => *cell as usize,
                Frame::Far { cell, .. } => self.near.len() + *cell as usize,
            };
            self.low[parent] = self.low[parent].min(low);
        }
        (low == self.found[node]).then_some(node)
    }

    fn take_component(&mut self, first: usize, gained: &mut Vec<usize>, lost: &mut Vec<usize>) {
        let n_near = self.near.len();
        while let Some(node) = self.stack.pop() {
            let node = node as usize;
            if node < n_near {
                self.near.insert(node);
                gained.push(node);
            } else {
                self.far.remove(node - n_near);
                lost.push(node - n_near);
            }
            if node == first {
                return;
            }
        }
    }
}
