//! Brelje et al. 2020, as paper 000 tells of it (section 2.1): two triangulations are apart where their minimum distance is above 0, their
//! intersection length is 0, and neither lies inside the other, which needs a test of its own, without derivatives.
//!
//! The minimum distance is that of all pairs of triangles, or its KS from below, m - D / rho ln sum exp(-rho (d_ij - m) / D), with D the
//! diagonal of the first mesh; pairs more than 37 D / rho beyond the nearest, which count less than 1e-16, are left out. The intersection
//! length is the length of all segments along which triangles cross; triangles in one plane have none.
//!
//! Derivatives are by the vertices of the second mesh, and by its translation, their sum. The minimum jumps from one piece to another where
//! the nearest pair changes, and KS kinks where the nearest features of a pair do, at parallel edges too, or a pair begins to cross: d_ij is
//! piecewise smooth. Where meshes cross, the distance of crossing pairs is 0, and so is its gradient: then the intersection length alone tells
//! the way out, and inside each other not even that. The length is continuous, but for triangles that come to lie in one plane, with kinks
//! where its ends go from edge to edge, and its gradient is not bounded where two triangles begin to cross. There are no Hessians.

use crate::error::{try_vec, try_with_capacity};
use crate::geometry::Mesh;
use crate::geometry::bounds::DIAGONALS;
use crate::geometry::edges::Sets;
use crate::geometry::pairs::{Pair, Pairs};
use crate::geometry::triangle_pair::{Crossing, crossing, nearest};
use crate::geometry::vec::{Vec3, add, is_finite, scale, sub, text};
use crate::{Error, Result};

/// rho times lengths beyond the nearest pair, by D, from which on pairs are left out: exp(-37) is below 1e-16.
const REACH: f64 = 37.0;

/// Coordinates keep squares in the range of doubles.
const LARGEST: f64 = 1e90;

/// How the distances of pairs of triangles become one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairDistance {
    /// The least.
    Minimum,
    /// KS from below, with rho, in 1 / D, in [1, 1e9].
    Ks(f64),
}

/// How two meshes lie to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// In the caller's unit; 0 where triangles cross, and by KS below 0 there.
    pub minimum_distance: f64,
    /// In the caller's unit.
    pub intersection_length: f64,
    /// d minimum_distance / d translation, without unit.
    pub distance_by_translation: Vec3,
    /// d intersection_length / d translation, without unit.
    pub length_by_translation: Vec3,
    /// A vertex of the second mesh, one for each part connected by vertices, lies inside the first: of parts that do not cross it, all do.
    pub second_in_first: bool,
    /// The same of the first mesh in the second.
    pub first_in_second: bool,
}

/// Where derivatives by the vertices of the second mesh [V x 3] go; `None` where they are not wanted.
#[derive(Default)]
pub struct ByVertices<'a> {
    /// Of the minimum distance.
    pub distance: Option<&'a mut [Vec3]>,
    /// Of the intersection length.
    pub length: Option<&'a mut [Vec3]>,
}

