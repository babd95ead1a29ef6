//! Forces, power and temperatures against wear: level, exponents, and what the land adds.

use crate::level::{Joint, Nodes, Start, ln_integral, mode};
use crate::model::Model;
use crate::normal::{HALF_LN_TAU, ln_density};
use crate::parameter::{Parameter, Prior, Scale};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use toolroom_process::Record;
use toolroom_wear::{Cut, Force, Pair};

/// Standard deviation of the logarithm of the level of a force or a temperature that comes from a handbook (assumption: a factor
/// 1.35).
const LEVEL: f64 = 0.3;
/// Standard deviation of an exponent of the force or the temperature (assumption).
const EXPONENT: f64 = 0.1;
/// Standard deviation of the logarithm of a stress on the land and of its heating (assumption: a factor 1.65).
const STRESS: f64 = 0.5;
/// Median of the scatter of a channel from edge to edge, and the standard deviation of its logarithm (assumption).
const SCATTER: (f64, f64) = (0.02, 0.5);
/// Median of the relative error of a reading of force or power, that of the usual sensor sheet, and the standard deviation of
/// its logarithm (assumption).
const NOISE: (f64, f64) = (0.02, 0.5);
/// The same of a temperature and of a thermo-EMF.
const HEAT_NOISE: (f64, f64) = (0.015, 0.5);

/// Median idle power of a spindle in kW, and the standard deviation of its logarithm (assumption: lathes idle with 0.2 to 2 kW).
const IDLE: (f64, f64) = (0.6, 0.7);

/// Name of the idle power of a spindle among the parameters.
pub const IDLE_POWER: &str = "spindle_idle_power";

/// What is measured of the load and the heat of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Cutting force, N.
    CuttingForce,
    /// Power of the spindle, kW: cutting force times speed, above an idle power.
    SpindlePower,
    /// Feed force, N.
    FeedForce,
    /// Contact temperature at the flank, K.
    Temperature,
    /// Thermo-EMF of the tool and the work, mV.
    ThermoEmf,
}

impl Channel {
    /// All of them; each is fitted with what those before it have told.
    pub const ALL: [Self; 5] =
        [Self::CuttingForce, Self::SpindlePower, Self::FeedForce, Self::Temperature, Self::ThermoEmf];

    /// Its column in records.
    pub const fn column(self) -> &'static str {
        match self {
            Self::CuttingForce => "cutting_force",
            Self::SpindlePower => "spindle_power",
            Self::FeedForce => "feed_force",
            Self::Temperature => "temperature",
            Self::ThermoEmf => "thermo_emf",
        }
    }

    /// Whether it tells of temperatures, on which wear depends; the others depend on wear.
    pub const fn heats(self) -> bool {
        match self {
            Self::CuttingForce | Self::SpindlePower | Self::FeedForce => false,
            Self::Temperature | Self::ThermoEmf => true,
        }
    }

    /// Unit of its readings here.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::CuttingForce | Self::FeedForce => "N",
            Self::SpindlePower => "kW",
            Self::Temperature => "K",
            Self::ThermoEmf => "mV",
        }
    }

    /// What a value of records in SI units is in the unit of this channel.
    pub(crate) const fn scale(self) -> f64 {
        match self {
            Self::CuttingForce | Self::FeedForce | Self::Temperature => 1.0,
            Self::SpindlePower => 1e-3,
            Self::ThermoEmf => 1e3,
        }
    }

    /// Names of the scatter from edge to edge and of the relative error of a reading among the parameters.
    pub const fn spread_names(self) -> [&'static str; 2] {
        match self {
            Self::CuttingForce => ["force_scatter", "force_noise"],
            Self::SpindlePower => ["power_scatter", "power_noise"],
            Self::FeedForce => ["feed_force_scatter", "feed_force_noise"],
            Self::Temperature => ["temperature_scatter", "temperature_noise"],
            Self::ThermoEmf => ["thermo_emf_scatter", "thermo_emf_noise"],
        }
    }
}

