//! Generic signatures: every channel against every covariate.

use super::{ChannelId, Forward, Linear, Transform};

/// Channels that a load on the edge moves together.
const LOADS: [ChannelId; 5] = [
    ChannelId::CuttingForce,
    ChannelId::FeedForce,
    ChannelId::SpindlePower,
    ChannelId::NormalForce,
    ChannelId::TangentialForce,
];

/// One generic signature: a relative deviation of some channels that follows a covariate.
#[derive(Clone, Debug)]
pub struct Signature {
    /// Channels, as written in the localisation map.
    pub channel: String,
    /// Covariate, as written in the localisation map.
    pub covariate: String,
    /// Relative deviation of every observation.
    pub column: Vec<f64>,
}

/// The dictionary at a linearised model. Wear is asked in two ways: its reading, and its rate,
/// whose deviations add up over the life of an edge. Models that know no rate, those of the logarithm
/// of the land, are asked for the reading only.
pub fn dictionary(model: &dyn Forward, linear: &Linear) -> Vec<Signature> {
    let measured = &model.frame().measured;
    let mut sets: Vec<(String, Vec<usize>)> =
        measured.channels.iter().enumerate().map(|(i, channel)| (channel.id.to_string(), vec![i])).collect();
    let forces: Vec<usize> =
        (0..measured.channels.len()).filter(|i| LOADS.contains(&measured.channels[*i].id)).collect();
    if forces.len() > 1 {
        sets.push((forces.iter().map(|i| measured.channels[*i].id.word()).collect::<Vec<_>>().join(" + "), forces));
    }
    let mut signatures = Vec::new();
    for (name, channels) in &sets {
        for covariate in &model.frame().covariates {
            let column = relative(model, linear, |i, row| {
                if channels.contains(&measured.observations[i].channel) { covariate.values[row] } else { 0.0 }
            });
            signatures.push(Signature { channel: name.clone(), covariate: covariate.name.clone(), column });
        }
    }
    let rated = |channel: &super::Channel| channel.id == ChannelId::FlankWear && channel.transform == Transform::Linear;
    if let Some(wear) = measured.channels.iter().position(rated) {
        // What every operation costs, however long it is.
        let mut column = vec![0.0; measured.len()];
        for run in measured.runs.iter().filter(|run| measured.observations[run.start].channel == wear) {
            let last = linear.raw[run.end - 1] / run.len() as f64;
            run.clone().enumerate().for_each(|(place, i)| column[i] = last * (place + 1) as f64);
        }
        signatures.push(Signature { channel: "wear rate".to_owned(), covariate: "each operation".to_owned(), column });
        for covariate in &model.frame().covariates {
            let mut column = vec![0.0; measured.len()];
            for run in measured.runs.iter().filter(|run| measured.observations[run.start].channel == wear) {
                let (mut sum, mut before) = (0.0, 0.0);
                for i in run.clone() {
                    sum += (linear.raw[i] - before) * covariate.values[measured.observations[i].row];
                    before = linear.raw[i];
                    column[i] = sum;
                }
            }
            signatures.push(Signature { channel: "wear rate".to_owned(), covariate: covariate.name.clone(), column });
        }
    }
    signatures
}

fn relative(model: &dyn Forward, linear: &Linear, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let measured = &model.frame().measured;
    let relative_of = |(i, observation): (usize, &super::Observation)| {
        let relative = value(i, observation.row);
        match measured.channels[observation.channel].transform {
            Transform::Log => relative,
            Transform::Linear => relative * linear.raw[i],
        }
    };
    measured.observations.iter().enumerate().map(relative_of).collect()
}
