//! Against brute force: overlaps by projecting vertices at many times, closure and cuts by looking at all sets.

use super::bits::Bits;
use super::closure::{Pair, close, room};
use super::conflict::{Conflicts, OverlapOptions, Side};
use super::correlation::Correlation;
use super::cut::cut;
use super::family::{FamilyOptions, family};
use super::grid::Grid;
use super::motion::{Law, Motion, Wave};
use super::optimise::{Design, OptimiseOptions, optimise};
use super::part::{Cell, Part};
use super::steps::{Relative, Sampling};
use super::sweep::{Body, Rule, sweep, unsweep};
use crate::geometry::Bounds;
use crate::geometry::random::SplitMix64;
use crate::geometry::rigid::{Rigid, Twist};
use crate::geometry::vec::{add, cross, dot, norm, sub};
use crate::par::Workers;
use crate::progress::Progress;
use std::f64::consts::TAU;

const SIDES: [Side; 2] = [Side::First, Side::Second];

fn twist<const D: usize>(random: &mut SplitMix64) -> Twist<D> {
    let w: [f64; 3] = std::array::from_fn(|_| random.between(-2.0, 2.0));
    let mut turn = [[0.0; D]; D];
    for (a, b, k) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
        if b < D {
            turn[a][b] = w[k];
            turn[b][a] = -w[k];
        }
    }
    Twist { turn, drift: std::array::from_fn(|_| random.between(-0.5, 0.5)) }
}

pub(super) fn motion<const D: usize>(random: &mut SplitMix64) -> Motion<D> {
    let law = Law {
        offset: 0.0,
        slope: random.between(-1.0, 1.0),
        waves: vec![Wave { amplitude: random.between(-0.3, 0.3), cycles: 1.0, phase: random.between(0.0, 3.0) }],
    };
    let along = Motion::along(twist(random), law).unwrap();
    match random.bits() % 4 {
        0 => Motion::fixed(),
        1 => along,
        2 => along.times(&Motion::along(twist(random), Law::even(1.0)).unwrap()).unwrap(),
        _ => Motion::sampled((0..4).map(|k| along.at(f64::from(k) / 3.0)).collect()).unwrap(),
    }
}

/// Grids that meet for a while.
pub(super) fn case<const D: usize>(random: &mut SplitMix64) -> ([Part<D>; 2], Relative<D>) {
    let mut part = || {
        let counts = std::array::from_fn(|_| 2 + random.bits() as usize % 4);
        let corner = std::array::from_fn(|_| random.between(-0.8, 0.0));
        Part::whole(Grid::new(corner, random.between(0.1, 0.25), counts).unwrap()).unwrap()
    };
    let parts = [part(), part()];
    (parts, Relative { from: motion(random), of: motion(random) })
}

pub(super) fn vertices<const D: usize>(grid: &Grid<D>, i: usize) -> Vec<[f64; D]> {
    let h = 0.5 * grid.cell();
    let corner = |k: usize| std::array::from_fn(|a| if k >> a & 1 == 0 { -h } else { h });
    (0..1 << D).map(|k| add(grid.center(i), corner(k))).collect()
}

/// By how much the shadows of both cells overlap on the axis on which they do so least; below 0 they are apart.
pub(super) fn overlap<const D: usize>(one: &[[f64; D]], two: &[[f64; D]]) -> f64 {
    let edges = |v: &[[f64; D]]| -> Vec<[f64; D]> { (0..D).map(|a| sub(v[1 << a], v[0])).collect() };
    let (a, b) = (edges(one), edges(two));
    let mut axes: Vec<[f64; D]> = a.iter().chain(&b).copied().collect();
    let three = |v: &[f64; D]| std::array::from_fn(|k| v[k % D]);
    if D == 3 {
        for (a, b) in a.iter().flat_map(|a| b.iter().map(move |b| (a, b))) {
            let n = cross(three(a), three(b));
            axes.push(std::array::from_fn(|k| n[k]));
        }
    }
    let mut least = f64::INFINITY;
    for n in axes.into_iter().filter(|n| norm(*n) > 1e-9) {
        let shadow = |v: &[[f64; D]]| {
            let at = v.iter().map(|p| dot(*p, n) / norm(n));
            (at.clone().fold(f64::INFINITY, f64::min), at.fold(f64::NEG_INFINITY, f64::max))
        };
        let (a, b) = (shadow(one), shadow(two));
        least = least.min((a.1 - b.0).min(b.1 - a.0));
    }
    least
}

