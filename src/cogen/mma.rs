//! The method of moving asymptotes: Svanberg 1987, with the rules and the elastic variables of his notes of 2007.
//!
//!   minimise f_0(x) + sum of (c y_i + y_i^2 / 2)  over x in [0, 1]^n, y >= 0,  with f_i(x) <= y_i, i = 1 .. m
//!
//! About the iterate x, with asymptotes l < x < u, each f is replaced by r + sum of p_j / (u_j - x_j) + q_j / (x_j - l_j), which has its value
//! and gradient there and is convex and separable. Given multipliers lambda >= 0, the best x and y are known in closed form,
//!
//!   x_j = (l_j sqrt(p_j) + u_j sqrt(q_j)) / (sqrt(p_j) + sqrt(q_j)), within [alpha_j, beta_j],   y_i = max(0, lambda_i - c),
//!
//! p = p_0 + sum of lambda_i p_i, q likewise, so that what is left is to maximise a concave function of m numbers: Newton's method, projected.

use crate::Result;
use crate::error::try_vec;
use crate::par::Workers;

/// Variables that a thread takes at a time.
const CHUNK: usize = 8192;

/// Asymptotes at first, as they come nearer and go farther, and their bounds, as fractions of a variable's range; how much of the way to an
/// asymptote x may go; how far x may go at once. Svanberg's.
const FIRST: f64 = 0.5;
const NEARER: f64 = 0.7;
const FARTHER: f64 = 1.2;
const NEAREST: f64 = 0.01;
const FARTHEST: f64 = 10.0;
const STAY_OFF: f64 = 0.1;
const MOVE: f64 = 0.5;

/// What derivatives' parts are raised by, as a fraction of their mean size.
const FLOOR: f64 = 1e-5;

/// c, the price of what constraints are exceeded by.
const PRICE: f64 = 1000.0;

/// Values of m constraints, and derivatives of them and of the objective.
#[derive(Debug)]
pub struct Problem<'a, const M: usize> {
    /// df_0/dx `[n]`
    pub objective: &'a [f64],
    /// f_i
    pub values: [f64; M],
    /// df_i/dx `[n]`
    pub gradients: [&'a [f64]; M],
}

/// Asymptotes, and what they follow from.
#[derive(Debug)]
pub struct Mma<const M: usize> {
    low: Vec<f64>,
    high: Vec<f64>,
    /// The iterates before the present one.
    last: Vec<f64>,
    before_last: Vec<f64>,
    n_steps: usize,
    /// The multipliers, from which the next dual begins.
    lambda: [f64; M],
    /// The approximation, by variables.
    terms: Vec<Term<M>>,
}

/// One variable's part of all f_i, and of the bounds.
#[derive(Debug, Clone, Copy)]
struct Term<const M: usize> {
    x: f64,
    low: f64,
    high: f64,
    alpha: f64,
    beta: f64,
    p0: f64,
    q0: f64,
    p: [f64; M],
    q: [f64; M],
}

/// The dual function, less what does not depend on x; its gradient and minus its Hessian, likewise.
#[derive(Clone, Copy)]
struct Dual<const M: usize> {
    value: f64,
    gradient: [f64; M],
    curvature: [[f64; M]; M],
}

impl<const M: usize> Mma<M> {
    /// For `n` variables.
    pub fn new(n: usize) -> Result<Self> {
        let zeros = || try_vec(n, 0.0, "moving asymptotes");
        Ok(Mma {
            low: zeros()?,
            high: zeros()?,
            last: zeros()?,
            before_last: zeros()?,
            n_steps: 0,
            lambda: [1.0; M],
            terms: try_vec(n, Term::NONE, "moving asymptotes")?,
        })
    }

    /// Takes `x` to the next iterate.
    pub fn step(&mut self, x: &mut [f64], problem: &Problem<'_, M>, workers: &Workers) {
        self.move_asymptotes(x);
        self.approximate(x, problem, workers);
        // r_i = f_i - sum of p / (u - x) + q / (x - l), at x.
        let at_x = self.sum(workers, |term, sum: &mut [f64; M]| {
            for (i, sum) in sum.iter_mut().enumerate() {
                *sum += term.p[i] / (term.high - term.x) + term.q[i] / (term.x - term.low);
            }
        });
        let r = std::array::from_fn(|i| problem.values[i] - at_x[i]);
        self.lambda = self.maximise_dual(&r, workers);
        std::mem::swap(&mut self.before_last, &mut self.last);
        self.last.copy_from_slice(x);
        let (terms, lambda) = (&self.terms, &self.lambda);
        workers.for_each(x.chunks_mut(CHUNK).zip(terms.chunks(CHUNK)), |(x, terms)| {
            x.iter_mut().zip(terms).for_each(|(x, term)| *x = term.best(lambda).0);
        });
        self.n_steps += 1;
    }

