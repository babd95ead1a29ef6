//! Lives as sections of a report and as JSON.

use super::analysis::{Analysis, Interval};
use super::law::{Dimension, Family, Law};
use super::picture;
use super::sample::Sample;
use serde_json::{Map, Value, json};
use toolroom_chart::page::{Figure, Section, Tile};
use toolroom_chart::{Axis, Table};

/// How numbers of lives are named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    /// Unit of lives, empty where it is not known.
    pub unit: String,
    /// Unit of costs, `EUR` or empty.
    pub money: String,
}

impl Words {
    /// `name [unit]`.
    pub fn key(&self, name: &str) -> String {
        if self.unit.is_empty() { name.to_owned() } else { format!("{name} [{}]", self.unit) }
    }
}

/// Mean and coefficient of variation: of the lives where all of them ended, of the best law
/// otherwise.
pub fn moments(sample: &Sample, law: &Law) -> (f64, f64) {
    let (size, ended) = (sample.size(), sample.ended());
    if ended < size {
        return (law.mean(), law.variation());
    }
    let mean = sample.lives().iter().map(|(life, weight)| weight * life.age()).sum::<f64>() / size;
    let squares = sample.lives().iter().map(|(life, weight)| weight * (life.age() - mean).powi(2)).sum::<f64>();
    (mean, (squares / (size - 1.0)).sqrt() / mean)
}

/// The result for programs.
pub fn json(sample: &Sample, analysis: &Analysis, words: &Words) -> Map<String, Value> {
    let law = analysis.fits[0].fit.law;
    let (mean, cv) = moments(sample, &law);
    let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    let pair = |low: f64, high: f64| json!([finite(low), finite(high)]);
    // Beyond what was observed there is nothing to state.
    let seen = |value: f64| if analysis.reach.reaches(value) { finite(value) } else { Value::Null };
    let whole = analysis.reach.reaches_mean();
    let quantiles: Map<String, Value> = [("b1", 0.01), ("b10", 0.1), ("b50", 0.5), ("b90", 0.9)]
        .into_iter()
        .map(|(name, share)| (words.key(name), seen(law.quantile(share))))
        .collect();
    let fits: Vec<Value> = analysis
        .fits
        .iter()
        .map(|fitted| {
            let mut parameters = Map::new();
            let mut intervals = Map::new();
            for (name, estimated, dimension) in &fitted.parameters {
                let key = if *dimension == Dimension::Life { words.key(name) } else { (*name).to_owned() };
                parameters.insert(key.clone(), json!(estimated.value));
                intervals.insert(key, pair(estimated.low, estimated.high));
            }
            json!({
                "distribution": fitted.fit.law.family().name(),
                "parameters": parameters,
                "intervals": intervals,
                "log_likelihood": fitted.fit.log_likelihood,
                "aicc": finite(fitted.fit.aicc()),
                "anderson_darling": finite(fitted.distance),
                "p": fitted.goodness.map(|test| test.p),
            })
        })
        .collect();
    let refused: Vec<Value> = analysis
        .refused
        .iter()
        .map(|(family, error)| json!({ "distribution": family.name(), "reason": error.to_string() }))
        .collect();
    let best = &analysis.by_age;
    let mut replacement = Map::new();
    replacement.insert("failure".to_owned(), json!(if analysis.limit_is_seen { "cut" } else { "limit" }));
    if analysis.replacement_seen() {
        replacement.insert(words.key("age"), finite(best.age));
        replacement.insert("cost_rate".to_owned(), json!(best.cost_rate));
        replacement.insert("saving".to_owned(), json!(best.saving()));
        replacement.insert("run_to_failure".to_owned(), json!(best.run_to_failure));
        replacement.insert("age_interval".to_owned(), pair(analysis.best_age.0, analysis.best_age.1));
        replacement.insert("cost_rate_interval".to_owned(), pair(analysis.best_cost.0, analysis.best_cost.1));
        let block = json!({ "interval": finite(analysis.in_blocks.age), "cost_rate": analysis.in_blocks.cost_rate });
        replacement.insert("blocks".to_owned(), block);
    } else {
        replacement.insert(words.key("age"), Value::Null);
        replacement.insert(words.key("not_reached_by"), json!(analysis.reach.last));
    }
    let banded = |estimate: &Interval, reached: bool| {
        let value = if reached { finite(estimate.value) } else { Value::Null };
        json!({ "value": value, "interval": if reached { pair(estimate.low, estimate.high) } else { Value::Null } })
    };
    let steps =
        analysis.empirical.iter().map(|step| json!([step.age, step.survival, finite(step.low), finite(step.high)]));
    let mut object = Map::new();
    object.insert("n".to_owned(), json!(sample.size()));
    object.insert("ended".to_owned(), json!(sample.ended()));
    object.insert(words.key("mean"), if whole { json!(mean) } else { Value::Null });
    object.insert("cv".to_owned(), if whole { json!(cv) } else { Value::Null });
    object.insert(words.key("restricted_mean"), json!(analysis.reach.restricted_mean));
    object.insert(words.key("last_observation"), json!(analysis.reach.last));
    object.insert("km".to_owned(), steps.collect());
    object.insert("quantiles".to_owned(), Value::Object(quantiles));
    object.insert(words.key("b10"), banded(&analysis.b10, analysis.reach.reaches(analysis.b10.value)));
    object.insert(words.key("mean_life"), banded(&analysis.mean, whole));
    object.insert("fits".to_owned(), Value::Array(fits));
    object.insert("refused".to_owned(), Value::Array(refused));
    object.insert("replacement".to_owned(), Value::Object(replacement));
    object
}

