//! Stiffnesses and the lag.

use toolroom_process::{ModelError, Number};

/// Lag of the system, `lag = process_stiffness / (system_stiffness + process_stiffness)`: the
/// share of the deflection that one work revolution leaves.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eq. (3).
///
/// ```
/// let lag = toolroom_infeed::lag(38.3747e6, 31.019e6);
/// assert!((lag - 0.553f64).abs() < 1e-5);
/// ```
pub fn lag<N: Number>(process_stiffness: N, system_stiffness: N) -> N {
    process_stiffness / (system_stiffness + process_stiffness)
}

/// System stiffness from the lag, `J = Cp (1 − K)/K`: the inverse of [`lag`].
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eq. (3) solved for J. The paper's own eq. (8) is
/// [`paper_eq8_contradicts_eq3`].
///
/// ```
/// let j = toolroom_infeed::stiffness_from_k(38.3747e6, 0.553);
/// assert!((j / 3.1019e7 - 1.0f64).abs() < 1e-4);
/// ```
pub fn stiffness_from_k<N: Number>(process_stiffness: N, lag: N) -> N {
    process_stiffness * (-lag + 1.0) / lag
}

/// `J = Cp (1 − K)`, eq. (8) as printed. It contradicts eq. (3) by the factor 1/K and is kept
/// only to show by how much the printed system stiffness is wrong.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eq. (8).
pub fn paper_eq8_contradicts_eq3<N: Number>(process_stiffness: N, lag: N) -> N {
    process_stiffness * (-lag + 1.0)
}

/// Stiffness of springs in series, `1/J = Σ 1/C`.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eq. (5), for three springs.
///
/// ```
/// assert_eq!(toolroom_infeed::series_stiffness(&[100e6, 100e6]), 50e6);
/// ```
pub fn series_stiffness(members: &[f64]) -> f64 {
    1.0 / members.iter().map(|stiffness| 1.0 / stiffness).sum::<f64>()
}

/// The one unknown spring of a series, from the whole and the `known` others.
///
/// # Errors
/// [`ModelError::NoSolution`] where the known springs alone are softer than the whole.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eq. (5) solved for C2.
///
/// ```
/// let c2 = toolroom_infeed::remaining_stiffness(31.019e6, &[100e6, 100e6]).unwrap();
/// assert!((c2 / 81.71e6 - 1.0).abs() < 1e-4);
/// ```
pub fn remaining_stiffness(whole: f64, known: &[f64]) -> Result<f64, ModelError> {
    let compliance = 1.0 / whole - known.iter().map(|stiffness| 1.0 / stiffness).sum::<f64>();
    if compliance > 0.0 {
        Ok(1.0 / compliance)
    } else {
        Err(ModelError::NoSolution {
            quantity: "remaining stiffness",
            reason: "the known springs alone are softer than the whole",
        })
    }
}
