//! The machine of the paper, and what is compared with its numbers.

use toolroom_effects::{Effect, Effects};
use toolroom_infeed::{Infeed, Parameters, stiffness_from_k};
use toolroom_process::Process;

/// One revolution of the work, s.
pub const REVOLUTION: f64 = 60.0 / 292.0;
/// Lag of the paper.
pub const K: f64 = 0.553;
/// The smallest change of a number printed with six significant digits.
pub const SIX_DIGITS: f64 = 1e-5;

#[track_caller]
pub fn close(value: f64, expected: f64, relative: f64) {
    assert!((value - expected).abs() <= relative * expected.abs(), "{value} computed, {expected} expected");
}

/// The paper's machine with K exactly 0.553.
pub fn paper() -> Infeed {
    let process_stiffness = 170.0 / 4.43e-6;
    let system_stiffness = stiffness_from_k(process_stiffness, K);
    let parameters = Parameters { process_stiffness, system_stiffness, ..Parameters::default() };
    Infeed { parameters, ..Infeed::default() }
}

/// Every mechanism at work: wear, threshold, dulling, and all effects at a moderate size.
pub fn everything() -> Infeed {
    let parameters = Parameters {
        threshold_force: 12.0,
        wheel_wear_ratio: 1.0 / 60.0,
        dulling_rate: 1.0 / 1.5e-3,
        ..Parameters::default()
    };
    let sized = Effect::all().filter(|effect| effect.entry().search(Infeed::NAME).is_some());
    let sized = sized.map(|effect| effect.with_size(effect.entry().size.max * 1e-3)).collect();
    Infeed::new(parameters, Effects::new(sized).expect("distinct")).expect("effects of infeed")
}
