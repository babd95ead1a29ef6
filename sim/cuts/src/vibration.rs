//! How a planned segment vibrates: the stretches in which it is unstable, as the process itself counts them.
//!
//! A process tells the time that it has spent in an unstable cut. Where that time grows within a stretch of the plan, the
//! stretch is cut again in parts until every part is either wholly stable or wholly unstable. So margin, time in chatter,
//! onset and marks on the surface all come from the same stretches, however short these are.

use super::cut_fault::{CutFault, STUCK};
use super::ports::{Ports, elements, read};
use super::workpiece::Surface;
use toolroom_process::MachineProcess;
use toolroom_runlog::runlog::PassRow;

/// Places of a stretch that are looked at.
const PLACES: usize = 8;
/// Amplitude of the vibration from which chatter grows, m: that of the surface which a tool finds
/// (assumption).
const SEED: f64 = 1e-6;
/// Length of a part, and time in chatter, below which nothing is told apart, s: what the counter of a long life resolves
/// (2⁻⁵² of 10⁶ s).
const RESOLUTION: f64 = 1e-9;

/// Vibration over one segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Least margin: negative exactly where some time is spent in an unstable cut.
    pub margin: f64,
    /// Time in an unstable cut, s.
    pub chatter_time: f64,
    /// When chatter has grown, s from the start of the segment; `None` where no unstable stretch lasts long enough.
    pub onset: Option<f64>,
    /// Its frequency, Hz.
    pub frequency: f64,
    /// Greatest amplitude, m.
    pub amplitude: f64,
    /// Greatest roughness Ra, m.
    pub roughness: f64,
}

impl Vibration {
    /// Nothing cut yet.
    pub(crate) const NONE: Self =
        Self { margin: f64::INFINITY, chatter_time: 0.0, onset: None, frequency: 0.0, amplitude: 0.0, roughness: 0.0 };

    /// Adds the segment to the row of its pass and to the part.
    pub fn note(&self, row: &mut PassRow, surface: &mut Surface) {
        row.chatter_time += self.chatter_time;
        row.stability_margin = row.stability_margin.min(self.margin);
        if row.chatter_frequency == 0.0 {
            row.chatter_frequency = self.frequency;
        }
        row.vibration_amplitude = row.vibration_amplitude.max(self.amplitude);
        row.roughness = row.roughness.max(self.roughness);
        surface.roughness = surface.roughness.max(self.roughness);
        surface.chattered |= self.onset.is_some();
    }
}

/// An instant of a cut: s from the start of the segment, state and input.
#[derive(Clone, Debug)]
pub(crate) struct Instant {
    pub time: f64,
    pub state: Vec<f64>,
    pub input: Vec<f64>,
}

/// Whoever follows a segment piece by piece.
pub(crate) struct Listener<'a> {
    process: &'a dyn MachineProcess,
    ports: &'a Ports,
    output: Vec<f64>,
    /// Logarithm of the growth of the vibration, infinite once it has grown, and until when it grew, s.
    growth: (f64, f64),
    /// What was heard so far.
    pub heard: Vibration,
}

impl<'a> Listener<'a> {
    pub fn new(process: &'a dyn MachineProcess, ports: &'a Ports) -> Self {
        let output = vec![0.0; elements(process.outputs())];
        Self { process, ports, output, growth: (0.0, f64::NEG_INFINITY), heard: Vibration::NONE }
    }

    /// Time in an unstable cut so far, s.
    fn counted(&self, instant: &Instant) -> f64 {
        read(&instant.state, self.ports.chatter_time, 0.0)
    }

    /// A piece of the segment that was cut under one command without an event, from `start` to `end`.
    pub fn follow(&mut self, start: &Instant, end: &Instant) -> Result<(), CutFault> {
        let counted = self.counted(end) - self.counted(start);
        self.heard.chatter_time += counted;
        self.divide(start, end, 0)
    }

    fn divide(&mut self, start: &Instant, end: &Instant, depth: u32) -> Result<(), CutFault> {
        let (length, unstable) = (end.time - start.time, self.counted(end) - self.counted(start));
        if unstable <= 0.0 {
            self.hear_quiet(start, end);
            return Ok(());
        }
        if unstable >= length - RESOLUTION || length <= RESOLUTION {
            self.hear_chatter(start, end);
            return Ok(());
        }
        // Where one of the ends is unstable and the cut switches once, this is where; halves where it is not so.
        let split = match depth % 2 {
            0 if self.is_unstable(end) => length - unstable,
            0 if self.is_unstable(start) => unstable,
            _ => 0.5 * length,
        };
        let middle = self.forward(start, split)?;
        self.divide(start, &middle, depth + 1)?;
        self.divide(&middle, end, depth + 1)
    }

