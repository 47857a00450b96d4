//! Evaluation of fields that are too large for the caches: in an order that keeps to the same control points, group by group, so that memory
//! is waited for while the group before is summed. The same bits as in any other order.

use super::Field;
use super::eval::{ControlPoints, Outputs, check_points, evaluate, packed};
use super::order::{self, Order};
use crate::Result;
use crate::isa::{self, Isa};

/// Points of which the control points are asked for while those before are evaluated, where the field is large.
const GROUP: usize = 16;

/// The points of a batch of a large field, the first of which has index `first` in it.
#[inline(always)]
pub(super) fn by_groups<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    (first, points): (usize, &[[f64; D]]),
    mut order: Option<Order>,
    outputs: Outputs<D>,
) -> Result<()> {
    let mut rest = outputs;
    for (c, points) in points.chunks(order::MOST).enumerate() {
        let (outputs, behind) = rest.split(points.len());
        rest = behind;
        let batch = (first + c * order::MOST, points);
        match order.as_mut().and_then(|order| order.of(&field.cells, points)) {
            Some(order) => in_order::<I, C, D>(field, control_points, batch, order, outputs)?,
            None => as_they_come::<I, C, D>(field, control_points, batch, outputs)?,
        }
    }
    Ok(())
}

/// Group by group: while one is evaluated, the control points of the next are asked for.
#[inline(always)]
fn as_they_come<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    (first, points): (usize, &[[f64; D]]),
    outputs: Outputs<D>,
) -> Result<()> {
    let mut rest = outputs;
    for (g, group) in points.chunks(GROUP).enumerate() {
        check_points(first + g * GROUP, group)?;
        let behind = &points[((g + 1) * GROUP).min(points.len())..];
        prefetch::<I, C, D>(field, control_points, &behind[..GROUP.min(behind.len())]);
        let (outputs, behind) = rest.split(group.len());
        rest = behind;
        evaluate::<I, C, D>(field, control_points, group, outputs);
    }
    Ok(())
}

/// The same in `order`, where the points of the group after the next are asked for too, and the places of the outputs.
#[inline(always)]
fn in_order<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    (first, points): (usize, &[[f64; D]]),
    order: &[u32],
    mut outputs: Outputs<D>,
) -> Result<()> {
    check_points(first, points)?;
    let group = |g: usize| &order[(g * GROUP).min(order.len())..((g + 1) * GROUP).min(order.len())];
    let gather = |g: usize, to: &mut [[f64; D]; GROUP], outputs: &Outputs<D>| {
        let places = group(g);
        to.iter_mut().zip(places).for_each(|(to, &i)| *to = points[i as usize]);
        prefetch::<I, C, D>(field, control_points, &to[..places.len()]);
        group(g + 1).iter().for_each(|&i| prefetch_ends(&points[i as usize]));
        places.iter().for_each(|&i| prefetch_places(outputs, i as usize));
    };
    let mut groups = [[[0.0; D]; GROUP]; 2];
    let mut given = Given::<D>::NOTHING;
    gather(0, &mut groups[0], &outputs);
    for g in 0..points.len().div_ceil(GROUP) {
        let [this, next] = if g % 2 == 0 { [0, 1] } else { [1, 0] };
        gather(g + 1, &mut groups[next], &outputs);
        let places = group(g);
        let room = given.outputs(&outputs, places.len());
        evaluate::<I, C, D>(field, control_points, &groups[this][..places.len()], room);
        given.copy(places.iter().map(|&i| i as usize), &mut outputs);
    }
    Ok(())
}

/// What the points of a group are given.
struct Given<const D: usize> {
    values: [f64; GROUP],
    gradients: [[f64; D]; GROUP],
    hessians: [f64; 6 * GROUP],
}

impl<const D: usize> Given<D> {
    const NOTHING: Self = Given { values: [0.0; GROUP], gradients: [[0.0; D]; GROUP], hessians: [0.0; 6 * GROUP] };

    /// Room for `n` points, for what `wanted` has room for.
    #[inline(always)]
    fn outputs(&mut self, wanted: &Outputs<D>, n: usize) -> Outputs<'_, D> {
        Outputs {
            values: wanted.values.is_some().then_some(&mut self.values[..n]),
            gradients: wanted.gradients.is_some().then_some(&mut self.gradients[..n]),
            hessians: wanted.hessians.is_some().then_some(&mut self.hessians[..n * packed::<D>()]),
        }
    }

    /// Takes it to `places` of a batch's outputs.
    #[inline(always)]
    fn copy(&self, places: impl Iterator<Item = usize> + Clone, to: &mut Outputs<D>) {
        if let Some(values) = &mut to.values {
            places.clone().zip(self.values).for_each(|(i, value)| values[i] = value);
        }
        if let Some(gradients) = &mut to.gradients {
            places.clone().zip(self.gradients).for_each(|(i, gradient)| gradients[i] = gradient);
        }
        if let Some(hessians) = &mut to.hessians {
            let n = packed::<D>();
            places
                .zip(self.hessians.chunks_exact(n))
                .for_each(|(i, hessian)| hessians[i * n..(i + 1) * n].copy_from_slice(hessian));
        }
    }
}

