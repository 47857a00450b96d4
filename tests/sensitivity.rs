//! Derivatives by the cloud agree with differences of refits: those that anyone can ask for, with KO_REWEIGHT_KEEP, solved to 1e-12.
//!
//! Moves are random, each coordinate apart from all others. What data hold but little follows them far: already 1e-4 D is a long way for
//! second differences, and central ones alone, of which the error falls as the square of the step, do not reach 1e-6 above the rounding of
//! the solves. So three of them, with steps h, 2 h and 4 h, are extrapolated to sixth order (Romberg). Normals, on which phi depends
//! linearly but for their length, bear steps a hundred times as long. Errors are fractions of |dJ| |move| / sqrt(n), n the coordinates that
//! move: the size that a derivative along a random move has. Along each it may be smaller, by chance.

use keepout::field::sensitivity::{Derivatives, Functional, Sensitivity};
use keepout::field::{Feasible, Field, FitOptions, Outputs, Reweighting};
use keepout::geometry::Cloud;
use keepout::geometry::random::SplitMix64;
use keepout::geometry::shapes::{box_mesh, circle, sphere, torus};
use keepout::geometry::vec::{add, dot, norm, normalized, scale};
use keepout::progress::Progress;
use std::f64::consts::TAU;

/// h of moves of points, in D, and of normals.
const OF_POINTS: f64 = 2e-5;
const OF_NORMALS: f64 = 2e-3;

const BAR: f64 = 1e-6;

/// A field to be differentiated, and J of random weights at random points in the box and around it.
struct Case<const D: usize> {
    cloud: Cloud<D>,
    options: FitOptions,
    field: Field<D>,
    points: Vec<[f64; D]>,
    weights: Vec<f64>,
}

/// A vector for each point, and for each normal.
type Moves<const D: usize> = [Vec<[f64; D]>; 2];

fn options(n: u32) -> FitOptions {
    FitOptions {
        control_points: [n; 3],
        tolerance: 1e-12,
        max_iterations: 100_000,
        n_threads: 1,
        ..FitOptions::default()
    }
}

impl<const D: usize> Case<D> {
    fn new(cloud: Cloud<D>, options: FitOptions) -> Self {
        let field = Field::fit(&cloud, &options, &mut Progress::silent()).unwrap();
        let mut random = SplitMix64::new(5);
        let axes = field.grid().axes;
        let points = (0..12).map(|i| {
            let factor = if i % 3 == 0 { 1.6 } else { 1.0 };
            std::array::from_fn(|a| {
                let (low, high) = (axes[a].lower, axes[a].upper());
                0.5 * (low + high) + 0.5 * factor * (high - low) * random.between(-1.0, 1.0)
            })
        });
        let points = points.collect();
        let weights = (0..12).map(|_| random.between(-1.0, 2.0)).collect();
        Case { cloud, options, field, points, weights }
    }

    fn j(&self, field: &Field<D>) -> f64 {
        let mut values = vec![0.0; self.points.len()];
        field.eval(&self.points, Outputs { values: Some(&mut values), ..Outputs::default() }).unwrap();
        values.iter().zip(&self.weights).map(|(v, w)| v * w).sum()
    }

    /// dJ by points, in units of D, and by normals.
    fn derivatives(&self) -> Moves<D> {
        let mut ready = Sensitivity::new(&self.field, &self.cloud, &self.options, &mut Progress::silent()).unwrap();
        let room = || vec![[f64::NAN; D]; self.cloud.len()];
        let (mut points, mut normals) = (room(), room());
        let to = Derivatives { points: Some(&mut points), normals: Some(&mut normals) };
        let j = Functional { points: &self.points, weights: Some(&self.weights) };
        ready.solve(j, None, to, &mut Progress::silent()).unwrap();
        points.iter_mut().for_each(|v| *v = scale(self.field.diagonal(), *v));
        [points, normals]
    }

