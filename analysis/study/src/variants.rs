//! Variants of a shop: the same study with some values changed, and what that changes.
//!
//! Every variant runs the replications of the shop as it is, on the same random numbers: they belong to the names of
//! orders, operations and machines, not to their number. Differences are therefore paired by replication.

mod branch;
mod selection;

pub use branch::{NoBranch, POSSIBLE, branched};
pub use selection::{NoSelection, SelectedShop, Wanted};

use crate::figure::{decimals, label, plain, shown, signed};
use crate::kpi::Kpi;
use crate::planner::late;
use crate::study::{Progress, Study, StudyError, StudyOptions, by_draw, run_study};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use toolroom_form::ReadError;
use toolroom_process::table::CsvWriter;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::{AS_IT_IS, ScenarioFile, ShopVariant, parse};
use toolroom_statistics::{CONFIDENCE, Interval, paired, t_interval};

/// A shop with some values changed.
#[derive(Clone, Debug)]
pub struct VariantShop {
    /// Name of the variant.
    pub name: String,
    /// The shop.
    pub scenario: Arc<Scenario>,
    /// Files that it names.
    pub files: Vec<PathBuf>,
}

/// A variant that cannot be run.
#[derive(Debug, thiserror::Error)]
#[error("variant \"{name}\": {source}")]
pub struct VariantError {
    /// Name of the variant.
    pub name: String,
    /// What is wrong.
    pub source: Wrong,
}

/// What is wrong with a variant.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Wrong {
    /// The file does not take its changes.
    #[error(transparent)]
    Read(#[from] Box<ReadError>),
    /// The shop cannot be changed that way while it runs.
    #[error(transparent)]
    Branch(#[from] NoBranch),
}

impl VariantError {
    /// The way out.
    pub fn fix(&self) -> &'static str {
        match &self.source {
            Wrong::Read(_) => "change its `set`: each path is one that --set takes",
            Wrong::Branch(_) => POSSIBLE,
        }
    }
}

/// The shops of all variants of a file that was read as `name` with `changes` and said `text`.
///
/// # Errors
/// [`VariantError`] of the first that cannot be run.
pub fn shops(
    name: &str,
    text: &str,
    changes: &[String],
    variants: &[ShopVariant],
) -> Result<Vec<VariantShop>, VariantError> {
    let read = |changes: &[String]| Ok::<_, Wrong>(parse(name, text, changes).map_err(Box::new)?);
    let shop = |variant: &ShopVariant| {
        let all: Vec<String> = changes.iter().chain(&variant.set).cloned().collect();
        let ScenarioFile { scenario, files, .. } = read(&all)?;
        let scenario = match variant.from {
            Some(time) => branched(&read(changes)?.scenario, &scenario, time, &variant.set)?,
            None => scenario,
        };
        Ok(VariantShop { name: variant.name.clone(), scenario: Arc::new(scenario), files })
    };
    let named =
        |variant: &ShopVariant| shop(variant).map_err(|source| VariantError { name: variant.name.clone(), source });
    variants.iter().map(named).collect()
}

/// Figures of a variant in every replication.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariantRuns {
    /// Name of the variant.
    pub name: String,
    /// By policy and replication: figures of the shop in the order of the study, then the number of late orders where
    /// there are orders. Null where one is not defined.
    values: Vec<Vec<Vec<Option<f64>>>>,
}

impl VariantRuns {
    /// Figures of a study of the variant.
    fn from_name(name: &str, scenario: &Scenario, study: &Study) -> Self {
        let count = study.policies.len();
        Self { name: name.to_owned(), values: (0..count).map(|policy| figures(scenario, study, policy)).collect() }
    }

    /// A figure in every replication; NaN where it is not defined.
    fn sample(&self, policy: usize, figure: usize) -> Vec<f64> {
        self.values[policy].iter().map(|values| values.get(figure).copied().flatten().unwrap_or(f64::NAN)).collect()
    }
}

/// Figures of the shop under a policy in every replication, and the number of late orders.
fn figures(scenario: &Scenario, study: &Study, policy: usize) -> Vec<Vec<Option<f64>>> {
    let count = shop_figures(study).len();
    let late = late(scenario, study, policy);
    let keep = |(replication, values): (usize, Vec<f64>)| {
        let values = values[..count].iter().copied();
        let late = late.get(replication).copied();
        values.chain(late).map(|value| Some(value).filter(|value| value.is_finite())).collect()
    };
    study.replications(policy).enumerate().map(keep).collect()
}

/// Figures of the shop; they stand before those of machines.
fn shop_figures(study: &Study) -> &[Kpi] {
    let machines = study.kpis.iter().position(|kpi| kpi.machine.is_some()).unwrap_or(study.kpis.len());
    &study.kpis[..machines]
}

