//! Against brute force: all sets of tiny assemblies, all cells of ten parts at many times.

use super::super::grid::Grid;
use super::super::motion::Law;
use super::super::part::Cell;
use super::super::tests::{overlap, table, vertices};
use super::*;
use crate::geometry::random::SplitMix64;
use crate::geometry::vec::{norm, sub};
use std::f64::consts::TAU;

const MANY: u64 = 1 << 30;

/// All edges as a table, by numbers among all.
fn edges_of(cells: &[Range<usize>], graphs: &[([usize; 2], Conflicts)]) -> Vec<Vec<bool>> {
    let n = cells.last().map_or(0, |c| c.end);
    let mut edges = vec![vec![false; n]; n];
    for ([i, j], graph) in graphs {
        for (a, row) in table(graph).iter().enumerate() {
            for (b, edge) in row.iter().enumerate() {
                edges[cells[*i].start + a][cells[*j].start + b] |= edge;
                edges[cells[*j].start + b][cells[*i].start + a] |= edge;
            }
        }
    }
    edges
}

fn random_assembly(
    random: &mut SplitMix64,
    meet: impl Fn(usize, usize) -> bool,
) -> (Vec<usize>, Vec<([usize; 2], Conflicts)>) {
    let n: Vec<usize> = (0..2 + random.bits() as usize % 4).map(|_| 1 + random.bits() as usize % 3).collect();
    let mut graphs = Vec::new();
    for (i, j) in (0..n.len()).flat_map(|i| (i + 1..n.len()).map(move |j| (i, j))).filter(|&(i, j)| meet(i, j)) {
        let density = random.unit();
        let edges: Vec<bool> = (0..n[i] * n[j]).map(|_| random.unit() < density).collect();
        let rows_of = SIDES[random.bits() as usize % 2];
        graphs.push(([i, j], Conflicts::of_edges([n[i], n[j]], rows_of, |a, b| edges[a * n[j] + b]).unwrap()));
    }
    (n, graphs)
}

fn check(edges: &[Vec<bool>], cells: &[Range<usize>], room: &[Bits], found: &[Bits]) {
    let has = |u: usize| {
        let k = part_of(cells, u);
        (found[k].has(u - cells[k].start), room[k].has(u - cells[k].start))
    };
    for u in 0..edges.len() {
        let meets = (0..edges.len()).any(|v| edges[u][v] && has(v).0);
        match has(u) {
            (true, in_room) => assert!(in_room && !meets, "cell {u} collides"),
            (false, in_room) => assert!(!in_room || meets, "cell {u} could be had"),
        }
    }
}

fn arrange_is_between_the_best_and_the_bound(seed: u64, meet: impl Fn(usize, usize) -> bool, two_colours: bool) {
    let mut random = SplitMix64::new(seed);
    let (mut n_met, mut n_best, n_rounds) = (0, 0, 1500);
    for round in 0..n_rounds {
        let (n, graphs) = random_assembly(&mut random, &meet);
        let silent = &mut Progress::silent();
        let assembly = Assembly::of_graphs(&n, &graphs, MANY, &Workers::caller_only(), silent).unwrap();
        let edges = edges_of(&assembly.cells, &graphs);
        let room: Vec<Bits> = n.iter().map(|&n| Bits::of(n, |i| round % 3 > 0 || i != 1).unwrap()).collect();
        let most = [1, 4, 1000][round % 3];
        let weights: Vec<Vec<u64>> = n.iter().map(|&n| (0..n).map(|_| random.bits() % (most + 1)).collect()).collect();
        let rooms: Vec<&Bits> = room.iter().collect();
        let of: Vec<&[u64]> = weights.iter().map(Vec::as_slice).collect();
        let found = assembly.arrange(&rooms, &of, &ArrangeOptions::default(), silent).unwrap();
        check(&edges, &assembly.cells, &room, &found.cells);
        let weigh = |sets: &[Bits]| -> u64 {
            sets.iter().zip(&weights).map(|(set, w)| set.iter().map(|i| w[i]).sum::<u64>()).sum()
        };
        assert_eq!(found.weight, weigh(&found.cells));
        // All sets.
        let (all, w) = (edges.len(), weights.concat());
        let open: Vec<bool> = room.iter().flat_map(|set| (0..set.len()).map(|i| set.has(i))).collect();
        let free = |set: u32| {
            let has = |u: usize| set >> u & 1 == 1;
            (0..all).all(|u| !has(u) || open[u] && (0..u).all(|v| !has(v) || !edges[u][v]))
        };
        let weight = |set: u32| (0..all).filter(|u| set >> u & 1 == 1).map(|u| w[u]).sum::<u64>();
        let best = (0..1_u32 << all).filter(|&set| free(set)).map(weight).max().unwrap();
        assert!(found.weight <= best && best <= found.bound, "{} {best} {}", found.weight, found.bound);
        n_met += usize::from(best == found.bound);
        n_best += usize::from(best == found.weight);

        // Closure of whatever is asked for.
        let wanted: Vec<Bits> = n.iter().map(|&n| Bits::of(n, |i| (i + round) % 2 == 0).unwrap()).collect();
        let order: Vec<usize> = (0..n.len()).map(|k| (k + round) % n.len()).collect();
        let closed = assembly.close(&rooms, &wanted.iter().collect::<Vec<_>>(), &order).unwrap();
        check(&edges, &assembly.cells, &room, &closed);
        assert!(
            (0..n[order[0]]).all(|i| closed[order[0]].has(i) || !wanted[order[0]].has(i) || !rooms[order[0]].has(i))
        );
    }
    if two_colours {
        assert_eq!((n_met, n_best), (n_rounds, n_rounds));
    } else {
        assert!(n_best * 100 > n_rounds * 97 && n_met < n_rounds, "{n_best} {n_met} of {n_rounds}");
    }
}

