//! What a unit does is what its process does.

use toolroom_cutting::{LifeModel, Milling, MillingInput, Turning, TurningInput, TurningState};
use toolroom_fmu::{Component, Interface, Log, Slot, Status, ValueType, Variable, units};
use toolroom_process::ode::{self, Tolerance};
use toolroom_process::{Process, Record};

const HELD: Interface = Interface::CoSimulation { event_mode: false, early_return: false };
const WITH_EVENTS: Interface = Interface::CoSimulation { event_mode: true, early_return: true };

/// A unit with its description.
struct Bench {
    unit: Box<dyn Component>,
    variables: Vec<Variable>,
}

impl Bench {
    fn new(model: &str, interface: Interface) -> Self {
        let entry = units().find(|unit| unit.name == model).expect("a shipped unit");
        Self { unit: entry.instantiate(interface, None, Log::new(None, false)), variables: entry.variables() }
    }

    fn reference(&self, name: &str) -> (ValueType, u32) {
        let variable = self.variables.iter().find(|each| each.name == name).expect("a variable");
        (variable.value_type, variable.slot.reference())
    }

    fn get(&mut self, name: &str) -> f64 {
        let (value_type, reference) = self.reference(name);
        let mut value = [f64::NAN];
        self.unit.read(value_type, &[reference], &mut value).expect("a readable variable");
        value[0]
    }

    fn set(&mut self, name: &str, value: f64) -> Status {
        let (value_type, reference) = self.reference(name);
        self.unit.write(value_type, &[reference], &[value]).expect("a settable variable")
    }

    fn start(mut self) -> Self {
        self.unit.enter_initialization().expect("Initialization Mode");
        self.unit.exit_initialization().expect("a unit that starts");
        self
    }

    /// Steps from `start` to `end`.
    fn run(&mut self, start: f64, end: f64, step: f64) {
        let count = ((end - start) / step).round() as u32;
        for i in 0..count {
            self.unit.do_step(start + f64::from(i) * step, step).expect("a step");
        }
    }
}

#[test]
fn steps_give_the_states_of_the_process() {
    let turning = Turning::named("ni_vk6om").expect("a shipped set");
    let milling = Milling::named("c45_endmill_d12").expect("a shipped set");
    let (mut x, mut y) = (turning.initial(), milling.initial());
    let (u, v) = (TurningInput::default(), MillingInput::default());
    let (mut lathe, mut mill) = (Bench::new("turning", HELD).start(), Bench::new("milling", HELD).start());
    for i in 0..600 {
        turning.advance(&mut x, &u, 0.5).expect("a step");
        milling.advance(&mut y, &v, 0.5).expect("a step");
        lathe.unit.do_step(f64::from(i) * 0.5, 0.5).expect("a step");
        mill.unit.do_step(f64::from(i) * 0.5, 0.5).expect("a step");
    }
    let close = |name: &str, a: f64, b: f64| assert!((a - b).abs() <= 1e-9 * b.abs(), "{name}: {a}, process {b}");
    let (outputs, milled) = (turning.output(&x, &u), milling.output(&y, &v));
    close("wear", lathe.get("tool.flank_wear"), x.flank_wear);
    close("energy", lathe.get("tool.energy"), x.energy);
    close("force", lathe.get("process.cutting_force"), outputs.cutting_force);
    close("temperature", lathe.get("process.temperature"), outputs.temperature);
    close("EMF", lathe.get("process.thermo_emf"), outputs.thermo_emf);
    close("wear of the cutter", mill.get("tool.flank_wear"), y.flank_wear);
    close("form error", mill.get("process.form_error"), milled.form_error);
}

#[test]
fn the_tool_life_of_a_cold_start_is_the_reference_value() {
    // 14.77972 min at 40 m/min with the default set, by the state equations.
    let (life, _) = Turning::default().life(&TurningInput::default(), LifeModel::Ode).expect("a life");
    let mut unit = Bench::new("turning", WITH_EVENTS).start();
    unit.unit.update_discrete().expect("Event Mode after initialisation");
    unit.unit.enter_step_mode().expect("Step Mode");
    let mut time = 0.0;
    let end = loop {
        let stepped = unit.unit.do_step(time, 10.0).expect("a step");
        time = stepped.time;
        if stepped.event {
            break stepped;
        }
        assert!(!stepped.early && time < 1000.0);
    };
    assert!(end.early && (end.time / 60.0 - 14.77972).abs() < 1e-5, "{end:?}");
    assert!((end.time / life.cutting_time - 1.0).abs() < 1e-6);
    assert_eq!(unit.get("event.wear_limit"), 1.0);
    assert!((unit.get("tool.flank_wear") / 0.6e-3 - 1.0).abs() < 1e-9);
    // The importer handles the event and mounts a new edge.
    unit.unit.enter_event_mode().expect("Event Mode");
    unit.set("tool.change", 1.0);
    assert!(unit.unit.update_discrete().expect("an update").states_changed);
    unit.unit.enter_step_mode().expect("Step Mode");
    assert_eq!((unit.get("tool.count"), unit.get("event.wear_limit"), unit.get("tool.flank_wear")), (2.0, 0.0, 0.0));
    assert!(!unit.unit.do_step(time, 10.0).expect("a step").early);
}

