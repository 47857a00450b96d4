//! Meshes of parts: the boundary of a set of cells, closed and manifold, smoothed within the cells.
//!
//! Each face between a cell that is kept and one that is not becomes a segment, or two triangles. Faces that share a hinge, a vertex in the
//! plane, an edge in space, are joined across it. Where four do, since two cells touch there and nowhere near, those of the same cell are
//! joined, and in space the edge gets a middle for each of both, so that no edge has four triangles. A vertex of the mesh is a fan of faces
//! around a vertex of the grid: cells that touch by a corner have a vertex each. So every edge has two facets and every vertex one fan, whatever
//! the cells. Then vertices are moved (`relax`), and no facet leaves the cells: what did not collide does not.

use super::bits::Bits;
use super::grid::Grid;
use super::relax::{Facets, Home, Relaxing, relax};
use crate::error::{try_reserve, try_vec, try_with_capacity};
use crate::geometry::Mesh;
use crate::geometry::vec::number;
use crate::progress::Progress;
use crate::{Error, Result};

/// Where the mesh may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Within {
    /// In the cells: meshes of parts that do not collide do not.
    Cells,
    /// About as much outside of them as inside, which keeps their volume.
    Anywhere,
}

/// How meshes are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryOptions {
    /// Where the mesh may be.
    pub within: Within,
    /// Times that each vertex is moved; with 0 the mesh is the cells' faces.
    pub rounds: usize,
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        BoundaryOptions { within: Within::Cells, rounds: 20 }
    }
}

/// A closed mesh of `cells`, within a cell of their boundary along each axis: curves in the plane, triangles in space. It is moved into a part by a
/// quarter of its thickness there at most. Where cells touch by an edge or a corner it may touch itself: formats without vertices of their own,
/// as STL, and in single precision, would weld it there. A field is fitted to what [`Mesh::sample`] draws from it.
pub fn mesh_of_cells<const D: usize>(
    grid: &Grid<D>,
    cells: &Bits,
    options: &BoundaryOptions,
    progress: &mut Progress<'_>,
) -> Result<Mesh<D>> {
    if cells.len() != grid.n_cells() {
        return Err(Error::InvalidArgument(format!(
            "a set of {} cells for a grid of {}; it must be one for each",
            cells.len(),
            grid.n_cells()
        )));
    }
    mesh(grid, cells, |_, _| 0.5, WEAK, options, progress)
}

/// The same of the cells with a density above `level`; the surface is drawn to where the density passes it.
pub fn mesh_of_densities<const D: usize>(
    grid: &Grid<D>,
    densities: &[f64],
    level: f64,
    options: &BoundaryOptions,
    progress: &mut Progress<'_>,
) -> Result<Mesh<D>> {
    if densities.len() != grid.n_cells() {
        let text = format!("{} densities for a grid of {} cells", densities.len(), grid.n_cells());
        return Err(Error::InvalidArgument(text));
    }
    if let Some((i, x)) = densities.iter().enumerate().find(|(_, x)| !(0.0..=1.0).contains(*x)) {
        return Err(Error::InvalidArgument(format!("density {i} is {}; it must be in [0, 1]", number(*x))));
    }
    if !(0.0..1.0).contains(&level) {
        return Err(Error::InvalidArgument(format!("the level is {}; it must be in [0, 1)", number(level))));
    }
    let cells = Bits::of(densities.len(), |i| densities[i] > level)?;
    let beside = |j: Option<usize>| j.map_or(0.0, |j| densities[j]);
    let part = |i: usize, j: Option<usize>| (densities[i] - level) / (densities[i] - beside(j));
    mesh(grid, &cells, part, STRONG, options, progress)
}

