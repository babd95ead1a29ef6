//! Streams of a shop, and what is kept of them between two looks.

use crate::change::Change;
use crate::conformal::conformal_score;
use crate::detector::{Detector, RareDetector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use toolroom_shards::fingerprint;

/// Fewer blocks of a stream give no alarm (assumption: before that a rank cannot be extreme enough).
pub const FEWEST_BLOCKS: usize = 40;
/// Version of the form of the state. The first had no fingerprint.
const SCHEMA: u32 = 2;
/// How a state begins: the fingerprint of all that follows it.
const SEAL: &str = "{\"fingerprint\":\"";
/// Values of a stream that are kept; the oldest go first (assumption: ten years of days; keeps the state small).
const MOST_VALUES: usize = 4000;

/// What one stream shows in one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Any number that grows with the deviation from the model; only its rank counts.
    Value(f64),
    /// Rare events, and how many the file lets expect.
    Count {
        /// Events.
        count: u64,
        /// Expected number, 0 or more.
        expected: f64,
    },
}

/// A block: one group of rows, such as an edge or a machine and day.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Name, unique.
    pub name: String,
    /// When it was, s from the start of the records.
    pub time: f64,
    /// Rows in it.
    pub rows: usize,
    /// Readings by stream.
    pub readings: Vec<(String, Reading)>,
}

/// What is known of one stream since it began anew.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stream {
    values: Vec<f64>,
    scores: Vec<f64>,
    times: Vec<f64>,
    detector: Detector,
    rare: RareDetector,
    /// Blocks ever, which number the draws of chance.
    blocks: u64,
}

/// A change that was seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Alarm {
    /// Stream.
    pub stream: String,
    /// Time of the block that gave the alarm, s.
    pub time: f64,
    /// Statistic, in blocks.
    pub statistic: f64,
    /// Likeliest time of the change, s: that of the first block after it.
    pub change: f64,
    /// First and last time of the 90 % set, s.
    pub span: [f64; 2],
    /// Mean score after the change, standard deviations of a block; for counts their ratio to what was expected.
    pub shift: f64,
}

/// A state file that cannot be gone on with.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// It is no state, or of another form.
    #[error("this is no state of a watch: {0}")]
    Form(String),
    /// It is not what this program has written: somebody has edited it, or it was cut off or damaged.
    #[error("the state was changed after it was written: its fingerprint is that of another text")]
    Changed,
    /// It belongs to another model.
    #[error("the state was kept for the model {state}, not for {model}")]
    Model {
        /// Fingerprint in the state.
        state: String,
        /// Fingerprint of the model that is watched now.
        model: String,
    },
}

/// The watch over a shop.
///
/// # Examples
/// ```
/// use toolroom_watch::{Block, Reading, Watch};
/// let mut watch = Watch::new("model");
/// let block = |day: usize, value| Block {
///     name: format!("day {day}"), time: 86400.0 * day as f64, rows: 1,
///     readings: vec![("force".to_owned(), Reading::Value(value))],
/// };
/// let blocks: Vec<Block> = (0..90).map(|day| block(day, (day as f64).sin() + if day < 60 { 0.0 } else { 3.0 })).collect();
/// assert_eq!(watch.look(&blocks, 100.0).len(), 1);
/// assert!(watch.look(&blocks, 100.0).is_empty()); // the same rows again: nothing changes
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Watch {
    schema: u32,
    model: String,
    streams: BTreeMap<String, Stream>,
    /// Rows by block that was taken in.
    blocks: BTreeMap<String, usize>,
    /// Time of the first and last block, s.
    span: Option<[f64; 2]>,
    /// Alarms so far.
    pub alarms: Vec<Alarm>,
    /// Rows that came after their block was taken in.
    pub late_rows: usize,
}

impl Watch {
    /// A watch that has seen nothing, for the model of a fingerprint.
    pub fn new(model: impl Into<String>) -> Self {
        Self {
            schema: SCHEMA,
            model: model.into(),
            streams: BTreeMap::new(),
            blocks: BTreeMap::new(),
            span: None,
            alarms: Vec::new(),
            late_rows: 0,
        }
    }

