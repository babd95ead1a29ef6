//! Properties that hold everywhere in the domain.

use proptest::prelude::*;
use toolroom_process::num_dual::{Dual64, DualNum, first_derivative};
use toolroom_process::{AnyRecord, Record, unit};
use toolroom_wear::{
    Cut, ExtendedTaylor, Objective, PARAMETER_SETS, Pair, RampLimits, SpeedMode, TakeyamaMurata, Usui, WearLaw,
    WearState,
};

fn pairs() -> impl Strategy<Value = Pair> {
    (0..PARAMETER_SETS.len(), 0..4).prop_map(|(set, law)| {
        let mut pair = Pair::named(PARAMETER_SETS[set].0).unwrap();
        match law {
            1 => pair.law = WearLaw::ExtendedTaylor(ExtendedTaylor { stage_tilt: 0.3, ..ExtendedTaylor::default() }),
            2 => {
                pair.law =
                    WearLaw::TakeyamaMurata(TakeyamaMurata { run_in_land: 0.08e-3, ..TakeyamaMurata::default() });
            }
            3 => pair.law = WearLaw::Usui(Usui::default()),
            _ => {}
        }
        pair
    })
}

fn cuts() -> impl Strategy<Value = Cut> {
    ((0.0..10.0f64), (0.02e-3..1e-3f64), (0.05e-3..6e-3f64), (0.7..1.4f64), (0.3..3.0f64), (0.3..3.0f64)).prop_map(
        |(cutting_speed, feed_per_rev, depth_of_cut, hardness, mechanical_factor, thermal_factor)| Cut {
            hardness,
            mechanical_factor,
            thermal_factor,
            ..Cut::nominal(cutting_speed, feed_per_rev, depth_of_cut)
        },
    )
}

/// Multiplies every number by the size of its unit in another system of base units.
fn rescale(record: &mut dyn AnyRecord) {
    // One metre of the new system is 1/3 m and so on; deliberately no powers of ten.
    const BASE: [f64; 8] = [3.0, 0.7, 1.7, 1.3, 2.1, 1.0, 1.0, 1.0];
    for (i, field) in record.fields().iter().enumerate() {
        let dimension = unit::parse(field.unit).unwrap().dimension;
        let scale: f64 = BASE.iter().zip(dimension).map(|(base, power)| base.powi(i32::from(power))).product();
        if let Some(value) = record.value(i) {
            record.set_value(i, value * scale);
        }
    }
}

fn rescaled<R: Record>(record: R) -> R {
    let mut other = record;
    rescale(&mut other);
    other
}

