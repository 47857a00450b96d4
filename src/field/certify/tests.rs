//! Thresholds are sound, whatever is tried to break them, and tight; they do not depend on threads.

use super::*;
use crate::field::FitOptions;
use crate::geometry::random::SplitMix64;
use crate::geometry::shapes::{TOLD_WRONG_IN_SHELLS, box_mesh, circle, rectangle, shells, sphere, torus};
use crate::geometry::vec::{norm, sub};
use crate::spline::{Axis, Grid};
use std::ops::ControlFlow;

fn fit<const D: usize>(mesh: &Mesh<D>, options: &FitOptions) -> Field<D> {
    let n = if D == 2 { 600 } else { 4000 };
    Field::fit(&mesh.sample(n, 1).unwrap(), options, &mut Progress::silent()).unwrap()
}

fn certify<const D: usize>(field: &Field<D>, mesh: &Mesh<D>, reach: f64) -> Certificate<D> {
    field.certify(mesh, reach, 0.0, &CertifyOptions::default(), &mut Progress::silent()).unwrap()
}

/// The set of a certificate, told by exact distances, and attempts to find phi above t in it.
struct Attack<'a, const D: usize> {
    field: &'a Field<D>,
    mesh: &'a Mesh<D>,
    reach: f64,
    is_side_certified: bool,
    random: SplitMix64,
}

