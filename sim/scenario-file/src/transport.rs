//! Crews and vehicles.

use super::fault::ScenarioFault;
use super::matrix::{Matrix, matrix};
use super::names::{Names, named, reference};
use toolroom_form::{Fault, Section, Walk, nearest};
use toolroom_scenario::{Buffer, Crew, Distribution, MachineType, Parking, Part, Transport, TransportRule};

/// Crews.
pub(super) fn crews(walk: &mut Walk, root: &Section<'_>, names: &mut Names) -> Vec<Crew> {
    let mut crews = Vec::new();
    for (name, section) in named(walk, root, "crew", None) {
        names.crews.push(name.clone());
        let calendar = reference(walk, "calendar", section.got("calendar"), names.calendars.iter().map(String::as_str));
        crews.push(Crew { name, count: section.count32("count"), calendar, rate: section.required("rate") });
    }
    crews
}

/// Vehicles; a bad one is left as it is read.
pub(super) fn transports(walk: &mut Walk, root: &Section<'_>, machines: &[MachineType]) -> Vec<Transport> {
    let mut transports = Vec::new();
    for (name, section) in named(walk, root, "transport", None) {
        let Some(Matrix { names: locations, mut times }) = matrix(walk, &section, "locations", false) else { continue };
        for (i, location) in locations.iter().enumerate() {
            let place = section.list("locations").get(i).map_or(section.span.clone(), |got| got.span.clone());
            if locations[..i].contains(location) {
                walk.fault(place, Fault::DuplicateName { kind: "location", name: location.clone() });
            } else if !machines.iter().any(|machine| machine.location == *location) {
                let mut known: Vec<&str> = machines.iter().map(|machine| machine.location.as_str()).collect();
                known.dedup();
                let fault = Fault::UnknownName {
                    kind: "location",
                    name: location.clone(),
                    nearest: nearest(location, known.iter().copied()).map(str::to_owned),
                    known: known.join(", "),
                };
                walk.fault(place, fault);
            }
        }
        let count = locations.len();
        if times.len() != count || times.iter().any(|row| row.len() != count) {
            let reason = format!("the times of transport \"{name}\" are no table of {count} rows and {count} columns");
            let fix = "give a row for every location, with a time to every location".to_owned();
            walk.fault(section.span_of("times"), ScenarioFault::Arrangement { reason, fix });
            times = vec![vec![0.0; count]; count];
        }
        transports.push(Transport {
            name,
            count: section.count32("count"),
            locations,
            times,
            park: section.chosen("park", Parking::from_word).unwrap_or(Parking::Stay),
            rule: section.chosen("rule", TransportRule::from_word).unwrap_or(TransportRule::Fifo),
            capacity: section.count32("capacity"),
        });
    }
    transports
}

/// Finds what vehicles could not do.
pub(super) fn check(
    walk: &mut Walk,
    root: &Section<'_>,
    (transports, move_time): (&[Transport], &Distribution),
    machines: &[MachineType],
    parts: &[Part],
    buffers: &[Buffer],
) {
    if move_time.mean() > 0.0 && !buffers.is_empty() {
        let reason = "moves take time in a shop with limited buffers".to_owned();
        let fix = "take out the limits of the buffers, or `move_time`: together they are not modelled".to_owned();
        walk.fault(root.span_of("shop"), ScenarioFault::Arrangement { reason, fix });
    }
    if transports.is_empty() {
        return;
    }
    let mut refuse = |reason: String, fix: &str| {
        walk.fault(root.span_of("transport"), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    if !buffers.is_empty() {
        let reason = "vehicles carry jobs in a shop with limited buffers".to_owned();
        refuse(reason, "take out the limits of the buffers, or [[transport]]: together they are not modelled");
    }
    for part in parts {
        for operation in &part.operations {
            let mut places = operation.machines.iter().map(|machine| machines[*machine].location.as_str());
            let first = places.next();
            if places.any(|place| Some(place) != first) {
                let reason = format!(
                    "the machines of operation \"{}\" of part \"{}\" stand at several places, but jobs are carried to one",
                    operation.name, part.name
                );
                refuse(reason, "give its machines the same `location`");
            }
        }
    }
}
