//! Priors and sensors of a diagnosis, with the defaults of the records contract.

use super::ChannelId;
use super::stated::STAYS;
use toolroom_records::Sensor;
use toolroom_scenario::Spreads;
use toolroom_wear::Scatter;

/// Prior standard deviation of a machine's gain on a channel.
pub(super) const MACHINE_GAIN: f64 = 0.03;

/// What is believed before any measurement: standard deviations of logarithms, and sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Force coefficients.
    pub force: f64,
    /// Temperature coefficients.
    pub temperature: f64,
    /// Wear-rate level.
    pub wear_level: f64,
    /// Stiffnesses of grinding.
    pub stiffness: f64,
    /// Scale of the half-normal prior of the scatter of wear from edge to edge.
    pub edge_wear: f64,
    /// Scatter of force from edge to edge.
    pub edge_force: f64,
    /// Form of the wear rate, linear in the logarithm of a condition per its spread.
    pub form_wear: f64,
    /// Form of the wear rate over the land.
    pub form_land_wear: f64,
    /// Form of the wear rate over the land as it differs with the conditions, per spread of theirs.
    pub form_land_conditions_wear: f64,
    /// Conditions, lots and materials that an empirical model knows; every number, if `None`.
    pub conditions: Option<Vec<String>>,
    /// Channels that an empirical model answers for; all, if empty.
    pub channels: Vec<String>,
    /// Whether an empirical model wears its edges at a constant rate instead of by a power of time.
    pub constant_rate: bool,
    /// Sensors that differ from the sheet.
    pub sensors: Vec<(String, Sensor)>,
    /// How edges and workpieces scatter in the scenario; `None` where it says nothing of it.
    pub scatter: Option<Scatter>,
    /// Parts of the scenario and the number of their workpieces that share a hardness.
    pub lots: Vec<(String, u32)>,
    /// Standard deviation of the time to load and unload a part, s.
    pub handling: f64,
    /// How natural frequencies and damping ratios of the machines differ in the scenario, relative standard deviations.
    pub structure_scatter: [f64; 2],
    /// How well the parameters of the tool are known by the draws or by `[prior]` of its set.
    pub spreads: Spreads,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            force: 0.08,
            temperature: 0.05,
            wear_level: 0.15,
            stiffness: 0.10,
            edge_wear: 0.25,
            edge_force: 0.02,
            form_wear: 0.15,
            form_land_wear: 0.15,
            form_land_conditions_wear: 0.15,
            conditions: None,
            channels: Vec::new(),
            constant_rate: false,
            sensors: Vec::new(),
            scatter: None,
            lots: Vec::new(),
            handling: 0.0,
            structure_scatter: [0.0; 2],
            spreads: Spreads::default(),
        }
    }
}

impl Settings {
    /// Standard deviation of the logarithm of the parameter called `group.name`: as the draws or the set of the tool say,
    /// else the usual one.
    pub fn spread(&self, name: &str, usual: f64) -> f64 {
        kept(self.spreads.parameters.get(name).copied(), usual)
    }

    /// The same of the level of the wear rate.
    pub fn spread_of_wear(&self) -> f64 {
        kept(self.spreads.wear_level, self.wear_level)
    }

    /// Whether nobody states how much a channel scatters beside its sensor: the cycle time, where the file gives loading one
    /// time and `[[gap.sensor]]` says nothing of it.
    pub fn leaves_unstated(&self, channel: ChannelId) -> bool {
        channel == ChannelId::CycleTime
            && self.handling == 0.0
            && self.sensors.iter().all(|(name, _)| name != channel.word())
    }

    /// The sensor of a column; handling scatters like an error of the cycle time.
    pub fn sensor(&self, column: &str) -> Sensor {
        let given = self.sensors.iter().find(|(name, _)| name == column);
        let mut sensor = given.map_or_else(|| Sensor::usual(column), |(_, sensor)| *sensor);
        if column == ChannelId::CycleTime.word() {
            sensor.absolute = sensor.absolute.hypot(self.handling);
        }
        sensor
    }
}

/// A spread that other measurements have left, or the usual one.
fn kept(known: Option<f64>, usual: f64) -> f64 {
    known.map_or(usual, |known| known.hypot(STAYS * usual))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_calibration_has_left_goes_before_the_usual_spread() {
        let spreads =
            Spreads { parameters: [("force.specific_force".to_owned(), 0.02)].into(), wear_level: Some(0.05) };
        let settings = Settings { spreads, ..Settings::default() };
        assert!((settings.spread("force.specific_force", 0.08) - 0.02_f64.hypot(0.25 * 0.08)).abs() < 1e-12);
        assert!((settings.spread("force.flank_pressure", 0.08) - 0.08).abs() < 1e-12);
        assert!((settings.spread_of_wear() - 0.05_f64.hypot(0.25 * 0.15)).abs() < 1e-12);
        assert!((Settings::default().spread_of_wear() - 0.15).abs() < 1e-12);
    }
}