impl<const D: usize> Attack<'_, D> {
    fn holds(&self, p: [f64; D]) -> bool {
        let mut distance = [0.0];
        self.mesh.distance_tree().unwrap().signed_distances(&[p], &mut distance).unwrap();
        let infeasible = distance[0] * self.field.feasible().sign() <= 0.0;
        distance[0].abs() <= self.reach || (self.is_side_certified && infeasible)
    }

    /// A point near the shape or, every third, anywhere around it.
    fn place(&mut self, i: usize) -> [f64; D] {
        let bounds = self.mesh.bounds();
        if i.is_multiple_of(3) {
            let wide = if i.is_multiple_of(2) { 3.0 } else { 0.7 };
            return std::array::from_fn(|a| {
                bounds.center()[a] + (bounds.extents()[a] * wide + self.reach) * self.random.between(-1.0, 1.0)
            });
        }
        let f = (self.mesh.facets().len() as f64 * self.random.unit()) as usize;
        let corners = self.mesh.corners(f);
        let weights: [f64; D] = std::array::from_fn(|_| self.random.unit());
        let sum: f64 = weights.iter().sum();
        std::array::from_fn(|a| {
            (0..D).map(|k| weights[k] / sum * corners[k][a]).sum::<f64>() + self.reach * self.random.between(-1.0, 1.0)
        })
    }

    /// Climbs from `p`: steps of random directions that stay in the set and gain.
    fn climb(&mut self, mut p: [f64; D], n_steps: usize) -> f64 {
        let (mut best, mut step) = (value(self.field, p), self.reach.max(1e-3 * self.field.diagonal()));
        for _ in 0..n_steps {
            let q = std::array::from_fn(|a| p[a] + step * self.random.between(-1.0, 1.0));
            let phi = value(self.field, q);
            if phi > best && self.holds(q) {
                (p, best) = (q, phi);
                step *= 1.5;
            } else {
                step *= 0.93;
            }
        }
        best
    }

    /// The largest phi in the set of `n` random points, and of the climbs from the best of them.
    fn largest(&mut self, n: usize) -> f64 {
        let mut best: Vec<(f64, [f64; D])> = Vec::new();
        for i in 0..n {
            let p = self.place(i);
            let phi = value(self.field, p);
            if (best.len() < 20 || phi > best[best.len() - 1].0) && self.holds(p) {
                best.push((phi, p));
                best.sort_by(|x, y| y.0.total_cmp(&x.0));
                best.truncate(20);
            }
        }
        best.into_iter().map(|(_, p)| self.climb(p, 300)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Tries to break a certificate; gives t over the largest phi found by the attack, in the set too.
fn attack<const D: usize>(field: &Field<D>, mesh: &Mesh<D>, reach: f64, certificate: &Certificate<D>, n: usize) -> f64 {
    let is_side_certified = certificate.is_side_certified;
    let mut attack = Attack { field, mesh, reach, is_side_certified, random: SplitMix64::new(17) };
    assert!(attack.holds(certificate.place) || attack.reach == 0.0, "{certificate:?}");
    assert_eq!(value(field, certificate.place), certificate.largest_found);
    let largest = attack.largest(n).max(certificate.largest_found);
    assert!(certificate.threshold > largest, "{largest} in {certificate:?}");
    certificate.threshold / largest
}

/// eps and G hold at random places.
fn check_bounds<const D: usize>(field: &Field<D>, mesh: &Mesh<D>, certificate: &Certificate<D>) {
    let mut random = SplitMix64::new(23);
    for p in mesh.sample(2000, 9).unwrap().points() {
        assert!(value(field, *p).abs() <= certificate.surface_error);
    }
    let slope = |p: [f64; D]| {
        let mut g = [[0.0; D]];
        field.eval(&[p], Outputs { gradients: Some(&mut g), ..Outputs::default() }).unwrap();
        norm(g[0])
    };
    for i in 0..6000 {
        let wide = [0.5, 0.8, 20.0][i % 3];
        let p = std::array::from_fn(|a| {
            let axis = field.grid().axes[a];
            0.5 * (axis.lower + axis.upper()) + wide * (axis.upper() - axis.lower) * random.between(-1.0, 1.0)
        });
        let most = if field.grid().holds(&p) { certificate.steepest } else { certificate.steepest_beyond };
        assert!(slope(p) <= most, "{} at {p:?}, {certificate:?}", slope(p));
    }
}

/// Both sides of a shape, from reach 0 to beyond the box.
fn both_sides<const D: usize>(mesh: &Mesh<D>, options: &FitOptions) {
    for feasible in [Feasible::Outside, Feasible::Inside] {
        let field = fit(mesh, &FitOptions { feasible, ..options.clone() });
        let d = field.diagonal();
        for reach in [0.0, 0.015, 0.1, 0.4] {
            // Without a reach no half-space helps where phi is level along the shape: sound, but not to the tolerance.
            let max_boxes = if reach == 0.0 { 20_000 } else { CertifyOptions::default().max_boxes };
            let limited = CertifyOptions { max_boxes, ..CertifyOptions::default() };
            let certificate = field.certify(mesh, reach * d, 0.0, &limited, &mut Progress::silent()).unwrap();
            assert!(certificate.is_side_certified && certificate.n_components == 1);
            let ratio = attack(&field, mesh, reach * d, &certificate, 2000);
            if reach > 0.0 {
                assert!(!certificate.is_budget_reached && ratio < 1.1, "{feasible:?} {reach}: {ratio} {certificate:?}");
            }
            if reach == 0.0 {
                check_bounds(&field, mesh, &certificate);
            }
        }
    }
}

#[test]
fn spheres_boxes_and_rings_are_sound_and_tight() {
    let options = FitOptions { control_points: [14; 3], ..FitOptions::default() };
    both_sides(&sphere([0.3, 0.0, 1.0], 1.0, 3).unwrap(), &options);
    both_sides(&box_mesh([-1.0; 3], [1.0, 0.5, 0.2]).unwrap(), &options);
    both_sides(&torus(0.7, 0.2, 40, 20).unwrap(), &options);
}

#[test]
fn curves_are_sound_and_tight() {
    let options = FitOptions { control_points: [20, 20, 0], ..FitOptions::default() };
    both_sides(&circle([3.0, -1.0], 1.0, 50).unwrap(), &options);
    both_sides(&rectangle([0.0; 2], [2.0, 0.5]).unwrap(), &options);
}

#[test]
fn refined_fields_are_sound_and_tight() {
    let options = FitOptions { max_error: 1e-3, ..FitOptions::default() };
    let cube = box_mesh([-1.0; 3], [1.0, 0.5, 0.2]).unwrap();
    assert!(fit(&cube, &options).is_refined());
    both_sides(&cube, &options);
    let frame = rectangle([0.0; 2], [2.0, 0.5]).unwrap();
    assert!(fit(&frame, &options).is_refined());
    both_sides(&frame, &options);
}

/// A cup, open above; a flat sheet through the box.
#[test]
fn of_open_shapes_both_sides_are_kept_clear() {
    let ball = sphere([0.0; 3], 1.0, 4).unwrap();
    let upper = |t: &[u32; 3]| t.iter().all(|&v| ball.vertices()[v as usize][0] > 0.0);
    let cup = Mesh::new(ball.vertices().to_vec(), ball.triangles().iter().copied().filter(upper).collect()).unwrap();
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]];
    let sheet = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    for mesh in [cup, sheet] {
        let options = FitOptions { control_points: [14; 3], ..FitOptions::default() };
        let field = fit(&mesh, &options);
        for reach in [0.015, 0.2] {
            let reach = reach * field.diagonal();
            let certificate = certify(&field, &mesh, reach);
            assert!(!certificate.is_side_certified && !certificate.is_budget_reached, "{certificate:?}");
            assert!(attack(&field, &mesh, reach, &certificate, 2000) < 1.15);
            check_bounds(&field, &mesh, &certificate);
        }
    }
}