/// The graph as a table.
pub(super) fn table(conflicts: &Conflicts) -> Vec<Vec<bool>> {
    let [n1, n2] = SIDES.map(|s| conflicts.n_cells(s));
    (0..n1)
        .map(|i| {
            let found = conflicts.neighbours(Side::First, &Bits::of(n1, |k| k == i).unwrap()).unwrap();
            (0..n2).map(|j| found.has(j)).collect()
        })
        .collect()
}

fn no_overlap_is_missed<const D: usize>(seed: u64, n_cases: usize) {
    let mut random = SplitMix64::new(seed);
    let (mut n_overlaps, mut n_edges) = (0, 0);
    for _ in 0..n_cases {
        let (parts, relative) = case::<D>(&mut random);
        let sampling = Sampling::Slack(random.between(0.01, 0.3));
        let options = OverlapOptions { sampling, n_threads: 1, ..OverlapOptions::default() };
        let conflicts =
            Conflicts::of_overlap([&parts[0], &parts[1]], &relative, &options, &mut Progress::silent()).unwrap();
        let table = table(&conflicts);
        n_edges += conflicts.n_edges();
        let mut seen = vec![vec![false; table[0].len()]; table.len()];
        for k in 0..200 {
            let t = if k < 2 { f64::from(k) } else { random.unit() };
            let pose: Rigid<D> = relative.at(t);
            let moved: Vec<Vec<_>> = (0..table[0].len())
                .map(|j| vertices(parts[1].grid(), j).into_iter().map(|p| pose.apply(p)).collect())
                .collect();
            for (i, row) in seen.iter_mut().enumerate() {
                let own = vertices(parts[0].grid(), i);
                for (j, seen) in row.iter_mut().enumerate() {
                    let by = overlap(&own, &moved[j]);
                    let cell = parts[0].grid().cell().min(parts[1].grid().cell());
                    assert!(by <= 1e-8 * cell || table[i][j], "cells {i} and {j} overlap by {by} at {t}");
                    *seen |= by > 0.0;
                }
            }
        }
        n_overlaps += seen.iter().flatten().filter(|s| **s).count();
    }
    // The graph is not simply full.
    assert!(n_overlaps > 100 && (n_edges as f64) < 2.0 * n_overlaps as f64, "{n_overlaps} overlaps, {n_edges} edges");
}

#[test]
fn no_overlap_is_missed_in_the_plane() {
    no_overlap_is_missed::<2>(1, 60);
}

#[test]
fn no_overlap_is_missed_in_space() {
    no_overlap_is_missed::<3>(2, 15);
}

/// Grids that fill the same box, turned by quarters or not at all, touch their neighbours and overlap themselves.
#[test]
fn touching_is_no_overlap() {
    let grid = Grid::new([-0.3, -0.3], 0.1, [6, 6]).unwrap();
    let part = Part::whole(grid).unwrap();
    for quarters in 0..4 {
        let turn =
            Motion::turn([0.0; 2], Law { offset: f64::from(quarters) * std::f64::consts::FRAC_PI_2, ..Law::default() })
                .unwrap();
        let relative = Relative { from: Motion::fixed(), of: turn };
        let conflicts =
            Conflicts::of_overlap([&part, &part], &relative, &OverlapOptions::default(), &mut Progress::silent())
                .unwrap();
        assert_eq!(conflicts.n_edges(), 36, "{quarters}");
    }
    // A slide along the rows keeps touching rows apart.
    let slide = Motion::slide([1.0, 0.0], Law::even(0.35)).unwrap();
    let relative = Relative { from: slide, of: Motion::fixed() };
    let conflicts =
        Conflicts::of_overlap([&part, &part], &relative, &OverlapOptions::default(), &mut Progress::silent()).unwrap();
    for (i, row) in table(&conflicts).iter().enumerate() {
        for (j, edge) in row.iter().enumerate() {
            assert!(!edge || i % 6 == j % 6, "{i} {j}");
        }
    }
}

