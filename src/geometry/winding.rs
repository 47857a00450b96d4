//! Generalised winding number of a mesh: Jacobson, Kavan and Sorkine-Hornung, "Robust inside-outside segmentation using
//! generalized winding numbers" (2013); fast by Barill, Dickson, Schmidt, Levin and Jacobson, "Fast winding numbers for soups and
//! clouds" (2018).
//!
//! Notation: w winding number, q query, r = c - q with R = |r|, c a node's centre, A n area and unit normal of its facets, in the plane
//! lengths and segments; d = x - c for their points x.
//!
//! | | there | here |
//! |---|---|---|
//! | 2013 | w = sum of solid angles / that of all directions, 4 pi or 2 pi | [`Winding::exact`] |
//! | 2018 | Taylor expansion to the first order | [`Moments::far_field`] |
//! | 2018 | its use from beta radii on | [`Winding::approximate`] |
//!
//! A side is decided by w < 1/2. Where the expansion is not clear of 1/2 by what it may be off, what the mesh's rim tells goes with it
//! ([`Closing`]): behind a flat sheet w comes as near to 1/2 as one likes. Where the expansion is not good enough for that it is refined;
//! where the rim is longer than the mesh, too, and at last all facets are summed.
//!
//! **What the expansion is off by.** The solid angle is the integral of n . F(r + d), F(r) = r / R^D = -grad of 1 / R, of -ln R in the plane.
//! Of the multipole series of 1 / |r + d| the term of degree l is a solid harmonic (d / R)^l P_l / R, of gradient at most l |d|^(l - 1) /
//! R^(l + 1): with k = l - 1 the square of the gradient is that of |d|^k / R^(l + 1) times l^2 P_k^2 + (1 - x^2) P'_k^2, which is at most l^2
//! since P_k^2 + (1 - x^2) P'_k^2 / (k (k + 1)) <= 1.
//! The expansion has the terms l = 1, 2. With t >= |d| / R the others sum up to
//!
//! ```text
//! sum over l >= 3 of l |d|^(l - 1) / R^(l + 1) <= (|d|^2 / R^4) (3 - 2 t) / (1 - t)^2
//! ```
//!
//! and in the plane, where they are (d / r)^k / r for k >= 2 as complex numbers, to (|d|^2 / R^3) / (1 - t). So a node is off by at most
//! the integral of |d|^2 over its facets, [`Moments::spread`], times this; t = 1 / beta. Shells in shells add up, and so do these.

use super::Mesh;
use super::bvh::{Bvh, STACK_SIZE};
use super::facet::{all_directions, normal, solid_angle};
use super::rim::Closing;
use super::vec::{add, dot, norm, scale, sub};
use crate::Result;
use crate::error::try_vec;

/// Far fields are used from so many radii on, pass by pass.
const PASSES: [f64; 3] = [2.0, 3.5, 8.0];

/// What sums over facets and far fields may be rounded by, much more than they are.
const ROUNDING: f64 = 1e-3;

/// w, and what it may be off by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rough {
    pub w: f64,
    error: f64,
}

/// Side of a point: where the mesh's normals point to, or behind them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// w < 1/2
    Outside,
    /// w >= 1/2
    Inside,
}

impl Side {
    fn of(w: f64) -> Self {
        if w < 0.5 { Side::Outside } else { Side::Inside }
    }
}

/// The facets below a node, seen from afar.
#[derive(Debug, Clone, Copy)]
struct Moments<const D: usize> {
    /// c: the mean of the facets' centroids by area.
    center: [f64; D],
    /// Of a sphere around c that holds the node's box.
    radius_squared: f64,
    /// Sum of A n.
    dipole: [f64; D],
    /// Symmetric part of the sum of A n (x - c)^T, x a facet's centroid: its diagonal, and xy yz zx; in the plane xy alone counts.
    quadrupole: [[f64; D]; 2],
    /// Sum of A.
    area: f64,
    /// Sum of the integrals of |x - c|^2 over the facets.
    spread: f64,
}

/// Winding numbers of the facets of a tree.
#[derive(Debug)]
pub(super) struct Winding<const D: usize> {
    /// One a node of the tree.
    moments: Vec<Moments<D>>,
    /// `None` where the mesh's rim is too long, or where no side is to be asked for.
    closing: Option<Closing<D>>,
}

impl<const D: usize> Winding<D> {
    /// For sides of `mesh`; `corners` are its facets' in the tree's order.
    pub fn new(mesh: &Mesh<D>, tree: &Bvh<D>, corners: &[[[f64; D]; D]]) -> Result<Self> {
        Ok(Winding { closing: Closing::of(mesh)?, ..Winding::without_sides(tree, corners)? })
    }

