//! From phi and psi to the derivatives by points and normals.

use super::Derivatives;
use super::form::Form;
use crate::Result;
use crate::error::{try_vec, try_with_capacity};
use crate::field::Field;
use crate::field::data::Mass;
use crate::field::eval::{Outputs, packed};
use crate::field::held::Hold;
use crate::geometry::Cloud;
use crate::geometry::vec::{add, dot, norm, scale, sub};
use crate::par::Workers;

/// Points, and cells, that are evaluated at a time.
const BLOCK: usize = 256;

/// What the memory is for, should it run out.
const WHAT: &str = "the points of a sensitivity";

/// The points of the cloud that count, and the distances held from them.
pub(super) struct Chain<const D: usize> {
    /// s
    sign: f64,
    /// p and n [N x D], by number, in the caller's unit of length.
    points: Vec<[f64; D]>,
    normals: Vec<[f64; D]>,
    /// m_v and lambda_n m_n `[N]`.
    forces: Vec<Mass>,
    /// x of each cell in which a distance is held, in the caller's unit of length [cells x D].
    middles: Vec<[f64; D]>,
    /// s M sign(d) (q - x) / |q - x| [cells x D], and the number of q `[cells]`.
    pulls: Vec<[f64; D]>,
    nearest: Vec<u32>,
}

impl<const D: usize> Chain<D> {
    /// For `cloud`, all of whose points count.
    pub fn new(field: &Field<D>, cloud: &Cloud<D>, form: &Form<D>) -> Result<Self> {
        let copy = |from: &[[f64; D]]| {
            let mut to = try_with_capacity(from.len(), WHAT)?;
            to.extend_from_slice(from);
            Ok(to)
        };
        let holds = form.holds()?;
        let room = || try_vec(holds.len(), [0.0; D], WHAT);
        let mut chain = Chain {
            sign: field.feasible().sign(),
            points: copy(cloud.points())?,
            normals: copy(cloud.normals())?,
            forces: form.forces()?,
            middles: room()?,
            pulls: room()?,
            nearest: try_vec(holds.len(), 0, WHAT)?,
        };
        chain.pull_cells(field, &holds);
        Ok(chain)
    }

    /// Fills in what belongs to the cells in which distances are held.
    fn pull_cells(&mut self, field: &Field<D>, holds: &[Hold<D>]) {
        let (grid, d) = (&field.grid, field.diagonal);
        for (i, Hold { middle, mass, point }) in holds.iter().enumerate() {
            let x = std::array::from_fn(|a| grid.axes[a].lower + d * middle[a]);
            let to_q = sub(self.points[*point as usize], x);
            self.pulls[i] = scale(self.sign * mass / norm(to_q), to_q);
            (self.middles[i], self.nearest[i]) = (x, *point);
        }
    }

    /// The derivatives, from phi of `field` and `psi`, a field of the control points lambda; of the points that count, by number.
    pub fn pull(&self, field: &Field<D>, psi: &Field<D>, workers: &Workers, to: &mut Derivatives<D>) -> Result<()> {
        // Where one is not wanted all its blocks are empty.
        let mut points = to.points.as_deref_mut().unwrap_or_default().chunks_mut(BLOCK);
        let mut normals = to.normals.as_deref_mut().unwrap_or_default().chunks_mut(BLOCK);
        let items = (0..self.points.len()).step_by(BLOCK).map(|first| {
            let to = [points.next(), normals.next()].map(Option::unwrap_or_default);
            (first, to)
        });
        workers.try_for_each(items, |(first, to)| self.pull_block(field, psi, first, to))?;
        match &mut to.points {
            Some(points) => self.add_distances(psi, workers, points),
            None => Ok(()),
        }
    }

    /// The derivatives of a block by the points from number `first` on, and by their normals, but for what distances add.
    fn pull_block(&self, field: &Field<D>, psi: &Field<D>, first: usize, to: [&mut [[f64; D]]; 2]) -> Result<()> {
        let points = &self.points[first..(first + BLOCK).min(self.points.len())];
        let (of_phi, of_psi) = (Jets::of(field, points)?, Jets::of(psi, points)?);
        let square = field.diagonal * field.diagonal;
        for k in 0..points.len() {
            let ((phi, grad_phi), (psi, grad_psi)) = (of_phi.at(k), of_psi.at(k));
            let (normal, Mass { value, gradient }) = (self.normals[first + k], self.forces[first + k]);
            // Gradients are by the caller's unit of length, and those of psi, which has none, want D.
            let pull = gradient * square;
            if let Some(to) = to[0].get_mut(k) {
                let by_values = add(scale(phi, grad_psi), scale(psi, grad_phi));
                let miss = sub(grad_phi, scale(self.sign, normal));
                let by_gradients = add(of_phi.hessian_times(k, grad_psi), of_psi.hessian_times(k, miss));
                *to = sub(scale(-value, by_values), scale(pull, by_gradients));
            }
            if let Some(to) = to[1].get_mut(k) {
                *to = scale(pull * self.sign, sub(grad_psi, scale(dot(grad_psi, normal), normal)));
            }
        }
        Ok(())
    }

    /// Adds what the distances held do.
    fn add_distances(&self, psi: &Field<D>, workers: &Workers, to: &mut [[f64; D]]) -> Result<()> {
        let mut values = try_vec(self.middles.len(), 0.0, WHAT)?;
        workers.try_for_each(values.chunks_mut(BLOCK).zip(self.middles.chunks(BLOCK)), |(values, middles)| {
            psi.eval(middles, Outputs { values: Some(values), ..Outputs::default() })
        })?;
        // One after the other: many cells have one nearest point.
        for ((value, pull), i) in values.iter().zip(&self.pulls).zip(&self.nearest) {
            let to = &mut to[*i as usize];
            *to = add(*to, scale(*value, *pull));
        }
        Ok(())
    }
}

/// Values, gradients and Hessians at the points of a block.
struct Jets<const D: usize> {
    values: [f64; BLOCK],
    gradients: [[f64; D]; BLOCK],
    hessians: [f64; 6 * BLOCK],
}

impl<const D: usize> Jets<D> {
    fn of(field: &Field<D>, points: &[[f64; D]]) -> Result<Self> {
        let mut jets = Jets { values: [0.0; BLOCK], gradients: [[0.0; D]; BLOCK], hessians: [0.0; 6 * BLOCK] };
        let n = points.len();
        let outputs = Outputs {
            values: Some(&mut jets.values[..n]),
            gradients: Some(&mut jets.gradients[..n]),
            hessians: Some(&mut jets.hessians[..n * packed::<D>()]),
        };
        field.eval(points, outputs)?;
        Ok(jets)
    }

    /// Value and gradient at point `k`.
    fn at(&self, k: usize) -> (f64, [f64; D]) {
        (self.values[k], self.gradients[k])
    }

    /// The Hessian at point `k` times `v`.
    fn hessian_times(&self, k: usize, v: [f64; D]) -> [f64; D] {
        let h = &self.hessians[k * packed::<D>()..][..packed::<D>()];
        let mut product = [0.0; D];
        let mut entries = h.iter();
        for a in 0..D {
            for b in a..D {
                let Some(h) = entries.next() else { return product };
                product[a] += h * v[b];
                if a != b {
                    product[b] += h * v[a];
                }
            }
        }
        product
    }
}
