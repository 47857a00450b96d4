//! Points on a mesh, spread evenly by area, in the plane by length.
//!
//! In space, candidates, [`CANDIDATES_PER_POINT`] for each point asked for, are drawn stratified by area; then all but `n_points` are
//! eliminated, the most crowded first (`eliminate.rs`). The result is a blue noise: neighbours keep a distance, and no
//! direction is preferred. In the plane, points are counted off along the curves (`along_curves.rs`).

use super::along_curves::along_curves;
use super::cloud::{Cloud, Origin};
use super::eliminate::{Candidate, eliminate};
use super::facet::cut;
use super::normals::corner_normals;
use super::random::SplitMix64;
use super::unit::Unit;
use super::vec::{dot, normalized, scale};
use super::{Mesh, facet};
use crate::error::try_with_capacity;
use crate::{Error, Result};

/// Candidates drawn for each point kept. More gain a little spacing, and time and memory grow in proportion.
pub const CANDIDATES_PER_POINT: usize = 4;

impl<const D: usize> Mesh<D> {
    /// `n_points` points on the mesh, evenly by area, in the plane by length, with normals that respect sharp edges ([`super::normals`])
    /// and the places they were taken from. The same mesh, number and seed give the same bits, and a mesh scaled by a power of two
    /// gives the same points, scaled. Points come in rows of grid cells, z slowest and x fastest, in the plane curve by curve: near in the
    /// list is near in space.
    pub fn sample(&self, n_points: usize, seed: u64) -> Result<Cloud<D>> {
        if n_points == 0 || n_points > u32::MAX as usize / CANDIDATES_PER_POINT {
            return Err(Error::InvalidArgument(format!(
                "{n_points} sample points are asked for; from 1 to {} can be served",
                u32::MAX as usize / CANDIDATES_PER_POINT
            )));
        }
        let unit = Unit::of(self);
        let mesh = unit.shrunk(self)?;
        let sampled = match D {
            2 => along_curves(&mesh, n_points, seed)?,
            _ => over_surface(&mesh, n_points, seed)?,
        };
        if sampled.is_empty() {
            return Err(without_area(self));
        }
        taken(&mesh, unit, sampled)
    }
}

/// The cloud of the points of the shrunk `mesh` at `origins`, in the caller's `unit`.
pub(super) fn taken<const D: usize>(mesh: &Mesh<D>, unit: Unit, origins: Vec<Origin<D>>) -> Result<Cloud<D>> {
    let corner_normals = corner_normals(mesh)?;
    let mut points = try_with_capacity(origins.len(), "the sample points")?;
    let mut normals = try_with_capacity(origins.len(), "the sample normals")?;
    for &Origin { facet: f, barycentric } in &origins {
        let f = f as usize;
        let face = normalized(mesh.area_normal(f)).unwrap_or([0.0; D]);
        points.push(scale(unit.grow, facet::point(&mesh.corners(f), barycentric)));
        normals.push(interpolate_normal(&corner_normals[f], barycentric, face));
    }
    Ok(Cloud::new(points, normals)?.with_origins(origins))
}

fn without_area<const D: usize>(mesh: &Mesh<D>) -> Error {
    let (n, name, area) = (mesh.facets().len(), Mesh::<D>::FACET, if D == 2 { "a length" } else { "an area" });
    Error::Degenerate(format!(
        "none of the {n} {name}s has {area}, so no point can be drawn from them; check the coordinates"
    ))
}

/// `n_points` places on a mesh of space, spread by elimination; none where no triangle has an area.
fn over_surface<const D: usize>(mesh: &Mesh<D>, n_points: usize, seed: u64) -> Result<Vec<Origin<D>>> {
    let areas = CumulativeArea::of(mesh)?;
    if areas.total == 0.0 {
        return Ok(Vec::new());
    }
    let candidates = draw_candidates(mesh, &areas, n_points * CANDIDATES_PER_POINT, seed)?;
    let mut origins = try_with_capacity(n_points, "the sample origins")?;
    let kept = eliminate(candidates, n_points, areas.total)?;
    origins.extend(kept.iter().map(|c| Origin { facet: c.origin.facet, barycentric: cut(c.origin.barycentric) }));
    Ok(origins)
}

/// Areas of the triangles, summed up.
struct CumulativeArea {
    /// One a triangle: area of triangles 0..=t.
    up_to: Vec<f64>,
    total: f64,
    /// The last triangle that has area.
    last: usize,
}

