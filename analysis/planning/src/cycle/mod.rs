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

use std::path::Path;
use toolroom_form::{FaultList, FormFile, ReadError, Refusal, key_place};
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
    /// Reads a cycle file with the values of `--set` and works it out; the design has the name of the file.
    ///
    /// # Errors
    /// [`ReadError`]: the file cannot be opened or decoded, every fault found in it, or limits that no cycle meets.
    pub fn read(file: &Path, set: &[String]) -> Result<FormFile<Self>, ReadError> {
        let FormFile { content, echo, text, files } = CycleFile::read(file, set)?;
        let content = Self::new(file.file_stem().unwrap_or_default().to_string_lossy(), content)
            .map_err(|error| conflict(&error, &file.display().to_string(), &text))?;
        Ok(FormFile { content, echo, text, files })
    }

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

/// Limits that no cycle meets: their place in the file is that of the first of them.
fn conflict(error: &CycleError, file: &str, text: &str) -> ReadError {
    let code = if error.limits().is_empty() { "out-of-range" } else { "limits-conflict" };
    let place = key_place(text, "limits", error.limits().first().copied().unwrap_or("limits"));
    let mut refusal = Refusal::new(code, error);
    if let [one, other, ..] = error.limits() {
        refusal.fix = Some(format!("change {one} or {other}"));
    }
    ReadError::Faults(Box::new(FaultList::refused(file, text, [(place, refusal)])))
}
