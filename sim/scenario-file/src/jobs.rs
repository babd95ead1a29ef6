//! What the flow of jobs asks for beside machines and work: batches, inspections, components, priorities.

use super::fault::ScenarioFault;
use super::names::{Names, reference};
use toolroom_form::{Fault, Section, Walk, nearest};
use toolroom_scenario::{
    Arrival, Batch, BatchFamily, BatchUnit, Blocking, Buffer, Component, DispatchRule, DrawUnit, InspectedTo,
    InspectedUnit, Inspection, InspectionOutcome, MachineType, Operation, Order, OutsideSample, Part, Preemption,
    Sample, Stock, WorkPer,
};

/// The key `batch` of a machine.
pub(super) fn batch(walk: &mut Walk, machine: &Section<'_>) -> Option<Batch> {
    let section = walk.table(machine, "batch")?;
    let max = section.count32("max");
    let min = section.count("min").and_then(|min| u32::try_from(min).ok()).unwrap_or(1);
    if min > max {
        let fault = Fault::Contradiction {
            first: "min",
            first_value: min.to_string(),
            second: "max",
            second_value: max.to_string(),
            rule: "a batch starts with no more than fit in",
        };
        walk.fault(section.span_of("min"), fault);
    }
    Some(Batch {
        max,
        min,
        time_out: section.si("time_out"),
        same: section.chosen("same", BatchFamily::from_word).unwrap_or(BatchFamily::SetupGroup),
        by: section.chosen("by", BatchUnit::from_word).unwrap_or(BatchUnit::Pieces),
    })
}

/// What an operation says of its flow, on machines that are known.
pub(super) fn flow(walk: &mut Walk, section: &Section<'_>, operation: &mut Operation, machines: &[MachineType]) {
    let per = section.chosen("work_per", WorkPer::from_word).unwrap_or_default();
    let batched = |machine: &&usize| machines[**machine].batch.is_some();
    let together = operation.machines.iter().filter(batched).count();
    if together != 0 && together != operation.machines.len() {
        let reason = format!("operation \"{}\" may be done alone and in batches", operation.name);
        let fix = "list only machines with `batch`, or only machines without".to_owned();
        walk.fault(section.span_of("machines"), ScenarioFault::Arrangement { reason, fix });
    }
    if per == WorkPer::Batch && together == 0 {
        let reason =
            format!("operation \"{}\" has a time per batch, but no machine that makes batches", operation.name);
        let fix = "give its machines `batch = { max = 6 }`, or use work_per = \"lot\"".to_owned();
        walk.fault(section.span_of("work_per"), ScenarioFault::Arrangement { reason, fix });
    }
    operation.work_per = per;
    operation.draw = section.chosen("draw", DrawUnit::from_word).unwrap_or_default();
    if operation.draw == DrawUnit::Part && per != WorkPer::Part {
        let reason = format!(
            "operation \"{}\" takes one time for all of its pieces, which are drawn one by one",
            operation.name
        );
        let fix = "take out `draw = \"part\"`, or `work_per`".to_owned();
        walk.fault(section.span_of("draw"), ScenarioFault::Arrangement { reason, fix });
    }
    operation.preemptible = section.flag("preemptible").unwrap_or(true);
    operation.assembles = section.flag("assemble").unwrap_or(false);
}

/// The inspection after the operation number `index` of a part whose operations are `names`.
pub(super) fn inspection(walk: &mut Walk, section: &Section<'_>, names: &[&str], index: usize) -> Inspection {
    let mut outcomes = Vec::new();
    for outcome in walk.sections(section, "outcomes", None) {
        let (go, scrap) = (outcome.text("go"), outcome.flag("scrap").unwrap_or(false));
        let to = match go {
            Some(_) => InspectedTo::Operation(back_to(walk, &outcome, names, index)),
            None => InspectedTo::Scrap,
        };
        if go.is_some() == scrap {
            let reason = "an outcome either goes back to an operation or is scrapped".to_owned();
            let fix = "write `go = \"turn\"` or `scrap = true`".to_owned();
            walk.fault(outcome.span.clone(), ScenarioFault::Arrangement { reason, fix });
        }
        outcomes.push(InspectionOutcome { share: outcome.required("share"), to });
    }
    let sum: f64 = outcomes.iter().map(|outcome| outcome.share).sum();
    if sum > 1.0 + 1e-12 {
        let reason = format!("the shares of the outcomes of \"{}\" add up to {sum}", names[index]);
        let fix = "what is left of 1 goes on to the next operation".to_owned();
        walk.fault(section.span_of("outcomes"), ScenarioFault::Arrangement { reason, fix });
    }
    let sample = walk.table(section, "sample").map(|sample| Sample {
        every: sample.count32("every"),
        others: sample.chosen("others", OutsideSample::from_word).unwrap_or_default(),
    });
    if sample.is_some_and(|sample| sample.others == OutsideSample::Worked) && outcomes.is_empty() {
        let reason = format!("operation \"{}\" judges a sample of its parts, but has no outcomes", names[index]);
        let fix = "add `outcomes`, or `others = \"pass\"` where only the sample is worked on".to_owned();
        walk.fault(section.span_of("sample"), ScenarioFault::Arrangement { reason, fix });
    }
    let on_reject = walk.table(section, "on_reject").map(|rejected| back_to(walk, &rejected, names, index));
    let inspection = Inspection {
        outcomes,
        sample,
        on_reject,
        per: section.chosen("outcomes_per", InspectedUnit::from_word).unwrap_or_default(),
        rework_max: section.count("rework_max").and_then(|most| u32::try_from(most).ok()),
    };
    if section.given("rework_max") && !inspection.sends_back() {
        let reason = format!("operation \"{}\" has `rework_max`, but sends no parts back", names[index]);
        let fix = "add an outcome with `go`, or `on_reject`, or take out `rework_max`".to_owned();
        walk.fault(section.span_of("rework_max"), ScenarioFault::Arrangement { reason, fix });
    }
    inspection
}

