//! Sets of constraints against differences of their values, in the plane and in space.

use super::pose::Order;
use super::*;
use crate::field::{Feasible, Field};
use crate::geometry::matrix::applied;
use crate::geometry::random::SplitMix64;
use crate::spline::{Axis, Grid};
use crate::{Error, Result};
use std::sync::Arc;

/// A field of random control points on a box around the origin.
fn field<const D: usize>(random: &mut SplitMix64) -> Arc<Field<D>> {
    let axes = std::array::from_fn(|a| Axis { lower: -1.0 - 0.1 * a as f64, cell: 0.45, n_cells: 4 + a });
    let grid = Grid { axes };
    let c = (0..grid.n_control()).map(|_| random.between(-1.0, 1.0)).collect();
    Arc::new(Field::from_control_points(grid, c, Feasible::Outside, random.between(1.0, 3.0)).unwrap())
}

fn body<const D: usize>(n: usize, random: &mut SplitMix64) -> Arc<Body<D>> {
    let points: Vec<[f64; D]> = (0..n).map(|_| std::array::from_fn(|_| random.between(-0.8, 0.8))).collect();
    Arc::new(Body::new(&points, 0.0).unwrap())
}

fn kinds<const D: usize>() -> Vec<PoseKind> {
    let rotations: &[Rotation] = if D == 2 {
        &[Rotation::None, Rotation::Angle]
    } else {
        &[Rotation::None, Rotation::Quaternion, Rotation::Vector]
    };
    let both = [Scale::One, Scale::Free];
    rotations.iter().flat_map(|&rotation| both.map(|scale| PoseKind { rotation, scale })).collect()
}

fn parameters<const D: usize>(kind: PoseKind, random: &mut SplitMix64) -> Vec<f64> {
    let mut q: Vec<f64> = (0..kind.n_parameters::<D>()).map(|_| random.between(-0.7, 0.7)).collect();
    if kind.rotation == Rotation::Quaternion {
        q[D] += 1.0;
    }
    if kind.scale == Scale::Free {
        *q.last_mut().unwrap() = random.between(0.7, 1.4);
    }
    q
}

const SMOOTH: [Kind; 4] = [Kind::None, Kind::Ks, Kind::InducedExponential, Kind::PNorm];

fn values<const D: usize>(set: &Constraints<D>, x: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; set.size().n_rows];
    set.values(x, &mut values).unwrap();
    values
}

fn dense<const D: usize>(set: &Constraints<D>, x: &[f64]) -> Vec<f64> {
    let mut jacobian = vec![0.0; set.size().n_rows * set.size().n_variables];
    set.dense_jacobian(x, &mut jacobian).unwrap();
    jacobian
}

/// The whole Hessian, of both triangles.
fn hessian<const D: usize>(set: &Constraints<D>, x: &[f64], lambda: &[f64]) -> Vec<f64> {
    let (n, mut entries) = (set.size().n_variables, vec![0.0; set.size().n_hessian]);
    set.hessian(x, lambda, &mut entries).unwrap();
    let (mut whole, mut at) = (vec![0.0; n * n], 0);
    set.hessian_pattern(|row, column| {
        assert!(column <= row && row < n);
        (whole[row * n + column], whole[column * n + row]) = (entries[at], entries[at]);
        at += 1;
    });
    assert_eq!(at, entries.len());
    whole
}

