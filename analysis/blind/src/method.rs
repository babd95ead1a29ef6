//! The method of the diagnosis, whole and with parts left out.

use toolroom_gap::Method;
use toolroom_truth::{Case, Set};

/// The method with nothing left out.
pub(crate) const WHOLE: &str = "whole";

/// The whole method, to leave parts of it out.
pub(crate) const ALL: Method = Method::WHOLE;

/// What is left of the method without its parts.
pub(crate) const PARTS: [(&str, Method); 6] = [
    ("without form tolerance", Method { tolerance: false, ..ALL }),
    ("without abstention", Method { abstention: false, ..ALL }),
    ("without agreement of groups", Method { agreement: false, ..ALL }),
    ("without factors of edges", Method { scatter: false, ..ALL }),
    ("without form allowance", Method { allowance: false, ..ALL }),
    (
        "naive: no allowance, tolerance or abstention, white noise",
        Method { allowance: false, abstention: false, tolerance: false, memory: false, ..ALL },
    ),
];

/// Cases on which the parts are left out: a third of the effects at their ordinary strength and of
/// the nulls, half of the causes outside the catalogue.
pub(crate) fn in_ablation(case: &Case) -> bool {
    match case.set {
        Set::Effect => case.hidden.iter().all(|hidden| hidden.strength == 1.0) && case.seed.is_multiple_of(3),
        Set::Null => case.seed.is_multiple_of(3),
        Set::Outside => case.seed.is_multiple_of(2),
        Set::Pair | Set::HeavyNull | Set::Stress | Set::StressNull => false,
    }
}
