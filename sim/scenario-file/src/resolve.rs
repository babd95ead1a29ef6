//! From sections to the resolved scenario: names become indices, contradictions are found.

use super::calendars::{calendars, end_of_run, start};
use super::choices::{LIFE_ONLY, ProcessKind};
use super::fault::ScenarioFault;
use super::names::{NamedTool, Names, members, named, reference};
use super::queue_rules::queue_rules;
use super::random::distribution;
use super::variants::{ShopVariant, variants};
use super::{
    Output, Statistics, control, cribs, failures, flow, jobs, measured, orders, planned, processes, progress,
    resources, routing, rules, schedule, shared, stability, stocks, transport, tune,
};
use std::sync::Arc;
use toolroom_effects::read_definitions;
use toolroom_form::{Fault, Section, Span, Value, Walk, nearest};
use toolroom_process::Record;
use toolroom_scenario::{
    BatchUnit, Buffer, Calibration, CalibrationShift, Distribution, GapSection, MachineType, Scenario, Shared,
    ShiftCalendar, Target, ToolType, TuneRequest, Variants,
};

/// Horizon of a file whose own is left out or cannot be read, s: so long that nothing is told to lie beyond it (assumption: ten
/// years).
const UNREAD_HORIZON: f64 = 10.0 * 365.0 * 86_400.0;

/// What a file says.
pub(super) struct ScenarioContent {
    pub scenario: Scenario,
    pub output: Output,
    pub gap: Option<GapSection>,
    pub tune: Option<TuneRequest>,
    pub variants: Vec<ShopVariant>,
    pub statistics: Statistics,
}

