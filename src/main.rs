//! `toolroom`, the command line: glue between scenario files, the shop and the analysis.
//!
//! One file a verb; data go to standard output, narration and progress to standard error.
//! Exit code 0: done; 1: the work failed; 2: the input is wrong; 3: done, but the answer must not be overlooked, such
//! as too little data; 130 and 143: interrupted by SIGINT and SIGTERM.

#![deny(clippy::wildcard_enum_match_arm)]

mod calibrate;
mod check;
mod coefficients;
mod compare;
mod completions;
mod contour;
mod demo;
mod diff;
mod effects;
mod explain;
mod failure;
mod fmu;
mod gap;
mod grind;
mod identify;
mod import;
mod life;
mod listen;
mod lobes;
mod merge;
mod modes;
mod new;
mod plan;
mod point;
mod program;
mod progress;
mod reference;
mod refusal;
mod report;
mod run;
mod schema;
mod shard;
mod snapshot;
mod speak;
mod ssp;
mod study;
mod sweep;
mod validate;
mod warm_up;

use args::{Command, Toolroom};
use clap::Parser;
use failure::Failure;
use speak::Voice;
use std::process::ExitCode;
use toolroom_arguments as args;
use toolroom_output::{codes, signals};

fn main() -> ExitCode {
    let Toolroom { command, common } = Toolroom::try_parse().unwrap_or_else(|error| refused(&error));
    let voice = Voice::new(&common);
    toolroom_study::draws::register();
    toolroom_output::progress::watch_silence(voice.progress());
    #[cfg(feature = "fmu-import")]
    toolroom_fmu_import::register_program();
    // A worker ends when its program says so, and not by signals of the terminal.
    let watched = if matches!(command, Command::Fmu(args::FmuCommand::Worker)) {
        Ok(())
    } else {
        signals::watch(voice.max_memory).map_err(Failure::from)
    };
    match watched.and_then(|()| perform(command, &voice)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(&voice),
    }
}

/// Ends with what clap says of a command line that cannot be understood; as JSON, too, where that was requested.
fn refused(error: &clap::Error) -> ! {
    if error.use_stderr() && std::env::args_os().any(|argument| argument == "--json") {
        let voice = Voice::new(&args::Common {
            json: true,
            quiet: false,
            verbose: false,
            wide: false,
            force: false,
            max_memory: None,
        });
        let text = error.to_string();
        // The first paragraph; usage and the way to help follow it.
        let words: Vec<&str> = text.split("\n\n").next().unwrap_or_default().split_whitespace().collect();
        let message = words.join(" ");
        refusal::report_on(&voice, codes::USAGE, message.strip_prefix("error: ").unwrap_or(&message), None, None);
    }
    error.exit()
}

fn perform(command: Command, voice: &Voice) -> Result<(), Failure> {
    match command {
        Command::Demo(args) => demo::run(&args, voice),
        Command::Compare(args) if args.scenario.from.is_none() && !args.sweep.is_empty() => sweep::run(&args, voice),
        Command::Compare(args) => compare::run(&args, voice),
        Command::Run(args) => snapshot::run(&args, voice),
        Command::Report(args) => report::run(&args, voice),
        Command::Diff(args) => diff::run(&args, voice),
        Command::New(args) => new::run(&args, voice),
        Command::Check(args) => check::run(&args, voice),
        Command::Point(args) => point::run(&args, voice),
        Command::Lobes(args) => lobes::run(&args, voice),
        Command::Modes(args) => modes::run(&args, voice),
        Command::Swap(args) => modes::swap(&args, voice),
        Command::Listen(args) => listen::run(&args, voice),
        Command::Coefficients(args) => coefficients::run(&args, voice),
        Command::Life(args) => life::run(&args, voice),
        Command::Calibrate(args) => calibrate::run(&args, voice),
        Command::Identify(args) => identify::run(&args, voice),
        Command::Grind(args) => grind::run(&args, voice),
        Command::Program(args) => program::run(&args, voice),
        Command::Contour(args) => contour::run(&args, voice),
        Command::Shard(args) => shard::run(&args, voice),
        Command::Merge(args) => merge::run(&args, voice),
        Command::Validate => validate::run(voice),
        Command::Effects(args) => effects::run(&args, voice),
        Command::Fmu(command) => fmu::run(&command, voice),
        Command::Ssp(command) => ssp::run(&command, voice),
        Command::Reference(args) => reference::run(&args, voice),
        Command::Schema(args) => schema::run(&args, voice),
        Command::Gap(command) => gap::run(&command, voice),
        Command::Import(command) => import::run(&command, voice),
        Command::Explain(args) => explain::run(&args, voice),
        Command::Completions(args) => completions::run(&args, voice),
    }
}
