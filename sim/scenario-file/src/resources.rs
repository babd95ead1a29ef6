//! People and setup matrices.

use super::fault::ScenarioFault;
use super::matrix::{Matrix, matrix};
use super::names::{Names, members, named, reference};
use toolroom_form::{Fault, Section, Walk, nearest};
use toolroom_scenario::{Attendance, MachineType, Operator, Part, Presence, SetupMatrix, Ways};

/// Operators, and the words for what they can do.
pub(super) fn operators(
    walk: &mut Walk,
    root: &Section<'_>,
    (names, machines): (&Names, &[MachineType]),
) -> (Vec<Operator>, Vec<String>) {
    let (mut operators, mut all): (Vec<Operator>, Vec<String>) = (Vec::new(), Vec::new());
    let sections = named(walk, root, "operator", None);
    let mut taken = sections.iter().map(|(name, _)| name.clone()).collect();
    for (name, section) in sections {
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
        let ways = ways(walk, &section, &name, machines);
        for operator_name in members(walk, "operator", (name.as_str(), &section), &mut taken) {
            let walk = ways.clone();
            let rate = section.required("rate");
            operators.push(Operator { name: operator_name, skills: skills.clone(), calendar, rate, walk });
        }
    }
    (operators, all)
}

/// The skills that an operation needs.
pub(super) fn attendance(walk: &mut Walk, operation: &Section<'_>, names: &Names) -> Attendance {
    let Some(section) = walk.table(operation, "operator") else { return Attendance::default() };
    let mut presence = Presence::Whole;
    let run = if section.text("run").is_none() && section.given("run") { walk.table(&section, "run") } else { None };
    if let Some(run) = &run {
        presence = match (run.si("share"), run.si("first")) {
            (None, None) => Presence::Whole,
            (Some(share), None) if share > 0.0 => Presence::Share(share),
            (None, Some(first)) => Presence::First(first),
            (Some(_), _) => {
                let reason = "a run has a share of a person above zero, or the first time of a piece".to_owned();
                let fix = "give one of `share` and `first`; an operation without a person has no `run`".to_owned();
                walk.fault(run.span_of("share"), ScenarioFault::Arrangement { reason, fix });
                Presence::Whole
            }
        };
    }
    let mut skill = |section: &Section<'_>, key: &'static str| {
        let name = section.text(key)?;
        let position = names.skills.iter().position(|known| known == name);
        if position.is_none() {
            let fault = ScenarioFault::SkillNobody {
                skill: name.to_owned(),
                nearest: nearest(name, names.skills.iter().map(String::as_str)).map(str::to_owned),
                known: names.skills.join(", "),
            };
            walk.fault(section.span_of(key), fault);
        }
        position
    };
    let (setup, load) = (skill(&section, "setup"), skill(&section, "load"));
    let run = match &run {
        Some(run) => skill(run, "skill"),
        None => skill(&section, "run"),
    };
    Attendance { setup, load, run, presence }
}

/// Ways of a person between machines.
fn ways(walk: &mut Walk, section: &Section<'_>, name: &str, machines: &[MachineType]) -> Option<Ways> {
    let table = walk.table(section, "walk")?;
    let Matrix { names: locations, times } = matrix(walk, &table, "locations", false)?;
    let ways = Ways { locations, times };
    let count = ways.locations.len();
    let mut refuse = |key: &str, reason: String, fix: &str| {
        walk.fault(table.span_of(key), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    if ways.times.len() != count || ways.times.iter().any(|row| row.len() != count) {
        let reason = format!("the ways of \"{name}\" are no table of {count} rows and {count} columns");
        refuse("times", reason, "give a row for every location, with a time to every location");
        return None;
    }
    if let Some(machine) = machines.iter().find(|machine| ways.location(&machine.location).is_none()) {
        let reason = format!("the ways of \"{name}\" do not lead to \"{}\"", machine.location);
        refuse("locations", reason, "name the place of every machine: its `location`, or the name of its section");
    }
    Some(ways)
}

/// Setup matrices; a bad one is left as it is read.
pub(super) fn setup_matrices(walk: &mut Walk, root: &Section<'_>, names: &mut Names) -> Vec<SetupMatrix> {
    let mut matrices = Vec::new();
    for (name, section) in named(walk, root, "setup_matrix", None) {
        names.setup_matrices.push(name.clone());
        let Some(Matrix { names: groups, mut times }) = matrix(walk, &section, "groups", true) else {
            // Left as it is known, so that references to it hold.
            matrices.push(SetupMatrix { name, groups: Vec::new(), first: None, times: Vec::new() });
            continue;
        };
        for (i, group) in groups.iter().enumerate().filter(|(i, group)| groups[..*i].contains(group)) {
            let place = section.list("groups").get(i).map_or(section.span.clone(), |got| got.span.clone());
            walk.fault(place, Fault::DuplicateName { kind: "setup group", name: group.clone() });
        }
        let rows = section.list("times");
        if ![groups.len(), groups.len() + 1].contains(&times.len()) {
            refuse(walk, section.span_of("times"), ("times", times.len(), "rows"), groups.len());
        }
        for (got, times) in rows.iter().zip(&times).filter(|(_, times)| times.len() != groups.len()) {
            refuse(walk, got.span.clone(), ("times", times.len(), "entries in a row"), groups.len());
        }
        let first = (times.len() == groups.len() + 1).then(|| times.remove(0));
        matrices.push(SetupMatrix { name, groups, first, times });
    }
    matrices
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
        if matrix.groups.is_empty() {
            continue; // a problem was noted
        }
        let mut missing: Vec<&str> = Vec::new();
        let here = parts.iter().flat_map(|part| &part.operations).filter(|own| own.machines.contains(&index));
        let groups = here.map(|operation| operation.setup_group.as_str());
        let at_start = machine.setup_at_start.as_deref().filter(|group| !group.is_empty());
        for group in groups.chain(at_start) {
            if matrix.group(group).is_none() && !missing.contains(&group) {
                missing.push(group);
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
