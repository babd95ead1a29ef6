//! What measurements say of a shop: scopes, effects of tools, calibration, deviations.

use super::fault::ScenarioFault;
use super::names::Names;
use toml::de::DeValue;
use toolroom_effects::{EffectList, Effects};
use toolroom_form::{Fault, Form, Key, Kind, Quantity, Section, Span, Value, Walk, nearest};
use toolroom_process::unit;
use toolroom_scenario::{
    Calibration, CalibrationShift, Deviation, SCOPE_NAMES, Scope, ShopEffect, SwitchedEffect, Target,
};

const NAMES: Kind = Kind::List(&Kind::Name);
const FACTOR: Kind = Kind::positive("1", "1", 1e6, "1.04");

/// The operations on which something acts.
pub(super) static SCOPE: Form = Form {
    title: "scope",
    doc: "Operations on which it acts; all keys hold together, names of a list are alternatives",
    keys: &[
        Key::optional("machine", NAMES, "Machines; one with `count` means all of them"),
        Key::optional("tool", NAMES, "Tools"),
        Key::optional("tool_id", NAMES, "Single edges, as records name them"),
        Key::optional("part", NAMES, "Parts"),
        Key::optional("operation", NAMES, "Operations by name"),
        Key::optional("material", NAMES, "Materials, as records name them; a simulated shop has none"),
        Key::optional(
            "lot",
            NAMES,
            "Lots, as records name them; in a simulated shop part-1, part-2 … for the batches of a part",
        ),
        Key::optional("shift", NAMES, "Shifts S1, S2 … of the machine's calendar"),
        Key::optional("operator", NAMES, "Operators, as records name them; a simulated shop has none"),
        Key::optional("coolant", NAMES, "Coolants, as records name them; first and second in a simulated shop"),
        Key::optional("from", Kind::Text, "First instant, as time since the start of the scenario"),
        Key::optional("until", Kind::Text, "End, as time since the start of the scenario"),
    ],
};

/// A constant that measurements have moved.
pub(super) static CALIBRATION: Form = Form {
    title: "[[calibration]]",
    doc: "A constant that measurements have moved, written by `toolroom gap apply` or by hand",
    keys: &[
        Key::required(
            "parameter",
            Kind::Name,
            "group.field of the process of a tool, or a word of the shop: programmed_time, handling_time, setup_time, \
             tool_change_time, time_between_failures, time_to_repair, arrival_interval, scrap, wear_rate, gain.CHANNEL, \
             offset.CHANNEL, scatter.FIELD",
        ),
        Key::required("target", Kind::Text, "tool NAME, machine NAME, part NAME/OPERATION, source PART, or shop"),
        Key::optional("factor", FACTOR, "Factor on the value"),
        Key::optional("summand", Kind::Amount, "Instead of a factor: what is added, with its unit"),
        Key::optional(
            "standard_error",
            Kind::Amount,
            "Of the logarithm of the factor, or of the summand with its unit",
        ),
        Key::optional(
            "prior",
            Kind::Amount,
            "Standard deviation of the same before any data; stays through every apply",
        ),
        Key::optional("scope", Kind::Table(&SCOPE), "Operations on which it acts; left out: all"),
        Key::default("by", Kind::Text, "", "Who wrote it"),
    ],
};

/// An effect of the shop.
pub(super) static SHOP_DEVIATION: Form = Form {
    title: "[[deviation]]",
    doc: "An effect of the shop that its planner does not know",
    keys: &[
        Key::required("id", Kind::Choice(ShopEffect::WORDS), "Effect; `toolroom effects` lists them"),
        Key::required("size", Kind::Amount, "Size in the unit of the catalogue, `12 s`, `0.1`, `1.5 1/h`"),
        Key::optional("standard_error", Kind::Amount, "Standard error of the size, with its unit"),
        Key::optional("scope", Kind::Table(&SCOPE), "Operations on which it acts; left out: all"),
        Key::optional("shift", Kind::Name, "The same as scope = { shift = \"S1\" }"),
        Key::optional(
            "share",
            Kind::quantity("1", "1", 0.0, 1.0, "0.05"),
            "Share of the operations that are held (feed_hold)",
        ),
        Key::optional(
            "recorded",
            Kind::quantity("1", "1", -1.0, 10.0, "0.05"),
            "Mean share that recorded overrides add to the time in cut, of which the size takes its part (feed_override)",
        ),
    ],
};

