//! What happens in a shop and is worth a line of its log.

use toolroom_process::ProcessEvent;

/// Declares the events of a shop: a line each, with its name in files.
macro_rules! events {
    ($($(#[doc = $doc:literal])+ $variant:ident = $name:literal,)+) => {
        /// What a line of the log of events is about.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum LogEvent {
            $($(#[doc = $doc])+ $variant,)+
            /// What a process reports of an edge in its cut.
            Cut(ProcessEvent),
        }

        impl LogEvent {
            /// Every event of the shop itself; what processes report is not among them.
            pub const OF_SHOP: &'static [Self] = &[$(Self::$variant),+];

            /// Name in files; that of the process event for what happens in a cut.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                    Self::Cut(event) => event.name(),
                }
            }
        }
    };
}

events! {
    /// A job enters the shop.
    Arrival = "arrival",
    /// A job that was held back is released.
    Release = "release",
    /// A job leaves the shop, good.
    Finish = "finish",
    /// A job leaves the shop for scrap.
    Scrap = "scrap",
    /// An inspection sends a job back.
    Rework = "rework",
    /// A more urgent job takes the machine of another.
    Preempt = "preempt",
    /// A job takes a card of a loop.
    Card = "card",
    /// A card is free again.
    CardReturn = "card_return",
    /// A machine is changed over to another setup group.
    Setup = "setup",
    /// An edge is changed.
    ToolChange = "tool_change",
    /// A grinding wheel is dressed.
    Dressing = "dressing",
    /// A cut is held.
    FeedHold = "feed_hold",
    /// A cut that was held goes on.
    FeedRelease = "feed_release",
    /// Jobs that wait for each other's places change them.
    Swap = "swap",
    /// A machine breaks down.
    Failure = "failure",
    /// A crew begins to repair.
    RepairStart = "repair_start",
    /// A machine is repaired.
    Repair = "repair",
    /// Planned maintenance is due.
    MaintenanceDue = "maintenance_due",
    /// Planned maintenance begins.
    Maintenance = "maintenance",
    /// Planned maintenance ends.
    MaintenanceEnd = "maintenance_end",
    /// A machine begins its shift.
    ShiftStart = "shift_start",
    /// A machine ends its shift.
    ShiftEnd = "shift_end",
    /// A vehicle takes up a job.
    Move = "move",
    /// A vehicle has brought a job.
    Delivery = "delivery",
    /// Pieces of a stock are ordered.
    Reorder = "reorder",
    /// Pieces that were ordered lie in their stock.
    Restock = "restock",
    /// Lost pieces of a lot begin anew.
    Replenish = "replenish",
    /// Edges lie in their crib.
    EdgesToCrib = "edges_to_crib",
    /// Edges are ordered.
    EdgesOrdered = "edges_ordered",
    /// Edges go to be ground again.
    EdgesToRegrind = "edges_to_regrind",
    /// A cut begins to chatter.
    ChatterOnset = "chatter_onset",
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_event_has_a_name_of_its_own() {
        use ProcessEvent::{Burn, Chipping, DressingDue, ThermalCollapse, WearLimit};
        let cuts = [WearLimit, ThermalCollapse, Chipping, Burn, DressingDue].map(LogEvent::Cut);
        let events: Vec<LogEvent> = LogEvent::OF_SHOP.iter().copied().chain(cuts).collect();
        let names: BTreeSet<&str> = events.iter().map(|event| event.name()).collect();
        assert_eq!(names.len(), events.len());
    }
}
