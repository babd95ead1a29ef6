//! Turning at a point: the speed of least wear and the life of the tool beside the outputs.

use super::evaluate::{evaluate, values};
use super::{Point, PointError, PointOptions};
use serde_json::{Value, json};
use toolroom_cutting::{LifeModel, Turning, TurningInput, TurningState};
use toolroom_effects::Effects;
use toolroom_process::Process;
use toolroom_wear::{Cut, Pair};

pub fn point(options: &PointOptions, effects: Effects) -> Result<Point, PointError> {
    let pair = Pair::load(options.tool.as_deref().unwrap_or("ni_vk6om"), std::path::Path::new(""))?;
    effects.check(Turning::NAME).map_err(PointError::Effect)?;
    // A set is used at the cut for which it was made, unless a change says otherwise.
    let reference = pair.reference_cut();
    let mut turning = Turning { pair, effects, ..Turning::default() };
    let start = TurningInput {
        cutting_speed: reference.cutting_speed,
        feed_per_rev: reference.feed_per_rev,
        depth_of_cut: reference.depth_of_cut,
        ..TurningInput::default()
    };
    let (mut point, input, mut state) = evaluate(&mut turning, start, options)?;
    let model = options.life_model;
    let given = options.changes.iter().any(|text| text.starts_with("tool_body_temperature_rise"));
    if model == LifeModel::QuasiSteady && !given && options.advance.is_none() {
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
