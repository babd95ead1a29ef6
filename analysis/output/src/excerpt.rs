//! Faults of files as people and programs read them: message, place, the text around it.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use serde_json::{Value, json};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;
use toolroom_form::{FaultList, Origin, Place, Problem};

/// One fault with the text around it.
#[derive(Debug)]
struct Excerpt {
    code: &'static str,
    message: String,
    fix: Option<String>,
    file: String,
    line: usize,
    column: usize,
    /// The text, one for all faults in it; none where its lines are too long to be shown.
    source: Option<Arc<NamedSource<String>>>,
    label: Option<LabeledSpan>,
}

impl Excerpt {
    /// The first faults of a file, `most` at most.
    fn first(list: &FaultList, most: usize) -> Vec<Self> {
        let mut texts: Vec<(Origin, Arc<NamedSource<String>>)> = Vec::new();
        let excerpt = |(problem, place): (&Problem, Place)| {
            let (file, text) = list.source(place.origin);
            let shown = shown(text, place.line);
            let source = shown.then(|| {
                let known = texts.iter().find(|(origin, _)| *origin == place.origin);
                known.map(|(_, source)| Arc::clone(source)).unwrap_or_else(|| {
                    let source = Arc::new(NamedSource::new(file, text.to_owned()));
                    texts.push((place.origin, Arc::clone(&source)));
                    source
                })
            });
            Self {
                code: problem.fault.code(),
                message: problem.fault.to_string(),
                fix: problem.fault.fix(),
                file: file.to_owned(),
                line: place.line,
                column: place.column,
                source,
                label: label(text, place.span).filter(|_| shown),
            }
        };
        list.problems.iter().zip(list.places()).take(most).map(excerpt).collect()
    }
}

/// The first faults of a file, `most` at most, each as people read it: code, message, the lines around its place, the fix.
pub fn shown_faults(list: &FaultList, most: usize) -> impl Iterator<Item = String> {
    Excerpt::first(list, most).into_iter().map(|fault| format!("{:?}", miette::Report::new(fault)))
}

/// Every fault of a file as programs read them: `code`, `file`, `line`, `column` (from 1), `message` and `fix`.
pub fn json_faults(list: &FaultList) -> Vec<Value> {
    let fault = |(problem, place): (&Problem, Place)| {
        json!({
            "code": problem.fault.code(),
            "file": list.source(place.origin).0,
            "line": place.line,
            "column": place.column,
            "message": problem.fault.to_string(),
            "fix": problem.fault.fix(),
        })
    };
    list.problems.iter().zip(list.places()).map(fault).collect()
}

/// The refusal of a file as programs read it: every fault as `problems`, the first as `error`, too.
pub fn json_refusal(list: &FaultList) -> Value {
    let problems = json_faults(list);
    json!({ "schema": 1, "error": problems.first(), "file": list.file, "valid": false, "problems": problems })
}

/// A fault of the file as a whole points at its first line, an empty file has none. A section's
/// span reaches over its lines; the first is enough to find it.
fn label(text: &str, span: Range<usize>) -> Option<LabeledSpan> {
    let length = text.get(span.clone()).and_then(|part| part.find(['\n', '\r'])).unwrap_or(span.len());
    (!text.is_empty()).then(|| LabeledSpan::new_with_span(None, span.start..span.start + length))
}

/// Longest line of a text that is shown around a fault, bytes.
const LONGEST_LINE: usize = 1000;

/// Whether the line of a fault and its neighbours can be shown.
fn shown(text: &str, line: usize) -> bool {
    text.lines().skip(line.saturating_sub(3)).take(5).all(|line| line.len() <= LONGEST_LINE)
}

impl fmt::Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        if self.source.is_none() {
            write!(f, " ({}, line {}, column {})", self.file, self.line, self.column)?;
        }
        Ok(())
    }
}

impl std::error::Error for Excerpt {}

impl Diagnostic for Excerpt {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.code))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.fix.as_ref().map(|fix| Box::new(fix) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|source| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.label.clone().into_iter()))
    }
}
