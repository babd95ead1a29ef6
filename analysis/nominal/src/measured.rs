//! What was measured, in the order that the statistics need: by group, channel and sequence.

use super::ChannelId;
use std::ops::Range;
use toolroom_records::Sensor;

/// How a channel's numbers are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// As they are.
    Linear,
    /// By their logarithm: errors are relative.
    Log,
}

/// A measured channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What is measured.
    pub id: ChannelId,
    /// Unit in which people are answered.
    pub display: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// How its numbers are compared.
    pub transform: Transform,
    /// Errors of its sensor.
    pub sensor: Sensor,
}

/// One measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Row of the records.
    pub row: usize,
    /// Index of the channel.
    pub channel: usize,
    /// Transformed value.
    pub value: f64,
    /// Standard deviation of the sensor, transformed.
    pub deviation: f64,
}

/// Everything that was measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Channels with at least one value.
    pub channels: Vec<Channel>,
    /// Values, those of a group together, in it those of a channel together, by sequence.
    pub observations: Vec<Observation>,
    /// Names of the groups: edges, dressing cycles.
    pub groups: Vec<String>,
    /// Group of each row.
    pub group_of_row: Vec<usize>,
    /// Observations of each group.
    pub spans: Vec<Range<usize>>,
    /// Runs of one channel in one group.
    pub runs: Vec<Range<usize>>,
    /// Whether a group takes part in the fit; the others are only predicted.
    pub fitted: Vec<bool>,
    /// Whether a channel counts rare events: what is far out is what one asks for, no outlier.
    pub rare: Vec<bool>,
    /// Whether nobody states how much a channel scatters beside its sensor, as loading does where the file gives it
    /// one time: its scatter is read off the records.
    pub unstated: Vec<bool>,
    /// Whether a value scatters by nothing, by observation: its deviation is what a clock may be off by, and it says nothing
    /// about the scatter of others.
    pub exact: Vec<bool>,
}

impl Measured {
    /// Gathers the values of `channels`, a list of SI numbers each, NaN where missing. Rows are
    /// in the order of their sequence within a group.
    pub fn new(
        channels: Vec<(Channel, Vec<f64>)>,
        groups: Vec<String>,
        group_of_row: Vec<usize>,
        fitted: Vec<bool>,
    ) -> Self {
        let mut observations = Vec::new();
        let (mut spans, mut runs) = (Vec::new(), Vec::new());
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); groups.len()];
        for (row, group) in group_of_row.iter().enumerate() {
            rows[*group].push(row);
        }
        for rows in &rows {
            let start = observations.len();
            for (index, (channel, values)) in channels.iter().enumerate() {
                let first = observations.len();
                observations.extend(rows.iter().filter_map(|row| observation(channel, index, *row, values[*row])));
                if observations.len() > first {
                    runs.push(first..observations.len());
                }
            }
            spans.push(start..observations.len());
        }
        let (rare, unstated) = (vec![false; channels.len()], vec![false; channels.len()]);
        let exact = vec![false; observations.len()];
        let channels = channels.into_iter().map(|(channel, _)| channel).collect();
        Self { channels, observations, groups, group_of_row, spans, runs, fitted, rare, unstated, exact }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.observations.len()
    }

    /// Whether nothing was measured.
    pub fn is_empty(&self) -> bool {
        self.observations.is_empty()
    }

    /// Runs of a group.
    pub fn runs_of(&self, group: usize) -> &[Range<usize>] {
        let begin = |at: usize| self.runs.partition_point(|run| run.start < at);
        &self.runs[begin(self.spans[group].start)..begin(self.spans[group].end)]
    }

    /// Groups that take part in the fit.
    pub fn fitted_groups(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.groups.len()).filter(|group| self.fitted[*group] && !self.spans[*group].is_empty())
    }
}

fn observation(channel: &Channel, index: usize, row: usize, value: f64) -> Option<Observation> {
    if !value.is_finite() {
        return None;
    }
    let deviation = channel.sensor.deviation(value);
    match channel.transform {
        Transform::Linear => Some(Observation { row, channel: index, value, deviation }),
        Transform::Log => {
            (value > 0.0).then(|| Observation { row, channel: index, value: value.ln(), deviation: deviation / value })
        }
    }
}
