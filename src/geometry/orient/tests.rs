use super::super::random::SplitMix64;
use super::super::shapes::{box_mesh, sphere, torus};
use super::super::vec::{Vec3, dot};
use super::*;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

fn estimate_of<const D: usize>(points: &[[f64; D]]) -> (Cloud<D>, NormalReport) {
    let options = NormalOptions { n_threads: 1, ..NormalOptions::default() };
    Cloud::with_estimated_normals(points.to_vec(), &options, &mut Progress::silent()).unwrap()
}

fn error_of<const D: usize>(points: &[[f64; D]]) -> Error {
    Cloud::with_estimated_normals(points.to_vec(), &NormalOptions::default(), &mut Progress::silent()).unwrap_err()
}

/// Points whose normals lie within a right angle of the true ones.
fn right<const D: usize>(cloud: &Cloud<D>, truth: &[[f64; D]]) -> usize {
    cloud.normals().iter().zip(truth).filter(|(a, b)| dot(**a, **b) > 0.0).count()
}

fn circle(radius: f64, n: usize) -> Vec<[f64; 2]> {
    let angle = |i: usize| TAU * i as f64 / n as f64;
    (0..n).map(|i| [radius * angle(i).cos(), radius * angle(i).sin()]).collect()
}

#[test]
fn closed_shapes_face_outward() {
    let shapes = [sphere([5.0, -3.0, 1.0], 2.0, 4), torus(1.0, 0.3, 80, 40), box_mesh([0.0; 3], [1.0, 2.0, 3.0])];
    for mesh in shapes {
        let truth = mesh.unwrap().sample(3000, 1).unwrap();
        let (cloud, report) = estimate_of(truth.points());
        assert_eq!(right(&cloud, truth.normals()), 3000);
        assert_eq!((report.n_components, &report.copies, &report.degenerate), (1, &vec![], &vec![]));
        assert_eq!(cloud.points(), truth.points());
    }
    let ring = circle(2.0, 40);
    assert_eq!(right(&estimate_of(&ring).0, &ring), 40);
}

#[test]
fn the_wall_of_a_cavity_faces_into_it_and_parts_apart_face_outward() {
    let nested = [circle(1.0, 60), circle(2.0, 120), circle(3.0, 180)].concat();
    let (cloud, report) = estimate_of(&nested);
    assert_eq!(report.n_components, 3);
    let middle = |i: usize| (60..180).contains(&i);
    assert!((0..360).all(|i| (dot(cloud.normals()[i], nested[i]) < 0.0) == middle(i)));

    let [a, b] = [0.0, 9.0].map(|x| sphere([x, 0.0, 0.0], 1.0, 3).unwrap().sample(500, 1).unwrap());
    let points = [a.points(), b.points()].concat();
    let (cloud, report) = estimate_of(&points);
    assert_eq!((report.n_components, right(&cloud, &[a.normals(), b.normals()].concat())), (2, 1000));
}

#[test]
fn open_shapes_face_the_side_they_bulge_to_and_flat_ones_their_largest_coordinate() {
    let upper: Vec<Vec3> =
        sphere([0.0; 3], 1.0, 5).unwrap().vertices().iter().copied().filter(|v| v[2] > 0.3).collect();
    assert_eq!(right(&estimate_of(&upper).0, &upper), upper.len());
    let flat: Vec<Vec3> = (0..100).map(|i| [(i % 10) as f64, (i / 10) as f64, 7.0]).collect();
    assert_eq!(right(&estimate_of(&flat).0, &[[0.0, 0.0, 1.0]; 100]), 100);
}

#[test]
fn threads_and_powers_of_two_change_no_bit() {
    let points = torus(1.0, 0.3, 80, 40).unwrap().sample(3000, 1).unwrap().points().to_vec();
    let (cloud, report) = estimate_of(&points);
    for (exponent, n_threads) in [(0, 3), (-600, 1), (600, 2)] {
        let scaled = points.iter().map(|&p| scale(2f64.powi(exponent), p)).collect();
        let options = NormalOptions { n_threads, ..NormalOptions::default() };
        let (other, its) = Cloud::with_estimated_normals(scaled, &options, &mut Progress::silent()).unwrap();
        assert_eq!(other.normals(), cloud.normals());
        assert_eq!(NormalReport { seconds: report.seconds, ..its }, report);
    }
}

