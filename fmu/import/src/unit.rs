//! A unit unpacked and loaded.

#![allow(unsafe_code)] // loading a library runs its initialisers

use crate::archive::{Archive, ArchiveError};
use crate::check::functions;
use crate::description::{Interface, ModelDescription};
use crate::instance::{Body, CallError, Local, Port, StartValue};
use crate::platform::{Binary, Platform};
#[cfg(unix)]
use crate::worker::Workers;
use fmi::fmi2::binding::Fmi2Binding;
use fmi::fmi3::binding::Fmi3Binding;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
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
    /// No interface that can be driven, or not the one that was requested.
    #[error("{path} has no interface for {wanted}; it has: {there}", path = .path.display())]
    Interface {
        /// The file.
        path: PathBuf,
        /// What was looked for.
        wanted: String,
        /// Interfaces that there are.
        there: String,
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
    /// A clock that has to be ticked in Model Exchange.
    #[error(
        "{path}: in Model Exchange its importer has to tick the clock {clock}, which is not offered; Co-Simulation \
         leaves clocks to the unit",
        path = .path.display()
    )]
    Clock {
        /// The file.
        path: PathBuf,
        /// Name of the clock.
        clock: String,
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

/// What a process has to know to load the library of a unit that was unpacked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Plan {
    /// 2 or 3.
    pub major: u32,
    /// The library.
    pub file: String,
    /// Name of the model.
    pub name: String,
    /// GUID or instantiation token.
    pub token: String,
    /// What is handed to the unit as its resources: a URI in FMI 2.0, a path in FMI 3.0.
    pub resources: Option<String>,
    /// What there is to integrate, where the unit is driven by Model Exchange.
    pub equations: Option<Equations>,
}

/// What a description says of the equations of Model Exchange.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Equations {
    /// Continuous states, where none of them is an array, whose size only the library knows.
    pub states: Option<u32>,
    /// Event indicators; FMI 3.0 has a function for the number.
    pub indicators: u32,
    /// Whether the unit wants to hear of each step of the integrator.
    pub completed: bool,
    /// Names of the derivatives as the description lists them, for messages.
    pub names: Vec<String>,
}

impl Equations {
    fn of(description: &ModelDescription, interface: &Interface) -> Self {
        let mut derivatives = description.structure.derivatives.iter();
        let scalars = derivatives.all(|unknown| description.variables[unknown.variable].dimensions.is_empty());
        Self {
            states: scalars.then_some(description.structure.derivatives.len() as u32),
            indicators: description.structure.event_indicators as u32,
            completed: match description.major {
                2 => !interface.can("completedIntegratorStepNotNeeded"),
                _ => interface.can("needsCompletedIntegratorStep"),
            },
            names: {
                let unknowns = description.structure.derivatives.iter();
                unknowns.map(|unknown| description.variables[unknown.variable].name.clone()).collect()
            },
        }
    }
}

/// The functions of a library.
pub(crate) enum Functions {
    Two(Box<Fmi2Binding>),
    Three(Box<Fmi3Binding>),
}

/// A library loaded into this process.
pub(crate) struct Library {
    pub functions: Functions,
    pub name: CString,
    pub token: CString,
    pub resources: Option<CString>,
    pub equations: Option<Equations>,
}

impl std::fmt::Debug for Library {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Library").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Library {
    /// Loads the library of `plan`, which runs its initialisers.
    pub fn load(plan: &Plan) -> Result<Arc<Self>, String> {
        let text = |text: &str| CString::new(text).map_err(|_| "a name with a zero byte".to_owned());
        // SAFETY: the library is what the user asked to run; its functions were looked up before.
        let functions = unsafe {
            if plan.major == 2 {
                Fmi2Binding::new(&plan.file).map(|binding| Functions::Two(Box::new(binding)))
            } else {
                Fmi3Binding::new(&plan.file).map(|binding| Functions::Three(Box::new(binding)))
            }
        };
        Ok(Arc::new(Self {
            functions: functions.map_err(|error| refusal_of_loader(&error.to_string()))?,
            name: text(&plan.name)?,
            token: text(&plan.token)?,
            resources: plan.resources.as_deref().map(text).transpose()?,
            equations: plan.equations.clone(),
        }))
    }
}