/// A square of four cells turns about its middle; one small cell stays at (r, 0). No clearance above the least gap between them may be taken to be
/// kept, however coarse the steps and however far away the small cell is; the turn may end while the gap still closes.
#[test]
fn no_clearance_above_the_least_gap_is_kept() {
    for (r, sampling) in [
        (1.0, Sampling::Slack(0.05)),
        (10.0, Sampling::Slack(0.05)),
        (1.0, Sampling::Slack(1.0)),
        (0.3, Sampling::Slack(1.0)),
        (1.0, Sampling::Steps(4)),
        (1.0, Sampling::Steps(1)),
    ] {
        for angle in [-1.0, -0.5, 0.3, 0.5, 0.7, 6.0] {
            let turn = Motion::<2>::turn([0.0; 2], Law::even(angle)).unwrap();
            let square = Part::whole(Grid::new([-0.1, -0.1], 0.1, [2, 2]).unwrap()).unwrap();
            let small = Part::whole(Grid::new([r, -0.005], 0.01, [1, 1]).unwrap()).unwrap();
            let gap = least_gap(&turn, square.grid(), small.grid());
            for (parts, relative) in [
                ([&square, &small], Relative { from: turn.clone(), of: Motion::fixed() }),
                ([&small, &square], Relative { from: Motion::fixed(), of: turn.clone() }),
            ] {
                let keeps = |clearance: f64| {
                    let options = OverlapOptions { sampling, clearance, ..OverlapOptions::default() };
                    Conflicts::of_overlap(parts, &relative, &options, &mut Progress::silent()).unwrap().n_edges() == 0
                };
                let (mut kept, mut lost) = (0.0, 2.0 * r);
                for _ in 0..40 {
                    let middle = 0.5 * (kept + lost);
                    *(if keeps(middle) { &mut kept } else { &mut lost }) = middle;
                }
                assert!(kept <= gap * (1.0 + 1e-7), "{r} {sampling:?} {angle}: {kept} is kept, {gap} is the gap");
                if sampling == Sampling::Slack(0.05) {
                    assert!(kept > gap - 0.02, "{r} {angle}: {kept} is kept, {gap} is the gap");
                }
            }
        }
    }
}

/// The least distance over a motion of `one` between its box and that of `two`, which stays: of corners of each to the other.
fn least_gap(motion: &Motion<2>, one: &Grid<2>, two: &Grid<2>) -> f64 {
    let off = |grid: &Grid<2>, p: [f64; 2]| {
        let Bounds { min, max } = grid.bounds();
        norm(std::array::from_fn::<f64, 2, _>(|a| (min[a] - p[a]).max(p[a] - max[a]).max(0.0)))
    };
    let at = |k: i32| {
        let pose = motion.at(f64::from(k) / 20_000.0);
        let there = one.corners().map(|p| off(two, pose.apply(p)));
        there.chain(two.corners().map(|p| off(one, pose.apply_inverse(p)))).fold(f64::INFINITY, f64::min)
    };
    (0..=20_000).map(at).fold(f64::INFINITY, f64::min)
}

#[test]
fn cells_without_weight_are_kept_where_they_are_in_nobodys_way() {
    let mut random = SplitMix64::new(31);
    for _ in 0..1000 {
        let conflicts = random_graph(&mut random, 10);
        let table = table(&conflicts);
        let n = SIDES.map(|s| conflicts.n_cells(s));
        let room = n.map(|n| Bits::all(n).unwrap());
        let mut weight = || if random.unit() < 0.4 { 0 } else { random.bits() % 200 };
        let weights: [Vec<u64>; 2] = n.map(|n| (0..n).map(|_| weight()).collect());
        let weights = [&weights[0][..], &weights[1][..]];
        let cut = cut(&conflicts, &room, weights, &mut Progress::silent()).unwrap();
        assert!(is_free(&table, &cut.pair) && is_maximal(&table, &cut.pair));
        for gap in [0.0, 0.005] {
            let gammas = [0.0, 0.3, 0.5, 0.9, 1.0];
            let options = FamilyOptions { gap };
            let members = family(&conflicts, &room, weights, &gammas, &options, &mut Progress::silent()).unwrap();
            for member in &members {
                assert!(is_free(&table, &member.pair) && is_maximal(&table, &member.pair));
                assert!(member.gamma.is_nan() == (member.volumes == [0, 0]));
            }
        }
    }
}

