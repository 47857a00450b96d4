//! Level sets of functions in closed form: topology, place, orientation, shape.

use super::*;
use crate::geometry::random::SplitMix64;
use crate::geometry::vec;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// A function given by value and gradient at a point.
struct Closed<G>(G);

impl<const D: usize, G: Fn([f64; D]) -> (f64, [f64; D]) + Sync> Function<D> for Closed<G> {
    fn values(&self, points: &[[f64; D]], values: &mut [f64]) -> Result<()> {
        points.iter().zip(values).for_each(|(p, v)| *v = (self.0)(*p).0);
        Ok(())
    }

    fn gradients(&self, points: &[[f64; D]], values: &mut [f64], gradients: &mut [[f64; D]]) -> Result<()> {
        for (p, (v, g)) in points.iter().zip(values.iter_mut().zip(gradients)) {
            (*v, *g) = (self.0)(*p);
        }
        Ok(())
    }
}

/// The cube or square [-1, 1]^D of `n` cells an axis.
fn axes<const D: usize>(n: usize) -> [Axis; D] {
    [Axis { lower: -1.0, cell: 2.0 / n as f64, n_cells: n }; D]
}

fn one_thread() -> LevelSetOptions {
    LevelSetOptions { n_threads: 1, ..LevelSetOptions::default() }
}

fn extract_from<const D: usize>(
    phi: impl Fn([f64; D]) -> (f64, [f64; D]) + Sync,
    n: usize,
    level: f64,
    options: &LevelSetOptions,
) -> LevelSet<D> {
    let question = Question { phi: &Closed(phi), axes: axes(n), level, outward: 1.0 };
    extract(&question, options, &mut Progress::silent()).unwrap()
}

/// |x - c| - r
fn ball<const D: usize>(center: [f64; D], radius: f64) -> impl Fn([f64; D]) -> (f64, [f64; D]) + Sync {
    move |p| {
        let d = vec::sub(p, center);
        let length = vec::norm(d);
        (length - radius, d.map(|x| x / length.max(1e-300)))
    }
}

/// A smooth minimum of two functions: -log(e^-kf + e^-kg) / k.
fn united<const D: usize>(
    f: impl Fn([f64; D]) -> (f64, [f64; D]) + Sync,
    g: impl Fn([f64; D]) -> (f64, [f64; D]) + Sync,
) -> impl Fn([f64; D]) -> (f64, [f64; D]) + Sync {
    const K: f64 = 30.0;
    move |p| {
        let ((f, df), (g, dg)) = (f(p), g(p));
        let least = f.min(g);
        let (a, b) = ((-K * (f - least)).exp(), (-K * (g - least)).exp());
        (least - (a + b).ln() / K, std::array::from_fn(|i| (a * df[i] + b * dg[i]) / (a + b)))
    }
}

fn torus(p: [f64; 3]) -> (f64, [f64; 3]) {
    let ring = p[0].hypot(p[1]).max(1e-300);
    let out = ring - 0.6;
    let tube = out.hypot(p[2]).max(1e-300);
    (tube - 0.25, [out / tube * p[0] / ring, out / tube * p[1] / ring, p[2] / tube])
}

fn gyroid(p: [f64; 3]) -> (f64, [f64; 3]) {
    const K: f64 = 5.0;
    let (s, c) = (p.map(|x| (K * x).sin()), p.map(|x| (K * x).cos()));
    let value = s[0] * c[1] + s[1] * c[2] + s[2] * c[0];
    let slope = |a: usize, b: usize, d: usize| K * (c[a] * c[b] - s[d] * s[a]);
    (value, [slope(0, 1, 2), slope(1, 2, 0), slope(2, 0, 1)])
}

/// A sum of waves of random direction and phase, lifted towards the faces of the box so that low levels stay inside.
fn waves<const D: usize>(seed: u64, lift: f64) -> impl Fn([f64; D]) -> (f64, [f64; D]) + Sync {
    let mut random = SplitMix64::new(seed);
    let waves: Vec<([f64; D], f64)> = (0..12)
        .map(|_| (std::array::from_fn(|_| random.between(-7.0, 7.0)), random.between(0.0, std::f64::consts::TAU)))
        .collect();
    move |p| {
        let mut value = lift * (vec::dot(p, p).powi(4) - 0.6);
        let mut gradient = p.map(|x| lift * 8.0 * vec::dot(p, p).powi(3) * x);
        for (k, phase) in &waves {
            let (s, c) = (vec::dot(*k, p) + phase).sin_cos();
            value += 0.4 * s;
            gradient = vec::add(gradient, vec::scale(0.4 * c, *k));
        }
        (value, gradient)
    }
}

