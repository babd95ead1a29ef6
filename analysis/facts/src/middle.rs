//! Times of people and machines against the mean that their file states, pair by pair.
//!
//! A time that is too long may be a constant of the file that is wrong, or a cause that adds to every time. A constant
//! multiplies, and so the times scatter by as much more; what is added leaves their scatter as it was. Where the file gives
//! one time nothing scatters by it, and nothing tells one from the other.

use crate::clock::clock_error;
use crate::count::{LEVEL, POWER};
use crate::fact::{Fact, Quantity};
use crate::law::{Reference, RelativeLaw};
use crate::told::{Delay, FactDetail};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
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
    /// How such times scatter by the file; not at all where it gives one time, and nobody says how much that scatters.
    pub law: &'a RelativeLaw,
}

/// How far the recorded times are from their file: mean, and its standard error, s.
pub fn excess(pairs: &[(f64, f64)]) -> (f64, f64) {
    let own: Moments = pairs.iter().map(|(recorded, model)| recorded - model).collect();
    (own.mean(), own.standard_deviation().hypot(CLOCK) / (pairs.len() as f64).sqrt())
}

/// Middle and scatter of recorded times against their file: two facts, since a scatter that is off is no mean that is off. Of
/// the middle Student's t of the mean excess; of the scatter the probability of [`RelativeLaw`]. A scatter that a constant
/// or an added time explains is none. Nothing for fewer than three times, of the scatter for fewer than twenty, and where the
/// file gives no time at all.
pub fn middle_and_scatter(timed: &Timed<'_>) -> Vec<Fact> {
    let Timed { pairs, .. } = *timed;
    let model = pairs.iter().map(|(_, model)| *model).collect::<Moments>().mean();
    if pairs.len() < FEWEST || model <= 0.0 || !model.is_finite() {
        return Vec::new();
    }
    let (mean, error) = excess(pairs);
    let scatter = scattered(timed, model);
    let about_scatter = scatter.map(|own| own.fact(timed));
    middle(timed, model, (mean, error), scatter).into_iter().chain(about_scatter).collect()
}

fn middle(timed: &Timed<'_>, model: f64, (mean, error): (f64, f64), scatter: Option<Scattered>) -> Option<Fact> {
    let count = timed.pairs.len() as f64;
    let law = StudentsT::new(0.0, 1.0, count - 1.0).ok()?;
    let p = 2.0 * law.sf((mean / error).abs());
    let estimate = model + mean;
    let half = student(0.9, count - 1.0) * error;
    let normal = Normal::standard();
    let deviation = (timed.law.variation() * model).hypot(CLOCK) / count.sqrt();
    let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * deviation / model;
    // A machine or a tool has no constant for one shift.
    let told = !timed.shifts.is_empty() || scatter.is_some_and(|own| own.factor < REFUSED && own.summand > KEPT);
    let constant = timed.shifts.is_empty() && scatter.is_some_and(|own| own.summand < REFUSED && own.factor > KEPT);
    let delay = Delay { effect: timed.effect, size: mean, standard_error: error, told };
    let delay = (mean > 0.0 && !constant).then_some(delay);
    Some(Fact {
        told: FactDetail { shifts: timed.shifts.to_vec(), delay, ..FactDetail::default() },
        p,
        tests: vec![("middle", p)],
        model,
        estimate,
        ci90: [estimate - half, estimate + half],
        least_seen: [(1.0 - reach).max(0.0), 1.0 + reach],
        ..timed.untold(timed.quantity)
    })
}

impl Timed<'_> {
    /// A fact of these times of which nothing is said.
    fn untold(&self, quantity: Quantity) -> Fact {
        let count = self.pairs.len();
        let (place, told) =
            (self.place.to_owned(), FactDetail { shifts: self.shifts.to_vec(), ..FactDetail::default() });
        let (pooled, expected) = (self.pooled, count as f64);
        let (p, tests, model, estimate) = (1.0, Vec::new(), f64::NAN, f64::NAN);
        let (ci90, least_seen, count) = ([f64::NAN; 2], [f64::NAN; 2], count as u64);
        Fact { quantity, place, pooled, told, count, expected, p, tests, model, estimate, ci90, least_seen }
    }
}

/// The scatter of times where the file is off by a factor, and where something is added to every time.
#[derive(Clone, Copy, Debug)]
struct Scattered {
    /// Probability under the first.
    factor: f64,
    /// And under the second.
    summand: f64,
    /// Standard deviation over the recorded mean (1).
    of_factor: f64,
    /// Over that of the file (1).
    of_summand: f64,
    /// Standard error of the logarithm of either (1).
    error: f64,
}

impl Scattered {
    /// By the better explanation.
    fn fact(self, timed: &Timed<'_>) -> Fact {
        let (p, estimate) =
            if self.factor >= self.summand { (self.factor, self.of_factor) } else { (self.summand, self.of_summand) };
        let normal = Normal::standard();
        let half = normal.inverse_cdf(0.95) * self.error;
        let reach = (normal.inverse_cdf(1.0 - 0.5 * LEVEL) + normal.inverse_cdf(POWER)) * self.error;
        Fact {
            p,
            tests: vec![("level", p)],
            model: timed.law.variation(),
            estimate,
            ci90: [estimate * (-half).exp(), estimate * half.exp()],
            least_seen: [(-reach).exp(), reach.exp()],
            ..timed.untold(Quantity::HandlingScatter)
        }
    }
}