/// Derivatives against central differences.
fn derivatives_are_those_of_differences<const D: usize>(
    set: &Constraints<D>,
    x: &[f64],
    random: &mut SplitMix64,
    text: &str,
) {
    let (n, m) = (set.size().n_variables, set.size().n_rows);
    let jacobian = dense(set, x);
    let lambda: Vec<f64> = (0..m).map(|_| random.between(-1.0, 1.0)).collect();
    let whole = hessian(set, x, &lambda);
    let size = |v: &[f64]| v.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    let (of_jacobian, of_hessian) = (size(&jacobian), size(&whole));
    let moved = |v: usize, h: f64| {
        let mut x = x.to_vec();
        x[v] += h;
        x
    };
    // Steps so small that hardly a sample crosses a knot, where third derivatives jump.
    let differences = |v: usize, f: &dyn Fn(&[f64]) -> Vec<f64>| -> Vec<f64> {
        const STEP: f64 = 1e-5;
        let [plus, minus] = [STEP, -STEP].map(|h| f(&moved(v, h)));
        plus.iter().zip(minus).map(|(p, m)| (p - m) / (2.0 * STEP)).collect()
    };
    for v in 0..n {
        let slopes = differences(v, &|x| values(set, x));
        for (row, slope) in slopes.iter().enumerate() {
            let own = jacobian[row * n + v];
            assert!((own - slope).abs() < 1e-7 * of_jacobian, "{text}: row {row} by {v}: {own} {slope}");
        }
        let bends = differences(v, &|x| {
            let jacobian = dense(set, x);
            (0..n).map(|w| (0..m).map(|row| lambda[row] * jacobian[row * n + w]).sum()).collect()
        });
        for (w, bend) in bends.iter().enumerate() {
            let own = whole[v * n + w];
            assert!((own - bend).abs() < 1e-5 * of_hessian, "{text}: {v} {w}: {own} {bend} of {of_hessian}");
        }
    }
    products_are_those_of_the_jacobian(set, x, &jacobian, random);
}

fn products_are_those_of_the_jacobian<const D: usize>(
    set: &Constraints<D>,
    x: &[f64],
    dense: &[f64],
    random: &mut SplitMix64,
) {
    let Size { n_variables: n, n_rows: m, n_jacobian, .. } = set.size();
    let mut entries = vec![0.0; n_jacobian];
    set.jacobian(x, &mut entries).unwrap();
    let (mut scattered, mut at, mut last) = (vec![0.0; m * n], 0, 0);
    set.jacobian_pattern(|row, variable| {
        assert!(row >= last);
        last = row;
        scattered[row * n + variable] += entries[at];
        at += 1;
    });
    assert_eq!((at, &scattered[..]), (n_jacobian, dense));
    let (mut both, mut same) = (vec![f64::NAN; m], vec![f64::NAN; n_jacobian]);
    set.values_and_jacobian(x, &mut both, &mut same).unwrap();
    assert_eq!(same, entries);
    let apart = both.iter().zip(values(set, x)).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(apart < 1e-13, "{apart:e}");
    let v: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
    let w: Vec<f64> = (0..m).map(|_| random.between(-1.0, 1.0)).collect();
    let (mut jv, mut jtw) = (vec![0.0; m], vec![0.0; n]);
    set.jacobian_times(x, &v, &mut jv).unwrap();
    set.transposed_jacobian_times(x, &w, &mut jtw).unwrap();
    for row in 0..m {
        let exact: f64 = (0..n).map(|k| dense[row * n + k] * v[k]).sum();
        assert!((jv[row] - exact).abs() < 1e-12 * (1.0 + exact.abs()));
    }
    for k in 0..n {
        let exact: f64 = (0..m).map(|row| dense[row * n + k] * w[row]).sum();
        assert!((jtw[k] - exact).abs() < 1e-12 * (1.0 + exact.abs()));
    }
}

fn of_kind(kind: Kind, random: &mut SplitMix64) -> Aggregation {
    let side = if random.unit() < 0.5 { Side::Below } else { Side::Above };
    Aggregation { kind, sharpness: random.between(1.0, 12.0), side }
}

