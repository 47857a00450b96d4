//! Certificates of real shapes: nothing that is tried breaks them, and they are tight.
//!
//! `KEEPOUT_ATTACK` is how many random points are tried, 200,000 where it is not set; 10,000,000 take minutes.

mod common;

use keepout::field::{Certificate, CertifyOptions, Field, FitOptions, Outputs};
use keepout::geometry::Mesh;
use keepout::geometry::random::SplitMix64;
use keepout::progress::Progress;
use std::io::Write;
use std::time::Instant;

/// d and r, in D.
const CLEARANCE: f64 = 0.01;
const COVERING: f64 = 0.005;

/// t over the largest phi that the attack finds in the same set, at most; what the search found itself is no witness.
const TIGHT: f64 = 1.3;

/// Points of a batch.
const BATCH: usize = 20_000;

/// Points from which phi is climbed, and steps of each.
const CLIMBS: usize = 60;
const STEPS: usize = 400;

struct Attack<'a> {
    field: &'a Field,
    mesh: &'a Mesh,
    reach: f64,
    random: SplitMix64,
}

impl Attack<'_> {
    fn phi(&self, points: &[[f64; 3]]) -> Vec<f64> {
        let mut phi = vec![0.0; points.len()];
        self.field.eval(points, Outputs { values: Some(&mut phi), ..Outputs::default() }).unwrap();
        phi
    }

    /// Whether the points are inside or within reach of the shape.
    fn hold(&self, points: &[[f64; 3]]) -> Vec<bool> {
        let mut distances = vec![0.0; points.len()];
        self.mesh.distance_tree().unwrap().signed_distances(points, &mut distances).unwrap();
        distances.iter().map(|d| *d <= self.reach).collect()
    }

    /// `n` points within a cube of half edge `reach` around the shape's.
    fn near(&mut self, n: usize) -> Vec<[f64; 3]> {
        let n_facets = self.mesh.triangles().len() as f64;
        let points = (0..n).map(|_| {
            let corners = self.mesh.corners((n_facets * self.random.unit()) as usize);
            let mut w: [f64; 3] = std::array::from_fn(|_| self.random.unit());
            let sum: f64 = w.iter().sum();
            w = w.map(|w| w / sum);
            std::array::from_fn(|a| {
                let on = (0..3).map(|k| w[k] * corners[k][a]).sum::<f64>();
                on + self.reach * self.random.between(-1.0, 1.0)
            })
        });
        points.collect()
    }

    /// The largest phi of `n` points near the shape and of climbs from the best of them.
    fn largest(&mut self, n: usize) -> f64 {
        let mut best: Vec<(f64, [f64; 3])> = Vec::new();
        for _ in 0..n.div_ceil(BATCH) {
            let points = self.near(BATCH);
            let phi = self.phi(&points);
            let least = if best.len() < CLIMBS { f64::NEG_INFINITY } else { best[best.len() - 1].0 };
            let high: Vec<(f64, [f64; 3])> = phi.into_iter().zip(points).filter(|(phi, _)| *phi > least).collect();
            let held = self.hold(&high.iter().map(|(_, p)| *p).collect::<Vec<_>>());
            best.extend(high.into_iter().zip(held).filter(|(_, held)| *held).map(|(point, _)| point));
            best.sort_by(|x, y| y.0.total_cmp(&x.0));
            best.truncate(CLIMBS);
        }
        best.into_iter().map(|(phi, p)| self.climb(p, phi)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn climb(&mut self, mut p: [f64; 3], mut best: f64) -> f64 {
        let mut step = 0.3 * self.reach;
        for _ in 0..STEPS {
            let q = std::array::from_fn(|a| p[a] + step * self.random.between(-1.0, 1.0));
            let phi = self.phi(&[q])[0];
            if phi > best && self.hold(&[q])[0] {
                (p, best, step) = (q, phi, 1.5 * step);
            } else {
                step *= 0.95;
            }
        }
        best
    }
}

/// Certifies a fit of `file` and tries to break what is certified.
fn certified(file: &str, options: &FitOptions) {
    let Some(dir) = common::data_dir() else { return };
    let mesh = Mesh::<3>::read(dir.join(file)).unwrap();
    let field = Field::fit(&mesh.sample(25_000, 1).unwrap(), options, &mut Progress::silent()).unwrap();
    let d = field.diagonal();
    mesh.distance_tree().unwrap();
    let start = Instant::now();
    let certify = CertifyOptions::default();
    let Certificate { threshold, largest_found, surface_error, steepest, n_boxes, is_side_certified, .. } =
        field.certify(&mesh, CLEARANCE * d, COVERING * d, &certify, &mut Progress::silent()).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    assert!(is_side_certified);

    let n = std::env::var("KEEPOUT_ATTACK").map_or(200_000, |n| n.parse().expect("KEEPOUT_ATTACK is a number"));
    let mut attack =
        Attack { field: &field, mesh: &mesh, reach: (CLEARANCE + COVERING) * d, random: SplitMix64::new(3) };
    let largest = attack.largest(n);
    let surface = attack.phi(mesh.sample(100_000, 7).unwrap().points());
    let (t, found) = (threshold / d, largest_found / d);
    let _ = writeln!(
        std::io::stderr(),
        "{file}, {} unknowns: t = {t:.6} D, found = {found:.6} D, attack = {:.6} D, ratio = {:.4}, eps = {:.6} D, G = {steepest:.3}, \
         boxes = {n_boxes}, seconds = {seconds:.2}",
        field.report().n_unknowns,
        largest / d,
        threshold / largest,
        surface_error / d,
    );
    assert!(largest < threshold, "phi is {largest} where it is certified to be below {threshold}");
    assert!(threshold < TIGHT * largest, "{threshold} is certified, {largest} the largest that was met");
    assert!(surface.iter().all(|phi| phi.abs() <= surface_error));
}

#[test]
fn the_bunny() {
    certified("stanford/bunny_lsdo_genie.stl", &FitOptions { control_points: [32, 31, 25], ..FitOptions::default() });
}

#[test]
fn a_mechanical_part() {
    certified("mechanical/joint.off", &FitOptions::default());
}

#[test]
fn a_refined_bunny() {
    certified(
        "stanford/bunny_lsdo_genie.stl",
        &FitOptions { max_error: 2e-3, tolerance: 1e-3, ..FitOptions::default() },
    );
}