/// Ridges of all facets, each with how many facets run through it forwards and backwards.
fn ridges<const D: usize>(set: &LevelSet<D>) -> BTreeMap<Vec<u32>, [usize; 2]> {
    let mut ridges = BTreeMap::<Vec<u32>, [usize; 2]>::new();
    for facet in set.facets() {
        for k in 0..D {
            let (key, forward) = match D {
                2 => (vec![facet[k]], k == 0),
                _ => {
                    let (a, b) = (facet[k], facet[(k + 1) % D]);
                    (vec![a.min(b), a.max(b)], a < b)
                }
            };
            ridges.entry(key).or_default()[usize::from(forward)] += 1;
        }
    }
    ridges
}

/// The set is an oriented manifold, open only where it says, uses each vertex, repeats none, and lies on the level.
fn check<const D: usize>(set: &LevelSet<D>, phi: impl Fn([f64; D]) -> (f64, [f64; D]), level: f64, h: f64) {
    let ridges = ridges(set);
    assert!(ridges.values().all(|n| n[0] <= 1 && n[1] <= 1), "every ridge has at most a facet of each direction");
    let open = ridges.values().filter(|n| n[0] + n[1] == 1).count();
    assert_eq!(open, set.boundary());
    let mut used = vec![false; set.vertices().len()];
    set.facets().as_flattened().iter().for_each(|&v| used[v as usize] = true);
    assert!(used.iter().all(|u| *u), "every vertex is used");
    let mut places: Vec<[u64; D]> = set.vertices().iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    places.sort_unstable();
    assert!(places.windows(2).all(|w| w[0] != w[1]), "no two vertices are at one place");
    for &p in set.vertices() {
        let (value, gradient) = phi(p);
        let distance = (value - level).abs() / vec::norm(gradient).max(1e-3);
        assert!(distance <= 2e-9 * h, "vertex {p:?} is {distance} off");
    }
    let report = set.clone().into_mesh().unwrap().report().unwrap();
    assert!(report.manifold && report.oriented && report.duplicate_facets == 0, "{report}");
    assert_eq!(report.boundary_edges, set.boundary());
}

/// V - E + F
fn euler(set: &LevelSet<3>) -> i64 {
    set.vertices().len() as i64 - ridges(set).len() as i64 + set.facets().len() as i64
}

fn solid(set: LevelSet<3>) -> crate::geometry::MeshReport {
    set.into_mesh().unwrap().report().unwrap()
}

/// The smallest angle of each triangle, in degrees, in ascending order.
fn smallest_angles(set: &LevelSet<3>) -> Vec<f64> {
    let angle = |p: [[f64; 3]; 3], k: usize| {
        let (u, v) = (vec::sub(p[(k + 1) % 3], p[k]), vec::sub(p[(k + 2) % 3], p[k]));
        (vec::dot(u, v) / (vec::norm(u) * vec::norm(v))).clamp(-1.0, 1.0).acos().to_degrees()
    };
    let corners = |f: &[u32; 3]| f.map(|v| set.vertices()[v as usize]);
    let smallest = |f| (0..3).map(|k| angle(corners(f), k)).fold(180.0, f64::min);
    let mut angles: Vec<f64> = set.facets().iter().map(smallest).collect();
    angles.sort_by(f64::total_cmp);
    angles
}

#[test]
fn a_sphere_is_a_sphere() {
    for n in [2, 3, 8, 17] {
        let phi = ball([0.01, -0.02, 0.03], 0.7);
        let set = extract_from(&phi, n, 0.05, &one_thread());
        check(&set, &phi, 0.05, 1.0 / n as f64);
        assert_eq!((euler(&set), set.boundary()), (2, 0));
        let report = solid(set);
        assert!(report.is_solid() && report.components == 1);
        let missing = 1.0 - report.volume / (std::f64::consts::PI * 0.75_f64.powi(3) * 4.0 / 3.0);
        assert!(missing > 0.0 && missing < 2.0 / (n * n) as f64, "{n}: {missing}");
    }
}

