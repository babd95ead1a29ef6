//! Lives that were measured: laws of all of them and of each group, and the regression over cutting data.

use crate::analysis::{Analysis, Interval, Request, analyse};
use crate::measured::{Measured, MeasuredLife};
use crate::page::{self, Words};
use crate::picture;
use crate::regression::{Regression, RegressionError, regress};
use crate::sample::{Observation, Sample, SampleError};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_chart::Table;
use toolroom_chart::page::{Report, Section};
use toolroom_form::significant;
use toolroom_shards::fingerprint;

/// Lives that belong together.
pub struct Group {
    /// Empty for all of them.
    pub name: String,
    /// The lives.
    pub sample: Sample,
    /// What they say, or why they do not suffice.
    pub analysis: Result<Analysis, String>,
}

/// Why measured lives say nothing.
#[derive(Debug, thiserror::Error)]
pub enum MeasuredStudyError {
    /// Lives that are none.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// No law can be fitted to all lives together.
    #[error("{0}")]
    TooFew(String),
    /// No regression over the wanted columns.
    #[error(transparent)]
    Regression(#[from] RegressionError),
}

/// What measured lives say.
pub struct MeasuredStudy<'a> {
    /// The lives as read.
    pub measured: &'a Measured,
    /// The statistics that were wanted.
    pub request: &'a Request,
    /// All lives, then each group where there are several.
    pub groups: Vec<Group>,
    /// The life against columns of the table, where some were named.
    pub regression: Option<Regression>,
    words: Words,
}

impl<'a> MeasuredStudy<'a> {
    /// Fits laws to all lives and to each group, and the regression over `columns`, whose values the lives carry.
    ///
    /// # Errors
    /// [`MeasuredStudyError`]; a group that does not suffice says so itself.
    pub fn new(measured: &'a Measured, columns: &[String], request: &'a Request) -> Result<Self, MeasuredStudyError> {
        let groups = groups(measured, request)?;
        let regression = if columns.is_empty() { None } else { Some(regression(measured, columns)?) };
        let words = Words { unit: measured.unit.clone(), money: String::new() };
        Ok(Self { measured, request, groups, regression, words })
    }

    /// The result for programs; `file` is the name of the table.
    pub fn summary(&self, file: &str) -> Value {
        let (groups, words) = (&self.groups, &self.words);
        let mut object = Map::from_iter([("schema".to_owned(), json!(1)), ("file".to_owned(), json!(file))]);
        if let Ok(analysis) = &groups[0].analysis {
            object.extend(page::json(&groups[0].sample, analysis, words));
        }
        object.insert("groups".to_owned(), groups[1..].iter().map(|group| as_json(group, words)).collect());
        if let Some(regression) = &self.regression {
            object.insert("regression".to_owned(), regression_json(regression));
        }
        object.insert("digest".to_owned(), json!(fingerprint(&digested(self.measured))));
        Value::Object(object)
    }

    /// The report; `file` is the name of the table.
    pub fn report(&self, file: &str) -> Report {
        report(file, &self.groups, self.regression.as_ref(), &self.words, self.request)
    }

    /// The laws in a few lines for a terminal.
    pub fn text(&self) -> String {
        text(&self.groups, self.regression.as_ref(), &self.words, self.request)
    }
}

/// All lives, and each group where there are several.
fn groups(measured: &Measured, request: &Request) -> Result<Vec<Group>, MeasuredStudyError> {
    let mut names: Vec<&str> = Vec::new();
    for life in &measured.lives {
        if !names.contains(&life.group.as_str()) {
            names.push(&life.group);
        }
    }
    let group = |name: &str, lives: &[&MeasuredLife]| -> Result<Group, SampleError> {
        let sample = Sample::new(lives.iter().map(|life| life.life))?;
        let analysis = analyse(&sample, request).map_err(|error| error.to_string());
        Ok(Group { name: name.to_owned(), sample, analysis })
    };
    let all: Vec<&MeasuredLife> = measured.lives.iter().collect();
    let mut groups = vec![group("", &all)?];
    if let Err(reason) = &groups[0].analysis {
        return Err(MeasuredStudyError::TooFew(reason.clone()));
    }
    if names.len() > 1 {
        for name in names {
            let lives: Vec<&MeasuredLife> = all.iter().copied().filter(|life| life.group == name).collect();
            groups.push(group(name, &lives)?);
        }
    }
    Ok(groups)
}

