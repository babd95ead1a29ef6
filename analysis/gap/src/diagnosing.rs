//! What every step of a diagnosis looks at.

use super::left_out::LeftOut;
use super::trial::{Remainder, Trial, remainder};
use super::{Basis, Fit, Forward};

/// The model, what it is judged by, and how groups are left out: the same for every step of one diagnosis.
#[derive(Clone, Copy)]
pub(super) struct Diagnosing<'a> {
    /// The nominal model over the records.
    pub model: &'a dyn Forward,
    /// Noise and scatter.
    pub basis: &'a Basis,
    /// Groups that are left out together.
    pub folds: &'a [Vec<usize>],
    /// Seed of everything that is drawn.
    pub seed: u64,
}

impl<'a> Diagnosing<'a> {
    /// Number of candidates among which an effect is chosen.
    pub fn candidates(self) -> usize {
        self.model.frame().candidates.len()
    }

    /// The fit of the `active` candidates, started from `start_fit`, with its evidence.
    pub fn trial(self, start_fit: &Fit, active: &[usize]) -> Trial {
        Trial::new(self.model, self.basis, self.folds, start_fit, active)
    }

    /// The evidence of a finished fit.
    pub fn trial_of(self, fit: Fit) -> Trial {
        Trial::of(self.model, self.basis, self.folds, fit)
    }

    /// What the generic dictionary finds beside a trial.
    pub fn remainder(self, trial: &Trial) -> Remainder {
        remainder(self.model, self.basis, self.folds, trial, self.seed)
    }

    /// Residuals of a trial, every group predicted without itself.
    pub fn left_out(self, trial: &Trial) -> LeftOut {
        LeftOut::of(self.model, self.basis, trial, self.folds)
    }

    /// [`Diagnosing::left_out`] with what other groups in the fit would have made of it.
    pub fn left_out_with_moves(self, trial: &Trial) -> LeftOut {
        LeftOut::with_moves(self.model, self.basis, trial, self.folds)
    }
}
