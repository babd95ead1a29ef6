//! An extended Kalman filter that reads flank wear from power, feed force and EMF.

use crate::{Coefficients, Contact, Cut, Load, Pair};
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
        /// Scatter of the depth of cut from pass to pass.
        depth_scatter: Real["m" => "mm"] = 0.05e-3, 0.0..=1e-2;
        /// Other scatter of force from pass to pass.
        pass_scatter: Real = 0.02, 0.0..=10.0;
        /// Added to the scatter from pass to pass.
        pass_margin: Real = 0.01, 0.0..=10.0;
    }
}

/// What the machine measures in cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<N = f64> {
    /// Spindle power without idle power, W.
    pub spindle_power: N,
    /// Feed force, N.
    pub feed_force: N,
    /// Thermo-EMF, V.
    pub thermo_emf: N,
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

/// Extended Kalman filter on (flank wear, ln force factor, ln wear factor).
///
/// Power and feed force feel wear differently, so wear and force factor separate; the force
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
    mean: [f64; 3],
    /// Symmetric.
    covariance: [[f64; 3]; 3],
    known: Option<Known>,
}

/// What the last cut gave; at another speed it costs little to adapt.
#[derive(Clone, Copy, Debug)]
struct Known {
    contact: Coefficients,
    load: Load<f64>,
}

impl Observer {
    /// An observer of a new edge of `pair`.
    pub fn new(pair: &Pair, noise: ObserverNoise) -> Self {
        let mut covariance = [[0.0; 3]; 3];
        let deviations = [noise.initial_wear, noise.initial_force, noise.initial_rate];
        for (i, deviation) in deviations.into_iter().enumerate() {
            covariance[i][i] = deviation * deviation;
        }
        let pairs = Arc::new((pair.clone(), pair.map(Dual64::from)));
        Self { pairs, noise, mean: [0.0; 3], covariance, known: None }
    }

    /// The same observer believing `estimate`, as uncertain as before.
    pub fn with_estimate(mut self, estimate: Estimate) -> Self {
        self.mean = [estimate.flank_wear, estimate.ln_force_factor, estimate.ln_wear_factor];
        self
    }

    /// Present estimate.
    pub fn estimate(&self) -> Estimate {
        let [flank_wear, ln_force_factor, ln_wear_factor] = self.mean;
        Estimate { flank_wear, ln_force_factor, ln_wear_factor }
    }

    /// Covariance of the estimate; units of [`Estimate`].
    ///
    /// # Shape
    /// 3 × 3, in the order of [`Estimate`]'s fields.
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        self.covariance
    }

    /// A new pass begins at a nominal `depth_of_cut` (m): the allowance may have changed.
    pub fn begin_pass(&mut self, depth_of_cut: f64) {
        let depth = self.noise.depth_scatter / depth_of_cut;
        let scatter = (self.noise.pass_scatter.powi(2) + depth * depth).sqrt() + self.noise.pass_margin;
        self.covariance[1][1] += scatter * scatter;
    }

    /// Contact and forces of a cut.
    fn at<'a>(pair: &'a Pair, known: &mut Option<Known>, cut: &Cut) -> (Contact<'a>, Load<f64>) {
        let same = |known: &Known| cut.at_speed(known.contact.cut.cutting_speed) == known.contact.cut;
        let known = match known {
            Some(known) if same(known) => *known,
            _ => *known.insert(Known { contact: pair.contact(cut).coefficients(), load: pair.force.load(cut) }),
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
        let row = [by_wear * moved(0) + by_rate * moved(2), moved(1), moved(2)];
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
        let (force, feed) = (load.cutting(self.mean[0]) * engaged, load.feed(self.mean[0]) * engaged);
        // A channel: noise, seen, predicted, slopes of the prediction by wear and force factor.
        let channels = [
            (
                self.noise.power_noise,
                measured.spindle_power,
                force * speed,
                load.shear_per_wear * engaged * speed,
                load.cutting(0.0) * engaged * speed,
            ),
            (
                self.noise.feed_force_noise,
                measured.feed_force,
                feed,
                load.pressure_per_wear * engaged,
                load.feed(0.0) * engaged,
            ),
            (self.noise.emf_noise, measured.thermo_emf, emf.re, emf.eps, 0.0),
        ];
        // Their noises are independent: one after the other corrects as all at once would, without
        // an inverse. Each is compared with its noise, a pure number whatever its unit.
        let (mut mean, mut covariance) = (self.mean, self.covariance);
        for (noise, seen, predicted, by_wear, by_force) in channels {
            let weight = (noise * predicted.abs()).recip();
            let (by_wear, by_force) = (by_wear * weight, by_force * weight);
            let moved = by_wear * (mean[0] - self.mean[0]) + by_force * (mean[1] - self.mean[1]);
            let innovation = (seen - predicted) * weight - moved;
            let lever: [f64; 3] = std::array::from_fn(|i| covariance[i][0] * by_wear + covariance[i][1] * by_force);
            let spread = by_wear * lever[0] + by_force * lever[1] + 1.0;
            for i in 0..3 {
                mean[i] += lever[i] / spread * innovation;
                for j in 0..3 {
                    covariance[i][j] -= lever[i] * lever[j] / spread;
                }
            }
        }
        if mean.iter().all(|value| value.is_finite()) {
            (self.mean, self.covariance) = (mean, covariance);
        }
    }
}
