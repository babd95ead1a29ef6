//! Taps at several spindle speeds: the modes at each, followed from speed to speed, and the responses between two speeds.
//!
//! A spindle that turns has other modes than one at rest. A table with a column `spindle_speed [rpm]` holds its responses at
//! several speeds. The modes of each are fitted and matched with those of the next speed; the structure file takes them as
//! `[[speed]]`.
//!
//! # Responses between two speeds
//! A mean of two responses whose resonances stand at two frequencies has both. The poles are followed instead: the frequencies
//! of both measurements are stretched, on straight lines between the modes, until their resonances stand where those of the
//! speed in question do, and only then the responses are mixed. At a speed of the table the response is the measured one.

use super::ModesStudy;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use toolroom_chart::page::Provenance;
use toolroom_dynamics::{DynamicsError, FitOptions, FittedMode, Frf, Measurement, Scatter, mode_keys, quoted};

/// Relative change of a natural frequency between two neighbouring speeds beyond which two modes are not one (assumption: a
/// spindle loses a few percent of its stiffness by preload and heat).
const GREATEST_CHANGE: f64 = 0.15;

/// Why taps at several speeds give no table of modes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpeedsError {
    /// One speed alone.
    #[error("the table holds one spindle speed alone; leave out its column for modes of all speeds")]
    Single,
    /// Another number of modes at two speeds.
    #[error(
        "{first} modes were found at {first_rpm} rpm and {second} at {second_rpm} rpm; tell their number with --modes, or pick them \
         with --pick"
    )]
    Count {
        /// Modes at the first speed.
        first: usize,
        /// The first speed (rpm).
        first_rpm: f64,
        /// Modes at the second speed.
        second: usize,
        /// The second speed (rpm).
        second_rpm: f64,
    },
    /// A mode that is none of those at the next speed.
    #[error("the mode of {frequency:.0} Hz at {rpm} rpm has none within 15 % at the next speed; tap at speeds between")]
    Lost {
        /// Its frequency (Hz).
        frequency: f64,
        /// The speed (rpm).
        rpm: f64,
    },
    /// A speed at which nobody measured.
    #[error("the responses were measured from {least_rpm} to {greatest_rpm} rpm, not at {rpm} rpm")]
    Outside {
        /// The speed in question (rpm).
        rpm: f64,
        /// Least speed of the table (rpm).
        least_rpm: f64,
        /// Greatest speed of the table (rpm).
        greatest_rpm: f64,
    },
    /// A response that cannot be fitted.
    #[error(transparent)]
    Fit(#[from] DynamicsError),
}

fn rpm(speed: f64) -> f64 {
    // Written as it was told, not as 6000.000000000001.
    (speed / TAU * 60.0 * 1e6).round() / 1e6
}

/// Taps at several spindle speeds with the modes of each.
#[derive(Debug)]
pub struct SpeedStudy {
    /// Name of the structure.
    name: String,
    /// By ascending spindle speed (rad/s); each but the first with the places of its modes in the order of those before it.
    rows: Vec<(f64, ModesStudy, Vec<usize>)>,
}

impl SpeedStudy {
    /// Fits modes at every spindle speed (rad/s).
    ///
    /// # Errors
    /// [`SpeedsError`]: one speed alone, a response that cannot be fitted.
    pub fn new(
        name: &str,
        measured: Vec<(f64, Measurement)>,
        options: &FitOptions,
        scatter: Scatter,
    ) -> Result<Self, SpeedsError> {
        if measured.len() < 2 {
            return Err(SpeedsError::Single);
        }
        let mut rows: Vec<(f64, ModesStudy, Vec<usize>)> = Vec::with_capacity(measured.len());
        for (speed, measured) in measured {
            let study = ModesStudy::new(name.to_owned(), measured, options, scatter)?;
            let order = match rows.last() {
                None => (0..study.fit.modes.len()).collect(),
                Some((_, before, order)) => {
                    let known: Vec<&FittedMode> = order.iter().map(|i| &before.fit.modes[*i]).collect();
                    follow(&known, &study.fit.modes)
                }
            };
            rows.push((speed, study, order));
        }
        Ok(Self { name: name.to_owned(), rows })
    }

