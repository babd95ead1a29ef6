//! What can go wrong, in words, with the exit code.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use toolroom_form::ReadError;
use toolroom_gap::ModelFileError;
use toolroom_gap_study::GapStudyError;
use toolroom_kinds::KindError;
use toolroom_location::{Located, Location};
use toolroom_output::{OutputError, codes, json_error, json_refusal};
use toolroom_process::ModelError;
use toolroom_shards::ShardError;
use toolroom_shop::ShopError;
use toolroom_shop_import::{ShopImportError, TableFault};
use toolroom_study::request::{RequestError, UnknownPolicy};
use toolroom_study::results::{FinishedRun, FinishedRunError};

/// Why a command did not do its work.
#[derive(Debug)]
pub enum Failure {
    /// A file was not read.
    File(ReadError),
    /// Faults of tables, each with its cell.
    Tables {
        /// The first of them.
        faults: Vec<TableFault>,
        /// How many more there are.
        more: usize,
    },
    /// An argument that cannot be used.
    Argument {
        /// A word for programs.
        code: &'static str,
        /// What is wrong.
        message: String,
        /// The likely fix.
        help: Option<String>,
        /// The file and line at fault, where one is.
        at: Option<Location>,
    },
    /// The work could not be done although the input is right.
    Work {
        /// A word for programs.
        code: &'static str,
        /// Why.
        message: String,
        /// The likely way out.
        help: Option<String>,
        /// The file and line that it is about, where it is about one.
        at: Option<Location>,
    },
    /// The work went as far as it could; what was complete is written.
    Stopped {
        /// A word for programs.
        code: &'static str,
        /// Why it went no further.
        message: String,
        /// What is there.
        help: String,
    },
    /// Done, but too little data for an answer: it is written, and may not be taken for one.
    TooLittle {
        /// What is too little.
        message: String,
    },
    /// Done, and the shop has changed.
    Alarm {
        /// What has changed.
        message: String,
    },
    /// Stopped by the user.
    Interrupted {
        /// How far the work came and what is kept.
        message: String,
        /// The way on.
        help: String,
    },
    /// A path that cannot be written.
    Unwritable { path: PathBuf, source: io::Error },
    /// A result that has no JSON form.
    Json(serde_json::Error),
}

impl Failure {
    /// An argument that cannot be used, with the likely fix.
    pub fn argument(message: impl fmt::Display, help: impl fmt::Display) -> Self {
        Self::argument_of(codes::ARGUMENT, message, help)
    }

    /// The same with a word for programs.
    pub fn argument_of(code: &'static str, message: impl fmt::Display, help: impl fmt::Display) -> Self {
        Self::Argument { code, message: message.to_string(), help: Some(help.to_string()), at: None }
    }

    /// An error that knows the file and line at fault, with the likely fix. Where the system did not give the file, the code is that
    /// of a file that cannot be read, whichever verb asked for it.
    pub fn located(error: impl Error + Located + 'static, help: impl fmt::Display) -> Self {
        let code = if is_of_system(&error) { codes::UNREADABLE } else { codes::ARGUMENT };
        Self::argument_of(code, &error, help).at(error.location())
    }

    /// What is wrong with a file as a whole, with the likely fix.
    pub fn of_file(file: &Path, wrong: impl fmt::Display, help: impl fmt::Display) -> Self {
        Self::argument(format_args!("{}: {wrong}", file.display()), help).at(Some(Location::of(file.display())))
    }

    /// A file that the system does not open, with the likely fix.
    pub fn unreadable(file: &Path, error: impl fmt::Display, help: impl fmt::Display) -> Self {
        let message = format!("{} cannot be read: {error}", file.display());
        Self::argument_of(codes::UNREADABLE, message, help).at(Some(Location::of(file.display())))
    }

    /// A file that cannot be read.
    pub fn unread(file: &Path) -> impl Fn(io::Error) -> Self {
        |error| {
            let message = format!("{}: {error}", file.display());
            Self::argument_of(codes::UNREADABLE, message, "check the path").at(Some(Location::of(file.display())))
        }
    }

    /// The same about a place in a file.
    pub fn at(mut self, place: Option<Location>) -> Self {
        if let Self::Argument { at, .. } | Self::Work { at, .. } = &mut self {
            *at = place;
        }
        self
    }

    /// Work that could not be done, in words.
    pub fn work(message: impl fmt::Display) -> Self {
        Self::Work { code: codes::WORK, message: message.to_string(), help: None, at: None }
    }

