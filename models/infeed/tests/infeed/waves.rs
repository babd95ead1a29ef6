//! Growth of waves against the delay equation with a vibrating wheel head.

use proptest::prelude::*;
use std::f64::consts::TAU;
use toolroom_infeed::{Infeed, Input, State, Structure, fastest_growing_wave, lag, wave};
use toolroom_process::ode::rk4;

/// One revolution over waves of unit height, in time: deflection `x = stiff part + mode`,
/// `q'' + 2 ζ ω q' + ω² q = ω² s F/J`, `F = Cp h`, `h = −x − r_before`. Returns the amplitude of
/// the wave that is left over the second half of the revolution.
fn amplitude_after_one_revolution(structure: &Structure, lobes: f64) -> f64 {
    let p = Infeed::default().parameters;
    let ratio = p.process_stiffness / p.system_stiffness;
    let omega = TAU * structure.natural_frequency;
    let wave_frequency = lobes * 292.0 / 60.0;
    let share = structure.modal_share;
    let before = |t: f64| (TAU * wave_frequency * t).cos();
    // The stiff part follows at once: x = q + (1 − s) (Cp/J) h.
    let stiff = (1.0 - share) * ratio;
    let depth = |t: f64, q: f64| (-q - before(t)) / (1.0 + stiff);
    let rhs = |t: f64, y: &[f64; 2]| {
        let force = share * ratio * depth(t, y[0]);
        [y[1], omega * omega * (force - y[0]) - 2.0 * structure.damping_ratio * omega * y[1]]
    };
    let period = 60.0 / 292.0;
    let steps = 200_000;
    let step = period / f64::from(steps);
    let mut y = [0.0, 0.0];
    let (mut cosine, mut sine) = (0.0, 0.0);
    for i in 0..steps {
        let t = f64::from(i) * step;
        y = rk4(rhs, t, &y, step);
        if i >= steps / 2 {
            // The surface left is where the wheel is: −x.
            let t = t + step;
            let left = before(t) + depth(t, y[0]);
            cosine += left * (TAU * wave_frequency * t).cos();
            sine += left * (TAU * wave_frequency * t).sin();
        }
    }
    cosine.hypot(sine) / f64::from(steps / 4)
}

#[test]
fn waves_grow_as_the_equation_of_motion_says() {
    for (share, damping_ratio, lobes) in
        [(1.0, 0.06, 4.0), (1.0, 0.06, 24.0), (1.0, 0.06, 36.0), (0.2, 0.06, 26.0), (0.5, 0.1, 30.0), (0.2, 0.05, 80.0)]
    {
        let structure = Structure { modal_share: share, damping_ratio, ..Structure::default() };
        let growth = wave(&Infeed::default(), &State::default(), &Input::default(), &structure, lobes);
        let growth = growth.expect("inside the domain").growth;
        let simulated = amplitude_after_one_revolution(&structure, lobes);
        assert!((growth / simulated - 1.0).abs() < 0.02, "{growth} by formula, {simulated} in time, {lobes} lobes");
    }
}

#[test]
fn slow_waves_die_out_by_the_lag_and_fast_ones_by_the_stiff_share() {
    let (grinding, input) = (Infeed::default(), Input::default());
    let structure = Structure { modal_share: 0.4, ..Structure::default() };
    let growth =
        |lobes| wave(&grinding, &State::default(), &input, &structure, lobes).expect("inside the domain").growth;
    let p = &grinding.parameters;
    let k = lag(p.process_stiffness, p.system_stiffness);
    assert!((growth(1e-6) / k - 1.0).abs() < 1e-9);
    let stiff = lag(p.process_stiffness, p.system_stiffness / 0.6);
    assert!((growth(1e6) / stiff - 1.0).abs() < 1e-6);
}

#[test]
fn a_mode_that_carries_the_whole_compliance_chatters_and_a_small_one_does_not() {
    let fastest = |modal_share, damping_ratio| {
        let structure = Structure { modal_share, damping_ratio, ..Structure::default() };
        fastest_growing_wave(&Infeed::default(), &State::default(), &Input::default(), &structure, 100)
            .expect("inside the domain")
    };
    let all = fastest(1.0, 0.05);
    // The greatest growth of one mode is near β = √(1 + Cp/J), about (Cp/J)/(2 ζ β).
    let ratio = 38.3747 / 31.019;
    let beta = f64::sqrt(1.0 + ratio);
    assert!((all.frequency / (120.0 * beta) - 1.0).abs() < 0.03, "{all:?}");
    assert!((all.growth / (ratio / (2.0 * 0.05 * beta)) - 1.0).abs() < 0.05, "{all:?}");
    assert!(fastest(0.05, 0.05).growth < 1.0);
}

#[test]
fn what_cannot_be_is_refused() {
    let (grinding, wheel, input) = (Infeed::default(), State::default(), Input::default());
    let structure = Structure::default();
    assert!(fastest_growing_wave(&grinding, &wheel, &input, &structure, 0).is_err());
    let still = Input { work_rotation_speed: 0.0, ..input };
    assert!(wave(&grinding, &wheel, &still, &structure, 3.0).is_err());
    let rigid = Structure { damping_ratio: f64::NAN, ..structure };
    assert!(wave(&grinding, &wheel, &input, &rigid, 3.0).is_err());
}

proptest! {
    /// More damping never lets the worst wave grow faster.
    #[test]
    fn damping_calms(share in 0.05..1.0f64, damping in 0.01..0.2f64) {
        let growth = |damping_ratio| {
            let structure = Structure { modal_share: share, damping_ratio, ..Structure::default() };
            fastest_growing_wave(&Infeed::default(), &State::default(), &Input::default(), &structure, 120)
                .map_or(f64::NAN, |wave| wave.growth)
        };
        prop_assert!(growth(1.5 * damping) <= growth(damping) * (1.0 + 1e-12));
    }
}
