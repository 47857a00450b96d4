//! The box of a field and its cells: steps 2 and 3 of paper 000's Algorithm 1.

use crate::geometry::Bounds;
use crate::geometry::bounds::DIAGONALS;
use crate::geometry::vec::text;
use crate::spline::{Axis, Grid};
use crate::{Error, Result};

/// An axis thinner than this fraction of D is widened to it before the margin is added, so that a flat cloud has a box.
const THINNEST: f64 = 0.05;

/// D of a cloud, checked to be a usable unit of length.
pub fn diagonal<const D: usize>(bounds: &Bounds<D>) -> Result<f64> {
    let d = bounds.diagonal();
    // Not by d, which is 0 too where its square underflows.
    if bounds.min == bounds.max {
        let place = text(&bounds.min);
        return Err(Error::Degenerate(format!(
            "all points are at {place}; points that are apart are needed to give the field a scale"
        )));
    }
    if !DIAGONALS.contains(&d) {
        return Err(Error::InvalidArgument(format!(
            "the points' bounding box has a diagonal of {d:e}; it must lie in [1e-90, 1e90]: choose another unit"
        )));
    }
    Ok(d)
}

/// Refuses a grid or a unit of length that no field can have.
pub fn check<const D: usize>(grid: &Grid<D>, diagonal: f64) -> Result<()> {
    if !DIAGONALS.contains(&diagonal) {
        return Err(Error::InvalidArgument(format!("the diagonal is {diagonal:e}; it must lie in [1e-90, 1e90]")));
    }
    for (a, axis) in grid.axes.iter().enumerate() {
        if axis.n_cells == 0 || axis.n_control() > u32::MAX as usize {
            let n = axis.n_control();
            return Err(Error::InvalidArgument(format!(
                "axis {a} has {n} control points; from 4 to 2^32 - 1 are served"
            )));
        }
        if !(DIAGONALS.contains(&axis.cell) && axis.lower.is_finite() && axis.upper().is_finite()) {
            return Err(Error::InvalidArgument(format!(
                "axis {a} begins at {:e} with cells of {:e}; it must be finite, with cells in [1e-90, 1e90]",
                axis.lower, axis.cell
            )));
        }
    }
    Ok(())
}

/// The grid of `n_control` control points along each axis of the box from `lower` to `upper`, in the caller's units.
pub fn grid_of_box<const D: usize>(lower: &[f64; D], upper: &[f64; D], n_control: &[u32; D]) -> Result<Grid<D>> {
    for a in 0..D {
        let (low, high, n) = (lower[a], upper[a], n_control[a]);
        if n < 4 {
            return Err(Error::InvalidArgument(format!("axis {a} has {n} control points; a cubic needs at least 4")));
        }
        // A NaN compares as false.
        if !(low < high && (high - low).is_finite()) {
            return Err(Error::InvalidArgument(format!(
                "the box runs from {low:e} to {high:e} along axis {a}; finite bounds are needed, the lower one first"
            )));
        }
    }
    let n_cells = |a: usize| n_control[a] as usize - 3;
    let axis = |a| Axis { lower: lower[a], cell: (upper[a] - lower[a]) / n_cells(a) as f64, n_cells: n_cells(a) };
    Ok(Grid { axes: std::array::from_fn(axis) })
}

/// The grid for points within `bounds`, in the caller's units. Counts of 0 in `control_points` are chosen so that cells are close to
/// cubes and at most `target` control points are used, unless the counts asked for leave no room for that.
pub fn grid<const D: usize>(
    bounds: &Bounds<D>,
    margin: f64,
    control_points: [u32; D],
    target: usize,
) -> Result<Grid<D>> {
    let d = diagonal(bounds)?;
    let extents = bounds.extents().map(|e| e.max(THINNEST * d) * (1.0 + margin));
    let center = bounds.center();
    let n_cells = cells(extents, control_points, target);
    let axes = std::array::from_fn(|a| Axis {
        lower: center[a] - 0.5 * extents[a],
        cell: extents[a] / n_cells[a] as f64,
        n_cells: n_cells[a],
    });
    Ok(Grid { axes })
}

