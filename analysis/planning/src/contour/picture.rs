//! Feeds, limits, form errors and gains in pictures.

use super::study::{PassStudy, Scattered};
use super::{Gain, OBJECTIVES, REPORTED_COST, REPORTED_PRODUCTIVITY};
use crate::plane::in_proportion;
use std::ops::Range;
use toolroom_chart::{Axis, Colour, Dash, Estimate, Hatch, Intervals, Marker, Plot, Style};
use toolroom_contour::{Constraint, Contour, Plan};

const MM: f64 = 1e3;
const UM: f64 = 1e6;
/// Points of the picture of a contour.
const POINTS: f64 = 1500.0;

/// Words and look of what can be active: every constraint, then nothing.
fn kinds() -> Vec<(String, Style)> {
    // The most frequent ones get the plainest looks.
    const ORDER: [Constraint; 12] = [
        Constraint::Accuracy,
        Constraint::ToolLife,
        Constraint::HighestFeed,
        Constraint::HighestSpindleSpeed,
        Constraint::ToothStrength,
        Constraint::Roughness,
        Constraint::Power,
        Constraint::BodyStrength,
        Constraint::FeedForce,
        Constraint::ChipSpace,
        Constraint::LowestFeed,
        Constraint::LowestSpindleSpeed,
    ];
    const HATCHES: [Hatch; 6] =
        [Hatch::Crosshatch, Hatch::Horizontal, Hatch::Solid, Hatch::Slash, Hatch::Backslash, Hatch::Vertical];
    let style = |constraint: &Constraint| {
        let index = ORDER.iter().position(|each| each == constraint).unwrap_or_default();
        let style = Style::nth(index);
        if index < 6 { style } else { style.hatch(HATCHES[index - 6]) }
    };
    let constraints = Constraint::ALL.iter().map(|each| (each.name().to_owned(), style(each)));
    constraints.chain([("no limit, the objective".to_owned(), Style::IDLE)]).collect()
}

fn kind(active: Option<Constraint>) -> usize {
    active.map_or(Constraint::ALL.len(), |constraint| constraint as usize)
}

/// Way along the wall at the start of every section and at the end, mm.
fn ways(contour: &Contour) -> Vec<f64> {
    let mut ways = vec![0.0];
    let mut way = 0.0;
    for section in &contour.sections {
        way += section.length * MM;
        ways.push(way);
    }
    ways
}

/// A staircase of a value of every section.
fn stairs(ways: &[f64], plan: &Plan, value: impl Fn(&toolroom_contour::PlannedSection) -> f64) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = ways.iter().copied().zip(plan.sections.iter().map(&value)).collect();
    points.extend(ways.last().copied().zip(plan.sections.last().map(value)));
    points
}

/// Feeds along the wall, with the active constraint of both plans as colour strips.
pub fn feeds(contour: &Contour, study: &PassStudy<'_>) -> Plot {
    let ways = ways(contour);
    let feed = |section: &toolroom_contour::PlannedSection| section.evaluation.feed * 60.0 * MM;
    let mut plot = Plot::new(
        format!("Feed along the contour, pass {}", study.name),
        Axis::linear("Way along the wall", "mm").range(0.0, ways.last().copied().unwrap_or(1.0)),
        Axis::linear("Feed of the cutter centre", "mm/min").include(0.0),
    )
    .describe("Feed of baselines and plans over the way along the wall; strips show which limit refuses more feed.");
    let regimes = [("handbook", Dash::Dotted), ("handbook by section", Dash::DashDot)];
    for (baseline, (name, dash)) in study.baselines.iter().zip(regimes) {
        if let Ok(plan) = &baseline.plan {
            plot = plot.step(name, stairs(&ways, plan, feed), Style::nth(0).colour(Colour::Ink).dash(dash));
        }
    }
    for (i, ((name, _), plan)) in OBJECTIVES.iter().zip(&study.plans).enumerate() {
        plot = plot.step(format!("least {name}"), stairs(&ways, plan, feed), Style::nth(i));
    }
    for ((name, _), plan) in OBJECTIVES.iter().zip(&study.plans) {
        let intervals =
            ways.windows(2).zip(&plan.sections).map(|(way, section)| (way[0], way[1], kind(section.active)));
        plot = plot.strip(*name, kinds(), intervals);
    }
    plot
}

