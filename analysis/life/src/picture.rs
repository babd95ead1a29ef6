//! Pictures of lives.

use super::analysis::Analysis;
use super::bootstrap::Banded;
use super::law::Family;
use super::normal;
use super::sample::{Observation, Sample};
use super::survival::Step;
use toolroom_chart::{Axis, Chart, Colour, Histogram, Plot, Style};

/// Density of the lives that ended, with the best laws over it. Censored lives are not in it: they
/// lie beyond the age to which they are known.
pub fn histogram(sample: &Sample, analysis: &Analysis, unit: &str) -> impl Chart + use<> {
    let ended: Vec<(Observation, f64)> = sample.lives().iter().filter(|(life, _)| life.ended()).copied().collect();
    let share = sample.ended() / sample.size();
    let columns: Vec<(f64, f64, f64)> = if ended.iter().all(|(_, weight)| *weight == 1.0) {
        Histogram::new(ended.iter().map(|(life, _)| life.age())).density().collect()
    } else {
        weighted_columns(&ended)
    };
    let scaled = columns.into_iter().map(|(from, to, density)| (from, to, density * share));
    let mut plot = Plot::new("Lives and fitted laws", Axis::linear("Life", unit), Axis::linear("Density", per(unit)))
        .columns("lives that ended", scaled, Style::nth(0).colour(Colour::Grey));
    let end = analysis.reliability.last().map_or(1.0, |point| point.age);
    for (i, fitted) in analysis.fits.iter().take(3).enumerate() {
        let law = fitted.fit.law;
        let curve = (1..=200).map(|k| end * f64::from(k) / 200.0).map(move |age| (age, law.ln_density(age).exp()));
        plot = plot.line(label(law.family()), curve, Style::nth(i));
    }
    plot.describe("Histogram of lives with the densities of the laws that are most credible by AICc.")
}

/// Forty equal classes of weighted lives between inspections, each life spread over the time between its two.
fn weighted_columns(lives: &[(Observation, f64)]) -> Vec<(f64, f64, f64)> {
    const CLASSES: usize = 40;
    let span = |life: &Observation| match *life {
        Observation::Between(from, to) => (from, to),
        Observation::Failed(age) | Observation::Censored(age) => (age, age),
    };
    let low = lives.iter().map(|(life, _)| span(life).0).fold(f64::INFINITY, f64::min);
    let high = lives.iter().map(|(life, _)| span(life).1).fold(0.0, f64::max);
    let width = ((high - low) / CLASSES as f64).max(1e-12 * high);
    let mut counts = [0.0; CLASSES];
    for (life, weight) in lives {
        let (from, to) = span(life);
        let class = |age: f64| (((age - low) / width) as usize).min(CLASSES - 1);
        for (i, count) in counts.iter_mut().enumerate().take(class(to) + 1).skip(class(from)) {
            let begin = low + width * i as f64;
            let inside = to.min(begin + width) - from.max(begin);
            *count += if to > from { weight * inside.max(0.0) / (to - from) } else { *weight };
        }
    }
    let total: f64 = counts.iter().sum();
    let column = |(i, count): (usize, &f64)| {
        let from = low + width * i as f64;
        (from, from + width, count / (total * width))
    };
    counts.iter().enumerate().map(column).collect()
}

/// The axes on which a family is a straight line, or nearly one.
fn paper(family: Family) -> (bool, fn(f64) -> f64) {
    match family {
        Family::Normal => (false, normal::quantile),
        Family::Lognormal | Family::InverseGaussian | Family::Gamma => (true, normal::quantile),
        Family::Weibull | Family::Weibull3 | Family::CompetingRisks => (true, |failed| (-(-failed).ln_1p()).ln()),
    }
}

