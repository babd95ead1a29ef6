//! Frequency responses from the record of a hammer test: force and response of several hits over time.
//!
//! Every hit is cut out of the record with what comes before it. Behind the pulse the force is faded out, for it holds noise
//! alone. Where the response has not died away at the end of a frame, force and response are both multiplied by
//! `e^(−d t)`: their ratio is then the response at `i w + d` instead of `i w`, and the fit takes d out of the damping again.
//!
//! # Source
//! Force and exponential windows: D. L. Brown, R. J. Allemang, W. Fladung, "Windows for impact testing" (recalled). H1, H2 and
//! Hv: J. S. Bendat, A. G. Piersol, Random Data, 4th edition (2010), chapters 6 and 7 (recalled).

use crate::error::{DynamicsError, RecordProblem};
use crate::fft::transform;
use crate::frf::{Frf, Measurement};
use crate::noise::{SMOOTHED, unbiased};
use crate::record::{Channel, Record, Signal};
use crate::unit::Motion;
use nalgebra::Complex;
use std::f64::consts::PI;
use std::fmt;
use std::ops::Range;

/// Share of the greatest force of a record at which a pulse begins (assumption: noise of a force sensor is far below, and hits
/// of one series differ by less than ten).
const TRIGGER: f64 = 0.1;
/// Least time between two hits that are meant (s) (assumption: nobody hits faster on purpose; a rebound comes within).
const APART: f64 = 0.25;
/// Share of the distance between hits that a frame may fill (assumption: nobody hits in even steps).
const FILLED: f64 = 0.95;
/// Share of a frame before the hit (assumption), and its least number of samples.
const BEFORE: (f64, usize) = (1.0 / 64.0, 16);
/// Share of its peak at which the pulse has ended (assumption).
const PULSE_END: f64 = 0.02;
/// Share of the peak that a second pulse must not reach.
const DOUBLE: f64 = 0.05;
/// Share of its peak from which on a second pulse of every hit is no rebound (assumption: one of a hammer is weaker than the hit).
const RINGING: f64 = 0.8;
/// Hits of which the reason is told, where none can be used.
const TOLD: usize = 3;
/// Equal samples in a row at the greatest value of a channel that show that it is clipped (assumption: two happen by chance).
const CLIPPED: usize = 3;
/// Share of its first size to which the response has to die away within a frame.
const DIED_AWAY: f64 = 0.01;
/// Share of a frame over which the size of a response is taken (assumption).
const PART: usize = 16;
/// Force spectrum over its greatest value at which the hammer excites no more, 20 dB.
const EXCITED: f64 = 0.1;
/// Share of the sampling rate up to which filters against aliasing leave the signal alone: one over 2.56 (usual).
const ALIAS_FREE: f64 = 1.0 / 2.56;

/// Coherence from which on a line is clear, and how many in a row begin the range (assumption: by chance a line of noise is clear
/// once in forty with five hits).
const CLEAR: f64 = 0.5;
const CLEAR_LINES: usize = 8;

/// Least standard deviation of a response over its modulus, for what all hits have in common (assumption: a response that has died
/// away to 1 % when its frame ends and sensors leave more than this).
const SYSTEMATIC: f64 = 1e-3;

/// How a response follows from the spectra of force and response.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// Cross spectrum over that of the force: right where the response is noisy.
    #[default]
    H1,
    /// Spectrum of the response over the cross spectrum: right where the force is noisy.
    H2,
    /// Geometric mean of both.
    Hv,
}

impl Estimator {
    /// From its name: `h1`, `h2`, `hv`.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "h1" => Some(Self::H1),
            "h2" => Some(Self::H2),
            "hv" => Some(Self::Hv),
            _ => None,
        }
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::H1 => "H1",
            Self::H2 => "H2",
            Self::Hv => "Hv",
        })
    }
}

/// What the user of a hammer test decides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HammerOptions {
    /// How responses are estimated.
    pub estimator: Estimator,
    /// Highest frequency that is needed (Hz); hits that do not excite so far are left out. As far as they do, if left out.
    pub highest: Option<f64>,
}

/// Why a hit is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
enum HitFault {
    Double(f64),
    Clipped,
    NoBefore,
    NoRoom,
    Weak(f64),
}

