//! One edge: how it differs from nominal, and its life under a policy.

use super::policy::Policy;
use super::{End, Study, Tilt};
use crate::life::normal;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use std::sync::LazyLock;
use toolroom_sim::{Entity, Purpose, Stream, Streams};
use toolroom_wear::{Chipping, Contact, Cut, Measurement, Pair, Scatter};

/// Coordinates of a point that every study has, in their order.
pub const COORDINATES: [&str; 9] = [
    "common wear",
    "mechanical wear",
    "thermal wear",
    "batch hardness",
    "flank shear",
    "flank pressure",
    "emf gain",
    "initial wear",
    "chipping resistance",
];

/// Wear levels whose first passage is noted, as shares of the wear limit.
pub const LEVELS: usize = 16;
/// The wear noise is held for this share of its correlation time.
const HELD: f64 = 0.1;
/// Steps of the state equations grow with the age of an edge, whose rate of wear falls by orders
/// of magnitude while it runs in: this share of its time in cut, but not below the first and above
/// the longest, s. Tool life comes out within 1e-4 (tested).
const STEP_SHARE: f64 = 0.15;
const FIRST_STEP: f64 = 1.5;
const LONGEST_STEP: f64 = 15.0;
/// The longest step while the body of the tool follows with its lag, s.
const LONGEST_LAGGED_STEP: f64 = 6.0;

/// What became of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Time in cut, s.
    pub life: f64,
    /// Cutting path, m.
    pub path: f64,
    /// Flank wear at the end, m.
    pub flank_wear: f64,
    /// What ended it.
    pub end: End,
    /// Weight of the edge, 1 but in importance sampling.
    pub weight: f64,
    /// Time in cut at which wear passed each of the [`LEVELS`], s; infinite where it did not.
    pub passages: [f64; LEVELS],
}

/// An edge with everything that is drawn once for it.
pub struct Edge {
    cut: Cut,
    initial_wear: f64,
    emf_gain: f64,
    resistance: f64,
    batch_hardness: f64,
    weight: f64,
}

impl Edge {
    /// The edge of a point; `pair` and `cut` carry the fields that the point has changed.
    pub fn of(study: &Study, cut: &Cut, point: &[f64], stream: &mut Stream) -> Self {
        let scatter = &study.scatter;
        let z = |i: usize| normal::quantile(point[i]);
        let (mut common, mut resistance, mut weight) = (z(0), -(-point[8]).ln_1p(), 1.0);
        let Tilt { wear_shift, chipping_rate } = study.tilt;
        if study.tilt != Tilt::default() {
            // Every second edge on average is drawn with the tilt, and all of them weigh by the
            // mixture of both: no weight is above 2 (T. Hesterberg, Technometrics 37 (1995) 185).
            if stream.random::<f64>() < 0.5 {
                common += wear_shift;
                resistance /= chipping_rate;
            }
            let shifted = (wear_shift * common - 0.5 * wear_shift * wear_shift).exp();
            let weaker = chipping_rate * ((1.0 - chipping_rate) * resistance).exp();
            weight = 2.0 / (1.0 + shifted * weaker);
        }
        let clip = |hardness: f64| hardness.clamp(1.0 - scatter.hardness_clip, 1.0 + scatter.hardness_clip);
        let batch_hardness = clip(1.0 + scatter.batch_hardness * z(3));
        Self {
            cut: Cut {
                wear_factor: cut.wear_factor * (scatter.common_wear * common).exp(),
                mechanical_factor: cut.mechanical_factor * (scatter.mechanical_wear * z(1)).exp(),
                thermal_factor: cut.thermal_factor * (scatter.thermal_wear * z(2)).exp(),
                flank_shear_factor: cut.flank_shear_factor * (scatter.flank_stress * z(4)).exp(),
                flank_pressure_factor: cut.flank_pressure_factor * (scatter.flank_stress * z(5)).exp(),
                ..*cut
            },
            emf_gain: 1.0 + scatter.emf_gain * z(6),
            initial_wear: scatter.initial_wear * (scatter.initial_wear_scatter * z(7)).exp(),
            resistance,
            batch_hardness,
            weight,
        }
    }

    /// The cut of a pass: hardness of the piece and depth of the allowance.
    fn cut_of_pass(&self, scatter: &Scatter, varies: bool, stream: &mut Stream) -> Cut {
        let nominal = Cut { hardness: self.cut.hardness * self.batch_hardness, ..self.cut };
        if !varies {
            return nominal;
        }
        let hardness = scatter.sample_piece_hardness(self.batch_hardness, stream);
        let depth_of_cut = scatter.sample_depth(self.cut.depth_of_cut, stream);
        Cut { hardness: self.cut.hardness * hardness, depth_of_cut, ..self.cut }
    }
}

