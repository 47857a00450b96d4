//! Motions that repeat themselves: one period gives what the whole gives.

use super::bits::Bits;
use super::closure::close;
use super::conflict::{Conflicts, OverlapOptions, Side};
use super::contact::contact;
use super::correlation::Correlation;
use super::grid::Grid;
use super::motion::{Law, Motion, Wave};
use super::part::Part;
use super::steps::{Relative, Sampling};
use crate::geometry::rigid::Rigid;
use crate::par::Workers;
use crate::progress::Progress;
use std::f64::consts::TAU;

/// A cam that turns thrice and its follower, which goes up and down six times, and the same of which no one knows that it repeats itself.
fn cam() -> ([Part<2>; 2], [Relative<2>; 2]) {
    let part = |y: f64| Part::whole(Grid::new([-0.31, y], 0.037, [17, 17]).unwrap()).unwrap();
    let turn = Motion::turn([0.0, 0.0], Law::even(3.0 * TAU)).unwrap();
    let law = Law { offset: 0.5, slope: 0.0, waves: vec![Wave { amplitude: 0.1, cycles: 6.0, phase: 0.3 }] };
    let slide = Motion::slide([0.0, 1.0], law).unwrap();
    let still = Motion::sampled(vec![Rigid::IDENTITY; 2]).unwrap();
    let [a, b] = [slide.clone(), slide.times(&still).unwrap()].map(|of| Relative { from: turn.clone(), of });
    ([part(-0.31), part(-0.29)], [a, b])
}

fn graph(parts: &[Part<2>; 2], relative: &Relative<2>, n: usize) -> Conflicts {
    let options = OverlapOptions { sampling: Sampling::Steps(n), ..OverlapOptions::default() };
    Conflicts::of_overlap([&parts[0], &parts[1]], relative, &options, &mut Progress::silent()).unwrap()
}

/// A screw of six turns by two cells each through a block that is at a pose of its own, and the same of which no one knows.
#[test]
fn one_turn_of_a_screw_has_the_measures_of_all() {
    let eps = [0.05, 0.025];
    let block = Part::whole(Grid::new([-0.21, -0.22, -0.05], eps[0], [9, 9, 5]).unwrap()).unwrap();
    let bolt = Part::of_centers(Grid::new([-0.13, -0.12, -0.7031], eps[1], [11, 10, 26]).unwrap(), |x| {
        x[0] > -0.1 || x[2] < -0.3
    })
    .unwrap();
    let screw = |turns: f64, lead: f64| {
        Motion::<3>::screw([0.01, 0.02, 0.0], [0.0, 0.0, 1.0], lead, Law::even(turns * TAU)).unwrap()
    };
    let pose = Motion::at_pose(screw(1.0, 0.3).at(0.37));
    let workers = Workers::new(2).unwrap();
    for (parts, lead) in [([&block, &bolt], 0.1 / TAU), ([&bolt, &block], -0.1 / TAU)] {
        let known = Relative { from: pose.clone(), of: pose.times(&screw(6.0, lead)).unwrap() };
        let halves = screw(3.0, lead).times(&screw(3.0, lead)).unwrap();
        let unknown = Relative { from: pose.clone(), of: pose.times(&halves).unwrap() };
        for relatives in [[known.clone(), unknown.clone()], [known.reversed(), unknown.reversed()]] {
            let parts = if relatives[0].of.n_periods() == 0 { [parts[1], parts[0]] } else { parts };
            let make = |r: &Relative<3>| Correlation::new(parts, r, 606, 1 << 30, &workers, &mut Progress::silent());
            let [one, all] = relatives.each_ref().map(|r| make(r).unwrap());
            let [stored, whole] = [&one, &all].map(Correlation::n_visits);
            assert!(stored * 3 < whole * 2 && whole > 10_000, "{stored} {whole}");
            let rho = parts.map(|p| {
                (0..p.grid().n_cells()).map(|i| if p.allowed().has(i) { f64::from(i as u32 % 4) / 3.0 } else { 0.0 })
            });
            let rho = rho.map(|values| values.collect::<Vec<_>>());
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + b.abs());
            let [m, w] = [&one, &all].map(|c| c.measures([&rho[0], &rho[1]], &workers).unwrap());
            assert!(near(m.g21, w.g21) && near(m.g12, w.g12) && w.g12 > 1e-6, "{m:?} {w:?}");
            for side in [Side::First, Side::Second] {
                let n = one.n_cells(side);
                let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
                one.local(side, &rho[side.other().index()], &mut a, &workers);
                all.local(side, &rho[side.other().index()], &mut b, &workers);
                assert!(a.iter().zip(&b).all(|(a, b)| near(*a, *b)));
            }
            let [a, b] = [&one, &all].map(|c| c.conflicts(1 << 30, &workers, &mut Progress::silent()).unwrap());
            assert!(a.n_edges() > 1000 && a.n_edges() == b.n_edges());
        }
    }
    // Where a turn does not slide by whole cells all are stored.
    let turns = |lead: f64| {
        let r = Relative { from: Motion::fixed(), of: screw(6.0, lead) };
        Correlation::new([&block, &bolt], &r, 606, 1 << 30, &workers, &mut Progress::silent()).unwrap().n_visits()
    };
    let (alike, other) = (turns(0.1 / TAU), turns(0.0971 / TAU));
    assert!(alike * 3 < other * 2, "{alike} {other}");
}

