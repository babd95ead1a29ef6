//! The jobs that came to a shop, as the data hold them beside its log.

use crate::machines::Machines;
use crate::{GapRequest, GapStudyError, Reading};
use toolroom_gap::{Jobs, ModelFileError, NominalModel, NominalProcess};
use toolroom_records::{RecordError, RecordKind, Records, has_table, read};

/// The jobs that came to the shop of a model that describes its log, or else to that of the `machines` of a process; `None` where
/// the data hold none.
///
/// # Errors
/// [`GapStudyError`]: a file that cannot be read.
pub fn jobs(
    request: &GapRequest<'_>,
    tables: &[Option<(NominalModel, Records)>],
    machines: Option<&Machines>,
    reading: &Reading<'_>,
) -> Result<Option<Jobs>, GapStudyError> {
    let is_shop = |table: &Option<(NominalModel, Records)>| {
        table.as_ref().is_some_and(|(model, _)| matches!(model.process, NominalProcess::Shop(_)))
    };
    // Machines are those of the only model.
    let place = tables.iter().position(is_shop).or_else(|| machines.filter(|own| own.has_events()).map(|_| 0));
    let Some(path) = place.and_then(|place| request.models.get(place)) else { return Ok(None) };
    // Of a log that is held out nobody knows when it began: its orders are not read.
    let alone = request.holdout_data.is_none() && request.data.is_dir();
    if !alone || !has_table(request.data, RecordKind::Orders) {
        return Ok(None);
    }
    let records = match read(request.data, RecordKind::Orders, reading.parquet) {
        Err(RecordError::NoRows { wrong: false, .. }) => return Ok(None),
        // A planner's table of orders has the same name.
        Err(error @ RecordError::MissingColumn { .. }) => {
            (reading.say)(&format!(
                "{error}: it is no table of jobs that came, and neither arrivals nor scrap is tested"
            ));
            return Ok(None);
        }
        read => reading.said(read)?,
    };
    let scenario = toolroom_scenario_file::read(path, request.set).map_err(ModelFileError::from)?.scenario;
    Ok(Some(Jobs { records, scenario }))
}