impl fmt::Display for HitFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Double(share) => write!(f, "a second pulse of {:.0} % follows", 100.0 * share),
            Self::Clipped => f.write_str("a channel is clipped"),
            Self::NoBefore => f.write_str("the record begins too late before it"),
            Self::NoRoom => f.write_str("the record ends too early after it"),
            Self::Weak(frequency) => write!(f, "its force is 20 dB down at {frequency:.0} Hz"),
        }
    }
}

/// A hit in its frame.
struct Hit {
    /// Spectrum of the force.
    force: Vec<Complex<f64>>,
    /// Spectra of the responses.
    responses: Vec<Vec<Complex<f64>>>,
}

/// The frequency responses of a record with one force and one response or two, of any number of hits.
///
/// # Errors
/// [`DynamicsError::Record`]: a record without a force or a response, with two forces, or without any hit that can be used.
pub fn responses(record: &Record, options: &HammerOptions) -> Result<Measurement, DynamicsError> {
    let fault = |problem| DynamicsError::Record { file: record.source.clone(), problem };
    let forces: Vec<&Channel> = record.channels.iter().filter(|channel| channel.signal == Signal::Force).collect();
    let moved: Vec<(&Channel, Motion)> = record
        .channels
        .iter()
        .filter_map(
            |channel| if let Signal::Response(motion) = channel.signal { Some((channel, motion)) } else { None },
        )
        .collect();
    let ([force], false) = (&forces[..], moved.is_empty()) else {
        return Err(fault(RecordProblem::Channels { forces: forces.len(), responses: moved.len() }));
    };
    let starts = hits(&force.values, record.rate);
    let length = frame(&starts, force.values.len(), record.rate).ok_or_else(|| fault(RecordProblem::NoHits))?;
    let before = ((BEFORE.0 * length as f64) as usize).max(BEFORE.1);
    let cut = Frames { record, force, moved: &moved, length, before };
    let decay = cut.decay(&starts);
    let step = record.rate / length as f64;
    let (mut used, mut notes) = (Vec::new(), Vec::new());
    let (mut last, mut left_out, mut rings) = ((ALIAS_FREE * length as f64) as usize, 0, true);
    for start in &starts {
        let found = cut.hit(*start, decay).and_then(|hit| {
            let reach = excited(&hit.force);
            match options.highest {
                Some(highest) if (reach as f64) * step < highest => Err(HitFault::Weak(reach as f64 * step)),
                _ => Ok((hit, reach)),
            }
        });
        match found {
            Ok((hit, reach)) => {
                last = last.min(reach);
                used.push(hit);
            }
            Err(reason) => {
                left_out += 1;
                rings &= matches!(reason, HitFault::Double(share) if share >= RINGING);
                notes.push(format!("the hit at {:.3} s is left out: {reason}", *start as f64 / record.rate));
            }
        }
    }
    if used.is_empty() {
        return Err(fault(RecordProblem::NoUsableHit { hits: left_out, reasons: without_use(&notes, rings) }));
    }
    if let Some(highest) = options.highest {
        last = last.min((highest / step).ceil() as usize);
    }
    notes.insert(
        0,
        format!(
            "{} of {} hits, frames of {:.3} s, up to {:.0} Hz",
            used.len(),
            starts.len(),
            length as f64 / record.rate,
            last as f64 * step
        ),
    );
    if used.len() == 1 {
        notes.push("one hit alone has no coherence".to_owned());
    }
    if decay > 0.0 {
        notes.push(format!("an exponential window of {decay:.2} 1/s is taken out of the damping again"));
    }
    let mut first = 0;
    let mut functions: Vec<Frf> = moved
        .iter()
        .enumerate()
        .map(|(i, (channel, motion))| {
            let Estimated { receptance, coherence, noise } = estimate(&used, i, 1..last + 1, options.estimator);
            let alone = match &used[..] {
                [hit] => Some(agreement_of_neighbours(hit, i, 1..last + 1)),
                _ => None,
            };
            first = first.max(coherence.as_deref().or(alone.as_deref()).map_or(0, first_clear));
            Frf { response: channel.direction, force: force.direction, motion: *motion, receptance, coherence, noise }
        })
        .collect();
    if first > 0 {
        let reason = if used.len() > 1 { "their coherence is low" } else { "there the response is noise" };
        notes.push(format!("lines below {:.0} Hz are left out: {reason}", (first + 1) as f64 * step));
    }
    for function in &mut functions {
        function.receptance.drain(..first);
        let others = [&mut function.coherence, &mut function.noise];
        others.into_iter().flatten().for_each(|values| drop(values.drain(..first)));
    }
    Measurement {
        source: record.source.clone(),
        frequencies: (first + 1..last + 1).map(|line| line as f64 * step).collect(),
        functions,
        averages: (used.len() > 1).then_some(used.len() as u32),
        coherence_digit: f64::EPSILON,
        window_decay: decay,
        notes,
    }
    .checked()
}

