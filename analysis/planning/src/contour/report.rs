//! The report of a contour plan.

use super::OBJECTIVES;
use super::picture;
use super::study::{PassStudy, runs, totals};
use super::text::{percent, rpm};
use crate::tables::{input_table, push_record};
use toolroom_chart::Table;
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_contour::{Constraint, ContourFile, CornerPolicy, FormError, Milling, PathError, Plan};
use toolroom_form::significant;

const MM: f64 = 1e3;
/// Rows of a table of sections in the report; the rest is in the file.
const MOST_ROWS: usize = 60;

/// The report of all passes.
pub fn report(file: &ContourFile, studies: &[PassStudy<'_>], provenance: Provenance) -> Report {
    let mut report = Report::new(file.title.as_str());
    for study in studies {
        report = report.lead(lead(study));
    }
    if let Some(study) = studies.last() {
        for (i, (name, _)) in OBJECTIVES.iter().enumerate() {
            let plan = &study.plans[i];
            let value = if i == 0 { format!("{:.4} min", plan.time / 60.0) } else { format!("{:.4} EUR", plan.cost) };
            let note = study.handbook().map_or_else(
                || "no handbook regime".to_owned(),
                |handbook| {
                    let (gain, cost) = (plan.productivity_gain(handbook), plan.cost_change(handbook));
                    format!("{} productivity, {} cost", percent(gain), percent(cost))
                },
            );
            report = report.tile(Tile::new(format!("least {name}, {}", study.name), value, note));
        }
        let active: Vec<&str> = study.plans[1].active().into_iter().map(Constraint::name).collect();
        let active = if active.is_empty() { "none".to_owned() } else { active.join(", ") };
        report = report.tile(Tile::new("limits at least cost", active, format!("pass {}", study.name)));
    }
    for study in studies {
        report = report.section(plans(study));
        if !study.conditions.is_empty() {
            report = report.section(gains(study));
        }
    }
    let inputs = inputs(file, studies);
    let last = all_passes(studies).unwrap_or_else(|| Section::new("Inputs"));
    report.section(last.table("Every value as it was understood", inputs)).provenance(provenance)
}

fn lead(study: &PassStudy<'_>) -> String {
    let [fast, cheap] = &study.plans;
    match study.handbook() {
        Some(handbook) => format!(
            "Pass {}: against the handbook regime, the fastest plan gains {} in productivity ({} in cost), the cheapest {} \
             in cost ({} in productivity).",
            study.name,
            percent(fast.productivity_gain(handbook)),
            percent(fast.cost_change(handbook)),
            percent(cheap.cost_change(handbook)),
            percent(cheap.productivity_gain(handbook)),
        ),
        None => format!("Pass {}: no step of the feed override makes the handbook regime admissible.", study.name),
    }
}

fn plans(study: &PassStudy<'_>) -> Section {
    let contour = study.planner.contour();
    let mut section = Section::new(format!("Pass {}", study.name));
    for warning in study.warnings() {
        section = section.warning(warning.to_string());
    }
    // The two tables stand side by side.
    section = section
        .table("Regimes and plans", regimes(study))
        .table("Sections of the plan of least cost", sections(study))
        .figure(
            Figure::new(
                &picture::feeds(contour, study),
                "Strips: the limit that refuses a higher feed at the planned spindle speed, for least time and least cost.",
            )
            .data_in("sections.csv"),
        )
        .figure(
            Figure::new(&picture::form_errors(contour, study), "The plan uses the tolerance where accuracy is the limit.")
                .data_in("sections.csv"),
        )
        .figure(Figure::new(&picture::map(contour, study), "The wall from above, as it is drawn."))
        .figure(Figure::new(&picture::front(study), "Plans on the convex hull of time and cost, and the regimes."));
    if !study.plans[1].corners.is_empty() {
        section = section.table("Moves around sharp corners", corners(&study.plans[1]));
    }
    section
}

fn gains(study: &PassStudy<'_>) -> Section {
    let mut section = Section::new(format!("What the gain depends on, pass {}", study.name))
        .paragraph(
            "A gain is a comparison with a regime. Lukin reports 10 to 14 % more productivity and 15 to 18 % less cost for \
             profile holes; the numbers here say under which conditions that comes out, and how far a change of one \
             condition moves it. The handbook regime is cut by a feed override in steps of 10 %, so its feed and with it \
             the gain jump.",
        )
        .figure(
            Figure::new(&picture::gains(study), "Each mark is a plan against the handbook regime of the same conditions.")
                .data_in("conditions.csv and draws.csv"),
        )
        .table(
            "One condition changed: productivity / cost against the handbook regime of the same condition",
            conditions(study),
        );
    if !study.scatter.is_empty() {
        let draws = study.scatter[0].by_objective[0].draws.len();
        let caption = format!("Median and 5 to 95 % of {draws} draws, each condition alone and all together.");
        section = section
            .figure(Figure::new(&picture::bands(study, 0), caption.as_str()).data_in("draws.csv"))
            .figure(Figure::new(&picture::bands(study, 1), caption).data_in("draws.csv"));
        if let Some(all) = study.scatter.last() {
            let sensitivity = &all.by_objective[1];
            let broken = Constraint::ALL.into_iter().map(|constraint| (constraint, sensitivity.broken(constraint)));
            let mut findings: Vec<String> = broken
                .filter(|(_, share)| *share > 0.0)
                .map(|(constraint, share)| format!("{constraint} in {:.0} % of the draws", 100.0 * share))
                .collect();
            if sensitivity.without_plan() > 0.0 {
                findings.push(format!("no plan or no handbook regime in {:.0} %", 100.0 * sensitivity.without_plan()));
            }
            if !findings.is_empty() {
                section = section.note(format!(
                    "The plan of least cost as given does not hold in all conditions; it breaks {}.",
                    findings.join(", ")
                ));
            }
        }
    }
    section
}

fn regimes(study: &PassStudy<'_>) -> Table {
    let mut table = Table::new([
        "regime",
        "time [min]",
        "cost [EUR]",
        "productivity [%]",
        "cost [%]",
        "edges a part",
        "edges in cost [%]",
    ]);
    let handbook = study.handbook();
    let mut push = |name: &str, plan: &Plan| {
        let gain = |of: fn(&Plan, &Plan) -> f64| handbook.map_or(f64::NAN, |handbook| hundredth(of(plan, handbook)));
        table.push([
            name.into(),
            (plan.time / 60.0).into(),
            plan.cost.into(),
            gain(Plan::productivity_gain).into(),
            gain(Plan::cost_change).into(),
            (plan.life_fraction + plan.wasted_life).into(),
            hundredth(plan.edge_share(&study.planner)).into(),
        ]);
    };
    for baseline in &study.baselines {
        if let Ok(plan) = &baseline.plan {
            push(baseline.name, plan);
        }
    }
    for ((name, _), plan) in OBJECTIVES.iter().zip(&study.plans) {
        push(&format!("least {name}"), plan);
    }
    table
}

fn sections(study: &PassStudy<'_>) -> Table {
    let mut table = Table::new([
        "sections",
        "shape",
        "radius [mm]",
        "n [rpm]",
        "f [mm/tooth]",
        "feed [mm/min]",
        "time [s]",
        "active limit",
    ]);
    let (plan, contour) = (&study.plans[1], study.planner.contour());
    let runs = runs(plan);
    for (first, last) in runs.iter().take(MOST_ROWS) {
        let section = &plan.sections[*first];
        let shape = contour.shape(&contour.sections[*first]);
        let name = super::text::place(study, *first, *last);
        table.push([
            name.into(),
            shape.name().into(),
            shape.radius().map_or(f64::NAN, |radius| radius * MM).into(),
            rpm(section).into(),
            (section.setting.feed_per_tooth * MM).into(),
            (section.evaluation.feed * 60.0 * MM).into(),
            plan.sections[*first..=*last].iter().map(|section| section.time).sum::<f64>().into(),
            section.active.map_or("none", Constraint::name).into(),
        ]);
    }
    if runs.len() > MOST_ROWS {
        table.push([format!("{} more in sections.csv", runs.len() - MOST_ROWS).into()]);
    }
    table
}

fn corners(plan: &Plan) -> Table {
    let mut table =
        Table::new(["after section", "inside angle [deg]", "additional path [mm]", "feed in it [mm/min]", "time [s]"]);
    for corner in plan.corners.iter().take(MOST_ROWS) {
        table.push([
            ((corner.corner.after + 1) as f64).into(),
            corner.corner.interior_angle.to_degrees().into(),
            (corner.length * MM).into(),
            (corner.feed * 60.0 * MM).into(),
            corner.time.into(),
        ]);
    }
    table
}

fn conditions(study: &PassStudy<'_>) -> Table {
    let mut table = Table::new(["condition", "plan of least time", "plan of least cost"]);
    for condition in &study.conditions {
        let [time, cost] = condition.gains.map(|gain| {
            gain.map_or_else(
                || "no plan or no handbook regime".to_owned(),
                |gain| {
                    let mark = if gain.as_reported() { "  as reported" } else { "" };
                    format!("{} / {}{mark}", percent(gain.productivity), percent(gain.cost))
                },
            )
        });
        table.push([condition.name.as_str().into(), time.into(), cost.into()]);
    }
    table
}

fn all_passes(studies: &[PassStudy<'_>]) -> Option<Section> {
    let totals = totals(studies);
    let handbook = totals.first().filter(|total| total.name == studies[0].baselines[0].name)?;
    let mut table = Table::new(["regime", "time [min]", "cost [EUR]", "productivity [%]", "cost [%]"]);
    for total in &totals {
        let (gain, cost) = (handbook.time / total.time - 1.0, total.cost / handbook.cost - 1.0);
        table.push([
            total.name.as_str().into(),
            (total.time / 60.0).into(),
            total.cost.into(),
            hundredth(gain).into(),
            hundredth(cost).into(),
        ]);
    }
    Some(Section::new("All passes, and inputs").table("Regimes and plans, passes together", table))
}

/// Per cent to two decimals: more would say more than the constants do.
fn hundredth(share: f64) -> f64 {
    (1e4 * share).round() / 1e2
}

fn inputs(file: &ContourFile, studies: &[PassStudy<'_>]) -> Table {
    let mut table = input_table();
    let mut parameters = file.parameters.clone();
    for (group, record) in parameters.parameters_mut() {
        push_record(&mut table, group, record);
    }
    push_record(&mut table, "scatter", &file.scatter);
    for study in studies {
        push_record(&mut table, &format!("pass {}", study.name), study.pass);
    }
    let models = &file.models;
    for (key, value) in [
        ("milling", if models.milling == Milling::Down { "down".to_owned() } else { "up".to_owned() }),
        ("path_error", path_error(&models.path_error)),
        ("form_error", if models.form_error == FormError::Mean { "mean".to_owned() } else { "helical".to_owned() }),
        ("corners", corner_policy(&models.corners)),
    ] {
        table.push(["models".into(), key.into(), value.into()]);
    }
    table
}

fn path_error(law: &PathError) -> String {
    match law {
        PathError::Empirical => "empirical, Lukin's eq. (14)".to_owned(),
        PathError::Servo { velocity_loop: None } => "servo, ideal velocity loop".to_owned(),
        PathError::Servo { velocity_loop: Some(inner) } => {
            format!(
                "servo, velocity loop of {} rad/s, damping {}",
                significant(inner.frequency),
                significant(inner.damping)
            )
        }
        PathError::ExplicitEuler { step } => format!("explicit_euler, step {} ms", significant(step * MM)),
        PathError::Off => "off".to_owned(),
    }
}

fn corner_policy(policy: &CornerPolicy) -> String {
    let within = |tolerance: &Option<f64>| {
        tolerance.map_or_else(String::new, |tolerance| format!(", within {} mm", significant(tolerance * MM)))
    };
    match policy {
        CornerPolicy::Loop { radius, tolerance } => {
            format!("loop of {} mm{}", significant(radius * MM), within(tolerance))
        }
        CornerPolicy::ExactStop => "exact_stop".to_owned(),
        CornerPolicy::SlowDown { tolerance } => format!("slow_down{}", within(tolerance)),
    }
}
