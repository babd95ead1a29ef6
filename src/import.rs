//! `toolroom import`: measured data of others as records.

mod mtconnect;

use crate::args::ImportCommand;
use crate::failure::Failure;
use crate::speak::Voice;

pub fn run(command: &ImportCommand, voice: &Voice) -> Result<(), Failure> {
    match command {
        ImportCommand::Mtconnect(args) => mtconnect::run(args, voice),
    }
}