    /// For [`Winding::rough`] alone.
    pub fn without_sides(tree: &Bvh<D>, corners: &[[[f64; D]; D]]) -> Result<Self> {
        let nothing = Moments {
            center: [0.0; D],
            radius_squared: 0.0,
            dipole: [0.0; D],
            quadrupole: [[0.0; D]; 2],
            area: 0.0,
            spread: 0.0,
        };
        let mut moments = try_vec(tree.nodes.len(), nothing, "the far fields")?;
        // Children come after their parents.
        for (i, node) in tree.nodes.iter().enumerate().rev() {
            let middle = node.bounds.center();
            moments[i] = match node.leaf() {
                Some(range) => Moments::sum(corners[range].iter().map(Moments::of_facet), middle),
                None => Moments::sum(node.children().iter().map(|&child| moments[child]), middle),
            };
            let c = moments[i].center;
            let farthest = |a: usize| (node.bounds.max[a] - c[a]).max(c[a] - node.bounds.min[a]);
            moments[i].radius_squared = (0..D).map(|a| farthest(a) * farthest(a)).sum();
        }
        Ok(Winding { moments, closing: None })
    }

    /// Whether nothing is missing for the mesh to be closed: w is an integer beside it.
    pub fn is_closed(&self) -> bool {
        self.closing.as_ref().is_some_and(|closing| closing.len() == 0)
    }

    /// The side of `q`.
    pub fn side(&self, tree: &Bvh<D>, corners: &[[[f64; D]; D]], q: [f64; D]) -> Side {
        // Of a closed mesh w is an integer: 1/2 more lies between it and the other side.
        let free = if self.is_closed() { 0.5 } else { 0.0 };
        for beta in PASSES {
            let rough = self.approximate(tree, corners, q, beta);
            if (rough.w - 0.5).abs() + free > rough.error + ROUNDING {
                return Side::of(rough.w);
            }
            if let Some(w) = self.by_rim(rough, q) {
                return Side::of(w);
            }
        }
        Side::of(Winding::exact(corners, q))
    }

    /// w by what closes the mesh, from a rough w; `None` where the rough one leaves a choice, and where the two are not an integer together,
    /// as where rounding blurs a closing facet on whose edge `q` lies.
    fn by_rim(&self, rough: Rough, q: [f64; D]) -> Option<f64> {
        const TOLERANCE: f64 = 0.1;
        // The next ones that it could be are 1 away.
        (rough.error + TOLERANCE < 1.0).then_some(())?;
        let closing = self.closing.as_ref()?.fraction(q);
        let together = (rough.w + closing).round();
        let w = together - closing;
        ((w - rough.w).abs() < TOLERANCE).then_some(w)
    }

    /// w by the first pass.
    pub fn rough(&self, tree: &Bvh<D>, corners: &[[[f64; D]; D]], q: [f64; D]) -> f64 {
        self.approximate(tree, corners, q, PASSES[0]).w
    }

    /// w by the sum over all facets.
    pub fn exact(corners: &[[[f64; D]; D]], q: [f64; D]) -> f64 {
        corners.iter().map(|t| solid_angle(q, t)).sum::<f64>() / all_directions::<D>()
    }

    /// w with far fields in place of nodes farther away than `beta` times their radius.
    pub fn approximate(&self, tree: &Bvh<D>, corners: &[[[f64; D]; D]], q: [f64; D], beta: f64) -> Rough {
        let mut stack = [0; STACK_SIZE];
        let mut depth = 1;
        let (mut sum, mut error) = (0.0, 0.0);
        while depth > 0 {
            depth -= 1;
            let node = stack[depth];
            let moments = &self.moments[node];
            let r = sub(moments.center, q);
            let r_squared = dot(r, r);
            if r_squared > beta * beta * moments.radius_squared {
                let inverse = 1.0 / r_squared.sqrt();
                sum += moments.far_field(r, inverse);
                error += moments.spread * inverse.powi(D as i32 + 1);
            } else if let Some(range) = tree.nodes[node].leaf() {
                sum += corners[range].iter().map(|t| solid_angle(q, t)).sum::<f64>();
            } else {
                stack[depth..depth + 2].copy_from_slice(&tree.nodes[node].children());
                depth += 2;
            }
        }
        let t = 1.0 / beta;
        let left_out = if D == 2 { 1.0 / (1.0 - t) } else { (3.0 - 2.0 * t) / ((1.0 - t) * (1.0 - t)) };
        Rough { w: sum / all_directions::<D>(), error: left_out * error / all_directions::<D>() }
    }
}

