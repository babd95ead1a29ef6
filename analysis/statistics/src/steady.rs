//! Steady state: where the start of a run ends to matter, and how well the mean of values that depend on each other is known.

use crate::{Interval, Moments, student};

/// Values of a run in their order, joined into batches of equal size.
///
/// When there are too many batches, they are joined by two, so that memory does not grow with the run. Values that do not
/// fill the last batch are left out.
///
/// # Examples
/// ```
/// use toolroom_statistics::Batched;
/// let mut batched = Batched::by(2);
/// (0..7).for_each(|i| batched.push(f64::from(i), f64::from(10 * i)));
/// assert_eq!(batched.means(), [0.5, 2.5, 4.5]);
/// assert_eq!(batched.end(2), Some(30.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Batched {
    size: u64,
    means: Vec<f64>,
    ends: Vec<f64>,
    sum: f64,
    count: u64,
}

impl Batched {
    /// Most batches that are kept. Half of that is what a long run has at least: enough to place the end of the start to
    /// 0.05 % of the run.
    pub const MOST: usize = 4096;

    /// Batches of `size` values at first, 1 or more.
    pub fn by(size: u64) -> Self {
        Self { size: size.max(1), means: Vec::new(), ends: Vec::new(), sum: 0.0, count: 0 }
    }

    /// Adds the next value, which came at `time`, s.
    pub fn push(&mut self, value: f64, time: f64) {
        self.sum += value;
        self.count += 1;
        if self.count < self.size {
            return;
        }
        if self.means.len() == Self::MOST {
            // The batch at hand is half of one now.
            self.join();
            return;
        }
        self.means.push(self.sum / self.size as f64);
        self.ends.push(time);
        (self.sum, self.count) = (0.0, 0);
    }

    /// Joins batches by two; of an odd number the last one is open again.
    fn join(&mut self) {
        if self.means.len() % 2 == 1
            && let Some(last) = self.means.pop()
        {
            self.ends.pop();
            self.sum += last * self.size as f64;
            self.count += self.size;
        }
        self.means = self.means.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        self.ends = self.ends.chunks_exact(2).map(|pair| pair[1]).collect();
        self.size *= 2;
    }

    /// Values in a batch.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// Means of the batches, in their order.
    pub fn means(&self) -> &[f64] {
        &self.means
    }

    /// When the last value of the first `batches` batches came, s; `None` without them.
    pub fn end(&self, batches: usize) -> Option<f64> {
        self.ends.get(batches.checked_sub(1)?).copied()
    }
}

/// What of the start of a run is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truncation {
    /// Batches that are left out.
    pub batches: usize,
    /// Values in a batch.
    pub size: u64,
    /// The statistic that is least there: the square of the standard error of the mean of the rest, were its batches
    /// independent.
    pub statistic: f64,
    /// Mean of the rest.
    pub mean: f64,
    /// Whether as much is left out as may be: the run is too short to tell where its start ends.
    pub at_limit: bool,
}

impl Truncation {
    /// Values that are left out.
    pub fn values(&self) -> u64 {
        self.batches as u64 * self.size
    }
}

/// Values in a batch of MSER-5, while there are few.
pub const MSER_BATCH: u64 = 5;
/// Least number of batches in which the end of a start is looked for (assumption: below it the statistic of the second
/// half is one of a few numbers).
pub const MSER_LEAST: usize = 10;

