//! Chatter in the sound of a milling cut.
//!
//! The spectrum of a cut without chatter holds the harmonics of the tooth frequency and, by runout and unbalance, those of the
//! spindle frequency. Chatter adds lines at `|fc + m ft|` between them, with the chatter frequency fc and the tooth frequency
//! ft. Period-doubling chatter of a cutter with an even number of teeth has its lines at odd multiples of ft/2, which are
//! harmonics of the spindle frequency too: such a record alone does not tell it from runout.
//!
//! # Source
//! Lines of milling chatter: T. Insperger, G. Stépán, P. V. Bayly, B. P. Mann, "Multiple chatter frequencies in milling
//! processes", Journal of Sound and Vibration 262 (2003) 333 (recalled). Best speeds: S. Smith, J. Tlusty, "Stabilizing chatter
//! by automatic spindle speed regulation", CIRP Annals 41 (1992) 433 (recalled).

use crate::comb::{BAND, Comb, WITHIN, WholeSpectrum};
use crate::error::{DynamicsError, RecordProblem};
use crate::folded::{self, Place};
use crate::frames::{Frames, level};
use crate::line::{Line, Origin};
use crate::record::Record;
use std::f64::consts::TAU;

/// Revolutions in a frame, so that lines of the spindle lie sixteen bins apart.
const FRAME: f64 = 16.0;
/// Least duration of a frame (s) (assumption: a resolution of a few hertz).
const LEAST_FRAME: f64 = 0.2;
/// Bins on each side that a line fills: half of the main lobe of Hann's window.
const LOBE: f64 = 2.0;
/// Bins on each side of a line within which frames may show another as a part of it: the lobes of both.
const MERGED: f64 = 2.0 * LOBE;
/// Wander of the speed within a record that broadens the lines of the spindle, relative (assumption).
const WANDER: f64 = 1e-3;
/// Level above the floor of a line (dB).
const STANDS_OUT: f64 = 10.0;
/// Level of chatter under the strongest line of the teeth beyond which it does not matter, 5 % of its amplitude (assumption).
const MATTERS: f64 = 0.05;
/// Amplitude at odd multiples of half the tooth frequency, over the strongest line of the teeth, from which runout does not
/// explain it for sure (assumption).
const HALF_TOOTH: f64 = 0.5;
/// The same over the strongest other line of the spindle (assumption).
const ABOVE_RUNOUT: f64 = 2.0;
/// Amplitude in the cut over that in the air up to which a line belongs to the machine (assumption).
const OF_MACHINE: f64 = 3.0;
/// Frequencies of mains (Hz), and how many of their harmonics are left out (assumption).
const MAINS: ([f64; 2], u32) = ([50.0, 60.0], 10);
/// Deviation of mains (Hz) in normal operation (Commission Regulation (EU) 2017/1485, recalled).
const MAINS_DEVIATION: f64 = 0.05;
/// Share of a bin to which the vertex of a line is known (assumption).
const VERTEX: f64 = 0.05;
/// Lowest frequency that is looked at (Hz).
const LOWEST: f64 = 20.0;
/// Amplitude of a line beside a harmonic of the spindle, over the most that a wandering speed makes of such a harmonic there, from
/// which the line is one of its own (assumption).
const BEYOND_WANDER: f64 = 4.0;
/// Share of clipped samples from which a note says so (assumption: fewer are single clicks).
const CLIPPED: f64 = 1e-3;
/// Share of the greatest amplitude at which chatter has set in (assumption).
const SET_IN: f64 = 0.5;
/// Amplitude over the floor from which the growth of a line is not that of noise (assumption: 20 dB).
const SURE_GROWTH: f64 = 10.0;
/// Harmonics of the teeth that a record must hold (assumption: of fewer any line would make a comb).
const LEAST_TEETH: u32 = 3;
/// Frequency (Hz) up to which tools, holders and spindles chatter, where nothing says it of this one (assumption).
const USUAL: f64 = 4000.0;
/// Frequency (Hz) up to which chatter that stands folded may come from (assumption: that of small slender cutters lies below).
const FARTHEST: f64 = 6000.0;
/// Share of the strongest chatter line from which another may be the one near a mode (assumption).
const STRONG: f64 = 0.5;

/// What is known of a recorded cut.
#[derive(Clone, Debug)]
pub struct Cutting<'a> {
    /// Teeth of the cutter.
    pub teeth: u32,
    /// Spindle speed as it was commanded (rad/s); the true one is looked for within 3 %.
    pub spindle_speed: f64,
    /// A record of the machine at the same speed without cutting.
    pub air: Option<&'a Record>,
    /// Natural frequencies of the structure (Hz), where they are known.
    pub natural_frequencies: &'a [f64],
}

