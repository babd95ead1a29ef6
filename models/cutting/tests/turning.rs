//! The process contract, the published lives and the neutrality of turning.

use proptest::prelude::*;
use toolroom_cutting::{LifeModel, Turning, TurningInput, TurningMemory, TurningState};
use toolroom_effects::{Effect, Effects};
use toolroom_process::num_dual::Dual64;
use toolroom_process::{Process, ProcessEvent, Record, process_contract};
use toolroom_wear::{ExtendedTaylor, WearLaw};

fn process() -> Turning {
    Turning::named("ni_vk6om").expect("a shipped set")
}

fn points() -> Vec<(TurningInput, f64)> {
    let base = TurningInput::default();
    vec![
        (base, 60.0),
        (TurningInput { cutting_speed: 1.2, feed_per_rev: 0.2e-3, depth_of_cut: 1.5e-3, ..base }, 30.0),
        (TurningInput { cutting_speed: 0.9, cutting_acceleration: -2e-3, hardness_ratio: 1.05, ..base }, 90.0),
        (TurningInput { engaged: 0.0, ..base }, 45.0),
    ]
}

process_contract!(contract, process(), points());

/// Cold-start life of the default set at 40 m/min, and its state at the end.
#[test]
fn the_life_of_a_cold_start_is_the_reference_value() {
    let (life, event) = process().life(&TurningInput::default(), LifeModel::Ode).expect("an edge that wears out");
    assert_eq!(event, ProcessEvent::WearLimit);
    let close = |computed: f64, expected: f64| assert!((computed / expected - 1.0).abs() < 1e-6, "{computed}");
    close(life.cutting_time / 60.0, 14.77972);
    close(life.mechanical_wear * 1e3, 0.21278695);
    close(life.thermal_wear * 1e3, 0.38721305);
}

/// Short steps are of third order and remember the one before: they add up to what long ones give.
#[test]
fn short_steps_add_up_to_a_long_one() {
    let (turning, u) = (process(), TurningInput::default());
    let wear = |count: u32| {
        let (mut x, mut memory) = (turning.initial(), TurningMemory::default());
        for _ in 0..count {
            turning.step(&mut x, &u, 200.0 / f64::from(count), &mut memory).expect("a step");
        }
        x.flank_wear
    };
    let (whole, tenths, hundredths) = (wear(1), wear(2000), wear(20_000));
    assert!((tenths / hundredths - 1.0).abs() < 3e-8, "{tenths:e}, {hundredths:e}");
    assert!((tenths / whole - 1.0).abs() < 5e-7, "{tenths:e}, {whole:e}");
}

/// What a step remembers belongs to its input.
#[test]
fn a_changed_input_is_not_mistaken_for_the_remembered_one() {
    let turning = process();
    let slow = TurningInput::default();
    let fast = TurningInput { cutting_speed: 0.9, ..slow };
    let (mut x, mut y, mut memory) = (turning.initial(), turning.initial(), TurningMemory::default());
    for u in [slow, slow, fast, fast, slow, TurningInput { engaged: 0.0, ..slow }, slow] {
        turning.step(&mut x, &u, 0.1, &mut memory).expect("a step");
        turning.advance(&mut y, &u, 0.1).expect("a step");
        assert_eq!(x, y);
    }
    assert!(turning.step(&mut x, &TurningInput { feed_per_rev: -1.0, ..slow }, 0.1, &mut memory).is_err());
    assert_eq!(x, y);
}