#[test]
fn where_the_level_set_goes_through_lattice_vertices_it_is_closed_still() {
    // Plane faces on lattice planes, and a sphere through many lattice vertices.
    let cube = |p: [f64; 3]| {
        let p4 = p.map(|x| (2.0 * x).powi(8));
        (p4.iter().sum::<f64>() - 1.0, p.map(|x| 16.0 * (2.0 * x).powi(7)))
    };
    for n in [4, 8, 10] {
        let set = extract_from(cube, n, 0.0, &one_thread());
        check(&set, cube, 0.0, 1.0 / n as f64);
        assert_eq!((euler(&set), set.boundary()), (2, 0));
        let sphere = ball([0.0; 3], 0.5);
        let set = extract_from(&sphere, n, 0.0, &one_thread());
        check(&set, &sphere, 0.0, 1.0 / n as f64);
        assert_eq!((euler(&set), set.boundary()), (2, 0));
    }
}

#[test]
fn tori_and_pairs_keep_their_topology() {
    let set = extract_from(torus, 12, 0.0, &one_thread());
    check(&set, torus, 0.0, 1.0 / 12.0);
    assert_eq!(euler(&set), 0);
    assert!(solid(set).is_solid());
    let pair = united(ball([-0.5, 0.0, 0.0], 0.3), ball([0.5, 0.1, 0.0], 0.3));
    let set = extract_from(&pair, 12, 0.0, &one_thread());
    check(&set, &pair, 0.0, 1.0 / 12.0);
    assert_eq!((euler(&set), solid(set).components), (4, 2));
}

#[test]
fn the_outward_side_is_the_callers() {
    let phi = ball([0.0; 3], 0.6);
    let inverse = |p| {
        let (v, g) = phi(p);
        (-v, g.map(|x: f64| -x))
    };
    let question = Question { phi: &Closed(inverse), axes: axes(7), level: 0.0, outward: -1.0 };
    let set = extract(&question, &one_thread(), &mut Progress::silent()).unwrap();
    assert!(solid(set).is_solid());
}

#[test]
fn what_meets_the_box_is_open_there() {
    let set = extract_from(gyroid, 10, 0.0, &one_thread());
    check(&set, gyroid, 0.0, 0.1);
    assert!(set.boundary() > 0);
    for v in set.vertices() {
        assert!(v.iter().all(|x| x.abs() <= 1.0 + 1e-15));
    }
    let plane = |p: [f64; 3]| (p[2] - 0.1, [0.0, 0.0, 1.0]);
    let set = extract_from(plane, 5, 0.0, &one_thread());
    check(&set, plane, 0.0, 0.1);
    assert_eq!(euler(&set), 1);
    assert!((solid(set).area - 4.0).abs() < 1e-12);
}

#[test]
fn curves_are_closed_or_run_from_face_to_face() {
    let annulus = |p: [f64; 2]| {
        let (r, g) = ball([0.0, 0.05], 0.6)(p);
        (r.abs() - 0.2, g.map(|x| x * r.signum()))
    };
    let set = extract_from(annulus, 16, 0.0, &one_thread());
    check(&set, annulus, 0.0, 1.0 / 16.0);
    let lines = set.into_mesh().unwrap().polylines().unwrap();
    assert_eq!((lines.closed.as_slice(), lines.starts.len()), (&[true, true][..], 2));
    let area = |i: usize| {
        let p = lines.curve(i);
        (0..p.len()).map(|k| (p[k], p[(k + 1) % p.len()])).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum::<f64>()
    };
    // The solid is on the left: counter-clockwise outside, clockwise inside.
    let mut areas = [area(0), area(1)];
    areas.sort_by(f64::total_cmp);
    assert!((areas[0] / (-0.16 * std::f64::consts::PI) - 1.0).abs() < 0.01);
    assert!((areas[1] / (0.64 * std::f64::consts::PI) - 1.0).abs() < 0.01);

    let line = |p: [f64; 2]| (p[0] + 0.3 * p[1] - 0.05, [1.0, 0.3]);
    let set = extract_from(line, 8, 0.0, &one_thread());
    check(&set, line, 0.0, 0.1);
    assert_eq!(set.boundary(), 2);
    let lines = set.into_mesh().unwrap().polylines().unwrap();
    assert_eq!(lines.closed, [false]);
    assert!(lines.points.is_sorted_by(|a, b| a[1] < b[1]), "the solid, x < .., is on the left of the way up");
}

