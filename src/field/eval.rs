//! Evaluation in batches: value, gradient and Hessian, each where wanted. Nothing here allocates or locks, but for
//! [`Field::eval_parallel`], which does so once a call.

use super::Field;
use crate::geometry::vec::text;
use crate::par::Workers;
use crate::spline::basis::Weights;
use crate::spline::kernel::Hessian;
use crate::{Error, Result};

/// Points checked, then evaluated, at a time; and the work of one item when threads share a batch.
const BLOCK: usize = 256;

/// Where the results of a batch go; `None` where one is not wanted.
#[derive(Default)]
pub struct Outputs<'a, const D: usize = 3> {
    /// phi `[n]`, in the caller's unit of length.
    pub values: Option<&'a mut [f64]>,
    /// grad phi [n x D], without unit.
    pub gradients: Option<&'a mut [[f64; D]]>,
    /// Hessian [n x 6], rows of the upper triangle xx xy xz yy yz zz; in the plane [n x 3], xx xy yy; in 1 / the caller's unit of length.
    pub hessians: Option<&'a mut [f64]>,
}

/// Numbers of a packed Hessian.
pub const fn packed<const D: usize>() -> usize {
    D * (D + 1) / 2
}

impl<'a, const D: usize> Outputs<'a, D> {
    /// The first `n` places, and the rest.
    fn split(self, n: usize) -> (Self, Self) {
        let (v, v_rest) = self.values.map(|s| s.split_at_mut(n)).unzip();
        let (g, g_rest) = self.gradients.map(|s| s.split_at_mut(n)).unzip();
        let (h, h_rest) = self.hessians.map(|s| s.split_at_mut(n * packed::<D>())).unzip();
        (
            Outputs { values: v, gradients: g, hessians: h },
            Outputs { values: v_rest, gradients: g_rest, hessians: h_rest },
        )
    }

    fn check(&self, n: usize) -> Result<()> {
        // Numbers of Hessians that make no whole one are room for none.
        let whole = |len: usize| if len.is_multiple_of(packed::<D>()) { len / packed::<D>() } else { usize::MAX };
        let lengths = [
            ("values", self.values.as_ref().map(|v| v.len())),
            ("gradients", self.gradients.as_ref().map(|g| g.len())),
            ("hessians", self.hessians.as_ref().map(|h| whole(h.len()))),
        ];
        match lengths.iter().find(|(_, len)| len.is_some_and(|len| len != n)) {
            None => Ok(()),
            Some((name, Some(usize::MAX))) => Err(Error::InvalidArgument(format!(
                "{name} has a length that is no multiple of {}; {} a point are needed",
                packed::<D>(),
                packed::<D>()
            ))),
            Some((name, len)) => Err(Error::InvalidArgument(format!(
                "{name} has room for {} points; the batch has {n}",
                len.unwrap_or(0)
            ))),
        }
    }
}

impl<const D: usize> Field<D> {
    /// Evaluates at `points` [n x D], on the caller's thread. After an error the outputs are unspecified.
    pub fn eval(&self, points: &[[f64; D]], outputs: Outputs<D>) -> Result<()> {
        outputs.check(points.len())?;
        self.eval_from(0, points, outputs)
    }

