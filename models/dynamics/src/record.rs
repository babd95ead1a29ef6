//! Records over time: force and response of a hammer test, the sound of a cut.

use crate::error::{DynamicsError, RecordProblem};
use crate::frf::Direction;
use crate::table::{Table, read_table, split_title};
use crate::unit::{self, Motion};
use crate::wav::{is_wave, read_wave};

/// Greatest distance of a sample from even steps, in steps (assumption: time written with few digits).
const UNEVEN: f64 = 0.5;
/// Least number of samples of a record (assumption: a transform of fewer has no line to speak of).
const LEAST_SAMPLES: usize = 64;

/// What a channel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// Force of the hammer (N).
    Force,
    /// Response of the structure (m, m/s, m/s²).
    Response(Motion),
    /// Sound or anything else of which only frequencies count, in its own unit.
    Sound,
}

/// One channel of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What it holds.
    pub signal: Signal,
    /// Where it acts or is measured.
    pub direction: Direction,
    /// Its samples, SI.
    pub values: Vec<f64>,
}

/// Evenly sampled channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The file, as messages call it.
    pub source: String,
    /// Samples in a second (Hz).
    pub rate: f64,
    /// The channels, all of the same length.
    pub channels: Vec<Channel>,
}

/// What full scale of a channel of a sound file means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullScale {
    /// What the channel holds.
    pub signal: Signal,
    /// Its direction.
    pub direction: Direction,
    /// The value at full scale, SI.
    pub value: f64,
}

impl FullScale {
    /// From a name and a quantity such as `x.acceleration` and `50 g`; `None` for another name or unit, and for a value that
    /// is not positive.
    pub fn from_name(name: &str, quantity: &str) -> Option<Self> {
        let quantity = quantity.trim();
        let end = quantity.find(|letter: char| letter.is_ascii_whitespace())?;
        let value: f64 = quantity[..end].parse().ok().filter(|value: &f64| value.is_finite() && *value > 0.0)?;
        let (signal, direction, factor) = meaning(&name.trim().to_lowercase(), Some(quantity[end..].trim()))?.ok()?;
        Some(Self { signal, direction, value: value * factor })
    }
}

impl Record {
    /// Its duration (s).
    pub fn duration(&self) -> f64 {
        self.channels[0].values.len() as f64 / self.rate
    }
}

/// Whether the bytes are a record over time rather than a frequency response: a sound file, or a table with a column of time.
pub fn is_record(bytes: &[u8]) -> bool {
    let text = bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let header = text.into_iter().find(|line| !line.is_empty() && !line.starts_with(b"#")).unwrap_or(&[]);
    let header = String::from_utf8_lossy(header).to_lowercase();
    is_wave(bytes)
        || header
            .trim_start_matches('\u{feff}')
            .split([',', ';', '\t'])
            .any(|title| split_title(title.trim().trim_matches('"').trim()).0 == "time")
}

/// Reads a record from a sound file, whose channels mean what `scales` say one by one (sound, where it is empty), or from a
/// table with units in its header: `time [s]`, `force [N]`, `acceleration [m/s2]`, `velocity [m/s]`, `displacement [um]`,
/// `sound [Pa]`, each with `x.` or `y.` before it where it is not in x.
///
/// # Errors
/// [`DynamicsError`] with the place of the first fault.
pub fn read_record(file: &str, bytes: &[u8], scales: &[FullScale]) -> Result<Record, DynamicsError> {
    let record =
        if is_wave(bytes) { wave(file, bytes, scales)? } else { table(file, &String::from_utf8_lossy(bytes))? };
    long_enough(record)
}

/// The record, where a spectrum of it has lines to speak of.
///
/// # Errors
/// [`RecordProblem::Short`].
pub(crate) fn long_enough(record: Record) -> Result<Record, DynamicsError> {
    let samples = record.channels[0].values.len();
    if samples < LEAST_SAMPLES {
        let problem = RecordProblem::Short { samples, least: LEAST_SAMPLES };
        return Err(DynamicsError::Record { file: record.source, problem });
    }
    Ok(record)
}

