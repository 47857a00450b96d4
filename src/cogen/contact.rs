//! Contact over the motion: when and where a pair that does not collide touches, and how large the gaps are (figure 11).
//!
//! The gap at a time is the distance between the nearest cells of both parts, as the cubes that they are. A distance map of part 1's cells, exact
//! for centres (Felzenszwalb and Huttenlocher 2012), says which of part 2's boundary cells can hold it; few are looked at closely, since what
//! was near a moment ago is near now.

use super::bits::Bits;
use super::closure::Pair;
use super::conflict::Side;
use super::cube::Cube;
use super::grid::Grid;
use super::steps::Relative;
use crate::error::{try_reserve, try_vec, try_with_capacity};
use crate::geometry::Bounds;
use crate::geometry::rigid::Rigid;
use crate::geometry::vec::{norm, number, sub};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};

/// The gap at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap<const D: usize> {
    /// t
    pub time: f64,
    /// Distance between the parts, in the caller's units.
    pub distance: f64,
    /// The cells that are nearest to each other, of part 1 and of part 2.
    pub cells: [usize; 2],
    /// A point between them, in part 1's frame.
    pub place: [f64; D],
}

/// Gaps over the motion.
#[derive(Debug, Clone)]
pub struct Contact<const D: usize> {
    /// One for each time, in order.
    pub gaps: Vec<Gap<D>>,
    /// The largest.
    pub largest: f64,
    /// Their mean: figure 11's.
    pub mean: f64,
}

/// Gaps of `pair`, on these grids, at `n_times` even times t_k = (k + 1/2) / n; none where a part has no cells.
pub fn contact<const D: usize>(
    grids: [&Grid<D>; 2],
    pair: &Pair,
    relative: &Relative<D>,
    n_times: usize,
    workers: &Workers,
    progress: &mut Progress<'_>,
) -> Result<Contact<D>> {
    if let Some(k) = (0..2).find(|&k| pair.cells[k].iter().next().is_none()) {
        return Err(Error::Degenerate(format!("part {} has no cells: there is no gap to measure", k + 1)));
    }
    let steps = relative.even_steps_of_period(n_times)?;
    let map = DistanceMap::new(grids[0], &pair.cells[Side::First.index()])?;
    let mut numbers: Vec<usize> = Vec::new();
    for j in boundary(grids[1], &pair.cells[1]) {
        try_reserve(&mut numbers, 1, "boundary cells")?;
        numbers.push(j);
    }
    let mut boundary: Vec<[f64; D]> = try_with_capacity(numbers.len(), "boundary cells")?;
    boundary.extend(numbers.iter().map(|&j| grids[1].center(j)));
    let search = Search { map: &map, cells: &pair.cells[0], grids, boundary: &boundary, numbers: &numbers };
    let mut gaps: Vec<Gap<D>> = try_with_capacity(n_times, "gaps")?;
    // As many at a time as make a parcel of work.
    let many = 64;
    for from in (0..steps.len()).step_by(many) {
        progress.tell(from as f64 / steps.len() as f64, "contact")?;
        gaps.extend(workers.map(many.min(steps.len() - from), |k| {
            let step = &steps[from + k];
            search.nearest(step.time, &step.pose)
        }));
    }
    if let Some(far) = gaps.iter().find(|gap| !gap.distance.is_finite()) {
        let text = format!("at time {} the parts are farther from each other than numbers reach", number(far.time));
        return Err(Error::InvalidArgument(text));
    }
    // The other periods are like the first.
    for k in steps.len()..n_times {
        gaps.push(Gap { time: (2 * k + 1) as f64 * (0.5 / n_times as f64), ..gaps[k - steps.len()] });
    }
    let largest = gaps.iter().map(|g| g.distance).fold(0.0, f64::max);
    let mean = gaps.iter().map(|g| g.distance).sum::<f64>() / gaps.len() as f64;
    Ok(Contact { gaps, largest, mean })
}

