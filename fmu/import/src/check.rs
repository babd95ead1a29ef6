//! Rules behind the failures that users of FMI report, applied to any unit without loading it.
//!
//! | rule | what goes wrong where it is broken (seen in) |
//! |---|---|
//! | archive | backslashes, a nested folder, entries that lead out of it (FMUComplianceChecker 14, unifmu 33, FMPy 632) |
//! | description | faulty XML, double names, unknown units, impossible combinations (FMIL 9) |
//! | structure | wrong ModelStructure, InitialUnknowns, dependencies (FMPy 221 and 223, fmi-standard 1966, OMSimulator 841) |
//! | time | experiments that no master can step through (fmi-standard 1924 and 575) |
//! | state | claims about FMU state that the unit cannot keep (FMPy 811, OpenModelica 12260) |
//! | logging | categories without names (FMPy 115, OMSimulator 1323) |
//! | symbols | missing functions: the importer rejects the unit (FMPy 735) |
//! | platform | no library for this computer, wrong folder, C library too new (FMPy 395 and 623, fmi4c 96) |
//! | events | discrete inputs and events without Event Mode (fmi-standard 1890, OMSimulator 889 and 1609) |
//! | instances | one instance a process (fmi4c 85, PythonFMU 213), no instantiation token (FMPy 110) |

mod capabilities;
mod library;
#[cfg(feature = "fmi")]
pub(crate) use library::functions;
mod names;
mod structure;
mod variables;

use crate::archive::{Archive, ArchiveError, MODEL_DESCRIPTION};
use crate::description::ModelDescription;
use serde::Serialize;
use std::fmt::Write;

/// The failure that a finding leads to; see the table of this module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Rule {
    /// The zip file.
    Archive,
    /// The XML and its variables.
    Description,
    /// What depends on what.
    Structure,
    /// Default experiment.
    Time,
    /// FMU state.
    State,
    /// Log messages.
    Logging,
    /// Functions of a library.
    Symbols,
    /// Libraries for platforms.
    Platform,
    /// Discrete inputs and events.
    Events,
    /// Instantiation.
    Instances,
}

impl Rule {
    /// Every rule, in the order of the reports.
    pub const ALL: [Self; 10] = [
        Self::Archive,
        Self::Description,
        Self::Structure,
        Self::Time,
        Self::State,
        Self::Logging,
        Self::Symbols,
        Self::Platform,
        Self::Events,
        Self::Instances,
    ];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Archive => "archive",
            Self::Description => "description",
            Self::Structure => "structure",
            Self::Time => "time",
            Self::State => "state",
            Self::Logging => "logging",
            Self::Symbols => "symbols",
            Self::Platform => "platform",
            Self::Events => "events",
            Self::Instances => "instances",
        }
    }
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Against the standard, or useless here: importers refuse it or crash.
    Error,
    /// Some importers fail on it.
    Warning,
    /// Worth knowing.
    Note,
}

/// One thing that was found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The failure it leads to.
    pub rule: Rule,
    /// How bad it is.
    pub severity: Severity,
    /// Entry of the archive, with the line where there is one.
    pub place: String,
    /// What is wrong.
    pub message: String,
}

/// What a check found.
#[derive(Debug)]
pub struct Report {
    /// The description, where it could be understood.
    pub description: Option<ModelDescription>,
    /// Findings by severity, then rule.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Number of findings of this severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|finding| finding.severity == severity).count()
    }

    /// Every rule with its verdict, then what was found.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for rule in Rule::ALL {
            let found = || self.findings.iter().filter(|finding| finding.rule == rule);
            let verdict = match (found().map(|finding| finding.severity).min(), self.description.is_some()) {
                (Some(Severity::Error), _) => "error",
                (Some(Severity::Warning), _) => "warning",
                (_, false) if rule > Rule::Description => "not checked",
                (_, _) => "ok",
            };
            let _ = writeln!(text, "{:12} {verdict}", rule.name());
            for finding in found() {
                let severity = match finding.severity {
                    Severity::Error => "error",
                    Severity::Warning => "warning",
                    Severity::Note => "note",
                };
                let _ = writeln!(text, "    {severity}: {}: {}", finding.place, finding.message);
            }
        }
        text.truncate(text.trim_end().len());
        text
    }
}

/// Applies every rule to `archive`. Nothing of the unit is run.
pub fn check(archive: &mut Archive) -> Report {
    let mut findings = Findings::default();
    entries(archive, &mut findings);
    let description = describe(archive, &mut findings);
    if let Some(description) = &description {
        variables::check(description, &mut findings);
        names::check(description, &mut findings);
        structure::check(description, &mut findings);
        capabilities::check(description, &mut findings);
        library::check(archive, description, &mut findings);
    }
    let mut findings = findings.list;
    findings.sort_by_key(|finding| (finding.severity, finding.rule));
    Report { description, findings }
}

fn describe(archive: &mut Archive, findings: &mut Findings) -> Option<ModelDescription> {
    let text = match archive.description() {
        Ok(text) => text,
        Err(error @ ArchiveError::Missing { .. }) => {
            let nested =
                archive.entries().iter().find(|entry| entry.slashed().ends_with(&format!("/{MODEL_DESCRIPTION}")));
            let message = match nested {
                Some(entry) => format!(
                    "{MODEL_DESCRIPTION} lies in a folder ({}); it belongs to the root of the archive",
                    entry.name
                ),
                None => error.to_string(),
            };
            findings.add(Rule::Archive, Severity::Error, MODEL_DESCRIPTION, message);
            return None;
        }
        Err(error) => {
            findings.add(Rule::Archive, Severity::Error, MODEL_DESCRIPTION, error.to_string());
            return None;
        }
    };
    let reading = ModelDescription::read(&text);
    for fault in reading.faults {
        findings.line(Rule::Description, Severity::Error, fault.line, fault.message);
    }
    reading.description
}

fn entries(archive: &Archive, findings: &mut Findings) {
    for entry in archive.entries() {
        let mut add = |severity, message: &str| findings.add(Rule::Archive, severity, &entry.name, message);
        if entry.symlink {
            add(Severity::Error, "is a symbolic link");
        }
        if entry.inside().is_none() {
            add(Severity::Error, "leads out of the folder that the unit is unpacked to");
        }
        if entry.name.contains('\\') {
            add(Severity::Error, "has backslashes; zip names have forward slashes");
        }
        if entry.encrypted {
            add(Severity::Error, "is encrypted");
        }
        if !entry.portable && !entry.directory {
            add(Severity::Error, "is neither stored nor deflated; FMI allows no other method");
        }
    }
}

/// Findings as they come up.
#[derive(Debug, Default)]
struct Findings {
    list: Vec<Finding>,
}

impl Findings {
    fn add(&mut self, rule: Rule, severity: Severity, place: &str, message: impl Into<String>) {
        self.list.push(Finding { rule, severity, place: place.to_owned(), message: message.into() });
    }

    fn line(&mut self, rule: Rule, severity: Severity, line: u32, message: impl Into<String>) {
        self.add(rule, severity, &format!("{MODEL_DESCRIPTION}:{line}"), message);
    }

    /// Of the description as a whole.
    fn whole(&mut self, rule: Rule, severity: Severity, message: impl Into<String>) {
        self.add(rule, severity, MODEL_DESCRIPTION, message);
    }
}
