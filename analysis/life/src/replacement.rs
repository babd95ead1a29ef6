//! When an edge is best replaced.

use super::law::{Law, integral};

/// What replacing an edge costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// Before it is spent.
    pub planned: f64,
    /// After it has failed in the cut.
    pub failure: f64,
}

/// A replacement rule at its best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replacement {
    /// Age at which an edge is replaced, or the interval of block replacement; infinite where
    /// running to failure is best.
    pub age: f64,
    /// Cost per time.
    pub cost_rate: f64,
    /// Cost per time of using every edge until it ends.
    pub run_to_failure: f64,
}

impl Replacement {
    /// Share of the cost of running to failure that the rule saves.
    pub fn saving(&self) -> f64 {
        1.0 - self.cost_rate / self.run_to_failure
    }
}

/// Which of the edges that end by themselves have failed. The others have come to a limit that is seen, and are replaced as
/// planned.
#[derive(Clone, Copy, Debug)]
pub enum Failing<'a> {
    /// All of them.
    Every,
    /// None.
    Never,
    /// Those that end by this law; it competes with the limit.
    By(&'a Law),
}

/// Parts of an interval of ages over which shares that failed are summed up.
const PARTS: usize = 8;

impl Failing<'_> {
    /// Share of edges that have failed between two ages, of which all ends are those of `law`: `∫ R dH` with the hazard of
    /// failures.
    fn between(self, law: &Law, start: f64, end: f64) -> f64 {
        match self {
            Self::Every => law.survival(start) - law.survival(end),
            Self::Never => 0.0,
            Self::By(failures) => {
                let age = |part: usize| start + (end - start) * part as f64 / PARTS as f64;
                let share = |part: usize| {
                    let (from, to) = (age(part), age(part + 1));
                    law.survival(0.5 * (from + to)) * (failures.ln_survival(from) - failures.ln_survival(to))
                };
                let shares = (0..PARTS).map(share).filter(|share| share.is_finite());
                shares.sum()
            }
        }
    }

    /// Share of edges that have failed by ascending ages.
    fn failed_by(self, law: &Law, ages: &[f64]) -> Vec<f64> {
        if let Self::Every = self {
            return ages.iter().map(|age| 1.0 - law.survival(*age)).collect();
        }
        let (mut from, mut failed) = (0.0, 0.0);
        let next = |age: &f64| {
            failed += self.between(law, from, *age);
            from = *age;
            f64::min(failed, 1.0)
        };
        ages.iter().map(next).collect()
    }
}

impl Costs {
    /// Cost of a cycle of which this share ends with a failure.
    fn of_cycle(&self, failed: f64) -> f64 {
        self.planned * (1.0 - failed) + self.failure * failed
    }

    /// Cost per time when every edge is used until it ends.
    fn until_the_end(&self, law: &Law, failing: Failing<'_>) -> f64 {
        if let Failing::Every = failing {
            return self.run_to_failure(law);
        }
        let failed = failing.failed_by(law, &grid(range(law)));
        self.of_cycle(failed.last().copied().unwrap_or(0.0)) / law.mean()
    }

    /// Cost per time when edges are replaced at an age or when they fail, whichever is first:
    /// `(planned·R + failure·(1 - R))/∫R`.
    ///
    /// # Source
    /// R. E. Barlow, L. C. Hunter, Operations Research 8 (1960) 90, policy I.
    pub fn at_age(&self, law: &Law, age: f64) -> f64 {
        let survival = law.survival(age);
        (self.planned * survival + self.failure * (1.0 - survival)) / law.lived(age)
    }

    /// Cost per time when every edge runs until it fails.
    pub fn run_to_failure(&self, law: &Law) -> f64 {
        self.failure / law.mean()
    }

    /// Cost per time when edges are replaced at every multiple of an interval and when they fail:
    /// `(planned + failure·M)/interval`, with the renewal function M.
    ///
    /// # Source
    /// Barlow and Hunter 1960, policy II.
    pub fn in_blocks(&self, law: &Law, interval: f64) -> f64 {
        (self.planned + self.failure * renewals(law, interval)) / interval
    }

    /// The best age.
    ///
    /// # Examples
    /// ```
    /// use toolroom_life::{law::Law, replacement::Costs};
    /// let best = Costs { planned: 1.0, failure: 5.0 }.best_age(&Law::Weibull { shape: 3.0, scale: 1.0 });
    /// assert!((best.age - 0.5026).abs() < 5e-5 && (best.cost_rate - 3.0314).abs() < 5e-5);
    /// ```
    pub fn best_age(&self, law: &Law) -> Replacement {
        self.best_age_of(law, Failing::Every)
    }

