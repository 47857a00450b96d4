//! Gaps over the motion against distances between points of cells.

use super::bits::Bits;
use super::closure::close;
use super::conflict::{Conflicts, OverlapOptions, Side};
use super::contact::contact;
use super::grid::Grid;
use super::tests::case;
use crate::geometry::random::SplitMix64;
use crate::geometry::rigid::Rigid;
use crate::geometry::vec::{add, norm, sub};
use crate::par::Workers;
use crate::progress::Progress;

/// Distance between two cells by points of theirs: from above, and the finer the nearer.
fn gap_by_points<const D: usize>(one: &Grid<D>, two: &Grid<D>, i: usize, j: usize, pose: &Rigid<D>, n: usize) -> f64 {
    let points = |grid: &Grid<D>, k: usize| -> Vec<[f64; D]> {
        let at = |m: usize| grid.cell() * (m as f64 / (n - 1) as f64 - 0.5);
        (0..n.pow(D as u32))
            .map(|m| add(grid.center(k), std::array::from_fn(|a| at(m / n.pow(a as u32) % n))))
            .collect()
    };
    let (p, q) = (points(one, i), points(two, j));
    let moved: Vec<_> = q.into_iter().map(|q| pose.apply(q)).collect();
    p.iter().flat_map(|p| moved.iter().map(move |q| norm(sub(*p, *q)))).fold(f64::INFINITY, f64::min)
}

fn gaps_are_distances_between_cells<const D: usize>(seed: u64, n_points: usize) {
    let mut random = SplitMix64::new(seed);
    let workers = Workers::caller_only();
    let mut n_apart = 0;
    for _ in 0..8 {
        let (parts, relative) = case::<D>(&mut random);
        let grids = [parts[0].grid(), parts[1].grid()];
        let conflicts = Conflicts::of_overlap(
            [&parts[0], &parts[1]],
            &relative,
            &OverlapOptions::default(),
            &mut Progress::silent(),
        )
        .unwrap();
        let some = Bits::of(grids[0].n_cells(), |i| i % 3 == 0).unwrap();
        let room = parts.each_ref().map(|p| p.allowed().clone());
        let pair = close(&conflicts, &room, Side::First, &some).unwrap();
        if pair.count(Side::Second) == 0 {
            continue;
        }
        let found = contact(grids, &pair, &relative, 5, &workers, &mut Progress::silent()).unwrap();
        for gap in &found.gaps {
            let pose = relative.at(gap.time);
            let each = || pair.cells[0].iter().flat_map(|i| pair.cells[1].iter().map(move |j| (i, j)));
            let near = each().filter(|&(i, j)| {
                let off = norm(sub(grids[0].center(i), pose.apply(grids[1].center(j))));
                off < gap.distance + (D as f64).sqrt() * 0.5 * (grids[0].cell() + grids[1].cell())
            });
            let least = near
                .map(|(i, j)| gap_by_points(grids[0], grids[1], i, j, &pose, n_points))
                .fold(f64::INFINITY, f64::min);
            // Points are within half their spacing of the nearest ones.
            let spacing = (grids[0].cell() + grids[1].cell()) / (n_points - 1) as f64 * 0.5 * (D as f64).sqrt();
            assert!(gap.distance <= least + 1e-12 && least <= gap.distance + spacing, "{} {least}", gap.distance);
            n_apart += usize::from(gap.distance > 0.01);
        }
        assert_eq!(found.largest, found.gaps.iter().map(|g| g.distance).fold(0.0, f64::max));
    }
    assert!(n_apart > 3, "{n_apart}");
}

#[test]
fn gaps_are_distances_between_cells_in_the_plane() {
    gaps_are_distances_between_cells::<2>(31, 12);
}

#[test]
fn gaps_are_distances_between_cells_in_space() {
    gaps_are_distances_between_cells::<3>(32, 5);
}
