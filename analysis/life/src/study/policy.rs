//! How the speed of an edge is chosen in a study.

use super::Passes;
use super::edge::rehearsed;
use std::sync::Arc;
use toolroom_scenario::{Course, Knowledge, SensorSheet, SpeedChoice, SpeedRule};
use toolroom_wear::{
    Coefficients, Contact, Cut, Measurement, Objective, Observer, Pair, RampLimits, SetSpeed, SpeedLaw, SpeedSchedule,
    SpeedTable, ramp_limits,
};

/// A speed rule of a shop, and what a shop would add to it, before it is worked out for a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// How the speed is chosen.
    pub speed: SpeedRule,
    /// What it knows of its edge, where it follows wear.
    pub knows: Knowledge,
    /// What it costs to change an edge; only some rules weigh it.
    pub change: ChangeCost,
}

/// What it costs to change an edge. A shop takes it from its machine and its tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChangeCost {
    /// Time of a change, s.
    pub time: f64,
    /// Price of an edge, currency.
    pub edge: f64,
    /// Price of the machine, currency per second; 0: only edges cost.
    pub machine: f64,
}

impl From<SpeedRule> for Rule {
    /// The rule with its sensors (an oracle with the true wear) and changes that cost nothing.
    fn from(speed: SpeedRule) -> Self {
        let knows = if speed == SpeedRule::Oracle { Knowledge::Wear } else { Knowledge::Sensors };
        Self { speed, knows, change: ChangeCost::default() }
    }
}

impl ChangeCost {
    /// Least cost as an objective; without a machine price only edges cost.
    fn objective(&self) -> Objective {
        if self.machine > 0.0 {
            Objective::Cost { change_time: self.time, edge_cost: self.edge, machine_cost: self.machine }
        } else {
            Objective::Path
        }
    }

    /// Time that a change is worth: its own and that which the price of the edge would buy, s.
    fn worth(&self) -> f64 {
        self.objective().change_time().unwrap_or(self.time)
    }
}

/// When the sensors are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// At the end of every pass.
    Pass,
    /// Every sampling period of the sensors.
    Period,
}

#[derive(Clone, Debug)]
enum Speed {
    Constant(f64),
    Schedule(SpeedSchedule),
    /// A law of flank wear, and its speed for nominal edges.
    Planned {
        law: SpeedLaw,
        table: SpeedTable,
    },
    /// The wear left, shared out over what is left of this path, m.
    SetIncrement(f64),
}

/// A rule worked out for one nominal cut.
#[derive(Clone, Debug)]
pub struct Policy {
    speed: Speed,
    knows: Knowledge,
    pair: Arc<Pair>,
    cut: Cut,
    /// Contact of the pair in the nominal cut.
    contact: Coefficients,
    sensors: SensorSheet,
    reading: Reading,
    template: Option<Observer>,
    ramp: RampLimits,
}

/// Speed over one pass, linear in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// At the start, m/s.
    pub start: f64,
    /// At the end, m/s.
    pub end: f64,
}

/// What a policy remembers of one edge.
#[derive(Clone, Debug)]
pub struct Pilot<'a> {
    observer: Option<Observer>,
    /// The edge as it is.
    pair: &'a Pair,
    cut: Cut,
    last_speed: Option<f64>,
}

impl Policy {
    /// Works a rule out on the nominal `pair` at the nominal `cut`, for lives in `passes` with a
    /// `lagged` body or not; `allowance` (m) is the scatter of depth that the observer reckons with.
    pub fn new(
        rule: Rule,
        (pair, cut): (&Pair, &Cut),
        (passes, lagged): (Passes, bool),
        allowance: f64,
        (sensors, reading): (SensorSheet, Reading),
    ) -> Self {
        let limits = pair.limits;
        let planned = |law: SpeedLaw| {
            let speed = |wear: f64| limits.clip(pair.speed_by_law(cut, law, wear));
            Speed::Planned { law, table: SpeedTable::tabulate(limits.wear_limit, speed) }
        };
        let speed = match rule.speed.entry().course {
            Course::Programmed => Speed::Constant(cut.cutting_speed),
            Course::Constant(choice) => Speed::Constant(constant(choice, rule.change, pair, cut)),
            Course::Schedule => Speed::Schedule(rehearsed(pair, cut, passes, lagged)),
            Course::Law(law) => planned(law),
            Course::Price(price) => {
                let optimum = || pair.rate_optimum(cut, rule.change.worth()).shadow_price;
                planned(SpeedLaw::ShadowPrice(price.unwrap_or_else(optimum)))
            }
            Course::SetIncrement(path_per_edge) => Speed::SetIncrement(path_per_edge),
        };
        let noise = sensors.observer_noise(allowance);
        let follows = matches!(speed, Speed::Planned { .. } | Speed::SetIncrement(_));
        let observes = follows && rule.knows == Knowledge::Sensors;
        Self {
            template: observes.then(|| Observer::new(pair, noise)),
            speed,
            knows: rule.knows,
            pair: Arc::new(pair.clone()),
            cut: *cut,
            contact: pair.contact(cut).coefficients(),
            sensors,
            reading,
            ramp: ramp_limits(pair),
        }
    }

    /// The speed of a policy that never changes it, m/s.
    pub fn constant(&self) -> Option<f64> {
        if let Speed::Constant(speed) = self.speed { Some(speed) } else { None }
    }

    /// The sensors of a policy that reads some.
    pub fn sensors(&self) -> Option<&SensorSheet> {
        self.template.as_ref().map(|_| &self.sensors)
    }

