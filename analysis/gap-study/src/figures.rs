//! Key figures of the recorded shop, of its nominal model, and of the model with the effects.

use crate::closed::{Closed, Replicated};
use crate::{GapStudyError, Reading};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use toolroom_gap::shop::{Shop, ShopKpi, Visits, mix, pools_of, recorded_waits, visits};
use toolroom_gap::{ModelFileError, NominalModel, NominalProcess, Settings};
use toolroom_recording::simulated;
use toolroom_records::{RecordKind, Records};
use toolroom_scenario::Scenario;
use toolroom_scenario_file::read;
use toolroom_statistics::Moments;

/// Replications of either model. Assumption: with ten an interval by Student's t is less than a fifth wider than with many.
const REPLICATIONS: u32 = 10;
const DAY: f64 = 86400.0;

/// One key figure: of the recorded shop, of its nominal model, and of the model with the effects.
#[derive(Clone, Debug)]
pub struct Figure {
    name: &'static str,
    /// Machines of a figure of a station.
    station: Option<String>,
    unit: &'static str,
    values: Replicated,
}

impl Figure {
    /// For programs.
    pub fn json(&self) -> Value {
        let mean = |values: &[f64]| values.iter().copied().collect::<Moments>().mean();
        let closed = self.values.closed();
        json!({
            "kpi": self.name, "station": self.station, "unit": self.unit,
            "recorded": self.values.recorded, "standard_error": self.values.error,
            "nominal": mean(&self.values.nominal), "with_effects": mean(&self.values.applied),
            "replications": self.values.nominal.len(),
            "closed": closed.map(|own| own.share), "closed_ci90": closed.map(|own| own.ci90),
            "grew": self.values.grew(),
        })
    }

    /// What to say where the gap is larger with the effects than without them, for certain.
    pub fn warning(&self) -> Option<String> {
        let [before, after] = self.values.gaps();
        let words = || {
            format!(
                "the gap of {} grows from {} to {} {}: look at what was found before you go on with the model",
                self.words(),
                digits(before),
                digits(after),
                self.unit
            )
        };
        self.values.grew().then(words)
    }

    /// How far it closes; `None` where there is no gap.
    pub(crate) fn closed(&self) -> Option<Closed> {
        self.values.closed()
    }

    /// Whether its gap grows, for certain.
    pub(crate) fn grew(&self) -> bool {
        self.values.grew()
    }

    /// Its name, and of which machines it is.
    pub(crate) fn words(&self) -> String {
        let station = self.station.as_ref().map(|machines| format!(" {machines}"));
        format!("{}{}", self.name, station.unwrap_or_default())
    }

    /// Whether the log and every run tell it.
    fn is_told(&self) -> bool {
        let all = self.values.nominal.iter().chain(&self.values.applied);
        self.values.recorded.is_finite() && all.into_iter().all(|value| value.is_finite())
    }
}

/// Runs the shop of `model` and of `better`, the model with the effects, on common random numbers, and holds both against
/// the recorded events.
///
/// # Errors
/// [`GapStudyError`]: a file that cannot be read, a model that is no shop, a run that stops.
pub fn figures(model: &Path, better: &Path, data: &Path, reading: &Reading<'_>) -> Result<Vec<Figure>, GapStudyError> {
    let [figures] = compared(model, [better], data, &[], reading)?;
    Ok(figures)
}

