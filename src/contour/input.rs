//! The contour file, the part program beside it, and their refusals.

use crate::failure::Failure;
use crate::faulty::{FaultyFile, Placed, key_place};
use std::path::Path;
use toolroom_contour::{ContourError, ContourFile, FileError, GcodeFileError};
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
    /// The contour file and, where it draws the contour, the part program.
    pub inputs: Vec<Text>,
}

/// Reads a contour file, with the part program `gcode` beside it and the values of `--set`; `passes` have to be in it.
pub fn read(file: &Path, gcode: Option<&Path>, set: &[String], passes: &[String]) -> Result<Task, Failure> {
    let setup = open(file, "give a contour file, such as scenarios/contour/rk3.toml")?;
    let program = gcode.map(|path| open(path, "give a part program of G0 to G3")).transpose()?;
    let read = match &program {
        None => ContourFile::read(&setup.text).map_err(|error| refused(&setup, error)),
        Some(program) => ContourFile::read_with_gcode(&setup.text, &program.text).map_err(|error| match error {
            GcodeFileError::Program(error) => refused(program, error),
            GcodeFileError::File(error) => refused(&setup, error),
            other => Failure::argument(other, "see the contour file"),
        }),
    };
    let mut file = read?;
    for change in set {
        let (key, value) = change.split_once('=').ok_or_else(|| {
            let example = "--set pass.finish.tolerance=\"0.03 mm\"";
            Failure::argument(format_args!("`{change}` is not of the form key=value"), example)
        })?;
        let help = "keys are group.key, such as economics.edge_cost, or pass.NAME.key";
        file.set(key.trim(), value.trim())
            .map_err(|error| Failure::argument(format_args!("--set {change}: {error}"), help))?;
    }
    for name in passes {
        file.pass(name)
            .map_err(|error| Failure::argument(format_args!("--pass: {error}"), "leave --pass out for all"))?;
    }
    let inputs = std::iter::once(setup).chain(program).collect();
    Ok(Task { file, inputs })
}

fn open(path: &Path, help: &str) -> Result<Text, Failure> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::argument(format_args!("{name} cannot be read: {error}"), help))?;
    Ok(Text { name, text: text.trim_start_matches('\u{FEFF}').to_owned() })
}

fn refused(input: &Text, error: FileError) -> Failure {
    let FileError { line, column, fault } = error;
    FaultyFile::new(&input.name, &input.text, vec![Placed::new(fault.code(), (line, column), fault)]).into()
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
