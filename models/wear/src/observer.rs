//! An extended Kalman filter that reads flank wear from power, feed force and EMF.

use crate::{Coefficients, Contact, Cut, Load, Measurement, Pair};
use std::sync::Arc;
use toolroom_process::num_dual::Dual64;
use toolroom_process::record;

record! {
    /// Noise that the [`Observer`] assumes. Drifts are standard deviations after `drift_time`,
    /// growing with the square root of time; measurement noise is relative to the prediction.
    ///
    /// # Source
    /// Assumptions, with the channels of Postnov & Shafikov, section 3.
    pub struct ObserverNoise {
        /// Drift of flank wear.
        wear_drift: Real["m" => "mm"] = 0.002e-3, 0.0..=1e-2;
        /// Drift of the logarithm of the force factor.
        force_drift: Real = 0.004, 0.0..=10.0;
        /// Drift of the logarithm of the wear factor.
        rate_drift: Real = 0.02, 0.0..=10.0;
        /// Time after which the drifts have that size.
        drift_time: Real["s" => "min"] = 60.0, 1e-3..=1e6;
        /// Noise of spindle power.
        power_noise: Real = 0.015, 1e-6..=10.0;
        /// Noise of feed force.
        feed_force_noise: Real = 0.03, 1e-6..=10.0;
        /// Noise of thermo-EMF, inflated for its bias.
        emf_noise: Real = 0.025, 1e-6..=10.0;
        /// Uncertainty of flank wear of a new edge.
        initial_wear: Real["m" => "mm"] = 0.01e-3, 0.0..=1e-2;
        /// Uncertainty of the logarithm of the force factor of a new edge.
        initial_force: Real = 0.08, 0.0..=10.0;
        /// Uncertainty of the logarithm of the wear factor of a new edge.
        initial_rate: Real = 0.30, 0.0..=10.0;
        /// The part of it by which edges differ; the rest is their common level, which is learnt from edge to edge.
        edge_rate: Real = 0.28, 0.0..=10.0;
        /// Systematic error of the feed force, logarithm of its gain; 0 where it is known to have none.
        feed_force_gain: Real = 0.0, 0.0..=10.0;
        /// Systematic error of the thermo-EMF, logarithm of its gain.
        emf_gain: Real = 0.0, 0.0..=10.0;
        /// Drift of both gains from edge to edge.
        gain_drift: Real = 0.01, 0.0..=10.0;
        /// Scatter of the depth of cut from pass to pass.
        depth_scatter: Real["m" => "mm"] = 0.05e-3, 0.0..=1e-2;
        /// Other scatter of force from pass to pass.
        pass_scatter: Real = 0.02, 0.0..=10.0;
        /// Added to the scatter from pass to pass.
        pass_margin: Real = 0.01, 0.0..=10.0;
    }
}

/// What the observer believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Flank wear, m.
    pub flank_wear: f64,
    /// Logarithm of the factor on the sharp edge's force.
    pub ln_force_factor: f64,
    /// Logarithm of the factor on wear.
    pub ln_wear_factor: f64,
}

/// What is known of the common level of the logarithm of the wear factor of edges.
///
/// # Examples
/// Four edges with known factors, which scatter by 0.2 about a level that is known to 0.3:
/// ```
/// use toolroom_wear::WearLevel;
/// let edges = [(0.20, 0.05), (0.35, 0.04), (0.05, 0.06), (0.28, 0.05)];
/// let level = edges.iter().fold(WearLevel { mean: 0.0, variance: 0.09 }, |level, (factor, error)| {
///     level.after(*factor, 0.2f64.powi(2) + f64::powi(*error, 2))
/// });
/// assert!((level.mean - 0.1983407).abs() < 1e-6 && (level.variance.sqrt() - 0.0975231).abs() < 1e-6);
/// assert!(((level.variance + 0.04).sqrt() - 0.2225101).abs() < 1e-6, "of the next edge");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WearLevel {
    /// Mean, 1.
    pub mean: f64,
    /// Variance, 1.
    pub variance: f64,
}

impl WearLevel {
    /// After an edge whose factor was `observed` with `variance`, its own scatter included.
    pub fn after(self, observed: f64, variance: f64) -> Self {
        let gain = self.variance / (self.variance + variance);
        Self { mean: self.mean + gain * (observed - self.mean), variance: self.variance * (1.0 - gain) }
    }
}