/// The key figures by several models that take the place of the nominal one, all with the values of `set`.
pub(crate) fn compared<const N: usize>(
    model: &Path,
    others: [&Path; N],
    data: &Path,
    set: &[String],
    reading: &Reading<'_>,
) -> Result<[Vec<Figure>; N], GapStudyError> {
    let nominal = NominalModel::read(model, set)?;
    let scenario = || read(model, set).map(|file| file.scenario).map_err(ModelFileError::from);
    let (nominal, shop) = match nominal.process {
        NominalProcess::Shop(ref shop) => {
            let shop = (**shop).clone();
            (nominal, shop)
        }
        // What a process is missing shows in the shop that its file describes.
        NominalProcess::Turning(_) | NominalProcess::Milling(_) | NominalProcess::Grinding(_) => {
            let shop = Shop::of(&scenario()?);
            (NominalModel { process: NominalProcess::Shop(Box::new(shop.clone())), ..nominal }, shop)
        }
        NominalProcess::Empirical | NominalProcess::Program(_) => return Err(GapStudyError::NoShop),
    };
    let events = reading.records(data, &nominal).map_err(|error| {
        if let GapStudyError::Records(source) = error { GapStudyError::NoEvents { source } } else { error }
    })?;
    let seen = visits(&events);
    let mix = mix(&seen);
    let rates: BTreeMap<String, f64> =
        scenario()?.machines.iter().map(|machine| (machine.name.clone(), machine.rate)).collect();
    let of_log = |seen: &Visits| Figures::of(&shop, seen, &mix, &rates);
    // Days are batches of all figures but the availability, whose batches are machines.
    let (recorded, days) = (of_log(&seen), by_day(&seen).iter().map(of_log).collect::<Vec<Figures>>());
    let nominal_logs = runs(model, set)?;
    let before: Vec<Figures> = nominal_logs.iter().map(of_log).collect();
    let by = |after_logs: &[Visits]| {
        let after: Vec<Figures> = after_logs.iter().map(of_log).collect();
        let figure = |(at, (name, unit)): (usize, &(&'static str, &'static str))| {
            let values = |all: &[Figures]| all.iter().map(|own| own.0[at]).collect::<Vec<f64>>();
            let batches = if *name == AVAILABILITY { availabilities(&seen) } else { values(&days) };
            let (nominal, applied) = (values(&before), values(&after));
            let values = Replicated { recorded: recorded.0[at], error: error(&batches), nominal, applied };
            Figure { name, station: None, unit, values }
        };
        let of_shop = NAMES.iter().enumerate().map(figure);
        let wait = |machines: Vec<String>| queue_wait(&machines, &seen, [&nominal_logs, after_logs]);
        of_shop.chain(pools_of(&seen).into_iter().map(wait)).filter(Figure::is_told).collect::<Vec<Figure>>()
    };
    let mut all: [Vec<Figure>; N] = std::array::from_fn(|_| Vec::new());
    for (figures, other) in all.iter_mut().zip(others) {
        *figures = by(&runs(other, set)?);
    }
    Ok(all)
}

/// Mean wait of jobs before the machines of a pool, from the end of their operation before; of the first operation of a
/// job no log tells it. Days of the record are batches.
fn queue_wait(machines: &[String], visits: &Visits, [before, after]: [&[Visits]; 2]) -> Figure {
    let waits = |visits: &Visits| recorded_waits(visits, |name| machines.iter().any(|own| own == name));
    let mean = |visits: &Visits| waits(visits).iter().map(|(_, wait)| wait / 60.0).collect::<Moments>().mean();
    let mut days: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for (ready, wait) in waits(visits) {
        days.entry((ready / DAY).floor() as i64).or_default().push(wait / 60.0);
    }
    let days: Vec<f64> = days.into_values().map(|waits| waits.into_iter().collect::<Moments>().mean()).collect();
    let [nominal, applied] = [before, after].map(|logs| logs.iter().map(mean).collect());
    let values = Replicated { recorded: mean(visits), error: error(&days), nominal, applied };
    Figure { name: "queue_wait", station: Some(machines.join(", ")), unit: "min", values }
}

const AVAILABILITY: &str = "availability";
/// Names and units of the figures, in the order of [`Figures`].
const NAMES: [(&str, &str); 8] = [
    ("cycle_time", "s"),
    ("throughput", "1/h"),
    ("effectiveness", "1"),
    ("parts_per_shift", "1"),
    ("lead_time", "min"),
    (AVAILABILITY, "1"),
    ("oee", "1"),
    ("machine_cost_per_part", "currency"),
];

/// Key figures of one log. Cycle time, throughput and effectiveness are on the recorded mix of programs; a part is done with
/// the last operation that was seen of it; lead times begin with its first one. Cost is that of machines while they are
/// occupied or broken down: a log has no edges. The overall equipment effectiveness is the programmed time of complete
/// operations over the time in shift (ISO 22400-2, availability times effectiveness, in which production time cancels); a
/// log has no rejects, so that the quality ratio is taken as 1.
struct Figures([f64; NAMES.len()]);