#[test]
fn one_period_has_the_conflicts_of_the_whole() {
    let (parts, [known, unknown]) = cam();
    assert_eq!((known.n_periods(), unknown.n_periods()), (3, 1));
    let grids = parts.each_ref().map(Part::grid);
    let steps = |r: &Relative<2>, s| r.bounded_steps(s, grids[0], grids[1], 0.0).unwrap();
    // 100 steps are no three times as many: there are more then.
    assert_eq!((steps(&known, Sampling::Steps(100)).len(), steps(&unknown, Sampling::Steps(102)).len()), (34, 102));
    let of_slack = steps(&known, Sampling::Slack(0.05));
    assert!(
        of_slack.iter().all(|s| s.time < 1.0 / 3.0)
            && (of_slack[of_slack.len() - 1].time + of_slack[0].half - 1.0 / 3.0).abs() < 1e-12
    );
    let (one, all) = (graph(&parts, &known, 100), graph(&parts, &unknown, 102));
    assert!(one.n_edges() > 1000 && one.n_edges() == all.n_edges(), "{} {}", one.n_edges(), all.n_edges());
    for i in 0..one.n_cells(Side::First) {
        let cell = Bits::of(one.n_cells(Side::First), |k| k == i).unwrap();
        assert_eq!(one.neighbours(Side::First, &cell).unwrap(), all.neighbours(Side::First, &cell).unwrap());
    }
}

#[test]
fn one_period_has_the_measures_of_the_whole_in_a_third_of_the_memory() {
    let (parts, relatives) = cam();
    let (pair, workers) = ([&parts[0], &parts[1]], Workers::caller_only());
    for n in [300, 100] {
        let of = |r| Correlation::new(pair, r, n, 1 << 30, &workers, &mut Progress::silent()).unwrap();
        let [one, all] = relatives.each_ref().map(of);
        assert_eq!((one.n_steps(), all.n_steps()), (n, n));
        // Only then do all periods have the same steps.
        if n == 300 {
            assert!(one.n_visits() * 5 < all.n_visits() * 2 && one.bytes() * 2 < all.bytes(), "{}", one.n_visits());
        } else {
            assert_eq!(one.n_visits(), all.n_visits());
        }
        let rho = [vec![1.0; 289], (0..289).map(|i| f64::from(i % 4) / 3.0).collect::<Vec<_>>()];
        let of = |c: &Correlation<2>| {
            let mut d = [[vec![0.0; 289], vec![0.0; 289]], [vec![0.0; 289], vec![0.0; 289]]];
            let [[a, b], [e, f]] = &mut d;
            c.sensitivities([&rho[0], &rho[1]], [[a, b], [e, f]], &workers).unwrap();
            d.concat().concat()
        };
        let (one, all) = (of(&one), of(&all));
        assert!(all.iter().any(|x| *x > 1e-5));
        assert!(one.iter().zip(&all).all(|(a, b)| (a - b).abs() < 1e-15), "{n}");
    }
}

#[test]
fn one_period_has_the_gaps_of_the_whole() {
    let (parts, relatives) = cam();
    let conflicts = graph(&parts, &relatives[0], 300);
    let room = parts.each_ref().map(|p| p.allowed().clone());
    let pair = close(&conflicts, &room, Side::First, &Bits::of(289, |i| i % 17 < 6).unwrap()).unwrap();
    let (grids, workers) = (parts.each_ref().map(Part::grid), Workers::caller_only());
    for n in [60, 50] {
        let of = |r| contact(grids, &pair, r, n, &workers, &mut Progress::silent()).unwrap();
        let [one, all] = relatives.each_ref().map(of);
        assert_eq!(one.gaps.len(), n);
        assert!((one.mean - all.mean).abs() < 1e-12 && one.largest > 0.01);
        for (a, b) in one.gaps.iter().zip(&all.gaps) {
            assert!((a.time - b.time).abs() < 1e-15 && (a.distance - b.distance).abs() < 1e-12, "{a:?} {b:?}");
        }
    }
}
