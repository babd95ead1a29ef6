//! Which files of a folder toolroom wrote: their names and a hash of what each held then.

use crate::error::OutputError;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use toolroom_shards::hash_of;

/// Files by their path relative to the folder, with `/`. A name has two hashes while its file is being replaced.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listed(BTreeMap<String, Vec<String>>);

/// How a file stands to what is listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileStatus {
    /// Nothing has the name.
    Free,
    /// As toolroom wrote it.
    Ours,
    /// Written by toolroom and changed since.
    Changed,
    /// Not written by toolroom.
    Foreign,
    /// A folder has the name.
    Folder,
}

impl Listed {
    /// The list in a manifest; `None` where it has none.
    pub fn from_manifest(manifest: &Value) -> Option<Self> {
        let mut listed = Self::default();
        for file in manifest["files"].as_array()? {
            listed.add(file["name"].as_str()?, file["hash"].as_str()?.to_owned());
        }
        Some(listed)
    }

    /// For a manifest.
    pub fn json(&self) -> Value {
        let one = |(name, hashes): (&String, &Vec<String>)| -> Vec<Value> {
            hashes.iter().map(|hash| json!({ "name": name, "hash": hash })).collect()
        };
        self.0.iter().flat_map(one).collect()
    }

    pub fn add(&mut self, name: &str, hash: String) {
        let hashes = self.0.entry(name.to_owned()).or_default();
        if !hashes.contains(&hash) {
            hashes.push(hash);
        }
    }

    /// This and another list.
    pub fn with(&self, other: &Self) -> Self {
        let mut both = self.clone();
        other.0.iter().for_each(|(name, hashes)| hashes.iter().for_each(|hash| both.add(name, hash.clone())));
        both
    }

    pub fn remove(&mut self, name: &str) {
        self.0.remove(name);
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    pub fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// How the file of a name in `folder` stands.
    pub fn standing(&self, folder: &Path, name: &str) -> Result<FileStatus, OutputError> {
        let path = folder.join(name);
        let unreadable = |source| OutputError::Unwritable { path: path.clone(), source };
        match fs::metadata(&path) {
            // A link that leads nowhere is somebody's, too.
            Err(error) if error.kind() == ErrorKind::NotFound && !path.is_symlink() => return Ok(FileStatus::Free),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(FileStatus::Foreign),
            Err(error) => return Err(unreadable(error)),
            Ok(there) if there.is_dir() => return Ok(FileStatus::Folder),
            Ok(_) => {}
        }
        let Some(hashes) = self.0.get(name) else { return Ok(FileStatus::Foreign) };
        let hash = hash(&path)?;
        Ok(if hashes.contains(&hash) { FileStatus::Ours } else { FileStatus::Changed })
    }
}

/// Hash of a file.
pub fn hash(path: &Path) -> Result<String, OutputError> {
    Ok(hash_of(path)?)
}

/// Refuses a file that must not be replaced; `force` lets replace what is not an input or a folder.
pub fn permit(path: &Path, standing: FileStatus, inputs: &[PathBuf], force: bool) -> Result<(), OutputError> {
    let shown = path.display();
    let real = fs::canonicalize(path).ok();
    if real.is_some() && inputs.iter().any(|input| fs::canonicalize(input).ok() == real) {
        let message = format!("{shown} is an input of this command and is not replaced");
        return Err(OutputError::refused(message, "choose another place; nothing was changed"));
    }
    let message = match standing {
        FileStatus::Free | FileStatus::Ours => return Ok(()),
        FileStatus::Folder => {
            let message = format!("{shown} is a folder, where a file is to be written");
            return Err(OutputError::refused(message, "choose another place; nothing was changed"));
        }
        FileStatus::Changed | FileStatus::Foreign if force => return Ok(()),
        FileStatus::Changed => format!("{shown} was changed since toolroom wrote it"),
        FileStatus::Foreign => format!("{shown} was not written by toolroom"),
    };
    let help = "move it away, choose another place, or replace it with --force; nothing was changed";
    Err(OutputError::refused(message, help))
}
