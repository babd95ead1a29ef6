//! Laws of measured tool lives: the most credible one, its mean and the age that 10 % do not reach.
#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use toolroom::life::analysis::{Request, analyse};
use toolroom::life::sample::Observation::{Censored, Failed};
use toolroom::life::sample::Sample;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    // Minutes in cut; the last edge was still good when the shift ended. Numbers made up for the example.
    let lives = [11.2, 13.0, 14.1, 14.9, 15.8, 16.6, 17.4, 18.9, 20.3].map(Failed);
    let sample = Sample::new(lives.into_iter().chain([Censored(21.0)]))?;
    let analysis = analyse(&sample, &Request { bootstrap: 99, goodness: 0, ..Request::default() })?;
    let (mean, b10) = (analysis.mean, analysis.b10);
    println!("mean {:.1} min ({:.1} to {:.1})", mean.value, mean.low, mean.high);
    println!("B10  {:.1} min ({:.1} to {:.1})", b10.value, b10.low, b10.high);
    Ok(())
}
