//! `terminalsAndIcons.xml`: which variables belong together at a connection, and the icon.

use super::Description;
use super::xml::Xml;
use crate::variable::{Role, Variable};

/// Terminals by what crosses them: name, meaning, members by the last part of their name.
const TERMINALS: &[(&str, &str, &[&str])] = &[
    (
        "spindle",
        "Main drive",
        &["cutting_speed", "work_rotation_speed", "spindle_speed", "spindle_power", "cutting_force"],
    ),
    (
        "feed",
        "Feed drive",
        &["feed_per_rev", "feed_per_tooth", "infeed_per_rev", "feed_rate", "feed_force", "normal_force"],
    ),
    (
        "tool",
        "Tool magazine and monitoring",
        &["tool.change", "tool.count", "wheel.dress", "wheel.count", "wear_ratio"],
    ),
    (
        "workpiece",
        "Workpiece",
        &["depth_of_cut", "width_of_cut", "hardness_ratio", "engaged", "roughness_ra", "size_error", "part.change"],
    ),
];

pub(super) fn write(description: &Description) -> String {
    let mut xml = Xml::new();
    xml.element("fmiTerminalsAndIcons", &[("fmiVersion", "3.0".to_owned())], |xml| {
        xml.element("Terminals", &[], |xml| {
            for (name, meaning, members) in TERMINALS {
                let belongs = |variable: &&Variable| {
                    matches!(variable.role, Role::Input | Role::Output)
                        && members.iter().any(|member| {
                            variable.name == *member || variable.name.strip_prefix("process.") == Some(*member)
                        })
                };
                let variables: Vec<&Variable> = description.variables.iter().filter(belongs).collect();
                if variables.is_empty() {
                    continue;
                }
                let attributes = [
                    ("name", (*name).to_owned()),
                    ("matchingRule", "plug".to_owned()),
                    ("terminalKind", "org.toolroom".to_owned()),
                    ("description", (*meaning).to_owned()),
                ];
                xml.element("Terminal", &attributes, |xml| {
                    for variable in variables {
                        let member = variable.name.rsplit('.').next().unwrap_or(&variable.name);
                        let attributes = [
                            ("variableName", variable.name.clone()),
                            ("memberName", member.to_owned()),
                            ("variableKind", "signal".to_owned()),
                        ];
                        xml.leaf("TerminalMemberVariable", &attributes);
                    }
                });
            }
        });
        xml.element("GraphicalRepresentation", &[], |xml| {
            let corner = |value: &str| value.to_owned();
            let extent = [("x1", corner("-100")), ("y1", corner("-100")), ("x2", corner("100")), ("y2", corner("100"))];
            let mut system = extent.to_vec();
            system.push(("suggestedScalingFactorTo_mm", corner("0.1")));
            xml.leaf("CoordinateSystem", &system);
            xml.leaf("Icon", &extent);
        });
    });
    xml.finish()
}