/// The separation of `first` and of `second` moved by `translation`.
///
/// Cost: the trees of both meshes, once; then some microseconds for each pair of triangles that are about as near as the nearest, or cross,
/// with KS for each within the least distance and 37 D / rho, which is every pair where rho is small; a side test for each connected part,
/// and O(V) for finding the parts and for gradients.
pub fn separation(
    first: &Mesh,
    second: &Mesh,
    translation: Vec3,
    distance: PairDistance,
    mut by_vertices: ByVertices,
) -> Result<Separation> {
    check(first, second, translation, distance, &by_vertices)?;
    let pairs = Pairs::new(first.distance_tree()?, second.distance_tree()?, translation);
    if let Some(g) = by_vertices.distance.as_deref_mut() {
        g.fill([0.0; 3]);
    }
    if let Some(g) = by_vertices.length.as_deref_mut() {
        g.fill([0.0; 3]);
    }
    let mut distances = Sum { second, by_vertices: by_vertices.distance, by_translation: [0.0; 3] };
    let minimum_distance = match distance {
        PairDistance::Minimum => {
            let (least, pair) = least(&pairs);
            distances.take_in(pair.facets[1], &gradient(&pair), 1.0);
            least * pairs.grow()
        }
        PairDistance::Ks(rho) => soft_least(&pairs, rho / (first.bounds().diagonal() * pairs.shrink()), &mut distances),
    };
    let mut lengths = Sum { second, by_vertices: by_vertices.length, by_translation: [0.0; 3] };
    let mut length = 0.0;
    pairs.visit(0.0, |pair| {
        if let Some(Crossing { length: of_pair, by_b }) = crossing(&pair.corners[0], &pair.corners[1]) {
            length += of_pair;
            lengths.take_in(pair.facets[1], &by_b, 1.0);
        }
        0.0
    });
    let back = translation.map(|x| -x);
    Ok(Separation {
        minimum_distance,
        intersection_length: length * pairs.grow(),
        distance_by_translation: distances.by_translation,
        length_by_translation: lengths.by_translation,
        second_in_first: has_part_inside(second, translation, first)?,
        first_in_second: has_part_inside(first, back, second)?,
    })
}

fn check(first: &Mesh, second: &Mesh, translation: Vec3, distance: PairDistance, to: &ByVertices) -> Result<()> {
    let wrong = |text: String| Err(Error::InvalidArgument(text));
    for (name, mesh) in [("first", first), ("second", second)] {
        let bounds = mesh.bounds();
        if !DIAGONALS.contains(&bounds.diagonal()) {
            let diagonal = bounds.diagonal();
            return wrong(format!("the diagonal of the {name} mesh is {diagonal}; it must lie in [1e-90, 1e90]"));
        }
        if bounds.min.iter().chain(&bounds.max).any(|x| x.abs() > LARGEST) {
            return wrong(format!("the {name} mesh has coordinates beyond 1e90; they are not served"));
        }
    }
    if !(is_finite(&translation) && translation.iter().all(|x| x.abs() <= LARGEST)) {
        let translation = text(&translation);
        return wrong(format!("translation is {translation}; it must be finite, and at most 1e90 in size"));
    }
    if let PairDistance::Ks(rho) = distance
        && !(1.0..=1e9).contains(&rho)
    {
        return wrong(format!("sharpness is {rho}; it must lie in [1, 1e9], or be 0 for the minimum"));
    }
    let n = second.vertices().len();
    let lengths = [&to.distance, &to.length].map(|g| g.as_ref().map_or(n, |g| g.len()));
    match lengths.into_iter().find(|len| *len != n) {
        Some(len) => wrong(format!("there is room for the gradients of {len} vertices; the second mesh has {n}")),
        None => Ok(()),
    }
}

/// Derivatives, summed by vertices and over all.
struct Sum<'a> {
    second: &'a Mesh,
    by_vertices: Option<&'a mut [Vec3]>,
    by_translation: Vec3,
}

impl Sum<'_> {
    fn take_in(&mut self, facet: u32, by_corners: &[Vec3; 3], weight: f64) {
        for (&v, by_corner) in self.second.triangles()[facet as usize].iter().zip(by_corners) {
            let part = scale(weight, *by_corner);
            self.by_translation = add(self.by_translation, part);
            if let Some(g) = &mut self.by_vertices {
                g[v as usize] = add(g[v as usize], part);
            }
        }
    }

    fn divide_by(&mut self, sum: f64) {
        let divided = |v: Vec3| v.map(|x| x / sum);
        self.by_translation = divided(self.by_translation);
        if let Some(g) = &mut self.by_vertices {
            g.iter_mut().for_each(|g| *g = divided(*g));
        }
    }
}

/// Distance of a pair, 0 where it crosses.
fn distance_of(pair: &Pair) -> f64 {
    let [a, b] = &pair.corners;
    if pair.apart_squared == 0.0 && crossing(a, b).is_some() { 0.0 } else { nearest(a, b).distance_squared.sqrt() }
}

