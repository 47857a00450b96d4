//! An order of points in which neighbours in the list are mostly neighbours in space.

use super::Bounds;
use crate::Result;
use crate::error::try_with_capacity;

/// Bits of a coordinate, three of which fit 64; in the plane as many.
const BITS: u32 = 21;

/// Indices of `points` along the Z curve of `bounds` (Morton, 1966); points outside are taken to its rim.
pub(super) fn along_z_curve<const D: usize>(points: &[[f64; D]], bounds: &Bounds<D>) -> Result<Vec<usize>> {
    let extents = bounds.extents();
    let code = |p: &[f64; D]| {
        // A product of infinity and zero, on a flat box, saturates to cell 0.
        let cell = |a: usize| ((p[a] - bounds.min[a]) / extents[a] * f64::from(1 << BITS)) as u64;
        (0..D).map(|a| spread(cell(a).min((1 << BITS) - 1)) << a).sum::<u64>()
    };
    let mut keys: Vec<(u64, usize)> = try_with_capacity(points.len(), "the order of the points")?;
    keys.extend(points.iter().enumerate().map(|(i, p)| (code(p), i)));
    keys.sort_unstable();
    let mut order = try_with_capacity(points.len(), "the order of the points")?;
    order.extend(keys.iter().map(|&(_, i)| i));
    Ok(order)
}

/// Two zeros put after each of the lowest 21 bits.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::super::vec::Vec3;
    use super::*;

    #[test]
    fn spread_puts_every_bit_at_three_times_its_place() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread((1 << BITS) - 1).count_ones(), BITS);
    }

    #[test]
    fn orders_octants_and_takes_every_point_once() {
        let bounds = Bounds { min: [0.0; 3], max: [2.0; 3] };
        let corners: Vec<Vec3> = (0..8).rev().map(|i| [0, 1, 2].map(|a| f64::from(i >> a & 1) + 0.5)).collect();
        assert_eq!(along_z_curve(&corners, &bounds).unwrap(), [7, 6, 5, 4, 3, 2, 1, 0]);
        let flat = Bounds { min: [0.0; 3], max: [2.0, 2.0, 0.0] };
        let mut order = along_z_curve(&[[1e300, -1e300, 0.0], [0.0; 3], [1.0; 3]], &flat).unwrap();
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2]);
    }
}
