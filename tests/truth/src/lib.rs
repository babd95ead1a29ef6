//! Shops with a hidden effect, to check the gap diagnosis blindly.
//!
//! Nothing here knows the process models. Turning: forces follow Kienzle with an edge term, temperature
//! saturates, wear is abrasion with an exponential run-in plus diffusion, integrated by Runge and
//! Kutta in 24 steps an operation. Milling: teeth are followed one by one. Grinding: the work is
//! followed by its angle. Readings are rounded, noisy with memory and outliers.
//!
//! ```text
//!   suite(seed) ─► Case (process, hidden causes, seed, world) ─► Generator ─► CSV of records
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`suite()`] | every case of the blind benchmark |
//! | [`Case`] | what is hidden in a data set |
//! | [`Hidden`] | one hidden cause, in or out of the catalogue |
//! | [`Generator`] | a kind of shop: its causes, and the records of a case |
//!
//! A new process is one file with a `GENERATOR` and one line in [`GENERATORS`]; the suite, its
//! gates and tables follow.
//!
//! ```
//! use toolroom_truth::{Case, turning};
//! let csv = Case::null("turning", 1).records();
//! assert!(csv.starts_with("operation_id,"));
//! assert!(csv.lines().count() > turning::TOOLS * turning::OPERATIONS / 2);
//! ```
//!
//! # What is not modelled
//! Anything that would make the world real: it is as plausible as its author could make it without
//! looking at the models that it tests.

#![deny(clippy::wildcard_enum_match_arm)]

mod form;
pub mod grinding;
pub mod milling;
mod noise;
pub mod program;
mod shop;
mod steel;
mod suite;
pub mod turning;

pub use suite::{Extent, Set, suite};

/// A kind of shop whose records are diagnosed.
#[derive(Clone, Copy, Debug)]
pub struct Generator {
    /// Process, and name of the shipped nominal model (`scenarios/gap/<process>.toml`).
    pub process: &'static str,
    /// Causes of the catalogue that can be hidden here, with their ordinary size in the catalogue's
    /// display unit.
    pub effects: &'static [(&'static str, f64)],
    /// Causes that no catalogue has.
    pub outside: &'static [&'static str],
    /// Records of a case, as CSV.
    pub records: fn(&Case) -> String,
}

/// Every kind of shop.
pub const GENERATORS: &[Generator] =
    &[turning::GENERATOR, milling::GENERATOR, grinding::GENERATOR, program::GENERATOR, shop::GENERATOR];

/// One hidden cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hidden {
    /// Word of the catalogue, or of a cause outside it.
    pub id: &'static str,
    /// Strength: 1 is ordinary; below zero where a cause has two signs, as feed overrides of a shop have.
    pub strength: f64,
}

/// Whose readings are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edges {
    /// Those that are diagnosed.
    Diagnosed,
    /// New ones of the same shop, as are cut next; several times as many.
    New,
}

/// What is hidden in a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Process, a word of [`GENERATORS`].
    pub process: &'static str,
    /// What the case is to show.
    pub set: Set,
    /// Hidden causes; none in a null case.
    pub hidden: Vec<Hidden>,
    /// Seed of everything random.
    pub seed: u64,
    /// Scatter from group to group (edges, dressings) over the usual one of the shop.
    pub scatter: f64,
    /// A world whose forms differ more from those of common models.
    pub stress: bool,
    /// Whose readings.
    pub edges: Edges,
    /// Groups that are diagnosed (edges, dressings, days, runs) over their usual number.
    pub times: usize,
    /// How far the equations of the shop are off by a smooth function of the cut and of the land, as a root mean
    /// square share of forces and temperatures; zero leaves them as they are. Only turning has it, and milling as a wear curve
    /// that is faster late in life, by 12.5 times this share.
    pub form: f64,
}

impl Case {
    /// Nothing hidden.
    pub fn null(process: &'static str, seed: u64) -> Self {
        Self {
            process,
            set: Set::Null,
            hidden: Vec::new(),
            seed,
            scatter: 1.0,
            stress: false,
            edges: Edges::Diagnosed,
            times: 1,
            form: 0.0,
        }
    }

    /// One hidden cause.
    pub fn one(process: &'static str, id: &'static str, strength: f64, seed: u64) -> Self {
        Self { set: Set::Effect, hidden: vec![Hidden { id, strength }], ..Self::null(process, seed) }
    }

    /// The same shop on new edges.
    #[must_use]
    pub fn on_new_edges(&self) -> Self {
        Self { edges: Edges::New, ..self.clone() }
    }

    /// The records, as CSV.
    ///
    /// # Panics
    /// If no generator has this process.
    pub fn records(&self) -> String {
        let generator = GENERATORS.iter().find(|generator| generator.process == self.process);
        (generator.expect("a process of GENERATORS").records)(self)
    }

    /// Ordinary size of a cause times its strength, display unit of the catalogue; `None` for one
    /// that is not hidden here or is in no catalogue.
    pub fn size(&self, id: &str) -> Option<f64> {
        let generator = GENERATORS.iter().find(|generator| generator.process == self.process)?;
        let (_, size) = generator.effects.iter().find(|(known, _)| *known == id)?;
        self.hidden.iter().find(|hidden| hidden.id == id).map(|hidden| hidden.strength * size)
    }

    /// Strength of a cause; zero where it is not hidden here.
    pub(crate) fn strength(&self, id: &str) -> f64 {
        self.hidden.iter().find(|hidden| hidden.id == id).map_or(0.0, |hidden| hidden.strength)
    }

    /// Stream of random numbers: edges that are diagnosed and new ones differ, the shop does not.
    pub(crate) fn stream(&self) -> u64 {
        match self.edges {
            Edges::Diagnosed => 1,
            Edges::New => 2,
        }
    }
}