fn bodies_in_fields<const D: usize>(seed: u64) {
    let mut random = SplitMix64::new(seed);
    for aggregate in SMOOTH {
        for of_body in kinds::<D>() {
            for of_field in kinds::<D>() {
                let mut set = Constraints::<D>::new();
                let (moving, around) = (set.add_frame(of_body).unwrap(), set.add_frame(of_field).unwrap());
                let fixed = set.add_fixed_frame(of_field, &parameters::<D>(of_field, &mut random)).unwrap();
                let n = 1 + (random.bits() % 5) as usize;
                let (a, b) = (body(n, &mut random), field(&mut random));
                let of = of_kind(aggregate, &mut random);
                set.keep_body((a.clone(), moving), (b.clone(), around), of).unwrap();
                set.keep_body((a.clone(), moving), (field(&mut random), fixed), of).unwrap();
                // Against each other, both ways, and in a field that stands where it was fitted.
                set.keep_body((a.clone(), around), (b, moving), of).unwrap();
                set.keep_body((a, around), (field(&mut random), WORLD), of).unwrap();
                let mut x = parameters::<D>(of_body, &mut random);
                x.extend(parameters::<D>(of_field, &mut random));
                let text = format!("{of:?} {of_body:?} {of_field:?} {n} points, {D}D");
                derivatives_are_those_of_differences(&set, &x, &mut random, &text);
            }
        }
    }
}

#[test]
fn bodies_in_fields_of_the_plane() {
    bodies_in_fields::<2>(1);
}

#[test]
fn bodies_in_fields_of_space() {
    bodies_in_fields::<3>(2);
}

fn points_in_fields<const D: usize>(seed: u64) {
    let mut random = SplitMix64::new(seed);
    for aggregate in SMOOTH {
        for of_field in kinds::<D>() {
            let mut set = Constraints::<D>::new();
            // Points before the frame and behind it; one set for itself and aggregated.
            let before = set.add_points(3).unwrap();
            let frame = set.add_frame(of_field).unwrap();
            let behind = set.add_points(2).unwrap();
            let of = of_kind(aggregate, &mut random);
            set.keep_points(before, (field(&mut random), frame), of_kind(Kind::None, &mut random)).unwrap();
            set.keep_points(before, (field(&mut random), frame), of).unwrap();
            set.keep_points(behind, (field(&mut random), frame), of).unwrap();
            set.keep_points(behind, (field(&mut random), WORLD), of).unwrap();
            let mut x: Vec<f64> = (0..3 * D).map(|_| random.between(-1.0, 1.0)).collect();
            x.extend(parameters::<D>(of_field, &mut random));
            x.extend((0..2 * D).map(|_| random.between(-1.0, 1.0)));
            derivatives_are_those_of_differences(&set, &x, &mut random, &format!("{of:?} {of_field:?} {D}D"));
        }
    }
}

#[test]
fn points_in_fields_of_the_plane() {
    points_in_fields::<2>(3);
}

#[test]
fn points_in_fields_of_space() {
    points_in_fields::<3>(4);
}

/// A region of one to four fields by a smooth combination.
fn region<const D: usize>(random: &mut SplitMix64) -> Region<D> {
    let kinds = [Kind::Ks, Kind::InducedExponential, Kind::PNorm];
    let of = of_kind(kinds[(random.bits() % 3) as usize], random);
    let extreme = if random.unit() < 0.5 { Extreme::Least } else { Extreme::Largest };
    let fields = (0..1 + random.bits() % 4).map(|_| field(random)).collect();
    Region::new(fields, extreme, of).unwrap()
}

fn samples_in_regions<const D: usize>(seed: u64) {
    let mut random = SplitMix64::new(seed);
    for aggregate in SMOOTH {
        for of_body in kinds::<D>() {
            for of_region in kinds::<D>() {
                let mut set = Constraints::<D>::new();
                let (moving, around) = (set.add_frame(of_body).unwrap(), set.add_frame(of_region).unwrap());
                let points = set.add_points(2).unwrap();
                let n = 1 + (random.bits() % 5) as usize;
                let (a, of) = (body(n, &mut random), of_kind(aggregate, &mut random));
                set.keep_body((a.clone(), moving), (region(&mut random), around), of).unwrap();
                set.keep_body((a, around), (region(&mut random), WORLD), of).unwrap();
                set.keep_points(points, (region(&mut random), around), of).unwrap();
                let mut x = parameters::<D>(of_body, &mut random);
                x.extend(parameters::<D>(of_region, &mut random));
                x.extend((0..2 * D).map(|_| random.between(-1.0, 1.0)));
                let text = format!("{of:?} {of_body:?} {of_region:?} {n} points, {D}D");
                derivatives_are_those_of_differences(&set, &x, &mut random, &text);
            }
        }
    }
}