/// A face of a cell.
#[derive(Debug, Clone, Copy)]
struct Face {
    cell: u32,
    axis: u8,
    /// Whether it is the cell's end along the axis.
    up: bool,
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// Corners of a face.
const fn n_corners<const D: usize>() -> usize {
    1 << (D - 1)
}

impl Face {
    /// Its corners, in the grid: counter-clockwise seen from outside in space, with the cell on the left in the plane, where two count.
    fn corners<const D: usize>(&self, grid: &Grid<D>) -> [[usize; D]; 4] {
        let (mut base, a) = (grid.place(self.cell as usize), self.axis as usize);
        base[a] += usize::from(self.up);
        let (b, c) = ((a + 1) % D, (a + 2) % D);
        let at = |x: usize, y: usize| {
            let mut p = base;
            p[b] += x;
            p[c] += y;
            p
        };
        if D == 2 {
            // Up along x the way goes up along y, and down where x goes down; the other way round along y.
            let forth = self.up == (a == 0);
            let (from, to) = (at(usize::from(!forth), 0), at(usize::from(forth), 0));
            return [from, to, from, to];
        }
        if self.up { [at(0, 0), at(1, 0), at(1, 1), at(0, 1)] } else { [at(0, 0), at(0, 1), at(1, 1), at(1, 0)] }
    }
    /// Cells that are kept from the face inwards, up to `most`.
    fn thickness<const D: usize>(&self, grid: &Grid<D>, cells: &Bits, most: usize) -> usize {
        let (mut place, a, mut n) = (grid.place(self.cell as usize), self.axis as usize, 1);
        while n < most
            && let Some(j) = beside(grid, place, a, !self.up)
            && cells.has(j)
        {
            place = grid.place(j);
            n += 1;
        }
        n
    }
}

fn mesh<const D: usize>(
    grid: &Grid<D>,
    cells: &Bits,
    part: impl Fn(usize, Option<usize>) -> f64,
    pull: f64,
    options: &BoundaryOptions,
    progress: &mut Progress<'_>,
) -> Result<Mesh<D>> {
    let faces = faces(grid, cells)?;
    if faces.is_empty() {
        return Err(Error::Degenerate("the part has no cells: there is nothing to make a mesh of".into()));
    }
    let joined = Joined::new(grid, &faces)?;
    let homes = joined.homes(grid, cells, &faces, part)?;
    let mut facets = joined.facets(&faces)?;
    let mut places: Vec<[f64; D]> = try_with_capacity(homes.len(), "the mesh of a part")?;
    places.extend(homes.iter().map(|h| h.place));
    let inside = options.within == Within::Cells;
    let kept = inside.then_some((grid, cells));
    let how = Relaxing { kept, rounds: options.rounds, pull: if inside { WEAK } else { pull } };

    relax(&mut places, &homes, &mut facets, &how, progress)?;
    // As the corners of cells are made of their places, so that what is in a cell stays in it.
    let corner = grid.corner();
    places.iter_mut().for_each(|p| *p = std::array::from_fn(|a| corner[a] + grid.cell() * p[a]));
    Mesh::new(places, facets.corners)
}

/// All faces between cells that are kept and cells that are not.
fn faces<const D: usize>(grid: &Grid<D>, cells: &Bits) -> Result<Vec<Face>> {
    let mut faces = Vec::new();
    for i in cells.iter() {
        let place = grid.place(i);
        for axis in 0..D {
            for up in [false, true] {
                if beside(grid, place, axis, up).is_none_or(|j| !cells.has(j)) {
                    try_reserve(&mut faces, 1, "the faces of a part")?;
                    faces.push(Face { cell: i as u32, axis: axis as u8, up });
                }
            }
        }
    }
    // Corners of faces have numbers of 32 bits.
    if faces.len() >= 1 << 29 {
        return Err(Error::Unsupported(format!("a mesh of {} cells' faces; at most {}", faces.len(), 1 << 29)));
    }
    Ok(faces)
}

/// The cell across a face, if there is one.
fn beside<const D: usize>(grid: &Grid<D>, mut place: [usize; D], axis: usize, up: bool) -> Option<usize> {
    let last = if up { grid.counts()[axis] - 1 } else { 0 };
    if place[axis] == last {
        return None;
    }
    if up {
        place[axis] += 1
    } else {
        place[axis] -= 1
    }
    Some(grid.number(place))
}

/// Which vertices of the mesh the corners of faces are.
struct Joined {
    /// Of each face's corners `[F x 2^(D - 1)]`.
    vertices: Vec<u32>,
    /// In space: the middle of the edge from each corner to the next, where it has one.
    middles: Vec<u32>,
    n_vertices: usize,
    /// Faces at which the middles' edges are: each with its corner.
    halved: Vec<(u32, u8)>,
}

impl Joined {
    fn new<const D: usize>(grid: &Grid<D>, faces: &[Face]) -> Result<Self> {
        let n = n_corners::<D>();
        let counts = grid.counts();
        let key = |p: [usize; D]| (0..D).fold(0_u64, |k, a| k * (counts[a] as u64 + 1) + p[a] as u64);
        // Hinges: in the plane the corners, in space the edges from each corner to the next, by their lower end and axis.
        let mut hinges: Vec<(u64, u32, u8)> = try_with_capacity(faces.len() * n, "the mesh of a part")?;
        for (f, face) in faces.iter().enumerate() {
            let corners = face.corners(grid);
            for k in 0..n {
                let hinge = if D == 2 {
                    key(corners[k])
                } else {
                    let (p, q) = (corners[k], corners[(k + 1) % n]);
                    let axis = (0..D).find(|&a| p[a] != q[a]).expect("an edge");
                    key(p.min(q)) * 3 + axis as u64
                };
                hinges.push((hinge, f as u32, k as u8));
            }
        }
        hinges.sort_unstable();
        let mut sets = Sets { of: try_vec(0, 0, "")? };
        try_reserve(&mut sets.of, faces.len() * n, "the mesh of a part")?;
        sets.of.extend(0..(faces.len() * n) as u32);
        let mut halved = Vec::new();
        let slot = |f: u32, k: usize| f * n as u32 + (k % n) as u32;
        let mut join = |(_, f, k): (u64, u32, u8), (_, g, m): (u64, u32, u8)| {
            let (k, m) = (k as usize, m as usize);
            if D == 2 {
                sets.unite(slot(f, k), slot(g, m));
            } else {
                // They run along the edge in opposite directions.
                sets.unite(slot(f, k), slot(g, m + 1));
                sets.unite(slot(f, k + 1), slot(g, m));
            }
        };
        for group in hinges.chunk_by(|a, b| a.0 == b.0) {
            if let [a, b] = *group {
                join(a, b);
                continue;
            }
            // Of two cells: in the order of faces, and so of cells.
            let &[a, b, c, d] = group else { unreachable!("a hinge has two faces or four") };
            join(a, b);
            join(c, d);
            if D == 3 {
                try_reserve(&mut halved, 4, "the mesh of a part")?;
                halved.extend([a, b, c, d].map(|(_, f, k)| (f, k)));
            }
        }
        let mut vertices = try_vec(faces.len() * n, NONE, "the mesh of a part")?;
        let mut n_vertices = 0;
        for s in 0..vertices.len() {
            let root = sets.root(s as u32) as usize;
            if vertices[root] == NONE {
                vertices[root] = n_vertices;
                n_vertices += 1;
            }
            vertices[s] = vertices[root];
        }
        let mut middles = try_vec(if D == 3 { vertices.len() } else { 0 }, NONE, "the mesh of a part")?;
        for pair in halved.chunks_exact(2) {
            pair.iter().for_each(|&(f, k)| middles[slot(f, k as usize) as usize] = n_vertices);
            n_vertices += 1;
        }
        Ok(Joined { vertices, middles, n_vertices: n_vertices as usize, halved })
    }

