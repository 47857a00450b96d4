//! What is too large, and what has no answer.

use super::bits::Bits;
use super::closure::{close, room};
use super::conflict::{Conflicts, OverlapOptions, Side};
use super::contact::contact;
use super::correlation::Correlation;
use super::cut::cut;
use super::family::{FamilyOptions, family};
use super::grid::Grid;
use super::motion::{Law, Motion};
use super::optimise::{Design, OptimiseOptions, optimise};
use super::part::Part;
use super::steps::Relative;
use crate::Error;
use crate::par::Workers;
use crate::progress::Progress;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Two squares of about 1 that turn against each other, with cells of these edges.
fn gears(cells: [f64; 2]) -> ([Part<2>; 2], Relative<2>) {
    let square = |x: f64, eps: f64| {
        let n = (1.0 / eps) as usize;
        Part::whole(Grid::new([x - 0.5, -0.5], eps, [n, n]).unwrap()).unwrap()
    };
    let turn = |x: f64, turns: f64| Motion::turn([x, 0.0], Law::even(turns * TAU)).unwrap();
    ([square(0.0, cells[0]), square(1.0, cells[1])], Relative { from: turn(0.0, 1.0), of: turn(1.0, -1.0) })
}

/// The bytes that the error tells of, the cells and the steps that it offers.
fn told(error: &Error, share: u64) -> (f64, [f64; 2], Option<usize>) {
    let Error::OutOfMemory { bytes, limit: Some(limit), what } = error else { panic!("{error}") };
    assert_eq!(*limit, u128::from(share));
    let (_, cells) = what.split_once("times as large (").unwrap();
    let (cells, rest) = cells.split_once(')').unwrap();
    let cells: Vec<f64> = cells.split(" and ").map(|x| x.parse().unwrap()).collect();
    let steps = rest.split_once("or with ").map(|(_, n)| n.split_once(' ').unwrap().0.parse().unwrap());
    (*bytes as f64, [cells[0], cells[1]], steps)
}

#[test]
fn a_graph_that_would_not_fit_is_refused_before_it_is_made_and_what_would_fit_does() {
    let of = |cells: [f64; 2], max_bytes: u64| {
        let (parts, relative) = gears(cells);
        let options = OverlapOptions { max_bytes, ..OverlapOptions::default() };
        let mut begun = false;
        let mut listen = |_: f64, _: &str| {
            begun = true;
            ControlFlow::Continue(())
        };
        let made = Conflicts::of_overlap([&parts[0], &parts[1]], &relative, &options, &mut Progress::new(&mut listen));
        (made.map(|g| g.bytes()), begun)
    };
    let cells = [0.0125, 0.01];
    let whole = of(cells, 1 << 30).0.unwrap() as u64;
    for share in [whole / 2, whole / 9] {
        let (error, begun) = of(cells, share);
        let (bytes, fitting, _) = told(&error.unwrap_err(), share);
        assert!(!begun && (bytes / whole as f64 - 1.0).abs() < 0.05, "{bytes} {whole}");
        let (made, _) = of(fitting, share);
        // The offer is no waste either.
        assert!(made.unwrap() as u64 > share / 2, "{fitting:?}");
    }
    // What fits by a little is not refused, nor what no sample tells of beforehand.
    assert!(of(cells, whole + whole / 100).0.is_ok());
    let (error, begun) = of(cells, whole - whole / 200);
    assert!(begun && told(&error.unwrap_err(), whole - whole / 200).1[0] > cells[0]);
}

#[test]
fn trajectories_that_would_not_fit_are_refused_before_they_are_made_and_what_would_fit_does() {
    let workers = Workers::new(2).unwrap();
    let of = |cells: [f64; 2], n: usize, max_bytes: u64| {
        let (parts, relative) = gears(cells);
        let mut begun = false;
        let mut listen = |_: f64, _: &str| {
            begun = true;
            ControlFlow::Continue(())
        };
        let progress = &mut Progress::new(&mut listen);
        let made = Correlation::new([&parts[0], &parts[1]], &relative, n, max_bytes, &workers, progress);
        (made.map(|c| c.bytes()), begun)
    };
    let cells = [0.0125, 0.01];
    let whole = of(cells, 500, 1 << 30).0.unwrap() as u64;
    for share in [whole / 2, whole / 5] {
        let (error, begun) = of(cells, 500, share);
        let (bytes, fitting, steps) = told(&error.unwrap_err(), share);
        assert!(!begun && (bytes / whole as f64 - 1.0).abs() < 0.05, "{bytes} {whole}");
        assert!(of(fitting, 500, share).0.unwrap() as u64 > share / 3);
        let steps = steps.unwrap();
        assert!(steps < 500 && of(cells, steps, share).0.unwrap() as u64 > share / 2, "{steps}");
    }
    // The ends of rows alone are more than this: no number of steps is offered.
    let (error, _) = of(cells, 500, 30_000);
    assert_eq!(told(&error.unwrap_err(), 30_000).2, None);
}

