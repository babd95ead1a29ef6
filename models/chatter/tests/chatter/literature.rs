//! Published and independently computed numbers, each with its tolerance.

mod amplitude;
mod milling;
mod paper;
mod turning;
