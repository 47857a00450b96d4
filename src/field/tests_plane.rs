//! Fields of the plane: what is asked of those of space holds here too.

use super::*;
use crate::Result;
use crate::geometry::Cloud;
use crate::geometry::random::SplitMix64;
use crate::geometry::shapes::circle;
use crate::geometry::vec::{add, norm, scale, sub};
use crate::progress::Progress;
use std::f64::consts::TAU;

/// An ellipse of half axes 1 and 0.4, its normals outwards.
fn ellipse(n: usize) -> Cloud<2> {
    let angles = || (0..n).map(|i| (TAU * i as f64 / n as f64).sin_cos());
    let points = angles().map(|(s, c)| [c, 0.4 * s]).collect();
    let normals = angles().map(|(s, c)| [0.4 * c, s]).collect();
    Cloud::new(points, normals).unwrap()
}

fn fit(cloud: &Cloud<2>, options: &FitOptions) -> Field<2> {
    Field::fit(cloud, options, &mut Progress::silent()).unwrap()
}

fn jet(field: &Field<2>, p: [f64; 2]) -> (f64, [f64; 2], [f64; 3]) {
    let (mut v, mut g, mut h) = ([0.0], [[0.0; 2]], [0.0; 3]);
    let outputs = Outputs { values: Some(&mut v), gradients: Some(&mut g), hessians: Some(&mut h) };
    field.eval(&[p], outputs).unwrap();
    (v[0], g[0], h)
}

fn points_around(field: &Field<2>, factor: f64, n: usize) -> Vec<[f64; 2]> {
    let mut random = SplitMix64::new(7);
    let axes = field.grid().axes;
    let middle = axes.map(|a| 0.5 * (a.lower + a.upper()));
    let half = axes.map(|a| 0.5 * (a.upper() - a.lower));
    (0..n).map(|_| std::array::from_fn(|a| middle[a] + factor * half[a] * random.between(-1.0, 1.0))).collect()
}

#[test]
fn an_ellipse_is_met_and_has_its_sides() {
    for feasible in [Feasible::Outside, Feasible::Inside] {
        let field = fit(&ellipse(1000), &FitOptions { feasible, ..FitOptions::default() });
        let report = field.report();
        assert!(report.rms < 1e-4 && (report.mean_gradient - 1.0).abs() < 0.01, "{report:?}");
        assert_eq!((field.grid().shape().len(), report.control_points[2]), (2, 0));
        for p in points_around(&field, 1.5, 5000) {
            let inside = p[0] * p[0] + p[1] * p[1] / 0.16;
            let phi = feasible.sign() * jet(&field, p).0;
            assert!((inside - 1.0).abs() < 0.1 || (inside > 1.0) == (phi > 0.0), "{phi} at {p:?}");
        }
    }
}

#[test]
fn derivatives_agree_with_differences_inside_outside_and_on_the_faces() {
    let field = fit(&ellipse(400), &FitOptions { control_points: [20, 17, 99], ..FitOptions::default() });
    assert_eq!(field.grid().shape(), [20, 17]);
    let e = 1e-6 * field.diagonal();
    let mut points = points_around(&field, 1.6, 200);
    let onto_faces =
        |p: [f64; 2]| std::array::from_fn(|a| p[a].clamp(field.grid().axes[a].lower, field.grid().axes[a].upper()));
    points.extend(points_around(&field, 1.3, 60).into_iter().map(onto_faces));
    for p in points {
        let (_, gradient, hessian) = jet(&field, p);
        for a in 0..2 {
            let step = std::array::from_fn(|b| if a == b { e } else { 0.0 });
            let (above, below) = (jet(&field, add(p, step)), jet(&field, sub(p, step)));
            let slope = (above.0 - below.0) / (2.0 * e);
            assert!((gradient[a] - slope).abs() < 1e-7 * (1.0 + norm(gradient)), "d/d{a} at {p:?}");
            for b in 0..2 {
                let column = (above.1[b] - below.1[b]) / (2.0 * e);
                let third = 1e-2 * hessian.iter().fold(1.0, |m: f64, h| m.max(h.abs()));
                assert!((hessian[a + b] - column).abs() < third, "d2/d{a}d{b} at {p:?}");
            }
        }
    }
}

