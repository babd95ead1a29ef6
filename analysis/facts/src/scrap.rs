//! Pieces that were scrapped, against those that a right shop scraps.

use crate::count::{LEVEL, POWER, mid_p};
use crate::fact::{Fact, Quantity};
use crate::told::FactDetail;
use statrs::distribution::{Beta, ContinuousCDF, Normal};
use statrs::function::factorial::ln_binomial;

/// Pieces that left a shop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pieces {
    /// All of them.
    pub left: u64,
    /// Those that were scrapped.
    pub scrapped: u64,
}

impl Pieces {
    fn share(self) -> f64 {
        self.scrapped as f64 / self.left as f64
    }

    /// As many as carry the same information where `clustering` of them count as one.
    fn independent(self, clustering: f64) -> Self {
        let fewer = |count: u64| (count as f64 / clustering).round() as u64;
        Self { left: fewer(self.left).max(fewer(self.scrapped)), scrapped: fewer(self.scrapped) }
    }
}

/// Share of scrap at `place`: pieces of the log against those that the file's shop scrapped when it was simulated. `clustering`
/// (1, at least 1) is the variance of such a number over that of pieces that know nothing of each other. `None` where nothing
/// left one of the two.
///
/// # Examples
/// ```
/// use toolroom_facts::scrap::{Pieces, scrap};
/// let planned = Pieces { left: 4000, scrapped: 80 };
/// let fact = scrap("shaft/inspect", Pieces { left: 1000, scrapped: 42 }, planned, 1.0).unwrap();
/// assert!(fact.is_rejected(0.01) && (fact.factor() - 2.1).abs() < 1e-9);
/// ```
///
/// # Source
/// The number of those in the log among all that were scrapped is hypergeometric where both shares are one: Fisher, Journal of
/// the Royal Statistical Society 98 (1935) 39. Interval of a share with Jeffreys' prior: Brown, Cai and DasGupta, Statistical
/// Science 16 (2001) 101; it is wider by the error of the simulated share (delta method).
pub fn scrap(place: &str, recorded: Pieces, planned: Pieces, clustering: f64) -> Option<Fact> {
    if recorded.left == 0 || planned.left == 0 {
        return None;
    }
    let [own, other] = [recorded, planned].map(|pieces| pieces.independent(clustering));
    let p = of_two_shares(own, other);
    let good = (own.left - own.scrapped) as f64;
    let law = Beta::new(own.scrapped as f64 + 0.5, good + 0.5).ok()?;
    let low = if own.scrapped == 0 { 0.0 } else { law.inverse_cdf(0.05) };
    let high = if own.scrapped == own.left { 1.0 } else { law.inverse_cdf(0.95) };
    let model = planned.share();
    let normal = Normal::standard();
    // The share by the file is simulated, and has an error of its own, relative to it.
    let simulated = if model > 0.0 { ((1.0 - model) / (model * other.left as f64)).sqrt() } else { 0.0 };
    let wider = (normal.inverse_cdf(0.95) * simulated).exp();
    let (low, high) = (low / wider, (high * wider).min(1.0));
    let reach = normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER);
    let error = (model * (1.0 - model) * (1.0 / own.left as f64 + 1.0 / other.left as f64)).sqrt();
    let least = if model > 0.0 { reach * error / model } else { f64::INFINITY };
    Some(Fact {
        quantity: Quantity::Scrap,
        place: place.to_owned(),
        pooled: false,
        told: FactDetail::default(),
        count: recorded.scrapped,
        expected: model * recorded.left as f64,
        p,
        tests: vec![("level", p)],
        model,
        estimate: recorded.share(),
        ci90: [low, high],
        least_seen: [(1.0 - least).max(0.0), 1.0 + least],
    })
}

/// Exact two-sided mid-p of two shares being one.
fn of_two_shares(own: Pieces, other: Pieces) -> f64 {
    let scrapped = own.scrapped + other.scrapped;
    let all = ln_binomial(own.left + other.left, scrapped);
    let probability =
        |count: u64| (ln_binomial(own.left, count) + ln_binomial(other.left, scrapped - count) - all).exp();
    let [first, last] = [scrapped.saturating_sub(other.left), scrapped.min(own.left)];
    let sum = |counts: std::ops::RangeInclusive<u64>| counts.map(probability).sum::<f64>();
    let below = if own.scrapped > first { sum(first..=own.scrapped - 1) } else { 0.0 };
    let above = if own.scrapped < last { sum(own.scrapped + 1..=last) } else { 0.0 };
    mid_p(below, probability(own.scrapped), above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    fn pieces(left: u64, scrapped: u64) -> Pieces {
        Pieces { left, scrapped }
    }

    #[test]
    fn the_probability_is_that_of_the_tea_taster() {
        // Fisher's table of 3 and 1 against 1 and 3: P(X > 3) = 1/70, P(X = 3) = 16/70.
        assert!((of_two_shares(pieces(4, 3), pieces(4, 1)) - 2.0 * 9.0 / 70.0).abs() < 1e-12);
        assert_eq!(of_two_shares(pieces(50, 0), pieces(90, 0)), 1.0);
    }

    #[test]
    fn a_right_share_is_contradicted_as_often_as_the_level_says() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut of =
            |left: u64, share: f64| pieces(left, (0..left).filter(|_| random.random::<f64>() < share).count() as u64);
        let below = (0..400).filter(|_| of_two_shares(of(400, 0.05), of(1600, 0.05)) < 0.05).count();
        // 20 are expected; the standard deviation of such a count is 4.4.
        assert!((6..=34).contains(&below), "{below} of 400 below 5 %");
        let found = (0..40).filter(|_| of_two_shares(of(1000, 0.10), of(4000, 0.05)) < 0.01).count();
        assert!(found >= 38, "{found} of 40 that scrap twice as much");
    }

    #[test]
    fn what_the_file_never_scraps_has_no_factor_and_lots_count_once() {
        let never = scrap("shaft", pieces(1000, 12), pieces(4000, 0), 1.0).expect("pieces");
        assert!(never.is_rejected(1e-6) && never.factor().is_infinite());
        let lots = scrap("shaft", pieces(1000, 30), pieces(4000, 80), 10.0).expect("pieces");
        let alone = scrap("shaft", pieces(1000, 30), pieces(4000, 80), 1.0).expect("pieces");
        assert!(lots.p > 0.4 && alone.p < 0.1, "{} {}", lots.p, alone.p);
        assert!(lots.ci90[0] < alone.ci90[0] && lots.ci90[1] > alone.ci90[1]);
        assert!(scrap("shaft", pieces(0, 0), pieces(9, 1), 1.0).is_none());
    }
}
