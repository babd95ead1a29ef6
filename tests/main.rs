//! Every promise of the README that the program has to keep: one module a promise, one binary for all of them.

mod architecture;
mod blind;
mod calibration;
mod cli;
mod command_line;
mod determinism;
mod dynamics;
mod examples;
mod extension;
mod fmu_files;
mod fmu_import;
mod gap_data;
mod gap_processes;
mod import;
mod life;
mod lobes;
mod parameter_sets;
mod planned;
mod planning;
mod programs;
mod report;
mod self_null;
mod ssp_cell;
mod tuning;
mod withheld;
mod withheld_grinding_milling;
