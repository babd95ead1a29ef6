//! The delay form with profile and the first-order forms: against the recursion, the reference
//! tables, and the contract.

use crate::paper::{K, REVOLUTION, SIX_DIGITS, close, everything, paper};
use proptest::prelude::*;
use toolroom_infeed::{
    FirstOrderState, Infeed, InfeedFirstOrder, InfeedProfile, Input, ProfileState, STATIONS, State, TimeConstant,
    stock_after,
};
use toolroom_process::{Process, ProcessEvent, Record, process_contract};

fn points() -> Vec<(Input, f64)> {
    let input = Input::default();
    vec![
        (input, 16.0 * REVOLUTION),
        (Input { infeed_per_rev: 0.0, ..input }, 1.0),
        (Input { infeed_per_rev: 1.0e-6, coolant_factor: 0.75, friction_factor: 0.9, ..input }, 7.77),
        (Input { coolant_age: 4e5, coolant_changed: 1.0, process_stiffness_factor: 1.1, ..input }, 5.0),
        (Input { work_rotation_speed: 0.0, ..input }, 10.0),
        (Input { engaged: 0.0, ..input }, 10.0),
        (Input { infeed_per_rev: 12e-6, ..input }, 20.0),
    ]
}

/// Dressing instead of burn: an event that is located leaves a burn margin of nothing but
/// rounding, which no change of units can be expected to keep.
fn cool_points() -> Vec<(Input, f64)> {
    let input = Input::default();
    let mut points = points();
    points.pop();
    points.push((Input { infeed_per_rev: 0.5e-6, ..input }, 3000.0));
    points
}

fn fireproof(mut grinding: Infeed) -> Infeed {
    grinding.parameters.burn_temperature_rise = 3000.0;
    grinding
}

process_contract!(profile, InfeedProfile { grinding: paper() }, points());
process_contract!(profile_with_everything, InfeedProfile { grinding: everything() }, points());
process_contract!(
    first_order_lag,
    InfeedFirstOrder { grinding: paper(), ..InfeedFirstOrder::default() },
    cool_points()
);
process_contract!(
    first_order_decay,
    InfeedFirstOrder { grinding: fireproof(everything()), time_constant: TimeConstant::Decay },
    cool_points()
);

/// Grinds phases of (infeed per revolution in um, revolutions), burnt or not.
fn ground<P: Process<Input = Input>>(process: &P, start: P::State, phases: &[(f64, f64)]) -> P::State {
    let mut part = start;
    for (infeed, revolutions) in phases {
        let input = Input { infeed_per_rev: infeed * 1e-6, ..Input::default() };
        let mut left = revolutions * REVOLUTION;
        while left > 0.0 {
            left -= process.advance(&mut part, &input, left).expect("inside the domain").elapsed;
        }
    }
    part
}

#[test]
fn the_delay_form_is_the_recursion_at_whole_revolutions() {
    let mut rubbing = paper();
    rubbing.parameters.threshold_force = 30.0;
    for grinding in [paper(), rubbing] {
        let delay = InfeedProfile { grinding: grinding.clone() };
        for phases in [&[(4.43, 1.0)][..], &[(4.43, 12.0), (1.0, 8.0)], &[(4.43, 12.0), (1.0, 8.0), (0.0, 4.0)]] {
            let profile = ground(&delay, delay.initial(), phases);
            let recursion = ground(&grinding, grinding.initial(), phases);
            assert_eq!(profile.station, 359.0);
            close(profile.profile[STATIONS - 1], recursion.stock_removed, 1e-11);
            close(profile.depth_of_cut, recursion.depth_of_cut, 1e-9);
            close(profile.revolutions, recursion.revolutions, 1e-12);
            // Outputs of one name mean the same.
            let (one, other) =
                (delay.output(&profile, &Input::default()), grinding.output(&recursion, &Input::default()));
            close(one.stock_removed, other.stock_removed, 1e-11);
            assert!((one.size_error - other.size_error).abs() < 1e-15, "{} {}", one.size_error, other.size_error);
        }
    }
}

