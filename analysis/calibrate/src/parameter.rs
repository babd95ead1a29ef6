//! Parameters in working coordinates, each with its prior.

use crate::normal::ln_density;
use toolroom_wear::{LARGEST_CONTRAST, LARGEST_TILT};

/// How a value of the parameter file and its working coordinate u hang together. Priors are normal in u, and the maximum
/// of the posterior density is taken in u.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// `u = ln value`.
    Logarithm,
    /// `u = value`.
    Plain,
    /// `u = logit(value/0.95)`, the contrast of the wear stages.
    Contrast,
    /// `u = atanh(value/0.95)`, the tilt of the wear stages in shares of `1 - stage_contrast`.
    Tilt,
}

impl Scale {
    /// The value of a working coordinate.
    pub fn value(self, u: f64) -> f64 {
        match self {
            Self::Logarithm => u.exp(),
            Self::Plain => u,
            Self::Contrast => LARGEST_CONTRAST / (1.0 + (-u).exp()),
            Self::Tilt => LARGEST_TILT * u.tanh(),
        }
    }

    /// The working coordinate of a value.
    pub fn coordinate(self, value: f64) -> f64 {
        match self {
            Self::Logarithm => value.ln(),
            Self::Plain => value,
            Self::Contrast => (value / (LARGEST_CONTRAST - value)).ln(),
            Self::Tilt => (value / LARGEST_TILT).atanh(),
        }
    }
}

/// A normal distribution in the working coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Prior {
    /// A normal prior.
    pub fn new(mean: f64, deviation: f64) -> Self {
        Self { mean, deviation }
    }

    /// Logarithm of its density.
    pub fn ln_density(&self, u: f64) -> f64 {
        ln_density(u, self.mean, self.deviation)
    }
}

/// A quantity that the data are to tell.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `group.key` of the parameter file, or `edge_scatter` and `reading_noise`, which are none of the law's.
    pub name: String,
    /// Unit of its value in files; `1` for a ratio.
    pub unit: &'static str,
    /// Working coordinate.
    pub scale: Scale,
    /// What is known of it beforehand.
    pub prior: Prior,
    /// What would have to be measured to tell it.
    pub lift: String,
}

impl Parameter {
    /// A parameter with a prior in its working coordinate.
    pub fn new(name: impl Into<String>, unit: &'static str, scale: Scale, prior: Prior, lift: &str) -> Self {
        Self { name: name.into(), unit, scale, prior, lift: lift.to_owned() }
    }
}
