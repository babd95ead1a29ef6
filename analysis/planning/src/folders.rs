//! Part programs in folders.

use std::fs;
use std::path::{Path, PathBuf};

/// Endings of files in a folder that are programs; `.spf` are subprograms of others.
pub const ENDINGS: [&str; 8] = ["nc", "ngc", "mpf", "h", "tap", "cnc", "eia", "gcode"];

/// Why the programs of a folder are not known.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// It cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// It has no file with one of the [`ENDINGS`].
    #[error("{} holds no program", path.display())]
    Empty {
        /// The folder.
        path: PathBuf,
    },
}

impl FolderError {
    /// The likely way out.
    pub fn fix(&self) -> String {
        match self {
            Self::Unreadable { .. } => "check the path".to_owned(),
            Self::Empty { .. } => format!("programs end in {}", ENDINGS.join(", ")),
        }
    }
}

/// The programs of files and folders, those of a folder by name.
///
/// # Errors
/// [`FolderError`]: a folder that cannot be read or holds no program.
pub fn programs(given: &[PathBuf]) -> Result<Vec<PathBuf>, FolderError> {
    let mut list = Vec::new();
    for path in given {
        if !path.is_dir() {
            list.push(path.clone());
            continue;
        }
        let unreadable = |source| FolderError::Unreadable { path: path.clone(), source };
        let mut inside: Vec<PathBuf> = Vec::new();
        for entry in fs::read_dir(path).map_err(unreadable)? {
            inside.push(entry.map_err(unreadable)?.path());
        }
        inside.retain(|file| file.is_file() && ENDINGS.contains(&ending(file).as_str()));
        if inside.is_empty() {
            return Err(FolderError::Empty { path: path.clone() });
        }
        inside.sort();
        list.extend(inside);
    }
    Ok(list)
}

fn ending(file: &Path) -> String {
    file.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}
