//! How the user is told what went wrong, and the exit code.

use crate::failure::Failure;
use crate::speak::Voice;
use std::fmt;
use std::io;
use std::process::ExitCode;
use toolroom_form::{FaultList, ReadError};
use toolroom_location::Location;
use toolroom_output::signals as stop;
use toolroom_output::{json_error, json_refusal, shown_faults};
use toolroom_shop_import::TableFault;

impl Failure {
    /// Tells the user and chooses the exit code.
    pub fn report(&self, voice: &Voice) -> ExitCode {
        match self {
            Self::File(ReadError::Faults(list)) => refuse(voice, list),
            Self::File(error) => self.plain(voice, error, None, 2),
            Self::Tables { faults, more } => refuse_tables(voice, faults, *more),
            Self::Argument { message, help, .. } => self.plain(voice, message, help.as_deref(), 2),
            Self::Work { message, help, .. } => self.plain(voice, message, help.as_deref(), 1),
            Self::Stopped { message, help, .. } => self.plain(voice, message, Some(help), 1),
            Self::TooLittle { message } => {
                voice.error(format_args!("warning: too little data for an answer: {message}"));
                ExitCode::from(3)
            }
            Self::Alarm { message } => {
                voice.error(format_args!("warning: the shop has changed: {message}"));
                ExitCode::from(3)
            }
            Self::Interrupted { message, help } => match stop::out_of_memory() {
                Some((reason, way)) => {
                    self.plain(voice, format!("{reason}; {message}"), Some(&format!("{way}; {help}")), 1)
                }
                None => self.plain(voice, message, Some(help), stop::exit_code()),
            },
            Self::Unwritable { path, source } => {
                let message = format!("{} cannot be written: {source}", path.display());
                // A wrong path is the user's to mend, a full disk is not in the command.
                let code = if source.kind() == io::ErrorKind::StorageFull { 1 } else { 2 };
                self.plain(voice, message, Some("choose another place"), code)
            }
            Self::Json(error) => self.plain(voice, error, None, 1),
        }
    }

    fn plain(&self, voice: &Voice, message: impl fmt::Display, help: Option<&str>, code: u8) -> ExitCode {
        report_on(voice, self.code(), &message.to_string(), help, self.place());
        voice.error(format_args!("error: {message}"));
        if let Some(help) = help {
            voice.error(format_args!("  help: {help}"));
        }
        ExitCode::from(code)
    }
}

/// Tells a program that asked for JSON why there is no result, unless one was printed before.
pub fn report_on(voice: &Voice, code: &str, message: &str, help: Option<&str>, at: Option<Location>) {
    if voice.json && !voice.has_spoken() {
        let error = json_error(code, message, help, at.as_ref());
        // Where standard output is gone there is nobody to tell.
        let _ = voice.json(&serde_json::json!({ "schema": 1, "error": error }));
    }
}

/// Faults of one file that are shown with the text around them, unless `--verbose` asks for all: somebody mends a few and looks
/// again, and a file of the wrong kind has thousands. An assumption.
const SHOWN: usize = 50;

/// Tells the faults of a file, to programs too, and chooses the exit code.
fn refuse(voice: &Voice, list: &FaultList) -> ExitCode {
    if voice.json {
        // The verb's result would have been JSON: so is its refusal.
        let _ = voice.json(&json_refusal(list));
    }
    let most = if voice.verbose { usize::MAX } else { SHOWN };
    shown_faults(list, most).for_each(|fault| voice.error(fault));
    let count = list.problems.len();
    let plural = if count == 1 { "" } else { "s" };
    let rest = if count > most {
        format!(", of which the first {most} are shown (`--verbose` shows all)")
    } else {
        String::new()
    };
    voice.error(format_args!("{count} problem{plural} in {}{rest}; `toolroom explain CODE` says more", list.file));
    ExitCode::from(2)
}

/// Tells the faults of tables, to programs too, and chooses the exit code.
fn refuse_tables(voice: &Voice, faults: &[TableFault], more: usize) -> ExitCode {
    if voice.json {
        let problems: Vec<serde_json::Value> = faults.iter().map(TableFault::json).collect();
        let error = problems.first().cloned();
        let result =
            serde_json::json!({ "schema": 1, "error": error, "valid": false, "problems": problems, "more": more });
        let _ = voice.json(&result);
    }
    for fault in faults {
        voice.error(format_args!("error[{}]: {}: {}", fault.code, fault.place, fault.message));
        if let Some(fix) = &fault.fix {
            voice.error(format_args!("  help: {fix}"));
        }
    }
    let count = faults.len() + more;
    let plural = if count == 1 { "" } else { "s" };
    let rest = if more > 0 { format!(", of which the first {} are shown", faults.len()) } else { String::new() };
    voice.error(format_args!(
        "{count} problem{plural} in the tables{rest}; nothing was written; `toolroom explain CODE` says more"
    ));
    ExitCode::from(2)
}