    /// The watch of a state that was written by [`Watch::state`].
    ///
    /// # Errors
    /// [`StateError::Form`] where the text is no state, [`StateError::Changed`] where it is not as it was written,
    /// [`StateError::Model`] where it belongs to another model.
    pub fn resume(text: &str, model: &str) -> Result<Self, StateError> {
        let form = |reason: String| StateError::Form(reason);
        let sealed = text.strip_prefix(SEAL).and_then(|rest| rest.split_once("\","));
        let (seal, rest) = sealed.ok_or_else(|| form("it does not begin with a fingerprint".to_owned()))?;
        if seal != fingerprint(rest.as_bytes()) {
            return Err(StateError::Changed);
        }
        let watch: Self = serde_json::from_str(&format!("{{{rest}")).map_err(|error| form(error.to_string()))?;
        if watch.schema != SCHEMA {
            return Err(form(format!("form {}, this program knows {SCHEMA}", watch.schema)));
        }
        if watch.model != model {
            return Err(StateError::Model { state: watch.model, model: model.to_owned() });
        }
        Ok(watch)
    }

    /// The state as JSON, with a fingerprint of it: a state that was edited or cut off would give another promise of false
    /// alarms than the one printed, and nothing else would show it.
    ///
    /// # Panics
    /// Never: every number in it is finite.
    pub fn state(&self) -> String {
        let text = serde_json::to_string(self)
            .unwrap_or_else(|error| unreachable!("a state is plain numbers and texts: {error}"));
        let rest = &text[1..]; // without the brace, which comes before the fingerprint
        format!("{SEAL}{}\",{rest}", fingerprint(rest.as_bytes()))
    }

    /// Takes in the blocks that are new, in the order of their time, and returns the alarms that they give at `threshold`
    /// (blocks). A stream that gave an alarm begins anew with the blocks after the change.
    pub fn look(&mut self, blocks: &[Block], threshold: f64) -> Vec<Alarm> {
        let mut order: Vec<&Block> = Vec::with_capacity(blocks.len());
        for block in blocks {
            match self.blocks.get_mut(&block.name) {
                Some(rows) => {
                    self.late_rows += block.rows.saturating_sub(*rows);
                    *rows = (*rows).max(block.rows);
                }
                None => order.push(block),
            }
        }
        order.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.name.cmp(&b.name)));
        let mut alarms = Vec::new();
        for block in order {
            self.blocks.insert(block.name.clone(), block.rows);
            let span = self.span.unwrap_or([block.time; 2]);
            self.span = Some([span[0].min(block.time), span[1].max(block.time)]);
            for (name, reading) in &block.readings {
                let stream = self.streams.entry(name.clone()).or_default();
                let statistic = stream.add(name, block.time, *reading);
                if stream.scores.len() >= FEWEST_BLOCKS && statistic >= threshold {
                    alarms.push(stream.alarm(name, statistic));
                }
            }
        }
        self.alarms.extend(alarms.iter().cloned());
        alarms
    }

    /// The threshold, in blocks, at which `per_year` false alarms (above 0) are promised for all `streams` together, each
    /// with `blocks_per_year`.
    pub fn threshold(streams: usize, blocks_per_year: f64, per_year: f64) -> f64 {
        streams as f64 * blocks_per_year / per_year
    }

    /// Number of streams, and of those that have too few blocks for an alarm.
    pub fn streams(&self) -> (usize, usize) {
        let learning = self.streams.values().filter(|stream| stream.scores.len() < FEWEST_BLOCKS).count();
        (self.streams.len(), learning)
    }

    /// Blocks that were taken in.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Time from the first block to the last, s.
    pub fn watched(&self) -> f64 {
        self.span.map_or(0.0, |[first, last]| last - first)
    }

    /// The highest statistics with their streams, highest first.
    pub fn highest(&self) -> Vec<(&str, f64)> {
        let statistic = |stream: &Stream| stream.detector.statistic().max(stream.rare.statistic());
        let mut all: Vec<(&str, f64)> =
            self.streams.iter().map(|(name, stream)| (name.as_str(), statistic(stream))).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(b.0)));
        all
    }
}

