//! `toolroom life --fit DATA.csv`: laws of measured lives.

use super::request;
use crate::args::LifeArgs;
use crate::failure::Failure;
use crate::output::OutputDir;
use crate::speak::Voice;
use crate::study::default_out;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use toolroom_chart::Table;
use toolroom_chart::page::{Provenance, Report, Section};
use toolroom_form::significant;
use toolroom_life::analysis::{Analysis, Request, analyse};
use toolroom_life::measured::{Layout, Measured, MeasuredLife, read};
use toolroom_life::page::{self, Words};
use toolroom_life::picture;
use toolroom_life::regression::{Regression, regress};
use toolroom_life::sample::Sample;
use toolroom_shards::fingerprint;

/// Lives that belong together.
struct Group {
    /// Empty for all of them.
    name: String,
    sample: Sample,
    /// What they say, or why they do not suffice.
    analysis: Result<Analysis, String>,
}

pub fn run(args: &LifeArgs, csv: &Path, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let request = request(&args.statistics, None)?;
    let file = csv.display().to_string();
    let bytes = std::fs::read(csv)
        .map_err(|error| Failure::argument(format_args!("{file} cannot be read: {error}"), "give a CSV file"))?;
    let measured = read(&file, &bytes, &layout(args)?, &args.regress)
        .map_err(|error| Failure::argument(error, "toolroom life --help shows the columns"))?;
    for note in &measured.notes {
        voice.say(format_args!("note: {note}"));
    }
    let words = Words { unit: measured.unit.clone(), money: String::new() };
    let target = args.out.clone().unwrap_or_else(|| {
        let stem = csv.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        default_out(&format!("life-{stem}"))
    });
    let out = OutputDir::create(&target, &["summary.json", "report.html"], [csv], voice.force)?;
    let groups = groups(&measured, &request)?;
    let regression = regression(args, &measured)?;
    let inputs = vec![(file.clone(), fingerprint(&bytes))];
    let command = std::env::args().collect::<Vec<_>>().join(" ");
    let provenance = Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: command.clone(),
        seed: Some(request.seed),
        inputs,
    };
    let mut object = Map::from_iter([("schema".to_owned(), json!(1)), ("file".to_owned(), json!(file))]);
    if let Ok(analysis) = &groups[0].analysis {
        object.extend(page::json(&groups[0].sample, analysis, &words));
    }
    object.insert("groups".to_owned(), groups[1..].iter().map(|group| as_json(group, &words)).collect());
    if let Some(regression) = &regression {
        object.insert("regression".to_owned(), regression_json(regression));
    }
    object.insert("digest".to_owned(), json!(fingerprint(&digested(&measured))));
    let report = report(&file, &groups, regression.as_ref(), &words, &request).provenance(provenance);
    let wall = start.elapsed();
    let run = json!({ "schema": 1, "version": env!("CARGO_PKG_VERSION"), "command": command,
        "inputs": [{ "name": file, "hash": fingerprint(&bytes) }], "complete": true, "wall_time [s]": wall.as_secs_f64() });
    let summary = Value::Object(object);
    out.put_json("summary.json", &summary)?;
    out.put("report.html", &report.html())?;
    out.put_json("run.json", &run)?;
    let target = out.publish()?;
    if voice.json {
        voice.json(&summary)?;
    } else {
        voice.data(text(&groups, regression.as_ref(), &words, &request).trim_end())?;
    }
    voice.detail(format_args!("{:.2} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

fn layout(args: &LifeArgs) -> Result<Layout, Failure> {
    let readings = &args.readings;
    let (Some(wear), Some(limit), Some(age)) = (&readings.wear, readings.limit, &readings.age) else {
        return Ok(Layout::Lives);
    };
    if !(limit > 0.0 && limit.is_finite()) {
        return Err(Failure::argument(format_args!("--limit {limit} is no wear"), "write for example --limit 0.3"));
    }
    Ok(Layout::Readings {
        edge: readings.edge.clone(),
        age: age.clone(),
        wear: wear.clone(),
        limit,
        group: readings.group.clone(),
        interpolate: !readings.between,
    })
}

/// All lives, and each group where there are several.
fn groups(measured: &Measured, request: &Request) -> Result<Vec<Group>, Failure> {
    let mut names: Vec<&str> = Vec::new();
    for life in &measured.lives {
        if !names.contains(&life.group.as_str()) {
            names.push(&life.group);
        }
    }
    let of = |name: &str, lives: &[&MeasuredLife]| -> Result<Group, Failure> {
        let help = "a life is a positive number; an edge that was still good has censored = 1";
        let sample = Sample::new(lives.iter().map(|life| life.life)).map_err(|error| Failure::argument(error, help))?;
        let analysis = analyse(&sample, request).map_err(|error| error.to_string());
        Ok(Group { name: name.to_owned(), sample, analysis })
    };
    let all: Vec<&MeasuredLife> = measured.lives.iter().collect();
    let mut groups = vec![of("", &all)?];
    if let Err(reason) = &groups[0].analysis {
        return Err(Failure::argument(reason, "observe edges until some of them end"));
    }
    if names.len() > 1 {
        for name in names {
            let lives: Vec<&MeasuredLife> = all.iter().copied().filter(|life| life.group == name).collect();
            groups.push(of(name, &lives)?);
        }
    }
    Ok(groups)
}

fn regression(args: &LifeArgs, measured: &Measured) -> Result<Option<Regression>, Failure> {
    if args.regress.is_empty() {
        return Ok(None);
    }
    let refused = |error: &dyn std::fmt::Display| Failure::argument(error, "choose other columns with --regress");
    let sample = Sample::new(measured.lives.iter().map(|life| life.life)).map_err(|error| refused(&error))?;
    let rows: Vec<Vec<f64>> = measured.lives.iter().map(|life| life.covariates.clone()).collect();
    regress(args.regress.iter().cloned(), &rows, &sample).map(Some).map_err(|error| refused(&error))
}

fn as_json(group: &Group, words: &Words) -> Value {
    let mut object =
        Map::from_iter([("group".to_owned(), json!(group.name)), ("n".to_owned(), json!(group.sample.size()))]);
    match &group.analysis {
        Ok(analysis) => object.extend(page::json(&group.sample, analysis, words)),
        Err(reason) => {
            object.insert("refused".to_owned(), json!(reason));
        }
    }
    Value::Object(object)
}

fn coefficients(regression: &Regression) -> impl Iterator<Item = (&str, f64, f64)> {
    let names = std::iter::once("intercept").chain(regression.names.iter().map(String::as_str));
    names.zip(&regression.coefficients).zip(&regression.standard_errors).map(|((name, b), error)| (name, *b, *error))
}

fn regression_json(regression: &Regression) -> Value {
    let of = |(name, coefficient, error): (&str, f64, f64)| {
        (name.to_owned(), json!({ "coefficient": coefficient, "standard_error": error }))
    };
    json!({
        "response": "ln(life)",
        "coefficients": coefficients(regression).map(of).collect::<Map<String, Value>>(),
        "sigma": regression.sigma,
        "freedom": regression.freedom,
        "log_likelihood": regression.log_likelihood,
    })
}

/// The bits of the lives in their order.
fn digested(measured: &Measured) -> Vec<u8> {
    use toolroom_life::sample::Observation::{Between, Censored, Failed};
    let words = measured.lives.iter().flat_map(|life| match life.life {
        Failed(age) => [1.0, age, age],
        Censored(age) => [2.0, age, age],
        Between(low, high) => [3.0, low, high],
    });
    words.flat_map(f64::to_le_bytes).collect()
}

fn report(file: &str, groups: &[Group], regression: Option<&Regression>, words: &Words, request: &Request) -> Report {
    let mut report = Report::new(format!("Tool lives of {file}"));
    for group in groups {
        let Ok(analysis) = &group.analysis else { continue };
        if group.name.is_empty() {
            report = report.lead(lead(analysis, words));
            for tile in page::tiles(&group.sample, analysis, words, request.confidence) {
                report = report.tile(tile);
            }
        }
        for section in page::sections(&group.name, &group.sample, analysis, words, request.confidence) {
            report = report.section(section);
        }
    }
    for group in groups {
        if let Err(reason) = &group.analysis {
            let section = Section::new(format!("Group {}", group.name));
            report = report.section(section.warning(format!("{} lives: {reason}.", group.sample.size())));
        }
    }
    if let Some(regression) = regression {
        let mut table = Table::new(["covariate", "coefficient of ln(life)", "standard error"]);
        for (name, coefficient, error) in coefficients(regression) {
            table.push([name.into(), coefficient.into(), error.into()]);
        }
        let sigma = format!(
            "Residual standard deviation of ln(life): {} with {} degrees of freedom.",
            significant(regression.sigma),
            regression.freedom
        );
        report = report.section(
            Section::new("Life against cutting data")
                .paragraph(sigma)
                .table("Extended Taylor law; coefficients of logarithms are exponents", table),
        );
    }
    report
}

fn lead(analysis: &Analysis, words: &Words) -> String {
    let best = &analysis.fits[0];
    let unit = if words.unit.is_empty() { String::new() } else { format!(" {}", words.unit) };
    let n = |value: f64| toolroom_chart::number(value, 3);
    format!(
        "The most credible law is {}: mean life {}{unit}, one edge in ten is spent at {}{unit}.",
        picture::label(best.fit.law.family()),
        n(analysis.mean.value),
        n(analysis.b10.value)
    )
}

fn text(groups: &[Group], regression: Option<&Regression>, words: &Words, request: &Request) -> String {
    let mut text = String::new();
    let n = |value: f64| if value == f64::INFINITY { "∞".to_owned() } else { toolroom_chart::number(value, 4) };
    for group in groups {
        let name = if group.name.is_empty() { "all lives" } else { &group.name };
        let Ok(analysis) = &group.analysis else {
            let reason = group.analysis.as_ref().err().map_or("", String::as_str);
            let _ = writeln!(text, "{name}: {reason}\n");
            continue;
        };
        let sample = &group.sample;
        let (mean, cv) = page::moments(sample, &analysis.fits[0].fit.law);
        let _ = writeln!(
            text,
            "{name}: {} lives, {} ended; {} {}, CV {}",
            n(sample.size()),
            n(sample.ended()),
            words.key("mean"),
            n(mean),
            n(cv)
        );
        let _ = writeln!(text, "  {:24} {:>10} {:>8} {:>8}  parameters", "law", "AICc", "A²", "p");
        for fitted in &analysis.fits {
            let parameters = fitted
                .parameters
                .iter()
                .map(|(name, at, _)| format!("{name} {} ({} … {})", n(at.value), n(at.low), n(at.high)));
            let p = fitted.goodness.map_or("–".to_owned(), |test| format!("{:.3}", test.p));
            let _ = writeln!(
                text,
                "  {:24} {:>10} {:>8} {p:>8}  {}",
                format!("{}{}", picture::label(fitted.fit.law.family()), if fitted.fit.regular() { "" } else { " *" }),
                n(fitted.fit.aicc()),
                n(fitted.distance),
                parameters.collect::<Vec<_>>().join(", ")
            );
        }
        for (family, reason) in &analysis.refused {
            let _ = writeln!(text, "  {:24} not fitted: {reason}", picture::label(*family));
        }
        if analysis.fits.iter().any(|fitted| !fitted.fit.regular()) {
            let _ = writeln!(text, "  * not regular: it follows single lives and predicts little");
        }
        let banded =
            |at: &toolroom_life::analysis::Interval| format!("{} ({} … {})", n(at.value), n(at.low), n(at.high));
        let _ = writeln!(text, "  B10 {}   mean life {}", banded(&analysis.b10), banded(&analysis.mean));
        let best = &analysis.by_age;
        if best.age.is_finite() {
            let _ = writeln!(
                text,
                "  replace at {} ({} … {}): cost per time {} instead of {}, saves {:.1} %\n",
                n(best.age),
                n(analysis.best_age.0),
                n(analysis.best_age.1),
                n(best.cost_rate),
                n(best.run_to_failure),
                100.0 * best.saving()
            );
        } else {
            let _ = writeln!(text, "  run to failure: replacing by age does not pay\n");
        }
    }
    if let Some(regression) = regression {
        let terms = coefficients(regression).map(|(name, b, error)| format!("{} ± {} {name}", n(b), n(error)));
        let _ = writeln!(
            text,
            "ln(life) = {}, residual deviation {} ({} degrees of freedom)",
            terms.collect::<Vec<_>>().join(" + "),
            n(regression.sigma),
            regression.freedom
        );
    }
    let _ = writeln!(text, "intervals: {} %", 100.0 * request.confidence);
    text
}
