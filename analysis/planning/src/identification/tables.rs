//! Trials and recorded forces as tables, and what is refused of them.

use super::IdentificationStudy;
use toolroom_form::{FaultList, ReadError, Refusal};
use toolroom_infeed::{
    IdentifyError, IdentifyOptions, ImpossibleTrial, TableError, TableFault, Trial, read_force_traces, read_trials,
};

/// A table (CSV) with its name.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of the file.
    pub name: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// Why nothing is identified from tables.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrialsError {
    /// A table that is none, or trials that cannot be, with their places.
    #[error(transparent)]
    Tables(#[from] ReadError),
    /// Too few trials.
    #[error(transparent)]
    Identify(IdentifyError),
}

impl IdentificationStudy {
    /// Identifies lag and stiffnesses from a table of trials and, where there is one, a table of recorded forces.
    /// The notes say, table by table, what was read differently than a reader might expect.
    ///
    /// # Errors
    /// [`TrialsError`]: faults of the tables with their places, or too few trials.
    pub fn read(
        title: impl Into<String>,
        trials: &Table,
        forces: Option<&Table>,
        options: IdentifyOptions,
    ) -> Result<(Self, Vec<String>), TrialsError> {
        let read = read_trials(&trials.name, &trials.bytes).map_err(|error| trials.refused(&error))?;
        let mut list: Vec<Trial> = read.trials;
        let mut notes: Vec<String> = read.notes.iter().map(|note| format!("{}: {note}", trials.name)).collect();
        if let Some(forces) = forces {
            let more =
                read_force_traces(&forces.name, &forces.bytes, &mut list).map_err(|error| forces.refused(&error))?;
            notes.extend(more.iter().map(|note| format!("{}: {note}", forces.name)));
        }
        let study = Self::new(title, list, options).map_err(|error| {
            if let IdentifyError::Impossible { trials: impossible } = &error {
                return trials.impossible(impossible).into();
            }
            TrialsError::Identify(error)
        })?;
        notes.extend(study.identification.left_out.iter().map(|trial| format!("{}: left out: {trial}", trials.name)));
        Ok((study, notes))
    }
}

impl Table {
    /// A table that is none. Its columns are cells: the line is what an editor finds.
    fn refused(&self, error: &TableError) -> ReadError {
        let placed = |TableFault { line, column, reason }: &TableFault| {
            ((*line, 1), Refusal::new(reason.code(), format_args!("{reason} (cell {column})")))
        };
        self.faults(error.faults.iter().map(placed))
    }

    /// Trials that cannot be, each by its name and line.
    fn impossible(&self, trials: &[ImpossibleTrial]) -> ReadError {
        let placed = |trial: &ImpossibleTrial| {
            let message = format!("trial `{}`: {}", trial.trial_id, trial.fault);
            ((trial.line.unwrap_or(1), 1), Refusal::new(trial.fault.code(), message))
        };
        self.faults(trials.iter().map(placed))
    }

    fn faults(&self, refusals: impl Iterator<Item = ((usize, usize), Refusal)>) -> ReadError {
        let text = String::from_utf8_lossy(&self.bytes);
        ReadError::Faults(Box::new(FaultList::refused(&self.name, &text, refusals)))
    }
}