/// The operation under the key `go`, to which parts go back after the operation number `index`.
fn back_to(walk: &mut Walk, section: &Section<'_>, names: &[&str], index: usize) -> usize {
    let Some(name) = section.text("go") else { return 0 };
    let found = names.iter().position(|known| *known == name);
    if found.is_none() {
        let fault = Fault::UnknownName {
            kind: "operation",
            name: name.to_owned(),
            nearest: nearest(name, names.iter().copied()).map(str::to_owned),
            known: names.join(", "),
        };
        walk.fault(section.span_of("go"), fault);
    } else if found.is_some_and(|found| found > index) {
        let reason = format!("an inspection after \"{}\" cannot send parts on to \"{name}\"", names[index]);
        let fix = "name this operation or an earlier one".to_owned();
        walk.fault(section.span_of("go"), ScenarioFault::Arrangement { reason, fix });
    }
    found.unwrap_or(0)
}

/// The components of every part, when all parts are known.
pub(super) fn components(walk: &mut Walk, sections: &[Section<'_>], names: &Names, parts: &mut [Part]) {
    for (section, part) in sections.iter().zip(parts.iter_mut()) {
        for component in walk.sections(section, "components", None) {
            let known = names.parts.iter().map(String::as_str);
            let Some(part_index) = reference(walk, "part", component.got("part"), known) else { continue };
            let quantity = component.count32("quantity");
            match part.components.iter_mut().find(|known| known.part == part_index) {
                Some(known) => known.quantity = known.quantity.saturating_add(quantity),
                None => part.components.push(Component { part: part_index, quantity }),
            }
        }
        let assembling = part.operations.iter().filter(|operation| operation.assembles).count();
        let (reason, fix) = match (part.components.is_empty(), assembling) {
            (true, 0) | (false, 1) => continue,
            (true, _) => ("has an operation that assembles, but no components", "add `components`"),
            (false, 0) => {
                ("has components, but no operation that takes them", "write `assemble = true` in one of its operations")
            }
            (false, _) => ("takes its components in several operations", "write `assemble = true` in one of them only"),
        };
        let reason = format!("part \"{}\" {reason}", part.name);
        walk.fault(section.span_of("name"), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    }
    // A part that goes into itself, over however many others.
    for start in 0..parts.len() {
        let mut inside: Vec<usize> = parts[start].components.iter().map(|component| component.part).collect();
        let mut next = 0;
        while let Some(&part) = inside.get(next) {
            next += 1;
            let further = parts[part].components.iter().map(|component| component.part);
            let new: Vec<usize> = further.filter(|part| !inside.contains(part)).collect();
            inside.extend(new);
        }
        if inside.contains(&start) {
            let reason = format!("part \"{}\" goes into itself", parts[start].name);
            let fix = "take it out of its own components, or out of theirs".to_owned();
            let place = sections.get(start).map_or(0..0, |section| section.span_of("components"));
            walk.fault(place, ScenarioFault::Arrangement { reason, fix });
        }
    }
}

/// What the rules of jobs are checked against.
pub(super) struct Around<'a> {
    pub machines: &'a [MachineType],
    pub buffers: &'a [Buffer],
    pub parts: &'a [Part],
    pub arrivals: &'a [Arrival],
    pub orders: &'a [Order],
    pub stocks: &'a [Stock],
    pub blocking: Blocking,
    pub rules: &'a [DispatchRule],
    pub preemption: Preemption,
}

/// Finds what these keys ask for and could never work, or is not modelled together.
pub(super) fn check(walk: &mut Walk, root: &Section<'_>, around: &Around<'_>) {
    let Around { machines, buffers, parts, arrivals, orders, stocks, blocking, rules, preemption } = *around;
    let mut refuse = |key: &str, reason: String, fix: &str| {
        walk.fault(root.span_of(key), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    if let (Some(machine), false) = (machines.iter().find(|machine| machine.batch.is_some()), buffers.is_empty()) {
        let reason = format!("machine \"{}\" makes batches in a shop with limited buffers", machine.name);
        refuse("machine", reason, "take out the limits of the buffers, or `batch`: together they are not modelled");
    }
    for part in parts {
        for operation in &part.operations {
            let batch = operation.machines.iter().filter_map(|machine| machines[*machine].batch).next();
            let limited = operation.machines.iter().any(|machine| machines[*machine].input_buffer.is_some());
            if operation.assembles && (batch.is_some() || limited) {
                let reason = format!(
                    "operation \"{}\" of part \"{}\" assembles on a machine with `batch` or a limited buffer",
                    operation.name, part.name
                );
                refuse("part", reason, "assemble on a machine without them: together they are not modelled");
            }
            let back = operation.inspection.sends_back();
            if back && blocking == Blocking::BeforeService {
                let reason = format!("operation \"{}\" sends parts back with blocking before service", operation.name);
                refuse(
                    "part",
                    reason,
                    "use blocking = \"after_service\": the place after an inspection is not known before",
                );
            }
        }
        for component in &part.components {
            let comes = arrivals.iter().any(|arrival| arrival.brings(component.part))
                || orders.iter().any(|order| order.part == component.part)
                || stocks.iter().any(|stock| stock.part == component.part);
            if !comes && let Some(needed) = parts.get(component.part) {
                let reason = format!("part \"{}\" needs \"{}\", which nobody makes", part.name, needed.name);
                refuse("part", reason, "add [[arrivals]] or an order of it, or a [[stock]] with `reorder`");
            }
        }
    }
    if blocking == Blocking::BeforeService
        && let Some(order) = orders.iter().find(|order| order.in_process.is_some())
    {
        let reason = format!("order \"{}\" is in process at the start with blocking before service", order.id);
        refuse("dispatch", reason, "use blocking = \"after_service\": which places are reserved is not known");
    }
    for order in orders {
        let Some(part) = parts.get(order.part) else { continue };
        lot_rules(order, part, &mut refuse);
        let size = order.job_size(part);
        let visited =
            part.operations.iter().flat_map(|operation| &operation.machines).map(|machine| &machines[*machine]);
        let full = |machine: &&MachineType| {
            machine.batch.is_some_and(|batch| batch.by == BatchUnit::Pieces && batch.max < size)
        };
        if let Some(machine) = visited.into_iter().find(full) {
            let reason = format!(
                "{size} pieces of order \"{}\" move together, but do not fit into \"{}\"",
                order.id, machine.name
            );
            refuse("order", reason, "give the order a `transfer` that fits, or count the batch by = \"lots\"");
        }
    }
    if preemption != Preemption::None {
        let first = |rules: &[DispatchRule]| rules.first() == Some(&DispatchRule::Priority);
        let mut machine_rules = machines.iter().filter_map(|machine| machine.rules.as_deref());
        if !first(rules) || machine_rules.any(|rules| !first(rules)) {
            let reason =
                "jobs of better priority interrupt others, but the queues do not go by priority first".to_owned();
            refuse("dispatch", reason, "write rule = [\"priority\", \"fifo\"], for single machines too");
        }
        if !buffers.is_empty() {
            let reason =
                "jobs interrupt others in a shop with limited buffers, where they may find no place".to_owned();
            refuse(
                "dispatch",
                reason,
                "take out `preempt`, or the limits of the buffers: together they are not modelled",
            );
        }
    }
}

/// Finds what the lot rules of an order ask for and is not modelled.
fn lot_rules(order: &Order, part: &Part, refuse: &mut dyn FnMut(&str, String, &str)) {
    let back = |own: &&Operation| own.inspection.sends_back();
    if order.setup_ahead
        && let Some(operation) = part.operations.iter().find(back)
    {
        let reason =
            format!("order \"{}\" has machines set up ahead, but \"{}\" sends parts back", order.id, operation.name);
        refuse(
            "order",
            reason,
            "take out `setup_ahead`: a part may come back to a machine that is kept for what comes after it",
        );
    }
    let once = |own: &&Operation| own.work_per == WorkPer::Lot;
    if order.split.is_some_and(|most| most > 1)
        && let Some(operation) = part.operations.iter().find(once)
    {
        let reason =
            format!("order \"{}\" is split, but \"{}\" takes one time for all of it", order.id, operation.name);
        refuse("order", reason, "take out `split`, or give the work per part");
    }
}
