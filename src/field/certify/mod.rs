//! Certificates: what phi at the samples of a body proves of the whole body.
//!
//! Takes a field, the shape that it stands for, the clearance d that is wanted and the covering radius r of a body's samples; gives a
//! threshold t above phi wherever a sample must not be, the continuation outside the box included.
//!
//! Notation: M the shape, a mesh; d clearance, r covering radius: every point of the body's surface is within r of a sample; S the set of
//! points that are on the infeasible side of M or within d + r of it; t > phi(x) for all x in S.
//!
//! **What it proves.** Let B be a body: closed, bounded, its surface covered by its samples with radius r. If phi >= t at every sample, and no
//! component of M has its point of [`Mesh::component_points`] in B, then B is on the feasible side and farther than d from M:
//!
//! 1. A sample p is not in S: phi(p) >= t > phi(x) for all x in S. So p is on the feasible side and farther than d + r from M.
//! 2. A point y of the surface of B is within r of a sample p, hence farther than d from M. No point between the two is on M, of which p is
//!    farther than r; the side changes only on M, so y is on the feasible side as p is.
//! 3. A component of M is connected and does not meet the surface of B, so it is in B or off B as a whole; by its one point it is off B.
//!    So M does not meet B.
//! 4. A point z in B is on the feasible side: on the way straight on in any direction, until the surface of B is met, M is not met. And from z
//!    to the point of M closest to it, which is off B, the surface of B is met, at a point y: |z - m| >= |y - m| > d.
//!
//! Where phi is aggregated, KS(min phi) <= min phi, so KS >= t will do. Without step 3 a body that swallows a component of M whole is not
//! told from one that is clear of it: its samples see nothing of that.
//!
//! **Where sides are certified.** Where M bounds a solid: every edge run through as often one way as the other, the volume positive. The
//! winding number is then an integer that changes only on M; points with 1/2 or more are inside. For other meshes S is what is within d + r
//! of M, on both sides, and 1 to 4 prove the clearance alone.
//!
//! **How it is found.** By branch and bound (`search`) over parts of cells and of what is continued from them (`parts`), with phi between its
//! Bezier points (`bounds`) and what is made of them beyond the box (`outside`): the largest phi on S (`clearance`), the largest |phi| on M
//! (`surface`), the largest |grad phi| (`steepness`).
//!
//! **What it costs.** A look at every cell and every facet, about two microseconds each with the distance; then boxes where phi is within the
//! tolerance of its largest. A box of size h misses by h^2 there, so that a part of the shape of size A in which phi is that large takes
//! about A / (tolerance (d + r))^((D - 1) / 2) boxes; where the shape faces itself across less than d + r from both sides a box misses by h,
//! and the exponent is D - 1. Shapes of 25,000 to 70,000 control points and 10,000 to 70,000 triangles take some 250,000 boxes in all at d =
//! 0.01 D, r = 0.005 D and the default tolerance (tests/certify.rs).
//!
//! **Rounding.** Bezier points and evaluations are sums of at most 4^D products per axis with weights that add up to 1, and to less than
//! 1.1 in size beyond a face: each is off by some 100 eps max |c| at most. Coordinates are rounded in units of eps X, X the largest among
//! those of the box and of what is looked at, which moves phi by G eps X. Bounds are raised by `ROUNDING` and `ASIDE` times these, ten
//! times as much and more, so that they hold for what evaluations give, too. Distances are lowered by `NEARER` of the size of M and by
//! `ASIDE` X; to needles of triangles, too, they are off by some eps (`geometry::triangle`). What the caller rounds is not in
//! it: samples that a pose brings to the field's frame are off by some eps of their coordinates there.

mod bounds;
mod clearance;
mod outside;
mod parts;
mod search;
mod steepness;
mod surface;

use super::{Feasible, Field, Outputs};
use crate::geometry::vec::{add, normalized, number, scale};
use crate::geometry::{Bounds, DistanceTree, Mesh};
use crate::par::Workers;
use crate::progress::Progress;
use crate::{Error, Result};
use clearance::Clearance;
use parts::Cells;
use search::{Limits, Outcome, search};
use steepness::Steepness;
use surface::Surface;

