use super::super::vec::Vec3;
use super::*;

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

fn points(offset: f64, size: f64) -> Vec<Vec3> {
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|p| p.map(|x| offset + size * x)).to_vec()
}

fn report(vertices: Vec<Vec3>, triangles: &[[u32; 3]]) -> MeshReport {
    Mesh::new(vertices, triangles.to_vec()).expect("indices are in range").report().unwrap()
}

#[test]
fn a_tetrahedron_is_a_solid() {
    let r = report(points(0.0, 1.0), &TETRAHEDRON);
    assert!(r.closed && r.oriented && r.manifold && !r.inside_out);
    assert_eq!((r.n_vertices, r.n_facets, r.components, r.boundary_edges), (4, 4, 1, 0));
    assert!((r.volume - 1.0 / 6.0).abs() < 1e-15);
    assert!((r.area - (1.5 + 0.75_f64.sqrt())).abs() < 1e-15);
    assert!(r.to_string().ends_with("closed, oriented, manifold: a solid\n"), "{r}");
}

#[test]
fn turned_over_it_is_inside_out() {
    let mut mesh = Mesh::new(points(0.0, 1.0), TETRAHEDRON.to_vec()).expect("indices are in range");
    mesh.flip();
    let r = mesh.report().unwrap();
    assert!(r.closed && r.oriented && r.inside_out && r.volume < 0.0);
    assert!(r.to_string().contains("inside out: flip it"), "{r}");
    mesh.flip();
    assert!(!mesh.report().unwrap().inside_out);
}

#[test]
fn one_and_two_triangles_are_open() {
    let r = report(points(0.0, 1.0), &[[0, 1, 2]]);
    assert_eq!((r.closed, r.manifold, r.boundary_edges, r.unreferenced_vertices), (false, true, 3, 1));
    assert_eq!(r.bounds.max, [1.0, 1.0, 0.0]);
    let r = report(points(0.0, 1.0), &[[0, 1, 2], [1, 2, 3]]);
    assert_eq!((r.boundary_edges, r.oriented, r.components), (4, false, 1));
    assert!(r.to_string().contains("winding: neighbouring triangles disagree"), "{r}");
}

#[test]
fn solids_that_touch_at_a_vertex_are_two_parts() {
    let mut vertices = points(0.0, 1.0);
    vertices.extend(&points(0.0, -1.0)[1..]);
    let second = TETRAHEDRON.map(|t| t.map(|v| if v == 0 { 0 } else { v + 3 }));
    let r = report(vertices, &[TETRAHEDRON, second].concat());
    assert_eq!((r.closed, r.manifold, r.components), (true, false, 2));
    assert_eq!((r.non_manifold_vertices, r.non_manifold_edges), (1, 0));
}

#[test]
fn three_triangles_at_an_edge_are_no_manifold() {
    let mut vertices = points(0.0, 1.0);
    vertices.push([0.5, -1.0, -1.0]);
    let r = report(vertices, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert_eq!((r.non_manifold_edges, r.non_manifold_vertices, r.components), (1, 2, 1));
    assert_eq!((r.boundary_edges, r.manifold, r.closed), (6, false, false));
}

#[test]
fn flat_and_repeated_triangles_are_counted() {
    let line = vec![[0.0; 3], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0]];
    let r = report(line, &[[0, 1, 2], [2, 1, 0], [0, 0, 1]]);
    assert_eq!((r.degenerate_facets, r.duplicate_facets, r.area), (3, 1, 0.0));
    // Nothing but triangles folded onto an edge bounds nothing.
    let r = report(vec![[2.0; 3]], &[[0, 0, 0]]);
    assert_eq!((r.closed, r.components, r.degenerate_facets, r.volume), (false, 0, 1, 0.0));
}

