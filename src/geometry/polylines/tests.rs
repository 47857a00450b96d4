use super::super::random::SplitMix64;
use super::*;
use proptest::prelude::*;
use std::f64::consts::TAU;

const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// A square of half width `r` around (x, 0), counter-clockwise when `turn` is positive.
fn square(x: f64, r: f64, turn: i32) -> Vec<[f64; 2]> {
    let mut points = SQUARE.map(|p| [x + r * p[0], r * p[1]]).to_vec();
    if turn < 0 {
        points.reverse();
    }
    points
}

fn closed(loops: &[Vec<[f64; 2]>]) -> Result<Mesh<2>> {
    let starts: Vec<usize> = (0..loops.len()).map(|k| loops[..k].iter().map(Vec::len).sum()).collect();
    Mesh::from_polylines(loops.concat(), &starts, Ends::Closed)
}

#[track_caller]
fn refused(made: Result<Mesh<2>>, words: &[&str]) {
    let Err(Error::InvalidArgument(message)) = made else { panic!("accepted: {made:?}") };
    assert!(words.iter().all(|w| message.contains(w)), "{message}");
}

#[test]
fn loops_become_solids_and_open_polylines_curves() {
    let r = closed(&[square(0.0, 1.0, 1)]).unwrap().report().unwrap();
    assert!(r.is_solid() && r.volume == 4.0 && r.area == 8.0, "{r}");
    let r = closed(&[square(0.0, 1.0, -1)]).unwrap().report().unwrap();
    assert!(r.inside_out, "{r}");
    let points = [square(0.0, 1.0, 1), vec![[5.0, 5.0], [6.0, 5.0]]].concat();
    let mesh = Mesh::from_polylines(points, &[0, 4], Ends::Open).unwrap();
    assert_eq!(mesh.segments(), [[0, 1], [1, 2], [2, 3], [4, 5]]);
    assert_eq!(mesh.report().unwrap().boundary_edges, 4);
}

#[test]
fn repeated_points_are_dropped() {
    let mut points = square(0.0, 1.0, 1);
    points.insert(2, points[1]);
    points.extend([points[0], points[0]]);
    let mesh = closed(&[points]).unwrap();
    assert_eq!((mesh.vertices(), mesh.segments().len()), (&SQUARE[..], 4));
    let speck = vec![[1.0, 1.0], [1.0, 1.0], [2.0, 1.0], [1.0, 1.0]];
    refused(closed(&[square(0.0, 9.0, 1), speck]), &["polyline 1, points 4 to 7, has 2 points", "at least 3"]);
}

#[test]
fn bad_points_and_starts_are_refused() {
    let points = square(0.0, 1.0, 1);
    let make = |starts: &[usize], ends| Mesh::from_polylines(points.clone(), starts, ends);
    refused(make(&[], Ends::Closed), &["no polylines"]);
    refused(make(&[1], Ends::Closed), &["loop_starts[0] is 1"]);
    refused(make(&[0, 5], Ends::Closed), &["loop_starts[1] is 5", "4 points"]);
    refused(make(&[0, 3], Ends::Open), &["polyline 1 starts at point 3, the points end at 4", "at least 2"]);
    refused(make(&[0, 2, 1], Ends::Open), &["polyline 1 starts at point 2, the next at 1"]);
    refused(make(&[0, 2], Ends::Closed), &["polyline 0 starts at point 0, the next at 2", "at least 3"]);
    refused(Mesh::from_polylines(Vec::new(), &[0], Ends::Open), &["at least 2 points"]);
    refused(closed(&[vec![[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]]]), &["point 1 is (1, NaN)"]);
}

