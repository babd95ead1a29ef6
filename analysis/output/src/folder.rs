//! The folder of results: what toolroom wrote into it, and nothing else, is toolroom's.
//!
//! Files are made in a draft within the folder and take their names one by one when all are complete. `run.json` lists
//! them, each with a hash: the next run into the same folder replaces those and removes what it no longer writes. A
//! file that is not listed stays; one that stands in the way, or that was changed since, is refused but for `--force`.
//! A lock keeps two processes from one folder.

use crate::error::OutputError;
use crate::files::real;
use crate::listed::{FileStatus, Listed, hash, permit};
use crate::lock::Lock;
use crate::signals::{self, Begun, Tidy, tidy};
use serde_json::{Value, json};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::time::Duration;
use toolroom_chart::ResultFiles;
use toolroom_chart::page::Provenance;

/// A folder of results while it is written.
#[derive(Debug)]
pub struct OutputDir {
    /// The folder as the user calls it.
    target: PathBuf,
    /// The folder itself, behind links.
    place: PathBuf,
    draft: PathBuf,
    /// What an earlier run left.
    earlier: Earlier,
    /// Files that were put into the folder itself.
    placed: Vec<String>,
    inputs: Vec<PathBuf>,
    force: bool,
    /// Folders made for it, from the outermost on.
    made: Vec<PathBuf>,
    tidies: Vec<Tidy>,
    lock: Option<Lock>,
    kept: bool,
}

/// What says which files of a folder are ours.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Earlier {
    /// No `run.json`.
    Nothing,
    /// A `run.json` of a version that did not list its files: it proves that the folder is ours, and nothing more.
    Unlisted,
    /// Files with their hashes.
    Listed(Listed),
}

/// Folder of the journals of work that is not complete.
const JOURNAL: &str = ".toolroom-journal";
/// What a folder of imported records holds, beside them.
const IMPORT: &str = "import.json";
/// What a folder of results always holds.
const MARK: &str = "run.json";
/// Folder of the files that are not complete.
const DRAFT: &str = ".toolroom-draft";

