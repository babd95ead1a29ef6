//! What a program tells of the control that it is written for.

use super::words::Words;
use super::{ProgramFault, Units};

/// Controls whose words mean different things, as far as a program itself shows which it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    /// A header `%_N_…` or `;$PATH`: Siemens.
    Siemens,
    /// A program number `O1234`: Fanuc, Haas and what follows them.
    Numbered,
    /// Neither.
    Unknown,
}

impl Dialect {
    pub(super) fn of(text: &str) -> Self {
        let lines = || text.lines().map(|line| line.trim_start_matches(['\u{feff}', '\0']).trim_start());
        let numbered = |line: &str| {
            let rest = line.strip_prefix(['O', 'o']).map_or("", str::trim_start);
            rest.starts_with(|sign: char| sign.is_ascii_digit())
        };
        if lines().any(|line| line.starts_with("%_N_") || line.starts_with(";$PATH")) {
            Self::Siemens
        } else if lines().any(numbered) {
            Self::Numbered
        } else {
            Self::Unknown
        }
    }

    /// Why a G code with tenths is not for this control, where it is not.
    pub(super) fn refuses(self, code: u32) -> Option<&'static str> {
        let siemens = self == Self::Siemens;
        match code {
            700 | 710 | 7000 | 7100 | 5050..=5990 | 600 if !siemens => Some(match code {
                700 | 710 => {
                    "inch and metric on a Siemens control, cycles on others; write G20 or G21, or keep the header %_N_ of a Siemens program"
                }
                _ => "a code of Siemens controls, but no header %_N_ or ;$PATH says that the program is for one",
            }),
            700 => Some(
                "on a Siemens control it leaves the unit of F to the machine; write G700 for inches and inches a minute",
            ),
            200
            | 210
            | 280
            | 300
            | 430..=490
            | 520
            | 541
            | 591..=593
            | 730
            | 800..=860
            | 890
            | 920..=923
            | 980
            | 990
                if siemens =>
            {
                Some("another control's code, though the header says Siemens; take the header out where it is wrong")
            }
            _ => None,
        }
    }

    /// Dwell of the P of a hole or of G4, s.
    ///
    /// # Source
    /// P without a decimal point is milliseconds on Fanuc and Haas, seconds on LinuxCNC; with one it is seconds on
    /// Haas and LinuxCNC (manuals of these controls; Kramer, Proctor and Messina, NISTIR 6556, 3.5.4 for seconds). So
    /// a whole number is taken only where a program number tells the first two from the third.
    pub(super) fn pause(self, words: &Words) -> Result<Option<f64>, ProgramFault> {
        let Some(value) = words.number('P') else { return Ok(None) };
        if value < 0.0 {
            return Err(ProgramFault::Dwell { reason: "the time is negative" });
        }
        if words.pointed('P') || value == 0.0 {
            return Ok(Some(value));
        }
        if self == Self::Numbered {
            return Ok(Some(value * 1e-3));
        }
        let reason = "P without a decimal point is milliseconds on Fanuc and Haas, seconds on LinuxCNC: write P with a point for seconds, or give the program its number O1234";
        Err(ProgramFault::Dwell { reason })
    }

    /// Dwell of G4, s.
    ///
    /// # Source
    /// F seconds, S revolutions: SINUMERIK 840D programming guide, fundamentals. X seconds: Fanuc operator's manual;
    /// U where X is a diameter. For P see [`Dialect::pause`].
    pub(super) fn dwell(self, words: &Words, spindle_speed: f64) -> Result<f64, ProgramFault> {
        let fault = |reason| ProgramFault::Dwell { reason };
        let time = if self == Self::Siemens {
            match (words.number('F'), words.number('S')) {
                (Some(seconds), None) => Some(seconds),
                (None, Some(revolutions)) if spindle_speed > 0.0 => Some(60.0 * revolutions / spindle_speed),
                (None, Some(_)) => return Err(fault("S counts revolutions, but no spindle speed stands before it")),
                _ => None,
            }
        } else {
            if words.any("FS") {
                let reason = "F and S of G4 are a time and revolutions on a Siemens control, a feed and a speed on others: write G4 X2. for seconds, or keep the header %_N_ of a Siemens program";
                return Err(fault(reason));
            }
            match (words.number('P'), words.number('X'), words.number('U')) {
                (Some(_), None, None) => self.pause(words)?,
                (None, Some(seconds), None) | (None, None, Some(seconds)) => Some(seconds),
                _ => None,
            }
        };
        let time = time.ok_or_else(|| fault("one time has to stand beside it, such as X2. for seconds"))?;
        if time >= 0.0 { Ok(time) } else { Err(fault("the time is negative")) }
    }
}

impl Units {
    /// Length of the unit, m.
    pub(super) fn length(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Inch => 0.0254,
        }
    }
}
