//! The comparison axis: how speed is chosen, how cycles and contours are run, when an edge is
//! changed or dressed.

use super::{ContourRule, DressingRule, GrindingRule, SpeedRule, StabilityRule, Tunable};
use toolroom_form::vocabulary;
use toolroom_wear::Pair;

/// One policy.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyRule {
    /// Name, unique.
    pub name: String,
    /// How the cutting speed of turning passes is chosen; milling runs as programmed.
    pub speed: SpeedRule,
    /// Factor on the speed that the rule commands, 1.
    pub speed_factor: f64,
    /// What a rule that follows wear knows of the edge.
    pub knows: Knowledge,
    /// What is done about chatter.
    pub stability: StabilityRule,
    /// When an edge is changed.
    pub tool_change: ToolChangeRule,
    /// How designed plunge cycles are run.
    pub grinding: GrindingRule,
    /// When a wheel is dressed.
    pub dressing: DressingRule,
    /// How contours are planned; `None`: as each operation says.
    pub contour: Option<ContourRule>,
    /// Tool and work material that the controller believes in, where they are not the tool's own.
    pub believed_model: Option<Pair>,
    /// Sensors of adaptive rules.
    pub sensors: SensorSheet,
    /// Whether and within what the policy is tuned before a fair comparison.
    pub tune: Tunable,
}

impl PolicyRule {
    /// What the rule knows of the edge: an oracle knows its wear at least.
    pub fn knowledge(&self) -> Knowledge {
        match (self.speed, self.knows) {
            (SpeedRule::Oracle, Knowledge::Sensors) => Knowledge::Wear,
            (_, knows) => knows,
        }
    }
}

vocabulary! {
    /// What a rule that follows wear knows of the edge. More than sensors is a bound that no real controller reaches.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Knowledge {
        /// What its sensors and the readings of wear tell.
        Sensors = "sensors",
        /// The true flank wear.
        Wear = "wear",
        /// The true flank wear, and how this edge differs from the nominal one.
        Edge = "edge",
    }
}

impl Default for PolicyRule {
    /// Everything as programmed; edges are changed and wheels dressed at their own limits.
    fn default() -> Self {
        Self {
            name: "programmed".to_owned(),
            speed: SpeedRule::Programmed,
            speed_factor: 1.0,
            knows: Knowledge::Sensors,
            stability: StabilityRule::Ignore,
            tool_change: ToolChangeRule::WearLimit { limit: None },
            grinding: GrindingRule::default(),
            dressing: DressingRule::default(),
            contour: None,
            believed_model: None,
            sensors: SensorSheet::default(),
            tune: Tunable::default(),
        }
    }
}

/// When an edge is changed; decided between passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolChangeRule {
    /// When the wear read after a pass, with its reading error, reaches this limit.
    WearLimit {
        /// Flank wear, m; `None`: the tool's wear limit.
        limit: Option<f64>,
    },
    /// After so many parts.
    PartCount {
        /// Parts per edge.
        parts: u32,
    },
    /// Before the cutting time would pass this.
    CuttingTime {
        /// Cutting time per edge, s.
        time: f64,
    },
    /// Before the next pass would bring the estimated wear past the limit. Where nothing can be
    /// estimated (milling) the edge is read after every pass instead.
    Predicted {
        /// Flank wear, m; `None`: the tool's wear limit.
        limit: Option<f64>,
    },
}

impl ToolChangeRule {
    /// Its word in files.
    pub const fn word(self) -> &'static str {
        match self {
            Self::WearLimit { .. } => "wear_limit",
            Self::PartCount { .. } => "part_count",
            Self::CuttingTime { .. } => "cutting_time",
            Self::Predicted { .. } => "predicted",
        }
    }
}

/// What an adaptive controller measures, and how well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorSheet {
    /// Time between samples, s.
    pub sampling_period: f64,
    /// Relative standard deviation of spindle power, 1.
    pub spindle_power: f64,
    /// Relative standard deviation of feed force, 1.
    pub feed_force: f64,
    /// Relative standard deviation of thermo-EMF, 1.
    pub thermo_emf: f64,
    /// Systematic relative error of the thermo-EMF on top of its scatter, 1.
    pub thermo_emf_bias: f64,
    /// Systematic relative error of the feed force, 1.
    pub feed_force_bias: f64,
    /// Systematic relative error of the spindle power, 1.
    pub spindle_power_bias: f64,
    /// Standard deviation of a flank wear reading, m.
    pub flank_wear: f64,
    /// Time that a flank wear reading takes, s.
    pub reading_time: f64,
    /// Passes from one reading to the next.
    pub read_every: u32,
    /// Systematic error of the feed force that an observer reckons with where wear is read, logarithm.
    pub feed_force_gain: f64,
    /// The same of the thermo-EMF.
    pub thermo_emf_gain: f64,
    /// Relative standard deviation of a measured chatter frequency, 1.
    pub dominant_frequency: f64,
    /// Standard deviation of the normal force in grinding, N.
    pub normal_force: f64,
    /// Systematic relative error of that force, 1.
    pub normal_force_bias: f64,
}

impl Default for SensorSheet {
    /// Noise of the observer's derivation: 6 s, 1.5 %, 3 %, 1.5 %, no bias, 0.01 mm
    /// (assumptions of the reconstruction); wear is read after every pass in no time, as gauging beside the cut would; gains
    /// known to 5 % and 2 % (assumptions); 2 N in grinding, as in the separability study of plunge trials (assumption).
    fn default() -> Self {
        Self {
            sampling_period: 6.0,
            spindle_power: 0.015,
            feed_force: 0.03,
            thermo_emf: 0.015,
            thermo_emf_bias: 0.0,
            feed_force_bias: 0.0,
            spindle_power_bias: 0.0,
            flank_wear: 1e-5,
            reading_time: 0.0,
            read_every: 1,
            feed_force_gain: 0.05,
            thermo_emf_gain: 0.02,
            dominant_frequency: 0.005,
            normal_force: 2.0,
            normal_force_bias: 0.0,
        }
    }
}