#[test]
fn triangles_are_well_shaped() {
    for phi in [torus, gyroid] {
        let raw = LevelSetOptions { shortest_edge: 0.0, relaxations: 0, ..one_thread() };
        let before = smallest_angles(&extract_from(phi, 12, 0.0, &raw));
        let after = smallest_angles(&extract_from(phi, 12, 0.0, &one_thread()));
        let show = |a: &[f64]| [0.0, 0.001, 0.01, 0.05, 0.5].map(|q| a[(q * (a.len() - 1) as f64) as usize]);
        println!(
            "smallest angles, quantiles 0 .001 .01 .05 .5: {:.1?} of {}, then {:.1?} of {}",
            show(&before),
            before.len(),
            show(&after),
            after.len()
        );
        assert!(after[after.len() / 100] > 20.0);
    }
}

#[test]
fn threads_do_not_change_the_result() {
    let alone = extract_from(gyroid, 13, 0.2, &one_thread());
    for n_threads in [2, 5] {
        let options = LevelSetOptions { n_threads, ..LevelSetOptions::default() };
        assert_eq!(extract_from(gyroid, 13, 0.2, &options), alone);
    }
}

#[test]
fn refusals_say_what_would_be_right() {
    let ask = |level: f64, options: &LevelSetOptions| {
        let phi = Closed(ball([0.0; 3], 0.5));
        extract(&Question { phi: &phi, axes: axes(4), level, outward: 1.0 }, options, &mut Progress::silent())
    };
    let o = one_thread();
    assert!(matches!(ask(5.0, &o), Err(Error::Degenerate(text)) if text.contains("from -0.5 to 1.23")));
    assert!(matches!(ask(f64::NAN, &o), Err(Error::InvalidArgument(_))));
    for bad in [
        LevelSetOptions { subdivisions: 0, ..o.clone() },
        LevelSetOptions { subdivisions: 1025, ..o.clone() },
        LevelSetOptions { shortest_edge: f64::NAN, ..o.clone() },
        LevelSetOptions { relaxations: 1001, ..o.clone() },
    ] {
        assert!(matches!(ask(0.0, &bad), Err(Error::InvalidArgument(_))));
    }
    for limit in [100, 30_000] {
        let small = LevelSetOptions { memory_limit: limit, ..o.clone() };
        assert!(matches!(ask(0.0, &small), Err(Error::OutOfMemory { limit: Some(_), .. })));
    }
    let huge = LevelSetOptions { subdivisions: 1024, ..o.clone() };
    assert!(matches!(ask(0.0, &huge), Err(Error::OutOfMemory { limit: Some(_), .. })));
}

