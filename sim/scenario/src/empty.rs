//! The shop in which there is nothing.

use crate::{Blocking, Control, Deadlock, DispatchRule, Distribution, MachineChoice, Preemption, Scenario, Shared};

impl Scenario {
    /// A shop in which there is nothing and no policy runs: one replication of eight hours that are one shift, first in first
    /// out, costs in euros. What is written in Rust instead of a file starts from it and names what it has.
    ///
    /// ```
    /// use toolroom_scenario::Scenario;
    /// let shop = Scenario { name: "trial".to_owned(), seed: 7, ..Scenario::empty() };
    /// assert!(shop.machines.is_empty() && shop.horizon == 28_800.0);
    /// ```
    pub fn empty() -> Self {
        Self {
            name: String::new(),
            title: String::new(),
            start: None,
            seed: 1,
            replications: 1,
            horizon: 28_800.0,
            warm_up: 0.0,
            seeks_warm_up: false,
            shift_length: 28_800.0,
            machines: Vec::new(),
            tools: Vec::new(),
            parts: Vec::new(),
            arrivals: Vec::new(),
            orders: Vec::new(),
            skills: Vec::new(),
            operators: Vec::new(),
            crews: Vec::new(),
            transports: Vec::new(),
            move_time: Distribution::Constant(0.0),
            shared: Shared::default(),
            setup_matrices: Vec::new(),
            machine_choice: MachineChoice::LeastSetup,
            buffers: Vec::new(),
            blocking: Blocking::AfterService,
            deadlock: Deadlock::Stop,
            dispatch: vec![DispatchRule::Fifo],
            control: Control::default(),
            preemption: Preemption::None,
            calendars: Vec::new(),
            failures: Vec::new(),
            maintenance: Vec::new(),
            policies: Vec::new(),
            deviations: Vec::new(),
            calibrations: Vec::new(),
            defined: Vec::new(),
            currency: "EUR".to_owned(),
            branch: None,
        }
    }
}
