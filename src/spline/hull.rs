//! Bounds of a spline on a part of one cell: its control points there as a Bezier polynomial, between which it lies.
//!
//! The polynomial of a cell is the blossom p(t, t, t), symmetric and affine in each of three arguments; control points are its values at
//! three knots in a row, -2 .. 3 around the cell [0, 1], Bezier points on [a, b] those at (a, a, a), (a, a, b), (a, b, b) and (b, b, b)
//! (Ramshaw 1989). On the way no difference is taken for t in [0, 1]: what comes out lies between the control points.

use super::kernel::Stencil;

/// The 4^D control points of a cell, in order; the first 16 in the plane.
pub type Window = [f64; 64];

/// The control points at `stencil`.
pub fn window<const D: usize>(stencil: &Stencil<D>, coefficients: &[f64]) -> Window {
    let mut window = [0.0; 64];
    for (i, row) in window[..4_usize.pow(D as u32)].chunks_exact_mut(4).enumerate() {
        let (x, y) = if D == 3 { (i / 4, i % 4) } else { (0, i) };
        let first = stencil.first + if D == 3 { x * stencil.strides[0] } else { 0 } + y * stencil.strides[D - 2];
        row.copy_from_slice(&coefficients[first..first + 4]);
    }
    window
}

/// The least and the largest of the numbers of a window.
pub fn range<const D: usize>(window: &Window) -> (f64, f64) {
    // Four at a time: the compiler makes vectors of them.
    let (mut low, mut high) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
    for row in window[..4_usize.pow(D as u32)].as_chunks::<4>().0 {
        for k in 0..4 {
            low[k] = if row[k] < low[k] { row[k] } else { low[k] };
            high[k] = if row[k] > high[k] { row[k] } else { high[k] };
        }
    }
    (low.into_iter().fold(f64::INFINITY, f64::min), high.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

/// The Bezier points of the spline of `window` on `part`, from a to b along each axis in cells.
pub fn bezier<const D: usize>(window: &Window, part: &[[f64; 2]; D]) -> Window {
    let mut points = *window;
    let n = 4_usize.pow(D as u32);
    for (axis, [a, b]) in part.iter().enumerate() {
        let weights = [[*a, *a, *a], [*a, *a, *b], [*a, *b, *b], [*b, *b, *b]].map(blossom);
        let stride = 4_usize.pow((D - 1 - axis) as u32);
        for block in points[..n].chunks_exact_mut(4 * stride) {
            for s in 0..stride {
                let line: [f64; 4] = std::array::from_fn(|k| block[s + k * stride]);
                for (k, w) in weights.iter().enumerate() {
                    block[s + k * stride] = w[0] * line[0] + w[1] * line[1] + w[2] * line[2] + w[3] * line[3];
                }
            }
        }
    }
    points
}

/// The weights of the four control points in p(t0, t1, t2): de Boor's recursion with an argument of its own for each step.
fn blossom([t0, t1, t2]: [f64; 3]) -> [f64; 4] {
    // The last step first: the weights of p(0, t0, t1) and p(1, t0, t1), then those of p(-1, 0, t0), p(0, 1, t0), p(1, 2, t0).
    let e = [1.0 - t2, t2];
    let d = [0.5 * (1.0 - t1) * e[0], 0.5 * ((1.0 + t1) * e[0] + (2.0 - t1) * e[1]), 0.5 * t1 * e[1]];
    let third = 1.0 / 3.0;
    [
        third * (1.0 - t0) * d[0],
        third * ((2.0 + t0) * d[0] + (2.0 - t0) * d[1]),
        third * ((1.0 + t0) * d[1] + (3.0 - t0) * d[2]),
        third * t0 * d[2],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::isa::Portable;
    use crate::spline::basis::Weights;

    #[test]
    fn the_diagonal_of_the_blossom_is_the_basis() {
        for t in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let (b, w) = (blossom([t; 3]), Weights::at(t).w);
            assert!((0..4).all(|i| (b[i] - w[i]).abs() < 1e-15), "{b:?} {w:?}");
        }
        assert_eq!(
            blossom([0.2, 0.7, 0.4]).map(|x| (1e12 * x).round()),
            blossom([0.7, 0.4, 0.2]).map(|x| (1e12 * x).round())
        );
    }

    fn bounds_hold_and_are_tight<const D: usize>() {
        let mut random = SplitMix64::new(5);
        let strides: [usize; D] = std::array::from_fn(|a| 6_usize.pow((D - 1 - a) as u32));
        let stencil = Stencil { first: 2, strides };
        let c: Vec<f64> = (0..300).map(|_| random.between(-1.0, 1.0)).collect();
        let window = window(&stencil, &c);
        let hull = range::<D>(&window);
        for _ in 0..50 {
            let part: [[f64; 2]; D] = std::array::from_fn(|_| {
                let a = random.unit();
                [a, a + (1.0 - a) * random.unit()]
            });
            let points = bezier(&window, &part);
            let (low, high) = range::<D>(&points);
            assert!(low >= hull.0 - 1e-15 && high <= hull.1 + 1e-15);
            for _ in 0..50 {
                let u = part.map(|[a, b]| random.between(a, b));
                let value = stencil.value::<Portable>(&c, u);
                assert!(value >= low - 1e-15 && value <= high + 1e-15, "{value} in {low} .. {high}");
            }
            // Corners are on the polynomial.
            let value = stencil.value::<Portable>(&c, part.map(|[a, _]| a));
            assert!((points[0] - value).abs() < 1e-15);
        }
    }

    #[test]
    fn bounds_hold_and_are_those_of_the_part() {
        bounds_hold_and_are_tight::<2>();
        bounds_hold_and_are_tight::<3>();
    }
}