    /// Work that could not be done, by an error; with the code of the model that refused, where one did.
    pub fn work_error(error: &(dyn Error + 'static)) -> Self {
        Self::work_of(error, None)
    }

    /// The same with the likely way out.
    pub fn work_error_with(error: &(dyn Error + 'static), help: String) -> Self {
        Self::work_of(error, Some(help))
    }

    fn work_of(error: &(dyn Error + 'static), help: Option<String>) -> Self {
        Self::Work { code: code_of_model(error).unwrap_or(codes::WORK), message: error.to_string(), help, at: None }
    }

    /// Work that went as far as it could before an error, with what is there.
    pub fn stopped(error: &(dyn Error + 'static), help: String) -> Self {
        Self::Stopped { code: code_of_model(error).unwrap_or(codes::STOPPED), message: error.to_string(), help }
    }

    /// A word for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Argument { code, .. } | Self::Work { code, .. } | Self::Stopped { code, .. } => code,
            Self::File(_) | Self::Tables { .. } => codes::UNREADABLE,
            Self::Json(_) => codes::WORK,
            Self::TooLittle { .. } => codes::TOO_LITTLE,
            Self::Alarm { .. } => codes::ALARM,
            Self::Interrupted { .. } => codes::INTERRUPTED,
            Self::Unwritable { .. } => codes::UNWRITABLE,
        }
    }

    /// What a program is told in place of a result of `file`, one of several.
    pub fn refusal(&self, file: &Path) -> serde_json::Value {
        if let Self::File(ReadError::Faults(list)) = self {
            return json_refusal(list);
        }
        let (message, help) = match self {
            Self::Argument { message, help, .. } | Self::Work { message, help, .. } => (message.clone(), help.clone()),
            Self::File(error) => (error.to_string(), None),
            Self::TooLittle { message } | Self::Alarm { message } => (message.clone(), None),
            Self::Stopped { message, help, .. } | Self::Interrupted { message, help } => {
                (message.clone(), Some(help.clone()))
            }
            Self::Unwritable { source, .. } => (source.to_string(), None),
            Self::Json(error) => (error.to_string(), None),
            Self::Tables { faults, .. } => {
                (faults.first().map(|fault| fault.message.clone()).unwrap_or_default(), None)
            }
        };
        let error = json_error(self.code(), &message, help.as_deref(), self.place().as_ref());
        serde_json::json!({ "schema": 1, "error": error, "file": file.display().to_string(), "valid": false })
    }

    /// The file and line at fault, where they are known.
    pub fn place(&self) -> Option<Location> {
        match self {
            Self::Argument { at, .. } | Self::Work { at, .. } => at.clone(),
            Self::File(error) => error.location(),
            Self::Unwritable { path, .. } => Some(Location::of(path.display())),
            Self::Tables { .. }
            | Self::Stopped { .. }
            | Self::TooLittle { .. }
            | Self::Alarm { .. }
            | Self::Interrupted { .. }
            | Self::Json(_) => None,
        }
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::File(error)
    }
}

impl From<ShopImportError> for Failure {
    fn from(error: ShopImportError) -> Self {
        let fix = error.fix();
        match error {
            ShopImportError::Read(error) => error.into(),
            ShopImportError::Cells { faults, more } => Self::Tables { faults, more },
            table @ ShopImportError::Table { .. } => {
                let (at, message) = (table.location(), table.to_string());
                Self::Argument { code: codes::ARGUMENT, message, help: fix.map(str::to_owned), at }
            }
        }
    }
}

impl From<UnknownPolicy> for Failure {
    fn from(error: UnknownPolicy) -> Self {
        Self::argument(&error, error.fix())
    }
}

impl From<RequestError> for Failure {
    fn from(error: RequestError) -> Self {
        Self::argument(&error, error.fix())
    }
}

impl From<FinishedRunError> for Failure {
    fn from(error: FinishedRunError) -> Self {
        Self::located(error, FinishedRun::FIX)
    }
}

impl From<GapStudyError> for Failure {
    fn from(error: GapStudyError) -> Self {
        if let GapStudyError::Model(ModelFileError::Read(error)) = error {
            return error.into();
        }
        match error.fix() {
            Some(fix) => Self::located(error, fix),
            None => Self::work_error(&error),
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Refused { message, help } => Self::argument(message, help),
            OutputError::Unwritable { path, source } => Self::Unwritable { path, source },
            OutputError::Json(error) => Self::Json(error),
            OutputError::Shard(error) => error.into(),
            work @ OutputError::Work { .. } => Self::work_error(&work),
        }
    }
}

impl From<ShardError> for Failure {
    /// Files that cannot be written are work that failed, the rest is input.
    fn from(error: ShardError) -> Self {
        if let ShardError::File { path, source } = error {
            return Self::Unwritable { path, source };
        }
        if let ShardError::Rows { .. } = error {
            return Self::work(format_args!("{error}; shards that were complete stay, go on with --resume"));
        }
        let fix = error.fix();
        Self::located(error, fix)
    }
}

impl From<KindError> for Failure {
    fn from(error: KindError) -> Self {
        let fix = error.fix();
        if let KindError::Read(error) = error { error.into() } else { Self::located(error, fix) }
    }
}

/// Whether an error comes from the system, which did not open or read a file.
fn is_of_system(error: &(dyn Error + 'static)) -> bool {
    error.is::<io::Error>() || error.source().is_some_and(is_of_system)
}

/// The code of the refusal of a model or of the stop of a shop that an error comes from, where it has one.
fn code_of_model(error: &(dyn Error + 'static)) -> Option<&'static str> {
    let of_shop = || error.downcast_ref::<Box<ShopError>>().and_then(|stopped| stopped.code());
    match error.downcast_ref::<ModelError>() {
        Some(refusal) => refusal.code(),
        None => of_shop().or_else(|| error.source().and_then(code_of_model)),
    }
}
