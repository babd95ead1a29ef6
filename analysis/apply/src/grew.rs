//! Channels from which a model is farther with what a diagnosis has found than it was before.
//!
//! Predictions have no factors of groups, so that a model may be nearer to the truth and farther from its records: an edge
//! that wears a little more slowly than the median stays in use for longer, and the median edge of the model would have
//! run away by then. Whoever goes on with the model has to know of which channels that is so.

use crate::applied::Applied;
use crate::predict::Prediction;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use toolroom_gap::ChannelId;
use toolroom_process::unit;

/// Growth of the mean square over its standard error between groups that counts as certain (1). Source: the gate of the
/// key figures of a shop, two standard errors.
const CERTAIN: f64 = 2.0;
/// Growth of the root mean square that matters (1). Assumption: a twentieth changes no plan.
const MATTERS: f64 = 1.05;
/// Fewest groups that show how it scatters (count). Derivation: two say next to nothing of a standard error.
const FEWEST: usize = 3;

/// A channel from which the applied model is farther than the model that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Grew {
    /// The channel.
    pub channel: ChannelId,
    /// Unit for people of the two root mean squares.
    pub unit: &'static str,
    /// Root mean square of measured less predicted values, of the model that was read.
    pub before: f64,
    /// The same of the applied model.
    pub after: f64,
}

impl Grew {
    /// What to say of it.
    pub fn words(&self) -> String {
        let Self { channel, unit, before, after } = self;
        let unit = if *unit == "1" { String::new() } else { format!(" {unit}") };
        // Three significant digits.
        let digits = |value: &f64| format!("{value:.2e}").parse().unwrap_or(*value).to_string();
        format!(
            "with what was found the model is farther from {channel} than before: root mean square {}{unit} instead of \
             {}{unit}; look at that channel before you go on with the model",
            digits(after),
            digits(before)
        )
    }

    /// The entry of `applied.grew`.
    pub fn json(&self, process: &str) -> Value {
        json!({ "process": process, "channel": self.channel.word(), "unit": self.unit, "rms_before": self.before,
                "rms_after": self.after, "words": self.words() })
    }
}

/// The channels of all parts that are predicted worse for certain, by as much as matters. Rows beyond the reach of either
/// model, where a value is no number, do not count.
pub fn grew(parts: &[Applied]) -> Vec<Grew> {
    parts.iter().flat_map(of_part).collect()
}

/// Squared residuals of one group: before and after in standard deviations, before and after in the unit, readings.
type Squares = [f64; 5];

fn of_part(part: &Applied) -> Vec<Grew> {
    let [nominal, _, applied] = &part.predictions;
    let mut channels: BTreeMap<ChannelId, (&'static str, BTreeMap<usize, Squares>)> = BTreeMap::new();
    for (before, after) in nominal.iter().zip(applied) {
        let shown = |own: &Prediction, value: f64| unit::convert(value, own.unit, own.display);
        let off = [before, after].map(|own| shown(own, own.measured) - shown(own, own.value));
        let standard = [before, after].map(|own| (own.measured - own.value) / own.standard_deviation);
        if standard.iter().any(|value| !value.is_finite()) {
            continue;
        }
        let group = channels.entry(after.channel).or_insert_with(|| (after.display, BTreeMap::new()));
        let squares = group.1.entry(after.group).or_default();
        let own = [standard[0].powi(2), standard[1].powi(2), off[0].powi(2), off[1].powi(2), 1.0];
        squares.iter_mut().zip(own).for_each(|(sum, value)| *sum += value);
    }
    let of_channel = |(channel, (unit, groups)): (ChannelId, (&'static str, BTreeMap<usize, Squares>))| {
        let count = groups.len() as f64;
        let growth: Vec<f64> = groups.values().map(|own| own[1] - own[0]).collect();
        let mean = growth.iter().sum::<f64>() / count;
        let variance = growth.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        let sum = |at: usize| groups.values().map(|own| own[at]).sum::<f64>();
        let [before, after] = [2, 3].map(|at| (sum(at) / sum(4)).sqrt());
        let certain = groups.len() >= FEWEST && mean > CERTAIN * (variance / count).sqrt();
        (certain && after > MATTERS * before).then_some(Grew { channel, unit, before, after })
    };
    channels.into_iter().filter_map(of_channel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings of six edges, four each, that the model before misses by `previous` and the model after by `after`, mm.
    fn part(previous: f64, after: f64) -> Applied {
        let prediction = |i: usize, off: f64| Prediction {
            row: i,
            channel: ChannelId::FlankWear,
            unit: "m",
            display: "mm",
            measured: 0.2e-3,
            value: 0.2e-3 + 1e-3 * off * (1.0 + 0.1 * (i % 3) as f64),
            standard_deviation: 0.01e-3,
            group: i / 4,
            used: true,
        };
        let all = |off: f64| (0..24).map(|i| prediction(i, off)).collect::<Vec<_>>();
        Applied {
            calibration: Vec::new(),
            effects: Vec::new(),
            names: Vec::new(),
            covariance: nalgebra::DMatrix::zeros(0, 0),
            predictions: [all(previous), all(previous), all(after)],
            left: Vec::new(),
        }
    }

    #[test]
    fn a_channel_that_is_missed_by_more_than_before_is_said_in_its_unit() {
        assert!(grew(&[part(0.04, 0.01)]).is_empty());
        assert!(grew(&[part(0.04, 0.0401)]).is_empty(), "a quarter of a per cent does not matter");
        let found = grew(&[part(0.04, 0.13)]);
        assert_eq!(found.iter().map(|own| (own.channel, own.unit)).collect::<Vec<_>>(), [(ChannelId::FlankWear, "mm")]);
        assert!((found[0].after / found[0].before - 3.25).abs() < 1e-9, "{found:?}");
        assert!(found[0].words().contains("0.143 mm instead of 0.0441 mm"), "{}", found[0].words());
    }
}
