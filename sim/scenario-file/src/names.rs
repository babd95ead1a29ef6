//! Names of a scenario file, and the references to them.

use super::choices::ProcessKind;
use std::collections::HashSet;
use toml::de::{DeTable, DeValue};
use toolroom_effects::Definition;
use toolroom_form::{Fault, Section, SectionValue, Span, Value, Walk, nearest};
use toolroom_scenario::{Fixture, Part, ToolType};

/// Machines, tools and calendars under their names, as references see them.
#[derive(Default)]
pub(super) struct Names {
    pub calendars: Vec<String>,
    /// Shifts of any calendar.
    pub shifts: Vec<String>,
    pub setup_matrices: Vec<String>,
    pub crews: Vec<String>,
    /// Fixtures, with the operations that need them as far as these have been read.
    pub fixtures: Vec<Fixture>,
    /// What any operator can do.
    pub skills: Vec<String>,
    /// A name and the machines that it stands for.
    pub machines: Vec<(String, Vec<usize>)>,
    /// The name of each machine.
    pub each_machine: Vec<String>,
    pub tools: Vec<String>,
    pub parts: Vec<String>,
    /// Effects that the file defines.
    pub defined: Vec<&'static Definition>,
    /// What scopes and targets may name, whatever the order of the sections.
    pub all: Named,
}

/// Names of a file before its sections are resolved.
#[derive(Default)]
pub(super) struct Named {
    pub tools: Vec<String>,
    pub parts: Vec<String>,
    pub operations: Vec<String>,
    /// `part/operation`.
    pub programs: Vec<String>,
}

impl Names {
    /// The names that scopes and targets may use; what the sections name comes as they are read.
    pub(super) fn of(root: &Section<'_>) -> Self {
        Self { all: Named::of(root), ..Self::default() }
    }
}

impl Named {
    fn of(root: &Section<'_>) -> Self {
        let mut all = Self::default();
        for (name, _) in raw_names(raw(root, "tool")) {
            all.tools.push(name.to_owned());
        }
        for (part, table) in raw_names(raw(root, "part")) {
            for (operation, _) in raw_names(table.get("operation").map(|raw| raw.get_ref())) {
                all.add_operation(part, operation);
            }
            all.parts.push(part.to_owned());
        }
        all
    }

    fn add_operation(&mut self, part: &str, operation: &str) {
        self.programs.push(format!("{part}/{operation}"));
        if !self.operations.iter().any(|known| known == operation) {
            self.operations.push(operation.to_owned());
        }
    }

    /// Adds parts that have no section of their own, as the edges of a crib that are ground again.
    pub(super) fn add(&mut self, parts: &[Part]) {
        for part in parts {
            part.operations.iter().for_each(|operation| self.add_operation(&part.name, &operation.name));
            self.parts.push(part.name.clone());
        }
    }
}

/// What stands under a key before it is read.
fn raw<'s, 'd>(section: &'s Section<'d>, key: &str) -> Option<&'s DeValue<'d>> {
    match section.got(key).map(|got| &got.value) {
        Some(Value::Raw(value)) => Some(value),
        Some(_) | None => None,
    }
}

/// The tables of a list that have a name.
fn raw_names<'s, 'd>(value: Option<&'s DeValue<'d>>) -> impl Iterator<Item = (&'s str, &'s DeTable<'d>)> {
    let entries = value.and_then(DeValue::as_array).into_iter().flatten();
    let tables = entries.filter_map(|entry| entry.get_ref().as_table());
    tables.filter_map(|table| Some((table.get("name")?.get_ref().as_str()?, table)))
}

/// A tool as operations see it: known by name and process even where its constants are at fault.
pub(super) struct NamedTool {
    pub process: Option<ProcessKind>,
    pub span: Span,
    /// Whether nothing is known of it but how long its edges last.
    pub life_only: bool,
    pub tool: Option<ToolType>,
}

/// Sections under `key`, at least one, no name twice; their names.
pub(super) fn named<'d>(
    walk: &mut Walk,
    root: &Section<'d>,
    key: &'static str,
    example: Option<&'static str>,
) -> Vec<(String, Section<'d>)> {
    let sections = walk.sections(root, key, None);
    if let Some(example) = example
        && sections.is_empty()
        && !matches!(root.got(key).map(|got| &got.value), Some(Value::Faulty))
    {
        walk.fault(0..0, Fault::Nothing { what: key, example });
    }
    let mut seen: HashSet<String> = HashSet::new();
    let mut named = Vec::with_capacity(sections.len());
    for section in sections {
        let name = section.text("name").unwrap_or_default().to_owned();
        if !seen.insert(name.clone()) && !name.is_empty() {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: key, name: name.clone() });
        }
        named.push((name, section));
    }
    named
}

/// What the members of a section are called, one or with `count` so many, each with a number behind the name. `taken` are the names
/// of all sections and of the members before; one that is among them is noted: L with `count = 12` has a member L11, and so has L1
/// with `count = 2`.
pub(super) fn members(
    walk: &mut Walk,
    kind: &'static str,
    (name, section): (&str, &Section<'_>),
    taken: &mut HashSet<String>,
) -> Vec<String> {
    let Some(count) = section.count("count") else { return vec![name.to_owned()] };
    let members: Vec<String> = (1..=count).map(|number| format!("{name}{number}")).collect();
    for member in &members {
        if !taken.insert(member.clone()) {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind, name: member.clone() });
        }
    }
    members
}

/// Index of the name that `got` holds.
pub(super) fn reference<'a>(
    walk: &mut Walk,
    kind: &'static str,
    got: Option<&SectionValue<'_>>,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Option<usize> {
    let got = got?;
    let Value::Text(name) = &got.value else { return None };
    let position = known.clone().position(|each| each == name);
    if position.is_none() {
        let fault = Fault::UnknownName {
            kind,
            name: name.clone(),
            nearest: nearest(name, known.clone()).map(str::to_owned),
            known: known.filter(|name| !name.is_empty()).collect::<Vec<_>>().join(", "),
        };
        walk.fault(got.span.clone(), fault);
    }
    position
}

/// The machines under a key, each once, in the order of the file.
pub(super) fn machine_indices(walk: &mut Walk, section: &Section<'_>, key: &str, names: &Names) -> Vec<usize> {
    let mut indices = Vec::new();
    for got in section.list(key) {
        let known = names.machines.iter().map(|(name, _)| name.as_str());
        let Some(found) = reference(walk, "machine", Some(got), known) else { continue };
        for index in &names.machines[found].1 {
            if !indices.contains(index) {
                indices.push(*index);
            }
        }
    }
    indices
}
