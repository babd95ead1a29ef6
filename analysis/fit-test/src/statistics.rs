//! Numbers by which the scores of a channel are asked.

use statrs::distribution::{ContinuousCDF, Normal};
use std::borrow::Cow;
use std::ops::Range;

/// A kind of misfit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Statistic {
    /// The mean is not zero.
    Level,
    /// The mean square is not one.
    Scale,
    /// Groups differ from one another by more than their scores do.
    Groups,
    /// Neighbours resemble each other, or alternate.
    Memory,
    /// The distribution is another one: outliers, steps.
    Shape,
    /// The scores follow something that was recorded.
    Covariate,
}

impl Statistic {
    /// All kinds, in the order of [`Statistics::values`].
    pub const ALL: [Self; 6] = [Self::Level, Self::Scale, Self::Groups, Self::Memory, Self::Shape, Self::Covariate];

    /// Word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Level => "level",
            Self::Scale => "scale",
            Self::Groups => "groups",
            Self::Memory => "memory",
            Self::Shape => "shape",
            Self::Covariate => "covariate",
        }
    }

    /// Whether it asks for structure of the means. The others ask for the noise: they may be large although no
    /// mean is off.
    pub fn of_means(self) -> bool {
        match self {
            Self::Level | Self::Groups | Self::Covariate => true,
            Self::Scale | Self::Memory | Self::Shape => false,
        }
    }

    /// Its value for the `scores` of a channel; zero without scores.
    ///
    /// # Examples
    /// ```
    /// use toolroom_fit_test::{Channel, Statistic};
    /// let channel = Channel::new(vec![0..2, 2..4], Vec::new());
    /// assert_eq!(Statistic::Level.of(&[1.0, 1.0, -1.0, 3.0], &channel), 2.0);
    /// ```
    pub fn of(self, scores: &[f64], channel: &Channel) -> f64 {
        if scores.is_empty() { 0.0 } else { self.of_scaled(&channel.scaled(scores), channel) }
    }

    fn of_scaled(self, scores: &[f64], channel: &Channel) -> f64 {
        match self {
            Self::Level => level(scores),
            // Rounding is no misfit.
            Self::Scale if channel.own_scale => 0.0,
            Self::Scale => scale(scores),
            Self::Groups => groups(scores, &channel.groups),
            Self::Memory => memory(scores, &channel.groups),
            Self::Shape => shape(scores),
            Self::Covariate => strongest(scores, channel).map_or(0.0, |(_, score)| score),
        }
    }
}

/// How the scores of a channel lie.
#[derive(Clone, Debug, Default)]
pub struct Channel {
    /// Scores of each group in sequence; together they are all scores of the channel.
    pub groups: Vec<Range<usize>>,
    /// Covariates that the scores may follow, one number a score each, of unit length.
    pub covariates: Vec<Vec<f64>>,
    /// Whether nobody states the scale of the scores: they count in units of their own root mean square, which is no
    /// question then. What they follow and how they are distributed still is.
    pub own_scale: bool,
}

impl Channel {
    /// A channel whose scores lie in `groups`, which share none, and may follow `covariates`, of any length.
    pub fn new(groups: Vec<Range<usize>>, mut covariates: Vec<Vec<f64>>) -> Self {
        for covariate in &mut covariates {
            let length = covariate.iter().map(|x| x * x).sum::<f64>().sqrt();
            covariate.iter_mut().for_each(|x| *x = if length > 0.0 { *x / length } else { 0.0 });
        }
        Self { groups, covariates, own_scale: false }
    }

    /// The scores as they are asked.
    fn scaled<'a>(&self, scores: &'a [f64]) -> Cow<'a, [f64]> {
        let square = scores.iter().map(|z| z * z).sum::<f64>() / scores.len().max(1) as f64;
        if !self.own_scale || square == 0.0 {
            return Cow::Borrowed(scores);
        }
        scores.iter().map(|z| z / square.sqrt()).collect()
    }
}

/// Six numbers of the scores of a channel, none negative but the shape's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// In the order of [`Statistic::ALL`].
    pub values: [f64; 6],
    /// The covariate that the scores follow most; `None` without covariates.
    pub strongest: Option<usize>,
}

