//! What the events of machines count beside the records of a process that runs on them: changes of edges, loading and
//! unloading, breakdowns.
//!
//! A table of operations leaves out the change of an edge, and one of trials has no times at all. What a change or a handling
//! takes is a fact of the log, and a constant of the file that it contradicts is one that is wrong.
//!
//! # Not asked
//! Changes of machines whose edges come from a crib or a magazine, where fetching and refilling is part of the time; handling
//! where jobs have several pieces, or machines take several jobs at a time.

use super::constants::{NINETY, PROBABLE};
use super::job_facts::{Jobs, WITHOUT_JOBS};
use super::queue::occasion;
use super::shift_labels::ShiftLabels;
use super::shop_facts::{of_failures, take_back};
use super::{Diagnosis, EffectId, GapVerdict, NamedEffect};
use std::collections::BTreeMap;
use toolroom_facts::law::RelativeLaw;
use toolroom_facts::middle::{Timed, agree, middle_and_scatter};
use toolroom_facts::{Fact, Quantity};
use toolroom_nominal::WrittenEffect;
use toolroom_nominal::shop::{Shop, Visit, Visits, visits};
use toolroom_records::Records;
use toolroom_scenario::{Deviation, Distribution, MachineType, Scenario, Scope, ShopConstant, ShopEffect, calibrated};

/// Tests what the `events` of machines count against the `scenario` that they run by, adds it to what the records of a
/// process say, and takes back that there is no gap where the log contradicts a constant of the file. `labels` are the shifts as
/// those records name them, `jobs` those that came to the shop, `seed` is that of replicated histories of breakdowns.
pub fn add_machine_facts(
    scenario: &Scenario,
    events: &Records,
    labels: &ShiftLabels,
    jobs: Option<&Jobs>,
    diagnosis: &mut Diagnosis,
    seed: u64,
) {
    let log = Log { shop: Shop::without_lives(scenario), seen: visits(events), scenario, labels };
    let mut facts = of_failures(&log.shop, &log.seen, false, seed);
    // A delay that the records of the process name is no constant beside it.
    let named = |id: EffectId| diagnosis.effects.iter().any(|effect| effect.id == id);
    let asked = [(HANDLING, EffectId::OPERATOR_DELAY), (CHANGE, EffectId::TOOL_CHANGE_DELAY)];
    for (timed, _) in asked.into_iter().filter(|(_, id)| !named(*id)) {
        facts.extend(timed.facts(&log));
    }
    if diagnosis.verdict == GapVerdict::CannotTell {
        return;
    }
    match jobs {
        Some(jobs) => facts.extend(jobs.facts(&log.shop, events, diagnosis, seed)),
        None => diagnosis.notes.push(WITHOUT_JOBS.to_owned()),
    }
    take_back(diagnosis, facts, Vec::new());
    let causes = diagnosis.findings.iter().filter_map(|own| cause(scenario, &diagnosis.facts[own.fact]));
    let causes: Vec<NamedEffect> = causes.collect();
    if !causes.is_empty() {
        diagnosis.verdict = GapVerdict::Effect;
        diagnosis.effects.extend(causes);
    }
}

/// The effect that a fact names; `None` of a constant.
fn cause(scenario: &Scenario, fact: &Fact) -> Option<NamedEffect> {
    let delay = fact.told.delay.as_ref().filter(|own| own.told)?;
    let id = EffectId::named(delay.effect)?;
    let half = NINETY * delay.standard_error;
    let machines: Vec<&str> = fact.place.split(", ").collect();
    let everywhere = scenario.machines.iter().all(|machine| machines.contains(&machine.name.as_str()));
    let machines = if everywhere { Vec::new() } else { machines.into_iter().map(str::to_owned).collect() };
    let mut names = vec![("machine", machines), ("shift", fact.told.shifts.clone())];
    names.retain(|(_, names)| !names.is_empty());
    let scope = Scope { names, ..Scope::default() };
    Some(NamedEffect {
        id,
        title: id.entry().title,
        empirical: false,
        shape: scope.words(),
        written: WrittenEffect { scope, ..WrittenEffect::default() },
        size: delay.size,
        unit: "s",
        ci90: [delay.size - half, delay.size + half],
        probability: PROBABLE,
        z: delay.size / delay.standard_error,
        // No evidence of records: a test of a log.
        gain: [f64::NAN; 2],
        class: vec![id],
        class_reason: String::new(),
    })
}

