//! Why records cannot be calibrated on.

use toolroom_form::significant;

/// Flank wear in mm that a reading microscope just resolves (assumption: a third of the usual error of a reading). Where no
/// reading reaches it, the unit is wrong.
pub(crate) const LEAST: f64 = 0.003;
/// Flank wear in mm that no edge survives (assumption; the column of records has the same bound).
pub(crate) const MOST: f64 = 5.0;
/// Units of flank wear in tables, with their names and their sizes in mm, the more usual first.
const UNITS: [(&str, &str, f64); 4] =
    [("mm", "millimetres", 1.0), ("um", "micrometres", 1e-3), ("m", "metres", 1e3), ("in", "inches", 25.4)];

/// The unit in which readings of `greatest` mm, read in `unit`, would be flank wear, where there is one.
fn meant(greatest: f64, unit: &str) -> String {
    let Some((_, _, size)) = UNITS.iter().find(|(known, ..)| *known == unit) else { return String::new() };
    let fits =
        |(known, _, other): &&(&str, &str, f64)| *known != unit && (LEAST..=MOST).contains(&(greatest / size * other));
    let told = |(unit, name, _): &(&str, &str, f64)| format!("; they look like {name}: write flank_wear [{unit}]");
    UNITS.iter().find(fits).map_or_else(String::new, told)
}

/// Why records cannot be calibrated on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// A column without which nothing can be told.
    #[error("the records have no column `{0}`")]
    NoColumn(String),
    /// A column of words that is to tell groups of edges.
    #[error("--by {column}: {what}")]
    Groups {
        /// What was wanted.
        column: String,
        /// What is wrong.
        what: String,
    },
    /// A word in `edge_end` that means nothing.
    #[error("edge `{edge}`: {place}: edge_end is `{read}`; it is one of worn, chipped, broken, stopped, changed")]
    End {
        /// The edge.
        edge: String,
        /// Where it stands.
        place: String,
        /// What was read.
        read: String,
    },
    /// A life, an inspection or a cutting time that cannot be.
    #[error("edge `{edge}`: {what}")]
    Value {
        /// The edge.
        edge: String,
        /// What is wrong.
        what: String,
    },
    /// Readings of flank wear that no edge has.
    #[error(
        "the greatest reading of flank_wear is {} mm, and flank wear lies between {LEAST} and {MOST} mm: check its \
         unit{}",
        significant(*greatest),
        meant(*greatest, unit)
    )]
    Unit {
        /// The greatest reading, mm.
        greatest: f64,
        /// The unit in which it was read.
        unit: String,
    },
    /// Records that say nothing of how edges wear.
    #[error(
        "no row has a flank_wear, and no edge_end says `worn`: nothing tells how fast edges wear; add the column \
         `flank_wear [mm]`, or give lives: tool_id, the cut and `life [min]`"
    )]
    NoWear,
    /// No edge with a reading or a life.
    #[error("no edge has a reading of flank_wear or a life")]
    Nothing,
}