    /// The fits by ascending spindle speed (rad/s).
    pub fn fits(&self) -> impl Iterator<Item = (f64, &ModesStudy)> {
        self.rows.iter().map(|(speed, study, _)| (*speed, study))
    }

    /// The modes at every speed, for people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (speed, study, _) in &self.rows {
            let _ = writeln!(text, "{} rpm\n{}", rpm(*speed), study.text());
        }
        text
    }

    /// The modes at every speed, for programs.
    pub fn json(&self) -> Value {
        let row = |(speed, study, order): &(f64, ModesStudy, Vec<usize>)| json!({ "spindle_speed [rpm]": rpm(*speed), "order": order, "fit": study.json() });
        json!({ "schema": 1, "name": self.name, "speeds": self.rows.iter().map(row).collect::<Vec<_>>() })
    }

    /// The structure file.
    ///
    /// # Errors
    /// [`SpeedsError::Count`] and [`SpeedsError::Lost`]: modes that cannot be followed from speed to speed.
    pub fn structure(&self, provenance: &Provenance) -> Result<String, SpeedsError> {
        for pair in self.rows.windows(2) {
            let [(first, before, _), (second, study, order)] = pair else { continue };
            let (count, other) = (before.fit.modes.len(), study.fit.modes.len());
            if count != other {
                let (first_rpm, second_rpm) = (rpm(*first), rpm(*second));
                return Err(SpeedsError::Count { first: count, first_rpm, second: other, second_rpm });
            }
            if order.len() < count {
                let near = |mode: &&FittedMode| !study.fit.modes.iter().any(|other| change(mode, other).is_some());
                let lost = before.fit.modes.iter().find(near).or(before.fit.modes.last());
                let frequency = lost.map_or(0.0, |mode| mode.natural_frequency.value);
                return Err(SpeedsError::Lost { frequency, rpm: rpm(*first) });
            }
        }
        let digests = provenance.inputs.iter().map(|(name, digest)| format!("{name} ({digest})"));
        let source = format!("{} of {}", provenance.command, digests.collect::<Vec<_>>().join(", "));
        let worst = self.rows.iter().map(|(_, study, _)| study.fit.quality.verdict()).collect::<Vec<_>>().join("; ");
        let mut text = format!("schema = 1\nname = {}\n\n[measurement]\n", quoted(&self.name));
        let _ = writeln!(text, "source = {}\nquality = {}", quoted(&source), quoted(&worst));
        for (speed, study, order) in &self.rows {
            let _ = writeln!(text, "\n[[speed]]\nspindle_speed = \"{} rpm\"", rpm(*speed));
            for (number, place) in order.iter().enumerate() {
                let keys = mode_keys(number + 1, &study.fit.modes[*place], study.scatter);
                let _ = write!(text, "[[speed.mode]]\n{keys}");
            }
        }
        // One compliance stands for the modes above the range at all speeds: the mean.
        let _ = writeln!(
            text,
            "\n# Mean over the speeds of the compliance of all modes above the measured range.\n[residual]"
        );
        for (pair, _) in &self.rows[0].1.fit.upper {
            let of = |(_, study, _): &(f64, ModesStudy, Vec<usize>)| {
                study.fit.upper.iter().find(|(name, _)| name == pair).map_or(0.0, |(_, upper)| upper.value)
            };
            let mean = self.rows.iter().map(of).sum::<f64>() / self.rows.len() as f64;
            let _ = writeln!(text, "upper_{pair} = \"{mean:.5e} m/N\"");
        }
        Ok(text)
    }

    /// The measurement at a spindle speed (rad/s): that of a speed of the table, or between two of them.
    ///
    /// # Errors
    /// [`SpeedsError::Outside`]: nobody measured there.
    pub fn at(&self, speed: f64) -> Result<Measurement, SpeedsError> {
        let (least, greatest) = (self.rows[0].0, self.rows[self.rows.len() - 1].0);
        if !(least * (1.0 - 1e-9)..=greatest * (1.0 + 1e-9)).contains(&speed) {
            return Err(SpeedsError::Outside { rpm: rpm(speed), least_rpm: rpm(least), greatest_rpm: rpm(greatest) });
        }
        let after = self.rows.partition_point(|(known, ..)| *known < speed).clamp(1, self.rows.len() - 1);
        let ((from, before, known), (to, behind, order)) = (&self.rows[after - 1], &self.rows[after]);
        let share = ((speed - from) / (to - from)).clamp(0.0, 1.0);
        if share < 1e-9 {
            return Ok(before.measured.clone());
        }
        if share > 1.0 - 1e-9 {
            return Ok(behind.measured.clone());
        }
        let frequency = |study: &ModesStudy, place: usize| study.fit.modes[place].natural_frequency.value;
        let poles = known.iter().zip(order).map(|(a, b)| [frequency(before, *a), frequency(behind, *b)]);
        Ok(between(&before.measured, &behind.measured, share, poles.collect()))
    }
}

