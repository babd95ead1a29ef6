//! What tuning found, for people and programs.

use super::{Excluded, ToolChangeTried, TunedPolicy, Tuning};
use crate::compare::Comparison;
use crate::figure::{decimals, plain, signed};
use crate::study::Study;
use serde_json::{Value, json};
use std::fmt::Write;

/// What one policy was tuned to, and what that is worth on fresh random numbers.
struct TuningVerdict<'a> {
    policy: &'a TunedPolicy,
    role: String,
    /// Mean of the objective in the comparison, in the unit of files.
    judged: Option<f64>,
}

fn judged<'a>(tuning: &'a Tuning, study: &Study, comparison: &Comparison) -> Vec<TuningVerdict<'a>> {
    let index = study.index(&tuning.objective);
    let result = |policy: &'a TunedPolicy| {
        let position = comparison.policies.iter().position(|result| result.name == policy.name)?;
        let result = &comparison.policies[position];
        let judged = index.map(|index| study.kpis[index].definition.file_scale() * result.kpis[index].mean);
        Some(TuningVerdict { policy, role: result.role.describe(), judged: judged.filter(|mean| mean.is_finite()) })
    };
    tuning.policies.iter().filter_map(result).collect()
}

/// The settings of every policy, and what they cost while tuning and when judged, one line each.
pub fn tuning_text(tuning: &Tuning, study: &Study, comparison: &Comparison) -> String {
    let mut text = format!(
        "tuned for {}: {} replications each on seed {}; at most {} % of edges may collapse\n",
        tuning.objective,
        tuning.budget,
        tuning.seed,
        plain(100.0 * tuning.collapse, 1).trim_end_matches(".0"),
    );
    for TuningVerdict { policy, judged, .. } in judged(tuning, study, comparison) {
        let _ = writeln!(text, "  {}: {}", policy.name, line(policy, judged, &tuning.unit));
    }
    if let Some(verdict) = &tuning.without_guard {
        let _ = writeln!(text, "  without the guard: {}", verdict.line);
    }
    text
}

fn line(policy: &TunedPolicy, judged: Option<f64>, unit: &str) -> String {
    let (Some(tuned), Some(error)) = (policy.objective, policy.standard_error) else {
        let excluded = policy.excluded.as_ref().map(|Excluded { settings, objective, .. }| {
            format!("; without it {settings} at {}", plain(*objective, decimals(*objective, f64::NAN)))
        });
        return format!("as given ({}){}", policy.given.as_deref().unwrap_or_default(), excluded.unwrap_or_default());
    };
    let settings = policy.settings.iter().map(|setting| {
        let end = if setting.border { " at the end of its range" } else { "" };
        format!("{} {}{end} (flat {} … {})", setting.key, setting.value, setting.flat.0, setting.flat.1)
    });
    let digits = decimals(tuned, error);
    let unit = if unit == "1" { "" } else { unit };
    let mut text = settings.collect::<Vec<_>>().join(", ");
    let _ = write!(text, "; tuned {} ± {} {unit}", plain(tuned, digits), plain(error, digits));
    if let Some(judged) = judged {
        let _ = write!(text, ", judged {} (optimism {})", plain(judged, digits), signed(judged - tuned, digits));
    }
    if let (Some(collapsed), Some(failed)) = (policy.collapsed, policy.failed) {
        let _ = write!(
            text,
            "; {} % of edges lost in cut, {} % by collapse",
            plain(100.0 * failed, 1),
            plain(100.0 * collapsed, 1)
        );
    }
    if let Some(Excluded { settings, objective, .. }) = &policy.excluded {
        let _ = write!(text, "; the guard excludes {settings} at {}", plain(*objective, digits));
    }
    text.push_str(&changes_tried(policy, digits));
    text
}

/// The rule of tool change that was chosen, and what the others would cost.
fn changes_tried(policy: &TunedPolicy, digits: usize) -> String {
    let told = |tried: &ToolChangeTried| match tried.objective {
        Some(objective) => format!("{} ({}) {}", tried.rule, tried.settings, plain(objective, digits)),
        None => format!("{} has no setting that the guard lets stand", tried.rule),
    };
    match policy.tool_changes.as_slice() {
        [chosen, others @ ..] => {
            format!("; changed by {}: {}", chosen.rule, others.iter().map(told).collect::<Vec<_>>().join(", "))
        }
        [] => String::new(),
    }
}

/// The same for programs: the key `tuning` of `summary.json`.
pub fn tuning_json(tuning: &Tuning, study: &Study, comparison: &Comparison) -> Value {
    let rows = judged(tuning, study, comparison).into_iter().map(|TuningVerdict { policy, role, judged }| {
        let settings = policy.settings.iter().map(|setting| (setting.key.clone(), json!(setting.value)));
        let flat = policy.settings.iter().map(|setting| (setting.key.clone(), json!([setting.flat.0, setting.flat.1])));
        json!({
            "policy": policy.name,
            "role": role,
            "settings": settings.collect::<serde_json::Map<_, _>>(),
            "flat": flat.collect::<serde_json::Map<_, _>>(),
            "given": policy.given,
            "evaluations": policy.evaluations,
            "tuned": policy.objective,
            "standard_error": policy.standard_error,
            "judged": judged,
            "optimism": policy.objective.zip(judged).map(|(tuned, judged)| judged - tuned),
            "collapsed": policy.collapsed,
            "failed": policy.failed,
            "border": policy.settings.iter().any(|setting| setting.border),
            "excluded": policy.excluded.as_ref().map(|Excluded { settings, objective, changes }| {
                json!({ "settings": settings, "tuned": objective, "set": changes })
            }),
            "tool_change": policy.tool_changes,
            "map": policy.map,
            "set": policy.changes,
        })
    });
    json!(rows.collect::<Vec<_>>())
}