/// Quasi-steady lives: the state equations with a slaved body equal the quadrature.
#[test]
fn the_quasi_steady_life_is_that_of_the_quadrature() {
    for (set, speed, minutes) in [
        ("ni_vk6om", 20.0, 24.320973),
        ("ni_vk6om", 60.0, 5.43553),
        ("ni_vk6om_hb", 40.0, 21.02601),
        ("c45_t15k6", 180.0, 111.78606),
        ("ti_vk6", 50.0, 18.696459),
    ] {
        let turning = Turning::named(set).expect("a shipped set");
        let cut = turning.pair.reference_cut();
        let input = TurningInput {
            cutting_speed: speed / 60.0,
            feed_per_rev: cut.feed_per_rev,
            depth_of_cut: cut.depth_of_cut,
            ..TurningInput::default()
        };
        let (life, _) = turning.life(&input, LifeModel::QuasiSteady).expect("an edge that wears out");
        assert!(
            (life.cutting_time / 60.0 / minutes - 1.0).abs() < 1e-6,
            "{set} at {speed}: {}",
            life.cutting_time / 60.0
        );
    }
}

/// Taylor's law with its bent wear curve: 60 min at the reference cut, however it is asked.
#[test]
fn a_bent_wear_curve_is_not_stepped_over() {
    let law = ExtendedTaylor::default();
    let mut turning = process();
    turning.pair.law = WearLaw::ExtendedTaylor(law);
    let u = TurningInput {
        cutting_speed: law.reference_speed,
        feed_per_rev: law.reference_feed,
        depth_of_cut: law.reference_depth,
        ..TurningInput::default()
    };
    // Cool enough for the nickel pair's heat model, which this law does not read.
    turning.pair.temperature.chip_heating = 1.0;
    turning.pair.temperature.flank_heating = 1.0;
    turning.pair.limits.wear_limit = law.wear_limit;
    let expected = law.reference_life;
    for model in [LifeModel::QuasiSteady, LifeModel::Ode] {
        let (life, _) = turning.life(&u, model).expect("an edge that wears out");
        assert!((life.cutting_time / expected - 1.0).abs() < 1e-5, "{model:?}: {} of {expected}", life.cutting_time);
    }
    let mut x = turning.initial();
    let end = turning.advance(&mut x, &u, 1e7).expect("a long step");
    assert!((end.elapsed / expected - 1.0).abs() < 1e-5, "{end:?} of {expected}");
}

/// Passes of 1.5 min at 36 m/min with pauses of 0.3 min.
#[test]
fn passes_with_pauses_give_the_reference_states() {
    let turning = process();
    let cut = TurningInput { cutting_speed: 0.6, ..TurningInput::default() };
    let pause = TurningInput { engaged: 0.0, ..cut };
    let mut x = turning.initial();
    for (land, body) in [(0.10095431, 259.06087), (0.15197396, 273.36952), (0.19088122, 281.48012)] {
        turning.advance(&mut x, &cut, 90.0).expect("a pass");
        turning.advance(&mut x, &pause, 18.0).expect("a pause");
        assert!((x.flank_wear * 1e3 / land - 1.0).abs() < 1e-6, "{}", x.flank_wear);
        assert!((x.tool_body_temperature_rise / body - 1.0).abs() < 1e-6, "{}", x.tool_body_temperature_rise);
    }
}

/// The first edge to reach its resistance chips, at the path that the Weibull law says.
#[test]
fn an_edge_chips_when_its_hazard_is_used_up() {
    let turning = process();
    let input = TurningInput { chipping_rate: 1e-2, chipping_resistance: 0.01, ..TurningInput::default() };
    let mut x = turning.initial();
    let end = turning.advance(&mut x, &input, 600.0).expect("a pass");
    assert_eq!(end.event, Some(ProcessEvent::Chipping));
    // Hazard (rate·path)^1.5 of an unworn edge; the land raises it a little, so the path is shorter.
    let unworn = 0.01f64.powf(1.0 / 1.5) / 1e-2;
    assert!(x.cutting_path < unworn && x.cutting_path > 0.8 * unworn, "{} m", x.cutting_path);
}

