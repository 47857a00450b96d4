//! Cells anywhere, as the cubes that they are: whether two overlap, and how far they are from each other.

use crate::geometry::matrix::transposed;
use crate::geometry::rigid::Rigid;
use crate::geometry::triangle_pair::nearest_on_segments;
use crate::geometry::vec::{Vec3, add, cross, dot, norm, normalized, scale, sub};

/// A cell somewhere.
pub(super) struct Cube<const D: usize> {
    center: [f64; D],
    half: f64,
    pose: Rigid<D>,
}

impl<const D: usize> Cube<D> {
    /// Of edge `edge`, turned as `pose` turns.
    pub fn new(center: [f64; D], edge: f64, pose: &Rigid<D>) -> Self {
        Cube { center, half: 0.5 * edge, pose: Rigid { turn: pose.turn, shift: center } }
    }

    fn vertices(&self) -> impl Iterator<Item = [f64; D]> + '_ {
        let h = self.half;
        (0..1_usize << D).map(move |k| self.pose.apply(std::array::from_fn(|a| if k >> a & 1 == 0 { -h } else { h })))
    }

    /// The point of the cube nearest to `p`.
    fn nearest(&self, p: [f64; D]) -> [f64; D] {
        self.pose.apply(self.pose.apply_inverse(p).map(|x| x.clamp(-self.half, self.half)))
    }

    /// By how much the shadows of both overlap on the axis on which they do so least; below 0 they are apart, by that much at least.
    pub fn overlap(&self, other: &Self) -> f64 {
        let off = sub(other.center, self.center);
        let (own, others) = (transposed(&self.pose.turn), transposed(&other.pose.turn));
        let least = |least: f64, n: [f64; D]| {
            let shadow = |axes: &[[f64; D]; D], half: f64| half * axes.iter().map(|e| dot(n, *e).abs()).sum::<f64>();
            least.min(shadow(&own, self.half) + shadow(&others, other.half) - dot(n, off).abs())
        };
        let by_faces = own.iter().chain(&others).copied().fold(f64::INFINITY, least);
        if D == 2 {
            return by_faces;
        }
        let three = |v: &[f64; D]| -> Vec3 { std::array::from_fn(|k| v[k % D]) };
        let across = own.iter().flat_map(|a| others.iter().filter_map(move |b| normalized(cross(three(a), three(b)))));
        across.map(|n| std::array::from_fn(|k| n[k])).fold(by_faces, least)
    }

    /// Distance to another, and a point between the nearest points, or one of both where they overlap.
    pub fn distance(&self, other: &Self) -> (f64, [f64; D]) {
        if self.overlap(other) > 0.0 {
            return (0.0, self.common(other));
        }
        // One of the nearest points is a vertex, or they are on two edges.
        let mut best = (f64::INFINITY, self.center);
        let mut take = |p: [f64; D], q: [f64; D]| {
            let distance = norm(sub(p, q));
            if distance < best.0 {
                best = (distance, scale(0.5, add(p, q)));
            }
        };
        self.vertices().for_each(|p| take(p, other.nearest(p)));
        other.vertices().for_each(|q| take(self.nearest(q), q));
        if D == 3 {
            let three = |p: [f64; D]| -> Vec3 { std::array::from_fn(|k| p[k % D]) };
            let edges = |cube: &Self| -> Vec<(Vec3, Vec3)> {
                let v: Vec<Vec3> = cube.vertices().map(three).collect();
                let ends = (0..8_usize).flat_map(|k| (0..3).map(move |a| (k, k | 1 << a)));
                ends.filter(|(k, m)| k != m).map(|(k, m)| (v[k], v[m])).collect()
            };
            for (a, b) in edges(self) {
                for (c, d) in edges(other) {
                    let [s, t] = nearest_on_segments([a, b], [c, d]);
                    let (p, q) = (add(a, scale(s, sub(b, a))), add(c, scale(t, sub(d, c))));
                    take(std::array::from_fn(|k| p[k]), std::array::from_fn(|k| q[k]));
                }
            }
        }
        best
    }

    /// A point of two that overlap, to a hundredth of a cell: the nearest of each to the last, in turn, come together.
    fn common(&self, other: &Self) -> [f64; D] {
        let mut p = scale(0.5, add(self.center, other.center));
        for _ in 0..200 {
            let q = other.nearest(self.nearest(p));
            let moved = norm(sub(p, q));
            p = q;
            if moved < 1e-9 * self.half {
                break;
            }
        }
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::geometry::rigid::Twist;

    #[test]
    fn cubes_that_overlap_share_a_point() {
        let (mut random, mut n) = (SplitMix64::new(8), [0; 2]);
        for _ in 0..3000 {
            let mut v = || random.between(-2.0, 2.0);
            let [a, b, c] = [v(), v(), v()];
            let pose = Twist { turn: [[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]], drift: [0.0; 3] }.exp();
            let one = Cube::new([0.0; 3], 1.0, &Rigid::IDENTITY);
            let two = Cube::new([v(), v(), v()], 1.3, &pose);
            let (by, (distance, p)) = (one.overlap(&two), one.distance(&two));
            if by > 1e-3 {
                let off = |cube: &Cube<3>| norm(sub(p, cube.nearest(p)));
                assert!(distance == 0.0 && off(&one) < 0.01 && off(&two) < 0.01, "{by}: {} {}", off(&one), off(&two));
                n[0] += 1;
            } else if by < 0.0 {
                assert!(distance >= -by - 1e-12, "{by} {distance}");
                n[1] += 1;
            }
        }
        assert!(n[0] > 500 && n[1] > 500, "{n:?}");
    }
}
