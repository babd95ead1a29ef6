//! Plans on the terminal.

use super::OBJECTIVES;
use super::study::{PassStudy, runs, totals};
use std::f64::consts::TAU;
use std::fmt::Write;
use toolroom_contour::{ContourFile, Plan, PlannedSection};

const MM: f64 = 1e3;
const UM: f64 = 1e6;
/// Runs of sections that are reported one by one.
const MOST_RUNS: usize = 24;

/// A share with its sign, in per cent.
pub(super) fn percent(share: f64) -> String {
    let text = format!("{:+.1} %", 100.0 * share);
    if let Some(rest) = text.strip_prefix('-') { format!("−{rest}") } else { text }
}

/// Spindle speed of a plan without the rounding of its conversion, rpm.
pub(super) fn rpm(section: &PlannedSection) -> f64 {
    (section.setting.spindle_speed * 60.0 / TAU * 1e6).round() / 1e6
}

/// The plans of every pass in a few lines.
pub fn text(file: &ContourFile, studies: &[PassStudy<'_>]) -> String {
    let contour = &file.contour;
    let mut text = format!(
        "{}\n  {} sections, {:.1} mm of wall, {} corners\n",
        file.title,
        contour.sections.len(),
        contour.length() * MM,
        contour.corners.len()
    );
    if file.residual > 0.0 {
        let _ = writeln!(text, "  the arcs lie within {:.2} um of the curve that they stand for", file.residual * UM);
    }
    for study in studies {
        pass(&mut text, study);
    }
    let totals = totals(studies);
    if let Some(handbook) = totals.first().filter(|total| total.name == studies[0].baselines[0].name) {
        let _ = writeln!(text, "\nall passes");
        for total in &totals {
            let (gain, cost) = (handbook.time / total.time - 1.0, total.cost / handbook.cost - 1.0);
            let shown = |share| if std::ptr::eq(total, handbook) { "–".to_owned() } else { percent(share) };
            let _ = writeln!(
                text,
                "  {:22} {:>10.4} {:>10.4} {:>13} {:>9}",
                total.name,
                total.time / 60.0,
                total.cost,
                shown(gain),
                shown(cost)
            );
        }
    }
    text.truncate(text.trim_end().len());
    text
}

fn pass(text: &mut String, study: &PassStudy<'_>) {
    let _ = writeln!(
        text,
        "\npass {}\n  {:22} {:>10} {:>10} {:>13} {:>9} {:>12}",
        study.name, "regime", "time, min", "cost, EUR", "productivity", "cost", "edges/part"
    );
    let handbook = study.handbook();
    let row = |text: &mut String, name: &str, plan: &Plan| {
        let gain = |of: &dyn Fn(&Plan) -> f64| match handbook {
            Some(handbook) if !std::ptr::eq(handbook, plan) => percent(of(handbook)),
            _ => "–".to_owned(),
        };
        let _ = writeln!(
            text,
            "  {name:22} {:>10.4} {:>10.4} {:>13} {:>9} {:>12.5}",
            plan.time / 60.0,
            plan.cost,
            gain(&|handbook| plan.productivity_gain(handbook)),
            gain(&|handbook| plan.cost_change(handbook)),
            plan.life_fraction + plan.wasted_life,
        );
    };
    for baseline in &study.baselines {
        match &baseline.plan {
            Ok(plan) => row(text, baseline.name, plan),
            Err(error) => {
                let _ = writeln!(text, "  {:22} none: {error}", baseline.name);
            }
        }
    }
    for ((name, _), plan) in OBJECTIVES.iter().zip(&study.plans) {
        row(text, &format!("least {name}"), plan);
    }
    let plan = &study.plans[1];
    let runs = runs(plan);
    if runs.len() <= MOST_RUNS {
        sections(text, study, plan, &runs);
    } else {
        let _ = writeln!(text, "  {} sections in sections.csv", plan.sections.len());
    }
    for edge in study.plans.iter().flat_map(|plan| &plan.edge_changes).take(1) {
        let _ = writeln!(text, "  the edge is changed before section {}", place(study, *edge, *edge));
    }
    if let Some(all) = study.scatter.last() {
        for ((name, _), sensitivity) in OBJECTIVES.iter().zip(&all.by_objective) {
            let shown = |of: &dyn Fn(f64) -> Option<f64>| {
                let [low, middle, high] = [0.05, 0.5, 0.95].map(of);
                Some(format!("{} ({} … {})", percent(middle?), percent(low?), percent(high?)))
            };
            let gain = shown(&|share| sensitivity.productivity_gain(share));
            let cost = shown(&|share| sensitivity.cost_change(share));
            if let (Some(gain), Some(cost)) = (gain, cost) {
                let draws = sensitivity.draws.len();
                let _ = writeln!(
                    text,
                    "  scattered, least {name}: productivity {gain}, cost {cost}, 90 % of {draws} draws"
                );
            }
        }
    }
    for warning in study.warnings() {
        let _ = writeln!(text, "  ! {warning}");
    }
}

fn sections(text: &mut String, study: &PassStudy<'_>, plan: &Plan, runs: &[(usize, usize)]) {
    let _ = writeln!(
        text,
        "  {:22} {:>10} {:>10} {:>13}  active limit",
        "least cost, section", "n, rpm", "f, mm", "feed, mm/min"
    );
    for (first, last) in runs {
        let section = &plan.sections[*first];
        let name = place(study, *first, *last);
        let _ = writeln!(
            text,
            "  {name:22} {:>10.0} {:>10.3} {:>13.0}  {}",
            rpm(section),
            section.setting.feed_per_tooth * MM,
            section.evaluation.feed * 60.0 * MM,
            section.active.map_or("none", |constraint| constraint.name()),
        );
    }
}

/// The planned sections from `first` to `last` as people find them: sections of the contour, with the way along the wall
/// where only a part of one is meant.
pub(super) fn place(study: &PassStudy<'_>, first: usize, last: usize) -> String {
    let pieces = study.planner.pieces();
    let (from, to) = (&pieces[first], &pieces[last]);
    if from.section != to.section {
        return format!("{} to {}", from.section + 1, to.section + 1);
    }
    let whole = from.from == 0.0 && pieces.get(last + 1).is_none_or(|next| next.section != to.section);
    if whole {
        format!("{}", from.section + 1)
    } else {
        format!("{}: {:.1} to {:.1} mm", from.section + 1, from.from * MM, to.to * MM)
    }
}
