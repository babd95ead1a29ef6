//! A life in passes, under any policy: the state equations.

use super::chips::{Chips, share_at};
use super::cubic::Cubic;
use super::noise::Noise;
use super::{Draws, Edge, LEVELS, Outcome, collapse, level_share};
use crate::study::policy::{Pilot, Policy, Ramp};
use crate::study::{End, Study};
use rand_distr::{Distribution, StandardNormal};
use toolroom_wear::{Contact, Measurement, Pair};

/// The first step of the state equations, s.
const FIRST_STEP: f64 = 3.0;
/// The longest step, s; the wear noise, held for a while, mostly sets a shorter one.
const LONGEST_STEP: f64 = 30.0;
/// The longest step while the body of the tool follows with its lag, s.
const LONGEST_LAGGED_STEP: f64 = 6.0;
/// Greatest difference of the two slopes in the middle of a step, over the slope at its start. It
/// goes with the square of the step over the time in which the rate of wear changes, the error
/// of the step with the fifth power.
const LARGEST_BEND: f64 = 0.01;
/// The shortest step that a bend may ask for, share of a pass.
const SHORTEST_STEP: f64 = 1e-6;
/// Passes after which an edge that does not wear counts as lasting for ever.
const MOST_PASSES: u32 = 1_000_000;

/// An edge in passes.
///
/// What is integrated is the square of the land with its offset, `(h + h_e)²`: while an edge runs
/// in, its rate of wear falls as 1/(h + h_e), and the square grows evenly.
pub(super) struct Machining<'a> {
    study: &'a Study,
    pair: &'a Pair,
    edge: &'a Edge,
    policy: &'a Policy,
    draws: &'a mut Draws,
    wear: f64,
    body: f64,
    time: f64,
    path: f64,
    hazard: f64,
    /// Power of path in the hazard.
    power: f64,
    noise: Noise,
    /// Time for which the noise still holds, s.
    held: f64,
    level: usize,
    passages: [f64; LEVELS],
    limit: f64,
    /// Offset of the land in the square, h_e, m.
    offset: f64,
    chips: Chips,
    longest_step: f64,
    largest_bend: f64,
    /// The next step, as far as the bend of the last one tells, s.
    next_step: f64,
}

/// A step that was taken, before its end is accepted.
struct Step<'a> {
    /// s.
    dt: f64,
    /// Square of the land with its offset, m².
    square: Cubic,
    /// Temperature rise of the body, K.
    body: Cubic,
    /// Path cut at its start and its end, m.
    path: [f64; 2],
    /// Speed at its start, m/s, and acceleration.
    speed: f64,
    acceleration: f64,
    /// Contact at its end.
    last: Contact<'a>,
    /// Difference of the slopes in its middle over that at its start.
    bend: f64,
}

impl Step<'_> {
    /// Path cut after a share of it, m.
    fn path_at(&self, share: f64) -> f64 {
        let time = share * self.dt;
        self.path[0] + (self.speed + 0.5 * self.acceleration * time) * time
    }
}

impl<'a> Machining<'a> {
    pub fn new(
        study: &'a Study,
        pair: &'a Pair,
        edge: &'a Edge,
        policy: &'a Policy,
        draws: &'a mut Draws,
        parts: u32,
    ) -> Self {
        let limit = study.wear_at_end(pair);
        let noise = Noise::new(&study.scatter, &mut draws.wear);
        let longest_step = if study.lagged { LONGEST_LAGGED_STEP } else { LONGEST_STEP };
        let mut machining = Self {
            wear: edge.initial_wear,
            body: 0.0,
            time: 0.0,
            path: 0.0,
            hazard: 0.0,
            power: 0.0,
            held: noise.held,
            noise,
            level: 0,
            passages: [f64::INFINITY; LEVELS],
            limit,
            offset: pair.curve_scale(),
            chips: Chips { chipping: pair.chipping, added: edge.cut.chipping_rate },
            longest_step: longest_step / f64::from(parts),
            next_step: FIRST_STEP / f64::from(parts),
            largest_bend: LARGEST_BEND / f64::from(parts).powi(2),
            study,
            pair,
            edge,
            policy,
            draws,
        };
        while machining.level_ahead() <= machining.wear {
            machining.passages[machining.level] = 0.0;
            machining.level += 1;
        }
        machining
    }

