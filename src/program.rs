//! `toolroom program`: the nominal cycle time of a part program.

use crate::args::ProgramArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::fs;
use std::path::Path;
use toolroom_drives::Machine;
use toolroom_output::Files;
use toolroom_planning::engagement::Engagement;
use toolroom_planning::explain::Explanation;
use toolroom_planning::program::{CycleTime, set_drive};
use toolroom_post::post;
use toolroom_program::{Dialect, ProgramError, Source, Units};
use toolroom_stock::Setup;

/// What a refused program is about.
pub const REFUSED: &str = "a word that is not followed could move an axis or take time, so none is passed over";

pub fn run(args: &ProgramArgs, voice: &Voice) -> Result<(), Failure> {
    let name = args.file.display().to_string();
    let text = open(&args.file)?;
    let files = Files::new([args.file.as_path()], voice.force);
    for path in args.blocks.iter().chain(&args.out).chain(&args.motions) {
        files.check(path)?;
    }
    let setup = args.setup.as_deref().map(|path| Setup::read(path, &[])).transpose()?.map(|file| file.content);
    let units = args.units.as_deref().and_then(Units::named);
    let named = setup.as_ref().zip(args.setup.as_deref()).and_then(|(setup, file)| setup.machine_file(file));
    let Machine { control, mut drives } = machine(args.drives.as_deref().or(named.as_deref()), &args.set)?;
    let mut control = control.for_file(&args.file, units);
    control.dialect = args.dialect.as_deref().and_then(Dialect::named);
    control.steps = args.steps;
    for number in &args.skip {
        control.skip[usize::from(*number)] = true;
    }
    if let Some(text) = &args.start {
        let fault = |error| Failure::argument(format!("--start {text}: {error}"), "write --start \"0,0,100 mm\"");
        control.set_start(text).map_err(fault)?;
    }
    for (number, tool) in setup.iter().flat_map(|setup| &setup.tools) {
        control.diameters.insert(*number, 2e3 * tool.radius);
    }
    for text in &args.tool {
        let fault = |error| Failure::argument(format!("--tool {text}: {error}"), "write --tool D1=\"10 mm\"");
        control.set_tool(text).map_err(fault)?;
    }
    for text in args.set.iter().filter(|text| !text.starts_with(FILE)) {
        set_drive(&mut drives, &mut control, text)
            .map_err(|error| Failure::argument(format!("--set {text}: {error}"), error.fix()))?;
    }
    let cycle = CycleTime::new(text.clone(), &control, &drives, args.blocks.is_some())
        .map_err(|error| refused(&name, &error))?;
    let explanation = args
        .explain
        .map(|line| Explanation::new(&text, &control, &drives, line as usize))
        .transpose()
        .map_err(|error| refused(&name, &error))?;
    let engagement = setup
        .map(|setup| Engagement::new(text.clone(), &control, &setup, args.motions.is_some()))
        .transpose()
        .map_err(|error| Failure::argument(format!("{name}:{error}"), REFUSED))?;
    if let (Some(path), Some(engagement)) = (&args.motions, &engagement) {
        files.put(path, engagement.table().as_bytes())?;
        voice.say(format_args!("wrote {}", path.display()));
    }
    if let Some(path) = &args.blocks {
        files.put(path, cycle.table().as_bytes())?;
        voice.say(format_args!("wrote {}", path.display()));
    }
    if let (Some(target), Some(path)) = (args.post.as_deref().and_then(Dialect::named), &args.out) {
        let written = post(text, &control, target).map_err(|error| refused(&name, &error))?;
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
    if voice.json {
        let mut result = cycle.json();
        if let Some(engagement) = &engagement {
            result["engagement"] = engagement.json();
        }
        if let Some(explanation) = &explanation {
            result["explained"] = explanation.json();
        }
        voice.json(&result)?;
    } else {
        voice.data(cycle.text())?;
        if let Some(engagement) = &engagement {
            voice.data(engagement.text())?;
        }
        if let Some(explanation) = &explanation {
            voice.data(explanation.text())?;
        }
    }
    let crash = engagement.as_ref().and_then(|engagement| engagement.crashes().first()).filter(|_| args.strict);
    crash.map_or(Ok(()), |line| Err(Failure::Work { message: format!("{name}:{line}: a rapid motion meets material") }))
}

/// A refused program, with all words of it that are refused.
fn refused(name: &str, error: &ProgramError) -> Failure {
    let list: Vec<String> = error.all().map(|one| format!("{name}:{one}")).collect();
    Failure::argument(list.join("\n"), REFUSED)
}

/// How a change of a machine file begins.
const FILE: &str = "drives.";

/// The machine of `--drives`, a file or a preset, with the changes of `--set` that begin with `drives.`.
fn machine(path: Option<&Path>, set: &[String]) -> Result<Machine, Failure> {
    let set: Vec<String> = set.iter().filter(|text| text.starts_with(FILE)).cloned().collect();
    let file = match path {
        Some(path) => Machine::read(path, &set),
        None => Machine::of("--set", "", &set),
    };
    Ok(file?.content)
}

/// A part program, which stays in its file: it may have millions of lines.
fn open(file: &Path) -> Result<Source, Failure> {
    Source::open(file).map_err(|error| Failure::argument(format!("{}: {error}", file.display()), "check the path"))
}

/// The text of a part program; controls write other encodings than UTF-8 in comments.
pub fn read(file: &Path) -> Result<String, Failure> {
    let name = file.display();
    let bytes = fs::read(file).map_err(|error| Failure::argument(format!("{name}: {error}"), "check the path"))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
