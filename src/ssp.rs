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
        SspCommand::Sim(args) => sim(args, voice),
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
fn sim(args: &crate::args::SspSimArgs, voice: &Voice) -> Result<(), Failure> {
    use crate::fmu::sim::seconds;
    use toolroom_ssp::{Experiment, MasterError, Order, System};

    let files = toolroom_output::Files::new([args.file.as_path()], voice.force);
    args.run.check(&files, voice)?;
    let stop = seconds("--stop", args.run.stop.as_deref())?;
    let experiment = Experiment { stop, step: seconds("--step", args.run.step.as_deref())? };
    let order = match args.order.as_str() {
        "jacobi" => Order::Jacobi,
        "gauss-seidel" => Order::GaussSeidel,
        names => Order::Given(names.split(',').map(|name| name.trim().to_owned()).collect()),
    };
    // A system that cannot run is an argument, one that failed on the way is work that failed.
    let failed = |error: MasterError| match error {
        MasterError::Unit { .. } | MasterError::Output(_) | MasterError::Folder(_) => {
            Failure::Work { message: error.to_string() }
        }
        error => Failure::argument(error, "`toolroom ssp info` shows units, signals and start values"),
    };
    let mut package = open(&args.file)?;
    let system = System::load(&mut package, &args.run.start_values()?, &args.run.isolation()?).map_err(failed)?;
    let done = args.run.table(&files, voice, |table| system.simulate(&experiment, &order, table))?;
    args.run.report(&args.file, ("ssp_version", &package.structure().version), done.map_err(failed)?, voice)
}
