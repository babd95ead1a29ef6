//! What a difference owes to chance and what to parameters that are not known, where tools take draws of a posterior.

use super::Decision;
use crate::figure::{decimals, plain, signed};
use crate::study::Study;
use statrs::distribution::{Continuous, ContinuousCDF, Normal};
use toolroom_scenario::Scenario;

/// A difference over draws of a posterior, each simulated several times.
///
/// # Source
/// Variance components of a one-way layout; value of perfect information under a normal distribution: H. Raiffa,
/// R. Schlaifer, Applied Statistical Decision Theory, Harvard 1961, section 5.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnDifference {
    /// Mean difference over the draws.
    pub difference: f64,
    /// Standard deviation of the difference from draw to draw, without what simulation adds; zero where it adds all of it.
    pub sd_parameters: f64,
    /// Standard error of the mean difference that comes from simulation alone.
    pub se_simulation: f64,
}

impl DrawnDifference {
    /// Mean difference and standard error within each draw; `None` for fewer than two draws.
    ///
    /// # Examples
    /// ```
    /// use toolroom_study::compare::DrawnDifference;
    /// let draws = [-0.9, -0.4, -0.1, -0.7, 0.2, -0.6, -0.3, -0.5];
    /// let errors = [0.15, 0.12, 0.2, 0.14, 0.16, 0.15, 0.13, 0.18];
    /// let found = DrawnDifference::from_draws(&draws.into_iter().zip(errors).collect::<Vec<_>>()).unwrap();
    /// assert!((found.sd_parameters - 0.3114683).abs() < 1e-7 && (found.se_simulation - 0.0550426).abs() < 1e-7);
    /// ```
    pub fn from_draws(draws: &[(f64, f64)]) -> Option<Self> {
        let count = draws.len() as f64;
        if draws.len() < 2 || draws.iter().any(|(mean, error)| !(mean.is_finite() && error.is_finite())) {
            return None;
        }
        let difference = draws.iter().map(|(mean, _)| mean).sum::<f64>() / count;
        let between = draws.iter().map(|(mean, _)| (mean - difference).powi(2)).sum::<f64>() / (count - 1.0);
        let within = draws.iter().map(|(_, error)| error * error).sum::<f64>();
        let sd_parameters = (between - within / count).max(0.0).sqrt();
        Some(Self { difference, sd_parameters, se_simulation: within.sqrt() / count })
    }

    /// Means and standard errors within draws of differences that come `per_draw` to a draw, in order. A last draw that is
    /// not complete is left out.
    pub fn of_replications(differences: &[f64], per_draw: usize) -> Option<Self> {
        if per_draw < 2 {
            return None;
        }
        let count = per_draw as f64;
        let draws = differences.chunks_exact(per_draw).map(|values| {
            let mean = values.iter().sum::<f64>() / count;
            let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
            (mean, (variance / count).sqrt())
        });
        Self::from_draws(&draws.collect::<Vec<_>>())
    }

    /// Probability that the true difference is below zero, as far as the data of the calibration tell.
    ///
    /// # Examples
    /// ```
    /// use toolroom_study::compare::DrawnDifference;
    /// let found = DrawnDifference { difference: -0.5, sd_parameters: 0.4, se_simulation: 0.0 };
    /// assert!((found.better() - 0.8943502).abs() < 1e-7);
    /// assert!((found.value_of_information() - 0.02023475).abs() < 1e-8);
    /// ```
    pub fn better(&self) -> f64 {
        if self.sd_parameters == 0.0 {
            return if self.difference < 0.0 { 1.0 } else { 0.0 };
        }
        Normal::standard().cdf(-self.difference / self.sd_parameters)
    }

    /// Expected value of knowing the parameters before choosing, in the unit of the difference.
    pub fn value_of_information(&self) -> f64 {
        if self.sd_parameters == 0.0 {
            return 0.0;
        }
        let normal = Normal::standard();
        let z = self.difference.abs() / self.sd_parameters;
        self.sd_parameters * (normal.pdf(z) - z * normal.sf(z))
    }
}

/// Draws below which a deviation over them is rough: that of 20 is known to a sixth (assumption).
const FEW_DRAWS: usize = 20;

/// What is to be said beside the decision where tools take draws.
pub(super) fn notes(scenario: &Scenario, study: &Study, decision: &Decision) -> Vec<String> {
    let per_draw = scenario.replications_per_draw();
    let draws = study.replications.div_ceil(per_draw) as usize;
    let posteriors = scenario.tools.iter().filter_map(|tool| Some((&tool.name, tool.posterior.as_ref()?.count())));
    let posteriors: Vec<_> = posteriors.collect();
    if posteriors.is_empty() {
        return Vec::new();
    }
    let mut notes = Vec::new();
    for (name, count) in posteriors.iter().filter(|(_, count)| *count < draws) {
        notes.push(format!(
            "tool {name} has {count} draws, fewer than the {draws} that are taken: they are reused in order"
        ));
    }
    let Some(cost) = study.index("cost_per_part") else { return notes };
    if study.policies.len() > 1 && (study.replications / per_draw) < 2 {
        notes.push(format!(
            "the parameters are drawn from a posterior; with fewer than two draws of {per_draw} replications the interval \
             does not tell what they leave open: take {} replications or more",
            2 * per_draw
        ));
        return notes;
    }
    let pairs: Vec<(usize, usize)> = match (decision.adaptive, decision.rival) {
        (Some(adaptive), Some(rival)) => vec![(adaptive, rival)],
        // Where nothing is adaptive, as in milling, every policy stands against the first.
        (None, _) | (_, None) => (1..study.policies.len()).map(|policy| (policy, 0)).collect(),
    };
    let name = |place: usize| scenario.policies[study.policies[place]].name.as_str();
    for (policy, other) in pairs {
        let (costs, rival) = (study.values(policy, cost), study.values(other, cost));
        let differences: Vec<f64> = costs.iter().zip(&rival).map(|(cost, rival)| cost - rival).collect();
        let Some(found) = DrawnDifference::of_replications(&differences, per_draw as usize) else { continue };
        let digits = decimals(found.difference, found.sd_parameters.max(found.se_simulation));
        let value = found.value_of_information();
        let drawn = differences.len() / per_draw as usize;
        let rough = if drawn < FEW_DRAWS {
            format!(" (so few draws say it roughly: {} replications take {FEW_DRAWS})", FEW_DRAWS * per_draw as usize)
        } else {
            String::new()
        };
        notes.push(format!(
            "{} against {} over {} draws of the parameters: difference {}, ±{} from what the data leave open, ±{} from \
             simulation (one deviation each); better in {:.0} % of what your data allow; to know the parameters is worth {} {} \
             a part{rough}",
            name(policy),
            name(other),
            drawn,
            signed(found.difference, digits),
            plain(found.sd_parameters, digits),
            plain(found.se_simulation, digits),
            100.0 * found.better(),
            plain(value, decimals(value, 0.1 * value)),
            scenario.currency,
        ));
    }
    notes
}
