//! Half-spaces beyond which a ball holds nothing that is near the mesh.
//!
//! That a ball of radius h around c may hold points within some reach of the mesh is told by the distance of c alone, but for points that
//! h brings nearer: an error of the order of h. A half-space leaves an error of the order of h^2 where the mesh is smooth as seen from c.
//!
//! Notation: T a facet, y_T its point closest to c, delta_T = |c - y_T|, u_T = (c - y_T) / delta_T; delta and n those of the closest facet.
//! T is convex, so its distance is a convex function, of gradient u_T at c: for any x, with |x - c| <= h,
//!
//! ```text
//! dist(x, T) >= delta_T + u_T . (x - c) >= delta_T + n . (x - c) - |u_T - n| h
//! ```
//!
//! With lag = max over T of |u_T - n| h - (delta_T - delta), at least 0, dist(x, mesh) >= delta + n . (x - c) - lag; so x is within `reach`
//! of the mesh only where n . (x - c) <= reach - delta + lag. Facets farther from c than reach + h have no part in it. A box of the tree
//! is convex too and no farther than what it holds: where its own term is at most the lag so far, dist(x, box) >= delta + n . (x - c) - lag
//! goes for all in it, though a facet's own term may be larger.

use super::super::bvh::STACK_SIZE;
use super::super::facet::{self, closest};
use super::super::vec::{norm, scale, sub};
use super::DistanceTree;

/// The points x with `normal` . (x - center) <= `offset`, in the caller's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HalfSpace<const D: usize> {
    /// Away from the mesh, of length 1.
    pub normal: [f64; D],
    /// From the ball's centre.
    pub offset: f64,
}

impl<const D: usize> DistanceTree<D> {
    /// A half-space that holds every point of the ball around `center` that is within `reach` of the mesh, but for rounding; `None` where it
    /// would hold the ball, and where the mesh may meet the ball.
    pub(crate) fn half_space(&self, center: [f64; D], radius: f64, reach: f64) -> Option<HalfSpace<D>> {
        let (q, h, reach) = (self.query(center).point, radius * self.unit.shrink, reach * self.unit.shrink);
        let (place, nearest) = self.search(q);
        let delta = nearest.distance_squared.sqrt();
        let most = h - (reach - delta);
        if delta <= h || most <= 0.0 {
            return None;
        }
        let normal = scale(1.0 / delta, sub(q, facet::point(&self.corners[place], nearest.barycentric)));
        let lag_of =
            |away: [f64; D], distance: f64| norm(sub(scale(1.0 / distance, away), normal)) * h - (distance - delta);
        let far_squared = (reach + h) * (reach + h);
        let mut lag: f64 = 0.0;
        let (mut stack, mut depth) = ([0; STACK_SIZE], 1);
        while depth > 0 {
            depth -= 1;
            let node = &self.tree.nodes[stack[depth]];
            let d_squared = node.distance_squared(q);
            if d_squared > far_squared {
                continue;
            }
            if d_squared > 0.0 {
                let on_box = std::array::from_fn(|a| q[a].clamp(node.bounds.min[a], node.bounds.max[a]));
                if lag_of(sub(q, on_box), d_squared.sqrt()) <= lag {
                    continue;
                }
            }
            let Some(range) = node.leaf() else {
                stack[depth..depth + 2].copy_from_slice(&node.children());
                depth += 2;
                continue;
            };
            for corners in &self.corners[range] {
                let found = closest(q, corners);
                if found.distance_squared <= far_squared {
                    let away = sub(q, facet::point(corners, found.barycentric));
                    lag = lag.max(lag_of(away, found.distance_squared.sqrt()));
                }
            }
            if lag >= most {
                return None;
            }
        }
        Some(HalfSpace { normal, offset: (reach - delta + lag) * self.unit.grow })
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Mesh;
    use super::super::super::random::SplitMix64;
    use super::super::super::shapes::{box_mesh, circle, sphere, torus};
    use super::super::super::vec::{add, dot};
    use super::*;

    /// Points of balls that are within reach lie in the half-space; gives how many balls had one.
    fn holds_what_is_near<const D: usize>(mesh: &Mesh<D>, reach: f64, seed: u64) -> usize {
        let tree = mesh.distance_tree().unwrap();
        let mut random = SplitMix64::new(seed);
        let mut n = 0;
        for p in mesh.sample(400, seed).unwrap().points() {
            let c = p.map(|x| x + 1.5 * reach * random.between(-1.0, 1.0));
            let h = 0.5 * reach * random.unit();
            let Some(HalfSpace { normal, offset }) = tree.half_space(c, h, reach) else { continue };
            n += 1;
            for _ in 0..200 {
                let d: [f64; D] = std::array::from_fn(|_| random.between(-h, h));
                if norm(d) <= h && tree.closest_point(add(c, d)).unwrap().distance <= reach {
                    assert!(dot(normal, d) <= offset + 1e-12, "{c:?} {h} {d:?}: {} {offset}", dot(normal, d));
                }
            }
        }
        n
    }

    #[test]
    fn what_is_near_lies_in_the_half_space() {
        let cube = box_mesh([-1.0; 3], [1.0, 0.5, 0.2]).unwrap();
        for (seed, reach) in [(1, 0.02), (2, 0.3), (3, 1.0)] {
            assert!(holds_what_is_near(&cube, reach, seed) > 3);
            assert!(holds_what_is_near(&torus(0.7, 0.2, 50, 20).unwrap(), reach, seed) > 3);
            assert!(holds_what_is_near(&circle([3.0, 1.0], 1.0, 100).unwrap(), reach, seed) > 3);
        }
    }

    #[test]
    fn beside_a_face_it_is_the_distance_and_beside_a_sphere_of_the_second_order() {
        let cube = box_mesh([-1.0; 3], [1.0; 3]).unwrap();
        let found = cube.distance_tree().unwrap().half_space([0.1, 0.2, 1.1], 0.05, 0.12).unwrap();
        // The triangle beside the closest one is another facet.
        assert!(found.normal[2] > 1.0 - 1e-14 && (0.02..0.04).contains(&found.offset), "{found:?}");
        let above = cube.distance_tree().unwrap().half_space([0.5, -0.5, 1.1], 0.05, 0.12).unwrap();
        assert!((above.offset - 0.02).abs() < 1e-14, "{above:?}");
        let ball = sphere([0.0; 3], 1.0, 6).unwrap();
        let lag = |h: f64| {
            let offset = ball.distance_tree().unwrap().half_space([0.0, 0.8, 0.0], h, 0.19).unwrap().offset;
            offset - (0.19 - 0.2)
        };
        assert!(lag(0.04) < 0.02 && lag(0.04) > 3.0 * lag(0.02), "{} {}", lag(0.04), lag(0.02));
    }
}
