//! What the machines did: Gantt charts, state times and OEE.

use super::{Source, replications};
use crate::figure::plain;
use crate::planner::ticks;
use crate::trace::{last_machines, machine_of};
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Colour, Gantt, Hatch, Marker, StackedBars, Style, Table};
use toolroom_process::ProcessEvent;
use toolroom_process::unit::convert;
use toolroom_scenario::{MachineType, Scenario};
use toolroom_shop::runlog::{LogEvent, MachineState};

/// Words and style of each state, in the order of [`MachineState::ALL`]. What fills most of a shift
/// is plain, so that the rest stands out.
fn style(state: MachineState) -> (&'static str, Style) {
    match state {
        MachineState::Cutting => ("cutting", Style::nth(2).hatch(Hatch::Solid)),
        MachineState::Working => ("plain work", Style::nth(2).hatch(Hatch::Vertical)),
        MachineState::Handling => ("loading, unloading", Style::nth(5).hatch(Hatch::Horizontal)),
        MachineState::Setup => ("setup", Style::nth(3)),
        MachineState::ToolChange => ("tool change", Style::nth(4)),
        MachineState::Dressing => ("dressing", Style::nth(0).hatch(Hatch::Backslash)),
        MachineState::Starved => ("kept for an order", Style::nth(6).hatch(Hatch::Horizontal)),
        MachineState::Blocked => ("blocked", Style::nth(4).hatch(Hatch::Slash)),
        MachineState::WaitingOperator => {
            ("waiting for operators", Style::nth(0).colour(Colour::Yellow).hatch(Hatch::Solid))
        }
        MachineState::WaitingFixture => ("waiting for fixtures", Style::nth(3).hatch(Hatch::Slash)),
        MachineState::WaitingTool => ("waiting for tools", Style::nth(4).hatch(Hatch::Backslash)),
        MachineState::Maintenance => ("maintenance", Style::nth(0)),
        MachineState::Down => ("down", Style::nth(1).hatch(Hatch::Slash)),
        MachineState::Idle => ("idle", Style::IDLE),
        MachineState::OffShift => ("off shift", Style::IDLE.colour(Colour::Ink).hatch(Hatch::Backslash)),
    }
}

/// Marks and the events that they stand for.
const MARKS: [(&str, &[LogEvent], Marker); 4] = [
    ("chatter sets in", &[LogEvent::ChatterOnset], Marker::Plus),
    ("tool change", &[LogEvent::ToolChange, LogEvent::Dressing], Marker::Triangle),
    (
        "edge lost",
        &[LogEvent::Cut(ProcessEvent::Chipping), LogEvent::Cut(ProcessEvent::ThermalCollapse)],
        Marker::Cross,
    ),
    ("part scrapped", &[LogEvent::Scrap], Marker::Diamond),
];

/// Longest stretch of dates that a Gantt chart of orders shows, s: a week.
const WEEK: f64 = 7.0 * 86_400.0;

/// The first instant from `from` on at which a machine works; `from` where none does before the horizon.
fn first_work(scenario: &Scenario, from: f64) -> f64 {
    let of_machine = |machine: &MachineType| {
        let Some(calendar) = machine.calendar.map(|index| &scenario.calendars[index]) else { return Some(from) };
        let mut time = from;
        while !calendar.works_at(time) {
            time = calendar.next_boundary(time).filter(|next| next.time < scenario.horizon)?.time;
        }
        Some(time)
    };
    scenario.machines.iter().filter_map(of_machine).reduce(f64::min).unwrap_or(from)
}

