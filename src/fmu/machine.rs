//! Units as machines of the shop: the importer that scenario files call.

use std::sync::Arc;
use toolroom_fmu_import::{Unit, UnitProcess};
use toolroom_process::MachineProcess;
use toolroom_sim::scenario::{UnitRequest, set_importer};

/// Makes `fmu = "…"` in scenarios work.
pub fn register() {
    set_importer(import);
}

fn import(request: &UnitRequest<'_>) -> Result<Arc<dyn MachineProcess>, String> {
    let unit = Unit::load(request.path).map_err(|error| error.to_string())?;
    let process = UnitProcess::new(Arc::new(unit), request.process, request.inputs, request.outputs, request.wiring);
    Ok(Arc::new(process.map_err(|error| error.to_string())?))
}
