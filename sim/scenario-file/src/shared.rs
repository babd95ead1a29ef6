//! Fixtures and pallets: which operations need them, and what is not modelled with them.

use super::fault::ScenarioFault;
use super::jobs::Around;
use super::names::{named, reference};
use toolroom_form::{Fault, Section, Walk, nearest};
use toolroom_scenario::{Distribution, Fixture, Hold, MachineType, Operator, Part, Presence, ShiftCalendar, Work};

/// Fixtures; nobody needs them yet.
pub(super) fn fixtures(walk: &mut Walk, root: &Section<'_>) -> Vec<Fixture> {
    let mut fixtures = Vec::new();
    for (name, section) in named(walk, root, "fixture", None) {
        fixtures.push(Fixture { name, count: section.count32("count"), holds: Vec::new() });
    }
    fixtures
}

/// The fixture that operation number `index` of a part needs, whose operations are `names`.
pub(super) fn hold(
    walk: &mut Walk,
    section: &Section<'_>,
    names: &[&str],
    (part, index): (usize, usize),
    fixtures: &mut [Fixture],
) {
    let given = section.given("hold");
    let Some(got) = section.got("fixture") else {
        if given {
            let reason = "an operation says how long it holds a fixture, but names none".to_owned();
            let fix = "add `fixture = \"vice\"`, or take out `hold`".to_owned();
            walk.fault(section.span_of("hold"), ScenarioFault::Arrangement { reason, fix });
        }
        return;
    };
    let known = fixtures.iter().map(|fixture| fixture.name.as_str());
    let Some(fixture) = reference(walk, "fixture", Some(got), known) else { return };
    let word = section.text("hold").unwrap_or("operation");
    let until = if word == "operation" {
        index
    } else if let Some(name) = word.strip_prefix("until ") {
        let name = name.trim();
        let Some(until) = names.iter().position(|known| *known == name) else {
            let fault = Fault::UnknownName {
                kind: "operation",
                name: name.to_owned(),
                nearest: nearest(name, names.iter().copied()).map(str::to_owned),
                known: names.join(", "),
            };
            walk.fault(section.span_of("hold"), fault);
            return;
        };
        if until < index {
            let reason =
                format!("operation \"{}\" holds a fixture until \"{name}\", which comes before it", names[index]);
            let fix = "name a later operation: it is free when that is over".to_owned();
            walk.fault(section.span_of("hold"), ScenarioFault::Arrangement { reason, fix });
            return;
        }
        until
    } else {
        let fault = Fault::WrongType {
            key: "hold".to_owned(),
            read: format!("\"{word}\""),
            expected: "\"operation\", or \"until\" and the name of a later operation".to_owned(),
            example: "\"until wash\"".to_owned(),
        };
        walk.fault(section.span_of("hold"), fault);
        return;
    };
    let own = &mut fixtures[fixture];
    if own.holds.iter().any(|other| other.contains(part, index)) {
        let reason =
            format!("operation \"{}\" needs \"{}\", which its part still holds from before", names[index], own.name);
        let fix = "take out its `fixture`: the one that travels is there".to_owned();
        walk.fault(section.span_of("fixture"), ScenarioFault::Arrangement { reason, fix });
        return;
    }
    own.holds.push(Hold { part, from: index, until });
}

/// Boundaries of a calendar that are looked at for its longest stretch of work (assumption: what a year of shifts does not have,
/// none will).
const BOUNDARIES: usize = 1000;

/// The longest shift of a calendar without its breaks, s.
fn longest(calendar: &ShiftCalendar) -> f64 {
    let (mut longest, mut from, mut at) = (0.0f64, calendar.works_at(0.0).then_some(0.0), 0.0);
    let mut before = 0.0;
    for _ in 0..BOUNDARIES {
        let Some(next) = calendar.next_boundary(at) else {
            return if from.is_some() { f64::INFINITY } else { longest };
        };
        at = next.time;
        if next.starts {
            from = Some(at);
        } else if let Some(from) = from.take() {
            before += at - from;
            longest = longest.max(before);
            before = if next.pauses { before } else { 0.0 };
        }
    }
    longest
}

/// Finds machines that make batches and look at the end of their shift, and operations that fit into no shift.
pub(super) fn check_shift_ends(
    walk: &mut Walk,
    root: &Section<'_>,
    (machines, parts): (&[MachineType], &[Part]),
    calendars: &[ShiftCalendar],
) {
    let looks = |machine: &MachineType| {
        let calendar = machine.calendar.and_then(|index| calendars.get(index));
        calendar.filter(|calendar| calendar.start_only_if_fits)
    };
    for (part, operation) in parts.iter().flat_map(|part| part.operations.iter().map(move |own| (part, own))) {
        let Work::Plain(Distribution::Constant(time)) = operation.work else { continue };
        let never = |machine: &usize| looks(&machines[*machine]).is_some_and(|calendar| longest(calendar) < time);
        if !operation.machines.is_empty() && operation.machines.iter().all(never) {
            let (operation, part) = (&operation.name, &part.name);
            let reason = format!(
                "operation \"{operation}\" of part \"{part}\" is longer than any shift in which it would have to fit"
            );
            let fix = "take out `start_only_if_fits` of its calendar, or give a longer shift".to_owned();
            walk.fault(root.span_of("part"), ScenarioFault::Arrangement { reason, fix });
        }
    }
    if let Some(machine) = machines.iter().find(|machine| machine.batch.is_some() && looks(machine).is_some()) {
        let reason =
            format!("machine \"{}\" makes batches, with a calendar that has `start_only_if_fits`", machine.name);
        let fix = "take out either: together they are not modelled".to_owned();
        walk.fault(root.span_of("machine"), ScenarioFault::Arrangement { reason, fix });
    }
}

