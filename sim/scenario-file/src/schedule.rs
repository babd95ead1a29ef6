//! Schedules: sequences of machines, from sections or from a table.

use super::calendars::moment;
use super::fault::ScenarioFault;
use super::names::reference;
use super::order_columns::Columns;
use super::orders::Around;
use super::table::{self, Table};
use std::collections::BTreeMap;
use toolroom_form::{Section, Span, Walk};
use toolroom_scenario::{InspectedTo, Order, PlannedOperation, Preemption, Schedule};

/// Most operations that are named one by one where a schedule misses them.
const MOST_NAMED: usize = 5;

/// Rows that have been read: machine, position, operation.
type Rows = Vec<(usize, u64, PlannedOperation)>;

/// The schedule of a file, where it has one.
pub(super) fn schedule(
    walk: &mut Walk,
    root: &Section<'_>,
    around: &Around<'_>,
    (orders, sources): (&[Order], usize),
    preemption: Preemption,
) -> Option<Schedule> {
    let mut rows: Rows = Vec::new();
    let mut seen: BTreeMap<(usize, usize), ()> = BTreeMap::new();
    let mut place = root.span_of("schedule");
    let mut given = root.given("schedule");
    for section in walk.sections(root, "schedule", None) {
        row(walk, &section, around, orders, &mut rows, &mut seen);
    }
    if let Some(tables) = around.tables
        && let Some(file) = tables.text("schedule")
        && let Some(text) = table::text(walk, tables, "schedule", file)
    {
        given = true;
        place = tables.span_of("schedule");
        let columns = &Columns::own();
        let table = Table { file, text: &text, place: place.clone(), kind: "schedule", mapping: columns };
        table.rows(walk, |walk, section, _| row(walk, section, around, orders, &mut rows, &mut seen));
    }
    if !given {
        return None;
    }
    let noted = walk.problems.len();
    check(walk, &place, around, (orders, sources), preemption, &seen);
    let mut schedule = Schedule { machines: vec![Vec::new(); around.machines.len()] };
    rows.sort_by_key(|(machine, position, _)| (*machine, *position)); // stable: rows without a position keep their order
    for (machine, _, planned) in rows {
        // What is done, or in a machine, when the run begins, is not begun in it.
        let begun = orders[planned.order].in_process.as_ref().is_some_and(|inside| {
            planned.operation < inside.operation || planned.operation == inside.operation && inside.machine.is_some()
        });
        if !begun {
            schedule.machines[machine].push(planned);
        }
    }
    if walk.problems.len() == noted {
        let circle = schedule.circle();
        if !circle.is_empty() {
            let named = |(machine, planned): &(usize, PlannedOperation)| {
                let order = &orders[planned.order];
                let operation = &around.parts[order.part].operations[planned.operation].name;
                format!("{operation} of {} on {}", order.id, around.machines[*machine].name)
            };
            let words: Vec<String> = circle.iter().map(named).collect();
            walk.fault(place, ScenarioFault::ScheduleCycle { circle: words.join(", then ") });
        }
    }
    Some(schedule)
}

