//! What the planner believes of the shop: a scenario seen by machines and programs.

use super::queueing::queueing;
use super::scaled::Scaled;
use super::stops::{Shape, lower_deviation};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::sync::Arc;
use toolroom_facts::survival::Life;
use toolroom_scenario::{
    Arrival, ArrivalPattern, Cut, Distribution, FailureMode, MachineTime, Occasion, PieceTimes, ProcessModel, Scenario,
    ShiftCalendar, ShopConstant, Stock, Work, calibrated,
};
use toolroom_shop::RunLog;
use toolroom_shop::programmed_cutting_times;
use toolroom_shop::runlog::{ChangeReason, EdgeRow, MachineState};
use toolroom_statistics::median;

/// Replications of a handling time behind its normal scores.
const REPLICATIONS: usize = 1000;
/// Longest stretch that is simulated for the lives of edges, s.
const STRETCH: f64 = 5.0 * 86400.0;

/// A program of the nominal shop.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Its times by pieces.
    pub pieces: PieceTimes,
    /// Programmed time in cut, of plain work the median of its distribution, s.
    pub time: f64,
    /// How its times lie about that by the file alone: plain work of a few possible times may be skewed; times in cut are not,
    /// nor are those on a scale where they are normal.
    pub planned: Shape,
    /// The distribution of its times by the file, s; `None` of times in cut, which have none.
    pub law: Option<Distribution>,
    /// Where its times are normal; `None` where they are taken as they are, as where a machine has a distribution of its own.
    pub scale: Option<Arc<Scaled>>,
    /// How much longer plain work takes on some machines than that (1), by their names.
    pub paces: BTreeMap<String, f64>,
    /// Sum of feed speeds over its passes, m/s: what the inverse of an acceleration costs.
    pub feed_speeds: f64,
}

/// A machine of the nominal shop.
#[derive(Clone, Debug)]
pub struct Station {
    /// Name.
    pub name: String,
    /// Process that it runs, in the word of its scenario.
    pub process: String,
    /// Replicated handling times of one operation, ascending, s.
    pub handling: Vec<f64>,
    /// Changing an edge, s.
    pub tool_change: f64,
    /// Why waits before it are not replicated, where they do not follow from ready jobs that are taken one by one in the order in
    /// which they came.
    pub queueing: Option<&'static str>,
    /// Its working time, where that has shifts.
    pub calendar: Option<ShiftCalendar>,
    /// How it breaks down.
    pub failures: Vec<FailureMode>,
    /// Time in cut of simulated edges, and whether they were worn out by then.
    pub lives: Vec<Life>,
    /// How long its edges last, where three of them wore out in the simulated shop.
    pub edge_life: Option<EdgeLife>,
}

/// How long the edges of a machine last in the nominal shop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLife {
    /// Mean logarithm of the time in cut of an edge, s.
    pub logarithm: f64,
    /// Growth of that time with the wear at which edges are changed, 1/m.
    pub growth: f64,
    /// Land at which edges are changed, m.
    pub land: f64,
}

/// A source of jobs that come by chance.
#[derive(Clone, Debug)]
pub struct JobSource {
    /// Its part, which no other source brings.
    pub part: String,
    /// Time between two jobs, s; what the file states of it is in it.
    pub interval: Distribution,
}

/// The nominal shop.
#[derive(Clone, Debug)]
pub struct Shop {
    /// Machines.
    pub stations: Vec<Station>,
    /// Programs by `part/operation`.
    pub programs: BTreeMap<String, Program>,
    /// Sources whose jobs a log tells from all others.
    pub sources: Vec<JobSource>,
    /// Parts of the other sources: of fixed times, of several parts, of parts that come from elsewhere as well.
    pub other_sources: Vec<String>,
}

impl Program {
    /// How much longer it takes on a machine than elsewhere, 1.
    pub fn pace_on(&self, machine: &str) -> f64 {
        self.paces.get(machine).copied().unwrap_or(1.0)
    }

    /// A time on a machine, s, as it would be if the logarithms of all were normal.
    pub fn normal_time(&self, machine: &str, time: f64) -> f64 {
        let middle = self.pace_on(machine) * self.time;
        self.scale.as_ref().map_or(time, |own| middle * own.scale.normal((time / middle).ln()).exp())
    }
}

impl Shop {
    /// The shop of a scenario. The lives of edges come from a simulation of its first policy.
    pub fn of(scenario: &Scenario) -> Self {
        // What the file states of the shop itself is counted from there, not simulated into it.
        let horizon = scenario.horizon.min(STRETCH);
        let stretch = Scenario { deviations: Vec::new(), calibrations: Vec::new(), horizon, ..scenario.clone() };
        Self::with_lives(scenario, &toolroom_shop::run(&stretch, 0, 0).unwrap_or_default())
    }

    /// The shop of a scenario without lives of edges, for whoever does not ask for them.
    pub fn without_lives(scenario: &Scenario) -> Self {
        Self::with_lives(scenario, &RunLog::default())
    }