/// d distance / d corners of the second triangle; 0 where they meet.
fn gradient(pair: &Pair) -> [Vec3; 3] {
    let [a, b] = &pair.corners;
    if pair.apart_squared == 0.0 && crossing(a, b).is_some() {
        return [[0.0; 3]; 3];
    }
    let found = nearest(a, b);
    let distance = found.distance_squared.sqrt();
    if distance == 0.0 {
        return [[0.0; 3]; 3];
    }
    let [on_a, on_b] = found.barycentric;
    let at =
        |corners: &[Vec3; 3], k: Vec3| (1..3).fold(scale(k[0], corners[0]), |p, c| add(p, scale(k[c], corners[c])));
    let away = scale(1.0 / distance, sub(at(b, on_b), at(a, on_a)));
    on_b.map(|weight| scale(weight, away))
}

/// The least distance, in the pairs' unit, and the first pair found that has it.
fn least(pairs: &Pairs) -> (f64, Pair) {
    let mut best = f64::INFINITY;
    let mut of = Pair { facets: [0; 2], corners: [[[0.0; 3]; 3]; 2], apart_squared: 0.0 };
    pairs.visit(f64::INFINITY, |pair| {
        let distance = distance_of(pair);
        if distance < best {
            (best, of) = (distance, *pair);
        }
        // Nothing is nearer than 0.
        if best == 0.0 { -1.0 } else { best * best }
    });
    (best, of)
}

/// KS of the distances with `rho` in 1 / the pairs' unit, in the caller's unit; its derivatives go to `sum`.
fn soft_least(pairs: &Pairs, rho: f64, sum: &mut Sum) -> f64 {
    let (least, _) = least(pairs);
    let reach = least + REACH / rho;
    let mut total = 0.0;
    pairs.visit(reach * reach, |pair| {
        let distance = distance_of(pair);
        if distance <= reach {
            let weight = (-rho * (distance - least)).exp();
            total += weight;
            sum.take_in(pair.facets[1], &gradient(pair), weight);
        }
        reach * reach
    });
    sum.divide_by(total);
    (least - total.ln() / rho) * pairs.grow()
}

