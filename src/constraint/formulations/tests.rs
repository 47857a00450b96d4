use super::*;
use crate::field::Feasible;
use crate::geometry::random::SplitMix64;
use crate::geometry::shapes::{circle, sphere, torus};
use crate::geometry::vec::{norm, normalized};

const ALL: [Formulation; 5] = [
    Formulation::HickenKaurLinear,
    Formulation::HickenKaurQuadratic,
    Formulation::Lin,
    Formulation::NearestPlane,
    Formulation::NearestPoint,
];

fn of(formulation: Formulation) -> ExplicitOptions {
    ExplicitOptions { formulation, ..Default::default() }
}

/// Points of a ball of this radius, with its normals: even, by the golden angle.
fn ball(n: usize, radius: f64) -> Cloud<3> {
    let direction = |i: usize| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / n as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), 2.399_963_229_728_653 * i as f64);
        [r * angle.cos(), r * angle.sin(), z]
    };
    let normals: Vec<[f64; 3]> = (0..n).filter_map(|i| normalized(direction(i))).collect();
    Cloud::new(normals.iter().map(|n| scale(radius, *n)).collect(), normals).unwrap()
}

fn values<const D: usize>(cloud: &Cloud<D>, options: &ExplicitOptions, points: &[[f64; D]]) -> Vec<f64> {
    let mut values = vec![0.0; points.len()];
    Explicit::new(cloud, options).unwrap().eval(points, Some(&mut values), None).unwrap();
    values
}

/// RMS of the differences from |x| - 1 at points so far from the unit ball.
fn error_on_ball(n: usize, options: &ExplicitOptions, away: f64) -> f64 {
    let mut random = SplitMix64::new(5);
    let mut points = Vec::new();
    while points.len() < 500 {
        points.extend(normalized(std::array::from_fn(|_| random.between(-1.0, 1.0))).map(|n| scale(1.0 + away, n)));
    }
    let errors = values(&ball(n, 1.0), options, &points).into_iter().map(|v| (v - away) * (v - away));
    (errors.sum::<f64>() / points.len() as f64).sqrt()
}

#[test]
fn planes_are_exact() {
    let mut random = SplitMix64::new(1);
    let normal = [0.6, 0.0, 0.8];
    let points: Vec<[f64; 3]> = (0..203)
        .map(|_| [random.between(-1.0, 1.0), random.between(-1.0, 1.0)])
        .map(|[u, v]| [0.8 * u + 0.3 * 0.6, v, -0.6 * u + 0.3 * 0.8])
        .collect();
    let cloud = Cloud::new(points, vec![normal; 203]).unwrap();
    let x: Vec<[f64; 3]> = (0..50).map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect();
    for formulation in &ALL[..4] {
        for nearest in [0, 1, 7, 64] {
            if *formulation == Formulation::NearestPlane && nearest > 1 {
                continue;
            }
            let explicit = Explicit::new(&cloud, &ExplicitOptions { nearest, ..of(*formulation) }).unwrap();
            let (mut values, mut gradients) = (vec![0.0; 50], vec![[0.0; 3]; 50]);
            explicit.eval(&x, Some(&mut values), Some(&mut gradients)).unwrap();
            for ((x, v), g) in x.iter().zip(values).zip(gradients) {
                let exact = 0.6 * x[0] + 0.8 * x[2] - 0.3;
                assert!((v - exact).abs() < 1e-14, "{formulation:?} {nearest}: {v} {exact}");
                assert!((0..3).all(|a| (g[a] - normal[a]).abs() < 1e-11), "{formulation:?} {nearest}: {g:?}");
            }
        }
    }
}

#[test]
fn errors_on_a_ball_fall_as_the_papers_say() {
    for away in [0.0, 0.02, -0.02] {
        let error = |formulation, n| error_on_ball(n, &of(formulation), away);
        let [linear, finer] = [1000, 4000].map(|n| error(Formulation::HickenKaurLinear, n));
        // The planes' error is the spacing squared: 1 / N.
        assert!(linear < 6e-3 && (3.0..5.5).contains(&(linear / finer)), "{away}: {linear} {finer}");
        let quadratic = error(Formulation::HickenKaurQuadratic, 1000);
        assert!(quadratic < 0.05 * linear, "{away}: {quadratic} for {linear}");
        let lin = error(Formulation::Lin, 1000);
        assert!(lin < 0.1, "{away}: {lin}");
    }
}

