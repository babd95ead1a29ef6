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
use toolroom_infeed::{Cycle, CycleError, CycleFile, DressingInterval, WheelLife};

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
    /// Volume per width that the wheel has removed since dressing where the cycle begins, m².
    pub removed_volume: f64,
    /// What the wheel is good for until it is too small, and the cycle on it then, where there is one; `None` where the
    /// file asks for nothing about that.
    pub wheel_life: Option<(WheelLife, Option<Cycle>)>,
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
        let dressing = file.dressing_intervals()?;
        let exact = dressing.as_ref().map(|[_, exact]| exact);
        let wheel = file.wheel_before(exact);
        let cycle = file.cycle_on(&wheel)?;
        let life = file
            .dressing
            .zip(exact)
            .and_then(|(plan, exact)| plan.wheel_life(&file.grinding, exact.parts, file.limits.stock));
        let wheel_life = life.map(|life| {
            let loss = 0.5 * (file.grinding.parameters.wheel_diameter - life.diameter);
            (life, file.cycle_with(&file.grinding.with_worn_wheel(loss), &wheel).ok())
        });
        Ok(Self { name: name.into(), file, cycle, dressing, removed_volume: wheel.removed_volume, wheel_life })
    }

    /// Limits that the cycle breaks in the process itself. Dulling within the part is in the search; warm gauging and
    /// what else effects change within the part come on top.
    pub fn broken(&self) -> Vec<&'static str> {
        let (cycle, limits) = (&self.cycle, &self.file.limits);
        let above = |value: f64, limit: f64| value > limit * (1.0 + 1e-9);
        [
            ("rough_temperature_rise", above(cycle.peak_temperature_rise, limits.rough_temperature_rise)),
            ("power", above(cycle.peak_power, limits.power)),
            ("normal_force", above(cycle.peak_normal_force, limits.normal_force)),
            ("material_removal", above(cycle.peak_removal_rate, limits.material_removal)),
            ("burn_margin", self.least_margin() < limits.burn_margin - 1e-9),
            ("roughness", cycle.roughness.is_some_and(|roughness| above(roughness, limits.roughness))),
            ("finish_stock", above(limits.finish_stock, cycle.finish_stock)),
            ("last_depth", above(cycle.last_depth, limits.last_depth)),
            ("size_error", above(cycle.size_error, limits.size_error)),
            ("roundness_error", above(cycle.roundness_error, limits.roundness_error)),
        ]
        .into_iter()
        .filter_map(|(limit, broken)| broken.then_some(limit))
        .collect()
    }

    /// The lesser of the distances to burn by temperature and by specific energy.
    fn least_margin(&self) -> f64 {
        let by_temperature = self.cycle.least_burn_margin;
        self.cycle.least_energy_margin.map_or(by_temperature, |by_energy| by_energy.min(by_temperature))
    }

    /// Which measure of burn binds.
    fn binding_burn(&self) -> &'static str {
        if self.least_margin() < self.cycle.least_burn_margin { "specific_energy" } else { "temperature" }
    }

    /// What to know before the cycle is used.
    pub fn warnings(&self) -> Vec<String> {
        let broken = self.broken();
        let breaks = (!broken.is_empty()).then(|| {
            format!(
                "what effects do within the part breaks {}: the search knows the dulling of the wheel and nothing else; tighten \
                 the limit by what is missing",
                broken.join(", ")
            )
        });
        breaks.into_iter().chain(self.file.dressing.and_then(|plan| plan.warning())).collect()
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