impl<const D: usize> Moments<D> {
    fn of_facet(corners: &[[f64; D]; D]) -> Self {
        let dipole = scale(1.0 / (D - 1) as f64, normal(corners));
        let center = scale(1.0 / D as f64, corners[1..].iter().fold(corners[0], |sum, c| add(sum, *c)));
        let area = norm(dipole);
        // Of a simplex of n dimensions: A / ((n + 1) (n + 2)) times the sum of its corners' squared distances from the middle.
        let from_middle = |c: &[f64; D]| dot(sub(*c, center), sub(*c, center));
        let spread = area * corners.iter().map(from_middle).sum::<f64>() / (D * (D + 1)) as f64;
        Moments { center, radius_squared: 0.0, dipole, quadrupole: [[0.0; D]; 2], area, spread }
    }

    /// The moments of all `parts` about their common centre; `middle` when they have no area.
    fn sum(parts: impl Iterator<Item = Self> + Clone, middle: [f64; D]) -> Self {
        let area: f64 = parts.clone().map(|m| m.area).sum();
        let weighted = parts.clone().fold([0.0; D], |c, m| add(c, scale(m.area, m.center)));
        let center = if area > 0.0 { scale(1.0 / area, weighted) } else { middle };
        let zero =
            Moments { center, radius_squared: 0.0, dipole: [0.0; D], quadrupole: [[0.0; D]; 2], area, spread: 0.0 };
        parts.fold(zero, |sum, m| {
            let (n, d) = (m.dipole, sub(m.center, center));
            // Row 0 the diagonal, row 1 the entry beside it.
            let shift = |beside: usize, a: usize| {
                let b = (a + beside) % D;
                0.5 * (n[a] * d[b] + n[b] * d[a])
            };
            Moments {
                dipole: add(sum.dipole, n),
                quadrupole: std::array::from_fn(|beside| {
                    std::array::from_fn(|a| sum.quadrupole[beside][a] + m.quadrupole[beside][a] + shift(beside, a))
                }),
                spread: sum.spread + m.spread + m.area * dot(d, d),
                ..sum
            }
        })
    }

