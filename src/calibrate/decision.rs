//! `toolroom calibrate --decision`: what to measure next, by what a scenario has to decide.

use crate::failure::Failure;
use std::path::Path;
use toolroom_calibrate::{Advice, Calibration, Clock, Condition, Costs, Process};
use toolroom_scenario::{Course, Operation, Scenario, SpeedChoice, Work};
use toolroom_wear::Cut;

/// The decision of a scenario between two constant speeds: those of its first two policies with one, else the present speed
/// and the one of least cost.
pub fn advise(path: &Path, calibration: &Calibration) -> Result<Advice, Failure> {
    let refuse = |reason: &str, fix: &str| Failure::of_file(path, reason, fix);
    if calibration.measured.clock == Clock::Operations {
        return Err(refuse("lives in operations have no cost by time", "give the records cutting_time"));
    }
    let scenario = toolroom_scenario_file::read(path, &[])?.scenario;
    let process = calibration.measured.process;
    let cuts = |operation: &Operation| match &operation.work {
        Work::Cutting(cuts) => cuts.first().copied(),
        Work::Plain(_) | Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_) | Work::Program(_) => None,
    };
    let of_process = |operation: &&Operation| {
        let tool = operation.tool.map(|tool| &scenario.tools[tool]);
        tool.is_some_and(|tool| tool.process.name() == process.name()) && cuts(operation).is_some()
    };
    let operation = scenario.parts.iter().flat_map(|part| &part.operations).find(of_process).ok_or_else(|| {
        refuse(&format!("no operation of {} passes", process.name()), "name a scenario that cuts with this tool")
    })?;
    let (machine, tool, cut) = match (operation.machines.first(), operation.tool, cuts(operation)) {
        (Some(machine), Some(tool), Some(cut)) => (&scenario.machines[*machine], &scenario.tools[tool], cut),
        _ => return Err(refuse("the operation has no machine", "give it one")),
    };
    if machine.rate <= 0.0 {
        return Err(refuse("the machine costs nothing", "give it a rate, such as rate = \"60 EUR/h\""));
    }
    let costs = Costs { machine: machine.rate * 60.0, change: machine.tool_change_time / 60.0, edge: tool.edge_cost };
    let condition = Condition {
        cut: Cut::nominal(cut.cutting_speed, cut.feed, cut.depth_of_cut),
        width: match process {
            Process::Turning => None,
            Process::Milling => Some(cut.width_of_cut),
        },
        group: 0,
    };
    let speeds = constants(&scenario);
    let present = speeds.first().copied().unwrap_or(cut.cutting_speed);
    let other = speeds.iter().find(|speed| (**speed / present - 1.0).abs() > 1e-3).copied();
    let other = other.unwrap_or_else(|| calibration.cheapest(&costs, &condition, machine.speed_range));
    Ok(calibration.advise(&costs, [condition.at_speed(present), condition.at_speed(other)], machine.speed_range))
}

/// Speeds of policies that state one, m/s.
fn constants(scenario: &Scenario) -> Vec<f64> {
    let stated = scenario.policies.iter().filter_map(|policy| match policy.speed.entry().course {
        Course::Constant(SpeedChoice::Given(speed)) => Some(speed * policy.speed_factor),
        Course::Constant(
            SpeedChoice::BestPath
            | SpeedChoice::BestLife
            | SpeedChoice::BestRate
            | SpeedChoice::BestCost
            | SpeedChoice::Makarov(_),
        )
        | Course::Programmed
        | Course::Schedule
        | Course::Law(_)
        | Course::Price(_)
        | Course::SetIncrement(_) => None,
    });
    stated.collect()
}