/// Whether a cut chatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chatter {
    /// Lines stand out that neither spindle nor teeth explain.
    Yes,
    /// None does.
    No,
    /// Lines at odd multiples of half the tooth frequency, which runout of an even number of teeth makes as well.
    Ambiguous,
}

/// What a record tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Heard {
    /// Spindle speed by the comb of its harmonics (rad/s).
    pub spindle_speed: f64,
    /// Whether the cut chatters.
    pub chatter: Chatter,
    /// Frequency of the chatter, or of the line that may be one (Hz); `None` also where the record leaves more than one.
    pub chatter_frequency: Option<f64>,
    /// The frequencies (Hz) of which one is that of the chatter, where the record is folded and nothing decides between them.
    pub possible_frequencies: Vec<f64>,
    /// When it has grown to half of its greatest amplitude (s from the start of the record).
    pub onset: Option<f64>,
    /// All lines, by frequency.
    pub lines: Vec<Line>,
    /// What to be careful about, in words.
    pub notes: Vec<String>,
}

impl Heard {
    /// Spindle speeds (rad/s) from `least` to `most` at which the tooth frequency is a whole fraction of the chatter frequency,
    /// `60 fc/(N j)`, from the greatest down; none without chatter.
    pub fn suggested_speeds(&self, teeth: u32, least: f64, most: f64) -> Vec<f64> {
        let Some(frequency) = self.chatter_frequency.filter(|_| self.chatter == Chatter::Yes) else {
            return Vec::new();
        };
        let speed = |j: u32| TAU * frequency / (f64::from(teeth) * f64::from(j));
        (1..).map(speed).take_while(|speed| *speed >= least.max(1e-3)).filter(|speed| *speed <= most).collect()
    }
}

