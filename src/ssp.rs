//! `toolroom ssp`: systems of FMI units.

use crate::args::{SspCommand, SspExportArgs};
use crate::failure::Failure;
use crate::fmu::export::binaries;
use crate::fmu::seconds;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use toolroom_cell::{Cell, Choice, Form};
use toolroom_fmu::Version;
use toolroom_output::Files;
use toolroom_scenario_file::read;
use toolroom_ssp::{Package, SspError};

pub fn run(command: &SspCommand, voice: &Voice) -> Result<(), Failure> {
    match command {
        SspCommand::Export(args) => export(args, voice),
        SspCommand::Info(args) => {
            let package = open(&args.file)?;
            if voice.json { voice.json(&package.json()) } else { voice.data(package.listing()) }
        }
        #[cfg(feature = "fmu-import")]
        SspCommand::Sim(args) => sim(args, voice),
        #[cfg(not(feature = "fmu-import"))]
        SspCommand::Sim(_) => Err(crate::fmu::no_import()),
    }
}

/// `toolroom ssp export`: a machine of a scenario and its controller as a package.
fn export(args: &SspExportArgs, voice: &Voice) -> Result<(), Failure> {
    let refused = |error| Failure::argument(error, "`toolroom check` lists machines, operations and policies");
    let stop = seconds("--stop", Some(&args.stop))?.filter(|stop| *stop > 0.0);
    let stop = stop.ok_or_else(|| Failure::argument("--stop: it has to be above 0", "such as \"1 h\""))?;
    let file = read(&args.scenario.file, &args.scenario.changes.overrides())?;
    let inputs = file.files.iter().map(AsRef::as_ref).chain([args.scenario.file.as_path()]);
    let files = Files::new(inputs, voice.force);
    files.check(&args.out)?;
    let choice =
        Choice { machine: args.machine.clone(), policy: args.policy.clone(), operation: args.operation.clone() };
    let cell = Cell::of(&file.scenario, &choice).map_err(|error| refused(error.to_string()))?;
    let version = if args.fmi == 3 { Version::Three } else { Version::Two };
    let form = if args.flat { Form::Flat } else { Form::Whole };
    if form == Form::Flat && version == Version::Three {
        return Err(Failure::argument("--flat makes units of FMI 2.0", "leave out --fmi 3 or --flat"));
    }
    let bytes = cell
        .in_form(form, version, &binaries(&args.platforms, args.libraries.as_deref(), voice)?, stop)
        .map_err(|error| Failure::work_error(&error))?;
    files.put(&args.out, &bytes)?;
    if voice.json {
        return voice.json(&json!({
            "schema": 1,
            "file": args.out,
            "name": cell.name,
            "title": cell.title,
            "fmi": args.fmi,
            "bytes": bytes.len(),
            "notes": cell.notes,
        }));
    }
    voice.data(format_args!(
        "{}  {}, FMI {}.0, {} kB",
        args.out.display(),
        cell.title,
        args.fmi,
        bytes.len() / 1000
    ))?;
    cell.notes.iter().for_each(|note| voice.say(note));
    voice.say(format_args!("next: toolroom ssp sim {}", args.out.display()));
    Ok(())
}

fn open(path: &Path) -> Result<Package, Failure> {
    Package::open(path).map_err(|error: SspError| {
        Failure::located(error, "a package of SSP is a zip file with SystemStructure.ssd at its root")
    })
}

#[cfg(feature = "fmu-import")]
fn sim(args: &crate::args::SspSimArgs, voice: &Voice) -> Result<(), Failure> {
    use crate::fmu::sim::UnitRun;
    use toolroom_ssp::{Experiment, MasterError, Order, System};

    let files = Files::new([args.file.as_path()], voice.force);
    let run = UnitRun(&args.run);
    run.check(&files, voice)?;
    let stop = seconds("--stop", args.run.stop.as_deref())?;
    let experiment = Experiment { stop, step: seconds("--step", args.run.step.as_deref())? };
    let order = match args.order.as_str() {
        "jacobi" => Order::Jacobi,
        "gauss-seidel" => Order::GaussSeidel,
        names => Order::Given(names.split(',').map(|name| name.trim().to_owned()).collect()),
    };
    // A system that cannot run is an argument, one that failed on the way is work that failed.
    let failed = |error: MasterError| {
        if !error.is_refusal() {
            return Failure::work_error(&error);
        }
        Failure::argument(error, "`toolroom ssp info` shows units, signals and start values")
    };
    let mut package = open(&args.file)?;
    let system = System::load(&mut package, &run.start_values()?, &run.isolation()?).map_err(failed)?;
    system.loops().iter().for_each(|each| voice.say(each));
    let done = run.table(&files, voice, |table| system.simulate(&experiment, &order, table))?;
    run.report(&args.file, ("ssp_version", &package.structure().version), done.map_err(failed)?, voice)
}
