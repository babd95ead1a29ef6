//! Stability charts of milling, turning and a three-jaw chuck.
//!
//! ```text
//!  lobes file ──► LobesFile: Cut + Chart + operating points
//!                              ├── judge ──► Judgement at a point
//!                              ├── lobes ──► verdicts over the grid
//!                              └── boundaries ──► Curve: the least unstable depth over speed
//! ```

mod boundary;
mod cut;
mod file;
mod judgement;

pub use boundary::{Curve, boundaries};
pub use cut::{Axes, Cut, Quantity};
pub use file::{Chart, LobesFile, Point, parse, read};
pub use judgement::{Judged, Judgement, word};
