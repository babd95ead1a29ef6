//! Discrepancy: how far the equations of a model are off as a smooth function of the cut, estimated from the data.
//!
//! The form allowance has a fixed scale and is a polynomial. With many groups every other smooth form error becomes
//! significant, and some effect of the catalogue looks a little like it. Here every class of channels has a Gaussian
//! process of low rank beside its allowance, over the conditions, the land and the age of the edge, and never over
//! the calendar, machines, lots, shifts, parts or coolants: a form error is a function of the cut. Amplitudes follow
//! from the marginal likelihood beside all candidates, so that an effect of the catalogue is not taken for it. Where
//! the data ask for none, the model stays as it is.
//!
//! # Source
//! Kennedy & O'Hagan 2001; Solin & Särkkä 2020 (low rank).

use super::constants::{DISCREPANT, LENGTHS};
use super::fit::offset_residual;
use super::gram::normal_equations;
use super::reframed::Reframed;
use super::{Basis, Discrepancy, Fit, Forward, Surface};
use toolroom_evidence::{amplitudes, matern_columns};

/// A model with the discrepancy that the data ask for.
pub(super) struct Widened<'a> {
    /// The model with the surfaces of the discrepancy among its own.
    pub model: Reframed<'a>,
    /// Amplitude of every class that has one, relative, over the scale of its prior.
    pub found: Vec<(&'static str, f64, f64)>,
}

impl<'a> Widened<'a> {
    /// `model` with its discrepancy at the nominal fit `fit`; `None` where the data ask for none.
    pub fn new(model: &'a dyn Forward, basis: &Basis, fit: &Fit) -> Option<Self> {
        let discrepancy = model.frame().discrepancy.as_ref()?;
        let tried = LENGTHS.iter().map(|length| Tried::new(model, basis, fit, discrepancy, *length));
        let best = tried.max_by(|a, b| a.gain.total_cmp(&b.gain)).filter(|best| best.gain > DISCREPANT)?;
        let mut frame = model.frame().clone();
        let mut found = Vec::new();
        for ((class, surfaces), amplitude) in discrepancy.classes.iter().zip(best.surfaces).zip(best.amplitudes) {
            if amplitude > 0.0 {
                found.push((class.name, amplitude * class.scale, amplitude));
                let scaled = |surface: Surface| Surface { deviation: amplitude * surface.deviation, ..surface };
                frame.surfaces.extend(surfaces.into_iter().map(scaled));
            }
        }
        Some(Self { model: Reframed { model, frame }, found })
    }

    /// What a reader has to know of it.
    pub fn note(&self) -> String {
        let words_of = |(name, share, _): &(&str, f64, f64)| format!("{name} by {:.1} %", 100.0 * share);
        let all: Vec<String> = self.found.iter().map(words_of).collect();
        format!("the equations are off by a smooth function of the cut: {}", all.join(", "))
    }

    /// Whether an amplitude exceeds the scale of its prior.
    pub fn far(&self) -> bool {
        self.found.iter().any(|(_, _, amplitude)| *amplitude > 1.0)
    }
}

/// Amplitudes at one length scale.
struct Tried {
    surfaces: Vec<Vec<Surface>>,
    amplitudes: Vec<f64>,
    gain: f64,
}

impl Tried {
    fn new(model: &dyn Forward, basis: &Basis, fit: &Fit, discrepancy: &Discrepancy, length: f64) -> Self {
        let features = matern_columns(&discrepancy.points, length);
        let frame = model.frame();
        let surfaces: Vec<Vec<Surface>> =
            discrepancy.classes.iter().map(|class| class.surfaces(&frame.measured, &features)).collect();
        let linear = &fit.linear;
        let deviations: Vec<Vec<f64>> = surfaces
            .iter()
            .flatten()
            .map(|surface| super::linear::surface_column(frame, surface, &linear.raw))
            .collect();
        let columns: Vec<&[f64]> =
            linear.nuisance.iter().chain(linear.effects.iter()).chain(&deviations).map(Vec::as_slice).collect();
        let residual = offset_residual(model, linear, &[]);
        let gram =
            normal_equations(&frame.measured, &basis.noise, linear, &columns, &residual, &basis.local_scale, &[]);
        let effects = linear.effects.iter().map(|_| super::basis::CANDIDATE_PRECISION);
        let precision: Vec<f64> = linear.nuisance.iter().map(|_| 1.0).chain(effects).collect();
        let mut first = precision.len();
        let of = |surfaces: &Vec<Surface>| {
            let range = first..first + surfaces.len();
            first = range.end;
            range
        };
        let classes: Vec<_> = surfaces.iter().map(of).collect();
        let (amplitudes, gain) = amplitudes(&gram, &precision, &classes);
        Self { surfaces, amplitudes, gain }
    }
}
