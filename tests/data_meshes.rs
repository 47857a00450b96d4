//! Every mesh of the test data reads as its PROVENANCE.md says, and every bad one fails as it should.

mod common;

use std::path::Path;

use keepout::Error;
use keepout::error::Place;
use keepout::geometry::{Mesh, MeshReport};

/// PROVENANCE.md counts parts that hang together through edges of exactly two triangles; the report lets any shared edge
/// connect. These two have thousands of edges with more: 1646 parts there are 12 here, and 1473 are 2.
const COMPONENTS_DIFFER: [&str; 2] = ["stanford/dragon_vrip_res2.ply.gz", "stanford/dragon_vrip_res3.ply.gz"];

/// These must fail: see [`bad_files_fail_at_the_place_that_is_wrong`].
const UNREADABLE: [&str; 2] = ["bad/truncated.off", "bad/nan_vertices.off"];

/// What a row of PROVENANCE.md says of a mesh.
#[derive(Debug)]
struct Row {
    file: String,
    n_vertices: usize,
    n_triangles: usize,
    closed: bool,
    boundary_edges: usize,
    non_manifold_edges: usize,
    oriented: bool,
    components: usize,
    degenerate: usize,
    /// Bounding box, where given.
    extents: Option<Vec<f64>>,
}

/// The rows of files that hold a mesh that the crate reads.
fn rows(dir: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(dir.join("PROVENANCE.md")).expect("PROVENANCE.md is readable");
    let cells = text.lines().filter(|line| line.starts_with("| ")).map(|line| line.split('|').map(str::trim).collect());
    cells.filter_map(|cells: Vec<&str>| row(&cells)).collect()
}

fn row(cells: &[&str]) -> Option<Row> {
    let number = |i: usize| cells[i].parse().ok();
    let (boundary, non_manifold) = cells[9].split_once('/')?;
    if cells[1].ends_with(".vtp") {
        return None;
    }
    Some(Row {
        file: cells[1].to_owned(),
        n_vertices: number(6)?,
        n_triangles: number(7)?,
        closed: cells[8] == "yes",
        boundary_edges: boundary.parse().ok()?,
        non_manifold_edges: non_manifold.parse().ok()?,
        oriented: cells[10] == "yes",
        components: number(11)?,
        degenerate: number(13)?,
        extents: cells[14].split(" x ").map(|x| x.parse().ok()).collect(),
    })
}

/// The ways in which a report differs from its row.
fn differences(row: &Row, report: &MeshReport) -> Vec<String> {
    let mut found = Vec::new();
    let mut compare = |what: &str, stated: usize, reported: usize| {
        if stated != reported {
            found.push(format!("{}: {what}: {stated} in PROVENANCE.md, {reported} here", row.file));
        }
    };
    compare("vertices", row.n_vertices, report.n_vertices);
    compare("triangles", row.n_triangles, report.n_facets);
    compare("boundary edges", row.boundary_edges, report.boundary_edges);
    compare("non-manifold edges", row.non_manifold_edges, report.non_manifold_edges);
    // There a mesh with a non-manifold edge is not called closed.
    compare("closed", row.closed.into(), (report.closed && report.non_manifold_edges == 0).into());
    compare("winding", row.oriented.into(), report.oriented.into());
    if !COMPONENTS_DIFFER.contains(&row.file.as_str()) {
        compare("components", row.components, report.components);
    }
    compare("degenerate", row.degenerate, report.degenerate_facets);
    let extents = report.bounds.extents();
    for (stated, reported) in row.extents.iter().flatten().zip(extents) {
        // The table gives four digits.
        if (stated - reported).abs() > 1e-3 * stated.abs() {
            found.push(format!("{}: box: {stated} in PROVENANCE.md, {reported} here", row.file));
        }
    }
    found
}

#[test]
fn meshes_read_as_their_provenance_says() {
    let Some(dir) = common::data_dir() else { return };
    let rows = rows(&dir);
    assert!(rows.len() > 30, "only {} meshes found in PROVENANCE.md", rows.len());
    let mut found = Vec::new();
    for row in rows.iter().filter(|row| !UNREADABLE.contains(&row.file.as_str())) {
        match Mesh::read(dir.join(&row.file)) {
            Ok(mesh) => found.extend(differences(row, &mesh.report().expect("memory suffices"))),
            Err(e) => found.push(e.to_string()),
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn bad_files_fail_at_the_place_that_is_wrong() {
    let Some(dir) = common::data_dir() else { return };
    let expected = [
        ("bad/empty.stl", Place::Whole, "empty"),
        ("bad/nan_vertices.off", Place::Line(13), "vertex 9 is (NaN, "),
        ("bad/truncated.obj", Place::Whole, "5548 vertices and 0 faces"),
        ("bad/truncated.off", Place::Line(6009), "ends before face 2109 of the 7798"),
        (
            "bad/truncated_binary.ply",
            Place::Byte(53_912),
            "a list of length 3 is announced, but the file ends 5 bytes later",
        ),
        ("bad/truncated_binary.stl", Place::Byte(249_342), "9972 triangles are announced, so 498684 bytes"),
    ];
    for (file, place, words) in expected {
        match Mesh::read(dir.join(file)) {
            Err(Error::Format { path, place: found, message }) => {
                assert_eq!((path, found), (dir.join(file), place), "{file}: {message}");
                assert!(message.contains(words), "{file}: {message}");
            }
            other => panic!("{file}: {other:?}"),
        }
    }
}

#[test]
fn bad_meshes_that_read_are_reported() {
    let Some(dir) = common::data_dir() else { return };
    let report = |file: &str| {
        Mesh::read(dir.join("bad").join(file)).expect("the file is readable").report().expect("memory suffices")
    };
    let text = report("degtri_sliding.off").to_string();
    assert!(text.contains("4 triangles without area"), "{text}");
    let text = report("quads_to_stitch.off").to_string();
    assert!(text.contains("20 boundary edges: open"), "{text}");
    // Self-intersection is no matter of edges: the report is silent on it.
    let crossed = report("tetra_intersected_by_triangle.off");
    assert_eq!((crossed.boundary_edges, crossed.components, crossed.manifold), (3, 2, true));
    let pig = report("pig.off");
    assert_eq!((pig.boundary_edges, pig.closed, pig.inside_out), (55, false, false));
}

#[test]
fn solids_are_right_side_out() {
    let Some(dir) = common::data_dir() else { return };
    for row in rows(&dir).iter().filter(|row| row.closed && !UNREADABLE.contains(&row.file.as_str())) {
        let report = Mesh::read(dir.join(&row.file)).expect("the file is readable").report().expect("memory suffices");
        assert!(!report.inside_out && report.volume > 0.0, "{}: {report}", row.file);
    }
}
