//! The recursion against a reference implementation (six significant digits), and against the
//! paper's own numbers.

use crate::paper::{K, REVOLUTION, SIX_DIGITS, close, paper};
use toolroom_infeed::{
    Infeed, Input, Parameters, State, claims, deviation_after, lag, lag_time_constant, paper_eq8_contradicts_eq3,
    remaining_stiffness, revolutions_to, series_stiffness, stiffness_from_k, stock_after,
};
use toolroom_process::{Process, Record};

/// Grinds phases of (infeed per revolution in um, revolutions).
fn ground(grinding: &Infeed, start: State, phases: &[(f64, f64)]) -> State {
    let mut part = start;
    for (infeed, revolutions) in phases {
        let input = Input { infeed_per_rev: infeed * 1e-6, ..Input::default() };
        let mut left = revolutions * REVOLUTION;
        while left > 0.0 {
            // A burn stops the step and not the cycle.
            left -= grinding.advance(&mut part, &input, left).expect("inside the domain").elapsed;
        }
    }
    part
}

#[test]
fn the_inverse_of_eq_3_closes_and_eq_8_does_not() {
    let cp = 170.0 / 4.43e-6;
    let j = stiffness_from_k(cp, K);
    close(j, 3.1019e7, SIX_DIGITS);
    close(lag(cp, j), K, 1e-14);
    let printed = paper_eq8_contradicts_eq3(cp, K);
    close(printed, 1.71535e7, SIX_DIGITS);
    close(printed, K * j, 1e-14);
    close(lag(cp, printed), 0.691085, SIX_DIGITS);
    close(170.0 / j, 5.48051e-6, SIX_DIGITS);
    close(170.0 / printed, 9.91051e-6, SIX_DIGITS);
}

#[test]
fn the_series_of_springs_closes() {
    let j = stiffness_from_k(170.0 / 4.43e-6, K);
    for (c1, c3, c2) in [(100e6, 100e6, 81.7106e6), (80e6, 120e6, 87.6809e6)] {
        let found = remaining_stiffness(j, &[c1, c3]).expect("stiff enough");
        close(found, c2, SIX_DIGITS);
        close(series_stiffness(&[c1, found, c3]), j, 1e-12);
    }
    let printed = paper_eq8_contradicts_eq3(170.0 / 4.43e-6, K);
    close(remaining_stiffness(printed, &[100e6, 100e6]).expect("stiff enough"), 26.1116e6, SIX_DIGITS);
    assert!(remaining_stiffness(50e6, &[40e6]).is_err());
}

#[test]
fn the_rough_transient_is_the_reference_recursion() {
    let grinding = paper();
    let input = Input::default();
    let rows = [
        (1.0, 1.98021, 1.98021, 75.99, 35.76),
        (2.0, 3.07527, 5.05548, 118.012, 55.5353),
        (3.0, 3.68083, 8.73631, 141.251, 66.471),
        (4.0, 4.01571, 12.752, 154.102, 72.5185),
        (5.0, 4.2009, 16.9529, 161.208, 75.8627),
        (7.0, 4.35994, 25.6162, 167.311, 78.7348),
        (10.0, 4.41815, 38.8341, 169.545, 79.786),
        (16.0, 4.42966, 65.3999, 169.987, 79.9939),
    ];
    let grinding = Infeed { parameters: Parameters { friction: 80.0 / 170.0, ..grinding.parameters }, ..grinding };
    for (revolutions, depth, stock, normal, tangential) in rows {
        let part = ground(&grinding, grinding.initial(), &[(4.43, revolutions)]);
        let output = grinding.output(&part, &input);
        close(part.depth_of_cut, depth * 1e-6, SIX_DIGITS);
        close(part.stock_removed, stock * 1e-6, SIX_DIGITS);
        close(output.normal_force, normal, SIX_DIGITS);
        close(output.tangential_force, tangential, SIX_DIGITS);
        close(part.stock_removed, stock_after(4.43e-6, revolutions, K), 1e-12);
    }
}

