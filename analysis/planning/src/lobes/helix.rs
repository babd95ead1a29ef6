//! The helix of a cutter that goes deepest in a window of spindle speeds.
//!
//! A helix spreads the entry of a tooth over the depth. It closes lobes of period doubling into islands and takes them away where
//! the depth is a multiple of the axial pitch; elsewhere it changes little. Angles up to 60° are tried, first in coarse steps and
//! then around the best one, each judged by the least limit at even speeds over the window. All teeth have the same helix:
//! teeth of different helices, whose pitch changes along the depth, are not modelled.
//!
//! # Source
//! Zatarain, Muñoa, Peigné, Insperger, Analysis of the influence of mill helix angle on chatter stability (2006), for the effect
//! (recalled); the search is exhaustive over even angles.

use super::LobesFile;
use super::cut::Cut;
use super::pitch::{PitchError, even_speeds, least};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use toolroom_chatter::{ChatterError, Cutter, Milling};
use toolroom_form::significant;

/// Greatest helix (deg) and steps of the search, coarse and fine (assumption: end mills are ground from 0 to 60°).
const GREATEST: f64 = 60.0;
const COARSE: f64 = 5.0;
const FINE: f64 = 1.0;

/// The best helix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestHelix {
    /// First and last speed of the window (rad/s).
    pub window: [f64; 2],
    /// Helix angle (rad).
    pub helix: f64,
    /// Least limit of depth over the window (m).
    pub limit: f64,
    /// Helix of the file (rad).
    pub given: f64,
    /// Least limit with that (m).
    pub given_limit: f64,
    /// Greatest depth that was searched (m), which a limit is cut off at.
    pub greatest: f64,
}

impl LobesFile {
    /// The helix with the greatest least limit over a window of speeds (rad/s); that of the file where none goes deeper.
    ///
    /// # Errors
    /// [`PitchError`]: a cut of another kind, a window that is none, a value that the model refuses.
    pub fn best_helix(&self, window: [f64; 2]) -> Result<BestHelix, PitchError> {
        let cut = match &self.cut {
            Cut::Milling(cut, None) => cut,
            Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => {
                return Err(PitchError::Process);
            }
        };
        let (speeds, greatest, given) = (even_speeds(window)?, self.chart.depth.end, cut.cutter.helix_angle);
        let judge = |helix_angle: f64| {
            let cutter = Cutter { helix_angle, ..cut.cutter.clone() };
            least(&Milling { cutter, ..cut.clone() }, &speeds, greatest)
        };
        let given_limit = judge(given)?;
        let mut best = (given, given_limit);
        let try_all = |angles: Vec<f64>, best: &mut (f64, f64)| -> Result<(), ChatterError> {
            let angles: Vec<f64> = angles.into_iter().map(f64::to_radians).collect();
            let limits: Vec<f64> = angles.par_iter().map(|angle| judge(*angle)).collect::<Result<_, _>>()?;
            for (angle, limit) in angles.into_iter().zip(limits) {
                if limit > best.1 {
                    *best = (angle, limit);
                }
            }
            Ok(())
        };
        try_all((0..=(GREATEST / COARSE) as usize).map(|i| COARSE * i as f64).collect(), &mut best)?;
        let around = best.0.to_degrees();
        let steps = (COARSE / FINE) as i32 - 1;
        let finer = (-steps..=steps).filter(|i| *i != 0).map(|i| around + FINE * f64::from(i));
        try_all(finer.filter(|angle| (0.0..=GREATEST).contains(angle)).collect(), &mut best)?;
        let (helix, limit) = best;
        Ok(BestHelix { window, helix, limit, given, given_limit, greatest })
    }
}

impl BestHelix {
    /// The limit over that of the file's helix, less one.
    pub fn gain(&self) -> f64 {
        self.limit / self.given_limit - 1.0
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({
            "schema": 1,
            "window [rpm]": self.window.map(|speed| speed * 60.0 / TAU),
            "helix_angle [deg]": self.helix.to_degrees(),
            "least_limit [mm]": self.limit * 1e3,
            "helix_angle_of_file [deg]": self.given.to_degrees(),
            "least_limit_of_file [mm]": self.given_limit * 1e3,
            "searched [mm]": self.greatest * 1e3,
            "gain": self.gain(),
        })
    }

    /// For a terminal.
    pub fn text(&self) -> String {
        let rounded = |value: f64| significant((value * 1e6).round() / 1e3);
        let [low, high] = self.window.map(|speed| speed * 60.0 / TAU);
        let end = |limit: f64| if limit >= self.greatest { ", the end of the chart" } else { "" };
        let angle = |radians: f64| significant((radians.to_degrees() * 1e3).round() / 1e3);
        let first = format!(
            "{low:.0} to {high:.0} rpm, helix {} deg: least limit {} mm{}\n",
            angle(self.given),
            rounded(self.given_limit),
            end(self.given_limit)
        );
        if self.limit <= self.given_limit {
            return first + "no other helix up to 60 deg goes deeper everywhere in this window";
        }
        first
            + &format!(
                "helix {0} deg: least limit {1} mm{2}, {3:+.0} %\n[cutter] takes it by helix_angle = \"{0} deg\"",
                angle(self.helix),
                rounded(self.limit),
                end(self.limit),
                100.0 * self.gain()
            )
    }
}
