//! `toolroom effects`.

use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_gap_report::{catalogue_json, catalogue_text};

pub fn run(voice: &Voice) -> Result<(), Failure> {
    if voice.json {
        return voice.json(&catalogue_json());
    }
    voice.data(catalogue_text())?;
    voice.say("\nswitch one on in a tool: effects = [{ id = \"wear_force\", size = 0.2 }]");
    Ok(())
}