#[test]
fn arrangements_are_between_the_best_and_the_bound() {
    arrange_is_between_the_best_and_the_bound(1, |_, _| true, false);
    // A train, and a star.
    arrange_is_between_the_best_and_the_bound(2, |i, j| j == i + 1, true);
    arrange_is_between_the_best_and_the_bound(3, |i, _| i == 0, true);
}

/// Squares of `n` cells a side around `centers`, which turn.
fn turning(centers: &[[f64; 2]], n: usize) -> (Vec<Part<2>>, Vec<Motion<2>>) {
    let of = |(k, c): (usize, &[f64; 2])| {
        let part = Part::whole(Grid::new([c[0] - 0.5, c[1] - 0.5], 1.0 / n as f64, [n, n]).unwrap()).unwrap();
        let law = Law { offset: 0.3 * k as f64, slope: if k % 2 == 0 { TAU } else { -TAU }, waves: Vec::new() };
        (part, Motion::turn(*c, law).unwrap())
    };
    centers.iter().enumerate().map(of).unzip()
}

fn of_ten(centers: &[[f64; 2]], n_meetings: usize) -> Arrangement {
    let n = 8;
    let (parts, motions) = turning(centers, n);
    let parts: Vec<&Part<2>> = parts.iter().collect();
    let (options, silent) = (OverlapOptions::default(), &mut Progress::silent());
    let assembly = Assembly::of_overlap(&parts, &motions, &options, silent).unwrap();
    assert_eq!(assembly.meetings().len(), n_meetings);
    // All pairs, those too that the boxes leave out.
    let mut graphs = Vec::new();
    for (i, j) in (0..10).flat_map(|i| (i + 1..10).map(move |j| (i, j))) {
        let relative = Relative { from: motions[i].clone(), of: motions[j].clone() };
        let graph = Conflicts::of_overlap([parts[i], parts[j]], &relative, &options, silent).unwrap();
        assert!(graph.n_edges() == 0 || assembly.meetings().contains(&[i, j]));
        graphs.push(([i, j], graph));
    }
    let edges = edges_of(&assembly.cells, &graphs);
    assert_eq!(edges.iter().flatten().filter(|e| **e).count(), 2 * assembly.n_edges());
    let room = assembly.room(&parts).unwrap();
    let weights = vec![vec![1; n * n]; 10];
    let found = assembly
        .arrange(
            &room.iter().collect::<Vec<_>>(),
            &weights.iter().map(Vec::as_slice).collect::<Vec<_>>(),
            &ArrangeOptions::default(),
            silent,
        )
        .unwrap();
    check(&edges, &assembly.cells, &room, &found.cells);
    // Cells of one part against those of another at many times.
    for t in (0..150).map(|k| (f64::from(k) + 0.37) / 150.0) {
        let moved: Vec<Vec<Vec<[f64; 2]>>> = (0..10)
            .map(|k| {
                let pose = motions[k].at(t);
                let of = |i| vertices(parts[k].grid(), i).into_iter().map(|p| pose.apply(p)).collect();
                found.cells[k].iter().map(of).collect()
            })
            .collect();
        for (i, j) in (0..10).flat_map(|i| (i + 1..10).map(move |j| (i, j))) {
            if norm(sub(centers[i], centers[j])) > 1.5 {
                continue;
            }
            for (a, b) in moved[i].iter().flat_map(|a| moved[j].iter().map(move |b| (a, b))) {
                assert!(norm(sub(a[0], b[0])) > 0.4 || overlap(a, b) <= 1e-8, "parts {i} and {j} overlap at {t}");
            }
        }
    }
    found
}

#[test]
fn ten_parts_never_collide_and_cannot_grow() {
    // A train that bends: one cut is the best there is.
    let train: Vec<[f64; 2]> = (0..10).map(|k| [0.8 * f64::from(k), 0.3 * f64::from(k % 2)]).collect();
    let found = of_ten(&train, 9);
    assert_eq!(found.weight, found.bound);
    assert!(found.n_cuts <= 2, "{}", found.n_cuts);
    // Four, three, two and one, as ninepins stand: each three neighbours meet.
    let pins: Vec<[f64; 2]> = (0..4_u32)
        .flat_map(|row| (0..4 - row).map(move |k| [f64::from(k) + 0.5 * f64::from(row), 0.9 * f64::from(row)]))
        .collect();
    let found = of_ten(&pins, 18);
    assert!(found.weight < found.bound && found.weight as f64 > 0.9 * found.bound as f64);
}

