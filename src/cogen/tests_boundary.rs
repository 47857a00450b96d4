//! Meshes of parts: closed, manifold, within the cells, near to them, smooth.

use super::bits::Bits;
use super::boundary::{BoundaryOptions, Within, mesh_of_cells, mesh_of_densities};
use super::closure::close;
use super::conflict::{Conflicts, OverlapOptions, Side};
use super::fraction::{Solid, fractions_of_solid};
use super::grid::Grid;
use super::motion::{Law, Motion};
use super::part::Part;
use super::steps::Relative;
use crate::geometry::Mesh;
use crate::geometry::random::SplitMix64;
use crate::geometry::vec::{dot, norm, normalized, sub};
use crate::par::Workers;
use crate::progress::Progress;
use std::f64::consts::{PI, TAU};

fn of_cells<const D: usize>(grid: &Grid<D>, cells: &Bits, within: Within, rounds: usize) -> Mesh<D> {
    mesh_of_cells(grid, cells, &BoundaryOptions { within, rounds }, &mut Progress::silent()).unwrap()
}

/// Whether a point is in a cell that is kept, or on the boundary of one.
fn is_in<const D: usize>(grid: &Grid<D>, cells: &Bits, p: [f64; D]) -> bool {
    let at: [f64; D] = std::array::from_fn(|a| (p[a] - grid.corner()[a]) / grid.cell());
    (0..1 << D).any(|k: usize| {
        let place: [f64; D] = std::array::from_fn(|a| (at[a] + if k >> a & 1 == 0 { -1e-9 } else { 1e-9 }).floor());
        let inside = (0..D).all(|a| (0.0..grid.counts()[a] as f64).contains(&place[a]));
        inside && cells.has(grid.number(place.map(|x| x as usize)))
    })
}

fn is_solid_within<const D: usize>(mesh: &Mesh<D>, grid: &Grid<D>, cells: &Bits, random: &mut SplitMix64) {
    let report = mesh.report().unwrap();
    assert!(report.is_solid(), "{report}");
    let odd = (report.degenerate_facets, report.duplicate_facets, report.unreferenced_vertices);
    assert_eq!(odd, (0, 0, 0), "{report}");
    for f in 0..mesh.facets().len() {
        let corners = mesh.corners(f);
        for _ in 0..10 {
            let mut b: [f64; D] = std::array::from_fn(|_| random.unit().powi(2) + 1e-9);
            let sum: f64 = b.iter().sum();
            b = b.map(|x| x / sum);
            let p: [f64; D] = std::array::from_fn(|a| (0..D).map(|k| b[k] * corners[k][a]).sum());
            assert!(is_in(grid, cells, p), "facet {f} is outside at {p:?}");
        }
    }
}

fn any_cells_have_a_solid<const D: usize>(seed: u64, n_cases: usize) {
    let mut random = SplitMix64::new(seed);
    for case in 0..n_cases {
        let counts: [usize; D] = std::array::from_fn(|_| 1 + random.bits() as usize % 6);
        let grid = Grid::new(std::array::from_fn(|_| random.between(-1.0, 1.0)), 0.137, counts).unwrap();
        let density = random.unit();
        let checkers = case % 5 == 0;
        let wanted: Vec<bool> = (0..grid.n_cells())
            .map(|i| if checkers { grid.place(i).iter().sum::<usize>() % 2 == 0 } else { random.unit() < density })
            .collect();
        let cells = Bits::of(wanted.len(), |i| wanted[i]).unwrap();
        if cells.count() == 0 {
            continue;
        }
        let volume = cells.count() as f64 * grid.measure();
        let raw = of_cells(&grid, &cells, Within::Cells, 0);
        is_solid_within(&raw, &grid, &cells, &mut random);
        assert!((raw.report().unwrap().volume / volume - 1.0).abs() < 1e-12);
        let smooth = of_cells(&grid, &cells, Within::Cells, 8);
        is_solid_within(&smooth, &grid, &cells, &mut random);
        let left = smooth.report().unwrap().volume / volume;
        assert!(left > 0.05 && left < 1.0, "{left}");
        assert_eq!(of_cells(&grid, &cells, Within::Cells, 8).vertices(), smooth.vertices());
    }
}

#[test]
fn any_cells_have_a_solid_in_the_plane() {
    any_cells_have_a_solid::<2>(1, 300);
}

#[test]
fn any_cells_have_a_solid_in_space() {
    any_cells_have_a_solid::<3>(2, 100);
}

