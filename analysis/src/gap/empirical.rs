//! A power law of the recorded conditions, for data without a physical parameter set.

use super::features::{self, standardised};
use super::noise::median;
use super::settings::Settings;
use super::{Candidate, Channel, Forward, Frame, Local, Measured, Point, Surface, Transform};
use crate::records::{ColumnKind, Records};

/// Conditions in which a response is a power law, where they are recorded.
const CONDITIONS: [&str; 6] =
    ["cutting_speed", "feed_per_rev", "feed_per_tooth", "depth_of_cut", "width_of_cut", "cutting_time"];
/// Prior standard deviation of a response per spread of a condition: all but free.
const FREE: f64 = 1.0;
/// Prior standard deviation of the level of a response: free.
const LEVEL: f64 = 5.0;
/// Curvature of the logarithm of a response (assumption).
const CURVED: f64 = 0.05;
/// Land to which the size of wear effects refers, m.
const LAND: f64 = 0.3e-3;

/// Power laws over [`Records`].
pub struct Empirical {
    frame: Frame,
    levels: Vec<f64>,
    /// Channel and relative slope of every row, by candidate.
    actions: Vec<(Vec<usize>, Vec<f64>)>,
}

impl Empirical {
    /// The model over `records`, whose groups and their part in the fit are given.
    pub fn new(records: &Records, groups: (Vec<String>, Vec<usize>, Vec<bool>), settings: &Settings) -> Self {
        let (names, group_of_row, fitted) = groups;
        let columns = records.kind.columns().iter().filter(|column| column.kind == ColumnKind::Channel);
        let mut channels: Vec<(Channel, Vec<f64>)> = columns
            .filter_map(|column| {
                let values = records.numbers(column.name)?.to_vec();
                let channel = Channel {
                    name: column.name,
                    display: column.display,
                    unit: column.unit,
                    transform: Transform::Log,
                    sensor: settings.sensor(column.name),
                };
                values.iter().any(|value| *value > 0.0).then_some((channel, values))
            })
            .collect();
        // Wear beside other channels is what they respond to.
        let wear = records.numbers("flank_wear").filter(|_| channels.len() > 1).map(<[f64]>::to_vec);
        if wear.is_some() {
            channels.retain(|(channel, _)| channel.name != "flank_wear");
        }
        let level =
            |values: &[f64]| median(&mut values.iter().copied().filter(|value| *value > 0.0).collect::<Vec<f64>>());
        let levels = channels.iter().map(|(_, values)| level(values)).collect();
        let measured = Measured::new(channels, names, group_of_row, fitted);
        let covariates = features::covariates(records, &measured.group_of_row, &CONDITIONS, wear.as_deref());
        let locals = vec![Local { name: "level of the group", deviation: settings.edge_wear, estimated: true }];
        let frame = Frame { locals, covariates, ..Frame::new(measured) };
        let mut model = Self { frame, levels, actions: Vec::new() };
        model.laws(records);
        model.catalogue(records, wear.as_deref());
        model
    }

    fn laws(&mut self, records: &Records) {
        let count = self.frame.measured.channels.len();
        let mut surfaces = Vec::new();
        let mut add = |name: String, channel: usize, feature: Vec<f64>, deviation: f64, allowance: bool| {
            surfaces.push(Surface { name, channels: vec![channel], feature, deviation, allowance, absolute: false });
        };
        for channel in 0..count {
            let name = self.frame.measured.channels[channel].name;
            add(format!("{name}, level"), channel, vec![1.0; records.len()], LEVEL, false);
            for (term, feature, linear) in features::surface(records, &CONDITIONS) {
                add(format!("{name}, {term}"), channel, feature, if linear { FREE } else { CURVED }, !linear);
            }
            if name == "flank_wear"
                && let Some(feature) = features::logarithm(records, "sequence")
            {
                add(format!("{name}, ln sequence"), channel, feature, FREE, false);
            }
        }
        self.frame.surfaces = surfaces;
    }

    fn catalogue(&mut self, records: &Records, wear: Option<&[f64]>) {
        let find = |names: &[&str]| -> Vec<usize> {
            let channels = self.frame.measured.channels.iter().enumerate();
            channels.filter(|(_, channel)| names.contains(&channel.name)).map(|(i, _)| i).collect()
        };
        let forces = find(&["cutting_force", "feed_force", "passive_force", "spindle_power", "spindle_torque"]);
        let sensors = find(&["cutting_force", "feed_force", "passive_force"]);
        let lands = find(&["flank_wear"]);
        let (mut candidates, mut actions) = (Vec::new(), Vec::new());
        let mut add = |id: &'static str, shape: String, typical: f64, channels: Vec<usize>, slope: Vec<f64>| {
            if !channels.is_empty() && standardised(&slope).is_some() {
                candidates.push(Candidate { id, shape, typical, greatest: f64::INFINITY });
                actions.push((channels, slope));
            }
        };
        if let Some(wear) = wear {
            let slope: Vec<f64> = wear.iter().map(|land| if land.is_finite() { land / LAND } else { 0.0 }).collect();
            // Channels answer to wear in their own measure.
            for channel in &forces {
                let name = self.frame.measured.channels[*channel].name;
                add("wear_force", name.to_owned(), 0.2, vec![*channel], slope.clone());
            }
        }
        if let Some(elapsed) = features::elapsed(records) {
            let latest = elapsed.iter().copied().filter(|time| time.is_finite()).fold(0.0, f64::max);
            let slope = elapsed.iter().map(|time| if time.is_finite() { *time } else { 0.0 }).collect();
            add("force_drift", String::new(), 0.1 / latest, sensors, slope);
        }
        for (column, level, rows) in features::indicators(records, &["coolant_id", "lot", "material"]) {
            let (id, channels) = match column.as_str() {
                "coolant_id" => ("coolant_change", lands.clone()),
                _ if lands.is_empty() => ("lot_hardness", forces.clone()),
                _ => ("lot_hardness", lands.clone()),
            };
            add(id, format!("{column} {level}"), 0.2, channels, rows);
        }
        self.frame.candidates = candidates;
        self.actions = actions;
    }
}

impl Forward for Empirical {
    fn frame(&self) -> &Frame {
        &self.frame
    }
    fn simulate(&self, at: &Point) -> Vec<f64> {
        let value = |observation: &super::Observation| {
            let group = self.frame.measured.group_of_row[observation.row];
            let mut relative = self.frame.locals[0].deviation * at.locals[0][group];
            for ((channels, slope), size) in self.actions.iter().zip(&at.effects) {
                if channels.contains(&observation.channel) {
                    relative += (size * slope[observation.row]).max(-0.99).ln_1p();
                }
            }
            self.levels[observation.channel] * relative.exp()
        };
        self.frame.measured.observations.iter().map(value).collect()
    }
}
