//! Forces and spindle power against wear: level, exponents, and stresses on the land.

use crate::level::{Joint, Nodes, Start, ln_integral, mode};
use crate::model::Model;
use crate::normal::{HALF_LN_TAU, ln_density};
use crate::parameter::{Parameter, Prior, Scale};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use toolroom_wear::{Cut, Force};

/// Standard deviation of the logarithm of a force level that comes from a handbook (assumption: a factor 1.35).
const LEVEL: f64 = 0.3;
/// Standard deviation of an exponent of the force (assumption).
const EXPONENT: f64 = 0.1;
/// Standard deviation of the logarithm of the shear stress on the land (assumption: a factor 1.65).
const STRESS: f64 = 0.5;
/// Median of the scatter of the force from edge to edge, and the standard deviation of its logarithm (assumption).
const SCATTER: (f64, f64) = (0.02, 0.5);
/// Median of the relative error of a force reading, that of the usual sensor sheet, and the standard deviation of its
/// logarithm (assumption).
const NOISE: (f64, f64) = (0.02, 0.5);

/// Median idle power of a spindle in kW, and the standard deviation of its logarithm (assumption: lathes idle with 0.2 to 2 kW).
const IDLE: (f64, f64) = (0.6, 0.7);

/// Name of the idle power of a spindle among the parameters.
pub const IDLE_POWER: &str = "spindle_idle_power";

/// What is measured of the load of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Cutting force, N.
    CuttingForce,
    /// Power of the spindle, kW: cutting force times speed, above an idle power.
    SpindlePower,
    /// Feed force, N.
    FeedForce,
}

impl Channel {
    /// All of them; each is fitted with what those before it have told.
    pub const ALL: [Self; 3] = [Self::CuttingForce, Self::SpindlePower, Self::FeedForce];

    /// Its column in records.
    pub const fn column(self) -> &'static str {
        match self {
            Self::CuttingForce => "cutting_force",
            Self::SpindlePower => "spindle_power",
            Self::FeedForce => "feed_force",
        }
    }

    /// What a value of records in SI units is in the unit of this channel.
    pub(crate) const fn scale(self) -> f64 {
        match self {
            Self::CuttingForce | Self::FeedForce => 1.0,
            Self::SpindlePower => 1e-3,
        }
    }

    /// Names of the scatter from edge to edge and of the relative error of a reading among the parameters.
    pub const fn spread_names(self) -> [&'static str; 2] {
        match self {
            Self::CuttingForce => ["force_scatter", "force_noise"],
            Self::SpindlePower => ["power_scatter", "power_noise"],
            Self::FeedForce => ["feed_force_scatter", "feed_force_noise"],
        }
    }
}

/// A reading of a force or a power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReading {
    /// The cut.
    pub cut: Cut,
    /// Flank wear of that moment, mm.
    pub wear: f64,
    /// What was read, in the unit of its [`Channel`].
    pub force: f64,
}

/// Forces of edges, `F = C·a^x·f^y·v^n·k + τ_f·b·h + ε`, with `ln k ~ N(0, σ_k²)` of each edge integrated out and an error
/// ε that is a share of the force. The feed force has the same form, with its ratio to the cutting force in place of C and the
/// pressure on the land in place of τ_f; C, x, y and n are then those of the set. Spindle power is cutting force times speed, above
/// an idle power.
///
/// The wear h is that of the fitted curve and not the reading: a reading has an error, which would make the shear stress
/// look smaller than it is.
#[derive(Clone, Debug)]
pub struct ForceModel {
    channel: Channel,
    base: Force,
    parameters: Vec<Parameter>,
    /// Scatter and noise where they are known.
    known: Option<(f64, f64)>,
    /// Whether the land acts at all.
    land: bool,
    edges: Vec<Vec<ForceReading>>,
}

impl ForceModel {
    /// Cutting forces of edges around the force group of a set. `known` are the scatter from edge to edge and the relative error
    /// of a reading where they are not to be estimated.
    pub fn new(base: &Force, edges: Vec<Vec<ForceReading>>, known: Option<(f64, f64)>) -> Self {
        Self::of(Channel::CuttingForce, base, edges, known)
    }