/// The fits as a table.
pub fn fits(analysis: &Analysis, words: &Words) -> Table {
    let mut table = Table::new(["law", "parameters (interval)", "log-likelihood", "AICc above the least", "A²", "p"]);
    let least = analysis.fits.iter().map(|fitted| fitted.fit.aicc()).fold(f64::INFINITY, f64::min);
    for fitted in &analysis.fits {
        let parameter = |(name, at, dimension): &(&str, super::fit::Estimated, Dimension)| {
            let unit = if *dimension == Dimension::Life && !words.unit.is_empty() {
                format!(" {}", words.unit)
            } else {
                String::new()
            };
            let n = |value: f64| if value.is_finite() { toolroom_chart::number(value, 4) } else { "∞".to_owned() };
            format!("{name} {}{unit} ({} … {})", n(at.value), n(at.low), n(at.high))
        };
        table.push([
            picture::label(fitted.fit.law.family()).into(),
            fitted.parameters.iter().map(parameter).collect::<Vec<_>>().join(", ").into(),
            fitted.fit.log_likelihood.into(),
            (fitted.fit.aicc() - least).into(),
            fitted.distance.into(),
            fitted.goodness.map_or(f64::NAN, |test| test.p).into(),
        ]);
    }
    table
}

/// Key figures of a sample.
pub fn tiles(sample: &Sample, analysis: &Analysis, words: &Words, confidence: f64) -> Vec<Tile> {
    let n = |value: f64| toolroom_chart::number(value, 4);
    let unit = if words.unit.is_empty() { String::new() } else { format!(" {}", words.unit) };
    let percent = 100.0 * confidence;
    let unseen = || format!("not reached by {}{unit}", n(analysis.reach.last));
    let banded = |label: &str, estimate: &Interval| {
        if !analysis.reach.reaches(estimate.value) {
            return Tile::new(label, "not reached", unseen());
        }
        Tile::new(
            label,
            format!("{}{unit}", n(estimate.value)),
            format!("{percent} % interval {} … {}", n(estimate.low), n(estimate.high)),
        )
    };
    let mean = if analysis.reach.reaches_mean() {
        banded("mean life", &analysis.mean)
    } else {
        let note = format!("restricted mean, up to the last observation at {}{unit}", n(analysis.reach.last));
        Tile::new("mean life so far", format!("{}{unit}", n(analysis.reach.restricted_mean)), note)
    };
    let best = &analysis.by_age;
    let replaced = if !analysis.replacement_seen() {
        Tile::new("replace at", "not reached", unseen())
    } else if best.age.is_finite() {
        let saves = match analysis.reach.reaches_mean() {
            true => format!("saves {:.1} % against {}; ", 100.0 * best.saving(), analysis.until_the_end()),
            false => String::new(),
        };
        let note = format!("{saves}{} … {}", n(analysis.best_age.0), n(analysis.best_age.1));
        Tile::new("replace at", format!("{}{unit}", n(best.age)), note)
    } else {
        let end = if analysis.limit_is_seen { "the limit" } else { "failure" };
        Tile::new("replace at", end, "edges do not age enough for anything else to pay")
    };
    let size = format!("{} of them ended", n(sample.ended()));
    vec![Tile::new("lives", n(sample.size()), size), mean, banded("B10", &analysis.b10), replaced]
}

/// Lives of one kind of edges, and what was worked out of them.
pub struct Group<'a> {
    /// Condition and policy, or the group of a measured table; empty where there is one only.
    pub name: String,
    /// The lives.
    pub sample: &'a Sample,
    /// Their laws.
    pub analysis: &'a Analysis,
    /// What else is known of their replacement.
    pub remark: Option<String>,
}

impl Group<'_> {
    /// A text about this group, which says so where there are several.
    fn said(&self, text: &str) -> String {
        if self.name.is_empty() { text.to_owned() } else { format!("{}: {text}", self.name) }
    }

    /// What is said of replacing its edges.
    fn replaced(&self, words: &Words) -> String {
        let unit = words.unit.as_str();
        let per = if words.money.is_empty() { String::new() } else { format!(" {}/{unit}", words.money) };
        let blocks = &self.analysis.in_blocks;
        let costs = if !self.analysis.replacement_seen() {
            "When to replace an edge lies beyond the ages that were observed; the curve there is the law's alone."
                .to_owned()
        } else if blocks.age.is_finite() {
            format!(
                "In blocks, replacing all edges every {} {unit} whatever their age, the cost per time is {}{per} against {}{per} by age.",
                toolroom_chart::number(blocks.age, 4),
                toolroom_chart::number(blocks.cost_rate, 4),
                toolroom_chart::number(self.analysis.by_age.cost_rate, 4)
            )
        } else {
            "Replacing all edges at fixed intervals does not pay.".to_owned()
        };
        self.remark.iter().fold(costs, |text, remark| format!("{text} {remark}"))
    }
}

