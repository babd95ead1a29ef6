//! Frequency responses as they were measured.

use crate::error::DynamicsError;
use crate::unit::Motion;
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::fmt;

/// Lines of one value from which on a response counts as constant (assumption: fewer are too few for a fit as well).
const LEAST_CONSTANT: usize = 20;

/// A direction of response or force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Direction {
    /// The first axis: feed in milling, chip thickness in turning.
    X,
    /// The second axis.
    Y,
}

impl Direction {
    /// Its place in a direction vector.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
        }
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
        })
    }
}

/// One response over one force.
#[derive(Clone, Debug, PartialEq)]
pub struct Frf {
    /// Direction of the response.
    pub response: Direction,
    /// Direction of the force.
    pub force: Direction,
    /// What was measured of the motion.
    pub motion: Motion,
    /// Displacement over force (m/N) at every frequency.
    pub receptance: Vec<Complex<f64>>,
    /// Coherence at every frequency, 0 … 1.
    pub coherence: Option<Vec<f64>>,
    /// Standard deviation of the real and of the imaginary part (of the unit of the motion over N as read, m/N in the end), where
    /// hits over time tell it.
    pub noise: Option<Vec<f64>>,
}

impl Frf {
    /// Its name: the direction of the response, then that of the force.
    pub fn name(&self) -> String {
        format!("{}{}", self.response, self.force)
    }

    /// Whether the response is in the direction of the force.
    pub fn is_direct(&self) -> bool {
        self.response == self.force
    }
}

/// What a tap test has measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The file, as messages call it.
    pub source: String,
    /// Frequencies (Hz), ascending and positive.
    pub frequencies: Vec<f64>,
    /// The functions, each over all frequencies.
    pub functions: Vec<Frf>,
    /// Averages behind each function, where they are known.
    pub averages: Option<u32>,
    /// Half of the last digit of the coherence as it was written: less of `1 − coherence` means nothing.
    pub coherence_digit: f64,
    /// Decay (1/s) of an exponential window over force and responses, which adds to the damping of every mode; 0 without.
    pub window_decay: f64,
    /// What was left out on the way and why.
    pub notes: Vec<String>,
}

impl Measurement {
    /// Frequency step (Hz), the median of the distances between lines.
    pub fn step(&self) -> f64 {
        let mut steps: Vec<f64> = self.frequencies.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    /// Turns raw responses of a motion into receptance, drops the line at rest and checks what all functions share.
    pub(crate) fn checked(mut self) -> Result<Self, DynamicsError> {
        let file = || self.source.clone();
        for pair in self.frequencies.windows(2) {
            if pair[1].partial_cmp(&pair[0]) != Some(std::cmp::Ordering::Greater) {
                return Err(DynamicsError::Order { file: file(), before: pair[0], value: pair[1] });
            }
        }
        let resting = self.frequencies.iter().filter(|frequency| **frequency <= 0.0).count();
        self.frequencies.drain(..resting);
        for (index, function) in self.functions.iter_mut().enumerate() {
            function.receptance.drain(..resting.min(function.receptance.len()));
            if let [first, .., _] = function.receptance[..]
                && function.receptance.iter().all(|value| *value == first)
                && function.receptance.len() >= LEAST_CONSTANT
            {
                let value = if first.im == 0.0 { format!("{:e}", first.re) } else { format!("{first:e}") };
                return Err(DynamicsError::Constant { file: file(), function: function.name(), value });
            }
            let order = function.motion.derivatives();
            for (value, frequency) in function.receptance.iter_mut().zip(&self.frequencies) {
                // Under an exponential window the response is that at i w + d.
                *value /= Complex::new(self.window_decay, TAU * frequency).powi(order);
            }
            if let Some(noise) = &mut function.noise {
                noise.drain(..resting.min(noise.len()));
                for (value, frequency) in noise.iter_mut().zip(&self.frequencies) {
                    *value /= Complex::new(self.window_decay, TAU * frequency).norm().powi(order);
                }
            }
            if let Some(coherence) = &mut function.coherence {
                coherence.drain(..resting.min(coherence.len()));
                for (value, frequency) in coherence.iter().zip(&self.frequencies) {
                    if !(0.0..=1.0).contains(value) {
                        let (file, frequency, value) = (self.source.clone(), *frequency, *value);
                        return Err(DynamicsError::Coherence { file, frequency, value });
                    }
                }
            }
            let lengths = [Some(function.receptance.len()), function.coherence.as_ref().map(Vec::len)];
            if lengths.iter().flatten().any(|length| *length != self.frequencies.len()) {
                let function = self.functions[index].name();
                return Err(DynamicsError::OtherFrequencies { file: self.source, function });
            }
        }
        for (index, function) in self.functions.iter().enumerate() {
            if self.functions[..index].iter().any(|other| other.name() == function.name()) {
                return Err(DynamicsError::Duplicate { file: file(), function: function.name() });
            }
        }
        if self.functions.is_empty() || self.frequencies.is_empty() {
            return Err(DynamicsError::Empty { file: file() });
        }
        Ok(self)
    }
}
