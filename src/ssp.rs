//! `toolroom ssp`: systems of FMI units.

use crate::args::SspCommand;
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::Path;
use toolroom_ssp::{Package, SspError};

pub fn run(command: &SspCommand, voice: &Voice) -> Result<(), Failure> {
    match command {
        SspCommand::Info(args) => {
            let package = open(&args.file)?;
            if voice.json { voice.json(&package.json()) } else { voice.data(package.listing()) }
        }
        #[cfg(feature = "fmu-import")]
        SspCommand::Sim(args) => sim::run(args, voice),
        #[cfg(not(feature = "fmu-import"))]
        SspCommand::Sim(_) => Err(crate::fmu::no_import()),
    }
}

fn open(path: &Path) -> Result<Package, Failure> {
    Package::open(path).map_err(|error: SspError| {
        Failure::argument(error, "a package of SSP is a zip file with SystemStructure.ssd at its root")
    })
}

#[cfg(feature = "fmu-import")]
mod sim {
    use super::open;
    use crate::args::SspSimArgs;
    use crate::failure::Failure;
    use crate::fmu::sim::{isolation, seconds};
    use crate::output::Files;
    use crate::speak::Voice;
    use serde_json::json;
    use std::io::{BufWriter, Write};
    use toolroom_fmu_import::simulate::named_values;
    use toolroom_ssp::{Experiment, MasterError, Order, System};

    pub fn run(args: &SspSimArgs, voice: &Voice) -> Result<(), Failure> {
        if voice.json && args.output.is_none() {
            return Err(Failure::argument("--json and the table both go to standard output", "give --output CSV"));
        }
        let files = Files::new([args.file.as_path()], voice.force);
        args.output.as_ref().map_or(Ok(()), |path| files.check(path))?;
        let start = named_values(&args.start)
            .map_err(|error| Failure::argument(error, "such as --start lathe.tool.set=ni_vk6om"))?;
        let experiment = Experiment {
            stop: seconds("--stop", args.stop.as_deref())?,
            step: seconds("--step", args.step.as_deref())?,
        };
        let order = match args.order.as_str() {
            "jacobi" => Order::Jacobi,
            "gauss-seidel" => Order::GaussSeidel,
            names => Order::Given(names.split(',').map(|name| name.trim().to_owned()).collect()),
        };
        let isolation = isolation(args.isolation, &args.call_limit)?;
        let system = System::load(&mut open(&args.file)?, &start, &isolation).map_err(failed)?;
        let done = match &args.output {
            Some(path) => {
                let mut draft = files.begin(path)?;
                let mut table = BufWriter::new(&mut draft.file);
                let done = system.simulate(&experiment, &order, &mut table);
                table.flush().map_err(|source| Failure::Unwritable { path: path.clone(), source })?;
                drop(table);
                files.end(draft)?;
                done
            }
            None => {
                let mut table = Vec::new();
                let done = system.simulate(&experiment, &order, &mut table);
                voice.data(String::from_utf8_lossy(&table).trim_end())?;
                done
            }
        };
        let done = done.map_err(failed)?;
        if voice.json {
            return voice.json(&json!({
                "schema": 1,
                "file": args.file.display().to_string(),
                "start [s]": done.start,
                "stop [s]": done.stop,
                "step [s]": done.step,
                "steps": done.steps,
                "ended_by_unit": done.ended,
                "output": args.output,
            }));
        }
        let end = if done.ended { ", where a unit ended the simulation" } else { "" };
        voice
            .say(format_args!("{} steps of {} s from {} s to {} s{end}", done.steps, done.step, done.start, done.stop));
        Ok(())
    }

    /// A system that cannot run is an argument, one that failed on the way is work that failed.
    fn failed(error: MasterError) -> Failure {
        match error {
            MasterError::Unit { .. } | MasterError::Output(_) | MasterError::Folder(_) => {
                Failure::Work { message: error.to_string() }
            }
            error => Failure::argument(error, "`toolroom ssp info` shows units, signals and start values"),
        }
    }
}
