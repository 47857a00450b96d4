//! Level 0 of fields fitted to real shapes has the topology of the shape: as many parts, as many handles, no hole.

mod common;

use keepout::field::{Feasible, Field, FitOptions, LevelSetOptions};
use keepout::geometry::{Mesh, MeshReport};
use keepout::progress::Progress;
use std::path::Path;

/// Parts and V - E + F of a closed mesh.
fn topology(report: &MeshReport) -> (usize, i64) {
    let vertices = (report.n_vertices - report.unreferenced_vertices) as i64;
    (report.components, vertices - report.n_facets as i64 / 2)
}

fn fit(mesh: &Mesh, n_points: usize, options: &FitOptions) -> Field {
    let cloud = mesh.sample(n_points, 1).expect("the mesh has area");
    Field::fit(&cloud, options, &mut Progress::silent()).expect("the fit converges")
}

fn zero_set(field: &Field, options: &LevelSetOptions) -> (MeshReport, usize) {
    let set = field.level_set(0.0, options, &mut Progress::silent()).expect("level 0 is reached");
    let boundary = set.boundary();
    (set.into_mesh().expect("it has facets").report().expect("memory suffices"), boundary)
}

fn check(dir: &Path, file: &str, n_points: usize, feasible: Feasible, expected: (usize, i64)) {
    let mesh = Mesh::read(dir.join(file)).expect("the file is readable");
    assert_eq!(topology(&mesh.report().expect("memory suffices")), expected, "{file}: the mesh itself");
    let field = fit(&mesh, n_points, &FitOptions { feasible, ..FitOptions::default() });
    let (report, boundary) = zero_set(&field, &LevelSetOptions::default());
    assert_eq!((topology(&report), boundary), (expected, 0), "{file}: {report}");
    assert!(report.is_solid() && report.unreferenced_vertices == 0, "{file}: {report}");
}

#[test]
fn the_bunny_is_one_ball_from_either_side() {
    let Some(dir) = common::data_dir() else { return };
    check(&dir, "stanford/bunny_lsdo_genie.stl", 25_000, Feasible::Outside, (1, 2));
    check(&dir, "stanford/bunny_lsdo_genie.stl", 40_000, Feasible::Inside, (1, 2));
}

#[test]
fn the_rotor_has_one_handle() {
    let Some(dir) = common::data_dir() else { return };
    // Its blades are thinner than half a cell of a field of 25,000 points, which gains a handle there.
    check(&dir, "mechanical/rotor.off", 40_000, Feasible::Outside, (1, 0));
}

#[test]
fn the_double_torus_has_two_handles() {
    let Some(dir) = common::data_dir() else { return };
    check(&dir, "mechanical/double-torus.off", 25_000, Feasible::Outside, (1, -2));
}

#[test]
fn the_armadillo_is_one_ball() {
    let Some(dir) = common::data_dir() else { return };
    check(&dir, "stanford/armadillo_cgal.off", 40_000, Feasible::Outside, (1, 2));
}

#[test]
fn the_femur_has_two_handles_and_voids_of_the_field() {
    let Some(dir) = common::data_dir() else { return };
    let mesh = Mesh::read(dir.join("anatomy/femur_cgal.off")).expect("the file is readable");
    let (report, boundary) = zero_set(&fit(&mesh, 25_000, &FitOptions::default()), &LevelSetOptions::default());
    assert!(report.is_solid() && boundary == 0, "{report}");
    // The field has voids in the bone, within a cell or so of its surface: parts of phi's zero set, though not of the mesh. They are
    // balls; what is beside them has the mesh's handles.
    let (parts, euler) = topology(&report);
    assert_eq!(euler - 2 * (parts as i64 - 1), topology(&mesh.report().expect("memory suffices")).1, "{report}");
}
