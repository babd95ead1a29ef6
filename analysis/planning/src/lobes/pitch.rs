//! The unequal pitch of a cutter that goes deepest in a window of spindle speeds.
//!
//! Teeth at unequal angles meet the waves of the teeth before them at different phases, so that their forces partly cancel. Two
//! families are searched: alternating `p ± d` of an even number of teeth, and linear `p + d (j − (N − 1)/2)` of three teeth and
//! more, with p the equal pitch and d up to where the least angle is 0.4 p. Each is judged by the least limit at even speeds
//! over the window.
//!
//! # Source
//! Budak, An analytical design method for milling cutters with nonconstant pitch to increase stability (2003), for the
//! families; the search is exhaustive over them.

use super::LobesFile;
use super::cut::Cut;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write;
use toolroom_chatter::{ChatterError, Cutter, Milling};
use toolroom_form::significant;

/// Speeds over the window at which every pitch is judged, and differences that are tried of each family.
pub(super) const SPEEDS: usize = 7;
const TRIED: usize = 12;
/// Differences between the best and its neighbours that are tried afterwards.
const FINER: usize = 4;
/// Least angle between two teeth over the equal one (assumption: less leaves no room for chips).
const LEAST: f64 = 0.4;
/// Depths that are sampled for a limit in the search.
const STEPS: usize = 24;

/// Why no pitch is searched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PitchError {
    /// A cut of another kind.
    #[error(
        "a pitch is searched of milling at constant speed with two teeth and more, without runout; a helix of milling at constant speed"
    )]
    Process,
    /// A window that is none.
    #[error("the window of speeds must ascend from a positive speed")]
    Window,
    /// The model refused a value.
    #[error(transparent)]
    Refused(#[from] ChatterError),
}

/// The best unequal pitch.
#[derive(Clone, Debug, PartialEq)]
pub struct BestPitch {
    /// First and last speed of the window (rad/s).
    pub window: [f64; 2],
    /// Angles from each tooth to the one before it (rad).
    pub pitch: Vec<f64>,
    /// Least limit of depth over the window (m).
    pub limit: f64,
    /// That of equal pitch (m).
    pub equal: f64,
    /// Greatest depth that was searched (m), which a limit is cut off at.
    pub greatest: f64,
}

impl LobesFile {
    /// The pitch with the greatest least limit over a window of speeds (rad/s).
    ///
    /// # Errors
    /// [`PitchError`]: a cut of another kind, a window that is none, a value that the model refuses.
    pub fn best_pitch(&self, window: [f64; 2]) -> Result<BestPitch, PitchError> {
        let cut = match &self.cut {
            Cut::Milling(cut, None) if cut.cutter.teeth > 1 && cut.cutter.runout == 0.0 => cut,
            Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => {
                return Err(PitchError::Process);
            }
        };
        let greatest = self.chart.depth.end;
        let speeds = even_speeds(window)?;
        let judge = |pitch: &Vec<f64>| {
            let cutter = Cutter { pitch: pitch.clone(), ..cut.cutter.clone() };
            least(&Milling { cutter, ..cut.clone() }, &speeds, greatest)
        };
        let teeth = cut.cutter.teeth;
        let candidates: Vec<(Family, f64)> = Family::of(teeth)
            .into_iter()
            .flat_map(|family| (1..=TRIED).map(move |i| (family, family.most(teeth) * i as f64 / TRIED as f64)))
            .collect();
        let found: Vec<f64> = candidates
            .par_iter()
            .map(|(family, apart)| judge(&family.pitch(teeth, *apart)))
            .collect::<Result<_, ChatterError>>()?;
        let equal = judge(&Vec::new())?;
        let mut best = (Vec::new(), equal);
        let top = (0..found.len()).max_by(|a, b| found[*a].total_cmp(&found[*b]));
        if let Some(top) = top.filter(|top| found[*top] > equal) {
            let (family, apart) = candidates[top];
            best = (family.pitch(teeth, apart), found[top]);
            let step = family.most(teeth) / TRIED as f64;
            let finer: Vec<Vec<f64>> = (1..=FINER)
                .flat_map(|i| [-1.0, 1.0].map(|side| apart + side * step * i as f64 / (FINER + 1) as f64))
                .filter(|apart| *apart > 0.0 && *apart <= family.most(teeth))
                .map(|apart| family.pitch(teeth, apart))
                .collect();
            let limits: Vec<f64> = finer.par_iter().map(judge).collect::<Result<_, ChatterError>>()?;
            for (pitch, limit) in finer.into_iter().zip(limits) {
                if limit > best.1 {
                    best = (pitch, limit);
                }
            }
        }
        let (pitch, limit) = best;
        Ok(BestPitch { window, pitch, limit, equal, greatest })
    }
}