    fn with_lives(scenario: &Scenario, log: &RunLog) -> Self {
        let failures: Vec<FailureMode> = scenario.failures.iter().map(|mode| stated(scenario, mode)).collect();
        let (sources, other_sources) = sources(scenario);
        // What the file states of the shop itself is counted from there, not simulated into it.
        let planned = Scenario { deviations: Vec::new(), calibrations: Vec::new(), ..scenario.clone() };
        let scenario = &planned;
        let times = programmed_cutting_times(scenario);
        let mut programs = BTreeMap::new();
        for (part, times) in scenario.parts.iter().zip(&times) {
            for (operation, time) in part.operations.iter().zip(times) {
                let feed_speeds = match &operation.work {
                    Work::Cutting(cuts) => {
                        let process = operation.tool.map(|tool| &scenario.tools[tool].process);
                        let feeds_of =
                            |process| cuts.iter().map(|cut| feed_speed(cut, *time / cuts.len() as f64, process)).sum();
                        process.map_or(0.0, feeds_of)
                    }
                    // Neither a wheel nor a planned contour runs at a programmed feed, plain work at none; the feeds of a
                    // part program are in its stretches.
                    Work::Plain(_) | Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_) | Work::Program(_) => {
                        0.0
                    }
                };
                let law = match &operation.work {
                    Work::Plain(times) => Some(times.clone()),
                    Work::Cutting(_) | Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_) | Work::Program(_) => {
                        None
                    }
                };
                let time = law.as_ref().map_or(*time, |law| law.quantile(0.5));
                let one_law = law.as_ref().filter(|_| !operation.has_own_times());
                let scale = one_law.and_then(Scaled::of).map(Arc::new);
                let planned = match (&law, &scale) {
                    (Some(law), None) => plain_shape(law),
                    (Some(_), Some(_)) | (None, _) => Shape::SYMMETRIC,
                };
                let on_machine = |(machine, _): &(usize, MachineTime)| {
                    let own = operation.own_time_on(*machine).map(|own| own.quantile(0.5) / time);
                    (scenario.machines[*machine].name.clone(), own.unwrap_or_else(|| operation.pace_on(*machine)))
                };
                let paces = operation.time_on.iter().map(on_machine).collect();
                let program =
                    Program { pieces: operation.piece_times(), time, planned, law, scale, paces, feed_speeds };
                programs.insert(format!("{}/{}", part.name, operation.name), program);
            }
        }
        let station = |index: usize| station(scenario, &failures, index, log);
        Self { stations: (0..scenario.machines.len()).map(station).collect(), programs, sources, other_sources }
    }

    /// The station of a machine's name.
    pub fn station(&self, name: &str) -> Option<&Station> {
        self.stations.iter().find(|station| station.name == name)
    }

    /// Name of the shift that holds a time: of the machine's calendar, or thirds of the day.
    pub fn shift(&self, machine: &str, time: f64) -> String {
        let calendar = self.station(machine).and_then(|station| station.calendar.as_ref());
        let third = || format!("S{}", ((time - 6.0 * 3600.0).rem_euclid(86400.0) / (8.0 * 3600.0)) as usize + 1);
        calendar.and_then(|calendar| calendar.shift_at(time)).unwrap_or_else(third)
    }
}

/// How the times of plain work lie about their middle by its distribution.
fn plain_shape(times: &Distribution) -> Shape {
    let middle = times.quantile(0.5);
    let quantile = |i: usize| times.quantile((i as f64 + 0.5) / REPLICATIONS as f64);
    let mut logarithms: Vec<f64> = (0..REPLICATIONS).map(quantile).map(|time| (time / middle).ln()).collect();
    let mut below: Vec<f64> = logarithms.iter().map(|y| -y).filter(|distance| *distance > 0.0).collect();
    let deviation = lower_deviation(&mut below);
    let known = deviation > 0.0 && logarithms.iter().all(|y| y.is_finite());
    if known { Shape::of(&mut logarithms, deviation) } else { Shape::SYMMETRIC }
}

/// Speed of the feed in a pass, m/s.
fn feed_speed(cut: &Cut, duration: f64, process: &ProcessModel) -> f64 {
    match process {
        ProcessModel::Milling(_) => cut.path_length / duration,
        ProcessModel::Turning(_) | ProcessModel::Infeed(_) | ProcessModel::Other(_) if cut.diameter > 0.0 => {
            cut.cutting_speed / (std::f64::consts::PI * cut.diameter) * cut.feed
        }
        ProcessModel::Turning(_) | ProcessModel::Infeed(_) | ProcessModel::Other(_) => 0.0,
    }
}

/// A law with what the file states of its mean at a place.
fn moved(scenario: &Scenario, constant: ShopConstant, place: &Occasion, law: &Distribution) -> Distribution {
    let mean = law.mean();
    let factor = calibrated(&scenario.calibrations, constant, place, mean) / mean;
    if factor.is_finite() && factor > 0.0 { law.scaled(factor) } else { law.clone() }
}

