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

use serde_json::{Value, json};
use std::fmt::{Display, Write};
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
    /// Computes the claims of every model.
    ///
    /// # Errors
    /// [`ClaimsError`]: a model that refuses a point of its own.
    ///
    /// ```
    /// let claims = toolroom_claims::Claims::new().unwrap();
    /// assert!(claims.count() > 10 && claims.failed() == 0);
    /// assert_eq!(claims.json().as_array().map(Vec::len), Some(claims.count()));
    /// ```
    pub fn new() -> Result<Self, ClaimsError> {
        let mut all = Vec::new();
        all.extend(named("wear", toolroom_wear::claims())?);
        all.extend(toolroom_cutting::milling::claims().into_iter().map(|claim| ("milling", claim)));
        all.extend(named("chatter", toolroom_chatter::claims())?);
        all.extend(named("dynamics", dynamics::claims())?);
        all.extend(named("infeed", toolroom_infeed::claims())?);
        all.extend(named("contour", toolroom_contour::claims())?);
        all.extend(named("life", toolroom_life::claims())?);
        all.extend(named("shop", shop::claims())?);
        all.extend(statistics::claims().into_iter().map(|claim| ("statistics", claim)));
        Ok(Self(all))
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

/// Claims with the name of their model.
fn named<E: Display>(
    model: &'static str,
    claims: Result<Vec<Claim>, E>,
) -> Result<impl Iterator<Item = (&'static str, Claim)>, ClaimsError> {
    let claims = claims.map_err(|error| ClaimsError { model, reason: error.to_string() })?;
    Ok(claims.into_iter().map(move |claim| (model, claim)))
}