/// Listens to the first channel of a record that is not constant.
///
/// # Errors
/// [`DynamicsError::Record`]: a record shorter than sixteen revolutions, without a comb of harmonics within 3 % of the speed, of
/// constant channels, or of a cut at another speed.
pub fn listen(record: &Record, cutting: &Cutting<'_>) -> Result<Heard, DynamicsError> {
    let fault = |problem| DynamicsError::Record { file: record.source.clone(), problem };
    let (samples, mut notes) = heard_channel(record).ok_or_else(|| {
        let channels = record.channels.len();
        fault(RecordProblem::Constant { channels })
    })?;
    let commanded = cutting.spindle_speed / TAU;
    let length = (FRAME / commanded).max(LEAST_FRAME);
    if record.duration() < length {
        return Err(fault(RecordProblem::Brief { duration: record.duration(), least: length }));
    }
    let highest = 0.5 * BAND * record.rate;
    let needed = f64::from(LEAST_TEETH * cutting.teeth) * commanded * (1.0 + WITHIN);
    if needed > highest {
        let least = 2.0 * needed / BAND;
        return Err(fault(RecordProblem::Slow { rate: record.rate, harmonics: LEAST_TEETH, least }));
    }
    let of_file = cutting.natural_frequencies.iter().copied().reduce(f64::max);
    if highest < of_file.unwrap_or(USUAL) {
        let known =
            of_file.map_or_else(String::new, |mode| format!(", and a mode of the lobes file is at {mode:.0} Hz"));
        notes.push(format!(
            "{:.0} samples a second tell of chatter up to {highest:.0} Hz{known}: what lies beyond is not heard, and without a filter in \
             the recorder it stands folded below; record with a higher rate",
            record.rate
        ));
    }
    let whole = WholeSpectrum::new(samples, record.rate);
    let comb = Comb::find(&whole, commanded, cutting.teeth)
        .ok_or_else(|| fault(RecordProblem::NoComb { speed: 60.0 * commanded }))?;
    let frames = Frames::new(samples, record.rate, length);
    let air = cutting.air.map(|air| {
        let (samples, _) = heard_channel(air).unwrap_or((&air.channels[0].values, Vec::new()));
        Frames::new(samples, air.rate, length)
    });
    let threshold = frames.false_alarm_level().max(STANDS_OUT);
    let mut lines: Vec<Line> = frames
        .peaks(LOWEST, threshold)
        .into_iter()
        .map(|(frequency, amplitude, floor)| {
            let origin = origin(frequency, amplitude, &comb, &frames, air.as_ref());
            Line { frequency, amplitude, level: level(amplitude / floor), origin }
        })
        .collect();
    apart(&mut lines, &whole, &comb, &frames, air.as_ref());
    not_mains(&mut lines, &whole, &comb, &frames, air.as_ref());
    let folded_teeth = folded::teeth(&mut lines, &whole, &comb, record.rate);
    if folded_teeth {
        notes.push(format!(
            "harmonics of the teeth from beyond {:.0} Hz stand folded in the record: the recorder has no filter against aliasing",
            0.5 * record.rate
        ));
    }
    let strongest = |wanted: &dyn Fn(&Origin) -> bool| {
        let of_kind = lines.iter().filter(|line| wanted(&line.origin));
        of_kind.copied().max_by(|a, b| a.amplitude.total_cmp(&b.amplitude))
    };
    let tooth = strongest(&|origin| matches!(origin, Origin::Tooth(_))).map_or(0.0, |line| line.amplitude);
    let unexplained = strongest(&|origin| *origin == Origin::Unknown).filter(|line| line.amplitude > MATTERS * tooth);
    let even = cutting.teeth.is_multiple_of(2);
    let half = |k: u32| even && k % cutting.teeth == cutting.teeth / 2;
    let doubled = strongest(&|origin| matches!(origin, Origin::Spindle(k) if half(*k)));
    let runout =
        strongest(&|origin| matches!(origin, Origin::Spindle(k) if !half(*k))).map_or(0.0, |line| line.amplitude);
    let doubled = doubled.filter(|line| line.amplitude > HALF_TOOTH * tooth && line.amplitude > ABOVE_RUNOUT * runout);
    if let Some(line) = unexplained
        && let Some(spindle) = comb.other(&whole, line.frequency)
    {
        let [commanded, heard] = [comb.spindle_frequency, spindle].map(|frequency| 60.0 * frequency);
        return Err(fault(RecordProblem::OtherSpeed { commanded, heard }));
    }
    let (chatter, line) = match (unexplained, doubled) {
        (Some(line), _) => (Chatter::Yes, Some(near_mode(&lines, line, cutting.natural_frequencies))),
        (None, Some(line)) => (Chatter::Ambiguous, Some(line)),
        (None, None) => (Chatter::No, None),
    };
    let onset = line.map(|line| frames.onset(line.frequency, SET_IN));
    let chatter_frequency = line.map(|line| {
        let settled = &samples[frames.sample(onset.unwrap_or(0.0)).min(samples.len() / 2)..];
        // A line beside a harmonic of the spindle must not be mistaken for that harmonic.
        let away = (line.frequency / comb.spindle_frequency - (line.frequency / comb.spindle_frequency).round()).abs();
        let reach = match line.origin {
            Origin::Unknown => frames.step().min(0.5 * away * comb.spindle_frequency),
            Origin::Tooth(_)
            | Origin::Spindle(_)
            | Origin::Mains
            | Origin::Machine
            | Origin::Folded(_)
            | Origin::Chatter(_) => frames.step(),
        };
        WholeSpectrum::new(settled, record.rate).refined(line.frequency, reach)
    });
    let mut possible_frequencies = Vec::new();
    let mut told = chatter_frequency;
    if let (Chatter::Yes, Some(frequency)) = (chatter, chatter_frequency) {
        let unfiltered = folded_teeth || folded::on_both_sides(&lines, &whole, &comb, frequency, record.rate);
        let usual = if unfiltered { FARTHEST } else { USUAL };
        let reach = of_file.map_or(usual, |mode| usual.max(1.1 * mode));
        let place = if !unfiltered && folded::is_filtered(&whole) {
            Place::At(frequency)
        } else {
            folded::unfolded(frequency, record.rate, reach, unfiltered, cutting.natural_frequencies)
        };
        match place {
            Place::At(one) => told = Some(one),
            Place::Told(one, others) => {
                told = Some(one);
                notes.push(format!(
                    "the chatter is at {one:.1} Hz if the recorder has a filter against aliasing, and may be at {} if it has none",
                    in_words(&others)
                ));
            }
            Place::OneOf(all) => (told, possible_frequencies) = (None, all),
        }
        let tooth_frequency = comb.spindle_frequency * f64::from(cutting.teeth);
        let centre = told.unwrap_or(frequency);
        for line in lines.iter_mut().filter(|line| line.origin == Origin::Unknown) {
            // A line at |fc + m ft| is one of fc + m ft or of −fc − m ft, and folded one of these beside multiples of the rate.
            let folds = if unfiltered { (centre / record.rate).ceil() as i32 } else { 0 };
            let beside = |fold: i32| [1.0, -1.0].map(|sign| f64::from(fold) * record.rate + sign * line.frequency);
            let places = (-folds..=folds).flat_map(beside);
            let whole = |m: &f64| (m - m.round()).abs() * tooth_frequency < LOBE * frames.step();
            let mut orders = places.map(|place| (place - centre) / tooth_frequency);
            if let Some(order) = orders.find(whole) {
                line.origin = Origin::Chatter(order.round() as i32);
            }
        }
    }
    let spindle_speed = TAU * comb.spindle_frequency;
    Ok(Heard { spindle_speed, chatter, chatter_frequency: told, possible_frequencies, onset, lines, notes })
}