/// Sources of one part each, which nothing else brings, whose jobs come by chance; and the parts of all others.
fn sources(scenario: &Scenario) -> (Vec<JobSource>, Vec<String>) {
    let alone = |part: usize| {
        let bring = scenario.arrivals.iter().filter(|source| source.brings(part)).count();
        let refilled = |stock: &Stock| stock.reorder.as_ref().is_some_and(|reorder| reorder.lead.is_none());
        let stocked = scenario.shared.stocks.iter().any(|stock| stock.part == part && refilled(stock));
        bring == 1 && !stocked && scenario.orders.iter().all(|order| order.part != part)
    };
    let source = |own: &Arrival| {
        let [(part, _)] = own.parts[..] else { return None };
        let law = match &own.pattern {
            ArrivalPattern::Poisson { rate } => Distribution::Exponential { mean: 1.0 / rate },
            ArrivalPattern::Renewal(Distribution::Constant(_))
            | ArrivalPattern::Schedule(_)
            | ArrivalPattern::Batch { .. }
            | ArrivalPattern::ConstantWork { .. } => return None,
            ArrivalPattern::Renewal(law) => law.clone(),
        };
        let name = scenario.parts[part].name.clone();
        let mut place = Occasion::default();
        place.set("part", name.as_str());
        let interval = moved(scenario, ShopConstant::ArrivalInterval, &place, &law);
        alone(part).then_some(JobSource { part: name, interval })
    };
    let (mut tested, mut others) = (Vec::new(), Vec::new());
    for own in &scenario.arrivals {
        match source(own) {
            Some(source) => tested.push(source),
            None => others.push(own.parts_named(&scenario.parts)),
        }
    }
    (tested, others)
}

/// A failure mode with what the file states of its times: no block of a log is compared with them.
fn stated(scenario: &Scenario, mode: &FailureMode) -> FailureMode {
    let mut place = Occasion::default();
    place.set("machine", scenario.machines[mode.machine].name.as_str());
    let moved = |constant: ShopConstant, law: &Distribution| moved(scenario, constant, &place, law);
    FailureMode {
        time_between: moved(ShopConstant::TimeBetweenFailures, &mode.time_between),
        time_to_repair: moved(ShopConstant::TimeToRepair, &mode.time_to_repair),
        ..mode.clone()
    }
}

fn station(scenario: &Scenario, failures: &[FailureMode], index: usize, log: &RunLog) -> Station {
    let machine = &scenario.machines[index];
    let mut random = ChaCha8Rng::seed_from_u64(index as u64);
    let mut draw = || machine.load_time.quantile(random.random()) + machine.unload_time.quantile(random.random());
    let mut handling: Vec<f64> = (0..REPLICATIONS).map(|_| draw()).collect();
    handling.sort_by(f64::total_cmp);
    let edges = log.edges.iter().filter(|edge| edge.machine == index as u32 && edge.reason != ChangeReason::Dressing);
    let life = |edge: &EdgeRow| Life { time: edge.cutting_time, ended: edge.reason != ChangeReason::EndOfRun };
    Station {
        name: machine.name.clone(),
        process: machine.process.clone(),
        handling,
        tool_change: machine.tool_change_time,
        queueing: queueing(scenario, index),
        calendar: machine.calendar.map(|at| scenario.calendars[at].clone()),
        failures: failures.iter().filter(|mode| mode.machine == index).cloned().collect(),
        lives: edges.map(life).filter(|life| life.time > 0.0).collect(),
        edge_life: edge_life(log, index),
    }
}

/// How long edges of a machine last in a run.
fn edge_life(log: &RunLog, machine: usize) -> Option<EdgeLife> {
    // Machines of the log cut what they are given; edges still in them are not finished.
    let ended = |reason: ChangeReason| reason != ChangeReason::EndOfRun && reason != ChangeReason::Dressing;
    let edges = log.edges.iter().enumerate().filter(|(_, edge)| edge.machine == machine as u32 && ended(edge.reason));
    let logarithms: Vec<(usize, f64)> = edges.map(|(at, edge)| (at, edge.cutting_time.ln())).collect();
    let busy = log.states.iter().any(|row| row.machine == machine as u32 && row.state == MachineState::Cutting);
    if logarithms.len() < 3 || !busy {
        return None;
    }
    let mean = logarithms.iter().map(|(_, life)| life).sum::<f64>() / logarithms.len() as f64;
    let last = |edge: usize| log.passes.iter().rev().find(|pass| pass.edge == edge as u32);
    let slope = |(edge, life): &(usize, f64)| {
        let last = last(*edge)?;
        let rate = (last.flank_wear_end - last.flank_wear_start) / last.cutting_time;
        (rate > 0.0).then(|| 1.0 / (rate * life.exp()))
    };
    let mut slopes: Vec<f64> = logarithms.iter().filter_map(slope).collect();
    let mut lands: Vec<f64> = logarithms.iter().filter_map(|(edge, _)| Some(last(*edge)?.flank_wear_end)).collect();
    Some(EdgeLife { logarithm: mean, growth: median(&mut slopes), land: median(&mut lands) })
}