fn regression(measured: &Measured, columns: &[String]) -> Result<Regression, MeasuredStudyError> {
    let sample = Sample::new(measured.lives.iter().map(|life| life.life))?;
    let rows: Vec<Vec<f64>> = measured.lives.iter().map(|life| life.covariates.clone()).collect();
    Ok(regress(columns.iter().cloned(), &rows, &sample)?)
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
    let entry = |(name, coefficient, error): (&str, f64, f64)| {
        (name.to_owned(), json!({ "coefficient": coefficient, "standard_error": error }))
    };
    json!({
        "response": "ln(life)",
        "coefficients": coefficients(regression).map(entry).collect::<Map<String, Value>>(),
        "sigma": regression.sigma,
        "freedom": regression.freedom,
        "log_likelihood": regression.log_likelihood,
    })
}

/// The bits of the lives in their order.
fn digested(measured: &Measured) -> Vec<u8> {
    use Observation::{Between, Censored, Failed};
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
    }
    let found = groups.iter().filter_map(|group| {
        let analysis = group.analysis.as_ref().ok()?;
        Some(page::Group { name: group.name.clone(), sample: &group.sample, analysis, remark: None })
    });
    let mut found: Vec<page::Group<'_>> = found.collect();
    if let [all, _, ..] = &mut found[..]
        && all.name.is_empty()
    {
        all.name = "all".to_owned();
    }
    if !found.is_empty() {
        for section in page::sections(&found, words, request.confidence) {
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
    let seen = &analysis.reach;
    let mean = if seen.reaches_mean() {
        format!("mean life {}{unit}", n(analysis.mean.value))
    } else {
        format!("mean life up to {}{unit}, the last observation, {}{unit}", n(seen.last), n(seen.restricted_mean))
    };
    let tenth = if seen.reaches(analysis.b10.value) {
        format!("one edge in ten is spent at {}{unit}", n(analysis.b10.value))
    } else {
        format!("one edge in ten is not spent by {}{unit}", n(seen.last))
    };
    format!("The most credible law is {}: {mean}, {tenth}.", picture::label(best.fit.law.family()))
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
        let seen = &analysis.reach;
        let (mean, cv) = page::moments(sample, &analysis.fits[0].fit.law);
        let moments = if seen.reaches_mean() {
            format!("{} {}, CV {}", words.key("mean"), n(mean), n(cv))
        } else {
            format!("{} {} up to {}", words.key("restricted mean"), n(seen.restricted_mean), n(seen.last))
        };
        let _ = writeln!(text, "{name}: {} lives, {} ended; {moments}", n(sample.size()), n(sample.ended()));
        let _ = writeln!(text, "  {:24} {:>10} {:>8} {:>8}  parameters", "law", "AICc", "A²", "p");
        for fitted in &analysis.fits {
            let parameters = fitted.parameters.iter().map(|(name, estimate, _)| {
                format!("{name} {} ({} … {})", n(estimate.value), n(estimate.low), n(estimate.high))
            });
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
        let unseen = || format!("not reached by t = {}", n(seen.last));
        let banded = |estimate: &Interval, reached: bool| match reached {
            true => format!("{} ({} … {})", n(estimate.value), n(estimate.low), n(estimate.high)),
            false => unseen(),
        };
        let _ = writeln!(
            text,
            "  B10 {}   mean life {}",
            banded(&analysis.b10, seen.reaches(analysis.b10.value)),
            banded(&analysis.mean, seen.reaches_mean())
        );
        let best = &analysis.by_age;
        if !analysis.replacement_seen() {
            let _ = writeln!(text, "  replace at: {}\n", unseen());
        } else if best.age.is_finite() {
            let saves = match seen.reaches_mean() {
                true => format!(" instead of {}, saves {:.1} %", n(best.run_to_failure), 100.0 * best.saving()),
                false => format!("; what running to failure costs is {}", unseen()),
            };
            let [age, low, high] = [best.age, analysis.best_age.0, analysis.best_age.1].map(n);
            let _ = writeln!(text, "  replace at {age} ({low} … {high}): cost per time {}{saves}\n", n(best.cost_rate));
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
