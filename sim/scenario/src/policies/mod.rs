//! Who chooses the cutting speed and when an edge is changed.
//!
//! A [`ResolvedPolicy`] is a [`PolicyRule`](crate::PolicyRule) worked out for one scenario: a [`Controller`] for
//! every pass on every machine that may cut it, immutable and shared. What a controller learns
//! about one edge is in the edge's [`Observer`].
//!
//! | file | rule |
//! |---|---|
//! | `constant.rs` | one speed for each nominal cut, best for path, life, rate or cost on the believed model, or Makarov's |
//! | `schedule.rs` | speed against cumulative path |
//! | `planned.rs` | minimum wear (mode 1), literal balance, productivity, oracle |
//! | `set_increment.rs` | set wear increment (mode 2) |
//! | `stability.rs` | what is done about chatter, on top of the speed |
//! | `tool_change.rs` | when an edge is changed |
//! | `observer.rs` | what the sensors say about the edge |
//! | `contour.rs` | spindle speeds and feeds of contours: handbook, best constant, planned |
//! | `grinding.rs` | plunge cycles: fixed, switched by force, timed by the measured lag; dressing |
//!
//! A controller sees what a machine can measure: the commanded pass, path and time of the edge,
//! the observer's estimate from noisy channels. Only a policy that [knows](crate::Knowledge) more is shown the true wear.
//!
//! Tool-life studies plan passes by the same rule ([`toolroom_wear::RampLimits::ramp`], [`toolroom_wear::ramp_limits`]) and read the same
//! sensors ([`SensorSheet::observer_noise`](crate::SensorSheet::observer_noise)).
//!
//! # What is not modelled
//! Speeds are planned for continuous cut: a controller does not know that the tool cools in a
//! pause. It learns from one edge for the next what is common to edges, nothing about the law of wear.

mod constant;
mod contour;
mod grinding;
mod observer;
mod planned;
mod resolve;
mod schedule;
mod set_increment;
mod settings;
mod stability;
mod tool_change;

pub use contour::{ContourPlan, ContourSection, PlanError};
pub use grinding::{ForceReading, GrindingController, WheelEstimate};
pub use observer::{Observer, Sample};
pub use resolve::ResolvedPolicy;
pub use settings::{Settings, SpeedSetting};
pub use stability::{Stability, nominal_limit};
pub use tool_change::ChangeRule;

use crate::{Knowledge, SensorSheet};
use planned::Planned;
use rand_distr::{Distribution as _, StandardNormal};
use set_increment::SetIncrement;
use std::sync::Arc;
use toolroom_chatter::{ChatterError, SpeedVariation};
use toolroom_infeed::CycleError;
use toolroom_kernel::Stream;
use toolroom_wear::{EdgeScatter, Pair, SpeedSchedule};

/// Why a policy could not be worked out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolicyError {
    /// The stability model refused the nominal structure.
    #[error("chatter: {0}")]
    Chatter(#[from] ChatterError),
    /// No cycle keeps the limits on a wheel of the dulling that the policy designs for.
    #[error("grinding cycle: {0}")]
    Cycle(#[from] CycleError),
    /// The contour has no such plan on this machine.
    #[error(transparent)]
    Contour(#[from] PlanError),
}

/// Why a policy could not be worked out for a scenario.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResolveError {
    /// The scenario has fewer policies.
    #[error("policy {index} does not exist: the scenario has {count}")]
    UnknownPolicy {
        /// Asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// An index of the scenario points nowhere.
    #[error("{kind} {index} is used, the scenario has {count}")]
    UnknownIndex {
        /// What is indexed.
        kind: &'static str,
        /// Index used.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A draw of a posterior gives no process.
    #[error("tool `{tool}`, draw of replication {replication}: {reason}")]
    Draw {
        /// Tool name.
        tool: String,
        /// Replication, from 0.
        replication: u32,
        /// What contradicts what.
        reason: String,
    },
    /// The policy cannot be worked out for a tool.
    #[error("policy `{policy}` with tool `{tool}`: {source}")]
    Policy {
        /// Policy name.
        policy: String,
        /// Tool name.
        tool: String,
        /// Why.
        source: Box<PolicyError>,
    },
}

/// What a controller is shown at the start of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// Path still to be cut in this pass, m.
    pub path: f64,
    /// Path that the edge has cut, m.
    pub edge_path: f64,
    /// Time that the edge has cut, s.
    pub edge_time: f64,
    /// Parts that the edge has finished.
    pub edge_parts: u32,
    /// Speed at the end of the edge's last pass, m/s.
    pub last_speed: Option<f64>,
    /// What the sensors said so far, where the controller has some.
    pub observer: Option<&'a Observer>,
    /// Speed to which the machine has gone in this kind of pass because of chatter, m/s.
    pub reaction: Option<f64>,
    /// True flank wear, m; `None` but for a policy that [knows](Controller::sees_true_wear) it.
    pub true_wear: Option<f64>,
    /// How the edge differs from the nominal one; `None` but for a policy that [knows](Controller::sees_edge) it.
    pub true_edge: Option<&'a EdgeScatter>,
}

impl Observation<'_> {
    /// Flank wear as far as the controller knows it, m.
    pub fn flank_wear(&self) -> Option<f64> {
        self.true_wear.or_else(|| self.observer.map(Observer::flank_wear))
    }

    /// A nominal cut as far as it is known how this edge meets it.
    fn cut(&self, nominal: &toolroom_wear::Cut) -> toolroom_wear::Cut {
        self.true_edge.map_or(*nominal, |edge| edge.apply(nominal))
    }
}

/// What a controller commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Cutting speed at the start of the pass, m/s.
    pub start_speed: f64,
    /// At its end, m/s; linear in time between them.
    pub end_speed: f64,
    /// Layers in which the depth is cut, one pass each.
    pub layers: u32,
    /// Sinusoidal variation of the spindle speed.
    pub variation: Option<SpeedVariation>,
}