/// Frequencies (Hz), in words.
fn in_words(frequencies: &[f64]) -> String {
    frequencies.iter().map(|frequency| format!("{frequency:.1} Hz")).collect::<Vec<_>>().join(" or ")
}

/// The samples of the first channel that is not constant, and what to be careful about; `None` where there is none.
fn heard_channel(record: &Record) -> Option<(&[f64], Vec<String>)> {
    let constant = |values: &[f64]| values.windows(2).all(|pair| pair[0] == pair[1]);
    let place = record.channels.iter().position(|channel| !constant(&channel.values))?;
    let samples = &record.channels[place].values;
    let mut notes = Vec::new();
    if record.channels.len() > 1 {
        let count = record.channels.len();
        let before = if place > 0 { ", those before it are constant" } else { "" };
        notes.push(format!("channel {} of {count} is heard{before}", place + 1));
    }
    let clipped = clipped_share(samples);
    if clipped > CLIPPED {
        notes.push(format!(
            "the record is clipped, {:.1} % of its samples lie at its greatest or least value: amplitudes are too small and \
             clipping makes lines of its own; record again at a lower gain",
            100.0 * clipped
        ));
    }
    Some((samples, notes))
}

/// Share of the samples that are at the greatest or least value and have one such neighbour on either side.
fn clipped_share(samples: &[f64]) -> f64 {
    let (least, greatest) = samples.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
    let at = |value: f64| samples.windows(3).filter(|three| three.iter().all(|x| *x == value)).count();
    (at(least) + at(greatest)) as f64 / samples.len() as f64
}

/// Tells lines that frames do not resolve from a harmonic of the spindle, where the whole record does. What stands beside a
/// harmonic must be more than a speed that wanders makes of it: that smears the lines of the teeth as well, the more the higher
/// they are.
fn apart(lines: &mut Vec<Line>, whole: &WholeSpectrum, comb: &Comb, frames: &Frames<'_>, air: Option<&Frames<'_>>) {
    let spindle = comb.spindle_frequency;
    let reach = |harmonic: f64| (MERGED * frames.step() + WANDER * harmonic).min(0.25 * spindle);
    let skirt = |harmonic: f64| whole.skirt(harmonic, reach(harmonic), WANDER * harmonic);
    let of_teeth: Vec<(f64, f64)> = lines
        .iter()
        .filter_map(|line| match line.origin {
            Origin::Tooth(order) => Some(f64::from(order * comb.teeth) * spindle),
            Origin::Spindle(_)
            | Origin::Mains
            | Origin::Machine
            | Origin::Folded(_)
            | Origin::Chatter(_)
            | Origin::Unknown => None,
        })
        .map(|harmonic| (harmonic, skirt(harmonic)))
        .collect();
    for i in 0..lines.len() {
        let line = lines[i];
        let (Origin::Tooth(_) | Origin::Spindle(_)) = line.origin else { continue };
        let harmonic = (line.frequency / spindle).round() * spindle;
        let others = of_teeth.iter().filter(|(other, _)| (other - harmonic).abs() > 0.5 * spindle);
        let wander = others.map(|(other, skirt)| skirt * (harmonic / other).max(1.0)).fold(0.0, f64::max);
        let Some((frequency, amplitude)) = whole.beside(harmonic, reach(harmonic), WANDER * harmonic) else { continue };
        if amplitude < BEYOND_WANDER * wander * whole.at(harmonic, WANDER * harmonic) {
            continue;
        }
        // The frames may have told it from the harmonic themselves.
        let known = |other: &Line| {
            let of_spindle = matches!(other.origin, Origin::Tooth(_) | Origin::Spindle(_));
            !of_spindle && (other.frequency - frequency).abs() < frames.step()
        };
        if lines.iter().any(known) {
            continue;
        }
        let level = line.level + level(amplitude / line.amplitude);
        let own = Line { frequency, amplitude, level, origin: beside_spindle(frequency, amplitude, frames, air) };
        if (line.frequency - frequency).abs() < (line.frequency - harmonic).abs() {
            lines[i] = own;
        } else {
            lines.push(own);
        }
    }
    lines.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
}