/// Random numbers of the life of edge `index`, apart from those of its point.
pub fn stream_of(seed: u64, index: u64) -> Stream {
    Streams::new(seed, 1).at(Entity::named("life"), Purpose::Workpiece, index)
}

/// Lives an edge under a policy.
pub fn live(study: &Study, pair: &Pair, cut: &Cut, policy: &Policy, point: &[f64], stream: &mut Stream) -> Outcome {
    let edge = Edge::of(study, cut, point, stream);
    match policy.constant() {
        Some(speed) if study.steady() => steady_life(study, pair, &edge, speed, stream),
        _ => Machining::new(study, pair, &edge, policy, stream).run(),
    }
}

/// Nodes and weights of the 4-point Gauss–Legendre rule, positive half.
const GAUSS: [(f64, f64); 2] =
    [(0.339_981_043_584_856_26, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_85)];

/// A life at one speed where nothing changes from pass to pass: quadrature over wear.
///
/// The wear noise multiplies the rate of wear, so that it only stretches time: the life without
/// noise is the integral of the noise factor over the life with it.
fn steady_life(study: &Study, pair: &Pair, edge: &Edge, speed: f64, stream: &mut Stream) -> Outcome {
    let cut = Cut { hardness: edge.cut.hardness * edge.batch_hardness, ..edge.cut }.at_speed(speed);
    let contact = pair.contact(&cut);
    let limit = study.wear_at_end(pair);
    let scale = study.run_in(pair);
    let mut passages = [f64::INFINITY; LEVELS];
    let (mut path_hazard, mut clock) = (0.0, Clock::new(&study.scatter, stream));
    let (mut from, mut time) = (edge.initial_wear.min(0.999 * limit), 0.0);
    let longest = study.ends.time.min(study.ends.path / speed);
    let chipping = Chips { chipping: pair.chipping, added: cut.chipping_rate };
    let done = |time: f64, wear: f64, end: End, passages: [f64; LEVELS]| Outcome {
        life: time,
        path: speed * time,
        flank_wear: wear,
        end,
        weight: edge.weight,
        passages,
    };
    for level in 0..LEVELS {
        let to = limit * level_share(level);
        if to <= from {
            passages[level] = 0.0;
            continue;
        }
        if contact.steady_temperature(to) > pair.temperature.collapse_temperature {
            let wear = collapse(&contact, pair.temperature.collapse_temperature, from, to);
            let end = clock.advance(panel(&contact, speed, scale, from, wear), stream);
            return done(end, wear, End::Collapse, passages);
        }
        let operational = panel(&contact, speed, scale, from, to);
        let end = clock.advance(operational, stream);
        let (before, after) = (speed * time, speed * end);
        let step = chipping.over(before, after, from, to);
        let chips = path_hazard + step >= edge.resistance;
        let chipped = if chips {
            chipping.path_at(before, after, step, edge.resistance - path_hazard) / speed
        } else {
            f64::INFINITY
        };
        if end.min(chipped) > longest {
            let part = (longest - time) / (end - time);
            let kind = if study.ends.time <= study.ends.path / speed { End::Time } else { End::Path };
            return done(longest, from + part * (to - from), kind, passages);
        }
        if chips {
            let part = (chipped - time) / (end - time);
            return done(chipped, from + part * (to - from), End::Chipping, passages);
        }
        path_hazard += step;
        passages[level] = end;
        (from, time) = (to, end);
    }
    done(time, limit, study.limit_kind(pair), passages)
}

/// The wear at which the contact is as hot as the edge bears.
fn collapse(contact: &Contact<'_>, temperature: f64, mut from: f64, mut to: f64) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (from + to);
        *(if contact.steady_temperature(middle) > temperature { &mut to } else { &mut from }) = middle;
    }
    from
}

/// Share of the limit at a level: evenly spaced in the variable in which run-in is as wide as the
/// rest of the life.
pub fn level_share(level: usize) -> f64 {
    SHARES[level]
}

static SHARES: LazyLock<[f64; LEVELS]> = LazyLock::new(|| {
    const STRETCH: f64 = 30.0;
    std::array::from_fn(|level| ((1.0 + STRETCH).powf((level + 1) as f64 / LEVELS as f64) - 1.0) / STRETCH)
});

