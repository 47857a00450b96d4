//! Derivatives agree with central differences of fits to clouds that moved: what they are derivatives of.

use super::form::{Form, OneGrid};
use super::*;
use crate::field::Reweighting;
use crate::field::data::{Data, DataTerm};
use crate::field::refined::energy::RefinedEnergy;
use crate::field::refined::{self, Refined};
use crate::field::system::Diagonal;
use crate::field::{Feasible, Outputs};
use crate::geometry::random::SplitMix64;
use crate::geometry::shapes::{box_mesh, circle, sphere, torus};
use crate::geometry::vec::{add, dot, norm, normalized, scale, sub};
use crate::linalg::cg::{self, Stop};
use std::f64::consts::TAU;

mod calls;

/// Step of a difference of fourth order, in D. Where points move, what data hold but little moves more than they do: at ten times the
/// step truncation shows, and what solves leave is divided by it.
const STEP: f64 = 1e-5;

/// Residual of the solves that are compared, as low as rounding lets it be.
const SOLVED: f64 = 1e-13;

/// A fit to be differentiated, and what of it.
struct Case<const D: usize> {
    cloud: Cloud<D>,
    options: FitOptions,
    field: Field<D>,
    points: Vec<[f64; D]>,
    weights: Vec<f64>,
}

fn options(n: u32) -> FitOptions {
    FitOptions { control_points: [n; 3], tolerance: 1e-12, n_threads: 1, ..FitOptions::default() }
}

impl<const D: usize> Case<D> {
    /// J of random weights at random points in the box and around it.
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

    /// dJ/dp and dJ/dn.
    fn derivatives(&self) -> [Vec<[f64; D]>; 2] {
        let mut ready = Sensitivity::new(&self.field, &self.cloud, &self.options, &mut Progress::silent()).unwrap();
        let room = || vec![[f64::NAN; D]; self.cloud.len()];
        let (mut points, mut normals) = (room(), room());
        let to = Derivatives { points: Some(&mut points), normals: Some(&mut normals) };
        ready.solve(self.functional(), None, to, &mut Progress::silent()).unwrap();
        [points, normals]
    }

