//! `toolroom schema`.

use crate::args::SchemaArgs;
use crate::failure::Failure;
use crate::speak::Voice;

pub fn run(args: &SchemaArgs, voice: &Voice) -> Result<(), Failure> {
    voice.json(&args.kind.schema())
}
