//! Figures of a block of operations: what is measured of it, each a channel.

use crate::{ChannelId, Transform};
use std::ops::{Index, IndexMut};

/// What is measured of a block: a channel each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Median time in cut.
    CuttingTime,
    /// Long outliers of the times in cut, less short ones.
    CuttingTail,
    /// Mean of the times in cut over their median.
    CuttingExcess,
    /// Scatter of the times in cut.
    CuttingSpread,
    /// Median handling time.
    HandlingTime,
    /// Scatter of the handling times.
    HandlingSpread,
    /// Median time of a tool change.
    ToolChangeTime,
    /// Mean time of a hold.
    FeedHoldTime,
    /// Booked short stops.
    StopCount,
    /// Mean life of edges.
    EdgeLife,
    /// How far times between breakdowns are from those of chance.
    FailureInterval,
}

impl Figure {
    /// Every figure.
    pub const ALL: [Self; 11] = [
        Self::CuttingTime,
        Self::CuttingTail,
        Self::CuttingExcess,
        Self::CuttingSpread,
        Self::HandlingTime,
        Self::HandlingSpread,
        Self::ToolChangeTime,
        Self::FeedHoldTime,
        Self::StopCount,
        Self::EdgeLife,
        Self::FailureInterval,
    ];

    /// Its channel.
    pub const fn channel(self) -> ChannelId {
        match self {
            Self::CuttingTime => ChannelId::CuttingTime,
            Self::CuttingTail => ChannelId::CuttingTail,
            Self::CuttingExcess => ChannelId::CuttingExcess,
            Self::CuttingSpread => ChannelId::CuttingSpread,
            Self::HandlingTime => ChannelId::HandlingTime,
            Self::HandlingSpread => ChannelId::HandlingSpread,
            Self::ToolChangeTime => ChannelId::ToolChangeTime,
            Self::FeedHoldTime => ChannelId::FeedHoldTime,
            Self::StopCount => ChannelId::StopCount,
            Self::EdgeLife => ChannelId::EdgeLife,
            Self::FailureInterval => ChannelId::FailureInterval,
        }
    }

    /// SI unit of its numbers.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::CuttingTime | Self::HandlingTime | Self::ToolChangeTime | Self::FeedHoldTime | Self::EdgeLife => "s",
            Self::CuttingTail
            | Self::CuttingExcess
            | Self::CuttingSpread
            | Self::HandlingSpread
            | Self::StopCount
            | Self::FailureInterval => "1",
        }
    }

    /// How its numbers are compared: by their logarithm, but for those that may be zero.
    pub const fn transform(self) -> Transform {
        match self {
            Self::CuttingTail | Self::FeedHoldTime | Self::StopCount | Self::FailureInterval => Transform::Linear,
            Self::CuttingTime
            | Self::CuttingExcess
            | Self::CuttingSpread
            | Self::HandlingTime
            | Self::HandlingSpread
            | Self::ToolChangeTime
            | Self::EdgeLife => Transform::Log,
        }
    }

    /// Whether it lives on the few operations of a block that were stopped.
    pub const fn is_rare(self) -> bool {
        matches!(
            self,
            Self::CuttingTail | Self::CuttingExcess | Self::CuttingSpread | Self::FeedHoldTime | Self::StopCount
        )
    }
}

/// A number for each figure of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures([f64; Figure::ALL.len()]);

impl Figures {
    /// The same number for each.
    pub const fn all(value: f64) -> Self {
        Self([value; Figure::ALL.len()])
    }
}

impl Index<Figure> for Figures {
    type Output = f64;

    fn index(&self, figure: Figure) -> &f64 {
        &self.0[figure as usize]
    }
}

impl IndexMut<Figure> for Figures {
    fn index_mut(&mut self, figure: Figure) -> &mut f64 {
        &mut self.0[figure as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_a_place_and_a_channel_of_its_own() {
        let mut figures = Figures::all(0.0);
        for (i, figure) in Figure::ALL.into_iter().enumerate() {
            figures[figure] = 1.0 + i as f64;
            assert!(Figure::ALL[..i].iter().all(|before| before.channel() != figure.channel()), "{figure:?}");
        }
        for (i, figure) in Figure::ALL.into_iter().enumerate() {
            assert_eq!(figures[figure], 1.0 + i as f64);
        }
    }
}
