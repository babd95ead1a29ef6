//! Parts and their operations.

use super::choices::{ProcessKind, RoutingWord};
use super::control;
use super::cribs;
use super::fault::ScenarioFault;
use super::jobs;
use super::names::{NamedTool, Names, machine_indices, named, reference};
use super::planned::{contour, cycle, program};
use super::random::distribution;
use super::required::due;
use super::resources::attendance;
use super::{shared, stocks};
use std::f64::consts::PI;
use toolroom_form::{Fault, Kind, Quantity, Section, Value, Walk, display, significant};
use toolroom_scenario::{
    Cut, Distribution, DrawUnit, GrindingPhase, Inspection, MachineChoice, MachineType, Operation, Part, Pegging,
    ProcessModel, ToolType, Work, WorkPer,
};

pub(super) fn parts(
    walk: &mut Walk,
    root: &Section<'_>,
    names: &mut Names,
    machines: &[MachineType],
    tools: &[NamedTool],
) -> Vec<Part> {
    let (mut parts, mut sections) = (Vec::new(), Vec::new());
    let mut used = vec![false; tools.len()];
    for (name, section) in named(walk, root, "part", Some("[[part]] with name and at least one [[part.operation]]")) {
        names.parts.push(name.clone());
        let operations = operations(walk, &section, &name, names, machines, tools, &mut used);
        parts.push(Part {
            name,
            material_cost: section.required("material_cost"),
            flow_allowance: section.required("flow_allowance"),
            batch_size: section.count32("batch_size"),
            deviating_lot: section.count("deviating_lot").and_then(|lot| u32::try_from(lot).ok()),
            components: Vec::new(),
            pegging: section.chosen("pegging", Pegging::from_word).unwrap_or_default(),
            replenish: stocks::replenish(walk, &section),
            random_routing: section.chosen("routing", RoutingWord::from_word) == Some(RoutingWord::Random),
            operations,
        });
        sections.push(section);
    }
    jobs::components(walk, &sections, names, &mut parts);
    for (i, tool) in tools.iter().enumerate().filter(|(i, _)| !used[*i]) {
        let reason = "no operation names it".to_owned();
        walk.fault(tool.span.clone(), ScenarioFault::UnusedTool { tool: names.tools[i].clone(), reason });
    }
    parts
}

