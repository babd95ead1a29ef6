//! The files of an identification.

use super::Study;
use super::picture::report;
use crate::args::IdentifyArgs;
use crate::failure::Failure;
use crate::output::{OutputDir, provenance};
use serde_json::{Value, json};
use std::time::Duration;
use toolroom_infeed::{Estimate, Scatter, Shifted, TrialLag};
use toolroom_process::table::Cell;

const UM: f64 = 1e6;
/// N/m to N/um.
const N_PER_UM: f64 = 1e-6;

/// The files of every identification.
pub const NAMES: &[&str] = &["trials.csv", "identify.json", "report.html"];

/// Writes `trials.csv`, `identify.json`, `report.html` and, last, `run.json`.
pub fn write(out: &OutputDir, args: &IdentifyArgs, study: &Study, wall: Duration) -> Result<(), Failure> {
    let mut arguments: Vec<String> = Vec::new();
    if let Some(force) = &args.forces {
        arguments.extend(["--forces".to_owned(), force.display().to_string()]);
    }
    arguments.extend(["--basis".to_owned(), args.basis.name().to_owned()]);
    arguments.extend(args.error.iter().flat_map(|change| ["--error".to_owned(), change.clone()]));
    let inputs: Vec<(String, &[u8])> =
        study.inputs.iter().map(|input| (input.name.clone(), input.bytes.as_slice())).collect();
    let mut provenance = provenance("identify", &inputs[..1], arguments, Some(args.seed));
    provenance
        .inputs
        .extend(inputs[1..].iter().map(|(name, bytes)| (name.clone(), toolroom_shards::fingerprint(bytes))));
    out.put_table("trials.csv", COLUMNS, study.found.trials.iter().map(row))?;
    out.put_json("identify.json", &summary(study))?;
    out.put("report.html", &report(study, provenance.clone()).html())?;
    out.record(&provenance, wall)
}

/// The result for programs.
pub fn summary(study: &Study) -> Value {
    let found = &study.found;
    let trials: Vec<Value> = found
        .trials
        .iter()
        .map(|trial| {
            json!({
                "trial_id": trial.trial_id,
                "K": trial.lag.value,
                "sd": trial.lag.sd,
                "K_stock": estimate(trial.from_stock),
                "K_force": estimate(trial.from_force),
                "process_stiffness [N/um]": trial.process_stiffness.map(|value| value * N_PER_UM),
                "system_stiffness [N/um]": trial.system_stiffness.map(|value| value * N_PER_UM),
                "force_ratio": trial.force_ratio,
            })
        })
        .collect();
    let standard_error = found.lag.sd.map(|sd| sd / (found.trials.len() as f64).sqrt());
    json!({
        "schema": 1,
        "name": study.title,
        "trials": trials,
        "mean": {
            "K": found.lag.mean,
            "median": found.lag.median,
            "sd": found.lag.sd,
            "standard_error": standard_error,
            "ci95": found.lag.ci95,
            "prediction95": found.lag.prediction95,
        },
        "bootstrap": found.bootstrap.as_ref().map(|bootstrap| json!({
            "median": bootstrap.median,
            "ci95": bootstrap.ci95,
            "resamples": bootstrap.resamples,
            "exact": bootstrap.exact,
        })),
        "jackknife": found.jackknife,
        "pooled": found.pooled.as_ref().map(|pooled| json!({
            "K": pooled.lag,
            "ci95": pooled.ci95,
            "sd_stock [um]": pooled.sd_stock.map(|sd| sd * UM),
            "residuals [um]": pooled.residuals.iter().map(|each| each * UM).collect::<Vec<_>>(),
        })),
        "process_stiffness [N/um]": found.process_stiffness.as_ref().map(stiffness),
        "system_stiffness [N/um]": found.system_stiffness.as_ref().map(stiffness),
        "half_revolution": half_revolution(&found.half_revolution),
        "best_revolutions": found.best.revolutions,
        "best_revolutions_sd": found.best.lag_sd,
        "advice": found.advice.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

fn estimate(estimate: Option<Estimate>) -> Value {
    estimate.map_or(Value::Null, |estimate| json!({ "value": estimate.value, "sd": estimate.sd }))
}

fn stiffness(scatter: &Scatter) -> Value {
    let both = |interval: [f64; 2]| interval.map(|value| value * N_PER_UM);
    json!({
        "mean": scatter.mean * N_PER_UM,
        "sd": scatter.sd.map(|sd| sd * N_PER_UM),
        "ci95": scatter.ci95.map(both),
        "prediction95": scatter.prediction95.map(both),
    })
}

fn half_revolution([less, more]: &[Option<Shifted>; 2]) -> Value {
    let lag = |shifted: &Option<Shifted>| shifted.as_ref().map(|shifted| shifted.lag.mean);
    let stiffness = |shifted: &Option<Shifted>| {
        shifted.as_ref().and_then(|shifted| Some(shifted.system_stiffness.as_ref()?.mean * N_PER_UM))
    };
    json!({
        "K_minus": lag(less),
        "K_plus": lag(more),
        "system_stiffness_minus [N/um]": stiffness(less),
        "system_stiffness_plus [N/um]": stiffness(more),
    })
}

const COLUMNS: [&str; 8] =
    ["trial_id", "K", "sd", "K_stock", "K_force", "process_stiffness [N/um]", "system_stiffness [N/um]", "force_ratio"];

/// One trial.
fn row(trial: &TrialLag) -> [Cell<'_>; 8] {
    [
        (&trial.trial_id).into(),
        trial.lag.value.into(),
        trial.lag.sd.into(),
        trial.from_stock.map(|estimate| estimate.value).into(),
        trial.from_force.map(|estimate| estimate.value).into(),
        trial.process_stiffness.map(|value| value * N_PER_UM).into(),
        trial.system_stiffness.map(|value| value * N_PER_UM).into(),
        trial.force_ratio.into(),
    ]
}
