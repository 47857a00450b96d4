//! An order of a batch's points in which those that take the same control points follow each other: by bricks of cells, brick after brick.

use crate::error::try_with_capacity;
use crate::spline::axis::Cells;

/// Bricks that a box is cut into at most: of 8 cells at 256^3, so that those which share control points find them in a cache of the core's
/// own.
const MOST_BRICKS: usize = 1 << 16;

/// Points from which on they may be put in order.
const LEAST: usize = 1 << 13;

/// Control points for each point up to which it pays: with fewer points no two of them take the same.
const CONTROL_POINTS_A_POINT: usize = 256;

/// Points that are put in order at a time: with more of them a brick's control points are read for more points, but what they take and give
/// leaves the caches.
pub(super) const MOST: usize = 1 << 19;

/// Room for the order of a batch, some 7 bytes a point.
pub(super) struct Order {
    bricks: Vec<u16>,
    /// Points before those of each brick.
    before: Vec<u32>,
    order: Vec<u32>,
}

impl Order {
    /// Room for batches of `n` points among `n_control`, where an order may pay and there is memory for it.
    pub fn with_room(n: usize, n_control: usize) -> Option<Self> {
        (n >= LEAST.max(n_control / CONTROL_POINTS_A_POINT)).then_some(())?;
        let (n, what) = (n.min(MOST), "the order of a batch");
        let mut before = try_with_capacity(MOST_BRICKS, what).ok()?;
        before.resize(MOST_BRICKS, 0);
        Some(Order { bricks: try_with_capacity(n, what).ok()?, before, order: try_with_capacity(n, what).ok()? })
    }

    /// The indices of `points`, at most as many as there is room for, in order; `None` where most points lie by those before as they come.
    pub fn of<const D: usize>(&mut self, cells: &Cells<D>, points: &[[f64; D]]) -> Option<&[u32]> {
        let bricks = Bricks::of(cells);
        (!bricks.follow_each_other(cells, points)).then_some(())?;
        self.before.fill(0);
        self.bricks.clear();
        for p in points {
            let index = bricks.index(bricks.holding(&cells.coordinates(p)));
            self.before[index] += 1;
            self.bricks.push(index as u16);
        }
        let mut n = 0;
        for before in &mut self.before {
            (*before, n) = (n, n + *before);
        }
        self.order.clear();
        self.order.resize(points.len(), 0);
        for (i, &brick) in self.bricks.iter().enumerate() {
            let next = &mut self.before[usize::from(brick)];
            self.order[*next as usize] = i as u32;
            *next += 1;
        }
        Some(&self.order)
    }
}

/// The bricks of a box: cubes of cells.
struct Bricks<const D: usize> {
    per_cell: f64,
    counts: [usize; D],
}

impl<const D: usize> Bricks<D> {
    /// As many as there may be, of 2^k cells along each axis.
    fn of(cells: &Cells<D>) -> Self {
        let counts_of = |edge: usize| cells.n_cells().map(|n| n.div_ceil(edge));
        let few = |edge: &usize| {
            counts_of(*edge).iter().try_fold(1usize, |n, c| n.checked_mul(*c)).is_some_and(|n| n <= MOST_BRICKS)
        };
        let edge = (0..usize::BITS - 1).map(|k| 1 << k).find(few).unwrap_or(usize::MAX);
        Bricks { per_cell: 1.0 / edge as f64, counts: counts_of(edge) }
    }

    /// Whether of a sample of the points most lie in the brick of the one before or beside it.
    fn follow_each_other(&self, cells: &Cells<D>, points: &[[f64; D]]) -> bool {
        const EACH: usize = 32;
        let jumps = points.chunks_exact(2).step_by(EACH / 2).filter(|pair| {
            let [a, b] = [0, 1].map(|i| self.holding(&cells.coordinates(&pair[i])));
            (0..D).any(|axis| a[axis].abs_diff(b[axis]) > 1)
        });
        4 * jumps.count() <= points.len() / EACH
    }

    /// That of a point given in cells, along each axis; the nearest for points outside the box.
    #[inline(always)]
    fn holding(&self, xi: &[f64; D]) -> [u32; D] {
        std::array::from_fn(|a| ((xi[a] * self.per_cell) as u32).min(self.counts[a] as u32 - 1))
    }

    #[inline(always)]
    fn index(&self, place: [u32; D]) -> usize {
        (0..D).fold(0, |index, a| index * self.counts[a] + place[a] as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::spline::{Axis, Grid};

    fn points_of_a_brick_follow_each_other<const D: usize>(n_cells: [usize; D]) {
        let grid = Grid { axes: n_cells.map(|n_cells| Axis { lower: -1.0, cell: 0.5, n_cells }) };
        let cells = Cells::of(&grid);
        let mut random = SplitMix64::new(3);
        let points: Vec<[f64; D]> =
            (0..LEAST).map(|_| std::array::from_fn(|a| random.between(-2.0, n_cells[a] as f64))).collect();
        let bricks = Bricks::of(&cells);
        let n_bricks: usize = bricks.counts.iter().product();
        assert!(n_bricks <= MOST_BRICKS && (n_bricks << D > MOST_BRICKS || bricks.per_cell == 1.0), "{n_bricks}");
        let mut room = Order::with_room(points.len(), 0).unwrap();
        for points in [&points[..], &points[..100]] {
            let order = room.of(&cells, points).unwrap();
            let mut sorted = order.to_vec();
            sorted.sort_unstable();
            assert!(sorted.iter().copied().eq(0..points.len() as u32));
            let brick = |i: u32| bricks.index(bricks.holding(&cells.coordinates(&points[i as usize])));
            assert!(order.is_sorted_by_key(|&i| (brick(i), i)));
        }
    }

    #[test]
    fn points_of_a_brick_follow_each_other_in_space_and_in_the_plane() {
        for n_cells in [[300, 200, 100], [40, 40, 40], [9000, 3, 1]] {
            points_of_a_brick_follow_each_other(n_cells);
        }
        for n_cells in [[1000, 3000], [70, 50], [100_000, 1]] {
            points_of_a_brick_follow_each_other(n_cells);
        }
    }

    #[test]
    fn few_points_and_points_by_each_other_are_left_as_they_come() {
        assert!(Order::with_room(LEAST - 1, 0).is_none());
        assert!(Order::with_room(LEAST, CONTROL_POINTS_A_POINT * (LEAST + 1)).is_none());
        let grid = Grid { axes: [Axis { lower: 0.0, cell: 1.0, n_cells: 100 }; 3] };
        let path: Vec<[f64; 3]> = (0..LEAST).map(|i| [i as f64 / 100.0; 3]).collect();
        assert!(Order::with_room(LEAST, 0).unwrap().of(&Cells::of(&grid), &path).is_none());
    }
}