/// One shift of the first replication, the first one that counts; of a scenario with dates the first week.
fn gantt(source: &Source<'_>, position: usize) -> Option<Figure> {
    let log = source.log(position)?;
    let scenario = source.scenario;
    let from = first_work(scenario, scenario.warm_up);
    let dated = scenario.start.filter(|_| !scenario.orders.is_empty());
    let stretch = if dated.is_some() { WEEK } else { scenario.shift_length };
    let to = (from + stretch).min(log.horizon);
    let hours = |seconds: f64| convert(seconds, "s", "h");
    let name = source.name(position);
    let machines = scenario.machines.iter().map(|machine| machine.name.as_str());
    let time = match dated {
        None => Axis::linear("Time", "h"),
        Some(start) => {
            let ticks = ticks(start, from, to).into_iter().map(|(time, date)| (hours(time), date));
            Axis::linear("Midnight of the day", "").ticks(ticks)
        }
    };
    let time = time.range(hours(from), hours(to));
    let what = if dated.is_some() { "First week" } else { "One shift" };
    let mut chart = Gantt::new(format!("{what}: {name}"), time, machines)
        .describe(format!("State of every machine over time under {name}, with tool changes and failures."));
    // Idle time is the paper itself.
    let drawn: Vec<MachineState> = MachineState::ALL
        .into_iter()
        .filter(|&state| state != MachineState::Idle && log.states.iter().any(|row| row.state == state))
        .collect();
    for &state in &drawn {
        let (label, style) = style(state);
        chart = chart.kind(label, style);
    }
    let marks: Vec<_> =
        MARKS.into_iter().filter(|(_, events, _)| log.events.iter().any(|row| events.contains(&row.event))).collect();
    for (label, _, marker) in &marks {
        chart = chart.mark_kind(*label, Style::nth(0).colour(Colour::Ink).marker(*marker));
    }
    for row in log.states.iter().filter(|row| row.end > from && row.start < to) {
        let Some(kind) = drawn.iter().position(|&state| state == row.state) else { continue };
        let label = match (row.state, row.job) {
            (MachineState::Cutting | MachineState::Working | MachineState::Setup, Some(job)) => {
                let order = log.jobs[job as usize].order.map(|order| scenario.orders[order as usize].id.clone());
                match order {
                    Some(id) => format!("order {id}"),
                    None if row.state == MachineState::Cutting => format!("job {job}"),
                    None => String::new(),
                }
            }
            _ => String::new(),
        };
        chart = chart.interval(row.machine as usize, kind, hours(row.start.max(from)), hours(row.end.min(to)), label);
    }
    let last_machines = last_machines(log);
    for row in log.events.iter().filter(|row| row.time >= from && row.time <= to) {
        let kind = marks.iter().position(|(_, events, _)| events.contains(&row.event));
        if let (Some(kind), Some(machine)) = (kind, machine_of(row, &last_machines)) {
            chart = chart.mark(machine as usize, kind, hours(row.time));
        }
    }
    let stretch = if dated.is_some() { "the first week" } else { "the first shift that counts" };
    let caption = format!("{name}, first replication, {stretch}. Empty stretches are idle.");
    Some(Figure::new(&chart, caption).data_in("the states table"))
}

pub(super) fn section(source: &Source<'_>) -> Section {
    let section = Section::new("What the machines did")
        .paragraph("schedule.html beside this page shows every machine over the whole run, to zoom and to search.")
        .paragraph(
        "OEE = availability · effectiveness · quality ratio by ISO 22400-2: production time (cutting and handling) \
         over planned busy time, the working time of the calendar and overtime; programmed time of the operations over \
         production time; programmed time of the good over that of all operations completed. An operation over an end \
         of the window counts by its part in it, a repair out of shift nowhere. The programmed speeds are the yardstick under every policy, so the effectiveness of a \
         faster one is above 1.",
    );
    let mut table =
        Table::new(["policy", "machine", "OEE", "availability", "effectiveness", "quality ratio", "utilisation, %"]);
    let schedules = source.pictured().into_iter();
    let schedules = schedules.filter_map(|position| Some((source.name(position).to_owned(), gantt(source, position)?)));
    let mut shares_of_time = Vec::new();
    for position in source.pictured() {
        let policy = &source.comparison.policies[position];
        let mean = |machine: usize, id: &str| {
            source.study.machine_index(machine, id).map_or(f64::NAN, |index| policy.kpis[index].mean)
        };
        let mut chart = StackedBars::new(
            format!("State times: {}", policy.name),
            Axis::linear("Share of all time", "%").range(0.0, 100.0),
        )
        .describe(format!("Mean share of time of each machine in each state under {}.", policy.name));
        for state in MachineState::of(source.scenario) {
            let (label, style) = style(state);
            chart = chart.kind(label, style);
        }
        for (machine, named) in source.scenario.machines.iter().enumerate() {
            let share = |state: MachineState| 100.0 * mean(machine, &format!("{}_time_share", state.name()));
            let shares: Vec<f64> = MachineState::of(source.scenario).map(share).collect();
            chart = chart.row(named.name.as_str(), shares);
            table.push([
                policy.name.as_str().into(),
                named.name.as_str().into(),
                plain(mean(machine, "oee"), 3).into(),
                plain(mean(machine, "availability"), 3).into(),
                plain(mean(machine, "effectiveness"), 3).into(),
                plain(mean(machine, "quality_ratio"), 3).into(),
                plain(100.0 * mean(machine, "utilisation"), 1).into(),
            ]);
        }
        let caption = format!("{}, mean over {}.", policy.name, replications(source.study.replications));
        shares_of_time.push((policy.name.clone(), Figure::new(&chart, caption).data_in("kpi.csv")));
    }
    section.choice(schedules).choice(shares_of_time).table("OEE of every machine", table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_told_apart() {
        let styles = MachineState::ALL.map(|state| (style(state).1.colour, style(state).1.hatch));
        for (i, style) in styles.iter().enumerate() {
            assert!(!styles[..i].contains(style), "{:?} looks like another state", MachineState::ALL[i]);
        }
    }
}
