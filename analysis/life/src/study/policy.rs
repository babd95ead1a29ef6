//! How the speed of an edge is chosen in a study.

use super::Passes;
use super::edge::rehearsed;
use std::sync::Arc;
use toolroom_scenario::SensorSheet;
use toolroom_wear::{
    Coefficients, Contact, Cut, Measurement, Objective, Observer, Pair, RampLimits, SpeedSchedule, SpeedTable,
    ramp_limits,
};

/// A rule, before it is worked out for a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// The speed of the condition.
    Programmed,
    /// One speed that is best for something on the nominal model.
    Best(Objective),
    /// Least wear per path at a reference wear (m) on the nominal model (Makarov).
    Makarov(f64),
    /// Speed against path: what mode 1 does with a nominal edge in the passes of the study.
    Schedule,
    /// Least wear per path at the estimated wear (mode 1).
    MinimumWear,
    /// Path weighed against time at a price (s/m) at the estimated wear.
    Price(f64),
    /// Mode 1 at the truth.
    Oracle(Knows),
}

/// What an oracle knows of its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knows {
    /// Its wear: the bound for whoever measures wear, as in the shop.
    Wear,
    /// Its wear, its factors of wear and the hardness of its batch: the bound for every observer.
    Edge,
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
    Planned { law: SpeedTable, oracle: Option<Knows> },
}

/// A rule worked out for one nominal cut.
#[derive(Clone, Debug)]
pub struct Policy {
    speed: Speed,
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
        let law = |speed: &dyn Fn(f64) -> f64| SpeedTable::tabulate(limits.wear_limit, |wear| limits.clip(speed(wear)));
        let least = || law(&|wear| pair.minimum_wear_speed(cut, wear));
        let speed = match rule {
            Rule::Programmed => Speed::Constant(cut.cutting_speed),
            Rule::Best(objective) => Speed::Constant(pair.best_constant_speed(cut, objective).cutting_speed),
            Rule::Makarov(wear) => Speed::Constant(limits.clip(pair.minimum_wear_speed(cut, wear))),
            Rule::Schedule => Speed::Schedule(rehearsed(pair, cut, passes, lagged)),
            Rule::MinimumWear => Speed::Planned { law: least(), oracle: None },
            Rule::Price(price) => {
                Speed::Planned { law: law(&|wear| pair.shadow_price_speed(cut, wear, price)), oracle: None }
            }
            Rule::Oracle(knows) => Speed::Planned { law: least(), oracle: Some(knows) },
        };
        let noise = sensors.observer_noise(allowance);
        let observes = matches!(speed, Speed::Planned { oracle: None, .. });
        Self {
            template: observes.then(|| Observer::new(pair, noise)),
            speed,
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
            Speed::Planned { oracle: Some(Knows::Edge), .. } => {
                let law = |wear: f64| policy.pair.limits.clip(self.pair.minimum_wear_speed(&self.cut, wear));
                policy.planned(law, self.pair.contact(&self.cut), (true_wear, 1.0), length, self.last_speed)
            }
            Speed::Planned { law, .. } => {
                let estimate = self.observer.as_ref().map(Observer::estimate);
                let known = estimate
                    .map_or((true_wear, 1.0), |estimate| (estimate.flank_wear.max(0.0), estimate.ln_wear_factor.exp()));
                let contact = policy.pair.contact_of(policy.contact);
                policy.planned(|wear| law.speed_at(wear), contact, known, length, self.last_speed)
            }
        };
        self.last_speed = Some(ramp.end);
        ramp
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
    /// Speeds by a law of wear at both ends of a pass, the wear at its end by the midpoint rule on
    /// the believed contact times the estimated factor of this edge. The first pass starts at the
    /// speed of the law, however far from the programmed one.
    fn planned(
        &self,
        law: impl Fn(f64) -> f64,
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
        let ramp = self.ramp.ramp(limits, wear, length, last, |wear| (law(wear), true), growth);
        Ramp { start: ramp.start_speed, end: ramp.end_speed }
    }
}
