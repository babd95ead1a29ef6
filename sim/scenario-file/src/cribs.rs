//! Tool cribs, planned maintenance, and tools of which only the life of their edges is known.

use super::fault::ScenarioFault;
use super::names::{Names, machine_indices, reference};
use super::random::distribution;
use std::collections::BTreeSet;
use std::sync::Arc;
use toolroom_form::{Fault, Section, Walk};
use toolroom_scenario::{
    Crib, DrawUnit, EdgeLife, FailureClock, Inspection, LifeOnly, LifeSpeed, MachineType, Maintenance, Operation, Part,
    Pegging, ProcessModel, Purchase, Regrind, Replenish, ToolType, Variants, Work, WorkPer, WornTool,
};
use toolroom_wear::Scatter;

/// A tool of which only the life of its edges is known.
pub(super) fn life_only(walk: &mut Walk, section: &Section<'_>, name: String) -> ToolType {
    let life = distribution(walk, section, "life");
    if life.mean() <= 0.0 {
        let example = "life = \"60 min\"";
        walk.fault(section.span_of("life"), Fault::Nothing { what: "life of an edge", example });
    }
    let at = walk.table(section, "life_at").map(|own| LifeSpeed {
        cutting_speed: own.required("cutting_speed"),
        exponent: own.required("speed_exponent"),
    });
    ToolType {
        name,
        process: ProcessModel::Other(Arc::new(LifeOnly)),
        variants: Variants::written(Vec::new()),
        parameter_set: String::new(),
        edge_cost: section.required("edge_cost"),
        dressing_time: 0.0,
        scatter: Scatter::none(),
        structure_scatter: Default::default(),
        posterior: None,
        spreads: Default::default(),
        life: Some(EdgeLife { time: life, at }),
    }
}

