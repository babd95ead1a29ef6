//! Fanuc, Haas and LinuxCNC: lines of words, macros and o-words.

mod block;
mod codes;
mod corner;
mod cycles;
mod increments;
mod modes;
mod once;
mod parse;
mod path;
mod pocket;
mod polar;
mod run;
mod turn;
mod variables;
mod words;

pub(crate) use run::Iso;
