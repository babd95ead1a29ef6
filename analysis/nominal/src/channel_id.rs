//! Ids of channels: what is measured and compared.

use std::cmp::Ordering;
use std::fmt;
use toolroom_form::vocabulary;
use toolroom_records::RecordColumn;

vocabulary! {
    /// A measured quantity that a nominal model predicts. Inside the program channels are told apart by this type alone;
    /// its word is the column of the records, or the figure of a log that is counted.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ChannelId {
        /// Width of the flank wear land.
        FlankWear = "flank_wear",
        /// Cutting force.
        CuttingForce = "cutting_force",
        /// Feed force.
        FeedForce = "feed_force",
        /// Passive force.
        PassiveForce = "passive_force",
        /// Power of the spindle.
        SpindlePower = "spindle_power",
        /// Torque of the spindle.
        SpindleTorque = "spindle_torque",
        /// Temperature of the cut.
        Temperature = "temperature",
        /// Thermo-EMF of tool and workpiece.
        ThermoEmf = "thermo_emf",
        /// Root mean square of the vibration.
        VibrationRms = "vibration_rms",
        /// Dominant frequency of the vibration.
        DominantFrequency = "dominant_frequency",
        /// Roughness Ra of the surface.
        RoughnessRa = "roughness_ra",
        /// Root mean square of the acoustic emission.
        AcousticEmissionRms = "acoustic_emission_rms",
        /// Form error of the part.
        FormError = "form_error",
        /// Stock that grinding has removed.
        StockRemoved = "stock_removed",
        /// Normal force of grinding.
        NormalForce = "normal_force",
        /// Tangential force of grinding.
        TangentialForce = "tangential_force",
        /// Revolutions until the force of grinding has risen.
        RiseRevolutions = "rise_revolutions",
        /// Force that spark-out leaves.
        ForceAfterSparkOut = "force_after_spark_out",
        /// Time of an operation from part to part.
        CycleTime = "cycle_time",
        /// Number of stops.
        StopCount = "stop_count",
        /// Time of stops.
        StopTime = "stop_time",
        /// Median time in cut.
        CuttingTime = "cutting_time",
        /// How many times in cut are long outliers, beyond those that are short.
        CuttingTail = "cutting_tail",
        /// Mean of the times in cut over their median.
        CuttingExcess = "cutting_excess",
        /// Scatter of the times in cut.
        CuttingSpread = "cutting_spread",
        /// Median time to load and unload.
        HandlingTime = "handling_time",
        /// Scatter of the times to load and unload.
        HandlingSpread = "handling_spread",
        /// Median time of a tool change.
        ToolChangeTime = "tool_change_time",
        /// Mean time of a feed hold.
        FeedHoldTime = "feed_hold_time",
        /// Mean life of edges.
        EdgeLife = "edge_life",
        /// How far times between breakdowns are from those of chance.
        FailureInterval = "failure_interval",
    }
}

impl ChannelId {
    /// The channel of a column of the records; `None` for a column that is none.
    pub fn from_record_column(column: &RecordColumn) -> Option<Self> {
        Self::from_word(column.name)
    }
}

/// Tables list channels by their words.
impl Ord for ChannelId {
    fn cmp(&self, other: &Self) -> Ordering {
        self.word().cmp(other.word())
    }
}

impl PartialOrd for ChannelId {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Display for ChannelId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_records::{ColumnKind, RecordKind};

    #[test]
    fn every_column_that_a_model_can_predict_is_a_channel() {
        for column in RecordKind::ALL.into_iter().flat_map(RecordKind::columns) {
            if column.kind == ColumnKind::Channel {
                assert!(ChannelId::from_record_column(column).is_some(), "{} has no id", column.name);
            }
        }
    }
}
