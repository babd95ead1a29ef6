//! Whether a shop can do its work at all: load against capacity, and due dates that no dispatching can meet.
//!
//! Everything here is worked out without a simulation, from mean times.

mod earliest;
mod visits;

use crate::Warning;
use crate::presence::{absent, paid_twice};
use crate::truncated::truncated;
use std::collections::BTreeSet;
use std::iter::successors;
use toolroom_scenario::{
    Arrival, ArrivalPattern, BatchUnit, Interruption, Operation, Order, Presence, Scenario, WorkPer, date, station_name,
};
use toolroom_shop::programmed_cutting_times;
use visits::Visits;

/// Most warnings of one kind that are reported one by one.
const MOST_TOLD: usize = 20;

/// Memory of a job that waits, bytes: without a log of the run, and with one.
///
/// # Source
/// Measured: 360 000 jobs an hour before a server of 60 an hour, as the growth of the process between one and three hours:
/// 337 and 1690 bytes a job.
const BYTES_OF_JOB: [f64; 2] = [337.0, 1690.0];

/// s.
const DAY: f64 = 86_400.0;

/// What stations and operators have to do until the horizon.
#[derive(Clone, Debug)]
pub(crate) struct Workload {
    /// Stations in the order of the routings, then skills.
    pub loads: Vec<Load>,
    /// What cannot go well.
    pub warnings: Vec<Warning>,
}

/// Load of a station, or of everybody who has a skill.
#[derive(Clone, Debug)]
pub(crate) struct Load {
    /// Names of its machines joined by ` + `, or `skill NAME`.
    pub name: String,
    /// Machines or people.
    members: Vec<usize>,
    /// Work that nobody else can do, s, without setups.
    pub work: f64,
    /// One setup a lot, s.
    pub setup: f64,
    /// Working time from zero to the horizon, s.
    pub capacity: f64,
    /// Whether jobs that replace those that leave keep it at work as long as it works.
    pub endless: bool,
    /// Due dates of the orders among this work, s, each with its work, s.
    dues: Vec<(f64, f64)>,
}

impl Load {
    /// Work and setups over working time.
    pub fn share(&self) -> f64 {
        (self.work + self.setup) / self.capacity
    }
}

/// What an operation takes on the machine where it takes least, s.
struct Need {
    /// Loading and unloading a piece.
    handling: f64,
    /// Its setup.
    setup: f64,
}

/// The view of a scenario that both questions share.
struct Shop<'a> {
    scenario: &'a Scenario,
    /// Time of passes as programmed, s, by part and operation.
    cutting: Vec<Vec<f64>>,
    /// Groups of setups that come to each machine.
    groups: Vec<BTreeSet<&'a str>>,
}

/// What no rule of dispatching helps against: stations and skills with more work than working time, and a queue that would
/// fill the memory; `bound` is what the process may have, bytes, where it is bounded, and `logged` says whether logs are written.
///
/// It is worked out from mean times and speeds as programmed, without a simulation, so that it can be said before a run.
pub fn overloads(scenario: &Scenario, bound: Option<u64>, logged: bool) -> Vec<Warning> {
    let shop = Shop::new(scenario);
    let loads = shop.loads();
    let mut warnings: Vec<Warning> = loads
        .iter()
        .filter_map(|load| shop.overload(load))
        .map(|message| Warning { code: "overload", message })
        .collect();
    let more = warnings.len().saturating_sub(MOST_TOLD);
    warnings.truncate(MOST_TOLD);
    if more > 0 {
        warnings.push(Warning { code: "overload", message: format!("{more} more stations are overloaded") });
    }
    let waiting = shop.waiting(&loads);
    let bytes = waiting * BYTES_OF_JOB[usize::from(logged)];
    if let Some(bound) = bound.filter(|bound| bytes > *bound as f64) {
        warnings.push(Warning {
            code: "memory",
            message: format!(
                "some {waiting:.1e} jobs would wait at the horizon; they need some {:.1} GB, and the command may have {:.1} GB: it \
                 would end before",
                bytes / 1e9,
                bound as f64 / 1e9
            ),
        });
    }
    warnings
}