/// Finds shifts with a factor where work is none that goes slower or faster, and where nobody looks at it.
pub(super) fn check_paces(
    walk: &mut Walk,
    root: &Section<'_>,
    (machines, parts): (&[MachineType], &[Part]),
    (operators, calendars): (&[Operator], &[ShiftCalendar]),
) {
    let uneven = |calendar: Option<usize>| {
        calendar.and_then(|index| calendars.get(index)).is_some_and(|calendar| !calendar.paces.is_even())
    };
    let mut refuse = |reason: String, fix: &str| {
        walk.fault(root.span_of("calendar"), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    if let Some(operator) = operators.iter().find(|operator| uneven(operator.calendar)) {
        let reason = format!(
            "operator \"{}\" has a calendar with a `factor`, which is one on the speed of machines",
            operator.name
        );
        refuse(reason, "give people a calendar without it, and the machines that are slower one with it");
    }
    for (part, operation) in parts.iter().flat_map(|part| part.operations.iter().map(move |own| (part, own))) {
        let Some(machine) = operation.machines.iter().map(|own| &machines[*own]).find(|own| uneven(own.calendar))
        else {
            continue;
        };
        if operation.worn_tool.is_some() || matches!(operation.attendance.presence, Presence::First(_)) {
            let reason = format!(
                "operation \"{}\" of part \"{}\" wears an edge or is attended to for a while, on \"{}\" with a `factor` on the speed of a shift",
                operation.name, part.name, machine.name
            );
            refuse(reason, "take out the `factor`: together they are not modelled");
        }
    }
}

/// Finds what is not modelled together with fixtures.
pub(super) fn check(walk: &mut Walk, root: &Section<'_>, fixtures: &[Fixture], around: &Around<'_>) {
    let Around { machines, parts, orders, .. } = *around;
    let mut refuse = |key: &str, reason: String, fix: &str| {
        walk.fault(root.span_of(key), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    for fixture in fixtures {
        let name = &fixture.name;
        if fixture.holds.is_empty() {
            refuse("fixture", format!("fixture \"{name}\" is needed by no operation"), "name it in an operation");
        }
        let travels = fixture.holds.iter().any(Hold::travels);
        for hold in &fixture.holds {
            let Some(part) = parts.get(hold.part) else { continue };
            for operation in &part.operations[hold.from..=hold.until] {
                if operation.machines.iter().any(|machine| machines[*machine].batch.is_some()) {
                    let reason = format!("operation \"{}\" needs \"{name}\" on a machine with `batch`", operation.name);
                    refuse(
                        "part",
                        reason,
                        "end its `hold` before, or take out `batch`: together they are not modelled",
                    );
                }
            }
            let own = || orders.iter().filter(|order| order.part == hold.part);
            if travels && let Some(order) = own().find(|order| order.keeps_machines(part)) {
                let reason = format!(
                    "order \"{}\" goes through the shop as several jobs, for which machines are kept, and needs \"{name}\", which travels",
                    order.id
                );
                refuse("order", reason, "give orders of a quantity of 1, or plain work that moves on together");
            }
            let inspected =
                part.operations[hold.from..hold.until].iter().find(|own| !own.inspection.outcomes.is_empty());
            if let Some(operation) = inspected
                && let Some(order) = own().find(|order| order.quantity > 1)
            {
                let reason = format!(
                    "pieces of order \"{}\" may part at \"{}\", while \"{name}\" travels with all of them",
                    order.id, operation.name
                );
                refuse("part", reason, "inspect where `hold` ends, or give orders of a quantity of 1");
            }
        }
        let inside = orders.iter().filter(|order| {
            let at = order.in_process.as_ref().map(|inside| (inside, inside.operation));
            at.is_some_and(|(inside, operation)| {
                let holds = |hold: &Hold| {
                    hold.contains(order.part, operation) && (inside.machine.is_some() || operation > hold.from)
                };
                fixture.holds.iter().any(holds)
            })
        });
        let count = inside.count();
        if count > fixture.count as usize {
            let reason = format!("{count} orders hold \"{name}\" at the start, of which there are {}", fixture.count);
            refuse("wip", reason, "give the fixture a greater `count`, or let fewer orders be where they need it");
        }
    }
}