#[test]
fn clearance_is_kept() {
    let mut random = SplitMix64::new(9);
    for _ in 0..20 {
        let (parts, relative) = case::<2>(&mut random);
        let parts = [&parts[0], &parts[1]];
        let of = |clearance| {
            let options = OverlapOptions { clearance, ..OverlapOptions::default() };
            table(&Conflicts::of_overlap(parts, &relative, &options, &mut Progress::silent()).unwrap())
        };
        let (none, some) = (of(0.0), of(0.07));
        for _ in 0..100 {
            let pose = relative.at(random.unit());
            for (i, j) in (0..none.len()).flat_map(|i| (0..none[0].len()).map(move |j| (i, j))) {
                assert!(!none[i][j] || some[i][j]);
                // Points of both cells that are nearer than that.
                let near = |grid: &Grid<2>, k, random: &mut SplitMix64| -> [f64; 2] {
                    let h = 0.5 * grid.cell();
                    add(grid.center(k), std::array::from_fn(|_| random.between(-h, h)))
                };
                let p = near(parts[0].grid(), i, &mut random);
                let q = pose.apply(near(parts[1].grid(), j, &mut random));
                assert!(norm(sub(p, q)) >= 0.07 || some[i][j]);
            }
        }
    }
}

pub(super) fn random_graph(random: &mut SplitMix64, most: usize) -> Conflicts {
    let mut n = || 1 + random.bits() as usize % most;
    let (n1, n2) = (n(), n());
    let density = random.unit();
    let rows_of = if random.bits() & 1 == 0 { Side::First } else { Side::Second };
    let edges: Vec<bool> = (0..n1 * n2).map(|_| random.unit() < density).collect();
    Conflicts::of_edges([n1, n2], rows_of, |i, j| edges[i * n2 + j]).unwrap()
}

fn is_free(table: &[Vec<bool>], pair: &Pair) -> bool {
    pair.cells[0].iter().all(|i| pair.cells[1].iter().all(|j| !table[i][j]))
}

/// Whether each cell that is left out, of all there are, conflicts with one that is kept.
fn is_maximal(table: &[Vec<bool>], pair: &Pair) -> bool {
    let (n1, n2) = (pair.cells[0].len(), pair.cells[1].len());
    (0..n1).all(|i| pair.cells[0].has(i) || pair.cells[1].iter().any(|j| table[i][j]))
        && (0..n2).all(|j| pair.cells[1].has(j) || pair.cells[0].iter().any(|i| table[i][j]))
}

#[test]
fn closure_never_collides_and_cannot_grow() {
    let mut random = SplitMix64::new(4);
    for _ in 0..4000 {
        let conflicts = random_graph(&mut random, 12);
        let table = table(&conflicts);
        let n = SIDES.map(|s| conflicts.n_cells(s));
        let room = n.map(|n| Bits::of(n, |i| !(i * 7 + n).is_multiple_of(5)).unwrap());
        let side = SIDES[random.bits() as usize % 2];
        let wanted: Vec<bool> = (0..n[side.index()]).map(|_| random.unit() < 0.5).collect();
        let set = Bits::of(wanted.len(), |i| wanted[i]).unwrap();
        let pair = close(&conflicts, &room, side, &set).unwrap();
        assert!(is_free(&table, &pair));
        let mut kept = set.clone();
        kept.intersect(&room[side.index()]);
        kept.subtract(&pair.cells[side.index()]);
        assert_eq!(kept.count(), 0, "what was there is kept");
        for s in SIDES {
            for i in room[s.index()].iter().filter(|&i| !pair.cells[s.index()].has(i)) {
                let mut grown = pair.clone();
                grown.cells[s.index()].insert(i);
                assert!(!is_free(&table, &grown));
            }
        }
    }
}

