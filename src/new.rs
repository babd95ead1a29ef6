//! `toolroom new DIR`.

use crate::args::NewArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::fs;
use std::path::Path;

/// The commented scenario that users start from.
const SCENARIO: &str = include_str!("../scenarios/template.toml");
/// Its schema, for editors.
const SCHEMA: &str = include_str!("../scenarios/schema/scenario.schema.json");

pub fn run(args: &NewArgs, voice: &Voice) -> Result<(), Failure> {
    let scenario = args.dir.join("scenario.toml");
    if scenario.exists() {
        let message = format!("{} is there already", scenario.display());
        return Err(Failure::argument(message, "choose another directory; nothing was changed"));
    }
    let schema = args.dir.join("scenario.schema.json");
    if !voice.force && fs::read(&schema).is_ok_and(|there| there != SCHEMA.as_bytes()) {
        let message = format!("{} is there already and is another one", schema.display());
        return Err(Failure::argument(message, "choose another directory, or replace it with --force"));
    }
    let unwritable = |path: &Path| {
        let path = path.to_owned();
        |source| Failure::Unwritable { path, source }
    };
    fs::create_dir_all(&args.dir).map_err(unwritable(&args.dir))?;
    fs::write(&schema, SCHEMA).map_err(unwritable(&schema))?;
    fs::write(&scenario, SCENARIO).map_err(unwritable(&scenario))?;
    if voice.json {
        voice.json(&serde_json::json!({ "schema": 1, "scenario": scenario.display().to_string() }))?;
    }
    voice.say(format_args!(
        "wrote {0}   next: edit it, then\n  toolroom check {0}\n  toolroom compare {0}",
        scenario.display()
    ));
    Ok(())
}
