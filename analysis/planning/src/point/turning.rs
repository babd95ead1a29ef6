//! Turning at a point: the speed of least wear and the life of the tool beside the outputs.

use super::evaluate::{evaluate, values};
use super::{Point, PointError, PointOptions};
use serde_json::json;
use std::borrow::Cow;
use toolroom_cutting::{LifeModel, Turning, TurningInput, TurningState};
use toolroom_effects::Effects;
use toolroom_process::{Process, watched};
use toolroom_wear::{Cut, Pair};

/// Heads of what is worked out beside the outputs, in the order of [`Beside`].
pub const BESIDE: [&str; 5] =
    ["minimum_wear_speed [m/min]", "tool_life [min]", "path_life [m]", "life_ends_by", "life_model"];

/// What is worked out beside the outputs.
pub struct Beside {
    /// Speed of least wear in m/min, life in min and path in m; NaN for the lives of an edge that does not end.
    pub numbers: [f64; 3],
    /// What ends the life, or why nothing does.
    pub ends_by: Cow<'static, str>,
}

/// The process of the options before their changes, with the cut for which its set was made.
pub fn start(options: &PointOptions, effects: Effects) -> Result<(Turning, TurningInput), PointError> {
    let pair = Pair::load(options.tool.as_deref().unwrap_or("ni_vk6om"), std::path::Path::new(""))
        .map_err(|error| error.told_apart("turning", toolroom_cutting::process_of_set))?;
    effects.check(Turning::NAME).map_err(PointError::Effect)?;
    // A set is used at the cut for which it was made, unless a change says otherwise.
    let reference = pair.reference_cut();
    let turning = Turning { pair, effects, ..Turning::default() };
    let start = TurningInput {
        cutting_speed: reference.cutting_speed,
        feed_per_rev: reference.feed_per_rev,
        depth_of_cut: reference.depth_of_cut,
        ..TurningInput::default()
    };
    Ok((turning, start))
}

/// Speed of least wear and life; a state whose body temperature nobody `gave` is warmed first where the life model
/// has a body in balance.
pub fn beside(
    turning: &Turning,
    input: &TurningInput,
    state: &mut TurningState,
    model: LifeModel,
    gave: bool,
) -> Beside {
    if model == LifeModel::QuasiSteady && !gave {
        state.tool_body_temperature_rise = warm_body(turning, state, input);
    }
    let least = minimum_wear_speed(turning, state, input) * 60.0;
    match turning.life(input, model) {
        Ok((life, event)) => {
            Beside { numbers: [least, life.cutting_time / 60.0, life.path], ends_by: event.name().into() }
        }
        Err(reason) => Beside { numbers: [least, f64::NAN, f64::NAN], ends_by: reason.to_string().into() },
    }
}

/// Whether the temperature of the tool body is not to be worked out: it was given, or follows from an advance.
pub fn gives_body(options: &PointOptions) -> bool {
    let given = options.changes.iter().any(|text| text.starts_with(BODY));
    given || options.advance.is_some()
}

/// The state that is warmed unless it was given.
pub const BODY: &str = "tool_body_temperature_rise";

pub fn point(options: &PointOptions, effects: Effects) -> Result<Point, PointError> {
    let (mut turning, start) = start(options, effects)?;
    let (mut point, input, mut state) = evaluate(&mut turning, start, options)?;
    let model = options.life_model;
    let at_state = || {
        let beside = beside(&turning, &input, &mut state, model, gives_body(options));
        (beside, turning.output(&state, &input))
    };
    let (Beside { numbers, ends_by }, output) = watched(at_state).map_err(PointError::Value)?;
    point.state = values(&state);
    point.outputs = values(&output);
    let texts = [json!(ends_by), json!(model.name())];
    let beside = BESIDE.iter().zip(numbers.into_iter().map(|number| json!(number)).chain(texts));
    point.outputs.extend(beside.map(|(head, value)| ((*head).to_owned(), value)));
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
        let turning_input = TurningInput { cutting_speed: speed, ..*input };
        let warm = TurningState { tool_body_temperature_rise: warm_body(turning, state, &turning_input), ..*state };
        turning.rates(&warm, &turning_input).flank_wear / speed
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