#[test]
fn the_cut_is_the_best_of_all_pairs() {
    let mut random = SplitMix64::new(5);
    for round in 0..3000 {
        let conflicts = random_graph(&mut random, 9);
        let table = table(&conflicts);
        let n = SIDES.map(|s| conflicts.n_cells(s));
        let most = [1, 3, 1000][round % 3];
        let weights = n.map(|n| (0..n).map(|_| random.bits() % (most + 1)).collect::<Vec<u64>>());
        let room = n.map(|n| Bits::of(n, |i| round % 2 == 0 || i % 4 != 1).unwrap());
        let found = cut(&conflicts, &room, [&weights[0], &weights[1]], &mut Progress::silent()).unwrap();
        assert!(is_free(&table, &found.pair));
        // All sets of part 1, each with all of part 2 that it leaves.
        let best = (0..1_u32 << n[0])
            .filter(|set| (0..n[0]).all(|i| set >> i & 1 == 0 || room[0].has(i)))
            .map(|set| {
                let one: u64 = (0..n[0]).filter(|i| set >> i & 1 == 1).map(|i| weights[0][i]).sum();
                let left = |j: &usize| room[1].has(*j) && (0..n[0]).all(|i| set >> i & 1 == 0 || !table[i][*j]);
                one + (0..n[1]).filter(left).map(|j| weights[1][j]).sum::<u64>()
            })
            .max()
            .unwrap();
        assert_eq!((found.weight, found.bound), (best, best));
    }
}

/// Where parts are alike it is told by their motions which of them is seen to move.
#[test]
fn ends_of_the_family_are_unsweeps_of_parts_that_are_alike() {
    let grid = Grid::<2>::new([-0.43, -0.57], 0.1, [10, 10]).unwrap();
    let part = Part::whole(grid).unwrap();
    let turn = |slope: f64| Motion::turn([0.0, 0.0], Law::even(slope)).unwrap();
    let beside = Motion::slide([1.0, 0.1], Law { offset: 1.0, ..Law::default() }).unwrap();
    let motions = [turn(TAU), beside.times(&turn(-TAU)).unwrap()];
    let (options, workers, silent) = (OverlapOptions::default(), Workers::caller_only(), &mut Progress::silent());
    for [one, two] in [[0, 1], [1, 0]] {
        let relative = Relative { from: motions[one].clone(), of: motions[two].clone() };
        let conflicts = Conflicts::of_overlap([&part, &part], &relative, &options, silent).unwrap();
        let room = [part.allowed().clone(), part.allowed().clone()];
        for (side, relative) in [(Side::First, relative.clone()), (Side::Second, relative.reversed())] {
            let whole = close(&conflicts, &room, side, &room[0]).unwrap();
            let body = Body { grid, cells: part.allowed(), relative, rule: Rule::Avoid, clearance: 0.0 };
            let left = unsweep(&part, &[body], options.sampling, &workers, silent).unwrap();
            assert!(left.count() < 50 && left == whole.cells[side.other().index()]);
        }
    }
}

#[test]
fn frozen_cells_stay_and_may_not_collide() {
    let conflicts = Conflicts::of_edges([3, 2], Side::First, |i, j| i == j).unwrap();
    let part = |n: usize, frozen: &[usize]| {
        let cells: Vec<Cell> = (0..n).map(|i| if frozen.contains(&i) { Cell::Frozen } else { Cell::Free }).collect();
        Part::of_cells(Grid::new([0.0; 2], 1.0, [n, 1]).unwrap(), &cells).unwrap()
    };
    let still = Relative { from: Motion::fixed(), of: Motion::fixed() };
    let rooms = room(&conflicts, [&part(3, &[0]), &part(2, &[1])], &still).unwrap();
    assert_eq!(rooms[0].iter().collect::<Vec<_>>(), [0, 2]);
    assert_eq!(rooms[1].iter().collect::<Vec<_>>(), [1]);
    let told = room(&conflicts, [&part(3, &[1]), &part(2, &[1])], &still).unwrap_err().to_string();
    assert!(
        told.contains("1 pair") && told.contains("cell 1 of part 2, at (1.5, 0.5), overlap from time 0 on"),
        "{told}"
    );
}