/// A reading of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelReading {
    /// The cut.
    pub cut: Cut,
    /// Flank wear of that moment, mm.
    pub wear: f64,
    /// What was read, in the unit of its [`Channel`].
    pub value: f64,
}

/// Forces of edges, `F = C·a^x·f^y·v^n·k + τ_f·b·h + ε`, with `ln k ~ N(0, σ_k²)` of each edge integrated out and an error
/// ε that is a share of the force. The feed force has the same form, with its ratio to the cutting force in place of C and the
/// pressure on the land in place of τ_f; C, x, y and n are then those of the set. Spindle power is cutting force times speed, above
/// an idle power.
///
/// The rise of temperature over that of the room has the chip's part `K_t·v^x·f^y·a^z` and that of friction on the land, `K_f·√(v·h)`, as the group
/// `temperature` of a set states them; the level k of the edge acts on both, and z is that of the set. A thermo-EMF tells the same by
/// the characteristic of the group `emf`; where the temperature was read as well, it tells the slope of that characteristic.
///
/// The wear h is that of the fitted curve and not the reading: a reading has an error, which would make the shear stress
/// look smaller than it is.
#[derive(Clone, Debug)]
pub struct ChannelModel {
    channel: Channel,
    base: Pair,
    /// Whether the temperatures are known, so that a thermo-EMF tells of the thermocouple.
    thermocouple: bool,
    parameters: Vec<Parameter>,
    /// Scatter and noise where they are known.
    known: Option<(f64, f64)>,
    /// Whether the land acts at all.
    land: bool,
    edges: Vec<Vec<ChannelReading>>,
}

impl ChannelModel {
    /// Cutting forces of edges around the force group of a set. `known` are the scatter from edge to edge and the relative error
    /// of a reading where they are not to be estimated.
    pub fn new(base: &Force, edges: Vec<Vec<ChannelReading>>, known: Option<(f64, f64)>) -> Self {
        Self::from_channel(Channel::CuttingForce, &Pair { force: *base, ..Pair::default() }, edges, known, false)
    }

    /// Readings of any channel around a set. A thermo-EMF tells of the temperatures, or where they are known (`thermocouple`) of
    /// the slope of its own characteristic.
    pub fn from_channel(
        channel: Channel,
        base: &Pair,
        edges: Vec<Vec<ChannelReading>>,
        known: Option<(f64, f64)>,
        thermocouple: bool,
    ) -> Self {
        let ln = |name: &str, unit, value: f64, deviation, lift| {
            Parameter::new(name, unit, Scale::Logarithm, Prior::new(value.ln(), deviation), lift)
        };
        let exponent =
            |name: &str, value, lift| Parameter::new(name, "1", Scale::Plain, Prior::new(value, EXPONENT), lift);
        let (force, heat) = (&base.force, &base.temperature);
        let speed = "vary cutting_speed by a factor of 1.2 or more";
        let cutting = || {
            vec![
                ln("force.specific_force", "N", force.specific_force, LEVEL, "measure the force of any edge"),
                exponent("force.feed_exponent", force.feed_exponent, "vary feed_per_rev"),
                exponent("force.speed_exponent", force.speed_exponent, speed),
                ln(
                    "force.flank_shear_stress",
                    "MPa",
                    force.flank_shear_stress * 1e-6,
                    STRESS,
                    "measure the force of new and of worn edges",
                ),
            ]
        };
        let heating = || {
            let land = "measure the temperature of new and of worn edges";
            vec![
                ln("temperature.chip_heating", "K", heat.chip_heating, LEVEL, "measure the temperature of any edge"),
                exponent("temperature.speed_exponent", heat.speed_exponent, speed),
                exponent("temperature.feed_exponent", heat.feed_exponent, "vary feed_per_rev"),
                ln("temperature.flank_heating", "K", heat.flank_heating, STRESS, land),
            ]
        };
        let mut parameters = match channel {
            Channel::CuttingForce => cutting(),
            Channel::SpindlePower => {
                let idle =
                    ln(IDLE_POWER, "kW", IDLE.0, IDLE.1, "measure the power at several feeds, or of the idle spindle");
                cutting().into_iter().chain([idle]).collect()
            }
            Channel::FeedForce => vec![
                ln("force.feed_force_ratio", "1", force.feed_force_ratio, LEVEL, "measure the feed force of any edge"),
                ln(
                    "force.flank_pressure",
                    "MPa",
                    force.flank_pressure * 1e-6,
                    STRESS,
                    "measure the feed force of new and of worn edges",
                ),
            ],
            Channel::ThermoEmf if thermocouple => {
                let sensitivity = base.emf.sensitivity * 1e3;
                vec![ln("emf.sensitivity", "mV/K", sensitivity, LEVEL, "measure the thermo-EMF of any edge")]
            }
            Channel::Temperature | Channel::ThermoEmf => heating(),
        };
        if known.is_none() {
            let [scatter, noise] = channel.spread_names();
            let (median, deviation) = if channel.heats() { HEAT_NOISE } else { NOISE };
            parameters.push(ln(scatter, "1", SCATTER.0, SCATTER.1, "measure more edges"));
            parameters.push(ln(noise, "1", median, deviation, "measure more than once on an edge"));
        }
        Self { channel, base: base.clone(), thermocouple, parameters, known, land: true, edges }
    }