/// The scatter of recorded times of which the file says `model` s in the mean; `None` where the file has none, or too few times
/// show it.
///
/// # Source
/// Standard error of a sample variance: Cramér 1946, section 27.4.
fn scattered(timed: &Timed<'_>, model: f64) -> Option<Scattered> {
    let shares: Moments = timed.pairs.iter().map(|(recorded, model)| recorded / model).collect();
    let (mean, deviation, count) = (shares.mean(), shares.standard_deviation(), timed.pairs.len());
    if timed.law.variation() <= 0.0 || count < FEWEST_SCATTERING || mean <= 0.0 {
        return None;
    }
    let power =
        |power: i32| timed.pairs.iter().map(|(recorded, model)| (recorded / model - mean).powi(power)).sum::<f64>();
    let n = count as f64;
    let kurtosis = power(4) / n / (power(2) / n).powi(2);
    let error = if kurtosis.is_finite() { ((kurtosis - 1.0).max(0.0) / (4.0 * (n - 1.0))).sqrt() } else { 0.0 };
    let error_of_clock = clock_error(timed.pairs.iter().map(|(recorded, _)| recorded), 1).max(CLOCK);
    let (of_factor, of_summand, clock) = (deviation / mean, deviation, error_of_clock / model);
    Some(Scattered {
        factor: timed.law.p(count, of_factor, Reference::OwnMean, clock / mean),
        summand: timed.law.p(count, of_summand, Reference::MeanOfLaw, clock),
        of_factor,
        of_summand,
        error,
    })
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

    fn law(cv: f64) -> RelativeLaw {
        RelativeLaw::new(|uniform| Distribution::Lognormal { mean: 60.0, cv }.quantile(uniform()))
    }

    fn asked(pairs: &[(f64, f64)], law: &RelativeLaw) -> Vec<Fact> {
        let (quantity, effect) = (Quantity::HandlingTime, "operator_delay");
        middle_and_scatter(&Timed { quantity, effect, place: "L1", pooled: false, shifts: &[], pairs, law })
    }

    #[test]
    fn a_true_file_is_rejected_as_often_as_the_level_says() {
        let law = law(VARIATION);
        for (count, facts) in [(8, 1), (60, 2)] {
            for fact in 0..facts {
                let p = |seed| asked(&recorded(count, 1.0, 0.0, seed), &law)[fact].p;
                let rejected = (0..400).filter(|seed| p(*seed) < 0.05).count();
                // Of 400 at 5 %: 20 with a standard deviation of 4.4; of two explanations the scatter has the better one.
                assert!((3..=34).contains(&rejected), "{count} {fact}: {rejected}");
            }
        }
    }

    #[test]
    fn what_the_clock_of_a_log_rounds_away_is_no_scatter() {
        let law = law(0.15);
        let rounded = |seed: u64| -> Vec<(f64, f64)> {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let step = |time: f64| (time / 10.0).round() * 10.0;
            let draw = Distribution::Lognormal { mean: 60.0, cv: 0.15 };
            let one = |_| {
                let begin: f64 = 1000.0 * random.random::<f64>();
                (step(begin + draw.quantile(random.random())) - step(begin), 60.0)
            };
            (0..300).map(one).collect()
        };
        let rejected = (0..100).filter(|seed| asked(&rounded(*seed), &law)[1].p < 0.01).count();
        assert!(rejected <= 4, "{rejected} of 100");
    }

    #[test]
    fn one_time_of_the_file_that_is_another_one_in_the_log_is_seen_whatever_its_scatter() {
        let exact: Vec<(f64, f64)> = vec![(180.0, 60.0); 5];
        let none = RelativeLaw::default();
        let fact = asked(&exact, &none).remove(0);
        assert!(fact.p < 1e-6 && (fact.factor() - 3.0).abs() < 1e-12, "{fact:?}");
        let delay = fact.told.delay.expect("what is too long may be a delay");
        assert!(!delay.told && (delay.size - 120.0).abs() < 1e-9);
        assert_eq!(asked(&[(60.0, 60.0); 5], &none)[0].p, 1.0);
        assert!(asked(&exact[..2], &none).is_empty());
    }

    #[test]
    fn a_delay_is_told_from_a_constant_by_the_scatter_that_it_leaves() {
        let law = law(VARIATION);
        for seed in 0..5 {
            let added = asked(&recorded(400, 1.0, 30.0, seed), &law).remove(0);
            assert!(added.told.delay.as_ref().is_some_and(|own| own.told), "{seed}: {added:?}");
            let times = asked(&recorded(400, 1.5, 0.0, seed), &law).remove(0);
            assert!(times.told.delay.is_none(), "{seed}: {times:?}");
            assert!(added.is_rejected(0.01) && times.is_rejected(0.01));
        }
    }

    #[test]
    fn a_scatter_that_neither_explains_is_seen_and_groups_that_differ_do_not_agree() {
        let wide = asked(&recorded(400, 1.0, 0.0, 1), &law(0.15));
        let [middle, scatter] = &wide[..] else { panic!("{wide:?}") };
        assert!(scatter.quantity == Quantity::HandlingScatter && scatter.p < 1e-6, "{wide:?}");
        assert!((1.7..2.3).contains(&scatter.factor()) && !middle.is_rejected(0.01), "{wide:?}");
        let [a, b, c] = [recorded(50, 1.0, 0.0, 1), recorded(50, 1.0, 0.0, 2), recorded(50, 1.0, 25.0, 3)];
        assert!(agree(&[&a, &b]) && !agree(&[&a, &b, &c]) && agree(&[&a, &b, &c[..2]]) && agree(&[]));
    }
}