    /// Nearer where x goes to and fro, farther where it goes on.
    fn move_asymptotes(&mut self, x: &[f64]) {
        for (j, &x) in x.iter().enumerate() {
            let (mut low, mut high) = (x - FIRST, x + FIRST);
            if self.n_steps >= 2 {
                let turned = (x - self.last[j]) * (self.last[j] - self.before_last[j]);
                let factor = if turned < 0.0 {
                    NEARER
                } else if turned > 0.0 {
                    FARTHER
                } else {
                    1.0
                };
                low = (x - factor * (self.last[j] - self.low[j])).clamp(x - FARTHEST, x - NEAREST);
                high = (x + factor * (self.high[j] - self.last[j])).clamp(x + NEAREST, x + FARTHEST);
            }
            (self.low[j], self.high[j]) = (low, high);
        }
    }

    /// p and q of all functions, and how far variables may go.
    fn approximate(&mut self, x: &[f64], problem: &Problem<'_, M>, workers: &Workers) {
        // Svanberg adds 1e-5 to derivatives of the size 1.
        let floor = |d: &[f64]| FLOOR * d.iter().map(|d| d.abs()).sum::<f64>() / d.len().max(1) as f64;
        let floors = (floor(problem.objective), problem.gradients.map(floor));
        let Mma { low, high, terms, .. } = self;
        workers.for_each(terms.chunks_mut(CHUNK).enumerate(), |(chunk, terms)| {
            for (k, term) in terms.iter_mut().enumerate() {
                let j = chunk * CHUNK + k;
                let (x, low, high) = (x[j], low[j], high[j]);
                let (up, down) = ((high - x) * (high - x), (x - low) * (x - low));
                // A little of both, which keeps the approximation strictly convex.
                let split = |d: f64, floor: f64| {
                    let (plus, minus) = (d.max(0.0), (-d).max(0.0));
                    let more = 1e-3 * (plus + minus) + floor;
                    ((plus + more) * up, (minus + more) * down)
                };
                let (p0, q0) = split(problem.objective[j], floors.0);
                let (mut p, mut q) = ([0.0; M], [0.0; M]);
                for i in 0..M {
                    (p[i], q[i]) = split(problem.gradients[i][j], floors.1[i]);
                }
                let alpha = (low + STAY_OFF * (x - low)).max(x - MOVE).max(0.0);
                let beta = (high - STAY_OFF * (high - x)).min(x + MOVE).min(1.0);
                *term = Term { x, low, high, alpha, beta, p0, q0, p, q };
            }
        });
    }

    /// What `add` sums up over all variables, in an order that does not depend on the number of threads.
    fn sum<S: Summand>(&self, workers: &Workers, add: impl Fn(&Term<M>, &mut S) + Sync) -> S {
        let sums = workers.map(self.terms.len().div_ceil(CHUNK), |k| {
            let mut sum = S::ZERO;
            self.terms[k * CHUNK..].iter().take(CHUNK).for_each(|term| add(term, &mut sum));
            sum
        });
        sums.iter().fold(S::ZERO, |total, sum| total.plus(sum))
    }

    /// The dual at lambda, with the constants `r` of the constraints and what they may be exceeded by.
    fn dual(&self, lambda: &[f64; M], r: &[f64; M], workers: &Workers) -> Dual<M> {
        let mut dual: Dual<M> = self.sum(workers, |term, sum: &mut Dual<M>| term.add_to(lambda, sum));
        for i in 0..M {
            let over = (lambda[i] - PRICE).max(0.0);
            dual.value += lambda[i] * r[i] - 0.5 * over * over;
            dual.gradient[i] += r[i] - over;
            dual.curvature[i][i] += f64::from(u8::from(over > 0.0));
        }
        dual
    }

    /// The lambda >= 0 at which the dual is greatest.
    fn maximise_dual(&self, r: &[f64; M], workers: &Workers) -> [f64; M] {
        let dual = |lambda: &[f64; M]| self.dual(lambda, r, workers);
        let mut lambda = self.lambda;
        let (mut here, mut damping) = (dual(&lambda), LEAST_DAMPING);
        for _ in 0..MOST_NEWTON {
            // Multipliers that are 0 and want to be less stay.
            let held: [bool; M] = std::array::from_fn(|i| lambda[i] <= 0.0 && here.gradient[i] <= 0.0);
            let rest = (0..M).filter(|&i| !held[i]).map(|i| here.gradient[i].abs()).fold(0.0, f64::max);
            if rest <= 1e-9 {
                break;
            }
            let direction = newton(&here, &held, damping);
            let next: [f64; M] = std::array::from_fn(|i| (lambda[i] + direction[i]).max(0.0));
            // It is concave: no step gains more than this.
            let gain: f64 = (0..M).map(|i| here.gradient[i] * (next[i] - lambda[i])).sum();
            let there = dual(&next);
            let slope: f64 = (0..M).map(|i| there.gradient[i] * (next[i] - lambda[i])).sum();
            // What is gained may be less than values are rounded by; then the slope there tells whether it went too far.
            let is_gain = there.value >= here.value + 1e-3 * gain;
            let is_small = gain <= 1e-10 * here.value.abs() && slope >= -0.5 * gain;
            // What is cut off at 0 may leave a step that goes down.
            if gain > 0.0 && (is_gain || is_small) {
                (lambda, here, damping) = (next, there, (damping / 10.0).max(LEAST_DAMPING));
            } else {
                damping *= 10.0;
            }
        }
        lambda
    }
}

