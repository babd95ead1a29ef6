//! Force, temperature and power of turning over cutting speed, with a worn edge.
#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use toolroom::cutting::{Turning, TurningInput, TurningState};
use toolroom::process::Process;
use toolroom::wear::Pair;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let turning = Turning { pair: Pair::named("ni_vk6om")?, ..Turning::default() };
    let reference = turning.pair.reference_cut();
    let state = TurningState { flank_wear: 0.2e-3, ..turning.initial() };
    for speed in [20.0, 40.0, 60.0] {
        let input = TurningInput {
            cutting_speed: speed / 60.0,
            feed_per_rev: reference.feed_per_rev,
            depth_of_cut: reference.depth_of_cut,
            ..TurningInput::default()
        };
        let output = turning.output(&state, &input);
        println!("{speed} m/min: {:.0} N, {:.0} W", output.cutting_force, output.spindle_power);
    }
    Ok(())
}
