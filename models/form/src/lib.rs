//! Files in TOML: what a kind of file may say is described once, and everything else is made from that.
//!
//! ```text
//!  bytes ─decode─► text ─TOML─► tree ◄─ --set key=value
//!                                │ Walk: units, ranges, unknown and missing keys, by the Form
//!                                ▼
//!                             Sections ─resolve: what the kind of file means by them─► content
//! ```
//! A [`Form`] says everything about every key once: kind, unit, range, default, meaning. The reader
//! ([`read`], [`parse`]), the JSON schema ([`schema`]()), the values as they were understood
//! ([`Echo`]) and the error texts are made from it. A file is answered with all its faults at once,
//! each with its line and column ([`FaultList`]).
//!
//! | module | what it is |
//! |---|---|
//! | `form` | keys, kinds, ranges |
//! | `walk`, `section` | sections read by their form |
//! | `record` | tables of which a record says keys, units and ranges |
//! | `fault`, `error`, `codes` | what can be wrong, where, how to mend it, longer texts |
//! | `reference` | the keys of a form as a page for people |
//! | `syntax` | TOML texts as trees, with what is wrong in them |
//! | `refusal` | what a model refuses of a file whose form is right |
//! | `shipped` | files that the program holds, `builtin:NAME` |
//! | `sets` | parameter sets that a crate ships, by their names |
//! | `overrides` | single values replaced before the file is read |
//! | `vocabulary` | lists of words, each with the variant that it becomes |
//!
//! # What is not modelled
//! Files of other formats; JSON is read by `serde_json`, tables by the rooms that own them.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod codes;
mod encoding;
mod error;
mod fault;
mod form;
mod outline;
mod overrides;
mod record;
mod reference;
mod refusal;
mod schema;
mod section;
mod sets;
mod shipped;
mod syntax;
mod text;
mod vocabulary;
mod walk;
mod words;

pub use codes::CODES;
pub use encoding::{Encoding, Undecodable, utf16_lossy};
pub use error::{FaultList, Origin, Place, ReadError};
pub use fault::{ContentFault, Fault, Problem, nearest};
pub use form::{CURRENCIES, Content, Form, Key, KeyCondition, Kind, Need, Quantity, joined, record_keys, same};
pub use outline::Outline;
pub use record::{fill_record, set_parameters, set_record};
pub use reference::reference;
pub use refusal::{Refusal, key_place};
pub use schema::{field, schema};
pub use section::{RuleTable, Section, SectionValue, Span, Value};
pub use sets::{UnknownSet, shipped_set};
pub use shipped::{SHIPPED, bytes, is_shipped, place_of, shipped_names};
pub use walk::{Echo, Walk};
pub use words::{display, example, significant};

use std::path::{Path, PathBuf};

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

/// Reads a TOML file: `form` describes its top level, and `resolve` turns the sections into what
/// the file means; `overrides` are `path=value` as after `--set`. Where `form` has a key `schema`,
/// it must be 1.
///
/// # Errors
/// [`ReadError`]: the file cannot be opened or decoded, or every fault found in it.
pub fn read<T>(
    path: &Path,
    overrides: &[String],
    form: &'static Form,
    resolve: impl FnOnce(&mut Walk, &Section<'_>) -> Option<T>,
) -> Result<FormFile<T>, ReadError> {
    let place = place_of(path);
    parse(&place.display().to_string(), &text(&place)?, overrides, form, resolve)
}

/// The text of a file of the disk or a shipped one, without the mark that some editors put before it.
///
/// # Errors
/// [`ReadError`]: the file cannot be opened or decoded.
pub fn text(path: &Path) -> Result<String, ReadError> {
    let file = path.display().to_string();
    let bytes = bytes(path).map_err(|source| ReadError::Unreadable { file: file.clone(), source })?;
    let text = text::decode(&file, &bytes)?;
    Ok(text.strip_prefix('\u{FEFF}').unwrap_or(&text).to_owned())
}

/// [`read`] of a text; `file` is its name in messages.
///
/// # Errors
/// [`ReadError::Faults`] with every fault found.
pub fn parse<T>(
    file: &str,
    text: &str,
    overrides: &[String],
    form: &'static Form,
    resolve: impl FnOnce(&mut Walk, &Section<'_>) -> Option<T>,
) -> Result<FormFile<T>, ReadError> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    let folder = Path::new(file).parent().map(Path::to_path_buf).unwrap_or_default();
    let ends = text.match_indices('\n').map(|(end, _)| end).collect();
    let mut walk = Walk { folder, ends, ..Walk::default() };
    let (mut root, errors) = syntax::tree(text);
    walk.problems = errors;
    let broken = !walk.problems.is_empty();
    let mut base = text.len() + 1;
    for change in overrides {
        overrides::apply(&mut walk, form, root.get_mut(), change, base);
        base += change.len() + 1;
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