/// Runs every variant as often as `study` was run. Where `stop` is set on the way, the study is not complete and has none.
///
/// # Errors
/// [`StudyError`] of the first variant that stopped.
pub(crate) fn run(
    scenario: &Scenario,
    study: &mut Study,
    options: &StudyOptions,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<(), StudyError> {
    let runs_each = study.replications.saturating_mul(study.policies.len() as u32);
    let total = runs_each.saturating_mul(1 + options.variants.len() as u32);
    let mut runs = Vec::with_capacity(options.variants.len());
    for (place, variant) in (1..).zip(&options.variants) {
        let variant_options = StudyOptions {
            policies: study.policies.clone(),
            replications: study.replications,
            threads: options.threads,
            logged: 0,
            known: Arc::clone(&options.known),
            journal: options.journal.clone(),
            shop: place,
            ..StudyOptions::of(&variant.scenario)
        };
        let report = |run: Progress| progress(Progress { done: runs_each.saturating_mul(place) + run.done, total });
        let done = run_study(&variant.scenario, &variant_options, None, &report, stop)
            .map_err(|source| StudyError::Variant { name: variant.name.clone(), source: Box::new(source) })?;
        if !done.complete {
            study.complete = false;
            return Ok(());
        }
        runs.push(VariantRuns::from_name(&variant.name, &variant.scenario, &done));
    }
    study.variants = runs;
    if let Some(wanted) = &options.select {
        study.selection = selection::select(scenario, study, options, wanted, stop)?;
        study.complete = study.selection.is_some();
    }
    Ok(())
}

/// One figure of a variant against the shop as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct VariantFigure {
    /// Its own value.
    pub value: Interval,
    /// Difference to the shop as it is, paired by replication.
    pub difference: Interval,
    /// Whether the difference is not zero at 95 % for all variants together (Bonferroni).
    pub resolved: bool,
}

/// Value and difference of a figure under a variant; `figure` counts those of the shop, the number of late orders last.
fn against(study: &Study, base: &VariantRuns, runs: &VariantRuns, policy: usize, figure: usize) -> VariantFigure {
    let independent = |runs: &VariantRuns| by_draw(runs.sample(policy, figure), study.alike);
    let (sample, reference) = (independent(runs), independent(base));
    let together = 1.0 - (1.0 - CONFIDENCE) / study.variants.len().max(1) as f64;
    VariantFigure {
        value: t_interval(&sample, CONFIDENCE),
        difference: paired(&sample, &reference, CONFIDENCE).difference,
        resolved: paired(&sample, &reference, together).difference.excludes(0.0),
    }
}

/// Figures of the table, where they are defined.
const COLUMNS: [&str; 6] = ["parts_per_shift", "cost_per_part", "lead_time", "tardiness", "tardy_share", "wip"];

/// Id of the number of late orders.
pub(crate) const LATE_ORDERS: &str = "late_orders";

/// Title of the number of late orders.
const LATE: &str = "late orders";

/// A table of every variant, by policy: head and rows of cells.
pub(crate) struct VariantTable {
    /// Policy, where there are several.
    pub policy: Option<String>,
    /// Names of the columns, that of the variants first and empty.
    pub head: Vec<String>,
    /// The shop as it is, then every variant.
    pub rows: Vec<Vec<String>>,
}

/// What is shown of the variants of a study.
pub(crate) fn tables(scenario: &Scenario, study: &Study) -> Vec<VariantTable> {
    if study.variants.is_empty() {
        return Vec::new();
    }
    let base = VariantRuns::from_name(AS_IT_IS, scenario, study);
    let shop = shop_figures(study);
    let table = |policy: usize| {
        let defined = |figure: usize| {
            let value =
                |runs: &VariantRuns| runs.sample(policy, figure).iter().any(|value| value.is_finite() && *value != 0.0);
            std::iter::once(&base).chain(&study.variants).any(value)
        };
        let known = COLUMNS.iter().filter_map(|id| shop.iter().position(|kpi| kpi.definition.id == *id));
        let columns: Vec<usize> = known.chain([shop.len()]).filter(|figure| defined(*figure)).collect();
        let title = |figure: &usize| shop.get(*figure).map_or_else(|| LATE.to_owned(), |kpi| label(scenario, kpi));
        let in_unit =
            |figure: usize, interval: &Interval| shop.get(figure).map_or(*interval, |kpi| shown(kpi, interval));
        let row = |runs: &VariantRuns| {
            let cell = |figure: &usize| {
                let comparison = against(study, &base, runs, policy, *figure);
                let (value, change) = (in_unit(*figure, &comparison.value), in_unit(*figure, &comparison.difference));
                if runs.name == AS_IT_IS {
                    return plain(value.mean, decimals(value.mean, value.half_width));
                }
                // What does not vary, or is known once only, says nothing about the digits.
                let varies = change.half_width > 0.0;
                let digits = if varies { change } else { value };
                let digits = decimals(digits.mean, digits.half_width);
                let mut text = format!("{} ({}", plain(value.mean, digits), signed(change.mean, digits));
                if change.half_width.is_finite() {
                    let _ = write!(text, " ±{}", plain(change.half_width, digits));
                }
                text + if comparison.resolved { ")*" } else { ")" }
            };
            std::iter::once(runs.name.clone()).chain(columns.iter().map(cell)).collect()
        };
        VariantTable {
            policy: (study.policies.len() > 1).then(|| scenario.policies[study.policies[policy]].name.clone()),
            head: std::iter::once(String::new()).chain(columns.iter().map(title)).collect(),
            rows: std::iter::once(&base).chain(&study.variants).map(row).collect(),
        }
    };
    (0..study.policies.len()).map(table).collect()
}

