//! Bodies: points of a design that move with it, and how densely they cover it.

use crate::error::{try_reserve_entry, try_with_capacity};
use crate::geometry::Mesh;
use crate::geometry::vec::{is_finite, norm, number, sub, text};
use crate::{Error, Result};
use std::collections::HashMap;

/// Points of a design in a frame of its own.
#[derive(Debug, Clone)]
pub struct Body<const D: usize> {
    /// Each with a 1 behind it, to be mapped by rows of four.
    points: Vec<[f64; 4]>,
    covering_radius: f64,
}

/// The point, with a 1 behind it.
pub(super) fn with_one<const D: usize>(p: &[f64; D]) -> [f64; 4] {
    let mut with_one = [0.0; 4];
    with_one[..D].copy_from_slice(p);
    with_one[D] = 1.0;
    with_one
}

/// Points of a body, and pieces of a mesh: beyond it numbers of 32 bits end.
const MOST_POINTS: usize = 1 << 30;

/// Coordinates up to this, and down to its inverse as radii, keep what is reckoned from them in the range of doubles.
const LARGEST: f64 = 1e90;

impl<const D: usize> Body<D> {
    /// A body of `points`, of which the caller knows that no point of its surface is farther than `covering_radius` from one of them; 0
    /// where it does not know, or the points are all that there is.
    pub fn new(points: &[[f64; D]], covering_radius: f64) -> Result<Self> {
        let n = points.len();
        if n == 0 || n > MOST_POINTS {
            return Err(Error::InvalidArgument(format!(
                "a body has {n} points; from 1 to {MOST_POINTS} can be served"
            )));
        }
        if let Some((i, p)) =
            points.iter().enumerate().find(|(_, p)| !is_finite(&p[..]) || p.iter().any(|x| x.abs() > LARGEST))
        {
            let p = text(p);
            return Err(Error::InvalidArgument(format!(
                "point {i} is {p}; coordinates must be finite, and at most 1e90 in size"
            )));
        }
        if !(0.0..=LARGEST).contains(&covering_radius) {
            let text = format!(
                "covering_radius is {covering_radius}; it must lie in [0, 1e90], and 0 tells that it is not known"
            );
            return Err(Error::InvalidArgument(text));
        }
        let mut with_ones = try_with_capacity(n, "the points of a body")?;
        with_ones.extend(points.iter().map(with_one));
        Ok(Body { points: with_ones, covering_radius })
    }

    /// Points on `mesh` so dense that none of its surface is farther than `covering_radius` from one of them: the corners of its facets,
    /// halved along their longest edges until no edge is longer than sqrt(3) times the radius, 2 times in the plane. In a triangle no point
    /// is farther from all three corners than the longest edge over sqrt(3): in an acute one than the radius of the circle through its
    /// corners, which is largest where it is equilateral; in others than half the longest edge.
    ///
    /// An edge is halved by its length alone, so neighbours agree on the points of the edge that they share. Cost: O(n) points, of which a
    /// surface of area S has some 0.7 to 1.3 S / radius^2 beside the mesh's own vertices (measured), and a microsecond each at most.
    pub fn on_mesh(mesh: &Mesh<D>, covering_radius: f64) -> Result<Self> {
        if !(1.0 / LARGEST..=LARGEST).contains(&covering_radius) {
            let text = format!("covering_radius is {covering_radius}; it must lie in [1e-90, 1e90]");
            return Err(Error::InvalidArgument(text));
        }
        let longest = covering_radius * if D == 2 { 2.0 } else { 3.0f64.sqrt() };
        check_pieces(mesh, covering_radius, longest)?;
        let mut points = Points { seen: HashMap::new(), points: Vec::new() };
        let mut pieces: Vec<[[f64; D]; D]> = Vec::new();
        for f in 0..mesh.facets().len() {
            pieces.push(mesh.corners(f));
            while let Some(piece) = pieces.pop() {
                let [a, b] = longest_edge(&piece);
                if norm(sub(piece[a], piece[b])) <= longest {
                    piece.iter().try_for_each(|p| points.add(p))?;
                    continue;
                }
                let middle = std::array::from_fn(|k| 0.5 * piece[a][k] + 0.5 * piece[b][k]);
                if middle == piece[a] || middle == piece[b] {
                    let text = format!(
                        "covering_radius {covering_radius} is beyond what the coordinates of facet {f} tell apart; a larger one is needed"
                    );
                    return Err(Error::InvalidArgument(text));
                }
                for end in [a, b] {
                    let mut half = piece;
                    half[end] = middle;
                    pieces.push(half);
                }
            }
        }
        Body::new(&points.points, covering_radius)
    }

