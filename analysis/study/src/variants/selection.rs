//! The best of a shop and its variants, with a guarantee.

use super::{LATE_ORDERS, VariantShop, shop_figures};
use crate::kpi::{Better, kpis};
use crate::planner::late_in;
use crate::study::{Study, StudyError, StudyOptions, stored_runs};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use toolroom_process::unit;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::AS_IT_IS;
use toolroom_statistics::{CONFIDENCE, Selection};

/// Most replications of a shop.
const MOST: u32 = 10_000;

/// Replications that are run at once.
const AT_ONCE: u32 = 16;

/// The figure by which the best shop is selected, and the least difference that matters.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Id of the figure.
    kpi: String,
    /// Least difference that matters.
    indifference: Difference,
    /// Probability of a right selection.
    confidence: f64,
    /// Whether the least value is the best.
    least: bool,
    /// As it was typed.
    text: String,
}

/// The least difference that matters.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Difference {
    /// In the SI unit of the figure.
    Absolute(f64),
    /// As a share of the mean of the shop as it is over its first replications.
    Relative(f64),
}

/// Replications of the shop as it is of which a relative difference is a share: those with which the procedure begins.
const FIRST: usize = 10;

/// A text that says no selection.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` selects nothing: {reason}")]
pub struct NoSelection {
    text: String,
    reason: String,
}

impl Wanted {
    /// `lead_time 0.5 min`: a figure of the shop and the least difference that matters.
    ///
    /// # Errors
    /// [`NoSelection`]: a figure that is not known or of which neither more nor less is better, a difference that is no
    /// quantity above zero of its unit.
    pub fn parse(scenario: &Scenario, text: &str) -> Result<Self, NoSelection> {
        let refuse = |reason: String| NoSelection { text: text.to_owned(), reason };
        let Some((id, difference)) = text.trim().split_once(' ') else {
            return Err(refuse(
                "a figure and the least difference that matters are due, such as \"lead_time 5 min\"".to_owned(),
            ));
        };
        let shop: Vec<_> = kpis(scenario).into_iter().filter(|kpi| kpi.machine.is_none()).collect();
        let (si, better) = if id == LATE_ORDERS && !scenario.orders.is_empty() {
            ("1", Better::Less)
        } else {
            let known = || shop.iter().map(|kpi| kpi.definition.id).collect::<Vec<_>>().join(", ");
            let found = shop.iter().find(|kpi| kpi.definition.id == id);
            let kpi = found.ok_or_else(|| refuse(format!("there is no figure `{id}`; known: {}", known())))?;
            (kpi.definition.unit, kpi.definition.better)
        };
        let difference = difference.trim();
        let share = difference.strip_suffix('%').filter(|_| si != "1");
        let indifference = if let Some(percent) = share {
            let percent = percent.trim().parse::<f64>();
            0.01 * percent.map_err(|_| refuse("a share in % of the shop as it is is due".to_owned()))?
        } else if si == "currency" {
            let number = difference.strip_suffix(scenario.currency.as_str()).unwrap_or(difference).trim();
            number.parse::<f64>().map_err(|_| refuse(format!("an amount of {} is due", scenario.currency)))?
        } else {
            unit::quantity(difference, si).map_err(|error| refuse(error.to_string()))?
        };
        if !(indifference > 0.0 && indifference.is_finite()) {
            return Err(refuse("the least difference that matters is above zero".to_owned()));
        }
        let least = match better {
            Better::Less => true,
            Better::More => false,
            Better::Neither => return Err(refuse(format!("neither more nor less of `{id}` is better"))),
        };
        let indifference =
            if share.is_some() { Difference::Relative(indifference) } else { Difference::Absolute(indifference) };
        Ok(Self { kpi: id.to_owned(), indifference, confidence: CONFIDENCE, least, text: text.trim().to_owned() })
    }

    /// The same with another probability of a right selection, 0.5 to below 1.
    #[must_use]
    pub fn with_confidence(self, confidence: f64) -> Self {
        Self { confidence, ..self }
    }

    /// As it was typed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The figure in a run of all figures.
    fn of(&self, scenario: &Scenario, values: &[f64]) -> f64 {
        if self.kpi == LATE_ORDERS {
            return late_in(scenario, &values[kpis(scenario).len()..]);
        }
        let place = kpis(scenario).iter().position(|kpi| kpi.machine.is_none() && kpi.definition.id == self.kpi);
        place.map_or(f64::NAN, |place| values[place])
    }
}