#[test]
fn a_unit_without_event_mode_does_the_same_by_itself() {
    let mut unit = Bench::new("turning", HELD).start();
    unit.run(0.0, 880.0, 10.0);
    assert_eq!(unit.get("event.wear_limit"), 0.0);
    unit.run(880.0, 890.0, 10.0);
    assert_eq!((unit.get("event.wear_limit"), unit.get("tool.lost")), (1.0, 0.0), "a worn edge cuts on");
    assert!(unit.get("tool.flank_wear") > 0.6e-3);
    unit.set("tool.change", 1.0);
    unit.run(890.0, 900.0, 10.0);
    assert_eq!((unit.get("tool.count"), unit.get("event.wear_limit")), (2.0, 0.0));
    let fresh = unit.get("tool.flank_wear");
    unit.run(900.0, 910.0, 10.0);
    assert_eq!(unit.get("tool.count"), 2.0, "only the rising edge counts");
    let mut other = Bench::new("turning", HELD).start();
    other.run(0.0, 10.0, 10.0);
    assert_eq!(other.get("tool.flank_wear"), fresh, "as a new edge");
}

#[test]
fn a_chipped_edge_cuts_no_more_until_it_is_changed() {
    let mut unit = Bench::new("turning", HELD).start();
    unit.set("process.chipping_rate", 1e-2);
    unit.set("process.chipping_resistance", 0.01);
    unit.run(0.0, 100.0, 10.0);
    assert_eq!((unit.get("tool.lost"), unit.get("event.chipping")), (1.0, 1.0));
    assert_eq!(unit.get("process.cutting_force"), 0.0);
    let wear = unit.get("tool.flank_wear");
    unit.run(100.0, 200.0, 10.0);
    assert_eq!(unit.get("tool.flank_wear"), wear);
    unit.set("process.chipping_resistance", 1e12);
    unit.set("tool.change", 1.0);
    unit.run(200.0, 210.0, 10.0);
    assert_eq!(unit.get("tool.lost"), 0.0);
    assert!(unit.get("process.cutting_force") > 0.0);
}

#[test]
fn model_exchange_gives_the_right_hand_side() {
    let turning = Turning::default();
    let mut unit = Bench::new("turning", Interface::ModelExchange).start();
    let count = unit.unit.state_count();
    let mut x = [0.0; 16];
    unit.unit.states(&mut x[..count]).expect("states");
    x[0] = 0.2e-3;
    x[1] = 300.0;
    unit.unit.enter_continuous_mode().expect("Continuous-Time Mode");
    unit.unit.set_states(&x[..count]).expect("states");
    let mut slopes = [0.0; 16];
    unit.unit.derivatives(&mut slopes[..count]).expect("derivatives");
    let state = TurningState::from_slice(&x[..count]);
    let expected = turning.derivative(&state, &TurningInput::default()).expect("an ODE");
    (0..count).for_each(|i| assert_eq!(Some(slopes[i]), expected.get(i)));
    // A discrete input between events is latched, with a remark.
    assert_eq!(unit.set("process.engaged", 0.0), Status::Warning);
    assert_eq!(unit.get("process.engaged"), 1.0);
    assert!(unit.unit.completed_step().expect("a step"), "the unit asks for Event Mode");
    unit.unit.enter_event_mode().expect("Event Mode");
    assert_eq!(unit.get("process.engaged"), 0.0);
}