/// Why no hit of a record can be used: the first reasons, and what is behind them where every "force" rings on.
fn without_use(reasons: &[String], rings: bool) -> String {
    let mut words = reasons[..reasons.len().min(TOLD)].join("; ");
    if reasons.len() > TOLD {
        words += &format!("; and {} more", reasons.len() - TOLD);
    }
    if rings {
        words += "; wait between hits until the structure is quiet, and see whether force and response are exchanged";
    }
    words
}

/// The first line from which on the coherence is clear for a while: an accelerometer hardly sees the lines below.
fn first_clear(coherence: &[f64]) -> usize {
    let clear = |row: &[f64]| row.iter().all(|value| *value >= CLEAR);
    coherence.windows(CLEAR_LINES).position(clear).unwrap_or(0)
}

/// What takes the place of coherence for one hit: how far nine neighbouring lines tell one response, since a response of modes
/// hardly changes from line to line and noise does (smoothing over frequency in place of hits; Bendat and Piersol, Random
/// Data, recalled).
fn agreement_of_neighbours(hit: &Hit, response: usize, lines: Range<usize>) -> Vec<f64> {
    let agreement = |line: usize| {
        let near = line.saturating_sub(SMOOTHED).max(lines.start)..(line + SMOOTHED + 1).min(lines.end);
        let (mut force, mut motion, mut cross) = (0.0, 0.0, Complex::from(0.0));
        for (f, x) in near.clone().map(|line| (hit.force[line], hit.responses[response][line])) {
            force += f.norm_sqr();
            motion += x.norm_sqr();
            cross += x * f.conj();
        }
        unbiased(cross.norm_sqr() / (force * motion).max(f64::MIN_POSITIVE), near.len() as f64)
    };
    lines.clone().map(agreement).collect()
}

/// Where pulses of force begin that are meant as hits.
fn hits(force: &[f64], rate: f64) -> Vec<usize> {
    let greatest = force.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let apart = (APART * rate) as usize;
    let mut starts: Vec<usize> = Vec::new();
    for (i, value) in force.iter().enumerate() {
        let begins = greatest > 0.0 && value.abs() >= TRIGGER * greatest;
        if begins && starts.last().is_none_or(|start| i - start > apart) {
            starts.push(i);
        }
    }
    starts
}

/// Samples of a frame, a power of two: what the median distance of hits leaves; none without hits.
fn frame(starts: &[usize], samples: usize, rate: f64) -> Option<usize> {
    let mut distances: Vec<usize> = starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    distances.sort_unstable();
    let room = match distances.get(distances.len() / 2) {
        Some(distance) => (FILLED * *distance as f64) as usize,
        None => samples - starts.first()?,
    };
    let least = (2 * BEFORE.1).max((APART * rate / 2.0) as usize);
    (room >= least).then(|| 1 << room.ilog2())
}

/// The last line below which the force stays within 20 dB of its greatest value.
fn excited(force: &[Complex<f64>]) -> usize {
    let greatest = force.iter().skip(1).map(|value| value.norm()).fold(0.0, f64::max);
    let end = force.iter().skip(1).position(|value| value.norm() < EXCITED * greatest);
    end.unwrap_or(force.len() - 1)
}

/// What cuts frames out of a record.
struct Frames<'a> {
    record: &'a Record,
    force: &'a Channel,
    moved: &'a [(&'a Channel, Motion)],
    /// Samples of a frame.
    length: usize,
    /// Samples of it before the hit.
    before: usize,
}