    /// J of the refit to the cloud with its points `h` D of their moves further, and its normals turned by `h` of theirs.
    fn j_moved(&self, [points, normals]: &Moves<D>, h: f64) -> f64 {
        let d = self.field.diagonal();
        let points = self.cloud.points().iter().zip(points).map(|(p, by)| add(*p, scale(h * d, *by))).collect();
        let normals = self.cloud.normals().iter().zip(normals).map(|(n, by)| add(*n, scale(h, *by))).collect();
        let mut moved = Cloud::new(points, normals).unwrap();
        if let Some(weights) = self.cloud.weights() {
            moved.set_weights(weights.to_vec()).unwrap();
        }
        let options = FitOptions { max_error: 0.0, reweighting: Reweighting::Kept, ..self.options.clone() };
        self.j(&self.field.refit(&moved, &options, &mut Progress::silent()).unwrap())
    }

    fn central(&self, moves: &Moves<D>, h: f64) -> f64 {
        (self.j_moved(moves, h) - self.j_moved(moves, -h)) / (2.0 * h)
    }

    /// Random moves within [-1, 1]^D, of points where the first of `which` is 1, of normals where the second is; none of a point near to
    /// another level.
    fn moves(&self, seed: u64, which: [f64; 2]) -> Moves<D> {
        let mut random = SplitMix64::new(seed);
        which.map(|size| {
            let mut vector = || std::array::from_fn(|_| size * random.between(-1.0, 1.0));
            let moves = self.cloud.points().iter().map(|p| (self.stays_on_its_level(p), vector()));
            moves.map(|(moves, v)| if moves { v } else { [0.0; D] }).collect()
        })
    }

    /// Whether a point is away from faces of cells, where refined fields may change their level, and weights with it.
    fn stays_on_its_level(&self, p: &[f64; D]) -> bool {
        let (finest, axes) = (f64::from(1u32 << (self.field.report().n_levels - 1)), self.field.grid().axes);
        let from_face = |a: usize| {
            let x = (p[a] - axes[a].lower) / axes[a].cell * finest;
            (x - x.round()).abs()
        };
        finest == 1.0 || (0..D).all(|a| from_face(a) > 0.01)
    }

    fn check(&self, name: &str) {
        let by = self.derivatives();
        for (normal, derivative) in self.cloud.normals().iter().zip(&by[1]) {
            assert!(dot(*normal, *derivative).abs() <= 1e-12 * norm(*derivative));
        }
        for (which, h) in [([1.0, 0.0], OF_POINTS), ([0.0, 1.0], OF_NORMALS)] {
            for seed in 1..=2 {
                let moves = self.moves(seed, which);
                let sum = |x: &Moves<D>, y: &Moves<D>| -> f64 {
                    x.iter().flatten().zip(y.iter().flatten()).map(|(x, y)| dot(*x, *y)).sum()
                };
                let moving = by.iter().zip(&which).map(|(by, w)| by.iter().map(|v| w * dot(*v, *v)).sum::<f64>());
                let n = (D * self.cloud.len()) as f64;
                let size = (moving.sum::<f64>() * sum(&moves, &moves) / n).sqrt();
                let [narrow, middle, wide] = [h, 2.0 * h, 4.0 * h].map(|h| self.central(&moves, h));
                let [fourth, rough] = [(4.0 * narrow - middle) / 3.0, (4.0 * middle - wide) / 3.0];
                let (by_difference, by_adjoint) = ((16.0 * fourth - rough) / 15.0, sum(&by, &moves));
                let error = |d: f64| (d - by_adjoint).abs() / size;
                println!(
                    "{name}, {which:?}, seed {seed}: dJ {by_adjoint:.3e} of {size:.3e}, error {:.1e}",
                    error(by_difference)
                );
                assert!(
                    error(by_difference) < BAR,
                    "{name} {which:?} {seed}: {by_difference:e} {by_adjoint:e} of {size:e}"
                );
            }
        }
    }
}