impl CumulativeArea {
    fn of<const D: usize>(mesh: &Mesh<D>) -> Result<Self> {
        let n = mesh.facets().len();
        let mut up_to = try_with_capacity(n, "the cumulative areas")?;
        let (mut total, mut last) = (0.0, 0);
        for t in 0..n {
            let with_t = total + facet::area(&mesh.corners(t));
            if with_t > total {
                (total, last) = (with_t, t);
            }
            up_to.push(total);
        }
        Ok(CumulativeArea { up_to, total, last })
    }
}

/// Candidate i lies at area (i + u_i) / m of the total, u_i random: so each triangle gets its share to within 2. Within
/// the triangle it is random: a sequence that fills it evenly is a lattice, on which all weights tie and elimination goes astray.
fn draw_candidates<const D: usize>(
    mesh: &Mesh<D>,
    areas: &CumulativeArea,
    m: usize,
    seed: u64,
) -> Result<Vec<Candidate>> {
    let mut random = SplitMix64::new(seed);
    let mut candidates = try_with_capacity(m, "the sample candidates")?;
    let mut t = 0;
    for i in 0..m {
        let target = (i as f64 + random.unit()) / m as f64 * areas.total;
        while t < areas.last && areas.up_to[t] <= target {
            t += 1;
        }
        let barycentric = square_to_triangle(random.unit(), random.unit());
        candidates.push(Candidate {
            point: cut(facet::point(&mesh.corners(t), cut(barycentric))),
            normal: normalized(cut(mesh.area_normal(t))).unwrap_or_default(),
            origin: Origin { facet: t as u32, barycentric },
        });
    }
    Ok(candidates)
}

/// The unit square onto barycentric coordinates, areas and, nearly, shapes kept: Heitz, "A low-distortion map between triangle
/// and square" (2019).
fn square_to_triangle(x: f64, y: f64) -> [f64; 3] {
    let [a, b] = if y > x { [0.5 * x, y - 0.5 * x] } else { [x - 0.5 * y, 0.5 * y] };
    [a, b, (1.0 - a - b).max(0.0)]
}

/// The normal at `barycentric`; the facet's own where the corners' cancel or turn against it.
fn interpolate_normal<const D: usize>(corners: &[[f64; D]; D], barycentric: [f64; D], face: [f64; D]) -> [f64; D] {
    normalized(facet::point(corners, barycentric)).filter(|n| dot(*n, face) > 0.0).unwrap_or(face)
}

#[cfg(test)]
mod tests {
    use super::super::eliminate::largest_radius;
    use super::super::shapes::{box_mesh, sphere, torus};
    use super::super::vec::{Vec3, norm, sub};
    use super::*;

    fn area(mesh: &Mesh) -> f64 {
        (0..mesh.triangles().len()).map(|t| 0.5 * norm(mesh.area_normal(t))).sum()
    }

    /// Distance of each point to its nearest neighbour.
    fn nearest(points: &[Vec3]) -> Vec<f64> {
        let to = |i: usize| {
            let others = points.iter().enumerate().filter(move |(j, _)| *j != i);
            others.fold(f64::INFINITY, |d, (_, q)| d.min(norm(sub(points[i], *q))))
        };
        (0..points.len()).map(to).collect()
    }