#[test]
fn a_budget_of_one_box_is_sound_and_threads_do_not_matter() {
    let mesh = box_mesh([-1.0; 3], [1.0, 0.5, 0.2]).unwrap();
    let field = fit(&mesh, &FitOptions { control_points: [12; 3], ..FitOptions::default() });
    let with = |n_threads, max_boxes| {
        let options = CertifyOptions { n_threads, max_boxes, tolerance: 0.02 };
        field.certify(&mesh, 0.05, 0.01, &options, &mut Progress::silent()).unwrap()
    };
    let (one, full) = (with(1, 1), with(1, 4_000_000));
    assert!(one.is_budget_reached && !full.is_budget_reached && one.n_boxes < full.n_boxes);
    assert!(one.threshold >= full.threshold && one.surface_error >= full.surface_error);
    assert!(one.steepest >= full.steepest);
    attack(&field, &mesh, 0.06, &one, 200);
    assert_eq!(with(3, 4_000_000), full);
}

/// A field that has nothing to do with the shape but its box: what is proven is proven of any.
#[test]
fn random_control_points_are_sound() {
    let mesh = torus(0.7, 0.2, 20, 10).unwrap();
    let grid = *fit(&mesh, &FitOptions { control_points: [9, 8, 7], ..FitOptions::default() }).grid();
    for seed in 1..4 {
        let mut random = SplitMix64::new(seed);
        let lift = [-0.4, 0.0, 0.4][seed as usize - 1];
        let c = (0..grid.n_control()).map(|_| lift + random.between(-0.5, 0.5)).collect();
        let field = Field::from_control_points(grid, c, Feasible::Outside, 1.8).unwrap();
        for reach in [0.0, 0.05, 0.5] {
            let certificate = certify(&field, &mesh, reach);
            attack(&field, &mesh, reach, &certificate, 3000);
            check_bounds(&field, &mesh, &certificate);
        }
        // The largest error on the surface to a thousandth.
        let fine = CertifyOptions { tolerance: 1e-3, max_boxes: 100_000, ..CertifyOptions::default() };
        let certificate = field.certify(&mesh, 0.5, 0.0, &fine, &mut Progress::silent()).unwrap();
        let surface = mesh.sample(40_000, 5).unwrap();
        let largest = surface.points().iter().map(|p| value(&field, *p).abs()).fold(0.0, f64::max);
        let eps = certificate.surface_error;
        assert!(eps >= largest && eps < 1.01 * largest, "{largest} {certificate:?}");
    }
}

