//! Contours against closed forms and literature, between their samples, under other units.

mod between_samples;
mod files;
mod gate;
mod literature;
mod rescaling;
mod search;
