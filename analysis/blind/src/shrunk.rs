//! How far the gap shrinks, as the diagnosis said and on new edges of the same shop.

use toolroom_gap::{ChannelId, Diagnosis, EffectId, NamedEffect, NominalModel, Outside, joined};
use toolroom_records::Records;

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
    pub fn from_text(
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
        let own: Vec<ChannelId> = diagnosis.effects.iter().flat_map(|effect| effect.id.channels()).collect();
        let of_hidden: Vec<ChannelId> = EffectId::named(hidden).into_iter().flat_map(EffectId::channels).collect();
        let (closed, _) = outside.closure(&named, &own, SEED);
        let (by_named, _) = outside.closure(&named, &of_hidden, SEED);
        // Of several shapes of the hidden effect the one that fits best.
        let (by_hidden, _) = (0..candidates.len())
            .filter(|index| candidates[*index].id.word() == hidden)
            .map(|index| outside.closure(&[index], &of_hidden, SEED))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        let size = match named[..] {
            [index] => Some(outside.size(index) * candidates[index].id.report_units().0),
            _ => None,
        };
        let shrunk = Self { closed: closed.closed, by_named: by_named.closed, by_hidden: by_hidden.closed, size };
        [shrunk.closed, shrunk.by_named, shrunk.by_hidden].iter().all(|x| x.is_finite()).then_some(shrunk)
    }
}