    /// What was measured.
    pub fn channel(&self) -> Channel {
        self.channel
    }

    /// Sets the prior of a parameter; a mean of NaN keeps the present one. Other names are none of this model's.
    pub fn set_prior(&mut self, name: &str, prior: Prior) {
        for parameter in self.parameters.iter_mut().filter(|parameter| parameter.name == name) {
            let mean = if prior.mean.is_nan() { parameter.prior.mean } else { prior.mean };
            parameter.prior = Prior { mean, ..prior };
        }
    }

    /// The same readings without any effect of the land.
    pub fn without_land(&self) -> Self {
        Self { land: false, ..self.clone() }
    }

    /// The set at some working coordinates.
    pub fn at(&self, u: &[f64]) -> Pair {
        let mut pair = self.base.clone();
        match self.channel {
            Channel::CuttingForce | Channel::SpindlePower => {
                pair.force.specific_force = u[0].exp();
                (pair.force.feed_exponent, pair.force.speed_exponent) = (u[1], u[2]);
                pair.force.flank_shear_stress = u[3].exp() * 1e6;
            }
            Channel::FeedForce => {
                (pair.force.feed_force_ratio, pair.force.flank_pressure) = (u[0].exp(), u[1].exp() * 1e6);
            }
            Channel::ThermoEmf if self.thermocouple => pair.emf.sensitivity = u[0].exp() * 1e-3,
            Channel::Temperature | Channel::ThermoEmf => {
                (pair.temperature.chip_heating, pair.temperature.flank_heating) = (u[0].exp(), u[3].exp());
                (pair.temperature.speed_exponent, pair.temperature.feed_exponent) = (u[1], u[2]);
            }
        }
        pair
    }

    /// Scatter from edge to edge and relative error of a reading.
    fn spread(&self, u: &[f64]) -> (f64, f64) {
        let last = self.parameters.len() - 1;
        self.known.unwrap_or_else(|| (u[last - 1].exp(), u[last].exp()))
    }

    /// What the level of the edge acts on in each of its readings, and all else: of forces the sharp edge and the land, of temperatures
    /// the rise and the room.
    fn parts(&self, pair: &Pair, u: &[f64], edge: usize) -> Vec<(f64, f64)> {
        self.edges[edge].iter().map(|reading| self.part(pair, u, reading)).collect()
    }