impl Stream {
    /// Adds a reading and returns the statistic.
    fn add(&mut self, name: &str, time: f64, reading: Reading) -> f64 {
        self.blocks += 1;
        self.times.push(time);
        let statistic = match reading {
            Reading::Value(value) => {
                let value = if value.is_finite() { value } else { 0.0 };
                let score = conformal_score(&self.values, value, chance(name, self.blocks));
                self.values.push(value);
                self.scores.push(score);
                self.detector.add(score)
            }
            Reading::Count { count, expected } => {
                self.values.push(expected);
                // Freeman–Tukey residual: about standard normal, for the date of a change only.
                let n = count as f64;
                self.scores.push(n.sqrt() + (n + 1.0).sqrt() - (4.0 * expected + 1.0).sqrt());
                self.rare.add(count, expected)
            }
        };
        let old = self.values.len().saturating_sub(MOST_VALUES);
        self.values.drain(..old);
        self.scores.drain(..old);
        self.times.drain(..old);
        statistic
    }

    /// The alarm, after which the stream begins anew with the blocks after the change.
    fn alarm(&mut self, name: &str, statistic: f64) -> Alarm {
        let change = Change::of(&self.scores);
        let (best, (first, last)) = (change.best(), change.span());
        let scores = &self.scores[best..];
        let alarm = Alarm {
            stream: name.to_owned(),
            time: self.times.last().copied().unwrap_or(0.0),
            statistic,
            change: self.times[best],
            span: [self.times[first], self.times[last]],
            shift: scores.iter().sum::<f64>() / scores.len() as f64,
        };
        self.values.drain(..best);
        self.times.drain(..best);
        // Ranks among the blocks before the change mean nothing any more.
        let kept = std::mem::take(&mut self.values);
        self.scores.clear();
        for value in kept {
            self.scores.push(conformal_score(&self.values, value, 0.5));
            self.values.push(value);
        }
        (self.detector, self.rare) = (Detector::default(), RareDetector::default());
        alarm
    }
}