#[test]
fn families_are_free_maximal_and_below_a_bound_that_holds() {
    let mut random = SplitMix64::new(6);
    let gammas = [0.5, 0.0, 0.1, 0.25, 0.4, 0.6, 0.8, 1.0, 0.5];
    let (mut n, mut n_met) = (0, 0);
    for round in 0..600 {
        let conflicts = random_graph(&mut random, 10);
        if conflicts.n_edges() == 0 {
            continue;
        }
        let table = table(&conflicts);
        let sizes = SIDES.map(|s| conflicts.n_cells(s));
        let weights = sizes.map(|n| (0..n).map(|_| 1 + random.bits() % [1, 4][round % 2]).collect::<Vec<u64>>());
        let room = sizes.map(|n| Bits::all(n).unwrap());
        let of = |gap| {
            let options = FamilyOptions { gap };
            family(&conflicts, &room, [&weights[0], &weights[1]], &gammas, &options, &mut Progress::silent()).unwrap()
        };
        let (members, near) = (of(0.0), of(0.02));
        // All pairs: each set of part 1 with all that it leaves of part 2; the corners of their hull are among them.
        let colliding = [
            Bits::of(sizes[0], |i| table[i].iter().any(|e| *e)).unwrap(),
            Bits::of(sizes[1], |j| table.iter().any(|row| row[j])).unwrap(),
        ];
        let all: Vec<[f64; 2]> = (0..1_u32 << sizes[0])
            .map(|set| {
                let has = |i: usize| set >> i & 1 == 1;
                let one: u64 = colliding[0].iter().filter(|&i| has(i)).map(|i| weights[0][i]).sum();
                let left = |j: &usize| (0..sizes[0]).all(|i| !has(i) || !table[i][*j]);
                [one as f64, colliding[1].iter().filter(left).map(|j| weights[1][j]).sum::<u64>() as f64]
            })
            .collect();
        for (member, gamma, exact) in members
            .iter()
            .zip(gammas)
            .map(|(m, g)| (m, g, true))
            .chain(near.iter().zip(gammas).map(|(m, g)| (m, g, false)))
        {
            assert_eq!(member.wanted, gamma);
            assert!(is_free(&table, &member.pair));
            for s in SIDES {
                for i in (0..sizes[s.index()]).filter(|&i| !member.pair.cells[s.index()].has(i)) {
                    let mut grown = member.pair.clone();
                    grown.cells[s.index()].insert(i);
                    assert!(!is_free(&table, &grown), "it could grow");
                }
            }
            let [v1, v2] = member.volumes.map(|v| v as f64);
            assert_eq!(member.gamma, v2 / (v1 + v2));
            // Pairs of that gamma, and mixtures of two pairs, weigh no more than the bound.
            let mixed = |p: &[f64; 2], q: &[f64; 2]| {
                let (a, b) = ((1.0 - gamma) * p[1] - gamma * p[0], (1.0 - gamma) * q[1] - gamma * q[0]);
                if a * b > 0.0 || a == b {
                    None
                } else {
                    Some((p[0] + p[1]) * (b / (b - a)) + (q[0] + q[1]) * (-a / (b - a)))
                }
            };
            let best = all.iter().flat_map(|p| all.iter().filter_map(move |q| mixed(p, q))).fold(0.0, f64::max);
            assert!(best <= member.bound * (1.0 + 1e-12), "{best} {}", member.bound);
            // Without a gap the bound is the hull itself.
            n += usize::from(exact);
            n_met += usize::from(exact && best >= member.bound * (1.0 - 1e-12));
        }
        assert_eq!((members[1].gamma, members[7].gamma), (0.0, 1.0));
        assert_eq!(members[0].pair, members[8].pair);
    }
    assert_eq!(n_met, n);
}

