//! How an imported unit stands in for a process.

use std::collections::BTreeMap;

/// Which variable of an imported unit stands for which quantity of the process it replaces.
///
/// What is left out is found by name: the variable `cutting_speed`, or the only one that ends
/// with `.cutting_speed`. A variable may carry the unit that its author left out:
/// `"vc [m/min]"`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wiring {
    /// Variable for an input of the process.
    pub inputs: BTreeMap<String, String>,
    /// Variable for an output of the process.
    pub outputs: BTreeMap<String, String>,
    /// Boolean variable that becomes true at an event of the process.
    pub events: BTreeMap<String, String>,
    /// Start values of parameters of the unit, as text, in the unit's own units.
    pub start: BTreeMap<String, String>,
    /// Longest communication step, s; a whole pass if `None`. A unit without FMU state
    /// shows its events at the end of a step only.
    pub step: Option<f64>,
    /// Where the unit's code runs.
    pub isolation: UnitIsolation,
    /// Longest time that one call of the unit may take in its worker process, s; the importer's own if `None`.
    pub call_limit: Option<f64>,
}

/// Where the code of an imported unit runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnitIsolation {
    /// In a worker process: a unit that hangs, crashes or ends its process fails one replication.
    #[default]
    Process,
    /// In the program itself: fastest, for units that one trusts.
    None,
}