/// The same number for the same block of a stream, whenever it is looked at.
fn chance(name: &str, block: u64) -> f64 {
    // FNV-1a, 64 bit.
    let hash = name
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    let mut random = ChaCha8Rng::seed_from_u64(hash);
    random.set_stream(block);
    random.random::<f64>().clamp(1e-9, 1.0 - 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DAY: f64 = 86400.0;

    /// Blocks of Student-5 noise, shifted by `shift` standard deviations from a day on.
    fn blocks(count: usize, start: usize, shift: f64, seed: u64) -> Vec<Block> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || {
            (-2.0 * random.random::<f64>().max(1e-300).ln()).sqrt()
                * (std::f64::consts::TAU * random.random::<f64>()).cos()
        };
        let mut student = || {
            let square: f64 = (0..5).map(|_| normal().powi(2)).sum();
            normal() / (square / 5.0).sqrt() / (5.0_f64 / 3.0).sqrt()
        };
        let block = |day: usize, value: f64| Block {
            name: format!("L1 day {day}"),
            time: DAY * day as f64,
            rows: 20,
            readings: vec![("cutting_force L1".to_owned(), Reading::Value(value))],
        };
        (0..count).map(|day| block(day, student() + if day >= start { shift } else { 0.0 })).collect()
    }

    #[test]
    fn a_shift_of_one_deviation_is_found_within_thirty_blocks_with_its_date() {
        let threshold = 250.0;
        let (mut delays, mut dated, mut early) = (Vec::new(), 0, 0);
        for seed in 0..60 {
            let mut watch = Watch::new("m");
            let alarms = watch.look(&blocks(260, 140, 1.0, seed), threshold);
            match alarms.iter().find(|alarm| alarm.time >= 140.0 * DAY) {
                Some(alarm) => {
                    delays.push(alarm.time / DAY - 140.0);
                    dated += usize::from(alarm.span[0] <= 140.0 * DAY && 140.0 * DAY <= alarm.span[1]);
                }
                None => delays.push(f64::INFINITY),
            }
            early += usize::from(alarms.iter().any(|alarm| alarm.time < 62.5 * DAY));
        }
        delays.sort_by(f64::total_cmp);
        assert!(delays[30] <= 30.0, "{delays:?}");
        assert!(dated >= 48, "{dated} of 60");
        // Within A/4 a quarter at most.
        assert!(early <= 15, "{early}");
    }

    #[test]
    fn a_watch_goes_on_where_it_stopped_and_the_same_rows_change_nothing() {
        let all = blocks(200, 120, 2.0, 9);
        let mut whole = Watch::new("m");
        let at_once = whole.look(&all, 250.0);
        let mut first = Watch::new("m");
        let mut seen = first.look(&all[..70], 250.0);
        let mut second = Watch::resume(&first.state(), "m").expect("a state");
        seen.extend(second.look(&all[..150], 250.0));
        seen.extend(second.look(&all, 250.0));
        assert_eq!((&seen, &second), (&at_once, &whole));
        let before = second.clone();
        assert!(second.look(&all, 250.0).is_empty());
        assert_eq!(second, before);
        let late = Block { rows: 23, ..all[3].clone() };
        assert!(second.look(std::slice::from_ref(&late), 250.0).is_empty());
        assert_eq!((second.late_rows, second.streams), (3, before.streams));
    }

    #[test]
    fn a_state_of_another_model_or_form_is_refused() {
        let state = Watch::new("m").state();
        assert!(matches!(Watch::resume(&state, "other"), Err(StateError::Model { .. })));
        assert!(matches!(Watch::resume("{}", "m"), Err(StateError::Form(_))));
        let newer = Watch { schema: SCHEMA + 1, ..Watch::new("m") }.state();
        assert!(matches!(Watch::resume(&newer, "m"), Err(StateError::Form(_))));
        let unsealed = serde_json::to_string(&Watch::new("m")).expect("plain numbers");
        assert!(matches!(Watch::resume(&unsealed, "m"), Err(StateError::Form(_))));
    }

    #[test]
    fn a_state_in_which_any_byte_was_changed_or_lost_is_refused() {
        let mut watch = Watch::new("m");
        watch.look(&blocks(3, 9, 0.0, 1), 1e9);
        let state = watch.state();
        assert_eq!(Watch::resume(&state, "m").expect("as written"), watch);
        assert!(serde_json::from_str::<serde_json::Value>(&state).is_ok(), "a state is JSON");
        for at in 0..state.len() {
            let other = if &state[at..=at] == "7" { "8" } else { "7" };
            assert!(Watch::resume(&[&state[..at], other, &state[at + 1..]].concat(), "m").is_err(), "byte {at}");
            assert!(Watch::resume(&state[..at], "m").is_err(), "cut off at {at}");
        }
    }

    #[test]
    fn failures_at_three_times_their_rate_are_found_and_few_blocks_give_no_alarm() {
        let block = |day: usize| Block {
            name: format!("day {day}"),
            time: DAY * day as f64,
            rows: 1,
            readings: vec![("failures L1".to_owned(), Reading::Count { count: u64::from(day > 60), expected: 0.33 })],
        };
        let all: Vec<Block> = (0..120).map(block).collect();
        let mut watch = Watch::new("m");
        assert!(watch.look(&all[..39], 1e-3).is_empty(), "fewer than forty blocks");
        let alarms = Watch::new("m").look(&all, 1000.0);
        let alarm = alarms.iter().find(|alarm| alarm.time > 60.0 * DAY).expect("an alarm");
        assert!(alarm.time < 90.0 * DAY, "{alarm:?}");
    }

    #[test]
    fn ten_years_of_days_are_a_small_state() {
        let mut watch = Watch::new("m");
        let all: Vec<Block> = blocks(3650, 9999, 0.0, 1);
        watch.look(&all, 1e9);
        let bytes = watch.state().len();
        assert!(bytes < 400_000, "{bytes}");
    }

    proptest! {
        #[test]
        fn no_text_is_a_state_that_panics(text in ".{0,200}") {
            let _ = Watch::resume(&text, "m");
        }
    }
}
