//! The machines on which a process runs, as its file describes them, and what their log holds.

use crate::tables::reads_events;
use crate::{GapRequest, GapStudyError, Reading};
use toolroom_gap::{Diagnosis, GapVerdict, Jobs, ModelFileError, NominalModel, ShiftLabels, add_machine_facts};
use toolroom_records::{RecordError, RecordKind, Records, read, tables};
use toolroom_scenario::Scenario;

/// Said where nothing was found, and nobody could have found it.
const NOT_ASKED: &str = "not tested, since the data hold no events of the machines: changes of edges, breakdowns";

/// A scenario with the events of its machines, if the data hold any.
pub struct Machines {
    /// The file of the model.
    pub scenario: Scenario,
    events: Option<Records>,
    /// Shifts as the records of the process name them.
    labels: ShiftLabels,
}

impl Machines {
    /// The machines of the only model of a request; `None` of several models, each of which may describe another shop, of
    /// a log that is diagnosed itself, and of a file that describes no machine.
    ///
    /// # Errors
    /// [`GapStudyError`]: a file that cannot be read, events that are none.
    pub fn from_gap_request(
        request: &GapRequest<'_>,
        tables_of: &[Option<(NominalModel, Records)>],
        reading: &Reading<'_>,
    ) -> Result<Option<Self>, GapStudyError> {
        let ([path], [Some((model, records))]) = (request.models, tables_of) else { return Ok(None) };
        if !reads_events(model) {
            return Ok(None);
        }
        let scenario = toolroom_scenario_file::read(path, request.set).map_err(ModelFileError::from)?.scenario;
        let has = request.data.is_dir() && tables(request.data).contains(&RecordKind::Shop);
        let read = has.then(|| read(request.data, RecordKind::Shop, reading.parquet));
        let events = match read {
            None | Some(Err(RecordError::NoRows { wrong: false, .. })) => None,
            Some(read) => Some(reading.said(read)?),
        };
        Ok(Some(Self { scenario, events, labels: ShiftLabels::from_records(records) }))
    }

    /// Whether they have recorded anything.
    pub fn has_events(&self) -> bool {
        self.events.is_some()
    }

    /// What the machines have recorded, beside what was found in the records of the process.
    pub fn add_to(&self, jobs: Option<&Jobs>, diagnosis: &mut Diagnosis, seed: u64) {
        match &self.events {
            Some(events) => add_machine_facts(&self.scenario, events, &self.labels, jobs, diagnosis, seed),
            None if diagnosis.verdict == GapVerdict::NoGap => diagnosis.notes.push(NOT_ASKED.to_owned()),
            None => {}
        }
    }
}
