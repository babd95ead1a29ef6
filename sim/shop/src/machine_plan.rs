//! What the engine asks of a machine whenever it chooses and begins, beside that of the others: a machine of the scenario is
//! too large to be looked at several times an event.

use toolroom_scenario::{Blocking, Scenario};

/// A machine as the engine sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct MachinePlan {
    /// Time of a setup for operations that have none of their own, s.
    pub setup_time: f64,
    /// Its setup matrix, by index.
    pub setup_matrix: Option<u32>,
    /// Whether it works on several jobs at once.
    pub is_batch: bool,
    /// Whether it begins operations only where they will be over before its shift is.
    pub fits_shifts: bool,
    /// Whether the first job by its rules can always be begun: without components, fixtures, a place to reserve or a shift that
    /// ends.
    pub takes_first: bool,
    /// Whether plain work that needs no setup is one step: nothing is loaded or unloaded, nobody attends, nothing breaks down and
    /// nothing is calibrated.
    pub one_step: bool,
    /// Whether such work of its own is all that it does.
    pub is_alone: bool,
    /// Whether no queue looks at the work that waits elsewhere, either, see [`quick`](super::quick).
    pub is_quick: bool,
}

impl MachinePlan {
    /// The machine number `index`; `assembles` where any of its operations needs components.
    pub fn from_scenario(scenario: &Scenario, index: usize, assembles: bool, kinds: [bool; 3]) -> Self {
        let [one_step, is_alone, is_quick] = kinds;
        let machine = &scenario.machines[index];
        let calendar = machine.calendar.map(|calendar| &scenario.calendars[calendar]);
        let fits_shifts = calendar.is_some_and(|calendar| calendar.start_only_if_fits);
        let reserves = !scenario.buffers.is_empty() && scenario.blocking == Blocking::BeforeService;
        Self {
            setup_time: machine.setup_time,
            setup_matrix: machine.setup_matrix.map(|matrix| matrix as u32),
            is_batch: machine.batch.is_some(),
            fits_shifts,
            takes_first: !(reserves || assembles || fits_shifts || !scenario.shared.fixtures.is_empty()),
            one_step,
            is_alone,
            is_quick,
        }
    }
}