/// What the tables mean, a line each.
pub(crate) const MEANING: [&str; 2] = [
    "in brackets the difference to the shop as it is, paired by replication, \u{b1} half the width of its 95 % interval",
    "* all variants together are certain of a difference at 95 %",
];

/// `variants` of the summary: differences of every figure of the shop under every policy.
pub(crate) fn json(scenario: &Scenario, study: &Study) -> Option<Value> {
    if study.variants.is_empty() {
        return None;
    }
    let base = VariantRuns::from_name(AS_IT_IS, scenario, study);
    let interval = |interval: Interval| json!({ "mean": interval.mean, "ci95": [interval.low(), interval.high()], "n": interval.count });
    let variant = |runs: &VariantRuns| {
        let policies = (0..study.policies.len()).map(|policy| {
            let named = |figure: usize| match shop_figures(study).get(figure) {
                Some(kpi) => (kpi.key(), kpi.definition.file_scale()),
                None => (LATE_ORDERS.to_owned(), 1.0),
            };
            let count = shop_figures(study).len() + usize::from(!scenario.orders.is_empty());
            let mut kpi = Map::new();
            let mut differences = Map::new();
            for figure in 0..count {
                let (key, scale) = named(figure);
                let comparison = against(study, &base, runs, policy, figure);
                let mut difference = interval(comparison.difference.scaled(scale));
                difference["resolved_together"] = json!(comparison.resolved);
                kpi.insert(key.clone(), interval(comparison.value.scaled(scale)));
                differences.insert(key, difference);
            }
            json!({ "name": scenario.policies[study.policies[policy]].name, "kpi": kpi, "differences": differences })
        });
        json!({ "name": runs.name, "policies": policies.collect::<Vec<_>>() })
    };
    Some(study.variants.iter().map(variant).collect())
}

/// Name of the table of variants beside the other results.
pub const FILE: &str = "variants.csv";