/// Works out load and earliest finishes.
pub(crate) fn workload(scenario: &Scenario) -> Workload {
    let shop = Shop::new(scenario);
    let loads = shop.loads();
    let mut warnings: Vec<Warning> = Vec::new();
    for load in &loads {
        warnings.extend(shop.overload(load).map(|message| Warning { code: "overload", message }));
    }
    warnings.extend(absent(scenario));
    warnings.extend(paid_twice(scenario));
    warnings.extend(truncated(scenario));
    warnings.extend(shop.never_replaced());
    let late: Vec<String> = scenario.orders.iter().filter_map(|order| shop.unreachable(order)).collect();
    let more = late.len().saturating_sub(MOST_TOLD);
    let late = late.into_iter().map(|message| Warning { code: "late", message });
    warnings.extend(late.take(MOST_TOLD));
    if more > 0 {
        let message = format!("due dates of {more} more orders cannot be reached");
        warnings.push(Warning { code: "late", message });
    }
    Workload { loads, warnings }
}

impl<'a> Shop<'a> {
    fn new(scenario: &'a Scenario) -> Self {
        let groups = vec![BTreeSet::new(); scenario.machines.len()];
        let mut shop = Self { scenario, cutting: programmed_cutting_times(scenario), groups };
        for (part, operation) in shop.lots() {
            let operation = &scenario.parts[part].operations[operation];
            for machine in &operation.machines {
                shop.groups[*machine].insert(&operation.setup_group);
            }
        }
        shop
    }

    /// Every station, and every skill that any operation needs.
    fn loads(&self) -> Vec<Load> {
        let scenario = self.scenario;
        let mut stations: Vec<Load> = Vec::new();
        let mut skills: Vec<Load> = Vec::new();
        for (part, operation) in self.lots() {
            let operation = &scenario.parts[part].operations[operation];
            let mut machines = operation.machines.clone();
            machines.sort_unstable();
            if !stations.iter().any(|load| load.members == machines) {
                let names = machines.iter().map(|&machine| scenario.machines[machine].name.as_str());
                let name = station_name(names);
                let capacity = self.capacity(machines.iter().map(|&each| scenario.machines[each].calendar), 0.0, None);
                stations.push(Load {
                    name,
                    members: machines,
                    work: 0.0,
                    setup: 0.0,
                    capacity,
                    endless: false,
                    dues: Vec::new(),
                });
            }
            let needed = [operation.attendance.setup, operation.attendance.load, operation.attendance.run];
            for skill in needed.into_iter().flatten() {
                let name = format!("skill {}", scenario.skills[skill]);
                if !skills.iter().any(|load| load.name == name) {
                    let members = self.skilled(skill);
                    let capacity =
                        self.capacity(members.iter().map(|&each| scenario.operators[each].calendar), 0.0, None);
                    skills.push(Load {
                        name,
                        members,
                        work: 0.0,
                        setup: 0.0,
                        capacity,
                        endless: false,
                        dues: Vec::new(),
                    });
                }
            }
        }
        for load in stations.iter_mut().chain(&mut skills) {
            load.members.sort_unstable();
        }
        for order in &scenario.orders {
            let pieces = f64::from(order.pieces());
            self.add(&mut stations, &mut skills, order.part, (pieces, 1.0), Some(order));
        }
        for arrival in &scenario.arrivals {
            for &(part, share) in &arrival.parts {
                let Some(jobs) = self.jobs(arrival).map(|jobs| share * jobs) else {
                    self.mark_endless(&mut stations, &mut skills, part);
                    continue;
                };
                self.add(&mut stations, &mut skills, part, (jobs * arrival.quantity.mean(), jobs), None);
            }
        }
        for (part, pieces, lots) in self.reordered() {
            self.add(&mut stations, &mut skills, part, (pieces, lots), None);
        }
        stations.append(&mut skills);
        stations
    }