/// Samples in a second (Hz) of times (s) in even steps.
///
/// # Errors
/// [`RecordProblem`]: a single time, uneven steps.
pub(crate) fn even_rate(time: &[f64]) -> Result<f64, RecordProblem> {
    let [first, .., last] = *time else {
        return Err(RecordProblem::Short { samples: time.len(), least: LEAST_SAMPLES });
    };
    let step = (last - first) / (time.len() - 1) as f64;
    let even = |(i, time): &(usize, &f64)| (*time - first - *i as f64 * step).abs() <= UNEVEN * step.abs();
    match time.iter().enumerate().find(|each| step <= 0.0 || !even(each)) {
        Some((i, time)) => Err(RecordProblem::Uneven { sample: i + 1, time: *time }),
        None => Ok(1.0 / step),
    }
}

fn wave(file: &str, bytes: &[u8], scales: &[FullScale]) -> Result<Record, DynamicsError> {
    let wave = read_wave(file, bytes)?;
    if !scales.is_empty() && scales.len() != wave.channels.len() {
        let problem = RecordProblem::Scales { channels: wave.channels.len(), scales: scales.len() };
        return Err(DynamicsError::Record { file: file.to_owned(), problem });
    }
    let sound = FullScale { signal: Signal::Sound, direction: Direction::X, value: 1.0 };
    let scales = scales.iter().copied().chain(std::iter::repeat(sound));
    let channels = wave.channels.into_iter().zip(scales).map(|(samples, scale)| Channel {
        signal: scale.signal,
        direction: scale.direction,
        values: samples.into_iter().map(|sample| sample * scale.value).collect(),
    });
    Ok(Record { source: file.to_owned(), rate: wave.rate, channels: channels.collect() })
}

fn table(file: &str, text: &str) -> Result<Record, DynamicsError> {
    let Table { line, titles, columns, .. } = read_table(file, text)?;
    let problem = |problem| DynamicsError::Record { file: file.to_owned(), problem };
    let (mut time, mut channels) = (None, Vec::new());
    for (title, values) in titles.into_iter().zip(columns) {
        let (name, unit) = split_title(&title);
        let Some(found) = meaning(&name, unit) else {
            return Err(DynamicsError::UnknownChannel { file: file.to_owned(), line, column: title });
        };
        let (signal, direction, factor) = found.map_err(|refused| match (unit, refused) {
            (None, Refused { example, .. }) => {
                DynamicsError::MissingUnit { file: file.to_owned(), line, column: title.clone(), example }
            }
            (Some(unit), Refused { accepted, .. }) => DynamicsError::UnknownUnit {
                file: file.to_owned(),
                line,
                column: title.clone(),
                unit: unit.to_owned(),
                accepted,
            },
        })?;
        let values: Vec<f64> = values.into_iter().map(|value| value * factor).collect();
        if name == "time" {
            if time.replace(values).is_some() {
                return Err(DynamicsError::ColumnCount { file: file.to_owned(), line, column: title });
            }
        } else {
            channels.push(Channel { signal, direction, values });
        }
    }
    let missing = |column: &str| DynamicsError::ColumnCount { file: file.to_owned(), line, column: column.to_owned() };
    let time = time.ok_or_else(|| missing("time [s]"))?;
    if channels.is_empty() {
        return Err(missing("force [N], acceleration [m/s2], sound [Pa]"));
    }
    let rate = even_rate(&time).map_err(problem)?;
    Ok(Record { source: file.to_owned(), rate, channels })
}

/// Units that would do, and a title with one.
#[derive(Clone, Copy, Debug)]
struct Refused {
    example: &'static str,
    accepted: &'static str,
}

