//! What can be wrong in a file, and the likely fix of each.

use std::error::Error;
use std::ops::Range;
use std::sync::Arc;
use toolroom_process::ModelError;
use toolroom_process::unit::UnitError;

/// A fault that only a kind of file knows, such as a tool that no operation uses.
pub trait ContentFault: Error + Send + Sync {
    /// Stable code, for `toolroom explain`.
    fn code(&self) -> &'static str;

    /// The likely fix, where one can be told.
    fn fix(&self) -> Option<String> {
        None
    }
}

/// A fault and the text that it is about.
#[derive(Clone, Debug)]
pub struct Problem {
    /// What is wrong.
    pub fault: Fault,
    /// Bytes of the text.
    pub span: Range<usize>,
}

/// One thing that is wrong in a file.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// Not TOML.
    #[error("{message}")]
    Syntax {
        /// What the TOML reader says.
        message: String,
    },
    /// A format version that this program does not read.
    #[error("schema = {read} is not known; this program reads schema = 1")]
    Schema {
        /// What was read.
        read: u64,
    },
    /// A key that the section does not have.
    #[error("{section} has no key `{key}`")]
    UnknownKey {
        /// The section as people write it.
        section: String,
        /// What was read.
        key: String,
        /// The most similar key.
        nearest: Option<&'static str>,
        /// Every key that exists.
        known: String,
    },
    /// A key that has to be given.
    #[error("{section} lacks `{key}`")]
    MissingKey {
        /// The section as people write it.
        section: String,
        /// The key.
        key: &'static str,
        /// A value that would do.
        example: String,
    },
    /// A key that says nothing here.
    #[error("`{key}` does not apply to {case}")]
    NotApplicable {
        /// The key.
        key: &'static str,
        /// The case at hand, such as `pattern = "batch"`.
        case: String,
        /// Keys that do apply.
        applicable: String,
    },
    /// A value of another kind than the key takes.
    #[error("`{key}` is {read}, but {expected} is due")]
    WrongType {
        /// The key.
        key: String,
        /// What was read.
        read: String,
        /// What was expected.
        expected: String,
        /// A value that would do.
        example: String,
    },
    /// A quantity that cannot be read in the unit of its key.
    #[error("`{key}`: {reason}")]
    Quantity {
        /// The key.
        key: String,
        /// What is wrong.
        reason: UnitError,
        /// A value that would do.
        example: String,
    },
    /// A value outside its range, infinite, or not a number.
    #[error("`{key}` = {read} is outside {range}")]
    OutOfRange {
        /// The key.
        key: String,
        /// What was read.
        read: String,
        /// The range in display units.
        range: String,
        /// The same number in other units that would be in range.
        meant: Vec<String>,
    },
    /// A word that is not among the choices.
    #[error("`{key}` = \"{read}\" is not known")]
    UnknownChoice {
        /// The key.
        key: String,
        /// What was read.
        read: String,
        /// The most similar choice.
        nearest: Option<String>,
        /// Every choice.
        choices: String,
    },
    /// A name that nothing carries.
    #[error("there is no {kind} \"{name}\"")]
    UnknownName {
        /// Kind of thing: `machine`, `tool`, …
        kind: &'static str,
        /// What was read.
        name: String,
        /// The most similar name.
        nearest: Option<String>,
        /// Every name.
        known: String,
    },
    /// Two things of one name.
    #[error("two {} are called \"{name}\"", plural(kind))]
    DuplicateName {
        /// Kind of thing.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Nothing where at least one is needed.
    #[error("there is no {what}")]
    Nothing {
        /// What is missing, such as `machine`.
        what: &'static str,
        /// What to write.
        example: &'static str,
    },
    /// A currency other than the shop's.
    #[error("{read} stands beside {expected}: a shop has one currency")]
    MixedCurrency {
        /// What was read.
        read: String,
        /// The shop's currency.
        expected: String,
    },
    /// Two values that cannot both hold.
    #[error("`{first}` = {first_value} and `{second}` = {second_value} contradict each other: {rule}")]
    Contradiction {
        /// One key.
        first: &'static str,
        /// Its value.
        first_value: String,
        /// The other key.
        second: &'static str,
        /// Its value.
        second_value: String,
        /// The rule that they break.
        rule: &'static str,
    },
    /// A file named in the file that cannot be opened.
    #[error("{file} cannot be read: {reason}")]
    Unreadable {
        /// The file as written.
        file: String,
        /// What the system says.
        reason: std::io::ErrorKind,
    },
    /// A table named in the file that does not hold what is due.
    #[error("{reason}")]
    Table {
        /// The table and its place, and what is wrong there.
        reason: String,
    },
    /// A file named in the file that is not UTF-8.
    #[error("{file} is not UTF-8")]
    NotUtf8 {
        /// The file as written.
        file: String,
    },
    /// A key that says nothing beside another one.
    #[error("`{key}` does not apply beside `{beside}`: {rule}")]
    Beside {
        /// The key.
        key: &'static str,
        /// The other key.
        beside: &'static str,
        /// Why.
        rule: &'static str,
    },
    /// What a process model or effect refuses.
    #[error("{subject}: {reason}")]
    Model {
        /// Tool or key.
        subject: String,
        /// What is wrong.
        reason: ModelError,
    },
    /// A `--set` that is no `key=value`.
    #[error("`{read}` is not of the form key=value")]
    OverrideForm {
        /// What was read.
        read: String,
    },
    /// A `--set` whose path leads nowhere.
    #[error("`{segment}` is not in the file")]
    OverridePath {
        /// The segment that was not found.
        segment: String,
        /// The most similar one.
        nearest: Option<String>,
        /// What there is.
        known: String,
    },
    /// What only the kind of file knows.
    #[error(transparent)]
    Content(Arc<dyn ContentFault>),
}