impl Frames<'_> {
    /// The samples of the frame of a hit.
    fn range(&self, start: usize) -> Result<Range<usize>, HitFault> {
        let first = start.checked_sub(self.before).ok_or(HitFault::NoBefore)?;
        let end = first + self.length;
        if end <= self.force.values.len() { Ok(first..end) } else { Err(HitFault::NoRoom) }
    }

    /// A channel over a frame, less its mean before the hit.
    fn samples(&self, channel: &Channel, range: Range<usize>) -> Vec<f64> {
        let part = &channel.values[range];
        // The last quarter before the trigger may hold the rise of the pulse.
        let rest = &part[..self.before - self.before / 4];
        let mean = rest.iter().sum::<f64>() / rest.len() as f64;
        part.iter().map(|value| value - mean).collect()
    }

    /// Greatest power of the end of a response that may be noise alone, as the record has it before its first hit: its mean
    /// there, and four standard deviations of such means of normal noise.
    fn quiet(&self, channel: &Channel, first: usize, part: usize) -> f64 {
        // The rise of the pulse may begin a quarter of the time before the trigger.
        let Some(rest) = first.checked_sub(self.before / 4).filter(|end| *end >= BEFORE.1) else { return 0.0 };
        let rest = &channel.values[..rest];
        let mean = rest.iter().sum::<f64>() / rest.len() as f64;
        let power = rest.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / rest.len() as f64;
        power * (1.0 + 4.0 * (2.0 / rest.len() as f64 + 2.0 / part as f64).sqrt())
    }

    /// The rate of decay (1/s) of the window under which every response dies away within its frame. What is no more than noise
    /// has died away: a window would only spread it over the lines.
    fn decay(&self, starts: &[usize]) -> f64 {
        let power = |part: &[f64]| part.iter().map(|value| value * value).sum::<f64>() / part.len() as f64;
        let part = (self.length / PART).max(1);
        let first = starts.first().copied().unwrap_or(0);
        let quiet: Vec<f64> = self.moved.iter().map(|(channel, _)| self.quiet(channel, first, part)).collect();
        let left = |start: &usize| {
            let range = self.range(*start).ok()?;
            let shares = self.moved.iter().zip(&quiet).map(|((channel, _), quiet)| {
                let values = self.samples(channel, range.clone());
                let end = power(&values[values.len() - part..]);
                if end <= *quiet {
                    return 0.0;
                }
                (end / power(&values[self.before..self.before + part]).max(f64::MIN_POSITIVE)).sqrt()
            });
            Some(shares.fold(0.0, f64::max))
        };
        let greatest = starts.iter().filter_map(left).fold(0.0, f64::max);
        (greatest / DIED_AWAY).max(1.0).ln() * self.record.rate / self.length as f64
    }

    fn hit(&self, start: usize, decay: f64) -> Result<Hit, HitFault> {
        let range = self.range(start)?;
        let channels = std::iter::once(self.force).chain(self.moved.iter().map(|(channel, _)| *channel));
        if channels.into_iter().any(|channel| clipped(&channel.values, range.clone())) {
            return Err(HitFault::Clipped);
        }
        let mut force = self.samples(self.force, range.clone());
        let end = pulse_end(&force, self.before)?;
        // From the end of the pulse on the force fades out over the duration of the pulse.
        let fade = (end - self.before).max(2);
        for (i, value) in force[end..].iter_mut().enumerate() {
            *value *= if i < fade { 0.5 + 0.5 * (PI * i as f64 / fade as f64).cos() } else { 0.0 };
        }
        let windowed = |mut values: Vec<f64>| {
            for (i, value) in values.iter_mut().enumerate().skip(self.before) {
                *value *= (-decay * (i - self.before) as f64 / self.record.rate).exp();
            }
            transform(&values)
        };
        let responses = self.moved.iter().map(|(channel, _)| windowed(self.samples(channel, range.clone())));
        let responses = responses.collect();
        Ok(Hit { force: windowed(force), responses })
    }
}

