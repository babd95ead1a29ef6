//! Channels of turning and milling: which the process predicts and the records hold, and how each is compared.

use super::{Action, Cutting, Nominal};
use crate::settings::Settings;
use crate::stopped::StopTimes;
use crate::{Candidate, Channel, ChannelId, EffectId, Transform};
use toolroom_process::Record;
use toolroom_records::{ColumnKind, Records, Sensor};

/// Where a channel's prediction comes from.
#[derive(Clone, Copy)]
pub(super) enum Source {
    /// Wear at the end of the operation.
    Wear,
    /// Mean of an output over the cut.
    Output(usize),
    /// Programmed time of the operation.
    Duration,
    /// No stops at all.
    Stops,
}

/// Where the prediction of a channel comes from.
pub(super) fn source<P: Nominal>(channel: ChannelId) -> Source {
    if channel == ChannelId::FlankWear {
        Source::Wear
    } else if channel == ChannelId::CycleTime {
        Source::Duration
    } else if channel == ChannelId::StopTime {
        Source::Stops
    } else {
        Source::Output(P::Output::index_of(channel.word()).unwrap_or(0))
    }
}

/// Channels that the process predicts and the records hold.
pub(super) fn channels<P: Nominal>(records: &Records, settings: &Settings) -> Vec<(Channel, Vec<f64>)> {
    let columns = records.kind.columns().iter();
    let measured = columns.filter(|column| column.kind == ColumnKind::Channel);
    let measured = measured.filter_map(|column| Some((ChannelId::from_record_column(column)?, column)));
    let known = measured.filter(|(id, column)| {
        P::Output::index_of(column.name).is_some() || matches!(id, ChannelId::CycleTime | ChannelId::FlankWear)
    });
    let with_values = known.filter_map(|(id, column)| {
        let values = records.numbers(column.name)?;
        values.iter().any(|value| value.is_finite()).then(|| (id, column, values.to_vec()))
    });
    with_values
        .map(|(id, column, values)| {
            let linear = matches!(
                id,
                ChannelId::FlankWear | ChannelId::Temperature | ChannelId::CycleTime | ChannelId::FormError
            );
            let signed = P::SIGNED.contains(&id);
            let transform = if linear || signed { Transform::Linear } else { Transform::Log };
            let mut sensor: Sensor = settings.sensor(column.name);
            if signed {
                // Relative errors vanish where the sign turns; those of the sensor do not.
                let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|v| v.is_finite()).collect();
                sensor.absolute += sensor.relative * toolroom_statistics::median(&mut sizes);
            }
            (Channel { id, display: column.display, unit: column.unit, transform, sensor }, values)
        })
        .collect()
}

/// The channel of what the shape of cycle times tells of stops.
pub(super) fn stop_channel(stops: &StopTimes) -> (Channel, Vec<f64>) {
    let sensor = Sensor { absolute: stops.deviation, relative: 0.0, resolution: 0.0 };
    let channel = Channel { id: ChannelId::StopTime, display: "s", unit: "s", transform: Transform::Linear, sensor };
    (channel, stops.times.clone())
}

impl<P: Nominal> Cutting<P> {
    /// Log likelihood by which the shape of cycle times asks for each candidate: for short stops on the rows on which they act.
    pub(super) fn shape_leads(&self, stops: &StopTimes) -> Vec<f64> {
        let lead = |(candidate, action): (&Candidate, &Action)| match action {
            Action::Reading { column, .. } if candidate.id == EffectId::MICRO_STOPS => {
                stops.lead(|row| column[row] > 0.0)
            }
            Action::Reading { .. } | Action::Effect(_) | Action::Scoped(..) | Action::Lot(..) => 0.0,
        };
        self.frame.candidates.iter().zip(&self.actions).map(lead).collect()
    }
}
