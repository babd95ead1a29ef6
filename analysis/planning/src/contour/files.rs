//! The files of a contour plan.

use super::report::report;
use super::study::{Baseline, PassStudy, RefusedPass, Scattered, totals};
use super::text::rpm;
use super::{Condition, Gain, OBJECTIVES};
use crate::tables::table;
use serde_json::{Value, json};
use toolroom_chart::ResultFiles;
use toolroom_chart::page::Provenance;
use toolroom_contour::{Constraint, ContourError, ContourFile, Piece, Plan, PlannedSection, Sensitivity};
use toolroom_post::{Drawing, post};
use toolroom_process::table::Cell;
use toolroom_program::{Blocks, Control, Dialect};

const MM: f64 = 1e3;
const UM: f64 = 1e6;

/// The files of a plan but for its part programs; `draws.csv` where there are draws.
pub const NAMES: &[&str] =
    &["sections.csv", "conditions.csv", "draws.csv", "contour.dxf", "contour.json", "report.html"];

/// `sections.csv`, `conditions.csv`, `draws.csv` where there are draws, a part program for every pass and objective in the
/// language of a control, `contour.dxf`, `contour.json` and `report.html`.
///
/// # Errors
/// [`RefusedPass`]: a plan that cannot be written as a part program.
pub fn files(
    file: &ContourFile,
    studies: &[PassStudy<'_>],
    provenance: Provenance,
    dialect: Dialect,
) -> Result<ResultFiles, RefusedPass> {
    let mut files = ResultFiles::default();
    files.push("sections.csv", sections(studies));
    files.push("conditions.csv", conditions(studies));
    if studies.iter().any(|study| !study.scatter.is_empty()) {
        files.push("draws.csv", draws(studies));
    }
    for (name, program) in programs(file, studies, dialect)? {
        files.push(name, program);
    }
    files.push("contour.dxf", drawing(file, studies)?.text());
    files.push("contour.json", format!("{:#}\n", summary(file, studies)));
    files.push("report.html", report(file, studies, provenance).html());
    Ok(files)
}

/// The result for programs.
pub fn summary(file: &ContourFile, studies: &[PassStudy<'_>]) -> Value {
    let plans: Vec<Value> = studies
        .iter()
        .flat_map(|study| {
            OBJECTIVES.iter().zip(&study.plans).map(|((objective, _), plan)| plan_json(file, study, objective, plan))
        })
        .collect();
    let baselines: Vec<Value> = studies
        .iter()
        .flat_map(|study| study.baselines.iter().map(|baseline| baseline_json(study, baseline)))
        .collect();
    let fronts: Vec<Value> = studies
        .iter()
        .map(|study| {
            let points: Vec<Value> =
                study.front.iter().map(|plan| json!({ "time [min]": plan.time / 60.0, "cost": plan.cost })).collect();
            json!({ "pass": study.name, "plans": points })
        })
        .collect();
    json!({
        "schema": 1,
        "name": file.name,
        "title": file.title,
        "contour": {
            "sections": file.contour.sections.len(),
            "length [mm]": file.contour.length() * MM,
            "centre_length [mm]": file.contour.centre_length(file.parameters.cutter.radius()) * MM,
            "corners": file.contour.corners.len(),
            "residual [um]": file.residual * UM,
        },
        "plans": plans,
        "baselines": baselines,
        "totals": totals(studies)
            .iter()
            .map(|total| json!({ "regime": total.name, "time [min]": total.time / 60.0, "cost": total.cost }))
            .collect::<Vec<_>>(),
        "pareto": fronts,
        "conditions": studies.iter().flat_map(|study| study.conditions.iter().map(|each| condition_json(study, each))).collect::<Vec<_>>(),
        "sensitivity": studies.iter().flat_map(|study| study.scatter.iter().map(|each| scatter_json(study, each))).collect::<Vec<_>>(),
    })
}

/// A part program of this project for every pass and objective, each with the name of both.
fn plain<'a>(
    file: &'a ContourFile,
    studies: &'a [PassStudy<'a>],
) -> impl Iterator<Item = Result<(&'a str, String, String), RefusedPass>> {
    studies.iter().flat_map(move |study| {
        OBJECTIVES.iter().zip(&study.plans).map(move |((objective, _), plan)| {
            let title = format!("{} {} least {objective}", file.name, study.name);
            let program = study.planner.part_program_leaving(plan, &title, left(file, study, plan));
            let fit = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '-' };
            let name: String = study.name.chars().map(fit).collect();
            program
                .map(|program| (study.name, format!("{name}-{objective}"), program))
                .map_err(|error| RefusedPass::new(study.name, error))
        })
    })
}

