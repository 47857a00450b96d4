//! The form on a tree against that of a grid.

use super::*;
use crate::field::distance::FarDistances;
use crate::field::energy::Energy;
use crate::geometry::random::SplitMix64;
use crate::geometry::shapes::{box_mesh, circle};
use crate::linalg::cg::System;
use crate::spline::{Axis, Grid};

const WEIGHTS: EnergyWeights = EnergyWeights { normal: 1e-4, smooth: 3e-8 };

fn grid<const D: usize>(n_cells: [usize; D]) -> Grid<D> {
    Grid { axes: n_cells.map(|n| Axis { lower: 0.0, cell: 1.0 / n as f64, n_cells: n }) }
}

fn in_space() -> Cloud<3> {
    box_mesh([0.15, 0.2, 0.25], [0.8, 0.75, 0.85]).unwrap().sample(700, 1).unwrap()
}

fn in_plane() -> Cloud<2> {
    circle([0.5; 2], 0.36, 300).unwrap().sample(200, 1).unwrap()
}

fn energy<const D: usize>(cloud: &Cloud<D>, tree: Tree<D>, held: f64) -> RefinedEnergy<D> {
    let data = Data::new(cloud, tree.grid()).unwrap();
    let space = Space::new(&tree).unwrap();
    RefinedEnergy::new(
        (tree, space),
        data,
        WEIGHTS,
        Holding { weight: held, nearest: 1.0, spacings: 0.0 },
        &Workers::caller_only(),
        || Ok(()),
    )
    .unwrap()
}

/// The form on the cells of one grid.
fn flat<const D: usize>(cloud: &Cloud<D>, grid: Grid<D>, level: u32, held: f64) -> Energy<D> {
    let weights = EnergyWeights {
        normal: WEIGHTS.normal * NORMAL_FALL.powi(level as i32),
        smooth: WEIGHTS.smooth * SMOOTH_FALL.powi(level as i32),
    };
    let mut energy = Energy::new(Data::new(cloud, &grid).unwrap(), grid, weights).unwrap();
    if held > 0.0 {
        let far = FarDistances::new(cloud.clone(), &grid, &Workers::caller_only(), |_| Ok(())).unwrap();
        energy.hold(far, held).unwrap();
    }
    energy.reserve().unwrap();
    energy
}

fn close(x: &[f64], y: &[f64]) -> bool {
    let size = y.iter().fold(0.0, |m: f64, y| m.max(y.abs()));
    x.len() == y.len() && x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-12 * size)
}

/// Places in vectors of the functions of one level, row-major.
fn places<const D: usize>(space: &Space<D>, level: u32, shape: [usize; D]) -> Vec<usize> {
    let function = |mut i: usize| {
        let mut f = [0; D];
        for a in (0..D).rev() {
            (f[a], i) = (i % shape[a], i / shape[a]);
        }
        f
    };
    (0..shape.iter().product()).map(|i| space.index(level, function(i)).unwrap()).collect()
}

/// Cut once everywhere, or not at all, the form is that of a grid.
fn agrees_with_that_of_a_grid<const D: usize>(cloud: &Cloud<D>, n_cells: [usize; D], cut: bool) {
    let workers = Workers::caller_only();
    let mut tree = Tree::new(grid(n_cells)).unwrap();
    if cut {
        tree.tiles().to_vec().iter().for_each(|t| assert!(tree.cut(0, t.place).unwrap()));
    }
    let (level, factor) = if cut { (1, 2) } else { (0, 1) };
    let of_grid = grid(n_cells.map(|n| n * factor));
    for held in [0.0, 150.0] {
        let mut energy = energy(cloud, tree.clone(), held);
        let mut flat = flat(cloud, of_grid, level, held);
        let at = places(energy.space(), level, of_grid.shape());
        assert_eq!(energy.space().n_active(), at.len());
        let pick = |y: &[f64]| at.iter().map(|i| y[*i]).collect::<Vec<_>>();
        let b = energy.right_hand_side(&workers, -1.0).unwrap();
        assert!(close(&pick(&b), &flat.right_hand_side(&workers, -1.0).unwrap()), "{n_cells:?} held {held}");
        let mut random = SplitMix64::new(5);
        let x: Vec<f64> = at.iter().map(|_| random.between(-1.0, 1.0)).collect();
        let (mut y, mut mine, mut ours) = (vec![0.0; x.len()], vec![0.0; b.len()], vec![0.0; b.len()]);
        flat.apply(&workers, &x, &mut y);
        at.iter().zip(&x).for_each(|(i, x)| mine[*i] = *x);
        energy.apply(&workers, &mine, &mut ours);
        assert!(close(&pick(&ours), &y), "{n_cells:?} held {held}");
        energy.renew_preconditioner(&workers);
        let diagonal: Vec<f64> = pick(&energy.inverse).iter().map(|i| 1.0 / i).collect();
        assert!(close(&diagonal, &flat.diagonal(&workers).unwrap()), "{n_cells:?} held {held}");
    }
}