/// Rounding of values, in units of eps max |c|.
const ROUNDING: f64 = 1024.0;

/// Rounding of coordinates, in units of eps X.
const ASIDE: f64 = 4096.0;

/// Of the shortest cell, what that may be at most: more makes boxes meet cells all around, and tells nothing.
const COARSEST: f64 = 0.125;

/// What exact distances may be off by, in units of the size of the mesh, a thousand times what they are and more.
const NEARER: f64 = 1e-11;

/// Sizes, in D, below which a tolerance is not a fraction of what was found but of this: the threshold is not to be known better.
const LEAST: f64 = 1e-3;

/// Facets beside which phi is looked at first, at most.
const FIRST_FACETS: usize = 20_000;

/// The slope beyond the box is no more than told about: a tolerance for it at least, and boxes at most.
const ROUGHLY: f64 = 0.2;
const FEW_BOXES: u64 = 100_000;

/// Coordinates, lengths and boxes that leave room for squares.
const LARGEST: f64 = 1e90;

/// What a certificate can be asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct CertifyOptions {
    /// How far bounds may be above the largest value that is found, as a fraction of it, or of 1e-3 D where it is less.
    pub tolerance: f64,
    /// Threads: 0 for all cores, 1 for none but the caller's.
    pub n_threads: u32,
    /// Bounds that each search may take of what it splits off, one a box, and for a piece of a facet one a cell that it meets; where more
    /// are needed the search's bound is sound but looser.
    pub max_boxes: u64,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        CertifyOptions { tolerance: 0.05, n_threads: 0, max_boxes: 4_000_000 }
    }
}

impl CertifyOptions {
    /// Checks every range.
    pub fn validate(&self) -> Result<()> {
        // A NaN is in no range.
        if !(1e-4..=1e4).contains(&self.tolerance) {
            let text = format!("tolerance is {}; it must lie in [1e-4, 1e4]", self.tolerance);
            return Err(Error::InvalidArgument(text));
        }
        if self.max_boxes == 0 {
            return Err(Error::InvalidArgument("max_boxes is 0; at least 1 is needed".into()));
        }
        Workers::check(self.n_threads)
    }
}

/// What was certified. Lengths are in the caller's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate<const D: usize = 3> {
    /// t: larger than phi at every point that is infeasible or within d + r of the shape.
    pub threshold: f64,
    /// The largest phi that was found at such points, and where.
    pub largest_found: f64,
    /// Its place.
    pub place: [f64; D],
    /// eps: at least |phi| everywhere on the shape.
    pub surface_error: f64,
    /// G: at least |grad phi| everywhere in the box.
    pub steepest: f64,
    /// At least |grad phi| everywhere beyond the box, by a fifth or more too large; infinite where the faces are of both sides.
    pub steepest_beyond: f64,
    /// Boxes that were looked at in all.
    pub n_boxes: u64,
    /// Components of the shape, of which [`Mesh::component_points`] has a point each.
    pub n_components: usize,
    /// Whether the shape bounds a solid, so that the infeasible side has its part in t.
    pub is_side_certified: bool,
    /// Whether a search ended before its tolerance was reached, but that beyond the box for the slope.
    pub is_budget_reached: bool,
}

