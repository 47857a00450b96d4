//! One triangle and one point: closest point and solid angle.

use super::facet::Closest;
use super::vec::{Vec3, add, cross, dot, norm, scale, sub};

/// A triangle is a needle when the squared sine of its angle at the first corner is below this: errors grow by its inverse.
const NEEDLE_SINE_SQUARED: f64 = 1e-3;

impl Closest<3> {
    /// The point with these coordinates along the edges from the first corner, `ap` leading from there to the query.
    #[inline]
    fn at(v: f64, w: f64, [ab, ac, ap]: [Vec3; 3]) -> Self {
        let d = sub(ap, add(scale(v, ab), scale(w, ac)));
        Closest { distance_squared: dot(d, d), barycentric: [1.0 - v - w, v, w] }
    }
}

/// The point of triangle (a, b, c) closest to p, by the Voronoi regions of its corners, edges and inside: Ericson, "Real-time
/// collision detection" (2005), section 5.1.5, its names. We depart in that everything is told from p - a: his vc = d1 d4 - d3 d2
/// is m00 d2 - m01 d1, which is cheaper, and linear in p, so that it keeps its figures when p is far.
#[inline]
pub(super) fn closest(p: Vec3, &[a, b, c]: &[Vec3; 3]) -> Closest<3> {
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let edges = [ab, ac, ap];
    let (m00, m01, m11) = (dot(ab, ab), dot(ab, ac), dot(ac, ac));
    let nn = m00 * m11 - m01 * m01;
    if nn <= NEEDLE_SINE_SQUARED * m00 * m11 {
        return closest_on_needle(edges);
    }
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return Closest::at(0.0, 0.0, edges);
    }
    let (d3, d4) = (d1 - m00, d2 - m01);
    if d3 >= 0.0 && d4 <= d3 {
        return Closest::at(1.0, 0.0, edges);
    }
    let (d5, d6) = (d1 - m01, d2 - m11);
    if d6 >= 0.0 && d5 <= d6 {
        return Closest::at(0.0, 1.0, edges);
    }
    let vc = m00 * d2 - m01 * d1;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return Closest::at(d1 / m00, 0.0, edges);
    }
    let vb = m11 * d1 - m01 * d2;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return Closest::at(0.0, d2 / m11, edges);
    }
    if vb + vc >= nn && d4 >= d3 && d5 >= d6 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return Closest::at(1.0 - w, w, edges);
    }
    let v = (vb / nn).clamp(0.0, 1.0);
    Closest::at(v, (vc / nn).clamp(0.0, 1.0 - v), edges)
}

/// The same for a triangle of little or no height: the best of its edges and of the point below p. Each candidate is a point of
/// the triangle, so an ill-determined one does no harm.
///
/// The point below p is told along the longest edge, which is well determined, and across it, where a height h is known to eps: what it is
/// off by there is at most h, and eps / h times the distance of p, hence at most sqrt(eps times that distance), beside which it makes
/// the distance wrong by its square over twice the distance: some eps.
#[cold]
fn closest_on_needle(edges: [Vec3; 3]) -> Closest<3> {
    let [ab, ac, ap] = edges;
    let (bc, bp) = (sub(ac, ab), sub(ap, ab));
    let along = |e: Vec3, q: Vec3| {
        let length_squared = dot(e, e);
        if length_squared > 0.0 { (dot(e, q) / length_squared).clamp(0.0, 1.0) } else { 0.0 }
    };
    let (v_ab, w_ac, w_bc) = (along(ab, ap), along(ac, ap), along(bc, bp));
    // Along edge e from its start on, and of the corner off it; `to_corner` and `to_p` lead there from the start.
    let inner = |e: Vec3, to_corner: Vec3, to_p: Vec3| {
        let s = along(e, to_corner);
        let x = dot(e, to_p) / dot(e, e);
        // Without what goes along e, of which roundings would count as much as heights.
        let y = along(sub(to_corner, scale(s, e)), sub(to_p, scale(x, e)));
        let x = x.clamp(s * y, (1.0 - (1.0 - s) * y).max(s * y));
        (x - s * y, y)
    };
    let [l_ab, l_ac, l_bc] = [ab, ac, bc].map(|e| dot(e, e));
    let mut candidates = [[v_ab, 0.0], [0.0, w_ac], [1.0 - w_bc, w_bc], [0.0, 0.0]];
    if l_ab >= l_ac && l_ab >= l_bc && l_ab > 0.0 {
        candidates[3] = inner(ab, ac, ap).into();
    } else if l_ac >= l_bc && l_ac > 0.0 {
        let (w, v) = inner(ac, ab, ap);
        candidates[3] = [v, w];
    } else if l_bc > 0.0 {
        let (w, u) = inner(bc, scale(-1.0, ab), bp);
        candidates[3] = [(1.0 - u - w).max(0.0), w];
    }
    let [first, rest @ ..] = candidates.map(|[v, w]| Closest::at(v, w, edges));
    rest.into_iter().fold(first, |best, c| if c.distance_squared < best.distance_squared { c } else { best })
}

/// Solid angle of triangle (a, b, c) seen from p, positive from behind.
pub(super) fn solid_angle(p: Vec3, corners: &[Vec3; 3]) -> f64 {
    let [x, y] = half_angle(p, corners);
    2.0 * y.atan2(x)
}