/// Fields with one peak, at the rim of what is to be kept clear: where a cell's middle is beyond the rim, the cell counts all the same.
#[test]
fn peaks_at_the_rim_are_seen() {
    let mesh = sphere([0.0; 3], 1.0, 2).unwrap();
    let (n_cells, cell, reach) = (16, 0.375, 0.5);
    let axis = Axis { lower: -0.5 * n_cells as f64 * cell, cell, n_cells };
    let grid = Grid { axes: [axis; 3] };
    let (n, mut random) = (n_cells + 3, SplitMix64::new(41));
    for k in 0..40 {
        let way: [f64; 3] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        // Within the rim, or just beyond it.
        let r = 1.0 + reach + cell * random.between(-0.3, 0.2);
        let peak = way.map(|x| x * r / norm(way));
        let control_point = |i: usize| {
            let at = [i / (n * n), i / n % n, i % n];
            if at.iter().any(|k| *k < 3 || k + 3 >= n) {
                return 1.0;
            }
            let off = norm(std::array::from_fn::<f64, 3, _>(|a| axis.lower + (at[a] as f64 - 1.0) * cell - peak[a]));
            2.0 * (-(off / cell).powi(2)).exp() - 1.0
        };
        let c = (0..grid.n_control()).map(control_point).collect();
        let field = Field::from_control_points(grid, c, Feasible::Outside, 3.5).unwrap();
        let options = CertifyOptions { tolerance: 0.01, ..CertifyOptions::default() };
        let certificate = field.certify(&mesh, reach, 0.0, &options, &mut Progress::silent()).unwrap();
        let mut attack =
            Attack { field: &field, mesh: &mesh, reach, is_side_certified: true, random: SplitMix64::new(k) };
        let start = way.map(|x| x * (r - 0.5 * cell).min(1.0 + 0.9 * reach) / norm(way));
        let largest = (0..5).map(|_| attack.climb(start, 300)).fold(f64::NEG_INFINITY, f64::max);
        assert!(certificate.threshold > largest, "{k}: {largest} {certificate:?}");
    }
}

/// Phi at the samples of a ball proves that the ball is clear, and shows where it is not.
#[test]
fn bodies_at_the_threshold_are_clear() {
    let mesh = torus(0.7, 0.2, 60, 30).unwrap();
    let field = fit(&mesh, &FitOptions { control_points: [24; 3], ..FitOptions::default() });
    let (clearance, radius) = (0.03, 0.15);
    let ball = sphere([0.0; 3], radius, 3).unwrap();
    // Vertices cover their triangles by the distance to the middles at most.
    let covering = 0.8 * norm(sub(ball.corners(0)[0], ball.corners(0)[1])) + 0.001;
    let certificate =
        field.certify(&mesh, clearance, covering, &CertifyOptions::default(), &mut Progress::silent()).unwrap();
    let (mut random, mut proven) = (SplitMix64::new(4), 0);
    for _ in 0..300 {
        let center: [f64; 3] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        let least = ball.vertices().iter().map(|v| value(&field, add(center, *v))).fold(f64::INFINITY, f64::min);
        if least >= certificate.threshold {
            proven += 1;
            let mut distance = [0.0];
            mesh.distance_tree().unwrap().signed_distances(&[center], &mut distance).unwrap();
            assert!(distance[0] > radius + clearance - 0.01 * radius, "{center:?} {distance:?}");
        }
    }
    assert!(proven > 100, "{proven}");
}

/// Far fields of all shells add up; the sides are known by construction. The search asks for the side of the cell in whose middle phi is
/// largest, and does so there, where the far fields are wrong: a cell taken for feasible is left out, and the threshold is below the peak.
#[test]
fn of_shells_in_shells_what_is_inside_all_is_infeasible() {
    let mesh = shells(100);
    for peak in TOLD_WRONG_IN_SHELLS {
        let w = mesh.distance_tree().unwrap().winding_number(peak);
        assert!(w < 0.3, "{w}: the far fields are no longer wrong at {peak:?}, of which this is a test");
        // phi is 1 on the faces and on the control points around the middle cell, and -1 elsewhere.
        let (n_cells, cell) = (13, 0.3);
        let axis = |a: usize| Axis { lower: peak[a] - 0.5 * n_cells as f64 * cell, cell, n_cells };
        let grid = Grid { axes: std::array::from_fn(axis) };
        let n = n_cells + 3;
        let control_point = |i: usize| {
            let at = [i / (n * n), i / n % n, i % n];
            let is_face = at.iter().any(|k| *k < 3 || k + 3 >= n);
            let is_top = at.iter().all(|k| *k == n / 2 - 1 || *k == n / 2);
            if is_face || is_top { 1.0 } else { -1.0 }
        };
        let c = (0..grid.n_control()).map(control_point).collect();
        let field = Field::from_control_points(grid, c, Feasible::Outside, 3.0).unwrap();
        let options = CertifyOptions { tolerance: 0.01, max_boxes: 2000, ..CertifyOptions::default() };
        let certificate = field.certify(&mesh, 0.01, 0.01, &options, &mut Progress::silent()).unwrap();
        let highest = value(&field, peak);
        assert!(certificate.is_side_certified && highest > 0.7, "{highest} {certificate:?}");
        assert!(certificate.threshold > highest, "{highest} {certificate:?}");
    }
}

