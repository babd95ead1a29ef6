//! The kinds of files that toolroom reads: what tells one, its reader, the form of its schema.
//!
//! Everything that knows kinds of files, which is `check`, `schema`, `new` and `reference` with their arguments, follows from
//! [`KINDS`].
//!
//! ```
//! use std::path::Path;
//! use toolroom_kinds::FileKind;
//! # std::env::set_current_dir("../..").unwrap();
//! let file = Path::new("scenarios/grinding/cycle.toml");
//! let kind = FileKind::from_path(file).unwrap();
//! assert_eq!(kind.word, "cycle");
//! let found = (kind.read.unwrap())(file, &["limits.stock=\"-1 mm\"".to_owned()]);
//! assert!(found.is_err());
//! ```
//!
//! # What is not modelled
//! Tables (CSV, Parquet): they have no keys, and what reads them says what is wrong. A file that a verb reads beside
//! another one, such as the part program of a setup, is looked at by the verb.

#![deny(clippy::wildcard_enum_match_arm)]

mod base;
mod checked;
mod diagnosis;
mod empirical;
mod error;
mod foreign;
mod load_table;
mod places;
mod plan;
mod presence;
mod readers;
mod records;
mod reference;
mod samples;
mod scopes;
mod truncated;
mod warning;
mod workload;

/// Codes of errors of this crate for `toolroom explain`, each with a longer text.
pub const CODES: &[(&str, &str)] = &[
    (
        "variant",
        "A [[variant]] is the same file with other values: its `set` names them by their paths, as after --set, such as \"machine.CMM.count\" = 3. The message says what the file with these values is refused for. `toolroom check FILE --set ...` with the same paths shows it alone.",
    ),
    (
        "plan",
        "A plan of shards holds its study as it was planned: text, changes, seed, fingerprints of the files that it names. Shards of two plans are never merged, so a plan is run by the version that made it and as it was written; to change anything, make a new plan with --plan.",
    ),
    (
        "overload",
        "A warning of check, run and compare: a station, or everybody who has a skill, has more work than working time until the horizon, or until a due date. The queue before it then grows without end, and lead times say how long was simulated. The same is said before run and compare begin. Mean times, one setup a lot where more than one group comes, no tool changes, no breakdowns: the true load is greater. Lower the arrivals, or add machines, people or hours.",
    ),
    (
        "memory",
        "A warning before run and compare: a station has so much more work than working time that the jobs before it would fill the memory that --max-memory allows (half of the machine if left out) before the horizon. Mean times; the run begins all the same, and what is finished when it ends is kept. Lower the arrivals, shorten the horizon, or add machines.",
    ),
    (
        "diagnosis",
        "diagnosis.json is held against its schema (toolroom schema diagnosis): the message names the entry, what stands there and what is due. Diagnosis files are written by gap diagnose and read by gap apply; one of an earlier version is made anew by diagnosing again.",
    ),
    (
        "records",
        "A table of records has one row an operation, cut, trial, event or stretch; `toolroom schema records` lists the columns of each kind with their units, and a header has its unit in brackets, such as `cutting_time [min]`. Tables of other people become records by a mapping: toolroom import csv LOG --map MAP --out DIR.",
    ),
    (
        "late",
        "A warning of check: an order cannot be finished by its due date even if nothing else is in the shop, every machine stands ready and nothing is set up.",
    ),
    (
        "never-there",
        "A warning of check: an operation needs somebody with a skill, and everybody who has it works only while all machines of the operation rest. The step waits for ever, and with it its order. Let calendars overlap, give somebody else the skill, or take it out of the operation.",
    ),
    (
        "no-effect",
        "A warning of check: `replenish` says what is done about pieces of an order that are lost, and no order is of this part. Jobs of sources are not made up for. Take the key out, or add orders of the part.",
    ),
    (
        "never-finished",
        "A warning of check: inspections scrap every piece of a part, and its orders begin lost pieces anew, so that they go on until the horizon and are never finished. Lower the shares of `outcomes` that scrap, or raise `rework_max`.",
    ),
    (
        "rate-counted-twice",
        "A warning of check: operators have a `rate`, and machines that they attend to have one as well. Where people have rates, the rate of a machine is the machine alone; a file whose machine rates hold the wages of operators counts these twice.",
    ),
    (
        "true-mean",
        "A warning of check: a normal time is drawn between its `low` (0) and its `high` only, not clipped there, so that its mean is not the `mean` of the whole distribution. The line says what it truly is. Nothing is changed; where the mean matters, take a family that has no negative values, such as lognormal or gamma.",
    ),
    (
        "empirical",
        "A warning of check: an effect of the file has kind = \"empirical\". It describes what records showed without saying why, such as a term that gap diagnose --propose has written. It holds where it was seen; its formula keeps the value of the end of that range beyond it. Look for the cause before a plan rests on it.",
    ),
    (
        "acts-together",
        "A warning of check: two entries of the same effect, or two calibrations of the same value, can act on one operation. Their factors multiply and what they add is added, in the order of the file. Where only one of them is meant, write the operations of each into its `scope`.",
    ),
    (
        "records-only",
        "A warning of check: something is scoped by `material` or `operator`. A simulated shop has neither, so that it acts on the records of a diagnosis and in no run.",
    ),
    (
        "coefficients",
        "A file of cutting-force coefficients that a lobes file names by `coefficients` cannot be used: it is no such file, or a coefficient is missing, negative or without its deviation. `toolroom coefficients` writes one, and `toolroom check FILE` tells its faults line by line.",
    ),
    (
        "unusual",
        "A warning of check and of coefficients: the value is admitted, and shops rarely have it. The usual cause is a slip of the unit, such as a diameter of 0.12 mm for 0.12 m or a feed per minute taken for one per revolution. Nothing is changed; a value that is meant can stay.",
    ),
];