fn operations(
    walk: &mut Walk,
    part: &Section<'_>,
    part_name: &str,
    names: &mut Names,
    machines: &[MachineType],
    tools: &[NamedTool],
    used: &mut [bool],
) -> Vec<Operation> {
    let (mut operations, mut sections): (Vec<Operation>, Vec<Section<'_>>) = (Vec::new(), Vec::new());
    let Some(Value::Raw(toml::de::DeValue::Array(raw))) = part.got("operation").map(|got| &got.value) else {
        if part.got("operation").is_none() {
            walk.fault(part.span.clone(), ScenarioFault::NoOperation { part: part_name.to_owned() });
        }
        return operations;
    };
    if raw.is_empty() {
        walk.fault(part.span_of("operation"), ScenarioFault::NoOperation { part: part_name.to_owned() });
    }
    let Some(Kind::Tables(form)) = part.form.key("operation").map(|key| key.kind) else { return operations };
    for (i, entry) in raw.iter().enumerate() {
        let Some(table) = entry.get_ref().as_table() else {
            walk.wrong_type("operation", entry.get_ref(), "a table", entry.span(), form.title.to_owned());
            continue;
        };
        // Which keys apply hangs on the process of the tool, which the section only names.
        let tool_name = table.get("tool").and_then(|tool| tool.get_ref().as_str());
        let tool_index = names.tools.iter().position(|name| Some(name.as_str()) == tool_name);
        // A part program calls its tools by itself; only mills run one.
        let programmed = table.contains_key("program");
        let of_tool = tool_index.and_then(|tool| tools[tool].process);
        let process = if programmed { Some(ProcessKind::Milling) } else { of_tool };
        let unnamed = if table.contains_key("name") { String::new() } else { format!(" {}", i + 1) };
        let path = format!("{}, operation{unnamed}", part.path);
        let plain = table.contains_key("work");
        let case = if plain { Some(MachineType::PLAIN) } else { process.map(ProcessKind::word) };
        let case = case.map(|word| ("process", word));
        let section = walk.section(form, &path, table, entry.span(), case);
        let name = section.text("name").unwrap_or_default().to_owned();
        if operations.iter().any(|other| other.name == name) {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: "operation", name: name.clone() });
        }
        if !plain && !programmed && !table.contains_key("tool") {
            let example = "\"insert\"` or `work = \"5 min\"".to_owned();
            let section = form.title.to_owned();
            walk.fault(entry.span(), Fault::MissingKey { section, key: "tool", example });
        }
        let tool = reference(walk, "tool", section.got("tool"), names.tools.iter().map(String::as_str));
        if let Some(tool) = tool {
            used[tool] = true;
        }
        let candidates = machine_indices(walk, &section, "machines", names);
        let able = if plain {
            if candidates.is_empty() && section.got("machines").is_some_and(|got| !matches!(got.value, Value::Faulty)) {
                let reason = format!("operation \"{name}\" names no machine");
                let fix = "write the machines that may do it: machines = [\"T\"]".to_owned();
                walk.fault(section.span_of("machines"), ScenarioFault::Arrangement { reason, fix });
            }
            candidates
        } else {
            let named = tool_name.or(section.text("program")).unwrap_or_default();
            able_machines(walk, &section, &name, &candidates, machines, named, process)
        };
        let known = tool.and_then(|tool| tools[tool].tool.as_ref());
        let model = known.map(|tool| &tool.process);
        let work = match process {
            _ if plain => Work::Plain(distribution(walk, &section, "work")),
            Some(ProcessKind::Infeed) => grinding(walk, &section, model),
            Some(ProcessKind::Milling) if programmed => {
                let types: Vec<Option<&ToolType>> = tools.iter().map(|tool| tool.tool.as_ref()).collect();
                program(walk, &section, &types, &names.tools).map_or(Work::Cutting(Vec::new()), Work::Program)
            }
            Some(ProcessKind::Milling) if section.given("contour") => {
                let machine = able.first().map(|machine| &machines[*machine]);
                contour(walk, &section, known, machine).unwrap_or(Work::Cutting(Vec::new()))
            }
            Some(process @ (ProcessKind::Turning | ProcessKind::Milling)) => {
                cutting(walk, &section, process, &able, machines, model)
            }
            None => Work::Cutting(Vec::new()),
        };
        let mut first = tool;
        if let Work::Program(work) = &work {
            work.calls.iter().for_each(|call| used[call.tool] = true);
            first = work.calls.first().map(|call| call.tool);
        }
        let life = |tool: &NamedTool| tool.life_only.then(|| tool.tool.as_ref()?.life.as_ref()?.at);
        let worn = tool.filter(|_| plain).map(|tool| (Some(tool), life(&tools[tool])));
        if plain && tool.is_none() && section.given("cutting_speed") {
            let reason = "plain work without a tool has no cutting speed".to_owned();
            let fix = "take out `cutting_speed`, or name the `tool` whose edge wears".to_owned();
            walk.fault(section.span_of("cutting_speed"), ScenarioFault::Arrangement { reason, fix });
        }
        let worn_tool = worn.and_then(|own| cribs::worn_tool(walk, &section, own, (machines, &able)));
        if let Some(tool) = tool.filter(|tool| !plain && tools[*tool].life_only) {
            let reason = format!("\"{}\" cuts nothing of which more is known than a time", names.tools[tool]);
            let fix = "give the operation `work`, a time, in the place of its passes".to_owned();
            walk.fault(section.span_of("tool"), ScenarioFault::Arrangement { reason, fix });
        }
        let spread = section.given("setup_time") && section.si("setup_time").is_none();
        let setup_spread = spread.then(|| distribution(walk, &section, "setup_time"));
        let time_on = control::time_on(walk, &section, names, &able);
        let mut operation = Operation {
            name,
            machine_choice: section.chosen("machine_choice", MachineChoice::from_word),
            time_on,
            machines: able,
            tool: if plain { None } else { Some(first.unwrap_or(0)) },
            worn_tool,
            setup_group: section.text("setup_group").unwrap_or(part_name).to_owned(),
            setup_time: setup_spread.as_ref().map(Distribution::mean).or(section.si("setup_time")),
            setup_spread,
            attendance: attendance(walk, &section, names),
            work,
            work_per: WorkPer::Part,
            draw: DrawUnit::Lot,
            inspection: Inspection::default(),
            preemptible: true,
            assembles: false,
            size_tolerance: section.si("size_tolerance").unwrap_or(f64::INFINITY),
            roughness_limit: section.si("roughness_limit").unwrap_or(f64::INFINITY),
            scrap_on_tool_failure: section.si("scrap_on_tool_failure").unwrap_or(0.0),
        };
        jobs::flow(walk, &section, &mut operation, machines);
        if operation.draw == DrawUnit::Part && operation.has_own_times() {
            let reason = "pieces with times of their own have one distribution on all machines".to_owned();
            let fix = "take out `draw = \"part\"`, or give `time_on` factors".to_owned();
            walk.fault(section.span_of("time_on"), ScenarioFault::Arrangement { reason, fix });
        }
        operations.push(operation);
        sections.push(section);
    }
    let all: Vec<String> = operations.iter().map(|operation| operation.name.clone()).collect();
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    let part_index = names.parts.len() - 1;
    for (index, section) in sections.iter().enumerate() {
        operations[index].inspection = jobs::inspection(walk, section, &all, index);
        shared::hold(walk, section, &all, (part_index, index), &mut names.fixtures);
    }
    operations
}

