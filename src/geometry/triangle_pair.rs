//! Two triangles of space: their nearest points, and the segment along which they cross, with its derivatives.
//!
//! Notation: a and b the corners, n_a and n_b unit normals, e the direction of the line on which the planes meet, P an end of the segment:
//! where an edge u of one triangle meets the plane of the other.

use super::triangle::closest;
use super::vec::{Vec3, add, cross, dot, normalized, scale, sub};

/// The nearest points of two triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearestPoints {
    pub distance_squared: f64,
    /// Of the point in each triangle: not negative, of sum 1.
    pub barycentric: [Vec3; 2],
}

/// Edges of a triangle by its corners.
const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The nearest points: an edge goes through the other triangle, or one of them is a corner, or both lie on edges. Triangles without area are
/// served as the segments and points that they are.
pub(crate) fn nearest(a: &[Vec3; 3], b: &[Vec3; 3]) -> NearestPoints {
    let mut best = NearestPoints { distance_squared: f64::INFINITY, barycentric: [[1.0, 0.0, 0.0]; 2] };
    let mut offer = |distance_squared: f64, barycentric: [Vec3; 2]| {
        if distance_squared < best.distance_squared {
            best = NearestPoints { distance_squared, barycentric };
        }
    };
    for corner in 0..3 {
        let mut one = [0.0; 3];
        one[corner] = 1.0;
        let to_b = closest(a[corner], b);
        offer(to_b.distance_squared, [one, to_b.barycentric]);
        let to_a = closest(b[corner], a);
        offer(to_a.distance_squared, [to_a.barycentric, one]);
    }
    for edge in EDGES {
        if let Some((on_a, in_b)) = pierced(edge, a, b) {
            offer(0.0, [on_a, in_b]);
        }
        if let Some((on_b, in_a)) = pierced(edge, b, a) {
            offer(0.0, [in_a, on_b]);
        }
    }
    for [i, j] in EDGES {
        for [k, l] in EDGES {
            let [s, t] = nearest_on_segments([a[i], a[j]], [b[k], b[l]]);
            let (mut on_a, mut on_b) = ([0.0; 3], [0.0; 3]);
            (on_a[i], on_a[j], on_b[k], on_b[l]) = (1.0 - s, s, 1.0 - t, t);
            let r = sub(add(a[i], scale(s, sub(a[j], a[i]))), add(b[k], scale(t, sub(b[l], b[k]))));
            offer(dot(r, r), [on_a, on_b]);
        }
    }
    best
}

/// Where an edge of a goes through b: barycentric coordinates on the edge, and in b.
fn pierced([i, j]: [usize; 2], a: &[Vec3; 3], b: &[Vec3; 3]) -> Option<(Vec3, Vec3)> {
    let (ab, ac) = (sub(b[1], b[0]), sub(b[2], b[0]));
    let n = cross(ab, ac);
    let [from, to] = [dot(n, sub(a[i], b[0])), dot(n, sub(a[j], b[0]))];
    // On the plane is above it: an edge in the plane meets an edge of b.
    if (from >= 0.0) == (to >= 0.0) {
        return None;
    }
    let part = from / (from - to);
    let p = sub(add(a[i], scale(part, sub(a[j], a[i]))), b[0]);
    let nn = dot(n, n);
    let (v, w) = (dot(n, cross(p, ac)) / nn, dot(n, cross(ab, p)) / nn);
    if !(v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
        return None;
    }
    let mut on_edge = [0.0; 3];
    (on_edge[i], on_edge[j]) = (1.0 - part, part);
    Some((on_edge, [1.0 - v - w, v, w]))
}

/// Where on two segments, as parts of their lengths, their nearest points lie: Ericson 2005, 5.1.9.
pub(crate) fn nearest_on_segments([p1, q1]: [Vec3; 2], [p2, q2]: [Vec3; 2]) -> [f64; 2] {
    let (d1, d2, r) = (sub(q1, p1), sub(q2, p2), sub(p1, p2));
    let (a, e, f) = (dot(d1, d1), dot(d2, d2), dot(d2, r));
    let part = |x: f64, of: f64| if of > 0.0 { (x / of).clamp(0.0, 1.0) } else { 0.0 };
    if a == 0.0 {
        return [0.0, part(f, e)];
    }
    let c = dot(d1, r);
    if e == 0.0 {
        return [part(-c, a), 0.0];
    }
    let b = dot(d1, d2);
    let s = part(b * f - c * e, a * e - b * b);
    let t = (b * s + f) / e;
    if t < 0.0 {
        return [part(-c, a), 0.0];
    }
    if t > 1.0 {
        return [part(b - c, a), 1.0];
    }
    [s, t]
}

