//! Published numbers beside computed ones, for every model.
//!
//! Each model states its claims: what a publication says, what the model computes, and how near the two have to be.
//!
//! # What is not modelled
//! A claim that holds says nothing of other points of the model; the tests of each model go further.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod dynamics;
mod shop;
mod statistics;

use rayon::prelude::*;
use serde_json::{Value, json};
use std::fmt::{Display, Write};
use std::sync::atomic::{AtomicU32, Ordering};
use toolroom_form::significant;
use toolroom_process::Claim;

/// A model that cannot compute its own claims.
#[derive(Debug, thiserror::Error)]
#[error("{model}: {reason}")]
pub struct ClaimsError {
    /// The model.
    pub model: &'static str,
    /// What it says.
    pub reason: String,
}

/// The claims of every model, with its name.
#[derive(Clone, Debug)]
pub struct Claims(Vec<(&'static str, Claim)>);

impl Claims {
    /// Computes the claims of every model, models beside each other: it takes minutes. `progress` hears how many models are
    /// done, of how many.
    ///
    /// # Errors
    /// [`ClaimsError`]: a model that refuses a point of its own.
    ///
    /// ```no_run
    /// let claims = toolroom_claims::Claims::new(&|_, _| {}).unwrap();
    /// assert!(claims.count() > 10 && claims.failed() == 0);
    /// assert_eq!(claims.json().as_array().map(Vec::len), Some(claims.count()));
    /// ```
    pub fn new(progress: &(dyn Fn(u32, u32) + Sync)) -> Result<Self, ClaimsError> {
        let (done, all) = (AtomicU32::new(0), MODELS.len() as u32);
        let of_model = |(model, claims): &(&'static str, ModelClaims)| {
            let found = claims().map_err(|reason| ClaimsError { model, reason })?;
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, all);
            Ok(found.into_iter().map(|claim| (*model, claim)).collect::<Vec<_>>())
        };
        let found: Result<Vec<_>, ClaimsError> = MODELS.par_iter().map(of_model).collect();
        Ok(Self(found?.concat()))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// How many do not hold.
    pub fn failed(&self) -> usize {
        self.0.iter().filter(|(_, claim)| !claim.pass()).count()
    }

    /// For programs, one entry a claim.
    pub fn json(&self) -> Value {
        let row = |(model, claim): &(&str, Claim)| {
            json!({
                "model": model,
                "claim": claim.claim,
                "source": claim.source,
                "published": claim.published,
                "computed": claim.computed,
                "tolerance": claim.tolerance,
                "pass": claim.pass(),
            })
        };
        self.0.iter().map(row).collect()
    }

    /// For a terminal, two lines a claim under the name of its model.
    pub fn text(&self) -> String {
        let mut text = format!("{:>12} {:>12} {:>9}  claim", "published", "computed", "within");
        let mut last = "";
        for (model, claim) in &self.0 {
            if *model != last {
                let _ = write!(text, "\n{model}");
            }
            last = model;
            let within = if claim.published == 0.0 {
                significant(claim.tolerance)
            } else {
                format!("{} %", significant(100.0 * claim.tolerance))
            };
            let mark = if claim.pass() { "" } else { "   DOES NOT HOLD" };
            let _ = write!(
                text,
                "\n{:>12} {:>12} {within:>9}  {}{mark}\n{:37}{}",
                significant(claim.published),
                significant(claim.computed),
                claim.claim,
                "",
                claim.source,
            );
        }
        text
    }
}

/// What a model claims, or why it cannot say.
type ModelClaims = fn() -> Result<Vec<Claim>, String>;

/// Every model, in the order of the table.
const MODELS: &[(&str, ModelClaims)] = &[
    ("wear", || described(toolroom_wear::claims())),
    ("milling", || Ok(toolroom_cutting::milling::claims())),
    ("chatter", || described(toolroom_chatter::claims())),
    ("dynamics", || described(dynamics::claims())),
    ("infeed", || described(toolroom_infeed::claims())),
    ("contour", || described(toolroom_contour::claims())),
    ("life", || described(toolroom_life::claims())),
    ("shop", || described(shop::claims())),
    ("statistics", || Ok(statistics::claims())),
];

fn described<E: Display>(claims: Result<Vec<Claim>, E>) -> Result<Vec<Claim>, String> {
    claims.map_err(|error| error.to_string())
}