    fn part(&self, pair: &Pair, u: &[f64], reading: &ChannelReading) -> (f64, f64) {
        let worn = if self.land { reading.wear * 1e-3 } else { 0.0 };
        let (load, room) = (|| pair.force.load(&reading.cut), pair.temperature.ambient_temperature);
        match self.channel {
            Channel::CuttingForce => {
                let load = load();
                (load.sharp, load.shear_per_wear * worn)
            }
            Channel::FeedForce => {
                let load = load();
                (load.feed_force_ratio * load.sharp, load.pressure_per_wear * worn)
            }
            Channel::SpindlePower => {
                let (load, speed) = (load(), reading.cut.cutting_speed * Channel::SpindlePower.scale());
                (speed * load.sharp, speed * load.shear_per_wear * worn + u[4].exp())
            }
            Channel::Temperature => (pair.point(&reading.cut, worn).temperature - room, room),
            Channel::ThermoEmf => {
                let cold = pair.emf.offset + pair.emf.sensitivity * (room - pair.emf.celsius_zero);
                let rise = pair.point(&reading.cut, worn).thermo_emf - cold;
                (Channel::ThermoEmf.scale() * rise, Channel::ThermoEmf.scale() * cold)
            }
        }
    }

    /// What was read of each edge over what a sharp edge of usual level would have shown under the same cut at some working
    /// coordinates, with the wear in mm, and the same of the model at the level of usual edges.
    pub fn over_sharp(&self, u: &[f64]) -> Vec<(f64, f64, f64)> {
        let (pair, blind) = (self.at(u), self.without_land());
        let sum = |(level, rest): (f64, f64)| level + rest;
        let one = |reading: &ChannelReading| {
            let sharp = sum(blind.part(&pair, u, reading));
            (reading.wear, reading.value / sharp, sum(self.part(&pair, u, reading)) / sharp)
        };
        self.edges.iter().flatten().map(one).collect()
    }
}

impl Model for ChannelModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn edges(&self) -> usize {
        self.edges.len()
    }

    fn possible(&self, u: &[f64]) -> bool {
        let pair = self.at(u);
        pair.force.check().is_ok() && pair.temperature.check().is_ok() && pair.emf.check().is_ok()
    }

    fn readings(&self, edge: usize) -> Vec<f64> {
        self.edges[edge].iter().map(|reading| reading.value).collect()
    }

    fn replicate(&self, u: &[f64], edge: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let (scatter, noise) = self.spread(u);
        let mut normal = || -> f64 { StandardNormal.sample(&mut *random) };
        let level = (scatter * normal()).exp();
        let parts = self.parts(&self.at(u), u, edge);
        parts.iter().map(|(sharp, land)| (sharp * level + land) * noise.mul_add(normal(), 1.0)).collect()
    }

    fn ln_densities(&self, u: &[f64], edges: &[usize]) -> Vec<f64> {
        let ((scatter, noise), pair) = (self.spread(u), self.at(u));
        if !self.possible(u) {
            return vec![f64::NEG_INFINITY; edges.len()];
        }
        let of_edge = |edge: &usize| {
            let parts = self.parts(&pair, u, *edge);
            let mut joint = |z: f64, stride: usize| -> Joint {
                let level = (scatter * z).exp();
                let (mut density, mut gradient, mut curvature) = (-0.5 * z * z - HALF_LN_TAU, -z, 1.0);
                for (reading, (sharp, land)) in self.edges[*edge].iter().zip(&parts).step_by(stride) {
                    let (mean, slope) = (sharp * level + land, sharp * level * scatter);
                    let deviation = noise * mean;
                    let off = (reading.value - mean) / deviation;
                    density += ln_density(reading.value, mean, deviation);
                    gradient += slope / deviation * (off + noise * (off * off - 1.0));
                    curvature += (slope / deviation).powi(2) * (1.0 + 2.0 * noise * noise);
                }
                (density, gradient, curvature)
            };
            let top = mode(&mut joint, parts.len(), Start::Many);
            ln_integral(Nodes::Nine, top, |levels| levels.iter_mut().for_each(|z| *z = joint(*z, 1).0))
        };
        edges.iter().map(of_edge).collect()
    }
}
