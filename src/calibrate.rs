//! `toolroom calibrate`: a parameter set from what a shop knows.

mod bake;
mod data;
mod decision;

use crate::args::CalibrateArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_calibrate::{DrawnTable, Process};
use toolroom_output::Files;
use toolroom_wear::{EDGE_SCATTER, EDGE_SCATTER_DEVIATION, FirstSet, KnownLife, ParameterSet, TURNING_SETS};

/// Flank wear at which an edge is spent where nothing else is said (ISO 3685, even wear).
const LIMIT: &str = "0.3 mm";

pub fn run(args: &CalibrateArgs, voice: &Voice) -> Result<(), Failure> {
    if let (Some(scenario), Some(tool)) = (&args.bake, &args.tool) {
        return bake::run(scenario, tool, &args.out, voice);
    }
    let process =
        if args.process.as_deref() == Some(Process::Milling.name()) { Process::Milling } else { Process::Turning };
    if let Some(records) = &args.measured.data {
        return data::run(&args.measured, process, records, &args.out, args.limit.as_deref(), voice);
    }
    if process == Process::Milling {
        let reason = "--life states a life of turning; milling is calibrated on --data";
        return Err(Failure::argument(reason, "give --data, or state the group `life` of a parameter set"));
    }
    let (Some(life), Some(cut)) = (&args.life, &args.at) else {
        return Err(Failure::argument("neither --life with --at nor --data is given", "toolroom calibrate --help"));
    };
    let first = FirstSet::read(&KnownLife {
        life,
        cutting_speed: cut,
        feed: &args.feed,
        depth_of_cut: &args.depth,
        wear_limit: args.limit.as_deref().unwrap_or(LIMIT),
        tool_material: &args.tool_material,
        iso513: &args.material,
    })
    .map_err(|error| Failure::argument(&error, error.fix()))?;
    let name = args.out.file_stem().map_or_else(|| "first".into(), |stem| stem.to_string_lossy().into_owned());
    let files = Files::new([], voice.force);
    let draws = args.out.with_file_name(format!("{name}-posterior.parquet"));
    files.check(&args.out)?;
    files.check(&draws)?;
    if let Some(folder) = args.out.parent() {
        std::fs::create_dir_all(folder).map_err(|source| Failure::Unwritable { path: folder.to_owned(), source })?;
    }
    let text = first.to_toml(&name);
    files.put(&args.out, text.as_bytes())?;
    // What one life leaves open, for scenarios that name the draws.
    let set = ParameterSet::parse(&args.out.display().to_string(), &text, &TURNING_SETS)
        .map_err(|error| Failure::work_error(&error))?;
    let (count, seed) = (args.measured.draws, args.measured.seed);
    data::write_draws(
        &files,
        &draws,
        &DrawnTable::of_prior(&set, (EDGE_SCATTER, EDGE_SCATTER_DEVIATION), count, seed),
    )?;
    if voice.json {
        return voice.json(&first.json(&args.out));
    }
    voice.data(first.text())?;
    voice.say(format_args!("draws of what is left open: {} (parameters_from of a tool)", draws.display()));
    voice.say(format_args!("next: toolroom check {}", args.out.display()));
    Ok(())
}
