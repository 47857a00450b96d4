//! Fields on refined cells.

use super::*;
use crate::geometry::random::SplitMix64;
use crate::geometry::shapes::{box_mesh, circle, rectangle, sphere};
use crate::geometry::{Cloud, Mesh};
use crate::progress::Progress;
use crate::spline::hierarchical::Space;
use crate::spline::tree::Tree;
use crate::spline::{Axis, Grid};
use std::ops::ControlFlow;

fn cloud<const D: usize>(mesh: Mesh<D>, n: usize) -> Cloud<D> {
    mesh.sample(n, 1).unwrap()
}

fn cube() -> Cloud {
    cloud(box_mesh([0.0; 3], [3.0, 4.0, 5.0]).unwrap(), 4000)
}

fn cloud_in_plane() -> Cloud<2> {
    cloud(rectangle([0.0; 2], [2.0, 1.0]).unwrap(), 800)
}

fn options(max_error: f64) -> FitOptions {
    FitOptions { max_error, control_points: [9, 10, 11], tolerance: 1e-3, n_threads: 1, ..FitOptions::default() }
}

fn fit<const D: usize>(cloud: &Cloud<D>, options: &FitOptions) -> Field<D> {
    Field::fit(cloud, options, &mut Progress::silent()).unwrap()
}

/// Value, gradient and Hessian at one point.
fn jet<const D: usize>(field: &Field<D>, p: [f64; D]) -> Vec<f64> {
    let (mut v, mut g, mut h) = ([0.0], [[0.0; D]], vec![0.0; eval::packed::<D>()]);
    let outputs = Outputs { values: Some(&mut v), gradients: Some(&mut g), hessians: Some(&mut h) };
    field.eval(&[p], outputs).unwrap();
    v.iter().chain(g.as_flattened()).chain(&h).copied().collect()
}

/// A field of random control points on a grid of `n_cells` that was cut at random.
fn at_random<const D: usize>(n_cells: [usize; D], n_cuts: usize, seed: u64) -> Field<D> {
    let mut random = SplitMix64::new(seed);
    let grid = Grid { axes: n_cells.map(|n| Axis { lower: random.between(-1.0, 1.0), cell: 0.5, n_cells: n }) };
    let mut tree = Tree::new(grid).unwrap();
    for _ in 0..n_cuts {
        let level = (3.0 * random.unit()) as u32;
        tree.cut(level, std::array::from_fn(|a| (tree.n_cells(level, a) as f64 / 4.0 * random.unit()) as u32)).unwrap();
    }
    let space = Space::new(&tree).unwrap();
    let active = (0..space.n_active()).map(|_| random.between(-1.0, 1.0)).collect();
    let refined = Refined::new(tree, &space, active).unwrap();
    Field::of_refined(refined, Feasible::Outside, 1.0, FitReport::default())
}

/// Across every face between leaves, and every face of the box, value, gradient and Hessian go on; third derivatives do not.
fn goes_on_across_faces<const D: usize>(n_cells: [usize; D], seed: u64) {
    const STEP: f64 = 1e-9;
    let field = at_random(n_cells, 6, seed);
    let tree = field.refined.as_ref().unwrap().tree();
    let mut random = SplitMix64::new(seed);
    for tile in tree.tiles().iter().filter(|t| t.is_leaf() && tree.holds(t)) {
        let (cells, level) = (tree.cells(tile), tree.grid_of(tile.level));
        for axis in 0..D {
            let at =
                |a: usize, cell: f64| level.axes[a].lower + level.axes[a].cell * (f64::from(4 * tile.place[a]) + cell);
            let mut p: [f64; D] = std::array::from_fn(|a| at(a, cells[a] as f64 * random.unit()));
            p[axis] = at(axis, cells[axis] as f64) - STEP;
            let before = jet(&field, p);
            p[axis] += 2.0 * STEP;
            let behind = jet(&field, p);
            // Third derivatives are at most about 8 / h^3 in size, beyond the box some hundred times that, h the shortest cell there.
            let beyond = level.axes[axis].upper() < p[axis];
            let h = tree.grid_of(if beyond { tree.n_levels() - 1 } else { tile.level }).axes[axis].cell;
            let largest = 1e3 * STEP / h.powi(3);
            let apart = before.iter().zip(&behind).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
            assert!(apart < largest, "{apart:e} of {largest:e} at {p:?}: {before:?} {behind:?}");
        }
    }
}

