//! The root of least modulus of a real polynomial, proved to be the least.

use nalgebra::Complex;

/// Steps to one root before it is given up.
const MAX_STEPS: usize = 40;

/// Moduli that are closer than this count as different only after both roots are known.
const APART: f64 = 1e-9;

/// Roots of moduli that differ by more than this are told apart without dividing out.
const SURELY_APART: f64 = 1e-3;

/// Intervals of the half circle at whose ends the root of a known modulus is sought.
const STARTS: usize = 32;

/// A simple root.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// Where it lies.
    pub at: Complex<f64>,
    /// Size of the last Newton step over the root.
    pub step: f64,
    /// `|x p'(x)|`: what an error of the polynomial is divided by to become one of the root.
    pub slope: f64,
}

/// Root of least modulus of `Σ coefficients[j] x^j`, ascending, with a constant term that is not
/// zero; `guess` is where the search begins. `None` where an iteration stalls.
///
/// A root is found (Halley's method), divided out, and Jury's criterion counts whether the rest has
/// one in the disc of the least so far; if so the next is found. So the answer does not hang on the
/// guess. Where that stalls or loses its digits, Jury's criterion alone gives the modulus by bisection,
/// and the root is sought on that circle. `rest` is working storage.
pub fn least_root(coefficients: &[f64], guess: Option<Complex<f64>>, rest: &mut Vec<f64>) -> Option<Root> {
    let least = by_division(coefficients, guess, rest).or_else(|| on_the_circle(coefficients))?;
    polish(coefficients, least)
}

/// Finds and divides out roots until the rest has none in the disc of the least.
fn by_division(coefficients: &[f64], guess: Option<Complex<f64>>, rest: &mut Vec<f64>) -> Option<Complex<f64>> {
    rest.clear();
    rest.extend_from_slice(coefficients);
    let mut least: Option<Complex<f64>> = None;
    let mut guess = guess;
    loop {
        while rest.last() == Some(&0.0) {
            rest.pop();
        }
        let clear = |least: &Complex<f64>| is_clear(rest, least.norm() * (1.0 + APART));
        if rest.len() < 2 || least.as_ref().is_some_and(clear) {
            break;
        }
        let root = find(rest, guess.take())?;
        divide(rest, root);
        if least.is_none_or(|least| root.norm_sqr() < least.norm_sqr()) {
            least = Some(root);
        }
    }
    // Dividing out a root that was not the least can spoil the rest: the whole has the last word.
    least.filter(|least| is_clear(coefficients, least.norm() * (1.0 - SURELY_APART)))
}

/// The root on the greatest circle whose disc is clear.
fn on_the_circle(coefficients: &[f64]) -> Option<Complex<f64>> {
    let degree = coefficients.iter().rposition(|a| *a != 0.0).filter(|degree| *degree > 0)?;
    // The moduli of all roots multiply to this ratio, so the least is not above their geometric mean.
    let mean = (coefficients[0] / coefficients[degree]).abs().powf(1.0 / degree as f64);
    let (mut clear, mut taken) = (0.0, mean * (1.0 + SURELY_APART));
    while taken - clear > 0.5 * SURELY_APART * taken {
        let middle = 0.5 * (clear + taken);
        if middle == 0.0 {
            return None;
        }
        *if is_clear(coefficients, middle) { &mut clear } else { &mut taken } = middle;
    }
    let starts = (0..=STARTS).map(|k| Complex::from_polar(taken, std::f64::consts::PI * k as f64 / STARTS as f64));
    starts.filter_map(|start| find(coefficients, Some(start))).find(|root| root.norm() <= taken * (1.0 + SURELY_APART))
}

/// Value, slope and half the curvature at `x`.
fn evaluate(coefficients: &[f64], x: Complex<f64>) -> [Complex<f64>; 3] {
    let zero = Complex::new(0.0, 0.0);
    let [mut p, mut slope, mut curvature] = [zero; 3];
    for a in coefficients.iter().rev() {
        curvature = curvature * x + slope;
        slope = slope * x + p;
        p = p * x + a;
    }
    [p, slope, curvature]
}

/// Some root, from `guess` or from the root of the first three terms.
fn find(coefficients: &[f64], guess: Option<Complex<f64>>) -> Option<Complex<f64>> {
    let mut x = guess.unwrap_or_else(|| quadratic(coefficients));
    for step in 1..=MAX_STEPS {
        let [p, slope, curvature] = evaluate(coefficients, x);
        let halley = p * slope / (slope * slope - p * curvature);
        if !halley.re.is_finite() || !halley.im.is_finite() {
            return None;
        }
        x -= halley;
        // Third order: the error left is the cube of this step.
        if halley.norm_sqr() <= 1e-14 * x.norm_sqr() {
            if x.im != 0.0 && x.im * x.im < 1e-16 * x.norm_sqr() {
                // A real root that was reached from the plane.
                x.im = 0.0;
                continue;
            }
            return Some(x);
        }
        if step % 8 == 0 {
            // The real line never leads to a complex root: off it, or elsewhere.
            x *= Complex::new(0.6, 0.8);
        }
    }
    None
}

/// The lesser root of the first three terms.
fn quadratic(coefficients: &[f64]) -> Complex<f64> {
    let (c, half_b) = (coefficients[0], 0.5 * coefficients[1]);
    let a = coefficients.get(2).copied().unwrap_or(0.0);
    let square = half_b * half_b - a * c;
    if square >= 0.0 {
        let q = -(half_b + square.sqrt().copysign(half_b));
        Complex::new(if q == 0.0 { 1.0 } else { c / q }, 0.0)
    } else {
        Complex::new(-half_b / a, (-square).sqrt() / a)
    }
}

