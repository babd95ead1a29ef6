//! What a verb refuses of a file, `check` finds: slips of the hand in every shipped file.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::path::{Path, PathBuf};
use toolroom_chart::page::Provenance;
use toolroom_chatter::ChatterError;
use toolroom_form::{FaultList, ReadError};
use toolroom_kernel::SimTime;
use toolroom_kinds::{FileKind, KindError};
use toolroom_nominal::ModelFileError;
use toolroom_planning::contour::{self, StudyOptions, Task};
use toolroom_planning::lobes;
use toolroom_records::import::{ImportError, Mapped, Mapping, Origin, import_csv};
use toolroom_scenario_file::{self as file, ScenarioFile};
use toolroom_shop::Shop;

/// Slips that are tried in each file. All of them would take minutes.
const TRIED: usize = 30;

/// One thing done to one line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slip {
    /// The line is left out.
    Missing,
    /// The line stands twice.
    Twice,
    /// The first word has one letter more.
    OtherKey,
    /// The first number has another sign.
    Negative,
    /// The first number is zero.
    Zero,
    /// The first number is ten thousand times as great.
    Great,
    /// The first number is beyond everything.
    Huge,
    /// The first number is none.
    NotANumber,
    /// The unit in a text is one of another quantity.
    OtherUnit,
    /// A text is a word that nobody knows.
    OtherWord,
    /// A value is of another kind.
    OtherKind,
}

impl Slip {
    const ALL: [Self; 11] = [
        Self::Missing,
        Self::Twice,
        Self::OtherKey,
        Self::Negative,
        Self::Zero,
        Self::Great,
        Self::Huge,
        Self::NotANumber,
        Self::OtherUnit,
        Self::OtherWord,
        Self::OtherKind,
    ];

    /// What becomes of a line; `None` where the slip does not apply to it.
    fn of(self, line: &str) -> Option<String> {
        let value = line.find('=')? + 1;
        let (key, rest) = line.split_at(value);
        let number = || {
            let start = rest.find(|c: char| c.is_ascii_digit())?;
            let end =
                rest[start..].find(|c: char| !(c.is_ascii_digit() || c == '.')).map_or(rest.len(), |end| start + end);
            Some((start, end))
        };
        let replaced = |other: &dyn Fn(&str) -> String| {
            let (start, end) = number()?;
            Some(format!("{key}{}{}{}", &rest[..start], other(&rest[start..end]), &rest[end..]))
        };
        match self {
            Self::Missing => Some(String::new()),
            Self::Twice => Some(format!("{line}\n{line}")),
            Self::OtherKey => Some(format!("x{line}")),
            Self::Negative => replaced(&|number| format!("-{number}")),
            Self::Zero => replaced(&|_| "0".to_owned()),
            Self::Great => replaced(&|number| format!("{}", number.parse::<f64>().unwrap_or(1.0) * 1e4)),
            Self::Huge => replaced(&|_| "1e300".to_owned()),
            Self::NotANumber => replaced(&|_| "nan".to_owned()),
            Self::OtherUnit => {
                let (_, end) = number().filter(|_| rest.contains('"'))?;
                let unit = rest[end..].strip_prefix(' ')?;
                let after = unit.find('"')?;
                Some(format!("{key}{} kg2{}", &rest[..end], &unit[after..]))
            }
            Self::OtherWord => {
                let start = rest.find('"')? + 1;
                let end = start + rest[start..].find('"')?;
                (!rest[start..end].contains(|c: char| c.is_ascii_digit()))
                    .then(|| format!("{key}{}xyzzy{}", &rest[..start], &rest[end..]))
            }
            Self::OtherKind => Some(format!("{key} [[1]]")),
        }
    }
}

/// Every slip in a text: what was done to which line, and the text with it.
fn slips(text: &str) -> Vec<(usize, Slip, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut all = Vec::new();
    for (i, line) in lines.iter().enumerate().filter(|(_, line)| !line.trim_start().starts_with('#')) {
        for slip in Slip::ALL {
            let Some(other) = slip.of(line) else { continue };
            let mut changed = lines.clone();
            changed[i] = &other;
            all.push((i + 1, slip, changed.join("\n") + "\n"));
        }
    }
    all
}