#[test]
fn refined_fields_are_c2() {
    for seed in 0..5 {
        goes_on_across_faces([5, 4, 9], seed);
        goes_on_across_faces([9, 6], seed);
        goes_on_across_faces([1, 2, 3], seed);
    }
}

fn derivatives_are_those_of_differences<const D: usize>(n_cells: [usize; D]) {
    let field = at_random(n_cells, 6, 4);
    let mut random = SplitMix64::new(6);
    for _ in 0..300 {
        let p = std::array::from_fn(|a| {
            let axis = field.grid().axes[a];
            random.between(axis.lower - 1.0, axis.upper() + 1.0)
        });
        let here = jet(&field, p);
        let mut packed = 1 + D;
        for a in 0..D {
            let step = 1e-5;
            let moved = |sign: f64| {
                let mut p = p;
                p[a] += sign * step;
                jet(&field, p)
            };
            let (low, high) = (moved(-1.0), moved(1.0));
            let slope = |i: usize| (high[i] - low[i]) / (2.0 * step);
            assert!((slope(0) - here[1 + a]).abs() < 1e-4 * (1.0 + here[1 + a].abs()), "{p:?}");
            for b in a..D {
                assert!((slope(1 + b) - here[packed]).abs() < 2e-2 * (1.0 + here[packed].abs()), "{p:?}");
                packed += 1;
            }
        }
    }
}

#[test]
fn derivatives_of_refined_fields_are_those_of_differences() {
    derivatives_are_those_of_differences([5, 4, 9]);
    derivatives_are_those_of_differences([9, 6]);
}

/// The rank of the active functions' values at many points is their number.
fn is_independent<const D: usize>(n_cells: [usize; D], seed: u64) {
    let field = at_random(n_cells, 3, seed);
    let tree = field.refined.as_ref().unwrap().tree();
    let space = Space::new(tree).unwrap();
    let n = space.n_active();
    // Five points a cell along each axis tell a cubic from every other.
    let points: Vec<[f64; D]> = (0..tree.tiles().len())
        .filter(|t| tree.tiles()[*t].is_leaf() && tree.holds(&tree.tiles()[*t]))
        .flat_map(|t| {
            let tile = tree.tiles()[t];
            let (cells, level) = (tree.cells(&tile).map(|n| 5 * n), tree.grid_of(tile.level));
            (0..cells.iter().product()).map(move |mut i: usize| {
                let mut p = [0.0; D];
                for a in (0..D).rev() {
                    let along = (i % cells[a]) as f64 / 5.0 + 0.1 + f64::from(4 * tile.place[a]);
                    (p[a], i) = (level.axes[a].lower + level.axes[a].cell * along, i / cells[a]);
                }
                p
            })
        })
        .collect();
    // The matrix of sums over the points, by columns; then Cholesky's pivots.
    let columns: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let one = (0..n).map(|j| f64::from(i == j)).collect();
            let refined = Refined::new(tree.clone(), &space, one).unwrap();
            let field = Field::of_refined(refined, Feasible::Outside, 1.0, FitReport::default());
            let mut values = vec![0.0; points.len()];
            field.eval(&points, Outputs { values: Some(&mut values), ..Outputs::default() }).unwrap();
            values
        })
        .collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let size = dot(&column, &column).sqrt();
        assert!(size > 0.0);
        for _ in 0..2 {
            for q in &basis {
                let along = dot(q, &column);
                column.iter_mut().zip(q).for_each(|(c, q)| *c -= along * q);
            }
        }
        let left = dot(&column, &column).sqrt();
        assert!(left > 1e-7 * size, "a function is a sum of others but for {:e}", left / size);
        column.iter_mut().for_each(|c| *c /= left);
        basis.push(column);
    }
}

#[test]
fn active_functions_are_independent() {
    for seed in 0..3 {
        is_independent([5, 4], seed);
        is_independent([2, 7], seed);
    }
    is_independent([1, 2, 2], 1);
}