#[test]
fn a_refit_of_a_shape_that_moved_a_little_is_the_fit_and_takes_fewer_iterations() -> Result<()> {
    let options = FitOptions { tolerance: 1e-9, ..FitOptions::default() };
    let field = fit(&ellipse(500), &options);
    let moved = ellipse(500).points().iter().map(|p| add(*p, [1e-3, 0.0])).collect();
    let moved = Cloud::new(moved, ellipse(500).normals().to_vec())?;
    let again = field.refit(&moved, &options, &mut Progress::silent())?;
    assert_eq!(field.grid(), again.grid());
    let blank =
        Field::from_control_points(*field.grid(), vec![0.0; field.coefficients().len()], Feasible::Outside, 1.0)?;
    let anew = blank.refit(&moved, &options, &mut Progress::silent())?;
    for (a, b) in again.coefficients().iter().zip(anew.coefficients()) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
    let (few, many) = (again.report().iterations, anew.report().iterations);
    assert!(few < many, "{few} {many}");
    let outside = Cloud::new(vec![[0.0, 0.0], [9.0, 0.0]], vec![[1.0, 0.0]; 2])?;
    assert!(
        field.refit(&outside, &options, &mut Progress::silent()).unwrap_err().to_string().contains("point 1 is (9, 0)")
    );
    Ok(())
}

#[test]
fn points_of_weight_0_are_as_if_they_were_not_there() -> Result<()> {
    let cloud = ellipse(300);
    let points = [cloud.points(), &[[5.0, 5.0], [0.0, 0.1]]].concat();
    let normals = [cloud.normals(), &[[1.0, 0.0]; 2]].concat();
    let mut with_more = Cloud::new(points, normals)?;
    with_more.set_weights([vec![2.0; 300], vec![0.0; 2]].concat())?;
    let (one, other) = (fit(&cloud, &FitOptions::default()), fit(&with_more, &FitOptions::default()));
    assert_eq!(one.report().n_points, other.report().n_points);
    let worst = one.coefficients().iter().zip(other.coefficients()).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    // Shares are sums of weights here, 1 / N there.
    assert!(worst < 1e-10, "{worst}");
    for wrong in [vec![1.0; 3], vec![f64::NAN; 302], vec![-1.0; 302], vec![0.0; 302]] {
        assert!(with_more.set_weights(wrong).is_err());
    }
    Ok(())
}

#[test]
fn a_point_that_counts_for_more_is_met_more_closely() -> Result<()> {
    let cloud = ellipse(300);
    let beside = [1.05, 0.0];
    let mut with_one = Cloud::new([cloud.points(), &[beside]].concat(), [cloud.normals(), &[[1.0, 0.0]]].concat())?;
    let options = FitOptions { reweightings: 0, ..FitOptions::default() };
    let phi = |cloud: &Cloud<2>| jet(&fit(cloud, &options), beside).0.abs();
    let before = phi(&with_one);
    with_one.set_weights([vec![1.0; 300], vec![30.0]].concat())?;
    let after = phi(&with_one);
    assert!(after < 0.5 * before, "{after} {before}");
    Ok(())
}

#[test]
fn a_robust_fit_leaves_outliers_out_and_keeps_every_good_point() -> Result<()> {
    let cloud = ellipse(500);
    let mut random = SplitMix64::new(2);
    let mut points = cloud.points().to_vec();
    let mut normals = cloud.normals().to_vec();
    for _ in 0..50 {
        points.push([random.between(-1.1, 1.1), random.between(-0.5, 0.5)]);
        normals.push([random.between(-1.0, 1.0), random.between(-1.0, 1.0)]);
    }
    let robust = FitOptions { reweighting: Reweighting::Robust, ..FitOptions::default() };
    let field = fit(&Cloud::new(points, normals)?, &robust);
    let clean = fit(&cloud, &robust);
    let worst = |f: &Field<2>| cloud.points().iter().fold(0.0, |m: f64, p| m.max(jet(f, *p).0.abs()));
    assert!(worst(&field) < 2e-3 && worst(&clean) < 2e-3, "{} {}", worst(&field), worst(&clean));
    assert_eq!(clean.report().n_outliers, 0);
    assert!((35..=50).contains(&field.report().n_outliers), "{}", field.report().n_outliers);
    Ok(())
}

