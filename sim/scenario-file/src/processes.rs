//! Tools: parameter sets, deviations from them, effects, scatter.

use super::choices::ProcessKind;
use super::fault::ScenarioFault;
use super::imported;
use super::names::NamedTool;
use super::stability;
use std::fmt::Display;
use std::sync::Arc;
use toolroom_cutting::{MILLING_CATALOGUE, Milling, MillingInput, Turning, process_of_set};
use toolroom_effects::Effects;
use toolroom_form::{Fault, Section, Value, Walk, nearest, set_parameters};
use toolroom_infeed::{Infeed, Parameters};
use toolroom_lobes::LobesCut;
use toolroom_process::{ModelError, Process};
use toolroom_scenario::{MachineType, Posterior, ProcessModel, Spreads, SwitchedEffect, read_posterior};
use toolroom_wear::{Catalogue, Chipping, Pair, ParameterSet, Scatter, SetError, TURNING_SETS, check_tilt};

/// Edges that are worn at the start can wear further.
pub(super) fn check_edges(walk: &mut Walk, root: &Section<'_>, tools: &[NamedTool], machines: &[MachineType]) {
    for machine in machines {
        for &(tool, wear) in &machine.edges_at_start {
            let Some(tool) = tools.get(tool).and_then(|own| own.tool.as_ref()) else { continue };
            let limit = tool.process.wear_limit();
            let (reason, fix) = if limit.is_infinite() {
                ("has no flank wear", "take out `edge_at_start`: only edges of turning and milling have one".to_owned())
            } else if wear >= limit {
                ("is worn out at the start", format!("below its limit of {} mm", limit * 1e3))
            } else {
                continue;
            };
            let reason = format!("tool \"{}\" on machine \"{}\" {reason}", tool.name, machine.name);
            walk.fault(root.span_of("machine"), ScenarioFault::Arrangement { reason, fix });
        }
    }
}

/// The process of a tool with its structure around it; `set` is what [`set_of_tool`] found. `None` where a problem was noted.
pub(super) fn process(
    walk: &mut Walk,
    tool: &Section<'_>,
    set: Option<&ParameterSet>,
    scatter: &Scatter,
    effects: &[SwitchedEffect],
    structure: Option<LobesCut>,
) -> Option<ProcessModel> {
    let always = effects.iter().filter(|own| own.scope.is_everywhere()).map(|own| own.effect);
    let effects = Effects::overlaid(always.collect());
    let process = tool.chosen("process", ProcessKind::from_word)?;
    if let Some(file) = tool.text("fmu") {
        return imported::process(walk, tool, process, file);
    }
    let Some(name) = tool.text("parameter_set") else {
        if !tool.given("parameter_set") {
            let example = "\"ni_vk6om\"".to_owned();
            let fault = Fault::MissingKey { section: tool.path.clone(), key: "parameter_set", example };
            walk.fault(tool.span.clone(), fault);
        }
        return None;
    };
    match process {
        ProcessKind::Turning => {
            let pair = Pair::of_set(set?).map_err(|reason| refuse(walk, tool, "parameter_set", reason)).ok()?;
            let mut turning = Turning { pair, effects, ..Turning::default() };
            stability::around_turning(walk, tool, structure, &mut turning);
            set_parameters(walk, tool, turning.parameters_mut());
            consistent(walk, tool, turning.pair.law.check());
            if chips_by_share(tool, scatter) {
                let (pair, cut) = (&turning.pair, turning.pair.reference_cut());
                match pair.chipping.for_share(pair, &cut, scatter.chipped_share) {
                    Ok(chipping) => turning.pair.chipping = chipping,
                    Err(reason) => refuse_share(walk, tool, reason),
                }
            }
            Some(ProcessModel::Turning(Arc::new(turning)))
        }
        ProcessKind::Milling => {
            let milling = Milling::of_set(set?).map_err(|reason| refuse(walk, tool, "parameter_set", reason)).ok()?;
            let mut milling = Milling { effects, ..milling };
            let drawn = stability::around_milling(walk, tool, structure, &mut milling);
            set_parameters(walk, tool, milling.parameters_mut());
            consistent(walk, tool, check_tilt(milling.life.stage_contrast, milling.life.stage_tilt));
            if let Some(cutter) = drawn {
                stability::same_cutter(walk, tool, &cutter, &milling);
            }
            if chips_by_share(tool, scatter) {
                match milling_chipping(&milling, scatter.chipped_share) {
                    Ok(chipping) => milling.chipping = chipping,
                    Err(reason) => refuse_share(walk, tool, reason),
                }
            }
            Some(ProcessModel::Milling(Arc::new(milling)))
        }
        ProcessKind::Infeed => {
            let parameters = loaded(walk, tool, name, toolroom_infeed::PARAMETER_SETS, Parameters::named)?;
            let mut infeed =
                Infeed::new(parameters, effects).map_err(|reason| refuse(walk, tool, "parameter_set", reason)).ok()?;
            set_parameters(walk, tool, infeed.parameters_mut());
            Some(ProcessModel::Infeed(Arc::new(infeed)))
        }
    }
}