/// Time without noise from one wear to another, s: Gauss–Legendre in ln(1 + h/scale).
fn panel(contact: &Contact<'_>, speed: f64, scale: f64, from: f64, to: f64) -> f64 {
    let (a, b) = ((from / scale).ln_1p(), (to / scale).ln_1p());
    let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
    let at = |x: f64| {
        let stretch = x.exp();
        let wear = scale * (stretch - 1.0);
        scale * stretch / contact.steady_wear(wear).rate(speed)
    };
    half * GAUSS.iter().map(|(x, w)| w * (at(centre - half * x) + at(centre + half * x))).sum::<f64>()
}

/// Noise on the rate of wear, held for a share of its correlation time.
struct Noise {
    scatter: Scatter,
    /// Time for which a value is held, s.
    held: f64,
    decay: f64,
    spread: f64,
    value: f64,
    /// Factor of the present value on the rate of wear.
    factor: f64,
}

impl Noise {
    fn new(scatter: &Scatter, stream: &mut Stream) -> Self {
        let held = if scatter.life_noise > 0.0 { HELD * scatter.life_noise_time } else { f64::INFINITY };
        let (decay, spread) = scatter.noise_transition(held);
        let value = scatter.sample_noise(stream);
        Self { scatter: *scatter, held, decay, spread, value, factor: scatter.noise_factor(value) }
    }

    fn next(&mut self, stream: &mut Stream) {
        let z: f64 = StandardNormal.sample(stream);
        self.value = self.value * self.decay + self.spread * z;
        self.factor = self.scatter.noise_factor(self.value);
    }
}

/// Time in cut against the time that wear without noise would take.
struct Clock {
    noise: Noise,
    /// How long the noise still holds, s.
    left: f64,
    time: f64,
}

impl Clock {
    fn new(scatter: &Scatter, stream: &mut Stream) -> Self {
        let noise = Noise::new(scatter, stream);
        Self { left: noise.held, noise, time: 0.0 }
    }

    /// Lets time pass until wear has advanced by what would take `operational` seconds without
    /// noise; the time then.
    fn advance(&mut self, operational: f64, stream: &mut Stream) -> f64 {
        let mut rest = operational;
        while rest > self.left * self.noise.factor {
            rest -= self.left * self.noise.factor;
            self.time += self.left;
            self.noise.next(stream);
            self.left = self.noise.held;
        }
        self.time += rest / self.noise.factor;
        self.left -= rest / self.noise.factor;
        self.time
    }
}

/// The chipping hazard between two states.
struct Chips {
    chipping: Chipping,
    added: f64,
}

impl Chips {
    fn rate(&self) -> f64 {
        self.chipping.rate + self.added
    }

    /// Hazard gathered from one path to another while the land grows from `from` to `to`: exact in
    /// path, the land's part by Simpson's rule for a land that grows evenly with path.
    fn over(&self, before: f64, after: f64, from: f64, to: f64) -> f64 {
        if self.rate() == 0.0 {
            return 0.0;
        }
        self.between(self.power(before), self.power(after), from, to)
    }

    /// The same between two powers of path.
    fn between(&self, before: f64, after: f64, from: f64, to: f64) -> f64 {
        let aged = |land: f64| 1.0 + (land / self.chipping.reference_land).powi(2);
        let land = (aged(from) + 4.0 * aged(0.5 * (from + to)) + aged(to)) / 6.0;
        land * (after - before)
    }

    /// `(rate·path)^shape`.
    fn power(&self, path: f64) -> f64 {
        (self.rate() * path).powf(self.chipping.shape)
    }

    /// The path at which `hazard` of the `step` from `before` to `after` is gathered.
    fn path_at(&self, before: f64, after: f64, step: f64, hazard: f64) -> f64 {
        let power = self.power(before) + (self.power(after) - self.power(before)) * (hazard / step);
        power.powf(self.chipping.shape.recip()) / self.rate()
    }
}

/// An edge in passes, under any policy.
struct Machining<'a> {
    study: &'a Study,
    pair: &'a Pair,
    edge: &'a Edge,
    policy: &'a Policy,
    stream: &'a mut Stream,
    wear: f64,
    body: f64,
    time: f64,
    path: f64,
    hazard: f64,
    /// Power of path in the hazard, 0 without chipping.
    power: f64,
    noise: Noise,
    /// Time for which the noise still holds, s.
    held: f64,
    level: usize,
    passages: [f64; LEVELS],
    limit: f64,
    chips: Chips,
}

/// Passes after which an edge that does not wear counts as lasting for ever.
const MOST_PASSES: u32 = 1_000_000;