/// Machines of the tool's process; the others are faults.
fn able_machines(
    walk: &mut Walk,
    section: &Section<'_>,
    operation: &str,
    candidates: &[usize],
    machines: &[MachineType],
    tool: &str,
    process: Option<ProcessKind>,
) -> Vec<usize> {
    let Some(process) = process else { return candidates.to_vec() };
    let process = process.word();
    let fits = |machine: &&usize| machines[**machine].process == process || machines[**machine].process.is_empty();
    let able: Vec<usize> = candidates.iter().filter(fits).copied().collect();
    for machine in candidates.iter().filter(|machine| !fits(machine)) {
        let fault = ScenarioFault::WrongProcess {
            operation: operation.to_owned(),
            tool: tool.to_owned(),
            tool_process: process.to_owned(),
            machine: machines[*machine].name.clone(),
            machine_process: machines[*machine].process.clone(),
        };
        walk.fault(section.span_of("machines"), fault);
    }
    if able.is_empty() && section.got("machines").is_some_and(|got| !matches!(got.value, Value::Faulty)) {
        walk.fault(section.span_of("machines"), ScenarioFault::NoMachine { operation: operation.to_owned() });
    }
    able
}

fn grinding(walk: &mut Walk, section: &Section<'_>, model: Option<&ProcessModel>) -> Work {
    if section.given("cycle") {
        let nothing = Work::Grinding { work_rotation_speed: f64::NAN, phases: Vec::new() };
        return cycle(walk, section, model).unwrap_or(nothing);
    }
    if section.given("wear_compensation") {
        let case = "a cycle given by its phases, which is positioned by command".to_owned();
        let fault = Fault::NotApplicable { key: "wear_compensation", case, applicable: "cycle, phase".to_owned() };
        walk.fault(section.span_of("wear_compensation"), fault);
    }
    let work_rotation_speed = due(walk, section, section, "work_rotation_speed", "292 rpm");
    if section.got("phase").is_none() {
        let example = "[{ infeed_per_rev = \"4.4 um/rev\", revolutions = 12 }]".to_owned();
        walk.fault(
            section.span.clone(),
            Fault::MissingKey { section: section.form.title.to_owned(), key: "phase", example },
        );
    }
    let phases: Vec<GrindingPhase> = walk
        .sections(section, "phase", None)
        .iter()
        .map(|phase| GrindingPhase {
            infeed_per_rev: phase.required("infeed_per_rev"),
            revolutions: phase.count32("revolutions"),
        })
        .collect();
    if phases.iter().all(|phase| phase.infeed_per_rev == 0.0) && section.given("phase") {
        let example = "a phase with infeed: phase = [{ infeed_per_rev = \"4.4 um/rev\", revolutions = 12 }]";
        walk.fault(section.span_of("phase"), Fault::Nothing { what: "infeed", example });
    }
    Work::Grinding { work_rotation_speed, phases }
}