    /// Whether a face has middles on its edges; it has one of its own then.
    fn is_fan(&self, f: usize) -> bool {
        self.middles.get(4 * f..4 * f + 4).is_some_and(|m| m.iter().any(|m| *m != NONE))
    }

    /// Where vertices begin, and where they are drawn to.
    fn homes<const D: usize>(
        &self,
        grid: &Grid<D>,
        cells: &Bits,
        faces: &[Face],
        part: impl Fn(usize, Option<usize>) -> f64,
    ) -> Result<Vec<Home<D>>> {
        let n = n_corners::<D>();
        let mut homes = try_vec(self.n_vertices, Home::default(), "the mesh of a part")?;
        let mut weights = try_vec(self.n_vertices, 0.0, "the mesh of a part")?;
        for (f, face) in faces.iter().enumerate() {
            let (corners, a) = (face.corners(grid), face.axis as usize);
            let at = corners.map(|p| p.map(|x| x as f64));
            let mut center: [f64; D] = std::array::from_fn(|b| at[..n].iter().map(|p| p[b]).sum::<f64>() / n as f64);
            // From the cell's middle to the next cell's it passes the level there.
            let i = face.cell as usize;
            let off = part(i, beside(grid, grid.place(i), a, face.up)) - 0.5;
            let flat = center;
            center[a] += if face.up { off } else { -off };
            let depth = QUARTER * face.thickness(grid, cells, MOST_CELLS) as f64;
            let mut put = |v: u32, place: [f64; D], most: f64| {
                let (home, w) = (&mut homes[v as usize], &mut weights[v as usize]);
                if *w == 0.0 {
                    *home = Home { place, aim: [0.0; D], reach: [f64::INFINITY; D] };
                }
                home.reach[a] = home.reach[a].min(depth.min(most));
                (0..D).for_each(|b| home.aim[b] += center[b]);
                *w += 1.0;
            };
            for (k, corner) in at.iter().enumerate().take(n) {
                put(self.vertices[f * n + k], *corner, f64::INFINITY);
            }
            if self.is_fan(f) {
                for k in (0..n).filter(|k| self.middles[f * n + k] != NONE) {
                    let (p, q) = (at[k], at[(k + 1) % n]);
                    put(self.middles[f * n + k], std::array::from_fn(|b| 0.5 * (p[b] + q[b])), QUARTER);
                }
                try_reserve(&mut homes, 1, "the mesh of a part")?;
                try_reserve(&mut weights, 1, "the mesh of a part")?;
                homes.push(Home { place: flat, aim: center, reach: [QUARTER; D] });
                weights.push(1.0);
            }
        }
        for (home, w) in homes.iter_mut().zip(weights) {
            home.aim = home.aim.map(|x| x / w);
            // Along the surface they need go less far.
            home.reach = home.reach.map(|x| if x.is_finite() { x } else { ALONG });
        }
        Ok(homes)
    }

