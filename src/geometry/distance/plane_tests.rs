//! Distances in the plane.

use super::super::random::SplitMix64;
use super::super::shapes::{circle, rectangle};
use super::super::vec::{norm, sub};
use super::*;

fn random_point(random: &mut SplitMix64, size: f64) -> [f64; 2] {
    std::array::from_fn(|_| random.between(-size, size))
}

/// Segments of all sizes, some without length, anyhow in a square of half width 1.
fn soup(n: usize, seed: u64) -> Mesh<2> {
    let mut random = SplitMix64::new(seed);
    let mut vertices = Vec::new();
    for i in 0..n {
        let from = random_point(&mut random, 1.0);
        let step = random_point(&mut random, 0.5_f64.powi((i % 8) as i32));
        vertices.extend([from, if i % 10 == 0 { from } else { super::super::vec::add(from, step) }]);
    }
    Mesh::new(vertices, (0..n as u32).map(|s| [2 * s, 2 * s + 1]).collect()).unwrap()
}

fn signed(mesh: &Mesh<2>, points: &[[f64; 2]]) -> Vec<f64> {
    let mut out = vec![f64::NAN; points.len()];
    mesh.distance_tree().unwrap().signed_distances(points, &mut out).unwrap();
    out
}

/// Every segment is asked: for its nearest point, and for the angle that it fills.
fn brute_force(mesh: &Mesh<2>, p: [f64; 2]) -> f64 {
    let (mut least, mut angle) = (f64::INFINITY, 0.0);
    for s in 0..mesh.segments().len() {
        let [a, b] = mesh.corners(s);
        let (u, v) = (sub(a, p), sub(b, p));
        angle += (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
        let along = sub(b, a);
        let squared = along[0] * along[0] + along[1] * along[1];
        let t = if squared > 0.0 { (-(u[0] * along[0] + u[1] * along[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
        least = least.min((u[0] + t * along[0]).hypot(u[1] + t * along[1]));
    }
    if angle / std::f64::consts::TAU < 0.5 { least } else { -least }
}

#[test]
fn agrees_with_brute_force() {
    let ring = circle([0.1, -0.2], 0.7, 101).unwrap();
    let arc = Mesh::new(ring.vertices().to_vec(), ring.segments()[..60].to_vec()).unwrap();
    let slab = rectangle([-0.9, -0.001], [0.8, 0.001]).unwrap();
    let mut random = SplitMix64::new(5);
    for (k, mesh) in [soup(1, 1), soup(6, 2), soup(700, 3), soup(4000, 4), ring, arc, slab].iter().enumerate() {
        let points: Vec<[f64; 2]> =
            (0..400).map(|i| random_point(&mut random, if i % 4 == 0 { 10.0 } else { 1.2 })).collect();
        for (p, d) in points.iter().zip(signed(mesh, &points)) {
            let expected = brute_force(mesh, *p);
            assert!((d - expected).abs() <= 1e-14 * (1.0 + d.abs()), "shape {k}, {p:?}: {d} for {expected}");
            let closest = mesh.distance_tree().unwrap().closest_point(*p).unwrap();
            assert!((norm(sub(closest.point, *p)) - closest.distance).abs() <= 1e-14 * (1.0 + d.abs()));
            assert_eq!(closest.distance, d.abs());
        }
    }
}

#[test]
fn circle_and_rectangle_follow_their_closed_forms() {
    let mut random = SplitMix64::new(6);
    let points: Vec<[f64; 2]> = (0..2000).map(|_| random_point(&mut random, 2.0)).collect();
    // The polygon is inscribed: its sagitta is edge^2 / 8 radius.
    let ring = circle([0.0; 2], 1.0, 1000).unwrap();
    for (p, d) in points.iter().zip(signed(&ring, &points)) {
        assert!((d - (norm(*p) - 1.0)).abs() < 5e-6, "{p:?}: {d}");
    }
    let box_2d = rectangle([-1.0, -0.5], [1.0, 0.5]).unwrap();
    for (p, d) in points.iter().zip(signed(&box_2d, &points)) {
        let [x, y] = [p[0].abs() - 1.0, p[1].abs() - 0.5];
        let exact = x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0);
        assert!((d - exact).abs() < 1e-15, "{p:?}: {d} {exact}");
    }
}

#[test]
fn rectangle_has_its_distances_to_the_bit() {
    let box_2d = rectangle([-1.0; 2], [1.0; 2]).unwrap();
    let points = [[0.0; 2], [0.5, 0.25], [3.0, 0.0], [4.0, 5.0], [1.0, -1.0]];
    assert_eq!(signed(&box_2d, &points), [-1.0, -0.5, 2.0, 5.0, 0.0]);
}

#[test]
fn an_open_arc_has_an_inside_up_to_where_it_fills_half_the_angles() {
    // A half circle fills half of all angles on its chord's line, pi of 2 pi: w = 1/2 there, more towards the arc.
    let ring = circle([0.0; 2], 1.0, 200).unwrap();
    let arc = Mesh::new(ring.vertices().to_vec(), ring.segments()[..100].to_vec()).unwrap();
    let points = [[0.0, 0.5], [0.6, 0.01], [-0.3, 0.7], [0.0, -0.01], [0.0, 1.5], [3.0, -5.0]];
    let signs: Vec<f64> = signed(&arc, &points).iter().map(|d| d.signum()).collect();
    assert_eq!(signs, [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0]);
    // Across the circle the arc fills the inscribed angle over its chord, pi / 2.
    let w = arc.distance_tree().unwrap().winding_number([0.0, -1.0]);
    assert!((w - 0.25).abs() < 0.1, "{w}");
}

#[test]
fn a_power_of_two_only_scales_and_flipping_changes_sides() {
    let mut ring = circle([3.0, 1.0], 2.0, 20).unwrap();
    let mut random = SplitMix64::new(8);
    let points: Vec<[f64; 2]> = (0..200).map(|_| random_point(&mut random, 5.0)).collect();
    let distances = signed(&ring, &points);
    for exponent in [-900, -30, 30, 900] {
        let factor = 2.0_f64.powi(exponent);
        let vertices = ring.vertices().iter().map(|&v| scale(factor, v)).collect();
        let scaled = Mesh::new(vertices, ring.segments().to_vec()).unwrap();
        let scaled_points: Vec<[f64; 2]> = points.iter().map(|&p| scale(factor, p)).collect();
        let expected: Vec<f64> = distances.iter().map(|d| factor * d).collect();
        assert_eq!(signed(&scaled, &scaled_points), expected);
    }
    ring.flip();
    // Segments are measured from their first ends, which changes bits.
    assert!(signed(&ring, &points).iter().zip(&distances).all(|(f, d)| (f - d.abs()).abs() < 1e-14));
}