/// Lives on probability paper of the best law, with its line and band.
pub fn probability(analysis: &Analysis, unit: &str) -> impl Chart + use<> {
    let family = analysis.fits[0].fit.law.family();
    let (logarithmic, height) = paper(family);
    let axis = if logarithmic { Axis::log("Life", unit) } else { Axis::linear("Life", unit) };
    let shares = [0.001, 0.01, 0.05, 0.1, 0.2, 0.5, 0.8, 0.9, 0.99, 0.999];
    let ticks = shares.map(|share| (height(share), format!("{} %", 100.0 * share)));
    let inside = |failed: f64| (0.0005..0.9995).contains(&failed);
    let line = |curve: &[Banded]| -> Vec<(f64, f64)> {
        let points = curve.iter().filter(|point| inside(1.0 - point.value));
        points.map(|point| (point.age, height(1.0 - point.value))).collect()
    };
    let reliability = &analysis.reliability;
    let band = reliability.iter().filter(|point| inside(1.0 - point.high) && inside(1.0 - point.low));
    let band = band.map(|point| (point.age, height(1.0 - point.high), height(1.0 - point.low)));
    // A point lies in the middle of its step: the ends of an empirical law are 0 and 1.
    let mut before = 1.0;
    let points = analysis.empirical.iter().map(|step| {
        let middle = 0.5 * (before + step.survival);
        before = step.survival;
        (step.age, 1.0 - middle)
    });
    let points: Vec<(f64, f64)> =
        points.filter(|(_, failed)| inside(*failed)).map(|(age, failed)| (age, height(failed))).collect();
    Plot::new(
        format!("Probability paper: {}", label(family)),
        axis,
        Axis::linear("Share that has failed", "").ticks(ticks),
    )
    .band("band of the law", band.collect::<Vec<_>>(), Style::nth(0))
    .line(label(family), line(reliability), Style::nth(0))
    .scatter("lives", points, Style::nth(1).colour(Colour::Ink))
    .describe("Lives on the scale on which the best law is a straight line or nearly one.")
}

/// Reliability with band, beside the estimate without a law.
pub fn reliability(analysis: &Analysis, unit: &str) -> impl Chart + use<> {
    let best = label(analysis.fits[0].fit.law.family());
    let band = analysis.reliability.iter().map(|point| (point.age, point.low, point.high));
    let line = analysis.reliability.iter().map(|point| (point.age, point.value));
    let start = std::iter::once((0.0, 1.0));
    let steps = start.chain(analysis.empirical.iter().map(|step: &Step| (step.age, step.survival)));
    Plot::new(
        "Reliability",
        Axis::linear("Age", unit).include(0.0),
        Axis::linear("Share still good", "").range(0.0, 1.0),
    )
    .band(format!("band of {best}"), band, Style::nth(0))
    .line(best, line, Style::nth(0))
    .step("without a law", steps, Style::nth(1).colour(Colour::Ink))
    .vertical(analysis.b10.value, "B10")
    .describe("Share of edges that reach an age.")
}

/// Hazard and mean residual life share no axis: one plot each.
pub fn banded(title: &str, axis: Axis, curve: &[Banded], unit: &str, description: &str) -> impl Chart + use<> {
    Plot::new(title, Axis::linear("Age", unit), axis)
        .band("band", curve.iter().map(|point| (point.age, point.low, point.high)), Style::nth(0))
        .line("best law", curve.iter().map(|point| (point.age, point.value)), Style::nth(0))
        .describe(description)
}

/// Cost per time against the age of replacement.
pub fn cost(analysis: &Analysis, unit: &str, money: &str) -> impl Chart + use<> {
    let run = analysis.by_age.run_to_failure;
    let seen = |value: &f64| *value < 3.0 * run;
    let curve: Vec<&Banded> = analysis.cost.iter().filter(|point| seen(&point.value) && seen(&point.high)).collect();
    let plot = Plot::new(
        "Cost against the age of replacement",
        Axis::linear("Age of replacement", unit),
        Axis::linear("Cost per time", format!("{money}/{}", if unit.is_empty() { "1" } else { unit })).include(0.0),
    )
    .band("band", curve.iter().map(|point| (point.age, point.low, point.high)).collect::<Vec<_>>(), Style::nth(0))
    .line("best law", curve.iter().map(|point| (point.age, point.value)).collect::<Vec<_>>(), Style::nth(0))
    .horizontal(run, analysis.until_the_end())
    .describe("Cost per time in cut when edges are replaced at an age, or at their end if it comes before.");
    if analysis.by_age.age.is_finite() { plot.vertical(analysis.by_age.age, "best") } else { plot }
}

/// A family in words.
pub fn label(family: Family) -> &'static str {
    match family {
        Family::Weibull => "Weibull",
        Family::Weibull3 => "Weibull, 3 parameters",
        Family::Lognormal => "lognormal",
        Family::Normal => "normal",
        Family::Gamma => "gamma",
        Family::InverseGaussian => "inverse Gaussian",
        Family::CompetingRisks => "wear-out and chipping",
    }
}

/// The unit of a rate.
pub fn per(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!("1/{unit}") }
}
