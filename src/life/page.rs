//! The results of a study: summary, table of cells, report.

use crate::failure::Failure;
use crate::output::{OutputDir, no_table};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_chart::page::{Figure, Provenance, Report, Section};
use toolroom_chart::{Axis, Chart, Estimate, Intervals, Plot, Style, Table, number};
use toolroom_form::{FormFile, significant};
use toolroom_life::analysis::{Analysis, Request, analyse};
use toolroom_life::file::StudyFile;
use toolroom_life::page::{self, Words};
use toolroom_life::regression::{Regression, regress};
use toolroom_life::replacement::{Costs, Cycles};
use toolroom_life::sample::{Observation, Sample};
use toolroom_life::study::edge::{Draws, LEVELS, level_share};
use toolroom_life::study::run::{Tally, lives};
use toolroom_life::study::sensitivity::{SobolIndex, morris, sobol};
use toolroom_life::study::shard::{Merged, sample};
use toolroom_life::study::tally::ERROR;
use toolroom_life::study::{Cell, End, Study};
use toolroom_process::table::{Cell as CsvCell, csv_text};
use toolroom_shards::{Plan, fingerprint};

/// What a result is made of.
pub struct Inputs<'a> {
    pub plan: &'a Plan,
    pub parsed: &'a FormFile<StudyFile>,
    pub merged: &'a Merged,
    pub request: &'a Request,
}

/// What was written, for the terminal.
pub struct Written {
    pub summary: Value,
    pub text: String,
}

/// Cells whose laws and pictures are in the report.
const SHOWN: usize = 4;
/// Refits behind the bands of simulated lives.
const REFITS: u32 = 100;
/// Lives of each cell behind the regression.
const REGRESSED: u64 = 300;
/// Two-sided 95 % quantile of the normal law.
const Z: f64 = 1.959_964;

/// One cell worked out.
struct Worked<'a> {
    cell: &'a Cell,
    tally: &'a Tally,
    sample: Sample,
    analysis: Result<Analysis, String>,
    /// Best wear at which to replace, m, and its cost rate (per min).
    by_wear: Option<(f64, f64)>,
}

/// The files of a study.
pub const NAMES: &[&str] = &["summary.json", "cells.csv", "report.html"];

pub fn write(out: &OutputDir, inputs: &Inputs<'_>) -> Result<Written, Failure> {
    let study = &inputs.parsed.content.study;
    let worked = inputs
        .merged
        .cells
        .iter()
        .zip(&study.cells)
        .map(|(tally, cell)| work(cell, tally, study, inputs.request))
        .collect::<Result<Vec<_>, _>>()?;
    let regression = regression(study);
    let indices = inputs.parsed.content.sensitivity.map(|(samples, paths)| sensitivity(study, samples, paths));
    let summary = summary(inputs, &worked, regression.as_ref(), indices.as_ref());
    out.put_json("summary.json", &summary)?;
    out.put("cells.csv", &csv(&overview(&worked))?)?;
    out.put("report.html", &report(inputs, &worked, regression.as_ref(), indices.as_ref()).html())?;
    let plan = inputs.plan;
    let run = json!({
        "schema": 1, "version": plan.version, "command": format!("toolroom life {}", plan.file),
        "inputs": [{ "name": plan.file, "hash": fingerprint(plan.text.as_bytes()) }],
        "plan": plan.hash(), "shards": plan.shards, "complete": true,
    });
    out.put_json("run.json", &run)?;
    Ok(Written { summary, text: text(inputs, &worked) })
}

fn work<'a>(cell: &'a Cell, tally: &'a Tally, study: &Study, request: &Request) -> Result<Worked<'a>, Failure> {
    let sample = sample(tally).map_err(|error| Failure::Work { message: format!("{}: {error}", name(cell)) })?;
    // Simulated lives in thousands are no draw from any law: a test would only count them.
    let request = Request { goodness: 0, bootstrap: request.bootstrap.min(REFITS), ..request.clone() };
    let analysis = analyse(&sample, &request).map_err(|error| error.to_string());
    Ok(Worked { cell, tally, sample, analysis, by_wear: by_wear(tally, study, &request.costs) })
}