/// Numbers that the filter estimates.
const STATES: usize = 5;

/// Numbers of [`Observer::belief`]: means, the covariance of each with itself and those after it, mean and variance of
/// the level of edges.
pub const BELIEF: usize = STATES + STATES * (STATES + 1) / 2 + 2;

/// Extended Kalman filter on (flank wear, ln force factor, ln wear factor, ln gain of the feed force, ln gain of the
/// thermo-EMF).
///
/// Power and feed force feel wear differently, so wear and force factor separate; readings of wear tell the gains of the
/// sensors apart from wear. The force
/// factor acts on the sharp force only and never on temperature. An error of the land's
/// stresses is a gain error of the estimated wear of the same size.
///
/// ```
/// use toolroom_wear::{Observer, ObserverNoise, Pair};
/// let pair = Pair::default();
/// let cut = pair.reference_cut();
/// let mut observer = Observer::new(&pair, ObserverNoise::default());
/// observer.predict(&cut, 60.0);
/// assert!((observer.estimate().flank_wear - 0.1e-3).abs() < 0.1e-3);
/// ```
#[derive(Clone, Debug)]
pub struct Observer {
    /// The pair, and the same for derivatives by wear.
    pairs: Arc<(Pair, Pair<Dual64>)>,
    noise: ObserverNoise,
    mean: [f64; STATES],
    /// Symmetric.
    covariance: [[f64; STATES]; STATES],
    /// Level of the wear factor of edges before this one.
    level: WearLevel,
    known: Option<LastCut>,
}

/// What the last cut gave; at another speed it costs little to adapt.
#[derive(Clone, Copy, Debug)]
struct LastCut {
    contact: Coefficients,
    load: Load<f64>,
}

impl Observer {
    /// An observer of a new edge of `pair`.
    pub fn new(pair: &Pair, noise: ObserverNoise) -> Self {
        Self::of(Arc::new((pair.clone(), pair.map(Dual64::from))), noise)
    }

    fn of(pairs: Arc<(Pair, Pair<Dual64>)>, noise: ObserverNoise) -> Self {
        let ObserverNoise { initial_rate, edge_rate, .. } = noise;
        let level = WearLevel { mean: 0.0, variance: (initial_rate.powi(2) - edge_rate.powi(2)).max(0.0) };
        let mut covariance = [[0.0; STATES]; STATES];
        let deviations = [noise.initial_wear, noise.initial_force, initial_rate, noise.feed_force_gain, noise.emf_gain];
        for (i, deviation) in deviations.into_iter().enumerate() {
            covariance[i][i] = deviation * deviation;
        }
        Self { pairs, noise, mean: [0.0; STATES], covariance, level, known: None }
    }

    /// An observer of the next edge of the same kind: the level of wear and the gains of the sensors are what this edge
    /// has taught, the rest is new. `initial_wear` (m) is the uncertainty of the wear of the edge.
    ///
    /// # Source
    /// Normal levels of edges, `ln factor = level + scatter`: what this edge adds to what was known of it before is the
    /// observation of its factor.
    pub fn next_edge(&self, initial_wear: f64) -> Self {
        let noise = ObserverNoise { initial_wear, ..self.noise };
        let scatter = noise.edge_rate * noise.edge_rate;
        let before = self.level.variance + scatter;
        let now = self.covariance[2][2];
        let level = if now > 0.0 && now < before {
            let error = (now.recip() - before.recip()).recip();
            let observed = error * (self.mean[2] / now - self.level.mean / before);
            self.level.after(observed, error + scatter)
        } else {
            self.level
        };
        let mut next = Self::of(Arc::clone(&self.pairs), noise);
        next.level = level;
        next.mean[2] = level.mean;
        next.covariance[2][2] = level.variance + scatter;
        for (i, gain) in [(3, noise.feed_force_gain), (4, noise.emf_gain)] {
            next.mean[i] = self.mean[i];
            next.covariance[i][i] = (self.covariance[i][i] + noise.gain_drift.powi(2)).min(gain.powi(2));
        }
        next
    }

