//! `.ssp` packages.

use crate::read::{Fault, Reader};
use crate::structure::{self, SystemStructure};
use std::path::{Path, PathBuf};
use toolroom_fmu_import::{Archive, ArchiveError, Entry};
use toolroom_location::{Located, Location};

/// Entry of the structure that is read. A package may hold others beside it.
pub const STRUCTURE: &str = "SystemStructure.ssd";

/// Why a package is not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SspError {
    /// The file.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// What is wrong in it, every fault with its entry and line.
    #[error("{}: {}", .path.display(), .faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("; "))]
    Faults {
        /// The file.
        path: PathBuf,
        /// The faults; at least one.
        faults: Vec<Fault>,
    },
}

impl Located for SspError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Archive(error) => error.location(),
            Self::Faults { path, .. } => Some(Location::of(path.display())),
        }
    }
}

/// A package with its structure.
#[derive(Debug)]
pub struct Package {
    archive: Archive,
    structure: SystemStructure,
}

impl Package {
    /// Reads the structure of the package at `path`, with the start values that it names. No unit is looked into.
    ///
    /// # Errors
    /// [`SspError`]: every fault of the structure at once.
    pub fn open(path: &Path) -> Result<Self, SspError> {
        let mut archive = Archive::open(path)?;
        let text = text(&mut archive, STRUCTURE)?;
        let mut reader = Reader::new(STRUCTURE);
        let mut structure = SystemStructure::default();
        if let Some(document) = reader.parse(&text) {
            let mut values = |entry: &str| self::text(&mut archive, entry).map_err(|error| error.to_string());
            let root = document.root_element();
            if root.tag_name().name() == "SystemStructureDescription" {
                structure = structure::read(&mut reader, root, &mut values);
            } else {
                let name = root.tag_name().name();
                reader.fault(root, format!("<{name}> instead of <SystemStructureDescription>"));
            }
        }
        let entries: Vec<String> = archive.entries().iter().map(Entry::slashed).collect();
        for component in structure.components.iter().filter(|component| !entries.contains(&component.source)) {
            let message = format!("source = \"{}\": there is no such entry in the package", component.source);
            reader.fault_at(component.line, message);
        }
        if !reader.faults.is_empty() {
            return Err(SspError::Faults { path: path.to_owned(), faults: reader.faults });
        }
        Ok(Self { archive, structure })
    }

    /// The structure.
    pub fn structure(&self) -> &SystemStructure {
        &self.structure
    }

    /// The file.
    pub fn path(&self) -> &Path {
        self.archive.path()
    }

    /// Unpacks every entry below `folder`.
    ///
    /// # Errors
    /// [`ArchiveError`]; nothing is written where a name leads out of the folder.
    pub fn unpack(&mut self, folder: &Path) -> Result<(), ArchiveError> {
        self.archive.unpack(folder)
    }
}

fn text(archive: &mut Archive, entry: &str) -> Result<String, ArchiveError> {
    let bytes = archive.read(entry)?;
    String::from_utf8(bytes).map_err(|error| ArchiveError::Damaged {
        path: archive.path().to_owned(),
        entry: entry.to_owned(),
        reason: format!("byte {} is not UTF-8", error.utf8_error().valid_up_to()),
    })
}
