//! How far the gap shrinks, as the diagnosis said and on new edges of the same shop.

use serde_json::{Value, json};
use toolroom_analysis::gap::{Diagnosis, NominalModel, Outside};
use toolroom_analysis::records::Records;
use toolroom_effects::Effect;
use toolroom_sim::effects::SHOP_EFFECTS;

/// Seed of intervals that nobody looks at.
const SEED: u64 = 1;

/// Closure over the channels that the hidden cause touches: estimated, and measured on new edges.
pub struct Shrunk {
    /// What the diagnosis said, with its 90 % interval.
    pub estimate: [f64; 3],
    /// On new edges, by the named effects.
    pub attributed: f64,
    /// On new edges, by the effect that was hidden, had it been known.
    pub oracle: f64,
}

impl Shrunk {
    /// `None` where a closure is no number: no new edges, or no gap before.
    pub fn of(
        hidden: &str,
        diagnosis: &Diagnosis,
        records: &Records,
        new: &Records,
        model: &NominalModel,
    ) -> Option<Self> {
        let known = if records.levels("tool_id").is_some() { "tool_id" } else { "dressing_cycle" };
        let inside = records.levels(known)?.0;
        let both = records.followed_by(new);
        let (forward, _) = model.over(&both, Some(known), |_, name| inside.iter().all(|own| own != name));
        let outside = Outside::new(forward.as_ref())?;
        let touched: Vec<&str> = Effect::CATALOGUE
            .iter()
            .chain(SHOP_EFFECTS)
            .filter(|entry| entry.id == hidden)
            .flat_map(|entry| entry.channels.iter().map(|touched| touched.channel))
            .collect();
        let candidates = &forward.frame().candidates;
        let named = |effect: &toolroom_analysis::gap::NamedEffect| {
            candidates.iter().position(|own| own.id == effect.id && own.shape == effect.shape)
        };
        let named: Vec<usize> = diagnosis.effects.iter().filter_map(named).collect();
        let (attributed, _) = outside.closure(&named, &touched, SEED);
        // Of several shapes of the hidden effect the one that fits best.
        let oracle = (0..candidates.len())
            .filter(|index| candidates[*index].id == hidden)
            .map(|index| outside.closure(&[index], &touched, SEED))
            .min_by(|a, b| a.1.total_cmp(&b.1))?
            .0;
        let [low, high] = diagnosis.total.ci90;
        let estimate = [diagnosis.total.closed, low, high];
        let number =
            attributed.closed.is_finite() && oracle.closed.is_finite() && estimate.iter().all(|x| x.is_finite());
        number.then_some(Self { estimate, attributed: attributed.closed, oracle: oracle.closed })
    }

    /// Whether the interval holds what was found on new edges.
    pub fn covered(&self) -> bool {
        self.estimate[1] <= self.attributed && self.attributed <= self.estimate[2]
    }

    pub fn csv(&self) -> String {
        let [value, low, high] = self.estimate;
        format!("{value:.3},{low:.3},{high:.3},{:.3},{:.3}", self.attributed, self.oracle)
    }

    pub fn json(&self) -> Value {
        json!({
            "estimate": self.estimate[0], "ci90": [self.estimate[1], self.estimate[2]],
            "on_new_edges": self.attributed, "by_hidden_effect": self.oracle,
        })
    }
}
