//! The results of a study: summary, table of cells, report.

mod figures;
mod worked;

use super::End;
use super::shard::Merged;
use super::tally::ERROR;
use crate::analysis::Request;
use crate::file::StudyFile;
use crate::page::{self, Words};
use crate::regression::Regression;
use crate::sample::SampleError;
use figures::{fan, sensitivities, taylor};
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_chart::page::{Figure, Provenance, Report, Section};
use toolroom_chart::{ResultFiles, Table, number};
use toolroom_form::{FormFile, significant};
use toolroom_process::table::{Cell as CsvCell, csv_text};
use toolroom_shards::{Plan, fingerprint};
use worked::{Sensitivity, Worked, chipped, early, name, outlived, regression, sensitivity, work};

/// What a result is made of.
pub struct Inputs<'a> {
    /// The plan of the study.
    pub plan: &'a Plan,
    /// The file of the plan.
    pub parsed: &'a FormFile<StudyFile>,
    /// The lives of all shards.
    pub merged: &'a Merged,
    /// Which statistics are wanted.
    pub request: &'a Request,
}

/// A cell of which the lives cannot be analysed.
#[derive(Debug, thiserror::Error)]
#[error("{cell}: {source}")]
pub struct RefusedCell {
    /// Condition and policy.
    pub cell: String,
    /// What is wrong with the lives.
    pub source: SampleError,
}

/// What a study says.
pub struct StudyResults {
    /// For programs: what is in `summary.json`.
    pub summary: Value,
    /// Lines for a terminal.
    pub text: String,
    /// `summary.json`, `cells.csv` and `report.html`.
    pub files: ResultFiles,
}

/// Cells whose laws and pictures are in the report.
const SHOWN: usize = 4;
/// Two-sided 95 % quantile of the normal law.
const Z: f64 = 1.959_964;

/// The files of a study.
pub const NAMES: &[&str] = &["summary.json", "cells.csv", "report.html"];

/// Works out a finished study.
///
/// # Errors
/// [`RefusedCell`]: a condition and policy of which the lives cannot be analysed.
pub fn results(inputs: &Inputs<'_>) -> Result<StudyResults, RefusedCell> {
    let study = &inputs.parsed.content.study;
    let worked = inputs
        .merged
        .cells
        .par_iter()
        .zip(&study.cells)
        .map(|(tally, cell)| work(cell, tally, study, inputs.request))
        .collect::<Result<Vec<_>, _>>()?;
    let regression = regression(study);
    let indices = inputs.parsed.content.sensitivity.map(|(samples, paths)| sensitivity(study, samples, paths));
    let summary = summary(inputs, &worked, regression.as_ref(), indices.as_ref());
    let mut files = ResultFiles::default();
    files.push("summary.json", format!("{summary:#}\n"));
    files.push("cells.csv", csv(&overview(&worked)));
    files.push("report.html", report(inputs, &worked, regression.as_ref(), indices.as_ref()).html());
    Ok(StudyResults { summary, text: text(inputs, &worked), files })
}

