//! Comparison, key figures, logs and reports of finished runs.
//!
//! | module | what it does |
//! |---|---|
//! | [`chart`] | pictures as SVG text: plots, bars, Gantt charts, heat maps, waterfalls |
//! | [`statistics`] | means, t intervals, paired differences |
//! | [`page`] | the report, one HTML file that needs no script and no network |

pub mod chart;
pub mod page;
pub mod statistics;
