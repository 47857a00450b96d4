//! The pairs of one weight: minimum cuts are the sets that are closed in the residual graph (Picard and Queyranne 1980).
//!
//! The smallest holds what supply reaches. From there a chain of larger ones is walked: a near cell is added with all that it reaches, which
//! is free unless that comes to demand. Near cells from which demand is reached are found first, backwards; the chain ends with all others.

use super::bits::Bits;
use super::closure::Pair;
use super::conflict::Side;
use super::flow::Flow;
use crate::Result;
use crate::error::try_reserve;
use crate::progress::Progress;

/// A chain of pairs of one weight, on the way: the part that has the rows grows, the other shrinks.
pub(super) struct Ties<'a> {
    flow: Flow<'a>,
    /// Near cells kept, and far ones.
    near: Bits,
    far: Bits,
    /// Near cells that may still be added.
    free: Bits,
    queue: Vec<u32>,
}

impl<'a> Ties<'a> {
    /// The chain's first pair, for the weights that `flow` is of; `near` and `far` are what it could be among.
    pub fn new(mut flow: Flow<'a>, near: &Bits, far: &Bits, progress: &mut Progress<'_>) -> Result<Self> {
        let (reached, left, _) = flow.solve(near, far, progress)?;
        let rows = flow.conflicts().rows();
        let (begins, ends) = flow.outflows()?;
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
                    ends[begins[i] as usize..begins[i + 1] as usize].iter().for_each(|&j| lost.insert(j as usize));
                }
            }
            if found.is_empty() {
                break;
            }
            found.into_iter().for_each(|i| free.remove(i));
        }
        Ok(Ties { flow, near: reached, far: left, free, queue: Vec::new() })
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

    /// Near cells that may be added.
    pub fn free(&self) -> &Bits {
        &self.free
    }

    /// Adds near cell `i`, which is free, and what must come with it. Calls `gain` for near cells that the pair gets, and `lose` for far ones
    /// that it loses.
    pub fn add(&mut self, i: usize, mut gain: impl FnMut(usize), mut lose: impl FnMut(usize)) -> Result<()> {
        let Ties { flow, near, far, free, queue } = self;
        queue.clear();
        queue.push(i as u32);
        free.remove(i);
        let rows = flow.conflicts().rows();
        while let Some(i) = queue.pop() {
            near.insert(i as usize);
            gain(i as usize);
            for run in rows.iter(i as usize) {
                while let Some(j) = far.first_in(run.clone()) {
                    far.remove(j);
                    lose(j);
                    let mut grown = Ok(());
                    flow.each_inflow(j, |from| {
                        if free.has(from) {
                            free.remove(from);
                            grown = std::mem::replace(&mut grown, Ok(()))
                                .and_then(|()| try_reserve(queue, 1, "ties of the cut"));
                            queue.push(from as u32);
                        }
                    });
                    grown?;
                }
            }
        }
        Ok(())
    }
}
