//! `toolroom program`: the nominal cycle time of a part program.

use crate::args::ProgramArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::fs;
use std::path::Path;
use toolroom_output::Files;
use toolroom_planning::program::{CycleTime, set_drive};
use toolroom_program::{Control, Dialect, Drives, Units, post};

/// What a refused program is about.
pub const REFUSED: &str = "a word that is not followed could move an axis or take time, so none is passed over";

pub fn run(args: &ProgramArgs, voice: &Voice) -> Result<(), Failure> {
    let name = args.file.display().to_string();
    let text = read(&args.file)?;
    let files = Files::new([args.file.as_path()], voice.force);
    for path in args.blocks.iter().chain(&args.out) {
        files.check(path)?;
    }
    let mut control = Control::of_file(&args.file, args.units.as_deref().and_then(Units::named));
    control.dialect = args.dialect.as_deref().and_then(Dialect::named);
    control.steps = args.steps;
    for number in &args.skip {
        control.skip[usize::from(*number)] = true;
    }
    if let Some(text) = &args.start {
        let fault = |error| Failure::argument(format!("--start {text}: {error}"), "write --start \"0,0,100 mm\"");
        control.set_start(text).map_err(fault)?;
    }
    for text in &args.tool {
        let fault = |error| Failure::argument(format!("--tool {text}: {error}"), "write --tool D1=\"10 mm\"");
        control.set_tool(text).map_err(fault)?;
    }
    let mut drives = Drives::default();
    for text in &args.set {
        set_drive(&mut drives, &mut control, text)
            .map_err(|error| Failure::argument(format!("--set {text}: {error}"), error.fix()))?;
    }
    let cycle = CycleTime::new(&text, &control, &drives, args.blocks.is_some())
        .map_err(|error| Failure::argument(format!("{name}:{error}"), REFUSED))?;
    if let Some(path) = &args.blocks {
        files.put(path, cycle.table().as_bytes())?;
        voice.say(format_args!("wrote {}", path.display()));
    }
    if let (Some(target), Some(path)) = (args.post.as_deref().and_then(Dialect::named), &args.out) {
        let written =
            post(&text, &control, target).map_err(|error| Failure::argument(format!("{name}:{error}"), REFUSED))?;
        files.put(path, written.text.as_bytes())?;
        voice.say(format_args!("wrote {}", path.display()));
        if let [first, ..] = written.left_out[..] {
            voice.say(format_args!(
                "{} blocks have no place in it: motions in machine coordinates, functions of the machine, exact stops (first: line {first})",
                written.left_out.len()
            ));
        }
    }
    let (dialect, reason) = cycle.dialect();
    voice.say(format_args!("read as a program for {dialect}: {reason}"));
    for (line, note) in cycle.notes() {
        voice.say(format_args!("line {line}: {note}"));
    }
    if let [first, ..] = cycle.unknown() {
        let count = cycle.unknown().len();
        voice.say(format_args!(
            "{count} blocks move axes from places that only the machine knows (first: line {first}); those axes count as standing"
        ));
    }
    if voice.json { voice.json(&cycle.json()) } else { voice.data(cycle.text()) }
}

/// The text of a part program; controls write other encodings than UTF-8 in comments.
pub fn read(file: &Path) -> Result<String, Failure> {
    let name = file.display();
    let bytes = fs::read(file).map_err(|error| Failure::argument(format!("{name}: {error}"), "check the path"))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