/// The level of wear at which replacing costs least per time.
fn by_wear(tally: &Tally, study: &Study, costs: &Costs) -> Option<(f64, f64)> {
    let limit = study.pair.limits.wear_limit.min(study.ends.wear).min(study.ends.rough_wear);
    let rates = tally.cycles.iter().enumerate().map(|(level, cycles)| {
        let cycles = Cycles { failed: cycles.failed.mean(), length: cycles.length.mean() / 60.0 };
        (limit * level_share(level), cycles.cost_rate(costs))
    });
    rates.filter(|(_, rate)| rate.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
}

fn name(cell: &Cell) -> String {
    match (cell.condition.as_str(), cell.policy.as_str()) {
        ("", policy) => policy.to_owned(),
        (condition, policy) => format!("{condition} · {policy}"),
    }
}

fn chipped(tally: &Tally) -> f64 {
    let total: f64 = tally.ends.iter().map(|sketch| sketch.weight()).sum();
    let chipping = End::ALL.iter().position(|end| *end == End::Chipping).unwrap_or(1);
    tally.ends[chipping].weight() / total
}

/// Probability of a failure before the early age, with its standard error.
fn early(tally: &Tally) -> (f64, f64) {
    (tally.early.mean(), tally.early.standard_error())
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
            cell.analysis.as_ref().map_or(f64::NAN, |analysis| analysis.b10.value).into(),
            chipped(tally).into(),
        ]);
    }
    table
}

fn csv(table: &Table) -> Result<String, Failure> {
    use toolroom_chart::Cell::{Number, Text};
    let rows = table.rows().iter().map(|row| {
        row.iter().map(|cell| match cell {
            Number(value) => CsvCell::Number(*value),
            Text(text) => CsvCell::Text(text),
        })
    });
    csv_text(table.columns(), rows).map_err(|error| no_table("cells.csv", &error))
}

