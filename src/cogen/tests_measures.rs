//! Collision measures, their sensitivities, colliding cells and the measure's graph against sums over all cells and times.

use super::conflict::Side;
use super::correlation::Correlation;
use super::cut::cut;
use super::grid::Grid;
use super::motion::{Law, Motion};
use super::part::Part;
use super::steps::Relative;
use super::tests::{case, table};
use crate::geometry::random::SplitMix64;
use crate::geometry::rigid::Rigid;
use crate::par::Workers;
use crate::progress::Progress;
use std::f64::consts::TAU;

/// Steps of `n` at which the centre of each of `moving`'s cells is in each of `still`'s, in the frame that `pose`(t) moves it to.
fn visits<const D: usize>(
    still: &Part<D>,
    moving: &Part<D>,
    n: usize,
    pose: impl Fn(f64) -> Rigid<D>,
) -> Vec<Vec<u32>> {
    let (one, two) = (still.grid(), moving.grid());
    let mut table = vec![vec![0; one.n_cells()]; two.n_cells()];
    for k in 0..n {
        let pose = pose((k as f64 + 0.5) / n as f64);
        for j in moving.allowed().iter() {
            let p = pose.apply(two.center(j));
            let place: [f64; D] = std::array::from_fn(|a| ((p[a] - one.corner()[a]) / one.cell()).floor());
            if (0..D).all(|a| (0.0..one.counts()[a] as f64).contains(&place[a])) {
                let i = one.number(place.map(|x| x as usize));
                table[j][i] += u32::from(still.allowed().has(i));
            }
        }
    }
    table
}

fn measures_are_sums_over_trajectories<const D: usize>(seed: u64) {
    let mut random = SplitMix64::new(seed);
    let workers = Workers::new(2).unwrap();
    let mut n_visits = 0;
    for round in 0..20 {
        let (whole, relative) = case::<D>(&mut random);
        let parts = whole.map(|p| Part::of_centers(*p.grid(), |x| x[0] + x[1] > -1.3).unwrap());
        let pair = [&parts[0], &parts[1]];
        // Long enough for stays of more than 255 steps.
        let n = if round < 3 { 3000 } else { 40 };
        let correlation = Correlation::new(pair, &relative, n, 1 << 30, &workers, &mut Progress::silent()).unwrap();
        n_visits += correlation.n_visits();
        let n21 = visits(pair[1], pair[0], n, |t| relative.at(t).inverse());
        let n12 = visits(pair[0], pair[1], n, |t| relative.at(t));
        let [n1, n2] = pair.map(|p| p.grid().n_cells());
        let mut density = |p: &Part<D>| -> Vec<f64> {
            (0..p.grid().n_cells()).map(|i| if p.allowed().has(i) { random.unit() } else { 0.0 }).collect()
        };
        let rho = [density(pair[0]), density(pair[1])];
        let each = || (0..n1).flat_map(|i| (0..n2).map(move |j| (i, j)));
        let w12 = |i: usize, j: usize| pair[1].grid().measure() * f64::from(n12[j][i]) / n as f64;
        let w21 = |i: usize, j: usize| pair[0].grid().measure() * f64::from(n21[i][j]) / n as f64;
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-13 * (1.0 + b.abs());

        let found = correlation.measures([&rho[0], &rho[1]], &workers).unwrap();
        assert!(near(found.g21, each().map(|(i, j)| rho[0][i] * w12(i, j) * rho[1][j]).sum()));
        assert!(near(found.g12, each().map(|(i, j)| rho[0][i] * w21(i, j) * rho[1][j]).sum()));

        let mut d = [[vec![0.0; n1], vec![0.0; n2]], [vec![0.0; n1], vec![0.0; n2]]];
        let [[a, b], [c, e]] = &mut d;
        correlation.sensitivities([&rho[0], &rho[1]], [[a, b], [c, e]], &workers).unwrap();
        // g is linear in each density: a difference of any size is the derivative.
        for (k, d) in d.iter().enumerate() {
            for (side, i) in [(0, random.bits() as usize % n1), (1, random.bits() as usize % n2)] {
                if !pair[side].allowed().has(i) {
                    continue;
                }
                let at = |x: f64| {
                    let mut moved = rho.clone();
                    moved[side][i] = x;
                    let m = correlation.measures([&moved[0], &moved[1]], &workers).unwrap();
                    [m.g21, m.g12][k]
                };
                assert!(near(d[side][i], at(1.0) - at(0.0)), "{k} {side}");
            }
        }

        let conflicts = correlation.conflicts(1 << 30, &workers, &mut Progress::silent()).unwrap();
        let table = table(&conflicts);
        assert!(each().all(|(i, j)| table[i][j] == (n12[j][i] + n21[i][j] > 0)));
        let colliding = correlation.colliding(&workers).unwrap();
        assert!((0..n1).all(|i| colliding[0].has(i) == (0..n2).any(|j| table[i][j])));
        assert!((0..n2).all(|j| colliding[1].has(j) == (0..n1).any(|i| table[i][j])));
        let weights = [vec![1; n1], vec![1; n2]];
        let room = pair.map(|p| p.allowed().clone());
        let best = cut(&conflicts, &room, [&weights[0], &weights[1]], &mut Progress::silent()).unwrap().pair;
        let kept = best.cells.map(|set| (0..set.len()).map(|i| f64::from(u8::from(set.has(i)))).collect::<Vec<_>>());
        let free = correlation.measures([&kept[0], &kept[1]], &workers).unwrap();
        assert_eq!((free.g21, free.g12), (0.0, 0.0));
    }
    assert!(n_visits > 300, "{n_visits}");
}

