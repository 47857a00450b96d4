//! Estimated normals beside the true ones, on meshes of the test data and on airfoils: how many point to the right side.
//!
//! `cargo test --release --test data_normals -- --nocapture` prints a line a cloud; `KEEPOUT_ALL_SIZES=1` adds
//! 5,000 samples, of which nothing is asked.

mod common;

use std::path::Path;

use keepout::geometry::orient::NormalOptions;
use keepout::geometry::random::SplitMix64;
use keepout::geometry::vec::{add, dot, norm, scale, sub};
use keepout::geometry::{Cloud, Mesh, read, shapes};
use keepout::progress::Progress;

/// Points estimated, those that are wrong, and the mean angle between the lines of the normals, in degrees.
#[derive(Debug, Clone, Copy, Default)]
struct Score {
    n: usize,
    wrong: usize,
    angle: f64,
}

/// The score of `truth`'s points, moved by `noise` times D: its standard deviation along each axis.
fn score<const D: usize>(name: &str, truth: &Cloud<D>, noise: f64) -> Score {
    let mut random = SplitMix64::new(5);
    // Uniform on [-s, s] has the deviation s / sqrt(3).
    let s = 3f64.sqrt() * noise * truth.bounds().diagonal();
    let moved = truth.points().iter().map(|p| p.map(|x| x + s * random.between(-1.0, 1.0))).collect();
    let options = NormalOptions { n_threads: 1, ..NormalOptions::default() };
    let (cloud, report) = Cloud::with_estimated_normals(moved, &options, &mut Progress::silent()).unwrap();
    let n = truth.len();
    let mut score = Score { n, ..Score::default() };
    for (a, b) in cloud.normals().iter().zip(truth.normals()) {
        let cosine = dot(*a, *b);
        score.wrong += usize::from(cosine <= 0.0);
        score.angle += cosine.abs().min(1.0).acos().to_degrees() / n as f64;
    }
    println!(
        "{name:36} n = {n:6} noise = {noise:5} right = {:8.4} % angle = {:6.3} deg agreement = {:.4} outliers = {} doubtful = {} \
         degenerate = {} components = {} seconds = {:.3}",
        100.0 - 100.0 * score.wrong as f64 / n as f64,
        score.angle,
        report.agreement,
        report.outliers.len(),
        report.doubtful.len(),
        report.degenerate.len(),
        report.n_components,
        report.seconds
    );
    score
}

/// Asserts that at least `percent` of the normals of 25,000 samples are right.
fn check(name: &str, mesh: &Mesh, percent: f64, percent_with_noise: f64) {
    if std::env::var("KEEPOUT_ALL_SIZES").is_ok() {
        let few = mesh.sample(5000, 1).unwrap();
        score(name, &few, 0.0);
        score(name, &few, 0.001);
    }
    let cloud = mesh.sample(25_000, 1).unwrap();
    for (noise, percent) in [(0.0, percent), (0.001, percent_with_noise)] {
        let Score { n, wrong, .. } = score(name, &cloud, noise);
        let right = 100.0 - 100.0 * wrong as f64 / n as f64;
        assert!(
            right >= percent,
            "{name}, noise {noise}: {right} % of the normals are right; {percent} % are expected"
        );
    }
}

fn joined(a: &Mesh, b: &Mesh) -> Mesh {
    let n = a.vertices().len() as u32;
    let after = b.triangles().iter().map(|t| t.map(|v| v + n));
    Mesh::new([a.vertices(), b.vertices()].concat(), a.triangles().iter().copied().chain(after).collect()).unwrap()
}

#[test]
fn normals_of_closed_forms() {
    let ball = |x: f64| shapes::sphere([x, 0.0, 0.0], 1.0, 5).unwrap();
    let slab = |thickness: f64| shapes::box_mesh([0.0; 3], [1.0, 1.0, thickness]).unwrap();
    check("sphere", &ball(0.0), 99.99, 99.99);
    check("torus", &shapes::torus(1.0, 0.3, 200, 80).unwrap(), 99.99, 99.98);
    check("two spheres 0.05 apart", &joined(&ball(0.0), &ball(2.05)), 99.99, 99.97);
    check("box", &shapes::box_mesh([0.0; 3], [1.0, 2.0, 3.0]).unwrap(), 99.99, 99.98);
    // Points are 0.01 apart.
    check("box 0.02 thick", &slab(0.02), 99.99, 99.95);
    check("box 0.01 thick", &slab(0.01), 99.0, 98.0);
}