    /// The best age where only some of the ends are failures. Infinite where using every edge until it ends is best.
    ///
    /// # Examples
    /// ```
    /// use toolroom_life::{law::Law, replacement::{Costs, Failing}};
    /// let (costs, worn) = (Costs { planned: 1.0, failure: 5.0 }, Law::Weibull { shape: 3.0, scale: 1.0 });
    /// // A limit that is seen is no failure: an edge is used up to it.
    /// assert!(costs.best_age_of(&worn, Failing::Never).age.is_infinite());
    /// // Edges that all fail by the law of their ends are those of `best_age`.
    /// let all = costs.best_age_of(&worn, Failing::By(&worn));
    /// assert!((all.age / costs.best_age(&worn).age - 1.0).abs() < 1e-3);
    /// ```
    pub fn best_age_of(&self, law: &Law, failing: Failing<'_>) -> Replacement {
        let grid = grid(range(law));
        let (lived, failed) = (law.lived_to(&grid), failing.failed_by(law, &grid));
        let costs: Vec<f64> = failed.iter().zip(&lived).map(|(failed, lived)| self.of_cycle(*failed) / lived).collect();
        let best = lowest(&costs);
        // From the next point below on, what was lived before is known.
        let first = best.saturating_sub(1);
        let near = |age: f64| {
            let failed = (failed[first] + failing.between(law, grid[first], age)).min(1.0);
            self.of_cycle(failed) / (lived[first] + law.lived_between(grid[first], age))
        };
        let best = golden(grid[first], grid[(best + 1).min(POINTS)], near);
        Self::settled(best, self.until_the_end(law, failing))
    }

    /// The cost of replacement at ascending ages, [`Costs::at_age`].
    pub fn at_ages(&self, law: &Law, failing: Failing<'_>, ages: &[f64]) -> Vec<f64> {
        let failed = failing.failed_by(law, ages);
        failed.into_iter().zip(law.lived_to(ages)).map(|(failed, lived)| self.of_cycle(failed) / lived).collect()
    }

    /// The best interval of block replacement; each edge that ends between is replaced at once, and costs as if it had failed
    /// in the same share as of all edges that are used until they end.
    pub fn best_blocks(&self, law: &Law, failing: Failing<'_>) -> Replacement {
        let (low, high) = range(law);
        let between = match failing {
            Failing::Every => *self,
            Failing::Never | Failing::By(_) => {
                let failed = failing.failed_by(law, &grid((low, high))).last().copied().unwrap_or(0.0);
                Self { planned: self.planned, failure: self.of_cycle(failed) }
            }
        };
        Self::settled(least(low, high, |interval| between.in_blocks(law, interval)), self.until_the_end(law, failing))
    }

    /// The rule at its best, or using every edge until it ends where that costs less.
    fn settled((age, cost_rate): (f64, f64), run_to_failure: f64) -> Replacement {
        if cost_rate < run_to_failure {
            Replacement { age, cost_rate, run_to_failure }
        } else {
            Replacement { age: f64::INFINITY, cost_rate: run_to_failure, run_to_failure }
        }
    }
}

/// Place and value of the least of `f`: the best of 60 points evenly spaced in the logarithm,
/// refined by golden section.
pub(super) fn least(low: f64, high: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    let grid = grid((low, high));
    let best = lowest(&grid.iter().map(|age| f(*age)).collect::<Vec<_>>());
    golden(grid[best.saturating_sub(1)], grid[(best + 1).min(POINTS)], f)
}

/// Parts of the range in which a rule is sought.
const POINTS: usize = 60;

/// Ages between which the best one of a law is sought.
fn range(law: &Law) -> (f64, f64) {
    (law.quantile(1e-4).max(1e-4 * law.mean()), law.quantile(0.999))
}

/// Ages evenly spaced in the logarithm.
fn grid((low, high): (f64, f64)) -> Vec<f64> {
    (0..=POINTS).map(|i| low * (high / low).powf(i as f64 / POINTS as f64)).collect()
}

/// Place of the least value.
fn lowest(values: &[f64]) -> usize {
    (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0)
}

/// Place and value of the least of `f` between two ages, by golden section.
fn golden(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    while b - a > 1e-7 * b {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - golden * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + golden * (b - a);
            fd = f(d);
        }
    }
    let age = 0.5 * (a + b);
    (age, f(age))
}

/// Expected number of failures within `time` when every failed edge is replaced at once:
/// `M(t) = F(t) + ∫ M(t - u) dF(u)`, by the midpoint rule of Xie on 200 parts.
///
/// # Source
/// M. Xie, Communications in Statistics B 18 (1989) 281.
pub fn renewals(law: &Law, time: f64) -> f64 {
    const PARTS: usize = 200;
    let step = time / PARTS as f64;
    let failed: Vec<f64> = (0..=2 * PARTS).map(|i| law.failed(0.5 * step * i as f64)).collect();
    let (whole, half) = (|i: usize| failed[2 * i], |i: usize| failed[2 * i + 1]);
    let mut renewals = vec![0.0; PARTS + 1];
    for i in 1..=PARTS {
        let earlier: f64 = (1..i).map(|j| half(i - j) * (renewals[j] - renewals[j - 1])).sum();
        renewals[i] = (whole(i) + earlier - half(0) * renewals[i - 1]) / (1.0 - half(0));
    }
    renewals[PARTS]
}