/// What a file of cuts is believed for: each leaves at least 2^D - 1 functions more.
fn cuts_add_functions<const D: usize>(n_cells: [usize; D], n_cuts: usize, seed: u64) {
    let mut random = SplitMix64::new(seed);
    let mut tree = Tree::new(Grid { axes: n_cells.map(|n| Axis { lower: 0.0, cell: 1.0, n_cells: n }) }).unwrap();
    let mut before = Space::new(&tree).unwrap().n_active();
    assert_eq!(before, tree.grid().n_control());
    for _ in 0..n_cuts {
        let leaves: Vec<u32> = (0..tree.tiles().len() as u32)
            .filter(|i| tree.tiles()[*i as usize].is_leaf() && tree.holds(&tree.tiles()[*i as usize]))
            .collect();
        // Early tiles as often as late ones: whole levels are cut that way, and single tiles far down.
        let of = leaves.len() as f64 * if random.unit() < 0.5 { 0.1 } else { 1.0 };
        assert!(tree.cut_index(leaves[(of * random.unit()) as usize]).unwrap());
        let after = Space::new(&tree).unwrap().n_active();
        assert!(after >= before + (1 << D) - 1, "{before} {after}");
        before = after;
    }
}

#[test]
fn a_cut_leaves_more_functions_than_there_were() {
    for seed in 0..8 {
        cuts_add_functions([1, 1], 60, seed);
        cuts_add_functions([9, 6], 60, seed);
        cuts_add_functions([1, 1, 1], 40, seed);
        cuts_add_functions([5, 1, 9], 40, seed);
        cuts_add_functions([4, 5, 3], 40, seed);
    }
}

/// Cut further, the space holds all that it held.
fn is_nested<const D: usize>(n_cells: [usize; D], seed: u64) {
    let workers = crate::par::Workers::caller_only();
    let before = at_random(n_cells, 4, seed);
    let mut tree = before.refined.as_ref().unwrap().tree().clone();
    let coarse = Space::new(&tree).unwrap();
    let mut random = SplitMix64::new(seed);
    for _ in 0..5 {
        let level = (4.0 * random.unit()) as u32;
        tree.cut(level, std::array::from_fn(|a| (tree.n_cells(level, a) as f64 / 4.0 * random.unit()) as u32)).unwrap();
    }
    let fine = Space::new(&tree).unwrap();
    assert!(fine.n_active() > coarse.n_active());
    let x = coarse.with_active(before.refined.as_ref().unwrap().active().iter().copied()).unwrap();
    let x = fine.take_over(&coarse, &x, &workers).unwrap();
    let refined = Refined::new(tree, &fine, fine.active(&x).collect()).unwrap();
    let after = Field::of_refined(refined, Feasible::Outside, 1.0, FitReport::default());
    for _ in 0..300 {
        let p = std::array::from_fn(|a| {
            let axis = before.grid().axes[a];
            random.between(axis.lower, axis.upper())
        });
        let (x, y) = (jet(&before, p), jet(&after, p));
        let size = x.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-11 * size), "{x:?} {y:?}");
    }
}

#[test]
fn a_tree_that_is_cut_further_holds_the_splines_of_before() {
    for seed in 0..4 {
        is_nested([5, 4, 9], seed);
        is_nested([9, 6], seed);
    }
}

#[test]
fn the_error_asked_for_is_reached_with_cells_where_it_is_hard() {
    let cloud = cube();
    let (coarse, fine) = (fit(&cloud, &FitOptions { max_error: 0.0, ..options(0.0) }), fit(&cloud, &options(6e-4)));
    let (before, after) = (coarse.report(), fine.report());
    assert!(before.max > 1.5e-3 && after.max <= 6e-4, "{before:?} {after:?}");
    assert!(before.n_levels == 1 && after.n_levels > 2);
    // A grid of the finest cells would have 8^l times as many.
    assert!(after.n_unknowns < before.n_unknowns * 8u64.pow(after.n_levels - 1) / 4, "{after:?}");
    assert!(fine.coefficients().is_empty() && fine.is_refined());
    // Beside an edge a wrong sign goes no farther than a few hundredths of the diagonal, which is 7.
    let mut random = SplitMix64::new(2);
    for _ in 0..500 {
        let p = std::array::from_fn(|a| random.between(-0.2, 3.2 + a as f64));
        let outside = (0..3).fold(f64::NEG_INFINITY, |m: f64, a| m.max(-p[a]).max(p[a] - 3.0 - a as f64));
        if outside.abs() > 0.2 {
            assert_eq!(jet(&fine, p)[0] > 0.0, outside > 0.0, "{p:?}");
        }
    }
}