impl OutputDir {
    /// Takes the folder `target`, for files of which `names` are known; an unwritable place and files in the way are
    /// told before any work. `inputs` of the command are never replaced, files of others with `force` only.
    pub fn create<'a>(
        target: &Path,
        names: &[&str],
        inputs: impl IntoIterator<Item = &'a Path>,
        force: bool,
    ) -> Result<Self, OutputError> {
        let unwritable = |source| OutputError::Unwritable { path: target.to_owned(), source };
        let place = std::path::absolute(real(target)).map_err(unwritable)?;
        if place.exists() && !place.is_dir() {
            return Err(unwritable(io::Error::new(io::ErrorKind::NotADirectory, "it is a file")));
        }
        let mut out = Self {
            target: target.to_owned(),
            draft: place.join(DRAFT),
            place,
            earlier: Earlier::Nothing,
            placed: Vec::new(),
            inputs: inputs.into_iter().map(Path::to_owned).collect(),
            force,
            made: Vec::new(),
            tidies: Vec::new(),
            lock: None,
            kept: false,
        };
        out.make_folders().map_err(unwritable)?;
        out.lock = Some(Lock::take(&out.place)?);
        out.earlier = earlier(&out.place);
        out.check(names.iter().copied().chain([MARK]))?;
        out.spare_records(names)?;
        // Under the lock a draft is that of a dead process.
        if out.draft.is_dir() {
            fs::remove_dir_all(&out.draft).map_err(unwritable)?;
        }
        out.tidies.push(tidy(Begun::Draft(out.draft.clone())));
        fs::create_dir(&out.draft).map_err(unwritable)?;
        Ok(out)
    }

    fn make_folders(&mut self) -> io::Result<()> {
        let missing: Vec<PathBuf> =
            self.place.ancestors().take_while(|folder| !folder.exists()).map(Path::to_owned).collect();
        for folder in missing.into_iter().rev() {
            match fs::create_dir(&folder) {
                // `a/..` is there as soon as `a` is, and another process may be quicker.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => continue,
                made => made?,
            }
            self.tidies.push(tidy(Begun::Folder(folder.clone())));
            self.made.push(folder);
        }
        Ok(())
    }

    /// Refuses names that must not be written, and listed files that somebody changed.
    fn check<'a>(&self, names: impl Iterator<Item = &'a str>) -> Result<(), OutputError> {
        let none = Listed::default();
        let listed = match &self.earlier {
            Earlier::Listed(listed) => listed,
            Earlier::Nothing | Earlier::Unlisted => &none,
        };
        for name in names.filter(|name| !listed.has(name)) {
            let mut standing = listed.standing(&self.place, name)?;
            let ours = if name == MARK { self.earlier != Earlier::Nothing } else { self.earlier == Earlier::Unlisted };
            if standing == FileStatus::Foreign && ours {
                standing = FileStatus::Ours;
            }
            permit(&self.target.join(name), standing, &self.inputs, self.force)?;
        }
        for name in listed.names().filter(|name| !self.placed.iter().any(|placed| placed == name)) {
            permit(&self.target.join(name), listed.standing(&self.place, name)?, &self.inputs, self.force)?;
        }
        Ok(())
    }

    /// Refuses a folder of imported records to what is no import: they are measurements, and no result that a next run replaces.
    fn spare_records(&self, names: &[&str]) -> Result<(), OutputError> {
        let imported = manifest(&self.place)
            .is_some_and(|run| run["command"].as_str().is_some_and(|command| command.starts_with("toolroom import")));
        let Earlier::Listed(listed) = &self.earlier else { return Ok(()) };
        if self.force || !imported || names.contains(&IMPORT) {
            return Ok(());
        }
        let (folder, names) = (self.target.display(), listed.names().collect::<Vec<_>>().join(", "));
        let message = format!("{folder} holds records that `toolroom import` wrote: {names}");
        Err(OutputError::refused(message, "choose another folder, or replace them with --force; nothing was changed"))
    }

    /// The folder under the name that the user gave it.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Where to write.
    pub fn draft(&self) -> &Path {
        &self.draft
    }

    /// Writes a file of the draft.
    pub fn put(&self, name: &str, text: &str) -> Result<(), OutputError> {
        self.put_bytes(name, text.as_bytes())
    }

    /// Writes a file of the draft that is no text.
    pub fn put_bytes(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        let path = self.draft.join(name);
        fs::write(&path, bytes).map_err(|source| OutputError::Unwritable { path, source })
    }

    /// Writes every file of a result into the draft.
    pub fn put_all(&self, files: &ResultFiles) -> Result<(), OutputError> {
        files.iter().try_for_each(|(name, contents)| self.put_bytes(name, contents))
    }

    /// Writes a JSON file of the draft.
    pub fn put_json(&self, name: &str, value: &Value) -> Result<(), OutputError> {
        self.put(name, &(serde_json::to_string_pretty(value).map_err(OutputError::Json)? + "\n"))
    }

    /// Writes `run.json`: what was computed from what.
    pub fn record(&self, provenance: &Provenance, wall: Duration) -> Result<(), OutputError> {
        let inputs: Vec<Value> =
            provenance.inputs.iter().map(|(name, hash)| json!({ "name": name, "hash": hash })).collect();
        let mut run = json!({
            "schema": 1,
            "version": provenance.version,
            "command": provenance.command,
            "inputs": inputs,
            "complete": true,
            "wall_time [s]": wall.as_secs_f64(),
        });
        if let Some(seed) = provenance.seed {
            run["seed"] = json!(seed);
        }
        self.put_json(MARK, &run)
    }

    /// Counts a file that was put into the folder itself among those of this run.
    pub fn placed(&mut self, name: String) {
        self.placed.push(name);
    }

    /// Removes what earlier runs left in a folder within this one, before that is filled anew.
    pub fn clear(&mut self, folder: &str) -> Result<(), OutputError> {
        let Earlier::Listed(listed) = &mut self.earlier else { return Ok(()) };
        let within = format!("{folder}/");
        let names: Vec<String> = listed.names().filter(|name| name.starts_with(&within)).map(str::to_owned).collect();
        if names.is_empty() {
            return Ok(());
        }
        for name in &names {
            remove(&self.place, name)?;
            listed.remove(name);
        }
        let mut run = manifest(&self.place).unwrap_or_default();
        run["files"] = listed.json();
        self.put_json(MARK, &run)?;
        rename(&self.draft.join(MARK), &self.place.join(MARK))
    }

    /// The folder of the journals of this work, which goes with [`publish`](Self::publish) of a complete result: what
    /// an earlier run left there when the work goes on, and nothing when it starts anew. It is made by whoever
    /// writes the first journal.
    ///
    /// # Errors
    /// A journal that cannot be removed.
    pub fn journal(&self, resume: bool) -> Result<PathBuf, OutputError> {
        let journal = self.place.join(JOURNAL);
        if !resume && journal.is_dir() {
            fs::remove_dir_all(&journal).map_err(OutputError::at(&journal))?;
        }
        Ok(journal)
    }

    /// Leaves the draft under a name that nobody takes for a result, and tells it.
    pub fn keep(mut self) -> PathBuf {
        self.kept = true;
        let name = format!("partial-{}", std::process::id());
        // Under its own name the next run would take it for that of a dead process.
        match fs::rename(&self.draft, self.place.join(&name)) {
            Ok(()) => self.target.join(name),
            Err(_) => self.draft.clone(),
        }
    }

    /// Gives every file its name, one by one. Only then files are removed that an earlier run wrote and this one did
    /// not, and the journals of a result that `run.json` calls complete.
    ///
    /// # Errors
    /// [`OutputError`]; what was computed then stays in a folder that the message names.
    pub fn publish(self) -> Result<PathBuf, OutputError> {
        match self.give_names() {
            Ok(()) => {
                let journal = self.place.join(JOURNAL);
                if journal.is_dir() && manifest(&self.place).is_some_and(|run| run["complete"] == true) {
                    fs::remove_dir_all(&journal).map_err(OutputError::at(&journal))?;
                }
                let target = self.target.clone();
                let message = format!("interrupted when the results were complete in {}", target.display());
                signals::keeps(message, "nothing is left to do".to_owned());
                Ok(target)
            }
            Err(failure) => {
                let kept = self.keep();
                Err(failure.adding(&format!("; what was computed stays in {}", kept.display())))
            }
        }
    }

    fn give_names(&self) -> Result<(), OutputError> {
        let names: Vec<String> = files_in(&self.draft)?.into_iter().filter(|name| name != MARK).collect();
        let mut new = Listed::default();
        for name in &names {
            new.add(name, hash(&self.draft.join(name))?);
        }
        for name in &self.placed {
            new.add(name, hash(&self.place.join(name))?);
        }
        // Somebody may have put a file there while the work went on.
        self.check(names.iter().map(String::as_str))?;
        let none = Listed::default();
        let old = match &self.earlier {
            Earlier::Listed(listed) => listed,
            Earlier::Nothing | Earlier::Unlisted => &none,
        };
        let mut run = manifest(&self.draft).unwrap_or_default();
        run["files"] = new.json();
        // Until all files have their names both runs are listed: whenever the program ends, they are known.
        let json = json!({
            "schema": 1, "version": run["version"], "command": run["command"], "complete": false,
            "files": old.with(&new).json(),
        });
        self.put_json("between", &json)?;
        let unchanged = |name: &&str| matches!(old.standing(&self.place, name), Ok(FileStatus::Ours));
        let gone: Vec<&str> = old.names().filter(|name| !new.has(name)).filter(unchanged).collect();
        self.put_json(MARK, &run)?;
        let _publishing = signals::publishing();
        rename(&self.draft.join("between"), &self.place.join(MARK))?;
        for name in &names {
            let place = self.place.join(name);
            if let Some(folder) = place.parent() {
                fs::create_dir_all(folder)
                    .map_err(|source| OutputError::Unwritable { path: folder.to_owned(), source })?;
            }
            rename(&self.draft.join(name), &place)?;
        }
        gone.iter().try_for_each(|name| remove(&self.place, name))?;
        rename(&self.draft.join(MARK), &self.place.join(MARK))
    }
}

