//! An extended Kalman filter that reads flank wear from power, feed force and EMF.

use crate::{Cut, Pair};
use nalgebra::{Matrix3, Vector3};
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
pub struct Measurement {
    /// Spindle power without idle power, W.
    pub spindle_power: f64,
    /// Feed force, N.
    pub feed_force: f64,
    /// Thermo-EMF, V.
    pub thermo_emf: f64,
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
    pair: Pair,
    dual: Pair<Dual64>,
    noise: ObserverNoise,
    mean: Vector3<f64>,
    covariance: Matrix3<f64>,
}

impl Observer {
    /// An observer of a new edge of `pair`.
    pub fn new(pair: &Pair, noise: ObserverNoise) -> Self {
        let deviation = Vector3::new(noise.initial_wear, noise.initial_force, noise.initial_rate);
        Self {
            pair: pair.clone(),
            dual: pair.map(Dual64::from),
            noise,
            mean: Vector3::zeros(),
            covariance: Matrix3::from_diagonal(&deviation.component_mul(&deviation)),
        }
    }

    /// The same observer believing `estimate`, as uncertain as before.
    pub fn with_estimate(mut self, estimate: Estimate) -> Self {
        self.mean = Vector3::new(estimate.flank_wear, estimate.ln_force_factor, estimate.ln_wear_factor);
        self
    }

    /// Present estimate.
    pub fn estimate(&self) -> Estimate {
        Estimate { flank_wear: self.mean[0], ln_force_factor: self.mean[1], ln_wear_factor: self.mean[2] }
    }

    /// Covariance of the estimate; units of [`Estimate`].
    ///
    /// # Shape
    /// 3 × 3, in the order of [`Estimate`]'s fields.
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        self.covariance.transpose().into()
    }

    /// A new pass begins at a nominal `depth_of_cut` (m): the allowance may have changed.
    pub fn begin_pass(&mut self, depth_of_cut: f64) {
        let depth = self.noise.depth_scatter / depth_of_cut;
        let scatter = (self.noise.pass_scatter.powi(2) + depth * depth).sqrt() + self.noise.pass_margin;
        self.covariance[(1, 1)] += scatter * scatter;
    }

    /// Moves the estimate by `dt` seconds of cutting at `cut` (midpoint rule).
    pub fn predict(&mut self, cut: &Cut, dt: f64) {
        // The wear factor multiplies the rate, so that its slope by the logarithm is the rate.
        let worn = Cut { wear_factor: cut.wear_factor * self.mean[2].exp(), ..*cut };
        let contact = self.pair.contact(&worn).lift(&self.dual);
        let rate = |wear: f64| {
            let wear = Dual64::new(wear, 1.0);
            contact.steady_wear(wear).rate(contact.cut.cutting_speed) * contact.cut.engaged
        };
        let half = 0.5 * dt;
        let start = rate(self.mean[0]);
        let middle = rate(self.mean[0] + half * start.re);
        let mut transition = Matrix3::identity();
        transition[(0, 0)] = 1.0 + dt * middle.eps * (1.0 + half * start.eps);
        transition[(0, 2)] = dt * (middle.re + middle.eps * half * start.re);
        let drift = Vector3::new(self.noise.wear_drift, self.noise.force_drift, self.noise.rate_drift);
        let growth = Matrix3::from_diagonal(&drift.component_mul(&drift)) * (dt / self.noise.drift_time);
        self.mean[0] += dt * middle.re;
        self.covariance = transition * self.covariance * transition.transpose() + growth;
    }

    /// Corrects the estimate by a measurement taken at `cut`. Where the innovation cannot be
    /// weighed (a covariance that is not finite) the estimate stays.
    pub fn update(&mut self, cut: &Cut, measured: &Measurement) {
        // Forces are affine in wear and in proportion to the factor on the sharp edge.
        let sharper = Cut { force_factor: cut.force_factor * self.mean[1].exp(), ..*cut };
        let load = self.pair.force.load(&sharper);
        let (engaged, speed) = (cut.engaged, cut.cutting_speed);
        let contact = self.pair.contact(cut).lift(&self.dual);
        let wear = Dual64::new(self.mean[0], 1.0);
        let emf = contact.thermo_emf(wear, contact.steady_temperature(wear));
        let (force, feed) = (load.cutting(self.mean[0]) * engaged, load.feed(self.mean[0]) * engaged);
        let predicted = Vector3::new(force * speed, feed, emf.re);
        let by_wear = Vector3::new(load.shear_per_wear * engaged * speed, load.pressure_per_wear * engaged, emf.eps);
        let by_force = Vector3::new(load.cutting(0.0) * engaged * speed, load.feed(0.0) * engaged, 0.0);
        // Channels are compared with their noise: pure numbers, whatever their units.
        let noise = Vector3::new(self.noise.power_noise, self.noise.feed_force_noise, self.noise.emf_noise);
        let weight = noise.component_mul(&predicted.abs()).map(f64::recip);
        let mut sensitivity = Matrix3::zeros();
        sensitivity.set_column(0, &by_wear.component_mul(&weight));
        sensitivity.set_column(1, &by_force.component_mul(&weight));
        let seen = Vector3::new(measured.spindle_power, measured.feed_force, measured.thermo_emf);
        let innovation = (seen - predicted).component_mul(&weight);
        let spread = sensitivity * self.covariance * sensitivity.transpose() + Matrix3::identity();
        let Some(inverse) = spread.try_inverse() else { return };
        let gain = self.covariance * sensitivity.transpose() * inverse;
        let mean = self.mean + gain * innovation;
        if mean.iter().all(|value| value.is_finite()) {
            self.mean = mean;
            let left = Matrix3::identity() - gain * sensitivity;
            // Joseph's form keeps the covariance symmetric and positive.
            self.covariance = left * self.covariance * left.transpose() + gain * gain.transpose();
        }
    }
}
