//! A third-order step for inputs that change with every step.

use super::Tolerance;

/// Greatest change of a component in a [`short_step`], share of its size and scale.
const SHORT: f64 = 0.02;

/// A right-hand side that time does not enter. A closure is one; a type of its own may have it
/// compiled into the step with `#[inline(always)]`, so that what it returns stays in registers.
pub trait Autonomous<const D: usize> {
    /// The right-hand side at `y`.
    fn slope(&self, y: &[f64; D]) -> [f64; D];
}

impl<const D: usize, F: Fn(&[f64; D]) -> [f64; D]> Autonomous<D> for F {
    #[inline]
    fn slope(&self, y: &[f64; D]) -> [f64; D] {
        self(y)
    }
}

/// One third-order step over `h` where so little changes in it that this is accurate enough; `None` where it is not. It takes
/// three calls of the right-hand side, whatever went before it.
///
/// Accurate enough is: no component changes by more than 2 % of its size plus its scale
/// (`absolute/relative` of the tolerance), and the error of the embedded second-order step is
/// within the tolerance. That of the step itself is smaller by the ratio of `h` to the time in
/// which the right-hand side changes.
///
/// # Source
/// Bogacki & Shampine, Appl. Math. Lett. 2 (1989) 321-325: the third-order step. Their second-order step asks for the
/// right-hand side at the end as well, which the next step can only use where its input is the same; an input that changes
/// with every step would cost a fourth call. The weights 1/9, 2/3, 2/9 of the same three calls meet the conditions of second
/// order, too, and their error is at least that of Bogacki and Shampine in each of the two terms of third order:
///
/// | term | this | Bogacki & Shampine |
/// |---|---|---|
/// | f'f'f | 1/12 | 1/48 |
/// | f''(f, f) | 1/48 | 1/48 |
///
/// ```
/// use toolroom_process::ode::{Tolerance, short_step};
/// let tolerance = Tolerance { relative: 1e-7, absolute: [1e-7] };
/// let end = short_step(&|y: &[f64; 1]| [-y[0]], &[1.0], 0.01, &tolerance).unwrap();
/// assert!((end[0] - (-0.01f64).exp()).abs() < 1e-9);
/// ```
#[inline]
pub fn short_step<const D: usize>(
    rhs: &impl Autonomous<D>,
    y: &[f64; D],
    h: f64,
    tolerance: &Tolerance<D>,
) -> Option<[f64; D]> {
    let relative = tolerance.relative;
    let size = |i: usize| tolerance.absolute[i] + relative * y[i].abs();
    let k1 = rhs.slope(y);
    if !every(D, |i| (h * k1[i]).abs() * relative <= SHORT * size(i)) {
        return None;
    }
    let k2 = rhs.slope(&std::array::from_fn(|i| y[i] + 0.5 * h * k1[i]));
    let k3 = rhs.slope(&std::array::from_fn(|i| y[i] + 0.75 * h * k2[i]));
    let error = |i: usize| h * (1.0 / 9.0) * (k1[i] - 3.0 * k2[i] + 2.0 * k3[i]);
    every(D, |i| error(i).abs() <= size(i))
        .then(|| std::array::from_fn(|i| y[i] + h * (2.0 / 9.0 * k1[i] + 1.0 / 3.0 * k2[i] + 4.0 / 9.0 * k3[i])))
}

/// Whether a condition holds for every component, without a branch for each.
#[inline]
fn every(components: usize, holds: impl Fn(usize) -> bool) -> bool {
    (0..components).fold(true, |so_far, i| so_far & holds(i))
}
