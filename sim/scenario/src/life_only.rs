//! Tools of which nothing is known but how long their edges last.

use toolroom_process::{Advance, AnyRecord, ModelError, Process, ProcessEvent, Record, record};

record! {
    /// What such a tool is given.
    pub struct LifeInput {
        /// Whether the edge works.
        engaged: Boolean = 1.0;
    }
}

record! {
    /// What changes while it works.
    pub struct LifeState {
        /// Time for which the edge has worked.
        used: Real["s" => "min"] = 0.0, 0.0..=1e12;
    }
}

record! {
    /// What it shows.
    pub struct LifeOutput {
        /// Time for which the edge has worked.
        used: Real["s" => "min"] = 0.0, 0.0..=1e12;
    }
}

/// Working time of an edge and nothing else: its life is that of [`ToolType::life`](super::ToolType::life), and it wears in
/// plain work, which has no passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LifeOnly;

impl Process for LifeOnly {
    type Input = LifeInput;
    type State = LifeState;
    type Output = LifeOutput;
    const NAME: &'static str = "life_only";
    const EVENTS: &'static [ProcessEvent] = &[];

    fn initial(&self) -> LifeState {
        LifeState::default()
    }

    fn output(&self, x: &LifeState, _: &LifeInput) -> LifeOutput {
        LifeOutput { used: x.used }
    }

    fn advance(&self, x: &mut LifeState, u: &LifeInput, dt: f64) -> Result<Advance, ModelError> {
        u.check()?;
        x.used += u.engaged * dt;
        Ok(Advance { elapsed: dt, event: None })
    }

    fn event_indicators(&self, _: &LifeState, _: &LifeInput, _: &mut [f64]) {}

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        Vec::new()
    }
}