impl Fault {
    /// Stable code, for `toolroom explain`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Syntax { .. } => "syntax",
            Self::Schema { .. } => "schema",
            Self::UnknownKey { .. } => "unknown-key",
            Self::MissingKey { .. } => "missing-key",
            Self::NotApplicable { .. } => "not-applicable",
            Self::WrongType { .. } => "wrong-type",
            Self::Quantity { .. } => "quantity",
            Self::OutOfRange { .. } => "out-of-range",
            Self::UnknownChoice { .. } => "unknown-choice",
            Self::UnknownName { .. } => "unknown-name",
            Self::DuplicateName { .. } => "duplicate-name",
            Self::Nothing { .. } => "nothing-there",
            Self::MixedCurrency { .. } => "mixed-currency",
            Self::Contradiction { .. } => "contradiction",
            Self::Unreadable { .. } | Self::NotUtf8 { .. } | Self::Table { .. } => "file",
            Self::Beside { .. } => "beside",
            Self::Model { .. } => "model",
            Self::OverrideForm { .. } | Self::OverridePath { .. } => "override",
            Self::Content(fault) => fault.code(),
        }
    }

    /// The likely fix, where one can be told.
    pub fn fix(&self) -> Option<String> {
        let near = |nearest: Option<&str>, known: &str| match nearest {
            Some(nearest) => format!("did you mean `{nearest}`? known: {known}"),
            None => format!("known: {known}"),
        };
        Some(match self {
            Self::UnknownKey { nearest, known, .. } => near(*nearest, known),
            Self::UnknownChoice { nearest, choices: known, .. }
            | Self::UnknownName { nearest, known, .. }
            | Self::OverridePath { nearest, known, .. } => near(nearest.as_deref(), known),
            Self::MissingKey { key, example, .. } => format!("add `{key} = {example}`"),
            Self::NotApplicable { applicable, .. } => format!("keys that apply here: {applicable}"),
            Self::WrongType { example, .. } | Self::Quantity { example, .. } => format!("write for example {example}"),
            Self::OutOfRange { meant, .. } if !meant.is_empty() => format!("did you mean {}?", meant.join(" or ")),
            Self::DuplicateName { kind, .. } => format!("give one {kind} another name"),
            Self::Nothing { example, .. } => format!("add {example}"),
            Self::MixedCurrency { expected, .. } => format!("convert the amount to {expected}"),
            Self::Beside { key, .. } => format!("remove `{key}`"),
            Self::Schema { .. } => "write schema = 1".to_owned(),
            Self::OverrideForm { .. } => "write for example --set machine.L1.tool_change_time=\"1 min\"".to_owned(),
            Self::Unreadable { .. } => "paths count from the folder of the file that names them".to_owned(),
            Self::Content(fault) => return fault.fix(),
            Self::NotUtf8 { .. } => "save it as UTF-8".to_owned(),
            Self::Syntax { .. }
            | Self::OutOfRange { .. }
            | Self::Contradiction { .. }
            | Self::Table { .. }
            | Self::Model { .. } => return None,
        })
    }
}

/// Letters from which on the beginning of a word stands for the word.
const BEGUN: usize = 4;

/// The text nearest to `read` among `known`, where it is near enough to be a slip.
///
/// ```
/// use toolroom_form::nearest;
/// assert_eq!(nearest("cuting_speed", ["cutting_speed", "depth_of_cut"]), Some("cutting_speed"));
/// ```
pub fn nearest<'a>(read: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let read = read.to_lowercase();
    let length = read.chars().count();
    let limit = 1 + length / 3;
    let distances = known.into_iter().filter_map(|name| {
        let word = name.to_lowercase();
        // A word that was only begun is nearer than one that differs.
        if length >= BEGUN && word.starts_with(&read) {
            return Some((0, name));
        }
        // As many letters as one is longer are missing at least: a flood of letters is compared with nothing.
        let missing = word.chars().count().abs_diff(length);
        (missing <= limit).then(|| (strsim::damerau_levenshtein(&read, &word), name))
    });
    distances.filter(|(distance, _)| *distance <= limit).min_by_key(|(distance, _)| *distance).map(|(_, name)| name)
}

/// The word for several things of a kind.
fn plural(kind: &str) -> String {
    match kind.strip_suffix('y') {
        Some(stem) => format!("{stem}ies"),
        None => format!("{kind}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::{Fault, nearest};

    #[test]
    fn two_things_of_one_name_are_told_in_the_plural() {
        let message = |kind| Fault::DuplicateName { kind, name: "A".to_owned() }.to_string();
        assert_eq!(message("policy"), "two policies are called \"A\"");
        assert_eq!(message("tool"), "two tools are called \"A\"");
    }

    #[test]
    fn a_slip_finds_its_word_and_nonsense_none() {
        let known = ["cutting_speed", "depth_of_cut"];
        assert_eq!(nearest("cuting_speed", known), Some("cutting_speed"));
        assert_eq!(nearest("zzz", known), None);
        assert_eq!(nearest("flank_shear", ["flank_pressure", "flank_shear_stress"]), Some("flank_shear_stress"));
    }
}
