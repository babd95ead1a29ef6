//! Pictures and tables of a study: wear over time, life over speed, what the life depends on.

use super::{SHOWN, Sensitivity, Worked, name};
use crate::regression::{Prediction, Regression};
use crate::study::Study;
use crate::study::edge::{LEVELS, level_share};
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Chart, Estimate, Intervals, Plot, Style, Table};
use toolroom_form::significant;

/// Wear over time of the first cells: 5, 50 and 95 % of first passages.
pub(super) fn fan(study: &Study, worked: &[Worked<'_>]) -> Option<impl Chart + use<>> {
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

pub(super) fn taylor(study: &Study, regression: &Regression, points: &[(f64, f64)], confidence: f64) -> Section {
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
    let predicted = |speed: f64| {
        let covariates = regression.names.iter().map(|name| match name.as_str() {
            "ln(cutting_speed)" => speed.ln(),
            "ln(feed_per_rev)" => (reference.feed_per_rev * 1e3).ln(),
            _ => (reference.depth_of_cut * 1e3).ln(),
        });
        regression.predict(&covariates.collect::<Vec<_>>(), confidence)
    };
    let speeds: Vec<f64> = (0..=40).map(|i| low * (high / low).powf(f64::from(i) / 40.0)).collect();
    let band = |of: fn(&Prediction) -> (f64, f64)| {
        speeds.iter().map(move |speed| {
            let (low, high) = of(&predicted(*speed));
            (*speed, low, high)
        })
    };
    let plot = Plot::new("Tool life over speed", Axis::log("Cutting speed", "m/min"), Axis::log("Life", "min"))
        .band("one more edge", band(|predicted| predicted.prediction).collect::<Vec<_>>(), Style::nth(1))
        .band("median", band(|predicted| predicted.confidence).collect::<Vec<_>>(), Style::nth(0))
        .line(
            "extended Taylor law",
            speeds.iter().map(|speed| (*speed, predicted(*speed).median)).collect::<Vec<_>>(),
            Style::nth(0),
        )
        .scatter("lives", points.iter().copied(), Style::nth(2))
        .describe("Lives over cutting speed on logarithmic axes with the regression and its bands.");
    section.figure(Figure::new(&plot, "A straight line is Taylor's law; curvature says that its exponent depends on speed. Line and bands are at the first condition's feed and depth."))
}

pub(super) fn sensitivities(study: &Study, sensitivity: &Sensitivity) -> Section {
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