/// What the accuracy limit sees along the wall, against the tolerance.
pub fn form_errors(contour: &Contour, study: &PassStudy<'_>) -> Plot {
    let ways = ways(contour);
    let error = |section: &toolroom_contour::PlannedSection| {
        (section.evaluation.deflection.abs() + section.evaluation.path_error.abs()) * UM
    };
    let mut plot = Plot::new(
        format!("Error of the wall, pass {}", study.name),
        Axis::linear("Way along the wall", "mm").range(0.0, ways.last().copied().unwrap_or(1.0)),
        Axis::linear("Deflection and path error", "um").include(0.0),
    )
    .height(220.0)
    .horizontal(study.pass.tolerance * UM, "tolerance")
    .describe("Deflection and path error together over the way along the wall, with the tolerance.");
    if let Some(handbook) = study.handbook() {
        let style = Style::nth(0).colour(Colour::Ink).dash(Dash::Dotted);
        plot = plot.step("handbook", stairs(&ways, handbook, error), style);
    }
    for (i, ((name, _), plan)) in OBJECTIVES.iter().zip(&study.plans).enumerate() {
        plot = plot.step(format!("least {name}"), stairs(&ways, plan, error), Style::nth(i));
    }
    plot
}

/// The contour with the active constraint of the plan of least cost, in true proportion.
pub fn map(contour: &Contour, study: &PassStudy<'_>) -> Plot {
    let step = contour.length() / POINTS;
    let course = |section: &toolroom_contour::Section| {
        let parts = if section.curvature == 0.0 { 1.0 } else { (section.length / step).ceil().max(2.0) };
        let at = |i: u32| section.at(section.length * f64::from(i) / parts);
        (0..=parts as u32).map(at).map(|point| (point.x * MM, point.y * MM)).collect::<Vec<_>>()
    };
    let courses: Vec<Vec<(f64, f64)>> = contour.sections.iter().map(course).collect();
    let bound = |of: fn(&(f64, f64)) -> f64, pick: fn(f64, f64) -> f64, from: f64| {
        courses.iter().flatten().map(of).fold(from, pick)
    };
    let (left, right) = (bound(|p| p.0, f64::min, f64::INFINITY), bound(|p| p.0, f64::max, f64::NEG_INFINITY));
    let (low, high) = (bound(|p| p.1, f64::min, f64::INFINITY), bound(|p| p.1, f64::max, f64::NEG_INFINITY));
    let (x, y, height) = in_proportion((Axis::linear("X", "mm"), left, right), (Axis::linear("Y", "mm"), low, high));
    let plan = &study.plans[1];
    let mut plot = Plot::new(format!("What limits the feed where, pass {}, least cost", study.name), x, y)
        .height(height)
        .describe("The wall from above, each section in the colour of the limit that refuses more feed.");
    let kinds = kinds();
    let mut labelled = vec![false; kinds.len()];
    // Neighbours with one limit are one line, so that its dashes run on.
    for run in runs_of(&plan.sections.iter().map(|section| kind(section.active)).collect::<Vec<_>>()) {
        let i = kind(plan.sections[run.start].active);
        let (label, style) = &kinds[i];
        let label = if std::mem::replace(&mut labelled[i], true) { "" } else { label };
        plot = plot.line(label, courses[run].concat(), *style);
    }
    if let Some(start) = courses.first().and_then(|course| course.first()) {
        plot = plot.scatter("start of the drawing", [*start], Style::nth(0).colour(Colour::Ink));
    }
    plot
}

/// Ranges of equal neighbours.
fn runs_of(values: &[usize]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (i, value) in values.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if values[run.start] == *value => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}

