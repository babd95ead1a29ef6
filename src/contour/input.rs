//! The contour file, the part program beside it, and their refusals.

use crate::failure::Failure;
use crate::faulty::{FaultyFile, Placed, key_place};
use std::path::Path;
use toolroom_contour::{ContourError, ContourFile, FileError, GcodeFileError};
use toolroom_form::{Echo, FormFile};
use toolroom_planning::contour::RefusedPass;
use toolroom_process::ModelError;

/// A text file with its name.
pub struct Text {
    pub name: String,
    pub text: String,
}

/// A contour task as read.
pub struct Task {
    pub file: ContourFile,
    /// Its values as they were understood.
    pub echo: Vec<Echo>,
    /// The contour file and, where it draws the contour, the part program.
    pub inputs: Vec<Text>,
}

/// Reads a contour file, with the part program `gcode` beside it and the values of `--set`; `passes` have to be in it.
pub fn read(file: &Path, gcode: Option<&Path>, set: &[String], passes: &[String]) -> Result<Task, Failure> {
    let setup = open(file)?;
    let program = gcode.map(open).transpose()?;
    let FormFile { content, echo, .. } = match &program {
        None => ContourFile::parse(&setup.name, &setup.text, set)?,
        Some(program) => ContourFile::parse_with_gcode(&setup.name, &setup.text, set, &program.text)
            .map_err(|error| refused(program, error))?,
    };
    for name in passes {
        content
            .pass(name)
            .map_err(|error| Failure::argument(format_args!("--pass: {error}"), "leave --pass out for all"))?;
    }
    let inputs = std::iter::once(setup).chain(program).collect();
    Ok(Task { file: content, echo, inputs })
}

pub fn open(path: &Path) -> Result<Text, Failure> {
    let text = toolroom_form::text(path)?;
    Ok(Text { name: path.display().to_string(), text })
}

fn refused(program: &Text, error: GcodeFileError) -> Failure {
    match error {
        GcodeFileError::Program(FileError { line, column, fault }) => {
            let fault = Placed::new(fault.code(), (line, column), fault);
            FaultyFile::new(&program.name, &program.text, vec![fault]).into()
        }
        GcodeFileError::File(error) => error.into(),
        other => Failure::argument(other, "see the contour file"),
    }
}

impl Task {
    /// What the planner refuses, with the place of the section or key where there is one.
    pub fn refused(&self, refused: &RefusedPass) -> Failure {
        let error = refused.error.as_ref();
        let setup = &self.inputs[0];
        // Sections stand in the part program where there is one.
        let drawn = self.inputs.last().unwrap_or(setup);
        let (input, place) = match (error.section().and_then(|section| self.file.places.get(section)), error) {
            (Some(place), _) => (drawn, *place),
            (None, ContourError::Model(ModelError::OutOfRange { field, .. })) => {
                (setup, key_place(&setup.text, "pass", field))
            }
            (None, ContourError::Model(ModelError::Contradiction { second, .. })) => {
                (setup, key_place(&setup.text, "pass", second))
            }
            (None, _) => (setup, (1, 1)),
        };
        let fault = Placed::new(error.code(), place, refused);
        FaultyFile::new(&input.name, &input.text, vec![fault]).into()
    }
}
