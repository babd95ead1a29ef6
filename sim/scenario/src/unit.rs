//! Imported units: what the shop asks of whoever can load them.

use std::path::Path;
use std::sync::{Arc, OnceLock};
use toolroom_process::{Field, MachineProcess, Wiring};

/// A unit that is to stand in for a native process.
#[derive(Clone, Copy, Debug)]
pub struct UnitRequest<'a> {
    /// The file.
    pub path: &'a Path,
    /// Name of the process that it replaces.
    pub process: &'static str,
    /// Inputs of that process.
    pub inputs: &'static [Field],
    /// Outputs of that process.
    pub outputs: &'static [Field],
    /// Which variable stands for which quantity.
    pub wiring: &'a Wiring,
}

/// Why a unit cannot stand in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitRefusal {
    /// What is wrong.
    pub reason: String,
    /// What the user may do about it.
    pub fix: String,
}

/// Loads units; answers with what is wrong where it cannot.
pub type Importer = fn(&UnitRequest<'_>) -> Result<Arc<dyn MachineProcess>, UnitRefusal>;

static IMPORTER: OnceLock<Importer> = OnceLock::new();

/// Names the importer of units for this program; the first one stays. This crate loads no foreign
/// code itself.
pub fn set_importer(importer: Importer) {
    let _ = IMPORTER.set(importer);
}

/// Loads a unit.
///
/// # Errors
/// What the importer says, or that there is none.
pub fn import_unit(request: &UnitRequest<'_>) -> Result<Arc<dyn MachineProcess>, UnitRefusal> {
    let Some(importer) = IMPORTER.get() else {
        return Err(UnitRefusal {
            reason: "this program was built without the import of units".to_owned(),
            fix: "build it with `cargo build --release --features fmu-import`; docs/guide/fmu-import.md says what \
                  that needs"
                .to_owned(),
        });
    };
    importer(request)
}
