//! What the file of a model states about sensors, scatter and priors.

use super::Settings;
use super::model_file_error::ModelFileError;
use toolroom_process::unit;
use toolroom_records::{RecordKind, Sensor};
use toolroom_scenario::{GapSection, Scenario, SensorErrors};
use toolroom_wear::Scatter;

/// Shares of a distribution by which its variance is taken (assumption: of times that scatter by half their mean a hundredth
/// and a half of it lies beyond them).
const QUANTILES: usize = 400;

/// What a run of the scenario draws for the tools of a process, their workpieces and the handling of parts.
pub(super) fn randomness(settings: &mut Settings, scenario: &Scenario, process: &str) {
    let tool = scenario.tools.iter().find(|tool| tool.process.name() == process);
    settings.scatter = tool.map(|tool| tool.scatter).filter(|scatter| *scatter != Scatter::none());
    let own = tool.map(|tool| tool.structure_scatter).unwrap_or_default();
    settings.structure_scatter = [own.natural_frequency, own.damping_ratio];
    settings.spreads = tool.map(|tool| tool.spreads.clone()).unwrap_or_default();
    settings.lots = scenario.parts.iter().map(|part| (part.name.clone(), part.batch_size)).collect();
    let machines = scenario.machines.iter().filter(|machine| machine.process == process);
    let handling =
        machines.map(|machine| machine.load_time.variance(QUANTILES) + machine.unload_time.variance(QUANTILES));
    settings.handling = handling.fold(0.0, f64::max).sqrt();
}

/// What the section of the diagnosis states about priors, constants and sensors.
///
/// # Errors
/// [`ModelFileError::Sensor`]: a quantity that does not fit its channel.
pub(super) fn settings(file: &str, section: &GapSection, kind: RecordKind) -> Result<Settings, ModelFileError> {
    let mut settings = Settings {
        force: section.force,
        temperature: section.temperature,
        wear_level: section.wear_level,
        stiffness: section.stiffness,
        conditions: section.conditions.clone(),
        channels: section.channels.clone(),
        constant_rate: section.constant_rate,
        edge_wear: section.edge_wear,
        edge_force: section.edge_force,
        ..Settings::default()
    };
    for sensor in &section.sensors {
        settings.sensors.push((sensor.channel.clone(), errors(file, sensor, kind)?));
    }
    Ok(settings)
}

/// The sensor sheet of `kind` where records are made rather than read: entries of other kinds are
/// passed over.
///
/// # Errors
/// [`ModelFileError::Sensor`]: a quantity that does not fit its channel.
pub fn sensor_sheet(file: &str, section: Option<&GapSection>, kind: RecordKind) -> Result<Settings, ModelFileError> {
    let mut settings = Settings::default();
    let sensors = section.into_iter().flat_map(|section| &section.sensors);
    for sensor in sensors.filter(|sensor| kind.column(&sensor.channel).is_some()) {
        settings.sensors.push((sensor.channel.clone(), errors(file, sensor, kind)?));
    }
    Ok(settings)
}

fn errors(file: &str, sensor: &SensorErrors, kind: RecordKind) -> Result<Sensor, ModelFileError> {
    let fault =
        |reason: String| ModelFileError::Sensor { file: file.to_owned(), channel: sensor.channel.clone(), reason };
    let column = kind.column(&sensor.channel);
    let column = column.ok_or_else(|| fault("no such channel".to_owned()))?;
    let quantity = |text: &Option<String>| match text {
        None => Ok(0.0),
        Some(text) => unit::quantity(text, column.unit).map_err(|reason| fault(reason.to_string())),
    };
    Ok(Sensor {
        relative: sensor.relative,
        absolute: quantity(&sensor.absolute)?,
        resolution: quantity(&sensor.resolution)?,
    })
}
