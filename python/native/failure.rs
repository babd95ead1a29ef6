//! What can go wrong, as `toolroom.Error` with code, place and help.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::fmt::Display;
use std::path::Path;
use toolroom::form::{FaultList, ReadError};
use toolroom::gap::ModelFileError;
use toolroom::gap_study::{GapStudyError, UserEffectsError};
use toolroom::kinds::KindError;

/// One fault of a file.
#[derive(Debug)]
pub struct Problem {
    /// Word of `toolroom explain`.
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// The file, or `--set`.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// The likely fix.
    pub help: Option<String>,
}

/// Why a call did not do its work.
#[derive(Debug)]
pub enum Failure {
    /// Faults of a file, never none.
    File(Vec<Problem>),
    /// An argument or a file as a whole.
    Argument {
        /// What is wrong.
        message: String,
        /// The likely fix.
        help: Option<String>,
    },
    /// The work could not be done although the input is right.
    Work(String),
    /// What Python raised.
    Python(PyErr),
}

impl Failure {
    /// An argument that cannot be used, with the likely fix.
    pub fn argument(message: impl Display, help: impl Display) -> Self {
        Self::Argument { message: message.to_string(), help: Some(help.to_string()) }
    }

    /// Work that failed.
    pub fn work(message: impl Display) -> Self {
        Self::Work(message.to_string())
    }

    /// A file that cannot be read or written.
    pub fn file(path: &Path, error: &std::io::Error) -> Self {
        Self::argument(format_args!("{}: {error}", path.display()), "check the path")
    }
}

fn problems(list: &FaultList) -> Vec<Problem> {
    let problem = |(problem, place): (&toolroom::form::Problem, toolroom::form::Place)| Problem {
        code: problem.fault.code(),
        message: problem.fault.to_string(),
        file: list.source(place.origin).0.to_owned(),
        line: place.line,
        column: place.column,
        help: problem.fault.fix(),
    };
    list.problems.iter().zip(list.places()).map(problem).collect()
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        match &error {
            ReadError::Faults(list) => Self::File(problems(list)),
            other => Self::Argument { message: other.to_string(), help: None },
        }
    }
}

impl From<UserEffectsError> for Failure {
    fn from(error: UserEffectsError) -> Self {
        match error {
            UserEffectsError::Read(error) => error.into(),
            twice => Self::argument(&twice, twice.fix()),
        }
    }
}

impl From<KindError> for Failure {
    fn from(error: KindError) -> Self {
        match error {
            KindError::Read(error) => error.into(),
            other => Self::argument(&other, other.fix()),
        }
    }
}

impl From<GapStudyError> for Failure {
    fn from(error: GapStudyError) -> Self {
        match error {
            GapStudyError::Model(ModelFileError::Read(error)) => error.into(),
            other => match other.fix() {
                Some(fix) => Self::argument(other, fix),
                None => Self::work(other),
            },
        }
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        if let Failure::Python(error) = failure {
            return error;
        }
        Python::attach(|py| raised(py, failure).unwrap_or_else(|error| error))
    }
}

/// The exception of a failure.
fn raised(py: Python<'_>, failure: Failure) -> PyResult<PyErr> {
    let class = py.import("toolroom._error")?.getattr("Error")?;
    let about = PyDict::new(py);
    let message = match failure {
        Failure::Python(error) => return Ok(error),
        Failure::Work(message) => {
            about.set_item("code", "work")?;
            message
        }
        Failure::Argument { message, help } => {
            about.set_item("code", "argument")?;
            about.set_item("help", help)?;
            message
        }
        Failure::File(problems) => {
            let mut list = Vec::new();
            let mut lines = Vec::new();
            for problem in &problems {
                let one = PyDict::new(py);
                one.set_item("code", problem.code)?;
                one.set_item("message", &problem.message)?;
                one.set_item("file", &problem.file)?;
                one.set_item("line", problem.line)?;
                one.set_item("column", problem.column)?;
                one.set_item("help", &problem.help)?;
                lines.push(format!("{}:{}:{}: {}", problem.file, problem.line, problem.column, problem.message));
                list.push(one);
            }
            if let Some(first) = list.first() {
                for key in ["code", "file", "line", "column", "help"] {
                    about.set_item(key, first.get_item(key)?)?;
                }
            }
            about.set_item("problems", list)?;
            lines.join("\n")
        }
    };
    Ok(PyErr::from_value(class.call((message,), Some(&about))?))
}