#[test]
fn a_circle() {
    let cloud = circle([0.5, -0.2], 2.0, 200).unwrap().sample(300, 1).unwrap();
    Case::new(cloud.clone(), options(20)).check("circle");
    Case::new(cloud.clone(), FitOptions { distance_weight: 0.0, ..options(20) }).check("circle without distances");
    Case::new(cloud, FitOptions { reweightings: 0, ..options(20) }).check("circle without reweighting");
}

/// Central differences approach the derivative as the square of their step, so it is that.
#[test]
fn errors_of_central_differences_fall_as_the_square_of_the_step() {
    let cloud = circle([0.5, -0.2], 2.0, 200).unwrap().sample(300, 1).unwrap();
    let case = Case::new(cloud, options(20));
    let (by, moves) = (case.derivatives(), case.moves(2, [1.0, 0.0]));
    let by_adjoint: f64 = by[0].iter().zip(&moves[0]).map(|(x, y)| dot(*x, *y)).sum();
    let errors = [8e-5, 4e-5, 2e-5].map(|h| (case.central(&moves, h) - by_adjoint).abs());
    for pair in errors.windows(2) {
        let factor = pair[0] / pair[1];
        assert!((3.9..4.1).contains(&factor), "{errors:?}");
    }
}

#[test]
fn an_open_curve_that_reaches_the_box_with_points_beyond() {
    // A wave: as much of the box lies above it as below.
    let angle = |i: i32| TAU * (f64::from(i) + 0.5) / 200.0;
    let points: Vec<[f64; 2]> = (0..200).map(|i| [angle(i), 0.3 * angle(i).sin()]).collect();
    let normals = (0..200).map(|i| normalized([-0.3 * angle(i).cos(), 1.0]).unwrap()).collect();
    let case = Case::new(Cloud::new(points, normals).unwrap(), FitOptions { margin: 0.02, ..options(16) });
    assert_eq!(case.field.beyond().sign, None);
    case.check("wave");
}

#[test]
fn a_sphere_and_a_torus_inside_with_weights_of_the_callers() {
    let cloud = sphere([0.3, 0.2, -0.1], 1.0, 3).unwrap().sample(800, 1).unwrap();
    Case::new(cloud, options(11)).check("sphere");
    let mut cloud = torus(30.0, 12.0, 40, 20).unwrap().sample(900, 1).unwrap();
    let mut random = SplitMix64::new(9);
    cloud.set_weights((0..900).map(|i| if i % 7 == 0 { 0.0 } else { random.between(0.2, 3.0) }).collect()).unwrap();
    let case = Case::new(cloud, FitOptions { feasible: Feasible::Inside, ..options(12) });
    let [by_points, by_normals] = case.derivatives();
    assert!((0..900).all(|i| (i % 7 == 0) == (by_points[i] == [0.0; 3] && by_normals[i] == [0.0; 3])));
    case.check("torus");
}

#[test]
fn a_box_with_outliers_fitted_robustly() {
    let sampled = box_mesh([0.0; 3], [1.0, 1.5, 2.0]).unwrap().sample(900, 1).unwrap();
    let mut points = sampled.points().to_vec();
    for i in (0..900).step_by(30) {
        points[i] = add(points[i], scale(0.2, sampled.normals()[i]));
    }
    let cloud = Cloud::new(points, sampled.normals().to_vec()).unwrap();
    let case = Case::new(cloud, FitOptions { reweighting: Reweighting::Robust, ..options(10) });
    assert!(case.field.report().n_outliers >= 20);
    case.check("robust box");
}

#[test]
fn refined_fields() {
    let round = circle([0.5, -0.2], 2.0, 200).unwrap().sample(600, 1).unwrap();
    let case = Case::new(round, FitOptions { max_error: 2e-5, ..options(9) });
    assert!(case.field.report().n_levels > 1);
    case.check("refined circle");
    // Of shapes with edges solves to 1e-12 take minutes.
    let ball = sphere([0.0; 3], 1.0, 3).unwrap().sample(900, 1).unwrap();
    let case = Case::new(ball, FitOptions { max_error: 1e-3, ..options(8) });
    assert!(case.field.report().n_levels > 1);
    case.check("refined ball");
}
