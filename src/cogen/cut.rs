//! The best pair for given weights of cells: a minimum cut.
//!
//! Of all pairs that never collide, which are the independent sets of the conflict graph, the one of greatest weight is what a minimum cut
//! leaves, each cell with its weight between it and source or sink. The flow that meets the cut proves that no pair weighs more: weight of
//! all cells less flow.

use super::bits::Bits;
use super::closure::{Pair, check_room, close};
use super::conflict::Conflicts;
use super::flow::Flow;
use crate::progress::Progress;
use crate::{Error, Result};

/// The best pair, and the proof.
#[derive(Debug)]
pub struct Cut {
    /// The pair of greatest weight, maximal too; of several, that with the fewest cells of the part whose cells the rows are of, but for cells of
    /// weight 0.
    pub pair: Pair,
    /// What the pair weighs.
    pub weight: u64,
    /// No pair weighs more: what all cells weigh, less the flow.
    pub bound: u64,
}

/// The pair of greatest weight among those within `room`; `weights` `[n_1]` and `[n_2]`.
pub fn cut(conflicts: &Conflicts, room: &[Bits; 2], weights: [&[u64]; 2], progress: &mut Progress<'_>) -> Result<Cut> {
    check_room(conflicts, room)?;
    let all = weight_of_all(room, weights)?;
    let near = conflicts.rows_of();
    let (near_room, far_room) = (&room[near.index()], &room[near.other().index()]);
    let mut flow = Flow::new(conflicts, near_room, weights[near.index()], far_room, weights[near.other().index()])?;
    let (kept, _, _) = flow.solve(near_room, far_room, progress)?;
    // Cells of weight 0 that are in nobody's way are on either side of the cut.
    let pair = close(conflicts, room, near, &kept)?;
    let weight = pair.weigh(weights).iter().sum();
    let bound = all - flow.amount();
    debug_assert_eq!(weight, bound);
    Ok(Cut { pair, weight, bound })
}

/// What all cells of `room` weigh.
pub(super) fn weight_of_all(room: &[Bits; 2], weights: [&[u64]; 2]) -> Result<u64> {
    for (k, of) in weights.iter().enumerate() {
        let n = room[k].len();
        if of.len() != n {
            return Err(Error::InvalidArgument(format!("{} weights for part {}'s {n} cells", of.len(), k + 1)));
        }
    }
    let all: u128 = (0..2).map(|k| room[k].iter().map(|i| u128::from(weights[k][i])).sum::<u128>()).sum();
    u64::try_from(all).map_err(|_| Error::InvalidArgument(format!("the weights' sum is {all}; it must be below 2^64")))
}
