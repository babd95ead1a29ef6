//! `toolroom point PROCESS`: every output of a process at one operating point.

use crate::args::{PointArgs, PointProcess};
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_cutting::{LifeModel, Milling, MillingInput, Turning, TurningInput, TurningState};
use toolroom_effects::{Effect, Effects};
use toolroom_form::{nearest, significant};
use toolroom_infeed::{Infeed, Parameters};
use toolroom_process::{AnyRecord, Field, Process, ProcessEvent, Record, unit};
use toolroom_wear::{Cut, Pair};

/// One operating point worked out.
struct Point {
    process: &'static str,
    inputs: Vec<(String, Value)>,
    state: Vec<(String, Value)>,
    outputs: Vec<(String, Value)>,
    event: Option<ProcessEvent>,
}

pub fn run(args: &PointArgs, voice: &Voice) -> Result<(), Failure> {
    let effects = args.effect.iter().map(|text| text.parse::<Effect>()).collect::<Result<Vec<_>, _>>();
    let effects = effects.and_then(Effects::new).map_err(|error| Failure::argument(error, "see toolroom effects"))?;
    let point = match args.process {
        PointProcess::Turning => turning(args, effects)?,
        PointProcess::Milling => {
            let set = args.tool.as_deref().unwrap_or("c45_endmill_d12");
            let milling = Milling::named(set).map_err(|error| Failure::argument(error, "give --tool SET"))?;
            effects.check(Milling::NAME).map_err(|error| Failure::argument(error, "see toolroom effects"))?;
            // A set is used at the cut for which it was made, unless --set says otherwise.
            let start = MillingInput {
                cutting_speed: milling.life.reference_speed,
                feed_per_tooth: milling.life.reference_feed,
                depth_of_cut: milling.life.reference_depth,
                width_of_cut: milling.life.reference_width,
                ..MillingInput::default()
            };
            evaluate(&mut Milling { effects, ..milling }, start, args)?.0
        }
        PointProcess::Infeed => {
            let set = args.tool.as_deref().unwrap_or("zb153u_40kh");
            let parameters = Parameters::named(set).map_err(|error| Failure::argument(error, "give --tool SET"))?;
            let mut infeed =
                Infeed::new(parameters, effects).map_err(|error| Failure::argument(error, "see toolroom effects"))?;
            evaluate(&mut infeed, toolroom_infeed::Input::default(), args)?.0
        }
    };
    if voice.json {
        return voice.json(&json!({
            "schema": 1,
            "process": point.process,
            "inputs": Map::from_iter(point.inputs),
            "state": Map::from_iter(point.state),
            "outputs": Map::from_iter(point.outputs),
            "event": point.event.map(ProcessEvent::name),
        }));
    }
    let mut text = format!("{}\n", point.process);
    for (title, values) in [("inputs", &point.inputs), ("state", &point.state), ("outputs", &point.outputs)] {
        let _ = writeln!(text, "{title}");
        for (name, value) in values {
            let value = match value {
                Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), significant),
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            let _ = writeln!(text, "  {name:34} {value:>14}");
        }
    }
    if let Some(event) = point.event {
        let _ = writeln!(text, "stopped by {}", event.name());
    }
    voice.data(text.trim_end())
}

fn turning(args: &PointArgs, effects: Effects) -> Result<Point, Failure> {
    let set = args.tool.as_deref().unwrap_or("ni_vk6om");
    let pair = Pair::named(set).map_err(|error| Failure::argument(error, "give --tool SET"))?;
    effects.check(Turning::NAME).map_err(|error| Failure::argument(error, "see toolroom effects"))?;
    // A set is used at the cut for which it was made, unless --set says otherwise.
    let reference = pair.reference_cut();
    let mut turning = Turning { pair, effects, ..Turning::default() };
    let start = TurningInput {
        cutting_speed: reference.cutting_speed,
        feed_per_rev: reference.feed_per_rev,
        depth_of_cut: reference.depth_of_cut,
        ..TurningInput::default()
    };
    let (mut point, input, mut state) = evaluate(&mut turning, start, args)?;
    let model = LifeModel::from(args.life_model);
    let given = args.set.iter().any(|text| text.starts_with("tool_body_temperature_rise"));
    if model == LifeModel::QuasiSteady && !given && args.advance.is_none() {
        state.tool_body_temperature_rise = warm_body(&turning, &state, &input);
        point.state = values(&state);
        point.outputs = values(&turning.output(&state, &input));
    }
    let mut add = |name: &str, value: Value| point.outputs.push((name.to_owned(), value));
    add("minimum_wear_speed [m/min]", json!(minimum_wear_speed(&turning, &state, &input) * 60.0));
    let life = turning.life(&input, model);
    add("tool_life [min]", life.as_ref().map_or(Value::Null, |(life, _)| json!(life.cutting_time / 60.0)));
    add("path_life [m]", life.as_ref().map_or(Value::Null, |(life, _)| json!(life.path)));
    add("life_ends_by", life.map_or_else(|reason| json!(reason.to_string()), |(_, event)| json!(event.name())));
    add("life_model", json!(model.name()));
    Ok(point)
}

/// Temperature rise of the tool body that `input`, held, ends in: its rate of change taken to
/// the end of its exponential approach.
fn warm_body(turning: &Turning, state: &TurningState, input: &TurningInput) -> f64 {
    let rate = turning.rates(state, input).tool_body_temperature_rise;
    state.tool_body_temperature_rise + rate * turning.pair.temperature.body_time_constant
}