/// The end of the start by MSER-5: of all that leave out at most half of the batches, the one whose rest has the least
/// Σ(Y−Ȳ)²/(m−d)², where Y are the m−d batches that are left. Several runs are averaged batch by batch, as far as
/// the shortest goes. `None` with fewer than [`MSER_LEAST`] batches.
///
/// # Source
/// K. P. White, Simulation 69 (1997) 323; K. P. White, M. J. Cobb, S. C. Spratt, Winter Simulation Conference (2000) 755.
pub fn mser(runs: &[Batched]) -> Option<Truncation> {
    let size = runs.iter().map(Batched::size).max()?;
    let alike: Vec<Batched> = runs
        .iter()
        .map(|run| {
            let mut run = run.clone();
            while run.size < size {
                run.join();
            }
            run
        })
        .collect();
    let count = alike.iter().map(|run| run.means.len()).min()?;
    if count < MSER_LEAST {
        return None;
    }
    let mean = |batch: usize| alike.iter().map(|run| run.means[batch]).sum::<f64>() / alike.len() as f64;
    let limit = count / 2;
    let mut rest = Moments::default();
    let mut best: Option<Truncation> = None;
    for batch in (0..count).rev() {
        rest.push(mean(batch));
        let statistic = rest.squares / (rest.count as f64 * rest.count as f64);
        // Of equal ones the one that leaves out least.
        if batch <= limit && best.is_none_or(|best| statistic <= best.statistic) {
            best = Some(Truncation { batches: batch, size, statistic, mean: rest.mean(), at_limit: batch == limit });
        }
    }
    best
}

/// The mean of one long run from the means of its batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatchMeans {
    /// Mean with its interval.
    pub interval: Interval,
    /// Values in a batch.
    pub size: u64,
    /// Lag-1 autocorrelation of the batches.
    pub correlation: f64,
}

/// Batches into which a long run is divided.
pub const BATCHES: usize = 20;

impl BatchMeans {
    /// Whether the batches still depend on each other: |r₁| is beyond two standard errors of that of independent ones, 2/√20.
    /// The interval is then not to be trusted, and the run has to be longer.
    pub fn correlated(&self) -> bool {
        self.correlation.abs() > 2.0 / (BATCHES as f64).sqrt()
    }
}