#[test]
fn smooth_shapes_need_no_cuts_and_the_plane_has_them_too() {
    let ball = fit(&cloud(sphere([0.0; 3], 1.0, 4).unwrap(), 3000), &FitOptions { max_error: 0.01, ..options(0.0) });
    assert!(ball.report().max <= 0.01 && !ball.is_refined(), "{:?}", ball.report());
    let plate = cloud_in_plane();
    let field = fit(&plate, &FitOptions { max_error: 1e-3, control_points: [12; 3], ..options(0.0) });
    let report = field.report();
    assert!(report.max <= 1e-3 && report.n_levels > 2 && report.control_points == [12, 12, 0], "{report:?}");
    let level_set = field.level_set(0.0, &LevelSetOptions::default(), &mut Progress::silent()).unwrap();
    assert_eq!(level_set.boundary(), 0);
}

#[test]
fn thin_parts_are_kept_whatever_the_error() {
    // A seventieth of the diagonal thick: with cells of a tenth both faces would be one.
    let plate = cloud(box_mesh([0.0; 3], [1.0, 1.0, 0.02]).unwrap(), 8000);
    let field = fit(&plate, &FitOptions { max_error: 2e-3, control_points: [10, 10, 6], ..options(0.0) });
    assert!(field.report().max <= 2e-3, "{:?}", field.report());
    for x in [0.2, 0.5, 0.8] {
        assert!(jet(&field, [x, 0.5, 0.01])[0] < -0.005 && jet(&field, [x, 0.5, 0.03])[0] > 0.005);
    }
}