/// What was selected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SelectedShop {
    /// As it was asked for.
    asked: String,
    /// Probability of a right selection.
    #[serde(default = "usual_confidence")]
    confidence: f64,
    /// The shop as it is and its variants.
    names: Vec<String>,
    /// Replications of each until it was struck out or the end.
    replications: Vec<u32>,
    /// The best.
    best: Option<usize>,
    /// Those that could not be told apart.
    survivors: Vec<usize>,
}

/// Selects the best of the shop as it is and its variants under the first policy, with further replications where the
/// first ones do not suffice; `None` where `stop` is set on the way.
pub(super) fn select(
    scenario: &Scenario,
    study: &Study,
    options: &StudyOptions,
    wanted: &Wanted,
    stop: &AtomicBool,
) -> Result<Option<SelectedShop>, StudyError> {
    let policy = study.policies[0];
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .map_err(|source| StudyError::Threads { source })?;
    let shops: Vec<&Scenario> =
        std::iter::once(scenario).chain(options.variants.iter().map(|own| own.scenario.as_ref())).collect();
    let figure = if wanted.kpi == LATE_ORDERS {
        shop_figures(study).len()
    } else {
        study.index(&wanted.kpi).unwrap_or(usize::MAX)
    };
    let base = super::VariantRuns::from_name(AS_IT_IS, scenario, study);
    let mut samples: Vec<Vec<f64>> =
        std::iter::once(&base).chain(&study.variants).map(|runs| runs.sample(0, figure)).collect();
    let indifference = match wanted.indifference {
        Difference::Absolute(difference) => difference,
        Difference::Relative(share) => {
            let first = &samples[0][..samples[0].len().min(FIRST)];
            share * (first.iter().sum::<f64>() / first.len() as f64).abs()
        }
    };
    let selection = Selection {
        systems: shops.len(),
        indifference,
        confidence: wanted.confidence,
        least: wanted.least,
        most: MOST,
    };
    let selected = selection.select(|system, replication| -> Result<Option<f64>, StudyError> {
        let sample = &mut samples[system];
        if replication as usize >= sample.len() {
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let from = sample.len() as u32;
            let runs = pool.install(|| stored_runs((system as u32, shops[system]), &[policy], from, from + AT_ONCE))?;
            sample.extend(runs.iter().map(|run| wanted.of(shops[system], &run.figures())));
        }
        Ok(sample.get(replication as usize).copied())
    })?;
    if selected.best.is_none() && stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let name = |own: &VariantShop| own.name.clone();
    Ok(Some(SelectedShop {
        asked: wanted.text.clone(),
        confidence: wanted.confidence,
        names: std::iter::once(AS_IT_IS.to_owned()).chain(options.variants.iter().map(name)).collect(),
        replications: selected.replications,
        best: selected.best,
        survivors: selected.survivors,
    }))
}

fn usual_confidence() -> f64 {
    CONFIDENCE
}

impl SelectedShop {
    /// What it would have cost to run all shops as often as the last.
    fn equal(&self) -> u32 {
        self.names.len() as u32 * self.replications.iter().copied().max().unwrap_or(0)
    }

    /// In words: what was selected, what that means, and what it took.
    pub(crate) fn sentences(&self) -> Vec<String> {
        let counts: Vec<String> =
            self.names.iter().zip(&self.replications).map(|(name, count)| format!("{name} {count}")).collect();
        let runs: u32 = self.replications.iter().sum();
        let cost =
            format!("{runs} runs: {}; the same number of each would have been {}", counts.join(", "), self.equal());
        match self.best {
            Some(best) => vec![
                format!("selected by {}: {}", self.asked, self.names[best]),
                format!(
                    "  with a probability of at least {} % the best, if it is better than all others by that much (Kim and \
                     Nelson)",
                    100.0 * self.confidence
                ),
                format!("  {cost}"),
            ],
            None => {
                let left: Vec<&str> = self.survivors.iter().map(|&place| self.names[place].as_str()).collect();
                vec![
                    format!("selected by {}: nothing, {} cannot be told apart", self.asked, left.join(", ")),
                    format!("  {cost}"),
                ]
            }
        }
    }

    /// `selection` of the summary.
    pub(crate) fn json(&self) -> Value {
        let counts = self.names.iter().zip(&self.replications).map(|(name, count)| (name.clone(), json!(count)));
        json!({
            "procedure": "kn",
            "by": self.asked,
            "best": self.best.map(|best| self.names[best].as_str()),
            "confidence": self.confidence,
            "replications": counts.collect::<serde_json::Map<_, _>>(),
            "equal_allocation": self.equal(),
        })
    }
}
