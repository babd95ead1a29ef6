//! A simulated run as the sensors of its file would have recorded it.

use crate::GapStudyError;
use toolroom_gap::{ModelFileError, Settings, sensor_sheet};
use toolroom_recording::simulated;
use toolroom_records::{RecordKind, Records};
use toolroom_scenario_file::ScenarioFile;
use toolroom_shop::RunLog;

/// Kinds of records that a simulated shop leaves.
pub const RECORDED: [RecordKind; 6] = [
    RecordKind::Turning,
    RecordKind::Milling,
    RecordKind::Grinding,
    RecordKind::Shop,
    RecordKind::Orders,
    RecordKind::Program,
];

/// What would have been measured of a run of the scenario in `file`, kind by kind; kinds without rows are left out.
/// Readings carry the errors of the sensors in the section `[gap]`, drawn from the seed of the scenario; `name` is that
/// of the file in messages.
///
/// # Errors
/// [`ModelFileError::Sensor`]: a quantity that does not fit its channel. [`GapStudyError::Refused`]: an effect of a user
/// gives no value at a state between those of the run.
pub fn recorded(name: &str, file: &ScenarioFile, log: &RunLog) -> Result<Vec<Records>, GapStudyError> {
    let sheet = |kind| Ok((kind, sensor_sheet(name, file.gap.as_ref(), kind)?));
    let sheets = RECORDED.into_iter().map(sheet).collect::<Result<Vec<(RecordKind, Settings)>, ModelFileError>>()?;
    let sensor = |kind: RecordKind, channel: &str| {
        let settings = sheets.iter().find(|(other, _)| *other == kind).map(|(_, settings)| settings.clone());
        settings.unwrap_or_default().sensor(channel)
    };
    Ok(simulated(&file.scenario, log, &sensor)?)
}