/// What explains a line, but for chatter.
fn origin(frequency: f64, amplitude: f64, comb: &Comb, frames: &Frames, air: Option<&Frames>) -> Origin {
    let width = LOBE * frames.step();
    let spindle = comb.spindle_frequency;
    let order = (frequency / spindle).round();
    // Wide lines must not fill the gap between them.
    let reach = (width + WANDER * frequency).min(0.25 * spindle);
    if order >= 1.0 && (frequency - order * spindle).abs() < reach {
        let order = order as u32;
        return if order.is_multiple_of(comb.teeth) {
            Origin::Tooth(order / comb.teeth)
        } else {
            Origin::Spindle(order)
        };
    }
    beside_spindle(frequency, amplitude, frames, air)
}

/// What explains a line that is none of the spindle, but for chatter.
fn beside_spindle(frequency: f64, amplitude: f64, frames: &Frames, air: Option<&Frames>) -> Origin {
    let (mains, harmonics) = MAINS;
    let of_mains = |base: f64| {
        let order = (frequency / base).round();
        (1.0..=f64::from(harmonics)).contains(&order)
            && (frequency - order * base).abs() < order * MAINS_DEVIATION + VERTEX * frames.step()
    };
    if mains.into_iter().any(of_mains) {
        return Origin::Mains;
    }
    in_the_air(frequency, amplitude, frames, air)
}

/// Whether a line is in the record without cutting as well.
fn in_the_air(frequency: f64, amplitude: f64, frames: &Frames, air: Option<&Frames>) -> Origin {
    let idle = air.and_then(|air| air.around(frequency, LOBE * frames.step()));
    if idle.is_some_and(|(idle, floor)| level(idle / floor) > STANDS_OUT && amplitude < OF_MACHINE * idle) {
        return Origin::Machine;
    }
    Origin::Unknown
}

/// Tells chatter that lies on a harmonic of mains from mains: the teeth do not modulate mains, so that it has no companion one
/// tooth frequency away, and it does not set in while the teeth are cutting already.
fn not_mains(lines: &mut [Line], whole: &WholeSpectrum, comb: &Comb, frames: &Frames<'_>, air: Option<&Frames<'_>>) {
    let tooth_frequency = comb.spindle_frequency * f64::from(comb.teeth);
    let place = |line: &Line| whole.refined(line.frequency, 0.5 * frames.step());
    // Lines of mains may be one tooth frequency from each other by chance, where 50 or 60 Hz is a fraction of it.
    let others: Vec<f64> = lines.iter().filter(|line| line.origin == Origin::Unknown).map(place).collect();
    let within = whole.width() + WANDER * tooth_frequency;
    let teeth = lines.iter().filter(|line| matches!(line.origin, Origin::Tooth(_)));
    let strongest = teeth.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude)).copied();
    let cut_begins = strongest.map_or(0.0, |line| frames.onset(line.frequency, SET_IN));
    let matters = MATTERS * strongest.map_or(0.0, |line| line.amplitude);
    for line in lines.iter_mut().filter(|line| line.origin == Origin::Mains && line.amplitude > matters) {
        let frequency = place(line);
        let companion = |other: &f64| {
            [frequency + tooth_frequency, (frequency - tooth_frequency).abs()]
                .into_iter()
                .any(|due| (due - other).abs() < within)
        };
        let sets_in =
            || line.level > level(SURE_GROWTH) && frames.onset(line.frequency, SET_IN) > cut_begins + frames.duration();
        if others.iter().any(companion) || sets_in() {
            line.origin = in_the_air(line.frequency, line.amplitude, frames, air);
        }
    }
}

/// Among the unexplained lines that are about as strong as the strongest, the one nearest to a natural frequency.
fn near_mode(lines: &[Line], strongest: Line, natural_frequencies: &[f64]) -> Line {
    let distance = |line: &Line| {
        let ratios = natural_frequencies.iter().map(|natural| (line.frequency / natural).ln().abs());
        ratios.fold(f64::INFINITY, f64::min)
    };
    let strong =
        lines.iter().filter(|line| line.origin == Origin::Unknown && line.amplitude >= STRONG * strongest.amplitude);
    let nearest = strong.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.copied().filter(|_| !natural_frequencies.is_empty()).unwrap_or(strongest)
}
