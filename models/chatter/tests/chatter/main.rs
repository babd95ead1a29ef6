//! Stability against literature, dense roots and simulations; what is refused.

mod convergence;
mod intervals;
mod literature;
mod refusals;
mod roots;
mod verdicts;
