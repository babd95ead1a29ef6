//! What the body of a tool keeps of its heat from one operation to the next.

use super::run::{MOST, Parts};
use super::{Cutting, Nominal};
use toolroom_records::Records;

/// Time by which a row may begin before the end of the last one and still follow it, s (assumption).
const OVERLAP: f64 = 2.0;

impl<P: Nominal> Cutting<P> {
    /// Share of its heat that the body keeps until each row begins: it cools by its time constant as long as the records
    /// say that the edge was out of cut, else for as long as the scenario handles a part. A new edge is cold.
    pub(super) fn kept_heat(&self, records: &Records) -> Vec<f64> {
        let mut kept = vec![0.0; self.inputs.len()];
        let lag = self.process.lag();
        if P::LAGGED.is_none() || !lag.is_finite() {
            return kept;
        }
        let starts = records.numbers("start_time");
        for pair in self.rows.iter().flat_map(|rows| rows.windows(2)) {
            let [before, row] = [pair[0], pair[1]];
            let recorded = starts.map(|starts| starts[row] - starts[before] - self.durations[before]);
            // Clocks are read to the second: a row that begins a little before the end of the last one follows it at once.
            let recorded = recorded.filter(|idle| *idle > -OVERLAP).map(|idle| idle.max(0.0));
            let planned = Some(self.handling[row]).filter(|time| *time > 0.0);
            // Where neither is known the edge has cooled.
            kept[row] = recorded.or(planned).map_or(0.0, |idle| (-idle / lag).exp());
        }
        kept
    }

    /// The state `x` of an edge when its row begins.
    pub(super) fn cool(&self, parts: &Parts, row: usize, x: &mut [f64; MOST]) {
        if let Some(body) = parts.lagged {
            x[body] *= self.warm[row];
        }
    }
}