    fn functional(&self) -> Functional<'_, D> {
        Functional { points: &self.points, weights: Some(&self.weights) }
    }

    /// The cloud with its points `h` D of `by_points` further, and its normals turned by `h` of `by_normals`.
    fn moved(&self, [by_points, by_normals]: [&[[f64; D]]; 2], h: f64) -> Cloud<D> {
        let d = self.field.diagonal();
        let points = self.cloud.points().iter().zip(by_points).map(|(p, by)| add(*p, scale(h * d, *by))).collect();
        let normals = self.cloud.normals().iter().zip(by_normals).map(|(n, by)| add(*n, scale(h, *by))).collect();
        let mut moved = Cloud::new(points, normals).unwrap();
        if let Some(weights) = self.cloud.weights() {
            moved.set_weights(weights.to_vec()).unwrap();
        }
        moved
    }

    /// The minimum for `moved` with all held that a sensitivity holds.
    fn refitted(&self, moved: &Cloud<D>) -> Field<D> {
        let workers = Workers::caller_only();
        let without = |cloud: &Cloud<D>| cloud.counted().unwrap().unwrap_or_else(|| cloud.clone());
        let (before, moved) = (without(&self.cloud), without(moved));
        let field = &self.field;
        let (form, _) = Form::new(field, &before, &self.options, &workers, &mut Progress::silent()).unwrap();
        let unit = fit::in_units_of(field.grid(), field.diagonal());
        let places = |cloud: &Cloud<D>| -> Vec<[f64; D]> {
            let counts = |i: &usize| field.weighed.without_distances().binary_search(&(*i as u32)).is_err();
            let axes = &field.grid().axes;
            let place =
                |p: [f64; D]| std::array::from_fn(|a| (p[a] - axes[a].lower) / axes[a].cell * unit.axes[a].cell);
            (0..cloud.len()).filter(counts).map(|i| place(cloud.points()[i])).collect()
        };
        let (old, new) = (places(&before), places(&moved));
        // From the point that was nearest: where two are as near, distances have a kink, and no derivative there.
        let distance = |x: [f64; D]| {
            let square = |i: usize| dot(sub(old[i], x), sub(old[i], x));
            let nearest = (1..old.len()).fold(0, |n, i| if square(i) < square(n) { i } else { n });
            norm(sub(new[nearest], x))
        };
        let mut data = Data::new(&moved, field.grid()).unwrap();
        field.weighed.weigh(&mut data);
        match form {
            Form::OneGrid(form) => self.on_one_grid(*form, data, distance),
            Form::Leaves(form) => self.on_leaves(&form, data, distance),
        }
    }

    fn on_one_grid(&self, form: OneGrid<D>, data: Data<D>, distance: impl Fn([f64; D]) -> f64) -> Field<D> {
        let (workers, sign) = (Workers::caller_only(), self.options.feasible.sign());
        let mut terms = form.terms;
        let data = DataTerm::new(data, self.options.normal_weight);
        let grid = *terms.view.grid();
        terms.view = data.view(grid, [1; D]).unwrap();
        let mut b = vec![0.0; grid.n_control()];
        data.add_right_hand_side(&terms.view, &workers, sign, &mut b);
        if let Some(held) = &mut terms.distance {
            held.hold_instead(&grid, distance);
            held.add_right_hand_side(&workers, sign, &mut b);
        }
        let mut x = self.field.coefficients().to_vec();
        x.iter_mut().for_each(|x| *x /= self.field.diagonal());
        let mut x = solve(&mut Diagonal::of(&data, &mut terms, &workers).unwrap(), &b, x);
        x.iter_mut().for_each(|x| *x *= self.field.diagonal());
        Field::new(*self.field.grid(), x, self.options.feasible, self.field.diagonal(), *self.field.report())
    }

    fn on_leaves(&self, form: &RefinedEnergy<D>, data: Data<D>, distance: impl Fn([f64; D]) -> f64) -> Field<D> {
        let (workers, d) = (Workers::caller_only(), self.field.diagonal());
        let tree = || form.tree().try_clone().unwrap();
        let space = refined::fit::functions(&tree(), data.xi.len(), u64::MAX).unwrap();
        let holding = refined::fit::holding(&self.options);
        let mut energy =
            RefinedEnergy::new((tree(), space), data, self.options.weights(), holding, &workers, || Ok(())).unwrap();
        energy.hold_as(form, distance);
        energy.renew_preconditioner(&workers);
        let b = energy.right_hand_side(&workers, self.options.feasible.sign()).unwrap();
        let start = vec![0.0; b.len()];
        let mut x = solve(&mut energy, &b, start);
        x.iter_mut().for_each(|x| *x *= d);
        let active = energy.space().active(&x).collect();
        let refined = Refined::new(tree().on(*self.field.grid()), energy.space(), active).unwrap();
        Field::of_refined(refined, self.options.feasible, d, *self.field.report())
    }

    /// Compares along moves of all points and normals, of all points alone, of all normals alone, and of one point; `refit` gives the field
    /// of a moved cloud. Of points for which `moves` is false none is moved.
    fn check(&self, moves: impl Fn(usize) -> bool, refit: impl Fn(&Cloud<D>) -> Field<D>) {
        let [by_points, by_normals] = self.derivatives();
        let n = self.cloud.len();
        for (i, normal) in by_normals.iter().enumerate() {
            assert!(dot(*normal, self.cloud.normals()[i]).abs() <= 1e-12 * norm(*normal));
        }
        let one = (n / 3..n).find(|i| moves(*i)).unwrap();
        // What solves leave is more beside what one point does.
        let cases = [
            (1, [1.0, 1.0], None, 1e-6),
            (2, [1.0, 0.0], None, 1e-6),
            (3, [0.0, 1.0], None, 1e-6),
            (4, [10.0, 0.0], Some(one), 1e-4),
        ];
        for (seed, [points_move, normals_move], only, tolerance) in cases {
            let mut random = SplitMix64::new(seed);
            let mut vectors = |size: f64| -> Vec<[f64; D]> {
                let mut all: Vec<[f64; D]> =
                    (0..n).map(|_| std::array::from_fn(|_| size * random.between(-1.0, 1.0))).collect();
                let stays = |i: &usize| !moves(*i) || only.is_some_and(|one| one != *i);
                (0..n).filter(stays).for_each(|i| all[i] = [0.0; D]);
                all
            };
            let (points, normals) = (vectors(points_move), vectors(normals_move));
            let sum = |x: &[[f64; D]], y: &[[f64; D]]| -> f64 { x.iter().zip(y).map(|(x, y)| dot(*x, *y)).sum() };
            let by_adjoint = self.field.diagonal() * sum(&by_points, &points) + sum(&by_normals, &normals);
            let at = |h: f64| self.j(&refit(&self.moved([&points, &normals], h)));
            let slope = |h: f64| (at(h) - at(-h)) / (2.0 * h);
            let by_difference = (4.0 * slope(STEP) - slope(2.0 * STEP)) / 3.0;
            let relative = (by_adjoint - by_difference).abs() / by_difference.abs();
            println!("seed {seed}: {by_adjoint:e}, relative error {relative:.1e}");
            assert!(
                relative < tolerance,
                "seed {seed}: {by_adjoint:e} {by_difference:e}, relative error {relative:.1e}"
            );
        }
    }

    fn check_with_all_held(&self) {
        self.check(|i| self.stays_on_its_level(i), |moved| self.refitted(moved));
    }

    /// Whether point `i` is away from faces of cells, where refined fields may change their level, and weights with it.
    fn stays_on_its_level(&self, i: usize) -> bool {
        let finest = f64::from(1u32 << (self.field.report().n_levels - 1));
        let (p, axes) = (self.cloud.points()[i], self.field.grid().axes);
        let from_face = |a: usize| {
            let x = (p[a] - axes[a].lower) / axes[a].cell * finest;
            (x - x.round()).abs()
        };
        finest == 1.0 || (0..D).all(|a| from_face(a) > 0.01)
    }
}