/// The extended Taylor law over the grid of conditions at programmed speed, every condition with
/// edges of its own; none where nothing varies.
fn regression(study: &Study) -> Option<(Regression, Vec<(f64, f64)>)> {
    let cells: Vec<&Cell> =
        study.cells.iter().filter(|cell| cell.speed.constant() == Some(cell.cut.cutting_speed)).collect();
    type Read = fn(&Cell) -> f64;
    let columns: [(&str, Read); 3] = [
        ("ln(cutting_speed)", |cell| (cell.cut.cutting_speed * 60.0).ln()),
        ("ln(feed_per_rev)", |cell| (cell.cut.feed_per_rev * 1e3).ln()),
        ("ln(depth_of_cut)", |cell| (cell.cut.depth_of_cut * 1e3).ln()),
    ];
    let varies = |read: &Read| cells.iter().any(|cell| (read(cell) - read(cells[0])).abs() > 1e-9);
    let columns: Vec<&(&str, Read)> = columns.iter().filter(|(_, read)| varies(read)).collect();
    if columns.is_empty() {
        return None;
    }
    let (mut rows, mut observations, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (i, cell) in cells.iter().enumerate() {
        let from = REGRESSED * i as u64;
        for outcome in lives(study, cell, from, from + REGRESSED, true).1 {
            let minutes = outcome.life / 60.0;
            rows.push(columns.iter().map(|(_, read)| read(cell)).collect::<Vec<f64>>());
            observations.push(if outcome.end.censored() {
                Observation::Censored(minutes)
            } else {
                Observation::Failed(minutes)
            });
            points.push((cell.cut.cutting_speed * 60.0, minutes));
        }
    }
    let sample = Sample::new(observations).ok()?;
    let regression = regress(columns.iter().map(|(name, _)| *name), &rows, &sample).ok()?;
    Some((regression, points))
}

/// Sobol indices, Morris effects and swings of the life under the first cell, min.
struct Sensitivity {
    indices: Vec<SobolIndex>,
    effects: Vec<toolroom_life::study::sensitivity::Effect>,
    /// Life at the median of every input, and with one input at its 10 and 90 % quantile.
    middle: f64,
    swings: Vec<(f64, f64)>,
}

fn sensitivity(study: &Study, samples: u64, paths: u64) -> Sensitivity {
    // Inputs are varied one by one: correlation and tilt would mix them.
    let study = Study { copula: None, tilt: toolroom_life::study::Tilt::default(), ..study.clone() };
    let cell = &study.cells[0];
    let life = |point: &[f64], row: u64| study.live(cell, point, &mut Draws::of(study.seed, row)).life / 60.0;
    let dimensions = study.dimensions();
    let quiet = Study { scatter: toolroom_wear::Scatter { life_noise: 0.0, ..study.scatter }, ..study.clone() };
    let at = |j: Option<(usize, f64)>| {
        let mut point = vec![0.5; dimensions];
        if let Some((j, u)) = j {
            point[j] = u;
        }
        quiet.live(cell, &point, &mut Draws::of(study.seed, 0)).life / 60.0
    };
    Sensitivity {
        indices: sobol(life, dimensions, samples, 0.9, study.seed),
        effects: morris(life, dimensions, paths, study.seed),
        middle: at(None),
        swings: (0..dimensions).map(|j| (at(Some((j, 0.1))), at(Some((j, 0.9))))).collect(),
    }
}

fn words() -> Words {
    Words { unit: "min".to_owned(), money: String::new() }
}

fn summary(
    inputs: &Inputs<'_>,
    worked: &[Worked<'_>],
    regression: Option<&(Regression, Vec<(f64, f64)>)>,
    sensitivity: Option<&Sensitivity>,
) -> Value {
    let study = &inputs.parsed.content.study;
    let of = |cell: &Worked<'_>| {
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
        object.insert("mean [min]".to_owned(), json!(tally.life.mean() / 60.0));
        object.insert("standard_error [min]".to_owned(), json!(tally.standard_error() / 60.0));
        object.insert("cv".to_owned(), json!(tally.life.variation()));
        let all = |share: f64| {
            let mut lives = tally.ends[0].clone();
            tally.ends[1..].iter().for_each(|other| lives.merge(other));
            lives.quantile(share) / 60.0
        };
        let quantiles =
            [("p1", 0.01), ("p5", 0.05), ("p10", 0.1), ("p50", 0.5), ("p90", 0.9), ("p95", 0.95), ("p99", 0.99)];
        let quantiles: Map<String, Value> =
            quantiles.iter().map(|(name, share)| (format!("{name} [min]"), json!(all(*share)))).collect();
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
        if study.early > 0.0 {
            let (probability, error) = early(tally);
            object.insert("early".to_owned(), json!({ "age [min]": study.early / 60.0, "probability": probability, "standard_error": error, "effective_lives": tally.effective() }));
        }
        Value::Object(object)
    };
    let cells: Vec<Value> = worked.iter().map(of).collect();
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
        let b10 = cell.analysis.as_ref().map_or_else(|_| "–".to_owned(), |analysis| number(analysis.b10.value, 3));
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
    if let Some(Ok(analysis)) = worked.first().map(|cell| &cell.analysis) {
        let best = &analysis.by_age;
        let first = name(worked[0].cell);
        let _ = if best.age.is_finite() {
            writeln!(
                text,
                "{first}: replace at {} min, saves {:.1} % against running to failure",
                number(best.age, 3),
                100.0 * best.saving()
            )
        } else {
            writeln!(text, "{first}: run to failure, replacing by age does not pay")
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
    report = report.section(cells);
    for cell in worked.iter().take(SHOWN) {
        let name = if worked.len() == 1 { String::new() } else { name(cell.cell) };
        match &cell.analysis {
            Ok(analysis) => {
                let mut sections = page::sections(&name, &cell.sample, analysis, &words(), inputs.request.confidence);
                if let (Some(last), Some((wear, rate))) = (sections.pop(), cell.by_wear) {
                    let text = format!(
                        "Replaced by wear instead, at {} mm, the cost per time is {}.",
                        number(wear * 1e3, 3),
                        number(rate, 4)
                    );
                    sections.push(last.paragraph(text));
                }
                for section in sections {
                    report = report.section(section);
                }
            }
            Err(reason) => report = report.section(Section::new(name).warning(format!("No law: {reason}."))),
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

/// Wear over time of the first cells: 5, 50 and 95 % of first passages.
fn fan(study: &Study, worked: &[Worked<'_>]) -> Option<impl Chart + use<>> {
    let limit = study.pair.limits.wear_limit.min(study.ends.wear).min(study.ends.rough_wear);
    let mut plot = Plot::new(
        "Flank wear over time",
        Axis::linear("Time in cut", "min").include(0.0),
        Axis::linear("Flank wear VB", "mm").include(0.0),
    )
    .horizontal(limit * 1e3, "limit")
    .describe("Quantiles of the time at which edges pass levels of flank wear.");
    let mut drawn = false;
    for (i, cell) in worked.iter().take(SHOWN).enumerate() {
        for (share, label) in [(0.05, ""), (0.5, "median"), (0.95, "")] {
            let curve: Vec<(f64, f64)> = (0..LEVELS)
                .map(|level| (cell.tally.passage(level, share) / 60.0, limit * level_share(level) * 1e3))
                .filter(|(time, _)| time.is_finite())
                .collect();
            drawn |= curve.len() > 1;
            let label = if label.is_empty() { String::new() } else { name(cell.cell) };
            plot = plot.line(label, curve, Style::nth(i));
        }
    }
    drawn.then_some(plot)
}

fn taylor(study: &Study, regression: &Regression, points: &[(f64, f64)], confidence: f64) -> Section {
    let mut table = Table::new(["covariate", "coefficient of ln(life/min)", "standard error"]);
    let names = std::iter::once("intercept").chain(regression.names.iter().map(String::as_str));
    for (name, (b, error)) in names.zip(regression.coefficients.iter().zip(&regression.standard_errors)) {
        table.push([name.into(), (*b).into(), (*error).into()]);
    }
    let section = Section::new("Extended Taylor law")
        .paragraph(format!(
            "Residual standard deviation of ln(life): {}. Speeds in m/min, feed and depth in mm.",
            significant(regression.sigma)
        ))
        .table("Least squares with censoring, every condition with edges of its own", table);
    if regression.names[0] != "ln(cutting_speed)" {
        return section;
    }
    let (low, high) =
        points.iter().fold((f64::INFINITY, 0.0f64), |(low, high), point| (low.min(point.0), high.max(point.0)));
    let reference = &study.cells[0].cut;
    let at = |speed: f64| {
        let covariates = regression.names.iter().map(|name| match name.as_str() {
            "ln(cutting_speed)" => speed.ln(),
            "ln(feed_per_rev)" => (reference.feed_per_rev * 1e3).ln(),
            _ => (reference.depth_of_cut * 1e3).ln(),
        });
        regression.predict(&covariates.collect::<Vec<_>>(), confidence)
    };
    let speeds: Vec<f64> = (0..=40).map(|i| low * (high / low).powf(f64::from(i) / 40.0)).collect();
    let band = |of: fn(&toolroom_life::regression::Prediction) -> (f64, f64)| {
        speeds.iter().map(move |speed| {
            let (low, high) = of(&at(*speed));
            (*speed, low, high)
        })
    };
    let plot = Plot::new("Tool life over speed", Axis::log("Cutting speed", "m/min"), Axis::log("Life", "min"))
        .band("one more edge", band(|at| at.prediction).collect::<Vec<_>>(), Style::nth(1))
        .band("median", band(|at| at.confidence).collect::<Vec<_>>(), Style::nth(0))
        .line(
            "extended Taylor law",
            speeds.iter().map(|speed| (*speed, at(*speed).median)).collect::<Vec<_>>(),
            Style::nth(0),
        )
        .scatter("lives", points.iter().copied(), Style::nth(2))
        .describe("Lives over cutting speed on logarithmic axes with the regression and its bands.");
    section.figure(Figure::new(&plot, "A straight line is Taylor's law; curvature says that its exponent depends on speed. Line and bands are at the first condition's feed and depth."))
}

fn sensitivities(study: &Study, sensitivity: &Sensitivity) -> Section {
    let mut table = Table::new([
        "input",
        "first",
        "first, 5 %",
        "first, 95 %",
        "total",
        "total, 5 %",
        "total, 95 %",
        "Morris μ* [min]",
        "Morris σ [min]",
    ]);
    let mut tornado = Intervals::new("Life with one input at its ends", Axis::linear("Life", "min"))
        .tornado("10 % quantile", "90 % quantile")
        .reference(sensitivity.middle, "all at their median")
        .describe("Swing of the life by each input alone.");
    for j in 0..sensitivity.indices.len() {
        let (index, effect) = (&sensitivity.indices[j], &sensitivity.effects[j]);
        let (low, high) = sensitivity.swings[j];
        table.push([
            study.coordinate(j).into(),
            index.first.value.into(),
            index.first.low.into(),
            index.first.high.into(),
            index.total.value.into(),
            index.total.low.into(),
            index.total.high.into(),
            effect.size.into(),
            effect.scatter.into(),
        ]);
        tornado = tornado.row(study.coordinate(j), Estimate::new(sensitivity.middle, low, high));
    }
    Section::new("Sensitivity")
        .paragraph("Life under the first condition and policy. The first index is the share of the variance of life that an input explains alone, the total one the share in which it has a part; what is missing to 1 is noise during the life.")
        .figure(Figure::new(&tornado, "Without noise during the life."))
        .table("Sobol indices with 90 % bootstrap intervals, Morris screening", table)
}
