//! What the sensors say about an edge.

use super::BelievedModel;
use crate::SensorSheet;
use rand_distr::{Distribution as _, StandardNormal};
use toolroom_kernel::Stream;
use toolroom_wear::{Cut, Estimate, Measurement, ObserverNoise};

/// Least noise that the filter reckons with, relative: what its model of a channel leaves out. Reckoning with less would make
/// a perfect sensor worse than a noisy one, because the filter would believe its model without question (assumption: 1 %).
const LEAST_NOISE: f64 = 0.01;
/// What the model of a channel leaves out beside the noise of its sensor, relative, where readings of wear are there to do
/// without: the stresses of a land differ from the nominal ones by 8 % ([`Scatter::flank_stress`](toolroom_wear::Scatter)) and
/// hardness by 4 %, and neither averages out over the samples of a pass. Smaller values make perfect sensors worse than noisy ones:
/// over 1500 passes the estimate errs by 18 against 13 µm at 1 %, by 8.7 µm either way at 5 %, by 8.4 against 8.5 µm at 8 %.
const MODEL_ERROR: f64 = 0.08;
/// Error of a flank wear reading beside that of the instrument, m: the land is not a straight band, of which a model knows one
/// number (assumption).
pub(super) const LAND_ERROR: f64 = 0.005e-3;
/// Least deviation of the level of the logarithm of wear of all edges from the believed model.
const LEAST_LEVEL: f64 = 0.1;
/// Inflation of the thermo-EMF noise for its bias, relative; with a sensor of 1.5 % it gives the
/// 2.5 % of the filter's derivation (assumption).
const EMF_INFLATION: f64 = 0.02;

impl SensorSheet {
    /// What the filter of a new edge reckons with: these sensors, and depths that scatter by `depth_scatter`, m.
    pub fn observer_noise(&self, depth_scatter: f64) -> ObserverNoise {
        ObserverNoise {
            power_noise: self.spindle_power.max(LEAST_NOISE),
            feed_force_noise: self.feed_force.max(LEAST_NOISE),
            emf_noise: self.thermo_emf.hypot(EMF_INFLATION),
            depth_scatter,
            ..ObserverNoise::default()
        }
    }
}

/// What sensors would show at one instant of a pass, without their errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time since the start of the segment, s.
    pub elapsed: f64,
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Spindle power, W.
    pub spindle_power: f64,
    /// Feed force, N.
    pub feed_force: f64,
    /// Thermo-EMF, V.
    pub thermo_emf: f64,
    /// Root mean square of the force about its mean by chatter, over the mean.
    pub force_ripple: f64,
}

/// Share of the force's fluctuation under chatter that is left in a sample (assumption): what a
/// sensor averages over a tenth of a second does not see all of it.
const ALIASED: f64 = 0.1;

/// What the filter of a new edge reckons with. `read` says whether wear is read from now on: only readings tell the gain of
/// a sensor from wear.
pub(super) fn noise(believed: &BelievedModel, sensors: &SensorSheet, read: bool) -> ObserverNoise {
    let mut new = ObserverNoise {
        edge_rate: believed.edge_scatter,
        // The level of all edges is never known better than this (assumption).
        initial_rate: ObserverNoise::default().initial_rate.max(believed.edge_scatter.hypot(LEAST_LEVEL)),
        ..sensors.observer_noise(believed.allowance)
    };
    if read {
        new.feed_force_gain = sensors.feed_force_gain;
        new.emf_gain = sensors.thermo_emf_gain;
        new.power_noise = sensors.spindle_power.hypot(MODEL_ERROR);
        new.feed_force_noise = sensors.feed_force.hypot(MODEL_ERROR);
        new.emf_noise = sensors.thermo_emf.hypot(MODEL_ERROR);
    }
    new
}

/// The Kalman filter of one edge, fed with samples when a stretch of cutting is over.
#[derive(Clone, Debug)]
pub struct Observer {
    filter: toolroom_wear::Observer,
    /// Nominal cut of the pass.
    cut: Cut,
    /// Time within the segment to which the filter has come, s.
    filtered_until: f64,
    /// Speed then, m/s.
    speed: Option<f64>,
}

impl Observer {
    /// For a new edge, or for one whose flank wear, m, was read; `read` as in [`noise`].
    pub(super) fn new(believed: &BelievedModel, sensors: &SensorSheet, read: bool, reading: Option<f64>) -> Self {
        let new = noise(believed, sensors, read);
        let initial_wear = if reading.is_some() { sensors.flank_wear } else { new.initial_wear };
        let noise = ObserverNoise { initial_wear, ..new };
        let mut filter = toolroom_wear::Observer::new(&believed.pair, noise);
        if let Some(reading) = reading {
            let flank_wear = reading.max(0.0);
            filter = filter.with_estimate(Estimate { flank_wear, ln_force_factor: 0.0, ln_wear_factor: 0.0 });
        }
        Self { filter, cut: believed.cut, filtered_until: 0.0, speed: None }
    }

    /// For the next edge of the same kind, which is new.
    pub(super) fn next_edge(&self, believed: &BelievedModel, sensors: &SensorSheet) -> Self {
        let initial_wear = sensors.observer_noise(believed.allowance).initial_wear;
        Self { filter: self.filter.next_edge(initial_wear), cut: believed.cut, filtered_until: 0.0, speed: None }
    }

    /// The flank wear, m, was read.
    pub fn read(&mut self, flank_wear: f64, sensors: &SensorSheet) {
        self.filter.read(flank_wear, sensors.flank_wear.hypot(LAND_ERROR));
    }

    /// Estimated flank wear, m.
    pub fn flank_wear(&self) -> f64 {
        self.filter.estimate().flank_wear.max(0.0)
    }

    /// Estimated factor of this edge on wear.
    pub fn wear_factor(&self) -> f64 {
        self.filter.estimate().ln_wear_factor.exp()
    }

    /// A pass begins at a nominal cut.
    pub fn begin_pass(&mut self, cut: &Cut) {
        self.cut = *cut;
        self.filter.begin_pass(cut.depth_of_cut);
    }

    /// Takes one sample as the sensors show it: with their biases, the gain `emf_gain` of this
    /// edge's thermocouple, and noise.
    pub fn see(&mut self, sample: &Sample, sensors: &SensorSheet, emf_gain: f64, noise: &mut Stream) {
        let chatter = ALIASED * sample.force_ripple;
        let mut shown = |value: f64, bias: f64, deviation: f64| {
            let z: f64 = StandardNormal.sample(noise);
            value * (1.0 + bias) * (1.0 + deviation.hypot(chatter) * z)
        };
        let measured = Measurement {
            spindle_power: shown(sample.spindle_power, sensors.spindle_power_bias, sensors.spindle_power),
            feed_force: shown(sample.feed_force, sensors.feed_force_bias, sensors.feed_force),
            thermo_emf: shown(sample.thermo_emf * emf_gain, sensors.thermo_emf_bias, sensors.thermo_emf),
        };
        // Commanded speeds are known; over the time since the last sample their mean counts.
        let before = self.speed.unwrap_or(sample.cutting_speed);
        let mean = 0.5 * (before + sample.cutting_speed);
        self.filter.predict(&self.cut.at_speed(mean), sample.elapsed - self.filtered_until);
        self.filter.update(&self.cut.at_speed(sample.cutting_speed), &measured);
        self.filtered_until = sample.elapsed;
        self.speed = Some(sample.cutting_speed);
    }

    /// The stretch of cutting is over; the next one counts its time from zero.
    pub fn segment_ends(&mut self) {
        self.filtered_until = 0.0;
        self.speed = None;
    }
}
