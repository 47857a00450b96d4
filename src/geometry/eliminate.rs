//! Weighted sample elimination: Yuksel, "Sample elimination for generating Poisson disk sample sets" (2015).
//!
//! | there | here |
//! |---|---|
//! | r_max of a surface of area A | [`largest_radius`] |
//! | weight w_ij of two samples, with the limit r_min | [`Weight::of`] |
//! | algorithm 1: a heap of the weights | [`eliminate`] |
//!
//! We depart in three points. Samples whose normals point against each other do not count as neighbours, so the sides of a thin
//! sheet are sampled one by one. Distance is measured along the surface, around the edge between two samples of different
//! normals ([`squared_distance_along`]): distance through space would thin out the samples along edges. And a heap's entry is
//! not updated when a neighbour goes: weights only fall, so an entry is an upper bound, set right when it comes to the top.

use super::Bounds;
use super::cloud::Origin;
use super::vec::{Vec3, dot, sub};
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;
use std::ops::Range;

/// Limits the weight of pairs that come close by chance: Yuksel's beta and gamma.
const BETA: f64 = 0.65;
const GAMMA: f64 = 1.5;

/// Cells along an axis at most, so that a cell's coordinate and its neighbours' fit 32 bits.
const MAX_CELLS: f64 = (1_u32 << 31) as f64;

/// A sample that may be kept.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub point: Vec3,
    /// The triangle's own unit normal.
    pub normal: Vec3,
    pub origin: Origin,
}

/// The `n_kept` of the candidates that keep the largest distances, in rows of grid cells: z slowest, x fastest.
pub(super) fn eliminate(candidates: Vec<Candidate>, n_kept: usize, area: f64) -> Result<Vec<Candidate>> {
    let n = candidates.len();
    let reach = 2.0 * largest_radius(area, n_kept);
    let weight = Weight::new(reach, n_kept as f64 / n as f64);
    let grid = Grid::new(&candidates, reach)?;

    let mut weights = try_vec(n, 0.0_f32, "the weights of the sample candidates")?;
    for (i, w) in weights.iter_mut().enumerate() {
        grid.for_each_neighbour(i, |_, distance| *w += weight.of(distance) as f32);
    }
    let mut entries = try_with_capacity(n, "the heap of the sample candidates")?;
    entries.extend(weights.iter().enumerate().map(|(i, &weight)| Entry { weight, index: i as u32 }));
    let mut heap = BinaryHeap::from(entries);

    let mut alive = try_vec(n, true, "the flags of the sample candidates")?;
    let mut n_alive = n;
    while n_alive > n_kept {
        let Some(mut top) = heap.peek_mut() else { break };
        let i = top.index as usize;
        if top.weight != weights[i] {
            top.weight = weights[i];
            continue;
        }
        PeekMut::pop(top);
        alive[i] = false;
        n_alive -= 1;
        grid.for_each_neighbour(i, |j, distance| weights[j] -= weight.of(distance) as f32);
    }

    let mut kept = try_with_capacity(n_kept, "the samples")?;
    kept.extend((0..n).filter(|&i| alive[i]).map(|i| candidates[grid.candidate_of[i] as usize]));
    Ok(kept)
}

/// r_max: the radius of `n` equal discs in the densest, hexagonal, packing of `area`.
pub(super) fn largest_radius(area: f64, n: usize) -> f64 {
    (area / (2.0 * 3.0_f64.sqrt() * n as f64)).sqrt()
}

/// w_ij = (1 - d_ij / (2 r_max))^8, where d_ij is at least 2 r_min.
struct Weight {
    inverse_reach: f64,
    shortest: f64,
}

impl Weight {
    fn new(reach: f64, kept_fraction: f64) -> Self {
        let r_min = (1.0 - kept_fraction.powf(GAMMA)) * BETA;
        Weight { inverse_reach: 1.0 / reach, shortest: r_min }
    }

    fn of(&self, distance: f64) -> f64 {
        let w = (1.0 - (distance * self.inverse_reach).max(self.shortest)).max(0.0);
        let w2 = w * w;
        let w4 = w2 * w2;
        w4 * w4
    }
}