/// Cells of which a neighbour across a face is not in the set.
fn boundary<'a, const D: usize>(grid: &'a Grid<D>, cells: &'a Bits) -> impl Iterator<Item = usize> + 'a {
    cells.iter().filter(move |&i| {
        let place = grid.place(i);
        (0..D).any(|a| {
            let beside = |to: usize| {
                let mut next = place;
                next[a] = to;
                cells.has(grid.number(next))
            };
            place[a] == 0 || place[a] + 1 == grid.counts()[a] || !beside(place[a] - 1) || !beside(place[a] + 1)
        })
    })
}

/// Squared distances from all centres of a grid to the nearest centre in a set, in cells.
struct DistanceMap<const D: usize> {
    grid: Grid<D>,
    squares: Vec<f32>,
}

impl<const D: usize> DistanceMap<D> {
    fn new(grid: &Grid<D>, cells: &Bits) -> Result<Self> {
        let n = grid.n_cells();
        let mut squares = try_vec(n, f32::INFINITY, "the distance map")?;
        cells.iter().for_each(|i| squares[i] = 0.0);
        let mut stride = n;
        for a in 0..D {
            let count = grid.counts()[a];
            stride /= count;
            let (mut line, mut lower) = (vec![0.0; count], LowerEnvelope::new(count));
            for start in (0..n).filter(|i| (i / stride).is_multiple_of(count)) {
                for k in 0..count {
                    line[k] = f64::from(squares[start + k * stride]);
                }
                lower.transform(&mut line);
                for k in 0..count {
                    squares[start + k * stride] = line[k] as f32;
                }
            }
        }
        Ok(DistanceMap { grid: *grid, squares })
    }

    /// A lower bound of the distance from `p` to the set's centres.
    fn below(&self, p: [f64; D]) -> f64 {
        let (grid, eps) = (&self.grid, self.grid.cell());
        let place: [usize; D] = std::array::from_fn(|a| {
            let x = ((p[a] - grid.corner()[a]) / eps).floor();
            x.clamp(0.0, (grid.counts()[a] - 1) as f64) as usize
        });
        let i = grid.number(place);
        let off = norm(sub(p, grid.center(i)));
        let Bounds { min, max } = grid.bounds();
        let beyond: [f64; D] =
            std::array::from_fn(|a| (min[a] + 0.5 * eps - p[a]).max(p[a] - max[a] + 0.5 * eps).max(0.0));
        // Squares are stored in single precision, which rounds their roots by less than this.
        let from_here = f64::from(self.squares[i]).sqrt() * eps * (1.0 - 1e-6) - off;
        from_here.max(norm(beyond))
    }
}

/// The one-dimensional transform: from f to the least of f(q) + (p - q)^2 over q, by the lower envelope of the parabolas.
struct LowerEnvelope {
    vertex: Vec<usize>,
    begin: Vec<f64>,
    values: Vec<f64>,
}

impl LowerEnvelope {
    fn new(n: usize) -> Self {
        LowerEnvelope { vertex: Vec::with_capacity(n), begin: Vec::with_capacity(n), values: vec![0.0; n] }
    }

    fn transform(&mut self, line: &mut [f64]) {
        self.vertex.clear();
        self.begin.clear();
        for (q, &value) in line.iter().enumerate().filter(|(_, v)| v.is_finite()) {
            let mut from = f64::NEG_INFINITY;
            while let Some(&v) = self.vertex.last() {
                // Where the new parabola goes below the last.
                let (a, b) = (q as f64, v as f64);
                from = ((value + a * a) - (line[v] + b * b)) / (2.0 * (a - b));
                if from > self.begin[self.begin.len() - 1] {
                    break;
                }
                self.vertex.pop();
                self.begin.pop();
                from = f64::NEG_INFINITY;
            }
            self.vertex.push(q);
            self.begin.push(from);
        }
        if self.vertex.is_empty() {
            return;
        }
        let mut k = 0;
        for (p, value) in self.values.iter_mut().enumerate() {
            while k + 1 < self.vertex.len() && self.begin[k + 1] <= p as f64 {
                k += 1;
            }
            let off = p as f64 - self.vertex[k] as f64;
            *value = off * off + line[self.vertex[k]];
        }
        line.copy_from_slice(&self.values);
    }
}