    /// How many points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Never: a body has one point at least.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Its points, each with a 1 behind it.
    pub(super) fn with_ones(&self) -> &[[f64; 4]] {
        &self.points
    }

    /// Its points, in its own frame.
    pub fn points(&self) -> impl ExactSizeIterator<Item = [f64; D]> {
        self.points.iter().map(|p| std::array::from_fn(|a| p[a]))
    }

    /// No point of its surface is farther than this from one of its points; 0: not known.
    pub fn covering_radius(&self) -> f64 {
        self.covering_radius
    }
}

/// Refuses a radius that makes more pieces than can be served, before they take time and memory.
fn check_pieces<const D: usize>(mesh: &Mesh<D>, covering_radius: f64, longest: f64) -> Result<()> {
    // A piece is no longer than `longest`, in space no larger than an equilateral triangle of this edge; a point has two pieces or so.
    const MOST_PIECES: f64 = 2.0 * MOST_POINTS as f64;
    let by_square = 3.0f64.sqrt() / 4.0;
    let size = (0..mesh.facets().len()).map(|f| norm(mesh.area_normal(f)) / (D - 1) as f64).sum::<f64>();
    // An edge of the longest is cut up whatever the area beside it.
    let edges = (0..mesh.facets().len()).map(|f| {
        let corners = mesh.corners(f);
        let [a, b] = longest_edge(&corners);
        norm(sub(corners[a], corners[b]))
    });
    let length = edges.sum::<f64>();
    let by_area = if D == 2 { 0.0 } else { size / longest / longest / by_square };
    let pieces = by_area.max(length / longest);
    // A NaN is of coordinates too large.
    if pieces <= MOST_PIECES {
        return Ok(());
    }
    let fitting = if D == 2 { 0.0 } else { (size / MOST_PIECES / by_square).sqrt() }.max(length / MOST_PIECES);
    let (radius, pieces) = (number(covering_radius), number(pieces.ceil()));
    let smallest = number(covering_radius * (fitting / longest));
    Err(Error::InvalidArgument(format!(
        "covering_radius {radius} cuts the mesh into {pieces} pieces or more, of which {MOST_PIECES} can be served; a larger one is needed, \
         {smallest} at least"
    )))
}

/// The ends of the longest edge of a facet, the first of those as long.
fn longest_edge<const D: usize>(corners: &[[f64; D]; D]) -> [usize; 2] {
    let edges: &[[usize; 2]] = if D == 2 { &[[0, 1]] } else { &[[0, 1], [1, 2], [2, 0]] };
    let length = |[a, b]: [usize; 2]| norm(sub(corners[a], corners[b]));
    edges.iter().fold(edges[0], |longest, &edge| if length(edge) > length(longest) { edge } else { longest })
}

/// Points, each once, in the order in which they come.
struct Points<const D: usize> {
    seen: HashMap<[u64; D], ()>,
    points: Vec<[f64; D]>,
}