/// Whether a vertex of `mesh`, moved, one a part, lies inside `other`.
fn has_part_inside(mesh: &Mesh, translation: Vec3, other: &Mesh) -> Result<bool> {
    let mut parts = Sets::new(mesh.vertices().len())?;
    for &[a, b, c] in mesh.triangles() {
        parts.join(a as usize, b as usize);
        parts.join(b as usize, c as usize);
    }
    let mut used = try_vec(mesh.vertices().len(), false, "the parts of the mesh")?;
    mesh.triangles().iter().flatten().for_each(|&v| used[v as usize] = true);
    let n = (0..used.len()).filter(|&v| used[v] && parts.is_first(v)).count();
    let mut points = try_with_capacity(n, "a point of each part")?;
    let firsts = (0..used.len()).filter(|&v| used[v] && parts.is_first(v));
    points.extend(firsts.map(|v| add(mesh.vertices()[v], translation)));
    let mut distances = try_vec(n, 0.0, "a point of each part")?;
    other.distance_tree()?.signed_distances(&points, &mut distances)?;
    Ok(distances.iter().any(|d| *d < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;
    use crate::geometry::shapes::{box_mesh, sphere, torus};
    use crate::geometry::vec::dot;

    fn of(first: &Mesh, second: &Mesh, translation: Vec3) -> Separation {
        separation(first, second, translation, PairDistance::Minimum, ByVertices::default()).unwrap()
    }

    /// Every pair of triangles, without trees.
    fn brute_force(first: &Mesh, second: &Mesh, by: Vec3) -> (f64, f64) {
        let (mut least, mut length) = (f64::INFINITY, 0.0);
        for i in 0..first.triangles().len() {
            for j in 0..second.triangles().len() {
                let (a, b) = (first.corners(i), second.corners(j).map(|p| add(p, by)));
                match crossing(&a, &b) {
                    Some(c) => (least, length) = (0.0, length + c.length),
                    None => least = least.min(nearest(&a, &b).distance_squared.sqrt()),
                }
            }
        }
        (least, length)
    }

    #[test]
    fn agrees_with_all_pairs() {
        let shapes = [
            torus(0.7, 0.2, 14, 8).unwrap(),
            sphere([0.0; 3], 0.5, 2).unwrap(),
            box_mesh([-0.3; 3], [0.4; 3]).unwrap(),
        ];
        let mut random = SplitMix64::new(4);
        for (k, first) in shapes.iter().enumerate() {
            for second in &shapes[k..] {
                for _ in 0..12 {
                    let by: Vec3 = std::array::from_fn(|_| random.between(-1.2, 1.2));
                    let (found, (least, length)) = (of(first, second, by), brute_force(first, second, by));
                    assert!((found.minimum_distance - least).abs() < 1e-14, "{found:?} {least}");
                    assert!((found.intersection_length - length).abs() < 1e-10, "{found:?} {length}");
                    let swapped = of(second, first, by.map(|x| -x));
                    assert!((swapped.intersection_length - length).abs() < 1e-10);
                    assert_eq!(
                        [swapped.first_in_second, swapped.second_in_first],
                        [found.second_in_first, found.first_in_second]
                    );
                }
            }
        }
    }

    #[test]
    fn boxes_have_their_distance_length_and_insides() {
        let (large, small) = (box_mesh([0.0; 3], [1.0; 3]).unwrap(), box_mesh([0.0; 3], [0.5; 3]).unwrap());
        let away = of(&large, &small, [4.0, 0.25, 5.0]);
        assert_eq!((away.minimum_distance, away.intersection_length), (5.0, 0.0));
        let by = away.distance_by_translation;
        assert!(by.iter().zip([0.6, 0.0, 0.8]).all(|(a, b)| (a - b).abs() < 1e-15), "{by:?}");
        assert!(!away.second_in_first && !away.first_in_second);
        // Through a face: a square of edge 1/2. Through an edge: two rectangles, less the sides that lie on the edge.
        for (by, length) in [([0.75, 0.2, 0.3], 2.0), ([0.75, 0.7, 0.3], 2.0 * (0.25 + 0.3 + 0.5))] {
            let found = of(&large, &small, by);
            assert_eq!(found.minimum_distance, 0.0);
            assert!((found.intersection_length - length).abs() < 1e-12, "{by:?}: {found:?}");
        }
        let within = of(&large, &small, [0.125, 0.25, 0.2]);
        assert_eq!((within.minimum_distance, within.intersection_length), (0.125, 0.0));
        assert!(within.second_in_first && !within.first_in_second);
        assert!(of(&small, &large, [-0.125, -0.25, -0.2]).first_in_second);
    }

    #[test]
    fn spheres_meet_in_a_circle() {
        let ball = sphere([0.0; 3], 1.0, 5).unwrap();
        // Centres 1.2 apart: a circle of radius 0.8. The meshes are inscribed.
        let found = of(&ball, &ball, [0.72, 0.96, 0.0]);
        assert!((found.intersection_length / (1.6 * std::f64::consts::PI) - 1.0).abs() < 2e-3, "{found:?}");
        // d (2 pi sqrt(1 - s^2 / 4)) / d s = -pi s / (2 sqrt(1 - s^2 / 4))
        let along = dot(found.length_by_translation, [0.6, 0.8, 0.0]);
        assert!((along / (-0.75 * std::f64::consts::PI) - 1.0).abs() < 0.02, "{along}");
        let apart = of(&ball, &ball, [3.0, 4.0, 0.0]);
        assert!((apart.minimum_distance - 3.0).abs() < 2e-3);
    }

    /// Derivatives by all vertices and by the translation against central differences.
    fn check_derivatives(first: &Mesh, second: &Mesh, by: Vec3, distance: PairDistance, tolerance: f64) {
        let n = second.vertices().len();
        let (mut by_distance, mut by_length) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
        let to = ByVertices { distance: Some(&mut by_distance), length: Some(&mut by_length) };
        let found = separation(first, second, by, distance, to).unwrap();
        let values = |mesh: &Mesh, by: Vec3| {
            let found = separation(first, mesh, by, distance, ByVertices::default()).unwrap();
            [found.minimum_distance, found.intersection_length]
        };
        let h = 1e-6;
        for axis in 0..3 {
            let moved = |step: f64| {
                let mut to = by;
                to[axis] += step;
                values(second, to)
            };
            let (up, down) = (moved(h), moved(-h));
            for (k, exact) in [found.distance_by_translation, found.length_by_translation].into_iter().enumerate() {
                let difference = (up[k] - down[k]) / (2.0 * h);
                assert!((exact[axis] - difference).abs() < tolerance, "{k}: {} {difference}", exact[axis]);
            }
            for v in 0..n {
                let moved = |step: f64| {
                    let mut vertices = second.vertices().to_vec();
                    vertices[v][axis] += step;
                    values(&Mesh::new(vertices, second.triangles().to_vec()).unwrap(), by)
                };
                let (up, down) = (moved(h), moved(-h));
                for (k, exact) in [by_distance[v], by_length[v]].into_iter().enumerate() {
                    let difference = (up[k] - down[k]) / (2.0 * h);
                    assert!((exact[axis] - difference).abs() < tolerance, "{k} {v}: {} {difference}", exact[axis]);
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        // Turned and sheared, so that no edges are parallel: there the nearest points are many, and the distance has a kink.
        let round = sphere([0.0; 3], 0.5, 0).unwrap();
        let turned = |p: &Vec3| [[0.8, -0.5, 0.33], [0.6, 0.7, -0.4], [-0.1, 0.5, 0.85]].map(|row| dot(row, *p));
        let ball = Mesh::new(round.vertices().iter().map(turned).collect(), round.triangles().to_vec()).unwrap();
        let ring = torus(0.7, 0.2, 12, 7).unwrap();
        for distance in [PairDistance::Minimum, PairDistance::Ks(50.0)] {
            check_derivatives(&ring, &ball, [0.31, 1.73, 0.45], distance, 1e-5);
            check_derivatives(&ring, &ball, [0.83, 0.21, 0.34], distance, 1e-5);
        }
    }

    #[test]
    fn ks_is_below_the_minimum_by_the_number_of_pairs_at_most() {
        let (ball, ring) = (sphere([0.0; 3], 0.5, 2).unwrap(), torus(0.7, 0.2, 20, 10).unwrap());
        let by = [0.2, 1.6, 0.3];
        let least = of(&ring, &ball, by).minimum_distance;
        let n = (ball.triangles().len() * ring.triangles().len()) as f64;
        for rho in [1.0, 30.0, 1e3, 1e9] {
            let soft = separation(&ring, &ball, by, PairDistance::Ks(rho), ByVertices::default()).unwrap();
            let most = ring.bounds().diagonal() * n.ln() / rho;
            assert!((-1e-15..=most).contains(&(least - soft.minimum_distance)), "{rho}: {soft:?} {least}");
        }
    }

    #[test]
    fn bad_arguments_are_refused() {
        let ball = sphere([0.0; 3], 1.0, 1).unwrap();
        let text =
            |by: Vec3, distance, to: ByVertices| separation(&ball, &ball, by, distance, to).unwrap_err().to_string();
        assert!(text([f64::NAN, 0.0, 0.0], PairDistance::Minimum, ByVertices::default()).contains("translation"));
        assert!(text([0.0; 3], PairDistance::Ks(0.5), ByVertices::default()).contains("sharpness is 0.5"));
        let mut short = [[0.0; 3]; 2];
        let to = ByVertices { distance: Some(&mut short), length: None };
        assert!(text([0.0; 3], PairDistance::Minimum, to).contains("2 vertices"));
        let speck = Mesh::new(vec![[1.0; 3]], vec![[0, 0, 0]]).unwrap();
        let end = separation(&ball, &speck, [0.0; 3], PairDistance::Minimum, ByVertices::default());
        assert!(end.unwrap_err().to_string().contains("the second mesh is 0"));
    }
}
