//! Stable intervals of turning: published crossings, and the neutral vibrations against an independent count.

use proptest::prelude::*;
use std::f64::consts::TAU;
use toolroom_chatter::{
    Axis, Certificate, ChatterError, Cutter, Direction, Engagement, Milling, MillingForce, Mode, Turning,
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

/// A milling cut of low immersion with a helix; modes as (x, y, Hz, damping ratio, N/m).
fn helical(modes: &[[f64; 5]], teeth: usize, [diameter, helix_angle, immersion]: [f64; 3], force: [f64; 2]) -> Milling {
    let modes = modes.iter().map(|[x, y, natural_frequency, damping_ratio, stiffness]| Mode {
        direction: [*x, *y],
        natural_frequency: *natural_frequency,
        damping_ratio: *damping_ratio,
        stiffness: *stiffness,
    });
    Milling {
        modes: modes.collect(),
        cutter: Cutter { helix_angle, ..Cutter::straight(teeth, diameter) },
        engagement: Engagement::new(immersion, Direction::Down).unwrap(),
        force: MillingForce::new(force[0] * 1e6, force[1] * 1e6),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    }
}

/// A pocket of 25 um within the last step of the search, on whose far side no further step says that the radius has risen
/// again: curve and intervals have it.
#[test]
fn a_pocket_in_the_last_step_of_a_search_is_found() {
    let modes = [
        [1.0, 0.0, 1311.4492286707791, 0.01166086624808492, 2197841.5260249553],
        [0.0, 1.0, 1022.7502700080674, 0.02644013885164674, 2000318.7552256514],
    ];
    let geometry = [6.551431323557439e-3, 0.5963038719435532, 0.03218963666471406];
    let cut = helical(&modes, 5, geometry, [856.6248363840143, 247.44523291018436]);
    let (speed, greatest) = (rpm(10015.012338187758), 1.800937727145292e-3);
    let axis = Axis { start: speed, end: 1.001 * speed, points: 2 };
    let curve = &cut.boundary(&axis, greatest).unwrap().columns[0];
    let found = cut.at_speed(speed).unwrap().stable_intervals(greatest).unwrap();
    for ends in [&curve.crossings, &found.ends] {
        let depths: Vec<f64> = ends.iter().map(|end| end.limit.depth * 1e3).collect();
        assert_eq!(depths.len(), 3, "{depths:?}");
        for (depth, expected) in depths.iter().zip([1.677834556, 1.769419845, 1.794724493]) {
            assert!((depth / expected - 1.0).abs() < 1e-4, "{depths:?}");
        }
    }
    assert!(cut.verdict(speed, 1.782746436972107e-3).unwrap().stable);
}

/// The fixed start vector of the iteration holds next to nothing of the dominant vector at 2.187 mm, where the map differs in
/// size from that at the depth before: its radius must not be that of the next pair, 0.943.
#[test]
fn a_start_without_the_dominant_vector_is_seen_through() {
    let modes = [
        [0.8934674164144618, -0.4491280171684536, 521.6036367736684, 0.012927032481206122, 7455462.6564867245],
        [-0.9180884679862579, 0.3963755352574701, 331.8872259748049, 0.015195696749690058, 2306428.605283379],
        [0.39283682086706656, -0.9196081949238253, 527.909587638366, 0.02103145870614485, 2920554.802116815],
        [0.34382489483919043, -0.9390337809093023, 293.4808090634, 0.028422955447979365, 3690416.271120397],
    ];
    let geometry = [19.526673844706178e-3, 0.7989102637461902, 0.042662454206932154];
    let cut = helical(&modes, 2, geometry, [905.2151338447617, 420.3404162587238]);
    let speed = rpm(18387.279065141945);
    let depths: Vec<f64> = (36..52).map(|j| 5.034598086274213e-3 * f64::from(j) / 99.0).collect();
    let chart = cut.lobes(&[speed], &depths).unwrap();
    for (j, depth) in depths.iter().enumerate() {
        let radius = cut.at_speed(speed).unwrap().multipliers(*depth, 0).unwrap()[0].norm();
        let alone = cut.at_speed(speed).unwrap().screen(*depth).unwrap().spectral_radius;
        for told in [chart.at(0, j).unwrap().spectral_radius, alone] {
            assert!((told / radius - 1.0).abs() < 1e-3, "{depth}: {told} for {radius}");
        }
    }
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