    /// [`Field::eval`] with the batch spread over `n_threads` threads, as [`Workers::new`] takes them; the same bits.
    pub fn eval_parallel(&self, points: &[[f64; D]], outputs: Outputs<D>, n_threads: u32) -> Result<()> {
        const ITEM: usize = 16 * BLOCK;
        outputs.check(points.len())?;
        Workers::check(n_threads)?;
        let workers = if points.len() <= ITEM { Workers::caller_only() } else { Workers::new(n_threads)? };
        let mut rest = outputs;
        let mut items = Vec::with_capacity(points.len().div_ceil(ITEM));
        for (i, points) in points.chunks(ITEM).enumerate() {
            let (outputs, behind) = rest.split(points.len());
            rest = behind;
            items.push((i * ITEM, points, outputs));
        }
        let first_error = std::sync::Mutex::new(None::<(usize, Error)>);
        workers.for_each(items, |(first, points, outputs)| {
            if let Err(error) = self.eval_from(first, points, outputs) {
                let mut slot = first_error.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                if slot.as_ref().is_none_or(|(at, _)| first < *at) {
                    *slot = Some((first, error));
                }
            }
        });
        match first_error.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()) {
            Some((_, error)) => Err(error),
            None => Ok(()),
        }
    }

    /// Whether each of `points` lies outside the box, where the field is continued: see [`beyond`](super::beyond).
    pub fn outside_box(&self, points: &[[f64; D]], outside: &mut [u8]) -> Result<()> {
        if outside.len() != points.len() {
            let (room, n) = (outside.len(), points.len());
            return Err(Error::InvalidArgument(format!("outside has room for {room} points; the batch has {n}")));
        }
        check_points(0, points)?;
        for (p, outside) in points.iter().zip(outside) {
            *outside = u8::from(!self.grid.holds(p));
        }
        Ok(())
    }

    /// Evaluates one part of a batch, the first point of which has index `first` in it.
    fn eval_from(&self, first: usize, points: &[[f64; D]], outputs: Outputs<D>) -> Result<()> {
        let mut rest = outputs;
        for (b, points) in points.chunks(BLOCK).enumerate() {
            check_points(first + b * BLOCK, points)?;
            let (block, behind) = rest.split(points.len());
            rest = behind;
            match block {
                Outputs { values, gradients, hessians: Some(hessians) } => {
                    self.block_with_hessian(points, values, gradients, hessians);
                }
                Outputs { values, gradients: Some(gradients), hessians: None } => {
                    self.block_with_gradient(points, values, gradients);
                }
                Outputs { values: Some(values), .. } => self.block_of_values(points, values),
                Outputs { values: None, .. } => {}
            }
        }
        Ok(())
    }

    fn block_of_values(&self, points: &[[f64; D]], values: &mut [f64]) {
        for (p, value) in points.iter().zip(values) {
            let xi = self.to_cells(*p);
            *value = if self.in_box(xi) {
                let (stencil, u) = self.grid.stencil(xi);
                stencil.value(&self.coefficients, u)
            } else {
                self.continued(xi).0
            };
        }
    }

    fn block_with_gradient(&self, points: &[[f64; D]], mut values: Option<&mut [f64]>, gradients: &mut [[f64; D]]) {
        for (i, (p, gradient)) in points.iter().zip(gradients).enumerate() {
            let xi = self.to_cells(*p);
            let value;
            (value, *gradient) = if self.in_box(xi) {
                let (stencil, u) = self.grid.stencil(xi);
                let (value, g) = stencil.value_gradient(&self.coefficients, &u.map(Weights::at));
                (value, std::array::from_fn(|a| g[a] * self.per_cell[a]))
            } else {
                let (value, gradient, _) = self.continued(xi);
                (value, gradient)
            };
            if let Some(values) = &mut values {
                values[i] = value;
            }
        }
    }

    fn block_with_hessian(
        &self,
        points: &[[f64; D]],
        mut values: Option<&mut [f64]>,
        mut gradients: Option<&mut [[f64; D]]>,
        hessians: &mut [f64],
    ) {
        let per_cell = self.per_cell;
        for (i, (p, packed)) in points.iter().zip(hessians.chunks_exact_mut(packed::<D>())).enumerate() {
            let xi = self.to_cells(*p);
            let (value, gradient, hessian) = if self.in_box(xi) {
                let (stencil, u) = self.grid.stencil(xi);
                let (value, g, h) = stencil.value_gradient_hessian(&self.coefficients, u);
                let hessian = std::array::from_fn(|a| std::array::from_fn(|b| h[a][b] * (per_cell[a] * per_cell[b])));
                (value, std::array::from_fn(|a| g[a] * per_cell[a]), hessian)
            } else {
                self.continued(xi)
            };
            pack(&hessian, packed);
            if let Some(values) = &mut values {
                values[i] = value;
            }
            if let Some(gradients) = &mut gradients {
                gradients[i] = gradient;
            }
        }
    }

    /// Coordinates in cells.
    #[inline]
    fn to_cells(&self, p: [f64; D]) -> [f64; D] {
        std::array::from_fn(|a| (p[a] - self.grid.axes[a].lower) * self.per_cell[a])
    }

    #[inline]
    fn in_box(&self, xi: [f64; D]) -> bool {
        (0..D).all(|a| xi[a] >= 0.0 && xi[a] <= self.grid.axes[a].n_cells as f64)
    }
}

/// The rows of the upper triangle.
#[inline]
fn pack<const D: usize>(hessian: &Hessian<D>, packed: &mut [f64]) {
    let upper = (0..D).flat_map(|a| (a..D).map(move |b| (a, b)));
    packed.iter_mut().zip(upper).for_each(|(p, (a, b))| *p = hessian[a][b]);
}

/// Coordinates up to this size keep every step of an evaluation in the range of doubles.
const LARGEST: f64 = 1e150;

/// Refuses points that are not finite, or too far, naming the first by its index in the batch.
pub(super) fn check_points<const D: usize>(first: usize, points: &[[f64; D]]) -> Result<()> {
    // A NaN compares as false.
    let served = |p: &[f64; D]| p.iter().all(|x| x.abs() <= LARGEST);
    match points.iter().position(|p| !served(p)) {
        None => Ok(()),
        Some(i) => {
            let (p, i) = (text(&points[i]), first + i);
            Err(Error::InvalidArgument(format!(
                "point {i} is {p}; coordinates must be finite, and at most {LARGEST:e} in size"
            )))
        }
    }
}