/// Asks for a few numbers in a row, which may lie in two lines of the cache.
#[inline(always)]
fn prefetch_ends(numbers: &[f64]) {
    if let [first, .., last] = numbers {
        isa::prefetch(first);
        isa::prefetch(last);
    }
}

/// Asks for the control points that `points` take.
#[inline(always)]
fn prefetch<'a, I: Isa, C: ControlPoints<'a, D>, const D: usize>(
    field: &Field<D>,
    control_points: C,
    points: &[[f64; D]],
) {
    for p in points {
        let xi = field.cells.coordinates(p);
        // Not yet checked: of a NaN this is false too.
        if field.cells.contain(&xi) {
            let place = control_points.place::<I>(&xi);
            place.stencil.prefetch(place.control_points);
        }
    }
}

/// Asks for the places of point `i` in a batch's outputs.
#[inline(always)]
fn prefetch_places<const D: usize>(outputs: &Outputs<D>, i: usize) {
    if let Some(values) = &outputs.values {
        isa::prefetch(&values[i]);
    }
    if let Some(gradients) = &outputs.gradients {
        prefetch_ends(&gradients[i]);
    }
    if let Some(hessians) = &outputs.hessians {
        prefetch_ends(&hessians[i * packed::<D>()..(i + 1) * packed::<D>()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Feasible;
    use crate::geometry::random::SplitMix64;
    use crate::spline::{Axis, Grid};

    /// Values, gradients and Hessians.
    type All<const D: usize> = (Vec<f64>, Vec<[f64; D]>, Vec<f64>);

    fn room<const D: usize>(n: usize) -> All<D> {
        (vec![0.0; n], vec![[0.0; D]; n], vec![0.0; n * packed::<D>()])
    }

    fn outputs<const D: usize>((v, g, h): &mut All<D>) -> Outputs<'_, D> {
        Outputs { values: Some(v), gradients: Some(g), hessians: Some(h) }
    }

    /// Batches of a large field at random points, some of them outside the box, against one point at a time.
    fn order_changes_no_bit<const D: usize>(n_cells: [usize; D]) {
        let mut random = SplitMix64::new(11);
        let grid = Grid { axes: n_cells.map(|n_cells| Axis { lower: -1.0, cell: 0.25, n_cells }) };
        let c: Vec<f64> = (0..grid.n_control()).map(|_| random.between(-1.0, 1.0)).collect();
        let field = Field::from_control_points(grid, c, Feasible::Outside, 1.0).unwrap();
        assert!(field.is_large());
        let n = 20_000;
        let mut points: Vec<[f64; D]> = (0..n)
            .map(|_| std::array::from_fn(|a| -1.0 + 0.25 * random.between(-0.5, n_cells[a] as f64 + 0.5)))
            .collect();
        assert!(Order::with_room(n, field.n_held()).unwrap().of(&field.cells, &points).is_some());
        let mut alone = room::<D>(n);
        for (i, point) in points.iter().enumerate() {
            let mut one = room::<D>(1);
            field.eval(std::slice::from_ref(point), outputs(&mut one)).unwrap();
            (alone.0[i], alone.1[i]) = (one.0[0], one.1[0]);
            alone.2[i * packed::<D>()..(i + 1) * packed::<D>()].copy_from_slice(&one.2);
        }
        let mut together = room::<D>(n);
        field.eval(&points, outputs(&mut together)).unwrap();
        assert!(together == alone);
        let mut on_threads = room::<D>(n);
        field.eval_parallel(&points, outputs(&mut on_threads), 3).unwrap();
        assert!(on_threads == alone);
        let mut gradients = vec![[0.0; D]; n];
        field.eval(&points, Outputs { gradients: Some(&mut gradients), ..Outputs::default() }).unwrap();
        assert!(gradients == alone.1);
        points[17_000][D - 1] = f64::NAN;
        let error = field.eval(&points, outputs(&mut together)).unwrap_err().to_string();
        assert!(error.contains("point 17000 is"), "{error}");
    }

    #[test]
    fn order_changes_no_bit_in_space_and_in_the_plane() {
        order_changes_no_bit([90, 120, 100]);
        order_changes_no_bit([1000, 1100]);
    }
}