#[test]
fn a_wheel_that_wears_differs_from_the_recursion_by_its_wear_within_a_revolution() {
    let mut grinding = paper();
    grinding.parameters.wheel_wear_ratio = 1.0 / 60.0;
    let delay = InfeedProfile { grinding: grinding.clone() };
    let profile = ground(&delay, delay.initial(), &[(4.43, 12.0)]);
    let recursion = ground(&grinding, grinding.initial(), &[(4.43, 12.0)]);
    let difference = profile.profile[STATIONS - 1] - recursion.stock_removed;
    // g h of one revolution: 1/480 of 4.4 um.
    assert!(difference.abs() < 4.43e-6 / 480.0 && difference != 0.0, "{difference}");
}

#[test]
fn the_spiral_has_the_reference_step() {
    let delay = InfeedProfile { grinding: paper() };
    let rough = ground(&delay, delay.initial(), &[(4.43, 16.0)]);
    let low_high = |x: &ProfileState| {
        x.profile.iter().fold((f64::INFINITY, 0.0f64), |(low, high), stock| (low.min(*stock), high.max(*stock)))
    };
    let (low, high) = low_high(&rough);
    close(low, 60.9825e-6, SIX_DIGITS);
    close(high, 65.3999e-6, SIX_DIGITS);
    close(high - low, 4.41736e-6, SIX_DIGITS);
    // The stations end one short of the turn; both sides of the step are the last depth apart, as in the recursion.
    close(rough.roundness_error(), 4.42966e-6, SIX_DIGITS);
    let spiral = high - low;
    let point = ground(&paper(), State::default(), &[(4.43, 16.0)]);
    let of_point = paper().output(&point, &Input::default()).roundness_error;
    close(delay.output(&rough, &Input::default()).roundness_error, of_point, 1e-12);
    let sparked = ground(&delay, rough, &[(0.0, 4.0)]);
    let (low, high) = low_high(&sparked);
    close(low, 69.9544e-6, SIX_DIGITS);
    close(high, 70.3675e-6, SIX_DIGITS);
    close(high - low, 0.413107e-6, SIX_DIGITS);
    close(sparked.roundness_error(), 0.413107e-6 * 360.0 / 359.0, SIX_DIGITS);
    // A gauge that averages the spiral reads half the last depth less.
    let mean = rough.mean_stock();
    close(stock_after(4.43e-6, 16.0, K) - mean, 0.5 * spiral, 1e-3);
}