/// The segment along which two triangles cross.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Above 0.
    pub length: f64,
    /// d length / d corners of b.
    pub by_b: [Vec3; 3],
}

/// An end of the segment in which one triangle meets the plane of the other.
#[derive(Clone, Copy)]
struct End {
    /// e . P, from the first corner of a.
    along: f64,
    point: Vec3,
    /// Corners of the edge that it lies on, and where on it.
    edge: [usize; 2],
    part: f64,
    of_b: bool,
}

/// How two triangles cross; `None` where they do not, or only touch, lie in one plane, or one has no area.
pub(crate) fn crossing(a: &[Vec3; 3], b: &[Vec3; 3]) -> Option<Crossing> {
    let normal = |[a, b, c]: &[Vec3; 3]| normalized(cross(sub(*b, *a), sub(*c, *a)));
    let (n_a, n_b) = (normal(a)?, normal(b)?);
    let heights_of_b = b.map(|p| dot(n_a, sub(p, a[0])));
    let lone_of_b = lone(&heights_of_b)?;
    let heights_of_a = a.map(|p| dot(n_b, sub(p, b[0])));
    let lone_of_a = lone(&heights_of_a)?;
    let e = normalized(cross(n_a, n_b))?;
    let ends = |corners: &[Vec3; 3], heights: &[f64; 3], lone: usize, of_b: bool| {
        let end = |other: usize| {
            let part = heights[lone] / (heights[lone] - heights[other]);
            let point = add(corners[lone], scale(part, sub(corners[other], corners[lone])));
            End { along: dot(e, sub(point, a[0])), point, edge: [lone, other], part, of_b }
        };
        let (first, second) = (end((lone + 1) % 3), end((lone + 2) % 3));
        if second.along < first.along { [second, first] } else { [first, second] }
    };
    let [low_a, high_a] = ends(a, &heights_of_a, lone_of_a, false);
    let [low_b, high_b] = ends(b, &heights_of_b, lone_of_b, true);
    let low = if low_b.along > low_a.along { low_b } else { low_a };
    let high = if high_b.along < high_a.along { high_b } else { high_a };
    if high.along <= low.along {
        return None;
    }
    let by_b = |end: &End| match end.of_b {
        true => moved_with_edge(end, b, e, n_a),
        false => moved_with_plane(end, a, b, e, n_b),
    };
    let (by_high, by_low) = (by_b(&high), by_b(&low));
    Some(Crossing { length: high.along - low.along, by_b: std::array::from_fn(|k| sub(by_high[k], by_low[k])) })
}

/// The corner alone on its side of a plane; a height of 0 is above, so that neighbours agree on the corners that they share.
fn lone(heights: &[f64; 3]) -> Option<usize> {
    let above = heights.map(|h| h >= 0.0);
    (0..3).find(|&k| above[k] != above[(k + 1) % 3] && above[k] != above[(k + 2) % 3])
}

/// d (e . P) / d corners of b, for P on the edge u of b in the plane of a: P moves with the edge, and along it so that it stays in the
/// plane: d P = d p - u (n_a . d p) / (n_a . u).
fn moved_with_edge(end: &End, b: &[Vec3; 3], e: Vec3, n_a: Vec3) -> [Vec3; 3] {
    let [i, j] = end.edge;
    let u = sub(b[j], b[i]);
    let g = sub(e, scale(dot(e, u) / dot(n_a, u), n_a));
    let mut by_b = [[0.0; 3]; 3];
    by_b[i] = scale(1.0 - end.part, g);
    by_b[j] = scale(end.part, g);
    by_b
}

