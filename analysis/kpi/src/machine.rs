//! Key figures of each machine.

use super::definition::Better::{Less, More, Neither};
use super::definition::{MachineFigure, define, net, oee};
use MachineState::{
    Blocked, Cutting, Down, Dressing, Handling, Idle, Maintenance, OffShift, Setup, Starved, ToolChange,
    WaitingFixture, WaitingOperator, WaitingTool, Working,
};
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::MachineState;

/// Figures of each machine.
pub(super) const MACHINE: &[MachineFigure] = &[
    (
        define("utilisation", "utilisation", "1", "%", Neither, "Share of the shift in which it works on something."),
        |_, m| m.utilisation(),
    ),
    (
        define(
            "load",
            "load",
            "1",
            "%",
            Neither,
            "Share of the shift in which it is not idle; breakdowns occupy it too.",
        ),
        |_, m| m.busy_time() / m.planned_busy_time(),
    ),
    (define("throughput", "throughput", "1/s", "1/h", More, "Good operations per time in shift."), |_, m| {
        m.good / m.planned_busy_time()
    }),
    (define("oee", "OEE", "1", "1", More, "Overall equipment effectiveness."), |_, m| {
        oee(m.earned, m.planned_busy_time(), m.planned_good / m.planned_produced)
    }),
    (define("availability", "availability", "1", "1", More, "Production time over planned busy time."), |_, m| {
        m.production_time() / m.planned_busy_time()
    }),
    (
        define(
            "effectiveness",
            "effectiveness",
            "1",
            "1",
            More,
            "Programmed time of its operations, by the share of each that lies in the window, over production time.",
        ),
        |_, m| m.earned / m.production_time(),
    ),
    (
        define("quality_ratio", "quality ratio", "1", "1", More, "Good over completed operations, by programmed time."),
        |_, m| m.planned_good / m.planned_produced,
    ),
    (
        define("nee", "NEE", "1", "1", More, "Net equipment effectiveness: OEE with setup counted as production."),
        |_, m| {
            let oee = oee(m.earned, m.planned_busy_time(), m.planned_good / m.planned_produced);
            net(m.production_time(), m.setup_time(), oee)
        },
    ),
    (
        define("utilisation_efficiency", "utilisation efficiency", "1", "%", More, "Production time over busy time."),
        |_, m| m.production_time() / m.busy_time(),
    ),
    (
        define(
            "technical_efficiency",
            "technical efficiency",
            "1",
            "%",
            More,
            "Production time over production and delay.",
        ),
        |_, m| m.production_time() / (m.production_time() + m.delay_time()),
    ),
    (define("setup_ratio", "setup ratio", "1", "%", Less, "Setup over production and setup."), |_, m| {
        m.setup_time() / (m.production_time() + m.setup_time())
    }),
    (
        define(
            "mtbf",
            "mean time between failures",
            "s",
            "h",
            More,
            "Planned busy time in which it was not broken down, per failure.",
        ),
        |_, m| (m.planned_busy_time() - m.state(Down)) / m.failures,
    ),
    (
        define(
            "mttr",
            "mean time to repair",
            "s",
            "h",
            Less,
            "Time broken down by the clock, in shift and out of it, per failure.",
        ),
        |_, m| m.down_time() / m.failures,
    ),
    (define("cutting_time_share", "cutting", "1", "%", Neither, "Share of all time in cut."), |t, m| {
        m.state(Cutting) / t.window
    }),
    (define("working_time_share", "working", "1", "%", Neither, "Share of all time in plain work."), |t, m| {
        m.state(Working) / t.window
    }),
    (
        define("handling_time_share", "handling", "1", "%", Neither, "Share of all time loading and unloading."),
        |t, m| m.state(Handling) / t.window,
    ),
    (define("setup_time_share", "setup", "1", "%", Neither, "Share of all time in setup."), |t, m| {
        m.state(Setup) / t.window
    }),
    (
        define("tool_change_time_share", "tool change", "1", "%", Neither, "Share of all time changing edges."),
        |t, m| m.state(ToolChange) / t.window,
    ),
    (define("dressing_time_share", "dressing", "1", "%", Neither, "Share of all time dressing."), |t, m| {
        m.state(Dressing) / t.window
    }),
    (
        define(
            "starved_time_share",
            "starved",
            "1",
            "%",
            Neither,
            "Share of all time kept for an order of which nothing is there.",
        ),
        |t, m| m.state(Starved) / t.window,
    ),
    (
        define(
            "blocked_time_share",
            "blocked",
            "1",
            "%",
            Neither,
            "Share of all time with a part that has no place to go to, or work for which none can be reserved.",
        ),
        |t, m| m.state(Blocked) / t.window,
    ),
    (
        define(
            "waiting_operator_time_share",
            "waiting for operators",
            "1",
            "%",
            Neither,
            "Share of all time with a job whose step waits for somebody.",
        ),
        |t, m| m.state(WaitingOperator) / t.window,
    ),
    (define("down_time_share", "down", "1", "%", Neither, "Share of all time broken down in shift."), |t, m| {
        m.state(Down) / t.window
    }),
    (define("idle_time_share", "idle", "1", "%", Neither, "Share of all time ready without work."), |t, m| {
        m.state(Idle) / t.window
    }),
    (
        define(
            "off_shift_time_share",
            "off shift",
            "1",
            "%",
            Neither,
            "Share of all time out of shift, repairs that go on then included.",
        ),
        |t, m| m.state(OffShift) / t.window,
    ),
    (
        define(
            "waiting_fixture_time_share",
            "waiting for fixtures",
            "1",
            "%",
            Neither,
            "Share of all time with work that lacks a fixture; there in scenarios with fixtures.",
        ),
        |t, m| m.state(WaitingFixture) / t.window,
    ),
    (
        define(
            "waiting_tool_time_share",
            "waiting for tools",
            "1",
            "%",
            Neither,
            "Share of all time with a part for which there is no edge in the crib; there in scenarios with cribs.",
        ),
        |t, m| m.state(WaitingTool) / t.window,
    ),
    (
        define(
            "maintenance_time_share",
            "maintenance",
            "1",
            "%",
            Neither,
            "Share of all time maintained as planned, in shift; there in scenarios with planned maintenance.",
        ),
        |t, m| m.state(Maintenance) / t.window,
    ),
];

/// Figures of states that are rare, and these states.
const RARE: [(&str, MachineState); 3] = [
    ("waiting_fixture_time_share", WaitingFixture),
    ("waiting_tool_time_share", WaitingTool),
    ("maintenance_time_share", Maintenance),
];

/// Figures of each machine of a scenario: states in which its machines never are have none.
pub(super) fn of_machine(scenario: &Scenario) -> impl Iterator<Item = &'static MachineFigure> + use<> {
    let states: Vec<MachineState> = MachineState::of(scenario).collect();
    MACHINE.iter().filter(move |(definition, _)| {
        let rare = RARE.iter().find(|(id, _)| *id == definition.id);
        rare.is_none_or(|(_, state)| states.contains(state))
    })
}
