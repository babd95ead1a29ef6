//! Stable intervals of turning: published crossings, and the neutral vibrations against an independent count.

use proptest::prelude::*;
use std::f64::consts::TAU;
use toolroom_chatter::{
    Certificate, ChatterError, Cutter, Direction, Engagement, Milling, MillingForce, Mode, Turning,
};

fn rpm(speed: f64) -> f64 {
    speed / 60.0 * TAU
}

/// Modes as (x, y, Hz, damping ratio, N/m).
fn cut(modes: &[[f64; 5]], coefficient: f64, angle: f64, process_damping: f64) -> Turning {
    let modes = modes.iter().map(|[x, y, natural_frequency, damping_ratio, stiffness]| Mode {
        direction: [*x, *y],
        natural_frequency: *natural_frequency,
        damping_ratio: *damping_ratio,
        stiffness: *stiffness,
    });
    Turning {
        force_angle: angle.to_radians(),
        process_damping,
        ..Turning::orthogonal(modes.collect(), coefficient, 0.04)
    }
}

/// Two modes whose limit two crossings follow within two percent.
fn near_touch() -> (Turning, f64) {
    let modes = [[0.92375, 0.38299, 208.7, 0.0288, 4.364e7], [0.99968, 0.02534, 815.0, 0.0119, 7.659e6]];
    (cut(&modes, 1081e6, 13.6, 6.856e5), rpm(2143.19))
}

/// Four modes of which two are close.
fn close_modes() -> (Turning, f64) {
    let modes = [
        [0.9677, -0.2521, 158.4, 0.0235, 8.643e6],
        [0.99668, -0.08139, 331.6, 0.0272, 1.803e7],
        [0.98168, 0.19054, 126.3, 0.0121, 1.587e7],
        [0.99503, -0.09959, 124.8, 0.0363, 5.803e6],
    ];
    (cut(&modes, 1735e6, 20.1, 1.066e5), rpm(4897.17))
}

#[track_caller]
fn ends(cut: &Turning, speed: f64, greatest: f64, expected: &[f64]) {
    let found = cut.stable_intervals(speed, greatest).unwrap();
    let depths: Vec<f64> = found.ends.iter().map(|end| end.limit.depth * 1e3).collect();
    assert_eq!(depths.len(), expected.len(), "{depths:?}");
    for (depth, expected) in depths.iter().zip(expected) {
        assert!((depth / expected - 1.0).abs() < 1e-7, "{depths:?}");
    }
    assert_eq!(found.certificate, Certificate::Proved);
    let (first, limit) = (found.limit().unwrap().depth, cut.limit(speed).unwrap().depth);
    assert!((first / limit - 1.0).abs() < 1e-12, "{first} {limit}");
}

#[test]
fn pairs_of_crossings_are_not_stepped_over() {
    let (cut, speed) = near_touch();
    ends(&cut, speed, 6e-3, &[0.83112419, 0.98851381, 1.00393934]);
    ends(&cut, speed, 30e-3, &[0.83112419, 0.98851381, 1.00393934, 6.35691405]);
    assert!((cut.limit(speed).unwrap().chatter_frequency - 849.7318).abs() < 1e-4);
}

#[test]
fn an_unstable_root_beside_stable_structural_ones_is_found() {
    let (cut, speed) = close_modes();
    let limit = cut.limit(speed).unwrap().depth;
    assert!((limit * 1e3 / 0.52521181 - 1.0).abs() < 1e-7, "{limit}");
    let verdict = cut.verdict(speed, 0.535716e-3).unwrap();
    assert!(!verdict.stable && (verdict.spectral_radius - 1.0007887).abs() < 1e-7, "{}", verdict.spectral_radius);
    ends(&cut, speed, 1.3e-3, &[0.52521181, 0.74595610, 0.80497655]);
}

#[test]
fn a_cut_is_stable_again_above_its_limit() {
    let cut = cut(&[[0.81398, 0.5809, 968.5, 0.0347, 4.917e6]], 756.2e6, 34.2, 7.69e5);
    ends(&cut, rpm(4320.58), 8e-3, &[3.40790862, 4.36082071, 4.76004717, 5.79565668]);
}

