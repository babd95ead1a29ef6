//! `toolroom program`: the nominal cycle time of a part program.

use crate::args::ProgramArgs;
use crate::failure::Failure;
use crate::output::Files;
use crate::speak::Voice;
use std::fs;
use toolroom_contour::{Drives, Program, Units};
use toolroom_planning::program::CycleTime;
use toolroom_process::{AnyRecord, Record, unit};

/// What a refused program is about.
pub const REFUSED: &str = "a word that is not followed could move an axis or take time, so none is passed over";

pub fn run(args: &ProgramArgs, voice: &Voice) -> Result<(), Failure> {
    let name = args.file.display().to_string();
    let text = fs::read_to_string(&args.file)
        .map_err(|error| Failure::argument(format!("{name}: {error}"), "check the path"))?;
    let files = Files::new([args.file.as_path()], voice.force);
    args.blocks.as_ref().map_or(Ok(()), |path| files.check(path))?;
    let drives = drives(&args.set)?;
    let program = Program::read_in(&text, args.units.as_deref().and_then(Units::named))
        .map_err(|error| Failure::argument(format!("{name}: {error}"), REFUSED))?;
    let cycle = CycleTime::new(program, drives);
    if let Some(path) = &args.blocks {
        files.put(path, cycle.table().as_bytes())?;
        voice.say(format_args!("wrote {}", path.display()));
    }
    if let [first, ..] = cycle.unknown() {
        let count = cycle.unknown().len();
        voice.say(format_args!(
            "{count} blocks move axes from places that only the machine knows (first: line {first}); those axes count as standing"
        ));
    }
    if voice.json { voice.json(&cycle.json()) } else { voice.data(cycle.text()) }
}

/// Drives with the values of `--set`.
fn drives(set: &[String]) -> Result<Drives, Failure> {
    let mut drives = Drives::<f64>::default();
    let names = || Drives::<f64>::FIELDS.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
    for text in set {
        let (key, value) = text.split_once('=').unwrap_or((text, ""));
        let index = Drives::<f64>::index_of(key).ok_or_else(|| {
            Failure::argument(format!("--set {text}: no value `{key}`"), format!("there are {}", names()))
        })?;
        let field = &Drives::<f64>::FIELDS[index];
        let number = unit::quantity(value, field.unit).map_err(|error| {
            Failure::argument(format!("--set {text}: {error}"), format!("write {key}=\"1 {}\"", field.display))
        })?;
        drives.set_value(index, number);
    }
    drives.check().map_err(|error| Failure::argument(error, "see the ranges in the documentation of Drives"))?;
    Ok(drives)
}
