//! The zip file that an FMU is: entries seen before anything is believed.

use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use toolroom_location::{Located, Location};
use zip::ZipArchive;

/// The description at the root of every unit.
pub const MODEL_DESCRIPTION: &str = "modelDescription.xml";

/// Largest entry that is read, bytes; assumption: a binary of a unit stays far below. What an
/// entry's header says about its size is not believed.
const LARGEST_ENTRY: u64 = 1 << 30;

/// One entry of the archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Name as written.
    pub name: String,
    /// Size unpacked, bytes, as the archive says.
    pub size: u64,
    /// Whether it is a directory.
    pub directory: bool,
    /// Whether it is a symbolic link.
    pub symlink: bool,
    /// Whether it is encrypted.
    pub encrypted: bool,
    /// Whether it is stored or deflated, as FMI asks for.
    pub portable: bool,
}

impl Entry {
    /// The name with forward slashes; some exporters on Windows write backslashes.
    pub fn slashed(&self) -> String {
        self.name.replace('\\', "/")
    }

    /// Where the entry lies below the folder it is unpacked to, or `None` where its name leads
    /// out of it.
    ///
    /// ```
    /// use toolroom_fmu_import::Entry;
    /// let named = |name: &str| Entry { name: name.into(), size: 0, directory: false, symlink: false, encrypted: false, portable: true };
    /// assert!(named("../../etc/passwd").inside().is_none());
    /// assert_eq!(named("resources\\tools.csv").inside(), Some("resources/tools.csv".into()));
    /// ```
    pub fn inside(&self) -> Option<PathBuf> {
        let name = self.slashed();
        let drive = name.chars().nth(1) == Some(':');
        if name.starts_with('/') || drive || name.contains('\0') {
            return None;
        }
        let mut path = PathBuf::new();
        for part in name.split('/') {
            match part {
                "" | "." => {}
                ".." => return None,
                part => path.push(part),
            }
        }
        Some(path)
    }
}

/// Why an archive is no use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// The file cannot be opened.
    #[error("{path} cannot be read: {source}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is no zip archive, or is cut off.
    #[error("{path} is not an FMU: {reason} (a zip archive is due)", path = .path.display())]
    NoZip {
        /// The file.
        path: PathBuf,
        /// What the reader of zip files says.
        reason: String,
    },
    /// An entry that is not there.
    #[error("{path} has no {entry}", path = .path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// The entry.
        entry: String,
    },
    /// An entry that cannot be unpacked: checksum, encryption, method.
    #[error("{path}: {entry} is damaged: {reason}", path = .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The entry.
        entry: String,
        /// What is wrong.
        reason: String,
    },
    /// An entry that would be written outside the folder of the unit.
    #[error("{path}: {entry} leads out of the unit's folder; nothing was unpacked", path = .path.display())]
    Traversal {
        /// The file.
        path: PathBuf,
        /// The entry.
        entry: String,
    },
    /// A folder that cannot be written.
    #[error("{path} cannot be written: {source}", path = .path.display())]
    Unwritable {
        /// The place.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl Located for ArchiveError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Unreadable { path, .. }
            | Self::NoZip { path, .. }
            | Self::Missing { path, .. }
            | Self::Damaged { path, .. }
            | Self::Traversal { path, .. }
            | Self::Unwritable { path, .. } => Some(Location::of(path.display())),
        }
    }
}

impl ArchiveError {
    /// The likely fix.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Unreadable { .. } | Self::Unwritable { .. } => "check path and permissions",
            Self::NoZip { .. } | Self::Damaged { .. } => "copy or export the unit again: it is damaged",
            Self::Traversal { .. } => "do not use it: such an archive writes over files of its choice",
            Self::Missing { .. } => "ask `toolroom fmu check` what is wrong with the unit",
        }
    }
}

/// An opened archive.
#[derive(Debug)]
pub struct Archive {
    path: PathBuf,
    zip: ZipArchive<BufReader<File>>,
    entries: Vec<Entry>,
}

