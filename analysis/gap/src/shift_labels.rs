//! In which shift an operation of a log was done.
//!
//! A name of a shift means what whoever gave it says. The records of a process may name shifts, and an effect in a shift that
//! they name is found and applied by that name; beside them a clock of its own would give another operation the same name.

use std::collections::BTreeMap;
use toolroom_nominal::shop::{Shop, Visit};
use toolroom_records::Records;

/// Names of shifts by operation, and by machine and start of an operation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShiftLabels {
    by_operation: BTreeMap<String, String>,
    by_start: BTreeMap<String, Vec<(f64, String)>>,
}

impl ShiftLabels {
    /// What the `records` of a process say; nothing where they name no shifts.
    pub fn from_records(records: &Records) -> Self {
        let mut all = Self::default();
        let Some(shifts) = records.texts("shift") else { return all };
        let (operations, machines) = (records.texts("operation_id"), records.texts("machine"));
        let starts = records.numbers("start_time");
        for (row, shift) in shifts.iter().enumerate().filter(|(_, shift)| !shift.is_empty()) {
            if let Some(operation) = operations.map(|all| &all[row]) {
                // A pass of an operation is called `operation/pass`.
                let whole = operation.rsplit_once('/').map(|(whole, _)| whole);
                for name in [Some(operation.as_str()), whole].into_iter().flatten() {
                    all.by_operation.entry(name.to_owned()).or_insert_with(|| shift.clone());
                }
            }
            if let (Some(machine), Some(start)) = (machines.map(|all| &all[row]), starts.map(|all| all[row]))
                && start.is_finite()
            {
                all.by_start.entry(machine.clone()).or_default().push((start, shift.clone()));
            }
        }
        all.by_start.values_mut().for_each(|starts| starts.sort_by(|a, b| a.0.total_cmp(&b.0)));
        all
    }

    /// The shift of a visit to `machine`: that of its own record, of the record on this machine that began nearest to it, or of the
    /// calendar of the machine. Empty where none of them names one: what has no calendar has no shifts in a run either.
    pub(super) fn shift(&self, shop: &Shop, machine: &str, visit: &Visit) -> String {
        let own = self.by_operation.get(&visit.operation);
        own.cloned().or_else(|| self.nearest(machine, visit.start)).unwrap_or_else(|| {
            let calendar = shop.station(machine).and_then(|station| station.calendar.as_ref());
            calendar
                .filter(|_| self.by_operation.is_empty())
                .map_or_else(String::new, |_| shop.shift(machine, visit.start))
        })
    }

    fn nearest(&self, machine: &str, start: f64) -> Option<String> {
        let all = self.by_start.get(machine)?;
        let after = all.partition_point(|(own, _)| *own < start);
        let near = all[after.saturating_sub(1)..].iter().take(2);
        near.min_by(|a, b| (a.0 - start).abs().total_cmp(&(b.0 - start).abs())).map(|(_, shift)| shift.clone())
    }
}
