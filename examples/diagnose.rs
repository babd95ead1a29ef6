//! Records of a shop whose force grows more with wear than its model believes, diagnosed against that model.
#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::fs;
use toolroom::recording::simulated;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/gap/turning.toml");
    let truth = toolroom::scenario_file::read(
        model.as_ref(),
        &["shop.horizon=16 h".to_owned(), "tool.insert.effects=[{ id = \"wear_force\", size = 0.4 }]".to_owned()],
    )?;
    let log = toolroom::run(&truth.scenario, 0, 0)?;
    let measured = simulated(&truth.scenario, &log, &|_, channel| toolroom::records::Sensor::usual(channel))?;
    let file = std::env::temp_dir().join(format!("toolroom-example-{}.csv", std::process::id()));
    toolroom::records::write_csv(&measured[0], fs::File::create(&file)?)?;
    let answers = toolroom::diagnose(model, &file, 1);
    fs::remove_file(&file)?;
    println!("{}", answers?.terminal());
    Ok(())
}
