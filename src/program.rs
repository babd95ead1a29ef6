//! `toolroom program`: the nominal cycle time of part programs.

use crate::args::ProgramArgs;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use std::fs;
use std::path::{Path, PathBuf};
use toolroom_chart::page::Provenance;
use toolroom_drives::{Drives, Machine};
use toolroom_location::Location;
use toolroom_output::{Files, provenance};
use toolroom_planning::feeds::FeedRequest;
use toolroom_planning::folders::programs;
use toolroom_planning::program::{
    CycleTime, ProgramOnMachine, ProgramRequest, ProgramStudy, overview_json, overview_text, report, set_drive,
};
use toolroom_post::Form;
use toolroom_program::{Control, Dialect, ProgramError, Source, Units};
use toolroom_stock::{FeedLimit, FeedObjective, FollowError, Setup};

/// What a refused program is about.
pub const REFUSED: &str = "a word that is not followed could move an axis or take time, so none is passed over";

pub fn run(args: &ProgramArgs, voice: &Voice) -> Result<(), Failure> {
    match &args.files[..] {
        [file] if !file.is_dir() => one(file, args, voice),
        given => {
            let list = programs(given).map_err(|error| Failure::argument(&error, error.fix()))?;
            many(&list, args, voice)
        }
    }
}

/// A row for each of several programs.
fn many(list: &[PathBuf], args: &ProgramArgs, voice: &Voice) -> Result<(), Failure> {
    let single = [
        ("--blocks", args.blocks.is_some()),
        ("--motions", args.motions.is_some()),
        ("--post", args.post.is_some()),
        ("--setup", args.setup.is_some()),
        ("--explain", args.explain.is_some()),
        ("--report", args.report.is_some()),
        ("--drawing", args.drawing.is_some()),
    ];
    if let Some((option, _)) = single.iter().find(|(_, given)| *given) {
        return Err(Failure::argument(format!("{option} is of one program"), "give one program"));
    }
    let (mut rows, mut unread) = (Vec::with_capacity(list.len()), Vec::new());
    let bar = Bar::of(voice, "programs");
    for file in list {
        bar.part(rows.len() as u32, list.len() as u32);
        let (control, drives) = machine_of(file, args, None)?;
        // What cannot be read is told behind the others.
        match Source::open(file) {
            Ok(text) => rows.push((file.display().to_string(), CycleTime::new(text, &control, &drives, false))),
            Err(error) => unread.push(format!("{}: {error}", file.display())),
        }
    }
    bar.finish();
    if voice.json {
        voice.json(&overview_json(&rows))?;
    } else {
        voice.data(overview_text(&rows))?;
    }
    let refusals: Vec<String> = rows
        .iter()
        .filter_map(|(name, row)| row.as_ref().err().map(|error| (name, error)))
        .flat_map(|(name, error)| error.all().map(move |one| format!("{name}:{one}")))
        .chain(unread)
        .collect();
    let first = rows.iter().find_map(|(name, row)| Some(place(Path::new(name), row.as_ref().err()?)));
    if refusals.is_empty() { Ok(()) } else { Err(Failure::argument(refusals.join("\n"), REFUSED).at(first)) }
}

/// Control and drives for a program.
fn machine_of(file: &Path, args: &ProgramArgs, setup: Option<&Setup>) -> Result<(Control, Drives), Failure> {
    let units = args.units.as_deref().and_then(Units::named);
    let named = setup.zip(args.setup.as_deref()).and_then(|(setup, file)| setup.machine_file(file));
    let Machine { control, mut drives } = machine(args.drives.as_deref().or(named.as_deref()), &args.set)?;
    let mut control = control.for_file(file, units);
    control.dialect = args.dialect.as_deref().and_then(Dialect::named);
    control.steps = args.steps;
    for number in &args.skip {
        control.skip[usize::from(*number)] = true;
    }
    if let Some(text) = &args.start {
        let fault = |error| Failure::argument(format!("--start {text}: {error}"), "write --start \"0,0,100 mm\"");
        control.set_start(text).map_err(fault)?;
    }
    if let Some(setup) = setup {
        setup.tell(&mut control);
    }
    for text in &args.tool {
        let fault = |error| Failure::argument(format!("--tool {text}: {error}"), "write --tool D1=\"10 mm\"");
        control.set_tool(text).map_err(fault)?;
    }
    for text in args.set.iter().filter(|text| !text.starts_with(FILE)) {
        set_drive(&mut drives, &mut control, text)
            .map_err(|error| Failure::argument(format!("--set {text}: {error}"), error.fix()))?;
    }
    Ok((control, drives))
}