#[test]
fn threads_files_and_refits_keep_a_refined_field() {
    let cloud = cube();
    let field = fit(&cloud, &options(3e-3));
    let many = fit(&cloud, &FitOptions { n_threads: 3, ..options(3e-3) });
    let active = |field: &Field| field.refined.as_ref().unwrap().active().to_vec();
    assert!(active(&field) == active(&many), "threads change bits");
    let path = std::env::temp_dir().join(format!("keepout_refined_{}.kof", std::process::id()));
    field.save(&path).unwrap();
    let again = Field::<3>::load(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(active(&field), active(&again));
    let (mut random, r) = (SplitMix64::new(7), field.report());
    for _ in 0..200 {
        let p = std::array::from_fn(|_| random.between(-1.0, 6.0));
        assert_eq!(jet(&field, p), jet(&again, p));
    }
    assert_eq!((r.n_unknowns, r.n_levels, r.max), {
        let r = again.report();
        (r.n_unknowns, r.n_levels, r.max)
    });
    let anew = again.refit(&cloud, &FitOptions { reweightings: 0, ..options(0.0) }, &mut Progress::silent()).unwrap();
    assert_eq!((anew.report().n_unknowns, anew.report().n_levels), (r.n_unknowns, r.n_levels));
    let further = again.refit(&cloud, &options(4e-4), &mut Progress::silent()).unwrap();
    let further = further.report();
    assert!(further.max <= 4e-4 && further.n_unknowns > r.n_unknowns, "{further:?} after {r:?}");
}

#[test]
fn a_refit_of_one_grid_cuts_cells_where_an_error_is_asked_for() {
    let cloud = cube();
    let coarse = fit(&cloud, &options(0.0));
    assert!(!coarse.is_refined() && coarse.report().max > 6e-4);
    let refit = |field: &Field, options: &FitOptions| field.refit(&cloud, options, &mut Progress::silent());
    let fine = refit(&coarse, &options(6e-4)).unwrap();
    assert!(fine.is_refined() && fine.report().max <= 6e-4, "{:?}", fine.report());
    let plate = cloud_in_plane();
    let square = fit(&plate, &options(0.0)).refit(&plate, &options(1e-3), &mut Progress::silent()).unwrap();
    assert!(square.is_refined() && square.report().max <= 1e-3, "{:?}", square.report());

    let robust = |max_error| FitOptions { reweighting: Reweighting::Robust, ..options(max_error) };
    for (field, options, advice) in [
        (&coarse, robust(1e-3), "KO_REWEIGHT_LARGEST"),
        (&fine, robust(1e-3), "fit anew"),
        (&fine, robust(0.0), "fit anew"),
    ] {
        let end = refit(field, &options);
        assert!(matches!(&end, Err(Error::Unsupported(text)) if text.contains(advice)), "{end:?}");
    }
    assert!(refit(&coarse, &robust(0.0)).is_ok());
}

#[test]
fn where_nothing_is_cut_the_field_has_one_grid() {
    fn check<const D: usize>(cloud: &Cloud<D>) {
        let of = |max_error| fit(cloud, &FitOptions { reweightings: 0, ..options(max_error) });
        let (one, refined) = (of(0.0), of(1.0));
        let (a, b) = (one.report(), refined.report());
        assert!(!refined.is_refined() && b.n_levels == 1 && a.n_unknowns == b.n_unknowns);
        assert_eq!(refined.coefficients().len() as u64, b.n_unknowns);
        // Of the same order of points, which a wrong order of control points would not be.
        assert!(b.max < 2.0 * a.max && b.max > 0.5 * a.max, "{a:?} {b:?}");
    }
    check(&cube());
    check(&cloud_in_plane());
}

#[test]
fn limits_end_refinement_and_not_the_fit() {
    let cloud = cube();
    let few = fit(&cloud, &FitOptions { max_unknowns: 3000, ..options(1e-4) });
    assert!(few.report().n_unknowns <= 3000 && few.report().n_unknowns > 1500, "{:?}", few.report());
    assert!(few.report().max > 1e-4);
    let tight = fit(&cloud, &FitOptions { memory_limit: 10 << 20, ..options(1e-4) });
    assert!(tight.report().max > 1e-4 && tight.report().n_unknowns > 990);
    let robust = FitOptions { reweighting: Reweighting::Robust, ..options(1e-3) };
    assert!(matches!(Field::fit(&cloud, &robust, &mut Progress::silent()), Err(Error::Unsupported(_))));
    for wrong in [-1.0, 1e-10, 2.0, f64::NAN] {
        let end = Field::fit(&cloud, &options(wrong), &mut Progress::silent());
        assert!(matches!(end, Err(Error::InvalidArgument(_))), "{wrong}");
    }
    let short = FitOptions { max_iterations: 30, ..options(1e-3) };
    let end = Field::fit(&cloud, &short, &mut Progress::silent());
    assert!(matches!(end, Err(Error::NotConverged { iterations: 30, .. })), "{end:?}");
}

#[test]
fn a_refining_fit_tells_of_progress_and_stops_where_it_is_asked_to() {
    let (cloud, mut told) = (cube(), Vec::new());
    let mut listen = |fraction: f64, stage: &str| {
        told.push((fraction, stage.to_owned()));
        ControlFlow::Continue(())
    };
    Field::fit(&cloud, &options(3e-3), &mut Progress::new(&mut listen)).unwrap();
    // It goes on all the way: no step is a third of it, and every stage is told of.
    assert!(told.windows(2).all(|w| w[1].0 - w[0].0 < 1.0 / 3.0), "{told:?}");
    assert!(told[0].0 < 0.1 && told.last().unwrap().0 == 1.0);
    for stage in ["assembly", "solve", "refinement", "check", "done"] {
        assert!(told.iter().any(|(_, told)| told == stage), "{stage} in {told:?}");
    }
    for stop in (1..told.len()).step_by(told.len() / 40 + 1) {
        let mut n = 0;
        let mut listen = |_: f64, _: &str| {
            n += 1;
            if n == stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        assert_eq!(Field::fit(&cloud, &options(3e-3), &mut Progress::new(&mut listen)).unwrap_err(), Error::Cancelled);
    }
}

#[test]
fn turning_the_feasible_side_turns_the_sign() {
    let ring = cloud(circle([0.0; 2], 1.0, 90).unwrap(), 400);
    let one = fit(&ring, &FitOptions { max_error: 1e-3, control_points: [8; 3], ..options(0.0) });
    let inside = FitOptions { feasible: Feasible::Inside, max_error: 1e-3, control_points: [8; 3], ..options(0.0) };
    let other = fit(&ring, &inside);
    for p in [[0.0, 0.3], [0.9, 0.2], [1.05, 0.1], [3.0, 2.0]] {
        let (x, y) = (jet(&one, p), jet(&other, p));
        assert!(x.iter().zip(&y).all(|(x, y)| (x + y).abs() < 1e-9), "{x:?} {y:?}");
    }
}

/// A field of which nothing is known but its values.
struct Opaque<'a, const D: usize>(&'a Field<D>);

impl<const D: usize> Function<D> for Opaque<'_, D> {
    fn values(&self, points: &[[f64; D]], values: &mut [f64]) -> crate::Result<()> {
        self.0.values(points, values)
    }

    fn gradients(&self, points: &[[f64; D]], values: &mut [f64], gradients: &mut [[f64; D]]) -> crate::Result<()> {
        self.0.gradients(points, values, gradients)
    }
}

