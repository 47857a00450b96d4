//! The curves of the test data are boundaries of solids: closed, oriented, and clear of themselves.

mod common;

use std::path::Path;

use keepout::geometry::{DistanceTree, Ends, Mesh, MeshReport};

/// Airfoils: points, segments, and the area by the shoelace formula. Two have trailing edges of a height, two end where they start.
const AIRFOILS: [(&str, usize, usize, f64); 4] = [
    ("clarky.dat", 121, 121, 0.0809371020),
    ("naca0012.dat", 69, 69, 0.0820949023),
    ("rae2822.dat", 129, 128, 0.0778430319),
    ("s1223.dat", 300, 299, 0.0649204632),
];

/// Segments and area of the site.
const SITE: (usize, f64) = (18, 14079886.055);

/// The points of an airfoil: a line of title, then x and y a line, from the trailing edge over the upper side around to it again, which is
/// counter-clockwise: in all four files.
fn airfoil(path: &Path) -> Vec<[f64; 2]> {
    let text = std::fs::read_to_string(path).expect("the airfoil is readable");
    let number = |x: &str| x.parse::<f64>().ok();
    let point = |line: &str| {
        let mut numbers = line.split_whitespace().map_while(number);
        Some([numbers.next()?, numbers.next()?])
    };
    text.lines().skip(1).filter_map(point).collect()
}

/// The corners of the wind farm's site: lines like `- [10363.8,  6490.3]`, clockwise.
fn site(path: &Path) -> Vec<[f64; 2]> {
    let text = std::fs::read_to_string(path).expect("the boundary is readable");
    let boundaries = text.split_once("boundaries:").expect("the file has boundaries").1;
    let point = |line: &str| {
        let (x, y) = line.trim().strip_prefix("- [")?.strip_suffix(']')?.split_once(',')?;
        Some([x.trim().parse().ok()?, y.trim().parse().ok()?])
    };
    boundaries.lines().filter_map(point).collect()
}

fn loop_of(points: &[[f64; 2]]) -> (Mesh<2>, MeshReport<2>) {
    let mesh = Mesh::from_polylines(points.to_vec(), &[0], Ends::Closed).expect("the loop is simple");
    let report = mesh.report().expect("memory suffices");
    assert!(report.closed && report.oriented && report.manifold && report.components == 1, "{report}");
    (mesh, report)
}

#[test]
fn airfoils_are_counter_clockwise_solids() {
    let Some(dir) = common::data_dir() else { return };
    for (name, n_points, n_segments, area) in AIRFOILS {
        let points = airfoil(&dir.join("curves2d").join(name));
        assert_eq!(points.len(), n_points, "{name}");
        let (mesh, report) = loop_of(&points);
        assert!(report.is_solid(), "{name}: {report}");
        assert_eq!(report.n_facets, n_segments, "{name}");
        assert!((report.volume - area).abs() < 1e-9, "{name}: {report}");
        let tree = DistanceTree::new(&mesh).expect("memory suffices");
        let mut distances = [0.0; 2];
        tree.signed_distances(&[[0.3, 0.05], [0.3, 0.5]], &mut distances).expect("the points are finite");
        assert!(distances[0] < 0.0 && distances[1] > 0.3, "{name}: {distances:?}");
    }
}

#[test]
fn the_site_of_the_wind_farm_is_a_loop() {
    let Some(dir) = common::data_dir() else { return };
    let (mut mesh, report) = loop_of(&site(&dir.join("curves2d/iea37-boundary-cs3.yaml")));
    assert!(report.inside_out && report.n_facets == SITE.0, "{report}");
    assert!((report.volume + SITE.1).abs() < 1e-6 * SITE.1, "{report}");
    mesh.flip();
    assert!(mesh.report().expect("memory suffices").is_solid());
}