#[test]
fn measures_are_sums_over_trajectories_in_the_plane() {
    measures_are_sums_over_trajectories::<2>(11);
}

#[test]
fn measures_are_sums_over_trajectories_in_space() {
    measures_are_sums_over_trajectories::<3>(12);
}

/// (33) and (34) look at centres of one part in cells of the other: of cells in conflict some are met by no centre.
#[test]
fn one_direction_misses_cells_that_collide() {
    let n = 100;
    let square = |x: f64| Part::whole(Grid::<2>::new([x - 0.5, -0.5], 1.0 / n as f64, [n, n]).unwrap()).unwrap();
    let parts = [square(0.0), square(1.0)];
    let turn = |x: f64, turns: f64| Motion::turn([x, 0.0], Law::even(turns * TAU)).unwrap();
    let relative = Relative { from: turn(0.0, 1.0), of: turn(1.0, -1.0) };
    let (workers, silent) = (Workers::caller_only(), &mut Progress::silent());
    let correlation = Correlation::new([&parts[0], &parts[1]], &relative, 500, 1 << 30, &workers, silent).unwrap();
    let mut own = vec![0.0; n * n];
    correlation.local(Side::First, &vec![1.0; n * n], &mut own, &workers);
    let met = own.iter().filter(|x| **x > 0.0).count();
    let all = correlation.colliding(&workers).unwrap()[0].count();
    // A few cells of four thousand, which would be left in what is called free.
    assert!(met < all && met + 20 > all && all > 4000, "{met} {all}");
}

#[test]
fn densities_that_are_none_are_refused() {
    let (whole, relative) = case::<2>(&mut SplitMix64::new(1));
    let parts = whole.map(|p| Part::of_centers(*p.grid(), |x| x[0] > p.grid().center(0)[0]).unwrap());
    let workers = Workers::caller_only();
    let pair = [&parts[0], &parts[1]];
    let correlation = Correlation::new(pair, &relative, 10, 1 << 30, &workers, &mut Progress::silent()).unwrap();
    let [n1, n2] = pair.map(|p| p.grid().n_cells());
    let told = |one: &[f64], two: &[f64]| correlation.measures([one, two], &workers).unwrap_err().to_string();
    let zeros = vec![0.0; n2];
    assert!(told(&zeros[..1], &zeros).contains("for part 1's"));
    let mut one = vec![0.0; n1];
    one[0] = 0.5;
    assert!(told(&one, &zeros).contains("density 0 of part 1 is 0.5; it must be 0"));
    one[0] = f64::NAN;
    assert!(told(&one, &zeros).contains("[0, 1]"));
    let few = Correlation::new(pair, &relative, 10, 1, &workers, &mut Progress::silent());
    assert!(few.is_err_and(|e| e.to_string().contains("the limit is 1 bytes")));
}