fn assert_close<R: Record>(computed: R, expected: R, relative: f64) {
    for (i, field) in R::FIELDS.iter().enumerate() {
        let (a, b) = (computed.get(i).unwrap(), expected.get(i).unwrap());
        assert!((a - b).abs() <= relative * a.abs().max(b.abs()), "{}: {a}, expected {b}", field.name);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn other_units_give_the_same_physics(pair in pairs(), cut in cuts(), wear in 0.0..1e-3f64) {
        let mut other = pair.clone();
        for (_, group) in other.parameters_mut() {
            rescale(group);
        }
        let state = WearState { body_temperature_rise: 300.0, thermal_damage: 0.1, path: 100.0, ..WearState::mounted(wear) };
        let effects = Cut { damage_gain: 0.5, damage_rate: 0.01, chipping_rate: 1e-3, ..cut };
        // The balance is a difference: compared on the scale of its terms, not of itself.
        let unbalanced = |mut point: toolroom_wear::Point| { point.wear_balance = 0.0; point };
        assert_close(unbalanced(other.output(&rescaled(state), &rescaled(effects))), unbalanced(rescaled(pair.output(&state, &effects))), 1e-9);
        let slope = pair.derivative(&state, &effects);
        let other_slope = other.derivative(&rescaled(state), &rescaled(effects));
        for (i, field) in WearState::<f64>::FIELDS.iter().enumerate() {
            // A rate has one time more in its denominator.
            let (a, b) = (other_slope.get(i).unwrap() * 1.7, rescaled(slope).get(i).unwrap());
            prop_assert!((a - b).abs() <= 1e-9 * a.abs().max(b.abs()), "{}: {a}, {b}", field.name);
        }
    }

    #[test]
    fn the_balance_is_the_slope_of_wear_per_path(pair in pairs(), cut in cuts(), wear in 0.0..1e-3f64) {
        prop_assume!(cut.cutting_speed > 0.05);
        let dual = pair.map(Dual64::from);
        let intensity = |ln_speed: Dual64| {
            let moving = Cut { cutting_speed: ln_speed.exp(), ..cut.map(Dual64::from) };
            dual.point(&moving, Dual64::from(wear)).wear_intensity
        };
        let (_, slope) = first_derivative(intensity, cut.cutting_speed.ln());
        let point = pair.point(&cut, wear);
        // wear_balance is the slope over the sum of its two terms.
        let law = pair.contact(&cut);
        let theta = law.steady_temperature(wear);
        let chi = law.speed_sensitivity(wear, theta);
        let (mechanical, thermal) = match &pair.law {
            WearLaw::EnergyBalance(balance) => balance.weights(theta, chi),
            WearLaw::TakeyamaMurata(diffusion) => (0.0, diffusion.activation_energy / (diffusion.gas_constant * theta) * chi - 1.0),
            WearLaw::ExtendedTaylor(taylor) => (1.0 - taylor.speed_exponent, 0.0),
            WearLaw::Usui(adhesion) => (-adhesion.activation_temperature / theta * chi, 0.0),
        };
        let first = mechanical * point.mechanical_wear_per_path;
        let second = thermal * point.thermal_wear_rate / cut.cutting_speed;
        let scale = first.abs() + second.abs();
        prop_assert!((-slope - (first - second)).abs() <= 1e-9 * scale.max(point.wear_intensity), "{slope}, {first}, {second}");
        prop_assert!((point.wear_balance * scale - (first - second)).abs() <= 1e-9 * scale);
    }

    #[test]
    fn nothing_is_undefined_inside_the_domain(pair in pairs(), cut in cuts(), wear in 0.0..2e-3f64, engaged in 0..2) {
        let cut = Cut { engaged: f64::from(engaged), ..cut };
        let state = WearState { body_temperature_rise: 500.0, thermal_damage: 0.3, ..WearState::mounted(wear) };
        pair.output(&state, &cut).check().unwrap();
        let slope = pair.derivative(&state, &cut);
        for i in 0..WearState::<f64>::LEN {
            prop_assert!(slope.get(i).unwrap().is_finite());
        }
        prop_assert!(slope.flank_wear >= 0.0);
        let duals = pair.map(Dual64::from).derivative(&state.map(|x| Dual64::new(x, 1.0)), &cut.map(|x| Dual64::new(x, 1.0)));
        prop_assert!(duals.flank_wear.eps.is_finite() && duals.body_temperature_rise.eps.is_finite());
    }

    #[test]
    fn speeds_and_plans_respect_the_limits(pair in pairs(), cut in cuts(), wear in 0.0..0.9f64, path in 1.0..400.0f64, mode in 0..4, last in 0.1..5.0f64) {
        let wear = wear * pair.limits.wear_limit;
        let mode = match mode {
            0 => SpeedMode::MinimumWear,
            1 => SpeedMode::LiteralBalance,
            2 => SpeedMode::SetIncrement { wear_increment: 0.05e-3 },
            _ => SpeedMode::ShadowPrice { shadow_price: 3.0 },
        };
        let ramp = RampLimits::default();
        let last = pair.limits.clip(last);
        let plan = pair.plan_pass(&cut, wear, path, mode, &ramp, Some(last));
        prop_assert!(plan.wear_increment.is_finite() && plan.wear_increment >= 0.0);
        prop_assert!((plan.start_speed - last).abs() <= ramp.largest_step * (1.0 + 1e-12));
        prop_assert!(plan.acceleration.abs() <= ramp.largest_acceleration * (1.0 + 1e-9));
        for speed in [plan.start_speed, plan.end_speed] {
            prop_assert!(speed >= pair.limits.lowest_speed * (1.0 - 1e-12) && speed <= pair.limits.highest_speed * (1.0 + 1e-12));
        }
    }

    #[test]
    fn no_speed_wears_less_than_the_minimum_wear_speed(set in 0..PARAMETER_SETS.len(), wear in 0.0..0.6e-3f64, other in 0.12..5.5f64, hardness in 0.9..1.1f64) {
        let pair = Pair::named(PARAMETER_SETS[set].0).unwrap();
        let cut = Cut { hardness, ..pair.reference_cut() };
        let intensity = |speed: f64| pair.point(&cut.at_speed(speed), wear).wear_intensity;
        let least = intensity(pair.minimum_wear_speed(&cut, wear));
        prop_assert!(least <= intensity(other * pair.limits.reference_speed) * (1.0 + 1e-12));
    }

    #[test]
    fn mode_1_outlasts_the_best_constant_speed(set in 0..PARAMETER_SETS.len(), hardness in 0.9..1.1f64, feed in 0.7..1.4f64) {
        let pair = Pair::named(PARAMETER_SETS[set].0).unwrap();
        let mut cut = Cut { hardness, ..pair.reference_cut() };
        cut.feed_per_rev *= feed;
        let best = pair.best_constant_speed(&cut, Objective::Path);
        prop_assert!(pair.minimum_wear_life(&cut).path >= best.life.path);
    }
}

#[test]
fn quadrature_and_integration_in_time_agree() {
    for (name, _) in PARAMETER_SETS {
        let mut pair = Pair::named(name).unwrap();
        pair.temperature.body_share = 0.0; // no body: the quasi-steady life is exact
        pair.temperature.collapse_temperature = 5000.0;
        for share in [0.6, 1.0, 1.5] {
            let cut = pair.reference_cut();
            let cut = cut.at_speed(share * cut.cutting_speed);
            let life = pair.life(&cut);
            let run = pair.run(&WearState::default(), |_, _| cut, 1e6, 1e-11).unwrap();
            assert!((life.cutting_time / run.elapsed - 1.0).abs() < 1e-7, "{name}: {life:?}, {run:?}");
            assert!((life.mechanical_wear / run.state.mechanical_wear - 1.0).abs() < 1e-7);
            assert!((run.state.mechanical_wear + run.state.thermal_wear - run.state.flank_wear).abs() < 1e-12);
        }
    }
}

#[test]
fn trajectories_converge_with_their_tolerance() {
    let pair = Pair::default();
    let life =
        |relative: f64| pair.run(&WearState::default(), |_, _| pair.reference_cut(), 1e5, relative).unwrap().elapsed;
    let exact = life(1e-12);
    for relative in [1e-5, 1e-7, 1e-9] {
        let error = (life(relative) / exact - 1.0).abs();
        assert!(error < 10.0 * relative, "tolerance {relative}: error {error}");
    }
}

#[test]
fn neutral_multipliers_change_no_bit() {
    let pair = Pair::default();
    let cut = pair.reference_cut();
    let strange = Cut { damage_rate: 0.5 / 60.0, damage_gain: 0.0, ..cut }; // memory without effect
    let run = |cut: Cut| pair.run(&WearState::default(), |_, _| cut, 300.0, 1e-8).unwrap();
    assert_eq!(run(cut), run(strange));
    let point = pair.point(&cut, 0.2e-3);
    let law = pair.law.map(|x| x * 1.0 + 0.0);
    assert_eq!(Pair { law, ..pair.clone() }.point(&cut, 0.2e-3), point);
}

#[test]
fn the_default_pair_is_the_shipped_set() {
    let mut shipped = Pair::named("ni_vk6om").unwrap();
    let mut built_in = Pair::default();
    for ((group, shipped), (_, built_in)) in shipped.parameters_mut().into_iter().zip(built_in.parameters_mut()) {
        for (i, field) in shipped.fields().iter().enumerate() {
            let (a, b) = (shipped.value(i).unwrap(), built_in.value(i).unwrap());
            assert!((a - b).abs() <= 1e-12 * b.abs(), "{group}.{}: {a} in the file, {b} in code", field.name);
        }
    }
}

#[test]
fn a_faulty_parameter_file_is_refused_with_the_likely_fix() {
    let text = PARAMETER_SETS[0].1;
    let message = |text: String| Pair::read(&text).unwrap_err().to_string();
    assert!(
        message(text.replace("[parameters.force]", "[parameters.forces]")).contains("did you mean [parameters.force]")
    );
    assert!(message(text.replace("[parameters.chipping]", "[parameters.extended_taylor]")).contains("2 wear laws"));
    assert!(message(text.replace("\"0.6 mm\", source = \"P", "\"0.6 min\", source = \"P")).contains("wear_limit"));
    assert!(message(text.replace("chip_heating = ", "chip_heat = ")).contains("chip_heat"));
}

#[test]
fn every_constant_has_a_source() {
    for (name, text) in PARAMETER_SETS {
        let file = toolroom_process::parameters::ParameterFile::read(text).unwrap();
        assert_eq!(file.name, *name);
        for (group, entries) in &file.groups {
            for (entry, value) in entries {
                assert!(value.get_ref().source.len() > 3, "{name}: [parameters.{group}] {entry} has no source");
            }
        }
    }
}

#[test]
fn a_taylor_edge_lasts_its_taylor_life() {
    let taylor = ExtendedTaylor { wear_limit: 0.6e-3, ..ExtendedTaylor::default() };
    let pair = Pair { law: WearLaw::ExtendedTaylor(taylor), ..Pair::default() };
    let cut = Cut::nominal(3.0, 0.3e-3, 1.5e-3);
    assert!((pair.life(&cut).cutting_time / taylor.tool_life(&cut) - 1.0).abs() < 1e-9);
}

#[test]
fn the_tilt_of_the_wear_curve_leaves_the_life_and_is_bounded() {
    let cut = Cut::nominal(3.0, 0.3e-3, 1.5e-3);
    for (stage_contrast, stage_tilt) in [(0.6, 0.38), (0.6, -0.38), (0.0, 0.95), (0.95, 0.0475)] {
        let law = ExtendedTaylor { wear_limit: 0.6e-3, stage_contrast, stage_tilt, ..ExtendedTaylor::default() };
        let pair = Pair { law: WearLaw::ExtendedTaylor(law), ..Pair::default() };
        pair.law.check().unwrap();
        assert!((pair.life(&cut).cutting_time / law.tool_life(&cut) - 1.0).abs() < 1e-7);
        let steeper = ExtendedTaylor { stage_tilt: stage_tilt * 1.01 + 1e-3, ..law };
        assert!(stage_tilt < 0.0 || WearLaw::ExtendedTaylor(steeper).check().is_err());
    }
}

#[test]
fn an_edge_at_rest_neither_wears_nor_breaks_the_equations() {
    for (name, _) in PARAMETER_SETS {
        let pair = Pair::named(name).unwrap();
        let cut = pair.reference_cut().at_speed(0.0);
        let state = WearState::mounted(0.1e-3);
        pair.output(&state, &cut).check().unwrap();
        let dual = pair.map(Dual64::from);
        let slope = dual.derivative(&state.map(Dual64::from), &cut.map(|x| Dual64::new(x, 1.0)));
        assert!(slope.flank_wear.re < 1e-20 && slope.flank_wear.eps.is_finite(), "{name}: {slope:?}");
    }
}
