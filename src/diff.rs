//! `toolroom diff DIR DIR`: which key figures of two runs differ.

use crate::args::DiffArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_study::difference::RunDifference;
use toolroom_study::results::FinishedRun;

pub fn run(args: &DiffArgs, voice: &Voice) -> Result<(), Failure> {
    let difference =
        RunDifference::read([&args.one, &args.two]).map_err(|error| Failure::located(error, FinishedRun::FIX))?;
    if voice.json { voice.json(&difference.json()) } else { voice.data(difference.text()) }
}
