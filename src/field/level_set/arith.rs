//! Arithmetic of `[f64; D]`, and the normal of a facet.

/// a - b
pub(super) fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// a + s b
pub(super) fn along<const D: usize>(a: [f64; D], s: f64, b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] + s * b[i])
}

/// a . b
pub(super) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|i| a[i] * b[i]).sum()
}

/// |a|
pub(super) fn norm<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

/// a / |a|, or zero where |a| is 0 or not finite.
pub(super) fn unit<const D: usize>(a: [f64; D]) -> [f64; D] {
    let n = norm(a);
    if n > 0.0 && n.is_finite() { a.map(|x| x / n) } else { [0.0; D] }
}

/// The normal of a facet: of a segment to its right, as long as it; of a triangle to the side from which it runs counter-clockwise, twice
/// its area long.
pub(super) fn facet_normal<const D: usize>(corners: [[f64; D]; D]) -> [f64; D] {
    let mut n = [0.0; D];
    match D {
        2 => {
            let e = sub(corners[1], corners[0]);
            (n[0], n[1]) = (e[1], -e[0]);
        }
        3 => {
            let (e, f) = (sub(corners[1], corners[0]), sub(corners[2], corners[0]));
            (n[0], n[1]) = (e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2]);
            n[2] = e[0] * f[1] - e[1] * f[0];
        }
        _ => unreachable!("facets are segments or triangles"),
    }
    n
}
