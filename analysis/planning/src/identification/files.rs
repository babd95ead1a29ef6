//! The files of an identification.

use super::IdentificationStudy;
use super::picture::report;
use crate::tables::table;
use serde_json::{Value, json};
use toolroom_chart::ResultFiles;
use toolroom_chart::page::Provenance;
use toolroom_infeed::{Estimate, Scatter, Shifted, TrialLag};
use toolroom_process::table::Cell;

const UM: f64 = 1e6;
/// N/m to N/um.
const N_PER_UM: f64 = 1e-6;

impl IdentificationStudy {
    /// `trials.csv`, `identify.json` and `report.html`.
    pub fn files(&self, provenance: Provenance) -> ResultFiles {
        let mut files = ResultFiles::default();
        files.push("trials.csv", table(COLUMNS, self.identification.trials.iter().map(row)));
        files.push("identify.json", format!("{:#}\n", self.summary()));
        files.push("report.html", report(self, provenance).html());
        files
    }

    /// The result for programs.
    pub fn summary(&self) -> Value {
        let found = &self.identification;
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
            "name": self.title,
            "trials": trials,
            "left_out": found.left_out.iter().map(|trial| json!({
                "trial_id": trial.trial_id,
                "line": trial.line,
                "code": trial.fault.code(),
                "reason": trial.fault.to_string(),
            })).collect::<Vec<_>>(),
            "mean": {
                "K": found.lag.mean,
                "median": found.lag.median,
                "huber": found.lag.huber,
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
            "joint": found.joint.as_ref().map(|joint| json!({
                "process_stiffness [N/um]": scaled(joint.process_stiffness, N_PER_UM),
                "system_stiffness [N/um]": scaled(joint.system_stiffness, N_PER_UM),
                "threshold_force [N]": estimate(joint.threshold_force),
                "force_exponent": estimate(joint.force_exponent),
                "misfit": joint.misfit,
                "readings": joint.readings,
            })),
            "process_stiffness [N/um]": found.process_stiffness.as_ref().map(stiffness),
            "system_stiffness [N/um]": found.system_stiffness.as_ref().map(stiffness),
            "half_revolution": half_revolution(&found.half_revolution),
            "best_revolutions": found.best.revolutions,
            "best_revolutions_sd": found.best.lag_sd,
            "advice": found.advice.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
    }
}

fn estimate(estimate: Option<Estimate>) -> Value {
    estimate.map_or(Value::Null, |estimate| json!({ "value": estimate.value, "sd": estimate.sd }))
}

fn scaled(Estimate { value, sd }: Estimate, scale: f64) -> Value {
    estimate(Some(Estimate { value: value * scale, sd: sd * scale }))
}

fn stiffness(scatter: &Scatter) -> Value {
    let both = |interval: [f64; 2]| interval.map(|value| value * N_PER_UM);
    json!({
        "mean": scatter.mean * N_PER_UM,
        "median": scatter.median * N_PER_UM,
        "huber": scatter.huber * N_PER_UM,
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