fn row(
    walk: &mut Walk,
    section: &Section<'_>,
    around: &Around<'_>,
    orders: &[Order],
    rows: &mut Rows,
    seen: &mut BTreeMap<(usize, usize), ()>,
) {
    let ids = orders.iter().map(|order| order.id.as_str());
    let Some(order) = reference(walk, "order", section.got("order"), ids) else { return };
    let Some(part) = around.parts.get(orders[order].part) else { return };
    let names = part.operations.iter().map(|operation| operation.name.as_str());
    let Some(operation) = reference(walk, "operation", section.got("operation"), names) else { return };
    let known = around.names.each_machine.iter().map(String::as_str);
    let Some(machine) = reference(walk, "machine", section.got("machine"), known) else { return };
    let mut refuse = |key: &str, reason: String, fix: String| {
        walk.fault(section.span_of(key), ScenarioFault::Arrangement { reason, fix });
    };
    let (id, planned) = (&orders[order].id, &part.operations[operation]);
    if !planned.machines.contains(&machine) {
        let may: Vec<&str> = planned.machines.iter().map(|each| around.machines[*each].name.as_str()).collect();
        let reason =
            format!("machine \"{}\" does not do operation \"{}\"", around.machines[machine].name, planned.name);
        refuse("machine", reason, format!("its machines: {}", may.join(", ")));
    }
    if seen.insert((order, operation), ()).is_some() {
        let reason = format!("operation \"{}\" of order \"{id}\" is planned twice", planned.name);
        refuse("order", reason, "take out one of the rows".to_owned());
        return;
    }
    // Rows without a position follow in the order of the table.
    let position = section.count("position").unwrap_or(rows.len() as u64);
    let same = rows.iter().find(|(other, own, _)| (*other, *own) == (machine, position) && section.given("position"));
    if let Some((.., other)) = same {
        let first = &around.parts[orders[other.order].part].operations[other.operation].name;
        let reason = format!(
            "position {position} of machine \"{}\" stands twice: for operation \"{first}\" of order \"{}\" and \"{}\" of \"{id}\"",
            around.machines[machine].name, orders[other.order].id, planned.name
        );
        refuse("position", reason, "number the operations of a machine in their order, each once".to_owned());
    }
    let not_before = moment(walk, section, "not_before", around.start).unwrap_or(0.0);
    let start = moment(walk, section, "start", around.start);
    rows.push((machine, position, PlannedOperation { order, operation, not_before, start }));
}

/// Finds what is not modelled together with a schedule, and operations that it misses.
fn check(
    walk: &mut Walk,
    place: &Span,
    around: &Around<'_>,
    (orders, sources): (&[Order], usize),
    preemption: Preemption,
    seen: &BTreeMap<(usize, usize), ()>,
) {
    let mut refuse = |reason: String, fix: &str| {
        walk.fault(place.clone(), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    if sources > 0 {
        refuse("jobs of [[arrivals]] have no place in a schedule".to_owned(), "give orders in their place");
    }
    if preemption != Preemption::None {
        refuse("a schedule leaves nothing to interrupt".to_owned(), "take out `preempt`, or the schedule");
    }
    let mut missing: Vec<String> = Vec::new();
    for (index, order) in orders.iter().enumerate() {
        let Some(part) = around.parts.get(order.part) else { continue };
        if order.split.is_some_and(|most| most > 1) {
            let reason = format!("order \"{}\" is split over machines, of which a schedule names one", order.id);
            refuse(reason, "take out `split`, or make orders of its shares");
        }
        if order.setup_ahead {
            let reason = format!("order \"{}\" sets up machines ahead, out of their sequence", order.id);
            refuse(reason, "take out `setup_ahead`, or the schedule");
        }
        if part.random_routing {
            refuse(
                format!("part \"{}\" has no fixed routing, whose operations a schedule could order", part.name),
                "take out `routing = \"random\"`, or the schedule",
            );
        }
        let from =
            order.in_process.as_ref().map_or(0, |inside| inside.operation + usize::from(inside.machine.is_some()));
        for (operation, step) in part.operations.iter().enumerate().skip(from) {
            if !seen.contains_key(&(index, operation)) {
                missing.push(format!("{} of {}", step.name, order.id));
            }
            if let Some(machine) =
                step.machines.iter().map(|&each| &around.machines[each]).find(|each| each.batch.is_some())
            {
                refuse(
                    format!("machine \"{}\" makes batches, which a schedule does not say", machine.name),
                    "take out `batch`, or the schedule",
                );
            }
            let back = |outcome: &toolroom_scenario::InspectionOutcome| matches!(outcome.to, InspectedTo::Operation(_));
            if step.inspection.outcomes.iter().any(back) {
                refuse(
                    format!("operation \"{}\" sends parts back, which a schedule does not foresee", step.name),
                    "take out `go` of its outcomes, or the schedule",
                );
            }
        }
    }
    if !missing.is_empty() {
        let more = missing.len().saturating_sub(MOST_NAMED);
        let named = missing[..missing.len().min(MOST_NAMED)].join(", ");
        let more = if more > 0 { format!(", and {more} more") } else { String::new() };
        refuse(format!("the schedule misses {named}{more}"), "give every operation of every order a row");
    }
}
