//! Fits that go on by multigrid: the field is that of the diagonal alone, and ends are told as without it.

use super::*;
use crate::geometry::Cloud;
use crate::geometry::shapes::{circle, torus};
use crate::progress::Progress;
use std::ops::ControlFlow;

/// Options with which the diagonal alone would take hundreds of iterations, as many unknowns as a multigrid serves and more.
fn options(control_points: [u32; 3]) -> FitOptions {
    FitOptions {
        control_points,
        distance_weight: 0.0,
        reweightings: 0,
        tolerance: 1e-11,
        n_threads: 1,
        ..FitOptions::default()
    }
}

/// The same with room for all but a multigrid.
fn by_diagonal<const D: usize>(cloud: &Cloud<D>, options: &FitOptions) -> FitOptions {
    let shape = std::array::from_fn::<u128, D, _>(|a| options.control_points[a].into());
    FitOptions { memory_limit: fit::memory(cloud.len() as u128, shape) as u64, ..options.clone() }
}

fn ring() -> Cloud {
    torus(1.0, 0.4, 60, 30).unwrap().sample(1500, 1).unwrap()
}

fn check_same<const D: usize>(cloud: &Cloud<D>, options: &FitOptions) {
    let fit = |options: &FitOptions| Field::fit(cloud, options, &mut Progress::silent()).unwrap();
    let (with, without) = (fit(options), fit(&by_diagonal(cloud, options)));
    let (fast, slow) = (with.report(), without.report());
    assert!(fast.iterations < 100 && slow.iterations > 150, "{} {}", fast.iterations, slow.iterations);
    assert!(fast.residual <= options.tolerance && slow.residual <= options.tolerance);
    assert!(fast.convergence_rate < 0.7 && slow.convergence_rate > 0.8, "{fast:?} {slow:?}");
    let size = without.coefficients().iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let apart = with.coefficients().iter().zip(without.coefficients()).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    // The residual bounds the error but for the condition, some 1e6.
    assert!(apart < 1e-5 * size, "{apart:e} of {size:e}");
}

#[test]
fn with_and_without_room_for_a_multigrid_the_field_is_the_same() {
    check_same(&ring(), &options([18, 17, 16]));
    check_same(&circle([0.0; 2], 1.0, 200).unwrap().sample(300, 1).unwrap(), &options([66, 63, 0]));
}

#[test]
fn fits_of_fewer_unknowns_take_none() {
    let (cloud, options) = (ring(), options([16, 16, 15]));
    let fit = |options: &FitOptions| Field::fit(&cloud, options, &mut Progress::silent()).unwrap();
    assert_eq!(fit(&options).coefficients(), fit(&by_diagonal(&cloud, &options)).coefficients());
}

/// Fits, and stops after `last` iterations; and how many there were.
fn fit_until(cloud: &Cloud, options: &FitOptions, last: usize) -> (Result<Field>, usize) {
    let mut iterations = 0;
    let mut stop = |_: f64, stage: &str| {
        iterations += usize::from(stage == "solve");
        if iterations == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let end = Field::fit(cloud, options, &mut Progress::new(&mut stop));
    (end, iterations)
}

#[test]
fn a_multigrid_is_stopped_where_it_is_asked_to_and_at_the_limit_of_iterations() {
    let (cloud, options) = (ring(), options([18, 17, 16]));
    let (end, all) = fit_until(&cloud, &options, usize::MAX);
    assert_eq!(end.unwrap().report().iterations as usize, all);
    // The diagonal ends at the first look, after 16; what follows is the multigrid's.
    assert!(all > 26, "{all}");
    for last in [16, all - 10, all - 1] {
        let (end, done) = fit_until(&cloud, &options, last);
        assert_eq!((end.unwrap_err(), done), (Error::Cancelled, last));
        let short = FitOptions { max_iterations: last as u32, ..options.clone() };
        let (end, done) = fit_until(&cloud, &short, usize::MAX);
        assert!(matches!(end, Err(Error::NotConverged { iterations, .. }) if iterations == last) && done == last);
    }
}
