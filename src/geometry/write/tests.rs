use super::*;
use crate::geometry::shapes::{sphere, torus};
use crate::geometry::vec::Vec3;
use proptest::prelude::*;
use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A folder that goes with the test.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let dir = std::env::temp_dir().join(format!("keepout-write-{}-{n}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        Folder(dir)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn bits(mesh: &Mesh) -> (Vec<[u64; 3]>, &[[u32; 3]]) {
    (mesh.vertices().iter().map(|v| v.map(f64::to_bits)).collect(), mesh.triangles())
}

fn through(mesh: &Mesh, name: &str) -> Mesh {
    let folder = Folder::new();
    mesh.write(folder.0.join(name)).unwrap();
    Mesh::read(folder.0.join(name)).unwrap()
}

#[test]
fn text_and_ply_give_the_same_bits_back() {
    let mesh = torus(1.0, 0.3, 17, 9).unwrap();
    for name in ["x.obj", "x.off", "x.ply", "x.OBJ", "x.y.Ply"] {
        assert_eq!(bits(&through(&mesh, name)), bits(&mesh), "{name}");
    }
}

#[test]
fn stl_gives_the_mesh_back_rounded() {
    let mesh = sphere([1.0, 2.0, 3.0], 1.0, 2).unwrap();
    let back = through(&mesh, "x.STL");
    assert!(back.report().unwrap().is_solid());
    assert_eq!((back.vertices().len(), back.triangles().len()), (mesh.vertices().len(), mesh.triangles().len()));
    for t in 0..mesh.triangles().len() {
        assert_eq!(back.corners(t), mesh.corners(t).map(|p| p.map(|x| f64::from(x as f32))));
    }
}

#[test]
fn stl_refuses_what_single_precision_does_not_hold() {
    let folder = Folder::new();
    let path = folder.0.join("x.stl");
    fs::write(&path, "old").unwrap();
    let far = Mesh::new(vec![[0.0; 3], [1.0; 3], [0.0, -1e39, 0.0]], vec![[0, 1, 2]]).unwrap();
    assert!(matches!(far.write(&path), Err(Error::InvalidArgument(text)) if text.contains("vertex 2")));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert!(far.write(folder.0.join("x.ply")).is_ok());
}

#[test]
fn other_endings_are_refused_by_name() {
    let mesh = sphere([0.0; 3], 1.0, 0).unwrap();
    let folder = Folder::new();
    for name in ["x", "x.step", "obj", "x.obj.gz", ".stl"] {
        let refused = mesh.write(folder.0.join(name));
        assert!(
            matches!(refused, Err(Error::Unsupported(text)) if text.contains(".obj, .off, .ply or .stl")),
            "{name}"
        );
    }
    assert!(matches!(mesh.write(folder.0.join("none/x.obj")), Err(Error::Io { .. })));
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 0);
}

#[test]
fn curves_are_lines_in_the_plane() {
    let folder = Folder::new();
    let path = folder.0.join("x.obj");
    let curves = Mesh::new(vec![[0.0, 0.5], [1e300, -0.1]], vec![[0, 1], [1, 0]]).unwrap();
    curves.write(&path).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "v 0.0 0.5 0.0\nv 1e300 -0.1 0.0\nl 1 2\nl 2 1\n");
    assert!(matches!(curves.write(folder.0.join("x.stl")), Err(Error::Unsupported(_))));
}

proptest! {
    // PROPTEST_CASES counts against its default.
    #![proptest_config(ProptestConfig { cases: 64 * ProptestConfig::default().cases / 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_finite_coordinate_survives(numbers in prop::collection::vec(any::<f64>(), 9..60)) {
        let vertices: Vec<Vec3> = numbers.as_chunks().0.iter().map(|c: &[f64; 3]| c.map(|x| if x.is_finite() { x } else { 0.0 })).collect();
        let n = vertices.len() as u32;
        let mesh = Mesh::new(vertices, (2..n).map(|i| [0, i, i - 1]).collect()).unwrap();
        for name in ["x.obj", "x.off", "x.ply"] {
            let back = through(&mesh, name);
            prop_assert_eq!(bits(&back), bits(&mesh));
        }
    }
}
