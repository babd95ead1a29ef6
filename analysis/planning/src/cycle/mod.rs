//! The fastest plunge-grinding cycle within limits, and when to dress the wheel.
//!
//! ```text
//!  CycleFile ──► CycleDesign ──┬── summary ──► JSON for programs
//!                              ├── text    ──► lines for a terminal
//!                              └── files   ──► tables, JSON, report with pictures
//! ```

mod files;
mod picture;
mod text;

use toolroom_infeed::{Cycle, CycleError, CycleFile, DressingInterval};

/// The files of a cycle design; `dressing.csv` where the file describes dressing.
pub const NAMES: &[&str] = &["cycle.csv", "dressing.csv", "grind.json", "report.html"];

/// A grinding task worked out.
pub struct CycleDesign {
    /// Name of the design.
    pub name: String,
    /// Process, conditions and limits.
    pub file: CycleFile,
    /// The fastest cycle within the limits.
    pub cycle: Cycle,
    /// When to dress, by estimated cycles and by the exact cycle of every part; `None` where the file does not
    /// describe dressing.
    pub dressing: Option<[DressingInterval; 2]>,
}

impl CycleDesign {
    /// Works out the cycle and the dressing interval of `file`.
    ///
    /// # Errors
    /// [`CycleError`]: limits that no cycle meets, or values out of range.
    pub fn new(name: impl Into<String>, file: CycleFile) -> Result<Self, CycleError> {
        let cycle = file.fastest_cycle()?;
        let dressing = file.dressing_intervals()?;
        Ok(Self { name: name.into(), file, cycle, dressing })
    }

    /// Limits that the cycle breaks in the process itself. The search takes the wheel as it is at
    /// the start of the part; dulling within the part and warm gauging come on top.
    pub fn broken(&self) -> Vec<&'static str> {
        let (cycle, limits) = (&self.cycle, &self.file.limits);
        let above = |value: f64, limit: f64| value > limit * (1.0 + 1e-9);
        [
            ("rough_temperature_rise", above(cycle.peak_temperature_rise, limits.rough_temperature_rise)),
            ("finish_stock", above(limits.finish_stock, cycle.finish_stock)),
            ("last_depth", above(cycle.last_depth, limits.last_depth)),
            ("size_error", above(cycle.size_error, limits.size_error)),
            ("roundness_error", above(cycle.roundness_error, limits.roundness_error)),
        ]
        .into_iter()
        .filter_map(|(limit, broken)| broken.then_some(limit))
        .collect()
    }

    /// What to know about broken limits before the cycle is used.
    pub fn warning(&self) -> Option<String> {
        let broken = self.broken();
        (!broken.is_empty()).then(|| {
            format!(
                "what the wheel does within the part breaks {}: the search takes the wheel as it is at the start; tighten \
                 the limit by what is missing",
                broken.join(", ")
            )
        })
    }
}
