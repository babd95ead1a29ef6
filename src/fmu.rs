//! `toolroom fmu`: FMI units.

mod check;
pub mod export;
mod info;
#[cfg(feature = "fmu-import")]
pub mod sim;

use crate::args::FmuCommand;
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::Path;
use toolroom_fmu_import::{Archive, ArchiveError};
use toolroom_process::unit::quantity;

pub fn run(command: &FmuCommand, voice: &Voice) -> Result<(), Failure> {
    match command {
        FmuCommand::Export(args) => export::run(args, voice),
        FmuCommand::Info(args) => info::run(&args.file, voice),
        FmuCommand::Check(args) => check::run(&args.file, voice),
        #[cfg(feature = "fmu-import")]
        FmuCommand::Sim(args) => sim::run(args, voice),
        #[cfg(all(feature = "fmu-import", unix))]
        FmuCommand::Worker => toolroom_fmu_import::worker::serve()
            .map_err(|error| Failure::work(format_args!("the program that uses this worker is gone: {error}"))),
        #[cfg(all(feature = "fmu-import", not(unix)))]
        FmuCommand::Worker => Err(Failure::work("worker processes are for Linux and macOS")),
        #[cfg(not(feature = "fmu-import"))]
        FmuCommand::Sim(_) | FmuCommand::Worker => Err(no_import()),
    }
}

/// What a program without the import of units answers.
#[cfg(not(feature = "fmu-import"))]
pub fn no_import() -> Failure {
    Failure::argument(
        "this toolroom was built without the import of units",
        "build it with `cargo build --release --features fmu-import`; docs/guide/fmu-import.md says what that needs",
    )
}

/// A time of an argument, s.
pub fn seconds(flag: &str, text: Option<&str>) -> Result<Option<f64>, Failure> {
    let read = |text| {
        quantity(text, "s").map_err(|error| Failure::argument(format_args!("{flag}: {error}"), "such as \"0.1 s\""))
    };
    text.map(read).transpose()
}

fn open(path: &Path) -> Result<Archive, Failure> {
    Archive::open(path).map_err(refused)
}

/// An archive that is no use, with the likely fix.
fn refused(error: ArchiveError) -> Failure {
    let fix = error.fix();
    Failure::located(error, fix)
}
