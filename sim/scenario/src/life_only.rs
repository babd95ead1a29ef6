//! Tools of which nothing is known but how long their edges last.

use crate::Distribution;
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

/// How long edges last in plain work.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeLife {
    /// Working time until an edge is changed, s.
    pub time: Distribution,
    /// How it falls with the cutting speed; `None`: nothing is known of that.
    pub at: Option<LifeSpeed>,
}

/// The cutting speed of a life, and how the life falls with it: `T(v) = T·(v / cutting_speed)^-exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LifeSpeed {
    /// Cutting speed at which edges last so long, m/s.
    pub cutting_speed: f64,
    /// Exponent of the speed, 1, that of Taylor's law in the form `v·T^(1/exponent) = C`.
    pub exponent: f64,
}

impl LifeSpeed {
    /// Life that a unit of working time takes at a cutting speed, m/s. Shares of the lives at several speeds add up, as
    /// damage does by Palmgren and Miner.
    ///
    /// ```
    /// let drill = toolroom_scenario::LifeSpeed { cutting_speed: 80.0 / 60.0, exponent: 4.0 };
    /// assert!((drill.aging(40.0 / 60.0) - 1.0 / 16.0).abs() < 1e-12);
    /// ```
    pub fn aging(self, cutting_speed: f64) -> f64 {
        (cutting_speed / self.cutting_speed).powf(self.exponent)
    }
}

/// Tool of which an edge wears in plain work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WornTool {
    /// Its index.
    pub tool: usize,
    /// Life that a unit of working time takes, 1 at the conditions of the life.
    pub aging: f64,
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
