//! How a shop deviates from what its planner believes.

use super::effects::SHOP_EFFECTS;
use super::{Occasion, Scope};
use toolroom_effects::CatalogueEntry;
use toolroom_form::vocabulary;

vocabulary! {
    /// An effect that a simulated shop can have: rows of [`SHOP_EFFECTS`](crate::effects::SHOP_EFFECTS).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ShopEffect {
        /// The feed runs slower or faster than programmed.
        FeedOverride = "feed_override",
        /// The feed is held.
        FeedHold = "feed_hold",
        /// Short stops that nobody books.
        MicroStops = "micro_stops",
        /// Operators come late to the machine.
        OperatorDelay = "operator_delay",
        /// A tool change takes longer than planned.
        ToolChangeDelay = "tool_change_delay",
        /// Edges are changed at another wear than planned.
        ToolChangePolicy = "tool_change_policy",
        /// Breakdowns come in bursts or after wear.
        BreakdownShape = "breakdown_shape",
    }
}

impl ShopEffect {
    /// Its row of the catalogue.
    ///
    /// # Panics
    /// Never: a test looks at every effect.
    pub fn entry(self) -> &'static CatalogueEntry {
        SHOP_EFFECTS.iter().find(|entry| entry.id == self.word()).expect("every effect of a shop has a row")
    }
}

/// An effect of the shop (a row of [`SHOP_EFFECTS`](crate::effects::SHOP_EFFECTS)) with its size.
///
/// | id | what it does |
/// |---|---|
/// | feed_override | time in cut or in plain work grows by this share; below zero it is faster than programmed |
/// | feed_hold | the program is held for this time before its end, in a share of the operations; added as cutting |
/// | micro_stops | stops of an exponential duration, 20 s in the mean, come as a Poisson process in the time in cut or in plain work; added there |
/// | operator_delay | time before loading, as handling |
/// | tool_change_delay | time of every change of an edge |
/// | tool_change_policy | edges are changed when the reading passes the limit by so much |
/// | breakdown_shape | exponential times between breakdowns become Weibull of shape 1 + size, mean kept |
///
/// # Source
/// Assumptions, as the rows of the catalogue say. The edge wears during its programmed passes only.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// What deviates.
    pub effect: ShopEffect,
    /// Size, SI.
    pub size: f64,
    /// Operations on which it acts.
    pub scope: Scope,
    /// Share of the operations that it concerns; of `feed_hold` only.
    pub share: f64,
    /// Standard error of the size, SI.
    pub standard_error: Option<f64>,
    /// Mean share that recorded overrides add to the time in cut, which the size multiplies; of `feed_override` only.
    pub recorded: Option<f64>,
}

/// Mean duration of a short stop, s (assumption of the catalogue).
pub const MICRO_STOP: f64 = 20.0;

impl Deviation {
    /// An effect that always acts on everything.
    pub fn new(effect: ShopEffect, size: f64) -> Self {
        Self { effect, size, scope: Scope::default(), share: 1.0, standard_error: None, recorded: None }
    }

    /// Those of an effect that act on an operation.
    pub fn acting<'a>(
        all: &'a [Self],
        effect: ShopEffect,
        occasion: &'a Occasion<'_>,
    ) -> impl Iterator<Item = &'a Self> {
        all.iter().filter(move |deviation| deviation.effect == effect && deviation.scope.holds(occasion))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_deviation_is_a_row_of_the_catalogue() {
        for word in ShopEffect::WORDS {
            assert_eq!(ShopEffect::from_word(word).map(|effect| effect.entry().id), Some(*word));
        }
    }
}