    /// The solid angle: (N . r) / R^D + tr(M) / R^D - D r^T M r / R^(D + 2), N the dipole and M the quadrupole. By the direction u =
    /// r / R, so that no power of R overflows; `inverse` is 1 / R.
    #[inline]
    fn far_field(&self, r: [f64; D], inverse: f64) -> f64 {
        let u = scale(inverse, r);
        let [diagonal, beside] = self.quadrupole;
        let trace: f64 = diagonal.iter().sum();
        let squares: f64 = (0..D).map(|a| diagonal[a] * u[a] * u[a]).sum();
        let pairs = D * (D - 1) / 2;
        let products: f64 = (0..pairs).map(|a| beside[a] * u[a] * u[(a + 1) % D]).sum();
        let second = trace - D as f64 * (squares + 2.0 * products);
        (dot(self.dipole, u) + second * inverse) * inverse.powi(D as i32 - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Bounds;
    use super::super::random::SplitMix64;
    use super::super::shapes::{TOLD_WRONG_IN_SHELLS, circle, shells, sphere, torus};
    use super::super::vec::{Vec3, normalized};
    use super::*;

    struct Prepared {
        tree: Bvh<3>,
        corners: Vec<[Vec3; 3]>,
        winding: Winding<3>,
    }

    fn prepare(mesh: &Mesh) -> Prepared {
        let tree = Bvh::new(mesh.triangles().len(), |t| Bounds::of(&mesh.corners(t))).unwrap();
        let corners: Vec<_> = tree.order.iter().map(|&t| mesh.corners(t as usize)).collect();
        let winding = Winding::new(mesh, &tree, &corners).unwrap();
        Prepared { tree, corners, winding }
    }

    /// The largest error of the expansion over points in a box twice the mesh's.
    fn worst_error(mesh: &Mesh, beta: f64) -> f64 {
        let Prepared { tree, corners, winding } = prepare(mesh);
        let bounds = mesh.bounds();
        let mut random = SplitMix64::new(3);
        (0..2000).fold(0.0, |worst: f64, _| {
            let q = std::array::from_fn(|a| bounds.center()[a] + bounds.extents()[a] * random.between(-1.0, 1.0));
            worst.max((winding.approximate(&tree, &corners, q, beta).w - Winding::exact(&corners, q)).abs())
        })
    }

    #[test]
    fn closed_meshes_have_winding_number_one_inside_and_zero_outside() {
        let ring = prepare(&torus(3.0, 1.0, 40, 30).unwrap());
        for (q, w) in [([3.0, 0.0, 0.2], 1.0), ([0.0; 3], 0.0), ([3.0, 0.0, 1.5], 0.0), ([1e6, 1e6, 0.0], 0.0)] {
            assert!((Winding::exact(&ring.corners, q) - w).abs() < 1e-12);
        }
    }

    #[test]
    fn errors_of_the_expansion_are_small_on_one_shell() {
        for mesh in
            [torus(3.0, 1.0, 60, 40).unwrap(), torus(3.0, 0.1, 60, 8).unwrap(), sphere([0.0; 3], 1.0, 4).unwrap()]
        {
            for (beta, most) in [(2.0, 0.1), (6.0, 0.01)] {
                let worst = worst_error(&mesh, beta);
                assert!(worst < most, "beta {beta}: {worst}");
            }
        }
    }

    #[test]
    fn expansions_are_off_by_no_more_than_they_tell() {
        let ball = sphere([0.0; 3], 1.0, 4).unwrap();
        let upper = |t: &[u32; 3]| t.iter().all(|&v| ball.vertices()[v as usize][0] > -1e-9);
        let half = ball.triangles().iter().copied().filter(upper).collect();
        let half = Mesh::new(ball.vertices().to_vec(), half).unwrap();
        let mut random = SplitMix64::new(31);
        for mesh in [shells(40), half, torus(3.0, 0.1, 60, 8).unwrap()] {
            let Prepared { tree, corners, winding } = prepare(&mesh);
            let size = mesh.bounds().diagonal();
            for beta in [1.5, 2.0, 6.0] {
                let mut largest: f64 = 0.0;
                for _ in 0..200 {
                    let q = std::array::from_fn(|a| mesh.bounds().center()[a] + size * random.between(-0.5, 0.5));
                    let Rough { w, error } = winding.approximate(&tree, &corners, q, beta);
                    let off = (w - Winding::exact(&corners, q)).abs();
                    assert!(off <= error + 1e-12, "{beta} {q:?}: {off} above {error}");
                    largest = largest.max(off / error);
                }
                assert!(largest > 1e-3, "beta {beta}: {largest}, hardly a bound");
            }
        }
    }

    #[test]
    fn expansions_in_the_plane_are_off_by_no_more_than_they_tell() {
        let mut random = SplitMix64::new(32);
        let round = circle([0.3, 0.1], 1.0, 200).unwrap();
        let arc = Mesh::new(round.vertices().to_vec(), round.facets()[20..].to_vec()).unwrap();
        for mesh in [round, arc] {
            let tree = Bvh::new(mesh.facets().len(), |f| Bounds::of(&mesh.corners(f))).unwrap();
            let corners: Vec<_> = tree.order.iter().map(|&f| mesh.corners(f as usize)).collect();
            let winding = Winding::new(&mesh, &tree, &corners).unwrap();
            for _ in 0..1000 {
                let q = [random.between(-2.0, 2.0), random.between(-2.0, 2.0)];
                let Rough { w, error } = winding.approximate(&tree, &corners, q, 2.0);
                let off = (w - Winding::exact(&corners, q)).abs();
                assert!(off <= error + 1e-12, "{q:?}: {off} above {error}");
            }
        }
    }

    /// Inside all of them w is 1; outside it is 0.
    #[test]
    fn sides_of_shells_in_shells_are_those_by_construction() {
        let Prepared { tree, corners, winding } = prepare(&shells(100));
        for q in TOLD_WRONG_IN_SHELLS {
            let w = winding.rough(&tree, &corners, q);
            assert!(w < 0.3, "{w}: the far fields are no longer wrong at {q:?}, of which this is a test");
            assert_eq!(winding.side(&tree, &corners, q), Side::Inside, "{q:?}");
        }
        let mut random = SplitMix64::new(33);
        let mut n = 0;
        while n < 400 {
            let Some(u) = normalized(std::array::from_fn(|_| random.between(-1.0, 1.0))) else {
                continue;
            };
            let (radius, side) = match n % 2 {
                0 => (0.7 * random.unit(), Side::Inside),
                _ => (1.0 + 10.0_f64.powf(random.between(-2.0, 1.0)), Side::Outside),
            };
            assert_eq!(winding.side(&tree, &corners, scale(radius, u)), side, "{radius}");
            n += 1;
        }
    }

    #[test]
    fn the_expansion_is_of_the_second_order_in_the_distance() {
        // Half a sphere has both moments; the first term left out falls by 2^4, or is small, when the distance doubles.
        let ball = sphere([0.0; 3], 1.0, 4).unwrap();
        let upper = |t: &[u32; 3]| t.iter().all(|&v| ball.vertices()[v as usize][0] > -1e-9);
        let triangles = ball.triangles().iter().copied().filter(upper).collect();
        let half = prepare(&Mesh::new(ball.vertices().to_vec(), triangles).unwrap());
        let error = |distance: f64| {
            let q = scale(distance, [0.48, 0.6, 0.64]);
            let [near, far] = [0.0, 1e9].map(|beta| half.winding.approximate(&half.tree, &half.corners, q, beta).w);
            (near - far).abs()
        };
        let ratio = error(10.0) / error(20.0);
        assert!(ratio > 14.0, "{ratio}");
    }

    /// `n` x `n` squares of the unit square in z = 0, each cut in two, its normals up; triangles share their
    /// vertices, or have their own.
    fn sheet(n: usize, shared: bool) -> Mesh {
        let at = |i: usize, j: usize| [i as f64 / n as f64, j as f64 / n as f64, 0.0];
        let squares = (0..n * n).map(|k| (k / n, k % n));
        let corners = squares.flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        });
        let corners: Vec<[Vec3; 3]> = corners.collect();
        if !shared {
            let triangles = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            return Mesh::new(corners.concat(), triangles).unwrap();
        }
        let number = |p: &Vec3| ((p[0] * n as f64).round() * (n + 1) as f64 + (p[1] * n as f64).round()) as u32;
        let vertices = (0..(n + 1) * (n + 1)).map(|k| at(k / (n + 1), k % (n + 1))).collect();
        Mesh::new(vertices, corners.iter().map(|t| [0, 1, 2].map(|k| number(&t[k]))).collect()).unwrap()
    }

