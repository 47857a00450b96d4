//! Which cells of one grid a cell of another may overlap within a step of time, for sure none missed.
//!
//! With h half the length of a step, c the moving cell's centre at its middle, v its velocity there, W the rate of turning, rho half the
//! cell's diagonal, every point of the moving cell is, at any time s of the step, within
//!
//!   slack = |W| rho h + bend
//!
//! of where it would be if the cell went straight on with v. So the cells are apart throughout where the body that the straight cell sweeps
//! is from the other cell, by the slack. Both are convex, and apart when their shadows on some axis are: in the plane the normals of both
//! cells' edges and of v, in space the faces' normals and the cross products of edges and v with edges. On the axis n the swept body's shadow
//! is the cell's, longer by |n . v| h at both ends. What parts lose by long steps is therefore the slack alone, and nothing where nothing
//! moves or cells slide along each other. Touching is no overlap, nor is what rounding makes of it: shadows that overlap by 1e-9 of a cell
//! count as touching.
//!
//! Lengths are in cells of the grid that stays.

use super::bits::Marks;
use super::grid::Grid;
use super::steps::{Relative, Sampling, Step};
use crate::dimension::OfDimension;
use crate::error::try_with_capacity;
use crate::geometry::matrix::{Matrix, applied, diagonal, scaled, transposed};
use crate::geometry::vec::{Vec3, add, cross, dot, norm, number, scale, sub};
use crate::{Error, Result};

/// Overlap of shadows, in cells, that counts as touching.
const TOUCH: f64 = 1e-9;

/// All steps of a motion made ready.
pub struct Swathes<const D: usize> {
    steps: OfDimension<Vec<Separation<D, 8>>, Vec<Separation<D, 24>>>,
    counts: [usize; D],
}

impl<const D: usize> Swathes<D> {
    /// For cells of `moving`, which `relative.of` moves, in those of `still`, from which they are to be apart by `clearance`.
    pub fn new(
        relative: &Relative<D>,
        sampling: Sampling,
        still: &Grid<D>,
        moving: &Grid<D>,
        clearance: f64,
    ) -> Result<Self> {
        if !(clearance >= 0.0 && clearance.is_finite()) {
            let text = format!("a clearance of {}; it must be 0 or more, and finite", number(clearance));
            return Err(Error::InvalidArgument(text));
        }
        let steps = relative.bounded_steps(sampling, still, moving, clearance)?;
        let steps = if D == 2 {
            OfDimension::Plane(ready(&steps, still, moving, clearance)?)
        } else {
            OfDimension::Space(ready(&steps, still, moving, clearance)?)
        };
        Ok(Swathes { steps, counts: still.counts() })
    }

    /// Puts into `marks` the cells that the moving cell with centre `x` may overlap at any time.
    #[inline(always)]
    pub fn mark(&self, x: [f64; D], marks: &mut Marks) {
        match &self.steps {
            OfDimension::Plane(steps) => steps.iter().for_each(|step| step.mark(x, self.counts, marks)),
            OfDimension::Space(steps) => steps.iter().for_each(|step| step.mark(x, self.counts, marks)),
        }
    }
}

fn ready<const D: usize, const N: usize>(
    steps: &[Step<D>],
    still: &Grid<D>,
    moving: &Grid<D>,
    clearance: f64,
) -> Result<Vec<Separation<D, N>>> {
    let mut ready = try_with_capacity(steps.len(), "steps of time")?;
    ready.extend(steps.iter().map(|s| Separation::new(s, still, moving, clearance)));
    Ok(ready)
}

/// A step made ready: D dimensions, N axes, of which the first D are the staying grid's own, and places for those with v at the end.
struct Separation<const D: usize, const N: usize> {
    /// From the moving grid's coordinates to numbers of cells of the other, centres at whole ones.
    linear: Matrix<D>,
    shift: [f64; D],
    /// Velocity times half the step's length, in cells, by place in cells.
    turn: Matrix<D>,
    drift: [f64; D],
    counts: [f64; D],
    /// Edges of both cells, in cells.
    own: Matrix<D>,
    edges: Matrix<D>,
    /// What shadows are widened by.
    slack: f64,
    /// Axes, by coordinate, of length 1; 0 where there is none.
    axes: [[f64; N]; D],
    n_axes: usize,
    /// Half the sum of both cells' shadows, widened.
    reach: [f64; N],
}

/// Edges of cells, D of each.
fn shadow<const D: usize>(n: [f64; D], edges: &Matrix<D>) -> f64 {
    0.5 * edges.iter().map(|e| dot(n, *e).abs()).sum::<f64>()
}

impl<const D: usize, const N: usize> Separation<D, N> {
    /// For cells of `moving` in those of `still`, which are to be apart by `clearance`.
    fn new(step: &Step<D>, still: &Grid<D>, moving: &Grid<D>, clearance: f64) -> Self {
        let cell = still.cell();
        let own: Matrix<D> = diagonal(1.0);
        // Columns of R are the directions of the moving cell's edges.
        let turned = transposed(&step.pose.turn);
        let edges = scaled(moving.cell() / cell, &turned);
        let mut normals: Vec<[f64; D]> = own.iter().chain(&turned).copied().collect();
        if D == 3 {
            normals.extend(own.iter().flat_map(|a| turned.iter().filter_map(move |b| across(a, b))));
        }
        let slack = (slack(step, moving) + clearance) / cell - TOUCH;
        let (mut axes, mut reach) = ([[0.0; N]; D], [f64::INFINITY; N]);
        for (j, n) in normals.iter().enumerate() {
            reach[j] = shadow(*n, &own) + shadow(*n, &edges) + slack;
            (0..D).for_each(|a| axes[a][j] = n[a]);
        }
        let corner = add(scale(1.0 / cell, still.corner()), [0.5; D]);
        let turn = scaled(step.half, &step.twist.turn);
        Separation {
            linear: scaled(1.0 / cell, &step.pose.turn),
            shift: sub(scale(1.0 / cell, step.pose.shift), corner),
            drift: add(applied(&turn, corner), scale(step.half / cell, step.twist.drift)),
            turn,
            counts: still.counts().map(|n| n as f64),
            own,
            edges,
            slack,
            axes,
            n_axes: normals.len(),
            reach,
        }
    }