/// Integrates a unit of Model Exchange, as an importer does that sets the speed at every instant.
fn exchange(unit: &mut Bench, from: f64, to: f64, speed: impl Fn(f64) -> f64) {
    const STATES: usize = TurningState::LEN;
    let mut start = [0.0; STATES];
    unit.unit.states(&mut start).expect("states");
    // Sizes of wear (m), body (K), damage, parts of wear, path (m), time (s), hazard, energy (J), chatter (s).
    let sizes = [0.6e-3, 300.0, 1.0, 0.6e-3, 0.6e-3, 13.0, 20.0, 1.0, 5e4, 1e5];
    let tolerance = Tolerance { relative: 1e-10, absolute: sizes.map(|size| 1e-10 * size) };
    let end = ode::integrate(
        |time, y: &[f64; STATES]| {
            unit.unit.set_time(from + time).expect("a time");
            unit.set("process.cutting_speed", speed(from + time));
            unit.unit.set_states(y).expect("states");
            let mut slopes = [0.0; STATES];
            unit.unit.derivatives(&mut slopes).expect("derivatives");
            slopes
        },
        |_, _| [-1.0],
        &start,
        to - from,
        &tolerance,
    );
    unit.unit.set_time(to).expect("a time");
    unit.unit.set_states(&end.expect("a trajectory").state).expect("states");
}

/// m/s: 40 m/min, from 100 s to 200 s up to 50 m/min, from 300 s on down to 30 m/min at 600 s.
fn ramps(time: f64) -> f64 {
    let up = (time - 100.0).clamp(0.0, 100.0) / 100.0 * 10.0;
    let down = (time - 300.0).max(0.0) / 300.0 * 20.0;
    (40.0 + up - down) / 60.0
}

/// Wear at 600 s of a unit of Co-Simulation under [`ramps`], the edge changed at 300 s.
fn stepped_over_ramps(step: f64, with_slope: bool) -> f64 {
    let mut unit = Bench::new("turning", HELD).start();
    let count = (600.0 / step).round() as u32;
    for i in 0..count {
        let time = f64::from(i) * step;
        unit.set("process.cutting_speed", ramps(time));
        if with_slope {
            unit.set("process.cutting_acceleration", (ramps(time + step) - ramps(time)) / step);
        }
        if time == 300.0 {
            unit.set("tool.change", 1.0);
        }
        unit.unit.do_step(time, step).expect("a step");
    }
    assert_eq!(unit.get("tool.count"), 2.0);
    unit.get("tool.flank_wear")
}

#[test]
fn both_interfaces_agree_over_ramps_and_a_change_of_the_edge() {
    let mut unit = Bench::new("turning", Interface::ModelExchange).start();
    unit.unit.enter_continuous_mode().expect("Continuous-Time Mode");
    for (from, to) in [(0.0, 100.0), (100.0, 200.0), (200.0, 300.0)] {
        exchange(&mut unit, from, to, ramps);
    }
    unit.unit.enter_event_mode().expect("Event Mode");
    unit.set("tool.change", 1.0);
    assert!(unit.unit.update_discrete().expect("an update").states_changed);
    unit.unit.enter_continuous_mode().expect("Continuous-Time Mode");
    exchange(&mut unit, 300.0, 600.0, ramps);
    let exact = unit.get("tool.flank_wear");
    let error = |step: f64, with_slope: bool| stepped_over_ramps(step, with_slope) / exact - 1.0;
    assert!(error(1.0, true).abs() < 1e-8, "{:e}", error(1.0, true));
    // A speed alone is held over the step: it lags by half a step, and so does its error.
    let (whole, half) = (error(1.0, false), error(0.5, false));
    assert!(whole.abs() > 1e-4 && (whole / half - 2.0).abs() < 0.02, "{whole:e}, {half:e}");
}

#[test]
fn both_interfaces_agree_under_the_built_in_policy() {
    let mut unit = Bench::new("turning", Interface::ModelExchange);
    unit.set("adaptive.enable", 1.0);
    let mut unit = unit.start();
    let mut time = 0.0;
    while time < 120.0 {
        let next = unit.unit.update_discrete().expect("an update").next_event.expect("the next command");
        unit.unit.enter_continuous_mode().expect("Continuous-Time Mode");
        exchange(&mut unit, time, next, |_| 40.0 / 60.0);
        unit.unit.enter_event_mode().expect("Event Mode");
        time = next;
    }
    let mut stepped = Bench::new("turning", HELD);
    stepped.set("adaptive.enable", 1.0);
    let mut stepped = stepped.start();
    stepped.run(0.0, 120.0, 1.0);
    let ratio = stepped.get("tool.flank_wear") / unit.get("tool.flank_wear");
    assert!(time == 120.0 && (ratio - 1.0).abs() < 1e-8, "{time} s: {ratio}");
}

