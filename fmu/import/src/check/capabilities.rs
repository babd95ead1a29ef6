//! Capability flags, default experiment, log categories.

use super::{Findings, Rule, Severity};
use crate::description::{Experiment, ModelDescription, ValueType};
use std::collections::BTreeSet;

pub(super) fn check(description: &ModelDescription, findings: &mut Findings) {
    if description.interfaces().next().is_none() {
        findings.whole(
            Rule::Description,
            Severity::Error,
            "the unit has no interface: no Co-Simulation, no Model Exchange",
        );
    }
    if description.token.is_empty() {
        findings.whole(
            Rule::Instances,
            Severity::Error,
            "the token that fmi2Instantiate and fmi3Instantiate check is empty",
        );
    }
    for (name, interface) in description.interfaces() {
        let mut add = |rule, severity, message: &str| findings.whole(rule, severity, format!("{name}: {message}"));
        if interface.serializes_state() && !interface.saves_state() {
            add(Rule::State, Severity::Error, "it serialises the FMU state, but cannot get and set it");
        }
        if !interface.saves_state() {
            add(Rule::State, Severity::Note, "no FMU state: a master cannot go back to an earlier time");
        } else if !interface.serializes_state() {
            add(Rule::State, Severity::Note, "the FMU state cannot be serialised: it lives in one instance only");
        }
        if interface.can("canBeInstantiatedOnlyOncePerProcess") {
            add(
                Rule::Instances,
                Severity::Warning,
                "only one instance a process: no two machines, no parallel replications",
            );
        }
        if name == "Co-Simulation" && !interface.can("canHandleVariableCommunicationStepSize") {
            let message = match description.fixed_step(interface) {
                Some(step) => format!("it takes communication steps of {step} s only"),
                None => "it takes communication steps of one length only, and does not say of which".to_owned(),
            };
            add(Rule::Time, Severity::Note, &message);
        }
        let clocks: Vec<&str> = description.clocks().map(|clock| clock.name.as_str()).collect();
        if name == "Co-Simulation" && !clocks.is_empty() {
            let clocks = clocks.join(", ");
            let message = format!("no clock ticks for an importer without Event Mode, as toolroom is one: {clocks}");
            add(Rule::Events, Severity::Note, &message);
        }
        if let Some(clock) = description.clock_to_tick().filter(|_| name == "Model Exchange") {
            let clock = &clock.name;
            let message = format!("its importer has to tick the clock {clock}; toolroom drives no such unit");
            add(Rule::Events, Severity::Note, &message);
        }
        if interface.can("needsExecutionTool") {
            add(Rule::Instances, Severity::Warning, "it needs the tool that exported it");
        }
        let discrete = description.variables.iter().any(|variable| {
            variable.causality == "input"
                && variable.variability == "discrete"
                && variable.value_type != ValueType::Clock
        });
        if name == "Co-Simulation" && description.major == 3 && discrete && !interface.can("hasEventMode") {
            add(Rule::Events, Severity::Note, "discrete inputs without Event Mode take effect at the next step");
        }
        if name == "Co-Simulation"
            && description.major == 3
            && interface.can("mightReturnEarlyFromDoStep")
            && !interface.can("hasEventMode")
        {
            add(Rule::Events, Severity::Note, "it may return early from a step, yet has no Event Mode to say why");
        }
    }
    experiment(&description.experiment, findings);
    categories(description, findings);
}

fn experiment(experiment: &Experiment, findings: &mut Findings) {
    let mut fault = |message: String| findings.whole(Rule::Time, Severity::Error, message);
    let Experiment { start, stop, tolerance, step } = *experiment;
    let numbers = [("startTime", start), ("stopTime", stop), ("tolerance", tolerance), ("stepSize", step)];
    for (name, value) in numbers {
        if value.is_some_and(|value| !value.is_finite()) {
            fault(format!("{name} is not finite"));
        }
    }
    let begin = start.unwrap_or(0.0);
    if stop.is_some_and(|stop| stop <= begin) {
        fault(format!("stopTime = {} is not after startTime = {begin}", stop.unwrap_or_default()));
    }
    if tolerance.is_some_and(|tolerance| tolerance <= 0.0) {
        fault("tolerance is not positive".to_owned());
    }
    if step.is_some_and(|step| step <= 0.0) {
        fault("stepSize is not positive".to_owned());
    }
    if let (Some(stop), Some(step)) = (stop, step)
        && step > 0.0
        && stop > begin
    {
        let steps = (stop - begin) / step;
        if (steps - steps.round()).abs() > 1e-9 * steps {
            let message =
                format!("stepSize = {step} does not divide the experiment: {steps} steps; masters round differently");
            findings.whole(Rule::Time, Severity::Note, message);
        }
    }
    if stop.is_none() {
        findings.whole(
            Rule::Time,
            Severity::Note,
            "no stopTime in DefaultExperiment: importers choose one of their own",
        );
    }
}

fn categories(description: &ModelDescription, findings: &mut Findings) {
    let mut seen = BTreeSet::new();
    for category in &description.log_categories {
        if category.is_empty() {
            findings.whole(Rule::Logging, Severity::Error, "a log category has no name");
        } else if !seen.insert(category) {
            findings.whole(Rule::Logging, Severity::Error, format!("two log categories are called {category}"));
        }
    }
    if description.log_categories.is_empty() {
        findings.whole(Rule::Logging, Severity::Note, "no log categories: an importer cannot choose what is logged");
    }
}
