//! Effects of turning and milling that the diagnosis tries, with the shapes that the data ask for.

use super::constants::{FASTEST, OVERRIDDEN, SAVED};
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
    /// By the process, on the rows of the lot of this name.
    Lot(Effect, String, Vec<f64>),
    /// On the readings of channels, SI per size.
    Reading {
        /// Indices of the channels.
        channels: Vec<usize>,
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
                    Rows::Lot(name, rows) => Action::Lot(effect, name, rows),
                    Rows::All => Action::Effect(effect),
                    Rows::Coolant(_) | Rows::SinceDressing => unreachable!("only the way of lots is offered"),
                };
                (
                    Candidate {
                        id: effect_id,
                        shape: name,
                        typical,
                        greatest,
                        least: entry.size.min.min(0.0),
                        onset: 0.0,
                    },
                    action,
                )
            })),
            Err(reason) => untried.push(Untried { id: effect_id, reason }),
        }
    }
    if timed(seen.channels, ShopEffect::OperatorDelay).is_some() {
        list.extend(cycle(seen));
    }
    (list, untried)
}

/// Channels to which an effect of the shop adds time: the cycle time, and what its shape tells of stops; `None` where no
/// cycle time is compared.
pub(super) fn timed(channels: &[Channel], effect: ShopEffect) -> Option<Vec<usize>> {
    let place = |id: ChannelId| channels.iter().position(|channel| channel.id == id);
    let cycle = place(ChannelId::CycleTime)?;
    let stopped = place(ChannelId::StopTime).filter(|_| effect == ShopEffect::MicroStops);
    Some(std::iter::once(cycle).chain(stopped).collect())
}

/// Delays that a cycle time may hold.
fn cycle(seen: &Seen<'_>) -> Vec<(Candidate, Action)> {
    let overridden = seen.records.numbers("feed_override").is_some();
    let reading = |Delay { candidate, column, scope }: Delay| {
        let channels = timed(seen.channels, candidate.id.shop()?)?;
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
        let recorded = match candidate.id.shop() {
            Some(ShopEffect::FeedOverride) => overridden.then(|| mean(&column) / mean(seen.durations)),
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
        Some((candidate, Action::Reading { channels, column, scope, recorded }))
    };
    delays(seen.records, seen.groups, seen.durations).into_iter().filter_map(reading).collect()
}

/// Time that may be lost.
pub(super) struct Delay {
    /// The effect.
    pub candidate: Candidate,
    /// What it adds to the time of each row per size.
    pub column: Vec<f64>,
    /// Where it acts.
    pub scope: Scope,
}

/// What the middle operation takes beside its cut, s; 0 where no cycle time is recorded.
fn handling(records: &Records, durations: &[f64]) -> f64 {
    let cycles = records.numbers("cycle_time").unwrap_or_default();
    let mut beside: Vec<f64> = cycles.iter().zip(durations).map(|(cycle, cut)| cycle - cut).collect();
    beside.retain(|time| time.is_finite());
    if beside.is_empty() { 0.0 } else { toolroom_statistics::median(&mut beside).max(0.0) }
}

/// Delays by what is recorded.
pub(super) fn delays(records: &Records, groups: &[usize], durations: &[f64]) -> Vec<Delay> {
    let mut list = Vec::new();
    let mut add_on = |scope: Scope, shape: String, id: EffectId, [typical, least]: [f64; 2], column: Vec<f64>| {
        if standardised(&column).is_some() {
            let candidate = Candidate { id, shape, typical, greatest: f64::INFINITY, least, onset: 0.0 };
            list.push(Delay { candidate, column, scope });
        }
    };
    let handled = handling(records, durations);
    for (column, name, rows) in features::indicators(records, &["machine", "shift", "operator"]) {
        let key = SCOPE_NAMES.iter().find(|key| **key == column);
        let names = key.map(|key| (*key, vec![name.clone()])).into_iter().collect();
        let scope = Scope { names, ..Scope::default() };
        add_on(scope, format!("{column} {name}"), EffectId::OPERATOR_DELAY, [30.0, -SAVED * handled], rows);
    }
    let mut add = |id: EffectId, sizes: [f64; 2], column: Vec<f64>| {
        add_on(Scope::default(), String::new(), id, sizes, column);
    };
    add(EffectId::TOOL_CHANGE_DELAY, [30.0, 0.0], features::first_of_group(groups));
    if let Some(overrides) = records.numbers("feed_override") {
        let column = overrides
            .iter()
            .zip(durations)
            .map(|(share, time)| if *share > 0.0 { time * (share.recip() - 1.0) } else { 0.0 });
        add(EffectId::FEED_OVERRIDE, [1.0, 0.0], column.collect());
    } else {
        // Nobody recorded what the override was: all of the planned time is longer or shorter.
        add(EffectId::FEED_OVERRIDE, [OVERRIDDEN, FASTEST], durations.to_vec());
    }
    if let Some(stops) = records.numbers("stop_count") {
        let known = |stops: &f64| if stops.is_finite() { *stops } else { 0.0 };
        add(EffectId::FEED_HOLD, [20.0, 0.0], stops.iter().map(known).collect());
    }
    let stopped = durations.iter().map(|time| time * MICRO_STOP).collect();
    add(EffectId::MICRO_STOPS, [1.0 / 600.0, 0.0], stopped);
    list
}