#[test]
fn samples_in_regions_of_the_plane() {
    samples_in_regions::<2>(9);
}

#[test]
fn samples_in_regions_of_space() {
    samples_in_regions::<3>(10);
}

/// The values of `points` in each of `fields`, and combined.
fn combined<const D: usize>(
    fields: &[Arc<Field<D>>],
    extreme: Extreme,
    of: Aggregation,
    points: &[[f64; D]],
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let each = Aggregation { kind: Kind::None, ..of };
    let values_in = |region: Region<D>| {
        let mut set = Constraints::<D>::new();
        let body = Arc::new(Body::new(points, 0.0).unwrap());
        set.keep_body((body, WORLD), (region, WORLD), each).unwrap();
        values(&set, &[])
    };
    let alone = fields.iter().map(|field| values_in(field.clone().into())).collect();
    (alone, values_in(Region::new(fields.to_vec(), extreme, of).unwrap()))
}

/// Sample by sample, of more samples than a block has and of more fields than leave a whole block of them.
fn combinations_are_aggregates_of_the_fields<const D: usize>(seed: u64) {
    let mut random = SplitMix64::new(seed);
    for n_fields in [1, 2, 3, 7, 200] {
        let fields: Vec<_> = (0..n_fields).map(|_| field::<D>(&mut random)).collect();
        let unit = fields.iter().fold(0.0, |most: f64, field| most.max(field.diagonal()));
        let points: Vec<[f64; D]> = (0..300).map(|_| std::array::from_fn(|_| random.between(-1.5, 1.5))).collect();
        for kind in [Kind::Ks, Kind::InducedExponential, Kind::PNorm, Kind::Minimum] {
            for extreme in [Extreme::Least, Extreme::Largest] {
                let of = Aggregation { kind, ..of_kind(kind, &mut random) };
                let (alone, together) = combined(&fields, extreme, of, &points);
                for (i, value) in together.iter().enumerate() {
                    let phi: Vec<f64> = alone.iter().map(|values| values[i]).collect();
                    let one = aggregate(of, extreme, unit, &phi, Derivatives::default()).unwrap();
                    assert!((value - one).abs() < 1e-13, "{of:?} {extreme:?} of {n_fields}: {value} {one}");
                    let end = match extreme {
                        Extreme::Least => phi.iter().copied().fold(f64::INFINITY, f64::min),
                        Extreme::Largest => phi.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                    };
                    // As far below and above as the aggregate of the least of the negatives above and below.
                    let (sign, of_least) = extreme.by_the_least(of);
                    let [mut low, mut high] = of_least.bounds(n_fields, sign * end / unit).map(|by| by * unit);
                    if sign < 0.0 {
                        (low, high) = (high, low);
                    }
                    let text = format!("{of:?} {extreme:?} of {n_fields}: {value}, {end}");
                    assert!(*value >= end - low - 1e-13 && *value <= end + high + 1e-13, "{text}");
                    // Nothing beyond the side, and KS within what the docs say.
                    assert_eq!(if of.side == Side::Below { high } else { low }, 0.0, "{text}");
                    let most = unit * (n_fields as f64).ln() / of.sharpness;
                    assert!(kind != Kind::Ks || (low + high - most).abs() < 1e-13, "{text}");
                    assert!(kind != Kind::Minimum || *value == end, "{text}");
                }
            }
        }
    }
}

#[test]
fn combinations_of_the_plane_are_aggregates_of_the_fields() {
    combinations_are_aggregates_of_the_fields::<2>(11);
}

