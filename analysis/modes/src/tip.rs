//! The tip of a tool at a number of lines, over any joint.

use super::swap_error::SwapError;
use super::tool::Tool;
use nalgebra::Complex;
use std::f64::consts::TAU;
use toolroom_dynamics::{BaseMode, Body, Joint, Receptance, base};

/// Bodies of a tool and receptances of the spindle that holds it, line by line.
#[derive(Clone, Debug)]
pub struct Tip {
    /// Frequencies (Hz), ascending.
    pub frequencies: Vec<f64>,
    /// The tool with free ends.
    pub bodies: Vec<Body>,
    /// The spindle at its face.
    pub faces: Vec<Receptance>,
}

impl Tip {
    /// A tool on a spindle of known modes.
    ///
    /// # Errors
    /// [`SwapError::Infinite`] where the receptance of the tool is.
    pub fn of_modes(modes: &[BaseMode], tool: &Tool, frequencies: Vec<f64>) -> Result<Self, SwapError> {
        let body = |frequency: &f64| tool.body(TAU * frequency).ok_or(SwapError::Infinite { frequency: *frequency });
        let bodies = frequencies.iter().map(body).collect::<Result<_, _>>()?;
        let faces = frequencies.iter().map(|frequency| base(modes, TAU * frequency)).collect();
        Ok(Self { frequencies, bodies, faces })
    }

    /// The line at a frequency (Hz), to a millionth.
    pub fn line(&self, frequency: f64) -> Option<usize> {
        let place = self.frequencies.partition_point(|line| *line < frequency * (1.0 - 1e-6));
        self.frequencies.get(place).filter(|line| (**line - frequency).abs() <= 1e-6 * frequency).map(|_| place)
    }

    /// Response (m/N) of the tip to a force there at some lines, over `joint` where there is one.
    ///
    /// # Errors
    /// [`SwapError::Infinite`] where it is none.
    pub fn at(&self, lines: &[usize], joint: Option<&Joint>) -> Result<Vec<Complex<f64>>, SwapError> {
        let value = |line: &usize| {
            let found = self.bodies[*line].on(&self.faces[*line], joint).map(|receptance| receptance[(0, 0)]);
            let finite = found.filter(|value| value.re.is_finite() && value.im.is_finite());
            finite.ok_or(SwapError::Infinite { frequency: self.frequencies[*line] })
        };
        lines.iter().map(value).collect()
    }

    /// Response (m/N) at all lines.
    ///
    /// # Errors
    /// As [`Tip::at`].
    pub fn all(&self, joint: Option<&Joint>) -> Result<Vec<Complex<f64>>, SwapError> {
        self.at(&(0..self.frequencies.len()).collect::<Vec<_>>(), joint)
    }
}