/// Every file of a folder and those within it, by its path with `/`, sorted.
fn files_in(folder: &Path) -> Result<Vec<String>, OutputError> {
    let unreadable = |source| OutputError::Unwritable { path: folder.to_owned(), source };
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.file_type().map_err(unreadable)?.is_dir() {
            names.extend(files_in(&entry.path())?.into_iter().map(|within| format!("{name}/{within}")));
        } else {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

fn rename(from: &Path, to: &Path) -> Result<(), OutputError> {
    fs::rename(from, to).map_err(|source| OutputError::Unwritable { path: to.to_owned(), source })
}

/// Removes a file that is listed, and folders within `place` that it leaves empty.
fn remove(place: &Path, name: &str) -> Result<(), OutputError> {
    // A list that names files elsewhere is none of ours.
    if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_))) {
        return Ok(());
    }
    let path = place.join(name);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return Err(OutputError::Unwritable { path, source: error });
        }
        _ => {}
    }
    let within = path.ancestors().skip(1).take_while(|folder| *folder != place);
    // A folder that holds something stays.
    within.for_each(|folder| drop(fs::remove_dir(folder)));
    Ok(())
}

/// `run.json` of a folder, if toolroom wrote it.
fn manifest(place: &Path) -> Option<Value> {
    let text = fs::read_to_string(place.join(MARK)).ok()?;
    let run: Value = serde_json::from_str(&text).ok()?;
    (run["schema"].is_number() && run["version"].is_string() && run["command"].is_string()).then_some(run)
}

fn earlier(place: &Path) -> Earlier {
    match manifest(place) {
        None => Earlier::Nothing,
        Some(run) => Listed::from_manifest(&run).map_or(Earlier::Unlisted, Earlier::Listed),
    }
}

