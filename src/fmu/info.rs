//! `toolroom fmu info F.fmu`.

use super::{open, refused};
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::Path;
use toolroom_fmu_import::ModelDescription;

pub fn run(path: &Path, voice: &Voice) -> Result<(), Failure> {
    let mut archive = open(path)?;
    let reading = ModelDescription::read(&archive.description().map_err(refused)?);
    let Some(description) = reading.description else {
        let fault = reading.faults.first();
        let message = fault.map_or(String::new(), |fault| format!(":{}: {}", fault.line, fault.message));
        let wrong = format!("modelDescription.xml{message}");
        return Err(Failure::of_file(path, wrong, "`toolroom fmu check` lists everything that is wrong"));
    };
    let platforms = archive.binary_folders();
    if voice.json {
        voice.json(&description.json(path, &platforms))
    } else {
        voice.data(description.listing(&platforms))?;
        if !reading.faults.is_empty() {
            let count = reading.faults.len();
            voice.say(format_args!("{count} faults in the description; see toolroom fmu check {}", path.display()));
        }
        Ok(())
    }
}
