//! One segment of the plane and one point: closest point and angle.

use super::facet::{Closest, normal};
use super::vec::{add, dot, scale, sub};

/// The point of segment (a, b) closest to p.
#[inline]
pub(super) fn closest(p: [f64; 2], &[a, b]: &[[f64; 2]; 2]) -> Closest<2> {
    let (ab, ap) = (sub(b, a), sub(p, a));
    let length_squared = dot(ab, ab);
    let t = if length_squared > 0.0 { (dot(ab, ap) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    // From the nearer end, so that both ends are at distance 0 to the bit.
    let d = if t < 0.5 { sub(ap, scale(t, ab)) } else { add(sub(p, b), scale(1.0 - t, ab)) };
    Closest { distance_squared: dot(d, d), barycentric: [1.0 - t, t] }
}

/// Angle of segment (a, b) seen from p, positive from behind: from its left.
pub(super) fn solid_angle(p: [f64; 2], corners: &[[f64; 2]; 2]) -> f64 {
    let [x, y] = angle(p, corners);
    y.atan2(x)
}

/// Cosine and sine of the angle, times a common factor. The product is taken with the edge, so that it keeps its figures when p is far.
pub(super) fn angle(p: [f64; 2], corners: &[[f64; 2]; 2]) -> [f64; 2] {
    let [a, b] = corners.map(|c| sub(c, p));
    [dot(a, b), dot(a, normal(corners))]
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::super::vec::norm;
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn closest_is_no_farther_than_any_point_and_lies_on_the_segment() {
        let mut random = SplitMix64::new(1);
        for k in 0..300 {
            let mut point = || std::array::from_fn(|_| random.between(-1.0, 1.0));
            let (p, a, b) = (point(), point(), point());
            let corners = if k % 10 == 0 { [a, a] } else { [a, b] };
            let found = closest(p, &corners);
            let [u, v] = found.barycentric;
            let q = add(scale(u, corners[0]), scale(v, corners[1]));
            assert!(u >= 0.0 && v >= 0.0 && (u + v - 1.0).abs() < 1e-15);
            assert!((norm(sub(p, q)) - found.distance_squared.sqrt()).abs() < 1e-14);
            for i in 0..=100 {
                let t = f64::from(i) / 100.0;
                let other = add(scale(1.0 - t, corners[0]), scale(t, corners[1]));
                assert!(found.distance_squared <= dot(sub(p, other), sub(p, other)) + 1e-14);
            }
            for end in corners {
                assert_eq!(closest(end, &corners).distance_squared, 0.0);
            }
        }
    }

    #[test]
    fn angles_are_positive_from_the_left_and_add_up_around_a_square() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let around = |p| (0..4).map(|k| solid_angle(p, &[corners[k], corners[(k + 1) % 4]])).sum::<f64>();
        assert!((around([0.3, 0.9]) - 2.0 * PI).abs() < 1e-15);
        assert!(around([1.3, 0.9]).abs() < 1e-15);
        assert!((solid_angle([0.5, 0.5], &[corners[0], corners[1]]) - 0.5 * PI).abs() < 1e-15);
    }
}
