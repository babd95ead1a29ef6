//! Designed plunge cycles and the policies that run them.

use super::GrindingPhase;
use toolroom_infeed::{CycleError, CycleLimits, Infeed, Input, State, fastest_cycle};

/// A plunge cycle given by what it must reach: rough, finish and spark-out are designed.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleWork {
    /// Machine, wheel and work that cycles are designed for; the tool's process is what happens.
    pub believed: Infeed,
    /// Conditions; the infeed per revolution is of no account.
    pub conditions: Input,
    /// Limits.
    pub limits: CycleLimits,
    /// Share of the wheel's wear that the machine corrects before each part, as a gauge after the
    /// operation tells it; 0 positions the wheel by command alone.
    pub wear_compensation: f64,
    /// The fastest cycle on a dressed wheel: rough, finish, spark-out.
    pub programmed: [GrindingPhase; 3],
}

impl CycleWork {
    /// Phases of a designed cycle; one that has nothing to do has no revolution.
    pub const PHASES: usize = 3;

    /// Designs the cycle of a dressed wheel.
    ///
    /// # Errors
    /// [`CycleError`] names the limits that conflict.
    ///
    /// # Examples
    /// ```
    /// use toolroom_infeed::{CycleLimits, Infeed, Input};
    /// use toolroom_scenario::CycleWork;
    /// let cycle = CycleWork::new(Infeed::default(), Input::default(), CycleLimits::default(), 1.0).unwrap();
    /// assert_eq!(cycle.programmed.map(|phase| phase.revolutions), [19, 5, 3]);
    /// ```
    pub fn new(
        infeed_model: Infeed,
        conditions: Input,
        limits: CycleLimits,
        wear_compensation: f64,
    ) -> Result<Self, CycleError> {
        let none = GrindingPhase { infeed_per_rev: 0.0, revolutions: 0 };
        let mut work =
            Self { believed: infeed_model, conditions, limits, wear_compensation, programmed: [none; Self::PHASES] };
        work.programmed = work.design(1.0)?;
        Ok(work)
    }

    /// The fastest cycle on a wheel whose process stiffness is `dulling` times that of a dressed
    /// one.
    ///
    /// # Errors
    /// [`CycleError`] names the limits that conflict.
    pub fn design(&self, dulling: f64) -> Result<[GrindingPhase; 3], CycleError> {
        let process_stiffness_factor = self.conditions.process_stiffness_factor * dulling;
        let input = Input { process_stiffness_factor, ..self.conditions };
        let cycle = fastest_cycle(&self.believed, &State::default(), &input, &self.limits)?;
        let none = GrindingPhase { infeed_per_rev: 0.0, revolutions: 0 };
        let mut phases = [none; Self::PHASES];
        for (i, phase) in cycle.phases.iter().enumerate() {
            let role = match i {
                0 => 0,
                _ if phase.infeed_per_rev > 0.0 => 1,
                _ => 2,
            };
            phases[role] = GrindingPhase { infeed_per_rev: phase.infeed_per_rev, revolutions: phase.revolutions };
        }
        Ok(phases)
    }
}

/// How designed cycles are run; cycles given by their phases run as programmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GrindingRule {
    /// The fastest cycle on a wheel of this dulling, without looking.
    Fixed {
        /// Process stiffness over that of a dressed wheel.
        dulling: f64,
    },
    /// The feed switches on the measured normal force: rough infeed while the force is below a
    /// threshold, else finish infeed; spark-out until the force says that the size is reached.
    ForceAdaptive {
        /// Dulling for which infeeds and stocks are designed.
        dulling: f64,
        /// Threshold in the rough phase, N; `None`: the force at which a dressed wheel reaches the
        /// rough temperature limit.
        rough_force: Option<f64>,
    },
    /// The measured force tells the time constant of the transient, hence the lag of this wheel on
    /// this part: spark-out is as long as it needs.
    TimeConstantAdaptive {
        /// Dulling for which infeeds and stocks are designed.
        dulling: f64,
        /// Whether infeeds and stocks too are designed anew, for the dulling that the last parts
        /// showed.
        redesign: bool,
    },
}

impl Default for GrindingRule {
    fn default() -> Self {
        Self::Fixed { dulling: 1.0 }
    }
}

/// When a wheel is dressed; decided after each part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DressingRule {
    /// When it has removed the volume that is its dressing limit.
    #[default]
    Limit,
    /// After so many parts; 1 dresses for every part.
    PartCount {
        /// Parts per dressing.
        parts: u32,
    },
    /// When the measured process stiffness has grown this much over that of a dressed wheel.
    Dulling {
        /// Process stiffness over that of a dressed wheel.
        ratio: f64,
    },
}
