//! Words that choose among rules, processes and families of a scenario file.
//!
//! Each list is one table of word, meaning and variant. The key admits its words, and the reader
//! matches its variants without a wildcard: a new word does not compile before it has a reader.
//! Rules without numbers of their own, such as [`DispatchRule`](toolroom_scenario::DispatchRule), are such
//! lists themselves.

use toolroom_form::vocabulary;
use toolroom_scenario::MachineType;

/// The word of a tool of which only the life of its edges is known.
pub(super) const LIFE_ONLY: &str = "life_only";

vocabulary! {
    /// Processes that a machine can run.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum ProcessKind {
        /// Longitudinal turning.
        Turning = "turning",
        /// Peripheral and face milling.
        Milling = "milling",
        /// Cylindrical plunge grinding.
        Infeed = "infeed",
    }
}

impl ProcessKind {
    /// Words of what a machine can run: a process, or plain work alone.
    pub const OF_MACHINES: &'static [&'static str] = &{
        let mut words = [MachineType::PLAIN; Self::WORDS.len() + 1];
        let mut i = 0;
        while i < Self::WORDS.len() {
            words[i] = Self::WORDS[i];
            i += 1;
        }
        words
    };
    /// Words of what a tool can do: a process, or nothing of which more is known than how long its edges last.
    pub const OF_TOOLS: &'static [&'static str] = &{
        let mut words = [LIFE_ONLY; Self::WORDS.len() + 1];
        let mut i = 0;
        while i < Self::WORDS.len() {
            words[i] = Self::WORDS[i];
            i += 1;
        }
        words
    };
    /// Words of the processes whose edges cut passes at a commanded speed.
    pub const CUTTING: &'static [&'static str] = &[Self::Turning.word(), Self::Milling.word()];
    /// Words of those whose feed is given per tooth, with a width of cut.
    pub const PER_TOOTH: &'static [&'static str] = &[Self::Milling.word()];
}

vocabulary! {
    /// Where the code of an imported unit runs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum IsolationWord {
        /// In a worker process.
        Process = "process",
        /// In the program itself.
        None = "none",
    }
}

vocabulary! {
    /// Families of random times.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum FamilyWord {
        /// Always the mean.
        Constant = "constant",
        /// Exponential by its mean.
        Exponential = "exponential",
        /// Sum of equal exponential times, by mean and number of phases.
        Erlang = "erlang",
        /// Gamma by mean and coefficient of variation.
        Gamma = "gamma",
        /// Lognormal by mean and coefficient of variation.
        Lognormal = "lognormal",
        /// Weibull by mean and shape.
        Weibull = "weibull",
        /// Triangular by least, most likely and greatest.
        Triangular = "triangular",
        /// Beta by least, most likely and greatest, as estimated in PERT.
        Beta = "beta",
        /// The same, by the name that planners give it.
        Pert = "pert",
        /// Normal by mean and standard deviation, cut off at least and greatest.
        Normal = "normal",
        /// Uniform by least and greatest.
        Uniform = "uniform",
        /// Equally likely times at equal distances.
        DiscreteUniform = "discrete_uniform",
        /// Given times with their weights.
        Empirical = "empirical",
        /// A law of lives that `toolroom life` has fitted, from its summary.
        Fitted = "fitted",
    }
}

vocabulary! {
    /// When jobs come.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum PatternWord {
        /// Independent times between arrivals of any distribution.
        Renewal = "renewal",
        /// Poisson process.
        Poisson = "poisson",
        /// Lots at a fixed interval.
        Batch = "batch",
        /// Lots at given times.
        Schedule = "schedule",
        /// A constant number of jobs in the shop.
        ConstantWork = "constant_work",
    }
}

vocabulary! {
    /// When jobs that have come are let into the shop.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum ReleaseWord {
        /// At once.
        Immediate = "immediate",
        /// A fixed time before they are due.
        AtDate = "at_date",
        /// When the load of the stations lets them.
        Workload = "workload",
    }
}

vocabulary! {
    /// In which order a job goes through the operations of its part.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum RoutingWord {
        /// In that of the file.
        Fixed = "fixed",
        /// In one of its own, drawn when it comes.
        Random = "random",
    }
}

vocabulary! {
    /// When jobs of a source are due.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum DueWord {
        /// A multiple of their total work after they came.
        TotalWork = "TWK",
        /// Their total work and a constant slack after they came.
        Slack = "slack",
        /// The flow_allowance of the part after they came.
        Constant = "constant",
        /// A random time after they came.
        Random = "random",
    }
}

vocabulary! {
    /// Formats of the log tables.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum FormatWord {
        /// Parquet.
        Parquet = "parquet",
        /// Comma-separated values.
        Csv = "csv",
    }
}

vocabulary! {
    /// How wear grows with the age of an edge in an empirical model.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum GrowthWord {
        /// With a power of the age.
        Power = "power",
        /// At a constant rate.
        ConstantRate = "constant_rate",
    }
}

vocabulary! {
    /// What is done about chatter.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum ChatterWord {
        /// Nothing.
        Ignore = "ignore",
        /// The nearby speed of the greatest nominal limit.
        BestLobe = "best_lobe",
        /// Another speed once chatter is heard.
        Reactive = "reactive",
        /// Sinusoidal spindle speed.
        SpeedVariation = "speed_variation",
        /// Layers below the nominal limit.
        DepthReduction = "depth_reduction",
        /// The nearby speed of most probable stability.
        RobustLobe = "robust_lobe",
        /// The nearest speed that leaves a margin.
        Constraint = "constraint",
    }
}

vocabulary! {
    /// When an edge is changed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum ToolChangeWord {
        /// When the wear that is read reaches a limit.
        WearLimit = "wear_limit",
        /// After a number of parts.
        PartCount = "part_count",
        /// Before a cutting time is exceeded.
        CuttingTime = "cutting_time",
        /// Before the predicted wear exceeds a limit.
        Predicted = "predicted",
    }
}

vocabulary! {
    /// How designed grinding cycles are run.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum GrindingWord {
        /// As designed.
        Fixed = "fixed",
        /// Phases switch on the measured normal force.
        ForceAdaptive = "force_adaptive",
        /// Spark-out follows the measured time constant.
        TimeConstantAdaptive = "time_constant_adaptive",
    }
}

vocabulary! {
    /// When a wheel is dressed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum DressingWord {
        /// At the wheel's own dressing limit.
        Limit = "limit",
        /// After a number of parts.
        PartCount = "part_count",
        /// At a measured dulling.
        Dulling = "dulling",
    }
}

#[cfg(test)]
pub(crate) mod tests;
