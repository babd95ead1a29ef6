//! The shop as a whole: exact results of others, conservation, common random numbers, branching,
//! interruptions.

mod adaptive;
mod ages;
mod anything;
mod breakdowns;
mod cards;
mod chatter;
mod conservation;
mod contours;
mod control;
mod crews_transport;
mod cribs;
mod cycles;
mod dated_shifts;
mod dispatching;
mod draws;
mod fixtures;
mod grinding;
mod in_process;
#[path = "../../../kernel/tests/kernel/instances.rs"]
mod instances;
mod interruptions;
mod jobs_flow;
mod lots;
mod names;
mod operators;
mod orders;
mod own_times;
mod paces;
mod part_programs;
mod pieces;
mod places;
mod plain_shops;
mod queues;
mod replay;
mod scenarios;
mod sequences;
mod setups;
mod shifts;
#[path = "../../../kernel/tests/kernel/statistics.rs"]
mod statistics;
mod stocks;
mod tables;
mod tools;
