//! Characteristic roots of turning against the collocation of whole revolutions, and against the
//! exact limits at low speed.

use proptest::prelude::*;
use std::f64::consts::TAU;
use toolroom_chatter::{ChatterError, Mode, SpeedVariation, Turning};

fn cut(frequencies: &[f64], damping_ratio: f64, process_damping: f64, force_angle: f64) -> Turning {
    let modes = frequencies.iter().enumerate().map(|(i, frequency)| Mode {
        direction: [1.0, 0.3 * i as f64],
        natural_frequency: *frequency,
        damping_ratio,
        stiffness: 6.48e6 * (1.0 + i as f64),
    });
    Turning { process_damping, force_angle, ..Turning::orthogonal(modes.collect(), 1384e6, 0.035) }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_rightmost_root_is_the_dominant_multiplier_of_the_revolution(
        first in 200.0..900.0f64,
        ratio in 1.1..3.0f64,
        modes in 1usize..=2,
        damping_ratio in 0.01..0.08f64,
        process_damping in 0.0..6e5f64,
        force_angle in 0.0..1.0f64,
        rpm in 1500.0..12000.0f64,
        width in 0.02e-3..2e-3f64,
    ) {
        let cut = cut(&[first, first * ratio][..modes], damping_ratio, process_damping, force_angle);
        let speed = rpm / 60.0 * TAU;
        let exact = cut.verdict(speed, width).unwrap();
        // No variation of the speed: the map of two revolutions.
        let still = SpeedVariation { amplitude: 0.0, revolutions: 2, phase: None };
        let mapped = cut.verdict_at_varying_speed(speed, still, width).unwrap();
        prop_assert!(
            (exact.spectral_radius / mapped.spectral_radius - 1.0).abs() < 1e-6,
            "{} by the root, {} by the map", exact.spectral_radius, mapped.spectral_radius
        );
    }

    #[test]
    fn slow_cuts_are_judged_as_their_exact_limit_says(
        rpm in 20.0..600.0f64,
        process_damping in 0.0..3e4f64,
        share in 0.3..2.0f64,
    ) {
        let cut = cut(&[540.9, 1210.0], 0.038, process_damping, 0.0);
        let speed = rpm / 60.0 * TAU;
        if let Ok(limit) = cut.limit(speed) {
            let verdict = cut.verdict(speed, share * limit.depth).unwrap();
            if (share - 1.0).abs() > 1e-6 && share < 1.0 {
                prop_assert!(verdict.stable, "{rpm} rpm, {share} of the limit: {}", verdict.spectral_radius);
            }
            if share > 1.0 + 1e-6 && process_damping == 0.0 {
                prop_assert!(!verdict.stable, "{rpm} rpm, {share} of the limit: {}", verdict.spectral_radius);
            }
            let neutral = cut.verdict(speed, limit.depth).unwrap();
            prop_assert!((neutral.spectral_radius - 1.0).abs() < 1e-7, "{}", neutral.spectral_radius);
        }
    }
}

#[test]
fn any_damping_is_answered_and_what_is_none_is_refused() {
    // From cuts that hardly rub to lands that a cut never has, with the modes' shares of the force in phase and against.
    for angles in [[0.0, 0.0], [0.9, -0.6], [0.9, -1.2]] {
        let modes = [720.0, 227.0].into_iter().zip(angles).map(|(natural_frequency, angle): (f64, f64)| Mode {
            direction: [angle.cos(), angle.sin()],
            natural_frequency,
            damping_ratio: 0.03,
            stiffness: 6e7,
        });
        let bare = Turning { force_angle: 1.2, ..Turning::orthogonal(modes.collect(), 1.1e9, 0.04) };
        let unit = Turning { process_damping: 1.0, ..bare };
        for rpm in [1.0, 60.0, 1591.0] {
            let speed = rpm / 60.0 * TAU;
            let damped = |ratio: f64| {
                Turning { process_damping: ratio * speed / unit.always_stable_below(), ..unit.clone() }.limit(speed)
            };
            for power in -12..15 {
                let limit = damped(10f64.powi(power));
                assert!(matches!(limit, Ok(_) | Err(ChatterError::NoLimit { .. })), "{rpm} rpm, 1e{power}: {limit:?}");
            }
            for beyond in [1e16, 1e100, 1e200] {
                assert!(matches!(damped(beyond), Err(ChatterError::OutOfRange { .. })), "{rpm} rpm, {beyond}");
            }
        }
    }
}