    /// The instant `duration` seconds after `start`.
    fn forward(&self, start: &Instant, duration: f64) -> Result<Instant, CutFault> {
        let mut at = start.clone();
        let (mut left, mut stuck) = (duration, 0);
        while left > 0.0 {
            let advance = self.process.advance(&mut at.state, &mut at.input, left).map_err(CutFault::Model)?;
            if advance.event.is_none_or(|event| event.ends_cut()) {
                break;
            }
            left -= advance.elapsed;
            stuck = if advance.elapsed > 0.0 { 0 } else { stuck + 1 };
            if stuck > STUCK {
                return Err(CutFault::Stuck);
            }
        }
        at.time = start.time + duration;
        Ok(at)
    }

    fn observe(&mut self, instant: &Instant) {
        self.process.output(&instant.state, &instant.input, &mut self.output);
    }

    fn is_unstable(&mut self, instant: &Instant) -> bool {
        self.observe(instant);
        read(&self.output, self.ports.stable, 1.0) < 0.5
    }

    /// A part that the process has counted as stable throughout. In between, states are interpolated; a verdict that this
    /// spoils does not count.
    fn hear_quiet(&mut self, start: &Instant, end: &Instant) {
        // Under one command that stays only the edge changes.
        let places = if start.input == end.input { 1 } else { PLACES };
        for place in 0..=places {
            self.observe(&between(start, end, place as f64 / places as f64));
            let heard = &mut self.heard;
            heard.margin = heard.margin.min(read(&self.output, self.ports.stability_margin, 1.0).max(0.0));
            if read(&self.output, self.ports.stable, 1.0) > 0.5 {
                heard.roughness = heard.roughness.max(read(&self.output, self.ports.roughness, 0.0));
                heard.amplitude = heard.amplitude.max(read(&self.output, self.ports.vibration_amplitude, 0.0));
            }
        }
    }

    /// A part that is unstable throughout: the vibration grows at the rate of each place until it has the size of the limit
    /// cycle. A part that ends before leaves what has grown.
    fn hear_chatter(&mut self, start: &Instant, end: &Instant) {
        let (mut growth, until) = self.growth;
        if start.time - until > RESOLUTION {
            growth = 0.0;
        }
        let length = end.time - start.time;
        let mut margin = -f64::MIN_POSITIVE;
        for place in 0..PLACES {
            let share = (place as f64 + 0.5) / PLACES as f64;
            self.observe(&between(start, end, share));
            margin = margin.min(read(&self.output, self.ports.stability_margin, 1.0));
            if read(&self.output, self.ports.stable, 1.0) > 0.5 {
                continue; // an interpolated state may lie on the other side of the limit
            }
            let full = read(&self.output, self.ports.vibration_amplitude, 0.0);
            let rate = read(&self.output, self.ports.chatter_growth_rate, 0.0);
            let needed = (full / SEED).max(1.0).ln();
            let step = length / PLACES as f64;
            let heard = &mut self.heard;
            if heard.frequency == 0.0 {
                heard.frequency = read(&self.output, self.ports.dominant_frequency, 0.0);
            }
            if growth + rate * step < needed {
                growth += rate * step;
                heard.amplitude = heard.amplitude.max(SEED * growth.exp());
                continue;
            }
            if heard.onset.is_none() {
                let after = if rate > 0.0 { ((needed - growth) / rate).max(0.0) } else { 0.0 };
                heard.onset = Some(start.time + place as f64 * step + after);
            }
            growth = f64::INFINITY; // until it is quiet again
            heard.amplitude = heard.amplitude.max(full);
            heard.roughness = heard.roughness.max(read(&self.output, self.ports.roughness, 0.0));
        }
        self.heard.margin = self.heard.margin.min(margin);
        self.growth = (growth, end.time);
    }
}

/// The instant at a share of the time between two.
fn between(start: &Instant, end: &Instant, share: f64) -> Instant {
    let mix = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
    Instant {
        time: start.time + share * (end.time - start.time),
        state: mix(&start.state, &end.state),
        input: mix(&start.input, &end.input),
    }
}