impl Drop for OutputDir {
    fn drop(&mut self) {
        // Without the lock the draft is that of another process. What cannot be removed is told by nobody: the failure
        // that brought us here is reported already, and the next run removes drafts of dead ones.
        if !self.kept && self.lock.is_some() {
            let _ = fs::remove_dir_all(&self.draft);
        }
        self.lock = None;
        // Only folders that are empty go.
        self.made.iter().rev().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_shards::fingerprint;

    /// A run that writes these files; what is then in its folder.
    fn run(target: &Path, names: &[&str]) -> Vec<String> {
        let output_dir = OutputDir::create(target, names, [], false).expect("a free place");
        for name in names {
            if let Some(folder) = output_dir.draft().join(name).parent() {
                fs::create_dir_all(folder).expect("writable");
            }
            output_dir.put(name, name).expect("writable");
        }
        output_dir
            .put_json(MARK, &json!({ "schema": 1, "version": "0", "command": "x", "complete": true }))
            .expect("writable");
        output_dir.publish().expect("writable");
        files_in(target).expect("readable")
    }

    #[test]
    fn tables_in_folders_are_listed_and_go_with_their_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("a/b");
        let first = run(&target, &["kpi.csv", "stopped/jobs.csv", "stopped/tools.csv"]);
        assert_eq!(first, ["kpi.csv", "run.json", "stopped/jobs.csv", "stopped/tools.csv"]);
        fs::write(target.join("stopped/notes.txt"), "mine").expect("writable");
        assert_eq!(run(&target, &["kpi.csv", "stopped/jobs.csv"]).len(), 4);
        assert_eq!(run(&target, &["kpi.csv"]), ["kpi.csv", "run.json", "stopped/notes.txt"]);
        fs::remove_file(target.join("stopped/notes.txt")).expect("there");
        assert_eq!(run(&target, &["stopped/jobs.csv"]), ["run.json", "stopped/jobs.csv"]);
        assert_eq!(run(&target, &["kpi.csv"]), ["kpi.csv", "run.json"]);
        assert!(!target.join("stopped").exists(), "an empty folder goes with its files");
    }

    #[test]
    fn imported_records_are_no_results_that_the_next_run_replaces() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("records");
        let import = |names: &[&str]| {
            let out = OutputDir::create(&target, names, [], false)?;
            names.iter().try_for_each(|name| out.put(name, "measured"))?;
            let run =
                json!({ "schema": 1, "version": "0", "command": "toolroom import csv log.csv", "complete": true });
            out.put_json(MARK, &run)?;
            out.publish()
        };
        import(&["operations.csv", IMPORT]).expect("a free place");
        import(&["operations.csv", IMPORT]).expect("another import of the same");
        let refused = OutputDir::create(&target, &["diagnosis.json"], [], false).expect_err("it holds records");
        assert!(refused.to_string().contains("operations.csv"), "{refused}");
        assert_eq!(fs::read_to_string(target.join("operations.csv")).expect("there"), "measured");
        OutputDir::create(&target, &["diagnosis.json"], [], true).expect("by force");
    }

    #[test]
    fn a_run_that_died_while_its_files_took_their_names_is_known() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("out");
        run(&target, &["kpi.csv", "tools.csv"]);
        // Half of the second run has its names, `run.json` lists both runs.
        let mut between = manifest(&target).expect("ours");
        let mut listed = Listed::from_manifest(&between).expect("listed");
        fs::write(target.join("kpi.csv"), "new").expect("writable");
        listed.add("kpi.csv", fingerprint(b"new"));
        listed.add("jobs.csv", fingerprint(b"never there"));
        between["files"] = listed.json();
        fs::write(target.join(MARK), between.to_string()).expect("writable");
        assert_eq!(run(&target, &["kpi.csv"]), ["kpi.csv", "run.json"]);
    }

    #[test]
    fn what_was_computed_stays_where_a_file_came_in_the_way() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("out");
        let output_dir = OutputDir::create(&target, &[], [], false).expect("a free place");
        output_dir.put_json(MARK, &json!({ "schema": 1, "version": "0", "command": "x" })).expect("writable");
        output_dir.put("kpi.csv", "computed").expect("writable");
        fs::write(target.join("kpi.csv"), "mine").expect("writable");
        let failure = output_dir.publish().expect_err("the file is somebody's");
        assert!(failure.to_string().contains("what was computed stays in"), "{failure:?}");
        assert_eq!(fs::read_to_string(target.join("kpi.csv")).expect("there"), "mine");
        let kept = target.join(format!("partial-{}", std::process::id())).join("kpi.csv");
        assert_eq!(fs::read_to_string(kept).expect("there"), "computed");
    }
}
