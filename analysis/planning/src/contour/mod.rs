//! Plans along a contour: regimes to compare with, plans of least time and cost, and what their gains depend on.
//!
//! ```text
//!  ContourFile ──► studies ──► PassStudy: baselines, plans, front, conditions, scatter
//!                                 ├── summary ──► JSON for programs
//!                                 ├── text    ──► lines for a terminal
//!                                 └── files   ──► tables, part programs, JSON, report with pictures
//! ```

mod conditions;
mod files;
mod journal;
mod picture;
mod report;
mod study;
mod task;
mod text;

pub use conditions::{Condition, Gain, OBJECTIVES, REPORTED_COST, REPORTED_PRODUCTIVITY, conditions};
pub use files::{NAMES, files, summary};
pub use journal::DrawJournal;
pub use report::report;
pub use study::{Baseline, PassStudy, RefusedPass, Scattered, StudyOptions, edge_life, join_length, studies};
pub use task::{Drawn, Task, Text, read_setup};
pub use text::text;
