//! Closest points by parry3d-f64 and cubics by interpn, at the points that `benches/run scale peers` wrote into the folder named on the
//! command line: one round of times as `key = value unit`, and the values found, as files in that folder.

#![forbid(unsafe_code)]

mod files;

use std::error::Error;
use std::time::Instant;

use files::Folder;
use interpn::{MultiBsplineRegular, MulticubicRegular};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// So often a work of milliseconds runs in one round; the least time counts.
const REPEATS: usize = 10;

/// What the points are called, in keys and file names.
const PLACES: [&str; 3] = ["uniform", "near", "surface"];

/// As many nodes as the field has control points, and the box of its cells.
struct Grid {
    counts: [usize; 3],
    lower: [f64; 3],
    upper: [f64; 3],
}

impl Grid {
    fn read(folder: &Folder) -> Outcome<Grid> {
        let triple =
            |name| -> Outcome<[f64; 3]> { Ok(folder.read(name)?.try_into().map_err(|_| "expected 3 numbers")?) };
        Ok(Grid { counts: triple("counts")?.map(|n| n as usize), lower: triple("lower")?, upper: triple("upper")? })
    }

    /// The edges of a cell, where `fewer` cells than nodes fill the box.
    fn steps(&self, fewer: usize) -> [f64; 3] {
        std::array::from_fn(|a| (self.upper[a] - self.lower[a]) / (self.counts[a] - fewer) as f64)
    }

    /// Nodes on the box's faces too: an interpolant knows nothing beyond.
    fn cubic<'a>(&self, values: &'a [f64]) -> Outcome<MulticubicRegular<'a, f64, 3>> {
        Ok(MulticubicRegular::new(self.counts, self.lower, self.steps(1), values, false)?)
    }

    /// The field's own function: its splines are centred on nodes that begin a cell before the box.
    fn bspline<'a>(&self, control_points: &'a [f64]) -> Outcome<MultiBsplineRegular<'a, f64, 3>> {
        let steps = self.steps(3);
        let starts = std::array::from_fn(|a| self.lower[a] - steps[a]);
        Ok(MultiBsplineRegular::new(self.counts, starts, steps, control_points, false)?)
    }
}

/// Points one behind the other for parry, axis by axis for interpn, as each wants them: nobody is timed putting them in order.
struct Points {
    place: &'static str,
    one_by_one: Vec<Vector>,
    by_axis: [Vec<f64>; 3],
}

impl Points {
    fn read(folder: &Folder, place: &'static str) -> Outcome<Points> {
        let numbers = folder.read(place)?;
        let one_by_one = numbers.chunks_exact(3).map(|p| Vector::new(p[0], p[1], p[2])).collect();
        let by_axis = std::array::from_fn(|a| numbers.iter().skip(a).step_by(3).copied().collect());
        Ok(Points { place, one_by_one, by_axis })
    }

    fn axes(&self) -> [&[f64]; 3] {
        self.by_axis.each_ref().map(Vec::as_slice)
    }

    /// Prints the least nanoseconds a point of `work` over `repeats`.
    fn print_time(&self, what: &str, repeats: usize, mut work: impl FnMut() -> Outcome<()>) -> Outcome<()> {
        let mut least = f64::INFINITY;
        for _ in 0..repeats {
            let start = Instant::now();
            work()?;
            least = least.min(start.elapsed().as_secs_f64());
        }
        println!("peers_{}_{what} = {} ns/point", self.place, least * 1e9 / self.one_by_one.len() as f64);
        Ok(())
    }
}

/// Side by the normals of the faces, edges and vertices that are closest; from an exact kernel's side it may differ beside sharp edges.
fn parry((folder, points): (&Folder, &Points), mesh: &TriMesh) -> Outcome<()> {
    let mut distances = vec![0.0; points.one_by_one.len()];
    points.print_time("parry_signed_distance", 1, || {
        for (distance, &point) in distances.iter_mut().zip(&points.one_by_one) {
            let projection = mesh.project_local_point(point, false);
            let length = point.distance(projection.point);
            *distance = if projection.is_inside { -length } else { length };
        }
        Ok(())
    })?;
    folder.write(&format!("{}_parry", points.place), &distances)
}

/// Values, and values with gradients, which take two calls.
fn interpn(
    (folder, points): (&Folder, &Points),
    name: &str,
    values: impl Fn(&[&[f64]; 3], &mut [f64]) -> Result<(), &'static str>,
    gradients: impl Fn(&[&[f64]; 3], &mut [&mut [f64]; 3]) -> Result<(), &'static str>,
) -> Outcome<()> {
    let n = points.one_by_one.len();
    let mut found = vec![0.0; n];
    points.print_time(&format!("{name}_value"), REPEATS, || Ok(values(&points.axes(), &mut found)?))?;
    folder.write(&format!("{}_{name}", points.place), &found)?;
    let [mut dx, mut dy, mut dz] = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    points.print_time(&format!("{name}_value_and_gradient"), REPEATS, || {
        values(&points.axes(), &mut found)?;
        Ok(gradients(&points.axes(), &mut [&mut dx, &mut dy, &mut dz])?)
    })
}

/// What this program was built for, of the instructions that matter here.
fn instructions() -> String {
    let known = [
        (cfg!(target_feature = "avx2"), " AVX2"),
        (cfg!(target_feature = "avx512f"), " AVX-512"),
        (cfg!(all(target_feature = "fma", feature = "fma")), " FMA"),
    ];
    known.iter().filter(|(has, _)| *has).map(|(_, name)| *name).collect()
}

fn main() -> Outcome<()> {
    let folder = Folder::new(std::env::args_os().nth(1).ok_or("usage: keepout_bench_peers FOLDER")?);
    for (key, name) in [("parry", "parry3d-f64"), ("interpn", "interpn")] {
        println!("peers_{key}_version = {name} {}", files::locked_version(name)?);
    }
    println!("peers_crates_instructions ={}", instructions());
    let vertices = folder.read("vertices")?.chunks_exact(3).map(|v| Vector::new(v[0], v[1], v[2])).collect();
    let triangles =
        folder.read("triangles")?.chunks_exact(3).map(|t| [t[0] as u32, t[1] as u32, t[2] as u32]).collect();
    let mesh = TriMesh::with_flags(vertices, triangles, TriMeshFlags::ORIENTED)?;
    let grid = Grid::read(&folder)?;
    let (control_points, phi, exact) =
        (folder.read("control_points")?, folder.read("grid_phi")?, folder.read("grid_exact")?);
    let bspline = grid.bspline(&control_points)?;
    for place in PLACES {
        let points = Points::read(&folder, place)?;
        let here = (&folder, &points);
        parry(here, &mesh)?;
        interpn(here, "interpn_bspline", |x, out| bspline.interp(x, out), |x, out| bspline.interp_grad(x, out))?;
        for (name, values) in [("interpn_cubic_of_phi", &phi), ("interpn_cubic_of_distances", &exact)] {
            let cubic = grid.cubic(values)?;
            interpn(here, name, |x, out| cubic.interp(x, out), |x, out| cubic.interp_grad(x, out))?;
        }
    }
    Ok(())
}
