//! `toolroom calibrate --bake`: a parameter set from the set of a scenario's tool and what the scenario moves in it.

use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use toolroom_apply::{BakeError, Baked, bake};
use toolroom_output::Files;

/// Writes the set of `tool` of the scenario `path` with the values that the scenario states or calibrates everywhere.
pub fn run(path: &Path, tool: &str, out: &Path, voice: &Voice) -> Result<(), Failure> {
    let file = toolroom_scenario_file::read(path, &[])?;
    let files = Files::new(file.files.iter().map(AsRef::as_ref).chain([path]), voice.force);
    let scenario = file.scenario;
    let place = path.display();
    let folder = path.parent().unwrap_or(Path::new(""));
    let Baked { mut set, moved, left_out } =
        bake(&scenario, tool, &place.to_string(), folder).map_err(|error| match error {
            BakeError::Set(error) => Failure::located(error, "mend the set of the tool"),
            BakeError::Tool { .. } | BakeError::Process(_) | BakeError::Nothing(_) => {
                let fix = error.fix();
                Failure::of_file(path, error, fix)
            }
        })?;
    set.name = out.file_stem().map_or_else(|| "baked".into(), |stem| stem.to_string_lossy().into_owned());
    set.title = format!("{}, as {place} calibrates it", set.title);
    files.check(out)?;
    files.put(out, set.to_toml().as_bytes())?;
    if voice.json {
        return voice
            .json(&json!({ "schema": 1, "out": out.display().to_string(), "moved": moved, "left_out": left_out }));
    }
    moved.iter().try_for_each(|line| voice.data(line))?;
    left_out.iter().for_each(|line| voice.say(format_args!("left out, no value of this set everywhere: {line}")));
    voice.say(format_args!("wrote {}; leave the baked entries out of the scenario that uses it", out.display()));
    Ok(())
}
