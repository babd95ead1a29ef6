//! Plunge grinding against literature, reference tables and its own limits.

mod continuous;
mod contract;
mod cycle;
mod golden;
mod identify;
mod limits;
mod paper;
mod signatures;
mod waves;
