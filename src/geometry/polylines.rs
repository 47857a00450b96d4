//! Curves of the plane from lists of points: boundaries of solids, or open curves, checked for what makes no boundary.

use super::Mesh;
use super::crossings::{Crossing, Meeting, first_crossing};
use super::nesting::{Lie, first_misfit};
use super::unit::Unit;
use super::vec::{is_finite, scale, text};
use crate::error::try_with_capacity;
use crate::{Error, Result};

/// Whether polylines go back to their first points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// A segment leads from each polyline's last point to its first.
    Closed,
    /// Polylines end at their last points.
    Open,
}

impl Mesh<2> {
    /// The curves through `points` [N x 2]: polyline k has the points from `loop_starts[k]` to before `loop_starts[k + 1]`, the last
    /// polyline all that follow. The first starts at 0. A point equal to the one before it is dropped, and so is the last of a closed
    /// polyline when it repeats the first; an open one needs 2 points then, a closed one 3.
    ///
    /// Closed polylines have the solid on their left: counter-clockwise around it, clockwise around its holes, islands in holes
    /// counter-clockwise again. The reverse in all of them makes the solid inside out, which [`Mesh::report`] tells. Open polylines have
    /// the side that counts as inside on their left.
    ///
    /// [`Error::InvalidArgument`], with the points' indices, for polylines that cross, touch or overlap, themselves or one another, decided
    /// exactly; for loops that run the same way around right inside each other, or different ways side by side; for points that
    /// are not finite and starts out of order. Cost: O(N log N) where few segments' boxes overlap.
    pub fn from_polylines(points: Vec<[f64; 2]>, loop_starts: &[usize], ends: Ends) -> Result<Self> {
        check_points(&points)?;
        check_starts(loop_starts, points.len(), ends)?;
        let Polylines { vertices, segments, point_of, first_segments } = Polylines::of(&points, loop_starts, ends)?;
        let mesh = Mesh::new(vertices, segments)?;

        let unit = Unit::of(&mesh);
        let shrunk = unit.shrunk(&mesh)?;
        if let Some(crossing) = first_crossing(&shrunk)? {
            return Err(crossing_error(&mesh, &crossing, unit, &point_of, &first_segments));
        }
        if ends == Ends::Closed
            && let Some(misfit) = first_misfit(&shrunk, &first_segments)?
        {
            return Err(misfit_error(misfit.reverse, misfit.other, misfit.lie));
        }
        Ok(mesh)
    }
}

fn check_points(points: &[[f64; 2]]) -> Result<()> {
    match points.iter().position(|p| !is_finite(p)) {
        None => Ok(()),
        Some(i) => {
            Err(Error::InvalidArgument(format!("point {i} is {}; coordinates must be finite", text(&points[i]))))
        }
    }
}

fn fewest(ends: Ends) -> (usize, &'static str) {
    match ends {
        Ends::Closed => (3, "a closed"),
        Ends::Open => (2, "an open"),
    }
}

fn check_starts(starts: &[usize], n_points: usize, ends: Ends) -> Result<()> {
    let (fewest, name) = fewest(ends);
    match starts.first() {
        Some(0) => {}
        Some(first) => {
            return Err(Error::InvalidArgument(format!("loop_starts[0] is {first}; the first polyline starts at 0")));
        }
        None => return Err(Error::InvalidArgument("there are no polylines; at least 1 is needed".into())),
    }
    for (k, &start) in starts.iter().enumerate() {
        let end = starts.get(k + 1).copied().unwrap_or(n_points);
        if end > n_points {
            return Err(Error::InvalidArgument(format!(
                "loop_starts[{}] is {end}, but there are {n_points} points, counted from 0",
                k + 1
            )));
        }
        if end < start || end - start < fewest {
            let next = if k + 1 < starts.len() { "the next at" } else { "the points end at" };
            return Err(Error::InvalidArgument(format!(
                "polyline {k} starts at point {start}, {next} {end}; {name} polyline needs at least {fewest} points"
            )));
        }
    }
    Ok(())
}

/// Polylines as a mesh, their vertices and segments one polyline after the other, without repeated points.
struct Polylines {
    vertices: Vec<[f64; 2]>,
    segments: Vec<[u32; 2]>,
    /// The point that each vertex was.
    point_of: Vec<usize>,
    /// The first segment of each polyline, and the number of all.
    first_segments: Vec<usize>,
}

impl Polylines {
    fn of(points: &[[f64; 2]], starts: &[usize], ends: Ends) -> Result<Self> {
        let n = points.len();
        let mut found = Polylines {
            vertices: try_with_capacity(n, "the vertices of the polylines")?,
            segments: try_with_capacity(n, "the segments of the polylines")?,
            point_of: try_with_capacity(n, "the vertices of the polylines")?,
            first_segments: try_with_capacity(starts.len() + 1, "the polylines")?,
        };
        for (k, &start) in starts.iter().enumerate() {
            let end = starts.get(k + 1).copied().unwrap_or(n);
            found.first_segments.push(found.segments.len());
            let first = found.vertices.len();
            for i in (start..end).filter(|&i| i == start || points[i] != points[i - 1]) {
                found.vertices.push(points[i]);
                found.point_of.push(i);
            }
            if ends == Ends::Closed && found.vertices.len() > first + 1 && found.vertices.last() == Some(&points[start])
            {
                found.vertices.pop();
                found.point_of.pop();
            }
            let last = found.vertices.len() - 1;
            let (fewest, name) = fewest(ends);
            if last + 1 - first < fewest {
                let given = last + 1 - first;
                return Err(Error::InvalidArgument(format!(
                    "polyline {k}, points {start} to {}, has {given} points that do not repeat the one before; {name} polyline needs at \
                     least {fewest}",
                    end - 1
                )));
            }
            found.segments.extend((first..last).map(|v| [v as u32, v as u32 + 1]));
            if ends == Ends::Closed {
                found.segments.push([last as u32, first as u32]);
            }
        }
        found.first_segments.push(found.segments.len());
        Ok(found)
    }
}

fn crossing_error(
    mesh: &Mesh<2>,
    crossing: &Crossing,
    unit: Unit,
    point_of: &[usize],
    first_segments: &[usize],
) -> Error {
    let [s, t] = crossing.segments.map(|s| {
        let [from, to] = mesh.segments()[s as usize].map(|v| point_of[v as usize]);
        let polyline = first_segments.partition_point(|&first| first <= s as usize) - 1;
        format!("the segment from point {from} to {to} of polyline {polyline}")
    });
    let meet = match crossing.meeting {
        Meeting::Cross => "crosses",
        Meeting::Touch => "touches",
        Meeting::Overlap => "overlaps",
    };
    let place = text(&scale(unit.grow, crossing.place));
    Error::InvalidArgument(format!(
        "{s} {meet} {t} at {place}; polylines must keep clear of themselves and of one another"
    ))
}

fn misfit_error(reverse: usize, other: usize, lie: Lie) -> Error {
    Error::InvalidArgument(match lie {
        Lie::Nested => {
            let (a, b) = (reverse.min(other), reverse.max(other));
            format!(
                "polylines {a} and {b} lie one right inside the other and run the same way around, which bounds no solid; reverse \
                 polyline {reverse}: solids are to the left of their boundaries"
            )
        }
        Lie::Apart => format!(
            "polylines {reverse} and {other} lie in no other and run different ways around, which bounds no solid; reverse polyline \
             {reverse}: solids are to the left of their boundaries"
        ),
    })
}

#[cfg(test)]
mod tests;