#[test]
fn a_power_of_two_scales_the_field_to_the_bit_and_threads_change_none() {
    let cloud = ellipse(500);
    let one = fit(&cloud, &FitOptions { n_threads: 1, ..FitOptions::default() });
    for factor in [1024.0, 1.0 / 1024.0] {
        let scaled = cloud.points().iter().map(|p| scale(factor, *p)).collect();
        let scaled = Cloud::new(scaled, cloud.normals().to_vec()).unwrap();
        let other = fit(&scaled, &FitOptions { n_threads: 3, ..FitOptions::default() });
        assert!(one.coefficients().iter().zip(other.coefficients()).all(|(a, b)| a * factor == *b));
    }
}

#[test]
fn a_straight_open_curve_has_a_box_and_hessians_want_whole_rooms() -> Result<()> {
    let points = (0..200).map(|i| [f64::from(i) / 199.0, 2.0]).collect();
    let field = fit(&Cloud::new(points, vec![[0.0, 1.0]; 200])?, &FitOptions::default());
    assert!(field.grid().axes[1].upper() - field.grid().axes[1].lower > 0.05);
    for len in [2, 4, 6] {
        let mut h = vec![0.0; len];
        assert!(field.eval(&[[0.5, 2.0]], Outputs { hessians: Some(&mut h), ..Outputs::default() }).is_err());
    }
    Ok(())
}

#[test]
fn files_tell_their_dimension() -> Result<()> {
    let field = fit(&ellipse(200), &FitOptions::default());
    let path = std::env::temp_dir().join(format!("keepout-plane-{}.kof", std::process::id()));
    field.save(&path)?;
    let (again, as_space) = (Field::<2>::load(&path)?, Field::<3>::load(&path));
    assert!(matches!(load(&path)?, crate::dimension::OfDimension::Plane(_)));
    std::fs::remove_file(&path).unwrap();
    let report = FitReport { clear_sides: 1.0, convergence_rate: field.report().convergence_rate, ..*again.report() };
    assert!(field.coefficients() == again.coefficients() && *field.report() == report);
    assert!(as_space.unwrap_err().to_string().contains("dimension 2; 3 is asked for"));
    Ok(())
}

#[test]
fn a_robust_fit_without_rounds_is_as_smooth_as_asked_for() {
    let cloud = circle([0.0, 0.0], 1.0, 200).unwrap().sample(200, 1).unwrap();
    let rms = |reweighting| {
        let options = FitOptions { reweighting, reweightings: 0, ..FitOptions::default() };
        Field::fit(&cloud, &options, &mut Progress::silent()).unwrap().report().rms
    };
    assert!(rms(Reweighting::Robust) < 2.0 * rms(Reweighting::Largest));
}

#[test]
fn a_cloud_that_the_cells_cannot_resolve_is_refused() {
    let cloud = |r: f64| circle([0.0, 0.0], r, 100).unwrap().sample(100, 1).unwrap();
    let fit = |c| Field::fit(&c, &FitOptions::default(), &mut Progress::silent());
    let field = fit(cloud(1.0)).unwrap();
    let refit = |r| field.refit(&cloud(r), &FitOptions::default(), &mut Progress::silent());
    assert!(refit(1e-3).is_ok());
    assert!(refit(1e-6).unwrap_err().to_string().contains("cannot resolve"));
    // The square of the diagonal is 0, the diagonal is not.
    assert!(matches!(fit(cloud(1e-200)), Err(Error::InvalidArgument(_))));
}

#[test]
fn a_lattice_of_which_nothing_is_wanted_costs_nothing() {
    let cloud = circle([0.0, 0.0], 1.0, 100).unwrap().sample(100, 1).unwrap();
    let field = Field::fit(&cloud, &FitOptions::default(), &mut Progress::silent()).unwrap();
    let lattice = Lattice::new([0.0; 2], &[[1e-12, 0.0], [0.0, 1e-12]], &[1 << 28, 1 << 28]).unwrap();
    field.eval_lattice(&lattice, None, None, 1, &mut Progress::silent()).unwrap();
}

/// Checks the signs of a field fitted to `points` with their normals, at 0.02 D before and behind those of `probes`.
fn has_both_sides_at<const D: usize>(points: Vec<([f64; D], [f64; D])>, probes: &[([f64; D], [f64; D])]) {
    let (points, normals) = points.into_iter().unzip();
    let cloud = Cloud::new(points, normals).unwrap();
    let field = Field::fit(&cloud, &FitOptions::default(), &mut Progress::silent()).unwrap();
    for (p, n) in probes {
        for off in [-0.02, 0.02].map(|off| off * field.diagonal()) {
            let mut phi = [0.0];
            field.eval(&[add(*p, scale(off, *n))], Outputs { values: Some(&mut phi), ..Outputs::default() }).unwrap();
            assert!((phi[0] / off - 1.0).abs() < 0.2, "{} at {off} from {p:?}", phi[0]);
        }
    }
}