/// An entry of the heap: heaviest first, then the lower index, so that ties have one outcome. In `f32`, for the heap waits for memory.
#[derive(PartialEq)]
struct Entry {
    weight: f32,
    index: u32,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.weight.total_cmp(&other.weight).then(other.index.cmp(&self.index))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Coordinates z, y, x of a cell; at least 1, so that every cell has neighbours on both sides.
type CellKey = [u32; 3];

/// What the search reads of a candidate: half its size, for the search waits for memory.
#[derive(Clone, Copy)]
struct Site {
    point: Vec3,
    normal: [f32; 3],
}

/// Candidates sorted by cells of a grid, as wide as the reach.
struct Grid {
    sites: Vec<Site>,
    /// The candidate of each site.
    candidate_of: Vec<u32>,
    /// The cell of each site.
    cell_of: Vec<u32>,
    /// Sites of the 3 x 3 rows, of three cells each, around each cell. Sorting makes a row contiguous.
    rows: Vec<[Range<u32>; 9]>,
    reach_squared: f64,
}

impl Grid {
    fn new(candidates: &[Candidate], reach: f64) -> Result<Self> {
        let n = candidates.len();
        let bounds = Bounds::of(candidates.iter().map(|c| &c.point));
        let widest = bounds.extents().into_iter().fold(0.0, f64::max);
        let inverse_cell = 1.0 / reach.max(widest / MAX_CELLS);
        let key_of = |p: Vec3| [2, 1, 0].map(|a: usize| 1 + ((p[a] - bounds.min[a]) * inverse_cell) as u32);

        let mut order: Vec<(CellKey, u32)> = try_with_capacity(n, "the order of the sample candidates")?;
        order.extend(candidates.iter().enumerate().map(|(i, c)| (key_of(c.point), i as u32)));
        order.sort_unstable();

        let mut sites = try_with_capacity(n, "the sorted sample candidates")?;
        let site = |c: &Candidate| Site { point: c.point, normal: c.normal.map(|x| x as f32) };
        sites.extend(order.iter().map(|&(_, i)| site(&candidates[i as usize])));
        let mut candidate_of = try_with_capacity(n, "the order of the sample candidates")?;
        candidate_of.extend(order.iter().map(|&(_, i)| i));
        let mut cell_of = try_with_capacity(n, "the cells of the sample candidates")?;
        let mut n_cells = 0;
        for cell in order.chunk_by(|a, b| a.0 == b.0) {
            cell_of.extend(cell.iter().map(|_| n_cells));
            n_cells += 1;
        }
        let rows = neighbour_rows(&order, n_cells as usize)?;
        Ok(Grid { sites, candidate_of, cell_of, rows, reach_squared: reach * reach })
    }

    /// Calls `visit(j, distance)` for each other site j within reach of i whose normal is not against i's.
    fn for_each_neighbour(&self, i: usize, mut visit: impl FnMut(usize, f64)) {
        let this = &self.sites[i];
        let normal = this.normal.map(f64::from);
        for row in &self.rows[self.cell_of[i] as usize] {
            let first = row.start as usize;
            for (k, other) in self.sites[first..row.end as usize].iter().enumerate() {
                let through_space = sub(other.point, this.point);
                if dot(through_space, through_space) >= self.reach_squared || first + k == i {
                    continue;
                }
                let other_normal = other.normal.map(f64::from);
                let cos = dot(normal, other_normal);
                let squared = squared_distance_along(through_space, normal, other_normal, cos);
                if cos >= 0.0 && squared < self.reach_squared {
                    visit(first + k, squared.sqrt());
                }
            }
        }
    }
}

/// Squared length of the shortest way between two points, `d` apart, on two half planes of normals `n` and `m`, with
/// cos theta = n . m. Unfolded, points at a and b from the planes' edge are (a + b)^2 + c^2 apart, which is
/// |d|^2 + 2 a b (1 - cos theta); and a sin theta = |m . d|, b sin theta = |n . d|.
fn squared_distance_along(d: Vec3, n: Vec3, m: Vec3, cos: f64) -> f64 {
    dot(d, d) + 2.0 * (dot(n, d) * dot(m, d)).abs() / (1.0 + cos)
}

/// The nine rows around each cell. Keys of successive cells grow, so do their rows' ends: each end is found by walking on.
fn neighbour_rows(order: &[(CellKey, u32)], n_cells: usize) -> Result<Vec<[Range<u32>; 9]>> {
    let mut rows = try_with_capacity(n_cells, "the grid of the sample candidates")?;
    let mut walk: [Range<usize>; 9] = Default::default();
    for cell in order.chunk_by(|a, b| a.0 == b.0) {
        let [z, y, x] = cell[0].0;
        rows.push(std::array::from_fn(|k| {
            let (z, y) = (z + k as u32 / 3 - 1, y + k as u32 % 3 - 1);
            let Range { start, end } = &mut walk[k];
            while *start < order.len() && order[*start].0 < [z, y, x - 1] {
                *start += 1;
            }
            while *end < order.len() && order[*end].0 <= [z, y, x + 1] {
                *end += 1;
            }
            *start as u32..*end as u32
        }));
    }
    Ok(rows)
}