    /// Components that the shop makes for a stock until the horizon: part, pieces and lots. What is needed of them beyond the
    /// stock at the start is made, in whole lots.
    fn reordered(&self) -> Vec<(usize, f64, f64)> {
        let scenario = self.scenario;
        let mut made = vec![0.0; scenario.parts.len()];
        scenario.orders.iter().for_each(|order| made[order.part] += f64::from(order.pieces()));
        for arrival in &scenario.arrivals {
            let jobs = self.jobs(arrival).unwrap_or(0.0) * arrival.quantity.mean();
            arrival.parts.iter().for_each(|(part, share)| made[*part] += share * jobs);
        }
        let mut lots_of = Vec::new();
        for stock in &scenario.shared.stocks {
            let Some(reorder) = stock.reorder.filter(|reorder| reorder.lead.is_none()) else { continue };
            let goes_into = scenario.parts.iter().zip(&made).flat_map(|(part, made)| {
                let own = part.components.iter().filter(|component| component.part == stock.part);
                own.map(move |component| f64::from(component.quantity) * made)
            });
            let missing = goes_into.sum::<f64>() - f64::from(stock.quantity);
            let lots = (missing / f64::from(reorder.lot)).ceil().max(0.0);
            lots_of.push((stock.part, lots * f64::from(reorder.lot), lots));
        }
        lots_of
    }

    /// Part and operation of everything that is ordered or arrives, each once.
    fn lots(&self) -> Vec<(usize, usize)> {
        let scenario = self.scenario;
        let ordered = scenario.orders.iter().map(|order| order.part);
        let come = scenario.arrivals.iter().flat_map(|arrival| &arrival.parts).map(|(part, _)| *part);
        let stocked = scenario.shared.stocks.iter().map(|stock| stock.part);
        let mut parts: Vec<usize> = ordered.chain(come).chain(stocked).collect();
        parts.sort_unstable();
        parts.dedup();
        parts
            .iter()
            .flat_map(|&part| (0..scenario.parts[part].operations.len()).map(move |each| (part, each)))
            .collect()
    }

    fn skilled(&self, skill: usize) -> Vec<usize> {
        let operators = self.scenario.operators.iter().enumerate();
        operators.filter(|(_, operator)| operator.skills.contains(&skill)).map(|(index, _)| index).collect()
    }

    /// Notes that a part which replaces itself comes to these stations and skills for as long as they can do it.
    fn mark_endless(&self, stations: &mut [Load], skills: &mut [Load], part: usize) {
        for operation in &self.scenario.parts[part].operations {
            let within = |load: &&mut Load| operation.machines.iter().all(|each| load.members.contains(each));
            stations.iter_mut().filter(within).for_each(|load| load.endless = true);
            let attendance = operation.attendance;
            for skill in [attendance.setup, attendance.load, attendance.run].into_iter().flatten() {
                let who = self.skilled(skill);
                let within = |load: &&mut Load| who.iter().all(|each| load.members.contains(each));
                skills.iter_mut().filter(within).for_each(|load| load.endless = true);
            }
        }
    }

    /// Jobs of sources that are not done at the horizon, by the most loaded station of their routing: expected number.
    fn waiting(&self, loads: &[Load]) -> f64 {
        let of_source = |arrival: &Arrival| {
            let jobs = self.jobs(arrival)?;
            let parts = arrival.parts.iter().map(|(part, _)| &self.scenario.parts[*part]);
            let shares = parts.flat_map(|part| &part.operations).flat_map(|operation| {
                let within = |load: &&Load| operation.machines.iter().all(|each| load.members.contains(each));
                loads.iter().filter(|load| !load.name.starts_with(SKILL)).filter(within).map(Load::share)
            });
            let most = shares.fold(1.0, f64::max);
            Some(jobs * (1.0 - 1.0 / most))
        };
        self.scenario.arrivals.iter().filter_map(of_source).sum()
    }

    /// Expected number of jobs until the horizon; `None` where each replaces one that leaves.
    fn jobs(&self, arrival: &Arrival) -> Option<f64> {
        let horizon = self.scenario.horizon;
        Some(match &arrival.pattern {
            ArrivalPattern::Schedule(rows) => {
                rows.iter().filter(|(time, _)| *time <= horizon).map(|(_, count)| f64::from(*count)).sum()
            }
            ArrivalPattern::Renewal(between) => horizon / between.mean(),
            ArrivalPattern::Poisson { rate } => rate * horizon,
            ArrivalPattern::Batch { interval, size } => (horizon / interval).ceil() * f64::from(*size),
            ArrivalPattern::ConstantWork { .. } => return None,
        })
    }

