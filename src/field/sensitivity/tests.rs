//! What calls promise beside the derivatives themselves, which tests/sensitivity.rs compares with differences of refits.

use super::form::Form;
use super::*;
use crate::field::Outputs;
use crate::geometry::shapes::sphere;
use crate::geometry::vec::{add, norm, scale, sub};
use std::ops::ControlFlow;

fn options(n: u32) -> FitOptions {
    FitOptions { control_points: [n; 3], tolerance: 1e-12, n_threads: 1, ..FitOptions::default() }
}

fn ball(n: usize) -> Cloud {
    sphere([0.0; 3], 1.0, 3).unwrap().sample(n, 1).unwrap()
}

fn solved(ready: &mut Sensitivity, points: &[[f64; 3]], effort: Option<Effort>) -> [Vec<[f64; 3]>; 2] {
    let room = || vec![[f64::NAN; 3]; ready.n_points()];
    let (mut by_points, mut by_normals) = (room(), room());
    let to = Derivatives { points: Some(&mut by_points), normals: Some(&mut by_normals) };
    ready.solve(Functional { points, weights: None }, effort, to, &mut Progress::silent()).unwrap();
    [by_points, by_normals]
}

/// Grids large and smooth enough for a multigrid, on which later solves go on.
#[test]
fn solves_do_not_depend_on_those_before_nor_on_threads() {
    let cloud = ball(3000);
    let options = FitOptions { smooth_weight: 1e-12, distance_weight: 0.0, tolerance: 1e-8, ..options(17) };
    let field = Field::fit(&cloud, &options, &mut Progress::silent()).unwrap();
    let ready = || Sensitivity::new(&field, &cloud, &options, &mut Progress::silent()).unwrap();
    let places = [[0.9, 0.3, 0.1], [1.3, 0.2, -0.4], [0.1, 0.0, 0.2]];
    let mut many = ready();
    let in_turn: Vec<_> = places.iter().map(|p| solved(&mut many, &[*p], None)).collect();
    assert!(matches!(&many.form, Form::OneGrid(form) if form.has_multigrid()));
    for (place, before) in places.iter().zip(&in_turn) {
        let alone = solved(&mut ready(), &[*place], None);
        assert_eq!(&alone, before);
        let two = Effort { n_threads: 2, ..Effort::from(&options) };
        assert_eq!(solved(&mut ready(), &[*place], Some(two)), alone);
    }
    let together = solved(&mut many, &places, None);
    let largest = together[0].iter().fold(0.0, |m: f64, v| m.max(norm(*v)));
    for i in 0..cloud.len() {
        let sum = in_turn.iter().fold([0.0; 3], |sum, one| add(sum, one[0][i]));
        assert!(norm(sub(sum, together[0][i])) < 1e-5 * largest);
    }
}

