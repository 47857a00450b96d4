//! Properties of fitted fields: what they minimise, what leaves them unchanged, and that they are smooth everywhere.

use super::*;
use crate::geometry::random::SplitMix64;
use crate::geometry::shapes::{box_mesh, scattered, sphere, torus};
use crate::geometry::vec::{Vec3, add, dot, norm, scale, sub};
use crate::geometry::{Cloud, Mesh};
use crate::progress::Progress;
use crate::{Error, Result};
use std::ops::ControlFlow;

fn options() -> FitOptions {
    FitOptions { control_points: [12, 11, 10], n_threads: 1, tolerance: 1e-8, ..FitOptions::default() }
}

fn fit(cloud: &Cloud, options: &FitOptions) -> Field {
    Field::fit(cloud, options, &mut Progress::silent()).unwrap()
}

fn ring() -> Cloud {
    let sampled = torus(1.0, 0.4, 60, 30).unwrap().sample(1500, 1).unwrap();
    // Made from arrays, as the clouds that are compared with it.
    Cloud::new(sampled.points().to_vec(), sampled.normals().to_vec()).unwrap()
}

fn values(field: &Field, points: &[Vec3]) -> Vec<f64> {
    let mut values = vec![0.0; points.len()];
    field.eval(points, Outputs { values: Some(&mut values), ..Outputs::default() }).unwrap();
    values
}

fn jet(field: &Field, p: Vec3) -> (f64, Vec3, [f64; 6]) {
    let (mut v, mut g, mut h) = ([0.0], [[0.0; 3]], [0.0; 6]);
    let outputs = Outputs { values: Some(&mut v), gradients: Some(&mut g), hessians: Some(&mut h) };
    field.eval(&[p], outputs).unwrap();
    (v[0], g[0], h)
}

/// Points in the box stretched by `factor` about its centre.
fn points_around(field: &Field, factor: f64, n: usize) -> Vec<Vec3> {
    let mut random = SplitMix64::new(7);
    let axes = field.grid().axes;
    let point = |random: &mut SplitMix64| -> Vec3 {
        std::array::from_fn(|a| {
            let (middle, half) = (0.5 * (axes[a].lower + axes[a].upper()), 0.5 * (axes[a].upper() - axes[a].lower));
            middle + factor * half * random.between(-1.0, 1.0)
        })
    };
    (0..n).map(|_| point(&mut random)).collect()
}

/// Derivatives agree with central differences of values and gradients, within `tolerance` of the field's curvature.
fn check_derivatives(field: &Field, points: &[Vec3]) {
    let e = 1e-6 * field.diagonal();
    for &p in points {
        let (_, gradient, hessian) = jet(field, p);
        for a in 0..3 {
            let step: Vec3 = std::array::from_fn(|b| if a == b { e } else { 0.0 });
            let (above, below) = (jet(field, add(p, step)), jet(field, sub(p, step)));
            let slope = (above.0 - below.0) / (2.0 * e);
            assert!(
                (gradient[a] - slope).abs() < 1e-7 * (1.0 + norm(gradient)),
                "d/d{a} at {p:?}: {gradient:?} {slope}"
            );
            let column: Vec3 = std::array::from_fn(|b| (above.1[b] - below.1[b]) / (2.0 * e));
            for b in 0..3 {
                let packed = [[0, 1, 2], [1, 3, 4], [2, 4, 5]][a][b];
                // The third derivative jumps at knots and faces: the difference quotient is off by it times e / 2 there.
                let third = 1e-2 * hessian.iter().fold(1.0, |m: f64, h| m.max(h.abs()));
                assert!((hessian[packed] - column[b]).abs() < third, "d2/d{a}d{b} at {p:?}");
            }
        }
    }
}