impl Statistics {
    /// Of the `scores` of a channel. No scores at all give zeros.
    ///
    /// # Examples
    /// ```
    /// use toolroom_fit_test::{Channel, Statistic, Statistics};
    /// let channel = Channel::new(vec![0..2, 2..4], Vec::new());
    /// let statistics = Statistics::of(&[1.0, 1.0, -1.0, 3.0], &channel);
    /// assert_eq!(statistics.get(Statistic::Level), 2.0);
    /// ```
    pub fn of(scores: &[f64], channel: &Channel) -> Self {
        Self::where_asked(scores, channel, |_| true)
    }

    /// The same with zero for every kind that `asks` leaves out, which then costs nothing: the shape of a distribution
    /// takes as long as all others together.
    pub fn where_asked(scores: &[f64], channel: &Channel, asks: impl Fn(Statistic) -> bool) -> Self {
        let scores = &*channel.scaled(scores);
        let strongest = if scores.is_empty() { None } else { strongest(scores, channel) };
        let value = |statistic: Statistic| match (asks(statistic), statistic, strongest) {
            (false, ..) => 0.0,
            // What has been found already.
            (true, Statistic::Covariate, Some((_, score))) => score,
            (true, ..) if scores.is_empty() => 0.0,
            (true, ..) => statistic.of_scaled(scores, channel),
        };
        Self { values: Statistic::ALL.map(value), strongest: strongest.map(|(index, _)| index) }
    }

    /// One of them.
    pub fn get(&self, statistic: Statistic) -> f64 {
        self.values[statistic as usize]
    }
}

/// The covariate that the scores follow most, and how strongly.
fn strongest(scores: &[f64], channel: &Channel) -> Option<(usize, f64)> {
    let follows = |covariate: &Vec<f64>| scores.iter().zip(covariate).map(|(z, x)| z * x).sum::<f64>().abs();
    channel.covariates.iter().map(follows).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
}

/// `√m |z̄|`.
fn level(scores: &[f64]) -> f64 {
    let count = scores.len() as f64;
    scores.iter().sum::<f64>().abs() / count.sqrt()
}

/// `√(m/2) |ln mean z²|`: about normal where the scores are.
fn scale(scores: &[f64]) -> f64 {
    let count = scores.len() as f64;
    let mean = scores.iter().map(|z| z * z).sum::<f64>() / count;
    (0.5 * count).sqrt() * mean.max(f64::MIN_POSITIVE).ln().abs()
}

/// Mean of `n z̄²` over groups of n scores.
fn groups(scores: &[f64], groups: &[Range<usize>]) -> f64 {
    let filled = || groups.iter().filter(|group| !group.is_empty());
    let square = |group: &Range<usize>| scores[group.clone()].iter().sum::<f64>().powi(2) / group.len() as f64;
    filled().map(square).sum::<f64>() / filled().count().max(1) as f64
}

/// `|Σ z_i z_{i+1}|` over the root of the number of neighbours.
fn memory(scores: &[f64], groups: &[Range<usize>]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for group in groups {
        let inside = &scores[group.clone()];
        sum += inside.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
        count += inside.len().saturating_sub(1) as f64;
    }
    if count > 0.0 { sum.abs() / count.sqrt() } else { 0.0 }
}

