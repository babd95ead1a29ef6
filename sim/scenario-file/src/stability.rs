//! Structures of tools, and what policies do about chatter.

use super::choices::ChatterWord;
use super::fault::ScenarioFault;
use std::sync::Arc;
use toolroom_chatter::Cutter;
use toolroom_cutting::{Milling, MillingStructure, Regeneration, Turning, TurningStructure};
use toolroom_form::{Section, Walk};
use toolroom_lobes::{LobesCut, LobesFile};
use toolroom_scenario::{StabilityRule, StructureScatter, Uncertainty};

/// The lobes file that a tool names, beside the scenario.
pub(super) fn structure(walk: &mut Walk, tool: &Section<'_>) -> Option<LobesFile> {
    let name = tool.text("structure")?.to_owned();
    let path = walk.folder.join(&name);
    walk.files.push(path.clone());
    match toolroom_lobes::read(&path, &[]) {
        Ok(file) => {
            walk.files.extend(file.files);
            Some(file.content)
        }
        Err(error) => {
            let fault = ScenarioFault::Structure { file: path.display().to_string(), reason: error.to_string() };
            walk.fault(tool.span_of("structure"), fault);
            None
        }
    }
}

fn refused(walk: &mut Walk, tool: &Section<'_>, reason: impl ToString) {
    let file = tool.text("structure").unwrap_or_default().to_owned();
    walk.fault(tool.span_of("structure"), ScenarioFault::Structure { file, reason: reason.to_string() });
}

/// Puts the structure of a turning tool around it.
pub(super) fn around_turning(walk: &mut Walk, tool: &Section<'_>, structure: Option<LobesCut>, turning: &mut Turning) {
    match structure {
        None => {}
        Some(LobesCut::Turning { cut, bar }) => match TurningStructure::new(cut, bar, Regeneration::default()) {
            Ok(structure) => turning.structure = Some(Arc::new(structure)),
            Err(reason) => refused(walk, tool, reason),
        },
        Some(_) => refused(walk, tool, "it describes no turning; process = \"turning\" is due"),
    }
}

/// Puts the structure of a milling cutter around it; the cutter that the file draws.
pub(super) fn around_milling(
    walk: &mut Walk,
    tool: &Section<'_>,
    structure: Option<LobesCut>,
    milling: &mut Milling,
) -> Option<Cutter> {
    let cut = match structure? {
        LobesCut::Milling(cut) => cut,
        LobesCut::Turning { .. } | LobesCut::Chuck(_) | LobesCut::ChipLag(_) | LobesCut::Lathe(_) => {
            refused(walk, tool, "it describes no milling; process = \"milling\" is due");
            return None;
        }
    };
    let damping = cut.force.process_damping;
    match MillingStructure::new(cut.modes, cut.cutter.helix_angle, damping, Regeneration::default()) {
        Ok(structure) => {
            let axial_ratio = cut.force.axial / cut.force.tangential;
            let structure = structure.by_speed(cut.by_speed).along_path(cut.along_path);
            let structure = structure.with_profile(&cut.cutter, axial_ratio);
            milling.structure = Some(Arc::new(structure));
        }
        Err(reason) => refused(walk, tool, reason),
    }
    Some(cut.cutter)
}

/// The cutter of the file and that of the tool are one.
pub(super) fn same_cutter(walk: &mut Walk, tool: &Section<'_>, cutter: &Cutter, milling: &Milling) {
    let (teeth, diameter) = (milling.cutter.teeth as usize, milling.cutter.diameter);
    if cutter.teeth != teeth || (cutter.diameter / diameter - 1.0).abs() > 1e-6 {
        let reason = format!(
            "its cutter has {} teeth and {} mm, that of the tool {teeth} and {} mm",
            cutter.teeth,
            cutter.diameter * 1e3,
            diameter * 1e3
        );
        refused(walk, tool, reason);
    }
}

/// How the structures of the machines differ: as the tool says, else as the modes of its structure are known.
pub(super) fn scatter(walk: &mut Walk, tool: &Section<'_>, structure: Option<&LobesFile>) -> StructureScatter {
    let Some(section) = walk.table(tool, "structure_scatter") else {
        let known = structure.and_then(|structure| structure.scatter);
        return known.map_or_else(StructureScatter::default, |known| StructureScatter {
            natural_frequency: known.natural_frequency,
            damping_ratio: known.damping_ratio,
        });
    };
    StructureScatter {
        natural_frequency: section.required("natural_frequency"),
        damping_ratio: section.required("damping_ratio"),
    }
}

/// `chatter = "best_lobe"`, or a table with the rule's numbers.
pub(super) fn rule(walk: &mut Walk, policy: &Section<'_>) -> StabilityRule {
    let Some((word, table)) = walk.rule(policy, "chatter", ChatterWord::from_word) else {
        return StabilityRule::Ignore; // a problem was noted
    };
    let value = |key: &str, otherwise: f64| table.si(key).unwrap_or(otherwise);
    match word {
        ChatterWord::Ignore => StabilityRule::Ignore,
        ChatterWord::BestLobe => StabilityRule::BestLobe,
        ChatterWord::Reactive => StabilityRule::Reactive { reaction_time: value("reaction_time", 2.0) },
        ChatterWord::SpeedVariation => StabilityRule::SpeedVariation {
            amplitude: value("amplitude", 0.2),
            revolutions: table
                .get()
                .filter(|table| table.given("revolutions"))
                .map_or(5, |table| table.count32("revolutions")),
        },
        ChatterWord::DepthReduction => StabilityRule::DepthReduction { share: value("share", 0.9) },
        ChatterWord::RobustLobe => StabilityRule::RobustLobe {
            uncertainty: Uncertainty {
                natural_frequency: value("natural_frequency", 0.02),
                damping_ratio: value("damping_ratio", 0.2),
                coefficients: value("coefficients", 0.1),
            },
        },
        ChatterWord::Constraint => StabilityRule::Constraint { margin: value("margin", 0.1) },
    }
}
