//! Words that choose among rules, samplings and distributions of a study file.

use toolroom_form::vocabulary;

vocabulary! {
    /// How points of the inputs are chosen.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum SamplingWord {
        /// Independently.
        Plain = "plain",
        /// In mirrored pairs.
        Antithetic = "antithetic",
        /// By a Latin hypercube.
        LatinHypercube = "latin_hypercube",
        /// By Sobol's sequence.
        Sobol = "sobol",
    }
}

vocabulary! {
    /// How the body of the tool warms up.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum BodyWord {
        /// At once.
        Steady = "steady",
        /// With a lag; it cools in pauses.
        Lagged = "lagged",
    }
}

vocabulary! {
    /// When the sensors are read.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum ReadingWord {
        /// At the end of every pass.
        Pass = "pass",
        /// Every sampling period.
        Period = "period",
    }
}

vocabulary! {
    /// Which ends of an edge are failures.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum FailureWord {
        /// Chipping and collapse.
        Cut = "cut",
        /// Reaching a limit as well.
        Limit = "limit",
    }
}

vocabulary! {
    /// What the oracle knows.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum KnowsWord {
        /// The wear of its edge.
        Wear = "wear",
        /// Also how the edge differs from the nominal one.
        Edge = "edge",
    }
}

vocabulary! {
    /// Families of distributions.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum FamilyWord {
        /// Normal.
        Normal = "normal",
        /// Lognormal by median and deviation of the logarithm.
        Lognormal = "lognormal",
        /// Weibull by scale and shape.
        Weibull = "weibull",
        /// Gamma by scale and shape.
        Gamma = "gamma",
        /// Triangular by least, most likely and greatest.
        Triangular = "triangular",
        /// Uniform by least and greatest.
        Uniform = "uniform",
        /// Beta between least and greatest.
        Beta = "beta",
        /// The values of a column of a table.
        Empirical = "empirical",
    }
}