#[test]
fn the_built_in_policy_commands_the_speed_of_least_wear() {
    let pair = Turning::default().pair;
    let mut unit = Bench::new("turning", HELD);
    unit.set("adaptive.enable", 1.0);
    let mut unit = unit.start();
    // It samples every six seconds and holds in between.
    unit.run(0.0, 294.0, 0.5);
    let sampled = unit.get("tool.flank_wear");
    unit.run(294.0, 300.0, 0.5);
    let (wear, speed) = (unit.get("tool.flank_wear"), unit.get("adaptive.cutting_speed"));
    let law = pair.limits.clip(pair.minimum_wear_speed(&pair.reference_cut(), sampled));
    assert!((speed / law - 1.0).abs() < 1e-12, "{speed}, the law {law}");
    assert!((unit.get("process.spindle_power") / unit.get("process.cutting_force") / speed - 1.0).abs() < 1e-12);
    // The sampling of the policy, not the step of the importer, decides.
    let mut coarse = Bench::new("turning", HELD);
    coarse.set("adaptive.enable", 1.0);
    let mut coarse = coarse.start();
    coarse.run(0.0, 300.0, 100.0);
    let ratio = coarse.get("tool.flank_wear") / wear;
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
}

#[test]
fn chatter_is_judged_where_it_is_asked_for() {
    let mut unit = Bench::new("turning", HELD);
    unit.set("process.depth_of_cut", 3e-3);
    unit.set("process.cutting_speed", 1.2);
    let mut unit = unit.start();
    assert_eq!((unit.get("process.stable"), unit.get("process.stability_margin")), (1.0, 1.0));
    unit.set("machine.chatter", 1.0);
    unit.set("machine.process_damping", 0.0);
    assert_eq!(unit.get("process.stable"), 0.0);
    assert!(unit.get("process.stability_margin") < 0.0 && unit.get("process.vibration_rms") > 1e-6);
    unit.set("machine.stiffness", 1e9);
    assert_eq!(unit.get("process.stable"), 1.0);
}

#[test]
fn an_effect_of_size_zero_is_off_and_a_size_switches_it_on() {
    let force = |size: f64| {
        let mut unit = Bench::new("turning", HELD);
        unit.set("effect.wear_force", size);
        unit.set("tool.flank_wear", 0.3e-3);
        unit.start().get("process.cutting_force")
    };
    let bare = Turning::default();
    let turning_state = TurningState { flank_wear: 0.3e-3, ..bare.initial() };
    let expected = bare.output(&turning_state, &TurningInput::default()).cutting_force;
    assert_eq!(force(0.0), expected);
    assert!((force(0.2) / expected - 1.2).abs() < 1e-12);
}

#[test]
fn a_set_leaves_alone_what_was_set_by_itself() {
    let choose = |order: [usize; 2]| {
        let mut unit = Bench::new("turning", HELD);
        for what in order {
            if what == 0 {
                let (_, reference) = unit.reference("tool.set");
                unit.unit.write_text(reference, "c45_t15k6").expect("a shipped set");
            } else {
                unit.set("limits.wear_limit", 0.5e-3);
            }
        }
        (unit.get("limits.wear_limit"), unit.get("force.specific_force"))
    };
    let (limit, force) = choose([0, 1]);
    assert_eq!(choose([1, 0]), (limit, force), "in either order");
    assert_eq!(limit, 0.5e-3);
    assert_eq!(force, Turning::named("c45_t15k6").expect("a shipped set").pair.force.specific_force);
}

#[test]
fn a_restored_state_goes_on_bit_for_bit_also_in_another_instance() {
    for model in ["turning", "milling", "infeed"] {
        let mut unit = Bench::new(model, HELD);
        if model == "turning" {
            unit.set("adaptive.enable", 1.0);
            unit.set("effect.run_in", 0.3);
        }
        let mut unit = unit.start();
        unit.run(0.0, 20.0, 0.5);
        let state = unit.unit.save(0).expect("a saved state");
        let bytes = unit.unit.serialise(state).expect("bytes");
        unit.run(20.0, 40.0, 0.5);
        let at_end = |unit: &mut Bench| {
            let handle = unit.unit.save(0).expect("a saved state");
            unit.unit.serialise(handle).expect("bytes")
        };
        let end = at_end(&mut unit);
        unit.unit.restore(state).expect("its own state");
        unit.run(20.0, 40.0, 0.5);
        assert_eq!(at_end(&mut unit), end, "{model} again");
        let mut other = Bench::new(model, HELD);
        let copy = other.unit.deserialise(&bytes).expect("the same unit's bytes");
        other.unit.restore(copy).expect("a state");
        other.run(20.0, 40.0, 0.5);
        assert_eq!(at_end(&mut other), end, "{model} elsewhere");
    }
}

