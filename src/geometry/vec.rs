//! Arithmetic of `[f64; D]`: points and vectors of the plane and of space.

/// A point or vector in space.
pub type Vec3 = [f64; 3];

/// a + b
#[inline]
pub fn add<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// a - b
#[inline]
pub fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// s a
#[inline]
pub fn scale<const D: usize>(s: f64, a: [f64; D]) -> [f64; D] {
    a.map(|x| s * x)
}

/// a . b
#[inline]
pub fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (1..D).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

/// a x b
#[inline]
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// |a|
#[inline]
pub fn norm<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

/// a / |a|, or `None` when |a| is 0 or not finite.
pub fn normalized<const D: usize>(a: [f64; D]) -> Option<[f64; D]> {
    // Scaled first by the largest entry, so that squares neither overflow nor vanish.
    let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if !(largest > 0.0 && is_finite(&a)) {
        return None;
    }
    let b = a.map(|x| x / largest);
    let n = norm(b);
    Some(b.map(|x| x / n))
}

/// Whether every coordinate is finite.
#[inline]
pub fn is_finite(a: &[f64]) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// The vector as people write it: (1, 2, 3).
pub fn text(a: &[f64]) -> String {
    let numbers: Vec<String> = a.iter().map(|x| number(*x)).collect();
    format!("({})", numbers.join(", "))
}

/// The number as people write it, with an exponent where there would be many zeros.
pub fn number(x: f64) -> String {
    if x == 0.0 || (1e-5..1e16).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}
