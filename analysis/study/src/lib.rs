//! What simulated runs say: policies compared on common random numbers, with intervals, logs,
//! pictures and a decision.
//!
//! ```text
//!             study: every policy, many replications, in parallel
//! Scenario ──►  RunLog ──► kpi ──► statistics ──► compare ──► terminal, summary.json
//!                  │                                 │
//!                  ├──► logs: Parquet, CSV           └──► report ──► chart, page: report.html
//!                  │                                              results: the whole directory
//!                  └──► trace.json
//! ```
//!
//! | module | what it does |
//! |---|---|
//! | [`kpi`] | key figures of one run, ISO 22400-2 time elements |
//! | [`study`] | replications of policies in parallel, stop by precision, bounded memory |
//! | [`compare`] | differences, cell gain and shop gain, bottleneck, decision |
//! | [`draws`] | draws of a posterior from Parquet files, for scenarios |
//! | [`groups`] | figures by part type, customer and station |
//! | [`logs`] | tables of passes, edges, jobs, states and events as Parquet or CSV |
//! | [`trace`] | machines as tracks for the Perfetto viewer |
//! | [`StatisticsWanted`] | the section `[statistics]` of a scenario |
//! | [`summary`], [`terminal`], [`report`] | the comparison for programs, terminals and browsers |
//! | [`results`] | all files of a study |
//! | [`difference`] | two finished runs against each other, paired where they share random numbers |
//! | [`request`] | what a study was asked to do: the condition for going on with it |
//! | [`sweep`] | the comparison at several values of one key |
//! | [`tune`](mod@tune) | the best settings of every policy, found before they are compared |
//! | [`variants`] | variants of the shop, paired with the shop as it is |
//! | [`planned`] | comparisons in shards on many hosts |
//! | [`planner`] | when orders are finished, load by week, queues |
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//! use toolroom_study::{compare::Comparison, study::{StudyOptions, run_study}};
//! let path = std::path::Path::new("../../scenarios/demo.toml");
//! let scenario = toolroom_scenario_file::read(path, &[])?.scenario;
//! let options = StudyOptions { policies: vec![0, 3], replications: 2, ..StudyOptions::of(&scenario) };
//! let study = run_study(&scenario, &options, None, &|_| {}, &AtomicBool::new(false))?;
//! let comparison = Comparison::new(&scenario, &study);
//! assert_eq!((comparison.policies.len(), comparison.differences.len()), (2, 1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is not modelled
//! Steady state is not detected: the warm-up is what the scenario says. Intervals assume that the
//! replications are independent and their means nearly normal; they are not corrected for comparing
//! many policies at once (the verdict between tuned rules is), nor for stopping when an interval is narrow. The Amdahl limit knows mean
//! loads, not queues. Money is not discounted, and the cost of good parts' material, of sensors and
//! of programming is left out.

#![deny(clippy::wildcard_enum_match_arm)]

pub mod compare;
pub mod difference;
pub mod draws;
mod figure;
#[cfg(test)]
mod fixture;
pub mod groups;
pub mod logs;
pub mod planned;
pub mod planner;
pub mod report;
pub mod request;
pub mod results;
mod run_info;
mod statistics_section;
pub mod study;
pub mod summary;
pub mod sweep;
pub mod terminal;
pub mod trace;
pub mod tune;
pub mod variants;

pub use statistics_section::{StatisticsError, StatisticsWanted};
pub use toolroom_kpi as kpi;