/// Root mean square of the sine of the angle between normals and the directions from the middle, by area.
fn roughness<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for f in 0..mesh.facets().len() {
        let (n, c) = (mesh.area_normal(f), mesh.corners(f));
        let middle = std::array::from_fn(|a| (0..D).map(|k| c[k][a]).sum::<f64>());
        let cosine = dot(normalized(n).unwrap(), normalized(middle).unwrap());
        sum += norm(n) * (1.0 - cosine * cosine);
        area += norm(n);
    }
    (sum / area).sqrt()
}

fn balls_become_round<const D: usize>(n: usize, rough: [f64; 2], least: f64) {
    let grid = Grid::new([-1.1; D], 2.2 / n as f64, [n; D]).unwrap();
    let cells = Bits::of(grid.n_cells(), |i| norm(grid.center(i)) < 1.0).unwrap();
    let mut random = SplitMix64::new(5);
    let volume = cells.count() as f64 * grid.measure();
    let raw = of_cells(&grid, &cells, Within::Cells, 0);
    let inside = of_cells(&grid, &cells, Within::Cells, 20);
    let free = of_cells(&grid, &cells, Within::Anywhere, 20);
    is_solid_within(&inside, &grid, &cells, &mut random);
    assert!(free.report().unwrap().is_solid());
    let [a, b, c] = [&raw, &inside, &free].map(roughness);
    assert!(a > 0.4 && b < rough[0] && c < rough[1], "{a} {b} {c}");
    let [b, c] = [&inside, &free].map(|m| m.report().unwrap().volume / volume);
    assert!(b > least && b < 1.0 && (c - 1.0).abs() < 0.02, "{b} {c}");
}

#[test]
fn balls_become_round_in_the_plane() {
    balls_become_round::<2>(60, [0.1, 0.05], 0.95);
}

#[test]
fn balls_become_round_in_space() {
    balls_become_round::<3>(40, [0.13, 0.05], 0.9);
}

#[test]
fn a_staircase_becomes_a_ramp() {
    // Steps of one down and three along; away from the ends and the walls.
    let grid = Grid::new([0.0, 0.0], 1.0, [60, 40]).unwrap();
    let cells = Bits::of(2400, |i| grid.place(i)[1] < 35 - grid.place(i)[0] / 3).unwrap();
    let mesh = of_cells(&grid, &cells, Within::Cells, 60);
    let slopes: Vec<f64> = (0..mesh.facets().len())
        .filter(|&f| mesh.corners(f).iter().all(|p| p[0] > 6.0 && p[0] < 54.0 && p[1] > 2.0))
        .map(|f| {
            let [x, y] = mesh.area_normal(f);
            x / y
        })
        .collect();
    assert!(slopes.len() > 60 && slopes.iter().all(|s| (s - 1.0 / 3.0).abs() < 0.06), "{slopes:?}");
}

#[test]
fn densities_are_met_where_they_pass_the_level() {
    let grid = Grid::new([-1.0; 3], 0.1, [20; 3]).unwrap();
    let mut densities = vec![0.0; grid.n_cells()];
    let ball = Solid::Ball { center: [0.02, -0.01, 0.03], radius: 0.71 };
    fractions_of_solid(&grid, &ball, 6, &mut densities, &Workers::caller_only()).unwrap();
    let of = |within, level| {
        let options = BoundaryOptions { within, rounds: 10 };
        mesh_of_densities(&grid, &densities, level, &options, &mut Progress::silent()).unwrap()
    };
    let free = of(Within::Anywhere, 0.5);
    assert!(free.report().unwrap().is_solid());
    // Of cells of 0.1: cut cells tell where the surface is, on average.
    let off: Vec<f64> = free.vertices().iter().map(|p| ball.signed_distance(*p)).collect();
    let rms = (off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64).sqrt();
    assert!(off.iter().all(|x| x.abs() < 0.04) && rms < 0.01, "{rms}");
    let volume = free.report().unwrap().volume / (4.0 / 3.0 * PI * 0.71_f64.powi(3));
    assert!((volume - 1.0).abs() < 0.03, "{volume}");
    let cells = Bits::of(densities.len(), |i| densities[i] > 0.5).unwrap();
    is_solid_within(&of(Within::Cells, 0.5), &grid, &cells, &mut SplitMix64::new(1));
    // A lower level takes more.
    assert!(of(Within::Anywhere, 0.1).report().unwrap().volume > free.report().unwrap().volume);
}