/// What all times share.
struct Search<'a, const D: usize> {
    map: &'a DistanceMap<D>,
    /// Part 1's.
    cells: &'a Bits,
    grids: [&'a Grid<D>; 2],
    /// Centres of part 2's boundary cells, and their numbers.
    boundary: &'a [[f64; D]],
    numbers: &'a [usize],
}

impl<const D: usize> Search<'_, D> {
    fn nearest(&self, time: f64, pose: &Rigid<D>) -> Gap<D> {
        // Half the diagonals of both cells: by so much may cells be nearer than their centres.
        let near = 0.5 * (D as f64).sqrt() * (self.grids[0].cell() + self.grids[1].cell());
        let mut bounds: Vec<(f64, u32)> =
            self.boundary.iter().enumerate().map(|(k, x)| (self.map.below(pose.apply(*x)), k as u32)).collect();
        let mut best = Gap { time, distance: f64::INFINITY, cells: [0; 2], place: [0.0; D] };
        // The most promising first; of the others those that could still be nearer.
        let first = (0..bounds.len()).min_by(|&a, &b| bounds[a].0.total_cmp(&bounds[b].0)).expect("a boundary");
        bounds.swap(0, first);
        for (below, k) in bounds {
            if below - near < best.distance {
                self.look(pose, k as usize, below, near, &mut best);
            }
        }
        best
    }

    /// Compares boundary cell `k` with the cells of part 1 that may be nearer to it than the best so far.
    fn look(&self, pose: &Rigid<D>, k: usize, below: f64, near: f64, best: &mut Gap<D>) {
        let p = pose.apply(self.boundary[k]);
        let mut radius = below + near;
        while !best.distance.is_finite() && radius.is_finite() {
            self.look_within(pose, k, p, radius, best);
            radius *= 2.0;
        }
        // Centres farther than this are of cells that are farther than the best.
        self.look_within(pose, k, p, best.distance + near, best);
    }

    fn look_within(&self, pose: &Rigid<D>, k: usize, p: [f64; D], radius: f64, best: &mut Gap<D>) {
        let (grid, eps) = (self.grids[0], self.grids[0].cell());
        let moved = Cube::new(p, self.grids[1].cell(), pose);
        let (mut from, mut to) = ([0; D], [0; D]);
        for a in 0..D {
            let at = |x: f64| ((x - grid.corner()[a]) / eps).clamp(0.0, grid.counts()[a] as f64);
            (from[a], to[a]) = (at(p[a] - radius) as usize, at(p[a] + radius).ceil() as usize);
        }
        each_place(from, to, |place| {
            let i = grid.number(place);
            if self.cells.has(i) && norm(sub(grid.center(i), p)) <= radius {
                let (distance, between) = Cube::new(grid.center(i), eps, &Rigid::IDENTITY).distance(&moved);
                if distance < best.distance {
                    *best = Gap { distance, cells: [i, self.numbers[k]], place: between, ..*best };
                }
            }
        });
    }
}

/// Calls `take` for all places from `from` to below `to`.
fn each_place<const D: usize>(from: [usize; D], to: [usize; D], mut take: impl FnMut([usize; D])) {
    if (0..D).any(|a| from[a] >= to[a]) {
        return;
    }
    let mut place = from;
    loop {
        take(place);
        let Some(a) = (0..D).rev().find(|&a| place[a] + 1 < to[a]) else { return };
        place[a] += 1;
        place[a + 1..].copy_from_slice(&from[a + 1..]);
    }
}