/// Real variables whose slot passes, by reference.
fn reals(variables: &[Variable], wanted: fn(Slot) -> bool) -> Vec<u32> {
    let real = variables.iter().filter(|each| each.value_type == ValueType::Real && wanted(each.slot));
    real.map(|each| each.slot.reference()).collect()
}

/// Jacobian columns of a unit at a point inside its range, with every effect on.
fn at_a_point(model: &str) -> (Bench, Vec<u32>, Vec<u32>) {
    let mut unit = Bench::new(model, Interface::ModelExchange);
    let effects: Vec<String> = unit.variables.iter().map(|each| each.name.clone()).collect();
    for name in effects.iter().filter(|name| name.starts_with("effect.")) {
        let max = unit.variables.iter().find(|each| each.name == **name).map_or(0.0, |each| each.field.max);
        unit.set(name, (0.02 * max).min(1e-3));
    }
    unit.set("tool.flank_wear", 0.23e-3);
    unit.set("tool.cutting_path", 321.0);
    unit.set("tool.cutting_time", 432.0);
    unit.set("process.chipping_rate", 1e-3);
    if model == "turning" {
        unit.set("tool.tool_body_temperature_rise", 321.0);
        unit.set("tool.thermal_damage", 0.21);
        unit.set("process.coolant_age", 10.0);
    }
    let unit = unit.start();
    let knowns = reals(&unit.variables, |slot| matches!(slot, Slot::Input(_) | Slot::State(_)));
    let unknowns =
        reals(&unit.variables, |slot| matches!(slot, Slot::Output(_) | Slot::Derivative(_) | Slot::Indicator(_)));
    (unit, knowns, unknowns)
}

#[test]
fn directional_and_adjoint_derivatives_are_the_slopes_and_touch_what_is_declared() {
    for model in ["turning", "milling"] {
        let (mut unit, knowns, unknowns) = at_a_point(model);
        let entry = units().find(|unit| unit.name == model).expect("a shipped unit");
        let declared = &entry.describe().dependencies;
        let mut slopes = vec![0.0; unknowns.len()];
        for &known in &knowns {
            let mut value = [0.0];
            unit.unit.read(ValueType::Real, &[known], &mut value).expect("a known");
            let field = unit.variables.iter().find(|each| each.slot.reference() == known).map(|each| each.field);
            // One that stands at the end of its range is moved inwards.
            let value =
                [field.map_or(value[0], |f| value[0].clamp(f.min + 1e-3 * (f.max - f.min).min(1.0), 0.99 * f.max))];
            let h = 1e-3 * value[0].abs().max(1e-5);
            let mut at = |offset: f64| {
                let mut values = vec![0.0; unknowns.len()];
                unit.set_any(known, value[0] + offset);
                unit.unit.read(ValueType::Real, &unknowns, &mut values).expect("unknowns");
                values
            };
            // Central differences over two steps, extrapolated: fourth order.
            let (low, high, lower, higher) = (at(-h), at(h), at(-2.0 * h), at(2.0 * h));
            at(0.0);
            unit.unit.directional(&unknowns, &[known], &[1.0], &mut slopes).expect("a derivative");
            for (i, unknown) in unknowns.iter().enumerate() {
                let difference = (8.0 * (high[i] - low[i]) - (higher[i] - lower[i])) / (12.0 * h);
                let scale = slopes[i].abs().max(1e-6 * (high[i].abs() + low[i].abs()) / value[0].abs().max(1e-4));
                // Values are good to a few units in the last place.
                let rounding = 1e-14 * (high[i].abs() + low[i].abs()) / h;
                assert!(
                    (difference - slopes[i]).abs() <= 1e-6 * scale + rounding,
                    "{model}: {unknown} by {known}: difference {difference}, derivative {}",
                    slopes[i]
                );
                let known_by = declared.of_unknown(*unknown).expect("a declared unknown");
                let touched = high[i].to_bits() != low[i].to_bits();
                assert!(!touched || known_by.contains(&known), "{model}: {unknown} depends on {known}");
            }
            // The adjoint of one weight is the same row by row.
            let mut back = [0.0];
            let weights: Vec<f64> = (0..unknowns.len()).map(|i| 1.0 / (1.0 + i as f64)).collect();
            unit.unit.adjoint(&unknowns, &[known], &weights, &mut back).expect("a derivative");
            let sum: f64 = slopes.iter().zip(&weights).map(|(slope, weight)| slope * weight).sum();
            assert!((back[0] - sum).abs() <= 1e-12 * sum.abs());
        }
    }
}