/// Resolves a whole file; `None` only where `[shop]` is no section.
pub(super) fn scenario(walk: &mut Walk, root: &Section<'_>) -> Option<ScenarioContent> {
    let shop = walk.table(root, "shop");
    let currency = shop.as_ref().and_then(|shop| shop.text("currency")).unwrap_or("EUR").to_owned();
    walk.currency.clone_from(&currency);
    let mut names = Names::of(root);
    let start = shop.as_ref().and_then(|shop| start(walk, shop));
    let horizon = shop.as_ref().and_then(|shop| end_of_run(walk, shop, start)).unwrap_or(UNREAD_HORIZON);
    let calendars = calendars(walk, root, &mut names, start, horizon);
    let most_shifts = calendars.iter().map(ShiftCalendar::shift_count).max().unwrap_or(0);
    names.shifts = (1..=most_shifts).map(|number| format!("S{number}")).collect();
    let setup_matrices = resources::setup_matrices(walk, root, &mut names);
    let (mut machines, buffers) = machines(walk, root, &mut names);
    let buffers = flow::shared(walk, root, &names, &mut machines, buffers);
    let (operators, skills) = resources::operators(walk, root, (&names, &machines));
    names.skills = skills;
    let crews = transport::crews(walk, root, &mut names);
    let transports = transport::transports(walk, root, &machines);
    let move_time = match &shop {
        Some(shop) if shop.given("move_time") => distribution(walk, shop, "move_time"),
        Some(_) | None => Distribution::Constant(0.0),
    };
    names.fixtures = shared::fixtures(walk, root);
    names.defined = read_definitions(walk, root);
    let tools = tools(walk, root, &mut names);
    processes::check_edges(walk, root, &tools, &machines);
    let mut parts = routing::parts(walk, root, &mut names, &machines, &tools);
    let known: Vec<_> = tools.iter().map(|tool| (tool.tool.as_ref(), tool.life_only)).collect();
    let named = parts.len();
    let cribs = cribs::cribs(walk, root, (&names, &machines), &known, &mut parts);
    names.all.add(&parts[named..]);
    let maintenance = cribs::maintenance(walk, root, &names);
    let arrivals = rules::arrivals(walk, root, &names);
    let tables = walk.table(root, "tables");
    let tables = tables.as_ref();
    let around = orders::Around { names: &names, machines: &machines, parts: &parts, tables, start, horizon };
    let (orders, order_places) = orders::orders(walk, root, &around);
    if let Some(tables) = tables.filter(|tables| tables.given("orders"))
        && orders.is_empty()
        && arrivals.is_empty()
        && walk.problems.is_empty()
    {
        let example = "a row of the table for each order, or [[arrivals]] with part and pattern";
        walk.fault(tables.span_of("orders"), Fault::Nothing { what: "order in the table", example });
    }
    let stocks = stocks::stocks(walk, root, &names, &parts);
    stocks::check_parents(walk, root, &parts, (&orders, &arrivals));
    let ruled = walk.table(root, "dispatch");
    let dispatch = rules::dispatch(walk, ruled.as_ref());
    let mut control = control::control(walk, (root, ruled.as_ref()), &names, (&parts, &orders));
    let planned = (orders.as_slice(), arrivals.len());
    control.schedule = schedule::schedule(walk, root, &around, planned, dispatch.preemption);
    let failures = failures::failures(walk, root, &names);
    let (policies, places): (Vec<_>, Vec<_>) = rules::policies(walk, root, &machines).into_iter().unzip();
    let output = rules::output(walk, root);
    let gap = rules::gap(walk, root);
    let seed = shop.as_ref().and_then(|shop| shop.count("seed")).unwrap_or(1);
    let tune = tune::request(walk, root, seed);
    let deviations = measured::deviations(walk, root, &names);
    let calibrations = measured::calibrations(walk, root, &names);
    let tools: Vec<ToolType> = tools.into_iter().filter_map(|tool| tool.tool).collect();
    let tools = tools.into_iter().map(|tool| varied(walk, tool, &calibrations)).collect();
    let calibrations = calibrations.into_iter().map(|(calibration, _)| calibration).collect();
    resources::check_pairs(walk, root, &machines, &parts, &setup_matrices);
    flow::check(walk, root, &dispatch, &machines, &buffers, (&parts, &orders, &order_places));
    let around = jobs::Around {
        machines: &machines,
        buffers: &buffers,
        parts: &parts,
        arrivals: &arrivals,
        orders: &orders,
        stocks: &stocks,
        blocking: dispatch.blocking,
        rules: &dispatch.rules,
        preemption: dispatch.preemption,
    };
    jobs::check(walk, root, &around);
    transport::check(walk, root, (&transports, &move_time), &machines, &parts, &buffers);
    shared::check(walk, root, &names.fixtures, &around);
    shared::check_shift_ends(walk, root, (&machines, &parts), &calendars);
    stocks::check(walk, root, &around, &control);
    shared::check_paces(walk, root, (&machines, &parts), (&operators, &calendars));
    let shared = Shared { fixtures: std::mem::take(&mut names.fixtures), cribs, stocks };
    let variants = variants(walk, root, (start, horizon));
    let shop = shop?;
    if let Some(warm_up) = shop.si("warm_up").filter(|warm_up| *warm_up >= horizon) {
        let hours = |seconds: f64| format!("{} h", seconds / 3600.0);
        let fault = Fault::Contradiction {
            first: "warm_up",
            first_value: hours(warm_up),
            second: "horizon",
            second_value: hours(horizon),
            rule: "the warm-up ends before the horizon, or nothing is counted",
        };
        walk.fault(shop.span_of("warm_up"), fault);
    }
    for (code, span) in std::mem::take(&mut walk.currencies) {
        if code != currency {
            walk.fault(span, Fault::MixedCurrency { read: code.to_owned(), expected: currency.clone() });
        }
    }
    let scenario = Scenario {
        name: shop.text("name").unwrap_or_default().to_owned(),
        title: shop.text("title").unwrap_or_default().to_owned(),
        start,
        seed,
        replications: shop.count32("replications"),
        horizon,
        warm_up: shop.si("warm_up").unwrap_or(0.0),
        seeks_warm_up: shop.text("warm_up").is_some(),
        shift_length: shop.required("shift_length"),
        machines,
        tools,
        parts,
        arrivals,
        orders,
        skills: names.skills,
        operators,
        crews,
        transports,
        move_time,
        shared,
        setup_matrices,
        machine_choice: dispatch.choice,
        buffers,
        blocking: dispatch.blocking,
        deadlock: dispatch.deadlock,
        dispatch: dispatch.rules,
        control,
        preemption: dispatch.preemption,
        calendars,
        failures,
        maintenance,
        policies,
        deviations,
        calibrations,
        defined: names.defined,
        currency,
        branch: None,
    };
    let warms_up = scenario.seeks_warm_up || scenario.warm_up > 0.0 && !scenario.orders.is_empty();
    if warms_up && scenario.is_terminating() {
        let reason = "a shop that ends with its orders or given jobs settles into nothing".to_owned();
        let fix = "take out `warm_up`: all of the run counts; or let jobs come from a source that goes on".to_owned();
        walk.fault(shop.span_of("warm_up"), ScenarioFault::Arrangement { reason, fix });
    }
    planned::policies(walk, &scenario, &places);
    progress::check(walk, root, &scenario);
    let statistics = rules::statistics(walk, root);
    Some(ScenarioContent { scenario, output, gap, tune, variants, statistics })
}