/// The laws of every group as one table.
fn all_fits(groups: &[Group<'_>], words: &Words) -> Table {
    let tables: Vec<Table> = groups.iter().map(|group| fits(group.analysis, words)).collect();
    if let [table] = &tables[..] {
        return table.clone();
    }
    let columns = tables.first().into_iter().flat_map(|table| table.columns().iter().map(String::as_str));
    let mut all = Table::new(std::iter::once("edges").chain(columns));
    for (group, table) in groups.iter().zip(&tables) {
        for row in table.rows() {
            all.push(std::iter::once(group.name.as_str().into()).chain(row.iter().cloned()));
        }
    }
    all
}

/// The laws whose likelihood is not regular, each with the groups where that is so.
fn irregular(groups: &[Group<'_>]) -> Vec<(Family, Vec<String>)> {
    let mut found: Vec<(Family, Vec<String>)> = Vec::new();
    for group in groups {
        for fitted in group.analysis.fits.iter().filter(|fitted| !fitted.fit.regular()) {
            let family = fitted.fit.law.family();
            match found.iter_mut().find(|(known, _)| *known == family) {
                Some((_, names)) => names.push(group.name.clone()),
                None => found.push((family, vec![group.name.clone()])),
            }
        }
    }
    found
}

/// The sections about lives: laws, reliability, replacement. Of several groups each picture is chosen by the group's name.
pub fn sections(groups: &[Group<'_>], words: &Words, confidence: f64) -> Vec<Section> {
    let unit = words.unit.as_str();
    let bands = |analysis: &Analysis| {
        let (percent, count) = (100.0 * confidence, analysis.resampled.len());
        format!("Bands are pointwise {percent} % intervals of {count} resampled refits.")
    };
    let of_all = |figure: &dyn Fn(&Group<'_>) -> Figure| {
        groups.iter().map(|group| (group.name.clone(), figure(group))).collect::<Vec<_>>()
    };
    let mut laws = Section::new("Laws").table(
        "Fits by maximum likelihood, profile-likelihood intervals, most credible first; A² is the Anderson–Darling \
         distance, p the share of samples of the law that are farther from their own fit",
        all_fits(groups, words),
    );
    for (law, names) in irregular(groups) {
        let name = picture::label(law);
        let of = if names.iter().all(String::is_empty) { String::new() } else { format!(" for {}", names.join(", ")) };
        laws = laws.note(format!(
            "The {name} law stands last{of}, whatever its AICc: its likelihood is not regular here, and it predicts little."
        ));
    }
    for group in groups {
        for (family, reason) in &group.analysis.refused {
            laws = laws.note(group.said(&format!("No {} law: {reason}.", picture::label(*family))));
        }
    }
    let laws = laws
        .choice(of_all(&|group| {
            let chart = picture::histogram(group.sample, group.analysis, unit);
            Figure::new(&chart, group.said("Lives that ended, with the densities of the most credible laws."))
        }))
        .choice(of_all(&|group| {
            let caption = format!("On this paper the best law is straight, or nearly. {}", bands(group.analysis));
            Figure::new(&picture::probability(group.analysis, unit), group.said(&caption))
        }));
    let hazard = || Axis::linear("Hazard", picture::per(unit)).include(0.0);
    let residual = || Axis::linear("Mean residual life", unit).include(0.0);
    let reliability = Section::new("Reliability")
        .choice(of_all(&|group| {
            Figure::new(&picture::reliability(group.analysis, unit), group.said(&bands(group.analysis)))
        }))
        .choice(of_all(&|group| {
            let rate = "Rate at which edges of an age end.";
            let chart = picture::banded("Hazard", hazard(), &group.analysis.hazard, unit, rate);
            let caption = "A hazard that rises says that edges wear out; one that falls, that weak edges go first.";
            Figure::new(&chart, group.said(caption))
        }))
        .choice(of_all(&|group| {
            let time = "Mean time that an edge still lives.";
            let chart = picture::banded("Mean residual life", residual(), &group.analysis.residual_life, unit, time);
            Figure::new(&chart, group.said("How long an edge of an age will still last on average."))
        }));
    let texts: Vec<String> = groups.iter().map(|group| group.said(&group.replaced(words))).collect();
    let replacement = Section::new("Replacement");
    let replacement = match &texts[..] {
        [text] => replacement.paragraph(text.as_str()),
        _ => replacement.list(texts),
    };
    let replacement = replacement.choice(of_all(&|group| {
        let chart = picture::cost(group.analysis, unit, &words.money);
        Figure::new(&chart, group.said("Too early wastes life, too late pays for failures in the cut."))
    }));
    vec![laws, reliability, replacement]
}
