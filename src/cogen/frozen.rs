//! Frozen cells that collide: which, when and where. A pair of parts that must have them both there is not.

use super::conflict::{Conflicts, Side};
use super::cube::Cube;
use super::grid::Grid;
use super::part::Part;
use super::steps::{Relative, Sampling, Step};
use crate::geometry::rigid::Rigid;
use crate::geometry::vec::{norm, number, text};
use crate::{Error, Result};

/// Pairs that the error of colliding frozen cells tells of.
const TOLD: usize = 3;

/// Steps within which cells have much the same speed.
const LOOK: Sampling = Sampling::Slack(0.25);

/// Overlap of cells, in cells, that counts as touching.
const TOUCH: f64 = 1e-9;

/// Overlap, in cells, so shallow that it may be passed by.
const GRAZE: f64 = 1e-3;

/// Two frozen cells that collide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clash<const D: usize> {
    /// The cells, of part 1 and of part 2.
    pub cells: [usize; 2],
    /// Their centres, each in its part's frame.
    pub centers: [[f64; D]; 2],
    /// When they begin to overlap; when they are nearest to each other, if they only come nearer than they may.
    pub time: f64,
    /// Their distance then: 0 where they overlap.
    pub distance: f64,
    /// A point of both then, or between them, in part 1's frame.
    pub place: [f64; D],
    /// The same in the world.
    pub world: [f64; D],
}

/// All that collide, and some of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Clashes<const D: usize> {
    /// Pairs of frozen cells that collide.
    pub n_pairs: usize,
    /// As many of them as were asked for, in the order of part 1's cells or of part 2's.
    pub found: Vec<Clash<D>>,
}

/// The frozen cells of `parts` that collide in the graph, which is of the motion `relative`; when and where is told of `most` pairs. Each
/// of these takes a look at each step of the motion.
pub fn clashes<const D: usize>(
    conflicts: &Conflicts,
    parts: [&Part<D>; 2],
    relative: &Relative<D>,
    most: usize,
) -> Result<Clashes<D>> {
    let near = conflicts.rows_of();
    let (own, other) = (parts[near.index()].frozen(), parts[near.other().index()].frozen());
    let (mut n_pairs, mut pairs) = (0, Vec::new());
    for i in own.iter() {
        for run in conflicts.rows().iter(i) {
            other.each_in(run, |j| {
                n_pairs += 1;
                if pairs.len() < most {
                    pairs.push(if near == Side::First { [i, j] } else { [j, i] });
                }
            });
        }
    }
    let grids = parts.map(Part::grid);
    let steps = if pairs.is_empty() { Vec::new() } else { relative.bounded_steps(LOOK, grids[0], grids[1], 0.0)? };
    Ok(Clashes { n_pairs, found: pairs.into_iter().map(|cells| clash(grids, cells, relative, &steps)).collect() })
}

/// The error of frozen cells that collide, of parts with the numbers `names`.
pub(super) fn check<const D: usize>(
    conflicts: &Conflicts,
    parts: [&Part<D>; 2],
    relative: &Relative<D>,
    names: [usize; 2],
) -> Result<()> {
    let Clashes { n_pairs, found } = clashes(conflicts, parts, relative, TOLD)?;
    if n_pairs == 0 {
        return Ok(());
    }
    let mut told: Vec<String> = found.iter().map(|clash| clash.told(names)).collect();
    if n_pairs > found.len() {
        told.push(format!("and {} more", n_pairs - found.len()));
    }
    let pairs = if n_pairs == 1 { "pair of frozen cells collides" } else { "pairs of frozen cells collide" };
    Err(Error::InvalidArgument(format!(
        "{n_pairs} {pairs}: {}; free one of each, let the motion keep them apart, or, where they only come near, take a smaller slack",
        told.join("; ")
    )))
}

/// Numbers for a message, to six digits.
pub(super) fn brief<const N: usize>(x: [f64; N]) -> [f64; N] {
    x.map(|x| format!("{x:.5e}").parse().unwrap_or(x))
}

impl<const D: usize> Clash<D> {
    fn told(&self, names: [usize; 2]) -> String {
        let [a, b] = names;
        let [time, distance] = brief([self.time, self.distance]).map(number);
        let when = if self.distance > 0.0 {
            format!("come within {distance} of each other at time {time}")
        } else {
            format!("overlap from time {time} on")
        };
        let [one, two, place, world] =
            [self.centers[0], self.centers[1], self.place, self.world].map(|p| text(&brief(p)));
        format!(
            "cell {} of part {a}, at {one}, and cell {} of part {b}, at {two}, {when}, at {place} in part {a}'s frame and {world} in the world",
            self.cells[0], self.cells[1]
        )
    }
}