#[test]
fn the_continuous_equivalents_have_their_numbers() {
    let cp = 170.0 / 4.43e-6;
    let tau = lag_time_constant(REVOLUTION, K);
    close(tau, 0.254206, SIX_DIGITS);
    close(tau, cp / (stiffness_from_k(cp, K) * (292.0 / 60.0)), 1e-12);
    close(toolroom_infeed::decay_time_constant(REVOLUTION, K), 0.346861, SIX_DIGITS);
    for (share, revolutions) in [(0.632121, 1.68806), (0.95, 5.05696), (0.98, 6.60372), (0.99, 7.77379)] {
        close(revolutions_to(share, K), revolutions, SIX_DIGITS);
    }
    close(1.0 - K.powi(10), 0.997325, SIX_DIGITS);
    close(paper().output(&State::default(), &Input::default()).rise_revolutions, 5.05696, SIX_DIGITS);
    // The first-order lag of that time constant differs from the recursion by up to 0.589 um.
    let difference = |i: f64| {
        let t = i * REVOLUTION;
        let ramp = 4.43e-6 / REVOLUTION * (t - tau * (1.0 - (-t / tau).exp()));
        (ramp - stock_after(4.43e-6, i, K)).abs()
    };
    close((1..=16).map(|i| difference(f64::from(i))).fold(0.0, f64::max), 0.58857e-6, SIX_DIGITS);
}

#[test]
fn the_temperature_is_the_reference_at_four_depths() {
    let grinding =
        Infeed { parameters: Parameters { friction: 80.0 / 170.0, ..paper().parameters }, ..Infeed::default() };
    for (depth, power, energy, rise) in [
        (4.43e-6, 2800.0, 41.3402e9, 585.533),
        (2.0e-6, 1264.11, 41.3402e9, 322.494),
        (1.0e-6, 632.054, 41.3402e9, 191.756),
        (8.0e-6, 5056.43, 41.3402e9, 912.15),
    ] {
        let output = grinding.output(&State { depth_of_cut: depth, ..State::default() }, &Input::default());
        close(output.spindle_power, power, SIX_DIGITS);
        close(output.specific_energy, energy, SIX_DIGITS);
        close(output.temperature_rise, rise, SIX_DIGITS);
        close(output.burn_margin, 1.0 - rise / 650.0, 1e-4);
    }
    for (depth, rise) in [(5.09197e-6, 650.0), (1.42426e-6, 250.0)] {
        let output = grinding.output(&State { depth_of_cut: depth, ..State::default() }, &Input::default());
        close(output.temperature_rise, rise, SIX_DIGITS);
    }
}

/// Infeed, stock and size error in um, last depth in um, wear in um, last force in N.
#[test]
fn four_cycles_end_where_the_reference_ends() {
    let rough_finish: &[(f64, f64)] = &[(4.43, 12.0), (1.0, 8.0)];
    let spark_out: &[(f64, f64)] = &[(4.43, 12.0), (1.0, 8.0), (0.0, 4.0)];
    let cases = [
        (0.0, 0.0, rough_finish, [59.8858, 1.27421, 1.02997, 0.0, 39.5247]),
        (0.0, 0.0, spark_out, [61.0408, 0.119163, 0.0963216, 0.0, 3.69631]),
        (1.0 / 60.0, 0.0, spark_out, [60.9146, 0.245353, 0.0957435, 0.126906, 3.67413]),
        (0.0, 20.0, spark_out, [60.3961, 0.763929, 0.0963212, 0.0, 23.6963]),
    ];
    for (wheel_wear_ratio, threshold_force, phases, [stock, size_error, depth, wear, force]) in cases {
        let mut grinding = paper();
        grinding.parameters.wheel_wear_ratio = wheel_wear_ratio;
        grinding.parameters.threshold_force = threshold_force;
        let part = ground(&grinding, grinding.initial(), phases);
        let output = grinding.output(&part, &Input { infeed_per_rev: 0.0, ..Input::default() });
        close(part.commanded_infeed, 61.16e-6, 1e-12);
        close(output.stock_removed, stock * 1e-6, SIX_DIGITS);
        close(output.size_error, size_error * 1e-6, SIX_DIGITS);
        close(output.roundness_error, depth * 1e-6, SIX_DIGITS);
        close(output.wheel_wear, wear * 1e-6, SIX_DIGITS);
        close(output.normal_force, force, SIX_DIGITS);
    }
}