#[test]
fn a_collapse_is_an_event_also_at_the_first_instant() {
    let end = |flank_wear: f64, cutting_speed: f64| {
        let mut x = TurningState { flank_wear, tool_body_temperature_rise: 800.0, ..TurningState::default() };
        process().advance(&mut x, &TurningInput { cutting_speed, ..TurningInput::default() }, 600.0).expect("a pass")
    };
    // Past the wear limit the edge cuts on, until it collapses.
    let worn = end(0.61e-3, 0.8);
    assert_eq!(worn.event, Some(ProcessEvent::ThermalCollapse));
    assert!(worn.elapsed > 1.0);
    let hopeless = end(0.65e-3, 2.0);
    assert_eq!((hopeless.event, hopeless.elapsed), (Some(ProcessEvent::ThermalCollapse), 0.0));
}

/// A heavy cut is too hot for the edge from some speed on: there it collapses at once instead of living on.
#[test]
fn faster_is_never_longer_up_to_the_speed_at_which_an_edge_collapses_at_once() {
    for (model, set) in [
        (LifeModel::QuasiSteady, "ni_vk6om"),
        (LifeModel::Ode, "ni_vk6om"),
        (LifeModel::QuasiSteady, "ti_vk6"),
        (LifeModel::QuasiSteady, "c45_t15k6"),
    ] {
        let turning = Turning::named(set).expect("a shipped set");
        let life = |speed: f64| {
            let cut = TurningInput { feed_per_rev: 0.4e-3, depth_of_cut: 3e-3, ..TurningInput::default() };
            let (life, event) = turning.life(&TurningInput { cutting_speed: speed, ..cut }, model).expect("an end");
            (life.cutting_time, event)
        };
        let speeds: Vec<f64> =
            (0..60).map(|i| turning.pair.limits.reference_speed * (1.0 + 0.1 * f64::from(i))).collect();
        let lives: Vec<(f64, ProcessEvent)> = speeds.iter().map(|speed| life(*speed)).collect();
        for (pair, speed) in lives.windows(2).zip(&speeds) {
            assert!(pair[1].0 <= pair[0].0, "{set} above {speed} m/s: {} s, then {} s", pair[0].0, pair[1].0);
        }
        let kinds = [ProcessEvent::WearLimit, ProcessEvent::ThermalCollapse];
        let order: Vec<usize> =
            lives.iter().filter_map(|(_, event)| kinds.iter().position(|kind| kind == event)).collect();
        assert!(order.len() == 60 && order.is_sorted() && order[0] == 0 && order[59] == 1, "{set}: {order:?}");
        if model == LifeModel::QuasiSteady {
            assert_eq!(lives[59].0, 0.0, "{set}");
        }
    }
    // 80 and 90 m/min of the reference set: 0.0148 min and nothing.
    let at = |speed: f64| {
        let cut = TurningInput { feed_per_rev: 0.4e-3, depth_of_cut: 3e-3, ..TurningInput::default() };
        process().life(&TurningInput { cutting_speed: speed / 60.0, ..cut }, LifeModel::QuasiSteady).expect("an end")
    };
    assert!((at(80.0).0.cutting_time / 60.0 - 0.0148).abs() < 1e-4);
    assert_eq!((at(90.0).0.cutting_time, at(90.0).1), (0.0, ProcessEvent::ThermalCollapse));
}

#[test]
fn an_edge_without_resistance_chips_at_once() {
    let u = TurningInput { chipping_rate: 1e-2, chipping_resistance: 0.0, ..TurningInput::default() };
    let (life, event) = process().life(&u, LifeModel::Ode).expect("an end");
    assert_eq!((life.cutting_time, event), (0.0, ProcessEvent::Chipping));
}