impl<const D: usize> Field<D> {
    /// Certifies this field against `mesh`, the shape that it was fitted to, for `clearance` d and `covering_radius` r: see
    /// [the room's page](self).
    ///
    /// Cost: a bound takes a microsecond, an exact distance one or two more. Every cell is bounded once; then boxes are split where phi is
    /// within the tolerance of its largest, the fewer the more that place stands out. Memory: about 150 bytes a box that is left.
    pub fn certify(
        &self,
        mesh: &Mesh<D>,
        clearance: f64,
        covering_radius: f64,
        options: &CertifyOptions,
        progress: &mut Progress,
    ) -> Result<Certificate<D>> {
        options.validate()?;
        for (name, length) in [("clearance", clearance), ("covering_radius", covering_radius)] {
            if !(0.0..=LARGEST).contains(&length) {
                let length = number(length);
                return Err(Error::InvalidArgument(format!("{name} is {length}; it must lie in [0, {LARGEST:e}]")));
            }
        }
        progress.tell(0.0, "components")?;
        let n_components = mesh.component_points()?.len();
        let work = Work::new(self, mesh, clearance + covering_radius, options, progress)?;
        let steepest = work.steepest(false, |done| progress.tell(0.1 * done, "gradient"))?;
        let steepest_beyond = work.steepest(true, |done| progress.tell(0.1 + 0.1 * done, "gradient"))?;
        // Beyond the box by the formula of the continuation, not by G there, which may be infinite.
        let [on_shape, rounding] = [work.coordinates, work.farthest].map(|x| work.rounding(steepest.upper, x));
        let surface = work.surface(|done| progress.tell(0.2 + 0.3 * done, "surface"))?;
        let threshold = work.threshold(|done| progress.tell(0.5 + 0.5 * done, "threshold"))?;
        progress.tell(1.0, "done")?;
        let all = [&steepest, &steepest_beyond, &surface, &threshold];
        Ok(Certificate {
            threshold: (threshold.upper + rounding).next_up(),
            largest_found: threshold.found,
            place: threshold.place,
            surface_error: surface.upper + on_shape,
            steepest: steepest.upper,
            steepest_beyond: steepest_beyond.upper,
            n_boxes: all.iter().map(|o| o.n_boxes).sum(),
            n_components,
            is_side_certified: work.is_solid,
            is_budget_reached: [&steepest, &surface, &threshold].iter().any(|o| o.is_cut_short),
        })
    }
}

/// phi at a point; minus infinity where it is too far to be evaluated.
fn value<const D: usize>(field: &Field<D>, point: [f64; D]) -> f64 {
    let mut values = [f64::NEG_INFINITY];
    let outputs = Outputs { values: Some(&mut values), ..Outputs::default() };
    if field.eval(&[point], outputs).is_ok() { values[0] } else { f64::NEG_INFINITY }
}

/// Refuses lengths beyond what is served, and those beside which cells of this edge are lost in rounding.
fn check_lengths(coordinates: f64, reach: f64, shortest_edge: f64) -> Result<()> {
    let most = (COARSEST * shortest_edge / (f64::EPSILON * ASIDE)).min(LARGEST);
    if coordinates + reach <= most {
        return Ok(());
    }
    let (farthest, most, edge) = (number(coordinates + reach), number(most), number(shortest_edge));
    let (coordinates, reach) = (number(coordinates), number(reach));
    Err(Error::InvalidArgument(format!(
        "clearance + covering_radius is {reach}, the largest coordinate of the shape and of the field's box {coordinates}: \
         {farthest} together; beside the field's shortest cells, of edge {edge}, at most {most} is served"
    )))
}

/// What the searches share.
struct Work<'a, const D: usize> {
    field: &'a Field<D>,
    mesh: &'a Mesh<D>,
    tree: &'a DistanceTree<D>,
    /// d + r
    reach: f64,
    is_solid: bool,
    /// max |c|
    size: f64,
    /// The largest coordinate of the box and of the shape.
    coordinates: f64,
    /// X: that and the reach.
    farthest: f64,
    options: &'a CertifyOptions,
    workers: Workers,
}

impl<'a, const D: usize> Work<'a, D> {
    fn new(
        field: &'a Field<D>,
        mesh: &'a Mesh<D>,
        reach: f64,
        options: &'a CertifyOptions,
        progress: &mut Progress,
    ) -> Result<Self> {
        let bounds = mesh.bounds();
        let grid = field.grid();
        let ends = grid.axes.iter().flat_map(|a| [a.lower, a.upper()]).chain(bounds.min).chain(bounds.max);
        let coordinates = ends.fold(0.0, |m: f64, x| m.max(x.abs()));
        let farthest = reach + coordinates;
        let cells = Cells::of(field);
        check_lengths(coordinates, reach, cells.shortest_edge())?;
        progress.tell(0.0, "tree")?;
        let tree = mesh.distance_tree()?;
        progress.tell(0.0, "sides")?;
        let is_solid = tree.bounds_solid();
        if is_solid && field.feasible() == Feasible::Inside && field.beyond().sign != Some(-1.0) {
            return Err(Error::Degenerate(
                "the infeasible side goes on for ever, and phi does not fall to minus infinity there: no threshold is \
                 above it; fit the field to this shape with a margin, with this side feasible"
                    .into(),
            ));
        }
        let size = cells.size;
        let workers = Workers::new(options.n_threads)?;
        Ok(Work { field, mesh, tree, reach, is_solid, size, coordinates, farthest, options, workers })
    }