/// A log of machines, and what is said of them.
struct Log<'a> {
    shop: Shop,
    seen: Visits,
    scenario: &'a Scenario,
    labels: &'a ShiftLabels,
}

/// A time of machines that a log shows.
#[derive(Clone, Copy)]
struct Kind {
    quantity: Quantity,
    constant: ShopConstant,
    effect: ShopEffect,
}

const HANDLING: Kind =
    Kind { quantity: Quantity::HandlingTime, constant: ShopConstant::HandlingTime, effect: ShopEffect::OperatorDelay };
const CHANGE: Kind = Kind {
    quantity: Quantity::ToolChangeTime,
    constant: ShopConstant::ToolChangeTime,
    effect: ShopEffect::ToolChangeDelay,
};

/// Recorded time, and mean by the file, s.
type Pair = (f64, f64);

impl Kind {
    fn is_handling(self) -> bool {
        self.quantity == Quantity::HandlingTime
    }

    /// Mean by the file before any calibration, s, and how it scatters by the file.
    fn law(self, machine: &MachineType) -> (f64, RelativeLaw) {
        if !self.is_handling() {
            return (machine.tool_change_time, RelativeLaw::default());
        }
        let (load, unload) = (&machine.load_time, &machine.unload_time);
        let scatters = !(load.is_constant() && unload.is_constant());
        let law = || RelativeLaw::new(|uniform| load.quantile(uniform()) + unload.quantile(uniform()));
        (load.mean() + unload.mean(), if scatters { law() } else { RelativeLaw::default() })
    }

    /// Whether two machines have one law.
    fn alike(self, a: &MachineType, b: &MachineType) -> bool {
        if self.is_handling() {
            return a.load_time == b.load_time && a.unload_time == b.unload_time;
        }
        a.tool_change_time == b.tool_change_time
    }

    /// Whether a log of this scenario shows the times of a machine alone.
    fn is_alone(self, machine: &MachineType, scenario: &Scenario) -> bool {
        if self.is_handling() {
            return machine.batch.is_none();
        }
        scenario.shared.cribs.is_empty() && (machine.magazine == 0 || machine.refill_time == 0.0)
    }

    /// What the log of `machine` has of it in each shift.
    fn pairs(self, log: &Log<'_>, machine: usize, mean: f64) -> BTreeMap<String, Vec<Pair>> {
        let Log { shop, seen, scenario, labels } = log;
        let mut all: BTreeMap<String, Vec<Pair>> = BTreeMap::new();
        for visit in seen.list.iter().filter(|visit| visit.machine == machine) {
            let shift = labels.shift(shop, &seen.machines[machine], visit);
            let mut place = occasion(shop, seen, visit);
            place.set("shift", shift.clone());
            let moved = |value| calibrated(&scenario.calibrations, self.constant, &place, value);
            let delays: f64 = Deviation::acting(&scenario.deviations, self.effect, &place).map(|own| own.size).sum();
            // Of what is added by the file no factor is asked.
            let added = moved(0.0) + delays;
            let model = moved(mean) - moved(0.0);
            let times = self.times(visit).into_iter().map(|time| (time - added, model));
            all.entry(shift).or_default().extend(times);
        }
        all
    }

    fn times(self, visit: &Visit) -> Vec<f64> {
        if self.is_handling() { vec![visit.handling] } else { visit.changes.clone() }
    }