fn machines(walk: &mut Walk, root: &Section<'_>, names: &mut Names) -> (Vec<MachineType>, Vec<Buffer>) {
    let (mut machines, mut buffers): (Vec<MachineType>, Vec<Buffer>) = (Vec::new(), Vec::new());
    let example = "[[machine]] with name, process, rate, load_time, unload_time";
    let sections = named(walk, root, "machine", Some(example));
    let mut taken = sections.iter().map(|(name, _)| name.clone()).collect();
    for (name, section) in sections {
        let calendar = reference(walk, "calendar", section.got("calendar"), names.calendars.iter().map(String::as_str));
        let matrices = names.setup_matrices.iter().map(String::as_str);
        let setup_matrix = reference(walk, "setup_matrix", section.got("setup_matrix"), matrices);
        let load_time = distribution(walk, &section, "load_time");
        let unload_time = distribution(walk, &section, "unload_time");
        let speed_range = speed_range(walk, &section);
        let own_rules = queue_rules(walk, &section);
        let batch = jobs::batch(walk, &section);
        let worn = walk.sections(&section, "edge_at_start", None);
        let known = || names.all.tools.iter().map(String::as_str);
        let mut edge =
            |own: &Section<'_>| Some((reference(walk, "tool", own.got("tool"), known())?, own.required("flank_wear")));
        let edges_at_start: Vec<(usize, f64)> = worn.iter().filter_map(&mut edge).collect();
        let mut indices = Vec::new();
        for machine_name in members(walk, "machine", (name.as_str(), &section), &mut taken) {
            indices.push(machines.len());
            names.each_machine.push(machine_name.clone());
            if section.given("count") {
                names.machines.push((machine_name.clone(), vec![machines.len()]));
            }
            machines.push(MachineType {
                name: machine_name,
                process: section.text("process").unwrap_or_default().to_owned(),
                rate: section.required("rate"),
                load_time: load_time.clone(),
                unload_time: unload_time.clone(),
                tool_change_time: section.required("tool_change_time"),
                setup_time: section.required("setup_time"),
                setup_matrix,
                setup_at_start: section.text("setup_at_start").map(str::to_owned),
                edges_at_start: edges_at_start.clone(),
                magazine: section.count32("magazine"),
                refill_time: section.required("refill_time"),
                speed_range,
                idle_power: section.required("idle_power"),
                coolant_change: section.si("coolant_change"),
                calendar,
                input_buffer: None,
                output_buffer: None,
                location: section.text("location").unwrap_or(&name).to_owned(),
                batch,
                rules: own_rules.clone(),
            });
        }
        for (key, behind) in [("input_buffer", false), ("output_buffer", true)] {
            let Some(places) = section.count(key) else { continue };
            for &machine in &indices {
                let kind = &mut machines[machine];
                *(if behind { &mut kind.output_buffer } else { &mut kind.input_buffer }) = Some(buffers.len());
            }
            let unit = section.chosen("buffer_unit", BatchUnit::from_word).unwrap_or(BatchUnit::Lots);
            buffers.push(Buffer { name: name.clone(), places: places as u32, unit, machines: indices.clone() });
        }
        names.machines.push((name, indices));
    }
    (machines, buffers)
}

fn speed_range(walk: &mut Walk, section: &Section<'_>) -> (f64, f64) {
    let speeds: Vec<f64> = section
        .list("speed_range")
        .iter()
        .filter_map(|got| if let Value::Si(speed) = got.value { Some(speed) } else { None })
        .collect();
    match (section.list("speed_range").len(), speeds.as_slice()) {
        (2, &[low, high]) if low < high => (low, high),
        (0, _) if !section.given("speed_range") => (0.0, f64::INFINITY), // a grinder has none
        (2, &[_, _]) | (0 | 1 | 3.., _)
            if !matches!(section.got("speed_range").map(|got| &got.value), Some(Value::Faulty)) =>
        {
            let fault = Fault::WrongType {
                key: "speed_range".to_owned(),
                read: format!("{} speeds", section.list("speed_range").len()),
                expected: "the least speed and then the greatest".to_owned(),
                example: "[\"15 m/min\", \"80 m/min\"]".to_owned(),
            };
            walk.fault(section.span_of("speed_range"), fault);
            (f64::NAN, f64::NAN)
        }
        _ => (f64::NAN, f64::NAN),
    }
}

