//! Facts that contradict their file, as constants that an application writes.

use serde_json::{Value, json};
use std::collections::BTreeSet;
use toolroom_facts::{Fact, Quantity};
use toolroom_gap::Diagnosis;

/// Half the width of a 90 % interval in standard errors. Derivation: normal quantile.
const NINETY: f64 = 1.645;

/// Entries of `applied.calibration` for times between failures and repairs that were found off, machine by machine. A pool
/// speaks for its machines; a machine speaks for itself where its pool was not found off. What was never seen has no
/// factor.
pub fn constants_of_facts(process: &str, diagnosis: &Diagnosis) -> Vec<Value> {
    let mut entries = Vec::new();
    for quantity in [Quantity::TimeBetweenFailures, Quantity::TimeToRepair] {
        let found = diagnosis.findings.iter().map(|finding| &diagnosis.facts[finding.fact]);
        let mut found: Vec<&Fact> =
            found.filter(|fact| fact.quantity == quantity && fact.estimate.is_finite()).collect();
        found.sort_by_key(|fact| !fact.pooled);
        let mut known = BTreeSet::new();
        for fact in found {
            for machine in fact.place.split(", ").filter(|machine| known.insert(machine.to_owned())) {
                let error = (fact.ci90[1] / fact.ci90[0]).ln() / (2.0 * NINETY);
                entries.push(json!({
                    "parameter": quantity.name(), "target": format!("machine {machine}"), "process": process, "scope": {},
                    "factor": fact.factor(), "se": if error.is_finite() { json!(error) } else { Value::Null },
                    "prior": null, "moved_sd": null,
                }));
            }
        }
    }
    entries
}
