//! The kernel against exact results that others derived: queues, lines, repair models, job shops.

mod breakdowns;
mod instances;
mod job_shop;
mod line;
mod order;
mod queues;
mod replay;
mod statistics;
mod stochastic_shop;