/// Newton steps of a dual, at most, with those that go too far.
const MOST_NEWTON: usize = 200;

/// What a dual's curvature is raised by at least, as a fraction of it: measures of both directions are much the same, so that it hardly bends along
/// some directions, and not at all where all variables are at bounds.
const LEAST_DAMPING: f64 = 1e-8;

impl<const M: usize> Term<M> {
    const NONE: Self =
        Term { x: 0.0, low: 0.0, high: 0.0, alpha: 0.0, beta: 0.0, p0: 0.0, q0: 0.0, p: [0.0; M], q: [0.0; M] };

    /// The best x_j for the multipliers, and p and q.
    #[inline]
    fn best(&self, lambda: &[f64; M]) -> (f64, f64, f64) {
        let (mut p, mut q) = (self.p0, self.q0);
        for (i, lambda) in lambda.iter().enumerate() {
            p += lambda * self.p[i];
            q += lambda * self.q[i];
        }
        let (a, b) = (p.sqrt(), q.sqrt());
        (((self.low * a + self.high * b) / (a + b)).clamp(self.alpha, self.beta), p, q)
    }

    #[inline]
    fn add_to(&self, lambda: &[f64; M], dual: &mut Dual<M>) {
        let (x, p, q) = self.best(lambda);
        let (up, down) = (1.0 / (self.high - x), 1.0 / (x - self.low));
        dual.value += p * up + q * down;
        let mut slope = [0.0; M];
        for (i, slope) in slope.iter_mut().enumerate() {
            dual.gradient[i] += self.p[i] * up + self.q[i] * down;
            *slope = self.p[i] * up * up - self.q[i] * down * down;
        }
        if self.alpha < x && x < self.beta {
            let stiffness = 0.5 / (p * up * up * up + q * down * down * down);
            for i in 0..M {
                for k in 0..M {
                    dual.curvature[i][k] += slope[i] * slope[k] * stiffness;
                }
            }
        }
    }
}

/// What can be summed up.
trait Summand: Send {
    const ZERO: Self;
    fn plus(self, other: &Self) -> Self;
}

impl<const M: usize> Summand for [f64; M] {
    const ZERO: Self = [0.0; M];
    fn plus(self, other: &Self) -> Self {
        std::array::from_fn(|i| self[i] + other[i])
    }
}

impl<const M: usize> Summand for Dual<M> {
    const ZERO: Self = Dual { value: 0.0, gradient: [0.0; M], curvature: [[0.0; M]; M] };
    fn plus(self, other: &Self) -> Self {
        Dual {
            value: self.value + other.value,
            gradient: self.gradient.plus(&other.gradient),
            curvature: std::array::from_fn(|i| self.curvature[i].plus(&other.curvature[i])),
        }
    }
}

