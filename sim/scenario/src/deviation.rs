//! How a shop deviates from what its planner believes.

use super::{MachineType, ShiftCalendar};

/// An effect of the shop (a row of [`SHOP_EFFECTS`](crate::effects::SHOP_EFFECTS)) with its size.
///
/// | id | what it does |
/// |---|---|
/// | feed_override | time in cut grows by this share; added after the last pass, as cutting |
/// | feed_hold | the program is held for this time before its end, in a share of the operations; added as cutting |
/// | micro_stops | stops of an exponential duration, 20 s in the mean, come as a Poisson process in the time in cut; added there |
/// | operator_delay | time before loading, as handling |
/// | tool_change_delay | time of every change of an edge |
/// | tool_change_policy | edges are changed when the reading passes the limit by so much |
/// | breakdown_shape | exponential times between breakdowns become Weibull of shape 1 + size, mean kept |
///
/// # Source
/// Assumptions, as the rows of the catalogue say. The edge wears during its programmed passes only.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// Word of the catalogue.
    pub id: &'static str,
    /// Size, SI.
    pub size: f64,
    /// Shift in which it acts, `S1`, `S2` … in the order of the machine's calendar; always, if none.
    pub shift: Option<String>,
    /// Share of the operations that it concerns; of `feed_hold` only.
    pub share: f64,
}

/// Mean duration of a short stop, s (assumption of the catalogue).
pub const MICRO_STOP: f64 = 20.0;

impl Deviation {
    /// Effects that a simulated shop can have.
    pub const IDS: &'static [&'static str] = &[
        "feed_override",
        "feed_hold",
        "micro_stops",
        "operator_delay",
        "tool_change_delay",
        "tool_change_policy",
        "breakdown_shape",
    ];

    /// An effect that always acts on everything.
    pub fn new(id: &'static str, size: f64) -> Self {
        Self { id, size, shift: None, share: 1.0 }
    }

    /// Those of `id` that act on a machine at a time.
    pub fn acting<'a>(
        all: &'a [Self],
        id: &str,
        machine: &MachineType,
        calendars: &[ShiftCalendar],
        time: f64,
    ) -> impl Iterator<Item = &'a Self> {
        let shift = machine.calendar.and_then(|index| calendars[index].shift_at(time));
        let id = id.to_owned();
        all.iter()
            .filter(move |own| own.id == id && own.shift.as_ref().is_none_or(|wanted| shift.as_ref() == Some(wanted)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::SHOP_EFFECTS;

    #[test]
    fn every_deviation_is_a_row_of_the_catalogue() {
        assert!(Deviation::IDS.iter().all(|id| SHOP_EFFECTS.iter().any(|entry| entry.id == *id)));
    }
}
