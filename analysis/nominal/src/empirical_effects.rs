//! Candidates of an empirical response: effects of the catalogue by what is recorded.

use super::features::{self, standardised};
use super::{Candidate, ChannelId, EffectId, cutting_effects};
use toolroom_records::Records;
use toolroom_statistics::median;

/// Argument of the tangent beyond which an edge has run away.
const RUNAWAY: f64 = 1.45;
/// Land to which the size of wear effects refers, m.
pub(super) const LAND: f64 = 0.3e-3;

/// What a candidate does to the values of its channel, row by row.
pub(super) enum Action {
    /// Multiplies by `1 + size · slope`.
    Factor(Vec<f64>),
    /// Multiplies by `exp(size · slope)`.
    Power(Vec<f64>),
    /// Adds `size · slope`, SI.
    Add(Vec<f64>),
    /// Wear feeds itself.
    Acceleration,
}

impl Action {
    pub fn act(&self, size: f64, values: &mut [f64]) {
        match self {
            Self::Factor(slope) => each(values, slope, |value, slope| value * (1.0 + size * slope).max(0.01)),
            Self::Power(slope) => each(values, slope, |value, slope| value * (size * slope).exp()),
            Self::Add(slope) => each(values, slope, |value, slope| (value + size * slope).max(f64::MIN_POSITIVE)),
            Self::Acceleration => values.iter_mut().for_each(|value| *value = accelerated(*value, size)),
        }
    }
}

fn each(values: &mut [f64], slope: &[f64], change: impl Fn(f64, f64) -> f64) {
    values.iter_mut().zip(slope).for_each(|(value, slope)| *value = change(*value, *slope));
}

/// What the choice of candidates looks at.
pub(super) struct Seen<'a> {
    pub records: &'a Records,
    pub channel: ChannelId,
    pub groups: &'a [usize],
    /// Age of the edge at each row.
    pub age: &'a [f64],
    /// Conditions that the nominal response knows.
    pub known: &'a [String],
}

const FORCES: [ChannelId; 3] = [ChannelId::CuttingForce, ChannelId::FeedForce, ChannelId::PassiveForce];
const LOADS: [ChannelId; 6] = [
    ChannelId::CuttingForce,
    ChannelId::FeedForce,
    ChannelId::PassiveForce,
    ChannelId::SpindlePower,
    ChannelId::SpindleTorque,
    ChannelId::VibrationRms,
];
const HEAT: [ChannelId; 2] = [ChannelId::Temperature, ChannelId::ThermoEmf];
/// Conditions that a response may depend on.
const CONDITIONS: [&str; 6] =
    ["cutting_speed", "spindle_speed", "feed_per_rev", "feed_per_tooth", "depth_of_cut", "width_of_cut"];
/// Shares of a median life over which an edge may run in (assumption).
const RUN_IN: [f64; 3] = [1.0 / 30.0, 0.1, 1.0 / 3.0];

type Offered = Vec<(Candidate, Action)>;

/// Candidates that the records of a channel can show.
pub(super) fn candidates(seen: &Seen<'_>) -> Offered {
    let mut list = Vec::new();
    if seen.channel == ChannelId::FlankWear {
        growth(seen, &mut list);
    } else {
        wear(seen, &mut list);
    }
    if FORCES.contains(&seen.channel) {
        drift(seen, &mut list);
    }
    levels(seen, &mut list);
    conditions(seen, &mut list);
    if seen.channel == ChannelId::FlankWear {
        // After all that makes the land what it is.
        offer(&mut list, EffectId::WEAR_ACCELERATION, String::new(), 1.0, Action::Acceleration);
    }
    if seen.channel == ChannelId::CycleTime {
        let ones = vec![1.0; seen.records.len()];
        let durations = seen.records.numbers("cutting_time").unwrap_or(&ones);
        let delays = cutting_effects::delays(seen.records, seen.groups, durations).into_iter();
        list.extend(delays.map(|delay| (delay.candidate, Action::Add(delay.column))));
    }
    list
}

fn offer(list: &mut Offered, id: EffectId, shape: String, typical: f64, action: Action) {
    let varies = match &action {
        Action::Factor(slope) | Action::Power(slope) | Action::Add(slope) => standardised(slope).is_some(),
        Action::Acceleration => true,
    };
    if varies {
        list.push((Candidate { id, shape, typical, greatest: f64::INFINITY, least: 0.0, onset: 0.0 }, action));
    }
}

fn or_zero(values: impl Iterator<Item = f64>) -> Vec<f64> {
    values.map(|value| if value.is_finite() { value } else { 0.0 }).collect()
}

/// Median of the greatest age of the groups.
pub(super) fn life(age: &[f64], groups: &[usize]) -> f64 {
    let mut lives = vec![0.0_f64; groups.iter().max().map_or(0, |last| last + 1)];
    for (group, age) in groups.iter().zip(age) {
        lives[*group] = lives[*group].max(*age);
    }
    median(&mut lives)
}