/// What the system's loader says, with the way out where the library is one of Python's.
fn refusal_of_loader(said: &str) -> String {
    if said.contains("Py") && said.contains("undefined symbol") || said.contains("libpython") {
        let advice = "the unit needs the library of Python: LD_PRELOAD=$(python3 -c 'import sysconfig as s; \
                      print(s.get_config_var(\"LIBDIR\") + \"/\" + s.get_config_var(\"LDLIBRARY\"))') before the command";
        return format!("{said}; {advice}");
    }
    said.to_owned()
}

/// Where the code of a unit runs.
#[derive(Clone, Debug, PartialEq)]
pub enum Isolation {
    /// In this process: fastest, and a unit that crashes takes the program with it.
    None,
    /// In worker processes, one for each thread that uses the unit.
    Process(WorkerProgram),
}

/// How worker processes are started.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkerProgram {
    /// A program that calls [`crate::worker::serve`] when it is given these arguments.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<String>,
    /// Longest time that one call of the unit may take.
    pub call_limit: Duration,
}

/// Longest time that one call of a unit may take, s, where nothing else is said (assumption: a step of a unit that is
/// of use in a study of thousands of passes takes far less).
pub const CALL_LIMIT: f64 = 10.0;

/// Which communication steps a unit takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steps {
    /// Any.
    Any,
    /// Steps of this length only, s.
    Every(f64),
    /// Steps of one length only, of which its description does not speak.
    Unknown,
}

/// By which interface a unit is driven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Driven {
    /// Co-Simulation where the unit has it, else Model Exchange.
    #[default]
    Either,
    /// Co-Simulation.
    CoSimulation,
    /// Model Exchange: its equations are integrated here, by the pair of Dormand and Prince.
    ModelExchange,
}

/// A unit of FMI 2.0 or 3.0 for Co-Simulation or Model Exchange, ready to be instantiated.
///
/// The archive is unpacked by [`Archive::unpack`] and read by [`ModelDescription::read`]; of the
/// `fmi` crate only the bindings are used. Its own reader refuses sound units of FMI 3.0 (a
/// `BaseUnit` with `K`, a variable with `unit`), and its instances have no FMU state in FMI 3.0.
pub struct Unit {
    home: Home,
    path: PathBuf,
    description: ModelDescription,
    interface: Interface,
    exchange: bool,
    /// Deleted last.
    _folder: TempDir,
}

/// Where the instances of a unit live.
enum Home {
    Here(Arc<Library>),
    #[cfg(unix)]
    Workers(Box<Workers>),
}

impl std::fmt::Debug for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Unit").field("path", &self.path).finish_non_exhaustive()
    }
}

impl Unit {
    /// Unpacks the unit at `path` and loads it where `isolation` says.
    ///
    /// # Errors
    /// [`LoadError`]. Without isolation a library that crashes while it is loaded takes the program with it.
    pub fn load(path: &Path, isolation: &Isolation) -> Result<Self, LoadError> {
        Self::load_driven(path, isolation, Driven::Either)
    }