/// The draws that `parameters_from` names; `None` without the key and where a problem was noted.
pub(super) fn posterior(walk: &mut Walk, tool: &Section<'_>, process: &ProcessModel) -> Option<Posterior> {
    let file = tool.text("parameters_from")?;
    let path = walk.folder.join(file);
    let read = read_posterior(&path, tool, process);
    walk.named(path);
    read.map_err(|reason| {
        let fault = ScenarioFault::Draws { file: file.to_owned(), reason };
        walk.fault(tool.span_of("parameters_from"), fault);
    })
    .ok()
}

/// Whether the chipping rate follows from the share of chipped edges; a rate that the file gives
/// stands.
fn chips_by_share(tool: &Section<'_>, scatter: &Scatter) -> bool {
    let given = match tool.got("parameters").map(|got| &got.value) {
        Some(Value::Raw(raw)) => raw.get("chipping").is_some(),
        _ => false,
    };
    scatter.chipped_share > 0.0 && !given
}

/// The chipping rate at which `share` of nominal cutters chip before the wear limit at the
/// reference cut: the accumulated hazard grows with the power `shape` of the rate.
fn milling_chipping(milling: &Milling, share: f64) -> Result<Chipping, ModelError> {
    let life = &milling.life;
    let cut = MillingInput {
        cutting_speed: life.reference_speed,
        feed_per_tooth: life.reference_feed,
        depth_of_cut: life.reference_depth,
        width_of_cut: life.reference_width,
        ..MillingInput::default()
    };
    let unit = Chipping { rate: (life.reference_speed * life.reference_life).recip(), ..milling.chipping };
    let trial = Milling { chipping: unit, ..milling.clone() };
    let mut state = trial.initial();
    // Three lives: the reference cut wears the cutter out in one, but for effects.
    Process::advance(&trial, &mut state, &cut, 3.0 * life.reference_life)?;
    if state.chipping_hazard <= 0.0 {
        return Err(ModelError::NoSolution { quantity: "chipping rate", reason: "the cutter gathers no hazard" });
    }
    Ok(Chipping { rate: unit.rate * (-(-share).ln_1p() / state.chipping_hazard).powf(unit.shape.recip()), ..unit })
}

fn refuse_share(walk: &mut Walk, tool: &Section<'_>, reason: ModelError) {
    walk.fault(tool.span_of("scatter"), Fault::Model { subject: format!("{}, chipped_share", tool.path), reason });
}

/// Notes a contradiction among the parameters of a tool.
fn consistent(walk: &mut Walk, tool: &Section<'_>, checked: Result<(), ModelError>) {
    if let Err(reason) = checked {
        walk.fault(tool.span_of("parameters"), Fault::Model { subject: tool.path.clone(), reason });
    }
}