    /// Cuts until the edge ends; `planned` gets to know the path before every pass, and its speeds.
    pub fn run(mut self, mut planned: impl FnMut(f64, &Ramp)) -> Outcome {
        if self.wear >= self.limit {
            return self.outcome(self.study.limit_kind(self.pair));
        }
        let mut pilot = self.policy.pilot(self.pair, self.edge.mean_cut());
        let (passes, scatter) = (self.study.passes, self.study.scatter);
        for _ in 0..MOST_PASSES {
            let cut = self.edge.cut_of_pass(&scatter, self.study.varies(), &mut self.draws.pieces);
            let ramp = pilot.plan(self.policy, self.wear, self.path, passes.path);
            planned(self.path, &ramp);
            let contact = self.pair.contact(&cut.at_speed(ramp.start));
            if let Some(outcome) = self.pass(&contact, &ramp, passes.path, &mut pilot) {
                return outcome;
            }
            if self.study.lagged && passes.pause > 0.0 {
                self.body *= (-passes.pause / self.pair.temperature.body_time_constant).exp();
            }
        }
        self.outcome(End::Time)
    }

    fn outcome(&self, end: End) -> Outcome {
        Outcome {
            life: self.time,
            path: self.path,
            flank_wear: self.wear,
            end,
            weight: self.edge.weight,
            passages: self.passages,
        }
    }

    /// One pass; something where the edge ends in it.
    pub(super) fn pass(
        &mut self,
        contact: &Contact<'a>,
        ramp: &Ramp,
        path: f64,
        pilot: &mut Pilot<'_>,
    ) -> Option<Outcome> {
        // A ramp down may be too hot at its start and not at the end of its first step, which is what is watched.
        if contact.steady_temperature(self.wear) > self.pair.temperature.collapse_temperature {
            return Some(self.outcome(End::Collapse));
        }
        let duration = 2.0 * path / (ramp.start + ramp.end);
        let acceleration = (ramp.end - ramp.start) / duration;
        let sampling = self.policy.sampling(duration);
        let load = self.policy.sensors().map(|_| self.pair.force.load(contact.cut()));
        let (mut time, mut sampled, mut next_sample) = (0.0, 0.0, sampling);
        let mut first = *contact;
        while time < duration * (1.0 - 1e-12) {
            if self.held <= 1e-9 * self.noise.held {
                self.noise.next(&mut self.draws.wear);
                self.held = self.noise.held;
            }
            let most = (duration - time).min(self.held);
            let speed = ramp.start + acceleration * time;
            // No sliver is left for one more step.
            let mut dt = if self.next_step > most - 1e-9 * duration { most } else { self.next_step };
            let start = self.slope(&first, (self.wear + self.offset).powi(2), self.body);
            let mut step = self.step(&first, start, (speed, acceleration), dt);
            while step.bend > self.largest_bend && dt > SHORTEST_STEP * duration {
                dt *= (0.8 * (self.largest_bend / step.bend).sqrt()).max(0.1);
                self.next_step = dt;
                step = self.step(&first, start, (speed, acceleration), dt);
            }
            let next = dt * (0.8 * (self.largest_bend / step.bend).sqrt()).min(3.0);
            // A step that was cut short says nothing against a longer one.
            self.next_step = if dt < self.next_step { next.max(self.next_step) } else { next }.min(self.longest_step);
            let wear = self.land(step.square.ends[1]);
            let (power, gathered) = self.gathered(&step, 1.0);
            if let Some(outcome) = self.ended(&step, wear, gathered) {
                return Some(outcome);
            }
            // What the sensors show on the way changes nothing before the next pass.
            while let Some(load) = load.filter(|_| next_sample <= (time + dt) * (1.0 + 1e-12) && sampled < duration) {
                let share = ((next_sample - time) / dt).min(1.0);
                let speed = ramp.start + acceleration * next_sample;
                let seen = if share == 1.0 { step.last } else { first.near_speed(speed) };
                let land = self.land(step.square.at(share));
                let body = if self.study.lagged { step.body.at(share) } else { seen.rise(land) };
                let load = self.pair.force.at_speed(&load, speed);
                let mean_speed = ramp.start + 0.5 * acceleration * (sampled + next_sample);
                self.measure(&seen.measurement(&load, land, body), pilot, next_sample - sampled, [mean_speed, speed]);
                sampled = next_sample;
                next_sample = (next_sample + sampling).min(duration);
            }
            self.pass_levels(&step, wear);
            (self.hazard, self.power) = (self.hazard + gathered, power);
            (self.wear, self.body, self.path) = (wear, step.body.ends[1], step.path[1]);
            self.time += dt;
            self.held -= dt;
            time += dt;
            first = step.last;
        }
        None
    }

