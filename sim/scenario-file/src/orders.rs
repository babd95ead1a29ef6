//! Orders: sections of the scenario and rows of tables beside it, and how far they are when the run begins.

use super::calendars::moment;
use super::fault::ScenarioFault;
use super::names::{Names, reference};
use super::order_columns::Columns;
use super::table::{self, Table, form_of};
use std::collections::BTreeSet;
use toolroom_form::{Fault, Section, Span, Walk, nearest};
use toolroom_scenario::{InProcess, MachineType, Order, Part, Replenish, Work, date};

/// Most orders that are named where one is not known (assumption: what a reader looks through).
const MOST_KNOWN: usize = 20;

/// What the orders of a file are read against.
pub(super) struct Around<'a> {
    pub names: &'a Names,
    pub machines: &'a [MachineType],
    pub parts: &'a [Part],
    /// The section `[tables]`.
    pub tables: Option<&'a Section<'a>>,
    /// The date of second 0.
    pub start: Option<f64>,
    pub horizon: f64,
}

/// Orders that have been read.
struct Reader<'a> {
    around: &'a Around<'a>,
    orders: Vec<Order>,
    /// Where the release of every order stands.
    places: Vec<Place>,
    seen: BTreeSet<String>,
    /// The order for which every order is made, as it stands in the file.
    parents: Vec<Option<(Span, String)>>,
    /// Machines that have work when the run begins, and the order.
    taken: Vec<(usize, usize)>,
}

/// A place in the scenario, or a row of a table that it names there.
struct Place {
    /// Where its release stands.
    span: Span,
    /// Its section, or where its table is named.
    section: Span,
    row: Option<(String, u64)>,
}

impl Place {
    /// A fault with the row of the table, where there is one.
    fn in_row(&self, fault: Fault) -> Fault {
        match &self.row {
            None => fault,
            Some((file, line)) => {
                let (reason, fix) = (fault.to_string(), fault.fix());
                ScenarioFault::TableCell { file: file.clone(), line: *line, reason, fix }.into()
            }
        }
    }
}

/// Where every order stands.
pub(super) struct Places(Vec<Place>);

impl Places {
    /// Notes a fault of an order at its section or row.
    pub fn fault(&self, walk: &mut Walk, order: usize, fault: impl Into<Fault>) {
        let place = &self.0[order];
        walk.fault(place.section.clone(), place.in_row(fault.into()));
    }
}

/// All orders: those of `[[order]]` first, then those of the table.
pub(super) fn orders(walk: &mut Walk, root: &Section<'_>, around: &Around<'_>) -> (Vec<Order>, Places) {
    let (orders, places, seen) = (Vec::new(), Vec::new(), BTreeSet::new());
    let mut reader = Reader { around, orders, places, seen, parents: Vec::new(), taken: Vec::new() };
    for section in walk.sections(root, "order", None) {
        reader.order(walk, &section, None);
    }
    if let Some(tables) = around.tables
        && let Some(file) = tables.text("orders")
        && let Some(text) = table::text(walk, tables, "orders", file)
    {
        let mapping = &Columns::read(walk, tables, form_of("order"));
        let table = Table { file, text: &text, place: tables.span_of("orders"), kind: "order", mapping };
        table.rows(walk, |walk, section, line| reader.order(walk, section, Some((file.to_owned(), line))));
    }
    reader.find_parents(walk);
    for section in walk.sections(root, "wip", None) {
        reader.in_process(walk, &section);
    }
    if let Some(tables) = around.tables
        && let Some(file) = tables.text("wip")
        && let Some(text) = table::text(walk, tables, "wip", file)
    {
        let table = Table { file, text: &text, place: tables.span_of("wip"), kind: "wip", mapping: &Columns::own() };
        table.rows(walk, |walk, section, _| reader.in_process(walk, section));
    }
    reader.check_releases(walk);
    (reader.orders, Places(reader.places))
}