    /// Adds what a part takes to every station and skill that alone can do it: work for so many pieces, setups for
    /// so many lots; of an order what is left of it.
    fn add(
        &self,
        stations: &mut [Load],
        skills: &mut [Load],
        part: usize,
        (pieces, lots): (f64, f64),
        order: Option<&Order>,
    ) {
        let routed = &self.scenario.parts[part];
        let due = order.map(|order| order.due);
        let visited = Visits::of(routed);
        let begun = order.map_or(1.0, |order| self.begun(order, &visited));
        for (number, operation) in routed.operations.iter().enumerate() {
            let need = self.need(part, number);
            let visits = begun * visited.by_operation[number] * order.map_or(1.0, |order| order.share_left(number));
            if visits == 0.0 {
                continue;
            }
            let (pieces, lots) = (visits * sampled(operation, pieces), visits * lots);
            let alone = self.together(part, number, pieces, lots);
            let (handling, setup) = (pieces * need.handling, lots * need.setup);
            let work = handling + alone;
            // A station that has more machines than the operation may use has its work too.
            let within = |load: &&mut Load| operation.machines.iter().all(|each| load.members.contains(each));
            for load in stations.iter_mut().filter(within) {
                load.take(work, setup, due);
            }
            let run = match operation.attendance.presence {
                Presence::Whole => alone,
                Presence::Share(share) => share * alone,
                Presence::First(time) => alone.min(pieces * time),
            };
            let attended = [
                (operation.attendance.setup, 0.0, setup),
                (operation.attendance.load, handling, 0.0),
                (operation.attendance.run, run, 0.0),
            ];
            for (skill, work, setup) in attended {
                let Some(skill) = skill else { continue };
                let who = self.skilled(skill);
                let within = |load: &&mut Load| who.iter().all(|each| load.members.contains(each));
                for load in skills.iter_mut().filter(within) {
                    load.take(work, setup, due);
                }
            }
        }
    }

    /// Work without loading of so many pieces of so many lots, s: of a machine that makes batches in full ones.
    fn together(&self, part: usize, operation: usize, pieces: f64, lots: f64) -> f64 {
        let planned = &self.scenario.parts[part].operations[operation];
        let count = match planned.work_per {
            WorkPer::Part => pieces,
            WorkPer::Lot | WorkPer::Batch => lots,
        };
        let batch = planned.machines.iter().filter_map(|machine| self.scenario.machines[*machine].batch);
        let full = batch.map(|batch| match batch.by {
            BatchUnit::Pieces => pieces / f64::from(batch.max),
            BatchUnit::Lots => lots / f64::from(batch.max),
        });
        full.reduce(f64::min).unwrap_or(count) * self.alone(part, operation)
    }

    /// Plain work or passes of a piece, s, without loading, on the machine that takes least.
    fn alone(&self, part: usize, operation: usize) -> f64 {
        let machines = &self.scenario.parts[part].operations[operation].machines;
        machines.iter().map(|machine| self.alone_on(part, operation, *machine)).fold(f64::INFINITY, f64::min)
    }

    /// The same on a machine.
    fn alone_on(&self, part: usize, operation: usize, machine: usize) -> f64 {
        self.scenario.parts[part].operations[operation].mean_time_on(machine) + self.cutting[part][operation]
    }

    /// Handling of a piece on the machine where it takes least, and the least setup between groups.
    fn need(&self, part: usize, operation: usize) -> Need {
        let scenario = self.scenario;
        let planned: &Operation = &scenario.parts[part].operations[operation];
        let least =
            |of: &dyn Fn(usize) -> f64| planned.machines.iter().map(|&each| of(each)).fold(f64::INFINITY, f64::min);
        let handling = least(&|machine| {
            let machine = &scenario.machines[machine];
            machine.load_time.mean() + machine.unload_time.mean()
        });
        let setup = least(&|machine| {
            // Where nothing else comes, the machine stays set up.
            let stays = self.groups[machine].len() < 2;
            let machine = &scenario.machines[machine];
            let Some(matrix) = machine.setup_matrix.map(|index| &scenario.setup_matrices[index]) else {
                return if stays { 0.0 } else { planned.setup_time.unwrap_or(machine.setup_time) };
            };
            let Some(to) = matrix.group(&planned.setup_group) else { return 0.0 };
            let from = (0..matrix.times.len()).filter(|from| *from != to && !stays);
            from.map(|from| matrix.times[from][to]).reduce(f64::min).unwrap_or(matrix.times[to][to])
        });
        Need { handling, setup }
    }

