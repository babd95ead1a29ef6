//! What a model predicts of recorded rows.

use toolroom_gap::{ChannelId, Forward, Point, Transform, predict};

/// A measured value beside what models say of it, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Row of the records.
    pub row: usize,
    /// Channel.
    pub channel: ChannelId,
    /// SI unit.
    pub unit: &'static str,
    /// Unit for people.
    pub display: &'static str,
    /// What was measured.
    pub measured: f64,
    /// What the model predicts, without factors of groups.
    pub value: f64,
    /// Standard deviation of the reading: of its logarithm times the value, where errors are relative.
    pub standard_deviation: f64,
    /// Edge, dressing, section or day to which it belongs.
    pub group: usize,
    /// Whether the row was fitted rather than held out.
    pub used: bool,
}

/// Predictions of a model as its file states it, without a fit.
pub fn predictions(model: &dyn Forward) -> Vec<Prediction> {
    at(model, &Point::nominal(model))
}

/// Predictions of a model at a point, in the order of its observations; factors of groups do not count.
pub(crate) fn at(model: &dyn Forward, point: &Point) -> Vec<Prediction> {
    let mut point = point.clone();
    point.locals.iter_mut().flatten().for_each(|x| *x = 0.0);
    let (_, raw) = predict(model, &point);
    let measured = &model.frame().measured;
    let one = |(observation, value): (&toolroom_gap::Observation, f64)| {
        let channel = &measured.channels[observation.channel];
        let (value_measured, scale) = match channel.transform {
            Transform::Linear => (observation.value, 1.0),
            Transform::Log => (observation.value.exp(), observation.value.exp()),
        };
        Prediction {
            row: model.frame().record_of(observation.row),
            channel: channel.id,
            unit: channel.unit,
            display: channel.display,
            measured: value_measured,
            value,
            standard_deviation: observation.deviation * scale,
            group: measured.group_of_row[observation.row],
            used: measured.fitted[measured.group_of_row[observation.row]],
        }
    };
    measured.observations.iter().zip(raw).map(one).collect()
}