/// A family of pitches with one difference.
#[derive(Clone, Copy)]
enum Family {
    Alternating,
    Linear,
}

impl Family {
    fn of(teeth: usize) -> Vec<Self> {
        match (teeth.is_multiple_of(2), teeth > 2) {
            (true, true) => vec![Self::Alternating, Self::Linear],
            (true, false) => vec![Self::Alternating],
            (false, _) => vec![Self::Linear],
        }
    }

    /// Greatest difference (rad).
    fn most(self, teeth: usize) -> f64 {
        let room = (1.0 - LEAST) * TAU / teeth as f64;
        match self {
            Self::Alternating => room,
            Self::Linear => 2.0 * room / (teeth - 1) as f64,
        }
    }

    fn pitch(self, teeth: usize, apart: f64) -> Vec<f64> {
        let equal = TAU / teeth as f64;
        let middle = 0.5 * (teeth - 1) as f64;
        let angle = |j: usize| match self {
            Self::Alternating => equal + if j.is_multiple_of(2) { apart } else { -apart },
            Self::Linear => equal + apart * (j as f64 - middle),
        };
        (0..teeth).map(angle).collect()
    }
}

/// Even speeds (rad/s) over a window.
pub(super) fn even_speeds([low, high]: [f64; 2]) -> Result<Vec<f64>, PitchError> {
    if !(low > 0.0 && low < high && high.is_finite()) {
        return Err(PitchError::Window);
    }
    Ok((0..SPEEDS).map(|i| low + (high - low) * i as f64 / (SPEEDS - 1) as f64).collect())
}

/// Least limit over the speeds; the greatest depth where there is none, zero where the search for one fails.
pub(super) fn least(cut: &Milling, speeds: &[f64], greatest: f64) -> Result<f64, ChatterError> {
    let mut least = greatest;
    for speed in speeds {
        match cut.at_speed(*speed)?.rough_limit(greatest, STEPS) {
            Ok(limit) => least = least.min(limit.depth),
            Err(ChatterError::NoLimit { .. }) => {}
            Err(error) if error.is_failed_search() => return Ok(0.0),
            Err(error) => return Err(error),
        }
    }
    Ok(least)
}

impl BestPitch {
    /// The limit over that of equal pitch, less one.
    pub fn gain(&self) -> f64 {
        self.limit / self.equal - 1.0
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({
            "schema": 1,
            "window [rpm]": self.window.map(|speed| speed * 60.0 / TAU),
            "pitch [deg]": self.pitch.iter().map(|angle| angle.to_degrees()).collect::<Vec<f64>>(),
            "least_limit [mm]": self.limit * 1e3,
            "least_limit_equal [mm]": self.equal * 1e3,
            "searched [mm]": self.greatest * 1e3,
            "gain": self.gain(),
        })
    }

    /// For a terminal.
    pub fn text(&self) -> String {
        let rounded = |value: f64| significant((value * 1e3).round() / 1e3);
        let [low, high] = self.window.map(|speed| speed * 60.0 / TAU);
        let mut text = format!(
            "{low:.0} to {high:.0} rpm, equal pitch: least limit {} mm{}\n",
            rounded(self.equal * 1e3),
            if self.equal >= self.greatest { ", the end of the chart" } else { "" }
        );
        if self.pitch.is_empty() {
            return text + "no unequal pitch goes deeper everywhere in this window";
        }
        let angles: Vec<String> = self.pitch.iter().map(|angle| format!("{:.5}", angle.to_degrees())).collect();
        let end = if self.limit >= self.greatest { ", the end of the chart" } else { "" };
        let _ = write!(
            text,
            "pitch {} deg: least limit {} mm{end}, {:+.0} %\n\
             [cutter] takes it by pitch = [{}]",
            angles.join(", "),
            rounded(self.limit * 1e3),
            100.0 * self.gain(),
            angles.iter().map(|angle| format!("\"{angle} deg\"")).collect::<Vec<_>>().join(", ")
        );
        text
    }
}
