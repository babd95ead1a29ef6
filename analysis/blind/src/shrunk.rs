//! How far the gap shrinks, as the diagnosis said and on new edges of the same shop.

use toolroom_effects::Effect;
use toolroom_gap::{Diagnosis, NamedEffect, NominalModel, Outside, joined, report_units};
use toolroom_records::Records;
use toolroom_scenario::effects::{PROGRAM_EFFECTS, SHOP_EFFECTS};

/// Seed of intervals that nobody looks at.
const SEED: u64 = 1;

/// What new edges say about a named effect where one was hidden.
pub(crate) struct Shrunk {
    /// Closure over the channels of the diagnosis, by what it named.
    pub closed: f64,
    /// Closure over the channels that the hidden effect touches, by what was named.
    pub by_named: f64,
    /// The same by the effect that was hidden, had it been known.
    pub by_hidden: f64,
    /// Size of the named effect that new edges ask for, in its display unit.
    pub size: Option<f64>,
}

impl Shrunk {
    /// `None` where a closure is no number: no new edges, or no gap before.
    pub fn of(
        hidden: &str,
        diagnosis: &Diagnosis,
        records: &Records,
        new: Records,
        model: &NominalModel,
    ) -> Option<Self> {
        let dressings = records.levels("tool_id").is_none() && records.levels("dressing_cycle").is_some();
        let column = dressings.then_some("dressing_cycle");
        let (both, outside) = joined(model, records, new, column).ok()?;
        let (forward, _) = model.over(&both, column, |_, name| outside.iter().any(|own| own == name));
        let outside = Outside::new(forward.as_ref())?;
        let candidates = &forward.frame().candidates;
        let place =
            |effect: &NamedEffect| candidates.iter().position(|own| own.id == effect.id && own.shape == effect.shape);
        let named: Vec<usize> = diagnosis.effects.iter().filter_map(place).collect();
        let own: Vec<&str> = diagnosis.effects.iter().flat_map(|effect| touched(effect.id)).collect();
        let of_hidden = touched(hidden);
        let (closed, _) = outside.closure(&named, &own, SEED);
        let (by_named, _) = outside.closure(&named, &of_hidden, SEED);
        // Of several shapes of the hidden effect the one that fits best.
        let (by_hidden, _) = (0..candidates.len())
            .filter(|index| candidates[*index].id == hidden)
            .map(|index| outside.closure(&[index], &of_hidden, SEED))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        let size = match named[..] {
            [index] => Some(outside.size(index) * report_units(forward.frame(), candidates[index].id).0),
            _ => None,
        };
        let shrunk = Self { closed: closed.closed, by_named: by_named.closed, by_hidden: by_hidden.closed, size };
        [shrunk.closed, shrunk.by_named, shrunk.by_hidden].iter().all(|x| x.is_finite()).then_some(shrunk)
    }
}

/// Channels that an effect touches by the catalogue.
fn touched(id: &str) -> Vec<&'static str> {
    let rows = Effect::CATALOGUE.iter().chain(SHOP_EFFECTS).chain(PROGRAM_EFFECTS).filter(|entry| entry.id == id);
    rows.flat_map(|entry| entry.channels.iter().map(|touched| touched.channel)).collect()
}