fn tools(walk: &mut Walk, root: &Section<'_>, names: &mut Names) -> Vec<NamedTool> {
    let mut tools = Vec::new();
    for (name, section) in named(walk, root, "tool", None) {
        names.tools.push(name.clone());
        if section.text("process") == Some(LIFE_ONLY) {
            let tool = Some(cribs::life_only(walk, &section, name));
            tools.push(NamedTool { process: None, span: section.span_of("name"), life_only: true, tool });
            continue;
        }
        let set = processes::set_of_tool(walk, &section);
        let set = set.as_ref();
        let scatter = processes::tool_scatter(walk, &section, set);
        let kind = section.chosen("process", ProcessKind::from_word);
        let effects = kind.map_or_else(Vec::new, |kind| measured::effects(walk, &section, kind.word(), names));
        let structure = stability::structure(walk, &section);
        let structure_scatter = stability::scatter(walk, &section, structure.as_ref());
        let cut = structure.map(|structure| structure.cut);
        let process = processes::process(walk, &section, set, &scatter, &effects, cut);
        let posterior = process.as_ref().and_then(|process| processes::posterior(walk, &section, process));
        let spreads = process.as_ref().map(|process| processes::spreads(set, process, posterior.as_ref()));
        let tool = process.map(|process| ToolType {
            name,
            process,
            variants: Variants::written(effects),
            parameter_set: section.text("parameter_set").or(section.text("fmu")).unwrap_or_default().to_owned(),
            edge_cost: section.required("edge_cost"),
            dressing_time: section.si("dressing_time").unwrap_or(0.0),
            scatter,
            structure_scatter,
            posterior: posterior.map(Arc::new),
            spreads: spreads.unwrap_or_default(),
            life: None,
        });
        tools.push(NamedTool {
            process: section.chosen("process", ProcessKind::from_word),
            span: section.span_of("name"),
            life_only: false,
            tool,
        });
    }
    tools
}

/// A tool with the processes that its effects and the calibration of its constants make of its parameter set.
fn varied(walk: &mut Walk, mut tool: ToolType, calibrations: &[(Calibration, Span)]) -> ToolType {
    scatter_moved(walk, &mut tool, calibrations);
    let of_tool = calibrations.iter().filter(|(of_tool, _)| match &of_tool.target {
        Target::Tool(name) => *name == tool.name,
        Target::Shop | Target::Machine(_) | Target::Operation(_) | Target::Source(_) => false,
    });
    let (constants, places): (Vec<&Calibration>, Vec<&Span>) =
        of_tool.filter(|(of_tool, _)| of_tool.constant().is_some()).map(|(of_tool, place)| (of_tool, place)).unzip();
    if constants.is_empty() && tool.variants.effects.is_empty() {
        return tool;
    }
    match Variants::from_process_model(&tool.process, tool.variants.effects.clone(), &constants) {
        Ok((process, variants)) => ToolType { process, variants, ..tool },
        Err(reason) => {
            let place = places.first().map_or(0..0, |place| (*place).clone());
            walk.fault(place, ScenarioFault::Calibration { reason: format!("tool {}: {reason}", tool.name) });
            tool
        }
    }
}

/// Moves the scatter of a tool.
fn scatter_moved(walk: &mut Walk, tool: &mut ToolType, calibrations: &[(Calibration, Span)]) {
    for (calibration, place) in calibrations {
        let Some(name) = calibration.parameter.strip_prefix("scatter.") else { continue };
        if !matches!(&calibration.target, Target::Tool(target) if *target == tool.name) {
            continue;
        }
        let fields = toolroom_wear::Scatter::<f64>::FIELDS;
        let Some(i) = fields.iter().position(|field| field.name == name) else {
            let fault = Fault::UnknownName {
                kind: "scatter",
                name: name.to_owned(),
                nearest: nearest(name, fields.iter().map(|field| field.name)).map(str::to_owned),
                known: fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", "),
            };
            walk.fault(place.clone(), fault);
            continue;
        };
        let value = tool.scatter.get(i).unwrap_or(0.0);
        let value = match calibration.moved {
            CalibrationShift::Factor(factor) => value * factor,
            CalibrationShift::Summand(summand) => value + summand,
        };
        match fields[i].check(value) {
            Ok(()) if calibration.scope.is_everywhere() => {
                tool.scatter.set(i, value);
            }
            Ok(()) => {
                let reason = "scatter of a tool has no scope: it belongs to all of its edges".to_owned();
                walk.fault(place.clone(), ScenarioFault::Calibration { reason });
            }
            Err(error) => walk.fault(place.clone(), ScenarioFault::Calibration { reason: error.to_string() }),
        }
    }
}
