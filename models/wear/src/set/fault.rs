//! What is wrong with a parameter set beyond its form.

use std::sync::Arc;
use toolroom_form::{ContentFault, Fault};
use toolroom_process::ModelError;

/// Most steps in a chain of `based_on` (assumption: longer ones are slips).
pub(super) const LONGEST_CHAIN: usize = 4;

/// A fault of a parameter set that only its reader knows.
#[derive(Debug, thiserror::Error)]
pub(super) enum SetFault {
    #[error("the set on which this one is based: {0}")]
    Base(String),
    #[error("`based_on` leads back to {0}")]
    Cycle(String),
    #[error("a chain of more than {LONGEST_CHAIN} sets, each based on the next")]
    Chain,
    #[error("{given} wear laws are given ({laws}), and `law` is left out")]
    Laws { given: usize, laws: String },
    #[error("no wear law: {0}")]
    NoLaw(String),
    #[error("law = \"{law}\", but nothing gives [parameters.{law}]")]
    LawWithoutGroup { law: &'static str },
    #[error("process = \"{read}\", where a set for {due} is due")]
    Process { read: String, due: &'static str },
    #[error("two sources for {key}: line {first} and line {second}")]
    TwoSources { key: String, first: usize, second: usize },
    #[error("{first} ({first_value}, line {first_line}) and {second} ({second_value}, line {second_line}) differ")]
    WearLimits {
        first: String,
        first_value: String,
        first_line: usize,
        second: String,
        second_value: String,
        second_line: usize,
    },
    #[error("{0}")]
    Implausible(String),
    #[error("prior of `{key}`: {reason}")]
    Prior { key: String, reason: &'static str },
    #[error("[parameters.{group}] lacks {names}")]
    Missing { group: &'static str, names: String },
    #[error("{0}")]
    Model(ModelError),
}

impl ContentFault for SetFault {
    fn code(&self) -> &'static str {
        "parameter-set"
    }

    fn fix(&self) -> Option<String> {
        Some(match self {
            Self::Laws { laws, .. } => format!("add `law = \"…\"` with one of {laws}"),
            Self::LawWithoutGroup { law } => {
                format!("add [parameters.{law}], or handbook constants that give it, or leave `law` out")
            }
            Self::TwoSources { .. } => "keep one of them".to_owned(),
            Self::WearLimits { .. } => {
                "a life belongs to one wear limit: state the same one, or the life at the other".to_owned()
            }
            Self::Missing { .. } => {
                "state them, or name a set that has them: `based_on` of a set with sources, `parameter_set` of a tool"
                    .to_owned()
            }
            Self::Prior { .. } => "write for example \"extended_taylor.speed_exponent\" = { factor = 1.35 }".to_owned(),
            Self::Process { due, .. } => format!("name a set with process = \"{due}\""),
            Self::Base(_) | Self::Cycle(_) | Self::Chain | Self::NoLaw(_) | Self::Implausible(_) | Self::Model(_) => {
                return None;
            }
        })
    }
}

impl From<SetFault> for Fault {
    fn from(fault: SetFault) -> Self {
        Self::Content(Arc::new(fault))
    }
}