/// When and where two cells collide: time goes on by what the distance allows at the speed of the step.
fn clash<const D: usize>(
    grids: [&Grid<D>; 2],
    cells: [usize; 2],
    relative: &Relative<D>,
    steps: &[Step<D>],
) -> Clash<D> {
    let centers = [grids[0].center(cells[0]), grids[1].center(cells[1])];
    let still = Cube::new(centers[0], grids[0].cell(), &Rigid::IDENTITY);
    let moved = |t: f64| {
        let pose = relative.at(t);
        Cube::new(pose.apply(centers[1]), grids[1].cell(), &pose)
    };
    let cell = grids[0].cell().min(grids[1].cell());
    let apart = |t: f64| TOUCH * cell - still.overlap(&moved(t));
    // The last time at which they were apart, the first at which they were not, and when they were nearest, with the way around it.
    let (mut before, mut after, mut nearest) = (0.0, None, (f64::INFINITY, 0.0, 0.0));
    'steps: for step in steps {
        let speed = speed(step, centers[1], grids[1].cell());
        let (mut t, end) = (step.time - step.half, step.time + step.half);
        loop {
            let gap = apart(t);
            if gap < 0.0 {
                after = Some(t);
                break 'steps;
            }
            before = t;
            let way = gap.max(GRAZE * cell) / speed;
            if gap < nearest.0 {
                nearest = (gap, t, way);
            }
            if t >= end {
                break;
            }
            // A millionth of the step at least: where speeds are beyond all measure nothing else ends.
            t = (t + way.max(1e-6 * step.half)).min(end);
        }
    }
    let time = match after {
        Some(mut after) => {
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                *(if apart(middle) < 0.0 { &mut after } else { &mut before }) = middle;
            }
            after
        }
        None => least(apart, (nearest.1 - nearest.2).max(0.0), (nearest.1 + nearest.2).min(1.0)),
    };
    let (distance, place) = still.distance(&moved(time));
    let distance = if after.is_some() { 0.0 } else { distance };
    Clash { cells, centers, time, distance, place, world: relative.from.at(time).apply(place) }
}

/// What no point of the cell around `x` is faster than within a step.
fn speed<const D: usize>(step: &Step<D>, x: [f64; D], cell: f64) -> f64 {
    let radius = 0.5 * (D as f64).sqrt() * cell;
    let acceleration = 2.0 * step.bend / (step.half * step.half);
    norm(step.twist.at(step.pose.apply(x))) + step.twist.rate() * radius + acceleration * step.half
}