impl<'a> Machining<'a> {
    fn new(study: &'a Study, pair: &'a Pair, edge: &'a Edge, policy: &'a Policy, stream: &'a mut Stream) -> Self {
        let limit = study.wear_at_end(pair);
        let noise = Noise::new(&study.scatter, stream);
        let mut machining = Self {
            wear: edge.initial_wear.min(0.999 * limit),
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
            chips: Chips { chipping: pair.chipping, added: edge.cut.chipping_rate },
            study,
            pair,
            edge,
            policy,
            stream,
        };
        machining.pass_levels(0.0, machining.wear, 0.0, 0.0);
        machining
    }

    /// Notes the levels passed up to `wear`, by a straight line from `from` at `before`.
    fn pass_levels(&mut self, from: f64, wear: f64, before: f64, after: f64) {
        while self.level < LEVELS && self.limit * level_share(self.level) <= wear {
            let level = self.limit * level_share(self.level);
            let part = if wear > from { ((level - from) / (wear - from)).max(0.0) } else { 1.0 };
            self.passages[self.level] = before + part * (after - before);
            self.level += 1;
        }
    }

    fn run(mut self) -> Outcome {
        let mut pilot = self.policy.pilot();
        let (passes, scatter) = (self.study.passes, self.study.scatter);
        for _ in 0..MOST_PASSES {
            let cut = self.edge.cut_of_pass(&scatter, self.study.varies(), self.stream);
            let ramp = pilot.plan(self.policy, self.wear, self.path, passes.path);
            let contact = self.pair.contact(&cut.at_speed(ramp.start));
            if let Some(outcome) = self.pass(&cut, &contact, &ramp, passes.path, &mut pilot) {
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

    /// One pass by the classical Runge–Kutta rule; something where the edge ends in it.
    fn pass(
        &mut self,
        cut: &Cut,
        contact: &Contact<'_>,
        ramp: &super::policy::Ramp,
        path: f64,
        pilot: &mut super::policy::Pilot,
    ) -> Option<Outcome> {
        let duration = 2.0 * path / (ramp.start + ramp.end);
        let acceleration = (ramp.end - ramp.start) / duration;
        let sampling = self.policy.sampling(duration);
        let longest = if self.study.lagged { LONGEST_LAGGED_STEP } else { LONGEST_STEP };
        let chips = self.chips.rate() > 0.0;
        let (mut at, mut sampled, mut next_sample) = (0.0, 0.0, sampling);
        let mut first = *contact;
        while at < duration * (1.0 - 1e-12) {
            if self.held <= 0.0 {
                self.noise.next(self.stream);
                self.held = self.noise.held;
            }
            let factor = self.noise.factor;
            let mut dt = (STEP_SHARE * self.time)
                .clamp(FIRST_STEP, longest)
                .min(duration - at)
                .min(self.held)
                .min(next_sample - at);
            // No sliver is left for one more step.
            if duration - at - dt < 1e-9 * duration {
                dt = duration - at;
            }
            let speed = ramp.start + acceleration * at;
            let (middle, last) = if acceleration == 0.0 {
                (first, first)
            } else {
                (contact.at_speed(speed + 0.5 * acceleration * dt), contact.at_speed(speed + acceleration * dt))
            };
            let (a, a_body) = self.slope(&first, self.wear, self.body, factor);
            let (b, b_body) = self.slope(&middle, self.wear + 0.5 * dt * a, self.body + 0.5 * dt * a_body, factor);
            let (c, c_body) = self.slope(&middle, self.wear + 0.5 * dt * b, self.body + 0.5 * dt * b_body, factor);
            let (d, d_body) = self.slope(&last, self.wear + dt * c, self.body + dt * c_body, factor);
            let wear = self.wear + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d);
            let mean_speed = speed + 0.5 * acceleration * dt;
            let after = self.path + mean_speed * dt;
            let power = if chips { self.chips.power(after) } else { 0.0 };
            let step = if chips { self.chips.between(self.power, power, self.wear, wear) } else { 0.0 };
            if let Some(outcome) = self.ended(wear, after, dt, step, (a, d), &last) {
                return Some(outcome);
            }
            self.pass_levels(self.wear, wear, self.time, self.time + dt);
            self.hazard += step;
            self.power = power;
            first = last;
            (self.wear, self.path) = (wear, after);
            self.body += dt / 6.0 * (a_body + 2.0 * b_body + 2.0 * c_body + d_body);
            self.time += dt;
            self.held -= dt;
            at += dt;
            if at >= next_sample * (1.0 - 1e-12) {
                let mean_speed = ramp.start + 0.5 * acceleration * (sampled + at);
                self.measure(cut, &last, pilot, at - sampled, mean_speed);
                sampled = at;
                next_sample = (next_sample + sampling).min(duration);
                if at >= duration * (1.0 - 1e-12) {
                    break;
                }
            }
        }
        None
    }

    /// Rates of wear and of the body's temperature.
    fn slope(&self, contact: &Contact<'_>, wear: f64, body: f64, factor: f64) -> (f64, f64) {
        let speed = contact.cut().cutting_speed;
        if !self.study.lagged {
            return (factor * contact.steady_wear(wear).rate(speed), 0.0);
        }
        let rise = contact.rise(wear);
        let temperature = contact.temperature(rise, body);
        let rate = contact.wear(wear, temperature, 0.0).rate(speed);
        (factor * rate, (rise - body) / self.pair.temperature.body_time_constant)
    }

    /// The earliest end within a step, where there is one.
    fn ended(
        &mut self,
        wear: f64,
        after: f64,
        dt: f64,
        step: f64,
        (slope, end_slope): (f64, f64),
        last: &Contact<'_>,
    ) -> Option<Outcome> {
        let ends = &self.study.ends;
        let mut part = f64::INFINITY;
        let mut end = End::WearLimit;
        let mut candidate = |share: f64, kind: End| {
            if share < part {
                (part, end) = (share, kind);
            }
        };
        if wear >= self.limit {
            candidate(
                hermite_root(self.wear, wear, slope * dt, end_slope * dt, self.limit),
                self.study.limit_kind(self.pair),
            );
        }
        if self.hazard + step >= self.edge.resistance {
            let path = self.chips.path_at(self.path, after, step, self.edge.resistance - self.hazard);
            candidate((path - self.path) / (after - self.path), End::Chipping);
        }
        if self.time + dt >= ends.time {
            candidate((ends.time - self.time) / dt, End::Time);
        }
        if after >= ends.path {
            candidate((ends.path - self.path) / (after - self.path), End::Path);
        }
        if ends.force.is_finite() {
            let force = |wear: f64| self.pair.force.load(last.cut()).cutting(wear);
            let (low, high) = (force(self.wear), force(wear));
            if high >= ends.force {
                candidate(((ends.force - low) / (high - low)).clamp(0.0, 1.0), End::Force);
            }
        }
        if last.steady_temperature(self.wear) > self.pair.temperature.collapse_temperature {
            candidate(0.0, End::Collapse);
        }
        if part > 1.0 {
            return None;
        }
        let reached = if end == End::WearLimit { self.limit } else { self.wear + part * (wear - self.wear) };
        self.pass_levels(self.wear, reached, self.time, self.time + part * dt);
        self.wear = reached;
        self.path += part * (after - self.path);
        self.time += part * dt;
        Some(self.outcome(end))
    }

    /// What the sensors show, given to the observer.
    fn measure(
        &mut self,
        cut: &Cut,
        contact: &Contact<'_>,
        pilot: &mut super::policy::Pilot,
        dt: f64,
        mean_speed: f64,
    ) {
        let Some(sensors) = self.policy.sensors() else { return };
        let point = self.pair.output(
            &toolroom_wear::WearState {
                flank_wear: self.wear,
                body_temperature_rise: if self.study.lagged { self.body } else { contact.rise(self.wear) },
                ..toolroom_wear::WearState::default()
            },
            &cut.at_speed(contact.cut().cutting_speed),
        );
        let mut shown = |value: f64, bias: f64, deviation: f64| {
            let z: f64 = StandardNormal.sample(self.stream);
            value * (1.0 + bias) * (1.0 + deviation * z)
        };
        let measured = Measurement {
            spindle_power: shown(point.spindle_power, sensors.spindle_power_bias, sensors.spindle_power),
            feed_force: shown(point.feed_force, sensors.feed_force_bias, sensors.feed_force),
            thermo_emf: shown(point.thermo_emf * self.edge.emf_gain, sensors.thermo_emf_bias, sensors.thermo_emf),
        };
        pilot.see(self.policy, mean_speed, contact.cut().cutting_speed, dt, &measured);
    }
}

/// The share of a step at which a cubic through both ends, with these slopes a step, reaches
/// `value`.
fn hermite_root(start: f64, end: f64, slope: f64, end_slope: f64, value: f64) -> f64 {
    let at = |t: f64| {
        let (u, v) = (1.0 - t, t);
        u * u * (1.0 + 2.0 * v) * start + v * v * (3.0 - 2.0 * v) * end + u * u * v * slope - v * v * u * end_slope
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        *(if at(middle) < value { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}
