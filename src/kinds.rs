//! The kinds of files that toolroom reads: what tells one, its reader, the form of its schema.
//!
//! Everything that knows kinds of files, which is `check` and `schema` with their arguments, follows from [`KINDS`].

use crate::failure::Failure;
use crate::{contour, gap, grind, life};
use serde_json::{Map, Value, json};
use std::path::Path;
use toolroom_contour::{CONTOUR, SETUP};
use toolroom_form::{Echo, Form, Outline, schema};
use toolroom_gap::NominalModel;
use toolroom_infeed::CYCLE;
use toolroom_records::import::{MAPPING, Mapping};
use toolroom_scenario::file::{self, SCENARIO, ScenarioFile};
use toolroom_scenario::lobes::LOBES;

/// One kind of file.
#[derive(Debug)]
pub struct FileKind {
    /// As `check --kind` and `schema` take it.
    pub word: &'static str,
    /// One line for people.
    pub doc: &'static str,
    /// Keys and tables of which at least one stands at the top of such a file, and of no kind further down in the table.
    pub signs: &'static [&'static str],
    /// The reader of the verb; none where toolroom writes such files only.
    pub read: Option<Reader>,
    /// What describes it to editors.
    pub form: Described,
}

/// Reads a file with the values of `--set`.
type Reader = fn(&Path, &[String]) -> Result<Checked, Failure>;

/// The JSON schema of a kind.
#[derive(Debug)]
pub enum Described {
    /// Made from the form of the reader.
    By(&'static Form),
    /// Made from forms of which a file has one.
    ByOneOf(&'static [&'static Form]),
    /// A text of its own.
    Text(&'static str),
}

/// A file that its reader accepts.
pub struct Checked {
    /// Its values as they were understood, where the reader tells them.
    pub echo: Vec<Echo>,
    /// What programs are told beside file and verdict.
    pub result: Map<String, Value>,
    /// What people are told.
    pub summary: String,
}

/// Every kind; of a file with signs of several, the first counts.
pub static KINDS: &[FileKind] = &[
    FileKind {
        word: "scenario",
        doc: "A shop under policies, for run and compare",
        signs: &["shop", "part", "arrivals", "dispatch", "calendar", "failure", "deviation"],
        read: Some(scenario),
        form: Described::By(&SCENARIO),
    },
    FileKind {
        word: "lobes",
        doc: "A stability chart, for lobes",
        signs: &["chart", "mode", "engagement", "chuck", "lathe", "point"],
        read: Some(chart),
        form: Described::By(&LOBES),
    },
    FileKind {
        word: "life",
        doc: "A study of tool lives, for life",
        signs: &["condition", "lives", "sampling", "passes", "early", "replacement", "sensitivity"],
        read: Some(study),
        form: Described::By(&toolroom_life::file::STUDY),
    },
    FileKind {
        word: "cycle",
        doc: "A grinding cycle to be designed, for grind",
        signs: &["limits", "conditions", "dressing"],
        read: Some(cycle),
        form: Described::By(&CYCLE),
    },
    FileKind {
        word: "contour",
        doc: "A contour to be milled, for contour",
        signs: &["section"],
        read: Some(planned),
        form: Described::By(&CONTOUR),
    },
    FileKind {
        word: "setup",
        doc: "Passes around a contour that a part program draws, for contour --gcode",
        signs: &["pass", "cutter_side", "path_error", "form_error", "corners"],
        read: Some(setup),
        form: Described::By(&SETUP),
    },
    FileKind {
        word: "mapping",
        doc: "What the columns of a measured table are, for import csv",
        signs: &["column", "keep", "rows_per_operation"],
        read: Some(mapping),
        form: Described::By(&MAPPING),
    },
    FileKind {
        word: "gap",
        doc: "A nominal model of power laws or part programs, or a scenario taken as one, for gap",
        signs: &["gap", "drives", "program"],
        read: Some(nominal),
        form: Described::ByOneOf(&NominalModel::FORMS),
    },
    FileKind {
        word: "diagnosis",
        doc: "diagnosis.json of gap diagnose",
        signs: &[],
        read: None,
        form: Described::Text(include_str!("../scenarios/schema/diagnosis.schema.json")),
    },
];

impl FileKind {
    /// The kind of this word.
    pub fn named(word: &str) -> Option<&'static Self> {
        KINDS.iter().find(|kind| kind.word == word)
    }

