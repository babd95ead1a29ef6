//! What can go wrong, in words, with the exit code.

use crate::speak::Voice;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt;
use std::io;
use std::path::PathBuf;
use std::process::ExitCode;
use toolroom_sim::scenario::file::{Fault, FaultList, ReadError};

/// Why a command did not do its work.
#[derive(Debug)]
pub enum Failure {
    /// The scenario was not read.
    Scenario(ReadError),
    /// An argument that cannot be used.
    Argument {
        /// What is wrong.
        message: String,
        /// The likely fix.
        help: Option<String>,
    },
    /// The work could not be done although the input is right.
    Work {
        /// Why.
        message: String,
    },
    /// Stopped by the user; what was complete is written.
    Interrupted { replications: u32, path: PathBuf },
    /// A path that cannot be written.
    Unwritable { path: PathBuf, source: io::Error },
    /// A result that has no JSON form.
    Json(serde_json::Error),
}

impl Failure {
    /// An argument that cannot be used, with the likely fix.
    pub fn argument(message: impl fmt::Display, help: impl fmt::Display) -> Self {
        Self::Argument { message: message.to_string(), help: Some(help.to_string()) }
    }

    /// What is wrong, in one line, where it is an argument or the work.
    pub fn message(&self) -> &str {
        match self {
            Self::Argument { message, .. } | Self::Work { message } => message,
            _ => "see above",
        }
    }

    /// Tells the user and chooses the exit code.
    pub fn report(&self, voice: &Voice) -> ExitCode {
        match self {
            Self::Scenario(ReadError::Faults(list)) => {
                if voice.json {
                    // The verb's result would have been JSON: so is its refusal.
                    let _ = voice.json(&faults_as_json(list));
                }
                for diagnostic in diagnostics(list) {
                    voice.error(format_args!("{:?}", miette::Report::new(diagnostic)));
                }
                let count = list.problems.len();
                let plural = if count == 1 { "" } else { "s" };
                voice
                    .error(format_args!("{count} problem{plural} in {}; `toolroom explain CODE` says more", list.file));
                ExitCode::from(2)
            }
            Self::Scenario(error) => self.plain(voice, error, None, 2),
            Self::Argument { message, help } => self.plain(voice, message, help.as_deref(), 2),
            Self::Work { message } => self.plain(voice, message, None, 1),
            Self::Interrupted { replications, path } => {
                let plural = if *replications == 1 { " is" } else { "s are" };
                let message = format!(
                    "interrupted: {replications} replication{plural} complete and written to {}",
                    path.display()
                );
                self.plain(voice, message, None, 1)
            }
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
        voice.error(format_args!("error: {message}"));
        if let Some(help) = help {
            voice.error(format_args!("  help: {help}"));
        }
        ExitCode::from(code)
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::Scenario(error)
    }
}

/// The faults of a scenario for programs.
fn faults_as_json(list: &FaultList) -> serde_json::Value {
    let problems: Vec<serde_json::Value> = list
        .problems
        .iter()
        .map(|problem| {
            let place = list.place(problem);
            serde_json::json!({
                "code": problem.fault.code(),
                "file": list.source(place.origin).0,
                "line": place.line,
                "column": place.column,
                "message": problem.fault.to_string(),
                "fix": problem.fault.fix(),
            })
        })
        .collect();
    serde_json::json!({ "schema": 1, "file": list.file, "valid": false, "problems": problems })
}

/// One fault with the text around it.
#[derive(Debug)]
struct Excerpt {
    fault: Fault,
    source: NamedSource<String>,
    label: Option<LabeledSpan>,
}

fn diagnostics(list: &FaultList) -> impl Iterator<Item = Excerpt> {
    list.problems.iter().map(|problem| {
        let place = list.place(problem);
        let (name, text) = list.source(place.origin);
        // A fault of the file as a whole points at its first line, an empty file has none.
        let label = (!text.is_empty()).then(|| LabeledSpan::new_with_span(None, first_line(text, place.span.clone())));
        Excerpt { fault: problem.fault.clone(), source: NamedSource::new(name, text.to_owned()), label }
    })
}

/// A section's span reaches over its lines; the first is enough to find it.
fn first_line(text: &str, span: std::ops::Range<usize>) -> std::ops::Range<usize> {
    let length = text.get(span.clone()).and_then(|part| part.find(['\n', '\r'])).unwrap_or(span.len());
    span.start..span.start + length
}

impl fmt::Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fault.fmt(f)
    }
}

impl std::error::Error for Excerpt {}

impl Diagnostic for Excerpt {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.fault.code()))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.fault.fix().map(|fix| Box::new(fix) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.label.clone().into_iter()))
    }
}
