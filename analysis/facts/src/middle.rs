//! Times of people and machines against the mean that their file states, pair by pair.
//!
//! A time that is too long may be a constant of the file that is wrong, or a cause that adds to every time. A constant
//! multiplies, and so the times scatter by as much more; what is added leaves their scatter as it was. Where the file gives
//! one time nothing scatters by it, and nothing tells one from the other.

use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::times::fisher;
use crate::told::{Delay, Told};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use statrs::function::erf::erfc;
use toolroom_statistics::{Moments, student};

/// Fewest times that are tested (count; assumption).
const FEWEST: usize = 3;
/// Fewest times whose scatter is tested (count; assumption, as for the scatter of handling).
const FEWEST_SCATTERING: usize = 20;
/// Standard deviation of a time as a log has it, s. Assumption: whole seconds at both ends, as for the cycle time.
const CLOCK: f64 = 0.5;
/// Probability below which one explanation is refused (1; the level of facts) and above which the other is kept (1;
/// assumption) before a cause is told from a constant.
const REFUSED: f64 = LEVEL;
const KEPT: f64 = 0.05;

/// Recorded times of one kind with what the file says of each.
#[derive(Clone, Copy, Debug)]
pub struct Timed<'a> {
    /// What was timed.
    pub quantity: Quantity,
    /// The effect of the catalogue that adds to such times.
    pub effect: &'static str,
    /// Where.
    pub place: &'a str,
    /// Whether that is several machines.
    pub pooled: bool,
    /// Shifts in which alone they were taken; all, if empty.
    pub shifts: &'a [String],
    /// Recorded time and mean by the file, s each.
    pub pairs: &'a [(f64, f64)],
    /// Coefficient of variation by the file (1; 0: the file gives one time, and nobody says how much it scatters).
    pub variation: f64,
    /// Relative standard error of that coefficient (1).
    pub variation_error: f64,
}

/// How far the recorded times are from their file: mean, and its standard error, s.
pub fn excess(pairs: &[(f64, f64)]) -> (f64, f64) {
    let own: Moments = pairs.iter().map(|(recorded, model)| recorded - model).collect();
    (own.mean(), own.standard_deviation().hypot(CLOCK) / (pairs.len() as f64).sqrt())
}

/// Middle and scatter of recorded times against their file (Student's t of the mean excess; the logarithm of the
/// coefficient of variation). A scatter that a constant or an added time explains is none. `None` for fewer than three
/// times, and where the file gives no time at all.
///
/// # Source
/// Combination of the two tests: Fisher 1932. Standard error of a sample variance: Cramér 1946, section 27.4.
pub fn middle(timed: &Timed<'_>) -> Option<Fact> {
    let Timed { quantity, pairs, .. } = *timed;
    let model = pairs.iter().map(|(_, model)| *model).collect::<Moments>().mean();
    if pairs.len() < FEWEST || model <= 0.0 || !model.is_finite() {
        return None;
    }
    let count = pairs.len() as f64;
    let (mean, error) = excess(pairs);
    let law = StudentsT::new(0.0, 1.0, count - 1.0).ok()?;
    let middle = 2.0 * law.sf((mean / error).abs());
    let estimate = model + mean;
    let scatter = scattered(timed, estimate / model);
    let half = student(0.9, count - 1.0) * error;
    let normal = Normal::standard();
    let deviation = (timed.variation * model).hypot(CLOCK) / count.sqrt();
    let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * deviation / model;
    let mut tests = vec![("middle", middle)];
    let p = scatter.map_or(middle, |own| {
        tests.push(("scatter", own.p()));
        fisher(middle, own.p())
    });
    // A machine or a tool has no constant for one shift.
    let told = !timed.shifts.is_empty() || scatter.is_some_and(|own| own.factor < REFUSED && own.summand > KEPT);
    let constant = timed.shifts.is_empty() && scatter.is_some_and(|own| own.summand < REFUSED && own.factor > KEPT);
    let delay = Delay { effect: timed.effect, size: mean, standard_error: error, told };
    Some(Fact {
        quantity,
        place: timed.place.to_owned(),
        pooled: timed.pooled,
        told: Told { shifts: timed.shifts.to_vec(), delay: (mean > 0.0 && !constant).then_some(delay) },
        count: pairs.len() as u64,
        expected: count,
        p,
        tests,
        model,
        estimate,
        ci90: [estimate - half, estimate + half],
        least_seen: [(1.0 - reach).max(0.0), 1.0 + reach],
    })
}

/// Probabilities of the scatter where the file is off by a factor, and where something is added to every time.
#[derive(Clone, Copy, Debug)]
struct Scattered {
    factor: f64,
    summand: f64,
}

impl Scattered {
    /// That of the better explanation.
    fn p(self) -> f64 {
        self.factor.max(self.summand)
    }
}

/// The scatter of recorded times, whose mean is `ratio` times that of the file; `None` where the file has none, or too few
/// times show it.
fn scattered(timed: &Timed<'_>, ratio: f64) -> Option<Scattered> {
    let shares: Vec<f64> = timed.pairs.iter().map(|(recorded, model)| recorded / model).collect();
    if timed.variation <= 0.0 || shares.len() < FEWEST_SCATTERING || ratio <= 0.0 {
        return None;
    }
    let count = shares.len() as f64;
    let mean = shares.iter().sum::<f64>() / count;
    let power = |power: i32| shares.iter().map(|share| (share - mean).powi(power)).sum::<f64>();
    let variance = power(2) / (count - 1.0);
    let kurtosis = power(4) / count / (power(2) / count).powi(2);
    let error = ((kurtosis - 1.0).max(0.0) / (4.0 * (count - 1.0))).sqrt().hypot(timed.variation_error);
    let off = |by: f64| {
        let distance = (variance.sqrt() / (by * timed.variation)).ln() / error;
        if distance.is_finite() { erfc(distance.abs() / std::f64::consts::SQRT_2) } else { 0.0 }
    };
    Some(Scattered { factor: off(ratio), summand: off(1.0) })
}

