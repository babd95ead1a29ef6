//! The parametric model of turning in a three-jaw chuck (Zakovorotny, Pham Dinh Tung,
//! Pham Thu Huong, "Parametrical phenomena under on-machine process control").
//!
//! The chuck holds the workpiece stiffer over a jaw than between two, so its stiffness is
//! modulated three times a revolution; the allowance modulates the cut at odd harmonics of the
//! revolution. Both can make a cut unstable that is stable on average. [`Reduced`] is the
//! single-mode system (6), [`FiveDegrees`] the tool-and-workpiece system (5).
//!
//! The published tables are in kgf, mm and s and do not agree with the text about the mass, so
//! four readings are offered as [`Preset`]s.
//!
//! # What matches the paper and what does not
//! Critical modulation of the reduced system at spindle 2400 rpm and 120 Hz (`eta = 1`), for the
//! chip-formation lags 0, 0.4·10⁻⁴ and 0.8·10⁻⁴ s:
//!
//! | reading | damping ratio | thresholds | verdict |
//! |---|---|---|---|
//! | paper, text to Fig. 3 | – | 0.50, 0.38, 0.24 | |
//! | [`Preset::F0_120Hz`] (default) | 0.0121 | 0.5416, 0.4173, 0.2576 | no fitted constant; at most 0.042 high |
//! | [`Preset::Fig3Fit`] | 0.0102 | 0.4970, 0.3851, 0.2382 | mass and damping fitted; within 0.005 |
//! | [`Preset::Table2Milli`] at `eta = 1.9` | 0.0717 | 0.5104, 0.3858, 0.2593 | fits, but on the flank of the principal tongue |
//! | [`Preset::Table2Milli`] at `eta = 1` | 0.0717 | none below 1.2, 1.122, 1.054 | does not |
//! | [`Preset::Table2Literal`] | 0.0016 | 0.1968, 0.1390, 0 | does not: unstable without modulation at the longest lag |
//!
//! * The mass of Table 2 contradicts the text in every decimal reading: 120 is the natural
//!   frequency in rad/s with the literal mass, in Hz only with 10.35 kg.
//! * Fig. 2: all three stars lie inside the stable region, except the third under the literal
//!   table (limit 198.77 kgf/mm against 200).
//! * Fig. 4: the region of the five-degree system expands with tool dynamics and sits at low
//!   spindle speed, as the paper says; the expansion with the allowance harmonic is **not**
//!   reproduced with the published constants (the threshold moves by less than 0.02 %).
//! * The regenerative term is not in the paper's stability analysis; it is a switch here
//!   ([`FiveDegrees::regeneration`]).

mod delay;
mod five;
mod magnus;
mod reduced;

pub use delay::delayed_multipliers;
pub use five::FiveDegrees;
pub use magnus::{expm, monodromy};
pub use reduced::Reduced;

use crate::error::ChatterError;

/// Natural cycles in a period that the integration follows: a second of one core for the system of ten states.
const MOST_CYCLES: f64 = 1000.0;

/// Newtons in a kilogram-force; with millimetres and seconds the unit of the paper's tables.
const KGF: f64 = 9.80665;
/// kgf/mm in N/m; the same factor turns kgf·s/mm into N·s/m and kgf·s²/mm into kg.
const KGF_PER_MM: f64 = KGF * 1e3;

/// A reading of the paper's tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// Table 2 to the letter: 0.041 kgf·s²/mm (402 kg), h = 0.0159 kgf·s/mm.
    Table2Literal,
    /// Table 2 with the factor 10⁻³ of Table 1: 0.402 kg, h = 0.0225 kgf·s/mm.
    Table2Milli,
    /// Mass from the text's natural frequency of 120 Hz, damping the mean of Table 2.
    #[default]
    #[serde(rename = "f0_120hz")]
    F0_120Hz,
    /// Mass and damping fitted to the three thresholds of Fig. 3.
    Fig3Fit,
}

impl Preset {
    /// Mass [kgf·s²/mm] and damping [kgf·s/mm] of this reading.
    fn mass_and_damping(self) -> (f64, f64) {
        match self {
            Self::Table2Literal => (0.041, 0.0159),
            Self::Table2Milli => (0.041e-3, 0.0225),
            // (c + c_p)/(2 pi 120 Hz)^2 and the mean of h11 and h22.
            Self::F0_120Hz => (600.0 / (240.0 * std::f64::consts::PI).powi(2), 0.0192),
            Self::Fig3Fit => (1.5505e-3, 0.019622),
        }
    }
}

/// Least argument up to `greatest` at which `excess` turns positive: the first of `samples` that
/// does, then bisection, which needs no slope. `Some(0)` if it is positive at once.
fn first_unstable(
    greatest: f64,
    samples: u32,
    excess: impl Fn(f64) -> Result<f64, ChatterError>,
) -> Result<Option<f64>, ChatterError> {
    if excess(0.0)? >= 0.0 {
        return Ok(Some(0.0));
    }
    let mut stable = 0.0;
    for step in 1..=samples {
        let mut unstable = greatest * f64::from(step) / f64::from(samples);
        if excess(unstable)? < 0.0 {
            stable = unstable;
            continue;
        }
        while unstable - stable > 1e-9 * greatest {
            let middle = 0.5 * (stable + unstable);
            if excess(middle)? < 0.0 {
                stable = middle;
            } else {
                unstable = middle;
            }
        }
        return Ok(Some(0.5 * (stable + unstable)));
    }
    Ok(None)
}
