//! Where a sampled function changes sign, with the samples closer where it comes near zero between them.

/// Even steps in which a range is sampled at first, where an evaluation costs little (assumption: the humps of a spectral radius
/// are wider).
pub const STEPS: usize = 48;
/// How often a step is halved where the function may reach zero within it.
const HALVINGS: u32 = 7;

/// An argument and the value there.
pub type Sample = (f64, f64);
/// Two samples before a step, its two ends and two samples behind it, where they are known.
pub type Around = [Option<Sample>; 6];

/// Brackets of the sign changes of `f` on `0 … greatest`, by ascending argument; `first` is the value at zero.
///
/// The range is sampled in even steps. A step whose ends have one sign is halved where the chords beside it, or
/// the parabolas where they are steeper, continued into it meet beyond zero: there a hump that is narrower than the step can hide.
pub struct SignChanges<F> {
    f: F,
    greatest: f64,
    steps: usize,
    /// Samples that are known, ascending, and the step to which they reach.
    samples: Vec<Sample>,
    step: usize,
}

impl<E, F: FnMut(f64) -> Result<f64, E>> SignChanges<F> {
    /// A search of `f`, which is `first` at zero, up to `greatest` in even `steps`.
    pub fn new(f: F, first: f64, greatest: f64, steps: usize) -> Self {
        Self { f, greatest, steps, samples: vec![(0.0, first)], step: 0 }
    }

    /// The sample after `step` steps.
    fn sample(&mut self, step: usize) -> Result<Sample, E> {
        let x = self.greatest * step as f64 / self.steps as f64;
        Ok((x, (self.f)(x)?))
    }

    fn advance(&mut self) -> Result<Vec<[Sample; 2]>, E> {
        let step = self.step;
        self.step += 1;
        while self.samples.len() < (step + 3).min(self.steps + 1) {
            let sample = self.sample(self.samples.len())?;
            self.samples.push(sample);
        }
        let known = |offset: usize| (step + offset).checked_sub(2).and_then(|i| self.samples.get(i)).copied();
        let mut around = [0, 1, 2, 3, 4, 5].map(known);
        if around[4].is_none() {
            around[4] = self.beyond(around);
        }
        let mut found = Vec::new();
        self.search(around, HALVINGS, &mut found)?;
        Ok(found)
    }

    /// The sample behind the last step, where it decides whether a hump hides in that step: by its own ends a function that
    /// has turned back within it looks as if it only fell. A search that fails out there decides nothing.
    fn beyond(&mut self, around: Around) -> Option<Sample> {
        let [further, before, from, to, ..] = around;
        let (from, to) = (from?, to?);
        let up = if from.1 > 0.0 { -1.0 } else { 1.0 };
        let slope = before.map_or(up * chord(from, to), |before| steepest(up, from, before, further, to.0));
        let reaches = (from.1 > 0.0) == (to.1 > 0.0) && up * from.1 + slope * (to.0 - from.0) > 0.0;
        if reaches { self.sample(self.steps + 1).ok() } else { None }
    }

    /// Brackets between the two middle ones of six samples.
    fn search(&mut self, around: Around, halvings: u32, found: &mut Vec<[Sample; 2]>) -> Result<(), E> {
        let [further, before, Some(from), Some(to), after, beyond] = around else { return Ok(()) };
        if (from.1 > 0.0) != (to.1 > 0.0) {
            found.push([from, to]);
            return Ok(());
        }
        if halvings == 0 || !may_reach_zero(around) {
            return Ok(());
        }
        let x = 0.5 * (from.0 + to.0);
        let middle = (x, (self.f)(x)?);
        self.search([further, before, Some(from), Some(middle), Some(to), after], halvings - 1, found)?;
        self.search([before, Some(from), Some(middle), Some(to), after, beyond], halvings - 1, found)
    }
}

impl<E, F: FnMut(f64) -> Result<f64, E>> Iterator for SignChanges<F> {
    /// The brackets in the next step.
    type Item = Result<Vec<[Sample; 2]>, E>;

    fn next(&mut self) -> Option<Self::Item> {
        (self.step < self.steps).then(|| self.advance())
    }
}

/// Slope of the chord between two samples.
fn chord(a: Sample, b: Sample) -> f64 {
    (b.1 - a.1) / (b.0 - a.0)
}

/// Slope, times `up` and away from `before`, with which a line from the sample `at` reaches at `end` what the chord behind it
/// reaches, or where the function bends upwards the parabola through the three samples up to it: a radius that turns back to
/// one bends on the way there, and its last chord says too little.
fn steepest(up: f64, at: Sample, before: Sample, further: Option<Sample>, end: f64) -> f64 {
    let last = chord(before, at);
    let bend = further.map_or(0.0, |further| (last - chord(further, before)) / (at.0 - further.0));
    // Newton's form; towards `end`, whichever side it lies on.
    let way = (end - at.0).signum();
    way * up * last + (up * bend).max(0.0) * (end - before.0).abs()
}

/// Whether a function may reach zero between the two middle ones of six samples, which have one sign: lines from either side
/// with the slopes of `steepest` meet beyond zero.
pub fn may_reach_zero([further, before, from, to, after, beyond]: Around) -> bool {
    let (Some(from), Some(to)) = (from, to) else { return false };
    // Towards zero is upwards.
    let up = if from.1 > 0.0 { -1.0 } else { 1.0 };
    let (left, right, width) = (up * from.1, up * to.1, to.0 - from.0);
    let inner = (right - left) / width;
    let rise = before.map_or(inner.max(0.0), |before| steepest(up, from, before, further, to.0));
    let fall = after.map_or(-inner.min(0.0), |after| steepest(up, to, after, beyond, from.0));
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
        let scan = SignChanges::new(|x| Ok::<_, std::convert::Infallible>(f(x)), first, 1.0, STEPS);
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
    fn a_hump_in_the_last_step_is_found() {
        // Above zero from 0.9837 to 0.9963; the last step is 0.9792 to 1.
        let hump = |x: f64| 6.3e-3f64.powi(2) - (x - 0.99) * (x - 0.99);
        let found = changes(hump);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0] - 0.9837).abs() < 2e-3 && (found[1] - 0.9963).abs() < 2e-3, "{found:?}");
        assert!(changes(|x| if x > 1.0 { f64::NAN } else { hump(x) - 1e-3 }).is_empty());
    }

    #[test]
    fn every_change_of_a_wave_is_found_in_order() {
        let found = changes(|x| (40.0 * x).sin() - 0.3);
        assert_eq!(found.len(), 13, "{found:?}");
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
