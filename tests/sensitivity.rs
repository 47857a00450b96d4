//! Derivatives by the cloud agree with central differences of refits, to 1e-6.

use keepout::field::sensitivity::{Derivatives, Functional, Sensitivity};
use keepout::field::{Feasible, Field, FitOptions, Outputs, Reweighting};
use keepout::geometry::Cloud;
use keepout::geometry::random::SplitMix64;
use keepout::geometry::shapes::{box_mesh, circle, sphere, torus};
use keepout::geometry::vec::{add, dot, norm, normalized, scale};
use keepout::progress::Progress;

struct Case<const D: usize> {
    name: &'static str,
    cloud: Cloud<D>,
    options: FitOptions,
    field: Field<D>,
    points: Vec<[f64; D]>,
    weights: Vec<f64>,
}

fn options(n: u32) -> FitOptions {
    FitOptions { control_points: [n; 3], tolerance: 1e-12, n_threads: 1, max_iterations: 100_000, ..FitOptions::default() }
}

impl<const D: usize> Case<D> {
    fn new(name: &'static str, cloud: Cloud<D>, options: FitOptions) -> Self {
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
        Case { name, cloud, options, field, points, weights }
    }

    fn j(&self, field: &Field<D>) -> f64 {
        let mut values = vec![0.0; self.points.len()];
        field.eval(&self.points, Outputs { values: Some(&mut values), ..Outputs::default() }).unwrap();
        values.iter().zip(&self.weights).map(|(v, w)| v * w).sum()
    }

    fn derivatives(&self) -> [Vec<[f64; D]>; 2] {
        let mut ready = Sensitivity::new(&self.field, &self.cloud, &self.options, &mut Progress::silent()).unwrap();
        let room = || vec![[f64::NAN; D]; self.cloud.len()];
        let (mut points, mut normals) = (room(), room());
        let to = Derivatives { points: Some(&mut points), normals: Some(&mut normals) };
        let j = Functional { points: &self.points, weights: Some(&self.weights) };
        ready.solve(j, None, to, &mut Progress::silent()).unwrap();
        [points, normals]
    }

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

    fn refitted(&self, moved: &Cloud<D>) -> Field<D> {
        let options = FitOptions {
            max_error: 0.0,
            tolerance: std::env::var("TOL").ok().map_or(1e-12, |t| t.parse().unwrap()),
            reweighting: Reweighting::Kept,
            ..self.options.clone()
        };
        self.field.refit(moved, &options, &mut Progress::silent()).unwrap()
    }

    fn scan(&self) {
        let [by_points, by_normals] = self.derivatives();
        let n = self.cloud.len();
        println!("## {} levels {} unknowns {}", self.name, self.field.report().n_levels, self.field.report().n_unknowns);
        for (what, [pm, nm]) in [("points", [1.0, 0.0]), ("normals", [0.0, 1.0])] {
            for seed in 1..3 {
                let mut random = SplitMix64::new(seed);
                let mut vectors = |size: f64| -> Vec<[f64; D]> {
                    (0..n).map(|_| std::array::from_fn(|_| size * random.between(-1.0, 1.0))).collect()
                };
                let (points, normals) = (vectors(pm), vectors(nm));
                let sum = |x: &[[f64; D]], y: &[[f64; D]]| -> f64 { x.iter().zip(y).map(|(x, y)| dot(*x, *y)).sum() };
                let d = self.field.diagonal();
                let adj = d * sum(&by_points, &points) + sum(&by_normals, &normals);
                let size = ((d * d * sum(&by_points, &by_points)) * pm + sum(&by_normals, &by_normals) * nm).sqrt() / 3f64.sqrt();
                print!("{what} {seed}: {adj:.4e} of {size:.3e}:");
                let at = |h: f64| self.j(&self.refitted(&self.moved([&points, &normals], h)));
                let mut last = None;
                for h in [4e-6f64, 1.6e-5, 6.4e-5, 2.56e-4, 1.024e-3, 4.096e-3] {
                    let slope = (at(h) - at(-h)) / (2.0 * h);
                    let rich = last.map_or(f64::NAN, |l: f64| (16.0 * l - slope) / 15.0);
                    print!("  {:.0e} {:.1e}/{:.1e}", h, (slope - adj).abs() / size, (rich - adj).abs() / size);
                    last = Some(slope);
                }
                println!();
            }
        }
    }
}

#[test]
fn scan() {
    Case::new("circle", circle([0.5, -0.2], 2.0, 200).unwrap().sample(300, 1).unwrap(), options(20)).scan();
    Case::new("circle without distances", circle([0.5, -0.2], 2.0, 200).unwrap().sample(300, 1).unwrap(), FitOptions { distance_weight: 0.0, ..options(20) }).scan();
    let round = circle([0.5, -0.2], 2.0, 200).unwrap().sample(600, 1).unwrap();
    Case::new("circle refined", round, FitOptions { max_error: 2e-5, ..options(9) }).scan();
    let angle = |i: i32| std::f64::consts::TAU * (f64::from(i) + 0.5) / 200.0;
    let points: Vec<[f64; 2]> = (0..200).map(|i| [angle(i), 0.3 * angle(i).sin()]).collect();
    let normals = (0..200).map(|i| normalized([-0.3 * angle(i).cos(), 1.0]).unwrap()).collect();
    Case::new("wave", Cloud::new(points, normals).unwrap(), FitOptions { margin: 0.02, ..options(16) }).scan();
    Case::new("sphere", sphere([0.3, 0.2, -0.1], 1.0, 3).unwrap().sample(800, 1).unwrap(), options(11)).scan();
    let mut cloud = torus(30.0, 12.0, 40, 20).unwrap().sample(900, 1).unwrap();
    let mut random = SplitMix64::new(9);
    cloud.set_weights((0..900).map(|i| if i % 7 == 0 { 0.0 } else { random.between(0.2, 3.0) }).collect()).unwrap();
    Case::new("torus", cloud, FitOptions { feasible: Feasible::Inside, ..options(12) }).scan();
    let sampled = box_mesh([0.0; 3], [1.0, 1.5, 2.0]).unwrap().sample(900, 1).unwrap();
    let mut points = sampled.points().to_vec();
    for i in (0..900).step_by(30) {
        points[i] = add(points[i], scale(0.2, sampled.normals()[i]));
    }
    let cloud = Cloud::new(points, sampled.normals().to_vec()).unwrap();
    Case::new("robust box", cloud, FitOptions { reweighting: Reweighting::Robust, ..options(10) }).scan();
    let cube = box_mesh([0.0; 3], [1.0, 1.5, 2.0]).unwrap().sample(1200, 1).unwrap();
    Case::new("refined box", cube, FitOptions { max_error: 4e-3, ..options(8) }).scan();
    let _ = norm([0.0; 3]);
}