    /// The kind of a file by its parsed content.
    ///
    /// # Errors
    /// The file cannot be read, or has no sign of any kind.
    pub fn of(path: &Path) -> Result<&'static Self, Failure> {
        let outline = Outline::read(path)?;
        // Every reader of a form tells all slips of a text that is not TOML, and nothing else.
        let known = KINDS.iter().find(|kind| kind.signs.iter().any(|sign| outline.has(sign)));
        known.or(outline.is_broken().then_some(&KINDS[0])).ok_or_else(|| {
            let kinds = KINDS.iter().filter(|kind| kind.read.is_some());
            let signs: Vec<String> = kinds.map(|kind| format!("{} by {}", kind.word, kind.signs.join(", "))).collect();
            Failure::argument(
                format_args!(
                    "{}: the kind of this file cannot be told; at the top of a file, each kind is told by one of its \
                     keys or tables: {}",
                    path.display(),
                    signs.join("; ")
                ),
                "name the kind with --kind, such as --kind scenario",
            )
        })
    }

    /// The JSON schema.
    ///
    /// # Errors
    /// There is none.
    pub fn schema(&self) -> Result<Value, Failure> {
        match self.form {
            Described::By(form) => Ok(schema(form, &self.title())),
            Described::ByOneOf(forms) => {
                let any: Vec<Value> = forms.iter().map(|form| schema(form, form.doc)).collect();
                Ok(json!({
                    "$schema": "https://json-schema.org/draft/2020-12/schema",
                    "title": self.title(),
                    "description": self.doc,
                    "anyOf": any,
                }))
            }
            Described::Text(text) => serde_json::from_str(text).map_err(Failure::Json),
        }
    }

    /// Its name in editors.
    fn title(&self) -> String {
        match self.word {
            "life" => "toolroom tool-life study".to_owned(),
            "lobes" => "toolroom lobes file".to_owned(),
            "gap" => "toolroom nominal model".to_owned(),
            "cycle" => "toolroom cycle file".to_owned(),
            "contour" => "toolroom contour file".to_owned(),
            "setup" => "toolroom setup file".to_owned(),
            word => format!("toolroom {word}"),
        }
    }
}

/// What a reader found in a file of a kind: `name` is its own, if it has one.
pub fn checked(word: &str, name: Option<&str>, echo: Vec<Echo>, more: &str) -> Checked {
    let mut result = Map::new();
    result.insert("kind".to_owned(), json!(word));
    result.extend(name.map(|name| ("name".to_owned(), json!(name))));
    if !echo.is_empty() {
        result.insert("values".to_owned(), json!(echo));
    }
    Checked { echo, result, summary: format!("valid: {more}") }
}

fn scenario(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let ScenarioFile { scenario, echo, .. } = file::read(path, set)?;
    // What `run` would refuse before its first event.
    for policy in 0..scenario.policies.len() {
        toolroom_shop::Shop::new(&scenario, policy, 0).map_err(|error| {
            Failure::argument(
                format_args!("policy `{}`: {error}", scenario.policies[policy].name),
                "no run would begin",
            )
        })?;
    }
    let mut result = Map::new();
    result.insert("name".to_owned(), json!(scenario.name));
    let policies: Vec<_> = scenario.policies.iter().map(|policy| &policy.name).collect();
    result.insert("policies".to_owned(), json!(policies));
    result.insert("values".to_owned(), json!(echo));
    let operations: usize = scenario.parts.iter().map(|part| part.operations.len()).sum();
    let summary = format!(
        "valid: {} machines, {} tools, {} parts with {operations} operations, {} policies, {} replications of {} h",
        scenario.machines.len(),
        scenario.tools.len(),
        scenario.parts.len(),
        scenario.policies.len(),
        scenario.replications,
        scenario.horizon / 3600.0,
    );
    Ok(Checked { echo, result, summary })
}

fn chart(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let file = toolroom_planning::lobes::read(path, set)?;
    let points = file.content.points.len();
    Ok(checked("lobes", Some(&file.content.name), file.echo, &format!("a chart with {points} operating points")))
}

fn study(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let file = life::read(path, set)?;
    let study = &file.content.study;
    let summary =
        format!("a study of {} lives in each of {} cells of condition and policy", study.lives, study.cells.len());
    Ok(checked("life", Some(&study.name), file.echo, &summary))
}

fn cycle(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let echo = grind::check(path, set)?;
    Ok(checked("cycle", None, echo, "a grinding cycle that can be worked out"))
}

fn planned(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let (name, passes, echo) = contour::check(path, set)?;
    Ok(checked("contour", Some(&name), echo, &format!("a contour with {passes} passes")))
}

fn setup(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let (passes, echo) = contour::check_setup(path, set)?;
    let summary = format!("a setup of {passes} passes; a part program draws the contour: toolroom contour --gcode");
    Ok(checked("setup", None, echo, &summary))
}

fn mapping(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let mapping = Mapping::read(path, set)?;
    let summary = format!("a mapping of {} columns to {} records", mapping.columns.len(), mapping.kind.name());
    Ok(checked("mapping", None, Vec::new(), &summary))
}

fn nominal(path: &Path, set: &[String]) -> Result<Checked, Failure> {
    let model = gap::nominal_of(path, set)?;
    Ok(checked("gap", None, Vec::new(), &format!("a nominal model of {} records", model.kind().name())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_is_a_key_of_its_kind_and_of_none_further_down() {
        for (i, kind) in KINDS.iter().enumerate() {
            for sign in kind.signs {
                assert!(KINDS[i + 1..].iter().all(|other| !other.signs.contains(sign)), "{sign}");
                if let Described::By(form) = kind.form {
                    assert!(form.key(sign).is_some(), "{} has no {sign}", kind.word);
                }
                for other in KINDS.iter().skip(i + 1) {
                    let Described::By(form) = other.form else { continue };
                    assert!(form.key(sign).is_none(), "{} has {sign} of {} too", other.word, kind.word);
                }
            }
        }
    }
}