#[test]
fn normals_of_meshes() {
    let Some(dir) = common::data_dir() else { return };
    // Smooth ones first, then sharp edges, then parts thinner than the points are apart.
    let expected = [
        ("stanford/bunny_35947.obj", 99.98, 99.95),
        ("stanford/bunny_lsdo_genie.stl", 99.98, 99.95),
        ("stanford/armadillo_cgal.off", 99.95, 99.8),
        ("mechanical/knot1.off", 99.99, 99.98),
        ("mechanical/double-torus.off", 99.9, 99.85),
        ("anatomy/head_with_ears_tuberlin.ply", 99.95, 99.9),
        ("mechanical/fandisk.obj", 99.98, 99.9),
        ("mechanical/rotor.off", 99.4, 99.3),
        ("anatomy/heart_sphinxsys.stl", 99.2, 99.0),
        ("anatomy/femur_cgal.off", 98.8, 98.0),
        ("aircraft/bwb.stl", 97.0, 94.0),
    ];
    for (file, percent, percent_with_noise) in expected {
        check(file, &read(&dir.join(file)).unwrap(), percent, percent_with_noise);
    }
}

#[test]
fn normals_of_airfoils() {
    let Some(dir) = common::data_dir() else { return };
    for name in ["clarky", "naca0012", "rae2822", "s1223"] {
        let curve = airfoil(&dir.join(format!("curves2d/{name}.dat")));
        for (n, most_wrong) in [(200, 34), (1000, 0), (5000, 0)] {
            let wrong = score(name, &evenly(&curve, n), 0.0).wrong;
            assert!(wrong <= most_wrong, "{name}: {wrong} of {n} normals are wrong");
        }
    }
}

/// The corners of the airfoil in a file of x and y below a title.
fn airfoil(path: &Path) -> Vec<[f64; 2]> {
    let text = std::fs::read_to_string(path).unwrap();
    let corner = |line: &str| {
        let mut numbers = line.split_whitespace().map(|word| word.parse().ok());
        Some([numbers.next()??, numbers.next()??])
    };
    text.lines().skip(1).filter_map(corner).collect()
}

/// `n` points at even distances along the closed line through `corners`, with its outward normals.
fn evenly(corners: &[[f64; 2]], n: usize) -> Cloud<2> {
    let m = corners.len();
    let sides: Vec<_> = (0..m).map(|i| [corners[i], corners[(i + 1) % m]]).collect();
    let area: f64 = sides.iter().map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum();
    let length = |[a, b]: [[f64; 2]; 2]| norm(sub(b, a));
    let total: f64 = sides.iter().map(|&s| length(s)).sum();
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    let (mut side, mut before) = (0, 0.0);
    for i in 0..n {
        let at = (i as f64 + 0.5) / n as f64 * total;
        while side + 1 < m && before + length(sides[side]) < at {
            before += length(sides[side]);
            side += 1;
        }
        let [a, b] = sides[side];
        points.push(add(a, scale((at - before) / length(sides[side]), sub(b, a))));
        normals.push(scale(area.signum(), [b[1] - a[1], a[0] - b[0]]));
    }
    Cloud::new(points, normals).unwrap()
}

/// Prints how the time grows: seconds for sizes a factor 10 apart. Run by `-- --ignored --nocapture`.
#[test]
#[ignore = "prints times"]
fn time_grows_as_the_points_do() {
    let ring = shapes::torus(1.0, 0.3, 200, 80).unwrap();
    for n in [25_000, 250_000] {
        score("torus", &ring.sample(n, 1).unwrap(), 0.0);
    }
}