/// Level sets are those of the whole lattice, to the last bit; how many there were.
fn level_sets_are_those_of_the_whole_lattice<const D: usize>(field: &Field<D>, levels: &[f64]) -> usize {
    let mut n = 0;
    for (i, &level) in levels.iter().enumerate() {
        for subdivisions in [1, 2, 3] {
            let (shortest_edge, relaxations) = if i > 0 { (0.0, 0) } else { (0.3, 1) };
            let options = LevelSetOptions {
                subdivisions,
                shortest_edge,
                relaxations,
                n_threads: 1,
                ..LevelSetOptions::default()
            };
            let axes = field.surface_axes(subdivisions);
            let whole = level_set::Question { phi: &Opaque(field), axes, level, outward: 1.0 };
            let whole = level_set::extract(&whole, &options, &mut Progress::silent());
            let options = LevelSetOptions { n_threads: 1 + i as u32 % 2, ..options };
            let near = field.level_set(level, &options, &mut Progress::silent());
            assert!(near == whole, "level {level}, {subdivisions} subdivisions");
            n += usize::from(whole.is_ok());
        }
    }
    n
}

#[test]
fn level_sets_lose_nothing_of_the_lattice() {
    // Random control points have a part of the level set in every few cells; at high levels, specks.
    let levels = [0.0, 0.0, 0.45, 0.6, -0.75, 3.0];
    let mut n = 0;
    for seed in 0..2 {
        for n_cuts in [0, 2, 6] {
            n += level_sets_are_those_of_the_whole_lattice(&at_random([2, 1, 3], n_cuts, seed), &levels);
            n += level_sets_are_those_of_the_whole_lattice(&at_random([9, 6], n_cuts, seed), &levels);
        }
        let grid = Grid { axes: [5, 4, 7].map(|n| Axis { lower: -1e3, cell: 0.5, n_cells: n }) };
        let mut random = SplitMix64::new(seed);
        let points = (0..grid.n_control()).map(|_| random.between(-1.0, 1.0)).collect();
        let field = Field::from_control_points(grid, points, Feasible::Outside, 1.0).unwrap();
        n += level_sets_are_those_of_the_whole_lattice(&field, &levels);
    }
    assert!(n > 100, "{n}");
    // A distance, which is 0 in few blocks; and one that is 0 nowhere.
    let field = fit(&cube(), &FitOptions { control_points: [7, 8, 9], ..options(4e-3) });
    assert!(field.is_refined());
    assert_eq!(level_sets_are_those_of_the_whole_lattice(&field, &[0.0, 0.2]), 6);
}

