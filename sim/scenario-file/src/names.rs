//! Names of a scenario file, and the references to them.

use super::choices::ProcessKind;
use toml::de::{DeTable, DeValue};
use toolroom_effects::Definition;
use toolroom_form::{Fault, Section, SectionValue, Span, Value, Walk, nearest};
use toolroom_scenario::{Fixture, ToolType};

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
        for (name, _) in raw_names(root.got("tool").map(|got| &got.value)) {
            all.tools.push(name);
        }
        for (part, table) in raw_names(root.got("part").map(|got| &got.value)) {
            let operations = table.get("operation").map(|raw| Value::Raw(raw.get_ref().clone()));
            for (operation, _) in raw_names(operations.as_ref()) {
                all.programs.push(format!("{part}/{operation}"));
                if !all.operations.contains(&operation) {
                    all.operations.push(operation);
                }
            }
            all.parts.push(part);
        }
        all
    }
}

/// The tables of a list that have a name.
fn raw_names<'d>(value: Option<&Value<'d>>) -> Vec<(String, DeTable<'d>)> {
    let Some(Value::Raw(DeValue::Array(entries))) = value else { return Vec::new() };
    let tables = entries.iter().filter_map(|entry| entry.get_ref().as_table());
    tables.filter_map(|table| Some((table.get("name")?.get_ref().as_str()?.to_owned(), table.clone()))).collect()
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
    let mut seen: Vec<String> = Vec::new();
    let mut named = Vec::with_capacity(sections.len());
    for section in sections {
        let name = section.text("name").unwrap_or_default().to_owned();
        if !name.is_empty() && seen.contains(&name) {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: key, name: name.clone() });
        }
        seen.push(name.clone());
        named.push((name, section));
    }
    named
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