    /// [`Unit::load`] for one interface.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn load_driven(path: &Path, isolation: &Isolation, driven: Driven) -> Result<Self, LoadError> {
        let mut archive = Archive::open(path)?;
        let reading = ModelDescription::read(&archive.description()?);
        let Some(description) = reading.description else {
            let fault = reading.faults.into_iter().next();
            let (line, message) = fault.map_or((1, String::new()), |fault| (fault.line, fault.message));
            return Err(LoadError::Description { path: path.to_owned(), line, message });
        };
        let (interface, equations) = interface(path, &description, driven)?;
        if let Some(clock) = description.clock_to_tick().filter(|_| equations.is_some()) {
            return Err(LoadError::Clock { path: path.to_owned(), clock: clock.name.clone() });
        }
        let library = library_entry(&archive, &description, &interface)?;
        let missing = missing_functions(&mut archive, &description, &library)?;
        if !missing.is_empty() {
            return Err(LoadError::Symbols { path: path.to_owned(), library, missing: missing.join(", ") });
        }
        let unwritable = |source| ArchiveError::Unwritable { path: std::env::temp_dir(), source };
        let folder = tempfile::Builder::new().prefix("toolroom-fmu-").tempdir().map_err(unwritable)?;
        let unpacked = folder.path().join("unit");
        archive.unpack(&unpacked)?;
        let refused = |reason: String| {
            let reason = reason.strip_prefix("nothing: ").map(str::to_owned).unwrap_or(reason); // of a worker that ended
            LoadError::Library { path: path.to_owned(), library: library.clone(), reason }
        };
        let resources = unpacked.join("resources");
        let plan = Plan {
            major: description.major.into(),
            file: unpacked.join(&library).display().to_string(),
            name: description.model_name.clone(),
            token: description.token.clone(),
            resources: match description.major {
                2 => Some(format!("file://{}", percent_encoded(&resources))),
                // NULL without resources; the path of a folder ends with a separator.
                _ => resources.is_dir().then(|| format!("{}{}", resources.display(), std::path::MAIN_SEPARATOR)),
            },
            equations,
        };
        let exchange = plan.equations.is_some();
        let home = match isolation {
            Isolation::None => Home::Here(Library::load(&plan).map_err(refused)?),
            #[cfg(unix)]
            Isolation::Process(program) => {
                Home::Workers(Box::new(Workers::start(plan, program.clone(), folder.path()).map_err(refused)?))
            }
            #[cfg(not(unix))]
            Isolation::Process(_) => {
                return Err(refused("worker processes are for Linux and macOS: set isolation to none".to_owned()));
            }
        };
        Ok(Self { home, path: path.to_owned(), description, interface, exchange, _folder: folder })
    }

    /// A new instance, initialised at `start` (s).
    pub(crate) fn instantiate(
        &self,
        start_values: &[(Port, StartValue)],
        start: f64,
    ) -> Result<Box<dyn Body>, CallError> {
        match &self.home {
            Home::Here(library) => Ok(Box::new(Local::new(library, start_values, start, &|_| {})?)),
            #[cfg(unix)]
            Home::Workers(workers) => {
                // A unit of states that go anywhere has few instances, each with a process of its own.
                let interface = &self.interface;
                let alone = interface.saves_state() && interface.serializes_state()
                    || interface.can("canBeInstantiatedOnlyOncePerProcess");
                workers.instantiate(alone, start_values, start)
            }
        }
    }

    /// Whether a second instance must wait for the first one to be freed.
    pub(crate) fn only_one(&self) -> bool {
        matches!(self.home, Home::Here(_)) && self.interface.can("canBeInstantiatedOnlyOncePerProcess")
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What the unit says about itself.
    pub fn description(&self) -> &ModelDescription {
        &self.description
    }

    /// The interface by which it is driven.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// Which communication steps it takes: what `canHandleVariableCommunicationStepSize` says, with the length from
    /// `fixedInternalStepSize`, or else from the step of the default experiment.
    pub fn steps(&self) -> Steps {
        if self.exchange || self.interface.can("canHandleVariableCommunicationStepSize") {
            return Steps::Any;
        }
        self.description.fixed_step(&self.interface).map_or(Steps::Unknown, Steps::Every)
    }

    /// Whether that is Model Exchange.
    pub fn is_model_exchange(&self) -> bool {
        self.exchange
    }
}

/// The interface to drive a unit by, with what there is to integrate in Model Exchange.
fn interface(
    path: &Path,
    description: &ModelDescription,
    driven: Driven,
) -> Result<(Interface, Option<Equations>), LoadError> {
    let steps = description.co_simulation.as_ref().filter(|_| driven != Driven::ModelExchange);
    let exchange = description.model_exchange.as_ref().filter(|_| driven != Driven::CoSimulation);
    match (steps, exchange) {
        (Some(interface), _) => Ok((interface.clone(), None)),
        (None, Some(interface)) => Ok((interface.clone(), Some(Equations::of(description, interface)))),
        (None, None) => Err(LoadError::Interface {
            path: path.to_owned(),
            wanted: match driven {
                Driven::Either => "Co-Simulation or Model Exchange",
                Driven::CoSimulation => "Co-Simulation",
                Driven::ModelExchange => "Model Exchange",
            }
            .to_owned(),
            there: description.interfaces().map(|(name, _)| name).collect::<Vec<_>>().join(", "),
        }),
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