/// Relative change from one mode to another that can be the same: in frequency, more where it turns.
fn change(a: &FittedMode, b: &FittedMode) -> Option<f64> {
    let shift = (b.natural_frequency.value / a.natural_frequency.value).ln().abs();
    let along = (a.direction[0] * b.direction[0] + a.direction[1] * b.direction[1]).abs().min(1.0);
    // A right angle counts as the greatest change of frequency.
    (shift < GREATEST_CHANGE).then_some(shift + GREATEST_CHANGE * (1.0 - along * along))
}

/// Places of the modes that continue `known`, as many as there are: the pairs of least change first.
fn follow(known: &[&FittedMode], modes: &[FittedMode]) -> Vec<usize> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, a) in known.iter().enumerate() {
        pairs.extend(modes.iter().enumerate().filter_map(|(j, b)| change(a, b).map(|change| (change, i, j))));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut place = vec![None; known.len()];
    let mut taken = vec![false; modes.len()];
    for (_, i, j) in pairs {
        if place[i].is_none() && !taken[j] {
            (place[i], taken[j]) = (Some(j), true);
        }
    }
    place.into_iter().map_while(|place| place).collect()
}

/// The response at a `share` of the way from `a` to `b`, whose `poles` (Hz) correspond.
fn between(a: &Measurement, b: &Measurement, share: f64, mut poles: Vec<[f64; 2]>) -> Measurement {
    let mix = |[a, b]: [f64; 2]| a + (b - a) * share;
    poles.sort_by(|p, q| mix(*p).total_cmp(&mix(*q)));
    // Two modes that pass each other cannot both be followed by stretching one axis: the later one is left out.
    let mut knots: Vec<[f64; 2]> = vec![[0.0, 0.0]];
    for pole in poles {
        let last = knots[knots.len() - 1];
        if pole[0] > last[0] && pole[1] > last[1] {
            knots.push(pole);
        }
    }
    // Beyond the last mode the axis is stretched as at it.
    let last = knots[knots.len() - 1];
    let far = if last[0] > 0.0 { last.map(|frequency| 100.0 * frequency) } else { [1e9, 1e9] };
    knots.push(far);
    let stretched = |frequency: f64| {
        let right = knots.partition_point(|knot| mix(*knot) < frequency).clamp(1, knots.len() - 1);
        let (from, to) = (knots[right - 1], knots[right]);
        let place = (frequency - mix(from)) / (mix(to) - mix(from));
        [from[0] + (to[0] - from[0]) * place, from[1] + (to[1] - from[1]) * place]
    };
    let (a_ends, b_ends) = (ends(a), ends(b));
    let frequencies: Vec<f64> = a
        .frequencies
        .iter()
        .copied()
        .filter(|frequency| {
            let [x, y] = stretched(*frequency);
            (a_ends[0]..=a_ends[1]).contains(&x) && (b_ends[0]..=b_ends[1]).contains(&y)
        })
        .collect();
    let functions = a.functions.iter().filter_map(|function| {
        let alike = |other: &&Frf| other.response == function.response && other.force == function.force;
        let other = b.functions.iter().find(alike)?;
        let at = |frequency: &f64| {
            let [x, y] = stretched(*frequency);
            (place(&a.frequencies, x), place(&b.frequencies, y))
        };
        let receptance = frequencies.iter().map(|frequency| {
            let (x, y) = at(frequency);
            let value = |function: &Frf, (i, t): (usize, f64)| {
                function.receptance[i] * (1.0 - t) + function.receptance[i + 1] * t
            };
            value(function, x) * (1.0 - share) + value(other, y) * share
        });
        let coherence = match (&function.coherence, &other.coherence) {
            (Some(a), Some(b)) => {
                let value = |known: &[f64], (i, t): (usize, f64)| known[i] * (1.0 - t) + known[i + 1] * t;
                let least = frequencies.iter().map(|frequency| {
                    let (x, y) = at(frequency);
                    value(a, x).min(value(b, y))
                });
                Some(least.collect())
            }
            _ => None,
        };
        Some(Frf { receptance: receptance.collect(), coherence, noise: None, ..function.clone() })
    });
    Measurement {
        source: format!("between {} and {}", a.source, b.source),
        functions: functions.collect(),
        frequencies,
        ..a.clone()
    }
}

