//! Charts as SVG text, drawn without any other crate, and as PNG; and the report [`page`].
//!
//! ```text
//!   Axis ─► Scale ─┐
//!   Style ─────────┼─► Plot, Bars, StackedBars, Gantt, HeatMap, Waterfall … : Chart ─► svg(), png(), data()
//!   values ────────┘
//! ```
//!
//! Every picture has a title, a description, units on its axes and a legend in which colour is
//! never the only cue. It stands alone on white paper, and follows the colours of the page when it
//! is set into a [report](crate::page). It holds no identifiers, scripts or links, so any number of
//! charts can share one page.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod axis;
mod bars;
mod files;
mod frame;
mod gantt;
mod heat;
mod histogram;
mod layer;
mod lobes;
pub mod page;
mod plot;
mod px;
mod ranges;
mod raster;
mod rows;
mod stacked;
mod strip;
mod style;
mod svg;
mod table;
mod waterfall;

pub use axis::{Axis, number};
pub use bars::{Bars, Estimate};
pub use files::ResultFiles;
pub use gantt::Gantt;
pub use heat::{ColourMap, HeatMap};
pub use histogram::Histogram;
pub use lobes::{PointStability, StabilityLobes};
pub use plot::Plot;
pub use ranges::Intervals;
pub use raster::png;
pub use stacked::StackedBars;
pub use style::{Colour, Dash, Hatch, Marker, Style};
pub use svg::escape;
pub use table::{Cell, Table};
pub use waterfall::Waterfall;

pub(crate) use style::{rules, variables};

/// A picture with the data that it shows.
pub trait Chart {
    /// The title printed in the picture.
    fn title(&self) -> &str;
    /// The picture as an SVG document. Values that are not finite are left out and counted;
    /// without any value the picture says "no data".
    fn svg(&self) -> String;
    /// The data that the picture shows, complete.
    fn data(&self) -> Table;
}

/// The builder method that every chart has.
macro_rules! describe {
    () => {
        /// Sets the description that a screen reader reads.
        #[must_use]
        pub fn describe(mut self, text: impl Into<String>) -> Self {
            self.description = text.into();
            self
        }
    };
}
use describe;

#[cfg(test)]
mod tests;
