//! Refined fields of real shapes: thin parts are there, inside and outside, where the exact distance has them.

mod common;

use keepout::field::{Field, FitOptions, Outputs};
use keepout::geometry::Mesh;
use keepout::progress::Progress;

/// Levels, in D, that are looked at: of the shape, and of what is a little smaller and larger.
const LEVELS: [f64; 5] = [-0.01, -0.005, 0.0, 0.005, 0.01];

/// How much nearer to a level than this, in D, the exact distance may be for phi to be on its other side: near the medial axis of an ear phi
/// is smooth where the distance has a kink.
const SLACK: f64 = 4e-3;

#[test]
fn the_bunny_has_its_ears_in_level_sets_inside_and_outside() {
    let Some(dir) = common::data_dir() else { return };
    let mesh = Mesh::<3>::read(dir.join("stanford/bunny_lsdo_genie.stl")).unwrap();
    let d = mesh.bounds().diagonal();
    let options = FitOptions { max_error: 1e-3, tolerance: 1e-3, ..FitOptions::default() };
    let field = Field::fit(&mesh.sample(50_000, 1).unwrap(), &options, &mut Progress::silent()).unwrap();
    assert!(field.report().max <= 1e-3 && field.is_refined(), "{:?}", field.report());

    // Around other samples, up to twice the largest level away along each axis.
    let places = mesh.sample(60_000, 5).unwrap();
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let points: Vec<[f64; 3]> = places.points().iter().map(|p| p.map(|x| x + 0.02 * d * random())).collect();
    let (mut exact, mut phi) = (vec![0.0; points.len()], vec![0.0; points.len()]);
    mesh.distance_tree().unwrap().signed_distances(&points, &mut exact).unwrap();
    field.eval(&points, Outputs { values: Some(&mut phi), ..Outputs::default() }).unwrap();
    for level in LEVELS {
        let beyond = exact.iter().filter(|e| (*e / d - level).abs() > SLACK).count();
        assert!(beyond > points.len() / 2);
        for ((p, e), phi) in points.iter().zip(&exact).zip(&phi) {
            let (e, phi) = (e / d - level, phi / d - level);
            assert!(e.abs() <= SLACK || (e > 0.0) == (phi > 0.0), "level {level} D at {p:?}: {phi:e} for {e:e}");
        }
    }
}