/// A shipped parameter set by name.
fn loaded<T, E: Display>(
    walk: &mut Walk,
    tool: &Section<'_>,
    set: &str,
    known: &[(&'static str, &str)],
    named: impl FnOnce(&str) -> Result<T, E>,
) -> Option<T> {
    let names = || known.iter().map(|(name, _)| *name);
    if names().all(|name| name != set) {
        if let Some(other) = process_of(set) {
            let known = names().collect::<Vec<_>>().join(", ");
            let reason = format!("it is a set of {other}, where one of grinding is due; there are {known}");
            refuse(walk, tool, "parameter_set", reason);
            return None;
        }
        let fault = Fault::UnknownName {
            kind: "parameter set",
            name: set.to_owned(),
            nearest: nearest(set, names()).map(str::to_owned),
            known: names().collect::<Vec<_>>().join(", "),
        };
        walk.fault(tool.span_of("parameter_set"), fault);
        return None;
    }
    named(set).map_err(|reason| refuse(walk, tool, "parameter_set", reason)).ok()
}

/// The process of the shipped set of this name, in words; `None` where no process has such a set. A set that is named in the
/// place of one of another process is then told as such.
///
/// ```
/// assert_eq!(toolroom_scenario_file::process_of("zb153u_40kh"), Some("grinding"));
/// assert_eq!(toolroom_scenario_file::process_of("c45_endmill_d12"), Some("milling"));
/// assert_eq!(toolroom_scenario_file::process_of("c45_endmill_d10"), None);
/// ```
pub fn process_of(set: &str) -> Option<&'static str> {
    let grinds = || toolroom_infeed::PARAMETER_SETS.iter().any(|(name, _)| *name == set);
    process_of_set(set).or_else(|| grinds().then_some("grinding"))
}

/// The parameter set that `key` names: a shipped one, or a file whose path counts from that of the
/// scenario.
pub(super) fn set(
    walk: &mut Walk,
    section: &Section<'_>,
    key: &str,
    catalogue: &'static Catalogue,
) -> Option<ParameterSet> {
    let reference = section.text(key)?;
    match ParameterSet::load(reference, &walk.folder, catalogue) {
        Ok(set) => {
            set.files.iter().for_each(|file| walk.named(file.clone()));
            Some(set)
        }
        Err(SetError::Unknown { name, nearest, known, .. }) => {
            if let Some(other) = process_of(&name) {
                let process = catalogue.process;
                let reason = format!("it is a set of {other}, where one of {process} is due; there are {known}");
                refuse(walk, section, key, reason);
                return None;
            }
            let kind = if catalogue.process == "turning" { "turning parameter set" } else { "milling parameter set" };
            let fault = Fault::UnknownName { kind, name, nearest: nearest.map(str::to_owned), known };
            walk.fault(section.span_of(key), fault);
            None
        }
        Err(reason) => {
            refuse(walk, section, key, reason);
            None
        }
    }
}

pub(super) fn refuse(walk: &mut Walk, section: &Section<'_>, key: &str, reason: impl Display) {
    let name = section.text(key).unwrap_or_default().to_owned();
    walk.fault(section.span_of(key), ScenarioFault::ParameterSet { name, reason: reason.to_string() });
}

/// The key `scatter` of a tool; left out, the scatter of its parameter set where that states one, else the shop's.
pub(super) fn tool_scatter(walk: &mut Walk, tool: &Section<'_>, set: Option<&ParameterSet>) -> Scatter {
    let stated = Scatter::of_section(walk, tool, &format!("{}, scatter", tool.path));
    stated.or(set.and_then(|set| set.scatter)).unwrap_or_else(Scatter::shop)
}

/// The parameter set of a cutting tool with the constants and the wear law that its section states; `None` for other tools, and
/// where a problem was noted.
pub(super) fn set_of_tool(walk: &mut Walk, tool: &Section<'_>) -> Option<ParameterSet> {
    if tool.given("fmu") {
        return None;
    }
    let catalogue = match tool.chosen("process", ProcessKind::from_word)? {
        ProcessKind::Turning => &TURNING_SETS,
        ProcessKind::Milling => &MILLING_CATALOGUE,
        ProcessKind::Infeed => return None,
    };
    set(walk, tool, "parameter_set", catalogue)?.of_tool(walk, tool, catalogue)
}

/// How well the parameters of a tool are known before records of its own: by its draws, else by `[prior]` of its set.
pub(super) fn spreads(set: Option<&ParameterSet>, process: &ProcessModel, posterior: Option<&Posterior>) -> Spreads {
    let of_set = set.map_or_else(Spreads::default, |set| Spreads::of_set(set, process));
    posterior.map_or_else(Spreads::default, |posterior| Spreads::of_draws(posterior, process)).or(of_set)
}