#[test]
fn meetings_are_named_with_their_place() {
    let bow_tie = vec![[0.0, 0.0], [0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]];
    let (first, second) = ("segment from point 1 to 2 of polyline 0", "segment from point 3 to 4 of polyline 0");
    // The first of the repeated points stands for both.
    refused(closed(&[bow_tie]), &[&first.replace('1', "0"), "crosses", second, "at (2, 2)"]);
    let side = vec![[1.0, 0.5], [1.0, -0.5], [3.0, 0.0]];
    refused(
        closed(&[square(0.0, 1.0, 1), side]),
        &["point 1 to 2 of polyline 0 overlaps", "point 4 to 5 of polyline 1"],
    );
    let corner = vec![[1.0, 0.0], [3.0, -1.0], [3.0, 1.0]];
    refused(closed(&[square(0.0, 1.0, 1), corner]), &["point 1 to 2 of polyline 0 touches", "polyline 1 at (1, 0)"]);
    let back = vec![[0.0, 0.0], [3.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    refused(closed(&[back]), &["from point 0 to 1 of polyline 0 overlaps", "point 1 to 2 of polyline 0 at (1, 0)"]);
    let ring = [square(0.0, 1.0, 1), vec![SQUARE[0]]].concat();
    let open = Mesh::from_polylines(ring, &[0], Ends::Open);
    refused(open, &["point 0 to 1 of polyline 0 touches the segment from point 3 to 4", "at (-1, -1)"]);
}

#[test]
fn nested_loops_alternate() {
    let nest = |turns: [i32; 4]| {
        closed(&[0, 1, 2, 3].map(|k| square(if k == 3 { 0.5 } else { 0.0 }, 1.0 / f64::from(1 << k), turns[k])))
    };
    let r = nest([1, -1, 1, -1]);
    assert!(r.is_err(), "the last crosses the third");
    let nest = |turns: [i32; 3]| closed(&[0, 1, 2].map(|k| square(0.0, 1.0 / f64::from(1 << k), turns[k])));
    let r = nest([1, -1, 1]).unwrap().report().unwrap();
    assert!(r.is_solid() && r.volume == 4.0 - 1.0 + 0.25, "{r}");
    assert!(nest([-1, 1, -1]).unwrap().report().unwrap().inside_out);
    refused(nest([1, 1, 1]), &["polylines 0 and 1 lie one right inside the other", "reverse polyline 1"]);
    refused(nest([1, -1, -1]), &["polylines 1 and 2 lie", "reverse polyline 2"]);
    refused(nest([-1, -1, 1]), &["polylines 0 and 1 lie", "reverse polyline 0"]);
    let apart = |turns: [i32; 2]| closed(&[square(0.0, 1.0, turns[0]), square(5.0, 1.0, turns[1])]);
    assert!(apart([1, 1]).is_ok() && apart([-1, -1]).is_ok());
    refused(apart([1, -1]), &["polylines 1 and 0 lie in no other", "reverse polyline 1"]);
    refused(apart([-1, 1]), &["polylines 0 and 1 lie in no other", "reverse polyline 0"]);
    // The inner may come first.
    assert!(closed(&[square(0.0, 1.0, -1), square(0.0, 2.0, 1)]).is_ok());
    refused(closed(&[square(0.0, 1.0, 1), square(0.0, 2.0, 1)]), &["polylines 0 and 1 lie", "reverse polyline 0"]);
}

/// A polygon of radius about `r` around `c`, counter-clockwise when `left`.
fn polygon(c: [f64; 2], r: f64, n: usize, left: bool) -> Vec<[f64; 2]> {
    let mut points: Vec<_> =
        (0..n).map(|i| (TAU * i as f64 / n as f64).sin_cos()).map(|(s, t)| [c[0] + r * t, c[1] + r * s]).collect();
    if !left {
        points.reverse();
    }
    points
}

#[test]
fn loops_scattered_in_one_another_are_told_apart() {
    let mut random = SplitMix64::new(5);
    for _ in 0..200 {
        // Circles that keep clear of one another, and how many are around each.
        let mut circles: Vec<([f64; 2], f64)> = Vec::new();
        for _ in 0..60 {
            let r = random.unit().powi(3);
            let c = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
            let clear = |&(d, s): &([f64; 2], f64)| {
                let far = (c[0] - d[0]).hypot(c[1] - d[1]);
                far > 1.3 * (r + s) || 1.3 * (far + r) < s || 1.3 * (far + s) < r
            };
            if circles.iter().all(clear) {
                circles.push((c, r));
            }
        }
        let depth =
            |(c, r): ([f64; 2], f64)| circles.iter().filter(|(d, s)| (c[0] - d[0]).hypot(c[1] - d[1]) < s - r).count();
        let n = 8 + (random.bits() % 8) as usize;
        let mut loops: Vec<_> = circles.iter().map(|&o| polygon(o.0, o.1, n, depth(o) % 2 == 0)).collect();
        assert!(closed(&loops).unwrap().report().unwrap().volume > 0.0);
        if loops.len() > 2 {
            let wrong = (random.bits() % loops.len() as u64) as usize;
            loops[wrong].reverse();
            refused(closed(&loops), &["reverse polyline", &wrong.to_string()]);
        }
    }
}

#[test]
fn many_loops_above_or_in_one_another_take_no_quadratic_time() {
    // That would take a minute here.
    let n = 30_000;
    let column: Vec<_> = (0..n).map(|k| polygon([0.0, 3.0 * f64::from(k)], 1.0, 4, true)).collect();
    assert!(closed_in_order(&column).is_ok());
    let rings: Vec<_> = (0..n).map(|k| square(0.0, f64::from(n - k), 1 - 2 * (k % 2))).collect();
    assert!(closed_in_order(&rings).is_ok());
}

/// As [`closed`], of many.
fn closed_in_order(loops: &[Vec<[f64; 2]>]) -> Result<Mesh<2>> {
    let starts: Vec<usize> = loops.iter().scan(0, |n, l| Some(std::mem::replace(n, *n + l.len()))).collect();
    Mesh::from_polylines(loops.concat(), &starts, Ends::Closed)
}

#[test]
fn vertices_below_a_loop_are_counted_once() {
    // Tips and corners straight below the first vertex of the square at (4, 0), whose lower left corner is (3, -1).
    let tips = [
        vec![[1.0, -6.0], [3.0, -5.0], [1.0, -4.0]],
        vec![[3.0, -3.0], [5.0, -3.5], [5.0, -2.5]],
        vec![[1.0, -9.0], [3.0, -9.5], [5.0, -9.0], [3.0, -8.0]],
        vec![[2.0, -7.5], [3.0, -7.5], [3.0, -7.0], [2.0, -7.0]],
    ];
    let mut loops = tips.to_vec();
    loops.push(square(4.0, 1.0, 1));
    assert!(closed(&loops).is_ok());
    loops.push(square(0.0, 20.0, 1));
    refused(closed(&loops), &["one right inside the other", "reverse polyline 0"]);
    loops[5].reverse();
    assert!(closed(&loops).unwrap().report().unwrap().inside_out);
    loops.iter_mut().for_each(|l| l.reverse());
    assert!(closed(&loops).unwrap().report().unwrap().is_solid());
}

#[test]
fn trailing_edges_are_decided_to_the_bit() {
    // The tail of a foil whose lower side ends at height y over the line between the upper side's last two points.
    let tail = |y: f64| closed(&[vec![[1.0, 0.0], [0.5, 0.25], [0.0, 0.0], [0.75, y]]]);
    assert!(tail(0.125_f64.next_down()).is_ok());
    refused(tail(0.125), &["touches"]);
    refused(tail(0.125_f64.next_up()), &["crosses"]);
}

/// Whether two segments of integers meet, by the definition, in integers.
fn meet([a, b]: [[i64; 2]; 2], [c, d]: [[i64; 2]; 2]) -> bool {
    let turn = |p: [i64; 2], q: [i64; 2], r: [i64; 2]| {
        ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).signum()
    };
    let between = |p: [i64; 2], q: [i64; 2], r: [i64; 2]| {
        turn(p, q, r) == 0 && (0..2).all(|k| r[k] >= p[k].min(q[k]) && r[k] <= p[k].max(q[k]))
    };
    turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0
        || between(a, b, c)
        || between(a, b, d)
        || between(c, d, a)
        || between(c, d, b)
}

/// Whether a polygon of integers, no point equal to the next, is simple.
fn is_simple(points: &[[i64; 2]]) -> bool {
    let n = points.len();
    let segment = |i: usize| [points[i % n], points[(i + 1) % n]];
    (0..n).all(|i| {
        (i + 1..n).all(|j| {
            if j == i + 1 || (i == 0 && j == n - 1) {
                let (first, second) = if j == i + 1 { (i, j) } else { (j, i) };
                let ([p, pivot], [_, q]) = (segment(first), segment(second));
                let (u, v) = ([p[0] - pivot[0], p[1] - pivot[1]], [q[0] - pivot[0], q[1] - pivot[1]]);
                return u[0] * v[1] != u[1] * v[0] || u[0] * v[0] + u[1] * v[1] < 0;
            }
            !meet(segment(i), segment(j))
        })
    })
}

proptest! {
    #[test]
    fn stars_are_solids(radii in prop::collection::vec(0.001..1.0, 4..200), seed in 0..1000_u64) {
        let mut random = SplitMix64::new(seed);
        let n = radii.len() as f64;
        let point = |(i, r): (usize, &f64)| {
            let (sin, cos) = ((i as f64 + 0.8 * random.unit()) / n * TAU).sin_cos();
            [r * cos, r * sin]
        };
        let mesh = closed(&[radii.iter().enumerate().map(point).collect()]).unwrap();
        prop_assert!(mesh.report().unwrap().is_solid());
    }

    #[test]
    fn polygons_are_accepted_just_when_they_are_simple(
        size in 3..12_i64,
        raw in prop::collection::vec((0..1_000_000_i64, 0..1_000_000_i64), 3..8),
    ) {
        // Few places, so that touching and overlapping are common.
        let mut points: Vec<[i64; 2]> = raw.iter().map(|&(x, y)| [x % size, y % size]).collect();
        points.dedup();
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        let made = closed(&[points.iter().map(|p| p.map(|x| x as f64)).collect()]);
        prop_assert_eq!(made.is_ok(), points.len() > 2 && is_simple(&points), "{:?} {:?}", points, made);
    }

    #[test]
    fn many_random_segments_agree_with_asking_each_pair(seed in 0..10_000_u64, n in 2..40_usize) {
        let mut random = SplitMix64::new(seed);
        let mut below = |n: u64| (random.bits() % n) as i64;
        let segments: Vec<[[i64; 2]; 2]> = (0..n)
            .map(|_| {
                let [x, y] = [below(100), below(100)];
                [[x, y], [x + 1 + below(8), y + below(8)]]
            })
            .collect();
        let clear = (0..n).all(|i| (0..i).all(|j| !meet(segments[i], segments[j])));
        let points = segments.iter().flatten().map(|p| p.map(|x| x as f64)).collect();
        let starts: Vec<usize> = (0..n).map(|k| 2 * k).collect();
        prop_assert_eq!(Mesh::from_polylines(points, &starts, Ends::Open).is_ok(), clear);
    }
}
