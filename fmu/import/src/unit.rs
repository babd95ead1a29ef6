//! A unit unpacked and loaded.

#![allow(unsafe_code)] // loading a library runs its initialisers

use crate::archive::{Archive, ArchiveError};
use crate::check::functions;
use crate::description::{Interface, ModelDescription};
use crate::platform::{Binary, Platform};
use fmi::fmi2::binding::Fmi2Binding;
use fmi::fmi3::binding::Fmi3Binding;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Why a unit cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// The description cannot be understood.
    #[error("{path}: modelDescription.xml:{line}: {message}", path = .path.display())]
    Description {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u32,
        /// What is wrong.
        message: String,
    },
    /// Model Exchange only.
    #[error("{path} has no Co-Simulation interface, which a driver of steps needs", path = .path.display())]
    NoCoSimulation {
        /// The file.
        path: PathBuf,
    },
    /// Nothing for this computer.
    #[error("{path} has no library for this computer: {wanted} is missing; there are: {there}", path = .path.display())]
    Platform {
        /// The file.
        path: PathBuf,
        /// The entry looked for.
        wanted: String,
        /// Platform folders that there are.
        there: String,
    },
    /// A library without functions that FMI asks for.
    #[error("{path}: {library} lacks functions that FMI asks for: {missing}", path = .path.display())]
    Symbols {
        /// The file.
        path: PathBuf,
        /// The library.
        library: String,
        /// Names of the functions.
        missing: String,
    },
    /// The system's loader refuses the library.
    #[error("{path}: {library} cannot be loaded: {reason}", path = .path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// The library.
        library: String,
        /// What the system says.
        reason: String,
    },
}

/// The functions of a library.
pub(crate) enum Library {
    Two(Box<Fmi2Binding>),
    Three(Box<Fmi3Binding>),
}

/// A unit of FMI 2.0 or 3.0 for Co-Simulation, ready to be instantiated.
///
/// The archive is unpacked by [`Archive::unpack`] and read by [`ModelDescription::read`]; of the
/// `fmi` crate only the bindings are used. Its own reader refuses sound units of FMI 3.0 (a
/// `BaseUnit` with `K`, a variable with `unit`), and its instances have no FMU state in FMI 3.0.
pub struct Unit {
    pub(crate) library: Library,
    pub(crate) name: CString,
    pub(crate) token: CString,
    /// What is handed to the unit as its resources: a URI in FMI 2.0, a path in FMI 3.0.
    pub(crate) resources: Option<CString>,
    path: PathBuf,
    description: ModelDescription,
    interface: Interface,
    /// Deleted last.
    _folder: TempDir,
}

impl std::fmt::Debug for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Unit").field("path", &self.path).finish_non_exhaustive()
    }
}

impl Unit {
    /// Unpacks and loads the unit at `path`.
    ///
    /// # Errors
    /// [`LoadError`]. A library that crashes while it is loaded takes the program with it.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        let mut archive = Archive::open(path)?;
        let reading = ModelDescription::read(&archive.description()?);
        let Some(description) = reading.description else {
            let fault = reading.faults.into_iter().next();
            let (line, message) = fault.map_or((1, String::new()), |fault| (fault.line, fault.message));
            return Err(LoadError::Description { path: path.to_owned(), line, message });
        };
        let no_interface = || LoadError::NoCoSimulation { path: path.to_owned() };
        let interface = description.co_simulation.clone().ok_or_else(no_interface)?;
        let library = library_entry(&archive, &description, &interface)?;
        let missing = missing_functions(&mut archive, &description, &library)?;
        if !missing.is_empty() {
            return Err(LoadError::Symbols { path: path.to_owned(), library, missing: missing.join(", ") });
        }
        let unwritable = |source| ArchiveError::Unwritable { path: std::env::temp_dir(), source };
        let folder = tempfile::Builder::new().prefix("toolroom-fmu-").tempdir().map_err(unwritable)?;
        archive.unpack(folder.path())?;
        let refused = |reason: String| LoadError::Library { path: path.to_owned(), library: library.clone(), reason };
        let file = folder.path().join(&library);
        // SAFETY: the library is what the user asked to run; its functions were looked up above.
        let loaded = unsafe {
            if description.major == 2 {
                Fmi2Binding::new(&file)
                    .map(|binding| Library::Two(Box::new(binding)))
                    .map_err(|error| refused(error.to_string()))?
            } else {
                Fmi3Binding::new(&file)
                    .map(|binding| Library::Three(Box::new(binding)))
                    .map_err(|error| refused(error.to_string()))?
            }
        };
        let text = |text: String| CString::new(text).map_err(|_| refused("a name with a zero byte".to_owned()));
        let resources = folder.path().join("resources");
        let resources = match description.major {
            2 => Some(format!("file://{}", percent_encoded(&resources))),
            // NULL without resources; the path of a folder ends with a separator.
            _ => resources.is_dir().then(|| format!("{}{}", resources.display(), std::path::MAIN_SEPARATOR)),
        };
        Ok(Self {
            library: loaded,
            name: text(description.model_name.clone())?,
            token: text(description.token.clone())?,
            resources: resources.map(text).transpose()?,
            path: path.to_owned(),
            description,
            interface,
            _folder: folder,
        })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What the unit says about itself.
    pub fn description(&self) -> &ModelDescription {
        &self.description
    }

    /// Its interface for Co-Simulation.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }
}

/// The entry of the library for this computer.
fn library_entry(
    archive: &Archive,
    description: &ModelDescription,
    interface: &Interface,
) -> Result<String, LoadError> {
    let names: Vec<String> = archive.entries().iter().map(crate::Entry::slashed).collect();
    let name = |folder: &str| format!("binaries/{folder}/{}{}", interface.identifier, std::env::consts::DLL_SUFFIX);
    let host = Platform::host();
    let wanted: Vec<String> =
        host.map_or_else(Vec::new, |host| vec![name(host.folder(description.major)), name(host.fmi3)]);
    wanted.iter().find(|wanted| names.contains(wanted)).cloned().ok_or_else(|| {
        let folder =
            |name: &String| name.strip_prefix("binaries/")?.split_once('/').map(|(folder, _)| folder.to_owned());
        let folders: std::collections::BTreeSet<String> = names.iter().filter_map(folder).collect();
        LoadError::Platform {
            path: archive.path().to_owned(),
            wanted: wanted.into_iter().next().unwrap_or_else(|| name(std::env::consts::ARCH)),
            there: folders.into_iter().collect::<Vec<_>>().join(", "),
        }
    })
}

fn missing_functions(
    archive: &mut Archive,
    description: &ModelDescription,
    library: &str,
) -> Result<Vec<&'static str>, LoadError> {
    let path = archive.path().to_owned();
    let refused = |reason| LoadError::Library { path, library: library.to_owned(), reason };
    let binary = Binary::parse(&archive.read(library)?).map_err(refused)?;
    Ok(functions(description).filter(|function| !binary.functions.contains(*function)).collect())
}

/// A path as the path of a URI (RFC 3986).
fn percent_encoded(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/:".contains(&byte);
    let encoded =
        text.bytes().map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") });
    let root = if text.starts_with('/') { "" } else { "/" };
    root.to_owned() + &encoded.collect::<String>()
}