/// The start of the verb that a file is for: what it refuses, in words; with the faults where the file is refused.
type Verb = fn(&Path) -> Result<(), Refused>;

enum Refused {
    File(Box<FaultList>),
    Work(String),
}

impl From<ReadError> for Refused {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Faults(list) => Self::File(list),
            other => Self::Work(other.to_string()),
        }
    }
}

fn work(error: impl ToString) -> Refused {
    Refused::Work(error.to_string())
}

/// Half an hour of the shop under every policy: what a run refuses it refuses at its start or in its first passes, and two hours of
/// the shops that chatter or mill contours took minutes.
fn run(path: &Path) -> Result<(), Refused> {
    let ScenarioFile { scenario, .. } = file::read(path, &[])?;
    let until = SimTime::from_seconds(scenario.horizon.min(1800.0)).map_err(work)?;
    for policy in 0..scenario.policies.len() {
        Shop::new(&scenario, policy, 0).and_then(|mut shop| shop.run_until(until)).map_err(work)?;
    }
    Ok(())
}

/// A few lives in every cell.
fn lives(path: &Path) -> Result<(), Refused> {
    let study = toolroom_life::file::read(path, &[])?.content.study;
    study.cells.iter().for_each(|cell| drop(toolroom_life::study::run::lives(&study, cell, 0, 3, true)));
    Ok(())
}

fn grind(path: &Path) -> Result<(), Refused> {
    let design = toolroom_planning::cycle::CycleDesign::read(path, &[])?.content;
    drop((design.text(), design.files(Provenance::default())));
    Ok(())
}

/// Four points of the chart: one that does not converge is a hole, and no fault of the file.
fn chart(path: &Path) -> Result<(), Refused> {
    let mut file = lobes::read(path, &[])?.content;
    (file.chart.speed.points, file.chart.depth.points) = (2, 2);
    match file.cut.lobes(&file.chart, 0..2) {
        Ok(_) | Err(ChatterError::NotConverged { .. }) => Ok(()),
        Err(error) => Err(work(error)),
    }
}

/// Every plan, with draws and files.
fn plan(path: &Path) -> Result<(), Refused> {
    let task = Task::read(path, None, &[])?;
    let options = StudyOptions { draws: 2, ..StudyOptions::default() };
    let studies =
        contour::studies(&task.file, &options, &|_| (), &|_, _| (), None).map_err(|error| task.refused(&error))?;
    let fanuc = toolroom_program::Dialect::Fanuc;
    contour::files(&task.file, &studies, Provenance::default(), fanuc)
        .map(drop)
        .map_err(|error| task.refused(&error).into())
}

fn from(mapped: &Mapped) -> Option<String> {
    if let Origin::Column { from, .. } = &mapped.origin { Some(from.clone()) } else { None }
}

/// Whether every column that the records need is mapped; what a table has in its columns is no matter of the file.
fn import(path: &Path) -> Result<(), Refused> {
    let mapping = Mapping::read(path, &[])?;
    let mut headers: Vec<String> = mapping.columns.iter().filter_map(from).collect();
    headers.sort();
    headers.dedup();
    let row = vec!["1"; headers.len()].join(",");
    match import_csv("table.csv", format!("{}\n{row}\n", headers.join(",")).as_bytes(), &mapping) {
        Err(error @ ImportError::NotMapped { .. }) => Err(work(error)),
        _ => Ok(()),
    }
}

fn model(path: &Path) -> Result<(), Refused> {
    toolroom_nominal::NominalModel::read(path, &[]).map(drop).map_err(|error| match error {
        ModelFileError::Read(error) => error.into(),
        other => work(other),
    })
}

