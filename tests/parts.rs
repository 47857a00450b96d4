//! Parts that were shaped together, as meshes in files and as fields.

use keepout::cogen::{
    Bits, BoundaryOptions, Conflicts, Grid, Law, Motion, OverlapOptions, Part, Relative, cut, mesh_of_cells, room,
};
use keepout::field::{Field, FitOptions, Outputs};
use keepout::geometry::Mesh;
use keepout::geometry::vec::norm;
use keepout::progress::Progress;

/// A ball and a box that a screw takes out of each other: the cells of the ball that a cut leaves.
fn part() -> (Grid<3>, Bits) {
    let of = |corner: f64, is_in: &dyn Fn([f64; 3]) -> bool| {
        Part::of_centers(Grid::new([corner; 3], 0.08, [20; 3]).expect("a grid"), is_in).expect("a part")
    };
    let parts = [of(-0.8, &|x| norm(x) < 0.75), of(-0.5, &|x| x[0] > 0.2)];
    let pair = [&parts[0], &parts[1]];
    let screw = Motion::screw([0.3, 0.0, 0.0], [0.0, 0.0, 1.0], 0.2, Law::even(2.0)).expect("a screw");
    let relative = Relative { from: Motion::fixed(), of: screw };
    let silent = &mut Progress::silent();
    let conflicts = Conflicts::of_overlap(pair, &relative, &OverlapOptions::default(), silent).expect("it fits");
    let room = room(&conflicts, pair, &relative).expect("nothing is frozen");
    // Part 1 counts for more: it stays large.
    let weights = [vec![3; 8000], vec![1; 8000]];
    let best = cut(&conflicts, &room, [&weights[0], &weights[1]], silent).expect("a cut");
    let [cells, _] = best.pair.cells;
    (*pair[0].grid(), cells)
}

#[test]
fn a_part_is_saved_and_fitted() {
    let (grid, cells) = part();
    assert!(cells.count() > 1000 && cells.count() < 4000, "{}", cells.count());
    let options = BoundaryOptions::default();
    let mesh = mesh_of_cells(&grid, &cells, &options, &mut Progress::silent()).expect("it has cells");
    assert!(mesh.report().expect("memory suffices").is_solid());
    let file = std::env::temp_dir().join(format!("keepout_part_{}.off", std::process::id()));
    mesh.write(&file).expect("it is written");
    let read = Mesh::<3>::read(&file).expect("it is read");
    std::fs::remove_file(&file).expect("it was there");
    let report = read.report().expect("memory suffices");
    assert!(report.is_solid() && report.n_facets == mesh.facets().len(), "{report}");

    let cloud = read.sample(20_000, 1).expect("it has area");
    let field = Field::fit(&cloud, &FitOptions::default(), &mut Progress::silent()).expect("the fit converges");
    // Outside of the part it is positive, inside negative: two cells from its surface.
    let tree = mesh.distance_tree().expect("memory suffices");
    let centers: Vec<[f64; 3]> = (0..grid.n_cells()).map(|i| grid.center(i)).collect();
    let mut distances = vec![0.0; centers.len()];
    tree.signed_distances(&centers, &mut distances).expect("as many");
    let mut values = vec![0.0; centers.len()];
    let outputs = Outputs { values: Some(&mut values), ..Outputs::default() };
    field.eval(&centers, outputs).expect("as many");
    let (mut n, mut wrong) = ([0; 2], 0);
    for (phi, distance) in values.iter().zip(distances).filter(|(_, d)| d.abs() > 0.16) {
        n[usize::from(distance > 0.0)] += 1;
        wrong += usize::from((*phi > 0.0) != (distance > 0.0));
    }
    assert!(n[0] > 100 && n[1] > 500 && wrong == 0, "{n:?}, {wrong} wrong");
}