fn overview(worked: &[Worked<'_>]) -> Table {
    let mut table = Table::new([
        "condition",
        "policy",
        "lives",
        "mean life [min]",
        "± 95 % [min]",
        "CV of life",
        "mean path [m]",
        "CV of path",
        "5 % path [m]",
        "path rate, 2 min change [m/min]",
        "B10 [min]",
        "chipped",
    ]);
    for cell in worked {
        let tally = cell.tally;
        let (life, path) = (tally.life.mean() / 60.0, tally.path.mean());
        table.push([
            cell.cell.condition.as_str().into(),
            cell.cell.policy.as_str().into(),
            (tally.life.count() as f64).into(),
            life.into(),
            (Z * tally.standard_error() / 60.0).into(),
            tally.life.variation().into(),
            path.into(),
            tally.path.variation().into(),
            tally.paths.quantile(0.05).into(),
            (path / (life + 2.0)).into(),
            match &cell.analysis {
                Ok(analysis) if analysis.reach.reaches(analysis.b10.value) => analysis.b10.value,
                Ok(_) | Err(_) => f64::NAN,
            }
            .into(),
            chipped(tally).into(),
        ]);
    }
    table
}

fn csv(table: &Table) -> String {
    use toolroom_chart::Cell::{Number, Text};
    let rows = table.rows().iter().map(|row| {
        row.iter().map(|cell| match cell {
            Number(value) => CsvCell::Number(*value),
            Text(text) => CsvCell::Text(text),
        })
    });
    csv_text(table.columns(), rows).expect("every row is as long as the header")
}

fn words() -> Words {
    // Files of studies state costs in this currency only.
    Words { unit: "min".to_owned(), money: "EUR".to_owned() }
}

fn summary(
    inputs: &Inputs<'_>,
    worked: &[Worked<'_>],
    regression: Option<&(Regression, Vec<(f64, f64)>)>,
    sensitivity: Option<&Sensitivity>,
) -> Value {
    let study = &inputs.parsed.content.study;
    let as_json = |cell: &Worked<'_>| {
        let tally = cell.tally;
        let mut object = Map::from_iter([
            ("condition".to_owned(), json!(cell.cell.condition)),
            ("policy".to_owned(), json!(cell.cell.policy)),
        ]);
        if let Ok(analysis) = &cell.analysis {
            object.extend(page::json(&cell.sample, analysis, &words()));
        }
        // Moments of the lives themselves, not of classes or laws.
        object.insert("n".to_owned(), json!(tally.life.count()));
        let restricted = outlived(tally) > 0.0;
        let (mean, none) = (json!(tally.life.mean() / 60.0), Value::Null);
        object.insert("mean [min]".to_owned(), if restricted { none } else { mean.clone() });
        object.insert("restricted_mean [min]".to_owned(), mean);
        object.insert("outlived".to_owned(), json!(outlived(tally)));
        object.insert("standard_error [min]".to_owned(), json!(tally.standard_error() / 60.0));
        object.insert("cv".to_owned(), json!(tally.life.variation()));
        let all = |share: f64| {
            let mut lives = tally.ends[0].clone();
            tally.ends[1..].iter().for_each(|other| lives.merge(other));
            lives.quantile(share) / 60.0
        };
        // What edges that outlived the study would have come to is not known.
        let seen = |share: f64| if share <= 1.0 - outlived(tally) { json!(all(share)) } else { Value::Null };
        let quantiles =
            [("p1", 0.01), ("p5", 0.05), ("p10", 0.1), ("p50", 0.5), ("p90", 0.9), ("p95", 0.95), ("p99", 0.99)];
        let quantiles: Map<String, Value> =
            quantiles.iter().map(|(name, share)| (format!("{name} [min]"), seen(*share))).collect();
        object.insert("quantiles".to_owned(), Value::Object(quantiles));
        object.insert("path".to_owned(), json!({ "mean [m]": tally.path.mean(), "cv": tally.path.variation(), "p5 [m]": tally.paths.quantile(0.05) }));
        let ends: Map<String, Value> = End::ALL
            .iter()
            .zip(&tally.ends)
            .map(|(end, sketch)| (end.name().to_owned(), json!(sketch.weight())))
            .collect();
        object.insert("ends".to_owned(), Value::Object(ends));
        if let Some((wear, rate)) = cell.by_wear {
            object
                .insert("replacement_by_wear".to_owned(), json!({ "flank_wear [mm]": wear * 1e3, "cost_rate": rate }));
        }
        if let Some([low, middle, high]) = cell.median_edge {
            let json = json!({ "draws": study.worlds.len(), "median [min]": middle, "ci90 [min]": [low, high] });
            object.insert("edge_of_median_level".to_owned(), json);
        }
        if study.early > 0.0 {
            let (probability, error) = early(tally);
            object.insert("early".to_owned(), json!({ "age [min]": study.early / 60.0, "probability": probability, "standard_error": error, "effective_lives": tally.effective() }));
        }
        Value::Object(object)
    };
    let cells: Vec<Value> = worked.iter().map(as_json).collect();
    let mut object = Map::from_iter([("schema".to_owned(), json!(1)), ("name".to_owned(), json!(study.name))]);
    if let Some(Value::Object(first)) = cells.first() {
        object.extend(first.clone());
    }
    object.insert("cells".to_owned(), json!(cells));
    object.insert("quantile_error".to_owned(), json!(ERROR));
    if let Some((regression, _)) = regression {
        let coefficients: Map<String, Value> = std::iter::once("intercept")
            .chain(regression.names.iter().map(String::as_str))
            .zip(regression.coefficients.iter().zip(&regression.standard_errors))
            .map(|(name, (coefficient, error))| {
                (name.to_owned(), json!({ "coefficient": coefficient, "standard_error": error }))
            })
            .collect();
        object.insert("regression".to_owned(), json!({ "coefficients": coefficients, "sigma": regression.sigma }));
    }
    if let Some(sensitivity) = sensitivity {
        let rows: Vec<Value> = (0..sensitivity.indices.len())
            .map(|j| {
                let (index, effect) = (&sensitivity.indices[j], &sensitivity.effects[j]);
                json!({
                    "input": study.coordinate(j),
                    "first": { "value": index.first.value, "interval": [index.first.low, index.first.high] },
                    "total": { "value": index.total.value, "interval": [index.total.low, index.total.high] },
                    "morris": { "size [min]": effect.size, "mean [min]": effect.mean, "scatter [min]": effect.scatter },
                    "swing [min]": [sensitivity.swings[j].0, sensitivity.swings[j].1],
                })
            })
            .collect();
        object.insert("sensitivity".to_owned(), json!(rows));
    }
    object.insert("digest".to_owned(), json!(format!("{:016x}", inputs.merged.digest)));
    Value::Object(object)
}

fn text(inputs: &Inputs<'_>, worked: &[Worked<'_>]) -> String {
    let study = &inputs.parsed.content.study;
    let mut text = format!("{} · {} lives each · seed {}\n", study.title, study.lives, study.seed);
    let _ = writeln!(
        text,
        "  {:32} {:>10} {:>8} {:>7} {:>10} {:>7} {:>9} {:>8}",
        "", "life, min", "±", "CV", "path, m", "CV", "B10, min", "chipped"
    );
    for cell in worked {
        let tally = cell.tally;
        let b10 = match &cell.analysis {
            Ok(analysis) if analysis.reach.reaches(analysis.b10.value) => number(analysis.b10.value, 3),
            Ok(analysis) => format!("> {}", number(analysis.reach.last, 3)),
            Err(_) => "–".to_owned(),
        };
        let _ = writeln!(
            text,
            "  {:32} {:>10} {:>8} {:>7} {:>10} {:>7} {b10:>9} {:>7} %",
            name(cell.cell),
            number(tally.life.mean() / 60.0, 4),
            number(Z * tally.standard_error() / 60.0, 2),
            number(tally.life.variation(), 3),
            number(tally.path.mean(), 4),
            number(tally.path.variation(), 3),
            number(100.0 * chipped(tally), 3),
        );
        if let Some([low, middle, high]) = cell.median_edge {
            let [low, middle, high] = [low, middle, high].map(|life| number(life, 3));
            let _ = writeln!(
                text,
                "    edge of median level over {} draws of the parameters: {middle} min, 90 % {low} … {high}",
                study.worlds.len()
            );
        }
        if study.early > 0.0 {
            let (probability, error) = early(tally);
            let _ = writeln!(
                text,
                "    fails before {} min: {} ± {}",
                significant(study.early / 60.0),
                number(probability, 3),
                number(Z * error, 2)
            );
        }
    }
    if let Some(share) = worked.iter().map(|cell| outlived(cell.tally)).reduce(f64::max).filter(|share| *share > 0.0) {
        let _ = writeln!(
            text,
            "  up to {} % of the edges of a line were still good when the study stopped: its mean life is a restricted mean",
            number(100.0 * share, 3)
        );
    }
    if let Some(Ok(analysis)) = worked.first().map(|cell| &cell.analysis) {
        let best = &analysis.by_age;
        let first = name(worked[0].cell);
        let _ = if !analysis.replacement_seen() {
            writeln!(text, "{first}: when to replace is not reached by t = {} min", number(analysis.reach.last, 3))
        } else if best.age.is_finite() {
            let saves = match analysis.reach.reaches_mean() {
                true => format!(", saves {:.1} % against {}", 100.0 * best.saving(), analysis.until_the_end()),
                false => String::new(),
            };
            writeln!(text, "{first}: replace at {} min{saves}", number(best.age, 3))
        } else {
            let end = if analysis.limit_is_seen { "use every edge up to its limit" } else { "run to failure" };
            writeln!(text, "{first}: {end}, replacing by age does not pay")
        };
    }
    let _ = writeln!(text, "digest {:016x}", inputs.merged.digest);
    text
}

