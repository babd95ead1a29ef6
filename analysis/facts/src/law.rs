//! How times scatter by the law of their file, whatever it is.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::function::gamma::{gamma_lr, gamma_ur};
use toolroom_statistics::Moments;

/// Times that are drawn of a law (count): its coefficient of variation is then known to about half a per cent.
const DRAWN: usize = 20_000;
/// Replicated samples (count).
const SAMPLES: usize = 4000;
/// Times of all replicated samples together (count): of larger samples the variance follows its own law of large numbers.
const MOST: usize = 2_000_000;
/// Samples beyond which a share of them is read off (count; assumption: it is then known to a third).
const BEYOND: f64 = 10.0;

/// A law of positive times, over their mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RelativeLaw {
    /// Drawn times over their mean (1).
    drawn: Vec<f64>,
    /// Coefficient of variation (1).
    variation: f64,
    /// Kurtosis (1).
    kurtosis: f64,
}

/// What a sample is compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reference {
    /// The standard deviation over the mean of the sample: its times are those of the law by a factor.
    OwnMean,
    /// The standard deviation over the mean of the law: something is added to every time.
    MeanOfLaw,
}

impl RelativeLaw {
    /// The law from which `draw` takes a time out of a number from 0 to 1 a part, of which it takes as many as it needs. Times
    /// that do not scatter have a coefficient of variation of zero.
    pub fn new(draw: impl Fn(&mut dyn FnMut() -> f64) -> f64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut uniform = || random.random::<f64>();
        let times: Vec<f64> = (0..DRAWN).map(|_| draw(&mut uniform)).collect();
        let mean = times.iter().copied().collect::<Moments>().mean();
        if mean <= 0.0 || !mean.is_finite() {
            return Self::default();
        }
        let drawn: Vec<f64> = times.iter().map(|time| time / mean).collect();
        let central = |power: i32| drawn.iter().map(|own| (own - 1.0).powi(power)).sum::<f64>() / DRAWN as f64;
        let variance = central(2);
        let kurtosis = if variance > 0.0 { central(4) / (variance * variance) } else { 0.0 };
        Self { variation: variance.sqrt(), kurtosis, drawn }
    }

    /// Coefficient of variation (1).
    pub fn variation(&self) -> f64 {
        self.variation
    }

    /// Probability of a relative standard deviation as far from that of the law as `deviation` (1) in a sample of `count`, two
    /// or more: twice the smaller share of replicated samples beyond it. `clock` (1) is the standard deviation of an error that
    /// the recorded times may have beside: samples with it are held against what scatters more, without it against what scatters less.
    ///
    /// Where hardly any replicated sample lies beyond, the gamma distribution of the same mean and variance continues the
    /// tail (Satterthwaite 1946), and it is taken at once of large samples.
    pub(crate) fn p(&self, count: usize, deviation: f64, against: Reference, clock: f64) -> f64 {
        let (law, square) = (self.variation * self.variation, deviation * deviation);
        let n = count as f64;
        let free = 2.0 / ((self.kurtosis - 3.0) / n + 2.0 / (n - 1.0));
        let tail = |of: fn(f64, f64) -> f64, mean: f64| {
            let at = 0.5 * free * square / mean;
            if at > 0.0 && free > 0.0 { of(0.5 * free, at) } else { 0.0 }
        };
        let noise = clock * clock;
        // The smaller tail is the one that is asked, so that one that is not defined counts as whole.
        let narrow = if square > 0.0 { tail(gamma_lr, law) } else { 0.0 };
        let wide = tail(gamma_ur, law + noise);
        if count * SAMPLES > MOST {
            return (2.0 * narrow.min(wide)).min(1.0);
        }
        let mut random = ChaCha8Rng::seed_from_u64(count as u64);
        let (mut below, mut above) = (0.0, 0.0);
        for _ in 0..SAMPLES {
            let sample: Moments = (0..count).map(|_| self.drawn[random.random_range(0..DRAWN)]).collect();
            let mean = match against {
                Reference::OwnMean => sample.mean(),
                Reference::MeanOfLaw => 1.0,
            };
            let own = (sample.standard_deviation() / mean).powi(2);
            below += f64::from(u8::from(own <= square));
            above += f64::from(u8::from(own + noise >= square));
        }
        let share = |beyond: f64, tail: f64| {
            let replicated = (beyond / SAMPLES as f64).max(0.0);
            if beyond >= BEYOND { replicated } else { tail.min(BEYOND / SAMPLES as f64) }
        };
        (2.0 * share(below, narrow).min(share(above, wide))).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_scenario::Distribution;

    fn lognormal(cv: f64) -> RelativeLaw {
        RelativeLaw::new(|uniform| Distribution::Lognormal { mean: 60.0, cv }.quantile(uniform()))
    }

    #[test]
    fn a_sample_scatters_as_far_from_its_law_as_the_level_says_however_heavy_its_tails_are() {
        for (cv, count) in [(0.1, 20), (0.1, 600), (1.0, 60)] {
            let law = lognormal(cv);
            let rejected = (0..400_u64).filter(|seed| {
                let mut random = ChaCha8Rng::seed_from_u64(seed + 7);
                let draw = |_| Distribution::Lognormal { mean: 60.0, cv }.quantile(random.random());
                let sample: Moments = (0..count).map(draw).collect();
                law.p(count, sample.standard_deviation() / sample.mean(), Reference::OwnMean, 0.0) < 0.05
            });
            // Of 400 at 5 %: 20 with a standard deviation of 4.4.
            let rejected = rejected.count();
            assert!((7..=34).contains(&rejected), "{cv} {count}: {rejected}");
        }
    }

    #[test]
    fn a_normal_sample_has_the_probability_of_its_chi_square() {
        // Of 60 normal times 1.31 times as wide: χ² of 59 beyond 59 · 1.31² by an independent program.
        let law = RelativeLaw::new(|uniform| {
            Distribution::Normal { mean: 60.0, sd: 3.0, low: 0.0, high: f64::INFINITY }.quantile(uniform())
        });
        let p = law.p(60, 1.31 * law.variation(), Reference::MeanOfLaw, 0.0);
        assert!((p / 1.0336e-3 - 1.0).abs() < 0.5, "{p}");
        assert!(law.p(60, 3.0 * law.variation(), Reference::MeanOfLaw, 0.0) < 1e-12);
        // An error of the clock explains what scatters more, and nothing that scatters less.
        let with = |deviation: f64| law.p(60, deviation, Reference::MeanOfLaw, law.variation());
        assert!(with(1.4 * law.variation()) > 0.5 && with(0.6 * law.variation()) < 1e-4);
    }
}