    /// What values are off by at most where coordinates are up to `farthest`, |grad phi| being at most `steepest` in the box.
    fn rounding(&self, steepest: f64, farthest: f64) -> f64 {
        f64::EPSILON * (ROUNDING * self.size + ASIDE * (1.0 + steepest) * farthest)
    }

    fn limits(&self, least: f64) -> Limits {
        Limits { tolerance: self.options.tolerance, least, max_bounds: self.options.max_boxes }
    }

    fn steepest(&self, beyond: bool, tell: impl FnMut(f64) -> Result<()>) -> Result<Outcome<D>> {
        let (found, place) = (0.0, [0.0; D]);
        if beyond && self.field.beyond().sign.is_none() {
            return Ok(Outcome { upper: f64::INFINITY, found, place, n_boxes: 0, is_cut_short: false });
        }
        let rounding = f64::EPSILON * ROUNDING * self.size;
        let problem = Steepness { cells: Cells::of(self.field), beyond, rounding };
        let mut limits = self.limits(LEAST);
        if beyond {
            limits.tolerance = limits.tolerance.max(ROUGHLY);
            limits.max_bounds = limits.max_bounds.min(FEW_BOXES);
        }
        search(&problem, (found, place), limits, &self.workers, tell)
    }

    fn surface(&self, tell: impl FnMut(f64) -> Result<()>) -> Result<Outcome<D>> {
        let slack = f64::EPSILON * ASIDE * self.coordinates;
        let problem = Surface { cells: Cells::of(self.field), mesh: self.mesh, slack };
        search(&problem, (0.0, [0.0; D]), self.limits(LEAST * self.field.diagonal()), &self.workers, tell)
    }

    fn threshold(&self, tell: impl FnMut(f64) -> Result<()>) -> Result<Outcome<D>> {
        let infeasible_inside = self.is_solid.then_some(self.field.feasible() == Feasible::Outside);
        let bounds = self.mesh.bounds();
        let slack = NEARER * bounds.diagonal() + f64::EPSILON * ASIDE * self.farthest;
        let around = self.reach + slack;
        let range = match infeasible_inside {
            Some(false) => Bounds { min: [f64::NEG_INFINITY; D], max: [f64::INFINITY; D] },
            _ => Bounds { min: bounds.min.map(|x| x - around), max: bounds.max.map(|x| x + around) },
        };
        let reach = self.reach;
        let cells = Cells::of(self.field);
        let problem = Clearance { cells, tree: self.tree, range, reach, slack, infeasible_inside };
        let start = self.beside_facets();
        search(&problem, start, self.limits(LEAST * self.field.diagonal()), &self.workers, tell)
    }

    /// The largest phi d + r away from the middles of facets along their normals, and where.
    fn beside_facets(&self) -> (f64, [f64; D]) {
        let n = self.mesh.facets().len();
        let mut best = (f64::NEG_INFINITY, self.mesh.corners(0)[0]);
        for f in (0..n).step_by(n.div_ceil(FIRST_FACETS)) {
            let corners = self.mesh.corners(f);
            let middle = std::array::from_fn(|a| corners.iter().map(|c| c[a]).sum::<f64>() / D as f64);
            let normal = normalized(self.mesh.area_normal(f)).unwrap_or([0.0; D]);
            for side in [1.0 - 1e-12, 1e-12 - 1.0] {
                let place = add(middle, scale(side * self.reach, normal));
                let phi = value(self.field, place);
                if phi > best.0 {
                    best = (phi, place);
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests;
