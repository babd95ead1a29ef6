//! Cards, release, and what the keys of the rules are made of.

use super::choices::{DueWord, ReleaseWord};
use super::fault::ScenarioFault;
use super::keys::quantity::{DISTRIBUTION, DURATION};
use super::names::{Names, named, reference};
use super::queue_rules::{queue_rules, rules_under};
use super::random::law;
use toml::Spanned;
use toml::de::DeValue;
use toolroom_form::{Fault, Kind, Section, Value, Walk, nearest};
use toolroom_scenario::{
    Assignment, CardLoop, Control, DispatchRule, Distribution, DueRule, InspectedTo, KeyOptions, KeyTime, MOST_LOOPS,
    MachineTime, NextQueue, Operation, Order, Part, QueueChoice, ReleaseRule, SlackBy,
};

/// Loops, release and options of the rules of a file whose parts and orders are known.
pub(super) fn control(
    walk: &mut Walk,
    (root, dispatch): (&Section<'_>, Option<&Section<'_>>),
    names: &Names,
    (parts, orders): (&[Part], &[Order]),
) -> Control {
    let mut control =
        Control { loops: loops(walk, root, names, parts), release: release(walk, root), ..Control::default() };
    if let Some(section) = dispatch {
        control.keys = keys(section);
        control.assign = section.chosen("assign", Assignment::from_word).unwrap_or_default();
        control.queue_choice = section.chosen("queue_choice", QueueChoice::from_word).unwrap_or_default();
        if section.given("queue_choice") && control.assign == Assignment::AtStart {
            let reason = "`queue_choice` chooses among queues, but the machines of an operation have one".to_owned();
            refuse(walk, root, "dispatch", reason, "write assign = \"at_arrival\", or take out `queue_choice`");
        }
    }
    check(walk, root, &control, (parts, orders));
    control
}

