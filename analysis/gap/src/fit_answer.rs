//! What the test of a calibrated model answers.

use super::ChannelId;
use super::channel_scale::ChannelScale;
use serde_json::{Value, json};

/// The answer of the test.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitness {
    /// Probability of a misfit like this where the model is right.
    pub p: f64,
    /// Level of the test.
    pub level: f64,
    /// Each statistic, least probable first.
    pub parts: Vec<Part>,
    /// What would have been seen.
    pub least_seen: Vec<LeastSeen>,
    /// How much of each channel the model leaves beside noise and scatter.
    pub structure: Vec<Structure>,
}

/// One statistic of the test.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Channel, or `catalogue`.
    pub what: &'static str,
    /// Kind of misfit; `effect` of the catalogue.
    pub test: &'static str,
    /// Covariate or effect that is followed most; may be empty.
    pub follows: String,
    /// Probability by itself.
    pub p: f64,
    /// The statistic.
    pub statistic: f64,
}

/// A deviation that would have been seen.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSeen {
    /// What deviates.
    pub what: String,
    /// The least size that is seen; infinite where calibration takes up any.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// With which probability it is seen.
    pub power: f64,
}

/// What a channel follows that noise and scatter do not, and how much it scatters.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// The channel.
    pub channel: ChannelId,
    /// Its root mean square, as it is estimated, in the unit of comparison; zero where noise alone would leave as much.
    pub rms: f64,
    /// Upper 90 % end of its root mean square, in the unit of comparison (relative, or SI).
    pub upper: f64,
    /// What is much of the channel.
    pub scale: ChannelScale,
    /// Root mean square of all that the model leaves, scatter of groups and of rows made up for, in the unit of comparison.
    pub scatter: f64,
}

impl Structure {
    /// Whether it scatters clearly more than its sensor, whatever it follows.
    pub(super) fn is_wide(&self) -> bool {
        self.scatter > WIDE * self.scale.sensor
    }
}

/// Scatter beyond which more than the sensor scatters, in standard deviations of it (1). Assumption: sheets of sensors are
/// right to a quarter.
pub(super) const WIDE: f64 = 1.25;

impl Fitness {
    /// Whether the model fits.
    pub fn passed(&self) -> bool {
        self.p > self.level
    }

    /// Several tests as one: the least probability counts as often as tests were made (Bonferroni).
    pub(super) fn together<'a>(all: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let all: Vec<&Self> = all.collect();
        let [first, others @ ..] = &all[..] else { return None };
        let mut whole = (*first).clone();
        for other in others {
            whole.p = whole.p.min(other.p);
            whole.parts.extend(other.parts.iter().cloned());
            whole.least_seen.extend(other.least_seen.iter().cloned());
            whole.structure.extend(other.structure.iter().cloned());
        }
        whole.parts.sort_by(|a, b| a.p.total_cmp(&b.p));
        whole.p = (whole.p * all.len() as f64).min(1.0);
        Some(whole)
    }

    /// The entry `fit` of the document.
    pub fn json(&self) -> Value {
        let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
        let part = |part: &Part| {
            json!({ "what": part.what, "test": part.test, "follows": part.follows, "p": part.p,
                    "statistic": finite(part.statistic) })
        };
        let seen = |seen: &LeastSeen| json!({ "what": seen.what, "value": finite(seen.value), "unit": seen.unit, "power": seen.power });
        let structure = |own: &Structure| json!({ "channel": own.channel.word(), "rms": finite(own.rms), "upper": finite(own.upper), "scatter": finite(own.scatter) });
        json!({
            "p": self.p, "level": self.level, "passed": self.passed(),
            "parts": self.parts.iter().map(part).collect::<Vec<_>>(),
            "least_seen": self.least_seen.iter().map(seen).collect::<Vec<_>>(),
            "structure": self.structure.iter().map(structure).collect::<Vec<_>>(),
        })
    }
}
