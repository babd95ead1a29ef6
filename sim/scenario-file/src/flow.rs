//! Buffers, and what can never work with them.

use super::fault::ScenarioFault;
use super::names::{Names, machine_indices, named};
use super::orders::Places;
use super::rules::Dispatch;
use toolroom_form::{Fault, Section, Walk};
use toolroom_scenario::{BatchUnit, Blocking, Buffer, Deadlock, MachineType, Operation, Order, Part};

/// Adds the buffers that several machines share to those of single sections.
pub(super) fn shared(
    walk: &mut Walk,
    root: &Section<'_>,
    names: &Names,
    machines: &mut [MachineType],
    mut buffers: Vec<Buffer>,
) -> Vec<Buffer> {
    for (name, section) in named(walk, root, "buffer", None) {
        let members = machine_indices(walk, &section, "before", names);
        for &machine in &members {
            let kind = &mut machines[machine];
            if let Some(other) = kind.input_buffer.replace(buffers.len()) {
                let fault = Fault::Contradiction {
                    first: "buffer",
                    first_value: name.clone(),
                    second: "buffer",
                    second_value: format!("{} before {}", buffers[other].name, kind.name),
                    rule: "a machine takes its work from one buffer",
                };
                walk.fault(section.span_of("before"), fault);
            }
        }
        let unit = section.chosen("unit", BatchUnit::from_word).unwrap_or(BatchUnit::Lots);
        buffers.push(Buffer { name, places: section.count32("places"), unit, machines: members });
    }
    buffers
}

/// Finds what contradicts itself and what could never move.
pub(super) fn check(
    walk: &mut Walk,
    root: &Section<'_>,
    dispatch: &Dispatch,
    machines: &[MachineType],
    buffers: &[Buffer],
    (parts, orders, places): (&[Part], &[Order], &Places),
) {
    let before = dispatch.blocking == Blocking::BeforeService;
    let word = Blocking::BeforeService.word();
    let mut refuse = |first: &'static str, first_value: String, rule: &'static str| {
        let second_value = word.to_owned();
        let fault = Fault::Contradiction { first, first_value, second: "blocking", second_value, rule };
        walk.fault(root.span_of("dispatch"), fault);
    };
    if before && dispatch.deadlock == Deadlock::Swap {
        let rule = "parts change places only where they are done, with blocking after service";
        refuse("deadlock", Deadlock::Swap.word().to_owned(), rule);
    }
    if before && let Some(machine) = machines.iter().find(|machine| machine.output_buffer.is_some()) {
        let rule = "a machine that begins only when a place is reserved needs none behind it";
        refuse("output_buffer", machine.name.clone(), rule);
    }
    if before && let Some(buffer) = buffers.iter().find(|buffer| buffer.unit == BatchUnit::Pieces) {
        let rule = "a place that is reserved is one for a job, not for its pieces";
        refuse("unit", format!("pieces, of buffer {}", buffer.name), rule);
    }
    // All places for an operation, where they are limited, one buffer.
    let only = |part: &Part, operation: usize| {
        let mut inputs = part.operations[operation].machines.iter().map(|machine| machines[*machine].input_buffer);
        let first = inputs.next()??;
        inputs.all(|input| input == Some(first)).then_some(first)
    };
    let place = root.span_of("part");
    for part in parts.iter().filter(|_| before) {
        for (index, pair) in part.operations.windows(2).enumerate() {
            let Some(buffer) = only(part, index).filter(|first| only(part, index + 1) == Some(*first)) else {
                continue;
            };
            if buffers[buffer].places as usize + buffers[buffer].machines.len() < 2 {
                let fault = ScenarioFault::BufferLoop {
                    part: part.name.clone(),
                    operations: [pair[0].name.clone(), pair[1].name.clone()],
                    buffer: buffers[buffer].name.clone(),
                };
                walk.fault(place.clone(), fault);
            }
        }
    }
    for (index, order) in orders.iter().enumerate() {
        // What moves together has to fit into every buffer on its way that counts pieces.
        let Some(part) = parts.get(order.part) else { continue };
        let (size, machines_of) = (order.job_size(part), |own: &Operation| own.machines.clone());
        let inputs =
            part.operations.iter().skip(1).flat_map(machines_of).filter_map(|each| machines[each].input_buffer);
        let small = |buffer: &usize| buffers[*buffer].unit == BatchUnit::Pieces && buffers[*buffer].places < size;
        if let Some(buffer) = inputs.map(|buffer| buffer.to_owned()).find(|buffer| small(buffer)) {
            let reason = format!(
                "{size} pieces of order \"{}\" move together, and buffer \"{}\" has {} places for pieces",
                order.id, buffers[buffer].name, buffers[buffer].places
            );
            let fix = "give the buffer more places, or the order a smaller quantity".to_owned();
            places.fault(walk, index, ScenarioFault::Arrangement { reason, fix });
        }
    }
    for (index, order) in orders.iter().enumerate() {
        let Some(part) = parts.get(order.part).filter(|part| order.keeps_machines(part)) else { continue };
        let visited = part.operations.iter().flat_map(|operation| &operation.machines);
        let limited =
            visited.filter_map(|machine| machines[*machine].input_buffer.or(machines[*machine].output_buffer));
        if let Some(buffer) = limited.min() {
            let fault = ScenarioFault::BufferLot { order: order.id.clone(), buffer: buffers[buffer].name.clone() };
            places.fault(walk, index, fault);
        }
    }
}