/// The paper's energy (10) of a field, by its definition: sums over the cloud and Gauss quadrature over the box.
fn energy(field: &Field, cloud: &Cloud, options: &FitOptions) -> f64 {
    // Four points are exact to degree 7, one more than the squares have along an axis.
    const GAUSS: [(f64, f64); 4] = [
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ];
    let d = field.diagonal();
    let n = cloud.len() as f64;
    let data: f64 = cloud
        .points()
        .iter()
        .zip(cloud.normals())
        .map(|(p, normal)| {
            let (value, gradient, _) = jet(field, *p);
            let miss = sub(gradient, scale(options.feasible.sign(), *normal));
            (value / d).powi(2) + options.normal_weight * dot(miss, miss)
        })
        .sum();
    let axes = field.grid().axes;
    let n_cells: usize = axes.iter().map(|a| a.n_cells).product();
    let mut curvature = 0.0;
    for c in 0..n_cells {
        let cell =
            [c / (axes[1].n_cells * axes[2].n_cells), c / axes[2].n_cells % axes[1].n_cells, c % axes[2].n_cells];
        for q in 0..64 {
            let nodes = [GAUSS[q / 16], GAUSS[q / 4 % 4], GAUSS[q % 4]];
            let p = std::array::from_fn(|a| axes[a].lower + (cell[a] as f64 + nodes[a].0) * axes[a].cell);
            let h = jet(field, p).2;
            let square = h[0] * h[0] + h[3] * h[3] + h[5] * h[5] + 2.0 * (h[1] * h[1] + h[2] * h[2] + h[4] * h[4]);
            curvature += nodes.iter().map(|n| n.1).product::<f64>() * square * d * d;
        }
    }
    data / n + options.smooth_weight * curvature / n_cells as f64
}

#[test]
fn the_corners_of_a_box_are_not_outside_it() {
    let mut random = SplitMix64::new(11);
    let mut outside = [0; 3];
    for _ in 0..1000 {
        let lower = [0; 2].map(|_| random.between(-1e3, 1e3));
        let upper = lower.map(|x| x + random.between(1e-3, 20.0));
        let n = [0; 2].map(|_| 4 + (random.bits() % 60) as u32);
        let grid = domain::grid_of_box(&lower, &upper, &n).unwrap();
        let corners = [grid.axes.map(|a| a.lower), grid.axes.map(|a| a.upper())];
        let beyond = corners[1].map(f64::next_up);
        let field = Field::from_control_points(grid, vec![1.0; grid.n_control()], Feasible::Outside, 1.0).unwrap();
        field.outside_box(&[corners[0], corners[1], beyond], &mut outside).unwrap();
        assert_eq!(outside, [0, 0, 1], "{grid:?}");
    }
}

#[test]
fn without_departures_the_fit_is_the_minimum_of_the_papers_energy() {
    let cloud = ring();
    for feasible in [Feasible::Outside, Feasible::Inside] {
        let options = FitOptions {
            control_points: [6, 6, 5],
            distance_weight: 0.0,
            reweightings: 0,
            tolerance: 1e-13,
            // Heavy enough to weigh beside the data.
            smooth_weight: 1e-5,
            feasible,
            ..options()
        };
        let field = fit(&cloud, &options);
        let least = energy(&field, &cloud, &options);
        let mut random = SplitMix64::new(3);
        for _ in 0..20 {
            // A quadratic has its minimum halfway between points of equal height.
            let direction: Vec<f64> = field.coefficients.iter().map(|_| random.between(-1.0, 1.0)).collect();
            let moved = |step: f64| {
                let mut moved = field.clone();
                moved.coefficients.iter_mut().zip(&direction).for_each(|(c, d)| *c += step * d);
                energy(&moved, &cloud, &options)
            };
            let (up, down) = (moved(1e-2), moved(-1e-2));
            assert!(up > least && down > least);
            assert!((up - down).abs() < 1e-6 * (up - least), "{up} {down} {least}");
        }
    }
}

#[test]
fn a_power_of_two_scales_the_field_to_the_bit() {
    let cloud = ring();
    let field = fit(&cloud, &options());
    let points = points_around(&field, 1.5, 500);
    let phi = values(&field, &points);
    for factor in [1024.0, 1.0 / 1024.0] {
        let times = |v: &[Vec3]| v.iter().map(|p| scale(factor, *p)).collect::<Vec<_>>();
        let scaled = fit(&Cloud::new(times(cloud.points()), cloud.normals().to_vec()).unwrap(), &options());
        let expected: Vec<f64> = phi.iter().map(|v| v * factor).collect();
        assert!(values(&scaled, &times(&points)) == expected);
    }
}