    /// The facts of all machines: of those of one law together where they agree, of each shift by itself where shifts
    /// differ, of each machine where machines do.
    fn facts(self, log: &Log<'_>) -> Vec<Fact> {
        let Log { seen, scenario, .. } = log;
        if self.is_handling() && !single_pieces(scenario) {
            return Vec::new();
        }
        let known = |(index, name): (usize, &String)| {
            let machine = scenario.machines.iter().find(|machine| machine.name == *name)?;
            self.is_alone(machine, scenario).then_some((index, machine))
        };
        let mut pools: Vec<Vec<(usize, &MachineType)>> = Vec::new();
        for own in seen.machines.iter().enumerate().filter_map(known) {
            match pools.iter_mut().find(|pool| self.alike(pool[0].1, own.1)) {
                Some(pool) => pool.push(own),
                None => pools.push(vec![own]),
            }
        }
        pools.iter().flat_map(|pool| self.of_pool(log, pool)).collect()
    }

    fn of_pool(self, log: &Log<'_>, pool: &[(usize, &MachineType)]) -> Vec<Fact> {
        let (mean, law) = self.law(pool[0].1);
        let cells: Vec<Cell> = pool
            .iter()
            .flat_map(|(index, machine)| {
                let of_shift = move |(shift, pairs)| Cell { machine: machine.name.clone(), shift, pairs };
                self.pairs(log, *index, mean).into_iter().map(of_shift)
            })
            .filter(|cell| !cell.pairs.is_empty())
            .collect();
        let fact = |cells: &[&Cell], shifts: &[String]| self.fact(cells, shifts, &law);
        let all: Vec<&Cell> = cells.iter().collect();
        if agreeing(&all) {
            return fact(&all, &[]);
        }
        let (shifts, machines) = (parts(&all, |cell| &cell.shift), parts(&all, |cell| &cell.machine));
        // Nothing is told of a shift without a name.
        let named = |own: &Vec<&Cell>| !own[0].shift.is_empty();
        if shifts.len() > 1 && shifts.iter().all(|own| named(own) && agreeing(own)) {
            return shifts.iter().flat_map(|own| fact(own, &[own[0].shift.clone()])).collect();
        }
        let of_machine = |own: &Vec<&Cell>| -> Vec<Fact> {
            if agreeing(own) {
                return fact(own, &[]);
            }
            let named = own.iter().filter(|cell| !cell.shift.is_empty());
            named.flat_map(|cell| fact(&[*cell], std::slice::from_ref(&cell.shift))).collect()
        };
        machines.iter().flat_map(of_machine).collect()
    }

    fn fact(self, cells: &[&Cell], shifts: &[String], law: &RelativeLaw) -> Vec<Fact> {
        let mut machines: Vec<&str> = cells.iter().map(|cell| cell.machine.as_str()).collect();
        machines.dedup();
        let place = machines.join(", ");
        let pairs: Vec<Pair> = cells.iter().flat_map(|cell| cell.pairs.iter().copied()).collect();
        middle_and_scatter(&Timed {
            quantity: self.quantity,
            effect: self.effect.word(),
            place: &place,
            pooled: machines.len() > 1,
            shifts,
            pairs: &pairs,
            law,
        })
    }
}

/// Times of one machine in one shift.
struct Cell {
    machine: String,
    shift: String,
    pairs: Vec<Pair>,
}

fn agreeing(cells: &[&Cell]) -> bool {
    agree(&cells.iter().map(|cell| cell.pairs.as_slice()).collect::<Vec<_>>())
}

/// Cells by a name that they have, in the order of the names.
fn parts<'a>(cells: &[&'a Cell], name: impl Fn(&Cell) -> &String) -> Vec<Vec<&'a Cell>> {
    let mut all: BTreeMap<String, Vec<&Cell>> = BTreeMap::new();
    for cell in cells {
        all.entry(name(cell).clone()).or_default().push(cell);
    }
    all.into_values().collect()
}

/// Whether a job is one piece whatever happens.
fn single_pieces(scenario: &Scenario) -> bool {
    let one = |quantity: &Distribution| *quantity == Distribution::Constant(1.0);
    scenario.arrivals.iter().all(|arrival| one(&arrival.quantity))
        && scenario.orders.iter().all(|own| own.quantity == 1)
}
