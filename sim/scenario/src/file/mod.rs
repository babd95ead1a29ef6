//! Scenario files: TOML in, a resolved [`Scenario`] or every fault with its place out.
//!
//! ```text
//!  bytes ─decode─► text ─TOML─► tree ◄─ --set key=value
//!                                │ walk: units, ranges, unknown and missing keys, by the
//!                                │       tables of keys.rs
//!                                ▼
//!                             sections ─resolve: names, parameter sets, contradictions─► Scenario
//! ```
//! The tables in `keys.rs` say everything about every key once: kind, unit, range, default,
//! meaning. Reader, JSON schema ([`schema`]), the echo of `toolroom check` and the error texts
//! are made from them.

mod choices;
mod error;
mod explain;
mod fault;
mod form;
mod imported;
mod keys;
mod outline;
mod overrides;
mod planned;
mod processes;
mod resolve;
mod routing;
mod rules;
mod schema;
mod speed;
mod stability;
#[cfg(test)]
mod tests;
mod text;
mod walk;
mod words;

#[cfg(test)]
pub(crate) use choices::tests::speed_rules;
pub use error::{FaultList, Origin, Place, ReadError};
pub use explain::{CODES, explain};
pub use fault::{Fault, nearest};
pub use form::{Form, Key, Kind, Need, Quantity, When};
pub use keys::{GAP, SCENARIO, SENSORS};
pub use outline::Outline;
pub use processes::{deviations, scatter};
pub use rules::{gap as gap_section, sensors};
pub use schema::schema;
pub use walk::{Echo, Problem, Section, Walk};
pub use words::significant;

use super::{GapSection, Scenario};
use std::path::{Path, PathBuf};
use toml::de::DeTable;
use toolroom_process::parameters::place;

/// What a scenario file says.
#[derive(Clone, Debug)]
pub struct ScenarioFile {
    /// What is simulated.
    pub scenario: Scenario,
    /// Every value as it was understood, defaults included, in the order of the sections.
    pub echo: Vec<Echo>,
    /// What is to be written.
    pub output: Output,
    /// Priors and sensors of a gap diagnosis.
    pub gap: Option<GapSection>,
    /// The text, for records of what was run.
    pub text: String,
    /// Other files that it names: cycles, contours, structures, units.
    pub files: Vec<PathBuf>,
}

/// The section `[output]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Log tables as CSV instead of Parquet.
    pub csv: bool,
    /// Whether log tables are written at all.
    pub logs: bool,
}

/// Reads a scenario file; `overrides` are `path=value` as after `--set`.
///
/// # Errors
/// [`ReadError`]: the file cannot be opened or decoded, or every fault found in it.
pub fn read(path: &Path, overrides: &[String]) -> Result<ScenarioFile, ReadError> {
    read_form(path, overrides, &SCENARIO, resolve::scenario).map(ScenarioFile::new)
}

/// Reads the text of a scenario; `file` is its name in messages.
///
/// # Errors
/// [`ReadError::Faults`] with every fault found.
///
/// # Examples
/// ```
/// use toolroom_scenario::file::{ReadError, parse};
/// let Err(ReadError::Faults(list)) = parse("shop.toml", "schema = 1\n[shpo]\n", &[]) else { panic!() };
/// assert!(list.to_string().starts_with("shop.toml:1:1: "));
/// assert!(list.problems.iter().any(|problem| problem.fault.code() == "unknown-key"));
/// ```
pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<ScenarioFile, ReadError> {
    parse_form(file, text, overrides, &SCENARIO, resolve::scenario).map(ScenarioFile::new)
}

/// A file of some [`Form`], understood.
#[derive(Clone, Debug)]
pub struct FormFile<T> {
    /// What it says.
    pub content: T,
    /// Every value as it was understood, defaults included, in the order of the sections.
    pub echo: Vec<Echo>,
    /// The text, for records of what was computed.
    pub text: String,
    /// Other files that it names.
    pub files: Vec<PathBuf>,
}

impl ScenarioFile {
    fn new(file: FormFile<(Scenario, Output, Option<GapSection>)>) -> Self {
        let FormFile { content: (scenario, output, gap), echo, text, files } = file;
        Self { scenario, echo, output, gap, text, files }
    }
}

/// Reads a TOML file of another kind than a shop by the same rules: `form` describes its top
/// level, with a key `schema`, and `resolve` turns the sections into what the file means.
///
/// # Errors
/// As [`read`].
pub fn read_form<T>(
    path: &Path,
    overrides: &[String],
    form: &'static Form,
    resolve: impl FnOnce(&mut Walk, &Section<'_>) -> Option<T>,
) -> Result<FormFile<T>, ReadError> {
    let file = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|source| ReadError::Unreadable { file: file.clone(), source })?;
    parse_form(&file, &text::decode(&file, &bytes)?, overrides, form, resolve)
}

/// [`read_form`] of a text; `file` is its name in messages.
///
/// # Errors
/// As [`parse`].
pub fn parse_form<T>(
    file: &str,
    text: &str,
    overrides: &[String],
    form: &'static Form,
    resolve: impl FnOnce(&mut Walk, &Section<'_>) -> Option<T>,
) -> Result<FormFile<T>, ReadError> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    let folder = Path::new(file).parent().map(Path::to_path_buf).unwrap_or_default();
    let mut walk = Walk { folder, ..Walk::default() };
    let (mut root, errors) = DeTable::parse_recoverable(text);
    let mut last_line = 0;
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        // One slip often gives several messages about its line; the first says what it is.
        let (line, _) = place(text, span.start);
        if line != last_line {
            walk.fault(span, Fault::Syntax { message: error.message().to_owned() });
        }
        last_line = line;
    }
    let broken = !walk.problems.is_empty();
    let mut base = text.len() + 1;
    for each in overrides {
        overrides::apply(&mut walk, root.get_mut(), each, base);
        base += each.len() + 1;
    }
    // What follows from a file that is not TOML says nothing about its content.
    let resolved = if broken {
        None
    } else {
        let root = walk.section(form, "", root.get_ref(), 0..0, None);
        if let Some(read) = root.count("schema").filter(|version| *version != 1) {
            walk.fault(root.span_of("schema"), Fault::Schema { read });
        }
        resolve(&mut walk, &root)
    };
    match resolved {
        Some(content) if walk.problems.is_empty() => {
            Ok(FormFile { content, echo: walk.echo, text: text.to_owned(), files: walk.files })
        }
        _ => {
            walk.problems.sort_by_key(|problem| problem.span.start);
            let list = FaultList {
                file: file.to_owned(),
                text: text.to_owned(),
                overrides: overrides.to_vec(),
                problems: walk.problems,
            };
            Err(ReadError::Faults(Box::new(list)))
        }
    }
}