fn cutting(
    walk: &mut Walk,
    section: &Section<'_>,
    process: ProcessKind,
    able: &[usize],
    machines: &[MachineType],
    model: Option<&ProcessModel>,
) -> Work {
    let passes = walk.sections(section, "pass", Some(("process", process.word())));
    if section.given("passes") && section.given("pass") {
        let case = "an operation with [[part.operation.pass]]".to_owned();
        let fault = Fault::NotApplicable { key: "passes", case, applicable: "one of passes, pass".to_owned() };
        walk.fault(section.span_of("passes"), fault);
    }
    let cuts: Vec<(Cut, &Section<'_>)> = if passes.is_empty() {
        let cut = cut(walk, section, section, process);
        (0..section.count32("passes")).map(|_| (cut, section)).collect()
    } else {
        let mut cuts = Vec::with_capacity(passes.len());
        for pass in &passes {
            cuts.push((cut(walk, pass, section, process), pass));
        }
        cuts
    };
    let mut last = None;
    for (cut, place) in &cuts {
        if last != Some(cut) {
            check(walk, cut, place, section, able, machines, model);
        }
        last = Some(cut);
    }
    Work::Cutting(cuts.iter().map(|(cut, _)| *cut).collect())
}

/// One pass; what it leaves out is the operation's.
fn cut(walk: &mut Walk, pass: &Section<'_>, operation: &Section<'_>, process: ProcessKind) -> Cut {
    let mut due = |key, example| due(walk, pass, operation, key, example);
    let cutting_speed = due("cutting_speed", "60 m/min");
    let depth_of_cut = due("depth_of_cut", "0.75 mm");
    let turning = process == ProcessKind::Turning;
    let (feed, width_of_cut) = if turning {
        (due("feed_per_rev", "0.12 mm/rev"), 0.0)
    } else {
        (due("feed_per_tooth", "0.1 mm/tooth"), due("width_of_cut", "30 mm"))
    };
    // The pass decides how its path is given; only then the operation.
    let decides = |section: &Section<'_>| ["path_length", "diameter", "length"].iter().any(|key| section.given(key));
    let from = if decides(pass) { pass } else { operation };
    let geometry = turning && (from.given("diameter") || from.given("length"));
    let path_length = if geometry {
        PI * due("diameter", "120 mm") * due("length", "40 mm") / feed
    } else {
        due("path_length", if turning { "75 m" } else { "1.2 m" })
    };
    if geometry && from.given("path_length") {
        let case = "a pass with diameter and length, from which the path follows".to_owned();
        let applicable = "diameter and length, or path_length".to_owned();
        walk.fault(from.span_of("path_length"), Fault::NotApplicable { key: "path_length", case, applicable });
    }
    let optional = |key| pass.si(key).or_else(|| operation.si(key)).unwrap_or(0.0);
    let (diameter, position) = if turning { (optional("diameter"), optional("position")) } else { (0.0, 0.0) };
    Cut { cutting_speed, feed, depth_of_cut, width_of_cut, path_length, diameter, position }
}

