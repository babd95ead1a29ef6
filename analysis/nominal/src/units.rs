//! Channels and conditions in a wrong unit.

use super::constants::{HANDLING, IMPOSSIBLE, NEAR};
use super::{ChannelId, Forward, Point, Transform};
use toolroom_statistics::median;

/// Factors that slips of units leave, and what they are.
const SLIPS: [(f64, &str); 8] = [
    (25.4, "inch for mm"),
    (1000.0, "a prefix"),
    (60.0, "minutes for seconds"),
    (9.81, "kgf for N"),
    (4.448, "lbf for N"),
    (0.3048 * 1000.0, "feet for mm"),
    (3.281, "feet for m"),
    (10.0, "a decimal point"),
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
pub fn suspicion(channel: ChannelId, ratio: f64) -> Option<String> {
    // Handling may take several times as long as cutting.
    let impossible = if channel == ChannelId::CycleTime { IMPOSSIBLE * HANDLING } else { IMPOSSIBLE };
    if ratio.is_nan() || ratio <= 0.0 || ratio.ln().abs() < impossible.ln() {
        return None;
    }
    let slip = SLIPS
        .iter()
        .find(|(factor, _)| (ratio.ln() - factor.ln()).abs() < NEAR || (ratio.ln() + factor.ln()).abs() < NEAR);
    let likely = slip.map_or_else(String::new, |(factor, what)| {
        let sign = if ratio > 1.0 { "×" } else { "÷" };
        format!("; is it {what} ({sign}{factor})?")
    });
    Some(format!("{channel} is {ratio:.3} times the nominal model: left out, check its unit{likely}"))
}

/// Whether a channel's ratio is a slip of units.
fn slips(ratio: f64) -> bool {
    SLIPS.iter().any(|(factor, _)| (ratio.ln().abs() - factor.ln()).abs() < NEAR)
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
            let note = suspicion(channel.id, ratio)?;
            let possible = !slips(ratio) && ratio.ln().abs() < IMPOSSIBLE.ln() + reach(model, index);
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
