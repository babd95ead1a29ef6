//! ModelStructure against the variables.

use super::{Findings, Rule, Severity};
use crate::description::{ModelDescription, Unknown};
use std::collections::BTreeSet;

pub(super) fn check(description: &ModelDescription, findings: &mut Findings) {
    let structure = &description.structure;
    let variables = &description.variables;
    let listed = |unknowns: &[Unknown]| unknowns.iter().map(|unknown| unknown.variable).collect::<BTreeSet<_>>();
    let (outputs, derivatives, initial) =
        (listed(&structure.outputs), listed(&structure.derivatives), listed(&structure.initial));
    let due: BTreeSet<usize> = (0..variables.len())
        .filter(|&index| variables[index].causality == "output" && variables[index].variability != "constant")
        .collect();
    let constant = |index: &usize| variables[*index].causality == "output";
    compare(
        "output",
        &due,
        &outputs.iter().copied().filter(|i| due.contains(i) || !constant(i)).collect(),
        description,
        findings,
    );
    let states: BTreeSet<usize> =
        (0..variables.len()).filter(|&index| variables[index].derivative_of.is_some()).collect();
    // A derivative may exist without being a state's (FMI 3.0), but what is listed has to be one.
    for index in derivatives.difference(&states) {
        let message =
            format!("{} is listed as derivative of a state, but has no attribute derivative", variables[*index].name);
        findings.line(Rule::Structure, Severity::Error, variables[*index].line, message);
    }
    if description.major == 2 && description.model_exchange.is_some() && !states.is_subset(&derivatives) {
        findings.whole(Rule::Structure, Severity::Error, "a derivative is missing among <Derivatives>");
    }
    let due: BTreeSet<usize> =
        (0..variables.len()).filter(|&index| initially_unknown(description, index, &derivatives)).collect();
    compare("initial unknown", &due, &initial, description, findings);
    twice("output", &structure.outputs, description, findings);
    twice("derivative", &structure.derivatives, description, findings);
    twice("initial unknown", &structure.initial, description, findings);
    knowns(description, findings);
}

/// What the standard lists as InitialUnknowns: outputs and calculated parameters that are
/// `approx` or `calculated`, and states and derivatives that are; not what is clocked, which has no value then.
fn initially_unknown(description: &ModelDescription, index: usize, derivatives: &BTreeSet<usize>) -> bool {
    let variable = &description.variables[index];
    let open = matches!(variable.initial.as_deref(), Some("approx" | "calculated"));
    let is_state = derivatives.iter().any(|&derivative| description.variables[derivative].derivative_of == Some(index));
    let kind = matches!(variable.causality.as_str(), "output" | "calculatedParameter")
        || is_state
        || derivatives.contains(&index);
    open && kind && !variable.clocked && variable.variability != "constant"
}

fn compare(
    kind: &str,
    due: &BTreeSet<usize>,
    listed: &BTreeSet<usize>,
    description: &ModelDescription,
    findings: &mut Findings,
) {
    let names = |indices: Vec<usize>| {
        let shown: Vec<&str> =
            indices.iter().take(5).map(|&index| description.variables[index].name.as_str()).collect();
        let more = if indices.len() > 5 { format!(" and {} more", indices.len() - 5) } else { String::new() };
        format!("{}{more}", shown.join(", "))
    };
    let missing: Vec<usize> = due.difference(listed).copied().collect();
    if !missing.is_empty() {
        let message = format!("missing in <ModelStructure> as {kind}: {}", names(missing));
        findings.whole(Rule::Structure, Severity::Error, message);
    }
    let extra: Vec<usize> = listed.difference(due).copied().collect();
    if !extra.is_empty() {
        let message = format!("in <ModelStructure> as {kind}, but is none: {}", names(extra));
        findings.whole(Rule::Structure, Severity::Error, message);
    }
}

fn twice(kind: &str, unknowns: &[Unknown], description: &ModelDescription, findings: &mut Findings) {
    let mut seen = BTreeSet::new();
    for unknown in unknowns {
        if !seen.insert(unknown.variable) {
            let message = format!("{} is listed twice as {kind}", description.variables[unknown.variable].name);
            findings.line(Rule::Structure, Severity::Error, unknown.line, message);
        }
    }
}

/// Outputs and derivatives depend on knowns of their mode: inputs, states, time, discrete
/// states. A dependency on a derivative or on another continuous output is a fault.
fn knowns(description: &ModelDescription, findings: &mut Findings) {
    let derivatives: BTreeSet<usize> =
        description.structure.derivatives.iter().map(|unknown| unknown.variable).collect();
    let states: BTreeSet<usize> =
        derivatives.iter().filter_map(|&derivative| description.variables[derivative].derivative_of).collect();
    for unknown in description.structure.outputs.iter().chain(&description.structure.derivatives) {
        for &index in unknown.dependencies.iter().flatten() {
            let variables = &description.variables[index];
            let continuous_output = variables.causality == "output" && variables.variability == "continuous";
            if derivatives.contains(&index) || (continuous_output && !states.contains(&index)) {
                let name = &description.variables[unknown.variable].name;
                let message = format!("{name} is said to depend on {}, which is no known", variables.name);
                findings.line(Rule::Structure, Severity::Error, unknown.line, message);
            }
        }
    }
}