impl Bench {
    /// Sets a known of either kind in Event Mode.
    fn set_any(&mut self, reference: u32, value: f64) {
        match Slot::of(reference) {
            Some(Slot::State(i)) => {
                let mut states = vec![0.0; self.unit.state_count()];
                self.unit.states(&mut states).expect("states");
                states[i] = value;
                self.unit.set_states(&states).expect("a state");
            }
            _ => drop(self.unit.write(ValueType::Real, &[reference], &[value]).expect("an input")),
        }
    }
}

#[test]
fn no_step_goes_beyond_the_end_that_the_importer_named() {
    let mut bench = Bench::new("turning", HELD);
    bench.unit.set_experiment(0.0, Some(1.0), None).expect("an end");
    let mut bench = bench.start();
    bench.run(0.0, 0.7, 0.1);
    let refused = bench.unit.do_step(0.7, 0.4).expect_err("beyond the end").to_string();
    assert!(refused.contains("the step ends at 1.1 s, the simulation was said to end at 1 s"), "{refused}");
    assert!((bench.unit.time() - 0.7).abs() < 1e-12, "a refused step is not taken");
    // Sums of steps that round are no steps beyond it.
    bench.unit.do_step(0.7, 0.3 * (1.0 + 1e-12)).expect("the last step");
    bench.unit.do_step(1.0, 0.1).expect_err("beyond the end");
    bench.unit.reset().expect("a new beginning");
    let mut bench = bench.start();
    bench.unit.do_step(0.0, 2.0).expect("without an end");
}

#[test]
fn a_tolerance_that_is_none_is_refused() {
    let mut bench = Bench::new("turning", HELD);
    for tolerance in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        let refused = bench.unit.set_experiment(0.0, None, Some(tolerance)).expect_err("no tolerance").to_string();
        assert!(refused.contains("has to be above 0"), "{refused}");
    }
    bench.unit.set_experiment(0.0, None, Some(1e-6)).expect("a tolerance");
}

#[test]
fn a_step_that_would_take_too_long_asks_for_shorter_ones() {
    let mut wheel = Bench::new("infeed", HELD).start();
    let refused = wheel.unit.do_step(0.0, 1e9).expect_err("a billion seconds of grinding").to_string();
    assert!(refused.contains("would not end within a second: take steps of at most"), "{refused}");
    wheel.unit.do_step(0.0, 1.0).expect("a second");
    let mut lathe = Bench::new("turning", HELD);
    lathe.set("adaptive.enable", 1.0);
    let mut lathe = lathe.start();
    let refused = lathe.unit.do_step(0.0, 1e9).expect_err("too many commands").to_string();
    assert!(refused.contains("the built-in policy commands a speed"), "{refused}");
    // Without commands within it a long step is one integration.
    for model in ["turning", "milling"] {
        Bench::new(model, HELD).start().unit.do_step(0.0, 1e9).expect("one integration");
        for endless in [1e12, 1e300] {
            let refused = Bench::new(model, HELD).start().unit.do_step(0.0, endless).expect_err("endless").to_string();
            assert!(refused.contains("would not end within a second: take steps of at most 2000000000 s"), "{refused}");
        }
    }
}

#[test]
fn a_cutter_wears_as_far_as_the_model_knows_and_is_lost_then() {
    let mut long = Bench::new("milling", HELD).start();
    long.unit.do_step(0.0, 1e9).expect("one step");
    let worn = long.get("tool.flank_wear");
    assert!((worn / 2e-3 - 1.0).abs() < 1e-9, "{worn}");
    assert_eq!((long.get("tool.lost"), long.get("event.wear_limit")), (1.0, 1.0));
    // The same in many steps.
    let mut short = Bench::new("milling", HELD).start();
    short.run(0.0, 1e6, 1e3);
    assert!((short.get("tool.flank_wear") / worn - 1.0).abs() < 1e-9);
    short.set("tool.change", 1.0);
    short.unit.do_step(1e6, 10.0).expect("a new cutter");
    assert_eq!(short.get("tool.lost"), 0.0);
    assert!(short.get("tool.flank_wear") > 0.0);
}