impl Figures {
    fn of(shop: &Shop, visits: &Visits, mix: &BTreeMap<String, f64>, rates: &BTreeMap<String, f64>) -> Self {
        let kpi = ShopKpi::from_shop(shop, visits, mix);
        let mut jobs: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
        let mut shifts: BTreeSet<(i64, String)> = BTreeSet::new();
        let mut cost = 0.0;
        for visit in &visits.list {
            let times = jobs.entry(&visit.job).or_insert((visit.start, visit.end));
            *times = (times.0.min(visit.start), times.1.max(visit.end));
            let machine = &visits.machines[visit.machine];
            shifts.insert(((visit.start / DAY).floor() as i64, shop.shift(machine, visit.start)));
            let extra: f64 = visit.changes.iter().chain(&visit.holds).chain(&visit.stops).sum();
            let occupied = visit.cutting + visit.handling + visit.setup + extra;
            cost += rates.get(machine).copied().unwrap_or(0.0) * occupied;
        }
        let earned: f64 = visits
            .list
            .iter()
            .filter_map(|visit| shop.programs.get(&visits.programs[visit.program]))
            .map(|own| own.time)
            .sum();
        let in_shift: f64 = visits.in_shift.iter().flatten().map(|(from, to)| to - from).sum();
        let (mut up, mut down) = (0.0, 0.0);
        for (machine, own) in visits.breakdowns.iter().enumerate() {
            let repairs: f64 = own.repairs.iter().sum();
            (up, down) = (up + own.up, down + repairs);
            cost += rates.get(&visits.machines[machine]).copied().unwrap_or(0.0) * repairs;
        }
        let parts = jobs.len() as f64;
        let lead = jobs.values().map(|(from, to)| to - from).sum::<f64>() / parts;
        Self([
            kpi.cycle_time,
            3600.0 * kpi.throughput,
            kpi.effectiveness,
            parts / shifts.len() as f64,
            lead / 60.0,
            up / (up + down),
            earned / in_shift,
            if rates.values().any(|rate| *rate > 0.0) { cost / parts } else { f64::NAN },
        ])
    }
}

/// The log day by day: operations that began on it. Breakdowns have no day, and no part in it.
fn by_day(visits: &Visits) -> Vec<Visits> {
    let day = |time: f64| (time / DAY).floor() as i64;
    let days: BTreeSet<i64> = visits.list.iter().map(|visit| day(visit.start)).collect();
    let one = |today: i64| {
        let list = visits.list.iter().filter(|visit| day(visit.start) == today).cloned().collect();
        let (from, to) = (today as f64 * DAY, (today + 1) as f64 * DAY);
        let inside = |stays: &Vec<(f64, f64)>| {
            stays.iter().map(|own| (own.0.max(from), own.1.min(to))).filter(|own| own.0 < own.1).collect()
        };
        Visits {
            list,
            breakdowns: Vec::new(),
            in_shift: visits.in_shift.iter().map(inside).collect(),
            ..visits.clone()
        }
    };
    days.into_iter().map(one).collect()
}

/// Share of the time that each machine was not broken down.
fn availabilities(visits: &Visits) -> Vec<f64> {
    visits.breakdowns.iter().map(|own| own.up / (own.up + own.repairs.iter().sum::<f64>())).collect()
}

/// Standard error of the mean of batches; those without a value do not count. Of fewer than two nothing is known: zero.
fn error(batches: &[f64]) -> f64 {
    let known: Moments = batches.iter().copied().filter(|value| value.is_finite()).collect();
    if known.count() < 2 { 0.0 } else { known.standard_error() }
}

/// Logs of the replications of a model.
fn runs(model: &Path, set: &[String]) -> Result<Vec<Visits>, GapStudyError> {
    let scenario = read(model, set).map_err(ModelFileError::from)?.scenario;
    (0..REPLICATIONS).map(|replication| run(&scenario, replication)).collect()
}

fn run(scenario: &Scenario, replication: u32) -> Result<Visits, GapStudyError> {
    let log = toolroom_shop::run(scenario, 0, replication)?;
    let all = simulated(scenario, &log, &|_, channel| Settings::default().sensor(channel))?;
    let events = all.iter().find(|records: &&Records| records.kind == RecordKind::Shop);
    Ok(events.map(visits).unwrap_or_default())
}

/// Four significant digits.
fn digits(value: f64) -> String {
    format!("{value:.3e}").parse().unwrap_or(value).to_string()
}

/// The figures as people read them.
pub fn table(figures: &[Figure]) -> String {
    let mut text = format!(
        "{:32} {:>16} {:>10} {:>14} {:>20}  {}\n",
        "on recorded mix", "recorded", "nominal", "with effects", "gap before → after", "closed (90 %)"
    );
    for figure in figures {
        let (words, Figure { unit, values, .. }) = (figure.words(), figure);
        let name = if *unit == "1" { words } else { format!("{words}, {unit}") };
        let [before, after] = values.gaps();
        let closed = match values.closed() {
            Some(own) => {
                let [low, high] = own.ci90.map(|end| 100.0 * end);
                format!("{:.0} % ({low:.0} … {high:.0})", 100.0 * own.share)
            }
            None => "no gap in this figure".to_owned(),
        };
        let recorded =
            format!("{} ± {}", digits(values.recorded), format!("{:.1e}", values.error).parse().unwrap_or(0.0));
        let _ = writeln!(
            text,
            "{name:32} {recorded:>16} {:>10} {:>14} {:>20}  {closed}",
            digits(values.recorded - before),
            digits(values.recorded - after),
            format!("{} → {}", digits(before), digits(after)),
        );
    }
    text
}