#[test]
fn normals_that_cancel_out_are_refused() {
    let one = cloud(circle([0.0; 2], 1.0, 90).unwrap(), 300);
    let points = [one.points(), one.points()].concat();
    let normals = one.normals().iter().copied().chain(one.normals().iter().map(|n| n.map(|x| -x))).collect();
    let both = Cloud::new(points, normals).unwrap();
    let end = Field::fit(&both, &FitOptions { max_error: 1e-3, ..options(0.0) }, &mut Progress::silent());
    assert!(matches!(end, Err(Error::Degenerate(_))), "{end:?}");
}

#[test]
fn files_gone_bad_are_refused_wherever_they_are_cut_and_whatever_they_claim() {
    let plate = cloud(rectangle([0.0; 2], [2.0, 1.0]).unwrap(), 400);
    let field = fit(&plate, &FitOptions { max_error: 2e-3, control_points: [8; 3], ..options(0.0) });
    let path = std::env::temp_dir().join(format!("keepout_spoiled_{}.kof", std::process::id()));
    field.save(&path).unwrap();
    let good = std::fs::read(&path).unwrap();
    let n_cuts = u64::from_le_bytes(good[160..168].try_into().unwrap()) as usize;
    assert!(n_cuts > 1 && field.is_refined());
    let refused = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let end = Field::<2>::load(&path);
        assert!(matches!(end, Err(Error::Format { .. })), "{end:?}");
    };
    for n in (0..good.len()).step_by(7).chain([160, 161, 167, 168, good.len() - 1]) {
        refused(&good[..n]);
    }
    // With a checksum that fits, so that what is wrong must be seen.
    let summed = |mut bytes: Vec<u8>| {
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        bytes
    };
    let bare = &good[..good.len() - 4];
    let crafted = |at: usize, with: &[u8]| {
        let mut crafted = bare.to_vec();
        crafted[at..at + with.len()].copy_from_slice(with);
        refused(&summed(crafted));
    };
    // A cut of no tile, of one twice, counts that are not the file's, another version, no number.
    crafted(168, &u32::MAX.to_le_bytes());
    crafted(172, &good[168..172]);
    for n in [0, n_cuts as u64 - 1, n_cuts as u64 + 1, u64::MAX] {
        crafted(160, &n.to_le_bytes());
    }
    crafted(16, &[7]);
    crafted(8, &[1]);
    crafted(good.len() - 12, &f64::NAN.to_le_bytes());
    // Half a number more than there should be, and a whole one.
    for n in [4, 8] {
        refused(&summed([bare, &vec![0; n]].concat()));
    }
    // With other cuts and as many control points as they could have.
    let with_cuts = |cuts: &[u32], control_points: usize| {
        let mut bytes = good[..160].to_vec();
        bytes.extend((cuts.len() as u64).to_le_bytes());
        bytes.extend(cuts.iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend(vec![0; 8 * control_points]);
        summed(bytes)
    };
    // The grid has 5 by 5 cells, so four tiles; of the parts of the last, one has a cell, the others lie beyond the box.
    assert_eq!(field.grid().n_cells(), [5, 5]);
    refused(&with_cuts(&[3, 7], 1000));
    // A chain of cuts goes down to the deepest level, and no further.
    let mut chain = vec![0];
    chain.extend((0..15).map(|level| 4 + 4 * level));
    let mut tree = Tree::new(*field.grid()).unwrap();
    chain.iter().for_each(|c| assert!(tree.cut_index(*c).unwrap()));
    let n = Space::new(&tree).unwrap().n_active();
    std::fs::write(&path, with_cuts(&chain, n)).unwrap();
    let deepest = Field::<2>::load(&path).unwrap();
    assert_eq!((deepest.report().n_levels, deepest.report().n_unknowns), (17, n as u64));
    chain.push(4 + 4 * 15);
    refused(&with_cuts(&chain, n + 100));
    // Thousands of cuts in a file that is too short for their functions are refused by its length alone.
    let many: Vec<u32> = (0..5000).collect();
    std::fs::write(&path, with_cuts(&many, 64 + 5000 * 2)).unwrap();
    let end = Field::<2>::load(&path).unwrap_err().to_string();
    assert!(end.contains("its header announces"), "{end}");
    refused(&with_cuts(&many, 64 + 5000 * 3));
    std::fs::remove_file(&path).unwrap();
}
