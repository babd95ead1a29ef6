//! `toolroom schema`.

use crate::failure::Failure;
use crate::speak::Voice;

pub fn run(voice: &Voice) -> Result<(), Failure> {
    voice.json(&toolroom_sim::scenario::file::schema())
}
