//! The Riemannian graph (Hoppe et al. 1992, section 3.3): points joined to their k nearest.

use super::super::neighbours::{Neighbour, Neighbours};
use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;
use crate::progress::Progress;

/// Points, all different, and their nearest neighbours.
pub struct Graph<const D: usize> {
    points: Vec<[f64; D]>,
    tree: Neighbours<D>,
    k: usize,
    /// [n x k], nearest first.
    nearest: Vec<Neighbour>,
}

impl<const D: usize> Graph<D> {
    /// The graph of `points` [n x D], n > `k` > 0, of a size of about 1. `progress` is told up to the fraction `until`.
    pub fn new(
        points: Vec<[f64; D]>,
        k: usize,
        workers: &Workers,
        progress: &mut Progress,
        until: f64,
    ) -> Result<Self> {
        const CHUNK: usize = 1024;
        const ROUND: usize = 32;
        let n = points.len();
        let tree = Neighbours::new(&points)?;
        let nothing = Neighbour { index: 0, distance_squared: 0.0 };
        let mut nearest = try_vec(n * k, nothing, "the neighbours of the points")?;
        let mut chunks = nearest.chunks_mut(CHUNK * k).enumerate();
        // Some chunks at a time, so that the caller hears of them.
        for done in (0..n).step_by(ROUND * CHUNK) {
            progress.tell(until * done as f64 / n as f64, "neighbours")?;
            workers.for_each(chunks.by_ref().take(ROUND), |(chunk, nearest)| {
                for (place, nearest) in nearest.chunks_mut(k).enumerate() {
                    let i = chunk * CHUNK + place;
                    tree.nearest(points[i], |j| j != i, nearest);
                }
            });
        }
        Ok(Graph { points, tree, k, nearest })
    }

    /// Number of points n.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Neighbours a point.
    pub fn k(&self) -> usize {
        self.k
    }

    /// Points [n x D].
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    /// The points' tree.
    pub fn tree(&self) -> &Neighbours<D> {
        &self.tree
    }

    /// The k nearest of point `i`, nearest first.
    pub fn neighbours(&self, i: usize) -> &[Neighbour] {
        &self.nearest[i * self.k..(i + 1) * self.k]
    }

    /// Each pair of points i < j of which one is among the nearest of the other, once.
    pub fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + Clone {
        let near = |i: u32| self.neighbours(i as usize).iter().map(|n| n.index);
        let of_point = move |i: u32| {
            let once = move |j: &u32| i < *j || near(*j).all(|back| back != i);
            near(i).filter(once).map(move |j| [i.min(j), i.max(j)])
        };
        (0..self.len() as u32).flat_map(of_point)
    }

    /// The mean distance of point `i` to its nearest.
    pub fn spacing(&self, i: usize) -> f64 {
        self.neighbours(i).iter().map(|n| n.distance_squared.sqrt()).sum::<f64>() / self.k as f64
    }
}