fn ends(measured: &Measurement) -> [f64; 2] {
    let first = measured.frequencies.first().copied().unwrap_or(0.0);
    [first, measured.frequencies.last().copied().unwrap_or(0.0)]
}

/// The line before `frequency` and the share of the way to the next one.
fn place(frequencies: &[f64], frequency: f64) -> (usize, f64) {
    let right = frequencies.partition_point(|known| *known < frequency).clamp(1, frequencies.len() - 1);
    let (from, to) = (frequencies[right - 1], frequencies[right]);
    (right - 1, ((frequency - from) / (to - from)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;
    use toolroom_chatter::{Mode, SpeedModes, Turning};
    use toolroom_dynamics::{Direction, Motion};

    const SPEEDS: [f64; 3] = [2000.0, 6000.0, 10000.0];

    fn modes(shift: f64, damping: f64) -> Vec<Mode> {
        let mode = |f: f64, zeta: f64, k: f64| Mode {
            direction: [1.0, 0.0],
            natural_frequency: f,
            damping_ratio: zeta,
            stiffness: k,
        };
        vec![mode(612.0 * shift, 0.03 * damping, 22e6), mode(1180.0 * shift, 0.019 * damping, 9.6e6)]
    }

    fn tapped(modes: &[Mode]) -> Measurement {
        let frequencies: Vec<f64> = (100..1000).map(|i| 2.0 * f64::from(i)).collect();
        let receptance: Vec<Complex<f64>> =
            frequencies.iter().map(|f| modes.iter().map(|mode| mode.compliance(*f)).sum()).collect();
        let frf = Frf {
            response: Direction::X,
            force: Direction::X,
            motion: Motion::Displacement,
            receptance,
            coherence: None,
            noise: None,
        };
        Measurement {
            source: "taps.csv".to_owned(),
            frequencies,
            functions: vec![frf],
            averages: None,
            coherence_digit: 0.0,
            window_decay: 0.0,
            notes: Vec::new(),
        }
    }

    fn drifting() -> Vec<(f64, Vec<Mode>)> {
        let rows = [(SPEEDS[0], modes(1.0, 1.0)), (SPEEDS[1], modes(0.95, 1.1)), (SPEEDS[2], modes(0.91, 1.3))];
        rows.map(|(n, modes)| (n / 60.0 * TAU, modes)).to_vec()
    }

    fn study() -> SpeedStudy {
        let measured = drifting().into_iter().map(|(speed, modes)| (speed, tapped(&modes))).collect();
        SpeedStudy::new("spindle", measured, &FitOptions::default(), Scatter::NONE).unwrap()
    }

    /// The limits straight from the measured table, at its speeds and between them, are those of modes whose poles are followed;
    /// a mean of the two responses, which has every resonance twice, is far off.
    #[test]
    fn the_response_between_two_speeds_follows_the_poles() {
        let (study, rows) = (study(), drifting());
        let truth = Turning {
            by_speed: Some(SpeedModes::new(rows.clone()).unwrap()),
            ..Turning::orthogonal(rows[0].1.clone(), 1.2e9, 0.04)
        };
        let mut naive: f64 = 0.0;
        for n in [2000.0, 3000.0, 4000.0, 5100.0, 6000.0, 7700.0, 9000.0, 10000.0] {
            let speed = n / 60.0 * TAU;
            let limit =
                |measured: &Measurement| super::super::measured_limit(measured, &truth, speed).unwrap().unwrap().depth;
            let expected = truth.limit(speed).unwrap().depth;
            let found = limit(&study.at(speed).unwrap());
            assert!((found / expected - 1.0).abs() < 0.02, "{n}: {found} {expected}");
            if n == 4000.0 {
                let (a, b) = (&study.rows[0].1.measured, &study.rows[1].1.measured);
                let mut mean = a.clone();
                for (value, other) in mean.functions[0].receptance.iter_mut().zip(&b.functions[0].receptance) {
                    *value = (*value + other) * 0.5;
                }
                naive = (limit(&mean) / expected - 1.0).abs();
            }
        }
        assert!(naive > 0.1, "{naive}");
        assert!(matches!(study.at(1900.0 / 60.0 * TAU), Err(SpeedsError::Outside { .. })));
        assert!(matches!(study.at(10100.0 / 60.0 * TAU), Err(SpeedsError::Outside { .. })));
    }

    #[test]
    fn the_structure_file_has_the_modes_of_every_speed_in_one_order() {
        let text = study().structure(&Provenance::default()).unwrap();
        let folder = std::env::temp_dir().join(format!("toolroom-speeds-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("spindle.toml");
        std::fs::write(&file, &text).unwrap();
        let structure = toolroom_lobes::read_structure(&file, &[]).unwrap_or_else(|error| panic!("{error:?}\n{text}"));
        std::fs::remove_dir_all(folder).unwrap();
        let table = structure.content.by_speed.unwrap();
        for (speed, modes) in drifting() {
            let found = table.at(speed).unwrap();
            for (a, b) in found.iter().zip(&modes) {
                assert!((a.natural_frequency / b.natural_frequency - 1.0).abs() < 1e-4, "{a:?} {b:?}");
                assert!((a.damping_ratio / b.damping_ratio - 1.0).abs() < 1e-2, "{a:?} {b:?}");
                assert!((a.stiffness / b.stiffness - 1.0).abs() < 1e-2, "{a:?} {b:?}");
            }
        }
        let single = vec![(100.0, tapped(&modes(1.0, 1.0)))];
        let alone = SpeedStudy::new("a", single, &FitOptions::default(), Scatter::NONE);
        assert_eq!(alone.err(), Some(SpeedsError::Single));
        let apart = vec![(100.0, tapped(&modes(1.0, 1.0))), (200.0, tapped(&modes(1.0, 1.0)[..1]))];
        let apart = SpeedStudy::new("a", apart, &FitOptions::default(), Scatter::NONE).unwrap();
        assert!(matches!(apart.structure(&Provenance::default()), Err(SpeedsError::Count { first: 2, second: 1, .. })));
    }
}