/// Cells along each axis: those asked for, else the finest near-cubes that keep within `target`.
fn cells<const D: usize>(extents: [f64; D], control_points: [u32; D], target: usize) -> [usize; D] {
    let at = |edge: f64| -> [usize; D] {
        std::array::from_fn(|a| match control_points[a] {
            0 => ((extents[a] / edge).round() as usize).max(1),
            n => n as usize - 3,
        })
    };
    let fits = |edge: f64| at(edge).iter().map(|&n| n as u128 + 3).product::<u128>() <= target as u128;
    // Bisection on the edge, in fractions of the longest extent: the counts fall as it grows.
    let longest = extents.iter().fold(0.0, |m: f64, &e| m.max(e));
    let (mut fine, mut coarse) = (longest / 1024.0, longest);
    for _ in 0..60 {
        let middle = 0.5 * (fine + coarse);
        if fits(middle) { coarse = middle } else { fine = middle }
    }
    at(coarse)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(extents: [f64; 3]) -> Bounds {
        Bounds { min: [1.0, 2.0, 3.0], max: std::array::from_fn(|a| [1.0, 2.0, 3.0][a] + extents[a]) }
    }

    #[test]
    fn chosen_counts_stay_within_the_target_with_near_cubic_cells() {
        for extents in [[1.0, 1.0, 1.0], [0.156, 0.154, 0.121], [30.0, 6.0, 46.5], [1.0, 0.0, 0.0]] {
            for target in [64, 1000, 24_800, 300_000] {
                let grid = grid(&bounds(extents), 0.15, [0; 3], target).unwrap();
                assert!(grid.n_control() <= target);
                if target >= 24_800 {
                    assert!(grid.n_control() as f64 > 0.8 * target as f64, "{} of {target}", grid.n_control());
                    let shortest = grid.axes.iter().fold(f64::INFINITY, |m, a| m.min(a.cell));
                    assert!(grid.longest_cell() < 1.4 * shortest);
                }
            }
        }
    }

    #[test]
    fn counts_asked_for_are_honoured_and_the_others_follow() {
        let all = grid(&bounds([1.0, 2.0, 3.0]), 0.15, [7, 4, 33], 1000).unwrap();
        assert_eq!(all.shape(), [7, 4, 33]);
        let one = grid(&bounds([1.0, 1.0, 1.0]), 0.15, [20, 0, 0], 8000).unwrap();
        assert_eq!(one.shape()[0], 20);
        assert!(one.n_control() <= 8000);
    }

    #[test]
    fn the_box_is_the_margin_larger_and_centred_and_thin_axes_are_widened() {
        let b = bounds([3.0, 4.0, 0.0]);
        let grid = grid(&b, 0.15, [10; 3], 1000).unwrap();
        for (a, extent) in [3.0 * 1.15, 4.0 * 1.15, 0.05 * 5.0 * 1.15].into_iter().enumerate() {
            assert!((grid.axes[a].upper() - grid.axes[a].lower - extent).abs() < 1e-14);
            assert!((0.5 * (grid.axes[a].upper() + grid.axes[a].lower) - b.center()[a]).abs() < 1e-14);
        }
    }

    #[test]
    fn a_box_and_its_counts_make_the_grid_again() {
        let grid = grid(&bounds([1.0, 2.0, 3.0]), 0.15, [7, 4, 33], 1000).unwrap();
        let (lower, upper) = (grid.axes.map(|a| a.lower), grid.axes.map(|a| a.upper()));
        let again = grid_of_box(&lower, &upper, &[7, 4, 33]).unwrap();
        for (a, b) in grid.axes.iter().zip(&again.axes) {
            assert!(
                a.lower == b.lower && a.n_cells == b.n_cells && (a.cell - b.cell).abs() <= 4.0 * f64::EPSILON * a.cell
            );
        }
        assert!(grid_of_box(&lower, &upper, &[7, 3, 33]).is_err());
        assert!(grid_of_box(&upper, &lower, &[7, 4, 33]).is_err());
        assert!(grid_of_box(&lower, &[1.0, f64::NAN, 9.0], &[7, 4, 33]).is_err());
        assert!(grid_of_box(&[-1e308; 3], &[1e308; 3], &[7, 4, 33]).is_err());
    }

    #[test]
    fn a_point_has_no_box() {
        assert!(matches!(diagonal(&bounds([0.0; 3])), Err(Error::Degenerate(_))));
        assert!(matches!(diagonal(&bounds([1e200, 0.0, 0.0])), Err(Error::InvalidArgument(_))));
    }
}