#[test]
fn combinations_of_space_are_aggregates_of_the_fields() {
    combinations_are_aggregates_of_the_fields::<3>(12);
}

/// About the signed distance to the ball of `radius` around `center`, positive inside: splines of its values on a fine grid.
fn ball<const D: usize>(center: [f64; D], radius: f64) -> Arc<Field<D>> {
    let grid = Grid { axes: [Axis { lower: -2.0, cell: 0.1, n_cells: 40 }; D] };
    let counts = grid.axes.map(|axis| axis.n_cells + 3);
    let c = (0..grid.n_control())
        .map(|i| {
            let (mut rest, mut square) = (i, 0.0);
            for a in (0..D).rev() {
                let x = -2.0 + 0.1 * ((rest % counts[a]) as f64 - 1.0);
                rest /= counts[a];
                square += (x - center[a]).powi(2);
            }
            radius - square.sqrt()
        })
        .collect();
    Arc::new(Field::from_control_points(grid, c, Feasible::Outside, 4.0).unwrap())
}

/// Two balls that overlap: the union has a body that neither holds, the intersection has only what both hold.
fn unions_hold_what_no_part_holds<const D: usize>() {
    let point = |x: f64| std::array::from_fn(|a| if a == 0 { x } else { 0.0 });
    let tanks = [-0.6, 0.6].map(|x| ball::<D>(point(x), 0.9));
    let rod: Vec<[f64; D]> = (0..=24).map(|i| point(-1.2 + 0.1 * i as f64)).collect();
    for kind in [Kind::Ks, Kind::InducedExponential, Kind::PNorm, Kind::Minimum] {
        let of = Aggregation { kind, sharpness: 100.0, side: Side::Below };
        let (alone, union) = combined(&tanks, Extreme::Largest, of, &rod);
        assert!(alone.iter().all(|values| values.iter().any(|v| *v < -0.5)));
        assert!(union.iter().all(|v| *v > 0.1), "{of:?}: {union:?}");
        let (_, both) = combined(&tanks, Extreme::Least, of, &rod);
        for (i, value) in both.iter().enumerate() {
            assert_eq!(*value > 0.0, (10..=14).contains(&i), "{of:?}: {both:?}");
        }
        // A path in the union, as one value.
        let mut set = Constraints::<D>::new();
        let path = set.add_points(2).unwrap();
        let whole = Aggregation { sharpness: 100.0, ..Aggregation::default() };
        let region = Region::new(tanks.to_vec(), Extreme::Largest, of).unwrap();
        set.keep_points(path, (region, WORLD), whole).unwrap();
        let at = |x: f64, y: f64| [point(x), point(y)].concat();
        let values = [at(-1.2, 1.2), at(-1.2, 1.8)].map(|x| values(&set, &x)[0]);
        assert!(values[0] > 0.1 && values[1] < -0.2, "{of:?}: {values:?}");
    }
}

#[test]
fn unions_of_the_plane_hold_what_no_part_holds() {
    unions_hold_what_no_part_holds::<2>();
}

#[test]
fn unions_of_space_hold_what_no_part_holds() {
    unions_hold_what_no_part_holds::<3>();
}