/// Time and cost of every regime and of the front between the two plans.
pub fn front(study: &PassStudy<'_>) -> Plot {
    let at = |plan: &Plan| (plan.time / 60.0, plan.cost);
    let mut plot = Plot::new(
        format!("Time and cost, pass {}", study.name),
        Axis::linear("Time of the part", "min"),
        Axis::linear("Cost of the part", "EUR"),
    )
    .height(240.0)
    .marked_line("front of time and cost", study.front.iter().map(at), Style::nth(0))
    .describe("Time and cost of the baselines and of the plans that no other beats in both.");
    for (i, baseline) in study.baselines.iter().enumerate() {
        if let Ok(plan) = &baseline.plan {
            plot = plot.scatter(baseline.name, [at(plan)], Style::nth(i + 1));
        }
    }
    plot
}

/// Gains in productivity and cost under changed and scattered conditions, with the reported ones.
pub fn gains(study: &PassStudy<'_>) -> Plot {
    let percent = |gain: Gain| (100.0 * gain.productivity, 100.0 * gain.cost);
    let [[low, high], [cheap, dear]] =
        [REPORTED_PRODUCTIVITY, REPORTED_COST].map(|range| range.map(|share| 100.0 * share));
    let mut plot = Plot::new(
        format!("What the gain depends on, pass {}", study.name),
        Axis::linear("Productivity against the handbook regime", "%"),
        Axis::linear("Cost against the handbook regime", "%"),
    )
    .describe("Gain in productivity and change of cost under changed conditions and over random draws.")
    .band("reported by Lukin for profile holes", [(low, cheap, dear), (high, cheap, dear)], Style::nth(2));
    if let Some(all) = study.scatter.last() {
        let draws = all.by_objective.iter().flat_map(|sensitivity| &sensitivity.draws);
        let gains =
            draws.filter_map(|draw| Some(Gain { productivity: draw.productivity_gain?, cost: draw.cost_change? }));
        plot = plot.scatter("random draws", gains.map(percent), Style::IDLE);
    }
    for (i, (name, _)) in OBJECTIVES.iter().enumerate() {
        let changed = study.conditions.iter().skip(1).filter_map(|condition| condition.gains[i]);
        let style = Style::nth(i).marker([Marker::Circle, Marker::Square][i]);
        plot = plot.scatter(format!("least {name}, one condition changed"), changed.map(percent), style);
    }
    for (i, (name, _)) in OBJECTIVES.iter().enumerate() {
        let given = study.conditions.first().and_then(|condition| condition.gains[i]);
        let style = Style::nth(0).colour(Colour::Ink).marker([Marker::Cross, Marker::Plus][i]);
        plot = plot.scatter(format!("least {name}, as given"), given.map(percent), style);
    }
    plot
}

/// How far the gain of a plan moves with each condition, 5 to 95 %.
pub fn bands(study: &PassStudy<'_>, objective: usize) -> Intervals {
    let (title, axis) = match objective {
        0 => ("Productivity gain of least time", Axis::linear("Productivity against the handbook regime", "%")),
        _ => ("Change of cost of least cost", Axis::linear("Cost against the handbook regime", "%")),
    };
    let nominal = study.handbook().map(|handbook| match objective {
        0 => study.plans[0].productivity_gain(handbook),
        _ => study.plans[1].cost_change(handbook),
    });
    let mut chart = Intervals::new(format!("{title}, pass {}", study.name), axis)
        .describe("Median and the range from 5 to 95 % of the draws, for each scattered condition alone and for all.");
    if let Some(nominal) = nominal {
        chart = chart.reference(100.0 * nominal, "as given");
    }
    let quantile = |scattered: &Scattered, share: f64| match objective {
        0 => scattered.by_objective[0].productivity_gain(share),
        _ => scattered.by_objective[1].cost_change(share),
    };
    for scattered in &study.scatter {
        let [low, middle, high] = [0.05, 0.5, 0.95].map(|share| quantile(scattered, share).map(|value| 100.0 * value));
        if let (Some(low), Some(middle), Some(high)) = (low, middle, high) {
            chart = chart.row(scattered.name.as_str(), Estimate::new(middle, low, high));
        }
    }
    chart
}
