//! `toolroom completions SHELL`.

use crate::args::{CompletionsArgs, Toolroom};
use crate::failure::Failure;
use crate::speak::Voice;
use clap::CommandFactory;

pub fn run(args: &CompletionsArgs, voice: &Voice) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Toolroom::command(), "toolroom", &mut script);
    voice.raw(String::from_utf8_lossy(&script).trim_end())
}