#[test]
fn it_is_that_of_a_grid_where_nothing_or_everything_is_cut() {
    for cut in [false, true] {
        for n_cells in [[4, 8, 5], [1, 6, 9], [7, 2, 3]] {
            agrees_with_that_of_a_grid(&in_space(), n_cells, cut);
        }
        for n_cells in [[8, 8], [5, 3], [1, 13]] {
            agrees_with_that_of_a_grid(&in_plane(), n_cells, cut);
        }
    }
}

fn cut_at_random<const D: usize>(n_cells: [usize; D], seed: u64) -> Tree<D> {
    let mut random = SplitMix64::new(seed);
    let mut tree = Tree::new(grid(n_cells)).unwrap();
    for _ in 0..6 {
        let level = (3.0 * random.unit()) as u32;
        tree.cut(level, std::array::from_fn(|a| (tree.n_cells(level, a) as f64 / 4.0 * random.unit()) as u32)).unwrap();
    }
    tree
}

fn is_symmetric_and_positive<const D: usize>(cloud: &Cloud<D>, n_cells: [usize; D], seed: u64) {
    let workers = Workers::caller_only();
    let mut energy = energy(cloud, cut_at_random(n_cells, seed), 150.0);
    let n = energy.space().n_numbers();
    let mut random = SplitMix64::new(seed);
    let mut vector = || {
        let mut x: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
        energy.space().keep_active(&mut x);
        x
    };
    let (x, y) = (vector(), vector());
    let (mut ax, mut ay) = (vec![0.0; n], vec![0.0; n]);
    energy.apply(&workers, &x, &mut ax);
    energy.apply(&workers, &y, &mut ay);
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    assert!((dot(&y, &ax) - dot(&x, &ay)).abs() < 1e-11 * dot(&x, &ax));
    assert!(dot(&x, &ax) > 0.0);
    let (mut again, workers) = (vec![0.0; n], Workers::new(3).unwrap());
    energy.apply(&workers, &x, &mut again);
    assert_eq!(again, ax, "threads change bits");
}

#[test]
fn it_is_symmetric_and_positive_and_the_same_on_any_number_of_threads() {
    for seed in 0..4 {
        is_symmetric_and_positive(&in_space(), [5, 4, 9], seed);
        is_symmetric_and_positive(&in_plane(), [9, 6], seed);
    }
}

/// Cut step by step or at once, the same distances are held.
fn holds_what_the_tree_asks_for<const D: usize>(cloud: &Cloud<D>, n_cells: [usize; D], seed: u64) {
    let (workers, mut random) = (Workers::caller_only(), SplitMix64::new(seed));
    let mut tree = Tree::new(grid(n_cells)).unwrap();
    let of = |tree: &Tree<D>| {
        let (data, space) = (Data::new(cloud, tree.grid()).unwrap(), Space::new(tree).unwrap());
        let holding = Holding { weight: 150.0, nearest: 0.5, spacings: 1.0 };
        let parts = (tree.clone(), space);
        RefinedEnergy::new(parts, data, WEIGHTS, holding, &workers, || Ok(())).unwrap()
    };
    let (mut by_steps, mut n_held) = (of(&tree), Vec::new());
    for _ in 0..12 {
        let level = (3.0 * random.unit()) as u32;
        let place = std::array::from_fn(|a| (tree.n_cells(level, a) as f64 / 4.0 * random.unit()) as u32);
        tree.cut(level, place).unwrap();
        let (space, x) = (Space::new(&tree).unwrap(), vec![0.0; by_steps.space().n_numbers()]);
        by_steps.refine(tree.clone(), space, &x, &workers, || Ok(())).unwrap();
        let at_once = of(&tree);
        // Of tiles that are cut the distances say nothing.
        let held = |energy: &RefinedEnergy<D>| {
            let (far, tiles) = (energy.far.as_ref().unwrap(), tree.tiles());
            let of_cell = |(i, (m, d)): (usize, (&f64, &f64))| {
                let counts = *m > 0.0 && tiles[i / per_pack::<D>()].is_leaf();
                (*m, if counts { *d } else { 0.0 })
            };
            far.mass.iter().zip(&far.distance).enumerate().map(of_cell).collect::<Vec<_>>()
        };
        assert!(held(&by_steps) == held(&at_once), "{n_cells:?} {seed}");
        assert_eq!(by_steps.clear(), at_once.clear());
        n_held.push(held(&at_once).iter().filter(|(m, _)| *m > 0.0).count());
    }
    assert!(n_held[11] > 0);
}

#[test]
fn what_is_held_depends_on_the_tree_alone() {
    for seed in 0..4 {
        holds_what_the_tree_asks_for(&in_space(), [9, 8, 11], seed);
        holds_what_the_tree_asks_for(&in_plane(), [20, 13], seed);
    }
}
