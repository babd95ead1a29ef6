//! Key figures by part type, customer and station: tables of their own beside those of the shop and its machines.
//!
//! Their values stand in each run behind those that a planner asks for.

use crate::kpi::{Definition, GroupKind, group_values_len, kpis};
use crate::planner::Figures;
use crate::study::Study;
use crate::summary::with_figures;
use serde_json::{Map, Value, json};
use std::io;
use toolroom_process::table::CsvWriter;
use toolroom_scenario::Scenario;
use toolroom_statistics::{CONFIDENCE, Interval, t_interval};

/// Files of the groups, with what they are of.
pub const FILES: [(&str, GroupKind); 3] =
    [("parts.csv", GroupKind::Part), ("customers.csv", GroupKind::Customer), ("stations.csv", GroupKind::Station)];

/// Numbers of a run of a scenario: key figures, what a planner asks, and figures of groups.
pub(crate) fn width(scenario: &Scenario) -> usize {
    before(scenario) + group_values_len(scenario)
}

/// Numbers of a run before those of groups.
fn before(scenario: &Scenario) -> usize {
    kpis(scenario).len() + Figures::of(scenario).len()
}

/// The groups of a kind with their figures under a policy, SI.
fn figures(
    scenario: &Scenario,
    study: &Study,
    kind: GroupKind,
    policy: usize,
) -> Vec<(String, Vec<(&'static Definition, Interval)>)> {
    let earlier = GroupKind::ALL.into_iter().take_while(|own| *own != kind);
    let first: usize = earlier.map(|own| own.groups(scenario).len() * own.definitions().count()).sum();
    let mut column = before(scenario) + first;
    let mut of_group = |name: String| {
        let figures = kind.definitions().map(|definition| {
            column += 1;
            (definition, t_interval(&study.samples(policy, column - 1), CONFIDENCE))
        });
        (name, figures.collect())
    };
    kind.groups(scenario).into_iter().map(&mut of_group).collect()
}

/// Writes the table of a kind: one row a policy, group and figure, its mean over the replications with the half-width of the
/// 95 % interval, in the unit beside them, empty where they are not defined.
///
/// # Errors
/// What the writer says.
pub fn write(scenario: &Scenario, study: &Study, kind: GroupKind, out: impl io::Write) -> io::Result<()> {
    let mut csv = CsvWriter::new(out, ["policy", kind.name(), "kpi", "unit", "mean", "half_width"])?;
    if study.replications > 0 {
        for (position, &policy) in study.policies.iter().enumerate() {
            for (group, figures) in figures(scenario, study, kind, position) {
                for (definition, interval) in figures {
                    let interval = interval.scaled(definition.file_scale());
                    csv.row([
                        (&scenario.policies[policy].name).into(),
                        group.as_str().into(),
                        definition.id.into(),
                        definition.file_unit_in(scenario).into(),
                        interval.mean.into(),
                        interval.half_width.into(),
                    ])?;
                }
            }
        }
    }
    Ok(csv.flush()?)
}

/// The files that a scenario has.
pub fn files(scenario: &Scenario) -> impl Iterator<Item = (&'static str, GroupKind)> + use<'_> {
    FILES.into_iter().filter(|(_, kind)| !kind.groups(scenario).is_empty())
}

/// Figures by groups under every policy for programs: `by_part`, `by_customer` and `by_station`, those that there are.
pub(crate) fn json(scenario: &Scenario, study: &Study) -> Vec<(String, Value)> {
    if study.replications == 0 {
        return Vec::new();
    }
    let of_kind = |(_, kind): (&str, GroupKind)| {
        let of_policy = |(position, policy): (usize, &usize)| {
            let groups = figures(scenario, study, kind, position).into_iter().map(|(name, figures)| {
                let figures: Map<String, Value> = figures
                    .into_iter()
                    .map(|(definition, interval)| (definition.key(), shown(&interval.scaled(definition.file_scale()))))
                    .collect();
                with_figures(&name, figures)
            });
            let mut own = json!({ "policy": scenario.policies[*policy].name });
            own["groups"] = groups.collect();
            own
        };
        let policies: Vec<Value> = study.policies.iter().enumerate().map(of_policy).collect();
        (format!("by_{}", kind.name()), policies.into())
    };
    files(scenario).map(of_kind).collect()
}

fn shown(interval: &Interval) -> Value {
    json!({ "mean": interval.mean, "ci95": [interval.low(), interval.high()], "n": interval.count })
}