#[test]
fn sweeps_and_unsweeps_are_neighbours_in_the_graph() {
    let mut random = SplitMix64::new(21);
    let (workers, sampling) = (Workers::new(2).unwrap(), OverlapOptions::default().sampling);
    for _ in 0..20 {
        let (parts, relative) = case::<2>(&mut random);
        let grids = parts.each_ref().map(|p| *p.grid());
        let wanted: Vec<bool> = (0..grids[1].n_cells()).map(|_| random.unit() < 0.3).collect();
        let set = Bits::of(wanted.len(), |j| wanted[j]).unwrap();
        let silent = &mut Progress::silent();
        let swept = sweep(&grids[1], &set, &relative, &grids[0], sampling, &workers, silent).unwrap();
        // What part 1 may have beside it is what is not swept, seen from either.
        let body =
            Body { grid: grids[1], cells: &set, relative: relative.reversed(), rule: Rule::Avoid, clearance: 0.0 };
        let kept = unsweep(&parts[0], &[body], sampling, &workers, silent).unwrap();
        for t in (0..50).map(|k| f64::from(k) / 49.0) {
            let pose = relative.at(t);
            for (i, j) in (0..grids[0].n_cells()).flat_map(|i| set.iter().map(move |j| (i, j))) {
                let moved: Vec<_> = vertices(&grids[1], j).into_iter().map(|p| pose.apply(p)).collect();
                let meets = overlap(&vertices(&grids[0], i), &moved) > 1e-8;
                assert!(!meets || (swept.has(i) && !kept.has(i)));
            }
        }
        assert!(swept.iter().filter(|&i| kept.has(i)).count() <= swept.count() / 5);
    }
}

/// A latch that turns in an enclosure about a pivot, and keeps off a pin that goes up: as in figure 2.
#[test]
fn a_latch_stays_in_its_enclosure_and_off_its_pin() {
    let grid = Grid::new([-1.0, -1.0], 0.05, [40, 40]).unwrap();
    let latch = Part::whole(grid).unwrap();
    let turn = Motion::turn([0.0; 2], Law::even(-0.8)).unwrap();
    let enclosure = Grid::new([-1.2, -0.9], 0.06, [40, 25]).unwrap();
    let inside = Bits::of(enclosure.n_cells(), |i| norm(enclosure.center(i)) < 1.1).unwrap();
    let pin = Grid::new([0.5, -0.2], 0.025, [8, 8]).unwrap();
    let round = Bits::of(pin.n_cells(), |i| norm(sub(pin.center(i), [0.6, -0.1])) < 0.1).unwrap();
    let up = Motion::slide([0.0, 1.0], Law::even(0.6)).unwrap();
    let body = |grid, cells, from, rule| Body {
        grid,
        cells,
        relative: Relative { from, of: turn.clone() },
        rule,
        clearance: 0.0,
    };
    let bodies = [body(enclosure, &inside, Motion::fixed(), Rule::StayIn), body(pin, &round, up.clone(), Rule::Avoid)];
    let workers = Workers::caller_only();
    let kept = unsweep(&latch, &bodies, OverlapOptions::default().sampling, &workers, &mut Progress::silent()).unwrap();
    assert!(kept.count() > 300 && kept.count() < 1300, "{}", kept.count());
    let mut random = SplitMix64::new(2);
    let in_cells = |grid: &Grid<2>, cells: &Bits, p: [f64; 2]| {
        let place: [f64; 2] = std::array::from_fn(|a| ((p[a] - grid.corner()[a]) / grid.cell()).floor());
        let inside = (0..2).all(|a| (0.0..grid.counts()[a] as f64).contains(&place[a]));
        inside && cells.has(grid.number(place.map(|x| x as usize)))
    };
    for i in kept.iter() {
        for _ in 0..60 {
            let (h, t) = (0.4999 * grid.cell(), random.unit());
            let p = add(grid.center(i), std::array::from_fn(|_| random.between(-h, h)));
            let world = turn.at(t).apply(p);
            assert!(in_cells(&enclosure, &inside, world));
            assert!(!in_cells(&pin, &round, up.at(t).apply_inverse(world)));
        }
    }
}

/// Two squares that turn against each other, as in section 5.1, of n^2 cells.
pub(super) fn gears(n: usize) -> ([Part<2>; 2], Relative<2>) {
    let square = |x: f64| Part::whole(Grid::new([x - 0.5, -0.5], 1.0 / n as f64, [n, n]).unwrap()).unwrap();
    let turn = |x: f64, turns: f64| Motion::turn([x, 0.0], Law::even(turns * std::f64::consts::TAU)).unwrap();
    ([square(0.0), square(1.0)], Relative { from: turn(0.0, 1.0), of: turn(1.0, -1.0) })
}

