//! `toolroom import mtconnect`.

use crate::args::MtconnectArgs;
use crate::failure::Failure;
use crate::program;
use crate::speak::Voice;
use serde_json::json;
use std::fs;
use std::path::Path;
use std::time::Instant;
use toolroom_drives::Drives;
use toolroom_output::{OutputDir, provenance};
use toolroom_process::unit;
use toolroom_program::{Control, Program, Units};
use toolroom_records::mtconnect::{
    Role, RoleError, Run, Session, Untimed, events, parse_shdr, runs, sessions, stretches, summary, whole,
};
use toolroom_records::{Records, write_csv};

pub fn run(args: &MtconnectArgs, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let read = args.files.iter().chain(&args.nc).map(AsRef::as_ref);
    let output_dir = OutputDir::create(&args.out, &["events.csv", "runs.csv", "stretches.csv"], read, voice.force)?;
    let chosen: Vec<(Role, String)> =
        args.key.iter().map(|text| Role::assigned(text)).collect::<Result<_, _>>().map_err(refused)?;
    let mut inputs: Vec<(String, Vec<u8>)> = Vec::new();
    let mut all: Vec<Session> = Vec::new();
    for file in &args.files {
        let name = file.display().to_string();
        let bytes = fs::read(file).map_err(Failure::unread(file))?;
        let lines = parse_shdr(&String::from_utf8_lossy(&bytes));
        if lines.entries.is_empty() {
            let wrong = format!("no line of {} is time|key|value", lines.count);
            return Err(Failure::of_file(file, wrong, "give logs of an adapter in the SHDR format"));
        }
        let of_file = sessions(&args.machine, &lines, &chosen);
        voice.say(summary(&name, &lines, &of_file));
        all.extend(of_file);
        inputs.push((name, bytes));
    }
    if all.iter().all(|session| !session.keys.contains_key(&Role::Execution)) {
        let keys: Vec<&str> = all.iter().flat_map(Session::unused).take(12).collect();
        let message = format!("no key tells the execution state; keys are {}, …", keys.join(", "));
        return Err(Failure::argument(message, "name it with --key execution=KEY"));
    }
    let found: Vec<Run> = all.iter().flat_map(|session| runs(session, args.program.as_deref())).collect();
    let records = events(&all, &found);
    let complete = whole(&found);
    voice.say(format_args!("{} runs of programs, {} completed", found.len(), complete.len()));
    let stretches = args.nc.as_deref().map(|nc| timed(args, nc, &found, voice)).transpose()?;
    put(&output_dir, "events.csv", &records)?;
    put(&output_dir, "runs.csv", &complete)?;
    if let Some(stretches) = &stretches {
        put(&output_dir, "stretches.csv", stretches)?;
    }
    let inputs: Vec<(String, &[u8])> = inputs.iter().map(|(name, bytes)| (name.clone(), bytes.as_slice())).collect();
    let mut options = vec!["--machine".to_owned(), args.machine.clone()];
    options.extend(args.key.iter().flat_map(|text| ["--key".to_owned(), text.clone()]));
    options.extend(args.program.iter().flat_map(|name| ["--program".to_owned(), name.clone()]));
    options.extend(args.nc.iter().flat_map(|nc| ["--nc".to_owned(), nc.display().to_string()]));
    output_dir.record(&provenance("import mtconnect", &inputs, options, None), start.elapsed())?;
    let target = output_dir.publish()?;
    let summary = json!({
        "schema": 1, "events": records.len(), "sessions": all.len(), "runs": found.len(), "completed": complete.len(),
        "stretches": stretches.as_ref().map(Records::len), "out": target.display().to_string(),
    });
    if voice.json {
        return voice.json(&summary);
    }
    let timed = stretches.map_or(String::new(), |stretches| format!(", {} timed stretches", stretches.len()));
    voice.data(format_args!("{} events of {} sessions{timed} in {}", records.len(), all.len(), target.display()))
}

fn put(output_dir: &OutputDir, name: &str, records: &Records) -> Result<(), Failure> {
    let mut csv = Vec::new();
    write_csv(records, &mut csv).map_err(|error| Failure::work_error(&error))?;
    Ok(output_dir.put(name, &String::from_utf8_lossy(&csv))?)
}

/// Stretches of the part program in every run of it; runs that are left out are reported.
fn timed(args: &MtconnectArgs, nc: &Path, found: &[Run], voice: &Voice) -> Result<Records, Failure> {
    let name = nc.display().to_string();
    let text = program::read(nc)?;
    let control = Control::of_file(nc, args.units.as_deref().and_then(Units::named));
    let program = Program::read(&text, &control).map_err(|error| program::refused(nc, &error))?;
    let least = unit::quantity(&args.stretch, "s")
        .map_err(|error| Failure::argument(format!("--stretch: {error}"), "write --stretch \"10 s\""))?;
    let list: Vec<&Run> = found.iter().collect();
    let (records, untimed) = stretches(&list, &program, least, Drives::default().rapid_speed);
    for Untimed { run, reason } in &untimed {
        voice.say(format_args!("  {run} left out: {reason}"));
    }
    if records.is_empty() {
        let message =
            format!("no run of {name} was timed: {}", untimed.first().map_or("there is none", |one| &one.reason));
        return Err(Failure::argument(message, "give the part program that ran, with all its lines"));
    }
    Ok(records)
}

fn refused(error: RoleError) -> Failure {
    let fix = error.fix();
    Failure::argument(error, fix)
}