    /// Time between readings in a pass of this duration, s; infinite where nothing is read.
    pub fn sampling(&self, duration: f64) -> f64 {
        match (&self.template, self.reading) {
            (None, _) => f64::INFINITY,
            (_, Reading::Pass) => duration,
            (_, Reading::Period) => self.sensors.sampling_period.min(duration),
        }
    }

    /// A pilot for a new edge, of which only an oracle gets to know how it differs from nominal.
    pub fn pilot<'a>(&self, pair: &'a Pair, cut: Cut) -> Pilot<'a> {
        Pilot { observer: self.template.clone(), pair, cut, last_speed: None }
    }
}

impl Pilot<'_> {
    /// The speeds of the next pass of `length` (m) of an edge that has cut `path` (m).
    pub fn plan(&mut self, policy: &Policy, true_wear: f64, path: f64, length: f64) -> Ramp {
        if let Some(observer) = &mut self.observer {
            observer.begin_pass(policy.cut.depth_of_cut);
        }
        let ramp = match &policy.speed {
            Speed::Constant(speed) => Ramp { start: *speed, end: *speed },
            Speed::Schedule(schedule) => Ramp { start: schedule.speed_at(path), end: schedule.speed_at(path + length) },
            Speed::Planned { law, table } => {
                let (contact, known) = self.known(policy, true_wear);
                let nominal = |wear: f64| (table.speed_at(wear), true);
                let of_edge =
                    |wear: f64| (policy.pair.limits.clip(self.pair.speed_by_law(&self.cut, *law, wear)), true);
                match policy.knows {
                    Knowledge::Edge => policy.planned(of_edge, contact, known, length, self.last_speed),
                    Knowledge::Sensors | Knowledge::Wear => {
                        policy.planned(nominal, contact, known, length, self.last_speed)
                    }
                }
            }
            Speed::SetIncrement(path_per_edge) => {
                let (contact, known) = self.known(policy, true_wear);
                let (pair, cut) = match policy.knows {
                    Knowledge::Edge => (self.pair, &self.cut),
                    Knowledge::Sensors | Knowledge::Wear => (&*policy.pair, &policy.cut),
                };
                let limits = &policy.pair.limits;
                let intensity = (limits.wear_limit - known.0).max(0.0) / (path_per_edge - path).max(length);
                let law = |wear: f64| {
                    let SetSpeed { cutting_speed, feasible } = pair.set_intensity_speed(cut, wear, intensity);
                    (limits.clip(cutting_speed), feasible)
                };
                policy.planned(law, contact, known, length, self.last_speed)
            }
        };
        self.last_speed = Some(ramp.end);
        ramp
    }

    /// The contact that the policy reckons with, and flank wear (m) and factor of wear as far as it knows them.
    fn known<'c>(&'c self, policy: &'c Policy, true_wear: f64) -> (Contact<'c>, (f64, f64)) {
        if policy.knows == Knowledge::Edge {
            return (self.pair.contact(&self.cut), (true_wear, 1.0));
        }
        let estimate = self.observer.as_ref().map(Observer::estimate);
        let known = estimate.map_or((true_wear, 1.0), |known| (known.flank_wear.max(0.0), known.ln_wear_factor.exp()));
        (policy.pair.contact_of(policy.contact), known)
    }

    /// Takes a reading `dt` seconds after the last one.
    pub fn see(&mut self, policy: &Policy, mean_speed: f64, speed: f64, dt: f64, measured: &Measurement) {
        if let Some(observer) = &mut self.observer {
            observer.predict(&policy.cut.at_speed(mean_speed), dt);
            observer.update(&policy.cut.at_speed(speed), measured);
        }
    }
}

impl Policy {
    /// Speeds by a law of wear, which also says whether it meets its demand, at both ends of a pass, the wear at its end by the midpoint rule on
    /// the believed contact times the estimated factor of this edge. The first pass starts at the
    /// speed of the law, however far from the programmed one.
    fn planned(
        &self,
        law: impl Fn(f64) -> (f64, bool),
        contact: Contact<'_>,
        (wear, factor): (f64, f64),
        length: f64,
        last: Option<f64>,
    ) -> Ramp {
        let limits = &self.pair.limits;
        let mut near_start = None;
        let growth = |start: f64, before: Option<(f64, f64)>| {
            let contact = near_start.get_or_insert_with(|| contact.at_speed(start));
            let (land, speed) = before.map_or((wear, start), |(end, grown)| (wear + 0.5 * grown, 0.5 * (start + end)));
            let intensity = contact.near_speed(speed).steady_wear(land).intensity(speed);
            (factor * intensity * length).min(limits.wear_limit)
        };
        let ramp = self.ramp.ramp(limits, wear, length, last, law, growth);
        Ramp { start: ramp.start_speed, end: ramp.end_speed }
    }
}

/// A constant speed on the nominal pair, m/s.
fn constant(choice: SpeedChoice, change: ChangeCost, pair: &Pair, cut: &Cut) -> f64 {
    let best = |objective| pair.best_constant_speed(cut, objective).cutting_speed;
    match choice {
        SpeedChoice::Given(speed) => speed,
        SpeedChoice::BestPath => best(Objective::Path),
        SpeedChoice::BestLife => best(Objective::Life),
        SpeedChoice::BestRate => best(Objective::Rate { change_time: change.time }),
        SpeedChoice::BestCost => best(change.objective()),
        SpeedChoice::Makarov(flank_wear) => pair.limits.clip(pair.minimum_wear_speed(cut, flank_wear)),
    }
}
