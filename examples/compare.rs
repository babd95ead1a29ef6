//! Two replications of every policy of a shipped shop, and whether adaptive speed pays.
#![allow(clippy::print_stdout)] // a program

use std::error::Error;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let scenario = toolroom::read_scenario(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/demo.toml"))?;
    let (study, comparison) = toolroom::compare(&scenario, 2)?;
    let parts = study.index("parts_per_shift").ok_or("no such key figure")?;
    for (position, policy) in comparison.policies.iter().enumerate() {
        let mean = toolroom::statistics::t_interval(&study.values(position, parts), 0.95).mean;
        println!("{:24} {mean:6.1} parts a shift", policy.name);
    }
    println!("{}", comparison.decision.line);
    Ok(())
}
