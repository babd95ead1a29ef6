//! Components in stock, what is made for an order, what replaces lost pieces, and sources of several parts.

use super::fault::ScenarioFault;
use super::jobs::Around;
use super::names::{Names, reference};
use std::sync::Arc;
use toolroom_form::{Fault, Section, Value, Walk, nearest};
use toolroom_scenario::{
    Arrival, BatchUnit, Control, Distribution, Empirical, Order, Part, Pegging, Reorder, Replenish, Stock, Work,
};

/// The keys `replenish` and `replenish_priority` of a part.
pub(super) fn replenish(walk: &mut Walk, section: &Section<'_>) -> Replenish {
    let priority = section.si("replenish_priority");
    let read = match section.text("replenish") {
        Some("new_order") => Replenish::NewOrder { priority: priority.unwrap_or(0.0) as i32 },
        Some(_) => Replenish::Nothing,
        None => walk
            .table(section, "replenish")
            .map_or(Replenish::Nothing, |table| Replenish::Overrun(table.required("overrun"))),
    };
    if priority.is_some() && !matches!(read, Replenish::NewOrder { .. }) {
        let case = "a part whose lost pieces do not begin anew".to_owned();
        let applicable = "replenish = \"new_order\"".to_owned();
        walk.fault(
            section.span_of("replenish_priority"),
            Fault::NotApplicable { key: "replenish_priority", case, applicable },
        );
    }
    if let Some(priority) = priority.filter(|priority| priority.fract() != 0.0) {
        let fault = Fault::WrongType {
            key: "replenish_priority".to_owned(),
            read: priority.to_string(),
            expected: "a whole number".to_owned(),
            example: "-1".to_owned(),
        };
        walk.fault(section.span_of("replenish_priority"), fault);
    }
    read
}

/// The parts of a source with their shares; a placeholder after a fault. They stand in the order of their names, so that
/// what is drawn does not hang on the order in the file.
pub(super) fn parts_of_source(walk: &mut Walk, section: &Section<'_>, parts: &[String]) -> Vec<(usize, f64)> {
    if !section.given("part_mix") {
        if section.got("part").is_none() {
            let example = "\"shaft\"` or `part_mix = { shaft = 0.3, ring = 0.7 }".to_owned();
            let fault = Fault::MissingKey { section: section.form.title.to_owned(), key: "part", example };
            walk.fault(section.span.clone(), fault);
        }
        let part = reference(walk, "part", section.got("part"), parts.iter().map(String::as_str));
        return vec![(part.unwrap_or(0), 1.0)];
    }
    if section.given("part") {
        let (case, applicable) = ("a source with `part_mix`".to_owned(), "one of part, part_mix".to_owned());
        walk.fault(section.span_of("part"), Fault::NotApplicable { key: "part", case, applicable });
    }
    let place = section.span_of("part_mix");
    let noted = walk.problems.len();
    let mut mix = Vec::new();
    for (name, text) in walk.texts(section, "part_mix", "{ shaft = 0.3, ring = 0.7 }") {
        let Some(part) = parts.iter().position(|known| *known == name) else {
            let fault = Fault::UnknownName {
                kind: "part",
                nearest: nearest(&name, parts.iter().map(String::as_str)).map(str::to_owned),
                known: parts.join(", "),
                name,
            };
            walk.fault(place.clone(), fault);
            continue;
        };
        match text.parse::<f64>() {
            Ok(share) if share > 0.0 && share <= 1.0 => mix.push((part, share)),
            Ok(_) | Err(_) => {
                let reason = format!("{name} = {text} is no share of the jobs");
                let fix = "write a number above 0 and at most 1, such as 0.3".to_owned();
                walk.fault(place.clone(), ScenarioFault::Arrangement { reason, fix });
            }
        }
    }
    let sum: f64 = mix.iter().map(|(_, share)| share).sum();
    if walk.problems.len() == noted && (sum - 1.0).abs() > 1e-9 {
        let reason = format!("the shares of the parts add up to {sum}");
        let fix = "give every part of the source its share of 1".to_owned();
        walk.fault(place, ScenarioFault::Arrangement { reason, fix });
    }
    if mix.is_empty() { vec![(0, 1.0)] } else { mix }
}