/// Whether groups of times agree in their excess over the file: weighted sum of squares about the common mean (χ²), or no
/// group farther than a twentieth of its time from it. Groups of fewer than three times say nothing.
pub fn agree(groups: &[&[(f64, f64)]]) -> bool {
    let known = groups.iter().filter(|pairs| pairs.len() >= FEWEST);
    let all: Vec<(f64, f64, f64)> = known
        .map(|pairs| {
            let (mean, error) = excess(pairs);
            (mean, error.powi(-2), pairs.iter().map(|(_, model)| *model).collect::<Moments>().mean())
        })
        .collect();
    let weight: f64 = all.iter().map(|(_, weight, _)| weight).sum();
    let common = all.iter().map(|(mean, weight, _)| mean * weight).sum::<f64>() / weight;
    let square: f64 = all.iter().map(|(mean, weight, _)| weight * (mean - common).powi(2)).sum();
    let far = all.iter().any(|(mean, _, model)| (mean - common).abs() > DIFFERENT * model);
    let Ok(law) = statrs::distribution::ChiSquared::new((all.len().max(2) - 1) as f64) else { return true };
    all.len() < 2 || !far || law.sf(square) > LEVEL
}

/// Share of a time by which groups have to differ before they are told apart (1; assumption: half of what matters).
const DIFFERENT: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use toolroom_scenario::Distribution;

    const VARIATION: f64 = 0.3;

    fn recorded(count: usize, factor: f64, added: f64, seed: u64) -> Vec<(f64, f64)> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let law = Distribution::Lognormal { mean: 60.0, cv: VARIATION };
        (0..count).map(|_| (factor * law.quantile(random.random()) + added, 60.0)).collect()
    }

    fn asked(pairs: &[(f64, f64)], variation: f64) -> Fact {
        let (quantity, effect) = (Quantity::HandlingTime, "operator_delay");
        let timed =
            Timed { quantity, effect, place: "L1", pooled: false, shifts: &[], pairs, variation, variation_error: 0.0 };
        middle(&timed).expect("enough times")
    }

    #[test]
    fn a_true_file_is_rejected_as_often_as_the_level_says() {
        for count in [8, 200] {
            let p = |seed| asked(&recorded(count, 1.0, 0.0, seed), VARIATION).p;
            let rejected = (0..400).filter(|seed| p(*seed) < 0.05).count();
            // Of 400 at 5 %: 20 with a standard deviation of 4.4; of two explanations the scatter has the better one.
            assert!((3..=34).contains(&rejected), "{count}: {rejected}");
        }
    }

    #[test]
    fn one_time_of_the_file_that_is_another_one_in_the_log_is_seen_whatever_its_scatter() {
        let exact: Vec<(f64, f64)> = vec![(180.0, 60.0); 5];
        let fact = asked(&exact, 0.0);
        assert!(fact.p < 1e-6 && (fact.factor() - 3.0).abs() < 1e-12, "{fact:?}");
        let delay = fact.told.delay.expect("what is too long may be a delay");
        assert!(!delay.told && (delay.size - 120.0).abs() < 1e-9);
        assert_eq!(asked(&[(60.0, 60.0); 5], 0.0).p, 1.0);
        let few = Timed { pairs: &exact[..2], ..timed_of(&exact) };
        assert!(middle(&few).is_none());
    }

    fn timed_of(pairs: &[(f64, f64)]) -> Timed<'_> {
        Timed {
            quantity: Quantity::ToolChangeTime,
            effect: "tool_change_delay",
            place: "L1",
            pooled: false,
            shifts: &[],
            pairs,
            variation: 0.0,
            variation_error: 0.0,
        }
    }

    #[test]
    fn a_delay_is_told_from_a_constant_by_the_scatter_that_it_leaves() {
        for seed in 0..5 {
            let added = asked(&recorded(400, 1.0, 30.0, seed), VARIATION);
            assert!(added.told.delay.as_ref().is_some_and(|own| own.told), "{seed}: {added:?}");
            let times = asked(&recorded(400, 1.5, 0.0, seed), VARIATION);
            assert!(times.told.delay.is_none(), "{seed}: {times:?}");
            assert!(added.is_rejected(0.01) && times.is_rejected(0.01));
        }
    }

    #[test]
    fn a_scatter_that_neither_explains_is_seen_and_groups_that_differ_do_not_agree() {
        let wide = asked(&recorded(400, 1.0, 0.0, 1), 0.15);
        assert!(wide.tests.iter().any(|(name, p)| *name == "scatter" && *p < 1e-6), "{wide:?}");
        let [a, b, c] = [recorded(50, 1.0, 0.0, 1), recorded(50, 1.0, 0.0, 2), recorded(50, 1.0, 25.0, 3)];
        assert!(agree(&[&a, &b]) && !agree(&[&a, &b, &c]) && agree(&[&a, &b, &c[..2]]) && agree(&[]));
    }
}