#[test]
fn frozen_cells_of_assemblies_stay() {
    let parts = |frozen: &[(usize, usize)]| -> Vec<Part<2>> {
        let of = |k: usize, i: usize| if frozen.contains(&(k, i)) { Cell::Frozen } else { Cell::Free };
        (0..3)
            .map(|k| {
                let cells: Vec<Cell> = (0..2).map(|i| of(k, i)).collect();
                Part::of_cells(Grid::new([0.0; 2], 1.0, [2, 1]).unwrap(), &cells).unwrap()
            })
            .collect()
    };
    let graph = || Conflicts::of_edges([2, 2], Side::First, |i, j| i == j).unwrap();
    let graphs = [([0, 1], graph()), ([0, 2], graph()), ([1, 2], graph())];
    let silent = &mut Progress::silent();
    let assembly = Assembly::of_graphs(&[2; 3], &graphs, MANY, &Workers::caller_only(), silent).unwrap();
    let room = |frozen: &[(usize, usize)]| assembly.room(&parts(frozen).iter().collect::<Vec<_>>());
    let rooms = room(&[(2, 0)]).unwrap();
    let numbers: Vec<Vec<usize>> = rooms.iter().map(|r| r.iter().collect()).collect();
    assert_eq!(numbers, [vec![1], vec![1], vec![0, 1]]);
    let weights: [&[u64]; 3] = [&[1, 5], &[1, 5], &[0, 4]];
    let found =
        assembly.arrange(&rooms.iter().collect::<Vec<_>>(), &weights, &ArrangeOptions::default(), silent).unwrap();
    assert!(found.cells[2].has(0) && found.weight == 5 && found.bound == 7);
    let told = room(&[(0, 1), (2, 1)]).unwrap_err().to_string();
    assert!(told.contains("frozen cell 1 of part 0 collides with frozen cell 1 of part 2"), "{told}");
}

#[test]
fn what_is_no_assembly_is_refused() {
    let graph = || Conflicts::of_edges([2, 3], Side::First, |i, j| i == j).unwrap();
    let silent = &mut Progress::silent();
    let mut of = |n: &[usize], graphs: &[([usize; 2], Conflicts)], most| {
        Assembly::of_graphs(n, graphs, most, &Workers::caller_only(), silent).map(|_| ()).unwrap_err().to_string()
    };
    assert!(of(&[2, 2], &[([0, 1], graph())], MANY).contains("no graph of parts 0 and 1"));
    assert!(of(&[3, 2], &[([1, 0], graph())], MANY).contains("no graph of parts 1 and 0"));
    assert!(of(&[2, 3], &[([0, 1], graph()), ([0, 1], graph())], MANY).contains("two graphs"));
    assert!(of(&[2, 3], &[([0, 1], graph())], 1).contains("the limit is 1 bytes"));
    assert!(of(&[MOST_CELLS, 3], &[], MANY).contains("may have"));

    let assembly = Assembly::of_graphs(&[2, 3], &[([0, 1], graph())], MANY, &Workers::caller_only(), silent).unwrap();
    let room = [Bits::all(2).unwrap(), Bits::all(3).unwrap()];
    let rooms = [&room[0], &room[1]];
    let weights: [&[u64]; 2] = [&[1, 1], &[1, 1, 1]];
    let mut told = |room: &[&Bits], weights: &[&[u64]], max_rounds| {
        let options = ArrangeOptions { max_rounds, ..ArrangeOptions::default() };
        assembly.arrange(room, weights, &options, silent).unwrap_err().to_string()
    };
    assert!(told(&rooms[..1], &weights, 1).contains("room of 1 parts; the assembly has 2"));
    assert!(told(&[&room[1], &room[1]], &weights, 1).contains("3 for part 0's 2 cells"));
    assert!(told(&rooms, &[&[1, 1], &[1]], 1).contains("weights: 1 for part 1's 3 cells"));
    assert!(told(&rooms, &[&[u64::MAX / 2, 1], &[1, 1, 1]], 1).contains("below 2^64"));
    assert!(told(&rooms, &weights, 0).contains("0 rounds"));
    assert!(assembly.close(&rooms, &rooms, &[1, 1]).unwrap_err().to_string().contains("[1, 1]"));

    let part = Part::<2>::whole(Grid::new([0.0; 2], 1.0, [1, 1]).unwrap()).unwrap();
    let few = Assembly::of_overlap(&[&part], &[], &OverlapOptions::default(), silent);
    assert!(few.unwrap_err().to_string().contains("0 motions for 1 parts"));
}
