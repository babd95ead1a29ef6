//! `toolroom fmu check F.fmu`.

use super::open;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;
use toolroom_fmu_import::check::{Report, Rule, Severity, check};

pub fn run(path: &Path, voice: &Voice) -> Result<(), Failure> {
    let report = check(&mut open(path)?);
    let errors = report.count(Severity::Error);
    if voice.json {
        voice.json(&json!({
            "schema": 1,
            "file": path.display().to_string(),
            "fmi_version": report.description.as_ref().map(|description| &description.fmi_version),
            "valid": errors == 0,
            "errors": errors,
            "warnings": report.count(Severity::Warning),
            "findings": report.findings,
        }))?;
    } else {
        voice.data(table(&report))?;
    }
    if errors == 0 {
        voice.say(format_args!("valid: no error in {}", path.display()));
        return Ok(());
    }
    let plural = if errors == 1 { "" } else { "s" };
    Err(Failure::argument(
        format_args!("{errors} error{plural} in {}", path.display()),
        "importers refuse such a unit or misread it; ask its exporter",
    ))
}

/// Every rule with its verdict, then what was found.
fn table(report: &Report) -> String {
    let mut text = String::new();
    for rule in Rule::ALL {
        let found = || report.findings.iter().filter(|finding| finding.rule == rule);
        let verdict = match (found().map(|finding| finding.severity).min(), report.description.is_some()) {
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