    /// The same of any channel.
    pub fn of(channel: Channel, base: &Force, edges: Vec<Vec<ForceReading>>, known: Option<(f64, f64)>) -> Self {
        let ln = |name: &str, unit, value: f64, deviation, lift| {
            Parameter::new(name, unit, Scale::Logarithm, Prior::new(value.ln(), deviation), lift)
        };
        let exponent =
            |name: &str, value, lift| Parameter::new(name, "1", Scale::Plain, Prior::new(value, EXPONENT), lift);
        let cutting = || {
            vec![
                ln("force.specific_force", "N", base.specific_force, LEVEL, "measure the force of any edge"),
                exponent("force.feed_exponent", base.feed_exponent, "vary feed_per_rev"),
                exponent("force.speed_exponent", base.speed_exponent, "vary cutting_speed by a factor of 1.2 or more"),
                ln(
                    "force.flank_shear_stress",
                    "MPa",
                    base.flank_shear_stress * 1e-6,
                    STRESS,
                    "measure the force of new and of worn edges",
                ),
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
                ln("force.feed_force_ratio", "1", base.feed_force_ratio, LEVEL, "measure the feed force of any edge"),
                ln(
                    "force.flank_pressure",
                    "MPa",
                    base.flank_pressure * 1e-6,
                    STRESS,
                    "measure the feed force of new and of worn edges",
                ),
            ],
        };
        if known.is_none() {
            let [scatter, noise] = channel.spread_names();
            parameters.push(ln(scatter, "1", SCATTER.0, SCATTER.1, "measure the force of more edges"));
            parameters.push(ln(noise, "1", NOISE.0, NOISE.1, "measure the force more than once on an edge"));
        }
        Self { channel, base: *base, parameters, known, land: true, edges }
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

    /// The same forces without any effect of the land.
    pub fn without_land(&self) -> Self {
        Self { land: false, ..self.clone() }
    }

    /// The force group at some working coordinates.
    pub fn force(&self, u: &[f64]) -> Force {
        match self.channel {
            Channel::CuttingForce | Channel::SpindlePower => Force {
                specific_force: u[0].exp(),
                feed_exponent: u[1],
                speed_exponent: u[2],
                flank_shear_stress: u[3].exp() * 1e6,
                ..self.base
            },
            Channel::FeedForce => Force { feed_force_ratio: u[0].exp(), flank_pressure: u[1].exp() * 1e6, ..self.base },
        }
    }

    /// Scatter from edge to edge and relative error of a reading.
    fn spread(&self, u: &[f64]) -> (f64, f64) {
        let last = self.parameters.len() - 1;
        self.known.unwrap_or_else(|| (u[last - 1].exp(), u[last].exp()))
    }

    /// What the sharp edge and what all else has to each reading of an edge; the level of the edge acts on the former.
    fn parts(&self, u: &[f64], edge: usize) -> Vec<(f64, f64)> {
        let force = self.force(u);
        let land = if self.land { 1e-3 } else { 0.0 };
        let part = |reading: &ForceReading| {
            let load = force.load(&reading.cut);
            let worn = reading.wear * land;
            match self.channel {
                Channel::CuttingForce => (load.sharp, load.shear_per_wear * worn),
                Channel::FeedForce => (load.feed_force_ratio * load.sharp, load.pressure_per_wear * worn),
                Channel::SpindlePower => {
                    let speed = reading.cut.cutting_speed * Channel::SpindlePower.scale();
                    (speed * load.sharp, speed * load.shear_per_wear * worn + u[4].exp())
                }
            }
        };
        self.edges[edge].iter().map(part).collect()
    }
}

impl Model for ForceModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn edges(&self) -> usize {
        self.edges.len()
    }

    fn readings(&self, edge: usize) -> Vec<f64> {
        self.edges[edge].iter().map(|reading| reading.force).collect()
    }

    fn replicate(&self, u: &[f64], edge: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let (scatter, noise) = self.spread(u);
        let mut normal = || -> f64 { StandardNormal.sample(&mut *random) };
        let level = (scatter * normal()).exp();
        let parts = self.parts(u, edge);
        parts.iter().map(|(sharp, land)| (sharp * level + land) * noise.mul_add(normal(), 1.0)).collect()
    }

    fn ln_densities(&self, u: &[f64], edges: &[usize]) -> Vec<f64> {
        let (scatter, noise) = self.spread(u);
        let of_edge = |edge: &usize| {
            let parts = self.parts(u, *edge);
            let mut joint = |z: f64, stride: usize| -> Joint {
                let level = (scatter * z).exp();
                let (mut density, mut gradient, mut curvature) = (-0.5 * z * z - HALF_LN_TAU, -z, 1.0);
                for (reading, (sharp, land)) in self.edges[*edge].iter().zip(&parts).step_by(stride) {
                    let (mean, slope) = (sharp * level + land, sharp * level * scatter);
                    let deviation = noise * mean;
                    let off = (reading.force - mean) / deviation;
                    density += ln_density(reading.force, mean, deviation);
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