    /// Puts into `marks` the cells that the moving cell with centre `x` may overlap.
    #[inline(always)]
    fn mark(&self, x: [f64; D], counts: [usize; D], marks: &mut Marks) {
        let q = add(applied(&self.linear, x), self.shift);
        let v = add(applied(&self.turn, q), self.drift);
        // Cells along each axis, from..to.
        let (mut from, mut to) = ([0.0; D], [0.0; D]);
        for a in 0..D {
            let reach = self.reach[a] + v[a].abs();
            from[a] = (q[a] - reach).floor().max(-1.0) + 1.0;
            to[a] = (q[a] + reach).ceil().min(self.counts[a]);
            if from[a] >= to[a] {
                return;
            }
        }
        let swept = self.swept(v);
        let mut row = [0.0; D];
        for x in from[0] as usize..to[0] as usize {
            row[0] = x as f64 - q[0];
            if D == 2 {
                self.mark_row(&swept, &row, q[D - 1], x * counts[D - 1], marks);
                continue;
            }
            for y in from[1] as usize..to[1] as usize {
                row[1] = y as f64 - q[1];
                self.mark_row(&swept, &row, q[D - 1], (x * counts[1] + y) * counts[D - 1], marks);
            }
        }
    }

    /// All axes for the velocity `v`, divided by their last coordinates.
    #[inline(always)]
    fn swept(&self, v: [f64; D]) -> Swept<D, N> {
        let (mut axes, mut reach) = (self.axes, self.reach);
        for j in 0..N {
            let along: f64 = (0..D).map(|a| axes[a][j] * v[a]).sum();
            reach[j] += along.abs();
        }
        let mut j = self.n_axes;
        let mut put = |n: [f64; D]| {
            (0..D).for_each(|a| axes[a][j] = n[a]);
            reach[j] = shadow(n, &self.own) + shadow(n, &self.edges) + self.slack;
            j += 1;
        };
        if D == 2 {
            let length = norm(v);
            if length > SLOW {
                let mut n = [0.0; D];
                (n[0], n[1]) = (-v[1] / length, v[0] / length);
                put(n);
            }
        } else if dot(v, v) > SLOW * SLOW {
            let v = scale(1.0 / norm(v), v);
            self.own.iter().chain(&self.edges).filter_map(|e| across(&v, e)).for_each(put);
        }
        // An axis across the rows holds a whole row or nothing of it.
        let last = axes[D - 1];
        for j in 0..N {
            let inverse = if last[j].abs() < FLAT { 1.0 / FLAT } else { 1.0 / last[j] };
            (0..D).for_each(|a| axes[a][j] *= -inverse);
            reach[j] *= inverse.abs();
        }
        Swept { axes, reach }
    }

    /// The same in the row that lies at `row` from the centre and whose cells are numbered from `base` on.
    #[inline(always)]
    fn mark_row(&self, swept: &Swept<D, N>, row: &[f64; D], q: f64, base: usize, marks: &mut Marks) {
        let (mut low, mut high) = ([f64::NEG_INFINITY; N], [f64::INFINITY; N]);
        for j in 0..N {
            let off: f64 = (0..D - 1).map(|a| swept.axes[a][j] * row[a]).sum();
            low[j] = off - swept.reach[j];
            high[j] = off + swept.reach[j];
        }
        let low = low.iter().fold(f64::NEG_INFINITY, |m, &x| if x > m { x } else { m });
        let high = high.iter().fold(f64::INFINITY, |m, &x| if x < m { x } else { m });
        let from = (q + low).floor().max(-1.0) + 1.0;
        let to = (q + high).ceil().min(self.counts[D - 1]);
        if from < to {
            marks.insert_range(base + from as usize..base + to as usize);
        }
    }
}

/// How far the cells of `moving` may be, at any time of the step, from where going straight on would take them.
fn slack<const D: usize>(step: &Step<D>, moving: &Grid<D>) -> f64 {
    let rho = 0.5 * moving.cell() * (D as f64).sqrt();
    step.twist.rate() * rho * step.half + step.bend
}

/// Axes divided by minus their last coordinate, and reaches by the size of that: within a row each axis leaves an interval.
struct Swept<const D: usize, const N: usize> {
    axes: [[f64; N]; D],
    reach: [f64; N],
}

/// Cells that go less far than this in a step do without the axes across their way.
const SLOW: f64 = 1e-3;

/// Axes whose last coordinate is smaller are taken as across the rows: within a few cells that moves a bound by 1e-11 cells.
const FLAT: f64 = 1e-12;

/// The axis across two directions, where these are not parallel: without it cells count as overlapping sooner, never later.
#[inline]
fn across<const D: usize>(a: &[f64; D], b: &[f64; D]) -> Option<[f64; D]> {
    let three = |v: &[f64; D]| -> Vec3 { std::array::from_fn(|k| v[k % D]) };
    let n = cross(three(a), three(b));
    let length = norm(n);
    (length > 1e-4).then(|| std::array::from_fn(|k| n[k] / length))
}