    #[test]
    fn rims_tell_what_all_facets_do() {
        let ball = sphere([0.0; 3], 1.0, 4).unwrap();
        let cap = ball.triangles().iter().copied().filter(|t| t.iter().all(|&v| ball.vertices()[v as usize][0] > 0.3));
        let cap = Mesh::new(ball.vertices().to_vec(), cap.collect()).unwrap();
        let mut random = SplitMix64::new(12);
        for mesh in [cap, sheet(30, true), sheet(30, false), torus(3.0, 1.0, 40, 30).unwrap()] {
            let Prepared { tree, corners, winding } = prepare(&mesh);
            let (low, extents) = (mesh.bounds().min, mesh.bounds().extents());
            for i in 0..600 {
                let mut q: Vec3 = std::array::from_fn(|a| low[a] + extents[a].max(0.1) * random.between(-0.2, 1.2));
                if i % 2 == 0 {
                    q[2] -= 10.0_f64.powi(-(i % 9));
                }
                let exact = Winding::exact(&corners, q);
                let rough = winding.approximate(&tree, &corners, q, 6.0);
                let told = winding.by_rim(rough, q).expect("the point lies beside the closing facets' edges");
                assert!((told - exact).abs() < 1e-10, "{q:?}: {told} for {exact}");
                assert_eq!(winding.side(&tree, &corners, q), Side::of(exact));
            }
        }
    }

    #[test]
    fn behind_a_flat_sheet_as_many_facets_are_asked_as_its_rim_has_edges() {
        for shared in [true, false] {
            let Prepared { tree, corners, winding } = prepare(&sheet(40, shared));
            assert_eq!(winding.closing.as_ref().map(Closing::len), Some(160));
            for q in [[0.4, 0.3, -1e-3], [0.4, 0.3, -1e-9], [0.5, 0.5, -1e-12], [0.4, 0.3, 1e-9]] {
                assert!(winding.by_rim(winding.approximate(&tree, &corners, q, 6.0), q).is_some());
                assert_eq!(winding.side(&tree, &corners, q), Side::Outside);
            }
        }
    }

    #[test]
    fn soups_have_no_rim_to_ask() {
        let apart: Vec<Vec3> = (0..30).map(|i| [f64::from(i), f64::from(i % 3 * i), f64::from(i % 2)]).collect();
        let soup = prepare(&Mesh::new(apart, (0..10).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap());
        assert!(soup.winding.closing.is_none());
    }
}