fn refuse(walk: &mut Walk, root: &Section<'_>, key: &str, reason: String, fix: &str) {
    walk.fault(root.span_of(key), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
}

fn keys(section: &Section<'_>) -> KeyOptions {
    let usual = KeyOptions::default();
    let value = |key: &str, usual: f64| section.si(key).unwrap_or(usual);
    KeyOptions {
        atc_k: value("atc_k", usual.atc_k),
        atcs_k: [value("atcs_k1", usual.atcs_k[0]), value("atcs_k2", usual.atcs_k[1])],
        covert_kb: [value("covert_k", usual.covert_kb[0]), value("covert_b", usual.covert_kb[1])],
        time: section.chosen("time_in_key", KeyTime::from_word).unwrap_or_default(),
        setup: section.flag("setup_in_key").unwrap_or(false),
        slack_by: section.chosen("slack_by", SlackBy::from_word).unwrap_or_default(),
        next_queue: section.chosen("next_queue", NextQueue::from_word).unwrap_or_default(),
    }
}

fn loops(walk: &mut Walk, root: &Section<'_>, names: &Names, parts: &[Part]) -> Vec<CardLoop> {
    let mut loops = Vec::new();
    for (name, section) in named(walk, root, "loop", None) {
        let stations = || names.machines.iter().map(|(name, _)| name.as_str());
        let from = reference(walk, "machine", section.got("from"), stations());
        let to = if section.given("to") { reference(walk, "machine", section.got("to"), stations()) } else { from };
        let (Some(from), Some(to)) = (from, to) else { continue }; // a problem was noted
        let (first, last) = (&names.machines[from], &names.machines[to]);
        let known = || names.parts.iter().map(String::as_str);
        let list = section.list("parts");
        let members: Vec<usize> = list.iter().filter_map(|got| reference(walk, "part", Some(got), known())).collect();
        let mut spans = Vec::new();
        for (index, part) in parts.iter().enumerate() {
            let listed = members.contains(&index);
            let span = span(part, &first.1, &last.1).filter(|_| listed || list.is_empty());
            if listed && span.is_none() {
                let reason = format!("part \"{}\" does not go from \"{}\" to \"{}\"", part.name, first.0, last.0);
                let fix = format!("take it out of the `parts` of loop \"{name}\", or name other machines");
                walk.fault(section.span_of("parts"), ScenarioFault::Arrangement { reason, fix });
            }
            spans.push(span);
        }
        if spans.iter().all(Option::is_none) {
            let reason = format!("no part goes from \"{}\" to \"{}\"", first.0, last.0);
            let fix = "name machines of operations of one part, the first ones before the last ones".to_owned();
            walk.fault(section.span_of("from"), ScenarioFault::Arrangement { reason, fix });
        }
        let rules = queue_rules(walk, &section).unwrap_or_default();
        if let Some(rule) = rules.iter().find(|rule| looks_at_setups(**rule)) {
            let reason =
                format!("`{}` looks at the setup of a machine, and nobody chooses one for a card", rule.word());
            let fix = "write another rule of the loop".to_owned();
            walk.fault(section.span_of("rule"), ScenarioFault::Arrangement { reason, fix });
        }
        loops.push(CardLoop { name, cards: section.count32("cards"), rules, spans });
    }
    loops
}

/// Whether a rule has a meaning at a machine only.
fn looks_at_setups(rule: DispatchRule) -> bool {
    matches!(rule, DispatchRule::LeastSetup | DispatchRule::AtcWithSetups)
}

/// First and last operation of a part from some machines to others.
fn span(part: &Part, from: &[usize], to: &[usize]) -> Option<(usize, usize)> {
    let at = |machines: &[usize], operation: &Operation| operation.machines.iter().any(|own| machines.contains(own));
    let first = part.operations.iter().position(|operation| at(from, operation))?;
    let last = part.operations.iter().rposition(|operation| at(to, operation))?;
    (first <= last).then_some((first, last))
}

fn release(walk: &mut Walk, root: &Section<'_>) -> ReleaseRule {
    let Some(section) = walk.table(root, "release") else { return ReleaseRule::Immediate };
    match section.chosen("rule", ReleaseWord::from_word) {
        Some(ReleaseWord::Immediate) | None => ReleaseRule::Immediate,
        Some(ReleaseWord::AtDate) => ReleaseRule::AtDate { lead: section.required("lead") },
        Some(ReleaseWord::Workload) => {
            let sequence = sequence(walk, &section);
            if let Some(rule) = sequence.iter().find(|rule| looks_at_setups(**rule)) {
                let reason = format!("`{}` looks at the setup of a machine, and none has been chosen yet", rule.word());
                let fix = "write another `sequence`".to_owned();
                walk.fault(section.span_of("sequence"), ScenarioFault::Arrangement { reason, fix });
            }
            ReleaseRule::Workload { norm: section.required("norm"), every: section.required("every"), sequence }
        }
    }
}

fn sequence(walk: &mut Walk, section: &Section<'_>) -> Vec<DispatchRule> {
    rules_under(walk, section, "sequence").unwrap_or(vec![DispatchRule::EarliestDueDate])
}

/// The key `due` of a source.
pub(super) fn due(walk: &mut Walk, arrivals: &Section<'_>) -> DueRule {
    let Some(section) = walk.table(arrivals, "due") else { return DueRule::Allowance };
    match section.chosen("rule", DueWord::from_word) {
        Some(DueWord::TotalWork) => DueRule::TotalWork { k: section.required("k") },
        Some(DueWord::Slack) => DueRule::Slack { slack: section.required("slack") },
        Some(DueWord::Random) => DueRule::Random(super::random::distribution(walk, &section, "allowance")),
        Some(DueWord::Constant) if section.given("allowance") => {
            DueRule::Random(super::random::distribution(walk, &section, "allowance"))
        }
        Some(DueWord::Constant) | None => DueRule::Allowance,
    }
}

/// The key `time_on` of an operation: a factor or a time of its own by machine.
pub(super) fn time_on(
    walk: &mut Walk,
    section: &Section<'_>,
    names: &Names,
    machines: &[usize],
) -> Vec<(usize, MachineTime)> {
    let Some(got) = section.got("time_on") else { return Vec::new() };
    let Value::Raw(raw) = &got.value else { return Vec::new() };
    let DeValue::Table(table) = raw else {
        let example = "{ CMM3 = 1.25 }".to_owned();
        walk.wrong_type("time_on", raw, "a table of machines and times", got.span.clone(), example);
        return Vec::new();
    };
    let mut read = Vec::new();
    for (name, value) in table {
        let name = name.get_ref().to_string();
        let Some((_, indices)) = names.machines.iter().find(|(known, _)| *known == name) else {
            let known = || names.machines.iter().map(|(name, _)| name.as_str());
            let fault = Fault::UnknownName {
                kind: "machine",
                nearest: nearest(&name, known()).map(str::to_owned),
                known: known().collect::<Vec<_>>().join(", "),
                name,
            };
            walk.fault(section.span_of("time_on"), fault);
            continue;
        };
        if indices.iter().any(|index| !machines.contains(index)) {
            let reason = format!("machine \"{name}\" does not do the operation");
            refuse(walk, section, "time_on", reason, "name one of its `machines`");
            continue;
        }
        if let Some(time) = machine_time(walk, section, &name, value) {
            read.extend(indices.iter().map(|index| (*index, time.clone())));
        }
    }
    read
}

/// What `time_on` has for a machine: a number is a factor, a duration or a table with a family is a time of its own.
fn machine_time<'d>(
    walk: &mut Walk,
    section: &Section<'d>,
    name: &str,
    value: &Spanned<DeValue<'d>>,
) -> Option<MachineTime> {
    let number = |text: &str| text.parse::<f64>().ok();
    let (factor, text) = match value.get_ref() {
        DeValue::Integer(integer) => (number(integer.as_str()), integer.as_str().to_owned()),
        DeValue::Float(float) => (number(float.as_str()), float.as_str().to_owned()),
        DeValue::String(text) => (number(text), text.to_string()),
        DeValue::Table(table) => {
            let path = format!("{}, time_on {name}", section.path);
            let table = walk.section(&DISTRIBUTION, &path, table, value.span(), None);
            return Some(MachineTime::Own(law(walk, &table)));
        }
        other @ (DeValue::Boolean(_) | DeValue::Datetime(_) | DeValue::Array(_)) => {
            let expected = "a factor, a duration or a table with a distribution";
            walk.wrong_type(name, other, expected, value.span(), "1.25".to_owned());
            return None;
        }
    };
    match factor {
        Some(factor) if factor > 0.0 && factor.is_finite() => Some(MachineTime::Factor(factor)),
        None if matches!(value.get_ref(), DeValue::String(_)) => {
            let Kind::Quantity(duration) = &DURATION else { return None };
            match walk.quantity(name, duration, value) {
                Value::Si(time) => Some(MachineTime::Own(Distribution::Constant(time))),
                // A problem was noted.
                Value::Count(_) | Value::Text(_) | Value::Flag(_) | Value::List(_) | Value::Raw(_) | Value::Faulty => {
                    None
                }
            }
        }
        Some(_) | None => {
            let reason = format!("{name} = {text} is no factor on a time");
            refuse(walk, section, "time_on", reason, "write a number above 0, such as 1.25");
            None
        }
    }
}

