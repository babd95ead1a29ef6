//! Which machines of a pool share a constant, and which have one of their own.

use crate::count::LEVEL;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use toolroom_statistics::Moments;

/// Places in groups that agree: all in one, or those that are left after the ones that stand apart have been taken out one
/// by one, each a group of its own behind the first. `agreement` is the probability of places as different by chance if
/// they share their constant; those below the level of facts do not. Groups are in the order of their places.
///
/// # Examples
/// ```
/// use toolroom_facts::agreement::{agreeing, same_rate};
/// let seen = [(47, 15.1), (17, 15.0), (15, 12.4), (10, 9.9)];
/// let rate = |places: &[usize]| same_rate(&places.iter().map(|place| seen[*place]).collect::<Vec<_>>());
/// assert_eq!(agreeing(4, rate), [vec![1, 2, 3], vec![0]]);
/// ```
pub fn agreeing(places: usize, agreement: impl Fn(&[usize]) -> f64) -> Vec<Vec<usize>> {
    let mut left: Vec<usize> = (0..places).collect();
    let mut groups = Vec::new();
    while left.len() > 1 && agreement(&left) < LEVEL {
        let without = |place: usize| left.iter().copied().filter(|other| *other != place).collect::<Vec<usize>>();
        let rest = |place: &usize| if left.len() > 2 { agreement(&without(*place)) } else { 0.0 };
        let apart = left.iter().copied().max_by(|a, b| rest(a).total_cmp(&rest(b))).unwrap_or(left[0]);
        left = without(apart);
        groups.push(vec![apart]);
    }
    groups.sort();
    groups.insert(0, left);
    groups
}

/// Probability that places of one rate differ as much as these: of each the events that were seen and how many were expected
/// (above 0). Pearson's χ² given their sum; 1 where nothing was seen.
pub fn same_rate(places: &[(u64, f64)]) -> f64 {
    let seen: u64 = places.iter().map(|(count, _)| count).sum();
    let expected: f64 = places.iter().map(|(_, expected)| expected).sum();
    let rate = seen as f64 / expected;
    let square = |(count, expected): &(u64, f64)| (*count as f64 - rate * expected).powi(2) / (rate * expected);
    match ChiSquared::new(places.len() as f64 - 1.0) {
        Ok(law) if seen > 0 => law.sf(places.iter().map(square).sum()),
        Ok(_) | Err(_) => 1.0,
    }
}

/// Probability that places whose times have one middle differ as much as these: of each its times, s, above 0. Fisher's F of their
/// logarithms; 1 where no place has two times, or where one has none.
pub fn same_middle(places: &[&[f64]]) -> f64 {
    let logarithms = |times: &&[f64]| times.iter().map(|time| time.ln()).collect::<Moments>();
    let places: Vec<Moments> = places.iter().map(logarithms).collect();
    let count: f64 = places.iter().map(|own| own.count() as f64).sum();
    let (groups, common) =
        (places.len() as f64, places.iter().map(|own| own.count() as f64 * own.mean()).sum::<f64>() / count);
    let between = |own: &Moments| own.count() as f64 * (own.mean() - common).powi(2);
    let within = |own: &Moments| {
        if own.count() > 1 { (own.count() as f64 - 1.0) * own.standard_deviation().powi(2) } else { 0.0 }
    };
    let between = places.iter().map(between).sum::<f64>() / (groups - 1.0);
    let within = places.iter().map(within).sum::<f64>() / (count - groups);
    match FisherSnedecor::new(groups - 1.0, count - groups) {
        Ok(law) if within > 0.0 && between.is_finite() => law.sf(between / within),
        Ok(_) | Err(_) => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn the_probabilities_are_those_computed_independently() {
        // scipy.stats: chi2.sf and f_oneway of the logarithms.
        let rate = same_rate(&[(12, 10.0), (4, 10.0), (9, 8.0)]);
        assert!((rate / 0.118_837_293_852_409_67 - 1.0).abs() < 1e-6, "{rate}");
        let middle = same_middle(&[&[20.0, 31.0, 26.0, 24.0], &[44.0, 39.0, 52.0], &[25.0, 22.0]]);
        assert!((middle / 0.004_818_295_567_564_803 - 1.0).abs() < 1e-6, "{middle}");
    }

    #[test]
    fn nothing_seen_and_single_times_say_nothing() {
        assert_eq!(same_rate(&[(0, 3.0), (0, 4.0)]), 1.0);
        assert_eq!(same_middle(&[&[20.0], &[900.0]]), 1.0);
        assert_eq!(same_middle(&[&[], &[900.0, 800.0]]), 1.0);
        assert_eq!(agreeing(0, |_| 0.0), [Vec::<usize>::new()]);
        assert_eq!(agreeing(2, |_| 0.0).len(), 2);
    }

    #[test]
    fn alike_places_are_parted_as_seldom_as_the_level_says() {
        let parted = (0..500_u64).filter(|seed| {
            let mut random = ChaCha8Rng::seed_from_u64(*seed);
            let mut clock = |exposure: f64| {
                let (mut time, mut count) = (0.0, 0);
                loop {
                    time -= (1.0 - random.random::<f64>()).ln();
                    if time > exposure {
                        return (count, exposure);
                    }
                    count += 1;
                }
            };
            let seen = [15.0, 14.0, 9.0, 20.0].map(&mut clock);
            agreeing(4, |places| same_rate(&places.iter().map(|i| seen[*i]).collect::<Vec<_>>())).len() > 1
        });
        // Of 500 at 1 %: 5 with a standard deviation of 2.2.
        let parted = parted.count();
        assert!(parted <= 13, "{parted}");
    }
}