/// Pieces of a job of a source.
pub(super) fn quantity(walk: &mut Walk, section: &Section<'_>) -> Distribution {
    if let Some(count) = section.count("quantity") {
        return Distribution::Constant(count as f64);
    }
    let Some(table) = walk.table(section, "quantity") else { return Distribution::Constant(1.0) };
    let counts = |key: &str| -> Vec<f64> {
        let number = |value: &Value<'_>| if let Value::Count(count) = value { *count as f64 } else { f64::NAN };
        table.list(key).iter().map(|got| number(&got.value)).collect()
    };
    let shares = |key: &str| -> Vec<f64> {
        let number = |value: &Value<'_>| if let Value::Si(number) = value { *number } else { f64::NAN };
        table.list(key).iter().map(|got| number(&got.value)).collect()
    };
    let mut refuse = |key: &str, reason: String| {
        let fix = "write low = 1 and high = 9, or values = [1, 5, 20] with weights = [2, 2, 1]".to_owned();
        walk.fault(table.span_of(key), ScenarioFault::Arrangement { reason, fix });
        Distribution::Constant(1.0)
    };
    match (table.count("low"), table.count("high"), counts("values")) {
        (Some(low), Some(high), values) if values.is_empty() && low <= high => {
            Distribution::DiscreteUniform { low: low as f64, step: 1.0, count: (high - low) as u32 + 1 }
        }
        (None, None, values) if !values.is_empty() => {
            let weights = if table.given("weights") { shares("weights") } else { vec![1.0; values.len()] };
            if weights.len() != values.len() {
                return refuse("weights", format!("{} numbers of pieces have {} weights", values.len(), weights.len()));
            }
            if weights.iter().sum::<f64>() <= 0.0 {
                return refuse("weights", "no number of pieces ever occurs".to_owned());
            }
            let weighted: Vec<(f64, f64)> = values.into_iter().zip(weights).collect();
            Distribution::Empirical(Arc::new(Empirical::new(&weighted)))
        }
        (Some(low), Some(high), values) if values.is_empty() => {
            refuse("low", format!("low = {low} is above high = {high}"))
        }
        (low, ..) => refuse(
            if low.is_some() { "low" } else { "values" },
            "pieces are given by low and high, or by values".to_owned(),
        ),
    }
}

/// The sections `[[stock]]`.
pub(super) fn stocks(walk: &mut Walk, root: &Section<'_>, names: &Names, parts: &[Part]) -> Vec<Stock> {
    let mut stocks: Vec<Stock> = Vec::new();
    for section in walk.sections(root, "stock", None) {
        let known = names.parts.iter().map(String::as_str);
        let Some(part) = reference(walk, "part", section.got("part"), known) else { continue };
        let name = &names.parts[part];
        if stocks.iter().any(|stock| stock.part == part) {
            walk.fault(section.span_of("part"), Fault::DuplicateName { kind: "stock", name: name.clone() });
            continue;
        }
        let component = |other: &Part| other.components.iter().any(|component| component.part == part);
        if !parts.iter().any(component) {
            let reason = format!("there is a stock of \"{name}\", which goes into no other part");
            let fix = format!("name it among the `components` of a part: components = [{{ part = \"{name}\" }}]");
            walk.fault(section.span_of("part"), ScenarioFault::Arrangement { reason, fix });
        }
        let reorder = walk.table(&section, "reorder").map(|reorder| Reorder {
            below: reorder.count32("below"),
            lot: reorder.count32("lot"),
            lead: reorder.si("lead"),
            priority: reorder.count32("priority"),
        });
        stocks.push(Stock { part, quantity: section.count32("quantity"), reorder });
    }
    stocks
}

/// Finds orders that are made for another one and do not go into it, and orders whose components nobody makes for them.
pub(super) fn check_parents(
    walk: &mut Walk,
    root: &Section<'_>,
    parts: &[Part],
    (orders, arrivals): (&[Order], &[Arrival]),
) {
    let mut refuse = |key: &str, reason: String, fix: String| {
        walk.fault(root.span_of(key), ScenarioFault::Arrangement { reason, fix });
    };
    let pegged = |order: &Order| parts.get(order.part).filter(|part| part.pegging == Pegging::Order);
    for order in orders {
        let Some(parent) = order.parent.and_then(|parent| orders.get(parent)) else { continue };
        let (Some(part), Some(into)) = (parts.get(order.part), parts.get(parent.part)) else { continue };
        if !into.components.iter().any(|component| component.part == order.part) {
            let reason = format!(
                "order \"{}\" is made for order \"{}\", but \"{}\" does not go into \"{}\"",
                order.id, parent.id, part.name, into.name
            );
            refuse("order", reason, "take out `parent`, or name the part among the `components`".to_owned());
        } else if pegged(parent).is_none() {
            let reason =
                format!("order \"{}\" is made for order \"{}\", which takes what is in stock", order.id, parent.id);
            refuse("order", reason, format!("give part \"{}\" pegging = \"order\"", into.name));
        }
    }
    for (index, order) in orders.iter().enumerate() {
        let Some(part) = pegged(order) else { continue };
        // Of what the order has behind it, it has the components.
        let assembled = order.in_process.as_ref().is_some_and(|inside| Some(inside.operation) > part.assembly());
        for component in part.components.iter().filter(|_| !assembled) {
            let own = orders.iter().filter(|own| own.parent == Some(index) && own.part == component.part);
            let made: u64 = own.map(|own| u64::from(own.quantity)).sum();
            let needed = u64::from(component.quantity) * u64::from(order.pieces());
            if made < needed {
                let name = &parts[component.part].name;
                let reason = format!(
                    "order \"{}\" needs {needed} \"{name}\" that are made for it, and orders with this `parent` make {made}",
                    order.id
                );
                refuse("order", reason, format!("add an order of \"{name}\" with parent = \"{}\"", order.id));
            }
        }
    }
    for arrival in arrivals {
        let of_order = |(part, _): &&(usize, f64)| parts.get(*part).is_some_and(|part| part.pegging == Pegging::Order);
        if let Some((part, _)) = arrival.parts.iter().find(of_order) {
            let reason =
                format!("jobs of \"{}\" come from a source, and take only what was made for them", parts[*part].name);
            refuse(
                "arrivals",
                reason,
                "take out pegging = \"order\", or give orders in the place of the source".to_owned(),
            );
        }
    }
}