fn report(
    inputs: &Inputs<'_>,
    worked: &[Worked<'_>],
    regression: Option<&(Regression, Vec<(f64, f64)>)>,
    sensitivity: Option<&Sensitivity>,
) -> Report {
    let study = &inputs.parsed.content.study;
    let mut report = Report::new(study.title.as_str());
    if let Some(first) = worked.first()
        && let Ok(analysis) = &first.analysis
    {
        report = report.lead(format!(
            "{} lives of each of {} cells; key figures are those of {}.",
            study.lives,
            worked.len(),
            name(first.cell)
        ));
        for tile in page::tiles(&first.sample, analysis, &words(), inputs.request.confidence) {
            report = report.tile(tile);
        }
    }
    let mut cells = Section::new("Conditions and policies")
        .table("Means with 95 % half-widths; the same edges under every condition and policy", overview(worked));
    if let Some(fan) = fan(study, worked) {
        cells = cells.figure(Figure::new(
            &fan,
            "Time at which 5, 50 and 95 % of all edges have passed a level of wear; a line ends where fewer get there.",
        ));
    }
    if worked.len() > SHOWN {
        let (all, shown) = (worked.len(), SHOWN);
        cells = cells.note(format!(
            "Pictures and laws below are those of the first {shown} of {all} rows; cells.csv and summary.json hold all."
        ));
    }
    report = report.section(cells);
    let of_cell = |cell: &Worked<'_>| if worked.len() == 1 { String::new() } else { name(cell.cell) };
    let by_wear = |(wear, rate): (f64, f64)| {
        format!(
            "Replaced by wear instead, at {} mm, the cost per time is {} EUR/min.",
            number(wear * 1e3, 3),
            number(rate, 4)
        )
    };
    let shown = || worked.iter().take(SHOWN);
    let groups: Vec<page::Group<'_>> = shown()
        .filter_map(|cell| {
            let analysis = cell.analysis.as_ref().ok()?;
            Some(page::Group { name: of_cell(cell), sample: &cell.sample, analysis, remark: cell.by_wear.map(by_wear) })
        })
        .collect();
    if !groups.is_empty() {
        for section in page::sections(&groups, &words(), inputs.request.confidence) {
            report = report.section(section);
        }
    }
    for cell in shown() {
        if let Err(reason) = &cell.analysis {
            report = report.section(Section::new(of_cell(cell)).warning(format!("No law: {reason}.")));
        }
    }
    if let Some((regression, points)) = regression {
        report = report.section(taylor(study, regression, points, inputs.request.confidence));
    }
    if let Some(sensitivity) = sensitivity {
        report = report.section(sensitivities(study, sensitivity));
    }
    let mut table = Table::new(["section", "key", "value"]);
    for value in &inputs.parsed.echo {
        let mark = if value.default { " (default)" } else { "" };
        table.push([value.section.as_str().into(), value.key.as_str().into(), format!("{}{mark}", value.value).into()]);
    }
    let plan = inputs.plan;
    report.section(Section::new("Inputs").table("Every value as it was understood", table)).provenance(Provenance {
        version: plan.version.clone(),
        command: format!(
            "toolroom life {} {}",
            plan.file,
            plan.overrides.iter().map(|change| format!("--set {change:?}")).collect::<Vec<_>>().join(" ")
        ),
        seed: Some(plan.seed),
        inputs: vec![(plan.file.clone(), fingerprint(plan.text.as_bytes()))],
    })
}