impl Conditions {
    /// One speed from start to end.
    pub fn constant(speed: f64) -> Self {
        Self::ramp(speed, speed)
    }

    /// A speed that changes evenly over the pass.
    pub fn ramp(start_speed: f64, end_speed: f64) -> Self {
        Self { start_speed, end_speed, layers: 1, variation: None }
    }

    /// Time for `path` metres in every layer, s.
    pub fn duration(&self, path: f64) -> f64 {
        2.0 * path * f64::from(self.layers) / (self.start_speed + self.end_speed)
    }
}

/// Speed and tool change for one nominal cut on one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Controller {
    speed: Speed,
    change: ChangeRule,
    /// Limits that no command leaves, m/s.
    range: (f64, f64),
    sensors: SensorSheet,
    /// What the controller believes about tool and work, and the cut as programmed.
    believed: Option<BelievedModel>,
    /// Whether the rule needs an estimate of wear.
    observes: bool,
    /// What it is shown of the edge.
    knows: Knowledge,
    /// What it does about chatter.
    stability: Option<Stability>,
}

/// A believed model at a nominal cut.
#[derive(Clone, Debug, PartialEq)]
struct BelievedModel {
    /// Pair, its speed limits narrowed to the machine's.
    pair: Arc<Pair>,
    /// Feed and depth as programmed.
    cut: toolroom_wear::Cut,
    /// Path of the pass as programmed, m.
    path: f64,
    /// Scatter of the allowance that the observer reckons with, m.
    allowance: f64,
    /// Scatter of wear from edge to edge that it reckons with, logarithm.
    edge_scatter: f64,
}

impl BelievedModel {
    /// The highest speed of the pair's range at which an edge keeps clear of thermal collapse,
    /// m/s; `flank_wear` is that of the edge at a speed, m.
    fn safe_speed(&self, flank_wear: impl Fn(f64) -> f64) -> f64 {
        self.pair.safe_speed(&self.cut, flank_wear)
    }
}

/// How the speed is found.
#[derive(Clone, Debug, PartialEq)]
enum Speed {
    Fixed(f64),
    Schedule(Arc<SpeedSchedule>),
    Planned(Arc<Planned>),
    SetIncrement(SetIncrement),
}

impl Controller {
    /// The command for a pass, always within the limits of the machine.
    pub fn choose(&self, observation: &Observation<'_>) -> Conditions {
        let conditions = match (&self.speed, &self.believed) {
            (Speed::Fixed(speed), _) => Conditions::constant(*speed),
            (Speed::Schedule(schedule), _) => schedule::conditions(schedule, observation),
            (Speed::Planned(planned), Some(believed)) => planned.conditions(believed, observation),
            (Speed::SetIncrement(set), Some(believed)) => set.conditions(believed, observation),
            (Speed::Planned(_) | Speed::SetIncrement(_), None) => Conditions::constant(self.range.1), // only made with a believed model
        };
        let limited = |speed: f64| speed.max(self.range.0).min(self.range.1);
        let conditions = Conditions::ramp(limited(conditions.start_speed), limited(conditions.end_speed));
        match &self.stability {
            Some(rule) => rule.applied(conditions, observation, self.range),
            None => conditions,
        }
    }