/// Curvature^-1 gradient among the multipliers that are not held, by Cholesky's method; the curvature is raised by `damping` (Levenberg,
/// Marquardt), since whole steps go too far where bounds of variables take hold on the way.
fn newton<const M: usize>(dual: &Dual<M>, held: &[bool; M], damping: f64) -> [f64; M] {
    let mut l = dual.curvature;
    for i in 0..M {
        l[i][i] += damping * (1e-3 + l[i][i]);
        for k in 0..M {
            if held[i] || held[k] {
                l[i][k] = f64::from(u8::from(i == k));
            }
        }
    }
    let mut d: [f64; M] = std::array::from_fn(|i| if held[i] { 0.0 } else { dual.gradient[i] });
    for i in 0..M {
        for k in 0..i {
            let sum: f64 = (0..k).map(|m| l[i][m] * l[k][m]).sum();
            l[i][k] = (l[i][k] - sum) / l[k][k];
        }
        let sum: f64 = (0..i).map(|m| l[i][m] * l[i][m]).sum();
        l[i][i] = (l[i][i] - sum).max(1e-14).sqrt();
    }
    for i in 0..M {
        d[i] = (d[i] - (0..i).map(|m| l[i][m] * d[m]).sum::<f64>()) / l[i][i];
    }
    for i in (0..M).rev() {
        d[i] = (d[i] - (i + 1..M).map(|m| l[m][i] * d[m]).sum::<f64>()) / l[i][i];
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::SplitMix64;

    /// Svanberg's cantilever beam of 1987: five heights, one displacement; the optimum is known.
    #[test]
    fn the_cantilever_beam_is_found() {
        // Heights of 10 x in [0, 10]; weight 0.0624 sum h; 61/h1^3 + 37/h2^3 + 19/h3^3 + 7/h4^3 + 1/h5^3 <= 1.
        let c = [61.0, 37.0, 19.0, 7.0, 1.0];
        let workers = Workers::caller_only();
        let (mut mma, mut x) = (Mma::<1>::new(5).unwrap(), vec![0.5; 5]);
        for _ in 0..30 {
            let height = |x: f64| 10.0 * x.max(0.05);
            let value = x.iter().zip(c).map(|(x, c)| c / height(*x).powi(3)).sum::<f64>() - 1.0;
            let gradient: Vec<f64> = x.iter().zip(c).map(|(x, c)| -30.0 * c / height(*x).powi(4)).collect();
            let problem = Problem { objective: &[0.624; 5], values: [value], gradients: [&gradient] };
            mma.step(&mut x, &problem, &workers);
        }
        let weight = 0.624 * x.iter().sum::<f64>();
        assert!((weight - 1.340).abs() < 5e-4, "{weight}");
        for (x, best) in x.iter().zip([0.6016, 0.5309, 0.4494, 0.3502, 0.2153]) {
            assert!((x - best).abs() < 2e-3, "{x} {best}");
        }
    }

    /// Constraints that are nearly the same, and one that is another's opposite: there a whole Newton step goes far astray.
    #[test]
    fn multipliers_are_the_best_where_constraints_are_much_the_same() {
        let (n, workers) = (400, Workers::caller_only());
        let mut random = SplitMix64::new(7);
        for round in 0..300 {
            let mut of =
                |from: f64, to: f64| -> Vec<f64> { (0..n).map(|_| random.between(from, to) / n as f64).collect() };
            let (objective, one, share) = (of(-1.0, -0.9), of(0.0, 3.0), of(-1.0, 1.0));
            let near: Vec<f64> = one.iter().zip(of(0.0, 1e-6)).map(|(x, d)| x + d).collect();
            let other: Vec<f64> = share.iter().map(|x| -x).collect();
            let mut x: Vec<f64> = (0..n).map(|_| [0.0, 1.0, random.unit()][random.bits() as usize % 3]).collect();
            let values = [random.between(-0.5, 2.0), random.between(-0.5, 2.0)];
            let ratio = random.between(-0.3, 0.3);
            let values = [values[0], if round % 2 == 0 { values[0] } else { values[1] }, ratio - 1e-3, -ratio - 1e-3];
            let problem = Problem { objective: &objective, values, gradients: [&one, &near, &share, &other] };
            let mut mma = Mma::<4>::new(n).unwrap();
            let before = x.clone();
            mma.step(&mut x, &problem, &workers);
            // r, as the step has it.
            let at = |x: &[f64], i: usize| -> f64 {
                let of = |(t, x): (&Term<4>, &f64)| t.p[i] / (t.high - x) + t.q[i] / (x - t.low);
                mma.terms.iter().zip(x).map(of).sum()
            };
            let r: [f64; 4] = std::array::from_fn(|i| values[i] - at(&before, i));
            let dual = mma.dual(&mma.lambda, &r, &workers);
            for i in 0..4 {
                let slope = dual.gradient[i];
                let rest = if mma.lambda[i] > 0.0 { slope.abs() } else { slope };
                assert!(rest < 1e-6, "{round}: {i} {slope} {:?}", mma.lambda);
            }
        }
    }

    #[test]
    fn threads_change_no_bit() {
        let n = 3 * CHUNK + 5;
        let gradient: Vec<f64> = (0..n).map(|j| (j % 17) as f64 / 8.0).collect();
        let run = |n_threads| {
            let workers = Workers::new(n_threads).unwrap();
            let (mut mma, mut x) = (Mma::<2>::new(n).unwrap(), vec![1.0; n]);
            let objective = vec![-1.0; n];
            for _ in 0..4 {
                let sum: f64 = x.iter().zip(&gradient).map(|(x, g)| x * g).sum();
                let values = [sum - 100.0, 1.0 - x[0]];
                let mut other = vec![0.0; n];
                other[0] = -1.0;
                mma.step(&mut x, &Problem { objective: &objective, values, gradients: [&gradient, &other] }, &workers);
            }
            x
        };
        assert_eq!(run(1), run(3));
    }
}