impl Archive {
    /// Opens the archive at `path` and lists its entries; nothing is unpacked.
    ///
    /// # Errors
    /// [`ArchiveError::Unreadable`] and [`ArchiveError::NoZip`].
    pub fn open(path: &Path) -> Result<Self, ArchiveError> {
        let unreadable = |source| ArchiveError::Unreadable { path: path.to_owned(), source };
        let no_zip =
            |reason: zip::result::ZipError| ArchiveError::NoZip { path: path.to_owned(), reason: reason.to_string() };
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(unreadable(io::Error::from(io::ErrorKind::IsADirectory)));
        }
        let mut zip = ZipArchive::new(BufReader::new(file)).map_err(no_zip)?;
        let mut entries = Vec::with_capacity(zip.len());
        for index in 0..zip.len() {
            let entry = zip.by_index_raw(index).map_err(no_zip)?;
            let method = entry.compression();
            entries.push(Entry {
                name: entry.name().map_err(no_zip)?.into_owned(),
                size: entry.size(),
                directory: entry.is_dir(),
                symlink: entry.is_symlink(),
                encrypted: entry.encrypted(),
                portable: matches!(method, zip::CompressionMethod::Stored | zip::CompressionMethod::Deflated),
            });
        }
        Ok(Self { path: path.to_owned(), zip, entries })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Every entry, in the order of the archive.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The bytes of the entry called `name` with forward slashes.
    ///
    /// # Errors
    /// [`ArchiveError::Missing`] and [`ArchiveError::Damaged`].
    pub fn read(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        let missing = || ArchiveError::Missing { path: self.path.clone(), entry: name.to_owned() };
        let index = self.entries.iter().position(|entry| entry.slashed() == name).ok_or_else(missing)?;
        self.bytes(index)
    }

    /// The model description as text.
    ///
    /// # Errors
    /// As [`Archive::read`]; [`ArchiveError::Damaged`] where it is not UTF-8.
    pub fn description(&mut self) -> Result<String, ArchiveError> {
        let bytes = self.read(MODEL_DESCRIPTION)?;
        String::from_utf8(bytes).map_err(|error| ArchiveError::Damaged {
            path: self.path.clone(),
            entry: MODEL_DESCRIPTION.to_owned(),
            reason: format!("byte {} is not UTF-8", error.utf8_error().valid_up_to()),
        })
    }

    fn bytes(&mut self, index: usize) -> Result<Vec<u8>, ArchiveError> {
        let (path, entry) = (&self.path, &self.entries[index].name);
        let damaged = |reason: String| ArchiveError::Damaged { path: path.clone(), entry: entry.clone(), reason };
        let packed = self.zip.by_index(index).map_err(|error| damaged(error.to_string()))?;
        let mut bytes = Vec::new();
        packed.take(LARGEST_ENTRY + 1).read_to_end(&mut bytes).map_err(|error| damaged(error.to_string()))?;
        if bytes.len() as u64 > LARGEST_ENTRY {
            return Err(damaged(format!("it is larger than {LARGEST_ENTRY} bytes")));
        }
        Ok(bytes)
    }

    /// Unpacks everything below `folder`, or nothing where a name leads out of it.
    ///
    /// # Errors
    /// [`ArchiveError::Traversal`] before anything is written, then damaged entries and places
    /// that cannot be written.
    pub fn unpack(&mut self, folder: &Path) -> Result<(), ArchiveError> {
        let mut places = Vec::with_capacity(self.entries.len());
        for entry in &self.entries {
            let inside = if entry.symlink { None } else { entry.inside() };
            let traversal = || ArchiveError::Traversal { path: self.path.clone(), entry: entry.name.clone() };
            places.push(folder.join(inside.ok_or_else(traversal)?));
        }
        let unwritable = |path: &Path| {
            let path = path.to_owned();
            move |source| ArchiveError::Unwritable { path, source }
        };
        for (index, place) in places.iter().enumerate() {
            if self.entries[index].directory {
                fs::create_dir_all(place).map_err(unwritable(place))?;
                continue;
            }
            if let Some(parent) = place.parent() {
                fs::create_dir_all(parent).map_err(unwritable(parent))?;
            }
            let bytes = self.bytes(index)?;
            fs::write(place, bytes).map_err(unwritable(place))?;
        }
        Ok(())
    }
}
