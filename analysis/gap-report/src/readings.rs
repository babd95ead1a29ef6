//! Measured values beside what the model says of them.

use toolroom_gap::{Diagnosis, Forward, NamedEffect, Point, Transform};
use toolroom_process::unit::convert;

/// Where and when a row of a model belongs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// Machine; empty where nobody wrote it down.
    pub machine: String,
    /// Time from the start of the records, s; NaN where nobody knows.
    pub time: f64,
    /// Operations for which the reading stands, times the mean of theirs over the reading: 1 where a row is an operation.
    pub operations: f64,
}

/// One measured value. Values are SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Index of the channel in [`Readings::channels`].
    pub channel: usize,
    /// Where and when.
    pub place: Place,
    /// Measured.
    pub measured: f64,
    /// The model as its file stands, then calibrated, then with the named effects one after the other.
    pub stages: Vec<f64>,
}

/// A channel of the readings.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadChannel {
    /// Column name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Unit in which people are answered.
    pub display: String,
    /// Whether errors are relative.
    pub relative: bool,
}

impl ReadChannel {
    /// An SI value in the unit in which people are answered.
    pub fn shown(&self, value: f64) -> f64 {
        convert(value, &self.unit, &self.display)
    }

    /// A difference of SI values in that unit.
    pub fn difference_shown(&self, difference: f64) -> f64 {
        self.shown(difference) - self.shown(0.0)
    }

    /// Residuals as people are answered: percent where errors are relative, else the channel's unit.
    pub fn residual_shown(&self, residual: f64) -> f64 {
        if self.relative { 100.0 * residual } else { self.difference_shown(residual) }
    }

    /// Unit of [`Self::residual_shown`]; empty for a number.
    pub fn residual_unit(&self) -> &str {
        if self.relative { "%" } else { self.label() }
    }

    /// Unit of [`Self::shown`] on an axis; empty for a number.
    pub fn label(&self) -> &str {
        if self.display == "1" { "" } else { &self.display }
    }
}

/// All readings of a process.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// Channels.
    pub channels: Vec<ReadChannel>,
    /// Names of the stages after the file's own: `calibration`, then effects.
    pub stages: Vec<String>,
    /// Readings.
    pub list: Vec<Reading>,
    /// Time that the records span, s, where a row is no operation; else the rows say it.
    pub span: Option<f64>,
}

impl Reading {
    /// Measured less predicted at a stage, relative where the channel is compared so.
    pub fn residual(&self, stage: usize, relative: bool) -> f64 {
        let predicted = self.stages[stage];
        if relative { (self.measured / predicted).ln() } else { self.measured - predicted }
    }
}

impl Readings {
    /// Adds the readings of one model. `place` says where a row belongs. Calibration and effects are those of the
    /// diagnosis, without form allowance and without what differs from group to group.
    pub fn add(&mut self, part: &dyn Forward, diagnosis: &Diagnosis, place: &dyn Fn(usize, &str) -> Place) {
        let frame = part.frame();
        let mut effects: Vec<(usize, f64, String)> = Vec::new();
        for effect in &diagnosis.effects {
            let is_effect =
                |candidate: &toolroom_gap::Candidate| candidate.id == effect.id && candidate.shape == effect.shape;
            if let Some(index) = frame.candidates.iter().position(is_effect) {
                effects.push((index, effect.size / effect.id.report_units().0, label(effect, &diagnosis.effects)));
            }
        }
        let mut point = Point::nominal(part);
        let mut stages = vec![part.simulate(&point)];
        let moved = |name: &str| {
            diagnosis.calibration.iter().find(|own| own.parameter == name).map_or(0.0, |own| own.prior_sd_moved)
        };
        let fitted = |allowance: bool, name: &str| if allowance { 0.0 } else { moved(name) };
        for (value, parameter) in point.parameters.iter_mut().zip(&frame.parameters) {
            *value = fitted(parameter.role.is_allowance(), &parameter.name);
        }
        for (value, surface) in point.surfaces.iter_mut().zip(&frame.surfaces) {
            *value = fitted(surface.role.is_allowance(), &surface.name);
        }
        stages.push(with_surfaces(part, &point));
        let names = std::iter::once("calibration".to_owned()).chain(effects.iter().map(|own| own.2.clone())).collect();
        for (index, size, _) in effects {
            point.effects[index] = size;
            stages.push(with_surfaces(part, &point));
        }
        // Parts of an empirical model name different effects: the longest list counts.
        if self.stages.len() < stages.len() - 1 {
            self.stages = names;
        }
        let first = self.channels.len();
        self.channels.extend(frame.measured.channels.iter().map(|channel| ReadChannel {
            name: channel.id.to_string(),
            unit: channel.unit.to_owned(),
            display: channel.display.to_owned(),
            relative: channel.transform == Transform::Log,
        }));
        for (i, observation) in frame.measured.observations.iter().enumerate() {
            let relative = self.channels[first + observation.channel].relative;
            let mut values: Vec<f64> = stages.iter().map(|stage| stage[i]).collect();
            values.resize(self.stages.len() + 1, values[values.len() - 1]);
            let mut place = place(observation.row, &self.channels[first + observation.channel].name);
            place.operations *= frame.stands_for.get(i).copied().unwrap_or(1.0);
            self.list.push(Reading {
                channel: first + observation.channel,
                place,
                measured: if relative { observation.value.exp() } else { observation.value },
                stages: values,
            });
        }
    }

    /// Readings of a channel whose first and last residual are numbers.
    pub fn of(&self, channel: usize) -> impl Iterator<Item = &Reading> {
        let relative = self.channels[channel].relative;
        self.list.iter().filter(move |reading| {
            let last = reading.stages.len() - 1;
            reading.channel == channel
                && reading.residual(0, relative).is_finite()
                && reading.residual(last, relative).is_finite()
        })
    }

    /// Mean and root mean square of the residuals of a channel at a stage (relative, or SI).
    pub fn residuals(&self, channel: usize, stage: usize) -> [f64; 2] {
        let relative = self.channels[channel].relative;
        let all: Vec<f64> = self.of(channel).map(|reading| reading.residual(stage, relative)).collect();
        let count = all.len() as f64;
        [all.iter().sum::<f64>() / count, (all.iter().map(|r| r * r).sum::<f64>() / count).sqrt()]
    }
}

/// Raw values with the corrections that need no simulation.
fn with_surfaces(part: &dyn Forward, point: &Point) -> Vec<f64> {
    let frame = part.frame();
    let mut raw = part.simulate(point);
    for (surface, moved) in frame.surfaces.iter().zip(&point.surfaces).filter(|(_, moved)| **moved != 0.0) {
        for (value, observation) in raw.iter_mut().zip(&frame.measured.observations) {
            if !surface.channels.contains(&observation.channel) {
                continue;
            }
            let moved = surface.deviation * moved * surface.feature[observation.row];
            let log = frame.measured.channels[observation.channel].transform == Transform::Log;
            match (log, surface.absolute) {
                (true, false) => *value *= moved.exp(),
                (false, false) => *value += *value * moved,
                (_, true) => *value += moved,
            }
        }
    }
    raw
}

/// The id of an effect, with its scope or shape where `all` have that id more than once.
pub(crate) fn label(effect: &NamedEffect, all: &[NamedEffect]) -> String {
    let alike = all.iter().filter(|other| other.id == effect.id).count();
    if alike > 1 { format!("{} ({})", effect.id, effect.shape) } else { effect.id.to_string() }
}
