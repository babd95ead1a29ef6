//! `toolroom effects`, and effects of users in files of their own.

use crate::args::EffectsArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::PathBuf;
use toolroom_effects::Definition;
use toolroom_gap_report::{catalogue_json, catalogue_text, vocabulary_json, vocabulary_text};
use toolroom_gap_study::{UserEffectsError, user_effects};

pub fn run(args: &EffectsArgs, voice: &Voice) -> Result<(), Failure> {
    let defined = defined(&args.effects)?;
    match (args.context, voice.json) {
        (true, true) => return voice.json(&vocabulary_json()),
        (true, false) => return voice.data(vocabulary_text().trim_end()),
        (false, true) => return voice.json(&catalogue_json(&defined)),
        (false, false) => voice.data(catalogue_text(&defined))?,
    }
    voice.say("\nswitch one on in a tool: effects = [{ id = \"wear_force\", size = 0.2 }]");
    Ok(())
}

/// Effects that the files of `--effects` define.
pub fn defined(files: &[PathBuf]) -> Result<Vec<&'static Definition>, Failure> {
    user_effects(files).map_err(|error| {
        if let UserEffectsError::Read(error) = error { error.into() } else { Failure::argument(&error, error.fix()) }
    })
}