/// Mean wear-out share and length of the cycles of wear-based replacement, from which
/// [`Costs`] makes a cost per time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycles {
    /// Share of edges that fail before they are replaced.
    pub failed: f64,
    /// Mean time in cut of an edge.
    pub length: f64,
}

impl Cycles {
    /// Cost per time.
    pub fn cost_rate(&self, costs: &Costs) -> f64 {
        (costs.planned + (costs.failure - costs.planned) * self.failed) / self.length
    }

    /// The cycles of replacement at an age.
    pub fn at_age(law: &Law, age: f64) -> Self {
        Self { failed: law.failed(age), length: integral(0.0, age, |t| law.survival(t)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn age_replacement_is_the_published_table() {
        // Weibull of scale 1, planned cost 1, failure cost r: t*, cost rate, run to failure, saving, R(t*).
        let table = [
            (2.0, 5.0, 0.5107, 4.0852, 5.6419, 0.276, 0.770),
            (3.0, 5.0, 0.5026, 3.0314, 5.5992, 0.459, 0.881),
            (4.08, 5.0, 0.5414, 2.4662, 5.5101, 0.552, 0.921),
            (4.08, 10.0, 0.4434, 2.9985, 11.020, 0.728, 0.964),
        ];
        for (shape, failure, age, rate, run, saving, survival) in table {
            let law = Law::Weibull { shape, scale: 1.0 };
            let best = Costs { planned: 1.0, failure }.best_age(&law);
            assert!((best.age - age).abs() < 5.1e-5, "{shape}, {failure}: {best:?}");
            assert!((best.cost_rate - rate).abs() < 5.1e-5, "{shape}, {failure}: {best:?}");
            assert!((best.run_to_failure / run - 1.0).abs() < 5.1e-5, "{shape}, {failure}: {best:?}");
            assert!((best.saving() - saving).abs() < 5.1e-4, "{shape}, {failure}: {best:?}");
            assert!((law.survival(best.age) - survival).abs() < 5.1e-4, "{shape}, {failure}: {best:?}");
            let cycles = Cycles::at_age(&law, best.age);
            assert!((cycles.cost_rate(&Costs { planned: 1.0, failure }) / best.cost_rate - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_limit_that_is_seen_is_no_failure_and_chips_before_it_are() {
        // Chips at a constant rate of 0.3 over the scale of wear-out: they do not age, so that a replacement before the limit
        // saves nothing, and of all edges the share of chips is ∫ R dH.
        let (costs, chips) = (Costs { planned: 1.0, failure: 5.0 }, Law::Weibull { shape: 1.0, scale: 1.0 / 0.3 });
        let ends = Law::Weibull { shape: 3.0, scale: 1.0 };
        let best = costs.best_age_of(&ends, Failing::By(&chips));
        let share = 0.3 * ends.mean();
        assert!(best.age.is_infinite(), "{best:?}");
        assert!((best.run_to_failure * ends.mean() / (1.0 + 4.0 * share) - 1.0).abs() < 2e-3, "{best:?}");
        // Chips that come with age are worth a replacement before the limit, later than if the limit were a failure, too.
        let aged = costs.best_age_of(&ends, Failing::By(&Law::Weibull { shape: 5.0, scale: 1.0 }));
        assert!(aged.age.is_finite() && aged.age > costs.best_age(&ends).age, "{aged:?}");
    }

    #[test]
    fn edges_that_do_not_age_are_run_to_failure() {
        let best = Costs { planned: 1.0, failure: 5.0 }.best_age(&Law::Weibull { shape: 1.0, scale: 10.0 });
        assert!(best.age.is_infinite() && best.saving() == 0.0, "{best:?}");
    }

    #[test]
    fn renewals_are_those_of_known_laws() {
        // Exponential: M = t/scale. Gamma of shape 2 and scale 1: M = t/2 - 1/4 + e^(-2t)/4.
        assert!((renewals(&Law::Weibull { shape: 1.0, scale: 2.0 }, 3.0) - 1.5).abs() < 1e-4);
        let expected = 1.5 - 0.25 + 0.25 * (-6.0f64).exp();
        assert!((renewals(&Law::Gamma { shape: 2.0, scale: 1.0 }, 3.0) - expected).abs() < 1e-4);
    }

    #[test]
    fn blocks_cost_more_than_ages() {
        let (costs, law) = (Costs { planned: 1.0, failure: 5.0 }, Law::Weibull { shape: 3.0, scale: 1.0 });
        let (age, blocks) = (costs.best_age(&law), costs.best_blocks(&law, Failing::Every));
        assert!(age.cost_rate < blocks.cost_rate && blocks.cost_rate < blocks.run_to_failure, "{age:?} {blocks:?}");
    }
}