/// Means of [`BATCHES`] equal batches of a run; what does not fill them is left out at its start. `None` where there are
/// fewer values than that.
///
/// # Source
/// A. M. Law, Simulation Modeling and Analysis, 5th ed. (2015), section 9.5.3.
pub fn batch_means(run: &Batched, confidence: f64) -> Option<BatchMeans> {
    let width = run.means.len() / BATCHES;
    if width == 0 {
        return None;
    }
    let from = run.means.len() - width * BATCHES;
    let means: Vec<f64> =
        run.means[from..].chunks_exact(width).map(|batch| batch.iter().sum::<f64>() / width as f64).collect();
    let moments: Moments = means.iter().copied().collect();
    let mean = moments.mean();
    let lagged: f64 = means.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    let half_width = student(confidence, (BATCHES - 1) as f64) * moments.standard_error();
    Some(BatchMeans {
        interval: Interval { mean, half_width, count: BATCHES as u64 },
        size: width as u64 * run.size,
        // Batches that are all equal do not depend on each other.
        correlation: if moments.squares > 0.0 { lagged / moments.squares } else { 0.0 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Values that were computed independently: a start that decays, a lattice and a slow wave.
    fn value(i: u32) -> f64 {
        let i = f64::from(i);
        let golden = i * 0.618_033_988_749_894_9;
        10.0 + 6.0 * (-i / 60.0).exp() + 4.0 * (golden - golden.floor() - 0.5) + 1.5 * (i / 37.0).sin()
    }

    fn batched(size: u64, values: impl Iterator<Item = f64>) -> Batched {
        let mut batched = Batched::by(size);
        values.enumerate().for_each(|(i, value)| batched.push(value, i as f64));
        batched
    }

    #[test]
    fn the_start_ends_where_it_was_computed_independently() {
        let found = mser(&[batched(MSER_BATCH, (0..2000).map(value))]).expect("400 batches");
        assert_eq!((found.values(), found.at_limit), (100, false));
        assert!((found.statistic - 0.003_052_304_394).abs() < 5e-13, "{}", found.statistic);
        assert!((found.mean - 10.034_778_75).abs() < 5e-9, "{}", found.mean);
    }

    #[test]
    fn batches_that_depend_on_each_other_are_found_as_computed_independently() {
        let found = batch_means(&batched(1, (300..2000).map(value)), 0.95).expect("1700 values");
        assert_eq!(found.size, 85);
        assert!((found.interval.mean - 10.020_252_8).abs() < 5e-8, "{}", found.interval.mean);
        assert!((found.interval.half_width - 0.398_121_141_1).abs() < 5e-11, "{}", found.interval.half_width);
        assert!((found.correlation + 0.643_926_460_7).abs() < 5e-11, "{}", found.correlation);
        assert!(found.correlated());
    }

    #[test]
    fn a_run_that_is_all_start_is_told_and_one_without_start_loses_nothing() {
        let rising = mser(&[batched(5, (0..1000).map(f64::from))]).expect("200 batches");
        assert!(rising.at_limit && rising.values() == 500, "{rising:?}");
        let level = mser(&[batched(5, (0..1000).map(|_| 3.0))]).expect("200 batches");
        assert_eq!((level.values(), level.statistic, level.mean), (0, 0.0, 3.0));
        assert_eq!(mser(&[batched(5, (0..49).map(f64::from))]), None);
        assert_eq!(mser(&[]), None);
        assert_eq!(batch_means(&batched(1, (0..19).map(f64::from)), 0.95), None);
    }

    #[test]
    fn runs_are_averaged_as_far_as_the_shortest_goes_whatever_the_size_of_their_batches() {
        let (short, long) = (batched(5, (0..2000).map(value)), batched(5, (0..50_000).map(value)));
        assert!(long.size() > 5 && long.means().len() <= Batched::MOST);
        let alone = mser(std::slice::from_ref(&short)).expect("400 batches");
        let together = mser(&[short, long]).expect("the same values");
        assert_eq!(together.size, 20);
        assert!((together.mean - alone.mean).abs() < 0.05, "{together:?}");
    }

    #[test]
    fn intervals_of_independent_values_hold_the_mean_as_often_as_they_say() {
        // A counter through SplitMix64: the same everywhere.
        let uniform = |i: u64| {
            let mixed = i.wrapping_mul(0x9E37_79B9_7F4A_7C15);
            let mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((mixed ^ mixed >> 31) >> 11) as f64 / (1u64 << 53) as f64
        };
        let (mut held, mut warned) = (0, 0);
        for run in 0..2000_u64 {
            let found = batch_means(&batched(1, (0..400).map(|i| uniform(run * 400 + i))), 0.95).expect("400 values");
            held += u32::from(!found.interval.excludes(0.5));
            warned += u32::from(found.correlated());
        }
        // Three standard errors of 95 % in 2000 runs are 1.5 %; the warning comes in about 5 % of runs without cause.
        assert!((0.935..0.965).contains(&(f64::from(held) / 2000.0)), "{held}");
        assert!(f64::from(warned) / 2000.0 < 0.06, "{warned}");
    }

    proptest! {
        #[test]
        fn joining_batches_keeps_the_mean_and_the_order(
            values in prop::collection::vec(-1e3..1e3f64, 1..30_000), size in 1u64..4,
        ) {
            let batched = batched(size, values.iter().copied());
            prop_assert!(batched.means().len() <= Batched::MOST);
            let whole = batched.means().len() * batched.size() as usize;
            prop_assert!(values.len() - whole < batched.size() as usize);
            for (batch, mean) in batched.means().iter().enumerate() {
                let from = batch * batched.size() as usize;
                let to = from + batched.size() as usize;
                let exact = values[from..to].iter().sum::<f64>() / batched.size() as f64;
                prop_assert!((mean - exact).abs() < 1e-9 * (1.0 + exact.abs()));
                prop_assert_eq!(batched.end(batch + 1), Some((to - 1) as f64));
            }
        }
    }
}
