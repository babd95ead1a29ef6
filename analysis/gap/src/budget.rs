//! What the gap is made of: shares of its sum of squares that each stage of explanation takes away.
//!
//! The gap is the sum of squares as the fit sees it: noise and scatter between groups weigh readings, and what went far from
//! its prior is paid for. Stages follow each other from the nominal constants on: the named effects by the sizes that they have
//! beside the calibration, the calibration, the form of the equations, and what nothing explains. Before the effects the calibration
//! might go as far as to imitate them; an effect that is named has been told from it. Each counts only what it explains beyond
//! the squares that so many numbers take of noise alone, so that a model that is right has nothing but noise.

use super::decision::Decision;
use super::evidence::{EFFECT_PRIOR, solution};
use super::gram::{factor, part, part_column};
use super::{Budget, Forward, Gram};

/// A stage of explanation.
#[derive(Clone, Copy)]
struct Stage {
    /// Sum of squares that it leaves.
    left: f64,
    /// Squares that its numbers take of noise alone: their effective number.
    chance: f64,
}

impl Stage {
    /// The columns `at` of `gram`, of which those below `nuisance` have the prior of a nuisance.
    fn of(gram: &Gram, at: &[usize], nuisance: usize) -> Self {
        Self::of_first(gram, at, at.len(), nuisance)
    }

    /// The first `count` of the columns `at` by the values that they have beside the others.
    fn of_first(gram: &Gram, at: &[usize], count: usize, nuisance: usize) -> Self {
        let prior = |i: usize| if at[i] < nuisance { 1.0 } else { EFFECT_PRIOR.powi(-2) };
        let mut matrix = part(&gram.total, at, at);
        (0..at.len()).for_each(|i| matrix[(i, i)] += prior(i));
        let mut x = solution(gram, at, nuisance, &[]);
        (count..at.len()).for_each(|i| x[i] = 0.0);
        let right = part_column(&gram.total, at, gram.last());
        let left = gram.total[(gram.last(), gram.last())] - 2.0 * right.dot(&x) + x.dot(&(&matrix * &x));
        let kept = factor(matrix).inverse_diagonal();
        let chance = (0..count).map(|i| 1.0 - prior(i) * kept[i]).sum();
        Self { left, chance }
    }

    /// This stage where it explains more than the one before, else that.
    fn after(self, before: Self) -> Self {
        Self { left: self.left.min(before.left), chance: self.chance.max(before.chance) }
    }

    /// What it explains beyond the stage before and beyond chance.
    fn beyond(self, before: Self) -> f64 {
        (before.left - self.left - (self.chance - before.chance)).max(0.0)
    }
}

/// Shares of the gap by cause.
pub(super) fn budget(model: &dyn Forward, decision: &Decision) -> Budget {
    let (frame, base, chosen) = (model.frame(), &decision.base, decision.model());
    let allowance = frame.allowances();
    let calibration: Vec<usize> = (0..allowance.len()).filter(|i| !allowance[*i]).collect();
    let everything: Vec<usize> = (0..allowance.len()).collect();
    let beside = |columns: &[usize]| -> Vec<usize> {
        chosen.fit.active.iter().map(|index| chosen.shared + index).chain(columns.iter().copied()).collect()
    };
    let squares = base.gram.total[(base.gram.last(), base.gram.last())];
    let nominal = Stage { left: squares, chance: 0.0 };
    let known = beside(&calibration);
    let with_effects = Stage::of_first(&chosen.gram, &known, chosen.fit.active.len(), chosen.shared).after(nominal);
    let calibrated = Stage::of(&chosen.gram, &known, chosen.shared).after(with_effects);
    let with_form = Stage::of(&chosen.gram, &beside(&everything), chosen.shared).after(calibrated);
    let measured = &frame.measured;
    let readings: usize = measured.fitted_groups().map(|group| measured.spans[group].len()).sum();
    let unexplained = (with_form.left - (readings as f64 - with_form.chance)).max(0.0);
    let explained =
        [calibrated.beyond(with_effects), with_effects.beyond(nominal), with_form.beyond(calibrated), unexplained];
    let share = |value: f64| if nominal.left > 0.0 { value / nominal.left } else { f64::NAN };
    let [calibration, effects, form_allowance, unexplained] = explained.map(share);
    let noise_floor = share(nominal.left) - calibration - effects - form_allowance - unexplained;
    Budget { calibration, form_allowance, effects, unexplained, noise_floor }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// Two columns of length ten, and a residual that is `x` times the first and a remainder of square 20.
    fn gram(x: f64) -> Gram {
        let total = DMatrix::from_row_slice(
            3,
            3,
            &[100.0, 0.0, 100.0 * x, 0.0, 100.0, 0.0, 100.0 * x, 0.0, 100.0 * x * x + 20.0],
        );
        let lengths = total.diagonal();
        Gram { folds: Vec::new(), total, log_determinant: 0.0, lengths }
    }

    #[test]
    fn what_a_number_explains_by_chance_is_no_share_of_it() {
        for (x, explained) in [(0.0, 0.0), (0.1, 0.0), (1.0, 100.0 * 100.0 / 101.0 - 100.0 / 101.0)] {
            let gram = gram(x);
            let nominal = Stage { left: gram.total[(2, 2)], chance: 0.0 };
            let stage = Stage::of(&gram, &[0], 2).after(nominal);
            assert!((stage.chance - 100.0 / 101.0).abs() < 1e-12);
            assert!((stage.beyond(nominal) - explained).abs() < 1e-9, "{x}: {}", stage.beyond(nominal));
        }
    }

    #[test]
    fn what_an_effect_explains_is_its_share_though_calibration_alone_could_go_as_far() {
        // A constant and an effect that move the readings alike.
        let total = DMatrix::from_element(3, 3, 10_000.0);
        let lengths = total.diagonal();
        let gram = Gram { folds: Vec::new(), total, log_determinant: 0.0, lengths };
        let nominal = Stage { left: 10_000.0, chance: 0.0 };
        let alone = Stage::of(&gram, &[0], 1).after(nominal).beyond(nominal);
        let effects = Stage::of_first(&gram, &[1, 0], 1, 1).after(nominal);
        let calibration = Stage::of(&gram, &[1, 0], 1).after(effects).beyond(effects);
        assert!(alone > 9_990.0, "{alone}");
        assert!(effects.beyond(nominal) > 9.0 * calibration, "{} beside {calibration}", effects.beyond(nominal));
    }
}