/// Where the safe side costs something: of KS in an intersection where the fields are equal, in a union where one stands alone; of the
/// induced exponential in an intersection at both, in a union at neither.
#[test]
fn what_is_lost_on_the_safe_side_is_lost_where_the_docs_say() {
    let (level, deep) = (constant(0.3), constant(-3.0));
    let equal = vec![level.clone(); 4];
    let alone = |others: Arc<Field<2>>| vec![others.clone(), level.clone(), others.clone(), others];
    let (rho, unit, n) = (50.0, 2.0, 4.0_f64);
    let lost = |kind, extreme, fields: &[Arc<Field<2>>]| {
        let of = Aggregation { kind, sharpness: rho, side: Side::Below };
        0.3 - combined(fields, extreme, of, &[[0.1, 0.2]]).1[0]
    };
    let (ks, exponential) = (Kind::Ks, Kind::InducedExponential);
    let by_ks = unit * n.ln() / rho;
    let by_exponential = unit * Aggregation { kind: exponential, sharpness: rho, side: Side::Below }.bounds(4, 0.0)[0];
    assert!(by_exponential > 0.0 && by_exponential < by_ks);
    for (kind, extreme, fields, right) in [
        (ks, Extreme::Least, &equal, by_ks),
        (ks, Extreme::Least, &alone(constant(3.0)), 0.0),
        (ks, Extreme::Largest, &equal, 0.0),
        (ks, Extreme::Largest, &alone(deep.clone()), by_ks),
        (exponential, Extreme::Least, &equal, by_exponential),
        (exponential, Extreme::Least, &alone(constant(3.0)), by_exponential),
        (exponential, Extreme::Largest, &equal, 0.0),
        (exponential, Extreme::Largest, &alone(deep), 0.0),
    ] {
        let found = lost(kind, extreme, fields);
        assert!((found - right).abs() < 1e-12, "{kind:?} {extreme:?}: {found} for {right}");
    }
}

/// phi is `value` in the box; D is 2.
fn constant(value: f64) -> Arc<Field<2>> {
    let grid = Grid { axes: [Axis { lower: -1.0, cell: 0.5, n_cells: 4 }; 2] };
    Arc::new(Field::from_control_points(grid, vec![value; grid.n_control()], Feasible::Outside, 2.0).unwrap())
}

/// The hard ones have the gradient of the first field that has the value, and no Hessian; a field alone is itself.
#[test]
fn hard_combinations_have_gradients_alone() {
    let mut random = SplitMix64::new(13);
    let fields: Vec<_> = (0..3).map(|_| field::<3>(&mut random)).collect();
    let hard = Aggregation { kind: Kind::Minimum, ..Aggregation::default() };
    for extreme in [Extreme::Least, Extreme::Largest] {
        let mut set = Constraints::<3>::new();
        let points = set.add_points(20).unwrap();
        let each = Aggregation { kind: Kind::None, ..hard };
        set.keep_points(points, (Region::new(fields.clone(), extreme, hard).unwrap(), WORLD), each).unwrap();
        for field in &fields {
            set.keep_points(points, (field.clone(), WORLD), each).unwrap();
        }
        set.keep_points(points, (Region::new(fields[1..2].to_vec(), extreme, hard).unwrap(), WORLD), each).unwrap();
        let x: Vec<f64> = (0..60).map(|_| random.between(-1.0, 1.0)).collect();
        let (values, jacobian) = (values(&set, &x), dense(&set, &x));
        for i in 0..20 {
            let better = |f: usize, g: usize| match extreme {
                Extreme::Least => values[f * 20 + i] < values[g * 20 + i],
                Extreme::Largest => values[f * 20 + i] > values[g * 20 + i],
            };
            let one = (2..=3).fold(1, |one, f| if better(f, one) { f } else { one });
            let row = |r: usize| &jacobian[(r * 20 + i) * 60..(r * 20 + i + 1) * 60];
            assert_eq!((values[i], row(0)), (values[one * 20 + i], row(one)));
            assert_eq!((values[80 + i], row(4)), (values[40 + i], row(2)));
        }
        let mut entries = vec![0.0; set.size().n_hessian];
        let mut lambda = vec![1.0; 100];
        let error = set.hessian(&x, &lambda, &mut entries).unwrap_err();
        assert!(
            matches!(&error, Error::Unsupported(text) if text.contains("value 0 are combined by a minimum")),
            "{error}"
        );
        lambda[..20].fill(0.0);
        set.hessian(&x, &lambda, &mut entries).unwrap();
    }
}