#[test]
fn moving_asymptotes_end_at_a_maximal_pair_below_the_cut() {
    let (parts, relative) = gears(60);
    let (pair, workers) = ([&parts[0], &parts[1]], Workers::new(2).unwrap());
    let correlation = Correlation::new(pair, &relative, 200, 1 << 30, &workers, &mut Progress::silent()).unwrap();
    let conflicts = correlation.conflicts(1 << 30, &workers, &mut Progress::silent()).unwrap();
    let room = pair.map(|p| p.allowed().clone());
    let weights = [vec![1; 3600], vec![1; 3600]];
    let best = cut(&conflicts, &room, [&weights[0], &weights[1]], &mut Progress::silent()).unwrap().weight;
    let design =
        Design { correlation: &correlation, conflicts: &conflicts, room: &room, frozen: pair.map(|p| p.frozen()) };
    let unsweeps = SIDES.map(|s| close(&conflicts, &room, s, &room[s.index()]).unwrap());
    for (gamma, unsweep) in [(0.0, Some(0)), (0.3, None), (0.5, None), (1.0, Some(1))] {
        let options = OptimiseOptions { gamma, ..OptimiseOptions::default() };
        let found = optimise(&design, &options, &workers, &mut Progress::silent()).unwrap();
        assert!(found.converged && found.history.len() < 100, "{gamma}: {}", found.history.len());
        let (first, last) = (found.history[0], found.history[found.history.len() - 1]);
        assert!(last.measures.g21 <= 2e-3 * first.measures.g21 && last.measures.g12 <= 2e-3 * first.measures.g12);
        let [v1, v2] = last.volumes;
        assert!((gamma * v1 - (1.0 - gamma) * v2).abs() < 2e-3 * (first.volumes[0] + first.volumes[1]));
        assert!((found.gamma - gamma).abs() < 0.05, "{gamma} {}", found.gamma);
        // (25) and (26): at the ends it is an unsweep.
        if let Some(k) = unsweep {
            assert!(found.pair == unsweeps[k]);
        }
        let total = SIDES.map(|s| found.pair.count(s)).iter().sum::<usize>() as u64;
        assert!(total <= best);
        let kept = found
            .pair
            .cells
            .each_ref()
            .map(|set| (0..3600).map(|i| f64::from(u8::from(set.has(i)))).collect::<Vec<_>>());
        let free = correlation.measures([&kept[0], &kept[1]], &workers).unwrap();
        assert_eq!((free.g21, free.g12), (0.0, 0.0));
    }
    let options = OptimiseOptions { gamma: 1.5, ..OptimiseOptions::default() };
    let told = optimise(&design, &options, &workers, &mut Progress::silent()).unwrap_err().to_string();
    assert!(told.contains("gamma is 1.5"));
}

#[test]
fn threads_change_no_result() {
    let (parts, relative) = gears(60);
    let pair = [&parts[0], &parts[1]];
    let room = pair.map(|p| p.allowed().clone());
    let of = |n_threads| {
        let (workers, silent) = (Workers::new(n_threads).unwrap(), &mut Progress::silent());
        let options = OverlapOptions { n_threads, ..OverlapOptions::default() };
        let overlaps = table(&Conflicts::of_overlap(pair, &relative, &options, silent).unwrap());
        let correlation = Correlation::new(pair, &relative, 200, 1 << 30, &workers, silent).unwrap();
        let conflicts = correlation.conflicts(1 << 30, &workers, &mut Progress::silent()).unwrap();
        let design =
            Design { correlation: &correlation, conflicts: &conflicts, room: &room, frozen: pair.map(|p| p.frozen()) };
        let options = OptimiseOptions { max_iterations: 5, ..OptimiseOptions::default() };
        (overlaps, optimise(&design, &options, &workers, silent).unwrap().densities)
    };
    assert!(of(1) == of(3));
}

#[test]
fn graphs_that_are_too_large_are_refused() {
    let (parts, relative) = gears(60);
    let options = OverlapOptions { max_bytes: 10_000, ..OverlapOptions::default() };
    let told = Conflicts::of_overlap([&parts[0], &parts[1]], &relative, &options, &mut Progress::silent()).unwrap_err();
    assert!(matches!(&told, crate::Error::OutOfMemory { bytes, limit: Some(10_000), .. } if *bytes > 10_000), "{told}");
}