/// The scope under the key `scope` of a section.
fn scope(walk: &mut Walk, section: &Section<'_>, names: &Names) -> Scope {
    let table = walk.table(section, "scope");
    table.map_or_else(Scope::default, |table| scope_of(walk, &table, names))
}

/// The scope that a table holds; names that the scenario knows are checked.
fn scope_of(walk: &mut Walk, table: &Section<'_>, names: &Names) -> Scope {
    let mut scope = Scope::default();
    for key in SCOPE_NAMES {
        if !table.given(key) {
            continue;
        }
        let mut chosen: Vec<String> = Vec::new();
        for name in table.texts(key) {
            let known: Option<Vec<&str>> = match key {
                "machine" => Some(names.machines.iter().map(|(name, _)| name.as_str()).collect()),
                "tool" => Some(names.all.tools.iter().map(String::as_str).collect()),
                "part" => Some(names.all.parts.iter().map(String::as_str).collect()),
                "operation" => Some(names.all.operations.iter().map(String::as_str).collect()),
                // Records may name shifts of which their model has no calendar.
                "shift" if !names.shifts.is_empty() => Some(names.shifts.iter().map(String::as_str).collect()),
                _ => None,
            };
            if let Some(known) = known.filter(|known| known.iter().all(|own| *own != name)) {
                let fault = ScenarioFault::ScopeName {
                    key,
                    nearest: nearest(&name, known.iter().copied()).map(str::to_owned),
                    known: known.join(", "),
                    name,
                };
                walk.fault(table.span_of(key), fault);
                continue;
            }
            match names.machines.iter().find(|(own, _)| key == "machine" && *own == name) {
                Some((_, indices)) => chosen.extend(indices.iter().map(|index| names.each_machine[*index].clone())),
                None => chosen.push(name),
            }
        }
        scope.names.push((key, chosen));
    }
    let mut time = |key: &'static str| {
        let text = table.text(key)?;
        match unit::quantity(text, "s") {
            Ok(time) if time.is_finite() => return Some(time),
            _ if text.len() >= 10 && text.as_bytes()[4] == b'-' => {
                walk.fault(table.span_of(key), ScenarioFault::DateWithoutStart { key, read: text.to_owned() });
            }
            Ok(_) => {
                let (name, read) = (key.to_owned(), text.to_owned());
                let fault = Fault::OutOfRange { key: name, read, range: "finite times".to_owned(), meant: Vec::new() };
                walk.fault(table.span_of(key), fault);
            }
            Err(reason) => {
                let fault = Fault::Quantity { key: key.to_owned(), reason, example: "\"12 day\"".to_owned() };
                walk.fault(table.span_of(key), fault);
            }
        }
        None
    };
    (scope.from, scope.until) = (time("from"), time("until"));
    if let (Some(from), Some(until)) = (scope.from, scope.until)
        && until <= from
    {
        let shown = |time: f64| format!("{time} s");
        let fault = Fault::Contradiction {
            first: "until",
            first_value: shown(until),
            second: "from",
            second_value: shown(from),
            rule: "a scope ends after it begins",
        };
        walk.fault(table.span_of("until"), fault);
    }
    scope
}