#[test]
fn a_large_smoothing_is_the_nearest_plane() {
    let cloud = torus(1.0, 0.3, 60, 30).unwrap().sample(800, 3).unwrap();
    let mut random = SplitMix64::new(2);
    let x: Vec<[f64; 3]> = (0..300).map(|_| std::array::from_fn(|_| random.between(-1.3, 1.3))).collect();
    let nearest = values(&cloud, &of(Formulation::NearestPlane), &x);
    let sharp = values(&cloud, &ExplicitOptions { smoothing: 1e9, ..of(Formulation::HickenKaurLinear) }, &x);
    for ((x, a), b) in x.iter().zip(nearest).zip(sharp) {
        assert!((a - b).abs() < 1e-12, "{x:?}: {a} {b}");
    }
    // The smallest smoothing: weights between exp(-0.6 / D) and 1, D above 3.5, so nearly the mean of all planes.
    let blunt =
        values(&cloud, &ExplicitOptions { smoothing: 1.0, ..of(Formulation::HickenKaurLinear) }, &[[0.0; 3]])[0];
    let planes = cloud.points().iter().zip(cloud.normals()).map(|(p, n)| -(0..3).map(|a| n[a] * p[a]).sum::<f64>());
    let mean = planes.sum::<f64>() / cloud.len() as f64;
    let nearest = values(&cloud, &of(Formulation::NearestPlane), &[[0.0; 3]])[0];
    assert!((blunt - mean).abs() < 0.1 && (nearest - mean).abs() > 0.9, "{blunt} {mean} {nearest}");
}

#[test]
fn all_points_are_the_nearest_where_there_are_no_more() {
    let cloud = ball(61, 1.0);
    let mut random = SplitMix64::new(3);
    let x: Vec<[f64; 3]> = (0..200).map(|_| std::array::from_fn(|_| random.between(-2.0, 2.0))).collect();
    for formulation in &ALL[..3] {
        let all = values(&cloud, &of(*formulation), &x);
        let nearest = values(&cloud, &ExplicitOptions { nearest: 64, ..of(*formulation) }, &x);
        let few = values(&cloud, &ExplicitOptions { nearest: 3, ..of(*formulation) }, &x);
        for ((a, b), c) in all.iter().zip(nearest).zip(few) {
            assert!((a - b).abs() < 1e-13, "{formulation:?}: {a} {b}");
            assert!(c.is_finite() && (a - c).abs() > 0.0);
        }
    }
}

/// Gradients against central differences, but where a step crosses a jump.
fn check_gradients<const D: usize>(cloud: &Cloud<D>, options: &ExplicitOptions, unit: f64) {
    let explicit = Explicit::new(cloud, options).unwrap();
    let at = |x: [f64; D]| {
        let (mut v, mut g) = ([0.0], [[0.0; D]]);
        explicit.eval(&[x], Some(&mut v), Some(&mut g)).unwrap();
        (v[0], g[0])
    };
    let mut random = SplitMix64::new(6);
    let h = 1e-6 * unit;
    let mut jumps = 0;
    for _ in 0..200 {
        let x: [f64; D] = std::array::from_fn(|_| unit * random.between(-1.5, 1.5));
        let (value, gradient) = at(x);
        for a in 0..D {
            let moved = |by: f64| {
                let mut to = x;
                to[a] += by;
                at(to).0
            };
            let (up, down) = (moved(h), moved(-h));
            if (up + down - 2.0 * value).abs() > 1e-8 * unit {
                jumps += 1;
                continue;
            }
            let difference = (up - down) / (2.0 * h);
            assert!((gradient[a] - difference).abs() < 2e-6, "{options:?} {x:?}: {} {difference}", gradient[a]);
        }
    }
    assert!(jumps < 5, "{options:?}: {jumps}");
}

#[test]
fn gradients_are_those_of_differences() {
    // In units from the smallest to the largest that are served, nearly.
    for unit in [1.0, 1e-80, 1e80] {
        let space = ball(150, unit);
        let plane = circle([0.0; 2], 1.0, 100).unwrap().sample(60, 1).unwrap();
        let points = plane.points().iter().map(|p| scale(unit, *p)).collect();
        let plane = Cloud::new(points, plane.normals().to_vec()).unwrap();
        for formulation in ALL {
            for nearest in [0, 1, 10] {
                for exponent in [3, 4] {
                    let options = ExplicitOptions { nearest, exponent, softening: 0.1, ..of(formulation) };
                    if formulation == Formulation::NearestPlane && nearest > 1 {
                        continue;
                    }
                    check_gradients(&space, &options, unit);
                    check_gradients(&plane, &options, unit);
                }
            }
        }
    }
}