/// All that is told of one program.
fn one(file: &Path, args: &ProgramArgs, voice: &Voice) -> Result<(), Failure> {
    let name = file.display().to_string();
    let source = Source::open(file).map_err(Failure::unread(file))?;
    let setup = args.setup.as_deref().map(|path| Setup::read(path, &[])).transpose()?;
    let named = setup.iter().flat_map(|setup| &setup.files).map(AsRef::as_ref);
    let inputs = std::iter::once(file).chain(args.setup.as_deref()).chain(args.drives.as_deref()).chain(named);
    let files = Files::new(inputs, voice.force);
    let outputs = [&args.blocks, &args.out, &args.motions, &args.report, &args.drawing];
    files.check_all(outputs.into_iter().flatten().map(PathBuf::as_path))?;
    let setup = setup.map(|file| file.content);
    let (control, drives) = machine_of(file, args, setup.as_ref())?;
    let bar = Bar::of(voice, "steps");
    let of = ProgramOnMachine { source, control, drives, setup };
    let study = ProgramStudy::new(of, &request(args), &|done, total| bar.part(done, total))
        .map_err(|error| not_followed(file, &error))?;
    let put = |path: &Path, bytes: &[u8]| -> Result<(), Failure> {
        files.put(path, bytes)?;
        voice.say(format_args!("wrote {}", path.display()));
        Ok(())
    };
    if let Some(path) = &args.motions {
        put(path, study.motions().map_err(|error| refused(file, &error))?.as_bytes())?;
    }
    if let Some(path) = &args.blocks {
        put(path, study.cycle.table().as_bytes())?;
    }
    if let Some(path) = &args.report {
        let page = report(&name, &study, origin(file, args)?).map_err(|error| not_followed(file, &error))?;
        put(path, page.html().as_bytes())?;
    }
    if let Some(path) = &args.drawing {
        put(path, study.drawing().map_err(|error| refused(file, &error))?.text().as_bytes())?;
    }
    if let (Some(dialect), Some(path)) = (args.post.as_deref().and_then(Dialect::named), &args.out) {
        let form = Form { dialect, keep_cycles: args.keep_cycles };
        let written = study.post(form).map_err(|error| refused(file, &error))?;
        put(path, written.text.as_bytes())?;
        for note in written.notes() {
            voice.say(note);
        }
    }
    bar.finish();
    say(&study.cycle, voice);
    if voice.json {
        voice.json(&study.json())?;
    } else {
        study.texts().iter().try_for_each(|text| voice.data(text))?;
    }
    match study.fault().filter(|_| args.strict) {
        Some((line, fault)) => {
            let message = format!("{name}:{line}: {fault}");
            Err(Failure::work(message).at(Some(Location::line(name, line))))
        }
        None => Ok(()),
    }
}

/// Says how a program was read.
fn say(cycle: &CycleTime, voice: &Voice) {
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
}

/// Command and input files of a report, but for the text of the setup.
fn origin(file: &Path, args: &ProgramArgs) -> Result<Provenance, Failure> {
    let bytes = fs::read(file).map_err(Failure::unread(file))?;
    Ok(provenance("program", &[(file.display().to_string(), &bytes)], args.words(), None))
}

/// What the arguments ask of a program.
fn request(args: &ProgramArgs) -> ProgramRequest {
    let limits = args.limits.iter().flatten().filter_map(|word| FeedLimit::from_word(word)).collect();
    let feeds = FeedRequest {
        objective: args.objective.as_deref().and_then(FeedObjective::from_word),
        speeds: args.speeds,
        blocks_factor: args.blocks_factor,
        limits,
    };
    ProgramRequest {
        blocks: args.blocks.is_some(),
        motions: args.motions.is_some(),
        explain: args.explain.map(|line| line as usize),
        feeds: (args.objective.is_some() || args.limits.is_some()).then_some(feeds),
    }
}

/// A refused program, with all words of it that are refused.
pub fn refused(file: &Path, error: &ProgramError) -> Failure {
    let list: Vec<String> = error.all().map(|one| format!("{}:{one}", file.display())).collect();
    Failure::argument(list.join("\n"), REFUSED).at(Some(place(file, error)))
}

/// A program that does not run in its setup.
fn not_followed(file: &Path, error: &FollowError) -> Failure {
    if let FollowError::Program(error) = error {
        return refused(file, error);
    }
    let line = if let FollowError::NoTool { line, .. } = error { Some(*line) } else { None };
    let message = format!("{}:{error}", file.display());
    Failure::argument(message, REFUSED).at(Some(Location { line, ..Location::of(file.display()) }))
}

/// Where a program is refused.
fn place(file: &Path, error: &ProgramError) -> Location {
    Location::column(file.display(), error.line, error.column)
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

/// The text of a part program; controls write other encodings than UTF-8 in comments.
pub fn read(file: &Path) -> Result<String, Failure> {
    let bytes = fs::read(file).map_err(Failure::unread(file))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