    /// What this controller does about chatter.
    pub fn stability(&self) -> Option<&Stability> {
        self.stability.as_ref()
    }

    /// The speed to go to after chatter at a measured `frequency` (Hz) and `speed`, m/s.
    pub fn reaction(&self, frequency: f64, speed: f64, tried: &[f64]) -> Option<f64> {
        self.stability.as_ref()?.reaction(frequency, speed, tried, self.range)
    }

    /// Whether this controller is shown the true wear.
    pub fn sees_true_wear(&self) -> bool {
        self.knows != Knowledge::Sensors && self.believed.is_some()
    }

    /// Whether this controller is shown how the edge differs from the nominal one.
    pub fn sees_edge(&self) -> bool {
        self.knows == Knowledge::Edge && self.believed.is_some()
    }

    /// Time between sensor samples, s.
    pub fn sampling_period(&self) -> f64 {
        self.sensors.sampling_period
    }

    /// The controller's sensors.
    pub fn sensors(&self) -> &SensorSheet {
        &self.sensors
    }

    /// An observer for an edge, where this controller needs one: of a new edge, or of one whose flank wear, m, was read
    /// just now. `before` is the observer of the edge before on the same machine, from which a new one learns.
    pub fn observer(&self, reading: Option<f64>, before: Option<&Observer>) -> Option<Observer> {
        let believed = self.believed.as_ref().filter(|_| self.observes)?;
        Some(match before.filter(|_| reading.is_none()) {
            Some(before) => before.next_edge(believed, &self.sensors),
            None => Observer::new(believed, &self.sensors, self.reading_limit().is_some(), reading),
        })
    }

    /// The nominal cut of a pass, for the observer.
    pub fn nominal_cut(&self) -> Option<&toolroom_wear::Cut> {
        self.believed.as_ref().map(|believed| &believed.cut)
    }

    /// Draws the error of a flank wear reading, m.
    pub fn reading_error(&self, stream: &mut Stream) -> f64 {
        let z: f64 = StandardNormal.sample(stream);
        self.sensors.flank_wear * z
    }

    /// Flank wear at whose reading an edge is changed, m; `None` where nobody reads.
    pub fn reading_limit(&self) -> Option<f64> {
        match self.change {
            ChangeRule::WearLimit(limit) => Some(limit),
            ChangeRule::PartCount(_) | ChangeRule::CuttingTime(_) | ChangeRule::Predicted(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cut, PolicyRule, SpeedRule, ToolChangeRule};
    use proptest::prelude::*;

    /// Every speed rule that a file can name, and the productivity rule at a price of its own.
    fn rules() -> Vec<SpeedRule> {
        let mut rules = crate::speed::examples();
        rules.push(SpeedRule::Productivity { price: Some(2.0) });
        rules
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn no_policy_leaves_the_limits_of_the_machine(
            rule in 0..rules().len(),
            set in 0..toolroom_wear::PARAMETER_SETS.len(),
            low in 0.05..3.0f64,
            width in 0.0..4.0f64,
            programmed in 0.05..6.0f64,
            path in 1e-3..500.0f64,
            edge_path in 0.0..5000.0f64,
            last in proptest::option::of(0.05..6.0f64),
            wear in 0.0..2e-3f64,
        ) {
            let pair = Pair::named(toolroom_wear::PARAMETER_SETS[set].0).unwrap();
            let policy = PolicyRule {
                name: "test".to_owned(),
                speed: rules()[rule],
                tool_change: ToolChangeRule::Predicted { limit: None },
                ..PolicyRule::default()
            };
            let cut = Cut {
                cutting_speed: programmed,
                feed: pair.temperature.reference_feed,
                depth_of_cut: pair.temperature.reference_depth,
                width_of_cut: 0.0,
                path_length: path, ..Cut::default() };
            let range = (low, low + width);
            let controller = resolve::for_turning(&policy, &pair, &cut, range);
            let observer = controller.observer(Some(wear), None);
            let observation = Observation {
                path,
                edge_path,
                edge_time: 60.0,
                edge_parts: 3,
                last_speed: last,
                observer: observer.as_ref(),
                reaction: None,
                true_wear: controller.sees_true_wear().then_some(wear),
                true_edge: None,
            };
            let conditions = controller.choose(&observation);
            for speed in [conditions.start_speed, conditions.end_speed] {
                prop_assert!(range.0 <= speed && speed <= range.1, "{:?}: {speed} outside {range:?}", policy.speed);
            }
            prop_assert!(conditions.duration(path) > 0.0);
            controller.change_due(&observation, &conditions, conditions.duration(path));
        }
    }
}
