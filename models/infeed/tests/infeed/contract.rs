//! Plunge grinding under the contract of all processes, and its effects.

use crate::paper::{REVOLUTION, everything};
use num_dual::Dual64;
use proptest::prelude::*;
use toolroom_effects::{Effect, Effects, Sign};
use toolroom_infeed::{Infeed, Input, Output, Parameters, State, stock_after};
use toolroom_process::{Process, ProcessEvent, Record, num_dual, process_contract};

fn points() -> Vec<(Input, f64)> {
    let input = Input::default();
    vec![
        (input, 16.0 * REVOLUTION),
        (input, 3.0),
        (Input { infeed_per_rev: 0.0, ..input }, 1.0),
        (Input { infeed_per_rev: 1.0e-6, coolant_factor: 0.75, friction_factor: 0.9, ..input }, 7.77),
        (Input { coolant_age: 4e5, coolant_changed: 1.0, process_stiffness_factor: 1.1, ..input }, 5.0),
        (Input { work_rotation_speed: 0.0, ..input }, 10.0),
        (Input { engaged: 0.0, ..input }, 10.0),
        // Deep enough to burn, long enough to need dressing.
        (Input { infeed_per_rev: 12e-6, ..input }, 20.0),
        (Input { infeed_per_rev: 5e-6, ..input }, 600.0),
    ]
}

process_contract!(the_paper_machine, Infeed::default(), points());
process_contract!(with_everything, everything(), points());

/// A wheel in the middle of its life, the coolant neither fresh nor nominal.
fn trial(grinding: &Infeed) -> (State, Output, Output) {
    let wheel = State { removed_volume: 0.5e-3, ..grinding.initial() };
    let time = 100.0 * 3600.0;
    let input = Input { coolant_age: time, coolant_changed: 1.0, machine_time: time, ..Input::default() };
    let spark_out = Input { infeed_per_rev: 0.0, ..input };
    let mut part = wheel;
    grinding.advance(&mut part, &input, 16.0 * REVOLUTION).expect("inside the domain");
    let rough = grinding.output(&part, &input);
    grinding.advance(&mut part, &spark_out, 6.0 * REVOLUTION).expect("inside the domain");
    (part, rough, grinding.output(&part, &spark_out))
}

#[test]
fn an_effect_of_size_zero_is_absent_bit_for_bit() {
    let off = Infeed { effects: Effects::every(Infeed::NAME), ..Infeed::default() };
    assert!(off.effects.iter().count() >= 4);
    assert_eq!(trial(&off), trial(&Infeed::default()));
}

#[test]
fn an_effect_moves_the_channels_that_its_catalogue_row_names() {
    let mut nominal = Infeed::default();
    nominal.parameters.burn_temperature_rise = 3000.0;
    let (_, rough, end) = trial(&nominal);
    for effect in Effects::every(Infeed::NAME).iter() {
        let entry = effect.entry();
        let effects = Effects::new(vec![effect.with_size(entry.size.max * 1e-2)]).expect("one effect");
        let (_, with_rough, with_end) = trial(&Infeed { effects, ..nominal.clone() });
        let mut seen = 0;
        for channel in entry.channels {
            let difference = match (channel.channel, Output::<f64>::index_of(channel.channel)) {
                ("force_after_spark_out", _) => with_end.normal_force - end.normal_force,
                (_, Some(i)) => with_rough.get(i).unwrap_or(f64::NAN) - rough.get(i).unwrap_or(f64::NAN),
                _ => continue,
            };
            seen += 1;
            let expected = if channel.sign == Sign::Rises { 1.0 } else { -1.0 };
            assert!(difference * expected > 0.0, "{}: {} moves by {difference}", entry.id, channel.channel);
        }
        assert!(seen > 0, "{} shows in no output", entry.id);
    }
}

#[test]
fn effects_of_other_processes_are_refused() {
    let wear = Effects::new(vec![Effect::named("wear_force").expect("in the catalogue")]).expect("one effect");
    assert!(Infeed::new(Parameters::default(), wear).is_err());
}

#[test]
fn burn_is_raised_once_at_the_end_of_its_revolution() {
    let grinding = Infeed::default();
    let input = Input { infeed_per_rev: 8e-6, ..Input::default() };
    let mut part = grinding.initial();
    let first = grinding.advance(&mut part, &input, 20.0 * REVOLUTION).expect("inside the domain");
    assert_eq!(first.event, Some(ProcessEvent::Burn));
    // 650 K needs 5.09 um; h = 8 um (1 - K^i) passes it in the second revolution (5.55 um).
    assert!((first.elapsed - 2.0 * REVOLUTION).abs() < 1e-9, "{first:?}");
    assert_eq!(part.revolution_phase, 0.0);
    let rest = grinding.advance(&mut part, &input, 18.0 * REVOLUTION).expect("inside the domain");
    assert_eq!(rest.event, None);
}

#[test]
fn the_next_part_keeps_the_wheel_and_dressing_renews_it() {
    let grinding = everything();
    let (part, ..) = trial(&grinding);
    let next = grinding.new_part(&part);
    assert_eq!((next.stock_removed, next.commanded_infeed, next.revolutions), (0.0, 0.0, 0.0));
    assert_eq!((next.wheel_wear, next.removed_volume), (part.wheel_wear, part.removed_volume));
    assert!(next.wheel_wear > 0.0);
    let dressed = grinding.dress(&part);
    assert_eq!((dressed.wheel_wear, dressed.removed_volume), (0.0, 0.0));
    assert_eq!(dressed.stock_removed, part.stock_removed);
}