impl Reader<'_> {
    fn order(&mut self, walk: &mut Walk, section: &Section<'_>, row: Option<(String, u64)>) {
        let id = section.text("id").unwrap_or_default().to_owned();
        if !id.is_empty() && !self.seen.insert(id.clone()) {
            walk.fault(section.span_of("id"), Fault::DuplicateName { kind: "order", name: id.clone() });
        }
        let &Around { names, parts, start, .. } = self.around;
        let known = names.parts.iter().map(String::as_str);
        let part = reference(walk, "part", section.got("part"), known).unwrap_or(0);
        let release = moment(walk, section, "release", start).unwrap_or(0.0);
        let allowance = parts.get(part).map_or(0.0, |part| part.flow_allowance);
        let due = match moment(walk, section, "due", start) {
            Some(due) => due,
            None => release + allowance,
        };
        if due < release {
            let fault = Fault::Contradiction {
                first: "due",
                first_value: self.shown(due),
                second: "release",
                second_value: self.shown(release),
                rule: "an order is due after it is released",
            };
            walk.fault(section.span_of("due"), fault);
        }
        self.places.push(Place { span: section.span_of("release"), section: section.span.clone(), row });
        let quantity = section.count32("quantity");
        self.orders.push(Order {
            id,
            part,
            quantity,
            release,
            due,
            priority: section.count32("priority"),
            weight: section.required("weight"),
            customer: section.text("customer").unwrap_or_default().to_owned(),
            transfer: section.count("transfer").and_then(|pieces| u32::try_from(pieces).ok()),
            split: match section.text("split") {
                Some(_) => Some(u32::MAX),
                None => section.count("split").and_then(|machines| u32::try_from(machines).ok()),
            },
            setup_ahead: section.flag("setup_ahead").unwrap_or(false),
            parent: None,
            overrun: match parts.get(part).map(|part| part.replenish) {
                // Rounded up, but not for the sake of rounding.
                Some(Replenish::Overrun(share)) => (share * f64::from(quantity) - 1e-9).ceil().max(0.0) as u32,
                Some(Replenish::Nothing | Replenish::NewOrder { .. }) | None => 0,
            },
            in_process: None,
        });
        self.parents.push(section.text("parent").map(|parent| (section.span_of("parent"), parent.to_owned())));
    }

    /// Finds the orders for which others are made, when all of them are known.
    fn find_parents(&mut self, walk: &mut Walk) {
        for (index, parent) in self.parents.iter().enumerate() {
            let Some((span, name)) = parent else { continue };
            let found = self.orders.iter().position(|order| order.id == *name);
            if found.is_none() {
                let known = || self.orders.iter().map(|order| order.id.as_str());
                let fault = Fault::UnknownName {
                    kind: "order",
                    name: name.clone(),
                    nearest: nearest(name, known()).map(str::to_owned),
                    known: known().take(MOST_KNOWN).collect::<Vec<_>>().join(", "),
                };
                walk.fault(span.clone(), self.places[index].in_row(fault));
            }
            self.orders[index].parent = found;
        }
    }

    /// How far an order has come when the run begins.
    fn in_process(&mut self, walk: &mut Walk, section: &Section<'_>) {
        let &Around { names, machines, parts, start, .. } = self.around;
        let ids = self.orders.iter().map(|order| order.id.as_str());
        let Some(index) = reference(walk, "order", section.got("order"), ids) else { return };
        let Some(part) = parts.get(self.orders[index].part) else { return };
        let operations = part.operations.iter().map(|operation| operation.name.as_str());
        let Some(place) = reference(walk, "operation", section.got("operation"), operations) else { return };
        let operation = &part.operations[place];
        let known = names.each_machine.iter().map(String::as_str);
        let machine = reference(walk, "machine", section.got("machine"), known);
        let order = &self.orders[index];
        let whole = f64::from(order.pieces());
        let done = match section.count("pieces") {
            Some(pieces) => pieces as f64 / whole,
            None => section.si("done").unwrap_or(0.0),
        };
        let in_process = InProcess {
            operation: place,
            machine,
            done,
            setup_left: section.si("setup_left").unwrap_or(0.0),
            since: moment(walk, section, "since", start).unwrap_or(0.0),
        };
        let done_at = if section.given("pieces") { "pieces" } else { "done" };
        let divided = order.is_divided(part);
        let batch = machine.and_then(|machine| machines[machine].batch);
        let mut refuse = |key: &str, reason: String, fix: String| {
            walk.fault(section.span_of(key), ScenarioFault::Arrangement { reason, fix });
        };
        let id = &order.id;
        if order.in_process.is_some() {
            refuse("order", format!("order \"{id}\" is in two places"), "take out one of them".to_owned());
        }
        if let Some(machine) = machine {
            let name = &machines[machine].name;
            if !operation.machines.contains(&machine) {
                let may: Vec<&str> =
                    operation.machines.iter().map(|in_process| machines[*in_process].name.as_str()).collect();
                let reason = format!("machine \"{name}\" does not do operation \"{}\"", operation.name);
                refuse("machine", reason, format!("its machines: {}", may.join(", ")));
            }
            let other = self.taken.iter().find(|(taken, _)| *taken == machine).filter(|_| batch.is_none());
            if let Some(other) = other.and_then(|(_, other)| self.orders.get(*other)) {
                let reason = format!("machine \"{name}\" has order \"{}\" already", other.id);
                refuse("machine", reason, format!("take out `machine`: then \"{id}\" waits"));
            }
        }
        if section.given("done") && section.given("pieces") {
            refuse("pieces", "`done` and `pieces` say the same".to_owned(), "take out one of them".to_owned());
        }
        if done >= 1.0 {
            let reason = format!("order \"{id}\" has all of operation \"{}\" behind it", operation.name);
            refuse(
                done_at,
                reason,
                "name the operation that comes next; leave out orders that are finished".to_owned(),
            );
        } else if done > 0.0 && !divided && machine.is_none() {
            let reason = format!("order \"{id}\" waits as a whole, but a part of it is done");
            let fix = "name the machine that works on it, or give the order the quantity that is left and take out \
                       what is done";
            refuse(done_at, reason, fix.to_owned());
        } else if done > 0.0 && matches!(operation.work, Work::Grinding { .. } | Work::Cycle(_)) && !divided {
            let reason = format!("operation \"{}\" is ground, and cannot begin in the middle", operation.name);
            refuse(done_at, reason, format!("take out `{done_at}`: the piece is ground from the start"));
        }
        if in_process.setup_left > 0.0 && (machine.is_none() || done > 0.0) {
            let reason = format!("order \"{id}\" has a setup in progress, but no machine, or work done");
            refuse("setup_left", reason, "take out `setup_left`, or what contradicts it".to_owned());
        }
        if in_process.since > 0.0 {
            let reason = format!("order \"{id}\" comes after the start: {}", self.shown(in_process.since));
            refuse("since", reason, "give a date or a time that is not after the start".to_owned());
        }
        self.taken.extend(machine.map(|machine| (machine, index)));
        self.orders[index].in_process = Some(in_process);
    }

    /// An order is released in the run, or is in the shop when it begins.
    fn check_releases(&self, walk: &mut Walk) {
        let horizon = self.around.horizon;
        for (order, place) in self.orders.iter().zip(&self.places) {
            let from = if order.in_process.is_some() { f64::NEG_INFINITY } else { 0.0 };
            let to = if order.in_process.is_some() { 0.0 } else { horizon };
            if (from..=to).contains(&order.release) {
                continue;
            }
            let run = format!("from {} to {}", self.shown(0.0), self.shown(horizon));
            let (id, release) = (order.id.clone(), self.shown(order.release));
            let fault = if order.in_process.is_some() {
                let reason = format!("order {id} is in the shop at the start, but released at {release}");
                ScenarioFault::Arrangement {
                    reason,
                    fix: "take it out of the [[wip]], or release it before".to_owned(),
                }
            } else {
                ScenarioFault::OrderOutside { id, release, run }
            };
            let fault = place.in_row(fault.into());
            walk.fault(place.span.clone(), fault);
        }
    }

    /// A time as people read it.
    fn shown(&self, time: f64) -> String {
        self.around.start.map_or_else(|| format!("{} h", time / 3600.0), |start| date::show(start + time))
    }
}