/// Two helical teeth at low immersion: islands above which the cut is stable again.
#[test]
fn islands_of_a_helical_cutter() {
    let cut = Milling {
        modes: vec![Mode { direction: [1.0, 0.0], natural_frequency: 922.0, damping_ratio: 0.011, stiffness: 1.34e6 }],
        cutter: Cutter { helix_angle: TAU / 8.0, ..Cutter::straight(2, 8e-3) },
        engagement: Engagement::new(0.05, Direction::Down).unwrap(),
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    };
    for (speed, from, to) in
        [(17850.0, 1.78988805, 3.06628205), (16800.0, 6.24774127, 7.29866957), (17600.0, 2.67135879, 3.54511686)]
    {
        let found = cut.at_speed(rpm(speed)).unwrap().stable_intervals(8.5e-3).unwrap();
        let depths: Vec<f64> = found.ends.iter().map(|end| end.limit.depth * 1e3).collect();
        let close = |value: f64| depths.iter().any(|depth| (depth / value - 1.0).abs() < 1e-7);
        assert!(close(from) && close(to), "{speed} rpm: {depths:?}");
        assert!(!found.is_stable(0.5e-3 * (from + to)) && found.is_stable(1.001e-3 * to));
    }
    // Just missed: the radius rises to 0.9834 only.
    let missed = cut.at_speed(rpm(17450.0)).unwrap().stable_intervals(4.5e-3).unwrap();
    assert!(missed.ends.iter().all(|end| (end.limit.depth * 1e3 - 3.6).abs() > 0.3), "{missed:?}");
}

#[test]
fn slow_spindles_are_answered() {
    let (cut, _) = close_modes();
    for speed in [1.0, 5.0, 50.0] {
        let cut = Turning { process_damping: 0.0, ..cut.clone() };
        let limit = cut.limit(rpm(speed)).unwrap();
        // The lobes close up on the absolute limit.
        assert!((limit.depth / cut.absolute_limit().unwrap() - 1.0).abs() < 0.02, "{speed} rpm: {}", limit.depth);
        let verdict = cut.verdict(rpm(speed), 1.1 * limit.depth).unwrap();
        assert!(!verdict.stable && verdict.spectral_radius > 1.0);
    }
}

prop_compose! {
    fn any_cut()(
        modes in proptest::collection::vec(
            (-0.7..0.7f64, 100.0..1500.0f64, 0.008..0.06f64, 4e6..6e7f64), 1..5),
        coefficient in 5e8..3e9f64,
        angle in 0.0..60.0f64,
        damping in prop_oneof![Just(0.0), 3e4..1e6f64],
        speed in 300.0..15000.0f64,
    ) -> (Turning, f64) {
        let modes: Vec<[f64; 5]> =
            modes.iter().map(|(turn, f, zeta, k)| [turn.cos(), turn.sin(), *f, *zeta, *k]).collect();
        (cut(&modes, coefficient, angle, damping), rpm(speed))
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn verdicts_intervals_and_limit_agree((cut, speed) in any_cut(), shares in proptest::collection::vec(0.01..4.0f64, 6)) {
        let reference = match cut.limit(speed) {
            Ok(limit) => limit.depth,
            Err(ChatterError::NoLimit { searched }) => 1e-2 * searched,
            Err(error) => return Err(TestCaseError::fail(error.to_string())),
        };
        let found = cut.stable_intervals(speed, 4.0 * reference).unwrap();
        prop_assert!(found.ends.windows(2).all(|pair| pair[0].limit.depth < pair[1].limit.depth
            && pair[0].becomes_unstable != pair[1].becomes_unstable));
        for share in shares {
            let width = share * reference;
            let verdict = cut.verdict(speed, width).unwrap();
            prop_assert_eq!(verdict.stable, found.is_stable(width), "{} m", width);
            prop_assert_eq!(verdict.stable, verdict.spectral_radius < 1.0);
            prop_assert_eq!(verdict.stable, cut.is_stable(speed, width).unwrap());
        }
        for end in &found.ends {
            let radius = |factor: f64| cut.verdict(speed, end.limit.depth * factor).unwrap().spectral_radius;
            prop_assert!((radius(1.0) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn units_do_not_matter((cut, speed) in any_cut(), length in 1e-3..1e3f64, force in 1e-3..1e3f64) {
        // Lengths in units of `length`, forces in units of `force`.
        let scaled = Turning {
            modes: cut.modes.iter().map(|mode| Mode { stiffness: mode.stiffness / force * length, ..*mode }).collect(),
            cutting_coefficient: cut.cutting_coefficient / force * length * length,
            process_damping: cut.process_damping / force * length,
            diameter: cut.diameter / length,
            ..cut.clone()
        };
        match (cut.limit(speed), scaled.limit(speed)) {
            (Ok(a), Ok(b)) => prop_assert!((a.depth / (b.depth * length) - 1.0).abs() < 1e-9),
            (a, b) => prop_assert_eq!(a.is_err(), b.is_err()),
        }
    }
}
