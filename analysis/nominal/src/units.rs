//! Channels and conditions in a wrong unit.

use super::constants::{HANDLING, IMPOSSIBLE, NEAR};
use super::{Channel, ChannelId, Forward, Point, Transform};
use toolroom_statistics::median;

/// Factors that slips of units leave, what they are, and the SI unit of the channels in which they happen; any, where none
/// is named.
const SLIPS: [(f64, &str, Option<&str>); 8] = [
    (25.4, "inch for mm", Some("m")),
    (1000.0, "a prefix", None),
    (60.0, "minutes for seconds", Some("s")),
    (9.81, "kgf for N", Some("N")),
    (4.448, "lbf for N", Some("N")),
    (0.3048 * 1000.0, "feet for mm", Some("m")),
    (3.281, "feet for m", Some("m")),
    (10.0, "a decimal point", None),
];

/// Ratio of measurement to the nominal model by channel, median.
pub fn ratios(model: &dyn Forward) -> Vec<f64> {
    let measured = &model.frame().measured;
    let (_, raw) = super::predict(model, &Point::nominal(model));
    let ratio = |channel: usize| {
        let values = measured.observations.iter().zip(&raw).filter(|(observation, _)| observation.channel == channel);
        let mut ratios: Vec<f64> = values
            .map(|(observation, raw)| match measured.channels[channel].transform {
                Transform::Log => observation.value.exp() / raw,
                Transform::Linear => observation.value / raw,
            })
            .filter(|ratio| ratio.is_finite())
            .collect();
        median(&mut ratios)
    };
    (0..measured.channels.len()).map(ratio).collect()
}

/// What to say about a channel whose ratio is impossible; `None` where it is possible.
fn suspicion(channel: &Channel, ratio: f64) -> Option<String> {
    let id = channel.id;
    // Handling may take several times as long as cutting.
    let impossible = if id == ChannelId::CycleTime { IMPOSSIBLE * HANDLING } else { IMPOSSIBLE };
    if ratio.is_nan() || ratio <= 0.0 || ratio.ln().abs() < impossible.ln() {
        return None;
    }
    let likely = slip(channel.unit, ratio).map_or_else(String::new, |(factor, what)| {
        let sign = if ratio > 1.0 { "×" } else { "÷" };
        format!("; is it {what} ({sign}{factor})?")
    });
    Some(format!("{id} is {ratio:.3} times the nominal model: left out, check its unit{likely}"))
}

/// The slip of units that leaves `ratio` in a channel of the SI unit `unit`, with its factor.
fn slip(unit: &str, ratio: f64) -> Option<(f64, &'static str)> {
    let found = |(factor, _, of): &&(f64, &str, Option<&str>)| {
        of.is_none_or(|own| own == unit) && (ratio.ln().abs() - factor.ln()).abs() < NEAR
    };
    SLIPS.iter().find(found).map(|(factor, what, _)| (*factor, *what))
}

/// Greatest change of a channel, median of the logarithm, that one effect of ordinary size makes.
fn reach(model: &dyn Forward, channel: usize) -> f64 {
    let frame = model.frame();
    let nominal = super::predict(model, &Point::nominal(model)).1;
    let by = |(index, candidate): (usize, &super::Candidate)| {
        let mut point = Point::nominal(model);
        point.effects[index] = candidate.typical;
        let raw = super::predict(model, &point).1;
        let of_channel = (0..raw.len()).filter(|i| frame.measured.observations[*i].channel == channel);
        let mut changes: Vec<f64> =
            of_channel.map(|i| (raw[i] / nominal[i]).ln().abs()).filter(|change| change.is_finite()).collect();
        median(&mut changes)
    };
    frame.candidates.iter().enumerate().map(by).filter(|change| change.is_finite()).fold(0.0, f64::max)
}

/// Channels whose ratio is impossible, with what to say about them. An effect that changes a
/// channel by so much saves it.
pub fn suspicious(model: &dyn Forward) -> Vec<(ChannelId, String)> {
    let channels = model.frame().measured.channels.iter().zip(ratios(model)).enumerate();
    let mut list: Vec<(ChannelId, f64, String)> = channels
        .filter_map(|(index, (channel, ratio))| {
            let note = suspicion(channel, ratio)?;
            let possible =
                slip(channel.unit, ratio).is_none() && ratio.ln().abs() < IMPOSSIBLE.ln() + reach(model, index);
            (!possible).then_some((channel.id, ratio, note))
        })
        .collect();
    let common = |ratio: f64| list.iter().filter(|(_, other, _)| (other / ratio).ln().abs() < NEAR).count() > 1;
    let common: Vec<bool> = list.iter().map(|(_, ratio, _)| common(*ratio)).collect();
    for ((_, _, note), common) in list.iter_mut().zip(common) {
        if common {
            note.push_str("; other channels are off alike: a condition may be in a wrong unit");
        }
    }
    list.into_iter().map(|(channel, _, note)| (channel, note)).collect()
}