#[test]
fn lengths_in_which_cells_are_lost_are_refused_and_large_ones_end_by_the_budget() {
    let mesh = box_mesh([-1.0; 3], [1.0; 3]).unwrap();
    let field = fit(&mesh, &FitOptions { control_points: [8; 3], ..FitOptions::default() });
    let options = CertifyOptions { max_boxes: 5000, ..CertifyOptions::default() };
    let with = |d: f64| field.certify(&mesh, d, 0.0, &options, &mut Progress::silent());
    let text = with(1e12).unwrap_err().to_string();
    assert!(text.contains("clearance + covering_radius is 1000000000000") && text.contains("of edge 0."), "{text}");
    for reach in [1e3, 1e6, 1e9, 5e10] {
        let certificate = with(reach).unwrap();
        assert!(certificate.n_boxes < 60_000 && certificate.surface_error < 1.0, "{certificate:?}");
        assert!(certificate.threshold > value(&field, [0.9 * reach, 0.0, 0.0]), "{certificate:?}");
    }
}

/// Something is told before each of what takes its time.
#[test]
fn progress_begins_before_the_tree() {
    let mesh = box_mesh([-1.0; 3], [1.0; 3]).unwrap();
    let field = fit(&mesh, &FitOptions { control_points: [8; 3], ..FitOptions::default() });
    let mut stages: Vec<String> = Vec::new();
    let mut listener = |_: f64, stage: &str| {
        if stages.last().is_none_or(|last| last != stage) {
            stages.push(stage.into());
        }
        ControlFlow::Continue(())
    };
    field.certify(&mesh, 0.1, 0.0, &CertifyOptions::default(), &mut Progress::new(&mut listener)).unwrap();
    assert_eq!(stages, ["components", "tree", "sides", "gradient", "surface", "threshold", "done"]);
}

#[test]
fn what_cannot_be_certified_is_refused() {
    let mesh = box_mesh([-1.0; 3], [1.0; 3]).unwrap();
    let field = fit(&mesh, &FitOptions { control_points: [8; 3], ..FitOptions::default() });
    let try_with = |clearance, radius, options: CertifyOptions| {
        field.certify(&mesh, clearance, radius, &options, &mut Progress::silent()).map(|_| ())
    };
    let usual = CertifyOptions::default;
    for (clearance, radius) in [(-0.1, 0.0), (f64::NAN, 0.0), (0.0, f64::INFINITY), (0.0, -1.0)] {
        assert!(matches!(try_with(clearance, radius, usual()), Err(Error::InvalidArgument(_))));
    }
    for tolerance in [0.0, f64::NAN, 1e5] {
        let options = CertifyOptions { tolerance, ..usual() };
        assert!(matches!(try_with(0.1, 0.1, options), Err(Error::InvalidArgument(text)) if text.contains("tolerance")));
    }
    assert!(try_with(0.1, 0.1, CertifyOptions { max_boxes: 0, ..usual() }).is_err());
    // With the other side said to be feasible, phi grows for ever where it should fall.
    let turned = Field::from_control_points(*field.grid(), field.coefficients().to_vec(), Feasible::Inside, 1.0);
    let refused = turned.unwrap().certify(&mesh, 0.1, 0.1, &usual(), &mut Progress::silent());
    assert!(matches!(refused, Err(Error::Degenerate(_))));
    let mut listener = |done: f64, _: &str| if done > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let cancelled = field.certify(&mesh, 0.1, 0.1, &usual(), &mut Progress::new(&mut listener));
    assert_eq!(cancelled, Err(Error::Cancelled));
}
