//! Stability charts of milling, turning and a three-jaw chuck.
//!
//! ```text
//!  lobes file ──► LobesFile: Cut + Chart + operating points
//!                              ├── judge ──► Judgement at a point
//!                              ├── lobes ──► verdicts over the grid
//!                              ├── boundaries ──► Curve: the least unstable depth over speed
//!                              └── ChartStudy ──► text, table, pictures, report
//! ```

mod boundary;
mod cut;
mod file;
mod files;
mod judgement;
mod part;
mod picture;
mod place;
mod study;
mod text;

pub use boundary::{Curve, boundaries};
pub use cut::{Axes, Cut, Quantity};
pub use file::{Chart, LobesFile, Point, parse, read};
pub use files::NAMES;
pub use judgement::{Judged, Judgement, word};
pub use part::{Columns, chart, plan};
pub use picture::picture;
pub use place::{PlaceError, PointVerdict};
pub use study::ChartStudy;
