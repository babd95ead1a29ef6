//! Work that is planned: cycles designed to limits, contours, and the policies that run them.

use super::choices::{DressingWord, GrindingWord};
use super::fault::ScenarioFault;

use std::sync::Arc;
use toml::de::DeValue;
use toolroom_contour::ContourFile;
use toolroom_form::{Fault, Section, Span, Value, Walk, set_record};
use toolroom_infeed::{CycleFile, CycleLimits, Infeed, Input};
use toolroom_scenario::policies::ResolveError;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::{
    ContourRule, ContourWork, CycleWork, DressingRule, GrindingRule, MachineType, ProcessModel, ProgramWork, Scenario,
    ToolType, Work,
};
use toolroom_stock::Setup;

/// Keys of a grinding operation that the cycle file contains.
const OF_CYCLE_FILE: &[&str] = &["work_rotation_speed", "phase"];

/// A cycle by its limits, or by a cycle file; `None` where a problem was noted.
pub(super) fn cycle(walk: &mut Walk, section: &Section<'_>, model: Option<&ProcessModel>) -> Option<Work> {
    let got = section.got("cycle")?;
    let wear_compensation = section.si("wear_compensation").unwrap_or(1.0);
    let (believed, conditions, limits) = match &got.value {
        Value::Raw(DeValue::Table(table)) => {
            not_beside(walk, section, "cycle", &["phase"]);
            let mut limits = CycleLimits::default();
            let noted = walk.problems.len();
            set_record(walk, &format!("{}, cycle", section.path), table, &mut limits);
            let work_rotation_speed = super::required::due(walk, section, section, "work_rotation_speed", "292 rpm");
            let Some(ProcessModel::Infeed(wheel)) = model else { return None };
            if walk.problems.len() > noted || work_rotation_speed.is_nan() {
                return None;
            }
            // Cycles are designed for what the parameter set says, not for effects beyond it.
            let believed = Infeed { parameters: wheel.parameters, ..Infeed::default() };
            (believed, Input { work_rotation_speed, ..Input::default() }, limits)
        }
        Value::Text(path) => {
            not_beside(walk, section, "cycle", OF_CYCLE_FILE);
            let text = walk.file(section, "cycle", path)?;
            match CycleFile::parse(path, &text, &[]).map(|file| file.content) {
                Ok(file) => (file.grinding, file.input, file.limits),
                Err(reason) => {
                    walk.fault(section.span_of("cycle"), ScenarioFault::CycleFile { reason: reason.to_string() });
                    return None;
                }
            }
        }
        Value::Si(_) | Value::Count(_) | Value::Flag(_) | Value::List(_) | Value::Raw(_) | Value::Faulty => {
            return None; // a problem was noted
        }
    };
    match CycleWork::new(believed, conditions, limits, wear_compensation) {
        Ok(work) => Some(Work::Cycle(Arc::new(work))),
        Err(reason) => {
            walk.fault(section.span_of("cycle"), ScenarioFault::Cycle { subject: section.path.clone(), reason });
            None
        }
    }
}

/// Keys of a milling operation that a contour makes superfluous.
const OF_CONTOUR: &[&str] =
    &["passes", "pass", "cutting_speed", "feed_per_tooth", "depth_of_cut", "width_of_cut", "path_length"];

/// Passes around the contour of a file; `None` where a problem was noted.
pub(super) fn contour(
    walk: &mut Walk,
    section: &Section<'_>,
    tool: Option<&ToolType>,
    machine: Option<&MachineType>,
) -> Option<Work> {
    let path = section.text("contour")?;
    not_beside(walk, section, "contour", OF_CONTOUR);
    let text = walk.file(section, "contour", path)?;
    let content = match ContourFile::parse(path, &text, &[]) {
        Ok(file) => file.content,
        Err(reason) => {
            walk.fault(section.span_of("contour"), ScenarioFault::ContourFile { reason: reason.to_string() });
            return None;
        }
    };
    let passes = contour_passes(walk, section, &content)?;
    let rule = section.chosen("plan", ContourRule::from_word).unwrap_or(ContourRule::HandbookOneFeed);
    match ContourWork::new(path, content, passes, rule, tool?, machine?) {
        Ok(work) => Some(Work::Contour(Arc::new(work))),
        Err(reason) => {
            walk.fault(section.span_of("contour"), ScenarioFault::Contour { subject: section.path.clone(), reason });
            None
        }
    }
}

/// Keys of an operation that a part program makes superfluous.
const OF_PROGRAM: &[&str] = &["tool", "contour", "contour_passes", "plan"];

