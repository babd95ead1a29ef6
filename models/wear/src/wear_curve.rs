//! Factors that shape the wear curve, shared by several laws.

use toolroom_process::{ModelError, Number};

/// Run-in of a new edge: `g_m = 1 + land/(flank_wear + offset)`.
///
/// The pressure on the flank falls while the land grows, so that mechanical wear is fastest on
/// a new edge. All physical laws share this factor: how the first tenths of a millimetre bend
/// is then no reason to prefer one law to another. A `land` of zero switches it off. All lengths
/// in one unit; the result is a ratio.
///
/// # Examples
/// ```
/// assert_eq!(toolroom_wear::run_in(0.06e-3, 0.08e-3, 0.02e-3), 2.0);
/// ```
#[inline]
pub fn run_in<N: Number>(flank_wear: N, land: N, offset: N) -> N {
    (flank_wear + offset).recip() * land + 1.0
}

/// Inverse rate of the three-stage wear curve, `s(x) = 1 + c·(6x(1 - x) - 1) + d·(2x - 1)` with
/// the contrast c and the tilt d; `x` = flank wear over wear limit, 1 beyond the limit.
///
/// Its integral from 0 to 1 is 1 for every c and d, so that neither changes the life. A
/// positive tilt makes a new edge wear faster and a spent one slower.
///
/// # Examples
/// ```
/// assert_eq!(toolroom_wear::wear_stage(0.5, 0.6, 0.0), 1.3); // slowest in the middle
/// assert!(toolroom_wear::wear_stage(0.0, 0.6, 0.2) < toolroom_wear::wear_stage(2.0, 0.6, 0.2));
/// ```
#[inline]
pub fn wear_stage<N: Number>(x: N, contrast: N, tilt: N) -> N {
    let x = if x.re() > 1.0 { N::from(1.0) } else { x };
    contrast * (x * (-x + 1.0) * 6.0 - 1.0) + 1.0 + tilt * (x * 2.0 - 1.0)
}

/// Share of the life after which the three-stage curve has reached `x` = flank wear over wear limit, 0 or more: the integral of
/// [`wear_stage`].
///
/// # Examples
/// ```
/// use toolroom_wear::stage_time;
/// assert_eq!((stage_time(0.0, 0.6, 0.2), stage_time(0.5, 0.6, 0.0), stage_time(1.0, 0.6, 0.2)), (0.0, 0.5, 1.0));
/// assert!((stage_time(2.0, 0.6, 0.0) - 1.4).abs() < 1e-15); // beyond the limit at the rate of its end
/// ```
pub fn stage_time(x: f64, contrast: f64, tilt: f64) -> f64 {
    let inside = x.min(1.0);
    let whole = inside + contrast * inside * (inside * (3.0 - 2.0 * inside) - 1.0) + tilt * inside * (inside - 1.0);
    whole + (x - inside) * wear_stage(1.0, contrast, tilt)
}

/// Largest contrast of the wear stages (assumption): at 1 the wear rate would be infinite at both ends of the life.
pub const LARGEST_CONTRAST: f64 = 0.95;

/// Largest share of `1 - stage_contrast` that the tilt may have: the wear curve then stays
/// above a twentieth of it everywhere.
pub const LARGEST_TILT: f64 = 0.95;

/// Whether a stage tilt is admissible beside its contrast.
///
/// # Errors
/// [`ModelError::Contradiction`] where |tilt| > 0.95·(1 - contrast): the wear rate would not be
/// positive and finite.
pub fn check_tilt(contrast: f64, tilt: f64) -> Result<(), ModelError> {
    // A tilt at the bound itself, written in decimals, is admissible.
    if tilt.abs() <= LARGEST_TILT * (1.0 - contrast) * (1.0 + 1e-12) {
        return Ok(());
    }
    Err(ModelError::Contradiction {
        first: "stage_tilt",
        first_value: tilt,
        second: "stage_contrast",
        second_value: contrast,
        rule: "the tilt is at most 0.95·(1 - stage_contrast) in absolute value, so that the wear rate stays finite",
    })
}