#[test]
fn other_scales_and_translations_change_nothing_but_rounding() {
    let cloud = ring();
    let exact = FitOptions { tolerance: 1e-12, ..options() };
    let field = fit(&cloud, &exact);
    let points = points_around(&field, 1.2, 500);
    let phi = values(&field, &points);
    for (factor, shift) in [(1e3, [0.0; 3]), (1e-3, [0.0; 3]), (1.0, [3.0, -5.0, 7.0])] {
        let moved = |v: &[Vec3]| v.iter().map(|p| add(scale(factor, *p), shift)).collect::<Vec<_>>();
        let other = fit(&Cloud::new(moved(cloud.points()), cloud.normals().to_vec()).unwrap(), &exact);
        for (a, b) in phi.iter().zip(values(&other, &moved(&points))) {
            assert!((a / field.diagonal() - b / other.diagonal()).abs() < 1e-9, "{factor} {shift:?}: {a} {b}");
        }
    }
}

#[test]
fn a_quarter_turn_turns_the_field() {
    let turn = |v: &Vec3| [v[1], v[2], v[0]];
    let cloud = ring();
    let exact = FitOptions { tolerance: 1e-12, ..options() };
    let field = fit(&cloud, &exact);
    let points = points_around(&field, 1.2, 500);
    let [x, y, z] = exact.control_points;
    let turned_cloud =
        Cloud::new(cloud.points().iter().map(turn).collect(), cloud.normals().iter().map(turn).collect()).unwrap();
    let turned = fit(&turned_cloud, &FitOptions { control_points: [y, z, x], ..exact });
    let turned_points: Vec<Vec3> = points.iter().map(turn).collect();
    for (a, b) in values(&field, &points).iter().zip(values(&turned, &turned_points)) {
        assert!((a - b).abs() < 1e-9 * field.diagonal());
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let cloud = ring();
    let one = fit(&cloud, &options());
    let points = points_around(&one, 1.3, 10_000);
    for n_threads in [2, 3] {
        let many = fit(&cloud, &FitOptions { n_threads, ..options() });
        assert_eq!(one.coefficients, many.coefficients);
        let mut spread = vec![0.0; points.len()];
        let outputs = Outputs { values: Some(&mut spread), ..Outputs::default() };
        one.eval_parallel(&points, outputs, n_threads).unwrap();
        assert_eq!(values(&one, &points), spread);
    }
}

#[test]
fn inside_is_the_negative_of_outside() {
    let cloud = ring();
    let outside = fit(&cloud, &options());
    let inside = fit(&cloud, &FitOptions { feasible: Feasible::Inside, ..options() });
    let points = points_around(&outside, 2.0, 300);
    for (a, b) in values(&outside, &points).iter().zip(values(&inside, &points)) {
        assert!((a + b).abs() < 1e-12);
    }
    assert_eq!(outside.beyond().sign, Some(1.0));
    assert_eq!(inside.beyond().sign, Some(-1.0));
}

#[test]
fn derivatives_agree_with_differences_inside_outside_and_on_the_faces() {
    for feasible in [Feasible::Outside, Feasible::Inside] {
        let field = fit(&ring(), &FitOptions { feasible, ..options() });
        check_derivatives(&field, &points_around(&field, 1.0, 100));
        check_derivatives(&field, &points_around(&field, 1.6, 100));
        let on_faces: Vec<Vec3> = points_around(&field, 1.3, 60)
            .into_iter()
            .map(|p| std::array::from_fn(|a| p[a].clamp(field.grid().axes[a].lower, field.grid().axes[a].upper())))
            .collect();
        check_derivatives(&field, &on_faces);
    }
}

/// A flat square with normals up: phi changes sign on the faces of its box.
fn sheet() -> Cloud {
    let points: Vec<Vec3> = (0..400).map(|i| [f64::from(i % 20) / 19.0, f64::from(i / 20) / 19.0, 0.0]).collect();
    let normals = vec![[0.0, 0.0, 2.0]; points.len()];
    Cloud::new(points, normals).unwrap()
}

#[test]
fn a_planar_open_cloud_has_a_field_that_keeps_the_sides_beyond_its_box() {
    let field = fit(&sheet(), &options());
    assert_eq!(field.beyond().sign, None);
    for (x, y) in [(0.5, 0.5), (0.1, 0.8)] {
        for z in [0.02, 0.1, 1.0, 100.0] {
            let phi = values(&field, &[[x, y, z], [x, y, -z]]);
            assert!(phi[0] > 0.0 && phi[1] < 0.0, "{phi:?} at {z}");
        }
        assert!(values(&field, &[[x, y, 0.0]])[0].abs() < 1e-3);
    }
    check_derivatives(&field, &points_around(&field, 1.8, 100));
}

#[test]
fn points_without_a_value_are_refused_by_their_index() {
    let field = fit(&sheet(), &FitOptions { control_points: [4; 3], ..options() });
    for bad in [f64::NAN, f64::INFINITY, 1e308] {
        let mut points = vec![[0.5; 3]; 1000];
        points[700][1] = bad;
        let mut values = vec![0.0; 1000];
        let end = field.eval(&points, Outputs { values: Some(&mut values), ..Outputs::default() });
        assert!(matches!(end, Err(Error::InvalidArgument(text)) if text.contains("point 700 ")));
    }
}

#[test]
fn far_away_the_field_grows_with_slope_one() {
    for feasible in [Feasible::Outside, Feasible::Inside] {
        let field = fit(&ring(), &FitOptions { feasible, ..options() });
        for p in points_around(&field, 1.0, 50) {
            let direction = scale(1.0 / norm(p), p);
            let mut last = 0.0;
            for r in [2.0, 3.0, 5.0, 10.0, 1e3, 1e100, 1e140] {
                let (value, gradient, _) = jet(&field, scale(r, direction));
                let outward = feasible.sign() * value;
                assert!(outward > last && outward.is_finite());
                last = outward;
                assert!(feasible.sign() * dot(gradient, direction) > 0.5);
                if r >= 1e3 {
                    assert!((norm(gradient) - 1.0).abs() < 1e-2, "{r}: {gradient:?}");
                }
            }
        }
    }
}

#[test]
fn the_sign_is_right_away_from_the_surface_of_a_thin_plate() {
    let plate = box_mesh([-1.0, -0.6, -0.01], [1.0, 0.6, 0.01]).unwrap();
    let field = fit(&plate.sample(3000, 1).unwrap(), &FitOptions { tolerance: 1e-4, ..FitOptions::default() });
    let points = points_around(&field, 1.0, 5000);
    let mut exact = vec![0.0; points.len()];
    plate.distance_tree().unwrap().signed_distances(&points, &mut exact).unwrap();
    let cell = field.grid().longest_cell();
    for ((p, d), phi) in points.iter().zip(&exact).zip(values(&field, &points)) {
        assert!(d.abs() < cell || d * phi > 0.0, "{p:?}: phi = {phi}, distance {d}");
    }
}

#[test]
fn normals_into_a_cavity_make_its_inside_positive_and_its_outside_negative() {
    for mesh in [torus(1.0, 0.4, 60, 30).unwrap(), box_mesh([-1.0, -0.6, -0.02], [1.0, 0.6, 0.02]).unwrap()] {
        let cloud = mesh.sample(3000, 1).unwrap();
        let inward = cloud.normals().iter().map(|n| scale(-1.0, *n)).collect();
        let cavity = Cloud::new(cloud.points().to_vec(), inward).unwrap();
        for margin in [0.15, 1.0] {
            let field = fit(&cavity, &FitOptions { margin, ..FitOptions::default() });
            let points = points_around(&field, 1.0, 3000);
            let mut exact = vec![0.0; points.len()];
            mesh.distance_tree().unwrap().signed_distances(&points, &mut exact).unwrap();
            let cell = field.grid().longest_cell();
            for ((p, d), phi) in points.iter().zip(&exact).zip(values(&field, &points)) {
                assert!(d.abs() < cell || d * phi < 0.0, "{p:?}: phi = {phi}, distance {d}");
            }
        }
    }
}

#[test]
fn points_given_more_than_once_leave_the_sides_where_they_are() {
    let cloud = sphere([0.0; 3], 1.0, 4).unwrap().sample(2000, 1).unwrap();
    for copies in [2, 3, 6] {
        let many = Cloud::new(cloud.points().repeat(copies), cloud.normals().repeat(copies)).unwrap();
        let field = fit(&many, &options());
        for (r, d) in [(0.3, -0.7), (0.6, -0.4), (1.1, 0.1)] {
            let phi = values(&field, &[scale(r, [0.6, 0.0, 0.8])])[0];
            assert!((phi - d).abs() < 0.05, "{copies} copies: {phi} at distance {d}");
        }
    }
}

#[test]
fn a_sphere_is_met_closely_and_better_with_more_control_points() {
    let ball = sphere([0.0; 3], 1.0, 5).unwrap().sample(4000, 1).unwrap();
    let rms = |n: u32| fit(&ball, &FitOptions { control_points: [n; 3], ..options() }).report().rms;
    let (coarse, fine) = (rms(8), rms(16));
    assert!(coarse < 1e-4 && fine < 0.8 * coarse, "{coarse} {fine}");
}

#[test]
fn reweighting_lowers_the_largest_error() {
    let plate = box_mesh([-1.0, -0.6, -0.05], [1.0, 0.6, 0.05]).unwrap().sample(3000, 1).unwrap();
    let max = |reweightings: u32| fit(&plate, &FitOptions { reweightings, ..options() }).report().max;
    assert!(max(3) < 0.8 * max(0));
}

#[test]
fn saved_and_loaded_it_evaluates_to_the_same_bits() {
    let field = fit(&ring(), &options());
    let path = std::env::temp_dir().join(format!("keepout-field-{}.kof", std::process::id()));
    field.save(&path).unwrap();
    let loaded = Field::load(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let points = points_around(&field, 1.5, 500);
    assert_eq!(values(&field, &points), values(&loaded, &points));
    // How clear the sides were is not kept.
    assert!(
        loaded.report().clear_sides.is_nan()
            && loaded.report().convergence_rate.is_nan()
            && field.report().clear_sides == 1.0
    );
    assert_eq!(
        FitReport { clear_sides: 1.0, convergence_rate: field.report().convergence_rate, ..*loaded.report() },
        *field.report()
    );
    assert_eq!(field.feasible(), loaded.feasible());
}

#[test]
fn a_cancelled_fit_is_cancelled_at_whatever_call() {
    let cloud = ring();
    let mut calls = 0;
    let mut count = |_: f64, _: &str| {
        calls += 1;
        ControlFlow::Continue(())
    };
    Field::fit(&cloud, &options(), &mut Progress::new(&mut count)).unwrap();
    for stop_at in [1, 2, 3, calls / 2, calls] {
        let mut call = 0;
        let mut stop = |_: f64, _: &str| {
            call += 1;
            if call == stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let end = Field::fit(&cloud, &options(), &mut Progress::new(&mut stop));
        assert_eq!(end.unwrap_err(), Error::Cancelled);
    }
}

#[test]
fn what_cannot_be_fitted_is_refused_with_the_reason() {
    let refused = |cloud: &Cloud, options: FitOptions| -> Error {
        Field::fit(cloud, &options, &mut Progress::silent()).unwrap_err()
    };
    let one = Cloud::new(vec![[1.0; 3]], vec![[0.0, 0.0, 1.0]]).unwrap();
    assert!(matches!(refused(&one, options()), Error::Degenerate(_)));
    let same = Cloud::new(vec![[1.0; 3]; 9], vec![[0.0, 0.0, 1.0]; 9]).unwrap();
    assert!(matches!(refused(&same, options()), Error::Degenerate(_)));
    let huge = FitOptions { control_points: [u32::MAX; 3], ..options() };
    assert!(matches!(refused(&ring(), huge), Error::OutOfMemory { bytes, .. } if bytes > 1 << 90));
    let few = FitOptions { control_points: [3, 10, 10], ..options() };
    assert!(matches!(refused(&ring(), few), Error::InvalidArgument(text) if text.contains("at least 4")));
    let short = FitOptions { max_iterations: 5, ..options() };
    assert!(matches!(refused(&ring(), short), Error::NotConverged { iterations: 5, .. }));
    // In a round that is solved roughly: the tolerance is still the caller's.
    let short = FitOptions { max_iterations: 2, tolerance: 1e-4, reweightings: 3, ..options() };
    assert!(matches!(refused(&ring(), short), Error::NotConverged { tolerance: 1e-4, .. }));
    // The limit is on all rounds together, and so is the count in the error.
    let rounds = fit(&ring(), &FitOptions { tolerance: 1e-4, ..options() }).report().iterations;
    let short = FitOptions { max_iterations: rounds - 1, tolerance: 1e-4, ..options() };
    assert!(
        matches!(refused(&ring(), short), Error::NotConverged { iterations, .. } if iterations == rounds as usize - 1)
    );
    // Two points with opposite normals at one place each: no side is asked for.
    let undecided =
        Cloud::new(vec![[0.0; 3], [0.0; 3], [1.0; 3], [1.0; 3]], [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]].repeat(2))
            .unwrap();
    assert!(matches!(refused(&undecided, FitOptions { distance_weight: 0.0, ..options() }), Error::Degenerate(_)));
}

#[test]
fn the_smallest_grid_and_the_smallest_cloud_are_served() -> Result<()> {
    let two = Cloud::new(vec![[0.0; 3], [1.0, 0.5, 0.2]], vec![[0.0, 0.0, 1.0]; 2])?;
    let field = fit(&two, &FitOptions { control_points: [4; 3], ..FitOptions::default() });
    assert!(field.report().max < 1e-2);
    let cube: Mesh = box_mesh([0.0; 3], [1.0; 3])?;
    let field = fit(&cube.sample(500, 1)?, &FitOptions { control_points: [4, 5, 9], ..FitOptions::default() });
    assert_eq!(field.grid().shape(), [4, 5, 9]);
    Ok(())
}

#[test]
fn closed_shapes_keep_their_sign_beyond_the_box_even_where_the_fit_is_coarse() {
    let slab = box_mesh([0.0; 3], [1.0, 1.0, 0.4]).unwrap().sample(2000, 1).unwrap();
    for feasible in [Feasible::Outside, Feasible::Inside] {
        let field = fit(&slab, &FitOptions { feasible, ..FitOptions::default() });
        for p in points_around(&field, 1.0, 2000) {
            for a in 0..3 {
                for face in [field.grid().axes[a].lower - 1.5, field.grid().axes[a].upper() + 1.5] {
                    let mut beyond = p;
                    beyond[a] = face;
                    let phi = values(&field, &[beyond])[0];
                    assert!(feasible.sign() * phi > 0.5, "{phi} at {beyond:?}");
                }
            }
        }
    }
}

#[test]
fn random_points_leave_no_doubt_about_the_sides_of_closed_shapes() {
    let options = FitOptions { tolerance: 1e-2, ..options() };
    for cloud in [scattered::sphere(2000, 1), scattered::torus(0.7, 0.25, 4000, 1)] {
        let clear = fit(&cloud, &options).report().clear_sides;
        assert!(clear > 0.99, "{clear}");
    }
}

#[test]
fn refinement_begins_with_no_more_control_points_than_it_may_take() {
    let refined = |max_unknowns| {
        let chosen = FitOptions { control_points: [0; 3], tolerance: 1e-2, ..options() };
        *fit(&ring(), &FitOptions { max_error: 1e-3, max_unknowns, ..chosen }).report()
    };
    assert_eq!(refined(1).n_unknowns, 64, "four along each axis, as few as there can be");
    let report = refined(1000);
    assert!((200..=1000).contains(&report.n_unknowns), "{report:?}");
}
