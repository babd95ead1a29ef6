//! How probable a named effect is.
//!
//! Models are weighted by their gain: what they raise the log posterior density by, the choice among many paid for. That
//! weight is right where the cause is among the models and noise is what its sheet says. In shops of other making a name of a low
//! score is wrong more often than its weight says, so that the weight is multiplied by the share of names of its
//! score that were right.

use super::EffectId;
use super::constants::{FORM, PROBABLE};
use super::decision::{Decision, Single};
use super::diagnosing::Diagnosing;
use super::evidence::gain;
use super::stops;

/// Upper end of a score, in standard deviations, and the share of names up to it that were right (1). Source: the 1416 names of
/// the published cases of the blind benchmark with a weight of at least one half (docs/gap-benchmark, 2026-11-27): 22 of 29, 22 of
/// 25, 68 of 70; above that 1292 of 1292.
const RIGHT: [(f64, f64); 3] = [(5.0, 0.76), (5.5, 0.88), (6.5, 0.97)];

/// The probability that is printed with a name of the effect `id` with this score.
pub(super) fn printed(probabilities: &[(EffectId, f64)], id: EffectId, score: f64) -> f64 {
    let weight = probabilities.iter().find(|(own, _)| *own == id).map_or(0.0, |(_, weight)| *weight);
    let right = RIGHT.iter().find(|(end, _)| score.abs() < *end).map_or(1.0, |(_, share)| *share);
    (weight * right).min(PROBABLE)
}

/// Weight of each id: models weighted by their gain, with the nominal model and the best generic signature among them.
pub(super) fn inclusion(context: Diagnosing<'_>, decision: &Decision) -> Vec<(EffectId, f64)> {
    let (model, count) = (context.model, context.candidates());
    let mut models: Vec<(Vec<usize>, f64)> = vec![(Vec::new(), 0.0)];
    if !decision.imaged(context, &decision.model().fit.active) {
        let form = FORM * decision.gain_of(decision.model(), count);
        models.push((Vec::new(), decision.generic_gain() - form));
    }
    let single = |single: &Single| {
        let price = (count.max(1) as f64).ln() + decision.share;
        (vec![single.candidate], gain(&single.evidence, &decision.base.evidence) - price)
    };
    models.extend(decision.singles.iter().filter(|single| single.evidence.admissible).map(single));
    let pairs = decision.trials.iter().filter(|trial| trial.fit.active.len() > 1 && trial.evidence.admissible);
    models.extend(pairs.map(|trial| (trial.fit.active.clone(), decision.gain_of(trial, count))));
    // What the scatter of its rows contradicts is no rival, however well it follows their means.
    let contradicted = stops::contradicted(context, decision.model());
    models.retain(|(active, _)| !active.iter().any(|index| contradicted.contains(index)));
    let greatest = models.iter().map(|(_, value)| *value).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = models.iter().map(|(_, value)| (value - greatest).exp()).sum();
    let ids: Vec<EffectId> = model.frame().candidates.iter().map(|candidate| candidate.id).collect();
    let with = |id: EffectId| {
        let has = |active: &Vec<usize>| active.iter().any(|index| ids[*index] == id);
        models.iter().filter(|(active, _)| has(active)).map(|(_, value)| (value - greatest).exp() / total).sum::<f64>()
    };
    ids.iter().map(|id| (*id, with(*id))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_a_low_score_are_printed_with_the_share_of_them_that_was_right() {
        let id = EffectId::MICRO_STOPS;
        let of = |weight, score| printed(&[(id, weight)], id, score);
        assert_eq!([of(1.0, 4.6), of(1.0, -5.2), of(1.0, 6.0), of(1.0, 46.0)], [0.76, 0.88, 0.97, PROBABLE]);
        assert_eq!((of(0.5, 9.0), of(0.5, 4.6), printed(&[], id, 9.0)), (0.5, 0.38, 0.0));
    }
}