#[test]
fn dressing_comes_due_after_the_parts_that_the_limit_allows() {
    let mut grinding = Infeed::default();
    grinding.parameters.dressing_limit = 3.0e-5;
    let mut wheel = grinding.initial();
    let mut parts = 0;
    loop {
        let mut left = 20.0 * REVOLUTION;
        let mut due = false;
        while left > 0.0 {
            let advance = grinding.advance(&mut wheel, &Input::default(), left).expect("inside the domain");
            due |= advance.event == Some(ProcessEvent::DressingDue);
            left -= advance.elapsed;
        }
        parts += 1;
        if due {
            break;
        }
        wheel = grinding.new_part(&wheel);
    }
    // 83.1 um of stock on 50 mm are 13.06 mm3/mm a part.
    assert_eq!(parts, 3);
}

/// dP/dK = -S dg/dK with the reference values of dg/dK.
#[test]
fn the_slope_of_stock_in_the_lag_is_exact() {
    for (revolutions, slope) in [(2.0, 2.106), (4.0, 3.69988), (8.0, 4.80448), (16.0, 5.00166), (30.0, 5.00478)] {
        let stock = stock_after(Dual64::from(1.0), Dual64::from(revolutions), Dual64::from(0.553).derivative());
        assert!((-stock.eps / slope - 1.0).abs() < 1e-5, "{} at {revolutions}", stock.eps);
    }
}

#[test]
fn the_recursion_carries_the_same_slope_as_the_closed_form() {
    let grinding = Infeed::default();
    let mut dual = grinding.map(Dual64::from);
    dual.parameters.process_stiffness = dual.parameters.process_stiffness.derivative();
    let input = Input::default().map(Dual64::from);
    let mut part = State::default().map(Dual64::from);
    for _ in 0..12 {
        part.commanded_infeed += input.infeed_per_rev;
        part = dual.revolution(&part, &input);
    }
    let lag = toolroom_infeed::lag(dual.parameters.process_stiffness, dual.parameters.system_stiffness);
    let closed = stock_after(input.infeed_per_rev, Dual64::from(12.0), lag);
    assert!((part.stock_removed.eps / closed.eps - 1.0).abs() < 1e-9, "{} and {}", part.stock_removed, closed);
}

proptest! {
    #[test]
    fn stock_never_exceeds_what_was_commanded(
        steps in prop::collection::vec((0.0..10e-6f64, 0.0..3.0f64), 1..12),
        cp in 1e6..1e9f64, j in 1e6..1e9f64, threshold_force in 0.0..100.0f64,
    ) {
        let parameters = Parameters { process_stiffness: cp, system_stiffness: j, threshold_force, ..Parameters::default() };
        let grinding = Infeed { parameters, ..Infeed::default() };
        let mut part = grinding.initial();
        for (infeed_per_rev, duration) in steps {
            let input = Input { infeed_per_rev, ..Input::default() };
            let before = part.stock_removed;
            let advance = grinding.advance(&mut part, &input, duration).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert!(advance.elapsed <= duration);
            prop_assert!(part.stock_removed >= before);
            prop_assert!(part.stock_removed <= part.commanded_infeed * (1.0 + 1e-12));
            prop_assert!(grinding.output(&part, &input).check().is_ok());
        }
    }

    #[test]
    fn any_split_of_a_cycle_gives_the_same_part(cuts in prop::collection::vec(0.01..1.0f64, 1..20)) {
        let grinding = everything();
        let total = 25.0 * REVOLUTION;
        let input = Input { infeed_per_rev: 2e-6, ..Input::default() };
        let mut whole = grinding.initial();
        grinding.advance(&mut whole, &input, total).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let mut parts = grinding.initial();
        let sum: f64 = cuts.iter().sum();
        for cut in &cuts {
            grinding.advance(&mut parts, &input, total * cut / sum).map_err(|error| TestCaseError::fail(error.to_string()))?;
        }
        prop_assert_eq!(whole.revolutions, parts.revolutions);
        prop_assert!((whole.stock_removed / parts.stock_removed - 1.0).abs() < 1e-9);
        prop_assert!((whole.removed_volume / parts.removed_volume - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_part_of_what_a_revolution_gives_is_the_same_by_itself() {
    let threshold = Parameters { threshold_force: 20.0, ..Parameters::default() };
    let plain = Infeed::default();
    for process in [plain.clone(), Infeed { parameters: threshold, ..plain }, everything()] {
        let u = Input::default();
        let mut part = process.initial();
        // In the first revolutions the wheel rubs under the threshold.
        for _ in 0..6 {
            part.commanded_infeed += 1.5e-6;
            let (whole, cold) = (process.revolution(&part, &u), process.cold_revolution(&part, &u));
            assert_eq!(State { peak_temperature_rise: part.peak_temperature_rise, ..whole }, cold);
            part = whole;
            assert_eq!(process.normal_force(&part, &u), process.output(&part, &u).normal_force);
        }
        assert!(part.peak_temperature_rise > 0.0);
    }
}