#[test]
fn bad_regions_are_refused() {
    let mut random = SplitMix64::new(14);
    let one = field::<2>(&mut random);
    let text =
        |n: usize, of: Aggregation| Region::new(vec![one.clone(); n], Extreme::Largest, of).unwrap_err().to_string();
    let ks = Aggregation::default();
    assert!(text(0, ks).contains("0 fields are given; from 1 to 256"));
    assert!(text(257, ks).contains("257 fields"));
    assert!(text(2, Aggregation { kind: Kind::None, ..ks }).contains("no combination"));
    assert!(text(2, Aggregation { sharpness: 0.5, ..ks }).contains("sharpness is 0.5"));
    // Where a sample is bad, it is named as in a field.
    let mut set = Constraints::<2>::new();
    let points = set.add_points(200).unwrap();
    let region = Region::new(vec![one.clone(); 3], Extreme::Least, ks).unwrap();
    set.keep_points(points, (region, WORLD), ks).unwrap();
    let (mut x, mut value) = (vec![0.0; 400], [0.0]);
    x[2 * 150] = 1e200;
    let error = set.values(&x, &mut value).unwrap_err().to_string();
    assert!(error.contains("samples of value 0") && error.contains("150"), "{error}");
}

/// More samples than a block has, on its faces and outside too: aggregates are those of the values one by one.
fn aggregates_are_those_of_the_values<const D: usize>(seed: u64) {
    let mut random = SplitMix64::new(seed);
    let (field, kind) = (field::<D>(&mut random), PoseKind { rotation: Rotation::None, scale: Scale::Free });
    let n = 700;
    let points: Vec<[f64; D]> = (0..n)
        .map(|i| {
            std::array::from_fn(|a| {
                let axis = field.grid().axes[a];
                let xi = random.between(-1.0, axis.n_cells as f64 + 1.0);
                axis.lower + axis.cell * if (i + a) % 3 == 0 { xi.round() } else { xi }
            })
        })
        .collect();
    let body = Arc::new(Body::new(&points, 0.1).unwrap());
    for kind_of in [Kind::Ks, Kind::InducedExponential, Kind::PNorm, Kind::Minimum] {
        for side in [Side::Below, Side::Above] {
            let of = Aggregation { kind: kind_of, sharpness: 40.0, side };
            let mut set = Constraints::<D>::new();
            let frame = set.add_frame(kind).unwrap();
            set.keep_body((body.clone(), frame), (field.clone(), WORLD), of).unwrap();
            let each = Aggregation { kind: Kind::None, ..of };
            set.keep_body((body.clone(), frame), (field.clone(), WORLD), each).unwrap();
            let mut x = vec![0.0; D + 1];
            x[D] = 1.0;
            let values = values(&set, &x);
            let mut weights = vec![0.0; n];
            let wanted = Derivatives { gradient: Some(&mut weights), hessian: None };
            let one = aggregate(of, Extreme::Least, field.diagonal(), &values[1..], wanted).unwrap();
            assert!((values[0] - one).abs() < 1e-12, "{of:?}: {} {one}", values[0]);
            let jacobian = dense(&set, &x);
            for k in 0..D + 1 {
                let chained: f64 = (0..n).map(|i| weights[i] * jacobian[(1 + i) * (D + 1) + k]).sum();
                assert!((jacobian[k] - chained).abs() < 1e-11, "{of:?}: {} {chained}", jacobian[k]);
            }
        }
    }
}

#[test]
fn aggregates_over_many_blocks_are_those_of_the_values() {
    aggregates_are_those_of_the_values::<2>(5);
    aggregates_are_those_of_the_values::<3>(6);
}