#[test]
fn stock_of_the_phases_is_eq_1_and_exact_instead_of_eq_2() {
    let grinding = paper();
    let rough = ground(&grinding, grinding.initial(), &[(4.43, 12.0)]);
    let both = ground(&grinding, rough, &[(1.0, 8.0)]);
    close(rough.stock_removed, 47.684e-6, SIX_DIGITS);
    close(both.stock_removed - rough.stock_removed, 12.2018e-6, SIX_DIGITS);
    // Eq. (2) takes the rough phase as steady: S_r for the last rough depth.
    let eq_2 = stock_after(1e-6, 8.0, K) + 4.43e-6 * K * (1.0 - K.powi(8)) / (1.0 - K);
    close(eq_2, 12.2063e-6, SIX_DIGITS);
}

#[test]
fn waviness_decays_by_the_lag_each_revolution() {
    let grinding = paper();
    let even = ground(&grinding, grinding.initial(), &[(4.43, 10.0)]);
    // The same station of the circumference with 20 um more material on it.
    let proud = State { stock_removed: even.stock_removed - 20e-6, ..even };
    for (revolutions, left) in [(1.0, 11.06), (2.0, 6.11618), (4.0, 1.87038), (6.0, 0.57198), (8.0, 0.174917)] {
        let difference = ground(&grinding, even, &[(4.43, revolutions)]).stock_removed
            - ground(&grinding, proud, &[(4.43, revolutions)]).stock_removed;
        close(difference, left * 1e-6, SIX_DIGITS);
        close(deviation_after(20e-6, revolutions, K), left * 1e-6, SIX_DIGITS);
    }
}

/// The reference reads the spiral at 360 stations, of which the last is one station short of a
/// whole turn.
#[test]
fn an_abrupt_retraction_leaves_the_last_depth_as_a_step() {
    let grinding = paper();
    let rough = ground(&grinding, grinding.initial(), &[(4.43, 16.0)]);
    let sparked = ground(&grinding, rough, &[(0.0, 4.0)]);
    let step = |part: &State| grinding.output(part, &Input::default()).roundness_error * 359.0 / 360.0;
    close(step(&rough), 4.41736e-6, SIX_DIGITS);
    close(step(&sparked), 0.413107e-6, SIX_DIGITS);
}

/// 100 um of stock on 50 mm are 15.708 mm3/mm; the tenth part meets 1.09425 of the sharp wheel.
#[test]
fn the_wheel_dulls_as_the_dressing_study_says() {
    let mut grinding = paper();
    grinding.parameters.dulling_rate = 1.0 / 1.5e-3;
    let wheel = State { removed_volume: 9.0 * 15.708e-6, ..State::default() };
    let factor = grinding.output(&wheel, &Input::default()).process_stiffness / grinding.parameters.process_stiffness;
    close(factor, 1.09425, SIX_DIGITS);
    let part = ground(&grinding, State { removed_volume: 0.0, ..wheel }, &[(5.0, 20.0)]);
    close(part.removed_volume, std::f64::consts::PI * 0.05 * part.stock_removed, 1e-12);
}

#[test]
fn every_claim_passes() {
    let claims = claims().expect("shipped parameters are inside the domain");
    assert_eq!(claims.len(), 20);
    for claim in claims {
        assert!(claim.pass(), "{claim:?}");
    }
}

#[test]
fn the_defaults_are_the_shipped_set() {
    let shipped = Parameters::named("zb153u_40kh").expect("a shipped set");
    for (i, field) in Parameters::<f64>::FIELDS.iter().enumerate() {
        // The conversion of units may cost the last bit.
        close(shipped.get(i).expect("a parameter"), field.start, 1e-15);
    }
    let error = Parameters::named("zb153u").expect_err("no such set").to_string();
    assert!(error.contains("did you mean `zb153u_40kh`"), "{error}");
    assert!(Parameters::read("schema = 1\nname = \"x\"\ntitle = \"x\"\n[parameters.grinding]\n").is_err());
}
