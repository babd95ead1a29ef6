//! Chatter in a scenario: how structures differ, what policies do about it.

/// How the structure of each machine differs from the one that the file describes: natural
/// frequencies and damping ratios, all modes of a machine alike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StructureScatter {
    /// Standard deviation of natural frequencies over nominal.
    pub natural_frequency: f64,
    /// Standard deviation of damping ratios over nominal.
    pub damping_ratio: f64,
}

/// What a policy does about chatter, on top of its speed rule. Rules other than
/// [`StabilityRule::Reactive`] work on the nominal structure; none sees the true one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StabilityRule {
    /// Nothing.
    #[default]
    Ignore,
    /// The speed near the programmed one at which the nominal limit is greatest.
    BestLobe,
    /// When chatter is heard: spindle speed to a whole fraction of the chatter frequency (Smith and
    /// Tlusty), for this and all later passes of the kind on the machine.
    Reactive {
        /// From chatter to the new speed, s.
        reaction_time: f64,
    },
    /// Sinusoidal spindle speed.
    SpeedVariation {
        /// Amplitude over the mean speed, RVA.
        amplitude: f64,
        /// Mean revolutions in a period, 1/RVF.
        revolutions: u32,
    },
    /// Layers no deeper than this share of the nominal limit.
    DepthReduction {
        /// Depth over limit.
        share: f64,
    },
    /// The speed near the programmed one at which stability is most probable under uncertain
    /// constants.
    RobustLobe {
        /// What the controller reckons with.
        uncertainty: Uncertainty,
    },
    /// The speed of the speed rule, moved to the nearest one whose nominal limit, at the wear that
    /// the observer believes, leaves a margin.
    Constraint {
        /// `1 − depth/limit` to be kept.
        margin: f64,
    },
}

/// Relative standard deviations of constants as a controller reckons with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// Of natural frequencies.
    pub natural_frequency: f64,
    /// Of damping ratios.
    pub damping_ratio: f64,
    /// Of cutting coefficients.
    pub coefficients: f64,
}