pub use checked::{CheckResult, Reader, checked};
pub use error::KindError;
pub use samples::Sample;
pub use warning::Warning;
pub use workload::overloads;

use serde_json::{Value, json};
use std::path::Path;
use toolroom_contour::{CONTOUR, SETUP};
use toolroom_effects::EFFECTS_FILE;
use toolroom_form::{Form, Outline, schema};
use toolroom_infeed::CYCLE;
use toolroom_lobes::{COEFFICIENTS, LOBES, STRUCTURE};
use toolroom_modes::TOOL;
use toolroom_nominal::NominalModel;
use toolroom_records::import::MAPPING;
use toolroom_scenario_file::SCENARIO;

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
    pub form: SchemaSource,
}

/// The JSON schema of a kind.
#[derive(Debug)]
pub enum SchemaSource {
    /// Made from the form of the reader.
    By(&'static Form),
    /// Made from forms of which a file has one.
    ByOneOf(&'static [&'static Form]),
    /// A text of its own.
    Text(&'static str),
    /// Made from the columns of tables.
    Rows(fn() -> Value),
}

/// Every kind; of a file with signs of several, the first counts.
pub static KINDS: &[FileKind] = &[
    FileKind {
        word: "scenario",
        doc: "A shop under policies, for run and compare",
        signs: &["shop", "part", "arrivals", "dispatch", "calendar", "failure", "deviation"],
        read: Some(readers::scenario),
        form: SchemaSource::By(&SCENARIO),
    },
    FileKind {
        word: "effects",
        doc: "Effects of your own, for --effects of gap and point",
        signs: &["effect"],
        read: Some(readers::effects),
        form: SchemaSource::By(&EFFECTS_FILE),
    },
    FileKind {
        word: "structure",
        doc: "Vibration modes from a tap test, for `structure` of lobes files; modes writes them",
        signs: &["measurement", "covariance", "residual", "station", "mass_loss"],
        read: Some(readers::structure),
        form: SchemaSource::By(&STRUCTURE),
    },
    FileKind {
        word: "coefficients",
        doc: "Cutting-force coefficients, for `coefficients` of lobes files; coefficients writes them",
        signs: &["tangential", "edge_tangential"],
        read: Some(readers::coefficients),
        form: SchemaSource::By(&COEFFICIENTS),
    },
    FileKind {
        word: "tool",
        doc: "A tool as round segments, for swap",
        signs: &["segment"],
        read: Some(readers::tool),
        form: SchemaSource::By(&TOOL),
    },
    FileKind {
        word: "lobes",
        doc: "A stability chart, for lobes",
        signs: &["chart", "mode", "chuck", "lathe", "point"],
        read: Some(readers::chart),
        form: SchemaSource::By(&LOBES),
    },
    FileKind {
        word: "life",
        doc: "A study of tool lives, for life",
        signs: &["condition", "lives", "sampling", "passes", "early", "replacement", "sensitivity"],
        read: Some(readers::study),
        form: SchemaSource::By(&toolroom_life::file::STUDY),
    },
    FileKind {
        word: "program-setup",
        doc: "Stock and tools of a part program, for program --setup",
        signs: &["stock"],
        read: Some(readers::program_setup),
        form: SchemaSource::By(&toolroom_stock::SETUP),
    },
    FileKind {
        word: "cycle",
        doc: "A grinding cycle to be designed, for grind",
        signs: &["limits", "conditions", "dressing"],
        read: Some(readers::cycle),
        form: SchemaSource::By(&CYCLE),
    },
    FileKind {
        word: "contour",
        doc: "A contour to be milled, for contour",
        signs: &["section"],
        read: Some(readers::planned),
        form: SchemaSource::By(&CONTOUR),
    },
    FileKind {
        word: "setup",
        doc: "Passes around a contour that a part program draws, for contour --gcode",
        signs: &["pass", "cutter_side", "path_error", "form_error", "corners"],
        read: Some(readers::setup),
        form: SchemaSource::By(&SETUP),
    },
    FileKind {
        word: "mapping",
        doc: "What the columns of a measured table are, for import csv",
        signs: &["column", "keep", "rows_per_operation"],
        read: Some(readers::mapping),
        form: SchemaSource::By(&MAPPING),
    },
    FileKind {
        word: "shop-mapping",
        doc: "What the tables of an order system are, for import shop",
        signs: &["table"],
        read: Some(readers::shop_mapping),
        form: SchemaSource::By(&toolroom_shop_import::SHOP_MAPPING),
    },
    FileKind {
        word: "gap",
        doc: "A nominal model of power laws or part programs, or a scenario taken as one, for gap",
        signs: &["gap", "program"],
        read: Some(readers::nominal),
        form: SchemaSource::ByOneOf(&NominalModel::FORMS),
    },
    FileKind {
        word: "machine",
        doc: "The control, drives, spindle and tool changer of a machine, for program --drives",
        signs: &["drives", "control"],
        read: Some(readers::machine),
        form: SchemaSource::By(&toolroom_drives::MACHINE),
    },
    FileKind {
        word: "parameter-set",
        doc: "Constants of one tool in one work material, for parameter_set of tools and believed_model of policies",
        signs: &["based_on", "handbook", "law", "material", "prior", "parameters"],
        read: Some(readers::parameter_set),
        form: SchemaSource::By(&toolroom_wear::PARAMETER_SET),
    },
    plan::KIND,
    diagnosis::KIND,
    records::KIND,
];

impl FileKind {
    /// The kind of this word.
    pub fn named(word: &str) -> Option<&'static Self> {
        KINDS.iter().find(|kind| kind.word == word)
    }