/// Anderson and Darling's A² against the standard normal distribution.
fn shape(scores: &[f64]) -> f64 {
    let normal = Normal::standard();
    let mut sorted = scores.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    // The upper tail is the lower one of the mirrored score: neither rounds to nothing.
    let tail = |z: f64| normal.cdf(z).max(f64::MIN_POSITIVE).ln();
    let term = |i: usize| (2 * i + 1) as f64 * (tail(sorted[i]) + tail(-sorted[count - 1 - i]));
    -(count as f64) - (0..count).map(term).sum::<f64>() / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Four groups of six scores, computed independently.
    const SCORES: [f64; 24] = [
        0.31, -0.92, 0.14, 1.2, -0.4, 0.05, -1.6, 0.2, 0.9, -0.3, 0.77, -0.11, 2.1, 0.4, -0.6, 0.8, -1.3, 0.33, 0.02,
        -0.48, 1.5, -0.7, 0.6, -2.2,
    ];

    fn channel() -> Channel {
        Channel::new(vec![0..6, 6..12, 12..18, 18..24], Vec::new())
    }

    #[test]
    fn statistics_of_a_small_table_are_those_computed_independently() {
        let statistics = Statistics::of(&SCORES, &channel());
        let golden = [0.144928, 0.268616, 0.197688, 1.417734, 0.166738];
        for (value, golden) in statistics.values.iter().zip(golden) {
            assert!((value / golden - 1.0).abs() < 4e-6, "{value} instead of {golden}");
        }
    }

    #[test]
    fn what_is_not_asked_is_zero_and_all_else_as_it_was() {
        let ramp: Vec<f64> = (0..24).map(|i| f64::from(i) - 11.5).collect();
        let channel = Channel::new(channel().groups, vec![vec![1.0; 24], ramp]);
        let all = Statistics::of(&SCORES, &channel);
        let some = Statistics::where_asked(&SCORES, &channel, |statistic| statistic != Statistic::Shape);
        for statistic in Statistic::ALL {
            let value = if statistic == Statistic::Shape { 0.0 } else { all.get(statistic) };
            assert_eq!((some.get(statistic), statistic.of(&SCORES, &channel)), (value, all.get(statistic)));
        }
        assert_eq!(some.strongest, all.strongest);
        assert_eq!(Statistics::of(&[], &channel).values, Statistic::ALL.map(|statistic| statistic.of(&[], &channel)));
    }

    #[test]
    fn scores_of_a_scale_of_their_own_are_asked_for_all_but_the_scale() {
        let ramp: Vec<f64> = (0..24).map(|i| f64::from(i) - 11.5).collect();
        let own = Channel { own_scale: true, ..Channel::new(channel().groups, vec![ramp]) };
        let wide = SCORES.map(|z| 7.0 * z);
        let (narrow, wide) = (Statistics::of(&SCORES, &own), Statistics::of(&wide, &own));
        for statistic in Statistic::ALL {
            let (a, b) = (narrow.get(statistic), wide.get(statistic));
            assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{}: {a} and {b}", statistic.name());
        }
        assert_eq!(wide.get(Statistic::Scale), 0.0);
        // A stop of a machine is told from loading that scatters.
        let stopped: Vec<f64> = SCORES.iter().enumerate().map(|(i, z)| if i == 4 { 40.0 } else { *z }).collect();
        assert!(Statistic::Shape.of(&stopped, &own) > 10.0 * narrow.get(Statistic::Shape));
    }

    #[test]
    fn each_statistic_grows_with_its_own_misfit() {
        let plain = Statistics::of(&SCORES, &channel());
        let changed = |change: &dyn Fn(usize, f64) -> f64| -> Statistics {
            let scores: Vec<f64> = SCORES.iter().enumerate().map(|(i, z)| change(i, *z)).collect();
            let ramp = (0..24).map(|i| f64::from(i) - 11.5).collect();
            Statistics::of(&scores, &Channel::new(channel().groups, vec![ramp]))
        };
        let shifted = changed(&|_, z| z + 1.0);
        assert!(shifted.get(Statistic::Level) > plain.get(Statistic::Level) + 3.0);
        assert!(changed(&|_, z| 2.0 * z).get(Statistic::Scale) > 4.0);
        let by_group = changed(&|i, z| if i / 6 % 2 == 0 { z + 1.0 } else { z - 1.0 });
        assert!(by_group.get(Statistic::Groups) > 4.0);
        let alternating = changed(&|i, z| if i % 2 == 0 { z.abs() } else { -z.abs() });
        assert!(alternating.get(Statistic::Memory) > 1.2, "{alternating:?}");
        let outlier = changed(&|i, z| if i == 3 || i == 17 { 9.0 } else { 0.3 * z });
        assert!(outlier.get(Statistic::Shape) > 2.5, "{outlier:?}");
        let ramp = changed(&|i, z| z + 0.2 * (i as f64 - 11.5));
        assert!(ramp.get(Statistic::Covariate) > 3.0);
        assert_eq!(ramp.strongest, Some(0));
    }

    proptest! {
        #[test]
        fn any_scores_give_numbers(scores in prop::collection::vec(-1e6..1e6f64, 0..40)) {
            let half = scores.len() / 2;
            let statistics = Statistics::of(&scores, &Channel::new(vec![0..half, half..scores.len()], Vec::new()));
            prop_assert!(statistics.values.iter().all(|value| value.is_finite()), "{statistics:?}");
        }
    }
}
