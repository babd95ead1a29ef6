//! Why a point cannot be evaluated.

use crate::change::ChangeError;
use toolroom_effects::EffectError;
use toolroom_form::nearest;
use toolroom_location::{Located, Location};
use toolroom_process::ModelError;
use toolroom_process::unit::UnitError;

/// Why a point cannot be evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// An effect that is none, or not one of the process.
    #[error(transparent)]
    Effect(EffectError),
    /// A parameter set of turning or milling.
    #[error(transparent)]
    Pair(#[from] toolroom_wear::SetError),
    /// A parameter set of grinding.
    #[error(transparent)]
    Set(#[from] toolroom_infeed::SetError),
    /// A change that is none, or that the field refuses.
    #[error("--set {0}")]
    Change(#[from] ChangeError),
    /// A group of parameters that the process does not have.
    #[error("there is no parameter group `{group}`")]
    NoGroup {
        /// The group.
        group: String,
        /// Groups that there are.
        known: Vec<&'static str>,
    },
    /// A parameter that the group does not have.
    #[error("`{group}` has no parameter `{name}`")]
    NoParameter {
        /// The group.
        group: String,
        /// The parameter.
        name: String,
        /// Parameters that there are.
        known: Vec<&'static str>,
    },
    /// Neither an input nor a state.
    #[error("{process} has no input or state `{key}`")]
    NoValue {
        /// Name of the process.
        process: &'static str,
        /// The key.
        key: String,
        /// Inputs and states that there are.
        known: Vec<&'static str>,
    },
    /// An axis that is given twice, or beside a change of the same value.
    #[error("`{key}` is given twice")]
    Twice {
        /// The key.
        key: String,
    },
    /// Axes of different lengths.
    #[error("`{key}` has {found} values, and the axes before it have {expected}")]
    Lengths {
        /// The axis.
        key: String,
        /// Number of its values.
        found: usize,
        /// Number of values of the others.
        expected: usize,
    },
    /// A point of a grid that is refused.
    #[error("point {index}: {source}")]
    Row {
        /// Which point, from 0.
        index: usize,
        /// Why.
        source: Box<PointError>,
    },
    /// A time of the advance that is none.
    #[error("--advance: {0}")]
    AdvanceTime(UnitError),
    /// A time of the advance longer than any edge or wheel is used: it could be computed for hours.
    #[error("--advance: {seconds} s is more than {most} s")]
    AdvanceTooLong {
        /// What was given, s.
        seconds: f64,
        /// The most that is taken, s.
        most: f64,
    },
    /// The process cannot be advanced.
    #[error("--advance: {0}")]
    Advance(ModelError),
    /// An effect of a user that gives no value at the point, on the way to it, or in the life of the tool.
    #[error(transparent)]
    Value(ModelError),
}

impl Located for PointError {
    fn location(&self) -> Option<Location> {
        if let Self::Pair(error) = self { error.location() } else { None }
    }
}

impl PointError {
    /// What a process refuses while it is advanced.
    pub(super) fn of_advance(error: ModelError) -> Self {
        if error.code().is_some() { Self::Value(error) } else { Self::Advance(error) }
    }

    /// The likely way out.
    pub fn fix(&self) -> String {
        match self {
            Self::Effect(_) => "see toolroom effects".to_owned(),
            Self::Pair(_) | Self::Set(_) => "give --tool SET".to_owned(),
            Self::Change(error) => error.fix(),
            Self::NoGroup { known, .. } | Self::NoParameter { known, .. } => known.join(", "),
            Self::NoValue { key, known, .. } => {
                let near = nearest(key, known.iter().copied());
                let near = near.map_or(String::new(), |near| format!("did you mean `{near}`? "));
                format!("{near}inputs and states: {}; parameters as group.name", known.join(", "))
            }
            Self::Twice { .. } => "leave one of them out".to_owned(),
            Self::Lengths { .. } => "give every axis as many values as there are points".to_owned(),
            Self::Row { source, .. } => source.fix(),
            Self::AdvanceTime(_) | Self::AdvanceTooLong { .. } => "--advance \"10 s\"".to_owned(),
            Self::Advance(_) => "see the ranges above".to_owned(),
            Self::Value(_) => "toolroom explain effect-value".to_owned(),
        }
    }
}