/// `effects = [{ id = "wear_force", size = 0.2, shape = { … }, scope = { … } }]` of a tool.
pub(super) fn effects(
    walk: &mut Walk,
    tool: &Section<'_>,
    process: &'static str,
    names: &Names,
) -> Vec<SwitchedEffect> {
    let Some(read) = EffectList::from_walk(walk, tool) else { return Vec::new() };
    let mut list: Vec<SwitchedEffect> = Vec::new();
    for entry in &read.entries {
        let place = entry.span();
        let mut entry = entry.clone();
        let (mut scope, mut error) = (Scope::default(), None);
        if let DeValue::Table(table) = entry.get_mut() {
            if let Some(raw) = table.remove("scope") {
                if let DeValue::Table(own) = raw.get_ref() {
                    let section = walk.section(&SCOPE, &format!("{}, scope", tool.path), own, raw.span(), None);
                    scope = scope_of(walk, &section, names);
                } else {
                    let example = "{ machine = \"L1\" }".to_owned();
                    walk.wrong_type("scope", raw.get_ref(), "a table", raw.span(), example);
                }
            }
            error = table.remove("standard_error");
        }
        let Some(effect) = read.read(walk, entry, &names.defined) else { continue };
        let field = effect.entry().size;
        let quantity = amounts(field.unit, field.display, 0.0, f64::MAX);
        let standard_error = error.and_then(|raw| {
            if let Value::Si(value) = walk.quantity("standard_error", &quantity, &raw) { Some(value) } else { None }
        });
        let same = |own: &SwitchedEffect| own.effect.with_size(0.0) == effect.with_size(0.0) && own.scope == scope;
        if list.iter().any(same) {
            let message = format!("`{}` is listed twice with one shape and scope", effect.entry().id);
            read.refuse(walk, place, message);
            continue;
        }
        list.push(SwitchedEffect { effect, scope, standard_error });
    }
    let all = Effects::overlaid(list.iter().map(|own| own.effect).collect());
    if let Err(reason) = all.check(process) {
        read.refuse(walk, read.span.clone(), reason.to_string());
        return Vec::new();
    }
    list
}

/// What an amount may be.
const fn amounts(unit: &'static str, display: &'static str, min: f64, max: f64) -> Quantity {
    Quantity { unit, display, min, max, above: false, example: "" }
}

/// The amount under `key`, SI; `None` where it is left out or at fault.
fn amount(walk: &mut Walk, section: &Section<'_>, key: &'static str, quantity: &Quantity) -> Option<f64> {
    let got = section.got(key)?;
    let Value::Raw(raw) = &got.value else { return None };
    let raw = toml::Spanned::new(got.span.clone(), raw.clone());
    match walk.quantity(key, quantity, &raw) {
        Value::Si(value) => Some(value),
        Value::Count(_) | Value::Text(_) | Value::Flag(_) | Value::List(_) | Value::Raw(_) | Value::Faulty => None,
    }
}

/// The sections `[[calibration]]`, each with its place in the file.
pub(super) fn calibrations(walk: &mut Walk, root: &Section<'_>, names: &Names) -> Vec<(Calibration, Span)> {
    let mut list: Vec<(Calibration, Span)> = Vec::new();
    for section in walk.sections(root, "calibration", None) {
        let scope = scope(walk, &section, names);
        let (Some(parameter), Some(words)) = (section.text("parameter"), section.text("target")) else { continue };
        let (parameter, words) = (parameter.to_owned(), words.to_owned());
        let Some(target) = target(walk, &section, &words, names) else { continue };
        let Some(unit) = unit_of(&parameter) else {
            let known = Calibration::WORDS.iter().map(|(word, _)| *word);
            let fault = Fault::UnknownChoice {
                key: "parameter".to_owned(),
                nearest: nearest(&parameter, known.clone()).map(str::to_owned),
                read: parameter,
                choices: format!("group.field of a tool's process, {}", known.collect::<Vec<_>>().join(", ")),
            };
            walk.fault(section.span_of("parameter"), fault);
            continue;
        };
        let summand = amount(walk, &section, "summand", &amounts(unit, unit, f64::MIN, f64::MAX));
        let moved = match (section.si("factor"), summand) {
            (Some(factor), None) if !section.given("summand") => CalibrationShift::Factor(factor),
            (None, Some(summand)) if !section.given("factor") => CalibrationShift::Summand(summand),
            _ => {
                if section.given("factor") == section.given("summand") {
                    let fault = Fault::Contradiction {
                        first: "factor",
                        first_value: shown(&section, "factor"),
                        second: "summand",
                        second_value: shown(&section, "summand"),
                        rule: "one of them is due, and not both",
                    };
                    walk.fault(section.span.clone(), fault);
                }
                continue;
            }
        };
        let unit = if matches!(moved, CalibrationShift::Factor(_)) { "1" } else { unit };
        let calibration = Calibration {
            parameter,
            target,
            moved,
            standard_error: amount(walk, &section, "standard_error", &amounts(unit, unit, 0.0, f64::MAX)),
            prior: amount(walk, &section, "prior", &amounts(unit, unit, 0.0, f64::MAX)),
            scope,
            by: section.text("by").unwrap_or_default().to_owned(),
        };
        list.push((calibration, section.span_of("parameter")));
    }
    list
}