impl<const D: usize> Points<D> {
    fn add(&mut self, p: &[f64; D]) -> Result<()> {
        const WHAT: &str = "the points of a body";
        // -0 and 0 are one place.
        let p = p.map(|x| x + 0.0);
        try_reserve_entry(&mut self.seen, WHAT)?;
        if self.seen.insert(p.map(f64::to_bits), ()).is_some() {
            return Ok(());
        }
        if self.points.len() == MOST_POINTS {
            let text = format!("the covering radius asks for more than {MOST_POINTS} points; a larger one is needed");
            return Err(Error::InvalidArgument(text));
        }
        crate::error::try_reserve(&mut self.points, 1, WHAT)?;
        self.points.push(p);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::geometry::shapes::{circle, sphere};

    /// No point drawn from the facets is farther than `radius` from all points of the body, and some are nearly so far.
    fn covers<const D: usize>(mesh: &Mesh<D>, radius: f64) {
        let body = Body::on_mesh(mesh, radius).unwrap();
        assert_eq!(body.covering_radius(), radius);
        let points: Vec<[f64; D]> = body.points().collect();
        let mut random = SplitMix64::new(7);
        let mut farthest = 0.0f64;
        for _ in 0..2000 {
            let corners = mesh.corners((random.bits() % mesh.facets().len() as u64) as usize);
            let mut weights: [f64; D] = std::array::from_fn(|_| random.unit());
            let sum: f64 = weights.iter().sum();
            weights = weights.map(|w| w / sum);
            let p = std::array::from_fn(|a| (0..D).map(|c| weights[c] * corners[c][a]).sum());
            farthest = farthest.max(points.iter().map(|q| norm(sub(p, *q))).fold(f64::INFINITY, f64::min));
        }
        assert!(farthest <= radius * (1.0 + 1e-12), "{farthest} beyond {radius}");
        let vertices = mesh.vertices().len();
        assert!(points.len() == vertices || farthest > 0.3 * radius, "{farthest} of {radius}: too many points");
        // Each once.
        let distinct: std::collections::HashSet<_> = points.iter().map(|p| p.map(f64::to_bits)).collect();
        assert_eq!(distinct.len(), points.len());
    }

    #[test]
    fn points_cover_the_mesh_within_their_radius() {
        for radius in [0.02, 0.1, 10.0] {
            covers(&sphere([0.1; 3], 0.7, 4).unwrap(), radius);
            covers(&circle([0.1; 2], 0.7, 12).unwrap(), radius);
        }
        // A sliver, and a right angle.
        let sliver =
            Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.3, 1e-3, 0.0], [0.0, 0.6, 0.2]], vec![[0, 1, 2], [0, 1, 3]]);
        covers(&sliver.unwrap(), 0.01);
    }

    #[test]
    fn bad_bodies_are_refused() {
        let text = |end: Result<Body<3>>| end.unwrap_err().to_string();
        assert!(text(Body::new(&[], 0.0)).contains("0 points"));
        assert!(text(Body::new(&[[0.0; 3], [f64::NAN; 3]], 0.0)).contains("point 1"));
        assert!(text(Body::new(&[[0.0; 3]], -1.0)).contains("covering_radius is -1"));
        let mesh = sphere([0.0; 3], 1.0, 1).unwrap();
        assert!(text(Body::on_mesh(&mesh, 0.0)).contains("covering_radius is 0"));
        // Closer than doubles are.
        let small =
            Mesh::new(vec![[1.0; 3], [1.0 + 4e-16, 1.0, 1.0], [1.0, 1.0 + 4e-16, 1.0]], vec![[0, 1, 2]]).unwrap();
        assert!(text(Body::on_mesh(&small, 1e-18)).contains("of facet 0 tell apart"));
    }

    #[test]
    fn radii_that_ask_for_too_many_pieces_are_refused_at_once() {
        let ball = sphere([0.0; 3], 1.0, 4).unwrap();
        let too_many = Body::on_mesh(&ball, 1e-6).unwrap_err().to_string();
        // 4 pi / (1.299e-12), and the radius that is sqrt of that over 2^31 times as large.
        assert!(too_many.contains("into 96") && too_many.contains("0.000067"), "{too_many}");
        let round = circle([0.0; 2], 1.0, 100).unwrap();
        let too_many = Body::on_mesh(&round, 1e-10).unwrap_err().to_string();
        assert!(too_many.contains("into 314") && too_many.contains("1.46"), "{too_many}");
        let wide = Mesh::new(vec![[0.0; 3], [1e200, 0.0, 1e200], [0.0, 1e200, 1e200]], vec![[0, 1, 2]]).unwrap();
        assert!(Body::on_mesh(&wide, 1e80).is_err());
    }
}