/// Code and place of every fault.
fn places(list: &FaultList) -> Vec<(&'static str, usize, usize)> {
    let one = |problem| {
        let place = list.place(problem);
        (problem.fault.code(), place.line, place.column)
    };
    list.problems.iter().map(one).collect()
}

/// The shipped files of a kind, in a copy of their folders.
fn shipped(word: &str, copy: &Path) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    copied(&root, copy);
    let mut found: Vec<PathBuf> = Vec::new();
    for folder in ["", "chatter", "contour", "gap", "grinding", "life"] {
        let entries = fs::read_dir(copy.join(folder)).expect("a folder").map(|entry| entry.expect("an entry").path());
        found.extend(entries.filter(|path| path.extension().is_some_and(|extension| extension == "toml")));
    }
    found.sort();
    // Units of others need a program that can run them.
    found.retain(|path| !path.to_string_lossy().contains("fmu-"));
    found.retain(|path| FileKind::from_path(path).expect("a kind").word == word);
    found
}

fn copied(source: &Path, target: &Path) {
    fs::create_dir_all(target).expect("a folder");
    for entry in fs::read_dir(source).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let there = target.join(entry.file_name().expect("a name"));
        if entry.is_dir() {
            copied(&entry, &there);
        } else {
            fs::copy(&entry, &there).expect("a copy");
        }
    }
}

/// Tries slips in every shipped file of a kind: how many were refused and how many accepted.
fn tried(word: &str, verb: Verb) {
    let kind = FileKind::named(word).expect("a kind");
    let check = kind.read.expect("a reader");
    let copy = tempfile::tempdir().expect("a folder");
    let files = shipped(word, copy.path());
    assert!(!files.is_empty(), "no {word} is shipped");
    let (mut refused, mut accepted, mut wrong) = (0, 0, Vec::new());
    for path in files {
        let text = fs::read_to_string(&path).expect("text");
        let mut all = slips(&text);
        all.shuffle(&mut ChaCha8Rng::seed_from_u64(15));
        // Beside its original, where the files that it names are found.
        let file = path.with_file_name("slip.toml");
        for (line, slip, changed) in all.into_iter().take(TRIED) {
            fs::write(&file, changed).expect("written");
            let found = check(&file, &[]);
            let (name, began) = (path.file_name().expect("a name").to_string_lossy(), verb(&file));
            match (found, began) {
                (Ok(_), Ok(())) => accepted += 1,
                (Err(KindError::Read(ReadError::Faults(found))), Err(Refused::File(told))) => {
                    refused += 1;
                    if places(&found) != places(&told) {
                        wrong.push(format!("{name}:{line} {slip:?}: check {found}, verb {told}"));
                    }
                }
                (Err(KindError::Read(ReadError::Faults(_))), _) => refused += 1,
                (Err(found), _) => wrong.push(format!("{name}:{line} {slip:?}: refused without a place: {found}")),
                (Ok(_), Err(Refused::File(told))) => wrong.push(format!("{name}:{line} {slip:?}: check passes {told}")),
                (Ok(_), Err(Refused::Work(told))) => wrong.push(format!("{name}:{line} {slip:?}: check passes {told}")),
            }
        }
    }
    assert!(refused > 3 && accepted > 0, "{refused} refused, {accepted} accepted");
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), refused + accepted + wrong.len(), wrong.join("\n"));
}

#[test]
fn what_run_refuses_of_a_scenario_check_finds() {
    tried("scenario", run);
}

#[test]
fn what_life_refuses_of_a_study_check_finds() {
    tried("life", lives);
}

#[test]
fn what_grind_refuses_of_a_cycle_check_finds() {
    tried("cycle", grind);
}

#[test]
fn what_lobes_refuses_of_a_chart_check_finds() {
    tried("lobes", chart);
}

#[test]
fn what_contour_refuses_of_a_contour_check_finds() {
    tried("contour", plan);
}

#[test]
fn what_import_refuses_of_a_mapping_check_finds() {
    tried("mapping", import);
}

#[test]
fn what_gap_refuses_of_a_nominal_model_check_finds() {
    tried("gap", model);
}