/// Whether the channel is clipped in a range: somewhere in the record some samples in a row stand at its greatest value, and here
/// one at least does. A short peak touches the end of the range with a single sample.
fn clipped(values: &[f64], range: Range<usize>) -> bool {
    let greatest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let flat = |row: &[f64]| row.iter().all(|value| value.abs() >= greatest && *value == row[0]);
    greatest > 0.0 && values[range].iter().any(|value| value.abs() >= greatest) && values.windows(CLIPPED).any(flat)
}

/// The sample at which the pulse has ended that begins about `trigger`; no second pulse may follow.
fn pulse_end(force: &[f64], trigger: usize) -> Result<usize, HitFault> {
    // The first pulse is over before another hit can begin: its peak is the first greatest value until the force turns.
    let sign = force[trigger].signum();
    let turned = force[trigger..].iter().position(|value| value * sign <= 0.0).map_or(force.len(), |n| trigger + n);
    let pulse = &force[trigger..turned];
    let peak = pulse.iter().map(|value| value * sign).fold(0.0, f64::max);
    let top = pulse.iter().position(|value| value * sign >= peak).map_or(trigger, |n| trigger + n);
    let end = force[top..].iter().position(|value| value * sign < PULSE_END * peak).map_or(force.len(), |n| top + n);
    let second = force[end..].iter().map(|value| value * sign).fold(0.0, f64::max);
    // A pulse that rises again before it has ended is two as well.
    let mut low = peak;
    let rises = |value: &f64| {
        low = low.min(*value * sign);
        *value * sign > low + DOUBLE * peak
    };
    let again = force[top..end].iter().copied().find(rises).unwrap_or(0.0) * sign;
    let second = second.max(again);
    if second > DOUBLE * peak { Err(HitFault::Double(second / peak)) } else { Ok(end.min(force.len() - 1)) }
}

/// A response over force as several hits tell it.
struct Estimated {
    /// Motion over force in the unit of the motion.
    receptance: Vec<Complex<f64>>,
    /// Coherence, free of the bias of few hits: they agree to 1/n by chance alone.
    coherence: Option<Vec<f64>>,
    /// Standard deviation of real and imaginary part.
    noise: Option<Vec<f64>>,
}

/// Response over force on some lines; coherence and noise where there are several hits.
fn estimate(hits: &[Hit], response: usize, lines: Range<usize>, estimator: Estimator) -> Estimated {
    let (mut receptance, mut coherence, mut noise, mut forces) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let count = hits.len() as f64;
    for line in lines {
        let (mut force, mut motion, mut cross) = (0.0, 0.0, Complex::from(0.0));
        for hit in hits {
            let (f, x) = (hit.force[line], hit.responses[response][line]);
            force += f.norm_sqr();
            motion += x.norm_sqr();
            cross += x * f.conj();
        }
        force = force.max(f64::MIN_POSITIVE);
        let shared = cross.norm_sqr() / force;
        let h1 = cross / force;
        receptance.push(match estimator {
            Estimator::H1 => h1,
            // Both others have the phase of the cross spectrum: H2 = H1 over the coherence.
            Estimator::H2 => h1 * (motion / shared.max(f64::MIN_POSITIVE)),
            Estimator::Hv => h1 * (motion / shared.max(f64::MIN_POSITIVE)).sqrt(),
        });
        let agreement = if motion > 0.0 { shared / motion } else { 0.0 };
        coherence.push(unbiased(agreement, count));
        // What the response holds beside the force has as many degrees of freedom as there are hits, less one.
        noise.push((motion - shared).max(0.0) / (count - 1.0));
        forces.push(force);
    }
    if hits.len() < 2 {
        return Estimated { receptance, coherence: None, noise: None };
    }
    let sd = (0..noise.len()).map(|i| {
        let near = &noise[i.saturating_sub(SMOOTHED)..(i + SMOOTHED + 1).min(noise.len())];
        // Half of the variance is that of the real part.
        let sd = (0.5 * near.iter().sum::<f64>() / near.len() as f64 / forces[i]).sqrt();
        sd.max(SYSTEMATIC * receptance[i].norm())
    });
    let sd: Vec<f64> = sd.collect();
    Estimated { receptance, coherence: Some(coherence), noise: Some(sd) }
}
