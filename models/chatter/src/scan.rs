//! Where a sampled function changes sign, with the samples closer where it comes near zero between them.

use crate::error::ChatterError;

/// Even steps in which a range is sampled at first, where an evaluation costs little (assumption: the humps of a spectral radius
/// are wider).
pub(crate) const STEPS: usize = 48;
/// How often a step is halved where the function may reach zero within it.
const HALVINGS: u32 = 7;

/// Brackets of the sign changes of `f` on `0 … greatest`, by ascending argument; `first` is the value at zero.
///
/// The range is sampled in even steps. A step whose ends have one sign is halved where the chords beside it,
/// continued into it, meet beyond zero: there a hump that is narrower than the step can hide.
pub(crate) struct SignChanges<F> {
    f: F,
    greatest: f64,
    steps: usize,
    /// Samples that are known, ascending, and the step to which they reach.
    samples: Vec<(f64, f64)>,
    step: usize,
}

impl<F: FnMut(f64) -> Result<f64, ChatterError>> SignChanges<F> {
    pub fn new(f: F, first: f64, greatest: f64, steps: usize) -> Self {
        Self { f, greatest, steps, samples: vec![(0.0, first)], step: 0 }
    }

    /// The sample after `step` steps.
    fn sample(&mut self, step: usize) -> Result<(f64, f64), ChatterError> {
        let x = self.greatest * step as f64 / self.steps as f64;
        Ok((x, (self.f)(x)?))
    }

    fn advance(&mut self) -> Result<Vec<[(f64, f64); 2]>, ChatterError> {
        let step = self.step;
        self.step += 1;
        while self.samples.len() < (step + 3).min(self.steps + 1) {
            let sample = self.sample(self.samples.len())?;
            self.samples.push(sample);
        }
        let (from, to) = (self.samples[step], self.samples[step + 1]);
        let before = step.checked_sub(1).map(|before| self.samples[before]);
        let after = self.samples.get(step + 2).copied();
        let mut found = Vec::new();
        self.search([before, Some(from), Some(to), after], HALVINGS, &mut found)?;
        Ok(found)
    }

    /// Brackets between the two middle ones of four samples.
    fn search(
        &mut self,
        around: [Option<(f64, f64)>; 4],
        halvings: u32,
        found: &mut Vec<[(f64, f64); 2]>,
    ) -> Result<(), ChatterError> {
        let [before, Some(from), Some(to), after] = around else { return Ok(()) };
        if (from.1 > 0.0) != (to.1 > 0.0) {
            found.push([from, to]);
            return Ok(());
        }
        if halvings == 0 || !may_reach_zero(before, from, to, after) {
            return Ok(());
        }
        let x = 0.5 * (from.0 + to.0);
        let middle = (x, (self.f)(x)?);
        self.search([before, Some(from), Some(middle), Some(to)], halvings - 1, found)?;
        self.search([Some(from), Some(middle), Some(to), after], halvings - 1, found)
    }
}

impl<F: FnMut(f64) -> Result<f64, ChatterError>> Iterator for SignChanges<F> {
    /// The brackets in the next step.
    type Item = Result<Vec<[(f64, f64); 2]>, ChatterError>;

    fn next(&mut self) -> Option<Self::Item> {
        (self.step < self.steps).then(|| self.advance())
    }
}

/// Whether chords continued from either side meet beyond zero between `from` and `to`, which have one sign.
pub(crate) fn may_reach_zero(
    before: Option<(f64, f64)>,
    from: (f64, f64),
    to: (f64, f64),
    after: Option<(f64, f64)>,
) -> bool {
    // Towards zero is upwards.
    let up = if from.1 > 0.0 { -1.0 } else { 1.0 };
    let (left, right, width) = (up * from.1, up * to.1, to.0 - from.0);
    let chord = |a: (f64, f64), b: (f64, f64)| up * (b.1 - a.1) / (b.0 - a.0);
    let inner = (right - left) / width;
    let rise = before.map_or(inner.max(0.0), |before| chord(before, from));
    let fall = -after.map_or(inner.min(0.0), |after| chord(to, after));
    // Lines left + rise x and right + fall (width − x).
    if rise + fall <= 0.0 {
        return false;
    }
    let x = ((right - left + fall * width) / (rise + fall)).clamp(0.0, width);
    (left + rise * x).min(right + fall * (width - x)) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changes(f: impl Fn(f64) -> f64) -> Vec<f64> {
        let first = f(0.0);
        let scan = SignChanges::new(|x| Ok(f(x)), first, 1.0, STEPS);
        scan.flat_map(Result::unwrap).map(|[a, b]| 0.5 * (a.0 + b.0)).collect()
    }

    #[test]
    fn a_hump_narrower_than_a_step_is_found() {
        // Above zero from 0.5037 to 0.5063, an eighth of a step.
        let hump = |x: f64| 1.3e-3f64.powi(2) - (x - 0.505) * (x - 0.505);
        let found = changes(hump);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0] - 0.5037).abs() < 2e-3 && (found[1] - 0.5063).abs() < 2e-3, "{found:?}");
        assert_eq!(changes(|x| -hump(x)).len(), 2);
        assert!(changes(|x| -1e-5 - (x - 0.505) * (x - 0.505)).is_empty());
    }

    #[test]
    fn every_change_of_a_wave_is_found_in_order() {
        let found = changes(|x| (40.0 * x).sin() - 0.3);
        assert_eq!(found.len(), 13, "{found:?}");
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