fn shown(section: &Section<'_>, key: &str) -> String {
    if section.given(key) { "given".to_owned() } else { "nothing".to_owned() }
}

/// Unit of a summand of a parameter; `None` where there is no such parameter.
fn unit_of(parameter: &str) -> Option<&'static str> {
    let word = |(word, _): &&(&str, &'static str)| match word.strip_suffix('*') {
        Some(start) => parameter.len() > start.len() && parameter.starts_with(start),
        None => *word == parameter,
    };
    let known = Calibration::WORDS.iter().find(word).map(|(_, unit)| *unit);
    known.or_else(|| {
        parameter.split_once('.').filter(|(group, field)| !group.is_empty() && !field.is_empty()).map(|_| "1")
    })
}

fn target(walk: &mut Walk, section: &Section<'_>, words: &str, names: &Names) -> Option<Target> {
    let Some(target) = Target::of(words) else {
        let fault = Fault::UnknownChoice {
            key: "target".to_owned(),
            read: words.to_owned(),
            nearest: None,
            choices: "tool NAME, machine NAME, part NAME/OPERATION, source PART, shop".to_owned(),
        };
        walk.fault(section.span_of("target"), fault);
        return None;
    };
    let programs = || names.all.programs.iter().map(String::as_str).collect::<Vec<_>>();
    let (kind, name, known): (&'static str, &str, Vec<&str>) = match &target {
        Target::Shop => return Some(target),
        Target::Tool(name) => ("tool", name, names.all.tools.iter().map(String::as_str).collect()),
        Target::Machine(name) => ("machine", name, names.machines.iter().map(|(name, _)| name.as_str()).collect()),
        Target::Operation(name) => ("operation", name, programs()),
        Target::Source(name) => ("part", name, names.all.parts.iter().map(String::as_str).collect()),
    };
    if known.contains(&name) {
        return Some(target);
    }
    let fault = Fault::UnknownName {
        kind,
        name: name.to_owned(),
        nearest: nearest(name, known.iter().copied()).map(str::to_owned),
        known: known.join(", "),
    };
    walk.fault(section.span_of("target"), fault);
    None
}

/// The sections `[[deviation]]`, sizes in the unit of the catalogue.
pub(super) fn deviations(walk: &mut Walk, root: &Section<'_>, names: &Names) -> Vec<Deviation> {
    let mut deviations: Vec<Deviation> = Vec::new();
    for section in walk.sections(root, "deviation", None) {
        let effect = section.text("id").and_then(ShopEffect::from_word);
        let mut scope = scope(walk, &section, names);
        if let Some(shift) = section.text("shift") {
            if scope.names.iter().any(|(key, _)| *key == "shift") {
                let rule = "the shift stands in the scope already";
                walk.fault(section.span_of("shift"), Fault::Beside { key: "shift", beside: "scope", rule });
                continue;
            }
            scope.names.push(("shift", vec![shift.to_owned()]));
            let place = |key: &str| SCOPE_NAMES.iter().position(|own| *own == key);
            scope.names.sort_by_key(|(key, _)| place(key));
        }
        let Some(effect) = effect else { continue };
        let field = effect.entry().size;
        let sizes = amounts(field.unit, field.display, field.min, field.max);
        let Some(size) = amount(walk, &section, "size", &sizes) else { continue };
        let errors = amounts(field.unit, field.display, 0.0, f64::MAX);
        let standard_error = amount(walk, &section, "standard_error", &errors);
        let share = section.si("share").unwrap_or(1.0);
        if deviations.iter().any(|own| {
            own.effect == effect && own.scope == scope && own.recorded.is_some() == section.given("recorded")
        }) {
            let name = format!("{} {}", effect.word(), scope.words());
            walk.fault(section.span_of("id"), Fault::DuplicateName { kind: "deviation", name: name.trim().to_owned() });
            continue;
        }
        let recorded = section.si("recorded").filter(|_| effect == ShopEffect::FeedOverride);
        deviations.push(Deviation { effect, size, scope, share, standard_error, recorded });
    }
    deviations
}
