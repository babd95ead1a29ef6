//! What a decision rests on: the trials that were fitted, what each gains, and what the map shows beside them.

use super::constants::{GATE, SAME};
use super::diagnosing::Diagnosing;
use super::evidence::{Evidence, gain};
use super::trial::{Remainder, Trial};
use super::{EffectId, Forward, GapVerdict, NINETY, NotNamed, Transform};

/// A single effect with its gain over the nominal model.
#[derive(Clone, Debug)]
pub struct Single {
    /// Candidate.
    pub candidate: usize,
    /// Its id.
    pub id: EffectId,
    /// Score at the nominal fit.
    pub score: f64,
    /// Evidence.
    pub evidence: Evidence,
    /// Index among the refitted trials, where it was.
    pub trial: Option<usize>,
}

/// Structure in the map that its null does not have.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mapped {
    /// Where, and how strongly.
    pub words: String,
    /// Upper 90 % end of its root mean square over the level of the channel in which that is greatest.
    pub share: f64,
}

/// Everything on which a verdict rests.
pub struct Decision {
    /// The answer.
    pub verdict: GapVerdict,
    /// The nominal model, calibrated.
    pub base: Trial,
    /// Singles by falling gain.
    pub singles: Vec<Single>,
    /// Refitted trials: singles, then pairs.
    pub trials: Vec<Trial>,
    /// The chosen trial; `None` keeps the nominal model.
    pub chosen: Option<usize>,
    /// The trial that the data ask for and that a rule kept from being named.
    pub(super) refused: Option<usize>,
    /// What the dictionary finds beside the nominal model.
    pub before: Remainder,
    /// What it finds beside the chosen trial.
    pub after: Option<Remainder>,
    /// Why, in words.
    pub reasons: Vec<String>,
    /// Best models that were not named, with the rules that stood against them.
    pub not_named: Vec<NotNamed>,
    /// What a name pays for having been chosen among several processes.
    pub share: f64,
}

impl Decision {
    /// The trial that the diagnosis goes on with.
    pub fn model(&self) -> &Trial {
        self.chosen.map_or(&self.base, |index| &self.trials[index])
    }

    /// Gain of the strongest generic signature over the nominal model, the choice among many paid for.
    pub(super) fn generic_gain(&self) -> f64 {
        let choice = (self.before.dictionary.len().max(1) as f64).ln();
        gain(&self.before.evidence, &self.base.evidence) - choice - self.share
    }

    /// What the map of channels and covariates shows beside the nominal model beyond its null.
    pub(super) fn structure(&self, model: &dyn Forward) -> Option<Mapped> {
        let Remainder { scores, strongest, threshold, dictionary, .. } = &self.before;
        let (score, signature) = (scores.score.get(*strongest)?.abs(), dictionary.get(*strongest)?);
        if score <= *threshold || self.generic_gain() <= GATE {
            return None;
        }
        let words = format!(
            "structure is left: {} follows {} (score {score:.1}; one of a hundred data sets without a gap exceeds {threshold:.1})",
            signature.channel, signature.covariate
        );
        let measured = &model.frame().measured;
        let size = scores.estimate[*strongest].abs() * (1.0 + NINETY / score);
        // Relative to the level of each channel: of a comparison of logarithms the column is that already.
        let share = |channel: usize| {
            let (mut squares, mut levels, mut count) = (0.0, 0.0, 0.0_f64);
            let own = measured.observations.iter().enumerate().filter(|(_, own)| own.channel == channel);
            for (i, _) in own {
                squares += (size * signature.column[i]).powi(2);
                levels += self.base.fit.linear.raw[i].abs();
                count += 1.0;
            }
            let rms = (squares / count.max(1.0)).sqrt();
            if measured.channels[channel].transform == Transform::Log { rms } else { rms * count / levels }
        };
        let shares = (0..measured.channels.len()).map(share).filter(|share| !share.is_nan());
        Some(Mapped { words, share: shares.fold(0.0, f64::max) })
    }

    /// Gain of a trial over the nominal model, the choice among many paid for.
    pub fn gain_of(&self, trial: &Trial, candidates: usize) -> f64 {
        gain(&trial.evidence, &self.base.evidence) - price(candidates, trial.fit.active.len()) - self.share
    }

    /// Whether the strongest generic signature is nothing but the image of one of `effects`.
    pub(super) fn imaged(&self, context: Diagnosing<'_>, effects: &[usize]) -> bool {
        let base = &self.base.fit;
        let Some(signature) = self.before.dictionary.get(self.before.strongest) else { return false };
        let gram = super::trial::gram(context.model, context.basis, base, &[], &[signature.column.as_slice()], &[]);
        let cosine = super::score::scores(&gram, base.linear.nuisance.len(), &[]).cosine;
        let generic = cosine.nrows() - 1;
        effects.iter().any(|index| cosine[(*index, generic)].abs() > SAME)
    }
}

/// What it costs to have chosen `effects` among `candidates`: the logarithm of the number of such choices.
fn price(candidates: usize, effects: usize) -> f64 {
    let count = candidates as f64;
    (0..effects).map(|i| ((count - i as f64).max(1.0) / (i + 1) as f64).ln()).sum::<f64>().max(0.0)
}
