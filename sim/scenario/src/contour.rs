//! Contours that mills run, and the regimes that policies choose for them.

use super::{MachineType, ToolType};
use crate::policies::{ContourPlan, PlanError};
use std::sync::Arc;
use toolroom_contour::{ContourFile, Pass};
use toolroom_form::vocabulary;

vocabulary! {
    /// How spindle speeds and feeds of a contour are found.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ContourRule {
        /// The handbook regime: one table feed for the whole contour.
        HandbookOneFeed = "handbook_one_feed",
        /// The handbook regime with a feed override for each section.
        HandbookPerSection = "handbook_per_section",
        /// The one spindle speed and feed of least cost.
        BestConstant = "best_constant",
        /// Least time, section by section.
        Time = "time",
        /// Least cost, section by section.
        Cost = "cost",
    }
}

/// Passes around a contour. The contour file says what the programmer believes of cutter, work and
/// machine; the tool's process is what happens.
#[derive(Clone, Debug)]
pub struct ContourWork {
    /// The file as written in the scenario.
    pub file: String,
    /// What it says.
    pub content: ContourFile,
    /// Passes that the operation makes, by index into those of the file.
    pub passes: Vec<usize>,
    /// The regime that is programmed, where the policy has none of its own.
    pub rule: ContourRule,
    /// Plans of that regime on the first machine, pass by pass: the yardstick of effectiveness.
    pub programmed: Vec<Arc<ContourPlan>>,
}

impl ContourWork {
    /// Plans the passes as programmed for `tool` on `machine`.
    ///
    /// # Errors
    /// [`PlanError`] where no plan exists or the contour is for another cutter.
    pub fn new(
        file: &str,
        content: ContourFile,
        passes: Vec<usize>,
        rule: ContourRule,
        tool: &ToolType,
        machine: &MachineType,
    ) -> Result<Self, PlanError> {
        let mut work = Self { file: file.to_owned(), content, passes, rule, programmed: Vec::new() };
        work.programmed = (0..work.passes.len())
            .map(|pass| ContourPlan::new(&work, pass, rule, tool, machine).map(Arc::new))
            .collect::<Result<_, _>>()?;
        Ok(work)
    }

    /// Pass number `pass` of the operation, with its name.
    pub fn pass(&self, pass: usize) -> (&str, &Pass) {
        let (name, pass) = &self.content.passes[self.passes[pass]];
        (name, pass)
    }
}