#[test]
fn points_of_the_cloud_and_far_ones_are_served() {
    let cloud = ball(100, 1.0);
    for formulation in ALL {
        let explicit = Explicit::new(&cloud, &of(formulation)).unwrap();
        let x = [cloud.points()[17], [1e12, 1e12, -1e12], [0.0; 3]];
        let (mut v, mut g) = ([0.0; 3], [[0.0; 3]; 3]);
        explicit.eval(&x, Some(&mut v), Some(&mut g)).unwrap();
        assert!(v.iter().chain(g.as_flattened()).all(|x| x.is_finite()), "{formulation:?}: {v:?} {g:?}");
        assert!(v[0].abs() < 0.2 && v[2] < 0.0, "{formulation:?}: {v:?}");
        // Far away all points count alike in Lin's mean, which has no sign to be relied on there.
        assert!(v[1] > 0.0 || formulation == Formulation::Lin, "{formulation:?}: {v:?}");
    }
    let nearest = ExplicitOptions { nearest: 2, ..of(Formulation::NearestPoint) };
    let pair = Cloud::new(vec![[0.0, 0.0], [0.0, 2.0]], vec![[1.0, 0.0]; 2]).unwrap();
    assert_eq!(values(&pair, &nearest, &[[1.0, 1.0], [-1.0, 1.0]]), [2f64.sqrt(), -(2f64.sqrt())]);
}

#[test]
fn batches_and_outputs_do_not_matter() {
    let cloud = sphere([0.1; 3], 0.7, 3).unwrap().sample(333, 1).unwrap();
    let mut random = SplitMix64::new(8);
    let x: Vec<[f64; 3]> = (0..40).map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect();
    for formulation in ALL {
        for nearest in [0, 1] {
            let explicit = Explicit::new(&cloud, &ExplicitOptions { nearest, ..of(formulation) }).unwrap();
            let (mut v, mut alone, mut g, mut g_alone) = ([0.0; 40], [0.0; 40], [[0.0; 3]; 40], [[0.0; 3]; 40]);
            explicit.eval(&x, Some(&mut v), Some(&mut g)).unwrap();
            for i in 0..40 {
                explicit.eval(&x[i..=i], Some(&mut alone[i..=i]), None).unwrap();
                explicit.eval(&x[i..=i], None, Some(&mut g_alone[i..=i])).unwrap();
            }
            assert_eq!((v, g), (alone, g_alone), "{formulation:?}");
            let inside = ExplicitOptions { nearest, feasible: Feasible::Inside, ..of(formulation) };
            let mirrored = v.map(|v| -v).to_vec();
            assert_eq!(values(&cloud, &inside, &x), mirrored);
        }
    }
}

#[test]
fn weights_say_which_points_count() {
    let mut cloud = ball(100, 1.0);
    let x = [[0.4, -0.5, 1.1]];
    let mut twice =
        Cloud::new([cloud.points(), &[[5.0; 3]]].concat(), [cloud.normals(), &[[1.0; 3]]].concat()).unwrap();
    twice.set_weights([vec![2.0; 100], vec![0.0]].concat()).unwrap();
    let expected = values(&cloud, &of(Formulation::HickenKaurQuadratic), &x);
    assert_eq!(values(&twice, &of(Formulation::HickenKaurQuadratic), &x), expected);
    cloud.set_weights(vec![3.0; 100]).unwrap();
    assert_eq!(values(&cloud, &of(Formulation::HickenKaurQuadratic), &x), expected);
    assert!(norm(x[0]) > 1.0 && expected[0] > 0.0);
}

#[test]
fn bad_arguments_are_refused() {
    let cloud = ball(50, 1.0);
    let text = |options: ExplicitOptions| Explicit::new(&cloud, &options).unwrap_err().to_string();
    assert!(text(ExplicitOptions { nearest: 65, ..Default::default() }).contains("n_nearest is 65"));
    assert!(text(ExplicitOptions { nearest: 2, ..of(Formulation::NearestPlane) }).contains("n_nearest is 2"));
    assert!(text(ExplicitOptions { smoothing: 0.5, ..Default::default() }).contains("smoothing is 0.5"));
    assert!(text(ExplicitOptions { smoothing: f64::NAN, ..Default::default() }).contains("smoothing is NaN"));
    assert!(text(ExplicitOptions { exponent: 0, ..Default::default() }).contains("exponent is 0"));
    assert!(text(ExplicitOptions { softening: 0.0, ..Default::default() }).contains("softening is 0"));
    let speck = Cloud::new(vec![[1.0; 3]; 2], vec![[1.0, 0.0, 0.0]; 2]).unwrap();
    assert!(matches!(Explicit::new(&speck, &ExplicitOptions::default()), Err(Error::Degenerate(_))));
    let explicit = Explicit::new(&cloud, &ExplicitOptions::default()).unwrap();
    let text = |x: [f64; 3]| explicit.eval(&[[0.0; 3], x], Some(&mut [0.0; 2]), None).unwrap_err().to_string();
    assert!(text([0.0, f64::NAN, 0.0]).contains("point 1"));
    assert!(text([1e14, 0.0, 0.0]).contains("point 1 is (100000000000000, 0, 0)"));
    assert!(explicit.eval(&[[0.0; 3]], Some(&mut []), None).unwrap_err().to_string().contains("values has room for 0"));
}
