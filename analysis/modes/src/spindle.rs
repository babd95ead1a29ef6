//! The spindle that a tool is put on.

use super::blank::tip_of_blank;
use super::swap::{tip, tip_at};
use super::swap_error::SwapError;
use super::tip::Tip;
use super::tool::Tool;
use toolroom_dynamics::{Blank, Measurement};
use toolroom_lobes::Structure;

/// What is known of a spindle.
#[derive(Clone, Debug)]
pub enum Spindle {
    /// Its modes at the face.
    Modes(Box<Structure>),
    /// Taps on a blank that it held.
    Tapped(Box<TappedBlank>),
}

/// Taps on a blank in a spindle.
#[derive(Clone, Debug)]
pub struct TappedBlank {
    /// The responses at two points.
    pub measured: Measurement,
    /// Averages behind each response, where its file does not say it.
    pub averages: Option<u32>,
    /// The blank, and where its second point is.
    pub blank: Blank,
    /// Direction of the taps: feed and normal, of length 1.
    pub direction: [f64; 2],
}

impl Spindle {
    /// The response at the tip of `tool` within `range` (Hz), and its direction.
    ///
    /// # Errors
    /// [`SwapError`]: modes or taps that do not tell it, a receptance that is infinite.
    pub fn tip(&self, tool: &Tool, range: [f64; 2]) -> Result<(Measurement, [f64; 2]), SwapError> {
        match self {
            Self::Modes(structure) => tip(structure, tool, range),
            Self::Tapped(tapped) => {
                let (measured, _) = tip_of_blank(&tapped.measured, tapped.averages, &tapped.blank, tool, range)?;
                Ok((measured, tapped.direction))
            }
        }
    }

    /// Tool and spindle at those of `frequencies` (Hz) that lie within `range`, or at the lines of the taps there.
    ///
    /// # Errors
    /// As [`Spindle::tip`].
    pub fn tip_at(&self, frequencies: &[f64], tool: &Tool, range: [f64; 2]) -> Result<Tip, SwapError> {
        match self {
            Self::Modes(structure) => {
                let inside = frequencies.iter().copied().filter(|line| (range[0]..=range[1]).contains(line));
                tip_at(structure, tool, inside.collect())
            }
            Self::Tapped(tapped) => {
                tip_of_blank(&tapped.measured, tapped.averages, &tapped.blank, tool, range).map(|(_, tip)| tip)
            }
        }
    }
}