/// A part program for every pass and objective, each with the name of its file.
///
/// # Errors
/// [`RefusedPass`]: a plan that cannot be written as a part program.
pub(super) fn programs(
    file: &ContourFile,
    studies: &[PassStudy<'_>],
    dialect: Dialect,
) -> Result<Vec<(String, String)>, RefusedPass> {
    let program = |made: Result<(&str, String, String), RefusedPass>| {
        let (pass, name, program) = made?;
        let program = written(&program, dialect).map_err(|error| RefusedPass::new(pass, error))?;
        Ok((format!("{name}.{}", ending(dialect)), program))
    };
    plain(file, studies).map(program).collect()
}

/// The contour in the layer `CONTOUR`, and the path of the cutter's centre of every part program in a layer of its name.
///
/// # Errors
/// [`RefusedPass`]: a plan that cannot be written as a part program.
fn drawing(file: &ContourFile, studies: &[PassStudy<'_>]) -> Result<Drawing, RefusedPass> {
    let mut drawing = Drawing::default();
    for section in &file.contour.sections {
        let [from, to] = [section.start, section.end()].map(|point| [point.x * MM, point.y * MM, 0.0]);
        if section.curvature == 0.0 {
            drawing.line("CONTOUR", from, to);
            continue;
        }
        // The centre lies a right angle to the left of the heading, at a radius with the sign of the curvature.
        let radius = MM / section.curvature;
        let (sin, cos) = section.heading.sin_cos();
        let centre = [from[0] - radius * sin, from[1] + radius * cos, 0.0];
        let angle = |place: [f64; 3]| (place[1] - centre[1]).atan2(place[0] - centre[0]).to_degrees();
        let begin = angle(if section.curvature > 0.0 { from } else { to });
        drawing.arc("CONTOUR", centre, radius.abs(), (begin, begin + section.sweep().abs().to_degrees()));
    }
    for made in plain(file, studies) {
        let (pass, name, program) = made?;
        let refused = |message: String| RefusedPass::new(pass, ContourError::Program { message });
        let blocks =
            Blocks::new(&program[..], &Control::of(Dialect::Fanuc)).map_err(|error| refused(error.to_string()))?;
        for block in blocks {
            let block = block.map_err(|error| refused(error.to_string()))?;
            for motion in block.motions.iter().filter(|motion| !motion.rapid) {
                drawing.motion(&name, motion);
            }
        }
    }
    Ok(drawing)
}

/// What a pass leaves of the wall, m: what the passes behind it in the file remove, and what the cutter that bends would cut
/// too deep.
fn left(file: &ContourFile, study: &PassStudy<'_>, plan: &Plan) -> f64 {
    let later = file.passes.iter().skip_while(|(name, _)| name != study.name).skip(1);
    later.map(|(_, pass)| pass.allowance).sum::<f64>() + study.planner.overcut(plan)
}

/// The most negative deflection of the cutter into the wall, m; 0 where it only leaves material.
fn least_error(plan: &Plan) -> f64 {
    plan.sections.iter().map(|section| section.evaluation.deflection).fold(0.0, f64::min)
}

/// A part program of this project in the words of another control.
fn written(program: &str, dialect: Dialect) -> Result<String, ContourError> {
    if dialect == Dialect::Fanuc {
        return Ok(program.to_owned());
    }
    let post = post(program, &Control::of(Dialect::Fanuc), dialect);
    post.map(|post| post.text).map_err(|error| ContourError::Program { message: error.to_string() })
}

/// Ending of the files of a control.
fn ending(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas => "nc",
        Dialect::Siemens => "mpf",
        Dialect::Heidenhain => "h",
        Dialect::LinuxCnc => "ngc",
    }
}

fn plan_json(file: &ContourFile, study: &PassStudy<'_>, objective: &str, plan: &Plan) -> Value {
    let handbook = study.handbook();
    let against: Vec<Value> = study
        .baselines
        .iter()
        .filter_map(|baseline| {
            let regime = baseline.plan.as_ref().ok()?;
            Some(json!({
                "baseline": baseline.name,
                "productivity_gain": plan.productivity_gain(regime),
                "cost_change": plan.cost_change(regime),
            }))
        })
        .collect();
    json!({
        "pass": study.name,
        "objective": objective,
        "time [min]": plan.time / 60.0,
        "cost": plan.cost,
        "productivity_gain": handbook.map(|handbook| plan.productivity_gain(handbook)),
        "cost_change": handbook.map(|handbook| plan.cost_change(handbook)),
        "against": against,
        "left [um]": left(file, study, plan) * UM,
        "least_left [um]": (left(file, study, plan) + least_error(plan)) * UM,
        "life_fraction": plan.life_fraction,
        "edge_share": plan.edge_share(&study.planner),
        "cutting_time [min]": plan.cutting_time / 60.0,
        "corner_time [min]": plan.corner_time / 60.0,
        "speed_change_time [min]": plan.speed_change_time / 60.0,
        "ramp_time [min]": plan.ramp_time / 60.0,
        "edge_changes": plan.edge_changes.iter().map(|at| study.planner.pieces()[*at].section + 1).collect::<Vec<_>>(),
        "warnings": plan.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "sections": plan.sections.iter().zip(study.planner.pieces()).map(section_json).collect::<Vec<_>>(),
    })
}

fn section_json((section, piece): (&PlannedSection, &Piece)) -> Value {
    json!({
        "section": piece.section + 1,
        "from [mm]": piece.from * MM,
        "engagement [deg]": section.evaluation.engagement.angle.to_degrees(),
        "spindle_speed [rpm]": rpm(section),
        "feed_per_tooth [mm]": section.setting.feed_per_tooth * MM,
        "feed [mm/min]": section.evaluation.feed * 60.0 * MM,
        "time [min]": section.time / 60.0,
        "active_constraint": section.active.map(Constraint::name),
    })
}

fn baseline_json(study: &PassStudy<'_>, baseline: &Baseline) -> Value {
    match &baseline.plan {
        Ok(plan) => json!({
            "pass": study.name,
            "name": baseline.name,
            "time [min]": plan.time / 60.0,
            "cost": plan.cost,
            "life_fraction": plan.life_fraction,
            "spindle_speed [rpm]": plan.sections.first().map(rpm),
        }),
        Err(error) => json!({
            "pass": study.name,
            "name": baseline.name,
            "time [min]": null,
            "cost": null,
            "reason": error.to_string(),
        }),
    }
}

fn gain_json(gain: Option<Gain>) -> Value {
    gain.map_or(Value::Null, |gain| {
        json!({ "productivity_gain": gain.productivity, "cost_change": gain.cost, "as_reported": gain.as_reported() })
    })
}

fn condition_json(study: &PassStudy<'_>, condition: &Condition) -> Value {
    let [time, cost] = condition.gains;
    json!({ "pass": study.name, "condition": condition.name, "time": gain_json(time), "cost": gain_json(cost) })
}

fn scatter_json(study: &PassStudy<'_>, scattered: &Scattered) -> Value {
    let bands = |sensitivity: &Sensitivity| {
        let quantiles = |of: &dyn Fn(f64) -> Option<f64>| json!({ "p05": of(0.05), "p25": of(0.25), "p50": of(0.5), "p75": of(0.75), "p95": of(0.95) });
        let broken: serde_json::Map<String, Value> = Constraint::ALL
            .into_iter()
            .map(|constraint| (constraint.name().to_owned(), json!(sensitivity.broken(constraint))))
            .filter(|(_, share)| share.as_f64() > Some(0.0))
            .collect();
        json!({
            "draws": sensitivity.draws.len(),
            "productivity_gain": quantiles(&|share| sensitivity.productivity_gain(share)),
            "cost_change": quantiles(&|share| sensitivity.cost_change(share)),
            "without_plan": sensitivity.without_plan(),
            "nominal_plan_breaks": broken,
        })
    };
    let [time, cost] = &scattered.by_objective;
    json!({ "pass": study.name, "scatter": scattered.name, "time": bands(time), "cost": bands(cost) })
}

/// Every section of every regime.
fn sections(studies: &[PassStudy<'_>]) -> String {
    let columns = [
        "pass",
        "regime",
        "section",
        "from [mm]",
        "shape",
        "radius [mm]",
        "length [mm]",
        "spindle_speed [rpm]",
        "feed_per_tooth [mm]",
        "feed [mm/min]",
        "time [s]",
        "edge_life",
        "active_constraint",
        "deflection [um]",
        "path_error [um]",
        "roughness [um]",
        "power [kW]",
        "normal_force [N]",
    ];
    let ratios = Constraint::ALL.iter().map(|constraint| format!("{constraint}_ratio"));
    let header = columns.map(str::to_owned).into_iter().chain(ratios);
    let mut rows: Vec<Vec<Cell<'_>>> = Vec::new();
    for study in studies {
        let baselines =
            study.baselines.iter().filter_map(|each| Some((each.name.to_owned(), each.plan.as_ref().ok()?)));
        let plans = OBJECTIVES.iter().zip(&study.plans).map(|((name, _), plan)| (format!("least {name}"), plan));
        for (regime, plan) in baselines.chain(plans) {
            let contour = study.planner.contour();
            let places = study.planner.pieces();
            for ((drawn, place), section) in contour.sections.iter().zip(places).zip(&plan.sections) {
                let (shape, evaluation) = (contour.shape(drawn), &section.evaluation);
                let mut row: Vec<Cell<'_>> = vec![
                    study.name.into(),
                    regime.clone().into(),
                    (place.section + 1).into(),
                    (place.from * MM).into(),
                    shape.name().into(),
                    shape.radius().map(|radius| radius * MM).into(),
                    (drawn.length * MM).into(),
                    rpm(section).into(),
                    (section.setting.feed_per_tooth * MM).into(),
                    (evaluation.feed * 60.0 * MM).into(),
                    section.time.into(),
                    section.life_fraction.into(),
                    section.active.map(Constraint::name).into(),
                    (evaluation.deflection * UM).into(),
                    (evaluation.path_error * UM).into(),
                    (evaluation.roughness * UM).into(),
                    (evaluation.power * 1e-3).into(),
                    evaluation.forces.normal.into(),
                ];
                row.extend(evaluation.ratios.iter().map(|(_, ratio)| Cell::Number(ratio)));
                rows.push(row);
            }
        }
    }
    table(header, rows)
}

fn conditions(studies: &[PassStudy<'_>]) -> String {
    let mut rows: Vec<[Cell<'_>; 5]> = Vec::new();
    for study in studies {
        for condition in &study.conditions {
            for ((objective, _), gain) in OBJECTIVES.iter().zip(condition.gains) {
                rows.push([
                    study.name.into(),
                    (&condition.name).into(),
                    (*objective).into(),
                    gain.map(|gain| gain.productivity).into(),
                    gain.map(|gain| gain.cost).into(),
                ]);
            }
        }
    }
    table(["pass", "condition", "objective", "productivity_gain", "cost_change"], rows)
}

fn draws(studies: &[PassStudy<'_>]) -> String {
    let columns = [
        "pass",
        "scatter",
        "objective",
        "draw",
        "allowance [mm]",
        "hardness_ratio",
        "table_feed [mm]",
        "productivity_gain",
        "cost_change",
        "nominal_plan_breaks",
    ];
    let mut rows: Vec<[Cell<'_>; 10]> = Vec::new();
    for study in studies {
        for scattered in &study.scatter {
            for ((objective, _), sensitivity) in OBJECTIVES.iter().zip(&scattered.by_objective) {
                for (k, draw) in sensitivity.draws.iter().enumerate() {
                    let broken: Vec<&str> = draw.broken.iter().map(|constraint| constraint.name()).collect();
                    rows.push([
                        study.name.into(),
                        (&scattered.name).into(),
                        (*objective).into(),
                        k.into(),
                        (draw.pass.allowance * MM).into(),
                        draw.pass.hardness_ratio.into(),
                        (draw.pass.table_feed * MM).into(),
                        draw.productivity_gain.into(),
                        draw.cost_change.into(),
                        broken.join(" ").into(),
                    ]);
                }
            }
        }
    }
    table(columns, rows)
}