#[test]
fn open_curves_have_both_sides() {
    let up = |x: f64| ([x, 0.0], [0.0, 1.0]);
    // An angle of 90 degrees, normals to its inner side or its outer one.
    let bent = |x: f64, s: f64| if x < 0.5 { ([2.0 * x, 0.0], [0.0, s]) } else { ([1.0, 2.0 * x - 1.0], [-s, 0.0]) };
    let arc = |x: f64, s: f64| ([(3.0 * x).cos(), (3.0 * x).sin()], [s * (3.0 * x).cos(), s * (3.0 * x).sin()]);
    for n in [50, 200, 1000] {
        let all = || (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n));
        has_both_sides_at(all().map(up).collect(), &[0.2, 0.5, 0.8].map(up));
        for s in [1.0, -1.0] {
            has_both_sides_at(all().map(|x| bent(x, s)).collect(), &[0.1, 0.3, 0.7, 0.9].map(|x| bent(x, s)));
            has_both_sides_at(all().map(|x| arc(x, s)).collect(), &[0.1, 0.5, 0.9].map(|x| arc(x, s)));
        }
    }
}

#[test]
fn open_sheets_have_both_sides() {
    for n in [30, 70] {
        let at = |i: i32, n: i32| (f64::from(i) + 0.5) / f64::from(n);
        let sheet = |n: i32| (0..n * n).map(move |i| ([at(i % n, n), at(i / n, n), 0.0], [0.0, 0.0, 1.0]));
        has_both_sides_at(sheet(n).collect(), &sheet(5).collect::<Vec<_>>());
        let ball = crate::geometry::shapes::sphere([0.0; 3], 1.0, 4).unwrap().sample(2 * (n * n) as usize, 1).unwrap();
        for s in [1.0, -1.0] {
            let above = |z: f64| ball.points().iter().filter(move |p| p[2] > z).map(move |p| (*p, scale(s, *p)));
            has_both_sides_at(above(0.0).collect(), &above(0.2).take(50).collect::<Vec<_>>());
        }
    }
}

#[test]
fn parts_within_parts_and_cavities_keep_their_sides() {
    let parts = [([0.0, 0.0], 1.0), ([0.0, 0.0], 0.5), ([3.0, 0.0], 1.0)].map(|(c, r)| circle(c, r, 400).unwrap());
    let [outer, inner, beside] = parts.map(|m| m.sample(400, 1).unwrap());
    let fit_to = |parts: &[(&Cloud<2>, f64)]| {
        let points = parts.iter().flat_map(|(c, _)| c.points().to_vec()).collect();
        let normals = parts.iter().flat_map(|(c, s)| c.normals().iter().map(|n| scale(*s, *n)).collect::<Vec<_>>());
        fit(&Cloud::new(points, normals.collect()).unwrap(), &FitOptions::default())
    };
    let far = [[1.5, 0.9], [0.75, 0.0], [0.0, 0.0], [3.0, 0.0]];
    // A ring and a disk beside it; a cavity with a pillar and another cavity.
    for (signs, side) in [([1.0, -1.0, 1.0], 1.0), ([-1.0, 1.0, -1.0], -1.0)] {
        let field = fit_to(&[(&outer, signs[0]), (&inner, signs[1]), (&beside, signs[2])]);
        for (p, right) in far.iter().zip([1.0, -1.0, 1.0, -1.0]) {
            let phi = jet(&field, *p).0;
            assert!(phi * right * side > 0.1, "{phi} at {p:?}");
        }
        assert_eq!(field.report().clear_sides, 1.0);
    }
}

#[test]
fn a_straight_curve_beside_a_closed_one_has_both_sides() {
    let disk = circle([0.0, 0.0], 1.0, 400).unwrap().sample(400, 1).unwrap();
    let wall = |y: f64| ([2.0, y], [1.0, 0.0]);
    let mut points: Vec<_> = disk.points().iter().copied().zip(disk.normals().iter().copied()).collect();
    points.extend((0..200).map(|i| wall(0.01 * f64::from(i) - 1.0)));
    has_both_sides_at(points, &[-0.7, 0.0, 0.7].map(wall));
}
