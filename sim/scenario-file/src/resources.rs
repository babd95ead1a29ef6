//! People and setup matrices.

use super::fault::ScenarioFault;
use super::resolve::{Names, named, reference};
use toolroom_form::{Fault, Got, Section, Value, Walk, nearest};
use toolroom_scenario::{Attendance, MachineType, Operator, Part, SetupMatrix};

/// Operators, and the words for what they can do.
pub(super) fn operators(walk: &mut Walk, root: &Section<'_>, names: &Names) -> (Vec<Operator>, Vec<String>) {
    let (mut operators, mut all): (Vec<Operator>, Vec<String>) = (Vec::new(), Vec::new());
    for (name, section) in named(walk, root, "operator", None) {
        let calendar = reference(walk, "calendar", section.got("calendar"), names.calendars.iter().map(String::as_str));
        let mut skills = Vec::new();
        for skill in section.texts("skills") {
            let index = all.iter().position(|known| *known == skill).unwrap_or_else(|| {
                all.push(skill);
                all.len() - 1
            });
            if !skills.contains(&index) {
                skills.push(index);
            }
        }
        let count = section.count("count");
        for number in 1..=count.unwrap_or(1) {
            let operator_name = if count.is_some() { format!("{name}{number}") } else { name.clone() };
            if count.is_some() && operators.iter().any(|operator| operator.name == operator_name) {
                walk.fault(
                    section.span_of("name"),
                    Fault::DuplicateName { kind: "operator", name: operator_name.clone() },
                );
            }
            operators.push(Operator { name: operator_name, skills: skills.clone(), calendar });
        }
    }
    (operators, all)
}

/// The skills that an operation needs.
pub(super) fn attendance(walk: &mut Walk, operation: &Section<'_>, names: &Names) -> Attendance {
    let Some(section) = walk.table(operation, "operator") else { return Attendance::default() };
    let mut skill = |key: &'static str| {
        let name = section.text(key)?;
        let found = names.skills.iter().position(|known| known == name);
        if found.is_none() {
            let fault = ScenarioFault::SkillNobody {
                skill: name.to_owned(),
                nearest: nearest(name, names.skills.iter().map(String::as_str)).map(str::to_owned),
                known: names.skills.join(", "),
            };
            walk.fault(section.span_of(key), fault);
        }
        found
    };
    Attendance { setup: skill("setup"), load: skill("load"), run: skill("run") }
}

/// Setup matrices; a bad one is left as it is read.
pub(super) fn setup_matrices(walk: &mut Walk, root: &Section<'_>, names: &mut Names) -> Vec<SetupMatrix> {
    let mut matrices = Vec::new();
    for (name, section) in named(walk, root, "setup_matrix", None) {
        names.setup_matrices.push(name.clone());
        let groups = section.texts("groups");
        for (i, group) in groups.iter().enumerate().filter(|(i, group)| groups[..*i].contains(group)) {
            let place = section.list("groups").get(i).map_or(section.span.clone(), |got| got.span.clone());
            walk.fault(place, Fault::DuplicateName { kind: "setup group", name: group.clone() });
        }
        let rows = section.list("times");
        let mut times: Vec<Vec<f64>> = rows.iter().map(row).collect();
        if ![groups.len(), groups.len() + 1].contains(&rows.len()) {
            refuse(walk, section.span_of("times"), ("times", rows.len(), "rows"), groups.len());
        }
        for (got, times) in rows.iter().zip(&times).filter(|(_, times)| times.len() != groups.len()) {
            refuse(walk, got.span.clone(), ("times", times.len(), "entries in a row"), groups.len());
        }
        let first = (times.len() == groups.len() + 1).then(|| times.remove(0));
        matrices.push(SetupMatrix { name, groups, first, times });
    }
    matrices
}

fn row(got: &Got<'_>) -> Vec<f64> {
    let Value::List(cells) = &got.value else { return Vec::new() };
    cells.iter().map(|cell| if let Value::Si(time) = cell.value { time } else { f64::NAN }).collect()
}

fn refuse(walk: &mut Walk, span: toolroom_form::Span, (key, count, of): (&'static str, usize, &str), groups: usize) {
    let fault = Fault::Contradiction {
        first: key,
        first_value: format!("{count} {of}"),
        second: "groups",
        second_value: format!("{groups} entries"),
        rule: "a setup matrix has a row for every group, or one more in front, and every row a time for every group",
    };
    walk.fault(span, fault);
}

/// Every setup group that comes to a machine stands in its matrix.
pub(super) fn check_pairs(
    walk: &mut Walk,
    root: &Section<'_>,
    machines: &[MachineType],
    parts: &[Part],
    matrices: &[SetupMatrix],
) {
    let place = root.span_of("setup_matrix");
    for (index, machine) in machines.iter().enumerate() {
        let Some(matrix) = machine.setup_matrix.and_then(|matrix| matrices.get(matrix)) else { continue };
        let mut told: Vec<&str> = Vec::new();
        let here = parts.iter().flat_map(|part| &part.operations).filter(|own| own.machines.contains(&index));
        let groups = here.map(|operation| operation.setup_group.as_str());
        let at_start = machine.setup_at_start.as_deref().filter(|group| !group.is_empty());
        for group in groups.chain(at_start) {
            if matrix.group(group).is_none() && !told.contains(&group) {
                told.push(group);
                let fault = ScenarioFault::MissingPair {
                    matrix: matrix.name.clone(),
                    machine: machine.name.clone(),
                    group: group.to_owned(),
                };
                walk.fault(place.clone(), fault);
            }
        }
        if matrix.first.is_none() && machine.setup_at_start.as_deref() == Some("") {
            let fault = ScenarioFault::MissingPair {
                matrix: matrix.name.clone(),
                machine: machine.name.clone(),
                group: String::new(),
            };
            walk.fault(place.clone(), fault);
        }
    }
}
