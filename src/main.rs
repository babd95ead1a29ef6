//! `toolroom`, the command line: glue between scenario files, the shop and the analysis.
//!
//! One file a verb; data go to standard output, narration and progress to standard error.
//! Exit code 0: done; 1: the work failed or was interrupted; 2: the input is wrong.

mod args;
mod check;
mod completions;
mod effects;
mod explain;
mod failure;
mod new;
mod point;
mod schema;
mod speak;
mod validate;

use args::{Command, Toolroom};
use clap::Parser;
use failure::Failure;
use speak::Voice;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Toolroom { command, common } = Toolroom::parse();
    let voice = Voice::new(&common);
    match run(command, &voice) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(&voice),
    }
}

fn run(command: Command, voice: &Voice) -> Result<(), Failure> {
    match command {
        Command::New(args) => new::run(&args, voice),
        Command::Check(args) => check::run(&args, voice),
        Command::Point(args) => point::run(&args, voice),
        Command::Validate => validate::run(voice),
        Command::Effects => effects::run(voice),
        Command::Schema => schema::run(voice),
        Command::Explain(args) => explain::run(&args, voice),
        Command::Completions(args) => completions::run(&args, voice),
    }
}