#[test]
fn refined_solves_have_the_same_bits_on_any_number_of_threads() {
    let cloud = ball(900);
    let options = FitOptions { max_error: 1e-3, tolerance: 1e-8, ..options(8) };
    let field = Field::fit(&cloud, &options, &mut Progress::silent()).unwrap();
    assert!(field.is_refined());
    let on = |n_threads: u32| {
        let options = FitOptions { n_threads, ..options.clone() };
        let mut ready = Sensitivity::new(&field, &cloud, &options, &mut Progress::silent()).unwrap();
        solved(&mut ready, &[[1.1; 3], [0.5, 0.5, 5.0]], None)
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn a_field_that_moves_with_its_cloud_moves_its_values() {
    // J of a rigid move is that of the opposite move of the points, far away and near.
    let (cloud, options) = (ball(2000), FitOptions { tolerance: 1e-8, ..options(14) });
    let field = Field::fit(&cloud, &options, &mut Progress::silent()).unwrap();
    let mut ready = Sensitivity::new(&field, &cloud, &options, &mut Progress::silent()).unwrap();
    for x in [[1.05, 0.0, 0.0], [0.8, 0.5, 0.6], [0.3, -0.2, 0.1]] {
        let [by_points, _] = solved(&mut ready, &[x], None);
        let by_move = by_points.iter().fold([0.0; 3], |sum, v| add(sum, *v));
        let mut gradient = [[0.0; 3]];
        field.eval(&[x], Outputs { gradients: Some(&mut gradient), ..Outputs::default() }).unwrap();
        // Not exactly: the box and the cells stay where they are.
        assert!(norm(add(by_move, gradient[0])) < 0.15, "{by_move:?} {gradient:?}");
    }
}

#[test]
fn what_is_not_the_fit_is_refused() {
    let (cloud, options) = (ball(600), options(10));
    let field = Field::fit(&cloud, &options, &mut Progress::silent()).unwrap();
    let refused = |cloud: &Cloud, options: &FitOptions, words: &str| {
        let end = Sensitivity::new(&field, cloud, options, &mut Progress::silent()).map(|_| ());
        assert!(matches!(&end, Err(Error::InvalidArgument(text)) if text.contains(words)), "{end:?}");
    };
    refused(&ball(601), &options, "the field was fitted to 600 points, but 601");
    refused(&cloud, &FitOptions { smooth_weight: 6e-10, ..options.clone() }, "it is not their fit");
    refused(&cloud, &FitOptions { distance_weight: 0.0, ..options.clone() }, "it is not their fit");
    refused(&cloud, &FitOptions { tolerance: 2.0, ..options.clone() }, "tolerance is 2");
    let outside = cloud.points().iter().map(|p| scale(1.5, *p)).collect();
    refused(&Cloud::new(outside, cloud.normals().to_vec()).unwrap(), &options, "outside the field's box");
    let other = cloud.points().iter().map(|p| scale(0.99, *p)).collect();
    refused(&Cloud::new(other, cloud.normals().to_vec()).unwrap(), &options, "it is not their fit");
    let limited = FitOptions { memory_limit: 1 << 16, ..options.clone() };
    let end = Sensitivity::new(&field, &cloud, &limited, &mut Progress::silent()).map(|_| ());
    assert!(matches!(end, Err(Error::OutOfMemory { limit: Some(65536), .. })), "{end:?}");

    // What a field does not know any more it need not where nothing was reweighted.
    let plain = FitOptions { reweightings: 0, ..options };
    let field = Field::fit(&cloud, &plain, &mut Progress::silent()).unwrap().try_clone().unwrap();
    Sensitivity::new(&field, &cloud, &plain, &mut Progress::silent()).unwrap();
}

/// They hold distances by the spacing of their points, where a fit on one grid holds them by its cells.
#[test]
fn fits_that_might_have_cut_cells_are_known_again() {
    let (cloud, options) = (ball(600), FitOptions { max_error: 0.05, ..options(12) });
    let field = Field::fit(&cloud, &options, &mut Progress::silent()).unwrap();
    assert!(!field.is_refined());
    Sensitivity::new(&field, &cloud, &options, &mut Progress::silent()).unwrap();
}

#[test]
fn wrong_arguments_of_solves_are_named_and_solves_are_cancelled() {
    let (cloud, options) = (ball(600), options(10));
    let field = Field::fit(&cloud, &options, &mut Progress::silent()).unwrap();
    let mut ready = Sensitivity::new(&field, &cloud, &options, &mut Progress::silent()).unwrap();
    let mut stop =
        |_: f64, stage: &str| if stage == "solve" { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let at = [[0.9, 0.0, 0.0]];
    let mut room = vec![[0.0; 3]; 600];
    let mut tried = |points: &[[f64; 3]], weights: Option<&[f64]>, effort: Option<Effort>, progress: &mut Progress| {
        let to = Derivatives { points: Some(&mut room), normals: None };
        ready.solve(Functional { points, weights }, effort, to, progress)
    };
    let silent = &mut Progress::silent();
    assert_eq!(tried(&at, None, None, &mut Progress::new(&mut stop)), Err(Error::Cancelled));
    let text = |end: Result<()>| end.unwrap_err().to_string();
    assert!(text(tried(&at, Some(&[1.0, 2.0]), None, silent)).contains("1 points come with 2 weights"));
    assert!(text(tried(&at, Some(&[f64::NAN]), None, silent)).contains("weight 0 is NaN"));
    assert!(text(tried(&[at[0], [f64::INFINITY; 3]], None, None, silent)).contains("point 1 is"));
    let few = Effort { max_iterations: 3, ..Effort::from(&options) };
    assert!(matches!(tried(&at, None, Some(few), silent), Err(Error::NotConverged { iterations: 3, .. })));
    // No points: J is 0.
    tried(&[], None, None, silent).unwrap();
    assert!(room.iter().all(|v| *v == [0.0; 3]));
    let to = Derivatives { points: None, normals: Some(&mut room[1..]) };
    let end = ready.solve(Functional { points: &at, weights: None }, None, to, silent);
    assert!(text(end).contains("by normals have room for 599 points"));
}
