//! The reader of each kind: what its verb would refuse before it begins is refused here.

use crate::KindError;
use crate::base;
use crate::checked::{CheckResult, checked};
use crate::empirical::empirical;
use crate::places::{header, nominal as nominal_place, parameter, refused};
use crate::scopes::{records_only, together};
use crate::warning::{Warning, unusual};
use crate::workload::workload;
use serde_json::{Map, json};
use std::path::Path;
use toolroom_cutting::{MILLING_CATALOGUE, Milling};
use toolroom_effects::{EFFECTS_FILE, read_definitions};
use toolroom_form::{Echo, Refusal, Section, Walk, significant};
use toolroom_nominal::NominalModel;
use toolroom_planning::contour::{Task, read_setup};
use toolroom_planning::cycle::CycleDesign;
use toolroom_records::import::Mapping;
use toolroom_scenario_file::{self as file, ScenarioFile};
use toolroom_shop_import::ShopMapping;
use toolroom_wear::{Origin, Pair, ParameterSet, SetError, TURNING_SETS};

pub fn program_setup(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = toolroom_stock::Setup::read(path, set)?;
    let tools = file.content.tools.len();
    let plural = if tools == 1 { "" } else { "s" };
    Ok(checked("program-setup", None, file.echo, &format!("a stock and {tools} tool{plural}")))
}

pub fn machine(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = toolroom_drives::Machine::read(path, set)?;
    Ok(checked("machine", None, file.echo, "a machine with its control and drives"))
}

pub fn scenario(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let ScenarioFile { scenario, echo, text, variants, .. } = match file::read(path, set) {
        Ok(read) => read,
        Err(error) => return Ok(base::of_tables(path, error)?),
    };
    for (index, variant) in variants.iter().enumerate() {
        let changes: Vec<String> = set.iter().chain(&variant.set).cloned().collect();
        file::read(path, &changes).map_err(|error| {
            let refusal = Refusal::new("variant", format_args!("variant `{}`: {error}", variant.name));
            refused(path, &text, header(&text, "variant", index), refusal)
        })?;
    }
    // What `run` would refuse before its first event.
    for (index, policy) in scenario.policies.iter().enumerate() {
        toolroom_shop::Shop::new(&scenario, index, 0).map_err(|error| {
            let refusal =
                Refusal::new("policy", format_args!("no run of policy `{}` would begin: {error}", policy.name));
            refused(path, &text, header(&text, "policy", index), refusal)
        })?;
    }
    let mut result = Map::new();
    result.insert("kind".to_owned(), json!("scenario"));
    result.insert("name".to_owned(), json!(scenario.name));
    let policies: Vec<_> = scenario.policies.iter().map(|policy| &policy.name).collect();
    result.insert("policies".to_owned(), json!(policies));
    result.insert("values".to_owned(), json!(echo));
    let workload = workload(&scenario);
    result.extend([workload.json(), ("warnings".to_owned(), json!([]))]);
    let operations: usize = scenario.parts.iter().map(|part| part.operations.len()).sum();
    let summary = format!(
        "valid: {}, {}, {} with {}, {}, {} of {} h",
        counted(scenario.machines.len(), "machine", "machines"),
        counted(scenario.tools.len(), "tool", "tools"),
        counted(scenario.parts.len(), "part", "parts"),
        counted(operations, "operation", "operations"),
        counted(scenario.policies.len(), "policy", "policies"),
        counted(scenario.replications as usize, "replication", "replications"),
        scenario.horizon / 3600.0,
    ) + &workload.text();
    let strange = unusual(&echo);
    let scoped = together(&scenario).into_iter().chain(records_only(&scenario));
    let told = workload.warnings.into_iter().chain(empirical(&scenario)).chain(scoped);
    let warnings: Vec<Warning> = told.chain(strange).collect();
    Ok(CheckResult { echo, result, summary }.warned(&warnings))
}

/// `1 machine`, `2 machines`.
fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

pub fn chart(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = toolroom_planning::lobes::read(path, set)?;
    let points = file.content.points.len();
    Ok(checked("lobes", Some(&file.content.name), file.echo, &format!("a chart with {points} operating points")))
}

pub fn structure(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = toolroom_lobes::read_structure(path, set)?;
    // What stiffer modes give way is no mode of the file.
    let modes = counted(file.content.rotations.len(), "mode", "modes");
    Ok(checked("structure", Some(&file.content.name), file.echo, &format!("a structure of {modes}")))
}

pub fn coefficients(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = toolroom_lobes::read_coefficients(path, set)?;
    let deviation = 100.0 * file.content.deviation;
    let summary = format!("coefficients of the cutting force, known to {deviation:.1} %");
    Ok(checked("coefficients", Some(&file.content.name), file.echo, &summary))
}

pub fn tool(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = toolroom_modes::read_tool(path, set)?;
    let segments = file.content.segments.len();
    Ok(checked("tool", Some(&file.content.name), file.echo, &format!("a tool of {segments} segments")))
}

