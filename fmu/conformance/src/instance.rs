//! Units of either version of FMI in `fmi-rs`, for Co-Simulation.

use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{CS, FMU2, builder::FMU2Builder};
use fmi_rs::fmi3::types::fmi3Status;
use fmi_rs::fmi3::{FMU3, builder::FMU3Builder};
use fmi_rs::model_description::{FMIMajorVersion, peek_fmi_major_version};
use fmi_rs::zip::extract_zip_archive;
use std::ffi::c_void;
use std::fmt::Display;
use std::ptr::null_mut;
use std::sync::Arc;
use tempfile::TempDir;

/// Why an action has no result.
pub struct Failed(pub String);

impl Failed {
    fn from_display(error: impl Display) -> Self {
        Self(error.to_string())
    }
}

/// A unit, unpacked and read.
pub enum Unit {
    /// FMI 2.0.
    Two(FMU2Builder),
    /// FMI 3.0.
    Three(FMU3Builder),
}

impl Unit {
    /// Unpacks and reads the unit in `file`.
    pub fn open(file: &str) -> Result<Self, Failed> {
        let folder = TempDir::new().map_err(Failed::from_display)?;
        extract_zip_archive(file, folder.path()).map_err(Failed::from_display)?;
        match peek_fmi_major_version(&folder.path().join("modelDescription.xml")).map_err(Failed::from_display)? {
            FMIMajorVersion::V2 => FMU2Builder::new(&file).map(Self::Two).map_err(Failed::from_display),
            FMIMajorVersion::V3 => {
                let mut builder = FMU3Builder::new(&file).map_err(Failed::from_display)?;
                // Units without Event Mode may refuse to be asked for it.
                (builder.eventModeUsed, builder.earlyReturnAllowed) = (false, false);
                Ok(Self::Three(builder))
            }
        }
    }

    /// What `fmi-rs` finds wrong with the description.
    pub fn problems(&self) -> Vec<String> {
        let problems = match self {
            Self::Two(builder) => builder.model_description.validate(),
            Self::Three(builder) => builder.model_description.validate(),
        };
        problems.into_iter().map(|problem| problem.message).collect()
    }

    /// Whether states can be saved.
    pub fn saves(&self) -> bool {
        match self {
            Self::Two(builder) => {
                builder.model_description.coSimulation.as_ref().is_some_and(|each| each.canGetAndSetFMUstate)
            }
            Self::Three(builder) => {
                builder.model_description.coSimulation.as_ref().is_some_and(|each| each.canGetAndSetFMUState)
            }
        }
    }

    /// An initialised instance of which `output` is read.
    pub fn instance(&self, output: &str) -> Result<Instance, Failed> {
        let (calls, reference) = match self {
            Self::Two(builder) => {
                let reference =
                    builder.model_description.variable_by_name(output).map_err(Failed::from_display)?.valueReference;
                let unit = builder.instantiate_cs("unit").map_err(Failed::from_display)?;
                ok2("fmi2SetupExperiment", unit.setupExperiment(None, 0.0, None))?;
                ok2("fmi2EnterInitializationMode", unit.enterInitializationMode())?;
                ok2("fmi2ExitInitializationMode", unit.exitInitializationMode())?;
                (Calls::Two(unit), reference)
            }
            Self::Three(builder) => {
                let reference =
                    builder.model_description.variable_by_name(output).map_err(Failed::from_display)?.valueReference;
                let unit = builder.instantiate_cs("unit").map_err(Failed::from_display)?;
                ok3("fmi3EnterInitializationMode", unit.enterInitializationMode(None, 0.0, None))?;
                ok3("fmi3ExitInitializationMode", unit.exitInitializationMode())?;
                (Calls::Three(unit), reference)
            }
        };
        Ok(Instance { calls, reference, state: null_mut() })
    }
}