#[test]
fn copies_and_outliers_are_named_and_harm_no_other() {
    let truth = sphere([0.0; 3], 1.0, 4).unwrap().sample(2000, 1).unwrap();
    let mut points = truth.points().to_vec();
    // Every tenth point many times over: neighbourhoods of equal points, were they not made one.
    for _ in 0..20 {
        points.extend(truth.points().iter().step_by(10));
    }
    let n = points.len();
    points.extend([[3.0, 0.0, 0.0], [0.0; 3], [0.0, -1.5, 0.0]]);
    let (cloud, report) = estimate_of(&points);
    assert_eq!(report.copies, (2000..n as u32).collect::<Vec<_>>());
    assert_eq!(report.outliers, (n as u32..n as u32 + 3).collect::<Vec<_>>());
    assert!((0..n).all(|i| dot(cloud.normals()[i], points[i]) > 0.0));
    let cleaned = cloud.without(&report.outliers).unwrap().without(&report.copies).unwrap();
    assert_eq!(cleaned.points(), truth.points());
    // Weights and places on a mesh stay with their points.
    let mut sampled = sphere([0.0; 3], 1.0, 1).unwrap().sample(4, 1).unwrap();
    sampled.set_weights(vec![1.0, 2.0, 3.0, 4.0]).unwrap();
    let fewer = sampled.without(&[1]).unwrap();
    assert_eq!(fewer.weights(), Some(&[1.0, 3.0, 4.0][..]));
    assert_eq!(fewer.origins().unwrap()[1], sampled.origins().unwrap()[2]);
    assert!(cloud.without(&[n as u32 + 3]).unwrap_err().to_string().contains("index 0 is 6003"));
}

#[test]
fn lines_of_a_scan_get_planes_from_the_lines_beside_them() {
    // Ten times as dense along the lines as across.
    let points: Vec<Vec3> = (0..4000).map(|i| [0.1 * (i % 400) as f64, (i / 400) as f64, 0.0]).collect();
    let (cloud, report) = estimate_of(&points);
    assert_eq!(report.degenerate, []);
    assert!(cloud.normals().iter().all(|n| n[2] > 0.999));
    // A line beside a sphere has none.
    let mut points = sphere([0.0; 3], 1.0, 4).unwrap().sample(2000, 1).unwrap().points().to_vec();
    points.extend((0..200).map(|i| [2.0, 0.0, 0.01 * f64::from(i)]));
    assert_eq!(estimate_of(&points).1.degenerate, (2000..2200).collect::<Vec<_>>());
}

#[test]
fn the_smallest_clouds_have_normals() {
    let (cloud, _) = estimate_of(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(cloud.len(), 3);
    for n in 4..9 {
        let mut random = SplitMix64::new(n);
        let points: Vec<Vec3> = (0..n).map(|_| std::array::from_fn(|_| random.unit())).collect();
        assert_eq!(estimate_of(&points).0.len(), n as usize);
    }
}

#[test]
fn lattices_noise_and_sizes_at_the_ends_of_the_range_pass() {
    // No surface at all, and ties everywhere.
    let lattice: Vec<Vec3> = (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100].map(f64::from)).collect();
    let mut random = SplitMix64::new(1);
    let noise: Vec<Vec3> = (0..1000).map(|_| std::array::from_fn(|_| random.unit())).collect();
    // Differences whose squares are nothing beside points of size 1.
    let specks: Vec<Vec3> = lattice.iter().map(|&p| scale(1e-200, p)).chain(noise.iter().copied()).collect();
    let largest = noise.iter().map(|&p| scale(f64::MAX, p)).collect();
    let smallest = noise.iter().map(|&p| scale(1e-306, p)).collect();
    for points in [lattice, noise, specks, largest, smallest] {
        let (cloud, report) = estimate_of(&points);
        assert_eq!(cloud.len(), points.len());
        assert!((0.0..=1.0).contains(&report.agreement));
    }
}

#[test]
fn refuses_what_has_no_normals() {
    let text = |error: Error| error.to_string();
    assert_eq!(text(error_of::<3>(&[[0.0; 3]; 3])), "3 points are given; normals need at least 4");
    assert!(text(error_of::<3>(&[[1.0; 3]; 9])).contains("9 points lie at 1 different places"));
    assert!(text(error_of::<2>(&[[0.0; 2], [1.0; 2], [f64::NAN, 0.0]])).contains("point 2"));
    let line: Vec<Vec3> = (0..50).map(|i| [f64::from(i); 3]).collect();
    assert!(matches!(error_of(&line), Error::Degenerate(text) if text.contains("line")));
    let with = |options: NormalOptions| {
        Cloud::with_estimated_normals(circle(1.0, 50), &options, &mut Progress::silent()).unwrap_err()
    };
    assert!(text(with(NormalOptions { neighbours: 2, ..NormalOptions::default() })).contains("neighbours is 2"));
    assert!(text(with(NormalOptions { outlier_factor: f64::NAN, ..NormalOptions::default() })).contains("NaN"));
    assert!(matches!(
        with(NormalOptions { memory_limit: 1000, ..NormalOptions::default() }),
        Error::OutOfMemory { .. }
    ));
}

#[test]
fn a_listener_may_cancel_at_any_time() {
    for most in 0..5 {
        let mut calls = 0;
        let mut listen = |_: f64, _: &str| {
            calls += 1;
            if calls > most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let points = circle(1.0, 50);
        let result = Cloud::with_estimated_normals(points, &NormalOptions::default(), &mut Progress::new(&mut listen));
        assert!(matches!(result, Err(Error::Cancelled)));
    }
}