pub fn study(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = toolroom_life::file::read(path, set)?;
    let study = &file.content.study;
    let summary =
        format!("a study of {} lives in each of {} cells of condition and policy", study.lives, study.cells.len());
    Ok(checked("life", Some(&study.name), file.echo, &summary))
}

pub fn cycle(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let echo = CycleDesign::read(path, set)?.echo;
    Ok(checked("cycle", None, echo, "a grinding cycle that can be worked out"))
}

pub fn planned(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let Task { file, echo, .. } = Task::checked(path, set)?;
    Ok(checked("contour", Some(&file.name), echo, &format!("a contour with {} passes", file.passes.len())))
}

pub fn setup(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let file = read_setup(path, set)?;
    let passes = file.content;
    let summary = format!("a setup of {passes} passes; a part program draws the contour: toolroom contour --gcode");
    Ok(checked("setup", None, file.echo, &summary))
}

pub fn mapping(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let mapping = Mapping::read(path, set)?;
    let summary = format!("a mapping of {} columns to {} records", mapping.columns.len(), mapping.kind.name());
    Ok(checked("mapping", None, Vec::new(), &summary))
}

pub fn shop_mapping(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let mapping = ShopMapping::read(path, set)?;
    let summary = format!("a mapping of tables of a shop: {}", mapping.tables().join(", "));
    Ok(checked("shop-mapping", None, Vec::new(), &summary))
}

pub fn effects(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let read = |walk: &mut Walk, root: &Section<'_>| Some(read_definitions(walk, root));
    let file = toolroom_form::read(path, set, &EFFECTS_FILE, read)?;
    let ids = file.content.iter().map(|own| own.entry().id).collect::<Vec<_>>().join(", ");
    Ok(checked("effects", None, file.echo, &format!("effects of your own: {ids}")))
}

pub fn nominal(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let model = NominalModel::read(path, set).map_err(|error| nominal_place(path, error))?;
    Ok(checked("gap", None, Vec::new(), &format!("a nominal model of {} records", model.kind().name())))
}

pub fn parameter_set(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    let set = ParameterSet::read(path, set, &[&TURNING_SETS, &MILLING_CATALOGUE])?;
    let refuse = |error: SetError| {
        // The file was read before.
        let text = toolroom_form::text(path).unwrap_or_default();
        let refusal = Refusal::new("parameter-set", format_args!("parameter set `{}`: {error}", set.name));
        refused(path, &text, parameter(&text, &error), refusal)
    };
    let pair = if set.process == "turning" { Some(Pair::of_set(&set).map_err(refuse)?) } else { None };
    if set.process == "milling" {
        Milling::of_set(&set).map_err(refuse)?;
    }
    let echo = set.values.iter().map(|value| Echo {
        section: match acting(&set, value.group) {
            true => value.group.to_owned(),
            false => format!("{} (matters little: acts on no tool life under this law)", value.group),
        },
        key: value.field.name.to_owned(),
        value: format!("{:14} {}: {}", value.shown(), value.origin, value.source),
        span: 0..0, // the set keeps no places
        default: value.origin == Origin::Assumed,
    });
    let mut checked = checked("parameter-set", Some(&set.name), echo.collect(), "");
    let parameters = set.values.iter().map(|value| {
        json!({
            "name": value.key(),
            "value": value.field.to_display(value.value),
            "unit": value.field.display,
            "origin": value.origin.to_string(),
            "source": value.source,
            "acts_on_life": acting(&set, value.group),
        })
    });
    checked.result.insert("process".to_owned(), json!(set.process));
    checked.result.insert("law".to_owned(), json!(set.law));
    checked.result.insert("parameters".to_owned(), parameters.collect());
    checked.result.insert("notes".to_owned(), json!(set.notes));
    let count = |wanted: fn(&Origin) -> bool| set.values.iter().filter(|value| wanted(&value.origin)).count();
    let mut summary = format!(
        "valid: a parameter set of {} with {} values: {} given, {} of handbook constants, {} of the set it is based on, \
         {} assumed",
        set.process,
        set.values.len(),
        count(|origin| *origin == Origin::Given),
        count(|origin| *origin == Origin::Handbook),
        count(|origin| matches!(origin, Origin::Based(_))),
        count(|origin| *origin == Origin::Assumed),
    );
    for note in &set.notes {
        summary.push_str(&format!("\nnote: {note}"));
    }
    if let Some(pair) = pair {
        let cut = pair.reference_cut();
        summary.push_str(&format!(
            "\nat {} m/min, {} mm/rev and {} mm an edge lasts {} min",
            significant(cut.cutting_speed * 60.0),
            significant(cut.feed_per_rev * 1e3),
            significant(cut.depth_of_cut * 1e3),
            significant(pair.life(&cut).cutting_time / 60.0),
        ));
    }
    Ok(CheckResult { summary, ..checked })
}

/// Whether a group acts on tool life: heat and its measurement do not under a law without temperature.
fn acting(set: &ParameterSet, group: &str) -> bool {
    let heat_free = set.law == Some("extended_taylor");
    match group {
        "emf" | "force" => false,
        "temperature" => !heat_free,
        _ => true,
    }
}