fn solve(system: &mut impl cg::System, b: &[f64], x: Vec<f64>) -> Vec<f64> {
    let stop = Stop { tolerance: SOLVED, max_iterations: 100_000, patience: None };
    cg::solve(system, b, x, stop, &Workers::caller_only(), |_, _| Ok(())).unwrap().0
}

#[test]
fn a_sphere_with_distances_held_and_reweighting() {
    let case = Case::new(sphere([0.3, 0.2, -0.1], 1.0, 3).unwrap().sample(800, 1).unwrap(), options(11));
    assert!(case.field.weighed != Default::default());
    case.check_with_all_held();
}

#[test]
fn a_torus_inside_with_weights_of_the_callers() {
    let mut cloud = torus(30.0, 12.0, 40, 20).unwrap().sample(900, 1).unwrap();
    let mut random = SplitMix64::new(9);
    cloud.set_weights((0..900).map(|i| if i % 7 == 0 { 0.0 } else { random.between(0.2, 3.0) }).collect()).unwrap();
    let case = Case::new(cloud, FitOptions { feasible: Feasible::Inside, ..options(12) });
    let [by_points, by_normals] = case.derivatives();
    assert!((0..900).all(|i| (i % 7 == 0) == (by_points[i] == [0.0; 3] && by_normals[i] == [0.0; 3])));
    case.check_with_all_held();
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
    assert!(case.field.report().n_outliers >= 20 && !case.field.weighed.without_distances().is_empty());
    case.check_with_all_held();
}

#[test]
fn a_circle_in_the_plane() {
    Case::new(circle([0.5, -0.2], 2.0, 200).unwrap().sample(300, 1).unwrap(), options(20)).check_with_all_held();
}

#[test]
fn an_open_curve_that_reaches_the_box_with_points_beyond() {
    // A wave: as much of the box lies above it as below.
    let angle = |i: i32| TAU * (f64::from(i) + 0.5) / 200.0;
    let points: Vec<[f64; 2]> = (0..200).map(|i| [angle(i), 0.3 * angle(i).sin()]).collect();
    let normals = (0..200).map(|i| normalized([-0.3 * angle(i).cos(), 1.0]).unwrap()).collect();
    let case = Case::new(Cloud::new(points, normals).unwrap(), FitOptions { margin: 0.02, ..options(16) });
    assert_eq!(case.field.beyond().sign, None);
    case.check_with_all_held();
}

#[test]
fn refined_fields() {
    let round = circle([0.5, -0.2], 2.0, 200).unwrap().sample(600, 1).unwrap();
    let case = Case::new(round, FitOptions { max_error: 2e-5, ..options(9) });
    assert!(case.field.report().n_levels > 1);
    case.check_with_all_held();
    let cube = box_mesh([0.0; 3], [1.0, 1.5, 2.0]).unwrap().sample(1200, 1).unwrap();
    let case = Case::new(cube, FitOptions { max_error: 4e-3, ..options(8) });
    assert!(case.field.report().n_levels > 1);
    case.check_with_all_held();
}

/// Without distances, and with D held by points that stay, nothing is held that a refit with the same weights of points does not hold.
#[test]
fn refits_that_anyone_can_ask_for() {
    fn check<const D: usize>(cloud: Cloud<D>, max_error: f64, n: u32) {
        let options = FitOptions { max_error, distance_weight: 0.0, ..options(n) };
        let case = Case::new(cloud, options.clone());
        let bounds = case.cloud.bounds();
        let margin = 0.05 * case.field.diagonal();
        let inner = |i: usize| {
            let p = case.cloud.points()[i];
            let inner = (0..D).all(|a| (bounds.min[a] + margin..bounds.max[a] - margin).contains(&p[a]));
            inner && case.stays_on_its_level(i)
        };
        let as_it_is = FitOptions { max_error: 0.0, tolerance: SOLVED, reweighting: Reweighting::Kept, ..options };
        case.check(inner, |moved| case.field.refit(moved, &as_it_is, &mut Progress::silent()).unwrap());
    }
    check(sphere([0.0; 3], 1.0, 3).unwrap().sample(800, 1).unwrap(), 0.0, 10);
    check(circle([0.0; 2], 1.0, 100).unwrap().sample(300, 1).unwrap(), 0.0, 16);
    check(sphere([0.0; 3], 1.0, 3).unwrap().sample(900, 1).unwrap(), 3e-4, 8);
}
