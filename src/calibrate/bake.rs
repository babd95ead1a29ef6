//! `toolroom calibrate --bake`: a parameter set from the set of a scenario's tool and what the scenario moves in it.

use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use std::sync::Arc;
use toolroom_cutting::MILLING_CATALOGUE;
use toolroom_output::Files;
use toolroom_process::{AnyRecord, Process as _};
use toolroom_scenario::{CalibrationShift, ProcessModel, Target, ToolType};
use toolroom_wear::{Origin, ParameterSet, Spread, TURNING_SETS};

/// Writes the set of `tool` of the scenario `path` with the values that the scenario states or calibrates everywhere.
pub fn run(path: &Path, tool: &str, out: &Path, voice: &Voice) -> Result<(), Failure> {
    let scenario = toolroom_scenario_file::read(path, &[])?.scenario;
    let place = path.display();
    let named = scenario.tools.iter().find(|tool_type| tool_type.name == tool).ok_or_else(|| {
        let known: Vec<&str> = scenario.tools.iter().map(|tool_type| tool_type.name.as_str()).collect();
        Failure::of_file(path, format_args!("no tool `{tool}`"), format_args!("there are {}", known.join(", ")))
    })?;
    let catalogue = match named.process {
        ProcessModel::Turning(_) => &TURNING_SETS,
        ProcessModel::Milling(_) => &MILLING_CATALOGUE,
        ProcessModel::Infeed(_) | ProcessModel::Other(_) => {
            let reason = format!("the tool `{tool}` neither turns nor mills");
            return Err(Failure::of_file(path, reason, "sets of turning and milling can be baked"));
        }
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut set = ParameterSet::load(&named.parameter_set, folder, catalogue)
        .map_err(|error| Failure::located(error, "mend the set of the tool"))?;
    let mut statements = stated(&mut set, named, &place.to_string());
    let mut left = Vec::new();
    for calibration in &scenario.calibrations {
        let of_tool = matches!(&calibration.target, Target::Tool(name) if name == tool);
        let value = set.values.iter_mut().find(|value| value.key() == calibration.parameter);
        let (true, true, Some(value)) = (of_tool, calibration.scope.is_everywhere(), value) else {
            left.push(format!("{} of {}", calibration.parameter, calibration.target.words()));
            continue;
        };
        let before = value.shown();
        let (moved, spread) = match calibration.moved {
            CalibrationShift::Factor(factor) => {
                value.value *= factor;
                (format!("times {factor:.5}"), calibration.standard_error.map(|error| Spread::Factor(error.exp())))
            }
            CalibrationShift::Summand(summand) => {
                value.value += summand;
                let shown = |error: f64| Spread::Deviation(value.field.to_display(error));
                (
                    format!("moved by {:.5} {}", value.field.to_display(summand), value.field.display),
                    calibration.standard_error.map(shown),
                )
            }
        };
        value.origin = Origin::Given;
        value.source = format!("{}; {moved} by {} in {place}", value.source, calibration.by);
        if let Some(spread) = spread {
            set.prior.insert(calibration.parameter.clone(), spread);
        }
        statements.push(format!("{}: {before} {moved}", calibration.parameter));
    }
    if statements.is_empty() {
        let reason = format!("nothing of the tool `{tool}` is stated or calibrated everywhere");
        return Err(Failure::of_file(path, reason, "`gap apply` writes [[calibration]] into a scenario"));
    }
    set.name = out.file_stem().map_or_else(|| "baked".into(), |stem| stem.to_string_lossy().into_owned());
    set.title = format!("{}, as {place} calibrates it", set.title);
    let files = Files::new([path], voice.force);
    files.check(out)?;
    files.put(out, set.to_toml().as_bytes())?;
    if voice.json {
        return voice
            .json(&json!({ "schema": 1, "out": out.display().to_string(), "moved": statements, "left_out": left }));
    }
    statements.iter().try_for_each(|line| voice.data(line))?;
    left.iter().for_each(|line| voice.say(format_args!("left out, no value of this set everywhere: {line}")));
    voice.say(format_args!("wrote {}; leave the baked entries out of the scenario that uses it", out.display()));
    Ok(())
}

/// Values of the tool that the scenario states beside the set (`parameters`).
fn stated(set: &mut ParameterSet, tool: &ToolType, place: &str) -> Vec<String> {
    let mut bare = tool.bare().clone();
    let groups: Vec<(&str, &mut dyn AnyRecord)> = match &mut bare {
        ProcessModel::Turning(process) => Arc::make_mut(process).parameters_mut(),
        ProcessModel::Milling(process) => Arc::make_mut(process).parameters_mut(),
        ProcessModel::Infeed(_) | ProcessModel::Other(_) => Vec::new(),
    };
    let mut statements = Vec::new();
    for (group, record) in groups {
        for (index, field) in record.fields().iter().enumerate() {
            let Some(now) = record.value(index) else { continue };
            let matching = set.values.iter_mut().find(|value| value.group == group && value.field.name == field.name);
            let Some(value) = matching.filter(|value| value.value != now) else { continue };
            let before = value.shown();
            (value.value, value.origin) = (now, Origin::Given);
            value.source = format!("stated in {place}");
            statements.push(format!("{}: {before} is {}", value.key(), value.shown()));
        }
    }
    statements
}