/// Speed of least wear per path at the wear of `state`.
///
/// Without effects that is the pair's exact balance; effects shift it through the rates.
fn minimum_wear_speed(turning: &Turning, state: &TurningState, input: &TurningInput) -> f64 {
    if turning.effects.iter().next().is_none() {
        let cut = Cut {
            hardness: input.hardness_ratio,
            mechanical_factor: input.mechanical_wear_factor,
            thermal_factor: input.thermal_wear_factor,
            wear_factor: input.wear_rate_factor,
            ..Cut::nominal(input.cutting_speed, input.feed_per_rev, input.depth_of_cut)
        };
        return turning.pair.minimum_wear_speed(&cut, state.flank_wear);
    }
    let intensity = |log_speed: f64| {
        let speed = log_speed.exp();
        let held = TurningInput { cutting_speed: speed, ..*input };
        let warm = TurningState { tool_body_temperature_rise: warm_body(turning, state, &held), ..*state };
        turning.rates(&warm, &held).flank_wear / speed
    };
    let limits = &turning.pair.limits;
    least(intensity, (0.1 * limits.reference_speed).ln(), (6.0 * limits.reference_speed).ln()).exp()
}

/// Where `f` is least between `low` and `high`: a grid against side valleys, then golden section.
fn least(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    const GRID: usize = 400;
    let at = |i: usize| low + (high - low) * i as f64 / GRID as f64;
    let best = (0..=GRID).min_by(|a, b| f(at(*a)).total_cmp(&f(at(*b)))).unwrap_or(0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(GRID)));
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    while b - a > 1e-9 {
        let (left, right) = (b - ratio * (b - a), a + ratio * (b - a));
        if f(left) < f(right) { b = right } else { a = left }
    }
    0.5 * (a + b)
}

/// Applies every `--set` to input, state or parameters, advances, and reads everything.
fn evaluate<P: Process>(
    process: &mut P,
    mut input: P::Input,
    args: &PointArgs,
) -> Result<(Point, P::Input, P::State), Failure> {
    let mut changes = Vec::new();
    for text in &args.set {
        let (key, value) = text.split_once('=').ok_or_else(|| {
            Failure::argument(format_args!("`{text}` is not of the form key=value"), "--set cutting_speed=\"40 m/min\"")
        })?;
        changes.push((key.trim(), value.trim()));
    }
    // Parameters first: the initial state may depend on them.
    for (key, value) in &changes {
        if let Some((group, name)) = key.split_once('.') {
            let mut groups = process.parameters_mut();
            let known = groups.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
            let Some((_, record)) = groups.iter_mut().find(|(each, _)| *each == group) else {
                return Err(Failure::argument(format_args!("there is no parameter group `{group}`"), known));
            };
            if !assign(*record, name, value)? {
                let fields = record.fields().iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
                return Err(Failure::argument(format_args!("`{group}` has no parameter `{name}`"), fields));
            }
        }
    }
    let mut state = process.initial();
    for (key, value) in changes.iter().filter(|(key, _)| !key.contains('.')) {
        if !assign(&mut input, key, value)? && !assign(&mut state, key, value)? {
            let names = P::Input::FIELDS.iter().chain(P::State::FIELDS).map(|field| field.name).collect::<Vec<_>>();
            let near =
                nearest(key, names.iter().copied()).map_or(String::new(), |near| format!("did you mean `{near}`? "));
            let help = format!("{near}inputs and states: {}; parameters as group.name", names.join(", "));
            return Err(Failure::argument(format_args!("{} has no input or state `{key}`", P::NAME), help));
        }
    }
    let mut event = None;
    if let Some(time) = &args.advance {
        let time = unit::quantity(time, "s")
            .map_err(|error| Failure::argument(format_args!("--advance: {error}"), "--advance \"10 s\""))?;
        let advance = process
            .advance(&mut state, &input, time)
            .map_err(|error| Failure::argument(format_args!("--advance: {error}"), "see the ranges above"))?;
        input = process.input_after(&input, advance.elapsed);
        event = advance.event;
    }
    let output = process.output(&state, &input);
    let point =
        Point { process: P::NAME, inputs: values(&input), state: values(&state), outputs: values(&output), event };
    Ok((point, input, state))
}

/// Sets `name` of a record from text; false where the record has no such scalar.
fn assign(record: &mut dyn AnyRecord, name: &str, text: &str) -> Result<bool, Failure> {
    let mut index = 0;
    for field in record.fields() {
        if field.name == name && field.len == 1 {
            let value = read(field, text)?;
            record.set_value(index, value);
            return Ok(true);
        }
        index += field.len;
    }
    Ok(false)
}

fn read(field: &Field, text: &str) -> Result<f64, Failure> {
    let help = format!("{} is in {}", field.name, if field.display == "1" { "a bare number" } else { field.display });
    let value = unit::quantity(text, field.unit)
        .map_err(|error| Failure::argument(format_args!("--set {}: {error}", field.name), &help))?;
    field.check(value).map_err(|error| Failure::argument(format_args!("--set {error}"), &help))?;
    Ok(value)
}

fn values(record: &dyn AnyRecord) -> Vec<(String, Value)> {
    let mut values = Vec::new();
    let mut index = 0;
    for field in record.fields() {
        let elements: Vec<Value> = (index..index + field.len)
            .filter_map(|i| record.value(i))
            .map(|value| json!(field.to_display(value)))
            .collect();
        index += field.len;
        let value = if field.len == 1 { elements.into_iter().next().unwrap_or(Value::Null) } else { json!(elements) };
        values.push((field.header(), value));
    }
    values
}