/// Where between `a` and `b` a function with one valley there is least, by thirds.
fn least(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..60 {
        let (p, q) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
        if f(p) <= f(q) { b = q } else { a = p }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::super::closure::room;
    use super::super::conflict::OverlapOptions;
    use super::super::motion::{Law, Motion};
    use super::super::part::Cell;
    use super::*;
    use crate::progress::Progress;

    /// A row of ten cells of which some are frozen, which slides up by `way` from half a cell below another.
    fn rows(frozen: [&[usize]; 2], way: f64, clearance: f64) -> Result<Clashes<2>> {
        let part = |k: usize, y: f64| {
            let cell = |i| if frozen[k].contains(&i) { Cell::Frozen } else { Cell::Free };
            let grid = Grid::new([0.0, y], 0.1, [10, 1]).unwrap();
            Part::of_cells(grid, &(0..10).map(cell).collect::<Vec<_>>()).unwrap()
        };
        let parts = [part(0, 1.0), part(1, 0.85)];
        let parts = [&parts[0], &parts[1]];
        // Both go to the right, so that the world's frame is not part 1's.
        let right = Motion::slide([1.0, 0.0], Law { offset: 2.0, ..Law::even(3.0) }).unwrap();
        let up = Motion::slide([0.0, 1.0], Law::even(way)).unwrap();
        let relative = Relative { of: right.times(&up).unwrap(), from: right };
        let options = OverlapOptions { clearance, ..OverlapOptions::default() };
        let conflicts = Conflicts::of_overlap(parts, &relative, &options, &mut Progress::silent()).unwrap();
        room(&conflicts, parts, &relative)?;
        clashes(&conflicts, parts, &relative, 10)
    }

    #[test]
    fn frozen_cells_that_collide_are_named_with_when_and_where() {
        let told = rows([&[3], &[3, 8]], 0.2, 0.0).unwrap_err().to_string();
        // The gap of 0.05 is closed at 0.25, at x = 0.35 + 2 + 0.75 in the world.
        for part in [
            "1 pair of frozen cells collides",
            "cell 3 of part 1, at (0.35, 1.05)",
            "cell 3 of part 2, at (0.35, 0.9)",
            "overlap from time 0.25",
            "(0.35, 1) in part 1's frame",
        ] {
            assert!(told.contains(part), "{part}: {told}");
        }
        let told = rows([&[3, 4, 5], &[3, 4, 5, 6]], 0.2, 0.0).unwrap_err().to_string();
        assert!(told.starts_with("3 pairs of frozen cells collide") && !told.contains("more"), "{told}");
        let told = rows([&[1, 3, 4, 5, 6], &[1, 2, 3, 4, 5, 6]], 0.2, 0.0).unwrap_err().to_string();
        assert!(told.starts_with("5 pairs") && told.contains("and 2 more; free one"), "{told}");
        assert_eq!(rows([&[3], &[4, 8]], 0.2, 0.0).unwrap().n_pairs, 0);
    }

    #[test]
    fn frozen_cells_that_come_too_near_are_told_apart_from_those_that_overlap() {
        // It stops 0.03 below; 0.04 is asked for.
        let told = rows([&[3], &[3]], 0.02, 0.04).unwrap_err().to_string();
        assert!(told.contains("come within 0.03") && told.contains("at time 1"), "{told}");
        assert!(rows([&[3], &[3]], 0.02, 0.0).is_ok());
    }

    /// At speeds beyond all measure the gap is below what a step of time can tell.
    #[test]
    fn cells_that_come_from_very_far_are_looked_at_to_an_end() {
        let part = |x: f64| Part::of_cells(Grid::<2>::new([x, 0.0], 0.1, [1, 1]).unwrap(), &[Cell::Frozen]).unwrap();
        let parts = [part(0.0), part(-5e14)];
        let parts = [&parts[0], &parts[1]];
        let of = Motion::slide([1.0, 0.0], Law::even(1e15)).unwrap();
        let relative = Relative { from: Motion::fixed(), of };
        let options = OverlapOptions { sampling: Sampling::Steps(10), ..OverlapOptions::default() };
        let conflicts = Conflicts::of_overlap(parts, &relative, &options, &mut Progress::silent()).unwrap();
        assert!(room(&conflicts, parts, &relative).unwrap_err().to_string().contains("1 pair of frozen cells"));
    }

    #[test]
    fn clashes_are_where_and_when_cells_overlap() {
        let mut random = crate::geometry::random::SplitMix64::new(3);
        let mut n = 0;
        for _ in 0..20 {
            let part = |x: f64| {
                let grid = Grid::new([x, -0.3], 0.1, [6, 6]).unwrap();
                let cells: Vec<Cell> = (0..36).map(|i| if i % 5 == 0 { Cell::Frozen } else { Cell::Free }).collect();
                Part::of_cells(grid, &cells).unwrap()
            };
            let parts = [part(-0.6), part(0.0)];
            let parts = [&parts[0], &parts[1]];
            let turn = |x: f64, s: f64| Motion::turn([x, 0.0], Law::even(s)).unwrap();
            let relative =
                Relative { from: turn(-0.4, random.between(0.5, 4.0)), of: turn(0.3, random.between(-4.0, 1.0)) };
            let silent = &mut Progress::silent();
            let conflicts = Conflicts::of_overlap(parts, &relative, &OverlapOptions::default(), silent).unwrap();
            let all = clashes(&conflicts, parts, &relative, usize::MAX).unwrap();
            assert_eq!(all.n_pairs, all.found.len());
            let [f1, f2] = parts.map(Part::frozen);
            let each = || f1.iter().flat_map(|i| f2.iter().map(move |j| [i, j]));
            for clash in &all.found {
                let of = |t: f64| {
                    let pose = relative.at(t);
                    let one = Cube::new(clash.centers[0], 0.1, &Rigid::IDENTITY);
                    one.overlap(&Cube::new(pose.apply(clash.centers[1]), 0.1, &pose))
                };
                if clash.distance == 0.0 {
                    let before = (0..2000).map(|k| f64::from(k) / 2000.0).take_while(|t| *t < clash.time - 1e-6);
                    assert!(of(clash.time) > 0.0 && before.into_iter().all(|t| of(t) < 2e-3), "{clash:?}");
                    n += 1;
                } else {
                    // The graph keeps cells apart by a twentieth of a cell more than it must.
                    assert!(clash.distance < 0.02 && of(clash.time) <= 1e-9, "{clash:?}");
                }
                let world = relative.from.at(clash.time).apply_inverse(clash.world);
                assert!(crate::geometry::vec::norm(crate::geometry::vec::sub(world, clash.place)) < 1e-12);
            }
            // None is left out.
            let is_told = |cells: [usize; 2]| all.found.iter().any(|c| c.cells == cells);
            for cells in each() {
                let [p, q] = [parts[0].grid().center(cells[0]), parts[1].grid().center(cells[1])];
                let meets = (0..200).any(|k| {
                    let pose = relative.at(f64::from(k) / 199.0);
                    let one = Cube::new(p, 0.1, &Rigid::IDENTITY);
                    one.overlap(&Cube::new(pose.apply(q), 0.1, &pose)) > 1e-6
                });
                assert!(!meets || is_told(cells));
            }
        }
        assert!(n > 50, "{n}");
    }
}