    /// A step of the classical Runge–Kutta rule from a speed (m/s) with an acceleration.
    fn step(
        &self,
        first: &Contact<'a>,
        (a, a_body): (f64, f64),
        (speed, acceleration): (f64, f64),
        dt: f64,
    ) -> Step<'a> {
        let (middle, last) = if acceleration == 0.0 {
            (*first, *first)
        } else {
            (first.near_speed(speed + 0.5 * acceleration * dt), first.near_speed(speed + acceleration * dt))
        };
        let square = (self.wear + self.offset).powi(2);
        let (b, b_body) = self.slope(&middle, square + 0.5 * dt * a, self.body + 0.5 * dt * a_body);
        let (c, c_body) = self.slope(&middle, square + 0.5 * dt * b, self.body + 0.5 * dt * b_body);
        let (d, d_body) = self.slope(&last, square + dt * c, self.body + dt * c_body);
        let sixth = dt / 6.0;
        Step {
            dt,
            square: Cubic { ends: [square, square + sixth * (a + 2.0 * b + 2.0 * c + d)], slopes: [dt * a, dt * d] },
            body: Cubic {
                ends: [self.body, self.body + sixth * (a_body + 2.0 * b_body + 2.0 * c_body + d_body)],
                slopes: [dt * a_body, dt * d_body],
            },
            path: [self.path, self.path + (speed + 0.5 * acceleration * dt) * dt],
            speed,
            acceleration,
            last,
            bend: ((c - b) / a).abs(),
        }
    }

    /// Rates of the square of the land and of the body's temperature.
    #[inline]
    fn slope(&self, contact: &Contact<'_>, square: f64, body: f64) -> (f64, f64) {
        let land = square.sqrt();
        let wear = land - self.offset;
        let speed = contact.cut().cutting_speed;
        let growth = 2.0 * land * self.noise.factor;
        if !self.study.lagged {
            return (growth * contact.steady_wear(wear).rate(speed), 0.0);
        }
        let rise = contact.rise(wear);
        let temperature = contact.temperature(rise, body);
        let rate = contact.wear(wear, temperature, 0.0).rate(speed);
        (growth * rate, (rise - body) / self.pair.temperature.body_time_constant)
    }

    /// Land of a square, m.
    fn land(&self, square: f64) -> f64 {
        square.sqrt() - self.offset
    }

    /// Wear of the next level, m; infinite after the last.
    fn level_ahead(&self) -> f64 {
        if self.level < LEVELS { self.limit * level_share(self.level) } else { f64::INFINITY }
    }

    /// Share of a step at which wear reaches a value (m).
    fn share_of(&self, step: &Step<'_>, wear: f64) -> f64 {
        step.square.share_at((wear + self.offset).powi(2))
    }

    /// Notes the levels passed up to `wear`.
    fn pass_levels(&mut self, step: &Step<'_>, wear: f64) {
        while self.level_ahead() <= wear {
            self.passages[self.level] = self.time + self.share_of(step, self.level_ahead()) * step.dt;
            self.level += 1;
        }
    }

    /// Power of path after a share of a step, and the hazard gathered in it.
    fn gathered(&self, step: &Step<'_>, share: f64) -> (f64, f64) {
        if !self.chips.happen() {
            return (0.0, 0.0);
        }
        let gathered_to =
            |share: f64| (self.chips.power(step.path_at(share)), self.chips.aged(self.land(step.square.at(share))));
        let (halfway, end) = (gathered_to(0.5 * share), gathered_to(share));
        (end.0, self.chips.over([(self.power, self.chips.aged(self.wear)), halfway, end]))
    }

    /// The earliest end within a step, where there is one.
    fn ended(&mut self, step: &Step<'_>, wear: f64, gathered: f64) -> Option<Outcome> {
        let ends = &self.study.ends;
        let (before, after) = (step.path[0], step.path[1]);
        let mut share = f64::INFINITY;
        let mut end = End::WearLimit;
        let mut candidate = |at: f64, kind: End| {
            if at < share {
                (share, end) = (at, kind);
            }
        };
        if wear >= self.limit {
            candidate(self.share_of(step, self.limit), self.study.limit_kind(self.pair));
        }
        if self.hazard + gathered >= self.edge.resistance {
            let missing = self.edge.resistance - self.hazard;
            candidate(share_at(missing, |share| self.gathered(step, share).1), End::Chipping);
        }
        if self.time + step.dt >= ends.time {
            candidate((ends.time - self.time) / step.dt, End::Time);
        }
        if after >= ends.path {
            candidate((ends.path - before) / (after - before), End::Path);
        }
        if ends.force.is_finite() {
            let load = self.pair.force.load(step.last.cut());
            if load.cutting(wear) >= ends.force {
                // Force grows evenly with the land.
                let spent = (ends.force - load.cutting(0.0)) / load.shear_per_wear;
                candidate(self.share_of(step, spent), End::Force);
            }
        }
        let hot = self.pair.temperature.collapse_temperature;
        if step.last.steady_temperature(wear) > hot {
            candidate(self.share_of(step, collapse(&step.last, hot, self.wear, wear)), End::Collapse);
        }
        if share > 1.0 {
            return None;
        }
        let reached = if end == End::WearLimit { self.limit } else { self.land(step.square.at(share)) };
        self.pass_levels(step, reached);
        self.wear = reached;
        self.path = step.path_at(share);
        self.time += share * step.dt;
        Some(self.outcome(end))
    }

    /// What the sensors show, given to the observer: with their biases and noise.
    fn measure(&mut self, truth: &Measurement, pilot: &mut Pilot<'_>, dt: f64, [mean_speed, speed]: [f64; 2]) {
        let Some(sensors) = self.policy.sensors() else { return };
        let mut shown = |value: f64, bias: f64, deviation: f64| {
            let z: f64 = StandardNormal.sample(&mut self.draws.sensors);
            value * (1.0 + bias) * (1.0 + deviation * z)
        };
        let measured = Measurement {
            spindle_power: shown(truth.spindle_power, sensors.spindle_power_bias, sensors.spindle_power),
            feed_force: shown(truth.feed_force, sensors.feed_force_bias, sensors.feed_force),
            thermo_emf: shown(truth.thermo_emf * self.edge.emf_gain, sensors.thermo_emf_bias, sensors.thermo_emf),
        };
        pilot.see(self.policy, mean_speed, speed, dt, &measured);
    }
}