/// The wear curve beside its nominal growth.
fn growth(seen: &Seen<'_>, list: &mut Offered) {
    let life = life(seen.age, seen.groups);
    let timed = seen.records.numbers("cutting_time").is_some_and(|times| times.iter().any(|time| *time > 0.0));
    for share in RUN_IN {
        let time = share * life;
        // Mean of exp(−t/τ) over the age: what a rate that falls so adds to the land.
        let slope =
            or_zero(seen.age.iter().map(|age| if *age > 0.0 { -(-age / time).exp_m1() * time / age } else { 1.0 }));
        let shape = if timed { format!("over {:.1} min", time / 60.0) } else { format!("over {time:.1} operations") };
        offer(list, EffectId::RUN_IN, shape, 1.5, Action::Factor(slope));
    }
    ageing(seen, list);
}

/// Whether a worn land presses harder on a channel than it drags.
pub(super) fn presses(channel: ChannelId) -> bool {
    matches!(channel, ChannelId::FeedForce | ChannelId::PassiveForce)
}

/// What grows with the land.
fn wear(seen: &Seen<'_>, list: &mut Offered) {
    let Some(land) = seen.records.numbers("flank_wear") else {
        ageing(seen, list);
        return;
    };
    let slope = |power: i32| or_zero(land.iter().map(|land| (land / LAND).powi(power)));
    if LOADS.contains(&seen.channel) {
        // Dorigueto's turning set: at 0.3 mm the main force is half as great again, the others treble.
        let typical = if presses(seen.channel) { 1.5 } else { 0.3 };
        offer(list, EffectId::WEAR_FORCE, String::new(), typical, Action::Factor(slope(1)));
        offer(list, EffectId::WEAR_FORCE, "square of the land".to_owned(), typical, Action::Factor(slope(2)));
    } else if HEAT.contains(&seen.channel) {
        offer(list, EffectId::WEAR_TEMPERATURE, String::new(), 0.1, Action::Factor(slope(1)));
    }
    ageing(seen, list);
}

fn ageing(seen: &Seen<'_>, list: &mut Offered) {
    let touched = HEAT.contains(&seen.channel) || seen.channel == ChannelId::FlankWear;
    if let Some(age) = seen.records.numbers("coolant_age").filter(|_| touched) {
        let greatest = age.iter().copied().filter(|age| age.is_finite()).fold(0.0, f64::max);
        offer(
            list,
            EffectId::COOLANT_AGEING,
            String::new(),
            0.1 / greatest,
            Action::Factor(or_zero(age.iter().copied())),
        );
    }
}

/// A sensor that drifts through the calendar, or while an edge is in use.
fn drift(seen: &Seen<'_>, list: &mut Offered) {
    let mut add = |shape: &str, times: &[f64]| {
        let latest = times.iter().copied().filter(|time| time.is_finite()).fold(0.0, f64::max);
        let slope = or_zero(times.iter().copied());
        offer(list, EffectId::FORCE_DRIFT, shape.to_owned(), 0.1 / latest, Action::Factor(slope));
    };
    if let Some(elapsed) = features::elapsed(seen.records) {
        add("calendar", &elapsed);
    }
    add("since the edge was new", seen.age);
}

/// Levels of lots, materials and coolants.
fn levels(seen: &Seen<'_>, list: &mut Offered) {
    let unknown: Vec<&str> =
        ["coolant_id", "lot", "material"].into_iter().filter(|name| seen.known.iter().all(|own| own != name)).collect();
    for (column, level, rows) in features::indicators(seen.records, &unknown) {
        let hard = LOADS.contains(&seen.channel) || seen.channel == ChannelId::FlankWear;
        match column.as_str() {
            "coolant_id" if seen.channel != ChannelId::CycleTime => {
                offer(list, EffectId::COOLANT_CHANGE, format!("coolant_id {level}"), 0.2, Action::Factor(rows));
            }
            "lot" | "material" if hard => {
                offer(list, EffectId::LOT_HARDNESS, format!("{column} {level}"), 0.2, Action::Factor(rows));
            }
            _ => {}
        }
    }
}

/// Conditions that the nominal response does not know.
fn conditions(seen: &Seen<'_>, list: &mut Offered) {
    for name in CONDITIONS.into_iter().filter(|name| seen.known.iter().all(|own| own != name)) {
        let Some(values) = seen.records.numbers(name) else { continue };
        let middle = median(&mut values.iter().copied().filter(|value| *value > 0.0).collect::<Vec<f64>>());
        for (sign, word) in [(1.0, "rises"), (-1.0, "falls")] {
            let slope = or_zero(values.iter().map(|value| sign * (value / middle).ln()));
            offer(list, EffectId::CONDITION_RESPONSE, format!("{word} with {name}"), 0.3, Action::Power(slope));
        }
    }
}

/// Growth of wear that feeds itself, `dW/dW₀ = 1 + φ (W/L)²` along the wear W₀ without it:
/// `W = (L/√φ) tan(√φ W₀/L)`.
fn accelerated(wear: f64, size: f64) -> f64 {
    let x = (size.sqrt() * wear / LAND).min(RUNAWAY);
    if x > 1e-6 { wear * x.tan() / x } else { wear }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn acceleration_solves_its_equation() {
        // Euler with small steps.
        let (size, end) = (0.8, 0.25e-3);
        let mut wear = 0.0;
        let steps = 200_000;
        for _ in 0..steps {
            wear += end / f64::from(steps) * (1.0 + size * (wear / LAND).powi(2));
        }
        assert!((accelerated(end, size) / wear - 1.0).abs() < 1e-4);
    }
}