/// Divides out a real root or a complex pair, from the highest power down: stable for the roots of
/// least modulus.
fn divide(rest: &mut Vec<f64>, root: Complex<f64>) {
    let (u, v) = (2.0 * root.re, root.norm_sqr());
    let (mut above, mut twice_above) = (0.0, 0.0);
    for entry in rest.iter_mut().rev() {
        let new = if root.im == 0.0 { *entry + root.re * above } else { *entry + u * above - v * twice_above };
        (twice_above, above) = (above, new);
        *entry = new;
    }
    // The first entries are the remainder.
    rest.drain(..if root.im == 0.0 { 1 } else { 2 });
}

/// Whether the disc of `radius` holds no root.
fn is_clear(coefficients: &[f64], radius: f64) -> bool {
    greatest_reflection(coefficients, radius) < 1.0
}

/// Greatest reflection coefficient of the recursion of Schur, Cohn and Jury, or the first that is not
/// below one: the disc of `radius` holds no root if all are below one. Infinite where the polynomial
/// is too long or has no value.
fn greatest_reflection(coefficients: &[f64], radius: f64) -> f64 {
    const SPACE: usize = 128;
    let mut scaled = [0.0; SPACE];
    let mut power = 1.0;
    let mut top = 0;
    let Some(scaled) = scaled.get_mut(..coefficients.len()) else { return f64::INFINITY };
    for (j, (target, a)) in scaled.iter_mut().zip(coefficients).enumerate() {
        *target = a * power;
        power *= radius;
        if target.abs() > f64::EPSILON * 1e-2 * coefficients[0].abs() {
            top = j;
        }
    }
    let mut greatest: f64 = 0.0;
    for n in (1..=top).rev() {
        let ratio = scaled[n] / scaled[0];
        if ratio.is_nan() {
            return f64::INFINITY;
        }
        greatest = greatest.max(ratio.abs());
        if greatest >= 1.0 {
            break;
        }
        for j in 0..=n / 2 {
            let (low, high) = (scaled[j], scaled[n - j]);
            scaled[j] = low - ratio * high;
            scaled[n - j] = high - ratio * low;
        }
    }
    greatest
}

/// Newton's method on the whole polynomial: dividing out has cost digits.
fn polish(coefficients: &[f64], mut at: Complex<f64>) -> Option<Root> {
    let mut step = f64::INFINITY;
    for _ in 0..4 {
        let [p, slope, _] = evaluate(coefficients, at);
        let newton = p / slope;
        let size = (newton.norm_sqr() / at.norm_sqr()).sqrt();
        if size >= step || size.is_nan() {
            break;
        }
        (at, step) = (at - newton, size);
        if step < 1e-15 {
            break;
        }
    }
    let slope = (evaluate(coefficients, at)[1] * at).norm_sqr().sqrt();
    step.is_finite().then_some(Root { at, step, slope })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn product(roots: &[(f64, f64)]) -> Vec<f64> {
        let mut all = vec![1.0];
        for (modulus, angle) in roots {
            // A pair, or a real root where the angle is 0 or pi.
            let real = angle.sin().abs() < 1e-12;
            let factor = if real {
                vec![1.0, -angle.cos() / modulus]
            } else {
                vec![1.0, -2.0 * angle.cos() / modulus, modulus.powi(-2)]
            };
            let mut next = vec![0.0; all.len() + factor.len() - 1];
            for (i, a) in all.iter().enumerate() {
                for (j, b) in factor.iter().enumerate() {
                    next[i + j] += a * b;
                }
            }
            all = next;
        }
        all
    }

    proptest! {
        /// Wherever the search begins.
        #[test]
        fn the_least_root_is_found(
            moduli in prop::collection::vec(0.2f64..5.0, 1..6), angles in prop::collection::vec(0usize..9, 6),
            start in (-3.0f64..3.0, -3.0f64..3.0),
        ) {
            let least = moduli.iter().copied().fold(f64::INFINITY, f64::min);
            prop_assume!(moduli.iter().filter(|modulus| **modulus < 1.02 * least).count() == 1);
            let roots: Vec<_> =
                moduli.iter().zip(&angles).map(|(m, a)| (*m, *a as f64 * std::f64::consts::PI / 8.0)).collect();
            let polynomial = product(&roots);
            for guess in [None, Some(Complex::new(start.0, start.1))] {
                if let Some(root) = least_root(&polynomial, guess, &mut Vec::new()) {
                    prop_assert!((root.at.norm() / least - 1.0).abs() < 1e-6, "{} {roots:?}", root.at);
                }
            }
            prop_assert!(least_root(&polynomial, None, &mut Vec::new()).is_some());
        }
    }

    /// Every search from the first three terms stalls here, or dividing out costs the digits.
    #[test]
    fn the_circle_finds_what_dividing_out_does_not() {
        let pi = std::f64::consts::PI;
        let hard = [
            (4.817518905978091, pi),
            (1.4496246321099626, 0.75 * pi),
            (3.5221389966960825, 0.375 * pi),
            (2.533818468830427, 0.25 * pi),
            (2.4271263564781795, 0.25 * pi),
        ];
        let polynomial = product(&hard);
        assert!(by_division(&polynomial, None, &mut Vec::new()).is_none());
        let root = least_root(&polynomial, None, &mut Vec::new()).unwrap();
        assert!((root.at.norm() / hard[1].0 - 1.0).abs() < 1e-9, "{}", root.at);
    }

    #[test]
    fn a_disc_with_a_root_is_not_clear() {
        let polynomial = product(&[(0.9, 1.0), (2.0, 0.0), (3.0, 2.0)]);
        assert!(is_clear(&polynomial, 0.8999) && !is_clear(&polynomial, 0.9001));
    }
}
