//! Single files that an option names, `--blocks FILE` or `--records DIR`.
//!
//! What toolroom wrote into a folder is listed in its `.toolroom.json` with a hash. A file that is listed and as it
//! was is replaced; any other one is not, but by `--force`. Inputs of the command are never replaced.

use crate::error::OutputError;
use crate::listed::{FileStatus, Listed, hash, permit};
use crate::lock::Lock;
use crate::signals::{self, Begun, Tidy};
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the list in its folder.
const LIST: &str = ".toolroom.json";

/// What the files of a command may replace.
#[derive(Clone, Debug)]
pub struct Files {
    inputs: Vec<PathBuf>,
    force: bool,
}

/// A file that is being written under another name.
#[derive(Debug)]
pub struct Draft {
    /// Where to write.
    pub file: File,
    place: PathBuf,
    /// Name until it is complete; none for what is no file, such as `/dev/stdout`.
    draft: Option<(PathBuf, Tidy)>,
}

impl Files {
    /// Files of a command that reads `inputs`; with `force` they replace those of others.
    pub fn new<'a>(inputs: impl IntoIterator<Item = &'a Path>, force: bool) -> Self {
        Self { inputs: inputs.into_iter().map(Path::to_owned).collect(), force }
    }

    /// Refuses a path that must not be written, before any work.
    pub fn check(&self, path: &Path) -> Result<(), OutputError> {
        if is_special(path) {
            return Ok(());
        }
        let (folder, name) = split(&real(path))?;
        permit(path, read(&folder).standing(&folder, &name)?, &self.inputs, self.force)
    }

    /// [`check`](Self::check) of every path, no two of which may be one file.
    pub fn check_all<'a>(&self, paths: impl IntoIterator<Item = &'a Path>) -> Result<(), OutputError> {
        let mut places: Vec<PathBuf> = Vec::new();
        for path in paths {
            self.check(path)?;
            let place = real(path);
            if !is_special(path) && places.contains(&place) {
                let message = format!("two results would be written to {}, of which one would be lost", path.display());
                return Err(OutputError::refused(message, "give each a name of its own"));
            }
            places.push(place);
        }
        Ok(())
    }

    /// Writes a file; its folder exists.
    pub fn put(&self, path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
        let mut draft = self.begin(path)?;
        draft.file.write_all(bytes).map_err(|source| OutputError::Unwritable { path: path.to_owned(), source })?;
        self.end(draft)
    }

    /// Writes a text that tells by itself whether toolroom wrote it, as `ours` finds: it is not listed.
    pub fn put_marked(&self, path: &Path, text: &str, ours: impl Fn(&str) -> bool) -> Result<(), OutputError> {
        if !is_special(path) {
            let (folder, name) = split(&real(path))?;
            let mut standing = Listed::default().standing(&folder, &name)?;
            let there = if standing == FileStatus::Foreign { fs::read_to_string(path).ok() } else { None };
            if there.is_some_and(|there| there == text || ours(&there)) {
                standing = FileStatus::Ours;
            }
            permit(path, standing, &self.inputs, self.force)?;
        }
        let mut draft = Draft::open(path)?;
        draft
            .file
            .write_all(text.as_bytes())
            .map_err(|source| OutputError::Unwritable { path: path.to_owned(), source })?;
        draft.publish()
    }

    /// Opens a file to be filled piece by piece.
    pub fn begin(&self, path: &Path) -> Result<Draft, OutputError> {
        self.check(path)?;
        Draft::open(path)
    }

    /// Gives a complete file its name.
    pub fn end(&self, draft: Draft) -> Result<(), OutputError> {
        let Some((written, _)) = &draft.draft else { return draft.publish() };
        let (folder, name) = split(&draft.place)?;
        let new = hash(written)?;
        let _lock = Lock::wait(&folder)?;
        let mut listed = read(&folder);
        let standing = listed.standing(&folder, &name)?;
        let same = standing != FileStatus::Free && standing != FileStatus::Folder && hash(&draft.place)? == new;
        if !same {
            // It may have been changed while the work went on.
            permit(&draft.place, standing, &self.inputs, self.force)?;
        }
        // Both hashes until the file has its name: whenever the program ends, the file is known.
        let earlier = if standing == FileStatus::Ours { Some(hash(&draft.place)?) } else { None };
        listed.remove(&name);
        earlier.into_iter().chain([new]).for_each(|hash| listed.add(&name, hash));
        let list = json!({ "schema": 1, "about": "files that toolroom wrote here, with a hash of each", "files": listed.json() });
        let mut list_draft = Draft::open(&folder.join(LIST))?;
        let text = serde_json::to_string_pretty(&list).map_err(OutputError::Json)? + "\n";
        let unwritable = |source| OutputError::Unwritable { path: folder.join(LIST), source };
        list_draft.file.write_all(text.as_bytes()).map_err(unwritable)?;
        list_draft.publish()?;
        draft.publish()
    }
}

impl Draft {
    fn open(path: &Path) -> Result<Self, OutputError> {
        let unwritable = |source| OutputError::Unwritable { path: path.to_owned(), source };
        if is_special(path) {
            let file = File::options().write(true).open(path).map_err(unwritable)?;
            return Ok(Self { file, place: path.to_owned(), draft: None });
        }
        let place = real(path);
        let (folder, name) = split(&place)?;
        let draft = folder.join(format!(".{name}.partial-{}", std::process::id()));
        let tidy = signals::tidy(Begun::File(draft.clone()));
        let file = File::create(&draft).map_err(unwritable)?;
        Ok(Self { file, place, draft: Some((draft, tidy)) })
    }

    fn publish(mut self) -> Result<(), OutputError> {
        let unwritable = |source| OutputError::Unwritable { path: self.place.clone(), source };
        self.file.flush().map_err(unwritable)?;
        if let Some((draft, _)) = &self.draft {
            let _publishing = signals::publishing();
            // The permissions are those of the file that is replaced.
            if let Ok(there) = fs::metadata(&self.place) {
                let _ = fs::set_permissions(draft, there.permissions());
            }
            fs::rename(draft, &self.place).map_err(unwritable)?;
        }
        self.draft = None;
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if let Some((draft, _)) = &self.draft {
            // The failure that brought us here is reported already.
            let _ = fs::remove_file(draft);
        }
    }
}

/// Whether a path is neither a file nor a folder: a pipe or a device is written into and stays what it is.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Where a path leads to: a link stays a link.
pub fn real(path: &Path) -> PathBuf {
    let mut place = path.to_owned();
    // As many links as the system follows.
    for _ in 0..40 {
        match fs::read_link(&place) {
            Ok(to) => place = place.parent().unwrap_or(Path::new("")).join(to),
            Err(_) => break,
        }
    }
    place
}

/// Folder and name of a file.
fn split(path: &Path) -> Result<(PathBuf, String), OutputError> {
    let Some(name) = path.file_name() else {
        return Err(OutputError::refused(format_args!("{} names no file", path.display()), "give the name of a file"));
    };
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Ok((folder.to_owned(), name.to_string_lossy().into_owned()))
}

/// The list of a folder; empty where there is none that can be read: then nothing there is ours.
fn read(folder: &Path) -> Listed {
    let text = fs::read_to_string(folder.join(LIST)).unwrap_or_default();
    serde_json::from_str::<Value>(&text).ok().and_then(|list| Listed::from_manifest(&list)).unwrap_or_default()
}
