//! A contour file, the part program beside it, and their refusals.

use super::files::programs;
use super::study::{RefusedPass, StudyOptions, studies};
use std::path::Path;
use toolroom_contour::{ContourError, ContourFile, Drawing, FileError, GcodeFileError};
use toolroom_form::{Echo, FaultList, FormFile, ReadError, Refusal, key_place};
use toolroom_process::ModelError;
use toolroom_program::{Control, Dialect, Units};

/// A text file with its name.
#[derive(Clone, Debug)]
pub struct Text {
    /// Name of the file.
    pub name: String,
    /// What it holds.
    pub text: String,
}

/// What draws a contour beside its file.
#[derive(Clone, Copy, Debug)]
pub enum Drawn<'a> {
    /// A part program in the language of a control.
    Program(&'a Path, &'a Control),
    /// A DXF file with the layer to read, the unit of a drawing that names none, and the distance of ends that are one point, m.
    Dxf(&'a Path, Option<&'a str>, Option<Units>, Option<f64>),
}

/// A contour task as read.
#[derive(Clone, Debug)]
pub struct Task {
    /// The contour and its passes.
    pub file: ContourFile,
    /// Its values as they were understood.
    pub echo: Vec<Echo>,
    /// The contour file and, where it draws the contour, the part program.
    pub inputs: Vec<Text>,
}

impl Task {
    /// Reads a contour file, with what draws its contour beside it, and the values of `--set`.
    ///
    /// # Errors
    /// [`ReadError`]: a file that cannot be opened or decoded, or every fault found in it.
    pub fn read(file: &Path, drawn: Option<Drawn<'_>>, set: &[String]) -> Result<Self, ReadError> {
        let setup = open(file)?;
        let path = drawn.map(|drawn| match drawn {
            Drawn::Program(path, _) | Drawn::Dxf(path, ..) => path,
        });
        let program = path.map(part_program).transpose()?;
        let FormFile { content, echo, .. } = match drawn.zip(program.as_ref()) {
            None => ContourFile::parse(&setup.name, &setup.text, set)?,
            Some((drawn, program)) => {
                let text = program.text.as_str();
                let drawing = match drawn {
                    Drawn::Program(_, control) => Drawing::Program(text, control),
                    Drawn::Dxf(_, layer, units, join) => {
                        Drawing::Dxf { text, layer, unit: units.map(|units| 1e-3 * units.scale()), join }
                    }
                };
                ContourFile::parse_with_drawing(&setup.name, &setup.text, set, drawing)
                    .map_err(|error| refused(program, error))?
            }
        };
        Ok(Self { file: content, echo, inputs: std::iter::once(setup).chain(program).collect() })
    }

    /// Reads a contour file as [`read`](Self::read) does, and plans it, so that what only a plan finds is found too.
    ///
    /// # Errors
    /// As [`read`](Self::read), and passes for which there is no plan.
    pub fn checked(file: &Path, set: &[String]) -> Result<Self, ReadError> {
        let task = Self::read(file, None, set)?;
        // Draws are never refused.
        let options = StudyOptions { draws: 0, ..StudyOptions::default() };
        let studies =
            studies(&task.file, &options, &|_| (), &|_, _| (), None).map_err(|refused| task.refused(&refused))?;
        // The path of a pass has to fit beside what it leaves.
        programs(&task.file, &studies, Dialect::Fanuc).map_err(|refused| task.refused(&refused))?;
        drop(studies);
        Ok(task)
    }

    /// What the planner refuses, with the place of the section or key where there is one.
    pub fn refused(&self, refused: &RefusedPass) -> ReadError {
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
        placed(input, place, Refusal::new(error.code(), refused))
    }
}

/// Reads a file of passes around a contour that a part program draws; its content is the number of its passes.
///
/// # Errors
/// [`ReadError`]: a file that cannot be opened or decoded, or every fault found in it.
pub fn read_setup(file: &Path, set: &[String]) -> Result<FormFile<usize>, ReadError> {
    let setup = open(file)?;
    ContourFile::parse_setup(&setup.name, &setup.text, set)
}

fn open(path: &Path) -> Result<Text, ReadError> {
    Ok(Text { name: path.display().to_string(), text: toolroom_form::text(path)? })
}

/// The text of a part program: controls write other encodings than UTF-8 in comments.
fn part_program(path: &Path) -> Result<Text, ReadError> {
    let name = path.display().to_string();
    match std::fs::read(path) {
        Ok(bytes) => Ok(Text { name, text: String::from_utf8_lossy(&bytes).into_owned() }),
        Err(source) => Err(ReadError::Unreadable { file: name, source }),
    }
}

fn placed(input: &Text, place: (usize, usize), refusal: Refusal) -> ReadError {
    ReadError::Faults(Box::new(FaultList::refused(&input.name, &input.text, [(place, refusal)])))
}

fn refused(program: &Text, error: GcodeFileError) -> ReadError {
    match error {
        GcodeFileError::Program(FileError { line, column, fault }) => {
            placed(program, (line, column), Refusal::new(fault.code(), fault))
        }
        GcodeFileError::File(error) => error,
        other => placed(program, (1, 1), Refusal::new("gcode", other)),
    }
}