#[test]
fn graphs_of_the_measure_keep_to_their_bytes() {
    let (parts, relative) = gears([0.02, 0.02]);
    let (workers, silent) = (Workers::new(2).unwrap(), &mut Progress::silent());
    let correlation = Correlation::new([&parts[0], &parts[1]], &relative, 100, 1 << 30, &workers, silent).unwrap();
    let whole = correlation.conflicts(1 << 30, &workers, silent).unwrap();
    let by_visits = 4 * correlation.n_visits() as u64;
    // Visits alone are more; with them there is room for some rows.
    for most in [by_visits / 2, by_visits + whole.bytes() as u64 / 2] {
        let mut begun = false;
        let mut listen = |_: f64, _: &str| {
            begun = true;
            ControlFlow::Continue(())
        };
        let error = correlation.conflicts(most, &workers, &mut Progress::new(&mut listen)).unwrap_err();
        let Error::OutOfMemory { bytes, limit: Some(limit), what } = error else { panic!("{error}") };
        assert!(!begun && limit <= u128::from(most) && bytes > limit, "{bytes} {limit}");
        assert!(what.contains("would fit with cells about 1."), "{what}");
    }
    let again = correlation.conflicts(2 * (by_visits + whole.bytes() as u64), &workers, silent).unwrap();
    assert_eq!(again.n_edges(), whole.n_edges());
}

#[test]
fn grids_that_never_meet_keep_every_cell_and_say_so() {
    let part = |x: f64| Part::whole(Grid::new([x, 0.0], 0.1, [10, 10]).unwrap()).unwrap();
    let parts = [part(0.0), part(5.0)];
    let (pair, workers) = ([&parts[0], &parts[1]], Workers::caller_only());
    let turn = Motion::turn([0.5, 0.5], Law::even(TAU)).unwrap();
    let relative = Relative { from: turn, of: Motion::fixed() };
    let silent = &mut Progress::silent();
    let correlation = Correlation::new(pair, &relative, 50, 1 << 20, &workers, silent).unwrap();
    let by_measure = correlation.conflicts(1 << 30, &workers, &mut Progress::silent()).unwrap();
    let by_overlap = Conflicts::of_overlap(pair, &relative, &OverlapOptions::default(), silent).unwrap();
    for conflicts in [&by_overlap, &by_measure] {
        assert!(conflicts.is_empty());
        let room = room(conflicts, pair, &relative).unwrap();
        let all = |cells: &[Bits; 2]| cells.iter().all(|c| c.count() == 100);
        assert!(all(&close(conflicts, &room, Side::First, &Bits::none(100).unwrap()).unwrap().cells));
        let weights = [vec![1; 100], vec![2; 100]];
        let best = cut(conflicts, &room, [&weights[0], &weights[1]], silent).unwrap();
        assert!(all(&best.pair.cells) && (best.weight, best.bound) == (300, 300));
        let options = FamilyOptions::default();
        for member in family(conflicts, &room, [&weights[0], &weights[1]], &[0.0, 0.5, 1.0], &options, silent).unwrap()
        {
            assert!(all(&member.pair.cells) && member.gamma.is_nan() && member.bound == 0.0);
        }
        let design = Design { correlation: &correlation, conflicts, room: &room, frozen: pair.map(|p| p.frozen()) };
        let found = optimise(&design, &OptimiseOptions::default(), &workers, silent).unwrap();
        assert!(all(&found.pair.cells) && found.gamma.is_nan() && found.converged);
        let gaps = contact(pair.map(Part::grid), &found.pair, &relative, 20, &workers, silent).unwrap();
        assert!((gaps.largest - (4.5 - 0.5_f64.sqrt())).abs() < 0.5 && gaps.mean > 3.0);
    }
}

#[test]
fn gammas_out_of_range_are_refused() {
    let (parts, relative) = gears([0.1, 0.1]);
    let (pair, workers, silent) = ([&parts[0], &parts[1]], Workers::caller_only(), &mut Progress::silent());
    let correlation = Correlation::new(pair, &relative, 50, 1 << 20, &workers, silent).unwrap();
    let conflicts = correlation.conflicts(1 << 30, &workers, &mut Progress::silent()).unwrap();
    let room = room(&conflicts, pair, &relative).unwrap();
    let weights = [vec![1; room[0].len()], vec![1; room[1].len()]];
    let design =
        Design { correlation: &correlation, conflicts: &conflicts, room: &room, frozen: pair.map(|p| p.frozen()) };
    for gamma in [-0.1, 1.1, f64::NAN] {
        let options = FamilyOptions::default();
        let told = family(&conflicts, &room, [&weights[0], &weights[1]], &[0.5, gamma], &options, silent).unwrap_err();
        assert_eq!(told.to_string(), format!("gamma 1 is {gamma}; it must be in [0, 1]"));
        let options = OptimiseOptions { gamma, ..OptimiseOptions::default() };
        let told = optimise(&design, &options, &workers, silent).unwrap_err();
        assert_eq!(told.to_string(), format!("gamma is {gamma}; it must be in [0, 1]"));
    }
}
