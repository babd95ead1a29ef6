//! What the key figures of a machine divide.

use std::collections::VecDeque;
use toolroom_shop::runlog::MachineState;

/// Sums of one machine, s unless said otherwise.
#[derive(Clone, Debug, Default)]
pub(super) struct MachineTally {
    /// In shift by what it does; all that is out of shift counts as off shift.
    pub states: [f64; MachineState::ALL.len()],
    /// Repairs out of shift.
    pub repair_off_shift: f64,
    /// What the calendar plans, and overtime.
    pub planned_busy_time: f64,
    /// Programmed time (cutting and handling) of all operations, as far as they lie in the window.
    pub earned: f64,
    /// Programmed time of the operations completed: PRI · PQ.
    pub planned_produced: f64,
    /// The same of the good ones: PRI · GQ.
    pub planned_good: f64,
    /// Programmed cutting time of operations that are good so far, as far as they lie in the window.
    pub programmed_good: f64,
    /// Good operations completed, 1.
    pub good: f64,
    /// Operations begun, 1, and the time for which their jobs had waited in the queue.
    pub begun: f64,
    pub waited: f64,
    /// Failures, 1.
    pub failures: f64,
    /// When the breakdowns were that wait for their crew, s.
    pub calls: VecDeque<f64>,
    /// Time from breakdowns to the beginnings of their repairs, and these, 1; where there are crews.
    pub crew_wait: f64,
    pub repairs_begun: f64,
    /// Operations that a wheel did, by their part in the window.
    pub wheel_parts: f64,
}

impl MachineTally {
    pub fn state(&self, state: MachineState) -> f64 {
        self.states[state as usize]
    }

    pub fn planned_busy_time(&self) -> f64 {
        self.planned_busy_time
    }

    pub fn production_time(&self) -> f64 {
        self.state(MachineState::Cutting) + self.state(MachineState::Working) + self.state(MachineState::Handling)
    }

    pub fn setup_time(&self) -> f64 {
        self.state(MachineState::Setup)
    }

    /// In shift with an order, but neither in production nor in setup.
    pub fn delay_time(&self) -> f64 {
        let delay = [
            MachineState::ToolChange,
            MachineState::Dressing,
            MachineState::Starved,
            MachineState::Blocked,
            MachineState::WaitingOperator,
            MachineState::WaitingFixture,
            MachineState::WaitingTool,
            MachineState::Down,
        ]
        .map(|state| self.state(state));
        delay.iter().sum::<f64>()
    }

    /// Production, setup and delay: all but idle.
    pub fn busy_time(&self) -> f64 {
        self.production_time() + self.setup_time() + self.delay_time()
    }

    /// Down by the clock, in shift and out of it.
    pub fn down_time(&self) -> f64 {
        self.state(MachineState::Down) + self.repair_off_shift
    }

    pub fn utilisation(&self) -> f64 {
        let empty = [MachineState::Idle, MachineState::WaitingFixture, MachineState::WaitingTool, MachineState::Down];
        let idle: f64 = empty.map(|state| self.state(state)).iter().sum();
        1.0 - idle / self.planned_busy_time()
    }
}
