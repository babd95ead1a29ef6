//! Shared libraries: there, for the right platform, complete.

use super::{Findings, Rule, Severity};
use crate::archive::Archive;
use crate::description::ModelDescription;
use crate::platform::{Binary, Platform};
use std::collections::BTreeSet;

/// The C library of the oldest systems that tools still support (RHEL 7).
const OLDEST_GLIBC: (u32, u32) = (2, 17);

pub(super) fn check(archive: &mut Archive, description: &ModelDescription, findings: &mut Findings) {
    let names: Vec<String> =
        archive.entries().iter().filter(|entry| !entry.directory).map(super::super::Entry::slashed).collect();
    let folder = |name: &str| {
        name.strip_prefix("binaries/").and_then(|rest| rest.split_once('/')).map(|(folder, _)| folder.to_owned())
    };
    let folders: BTreeSet<String> = names.iter().filter_map(|name| folder(name)).collect();
    let sources = names.iter().any(|name| name.starts_with("sources/"));
    if folders.is_empty() && !sources {
        findings.add(Rule::Platform, Severity::Error, "binaries/", "the unit has neither binaries nor sources");
    }
    let identifiers: BTreeSet<&str> =
        description.interfaces().map(|(_, interface)| interface.identifier.as_str()).collect();
    for folder in &folders {
        let place = format!("binaries/{folder}");
        let Some(platform) = Platform::of_folder(folder, description.major) else {
            // FMI 2.0.4 allows the names of FMI 3.0 beside the old ones.
            if Platform::of_folder(folder, 3).is_none() {
                let message = format!("is no platform folder of FMI {}", description.fmi_version);
                findings.add(Rule::Platform, Severity::Warning, &place, message);
            }
            continue;
        };
        for identifier in &identifiers {
            let name = format!("{place}/{identifier}{}", platform.suffix);
            if !names.contains(&name) {
                findings.add(Rule::Platform, Severity::Error, &name, "is missing: the modelIdentifier gives this name");
                continue;
            }
            one(archive, description, platform, &name, findings);
        }
    }
    if let Some(host) = Platform::host()
        && !folders.is_empty()
        && !folders.contains(host.folder(description.major))
        && !folders.contains(host.fmi3)
    {
        let message = format!(
            "no library for this computer ({}); there are: {}",
            host.folder(description.major),
            folders.iter().cloned().collect::<Vec<_>>().join(", ")
        );
        findings.add(Rule::Platform, Severity::Error, "binaries/", message);
    }
}

fn one(
    archive: &mut Archive,
    description: &ModelDescription,
    platform: &Platform,
    name: &str,
    findings: &mut Findings,
) {
    let bytes = match archive.read(name) {
        Ok(bytes) => bytes,
        Err(error) => return findings.add(Rule::Archive, Severity::Error, name, error.to_string()),
    };
    let binary = match Binary::parse(&bytes) {
        Ok(binary) => binary,
        Err(reason) => {
            return findings.add(Rule::Platform, Severity::Error, name, format!("is no shared library: {reason}"));
        }
    };
    if !binary.fits(platform) {
        findings.add(
            Rule::Platform,
            Severity::Error,
            name,
            format!("is {}; the folder is for another platform", binary.kind),
        );
    }
    let missing: Vec<&str> = functions(description).filter(|function| !binary.functions.contains(*function)).collect();
    if !missing.is_empty() {
        let message = format!("lacks {} functions: {}", missing.len(), missing.join(", "));
        findings.add(Rule::Symbols, Severity::Error, name, message);
    }
    if let Some((major, minor)) = binary.glibc.filter(|version| *version > OLDEST_GLIBC) {
        let message = format!("asks for GLIBC_{major}.{minor}; systems older than that cannot load it");
        findings.add(Rule::Platform, Severity::Warning, name, message);
    }
}

/// Functions that a library has to hand out for the interfaces of `description`; the standard
/// asks for all of an interface, also those whose capability flag is false.
pub(crate) fn functions(description: &ModelDescription) -> impl Iterator<Item = &'static str> {
    let groups: [(bool, &'static str); 4] = if description.major == 2 {
        [
            (true, FMI2),
            (description.model_exchange.is_some(), FMI2_MODEL_EXCHANGE),
            (description.co_simulation.is_some(), FMI2_CO_SIMULATION),
            (false, ""),
        ]
    } else {
        [
            (true, FMI3),
            (description.model_exchange.is_some(), FMI3_MODEL_EXCHANGE),
            (description.co_simulation.is_some(), FMI3_CO_SIMULATION),
            (description.scheduled_execution.is_some(), FMI3_SCHEDULED_EXECUTION),
        ]
    };
    groups.into_iter().filter(|(due, _)| *due).flat_map(|(_, names)| names.split_whitespace())
}

const FMI2: &str = "fmi2GetTypesPlatform fmi2GetVersion fmi2SetDebugLogging fmi2Instantiate fmi2FreeInstance
    fmi2SetupExperiment fmi2EnterInitializationMode fmi2ExitInitializationMode fmi2Terminate fmi2Reset fmi2GetReal
    fmi2GetInteger fmi2GetBoolean fmi2GetString fmi2SetReal fmi2SetInteger fmi2SetBoolean fmi2SetString
    fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate fmi2SerializedFMUstateSize fmi2SerializeFMUstate
    fmi2DeSerializeFMUstate fmi2GetDirectionalDerivative";

const FMI2_MODEL_EXCHANGE: &str = "fmi2EnterEventMode fmi2NewDiscreteStates fmi2EnterContinuousTimeMode
    fmi2CompletedIntegratorStep fmi2SetTime fmi2SetContinuousStates fmi2GetDerivatives fmi2GetEventIndicators
    fmi2GetContinuousStates fmi2GetNominalsOfContinuousStates";

const FMI2_CO_SIMULATION: &str = "fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives fmi2DoStep fmi2CancelStep
    fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus fmi2GetStringStatus";

const FMI3: &str =
    "fmi3GetVersion fmi3SetDebugLogging fmi3FreeInstance fmi3EnterInitializationMode fmi3ExitInitializationMode
    fmi3EnterEventMode fmi3Terminate fmi3Reset fmi3GetFloat32 fmi3GetFloat64 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16
    fmi3GetUInt16 fmi3GetInt32 fmi3GetUInt32 fmi3GetInt64 fmi3GetUInt64 fmi3GetBoolean fmi3GetString fmi3GetBinary
    fmi3GetClock fmi3SetFloat32 fmi3SetFloat64 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32
    fmi3SetUInt32 fmi3SetInt64 fmi3SetUInt64 fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetFMUState fmi3SetFMUState
    fmi3FreeFMUState fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
    fmi3GetDirectionalDerivative fmi3GetAdjointDerivative fmi3EnterConfigurationMode fmi3ExitConfigurationMode
    fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction
    fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates";

const FMI3_MODEL_EXCHANGE: &str =
    "fmi3InstantiateModelExchange fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime
    fmi3SetContinuousStates fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3GetContinuousStates
    fmi3GetNominalsOfContinuousStates fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates";

const FMI3_CO_SIMULATION: &str = "fmi3InstantiateCoSimulation fmi3EnterStepMode fmi3GetOutputDerivatives fmi3DoStep";

const FMI3_SCHEDULED_EXECUTION: &str = "fmi3InstantiateScheduledExecution fmi3ActivateModelPartition";
