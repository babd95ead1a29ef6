//! `toolroom schema`.

use crate::args::{FileKind, SchemaArgs};
use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_life::file::STUDY;
use toolroom_scenario::file::{SCENARIO, schema};
use toolroom_scenario::lobes::LOBES;

/// Of a file that is written, not read.
const DIAGNOSIS: &str = include_str!("../scenarios/schema/diagnosis.schema.json");

pub fn run(args: &SchemaArgs, voice: &Voice) -> Result<(), Failure> {
    let schema = match args.kind {
        FileKind::Scenario => schema(&SCENARIO, "toolroom scenario"),
        FileKind::Lobes => schema(&LOBES, "toolroom lobes file"),
        FileKind::Life => schema(&STUDY, "toolroom tool-life study"),
        FileKind::Diagnosis => serde_json::from_str(DIAGNOSIS).map_err(Failure::Json)?,
    };
    voice.json(&schema)
}