/// Writes one row a variant, policy, replication and figure of the shop, the shop as it is included.
pub(crate) fn write(scenario: &Scenario, study: &Study, out: impl io::Write) -> io::Result<()> {
    let mut csv = CsvWriter::new(out, ["variant", "policy", "replication", "kpi", "unit", "value"])?;
    let base = VariantRuns::from_name(AS_IT_IS, scenario, study);
    for runs in std::iter::once(&base).chain(&study.variants) {
        for (policy, replications) in runs.values.iter().enumerate() {
            for (replication, values) in (0u32..).zip(replications) {
                for (figure, value) in values.iter().enumerate() {
                    let kpi = shop_figures(study).get(figure).map(|kpi| &kpi.definition);
                    let unit = kpi.map_or("1", |kpi| kpi.file_unit_in(scenario));
                    let value = value.unwrap_or(f64::NAN) * kpi.map_or(1.0, |kpi| kpi.file_scale());
                    csv.row([
                        runs.name.as_str().into(),
                        scenario.policies[study.policies[policy]].name.as_str().into(),
                        replication.into(),
                        kpi.map_or(LATE_ORDERS, |kpi| kpi.id).into(),
                        unit.into(),
                        value.into(),
                    ])?;
                }
            }
        }
    }
    Ok(csv.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Comparison;
    use crate::fixture;
    use crate::study::{known, run_study, stored_runs};
    use crate::summary::summary;

    fn varied(threads: usize) -> (Scenario, Study) {
        let scenario = fixture::scenario();
        let mut faster = scenario.clone();
        faster
            .machines
            .iter_mut()
            .for_each(|machine| machine.load_time = toolroom_scenario::Distribution::Constant(0.0));
        let shop = |name: &str, scenario: &Scenario| VariantShop {
            name: name.to_owned(),
            scenario: Arc::new(scenario.clone()),
            files: Vec::new(),
        };
        let options = StudyOptions {
            replications: 6,
            threads,
            variants: vec![shop("the same", &scenario), shop("loaded in no time", &faster)],
            ..StudyOptions::of(&scenario)
        };
        let study = run_study(&scenario, &options, None, &|_| {}, &AtomicBool::new(false)).expect("a study");
        (scenario, study)
    }

    #[test]
    fn variants_are_paired_with_the_shop_as_it_is() {
        let (scenario, study) = varied(1);
        let summary = summary(&scenario, &study, &Comparison::new(&scenario, &study));
        let lead = |variant: usize| &summary["variants"][variant]["policies"][0]["differences"]["lead_time [min]"];
        // The same shop draws the same numbers.
        assert_eq!((&lead(0)["mean"], &lead(0)["ci95"]), (&json!(0.0), &json!([0.0, 0.0])));
        assert_eq!(lead(0)["resolved_together"], json!(false));
        // Loading took a minute on the lathe and ten seconds on the grinder; each of two parts waits for its own.
        let difference = lead(1)["mean"].as_f64().expect("a number");
        assert!((difference + 70.0 / 60.0).abs() < 0.3, "{difference}");
        assert_eq!(lead(1)["resolved_together"], json!(true));
        let table = &tables(&scenario, &study)[0];
        assert_eq!(
            table.rows.iter().map(|row| row[0].as_str()).collect::<Vec<_>>(),
            [AS_IT_IS, "the same", "loaded in no time"]
        );
        let lead = table.head.iter().position(|title| title.starts_with("lead time")).expect("a column");
        assert!(
            table.rows[2][lead].ends_with(")*") && table.rows[2][lead].contains('\u{2212}'),
            "{}",
            table.rows[2][lead]
        );
    }

    #[test]
    fn the_best_variant_is_selected_with_as_few_runs_as_needed() {
        let (scenario, _) = varied(1);
        let mut faster = scenario.clone();
        faster.machines.iter_mut().for_each(|own| own.load_time = toolroom_scenario::Distribution::Constant(0.0));
        let options = StudyOptions {
            replications: 3,
            variants: vec![VariantShop {
                name: "loaded in no time".to_owned(),
                scenario: Arc::new(faster),
                files: Vec::new(),
            }],
            select: Some(Wanted::parse(&scenario, "lead_time 0.1 min").expect("a selection")),
            ..StudyOptions::of(&scenario)
        };
        let study = run_study(&scenario, &options, None, &|_| {}, &AtomicBool::new(false)).expect("a study");
        let summary = summary(&scenario, &study, &Comparison::new(&scenario, &study));
        assert_eq!(summary["selection"]["best"], json!("loaded in no time"));
        assert!(summary["selection"]["equal_allocation"].as_u64() >= Some(20));
        for (text, word) in [
            ("lead_time", "are due"),
            ("lead 1 min", "known"),
            ("wip -1", "above zero"),
            ("cutting_share 1 %", "neither"),
        ] {
            let error = Wanted::parse(&scenario, text).expect_err(word).to_string();
            assert!(error.contains(word), "{error}");
        }
    }

    #[test]
    fn known_runs_of_a_variant_are_not_made_again() {
        let scenario = fixture::scenario();
        let mut faster = scenario.clone();
        faster.machines.iter_mut().for_each(|own| own.load_time = toolroom_scenario::Distribution::Constant(0.0));
        let variant = VariantShop { name: "faster".to_owned(), scenario: Arc::new(faster), files: Vec::new() };
        let policies: Vec<usize> = (0..scenario.policies.len()).collect();
        // Runs of the shop as it is in the place of those of the variant: they are taken as they are.
        let mut runs = stored_runs((0, &scenario), &policies, 0, 3).expect("runs");
        runs.iter_mut().for_each(|run| run.shop = 1);
        let options = StudyOptions {
            replications: 3,
            variants: vec![variant],
            known: Arc::new(known(runs)),
            ..StudyOptions::of(&scenario)
        };
        let study = run_study(&scenario, &options, None, &|_| {}, &AtomicBool::new(false)).expect("a study");
        assert_eq!(study.variants[0].values, VariantRuns::from_name(AS_IT_IS, &scenario, &study).values);
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let [one, two] = [varied(1).1, varied(2).1];
        assert_eq!((one.digest, &one.variants), (two.digest, &two.variants));
    }
}