/// Cosine and sine of half the solid angle, times a common factor: van Oosterom and Strackee, "The solid angle of a plane triangle" (1983),
/// equation (8). The triple product is taken with the edges, so that it keeps its figures when p is far.
pub(super) fn half_angle(p: Vec3, &[a, b, c]: &[Vec3; 3]) -> [f64; 2] {
    let n = cross(sub(b, a), sub(c, a));
    let (a, b, c) = (sub(a, p), sub(b, p), sub(c, p));
    let (la, lb, lc) = (norm(a), norm(b), norm(c));
    [la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb, dot(a, n)]
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;
    use std::f64::consts::PI;

    fn random_point(random: &mut SplitMix64, size: f64) -> Vec3 {
        [random.between(-size, size), random.between(-size, size), random.between(-size, size)]
    }

    /// The least distance over a fine lattice of points of the triangle.
    fn lattice_distance(p: Vec3, [a, b, c]: &[Vec3; 3], n: i32) -> f64 {
        let mut least = f64::INFINITY;
        for i in 0..=n {
            for j in 0..=n - i {
                let (v, w) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                let q = add(*a, add(scale(v, sub(*b, *a)), scale(w, sub(*c, *a))));
                least = least.min(norm(sub(p, q)));
            }
        }
        least
    }

    #[test]
    fn closest_is_no_farther_than_any_point_and_lies_on_the_triangle() {
        let mut random = SplitMix64::new(1);
        for k in 0..600 {
            let [a, b, mut c] = std::array::from_fn(|_| random_point(&mut random, 1.0));
            // Every third is a needle, every sixth a line, some a point.
            if k % 3 == 0 {
                let height = if k % 6 == 0 { 0.0 } else { 1e-5 };
                c = add(add(a, scale(random.between(-1.0, 2.0), sub(b, a))), [height; 3]);
            }
            let corners = if k % 18 == 0 { [a; 3] } else { [a, b, c] };
            let p = random_point(&mut random, 2.0);
            let found = closest(p, &corners);
            let distance = found.distance_squared.sqrt();
            let [u, v, w] = found.barycentric;
            let q = add(add(scale(u, corners[0]), scale(v, corners[1])), scale(w, corners[2]));
            assert!((norm(sub(p, q)) - distance).abs() < 1e-14);
            assert!(u >= -1e-15 && v >= 0.0 && w >= 0.0);
            let reference = lattice_distance(p, &corners, 60);
            assert!(distance <= reference + 1e-14 && distance > reference - 0.06, "{k}: {distance} {reference}");
        }
    }

    /// Points of needles, and points straight above them, are as far as they are, whatever the height and the corner told first.
    #[test]
    fn distances_to_needles_are_off_by_roundings_alone() {
        let mut random = SplitMix64::new(4);
        for k in 0..40_000 {
            let height = 10.0_f64.powf(random.between(-16.0, -1.5));
            let [a, b, off] = std::array::from_fn(|_| random_point(&mut random, 0.5));
            let c = add(add(a, scale(random.unit(), sub(b, a))), scale(height, off));
            let mut corners = [a, b, c];
            corners.rotate_left(k % 3);
            let n = cross(sub(b, a), sub(c, a));
            let (mut x, mut y) = (random.unit(), random.unit());
            if x + y > 1.0 {
                (x, y) = (1.0 - x, 1.0 - y);
            }
            let on = add(a, add(scale(x, sub(b, a)), scale(y, sub(c, a))));
            let away = 10.0_f64.powf(random.between(-12.0, 0.0));
            let edges = |p: Vec3| [corners[1], corners[2], p].map(|q| sub(q, corners[0]));
            let found = closest_on_needle(edges(on)).distance_squared.sqrt();
            assert!(found < 2e-15, "{height}: {found}");
            // Told by the normal where the triangle is no needle yet.
            let found = closest(on, &corners).distance_squared.sqrt();
            assert!(found < 1e-12, "{height}: {found}");
            // No nearer than along the normal, and no farther than the point below.
            if norm(n) > 0.0 {
                let above = add(on, scale(away / norm(n), n));
                let found = closest_on_needle(edges(above)).distance_squared.sqrt();
                assert!(found <= away + 2e-15, "{height}, {away}: {found}");
            }
        }
    }

    #[test]
    fn corners_are_at_distance_zero_to_the_bit() {
        let mut random = SplitMix64::new(2);
        for _ in 0..1000 {
            let corners: [Vec3; 3] = std::array::from_fn(|_| random_point(&mut random, 1.0));
            for p in corners {
                assert_eq!(closest(p, &corners).distance_squared, 0.0);
            }
        }
    }

    #[test]
    fn solid_angle_of_an_octant_is_half_pi() {
        let octant = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!((solid_angle([0.0; 3], &octant) - 0.5 * PI).abs() < 1e-15);
        assert_eq!(solid_angle([1.0, 0.0, 0.0], &octant), 0.0);
        // From afar, behind: area times cosine by squared distance.
        let far = solid_angle([-1e6; 3], &octant) * 3e12 / (0.5 * 3.0_f64.sqrt());
        assert!((far - 1.0).abs() < 1e-5, "{far}");
    }
}
