//! `toolroom fmu check F.fmu`.

use super::open;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use toolroom_fmu_import::check::{Severity, check};

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
        voice.data(report.text())?;
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