#[test]
fn the_size_of_the_mesh_does_not_matter() {
    for size in [1e-100, 1e-30, 1.0, 1e30, 1e100] {
        let r = report(points(0.0, size), &TETRAHEDRON);
        assert!(r.closed && r.manifold && r.degenerate_facets == 0, "{size}: {r}");
        assert!((r.volume / size.powi(3) - 1.0 / 6.0).abs() < 1e-14, "{size}: {r}");
    }
    // Beyond the range of f64 the numbers go, the judgement stays.
    for size in [1e-320, 1e-300, 1e300, f64::MAX] {
        let r = report(points(0.0, size), &TETRAHEDRON);
        assert_eq!((r.degenerate_facets, r.inside_out), (0, false), "{size}: {r}");
    }
    let r =
        report([[-1.0; 3], [1.0, -1.0, 0.0], [0.0, 1.0, 1.0]].map(|p| p.map(|x| x * f64::MAX)).to_vec(), &[[0, 1, 2]]);
    assert_eq!(r.degenerate_facets, 0);
}

#[test]
fn far_from_the_origin_the_volume_stays() {
    let r = report(points(1e6, 1.0), &TETRAHEDRON);
    assert!((r.volume - 1.0 / 6.0).abs() < 1e-9, "{r}");
}

/// Report of the curves through a unit square's corners, from 0 around it, then through those of one of half its width around its centre.
fn squares(segments: &[[u32; 2]]) -> MeshReport<2> {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let points = [0.5, 0.25].into_iter().flat_map(|r| square.map(|p| [3.0 + r * p[0], r * p[1]])).collect();
    Mesh::new(points, segments.to_vec()).expect("indices are in range").report().unwrap()
}

const SQUARE: [[u32; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];

#[test]
fn a_square_with_a_hole_is_a_solid_of_the_plane() {
    let hole = SQUARE.map(|[a, b]| [b + 4, a + 4]);
    let r = squares(&[SQUARE, hole].concat());
    assert!(r.is_solid() && r.manifold && !r.inside_out, "{r}");
    assert_eq!((r.n_vertices, r.n_facets, r.components, r.boundary_edges), (8, 8, 2, 0));
    assert_eq!((r.area, r.volume, r.bounds.min), (6.0, 0.75, [2.5, -0.5]));
    let text = "8 vertices, 8 segments, 2 components; box 1.0000e0 x 1.0000e0; length 6.000000e0, area 7.500000e-1";
    assert_eq!(r.to_string(), format!("{text}\nclosed, oriented, manifold: a solid\n"));
    let r = squares(&hole);
    assert!(r.closed && r.inside_out && r.volume == -0.25, "{r}");
    assert!(r.to_string().contains("inside out: flip it\n4 vertices that no segment uses: harmless"), "{r}");
}

#[test]
fn what_is_wrong_with_curves_is_counted() {
    // The square is open, one of its segments runs against the others, one comes twice, and two have no length.
    let r = squares(&[[0, 1], [1, 2], [3, 2], [4, 5], [5, 4], [7, 7]]);
    assert!(!r.closed && !r.oriented && r.manifold && !r.is_solid());
    assert_eq!((r.boundary_edges, r.components, r.degenerate_facets, r.duplicate_facets), (2, 2, 1, 1));
    let text = r.to_string();
    for remark in [
        "winding: neighbouring segments disagree; orient them alike",
        "2 end points: open; join them if a solid is meant",
        "1 segments without length: harmless for sampling, better removed",
        "1 segments given more than once: remove the copies",
    ] {
        assert!(text.contains(remark), "{text}");
    }
    // Two loops that share a vertex: closed, but no manifold.
    let r = squares(&[[0, 1], [1, 4], [4, 0], [4, 5], [5, 6], [6, 4]]);
    assert_eq!((r.closed, r.manifold, r.components), (true, false, 1));
    assert_eq!((r.non_manifold_edges, r.non_manifold_vertices), (1, 1));
    let remark = "1 vertices with more than two segments: give each curve a vertex of its own\n";
    assert!(r.to_string().contains(remark) && !r.to_string().contains("fans"), "{r}");
}

#[test]
fn the_size_of_a_curve_does_not_matter() {
    for size in [1e-300, 1e-150, 1e150, 1e300] {
        let points = vec![[0.0, 0.0], [size, 0.0], [0.0, size], [0.0, size]];
        let r = Mesh::new(points, vec![[0, 1], [1, 2], [2, 3], [3, 0]]).unwrap().report().unwrap();
        assert!((r.area / size - 2.0 - 2.0_f64.sqrt()).abs() < 1e-14, "{size}: {r}");
        assert!(r.is_solid() && r.degenerate_facets == 1, "{size}: {r}");
    }
}
