//! One replication of a shipped shop: how many parts it made, and why its edges were changed.
#![allow(clippy::print_stdout)] // a program

use std::collections::BTreeMap;
use std::error::Error;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let scenario = toolroom::read_scenario(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/demo.toml"))?;
    let log = toolroom::run(&scenario, 0, 0)?;
    let mut edges: BTreeMap<&str, u32> = BTreeMap::new();
    for reason in log.edges.iter().map(|edge| edge.reason.name()) {
        *edges.entry(reason).or_default() += 1;
    }
    println!("{}: {} jobs, {} passes, edges {edges:?}", scenario.name, log.jobs.len(), log.passes.len());
    Ok(())
}
