//! `toolroom listen RECORD`: whether the sound of a milling cut is that of chatter.

use crate::args::ListenArgs;
use crate::failure::Failure;
use crate::modes::bytes;
use crate::speak::Voice;
use std::path::Path;
use toolroom_dynamics::{Record, read_record};
use toolroom_planning::listen::{ListenRequest, ListenStudy};

pub fn run(args: &ListenArgs, voice: &Voice) -> Result<(), Failure> {
    let air = args.air.as_deref().map(record).transpose()?;
    let lobes = args.lobes.as_deref().map(|path| toolroom_planning::lobes::read(path, &[])).transpose()?;
    let request = ListenRequest { teeth: args.teeth, speed: &args.speed };
    let study =
        ListenStudy::new(&record(&args.record)?, air.as_ref(), &request, lobes.as_ref().map(|file| &file.content))
            .map_err(|error| Failure::located(error, "see docs/dynamics.md"))?;
    if voice.json { voice.json(&study.json()) } else { voice.data(study.text()) }
}

fn record(path: &Path) -> Result<Record, Failure> {
    read_record(&path.display().to_string(), &bytes(path)?, &[])
        .map_err(|error| Failure::located(error, "see docs/dynamics.md"))
}
