//! `toolroom program`: the nominal cycle time of a part program.

use crate::args::ProgramArgs;
use crate::failure::Failure;
use crate::output::Files;
use crate::speak::Voice;
use std::fs;
use std::path::Path;
use toolroom_planning::program::CycleTime;
use toolroom_process::{AnyRecord, Record, unit};
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
    let mut control = control(&args.file, args.units.as_deref());
    control.dialect = args.dialect.as_deref().and_then(Dialect::named);
    control.steps = args.steps;
    for number in &args.skip {
        control.skip[usize::from(*number)] = true;
    }
    if let Some(text) = &args.start {
        control.start = start(text)?;
    }
    for text in &args.tool {
        let (number, diameter) = diameter(text)?;
        control.diameters.insert(number, diameter);
    }
    let drives = drives(&args.set, &mut control)?;
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

/// The control of a program in a file: its subprograms stand beside it.
pub fn control(file: &Path, units: Option<&str>) -> Control {
    let folder = file.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    Control {
        units: units.and_then(Units::named),
        extension: file.extension().map(|extension| extension.to_string_lossy().into_owned()),
        library: folder.map(Path::to_path_buf),
        ..Control::default()
    }
}

/// `0,0,100 mm`.
fn start(text: &str) -> Result<[Option<f64>; 9], Failure> {
    let fault = |error: String| Failure::argument(format!("--start {text}: {error}"), "write --start \"0,0,100 mm\"");
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, z] = parts[..] else { return Err(fault("three coordinates are needed".to_owned())) };
    let (_, word) = z.split_once(' ').ok_or_else(|| fault("the unit is missing".to_owned()))?;
    let mut places = [Some(0.0); 9];
    for (slot, part) in places.iter_mut().zip([x, y, z]) {
        let whole = if part.contains(' ') { part.to_owned() } else { format!("{part} {word}") };
        *slot = Some(1e3 * unit::quantity(&whole, "m").map_err(|error| fault(error.to_string()))?);
    }
    Ok(places)
}

/// `D1=10 mm`: number, mm.
fn diameter(text: &str) -> Result<(u32, f64), Failure> {
    let fault = |error: String| Failure::argument(format!("--tool {text}: {error}"), "write --tool D1=\"10 mm\"");
    let (number, value) = text.split_once('=').ok_or_else(|| fault("the diameter is missing".to_owned()))?;
    let number = number.trim_start_matches(['D', 'T']).parse().map_err(|_| fault(format!("{number} is no tool")))?;
    let diameter = 1e3 * unit::quantity(value, "m").map_err(|error| fault(error.to_string()))?;
    if (0.0..=1e3).contains(&diameter) {
        Ok((number, diameter))
    } else {
        Err(fault("0 to 1000 mm is possible".to_owned()))
    }
}

/// Drives with the values of `--set`; those of the control go there.
fn drives(set: &[String], control: &mut Control) -> Result<Drives, Failure> {
    let mut drives = Drives::<f64>::default();
    let names = || Drives::<f64>::FIELDS.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
    for text in set {
        let (key, value) = text.split_once('=').unwrap_or((text, ""));
        if let Some(key) = key.strip_prefix("control.") {
            let value = value.trim_matches('"');
            control.set(key, value).map_err(|error| {
                Failure::argument(format!("--set {text}: {error}"), format!("there are {}", Control::KEYS))
            })?;
            continue;
        }
        let index = Drives::<f64>::index_of(key).ok_or_else(|| {
            Failure::argument(format!("--set {text}: no value `{key}`"), format!("there are {}, control.…", names()))
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