#[test]
fn three_lobes_leave_the_reference_residual_for_contact_is_lost_at_first() {
    let delay = InfeedProfile { grinding: paper() };
    let even = ground(&delay, delay.initial(), &[(4.43, 16.0)]);
    let wavy = ground(&delay, ProfileState::wavy(2e-6, 3.0), &[(4.43, 16.0)]);
    let residual = |a: &ProfileState, b: &ProfileState| {
        a.profile.iter().zip(b.profile).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    close(residual(&wavy, &even), 0.000275874e-6, SIX_DIGITS);
    close(2e-6 * K.powi(16), 0.000152979e-6, SIX_DIGITS);
    // In full contact throughout, each revolution leaves exactly the share K.
    let mut settled = even;
    for (stock, wave) in settled.profile.iter_mut().zip(ProfileState::wavy(0.5e-6, 3.0).profile) {
        *stock += wave;
    }
    let (a, b) = (ground(&delay, settled, &[(4.43, 6.0)]), ground(&delay, even, &[(4.43, 6.0)]));
    close(residual(&a, &b), 0.5e-6 * K.powi(6), 1e-6);
}

#[test]
fn a_wheel_out_of_contact_cuts_nothing_and_presses_not() {
    let delay = InfeedProfile { grinding: paper() };
    let mut part = ProfileState::wavy(5e-6, 1.0);
    let input = Input::default();
    delay.advance(&mut part, &input, 0.1 * REVOLUTION).expect("inside the domain");
    // 0.44 um of infeed do not reach the hollow side.
    let output = delay.output(&part, &input);
    assert_eq!((output.depth_of_cut, output.normal_force, output.temperature_rise), (0.0, 0.0, 0.0));
    delay.advance(&mut part, &input, 0.4 * REVOLUTION).expect("inside the domain");
    assert!(delay.output(&part, &input).normal_force > 0.0);
}

#[test]
fn burn_is_raised_at_its_station() {
    let delay = InfeedProfile { grinding: paper() };
    let input = Input { infeed_per_rev: 8e-6, ..Input::default() };
    let mut part = delay.initial();
    let advance = delay.advance(&mut part, &input, 4.0).expect("inside the domain");
    assert_eq!(advance.event, Some(ProcessEvent::Burn));
    // 5.092 um lie between 8 (1 - K) and 8 (1 - K^2) um: within the second revolution.
    let share = (5.092 / 8.0 - (1.0 - K)) / (K - K * K);
    assert!((advance.elapsed / REVOLUTION - 1.0 - share).abs() < 1.5 / 360.0, "{advance:?}");
}

#[test]
fn the_first_order_forms_keep_what_they_promise() {
    let recursion = |i: i32| stock_after(4.43e-6, f64::from(i), K);
    let stock = |time_constant, i: i32| {
        let process = InfeedFirstOrder { grinding: paper(), time_constant };
        ground(&process, process.initial(), &[(4.43, f64::from(i))]).stock_removed
    };
    let worst = (1..=16).map(|i| (stock(TimeConstant::Lag, i) - recursion(i)).abs()).fold(0.0, f64::max);
    close(worst, 0.58857e-6, SIX_DIGITS);
    close(stock(TimeConstant::Lag, 40), recursion(40), 1e-9);
    // The decay form keeps the decay and pays with the lag behind the ramp.
    let process = InfeedFirstOrder { grinding: paper(), time_constant: TimeConstant::Decay };
    let rough = ground(&process, process.initial(), &[(4.43, 30.0)]);
    let left = |x: &FirstOrderState| x.commanded_infeed - x.stock_removed;
    close(left(&ground(&process, rough, &[(0.0, 4.0)])), left(&rough) * K.powi(4), 1e-7);
    let behind = recursion(40) - stock(TimeConstant::Decay, 40);
    close(behind, 4.43e-6 * (-1.0 / K.ln() - K / (1.0 - K)), 1e-6);
}

#[test]
fn burn_of_the_first_order_form_is_located() {
    let process = InfeedFirstOrder { grinding: paper(), ..InfeedFirstOrder::default() };
    let input = Input { infeed_per_rev: 8e-6, ..Input::default() };
    let mut part = process.initial();
    let advance = process.advance(&mut part, &input, 4.0).expect("inside the domain");
    assert_eq!(advance.event, Some(ProcessEvent::Burn));
    close(process.output(&part, &input).temperature_rise, 650.0, 1e-9);
}

#[test]
fn states_with_a_ring_are_saved_and_restored() {
    let delay = InfeedProfile { grinding: paper() };
    let part = ground(&delay, ProfileState::wavy(2e-6, 5.0), &[(4.43, 3.3)]);
    let mut saved = vec![0.0; ProfileState::LEN];
    part.write_to(&mut saved);
    assert_eq!(ProfileState::from_slice(&saved), part);
}

#[test]
fn the_temperature_of_a_rubbing_wheel_is_finite() {
    let mut grinding = paper();
    grinding.parameters.threshold_force = 40.0;
    let at = |depth_of_cut: f64| {
        let state = State { depth_of_cut, commanded_infeed: 20e-6, ..State::default() };
        grinding.output(&state, &Input::default()).temperature_rise
    };
    close(at(1e-12), at(0.0), 1e-3);
    assert!(at(0.0) > 50.0 && at(0.0) < at(1e-6));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    #[test]
    fn no_station_loses_material_it_does_not_have(
        amplitude in 0.0..20e-6f64, lobes in 0.0..20.0f64, infeed in 0.0..8e-6f64, turns in 0.1..6.0f64,
    ) {
        let delay = InfeedProfile { grinding: everything() };
        let start = ProfileState::wavy(amplitude, lobes);
        let part = ground(&delay, start, &[(infeed * 1e6, turns)]);
        for (before, after) in start.profile.iter().zip(part.profile) {
            prop_assert!(after >= *before);
            prop_assert!(after <= part.commanded_infeed.max(*before) + 1e-18);
        }
        prop_assert!(part.check().is_ok());
    }
}