/// A pass against the speed range of its machines and the ranges of its process model.
fn check(
    walk: &mut Walk,
    cut: &Cut,
    pass: &Section<'_>,
    operation: &Section<'_>,
    able: &[usize],
    machines: &[MachineType],
    model: Option<&ProcessModel>,
) {
    let span = |key: &str| if pass.given(key) { pass.span_of(key) } else { operation.span_of(key) };
    let speed = Quantity { unit: "m/s", display: "m/min", min: 0.0, max: 1.0, above: true, example: "" };
    for machine in able {
        let (low, high) = machines[*machine].speed_range;
        if cut.cutting_speed < low || cut.cutting_speed > high {
            let name = &machines[*machine].name;
            let fault = Fault::OutOfRange {
                key: "cutting_speed".to_owned(),
                read: display(&speed, cut.cutting_speed),
                range: format!("{} to {}, the speed_range of {name}", display(&speed, low), display(&speed, high)),
                meant: Vec::new(),
            };
            walk.fault(span("cutting_speed"), fault);
        }
    }
    let Some(model) = model else { return };
    // Cutting speeds at which the structure of the tool is known, where its modes change with the spindle speed.
    let known = match model {
        ProcessModel::Milling(milling) => milling
            .structure
            .as_ref()
            .and_then(|structure| structure.speeds())
            .map(|(least, greatest)| (least, greatest, 0.5 * milling.cutter.diameter)),
        ProcessModel::Turning(turning) => turning
            .structure
            .as_ref()
            .and_then(|structure| structure.speeds())
            .map(|(least, greatest)| (least, greatest, 0.5 * cut.diameter)),
        ProcessModel::Infeed(_) | ProcessModel::Other(_) => None,
    };
    if let Some((least, greatest, radius)) = known
        && radius > 0.0
        && !(least * radius..=greatest * radius).contains(&cut.cutting_speed)
    {
        let fault = Fault::OutOfRange {
            key: "cutting_speed".to_owned(),
            read: display(&speed, cut.cutting_speed),
            range: format!(
                "{} to {}, the spindle speeds of [[speed]] in the structure of the tool",
                display(&speed, least * radius),
                display(&speed, greatest * radius)
            ),
            meant: Vec::new(),
        };
        walk.fault(span("cutting_speed"), fault);
    }
    let millimetres = |value: f64| format!("{} mm", significant(value * 1e3));
    if let ProcessModel::Milling(milling) = model
        && cut.width_of_cut > milling.cutter.diameter
    {
        let fault = Fault::Contradiction {
            first: "width_of_cut",
            first_value: millimetres(cut.width_of_cut),
            second: "diameter of the cutter",
            second_value: millimetres(milling.cutter.diameter),
            rule: "a slot as wide as the cutter is the widest cut",
        };
        walk.fault(span("width_of_cut"), fault);
    }
    if let ProcessModel::Turning(turning) = model
        && let Some(structure) = &turning.structure
    {
        if cut.diameter == 0.0 {
            let section = "[[part.operation]] of a tool with a structure".to_owned();
            let fault = Fault::MissingKey { section, key: "diameter", example: "\"40 mm\"".to_owned() };
            walk.fault(pass.span.clone(), fault);
        }
        if let Some(length) = structure.bar_length().filter(|length| cut.position > *length) {
            let fault = Fault::Contradiction {
                first: "position",
                first_value: millimetres(cut.position),
                second: "length of the bar",
                second_value: millimetres(length),
                rule: "the tool is on the bar",
            };
            walk.fault(span("position"), fault);
        }
    }
    let inputs = model.machine_process().inputs();
    let values = [
        ("cutting_speed", cut.cutting_speed),
        ("feed_per_rev", cut.feed),
        ("feed_per_tooth", cut.feed),
        ("depth_of_cut", cut.depth_of_cut),
        ("width_of_cut", cut.width_of_cut),
    ];
    for (key, value) in values {
        let Some(field) = inputs.iter().find(|field| field.name == key) else { continue };
        if value.is_nan() {
            continue; // noted before
        }
        if let Err(reason) = field.check(value) {
            walk.fault(span(key), Fault::Model { subject: operation.path.clone(), reason });
        }
    }
}
