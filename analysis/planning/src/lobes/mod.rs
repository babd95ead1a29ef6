//! Stability charts of milling, turning and a three-jaw chuck.
//!
//! ```text
//!  lobes file ──► LobesFile: Cut + Chart + operating points
//!                              ├── judge ──► Judgement at a point
//!                              ├── lobes ──► verdicts over the grid
//!                              ├── boundaries ──► Curve: the least unstable depth over speed
//!                              ├── load, surface_error, limit_depths ──► what limits of the file forbid
//!                              └── ChartStudy ──► text, table, pictures, report
//!                                     └── ChartMap, Best, robust speeds: the workbench
//! ```

mod best;
mod best_point;
mod boundary;
mod chart_map;
mod cut;
mod file;
mod files;
mod helix;
mod history;
mod judgement;
mod load;
mod map;
mod measured;
mod measured_curve;
mod part;
mod picture;
mod pitch;
mod place;
mod robust;
mod study;
mod text;

pub use best_point::{Best, Bound};
pub use boundary::{Curve, boundaries};
pub use chart_map::{ChartMap, MapError, MapKind};
pub use cut::{Axes, Cut, Quantity};
pub use file::{Chart, Limits, LobesFile, Point, parse, read};
pub use files::NAMES;
pub use helix::BestHelix;
pub use history::{HISTORY_NAMES, History, HistoryError, SpectralLine};
pub use judgement::{Judged, Judgement, word};
pub use load::Limited;
pub use map::MAP_SAMPLES;
pub use measured::Measured;
pub use measured_curve::MeasuredCurve;
pub use part::{Columns, chart, plan};
pub use picture::picture;
pub use pitch::{BestPitch, PitchError};
pub use place::{GREATEST_DIFFERENCE, PlaceError, PointVerdict};
pub use robust::ASSUMED_SCATTER;
pub use study::ChartStudy;