    /// The same observer believing `estimate`, as uncertain as before.
    pub fn with_estimate(mut self, estimate: Estimate) -> Self {
        let Estimate { flank_wear, ln_force_factor, ln_wear_factor } = estimate;
        let [_, _, _, gains @ ..] = self.mean;
        self.mean = [flank_wear, ln_force_factor, ln_wear_factor, gains[0], gains[1]];
        self
    }

    /// Everything that the observer has learnt, as numbers: for those who keep it elsewhere.
    ///
    /// ```
    /// use toolroom_wear::{Observer, ObserverNoise, Pair};
    /// let pair = Pair::default();
    /// let new = Observer::new(&pair, ObserverNoise::default());
    /// let mut worn = new.clone();
    /// worn.predict(&pair.reference_cut(), 60.0);
    /// assert_eq!(new.with_belief(&worn.belief()).estimate(), worn.estimate());
    /// ```
    pub fn belief(&self) -> [f64; BELIEF] {
        let triangle = (0..STATES).flat_map(|i| (i..STATES).map(move |j| self.covariance[i][j]));
        let mut numbers = self.mean.into_iter().chain(triangle).chain([self.level.mean, self.level.variance]);
        std::array::from_fn(|_| numbers.next().unwrap_or(0.0))
    }

    /// The same observer with what another one of its pair has learnt.
    pub fn with_belief(mut self, belief: &[f64; BELIEF]) -> Self {
        let mut numbers = belief.iter().copied();
        let mut next = || numbers.next().unwrap_or(0.0);
        self.mean = std::array::from_fn(|_| next());
        for i in 0..STATES {
            for j in i..STATES {
                let value = next();
                (self.covariance[i][j], self.covariance[j][i]) = (value, value);
            }
        }
        self.level = WearLevel { mean: next(), variance: next() };
        self
    }

    /// Present estimate.
    pub fn estimate(&self) -> Estimate {
        let [flank_wear, ln_force_factor, ln_wear_factor, ..] = self.mean;
        Estimate { flank_wear, ln_force_factor, ln_wear_factor }
    }

