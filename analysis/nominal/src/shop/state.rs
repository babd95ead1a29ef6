//! Words for what a machine does.

/// What a machine does, as far as a diagnosis cares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// The program runs, or plain work goes on.
    Cutting,
    /// Loading or unloading.
    Handling,
    /// Changing an edge.
    ToolChange,
    /// Changing over, dressing.
    Setup,
    /// Feed held by a person or an interlock in the middle of the program.
    Hold,
    /// Stopped; short ones are booked micro-stops, long ones breakdowns.
    Stopped,
    /// Nothing to do, or waiting for somebody.
    Idle,
    /// Out of shift, or maintained as planned.
    OffShift,
    /// Nobody knows.
    Unknown,
}

impl State {
    /// The state of a word: the simulator's own, MTConnect's execution states, and what shops
    /// commonly write.
    ///
    /// ```
    /// use toolroom_nominal::shop::State;
    /// assert_eq!(State::of("FEED_HOLD"), State::Hold);
    /// assert_eq!(State::of("off shift"), State::OffShift);
    /// assert_eq!(State::of("working"), State::Cutting);
    /// assert_eq!(State::of("UNAVAILABLE"), State::Unknown);
    /// ```
    pub fn of(word: &str) -> Self {
        let word = word.trim().to_ascii_lowercase().replace([' ', '-'], "_");
        match word.as_str() {
            "cutting" | "working" | "active" | "executing" | "running" | "run" | "machining" | "processing"
            | "busy" => Self::Cutting,
            "handling" | "load" | "loading" | "unload" | "unloading" | "clamping" => Self::Handling,
            "tool_change" | "toolchange" | "tool_changing" | "edge_change" => Self::ToolChange,
            "setup" | "changeover" | "dressing" => Self::Setup,
            "feed_hold" | "hold" | "interrupted" | "program_hold" => Self::Hold,
            "stopped" | "stop" | "micro_stop" | "program_stopped" | "optional_stop" | "down" | "breakdown"
            | "failure" | "fault" | "alarm" | "error" | "repair" | "wait" | "waiting" => Self::Stopped,
            "idle" | "waiting_operator" | "waiting_fixture" | "waiting_tool" | "ready" | "program_completed"
            | "starved" | "blocked" | "standby" => Self::Idle,
            "off_shift" | "off" | "offline" | "break" | "closed" | "maintenance" => Self::OffShift,
            _ => Self::Unknown,
        }
    }
}