    /// The facets, each with the axis that it looks along.
    fn facets<const D: usize>(&self, faces: &[Face]) -> Result<Facets<D>> {
        let n = n_corners::<D>();
        let most = (D - 1) * faces.len() + 6 * self.halved.len();
        let mut facets = Facets {
            corners: try_with_capacity(most, "the mesh of a part")?,
            looks: try_with_capacity(most, "the mesh of a part")?,
        };
        let mut center = self.n_vertices as u32;
        for (f, face) in faces.iter().enumerate() {
            let v = &self.vertices[f * n..(f + 1) * n];
            let mut put = |corners: [u32; 3]| {
                facets.corners.push(std::array::from_fn(|k| corners[k]));
                facets.looks.push((face.axis, face.up));
            };
            if D == 2 {
                put([v[0], v[1], 0]);
            } else if self.is_fan(f) {
                for k in 0..n {
                    let (from, middle, to) = (v[k], self.middles[f * n + k], v[(k + 1) % n]);
                    if middle == NONE {
                        put([from, to, center]);
                    } else {
                        put([from, middle, center]);
                        put([middle, to, center]);
                    }
                }
                center += 1;
            } else {
                put([v[0], v[1], v[2]]);
                put([v[0], v[2], v[3]]);
            }
        }
        Ok(facets)
    }
}

/// How much vertices are drawn to where faces pass the level: where only cells tell that, it is not known to half a cell.
const WEAK: f64 = 0.01;

/// The same of densities, which tell more.
const STRONG: f64 = 0.1;

/// Vertices go at most this part of a part's thickness into it, from either side, so that half of it stays.
const QUARTER: f64 = 0.25;

/// Cells that a thickness is counted up to: vertices go as far as this at most.
const MOST_CELLS: usize = 4;

/// How far vertices go along axes that none of their faces looks along.
const ALONG: f64 = 0.45;

/// Sets that are united, by the root of each member's tree.
struct Sets {
    of: Vec<u32>,
}

impl Sets {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.of[i as usize] != i {
            // Half the way is cut off each time.
            let next = self.of[self.of[i as usize] as usize];
            self.of[i as usize] = next;
            i = next;
        }
        i
    }

    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.of[a.max(b) as usize] = a.min(b);
    }
}
