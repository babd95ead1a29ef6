//! The number type that equations are written in.

use num_dual::{DualNum, DualNumCopy};

/// `f64`, or a dual number that carries exact derivatives along.
///
/// Equations are written once, generic over this trait; constants enter through
/// `N::from(1.0)`, powers with a constant exponent through `powf`, with a variable exponent
/// through `powd`.
///
/// ```
/// use num_dual::{Dual64, first_derivative};
/// use toolroom_process::Number;
/// fn rate<N: Number>(speed: N) -> N {
///     speed.powf(0.4) * 92.0
/// }
/// let (value, slope) = first_derivative(rate::<Dual64>, 3.0);
/// assert!((slope - 0.4 * value / 3.0).abs() < 1e-12);
/// ```
pub trait Number: DualNumCopy + DualNum<Primitive = f64> {}

impl<T: DualNumCopy + DualNum<Primitive = f64>> Number for T {}