/// Depth to which the points of one mesh come into the other, at some times of the motion.
fn depth<const D: usize>(meshes: [&Mesh<D>; 2], relative: &Relative<D>, n_times: usize) -> f64 {
    let tree = meshes[0].distance_tree().unwrap();
    let mut deepest = 0.0_f64;
    for k in 0..n_times {
        let pose = relative.at((k as f64 + 0.37) / n_times as f64);
        let points: Vec<[f64; D]> = (0..meshes[1].facets().len())
            .flat_map(|f| {
                let c = meshes[1].corners(f);
                [c[0], std::array::from_fn(|a| (0..D).map(|k| c[k][a]).sum::<f64>() / D as f64)]
            })
            .map(|p| pose.apply(p))
            .collect();
        let mut distances = vec![0.0; points.len()];
        tree.signed_distances(&points, &mut distances).unwrap();
        deepest = distances.iter().fold(deepest, |m, d| m.max(-d));
    }
    deepest
}

fn meshes_of_a_pair_do_not_collide<const D: usize>(parts: [Part<D>; 2], relative: Relative<D>, side: Side, set: &Bits) {
    let pair = [&parts[0], &parts[1]];
    let room = pair.map(|p| p.allowed().clone());
    let conflicts =
        Conflicts::of_overlap(pair, &relative, &OverlapOptions::default(), &mut Progress::silent()).unwrap();
    let kept = close(&conflicts, &room, side, set).unwrap();
    let of = |within| [0, 1].map(|k| of_cells(pair[k].grid(), &kept.cells[k], within, 15));
    let [a, b] = of(Within::Cells);
    assert!(depth([&a, &b], &relative, 60) < 1e-9, "{}", depth([&a, &b], &relative, 60));
    // Both do something, and those that may be anywhere collide a little.
    for (k, mesh) in [&a, &b].into_iter().enumerate() {
        let volume = kept.cells[k].count() as f64 * pair[k].grid().measure();
        assert!(volume > 0.05 * pair[k].grid().n_cells() as f64 * pair[k].grid().measure());
        assert!(mesh.report().unwrap().volume > 0.8 * volume);
    }
    let [a, b] = of(Within::Anywhere);
    assert!(depth([&a, &b], &relative, 60) < 0.5 * pair[0].grid().cell());
}

#[test]
fn meshes_of_a_pair_do_not_collide_in_the_plane() {
    let square = |x: f64| Part::whole(Grid::new([x - 0.5, -0.5], 1.0 / 60.0, [60, 60]).unwrap()).unwrap();
    let turn = |x: f64, turns: f64| Motion::turn([x, 0.0], Law::even(turns * TAU)).unwrap();
    let grid = *square(0.0).grid();
    // A cross, which leaves the other part some teeth.
    let cross = Bits::of(3600, |i| grid.center(i).iter().any(|x| x.abs() < 0.15)).unwrap();
    let relative = Relative { from: turn(0.0, 1.0), of: turn(1.0, -1.0) };
    meshes_of_a_pair_do_not_collide([square(0.0), square(1.0)], relative, Side::First, &cross);
}

#[test]
fn meshes_of_a_pair_do_not_collide_in_space() {
    let part = |z: f64| Part::whole(Grid::new([-0.5, -0.5, z], 1.0 / 14.0, [14; 3]).unwrap()).unwrap();
    let parts = [part(-0.5), part(-0.3)];
    let grid = *parts[0].grid();
    let ball = Bits::of(14_usize.pow(3), |i| norm(sub(grid.center(i), [0.1, 0.1, -0.2])) < 0.4).unwrap();
    let screw = Motion::screw([0.0; 3], [0.1, 0.0, 1.0], 0.1, Law::even(3.0)).unwrap();
    meshes_of_a_pair_do_not_collide(parts, Relative { from: Motion::fixed(), of: screw }, Side::First, &ball);
}

#[test]
fn what_makes_no_mesh_is_refused() {
    let grid = Grid::new([0.0; 2], 1.0, [3, 3]).unwrap();
    let options = BoundaryOptions::default();
    let silent = &mut Progress::silent();
    let told = mesh_of_cells(&grid, &Bits::none(9).unwrap(), &options, silent).unwrap_err().to_string();
    assert!(told.contains("no cells"), "{told}");
    assert!(
        mesh_of_cells(&grid, &Bits::all(8).unwrap(), &options, silent).unwrap_err().to_string().contains("8 cells")
    );
    let mut of = |d: &[f64], level| mesh_of_densities(&grid, d, level, &options, silent).unwrap_err().to_string();
    assert!(of(&[0.5; 8], 0.5).contains("8 densities"));
    assert!(of(&[f64::NAN; 9], 0.5).contains("density 0 is NaN"));
    assert!(of(&[0.5; 9], 1.0).contains("the level is 1"));
    assert!(of(&[0.5; 9], 0.6).contains("no cells"));
}
