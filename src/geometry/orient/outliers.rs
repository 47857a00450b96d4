//! Points that lie far from all others.
//!
//! s_i is the mean distance of a point to its k nearest. Beside the median of theirs it tells a lone point whatever the density there: a
//! threshold on s_i itself, as mean + c times standard deviation, names the coarse parts of an adaptive cloud. Outliers in groups of more
//! than k / 2 have each other for neighbours, and are not found.

use super::graph::Graph;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};

/// Whether each point's s is more than `factor` times the median of its neighbours'.
pub fn outliers<const D: usize>(graph: &Graph<D>, factor: f64) -> Result<Vec<bool>> {
    let mut spacing = try_with_capacity(graph.len(), "the spacing of the points")?;
    spacing.extend((0..graph.len()).map(|i| graph.spacing(i)));
    let mut far = try_vec(graph.len(), false, "the outliers")?;
    let mut of_neighbours = try_with_capacity(graph.k(), "the spacing of the neighbours")?;
    for (i, far) in far.iter_mut().enumerate() {
        of_neighbours.clear();
        of_neighbours.extend(graph.neighbours(i).iter().map(|n| spacing[n.index as usize]));
        of_neighbours.sort_unstable_by(f64::total_cmp);
        *far = spacing[i] > factor * of_neighbours[of_neighbours.len() / 2];
    }
    Ok(far)
}