/// Finds what is not modelled together with several pieces from a source, with samples, and with lost pieces that are replaced.
pub(super) fn check(walk: &mut Walk, root: &Section<'_>, around: &Around<'_>, control: &Control) {
    let Around { machines, buffers, parts, arrivals, orders, .. } = *around;
    let mut refuse = |key: &str, reason: String, fix: &str| {
        walk.fault(root.span_of(key), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    for arrival in arrivals {
        let most = arrival.quantity.quantile(1.0 - f64::EPSILON);
        let mixed = arrival.parts.iter().filter_map(|(part, _)| parts.get(*part)).filter(|_| most > 1.0);
        for part in mixed {
            let cut = part.operations.iter().find(|operation| !matches!(operation.work, Work::Plain(_)));
            if let Some(operation) = cut {
                let reason = format!(
                    "jobs of \"{}\" have several pieces, which are cut one by one in \"{}\"",
                    part.name, operation.name
                );
                refuse(
                    "arrivals",
                    reason,
                    "take out `quantity`: let as many jobs come together, by pattern = \"batch\"",
                );
            }
            let visited = part.operations.iter().flat_map(|operation| &operation.machines).map(|each| &machines[*each]);
            let full = |batch: &toolroom_scenario::Batch| batch.by == BatchUnit::Pieces && f64::from(batch.max) < most;
            let small = |buffer: &usize| {
                buffers[*buffer].unit == BatchUnit::Pieces && f64::from(buffers[*buffer].places) < most
            };
            for machine in visited {
                if machine.batch.as_ref().is_some_and(full) || machine.input_buffer.as_ref().is_some_and(small) {
                    let reason = format!(
                        "{most} pieces of \"{}\" may move together, but do not fit into \"{}\" or before it",
                        part.name, machine.name
                    );
                    refuse("arrivals", reason, "give it more room, or the source a smaller `quantity`");
                }
            }
        }
    }
    for part in parts {
        let scrapped = |own: &&toolroom_scenario::Operation| own.inspection.passes_by();
        let Some(operation) = part.operations.iter().find(scrapped) else { continue };
        let handles = operation.machines.iter().map(|each| &machines[*each]);
        let handled = handles.clone().find(|own| own.load_time.mean() + own.unload_time.mean() > 0.0);
        let name = format!("pieces of \"{}\" pass by \"{}\"", part.name, operation.name);
        if !matches!(operation.work, Work::Plain(_)) {
            refuse("part", format!("{name}, which cuts"), "sample an operation with `work`");
        } else if let Some(machine) = handled {
            let reason = format!("{name}, and \"{}\" has times of loading and unloading", machine.name);
            refuse("part", reason, "make them part of `work`: they are those of the sample only");
        } else if part.random_routing
            || !buffers.is_empty()
            || !control.loops.is_empty()
            || control.schedule.is_some()
            || orders.iter().any(|order| order.keeps_machines(part) && order.setup_ahead)
            || handles.clone().any(|own| own.batch.is_some())
            || operation.assembles
        {
            let reason = format!(
                "{name} in a shop with a random routing, limited buffers, loops, a schedule, setups ahead, batches or assembly there"
            );
            refuse("part", reason, "take out `others = \"pass\"`: together they are not modelled");
        }
    }
    for part in parts.iter().filter(|part| matches!(part.replenish, Replenish::NewOrder { .. })) {
        if control.schedule.is_some() || part.random_routing {
            let reason =
                format!("lost pieces of \"{}\" begin anew in a shop with a schedule or a random routing", part.name);
            refuse("part", reason, "take out `replenish`: together they are not modelled");
        }
    }
}