/// An instance in step mode and the one output that is read from it.
pub struct Instance {
    calls: Calls,
    reference: u32,
    /// What the unit was saved to; saved to again, as importers do.
    state: *mut c_void,
}

enum Calls {
    Two(Arc<FMU2<CS>>),
    Three(Arc<FMU3>),
}

impl Instance {
    /// One communication step.
    pub fn step(&mut self, time: f64, length: f64) -> Result<(), Failed> {
        match &self.calls {
            Calls::Two(unit) => ok2("fmi2DoStep", unit.doStep(time, length, 1)),
            Calls::Three(unit) => {
                let (mut event, mut end, mut early, mut reached) = (false, false, false, 0.0);
                let status = unit.doStep(time, length, true, &mut event, &mut end, &mut early, &mut reached);
                ok3("fmi3DoStep", status)
            }
        }
    }

    /// The output.
    pub fn output(&self) -> Result<f64, Failed> {
        let mut value = [0.0];
        match &self.calls {
            Calls::Two(unit) => ok2("fmi2GetReal", unit.getReal(&[self.reference], &mut value))?,
            Calls::Three(unit) => ok3("fmi3GetFloat64", unit.getFloat64(&[self.reference], &mut value))?,
        }
        Ok(value[0])
    }

    /// Saves the state, over the one that was saved before.
    pub fn save(&mut self) -> Result<(), Failed> {
        match &self.calls {
            Calls::Two(unit) => ok2("fmi2GetFMUstate", unit.getFMUstate(&mut self.state)),
            Calls::Three(unit) => ok3("fmi3GetFMUState", unit.getFMUState(&mut self.state)),
        }
    }

    /// The state as bytes.
    pub fn bytes(&mut self) -> Result<Vec<u8>, Failed> {
        self.save()?;
        let mut size = 0;
        match &self.calls {
            Calls::Two(unit) => {
                ok2("fmi2SerializedFMUstateSize", unit.serializedFMUstateSize(self.state, &mut size))?;
                let mut bytes = vec![0; size];
                ok2("fmi2SerializeFMUstate", unit.serializeFMUstate(self.state, &mut bytes))?;
                Ok(bytes.into_iter().map(|byte| byte as u8).collect())
            }
            Calls::Three(unit) => {
                ok3("fmi3SerializedFMUStateSize", unit.serializedFMUStateSize(self.state, &mut size))?;
                let mut bytes = vec![0; size];
                ok3("fmi3SerializeFMUState", unit.serializeFMUState(self.state, &mut bytes))?;
                Ok(bytes)
            }
        }
    }

    /// Goes to a state in bytes, of this instance or another.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Failed> {
        match &self.calls {
            Calls::Two(unit) => {
                let bytes: Vec<_> = bytes.iter().map(|byte| *byte as _).collect();
                ok2("fmi2DeSerializeFMUstate", unit.deSerializeFMUstate(&bytes, &mut self.state))?;
                ok2("fmi2SetFMUstate", unit.setFMUstate(self.state))
            }
            Calls::Three(unit) => {
                ok3("fmi3DeserializeFMUState", unit.deserializeFMUState(bytes, &mut self.state))?;
                ok3("fmi3SetFMUState", unit.setFMUState(self.state))
            }
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if self.state.is_null() {
            return;
        }
        // The unit goes next; what it says to this changes nothing.
        match &self.calls {
            Calls::Two(unit) => drop(unit.freeFMUstate(&mut self.state)),
            Calls::Three(unit) => drop(unit.freeFMUState(&mut self.state)),
        }
    }
}

fn ok2(call: &str, status: fmi2Status) -> Result<(), Failed> {
    if status == fmi2Status::Ok { Ok(()) } else { Err(Failed(format!("{call}: {status:?}"))) }
}

fn ok3(call: &str, status: fmi3Status) -> Result<(), Failed> {
    if status == fmi3Status::Ok { Ok(()) } else { Err(Failed(format!("{call}: {status:?}"))) }
}
