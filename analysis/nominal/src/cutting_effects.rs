//! Effects of turning and milling that the diagnosis tries, with the shapes that the data ask for.

use super::features::{self, standardised};
use super::search::{self, Rows, SearchContext, Shape, Way};
use super::{Candidate, Channel, ChannelId, EffectId, Untried};
use toolroom_effects::{Definition, Effect, Search};
use toolroom_records::Records;
use toolroom_scenario::{MICRO_STOP, SCOPE_NAMES, Scope, ShopEffect};

/// Which prior a constant has.
pub(super) enum Prior {
    /// Of force coefficients.
    Force,
    /// Of edge forces, which a fit over thicker chips extrapolates.
    Edge,
    /// Of temperature coefficients.
    Temperature,
    /// Of the wear-rate level.
    Wear,
}

/// Constants that calibration may move: group and name; those that a process lacks are skipped.
pub(super) const CONSTANTS: &[(&str, &str, Prior)] = &[
    ("force", "specific_force", Prior::Force),
    ("force", "flank_shear_stress", Prior::Force),
    ("force", "flank_pressure", Prior::Force),
    ("force", "tangential_cutting", Prior::Force),
    ("force", "tangential_edge", Prior::Edge),
    ("force", "radial_cutting", Prior::Force),
    ("force", "radial_edge", Prior::Edge),
    ("temperature", "chip_heating", Prior::Temperature),
    ("temperature", "flank_heating", Prior::Temperature),
    ("energy_balance", "thermal_wear_rate", Prior::Wear),
    ("energy_balance", "run_in_land", Prior::Wear),
    ("life", "stage_contrast", Prior::Wear),
];

/// How a candidate acts.
pub(super) enum Action {
    /// By the process.
    Effect(Effect),
    /// By the process on the rows of a scope, 1 or 0 each.
    Scoped(Effect, Scope, Vec<f64>),
    /// By the process, on the rows of one lot.
    Lot(Effect, Vec<f64>),
    /// On the reading of a channel, SI per size.
    Reading {
        /// Index of the channel.
        channel: usize,
        /// One number a row.
        column: Vec<f64>,
        /// Operations on which it acts.
        scope: Scope,
        /// Mean of what the records hold of it, where the column is made of that.
        recorded: Option<f64>,
    },
}

/// What the choice of candidates looks at.
pub(super) struct Seen<'a> {
    /// Effects that the user has defined.
    pub defined: &'a [&'static Definition],
    pub records: &'a Records,
    pub groups: &'a [usize],
    pub durations: &'a [f64],
    pub channels: &'a [Channel],
}

/// Candidates of a process that can show in the recorded channels at all, and effects that are not tried.
pub(super) fn candidates(process: &'static str, seen: &Seen<'_>) -> (Vec<(Candidate, Action)>, Vec<Untried>) {
    let (mut list, mut untried) = (Vec::new(), Vec::new());
    let measured = |name: &str| seen.channels.iter().any(|channel| channel.id.word() == name);
    let greatest = |quantity: &str| match quantity {
        // Sensor and machine are as old as the records.
        "sensor_time" | "machine_time" => {
            let times = features::elapsed(seen.records)?;
            Some(times.into_iter().filter(|time| time.is_finite()).fold(0.0, f64::max))
        }
        column => search::greatest(seen.records, column),
    };
    let sought = SearchContext { process, records: seen.records, greatest: &greatest, ways: &[Way::Lots] };
    for effect in &search::effects_of(process, seen.defined) {
        let (effect_id, entry) = (EffectId::from(effect), effect.entry());
        let touched: Vec<&str> = entry.channels.iter().map(|touched| touched.channel).collect();
        let shapes = match entry.search(process) {
            Some(Search::Untried(reason)) => Err(reason.to_owned()),
            _ if !touched.iter().any(|channel| measured(channel)) => {
                Err(format!("no channel that it moves is compared: {}", touched.join(", ")))
            }
            _ => sought.shapes(*effect),
        };
        match shapes {
            Ok(shapes) => list.extend(shapes.into_iter().map(|shape| {
                let Shape { name, effect, typical, greatest, rows } = shape;
                let action = match rows {
                    Rows::Lot(rows) => Action::Lot(effect, rows),
                    Rows::All => Action::Effect(effect),
                    Rows::Coolant(_) | Rows::SinceDressing => unreachable!("only the way of lots is offered"),
                };
                (Candidate { id: effect_id, shape: name, typical, greatest, least: entry.size.min.min(0.0) }, action)
            })),
            Err(reason) => untried.push(Untried { id: effect_id, reason }),
        }
    }
    if let Some(channel) = seen.channels.iter().position(|channel| channel.id == ChannelId::CycleTime) {
        list.extend(cycle(channel, seen));
    }
    (list, untried)
}

/// Delays that a cycle time may hold.
fn cycle(channel: usize, seen: &Seen<'_>) -> Vec<(Candidate, Action)> {
    let reading = |(candidate, column): (Candidate, Vec<f64>)| {
        let scope = candidate.shape.split_once(' ').and_then(|(column, name)| {
            let key = SCOPE_NAMES.iter().find(|key| **key == column)?;
            Some(Scope { names: vec![(*key, vec![name.to_owned()])], ..Scope::default() })
        });
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
        let recorded = match candidate.id.shop() {
            Some(ShopEffect::FeedOverride) => Some(mean(&column) / mean(seen.durations)),
            Some(ShopEffect::FeedHold) => Some(mean(&column)),
            Some(
                ShopEffect::MicroStops
                | ShopEffect::OperatorDelay
                | ShopEffect::ToolChangeDelay
                | ShopEffect::ToolChangePolicy
                | ShopEffect::BreakdownShape,
            )
            | None => None,
        };
        let scope = scope.unwrap_or_default();
        (candidate, Action::Reading { channel, column, scope, recorded })
    };
    delays(seen.records, seen.groups, seen.durations).into_iter().map(reading).collect()
}

/// Delays by what is recorded, with what each adds to the time of a row per size.
pub(super) fn delays(records: &Records, groups: &[usize], durations: &[f64]) -> Vec<(Candidate, Vec<f64>)> {
    let mut list = Vec::new();
    let mut add = |id: EffectId, shape: String, typical: f64, column: Vec<f64>| {
        if standardised(&column).is_some() {
            list.push((Candidate { id, shape, typical, greatest: f64::INFINITY, least: 0.0 }, column));
        }
    };
    add(EffectId::TOOL_CHANGE_DELAY, String::new(), 30.0, features::first_of_group(groups));
    for (column, name, rows) in features::indicators(records, &["machine", "shift", "operator"]) {
        add(EffectId::OPERATOR_DELAY, format!("{column} {name}"), 30.0, rows);
    }
    if let Some(overrides) = records.numbers("feed_override") {
        let column = overrides
            .iter()
            .zip(durations)
            .map(|(share, time)| if *share > 0.0 { time * (share.recip() - 1.0) } else { 0.0 });
        add(EffectId::FEED_OVERRIDE, String::new(), 1.0, column.collect());
    }
    if let Some(stops) = records.numbers("stop_count") {
        let known = |stops: &f64| if stops.is_finite() { *stops } else { 0.0 };
        add(EffectId::FEED_HOLD, String::new(), 20.0, stops.iter().map(known).collect());
    }
    add(EffectId::MICRO_STOPS, String::new(), 1.0 / 600.0, durations.iter().map(|time| time * MICRO_STOP).collect());
    list
}