/// Finds what could never work, or is not modelled together.
fn check(walk: &mut Walk, root: &Section<'_>, control: &Control, (parts, orders): (&[Part], &[Order])) {
    if control.loops.len() > MOST_LOOPS {
        let reason = format!("{} loops are more than {MOST_LOOPS}", control.loops.len());
        refuse(walk, root, "loop", reason, "let one loop control more than one station");
    }
    let ahead = orders.iter().find(|order| order.setup_ahead);
    if let (Some(order), false) = (ahead, control.loops.is_empty()) {
        let reason = format!("order \"{}\" has machines set up ahead, and may then wait for a card", order.id);
        refuse(walk, root, "order", reason, "take out `setup_ahead`: together with [[loop]] it is not modelled");
    }
    let keeps = |order: &&Order| parts.get(order.part).is_some_and(|part| order.keeps_machines(part));
    if let (Some(order), Assignment::AtArrival) = (orders.iter().find(keeps), control.assign) {
        let reason = format!("order \"{}\" moves in several jobs, and its machine is kept for them", order.id);
        refuse(walk, root, "order", reason, "write assign = \"at_start\": whose queue is shorter is not known then");
    }
    for (index, part) in parts.iter().enumerate().filter(|(_, part)| part.random_routing) {
        let name = &part.name;
        if let Some(own) = control.loops.iter().find(|own| own.spans.get(index).is_some_and(Option::is_some)) {
            let reason = format!("part \"{name}\" has no fixed routing, but passes loop \"{}\"", own.name);
            refuse(walk, root, "loop", reason, "list other `parts` of the loop, or write routing = \"fixed\"");
        }
        let back = |own: &Operation| own.inspection.outcomes.iter().any(|outcome| outcome.to != InspectedTo::Scrap);
        if let Some(operation) = part.operations.iter().find(|own| back(own)) {
            let reason = format!("part \"{name}\" has no fixed routing, but \"{}\" sends it back", operation.name);
            refuse(walk, root, "part", reason, "write routing = \"fixed\", or let the operation scrap");
        }
        let divided =
            |order: &&Order| order.part == index && (order.keeps_machines(part) || order.in_process.is_some());
        if let Some(order) = orders.iter().find(divided) {
            let reason = format!(
                "part \"{name}\" has no fixed routing, but order \"{}\" moves in several jobs or is in process",
                order.id
            );
            refuse(
                walk,
                root,
                "order",
                reason,
                "write routing = \"fixed\", or take out `transfer`, `split` and [[wip]]",
            );
        }
    }
}