/// Signal, direction and factor to SI of a column; `None` where the name means nothing.
fn meaning(name: &str, unit: Option<&str>) -> Option<Result<(Signal, Direction, f64), Refused>> {
    let (direction, name) = match name.split_once('.') {
        Some(("x", name)) => (Direction::X, name),
        Some(("y", name)) => (Direction::Y, name),
        Some(_) => return None,
        None => (Direction::X, name),
    };
    let moved = |motion: Motion, example, accepted| {
        let found = unit.and_then(unit::motion).filter(|(_, kind)| *kind == motion);
        found.map(|(factor, _)| (Signal::Response(motion), direction, factor)).ok_or(Refused { example, accepted })
    };
    Some(match name {
        "time" => {
            let factor = unit.and_then(unit::time);
            let refused = Refused { example: "time [s]", accepted: "s, ms, us" };
            factor.map(|factor| (Signal::Sound, direction, factor)).ok_or(refused)
        }
        "force" => {
            let factor = unit.and_then(unit::force);
            let refused = Refused { example: "force [N]", accepted: "N, kN, lbf" };
            factor.map(|factor| (Signal::Force, direction, factor)).ok_or(refused)
        }
        "displacement" => moved(Motion::Displacement, "displacement [um]", "m, mm, um, nm, in"),
        "velocity" => moved(Motion::Velocity, "velocity [m/s]", "m/s, mm/s, in/s"),
        "acceleration" => {
            moved(Motion::Acceleration, "acceleration [m/s2]", "m/s2, mm/s2, in/s2, g (standard gravity)")
        }
        "sound" => Ok((Signal::Sound, direction, 1.0)),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::fmt::Write as _;

    fn text(header: &str, row: impl Fn(f64) -> String) -> String {
        (0..100).fold(format!("{header}\n"), |mut text, i| {
            let _ = writeln!(text, "{}", row(f64::from(i)));
            text
        })
    }

    #[test]
    fn a_table_over_time_is_read_in_its_units() {
        let table = text("Time [ms];force [kN];y.acceleration [g]", |i| format!("{:.1};0.5;{i}", 7.0 + 0.1 * i));
        assert!(is_record(table.as_bytes()) && !is_record(b"frequency [Hz],real [um/N]\n"));
        let record = read_record("hits.csv", table.as_bytes(), &[]).unwrap();
        assert!((record.rate - 1e4).abs() < 1e-6 && (record.duration() - 0.01).abs() < 1e-12);
        let [force, response] = &record.channels[..] else { panic!("{record:?}") };
        assert_eq!((force.signal, force.values[3]), (Signal::Force, 500.0));
        assert_eq!((response.signal, response.direction), (Signal::Response(Motion::Acceleration), Direction::Y));
        assert!((response.values[2] - 19.6133).abs() < 1e-12);
    }

    #[test]
    fn faults_of_records_name_their_place() {
        let fault = |text: String| read_record("hits.csv", text.as_bytes(), &[]).unwrap_err().to_string();
        let plain = |header: &str| fault(text(header, |i| format!("{i},0")));
        assert!(plain("time [s],force").starts_with("hits.csv:1: the column `force` has no unit"));
        assert!(plain("time [s],force [V]").contains("the unit `V`"));
        assert!(plain("time [s],velocity [m]").contains("the unit `m`"));
        assert!(plain("time [s],torque [N m]").contains("the column `torque [N m]` is not known"));
        assert!(plain("force [N],acceleration [g]").contains("`time [s]` must be there once"));
        let jump = fault(text("time [s],force [N]", |i| format!("{},0", i + f64::from(u8::from(i > 50.0)))));
        assert!(jump.contains("uneven"), "{jump}");
        assert!(fault("time [s],force [N]\n0,1\n1,1\n".to_owned()).contains("2 samples"));
        assert!(fault(text("time [s],force [N]", |_| "1,0".to_owned())).contains("uneven"));
    }

    #[test]
    fn full_scale_has_name_and_unit() {
        let scale = FullScale::from_name("y.acceleration", "50 g").unwrap();
        assert_eq!((scale.signal, scale.direction), (Signal::Response(Motion::Acceleration), Direction::Y));
        assert!((scale.value - 490.3325).abs() < 1e-9);
        assert_eq!(FullScale::from_name("force", "500 N").unwrap().value, 500.0);
        for (name, quantity) in [("force", "500"), ("force", "500 g"), ("force", "-1 N"), ("z.force", "1 N")] {
            assert_eq!(FullScale::from_name(name, quantity), None, "{name} {quantity}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "(time \\[s\\]|force \\[N\\]|[a-z.]{1,6}|[0-9.,;\\-\n ]){0,60}") {
            let _ = read_record("a", text.as_bytes(), &[]);
        }
    }
}