/// The same for P on the edge u of a in the plane of b: d P = u (n_b . d q) / (n_b . u), q the point of the plane where P is.
fn moved_with_plane(end: &End, a: &[Vec3; 3], b: &[Vec3; 3], e: Vec3, n_b: Vec3) -> [Vec3; 3] {
    let [i, j] = end.edge;
    let u = sub(a[j], a[i]);
    let g = scale(dot(e, u) / dot(n_b, u), n_b);
    let (ab, ac, ap) = (sub(b[1], b[0]), sub(b[2], b[0]), sub(end.point, b[0]));
    let n = cross(ab, ac);
    let nn = dot(n, n);
    let (v, w) = (dot(n, cross(ap, ac)) / nn, dot(n, cross(ab, ap)) / nn);
    [1.0 - v - w, v, w].map(|weight| scale(weight, g))
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    fn triangle(random: &mut SplitMix64, around: Vec3) -> [Vec3; 3] {
        std::array::from_fn(|_| std::array::from_fn(|a| around[a] + random.between(-1.0, 1.0)))
    }

    fn at(corners: &[Vec3; 3], b: Vec3) -> Vec3 {
        std::array::from_fn(|a| (0..3).map(|k| b[k] * corners[k][a]).sum())
    }

    #[test]
    fn nearest_points_are_no_farther_than_those_of_a_lattice() {
        let mut random = SplitMix64::new(1);
        for k in 0..300 {
            let (a, mut b) = (triangle(&mut random, [0.0; 3]), triangle(&mut random, [0.7; 3]));
            // Some are segments, some points.
            if k % 5 == 0 {
                b[2] = b[1];
            }
            if k % 25 == 0 {
                b = [b[0]; 3];
            }
            if crossing(&a, &b).is_some() {
                continue;
            }
            let found = nearest(&a, &b);
            let [on_a, on_b] = found.barycentric;
            let r = sub(at(&a, on_a), at(&b, on_b));
            assert!((dot(r, r).sqrt() - found.distance_squared.sqrt()).abs() < 1e-7);
            let mut least = f64::INFINITY;
            for i in 0..=30 {
                for j in 0..=30 - i {
                    let p = at(&a, [f64::from(i) / 30.0, f64::from(j) / 30.0, f64::from(30 - i - j) / 30.0]);
                    least = least.min(closest(p, &b).distance_squared.sqrt());
                }
            }
            let distance = found.distance_squared.sqrt();
            assert!(distance <= least + 1e-12 && distance > least - 0.1, "{k}: {distance} {least}");
        }
    }

    #[test]
    fn crossings_have_their_length_and_derivatives() {
        let a = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let b = [[1.0, 0.5, -1.0], [1.0, 0.5, 1.0], [1.0, 1.5, 0.0]];
        assert!((crossing(&a, &b).unwrap().length - 1.0).abs() < 1e-15);
        let mut random = SplitMix64::new(2);
        let mut n = 0;
        while n < 300 {
            let (a, b) = (triangle(&mut random, [0.0; 3]), triangle(&mut random, [0.0; 3]));
            let Some(found) = crossing(&a, &b) else { continue };
            if found.length < 0.05 {
                continue;
            }
            let swapped = crossing(&b, &a).unwrap().length;
            assert!((swapped - found.length).abs() < 1e-9, "{swapped} {found:?}");
            n += 1;
            let size = found.by_b.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
            for corner in 0..3 {
                for axis in 0..3 {
                    let length = |by: f64| {
                        let mut moved = b;
                        moved[corner][axis] += by;
                        crossing(&a, &moved).map_or(f64::NAN, |c| c.length)
                    };
                    // Where an end goes from one edge to another the length has a kink: both sides must then hold it.
                    let h = 1e-6;
                    let (up, down) = ((length(h) - found.length) / h, (found.length - length(-h)) / h);
                    let by = found.by_b[corner][axis];
                    let error = (up - by).abs().min((down - by).abs());
                    assert!(error < 1e-3 * size * size, "{by} for {up} and {down}");
                }
            }
        }
    }

    #[test]
    fn what_touches_or_lies_in_one_plane_does_not_cross() {
        let a = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        assert_eq!(crossing(&a, &a), None);
        assert_eq!(crossing(&a, &[[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), None);
        assert_eq!(crossing(&a, &[[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]]), None);
    }
}