    /// Covariance of the estimate; units of [`Estimate`].
    ///
    /// # Shape
    /// 3 × 3, in the order of [`Estimate`]'s fields.
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| self.covariance[i][j]))
    }

    /// Logarithms of the gains of feed force and thermo-EMF as they are estimated.
    pub fn ln_gains(&self) -> [f64; 2] {
        [self.mean[3], self.mean[4]]
    }

    /// Corrects the estimate by a reading of flank wear (m) with the standard deviation `error` (m).
    pub fn read(&mut self, flank_wear: f64, error: f64) {
        let spread = self.covariance[0][0] + error * error;
        if !(spread > 0.0 && flank_wear.is_finite()) {
            return;
        }
        let innovation = flank_wear - self.mean[0];
        let lever = self.covariance[0];
        for i in 0..STATES {
            self.mean[i] += lever[i] / spread * innovation;
            for j in 0..STATES {
                self.covariance[i][j] -= lever[i] * lever[j] / spread;
            }
        }
    }

    /// A new pass begins at a nominal `depth_of_cut` (m): the allowance may have changed.
    pub fn begin_pass(&mut self, depth_of_cut: f64) {
        let depth = self.noise.depth_scatter / depth_of_cut;
        let scatter = (self.noise.pass_scatter.powi(2) + depth * depth).sqrt() + self.noise.pass_margin;
        self.covariance[1][1] += scatter * scatter;
    }

    /// Contact and forces of a cut.
    fn at<'a>(pair: &'a Pair, known: &mut Option<LastCut>, cut: &Cut) -> (Contact<'a>, Load<f64>) {
        let same = |known: &LastCut| cut.at_speed(known.contact.cut.cutting_speed) == known.contact.cut;
        let known = match known {
            Some(known) if same(known) => *known,
            _ => *known.insert(LastCut { contact: pair.contact(cut).coefficients(), load: pair.force.load(cut) }),
        };
        let speed = cut.cutting_speed;
        (pair.contact_of(known.contact).at_speed(speed), pair.force.at_speed(&known.load, speed))
    }

    /// Moves the estimate by `dt` seconds of cutting at `cut` (midpoint rule).
    pub fn predict(&mut self, cut: &Cut, dt: f64) {
        let (pair, dual) = &*self.pairs;
        let contact = Self::at(pair, &mut self.known, cut).0.lift(dual);
        // The wear factor multiplies the rate, so that its slope by the logarithm is the rate.
        let factor = self.mean[2].exp() * cut.engaged;
        let rate = |wear: f64| {
            let wear = Dual64::new(wear, 1.0);
            contact.steady_wear(wear).rate(contact.cut().cutting_speed) * factor
        };
        let half = 0.5 * dt;
        let start = rate(self.mean[0]);
        let middle = rate(self.mean[0] + half * start.re);
        // The transition is one but for wear, which depends on itself and on the wear factor.
        let by_wear = 1.0 + dt * middle.eps * (1.0 + half * start.eps);
        let by_rate = dt * (middle.re + middle.eps * half * start.re);
        let before = self.covariance;
        let moved = |i: usize| by_wear * before[0][i] + by_rate * before[2][i];
        let row = [by_wear * moved(0) + by_rate * moved(2), moved(1), moved(2), moved(3), moved(4)];
        for (i, value) in row.into_iter().enumerate() {
            (self.covariance[0][i], self.covariance[i][0]) = (value, value);
        }
        let drifts = [self.noise.wear_drift, self.noise.force_drift, self.noise.rate_drift];
        for (i, drift) in drifts.into_iter().enumerate() {
            self.covariance[i][i] += drift * drift * (dt / self.noise.drift_time);
        }
        self.mean[0] += dt * middle.re;
    }

    /// Corrects the estimate by a measurement taken at `cut`. Where the innovation cannot be
    /// weighed (a covariance that is not finite) the estimate stays.
    pub fn update(&mut self, cut: &Cut, measured: &Measurement) {
        let (pair, dual) = &*self.pairs;
        let (contact, load) = Self::at(pair, &mut self.known, cut);
        let contact = contact.lift(dual);
        // Forces are affine in wear and in proportion to the factor on the sharp edge.
        let load = load.times(self.mean[1].exp());
        let (engaged, speed) = (cut.engaged, cut.cutting_speed);
        let wear = Dual64::new(self.mean[0], 1.0);
        let emf = contact.thermo_emf(wear, contact.steady_temperature(wear));
        let [feed_gain, emf_gain] = self.ln_gains().map(f64::exp);
        let (force, feed) = (load.cutting(self.mean[0]) * engaged, feed_gain * load.feed(self.mean[0]) * engaged);
        let emf = emf * emf_gain;
        // A channel: noise, seen, predicted, slopes of the prediction by wear, force factor, wear factor and gains.
        let channels: [(f64, f64, f64, [f64; STATES]); 3] = [
            (
                self.noise.power_noise,
                measured.spindle_power,
                force * speed,
                [load.shear_per_wear * engaged * speed, load.cutting(0.0) * engaged * speed, 0.0, 0.0, 0.0],
            ),
            (
                self.noise.feed_force_noise,
                measured.feed_force,
                feed,
                [feed_gain * load.pressure_per_wear * engaged, feed_gain * load.feed(0.0) * engaged, 0.0, feed, 0.0],
            ),
            (self.noise.emf_noise, measured.thermo_emf, emf.re, [emf.eps, 0.0, 0.0, 0.0, emf.re]),
        ];
        // Their noises are independent: one after the other corrects as all at once would, without
        // an inverse. Each is compared with its noise, a pure number whatever its unit.
        let (mut mean, mut covariance) = (self.mean, self.covariance);
        for (noise, seen, predicted, slopes) in channels {
            let weight = (noise * predicted.abs()).recip();
            let slopes = slopes.map(|slope| slope * weight);
            let along = |of: &[f64; STATES]| slopes.iter().zip(of).map(|(slope, value)| slope * value).sum::<f64>();
            let moved: [f64; STATES] = std::array::from_fn(|i| mean[i] - self.mean[i]);
            let innovation = (seen - predicted) * weight - along(&moved);
            let lever: [f64; STATES] = std::array::from_fn(|i| along(&covariance[i]));
            let spread = along(&lever) + 1.0;
            for i in 0..STATES {
                mean[i] += lever[i] / spread * innovation;
                for j in 0..STATES {
                    covariance[i][j] -= lever[i] * lever[j] / spread;
                }
            }
        }
        if mean.iter().all(|value| value.is_finite()) {
            (self.mean, self.covariance) = (mean, covariance);
        }
    }
}