/// The part program of a file with its setup; `None` where a problem was noted.
pub(super) fn program(
    walk: &mut Walk,
    section: &Section<'_>,
    tools: &[Option<&ToolType>],
    names: &[String],
) -> Option<Arc<ProgramWork>> {
    let file = section.text("program")?;
    not_beside(walk, section, "program", OF_PROGRAM);
    not_beside(walk, section, "program", OF_CONTOUR);
    let Some(setup_file) = section.text("setup") else {
        if !section.given("setup") {
            let example = "\"plate-setup.toml\"".to_owned();
            let fault = Fault::MissingKey { section: section.path.clone(), key: "setup", example };
            walk.fault(section.span_of("program"), fault);
        }
        return None;
    };
    let text = walk.file(section, "setup", setup_file)?;
    // Files that it names count from its own folder.
    let setup = match Setup::parse(&walk.folder.join(setup_file).display().to_string(), &text, &[]) {
        Ok(file) => {
            file.files.into_iter().for_each(|named| walk.named(named));
            file.content
        }
        Err(reason) => {
            walk.fault(section.span_of("setup"), ScenarioFault::SetupFile { reason: reason.to_string() });
            return None;
        }
    };
    let folder = walk.folder.clone();
    walk.named(folder.join(file));
    match ProgramWork::new(&folder, [file, setup_file], &setup, tools, names) {
        Ok(work) => Some(Arc::new(work)),
        Err(reason) => {
            let (subject, reason) = (section.path.clone(), reason.to_string());
            walk.fault(section.span_of("program"), ScenarioFault::Program { subject, reason });
            None
        }
    }
}

/// The passes that `contour_passes` names, in that order; all of the file where it is left out.
fn contour_passes(walk: &mut Walk, section: &Section<'_>, content: &ContourFile) -> Option<Vec<usize>> {
    let names = || content.passes.iter().map(|(name, _)| name.as_str());
    if !section.given("contour_passes") {
        return Some((0..content.passes.len()).collect());
    }
    let named = section.list("contour_passes");
    let found: Vec<usize> = named
        .iter()
        .filter_map(|got| super::names::reference(walk, "pass of the contour", Some(got), names()))
        .collect();
    (found.len() == named.len() && !found.is_empty()).then_some(found)
}

/// Whether every policy can plan what it has to: only the whole scenario tells.
pub(super) fn policies(walk: &mut Walk, scenario: &Scenario, places: &[Span]) {
    super::speed::needs_model(walk, scenario, places);
    let operations = || scenario.parts.iter().flat_map(|part| &part.operations);
    if !walk.problems.is_empty()
        || !operations().any(|operation| matches!(operation.work, Work::Cycle(_) | Work::Contour(_)))
    {
        return;
    }
    for (policy, place) in places.iter().enumerate() {
        if let Err(ResolveError::Policy { policy, tool, source }) = ResolvedPolicy::from_scenario(scenario, policy) {
            walk.fault(place.clone(), ScenarioFault::Policy { policy, tool, reason: source });
        }
    }
}

/// Keys that `key` makes superfluous.
pub(super) fn not_beside(walk: &mut Walk, section: &Section<'_>, key: &'static str, others: &[&'static str]) {
    for other in others.iter().filter(|other| section.given(other)) {
        let case = format!("an operation with `{key}`");
        let fault = Fault::NotApplicable { key: other, case, applicable: format!("one of {key}, {other}") };
        walk.fault(section.span_of(other), fault);
    }
}

pub(super) fn grinding_rule(walk: &mut Walk, section: &Section<'_>) -> GrindingRule {
    let Some((word, table)) = walk.rule(section, "grinding", GrindingWord::from_word) else {
        return GrindingRule::default(); // a problem was noted
    };
    let dulling = table.si("dulling").unwrap_or(1.0);
    match word {
        GrindingWord::Fixed => GrindingRule::Fixed { dulling },
        GrindingWord::ForceAdaptive => GrindingRule::ForceAdaptive { dulling, rough_force: table.si("rough_force") },
        GrindingWord::TimeConstantAdaptive => {
            let redesign = table.get().and_then(|table| table.flag("redesign")).unwrap_or(false);
            GrindingRule::TimeConstantAdaptive { dulling, redesign }
        }
    }
}

pub(super) fn dressing_rule(walk: &mut Walk, section: &Section<'_>) -> DressingRule {
    let Some((word, table)) = walk.rule(section, "dressing", DressingWord::from_word) else {
        return DressingRule::default(); // a problem was noted
    };
    match word {
        DressingWord::Limit => DressingRule::Limit,
        DressingWord::PartCount => DressingRule::PartCount { parts: table.due().count32("parts") },
        DressingWord::Dulling => DressingRule::Dulling { ratio: table.due().required("ratio") },
    }
}
