//! Facts that contradict their file, as constants that an application writes.

use serde_json::{Value, json};
use std::collections::BTreeSet;
use toolroom_apply::scope_json;
use toolroom_facts::{Fact, Quantity};
use toolroom_gap::Diagnosis;
use toolroom_scenario::{Deviation, Scenario, Scope, ShopEffect};

/// Half the width of a 90 % interval in standard errors. Derivation: normal quantile.
const NINETY: f64 = 1.645;

/// Constants that facts find off, and whose they are.
const OWNED: [(Quantity, &str); 6] = [
    (Quantity::TimeBetweenFailures, "machine"),
    (Quantity::TimeToRepair, "machine"),
    (Quantity::HandlingTime, "machine"),
    (Quantity::ToolChangeTime, "machine"),
    (Quantity::ArrivalInterval, "source"),
    (Quantity::Scrap, "part"),
];

/// Entries of `applied.calibration` for times between failures, repairs, changes of edges and handling that were found off,
/// machine by machine, of times between arrivals, source by source, and of scrap, operation by operation. A pool speaks for its
/// machines; a machine speaks for itself where its pool was not found off. What was never seen has no factor, what is off in its
/// scatter alone none that matters, and what a cause adds is an effect. `known` are the constants that the records of the process
/// move by themselves.
pub fn constants_of_facts(process: &str, diagnosis: &Diagnosis, known: &[Value]) -> Vec<Value> {
    let mut entries = Vec::new();
    for (quantity, owner) in OWNED {
        let found = found(diagnosis).filter(|fact| fact.quantity == quantity && !fact.is_cause());
        let known_size = |fact: &&Fact| fact.factor().is_finite() && fact.factor() > 0.0 && fact.is_far();
        let has_owner = |fact: &&Fact| !fact.told.ownerless;
        let mut found: Vec<&Fact> = found.filter(known_size).filter(has_owner).collect();
        found.sort_by_key(|fact| !fact.pooled);
        let mut told = BTreeSet::new();
        for fact in found.into_iter().filter(|fact| !is_moved(fact, process, known)) {
            // The name of a part may hold a comma.
            let places: Vec<&str> =
                if owner == "machine" { fact.place.split(", ").collect() } else { vec![&fact.place] };
            for place in places.into_iter().filter(|place| told.insert((*place).to_owned())) {
                let error = (fact.ci90[1] / fact.ci90[0]).ln() / (2.0 * NINETY);
                entries.push(json!({
                    "parameter": quantity.name(), "target": format!("{owner} {place}"), "process": process, "scope": {},
                    "factor": fact.factor(), "se": if error.is_finite() { json!(error) } else { Value::Null },
                    "prior": null, "moved_sd": null,
                }));
            }
        }
    }
    entries
}

/// Entries of `applied.effects` for causes that a log tells from constants of the `scenario`. A size is that in all, with
/// what the file states of it.
pub fn causes_of_facts(process: &str, diagnosis: &Diagnosis, scenario: &Scenario) -> Vec<Value> {
    let deviations = &scenario.deviations;
    let mut entries = Vec::new();
    for fact in found(diagnosis).filter(|fact| fact.is_cause()) {
        let Some(delay) = &fact.told.delay else { continue };
        let machines: Vec<String> = fact.place.split(", ").map(str::to_owned).collect();
        let everywhere = scenario.machines.iter().all(|machine| machines.contains(&machine.name));
        let mut names = if everywhere { Vec::new() } else { vec![("machine", machines)] };
        if !fact.told.shifts.is_empty() {
            names.push(("shift", fact.told.shifts.clone()));
        }
        let scope = Scope { names, ..Scope::default() };
        let same = |own: &&Deviation| own.effect.word() == delay.effect && own.scope == scope;
        let before: f64 = deviations.iter().filter(same).map(|own| own.size).sum();
        entries.push(json!({
            "kind": "cause", "id": delay.effect, "process": process, "target": "shop", "shape": {},
            "scope": scope_json(&scope),
            "size": { "value": before + delay.size, "unit": "s", "se": delay.standard_error },
        }));
    }
    entries
}

/// Drops from `calibration` the constants of handling that the cycle times of the process have moved, where the log has said
/// itself how long handling takes, by `constants` or by `causes`: both say the same, and only one is written.
pub fn drop_said_twice(calibration: &mut Vec<Value>, constants: &[Value], causes: &[Value]) {
    let handling = Quantity::HandlingTime.name();
    let delay = ShopEffect::OperatorDelay.word();
    let by_log = |own: &Value| {
        let said = constants.iter().filter(|constant| constant["parameter"] == handling);
        let mut said = said.chain(causes.iter().filter(|cause| cause["id"] == delay));
        said.any(|other| other["process"] == own["process"])
    };
    calibration.retain(|own| own["parameter"] != handling || own["scope"] != json!({}) || !by_log(own));
}

/// Gives the effects of a document that a log names, `causes`, the form of those that the records of a process name.
pub fn complete(effects: &mut Value, causes: &[Value]) {
    let mut left: Vec<&Value> = causes.iter().collect();
    let unfinished = effects.as_array_mut().into_iter().flatten().filter(|own| own["size"].is_number());
    for effect in unfinished {
        let same = |own: &&Value| own["id"] == effect["id"] && own["process"] == effect["process"];
        let Some(place) = left.iter().position(same) else { continue };
        let cause = left.remove(place);
        effect["words"] = effect["shape"].take();
        effect["size"] = json!({
            "value": effect["size"], "unit": effect["unit"], "se": cause["size"]["se"], "ci90": effect["ci90"],
        });
        for key in ["kind", "shape", "scope", "target"] {
            effect[key] = cause[key].clone();
        }
    }
}

fn found(diagnosis: &Diagnosis) -> impl Iterator<Item = &Fact> {
    diagnosis.findings.iter().map(|finding| &diagnosis.facts[finding.fact])
}

/// Whether the constants that the records of the process move say of handling what the fact says, up to what is no finding.
fn is_moved(fact: &Fact, process: &str, known: &[Value]) -> bool {
    let mine = |own: &&Value| {
        own["process"] == process && own["parameter"] == fact.quantity.name() && own["scope"] == json!({})
    };
    let mut model = fact.model;
    for own in known.iter().filter(mine) {
        model = model * own["factor"].as_f64().unwrap_or(1.0) + own["summand"].as_f64().unwrap_or(0.0);
    }
    model != fact.model && !Fact { model, ..fact.clone() }.is_far()
}