    /// What `new` writes to begin with.
    ///
    /// # Panics
    /// Never: every kind has an example, which a test asks.
    pub fn sample(&self) -> &'static Sample {
        if self.word == plan::KIND.word {
            return samples::plan();
        }
        let sample = samples::SAMPLES.iter().find(|(word, _)| *word == self.word);
        sample.map(|(_, sample)| *sample).expect("every kind has an example")
    }

    /// The kind of a file by its parsed content.
    ///
    /// # Errors
    /// The file cannot be read, or has no sign of any kind.
    pub fn from_path(path: &Path) -> Result<&'static Self, KindError> {
        if records::by_place(path) {
            return Ok(&records::KIND);
        }
        let no_keys = |reader| KindError::NoKeys { file: path.display().to_string(), reader };
        let text = toolroom_form::text(path).map_err(|error| {
            let bytes = toolroom_form::bytes(path).ok();
            let reader = bytes.and_then(|bytes| foreign::reader_of_bytes(path, &bytes));
            reader.map_or_else(|| error.into(), no_keys)
        })?;
        let found = if text.trim_start().starts_with('{') {
            let json: Option<Value> = serde_json::from_str(&text).ok();
            let has = |sign: &str| json.as_ref().is_some_and(|json| json.get(sign).is_some());
            KINDS.iter().find(|kind| kind.signs.iter().any(|sign| has(sign))).or(json.is_none().then_some(&plan::KIND))
        } else {
            let outline = Outline::of(&text);
            let known = KINDS.iter().find(|kind| kind.signs.iter().any(|sign| outline.has(sign)));
            let known = known.or_else(|| records::by_header(&text).then_some(&records::KIND));
            if known.is_none() && outline.is_broken() && !foreign::ends(path, &["toml"]) {
                return Err(no_keys(foreign::reader(path, text.as_bytes())));
            }
            // Every reader of a form tells all slips of a text that is not TOML, and nothing else.
            known.or(outline.is_broken().then_some(&KINDS[0]))
        };
        found.ok_or_else(|| {
            let kinds = KINDS.iter().filter(|kind| kind.read.is_some());
            let signs: Vec<String> = kinds.map(|kind| format!("{} by {}", kind.word, kind.signs.join(", "))).collect();
            KindError::NoSign { file: path.display().to_string(), signs: signs.join("; ") }
        })
    }

    /// The JSON schema.
    ///
    /// # Panics
    /// Never: schemas that are texts of their own are JSON, which a test asks.
    pub fn schema(&self) -> Value {
        match self.form {
            SchemaSource::By(form) => schema(form, &self.title()),
            SchemaSource::ByOneOf(forms) => {
                let any: Vec<Value> = forms.iter().map(|form| schema(form, form.doc)).collect();
                json!({
                    "$schema": "https://json-schema.org/draft/2020-12/schema",
                    "title": self.title(),
                    "description": self.doc,
                    "anyOf": any,
                })
            }
            SchemaSource::Text(text) => serde_json::from_str(text).expect("a schema of the repository is JSON"),
            SchemaSource::Rows(schema) => schema(),
        }
    }

    /// Its name in editors.
    fn title(&self) -> String {
        match self.word {
            "life" => "toolroom tool-life study".to_owned(),
            "lobes" => "toolroom lobes file".to_owned(),
            "structure" => "toolroom structure file".to_owned(),
            "coefficients" => "toolroom coefficient file".to_owned(),
            "gap" => "toolroom nominal model".to_owned(),
            "cycle" => "toolroom cycle file".to_owned(),
            "contour" => "toolroom contour file".to_owned(),
            "setup" => "toolroom setup file".to_owned(),
            "parameter-set" => "toolroom parameter set".to_owned(),
            word => format!("toolroom {word}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_is_of_its_kind_and_its_reader_takes_it() {
        assert!(samples::SAMPLES.iter().all(|(word, _)| FileKind::named(word).is_some()));
        for kind in KINDS {
            let sample = kind.sample();
            let folder = tempfile::tempdir().expect("a folder");
            for (name, text) in sample.files {
                std::fs::write(folder.path().join(name), text).expect("written");
            }
            let file = folder.path().join(sample.files[0].0);
            let told = FileKind::from_path(&file).expect("a kind");
            // A scenario may be a nominal model: the reader of scenarios is asked first.
            assert!(told.word == kind.word || kind.word == "gap", "{} is told as {}", kind.word, told.word);
            let read = (kind.read.expect("a reader"))(&file, &[]);
            assert!(read.is_ok(), "{}: {}", kind.word, read.expect_err("refused"));
        }
    }

    #[test]
    fn the_reference_has_every_key_of_every_kind() {
        for kind in KINDS {
            let page = kind.reference();
            let SchemaSource::By(form) = kind.form else { continue };
            for key in form.keys {
                assert!(page.contains(&format!("| `{}` |", key.name)), "{}: {}", kind.word, key.name);
            }
        }
    }

    #[test]
    fn every_kind_has_a_schema() {
        assert!(KINDS.iter().all(|kind| kind.schema().is_object()));
    }

    #[test]
    fn a_sign_is_a_key_of_its_kind_and_of_none_further_down() {
        for (i, kind) in KINDS.iter().enumerate() {
            for sign in kind.signs {
                assert!(KINDS[i + 1..].iter().all(|other| !other.signs.contains(sign)), "{sign}");
                if let SchemaSource::By(form) = kind.form {
                    assert!(form.key(sign).is_some(), "{} has no {sign}", kind.word);
                }
                for other in KINDS.iter().skip(i + 1) {
                    let SchemaSource::By(form) = other.form else { continue };
                    assert!(form.key(sign).is_none(), "{} has {sign} of {} too", other.word, kind.word);
                }
            }
        }
    }
}