    #[test]
    fn every_number_of_points_is_met_on_the_surface() {
        let ring = torus(2.0, 0.5, 30, 20).unwrap();
        for n in [1, 2, 3, 7, 100, 1001] {
            let cloud = ring.sample(n, 5).unwrap();
            assert_eq!(cloud.len(), n);
            for ((p, normal), o) in cloud.points().iter().zip(cloud.normals()).zip(cloud.origins().unwrap()) {
                let corners = ring.corners(o.facet as usize);
                assert!(o.barycentric.iter().all(|b| (0.0..=1.0).contains(b)));
                assert!((o.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                assert!(norm(sub(*p, facet::point(&corners, o.barycentric))) < 1e-15);
                assert!(dot(*normal, ring.area_normal(o.facet as usize)) > 0.0);
            }
        }
    }

    #[test]
    fn neighbours_keep_most_of_the_hexagonal_distance() {
        let ball = sphere([0.0; 3], 1.0, 4).unwrap();
        let n = 2000;
        let hexagonal = 2.0 * largest_radius(area(&ball), n);
        let smallest = |points: &[Vec3]| nearest(points).into_iter().fold(f64::INFINITY, f64::min) / hexagonal;

        let blue = smallest(ball.sample(n, 1).unwrap().points());
        let areas = CumulativeArea::of(&ball).unwrap();
        let random: Vec<Vec3> = draw_candidates(&ball, &areas, n, 1).unwrap().iter().map(|c| c.point).collect();
        assert!(blue > 0.68, "{blue}");
        assert!(blue > 5.0 * smallest(&random), "{blue}");
    }

    #[test]
    fn counts_are_proportional_to_area() {
        // The six faces have areas 2, 2, 3, 3, 6, 6 of 22.
        let slab = box_mesh([0.0; 3], [1.0, 2.0, 3.0]).unwrap();
        let n = 22_000;
        let cloud = slab.sample(n, 3).unwrap();
        let mut counts = [0_usize; 12];
        for o in cloud.origins().unwrap() {
            counts[o.facet as usize] += 1;
        }
        for (t, count) in counts.iter().enumerate() {
            let share = n as f64 * 0.5 * norm(slab.area_normal(t)) / area(&slab);
            // An even spread misses by points along the rim, of number sqrt(share), not by random's deviation alone.
            assert!((*count as f64 - share).abs() < 1.5 * share.sqrt(), "{t}: {count} for {share}");
        }
        // A cube's samples have its faces' normals to the bit, up to the rim.
        for (normal, o) in cloud.normals().iter().zip(cloud.origins().unwrap()) {
            assert_eq!(Some(*normal), normalized(slab.area_normal(o.facet as usize)));
        }
    }

    #[test]
    fn sides_of_a_thin_sheet_do_not_repel() {
        let thickness = 1e-6;
        let sheet = box_mesh([0.0; 3], [1.0, 1.0, thickness]).unwrap();
        let n = 1000;
        let cloud = sheet.sample(n, 11).unwrap();
        for side in [1.0, -1.0] {
            let points: Vec<Vec3> =
                (0..n).filter(|&i| cloud.normals()[i][2] == side).map(|i| cloud.points()[i]).collect();
            assert!(points.len().abs_diff(n / 2) < 10, "{}", points.len());
            let smallest = nearest(&points).into_iter().fold(f64::INFINITY, f64::min);
            assert!(smallest > 0.65 * 2.0 * largest_radius(2.0, n), "{smallest}");
        }
    }

    #[test]
    fn the_seed_decides_and_a_power_of_two_only_scales() {
        let ball = sphere([0.5, 0.25, -3.0], 1.0, 3).unwrap();
        let cloud = ball.sample(500, 9).unwrap();
        assert_eq!(cloud.points(), ball.sample(500, 9).unwrap().points());
        assert_ne!(cloud.points(), ball.sample(500, 10).unwrap().points());
        for exponent in [-600, -30, 1, 30, 600] {
            let factor = 2.0_f64.powi(exponent);
            let vertices = ball.vertices().iter().map(|&v| scale(factor, v)).collect();
            let scaled = Mesh::new(vertices, ball.triangles().to_vec()).unwrap().sample(500, 9).unwrap();
            assert_eq!(scaled.normals(), cloud.normals());
            assert!(scaled.points().iter().zip(cloud.points()).all(|(a, b)| *a == scale(factor, *b)));
        }
    }

    #[test]
    fn refuses_no_points_and_no_area() {
        let cube = box_mesh([0.0; 3], [1.0; 3]).unwrap();
        assert!(matches!(cube.sample(0, 1), Err(Error::InvalidArgument(_))));
        assert!(matches!(cube.sample(usize::MAX, 1), Err(Error::InvalidArgument(_))));
        let line = Mesh::new(vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2], [0, 0, 1]]).unwrap();
        assert!(matches!(line.sample(10, 1), Err(Error::Degenerate(_))));
    }

    #[test]
    fn far_apart_specks_are_sampled() {
        let speck = |x: f64| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]];
        let vertices = [speck(0.0), speck(1e12)].concat();
        let cloud = Mesh::new(vertices, vec![[0, 1, 2], [3, 4, 5], [0, 0, 0]]).unwrap().sample(100, 1).unwrap();
        assert!(cloud.points().iter().filter(|p| p[0] > 10.0).count().abs_diff(50) <= 3);
    }
}