#[test]
fn cancelling_works_at_every_word_of_progress() {
    let ask = |last: usize| {
        let mut words = 0;
        let mut listen = |_: f64, _: &str| {
            words += 1;
            if words > last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let question = Question { phi: &Closed(torus), axes: axes(6), level: 0.0, outward: 1.0 };
        extract(&question, &one_thread(), &mut Progress::new(&mut listen)).err()
    };
    let mut last = 0;
    while ask(last) == Some(Error::Cancelled) {
        last += 1;
    }
    assert!(last > 4 && ask(last).is_none());
}

/// Looking for blocks in a large field tells progress too, and stops where it is asked to.
#[test]
fn a_search_for_blocks_is_told_of_and_stopped() {
    let grid = crate::spline::Grid { axes: axes::<2>(500) };
    let shape = grid.shape();
    let phi = (0..shape[0] * shape[1]).map(|i| (i / shape[1]) as f64 - 200.0).collect();
    let field = Field::from_control_points(grid, phi, crate::field::Feasible::Outside, 1.0).unwrap();
    let ask = |last: usize| {
        let mut told = Vec::new();
        let mut tell = |done| {
            told.push(done);
            if told.len() > last { Err(Error::Cancelled) } else { Ok(()) }
        };
        let blocks = LatticeBlocks::new([1000; 2]).unwrap();
        let end = field.mark_level(0.0, &blocks, &Workers::caller_only(), &mut tell);
        (end.err(), told)
    };
    let (end, told) = ask(usize::MAX);
    assert!(end.is_none() && told.len() > 1 && told.iter().all(|done| (0.0..1.0).contains(done)), "{told:?}");
    assert_eq!(ask(1).0, Some(Error::Cancelled));
}

proptest! {
    // PROPTEST_CASES counts against its default.
    #![proptest_config(ProptestConfig { cases: 48 * ProptestConfig::default().cases / 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_level_sets_in_space_are_manifolds(
        seed: u64,
        n in 2_usize..8,
        level in -1.0..1.0,
        subdivisions in 1_u32..4,
        shortest_edge in 0.0..1.0,
    ) {
        for lift in [0.0, 12.0] {
            let phi = waves::<3>(seed, lift);
            let options = LevelSetOptions { subdivisions, shortest_edge, ..one_thread() };
            let question = Question { phi: &Closed(&phi), axes: axes(n), level, outward: 1.0 };
            let raw = LevelSetOptions { subdivisions, shortest_edge: 0.0, relaxations: 0, ..one_thread() };
            let [set, raw] = [&options, &raw].map(|o| extract(&question, o, &mut Progress::silent()));
            match (set, raw) {
                (Ok(set), Ok(raw)) => {
                    check(&set, &phi, level, 1.0 / n as f64);
                    check(&raw, &phi, level, 1.0 / n as f64);
                    prop_assert_eq!(euler(&set), euler(&raw), "collapsing keeps the topology");
                    prop_assert_eq!(set.boundary() == 0, raw.boundary() == 0);
                }
                ends => prop_assert!(not_reached(&ends.0) && not_reached(&ends.1), "{:?}", ends),
            }
        }
    }

    #[test]
    fn random_level_sets_in_the_plane_are_manifolds(seed: u64, n in 2_usize..30, level in -1.0..1.0, lift in 0.0..20.0) {
        let phi = waves::<2>(seed, lift);
        let question = Question { phi: &Closed(&phi), axes: axes(n), level, outward: 1.0 };
        match extract(&question, &one_thread(), &mut Progress::silent()) {
            Ok(set) => {
                check(&set, &phi, level, 1.0 / n as f64);
                let lines = set.clone().into_mesh().unwrap().polylines().unwrap();
                prop_assert_eq!(lines.points.len(), set.vertices().len());
                prop_assert_eq!(2 * lines.closed.iter().filter(|c| !**c).count(), set.boundary());
            }
            end => prop_assert!(not_reached(&end), "{:?}", end),
        }
    }
}

/// Whether the function has no such level.
fn not_reached<const D: usize>(end: &Result<LevelSet<D>>) -> bool {
    matches!(end, Err(Error::Degenerate(_)))
}

#[test]
fn a_function_that_is_constant_but_for_rounding_has_no_level_set() {
    let noise = |p: [f64; 3]| (0.1 + f64::EPSILON * 0.1 * (1e3 * p[0]).sin().signum(), [0.0; 3]);
    let question = Question { phi: &Closed(noise), axes: axes(4), level: 0.1, outward: 1.0 };
    let error = extract(&question, &one_thread(), &mut Progress::silent()).unwrap_err();
    assert!(matches!(error, Error::Degenerate(_)), "{error}");
    // The range is that of the function, not what is left of it beside the level.
    let question =
        Question { phi: &Closed(|p: [f64; 2]| (p[0], [1.0, 0.0])), axes: axes(4), level: 1e300, outward: 1.0 };
    let text = extract(&question, &one_thread(), &mut Progress::silent()).unwrap_err().to_string();
    assert!(text.contains("level 1e300 is not reached") && text.contains("from -1 to 1"), "{text}");
}