/// The tool of which an edge wears in plain work.
pub(super) fn worn_tool(
    walk: &mut Walk,
    section: &Section<'_>,
    (tool, life): (Option<usize>, Option<Option<LifeSpeed>>),
    (machines, indices): (&[MachineType], &[usize]),
) -> Option<WornTool> {
    let name = section.text("tool").unwrap_or_default().to_owned();
    let mut refuse = |reason: String, fix: &str| {
        walk.fault(section.span_of("tool"), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
    };
    let tool = tool?;
    let Some(life) = life else {
        let reason = format!("plain work has the tool \"{name}\", whose edges wear in passes");
        refuse(reason, "give the operation its passes in the place of `work`, or a tool of process = \"life_only\"");
        return None;
    };
    if indices.iter().any(|machine| machines[*machine].batch.is_some()) {
        let reason = format!("an edge of \"{name}\" would wear in work of a whole batch");
        refuse(reason, "take out `tool`, or `batch` of its machines: together they are not modelled");
    }
    let aging = match (section.si("cutting_speed"), life) {
        (None, _) => 1.0,
        (Some(speed), Some(life)) => life.aging(speed),
        (Some(_), None) => {
            let reason = format!("nothing says how the life of \"{name}\" falls with the cutting speed");
            let fix = "give the tool life_at = { cutting_speed = \"80 m/min\", speed_exponent = 4.0 }, or take out `cutting_speed`";
            let fault = ScenarioFault::Arrangement { reason, fix: fix.to_owned() };
            walk.fault(section.span_of("cutting_speed"), fault);
            1.0
        }
    };
    Some(WornTool { tool, aging })
}

/// Cribs; what is ground on machines of the shop becomes a part of its own behind the others.
pub(super) fn cribs(
    walk: &mut Walk,
    root: &Section<'_>,
    (names, machines): (&Names, &[MachineType]),
    tools: &[(Option<&ToolType>, bool)],
    parts: &mut Vec<Part>,
) -> Vec<Crib> {
    let mut cribs: Vec<Crib> = Vec::new();
    for section in walk.sections(root, "crib", None) {
        let Some(tool) = reference(walk, "tool", section.got("tool"), names.tools.iter().map(String::as_str)) else {
            continue;
        };
        let name = &names.tools[tool];
        if cribs.iter().any(|crib| crib.tool == tool) {
            walk.fault(section.span_of("tool"), Fault::DuplicateName { kind: "crib", name: name.clone() });
        }
        if tools[tool].0.is_some_and(|tool| matches!(tool.process, ProcessModel::Infeed(_))) {
            let reason = format!("\"{name}\" is a grinding wheel, which is dressed in its machine");
            let fix = "take out its [[crib]]".to_owned();
            walk.fault(section.span_of("tool"), ScenarioFault::Arrangement { reason, fix });
        }
        let regrind = walk.table(&section, "regrind").map(|own| {
            let stations = machine_indices(walk, &own, "station", names);
            let time = distribution(walk, &own, "time");
            if let Some(machine) = stations.iter().map(|&each| &machines[each]).find(|each| each.batch.is_some()) {
                let reason =
                    format!("\"{}\" makes batches, and would grind edges of \"{name}\" one by one", machine.name);
                let fix = "name a station without `batch`: `batch` of the regrinding says how many are sent together";
                walk.fault(own.span_of("station"), ScenarioFault::Arrangement { reason, fix: fix.to_owned() });
            }
            let part = (!stations.is_empty()).then(|| {
                let group = own.text("setup_group").map_or_else(|| format!("{name} regrind"), str::to_owned);
                parts.push(regrinding(name, stations, group, time.clone()));
                parts.len() - 1
            });
            let times = own.count("times").and_then(|times| u32::try_from(times).ok());
            if own.si("life_factor").is_some_and(|factor| factor < 1.0) && times.is_none() {
                let reason =
                    format!("edges of \"{name}\" last shorter after every regrinding, of which there is no end");
                let fix =
                    "add `times`, how often an edge is ground: in the end it would last for no time at all".to_owned();
                walk.fault(own.span_of("life_factor"), ScenarioFault::Arrangement { reason, fix });
            }
            Regrind {
                part,
                time,
                times,
                life_factor: own.required("life_factor"),
                cost: own.required("cost"),
                batch: own.count32("batch"),
            }
        });
        let buy = walk.table(&section, "buy").map(|own| Purchase {
            below: own.count32("below"),
            lot: own.count32("lot"),
            lead: own.required("lead"),
        });
        let edges = section.count32("edges");
        let wears = |operation: &Operation| {
            let program =
                matches!(&operation.work, Work::Program(work) if work.calls.iter().any(|call| call.tool == tool));
            operation.worn_tool.is_some_and(|own| own.tool == tool) || operation.tool == Some(tool) || program
        };
        let users =
            parts.iter().flat_map(|part| &part.operations).filter(|own| wears(own)).flat_map(|own| &own.machines);
        let users = users.collect::<BTreeSet<_>>().len();
        // An edge stays in its machine until it is worn, and worn ones wait until a batch is full.
        let batch = regrind.as_ref().map_or(1, |own| own.batch as usize);
        if (edges as usize) < users + batch - 1 && buy.is_none() {
            let reason = format!(
                "{users} machines use \"{name}\", whose edges are ground {batch} at a time, and there are {edges}"
            );
            let least = users + batch - 1;
            let fix = format!(
                "give at least {least}, or `buy`: an edge stays in its machine until it is worn, and worn ones wait for a whole \
                 batch, so that a machine could wait for ever"
            );
            walk.fault(section.span_of("edges"), ScenarioFault::Arrangement { reason, fix });
        }
        cribs.push(Crib { tool, edges, fetch: section.required("fetch"), regrind, buy });
    }
    cribs
}

/// The part whose one operation is the regrinding of a tool.
fn regrinding(tool: &str, machines: Vec<usize>, setup_group: String, time: toolroom_scenario::Distribution) -> Part {
    let operation = Operation {
        name: "regrind".to_owned(),
        machines,
        machine_choice: None,
        time_on: Vec::new(),
        tool: None,
        worn_tool: None,
        setup_group,
        setup_time: None,
        setup_spread: None,
        attendance: Default::default(),
        work: Work::Plain(time),
        draw: DrawUnit::Lot,
        work_per: WorkPer::Part,
        inspection: Inspection::default(),
        preemptible: true,
        assembles: false,
        size_tolerance: f64::INFINITY,
        roughness_limit: f64::INFINITY,
        scrap_on_tool_failure: 0.0,
    };
    Part {
        name: format!("{tool} regrind"),
        material_cost: 0.0,
        flow_allowance: 28_800.0, // s, that of a part for which nothing is said
        batch_size: 1,
        deviating_lot: None,
        components: Vec::new(),
        pegging: Pegging::Stock,
        replenish: Replenish::Nothing,
        random_routing: false,
        operations: vec![operation],
    }
}

/// Planned maintenance of every machine.
pub(super) fn maintenance(walk: &mut Walk, root: &Section<'_>, names: &Names) -> Vec<Maintenance> {
    let mut plans = Vec::new();
    for section in walk.sections(root, "maintenance", None) {
        let duration = distribution(walk, &section, "duration");
        let clock = section.chosen("clock", FailureClock::from_word).unwrap_or(FailureClock::Busy);
        let known = names.calendars.iter().map(String::as_str);
        let window = reference(walk, "calendar", section.got("window"), known);
        let every = section.required("every");
        for machine in machine_indices(walk, &section, "machines", names) {
            plans.push(Maintenance { machine, every, clock, duration: duration.clone(), window });
        }
    }
    plans
}