/// The field moved one way is the body moved the other.
#[test]
fn only_the_relative_pose_counts() {
    let mut random = SplitMix64::new(7);
    let kind = PoseKind { rotation: Rotation::Quaternion, scale: Scale::Free };
    let (field, body) = (field::<3>(&mut random), body(50, &mut random));
    for _ in 0..20 {
        let (q, shared) = (parameters::<3>(kind, &mut random), parameters::<3>(kind, &mut random));
        let value = |of_body: &[f64], of_field: &[f64]| {
            let mut set = Constraints::<3>::new();
            let frames = [of_body, of_field].map(|q| set.add_fixed_frame(kind, q).unwrap());
            set.keep_body((body.clone(), frames[0]), (field.clone(), frames[1]), Aggregation::default()).unwrap();
            values(&set, &[])[0]
        };
        let moved = |q: &[f64], by: &[f64]| -> Vec<f64> {
            // by after q: s = s_2 s_1, R = R_2 R_1 as quaternions, t = s_2 R_2 t_1 + t_2.
            let pose = pose::Pose::<3>::at(kind, by, Order::Value).unwrap();
            let t = applied(&pose.linear, [q[0], q[1], q[2]]);
            let (a, b) = (&by[3..7], &q[3..7]);
            let mut both: Vec<f64> = (0..3).map(|k| t[k] + by[k]).collect();
            both.extend([
                a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
                q[7] * by[7],
            ]);
            both
        };
        let identity = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let (alone, together) = (value(&q, &identity), value(&moved(&q, &shared), &shared));
        assert!((together - shared[7] * alone).abs() < 1e-12, "{together} {alone}");
    }
}

#[test]
fn bad_requests_are_refused_and_change_nothing() {
    let mut random = SplitMix64::new(8);
    let (field, body) = (field::<3>(&mut random), body::<3>(3, &mut random));
    let mut set = Constraints::<3>::new();
    let frame = set.add_frame(PoseKind { rotation: Rotation::Quaternion, scale: Scale::Free }).unwrap();
    let minimum = Aggregation { kind: Kind::Minimum, ..Aggregation::default() };
    set.keep_body((body.clone(), frame), (field.clone(), WORLD), minimum).unwrap();
    let before = set.size();
    let text = |end: Result<usize>| end.unwrap_err().to_string();
    let ks = Aggregation::default();
    assert!(text(set.keep_body((body.clone(), FrameId(7)), (field.clone(), WORLD), ks)).contains("no frame 7"));
    assert!(text(set.keep_body((body.clone(), frame), (field.clone(), frame), ks)).contains("both move with frame 1"));
    assert!(text(set.keep_points(PointsId(0), (field.clone(), WORLD), ks)).contains("no set of points 0"));
    assert!(
        text(set.keep_body((body.clone(), frame), (field, WORLD), Aggregation { sharpness: f64::NAN, ..ks }))
            .contains("NaN")
    );
    assert!(set.add_frame(PoseKind { rotation: Rotation::Angle, scale: Scale::One }).is_err());
    assert!(set.add_points(0).is_err() && set.add_points(usize::MAX).is_err());
    assert!(set.add_fixed_frame(PoseKind { rotation: Rotation::None, scale: Scale::One }, &[0.0; 2]).is_err());
    assert_eq!(set.size(), before);

    let mut one = [0.0];
    let mut x = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    set.values(&x, &mut one).unwrap();
    assert!(set.values(&x[1..], &mut one).unwrap_err().to_string().contains("7 entries; there are 8 variables"));
    assert!(set.values(&x, &mut []).is_err());
    let mut entries = vec![0.0; set.size().n_hessian];
    assert!(matches!(set.hessian(&x, &[1.0], &mut entries), Err(Error::Unsupported(_))));
    set.hessian(&x, &[0.0], &mut entries).unwrap();
    x[7] = 0.0;
    assert!(
        set.values(&x, &mut one)
            .unwrap_err()
            .to_string()
            .contains("frame 1, with variables from 0 on: parameter 7 is the scale 0")
    );
    x[2] = f64::NAN;
    assert!(set.values(&x, &mut one).unwrap_err().to_string().contains("variable 2 is NaN"));
    (x[2], x[7]) = (1e200, 1.0);
    assert!(set.values(&x, &mut one).unwrap_err().to_string().contains("samples of value 0"));
}