#[test]
fn a_known_effect_changes_what_it_should() {
    let effect = |id: &str, size: f64| Turning {
        effects: Effects::new(vec![Effect::named(id).expect("a known effect").with_size(size)]).expect("one effect"),
        ..process()
    };
    let turning_state = TurningState { flank_wear: 0.3e-3, ..TurningState::default() };
    let u = TurningInput::default();
    let (bare, more) = (process().output(&turning_state, &u), effect("wear_force", 0.2).output(&turning_state, &u));
    assert!((more.cutting_force / bare.cutting_force - 1.2).abs() < 1e-12);
    let life = |turning: &Turning| turning.life(&u, LifeModel::Ode).expect("a life").0.cutting_time;
    for id in ["wear_acceleration", "run_in", "wear_temperature", "thermal_heredity"] {
        assert!(life(&effect(id, 0.5)) < life(&process()), "{id} shortens life");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn zero_strength_is_neutral(speed in 0.25..1.3f64, feed in 0.05e-3..0.4e-3, depth in 0.2e-3..3e-3, dt in 1.0..120.0f64) {
        let u = TurningInput { cutting_speed: speed, feed_per_rev: feed, depth_of_cut: depth, ..TurningInput::default() };
        let with = Turning { effects: Effects::every("turning"), ..process() };
        let (mut a, mut b) = (process().initial(), with.initial());
        prop_assert_eq!(process().advance(&mut a, &u, dt), with.advance(&mut b, &u, dt));
        prop_assert_eq!(a, b);
        prop_assert_eq!(process().output(&a, &u), with.output(&b, &u));
    }

    #[test]
    fn dual_numbers_give_the_slope_of_every_output(speed in 0.3..1.2f64, land in 0.05e-3..0.5e-3) {
        let turning = process();
        let dual = turning.map(Dual64::from);
        let x = TurningState { flank_wear: land, tool_body_temperature_rise: 300.0, ..TurningState::default() };
        let u = TurningInput { cutting_speed: speed, ..TurningInput::default() };
        let mut seeded = u.map(Dual64::from);
        seeded.cutting_speed = seeded.cutting_speed.derivative();
        let slopes = dual.observe(&x.map(Dual64::from), &seeded).map(|value| value.eps);
        let h = 1e-5 * speed;
        let at = |speed: f64| turning.output(&x, &TurningInput { cutting_speed: speed, ..u });
        let (low, high) = (at(speed - h), at(speed + h));
        for i in 0..toolroom_cutting::TurningOutput::<f64>::LEN {
            let difference = (high.get(i).unwrap_or(0.0) - low.get(i).unwrap_or(0.0)) / (2.0 * h);
            let slope = slopes.get(i).unwrap_or(0.0);
            let scale = slope.abs().max(high.get(i).unwrap_or(0.0).abs() / speed);
            prop_assert!((difference - slope).abs() <= 1e-5 * scale, "output {}: {} against {}", i, slope, difference);
        }
    }
}

#[test]
fn an_effect_of_a_user_without_a_value_ends_a_step_and_leaves_the_state() {
    let text = "[[effect]]\nid = \"my.root\"\nprocess = [\"turning\"]\nsize = { ordinary = 0.1, range = [0, 2] }\n\
                changes = [{ term = \"cutting_force\", \
                factor = \"1 + size * sqrt(1 - 2 * bump(flank_wear, 0.15 mm, 0.0005 mm))\" }]\n";
    let definition = toolroom_effects::parse_definitions("effects.toml", text).expect("an effect")[0];
    let effect = Effect::User(toolroom_effects::UserEffect::new(definition)).with_size(0.1);
    let turning = Turning { effects: Effects::new(vec![effect]).expect("one effect"), ..Turning::default() };
    let u = TurningInput::default();
    // Inside the window from the first instant on: the energy has no slope.
    let turning_state = TurningState { flank_wear: 0.15e-3, ..TurningState::default() };
    let mut x = turning_state;
    let refused = turning.advance(&mut x, &u, 30.0).expect_err("no force, no energy");
    assert_eq!((refused.code(), x), (Some("effect-value"), turning_state));
    assert!(refused.to_string().contains("flank_wear 1.5000e-1 mm"), "{refused}");
    let looked = turning.advance_watched(&mut x, &u, 30.0, &[10.0], &mut |_, _, _| ());
    assert_eq!((looked.map_err(|error| error.code()), x), (Err(Some("effect-value")), turning_state));
    // Before it the step is taken.
    let mut x = TurningState { flank_wear: 0.05e-3, ..TurningState::default() };
    assert_eq!(turning.advance(&mut x, &u, 1.0).map(|step| step.elapsed), Ok(1.0));
}