    /// Working time of several calendars from `from` to `to`, the horizon where it is left out, s.
    fn capacity(&self, calendars: impl Iterator<Item = Option<usize>>, from: f64, to: Option<f64>) -> f64 {
        let to = to.unwrap_or(self.scenario.horizon);
        let time = |calendar: Option<usize>| {
            calendar.map_or((to - from).max(0.0), |index| self.scenario.calendars[index].work_done(from, to))
        };
        calendars.map(time).sum()
    }

    /// Time after the shifts of several calendars until `to` in which a step may be finished, s.
    fn finishing(&self, calendars: impl Iterator<Item = Option<usize>>, to: f64) -> f64 {
        let of = |index: usize| {
            let calendar = &self.scenario.calendars[index];
            let next = |time: &f64| calendar.next_boundary(*time).map(|next| next.time).filter(|time| *time <= to);
            let ends = successors(next(&0.0), next).filter(|time| !calendar.works_at(*time)).count();
            ends as f64 * calendar.finish_within
        };
        calendars.flatten().filter(|index| self.scenario.calendars[*index].finish_within > 0.0).map(of).sum()
    }

    /// What is wrong with the load of a station or skill.
    fn overload(&self, load: &Load) -> Option<String> {
        let hours = |seconds: f64| format!("{:.1} h", seconds / 3600.0);
        if load.share() > 1.0 {
            let excess = load.work + load.setup - load.capacity;
            return Some(format!(
                "{} is overloaded: {} of work and {} of setups until {}, but {} of working time ({:.0} %); the work that waits \
                 there grows by {} a day",
                load.name,
                hours(load.work),
                hours(load.setup),
                self.shown(self.scenario.horizon),
                hours(load.capacity),
                100.0 * load.share(),
                hours(excess * DAY / self.scenario.horizon),
            ));
        }
        let calendars = || {
            load.members.iter().map(|&each| match load.name.starts_with(SKILL) {
                true => self.scenario.operators[each].calendar,
                false => self.scenario.machines[each].calendar,
            })
        };
        let mut dues = load.dues.clone();
        dues.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut work = 0.0;
        let mut worst: Option<(f64, f64, f64)> = None;
        // Who finishes what was begun may go on after a shift: what is due then is not known by its hours.
        if calendars().flatten().any(|index| self.scenario.calendars[index].at_end == Interruption::Finish) {
            return None;
        }
        for (i, (due, content)) in dues.iter().enumerate() {
            work += content;
            if dues.get(i + 1).is_some_and(|next| next.0 == *due) || *due > self.scenario.horizon {
                continue;
            }
            let capacity = self.capacity(calendars(), 0.0, Some(*due)) + self.finishing(calendars(), *due);
            if work > capacity && worst.is_none_or(|(_, most, least)| work * least > most * capacity) {
                worst = Some((*due, work, capacity));
            }
        }
        let (due, work, capacity) = worst?;
        Some(format!(
            "{} cannot do in time what is due until {}: {} of work, but {} of working time until then",
            load.name,
            self.shown(due),
            hours(work),
            hours(capacity),
        ))
    }

    /// A time as people read it.
    fn shown(&self, time: f64) -> String {
        match self.scenario.start {
            Some(_) if time.is_infinite() => "any date".to_owned(),
            Some(start) => date::show(start + time),
            None => format!("{:.2} h", time / 3600.0),
        }
    }
}

/// How names of skills begin.
const SKILL: &str = "skill ";

impl Load {
    fn take(&mut self, work: f64, setup: f64, due: Option<f64>) {
        self.work += work;
        self.setup += setup;
        self.dues.extend(due.map(|due| (due, work)));
    }
}

/// Of so many pieces those on which an operation is done.
fn sampled(operation: &Operation, pieces: f64) -> f64 {
    let sample = operation.inspection.sample.filter(|_| operation.inspection.passes_by());
    sample.map_or(pieces, |sample| (pieces / f64::from(sample.every)).ceil())
}

#[cfg(test)]
mod tests;
